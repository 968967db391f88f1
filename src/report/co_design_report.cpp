#include "report/co_design_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "io/text/printable.hpp"
#include "report/actuator_report.hpp"
#include "report/selection_report.hpp"
#include "report/text_table.hpp"
#include "units/units.hpp"

namespace gear3k::report {

namespace {

std::vector<std::string_view> names_of_unknown(const CoDesignMotor& motor) {
  std::vector<std::string_view> names;
  for (const actuator::Unknown what : motor.unknown) {
    names.push_back(actuator::kUnknownNames[static_cast<std::size_t>(what)]);
  }
  return names;
}

/// Six digits, downwards.
double rounded_down(double value) {
  if (value == 0.0) return value;
  const double power = std::pow(10.0, 5.0 - std::floor(std::log10(std::abs(value))));
  return std::floor(value * power) / power;
}

io::Json motor_json(const CoDesignMotor& motor) {
  const actuator::PairResult& r = motor.result;
  io::Json json{
      {"motor", motor.name},
      {"energy_j", r.energy_J},
      {"rms_current_a", r.rms_current_A},
      {"peak_current_a", r.peak_current_A},
      {"peak_voltage_v", r.peak_voltage_V},
      {"peak_motor_speed_rad_s", r.peak_motor_speed_rad_s},
      {"winding_c", r.winding_K ? io::Json(units::from_si(*r.winding_K, units::Unit::kCelsius))
                                : io::Json(nullptr)},
      {"unknown", names_of_unknown(motor)}};
  if (r.felt) {
    json["felt"] = {{"inertia_kgm2", r.felt->inertia_kgm2},
                    {"breakaway_nm", r.felt->breakaway_Nm},
                    {"transparency",
                     r.felt->transparency ? io::Json(*r.felt->transparency) : io::Json(nullptr)}};
  }
  return json;
}

}  // namespace

io::Json co_design_json(const CoDesignReport& report) {
  io::Json next = io::Json::array();
  for (std::size_t k = 1; k < report.motors.size(); ++k) {
    next.push_back(motor_json(report.motors[k]));
  }
  io::Json json = motor_json(report.motors.front());
  json["run_energy_j"] = report.run_J;
  json["gear_inertia"] = report.gear_inertia;
  json["bound_j"] = report.bound_J;
  json["motors"] = report.motors_considered;
  json["cycles"] = report.cycles;
  json["peak_torque_nm"] = report.peak_torque_Nm;
  json["rms_torque_nm"] = report.rms_torque_Nm;
  json["next"] = std::move(next);
  return json;
}

std::string co_design_table(const CoDesignReport& report) {
  std::string text =
      fmt::format("\nMotor, of {}, for {}:\n", report.motors_considered,
                  report.cycles == 1 ? "one cycle" : fmt::format("{} cycles", report.cycles));
  TextTable table(
      {"motor", "energy J", "A rms", "A peak", "V peak", "rad/s", "winding C", "not known"});
  for (const CoDesignMotor& motor : report.motors) {
    const actuator::PairResult& r = motor.result;
    table.add(
        {motor.name, fmt::format("{:.6g}", r.energy_J), fmt::format("{:.4g}", r.rms_current_A),
         fmt::format("{:.4g}", r.peak_current_A), fmt::format("{:.4g}", r.peak_voltage_V),
         fmt::format("{:.4g}", r.peak_motor_speed_rad_s),
         r.winding_K ? fmt::format("{:.1f}", units::from_si(*r.winding_K, units::Unit::kCelsius))
                     : "-",
         fmt::format("{}", fmt::join(names_of_unknown(motor), " "))});
  }
  text += table.text(0);
  text += limit_checks_text(report.felt_checks);
  if (report.bound_J) {
    text += fmt::format(
        "No motor of these with any back-drivable gearbox of this task needs less than {:.6g} "
        "J, {} the inertia of its gears\n",
        rounded_down(*report.bound_J), report.gear_inertia ? "with" : "without");
  }
  if (!report.gear_inertia) {
    text +=
        "Face widths, densities and size.ring_rim_mm are not all stated: the gears run without "
        "inertia\n";
  }
  text +=
      fmt::format("Cycles: {:.4g} N m at most, {:.4g} N m rms; {}\n", report.peak_torque_Nm,
                  report.rms_torque_Nm,
                  report.stated_torque_Nm
                      ? fmt::format("the gearbox is rated for {:g} N m", *report.stated_torque_Nm)
                      : "what the gearbox carries is not stated ([strength])");
  return text;
}

std::string no_motor_text(const actuator::CoDesign& co_design, std::size_t gearboxes,
                          const actuator::PairResult& nearest) {
  const auto& task = co_design.task();
  const std::string gears =
      gearboxes > 0 ? fmt::format("any of the {} gearboxes that were refined", gearboxes)
                    : "even a gearbox without losses, of any ratio of this task,";
  return fmt::format(
      "no feasible design: none of {} motors drives {} within its limits: the nearest, {}, exceeds "
      "{}{}",
      task.motors.size(), gears, io::printable(task.motors[nearest.pair.motor].name),
      nearest.limit ? actuator::kPairLimitNames[static_cast<std::size_t>(*nearest.limit)]
                    : "no limit",
      excess_text(nearest.excess));
}

}  // namespace gear3k::report
