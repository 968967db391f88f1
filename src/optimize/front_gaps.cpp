#include "optimize/front_gaps.hpp"

#include <algorithm>
#include <utility>

#include "optimize/hypervolume.hpp"

namespace gear3k::optimize {

namespace {

/// What limits give way, in costs of the box.
constexpr double kWithin = 1e-5;
/// Sides that are not halved again.
constexpr double kShortest = 1.0 / 4096.0;

}  // namespace

FrontGaps::FrontGaps(std::size_t objectives) {
  Cell whole{.lo = std::vector<double>(objectives - 1, 0.0),
             .hi = std::vector<double>(objectives - 1, 1.0)};
  whole.gap = 1.0;
  cells_.push_back(std::move(whole));
}

void FrontGaps::add(std::span<const double> costs) {
  designs_.emplace_back(costs.begin(), costs.end());
  for (Cell& cell : cells_) {
    bool inside = costs[0] < 1.0;
    for (std::size_t k = 0; k < cell.hi.size(); ++k) inside = inside && costs[k + 1] < cell.hi[k];
    if (inside) cell.gap = gap_of(cell);
  }
}

double FrontGaps::gap_of(const Cell& cell) const {
  double volume = 1.0 - cell.least;
  if (volume <= 0.0) return 0.0;
  for (std::size_t k = 0; k < cell.hi.size(); ++k) volume *= cell.hi[k] - cell.lo[k];
  std::vector<std::vector<double>> inside;
  for (const std::vector<double>& design : designs_) {
    std::vector<double> at{(design[0] - cell.least) / (1.0 - cell.least)};
    for (std::size_t k = 0; k < cell.hi.size(); ++k) {
      at.push_back((design[k + 1] - cell.lo[k]) / (cell.hi[k] - cell.lo[k]));
    }
    if (std::ranges::any_of(at, [](double x) { return x >= 1.0; })) continue;
    for (double& x : at) x = std::max(x, 0.0);
    const auto covers = [](const auto& a, const auto& b) {
      return std::ranges::equal(a, b, std::ranges::less_equal{});
    };
    if (std::ranges::any_of(inside, [&](const auto& other) { return covers(other, at); })) continue;
    std::erase_if(inside, [&](const auto& other) { return covers(at, other); });
    inside.push_back(std::move(at));
  }
  return volume * (1.0 - hypervolume(std::move(inside)));
}

std::size_t FrontGaps::greatest() const {
  const auto is_open = [](const Cell& cell) {
    for (std::size_t k = 0; k < cell.hi.size(); ++k) {
      if (cell.hi[k] - cell.lo[k] > kShortest) return true;
    }
    return false;
  };
  std::size_t best = cells_.size();
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    if (is_open(cells_[k]) && (best == cells_.size() || cells_[k].gap > cells_[best].gap)) best = k;
  }
  return best;
}

const FrontGaps::Answer* FrontGaps::known_answer(std::span<const double> limits) const {
  // A search with wider limits whose design keeps these as well, or that found none.
  for (const Answer& answer : answers_) {
    bool answers = std::ranges::equal(limits, answer.limits, std::ranges::less_equal{});
    for (std::size_t k = 0; answers && answer.costs && k < limits.size(); ++k) {
      answers = (*answer.costs)[k + 1] <= limits[k] + kWithin;
    }
    if (answers) return &answer;
  }
  return nullptr;
}

std::optional<std::vector<double>> FrontGaps::next(double enough) {
  while (missing() > enough) {
    cell_ = greatest();
    if (cell_ == cells_.size() || cells_[cell_].gap <= 0.0) return std::nullopt;
    const Cell& cell = cells_[cell_];
    side_ = 0;
    for (std::size_t k = 1; k < cell.hi.size(); ++k) {
      if (cell.hi[k] - cell.lo[k] > cell.hi[side_] - cell.lo[side_]) side_ = k;
    }
    std::vector<double> limits = cell.hi;
    limits[side_] = 0.5 * (cell.lo[side_] + cell.hi[side_]);
    const Answer* known = known_answer(limits);
    if (known == nullptr) return limits;
    split({.limits = std::move(limits), .costs = known->costs});
  }
  return std::nullopt;
}

void FrontGaps::found(const std::optional<std::vector<double>>& costs) {
  std::vector<double> limits = cells_[cell_].hi;
  limits[side_] = 0.5 * (cells_[cell_].lo[side_] + cells_[cell_].hi[side_]);
  if (costs) add(*costs);
  answers_.push_back({.limits = std::move(limits), .costs = costs});
  split(answers_.back());
}

void FrontGaps::split(const Answer& answer) {
  Cell low = cells_[cell_];
  Cell high = low;
  low.hi[side_] = high.lo[side_] = answer.limits[side_];
  low.least = answer.costs ? std::max(low.least, (*answer.costs)[0]) : 1.0;
  low.gap = gap_of(low);
  high.gap = gap_of(high);
  cells_[cell_] = std::move(low);
  cells_.push_back(std::move(high));
}

double FrontGaps::missing() const {
  double sum = 0.0;
  for (const Cell& cell : cells_) sum += cell.gap;
  return sum;
}

}  // namespace gear3k::optimize
