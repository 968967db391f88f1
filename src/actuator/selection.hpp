#pragma once
// Which motors and gearboxes of catalogues suit a load: screened by moments of its cycles, then
// run.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "actuator/actuator.hpp"
#include "actuator/chain.hpp"
#include "actuator/cycle.hpp"

namespace gear3k::actuator {

enum class Objective { kEnergy, kMass, kPeakCurrent, kBreakaway, kInertia };
inline constexpr std::array<std::string_view, 5> kObjectiveNames{"energy", "mass", "peak_current",
                                                                 "breakaway", "inertia"};

/// What a pair is held against.
enum class PairLimit {
  kContinuousTorque,    ///< root mean square of m over the gearbox's continuous torque
  kIntermittentTorque,  ///< peak of m over its intermittent torque
  kNominalCurrent,      ///< root mean square of the current over the motor's
  kVoltage,             ///< peak over the bus, or the motor's nominal voltage
  kPeakCurrent,         ///< peak over the stated multiple of the nominal current
  kWinding,             ///< steady temperature rise over what the stated limit leaves
  kSpeed,               ///< of the motor, over its greatest
  kFeltInertia,         ///< that speeds up from outside
  kBreakaway,           ///< from outside
  kTransparency
};
inline constexpr std::array<std::string_view, 10> kPairLimitNames{"continuous_torque",
                                                                  "intermittent_torque",
                                                                  "nominal_current",
                                                                  "voltage",
                                                                  "peak_current",
                                                                  "winding",
                                                                  "speed",
                                                                  "felt_inertia",
                                                                  "breakaway",
                                                                  "transparency"};

struct CatalogueMotor {
  std::string name;
  Motor motor;
  std::optional<double> nominal_current_A, nominal_voltage_V;
  bool friction_known = true;  ///< else it runs without any
  bool coulomb_known = true;   ///< else all of its friction is viscous
  bool inertia_known = true;   ///< else its rotor has none
  /// Of its surroundings, in place of the task's.
  std::optional<double> ambient_K{};
};
struct CatalogueGearbox {
  std::string name;
  Gearbox gearbox;
  std::optional<double> continuous_Nm, intermittent_Nm;
  bool inertia_known = true;  ///< else it has none
  int planets = 0;            ///< 0 = not known
  std::string file{};         ///< that it is of
};

struct SelectionTask {
  std::string name;
  std::vector<CatalogueMotor> motors;
  std::vector<CatalogueGearbox> gearboxes;
  std::vector<Cycle> cycles;
  std::vector<double> weights;  ///< how often each cycle is run
  std::vector<Objective> objectives{Objective::kEnergy, Objective::kMass};
  Drive drive;
  double load_inertia_kgm2 = 0.0;
  std::optional<double> peak_current_factor;  ///< of the nominal current
  std::optional<double> max_winding_K;
  double ambient_K = kResistanceTemperature_K;
  FeltLimits felt{};
};

/// What is not known of a pair: its result is the better for it.
enum class Unknown {
  kMotorFriction,
  kNominalCurrent,  ///< no limit of the current, nor of its peak
  kGearboxTorque,   ///< no continuous or no intermittent torque
  kWinding,         ///< no temperature, and no limit of it
  kMass,
  kMotorCoulomb,    ///< all friction of the motor is viscous: none of it holds at rest
  kGearboxDrag,     ///< breakaway is without it
  kRotorInertia,    ///< the rotor runs without
  kGearboxInertia,  ///< the gearbox runs without
  kVoltage          ///< no limit of it
};
inline constexpr std::array<std::string_view, 10> kUnknownNames{
    "motor_friction", "nominal_current", "gearbox_torque", "winding",         "mass",
    "motor_coulomb",  "gearbox_drag",    "rotor_inertia",  "gearbox_inertia", "voltage"};

/// What FeltLimits limit; infinite where the output cannot be moved so.
struct Felt {
  double inertia_kgm2 = 0.0, breakaway_Nm = 0.0;
  std::optional<double> transparency{};  ///< empty where its torque is not stated
};

/// Places in the lists of a task.
struct Pair {
  std::size_t motor = 0, gearbox = 0;
};

/// What a pair does, all cycles together.
struct PairResult {
  Pair pair;
  double energy_J = 0.0;  ///< drawn less regenerated, by the weights
  double rms_current_A = 0.0, peak_current_A = 0.0, peak_voltage_V = 0.0;
  double peak_motor_speed_rad_s = 0.0;
  double rms_torque_Nm = 0.0, peak_torque_Nm = 0.0;  ///< m
  std::optional<double> winding_K{};                 ///< empty at a runaway, or where not known
  std::optional<double> mass_kg{}, breakaway_Nm{};
  double inertia_kgm2 = 0.0;   ///< reflected, of motor and gearbox
  std::optional<Felt> felt{};  ///< empty where no limit asks for it, or not yet known
  /// Greatest value over limit less 1, and which limit: above 0 = infeasible.
  double excess = 0.0;
  std::optional<PairLimit> limit{};
};

enum class PairStatus { kFront, kDominated, kInfeasible };
inline constexpr std::array<std::string_view, 3> kPairStatusNames{"front", "dominated",
                                                                  "infeasible"};

/// What became of one pair; a named reason for every rejection.
struct PairVerdict {
  Pair pair;
  PairStatus status = PairStatus::kDominated;
  std::optional<PairLimit> limit{};  ///< of an infeasible one
  double excess = 0.0;               ///< by which that limit is exceeded at least, over the limit
  bool run = false;                  ///< the exact cycle was run; else the moments decided
};

struct Selection {
  std::vector<PairVerdict> verdicts;  ///< gearbox by gearbox
  std::vector<PairResult> front;      ///< in the order of the verdicts
  std::array<std::size_t, kPairLimitNames.size()> rejected{};
  std::size_t run = 0;                ///< pairs whose cycles were run
  std::optional<PairResult> nearest;  ///< where nothing is feasible: least excess
};

/// The Pareto front of all pairs.
///
/// Of a gearbox and a cycle b = (u, a, w, s) is known; M = ∫ b bᵀ dt gives the mean square torque
/// of any motor as pᵀ M p/t with p = (1, i² J_m, D1, c1), and ∫ τ w dt its energy at a lossless
/// drive. They bound what the exact cycle gives from below; that is run only where no pair of the
/// front so far is as good in every objective, so the front is that of running all. Source: own
/// derivation, docs/theory §63.
/// @throws std::invalid_argument where weights and cycles differ in number
Selection select(const SelectionTask& task);

/// One pair by its exact cycles.
PairResult run_pair(const SelectionTask& task, const Pair& pair);
/// The same of an actuator in place of the pair's, such as one with a train.
PairResult run_actuator(const SelectionTask& task, const Pair& pair, const Actuator& actuator);

/// Holds the values of a pair, or bounds of them from below, against the limits of its motor and
/// gearbox: sets excess, limit and winding_K of `judged`, which may be `values`.
/// @param friction_W  of the motor, mean
void judge(const SelectionTask& task, const PairResult& values, double friction_W,
           PairResult& judged);

/// Temperature around a motor of the task [K].
double ambient_of(const SelectionTask& task, std::size_t motor);

/// What no catalogue tells of a pair.
std::vector<Unknown> unknown_of(const SelectionTask& task, const Pair& pair);

/// Whether a is as good as b in every objective and better in one.
bool dominates(const SelectionTask& task, const PairResult& a, const PairResult& b);

/// ∫ b bᵀ dt over the moving part of a cycle, and what else a motor's bounds need.
struct CycleMoments {
  std::array<std::array<double, 4>, 4> square{};  ///< of (u, a, w, s)
  double input_work_J = 0.0;                      ///< ∫ u w dt
  double square_mesh = 0.0;                       ///< ∫ m² dt
  double peak_mesh_Nm = 0.0;
  double period_s = 0.0;
  std::vector<std::array<double, 4>> points;  ///< b at the ends of all parts
};
CycleMoments cycle_moments(const Actuator& actuator, const std::vector<CyclePiece>& pieces);

}  // namespace gear3k::actuator
