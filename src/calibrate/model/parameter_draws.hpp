#pragma once
// What a model could as well be: its parameters drawn from their covariance.

#include <cstdint>
#include <string>
#include <vector>

#include "calibrate/model/extended_model.hpp"

namespace gear3k::calibrate {

/// Parameters "drag_constant.torque" of causes that change the gearbox whose scatter models do not
/// state: without covariance, or with a variance of 0, as of one that the data did not tell.
std::vector<std::string> parameters_without_scatter(const std::vector<ExtendedModel>& models);

/// Draws models from N(value, covariance) of their parameters, those of different kinds independent
/// of each other; each parameter held within the bounds of its fit.
///
/// Draw n depends on seed and n only.  A model without covariance stays as it is.
/// Source: own derivation, docs/theory §30.
class ParameterDraws {
 public:
  /// @throws std::invalid_argument for a covariance of another size than the parameters
  ParameterDraws(const std::vector<ExtendedModel>& models, std::uint64_t seed);

  [[nodiscard]] std::vector<ExtendedModel> draw(std::uint64_t n) const;

 private:
  const std::vector<ExtendedModel>* models_;
  std::uint64_t seed_;
  /// Of each model, row after row: L of covariance = L Lᵀ; empty where there is none.
  std::vector<std::vector<double>> roots_;
};

}  // namespace gear3k::calibrate
