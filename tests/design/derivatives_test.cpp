#include "design/checks.hpp"
#include "geometry/interference.hpp"

// Gradients (Jet1) and Hessians (Jet2) of everything that an optimiser sees, against differences.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "backlash/lost_motion.hpp"
#include "efficiency/train_efficiency.hpp"
#include "geometry/sliding.hpp"
#include "inertia/effective_inertia.hpp"
#include "inertia/mass_properties.hpp"
#include "tests/sample.hpp"
#include "tests/seeded.hpp"
#include "train/train_geometry.hpp"

namespace gear3k::design::derivatives_test {
namespace {

using efficiency::LossModel;

constexpr double kPi = std::numbers::pi;
const int designs = sample(100, 300);

// Variables: the five profile shifts, the centre distance, the modules of both stages.
constexpr std::size_t kVariables = 8;
static_assert(kVariables <= static_cast<std::size_t>(kMaxVariables));
template <class T>
using Variables = std::array<T, kVariables>;

// Central differences over five points: (f(-2h) - 8 f(-h) + 8 f(h) - f(2h))/(12 h), truncated by
// h^4/30 of the fifth derivative and rounded by about 2 eps/h, with h in units of `scales()`.
constexpr double kStep = 1e-3;
// Allowed share of the largest of the function and its scaled derivatives.
constexpr double kTruncation = 2e-8;
// Jets divide by multiplying with the inverse: a few roundings apart from double.
constexpr double kValueRounding = 1e-12;

struct RandomDesign {
  train::ToothSet teeth;
  int planets = 3;
  double pressure_angle_rad = 0.0;
  double ring2_outer_radius_m = 0.0;
  Variables<double> at{};
  train::AxialLayout axial;

  /// Change that counts as one unit of each variable.
  Variables<double> scales() const {
    return {1.0, 1.0, 1.0, 1.0, 1.0, at[6], 0.1 * at[6], 0.1 * at[7]};
  }
};

/// R1 is shaped, R2 has the arc.
std::array<geometry::PinionCutter, train::kGearCount> cutters(const RandomDesign& d) {
  std::array<geometry::PinionCutter, train::kGearCount> result;
  result[train::kR1] = {.teeth = d.teeth.R1 / 3, .profile_shift = 0.1, .tip_radius = 0.15};
  return result;
}

template <class T>
std::optional<train::TrainGeometry<T>> geometry_at(const RandomDesign& d, const Variables<T>& v) {
  train::TrainParameters<T> p{.teeth = d.teeth,
                              .planets = d.planets,
                              .pressure_angle_rad = constant<T>(d.pressure_angle_rad),
                              .center_distance_m = v[5],
                              .module_m = {v[6], v[7]},
                              .profile_shift = {v[0], v[1], v[2], v[3], v[4]},
                              .machining_allowance = {},
                              .tip_shortening = {},
                              .rack = {},
                              .cutter = cutters(d)};
  p.machining_allowance.fill(constant<T>(0.02));
  p.tip_shortening.fill(constant<T>(0.05));
  return make_train_geometry(p);
}

/// Gears of two plastics and a metal in a carrier of another.
const train::ThermalRange kWarm{
    .least_K = 253.15,
    .greatest_K = 333.15,
    .gear = {train::Growth{.expansion_1_K = 1.1e-5},
             train::Growth{.expansion_1_K = 1e-4, .swelling = {.dry = -1e-3, .wet = 2e-3}},
             train::Growth{.expansion_1_K = 8e-5},
             train::Growth{.expansion_1_K = 1e-4, .swelling = {.dry = -1e-3, .wet = 2e-3}},
             train::Growth{.expansion_1_K = 1.1e-5}},
    .carrier = {.expansion_1_K = 2.3e-5}};

Limits all_limits() {
  Limits limits = default_limits();
  for (auto& limit : limits.limit) limit = limit.value_or(1e-3);
  return limits;
}

/// Everything whose derivatives are tested, with names in `names` when asked for.
template <class T>
std::vector<T> quantities(const RandomDesign& d, const Variables<T>& v,
                          std::vector<std::string>* names = nullptr) {
  std::vector<T> all;
  const auto add = [&](const std::string& name, const T& value) {
    all.push_back(value);
    if (names != nullptr) names->push_back(name);
  };
  const auto train = geometry_at(d, v);
  if (!train) return all;
  const auto j = backlash::normal_backlashes(*train);
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    add(fmt::format("normal backlash {}", train::kMeshNames[k]), j[k]);
    add(fmt::format("contact ratio {}", train::kMeshNames[k]), train->meshes[k].contact_ratio);
  }
  using backlash::LostMotionModel;
  for (const auto model : {LostMotionModel::kKinematic, LostMotionModel::kPaper}) {
    add(model == LostMotionModel::kPaper ? "lost motion paper" : "lost motion kinematic",
        output_lost_motion(*train, j, model));
    std::array<geometry::ToothForm<T>, train::kGearCount> forms;
    std::ranges::transform(train->gears, forms.begin(), geometry::make_tooth_form<T>);
    auto gearing = gearing_of(*train, j, model);
    gearing.forms = forms;
    gearing.axial = &d.axial;
    TrainBodies<T> bodies;
    bodies.bore_radius_m = {1e-3, 2e-3, 0.0, 2e-3, 0.0};
    bodies.ring_rim_m = 2e-3;
    gearing.bodies = &bodies;
    gearing.thermal = &kWarm;
    for (const CheckInstance& check :
         list_checks(all_limits(), train_layout({.planets = d.planets,
                                   .stage1_module_m = value_of(v[6]),
                                   .cutter = cutters(d),
                                   .axial = d.axial,
                                   .bodies = {.bore_radius_m = bodies.bore_radius_m,
                                             .ring_outer_radius_m = {},
                                             .ring_rim_m = 2e-3},
                                   .rating = nullptr,
                                   .thermal = &kWarm}))) {
      // The least gap changes its place in jumps: its derivatives are tested where it stays,
      // tests/geometry/tooth_form_test.cpp.
      if (check.record->id == CheckId::kTipFouling) continue;
      // Nor is there a single formula behind the least of the cutter's three margins.
      if (check.record->id == CheckId::kRingCutter) continue;
      const auto subject =
          subject_names(check, train::kGearNames, train::kMeshNames, train::kMeshGears);
      // Sliding has a pole next to interference: what it is made of has none.
      const bool pole = check.record->id == CheckId::kSpecificSliding;
      add(fmt::format("check {} {}{}", check.record->name, subject.mesh, subject.gear),
          pole ? geometry::rolling_share(check_value(check, gearing))
               : check_margin(check, gearing));
    }
  }
  const T mu = constant<T>(0.05);
  for (const LossModel model : {LossModel::kSliding, LossModel::kOhlendorf}) {
    const auto forward = mesh_efficiencies(*train, mu, model, true);
    const auto backward = mesh_efficiencies(*train, mu, model, false);
    const auto name = efficiency::kLossModelNames[static_cast<std::size_t>(model)];
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      add(fmt::format("{} efficiency {} forward", name, train::kMeshNames[k]), forward[k]);
      add(fmt::format("{} efficiency {} backward", name, train::kMeshNames[k]), backward[k]);
    }
    add(fmt::format("{} eta_f", name), efficiency::forward_efficiency(d.teeth, forward));
    add(fmt::format("{} eta_b", name), efficiency::backward_efficiency(d.teeth, backward));
    add(fmt::format("{} backdriving margin", name),
        efficiency::backdriving_margin(d.teeth, backward));
    const auto body = [&](train::GearId id, double other_m) {
      return inertia::gear_body(train->gears[static_cast<std::size_t>(id)], constant<T>(other_m),
                                constant<T>(8e-3), constant<T>(7800.0));
    };
    const inertia::InertialTrain<T> inertial{
        .teeth = d.teeth,
        .planets = d.planets,
        .center_distance_m = train->center_distance_m,
        .bodies = {
            .sun_kgm2 = body(train::kS, 1e-3).inertia_kgm2,
            .planet1_kgm2 = body(train::kP1, 2e-3).inertia_kgm2,
            .planet2_kgm2 = body(train::kP2, 2e-3).inertia_kgm2,
            .planet_mass_kg = body(train::kP1, 2e-3).mass_kg + body(train::kP2, 2e-3).mass_kg,
            .carrier_kgm2 = constant<T>(1e-5),
            .ring2_kgm2 = body(train::kR2, d.ring2_outer_radius_m).inertia_kgm2}};
    add("lossless inertia", inertia::lossless_inertia(inertial));
    add(fmt::format("{} paper inertia", name), inertia::paper_inertia(inertial, backward));
    for (const bool direction : {true, false}) {
      const auto lossy = inertia::effective_inertia<T>(
          inertial, {.forward = forward, .backward = backward}, direction);
      if (!lossy) return {};
      add(fmt::format("{} inertia {}", name, direction ? "forward" : "backward"), *lossy);
    }
  }
  return all;
}

double distance_to_integer(double x) { return std::abs(x - std::round(x)); }

class RandomDesigns {
 public:
  /// A design whose quantities are all defined and smooth for some steps around it.
  RandomDesign operator()() {
    for (;;) {
      const RandomDesign d = any();
      if (is_smooth(d) && !quantities<double>(d, d.at).empty()) return d;
    }
  }

 private:
  RandomDesign any() {
    RandomDesign d;
    auto& z = d.teeth;
    do {
      z = {.S = count(10, 24), .P1 = count(18, 50), .R1 = 0, .P2 = count(18, 50), .R2 = 0};
      z.R1 = z.S + 2 * z.P1 + count(-2, 3);
      z.R2 = z.P2 + z.R1 - z.P1 + count(-2, 2);
    } while (std::abs(1.0 - train::g2(z)) < 0.01);
    d.planets = count(3, 5);
    d.pressure_angle_rad = between(18.0, 25.0) * kPi / 180.0;
    const double m1 = between(0.4e-3, 1e-3);
    const double m2 = m1 * (z.R1 - z.P1) / (z.R2 - z.P2) * between(0.99, 1.01);
    d.at = {between(0.0, 0.8),
            between(0.0, 0.8),
            between(0.0, 1.2),
            between(0.0, 0.8),
            between(0.0, 1.2),
            0.5 * m1 * (z.R1 - z.P1) * between(1.0, 1.05),
            m1,
            m2};
    d.ring2_outer_radius_m = 1.3 * m2 * z.R2 / 2.0;
    d.axial.extent.fill(train::AxialInterval{.from_m = 0.0, .to_m = 0.01});
    d.axial.carrier_radius_m = 0.4 * m1 * z.R1;
    return d;
  }

  /// Away from the points where a formula changes branch: a tip at its base circle, a whole share
  /// of a contact ratio, phi_2 = phi_3, a train that (nearly) locks.
  static bool is_smooth(const RandomDesign& d) {
    const auto train = geometry_at(d, d.at);
    if (!train) return false;
    for (const auto& g : train->gears) {
      if (g.tip_radius_m < g.base_radius_m + 0.2 * g.gear.module_m) return false;
    }
    for (const auto& mesh : train->meshes) {
      const double e1 = mesh.addendum_contact_ratio1;
      const double e2 = mesh.addendum_contact_ratio2;
      if (mesh.contact_ratio < 0.8 || mesh.contact_ratio > 2.8) return false;
      if (mesh.tan_alpha_w < 0.15) return false;
      for (const double e : {e1, e2, e1 + e2}) {
        if (distance_to_integer(e) < 0.03) return false;
      }
    }
    if (!is_smooth_at_root_and_tips(*train)) return false;
    const auto j = backlash::normal_backlashes(*train);
    const auto phi = backlash::paper_lost_motion(*train, j);
    if (std::abs(phi[1] - phi[2]) < 0.02 * std::max(std::abs(phi[1]), std::abs(phi[2]))) {
      return false;
    }
    for (const LossModel model : {LossModel::kSliding, LossModel::kOhlendorf}) {
      const auto eta = mesh_efficiencies(*train, 0.05, model, false);
      if (efficiency::backward_efficiency(d.teeth, eta) < 0.3) return false;
    }
    return true;
  }

  /// Free of undercut, away from where two root roundings become one, from tip circles
  /// that hardly cross or pinions that pass radially, and from a mesh at its own distance.
  static bool is_smooth_at_root_and_tips(const train::TrainGeometry<double>& train) {
    for (const auto& g : train.gears) {
      const auto form = geometry::make_tooth_form(g);
      const double asked = g.gear.rack.root_radius * g.gear.module_m;
      if (g.gear.kind == geometry::GearKind::kExternal) {
        if (geometry::undercut_margin(g) < 0.05) return false;
        continue;
      }
      const bool two_arcs = form.fillet.rounding_radius_m == asked;
      if (form.fillet.tool == geometry::RootTool::kArc && two_arcs &&
          form.fillet.center_offset * g.root_radius_m < 0.03 * g.gear.module_m) {
        return false;
      }
      if (!two_arcs && form.fillet.tool == geometry::RootTool::kArc &&
          form.fillet.rounding_radius_m > 0.9 * asked) {
        return false;
      }
    }
    const double d = train.center_distance_m;
    for (const auto& [first, second] : train::kMeshGears) {
      const auto& gear1 = train.gears[static_cast<std::size_t>(first)];
      const auto& gear2 = train.gears[static_cast<std::size_t>(second)];
      const auto own = geometry::zero_backlash_center_distance(gear1, gear2);
      if (!own || std::abs(d - *own) < 0.01 * gear1.gear.module_m) return false;
      if (*geometry::zero_backlash_angle(gear1, gear2) < 0.2) return false;
      if (gear2.gear.kind == geometry::GearKind::kExternal) continue;
      const double ra1 = gear1.tip_radius_m, ra2 = gear2.tip_radius_m;
      if (std::abs((ra2 * ra2 - ra1 * ra1 - d * d) / (2.0 * d * ra1)) > 0.97) return false;
      const double share = gear1.base_radius_m * ra2 / (gear2.base_radius_m * ra1);
      const double ratio = gear1.base_radius_m / gear2.base_radius_m;
      const double square = (1.0 - share * share) / (1.0 - ratio * ratio);
      if (square < 0.02 || square > 0.9) return false;
    }
    return true;
  }

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }

  std::mt19937_64 generator_{14};
};

/// Largest deviation of each quantity, as a share of what is allowed.
struct Deviations {
  explicit Deviations(std::size_t count) : share(count, 0.0) {}

  void see(std::size_t quantity, double deviation, double allowed) {
    if (deviation == 0.0) return;
    const double s = std::abs(deviation) / allowed;
    if (s <= share[quantity]) return;
    share[quantity] = std::isnan(s) ? std::numeric_limits<double>::infinity() : s;
  }
  void expect_allowed(const std::string& what, const std::vector<std::string>& names) const {
    for (std::size_t q = 0; q < share.size(); ++q) {
      EXPECT_LE(share[q], 1.0) << what << " of " << names[q];
    }
    const auto worst = std::ranges::max_element(share) - share.begin();
    ::testing::Test::RecordProperty(
        what + "_share_of_tolerance",
        fmt::format("{:.3g} ({})", share[static_cast<std::size_t>(worst)],
                    names[static_cast<std::size_t>(worst)]));
  }
  std::vector<double> share;
};

Variables<double> moved(const RandomDesign& d, std::size_t k, double steps) {
  Variables<double> v = d.at;
  v[k] += steps * kStep * d.scales()[k];
  return v;
}

/// Five-point difference over `function(steps)`, a vector of numbers, per step.
template <class F>
std::vector<double> difference(F function) {
  const auto far_below = function(-2.0), below = function(-1.0);
  const auto above = function(1.0), far_above = function(2.0);
  std::vector<double> result(above.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = (far_below[i] - 8.0 * below[i] + 8.0 * above[i] - far_above[i]) / (12.0 * kStep);
  }
  return result;
}

std::vector<std::string> quantity_names(const RandomDesign& d) {
  std::vector<std::string> names;
  quantities<double>(d, d.at, &names);
  return names;
}

TEST(Derivatives, GradientsAreTheCentralDifferencesOfTheFunctions) {
  RandomDesigns random;
  const auto names = quantity_names(random());
  Deviations values(names.size()), gradients(names.size());
  for (int i = 0; i < designs; ++i) {
    const RandomDesign d = random();
    const auto scales = d.scales();
    const auto exact = quantities<double>(d, d.at);
    const auto jets = quantities<Jet1>(d, seeded1(d.at));
    ASSERT_EQ(exact.size(), names.size());
    ASSERT_EQ(jets.size(), names.size());
    std::vector<std::vector<double>> slopes;  // by variable, then quantity
    for (std::size_t k = 0; k < kVariables; ++k) {
      slopes.push_back(
          difference([&](double steps) { return quantities<double>(d, moved(d, k, steps)); }));
      ASSERT_EQ(slopes.back().size(), names.size());
    }
    for (std::size_t q = 0; q < names.size(); ++q) {
      double size = std::abs(exact[q]);
      for (std::size_t k = 0; k < kVariables; ++k) size = std::max(size, std::abs(slopes[k][q]));
      values.see(q, jets[q].a - exact[q], kValueRounding * size);
      for (std::size_t k = 0; k < kVariables; ++k) {
        const double slope = jets[q].v[static_cast<Eigen::Index>(k)] * scales[k];
        gradients.see(q, slope - slopes[k][q], kTruncation * size);
      }
    }
  }
  values.expect_allowed("value", names);
  gradients.expect_allowed("gradient", names);
}

TEST(Derivatives, HessiansAreTheCentralDifferencesOfTheGradients) {
  RandomDesigns random;
  const auto names = quantity_names(random());
  Deviations values(names.size()), gradients(names.size()), hessians(names.size()),
      symmetry(names.size());
  const auto scaled_gradients = [](const RandomDesign& d, const Variables<double>& at) {
    std::vector<double> flat;
    const auto scales = d.scales();
    for (const Jet1& q : quantities<Jet1>(d, seeded1(at))) {
      for (std::size_t k = 0; k < kVariables; ++k) {
        flat.push_back(q.v[static_cast<Eigen::Index>(k)] * scales[k]);
      }
    }
    return flat;
  };
  for (int i = 0; i < designs; ++i) {
    const RandomDesign d = random();
    const auto scales = d.scales();
    const auto exact = quantities<double>(d, d.at);
    const auto exact_gradients = scaled_gradients(d, d.at);
    const auto jets = quantities<Jet2>(d, seeded2(d.at));
    ASSERT_EQ(jets.size(), names.size());
    std::vector<std::vector<double>> slopes;  // by variable, then quantity and variable
    for (std::size_t k = 0; k < kVariables; ++k) {
      slopes.push_back(
          difference([&](double steps) { return scaled_gradients(d, moved(d, k, steps)); }));
    }
    for (std::size_t q = 0; q < names.size(); ++q) {
      double size1 = std::abs(exact[q]);
      for (std::size_t k = 0; k < kVariables; ++k) {
        size1 = std::max(size1, std::abs(exact_gradients[q * kVariables + k]));
      }
      double size2 = size1;
      for (const auto& row : slopes) {
        for (std::size_t k = 0; k < kVariables; ++k) {
          size2 = std::max(size2, std::abs(row[q * kVariables + k]));
        }
      }
      values.see(q, value_of(jets[q]) - exact[q], kValueRounding * size1);
      for (std::size_t k = 0; k < kVariables; ++k) {
        const double expected = exact_gradients[q * kVariables + k];
        gradients.see(q, jets[q].by_column[k] * scales[k] - expected, kValueRounding * size1);
        gradients.see(q, jets[q].by_row[k] * scales[k] - expected, kValueRounding * size1);
        for (std::size_t l = 0; l < kVariables; ++l) {
          const double curvature = jets[q].mixed[k][l] * scales[k] * scales[l];
          hessians.see(q, curvature - slopes[k][q * kVariables + l], kTruncation * size2);
          symmetry.see(q, curvature - jets[q].mixed[l][k] * scales[k] * scales[l],
                       kValueRounding * size2);
        }
      }
    }
  }
  values.expect_allowed("value", names);
  gradients.expect_allowed("gradient", names);
  hessians.expect_allowed("hessian", names);
  symmetry.expect_allowed("symmetry", names);
}

TEST(Derivatives, CoverEveryCheckOfTheRegistryButTheLeastOfSeveral) {
  RandomDesigns random;
  const auto names = quantity_names(random());
  for (const CheckRecord& record : check_records()) {
    if (record.id == CheckId::kTipFouling || record.id == CheckId::kRingCutter) continue;
    if (record.id == CheckId::kAllowedTeeth) continue;  // of tooth numbers only
    // Those of a stated load: tests/strength, and as rows of a refinement in tests/optimize.
    if (record.rating) continue;
    EXPECT_TRUE(std::ranges::any_of(names, [&](const std::string& name) {
      return name.starts_with(fmt::format("check {} ", record.name));
    })) << record.name;
  }
}

}  // namespace
}  // namespace gear3k::design::derivatives_test
