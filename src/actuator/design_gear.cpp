#include "actuator/design_gear.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <variant>

#include "backlash/lost_motion.hpp"
#include "design/evaluation.hpp"
#include "design/mass_model.hpp"

namespace gear3k::actuator {

namespace {

using design::TrainInstant;

design::MovingTrain moving(const DesignTrain& train) {
  return {.lossy = {.geometry = train.geometry(),
                    .friction = train.friction,
                    .shafts = train.shafts,
                    .face_width_m = train.face_width_m()},
          .bodies = train.bodies,
          .lossless_mesh = train.lossless_mesh};
}

/// By design_gear_causes().
std::array<double, kMostGearLosses> losses_of(const TrainInstant& t) {
  std::array<double, kMostGearLosses> loss_W{};
  std::size_t k = 0;
  for (const double loss : t.mesh_loss_W) loss_W[k++] = loss;
  loss_W[k++] = t.bearing_loss_W;
  for (const double loss : t.drag_loss_W) loss_W[k++] = loss;
  return loss_W;
}

/// The design, or why it has no teeth that run.
const design::Design& defined(const design::Design& design) {
  if (const auto undefined = design::why_undefined(design)) {
    throw std::invalid_argument(undefined->message);
  }
  return design;
}

class DesignGear : public GearModel {
 public:
  explicit DesignGear(const Actuator& actuator)
      : train_(actuator.train),
        prepared_(moving(*train_)),
        load_kgm2_(actuator.load_inertia_kgm2),
        linear_(prepared_.is_linear()) {}

  [[nodiscard]] const std::vector<std::string>& causes() const override {
    return design_gear_causes();
  }
  [[nodiscard]] GearInstant at(const OutputMotion& o) const override {
    const TrainInstant t = instant(o);
    return {.mesh_Nm = o.sense * t.ring2_mesh_Nm,
            .input_Nm = o.sense * train_->ratio() * t.sun_torque_Nm,
            .loss_W = losses_of(t)};
  }
  void append_flow_changes(const CyclePiece& piece, std::array<double, 2> range, double sense,
                           std::vector<double>& roots) const override {
    double before = range[0];
    auto pattern = pattern_at(piece, before, sense);
    // Between ends of one pattern torques are straight lines of one sign.
    if (linear_ && piece.speed_rad_s[2] == 0.0 && pattern_at(piece, range[1], sense) == pattern) {
      return;
    }
    constexpr int kSamples = 4;
    for (int k = 1; k <= kSamples; ++k) {
      const double x = range[0] + (range[1] - range[0]) * k / kSamples;
      const auto now = pattern_at(piece, x, sense);
      // More than one mesh may change within a stretch.
      for (double from = before; pattern != now;) {
        const double at = change_between(piece, from, x, sense);
        roots.push_back(at);
        pattern = pattern_at(piece, at, sense);
        if (!(at > from)) break;
        from = at;
      }
      before = x;
      pattern = now;
    }
  }
  [[nodiscard]] RestBand band(double load_Nm) const override {
    return {.low_Nm = resting_input(load_Nm, -1.0), .high_Nm = resting_input(load_Nm, 1.0)};
  }
  [[nodiscard]] bool constant_efficiencies() const override { return linear_; }
  /// Where the flow of a mesh changes its direction, about to move either way.
  void append_band_kinks(const CyclePiece& piece, std::vector<double>& places) const override {
    for (const double sense : {-1.0, 1.0}) append_flow_changes(piece, {0.0, 1.0}, sense, places);
  }
  [[nodiscard]] double inertia_kgm2() const override { return train_->inertia_kgm2() + load_kgm2_; }

 private:
  using Pattern = std::array<bool, train::kMeshCount>;

  [[nodiscard]] TrainInstant instant(const OutputMotion& o) const {
    const double outside = o.load_Nm - load_kgm2_ * o.acceleration_rad_s2;
    const auto result =
        prepared_.balance({.output_speed_rad_s = std::abs(o.speed_rad_s),
                           .output_acceleration_rad_s2 = o.sense * o.acceleration_rad_s2,
                           .given_end = train::End::kOutput,
                           .given_torque_Nm = o.sense * outside,
                           .temperature_K = train_->temperature_k(),
                           .least_friction_speed_rad_s = train_->least_friction_speed_rad_s});
    if (result.instant) return *result.instant;
    const bool no_friction = result.reason == design::NoOperation::kNoFriction;
    throw std::runtime_error(fmt::format(
        "{} at {:g} rad/s and {:g} N m of the load at the output: {}{}", train_->name(),
        o.speed_rad_s, o.load_Nm, design::no_operation_text(result.reason),
        no_friction ? "; gearbox.least_friction_speed_rad_s gives it one near rest" : ""));
  }
  [[nodiscard]] Pattern pattern_at(const CyclePiece& piece, double x, double sense) const {
    return instant(motion_at(piece, x, sense)).gear1_drives;
  }
  /// The first change of who drives after x0, which differs from x1; its later end to rounding.
  [[nodiscard]] double change_between(const CyclePiece& piece, double x0, double x1,
                                      double sense) const {
    const Pattern first = pattern_at(piece, x0, sense);
    double low = x0;
    double high = x1;
    constexpr int kHalvings = 50;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (low + high);
      (pattern_at(piece, middle, sense) == first ? low : high) = middle;
    }
    return high;
  }
  [[nodiscard]] double resting_input(double load_Nm, double sense) const {
    return sense * train_->ratio() * instant({.load_Nm = load_Nm, .sense = sense}).sun_torque_Nm;
  }

  std::shared_ptr<const DesignTrain> train_;
  design::PreparedTrain prepared_;
  double load_kgm2_;
  bool linear_;
};

}  // namespace

DesignTrain::DesignTrain(const design::Design& design)
    : shafts(defined(design).shafts),
      friction(design.friction),
      name_(design.name),
      geometry_(*train::make_train_geometry(design::resolved_parameters(design))),
      temperature_K_(design.operating_point ? design.operating_point->temperature_K
                                            : design::OperatingPoint<double>{}.temperature_K) {
  const design::LossyTrain<double> lossy = design::lossy_train(design, geometry_);
  face_width_m_ = lossy.face_width_m;
  const design::MassModel masses = design::mass_model(design.masses, geometry_);
  mass_kg_ = masses.total_mass_kg;
  if (masses.bodies) {
    bodies = *masses.bodies;
    counts_carrier_ = masses.counts_carrier;
  } else {
    inertia_missing_ = masses.bodies_missing;
  }
  const auto evaluated = design::evaluate(design);
  const auto* evaluation = std::get_if<design::Evaluation>(&evaluated);
  if (evaluation == nullptr) return;
  for (const design::CheckResult& check : evaluation->checks) {
    if (!check.ok && std::ranges::find(failed_, check.record->title) == failed_.end()) {
      failed_.push_back(check.record->title);
    }
  }
  if (!evaluation->strength) return;
  if (const auto& stiffness = evaluation->strength->backward.stiffness) {
    stiffness_Nm_rad_ = stiffness->output_Nm_rad;
  }
}

double DesignTrain::ratio() const { return train::speed_ratios(geometry_.teeth).sun; }

double DesignTrain::backlash_rad() const {
  return std::max(0.0,
                  backlash::output_lost_motion(geometry_, backlash::normal_backlashes(geometry_),
                                               backlash::LostMotionModel::kKinematic));
}

double DesignTrain::inertia_kgm2() const {
  return inertia::lossless_inertia<double>({.teeth = geometry_.teeth,
                                            .planets = geometry_.planets,
                                            .center_distance_m = geometry_.center_distance_m,
                                            .bodies = bodies});
}

std::vector<std::string> notes_of(const DesignTrain& train) {
  std::vector<std::string> notes;
  if (!train.failed_checks().empty()) {
    notes.push_back(fmt::format("{} fails checks of `gear3k analyze`: {}", train.name(),
                                fmt::join(train.failed_checks(), "; ")));
  }
  if (!train.inertia_missing().empty()) {
    notes.push_back(fmt::format("the gears of {} have no inertia: it lacks {}", train.name(),
                                train.inertia_missing()));
  } else if (!train.counts_carrier()) {
    notes.push_back(fmt::format("{}: {}", train.name(), design::kCarrierNotCounted));
  }
  return notes;
}

const std::vector<std::string>& design_gear_causes() {
  static const std::vector<std::string> causes = [] {
    std::vector<std::string> names{"S-P1", "P1-R1", "P2-R2", "bearing"};
    for (const std::string_view shaft : design::kShaftNames) {
      names.push_back("drag_" + std::string(shaft));
    }
    return names;
  }();
  return causes;
}

std::shared_ptr<const DesignTrain> without(const DesignTrain& train, const std::string& cause) {
  auto changed = std::make_shared<DesignTrain>(train);
  if (cause == "inertia") {
    changed->bodies = {};
  } else if (cause == "bearing") {
    changed->shafts.planet_bearing_coefficient = 0.0;
    changed->shafts.output_bearing_share = 0.0;
    changed->shafts.output_bearing_growth = {};
  } else if (cause.starts_with("drag_")) {
    const auto* const shaft = std::ranges::find(design::kShaftNames, cause.substr(5));
    changed->shafts.drag[static_cast<std::size_t>(shaft - design::kShaftNames.begin())] = {};
  } else {
    const auto& causes = design_gear_causes();
    const auto mesh = std::ranges::find(causes, cause) - causes.begin();
    changed->lossless_mesh[static_cast<std::size_t>(mesh)] = true;
  }
  return changed;
}

std::unique_ptr<GearModel> design_gear(const Actuator& actuator) {
  return std::make_unique<DesignGear>(actuator);
}

design::PreparedTrain prepared(const DesignTrain& train) {
  return design::PreparedTrain(moving(train));
}

std::optional<GearInstant> moved_from_output(const design::PreparedTrain& prepared,
                                             const DesignTrain& train, const OutputMotion& motion,
                                             double input_Nm) {
  const auto result =
      prepared.balance({.output_speed_rad_s = std::abs(motion.speed_rad_s),
                        .output_acceleration_rad_s2 = motion.sense * motion.acceleration_rad_s2,
                        .given_end = train::End::kSun,
                        .given_torque_Nm = motion.sense * input_Nm / train.ratio(),
                        .temperature_K = train.temperature_k(),
                        .least_friction_speed_rad_s = train.least_friction_speed_rad_s});
  if (!result.instant) return std::nullopt;
  return GearInstant{.mesh_Nm = -motion.sense * result.instant->output_torque_Nm,
                     .input_Nm = input_Nm,
                     .loss_W = losses_of(*result.instant)};
}

std::optional<double> output_torque(const DesignTrain& train, const OutputMotion& motion,
                                    double input_Nm) {
  const auto moved = moved_from_output(prepared(train), train, motion, input_Nm);
  if (!moved) return std::nullopt;
  return moved->mesh_Nm;
}

}  // namespace gear3k::actuator
