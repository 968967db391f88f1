#include "efficiency/friction_dependence.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

// What a coefficient of friction depends on, against the coefficient itself in states that differ
// by one quantity.

namespace gear3k::efficiency::friction_dependence_test {
namespace {

constexpr std::array<FrictionLaw, 5> kLaws{FrictionLaw::kConstant, FrictionLaw::kLoadPower,
                                           FrictionLaw::kStribeck, FrictionLaw::kSchlenk,
                                           FrictionLaw::kTable};

/// A law whose every parameter acts.
Friction<double> friction_of(FrictionLaw law) {
  Friction<double> f{};
  f.law = law;
  f.coefficient = 0.05;
  f.load_exponent = -0.2;
  f.reference_force_N = 40.0;
  f.static_coefficient = 0.09;
  f.stribeck_speed_m_s = 0.2;
  f.stribeck_exponent = 1.2;
  f.viscous_s_m = 0.01;
  f.roughness_m = 0.7e-6;
  f.lubricant_factor = 0.9;
  f.lubricant = {
      .temperature_K = {313.15, 373.15}, .viscosity_m2_s = {220e-6, 19e-6}, .density_kgm3 = 880.0};
  f.table = {.sliding_speed_m_s = {0.0, 1.0},
             .tooth_force_N = {1.0, 1000.0},
             .coefficient = {0.08, 0.05, 0.06, 0.04}};
  return f;
}

/// Every part of the extension that multiplies the coefficient, each alone.
struct Part {
  std::string name;
  std::function<void(FrictionExtension<double>&)> set;
};
std::vector<Part> parts() {
  using Extension = FrictionExtension<double>;
  std::vector<Part> list{{"none", [](Extension&) {}},
                         {"level", [](Extension& e) { e.level = 1.1; }},
                         {"load exponent", [](Extension& e) { e.load_exponent = 0.1; }},
                         {"load exponent, of the torque",
                          [](Extension& e) {
                            e.load_exponent = 0.1;
                            e.load_is_torque = true;
                          }},
                         {"slow excess", [](Extension& e) { e.slow_excess = 0.3; }},
                         {"speed exponent", [](Extension& e) { e.speed_exponent = -0.1; }},
                         {"temperature", [](Extension& e) { e.temperature_1_K = -0.01; }},
                         {"side", [](Extension& e) { e.forward = 1.2; }},
                         {"approach", [](Extension& e) { e.approach = 1.2; }},
                         {"inner drives", [](Extension& e) { e.inner_drives = 1.2; }},
                         {"ring meshes", [](Extension& e) { e.ring_meshes = 1.2; }}};
  struct NamedBend {
    std::string name;
    FrictionBend<double> Extension::*bend;
    double half_range;
  };
  for (const NamedBend& own : {NamedBend{"load bend", &Extension::load_bend, 5.0},
                               NamedBend{"speed bend", &Extension::speed_bend, 5.0},
                               NamedBend{"temperature bend", &Extension::temperature_bend, 50.0}}) {
    const auto add = [&](const char* kind, const FrictionBend<double>& bend) {
      list.push_back({own.name + ", " + kind, [own, bend](Extension& e) {
                        e.*own.bend = bend;
                        (e.*own.bend).half_range = own.half_range;
                      }});
    };
    add("quadratic", {.quadratic = 0.4});
    add("cubic", {.cubic = 0.4});
    add("curve", {.s = {0.3, 0.2, 0.1, 0.0, -0.1, 0.1, 0.2}});
  }
  return list;
}

TEST(StateDependence, IsByWhatTheCoefficientChangesWith) {
  const MeshState<double> state{.normal_force_N = 70.0,
                                .sliding_speed_m_s = 0.3,
                                .sum_speed_m_s = 1.1,
                                .reduced_radius_m = 4e-3,
                                .face_width_m = 8e-3,
                                .temperature_K = 320.0,
                                .forward = true,
                                .ring2_torque_Nm = 3.0};
  MeshState<double> loaded = state, faster = state, warmer = state;
  loaded.normal_force_N *= 1.5;
  loaded.ring2_torque_Nm *= 1.5;
  faster.sliding_speed_m_s *= 1.5;
  faster.sum_speed_m_s *= 1.5;
  warmer.temperature_K += 10.0;
  int dependent = 0;
  for (const FrictionLaw law : kLaws) {
    for (const Part& part : parts()) {
      Friction<double> f = friction_of(law);
      part.set(f.extension);
      const auto changes = [&](const MeshState<double>& other) {
        return friction_coefficient(f, other).value() != friction_coefficient(f, state).value();
      };
      const StateDependence depends = state_dependence(f);
      const std::string what = part.name + ", law " + std::to_string(static_cast<int>(law));
      EXPECT_EQ(depends.load, changes(loaded)) << what;
      EXPECT_EQ(depends.speed, changes(faster)) << what;
      EXPECT_EQ(depends.temperature, changes(warmer)) << what;
      const bool any = depends.load || depends.speed || depends.temperature;
      EXPECT_EQ(depends_on_state(f), any) << what;
      dependent += any ? 1 : 0;
    }
  }
  EXPECT_EQ(dependent, 4 * 20 + 14);
}

}  // namespace
}  // namespace gear3k::efficiency::friction_dependence_test
