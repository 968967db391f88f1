#include "report/actuator_report.hpp"

#include <fmt/format.h>

#include <array>
#include <complex>

#include "io/text/json.hpp"
#include "io/text/printable.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using actuator::DutyCycle, actuator::ImpedancePoint, actuator::LimitCheck, actuator::Reflected;
using io::Json;

Json celsius_json(const std::optional<double>& kelvin) {
  return kelvin ? Json(units::from_si(*kelvin, units::Unit::kCelsius)) : Json();
}

Json reflected_json(const Reflected& r) {
  return {{"inertia_kgm2",
           {{"motor", r.motor_kgm2},
            {"gearbox", r.gearbox_inertia_known ? Json(r.gearbox_kgm2) : Json()},
            {"load", r.load_kgm2},
            {"total", r.total_kgm2},
            {"speeding_up", r.speeding_up_kgm2},
            {"slowing_down", r.slowing_down_kgm2}}},
          {"damping_nms_per_rad",
           {{"motor", r.motor_Nms},
            {"gearbox", r.gearbox_Nms},
            {"total", r.total_Nms},
            {"backdriven", r.backdriven_Nms}}},
          {"coulomb_nm", r.coulomb_Nm},
          {"coulomb_backdriven_nm", r.backdriven_coulomb_Nm},
          {"breakaway_nm", r.breakaway_Nm},
          {"breakaway_motor_nm", r.breakaway_motor_Nm},
          {"stiffness_nm_per_rad",
           {{"motor", r.motor_Nm_rad}, {"gearbox", r.gearbox_Nm_rad}, {"total", r.total_Nm_rad}}}};
}

/// Value, limit and margin in the unit of the result: temperatures in degrees Celsius.
struct ShownCheck {
  std::string unit;
  std::optional<double> value;
  double limit;
};
ShownCheck shown(const LimitCheck& check) {
  if (check.unit != "K") return {.unit = check.unit, .value = check.value, .limit = check.limit};
  ShownCheck result{.unit = "C",
                    .value = check.value,
                    .limit = units::from_si(check.limit, units::Unit::kCelsius)};
  if (result.value) result.value = units::from_si(*result.value, units::Unit::kCelsius);
  return result;
}

Json checks_list(const std::vector<LimitCheck>& checks) {
  Json list = Json::array();
  for (const LimitCheck& check : checks) {
    const ShownCheck s = shown(check);
    list.push_back({{"name", check.name},
                    {"value", s.value},
                    {"limit", s.limit},
                    {"margin", check.margin},
                    {"unit", s.unit},
                    {"ok", check.ok}});
  }
  return list;
}

Json felt_json(const actuator::FeltTorque& felt) {
  return {{"motor_torque_nm", felt.motor_Nm},
          {"moving_with_nm", felt.moving_with_Nm},
          {"pushed_back_nm", felt.pushed_back_Nm},
          {"transparency", felt.transparency}};
}

Json winding_json(const DutyCycle& d) {
  if (!d.winding) return nullptr;
  return {{"runaway", d.winding->runaway},
          {"winding_c", celsius_json(d.winding->winding_K)},
          {"housing_c", celsius_json(d.winding->housing_K)},
          {"winding_j_per_k", d.winding->winding_J_K},
          {"housing_j_per_k", d.winding->housing_J_K}};
}

Json cycle_json(const ActuatorResult& result) {
  const DutyCycle& d = *result.cycle;
  Json losses = Json::object();
  for (const auto& [cause, energy] : d.losses) losses[cause] = energy;
  Json json{{"name", result.cycle_name},
            {"period_s", d.period_s},
            {"periodic", d.periodic},
            {"mechanical_energy_j", {{"positive", d.positive_J}, {"negative", d.negative_J}}},
            {"electrical_energy_j", {{"drawn", d.drawn_J}, {"regenerated", d.regenerated_J}}},
            {"loss_j", losses},
            {"kinetic_j", d.kinetic_J},
            {"balance_error", d.balance_error},
            {"peak_current_a", d.peak_current_A},
            {"rms_current_a", d.rms_current_A},
            {"peak_voltage_v", d.peak_voltage_V},
            {"peak_motor_speed_rad_s", d.peak_motor_speed_rad_s},
            {"peak_motor_torque_nm", d.peak_motor_torque_Nm},
            {"rms_motor_torque_nm", d.rms_motor_torque_Nm}};
  const auto share = [&](double actuator::NegativeShares::*member) {
    return d.shares ? Json((*d.shares).*member) : Json();
  };
  json["backdrivable_fraction_of_negative_power"] = share(&actuator::NegativeShares::backdriven);
  json["motor_braking_fraction"] = share(&actuator::NegativeShares::motor_braking);
  json["regenerating_fraction"] = share(&actuator::NegativeShares::regenerating);
  json["winding_c"] = d.winding ? celsius_json(d.winding->winding_K) : Json();
  json["thermal"] = winding_json(d);
  json["checks"] = checks_list(d.checks);
  json["feasible"] = d.feasible;
  json["notes"] = d.notes;
  if (result.without_each) {
    Json causes = Json::object();
    for (const auto& w : *result.without_each) {
      causes[w.cause] = {
          {"drawn_j", w.drawn_J}, {"regenerated_j", w.regenerated_J}, {"saved_j", w.saved_J}};
    }
    json["without_each"] = causes;
  }
  return json;
}

Json complex_json(const std::optional<std::complex<double>>& z) {
  if (!z) return nullptr;
  return {{"real", z->real()}, {"imaginary", z->imag()}};
}

constexpr std::array<const char*, 3> kTerminalNames{"open", "shorted", "locked"};

Json causes_json(const std::vector<actuator::ImpedanceCause>& causes) {
  if (causes.empty()) return {};
  Json json = Json::object();
  for (const auto& [name, impedance] : causes) json[name] = complex_json(impedance);
  return json;
}

Json impedance_json(const ActuatorResult& result) {
  const actuator::ImpedanceTask& task = *result.impedance_task;
  Json points = Json::array();
  for (const ImpedancePoint& p : result.impedance) {
    points.push_back({{"frequency_hz", p.frequency_Hz},
                      {"dynamic_stiffness_nm_per_rad", complex_json(p.stiffness_Nm_rad)},
                      {"impedance_nms_per_rad", complex_json(p.impedance_Nms)},
                      {"first_harmonic_nms_per_rad", complex_json(p.first_harmonic_Nms)},
                      {"flow_change_deg",
                       p.flow_change_rad ? Json(*p.flow_change_rad / units::kDegree) : Json()},
                      {"causes_nms_per_rad", causes_json(p.causes)},
                      {"first_harmonic_causes_nms_per_rad", causes_json(p.harmonic_causes)}});
  }
  return {{"motor", kTerminalNames[static_cast<std::size_t>(task.motor)]},
          {"amplitude_rad", task.amplitude_rad},
          {"points", points}};
}

std::string number_or(const std::optional<double>& value, const char* none, const char* unit) {
  return value ? fmt::format("{:.6g}{}", *value, unit) : std::string(none);
}

std::string reflected_text(const ActuatorResult& result) {
  const Reflected& r = result.reflected;
  TextTable table({"at the output", "motor", "gearbox", "load", "total"});
  const auto cell = [](double value) { return fmt::format("{:.6g}", value); };
  table.add({"inertia [kg m2]", cell(r.motor_kgm2),
             r.gearbox_inertia_known ? cell(r.gearbox_kgm2) : "not known", cell(r.load_kgm2),
             cell(r.total_kgm2)});
  table.add({"damping [N m s/rad]", cell(r.motor_Nms), cell(r.gearbox_Nms), "", cell(r.total_Nms)});
  table.add({"stiffness [N m/rad]", number_or(r.motor_Nm_rad, "rigid", ""),
             number_or(r.gearbox_Nm_rad, "rigid", ""), "", number_or(r.total_Nm_rad, "rigid", "")});
  return table.text(0) +
         fmt::format(
             "\ninertia speeding up     {}\ninertia slowing down    {}\n"
             "Coulomb friction        {:.6g} N m{}\n"
             "breakaway               {} from outside, {} at the motor\n",
             number_or(r.speeding_up_kgm2, "none: self-locking", " kg m2"),
             number_or(r.slowing_down_kgm2, "none", " kg m2"), r.coulomb_Nm,
             r.backdriven_coulomb_Nm
                 ? fmt::format("; turned from outside {:.6g} N m", *r.backdriven_coulomb_Nm)
                 : "",
             number_or(r.breakaway_Nm, "none", " N m"),
             number_or(r.breakaway_motor_Nm, "none", " N m"));
}

std::string checks_lines(const std::vector<LimitCheck>& checks) {
  if (checks.empty()) return "";
  TextTable table({"check", "value", "limit", "margin", ""});
  table.align_left(4);
  for (const LimitCheck& check : checks) {
    const ShownCheck s = shown(check);
    table.add({check.name, number_or(s.value, "without bound", ""),
               with_unit(fmt::format("{:.6g}", s.limit), s.unit), number_or(check.margin, "-", ""),
               check.ok ? "ok" : "FAILS"});
  }
  return '\n' + table.text(0);
}

std::string ledger_text(const ActuatorResult& result) {
  const DutyCycle& d = *result.cycle;
  TextTable table(result.without_each
                      ? std::vector<std::string>{"energy [J]", "", "saved without it"}
                      : std::vector<std::string>{"energy [J]", ""});
  const auto row = [&](std::string name, double energy, std::string saved = "") {
    std::vector<std::string> cells{std::move(name), fixed(energy, 4)};
    if (result.without_each) cells.push_back(std::move(saved));
    table.add(std::move(cells));
  };
  const auto saved = [&](const std::string& cause) -> std::string {
    if (!result.without_each) return "";
    for (const auto& w : *result.without_each) {
      if (w.cause == cause) return fixed(w.saved_J, 4);
    }
    return "";
  };
  row("drawn from the bus", d.drawn_J);
  row("back to the bus", 0.0 - d.regenerated_J);
  row("to the load", d.positive_J);
  row("from the load", 0.0 - d.negative_J);
  for (const auto& [cause, energy] : d.losses) row("  " + cause, energy, saved(cause));
  row("kinetic", d.kinetic_J);
  if (result.without_each) row("  inertia", 0.0, saved("inertia"));
  return table.text(0);
}

std::string felt_text(const actuator::FeltTorque& felt) {
  return fmt::format(
      "motor holds {:.6g} N m      {} moving with it, {} pushed back; transparency {}\n",
      felt.motor_Nm, number_or(felt.moving_with_Nm, "stands still", " N m"),
      number_or(felt.pushed_back_Nm, "not to be", " N m"),
      number_or(felt.transparency, "none", ""));
}

std::string cycle_text(const ActuatorResult& result) {
  const DutyCycle& d = *result.cycle;
  std::string text = fmt::format("\nCycle {}: {:g} s, {}\n", io::printable(result.cycle_name),
                                 d.period_s, d.periodic ? "periodic" : "not periodic");
  text += ledger_text(result);
  text += fmt::format("balance error {:.1e} of all magnitudes\n\n", d.balance_error);
  text += fmt::format(
      "motor  current {:.4f} A peak, {:.4f} A rms; voltage {:.4f} V peak; torque {:.5g} N m rms\n",
      d.peak_current_A, d.rms_current_A, d.peak_voltage_V, d.rms_motor_torque_Nm);
  if (d.shares) {
    text += fmt::format(
        "of the energy that the load gives {:.1f} % passes the mesh backward, against {:.1f} % the "
        "motor brakes, in {:.1f} % it gives power\n",
        100.0 * d.shares->backdriven, 100.0 * d.shares->motor_braking,
        100.0 * d.shares->regenerating);
  }
  if (d.winding && d.winding->winding_K) {
    text += fmt::format("winding {:.2f} C\n",
                        units::from_si(*d.winding->winding_K, units::Unit::kCelsius));
  }
  text += checks_lines(d.checks);
  for (const std::string& note : d.notes) text += fmt::format("note: {}\n", note);
  return text;
}

/// Magnitude and phase.
std::array<std::string, 2> magnitude_and_phase(const std::optional<std::complex<double>>& z) {
  if (!z) return {"-", "-"};
  return {fmt::format("{:.6g}", std::abs(*z)),
          std::abs(*z) > 0.0 ? fmt::format("{:.3f}", std::arg(*z) / units::kDegree) : "-"};
}

/// What each cause adds at the ends of the range; "" where nothing is known.
std::string causes_text(const std::string& title, const std::vector<ImpedancePoint>& points,
                        std::vector<actuator::ImpedanceCause> ImpedancePoint::*causes) {
  const ImpedancePoint& low = points.front();
  const ImpedancePoint& high = points.back();
  const auto& first = low.*causes;
  const auto& last = high.*causes;
  if (first.empty() || last.size() != first.size()) return "";
  TextTable table({title, fmt::format("|Z| at {:.5g} Hz", low.frequency_Hz), "phase deg",
                   fmt::format("|Z| at {:.5g} Hz", high.frequency_Hz), "phase deg"});
  for (std::size_t k = 0; k < first.size(); ++k) {
    if (std::abs(first[k].impedance_Nms) + std::abs(last[k].impedance_Nms) == 0.0) continue;
    const auto a = magnitude_and_phase(first[k].impedance_Nms);
    const auto b = magnitude_and_phase(last[k].impedance_Nms);
    table.add({first[k].name, a[0], a[1], b[0], b[1]});
  }
  return '\n' + table.text(0);
}

std::string impedance_text(const ActuatorResult& result) {
  TextTable table({"Hz", "|Z| N m s/rad", "phase deg", "first harmonic", "phase deg"});
  for (const ImpedancePoint& p : result.impedance) {
    const auto linear = magnitude_and_phase(p.impedance_Nms);
    const auto harmonic = magnitude_and_phase(p.first_harmonic_Nms);
    table.add(
        {fmt::format("{:.5g}", p.frequency_Hz), linear[0], linear[1], harmonic[0], harmonic[1]});
  }
  const actuator::ImpedanceTask& task = *result.impedance_task;
  const std::string harmonic = task.amplitude_rad > 0.0
                                   ? fmt::format("first harmonic at {:g} rad", task.amplitude_rad)
                                   : "no first harmonic without an amplitude";
  return fmt::format("\nImpedance of the output, motor {}; {}\n",
                     kTerminalNames[static_cast<std::size_t>(task.motor)], harmonic) +
         table.text(0) +
         causes_text("by cause, complex sum", result.impedance, &ImpedancePoint::causes) +
         causes_text("of the first harmonic", result.impedance, &ImpedancePoint::harmonic_causes);
}

/// Names of the causes of the first point that has some.
std::vector<std::string> names_of_causes(
    const std::vector<ImpedancePoint>& points,
    std::vector<actuator::ImpedanceCause> ImpedancePoint::*causes) {
  std::vector<std::string> names;
  const auto known =
      std::ranges::find_if(points, [&](const ImpedancePoint& p) { return !(p.*causes).empty(); });
  if (known == points.end()) return names;
  for (const auto& cause : (*known).*causes) names.push_back(cause.name);
  return names;
}

}  // namespace

io::Json limit_checks_json(const std::vector<LimitCheck>& checks) { return checks_list(checks); }
std::string limit_checks_text(const std::vector<LimitCheck>& checks) {
  return checks_lines(checks);
}

io::Json actuator_json(const ActuatorResult& result) {
  Json json{{"tool", tool_json()},
            {"name", result.actuator.name},
            {"ratio", result.actuator.gearbox.ratio},
            {"reflected", reflected_json(result.reflected)},
            {"cycle", result.cycle ? cycle_json(result) : Json()}};
  if (result.felt) json["felt"] = felt_json(*result.felt);
  if (!result.felt_checks.empty()) json["checks"] = checks_list(result.felt_checks);
  if (result.impedance_task) json["impedance"] = impedance_json(result);
  json["notes"] = result.reflected.notes;
  return json;
}

std::string actuator_table(const ActuatorResult& result) {
  std::string text =
      fmt::format("{}: ratio {:.6g}\n",
                  io::printable(result.actuator.name.empty() ? "actuator" : result.actuator.name),
                  result.actuator.gearbox.ratio);
  text += reflected_text(result);
  if (result.felt) text += felt_text(*result.felt);
  text += checks_lines(result.felt_checks);
  for (const std::string& note : result.reflected.notes) text += fmt::format("note: {}\n", note);
  if (result.cycle) text += cycle_text(result);
  if (result.impedance_task) text += impedance_text(result);
  return text;
}

std::string actuator_cycle_csv(const DutyCycle& cycle) {
  std::string text =
      "time_s,speed_rad_s,load_nm,mesh_nm,motor_torque_nm,current_a,voltage_v,mechanical_power_w,"
      "electrical_power_w\n";
  for (const actuator::MotorInstant& p : cycle.instants) {
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{}\n", exact(p.time_s), exact(p.speed_rad_s),
                    exact(p.load_Nm), exact(p.mesh_Nm), exact(p.motor_Nm), exact(p.current_A),
                    exact(p.voltage_V), exact(-p.load_Nm * p.speed_rad_s), exact(p.electrical_W));
  }
  return text;
}

std::string impedance_csv(const std::vector<ImpedancePoint>& points) {
  const auto columns = [](const std::string& name) {
    return fmt::format("{0}_real_nms_per_rad,{0}_imaginary_nms_per_rad", name);
  };
  std::string text =
      fmt::format("frequency_hz,{},{}", columns("impedance"), columns("first_harmonic"));
  const auto linear = names_of_causes(points, &ImpedancePoint::causes);
  const auto harmonic = names_of_causes(points, &ImpedancePoint::harmonic_causes);
  for (const std::string& name : linear) text += ',' + columns("impedance_" + name);
  for (const std::string& name : harmonic) text += ',' + columns("first_harmonic_" + name);
  text += '\n';
  const auto cells = [](const std::optional<std::complex<double>>& z) {
    return z ? fmt::format("{},{}", exact(z->real()), exact(z->imag())) : std::string(",");
  };
  const auto append = [&](const std::vector<actuator::ImpedanceCause>& causes, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      text += ',' + (k < causes.size() ? cells(causes[k].impedance_Nms) : ",");
    }
  };
  for (const ImpedancePoint& p : points) {
    text += fmt::format("{},{},{}", exact(p.frequency_Hz), cells(p.impedance_Nms),
                        cells(p.first_harmonic_Nms));
    append(p.causes, linear.size());
    append(p.harmonic_causes, harmonic.size());
    text += '\n';
  }
  return text;
}

}  // namespace gear3k::report
