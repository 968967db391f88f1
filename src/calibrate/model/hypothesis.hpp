#pragma once
// Causes that act together in a simulation, and the values of their parameters.

#include <span>
#include <vector>

#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate {

/// Parameters that a set of causes may have together.
inline constexpr int kMostParameters = 24;

/// A cause in one of its forms.
struct Candidate {
  const Cause* cause = nullptr;
  Form form;
  std::vector<ParameterRecord> parameters;  ///< of cause and form
};

/// Candidates with values for their parameters, in units of the parameters.
struct Hypothesis {
  std::vector<Candidate> effects;
  std::vector<double> value;  ///< of all effects, one after the other
  /// Whether drift and sessions act in every row as the campaign left them behind
  /// (Cause::leave_behind): what later measurements meet.
  bool left_behind = false;
};
std::vector<ParameterRecord> parameters_of(const Hypothesis& h);

/// Whether a candidate sets Modification::friction_level.
bool changes_row_friction(const Candidate& candidate);

/// Where an effect acts: a form of a cause of the measurement may change what the gearbox carries.
Place place_of(const Candidate& candidate);

/// Where the values of an effect begin.
std::size_t value_offset(const Hypothesis& h, std::size_t effect);
/// The values of an effect.
std::span<const double> values_of(const Hypothesis& h, std::size_t effect);

bool has_cause(const Hypothesis& h, const Cause* cause);
/// The same causes in the same forms, in any order and with any values.
bool same_forms(const Hypothesis& a, const Hypothesis& b);

/// With one more effect, its values 0.
Hypothesis with(Hypothesis h, const Candidate& candidate);
/// Without one of the effects.
Hypothesis without(const Hypothesis& h, std::size_t effect);
/// The effects for which `stays` holds, with their values.
Hypothesis subset(const Hypothesis& h, const std::vector<bool>& stays);

/// Changes the simulation of one row by all effects, one after the other.
/// @param value  of all effects, as Hypothesis::value: as constants, or with derivatives
void apply(const Hypothesis& h, std::span<const Scalar> value, const Condition& condition,
           Kind kind, Modification& m);

/// Of those changes the ones that a row's condition decides: all but those of Place::kGearbox.  In
/// data of pairs, where a loss beside the mesh is one of the gearbox, all.
void apply_to_reading(const Hypothesis& h, std::span<const Scalar> value,
                      const Condition& condition, Kind kind, Modification& m);

/// Values without derivatives, and with the derivatives by so many of them from value `first` on:
/// the derivative by value k is in slot k − first.
std::vector<Scalar> constants_of(std::span<const double> values);
std::vector<Scalar> variables_of(std::span<const double> values, std::size_t first = 0,
                                 std::size_t count = kMaxVariables);

}  // namespace gear3k::calibrate
