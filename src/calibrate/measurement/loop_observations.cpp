#include "calibrate/measurement/loop_observations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "calibrate/loops/zero_phase_filter.hpp"
#include "calibrate/measurement/loop_friction.hpp"
#include "calibrate/measurement/loop_reading.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/row_selection.hpp"
#include "numerics/median.hpp"

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
  const LoopAnalysis* record;
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

std::vector<LoopReading> readings_of(const std::vector<UsedLoop>& used, double peak_Nm) {
  std::vector<LoopReading> readings;
  readings.reserve(used.size());
  const Session* session = nullptr;
  std::vector<double> response;
  for (const UsedLoop& u : used) {
    if (u.session != session) response = impulse_response(u.record->cutoff_per_sample);
    session = u.session;
    readings.push_back(read_loop(*u.loop, u.record->flank_noise, response, peak_Nm));
  }
  return readings;
}

/// Friction holds the shaft that was measured: loops of one such shaft have one.
std::vector<FrictionShare> shares_of(const std::vector<UsedLoop>& used,
                                     const std::vector<LoopReading>& readings) {
  std::vector<FrictionShare> shares(used.size());
  for (const bool sun_locked : {true, false}) {
    std::vector<LoopReading> some;
    std::vector<std::size_t> place;
    for (std::size_t k = 0; k < used.size(); ++k) {
      if (used[k].session->sun_locked != sun_locked) continue;
      some.push_back(readings[k]);
      place.push_back(k);
    }
    std::vector<FrictionShare> of_some = friction_shares(some);
    for (std::size_t k = 0; k < place.size(); ++k) shares[place[k]] = std::move(of_some[k]);
  }
  return shares;
}

std::string friction_note(const std::vector<FrictionShare>& shares) {
  double loops = 0.0, zero = 0.0, travel = 0.0, travels = 0.0;
  for (const FrictionShare& share : shares) {
    if (!(share.friction_Nm > 0.0)) continue;
    loops += 1.0;
    zero += share.zero_rad;
    travel += std::accumulate(share.travel_rad.begin(), share.travel_rad.end(), 0.0);
    travels += static_cast<double>(share.travel_rad.size());
  }
  if (loops == 0.0) return {};
  const double unit = response_unit(Kind::kLostMotion).si;
  return fmt::format(
      "friction opens {} loop{} by {:.3g} arcmin at zero torque and takes {:.3g} off the travel "
      "(means): both are corrected for it",
      loops, loops == 1.0 ? "" : "s", zero / loops / unit, travel / travels / unit);
}

/// When a reading was taken that is made of two: between the times of both.
double mean_time(const std::vector<double>& time_s, double one_sample, double other_sample) {
  const auto at = [&](double place) {
    const auto last = static_cast<double>(time_s.size() - 1);
    const auto k = static_cast<std::size_t>(std::clamp(std::floor(place), 0.0, last));
    const std::size_t next = std::min(k + 1, time_s.size() - 1);
    return time_s[k] + (place - static_cast<double>(k)) * (time_s[next] - time_s[k]);
  };
  return 0.5 * (at(one_sample) + at(other_sample));
}

/// By how much more than its travels a session's angles at zero torque scatter; 1 where not known.
/// Only rows of one session are compared: noise slower than the filter, which all rows of a loop
/// share, is in none of these deviations, so that faster sampling says nothing of whole loops.
double zero_scatter(const Session& session, const std::vector<UsedLoop>& used,
                    const std::vector<LoopReading>& readings) {
  constexpr double kMostRatio = 3.0;
  std::vector<double> zero, travel;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (used[k].session != &session || !readings[k].tells_zero) continue;
    zero.push_back(readings[k].zero_variance_rad2);
    for (const TravelReading& one : readings[k].travel) travel.push_back(one.variance_rad2);
  }
  if (zero.empty() || travel.empty()) return 1.0;
  const double of_zero = numerics::upper_median(std::move(zero));
  const double of_travel = numerics::upper_median(std::move(travel));
  if (!(of_zero > 0.0 && of_travel > 0.0)) return 1.0;
  return std::clamp(std::sqrt(of_zero / of_travel), 1.0 / kMostRatio, kMostRatio);
}

std::string session_text(const Session& session) {
  return session.label.empty() ? session.name
                               : fmt::format("{}, run {}", session.name, session.label);
}

/// Of each session's record; travels at 5 to 94 % of the greatest torque.
std::vector<LoopAnalysis> analyses_of(const std::vector<Session>& sessions) {
  LoopOptions options;
  options.travel_levels.clear();
  options.travel_levels.reserve(90);
  for (int k = 5; k < 95; ++k) options.travel_levels.push_back(0.01 * k);
  std::vector<LoopAnalysis> analyses;
  analyses.reserve(sessions.size());
  for (const Session& session : sessions) {
    analyses.push_back(analyse_loops(session.samples, options));
  }
  return analyses;
}

/// Whether a loop that is not measured at zero torque is so between its loading flanks.
bool tells_travel(const Loop& loop) {
  const bool zero_only = loop.outcome == LoopOutcome::kAtEdge ||
                         loop.outcome == LoopOutcome::kDependsOnFilter ||
                         loop.outcome == LoopOutcome::kZeroAmbiguous;
  return zero_only && !loop.travel.empty();
}

/// Places of the loops that are used, in order, each sample in one of them: those that are measured
/// at zero torque go first.
std::vector<std::size_t> used_places(const std::vector<Loop>& loops) {
  std::vector<std::size_t> places;
  const auto is_free = [&](const Loop& loop) {
    return std::ranges::all_of(places, [&](std::size_t other) {
      return loop.first_sample >= loops[other].last_sample ||
             loop.last_sample <= loops[other].first_sample;
    });
  };
  for (const bool at_zero : {true, false}) {
    for (std::size_t k = 0; k < loops.size(); ++k) {
      const bool usable =
          at_zero ? loops[k].outcome == LoopOutcome::kMeasured : tells_travel(loops[k]);
      if (usable && is_free(loops[k])) places.push_back(k);
    }
  }
  std::ranges::sort(places);
  return places;
}

void add_remedy(std::string_view remedy, LoopObservations& result) {
  if (!remedy.empty() && std::ranges::find(result.remedies, remedy) == result.remedies.end()) {
    result.remedies.emplace_back(remedy);
  }
}

/// What is left out of the loops of a session, with the reason.
void add_left_out(const std::string& session, const std::vector<Loop>& loops,
                  const std::vector<std::size_t>& places, LoopObservations& result) {
  std::vector<std::pair<LoopOutcome, std::vector<std::size_t>>> without_zero;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const LoopOutcome outcome = loops[k].outcome;
    if (outcome == LoopOutcome::kMeasured) continue;
    if (!tells_travel(loops[k])) {
      ++result.refused;
      result.notes.push_back(
          fmt::format("{}: loop {} left out: {}", session, k + 1, loop_outcome_text(outcome)));
      add_remedy(loop_outcome_remedy(outcome), result);
      continue;
    }
    if (std::ranges::find(places, k) == places.end()) continue;
    auto group =
        std::ranges::find_if(without_zero, [&](const auto& g) { return g.first == outcome; });
    if (group == without_zero.end()) group = without_zero.insert(group, {outcome, {}});
    group->second.push_back(k + 1);
  }
  for (const auto& [outcome, numbers] : without_zero) {
    result.notes.push_back(fmt::format(
        "{}: loop{} {}: test torque 0 left out, the travel under load is used: {}", session,
        numbers.size() == 1 ? "" : "s", fmt::join(numbers, ", "), loop_outcome_text(outcome)));
  }
}

/// The loops of all sessions that are used; what is left out is counted and named in `result`, and
/// what is used told by its sessions.
std::vector<UsedLoop> used_loops(const std::vector<Session>& sessions,
                                 const std::vector<LoopAnalysis>& analyses,
                                 LoopObservations& result) {
  std::vector<UsedLoop> used;
  result.sessions.reserve(sessions.size());
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    const LoopAnalysis& analysis = analyses[s];
    if (analysis.outcome != RecordOutcome::kLoops) {
      ++result.refused;
      result.notes.push_back(fmt::format("{}: no loop: {}", session_text(sessions[s]),
                                         record_outcome_text(analysis.outcome)));
      add_remedy(record_outcome_remedy(analysis.outcome), result);
      continue;
    }
    LoopSession found{.file = sessions[s].file,
                      .run = sessions[s].label,
                      .sun_locked = sessions[s].sun_locked,
                      .cutoff_Hz = analysis.cutoff_Hz,
                      .creep = analysis.creep};
    const std::vector<std::size_t> places = used_places(analysis.loops);
    found.loops.reserve(places.size());
    for (const std::size_t k : places) {
      const Loop& loop = analysis.loops[k];
      used.push_back({.session = &sessions[s], .loop = &loop, .record = &analysis});
      found.loops.push_back({.number = static_cast<int>(k) + 1, .loop = loop});
    }
    add_left_out(session_text(sessions[s]), analysis.loops, places, result);
    if (!found.loops.empty()) result.sessions.push_back(std::move(found));
  }
  return used;
}

/// Lost motion of one loop: at zero torque, then at the test torques of its reading.
/// @param scatter  of the row at zero torque, over that of the others
/// @param in_time  whether its rows have times of their own: within one loop nothing tells a drift
///     from what goes with the torque
std::vector<Observation> rows_of_loop(const UsedLoop& used, const LoopReading& reading,
                                      const FrictionShare& share, double scatter, bool in_time) {
  const Session& session = *used.session;
  const Loop& loop = *used.loop;
  const std::vector<double>& time_s = session.samples.time_s;
  const auto time_of = [&](double fall_sample, double rise_sample) {
    if (time_s.empty()) return kUnknown;
    return in_time ? mean_time(time_s, fall_sample, rise_sample) : time_s[loop.reversal_sample];
  };
  const auto sigma = [](double v) { return v > 0.0 ? std::sqrt(v) : kUnknown; };
  Observation row;
  row.condition.run = session.run;
  row.file = session.file;
  row.line = session.place[loop.first_sample];
  row.condition.time_s = time_of(loop.falling_zero_sample, loop.rising_zero_sample);
  row.response = reading.zero_rad - share.zero_rad;
  row.scatter = scatter;
  row.sigma = sigma(reading.zero_variance_rad2);
  std::vector<Observation> rows;
  rows.reserve(1 + reading.travel.size());
  if (reading.tells_zero) rows.push_back(row);
  row.scatter = 1.0;
  for (std::size_t k = 0; k < reading.travel.size(); ++k) {
    const TravelReading& travel = reading.travel[k];
    row.condition.test_torque_Nm = travel.torque_Nm;
    row.condition.time_s = time_of(travel.fall_sample, travel.rise_sample);
    row.response = travel.angle_rad + share.travel_rad[k];
    row.sigma = sigma(travel.variance_rad2);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

LoopObservations loop_observations(const std::vector<LockedShaftRecord>& records, double ratio) {
  if (!std::isfinite(ratio) || ratio == 0.0) {
    throw std::invalid_argument(
        fmt::format("loop_observations: ratio = {}, allowed: a finite number other than 0", ratio));
  }
  LoopObservations result;
  const std::vector<Session> sessions = sessions_of(records, ratio, result.runs);
  const std::vector<LoopAnalysis> analyses = analyses_of(sessions);
  const std::vector<UsedLoop> used = used_loops(sessions, analyses, result);
  result.measured = static_cast<int>(used.size());
  if (used.empty()) return result;

  double peak = std::numeric_limits<double>::infinity();
  for (const UsedLoop& u : used) peak = std::min(peak, peak_of(*u.loop));
  const std::vector<LoopReading> readings = readings_of(used, peak);
  const std::vector<FrictionShare> shares = shares_of(used, readings);
  for (std::size_t u = 0; u < used.size(); ++u) {
    const std::vector<double>& time_s = used[u].session->samples.time_s;
    if (!time_s.empty() && !(result.record_start_s <= time_s.front())) {
      result.record_start_s = time_s.front();
    }
    const double scatter = zero_scatter(*used[u].session, used, readings);
    const std::vector<Observation> rows =
        rows_of_loop(used[u], readings[u], shares[u], scatter, used.size() > 1);
    result.rows.insert(result.rows.end(), rows.begin(), rows.end());
  }
  const bool at_zero = std::ranges::any_of(readings, &LoopReading::tells_zero);
  result.notes.push_back(
      fmt::format("{} loop{} read as lost motion at test torques {:.4g} to {:.4g} N m", used.size(),
                  used.size() == 1 ? "" : "s", at_zero ? 0.0 : kTravelFractions.front() * peak,
                  kTravelFractions.back() * peak));
  if (std::string note = friction_note(shares); !note.empty()) {
    result.notes.push_back(std::move(note));
  } else if (!at_zero) {
    result.notes.push_back(
        "without test torque 0 friction is not told: the travel is less by what the flanks yield "
        "under it");
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
