#include "calibrate/laws/law_data.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "calibrate/fit/screen.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/row_selection.hpp"
#include "calibrate/measurement/value_range.hpp"

namespace gear3k::calibrate {

namespace {

/// From here on so many rows, chosen at random, must do for the search.
constexpr std::size_t kMostRowsOfLaw = 1500;

/// The rows that the search looks at.
std::vector<std::size_t> searched_rows(std::size_t count) {
  std::vector<std::size_t> rows(count);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  if (count <= kMostRowsOfLaw) return rows;
  RandomBits random(1);
  for (std::size_t k = 0; k < kMostRowsOfLaw; ++k) {
    std::swap(rows[k], rows[k + random.next() % (count - k)]);
  }
  rows.resize(kMostRowsOfLaw);
  std::ranges::sort(rows);
  return rows;
}

}  // namespace

LawData law_data(const Problem& problem, const Hypothesis& hypothesis, LawScope scope) {
  LawData d;
  d.scope = scope;
  d.rows = searched_rows(problem.data.rows.size());
  d.data = select_rows(problem.data, d.rows);
  d.data.covariates.clear();
  d.noise = subset_of(problem.noise, d.rows);
  const Problem part{.simulation = problem.simulation, .data = d.data, .noise = d.noise};
  const Linearisation at = linearise(part, hypothesis, {});
  d.simulated = at.simulated;
  Eigen::MatrixXd columns(d.simulated.size(), at.own.cols() + 1);
  columns << measured(d.data) - d.simulated, at.own;
  d.noise.whiten(columns);
  d.residual = columns.col(0);
  d.own = columns.rightCols(at.own.cols());
  d.own_basis = orthonormal_basis(d.own);
  d.si = response_unit(d.data.kind).si;
  return d;
}

std::vector<Eigen::Index> rows_of(const LawData& d, const Blocks& all, int block, bool inside) {
  std::vector<Eigen::Index> result;
  for (std::size_t k = 0; k < d.rows.size(); ++k) {
    if ((all.of[d.rows[k]] == block) == inside) result.push_back(static_cast<Eigen::Index>(k));
  }
  return result;
}

double law_change(LawAction action, const Condition& c, double response, double si) {
  return law_weight(action, c, response) * (is_share(action) ? 1.0 : si);
}

Eigen::VectorXd channel_weights(const LawData& d, LawAction action, LawRows rows) {
  Eigen::VectorXd w(d.simulated.size());
  const Law law{.action = action, .rows = rows, .factors = {}};
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    const Condition& c = d.data.rows[static_cast<std::size_t>(i)].condition;
    w[i] = acts_in(law, c) ? law_change(action, c, d.simulated[i], d.si) : 0.0;
  }
  return w;
}

namespace {

/// The value of a law at its conditions, as many as factors.
double value_at(const Law& law, const std::vector<double>& x, const double* p) {
  double product = p[0];
  const double* of_factor = p + (law.offset ? 2 : 1);
  for (std::size_t f = 0; f < law.factors.size(); ++f) {
    product *= factor_value(law.factors[f], x[f], of_factor);
    of_factor += parameter_count(law.factors[f].shape);
  }
  return product + (law.offset ? p[1] : 0.0);
}

}  // namespace

bool exceeds_its_rows(const LawData& d, const LawTrial& trial, double inside) {
  const Law& law = trial.law;
  const double* p = trial.value.data() + own_size(trial);
  std::set<std::vector<double>> states;
  std::vector<ValueRange> range(law.factors.size());
  ValueRange held;
  // Where a law does not act it is 0.
  held.extend(0.0);
  for (const Observation& row : d.data.rows) {
    if (!acts_in(law, row.condition)) continue;
    std::vector<double> x;
    for (std::size_t f = 0; f < law.factors.size(); ++f) {
      x.push_back(law_conditions()[law.factors[f].condition].value(row.condition));
      range[f].extend(x.back());
    }
    held.extend(value_at(law, x, p));
    states.insert(std::move(x));
  }
  constexpr double kBeyond = 1.0;
  constexpr int kPlaces = 48;
  const double width = held.high - held.low;
  for (const std::vector<double>& state : states) {
    for (std::size_t f = 0; f < state.size(); ++f) {
      const double span = range[f].high - range[f].low;
      std::vector<double> x = state;
      for (int k = 0; k <= kPlaces; ++k) {
        const double share = -kLawReach + (1.0 + 2.0 * kLawReach) * k / kPlaces;
        x[f] = range[f].low + share * span;
        const LawCondition& condition = law_conditions()[law.factors[f].condition];
        if (x[f] < 0.0 && condition.natural_zero && !(condition.turn > 0.0)) continue;
        const double v = value_at(law, x, p);
        const double most = width * (share < 0.0 || share > 1.0 ? kBeyond : inside);
        if (!(v >= held.low - most && v <= held.high + most)) return true;
      }
    }
  }
  return false;
}

Eigen::VectorXd left_by_own(const LawData& d) {
  Eigen::VectorXd left = d.residual;
  if (d.own_basis.cols() > 0) left -= d.own_basis * (d.own_basis.transpose() * left);
  return left;
}

int law_cost(const Law& law) {
  int count = law.offset ? 2 : 1;
  for (const LawFactor& f : law.factors) {
    count += parameter_count(f.shape) + (record_of(f.shape).constant.empty() ? 0 : 1);
  }
  return count;
}

int fitted_count(const Law& law) {
  int count = law.offset ? 2 : 1;
  for (const LawFactor& f : law.factors) count += parameter_count(f.shape);
  return count;
}

Eigen::Index own_size(const LawTrial& t) {
  return static_cast<Eigen::Index>(t.value.size()) - fitted_count(t.law);
}

}  // namespace gear3k::calibrate
