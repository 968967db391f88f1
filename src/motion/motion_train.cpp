// A designed train between the two sides: its torques are solved for at every instant.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "actuator/design_gear.hpp"
#include "motion/motion_gear.hpp"

namespace gear3k::motion {

namespace {

using actuator::DesignTrain, actuator::GearInstant, actuator::GearModel, actuator::OutputMotion;

/// A torque and what it is of an acceleration.
struct Balance {
  double acceleration = 0.0;
  GearInstant gear{};
};

/// J a + u(a) = given, by secants within what is known to hold the root.
class TorqueBalance {
 public:
  TorqueBalance(const GearModel& gear, double fast_kgm2, double given_Nm)
      : gear_(gear), fast_kgm2_(fast_kgm2), given_Nm_(given_Nm) {}

  /// @param motion_of  of the output at an acceleration
  /// @returns empty where the train locks or the sum does not grow with the acceleration
  template <class MotionOf>
  std::optional<Balance> solve(const MotionOf& motion_of, double guess, double scale_Nm) const {
    try {
      return secants(motion_of, guess, scale_Nm);
    } catch (const std::runtime_error&) {
      return std::nullopt;
    }
  }

 private:
  template <class MotionOf>
  std::optional<Balance> secants(const MotionOf& motion_of, double guess, double scale_Nm) const {
    constexpr int kTries = 100;
    constexpr double kStep = 1e-3;
    const double close = 4.0 * std::numeric_limits<double>::epsilon() * scale_Nm;
    Balance at{.acceleration = guess};
    const auto excess = [&](double acceleration) {
      at.acceleration = acceleration;
      at.gear = gear_.at(motion_of(acceleration));
      return fast_kgm2_ * acceleration + at.gear.input_Nm - given_Nm_;
    };
    double x0 = guess;
    double f0 = excess(x0);
    double x1 = guess + kStep * (1.0 + std::abs(guess));
    double f1 = excess(x1);
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    for (int k = 0; k < kTries; ++k) {
      if (!((f1 - f0) * (x1 - x0) > 0.0) && f1 != f0) return std::nullopt;
      (f1 > 0.0 ? high : low) = x1;
      (f0 > 0.0 ? high : low) = f0 > 0.0 ? std::min(high, x0) : std::max(low, x0);
      if (std::abs(f1) <= close || f1 == f0) return at;
      double next = x1 - f1 * (x1 - x0) / (f1 - f0);
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      if (next == x1 || !std::isfinite(next)) return at;
      x0 = x1;
      f0 = f1;
      x1 = next;
      f1 = excess(x1);
    }
    return at;
  }

  const GearModel& gear_;
  double fast_kgm2_, given_Nm_;
};

actuator::Actuator with_load(actuator::Actuator actuator, double load_kgm2) {
  actuator.load_inertia_kgm2 = load_kgm2;
  return actuator;
}

actuator::Actuator without_drag(actuator::Actuator actuator) {
  auto train = std::make_shared<DesignTrain>(*actuator.train);
  train->shafts.drag = {};
  actuator.train = std::move(train);
  return with_load(std::move(actuator), 0.0);
}

class TrainMotion : public MotionGear {
 public:
  TrainMotion(const actuator::Actuator& actuator, double load_kgm2)
      : rotor_kgm2_(chain_of(actuator).j1_kgm2),
        train_kgm2_(actuator.train->inertia_kgm2()),
        load_kgm2_(actuator.load_inertia_kgm2 + load_kgm2),
        has_gap_(actuator.gearbox.backlash_rad.value_or(0.0) > 0.0),
        whole_(gear_model(with_load(actuator, load_kgm2_))),
        bare_(gear_model(with_load(actuator, 0.0))),
        struck_(gear_model(without_drag(actuator))) {}

  [[nodiscard]] const std::vector<std::string>& causes() const override { return whole_->causes(); }

  [[nodiscard]] Joint joined(const JointInput& in) const override {
    const double total = rotor_kgm2_ + train_kgm2_ + load_kgm2_;
    const double scale = in.fast_scale_Nm + std::abs(in.load_Nm);
    const auto balance = TorqueBalance(*whole_, rotor_kgm2_, in.fast_Nm)
                             .solve(
                                 [&](double a) {
                                   return OutputMotion{.speed_rad_s = in.speed_rad_s,
                                                       .acceleration_rad_s2 = a,
                                                       .load_Nm = in.load_Nm,
                                                       .sense = static_cast<double>(in.sense)};
                                 },
                                 (in.fast_Nm + in.load_Nm) / total, scale);
    Joint r;
    r.jammed = !balance;
    if (!balance) return r;
    r.acceleration_rad_s2 = balance->acceleration;
    r.mesh_Nm = balance->gear.mesh_Nm;
    r.input_Nm = balance->gear.input_Nm;
    r.loss_W = balance->gear.loss_W;
    r.lead = has_gap_ ? load_kgm2_ * balance->acceleration - in.load_Nm : r.mesh_Nm;
    constexpr double kHidden = 1e-11;
    constexpr double kLeast = 1e-300;  // keeps the flow where there is no torque at all
    r.lead_rounding = kHidden * scale + kLeast;
    return r;
  }

  [[nodiscard]] double breakaway_excess_nm(const JointInput& in) const override {
    const double sense = in.sense;
    try {
      const GearInstant rest = whole_->at({.load_Nm = in.load_Nm, .sense = sense});
      return sense * (in.fast_Nm - rest.input_Nm);
    } catch (const std::runtime_error&) {
      return -std::numeric_limits<double>::max();
    }
  }

  [[nodiscard]] FreeSide fast_alone(const FreeInput& in) const override {
    const auto balance =
        TorqueBalance(*bare_, rotor_kgm2_, in.torque_Nm)
            .solve(
                [&](double a) {
                  return OutputMotion{.speed_rad_s = in.speed_rad_s,
                                      .acceleration_rad_s2 = a,
                                      .sense = static_cast<double>(in.sense)};
                },
                in.torque_Nm / (rotor_kgm2_ + train_kgm2_), std::abs(in.torque_Nm));
    if (!balance) return {.acceleration_rad_s2 = in.speed_rad_s == 0.0 ? -in.sense : 0.0};
    return {.acceleration_rad_s2 = balance->acceleration, .loss_W = balance->gear.loss_W};
  }

  [[nodiscard]] FreeSide output_alone(const FreeInput& in) const override {
    return {.acceleration_rad_s2 = in.torque_Nm / load_kgm2_};
  }

  [[nodiscard]] double speed_after_contact(const std::array<double, 2>& speeds) const override {
    const auto& [fast, output] = speeds;
    const double total = rotor_kgm2_ + train_kgm2_ + load_kgm2_;
    const double lossless = ((rotor_kgm2_ + train_kgm2_) * fast + load_kgm2_ * output) / total;
    const double of_fast = fast;
    const double of_output = output;
    // Impulses balance as torques do, changes of speed in place of accelerations.
    for (const double sense : {1.0, -1.0}) {
      const auto balance =
          TorqueBalance(*struck_, rotor_kgm2_, 0.0)
              .solve(
                  [&](double change) {
                    const double speed = of_fast + change;
                    return OutputMotion{.speed_rad_s = speed,
                                        .acceleration_rad_s2 = change,
                                        .load_Nm = -load_kgm2_ * (speed - of_output),
                                        .sense = sense};
                  },
                  lossless - of_fast, total * (std::abs(of_fast) + std::abs(of_output)));
      if (!balance) continue;
      const double speed = of_fast + balance->acceleration;
      if (sense * speed > 0.0) return speed;
    }
    return 0.0;
  }

  [[nodiscard]] std::array<double, 2> inertias_kgm2() const override {
    return {rotor_kgm2_ + train_kgm2_, load_kgm2_};
  }

 private:
  double rotor_kgm2_, train_kgm2_, load_kgm2_;
  bool has_gap_;
  std::unique_ptr<GearModel> whole_, bare_, struck_;
};

}  // namespace

std::unique_ptr<MotionGear> motion_train(const actuator::Actuator& actuator, double load_kgm2) {
  return std::make_unique<TrainMotion>(actuator, load_kgm2);
}

}  // namespace gear3k::motion
