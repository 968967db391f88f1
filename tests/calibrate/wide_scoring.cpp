#include "tests/calibrate/wide_scoring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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

namespace {

using calibrate::Diagnosis, calibrate::Effect;

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
  for (const File& file : files) texts.push_back({.path = file.name, .text = file.text});
  return app::diagnosis_task({.subject = subject, .data = io::parse_measurements(texts)});
}

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

/// Root mean square of predicted − clean over the unseen rows.
double error_of(const calibrate::Subject& subject, const Campaign& campaign,
                const calibrate::ExtendedModel* model, const calibrate::Hypothesis& hypothesis) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const app::DiagnosisTask task = task_of(subject, campaign.unseen);
  const calibrate::MeasurementSet& data = task.sets.front();
  if (data.rows.size() != campaign.unseen_clean.size()) return kNone;
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
  for (std::size_t i = 0; i < campaign.unseen_clean.size(); ++i) {
    const double e = at.simulated[static_cast<Eigen::Index>(i)] * unit - campaign.unseen_clean[i];
    sum += e * e;
  }
  return std::sqrt(sum / static_cast<double>(campaign.unseen_clean.size()));
}

void score_unseen(const calibrate::Subject& subject, const Campaign& campaign,
                  const app::DiagnosisTask& task, const Diagnosis& d, Score& score) {
  score.unseen = score.unseen_refit = std::numeric_limits<double>::quiet_NaN();
  if (campaign.unseen.empty()) return;
  score.unseen = error_of(subject, campaign, &d.model, {});
  const calibrate::MeasurementSet& data = task.sets.front();
  const calibrate::Problem problem{.simulation = task.simulations.front(),
                                   .data = data,
                                   .noise = calibrate::make_noise_model(data)};
  for (const calibrate::Candidate& c : calibrate::candidates_for(problem.simulation, data)) {
    const bool refits = c.cause->id == "friction_level" || c.cause->id == "clearance";
    if (!refits) continue;
    const calibrate::Columns base = calibrate::columns_at(problem, {}, {}, 0.0);
    const calibrate::Fit fit =
        calibrate::fit(problem, calibrate::with({}, c), calibrate::robust_deviation(base.residual));
    score.unseen_refit = error_of(subject, campaign, nullptr, fit.hypothesis);
  }
}

std::string answer_of(const Diagnosis& d) {
  std::string text;
  for (const Effect& e : d.effects) {
    text += (text.empty() ? "" : " + ") + e.id + ":" + e.form.name;
    std::string others;
    for (const auto& a : e.alternatives) others += (others.empty() ? "" : " ") + a.id;
    if (!others.empty()) text += "(" + others + ")";
  }
  if (text.empty())
    text = std::string(calibrate::kVerdictNames[static_cast<std::size_t>(d.verdict)]);
  if (d.remainder.significant) text += " + remainder along " + d.remainder.along;
  return text;
}

}  // namespace

Score score(const Campaign& campaign) {
  const calibrate::Subject subject = subject_of(campaign.subject_toml);
  const app::DiagnosisTask task = task_of(subject, campaign.files);
  const auto results = app::diagnose(task, {});
  const Diagnosis& d = results->front();
  Score score;
  score.strength = campaign.strength;
  score.answer = answer_of(d);

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
    score.lists_excluded =
        score.lists_excluded || std::ranges::any_of(campaign.excluded, [&](const std::string& id) {
          return lists(effect, id) && !holds(campaign.companions, id) &&
                 std::ranges::none_of(campaign.truths, [&](const Truth& t) {
                   return t.cause == id || holds(t.acceptable, id);
                 });
        });
  }
  if (unknown) {
    score.right = d.remainder.significant;
    score.wrong_name = !d.effects.empty() && !d.remainder.significant;
    score.disclosed = true;
  } else {
    score.false_remainder = d.remainder.significant && all_named && !score.wrong_name;
    score.right = all_named && !score.wrong_name && !d.remainder.significant;
    score.disclosed = std::ranges::all_of(campaign.truths, [&](const Truth& t) {
      return std::ranges::any_of(d.effects, [&](const Effect& e) { return lists(e, t.cause); });
    });
  }
  for (const Truth& t : campaign.truths) {
    for (const Effect& e : d.effects) {
      if (e.id != t.cause) continue;
      for (const TruthParameter& p : t.parameters) {
        for (const auto& found : e.parameters) {
          if (found.name != p.name || found.unit != p.unit) continue;
          ++score.intervals;
          score.inside += found.low <= p.value && p.value <= found.high ? 1 : 0;
        }
      }
    }
  }
  score_unseen(subject, campaign, task, d, score);
  return score;
}

}  // namespace gear3k::wide_rig
