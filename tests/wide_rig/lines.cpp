#include <set>
#include <stdexcept>
#include <utility>

#include "tests/wide_rig/hidden_effect.hpp"
#include "tests/wide_rig/test_plan.hpp"
#include "tests/wide_rig/wide_rig.hpp"

namespace gear3k::wide_rig {
namespace {

void add_singles(std::vector<Line>& all) {
  for (const char* kind : {"transmission", "lost_motion", "pair_loss", "torque_angle"}) {
    for (const std::string& cause : causes_of(kind)) {
      for (const std::string& law : laws_of(cause, kind)) {
        std::string name = "single ";
        if (std::string(kind) != "transmission") name.append(kind).append(" ");
        name.append(cause).append(" ").append(law);
        all.push_back({.name = name,
                       .group = "single",
                       .kind = kind,
                       .hidden = {{cause, law}},
                       .plan = "",
                       .noise = ""});
      }
    }
  }
}

void add_specials(std::vector<Line>& all) {
  const auto add = [&](const std::string& name, const std::string& kind,
                       const std::vector<HiddenCause>& hidden, const std::string& plan) {
    all.push_back({.name = name,
                   .group = "special",
                   .kind = kind,
                   .hidden = hidden,
                   .plan = plan,
                   .noise = ""});
  };
  add("drift on friction", "transmission", {{"drift", "friction_*"}}, "");
  add("drift on gain", "transmission", {{"drift", "gain_*"}}, "");
  add("gain steps", "transmission", {{"run_step", "gain_sessions"}}, "");
  add("gain steps by_session", "transmission", {{"run_step", "gain_sessions"}}, "by_session");
  add("friction steps", "transmission", {{"run_step", "friction_sessions"}}, "");
  add("steps of all sessions in lost motion", "lost_motion", {{"run_step", "sessions"}}, "");
  add("drift of lost motion", "lost_motion", {{"drift", ""}}, "");
  add("first-order wave on one turn", "lost_motion", {{"runout", "single_wave"}}, "one_turn");
  add("first-order wave on one turn transmission", "transmission",
      {{"runout", "load_proportional"}}, "one_turn");
  add("wave on an even grid", "lost_motion", {{"runout", ""}}, "even_angles");
  add("tooth wave on an even grid", "lost_motion", {{"mesh_order", ""}}, "even_angles");
  add("friction_load sun torque set", "transmission", {{"friction_load", ""}}, "sun_torque_set");
  add("friction_speed sun torque set", "transmission", {{"friction_speed", ""}}, "sun_torque_set");
  add("drag_constant sun torque set", "transmission", {{"drag_constant", ""}}, "sun_torque_set");
}

void add_several(std::vector<Line>& all) {
  const auto add = [&](const std::string& kind, const std::vector<HiddenCause>& hidden) {
    std::string name;
    for (const HiddenCause& one : hidden) name += (name.empty() ? "" : "+") + one.cause;
    all.push_back({.name = (hidden.size() == 2 ? "pair " : "triple ") + name,
                   .group = hidden.size() == 2 ? "pair" : "triple",
                   .kind = kind,
                   .hidden = hidden,
                   .plan = "",
                   .noise = ""});
  };
  const std::string t = "transmission";
  add(t, {{"friction_load", ""}, {"drag_viscous", ""}});
  add(t, {{"friction_speed", ""}, {"sensor_gain", "constant"}});
  add(t, {{"friction_temperature", ""}, {"drag_constant", ""}});
  add(t, {{"friction_temperature", ""}, {"friction_speed", ""}});
  add(t, {{"friction_load", ""}, {"sensor_offset", "constant"}});
  add(t, {{"friction_speed", ""}, {"runout", ""}});
  add(t, {{"friction_level", "all_meshes"}, {"drag_viscous", "sun"}});
  add(t, {{"friction_direction", "flank_finish"}, {"drag_quadratic", "sun"}});
  add(t, {{"run_step", "gain_sessions"}, {"friction_temperature", ""}});
  add(t, {{"drift", "friction_*"}, {"drag_constant", "sun_seal"}});
  add(t, {{"drag_constant", ""}, {"sensor_gain", "constant"}});
  add(t, {{"bearing_load", ""}, {"sensor_offset", "constant"}});
  add("lost_motion", {{"clearance", "constant"}, {"compliance", ""}});
  add("lost_motion", {{"runout", "single_wave"}, {"thermal_expansion", "linear"}});
  add(t, {{"friction_load", ""}, {"drag_viscous", "sun"}, {"sensor_offset", "constant"}});
  add(t, {{"friction_speed", ""}, {"friction_temperature", ""}, {"runout", "load_proportional"}});
  add(t, {{"friction_level", "all_meshes"}, {"drag_constant", "sun_seal"}, {"run_step", "gain_*"}});
  add("lost_motion", {{"clearance", "constant"}, {"compliance", "linear"}, {"mesh_order", ""}});
}

void add_nulls(std::vector<Line>& all) {
  const auto add = [&](const std::string& kind, const std::string& plan, const std::string& noise) {
    all.push_back({.name = "null " + kind + " " + noise + " " + plan,
                   .group = noise == "correlated" || noise == "blocks" ? "correlated" : "null",
                   .kind = kind,
                   .hidden = {},
                   .plan = plan,
                   .noise = noise});
  };
  for (const char* kind : {"transmission", "lost_motion", "pair_loss"}) {
    for (const std::string& plan : plans_of(kind)) {
      if (plan.starts_with("coarse_grid")) continue;  // made for waves
      for (const char* noise :
           {"normal", "t3", "outliers", "quantised", "reading", "correlated", "blocks"}) {
        add(kind, plan, noise);
      }
    }
  }
  add("torque_angle", "loops", "normal");
}

void add_confounded(std::vector<Line>& all) {
  const auto add = [&](const std::string& cause, const std::string& law, const std::string& plan,
                       const std::string& kind) {
    all.push_back({.name = "confounded " + kind + " " + cause + " " + plan,
                   .group = "confounded",
                   .kind = kind,
                   .hidden = {{cause, law}},
                   .plan = plan,
                   .noise = ""});
  };
  for (const char* plan : {"warming_with_speed", "warming_with_time", "temperature_by_session"}) {
    add("friction_temperature", "", plan, "transmission");
  }
  add("friction_speed", "", "warming_with_speed", "transmission");
  add("drift", "friction_*", "warming_with_time", "transmission");
  add("run_step", "gain_sessions", "one_direction", "transmission");
  add("run_step", "friction_sessions", "temperature_by_session", "transmission");
  add("friction_load", "", "load_by_session", "transmission");
  add("friction_load", "", "one_direction", "transmission");
  add("drag_constant", "", "one_rotation", "transmission");
  add("sensor_offset", "constant", "one_rotation", "transmission");
  add("sensor_gain", "constant", "one_direction", "transmission");
  add("thermal_expansion", "", "warming_with_time", "lost_motion");
  add("thermal_expansion", "", "temperature_by_session", "lost_motion");
  add("compliance", "", "one_torque", "lost_motion");
  add("clearance", "constant", "one_torque", "lost_motion");
  add("friction_level", "all_pairs", "one_sense", "pair_loss");
}

void add_aliased(std::vector<Line>& all) {
  for (const char* kind : {"transmission", "lost_motion"}) {
    for (const auto& [cause, plan] :
         {std::pair{"runout", "coarse_grid"}, std::pair{"mesh_order", "coarse_grid"},
          std::pair{"runout", "coarse_grid_shafts"}}) {
      all.push_back({.name = std::string("aliased ") + kind + " " + cause + " " + plan,
                     .group = "aliased",
                     .kind = kind,
                     .hidden = {{cause, ""}},
                     .plan = plan,
                     .noise = ""});
    }
  }
}

void add_unknowns(std::vector<Line>& all) {
  for (const char* kind : {"transmission", "lost_motion", "pair_loss"}) {
    for (const std::string& law : laws_of("unknown", kind)) {
      all.push_back({.name = std::string("unknown ") + kind + " " + law,
                     .group = "unknown",
                     .kind = kind,
                     .hidden = {{"unknown", law}},
                     .plan = "crossed",
                     .noise = ""});
    }
  }
}

}  // namespace

std::vector<Line> lines() {
  std::vector<Line> all;
  add_singles(all);
  add_specials(all);
  add_several(all);
  add_nulls(all);
  add_confounded(all);
  add_aliased(all);
  add_unknowns(all);
  return all;
}

}  // namespace gear3k::wide_rig
