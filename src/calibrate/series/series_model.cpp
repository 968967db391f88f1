#include "calibrate/series/series_model.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace gear3k::calibrate {

namespace {

/// A mean of the design: its parameter, the place of that among all, the gearboxes' weights.
struct Mean {
  const SeriesParameter* parameter;
  Eigen::Index at;
  std::vector<double> weight;
};

std::vector<double> weights_of(const SeriesParameter& p) {
  const double variance = p.effects.deviation * p.effects.deviation;
  std::vector<double> weight;
  double sum = 0.0;
  for (const UnitEstimate& u : p.units) {
    weight.push_back(std::isfinite(u.sd) ? 1.0 / (u.sd * u.sd + variance) : 0.0);
    sum += weight.back();
  }
  for (double& w : weight) w /= sum;
  return weight;
}

std::vector<Mean> means_of_design(const std::vector<SeriesCause>& causes) {
  std::vector<Mean> means;
  Eigen::Index at = 0;
  for (const SeriesCause& cause : causes) {
    for (const SeriesParameter& p : cause.parameters) {
      if (cause.of != Origin::kPart) {
        means.push_back({.parameter = &p, .at = at, .weight = weights_of(p)});
      }
      ++at;
    }
  }
  return means;
}

Eigen::MatrixXd covariance_of(const std::vector<Mean>& means,
                              const std::vector<Eigen::MatrixXd>& of_unit) {
  const auto size = static_cast<Eigen::Index>(means.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    const Mean& row = means[static_cast<std::size_t>(j)];
    for (Eigen::Index k = 0; k < size; ++k) {
      const Mean& column = means[static_cast<std::size_t>(k)];
      for (std::size_t u = 0; u < of_unit.size(); ++u) {
        double between = of_unit[u](row.at, column.at);
        if (j == k) between += std::pow(row.parameter->effects.deviation, 2);
        result(j, k) += row.weight[u] * column.weight[u] * between;
      }
    }
  }
  Eigen::VectorXd scale(size);
  for (Eigen::Index j = 0; j < size; ++j) {
    const double sd = means[static_cast<std::size_t>(j)].parameter->effects.mean_sd;
    scale[j] = result(j, j) > 0.0 ? sd / std::sqrt(result(j, j)) : 1.0;
  }
  return scale.asDiagonal() * result * scale.asDiagonal();
}

bool same_cause(const SeriesCause& cause, const AppliedCause& applied) {
  return applied.id == cause.id && applied.form.name == cause.form.name &&
         applied.form.body == cause.form.body && applied.form.order == cause.form.order &&
         applied.value.size() == cause.parameters.size();
}

/// Deviations of the design's causes no less than those of their means.
ExtendedModel widened(const std::vector<SeriesCause>& causes, ExtendedModel model) {
  const std::size_t size = parameter_count(model);
  if (model.covariance.size() != size * size) return model;
  std::vector<double> factor(size, 1.0);
  std::size_t at = 0;
  for (const AppliedCause& applied : model.causes) {
    const auto own =
        std::ranges::find_if(causes, [&](const SeriesCause& c) { return same_cause(c, applied); });
    for (std::size_t k = 0; k < applied.value.size(); ++k, ++at) {
      if (own == causes.end()) continue;
      const double variance = model.covariance[at * size + at];
      const double sd = own->parameters[k].effects.mean_sd;
      if (variance > 0.0) factor[at] = std::max(1.0, sd / std::sqrt(variance));
    }
  }
  for (std::size_t j = 0; j < size; ++j) {
    for (std::size_t k = 0; k < size; ++k) model.covariance[j * size + k] *= factor[j] * factor[k];
  }
  return model;
}

}  // namespace

std::optional<SeriesParameter> series_parameter(const std::vector<FinalFit>& fits,
                                                const ParameterRecord& record, std::size_t at) {
  SeriesParameter p{.name = std::string(record.name), .unit = std::string(record.unit)};
  std::vector<UnitEstimate> determined;
  for (const FinalFit& fit : fits) {
    const auto k = static_cast<Eigen::Index>(at);
    const double nu = fit.degrees;
    const double student = fit.scale_is_known ? 1.0 : nu > 2.0 ? nu / (nu - 2.0) : kUnknown;
    const double variance = fit.determined[at] ? fit.covariance(k, k) * student : kUnknown;
    p.units.push_back(
        {.value = fit.hypothesis.value[at], .sd = variance > 0.0 ? std::sqrt(variance) : kUnknown});
    p.at_bound.push_back(fit.at_bound[at]);
    if (std::isfinite(p.units.back().sd)) determined.push_back(p.units.back());
  }
  if (determined.size() < 2) return std::nullopt;
  p.effects = random_effects(determined);
  return p;
}

ExtendedModel series_model(const std::vector<SeriesCause>& causes,
                           const std::vector<Eigen::MatrixXd>& covariance, ExtendedModel model) {
  const bool formula = std::ranges::any_of(model.causes, &AppliedCause::empirical);
  if (!model.laws.empty() || formula) return widened(causes, std::move(model));
  model.causes.clear();
  for (const SeriesCause& cause : causes) {
    if (cause.of == Origin::kPart) continue;
    model.causes.push_back({.id = cause.id,
                            .form = cause.form,
                            .value = {},
                            .alternatives = cause.alternatives,
                            .implausible = {}});
    for (const SeriesParameter& p : cause.parameters) {
      model.causes.back().value.push_back(p.effects.mean);
    }
  }
  const Eigen::MatrixXd of_means = covariance_of(means_of_design(causes), covariance);
  model.covariance.clear();
  for (Eigen::Index j = 0; j < of_means.rows(); ++j) {
    for (Eigen::Index k = 0; k < of_means.cols(); ++k) model.covariance.push_back(of_means(j, k));
  }
  return model;
}

}  // namespace gear3k::calibrate
