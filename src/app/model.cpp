#include "app/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "calibrate/model/model_range.hpp"
#include "design/checks.hpp"
#include "design/measured_lost_motion.hpp"
#include "io/files/model_file.hpp"
#include "io/text/diagnostics.hpp"
#include "units/units.hpp"

namespace gear3k::app {

namespace {

using calibrate::ExtendedModel;
using Point = design::OperatingPoint<double>;

std::string point_text(const Point& point) {
  return fmt::format("{:.6g} rpm, {:.6g} N m, {:.4g} C", point.sun_speed_rad_s / units::kRpm,
                     point.output_torque_Nm, point.temperature_K - 273.15);
}

void note_range(const Model& model, const calibrate::UsedRange& used, Notes& notes) {
  for (std::string& note : calibrate::outside_range(model.use.models, used)) {
    notes.push_back(std::move(note));
  }
}

void note_point(const Model& model, const Point& point, Notes& notes) {
  note_range(model, {.where = "the operating point", .low = point, .high = point}, notes);
}

/// Laws are about readings: they do not change the gearbox.
void note_laws(const Model& model, Notes& notes) {
  for (const ExtendedModel& m : model.use.models) {
    for (const calibrate::AppliedLaw& law : m.laws) {
      notes.push_back(
          fmt::format("{}: a law of {} is left out, as it changes readings and not the "
                      "gearbox: {}",
                      model.use.file, calibrate::kKindNames[static_cast<std::size_t>(m.kind)],
                      law_formula(law.law, law.value, m.kind)));
    }
  }
}

/// The stated point, or the middle of the model's range, which is noted.
std::optional<Point> point_or_middle(const std::optional<Point>& stated, const Model& model,
                                     const char* file, Notes& notes) {
  if (stated) return stated;
  const auto middle = calibrate::middle_of_range(model.use.models);
  if (middle) {
    if (!(middle->sun_speed_rad_s >= 0.0 && middle->output_torque_Nm >= 0.0)) {
      throw io::InvalidInput(fmt::format(
          "{}: the middle of its range is no operating point: {}; allowed: 0 rpm and 0 N m or more",
          model.use.file, point_text(*middle)));
    }
    notes.push_back(
        fmt::format("no [operating_point] in {}: the middle of the model's range is "
                    "taken, {}",
                    file, point_text(*middle)));
  }
  return middle;
}

/// Lost motion at a torque that the model adds to that of the teeth.
double added_lost_motion(const backlash::LostMotionExtension<double>& e, double torque_Nm) {
  return e.clearance_rad + backlash::windup(e, torque_Nm);
}

/// Lowers the limits of lost motion by what the model adds to that of the teeth.
void lower_limits(optimize::Specification& spec, Model& model, Notes& notes) {
  const auto& e = model.extension.lost_motion;
  if (!design::changes_lost_motion(e)) return;
  const double torque_Nm = spec.operating_point ? spec.operating_point->output_torque_Nm : 0.0;
  const double shift = added_lost_motion(e, torque_Nm);
  using design::CheckId;
  bool lowered = false;
  for (const CheckId id : {CheckId::kOutputBacklashMin, CheckId::kOutputBacklashMax}) {
    auto& limit = spec.limits[id];
    if (!limit || shift == 0.0) continue;
    *limit -= shift;
    lowered = true;
  }
  if (lowered) {
    model.use.lost_motion_shift_rad = shift;
    notes.push_back(fmt::format(
        "limits of lost motion hold with the {:.4g} arcmin that the model adds at {:.6g} N m: the "
        "teeth alone, and best.toml, get limits lower by that",
        units::from_si(shift, units::Unit::kArcmin), torque_Nm));
  }
  if (e.beyond_springs) {
    notes.emplace_back(
        "limits of lost motion hold without the wind-up of the springs of [strength], beyond which "
        "the model's compliance counts");
  }
  if (e.expansion_1_K != 0.0) {
    notes.emplace_back(
        "limits of lost motion hold at the model's reference temperature: its thermal expansion is "
        "not taken into account");
  }
}

bool beyond_springs(const report::ModelUse& model) {
  return std::ranges::any_of(model.models, &ExtendedModel::beyond_springs);
}

}  // namespace

void note_springs(const report::ModelUse& model, bool states_springs, Notes& notes) {
  if (states_springs || !beyond_springs(model)) return;
  notes.push_back(fmt::format(
      "{}: its compliance counts beyond the springs of [strength], which the design does "
      "not state: what they wind up is missing",
      model.file));
}

void note_model(const std::string& name, const report::ModelUse& model, Notes& notes) {
  for (const ExtendedModel& m : model.models) {
    if (m.name.empty() || name.empty() || m.name == name) continue;
    notes.push_back(
        fmt::format("{}: measured on \"{}\", applied to \"{}\"", model.file, m.name, name));
    break;
  }
  for (std::string& caution : report::cautions(model)) notes.push_back(std::move(caution));
}

std::string unreachable_lost_motion(const optimize::Specification& stated, const Model& model) {
  const auto& limit = stated.limits[design::CheckId::kOutputBacklashMax];
  const double added = model.use.lost_motion_shift_rad;
  if (!limit || *limit >= added) return "";
  const auto arcmin = [](double rad) { return units::from_si(rad, units::Unit::kArcmin); };
  return fmt::format(
      "backlash.max_output_arcmin = {:.6g}: the model adds {:.4g} arcmin to the lost motion of the "
      "teeth: no teeth can keep the limit, allowed with this model: {:.4g} or more",
      arcmin(*limit), arcmin(added), arcmin(added));
}

Model model_of(std::vector<ExtendedModel> models, const std::string& source) {
  const auto refused = calibrate::black_box_causes(models);
  if (!refused.empty()) {
    throw io::InvalidInput(fmt::format(
        "{}: {}: measured on a black box, by torque and speed of its shafts: allowed: a model that "
        "diagnose found with a DESIGN",
        source, fmt::join(refused, ", ")));
  }
  const design::Extension<double> extension = calibrate::extension_of(models);
  return {.use = {.file = source, .models = std::move(models)}, .extension = extension};
}

std::optional<Model> read_model(const std::string& path) {
  if (path.empty()) return std::nullopt;
  return model_of(io::read_model(path), path);
}

design::Design with_model(const design::Design& design, const Model& model, Notes& notes) {
  note_model(design.name, model.use, notes);
  note_springs(model.use, design.rating.has_value(), notes);
  note_laws(model, notes);
  design::Design extended = design::extended(design, model.extension);
  if (calibrate::needs_operating_point(model.extension)) {
    extended.operating_point = point_or_middle(design.operating_point, model, "the design", notes);
    if (!extended.operating_point) {
      notes.emplace_back(
          "neither design nor model states an operating point: what of the model depends on load, "
          "speed or temperature, drags and bearings have no effect");
    }
  }
  if (extended.operating_point) {
    note_point(model, *extended.operating_point, notes);
  }
  return extended;
}

design::Design with_model_on_grid(const design::Design& design, const Model& model, Notes& notes) {
  note_model(design.name, model.use, notes);
  note_laws(model, notes);
  const Point stated = design.operating_point.value_or(Point{});
  const design::MapGrid& grid = design.map;
  note_range(
      model,
      {.where = "the map's grid",
       .low = {.sun_speed_rad_s = std::min(grid.sun_speed_rad_s.from, grid.sun_speed_rad_s.to),
               .output_torque_Nm = std::min(grid.output_torque_Nm.from, grid.output_torque_Nm.to),
               .temperature_K = stated.temperature_K},
       .high = {.sun_speed_rad_s = std::max(grid.sun_speed_rad_s.from, grid.sun_speed_rad_s.to),
                .output_torque_Nm = std::max(grid.output_torque_Nm.from, grid.output_torque_Nm.to),
                .temperature_K = stated.temperature_K}},
      notes);
  return design::extended(design, model.extension);
}

optimize::Specification with_model(const optimize::Specification& spec, Model& model,
                                   Notes& notes) {
  note_model(spec.name, model.use, notes);
  note_laws(model, notes);
  optimize::Specification extended = spec;
  extended.friction.extension = model.extension.friction;
  extended.operating_point = point_or_middle(spec.operating_point, model, "SPEC", notes);
  extended.model = model.extension;
  if (extended.operating_point) {
    note_point(model, *extended.operating_point, notes);
  } else {
    notes.emplace_back(
        "neither SPEC nor model states an operating point: the refined sets are not judged with "
        "the model; its friction level and side enter their refinement");
  }
  lower_limits(extended, model, notes);
  return extended;
}

}  // namespace gear3k::app
