#pragma once

#include <functional>
#include <string>

#include "tests/rig/deterministic_random.hpp"
#include "tests/wide_rig/shape_laws.hpp"

namespace gear3k::wide_rig {

/// Wind-up over the test torque in shares of that at the greatest one, of parts that come to carry
/// one after the other:
///
///   two_stage       stiffness K_1 up to a torque and K_2 beyond it, as makers state it
///   three_stage     K_1, K_2, K_3 with two torques between them
///   gradual_stages  many small parts: the softness of the beginning dies out as 1/(1 + (T/T_1)²)
std::function<double(double torque_Nm)> stage_law(const std::string& law, Span torque_Nm,
                                                  rig::DeterministicRandom& random);

/// Radius of the bearing on a gear's shaft over the gear's own:
///
///   torsion_shafts   of a shaft that its torque F r strains alike, d ~ (F r)^(1/3)
///   hub_bores        a share of the gear and what the hub takes at least
///   catalogue_bores  the next bore of a catalogue above a share of the gear
std::function<double(double radius_mm)> bearing_radius_law(const std::string& law,
                                                           rig::DeterministicRandom& random);

}  // namespace gear3k::wide_rig
