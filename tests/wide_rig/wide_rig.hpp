#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gear3k::wide_rig {

/// A value that the contract defines without a choice of form.
struct TruthParameter {
  std::string name, unit;
  double value = 0.0;
};

/// One hidden effect.
struct Truth {
  std::string cause;    ///< id of the table of causes in docs/interface.md; "unknown": none of them
  std::string law;      ///< generating law
  std::string acts_on;  ///< friction, gain, offset, drag on a body, lost motion, ...; with the body
  /// Causes that explain these data as well, the cause itself among them: those one of whose usual
  /// shapes, with another coefficient of friction, leaves a chi-square below 9 of the clean effect.
  /// The likelihoods of two models that far apart choose the wrong one in 1 of 15 campaigns.
  std::vector<std::string> acceptable{};
  std::vector<TruthParameter> parameters{};
  double strength = 0.0;  ///< of this effect alone, as Campaign::strength
};

struct File {
  std::string name, text;
};

/// A wave that something in the gearbox can make.
struct PossibleOrder {
  std::string cause;  ///< runout or mesh_order
  /// sun, planet, carrier, R2 or teeth; an order of a body may be relative to the carrier or not.
  std::string body{};
  double order = 0.0;  ///< periods per turn of the output
};

/// What a test bench with hidden effects writes, and what is true.
struct Campaign {
  std::string subject_toml{};  ///< DESIGN, PAIR or black box
  std::vector<File> files{};   ///< measurements to be diagnosed
  /// Response without noise under the conditions as written, row by row of `files`; of torque-angle
  /// records none.
  std::vector<double> clean{};
  std::vector<File> unseen{};          ///< rows at other speeds and loads, same effects and sensor
  std::vector<double> unseen_clean{};  ///< response without noise, row by row of `unseen`
  /// The next session after the campaign, at levels as in `unseen`; none of torque_angle, whose
  /// unseen rows are of the end of the record.
  std::vector<File> later{};
  std::vector<double> later_clean{};
  std::vector<Truth> truths{};  ///< empty: null campaign
  /// Root mean square of the noise, unit of the response, without outliers. torque_angle: of one
  /// sample of the angle, at the output. Sun torque set and output torque read: the noise of the
  /// output torque, referred to the sun.
  double noise_sd = 0.0;
  /// Root mean square over the rows of (clean with effects - clean without) / noise_sd: all effects
  /// together, and for sun torques that are set at the output torques that follow.
  double strength = 0.0;
  std::string kind{}, plan{}, noise_model{};
  /// Causes that these data rule out: in the place of any hidden effect, all others and the
  /// coefficient of friction free, they leave a chi-square above 60 and a twentieth of the
  /// effect's.
  std::vector<std::string> excluded{};
  /// Of waves: the orders of the gearbox that describe these rows as well as the true one (aliases
  /// on a grid of angles, orders that the turns do not resolve), the true one among them:
  /// chi-square within 9 of what the true one leaves.
  std::vector<PossibleOrder> orders{};
  /// Causes that may stand beside the truths without being wrong: what is common to all rows of an
  /// effect whose zero is not the nominal gearbox (reference points, mean of steps), and what a law
  /// holds besides its cause.
  std::vector<std::string> companions{};
};

struct HiddenCause {
  std::string cause, law;  ///< empty law: chosen at random
};

/// A line of a table of rates.
struct Line {
  std::string name;
  /// single, special, pair, triple, null, correlated (null, noise that remembers), confounded,
  /// aliased or unknown
  std::string group;
  std::string kind;  ///< of measurement
  std::vector<HiddenCause> hidden;
  std::string plan;   ///< empty: chosen at random among those that let the causes be told apart
  std::string noise;  ///< a model of sensor_noise.hpp; empty: at random
};

/// All lines, names unique.
std::vector<Line> lines();

/// A campaign of a line. The plan, the gearbox and the laws depend on the seed only, not on the
/// strength.
///
/// @param strength of each hidden effect by itself: rms over the rows / noise_sd. Where physics
///                 (friction above zero, no efficiency above 1, no negative lost motion) forbids
///                 it, the greatest possible is taken and stated.
/// @throws std::invalid_argument for causes, laws and plans that do not exist
Campaign make_campaign(const Line& line, double strength, std::uint64_t seed);

}  // namespace gear3k::wide_rig
