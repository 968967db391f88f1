#pragma once
// The diagnosis of logs of motion.

#include <string>
#include <vector>

#include "calibrate/dynamic/motion_diagnosis.hpp"
#include "calibrate/dynamic/motion_readings.hpp"

namespace gear3k::report {

struct MotionDiagnosisResult {
  std::string subject;  ///< name of the actuator
  double ratio = 1.0;   ///< i: quantities of the motor's side are told at its shaft
  std::vector<std::string> files;
  calibrate::MotionDiagnosis diagnosis;
  calibrate::MotionReadings readings{};
  std::string model{};  ///< an ACTUATOR file with what was found
};

std::string motion_diagnosis_json(const MotionDiagnosisResult& result);
std::string motion_diagnosis_table(const MotionDiagnosisResult& result);
/// A row for each window: its terms, and what the model as stated and extended leaves.
std::string motion_window_csv(const MotionDiagnosisResult& result);

}  // namespace gear3k::report
