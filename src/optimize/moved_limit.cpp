#include "optimize/moved_limit.hpp"

#include <utility>

namespace gear3k::optimize {

namespace {

using design::CheckId;

void move_end(NumberRange& range, bool at_least, double by_si) {
  (at_least ? range.min : range.max) += by_si;
}

/// Both what is asked for and what can be carried follow the load's own least safety.
void state_safety(strength::RatingTask& task, const LimitOf& limit, double value) {
  strength::StatedTeeth& teeth =
      limit.place >= 0 ? task.gear_teeth[static_cast<std::size_t>(limit.place)] : task.teeth;
  (*limit.check == CheckId::kRootSafety ? teeth.root_safety_min : teeth.flank_safety_min) = value;
}

bool move_check(Specification& spec, const LimitPrice& price, double by_si) {
  const LimitOf& limit = price.limit;
  if (*limit.check == CheckId::kRootSafety || *limit.check == CheckId::kFlankSafety) {
    state_safety(*spec.rating, limit, price.value_si + by_si);
    return true;
  }
  std::optional<double>& value = number_of(spec.limits, limit);
  if (value) *value += by_si;
  return value.has_value();
}

void move_modules(Specification& spec, const LimitOf& limit, double by_si) {
  for (std::size_t stage = 0; stage < spec.module.size(); ++stage) {
    if (static_cast<int>(stage) != limit.place && !has_same_module(spec)) continue;
    move_end(*spec.module[stage].range_m, limit.at_least, by_si);
  }
}

/// Tips are shortened from the greatest addendum.
void move_addendum(Specification& spec, bool at_least, double by_si) {
  spec.free.tip_shortening->max += at_least ? -by_si : by_si;
  if (!at_least) spec.rack.addendum += by_si;
}

}  // namespace

std::optional<Specification> with_limit_moved(const Specification& spec, const LimitPrice& price,
                                              double by_si) {
  Specification own = spec;
  const LimitOf& limit = price.limit;
  switch (limit.kind) {
    case LimitKind::kCheck:
      if (!move_check(own, price, by_si)) return std::nullopt;
      break;
    case LimitKind::kProfileShift:
      move_end(own.profile_shift, limit.at_least, by_si);
      break;
    case LimitKind::kRingShift:
      move_end(*own.ring_shift, limit.at_least, by_si);
      break;
    case LimitKind::kModule:
      move_modules(own, limit, by_si);
      break;
    case LimitKind::kTipShortening:
      move_end(*own.free.tip_shortening, limit.at_least, by_si);
      break;
    case LimitKind::kAddendum:
      move_addendum(own, limit.at_least, by_si);
      break;
    case LimitKind::kPressureAngle:
      move_end(*own.free.pressure_angle_rad, limit.at_least, by_si);
      break;
    case LimitKind::kObjective:
    case LimitKind::kFaceWidth:
    case LimitKind::kTorque:
    case LimitKind::kFelt:
    case LimitKind::kSearchSpace:
      return std::nullopt;
  }
  return own;
}

}  // namespace gear3k::optimize
