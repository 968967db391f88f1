#include "app/diagnose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "app/errors.hpp"
#include "calibrate/measurement/blank_conditions.hpp"
#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/measurement/impossible_rows.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/model_range.hpp"
#include "calibrate/series/series.hpp"
#include "io/files/measurement_loops.hpp"

namespace gear3k::app {

namespace {

using calibrate::Diagnosis, calibrate::ExtendedModel, calibrate::Kind, calibrate::MeasurementSet,
    calibrate::Simulation, calibrate::Subject;

std::string name_of(const Subject& subject) {
  return std::visit([](const auto& s) { return s.name; }, subject);
}

/// What of a model means something for a subject only.
void refuse_foreign_model(const Subject& subject, const std::vector<ExtendedModel>& models,
                          const DiagnoseRequest& request) {
  const bool black_box = std::holds_alternative<calibrate::BlackBox>(subject);
  const auto ids =
      black_box ? calibrate::inner_causes(models) : calibrate::black_box_causes(models);
  if (ids.empty()) return;
  throw io::InvalidInput(fmt::format(
      "{}: {}: measured on {}, allowed for {}: a model that diagnose found with {}",
      request.model->file, fmt::join(ids, ", "),
      black_box ? "a DESIGN, by what is inside (teeth, planets, centre distance or stated drags)"
                : "a black box",
      request.source, black_box ? "a black box" : "a DESIGN"));
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

/// A limit of the next experiment [SI]; an end that is not stated is a quarter beyond the data.
using Ends = std::array<double, 2>;
std::optional<Ends> ends_of(const ExperimentLimit& limit,
                            const calibrate::ConditionQuantity& quantity,
                            const MeasurementSet& set) {
  if (!limit.least && !limit.greatest) return std::nullopt;
  const auto [low, high] = calibrate::range_of(set, quantity.member);
  constexpr double kBeyond = 0.25;
  // Of a temperature a quarter is one of its range.
  const bool shifted = quantity.si(0.0) != 0.0;
  const double room = shifted ? kBeyond * (high - low) : 0.0;
  const double least = limit.least.value_or(shifted ? low - room : (1.0 - kBeyond) * low);
  const double greatest = limit.greatest.value_or(shifted ? high + room : (1.0 + kBeyond) * high);
  if (!std::isfinite(least) || !std::isfinite(greatest)) return std::nullopt;
  // The end that is stated holds where the other one, of the data, is beyond it.
  if (least > greatest) return limit.least ? Ends{least, least} : Ends{greatest, greatest};
  return Ends{least, greatest};
}

/// Whether a map spans the torques that it has where no file states others.
bool is_default_torque(const design::GridAxis& axis) {
  const design::GridAxis by_default = design::MapGrid{}.output_torque_Nm;
  return axis.from == by_default.from && axis.to == by_default.to;
}

/// Limits of a torque at R2.  Unless they are stated, the next experiment is not to break the
/// gearbox: it has no more than what the gearbox is to carry, or what the data have.
/// @param rated_Nm what the gearbox is to carry; empty: unknown, and a map that nobody stated does
///   not say so either: the experiment keeps to a quarter beyond the data
/// @param meant what the map spans of it, which the default reaches too; null: nothing
/// @param[in,out] held becomes true where that lowers the default
std::optional<Ends> torque_ends(std::optional<double> rated_Nm, ExperimentLimit limit,
                                const calibrate::ConditionQuantity& quantity,
                                const MeasurementSet& set, const design::GridAxis* meant,
                                bool& held) {
  const auto [low, high] = calibrate::range_of(set, quantity.member);
  const bool nobody_said = !rated_Nm && meant != nullptr && is_default_torque(*meant);
  if ((rated_Nm || nobody_said) && !limit.greatest && std::isfinite(high)) {
    const double most_Nm = nobody_said ? 1.25 * high : std::max(*rated_Nm, high);
    const double by_default_Nm = std::max(1.25 * high, meant == nullptr ? 0.0 : meant->to);
    if (most_Nm < by_default_Nm) {
      limit.greatest = most_Nm;
      if (!limit.least && meant != nullptr) limit.least = std::min(0.75 * low, meant->from);
      held = true;
    }
  }
  return ends_of(limit, quantity, set);
}

/// Says what the compliance of rows of lost motion counts from, where the DESIGN states springs.
void tell_springs(const DiagnosisTask& task, const MeasurementSet& set,
                  const Simulation& simulation, Diagnosis& d) {
  const bool angles = set.kind == Kind::kLostMotion || set.kind == Kind::kTorqueAngle;
  if (const auto* springs = simulation.springs()) {
    const double torque_Nm = calibrate::range_of(set, &calibrate::Condition::test_torque_Nm).high;
    if (!(torque_Nm > 0.0)) return;
    d.model.beyond_springs = true;
    d.springs_Nm_rad = torque_Nm / design::elastic_windup(*springs, torque_Nm);
    d.notes.push_back(fmt::format(
        "the simulation winds up by the springs of [strength], {:.4g} N m/rad at {:.4g} N m: "
        "compliance is what comes on top of it",
        *d.springs_Nm_rad, torque_Nm));
  } else if (angles && task.states_springs && calibrate::has_whole_windup(task.models)) {
    d.notes.emplace_back(
        "the model holds a compliance that was found without the springs of [strength]: it stays "
        "all of the wind-up");
  }
}

/// What the diagnosis found out about its model, beside the values.
void complete_model(Diagnosis& d) {
  d.model.verdict = d.verdict;
  for (const calibrate::Effect& effect : d.effects) {
    // The model of a series has the causes of the design, which may be others.
    const auto own = std::ranges::find_if(d.model.causes, [&](const auto& cause) {
      return cause.id == effect.id && cause.form.name == effect.form.name &&
             cause.form.body == effect.form.body && cause.form.order == effect.form.order;
    });
    if (own == d.model.causes.end()) continue;
    calibrate::AppliedCause& cause = *own;
    for (const calibrate::Alternative& a : effect.alternatives) {
      if (std::ranges::find(cause.alternatives, a.id) == cause.alternatives.end()) {
        cause.alternatives.push_back(a.id);
      }
    }
    for (const calibrate::ParameterResult& p : effect.parameters) {
      if (!p.plausible) cause.implausible.push_back(p.name);
    }
  }
}

}  // namespace

DiagnosisTask diagnosis_task(const DiagnoseRequest& request) {
  DiagnosisTask task;
  const Subject& subject = request.subject;
  io::Measurements data = request.data;
  if (data.sets.empty()) throw io::InvalidInput("no measurements, allowed: at least one row");
  if (request.model) {
    task.models = request.model->models;
    refuse_foreign_model(subject, task.models, request);
  }
  task.subject = name_of(subject);
  Errors errors;
  for (MeasurementSet& set : data.sets) {
    errors.collect([&] {
      if (const std::string why = why_unanswerable(subject, set); !why.empty()) {
        throw io::InvalidInput(fmt::format("{}: {}", request.source, why));
      }
      task.simulations.emplace_back(subject, set.kind, task.models);
      if (set.kind == Kind::kTorqueAngle) return;
      const double ratio = task.simulations.back().ratio();
      if (const auto refusal = calibrate::leave_out_impossible(set, ratio)) {
        throw io::InvalidInput(*refusal);
      }
    });
  }
  errors.throw_if_any();
  io::read_loops(data, task.simulations.front().ratio());
  if (std::ranges::find(data.sets, Kind::kTorqueAngle, &MeasurementSet::kind) == data.sets.end()) {
    // Its rows went to the set of lost motion.
    std::erase_if(task.simulations,
                  [](const Simulation& s) { return s.kind() == Kind::kTorqueAngle; });
  }
  for (MeasurementSet& set : data.sets) calibrate::settle_blank_conditions(set);
  for (const MeasurementSet& set : data.sets) {
    errors.collect([&] {
      const std::vector<std::string> few = calibrate::units_of_few_rows(set);
      if (!few.empty()) throw io::InvalidInput(fmt::format("{}", fmt::join(few, "\n")));
    });
  }
  errors.throw_if_any();
  task.sets = std::move(data.sets);
  if (request.model) {
    note_model(task.subject, *request.model, task.model_notes);
    const auto* design = std::get_if<design::Design>(&subject);
    note_springs(*request.model, design != nullptr && design->rating, task.model_notes);
    for (const MeasurementSet& set : task.sets) {
      for (std::string& note : calibrate::outside_range(task.models, set)) {
        task.model_notes.push_back(std::move(note));
      }
    }
  }
  auto& notes = task.sets.front().notes;
  notes.insert(notes.end(), task.model_notes.begin(), task.model_notes.end());
  if (const auto* design = std::get_if<design::Design>(&subject)) {
    task.orders = train::shaft_orders(design->train.teeth);
    task.states_springs = design->rating.has_value();
    if (design->rating) task.rated_torque_Nm = design->rating->torque_Nm;
  }
  return task;
}

std::optional<std::vector<Diagnosis>> diagnose(const DiagnosisTask& task,
                                               const DiagnoseSettings& settings) {
  std::vector<Diagnosis> results;
  results.reserve(task.sets.size());
  for (std::size_t k = 0; k < task.sets.size(); ++k) {
    const MeasurementSet& set = task.sets[k];
    calibrate::DiagnoseOptions how;
    how.false_discovery_rate = settings.false_discovery_rate;
    how.seed = settings.seed;
    how.sun_speed_rad_s = ends_of(settings.sun_speed_rad_s, calibrate::kSunSpeed, set);
    bool held = false;
    const design::MapGrid* grid = task.simulations[k].grid();
    how.output_torque_Nm =
        torque_ends(task.rated_torque_Nm, settings.output_torque_Nm, calibrate::kOutputTorque, set,
                    grid == nullptr ? nullptr : &grid->output_torque_Nm, held);
    how.test_torque_Nm = torque_ends(task.rated_torque_Nm, settings.test_torque_Nm,
                                     calibrate::kTestTorque, set, nullptr, held);
    how.temperature_K = ends_of(settings.temperature_K, calibrate::kTemperature, set);
    how.progress = [&](double share) {
      const double all = (static_cast<double>(k) + share) / static_cast<double>(task.sets.size());
      return !settings.progress || settings.progress(all);
    };
    std::optional<Diagnosis> result;
    try {
      result = set.units.empty() ? calibrate::diagnose(task.simulations[k], set, how)
                                 : calibrate::diagnose_series(task.simulations[k], set, how);
    } catch (const std::invalid_argument& error) {
      throw io::InvalidInput(fmt::format("{}: {}", fmt::join(set.files, ", "), error.what()));
    }
    if (!result) return std::nullopt;
    result->subject = task.subject;
    result->model.name = task.subject;
    if (held && result->next_experiment) {
      result->notes.push_back(
          task.rated_torque_Nm
              ? fmt::format(
                    "the next experiment keeps to the {:.4g} N m of [strength], or what the data "
                    "have: --max-output-torque-nm and --max-test-torque-nm allow more",
                    *task.rated_torque_Nm)
              : std::string("the next experiment keeps to a quarter beyond the torques of the "
                            "data, as neither [strength] nor [map] says what the gearbox carries: "
                            "--max-output-torque-nm allows more"));
    }
    tell_springs(task, set, task.simulations[k], *result);
    complete_model(*result);
    results.push_back(std::move(*result));
  }
  return results;
}

}  // namespace gear3k::app
