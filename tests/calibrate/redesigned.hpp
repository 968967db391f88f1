#pragma once
// What optimize says a model gains, beside what the redesigned gearbox gains on the bench that the
// model was measured on.

#include <cstdint>
#include <string>

#include "app/optimize.hpp"

namespace gear3k::wide_rig {

/// A task, and the gearbox that is built and measured first: its best design without a model.
struct FirstDesign {
  optimize::Specification spec;
  design::Design design;
};
/// @throws std::invalid_argument where the specification has no feasible design
FirstDesign first_design(const optimize::Specification& spec);

/// What is hidden on the bench.
struct HiddenLaw {
  std::string cause, law;   ///< of hidden_effect.hpp, one that belongs to the gearbox
  std::string plan{};       ///< of test_plan.hpp; empty: crossed, by_session or even_angles
  std::size_t rows = 1000;  ///< at most
  /// Files state neither angles, times, sessions nor temperatures: quick to diagnose.
  bool few_columns = false;
};

/// Measured, diagnosed, designed again, built and measured again.
struct Redesigned {
  std::string answer;  ///< causes that the diagnosis named, each with its likeliest alternative
  report::ModelChange change;
  double true_gain = 0.0;  ///< in the objective, an efficiency, of the gearboxes as the bench has
                           ///< them
  /// Whether it is in the interval that is stated.
  [[nodiscard]] bool covered() const;
};

/// One campaign on the wide rig, whose laws, plans and noise are not the library's.  Friction that
/// differs as a whole does so by 20 to 60 %; of other laws the root mean square of what they change
/// is 3 to 25 standard deviations of the noise.  The operating point lies within the campaign's
/// conditions.  Pins and seals stay as they are when the teeth change.
///
/// Everything random comes from the seed.
/// @throws std::invalid_argument for a law that the bench does not know
Redesigned redesigned(const FirstDesign& first, const HiddenLaw& hidden, std::uint64_t seed);

}  // namespace gear3k::wide_rig
