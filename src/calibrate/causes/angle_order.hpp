#pragma once
// What run-out and pitch errors have in common: a response that repeats with an order of the
// output's angle.

#include <string>
#include <vector>

#include "calibrate/model/cause.hpp"
#include "train/shaft_orders.hpp"

namespace gear3k::calibrate {

/// Amplitudes of cosine and sine: a share of the response (form "proportional") or of the friction
/// (form "friction"), or in the response's unit (form "constant": on its magnitude; form "drag": a
/// torque at the sun, which adds forward and takes away backward).
std::vector<ParameterRecord> angle_parameters(const Form& form, Kind kind);

/// Whether the angles of rows show a wave of an order and its harmonics, beside what all rows have
/// in common: the phases are spread so that no coefficient's variance is more than four times what
/// phases spread evenly over the turn would make it,
///
///   Var(p_j) σ²/n ≤ 4,   p of 1, √2 cos mφ, √2 sin mφ;   m = 1 … harmonics
///
/// (0.57 of a turn for the first harmonic, 0.7 for two), and where angles pass over turns of the
/// wave they do not walk through it as slowly as a drift: by one and a half periods of what is left
/// of their steps.
/// @param angle_rad  sorted, each once
/// @param harmonics  from 1 to 3
bool angles_show(const std::vector<double>& angle_rad, double order, int harmonics);

/// The shafts that may run out, and how often each turns per turn of the output.
std::vector<train::ShaftOrder> shafts_of(const Occasion& occasion);

/// Shafts whose turn the angles pass by, though they go far enough: bodies by name, in words.
std::vector<std::string> shafts_not_shown(const Occasion& occasion);

/// Appends what is said of these, where there are any.
void add_note_on_shafts(const Occasion& occasion, std::vector<std::string>& notes);

/// Forms for orders that the data can show (angles_show()), or that draw the same at these angles
/// as a shaft's order which they show: what is not told from that is an alternative.  They span at
/// least 0.6 of a period.
std::vector<Form> angle_forms(const Occasion& occasion,
                              const std::vector<train::ShaftOrder>& orders);

/// The amplitude √(cosine² + sine²).
std::vector<DerivedParameter> angle_amplitude(const Form& form, std::span<const Scalar> p,
                                              const Simulation& simulation,
                                              const Modification& all);

void apply_angle(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
                 Modification& m);

}  // namespace gear3k::calibrate
