// `diagnose` of few rows: a DESIGN, PAIR or black box, a line "---", and a measurement file.

#include "app/diagnose.hpp"

#include "entry.hpp"
#include "io/files/design_file.hpp"
#include "io/files/document_kind.hpp"
#include "io/files/measurement_file.hpp"
#include "io/files/model_file.hpp"
#include "io/files/subject_file.hpp"
#include "io/text/toml_value.hpp"
#include "report/diagnosis_plot.hpp"
#include "report/diagnosis_report.hpp"
#include "work.hpp"

using namespace gear3k;

namespace {

// A loop has eight samples of each flank between reversal and zero torque, and all of them are one
// row of the diagnosis.
constexpr std::size_t kMostRows = 24, kMostSamples = 100;

std::size_t most_lines(const std::string& data) {
  return data.find("torque_angle") == std::string::npos ? kMostRows : kMostSamples;
}

calibrate::Subject subject_of(const std::string& text) {
  switch (io::look_of(io::parse_toml(text, fuzz::kName)).kind) {
    case io::DocumentKind::kPair:
      return io::parse_pair(text, fuzz::kName);
    case io::DocumentKind::kBlackBox:
      return io::parse_black_box(text, fuzz::kName);
    default:
      return io::parse_design(text, fuzz::kName);
  }
}

void diagnose(const std::string& text) {
  const auto files = fuzz::both_files(text);
  if (fuzz::has_more_lines(files.second, most_lines(files.second))) {
    throw io::InvalidInput("too many rows");
  }
  const app::DiagnosisTask task = app::diagnosis_task(
      {.subject = subject_of(files.first),
       .source = fuzz::kName,
       .data = io::parse_measurements({{.path = "fuzz.csv", .text = files.second}})});
  const auto results = app::diagnose(task, {});
  fuzz::write(report::diagnosis_json(*results, task.sets, {}));
  report::diagnosis_table(*results, task.sets, {});
  report::residual_csv(*results, task.sets);
  report::diagnosis_plots(*results, task.sets, task.orders);
  std::vector<calibrate::ExtendedModel> models;
  for (const calibrate::Diagnosis& d : *results) models.push_back(d.model);
  io::parse_model(io::model_text(models), "model.toml");
}

}  // namespace

FUZZER(diagnose)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, diagnose);
}
