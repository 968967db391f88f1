#include "calibrate/verdict/model_update.hpp"

#include <algorithm>

#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::calibrate {

namespace {

/// Rows and columns of a covariance; 0 where it is not stated.
double entry(const ExtendedModel& model, std::size_t parameters, std::size_t row,
             std::size_t column) {
  const std::size_t place = row * parameters + column;
  return place < model.covariance.size() ? model.covariance[place] : 0.0;
}

/// What a model is worth together with what was found on top of it: a cause that could be another
/// one stays so, and what could not be explained before may be now.
std::optional<Verdict> joint_verdict(const std::optional<Verdict>& earlier,
                                     const std::optional<Verdict>& found) {
  if (!found) return earlier;
  if (earlier == Verdict::kAmbiguous) return std::max(*earlier, *found);
  return found;
}

ExtendedModel joined(const ExtendedModel& earlier, const ExtendedModel& found) {
  ExtendedModel result = found;
  result.verdict = joint_verdict(earlier.verdict, found.verdict);
  result.beyond_springs = earlier.beyond_springs || found.beyond_springs;
  result.causes.clear();
  result.laws.clear();
  // Where each parameter is in the covariance that it comes from.
  struct Source {
    const ExtendedModel* model;
    std::size_t parameters, place;
  };
  std::vector<Source> sources;
  for (const ExtendedModel* model : {&earlier, &found}) {
    const std::size_t parameters = parameter_count(*model);
    std::size_t place = 0;
    for (const AppliedCause& cause : model->causes) {
      result.causes.push_back(cause);
      for (std::size_t k = 0; k < cause.value.size(); ++k, ++place) {
        sources.push_back({.model = model, .parameters = parameters, .place = place});
      }
    }
  }
  for (const ExtendedModel* model : {&earlier, &found}) {
    const std::size_t parameters = parameter_count(*model);
    std::size_t place = parameters;
    for (const AppliedLaw& law : model->laws) place -= law.value.size();
    for (const AppliedLaw& law : model->laws) {
      result.laws.push_back(law);
      for (std::size_t k = 0; k < law.value.size(); ++k, ++place) {
        sources.push_back({.model = model, .parameters = parameters, .place = place});
      }
    }
  }
  result.covariance.clear();
  result.covariance.reserve(sources.size() * sources.size());
  for (const Source& row : sources) {
    for (const Source& column : sources) {
      result.covariance.push_back(row.model == column.model
                                      ? entry(*row.model, row.parameters, row.place, column.place)
                                      : 0.0);
    }
  }
  return result;
}

}  // namespace

std::vector<ExtendedModel> updated_models(const std::vector<ExtendedModel>& earlier,
                                          const std::vector<ExtendedModel>& found) {
  std::vector<ExtendedModel> result = earlier;
  for (const ExtendedModel& model : found) {
    const auto at = std::ranges::find(result, model.kind, &ExtendedModel::kind);
    if (at == result.end()) {
      result.push_back(model);
    } else if (!model.causes.empty() || !model.laws.empty()) {
      *at = joined(*at, model);
    } else if (model.verdict == Verdict::kUnexplained) {
      at->verdict = model.verdict;
    }
  }
  std::ranges::stable_sort(result, {}, &ExtendedModel::kind);
  return result;
}

}  // namespace gear3k::calibrate
