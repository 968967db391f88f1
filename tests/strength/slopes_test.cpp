// Gradients by Jet1 (and Jet2) against central differences, away from kinks.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"
#include "strength/flank_strength.hpp"
#include "strength/flank_stress.hpp"
#include "strength/load_factors.hpp"
#include "strength/plastic_gear.hpp"
#include "strength/root_strength.hpp"
#include "strength/root_stress.hpp"

namespace gear3k::strength::slopes_test {
namespace {

using geometry::Gear;
using geometry::GearKind;

constexpr std::size_t kVariables = kMaxVariables;
/// module [mm], x1, x2, centre distance over module, face width [mm], force [100 N], speed [m/s],
/// allowance.
using Point = std::array<double, kVariables>;

enum class Pair { kExternal, kCutterRing, kArcRing };

template <class T>
struct Named {
  std::vector<std::string> names;
  std::vector<T> values;
  void add(const std::string& name, const T& value) {
    names.push_back(name);
    values.push_back(value);
  }
};

template <class T>
Named<T> outputs(Pair kind, const std::array<T, kVariables>& p) {
  const T m = 1e-3 * p[0];
  const auto angle = geometry::make_pressure_angle(constant<T>(20.0 * std::numbers::pi / 180.0));
  Gear<T> one{.teeth = 19,
              .module_m = m,
              .profile_shift = p[1],
              .machining_allowance = p[7],
              .tip_shortening = constant<T>(0.05),
              .rack = {}};
  Gear<T> two{.teeth = kind == Pair::kExternal ? 27 : 70,
              .kind = kind == Pair::kExternal ? GearKind::kExternal : GearKind::kRing,
              .module_m = m,
              .profile_shift = p[2],
              .machining_allowance = p[7],
              .tip_shortening = constant<T>(0.05),
              .rack = {.root_radius = constant<T>(0.25)}};
  if (kind == Pair::kCutterRing) {
    two.cutter = {.teeth = 25, .profile_shift = 0.1, .tip_radius = 0.2};
  }
  const auto g1 = geometry::make_gear_geometry(one, angle);
  const auto g2 = geometry::make_gear_geometry(two, angle);
  const auto mesh = geometry::make_mesh_geometry(g1, g2, T(p[3] * m)).value();
  const ToothLoad<T> load{.tangential_N = 100.0 * p[5], .face_width_m = 1e-3 * p[4]};
  const LoadedMesh<T> loaded{.tangential_N = load.tangential_N,
                             .face_width_m = load.face_width_m,
                             .application_factor = 1.25,
                             .contact_ratio = mesh.contact_ratio,
                             .pinion_teeth = 19,
                             .tooth_ratio = two.teeth / 19.0,
                             .speed_m_s = p[6]};
  Named<T> result;
  LoadFactorSet<T> factors{.application = constant<T>(1.25)};
  factors.dynamic = dynamic_factor(loaded, 6).value;
  factors.face = face_load_factor(loaded, constant<T>(3e-6), constant<T>(12e9)).value;
  factors.transverse =
      transverse_load_factors<T>(loaded,
                                 TransverseDeviation<T>{.base_pitch_deviation_m = constant<T>(9e-6),
                                                        .running_in_m = constant<T>(0.6e-6),
                                                        .stiffness_Pa = constant<T>(14e9),
                                                        .dynamic_factor = factors.dynamic,
                                                        .face_load_factor = factors.face})
          .flank.value;
  const Material& hard = *find_material("18CrNiMo7-6 case hardened");
  const Material& soft = *find_material("34CrNiMo6 through hardened");
  const auto flank =
      flank_stress<T>({.gear1 = g1,
                       .gear2 = g2,
                       .mesh = mesh,
                       .elasticity1 = {.youngs_modulus_Pa = 206e9, .poissons_ratio = 0.3},
                       .elasticity2 = {.youngs_modulus_Pa = 206e9, .poissons_ratio = 0.3}},
                      load, factors);
  result.add("sigma_H1", flank.stress1_Pa);
  result.add("sigma_H2", flank.stress2_Pa);
  const auto permitted =
      flank_strength<T>(soft, constant<T>(700e6),
                        {.cycles = 1e6 * p[6],
                         .softer_limit_Pa = constant<T>(700e6),
                         .reduced_radius_m = pitch_point_curvature(g1, g2, mesh).reduced_m,
                         .speed_m_s = p[6],
                         .viscosity40_m2_s = 100e-6,
                         .own_roughness_m = 4e-6,
                         .mate_roughness_m = 3e-6,
                         .mate_group = MaterialGroup::kCaseHardened,
                         .brinell_hardness = 240.0});
  result.add("S_H", flank_safety(permitted, flank.stress2_Pa));
  for (const int which : {1, 2}) {
    const auto& g = which == 1 ? g1 : g2;
    const std::string number = std::to_string(which);
    const auto section = root_section(g, geometry::make_tooth_form(g));
    const auto form = root_form(
        g, section, load_point(g, outer_single_contact(g, mesh.base_pitch_m, mesh.contact_ratio)));
    const T rim = rim_factor<T>(g, T(2.3 * m)).value;
    LoadFactorSet<T> root_factors = factors;
    root_factors.face = root_face_load_factor(factors.face, T(m / load.face_width_m)).value;
    const auto stress = root_stress(g, form, rim, load, root_factors);
    const auto strength = root_strength<T>(hard, constant<T>(430e6),
                                           {.cycles = 1e5 * p[6],
                                            .notch_parameter = form.notch_parameter,
                                            .module_m = m,
                                            .root_roughness_m = 10e-6});
    result.add("s_F" + number, T(section.chord_m / m));
    result.add("y_F" + number, T(section.height_m / m));
    result.add("rho_F" + number, T(section.fillet_radius_m / m));
    result.add("Y_F" + number, form.form_factor);
    result.add("Y_S" + number, form.stress_correction_factor);
    result.add("S_F" + number, root_safety(strength, stress.stress_Pa));
    if (which == 2 && kind != Pair::kExternal) {
      const auto virtual_form = root_form(g, virtual_rack_section(g, 0.3), form.load);
      result.add("virtual Y_F Y_S",
                 T(virtual_form.form_factor * virtual_form.stress_correction_factor));
    }
    const T heated = tooth_temperature<T>({.ambient_K = constant<T>(313.15),
                                           .loss_W = load.tangential_N * p[6] * 0.01,
                                           .face_width_m = load.face_width_m,
                                           .pinion_teeth = 19,
                                           .speed_m_s = p[6],
                                           .module_m = m,
                                           .housing_resistance = 0.03,
                                           .housing_surface_m2 = 0.02},
                                          895.0);
    const ToothCondition<T> condition{.temperature_K = heated, .cycles = 1e6 * p[6]};
    const auto plastic =
        plastic_root_stress(g, section, mesh.contact_ratio, load, factors.application);
    result.add("temperature" + number, heated);
    result.add("S_F POM" + number,
               plastic_root_safety(root_limit(*find_material("POM"), condition).stress_Pa,
                                   plastic.stress_Pa));
    result.add("S_F PA66" + number,
               plastic_root_safety(root_limit(*find_material("PA66"), condition).stress_Pa,
                                   plastic.stress_Pa));
    result.add("S_H POM" + number,
               plastic_flank_safety(flank_limit(*find_material("POM"), condition).stress_Pa,
                                    flank.pitch_point_Pa));
  }
  return result;
}

Point start(Pair kind) {
  return {1.1,
          0.35,
          kind == Pair::kExternal ? 0.2 : 0.45,
          kind == Pair::kExternal ? 23.5 : 25.65,
          9.0,
          1.7,
          1.3,
          0.02};
}

template <class T>
std::array<T, kVariables> seeded(const Point& point) {
  std::array<T, kVariables> result{};
  for (std::size_t i = 0; i < kVariables; ++i) {
    if constexpr (std::is_same_v<T, Jet1>) {
      result[i] = Jet1(point[i], static_cast<int>(i));
    } else {
      result[i] = Jet2::variable(point[i], i);
    }
  }
  return result;
}

// Central differences of step h: h² of truncation and eps/h of rounding, both near 1e-10 of a
// value's own scale; a slope may be small against value over variable.
constexpr double kStep = 1e-5;
constexpr double kSlopeTolerance = 1e-6;

void expect_slopes(Pair kind) {
  const Point point = start(kind);
  const Named<Jet1> exact = outputs(kind, seeded<Jet1>(point));
  for (std::size_t i = 0; i < kVariables; ++i) {
    const auto at = [&](double share) {
      Point moved = point;
      moved[i] += share * kStep * point[i];
      return outputs<double>(kind, moved).values;
    };
    // Fourth order.
    const auto far_above = at(2.0), above = at(1.0), below = at(-1.0), far_below = at(-2.0);
    const double h = kStep * point[i];
    for (std::size_t k = 0; k < exact.values.size(); ++k) {
      const double slope =
          (8.0 * (above[k] - below[k]) - (far_above[k] - far_below[k])) / (12.0 * h);
      const double scale = std::abs(slope) + std::abs(exact.values[k].a / point[i]);
      EXPECT_NEAR(exact.values[k].v[static_cast<int>(i)], slope, kSlopeTolerance * scale)
          << exact.names[k] << " by variable " << i;
    }
  }
}

TEST(StrengthSlopes, OfAnExternalPairAreTheDifferences) { expect_slopes(Pair::kExternal); }
TEST(StrengthSlopes, OfARingShapedByACutterAreTheDifferences) { expect_slopes(Pair::kCutterRing); }
TEST(StrengthSlopes, OfARingWithArcsAreTheDifferences) { expect_slopes(Pair::kArcRing); }

TEST(StrengthSlopes, HessiansAreTheDifferencesOfGradients) {
  for (const Pair kind : {Pair::kExternal, Pair::kCutterRing, Pair::kArcRing}) {
    const Point point = start(kind);
    const Named<Jet2> exact = outputs(kind, seeded<Jet2>(point));
    for (std::size_t i = 0; i < kVariables; ++i) {
      Point up = point, down = point;
      const double h = kStep * point[i];
      up[i] += h;
      down[i] -= h;
      const auto above = outputs(kind, seeded<Jet1>(up)).values;
      const auto below = outputs(kind, seeded<Jet1>(down)).values;
      for (std::size_t k = 0; k < exact.values.size(); ++k) {
        for (int j = 0; j < kMaxVariables; ++j) {
          const double difference = (above[k].v[j] - below[k].v[j]) / (2.0 * h);
          const double scale =
              std::abs(difference) +
              std::abs(value_of(exact.values[k]) / (point[i] * point[static_cast<std::size_t>(j)]));
          EXPECT_NEAR(exact.values[k].mixed[static_cast<std::size_t>(j)][i], difference,
                      1e-5 * scale)
              << exact.names[k] << " by variables " << i << ", " << j;
        }
      }
    }
  }
}

}  // namespace
}  // namespace gear3k::strength::slopes_test
