#pragma once
// A cause that can make a simulation wrong: what it changes, with which parameters, in which forms.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/measurement/measurement.hpp"
#include "design/extension.hpp"
#include "train/tooth_set.hpp"

namespace gear3k::calibrate {

/// Scalar of the simulation in fits: value and derivatives by the fitted parameters.
using Scalar = Jet1;

class Simulation;

/// What causes may change in the reading of one row.
struct ReadingChange {
  /// On the friction of the meshes in this row, beside the gearbox's own level: what sessions, time
  /// and cycles change.  Simulation::response() does not know it: LevelledResponses does.
  Scalar friction_level{1.0};
  Scalar response_factor{1.0};  ///< on the simulated response
  Scalar added{0.0};            ///< to the response [its SI unit]
  Scalar sensor_gain{1.0};      ///< of the sensor that measures the response
  Scalar sensor_offset{0.0};    ///< in the sensor's own sign [SI]
};

/// What the sensor of the output's torque reads too much [Nm].
struct OutputSensorError {
  /// In the sensor's own sign, that of the torque at the output when the sun turns with +1 and
  /// drives: it reads rotation · (T + …) forward and −rotation · (T + …) backward.
  Scalar own_sign{0.0};
  Scalar magnitude{0.0};  ///< whichever way anything turns or drives
};

/// What causes may change in the simulation of one row.
struct Modification : ReadingChange {
  design::Extension<Scalar> gearbox;
  OutputSensorError output_sensor;  ///< the gearbox is under another load than the rows state
};

/// A parameter of a cause; numbers in `unit`.
struct ParameterRecord {
  std::string_view name, unit;
  double lower, upper;                   ///< bounds of the fit
  double plausible_low, plausible_high;  ///< what a gearbox may show
  /// Of how a form bends within the range of the data: its bounds are those of the form, and rows
  /// that would have a value beyond them are not rows that no gearbox shows.
  bool is_of_shape = false;
};

/// A quantity that follows from fitted parameters, with its derivatives by them.
struct DerivedParameter {
  ParameterRecord record;  ///< bounds: of nothing
  Scalar value;
  bool leads = false;  ///< is told before the parameters
};

/// A constant that tells forms of a cause apart: reference force, instant of a step, order.
struct FormConstant {
  std::string name = {}, unit = {};
  double value = 0.0;
};

/// One way in which a cause may act.  Forms of a cause may differ in their parameters
/// (Cause::parameters).
struct Form {
  std::string name = {};
  std::vector<FormConstant> constants = {};
  std::string body = {};  ///< run-out: "sun", "planet", "carrier", "output"
  double order = 0.0;     ///< run-out: per output revolution; 0 = none
  /// Share of the forms that it is given in the search, before the data; 0: not searched for, but
  /// taken in the place of a form that was found where it explains the data as well.
  double weight = 1.0;
  std::string_view law = {};  ///< one law of the cause among several; others do not take its place

  /// @throws std::invalid_argument when there is no such constant
  [[nodiscard]] double constant(std::string_view constant_name) const;
};

/// Laws of causes that change what a row's session, time or cycles say, by what they change.
inline constexpr std::string_view kOnFriction = "friction", kOnGain = "gain", kOnOffset = "offset",
                                  kOnDrag = "drag";

/// What a cause needs to know of data and gearbox to state its forms.
struct Occasion {
  Kind kind = Kind::kTransmission;
  const MeasurementSet* data = nullptr;
  const train::ToothSet* teeth = nullptr;  ///< null for a black box or pairs
  double ratio = 0.0;                      ///< 0 for pairs
  /// Range over the rows of what stands for tooth load and sliding speed: of the mesh P1-R1, N and
  /// m/s; of a black box output torque, Nm, and sun speed, rad/s.
  std::array<double, 2> load{}, speed{};
  std::string_view load_unit = "N", speed_unit = "m/s";
  std::array<double, 2> temperature_K{kUnknown, kUnknown};
  double design_temperature_K = 293.15;  ///< that the simulation stands for
  bool has_drag = false;                 ///< the simulation has drags whose size could change
  bool every_wave = false;               ///< whether or not the angles show it: for lists of forms
};

/// Whether the temperatures of the rows differ enough for a law of temperature: over less, whatever
/// else went on with time looks like one, and what it says a few kelvin away was not measured.
/// 3 K, an assumption.
inline bool tells_of_temperature(const Occasion& o) {
  constexpr double kLeast_K = 3.0;
  return o.temperature_K[1] - o.temperature_K[0] >= kLeast_K;
}

/// What follows for whoever finds the cause; causes of one remedy need no telling apart.
enum class Remedy {
  kFrictionValue,  ///< take another coefficient of friction: a parameter, not a missing effect
  kFlanks,         ///< surfaces, lubricant, flank geometry
  kDrag,           ///< seals, preload, oil level
  kBearings,
  kSensor,     ///< calibrate the measurement
  kProcedure,  ///< measuring sessions, running-in, wear
  kAccuracy,   ///< run-out and pitch errors of parts
  kClearance,
  kStiffness,
  kHousing  ///< materials, temperature
};

/// Where a cause acts.
enum class Place {
  kGearbox,     ///< in Modification::gearbox, whatever the condition
  kMeasurement  ///< everywhere else in Modification
};

struct Cause {
  std::string_view id;     ///< of the interface
  std::string_view title;  ///< "load-independent drag at the sun"
  Remedy remedy;
  Place place;
  /// Weight before the data: chosen so that campaigns show the causes about equally easily, as more
  /// forms and parameters make one harder to find (docs/theory §30).
  double weight;
  /// Forms of this cause set the same constants: only one of them can act at a time.
  bool exclusive_forms = false;
  std::vector<ParameterRecord> (*parameters)(const Form& form, Kind kind);
  /// Forms that these data could show at all; empty where they lack the column that it acts along.
  std::vector<Form> (*forms)(const Occasion& occasion);
  /// Changes the simulation of one row.  `p` in units of the parameters, all 0: no change.
  void (*apply)(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
                Modification& m);
  /// What a reader wants to know beside the parameters; null where there is nothing.
  /// @param p  of this cause; @param all  the simulation under all causes of the fit
  std::vector<DerivedParameter> (*derived)(const Form& form, std::span<const Scalar> p,
                                           const Simulation& simulation,
                                           const Modification& all) = nullptr;
  /// Of a cause whose effect depends on when a row was measured: puts values and condition to what
  /// the campaign left behind, which is what later measurements meet; null for all others.
  void (*leave_behind)(const Form& form, std::span<Scalar> value, Condition& condition) = nullptr;
  /// Of such a cause: the form of one parameter that changes all rows alike, whatever their time
  /// and session, once leave_behind() has put the condition.
  /// @param law  what it changes: one of kOnFriction to kOnDrag; "" the response
  Form (*as_constant)(const Form& form, std::string_view law) = nullptr;
  /// Of a cause of the measurement: whether a form acts in the gearbox all the same, as it changes
  /// what load that is simulated under; null: none does.
  bool (*acts_in_gearbox)(const Form& form) = nullptr;
};

/// All causes; where two explain data as well, the earlier one is named first.
const std::vector<const Cause*>& causes();
/// @returns nullptr when there is none of this id
const Cause* find_cause(std::string_view id);

}  // namespace gear3k::calibrate
