#include "tests/app/wide_scoring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "app/diagnose.hpp"
#include "calibrate/fit/fit.hpp"
#include "calibrate/search/search.hpp"
#include "io/files/design_file.hpp"
#include "io/files/document_kind.hpp"
#include "io/files/measurement_file.hpp"
#include "io/files/subject_file.hpp"
#include "io/text/toml_value.hpp"

namespace gear3k::wide_rig {

calibrate::Subject subject_of(const std::string& text) {
  switch (io::look_of(io::parse_toml(text, "subject.toml")).kind) {
    case io::DocumentKind::kPair:
      return io::parse_pair(text, "subject.toml");
    case io::DocumentKind::kBlackBox:
      return io::parse_black_box(text, "subject.toml");
    default:
      return io::parse_design(text, "subject.toml");
  }
}

app::DiagnosisTask task_of(const calibrate::Subject& subject, const std::vector<File>& files) {
  std::vector<io::FileText> texts;
  texts.reserve(files.size());
  for (const File& file : files) texts.push_back({.path = file.name, .text = file.text});
  return app::diagnosis_task({.subject = subject, .data = io::parse_measurements(texts)});
}

namespace {

using calibrate::Diagnosis, calibrate::Effect;

bool lists(const Effect& effect, const std::string& id) {
  return effect.id == id ||
         std::ranges::any_of(effect.alternatives, [&](const auto& a) { return a.id == id; });
}

bool holds(const std::vector<std::string>& list, const std::string& id) {
  return std::ranges::find(list, id) != list.end();
}

/// Whether the truths from one on each have an effect of their own among those that are left.
bool each_has_one(const Campaign& campaign, const std::vector<Effect>& effects, std::size_t truth,
                  std::vector<bool>& taken) {
  if (truth == campaign.truths.size()) return true;
  const Truth& t = campaign.truths[truth];
  for (std::size_t e = 0; e < effects.size(); ++e) {
    if (taken[e] || !(lists(effects[e], t.cause) || holds(t.acceptable, effects[e].id))) continue;
    taken[e] = true;
    if (each_has_one(campaign, effects, truth + 1, taken)) return true;
    taken[e] = false;
  }
  return false;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Rows that the diagnosis has not seen, and what they would read without noise.
struct Further {
  calibrate::MeasurementSet data;
  const std::vector<double>& clean;
};

/// With the sessions numbered as in the data of the diagnosis; those of no label there are -1.
Further further(const calibrate::Subject& subject, const std::vector<File>& files,
                const std::vector<double>& clean, const calibrate::MeasurementSet& seen) {
  Further result{.data = task_of(subject, files).sets.front(), .clean = clean};
  for (calibrate::Observation& row : result.data.rows) {
    int& run = row.condition.run;
    if (run < 0) continue;
    const auto at = std::ranges::find(seen.runs, result.data.runs[static_cast<std::size_t>(run)]);
    run = at == seen.runs.end() ? -1 : static_cast<int>(at - seen.runs.begin());
  }
  result.data.runs = seen.runs;
  return result;
}

/// Root mean square of predicted − clean.
double error_of(const calibrate::Subject& subject, const Further& further,
                const calibrate::ExtendedModel* model, const calibrate::Hypothesis& hypothesis) {
  const calibrate::MeasurementSet& data = further.data;
  if (data.rows.size() != further.clean.size()) return kNone;
  std::vector<calibrate::ExtendedModel> models;
  if (model != nullptr) models.push_back(*model);
  const calibrate::Simulation simulation(subject, data.kind, models);
  const calibrate::Problem problem{
      .simulation = simulation, .data = data, .noise = calibrate::make_noise_model(data)};
  const calibrate::Linearisation at = calibrate::linearise(problem, hypothesis, {});
  if (!at.runs) return kNone;
  const double unit =
      data.kind == calibrate::Kind::kLostMotion || data.kind == calibrate::Kind::kTorqueAngle
          ? 1.0 / units::kArcmin
          : 1.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < further.clean.size(); ++i) {
    const double e = at.simulated[static_cast<Eigen::Index>(i)] * unit - further.clean[i];
    sum += e * e;
  }
  return std::sqrt(sum / static_cast<double>(further.clean.size()));
}

/// What a diagnosis found, with drift and sessions where its data had them.
calibrate::Hypothesis found_in(const Diagnosis& d) {
  calibrate::Hypothesis h;
  for (const calibrate::AppliedCause& c : d.model.causes) {
    const calibrate::Cause* cause = calibrate::find_cause(c.id);
    h.effects.push_back(
        {.cause = cause, .form = c.form, .parameters = cause->parameters(c.form, d.kind)});
    h.value.insert(h.value.end(), c.value.begin(), c.value.end());
  }
  return h;
}

void score_unseen(const calibrate::Subject& subject, const Campaign& campaign,
                  const app::DiagnosisTask& task, const Diagnosis& d, Score& score) {
  const calibrate::MeasurementSet& data = task.sets.front();
  const Further unseen = further(subject, campaign.unseen, campaign.unseen_clean, data);
  const bool dated = data.kind != calibrate::Kind::kTorqueAngle;
  // A law is no hypothesis of the library's: it acts by the model.
  score.unseen = dated && d.model.laws.empty() ? error_of(subject, unseen, nullptr, found_in(d))
                                               : error_of(subject, unseen, &d.model, {});
  std::optional<Further> later;
  if (!campaign.later.empty()) {
    later.emplace(further(subject, campaign.later, campaign.later_clean, data));
    score.later = error_of(subject, *later, &d.model, {});
  }
  const calibrate::Problem problem{.simulation = task.simulations.front(),
                                   .data = data,
                                   .noise = calibrate::make_noise_model(data)};
  const calibrate::Columns base = calibrate::columns_at(problem, {}, {}, 0.0);
  const double scale = calibrate::robust_deviation(base.residual);
  double least = std::numeric_limits<double>::infinity();
  for (const calibrate::Candidate& c : calibrate::candidates_for(problem.simulation, data)) {
    const bool refits = c.cause->id == "friction_level" || c.cause->id == "clearance" ||
                        c.cause->id == "sensor_gain";
    if (!refits || !(c.form.weight > 0.0)) continue;
    const calibrate::Fit fit = calibrate::fit(problem, calibrate::with({}, c), scale);
    if (!(fit.sum_of_squares < least)) continue;
    least = fit.sum_of_squares;
    score.unseen_refit = error_of(subject, unseen, nullptr, fit.hypothesis);
    if (later) score.later_refit = error_of(subject, *later, nullptr, fit.hypothesis);
  }
}

/// Which of the orders that describe a wave as well are named or listed.
void score_orders(const Campaign& campaign, const Diagnosis& d, Score& score) {
  if (campaign.truths.size() != 1 || campaign.orders.empty()) return;
  const auto listed = [&](const std::string& cause, double order) {
    constexpr double kSame = 1e-3;
    const auto is = [&](const std::string& id, const calibrate::Form& form) {
      return id == cause && std::abs(form.order - order) < kSame * order;
    };
    const auto any = [&](const std::vector<calibrate::Alternative>& list) {
      return std::ranges::any_of(list, [&](const auto& a) { return is(a.id, a.form); });
    };
    return std::ranges::any_of(d.effects, [&](const Effect& e) {
      return is(e.id, e.form) || any(e.alternatives) || any(e.other_bodies);
    });
  };
  // The orders of a body relative to the carrier and absolute are one answer.
  const Truth& truth = campaign.truths.front();
  const auto own = std::ranges::find(truth.parameters, "order", &TruthParameter::name);
  std::map<std::pair<std::string, std::string>, bool> bodies;
  for (const PossibleOrder& o : campaign.orders) {
    bool& any = bodies[{o.cause, o.body}];
    any = any || listed(o.cause, o.order);
  }
  for (const PossibleOrder& o : campaign.orders) {
    const bool true_one =
        own != truth.parameters.end() && o.cause == truth.cause && o.order == own->value;
    score.own_order_listed = score.own_order_listed || (true_one && bodies[{o.cause, o.body}]);
  }
  score.orders = static_cast<int>(bodies.size());
  for (const auto& [body, any] : bodies) score.orders_listed += any ? 1 : 0;
}

/// Every effect's name with its alternatives.
std::vector<std::vector<std::string>> explanations_of(const Diagnosis& d) {
  std::vector<std::vector<std::string>> result;
  for (const Effect& e : d.effects) {
    std::vector<std::string> ids{e.id};
    for (const auto& a : e.alternatives) ids.push_back(a.id);
    result.push_back(std::move(ids));
  }
  return result;
}

std::string answer_of(const Diagnosis& d) {
  std::string text;
  for (const Effect& e : d.effects) {
    text += (text.empty() ? "" : " + ") + e.id + ":" + e.form.name;
    std::string others;
    for (const auto& a : e.alternatives) others += (others.empty() ? "" : " ") + a.id;
    if (!others.empty()) text += "(" + others + ")";
    for (const auto& p : e.parameters) {
      if (!p.plausible) text += " <" + p.name + " " + std::to_string(p.value) + ">";
    }
  }
  if (text.empty())
    text = std::string(calibrate::kVerdictNames[static_cast<std::size_t>(d.verdict)]);
  if (d.remainder.significant) text += " + remainder along " + d.remainder.along;
  return text;
}

/// A value of the truth as a parameter of the library.
struct Comparable {
  std::string name;
  double value = kNone;
};
std::optional<Comparable> comparable(const calibrate::Subject& subject, const Truth& truth,
                                     const TruthParameter& p, const Effect& effect) {
  const std::string& id = truth.cause;
  if (id == "friction_level") {
    const auto* design = std::get_if<design::Design>(&subject);
    const auto* pair = std::get_if<design::PairDesign>(&subject);
    if (design == nullptr && pair == nullptr) return std::nullopt;
    const double stated =
        design != nullptr ? design->friction.coefficient : pair->friction.coefficient;
    return Comparable{.name = "relative_change", .value = p.value / stated - 1.0};
  }
  if (id.starts_with("drag")) {
    const bool output = truth.acts_on == "drag on R2";
    if (!(output || truth.acts_on == "drag on sun")) return std::nullopt;
    // Drags that the data do not tell apart say so.
    if (effect.form.body != (output ? "output" : "sun") || !effect.other_bodies.empty()) {
      return std::nullopt;
    }
    return Comparable{.name = p.name, .value = p.value};
  }
  if (id == "sensor_gain") return Comparable{.name = "gain_error", .value = p.value - 1.0};
  if (id == "clearance" && truth.law != "seated") {
    return Comparable{.name = "extra_lost_motion", .value = p.value};
  }
  // Travel between both senses of the test torque is twice the wind-up.
  if (id == "compliance") return Comparable{.name = "compliance", .value = 0.5 * p.value};
  if (id == "thermal_expansion") return Comparable{.name = "expansion", .value = 1e6 * p.value};
  if (p.name == "order") return std::nullopt;  // stated without an interval
  return Comparable{.name = p.name, .value = p.value};
}

/// Intervals of an effect against its truth.  Where another cause explains the data as well, or
/// stands beside it as part of the truth, the value is another question.
void count_intervals(const calibrate::Subject& subject, const Truth& truth, const Effect& effect,
                     Score& score) {
  for (const TruthParameter& p : truth.parameters) {
    const auto expected = comparable(subject, truth, p, effect);
    if (!expected) continue;
    const auto found =
        std::ranges::find(effect.parameters, expected->name, &calibrate::ParameterResult::name);
    if (found == effect.parameters.end()) continue;
    ++score.intervals;
    score.inside += found->low <= expected->value && expected->value <= found->high ? 1 : 0;
    if (!(found->low <= expected->value && expected->value <= found->high)) {
      score.answer += " {" + p.name + " " + std::to_string(expected->value) + " not in " +
                      std::to_string(found->low) + " " + std::to_string(found->high) + "}";
    }
  }
}

/// A name that may stand beside the truths is neither true nor false.
void count_claims(const Campaign& campaign, const Diagnosis& d, Score& score) {
  const auto true_cause = [&](const std::string& id) {
    return std::ranges::any_of(campaign.truths, [&](const Truth& t) { return t.cause == id; });
  };
  for (const Effect& e : d.effects) {
    const bool offers_truth =
        std::ranges::any_of(e.alternatives, [&](const auto& a) { return true_cause(a.id); });
    if (!true_cause(e.id) && !offers_truth && holds(campaign.companions, e.id)) continue;
    bool any = true_cause(e.id);
    score.claims.push_back({e.probability, any});
    for (const auto& a : e.alternatives) {
      const bool here = !true_cause(e.id) && true_cause(a.id);
      score.claims.push_back({a.probability, here});
      any = any || here;
    }
    score.claims.push_back({e.no_cause, !any});
  }
}

}  // namespace

bool Score::all_right() const {
  return right && verdict_fits && disclosed && !lists_excluded && !(gain <= 0.0);
}

Score score(const Campaign& campaign) {
  const calibrate::Subject subject = subject_of(campaign.subject_toml);
  const app::DiagnosisTask task = task_of(subject, campaign.files);
  const auto results = app::diagnose(task, {});
  const Diagnosis& d = results->front();
  Score score;
  score.strength = campaign.strength;
  score.noise = campaign.noise_sd;
  score.answer = answer_of(d);
  score.verdict = calibrate::kVerdictNames[static_cast<std::size_t>(d.verdict)];
  score.explanations = explanations_of(d);
  score.gain = std::isfinite(d.errors.weighted_gain)
                   ? d.errors.weighted_gain
                   : 1.0 - d.errors.extended_holdout / d.errors.baseline_holdout;
  // Nothing found: both models are the same.
  if (d.effects.empty()) score.gain = kNone;

  std::vector<bool> taken(d.effects.size(), false);
  const bool unknown =
      std::ranges::any_of(campaign.truths, [](const Truth& t) { return t.cause == "unknown"; });
  const bool all_named = each_has_one(campaign, d.effects, 0, taken);
  for (std::size_t e = 0; e < d.effects.size(); ++e) {
    const Effect& effect = d.effects[e];
    const bool allowed =
        taken[e] || std::ranges::any_of(campaign.companions,
                                        [&](const std::string& c) { return lists(effect, c); });
    score.wrong_name = score.wrong_name || !allowed;
    for (const std::string& id : campaign.excluded) {
      const bool ruled_out = lists(effect, id) && !holds(campaign.companions, id) &&
                             std::ranges::none_of(campaign.truths, [&](const Truth& t) {
                               return t.cause == id || holds(t.acceptable, id);
                             });
      if (!ruled_out) continue;
      score.lists_excluded = true;
      score.answer += " [" + id + " is ruled out]";
    }
  }
  if (unknown) {
    score.right = d.remainder.significant;
    score.disclosed = true;
    score.verdict_fits = d.verdict == calibrate::Verdict::kUnexplained;
  } else {
    score.verdict_fits = campaign.truths.empty() ? d.verdict == calibrate::Verdict::kNoDiscrepancy
                                                 : d.verdict == calibrate::Verdict::kExplained ||
                                                       d.verdict == calibrate::Verdict::kAmbiguous;
    score.false_remainder = d.remainder.significant && all_named && !score.wrong_name;
    score.right = all_named && !score.wrong_name && !d.remainder.significant;
    score.disclosed = std::ranges::all_of(campaign.truths, [&](const Truth& t) {
      return std::ranges::any_of(d.effects, [&](const Effect& e) { return lists(e, t.cause); });
    });
  }
  for (const Truth& t : campaign.truths) {
    for (const Effect& e : d.effects) {
      if (e.id == t.cause) count_intervals(subject, t, e, score);
    }
  }
  count_claims(campaign, d, score);
  score_orders(campaign, d, score);
  score_unseen(subject, campaign, task, d, score);
  return score;
}

LeftOut leave_out(const Campaign& campaign, const Score& whole, std::size_t part) {
  const calibrate::Subject subject = subject_of(campaign.subject_toml);
  app::DiagnosisTask task = task_of(subject, campaign.files);
  calibrate::MeasurementSet& data = task.sets.front();
  const std::size_t n = data.rows.size();
  const bool one_step = std::ranges::any_of(
      campaign.truths, [](const Truth& t) { return t.law.ends_with("one_step"); });
  const std::size_t sessions = one_step ? 0 : data.runs.size();
  constexpr std::size_t kParts = 10;
  std::vector<calibrate::Observation> rows;
  std::vector<std::size_t> stays;
  for (std::size_t i = 0; i < n; ++i) {
    const int run = data.rows[i].condition.run;
    const bool out =
        sessions > 2 ? run == static_cast<int>(part % sessions) : i * kParts / n == part % kParts;
    if (!out) stays.push_back(i);
  }
  rows.reserve(stays.size());
  for (const std::size_t i : stays) rows.push_back(data.rows[i]);
  data.rows = std::move(rows);
  if (sessions > 2) {
    const int gone = static_cast<int>(part % sessions);
    data.runs.erase(data.runs.begin() + gone);
    for (calibrate::Observation& row : data.rows)
      row.condition.run -= row.condition.run > gone ? 1 : 0;
  }
  for (calibrate::Covariate& c : data.covariates) {
    std::vector<double> values;
    values.reserve(stays.size());
    for (const std::size_t i : stays) values.push_back(c.value[i]);
    c.value = std::move(values);
  }
  const auto results = app::diagnose(task, {});
  const Diagnosis& d = results->front();
  LeftOut result{.answer = answer_of(d)};
  const auto left = explanations_of(d);
  const auto names = [](const std::vector<std::vector<std::string>>& all) {
    std::multiset<std::string> ids;
    for (const auto& one : all) ids.insert(one.front());
    return ids;
  };
  result.same = names(left) == names(whole.explanations);
  std::vector<bool> taken(left.size(), false);
  result.same_or_alternatives =
      left.size() == whole.explanations.size() &&
      std::ranges::all_of(whole.explanations, [&](const std::vector<std::string>& before) {
        for (std::size_t e = 0; e < left.size(); ++e) {
          if (taken[e] || !(holds(before, left[e].front()) || holds(left[e], before.front()))) {
            continue;
          }
          taken[e] = true;
          return true;
        }
        return false;
      });
  return result;
}

}  // namespace gear3k::wide_rig
