// Published calculations by the KHK formulas: tests/golden/khk_pairs.toml.

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>

#include "geometry/involute.hpp"
#include "geometry/mesh.hpp"
#include "geometry/tooth_measures.hpp"

namespace gear3k::geometry::khk_pairs_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMm = 1e-3;

std::optional<double> number(const toml::table& table, const std::string& key) {
  return table[key].value<double>();
}

using Values = std::map<std::string, double>;

void add_gear(const GearGeometry<double>& g, const std::string& index, Values& values) {
  values["addendum" + index] = std::abs(g.tip_radius_m - g.reference_radius_m) / kMm;
  values["dedendum" + index] = std::abs(g.root_radius_m - g.reference_radius_m) / kMm;
  values["whole_depth" + index] = std::abs(g.tip_radius_m - g.root_radius_m) / kMm;
  values["generating_shift" + index] = infeed(g).profile_shift;
  values["chordal_thickness" + index] = chordal_thickness(g).chord_m / kMm;
  values["chordal_height" + index] = chordal_thickness(g).height_m / kMm;
}

Values values_of(const toml::table& in) {
  const std::string kind = in["kind"].value_or("");
  const auto rad = [&](const char* key) { return number(in, key).value() * kPi / 180.0; };
  const auto angle = make_pressure_angle(
      in.contains("helix_angle")
          ? std::atan(std::tan(rad("normal_alpha")) / std::cos(rad("helix_angle")))
          : rad("alpha"));
  // Transverse module and shift from the normal ones: m_t = m_n/cos beta, tan alpha_t = tan
  // alpha_n/cos beta, x_t m_t = x_n m_n.
  double m = kMm * number(in, "module").value_or(0.0);
  double shift_share = 1.0;
  if (const auto normal = number(in, "normal_module")) {
    shift_share = std::tan(rad("normal_alpha")) / angle.tan;
    m = kMm * *normal / shift_share;
  }
  const auto gear = [&](const std::string& index, GearKind gear_kind, double shortening) {
    return make_gear_geometry<double>(
        {.teeth = static_cast<int>(number(in, "z" + index).value()),
         .kind = gear_kind,
         .module_m = m,
         .profile_shift = number(in, "x" + index).value() * shift_share,
         .machining_allowance = number(in, "normal_backlash").value_or(0.0) * kMm / m,
         .tip_shortening = shortening,
         .rack = {},
         .cutter = {}},
        angle);
  };
  Values values;
  values["involute"] = angle.involute;
  if (kind == "gear") {
    add_gear(gear("1", GearKind::kExternal, 0.0), "1", values);
    return values;
  }
  const GearKind kind2 = kind == "internal" ? GearKind::kRing : GearKind::kExternal;
  const double d = number(in, "center_distance").value() * kMm;
  double shortening = 0.0;
  if (in["tip_rule"].value_or("") == std::string("khk")) {
    shortening = khk_tip_shortening<double>(
        {.teeth_sum = in["z1"].value<int>().value() + in["z2"].value<int>().value(),
         .module_m = m,
         .shift_sum = number(in, "x1").value() + number(in, "x2").value(),
         .center_distance_m = d});
  }
  const auto g1 = gear("1", GearKind::kExternal, shortening);
  const auto g2 = gear("2", kind2, shortening);
  add_gear(g1, "1", values);
  add_gear(g2, "2", values);
  const auto mesh = make_mesh_geometry(g1, g2, d).value();
  const double reference_m = g2.reference_radius_m + mesh_sign(kind2) * g1.reference_radius_m;
  const double cos_w = std::cos(mesh.alpha_w_rad);
  values["tip_shortening"] = shortening;
  values["reference_distance"] = reference_m / kMm;
  values["distance_modification"] = (d - reference_m) / m;
  values["working_angle"] = mesh.alpha_w_rad * 180.0 / kPi;
  values["working_involute"] = involute(zero_backlash_angle(g1, g2).value());
  values["zero_backlash_distance"] = zero_backlash_center_distance(g1, g2).value() / kMm;
  values["pitch_diameter1"] = 2.0 * g1.base_radius_m / cos_w / kMm;
  values["pitch_diameter2"] = 2.0 * g2.base_radius_m / cos_w / kMm;
  return values;
}

TEST(KhkPairs, PublishedPairsAreReproducedToTheirPrintedDigits) {
  const toml::table file = toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/khk_pairs.toml");
  int compared = 0;
  for (const toml::node& node : *file["case"].as_array()) {
    const toml::table& c = *node.as_table();
    SCOPED_TRACE(c["id"].value_or("(no id)"));
    ASSERT_NE(std::string(c["cite"].value_or("")), "");
    ASSERT_NE(std::string(c["locator"].value_or("")), "");
    const auto values = values_of(*c["inputs"].as_table());
    for (const toml::node& item : *c["expect"].as_array()) {
      const toml::table& e = *item.as_table();
      const std::string quantity = e["quantity"].value_or("");
      ASSERT_TRUE(values.contains(quantity)) << quantity;
      double tolerance = 0.0;
      if (const auto decimals = e["decimals"].value<int>()) {
        tolerance = 0.5 * std::pow(10.0, -*decimals);  // half a unit of the last printed digit
      } else if (const auto stated = number(e, "tolerance")) {
        ASSERT_NE(std::string(e["reason"].value_or("")), "") << quantity;
        tolerance = *stated;
      } else {
        tolerance = number(c, "tolerance").value();  // stated by the source
      }
      EXPECT_NEAR(values.at(quantity), number(e, "value").value(), tolerance) << quantity;
      ++compared;
    }
  }
  EXPECT_GE(compared, 36);
}

}  // namespace
}  // namespace gear3k::geometry::khk_pairs_test
