#pragma once
// What logs of motion say about an actuator.

#include <string>
#include <vector>

#include "actuator/actuator.hpp"
#include "calibrate/dynamic/motion_record.hpp"
#include "io/files/motion_log_file.hpp"
#include "report/motion_diagnosis_report.hpp"

namespace gear3k::app {

struct DiagnoseMotionRequest {
  actuator::Actuator actuator;
  std::string source;  ///< of the actuator, for messages
  std::vector<std::string> data;
  double false_discovery_rate = 0.05;
};

/// Reads and diagnoses logs of kind `dynamic`.
/// @throws io::InvalidInput for logs that cannot be read, an actuator with a designed train, logs
/// with too few windows of a clear sense and flow, and signals of the wrong sign
report::MotionDiagnosisResult diagnose_motion(const DiagnoseMotionRequest& request);

/// What turns logs of this actuator into torques at the output.
io::MotionLogScale log_scale(const actuator::Actuator& actuator);
/// The same with logs that were read, by log_scale(); `data` of the request is not read.
report::MotionDiagnosisResult diagnose_motion(const DiagnoseMotionRequest& request,
                                              const calibrate::MotionRecord& record);

}  // namespace gear3k::app
