#include "calibrate/verdict/unexplained.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "calibrate/laws/law_result.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/verdict/noise_level.hpp"

namespace gear3k::calibrate {

namespace {

constexpr std::string_view kMinorRemainder = "the causes leave a structure that no noise makes, ";

/// Share of what a term takes off the squares that causes must take off to be most of it: a term of
/// levels holds what all rows have in common as well, and would put out the plainest cause.
constexpr double kMostOfIt = 2.0 / 3.0;

/// Whether an effect is most of what the best empirical term does, or the data need it once the
/// term is there.
bool stays_beside(const Columns& fitted, const Hypothesis& h, std::size_t effect,
                  const EmpiricalTerm& term, double threshold) {
  const auto first = static_cast<Eigen::Index>(value_offset(h, effect));
  const auto count = static_cast<Eigen::Index>(h.effects[effect].parameters.size());
  const Eigen::MatrixXd& own = fitted.own;
  const Eigen::MatrixXd mine = own.middleCols(first, count);
  Eigen::MatrixXd rest(own.rows(), own.cols() - count + term.columns.cols());
  rest << own.leftCols(first), own.rightCols(own.cols() - first - count), term.columns;
  // The residual of the model without the effect, along the linearisation.
  Eigen::VectorXd without_it = fitted.residual;
  for (Eigen::Index k = 0; k < count; ++k) {
    without_it += mine.col(k) * h.value[static_cast<std::size_t>(first + k)];
  }
  const auto gain = [&](const Eigen::MatrixXd& beside, const Eigen::MatrixXd& columns) {
    return Screen(beside, columns, {{.first = 0, .count = columns.cols()}}, 0.0)
        .gains(without_it)[0];
  };
  const Eigen::MatrixXd others = rest.leftCols(own.cols() - count);
  return gain(rest, mine).evidence > threshold ||
         gain(others, mine).sum_of_squares >= kMostOfIt * gain(others, term.columns).sum_of_squares;
}

/// Squares of the baseline's residual and of what the causes leave of it.  Rows far off count as
/// less far, and so does what the causes take off them: a term has the same to explain.
struct Squares {
  double before = 0.0, after = 0.0;
};
Squares squares_of(const Columns& base, const Columns& fitted) {
  const double bound = robust_deviation(base.raw);
  const Eigen::VectorXd clipped = winsorised(base.raw, bound);
  return {.before = clipped.squaredNorm(),
          .after = (clipped - winsorised(base.raw - fitted.raw, bound)).squaredNorm()};
}

/// Evidence of all causes of a fit together, paid for by the number of causes that each was chosen
/// from.
double evidence_of_causes(const SearchResult& found, const Columns& base, const Columns& fitted) {
  const auto [before, after] = squares_of(base, fitted);
  const auto n = static_cast<double>(base.residual.size());
  const auto p = static_cast<Eigen::Index>(found.fit.hypothesis.value.size());
  const double statistic = (n - static_cast<double>(p)) * std::log(std::max(before / after, 1.0));
  std::set<const Cause*> offered;
  for (const Candidate& c : found.candidates) offered.insert(c.cause);
  return chi_square_evidence(statistic, p) -
         static_cast<double>(found.effects.size()) * std::log(static_cast<double>(offered.size()));
}

/// Whether the causes take off at least a share of the squares that a term takes off.
bool take_share_of(const EmpiricalTerm& term, double share, const Columns& base,
                   const Columns& fitted) {
  const auto [before, after] = squares_of(base, fitted);
  const Eigen::VectorXd clipped = winsorised(base.raw, robust_deviation(base.raw));
  return before - after >=
         share * (orthonormal_basis(term.columns).transpose() * clipped).squaredNorm();
}

/// Twelfths of a wave, as levels.
Levels sectors_of(const MeasurementSet& data, const EmpiricalTerm& term) {
  constexpr int kSectors = 12;
  Levels sectors{
      .name = term.along, .of = std::vector<int>(data.rows.size(), -1), .count = kSectors};
  for (int k = 0; k < kSectors; ++k) sectors.at.push_back(360.0 * (k + 0.5) / kSectors);
  const std::vector<double> times = reading_times(data);
  const ValueRange time = range_of(times);
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const Condition& c = data.rows[i].condition;
    const double turn = term.along == "time"
                            ? term.order * (times[i] - time.low) / (time.high - time.low)
                            : term.order * c.output_angle_rad / (2.0 * std::numbers::pi);
    if (!std::isfinite(turn)) continue;
    sectors.of[i] = std::min(static_cast<int>((turn - std::floor(turn)) * kSectors), kSectors - 1);
  }
  return sectors;
}

}  // namespace

Contest causes_against_structure(const SearchResult& found, const Columns& base,
                                 const Columns& fitted, const RemainderSearch& before,
                                 const RemainderSearch& after, double rate) {
  const Hypothesis& h = found.fit.hypothesis;
  const std::size_t count = h.effects.size();
  Contest contest{.structure = after.p_value <= rate,
                  .stays = std::vector<bool>(count, true),
                  .remainder = after};
  for (std::size_t e = 0; contest.structure && e < count; ++e) {
    contest.stays[e] = stays_beside(fitted, h, e, after.best, found.first_luck.threshold);
  }
  // Where nothing is left beside causes of nearly the same evidence, they and the term say the
  // same.
  constexpr double kClearly = 3.0, kNearly = 0.1;
  const double clearly =
      contest.structure ? kClearly : std::max(kClearly, kNearly * before.best.evidence);
  // Causes that leave no structure and take off all that the term does leave it nothing to explain.
  const double enough = contest.structure ? kMostOfIt : 1.0;
  if (count > 0 && before.p_value <= rate && !take_share_of(before.best, enough, base, fitted) &&
      before.best.evidence > evidence_of_causes(found, base, fitted) + clearly) {
    contest = {.structure = true, .stays = std::vector<bool>(count, false), .remainder = before};
  }
  return contest;
}

void describe_shape(const Problem& problem, const Columns& columns, const EmpiricalTerm& term,
                    const std::vector<Levels>& levels, const Eigen::VectorXd& residual,
                    Remainder& remainder) {
  remainder.along = term.along;
  remainder.order = term.order;
  // Beside the fit: what of the term no effect takes.
  const Eigen::MatrixXd basis =
      orthonormal_basis(free_of(orthonormal_basis(columns.own), term.columns));
  Eigen::VectorXd fitted = basis * (basis.transpose() * columns.residual);
  remainder.share = fitted.squaredNorm() / columns.residual.squaredNorm();
  fitted = fitted.cwiseQuotient(problem.noise.weight);
  Levels by;
  if (term.order > 0.0) {
    by = sectors_of(problem.data, term);
  } else {
    const auto found = std::ranges::find(levels, term.along, &Levels::name);
    if (found == levels.end()) return;
    by = *found;
  }
  const auto count = static_cast<std::size_t>(by.count);
  remainder.at = by.at;
  remainder.mean.assign(count, 0.0);
  remainder.term.assign(count, 0.0);
  remainder.rows.assign(count, 0);
  for (std::size_t i = 0; i < by.of.size(); ++i) {
    if (by.of[i] < 0) continue;
    const auto level = static_cast<std::size_t>(by.of[i]);
    remainder.mean[level] += residual[static_cast<Eigen::Index>(i)];
    remainder.term[level] += fitted[static_cast<Eigen::Index>(i)];
    ++remainder.rows[level];
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (remainder.rows[k] == 0) continue;
    remainder.mean[k] /= remainder.rows[k];
    remainder.term[k] /= remainder.rows[k];
  }
}

Remainder structure_of(const Problem& problem, const FoundLaw& law,
                       const std::vector<Levels>& levels) {
  EmpiricalTerm term{.along = covariate_of(law.law), .columns = law.change};
  problem.noise.whiten(term.columns);
  if (record_of(law.law.factors.front().shape).turns) {
    // Amplitude, perhaps an offset, then the order.
    const std::size_t own = parameters_of(law.law, problem.data.kind).size();
    term.order = law.hypothesis.value[law.hypothesis.value.size() - own + (law.law.offset ? 2 : 1)];
  }
  Remainder remainder;
  remainder.significant = true;
  remainder.p_value = law.p_value;
  const Hypothesis causes =
      fit(problem, without(law.hypothesis, law.hypothesis.effects.size() - 1), law.scale)
          .hypothesis;
  const Columns columns = columns_at(problem, causes, {}, law.scale);
  describe_shape(problem, columns, term, levels,
                 measured(problem.data) - linearise(problem, causes, {}).simulated, remainder);
  return remainder;
}

namespace {

/// Squares of the baseline's residual beyond noise: what there is to explain.  Rows far off count
/// as less far.
double discrepancy_of(const Columns& before, double scale) {
  const double squares = winsorised(before.raw, robust_deviation(before.raw)).squaredNorm();
  return std::max(0.0, squares - static_cast<double>(before.raw.size()) * scale * scale);
}

/// Share of the discrepancy's squares from which on structure beside causes matters.
constexpr double kLeastOfDiscrepancy = 0.02;

/// Whether rows as they are keep more than noise makes, and more than a law of slightly another
/// shape leaves.
bool keeps_much(const LeftOver& left) {
  constexpr double kBeyondNoise = 1.5 * 1.5;
  const double beyond = left.missed_by_effects - left.noise;
  return left.missed_by_effects > kBeyondNoise * left.noise &&
         beyond > kLeastOfDiscrepancy * (left.missed - left.noise);
}

/// Whether a covariate says at what state the gearbox was, and not when or by what it was measured.
/// Not load, speed and direction: a step that acts on something else than it is said to leaves
/// structure along these.
bool is_of_state(const std::string& along) {
  return along == "temperature" || along == "test torque" || along == "driving teeth" ||
         along == "driven teeth";
}

/// A standard deviation is misstated by less than this: rows that scatter by more differ in what
/// the data do not state.
constexpr double kMostMisstated = 3.0;

/// Whether readings go together as no sensor's do: beyond the scatter that is stated that is
/// something that changes, along nothing that the data state.
bool changes_slowly(const NoiseModel& noise) {
  constexpr double kMostOfSensors = 0.8;
  return noise.remembers() && noise.memory.correlation() > kMostOfSensors;
}

}  // namespace

double mean_square_as_read(const NoiseModel& noise, const Eigen::VectorXd& missed) {
  const Eigen::VectorXd over = missed.cwiseProduct(noise.weight);
  return winsorised(over, robust_deviation(over)).squaredNorm() / static_cast<double>(over.size());
}

std::optional<std::string> settle(Contest& contest, const NoiseModel& noise, const LeftOver& left,
                                  const Columns& before, double rate, bool has_causes) {
  double scale = left.scale;
  if (const double chance = chance_of_scatter(noise, left.whitened, left.degrees);
      !contest.structure && chance <= rate &&
      (noise.known_scale() > 0.0 || changes_slowly(noise) || left.scale > kMostMisstated)) {
    contest = {.structure = true, .stays = {}, .remainder = {}};
    contest.remainder.p_value = chance;
    // Beyond the scatter that is stated, not the one that these rows have.
    scale = 1.0;
    contest.remainder.best.statistic =
        winsorised(left.whitened, robust_deviation(left.whitened)).squaredNorm() - left.degrees;
  }
  if (!contest.structure || !has_causes) return std::nullopt;
  const double squares = contest.remainder.best.statistic * scale * scale;
  const double discrepancy = discrepancy_of(before, scale);
  if (squares >= kLeastOfDiscrepancy * discrepancy || keeps_much(left) ||
      (left.of_time_alone && is_of_state(contest.remainder.best.along))) {
    return std::nullopt;
  }
  contest.structure = false;
  return fmt::format(
      "{}{:.1f} % of the squares of the discrepancy: a law of slightly another shape",
      kMinorRemainder, 100.0 * squares / discrepancy);
}

bool tells_of_minor_remainder(const std::string& note) { return note.starts_with(kMinorRemainder); }

}  // namespace gear3k::calibrate
