#include "calibrate/verdict/unexplained.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>
#include <string>

#include "calibrate/verdict/noise_level.hpp"
#include "tests/calibrate/rig_campaign.hpp"

namespace gear3k::calibrate::unexplained_test {
namespace {

class Shape : public testing::Test {
 protected:
  Shape() : simulation_(design_of(rig::bilateral_drive_gear()), Kind::kTransmission) {}
  [[nodiscard]] Problem problem(const MeasurementSet& data) const {
    return {.simulation = simulation_, .data = data, .noise = make_noise_model(data)};
  }
  Simulation simulation_;
};

TEST_F(Shape, HasTheMeansOfTheLevels) {
  const MeasurementSet data = campaign(Kind::kTransmission);
  const auto levels = covariate_levels(data);
  const auto load = std::ranges::find(levels, "load", &Levels::name);
  ASSERT_NE(load, levels.end());
  // A residual of one value for each load: the term is all of it.
  const auto n = static_cast<Eigen::Index>(data.rows.size());
  Eigen::VectorXd residual(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    residual[i] = 0.01 * std::pow(-1.0, load->of[static_cast<std::size_t>(i)]);
  }
  Columns columns;
  columns.residual = residual;
  const EmpiricalTerm term{.along = "load", .columns = indicators(*load)};
  Remainder remainder;
  describe_shape(problem(data), columns, term, levels, residual, remainder);
  EXPECT_EQ(remainder.along, "load");
  EXPECT_NEAR(remainder.share, 1.0, 1e-12);
  ASSERT_EQ(remainder.at.size(), static_cast<std::size_t>(load->count));
  int rows = 0;
  for (std::size_t k = 0; k < remainder.at.size(); ++k) {
    EXPECT_NEAR(remainder.mean[k], k % 2 == 0 ? 0.01 : -0.01, 1e-15);
    EXPECT_NEAR(remainder.term[k], remainder.mean[k], 1e-12);
    rows += remainder.rows[k];
  }
  EXPECT_EQ(rows, static_cast<int>(n));
}

TEST_F(Shape, OfAWaveIsItsTwelfths) {
  // Angles over ten turns of a wave of the third order: each twelfth has the mean of the cosine
  // over it, (6/π)(sin φ₂ − sin φ₁).
  MeasurementSet data;
  constexpr int kRows = 3600;
  Eigen::VectorXd residual(kRows);
  Eigen::MatrixXd columns(kRows, 2);
  for (int i = 0; i < kRows; ++i) {
    Observation row;
    row.condition.output_angle_rad = 20.0 * std::numbers::pi * (i + 0.5) / kRows;
    const double phase = 3.0 * row.condition.output_angle_rad;
    residual[i] = std::cos(phase);
    columns(i, 0) = std::cos(phase);
    columns(i, 1) = std::sin(phase);
    data.rows.push_back(row);
  }
  Columns at;
  at.residual = residual;
  Remainder remainder;
  describe_shape(problem(data), at, {.along = "angle", .columns = columns, .order = 3.0}, {},
                 residual, remainder);
  ASSERT_EQ(remainder.at.size(), 12U);
  for (int k = 0; k < 12; ++k) {
    const auto at_k = static_cast<std::size_t>(k);
    const double from = std::numbers::pi * k / 6.0;
    const double to = std::numbers::pi * (k + 1) / 6.0;
    EXPECT_NEAR(remainder.at[at_k], 15.0 + 30.0 * k, 1e-12);
    EXPECT_NEAR(remainder.mean[at_k], 6.0 / std::numbers::pi * (std::sin(to) - std::sin(from)),
                1e-3);
    EXPECT_EQ(remainder.rows[at_k], kRows / 12);
  }
}

/// Rows of stated scatter 1 that are off by some deviations to either side in turn, beside a cause
/// that took off others.
struct ScatteredRows {
  NoiseModel noise;
  Eigen::VectorXd left;
  Columns before;
};
ScatteredRows scattered_rows(Eigen::Index n, double off, double taken_off) {
  ScatteredRows rows;
  rows.noise.source = NoiseSource::kStated;
  rows.noise.weight = Eigen::VectorXd::Ones(n);
  rows.left.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) rows.left[i] = i % 2 == 0 ? off : -off;
  rows.before.raw = Eigen::VectorXd::Constant(n, taken_off);
  return rows;
}

TEST(UnderstatedScatter, HasTheChanceOfItsChiSquare) {
  constexpr int kRows = 100, kDegrees = 98;
  // Squares of 1.5² a row: more than 1.25², and the median too.
  const ScatteredRows rows = scattered_rows(kRows, 2.0, 0.0);
  const double p = cdf(complement(boost::math::chi_squared(kDegrees), 4.0 * kRows));
  EXPECT_NEAR(chance_of_scatter(rows.noise, rows.left, kDegrees), p, 1e-9 * p);
  // As stated within a quarter.
  EXPECT_EQ(chance_of_scatter(rows.noise, 0.6 * rows.left, kDegrees), 1.0);
  // A tenth of the rows, however far off.
  Eigen::VectorXd outliers = 0.5 * rows.left;
  for (Eigen::Index i = 0; i < kRows; i += 10) outliers[i] = 1e3;
  EXPECT_EQ(chance_of_scatter(rows.noise, outliers, kDegrees), 1.0);
  // Nothing is stated.
  NoiseModel unknown = rows.noise;
  unknown.source = NoiseSource::kResiduals;
  EXPECT_EQ(chance_of_scatter(unknown, rows.left, kDegrees), 1.0);
}

TEST(UnderstatedScatter, OfManyRowsIsNoStructure) {
  const ScatteredRows rows = scattered_rows(100, 3.0, 10.0);
  for (const bool has_causes : {false, true}) {
    Contest contest;
    const auto note =
        settle(contest, rows.noise, {.whitened = rows.left, .degrees = 99, .scale = 3.0},
               rows.before, 0.01, has_causes);
    EXPECT_FALSE(contest.structure);
    EXPECT_FALSE(note.has_value());
  }
}

TEST(UnderstatedScatter, OfManyRowsIsStructureWhereNoSigmaIsMisstatedSoFar) {
  const ScatteredRows rows = scattered_rows(100, 5.0, 10.0);
  Contest contest;
  settle(contest, rows.noise, {.whitened = rows.left, .degrees = 99, .scale = 5.0}, rows.before,
         0.01, false);
  EXPECT_TRUE(contest.structure);
  EXPECT_LT(contest.remainder.p_value, 1e-6);
}

TEST(UnderstatedScatter, OfFewRowsIsStructureBesideACauseUnlessItIsLittleOfTheDiscrepancy) {
  constexpr Eigen::Index kRows = 14;
  constexpr int kDegrees = 13;
  const auto settled = [](double taken_off) {
    const ScatteredRows rows = scattered_rows(kRows, 3.0, taken_off);
    Contest contest;
    const auto note =
        settle(contest, rows.noise, {.whitened = rows.left, .degrees = kDegrees, .scale = 3.0},
               rows.before, 0.01, true);
    EXPECT_LT(contest.remainder.p_value, 1e-6);
    EXPECT_EQ(note.has_value(), !contest.structure);
    return note;
  };
  // 3² n − ν of the squares beyond what is stated, against n (10² − 1): 8.2 %.
  EXPECT_FALSE(settled(10.0).has_value());
  // Against n (30² − 1): 0.90 %.
  const auto note = settled(30.0);
  ASSERT_TRUE(note.has_value());
  EXPECT_TRUE(tells_of_minor_remainder(*note));
  EXPECT_NE(note->find(" 0.9 % of the squares"), std::string::npos) << *note;
}

TEST(MinorRemainder, IsNoneWhereRowsAsTheyAreKeepMuch) {
  const ScatteredRows rows = scattered_rows(100, 1.0, 30.0);
  const auto is_minor = [&](double missed_by_effects, bool of_time_alone, const char* along) {
    Contest contest{.structure = true, .stays = {true}, .remainder = {}};
    contest.remainder.best.along = along;
    contest.remainder.best.statistic = 100.0;  // of 90,000
    NoiseModel unknown = rows.noise;
    unknown.source = NoiseSource::kResiduals;
    const auto note = settle(contest, unknown,
                             {.whitened = rows.left,
                              .degrees = 99,
                              .scale = 1.0,
                              .missed = 901.0,
                              .missed_by_effects = missed_by_effects,
                              .noise = 1.0,
                              .of_time_alone = of_time_alone},
                             rows.before, 0.01, true);
    EXPECT_EQ(note.has_value(), !contest.structure);
    return note.has_value();
  };
  EXPECT_TRUE(is_minor(1.0, false, "load"));
  // 19 or 17 beyond noise, of 900.
  EXPECT_FALSE(is_minor(20.0, false, "load"));
  EXPECT_TRUE(is_minor(18.0, false, "load"));
  // A law of time of another shape leaves nothing along the test torque; one of another target may
  // along the load.
  EXPECT_FALSE(is_minor(1.0, true, "test torque"));
  EXPECT_TRUE(is_minor(1.0, false, "test torque"));
  EXPECT_TRUE(is_minor(1.0, true, "load"));
  EXPECT_TRUE(is_minor(1.0, true, "time"));
}

/// A fit of one cause to data that hold it, and a term to put beside it.
class AContest : public Shape {
 protected:
  AContest() : data_(campaign(Kind::kTransmission)) {
    const Hypothesis drag =
        hypothesis({candidate("drag_constant", {.name = "sun", .body = "sun"})}, {0.02});
    const Eigen::VectorXd y = simulated(simulation_, data_, drag).value();
    RandomBits random(4);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].response = y[static_cast<Eigen::Index>(i)] + 0.002 * random.normal();
    }
  }
  struct Sides {
    SearchResult found;
    Columns base, fitted;
  };
  [[nodiscard]] Sides search(const Problem& p) const {
    Sides s;
    s.found = search_causes(p, candidates_for(simulation_, data_), {});
    s.base = columns_at(p, {}, {}, robust_deviation(s.found.fit.residual) * 10.0);
    s.fitted = columns_at(p, s.found.fit.hypothesis, {}, s.found.scale);
    return s;
  }
  [[nodiscard]] RemainderSearch search_with(const EmpiricalTerm& term, double p) const {
    RemainderSearch r;
    r.best = term;
    r.p_value = p;
    return r;
  }
  MeasurementSet data_;
};

TEST_F(AContest, KeepsACauseThatTheDataNeed) {
  const Problem p = problem(data_);
  const Sides s = search(p);
  ASSERT_EQ(s.found.effects.size(), 1U);
  const auto levels = covariate_levels(data_);
  const EmpiricalTerm rotation{
      .along = "rotation",
      .columns = indicators(*std::ranges::find(levels, "rotation", &Levels::name)),
      .evidence = 1.0};
  // No structure: nothing changes.
  const Contest quiet = causes_against_structure(
      s.found, s.base, s.fitted, search_with(rotation, 1.0), search_with(rotation, 1.0), 0.01);
  EXPECT_FALSE(quiet.structure);
  EXPECT_EQ(quiet.stays, std::vector<bool>{true});
  // Structure along the rotation beside a drag that brakes either way: both are there.
  const Contest both = causes_against_structure(
      s.found, s.base, s.fitted, search_with(rotation, 1.0), search_with(rotation, 1e-6), 0.01);
  EXPECT_TRUE(both.structure);
  EXPECT_EQ(both.stays, std::vector<bool>{true});
}

TEST_F(AContest, DropsACauseThatOnlyImitatesATerm) {
  const Problem p = problem(data_);
  Sides s = search(p);
  // A term that holds the very thing that the drag does, as levels hold a constant: the drag is all
  // of it, and stays.
  const EmpiricalTerm same{.along = "load", .columns = s.fitted.own, .evidence = 1.0};
  const Contest most = causes_against_structure(s.found, s.base, s.fitted, search_with(same, 1.0),
                                                search_with(same, 1e-6), 0.01);
  EXPECT_EQ(most.stays, std::vector<bool>{true});
  // As much again that is not the drag: a term that is both leaves nothing to the drag, which is
  // half of it.
  const Eigen::VectorXd drag = s.fitted.own.col(0) * s.found.fit.hypothesis.value[0];
  Eigen::VectorXd other(drag.size());
  for (Eigen::Index i = 0; i < other.size(); ++i) other[i] = i % 3 == 0 ? 1.0 : -0.5;
  other -= drag * (drag.dot(other) / drag.squaredNorm());
  other *= drag.norm() / other.norm();
  s.fitted.residual += other;
  const EmpiricalTerm whole{.along = "load", .columns = drag + other, .evidence = 1.0};
  const Contest beside = causes_against_structure(
      s.found, s.base, s.fitted, search_with(whole, 1.0), search_with(whole, 1e-6), 0.01);
  EXPECT_EQ(beside.stays, std::vector<bool>{false});
  // One of the baseline's residuals that does the very same, in fewer parameters or a better known
  // place: where the drag leaves nothing, there is nothing for it to explain.
  EmpiricalTerm far = same;
  far.evidence = 1e4;
  EXPECT_EQ(causes_against_structure(s.found, s.base, s.fitted, search_with(far, 1e-6),
                                     search_with(same, 1.0), 0.01)
                .stays,
            std::vector<bool>{true});
  // One that explains far more than the causes do.
  far.columns.resize(other.size(), 2);
  far.columns << s.fitted.own.col(0), other;
  const Contest against = causes_against_structure(
      s.found, s.base, s.fitted, search_with(far, 1e-6), search_with(same, 1.0), 0.01);
  EXPECT_TRUE(against.structure);
  EXPECT_EQ(against.stays, std::vector<bool>{false});
  EXPECT_EQ(against.remainder.best.evidence, 1e4);
}

}  // namespace
}  // namespace gear3k::calibrate::unexplained_test
