#pragma once
// The published 96.2:1 gearboxes: what the paper says, what its own equations give, what was
// measured; and the ledger of the paper's errata, computed.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "design/evaluation.hpp"
#include "optimize/specification.hpp"

namespace gear3k::report {

/// A published gearbox: its design (full teeth, no friction value of its own) and its figures.
struct PublishedGearbox {
  design::Design design;
  std::optional<double> stated_ratio;
  std::optional<double> stated_lost_motion_rad;  ///< the authors' simulation
  std::optional<double> measured_lost_motion_rad;
  std::optional<std::array<double, train::kMeshCount>> stated_contact_ratio;
  std::optional<double> measured_forward, measured_backward;  ///< efficiencies
};

struct PublishedSources {
  PublishedGearbox low_backlash, bilateral;
  double max_backdriving_torque_Nm = 0.0;  ///< low-backlash gear, measured
  double backdrive_starting_torque_Nm = 0.0;
  double strain_wave_starting_torque_Nm = 0.0;  ///< of the paper's comparison
  /// The paper's optimisation task (RP-96), for what its tooth counts could reach.
  optimize::Specification task;
};

/// One compared quantity; empty = the source does not say.
struct ComparedRow {
  std::string quantity, unit;
  std::optional<double> paper, equations, measured;
  int decimals = 4;
};

struct FrictionFit {
  std::string model;
  double mu = 0.0;           ///< that reproduces the measured forward efficiency
  double backward = 0.0;     ///< η_b predicted with it
  double backward_mu = 0.0;  ///< that reproduces the measured backward efficiency
  double measured_forward = 0.0, measured_backward = 0.0;
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
};

/// One erratum: place, what is printed, what the equations or the arithmetic give.
struct LedgerEntry {
  int number;
  std::string where, paper, computed;
};

struct Reproduction {
  std::vector<GearboxComparison> gearboxes;
  std::vector<LedgerEntry> ledger;
};

Reproduction reproduce(const PublishedSources& sources);

std::string reproduce_table(const Reproduction& r);
std::string reproduce_json(const Reproduction& r);
std::string reproduce_csv(const Reproduction& r);

}  // namespace gear3k::report
