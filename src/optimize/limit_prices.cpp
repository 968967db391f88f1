#include "optimize/limit_prices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/rack_point.hpp"
#include "optimize/check_row.hpp"
#include "optimize/gradients.hpp"
#include "optimize/kkt_residual.hpp"
#include "optimize/multiplier_range.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/solve_outcome.hpp"
#include "strength/mesh_rating.hpp"

namespace gear3k::optimize {

namespace {

using design::CheckId;

/// Rows and bounds within this of their limits are active, as for the KKT residual.
constexpr double kActiveLimit = 1e-6;

/// |∂g/∂L| of a row at its limit: margins over their scale, but for safeties and sliding, whose
/// rows have slope 1 there (constraint_of()).
double slope_in_limit(const design::CheckInstance& check) {
  const bool unscaled =
      load_exponent(check.record->id) > 0 || check.record->id == CheckId::kSpecificSliding;
  return unscaled ? 1.0 : 1.0 / check.scale;
}

std::string subject_text(const design::CheckInstance& check) {
  const auto names =
      design::subject_names(check, train::kGearNames, train::kMeshNames, train::kMeshGears);
  if (names.mesh.empty() || names.gear.empty()) return names.mesh + names.gear;
  return fmt::format("{} in {}", names.gear, names.mesh);
}

/// What a file states of a limit by which the search may hold a tighter one.
double stated_value(const Specification& spec, const design::Limits& stated,
                    const design::CheckInstance& check) {
  const CheckId id = check.record->id;
  const auto mesh = static_cast<std::size_t>(check.subject.member);
  const bool backlash = id == CheckId::kNormalBacklash;
  const auto in_file = backlash ? design::least_backlash_m(stated, mesh) : stated[id];
  const auto searched = backlash ? design::least_backlash_m(spec.limits, mesh) : spec.limits[id];
  return in_file && searched ? check.limit + (*in_file - *searched) : check.limit;
}

/// The gear whose tooth in a mesh a check is about.
std::size_t gear_of(const design::CheckInstance& check) {
  const auto mesh = static_cast<std::size_t>(check.subject.member);
  return static_cast<std::size_t>(
      train::kMeshGears[mesh][static_cast<std::size_t>(check.subject.which - 1)]);
}

/// The key that states a least safety, of the gear itself where it has its own.  An overload asks
/// for the safeties of the load; of the roots of plastics for one that no file states.
void name_safety(const strength::RatingTask& task, std::size_t gear, CheckId safety,
                 LimitPrice& price) {
  const bool root = safety == CheckId::kRootSafety;
  if (price.limit.check == CheckId::kOverloadRootSafety &&
      strength::is_plastic(task.material[gear]->record.group)) {
    return;
  }
  const strength::StatedTeeth& own = task.gear_teeth[gear];
  price.limit.check = safety;
  price.key = design::check_record(safety).limit_key;
  price.stated = true;
  if (!(root ? own.root_safety_min : own.flank_safety_min)) return;
  price.limit.place = static_cast<int>(gear);
  price.key = fmt::format("gears.{}.{}", train::kGearNames[gear], price.key);
}

LimitPrice limit_of_check(const Specification& spec, const design::Limits& stated,
                          const design::CheckInstance& check) {
  const design::CheckRecord& record = *check.record;
  LimitPrice price{.limit = {.check = record.id, .at_least = record.at_least},
                   .key = key_of_limit(record),
                   .stated = record.threshold || !record.limit_key.empty(),
                   .unit = record.unit,
                   .value_si = stated_value(spec, stated, check)};
  const auto mesh = static_cast<std::size_t>(check.subject.member);
  switch (record.id) {
    case CheckId::kNormalBacklash:
      if (!spec.limits.mesh_backlash_m[mesh]) break;
      price.limit.place = check.subject.member;
      price.key = key_of_limit(price.limit);
      break;
    case CheckId::kRootSafety:
    case CheckId::kOverloadRootSafety:
      name_safety(*spec.rating, gear_of(check), CheckId::kRootSafety, price);
      break;
    case CheckId::kFlankSafety:
    case CheckId::kOverloadFlankSafety:
      name_safety(*spec.rating, gear_of(check), CheckId::kFlankSafety, price);
      break;
    default:
      break;
  }
  return price;
}

LimitPrice limit_of_module(const Specification& spec, int stage, bool at_least) {
  const auto& range = *spec.module[static_cast<std::size_t>(stage)].range_m;
  const char* const end = at_least ? "min" : "max";
  return {.limit = {.kind = LimitKind::kModule, .place = stage, .at_least = at_least},
          .key = has_same_module(spec)
                     ? fmt::format("module.stage1_mm.{0} and module.stage2_mm.{0}", end)
                     : fmt::format("module.stage{}_mm.{}", stage + 1, end),
          .unit = units::Unit::kMillimetre,
          .value_si = at_least ? range.min : range.max};
}

LimitPrice limit_of_range(LimitKind kind, const std::string& key, units::Unit unit, double value_si,
                          bool at_least) {
  return {.limit = {.kind = kind, .at_least = at_least},
          .key = fmt::format("{}[{}]", key, at_least ? 0 : 1),
          .unit = unit,
          .value_si = value_si};
}

/// A column of the conditions of an optimum: which limit it belongs to, and |∂g/∂L|.
struct Pull {
  std::optional<LimitPrice> limit;  ///< empty: no limit, but a branch of the objective
  double weight = 0.0;
  std::string where;
  Eigen::VectorXd gradient;
  std::optional<std::size_t> check_row{};  ///< its place among the rows, where it is a check's
};

/// The load that designs are to carry.
LimitPrice limit_of_torque(const Specification& spec) {
  return {.limit = {.kind = LimitKind::kTorque},
          .key = "strength.output_torque_nm",
          .unit = units::Unit::kNewtonMetre,
          .value_si = spec.rating->torque_Nm};
}

/// Active rows and bounds of a problem at a point.
class ActiveLimits {
 public:
  ActiveLimits(const RefinementProblem& problem, const Point& v, const design::Limits& stated,
               const Gradients& at)
      : p_(problem), v_(v), stated_(stated), at_(at) {
    for (std::size_t k = 0; k < p_.rows.size(); ++k) {
      if (at_.g[k] <= kActiveLimit) add_row(k);
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(p_.variables); ++k) {
      if (v_[k] - p_.lower[k] <= kActiveLimit) add_bound(k, true);
      if (p_.upper[k] - v_[k] <= kActiveLimit) add_bound(k, false);
    }
  }
  [[nodiscard]] const std::vector<Pull>& pulls() const { return pulls_; }

 private:
  void add_row(std::size_t k) {
    const ConstraintRow& row = p_.rows[k];
    const Eigen::VectorXd gradient =
        Eigen::Map<const Eigen::VectorXd>(at_.dg.data() + k * n(), p_.variables);
    if (row.check) {
      if (row.check->record->id == CheckId::kRingTipOutsideBase) {
        ring_on_base_[static_cast<std::size_t>(row.check->subject.member)] = true;
      }
      pulls_.push_back({.limit = limit_of_check(*p_.spec, stated_, *row.check),
                        .weight = slope_in_limit(*row.check),
                        .where = subject_text(*row.check),
                        .gradient = gradient,
                        .check_row = k});
    } else if (row.objective && row.objective->limit) {
      const ObjectiveRecord& record = objective_record(row.objective->objective);
      pulls_.push_back({.limit = LimitPrice{.limit = {.kind = LimitKind::kObjective,
                                                      .place = static_cast<int>(record.id),
                                                      .at_least = record.maximise},
                                            .key = std::string(record.name),
                                            .stated = false,
                                            .value_si = *row.objective->limit},
                        .weight = 1.0 / row.objective->scale,
                        .where = {},
                        .gradient = gradient});
    } else if (row.felt) {
      const FeltRecord& record = felt_record(row.felt->quantity);
      pulls_.push_back({.limit = LimitPrice{.limit = {.kind = LimitKind::kFelt,
                                                      .place = static_cast<int>(row.felt->quantity),
                                                      .at_least = false},
                                            .key = std::string(record.key),
                                            .unit = record.unit,
                                            .value_si = row.felt->value},
                        .weight = felt_slope(*row.felt),
                        .where = {},
                        .gradient = gradient});
    } else if (row.objective) {
      pulls_.push_back({.limit = {}, .weight = 0.0, .where = {}, .gradient = gradient});
    } else {
      pulls_.push_back({.limit = limit_of_module(*p_.spec, row.stage, row.at_least),
                        .weight = 1.0 / p_.length_scale_m,
                        .where = {},
                        .gradient = gradient});
    }
  }

  void add_bound(std::size_t k, bool at_least) {
    const auto axis = static_cast<Eigen::Index>(k);
    Pull pull{.limit = {},
              .weight = 1.0,
              .where = {},
              .gradient = Eigen::VectorXd::Unit(p_.variables, axis) * (at_least ? 1.0 : -1.0)};
    if (k < train::kGearCount) {
      if (!name_shift(k, at_least, pull)) return;
    } else if (k == p_.scale) {
      pull.limit = limit_of_module(*p_.spec, 0, at_least);
      pull.weight = 1.0 / p_.length_scale_m;
    } else if (p_.first_tip > 0 && k >= p_.first_tip && k < p_.first_tip + train::kGearCount) {
      name_tip(k - p_.first_tip, at_least, pull);
    } else if (k == p_.pressure_angle) {
      pull.limit = limit_of_angle(end_of(k, at_least), at_least);
    } else if (k == p_.torque) {
      name_torque(at_least, pull);
    } else if (k == p_.face_width[0] || k == p_.face_width[1]) {
      name_width(k == p_.face_width[0] ? 0 : 1, at_least, pull);
    } else {
      pull.limit = of_search("working_angle", units::Unit::kDegree, end_of(k, at_least), at_least);
    }
    pulls_.push_back(std::move(pull));
  }

  /// @returns whether it is a limit of its own
  bool name_shift(std::size_t gear, bool at_least, Pull& pull) const {
    const Specification& spec = *p_.spec;
    const bool ring = train::kind_of(static_cast<int>(gear)) == geometry::GearKind::kRing;
    const NumberRange& range = shift_limits(spec, static_cast<int>(gear));
    pull.where = train::kGearNames[gear];
    if (at_least && p_.lower[gear] > range.min) {
      if (ring_on_base_[gear]) return false;
      pull.limit =
          of_search("ring_tip_on_base_circle", units::Unit::kModules, p_.lower[gear], true);
      return true;
    }
    const bool own = ring && spec.ring_shift;
    pull.limit = limit_of_range(own ? LimitKind::kRingShift : LimitKind::kProfileShift,
                                own ? "profile_shift.ring_range" : "profile_shift.range",
                                units::Unit::kModules, at_least ? range.min : range.max, at_least);
    return true;
  }
  void name_tip(std::size_t gear, bool at_least, Pull& pull) const {
    const FreeVariables& free = p_.spec->free;
    pull.where = train::kGearNames[gear];
    const double end = at_least ? free.tip_shortening->min : free.tip_shortening->max;
    // A least shortening is a greatest addendum.
    pull.limit = free.addendum_stated
                     ? limit_of_range(LimitKind::kAddendum, "free.addendum", units::Unit::kModules,
                                      p_.spec->rack.addendum - end, !at_least)
                     : limit_of_range(LimitKind::kTipShortening, "free.tip_shortening",
                                      units::Unit::kModules, end, at_least);
  }
  void name_torque(bool at_least, Pull& pull) const {
    const double stated_Nm = p_.spec->rating->torque_Nm;
    pull.weight = 1.0 / stated_Nm;
    if (!at_least) {
      pull.limit =
          of_search("torque", units::Unit::kNewtonMetre, stated_Nm * p_.upper[p_.torque], false);
      return;
    }
    pull.limit = limit_of_torque(*p_.spec);
  }
  void name_width(std::size_t stage, bool at_least, Pull& pull) const {
    const NumberRange& range = *p_.spec->free.face_width_m[stage];
    pull.weight = 1.0 / range.max;
    pull.limit = LimitPrice{
        .limit = {.kind = LimitKind::kFaceWidth,
                  .place = static_cast<int>(stage),
                  .at_least = at_least},
        .key = fmt::format("stage{}.face_width_mm.{}", stage + 1, at_least ? "min" : "max"),
        .unit = units::Unit::kMillimetre,
        .value_si = at_least ? range.min : range.max};
  }
  /// No file states a range by a step wider where the rack's tooth comes to a point.
  [[nodiscard]] LimitPrice limit_of_angle(double end_rad, bool at_least) const {
    LimitPrice limit = limit_of_range(LimitKind::kPressureAngle, "free.pressure_angle_deg",
                                      units::Unit::kDegree, end_rad, at_least);
    const double wider_rad = end_rad + giving_step(limit) * units::si_per(limit.unit);
    if (wider_rad < geometry::pointed_rack_angle(p_.spec->rack)) return limit;
    return of_search("pointed_rack", units::Unit::kDegree, end_rad, at_least);
  }
  static LimitPrice of_search(std::string key, units::Unit unit, double value_si, bool at_least) {
    return {.limit = {.kind = LimitKind::kSearchSpace, .at_least = at_least},
            .key = std::move(key),
            .stated = false,
            .unit = unit,
            .value_si = value_si};
  }

  [[nodiscard]] std::size_t n() const { return static_cast<std::size_t>(p_.variables); }
  [[nodiscard]] double end_of(std::size_t k, bool at_least) const {
    return at_least ? p_.lower[k] : p_.upper[k];
  }

  const RefinementProblem& p_;
  const Point& v_;
  const design::Limits& stated_;
  const Gradients& at_;
  std::array<bool, train::kGearCount> ring_on_base_{};
  std::vector<Pull> pulls_;
};

/// Fills the prices of a limit by the weights |∂g_k/∂L| of its rows.
void fill_price(const RefinementProblem& problem, const Multipliers& multipliers,
                const Eigen::VectorXd& weight, LimitPrice& price) {
  const double scale = problem.objective_scale * sense_of(problem.objective);
  const MultiplierRange range = multipliers.range_of(weight);
  const double per_sum = price.limit.at_least ? -scale : scale;
  price.loosened = per_sum * range.least;
  if (range.greatest) price.tightened = per_sum * *range.greatest;
}

/// The prices of the limits that active rows and bounds belong to.
std::vector<LimitPrice> prices_of(const RefinementProblem& problem, const std::vector<Pull>& pulls,
                                  const Multipliers& multipliers) {
  std::vector<LimitPrice> prices;
  std::vector<Eigen::VectorXd> weights;
  const auto count = static_cast<Eigen::Index>(pulls.size());
  for (Eigen::Index k = 0; k < count; ++k) {
    const Pull& pull = pulls[static_cast<std::size_t>(k)];
    if (!pull.limit) continue;
    const auto same = std::ranges::find_if(prices, [&](const LimitPrice& price) {
      return price.key == pull.limit->key && price.value_si == pull.limit->value_si;
    });
    const auto place = static_cast<std::size_t>(same - prices.begin());
    if (same == prices.end()) {
      prices.push_back(*pull.limit);
      weights.emplace_back(Eigen::VectorXd::Zero(count));
    }
    weights[place][k] = pull.weight;
    if (!pull.where.empty()) prices[place].where.push_back(pull.where);
  }
  for (std::size_t k = 0; k < prices.size(); ++k) {
    fill_price(problem, multipliers, weights[k], prices[k]);
  }
  return prices;
}

/// The price of the load where it is stated and no variable: of all active rows that it moves.
/// Each place once, for root and flank.  Empty where it moves none, or one the other way.
std::optional<LimitPrice> price_of_load(const SetProblem& own, const std::vector<Pull>& pulls,
                                        const Multipliers& multipliers) {
  const RefinementProblem& stated = own.problem;
  // The load moves the stiffness itself, too.
  const auto is_stiffness = [](const ConstraintRow& row) {
    return row.objective && row.objective->objective == Objective::kTorsionalStiffness;
  };
  if (!stated.spec->rating || stated.torque > 0 ||
      stated.objective == Objective::kTorsionalStiffness ||
      std::ranges::any_of(stated.rows, is_stiffness)) {
    return std::nullopt;
  }
  RefinementProblem free = stated;
  free.torque = static_cast<std::size_t>(free.variables++);
  Point v = own.v;
  v[free.torque] = free.lower[free.torque] = free.upper[free.torque] = 1.0;
  std::vector<std::uint16_t> rows;
  for (const Pull& pull : pulls) {
    if (pull.check_row) rows.push_back(static_cast<std::uint16_t>(*pull.check_row));
  }
  Gradients at;
  if (rows.empty() || !evaluate_gradients(free, used(free, v), rows, at)) return std::nullopt;
  LimitPrice price = limit_of_torque(*stated.spec);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(pulls.size()));
  const auto slope_of = [&](std::size_t row) {
    const auto variables = static_cast<std::size_t>(free.variables);
    return at.dg[row * variables + free.torque] / price.value_si;
  };
  double rounding = 0.0;  // what of a slope is none
  for (std::size_t row = 0; row < rows.size(); ++row) {
    rounding = std::max(rounding, 1e-9 * std::abs(slope_of(row)));
  }
  std::size_t row = 0;
  for (std::size_t k = 0; k < pulls.size(); ++k) {
    if (!pulls[k].check_row) continue;
    const double slope = slope_of(row++);
    if (slope > rounding) return std::nullopt;
    if (slope >= -rounding) continue;
    weight[static_cast<Eigen::Index>(k)] = -slope;
    if (std::ranges::count(price.where, pulls[k].where) == 0) price.where.push_back(pulls[k].where);
  }
  if (price.where.empty()) return std::nullopt;
  fill_price(stated, multipliers, weight, price);
  return price;
}

/// The tooth ranges, lists and tolerances that a set has no room in.
std::vector<SearchBound> bounds_met(const Specification& spec, const RefinedSet& set) {
  std::vector<SearchBound> at;
  const train::ToothSet& z = set.candidate.teeth;
  const ToothRanges& teeth = spec.teeth;
  const auto meet = [&](bool met, std::string key, double value) {
    if (met) at.push_back({.key = std::move(key), .value = value});
  };
  const auto meet_range = [&](const char* gear, int count, const IntegerRange& range) {
    meet(count == range.min, fmt::format("teeth.{}[0]", gear), count);
    meet(count == range.max, fmt::format("teeth.{}[1]", gear), count);
  };
  meet_range("S", z.S, teeth.S);
  meet_range("P1", z.P1, teeth.P1);
  meet_range("P2", z.P2, teeth.P2);
  meet(z.R1 == teeth.R1_max, "teeth.R1_max", z.R1);
  meet(z.R2 == teeth.R2_max, "teeth.R2_max", z.R2);
  const int offset = std::abs(z.R1 - (z.S + 2 * z.P1));
  meet(offset == teeth.max_coaxial_offset, "teeth.max_coaxial_offset", offset);
  const int difference = std::min(z.R1 - z.P1, z.R2 - z.P2);
  meet(difference == teeth.min_internal_difference, "teeth.min_internal_difference", difference);
  const auto counts = train::teeth_of(z);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const auto& list = spec.limits.allowed_teeth[i];
    if (list.empty() || !spec.limits[design::CheckId::kAllowedTeeth]) continue;
    const auto [least, most] = std::ranges::minmax(list);
    meet(counts[i] == least || counts[i] == most,
         fmt::format("allowed_teeth.{}", train::kGearNames[i]), counts[i]);
  }
  for (std::size_t stage = 0; stage < 2; ++stage) {
    const auto& series = spec.module[stage].series_m;
    if (series.empty()) continue;
    const double module_m = set.train.module_m[stage];
    meet(module_m == series.front() || module_m == series.back(),
         fmt::format("module.stage{}_mm.series", stage + 1),
         units::decimal_from_si(module_m, units::Unit::kMillimetre));
  }
  // No ratio is at the tolerance exactly: the last twentieth of it counts.
  constexpr double kLastShare = 0.95;
  const double off = std::abs(train::ratio(z) / spec.ratio.target - 1.0);
  meet(off >= kLastShare * spec.ratio.tolerance, "ratio.tolerance", off);
  return at;
}

}  // namespace

double giving_step(const LimitPrice& price) {
  const double sign = price.limit.at_least ? -1.0 : 1.0;
  constexpr double kShare = 0.05;
  if (price.limit.kind == LimitKind::kFelt || price.limit.kind == LimitKind::kTorque) {
    return units::meant_si(sign * kShare * price.value_si, units::Unit::kNone);
  }
  switch (price.unit) {
    case units::Unit::kNone:
    case units::Unit::kModule:
    case units::Unit::kModules:
      return sign * 0.05;
    case units::Unit::kMillimetre:
    case units::Unit::kDiameterMillimetre: {
      const bool large =
          price.key.starts_with("size.") || price.key.find("face_width") != std::string::npos;
      return sign * (large ? 1.0 : 0.05);
    }
    case units::Unit::kNewton:
    case units::Unit::kMegapascal:
      return sign * 10.0;
    default:
      return sign;
  }
}

const LimitPrice* dearest(const HeldBack& held) {
  const auto gain = [](const LimitPrice& price) {
    if (price.refined_gain_si) return std::abs(*price.refined_gain_si);
    return std::abs(price.loosened * units::si_per(price.unit) * giving_step(price));
  };
  const LimitPrice* most = nullptr;
  for (const LimitPrice& price : held.prices) {
    if (!price.stated || price.loosened == 0.0 || is_below_no_backlash(price)) continue;
    if (price.limit.kind == LimitKind::kTorque) continue;
    if (price.refined_gain_si && *price.refined_gain_si == 0.0) continue;
    if (most == nullptr || gain(price) > gain(*most)) most = &price;
  }
  return most;
}

bool LimitPrice::unique() const {
  constexpr double kSamePrice = 1e-6;
  return tightened && std::abs(*tightened - loosened) <= kSamePrice * std::abs(*tightened);
}

void lower_to_carried_torque(const RefinementProblem& problem, Point& v) {
  if (problem.torque == 0) return;
  double& torque = v[problem.torque];
  if (outcome_at(problem, v).feasible()) return;
  double carried = problem.lower[problem.torque], beyond = torque;
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    torque = 0.5 * (carried + beyond);
    (outcome_at(problem, v).feasible() ? carried : beyond) = torque;
  }
  torque = carried;
}

std::string key_of_limit(const design::CheckRecord& record) {
  const std::string key = record.limit_key.empty() ? fmt::format("limits.{}", record.name)
                                                   : std::string(record.limit_key);
  const bool of_range =
      record.id == CheckId::kContactRatioMin || record.id == CheckId::kContactRatioMax;
  return of_range ? key + (record.at_least ? "[0]" : "[1]") : key;
}

std::string key_of_limit(const LimitOf& limit) {
  if (limit.place < 0) return key_of_limit(design::check_record(*limit.check));
  return fmt::format("backlash.{}.min_normal_um",
                     train::kMeshNames[static_cast<std::size_t>(limit.place)]);
}

std::optional<double>& number_of(design::Limits& limits, const LimitOf& limit) {
  return limit.place >= 0 ? limits.mesh_backlash_m[static_cast<std::size_t>(limit.place)]
                          : limits[*limit.check];
}

const std::optional<double>& number_of(const design::Limits& limits, const LimitOf& limit) {
  return limit.place >= 0 ? limits.mesh_backlash_m[static_cast<std::size_t>(limit.place)]
                          : limits[*limit.check];
}

std::optional<SetProblem> problem_of(const Specification& spec, const RefinedSet& set,
                                     double slack) {
  std::array<std::optional<double>, 2> fixed;
  for (std::size_t stage = 0; stage < 2; ++stage) {
    const auto& range = spec.module[stage].range_m;
    if (!range || !(range->min < range->max)) fixed[stage] = set.train.module_m[stage];
  }
  const train::TrainParameters<double> train = train_of(spec, set);
  const double torque_Nm = set.torque_capacity_Nm.value_or(0.0);
  std::optional<SetProblem> best;
  for (const ProblemBranch& branch : branches_of(spec)) {
    SetProblem own{.problem = make_refinement_problem(spec, set.candidate, fixed, branch)};
    own.problem.cutter_teeth = set.train.cutter_teeth;
    own.v = point_of(own.problem, train,
                     {.face_width_m = set.train.face_width_m, .torque_Nm = torque_Nm});
    lower_to_carried_torque(own.problem, own.v);
    if (!(outcome_at(own.problem, own.v).violation <= slack)) continue;
    own.kkt_residual = kkt_residual(own.problem, own.v);
    // NaN where gradients are not defined, which any number is better than.
    if (!best || !(best->kkt_residual <= own.kkt_residual)) best = std::move(own);
  }
  return best;
}

HeldBack held_back(const Specification& spec, const RefinedSet& set, const design::Limits& stated) {
  HeldBack held;
  held.at = bounds_met(spec, set);
  if (spec.shift_step) {
    held.missing = "shifts are multiples of profile_shift.step, between which nothing is";
    return held;
  }
  if (set.status == Status::kNotStationary) {
    held.missing = "the best design found is no optimum, and limits have prices at one";
    return held;
  }
  const std::optional<SetProblem> own = problem_of(spec, set);
  Gradients at;
  if (!own ||
      !evaluate_gradients(own->problem, used(own->problem, own->v), all_rows(own->problem), at)) {
    held.missing = "the optimum misses a limit within its tolerance";
    return held;
  }
  const ActiveLimits active(own->problem, own->v, stated, at);
  const std::vector<Pull>& pulls = active.pulls();
  if (pulls.empty()) return held;
  Eigen::MatrixXd a(own->problem.variables, static_cast<Eigen::Index>(pulls.size()));
  for (std::size_t k = 0; k < pulls.size(); ++k) {
    a.col(static_cast<Eigen::Index>(k)) = pulls[k].gradient;
  }
  const Multipliers multipliers(
      a, Eigen::Map<const Eigen::VectorXd>(at.df.data(), own->problem.variables));
  held.kkt_residual = multipliers.residual();
  if (!(held.kkt_residual <= kStationary)) {
    held.missing = "the optimum is on a kink, where one gradient does not say what a limit costs";
    return held;
  }
  held.prices = prices_of(own->problem, pulls, multipliers);
  if (auto load = price_of_load(*own, pulls, multipliers)) held.prices.push_back(*std::move(load));
  return held;
}

std::vector<RefinedSet> best_per_planets(const Specification& spec,
                                         const std::vector<RefinedSet>& refined) {
  std::vector<RefinedSet> best;
  for (const RefinedSet& set : refined) {
    if (!has_design(set.status)) continue;
    const auto same = std::ranges::find_if(best, [&](const RefinedSet& other) {
      return other.candidate.planets == set.candidate.planets;
    });
    if (same == best.end()) {
      best.push_back(set);
    } else if (merit_order(spec, set) < merit_order(spec, *same)) {
      *same = set;
    }
  }
  std::ranges::sort(best, {}, [](const RefinedSet& set) { return set.candidate.planets; });
  return best;
}

}  // namespace gear3k::optimize
