#include "optimize/stage_relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "geometry/involute.hpp"
#include "optimize/flank_box.hpp"

namespace gear3k::optimize {

namespace {

/// The lines of action of a stage at one centre distance.
struct Distance {
  double d = 0.0;
  double sun_tangent = 0.0, ring_tangent = 0.0;  ///< d sin α_w
  double sun_opening = 0.0, ring_opening = 0.0;  ///< z_Σ cos α (inv α_w − inv α)
};

struct Box {
  Distance low, high;
  Interval planet_shift;
  double bound = 0.0;
  double error = 0.0;  ///< at most so much of the bound is owed to the size of the box
  bool split_distance = true;
  bool by_root = false;  ///< a root asks for more than the flanks do
  StagePoint point;
};
bool later(const Box& a, const Box& b) { return a.bound > b.bound; }

class StageSearch {
 public:
  explicit StageSearch(const StageTask& task)
      : t_(task),
        sin_(std::sin(task.pressure_angle_rad)),
        cos_(std::cos(task.pressure_angle_rad)),
        involute_(std::tan(task.pressure_angle_rad) - task.pressure_angle_rad),
        base_pitch_(std::numbers::pi * cos_),
        ring_sum_(0.5 * cos_ * (task.ring.teeth - task.planet.teeth)),
        sun_sum_(task.sun ? 0.5 * cos_ * (task.sun->teeth + task.planet.teeth) : 0.0),
        planet_base_(0.5 * cos_ * task.planet.teeth),
        ring_base_(0.5 * cos_ * task.ring.teeth),
        sun_base_(task.sun ? 0.5 * cos_ * task.sun->teeth : 0.0) {}

  [[nodiscard]] Interval distances() const {
    Box first;
    if (!first_box(first)) return {kInfinity, -kInfinity};
    return {first.low.d, first.high.d};
  }

  [[nodiscard]] TeethReach reach() const {
    constexpr int kDistances = 8, kShifts = 4;
    TeethReach reach;
    Box box, whole;
    if (!first_box(whole)) return reach;
    const auto at_share = [](double lo, double hi, int k, int n) {
      return k == n ? hi : lo + (hi - lo) * k / n;
    };
    const Interval& xp = whole.planet_shift;
    box.high = whole.low;
    for (int i = 1; i <= kDistances; ++i) {
      box.low = box.high;
      box.high = at(at_share(whole.low.d, whole.high.d, i, kDistances));
      for (int k = 0; k < kShifts; ++k) {
        box.planet_shift = {at_share(xp.lo, xp.hi, k, kShifts),
                            at_share(xp.lo, xp.hi, k + 1, kShifts)};
        widen_by_box(reach, box);
      }
    }
    return reach;
  }

  StageBound run(const StageEffort& effort) {
    StageBound result;
    heap_.clear();
    Box first;
    if (!first_box(first)) {
      result.empty = true;
      return result;
    }
    result.center_distance = {first.low.d, first.high.d};
    push(first);
    result.boxes = 1;
    while (!heap_.empty() && result.boxes < effort.boxes) {
      const Box& top = heap_.front();
      if (top.error <= effort.tolerance * top.bound) break;
      Box parent = top;
      std::pop_heap(heap_.begin(), heap_.end(), later);
      heap_.pop_back();
      Box left = parent, right = parent;
      if (parent.split_distance) {
        left.high = right.low = at(0.5 * (parent.low.d + parent.high.d));
      } else {
        left.planet_shift.hi = right.planet_shift.lo = parent.planet_shift.middle();
      }
      push(left);
      push(right);
      result.boxes += 2;
    }
    if (heap_.empty()) {
      result.empty = true;
      return result;
    }
    result.least = heap_.front().bound;
    result.point = heap_.front().point;
    result.by_root = heap_.front().by_root;
    Interval& hull = result.center_distance;
    hull = {kInfinity, -kInfinity};
    for (const Box& box : heap_) {
      hull.lo = std::min(hull.lo, box.low.d);
      hull.hi = std::max(hull.hi, box.high.d);
    }
    return result;
  }

 private:
  [[nodiscard]] Distance at(double d) const {
    Distance p;
    p.d = d;
    const auto line = [&](double sum, double& tangent, double& opening) {
      tangent = std::sqrt(std::max(0.0, (d - sum) * (d + sum)));
      const double tan_w = tangent / sum;
      opening = 2.0 * sum * (tan_w - std::atan(tan_w) - involute_);
    };
    line(ring_sum_, p.ring_tangent, p.ring_opening);
    if (t_.sun) line(sun_sum_, p.sun_tangent, p.sun_opening);
    return p;
  }

  /// Centre distance at which z_Σ cos α (inv α_w − inv α) has a value; that of α_w = 0 below it.
  [[nodiscard]] double distance_of(double sum, double opening) const {
    const double inv = opening / (2.0 * sum) + involute_;
    if (!(inv > 0.0)) return sum;
    const double angle = inv > 100.0 ? 1.57 : geometry::inverse_involute(inv);
    return sum / std::cos(angle);
  }

  bool first_box(Box& box) const {
    if (t_.planet.profile_shift.empty() || t_.ring.profile_shift.empty() ||
        t_.ring_backlash.empty() || t_.contact_ratio.empty() ||
        (t_.sun && (t_.sun->profile_shift.empty() || t_.sun_backlash.empty())) ||
        ring_sum_ <= 0.0) {
      return false;
    }
    const double closest = std::max(ring_sum_, sun_sum_);
    Interval d{closest * (1.0 + 1e-12), closest / std::cos(t_.greatest_angle_rad)};
    const double q2 = t_.planet.machining_allowance + t_.ring.machining_allowance;
    const Interval& xp = t_.planet.profile_shift;
    const Interval& xr = t_.ring.profile_shift;
    d.hi = std::min(
        d.hi, distance_of(ring_sum_, 2.0 * sin_ * (xr.hi - xp.lo) + q2 - t_.ring_backlash.lo));
    if (std::isfinite(t_.ring_backlash.hi)) {
      d.lo = std::max(
          d.lo, distance_of(ring_sum_, 2.0 * sin_ * (xr.lo - xp.hi) + q2 - t_.ring_backlash.hi));
    }
    if (t_.sun) {
      const double q1 = t_.planet.machining_allowance + t_.sun->machining_allowance;
      const Interval& xs = t_.sun->profile_shift;
      if (std::isfinite(t_.sun_backlash.lo)) {
        d.lo = std::max(
            d.lo, distance_of(sun_sum_, 2.0 * sin_ * (xs.lo + xp.lo) - q1 + t_.sun_backlash.lo));
      }
      d.hi = std::min(
          d.hi, distance_of(sun_sum_, 2.0 * sin_ * (xs.hi + xp.hi) - q1 + t_.sun_backlash.hi));
    }
    d.lo -= kRelaxationSlack;
    d.hi += kRelaxationSlack;
    d.lo = std::max({d.lo, closest * (1.0 + 1e-12), t_.distance.lo});
    d.hi = std::min(d.hi, t_.distance.hi);
    if (d.empty()) return false;
    box.low = at(d.lo);
    box.high = at(d.hi);
    box.planet_shift = xp;
    return true;
  }

  /// Greatest ρ_a of a tip in an external mesh: T − ρ_a is at least the interference margin, and
  /// s ρ_a z_mate/z.
  [[nodiscard]] double most_length(double tangent, int mate_teeth, int teeth) const {
    double most = kInfinity;
    if (t_.interference) most = tangent - *t_.interference;
    if (t_.rolling_share) {
      most = std::min(most, tangent / (1.0 + *t_.rolling_share * mate_teeth / teeth));
    }
    return most;
  }

  static double flank_length(const StageGear& gear, double base, double tip) {
    const double radius = 0.5 * gear.teeth + tip;
    return radius > base ? std::sqrt((radius - base) * (radius + base)) : 0.0;
  }
  /// Profile shift plus tip height at which the tip is so far from the tangent point.
  static double tip_at(const StageGear& gear, double base, double length) {
    return std::sqrt(length * length + base * base) - 0.5 * gear.teeth;
  }

  /// What a box leaves, in modules.
  struct Rest {
    Interval sum{-kInfinity, kInfinity};  ///< x_S + x_P
    Interval difference{};                ///< x_R − x_P
    Interval planet_tip{}, sun_tip{};     ///< heights
    Interval planet_length{};             ///< ρ_a of the planet
    Interval ring_shift{}, ring_length{};
    double low_tan = 0.0, high_tan = 0.0;      ///< tan α_w of planet and ring
    Interval e1{}, e2{}, ring_ratio{};         ///< contact ratios of planet and ring
    Interval sun_e1{}, sun_e2{}, sun_ratio{};  ///< those of sun and planet
  };
  /// Least m² [m²] that flanks and roots ask for in a box.
  struct Needs {
    double flank_m2 = 0.0, root_m2 = 0.0;
    double of_interest_m2 = 0.0;  ///< what a root asks for below it need not be known
  };
  /// What of a bound is owed to the width of a box.
  struct Effects {
    double distance = 0.0, shift = 0.0;
  };

  /// Takes a copy of a box into what is reached.
  void widen_by_box(TeethReach& reach, Box box) const {
    Rest rest = confine_sums(box);
    Effects effects;
    Needs needs;
    if (!confine_planet(box, rest) || !confine_ring(box, rest) ||
        !bound_ring_loss(box, rest, effects) ||
        (t_.sun && !examine_sun(box, rest, effects, needs))) {
      return;
    }
    reach.empty = false;
    reach.distance = std::max(reach.distance, box.high.d);
    const auto widen = [&](MeshReach& mesh, const Interval& e1, const Interval& e2,
                           const Interval& ratio, double tangent) {
      const auto take = [&](double e) { mesh.farthest = std::max(mesh.farthest, e); };
      take(std::min(e1.hi, ratio.hi - e2.lo));
      take(std::min(e2.hi, ratio.hi - e1.lo));
      // Without contact the middle of the empty path counts.
      if (ratio.lo < 0.0) take(std::max(-e1.lo, -e2.lo));
      mesh.loss_factor = std::max(mesh.loss_factor, most_loss_factor(e1, e2, ratio, t_.sliding));
      mesh.tan_alpha_w = std::max(mesh.tan_alpha_w, tangent);
    };
    widen(reach.ring, rest.e1, rest.e2, rest.ring_ratio, rest.high_tan);
    if (t_.sun) {
      widen(reach.sun, rest.sun_e1, rest.sun_e2, rest.sun_ratio, box.high.sun_tangent / sun_sum_);
    }
  }

  /// Confines the box and bounds its losses.  @returns false when it holds no point
  bool examine(Box& box) const {
    Rest rest = confine_sums(box);
    if (!confine_planet(box, rest) || !confine_ring(box, rest)) return false;
    Effects effects;
    if (!bound_ring_loss(box, rest, effects)) return false;
    const double root = 0.5 * t_.ring.teeth + t_.ring.root_height + rest.ring_shift.lo;
    double most_m = t_.most_module_m;
    if (root > 0.0) most_m = std::min(most_m, 0.5 * t_.most_root_diameter_m / root);
    most_m *= 1.0 + kRelaxationSlack;
    const bool of_loss = t_.least == StageTask::Least::kLoss;
    Needs needs{.of_interest_m2 = of_loss ? most_m * most_m : 0.0};
    needs.flank_m2 =
        needed_module2(t_.ring_flank, {.base_pitch = base_pitch_,
                                       .ratio = rest.ring_ratio.hi,
                                       .low_tangent = box.low.ring_tangent,
                                       .high_tangent = box.high.ring_tangent,
                                       .base1 = planet_base_,
                                       .base2 = ring_base_,
                                       .base_sum = ring_sum_,
                                       .length = {rest.planet_length, rest.ring_length},
                                       .sign = -1.0});
    if (t_.sun && !examine_sun(box, rest, effects, needs)) return false;
    add_root(needs, {.table = t_.roots.planet_table, .need = t_.roots.planet_of_ring}, [&] {
      return root_range(box.planet_shift, rest.planet_length, rest.ring_ratio,
                        {base_pitch_ + rest.ring_length.lo - box.high.ring_tangent,
                         base_pitch_ + rest.ring_length.hi - box.low.ring_tangent});
    });
    box.by_root = needs.root_m2 > needs.flank_m2;
    box.split_distance = effects.distance > effects.shift;
    const double need_m2 = std::max(needs.flank_m2, needs.root_m2);
    if (of_loss) return need_m2 <= most_m * most_m;
    bound_distance(box, rest, std::sqrt(need_m2), most_m);
    return true;
  }

  /// x_R − x_P and x_S + x_P from backlash and clearance.
  [[nodiscard]] Rest confine_sums(const Box& box) const {
    constexpr double kSlack = kRelaxationSlack;
    const Distance& low = box.low;
    const Distance& high = box.high;
    const double double_sin = 2.0 * sin_;
    Rest rest;
    rest.planet_tip = t_.planet.tip_height;
    const double q2 = t_.planet.machining_allowance + t_.ring.machining_allowance;
    double most_ring_backlash = t_.ring_backlash.hi;
    if (t_.sun) {
      const double q1 = t_.planet.machining_allowance + t_.sun->machining_allowance;
      if (t_.lost_motion) {
        const double least =
            std::max(t_.sun_backlash.lo,
                     low.sun_opening + q1 -
                         double_sin * (t_.sun->profile_shift.hi + box.planet_shift.hi)) -
            kSlack;
        most_ring_backlash =
            std::min(most_ring_backlash,
                     (t_.lost_motion->most - t_.lost_motion->sun * least) / t_.lost_motion->ring);
      }
      rest.sum = {(low.sun_opening + q1 - t_.sun_backlash.hi) / double_sin - kSlack,
                  (high.sun_opening + q1 - t_.sun_backlash.lo) / double_sin + kSlack};
    }
    rest.difference = {(t_.ring_backlash.lo - q2 + low.ring_opening) / double_sin - kSlack,
                       (most_ring_backlash - q2 + high.ring_opening) / double_sin + kSlack};
    const Interval khk = khk_shortening(box, rest.sum);
    const auto shortened = [&](const Interval& tip) {
      return Interval{tip.lo - khk.hi, tip.hi - khk.lo};
    };
    if (t_.planet_khk_tip) rest.planet_tip = shortened(rest.planet_tip);
    if (t_.sun) {
      rest.sun_tip = t_.sun_khk_tip ? shortened(t_.sun->tip_height) : t_.sun->tip_height;
    }
    if (!t_.root_clearance) return rest;
    const double half_planet = 0.5 * t_.planet.teeth;
    const double room = *t_.root_clearance + low.d + half_planet - 0.5 * t_.ring.teeth - kSlack;
    rest.difference.lo =
        std::max({rest.difference.lo, room + rest.planet_tip.lo - t_.ring.root_height,
                  room + t_.planet.root_height - t_.ring.tip_height.hi});
    if (t_.sun) {
      const double free = high.d - *t_.root_clearance - half_planet - 0.5 * t_.sun->teeth + kSlack;
      rest.sum.hi = std::min({rest.sum.hi, free - rest.sun_tip.lo - t_.planet.root_height,
                              free - rest.planet_tip.lo - t_.sun->root_height});
    }
    return rest;
  }

  /// The planet's shift and tip.  @returns false where none is left
  bool confine_planet(Box& box, Rest& rest) const {
    constexpr double kSlack = kRelaxationSlack;
    Interval& xp = box.planet_shift;
    xp.lo = std::max(xp.lo, t_.ring.profile_shift.lo - rest.difference.hi);
    xp.hi = std::min(xp.hi, t_.ring.profile_shift.hi - rest.difference.lo);
    if (t_.sun) {
      xp.lo = std::max(xp.lo, rest.sum.lo - t_.sun->profile_shift.hi);
      xp.hi = std::min(xp.hi, rest.sum.hi - t_.sun->profile_shift.lo);
      const double most =
          most_length(box.high.sun_tangent, t_.sun->teeth, t_.planet.teeth) + kSlack;
      if (most < 0.0) return false;
      if (std::isfinite(most)) {
        xp.hi = std::min(xp.hi, tip_at(t_.planet, planet_base_, most) - rest.planet_tip.lo);
      }
    }
    if (t_.planet_gap) {
      xp.hi = std::min(xp.hi, box.high.d * t_.planet_gap->half_spacing - t_.planet_gap->half_gap -
                                  0.5 * t_.planet.teeth - rest.planet_tip.lo + kSlack);
    }
    if (xp.empty()) return false;
    rest.planet_length = {flank_length(t_.planet, planet_base_, xp.lo + rest.planet_tip.lo),
                          flank_length(t_.planet, planet_base_, xp.hi + rest.planet_tip.hi)};
    return true;
  }

  /// The ring's shift and tip.  @returns false where none is left
  bool confine_ring(const Box& box, Rest& rest) const {
    constexpr double kSlack = kRelaxationSlack;
    const Distance& low = box.low;
    const Distance& high = box.high;
    Interval& xr = rest.ring_shift;
    Interval& length = rest.ring_length;
    xr = {std::max(t_.ring.profile_shift.lo, box.planet_shift.lo + rest.difference.lo),
          std::min(t_.ring.profile_shift.hi, box.planet_shift.hi + rest.difference.hi)};
    length = {rest.planet_length.lo + low.ring_tangent - base_pitch_ * t_.contact_ratio.hi,
              rest.planet_length.hi + high.ring_tangent - base_pitch_ * t_.contact_ratio.lo};
    if (t_.interference) length.lo = std::max(length.lo, low.ring_tangent + *t_.interference);
    if (t_.rolling_share) {
      // ρ_R − T ≥ s ρ_R z_P/z_R
      const double left = 1.0 - *t_.rolling_share * t_.planet.teeth / t_.ring.teeth;
      if (left > 0.0) length.lo = std::max(length.lo, low.ring_tangent / left);
    }
    if (length.hi < -kSlack) return false;
    const Interval& tip = t_.ring.tip_height;
    if (std::isfinite(length.hi)) {
      xr.hi =
          std::min(xr.hi, tip_at(t_.ring, ring_base_, std::max(0.0, length.hi)) - tip.lo + kSlack);
    }
    if (length.lo > 0.0) {
      xr.lo = std::max(xr.lo, tip_at(t_.ring, ring_base_, length.lo) - tip.hi - kSlack);
    }
    if (xr.empty()) return false;
    length = {flank_length(t_.ring, ring_base_, xr.lo + tip.lo),
              flank_length(t_.ring, ring_base_, xr.hi + tip.hi)};
    return true;
  }

  /// Loss of planet and ring, or where none is looked for whether they touch at all.
  /// @returns false where they cannot
  bool bound_ring_loss(Box& box, Rest& rest, Effects& effects) const {
    constexpr double kSlack = kRelaxationSlack;
    const Interval& planet = rest.planet_length;
    const Interval& ring = rest.ring_length;
    const double low_tan = rest.low_tan = box.low.ring_tangent / ring_sum_;
    const double high_tan = rest.high_tan = box.high.ring_tangent / ring_sum_;
    rest.e1 = {(planet.lo - planet_base_ * high_tan) / base_pitch_ - kSlack,
               (planet.hi - planet_base_ * low_tan) / base_pitch_ + kSlack};
    rest.e2 = {(ring_base_ * low_tan - ring.hi) / base_pitch_ - kSlack,
               (ring_base_ * high_tan - ring.lo) / base_pitch_ + kSlack};
    rest.ring_ratio = {
        std::max(t_.contact_ratio.lo, (planet.lo - ring.hi + box.low.ring_tangent) / base_pitch_) -
            kSlack,
        std::min(t_.contact_ratio.hi, (planet.hi - ring.lo + box.high.ring_tangent) / base_pitch_) +
            kSlack};
    const double factor = factor_of(rest.e1, rest.e2, rest.ring_ratio);
    if (factor == kInfinity) return false;
    const double scale = t_.ring_weight * t_.ring_loss;
    effects = {
        .distance = scale * ((planet_base_ + ring_base_) * (high_tan - low_tan) / base_pitch_),
        .shift = scale * planet.width() / base_pitch_};
    box.error = scale * (rest.e1.width() + rest.e2.width());
    box.bound = scale * factor;
    box.point = {.center_distance = 0.5 * (box.low.d + box.high.d),
                 .sun_shift = 0.0,
                 .planet_shift = box.planet_shift.middle(),
                 .ring_shift = rest.ring_shift.middle()};
    if (t_.least != StageTask::Least::kLoss) return true;
    const double mid_tan = 0.5 * (low_tan + high_tan);
    const LeastShares shares = least_shares(rest.e1, rest.e2, rest.ring_ratio, t_.sliding);
    box.point.ring_shift = std::clamp(
        tip_at(t_.ring, ring_base_, std::max(0.0, ring_base_ * mid_tan - base_pitch_ * shares.e2)) -
            t_.ring.tip_height.middle(),
        rest.ring_shift.lo, rest.ring_shift.hi);
    return true;
  }

  /// Least, or over 1 greatest, centre distance in metres where that is looked for.
  void bound_distance(Box& box, const Rest& rest, double least_m, double most_m) const {
    const double wider = box.high.d / box.low.d - 1.0;
    if (t_.least == StageTask::Least::kDistance) {
      box.bound = least_m * box.low.d * (1.0 - kRelaxationSlack);
      box.error = box.bound * (wider + (rest.high_tan - rest.low_tan) / rest.high_tan +
                               rest.ring_ratio.width());
    } else {
      box.bound = 1.0 / (most_m * box.high.d);
      box.error = box.bound * (wider + rest.ring_shift.width() / (0.5 * t_.ring.teeth));
    }
  }

  struct TabledRoot {
    const strength::RootTable* table;
    const strength::RootNeed& need;
  };
  /// Of the greatest distance no need of the load is a limit.
  template <class RangeOf>
  void add_root(Needs& needs, const TabledRoot& root, RangeOf range_of) const {
    if (root.table == nullptr || !(root.need.load_m2 > 0.0) ||
        t_.least == StageTask::Least::kInverseDistance) {
      return;
    }
    const double known_m2 = std::max({needs.flank_m2, needs.root_m2, needs.of_interest_m2});
    needs.root_m2 = std::max(
        needs.root_m2, strength::least_root_module2(*root.table, root.need, range_of(), known_m2));
  }

  /// least_loss_factor(); where no loss is looked for, 0 where there is one.
  [[nodiscard]] double factor_of(const Interval& e1, const Interval& e2,
                                 const Interval& ratio) const {
    if (t_.least == StageTask::Least::kLoss) return least_loss_factor(e1, e2, ratio, t_.sliding);
    const bool any = !e1.empty() && !e2.empty() && !ratio.empty() && e1.lo + e2.lo <= ratio.hi &&
                     e1.hi + e2.hi >= ratio.lo;
    return any ? 0.0 : kInfinity;
  }

  /// A gear in a box, a little widened.
  static strength::RootRange root_range(const Interval& shift, const Interval& tip,
                                        const Interval& ratio, const Interval& by_mate) {
    constexpr double kSlack = kRelaxationSlack;
    return {.least_shift = shift.lo,
            .greatest_shift = shift.hi,
            .least_tip = tip.lo - kSlack,
            .greatest_tip = tip.hi + kSlack,
            .least_by_mate = by_mate.lo - kSlack,
            .greatest_by_mate = by_mate.hi + kSlack,
            .least_contact_ratio = ratio.lo,
            .greatest_contact_ratio = ratio.hi};
  }

  /// Of the greatest distance no need of the load is a limit.
  [[nodiscard]] double needed_module2(const strength::FlankNeed& need, const FlankBox& box) const {
    return t_.least == StageTask::Least::kInverseDistance ? 0.0 : least_flank_module2(need, box);
  }

  /// k = x_S + x_P − y of the KHK rule, y = d − (z_S + z_P)/2; 0 where there is none.
  [[nodiscard]] Interval khk_shortening(const Box& box, const Interval& sum) const {
    if (!t_.sun_khk_tip && !t_.planet_khk_tip) return {};
    const double half_sum = 0.5 * (t_.planet.teeth + t_.sun->teeth);
    const Interval& xs = t_.sun->profile_shift;
    return {std::max(0.0, std::max(sum.lo, xs.lo + box.planet_shift.lo) - (box.high.d - half_sum)),
            std::max(0.0, std::min(sum.hi, xs.hi + box.planet_shift.hi) - (box.low.d - half_sum))};
  }

  bool examine_sun(Box& box, Rest& rest, Effects& effects, Needs& needs) const {
    constexpr double kSlack = kRelaxationSlack;
    const StageGear& sun = *t_.sun;
    const Distance& low = box.low;
    const Distance& high = box.high;
    // No structured binding: clang 14 does not let lambdas use one.
    const Interval& sum = rest.sum;
    const Interval& sun_tip = rest.sun_tip;
    const Interval& planet_length = rest.planet_length;
    Interval xs{std::max(sun.profile_shift.lo, sum.lo - box.planet_shift.hi),
                std::min(sun.profile_shift.hi, sum.hi - box.planet_shift.lo)};
    Interval sun_length{base_pitch_ * t_.contact_ratio.lo + low.sun_tangent - planet_length.hi,
                        base_pitch_ * t_.contact_ratio.hi + high.sun_tangent - planet_length.lo};
    sun_length.hi =
        std::min(sun_length.hi, most_length(high.sun_tangent, t_.planet.teeth, sun.teeth));
    if (planet_length.lo > most_length(high.sun_tangent, sun.teeth, t_.planet.teeth) + kSlack) {
      return false;
    }
    if (sun_length.hi < -kSlack) return false;
    if (std::isfinite(sun_length.hi)) {
      xs.hi = std::min(xs.hi,
                       tip_at(sun, sun_base_, std::max(0.0, sun_length.hi)) - sun_tip.lo + kSlack);
    }
    if (sun_length.lo > 0.0) {
      xs.lo = std::max(xs.lo, tip_at(sun, sun_base_, sun_length.lo) - sun_tip.hi - kSlack);
    }
    if (xs.empty()) return false;
    sun_length = {flank_length(sun, sun_base_, xs.lo + sun_tip.lo),
                  flank_length(sun, sun_base_, xs.hi + sun_tip.hi)};
    const double low_tan = low.sun_tangent / sun_sum_;
    const double high_tan = high.sun_tangent / sun_sum_;
    const Interval& e1 =
        rest.sun_e1 = {(sun_length.lo - sun_base_ * high_tan) / base_pitch_ - kSlack,
                       (sun_length.hi - sun_base_ * low_tan) / base_pitch_ + kSlack};
    const Interval& e2 =
        rest.sun_e2 = {(planet_length.lo - planet_base_ * high_tan) / base_pitch_ - kSlack,
                       (planet_length.hi - planet_base_ * low_tan) / base_pitch_ + kSlack};
    const Interval& ratio = rest.sun_ratio = {
        std::max(t_.contact_ratio.lo,
                 (sun_length.lo + planet_length.lo - high.sun_tangent) / base_pitch_) -
            kSlack,
        std::min(t_.contact_ratio.hi,
                 (sun_length.hi + planet_length.hi - low.sun_tangent) / base_pitch_) +
            kSlack};
    const double factor = factor_of(e1, e2, ratio);
    if (factor == kInfinity) return false;
    const double scale = t_.sun_weight * t_.sun_loss;
    box.bound += scale * factor;
    box.error += scale * (e1.width() + e2.width());
    effects.distance += scale * (planet_base_ + sun_base_) * (high_tan - low_tan) / base_pitch_;
    effects.shift += scale * planet_length.width() / base_pitch_;
    needs.flank_m2 = std::max(needs.flank_m2,
                              needed_module2(t_.sun_flank, {.base_pitch = base_pitch_,
                                                            .ratio = ratio.hi,
                                                            .low_tangent = low.sun_tangent,
                                                            .high_tangent = high.sun_tangent,
                                                            .base1 = sun_base_,
                                                            .base2 = planet_base_,
                                                            .base_sum = sun_sum_,
                                                            .length = {sun_length, planet_length},
                                                            .sign = 1.0}));
    const auto of_mate = [&](const Interval& mate) {
      return Interval{base_pitch_ + low.sun_tangent - mate.hi,
                      base_pitch_ + high.sun_tangent - mate.lo};
    };
    add_root(needs, {.table = t_.roots.sun_table, .need = t_.roots.sun},
             [&] { return root_range(xs, sun_length, ratio, of_mate(planet_length)); });
    add_root(needs, {.table = t_.roots.planet_table, .need = t_.roots.planet_of_sun}, [&] {
      return root_range(box.planet_shift, planet_length, ratio, of_mate(sun_length));
    });
    if (t_.least != StageTask::Least::kLoss) return true;
    const LeastShares shares = least_shares(e1, e2, ratio, t_.sliding);
    box.point.sun_shift = std::clamp(
        tip_at(sun, sun_base_,
               std::max(0.0, sun_base_ * 0.5 * (low_tan + high_tan) + base_pitch_ * shares.e1)) -
            sun_tip.middle(),
        xs.lo, xs.hi);
    return true;
  }

  void push(Box box) {
    if (!examine(box)) return;
    heap_.push_back(box);
    std::push_heap(heap_.begin(), heap_.end(), later);
  }

  const StageTask& t_;
  double sin_, cos_, involute_, base_pitch_;
  double ring_sum_, sun_sum_;  ///< base radii: rb2 ∓ rb1
  double planet_base_, ring_base_, sun_base_;
  std::vector<Box> heap_;
};

}  // namespace

StageBound relax_stage(const StageTask& task, const StageEffort& effort) {
  return StageSearch(task).run(effort);
}

TeethReach teeth_reach(const StageTask& task) { return StageSearch(task).reach(); }

Interval center_distances(const StageTask& task) { return StageSearch(task).distances(); }

}  // namespace gear3k::optimize
