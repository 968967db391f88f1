#include "backlash/first_contact.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "tests/random_train.hpp"

namespace gear3k::backlash::first_contact_test {
namespace {

class Random : public RandomTrain {
 public:
  Random() : RandomTrain(33) {}
  std::vector<PlanetPlay> planets(int count) {
    std::vector<PlanetPlay> result(static_cast<std::size_t>(count));
    for (PlanetPlay& planet : result) {
      for (MeshPlay& play : planet) {
        const double middle = between(-10e-6, 10e-6);
        const double half = between(15e-6, 40e-6);
        play = {.lower_m = middle - half, .upper_m = middle + half};
      }
    }
    return result;
  }
};

TEST(FirstContact, AlikePlanetsShareEvenly) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    const auto levers = output_levers(random.train(i % 2 == 0));
    std::vector<PlanetPlay> planets = random.planets(1);
    planets.resize(4, planets.front());
    for (const bool greatest : {false, true}) {
      const FirstContact contact = first_contact(levers, planets, greatest);
      for (const double share : contact.share) EXPECT_NEAR(share, 0.25, 1e-12);
      for (const double room_m : contact.room_m) EXPECT_NEAR(room_m, 0.0, 1e-15);
    }
  }
}

// A multiplier is what the optimum gains when its constraint gives way: moving both bounds of u3 of
// one planet by h is its output flank standing off by h.
TEST(FirstContact, SharesAreTheGainsOfTheRange) {
  Random random;
  int cases = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto levers = output_levers(random.train(i % 2 == 0));
    const std::vector<PlanetPlay> planets = random.planets(random.count(1, 5));
    const OutputRange range = output_range(levers, planets);
    if (range.margin_m < 1e-7) continue;
    constexpr double kStep = 1e-9;
    for (const bool greatest : {false, true}) {
      const FirstContact contact = first_contact(levers, planets, greatest);
      ASSERT_EQ(contact.share.size(), planets.size());
      EXPECT_NEAR(std::accumulate(contact.share.begin(), contact.share.end(), 0.0), 1.0, 1e-12);
      bool smooth = true;  // the same planets hold the end on both sides of the step
      std::vector<double> gain;
      for (std::size_t p = 0; p < planets.size(); ++p) {
        const auto moved = [&](double h) {
          std::vector<PlanetPlay> copy = planets;
          copy[p][2].lower_m += h;
          copy[p][2].upper_m += h;
          const OutputRange r = output_range(levers, copy);
          return levers.output_m * (greatest ? r.upper_rad : r.lower_rad);
        };
        const double forward = (moved(kStep) - moved(0.0)) / kStep;
        const double backward = (moved(0.0) - moved(-kStep)) / kStep;
        smooth = smooth && std::abs(forward - backward) < 1e-4;
        gain.push_back(forward);
      }
      if (!smooth) continue;
      ++cases;
      for (std::size_t p = 0; p < planets.size(); ++p) {
        EXPECT_NEAR(contact.share[p], gain[p], 1e-4);
      }
    }
  }
  EXPECT_GT(cases, 1000);
}

TEST(FirstContact, AtLeastOnePlanetHasNoRoomLeft) {
  Random random;
  int assembled = 0;
  for (int i = 0; i < 500; ++i) {
    const auto levers = output_levers(random.train(i % 2 == 0));
    const std::vector<PlanetPlay> planets = random.planets(random.count(2, 6));
    if (!output_range(levers, planets).assembles()) continue;
    ++assembled;
    for (const bool greatest : {false, true}) {
      const FirstContact contact = first_contact(levers, planets, greatest);
      EXPECT_NEAR(*std::ranges::min_element(contact.room_m), 0.0, 1e-15);
    }
  }
  EXPECT_GT(assembled, 250);
}

TEST(FirstContact, RefusesWhatDoesNotAssemble) {
  Random random;
  const auto levers = output_levers(random.train(true));
  std::vector<PlanetPlay> planets = random.planets(2);
  planets[0][0] = {.lower_m = 1e-6, .upper_m = -1e-6};
  EXPECT_THROW(static_cast<void>(first_contact(levers, planets, true)), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::backlash::first_contact_test
