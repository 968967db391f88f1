#include "report/loop_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <vector>

#include "report/display.hpp"
#include "report/text_table.hpp"
#include "report/uncertain_value.hpp"

namespace gear3k::report {

namespace {

using calibrate::LoopSession, calibrate::MeasurementSet;

std::string stiffness_text(const std::optional<calibrate::FlankStiffness>& flank) {
  return flank ? deviation_text(flank->stiffness_Nm_rad, flank->standard_deviation_Nm_rad) : "-";
}

std::string session_name(const LoopSession& session, const MeasurementSet& set) {
  const auto file = static_cast<std::size_t>(session.file);
  const std::string name = file < set.files.size() ? set.files[file] : "";
  return session.run.empty() ? name : fmt::format("{}, run {}", name, session.run);
}

/// What the filter of a session's record was, and how its angle crept.
std::string record_text(const LoopSession& session) {
  std::vector<std::string> parts;
  if (session.cutoff_Hz > 0.0) {
    parts.push_back(fmt::format("filter cut-off {:.3g} Hz", session.cutoff_Hz));
  }
  if (session.creep) {
    parts.push_back(fmt::format("creep of {} arcmin/s, which is not taken out",
                                deviation_text(arcmin(session.creep->rad_s),
                                               arcmin(session.creep->standard_deviation_rad_s))));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace

std::string loop_table(const MeasurementSet& set) {
  if (set.loops.empty()) return "";
  TextTable table({"record", "measured at", "loop", "lost motion (arcmin)",
                   "stiffness at T > 0 (N m/rad)", "at T < 0 (N m/rad)", "asymmetry"});
  std::string records;
  bool at_sun = false;
  for (const LoopSession& session : set.loops) {
    const std::string name = session_name(session, set);
    for (const auto& [number, loop] : session.loops) {
      table.add({name, session.sun_locked ? "output" : "sun", fmt::format("{}", number),
                 loop.outcome == calibrate::LoopOutcome::kMeasured
                     ? deviation_text(arcmin(loop.lost_motion_rad), arcmin(loop.lost_motion_sd_rad))
                     : "-",
                 stiffness_text(loop.stiffness_positive), stiffness_text(loop.stiffness_negative),
                 loop.asymmetry ? fmt::format("{} %", fixed(percent(*loop.asymmetry), 1)) : "-"});
    }
    at_sun = at_sun || !session.sun_locked;
    const std::string record = record_text(session);
    if (record.empty()) continue;
    records += fmt::format("  {}: {}\n", name, record);
  }
  return fmt::format(
      "\nLoops, friction included, at the output (± is one standard deviation)\n{}{}{}",
      table.text(2), at_sun ? "  What was measured at the sun is referred to the output.\n" : "",
      records);
}

}  // namespace gear3k::report
