#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

#include "calibrate/measurement/blank_conditions.hpp"
#include "calibrate/measurement/left_out_rows.hpp"
#include "calibrate/verdict/noise_level.hpp"
#include "io/text/printable.hpp"
#include "report/condition_columns.hpp"
#include "report/diagnosis_report.hpp"
#include "report/display.hpp"
#include "report/experiment_table.hpp"
#include "report/loop_table.hpp"
#include "report/series_report.hpp"
#include "report/text_table.hpp"
#include "report/uncertain_value.hpp"

namespace gear3k::report {

namespace {

using calibrate::Alternative, calibrate::CovariateTest, calibrate::Diagnosis, calibrate::Effect,
    calibrate::Form, calibrate::MeasurementSet, calibrate::NoiseSource, calibrate::ParameterResult,
    calibrate::Verdict;

std::string spaced(std::string text) {
  std::ranges::replace(text, '_', ' ');
  return text;
}

std::string rows_text(std::size_t rows) {
  return rows == 1 ? "1 row" : fmt::format("{} rows", rows);
}

std::string parameters_text(const std::vector<ParameterResult>& parameters) {
  std::vector<std::string> parts;
  parts.reserve(parameters.size());
  for (const ParameterResult& p : parameters) {
    parts.push_back(fmt::format("{} {}", spaced(p.name), with_interval(p)));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// Where a cause acts, as the end of its title: " at the sun"; " of the planet, 29.2 per ...".
std::string place_clause(const std::string& id, const Form& form) {
  const std::string place = place_text(form);
  std::string text;
  if (!place.empty()) {
    // The title of a run-out ends with "of a body".
    text = fmt::format("{} the {}", form.order > 0.0 && id == "runout" ? ":" : " at", place);
    if (form.order > 0.0 && id != "runout") text = fmt::format(" of {}", place);
  }
  if (form.order > 0.0) text += fmt::format(", {:.4g} times per turn of the output", form.order);
  return text;
}

std::string form_clause(const Form& form, const std::vector<std::string>& runs) {
  const std::string text = form_text(form, runs);
  return text.empty() ? "" : fmt::format(" (form: {})", text);
}

std::string limits_text(const ParameterResult& p) {
  std::string text;
  if (p.at_bound) {
    text += fmt::format("  {} stands at a bound of the fit: take it as a limit, not as a value.\n",
                        spaced(p.name));
  }
  if (!p.plausible) {
    text += fmt::format(
        "  {} = {} is physically implausible ({:.4g} to {:.4g} would be plausible): distrust this "
        "cause, or the data.\n",
        spaced(p.name), with_unit(fmt::format("{:.4g}", clean(p.value)), p.unit), p.plausible_low,
        p.plausible_high);
  }
  return text;
}

std::string alternative_text(const Alternative& a, const std::vector<std::string>& runs,
                             calibrate::Kind kind) {
  const bool angles = kind == calibrate::Kind::kLostMotion || kind == calibrate::Kind::kTorqueAngle;
  const char* const level =
      angles ? ", with another clearance" : ", with another coefficient of friction";
  std::string text = fmt::format("    {}: {}{}{}: {}{}\n", a.id, a.title,
                                 place_clause(a.id, a.form), form_clause(a.form, runs),
                                 parameters_text(a.parameters), a.with_level ? level : "");
  for (const ParameterResult& p : a.parameters) {
    if (!p.plausible) {
      text +=
          fmt::format("      {} = {:.4g} would not be plausible\n", spaced(p.name), clean(p.value));
    }
  }
  return text;
}

/// @param several  whether other causes act beside it
std::string effect_text(const Effect& e, const std::vector<std::string>& runs, bool several,
                        calibrate::Kind kind) {
  // What is likelier to have no cause of the library is not called one.
  std::string text = fmt::format("{}: {}{}: {}{}. [{}]\n",
                                 e.is_doubtful() ? "Nearest cause, but likely none" : "Cause",
                                 e.title, place_clause(e.id, e.form), parameters_text(e.parameters),
                                 form_clause(e.form, runs), e.id);
  if (e.id == "friction_level") text += "  This is a parameter, not a missing effect.\n";
  if (e.preferred_parameter) {
    const bool ahead = std::ranges::any_of(
        e.alternatives, [&](const Alternative& a) { return a.probability > e.probability; });
    text += fmt::format(
        "  A missing effect explains the data as well{}; the parameter is preferred because it "
        "needs no new physics.\n",
        ahead ? " or a little better" : "");
  }
  for (const ParameterResult& p : e.parameters) text += limits_text(p);
  for (const Alternative& other : e.other_bodies) {
    const std::string form = other.form.body.empty() ? form_clause(other.form, runs) : "";
    text +=
        fmt::format("  These data cannot tell where: as well{}{}: {}\n",
                    place_clause(other.id, other.form), form, parameters_text(other.parameters));
  }
  if (!e.alternatives.empty()) {
    text += several ? "  These data cannot tell it from (each beside another cause as above):\n"
                    : "  These data cannot tell it from:\n";
    for (const Alternative& a : e.alternatives) text += alternative_text(a, runs, kind);
  }
  return text;
}

/// "12 % better", "2 % worse": a gain of the root mean square of rows held out, which all count
/// alike in it, whatever their noise.
std::string gain_text(double gain) {
  const std::string text = fixed(std::abs(percent(gain)), 0);
  return fmt::format("{} % {}", text, gain < 0.0 && text != "0" ? "worse" : "better");
}

/// A law, what it predicts and where it holds.
std::string law_text(const calibrate::LawResult& law, const Diagnosis& d) {
  std::string text = fmt::format("Law (no cause): {}: {}\n  {}\n", law.name, law.formula,
                                 parameters_text(law.parameters));
  const ResponseText response = response_text(d.kind);
  if (std::isfinite(law.held_out_gain)) {
    text += fmt::format(
        "  It predicts rows held out (by {}) to {}, {} than without it.\n", d.holdout_blocks,
        with_unit(fmt::format("{:.3g}", clean(law.held_out_error / response.si)), response.unit),
        gain_text(law.held_out_gain));
  }
  std::vector<std::string> ranges;
  for (const calibrate::ConditionRange& r : law.range) {
    ranges.push_back(fmt::format("{} {:.4g} to {}", r.name, clean(r.low),
                                 with_unit(fmt::format("{:.4g}", clean(r.high)), r.unit)));
  }
  return text + fmt::format("  It is a formula for these data, {}; chosen among {} forms.\n",
                            fmt::join(ranges, ", "), law.forms);
}

/// What the model predicts by where nothing explains.
std::string correction_text(const Diagnosis& d) {
  if (!d.correction) return "";
  const ResponseText response = response_text(d.kind);
  const calibrate::Correction& c = *d.correction;
  if (!d.effects.empty() || !d.remainder.significant) {
    return fmt::format(
        "The model predicts by {} alone: {}\n"
        "  It predicts rows held out (by {}) to {}; of all rows left out, by load, test torque, "
        "speed and session, the causes above predict some less well, or none surely better.\n",
        c.id, parameters_text(c.parameters), d.holdout_blocks,
        with_unit(fmt::format("{:.3g}", clean(c.held_out_error / response.si)), response.unit));
  }
  return fmt::format(
      "Empirical correction (no cause): {} as a formula: {}\n"
      "  It predicts rows held out (by {}) to {}, {} than the simulation, and explains nothing.\n",
      c.id, parameters_text(c.parameters), d.holdout_blocks,
      with_unit(fmt::format("{:.3g}", clean(c.held_out_error / response.si)), response.unit),
      gain_text(c.held_out_gain));
}

// --- errors

/// Mean magnitude of the measured response, in its unit.
double mean_response(const MeasurementSet& set) {
  double sum = 0.0;
  for (const auto& row : set.rows) sum += std::abs(row.response);
  return set.rows.empty() ? 0.0 : sum / static_cast<double>(set.rows.size());
}

/// A share in percent, to two digits.
std::string share_text(double si, double mean) {
  const double share = percent(si / mean);
  return fixed(share, share < 0.095 ? 2 : share < 9.95 ? 1 : 0) + " %";
}

/// "0.00432 Nm (4.1 %)": percent of the mean response.
std::string error_text(double si, const Diagnosis& d, double mean) {
  if (!std::isfinite(si)) return "not known";
  const ResponseText response = response_text(d.kind);
  const std::string number =
      with_unit(fmt::format("{:.3g}", clean(si / response.si)), response.unit);
  return mean > 0.0 ? fmt::format("{} ({})", number, share_text(si, mean)) : number;
}

std::string noise_text(const Diagnosis& d) {
  switch (d.noise_source) {
    case NoiseSource::kStated:
      return "as the data state it";
    case NoiseSource::kRepeats:
      return fmt::format("from {} repeat{}", d.repeat_degrees, d.repeat_degrees == 1 ? "" : "s");
    case NoiseSource::kResiduals:
      break;
  }
  return std::isfinite(d.stated_noise)
             ? "from what is left"
             : "from what is left, for want of sigma and of enough repeats";
}

/// Scatter of the rows over what they state, where the stated level is not theirs; else empty.
std::optional<double> scatter_over_stated(const Diagnosis& d) {
  if (d.noise_source == NoiseSource::kStated || !std::isfinite(d.stated_noise)) return std::nullopt;
  return d.errors.noise_floor / d.stated_noise;
}

/// "The rows scatter by 2.1 times the sigma that they state (0.0003 Nm)."
std::string stated_noise_text(const Diagnosis& d) {
  const std::optional<double> factor = scatter_over_stated(d);
  if (!factor || !std::isfinite(*factor)) return "";
  const std::string stated = error_text(d.stated_noise, d, 0.0);
  return *factor > 1.0
             ? fmt::format("The rows scatter by {:.3g} times the sigma that they state ({}).\n",
                           *factor, stated)
             : fmt::format("The stated sigma ({}) is {:.3g} times what the rows scatter by.\n",
                           stated, 1.0 / *factor);
}

std::string headline(const Diagnosis& d, const MeasurementSet& set) {
  const double mean = mean_response(set);
  const ResponseText response = response_text(d.kind);
  std::string off;
  std::string noise;
  if (mean > 0.0) {
    off = share_text(d.errors.baseline_train, mean);
    noise = share_text(d.errors.noise_floor, mean);
  } else {
    off = error_text(d.errors.baseline_train, d, 0.0);
    noise = error_text(d.errors.noise_floor, d, 0.0);
  }
  if (!std::isfinite(d.errors.noise_floor)) {
    return fmt::format(
        "The simulation is {} off; {} row{} without sigma or repeats cannot say what of it is "
        "noise.\n(Root mean square {} of a mean {} of {}.)\n",
        off, set.rows.size(), set.rows.size() == 1 ? "" : "s",
        error_text(d.errors.baseline_train, d, 0.0), response.title, error_text(mean, d, 0.0));
  }
  std::string text = fmt::format(
      "The simulation is {} off where noise is {}.\n"
      "(Root mean square {} of a mean {} of {}; noise {}, {}.)\n",
      off, noise, error_text(d.errors.baseline_train, d, 0.0), response.title,
      error_text(mean, d, 0.0), error_text(d.errors.noise_floor, d, 0.0), noise_text(d));
  text += stated_noise_text(d);
  if (d.session_deviation > 0.0) {
    text += fmt::format("Sessions scatter by {} beyond that.\n",
                        error_text(d.session_deviation, d, 0.0));
  }
  if (d.memory.memory.share > 0.0) {
    text += fmt::format(
        "The noise remembers: readings that follow each other correlate by {:.2f} ({:.2f} to "
        "{:.2f}), and all\nthat is said here was judged against such noise.\n",
        d.memory.memory.correlation(), d.memory.low, d.memory.high);
  }
  return text;
}

/// What the effects need that no gearbox shows.
std::string implausible_text(const Diagnosis& d) {
  std::vector<std::string> values;
  for (const auto& effect : d.effects) {
    for (const ParameterResult& p : effect.parameters) {
      if (p.plausible) continue;
      values.push_back(fmt::format("{} {} [{}]", spaced(p.name),
                                   with_unit(fmt::format("{:.2g}", clean(p.value)), p.unit),
                                   effect.id));
    }
  }
  if (values.empty()) return "";
  return fmt::format("  It takes physically implausible values: {}.\n", fmt::join(values, ", "));
}

std::string ambiguous_text(const Diagnosis& d) {
  std::vector<std::string> doubtful;
  for (const auto& effect : d.effects) {
    if (!effect.is_doubtful()) continue;
    doubtful.push_back(fmt::format("that no cause of the library is behind {} has {} %", effect.id,
                                   fixed(percent(effect.no_cause), 0)));
  }
  if (doubtful.empty()) {
    return "Verdict: ambiguous. Several causes explain these data as well and would lead to "
           "different remedies; see the next experiment.\n";
  }
  return fmt::format(
      "Verdict: ambiguous. What is found may be chance: {}; see the next experiment.\n",
      fmt::join(doubtful, ", "));
}

/// Whether what is left follows a condition that many rows lack, so that nothing was looked for
/// that does.
bool follows_unused(const Diagnosis& d, const MeasurementSet& set) {
  const auto column = column_of(d.remainder.along, d.kind);
  return column && std::ranges::any_of(calibrate::kConditionQuantities, [&](const auto& quantity) {
           return quantity.column == column->name && calibrate::is_unused(set, quantity);
         });
}

std::string verdict_text(const Diagnosis& d, const MeasurementSet& set) {
  switch (d.verdict) {
    case Verdict::kNoDiscrepancy:
      if (!std::isfinite(d.errors.noise_floor)) {
        return "Verdict: no discrepancy found, but too few rows to know whether the simulation "
               "agrees: state sigma, or measure repeats.\n";
      }
      if (d.session_deviation > 0.0) {
        return "Verdict: no discrepancy beyond what the sessions differ by. Within a session the "
               "simulation agrees with these data within their noise.\n";
      }
      if (const auto factor = scatter_over_stated(d); factor && *factor > calibrate::kAsStated) {
        return "Verdict: no discrepancy beyond how the rows scatter: along nothing that the data "
               "state is the simulation off. The stated sigma is too small, or rows differ in what "
               "the file does not say.\n";
      }
      return "Verdict: no discrepancy. The simulation agrees with these data within their noise.\n";
    case Verdict::kExplained:
      return "Verdict: explained.\n";
    case Verdict::kAmbiguous:
      return ambiguous_text(d);
    case Verdict::kUnexplained:
      break;
  }
  if (!d.effects.empty() && !d.remainder.significant) {
    return "Verdict: unexplained. What fits takes values that no gearbox shows.\n";
  }
  if (follows_unused(d, set)) {
    return fmt::format(
        "Verdict: unexplained. Something is left along {}, which many rows do not state: causes "
        "that follow it were not looked for.\n",
        d.remainder.along);
  }
  return d.effects.empty()
             ? "Verdict: unexplained. The simulation is off and no known cause explains it.\n"
             : "Verdict: unexplained. Something is left that no known cause explains.\n";
}

// --- tables

std::string p_text(double p) {
  if (!std::isfinite(p)) return "-";
  constexpr double kLeastShown = 1e-99;
  if (p < kLeastShown) return "<1e-99";
  return p < 1e-4 ? fmt::format("{:.0e}", p) : fmt::format("{:.2g}", p);
}

/// "p = 0.02", "p < 1e-99"
std::string p_statement(double p) {
  const std::string text = p_text(p);
  return text.starts_with('<') ? fmt::format("p < {}", text.substr(1)) : "p = " + text;
}

std::string evidence_table(const Diagnosis& d) {
  if (d.effects.empty()) return "";
  const auto share = [](double p) -> std::string {
    constexpr double kLeast = 0.01;
    if (p < kLeast) return "<1 %";
    if (p > 1.0 - kLeast) return ">99 %";
    return fmt::format("{} %", fixed(percent(p), 0));
  };
  TextTable table({"cause", "delta BIC", "probability", "p-value"});
  for (const Effect& e : d.effects) {
    table.add({e.id, fixed(e.delta_bic, 1), share(e.probability), p_text(e.p_value)});
    for (const Alternative& a : e.alternatives) {
      table.add({"  or " + a.id, "", share(a.probability), ""});
    }
    table.add({"  or no cause of the library", "", share(e.no_cause), ""});
  }
  return "\nEvidence (delta BIC above 10 is strong)\n" + table.text(2);
}

std::string covariate_table(const Diagnosis& d) {
  if (d.covariates_before.empty()) return "";
  TextTable table({"along", "p-value before", "after"});
  for (auto before = d.covariates_before.begin(); before != d.covariates_before.end(); ++before) {
    // A name may stand twice: by levels, then by periods.
    const bool again = std::find_if(d.covariates_before.begin(), before, [&](const auto& t) {
                         return t.name == before->name;
                       }) != before;
    auto after = std::ranges::find(d.covariates_after, before->name, &CovariateTest::name);
    if (again && after != d.covariates_after.end()) {
      after = std::find_if(after + 1, d.covariates_after.end(),
                           [&](const auto& t) { return t.name == before->name; });
    }
    const bool periods = again || before->name == "angle";
    const bool nothing = d.effects.empty() || after == d.covariates_after.end();
    table.add({before->name + (periods ? ", periodic" : ""), p_text(before->p_value),
               nothing ? "-" : p_text(after->p_value)});
  }
  return "\nStructure of the residuals (small: the simulation misses something along this)\n" +
         table.text(2);
}

std::string gain_table(const Diagnosis& d, const MeasurementSet& set) {
  const double mean = mean_response(set);
  TextTable table({"error (root mean square)", "as given", "extended"});
  const auto add = [&](const std::string& name, double before, double after) {
    table.add({name, error_text(before, d, mean), error_text(after, d, mean)});
  };
  add("all rows", d.errors.baseline_train, d.errors.extended_train);
  if (!d.holdout_blocks.empty()) {
    add(fmt::format("held out (by {})", d.holdout_blocks), d.errors.baseline_holdout,
        d.errors.extended_holdout);
  }
  if (!d.extrapolation.along.empty()) {
    const auto column = column_of(d.extrapolation.along, d.kind);
    add(fmt::format("beyond the fit, {} {} ({})", d.extrapolation.along,
                    with_unit(fmt::format("{:.4g}", clean(d.extrapolation.left_out)),
                              column ? column->unit : ""),
                    rows_text(static_cast<std::size_t>(d.extrapolation.rows))),
        d.extrapolation.baseline, d.extrapolation.extended);
  }
  std::string text = fmt::format("\n{}", table.text(0));
  const bool weighted = std::isfinite(d.errors.weighted_gain);
  const double gain = weighted ? d.errors.weighted_gain
                               : 1.0 - d.errors.extended_holdout / d.errors.baseline_holdout;
  if (std::isfinite(gain) && !(d.effects.empty() && d.laws.empty())) {
    text += fmt::format("On data that it has not seen the extended model is {} % {}{}.\n",
                        fixed(std::abs(percent(gain)), 0), gain >= 0.0 ? "better" : "worse",
                        weighted ? ", each row over its own noise" : "");
    if (gain < 0.0) text += "Do not use it.\n";
  } else if (!std::isfinite(gain)) {
    text += "These data have too few blocks to hold some out.\n";
  }
  return text;
}

/// Whether repeats tell that the simulation as given, the only one there is, misses nothing but
/// what differs among them.
bool repeats_scatter_as_much(const Diagnosis& d) {
  constexpr int kEnough = 10;
  constexpr double kLikely = 0.05;
  return d.effects.empty() && d.lack_of_fit.pure_degrees >= kEnough &&
         d.lack_of_fit.p_value > kLikely;
}

std::string remainder_text(const Diagnosis& d, const MeasurementSet& set) {
  const auto& r = d.remainder;
  if (!r.significant && r.minor) {
    return "Left over: more than noise makes, too little of the discrepancy to look for (see the "
           "notes).\n";
  }
  if (!r.significant) {
    return std::isfinite(d.errors.noise_floor) ? "Left over: nothing beyond noise.\n" : "";
  }
  if (r.constant) {
    return fmt::format(
        "Left over: an offset that all rows have in common ({}). No known cause does this.\n",
        p_statement(r.p_value));
  }
  if (r.along.empty()) {
    return fmt::format(
        "Left over: more than noise, along nothing that the data state ({}): root mean square {} "
        "where noise is {}. {}\n",
        p_statement(r.p_value), error_text(d.errors.extended_train, d, 0.0),
        error_text(d.errors.noise_floor, d, 0.0),
        repeats_scatter_as_much(d)
            ? "Rows that repeat each other scatter as much, and from condition to condition "
              "nothing "
              "is off: the stated sigma is too small, or repeats differ in what the file does not "
              "say."
        : d.noise_source == calibrate::NoiseSource::kStated
            ? "The stated sigma is too small, or rows differ in what the file does not say."
            : "More rows are far off than outliers are: they differ in what the file does not "
              "say.");
  }
  std::string text = fmt::format(
      "{}: structure along {}", d.laws.empty() ? "Left over" : "Left over before the law", r.along);
  if (r.order > 0.0 && r.along == "angle") {
    text += fmt::format(", {:.4g} times per turn of the output", r.order);
  } else if (r.order > 0.0 && r.along == "time") {
    text += fmt::format(", {:.3g} periods over the data", r.order);
  }
  return text + fmt::format(", which is {} % of what is left ({}). {}\n",
                            fixed(percent(r.share), 0), p_statement(r.p_value),
                            r.along == "session time"
                                ? "What warms up or settles does so anew in every session; "
                                  "measured temperatures would tell."
                            : follows_unused(d, set)
                                ? "Causes of it were not looked for: many rows do not state it."
                                : "No known cause does this.");
}

std::string lack_text(const Diagnosis& d) {
  if (d.lack_of_fit.degrees <= 0 || d.lack_of_fit.pure_degrees <= 0) return "";
  const auto f_of = [](const calibrate::LackOfFit& lack) {
    return fmt::format("F({}, {}) = {:.3g}, {}", lack.degrees, lack.pure_degrees, clean(lack.f),
                       p_statement(lack.p_value));
  };
  std::string text = fmt::format("Lack of fit of the simulation as given: {}", f_of(d.lack_of_fit));
  if (d.lack_of_model.degrees > 0) {
    constexpr double kRare = 1e-3;
    text += fmt::format(
        "; of the extended model: {}{}", f_of(d.lack_of_model),
        d.lack_of_model.p_value < kRare ? ": its shape leaves more than repeats differ by" : "");
  }
  return text + ".\n";
}

std::string notes_text(const Diagnosis& d, const MeasurementSet& set) {
  std::string text;
  // Those that were left out have a note of their own.
  std::vector<char> marked;
  marked.reserve(d.rows.size());
  for (const auto& row : d.rows) {
    marked.push_back(row.outlier && std::isfinite(row.extended) ? 1 : 0);
  }
  const auto outliers = std::ranges::count(marked, 1);
  if (outliers > 0) {
    const std::string places = io::printable(calibrate::places_of(set, marked));
    text += fmt::format(
        "Note: {}{}{}\n",
        outliers == 1
            ? fmt::format("1 of {} rows is an outlier; it counts less in the fit", d.rows.size())
            : fmt::format("{} of {} rows are outliers; they count less in the fit", outliers,
                          d.rows.size()),
        places.empty() ? "" : ": ", places);
  }
  for (const std::string& note : d.notes) text += fmt::format("Note: {}\n", io::printable(note));
  return text.empty() ? "" : fmt::format("\n{}", text);
}

std::string kind_text(const Diagnosis& d, const MeasurementSet& set) {
  std::string text = fmt::format("{}{}{} of kind {} from {}\n\n", io::printable(d.subject),
                                 d.subject.empty() ? "" : ": ", rows_text(set.rows.size()),
                                 calibrate::kKindNames[static_cast<std::size_t>(d.kind)],
                                 fmt::join(set.files, ", "));
  text += headline(d, set) + verdict_text(d, set) + implausible_text(d);
  const bool several = d.effects.size() > 1;
  if (several && std::ranges::find(d.effects, "friction_level", &Effect::id) != d.effects.end()) {
    text += "One coefficient of friction cannot explain these data by itself.\n";
  }
  for (const Effect& effect : d.effects) text += effect_text(effect, d.runs, several, d.kind);
  if (!d.effects.empty()) text += "(± is half of the 95 % interval.)\n";
  std::string laws;
  for (const calibrate::LawResult& law : d.laws) laws += law_text(law, d);
  text += unit_series_text(d) + evidence_table(d) + covariate_table(d) + gain_table(d, set) +
          remainder_text(d, set) + laws + correction_text(d) + lack_text(d) + loop_table(set) +
          experiment_table(d) + notes_text(d, set);
  return text;
}

}  // namespace

std::string place_text(const Form& form) {
  return form.body == "output" ? "output (R2)" : form.body;
}

std::string form_text(const Form& form, const std::vector<std::string>& runs) {
  // A form that is called as its body says nothing more.
  std::vector<std::string> parts;
  if (form.name != form.body && !form.name.empty()) parts.push_back(spaced(form.name));
  for (const auto& constant : form.constants) {
    const auto run = static_cast<std::size_t>(std::max(0.0, constant.value));
    if (constant.name == "first_run" && run < runs.size()) {
      parts.push_back(fmt::format("run {}", runs[run]));
    } else {
      parts.push_back(
          fmt::format("{} {}", spaced(constant.name),
                      with_unit(fmt::format("{:.4g}", clean(constant.value)), constant.unit)));
    }
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string diagnosis_table(const std::vector<Diagnosis>& diagnoses,
                            const std::vector<MeasurementSet>& sets, const DiagnosisSetup& setup) {
  require_matching(diagnoses, sets);
  std::string text;
  if (setup.model) text = diagnosed_model_paragraph(*setup.model) + "\n";
  for (std::size_t k = 0; k < sets.size(); ++k) {
    if (k > 0) text += '\n';
    text += kind_text(diagnoses[k], sets[k]);
  }
  return text;
}

}  // namespace gear3k::report
