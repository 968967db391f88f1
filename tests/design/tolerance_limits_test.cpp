// Gearboxes within their tolerances: against a KISSsoft report, and against evaluate() of drawings
// that are changed by hand.

#include "design/tolerance_limits.hpp"

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "tests/design/redrawn.hpp"
#include "tests/strength/steel.hpp"

namespace gear3k::design::tolerance_limits_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMm = 1e-3;
constexpr double kMicrometre = 1e-6;
const std::string kRoot = GEAR3K_SOURCE_DIR;

// ---- KISSsoft's report ------------------------------------------------------------------------

/// A printed quantity of ours, in the unit of the golden file.
struct Printed {
  BuiltRange range;
  double unit = kMm;
};

/// Everything that the golden file has limits of, by "quantity.subject".
class ReportedStage {
 public:
  ReportedStage() {
    add_pair(
        "wind_turbine_sun_planet",
        {.mesh = "sun_planet", .gears = {"sun", "planet"}, .members = {"sun", "planet_with_sun"}});
    add_pair("wind_turbine_planet_ring", {.mesh = "planet_ring",
                                          .gears = {"planet", "ring"},
                                          .members = {"planet_with_ring", "ring"}});
  }
  const std::map<std::string, Printed>& values() const { return values_; }

 private:
  struct Names {
    std::string mesh;
    std::array<std::string, 2> gears, members;
  };
  void add_pair(const std::string& file, const Names& names) {
    const PairDesign design = io::read_pair(kRoot + "/examples/pairs/" + file + ".toml");
    const auto result = evaluate(design);
    const auto& limits = std::get<PairEvaluation>(result).tolerance_limits;
    ASSERT_TRUE(limits);
    const MeshLimits& m = limits->meshes.at(0);
    const auto add = [&](const std::string& quantity, const std::string& subject,
                         const BuiltRange& range, double unit) {
      values_[quantity + "." + subject] = {.range = range, .unit = unit};
    };
    add("circumferential_backlash", names.mesh, m.circumferential_backlash_m, kMm);
    add("radial_backlash", names.mesh, m.radial_backlash_m, kMm);
    add("contact_ratio", names.mesh, m.contact_ratio, 1.0);
    add("working_angle", names.mesh, m.working_pressure_angle_rad, kPi / 180.0);
    {
      // j_bn/cos α_w cos α: the greatest backlash is at the greatest working angle, of a ring at
      // the least.
      const bool ring = design.gear2.kind == geometry::GearKind::kRing;
      const BuiltRange& angle = m.working_pressure_angle_rad;
      const double to_least = std::cos(ring ? angle.greatest : angle.least);
      const double to_greatest = std::cos(ring ? angle.least : angle.greatest);
      const double cos_alpha = std::cos(design.pressure_angle_rad);
      const BuiltRange& j = m.normal_backlash_m;
      add("normal_backlash_as_reported", names.mesh,
          {.least = j.least / to_least * cos_alpha,
           .nominal = j.nominal,
           .greatest = j.greatest / to_greatest * cos_alpha},
          kMm);
    }
    for (const std::size_t i : {0U, 1U}) {
      add("tip_clearance", names.members[i], m.root_clearance_m[i], kMm);
      add("active_root_diameter", names.members[i], m.active_root_diameter_m[i], kMm);
      add("form_reserve", names.members[i], m.form_reserve_m[i], kMm);
      const GearLimits& g = limits->gears.at(i);
      add("generating_shift", names.gears[i], g.generating_shift, 1.0);
      add("thickness_arc", names.gears[i], g.tooth_thickness_m, kMm);
      add("manufactured_root_diameter", names.gears[i], g.root_diameter_m, kMm);
      add("root_diameter", names.gears[i], g.root_diameter_m, kMm);
      add("form_diameter", names.gears[i], g.form_diameter_m, kMm);
      add("tip_thickness", names.gears[i], g.tip_thickness_m, kMm);
    }
  }

  std::map<std::string, Printed> values_;
};

bool is_note(std::string_view key) {
  return key == "quantity" || key == "decimals" || key == "tolerance" || key == "reason";
}

TEST(ToleranceLimits, KisssoftsMinimumNominalAndMaximumToTheirPrintedDigits) {
  const toml::table file = toml::parse_file(kRoot + "/tests/golden/kisssoft_stage_01.toml");
  const std::map<std::string, Printed> values = ReportedStage().values();
  const auto tolerance_of = [&](const toml::table& row) {
    EXPECT_EQ(row.contains("tolerance"), row.contains("reason"));
    const int decimals = row["decimals"].value_or(file["decimals"].value<int>().value());
    return row["tolerance"].value_or(0.5 * std::pow(10.0, -decimals));
  };
  // Upper and lower allowance, by subject; which of the two is the greater is the report's sign.
  struct Ends {
    std::vector<double> values;
    double tolerance = 0.0;
  };
  std::map<std::string, Ends> ends;
  int nominals = 0, ranges = 0;
  for (const toml::node& node : *file["expect"].as_array()) {
    const toml::table& row = *node.as_table();
    std::string quantity = row["quantity"].value_or("");
    bool end = false;
    for (const char* suffix : {"_e", "_i", "_upper", "_lower"}) {
      if (!quantity.ends_with(suffix)) continue;
      quantity.resize(quantity.size() - std::string(suffix).size());
      end = true;
    }
    for (const auto& [key, value] : row) {
      if (is_note(key.str())) continue;
      const std::string name = quantity + "." + std::string(key.str());
      const auto ours = values.find(name);
      if (ours == values.end()) continue;
      if (end) {
        ends[name].values.push_back(value.value<double>().value());
        ends[name].tolerance = tolerance_of(row);
        continue;
      }
      EXPECT_NEAR(ours->second.range.nominal / ours->second.unit, value.value<double>().value(),
                  tolerance_of(row))
          << name;
      ++nominals;
    }
  }
  for (const toml::node& node : *file["range"].as_array()) {
    const toml::table& row = *node.as_table();
    for (const auto& [key, value] : row) {
      if (is_note(key.str())) continue;
      const std::string name =
          std::string(row["quantity"].value_or("")) + "." + std::string(key.str());
      const toml::array& range = *value.as_array();
      ends[name] = {.values = {range[0].value<double>().value(), range[1].value<double>().value()},
                    .tolerance = tolerance_of(row)};
    }
  }
  for (const auto& [name, printed] : ends) {
    ASSERT_TRUE(values.contains(name)) << name;
    ASSERT_EQ(printed.values.size(), 2U) << name;
    const auto [least, greatest] = std::ranges::minmax(printed.values);
    const Printed& ours = values.at(name);
    EXPECT_NEAR(ours.range.least / ours.unit, least, printed.tolerance) << name;
    EXPECT_NEAR(ours.range.greatest / ours.unit, greatest, printed.tolerance) << name;
    ++ranges;
  }
  EXPECT_GE(nominals, 24);
  EXPECT_GE(ranges, 35);
}

// ---- Drawings changed by hand -----------------------------------------------------------------

Evaluation evaluated(const Design& design) { return std::get<Evaluation>(evaluate(design)); }

/// Every quantity of a gearbox that has limits, in the order of quantities(limits).
std::vector<double> quantities(const Evaluation& e) {
  std::vector<double> all{e.lost_motion.kinematic_rad};
  for (const MeshResult& m : e.meshes) {
    all.insert(all.end(),
               {m.normal_backlash_m, m.normal_backlash_m / std::cos(m.working_pressure_angle_rad),
                m.contact_ratio, m.working_pressure_angle_rad, m.root_clearance_m[0],
                m.root_clearance_m[1], m.active_root_diameter_m[0].value(),
                m.active_root_diameter_m[1].value()});
    const auto& pair = train::kMeshGears[static_cast<std::size_t>(&m - e.meshes.data())];
    for (const std::size_t i : {0U, 1U}) {
      const GearResult& g = e.gears[static_cast<std::size_t>(pair[i])];
      const double room_m = 0.5 * (m.active_root_diameter_m[i].value() - g.tooth.form_diameter_m);
      const auto kind = train::kind_of(pair[i]);
      all.push_back(kind == geometry::GearKind::kRing ? -room_m : room_m);
    }
  }
  for (const GearResult& g : e.gears) {
    all.insert(all.end(), {g.tooth.infeed.profile_shift, g.tip_diameter_m, g.root_diameter_m,
                           g.tooth.form_diameter_m, g.tip_thickness_m});
  }
  for (const CheckResult& c : e.checks) all.push_back(c.margin);
  return all;
}
std::vector<BuiltRange> quantities(const ToleranceLimits& limits) {
  std::vector<BuiltRange> all{limits.lost_motion_rad.value()};
  for (const MeshLimits& m : limits.meshes) {
    all.insert(all.end(), {m.normal_backlash_m, m.circumferential_backlash_m, m.contact_ratio,
                           m.working_pressure_angle_rad, m.root_clearance_m[0],
                           m.root_clearance_m[1], m.active_root_diameter_m[0],
                           m.active_root_diameter_m[1], m.form_reserve_m[0], m.form_reserve_m[1]});
  }
  for (const GearLimits& g : limits.gears) {
    all.insert(all.end(), {g.generating_shift, g.tip_diameter_m, g.root_diameter_m,
                           g.form_diameter_m, g.tip_thickness_m});
  }
  for (const CheckLimits& c : limits.checks) all.push_back(c.margin);
  return all;
}

constexpr std::array<const char*, 3> kDesigns{"low_backlash_prototype", "bilateral_drive_gear",
                                              "ratio_96_with_losses"};

/// A published design with every check on, thinned teeth and deviations of every kind; rooted: the
/// planets' and a ring's root diameters are stated too.
Design tolerated(const char* name, bool rooted) {
  Design d = io::read_design(kRoot + "/examples/designs/" + name + ".toml");
  for (auto& limit : d.limits.limit) limit = limit.value_or(0.0);
  d.axial.extent.fill(train::AxialInterval{.from_m = 0.0, .to_m = 0.01});
  d.axial.carrier_radius_m = 0.02;
  d.train.machining_allowance.fill(0.02);
  backlash::Tolerances t;
  t.center_distance_m = {.lower = -12.0 * kMicrometre, .upper = 8.0 * kMicrometre};
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const double step = static_cast<double>(i);
    t.gears[i].tooth_thickness_m = {.lower = (-30.0 - step) * kMicrometre,
                                    .upper = (-8.0 + 3.0 * step) * kMicrometre};
    t.gears[i].tip_diameter_m = {.lower = -40.0 * kMicrometre, .upper = step * kMicrometre};
  }
  if (rooted) {
    for (const std::size_t i : {train::kP1, train::kR2}) {
      t.gears[i].root_diameter_m = {.lower = -50.0 * kMicrometre, .upper = 20.0 * kMicrometre};
    }
  }
  d.tolerances = t;
  return d;
}

/// Rounding: a few digits of quantities that are differences of the gearbox's own dimensions.
constexpr double kRounding = 1e-11;

TEST(ToleranceLimits, AreTheExtremesOverEveryCornerOfTheWholeGearbox) {
  const Design design = tolerated("low_backlash_prototype", false);
  const auto ranges = quantities(evaluated(design).tolerance_limits.value());
  std::vector<double> least(ranges.size(), 1e300), greatest(ranges.size(), -1e300);
  constexpr unsigned kCorners = 1U << (1U + 2U * train::kGearCount);
  for (unsigned corner = 0; corner < kCorners; ++corner) {
    unsigned bits = corner;
    const Built built = built_by(*design.tolerances, [&](const backlash::DeviationLimits& l) {
      const bool upper = (bits & 1U) != 0;
      bits >>= 1U;
      return upper ? l.upper : l.lower;
    });
    const auto values = quantities(evaluated(redrawn(design, built)));
    ASSERT_EQ(values.size(), ranges.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      least[i] = std::min(least[i], values[i]);
      greatest[i] = std::max(greatest[i], values[i]);
    }
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    EXPECT_NEAR(ranges[i].least, least[i], kRounding) << i;
    EXPECT_NEAR(ranges[i].greatest, greatest[i], kRounding) << i;
  }
}

TEST(ToleranceLimits, NoGearboxInsideTheTolerancesExceedsThem) {
  std::mt19937_64 generator(7);
  for (const char* name : kDesigns) {
    for (const bool rooted : {false, true}) {
      const Design design = tolerated(name, rooted);
      const auto limits = evaluated(design).tolerance_limits.value();
      const auto ranges = quantities(limits);
      const std::size_t first_check = ranges.size() - limits.checks.size();
      for (int sample = 0; sample < 400; ++sample) {
        const Built built = built_by(*design.tolerances, [&](const backlash::DeviationLimits& l) {
          return std::uniform_real_distribution<double>(l.lower, l.upper)(generator);
        });
        const auto values = quantities(evaluated(redrawn(design, built)));
        for (std::size_t i = 0; i < values.size(); ++i) {
          const std::string what = i < first_check
                                       ? std::to_string(i)
                                       : std::string(limits.checks[i - first_check].record->name);
          EXPECT_GE(values[i], ranges[i].least - kRounding) << name << " " << what;
          // |d - own| is least inside, where the distance is the mesh's own; a gap that is the
          // least of several along a fillet may be greatest where two of them are equal.
          if (what == "coaxiality" || what == "tip_fouling") continue;
          EXPECT_LE(values[i], ranges[i].greatest + kRounding) << name << " " << what;
        }
      }
    }
  }
}

TEST(ToleranceLimits, NominalIsTheDrawnGearbox) {
  for (const char* name : kDesigns) {
    const Evaluation e = evaluated(tolerated(name, true));
    const auto drawn = quantities(e);
    const auto ranges = quantities(e.tolerance_limits.value());
    ASSERT_EQ(drawn.size(), ranges.size());
    for (std::size_t i = 0; i < drawn.size(); ++i) EXPECT_EQ(ranges[i].nominal, drawn[i]) << i;
  }
}

TEST(ToleranceLimits, RadialBacklashIsTheMoveOfTheAxesThatUsesUpTheBacklash) {
  for (const char* file : {"wind_turbine_sun_planet", "wind_turbine_planet_ring"}) {
    PairDesign pair = io::read_pair(kRoot + "/examples/pairs/" + file + ".toml");
    pair.tolerances.reset();
    pair.tolerances = backlash::PairTolerances{};
    pair.gear1.machining_allowance = 0.01;
    const auto drawn = std::get<PairEvaluation>(evaluate(pair));
    const double j_r = drawn.tolerance_limits->meshes[0].radial_backlash_m.nominal;
    EXPECT_GT(j_r, 0.0);
    const bool ring = pair.gear2.kind == geometry::GearKind::kRing;
    pair.center_distance_m = drawn.center_distance_m + (ring ? j_r : -j_r);
    const auto closed = std::get<PairEvaluation>(evaluate(pair));
    EXPECT_NEAR(closed.mesh.normal_backlash_m, 0.0, 1e-12) << file;
  }
}

TEST(ToleranceLimits, WithoutToleranceEveryGearboxIsTheDrawnOne) {
  Design design = io::read_design(kRoot + "/examples/designs/bilateral_drive_gear.toml");
  EXPECT_FALSE(evaluated(design).tolerance_limits);
  design.tolerances = backlash::Tolerances{};
  for (const BuiltRange& r : quantities(evaluated(design).tolerance_limits.value())) {
    EXPECT_EQ(r.least, r.nominal);
    EXPECT_EQ(r.greatest, r.nominal);
  }
}

TEST(ToleranceLimits, CheckFailsWhereItsWorstCornerDoes) {
  Design design = tolerated("low_backlash_prototype", false);
  const auto before = evaluated(design).tolerance_limits.value();
  const CheckLimits& backlash = *std::ranges::find_if(before.checks, [](const CheckLimits& c) {
    return c.record->id == CheckId::kNormalBacklash && c.mesh == "P2-R2";
  });
  // A limit between the least backlash and the drawn one: holds as drawn, not as built.
  auto& limit = design.limits[CheckId::kNormalBacklash];
  limit = *limit + 0.5 * (backlash.margin.least + backlash.margin.nominal);
  const Evaluation e = evaluated(design);
  for (std::size_t i = 0; i < e.checks.size(); ++i) {
    if (e.checks[i].record->id != CheckId::kNormalBacklash || e.checks[i].mesh != "P2-R2") continue;
    EXPECT_TRUE(e.checks[i].ok);
    EXPECT_FALSE(e.tolerance_limits->checks[i].holds);
    return;
  }
  FAIL() << "no such check";
}

TEST(ToleranceLimits, NoneWhereAnEndOfTheCentreDistanceLeavesNoWorkingAngle) {
  Design design = io::read_design(kRoot + "/examples/designs/low_backlash_prototype.toml");
  design.tolerances = backlash::Tolerances{};
  design.tolerances->center_distance_m = {.lower = -3e-3, .upper = 0.0};
  const Evaluation e = evaluated(design);
  EXPECT_FALSE(e.tolerance_limits);
  EXPECT_TRUE(std::ranges::any_of(e.notes, [](const std::string& note) {
    return note.find("tolerances.center_distance_um") != std::string::npos;
  }));
}

// ---- Under load ---------------------------------------------------------------------------------

/// Every check that reads a rating, with bearings, pin, overload, grade, misalignment and speed.
Design rated_design() {
  Design d = io::read_design(kRoot + "/examples/designs/loaded.toml");
  d.limits[CheckId::kBearingLoad] = 2000.0;
  d.limits[CheckId::kPinStress] = 500e6;
  d.rating->pin_diameter_m = 5e-3;
  d.rating->overload = 1.5;
  d.rating->accuracy_grade = 6;
  d.rating->misalignment_m = 4e-6;
  d.rating->speed_rad_s = 300.0;
  d.rating->rim_radius_m[train::kP1] = 12e-3;
  backlash::Tolerances t;
  t.center_distance_m = {.lower = -6.0 * kMicrometre, .upper = 6.0 * kMicrometre};
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    t.gears[i].tooth_thickness_m = {.lower = -24.0 * kMicrometre, .upper = -4.0 * kMicrometre};
    t.gears[i].tip_diameter_m = {.lower = -20.0 * kMicrometre, .upper = 5.0 * kMicrometre};
  }
  d.tolerances = t;
  return d;
}

/// Margins of the checks under load, in their scale.
std::vector<double> rated_margins(const std::vector<CheckResult>& checks) {
  std::vector<double> margins;
  for (const CheckResult& c : checks) {
    if (c.record->rating) margins.push_back(c.margin / std::max(1.0, std::abs(c.limit)));
  }
  return margins;
}
struct RatedLimit {
  std::string name;
  BuiltRange margin;
};
std::vector<RatedLimit> rated_limits(const ToleranceLimits& limits,
                                     const std::vector<CheckResult>& checks) {
  std::vector<RatedLimit> all;
  for (std::size_t i = 0; i < checks.size(); ++i) {
    const CheckLimits& c = limits.checks[i];
    if (!c.record->rating) continue;
    const double scale = 1.0 / std::max(1.0, std::abs(checks[i].limit));
    all.push_back({.name = std::string(c.record->name) + " " + c.mesh + " " + c.gear,
                   .margin = {.least = scale * c.margin.least,
                              .nominal = scale * c.margin.nominal,
                              .greatest = scale * c.margin.greatest}});
  }
  return all;
}

TEST(ToleranceLimitsUnderLoad, AreTheExtremesOverEveryCornerOfTheWholeGearbox) {
  Design design = rated_design();
  // What stays as drawn halves the number of corners.
  for (const std::size_t i : {train::kR1, train::kP2}) {
    design.tolerances->gears[i].tooth_thickness_m = {};
  }
  design.tolerances->gears[train::kR2].tip_diameter_m = {};
  const Evaluation drawn = evaluated(design);
  const auto ranges = rated_limits(drawn.tolerance_limits.value(), drawn.checks);
  std::vector<double> least(ranges.size(), 1e300), greatest(ranges.size(), -1e300);
  for (unsigned corner = 0; corner < 256; ++corner) {
    unsigned bits = corner;
    const Built built = built_by(*design.tolerances, [&](const backlash::DeviationLimits& l) {
      if (l.lower == l.upper) return l.lower;
      const bool upper = (bits & 1U) != 0;
      bits >>= 1U;
      return upper ? l.upper : l.lower;
    });
    const auto values = rated_margins(evaluated(redrawn(design, built)).checks);
    ASSERT_EQ(values.size(), ranges.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      least[i] = std::min(least[i], values[i]);
      greatest[i] = std::max(greatest[i], values[i]);
    }
  }
  int deviating = 0;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    // Another drawing has other masses of planets, whose centrifugal forces the drawn gearbox
    // keeps.
    const bool by_mass = ranges[i].name.starts_with("bearing") || ranges[i].name.starts_with("pin");
    const double allowed = by_mass ? 1e-6 : kRounding;
    EXPECT_NEAR(ranges[i].margin.least, least[i], allowed) << ranges[i].name;
    EXPECT_NEAR(ranges[i].margin.greatest, greatest[i], allowed) << ranges[i].name;
    if (ranges[i].margin.greatest - ranges[i].margin.least > 1e-4) ++deviating;
  }
  EXPECT_GE(deviating, 20);
}

TEST(ToleranceLimitsUnderLoad, NoGearboxInsideTheTolerancesExceedsThem) {
  std::mt19937_64 generator(11);
  for (const bool rooted : {false, true}) {
    Design design = rated_design();
    if (rooted) {
      design.tolerances->gears[train::kS].root_diameter_m = {.lower = -50.0 * kMicrometre,
                                                             .upper = 10.0 * kMicrometre};
    }
    const Evaluation drawn = evaluated(design);
    const auto ranges = rated_limits(drawn.tolerance_limits.value(), drawn.checks);
    for (int sample = 0; sample < 300; ++sample) {
      const Built built = built_by(*design.tolerances, [&](const backlash::DeviationLimits& l) {
        return std::uniform_real_distribution<double>(l.lower, l.upper)(generator);
      });
      const auto values = rated_margins(evaluated(redrawn(design, built)).checks);
      for (std::size_t i = 0; i < values.size(); ++i) {
        EXPECT_GE(values[i], ranges[i].margin.least - kRounding) << ranges[i].name;
        // The nearer end of a range is the least of two margins, greatest where they are equal.
        if (ranges[i].name.starts_with("shift_sum_range")) continue;
        EXPECT_LE(values[i], ranges[i].margin.greatest + kRounding) << ranges[i].name;
      }
    }
  }
}

TEST(ToleranceLimitsUnderLoad, NoneIsBelowTheLeastWhereFactorsHaveKinks) {
  // K_Halpha at either of its bounds, contact ratios on both sides of 2, Z_B from 1 on.
  std::mt19937_64 generator(3);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
  };
  std::array<int, 2> contacts{};  // below 2, above
  for (int variant = 0; variant < 24; ++variant) {
    Design design = rated_design();
    design.rating->accuracy_grade = 3 + variant % 6;
    design.rating->torque_Nm = between(2.0, 60.0);
    design.rating->misalignment_m = between(0.0, 10.0 * kMicrometre);
    for (double& shortening : design.train.tip_shortening) shortening = between(-0.25, 0.1);
    const Evaluation drawn = evaluated(design);
    const auto ranges = rated_limits(drawn.tolerance_limits.value(), drawn.checks);
    for (const MeshResult& mesh : drawn.meshes) ++contacts[mesh.contact_ratio > 2.0 ? 1 : 0];
    for (int sample = 0; sample < 30; ++sample) {
      const Built built = built_by(*design.tolerances, [&](const backlash::DeviationLimits& l) {
        return between(l.lower, l.upper);
      });
      const auto values = rated_margins(evaluated(redrawn(design, built)).checks);
      for (std::size_t i = 0; i < values.size(); ++i) {
        EXPECT_GE(values[i], ranges[i].margin.least - kRounding) << ranges[i].name;
      }
    }
  }
  EXPECT_GE(contacts[0], 20);
  EXPECT_GE(contacts[1], 5);
}

TEST(ToleranceLimitsUnderLoad, NominalIsTheDrawnGearbox) {
  const Design design = rated_design();
  const Evaluation e = evaluated(design);
  const auto drawn = rated_margins(e.checks);
  const auto ranges = rated_limits(e.tolerance_limits.value(), e.checks);
  ASSERT_EQ(drawn.size(), ranges.size());
  EXPECT_GE(drawn.size(), 30U);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    EXPECT_NEAR(ranges[i].margin.nominal, drawn[i], 1e-15) << ranges[i].name;
  }
}

// Nothing but the rating of the sun's own teeth reads its rim.
TEST(ToleranceLimitsUnderLoad, AGearWithoutRimInACornerIsSaidAndHasNoRangeTheOthersKeepTheirs) {
  Design design = rated_design();
  design.tolerances->gears[train::kS].root_diameter_m = {.lower = -20.0 * kMicrometre,
                                                         .upper = 0.0};
  const Evaluation solid = evaluated(design);
  ASSERT_TRUE(solid.tolerance_limits.value().gears_without_rim.empty());
  design.rating->rim_radius_m[train::kS] =
      0.5 * solid.gears[train::kS].root_diameter_m - 5.0 * kMicrometre;
  const Evaluation bored = evaluated(design);
  EXPECT_EQ(bored.tolerance_limits.value().gears_without_rim, std::vector<std::string>{"S"});
  const auto said = [](const Evaluation& e) {
    return std::ranges::count_if(e.notes, [](const std::string& note) {
      return note.find("no material is left under the root of S:") != std::string::npos;
    });
  };
  EXPECT_EQ(said(bored), 1);
  EXPECT_EQ(said(solid), 0);
  const std::vector<CheckLimits>& expected = solid.tolerance_limits->checks;
  std::size_t next = 0;
  int without = 0, kept = 0;
  for (const CheckLimits& c : bored.tolerance_limits->checks) {
    const std::string name = std::string(c.record->name) + " " + c.mesh + " " + c.gear;
    const bool of_sun = c.record->rating && c.gear == "S";
    if (of_sun) {
      EXPECT_TRUE(std::isnan(c.margin.least) && std::isnan(c.margin.greatest)) << name;
      EXPECT_TRUE(std::isfinite(c.margin.nominal)) << name;
      EXPECT_FALSE(c.holds) << name;
      ++without;
    }
    // A solid sun has no rim to check.
    if (of_sun && c.record->id == CheckId::kRimThickness) continue;
    ASSERT_LT(next, expected.size());
    const CheckLimits& same = expected[next++];
    ASSERT_EQ(same.record, c.record) << name;
    if (of_sun) continue;
    EXPECT_EQ(c.margin.least, same.margin.least) << name;
    EXPECT_EQ(c.margin.greatest, same.margin.greatest) << name;
    if (c.record->rating) ++kept;
  }
  EXPECT_EQ(next, expected.size());
  EXPECT_GE(without, 5);
  EXPECT_GE(kept, 20);
}

TEST(ToleranceLimitsUnderLoad, OfAPairAreThoseOfPairsThatAreDrawnSo) {
  PairDesign pair = io::read_pair(kRoot + "/examples/pairs/dry_steel_pair.toml");
  strength::RatingTask task;
  task.material[0] = task.material[1] = strength::steel_700_290();
  task.torque_Nm = 1.0;
  task.face_width_m = {5e-3, 5e-3};
  task.speed_rad_s = 100.0;
  task.accuracy_grade = 7;
  pair.rating = task;
  backlash::PairTolerances t;
  t.center_distance_m = {.lower = -5.0 * kMicrometre, .upper = 8.0 * kMicrometre};
  for (backlash::GearTolerances& gear : t.gears) {
    gear.tooth_thickness_m = {.lower = -20.0 * kMicrometre, .upper = -5.0 * kMicrometre};
    gear.tip_diameter_m = {.lower = -40.0 * kMicrometre, .upper = 0.0};
  }
  pair.tolerances = t;
  const auto drawn = std::get<PairEvaluation>(evaluate(pair));
  const auto ranges = rated_limits(drawn.tolerance_limits.value(), drawn.checks);
  ASSERT_GE(ranges.size(), 4U);
  std::vector<double> least(ranges.size(), 1e300), greatest(ranges.size(), -1e300);
  for (unsigned corner = 0; corner < 32; ++corner) {
    unsigned bits = corner;
    const PairDesign built =
        redrawn_pair(pair, drawn.center_distance_m, [&](const backlash::DeviationLimits& l) {
          const bool upper = (bits & 1U) != 0;
          bits >>= 1U;
          return upper ? l.upper : l.lower;
        });
    const auto values = rated_margins(std::get<PairEvaluation>(evaluate(built)).checks);
    for (std::size_t i = 0; i < values.size(); ++i) {
      least[i] = std::min(least[i], values[i]);
      greatest[i] = std::max(greatest[i], values[i]);
    }
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    EXPECT_NEAR(ranges[i].margin.least, least[i], kRounding) << ranges[i].name;
    EXPECT_NEAR(ranges[i].margin.greatest, greatest[i], kRounding) << ranges[i].name;
    EXPECT_LE(ranges[i].margin.least, ranges[i].margin.nominal) << ranges[i].name;
  }
}

}  // namespace
}  // namespace gear3k::design::tolerance_limits_test
