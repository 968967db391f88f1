// `diagnose` on every measurement in the repository that was made on a real gearbox or pair: what
// it says, and how it predicts rows held out of the fit beside the best refit of one parameter.

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "app/diagnose.hpp"
#include "benchmarks/program.hpp"
#include "calibrate/fit/holdout.hpp"
#include "calibrate/fit/screen.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/search/search.hpp"
#include "io/files/measurement_file.hpp"
#include "io/files/subject_file.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program's own namespace
using calibrate::Diagnosis;

struct RealRecord {
  std::string subject{}, data{};  ///< from the root of the sources; subject "": `black_box`
  std::string black_box{};
};

const std::vector<RealRecord>& records() {
  static const std::vector<RealRecord> list{
      {.subject = "examples/pairs/dry_steel_pair.toml",
       .data = "data/spur_pair_loss_dry_steel.csv"},
      {.data = "data/printed_cpg_windup.csv",
       .black_box = "[gearbox]\nratio = 14.0\nefficiency_forward = 0.9\nefficiency_backward = 0.9\n"
                    "backlash_arcmin = 0.0\n"},
      {.subject = "examples/designs/low_backlash_prototype.toml",
       .data = "examples/measurements/published_low_backlash.csv"},
      {.subject = "examples/designs/bilateral_drive_gear.toml",
       .data = "examples/measurements/published_bilateral_drive_gear.csv"}};
  return list;
}

/// Root mean square of held-out rows under the best refit of one parameter [SI]; NaN: too few rows.
double refit_error(const calibrate::Problem& problem) {
  const std::vector<calibrate::Levels> levels = calibrate::covariate_levels(problem.data);
  const calibrate::Blocks blocks = calibrate::holdout_blocks(problem.data, levels);
  const Eigen::VectorXd measured = calibrate::measured(problem.data);
  const calibrate::Columns base = calibrate::columns_at(problem, {}, {}, 0.0);
  const double scale = calibrate::robust_deviation(base.residual);
  double least = calibrate::kUnknown;
  for (const calibrate::Candidate& c :
       calibrate::candidates_for(problem.simulation, problem.data)) {
    const bool refit = c.cause->id == "friction_level" || c.cause->id == "clearance" ||
                       c.cause->id == "sensor_gain";
    if (!refit || !(c.form.weight > 0.0) || blocks.count < 2) continue;
    const calibrate::Fit fit = calibrate::fit(problem, calibrate::with({}, c), scale);
    const Eigen::VectorXd predicted = calibrate::predict_held_out(problem, fit.hypothesis, blocks);
    if (!predicted.allFinite()) continue;
    const double error = calibrate::root_mean_square(measured - predicted);
    if (!(error >= least)) least = error;
  }
  return least;
}

std::string causes_of(const Diagnosis& d) {
  std::string text;
  for (const calibrate::Effect& e : d.effects) {
    const bool implausible =
        std::ranges::any_of(e.parameters, [](const auto& p) { return !p.plausible; });
    text += (text.empty() ? "" : ", ") + e.id + (implausible ? " (implausible)" : "");
    for (const auto& a : e.alternatives) text += " or " + a.id;
  }
  return text.empty() ? "-" : text;
}

std::string number(double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : "-"; }

}  // namespace

PROGRAM(real_data)(int, char**) {
  const std::string root = GEAR3K_SOURCE_DIR "/";
  fmt::print(
      "root mean square error in the response's unit: as given, extended, and held out of the "
      "fit:\n"
      "the extended model, and the best refit of one parameter (friction, clearance or gain)\n");
  for (const RealRecord& record : records()) {
    const calibrate::Subject subject =
        record.subject.empty()
            ? calibrate::Subject(io::parse_black_box(record.black_box, "black box"))
            : io::read_subject(root + record.subject);
    const app::DiagnosisTask task = app::diagnosis_task(
        {.subject = subject, .data = io::read_measurements({root + record.data})});
    const auto results = app::diagnose(task, {});
    const Diagnosis& d = results->front();
    const calibrate::Problem problem{.simulation = task.simulations.front(),
                                     .data = task.sets.front(),
                                     .noise = calibrate::make_noise_model(task.sets.front())};
    const double unit = calibrate::response_unit(d.kind).si;
    // As many parameters as rows leave rounding.
    constexpr double kRounding = 1e-9;
    const double left = d.errors.extended_train > kRounding * d.errors.baseline_train
                            ? d.errors.extended_train / unit
                            : 0.0;
    fmt::print(
        "\n{}: {} rows, {}\n  {}\n  as given {}, extended {} {}; held out by {}: {}, refit {}\n",
        record.data, d.rows.size(), calibrate::kVerdictNames[static_cast<std::size_t>(d.verdict)],
        causes_of(d), number(d.errors.baseline_train / unit), number(left),
        calibrate::response_unit(d.kind).name,
        d.holdout_blocks.empty() ? "nothing" : d.holdout_blocks,
        number(d.errors.extended_holdout / unit), number(refit_error(problem) / unit));
  }
  return 0;
}
