#include "report/motion_report.hpp"

#include <fmt/format.h>

#include <map>

#include "io/text/json.hpp"
#include "io/text/printable.hpp"
#include "report/actuator_report.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using io::Json;
using motion::Ledger, motion::Mode, motion::Phase;

const char* flow_name(const Mode& mode) {
  if (mode.phase != Phase::kSlide) return "none";
  return mode.flow > 0 ? "forward" : "backward";
}

std::string run_title(const MotionResult& result) {
  const auto named = [](const std::string& name, const char* otherwise) {
    return name.empty() ? std::string(otherwise) : io::printable(name);
  };
  return fmt::format("{}: {}", named(result.actuator.name, "actuator"),
                     named(result.scenario.name, "scenario"));
}

/// How often each event happened.
std::map<std::string, int> event_counts(const MotionResult& result) {
  std::map<std::string, int> counts;
  for (const motion::MotionEvent& event : result.motion.events) ++counts[event.what];
  return counts;
}

Json ledger_json(const Ledger& l) {
  Json losses = Json::object();
  for (const auto& [cause, energy] : l.losses) losses[cause] = energy;
  return {
      {"electrical_energy_j", {{"drawn", l.drawn_J}, {"regenerated", l.regenerated_J}}},
      {"load_energy_j", {{"positive", l.positive_J}, {"negative", l.negative_J}}},
      {"loss_j", losses},
      {"stored_j", {{"kinetic", l.kinetic_J}, {"spring", l.spring_J}, {"gravity", l.gravity_J}}},
      {"balance_error", l.balance_error}};
}

}  // namespace

std::string motion_csv(const MotionResult& result) {
  std::string text =
      "time_s,output_angle_rad,output_speed_rad_s,output_acceleration_rad_s2,motor_side_angle_rad,"
      "motor_side_speed_rad_s,mode,sense,flow,motor_torque_nm,load_nm,mesh_nm,current_a,"
      "voltage_v\n";
  for (const motion::MotionRow& r : result.motion.rows) {
    text += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", exact(r.time_s), exact(r.sides.output_rad),
        exact(r.sides.output_rad_s), exact(r.acceleration_rad_s2), exact(r.sides.fast_rad),
        exact(r.sides.fast_rad_s), phase_name(r.mode.phase), r.mode.sense, flow_name(r.mode),
        exact(r.outside.motor_Nm), exact(r.outside.load_Nm), r.mesh_Nm ? exact(*r.mesh_Nm) : "",
        exact(r.outside.current_A), exact(r.outside.voltage_V));
  }
  return text;
}

std::string motion_events_csv(const MotionResult& result) {
  std::string text =
      "time_s,event,mode_before,flow_before,mode_after,flow_after,output_angle_rad,"
      "output_speed_rad_s,loss_j\n";
  for (const motion::MotionEvent& e : result.motion.events) {
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{}\n", exact(e.time_s), e.what,
                    phase_name(e.before.phase), flow_name(e.before), phase_name(e.after.phase),
                    flow_name(e.after), exact(e.angle_rad), exact(e.speed_rad_s), exact(e.loss_J));
  }
  return text;
}

io::Json motion_json(const MotionResult& result) {
  const motion::Motion& m = result.motion;
  Json modes = Json::object();
  for (const motion::ModeShare& share : m.shares) {
    modes[share.name] = {{"time_s", share.time_s}, {"entries", share.entries}};
  }
  Json events = Json::object();
  for (const auto& [name, count] : event_counts(result)) events[name] = count;
  Json json{{"tool", tool_json()},
            {"name", result.scenario.name},
            {"actuator", result.actuator.name},
            {"duration_s", result.scenario.duration_s},
            {"complete", m.complete},
            {"interrupted", m.interrupted},
            {"end",
             {{"time_s", m.end.time_s},
              {"output_angle_rad", m.end.sides.output_rad},
              {"output_speed_rad_s", m.end.sides.output_rad_s},
              {"mode", phase_name(m.end.mode.phase)}}},
            {"backlash_arcmin", units::from_si(result.actuator.gearbox.backlash_rad.value_or(0.0),
                                               units::Unit::kArcmin)},
            {"ledger", ledger_json(m.ledger)},
            {"modes", modes},
            {"events", events},
            {"peak_current_a", m.peak_current_A},
            {"peak_voltage_v", m.peak_voltage_V},
            {"peak_motor_speed_rad_s", m.peak_motor_speed_rad_s},
            {"checks", limit_checks_json(m.checks)},
            {"steps", m.steps},
            {"notes", m.notes}};
  return json;
}

std::string motion_table(const MotionResult& result) {
  const motion::Motion& m = result.motion;
  const Ledger& l = m.ledger;
  std::string text =
      fmt::format("{}: {:.6g} s{}, {} events, {} steps\n", run_title(result), m.end.time_s,
                  m.complete ? "" : fmt::format(" of {:.6g} s", result.scenario.duration_s),
                  m.events.size(), m.steps);
  text += fmt::format("ends at {:.6g} rad with {:.6g} rad/s\n\n", m.end.sides.output_rad,
                      m.end.sides.output_rad_s);
  TextTable modes({"mode", "time [s]", "entered"});
  for (const motion::ModeShare& share : m.shares) {
    modes.add({share.name, fmt::format("{:.4f}", share.time_s), std::to_string(share.entries)});
  }
  text += modes.text(0) + '\n';
  const auto counts = event_counts(result);
  if (!counts.empty()) {
    TextTable events({"event", "times"});
    for (const auto& [name, count] : counts) events.add({name, std::to_string(count)});
    text += events.text(0) + '\n';
  }
  TextTable ledger({"energy", "[J]"});
  const auto add = [&](const std::string& name, double energy) {
    ledger.add({name, fmt::format("{:.6f}", energy)});
  };
  add("drawn", l.drawn_J);
  add("regenerated", l.regenerated_J);
  add("to the load", l.positive_J);
  add("from the load", l.negative_J);
  for (const auto& [cause, energy] : l.losses) {
    if (energy != 0.0) add(cause, energy);
  }
  add("kinetic", l.kinetic_J);
  if (l.spring_J != 0.0) add("spring", l.spring_J);
  if (l.gravity_J != 0.0) add("gravity", l.gravity_J);
  text += ledger.text(0);
  text += fmt::format("closes to {:.0e} of the sum\n", l.balance_error);
  text += fmt::format("peaks: {:.4g} A, {:.4g} V, motor {:.4g} rad/s\n", m.peak_current_A,
                      m.peak_voltage_V, m.peak_motor_speed_rad_s);
  text += limit_checks_text(m.checks);
  for (const std::string& note : m.notes) text += fmt::format("note: {}\n", note);
  return text;
}

}  // namespace gear3k::report
