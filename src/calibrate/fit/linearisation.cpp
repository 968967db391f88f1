#include "calibrate/fit/linearisation.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <span>
#include <utility>

#include "numerics/parallel.hpp"

namespace gear3k::calibrate {

namespace {

constexpr int kSlots = kSlotsBesideLevel;

/// Candidates that one pass of derivatives carries.
struct Pass {
  /// As many parameters of a candidate as the pass had room for.
  struct Part {
    std::size_t candidate;
    std::vector<Scalar> values;  ///< of all its parameters: 0, the part's with a slot each
    Eigen::Index first, count;   ///< of the candidate's parameters
    int slot;                    ///< of the first
  };
  std::vector<Part> parts;
  int used = 0;

  bool add(const std::vector<Candidate>& candidates, std::size_t k, Eigen::Index first,
           Eigen::Index count) {
    const Candidate& candidate = candidates[k];
    const bool clash =
        candidate.cause->exclusive_forms && std::ranges::any_of(parts, [&](const Part& other) {
          return candidates[other.candidate].cause == candidate.cause;
        });
    if (clash || used + count > kSlots) return false;
    std::vector<Scalar> p(candidate.parameters.size(), Scalar(0.0));
    for (Eigen::Index j = 0; j < count; ++j) {
      p[static_cast<std::size_t>(first + j)] = Scalar(0.0, used + static_cast<int>(j));
    }
    parts.push_back(
        {.candidate = k, .values = std::move(p), .first = first, .count = count, .slot = used});
    used += static_cast<int>(count);
    return true;
  }
};

/// Passes that together carry all candidates of a place.
std::vector<Pass> make_passes(const std::vector<Candidate>& candidates, Place place) {
  std::vector<Pass> passes;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    // A friction that differs by row is read row by row, whatever the cause.
    const Place own =
        changes_row_friction(candidates[k]) ? Place::kMeasurement : place_of(candidates[k]);
    if (own != place) continue;
    const auto all = static_cast<Eigen::Index>(candidates[k].parameters.size());
    for (Eigen::Index first = 0; first < all; first += kSlots) {
      const Eigen::Index count = std::min<Eigen::Index>(kSlots, all - first);
      const bool found =
          std::ranges::any_of(passes, [&](Pass& p) { return p.add(candidates, k, first, count); });
      if (found) continue;
      passes.emplace_back();
      passes.back().add(candidates, k, first, count);
    }
  }
  return passes;
}

/// The gearbox under a hypothesis, in any row.
Modification gearbox_under(const Simulation& simulation, const Hypothesis& h,
                           const std::vector<Scalar>& values) {
  Modification m = simulation.unmodified({});
  apply(h, values, {}, simulation.kind(), m);
  return m;
}

void apply_pass(const Pass& pass, const std::vector<Candidate>& others, const Condition& condition,
                Kind kind, Modification& m) {
  for (const Pass::Part& part : pass.parts) {
    const Candidate& c = others[part.candidate];
    c.cause->apply(c.form, part.values, condition, kind, m);
  }
}

/// What rows are read under, one after the other.  A gearbox with its derivatives is some thousand
/// bytes, which no row changes: it is kept from row to row.
class RowReadings {
 public:
  /// @param h, values  must outlive this
  RowReadings(const Simulation& simulation, const Hypothesis& h, std::span<const Scalar> values)
      : simulation_(simulation), h_(h), values_(values) {}

  /// Until the next row.
  const Modification& under(const Condition& condition) {
    start(condition, row_);
    apply_to_reading(h_, values_, condition, simulation_.kind(), row_);
    return row_;
  }
  /// The same with candidates more.
  const Modification& with(const Pass& pass, const std::vector<Candidate>& others,
                           const Condition& condition) {
    if (is_kept()) {
      static_cast<ReadingChange&>(more_) = static_cast<const ReadingChange&>(row_);
    } else {
      more_ = row_;
    }
    apply_pass(pass, others, condition, simulation_.kind(), more_);
    return more_;
  }

 private:
  /// Whether readings leave the gearbox alone: models bring their own, and losses of pairs are read
  /// under all of it.
  [[nodiscard]] bool is_kept() const {
    return !simulation_.has_models() && simulation_.kind() != Kind::kPairLoss;
  }
  void start(const Condition& condition, Modification& m) const {
    if (is_kept()) {
      static_cast<ReadingChange&>(m) = {};
    } else {
      m = simulation_.unmodified(condition);
    }
  }

  const Simulation& simulation_;
  const Hypothesis& h_;
  std::span<const Scalar> values_;
  Modification row_, more_;
};

/// Levels of friction that a hypothesis gives the rows, or a model under the simulation.
LevelRange levels_of(const Problem& problem, const Hypothesis& h) {
  LevelRange levels;
  const bool by_row = std::ranges::any_of(h.effects, changes_row_friction);
  if (!problem.simulation.has_models() && !by_row) return levels;
  const auto constants = constants_of(h.value);
  RowReadings readings(problem.simulation, h, constants);
  for (const Observation& row : problem.data.rows) {
    const double level = readings.under(row.condition).friction_level.a;
    if (level != 1.0) levels.include(level);
  }
  // A hypothesis at 1 has derivatives by the level all the same.
  if (by_row) levels.include(1.0);
  return levels;
}

/// @param work  of a row, by its place in the data and in a vector of all, with what it is read
/// under
template <class Work>
void for_rows(const Problem& problem, const Hypothesis& h, std::span<const Scalar> values,
              const Work& work) {
  constexpr std::size_t kChunk = 512;
  const std::size_t n = problem.data.rows.size();
  const auto of_chunk = [&](std::size_t chunk) {
    RowReadings readings(problem.simulation, h, values);
    const std::size_t first = chunk * kChunk;
    for (std::size_t row = first; row < std::min(n, first + kChunk); ++row) {
      work(row, static_cast<Eigen::Index>(row), readings);
    }
  };
  numerics::parallel_for((n + kChunk - 1) / kChunk, of_chunk, n > kManyRows);
}

/// The derivatives of all rows by what may be added to a hypothesis, each at 0.
/// @param first_column  of each candidate in the result
Eigen::MatrixXd derivatives_by(const std::vector<Candidate>& others,
                               const std::vector<Eigen::Index>& first_column,
                               const Problem& problem, const Hypothesis& h, Eigen::Index columns) {
  const Simulation& simulation = problem.simulation;
  const Kind kind = simulation.kind();
  const LevelRange levels = levels_of(problem, h);
  const auto constants = constants_of(h.value);
  const auto in_gearbox = make_passes(others, Place::kGearbox);
  const auto in_reading = make_passes(others, Place::kMeasurement);
  const Modification known = gearbox_under(simulation, h, constants);
  LevelRange with_others = levels;
  if (std::ranges::any_of(others, changes_row_friction)) with_others.include(1.0);
  const LevelledResponses plain(problem.states, simulation, known, with_others);
  std::vector<LevelledResponses> of_pass;
  of_pass.reserve(in_gearbox.size());
  for (const Pass& pass : in_gearbox) {
    Modification m = known;
    apply_pass(pass, others, {}, kind, m);
    of_pass.emplace_back(problem.states, simulation, m, levels);
  }
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(problem.data.rows.size()), columns);
  for_rows(problem, h, constants, [&](std::size_t row, Eigen::Index i, RowReadings& readings) {
    const Condition& condition = problem.data.rows[row].condition;
    const auto store = [&](const Pass& pass, const Scalar& y) {
      for (const Pass::Part& part : pass.parts) {
        result.row(i).segment(first_column[part.candidate] + part.first, part.count) =
            y.v.segment(part.slot, part.count).transpose();
      }
    };
    const Modification& reading = readings.under(condition);
    for (std::size_t k = 0; k < in_gearbox.size(); ++k) {
      const auto response = of_pass[k].of_row(row, reading.friction_level.a);
      if (!response) continue;
      const Scalar under = response->at(reading.friction_level, true);
      // Of pairs a loss beside the mesh is read with it.
      const bool of_pairs = kind == Kind::kPairLoss;
      const Modification& m = of_pairs ? readings.with(in_gearbox[k], others, condition) : reading;
      store(in_gearbox[k], simulation.reading(under, condition, m));
    }
    for (const Pass& pass : in_reading) {
      const Modification& m = readings.with(pass, others, condition);
      const auto response = plain.of_row(row, m.friction_level.a);
      if (!response) continue;
      store(pass, simulation.reading(response->at(m.friction_level, false), condition, m));
    }
  });
  return result;
}

}  // namespace

Eigen::VectorXd measured(const MeasurementSet& data) {
  Eigen::VectorXd y(static_cast<Eigen::Index>(data.rows.size()));
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    y[static_cast<Eigen::Index>(i)] = data.rows[i].response;
  }
  return y;
}

NearbyRows::NearbyRows(const Problem& problem, Hypothesis about, double room)
    : problem_(&problem), about_(std::move(about)), levels_(levels_of(problem, about_)) {
  if (levels_.varies()) {
    levels_.log_low -= room;
    levels_.log_high += room;
  }
  std::size_t k = 0;
  for (const Candidate& c : about_.effects) {
    const bool acts = place_of(c) == Place::kGearbox && !changes_row_friction(c);
    for (std::size_t j = 0; j < c.parameters.size(); ++j, ++k) {
      if (acts) acting_.push_back(k);
    }
  }
  // As many parameters at a time as there are slots.
  for (std::size_t first = 0; first == 0 || first < acting_.size(); first += kSlots) {
    auto variables = constants_of(about_.value);
    for (std::size_t j = first; j < std::min<std::size_t>(first + kSlots, acting_.size()); ++j) {
      variables[acting_[j]] = Scalar(about_.value[acting_[j]], static_cast<int>(j - first));
    }
    gearbox_.emplace_back(problem.states, problem.simulation,
                          gearbox_under(problem.simulation, about_, variables), levels_,
                          MissingRow::kEndsAll);
  }
}

bool NearbyRows::is_exact_at(const std::vector<double>& value) const {
  return std::ranges::all_of(acting_, [&](std::size_t k) { return value[k] == about_.value[k]; });
}

Linearisation NearbyRows::at(const std::vector<double>& value) const {
  const Simulation& simulation = problem_->simulation;
  const auto n = static_cast<Eigen::Index>(problem_->data.rows.size());
  const auto parameters = static_cast<Eigen::Index>(value.size());
  const Eigen::VectorXd change = change_in_gearbox(value);
  Linearisation result{.simulated = Eigen::VectorXd::Zero(n),
                       .own = Eigen::MatrixXd::Zero(n, parameters),
                       .other = {}};
  std::atomic<bool> all_run = true;
  // As many parameters at a time as there are slots.
  for (std::size_t first = 0; first == 0 || first < value.size(); first += kSlots) {
    const std::size_t end = std::min<std::size_t>(first + kSlots, value.size());
    for_rows(*problem_, about_, variables_of(value, first, kSlots),
             [&](std::size_t row, Eigen::Index i, RowReadings& readings) {
               const Condition& condition = problem_->data.rows[row].condition;
               const Modification& reading = readings.under(condition);
               auto response = response_of(row, reading.friction_level, first, end);
               if (!response) {
                 all_run = false;
                 return;
               }
               response->a += change[i];
               const Scalar y = simulation.reading(*response, condition, reading);
               result.simulated[i] = y.a;
               const auto count = static_cast<Eigen::Index>(end - first);
               if (count == 0) return;  // a matrix without columns has no rows to point at
               result.own.row(i).segment(static_cast<Eigen::Index>(first), count) =
                   y.v.head(count).transpose();
             });
  }
  result.runs = all_run;
  return result;
}

std::optional<Scalar> NearbyRows::response_of(std::size_t row, const Scalar& level,
                                              std::size_t first, std::size_t end) const {
  if (!levels_.holds(level.a)) return std::nullopt;
  std::optional<Scalar> result;
  for (std::size_t block = 0; block < gearbox_.size(); ++block) {
    const auto acting = acting_of_block(block);
    const bool counts =
        std::ranges::any_of(acting, [&](std::size_t k) { return k >= first && k < end; });
    if (block > 0 && !counts) continue;
    const auto response = gearbox_[block].of_row(row, level.a);
    if (!response) return std::nullopt;
    if (!result) result = response->at(level, false);
    for (std::size_t j = 0; j < acting.size(); ++j) {
      const std::size_t k = acting[j];
      if (k < first || k >= end) continue;
      result->v[static_cast<Eigen::Index>(k - first)] +=
          response->by_gearbox[static_cast<Eigen::Index>(j)];
    }
  }
  return result;
}

std::span<const std::size_t> NearbyRows::acting_of_block(std::size_t block) const {
  const std::size_t first = block * kSlots;
  return std::span(acting_).subspan(first, std::min<std::size_t>(kSlots, acting_.size() - first));
}

Eigen::VectorXd NearbyRows::change_in_gearbox(const std::vector<double>& value) const {
  Eigen::VectorXd change =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem_->data.rows.size()));
  if (is_exact_at(value)) return change;
  const auto constants = constants_of(value);
  for_rows(*problem_, about_, constants,
           [&](std::size_t row, Eigen::Index i, RowReadings& readings) {
             const Modification& reading = readings.under(problem_->data.rows[row].condition);
             for (std::size_t block = 0; block < gearbox_.size(); ++block) {
               const auto response = gearbox_[block].of_row(row, reading.friction_level.a);
               if (!response) continue;
               const auto acting = acting_of_block(block);
               for (std::size_t j = 0; j < acting.size(); ++j) {
                 change[i] += response->by_gearbox[static_cast<Eigen::Index>(j)] *
                              (value[acting[j]] - about_.value[acting[j]]);
               }
             }
           });
  return change;
}

WhitenedRows NearbyRows::whitened_at(const std::vector<double>& value) const {
  Linearisation at = this->at(value);
  Eigen::MatrixXd columns(at.own.rows(), at.own.cols() + 1);
  columns << measured(problem_->data) - at.simulated, at.own;
  problem_->noise.whiten(columns);
  return {.residual = columns.col(0),
          .jacobian = columns.rightCols(at.own.cols()),
          .simulated = std::move(at.simulated),
          .runs = at.runs};
}

Linearisation linearise(const Problem& problem, const Hypothesis& hypothesis,
                        const std::vector<Candidate>& others) {
  Linearisation result = NearbyRows(problem, hypothesis).at(hypothesis.value);
  Eigen::Index columns = 0;
  std::vector<Eigen::Index> first_column;
  first_column.reserve(others.size());
  for (const Candidate& c : others) {
    first_column.push_back(columns);
    columns += static_cast<Eigen::Index>(c.parameters.size());
  }
  result.other = others.empty()
                     ? Eigen::MatrixXd::Zero(result.own.rows(), 0)
                     : derivatives_by(others, first_column, problem, hypothesis, columns);
  return result;
}

WhitenedRows whitened_rows(const Problem& problem, const Hypothesis& h) {
  return NearbyRows(problem, h).whitened_at(h.value);
}

}  // namespace gear3k::calibrate
