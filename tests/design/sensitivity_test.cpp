// Derivatives by automatic differentiation against differences of evaluate() over the text of the
// file: one number of the file is changed, the file is read and evaluated again.

#include "design/sensitivity.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/keys/design_keys.hpp"
#include "io/text/diagnostics.hpp"
#include "tests/random_train.hpp"

namespace gear3k::design::sensitivity_test {
namespace {

using efficiency::FrictionLaw;
using efficiency::LossModel;

constexpr double kArcmin_rad = std::numbers::pi / 10800.0;
constexpr std::size_t kEveryCheck = 1000;

std::string text_of_file(const std::string& path) {
  std::ifstream file(std::string(GEAR3K_SOURCE_DIR) + "/" + path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

Design published(const std::string& name) {
  return io::parse_design(text_of_file("examples/designs/" + name + ".toml"), name);
}
Design low_backlash() { return published("low_backlash_prototype"); }
Design bilateral() { return published("bilateral_drive_gear"); }

Evaluation evaluated(const Design& design) { return std::get<Evaluation>(evaluate(design)); }

/// The text of a DESIGN file with the number of one key replaced, or added.
std::string with_number(const std::string& text, const std::string& key, double number) {
  const auto dot = key.rfind('.');
  const std::string line =
      fmt::format("{} = {}\n", key.substr(dot == std::string::npos ? 0 : dot + 1), number);
  const std::string name = line.substr(0, line.find('=') + 1);
  std::size_t begin = 0;
  if (dot != std::string::npos) {
    const std::string header = fmt::format("[{}]\n", key.substr(0, dot));
    const auto at = text.find(header);
    if (at == std::string::npos) return text + "\n" + header + line;
    begin = at + header.size();
  }
  const std::size_t end = std::min(text.find('[', begin), text.size());
  for (std::size_t at = begin; at < end; at = text.find('\n', at) + 1) {
    if (text.compare(at, name.size(), name) != 0) continue;
    return text.substr(0, at) + line + text.substr(text.find('\n', at) + 1);
  }
  return text.substr(0, begin) + line + text.substr(begin);
}

/// What is derived, in units of which a hundredth is much: the five quantities, then the margins of
/// every check.
struct Numbers {
  std::array<std::optional<double>, kQuantityCount> quantity;
  /// Of every check; then at each end of the temperatures the lost motion and of each mesh the mean
  /// and the least backlash.
  std::vector<double> margin;
};
constexpr std::size_t kAtEnd = 1 + 2 * train::kMeshCount;
constexpr std::array<double, kQuantityCount> kSize{1.0, 1.0, 1.0, 1.0, 10.0 * kArcmin_rad};
double size_of(const CheckResult& check) {
  switch (check.record->unit) {
    case Unit::kNone:
    case Unit::kModule:
      return 1.0;
    case Unit::kMillimetre:
      return 1e-3;
    case Unit::kMicrometre:
      return 1e-4;
    case Unit::kArcmin:
      return 10.0 * kArcmin_rad;
    default:
      return 1.0;
  }
}

Numbers numbers_of(const Evaluation& e) {
  Numbers n{};
  n.quantity[kEtaForward] = e.efficiency.forward;
  if (e.efficiency.backdrivable) n.quantity[kEtaBackward] = e.efficiency.backward;
  if (e.operation) {
    if (e.operation->forward.operation) {
      n.quantity[kTotalEtaForward] = e.operation->forward.operation->efficiency;
    }
    if (e.operation->backward.operation) {
      n.quantity[kTotalEtaBackward] = e.operation->backward.operation->efficiency;
    }
  }
  n.quantity[kLostMotion] = e.lost_motion.kinematic_rad;
  for (const CheckResult& c : e.checks) n.margin.push_back(c.margin);
  for (std::size_t s = 1; e.thermal && s < e.thermal->states.size(); ++s) {
    n.margin.push_back(e.thermal->states[s].lost_motion_rad);
    for (const ThermalMesh& m : e.thermal->states[s].meshes) {
      n.margin.push_back(m.normal_backlash_m);
      n.margin.push_back(m.least_backlash_m);
    }
  }
  return n;
}

std::string name_of(const CheckResult& c) {
  return fmt::format("{} {} {}", c.record->name, c.mesh, c.gear);
}
std::string name_of(const TightCheck& c) {
  return fmt::format("{} {} {}", c.record->name, c.mesh, c.gear);
}

/// Differences of fourth order, h apart: central, or from one side where a key has its bound.
struct Stencil {
  std::vector<double> at, weight;
};
const Stencil kCentral{.at = {-2, -1, 1, 2}, .weight = {1. / 12, -8. / 12, 8. / 12, -1. / 12}};
const Stencil kFromBound{.at = {0, 1, 2, 3, 4},
                         .weight = {-25. / 12, 48. / 12, -36. / 12, 16. / 12, -3. / 12}};

/// What happened to the comparisons of a test.
struct Tally {
  int compared = 0, kinks = 0;
  double worst = 0.0;
  std::string worst_of;
  std::set<std::string> inputs;

  /// `fine` and `coarse` are differences at two steps: they disagree where a branch changes nearby.
  void see(const std::string& what, std::optional<double> jet, double fine, double coarse,
           double size) {
    constexpr double kAllowed = 1e-7;
    const double floor = 1e-3 * size;
    const double allowed = kAllowed * std::max(std::abs(fine), floor);
    if (std::abs(fine - coarse) > 0.3 * allowed) {
      ++kinks;
      return;
    }
    ++compared;
    ASSERT_TRUE(jet.has_value()) << what;
    const double share = std::abs(*jet - fine) / allowed;
    EXPECT_LE(share, 1.0) << what << ": " << *jet << " against " << fine;
    if (share > worst) {
      worst = share;
      worst_of = what;
    }
  }
};

/// The row of a key of the DESIGN file.
auto row_of(const Sensitivities& s, const std::string& key) {
  return std::ranges::find_if(s.inputs,
                              [&](const Sensitivity& row) { return io::key_of(row.input) == key; });
}

/// The design of a text, with what a calibrated model adds to another one.
Design with_extension(const std::string& text, const std::string& name, const Design& model) {
  Design design = io::parse_design(text, name);
  design.friction.extension = model.friction.extension;
  design.shafts.output_bearing_share = model.shafts.output_bearing_share;
  design.shafts.output_bearing_growth = model.shafts.output_bearing_growth;
  design.shafts.drag_temperature_1_K = model.shafts.drag_temperature_1_K;
  design.shafts.drag_reference_temperature_K = model.shafts.drag_reference_temperature_K;
  return design;
}

/// Of where it runs, what is not among the inputs must change no quantity.
void expect_rest_does_not_act(const std::string& name, const Design& design, const Sensitivities& s,
                              const Numbers& at) {
  if (!design.operating_point) return;
  const auto moved = [&](const char* key, double OperatingPoint<double>::*member, double by) {
    if (row_of(s, key) != s.inputs.end()) return;
    Design other = design;
    (*other.operating_point).*member += by * (*other.operating_point).*member;
    const Numbers n = numbers_of(evaluated(other));
    for (std::size_t q = 0; q < kQuantityCount; ++q) {
      ASSERT_EQ(n.quantity[q].has_value(), at.quantity[q].has_value()) << name << " " << key;
      if (!n.quantity[q]) continue;
      EXPECT_NEAR(*n.quantity[q], *at.quantity[q], 1e-12 * kSize[q]) << name << " " << key;
    }
  };
  moved("operating_point.sun_speed_rpm", &OperatingPoint<double>::sun_speed_rad_s, 0.1);
  moved("operating_point.output_torque_nm", &OperatingPoint<double>::output_torque_Nm, 0.1);
  moved("operating_point.temperature_c", &OperatingPoint<double>::temperature_K, 0.01);
}

/// Compares every derivative of a design, as change per step.
void compare(const std::string& name, const Design& design, Tally& tally) {
  const std::string text = io::design_text(design);
  const Design read = with_extension(text, name, design);
  const Evaluation base = evaluated(read);
  const Sensitivities s = sensitivities(read, kEveryCheck);
  const Numbers at = numbers_of(base);
  ASSERT_FALSE(s.inputs.empty()) << name;
  expect_rest_does_not_act(name, read, s, at);
  for (std::size_t q = 0; q < kQuantityCount; ++q) {
    ASSERT_EQ(s.value[q].has_value(), at.quantity[q].has_value()) << name << " " << q;
    if (s.value[q]) {
      EXPECT_NEAR(*s.value[q], *at.quantity[q], 1e-14 * kSize[q]);
    }
  }
  for (const Sensitivity& row : s.inputs) {
    tally.inputs.insert(io::key_of(row.input));
    const auto numbers = [&](double number) {
      const std::string key = io::key_of(row.input);
      return numbers_of(evaluated(with_extension(with_number(text, key, number), key, design)));
    };
    const auto difference = [&](double h) {
      std::vector<double> slope(kQuantityCount + at.margin.size(), 0.0);
      const auto add = [&](const Stencil& stencil) {
        std::vector<Numbers> n;
        for (const double k : stencil.at) n.push_back(numbers(row.value + k * h));
        for (std::size_t i = 0; i < n.size(); ++i) {
          const double w = stencil.weight[i] * row.step / h;
          for (std::size_t q = 0; q < kQuantityCount; ++q) {
            slope[q] += w * n[i].quantity[q].value_or(std::nan(""));
          }
          for (std::size_t c = 0; c < at.margin.size(); ++c) {
            slope[kQuantityCount + c] += w * n[i].margin[c];
          }
        }
      };
      try {
        add(kCentral);
      } catch (const io::InvalidInput&) {
        add(kFromBound);
      }
      return slope;
    };
    const double h = 0.05 * row.step;
    const auto fine = difference(h);
    const auto coarse = difference(2.0 * h);
    for (std::size_t q = 0; q < kQuantityCount; ++q) {
      if (!at.quantity[q]) {
        EXPECT_FALSE(row.slope[q].has_value());
        continue;
      }
      tally.see(fmt::format("{}: quantity {} by {}", name, q, io::key_of(row.input)),
                row.effect(static_cast<QuantityId>(q)), fine[q], coarse[q], kSize[q]);
    }
    for (std::size_t c = 0; c < base.checks.size(); ++c) {
      const auto tight = std::ranges::find_if(
          s.checks, [&](const TightCheck& t) { return name_of(t) == name_of(base.checks[c]); });
      const auto index = static_cast<std::size_t>(tight - s.checks.begin());
      const auto jet = tight == s.checks.end() ? 0.0 : row.margin_effect(index);
      tally.see(fmt::format("{}: {} by {}", name, name_of(base.checks[c]), io::key_of(row.input)),
                jet, fine[kQuantityCount + c], coarse[kQuantityCount + c], size_of(base.checks[c]));
    }
    ASSERT_EQ(row.thermal.size() * kAtEnd, at.margin.size() - base.checks.size());
    std::size_t place = kQuantityCount + base.checks.size();
    for (std::size_t end = 0; end < row.thermal.size(); ++end) {
      const auto see = [&](const char* what, const std::optional<double>& slope, double size) {
        ASSERT_TRUE(slope);
        tally.see(fmt::format("{}: {} at end {} by {}", name, what, end, io::key_of(row.input)),
                  *slope * row.step, fine[place], coarse[place], size);
        ++place;
      };
      see("lost motion", row.thermal[end].lost_motion, 10.0 * kArcmin_rad);
      for (std::size_t k = 0; k < train::kMeshCount; ++k) {
        see("mean backlash", row.thermal[end].normal_backlash[k], 1e-4);
        see("least backlash", row.thermal[end].least_backlash[k], 1e-4);
      }
    }
  }
}

/// Few of the comparisons may fall to a kink nearby.
void expect_few_kinks(const Tally& tally) {
  EXPECT_LE(tally.kinks, 0.03 * tally.compared);
  ::testing::Test::RecordProperty("compared", tally.compared);
  ::testing::Test::RecordProperty("kinks", tally.kinks);
  ::testing::Test::RecordProperty("worst_share_of_tolerance",
                                  fmt::format("{:.3g} ({})", tally.worst, tally.worst_of));
}

Design thinned(Design design) {
  design.train.machining_allowance = {0.02, 0.03, 0.01, 0.025, 0.015};
  design.train.tip_shortening = {0.03, 0.02, 0.05, 0.04, 0.01};
  return design;
}

/// The low-backlash gearbox, which runs with every loss that there is.
Design running(FrictionLaw law) {
  Design d = thinned(low_backlash());
  d.name = fmt::format("running {}", efficiency::kFrictionLawNames[static_cast<std::size_t>(law)]);
  d.masses.face_width_m = {6e-3, 7e-3};
  d.operating_point = OperatingPoint<double>{
      .sun_speed_rad_s = 60.0, .output_torque_Nm = 8.0, .temperature_K = 308.0};
  d.friction.law = law;
  d.friction.coefficient = 0.06;
  d.friction.load_exponent = -0.15;
  d.friction.reference_force_N = 50.0;
  d.friction.static_coefficient = 0.12;
  d.friction.stribeck_speed_m_s = 0.1;
  d.friction.stribeck_exponent = 1.3;
  d.friction.viscous_s_m = 0.01;
  d.friction.roughness_m = 0.8e-6;
  d.friction.lubricant_factor = 0.9;
  d.friction.lubricant = {
      .temperature_K = {313.15, 373.15}, .viscosity_m2_s = {220e-6, 19e-6}, .density_kgm3 = 890.0};
  if (law == FrictionLaw::kTable) {
    d.friction.table = {.sliding_speed_m_s = {0.0, 1.0},
                        .tooth_force_N = {1.0, 1000.0},
                        .coefficient = {0.1, 0.06, 0.07, 0.05}};
  }
  for (std::size_t i = 0; i < kShaftCount; ++i) {
    const double size = 1e-4 * static_cast<double>(i + 1);
    d.shafts.drag[i] = {
        .constant_Nm = 10.0 * size, .viscous_Nms = size, .quadratic_Nms2 = 0.01 * size};
  }
  d.shafts.planet_bearing_coefficient = 0.02;
  d.shafts.planet_bearing_radius_m = 3e-3;
  return d;
}

TEST(Sensitivity, OfThePublishedGearboxesAreTheDifferencesOfTheirEvaluation) {
  Tally tally;
  compare("low-backlash prototype", low_backlash(), tally);
  compare("bilateral drive gear", bilateral(), tally);
  EXPECT_EQ(tally.inputs.count("center_distance_mm"), 1U);
  expect_few_kinks(tally);
}

TEST(Sensitivity, OfAnUnstatedDistanceAndTipsByRuleCountWhatBothBringAlong) {
  Tally tally;
  Design d = thinned(bilateral());
  ASSERT_FALSE(d.center_distance_given);
  d.train.khk_tip = {true, true, false, false, false};
  d.train.tip_shortening[train::kS] = d.train.tip_shortening[train::kP1] = 0.0;
  compare("unstated", d, tally);
  EXPECT_EQ(tally.inputs.count("gears.S.tip_shortening"), 0U);
  EXPECT_EQ(tally.inputs.count("gears.P2.tip_shortening"), 1U);
  d.center_distance_given = true;
  d.train.center_distance_m = 21.29e-3;
  compare("stated", d, tally);
  expect_few_kinks(tally);
}

TEST(Sensitivity, AtTheEndsOfTemperatureAreTheDifferencesOfEvaluationsThere) {
  Tally tally;
  Design d = thinned(low_backlash());
  const train::Growth plastic{.expansion_1_K = 1.1e-4, .swelling = {-1e-3, 2e-3}};
  const train::Growth metal{.expansion_1_K = 1.2e-5, .swelling = {}};
  d.thermal = {.least_K = 253.15,
               .greatest_K = 333.15,
               .gear = {metal, plastic, plastic, plastic, metal},
               .carrier = {.expansion_1_K = 2.3e-5}};
  d.limits[CheckId::kThermalBacklash].reset();
  compare("two materials, swelling", d, tally);
  for (train::Growth& growth : d.thermal->gear) growth.swelling = {};
  d.train.center_distance_m = evaluated(d).center_distance_m + 5e-5;
  d.center_distance_given = true;
  compare("two materials, distance stated", d, tally);
  EXPECT_EQ(sensitivities(d).ends.size(), 2U);
  expect_few_kinks(tally);
  // They are not those of the drawing.
  const Sensitivities s = sensitivities(d);
  const auto row = row_of(s, "center_distance_mm");
  EXPECT_GT(std::abs(row->thermal[1].lost_motion.value() - row->slope[kLostMotion].value()),
            1e-4 * std::abs(row->slope[kLostMotion].value()));
  EXPECT_TRUE(sensitivities(low_backlash()).ends.empty());
}

TEST(Sensitivity, ToThePlanetsShiftHoldsAStatedDistanceAndFollowsAnUnstatedOne) {
  // Opposite facts that a slip between partial and total derivatives would make equal: with the
  // distance stated, P1's shift opens or closes mesh P1-R1; else this mesh stays without backlash.
  Design d = low_backlash();
  const auto slope = [](const Design& design) {
    const Sensitivities s = sensitivities(design, kEveryCheck);
    const auto check = std::ranges::find_if(s.checks, [](const TightCheck& c) {
      return c.record->id == CheckId::kNormalBacklash && c.mesh == "P1-R1";
    });
    const auto row = row_of(s, "gears.P1.profile_shift");
    return row->margin_slope[static_cast<std::size_t>(check - s.checks.begin())].value();
  };
  const double module_m = d.train.module_m[0];
  const double held_open = 2.0 * std::sin(d.train.pressure_angle_rad) * module_m;
  EXPECT_NEAR(slope(d), 0.0, 1e-12 * module_m);
  d.train.center_distance_m = evaluated(d).center_distance_m;
  d.center_distance_given = true;
  // j_bn of a ring falls by 2 m sin α per module of the pinion's shift (paper, eq. 15).
  EXPECT_NEAR(slope(d), -held_open, 1e-12 * module_m);
}

/// Bores, rings that end somewhere, and face widths in the place of places along the axis.
void add_bodies(RandomTrain& random, const train::TrainGeometry<double>& geometry, Design& d) {
  const auto share_of_root = [&](int gear, double low, double high) {
    return random.between(low, high) * geometry.gears[static_cast<std::size_t>(gear)].root_radius_m;
  };
  for (const int gear : {train::kS, train::kP1, train::kP2}) {
    d.masses.bore_radius_m[static_cast<std::size_t>(gear)] = share_of_root(gear, 0.2, 0.8);
  }
  d.masses.ring1_outer_radius_m = share_of_root(train::kR1, 1.1, 1.3);
  d.masses.ring2_outer_radius_m = share_of_root(train::kR2, 1.1, 1.3);
  d.limits[CheckId::kWall] = random.between(0.0, 5e-3);
  d.limits[CheckId::kGearboxLength] = random.between(5e-3, 30e-3);
  d.masses.face_width_m = {random.between(4e-3, 12e-3), random.between(4e-3, 12e-3)};
}

efficiency::FrictionBend<double> random_bend(RandomTrain& random, double half_range) {
  efficiency::FrictionBend<double> bend;
  bend.quadratic = random.between(-0.1, 0.1);
  bend.cubic = random.between(-0.1, 0.1);
  for (double& s : bend.s) s = random.between(-0.1, 0.1);
  bend.s[3] = 0.0;
  bend.half_range = half_range;
  return bend;
}

/// What a calibrated model adds to friction and to the output's bearing, where it runs.
void add_extension(RandomTrain& random, Design& d) {
  d.operating_point = OperatingPoint<double>{.sun_speed_rad_s = random.between(20.0, 200.0),
                                             .output_torque_Nm = random.between(2.0, 20.0),
                                             .temperature_K = random.between(290.0, 330.0)};
  auto& e = d.friction.extension;
  e.level = random.between(0.8, 1.2);
  e.load_exponent = random.between(-0.1, 0.1);
  e.reference_force_N = 50.0;
  e.slow_excess = random.between(0.0, 0.3);
  e.slow_speed_m_s = 0.05;
  e.speed_exponent = random.between(-0.1, 0.1);
  e.reference_speed_m_s = 0.1;
  e.temperature_1_K = random.between(-0.01, 0.0);
  e.load_bend = random_bend(random, 4.0);
  e.speed_bend = random_bend(random, 4.0);
  e.temperature_bend = random_bend(random, 40.0);
  e.forward = random.between(0.9, 1.1);
  e.approach = random.between(0.9, 1.1);
  e.inner_drives = random.between(0.9, 1.1);
  e.ring_meshes = random.between(0.9, 1.1);
  d.shafts.output_bearing_share = random.between(0.0, 0.02);
  d.shafts.output_bearing_growth = {.share = random.between(0.005, 0.02),
                                    .exponent = random.between(-0.5, 0.5),
                                    .reference_Nm = 10.0};
}

TEST(Sensitivity, OfRandomGearboxesAreTheDifferencesOfTheirEvaluation) {
  Tally tally;
  RandomTrain random(41);
  int walled = 0, sized = 0, running = 0;
  constexpr std::array<LossModel, 4> kModels{LossModel::kSliding, LossModel::kOhlendorf,
                                             LossModel::kCoulombPath, LossModel::kDirectional};
  int done = 0;
  while (done < 16) {
    Design d;
    d.name = fmt::format("random {}", done);
    const auto geometry = random.train(done % 2 == 0);
    d.train.teeth = geometry.teeth;
    d.train.planets = random.count(1, 5);
    d.train.pressure_angle_rad = geometry.gears[0].angle.alpha_rad;
    d.train.module_m = {geometry.gears[train::kS].gear.module_m,
                        geometry.gears[train::kP2].gear.module_m};
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      d.train.profile_shift[i] = geometry.gears[i].gear.profile_shift;
      d.train.machining_allowance[i] = random.between(0.01, 0.1);
      d.train.tip_shortening[i] = random.between(0.02, 0.2);
      d.train.rack[i] = {.addendum = 0.95, .dedendum = 1.3, .root_radius = 0.25};
    }
    d.center_distance_given = done % 3 != 0;
    d.train.center_distance_m = d.center_distance_given ? geometry.center_distance_m : 0.0;
    d.train.cutter[train::kR1] = {
        .teeth = d.train.teeth.R1 / 3, .profile_shift = 0.1, .tip_radius = 0.15};
    if (done % 4 < 2) {
      // S and either ring reach beyond their stages, so that all bodies that may pass do.
      const auto place = [&](int body, double from_m, double to_m) {
        d.axial.extent[static_cast<std::size_t>(body)] =
            train::AxialInterval{.from_m = from_m, .to_m = to_m};
      };
      place(train::kP1, 0.0, 0.01);
      place(train::kP2, 0.01, 0.02);
      place(train::kS, 0.0, 0.015);
      const double rings_meet_m = done % 2 == 0 ? 0.015 : 0.005;
      place(train::kR1, 0.0, rings_meet_m);
      place(train::kR2, rings_meet_m, 0.02);
      place(train::kCarrier, 0.0, 0.02);
      d.axial.carrier_radius_m = 0.4 * d.train.module_m[0] * d.train.teeth.R1;
    }
    if (done % 8 > 0) add_bodies(random, geometry, d);
    if (done % 2 > 0) add_extension(random, d);
    d.friction.coefficient = 0.05;
    d.friction.model = kModels[static_cast<std::size_t>(done) % 4];
    if (d.friction.model == LossModel::kDirectional) {
      d.friction.approach_factor = 1.3;
      d.friction.recess_factor = 0.8;
    }
    // A gearbox that runs, as a designer would print it.
    const auto result = evaluate(d);
    const auto* e = std::get_if<Evaluation>(&result);
    if (e == nullptr || !e->efficiency.backdrivable) continue;
    if (std::ranges::any_of(e->meshes, [](const auto& m) { return m.contact_ratio < 1.02; })) {
      continue;
    }
    compare(d.name, d, tally);
    const auto has = [&](CheckId id) {
      return std::ranges::any_of(sensitivities(d, kEveryCheck).checks,
                                 [&](const TightCheck& c) { return c.record->id == id; });
    };
    walled += has(CheckId::kWall) ? 1 : 0;
    sized += has(CheckId::kGearboxLength) ? 1 : 0;
    running += d.operating_point ? 1 : 0;
    ++done;
  }
  expect_few_kinks(tally);
  EXPECT_EQ(walled, 14);
  EXPECT_EQ(sized, 8);
  EXPECT_EQ(running, 8);
  for (const char* key : {"operating_point.sun_speed_rpm", "operating_point.output_torque_nm",
                          "operating_point.temperature_c", "stage1.face_width_mm"}) {
    EXPECT_TRUE(tally.inputs.contains(key)) << key;
  }
}

// By one part of a model alone: with it the operating point acts, and nothing else makes it.
TEST(Sensitivity, ByTheOperatingPointIsThatOfEveryPartOfAModel) {
  using Extension = efficiency::FrictionExtension<double>;
  const efficiency::FrictionBend<double> bend{.quadratic = 0.2,
                                              .cubic = -0.1,
                                              .s = {0.1, 0.05, 0.02, 0.0, -0.05, -0.04, 0.1},
                                              .half_range = 4.0};
  struct Case {
    const char* key;
    void (*add)(Design& d, const efficiency::FrictionBend<double>& bend);
  };
  using Bend = efficiency::FrictionBend<double>;
  const std::array<Case, 8> cases{
      {{"operating_point.sun_speed_rpm",
        [](Design& d, const Bend& b) { d.friction.extension.speed_bend = b; }},
       {"operating_point.sun_speed_rpm",
        [](Design& d, const Bend&) { d.friction.extension.speed_exponent = -0.1; }},
       {"operating_point.output_torque_nm",
        [](Design& d, const Bend& b) { d.friction.extension.load_bend = b; }},
       {"operating_point.output_torque_nm",
        [](Design& d, const Bend& b) {
          Extension& e = d.friction.extension;
          e.load_bend = b;
          e.load_is_torque = true;
        }},
       {"operating_point.output_torque_nm",
        [](Design& d, const Bend&) {
          d.shafts.output_bearing_growth = {.share = 0.02, .exponent = -0.5, .reference_Nm = 5.0};
        }},
       {"operating_point.temperature_c",
        [](Design& d, const Bend& b) {
          d.friction.extension.temperature_bend = b;
          d.friction.extension.temperature_bend.half_range = 40.0;
        }},
       {"operating_point.temperature_c",
        [](Design& d, const Bend&) { d.friction.extension.temperature_1_K = -0.01; }},
       {"", [](Design& d, const Bend&) { d.friction.extension.level = 1.2; }}}};
  const std::array<std::string, 3> all{"operating_point.sun_speed_rpm",
                                       "operating_point.output_torque_nm",
                                       "operating_point.temperature_c"};
  Tally tally;
  for (std::size_t n = 0; n < cases.size(); ++n) {
    Design d = running(FrictionLaw::kConstant);
    d.shafts = {};
    cases[n].add(d, bend);
    compare(fmt::format("case {}", n), d, tally);
    const Sensitivities s = sensitivities(d);
    for (const std::string& key : all) {
      EXPECT_EQ(row_of(s, key) != s.inputs.end(), key == cases[n].key) << n << " " << key;
    }
  }
  expect_few_kinks(tally);
}

// Checks of evaluate() that any of the inputs moves, found by moving them all.
TEST(Sensitivity, HasTheChecksOfTheEvaluationThatItsInputsMove) {
  Design d = thinned(published("loaded"));
  d.masses.bore_radius_m[train::kP1] = d.masses.bore_radius_m[train::kP2] = 5e-3;
  d.masses.ring1_outer_radius_m = 42e-3;
  d.limits[CheckId::kWall] = 15e-3;
  d.limits[CheckId::kGearboxLength] = 5e-3;
  const Evaluation e = evaluated(d);
  std::set<std::string> failed;
  for (const CheckResult& c : e.checks) {
    if (!c.ok) failed.insert(std::string(c.record->name));
  }
  EXPECT_TRUE(failed.contains("wall"));
  EXPECT_TRUE(failed.contains("gearbox_length"));
  std::set<std::string> expected;
  for (const double by : {-1.0, 1.0}) {
    Design moved = d;
    moved.train.center_distance_m *= 1.0 + by * 1e-5;
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      const double step = by * 1e-4 * static_cast<double>(i + 1);
      moved.train.profile_shift[i] += step;
      moved.train.tip_shortening[i] -= 0.7 * step;
      moved.train.machining_allowance[i] += 0.3 * step;
    }
    for (const std::size_t stage : {0U, 1U}) {
      const double factor = 1.0 + by * 1e-4 * static_cast<double>(stage + 1);
      moved.train.module_m[stage] *= factor;
      moved.rating->face_width_m[stage] *= factor;
      auto& width = moved.masses.face_width_m[stage];
      if (width) *width *= factor;
    }
    const Evaluation other = evaluated(moved);
    ASSERT_EQ(other.checks.size(), e.checks.size());
    for (std::size_t c = 0; c < e.checks.size(); ++c) {
      if (other.checks[c].margin != e.checks[c].margin) expected.insert(name_of(e.checks[c]));
    }
  }
  std::set<std::string> told;
  for (const TightCheck& c : sensitivities(d, kEveryCheck).checks) told.insert(name_of(c));
  EXPECT_EQ(told, expected);
  EXPECT_GT(told.size(), 40U);
}

TEST(Sensitivity, OfEveryFrictionLawAndLossAreTheDifferencesOfTheirEvaluation) {
  Tally tally;
  for (const FrictionLaw law :
       {FrictionLaw::kConstant, FrictionLaw::kLoadPower, FrictionLaw::kStribeck,
        FrictionLaw::kSchlenk, FrictionLaw::kTable}) {
    const Design d = running(law);
    compare(d.name, d, tally);
  }
  expect_few_kinks(tally);
  // No number of the losses is forgotten, and each has the key that the file knows.
  for (const io::LossKey& loss : io::loss_keys()) {
    const io::KeyRecord& record = loss.key.record;
    if (record.type != io::KeyType::kNumber) continue;
    EXPECT_EQ(tally.inputs.count(record.path), 1U) << record.path;
  }
}

// Safeties and what else a stated load is judged by, face widths among the inputs.
TEST(Sensitivity, UnderLoadAreTheDifferencesOfTheirEvaluation) {
  Tally tally;
  const Design steel = published("loaded");
  compare("loaded", steel, tally);
  Design graded = steel;
  graded.rating->accuracy_grade = 6;
  // Not of one height: K_Fbeta takes the higher tooth, with a kink where both are.
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    graded.train.tip_shortening[i] += 0.01 * static_cast<double>(i % 3);
  }
  graded.rating->misalignment_m = 4e-6;
  graded.rating->teeth.flank_roughness_m = 3e-6;
  compare("loaded, grade 6", graded, tally);
  expect_few_kinks(tally);
  EXPECT_TRUE(tally.inputs.contains("stage1.face_width_mm"));
  // Of more load than it carries the safety that fails is among the tightest.
  Design heavy = steel;
  heavy.rating->torque_Nm = 45.0;
  const Sensitivities s = sensitivities(heavy);
  EXPECT_TRUE(std::ranges::any_of(s.checks, [](const TightCheck& check) {
    return check.record->id == CheckId::kRootSafety && check.margin < 0.0;
  }));
}

// What has no derivatives is left out: K_γ of the tolerances, speeds of a rating.
TEST(Sensitivity, UnderLoadLeavesOutWhatIsNotDerived) {
  Design drawn = published("loaded");
  drawn.tolerances = published("ratio_96_tolerances").tolerances;
  drawn.rating->factors.mesh_load_source = strength::MeshLoadSource::kTolerances;
  const auto rated = [](const TightCheck& check) { return check.record->rating; };
  EXPECT_FALSE(std::ranges::any_of(sensitivities(drawn, kEveryCheck).checks, rated));
  EXPECT_TRUE(std::ranges::any_of(sensitivities(published("loaded"), kEveryCheck).checks, rated));
}

TEST(Sensitivity, UnitsAndValuesAreThoseOfTheFile) {
  const Sensitivities s = sensitivities(running(FrictionLaw::kSchlenk));
  for (const io::LossKey& loss : io::loss_keys()) {
    const auto row = row_of(s, loss.key.record.path);
    if (row == s.inputs.end()) continue;
    EXPECT_EQ(row->unit, loss.key.record.unit) << io::key_of(row->input);
  }
  const auto value = [&](const char* key) { return row_of(s, key)->value; };
  EXPECT_DOUBLE_EQ(value("stage1.module_mm"), 0.59);
  EXPECT_DOUBLE_EQ(value("lubricant.viscosity1_mm2_s"), 220.0);
  EXPECT_NEAR(value("operating_point.temperature_c"), 308.0 - 273.15, 1e-12);
  EXPECT_NEAR(value("pressure_angle_deg"), 20.0, 1e-12);
  for (const Sensitivity& row : s.inputs) {
    EXPECT_GT(row.step, 0.0) << io::key_of(row.input);
    // Every key is in the table that users read, with its unit.
    std::string key = io::key_of(row.input);
    const auto gear = key.find("gears.");
    if (gear == 0) key = "gears.<S,P1,R1,P2,R2>" + key.substr(key.find('.', 6));
    EXPECT_NE(io::design_key_table().find(fmt::format("`{}`", key)), std::string::npos)
        << io::key_of(row.input);
  }
}

TEST(Sensitivity, RowsFallWithTheirEffectOnBackwardEfficiency) {
  for (const Design& d : {low_backlash(), bilateral(), running(FrictionLaw::kStribeck)}) {
    const Sensitivities s = sensitivities(d);
    const auto size = [](const Sensitivity& row, QuantityId q) {
      return std::abs(row.effect(q).value());
    };
    for (std::size_t i = 1; i < s.inputs.size(); ++i) {
      const Sensitivity &before = s.inputs[i - 1], &after = s.inputs[i];
      EXPECT_GE(size(before, kEtaBackward), size(after, kEtaBackward)) << io::key_of(after.input);
      if (size(before, kEtaBackward) == 0.0 && size(before, kEtaForward) == 0.0) {
        EXPECT_GE(size(before, kLostMotion), size(after, kLostMotion)) << io::key_of(after.input);
      }
    }
  }
}

TEST(Sensitivity, TightestChecksAreThoseOfLeastMarginThatAnInputMoves) {
  const Design d = low_backlash();
  const Sensitivities s = sensitivities(d, 5);
  const Evaluation e = evaluated(d);
  ASSERT_EQ(s.checks.size(), 5U);
  // Scales by docs/interface.md: all in modules or numbers but normal backlash, over the module.
  const auto scaled = [&](const CheckRecord& record, double margin) {
    return record.unit == Unit::kMicrometre ? margin / d.train.module_m[0] : margin;
  };
  std::vector<double> margins;
  for (const CheckResult& c : e.checks) {
    if (c.record->unit != Unit::kDegree) margins.push_back(scaled(*c.record, c.margin));
  }
  std::ranges::sort(margins);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(scaled(*s.checks[i].record, s.checks[i].margin), margins[i], 1e-12);
  }
}

TEST(Sensitivity, OfWhatIsNotDefinedIsEmpty) {
  // Locked: friction beyond what R2 can drive.
  Design locked = low_backlash();
  locked.friction.coefficient = 2.0;
  ASSERT_FALSE(evaluated(locked).efficiency.backdrivable);
  Design apart = low_backlash();
  apart.train.tip_shortening.fill(1.4);
  ASSERT_FALSE(evaluated(apart).efficiency.forward.has_value());
  for (const bool contact : {true, false}) {
    const Sensitivities s = sensitivities(contact ? locked : apart);
    ASSERT_FALSE(s.inputs.empty());
    for (const Sensitivity& row : s.inputs) {
      EXPECT_EQ(row.slope[kEtaForward].has_value(), contact) << io::key_of(row.input);
      EXPECT_FALSE(row.slope[kEtaBackward].has_value()) << io::key_of(row.input);
      EXPECT_FALSE(row.slope[kTotalEtaForward].has_value()) << io::key_of(row.input);
      EXPECT_TRUE(row.slope[kLostMotion].has_value()) << io::key_of(row.input);
      for (const auto& slope : row.slope)
        EXPECT_FALSE(slope && std::isnan(*slope)) << io::key_of(row.input);
    }
  }
  Design nowhere = low_backlash();
  nowhere.train.profile_shift[train::kP1] = 4.0;
  ASSERT_TRUE(std::holds_alternative<NotDefined>(evaluate(nowhere)));
  EXPECT_TRUE(sensitivities(nowhere).inputs.empty());
}

}  // namespace
}  // namespace gear3k::design::sensitivity_test
