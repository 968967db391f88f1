#pragma once
// What run-out and pitch errors have in common: a response that repeats with an order of the
// output's angle.

#include "calibrate/model/cause.hpp"
#include "train/shaft_orders.hpp"

namespace gear3k::calibrate {

/// Amplitudes of cosine and sine: a share of the response (form "proportional") or of the friction
/// (form "friction"), or in the response's unit (form "constant": on its magnitude; form "drag": a
/// torque at the sun, which adds forward and takes away backward).
std::vector<ParameterRecord> angle_parameters(const Form& form, Kind kind);

/// Forms for orders that the data can show: they span at least 0.6 of a period.
std::vector<Form> angle_forms(const Occasion& occasion,
                              const std::vector<train::ShaftOrder>& orders);

/// The amplitude √(cosine² + sine²).
std::vector<DerivedParameter> angle_amplitude(const Form& form, std::span<const Scalar> p,
                                              const Simulation& simulation,
                                              const Modification& all);

void apply_angle(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
                 Modification& m);

}  // namespace gear3k::calibrate
