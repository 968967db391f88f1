#pragma once

#include <string>
#include <vector>

#include "tests/wide_rig/bench_row.hpp"
#include "tests/wide_rig/bench_subject.hpp"
#include "tests/wide_rig/shape_laws.hpp"

namespace gear3k::wide_rig {

/// What the laws draw their constants from.
struct EffectContext {
  const BenchSubject* subject = nullptr;
  std::string kind{};
  Span load_Nm{}, speed_rpm{}, temperature_c{}, test_torque_Nm{};
  int sessions = 1;
  double typical = 1.0;             ///< mean response without effects
  double turns = 100.0;             ///< of the output over the campaign, 0: no angles
  bool first_order = false;         ///< waves are those of the output itself
  std::vector<double> orders = {};  ///< waves are one of these; empty: any
};

/// Laws of a cause for a kind of measurement, the obvious one first.
/// @returns empty where the cause does not act on the kind
std::vector<std::string> laws_of(const std::string& cause, const std::string& kind);

/// Causes of a kind of measurement, as the contract lists them.
std::vector<std::string> causes_of(const std::string& kind);

/// Draws one effect.
/// @throws std::invalid_argument for a cause or a law that the kind does not know
HiddenEffect make_effect(const std::string& cause, const std::string& law,
                         const EffectContext& context, rig::DeterministicRandom& random);

/// Periods per turn of the output of what turns in a gearbox.
struct TurningBody {
  std::string name;
  double order = 1.0;
};
/// Sun, planet, carrier and rings, relative to the carrier and absolute; of a black box the fast
/// shaft and the output.
std::vector<TurningBody> turning_bodies(const BenchSubject& subject);
/// Tooth frequencies of the two stages; none of a black box, whose teeth nobody knows.
std::vector<TurningBody> tooth_orders(const BenchSubject& subject);

}  // namespace gear3k::wide_rig
