#include "papers/published_fits.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "report/display.hpp"

namespace gear3k::papers {

using backlash::LostMotionModel;
using design::Design, design::Direction, design::Evaluation;
using efficiency::LossModel;

namespace {

using report::or_nan;

double lost_motion(const Evaluation& e, LostMotionModel model) {
  return model == LostMotionModel::kPaper ? e.lost_motion.paper_rad : e.lost_motion.kinematic_rad;
}

std::string model_name(LossModel model) {
  return std::string(efficiency::kLossModelNames[static_cast<std::size_t>(model)]);
}

}  // namespace

Evaluation evaluated(const Design& design) {
  auto result = design::evaluate(design);
  if (const auto* undefined = std::get_if<design::NotDefined>(&result)) {
    throw std::invalid_argument(fmt::format("{}: {}", design.name, undefined->message));
  }
  return std::get<Evaluation>(std::move(result));
}

Design with_friction(Design design, double mu, LossModel model) {
  design.friction = {.coefficient = mu, .model = model};
  return design;
}

Design with_allowance(Design design, double q) {
  design.train.machining_allowance.fill(q);
  return design;
}

Design at_distance(Design design, double center_distance_m) {
  design.train.center_distance_m = center_distance_m;
  design.center_distance_given = true;
  return design;
}

std::optional<double> explaining_allowance(const Design& design, double lost_motion_rad,
                                           LostMotionModel model) {
  return root_of_increasing(
      [&](double q) {
        return lost_motion(evaluated(with_allowance(design, q)), model) - lost_motion_rad;
      },
      0.0, 1.0);
}

double efficiency_at(const Design& design, double mu, LossModel model, Direction direction) {
  const Evaluation e = evaluated(with_friction(design, mu, model));
  return or_nan(direction == Direction::kForward ? e.efficiency.forward : e.efficiency.backward);
}

std::optional<double> fitted_friction(const Design& design, LossModel model, Direction direction,
                                      double efficiency) {
  return root_of_increasing(
      [&](double mu) { return efficiency - efficiency_at(design, mu, model, direction); }, 0.0,
      0.5);
}

namespace {

/// Loss model `directional` with friction (1 + a) mu in approach and (1 - a) mu in recess; a = -1,
/// 1: all of it on one side of the pitch point.
class AsymmetricFriction {
 public:
  explicit AsymmetricFriction(const PublishedGearbox& gearbox) : gearbox_(gearbox) {}

  /// mu with which it gives the measured forward efficiency.
  [[nodiscard]] std::optional<double> forward_mu(double a) const {
    return root_of_increasing(
        [&](double mu) { return *gearbox_.measured_forward - or_nan(efficiency(mu, a).forward); },
        0.0, 0.5);
  }
  /// Backward efficiency with that mu.
  [[nodiscard]] std::optional<double> backward(double a) const {
    const auto mu = forward_mu(a);
    return mu ? efficiency(*mu, a).backward : std::nullopt;
  }

 private:
  [[nodiscard]] design::EfficiencyResult efficiency(double mu, double a) const {
    Design design = with_friction(gearbox_.design, mu, LossModel::kDirectional);
    design.friction.approach_factor = 1.0 + a;
    design.friction.recess_factor = 1.0 - a;
    return evaluated(design).efficiency;
  }
  const PublishedGearbox& gearbox_;
};

}  // namespace

FrictionFit friction_fit(const PublishedGearbox& gearbox, LossModel model) {
  FrictionFit fit{
      .model = model_name(model),
      .measured_forward = *gearbox.measured_forward,
      .measured_backward = *gearbox.measured_backward,
      .mu = fitted_friction(gearbox.design, model, Direction::kForward, *gearbox.measured_forward),
      .backward_mu =
          fitted_friction(gearbox.design, model, Direction::kBackward, *gearbox.measured_backward),
      .backward = {}};
  if (fit.mu) fit.backward = efficiency_at(gearbox.design, *fit.mu, model, Direction::kBackward);
  return fit;
}

std::optional<DirectionalFit> directional_fit(const PublishedGearbox& gearbox) {
  const AsymmetricFriction friction(gearbox);
  const auto excess = [&](double a) {
    return or_nan(friction.backward(a)) - *gearbox.measured_backward;
  };
  std::optional<double> a = root_of_increasing(excess, -1.0, 1.0);
  if (!a) a = root_of_increasing([&](double x) { return -excess(x); }, -1.0, 1.0);
  if (!a) return std::nullopt;
  return DirectionalFit{
      .mu = *friction.forward_mu(*a), .approach_factor = 1.0 + *a, .recess_factor = 1.0 - *a};
}

std::optional<double> recess_only_backward(const PublishedGearbox& gearbox) {
  return AsymmetricFriction(gearbox).backward(-1.0);
}

}  // namespace gear3k::papers
