// Prices of limits against refining anew with the limit moved, and against functions by hand.

#include "optimize/limit_prices.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "io/files/specification_file.hpp"
#include "optimize/multiplier_range.hpp"
#include "optimize/refine.hpp"
#include "optimize/solve_outcome.hpp"
#include "tests/optimize/random_specification.hpp"
#include "tests/sample.hpp"
#include "tests/strength/steel.hpp"

namespace gear3k::optimize::limit_prices_test {
namespace {

using design::CheckId;

Eigen::MatrixXd columns(const std::vector<std::vector<double>>& list) {
  Eigen::MatrixXd a(static_cast<Eigen::Index>(list.front().size()),
                    static_cast<Eigen::Index>(list.size()));
  for (Eigen::Index k = 0; k < a.cols(); ++k) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      a(i, k) = list[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)];
    }
  }
  return a;
}

TEST(Multipliers, OfIndependentLimitsAreUnique) {
  // Least −2x − 3y with 1 − x ≥ 0 and 1 − y ≥ 0, the second row times 10.
  const Multipliers m(columns({{-1.0, 0.0}, {0.0, -10.0}}), Eigen::Vector2d(-2.0, -3.0));
  EXPECT_NEAR(m.residual(), 0.0, 1e-12);
  const MultiplierRange first = m.range_of(Eigen::Vector2d(1.0, 0.0));
  EXPECT_NEAR(first.least, 2.0, 1e-12);
  EXPECT_NEAR(first.greatest.value(), 2.0, 1e-12);
  // Of both rows together, the second with weight 10 as its gradient: 2 + 3.
  EXPECT_NEAR(m.range_of(Eigen::Vector2d(1.0, 10.0)).least, 5.0, 1e-12);
}

TEST(Multipliers, OfLimitsThatSayTheSameAreARange) {
  // Twice 1 − x ≥ 0: one of them alone gains nothing when it gives way, and costs all when it is
  // tightened; both together are unique.
  const Multipliers m(columns({{-1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}}), Eigen::Vector2d(-2.0, 0.0));
  const MultiplierRange one = m.range_of(Eigen::Vector3d(1.0, 0.0, 0.0));
  EXPECT_NEAR(one.least, 0.0, 1e-12);
  EXPECT_NEAR(one.greatest.value(), 2.0, 1e-12);
  const MultiplierRange both = m.range_of(Eigen::Vector3d(1.0, 1.0, 0.0));
  EXPECT_NEAR(both.least, 2.0, 1e-12);
  EXPECT_NEAR(both.greatest.value(), 2.0, 1e-12);
}

TEST(Multipliers, OfLimitsThatLeaveNoRoomHaveNoGreatestSum) {
  // x ≥ 1 and x ≤ 1: tightening either leaves nothing; giving way of x ≤ 1 gains 2.
  const Multipliers m(columns({{1.0}, {-1.0}}), Eigen::VectorXd::Constant(1, -2.0));
  EXPECT_NEAR(m.range_of(Eigen::Vector2d(0.0, 1.0)).least, 2.0, 1e-12);
  EXPECT_FALSE(m.range_of(Eigen::Vector2d(0.0, 1.0)).greatest);
  EXPECT_NEAR(m.range_of(Eigen::Vector2d(1.0, 0.0)).least, 0.0, 1e-12);
  EXPECT_FALSE(m.range_of(Eigen::Vector2d(1.0, 0.0)).greatest);
}

/// Least and greatest weight·λ over all bases of A λ = b, λ ≥ 0: every choice of as many columns as
/// A has rows.
std::pair<double, double> range_over_bases(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                           const Eigen::VectorXd& weight) {
  std::pair<double, double> range{1e300, -1e300};
  const auto rows = static_cast<std::size_t>(a.rows()), count = static_cast<std::size_t>(a.cols());
  for (std::size_t chosen = 0; chosen < (std::size_t{1} << count); ++chosen) {
    std::vector<Eigen::Index> basis;
    for (std::size_t k = 0; k < count; ++k) {
      if ((chosen >> k & 1U) != 0) basis.push_back(static_cast<Eigen::Index>(k));
    }
    if (basis.size() != rows) continue;
    Eigen::MatrixXd part(a.rows(), a.rows());
    for (std::size_t k = 0; k < rows; ++k) part.col(static_cast<Eigen::Index>(k)) = a.col(basis[k]);
    // Cramer: of 2 × 2 and 3 × 3 by the cross product is enough, dimensions here are 3.
    const Eigen::Vector3d p = part.col(0), q = part.col(1), r = part.col(2), s = b;
    const auto triple = [](const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                           const Eigen::Vector3d& w) {
      return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
             u[2] * (v[0] * w[1] - v[1] * w[0]);
    };
    const double det = triple(p, q, r);
    if (std::abs(det) < 1e-9) continue;
    const Eigen::Vector3d x(triple(s, q, r) / det, triple(p, s, r) / det, triple(p, q, s) / det);
    if (x.minCoeff() < -1e-12) continue;
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) sum += weight[basis[k]] * x[static_cast<Eigen::Index>(k)];
    range = {std::min(range.first, sum), std::max(range.second, sum)};
  }
  return range;
}

TEST(Multipliers, ReachAsFarAsAllBasesSay) {
  rig::DeterministicRandom random(11);
  for (int n = 0; n < 200; ++n) {
    // First row positive: the multipliers are bounded.  λ of two columns alone: a degenerate corner
    // to begin with.
    Eigen::MatrixXd a(3, 6);
    for (Eigen::Index k = 0; k < 6; ++k) {
      a.col(k) << random.between(0.2, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0);
    }
    const Eigen::VectorXd b = a.col(0) * random.between(0.1, 1.0) + a.col(1);
    Eigen::VectorXd weight = Eigen::VectorXd::Zero(6);
    weight[static_cast<Eigen::Index>(random.index(6))] = 1.0;
    weight[static_cast<Eigen::Index>(random.index(6))] += random.uniform();
    const auto [least, greatest] = range_over_bases(a, b, weight);
    const Multipliers m(a, b);
    ASSERT_LE(m.residual(), 1e-9);
    const MultiplierRange range = m.range_of(weight);
    EXPECT_NEAR(range.least, least, 1e-6) << n;
    ASSERT_TRUE(range.greatest) << n;
    EXPECT_NEAR(*range.greatest, greatest, 1e-6) << n;
  }
}

/// The specification with one of its limits moved.
Specification moved(Specification spec, const LimitOf& limit, double by_si) {
  const auto end = [&](NumberRange& range) { (limit.at_least ? range.min : range.max) += by_si; };
  switch (limit.kind) {
    case LimitKind::kCheck:
      if (limit.place >= 0) {
        *spec.limits.mesh_backlash_m[static_cast<std::size_t>(limit.place)] += by_si;
      } else {
        *spec.limits[*limit.check] += by_si;
      }
      break;
    case LimitKind::kProfileShift:
      end(spec.profile_shift);
      break;
    case LimitKind::kRingShift:
      end(*spec.ring_shift);
      break;
    case LimitKind::kModule:
      for (std::size_t stage = 0; stage < 2; ++stage) {
        if (static_cast<int>(stage) == limit.place || has_same_module(spec)) {
          end(*spec.module[stage].range_m);
        }
      }
      break;
    case LimitKind::kTipShortening:
      end(*spec.free.tip_shortening);
      break;
    case LimitKind::kPressureAngle:
      end(*spec.free.pressure_angle_rad);
      break;
    case LimitKind::kTorque:
      spec.rating->torque_Nm += by_si;
      break;
    default:
      ADD_FAILURE() << "no limit that these tasks have";
  }
  return spec;
}

/// Rows and bounds that are active at a point.
std::set<int> active_at(const RefinementProblem& problem, const Point& v) {
  std::vector<double> g(problem.rows.size());
  std::set<int> active;
  if (!evaluate<double>(problem, used(problem, v), g)) return active;
  constexpr double kMet = 1e-6;
  for (std::size_t k = 0; k < g.size(); ++k) {
    if (g[k] <= kMet) active.insert(static_cast<int>(k));
  }
  for (int k = 0; k < problem.variables; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (v[i] - problem.lower[i] <= kMet) active.insert(-1 - 2 * k);
    if (problem.upper[i] - v[i] <= kMet) active.insert(-2 - 2 * k);
  }
  return active;
}

/// The objective [SI] of a tooth set refined anew with a limit moved, where the active set stays.
std::optional<double> refined_anew(const Specification& spec, const SetProblem& from,
                                   const LimitOf& limit, double by_si) {
  const Specification own = moved(spec, limit, by_si);
  const RefinementProblem problem = make_refinement_problem(
      own, from.problem.candidate, from.problem.fixed_module_m, from.problem.branch);
  Point start = from.v;
  for (std::size_t k = 0; k < static_cast<std::size_t>(problem.variables); ++k) {
    start[k] = std::clamp(start[k], problem.lower[k], problem.upper[k]);
  }
  SolveOutcome end = solve_slsqp(problem, start, {});
  end = solve_slsqp(problem, end.v, {});
  if (!(end.violation <= 1e-8)) return std::nullopt;
  if (active_at(problem, end.v) != active_at(from.problem, from.v)) return std::nullopt;
  return -sense_of(problem.objective) * problem.objective_scale * end.objective;
}

struct BankTally {
  int tasks = 0, prices = 0, compared = 0, near = 0, small = 0, other_set = 0, degenerate = 0,
      kinks = 0;
  double worst = 0.0;
};

/// Compares the prices of one optimum, per limit moved both ways by what moves its row by 1e-4.
void compare_prices(const Specification& spec, const RefinedSet& set, BankTally& tally) {
  const HeldBack held = held_back(spec, set, spec.limits);
  if (!held.missing.empty()) {
    ++tally.kinks;
    return;
  }
  const auto from = problem_of(spec, set);
  ASSERT_TRUE(from);
  ++tally.tasks;
  for (const LimitPrice& price : held.prices) {
    if (!price.stated || price.loosened == 0.0) continue;
    ++tally.prices;
    if (!price.unique()) {
      ++tally.degenerate;
      continue;
    }
    const double value = std::abs(price.value_si);
    const bool length = price.unit == units::Unit::kMillimetre ||
                        price.unit == units::Unit::kDiameterMillimetre ||
                        price.unit == units::Unit::kMicrometre;
    const double step = price.unit == units::Unit::kArcmin ? 1e-4 * value : (length ? 5e-8 : 1e-4);
    const auto up = refined_anew(spec, *from, price.limit, step);
    const auto down = refined_anew(spec, *from, price.limit, -step);
    if (!up || !down) {
      ++tally.other_set;
      continue;
    }
    const double quotient = (*up - *down) / (2.0 * step);
    // Two runs differ by 1e-9 of the objective's scale: a price below fifty times that is not known
    // from them.
    const double noise = 1e-9 * from->problem.objective_scale / step;
    if (std::abs(price.loosened) < 50.0 * noise) {
      ++tally.small;
      continue;
    }
    ++tally.compared;
    const double off = std::abs(quotient / price.loosened - 1.0);
    const bool near = off <= 0.02;
    tally.near += near ? 1 : 0;
    tally.worst = std::max(tally.worst, off);
    EXPECT_TRUE(near) << spec.solver.seed << " " << price.key << " " << price.loosened << " is "
                      << quotient;
  }
}

const LimitPrice* price_of_the_load(const HeldBack& held) {
  const auto price = std::ranges::find_if(
      held.prices, [](const LimitPrice& own) { return own.limit.kind == LimitKind::kTorque; });
  return price == held.prices.end() ? nullptr : &*price;
}

/// The paper's gearbox so narrow that the loads of these tests bind.
Specification narrow(double flank_safety_min) {
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/rp96.toml");
  constexpr double kWidth_m = 2e-3;
  spec.bodies.face_width_m = {kWidth_m, kWidth_m};
  spec.rating.emplace();
  spec.rating->material.fill(strength::steel_700_290());
  spec.rating->face_width_m = {kWidth_m, kWidth_m};
  spec.rating->teeth.root_safety_min = 1.5;
  spec.rating->teeth.flank_safety_min = flank_safety_min;
  return spec;
}
const Candidate kPapersTeeth{.teeth = {.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118},
                             .planets = 3};

// Root and flank of P2 bind together.
TEST(LimitPrices, OfTheLoadNamesAGearOnceForItsRootAndItsFlank) {
  Specification spec = narrow(1.48);
  spec.rating->torque_Nm = 30.0;
  const RefinedSet set = refine(spec, kPapersTeeth);
  ASSERT_EQ(set.status, Status::kOptimal);
  const HeldBack held = held_back(spec, set, spec.limits);
  for (const char* key : {"strength.s_f_min", "strength.s_h_min"}) {
    const auto own = std::ranges::find(held.prices, key, &LimitPrice::key);
    ASSERT_NE(own, held.prices.end()) << key;
    EXPECT_EQ(own->where, std::vector<std::string>{"P2 in P2-R2"}) << key;
  }
  const LimitPrice* const price = price_of_the_load(held);
  ASSERT_NE(price, nullptr);
  EXPECT_EQ(price->where, std::vector<std::string>{"P2 in P2-R2"});
}

TEST(LimitPrices, OfTheLoadIsWhatRefiningAnewWithAnotherOneGains) {
  const Specification unrated =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/rp96.toml");
  const RefinedSet unloaded = refine(unrated, kPapersTeeth);
  EXPECT_EQ(price_of_the_load(held_back(unrated, unloaded, unrated.limits)), nullptr);
  Specification spec = narrow(1.2);
  int compared = 0;
  for (const double torque_Nm : {22.0, 26.0, 30.0, 34.0}) {
    spec.rating->torque_Nm = torque_Nm;
    const RefinedSet set = refine(spec, kPapersTeeth);
    ASSERT_EQ(set.status, Status::kOptimal) << torque_Nm;
    const HeldBack held = held_back(spec, set, spec.limits);
    const LimitPrice* const price = price_of_the_load(held);
    const auto from = problem_of(spec, set);
    if (price == nullptr || !from || !price->unique()) continue;
    EXPECT_LT(price->loosened, 0.0) << "the efficiency falls where more is to be carried";
    const double step_Nm = 1e-4 * torque_Nm;
    const auto up = refined_anew(spec, *from, price->limit, step_Nm);
    const auto down = refined_anew(spec, *from, price->limit, -step_Nm);
    if (!up || !down) continue;
    ++compared;
    EXPECT_NEAR((*up - *down) / (2.0 * step_Nm) / price->loosened, 1.0, 0.01) << torque_Nm;
  }
  EXPECT_GE(compared, 2);
}

// A row that does not depend on the torque, missed within the tolerance of feasibility.
TEST(LimitPrices, CarriedTorqueIsFoundWhereAnotherRowIsMissedWithinTheTolerance) {
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml");
  spec.objectives = {Objective::kTorqueCapacity};
  spec.rating->torque_Nm = 5.0;
  const RefinedSet set =
      refine(spec, {.teeth = {.S = 12, .P1 = 64, .R1 = 141, .P2 = 52, .R2 = 132}, .planets = 3});
  ASSERT_EQ(set.status, Status::kOptimal);
  *spec.limits[CheckId::kRingRootDiameter] *= 1.0 - 0.5 * design::kFeasibilityTolerance;
  const auto own = problem_of(spec, set);
  ASSERT_TRUE(own);
  ASSERT_GT(own->problem.torque, 0U);
  const double missed = outcome_at(own->problem, own->v).violation;
  ASSERT_GT(missed, 0.0);
  ASSERT_LE(missed, design::kFeasibilityTolerance);
  Point v = own->v;
  v[own->problem.torque] *= 1.1;
  lower_to_carried_torque(own->problem, v);
  EXPECT_NEAR(v[own->problem.torque] / own->v[own->problem.torque], 1.0, 1e-5);
}

TEST(LimitPrices, AreWhatRefiningAnewWithTheLimitMovedGains) {
  BankTally tally;
  const std::uint64_t tasks = sample<std::uint64_t>(12, 100);
  for (std::uint64_t seed = 1; seed <= 40 * tasks && tally.tasks < static_cast<int>(tasks);
       ++seed) {
    test::RandomTask task =
        seed % 2 == 0 ? test::random_task(seed, 4) : test::random_workshop_task(seed, 4);
    if (seed % 5 == 0) task.spec.objectives = {Objective::kLostMotion};
    if (seed % 7 == 0) task.spec.objectives = {Objective::kOuterDiameter};
    if (seed % 3 == 0) {
      task.spec.tip_shortening = {};
      task.spec.khk_tip = {};
      task.spec.free.tip_shortening = NumberRange{.min = 0.0, .max = 0.3};
    }
    for (const Candidate& candidate : task.candidates) {
      const RefinedSet set = refine(task.spec, candidate);
      if (set.status != Status::kOptimal) continue;
      compare_prices(task.spec, set, tally);
      break;
    }
  }
  EXPECT_EQ(tally.tasks, static_cast<int>(tasks));
  EXPECT_GE(tally.compared, 2 * tally.tasks);
  std::cout << tally.tasks << " optima, " << tally.prices << " prices: " << tally.compared
            << " compared, " << tally.near << " of them within 2 %, worst " << tally.worst << "; "
            << tally.other_set << " where the active set changes, " << tally.small
            << " below the noise, " << tally.degenerate << " not unique; " << tally.kinks
            << " optima on kinks\n";
}

}  // namespace
}  // namespace gear3k::optimize::limit_prices_test
