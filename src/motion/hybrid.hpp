#pragma once
// An actuator as a hybrid system: modes, the equations within each, and what ends it.

#include <memory>
#include <string>
#include <vector>

#include "actuator/chain.hpp"
#include "motion/motion_gear.hpp"
#include "motion/stepper.hpp"
#include "motion/surroundings.hpp"

namespace gear3k::motion {

/// Places in a State: both sides, then energies by where they go [J].
enum StatePlace : std::size_t {
  kFastAngle,
  kFastSpeed,
  kOutputAngle,
  kOutputSpeed,
  kDrawn,
  kRegenerated,
  kPositive,
  kNegative,
  kCopper,
  kMotorCoulomb,
  kMotorViscous,
  kDrive,
  kGearLosses,
};
static_assert(kGearLosses + actuator::kMostGearLosses == kStateSize);

enum class Phase {
  kStick,  ///< both sides rest
  kSlide,  ///< they turn as one
  kGap,    ///< each by itself, within the backlash
};

struct Mode {
  Phase phase = Phase::kStick;
  int sense = 0;    ///< of kSlide: s
  int flow = 0;     ///< of kSlide: 1 forward, −1 backward
  int contact = 0;  ///< with backlash, but in kGap: side on which the motor's side pushes
  int fast_sense = 0, output_sense = 0;  ///< of kGap; 0: that side rests
  bool operator==(const Mode&) const = default;
};

/// Energies that a moment takes.
struct Occurrence {
  std::string what;  ///< "contact", "jams"
  Mode before, after;
  double loss_J = 0.0;
};

/// A side that turns has come to rest this far beyond zero, which rounding cannot make of a start.
inline constexpr double kSpeedFloor_rad_s = 1e-15;

/// Both sides in a state.
Sides sides_of(const State& x);

/// Everything at an instant of a mode.
struct Instant {
  Outside outside{};
  double fast_rad_s2 = 0.0, output_rad_s2 = 0.0;
  double mesh_Nm = 0.0;  ///< m; 0 in a gap, not determined at rest
  double lead = 0.0, lead_rounding = 0.0;
  bool jammed = false;
  double motor_coulomb_W = 0.0, motor_viscous_W = 0.0, bus_W = 0.0;
  std::array<double, actuator::kMostGearLosses> loss_W{};
};

class Hybrid {
 public:
  /// @throws std::invalid_argument where a side has no inertia that it needs
  Hybrid(const actuator::Actuator& actuator, const Scenario& scenario);

  [[nodiscard]] const Mode& mode() const { return mode_; }
  [[nodiscard]] const MotionGear& gear() const { return *gear_; }
  [[nodiscard]] const Surroundings& surroundings() const { return surroundings_; }
  [[nodiscard]] double kinetic_j(const State& x) const;
  /// A fortieth of the shortest period, at most a fiftieth of the duration.
  [[nodiscard]] double max_step_s() const;
  [[nodiscard]] State start() const;

  [[nodiscard]] Instant at(const State& x, double time_s) const;
  void slopes(const State& x, State& dxdt, double time_s) const;

  /// Everything that could end the mode or change the sign of a power: above zero while it lasts.
  /// Their number and order are the same as long as the mode stays.
  /// @returns what acts from outside at that instant
  Outside watch(const State& x, double time_s, std::vector<double>& values) const;
  /// Takes note of what has ended, values[k] ≤ 0: speeds that have become zero are so exactly.
  void take(const std::vector<double>& values, State& x);
  /// Goes on to the mode that holds from a time on; appends what happens on the way.
  void settle(State& x, double time_s, std::vector<Occurrence>& happened);
  void enter(double time_s) { surroundings_.enter(time_s); }

 private:
  struct Signs {
    int electrical = 1, bus = 1, load = 1;
    std::array<int, 2> rest{1, 1};  ///< of what still holds the output at rest, forward, backward
  };

  [[nodiscard]] JointInput joint_input(const Outside& o, double speed_rad_s, int sense,
                                       bool starting) const;
  /// What rounding may make of the torques at rest.
  [[nodiscard]] double hidden_torque_nm(const Outside& o) const;
  /// What the motor's side has beyond what turns the output from rest, with the frictions at rest
  /// and with those in motion [N m].
  [[nodiscard]] double breakaway_excess_nm(const Outside& o, int sense) const;
  /// Above zero while neither has changed its sign: what holds may be let go and held again by the
  /// other side within a step.
  [[nodiscard]] std::array<double, 2> rest_margins(const Outside& o) const;
  /// The same where the output then starts, below zero where it is held.
  [[nodiscard]] double start_excess(const Outside& o, int sense) const;
  [[nodiscard]] double fast_start_excess(const Outside& o, int sense) const;
  [[nodiscard]] double output_start_excess(const Outside& o, int sense) const;
  /// Above zero while the sides at rest in contact do not come apart.
  [[nodiscard]] double cohesion(const Outside& o) const;
  [[nodiscard]] double bus_w(double electrical_W) const;
  [[nodiscard]] std::array<double, 3> power_margins(const Instant& now, const State& x) const;
  void set_slide(const JointInput& in, int flow, Instant& now) const;
  void set_gap(const State& x, const Mode& mode, Instant& now) const;
  void settle_stick(State& x, double time_s);
  void settle_slide(State& x, double time_s, std::vector<Occurrence>& happened);
  void settle_gap(State& x, double time_s, std::vector<Occurrence>& happened);
  void hit(State& x, int side, std::vector<Occurrence>& happened);
  void set_senses(const State& x, const Outside& o);
  void leave(State& x, const Mode& gap);
  void jam(State& x, std::vector<Occurrence>& happened);
  void hold_signs(const State& x, double time_s);
  /// What rounding hides of the room in the gap [rad].
  [[nodiscard]] double hidden_room(const State& x) const;
  [[nodiscard]] int started(const Outside& o, bool fast) const;

  actuator::Chain chain_;
  actuator::Drive drive_;
  const Scenario& scenario_;
  double half_gap_rad_;
  Surroundings surroundings_;
  std::unique_ptr<MotionGear> gear_;
  Mode mode_;
  Signs signs_;
};

/// "stick", "slide", "gap".
const char* phase_name(Phase phase);

}  // namespace gear3k::motion
