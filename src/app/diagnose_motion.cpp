#include "app/diagnose_motion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "actuator/chain.hpp"
#include "calibrate/dynamic/motion_readings.hpp"
#include "calibrate/dynamic/windup.hpp"
#include "io/files/actuator_file.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/printable.hpp"
#include "numerics/square.hpp"

namespace gear3k::app {

namespace {

using calibrate::DriveParameters, calibrate::MotionDiagnosis, calibrate::MotionWindow;

DriveParameters drive_of(const actuator::Actuator& a, const actuator::Chain& chain) {
  return {.motor_inertia_kgm2 = chain.j1_kgm2,
          .motor_viscous_Nms = chain.d1_Nms,
          .motor_coulomb_Nm = chain.c1_Nm,
          .output_inertia_kgm2 = chain.j2_kgm2 - a.load_inertia_kgm2,
          .output_viscous_Nms = chain.d2_Nms,
          .output_coulomb_Nm = chain.c2_Nm,
          .efficiency_forward = chain.efficiency_forward,
          .efficiency_backward = chain.efficiency_backward};
}

/// Squares of what is left of the windows with either sign of a term.
struct SignSquares {
  double as_logged = 0.0, motor_reversed = 0.0, load_reversed = 0.0;
};

SignSquares sign_squares(const std::vector<MotionWindow>& windows, const DriveParameters& drive) {
  SignSquares r;
  for (const MotionWindow& w : windows) {
    const auto beta = calibrate::drive_coefficients(drive, w.flow, w.load_kgm2);
    const double load = beta[3] * w.term[3];
    const double own = beta[0] * w.term[0] + beta[1] * w.term[1] + beta[2] * w.term[2];
    r.as_logged += numerics::square(w.motor_Nm - own - load);
    r.motor_reversed += numerics::square(-w.motor_Nm - own - load);
    r.load_reversed += numerics::square(w.motor_Nm - own + load);
  }
  return r;
}

/// Whether the motor's torque changes in the log.
bool torque_varies(const std::vector<MotionWindow>& windows) {
  constexpr double kLeastShare = 1e-6;  // of its mean square
  double mean = 0.0, mean_square = 0.0;
  for (const MotionWindow& w : windows) {
    const double torque = w.motor_Nm / w.term[4], share = 1.0 / static_cast<double>(windows.size());
    mean += share * torque;
    mean_square += share * torque * torque;
  }
  return mean_square - mean * mean > kLeastShare * mean_square;
}

/// A sign is wrong where the other one leaves less than a quarter of the squares.
void refuse_unfit(const std::vector<MotionWindow>& windows, const DriveParameters& drive,
                  const std::string& files) {
  constexpr double kClearly = 0.25;
  if (!windows.empty() && !torque_varies(windows)) {
    throw io::InvalidInput(fmt::format(
        "{}: the motor's torque does not change: allowed: logs of several speeds, loads "
        "or accelerations",
        files));
  }
  const SignSquares s = sign_squares(windows, drive);
  if (s.motor_reversed < kClearly * s.as_logged && s.motor_reversed < s.load_reversed) {
    throw io::InvalidInput(fmt::format(
        "{}: the motor's torque acts against the motion that it makes: allowed: the sign of "
        "gearbox.ratio, by which a positive one turns the output forward",
        files));
  }
  if (s.load_reversed < kClearly * s.as_logged) {
    throw io::InvalidInput(
        fmt::format("{}: output_torque_nm has the other sign: allowed: that of the load on the "
                    "output, or the note \"# torque: actuator\"",
                    files));
  }
}

/// The stated actuator with what the logs have found; what no effect changes stays to the last bit.
actuator::Actuator found_actuator(const actuator::Actuator& stated, const DriveParameters& drive,
                                  const MotionDiagnosis& d) {
  actuator::Actuator a = stated;
  const DriveParameters& f = d.drive;
  const double i = std::abs(a.gearbox.ratio);
  const auto add = [](double& value, double more) { value = std::max(0.0, value + more); };
  // What is found is of both inertias of the fast side; the rotor takes it as far as it goes.
  const double fast = (f.motor_inertia_kgm2 - drive.motor_inertia_kgm2) / (i * i);
  const double gears = std::min(0.0, fast + a.motor.rotor_inertia_kgm2);
  add(a.motor.rotor_inertia_kgm2, fast);
  add(a.gearbox.input_inertia_kgm2, gears);
  add(a.motor.viscous_Nms, (f.motor_viscous_Nms - drive.motor_viscous_Nms) / (i * i));
  add(a.motor.coulomb_Nm, (f.motor_coulomb_Nm - drive.motor_coulomb_Nm) / i);
  a.motor.static_Nm += a.motor.coulomb_Nm - stated.motor.coulomb_Nm;
  a.motor.torque_constant_Nm_A *= f.torque_gain;
  add(a.gearbox.output_inertia_kgm2, f.output_inertia_kgm2 - drive.output_inertia_kgm2);
  add(a.gearbox.viscous_Nms, f.output_viscous_Nms - drive.output_viscous_Nms);
  add(a.gearbox.coulomb_Nm, f.output_coulomb_Nm - drive.output_coulomb_Nm);
  a.gearbox.static_Nm += a.gearbox.coulomb_Nm - stated.gearbox.coulomb_Nm;
  const bool losses = std::ranges::any_of(d.effects, [](const calibrate::MotionEffect& e) {
    return e.cause == calibrate::kLevelChange || e.cause == calibrate::kDirectionChange;
  });
  if (losses) {
    a.gearbox.efficiency_forward = std::min(1.0, f.efficiency_forward);
    a.gearbox.efficiency_backward = std::min(1.0, f.efficiency_backward);
  }
  for (const calibrate::MotionEffect& e : d.effects) {
    if (e.cause == calibrate::kClearanceChange) {
      a.gearbox.backlash_rad =
          std::max(0.0, a.gearbox.backlash_rad.value_or(0.0) + e.estimate.value);
    } else if (e.cause == calibrate::kComplianceChange) {
      const double before = a.gearbox.stiffness_Nm_rad ? 1.0 / *a.gearbox.stiffness_Nm_rad : 0.0;
      const double compliance = before + e.estimate.value;
      a.gearbox.stiffness_Nm_rad =
          compliance > 0.0 ? std::optional(1.0 / compliance) : std::nullopt;
    }
  }
  return a;
}

/// The text of found_actuator(); of the stated one, with a note, where no ACTUATOR can have what
/// was found.
std::string model_of(const actuator::Actuator& stated, const DriveParameters& drive,
                     const std::string& files, MotionDiagnosis& d) {
  const auto text = [&](const actuator::Actuator& a, const char* what) {
    return fmt::format("# {} {} gear3k diagnose found in {}\n{}",
                       io::printable(a.name.empty() ? "actuator" : a.name), what,
                       io::printable(files), io::actuator_text(a));
  };
  std::string found = text(found_actuator(stated, drive, d), "with what");
  try {
    static_cast<void>(io::parse_actuator(found, "model.toml"));
    return found;
  } catch (const io::InvalidInput&) {
    d.notes.emplace_back(
        "no ACTUATOR can have the numbers that were found: model.toml has the stated ones");
    return text(stated, "as stated, without what");
  }
}

void require_catalogue_values(const DiagnoseMotionRequest& request) {
  if (request.actuator.train == nullptr) return;
  throw io::InvalidInput(
      fmt::format("{}: gearbox.design: logs of motion are diagnosed for a gearbox by catalogue "
                  "values: allowed: ratio, efficiency_forward and efficiency_backward, as gear3k "
                  "analyze prints them for the design",
                  request.source));
}

}  // namespace

io::MotionLogScale log_scale(const actuator::Actuator& actuator) {
  return {.ratio = actuator.gearbox.ratio,
          .torque_constant_Nm_A = actuator.motor.torque_constant_Nm_A,
          .load_kgm2 = actuator.load_inertia_kgm2};
}

report::MotionDiagnosisResult diagnose_motion(const DiagnoseMotionRequest& request) {
  require_catalogue_values(request);
  return diagnose_motion(request, io::read_motion_logs(request.data, log_scale(request.actuator)));
}

report::MotionDiagnosisResult diagnose_motion(const DiagnoseMotionRequest& request,
                                              const calibrate::MotionRecord& record) {
  require_catalogue_values(request);
  const actuator::Actuator& a = request.actuator;
  const actuator::Chain chain = actuator::chain_of(a);
  report::MotionDiagnosisResult result;
  result.subject = a.name;
  result.ratio = chain.ratio;
  result.files = record.files;
  const DriveParameters drive = drive_of(a, chain);
  const std::string files = fmt::format("{}", fmt::join(record.files, ", "));
  refuse_unfit(calibrate::motion_windows(record, drive), drive, files);
  const bool both_sides = std::ranges::any_of(
      record.stretches, [](const auto& stretch) { return !stretch.windup_rad.empty(); });
  // One rate for all causes that the log can show.
  const double share = both_sides ? static_cast<double>(calibrate::kDriveChanges) /
                                        static_cast<double>(calibrate::kMotionCauses)
                                  : 1.0;
  auto found = calibrate::diagnose_motion(
      record, drive, {.false_discovery_rate = share * request.false_discovery_rate});
  if (!found) {
    throw io::InvalidInput(fmt::format(
        "{}: too few stretches of 12 samples and more in one sense and one flow of power: allowed: "
        "at least 16 (log for longer, faster, or slower motions)",
        files));
  }
  result.diagnosis = std::move(*found);
  if (both_sides) {
    const calibrate::StatedWindup stated{
        .play_rad = a.gearbox.backlash_rad.value_or(0.0),
        .compliance_rad_Nm = a.gearbox.stiffness_Nm_rad ? 1.0 / *a.gearbox.stiffness_Nm_rad : 0.0};
    const auto windup =
        calibrate::diagnose_windup(result.diagnosis.rows, result.diagnosis.drive, stated,
                                   (1.0 - share) * request.false_discovery_rate);
    if (windup) {
      calibrate::add_windup(*windup, stated, result.diagnosis);
    } else {
      result.diagnosis.notes.emplace_back(
          "both sides are logged, but too few stretches have a clear torque: neither play nor "
          "compliance can be known");
    }
  }
  result.readings = calibrate::motion_readings(record, result.diagnosis.drive,
                                               result.diagnosis.rows, chain.ratio);
  auto& notes = result.diagnosis.notes;
  result.model = model_of(a, drive, files, result.diagnosis);
  notes.insert(notes.begin(), record.notes.begin(), record.notes.end());
  return result;
}

}  // namespace gear3k::app
