#include "motion/motion_gear.hpp"

#include <cmath>

#include "actuator/chain.hpp"

namespace gear3k::motion {

namespace {

/// What rounding may make of a difference of torques, as a share of its terms.
constexpr double kRoundingShare = 1e-11;
/// Keeps the flow where there is no torque at all.
constexpr double kNoTorqueAtAll = 1e-300;

/// A gearbox by catalogue values: equations in closed form, docs/theory §66.
class CatalogueMotion : public MotionGear {
 public:
  CatalogueMotion(const actuator::Actuator& actuator, double load_kgm2)
      : chain_(chain_of(actuator)) {
    chain_.j2_kgm2 += load_kgm2;
  }

  [[nodiscard]] const std::vector<std::string>& causes() const override { return causes_; }

  [[nodiscard]] Joint joined(const JointInput& in) const override {
    const double j1 = chain_.j1_kgm2;
    const double j2 = chain_.j2_kgm2;
    const double friction = in.sense * (in.starting ? chain_.c2_static_Nm : chain_.c2_Nm);
    const double viscous = chain_.d2_Nms * in.speed_rad_s;
    const double output = in.load_Nm - viscous - friction;
    Joint r;
    r.lead = j2 * in.fast_Nm - j1 * output;
    r.lead_rounding =
        kNoTorqueAtAll +
        kRoundingShare * (j2 * in.fast_scale_Nm +
                          j1 * (std::abs(in.load_Nm) + std::abs(viscous) + std::abs(friction)));
    const int flow = in.flow != 0 ? in.flow : in.sense * r.lead >= 0.0 ? 1 : -1;
    if (flow > 0) {
      const double forward = chain_.efficiency_forward;
      r.acceleration_rad_s2 = (forward * in.fast_Nm + output) / (forward * j1 + j2);
    } else {
      const double inertia = j1 + chain_.efficiency_backward * j2;
      r.jammed = !(inertia > 0.0);
      if (r.jammed) return r;
      r.acceleration_rad_s2 = (in.fast_Nm + chain_.efficiency_backward * output) / inertia;
    }
    r.mesh_Nm = j2 * r.acceleration_rad_s2 - output;
    r.input_Nm = in.fast_Nm - j1 * r.acceleration_rad_s2;
    r.loss_W = {friction * in.speed_rad_s, viscous * in.speed_rad_s,
                (r.input_Nm - r.mesh_Nm) * in.speed_rad_s};
    return r;
  }

  [[nodiscard]] double breakaway_excess_nm(const JointInput& in) const override {
    const double friction = in.sense * (in.starting ? chain_.c2_static_Nm : chain_.c2_Nm);
    return in.sense * (in.fast_Nm - mesh_input(chain_, friction - in.load_Nm, in.sense));
  }

  [[nodiscard]] FreeSide fast_alone(const FreeInput& in) const override {
    return {.acceleration_rad_s2 = in.torque_Nm / chain_.j1_kgm2};
  }

  [[nodiscard]] FreeSide output_alone(const FreeInput& in) const override {
    const double friction = in.sense * (in.starting ? chain_.c2_static_Nm : chain_.c2_Nm);
    const double viscous = chain_.d2_Nms * in.speed_rad_s;
    return {.acceleration_rad_s2 = (in.torque_Nm - friction - viscous) / chain_.j2_kgm2,
            .loss_W = {friction * in.speed_rad_s, viscous * in.speed_rad_s}};
  }

  [[nodiscard]] double speed_after_contact(const std::array<double, 2>& speeds) const override {
    const auto [fast, output] = speeds;
    const double side = fast > output ? 1.0 : -1.0;  // the sign of the impulse on the output
    const double given = chain_.efficiency_forward * chain_.j1_kgm2;
    const double forward = (given * fast + chain_.j2_kgm2 * output) / (given + chain_.j2_kgm2);
    if (side * forward > 0.0) return forward;
    const double taken = chain_.efficiency_backward * chain_.j2_kgm2;
    if (!(chain_.j1_kgm2 + taken > 0.0)) return 0.0;
    const double backward = (chain_.j1_kgm2 * fast + taken * output) / (chain_.j1_kgm2 + taken);
    return side * backward < 0.0 ? backward : 0.0;
  }

  [[nodiscard]] std::array<double, 2> inertias_kgm2() const override {
    return {chain_.j1_kgm2, chain_.j2_kgm2};
  }

 private:
  actuator::Chain chain_;
  std::vector<std::string> causes_{"gear_coulomb", "gear_viscous", "mesh"};
};

}  // namespace

std::unique_ptr<MotionGear> motion_gear(const actuator::Actuator& actuator, double load_kgm2) {
  if (actuator.train != nullptr) return motion_train(actuator, load_kgm2);
  return std::make_unique<CatalogueMotion>(actuator, load_kgm2);
}

}  // namespace gear3k::motion
