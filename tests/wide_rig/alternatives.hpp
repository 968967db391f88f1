#pragma once

#include <string>
#include <vector>

#include "tests/wide_rig/bench_row.hpp"
#include "tests/wide_rig/bench_subject.hpp"
#include "tests/wide_rig/hidden_effect.hpp"

namespace gear3k::wide_rig {

/// What each cause could do to the rows at best: a few usual shapes per cause, to first order.
///
/// Two causes are confounded where their columns are parallel once what both may have besides
/// (another coefficient of friction, the other effects) is taken out. That is a property of the
/// plan, so that it is computed from the plan, not listed: temperature that follows speed, time or
/// sessions, one direction, one sense of rotation, too few levels.
struct CauseShape {
  std::string cause;
  std::vector<std::vector<double>> columns{};  ///< each of the length of the rows, over sigma
  double order = 0.0;                          ///< of a wave: periods per turn of the output
  std::string body{};                          ///< of a wave: what turns
};

struct Alternatives {
  std::vector<CauseShape> shapes;
  std::vector<CauseShape> waves;            ///< at every order of the gearbox, of friction too
  std::vector<std::vector<double>> always;  ///< free in any case: the level of friction
};

/// @param columns tells which causes the data can speak of at all (no time, no drift)
Alternatives usual_shapes(const BenchSubject& subject, const std::string& kind,
                          const std::vector<BenchRow>& rows, const BenchColumns& columns,
                          const std::vector<double>& sigma);

struct LeftOver {
  std::string cause;
  double chi_square = 0.0;     ///< of the effect, that the best shape of the cause leaves
  std::vector<double> rest{};  ///< that remainder by rows
};

/// What remains of a clean effect (over sigma) with each cause in its place, best shape each.
///
/// @param others clean effects of the other truths over sigma: free too
/// @param is_level the effect is itself another coefficient of friction: that is then not free
std::vector<LeftOver> left_over(const Alternatives& alternatives, const std::vector<double>& effect,
                                const std::vector<std::vector<double>>& others, bool is_level);

/// An order of the gearbox at which a wave is described as well as at its own.
struct OrderAsGood {
  std::string cause, body;
  double order = 0.0;
};

/// Orders whose waves (two harmonics, best target) leave a chi-square of the effect that is less
/// than `more` above what its own order leaves; that one is among them.
std::vector<OrderAsGood> orders_as_good(const Alternatives& alternatives,
                                        const std::vector<double>& effect,
                                        const std::vector<std::vector<double>>& others,
                                        double own_order, double more);

}  // namespace gear3k::wide_rig
