#include "report/thermal_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "design/checks.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using design::JamRange, design::ThermalMesh, design::ThermalResult, design::ThermalStateResult;

Fields thermal_mesh_fields(const ThermalStateResult& at, std::size_t k) {
  const ThermalMesh& m = at.meshes[k];
  const std::string name(train::kMeshNames[k]);
  Fields f(fmt::format("{} at {}", name, design::state_text(at.state)));
  f.add("name", name);
  f.add("base_pitch_difference_um", um(m.base_pitch_difference_m), {"base_pitch_difference", "um"});
  f.add("working_pressure_angle_deg", degrees(m.working_pressure_angle_rad),
        {"working_pressure_angle", "deg"});
  f.add("contact_ratio", m.contact_ratio, {"contact_ratio"});
  f.add("normal_backlash_um", um(m.normal_backlash_m), {"normal_backlash", "um"});
  f.add("least_backlash_um", um(m.least_backlash_m), {"least_backlash", "um"});
  for (const std::size_t i : {0U, 1U}) {
    f.append("root_clearance_mm", mm(m.root_clearance_m[i]),
             {fmt::format("root_clearance_gear{}", i + 1), "mm"});
  }
  return f;
}

Fields thermal_state_fields(const ThermalStateResult& at) {
  Fields f(fmt::format("train at {}", design::state_text(at.state)));
  f.add("temperature_c", celsius(at.state.temperature_K));
  f.add("moisture", moisture_name(at.state.moisture));
  f.add("center_distance_mm", mm(at.center_distance_m), {"center_distance", "mm"});
  f.add("lost_motion_arcmin", arcmin(at.lost_motion_rad), {"lost_motion_kinematic", "arcmin"});
  f.add("meshes", io::Json::array());
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    f.append("meshes", thermal_mesh_fields(at, k));
  }
  return f;
}

std::string jam_text(const std::optional<double>& temperature_K) {
  return temperature_K ? fmt::format("{:.1f} C", celsius(*temperature_K)) : std::string("none");
}

/// The nearest temperature of several; `above`: the least of them.
std::optional<double> nearest_jam(const ThermalResult& thermal, bool above) {
  std::optional<double> nearest;
  for (const JamRange& jam : thermal.jams) {
    const std::optional<double>& at = above ? jam.above_K : jam.below_K;
    if (at && (!nearest || (above ? *at < *nearest : *at > *nearest))) nearest = at;
  }
  return nearest;
}

}  // namespace

std::string_view moisture_name(train::Moisture moisture) {
  switch (moisture) {
    case train::Moisture::kDry:
      return "dry";
    case train::Moisture::kWet:
      return "wet";
    case train::Moisture::kDrawn:
      break;
  }
  return "drawn";
}

std::string thermal_summary(const ThermalResult& thermal) {
  double least_m = std::numeric_limits<double>::infinity();
  double most_rad = -std::numeric_limits<double>::infinity();
  std::string where;
  for (const ThermalStateResult& at : thermal.states) {
    most_rad = std::max(most_rad, at.lost_motion_rad);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      if (!(at.meshes[k].least_backlash_m < least_m)) continue;
      least_m = at.meshes[k].least_backlash_m;
      where = fmt::format("{} at {}", train::kMeshNames[k], design::state_text(at.state));
    }
  }
  return fmt::format(
      "least backlash {} um ({}), {}; jams below: {}, above: {}", fixed(um(least_m), 1), where,
      most_rad < 0.0 ? "no lost motion, as meshes overlap"
                     : fmt::format("lost motion up to {} arcmin", fixed(arcmin(most_rad), 2)),
      jam_text(nearest_jam(thermal, false)), jam_text(nearest_jam(thermal, true)));
}

std::string thermal_table(const std::optional<ThermalResult>& thermal) {
  if (!thermal) return "";
  TextTable table({"at", "mesh", "centre distance", "lost motion", "backlash j_bn",
                   "least backlash", "base pitch difference", "working angle", "contact ratio",
                   "tip clearances"});
  table.align_left(1);
  for (const ThermalStateResult& at : thermal->states) {
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const ThermalMesh& m = at.meshes[k];
      table.add({k == 0 ? design::state_text(at.state) : "", std::string(train::kMeshNames[k]),
                 k == 0 ? fmt::format("{:.4f} mm", mm(at.center_distance_m)) : "",
                 k == 0 ? fixed(arcmin(at.lost_motion_rad), 2) + " arcmin" : "",
                 fixed(um(m.normal_backlash_m), 2) + " um",
                 fixed(um(m.least_backlash_m), 2) + " um",
                 fixed(um(m.base_pitch_difference_m), 2) + " um",
                 fmt::format("{:.4f} deg", degrees(m.working_pressure_angle_rad)),
                 fixed(m.contact_ratio, 3),
                 fmt::format("{}, {} mm", fixed(mm(m.root_clearance_m[0]), 4),
                             fixed(mm(m.root_clearance_m[1]), 4))});
    }
  }
  std::string jams;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const JamRange& jam = thermal->jams[k];
    jams += fmt::format("  {}: first jams below at {}, above at {}\n", train::kMeshNames[k],
                        jam_text(jam.below_K), jam_text(jam.above_K));
  }
  return fmt::format(
             "\nTemperature (as drawn at {:g} C; least backlash: in any position; clearances: of "
             "the tips of gear 1 and 2)\n",
             celsius(thermal->reference_K)) +
         table.text(2) + jams;
}

Fields thermal_fields(const ThermalResult& thermal) {
  Fields f;
  f.add("reference_c", celsius(thermal.reference_K));
  f.add_list("states", thermal.states, thermal_state_fields);
  f.add("jams", io::Json::array());
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    Fields jam{std::string(train::kMeshNames[k])};
    jam.add("name", train::kMeshNames[k]);
    jam.add("below_c", if_any(thermal.jams[k].below_K, celsius), {"jams_below", "C"});
    jam.add("above_c", if_any(thermal.jams[k].above_K, celsius), {"jams_above", "C"});
    f.append("jams", std::move(jam));
  }
  return f;
}

}  // namespace gear3k::report
