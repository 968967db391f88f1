#pragma once
// A law as a reader sees it.

#include <string>
#include <vector>

#include "calibrate/fit/parameter_results.hpp"
#include "calibrate/laws/law_search.hpp"
#include "calibrate/model/extended_model.hpp"

namespace gear3k::calibrate {

/// A formula for what no cause explains; no physical cause.
struct LawResult {
  std::string name;     ///< "law: power of sun_speed"
  std::string formula;  ///< "loss = 0.012 Nm * (sun_speed/3000 rpm)^1.02", in ASCII
  std::string acts_on;  ///< of kLawActionNames
  std::string rows;     ///< of kLawRowsNames
  std::string unit;     ///< of amplitude and offset: "Nm", "arcmin" or ""
  std::vector<ParameterResult> parameters;
  /// 1 − e/e_0, with the root mean square e of held-out rows as causes and law predict them and e_0
  /// as the causes alone do; NaN without blocks.
  double held_out_gain = kUnknown;
  double held_out_error = kUnknown;   ///< e [SI]
  double delta_bic = 0.0;             ///< of the causes alone less that with the law
  int forms = 0;                      ///< that were tried
  std::vector<ConditionRange> range;  ///< of the conditions that it depends on, in the data
};

/// @param final  of the law's hypothesis
/// @param error_without, error_with  of held-out rows [SI]
LawResult law_result(const Problem& problem, const FoundLaw& found, const FinalFit& final,
                     double error_without, double error_with);

/// Whether the interval of the amplitude of a law, the last effect of a fit, is off 0.  Values
/// between which the rows do not choose may end anywhere in a fit to all of them.
bool has_amplitude(const Problem& problem, const FinalFit& final);

/// The covariate that a law's first condition is: "load", "speed", "angle", "tooth sum", ...
std::string covariate_of(const Law& law);

/// Whether an effect of a hypothesis is a law, no cause.
bool is_law(const Candidate& candidate);

}  // namespace gear3k::calibrate
