#pragma once
// What the simulation of a gearbox gets wrong on measurements, and why.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/model.hpp"
#include "calibrate/model/simulation.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "io/files/measurement_file.hpp"
#include "train/shaft_orders.hpp"

namespace gear3k::app {

struct DiagnoseRequest {
  calibrate::Subject subject;
  std::string source = "subject";  ///< stands for the subject in messages
  io::Measurements data;
  /// Models under the simulation, and their file; without: the simulation alone.
  std::optional<report::ModelUse> model = std::nullopt;
};

/// A request that can be worked on.
struct DiagnosisTask {
  std::string subject;  ///< its name
  std::vector<calibrate::ExtendedModel> models;
  Notes model_notes;  ///< also among the notes of the first set
  std::vector<calibrate::MeasurementSet> sets;
  std::vector<calibrate::Simulation> simulations;  ///< of each set
  std::vector<train::ShaftOrder> orders;           ///< of the shafts of a DESIGN
  bool states_springs = false;                     ///< a DESIGN with [strength]
  std::optional<double> rated_torque_Nm{};         ///< at R2, of such a DESIGN
};

/// Simulations of what was measured; loops become rows of lost motion, and rows that give more
/// power than they take are left out.
/// @throws io::InvalidInput for data that the subject cannot explain, a model of another kind of
/// subject, and data that break the physics: all of them at once
DiagnosisTask diagnosis_task(const DiagnoseRequest& request);

/// A limit of the next experiment [SI]; an end that is not stated is a quarter beyond the data (of
/// their range for a temperature).
struct ExperimentLimit {
  std::optional<double> least{}, greatest{};
};

struct DiagnoseSettings {
  double false_discovery_rate = 0.05;
  std::uint64_t seed = 1;
  ExperimentLimit sun_speed_rad_s, output_torque_Nm, test_torque_Nm, temperature_K;
  /// Told now and then how far the work is, 0 to 1; returning false ends it.
  std::function<bool(double)> progress = {};
};

/// Diagnoses each set; the model of each result names its verdict, its alternatives and what is
/// implausible.
/// @returns empty when it was ended
/// @throws io::InvalidInput where no row can be simulated
std::optional<std::vector<calibrate::Diagnosis>> diagnose(const DiagnosisTask& task,
                                                          const DiagnoseSettings& settings);

}  // namespace gear3k::app
