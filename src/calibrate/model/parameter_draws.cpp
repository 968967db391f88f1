#include "calibrate/model/parameter_draws.hpp"

#include <Random123/philox.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "calibrate/model/model_range.hpp"
#include "numerics/distributions.hpp"

namespace gear3k::calibrate {

namespace {

/// L of C = L Lᵀ for a positive semidefinite C of n rows, by Cholesky's algorithm on its
/// correlations; columns of what follows from those before it are 0.
std::vector<double> root_of(const std::vector<double>& c, std::size_t n) {
  std::vector<double> sd(n);
  for (std::size_t i = 0; i < n; ++i) sd[i] = std::sqrt(std::max(0.0, c[i * (n + 1)]));
  std::vector<double> root(n * n, 0.0);
  for (std::size_t j = 0; j < n; ++j) {
    const auto rest = [&](std::size_t i) {
      double r = sd[i] > 0.0 && sd[j] > 0.0 ? c[i * n + j] / (sd[i] * sd[j]) : 0.0;
      for (std::size_t k = 0; k < j; ++k) r -= root[i * n + k] * root[j * n + k];
      return r;
    };
    constexpr double kRounding = 1e-12;
    const double pivot = rest(j);
    if (!(pivot > kRounding)) continue;
    for (std::size_t i = j; i < n; ++i) root[i * n + j] = rest(i) / std::sqrt(pivot);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) root[i * n + j] *= sd[i];
  }
  return root;
}

/// Standard normal number of a draw, the same whatever was drawn before.
double normal_number(std::uint64_t seed, std::uint64_t draw, std::uint64_t place) {
  const auto words = r123::Philox4x64()({{draw, place, 0, 0}}, {{seed, 0}});
  return numerics::normal_quantile((static_cast<double>(words[0] >> 11U) + 0.5) * 0x1p-53);
}

}  // namespace

std::vector<std::string> parameters_without_scatter(const std::vector<ExtendedModel>& models) {
  std::vector<std::string> names;
  for (const ExtendedModel& model : models) {
    const std::size_t count = parameter_count(model);
    std::size_t place = 0;
    for (const AppliedCause& applied : model.causes) {
      const Cause* cause = find_cause(applied.id);
      const bool acts = cause != nullptr && changes_gearbox(applied, model.kind);
      for (std::size_t k = 0; k < applied.value.size(); ++k, ++place) {
        const bool scatters =
            !model.covariance.empty() && model.covariance[place * (count + 1)] > 0.0;
        if (!acts || scatters) continue;
        names.push_back(
            fmt::format("{}.{}", applied.id, cause->parameters(applied.form, model.kind)[k].name));
      }
    }
  }
  return names;
}

ParameterDraws::ParameterDraws(const std::vector<ExtendedModel>& models, std::uint64_t seed)
    : models_(&models), seed_(seed) {
  roots_.reserve(models.size());
  for (const ExtendedModel& model : models) {
    const std::size_t count = parameter_count(model);
    if (!model.covariance.empty() && model.covariance.size() != count * count) {
      throw std::invalid_argument(
          fmt::format("ParameterDraws: covariance of {} numbers, allowed: {} (none, or {} "
                      "parameters squared)",
                      model.covariance.size(), count * count, count));
    }
    roots_.push_back(model.covariance.empty() ? std::vector<double>()
                                              : root_of(model.covariance, count));
  }
}

std::vector<ExtendedModel> ParameterDraws::draw(std::uint64_t n) const {
  std::vector<ExtendedModel> drawn = *models_;
  std::uint64_t first = 0;  // of a model's random numbers
  for (std::size_t m = 0; m < drawn.size(); ++m) {
    ExtendedModel& model = drawn[m];
    const std::size_t count = parameter_count(model);
    if (!roots_[m].empty()) {
      std::vector<double> normal(count);
      for (std::size_t k = 0; k < count; ++k) normal[k] = normal_number(seed_, n, first + k);
      std::size_t place = 0;
      for (AppliedCause& applied : model.causes) {
        const Cause* cause = find_cause(applied.id);
        if (cause == nullptr) {
          place += applied.value.size();
          continue;
        }
        const auto records = cause->parameters(applied.form, model.kind);
        for (std::size_t i = 0; i < applied.value.size(); ++i, ++place) {
          double value = applied.value[i];
          for (std::size_t k = 0; k <= place; ++k)
            value += roots_[m][place * count + k] * normal[k];
          // A stated value beyond the bounds stays possible.
          applied.value[i] = std::clamp(value, std::min(records[i].lower, applied.value[i]),
                                        std::max(records[i].upper, applied.value[i]));
        }
      }
    }
    first += count;
  }
  return drawn;
}

}  // namespace gear3k::calibrate
