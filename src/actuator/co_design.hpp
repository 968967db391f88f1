#pragma once
// The best motor for a gearbox that is still to be designed.

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "actuator/design_gear.hpp"
#include "actuator/selection.hpp"
#include "optimize/cycle_energy.hpp"

namespace gear3k::actuator {

/// Energy of a task's cycles with the best of its motors, for any ratio and efficiencies.
///
/// Without inertia and drag of the gearbox, where power flows forward and where backward depends on
/// the load alone, so that the cycles are cut once.  With h = 1/η_f forward and h = η_b backward
///
///   τ = h m + J1 a + D1 w + c1 s,   P_el = ρ τ² + τ w,   ρ = R/(i K_t)²
///
/// and the power from the bus, max(P_el/η_mot, η_reg P_el), is convex in h, as is the copper loss
/// of what is held at rest.  The least energy over h ≥ 1/η_f,max and over 0 ≤ h ≤ η_b,max therefore
/// is at an end or where its slope vanishes, and the bound is exact but for that place.  A lossless
/// drive needs no cycle: ∫ P_el dt is a quadratic in h of ∫ b bᵀ dt, b = (m, a, w, s).  Another one
/// takes at least η_reg and 1/η_mot times that of any stretch, which screens motors.
///
/// The inertia of the gears acts as one on the motor's side, J1 + J, in at(); in a design it is
/// felt through its meshes, τ = h m + (J1 + γ) a + ... with γ(t) between two shares of J. Bounds
/// take the tangent of E at the least inertia, less what γ can take from it.
/// Source: own derivation, docs/theory §75.
class CoDesign final : public optimize::CycleEnergy {
 public:
  /// @param task  its gearboxes and objectives are not used
  /// @param sources  files that it came from
  /// @throws std::invalid_argument without a motor or a cycle, or where weights differ in number
  explicit CoDesign(SelectionTask task, std::vector<std::string> sources = {});

  [[nodiscard]] optimize::EnergyAt at(const optimize::EnergyGearbox& gearbox) const override;
  [[nodiscard]] optimize::EnergyAt of(const design::Design& design) const override;
  [[nodiscard]] double least(const optimize::EnergyBox& gearboxes) const override;
  [[nodiscard]] double scale_j() const override { return scale_J_; }

  /// The exact cycles of one motor with such a gearbox.
  [[nodiscard]] PairResult run(std::size_t motor, const optimize::EnergyGearbox& gearbox) const;
  /// The same with a design.
  [[nodiscard]] PairResult run(std::size_t motor,
                               const std::shared_ptr<const DesignTrain>& train) const;
  [[nodiscard]] const SelectionTask& task() const { return task_; }
  [[nodiscard]] const std::vector<std::string>& sources() const { return sources_; }
  /// Greatest magnitude, and root mean square over all cycles, of the mesh's torque [N m].
  [[nodiscard]] double peak_mesh_nm() const { return peak_mesh_Nm_; }
  [[nodiscard]] double rms_mesh_nm() const { return rms_mesh_Nm_; }

 private:
  static constexpr double kWithoutBound = std::numeric_limits<double>::infinity();
  /// Bounds are lowered by this share, for their rounding.
  static constexpr double kBoundRoom = 1e-9;
  enum Flow : std::size_t { kForwardFlow, kBackwardFlow };
  using Basis = std::array<double, 4>;
  struct FlowMoments {
    std::array<Basis, 4> square{};
  };
  /// A stretch with one sense and one flow, over x in [0, 1].
  struct Part {
    double seconds = 0.0;  ///< its length times its cycle's weight
    Quadratic mesh_Nm{}, speed_rad_s{}, acceleration_rad_s2{};
    double sense = 1.0;
    Flow flow = kForwardFlow;
  };
  struct Rest {
    double seconds = 0.0;
    Quadratic load_Nm{};
  };
  /// A motor as it acts at the output through a ratio.
  struct Fast {
    double rotor_kgm2;
    double j1_kgm2, d1_Nms, c1_Nm, c1_static_Nm;  ///< j1: with the gears
    double per_torque;                            ///< current over τ
    double back_emf;                              ///< volts over w
    double copper;                                ///< ρ
    double resistance_ohm;
  };
  /// Energy over h with its derivatives, and those over J1.
  struct Sum {
    double energy = 0.0, slope = 0.0, curvature = 0.0;
    double inertia_slope = 0.0, inertia_curvature = 0.0, mixed = 0.0;
  };
  /// Where the least energy of a flow lies, and a bound of it from below.
  struct Least {
    double h = 0.0, bound = 0.0;
    Sum sum;
  };
  /// Parts of a mean square or an energy: A + B h + C h².
  struct InH {
    double a = 0.0, b = 0.0, c = 0.0;
  };
  /// The least h forward and the most backward, or one value of each.
  struct Box {
    double forward = 1.0, backward = 1.0;
    bool exact = false;
    double inertia_kgm2 = 0.0;  ///< J1 has it
    double spread_kgm2 = 0.0;   ///< by which γ may differ from it
  };

  void add(const Cycle& cycle, double weight);
  void add_part(const CyclePiece& piece, std::array<double, 2> range, double sense, double weight);
  [[nodiscard]] Fast fast_of(std::size_t motor, double ratio, double inertia_kgm2) const;
  [[nodiscard]] static Basis point(const Part& part, double x);
  static void add_moments(const Part& part, FlowMoments& moments);
  void set_classes();
  [[nodiscard]] static InH square_in_h(const FlowMoments& moments, const Fast& fast);
  [[nodiscard]] static InH energy_in_h(const FlowMoments& moments, const Fast& fast);
  [[nodiscard]] Sum energy_over(Flow flow, const Fast& fast, double h) const;
  void add_moving(const Part& part, const Fast& fast, double h, Sum& sum) const;
  void add_resting(const Rest& rest, const Fast& fast, double h, Sum& sum) const;
  [[nodiscard]] Least least_over(Flow flow, const Fast& fast, double end) const;
  [[nodiscard]] double sharp_bound(const Fast& fast, const Box& box,
                                   const optimize::EnergyBox& gearboxes) const;
  [[nodiscard]] double square_acceleration() const;
  [[nodiscard]] double quick_bound(const Fast& fast, const Box& box) const;
  /// What is felt; of a box the least, as all of it falls with each efficiency:
  ///   J_L + J1/η_b,  c1s/η_b,  2 (r − 1)/(r + 1) with r = (τ + c1)/((τ − c1) η_f η_b)
  [[nodiscard]] Felt felt_of(const Fast& fast, const Box& box) const;
  [[nodiscard]] double excess(std::size_t motor, double ratio, const Fast& fast,
                              const Box& box) const;
  void bound_peaks(const Fast& fast, const Box& box, double& amperes, double& volts) const;
  void note_peaks(const Fast& fast, const Box& box, double& amperes, double& volts) const;

  SelectionTask task_;
  std::vector<std::string> sources_;
  std::vector<Part> parts_;
  std::vector<Rest> rests_;
  std::array<FlowMoments, 2> moments_{};
  /// Moments of parts alike, of a drive with losses: by flow, then by |w| over |m|.
  struct Class {
    Flow flow = kForwardFlow;
    FlowMoments moments;
  };
  std::vector<Class> classes_;
  double time_s_ = 0.0, peak_speed_rad_s_ = 0.0, peak_mesh_Nm_ = 0.0, rms_mesh_Nm_ = 0.0;
  double scale_J_ = 0.0;
  double acceleration_work_ = 0.0;  ///< ∫ |w a| dt at most [rad²/s²]
  bool lossless_drive_ = true;
};

/// The co-design of a specification's objective; null without.
const CoDesign* co_design_of(const optimize::CycleEnergy* energy);

}  // namespace gear3k::actuator
