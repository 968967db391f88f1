#pragma once
// The published 96.2:1 gearboxes: what the paper says, what its own equations give, what was
// measured; and the ledger of the paper's errata, computed.  With them the directional-impedance
// thesis, see thesis_comparison.hpp, and the backdrivability-factors paper, see
// backdrivability.hpp.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "design/evaluation.hpp"
#include "optimize/specification.hpp"
#include "papers/backdrivability.hpp"
#include "papers/compared_row.hpp"
#include "papers/directional_bench.hpp"
#include "papers/ledger.hpp"
#include "papers/thesis_comparison.hpp"

namespace gear3k::papers {

/// A number as printed, and where.
struct Stated {
  double value = 0.0;
  std::string source;
};
inline std::optional<double> value_of(const std::optional<Stated>& stated) {
  return stated ? std::optional(stated->value) : std::nullopt;
}

/// A published gearbox: its design (full teeth, no friction value of its own) and its figures.
struct PublishedGearbox {
  design::Design design;
  std::optional<Stated> stated_ratio;
  std::optional<Stated> stated_lost_motion_rad;  ///< the authors' simulation
  std::optional<double> measured_lost_motion_rad;
  std::optional<double> lost_motion_bracket_rad;  ///< printed in brackets after the measured one
  std::optional<Stated> stated_lost_motion_accuracy;  ///< of the authors' model against it
  std::optional<Stated> stated_backward;              ///< efficiency of the authors' simulation
  std::array<std::optional<Stated>, train::kMeshCount> stated_contact_ratio;
  std::optional<double> measured_forward, measured_backward;  ///< efficiencies
  std::optional<double> outer_diameter_m;
};

/// Figures that the paper's text states.
struct PaperStatements {
  double bilateral_xP2_printed = 0.0;
  double starting_torque_ratio = 0.0;
  double eq10_factor = 0.0;
  // Of the simulation behind Figs. 6 to 8.
  double figure_outer_diameter_m = 0.0;
  double lost_motion_before_rad = 0.0;  ///< without profile shift
  double lost_motion_after_rad = 0.0;   ///< with it
  double efficiency_after = 0.0;        ///< backward, there
};

struct PublishedSources {
  PublishedGearbox low_backlash, bilateral;
  PaperStatements statements;
  double max_backdriving_torque_Nm = 0.0;  ///< low-backlash gear, measured
  double backdrive_starting_torque_Nm = 0.0;
  double strain_wave_starting_torque_Nm = 0.0;  ///< of the paper's comparison
  /// The paper's optimisation task (RP-96), for what its tooth counts could reach.
  optimize::Specification task;
  optimize::Specification figure_task;  ///< of the paper's figures, see paper_figures.hpp
  ThesisSources thesis;
  DirectionalBenchSources directional_bench;
  BackdrivabilitySources backdrivability;
};

struct FrictionFit {
  std::string model;
  double measured_forward = 0.0, measured_backward = 0.0;
  /// Friction that reproduces the measured forward (backward) efficiency; empty when none does.
  std::optional<double> mu, backward_mu;
  std::optional<double> backward;  ///< η_b predicted with `mu`
};

/// Loss model `directional` fitted to both measured efficiencies.
struct DirectionalFit {
  double mu = 0.0;
  double approach_factor = 1.0, recess_factor = 1.0;  ///< 1 + a and 1 - a
};

struct EfficiencyPoint {
  double mu;
  double ohlendorf_forward, ohlendorf_backward, sliding_forward, sliding_backward;
};

struct GearboxComparison {
  std::string name;
  std::vector<ComparedRow> rows;
  std::vector<EfficiencyPoint> efficiency;
  std::vector<FrictionFit> fits;
  /// Different friction in approach and recess that explains both directions; empty when none does.
  std::optional<DirectionalFit> directional;
  /// Backward efficiency predicted with all friction in recess, mu fitted to the forward one.
  std::optional<double> recess_only_backward;
};

struct Reproduction {
  std::vector<GearboxComparison> gearboxes;
  std::vector<LedgerEntry> ledger;
  ThesisComparison thesis;  ///< its ledger goes on with that of the bench
  DirectionalBench directional_bench;
  BackdrivabilityComparison backdrivability;
};

/// Evaluates everything.
/// @throws std::invalid_argument when a published gearbox has no defined geometry
Reproduction reproduce(const PublishedSources& sources);

}  // namespace gear3k::papers
