#include "backlash/gearbox_batch.hpp"

#include <algorithm>
#include <limits>

namespace gear3k::backlash {

namespace {

/// Gearboxes whose sums are kept in registers.
constexpr std::size_t kBlock = 16;
using Block = std::array<double, kBlock>;

/// Intersection of the planets' intervals of one sum, as in output_range().
struct Strips {
  Block lower, upper;
};

Strips everything() {
  Strips s{};
  s.lower.fill(-std::numeric_limits<double>::infinity());
  s.upper.fill(std::numeric_limits<double>::infinity());
  return s;
}
/// std::max and std::min, in a form that becomes one instruction each.
inline double batch_larger(double a, double b) { return a < b ? b : a; }
inline double batch_smaller(double a, double b) { return b < a ? b : a; }

}  // namespace

GearboxBatch::GearboxBatch(const ClearanceModel& model)
    : levers_(model.levers), middle_m_(model.middle_m) {
  std::vector<std::vector<Term>> of_bound(model.middle_m.size());
  for (std::size_t d = 0; d < model.deviations.size(); ++d) {
    const Deviation& deviation = model.deviations[d];
    const auto add = [&](const std::vector<PlayEffect>& effects, bool y) {
      for (const PlayEffect& e : effects) {
        of_bound[e.bound].push_back(
            {.component = components_.size(), .coefficient = e.coefficient});
      }
      components_.push_back({.deviation = d, .source = deviation.source, .y = y});
    };
    add(deviation.x, false);
    if (deviation.planar) add(deviation.y, true);
  }
  begins_.push_back(0);
  for (const auto& terms : of_bound) {
    terms_.insert(terms_.end(), terms.begin(), terms.end());
    begins_.push_back(terms_.size());
  }
}

void GearboxBatch::ranges(std::span<const Lanes* const> values, BatchRange& result) const {
  // Symbols as in docs/theory §33.
  const double kappa = levers_.planet;
  const double e = levers_.sun_side;
  const double f = levers_.ring_side;
  const double output_m = levers_.output_m;
  std::array<Block, 6> u{};  // lower and upper bounds of one planet's plays
  for (std::size_t at = 0; at < kBatch; at += kBlock) {
    Strips w = everything(), s13 = everything(), s23 = everything();
    Block margin{};
    margin.fill(std::numeric_limits<double>::infinity());
    for (std::size_t planet = 0; 6 * planet < middle_m_.size(); ++planet) {
      for (std::size_t k = 0; k < 6; ++k) {
        const std::size_t bound = 6 * planet + k;
        Block sum{};
        sum.fill(middle_m_[bound]);
        for (std::size_t i = begins_[bound]; i < begins_[bound + 1]; ++i) {
          const double c = terms_[i].coefficient;
          const double* v = values[terms_[i].component]->lane.data() + at;
          for (std::size_t b = 0; b < kBlock; ++b) sum[b] += c * v[b];
        }
        u[k] = sum;
      }
      const auto& [low1, high1, low2, high2, low3, high3] = u;
      for (std::size_t b = 0; b < kBlock; ++b) {
        w.lower[b] = batch_larger(w.lower[b], low1[b] + low2[b]);
        w.upper[b] = batch_smaller(w.upper[b], high1[b] + high2[b]);
        s13.lower[b] = batch_larger(s13.lower[b], kappa * low1[b] + low3[b]);
        s13.upper[b] = batch_smaller(s13.upper[b], kappa * high1[b] + high3[b]);
        s23.lower[b] = batch_larger(s23.lower[b], low3[b] - kappa * high2[b]);
        s23.upper[b] = batch_smaller(s23.upper[b], high3[b] - kappa * low2[b]);
        margin[b] = batch_smaller(
            batch_smaller(batch_smaller(margin[b], high1[b] - low1[b]), high2[b] - low2[b]),
            high3[b] - low3[b]);
      }
    }
    // output_range() takes the lower end from mirrored strips: signs change, roundings do not.
    const Block& w_up = f > 0.0 ? w.lower : w.upper;
    const Block& w_down = f > 0.0 ? w.upper : w.lower;
    const Block& s13_up = f > 0.0 ? s13.lower : s13.upper;
    const Block& s13_down = f > 0.0 ? s13.upper : s13.lower;
    for (std::size_t b = 0; b < kBlock; ++b) {
      const double up =
          batch_smaller(batch_smaller(s13.upper[b] - e * w.lower[b], s23.upper[b] - f * w_up[b]),
                        (e * s23.upper[b] - f * s13_up[b]) / kappa);
      const double down =
          batch_smaller(batch_smaller(e * w.upper[b] - s13.lower[b], f * w_down[b] - s23.lower[b]),
                        (f * s13_down[b] - e * s23.lower[b]) / kappa);
      result.width_rad.lane[at + b] = up / output_m + down / output_m;
      const double chains =
          batch_smaller(batch_smaller(w.upper[b] - w.lower[b], s13.upper[b] - s13.lower[b]),
                        s23.upper[b] - s23.lower[b]);
      const double across = batch_smaller(kappa * w.upper[b] - (s13.lower[b] - s23.upper[b]),
                                          (s13.upper[b] - s23.lower[b]) - kappa * w.lower[b]);
      result.margin_m.lane[at + b] = batch_smaller(batch_smaller(margin[b], chains), across);
    }
  }
}

}  // namespace gear3k::backlash
