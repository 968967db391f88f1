#pragma once
// The simulation of a measured response, and what causes change in it.

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "calibrate/model/cause.hpp"
#include "calibrate/model/extended_model.hpp"
#include "design/elastic_windup.hpp"
#include "design/evaluation.hpp"

namespace gear3k::calibrate {

/// What was measured: a gearbox, a gearbox as a black box, or pairs of gears of one rack.
using Subject = std::variant<design::Design, BlackBox, design::PairDesign>;

/// Least and greatest coefficient of friction on any flank.
struct FrictionRange {
  double least = 0.0, greatest = 0.0;
};

/// A response by condition; empty where the gearbox does not run.
using ResponseAt = std::function<std::optional<Scalar>(const Condition&)>;

/// A subject ready to be simulated.
class Simulation {
 public:
  /// @param models  what earlier measurements added; part of every simulation
  /// @throws std::invalid_argument for a subject that has no defined geometry (why_undefined()) or
  /// that cannot answer this kind (a black box without backlash, a pair's transmission)
  Simulation(const Subject& subject, Kind kind, std::vector<ExtendedModel> models = {});

  /// The starting point of modifications at a condition: what the models say.
  [[nodiscard]] Modification unmodified(const Condition& condition) const;

  /// Response of the gearbox [SI] under Modification::gearbox; empty where it does not run.
  [[nodiscard]] std::optional<Scalar> response(const Condition& condition,
                                               const Modification& m) const;
  /// The same at any conditions, from several threads too.  Refers to this object and to the
  /// modification.
  [[nodiscard]] ResponseAt responses(const Modification& m) const;
  /// Whether that response depends on Condition::temperature_K.
  [[nodiscard]] bool reads_temperature(const Modification& m) const;
  /// What is read of a response under the other parts of a modification [SI].
  [[nodiscard]] Scalar reading(const Scalar& response, const Condition& condition,
                               const Modification& m) const;

  /// Coefficients of friction on the flanks of all meshes, approach and recess, at conditions under
  /// a modification, less what it changes by row; empty where the gearbox does not run, and of a
  /// black box, which has no flanks.
  [[nodiscard]] std::vector<std::optional<FrictionRange>> flank_friction(
      const std::vector<Condition>& conditions, const Modification& m) const;

  /// Coefficients of friction in approach and in recess under a modification; of pairs.
  [[nodiscard]] std::array<Scalar, 2> flank_coefficients(const Modification& m) const;

  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] bool has_models() const { return !models_.empty(); }
  /// Whether a model holds a cause for data of this kind.
  [[nodiscard]] bool models_cause(std::string_view id) const;
  /// Springs whose wind-up is part of the simulated lost motion: those of a DESIGN with [strength]
  /// unless a model's cause `compliance` is all of the wind-up (has_whole_windup()); null: none.
  [[nodiscard]] const design::ElasticTrain* springs() const;
  /// Speeds and loads that the gearbox is meant for: those of the design's map; null without one.
  [[nodiscard]] const design::MapGrid* grid() const;
  /// The ratio of the gearbox; 0 for pairs.
  [[nodiscard]] double ratio() const;
  /// What causes need to know of these data; refers to `data` and to this object.
  [[nodiscard]] Occasion occasion(const MeasurementSet& data) const;

 private:
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): a variant of it is default-made here
  struct Gearbox {
    design::Design design;
    train::TrainParameters<Scalar> parameters;
    train::TrainGeometry<Scalar> geometry;
    efficiency::Friction<Scalar> friction;
    design::ShaftLosses<Scalar> shafts;
    train::TrainGeometry<double> fixed_geometry;
    std::array<double, 2> face_width_m;
    Scalar lost_motion_rad;
    std::optional<design::ElasticTrain> springs;
  };
  [[nodiscard]] ResponseAt sun_torques(const Modification& m) const;
  [[nodiscard]] std::optional<Scalar> lost_motion(const Condition& c, const Modification& m) const;
  [[nodiscard]] Scalar pair_loss(const Condition& c, const Modification& m) const;
  [[nodiscard]] const design::Friction& stated_friction() const;
  /// Tooth load and sliding speed as Occasion tells them.
  [[nodiscard]] std::array<double, 2> load_and_speed(const Condition& c) const;

  Kind kind_;
  std::variant<Gearbox, BlackBox, design::PairDesign> subject_;
  std::vector<ExtendedModel> models_;
};

}  // namespace gear3k::calibrate
