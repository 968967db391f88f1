#include "calibrate/laws/law_fit.hpp"

#include <algorithm>
#include <cmath>

#include "calibrate/fit/screen.hpp"
#include "calibrate/laws/law_forms.hpp"
#include "numerics/linear_algebra.hpp"

namespace gear3k::calibrate {

std::size_t first_value(const LawTrial& t, std::size_t factor) {
  std::size_t at = static_cast<std::size_t>(own_size(t)) + (t.law.offset ? 2 : 1);
  for (std::size_t f = 0; f < factor; ++f) {
    at += static_cast<std::size_t>(parameter_count(t.law.factors[f].shape));
  }
  return at;
}

LawFit::At LawFit::at(const LawTrial& t) const {
  const auto own = d_.own.cols();
  const auto count = static_cast<Eigen::Index>(t.value.size()) - own_size(t);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(d_.simulated.size(), count + 1);
  std::vector<Scalar> p;
  for (Eigen::Index k = 0; k < count; ++k) {
    p.emplace_back(t.value[static_cast<std::size_t>(own_size(t) + k)], static_cast<int>(k));
  }
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const Condition& c = d_.data.rows[static_cast<std::size_t>(i)].condition;
    if (!acts_in(t.law, c)) continue;
    const Scalar v = law_value(t.law, c, p.data());
    const double w = law_change(t.law.action, c, d_.simulated[i], d_.si);
    columns(i, 0) = w * v.a;
    columns.row(i).tail(count) = w * v.v.head(count).transpose();
  }
  d_.noise.whiten(columns);
  At result{.residual = d_.residual - columns.col(0),
            .jacobian = Eigen::MatrixXd(columns.rows(), own + count)};
  for (Eigen::Index k = 0; k < own_size(t); ++k) {
    result.residual -= d_.own.col(k) * t.value[static_cast<std::size_t>(k)];
  }
  result.jacobian << d_.own, columns.rightCols(count);
  return result;
}

double LawFit::sum_of(const Eigen::VectorXd& residual, const std::vector<Eigen::Index>& in) const {
  double sum = 0.0;
  for (const Eigen::Index i : in) {
    sum += scale_ > 0.0 ? huber_square(residual[i] / scale_) : residual[i] * residual[i];
  }
  return sum;
}

Eigen::VectorXd LawFit::refine(LawTrial& t, const std::vector<Eigen::Index>& in) const {
  if (own_size(t) == 0 && d_.own.cols() > 0) {
    t.value.insert(t.value.begin(), static_cast<std::size_t>(d_.own.cols()), 0.0);
  }
  const std::vector<ParameterRecord> records = parameters_of(t.law, d_.data.kind);
  const auto own = static_cast<std::size_t>(d_.own.cols());
  At now = at(t);
  t.sum = sum_of(now.residual, in);
  constexpr int kPasses = 30;
  constexpr int kHalves = 8;
  for (int pass = 0; pass < kPasses; ++pass) {
    Eigen::VectorXd psi = now.residual(in);
    if (scale_ > 0.0) psi = winsorised(psi, std::max(scale_, robust_deviation(psi)));
    const Eigen::VectorXd change = numerics::least_norm_solution(now.jacobian(in, Eigen::all), psi);
    bool improved = false;
    double share = 1.0;
    for (int half = 0; half < kHalves; ++half, share *= 0.5) {
      LawTrial next = t;
      for (std::size_t k = 0; k < next.value.size(); ++k) {
        next.value[k] += share * change[static_cast<Eigen::Index>(k)];
        if (k < own) continue;
        const ParameterRecord& r = records[k - own];
        next.value[k] = std::clamp(next.value[k], r.lower, r.upper);
      }
      At there = at(next);
      next.sum = sum_of(there.residual, in);
      if (!(next.sum < t.sum)) continue;
      constexpr double kSmall = 1e-5;
      improved = t.sum - next.sum > kSmall * t.sum;
      t = std::move(next);
      now = std::move(there);
      break;
    }
    if (!improved) break;
  }
  return now.residual;
}

void LawFit::start(LawTrial& t, const std::vector<Eigen::Index>& in) const {
  t.value[0] = 0.0;
  if (t.law.offset) t.value[1] = 0.0;
  const At here = at(t);
  // Derivatives by the rest are 0 at the amplitude 0: the first columns are all that counts.
  const Eigen::Index linear = d_.own.cols() + (t.law.offset ? 2 : 1);
  const Eigen::VectorXd x = numerics::least_norm_solution(
      here.jacobian.leftCols(linear)(in, Eigen::all), here.residual(in));
  std::vector<double> own(x.data(), x.data() + d_.own.cols());
  t.value[0] = x[d_.own.cols()];
  if (t.law.offset) t.value[1] = x[d_.own.cols() + 1];
  t.value.insert(t.value.begin(), own.begin(), own.end());
}

Eigen::VectorXd LawFit::without_law(const std::vector<Eigen::Index>& in) const {
  Eigen::VectorXd r = d_.residual;
  constexpr int kPasses = 20;
  for (int pass = 0; pass < kPasses && d_.own.cols() > 0; ++pass) {
    const Eigen::VectorXd seen = r(in);
    r -= d_.own *
         numerics::least_norm_solution(d_.own(in, Eigen::all),
                                       winsorised(seen, std::max(scale_, robust_deviation(seen))));
  }
  return r;
}

bool LawFit::take_better(LawTrial& t, LawTrial other, const std::vector<Eigen::Index>& in) const {
  refine(other, in);
  if (!(other.sum < t.sum)) return false;
  t = std::move(other);
  return true;
}

namespace {

/// Values of a factor's condition in the rows where the law acts, ascending.
std::vector<double> rising_values(const LawData& d, const Law& law, std::size_t factor) {
  const LawCondition& condition = law_conditions()[law.factors[factor].condition];
  std::vector<double> values;
  values.reserve(d.data.rows.size());
  for (const Observation& row : d.data.rows) {
    if (!acts_in(law, row.condition)) continue;
    const double x = condition.value(row.condition);
    if (std::isfinite(x)) values.push_back(x);
  }
  std::ranges::sort(values);
  return values;
}

/// The same pulses twice as often: at an order and phase doubled, with every second one new.
LawTrial twice_as_often(LawTrial t, std::size_t factor) {
  const std::size_t order = first_value(t, factor);
  const double phase = 2.0 * t.value[order + 1];
  t.value[order] *= 2.0;
  t.value[order + 1] = phase - std::floor(phase + 0.5);
  double& width = t.law.factors[factor].constant;
  width = preferred_number(2.0 * width);
  return t;
}

/// Bounds of a factor's first parameter.
ParameterRecord first_record(const LawTrial& t, std::size_t factor, Kind kind) {
  const auto own = static_cast<std::size_t>(own_size(t));
  return parameters_of(t.law, kind)[first_value(t, factor) - own];
}

}  // namespace

bool LawFit::polish_step(LawTrial& t, std::size_t factor,
                         const std::vector<Eigen::Index>& in) const {
  std::vector<double> x = rising_values(d_, t.law, factor);
  const StepRange allowed(x);
  x.erase(std::unique(x.begin(), x.end()), x.end());
  const auto gaps = static_cast<std::ptrdiff_t>(x.size()) - 1;
  const auto between = [&](std::ptrdiff_t gap) {
    const auto k = static_cast<std::size_t>(gap);
    return 0.5 * (x[k] + x[k + 1]);
  };
  bool improved = false;
  for (std::ptrdiff_t jump = 16; jump > 0;) {
    // The threshold lies above x[gap].
    const std::ptrdiff_t gap =
        std::ranges::upper_bound(x, t.law.factors[factor].constant) - x.begin() - 1;
    bool moved = false;
    for (const std::ptrdiff_t to : {gap - jump, gap + jump}) {
      if (moved || to < 0 || to >= gaps || !allowed.contains(between(to))) continue;
      LawTrial other = t;
      other.law.factors[factor].constant = between(to);
      moved = take_better(t, std::move(other), in);
    }
    improved = improved || moved;
    if (!moved) jump /= 2;
  }
  return improved;
}

bool LawFit::polish_width(LawTrial& t, std::size_t factor,
                          const std::vector<Eigen::Index>& in) const {
  for (const int step : {-1, 1}) {
    LawTrial other = t;
    double& width = other.law.factors[factor].constant;
    width = preferred_number(width, step);
    if (take_better(t, std::move(other), in)) return true;
  }
  if (t.law.factors[factor].shape != LawShape::kPulse) return false;
  LawTrial other = twice_as_often(t, factor);
  const double most = std::min(first_record(t, factor, d_.data.kind).upper, 2.0 * t.highest_order);
  return other.value[first_value(other, factor)] <= most && take_better(t, std::move(other), in);
}

void LawFit::polish(LawTrial& t, const std::vector<Eigen::Index>& in) const {
  constexpr int kPasses = 6;
  bool again = true;
  for (int pass = 0; pass < kPasses && again; ++pass) {
    again = false;
    for (std::size_t f = 0; f < t.law.factors.size(); ++f) {
      const LawShape shape = t.law.factors[f].shape;
      if (shape == LawShape::kStep) again = polish_step(t, f, in) || again;
      if (shape == LawShape::kWindow || shape == LawShape::kPulse) {
        again = polish_width(t, f, in) || again;
      }
    }
  }
}

}  // namespace gear3k::calibrate
