#pragma once
// The diagnosis of logs of motion.

#include <string>
#include <vector>

#include "calibrate/dynamic/motion_diagnosis.hpp"
#include "calibrate/dynamic/motion_readings.hpp"
#include "io/text/json.hpp"
#include "report/plot.hpp"

namespace gear3k::report {

struct MotionDiagnosisResult {
  std::string subject;  ///< name of the actuator
  double ratio = 1.0;   ///< i: quantities of the motor's side are told at its shaft
  std::vector<std::string> files;
  calibrate::MotionDiagnosis diagnosis;
  calibrate::MotionReadings readings{};
  std::string model{};  ///< an ACTUATOR file with what was found
};

io::Json motion_diagnosis_json(const MotionDiagnosisResult& result);
std::string motion_diagnosis_table(const MotionDiagnosisResult& result);
/// A row for each window: its terms, and what the model as stated and extended leaves.
std::string motion_window_csv(const MotionDiagnosisResult& result);
/// measured_vs_simulated: mean motor torques of the windows against those of the model, as stated
/// and with the causes;
/// residuals: what either leaves, along what the first cause acts on: the speed for a drag, the
/// acceleration for an inertia, else the load's torque (where none is logged, the acceleration).
std::vector<Plot> motion_diagnosis_plots(const MotionDiagnosisResult& result);
/// Names of all of them.
std::vector<std::string> motion_diagnosis_plot_names();

}  // namespace gear3k::report
