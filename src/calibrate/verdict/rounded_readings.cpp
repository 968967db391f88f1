#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "calibrate/fit/rounding.hpp"
#include "calibrate/measurement/noise.hpp"
#include "calibrate/measurement/row_selection.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "calibrate/verdict/noise_level.hpp"

namespace gear3k::calibrate {
namespace {

/// The readings as they may have been before they were rounded, if the simulation as given is
/// right; rows that a diagnosis left out stay as they are.
/// @param rows  of that diagnosis
std::optional<MeasurementSet> before_rounding_of(const MeasurementSet& data,
                                                 const std::vector<RowResult>& rows,
                                                 std::uint64_t seed) {
  std::vector<std::size_t> place;
  std::vector<double> expected;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!std::isfinite(rows[i].baseline)) continue;
    place.push_back(i);
    expected.push_back(rows[i].baseline);
  }
  if (expected.empty()) return std::nullopt;
  const Eigen::Map<const Eigen::VectorXd> y(expected.data(),
                                            static_cast<Eigen::Index>(expected.size()));
  const auto before = before_rounding(select_rows(data, place), y, seed);
  if (!before) return std::nullopt;
  MeasurementSet result = data;
  for (std::size_t k = 0; k < place.size(); ++k) {
    result.rows[place[k]].response = before->rows[k].response;
  }
  result.readings = before->readings;
  return result;
}

/// Errors and σ of a diagnosis of readings before they were rounded become those of the readings
/// themselves: σ² and the noise's floor have u²/12 more.
void tell_of_readings(Diagnosis& d, const MeasurementSet& data, double step) {
  std::vector<double> off, off_extended, off_then, off_held, weighted, weighted_held;
  for (std::size_t i = 0; i < d.rows.size(); ++i) {
    RowResult& row = d.rows[i];
    if (!std::isfinite(row.baseline)) continue;
    const double y = data.rows[i].response;
    off.push_back(y - row.baseline);
    off_extended.push_back(y - row.extended);
    if (std::isfinite(row.holdout)) {
      off_then.push_back(off.back());
      off_held.push_back(y - row.holdout);
      weighted.push_back(off.back() / row.sigma);
      weighted_held.push_back(off_held.back() / row.sigma);
    }
    row.sigma = std::hypot(row.sigma, step / std::sqrt(12.0));
  }
  const auto rms = [](const std::vector<double>& x) {
    return root_mean_square(
        Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())));
  };
  Errors& e = d.errors;
  e.baseline_train = rms(off);
  e.extended_train = rms(off_extended);
  e.noise_floor = std::hypot(e.noise_floor, step / std::sqrt(12.0));
  // What was said of a stated sigma is that of the readings, rounding included, too.
  if (std::isfinite(d.stated_noise) && d.noise_source != NoiseSource::kStated) {
    std::erase_if(d.notes, tells_of_stated_level);
    const double factor = e.noise_floor / d.stated_noise;
    if (factor <= kAsStated && factor >= 1.0 / kAsStated) {
      d.noise_source = NoiseSource::kStated;
      e.noise_floor = d.stated_noise;
    } else {
      d.notes.push_back(note_on_stated_level(factor));
    }
  }
  if (!std::isfinite(e.extended_holdout)) return;
  e.baseline_holdout = rms(off_then);
  e.extended_holdout = rms(off_held);
  if (std::isfinite(e.weighted_gain)) e.weighted_gain = 1.0 - rms(weighted_held) / rms(weighted);
  if (!d.correction) return;
  d.correction->held_out_error = e.extended_holdout;
  d.correction->held_out_gain = 1.0 - e.extended_holdout / e.baseline_holdout;
}

std::vector<std::string> names_of(const Diagnosis& d) {
  std::vector<std::string> names;
  names.reserve(d.effects.size());
  for (const Effect& effect : d.effects) names.push_back(effect.id);
  std::ranges::sort(names);
  return names;
}

/// Whether readings before rounding say something else than the readings.
bool says_otherwise(const Diagnosis& before, const Diagnosis& found) {
  const bool explains =
      found.verdict == Verdict::kUnexplained && before.verdict != Verdict::kUnexplained;
  return explains || names_of(before) != names_of(found);
}

std::string note_on_rounding(const Diagnosis& before) {
  const std::string told =
      before.effects.empty()
          ? "no cause is found"
          : fmt::format("{} would be found{}", fmt::join(names_of(before), ", "),
                        before.verdict == Verdict::kUnexplained ? "" : ", and nothing else");
  return "the readings come in coarse steps, and some of what is found may be their rounding: of "
         "readings as they may have been before it " +
         told;
}

DiagnoseOptions part_of(const DiagnoseOptions& options, double from, double to) {
  DiagnoseOptions part = options;
  if (options.progress) {
    part.progress = [&options, from, to](double share) {
      return options.progress(from + (to - from) * share);
    };
  }
  return part;
}

/// What is told of readings in steps where something is found in them.
std::optional<Diagnosis> look_again(const Simulation& simulation, const MeasurementSet& data,
                                    const DiagnoseOptions& options, Diagnosis found, double step) {
  // Whether there is anything is a question of the simulation as given, and of what a sensor with
  // such steps reads of it.
  const auto expected = before_rounding_of(data, found.rows, options.seed + 13);
  if (!expected) return found;
  auto before = diagnose_as_read(simulation, *expected, part_of(options, 0.5, 1.0));
  if (!before) return std::nullopt;
  // A memory that only the second look shows is no matter of rounding.
  if (before->memory.memory.share > 0.0 && !(found.memory.memory.share > 0.0)) return found;
  if (before->verdict == Verdict::kNoDiscrepancy) {
    tell_of_readings(*before, data, step);
    before->notes.emplace_back(
        "the readings come in coarse steps: rounded alike, the simulation as given agrees with "
        "them; tests and outliers are those of readings as they may have been before rounding");
    return before;
  }
  // Its values are no answer: these readings lie nearer to the simulation as given than what is
  // there leaves them.
  if (says_otherwise(*before, found)) found.notes.push_back(note_on_rounding(*before));
  return found;
}

}  // namespace

std::optional<Diagnosis> diagnose(const Simulation& simulation, const MeasurementSet& data,
                                  const DiagnoseOptions& options) {
  const auto steps = reading_steps(data);
  if (!steps) return diagnose_as_read(simulation, data, options);
  auto found = diagnose_as_read(simulation, data, part_of(options, 0.0, 0.5));
  if (found && found->verdict != Verdict::kNoDiscrepancy) {
    found = look_again(simulation, data, options, std::move(*found), steps->step);
  }
  if (found && options.progress && !options.progress(1.0)) return std::nullopt;
  return found;
}

}  // namespace gear3k::calibrate
