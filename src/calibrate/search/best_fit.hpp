#pragma once
// The best of several fits by their score.

#include <optional>
#include <utility>
#include <vector>

#include "calibrate/fit/fit.hpp"
#include "calibrate/fit/screen.hpp"
#include "calibrate/search/free_shapes.hpp"

namespace gear3k::calibrate {

/// The fit of the best score_of() among those that were offered.
class BestFit {
 public:
  /// None yet.
  BestFit(const Problem& problem, double scale) : problem_(problem), scale_(scale) {}
  BestFit(const Problem& problem, Fit found, double scale) : BestFit(problem, scale) {
    offer(std::move(found));
  }

  /// @returns whether it is the best now
  bool offer(Fit trial) {
    const double score = score_of(problem_, trial, scale_);
    if (fit_ && !(score > score_)) return false;
    score_ = score;
    fit_ = std::move(trial);
    return true;
  }
  /// Fits the hypothesis first; one of too many parameters is none.
  bool offer(Hypothesis h) {
    if (h.value.size() > static_cast<std::size_t>(kMostParameters)) return false;
    return offer(fit(problem_, std::move(h), scale_));
  }
  /// As if offered one after the other.
  bool offer_all(std::vector<Hypothesis> some) {
    std::erase_if(some, [](const Hypothesis& h) {
      return h.value.size() > static_cast<std::size_t>(kMostParameters);
    });
    bool better = false;
    for (Fit& trial : fit_all(problem_, some, scale_)) better = offer(std::move(trial)) || better;
    return better;
  }
  [[nodiscard]] const Hypothesis& hypothesis() const { return fit_->hypothesis; }
  [[nodiscard]] Fit take() && { return std::move(*fit_); }
  /// The best one if its score is above that of another fit less `handicap` (ln L), else that fit.
  [[nodiscard]] Fit or_else(Fit other, double handicap) && {
    const bool better = fit_ && score_ > score_of(problem_, other, scale_) - handicap;
    return better ? std::move(*fit_) : std::move(other);
  }

 private:
  const Problem& problem_;
  double scale_;
  std::optional<Fit> fit_;
  double score_ = 0.0;
};

}  // namespace gear3k::calibrate
