// What the findings of the ledgers say in words, beside the figures that stand below them: a change
// of a table or of a model that leaves a finding without its figures fails here.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "papers/published_sources.hpp"
#include "papers/reproduce.hpp"

namespace gear3k::papers::verdict_test {
namespace {

const Reproduction& reproduction() {
  static const Reproduction kResult = reproduce(published_sources());
  return kResult;
}

/// The figures of an entry, which is the one that says this.
class Entry {
 public:
  Entry(const std::vector<LedgerEntry>& ledger, std::size_t number, const std::string& says)
      : entry_(ledger.at(number - 1)) {
    EXPECT_NE(entry_.finding.find(says), std::string::npos) << number << ": " << entry_.finding;
  }
  double operator[](const std::string& name) const {
    for (const Figure& f : entry_.figures) {
      if (f.name == name) return f.value;
    }
    throw std::invalid_argument("no figure " + name + " of " + entry_.where);
  }

 private:
  const LedgerEntry& entry_;
};
Entry low_backlash(std::size_t number, const std::string& says) {
  return {reproduction().ledger, number, says};
}
Entry thesis(std::size_t number, const std::string& says) {
  return {reproduction().thesis.ledger, number, says};
}
Entry backdrivability(std::size_t number, const std::string& says) {
  return {reproduction().backdrivability.ledger, number, says};
}

/// The fitted exponent of a law and half of its band.
struct Exponent {
  double fitted, band;
  [[nodiscard]] bool holds(double exponent) const { return std::abs(exponent - fitted) <= band; }
};
Exponent exponent_of(const Entry& entry, const std::string& law) {
  return {.fitted = entry[law + ", fitted exponent"], .band = entry[law + ", 95 % band +-"]};
}

TEST(LowBacklashVerdicts, HoldOfTheGeometry) {
  const Entry ratio = low_backlash(2, "for the bilateral drive gear alone");
  EXPECT_EQ(std::round(10.0 * ratio["bilateral drive gear"]), 962.0);
  EXPECT_NE(std::round(10.0 * ratio["low-backlash prototype"]), 962.0);
  // Mended to a micrometre of the other two, of which the printed shift is eight away.
  const Entry shift = low_backlash(3, "closes the three centre distances");
  EXPECT_NEAR(shift["S-P1"], shift["P1-R1"], 1e-4);
  EXPECT_NEAR(shift["P2-R2 mended"], shift["P1-R1"], 1e-3);
  EXPECT_GT(std::abs(shift["P2-R2 as printed"] - shift["P1-R1"]), 5e-3);
  EXPECT_GT(low_backlash(4, "some mesh interferes")["interference there"], 0.0);
  const Entry planets = low_backlash(
      5,
      "low-backlash prototype: 3 identical planets do not fit; bilateral drive gear: 3 identical "
      "planets fit");
  for (const char* gear : {"low-backlash prototype", "bilateral drive gear"}) {
    const std::string of = std::string(gear) + ": ";
    const double rest =
        std::fmod(planets[of + "|zR2 zP1 - zR1 zP2|"], planets[of + "N gcd(zP1, zP2)"]);
    EXPECT_EQ(std::fmod(planets[of + "zS + zR1"], 3.0), 0.0);
    EXPECT_EQ(rest == 0.0, of.starts_with("bilateral"));
  }
}

TEST(LowBacklashVerdicts, HoldOfTheEfficiency) {
  const Entry friction = low_backlash(10, "does not explain both directions");
  for (const char* gear : {"low-backlash prototype", "bilateral drive gear"}) {
    const std::string of = std::string(gear) + ": ";
    EXPECT_GT(friction[of + "backward predicted"], friction[of + "backward measured"] + 1.0);
    EXPECT_GT(friction[of + "mu from backward"], friction[of + "mu from forward"] + 0.01);
  }
  EXPECT_GT(friction["P1-R1 approach"], 1.0);
  EXPECT_GT(friction["P2-R2 approach"], 1.0);
  // Measured 87.1 % forward; backward by more than the rounding of the simulated one.
  low_backlash(10, "misses either measurement");
  EXPECT_LT(friction["forward with it"], 87.1 - 1.0);
  const PublishedGearbox gearbox = published_sources().low_backlash;
  EXPECT_GT(gearbox.stated_backward.value().value - 0.005, gearbox.measured_backward.value());
  const Entry optimum = low_backlash(11, "its own Fig. 8a is better in both");
  EXPECT_GT(optimum["Fig. 8a below the set"], 0.0);
  EXPECT_GT(optimum["above it"], 0.0);
}

TEST(ThesisVerdicts, HoldOfTheModel) {
  const Entry contact = thesis(3, "every tested pair is above it: mostly two pairs");
  EXPECT_GT(contact["least contact ratio of Table 3.1"], 1.5);
  EXPECT_LT(contact["time with one pair, at most"], 50.0);
  EXPECT_GT(contact["loss over that with shared load, least"], 1.0);
  const Entry reversed = thesis(4, "reverse this between larger gears");
  EXPECT_GT(reversed["with less loss when the larger drives"], 0.0);
  EXPECT_LT(reversed["skew of 120 driving 60"], 0.0);
  const Entry largest = thesis(5, "give more");
  EXPECT_GT(largest["largest over Table 3.1 at mu = 0.5"], 0.015);
  EXPECT_GT(largest["largest over Table 3.1 at mu = 0.3"], 0.015);
  const Entry corrected = thesis(6, "leave much less");
  EXPECT_LT(corrected["rms error"], 0.6 * corrected["rms error as printed"]);
  EXPECT_LT(corrected["its rms error"], 0.6 * corrected["rms error as printed"]);
  const Entry factor = thesis(7, "it is not the same for all pairs");
  EXPECT_LT(factor["measured over model's skew, least"], 0.0);
  EXPECT_GT(factor["measured over model's skew, largest"], 100.0);
  const Entry symmetric = thesis(8, "the least squares differ");
  EXPECT_LT(symmetric["refitted"], 0.6 * symmetric["rms error as printed"]);
  EXPECT_LT(symmetric["scale"], 0.6);
  const Entry range = thesis(11, "the least loss is far below the model's");
  EXPECT_LT(0.001, 0.1 * range["model's loss of 16 driving 100 at mu = 0.3"]);
  EXPECT_GT(0.179, 2.0 * range["of 120 driving 16"]);
  EXPECT_GT(range["mu that gives 120 driving 16"], 100.0 * range["mu that gives 16 driving 100"]);
}

TEST(ThesisVerdicts, HoldOfTheBench) {
  const Entry power = thesis(12, "the sign of the motor's power does not");
  EXPECT_GT(power["of all time the motor gives power meanwhile"], 1.0);
  const Entry fixed = thesis(13, "the speed differs by a few per cent");
  EXPECT_GT(fixed["rms difference over rms speed"], 2.0);
  EXPECT_LT(fixed["rms difference over rms speed"], 10.0);

  // Table 3.1: 16/120 0.179 - 0.013, 16/100 0.167 - 0.001, 30/120 0.109 - 0.068.
  const Entry asymmetry = thesis(14, "Table 3.1 agrees; it has as much with 16 and 100.");
  EXPECT_NEAR(asymmetry["120/16"], 16.6, 1e-9);
  EXPECT_NEAR(asymmetry["greatest, 100/16"], 16.6, 1e-9);
  EXPECT_NEAR(asymmetry["120/30"], 4.1, 1e-9);
  EXPECT_EQ(std::round(asymmetry["120/16"]), 17.0);
  EXPECT_EQ(std::round(asymmetry["120/30"]), 4.0);
  EXPECT_LT(asymmetry["two stages of 100/16"], 2.0 * asymmetry["greatest, 100/16"]);
  EXPECT_NEAR(asymmetry["felt pushed in over let out"], std::pow(0.999 * 0.833, -2.0), 1e-9);

  const Entry larger = thesis(15, "for the largest gears alone: the middle ones lose most in both");
  for (const char* loss : {": loss driving", ": driven"}) {
    const auto of = [&](const char* pair) { return larger[std::string(pair) + loss]; };
    EXPECT_LT(of("120/24"), of("80/16"));
    EXPECT_GT(of("100/20"), of("80/16"));
  }
  const Entry closer = thesis(16, "so they do, but the impedance at the output comes first of all");
  EXPECT_LT(closer["80/40: added loss"], closer["120/16: added loss"]);
  const double felt =
      closer["120/16: felt inertia, sped up"] / closer["80/40: felt inertia, sped up"];
  EXPECT_GT(felt, 10.0);
  EXPECT_LT(closer["of the latter by the loss"], 25.0);
  // Without inertia of their own the larger gears, which lose less, feel lighter.
  EXPECT_GT(thesis(17, "only up to a face width")["face width"], 0.0);
  const auto& pairs = reproduction().directional_bench.felt;
  EXPECT_LT(gears_of(pairs, 24, 120).speeding_up_kgm2, gears_of(pairs, 16, 80).speeding_up_kgm2);
}

TEST(BackdrivabilityVerdicts, HoldOfTheScalingLaws) {
  const Entry stiffness = backdrivability(9, "for similar shapes d^3 and not d^5");
  for (const char* law : {"K1 of RT1 over radius", "K3 of RT1 over radius"}) {
    EXPECT_TRUE(exponent_of(stiffness, law).holds(3.0)) << law;
    EXPECT_FALSE(exponent_of(stiffness, law).holds(5.0)) << law;
  }
  const Entry quotient = backdrivability(10, "for similar shapes all of them are Fig. 8");
  const Exponent over_torque = exponent_of(quotient, "K3 of RT1 over torque");
  EXPECT_TRUE(over_torque.holds(quotient["corrected"]));
  EXPECT_FALSE(over_torque.holds(quotient["K over T for similar shapes, eqs. 28, 31, 34"]));

  const Entry size = backdrivability(11,
                                     "of 23 frames of one series neither inertia law is within the "
                                     "band, and the torque's diameter is, not its length");
  EXPECT_FALSE(exponent_of(size, "inertia over diameter").holds(3.0));
  EXPECT_FALSE(exponent_of(size, "inertia over diameter").holds(4.0));
  EXPECT_FALSE(exponent_of(size, "inertia over length").holds(1.0));
  EXPECT_TRUE(exponent_of(size, "torque over diameter").holds(2.5));
  EXPECT_FALSE(exponent_of(size, "torque over length").holds(1.0));
  for (const ScalingLaw& law : reproduction().backdrivability.laws) {
    if (law.name == "motor_inertia" || law.name == "motor_torque") {
      EXPECT_EQ(law.points.size(), 23U);
    }
  }

  const Entry torque = backdrivability(12, "the frames of one series miss eq. 36");
  EXPECT_FALSE(exponent_of(torque, "torque per inertia of Megaflux over diameter").holds(-1.5));
  EXPECT_FALSE(exponent_of(torque, "torque per inertia of Megaflux over length").holds(0.0));
  // J ~ L d^4 and T ~ L d^2.5 at L ~ d: 5/3.5.
  backdrivability(12, "holds Fig. 9's exponent, not that of eqs. 23, 35");
  EXPECT_NEAR(torque["eqs. 23, 35 at L ~ d"], 5.0 / 3.5, 1e-12);
  EXPECT_TRUE(exponent_of(torque, "inertia of all frames over torque").holds(1.5));
  EXPECT_FALSE(exponent_of(torque, "inertia of all frames over torque").holds(5.0 / 3.5));
  EXPECT_GT(backdrivability(13, "much Coulomb friction")["least"], 10.0);
}

TEST(BackdrivabilityVerdicts, HoldOfTheKneesNumbers) {
  const Entry drag = backdrivability(18, "the friction counts twice. 0.2 is neither");
  EXPECT_LT(drag["forward at 46 N m with both"], 75.0 - 10.0);
  EXPECT_LT(drag["its loss driven backward"], 0.5 * 20.0);
  const Entry breakaway = backdrivability(19, "cannot start the unloaded gearbox");
  EXPECT_GT(breakaway["motor torque that starts it"], breakaway["nominal"]);
  backdrivability(19, "other gearboxes of its kind need far less");
  EXPECT_LT(breakaway["RT1 size 17, i = 100"], 34.0 / 2.0);
  EXPECT_LT(breakaway["CSG-25 in the low-backlash paper"], 34.0 / 2.0);
}

TEST(BackdrivabilityVerdicts, HoldOfTheStride) {
  const Entry negative = backdrivability(21, "its drag and inertia come first");
  EXPECT_LT(negative["while the mesh is driven backward"], 50.0);
  EXPECT_GT(negative["given back by the load"], 0.0);
  const Entry axis = backdrivability(22, "have the same four stretches");
  EXPECT_EQ(axis["stretches of negative power"], 4.0);
  EXPECT_EQ(axis["that begin at zero torque"], 4.0);
  const Entry passable = backdrivability(23, "its own three instants give more");
  EXPECT_NEAR(passable["stated"], 100.0 * 2.0 / 3.0, 0.05);
  EXPECT_GT(passable["share"], passable["stated"] + 10.0);

  const Entry regenerated = backdrivability(24, "exceeds it in two of them");
  int exceeding = 0;
  for (const char* stretch : {"2", "3", "4"}) {
    const double most = regenerated[std::string("largest torque of stretch ") + stretch];
    exceeding += most > regenerated["friction, eq. 39"] ? 1 : 0;
  }
  EXPECT_EQ(exceeding, 2);
  EXPECT_GT(regenerated["regenerated, corrected"], 0.0);

  const Entry power = backdrivability(25,
                                      "so is the energy over the work; the power is three to four "
                                      "times the knee's");
  for (const char* numbers : {"its own equations", "corrected"}) {
    const double times =
        power[std::string("electrical, ") + numbers] / power["largest power of the knee"];
    EXPECT_GE(times, 3.0) << numbers;
    EXPECT_LE(times, 4.0) << numbers;
    const double work = power[std::string("drawn, ") + numbers] / power["its work on the load"];
    EXPECT_GT(work, 10.0 / std::sqrt(10.0)) << numbers;
    EXPECT_LT(work, 10.0 * std::sqrt(10.0)) << numbers;
  }
  // Almost two orders: nearer to 100 than to 10 on logarithms.
  const double printed = power["electrical, as printed"] / power["largest power of the knee"];
  EXPECT_GT(printed, 10.0 * std::sqrt(10.0));
  EXPECT_LT(printed, 100.0);
}

}  // namespace
}  // namespace gear3k::papers::verdict_test
