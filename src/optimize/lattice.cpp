#include "optimize/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "optimize/slsqp.hpp"

namespace gear3k::optimize {

namespace {
constexpr double kSameStep = 1e-7;  // of a step
}  // namespace

Multiples::Multiples(double step_si, units::Unit unit)
    : unit_(unit), step_(units::decimal_from_si(step_si, unit)), step_si_(step_si) {}

double Multiples::at(long k) const {
  constexpr double kDigits = 1e12;
  return units::to_si(std::round(static_cast<double>(k) * step_ * kDigits) / kDigits, unit_);
}

long Multiples::nearest(double si) const { return std::lround(count(si)); }

long Multiples::first_from(double si) const {
  return static_cast<long>(std::ceil(count(si) - kSameStep));
}

long Multiples::last_to(double si) const {
  return static_cast<long>(std::floor(count(si) + kSameStep));
}

std::optional<std::size_t> farthest_axis(const LatticeBox& box, std::span<const double> steps) {
  std::optional<std::size_t> farthest, longest;
  double most = kOnLattice;
  for (std::size_t k = 0; k < box.size(); ++k) {
    const long length = box[k][1] - box[k][0];
    if (length == 0) continue;
    const double off = std::abs(steps[k] - std::round(steps[k]));
    if (off > most) {
      most = off;
      farthest = k;
    }
    if (!longest || length > box[*longest][1] - box[*longest][0]) longest = k;
  }
  return farthest ? farthest : longest;
}

void CutGains::add(std::size_t axis, bool up, double steps, std::optional<double> gain) {
  const double off = up ? std::ceil(steps) - steps : steps - std::floor(steps);
  if (!gain || !(off > kOnLattice)) return;
  const double worth = std::max(0.0, *gain) / off;
  for (Mean* mean : {&of_[axis][up ? 1 : 0], &all_}) {
    mean->sum += worth;
    ++mean->count;
  }
}

double CutGains::expected(std::size_t axis, bool up, double off) const {
  const Mean& own = of_[axis][up ? 1 : 0];
  const Mean& mean = own.count > 0 ? own : all_;
  return mean.count > 0 ? off * mean.sum / mean.count : off;
}

std::optional<std::size_t> CutGains::best_axis(const LatticeBox& box,
                                               std::span<const double> steps) const {
  constexpr double kLeast = 1e-9;
  std::optional<std::size_t> best;
  double most = -1.0;
  for (std::size_t k = 0; k < box.size(); ++k) {
    if (box[k][0] == box[k][1] || std::abs(steps[k] - std::round(steps[k])) <= kOnLattice) continue;
    const double below = steps[k] - std::floor(steps[k]);
    const double score = std::max(kLeast, expected(k, false, below)) *
                         std::max(kLeast, expected(k, true, 1.0 - below));
    if (score > most) {
      most = score;
      best = k;
    }
  }
  return best ? best : farthest_axis(box, steps);
}

SolveOutcome best_within(const RefinementProblem& problem, Point start, bool give_up) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(problem.variables); ++k) {
    start[k] = std::clamp(start[k], problem.lower[k], problem.upper[k]);
  }
  SlsqpOptions near{.working_margin = 0.3, .give_up = give_up};
  if (give_up) {
    near.x_tolerance = 1e-8;
    near.f_tolerance = 1e-11;
  }
  const SolveOutcome end = solve_slsqp(problem, start, near);
  if (end.feasible()) return end;
  const SolveOutcome met = least_violation(problem, start, give_up ? near : SlsqpOptions{});
  return met.feasible() ? solve_slsqp(problem, met.v, {}) : met;
}

bool search_boxes(const BoxProblem& problem, BoxNode root) {
  std::vector<BoxNode> open;
  open.push_back(std::move(root));
  return search_boxes(problem, open);
}

bool search_boxes(const BoxProblem& problem, std::vector<BoxNode>& open) {
  while (!open.empty() && !problem.cut()) {
    if (problem.best_first) {
      std::swap(open.back(), *std::ranges::min_element(
                                 open, {}, [](const BoxNode& node) { return node.bound; }));
    }
    const BoxNode node = std::move(open.back());
    open.pop_back();
    if (!problem.can_win(node)) continue;
    const auto axis = problem.axis_to_cut(node);
    if (!axis) continue;
    const auto& [first, last] = node.box[*axis];
    const double at = problem.steps_at(*axis, node.relaxed.v);
    const long below = std::clamp(static_cast<long>(std::floor(at)), first, last - 1);
    std::array<BoxNode, 2> halves;
    for (BoxNode& half : halves) half.box = node.box;
    halves[0].box[*axis][1] = below;
    halves[1].box[*axis][0] = below + 1;
    for (BoxNode& half : halves) {
      problem.relax(node, half);
      problem.offer(half);
    }
    if (problem.learn) problem.learn(node, *axis, halves);
    if (halves[0].bound < halves[1].bound) std::swap(halves[0], halves[1]);
    for (BoxNode& half : halves) {
      if (problem.can_win(half)) open.push_back(std::move(half));
    }
  }
  return std::ranges::none_of(open, problem.can_win);
}

}  // namespace gear3k::optimize
