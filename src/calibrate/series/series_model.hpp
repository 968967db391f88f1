#pragma once
// Parameters of a series from the fits of its gearboxes, and the model of what is the design's.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrate/fit/final_fit.hpp"
#include "calibrate/series/series.hpp"

namespace gear3k::calibrate {

/// A parameter over the gearboxes that determine it; empty where fewer than two do.
///
/// Errors of a scatter that ν rows estimate are √(ν/(ν − 2)) times as great (Student's variance);
/// with ν ≤ 2, and where a fit's rows do not determine the parameter, they are not known.
/// @param at  its place among the values of each fit
std::optional<SeriesParameter> series_parameter(const std::vector<FinalFit>& fits,
                                                const ParameterRecord& record, std::size_t at);

/// The causes of the design with their means, and the covariance of the means:
/// Σ_u a_ju a_ku (C_u,jk + δ_jk τ_j²) with the weights a_ju of gearbox u in the mean j, to the
/// deviations that the means' intervals have.
///
/// A model with laws and one that is a formula only stay as they are but for deviations: their
/// values were fitted together.  Those of the design's causes are no less than
/// those of the means.
/// @param covariance  by gearbox, of all parameters of the causes
/// @param model  of the diagnosis of rows less what is the parts' own
ExtendedModel series_model(const std::vector<SeriesCause>& causes,
                           const std::vector<Eigen::MatrixXd>& covariance, ExtendedModel model);

}  // namespace gear3k::calibrate
