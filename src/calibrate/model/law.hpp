#pragma once
// A formula without a cause: what is left of a response as a function of the conditions.

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate {

/// What a law changes; v: its value, y: the response, s: +1 forward, −1 backward.
enum class LawAction {
  kAdded,      ///< y + v
  kLoss,       ///< y + s v: more torque at the sun forward, less backward
  kShare,      ///< y (1 + v)
  kShareLost,  ///< y (1 + s v)
};
inline constexpr std::array<std::string_view, 4> kLawActionNames{"response", "loss",
                                                                 "response_share", "loss_share"};
constexpr bool is_share(LawAction action) {
  return action == LawAction::kShare || action == LawAction::kShareLost;
}

/// In which rows a law acts.
enum class LawRows { kAll, kForward, kBackward, kPositive, kNegative };
inline constexpr std::array<std::string_view, 5> kLawRowsNames{
    "all", "forward", "backward", "positive_rotation", "negative_rotation"};

/// A condition that a law may depend on, as a number in the unit of files.
struct LawCondition {
  std::string_view name, unit;
  std::string_view shown_unit;        ///< as formulas write it
  std::vector<Kind> kinds;            ///< of data that state it
  bool natural_zero = true;           ///< 0 is where there is none of it; not so for a temperature
  bool of_campaign = false;           ///< counts from where a campaign begins: time, cycles
  double turn = 0.0;                  ///< > 0: waves count per this much of it (360 deg)
  double (*value)(const Condition&);  ///< NaN: not stated
};
const std::vector<LawCondition>& law_conditions();

/// A factor of a law, f(x) of one condition x, with u = (x − origin)/reference.
enum class LawShape {
  kPower,        ///< u^a, u at least 1e-3
  kExponential,  ///< exp(k u)
  kGrowth,  ///< (exp(k u) − 1)/(exp(k) − 1): rises ever faster (k > 0) or levels off (k < 0)
  kSaturation,  ///< x/(x + x_h) over its value at u = 1
  kBell,        ///< exp(−((x − x_c)/w)²)
  kResonance,   ///< 1/(1 + ((x − x_c)/w)²)
  kWindow,      ///< exp(−(ln(x/x_c)/W)²), W a constant; 0 for x <= 0
  kRamp,        ///< max(0, x − x_t)/reference
  kStep,        ///< 1 above the constant x_t, else 0
  kCentred,     ///< (x − x_z)/reference
  kWave,        ///< cos 2π(ν u − φ)
  kPulse,       ///< exp(−(d/W)²), d = ν u − φ less the next whole number, W a constant
};
struct LawShapeRecord {
  std::string_view name;                       ///< in files
  std::string_view title;                      ///< "power of"
  std::array<std::string_view, 2> parameters;  ///< "" = none
  std::string_view constant = {};              ///< "" = none
  bool natural_zero = false;                   ///< for conditions with a natural zero only
  bool turns = false;                          ///< for those with turns, or time, only
};
const LawShapeRecord& record_of(LawShape shape);
inline constexpr int kLawShapes = 12;
int parameter_count(LawShape shape);

struct LawFactor {
  LawShape shape = LawShape::kPower;
  std::size_t condition = 0;             ///< of law_conditions()
  double origin = 0.0, reference = 1.0;  ///< of u, in the condition's unit; reference > 0
  double constant = 0.0;                 ///< x_t or W
  /// Where x is taken as these beyond them: a formula for measured values says nothing far from
  /// them.  The greatest time, or number of cycles, is that of the last row.
  double least = -HUGE_VAL, greatest = HUGE_VAL;
};

/// v = offset + amplitude · f_1 · f_2.  At most three parameters (kMostLawParameters).
///
/// Offset and amplitude are in the unit of the response (Nm, arcmin, 1), of a share 1.  In rows
/// that do not state a condition, and where rows leave it out, v is 0.
struct Law {
  LawAction action = LawAction::kAdded;
  LawRows rows = LawRows::kAll;
  std::vector<LawFactor> factors;  ///< one or two, of different conditions
  bool offset = false;
};
inline constexpr int kMostLawParameters = 3;

/// Amplitude, offset where there is one, then those of the factors: names, units and bounds.
std::vector<ParameterRecord> parameters_of(const Law& law, Kind kind);

/// The value of a factor at x; derivatives by its parameters.
/// @param p  as many as parameter_count()
template <class T>
T factor_value(const LawFactor& factor, double x, const T* p);

/// Whether a law acts in rows of a condition, and states all that it needs.
bool acts_in(const Law& law, const Condition& condition);

/// Whether a factor's condition has an end: angles, and times of waves, go on as they do.
bool has_limits(const LawFactor& factor);

/// v at a condition where acts_in() holds, in the unit of its amplitude; conditions beyond least
/// and greatest count as these.
template <class T>
T law_value(const Law& law, const Condition& condition, const T* p);

/// What a law multiplies its value by in a row to give the change of a response: 1, s, y or s y.
double law_weight(LawAction action, const Condition& condition, double response);

/// A law as an effect of a hypothesis, so that it is fitted with the causes beside it.  The form
/// holds all of it: law_of(form_of(law)) is the law.
const Cause& law_cause();
Form form_of(const Law& law);
/// @throws std::invalid_argument for a form that is no law's
Law law_of(const Form& form);

/// "power of output_torque times power of sun_speed"
std::string law_title(const Law& law);
/// "loss = 0.0123 Nm * (sun_speed/3000 rpm)^1.02"
std::string law_formula(const Law& law, const std::vector<double>& value, Kind kind);

/// A law with its fitted parameters.
struct AppliedLaw {
  Law law;
  std::vector<double> value;  ///< as parameters_of()
  /// Of each factor over time or cycles, what its campaign left behind: its value at the last row,
  /// of a wave or pulse the mean over the rows; NaN: not known.
  std::array<double, 2> left_behind{kUnknown, kUnknown};
};
/// Whether a law is over time or cycles, which count from where its campaign began.
bool is_of_campaign(const Law& law);

/// A law with what it leaves behind in rows; means are over those where it acts.
/// @param value  as parameters_of()
AppliedLaw applied_law(const Law& law, std::span<const double> value,
                       std::span<const Observation> rows);

/// A law as its campaign left it behind, which is what later measurements meet.
/// @returns a law of the factors over other conditions, maybe none; empty where it is not known
std::optional<AppliedLaw> as_left_behind(const AppliedLaw& applied);

void apply_law(const AppliedLaw& applied, const Condition& condition, Kind kind, Modification& m);

}  // namespace gear3k::calibrate
