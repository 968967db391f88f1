// A planetary stage against its KISSsoft report: tests/golden/kisssoft_stage_01.toml.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "backlash/normal_backlash.hpp"
#include "geometry/interference.hpp"
#include "geometry/sliding.hpp"
#include "geometry/tooth_form.hpp"
#include "geometry/tooth_measures.hpp"

namespace gear3k::geometry::kisssoft_stage_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMm = 1e-3;

double number(const toml::table& table, const std::string& key) {
  return table[key].value<double>().value();
}

/// Upper, lower and mean allowance of the report: which way each dimension goes.
enum class Limit { kNominal, kUpper, kLower, kMean };

/// The stage that the file describes.
class Stage {
 public:
  explicit Stage(const toml::table& file)
      : file_(file),
        module_m_(number(file, "module") * kMm),
        angle_(make_pressure_angle(number(file, "alpha") * kPi / 180.0)) {}

  double distance_m(Limit limit) const {
    const double allowance = number(file_, "center_distance_allowance");
    const double d = number(file_, "center_distance");
    return kMm * (limit == Limit::kUpper   ? d + allowance
                  : limit == Limit::kLower ? d - allowance
                                           : d);
  }
  /// k by the KHK rule.
  double ruled_tip_shortening() const {
    return khk_tip_shortening<double>({.teeth_sum = teeth("sun") + teeth("planet"),
                                       .module_m = module_m_,
                                       .shift_sum = number(entry("sun"), "profile_shift") +
                                                    number(entry("planet"), "profile_shift"),
                                       .center_distance_m = distance_m(Limit::kNominal)});
  }
  /// Thinned as `thickness` says, the tip circle at its largest, smallest or mean as `tip` says.
  GearGeometry<double> gear(const std::string& name, Limit thickness = Limit::kNominal,
                            Limit tip = Limit::kNominal) const {
    const toml::table& e = entry(name);
    const bool ring = name == "ring";
    Gear<double> g{.teeth = teeth(name),
                   .kind = ring ? GearKind::kRing : GearKind::kExternal,
                   .module_m = module_m_,
                   .profile_shift = number(e, "profile_shift"),
                   .machining_allowance = thinning_m(name, thickness) * angle_.cos / module_m_,
                   .tip_shortening = 0.0,
                   .rack = {},
                   .cutter = {}};
    const double share = tip == Limit::kLower ? 1.0 : tip == Limit::kMean ? 0.5 : 0.0;
    const double tip_radius_m = 0.5 * kMm *
                                (number(e, "tip_diameter") +
                                 (ring ? share : -share) * number(file_, "tip_diameter_allowance"));
    const double full_m = make_gear_geometry(g, angle_).tip_radius_m;
    g.tip_shortening = std::abs(full_m - tip_radius_m) / module_m_;
    if (ring) {
      const toml::table& cutter = *e["cutter"].as_table();
      g.rack.root_radius = number(cutter, "tip_radius");
      g.cutter = {.teeth = static_cast<int>(number(cutter, "teeth")),
                  .profile_shift = number(cutter, "profile_shift"),
                  .tip_radius = number(cutter, "tip_radius")};
    }
    return make_gear_geometry(g, angle_);
  }
  /// Cut by the nominal tool, fed deeper until the tooth is as thin as allowed.
  GearGeometry<double> fed_deeper(const std::string& name, Limit thickness,
                                  Limit tip = Limit::kNominal) const {
    const auto thinned = gear(name, thickness, tip);
    Gear<double> g = thinned.gear;
    const double x = g.profile_shift;
    g.profile_shift = infeed(thinned).profile_shift;
    g.machining_allowance = 0.0;
    if (g.kind == GearKind::kRing) {
      g.tip_shortening -= g.profile_shift - x;  // the tip circle is turned, not cut
      // A ring's cutter is given without its tip radius, which follows from the root circle.  The
      // report keeps the nominal cutter and feeds it deeper, so that the root circle moves by the
      // change of the generating distance: as deep a rack as leaves the cutter what it is.
      const auto nominal = make_tooth_form(gear(name));
      for (int i = 0; i < 3; ++i) {
        const auto form = make_tooth_form(make_gear_geometry(g, angle_));
        g.rack.dedendum += (nominal.cutter_tip_radius_m - form.cutter_tip_radius_m) / module_m_;
      }
    } else {
      g.tip_shortening += g.profile_shift - x;
    }
    return make_gear_geometry(g, angle_);
  }
  /// Smallest or largest tip and root circle.
  GearGeometry<double> with_manufactured_root(const std::string& name, Limit limit) const {
    auto g = gear(name, limit, limit);
    g.root_radius_m = infeed(g).root_radius_m;
    return g;
  }
  double thinning_m(const std::string& name, Limit limit) const {
    const toml::array& range = *entry(name)["thinning"].as_array();
    const double least = range[0].value<double>().value();
    const double greatest = range[1].value<double>().value();
    switch (limit) {
      case Limit::kUpper:
        return kMm * least;
      case Limit::kLower:
        return kMm * greatest;
      case Limit::kMean:
        return kMm * 0.5 * (least + greatest);
      case Limit::kNominal:
        break;
    }
    return 0.0;
  }
  double pin_diameter_m(const std::string& name) const {
    return number(entry(name), "pin_diameter") * kMm;
  }
  double module_m() const { return module_m_; }

 private:
  const toml::table& entry(const std::string& name) const { return *file_[name].as_table(); }
  int teeth(const std::string& name) const {
    return static_cast<int>(number(entry(name), "teeth"));
  }

  const toml::table& file_;
  double module_m_;
  PressureAngle<double> angle_;
};

using Values = std::map<std::string, double>;

double degrees(double rad) { return rad * 180.0 / kPi; }

/// Radius and roll angle of a flank's point from its distance along the line of action.
double diameter_mm(const GearGeometry<double>& g, double length_m) {
  return 2.0 * std::hypot(g.base_radius_m, length_m) / kMm;
}
double roll_angle_deg(const GearGeometry<double>& g, double length_m) {
  return degrees(length_m / g.base_radius_m);
}

constexpr std::array<std::pair<Limit, const char*>, 2> kLimits{
    {{Limit::kUpper, "_e"}, {Limit::kLower, "_i"}}};

Limit opposite(Limit limit) { return limit == Limit::kUpper ? Limit::kLower : Limit::kUpper; }

/// The pin that touches the flanks on the circle d + 2 x m.
double pin_touching_on_shifted_circle_m(const GearGeometry<double>& g) {
  const double target_m = g.reference_radius_m + g.gear.profile_shift * g.gear.module_m;
  double low = 1.5 * g.gear.module_m, high = 2.5 * g.gear.module_m;
  // A thicker pin sits farther out in a gear and farther in in a ring.
  const bool ring = g.gear.kind == GearKind::kRing;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const bool beyond = pin_measure(g, middle).value().contact_radius_m > target_m;
    (beyond != ring ? high : low) = middle;
  }
  return low;
}

void add_gear(const Stage& stage, const std::string& name, Values& values) {
  const auto add = [&](const std::string& quantity, double value) {
    values[quantity + "." + name] = value;
  };
  const auto g = stage.gear(name);
  const auto form = make_tooth_form(g);
  add("reference_diameter", 2.0 * g.reference_radius_m / kMm);
  add("base_diameter", 2.0 * g.base_radius_m / kMm);
  {
    Gear<double> ruled = g.gear;
    ruled.tip_shortening = name == "ring" ? 0.0 : stage.ruled_tip_shortening();
    add("tip_diameter_of_rule", 2.0 * make_gear_geometry(ruled, g.angle).tip_radius_m / kMm);
  }
  add("root_diameter", 2.0 * g.root_radius_m / kMm);
  add("addendum", std::abs(g.tip_radius_m - g.reference_radius_m) / kMm);
  add("dedendum", std::abs(g.root_radius_m - g.reference_radius_m) / kMm);
  add("tooth_height", std::abs(g.tip_radius_m - g.root_radius_m) / kMm);
  add("thickness_in_modules", reference_tooth_thickness(g) / stage.module_m());
  add("form_diameter", 2.0 * form.form_radius_m / kMm);
  add("tip_thickness", tooth_thickness(g, g.tip_radius_m) / kMm);
  if (const auto width = root_space_width(g)) add("root_space_width", *width / kMm);
  add("thickness_arc", reference_tooth_thickness(g) / kMm);
  add("thickness_chord", chordal_thickness(g).chord_m / kMm);
  add("chordal_height", chordal_thickness(g).height_m / kMm);
  {
    const double s = reference_tooth_thickness(g), r = g.reference_radius_m;
    const double series = s * s / (8.0 * r) - r * (1.0 - std::cos(s / (2.0 * r)));
    const double height =
        chordal_thickness(stage.gear(name, Limit::kNominal, Limit::kMean)).height_m;
    add("chordal_height_as_reported", (name == "ring" ? height - series : height + series) / kMm);
  }

  const double pin_m = stage.pin_diameter_m(name);
  const auto span = span_measure(g);
  ASSERT_TRUE(span);
  add("span_count", span->count);
  add("span", span->length_m / kMm);
  const auto pins = pin_measure(g, pin_m);
  ASSERT_TRUE(pins);
  EXPECT_EQ(pins->pin_diameter_m, pin_m);
  add("over_pins", pins->over_pins_m / kMm);
  const double sign = name == "ring" ? -1.0 : 1.0;
  const double share = g.gear.teeth % 2 == 1 ? std::cos(kPi / (2.0 * g.gear.teeth)) : 1.0;
  add("radial_over_pin",
      ((pins->over_pins_m - sign * pin_m) / (2.0 * share) + sign * 0.5 * pin_m) / kMm);
  add("theoretical_pin_diameter", pin_touching_on_shifted_circle_m(g) / kMm);
  const auto proposed = pin_measure(g, std::nullopt);
  ASSERT_TRUE(proposed);
  add("proposed_pin_diameter", proposed->pin_diameter_m / kMm);
  {
    const auto mean = stage.gear(name, Limit::kMean);
    add("span_contact_diameter", 2.0 * span_measure(mean).value().contact_radius_m / kMm);
    add("pin_contact_diameter", 2.0 * pin_measure(mean, pin_m).value().contact_radius_m / kMm);
  }

  for (const auto& [limit, suffix] : kLimits) {
    const auto add_limit = [&, end = std::string(suffix)](const std::string& quantity,
                                                          double value) {
      add(quantity + end, value);
    };
    const auto thinned = stage.gear(name, limit, limit);
    add_limit("generating_shift", infeed(thinned).profile_shift);
    add_limit("manufactured_root_diameter", 2.0 * infeed(thinned).root_radius_m / kMm);
    const auto deep_form = make_tooth_form(stage.fed_deeper(name, limit));
    add_limit("form_diameter", 2.0 * deep_form.form_radius_m / kMm);
    add_limit("form_roll_angle", roll_angle_deg(g, deep_form.form_length_m));
    add_limit("tip_roll_angle", roll_angle_deg(g, tip_curvature_radius(thinned)));
    // Thickest with the least thinning and the tip circle nearest to the root.
    const auto tipped = stage.gear(name, limit, opposite(limit));
    add_limit("tip_thickness", tooth_thickness(tipped, tipped.tip_radius_m) / kMm);
    add_limit("thickness_arc", reference_tooth_thickness(thinned) / kMm);
    add_limit("thickness_chord", chordal_thickness(thinned).chord_m / kMm);
    values["thickness_chord" + std::string(suffix) + "_as_reported." + name] =
        (chordal_thickness(g).chord_m - stage.thinning_m(name, limit)) / kMm;
    add_limit("span", span_measure(thinned).value().length_m / kMm);
    add_limit("over_pins", pin_measure(thinned, pin_m).value().over_pins_m / kMm);
  }
}

struct MeshCase {
  std::string name;            ///< of the mesh in the file
  std::string gear1, gear2;    ///< in Stage
  std::string value1, value2;  ///< in the file
};

void add_mesh(const Stage& stage, const MeshCase& c, Values& values) {
  const bool ring = c.gear2 == "ring";
  const auto add = [&](const std::string& quantity, const std::string& subject, double value) {
    values[quantity + "." + subject] = value;
  };
  const auto g1 = stage.gear(c.gear1), g2 = stage.gear(c.gear2);
  const auto mesh = make_mesh_geometry(g1, g2, stage.distance_m(Limit::kNominal)).value();
  const double pitch_m = mesh.base_pitch_m;
  add("working_angle", c.name, degrees(mesh.alpha_w_rad));
  add("base_pitch", c.name, pitch_m / kMm);
  add("contact_ratio", c.name, mesh.contact_ratio);
  add("path_length", c.name, mesh.contact_ratio * pitch_m / kMm);

  const std::array<const GearGeometry<double>*, 2> gears{&g1, &g2};
  const std::array<std::string, 2> names{c.gear1, c.gear2}, subjects{c.value1, c.value2};
  for (const int which : {1, 2}) {
    const auto i = static_cast<std::size_t>(which - 1);
    const auto& g = *gears[i];
    const auto& subject = subjects[i];
    add("pitch_diameter", subject, 2.0 * g.base_radius_m / std::cos(mesh.alpha_w_rad) / kMm);
    add("tip_clearance", subject, root_clearance(g1, g2, mesh, which) * stage.module_m() / kMm);
    const double root_m = active_root_length(g1, g2, mesh, which);
    const double tip_m = tip_curvature_radius(g);
    add("active_root_diameter", subject, diameter_mm(g, root_m));
    // A is the end at the tip of gear 1, E that at the tip of gear 2; B and D are a base pitch from
    // E and A.  On gear 1 of a mesh the distance falls from A to E; on a ring too.
    const bool falls = which == 1 || ring;
    const double a_m = which == 1 ? tip_m : root_m;
    const double e_m = which == 1 ? root_m : tip_m;
    const double b_m = e_m + (falls ? pitch_m : -pitch_m);
    const double d_m = a_m - (falls ? pitch_m : -pitch_m);
    add("length_A", subject, a_m / kMm);
    add("length_B", subject, b_m / kMm);
    add("length_C", subject, g.base_radius_m * mesh.tan_alpha_w / kMm);
    add("length_D", subject, d_m / kMm);
    add("length_E", subject, e_m / kMm);
    add("diameter_B", subject, diameter_mm(g, b_m));
    add("diameter_D", subject, diameter_mm(g, d_m));
    const auto sliding = tip_sliding(g1, g2, mesh, which);
    add("specific_sliding_tip", subject, sliding.specific_at_tip);
    add("specific_sliding_root", subjects[1 - i], sliding.specific_at_root);
    add("sliding_factor_tip", subject, sliding.sliding_factor);
  }

  for (const auto& [limit, suffix_text] : kLimits) {
    const std::string suffix = suffix_text;
    const bool upper = limit == Limit::kUpper;
    // The report's upper working angle of an internal mesh belongs to the upper (less negative)
    // distance: the lesser one.
    const Limit distance = ring ? opposite(limit) : limit;
    const auto far = make_mesh_geometry(g1, g2, stage.distance_m(distance)).value();
    add("working_angle" + suffix, c.name, degrees(far.alpha_w_rad));

    // Longest path: full tips, and the distance at which they reach farthest over each other.
    {
      const auto a = stage.gear(c.gear1, Limit::kNominal, limit);
      const auto b = stage.gear(c.gear2, Limit::kNominal, limit);
      const auto path = make_mesh_geometry(a, b, stage.distance_m(opposite(distance))).value();
      add("contact_ratio" + suffix, c.name, path.contact_ratio);
      add("path_length" + suffix, c.name, path.contact_ratio * pitch_m / kMm);
    }
    // Active root: farthest from the root with the mate's shortest tip and least overlap.
    {
      const auto a = stage.gear(c.gear1, Limit::kNominal, opposite(limit));
      const auto b = stage.gear(c.gear2, Limit::kNominal, opposite(limit));
      const auto path = make_mesh_geometry(a, b, stage.distance_m(distance)).value();
      for (const int which : {1, 2}) {
        const auto i = static_cast<std::size_t>(which - 1);
        const double root_m = active_root_length(a, b, path, which);
        add("active_root_diameter" + suffix, subjects[i], diameter_mm(*gears[i], root_m));
        add("active_root_roll_angle" + suffix, subjects[i], roll_angle_deg(*gears[i], root_m));
        const auto deep = make_tooth_form(stage.fed_deeper(names[i], opposite(limit)));
        add("form_reserve" + suffix, subjects[i],
            std::abs(0.5 * diameter_mm(*gears[i], root_m) - deep.form_radius_m / kMm));
      }
    }
    // Tip clearance: short tips, deep roots and the distance that separates them, and the reverse.
    {
      const auto a = stage.with_manufactured_root(c.gear1, opposite(limit));
      const auto b = stage.with_manufactured_root(c.gear2, opposite(limit));
      const auto roomy = make_mesh_geometry(a, b, stage.distance_m(distance)).value();
      for (const int which : {1, 2}) {
        add(upper ? "tip_clearance_upper" : "tip_clearance_lower",
            subjects[static_cast<std::size_t>(which - 1)],
            root_clearance(a, b, roomy, which) * stage.module_m() / kMm);
      }
      const auto a_thin = stage.fed_deeper(c.gear1, limit),
                 b_thin = stage.fed_deeper(c.gear2, limit);
      add("backlash_free_distance" + suffix, c.name,
          zero_backlash_center_distance(a_thin, b_thin).value() / kMm);
    }
    const double normal_m =
        backlash::normal_backlash(stage.gear(c.gear1, limit), stage.gear(c.gear2, limit), mesh);
    add(upper ? "circumferential_backlash_least" : "circumferential_backlash_greatest", c.name,
        normal_m / std::cos(mesh.alpha_w_rad) / kMm);
  }
}

TEST(KisssoftStage, EveryFigureIsReproducedToItsPrintedDigits) {
  const toml::table file =
      toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/kisssoft_stage_01.toml");
  ASSERT_NE(std::string(file["cite"].value_or("")), "");
  ASSERT_NE(std::string(file["locator"].value_or("")), "");
  const Stage stage(file);
  Values values;
  for (const char* name : {"sun", "planet", "ring"}) add_gear(stage, name, values);
  for (const char* name : {"sun", "planet"}) {
    values[std::string("tip_alteration.") + name] =
        stage.ruled_tip_shortening() * stage.module_m() / kMm;
  }
  add_mesh(stage,
           {.name = "sun_planet",
            .gear1 = "sun",
            .gear2 = "planet",
            .value1 = "sun",
            .value2 = "planet_with_sun"},
           values);
  add_mesh(stage,
           {.name = "planet_ring",
            .gear1 = "planet",
            .gear2 = "ring",
            .value1 = "planet_with_ring",
            .value2 = "ring"},
           values);
  int compared = 0;
  for (const toml::node& node : *file["expect"].as_array()) {
    const toml::table& row = *node.as_table();
    const std::string quantity = row["quantity"].value_or("");
    const int decimals = row["decimals"].value_or(file["decimals"].value<int>().value());
    double tolerance = 0.5 * std::pow(10.0, -decimals);  // half a unit of the last printed digit
    if (const auto wider = row["tolerance"].value<double>()) {
      ASSERT_NE(std::string(row["reason"].value_or("")), "") << quantity;
      tolerance = *wider;
    }
    for (const auto& [key, value] : row) {
      const std::string subject(key.str());
      if (subject == "quantity" || subject == "decimals" || subject == "tolerance" ||
          subject == "reason") {
        continue;
      }
      const std::string name = fmt::format("{}.{}", quantity, subject);
      ASSERT_TRUE(values.contains(name)) << name;
      EXPECT_NEAR(values.at(name), value.value<double>().value(), tolerance) << name;
      ++compared;
    }
  }
  EXPECT_GE(compared, 230);
}

TEST(KisssoftStage, RootCircleInsideTheBaseCircleHasNoSpaceWidth) {
  // The report prints 0.000 for the sun.
  const toml::table file =
      toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/kisssoft_stage_01.toml");
  EXPECT_FALSE(root_space_width(Stage(file).gear("sun")));
}

}  // namespace
}  // namespace gear3k::geometry::kisssoft_stage_test
