#include "units/units.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace gear3k::units::units_test {
namespace {

std::vector<Unit> all_units() {
  std::vector<Unit> units;
  for (std::size_t i = 0; i < kUnits.size(); ++i) units.push_back(static_cast<Unit>(i));
  return units;
}

/// Decimal digits that it takes to write a value.
int digits_of(double value) {
  int digits = 1;
  while (digits < 17 && std::stod(fmt::format("{:.{}e}", value, digits - 1)) != value) ++digits;
  return digits;
}

TEST(Units, AreWhatTheirNamesSay) {
  EXPECT_EQ(to_si(31.4, Unit::kMillimetre), 31.4 * 1e-3);
  EXPECT_EQ(to_si(8.0, Unit::kDiameterMillimetre), 4e-3);
  EXPECT_EQ(to_si(12.0, Unit::kMicrometre), 12.0 * 1e-6);
  EXPECT_DOUBLE_EQ(to_si(180.0, Unit::kDegree), std::numbers::pi);
  EXPECT_DOUBLE_EQ(to_si(60.0, Unit::kArcmin), std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(to_si(60.0, Unit::kRpm), 2.0 * std::numbers::pi);
  EXPECT_EQ(to_si(20.0, Unit::kCelsius), 293.15);
  EXPECT_DOUBLE_EQ(to_si(220.0, Unit::kSquareMillimetrePerSecond), 220e-6);
  EXPECT_EQ(to_si(2.0, Unit::kHour), 7200.0);
  EXPECT_DOUBLE_EQ(to_si(1e6, Unit::kSquareMillimetre), 1.0);
  EXPECT_EQ(to_si(50.0, Unit::kNewtonPerMicrometre), 50e6);
  EXPECT_DOUBLE_EQ(to_si(1.0, Unit::kWearCoefficient), 1e-9);
  EXPECT_EQ(to_si(25.0, Unit::kNewtonPerMillimetre), 25e3);
  EXPECT_EQ(to_si(290.0, Unit::kMegapascal), 290e6);
  EXPECT_EQ(to_si(14.0, Unit::kMeshStiffness), 14e9);
  EXPECT_EQ(to_si(12.5, Unit::kTorsionalStiffness), 12.5);
  EXPECT_TRUE(std::signbit(to_si(-0.0, Unit::kMillimetre)));
}

TEST(Units, ADecimalComesBackFromItsSiValueAsItWas) {
  std::mt19937_64 random(7);
  for (const Unit unit : all_units()) {
    for (int sample = 0; sample < 2000; ++sample) {
      // Up to 15 digits, as a user writes them.
      const int digits = 1 + static_cast<int>(random() % 15);
      const double share = std::ldexp(static_cast<double>(random() >> 11U), -53) - 0.5;
      const double power = std::pow(10.0, static_cast<int>(random() % 9) - 4);
      const double value = std::stod(fmt::format("{:.{}e}", share * power, digits - 1));
      const double si = to_si(value, unit);
      const double back = decimal_from_si(si, unit);
      EXPECT_EQ(std::bit_cast<std::uint64_t>(to_si(back, unit)), std::bit_cast<std::uint64_t>(si));
      EXPECT_LE(digits_of(back), digits_of(value)) << unit_name(unit) << " " << value;
      // Added to 273.15, the last digits of degrees are lost.
      if (unit == Unit::kCelsius) continue;
      EXPECT_EQ(back, value) << unit_name(unit);
    }
  }
}

TEST(Units, ASumOfDecimalsIsTheDecimalThatItMeans) {
  std::mt19937_64 random(5);
  int broken = 0;
  for (int sample = 0; sample < 2000; ++sample) {
    // Whole steps of 0.01 mm, as a root diameter and the rims about it; summed up in whole numbers.
    const int root = 3000 + static_cast<int>(random() % 5000),
              rim = 50 + static_cast<int>(random() % 200);
    const double meant_mm = (root + 2 * rim) / 100.0;
    const double sum_m = to_si(root / 100.0, Unit::kDiameterMillimetre) + 1e-5 * rim;
    broken += decimal_from_si(sum_m, Unit::kDiameterMillimetre) == meant_mm ? 0 : 1;
    EXPECT_EQ(
        decimal_from_si(meant_si(sum_m, Unit::kDiameterMillimetre), Unit::kDiameterMillimetre),
        meant_mm);
  }
  EXPECT_GT(broken, 100) << "or this shows nothing";
}

TEST(Units, AValueThatMeansNoDecimalStaysAsItIs) {
  std::mt19937_64 random(3);
  int moved = 0;
  for (int sample = 0; sample < 2000; ++sample) {
    const double si = 0.1 * std::ldexp(static_cast<double>(random() >> 11U), -53);
    const double meant = meant_si(si, Unit::kMillimetre);
    moved += meant == si ? 0 : 1;
    EXPECT_LE(std::abs(meant - si), 4.0 * std::numeric_limits<double>::epsilon() * si);
  }
  EXPECT_LT(moved, 20);
  EXPECT_EQ(meant_si(0.0, Unit::kMillimetre), 0.0);
}

TEST(Units, AStatedLimitIsNotWrittenBeyondItself) {
  const double si = to_si(1e6, Unit::kArcmin);
  ASSERT_NE(from_si(si, Unit::kArcmin), 1e6) << "the quotient rounds off, or this shows nothing";
  EXPECT_EQ(decimal_from_si(si, Unit::kArcmin), 1e6);
}

TEST(Units, AnySiValueIsWrittenAtMostOneLastBitOff) {
  std::mt19937_64 random(11);
  for (const Unit unit : all_units()) {
    int exact = 0;
    constexpr int kSamples = 2000;
    for (int sample = 0; sample < kSamples; ++sample) {
      // Where lubricants are, of temperatures.
      const double si = 250.0 + std::ldexp(static_cast<double>(random() >> 11U), -45);
      const double read = to_si(decimal_from_si(si, unit), unit);
      EXPECT_LE(std::nextafter(si, 0.0), read) << unit_name(unit);
      EXPECT_GE(std::nextafter(si, INFINITY), read) << unit_name(unit);
      // Written once more, it stays.
      EXPECT_EQ(to_si(decimal_from_si(read, unit), unit), read) << unit_name(unit);
      exact += read == si ? 1 : 0;
    }
    EXPECT_GT(exact, kSamples / 2) << unit_name(unit);
  }
}

}  // namespace
}  // namespace gear3k::units::units_test
