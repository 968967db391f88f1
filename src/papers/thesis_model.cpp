#include "papers/thesis_model.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>

#include "geometry/gear.hpp"
#include "numerics/linear_algebra.hpp"

namespace gear3k::papers {

using efficiency::SinglePair;

std::vector<MeasuredBothWays> measured_both_ways(const std::vector<MeasuredPairLoss>& rows) {
  std::vector<MeasuredBothWays> pairs;
  for (const MeasuredPairLoss& large : rows) {
    if (large.driving_teeth <= large.driven_teeth) continue;
    for (const MeasuredPairLoss& small : rows) {
      if (small.driving_teeth == large.driven_teeth && small.driven_teeth == large.driving_teeth) {
        pairs.push_back({.large_drives = large, .small_drives = small});
      }
    }
  }
  return pairs;
}

SinglePair pair_of(const ThesisStatements& s, const MeasuredPairLoss& m, double friction) {
  const auto angle = geometry::make_pressure_angle(s.pressure_angle_rad);
  const auto gear = [&](int teeth) {
    return geometry::make_gear_geometry(
        geometry::Gear<double>{.teeth = teeth,
                               .kind = geometry::GearKind::kExternal,
                               .module_m = s.module_m,
                               .profile_shift = 0.0,
                               .machining_allowance = 0.0,
                               .tip_shortening = 0.0,
                               .rack = {}},
        angle);
  };
  const auto driver = gear(m.driving_teeth);
  const auto driven = gear(m.driven_teeth);
  return {.pitch_radius1_m = driver.reference_radius_m,
          .pitch_radius2_m = driven.reference_radius_m,
          .tip_radius1_m = driver.tip_radius_m,
          .tip_radius2_m = driven.tip_radius_m,
          .pressure_angle_rad = s.pressure_angle_rad,
          .friction = friction};
}

LossMap loss_map(const ThesisStatements& s) {
  LossMap map{.friction = s.map_friction, .teeth = {}, .points = {}};
  map.teeth.reserve((kMapLast - kMapFirst) / kMapStep + 1);
  for (int z = kMapFirst; z <= kMapLast; z += kMapStep) map.teeth.push_back(z);
  map.points.reserve(map.teeth.size() * map.teeth.size());
  for (const int driving : map.teeth) {
    for (const int driven : map.teeth) {
      const SinglePair pair = pair_of(s, {driving, driven, 0.0}, map.friction);
      map.points.push_back({.driving_teeth = driving,
                            .driven_teeth = driven,
                            .loss = efficiency::mean_torque_loss(pair),
                            .symmetric = efficiency::symmetric_loss(pair),
                            .skew = efficiency::skew_loss(pair),
                            .on_involutes = efficiency::path_on_involutes(pair)});
    }
  }
  return map;
}

Parts parts_of(const ThesisSources& sources, double friction) {
  const auto count = static_cast<Eigen::Index>(sources.measured.size());
  Parts parts{.symmetric = Eigen::VectorXd(count), .skew = Eigen::VectorXd(count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const SinglePair pair =
        pair_of(sources.statements, sources.measured[static_cast<std::size_t>(k)], friction);
    parts.symmetric[k] = efficiency::symmetric_loss(pair);
    parts.skew[k] = efficiency::skew_loss(pair);
  }
  return parts;
}

Eigen::VectorXd measured_losses(const ThesisSources& sources) {
  Eigen::VectorXd losses(static_cast<Eigen::Index>(sources.measured.size()));
  for (Eigen::Index k = 0; k < losses.size(); ++k) {
    losses[k] = sources.measured[static_cast<std::size_t>(k)].loss;
  }
  return losses;
}

double rms(const Eigen::VectorXd& residual) {
  return std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
}

namespace {
Eigen::VectorXd predicted(const PairLossModel& model, const Parts& parts) {
  return (model.symmetric_scale * parts.symmetric + model.skew_factor * parts.skew).array() +
         model.offset;
}
}  // namespace

LeastSquares least_squares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& wanted) {
  LeastSquares fit{.coefficients = numerics::least_squares(columns, wanted), .rms_error = 0.0};
  fit.rms_error = rms(columns * fit.coefficients - wanted);
  return fit;
}

LeastSquares fit_of_scale(const Parts& parts, const Eigen::VectorXd& third,
                          const Eigen::VectorXd& losses) {
  Eigen::MatrixXd columns(losses.size(), 3);
  columns << parts.symmetric, Eigen::VectorXd::Ones(losses.size()), third;
  return least_squares(columns, losses);
}

namespace {
/// Least squares of offset and skew factor at a given friction.
LeastSquares fit_at_friction(const ThesisSources& sources, double friction) {
  const Eigen::VectorXd losses = measured_losses(sources);
  const Parts parts = parts_of(sources, friction);
  Eigen::MatrixXd columns(losses.size(), 2);
  columns << Eigen::VectorXd::Ones(losses.size()), parts.skew;
  return least_squares(columns, losses - parts.symmetric);
}
}  // namespace

double largest_friction(const ThesisStatements& s) { return 1.0 / std::tan(s.pressure_angle_rad); }

namespace {
/// The friction with the least rms error: a scan of the model's whole range, then Brent's method
/// between the neighbours of the best point.
double best_friction(const ThesisSources& sources) {
  constexpr int kSteps = 200;
  const double step = largest_friction(sources.statements) / kSteps;
  const auto error = [&](double mu) { return fit_at_friction(sources, mu).rms_error; };
  int best = 1;
  for (int k = 2; k < kSteps; ++k) {
    if (error(k * step) < error(best * step)) best = k;
  }
  const double low = std::max(best - 1, 0) * step;
  const double high = std::min((best + 1) * step, (kSteps - 0.5) * step);
  constexpr int kBits = std::numeric_limits<double>::digits / 2;  // all that a minimum can hold
  return boost::math::tools::brent_find_minima(error, std::max(low, 0.01 * step), high, kBits)
      .first;
}
}  // namespace

std::vector<PairLossModel> loss_models(const ThesisSources& sources) {
  const ThesisStatements& s = sources.statements;
  const Eigen::VectorXd losses = measured_losses(sources);
  const Parts parts = parts_of(sources, s.corrected_friction);
  std::vector<PairLossModel> models;
  models.push_back({.name = "single_tooth",
                    .description = "the single-tooth model",
                    .friction = s.corrected_friction});
  models.push_back({.name = "corrected",
                    .description = "corrected model of section 3.4",
                    .friction = s.corrected_friction,
                    .symmetric_scale = s.corrected_symmetric_scale,
                    .offset = s.corrected_offset,
                    .skew_factor = s.corrected_skew_factor});
  for (PairLossModel& model : models) model.rms_error = rms(predicted(model, parts) - losses);
  const LeastSquares scale = fit_of_scale(parts, parts.skew, losses);
  models.push_back({.name = "refit_scale",
                    .description = "scale, offset and skew factor refitted",
                    .friction = s.corrected_friction,
                    .symmetric_scale = scale.coefficients[0],
                    .offset = scale.coefficients[1],
                    .skew_factor = scale.coefficients[2],
                    .rms_error = scale.rms_error});
  const double mu = best_friction(sources);
  const LeastSquares friction = fit_at_friction(sources, mu);
  models.push_back({.name = "refit_friction",
                    .description = "friction, offset and skew factor refitted",
                    .friction = mu,
                    .symmetric_scale = 1.0,
                    .offset = friction.coefficients[0],
                    .skew_factor = friction.coefficients[1],
                    .rms_error = friction.rms_error});
  return models;
}

std::vector<PairLossRow> loss_rows(const ThesisSources& sources,
                                   const std::vector<PairLossModel>& models) {
  std::vector<PairLossRow> rows;
  rows.reserve(sources.measured.size());
  for (const MeasuredPairLoss& m : sources.measured)
    rows.push_back({.measured = m, .predicted = {}});
  for (const PairLossModel& model : models) {
    const Eigen::VectorXd losses = predicted(model, parts_of(sources, model.friction));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      rows[k].predicted.push_back(losses[static_cast<Eigen::Index>(k)]);
    }
  }
  return rows;
}

}  // namespace gear3k::papers
