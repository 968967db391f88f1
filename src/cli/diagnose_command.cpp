#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/model_range.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "calibrate/verdict/model_update.hpp"
#include "cli/commands.hpp"
#include "cli/model_option.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/talk.hpp"
#include "io/files/measurement_file.hpp"
#include "io/files/measurement_loops.hpp"
#include "io/files/model_file.hpp"
#include "io/files/subject_file.hpp"
#include "io/text/diagnostics.hpp"
#include "report/condition_columns.hpp"
#include "report/diagnosis_plot.hpp"
#include "report/diagnosis_report.hpp"
#include "train/shaft_orders.hpp"

namespace gear3k::cli {

namespace {

using calibrate::Diagnosis, calibrate::ExtendedModel, calibrate::Kind, calibrate::MeasurementSet,
    calibrate::Simulation, calibrate::Subject;

/// Everything that was read, ready to be diagnosed.
struct Task {
  std::string subject;  ///< its name
  std::vector<ExtendedModel> models;
  Notes model_notes;  ///< what there is to say about their use
  std::vector<MeasurementSet> sets;
  std::vector<Simulation> simulations;      ///< of each set
  std::vector<train::ShaftOrder> orders{};  ///< of the shafts of a DESIGN
};

/// Errors of several files, told together.
class Errors {
 public:
  /// Runs a step; an error in it is kept.
  template <class Step>
  void collect(Step step) {
    try {
      step();
    } catch (const io::InvalidInput& error) {
      // What is wrong with a subject is so for every kind of data.
      if (text_.find(error.what()) != std::string::npos) return;
      if (!text_.empty()) text_ += '\n';
      text_ += error.what();
    }
  }
  void throw_if_any() const {
    if (!text_.empty()) throw io::InvalidInput(text_);
  }

 private:
  std::string text_;
};

std::string name_of(const Subject& subject) {
  return std::visit([](const auto& s) { return s.name; }, subject);
}

/// What of a model means something for a subject only.
void refuse_foreign_model(const Subject& subject, const std::vector<ExtendedModel>& models,
                          const DiagnoseOptions& options) {
  const bool black_box = std::holds_alternative<calibrate::BlackBox>(subject);
  std::vector<std::string> ids;
  if (black_box) {
    for (const ExtendedModel& model : models) {
      for (const calibrate::AppliedCause& cause : model.causes) {
        if (std::ranges::any_of(cause.form.constants, [](const auto& constant) {
              return constant.unit == "N" || constant.unit == "m/s";
            })) {
          ids.push_back(cause.id);
        }
      }
    }
  } else {
    ids = calibrate::black_box_causes(models);
  }
  if (ids.empty()) return;
  throw io::InvalidInput(fmt::format(
      "{}: {}: measured on {}, allowed for {}: a model that diagnose found with {}", options.model,
      fmt::join(ids, ", "), black_box ? "a DESIGN, by its tooth forces and sliding" : "a black box",
      options.file, black_box ? "a black box" : "a DESIGN"));
}

/// Why a subject cannot say what data of a kind measure; "" where it can.
std::string why_unanswerable(const Subject& subject, const MeasurementSet& set) {
  const std::string data =
      fmt::format("{} data ({})", calibrate::kKindNames[static_cast<std::size_t>(set.kind)],
                  fmt::join(set.files, ", "));
  if (std::holds_alternative<design::PairDesign>(subject)) {
    if (set.kind == Kind::kPairLoss) return "";
    return fmt::format(
        "a PAIR explains pair_loss data only: {}: allowed with a DESIGN or a black box", data);
  }
  if (const auto* box = std::get_if<calibrate::BlackBox>(&subject)) {
    if (set.kind == Kind::kPairLoss) {
      return fmt::format("a black box has no gears: {}: allowed with a PAIR or a DESIGN", data);
    }
    if (set.kind != Kind::kTransmission && std::isnan(box->backlash_rad)) {
      return fmt::format(
          "gearbox.backlash_arcmin is not stated and {} need it: allowed: a number of at least 0",
          data);
    }
    return "";
  }
  const auto undefined = design::why_undefined(std::get<design::Design>(subject));
  return undefined ? undefined->message : "";
}

Task read_task(const DiagnoseOptions& options) {
  Task task;
  Errors errors;
  Subject subject;
  io::Measurements data;
  errors.collect([&] { subject = io::read_subject(options.file); });
  errors.collect([&] { data = io::read_measurements(options.data); });
  if (!options.model.empty()) {
    errors.collect([&] { task.models = io::read_model(options.model); });
  }
  errors.throw_if_any();
  refuse_foreign_model(subject, task.models, options);
  task.subject = name_of(subject);
  for (MeasurementSet& set : data.sets) {
    errors.collect([&] {
      if (const std::string why = why_unanswerable(subject, set); !why.empty()) {
        throw io::InvalidInput(fmt::format("{}: {}", options.file, why));
      }
      task.simulations.emplace_back(subject, set.kind, task.models);
      if (set.kind == Kind::kTorqueAngle) return;
      io::check_physics(set, task.simulations.back().ratio());
    });
  }
  errors.throw_if_any();
  io::read_loops(data, task.simulations.front().ratio());
  if (std::ranges::find(data.sets, Kind::kTorqueAngle, &MeasurementSet::kind) == data.sets.end()) {
    // Its rows went to the set of lost motion.
    std::erase_if(task.simulations,
                  [](const Simulation& s) { return s.kind() == Kind::kTorqueAngle; });
  }
  task.sets = std::move(data.sets);
  if (!options.model.empty()) {
    note_model(task.subject, {.file = options.model, .models = task.models}, task.model_notes);
  }
  auto& notes = task.sets.front().notes;
  notes.insert(notes.end(), task.model_notes.begin(), task.model_notes.end());
  if (const auto* design = std::get_if<design::Design>(&subject)) {
    task.orders = train::shaft_orders(design->train.teeth);
  }
  return task;
}

/// A limit of the next experiment [SI]; an end that is not stated is a quarter beyond the data.
using Ends = std::array<double, 2>;
std::optional<Ends> limits_of(const ConditionLimit& limit,
                              const calibrate::ConditionQuantity& quantity,
                              const MeasurementSet& set) {
  if (!limit.least && !limit.greatest) return std::nullopt;
  const auto [low, high] = calibrate::range_of(set, quantity.member);
  constexpr double kBeyond = 0.25;
  // Of a temperature a quarter is one of its range.
  const bool shifted = quantity.shift != 0.0;
  const double room = shifted ? kBeyond * (high - low) : 0.0;
  const double least =
      limit.least ? quantity.si(*limit.least) : (shifted ? low - room : (1.0 - kBeyond) * low);
  const double greatest = limit.greatest ? quantity.si(*limit.greatest)
                                         : (shifted ? high + room : (1.0 + kBeyond) * high);
  if (!std::isfinite(least) || !std::isfinite(greatest)) return std::nullopt;
  // The end that is stated holds where the other one, of the data, is beyond it.
  if (least > greatest) return limit.least ? Ends{least, least} : Ends{greatest, greatest};
  return Ends{least, greatest};
}

/// The limits that act on none of the data, in words.
Notes idle_limits(const DiagnoseOptions& options, const std::vector<MeasurementSet>& sets) {
  struct Option {
    const char* column;
    ConditionLimit DiagnoseOptions::*limit;
  };
  constexpr std::array<Option, 4> kOptions{
      {{.column = "sun_speed_rpm", .limit = &DiagnoseOptions::sun_speed_rpm},
       {.column = "output_torque_nm", .limit = &DiagnoseOptions::output_torque_nm},
       {.column = "test_torque_nm", .limit = &DiagnoseOptions::test_torque_nm},
       {.column = "temperature_c", .limit = &DiagnoseOptions::temperature_c}}};
  Notes notes;
  for (const Option& option : kOptions) {
    const ConditionLimit& limit = options.*option.limit;
    if (!limit.least && !limit.greatest) continue;
    const bool acts = std::ranges::any_of(sets, [&](const MeasurementSet& set) {
      const auto stated = report::stated_columns(set);
      return std::ranges::find(stated, option.column, &report::ConditionColumn::name) !=
             stated.end();
    });
    if (acts) continue;
    std::string name = option.column;
    std::ranges::replace(name, '_', '-');
    std::vector<std::string> words;
    if (limit.least) words.push_back("--min-" + name);
    if (limit.greatest) words.push_back("--max-" + name);
    notes.push_back(fmt::format("{}: no effect, as the data state no {}", fmt::join(words, ", "),
                                option.column));
  }
  return notes;
}

/// What the diagnosis found out about its model, beside the values.
void add_findings(Diagnosis& d) {
  d.model.verdict = d.verdict;
  for (std::size_t k = 0; k < d.effects.size() && k < d.model.causes.size(); ++k) {
    calibrate::AppliedCause& cause = d.model.causes[k];
    for (const calibrate::Alternative& a : d.effects[k].alternatives) {
      if (std::ranges::find(cause.alternatives, a.id) == cause.alternatives.end()) {
        cause.alternatives.push_back(a.id);
      }
    }
    for (const calibrate::ParameterResult& p : d.effects[k].parameters) {
      if (!p.plausible) cause.implausible.push_back(p.name);
    }
  }
}

/// @returns empty when it was interrupted
std::optional<std::vector<Diagnosis>> diagnose_all(const Task& task,
                                                   const DiagnoseOptions& options) {
  optimize::Progress progress;
  constexpr std::size_t kSteps = 1000;
  progress.phase = optimize::Progress::Phase::kDiagnosis;
  progress.total = kSteps;
  const ProgressDisplay display(progress, options.quiet);
  // A partial diagnosis has no result and nothing is written before the end: an interrupt need not
  // wait for the next step, which takes minutes for 100 000 rows.
  end_on_interrupt();
  std::vector<Diagnosis> results;
  results.reserve(task.sets.size());
  for (std::size_t k = 0; k < task.sets.size(); ++k) {
    const MeasurementSet& set = task.sets[k];
    calibrate::DiagnoseOptions how;
    how.false_discovery_rate = options.false_discovery_rate;
    how.seed = options.seed;
    how.sun_speed_rad_s = limits_of(options.sun_speed_rpm, calibrate::kSunSpeed, set);
    how.output_torque_Nm = limits_of(options.output_torque_nm, calibrate::kOutputTorque, set);
    how.test_torque_Nm = limits_of(options.test_torque_nm, calibrate::kTestTorque, set);
    how.temperature_K = limits_of(options.temperature_c, calibrate::kTemperature, set);
    how.progress = [&](double share) {
      const double all = (static_cast<double>(k) + share) / static_cast<double>(task.sets.size());
      progress.done = static_cast<std::size_t>(all * static_cast<double>(kSteps));
      return !progress.stop.load();
    };
    std::optional<Diagnosis> result;
    try {
      result = calibrate::diagnose(task.simulations[k], set, how);
    } catch (const std::invalid_argument& error) {
      throw io::InvalidInput(fmt::format("{}: {}", fmt::join(set.files, ", "), error.what()));
    }
    if (!result) return std::nullopt;
    result->subject = task.subject;
    result->model.name = task.subject;
    add_findings(*result);
    results.push_back(std::move(*result));
  }
  if (progress.stop.load()) return std::nullopt;
  return results;
}

WrittenFiles write_diagnosis(const DiagnoseOptions& options, const Task& task,
                             const std::vector<Diagnosis>& results,
                             const report::DiagnosisSetup& setup) {
  std::vector<ExtendedModel> found;
  found.reserve(results.size());
  for (const Diagnosis& result : results) found.push_back(result.model);
  ResultFolder folder{.path = options.out,
                      .input = options.file,
                      .protected_inputs = options.data,
                      .figures = report::diagnosis_plot_names(),
                      .quiet = options.quiet};
  folder.protected_inputs.push_back(options.file);
  if (!options.model.empty()) folder.protected_inputs.push_back(options.model);
  return write_results(
      folder,
      {{.path = "diagnosis.json", .text = report::diagnosis_json(results, task.sets, setup)},
       {.path = "model.toml",
        .text = io::model_text(calibrate::updated_models(task.models, found))},
       {.path = "residuals.csv", .text = report::residual_csv(results, task.sets)}},
      report::diagnosis_plots(results, task.sets, task.orders));
}

}  // namespace

ExitCode run_diagnose(const DiagnoseOptions& options) {
  end_on_interrupt();
  use_threads(options);
  const Task task = read_task(options);
  warn(task.model_notes, options.quiet);
  if (!options.quiet) {
    for (const std::string& note : idle_limits(options, task.sets)) {
      say(fmt::format("{}\n", note));
    }
  }
  const std::optional<std::vector<Diagnosis>> results = diagnose_all(task, options);
  if (!results) {
    say("interrupted: a partial diagnosis has no result\n");
    return kInterrupted;
  }
  end_on_interrupt();
  WrittenFiles written;
  report::DiagnosisSetup setup{.seed = options.seed,
                               .false_discovery_rate = options.false_discovery_rate};
  if (!options.model.empty()) {
    setup.model = report::ModelUse{.file = options.model, .models = task.models};
  }
  if (!options.out.empty()) written = write_diagnosis(options, task, *results, setup);
  switch (options.format) {
    case Format::kJson:
      print_result(report::diagnosis_json(*results, task.sets, setup));
      break;
    case Format::kCsv:
      print_result(report::residual_csv(*results, task.sets));
      break;
    case Format::kTable:
      print_result(report::diagnosis_table(*results, task.sets, setup) + files_text(written));
      break;
  }
  return written.code;
}

}  // namespace gear3k::cli
