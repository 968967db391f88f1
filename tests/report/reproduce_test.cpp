#include "report/reproduce.hpp"

#include <gtest/gtest.h>

#include "io/design_file.hpp"
#include "io/published_sources.hpp"

namespace gear3k::report {
namespace {

const Reproduction& reproduction() {
  static const Reproduction kResult = reproduce(io::published_sources());
  return kResult;
}

const ComparedRow& row(std::size_t gearbox, const std::string& quantity) {
  for (const ComparedRow& r : reproduction().gearboxes[gearbox].rows) {
    if (r.quantity.starts_with(quantity)) return r;
  }
  throw std::invalid_argument("no row " + quantity);
}

const std::string& ledger(int number) {
  return reproduction().ledger.at(static_cast<std::size_t>(number - 1)).computed;
}

void expect_ledger_holds(int number, const std::vector<std::string>& figures) {
  for (const std::string& figure : figures) {
    EXPECT_NE(ledger(number).find(figure), std::string::npos)
        << number << ": no " << figure << " in: " << ledger(number);
  }
}

// Figures of the independent recomputation of the paper, to their printed digits.
TEST(Reproduce, RatiosAndDistancesAreThoseOfTheErrata) {
  EXPECT_NEAR(*row(0, "ratio").equations, 95.907, 0.5e-3);
  EXPECT_NEAR(*row(1, "ratio").equations, 5967.0 / 62.0, 1e-12);
  const double half_digit = 0.5e-4;
  EXPECT_NEAR(*row(0, "zero-backlash centre distance S-P1").equations, 16.2077, half_digit);
  EXPECT_NEAR(*row(0, "zero-backlash centre distance P1-R1").equations, 16.1813, half_digit);
  EXPECT_NEAR(*row(0, "zero-backlash centre distance P2-R2").equations, 16.1752, half_digit);
  EXPECT_NEAR(*row(1, "zero-backlash centre distance S-P1").equations, 21.2679, half_digit);
  EXPECT_NEAR(*row(1, "zero-backlash centre distance P1-R1").equations, 21.2679, half_digit);
  EXPECT_NEAR(*row(1, "zero-backlash centre distance P2-R2").equations, 21.2687, half_digit);
}

TEST(Reproduce, InertiaFactorsAreThoseOfTheErrata) {
  EXPECT_NEAR(*row(0, "J_P factor per planet, rolling part").paper, 6.5, 0.05);
  EXPECT_NEAR(*row(0, "J_P factor per planet, rolling part").equations, 282.0, 0.5);
}

TEST(Reproduce, FrictionFitsAreThoseOfTheErrata) {
  struct Fit {
    std::size_t gearbox;
    double mu, backward_percent, backward_mu;
  };
  for (const Fit& expected : {Fit{0, 0.105, 85.7, 0.128}, Fit{1, 0.136, 88.1, 0.169}}) {
    const FrictionFit& fit = reproduction().gearboxes[expected.gearbox].fits.at(0);
    EXPECT_EQ(fit.model, "ohlendorf");
    EXPECT_NEAR(fit.mu, expected.mu, 0.5e-3);
    EXPECT_NEAR(100.0 * fit.backward, expected.backward_percent, 0.05);
    EXPECT_NEAR(fit.backward_mu, expected.backward_mu, 0.5e-3);
    EXPECT_GT(fit.backward - fit.measured_backward, 0.025) << "about three points unexplained";
  }
}

TEST(Reproduce, AllowanceThatExplainsTheLostMotionIsProportionalToIt) {
  // The kinematic lost motion is linear in q: two published gearboxes, each checked by the slope.
  for (const std::size_t gearbox : {0U, 1U}) {
    const double q = *row(gearbox, "allowance q that explains").equations;
    EXPECT_GT(q, 0.01);
    EXPECT_LT(q, 0.2);
  }
}

TEST(Reproduce, LedgerHoldsTheThirteenErrataWithTheirFigures) {
  ASSERT_EQ(reproduction().ledger.size(), 13U);
  expect_ledger_holds(1, {"-0.0", "0.8761"});
  expect_ledger_holds(2, {"95.907", "96.242"});
  expect_ledger_holds(3, {"21.2759", "21.2687", "21.2679"});
  expect_ledger_holds(
      4, {"16.2077", "16.1813", "16.1752", "12 um", "16.193", "20 um", "55 um", "11 %"});
  expect_ledger_holds(5, {"108", "296", "12: identical planets do not fit", "102", "279"});
  expect_ledger_holds(7, {"0.500"});
  expect_ledger_holds(9, {"-7.3", "6.5", "282"});
  expect_ledger_holds(10, {"0.105", "85.7", "0.128", "0.136", "88.1", "0.169", "1.27", "1.20"});
  expect_ledger_holds(11, {"86.3", "90.9"});
  expect_ledger_holds(13, {"1/440", "1/29"});
}

TEST(Reproduce, Equation2WithTheWorkingAngleEqualsEquation13) {
  // "... with alpha_w1 in its place A um, which is eq. 13's B um": A and B as printed.
  const std::string& text = ledger(12);
  const auto number_after = [&](const std::string& words) {
    return std::stod(text.substr(text.find(words) + words.size()));
  };
  EXPECT_DOUBLE_EQ(number_after("in its place "), number_after("eq. 13's "));
  EXPECT_NE(number_after("a backlash of "), number_after("eq. 13's "));
}

TEST(Reproduce, ExampleDesignsAreTheGearboxesOfTheData) {
  const PublishedSources sources = io::published_sources();
  const std::string folder = std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/";
  for (const auto& [file, published] :
       {std::pair{"low_backlash_prototype.toml", &sources.low_backlash.design},
        std::pair{"bilateral_drive_gear.toml", &sources.bilateral.design}}) {
    const design::Design example = io::read_design(folder + file);
    EXPECT_EQ(example.train.teeth, published->train.teeth);
    EXPECT_EQ(example.train.planets, published->train.planets);
    EXPECT_EQ(example.train.profile_shift, published->train.profile_shift);
    EXPECT_EQ(example.train.module_m, published->train.module_m);
    EXPECT_EQ(example.train.pressure_angle_rad, published->train.pressure_angle_rad);
  }
}

}  // namespace
}  // namespace gear3k::report
