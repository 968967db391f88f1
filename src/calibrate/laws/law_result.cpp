#include "calibrate/laws/law_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"

namespace gear3k::calibrate {

LawResult law_result(const Problem& problem, const FoundLaw& found, const FinalFit& final,
                     double error_without, double error_with) {
  const std::size_t effect = final.hypothesis.effects.size() - 1;
  const Law& law = found.law;
  const auto fitted = values_of(final.hypothesis, effect);
  LawResult result{
      .name = "law: " + law_title(law),
      .formula = law_formula(law, {fitted.begin(), fitted.end()}, problem.data.kind),
      .acts_on = std::string(kLawActionNames[static_cast<std::size_t>(law.action)]),
      .rows = std::string(kLawRowsNames[static_cast<std::size_t>(law.rows)]),
      .unit = is_share(law.action) ? "" : std::string(response_unit(problem.data.kind).name),
      .parameters = parameter_results(problem, final, effect),
      .held_out_gain = 1.0 - error_with / error_without,
      .held_out_error = error_with,
      .delta_bic = found.delta_bic,
      .forms = found.forms,
      .range = {}};
  for (const LawFactor& f : law.factors) {
    const LawCondition& condition = law_conditions()[f.condition];
    ValueRange range;
    for (const Observation& row : problem.data.rows) range.extend(condition.value(row.condition));
    result.range.push_back({.name = std::string(condition.name),
                            .unit = std::string(condition.shown_unit),
                            .low = range.low,
                            .high = range.high});
  }
  return result;
}

bool has_amplitude(const Problem& problem, const FinalFit& final) {
  const ParameterResult amplitude =
      parameter_results(problem, final, final.hypothesis.effects.size() - 1).front();
  return amplitude.low > 0.0 || amplitude.high < 0.0;
}

std::string covariate_of(const Law& law) {
  std::string name(law_conditions()[law.factors.front().condition].name);
  if (name == kOutputTorque.name) return "load";
  if (name == kSunSpeed.name) return "speed";
  if (name == kOutputAngle.name) return "angle";
  std::ranges::replace(name, '_', ' ');
  return name;
}

bool is_law(const Candidate& candidate) { return candidate.cause == &law_cause(); }

}  // namespace gear3k::calibrate
