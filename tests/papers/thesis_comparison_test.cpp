#include "papers/thesis_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "papers/published_sources.hpp"
#include "papers/reproduce_report.hpp"

namespace gear3k::papers::thesis_comparison_test {
namespace {

const ThesisSources& sources() {
  static const ThesisSources kSources = published_sources().thesis;
  return kSources;
}

const ThesisComparison& comparison() {
  static const ThesisComparison kResult = compare_thesis(sources());
  return kResult;
}

const PairLossModel& model(const std::string& name) {
  for (const PairLossModel& m : comparison().models) {
    if (m.name == name) return m;
  }
  throw std::invalid_argument("no model " + name);
}

double figure(const std::string& where, const std::string& name) {
  for (const LedgerEntry& entry : comparison().ledger) {
    if (!entry.where.starts_with(where)) continue;
    for (const Figure& f : entry.figures) {
      if (f.name == name) return f.value;
    }
  }
  throw std::invalid_argument("no figure " + where + ": " + name);
}

/// The thesis's loss written anew: eqs. 2.1, 2.2 with module 1, brute-force mean over its path.
double brute_force_loss(int z1, int z2, double mu) {
  const double alpha = 20.0 * std::numbers::pi / 180.0;
  const double r1 = 0.5 * z1;
  const double r2 = 0.5 * z2;
  const auto addendum = [&](double r) {
    return std::sqrt((r + 1.0) * (r + 1.0) - std::pow(r * std::cos(alpha), 2)) -
           r * std::sin(alpha);
  };
  constexpr int kSteps = 2000;
  const auto integral = [&](double length, double side) {
    double sum = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      const double a = (k + 0.5) / kSteps * length;
      sum += mu * a * (r1 + r2) /
             (r2 * (mu * a + r1 * std::cos(alpha) + side * mu * r1 * std::sin(alpha)));
    }
    return sum * length / kSteps;
  };
  const double approach = addendum(r2);
  const double recess = addendum(r1);
  return (integral(approach, -1.0) + integral(recess, 1.0)) / (approach + recess);
}
constexpr double kMidpointError = 1e-7;  // of the rule above: steps^-2 times a loss below 0.3

struct Expected {
  const char* model;
  double friction, scale, offset, skew_factor, rms;
};

// What an independent recomputation of Table 3.1 found (errata of the thesis, 1), to its digits.
TEST(ThesisComparison, ModelsAndRefitsAreThoseOfTheErrata) {
  for (const Expected& e : {Expected{"single_tooth", 0.5, 1.0, 0.0, 1.0, 0.0534},
                            Expected{"corrected", 0.5, 1.0, 0.025, 100.0, 0.0276},
                            Expected{"refit_scale", 0.5, 0.485, 0.050, 74.0, 0.0152},
                            Expected{"refit_friction", 0.364, 1.0, 0.032, 158.0, 0.0162}}) {
    const PairLossModel& m = model(e.model);
    EXPECT_NEAR(m.friction, e.friction, 0.5e-3) << e.model;
    EXPECT_NEAR(m.symmetric_scale, e.scale, 0.5e-3) << e.model;
    EXPECT_NEAR(m.offset, e.offset, 0.5e-3) << e.model;
    EXPECT_NEAR(m.skew_factor, e.skew_factor, 0.5) << e.model;
    EXPECT_NEAR(m.rms_error, e.rms, 0.5e-4) << e.model;
  }
}

struct Erratum {
  const char *where, *figure;
  double value, half_unit;
};

// Errata of the thesis, 2 and 3, to their digits.
TEST(ThesisComparison, LedgerHoldsTheFiguresOfTheErrata) {
  for (const Erratum& e : std::initializer_list<Erratum>{
           {"Sec. 3.4: largest skew", "largest over Table 3.1 at mu = 0.5", 0.11, 0.5e-2},
           {"Sec. 3.4, 3.4.1: skew", "measured skew 120/16 (7.5:1)", 0.083, 0.5e-3},
           {"Sec. 3.4, 3.4.1: skew", "measured skew 80/40 (2:1)", 0.0, 0.5e-2},
           {"Sec. 3.4: corrected model", "rms error as printed", 0.0276, 0.5e-4},
           {"Sec. 3.4: corrected model", "rms error of the single-tooth model", 0.0534, 0.5e-4}}) {
    EXPECT_NEAR(figure(e.where, e.figure), e.value, e.half_unit) << e.figure;
  }
  EXPECT_EQ(sources().statements.largest_model_skew_percent, 0.015);
}

TEST(ThesisComparison, RowsAreThoseOfTheTableAndPredictionsThoseOfTheEquations) {
  ASSERT_EQ(comparison().rows.size(), 31U);
  ASSERT_EQ(comparison().models.size(), 4U);
  std::vector<double> squares(comparison().models.size());
  for (const PairLossRow& row : comparison().rows) {
    ASSERT_EQ(row.predicted.size(), comparison().models.size());
    for (std::size_t k = 0; k < row.predicted.size(); ++k) {
      const PairLossModel& m = comparison().models[k];
      const double there =
          brute_force_loss(row.measured.driving_teeth, row.measured.driven_teeth, m.friction);
      const double back =
          brute_force_loss(row.measured.driven_teeth, row.measured.driving_teeth, m.friction);
      const double expected = m.symmetric_scale * 0.5 * (there + back) + m.offset +
                              m.skew_factor * 0.5 * (there - back);
      EXPECT_NEAR(row.predicted[k], expected, kMidpointError * (1.0 + m.skew_factor))
          << m.name << ", " << row.measured.driving_teeth << "/" << row.measured.driven_teeth;
      squares[k] += std::pow(row.predicted[k] - row.measured.loss, 2);
    }
  }
  for (std::size_t k = 0; k < squares.size(); ++k) {
    EXPECT_NEAR(comparison().models[k].rms_error, std::sqrt(squares[k] / 31.0), 1e-12);
  }
}

// A least-squares fit leaves residuals at right angles to everything that it could vary.
TEST(ThesisComparison, ResidualsOfTheRefitsAreOrthogonalToTheirParameters) {
  const auto sum_over_rows = [](std::size_t k, auto direction) {
    double product = 0.0;
    double size = 0.0;
    double residual = 0.0;
    for (const PairLossRow& row : comparison().rows) {
      const double r = row.predicted[k] - row.measured.loss;
      const double d = direction(row.measured);
      product += r * d;
      size += d * d;
      residual += r * r;
    }
    return product / std::sqrt(size * residual);  // cosine
  };
  const auto half = [](double friction, double sense) {
    return [=](const MeasuredPairLoss& m) {
      return 0.5 * (brute_force_loss(m.driving_teeth, m.driven_teeth, friction) +
                    sense * brute_force_loss(m.driven_teeth, m.driving_teeth, friction));
    };
  };
  const auto one = [](const MeasuredPairLoss&) { return 1.0; };
  const double mu = model("refit_friction").friction;
  const double skew_factor = model("refit_friction").skew_factor;
  // The midpoint error is 1e-4 of the smallest skew.
  const double allowed = 1e-4;
  EXPECT_NEAR(sum_over_rows(2, one), 0.0, 1e-9);
  EXPECT_NEAR(sum_over_rows(2, half(0.5, 1.0)), 0.0, allowed);
  EXPECT_NEAR(sum_over_rows(2, half(0.5, -1.0)), 0.0, allowed);
  EXPECT_NEAR(sum_over_rows(3, one), 0.0, 1e-9);
  EXPECT_NEAR(sum_over_rows(3, half(mu, -1.0)), 0.0, allowed);
  const auto with_friction = [&](const MeasuredPairLoss& m) {
    const double h = 1e-3;
    return ((half(mu + h, 1.0)(m) + skew_factor * half(mu + h, -1.0)(m)) -
            (half(mu - h, 1.0)(m) + skew_factor * half(mu - h, -1.0)(m))) /
           (2.0 * h);
  };
  EXPECT_NEAR(sum_over_rows(3, with_friction), 0.0, allowed);
}

TEST(LossMap, PartsAddUpAndReverseWithTheDirection) {
  const LossMap& map = comparison().map;
  const std::size_t n = map.teeth.size();
  ASSERT_EQ(map.points.size(), n * n);
  EXPECT_EQ(map.friction, 0.3);
  EXPECT_EQ(map.teeth.front(), 10);
  EXPECT_EQ(map.teeth.back(), 120);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const LossMap::Point& p = map.points[i * n + j];
      const LossMap::Point& back = map.points[j * n + i];
      EXPECT_EQ(p.driving_teeth, map.teeth[i]);
      EXPECT_EQ(p.driven_teeth, map.teeth[j]);
      EXPECT_NEAR(p.loss, brute_force_loss(p.driving_teeth, p.driven_teeth, 0.3), kMidpointError);
      EXPECT_EQ(p.symmetric, back.symmetric);
      EXPECT_EQ(p.skew, -back.skew);
      EXPECT_NEAR(p.symmetric + p.skew, p.loss, 1e-15);
      EXPECT_EQ(p.on_involutes, back.on_involutes);
      // The loss falls with the size of either gear (section 2.1).
      if (i > 0) {
        EXPECT_LT(p.symmetric, map.points[(i - 1) * n + j].symmetric);
      }
    }
  }
}

TEST(ThesisLedger, IsNumberedAndEveryFigureIsComputed) {
  ASSERT_EQ(comparison().ledger.size(), 11U);
  int number = 0;
  for (const LedgerEntry& entry : comparison().ledger) {
    EXPECT_EQ(entry.number, ++number);
    EXPECT_FALSE(entry.figures.empty()) << entry.where;
    for (const Figure& f : entry.figures) EXPECT_TRUE(std::isfinite(f.value)) << f.name;
  }
}

TEST(ThesisLedger, EquationsHoldWithTheDistanceAlongTheLineOfActionOnly) {
  for (const auto& [equation, contact] : {std::pair{"by eq. 2.1", "first contact by moments"},
                                          {"by eq. 2.2", "last contact by moments"}}) {
    const double moments = figure("eqs. 2.1, 2.2", contact);
    EXPECT_NEAR(figure("eqs. 2.1, 2.2", equation), moments, 1e-12);
    EXPECT_LT(figure("eqs. 2.1, 2.2", std::string(equation) + " with a from the line of centres"),
              0.97 * moments);
  }
}

TEST(ThesisLedger, LimitsAddUpToEquation23AndPassTheTangentPoint) {
  const auto range = [](const char* name) { return figure("ranges of eqs.", name); };
  EXPECT_NEAR(range("limit of 2.1") + range("limit of 2.2"), range("eq. 2.3"), 1e-12);
  EXPECT_GT(range("limit of 2.1"), range("tangent point"));
  // At 20 deg 16 teeth run with 101 at most: of Table 3.1 only 16/120, in both directions.
  EXPECT_EQ(range("rows of Table 3.1 past it"), 2.0);
}

TEST(ThesisLedger, MeasuredSkewGrowsWithTheRatioAtEveryPinion) {
  const auto skew = [](const char* name) { return figure("Sec. 3.4, 3.4.1: skew", name); };
  EXPECT_LT(skew("pinion 16: at gear 80"), skew("pinion 16: at gear 120"));
  EXPECT_LT(skew("pinion 18: at gear 80"), skew("pinion 18: at gear 120"));
  EXPECT_LT(skew("pinion 20: at gear 80"), skew("pinion 20: at gear 100"));
  EXPECT_LT(skew("pinion 24: at gear 80"), skew("pinion 24: at gear 120"));
  EXPECT_LT(skew("pinion 30: at gear 80"), skew("pinion 30: at gear 120"));
  EXPECT_GT(skew("pinion 16: at gear 120"), skew("pinion 30: at gear 120"));
  // One skew for all pairs explains the table far worse than one in proportion to the model's.
  EXPECT_GT(skew("rms error with the same skew for all"), 1.5 * skew("rms error with scaled skew"));
}

TEST(ThesisLedger, LargerDriverDoesNotAlwaysLoseMore) {
  // Of Table 3.1: 80 driving 40 loses 0.075, 40 driving 80 loses 0.078.
  EXPECT_EQ(figure("Sec. 3.4.1", "without greater loss when the larger drives"), 1.0);
  EXPECT_EQ(figure("Sec. 3.4.1", "pairs measured both ways"), 15.0);
  EXPECT_NEAR(figure("Sec. 3.4.1: larger gears", "measured skew 80/40"), -0.15, 1e-12);
  // And of the thesis's own equations.
  EXPECT_LT(brute_force_loss(120, 60, 0.3), brute_force_loss(60, 120, 0.3));
  EXPECT_GT(figure("Sec. 2.1, Fig. 2-2c", "with less loss when the larger drives"), 0.0);
}

TEST(ThesisReport, JsonHoldsMapModelsResidualsAndLedger) {
  Reproduction r;
  r.thesis = comparison();
  const auto json =
      nlohmann::json::parse(reproduce_json(r).text()).at("directional_impedance_thesis");
  const auto& map = json.at("loss_map");
  const std::size_t n = comparison().map.teeth.size();
  for (const char* part : {"loss", "symmetric", "skew", "on_involutes"}) {
    ASSERT_EQ(map.at(part).size(), n) << part;
    for (const auto& row : map.at(part)) EXPECT_EQ(row.size(), n) << part;
  }
  EXPECT_NEAR(map.at("loss")[0][n - 1].get<double>(), brute_force_loss(10, 120, 0.3),
              kMidpointError)
      << "driving teeth are the rows";
  ASSERT_EQ(json.at("rows").size(), 31U);
  for (const auto& row : json.at("rows")) {
    for (const auto& m : json.at("models")) {
      const auto name = m.at("name").get<std::string>();
      EXPECT_EQ(row.at("measured").get<double>() - row.at("predicted").at(name).get<double>(),
                row.at("residual").at(name).get<double>());
    }
  }
  EXPECT_EQ(json.at("ledger").size(), comparison().ledger.size());
}

TEST(ThesisReport, CsvHoldsEveryMapPointAndResidualInEightColumns) {
  Reproduction r;
  r.thesis = comparison();
  std::istringstream lines(reproduce_csv(r));
  std::string line;
  int residuals = 0;
  int map_points = 0;
  while (std::getline(lines, line)) {
    int columns = 1;
    bool quoted = false;
    for (const char c : line) {
      quoted = quoted != (c == '"');
      if (c == ',' && !quoted) ++columns;
    }
    EXPECT_EQ(columns, 8) << line;
    residuals += line.find("residual (measured - model)") != std::string::npos ? 1 : 0;
    map_points += line.find("\"skew loss, ") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(residuals, 31 * 4);
  EXPECT_EQ(map_points, 12 * 12);
}

TEST(ThesisComparison, WithoutEnoughRowsSaysSo) {
  ThesisSources few = sources();
  few.measured.resize(3);
  EXPECT_THROW(static_cast<void>(compare_thesis(few)), std::invalid_argument);
  ThesisSources one_way = sources();
  std::erase_if(one_way.measured, [](const auto& m) { return m.driving_teeth > m.driven_teeth; });
  EXPECT_THROW(static_cast<void>(compare_thesis(one_way)), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::papers::thesis_comparison_test
