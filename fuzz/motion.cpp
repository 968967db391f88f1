// `diagnose` of any log of motion of any ACTUATOR: the file, a line "---", and the log.

#include "app/diagnose_motion.hpp"
#include "entry.hpp"
#include "io/files/actuator_file.hpp"
#include "work.hpp"

using namespace gear3k;

namespace {

constexpr std::size_t kMostLogRows = 600;

void diagnose_log(const std::string& text) {
  const auto files = fuzz::both_files(text);
  if (fuzz::has_more_lines(files.second, kMostLogRows)) throw io::InvalidInput("too long a log");
  const app::DiagnoseMotionRequest request{
      .actuator = io::parse_actuator(files.first, fuzz::kNameAmongActuators),
      .source = fuzz::kName,
      .data = {}};
  const report::MotionDiagnosisResult result = app::diagnose_motion(
      request, io::parse_motion_log("fuzz.csv", files.second, app::log_scale(request.actuator)));
  static_cast<void>(report::motion_diagnosis_json(result));
  report::motion_diagnosis_table(result);
  report::motion_window_csv(result);
  // What is written can be read.
  io::parse_actuator(result.model, "model.toml");
}

}  // namespace

FUZZER(motion)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, diagnose_log);
}
