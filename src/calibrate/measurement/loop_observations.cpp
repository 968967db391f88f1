#include "calibrate/measurement/loop_observations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "calibrate/measurement/response_unit.hpp"

namespace gear3k::calibrate {

namespace {

/// Samples of one session, referred to the output.
struct Session {
  TorqueAngleRecord samples;
  int run = -1, file = 0;
  bool sun_locked = true;
  std::string label, name;  ///< of run and file
  std::vector<int> place;   ///< of each sample in the file's record, from 1
};

/// A loop that is used.
struct UsedLoop {
  const Session* session;
  const Loop* loop;
};

std::vector<Session> sessions_of(const std::vector<LockedShaftRecord>& records, double ratio,
                                 std::vector<std::string>& runs) {
  std::vector<Session> sessions;
  const double factor = std::abs(ratio);
  for (const LockedShaftRecord& record : records) {
    const TorqueAngleRecord& all = record.samples;
    const std::size_t count = all.angle_rad.size();
    if (all.torque_Nm.size() != count || (!all.time_s.empty() && all.time_s.size() != count) ||
        (!record.run.empty() && record.run.size() != count)) {
      throw std::invalid_argument(fmt::format(
          "loop_observations: record of file {}: columns differ in length", record.file));
    }
    const std::size_t first = sessions.size();
    const double angle_factor = record.sun_locked ? 1.0 : 1.0 / factor;
    const double torque_factor = record.sun_locked ? 1.0 : factor;
    std::size_t current = first;
    for (std::size_t k = 0; k < count; ++k) {
      const std::string label = record.run.empty() ? "" : record.run[k];
      if (sessions.size() == first || sessions[current].label != label) {
        const auto known =
            std::find_if(sessions.begin() + static_cast<std::ptrdiff_t>(first), sessions.end(),
                         [&](const Session& s) { return s.label == label; });
        current = static_cast<std::size_t>(known - sessions.begin());
        if (known == sessions.end()) {
          Session session;
          session.file = record.file;
          session.sun_locked = record.sun_locked;
          session.label = label;
          session.name = record.name;
          if (!record.run.empty() || records.size() > 1) {
            session.run = static_cast<int>(runs.size());
            runs.push_back(record.run.empty() ? record.name : label);
          }
          sessions.push_back(std::move(session));
        }
      }
      TorqueAngleRecord& to = sessions[current].samples;
      if (!all.time_s.empty()) to.time_s.push_back(all.time_s[k]);
      to.angle_rad.push_back(all.angle_rad[k] * angle_factor);
      to.torque_Nm.push_back(all.torque_Nm[k] * torque_factor);
      sessions[current].place.push_back(static_cast<int>(k) + 1);
    }
  }
  return sessions;
}

double peak_of(const Loop& loop) {
  return std::min(-loop.lowest_torque_Nm, loop.highest_torque_Nm);
}

/// Travel at a torque, between the levels that were read.
std::optional<double> travel_at(const Loop& loop, double torque_Nm) {
  const auto& levels = loop.travel;
  for (std::size_t k = 1; k < levels.size(); ++k) {
    const auto& low = levels[k - 1];
    const auto& high = levels[k];
    if (torque_Nm < low.torque_Nm || torque_Nm > high.torque_Nm) continue;
    const double share = (torque_Nm - low.torque_Nm) / (high.torque_Nm - low.torque_Nm);
    return low.angle_rad + share * (high.angle_rad - low.angle_rad);
  }
  return std::nullopt;
}

/// Mean travel about a torque; empty where the flanks do not reach that far.
std::optional<double> mean_travel(const Loop& loop, double torque_Nm, double band_Nm) {
  constexpr int kSteps = 10;
  double sum = 0.0;
  for (int k = 0; k <= kSteps; ++k) {
    const auto travel = travel_at(loop, torque_Nm + band_Nm * (2.0 * k / kSteps - 1.0));
    if (!travel) return std::nullopt;
    sum += *travel;
  }
  return sum / (kSteps + 1);
}

struct Intercept {
  double value = 0.0, standard_deviation = 0.0;
};

/// Least-squares line through points (x, y), at x = 0, with the scatter about it; empty with fewer
/// than three.
std::optional<Intercept> intercept_of(const std::vector<std::array<double, 2>>& points) {
  if (points.size() < 3) return std::nullopt;
  const auto count = static_cast<double>(points.size());
  double x = 0.0;
  double y = 0.0;
  for (const auto& p : points) {
    x += p[0] / count;
    y += p[1] / count;
  }
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const auto& p : points) {
    xx += (p[0] - x) * (p[0] - x);
    xy += (p[0] - x) * (p[1] - y);
    yy += (p[1] - y) * (p[1] - y);
  }
  if (!(xx > 0.0)) return std::nullopt;
  const double left = std::max(0.0, yy - xy * xy / xx) / (count - 2.0);
  return Intercept{.value = y - xy / xx * x,
                   .standard_deviation = std::sqrt(left * (1.0 / count + x * x / xx))};
}

std::string session_text(const Session& session) {
  return session.label.empty() ? session.name
                               : fmt::format("{}, run {}", session.name, session.label);
}

/// Sessions that no row is of, as of records without a loop, are none.
void drop_empty_runs(MeasurementSet& set) {
  std::vector<int> place(set.runs.size(), -1);
  for (const Observation& row : set.rows) {
    if (row.condition.run >= 0) place[static_cast<std::size_t>(row.condition.run)] = 0;
  }
  std::vector<std::string> runs;
  for (std::size_t k = 0; k < place.size(); ++k) {
    if (place[k] < 0) continue;
    place[k] = static_cast<int>(runs.size());
    runs.push_back(set.runs[k]);
  }
  for (Observation& row : set.rows) {
    int& run = row.condition.run;
    if (run >= 0) run = place[static_cast<std::size_t>(run)];
  }
  set.runs = std::move(runs);
}

}  // namespace

LoopObservations loop_observations(const std::vector<LockedShaftRecord>& records, double ratio) {
  if (!std::isfinite(ratio) || ratio == 0.0) {
    throw std::invalid_argument(
        fmt::format("loop_observations: ratio = {}, allowed: a finite number other than 0", ratio));
  }
  LoopObservations result;
  const std::vector<Session> sessions = sessions_of(records, ratio, result.runs);
  LoopOptions options;
  options.travel_levels.clear();
  options.travel_levels.reserve(90);
  for (int k = 5; k < 95; ++k) options.travel_levels.push_back(0.01 * k);
  std::vector<LoopAnalysis> analyses;
  analyses.reserve(sessions.size());
  for (const Session& session : sessions)
    analyses.push_back(analyse_loops(session.samples, options));

  std::vector<UsedLoop> used;
  result.sessions.reserve(sessions.size());
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    const LoopAnalysis& analysis = analyses[s];
    if (analysis.outcome != RecordOutcome::kLoops) {
      ++result.refused;
      result.notes.push_back(fmt::format("{}: no loop: {}", session_text(sessions[s]),
                                         record_outcome_text(analysis.outcome)));
      continue;
    }
    LoopSession found{.file = sessions[s].file,
                      .run = sessions[s].label,
                      .sun_locked = sessions[s].sun_locked,
                      .cutoff_Hz = analysis.cutoff_Hz,
                      .creep = analysis.creep};
    found.loops.reserve(analysis.loops.size());
    std::size_t free_from = 0;
    for (std::size_t k = 0; k < analysis.loops.size(); ++k) {
      const Loop& loop = analysis.loops[k];
      if (loop.outcome != LoopOutcome::kMeasured) {
        ++result.refused;
        result.notes.push_back(fmt::format("{}: loop {} left out: {}", session_text(sessions[s]),
                                           k + 1, loop_outcome_text(loop.outcome)));
        continue;
      }
      if (loop.first_sample < free_from) continue;
      free_from = loop.last_sample;
      used.push_back({.session = &sessions[s], .loop = &loop});
      found.loops.push_back({.number = static_cast<int>(k) + 1, .loop = loop});
    }
    if (!found.loops.empty()) result.sessions.push_back(std::move(found));
  }
  result.measured = static_cast<int>(used.size());
  if (used.empty()) return result;

  double peak = std::numeric_limits<double>::infinity();
  for (const UsedLoop& u : used) peak = std::min(peak, peak_of(*u.loop));
  double taken_sum = 0.0;
  int taken = 0;
  for (const auto& [session, loop] : used) {
    std::vector<std::array<double, 2>> points;
    for (const double fraction : kTravelFractions) {
      if (const auto travel = mean_travel(*loop, fraction * peak, kTravelBand * peak)) {
        points.push_back({fraction * peak, *travel});
      }
    }
    double half = 0.0;
    if (const auto at_zero = intercept_of(points)) {
      constexpr double kDeviations = 3.0;
      const double h = loop->lost_motion_rad - at_zero->value;
      if (h > kDeviations * std::hypot(loop->lost_motion_sd_rad, at_zero->standard_deviation)) {
        half = 0.5 * h;
      }
    }
    if (half > 0.0) {
      taken_sum += half;
      ++taken;
    }
    Observation row;
    row.condition.run = session->run;
    row.file = session->file;
    row.line = session->place[loop->first_sample];
    if (!session->samples.time_s.empty()) {
      row.condition.time_s = session->samples.time_s[loop->reversal_sample];
      const double start_s = session->samples.time_s.front();
      if (!(result.record_start_s <= start_s)) result.record_start_s = start_s;
    }
    if (loop->lost_motion_sd_rad > 0.0) row.sigma = loop->lost_motion_sd_rad;
    row.response = loop->lost_motion_rad - half;
    result.rows.push_back(row);
    for (const auto& [torque, travel] : points) {
      row.condition.test_torque_Nm = torque;
      row.response = travel + half;
      result.rows.push_back(row);
    }
  }
  result.notes.push_back(
      fmt::format("{} loop{} read as lost motion at test torques 0 to {:.4g} N m", used.size(),
                  used.size() == 1 ? "" : "s", kTravelFractions.back() * peak));
  if (taken > 0) {
    result.notes.push_back(fmt::format(
        "friction opens {} loop{} by {:.3g} arcmin at zero torque and takes as much off the travel "
        "(means): both are corrected for it",
        taken, taken == 1 ? "" : "s", taken_sum / taken / response_unit(Kind::kLostMotion).si));
  }
  return result;
}

void add_loops(MeasurementSet& set, const LoopObservations& loops, int file_offset) {
  const bool in_sessions = !loops.runs.empty() || !set.runs.empty() || !set.rows.empty();
  const auto run_of_file = [&](int file) {
    const auto place = static_cast<std::size_t>(file);
    const std::string label =
        place < set.files.size() ? set.files[place] : fmt::format("file {}", file + 1);
    const auto known = std::ranges::find(set.runs, label);
    if (known == set.runs.end()) {
      set.runs.push_back(label);
      return static_cast<int>(set.runs.size()) - 1;
    }
    return static_cast<int>(known - set.runs.begin());
  };
  for (Observation& row : set.rows) {
    if (row.condition.run < 0) row.condition.run = run_of_file(row.file);
  }
  const auto run_offset = static_cast<int>(set.runs.size());
  set.runs.insert(set.runs.end(), loops.runs.begin(), loops.runs.end());
  // Several loops are repeats, which say more of their scatter than the filter does; but one sigma
  // for some rows only would say that the others have none.
  const bool keep_sigma = set.rows.empty()
                              ? loops.measured == 1
                              : std::ranges::all_of(set.rows, [](const Observation& row) {
                                  return std::isfinite(row.sigma);
                                });
  set.rows.reserve(set.rows.size() + loops.rows.size());
  for (Observation row : loops.rows) {
    row.file += file_offset;
    if (row.condition.run >= 0) {
      row.condition.run += run_offset;
    } else if (in_sessions) {
      row.condition.run = run_of_file(row.file);
    }
    if (!keep_sigma) row.sigma = kUnknown;
    set.rows.push_back(row);
  }
  drop_empty_runs(set);
  set.loops.reserve(set.loops.size() + loops.sessions.size());
  for (LoopSession session : loops.sessions) {
    session.file += file_offset;
    set.loops.push_back(std::move(session));
  }
  for (Covariate& covariate : set.covariates) covariate.value.resize(set.rows.size(), kUnknown);
  set.notes.insert(set.notes.end(), loops.notes.begin(), loops.notes.end());
  set.record_start_s = loops.record_start_s;
}

}  // namespace gear3k::calibrate
