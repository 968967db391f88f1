#include "calibrate/dynamic/motion_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrate/dynamic/motion_experiment.hpp"
#include "calibrate/dynamic/motion_holdout.hpp"
#include "calibrate/dynamic/window_fit.hpp"
#include "numerics/distributions.hpp"
#include "numerics/square.hpp"

namespace gear3k::calibrate {

namespace {

using Eigen::Index;
using numerics::square;

constexpr double kLeastProbability = 0.05;  // of an alternative that is told
constexpr double kImplausible = 20.0;       // times what is stated: no drive's, but a wrong unit

/// Causes that these data could show at all.
std::vector<std::size_t> possible_changes(const WindowSums& sums, const DriveParameters& stated) {
  std::vector<std::size_t> all;
  const bool lossless = stated.efficiency_forward == 1.0 && stated.efficiency_backward == 1.0;
  for (std::size_t k = 0; k < kDriveChanges; ++k) {
    if (lossless && k <= kDirectionChange) continue;
    if (fit_drive(sums, stated, {k}).determined) all.push_back(k);
  }
  return all;
}

/// All sets of one to three causes that the data fix and that can exist.
std::vector<DriveFit> all_fits(const WindowSums& sums, const DriveParameters& stated,
                               const std::vector<std::size_t>& causes) {
  std::vector<DriveFit> fits;
  const auto add = [&](const std::vector<std::size_t>& free) {
    DriveFit fit = fit_drive(sums, stated, free);
    if (fit.determined && fit.physical) fits.push_back(std::move(fit));
  };
  const std::size_t n = causes.size();
  for (std::size_t a = 0; a < n; ++a) {
    add({causes[a]});
    for (std::size_t b = a + 1; b < n; ++b) {
      add({causes[a], causes[b]});
      for (std::size_t c = b + 1; c < n; ++c) add({causes[a], causes[b], causes[c]});
    }
  }
  return fits;
}

double binomial(double n, double k) {
  double r = 1.0;
  for (double j = 1.0; j <= k; j += 1.0) r *= (n - k + j) / j;
  return r;
}

/// −2 log of the weight of a set: χ², BIC's price, and as many sets of its size share a prior.
double fit_score(const DriveFit& fit, const WindowSums& sums, double causes) {
  const auto k = static_cast<double>(fit.free.size());
  return fit.statistic + k * std::log(sums.degrees) + 2.0 * std::log(binomial(causes, k));
}

MotionEstimate estimate_of(const DriveFit& fit, std::size_t place, double degrees) {
  const auto at = static_cast<Index>(place);
  const double half =
      numerics::student_quantile(0.975, degrees) * std::sqrt(fit.covariance(at, at));
  const double value = fit.changes.at(fit.free[place]);
  return {.value = value, .low = value - half, .high = value + half};
}

std::size_t place_in(const DriveFit& fit, std::size_t cause) {
  return static_cast<std::size_t>(std::ranges::find(fit.free, cause) - fit.free.begin());
}
bool has(const DriveFit& fit, std::size_t cause) { return place_in(fit, cause) < fit.free.size(); }

/// The best set with another cause in an effect's place.
const DriveFit* replaced(const std::vector<DriveFit>& fits, const DriveFit& best,
                         std::size_t effect, std::size_t other) {
  std::vector<std::size_t> free = best.free;
  free[place_in(best, effect)] = other;
  std::ranges::sort(free);
  const auto at = std::ranges::find(fits, free, &DriveFit::free);
  return at == fits.end() ? nullptr : &*at;
}

struct ScoredFits {
  std::vector<DriveFit> fits;
  std::vector<double> weight;  ///< sum 1
  std::size_t best = 0;
};

ScoredFits scored(std::vector<DriveFit> fits, const WindowSums& sums, double causes) {
  ScoredFits r{.fits = std::move(fits), .weight = {}};
  double least = 0.0;
  for (std::size_t k = 0; k < r.fits.size(); ++k) {
    r.weight.push_back(fit_score(r.fits[k], sums, causes));
    if (k == 0 || r.weight[k] < least) {
      least = r.weight[k];
      r.best = k;
    }
  }
  double total = 0.0;
  for (double& w : r.weight) {
    w = std::exp(-0.5 * (w - least));
    total += w;
  }
  for (double& w : r.weight) w /= total;
  return r;
}

std::vector<MotionAlternative> alternatives_of(const ScoredFits& all, std::size_t effect,
                                               const std::vector<std::size_t>& causes,
                                               double degrees) {
  const DriveFit& best = all.fits[all.best];
  std::vector<MotionAlternative> found;
  // Among sets that differ in this place only.
  double total = 1.0;
  for (const std::size_t other : causes) {
    if (has(best, other)) continue;
    const DriveFit* fit = replaced(all.fits, best, effect, other);
    if (fit == nullptr) continue;
    const double statistic = fit->statistic - best.statistic;
    const double weight = std::exp(-0.5 * statistic);
    total += weight;
    found.push_back({.cause = other,
                     .estimate = estimate_of(*fit, place_in(*fit, other), degrees),
                     .statistic = statistic,
                     .probability = weight});
  }
  for (MotionAlternative& a : found) a.probability /= total;
  std::erase_if(found, [](const auto& a) { return a.probability < kLeastProbability; });
  std::ranges::sort(found, std::greater{}, &MotionAlternative::probability);
  return found;
}

MotionEffect effect_of(const ScoredFits& all, std::size_t cause,
                       const std::vector<std::size_t>& causes, const WindowSums& sums,
                       const DriveParameters& stated) {
  const DriveFit& best = all.fits[all.best];
  MotionEffect e{.cause = cause,
                 .estimate = estimate_of(best, place_in(best, cause), sums.degrees),
                 .alternatives = alternatives_of(all, cause, causes, sums.degrees)};
  std::vector<std::size_t> without = best.free;
  std::erase(without, cause);
  const double gain = fit_drive(sums, stated, without).statistic - best.statistic;
  e.delta_bic = gain - std::log(sums.degrees);
  e.p_value = numerics::f_upper_tail(std::max(0.0, gain), 1.0, sums.degrees);
  for (std::size_t k = 0; k < all.fits.size(); ++k) {
    if (has(all.fits[k], cause)) e.probability += all.weight[k];
  }
  return e;
}

/// Numbers of the drive with the others free: those of the changes are enough for all but η.
std::vector<MotionQuantity> quantities_of(const WindowSums& sums, const DriveParameters& stated) {
  // In place of the two changes of friction, with losses that may be 0, by 1/η_f and η_b.
  DriveParameters base = stated;
  base.efficiency_forward = std::min(base.efficiency_forward, 0.98);
  base.efficiency_backward = std::min(base.efficiency_backward, 0.98);
  std::vector<std::size_t> free{kLevelChange,         kDirectionChange,    kMotorCoulombChange,
                                kOutputCoulombChange, kMotorViscousChange, kOutputViscousChange,
                                kMotorInertiaChange,  kOutputInertiaChange};
  DriveFit fit = fit_drive(sums, base, free);
  std::size_t first = 2;
  if (!fit.determined) {
    // Where each flow has one sense, constant drags and the torque's offset are two numbers for
    // three: with one of them held the others are what they are.
    std::erase(free, kOutputCoulombChange);
    fit = fit_drive(sums, base, free);
    first = 4;
  }
  std::vector<MotionQuantity> all{
      {.name = "efficiency_forward", .unit = "", .stated = stated.efficiency_forward},
      {.name = "efficiency_backward", .unit = "", .stated = stated.efficiency_backward},
      {.name = "motor_coulomb", .unit = "Nm", .stated = stated.motor_coulomb_Nm},
      {.name = "output_coulomb", .unit = "Nm", .stated = stated.output_coulomb_Nm},
      {.name = "motor_viscous", .unit = "Nm s/rad", .stated = stated.motor_viscous_Nms},
      {.name = "output_viscous", .unit = "Nm s/rad", .stated = stated.output_viscous_Nms},
      {.name = "motor_inertia", .unit = "kg m2", .stated = stated.motor_inertia_kgm2},
      {.name = "output_inertia", .unit = "kg m2", .stated = stated.output_inertia_kgm2}};
  // Efficiencies stand in the coefficient of −T_L, whatever the others are.
  const double t = numerics::student_quantile(0.975, sums.degrees);
  for (std::size_t f = 0; f < 2; ++f) {
    double weight = 0.0, sum = 0.0;
    for (std::size_t k = 0; k < sums.groups.size(); ++k) {
      if ((sums.groups[k].flow > 0) != (f == 0)) continue;
      const auto own = own_coefficient(sums, 4 * k + 3);
      if (!own) continue;
      weight += 1.0 / own->variance;
      sum += own->value / own->variance;
    }
    if (!(weight > 0.0)) continue;
    const double h = sum / weight, half = t / std::sqrt(weight);
    if (!(half < 0.5) || !(h - half > 0.0 || f == 1)) continue;
    all[f].found =
        f == 0 ? MotionEstimate{.value = 1.0 / h, .low = 1.0 / (h + half), .high = 1.0 / (h - half)}
               : MotionEstimate{.value = h, .low = h - half, .high = h + half};
  }
  if (!fit.determined) return all;
  for (std::size_t k = first; k < all.size(); ++k) {
    const std::size_t place = k - (first == 2 ? 0 : 1);
    const MotionEstimate e = estimate_of(fit, place, sums.degrees);
    all[k].found = MotionEstimate{.value = all[k].stated + e.value,
                                  .low = all[k].stated + e.low,
                                  .high = all[k].stated + e.high};
  }
  return all;
}

double root_mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, values.size())));
}

void add_residuals(MotionDiagnosis& d, const DriveParameters& stated, const DriveChanges& changes) {
  const DriveParameters drive = changed_drive(stated, changes);
  for (const MotionWindow& w : d.rows) {
    d.baseline.push_back(window_residual(w, stated));
    d.extended.push_back(window_residual(w, drive));
  }
  d.baseline_Nm = root_mean(d.baseline);
  d.extended_Nm = root_mean(d.extended);
}

/// What the causes predict of windows that they were not fitted to.
void add_held_out(MotionDiagnosis& d, const DriveParameters& stated) {
  std::vector<std::size_t> causes;
  for (const MotionEffect& e : d.effects) causes.push_back(e.cause);
  std::ranges::sort(causes);
  d.held_out = hold_out(d.rows, stated, causes);
  const auto known =
      std::ranges::count_if(d.held_out.residual, [](double r) { return std::isfinite(r); });
  if (!d.held_out.blocks.empty() && known < std::ssize(d.rows)) {
    d.notes.push_back(fmt::format(
        "the errors held out are of {} of {} windows: without the others ({}) the rest does not "
        "fix the causes' numbers",
        known, d.rows.size(), d.held_out.blocks == "log" ? "whole logs" : "parts of the log"));
  }
}

bool flows_have_one_sense(const std::vector<MotionWindow>& windows) {
  constexpr double kShare = 0.02;  // of a flow's windows in its rarer sense
  for (const int flow : {1, -1}) {
    double all = 0.0, forward = 0.0;
    for (const MotionWindow& w : windows) {
      if (w.flow != flow) continue;
      all += 1.0;
      if (w.sense > 0) forward += 1.0;
    }
    if (all > 0.0 && std::min(forward, all - forward) > kShare * all) return false;
  }
  return true;
}

void tell_gaps(MotionDiagnosis& d, const WindowSums& sums, bool load) {
  if (d.windows[0] == 0 || d.windows[1] == 0) {
    d.notes.push_back(fmt::format(
        "the mesh's flow is {} throughout: the {} efficiency, and drag and inertia of one side "
        "apart from those of the other, cannot be known",
        d.windows[1] == 0 ? "forward" : "backward", d.windows[1] == 0 ? "backward" : "forward"));
  }
  if (!load) {
    d.notes.emplace_back(
        "no output torque is logged: losses show only by the inertia that they act on, and "
        "efficiencies apart from inertia and drag cannot be known");
  }
  if (std::ranges::none_of(sums.groups, &WindowGroup::both_senses)) {
    d.notes.emplace_back(
        "the output turns one way only: constant drag and an offset of the motor's torque are one, "
        "and the offset is taken to be 0");
  } else if (flows_have_one_sense(d.rows)) {
    d.notes.emplace_back(
        "each flow has one sense: the constant drags of both sides and an offset of the motor's "
        "torque are three numbers for two, and neither drag can be known; a load that pulls both "
        "ways, or logs with the load reversed, would tell");
  }
}

/// Without T_L inertia and drag of both sides make any coefficients: what acts by an inertia, or by
/// the torque's gain, has them as an alternative.
void doubt_without_load(MotionDiagnosis& d) {
  const bool by_inertia = std::ranges::any_of(d.effects, [](const MotionEffect& e) {
    const std::string_view id = kDriveCauses.at(e.cause).id;
    return id != "drag_constant" && id != "drag_viscous";
  });
  if (!by_inertia || d.verdict != MotionVerdict::kExplained) return;
  d.verdict = MotionVerdict::kAmbiguous;
  d.sides_as_well = true;
  d.notes.emplace_back(
      "inertia and drag of both sides, changed together, explain this log as well as the cause "
      "that is named: it is the simplest, and no more");
}

/// By which factor a cause makes a number of the drive greater or less; 1: not known.
double factor_of_stated(const MotionEffect& effect, const DriveParameters& stated,
                        double load_kgm2) {
  const double inertia = stated.motor_inertia_kgm2 + stated.output_inertia_kgm2 + load_kgm2;
  switch (effect.cause) {
    case kLevelChange:
      return std::abs(1.0 + effect.estimate.value);
    case kMotorInertiaChange:
    case kOutputInertiaChange:
      return inertia > 0.0 ? std::abs(effect.estimate.value) / inertia : 1.0;
    case kTorqueConstantChange: {
      const double gain = 1.0 + effect.estimate.value;
      return std::max(gain, 1.0 / gain);
    }
    default:
      return 1.0;
  }
}

/// No log is explained by a drive that cannot be the stated one.
void doubt_implausible(MotionDiagnosis& d, const DriveParameters& stated) {
  double load = 0.0;
  for (const MotionWindow& w : d.rows) load = std::max(load, w.load_kgm2);
  for (const MotionEffect& e : d.effects) {
    const double factor = factor_of_stated(e, stated, load);
    if (!(factor > kImplausible)) continue;
    d.verdict = MotionVerdict::kUnexplained;
    const DriveCause& cause = kDriveCauses.at(e.cause);
    d.notes.push_back(fmt::format(
        "{}{}{} would differ by a factor of {:.3g} from {}, allowed: at most {:g}; look at the "
        "units of the log (time_s is in seconds) and at the inertia that is stated",
        cause.id, cause.body.empty() ? "" : " of the side of the ", cause.body, factor,
        cause.id == "inertia" ? "all inertia that is stated to move" : "what is stated",
        kImplausible));
  }
}

/// Verdict and effects.  @returns the changes that explain
DriveChanges judge(MotionDiagnosis& d, const WindowSums& sums, const DriveParameters& stated,
                   const MotionDiagnoseOptions& options) {
  const std::vector<std::size_t> causes = possible_changes(sums, stated);
  const double null = fit_drive(sums, stated, {}).statistic;
  const FreeFit free = free_fit(sums);
  const auto misfit = [&](double statistic, double spent) {
    const double degrees = free.coefficients - spent;
    if (degrees < 1.0) return 1.0;
    return numerics::f_upper_tail(std::max(0.0, statistic - free.statistic) / degrees, degrees,
                                  sums.degrees);
  };
  std::vector<DriveFit> fits = all_fits(sums, stated, causes);
  double gain = 0.0;
  for (const DriveFit& fit : fits) {
    if (fit.free.size() == 1) gain = std::max(gain, null - fit.statistic);
  }
  const double single = numerics::f_upper_tail(gain, 1.0, sums.degrees);
  d.p_value = std::min(1.0, single * static_cast<double>(std::max<std::size_t>(1, causes.size())));
  d.lack_of_fit = misfit(null, 0.0);
  if (fits.empty() || (d.p_value >= options.false_discovery_rate && !d.leaves_something())) {
    return {};
  }
  const ScoredFits all = scored(std::move(fits), sums, static_cast<double>(causes.size()));
  const DriveFit& best = all.fits[all.best];
  for (const std::size_t cause : best.free) {
    d.effects.push_back(effect_of(all, cause, causes, sums, stated));
  }
  std::ranges::sort(d.effects, std::greater{}, &MotionEffect::delta_bic);
  d.lack_of_fit = misfit(best.statistic, static_cast<double>(best.free.size()));
  const bool doubtful =
      std::ranges::any_of(d.effects, [](const auto& e) { return !e.alternatives.empty(); });
  d.verdict = d.leaves_something() ? MotionVerdict::kUnexplained
              : doubtful           ? MotionVerdict::kAmbiguous
                                   : MotionVerdict::kExplained;
  return best.changes;
}

}  // namespace

std::optional<MotionDiagnosis> diagnose_motion(const MotionRecord& record,
                                               const DriveParameters& stated,
                                               const MotionDiagnoseOptions& options) {
  MotionDiagnosis result;
  DriveParameters drive = stated;
  // The flow of a sample depends on what is found: twice.
  for (int round = 0; round < 2; ++round) {
    MotionDiagnosis d;
    d.rows = motion_windows(record, drive);
    const std::optional<WindowSums> sums = window_sums(d.rows);
    if (!sums) return std::nullopt;
    for (const MotionWindow& w : d.rows) ++d.windows.at(w.flow > 0 ? 0U : 1U);
    d.correlation = sums->correlation;
    d.noise_Nm = sums->deviation_Nm;
    const DriveChanges changes = judge(d, *sums, stated, options);
    add_residuals(d, stated, changes);
    if (round == 1) add_held_out(d, stated);
    d.quantities = quantities_of(*sums, stated);
    const bool load = std::ranges::any_of(d.rows, [](const auto& w) { return w.term[3] != 0.0; });
    if (!load) doubt_without_load(d);
    doubt_implausible(d, stated);
    tell_gaps(d, *sums, load);
    if (round == 1 && d.verdict == MotionVerdict::kAmbiguous) {
      d.next = next_motion(d, *sums, stated, changes);
    }
    drive = changed_drive(stated, changes);
    d.drive = drive;
    result = std::move(d);
  }
  return result;
}

}  // namespace gear3k::calibrate
