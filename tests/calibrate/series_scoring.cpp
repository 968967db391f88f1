#include "tests/calibrate/series_scoring.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/diagnose.hpp"
#include "calibrate/series/series.hpp"
#include "io/files/design_file.hpp"
#include "io/files/measurement_file.hpp"

namespace gear3k::series_rig {

namespace {

using calibrate::Origin, calibrate::SeriesCause, calibrate::SeriesParameter;

Origin origin_of(Owner owner) {
  switch (owner) {
    case Owner::design:
      return Origin::kDesign;
    case Owner::part:
      return Origin::kPart;
    case Owner::both:
      break;
  }
  return Origin::kBoth;
}

/// Standard deviation of the gearboxes as they were built.
double built_deviation(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  double squares = 0.0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

bool lists(const SeriesCause& cause, const std::string& id) {
  return cause.id == id || std::ranges::find(cause.alternatives, id) != cause.alternatives.end();
}

void compare(const SeriesTruth& truth, const SeriesParameter& p, TruthScore& score) {
  score.measured = true;
  if (truth.deviation > 0.0) score.deviation = p.effects.deviation / built_deviation(truth.values);
  score.mean_inside = p.effects.mean_low <= truth.mean && truth.mean <= p.effects.mean_high;
  score.deviation_inside =
      p.effects.deviation_low <= truth.deviation && truth.deviation <= p.effects.deviation_high;
}

}  // namespace

SeriesScore score(const SeriesCampaign& campaign, bool whole) {
  std::vector<io::FileText> texts;
  for (const wide_rig::File& file : campaign.files) {
    texts.push_back({.path = file.name, .text = file.text});
  }
  const auto start = std::chrono::steady_clock::now();
  const app::DiagnosisTask task =
      app::diagnosis_task({.subject = io::parse_design(campaign.subject_toml, "subject.toml"),
                           .data = io::parse_measurements(texts)});
  const calibrate::UnitSeries series =
      whole ? *app::diagnose(task, {})->front().series
            : calibrate::find_series(task.simulations.front(), task.sets.front(), {});
  SeriesScore result;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::vector<bool> taken(series.causes.size(), false);
  result.right = true;
  for (const SeriesTruth& truth : campaign.truths) {
    TruthScore one;
    for (const bool itself : {true, false}) {
      for (std::size_t c = 0; c < series.causes.size() && !one.named; ++c) {
        const SeriesCause& cause = series.causes[c];
        if (taken[c] || !(itself ? cause.id == truth.cause : lists(cause, truth.cause))) continue;
        taken[c] = true;
        one.named = true;
        one.right = cause.of == origin_of(truth.owner);
        for (const SeriesParameter& p : cause.parameters) {
          if (itself && p.name == truth.parameter) compare(truth, p, one);
        }
      }
    }
    result.right = result.right && one.right;
    result.truths.push_back(one);
  }
  for (std::size_t c = 0; c < series.causes.size(); ++c) {
    const SeriesCause& cause = series.causes[c];
    const bool companion = std::ranges::any_of(campaign.truths, [&](const SeriesTruth& truth) {
      return truth.companion == cause.id && cause.of == Origin::kDesign;
    });
    result.right = result.right && (taken[c] || companion);
  }
  for (const auto& unit : series.units) {
    result.unexplained = result.unexplained || unit.unexplained_along.has_value();
  }
  for (const SeriesCause& cause : series.causes) {
    result.answer += (result.answer.empty() ? "" : " + ") + cause.id + ":" + cause.form.name + " " +
                     std::string(calibrate::kOriginNames[static_cast<std::size_t>(cause.of)]);
    for (const std::string& id : cause.alternatives) result.answer += " (" + id + ")";
  }
  if (result.answer.empty()) result.answer = "nothing";
  if (result.unexplained) result.answer += "; unexplained";
  return result;
}

}  // namespace gear3k::series_rig
