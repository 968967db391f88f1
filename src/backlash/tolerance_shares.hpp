#pragma once
// Which tolerance the scatter of the lost motion comes from, and what tightening each would buy.

#include <cstdint>
#include <vector>

#include "backlash/monte_carlo.hpp"

namespace gear3k::backlash {

struct Estimate {
  double value = 0.0, standard_error = 0.0;
};

/// Of one source.
struct ToleranceShare {
  /// Shares of the variance: of the source alone, and with all that it does together with others.
  Estimate first_order, total;
  /// With the source's half width halved about its middle, all else the same numbers.
  struct Halved {
    double yield = 0.0, jam_probability = 0.0;
    double quantile_99_rad = 0.0;  ///< of those that assemble
    /// Against the series as it is; errors from the gearboxes whose fate differs (McNemar).
    Estimate yield_gain, jam_change;
  } halved;
};

struct ToleranceShares {
  std::uint64_t samples = 0;
  /// Of the lost motion, a jammed gearbox counting as one without any.
  double mean_rad = 0.0, variance_rad2 = 0.0;
  double yield = 0.0, jam_probability = 0.0, quantile_99_rad = 0.0;  ///< as the tolerances are
  std::vector<ToleranceShare> sources;  ///< in the order of ClearanceModel::sources
};

/// Sobol' indices of every source, by picking from one series A of gearboxes and freezing in
/// another one B: AB_i is A with the deviations of source i from B.
///
///   V = variance of y,   S_i = mean of (y_B − ȳ)(y_ABi − y_A)/V,   T_i = mean of (y_A − y_ABi)²/(2
///   V)
///
/// y is the lost motion, 0 where the gearbox jams.  Standard errors by the delta method of the
/// ratio of means.  A is the series that monte_carlo() builds with the same options. Source:
/// Saltelli, Annoni, Azzini, Campolongo, Ratto, Tarantola, Computer Physics Communications 181
/// (2010), table 2 (b), (f); the latter Jansen's, Computer Physics Communications 117 (1999).
/// Resolution of the quantiles: the greatest lost motion over 2¹⁴.
/// Does not cover: a tolerance that lies in two sources: what run-out leaves of the cumulative
/// pitch stays as it is where the run-out is halved.
/// @throws std::invalid_argument as monte_carlo()
ToleranceShares tolerance_shares(const ClearanceModel& model, const MonteCarloOptions& options);

}  // namespace gear3k::backlash
