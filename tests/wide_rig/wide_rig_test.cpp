#include "tests/wide_rig/wide_rig.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/rig/rig_train.hpp"
#include "tests/sample.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/wide_rig/alternatives.hpp"
#include "tests/wide_rig/bench_subject.hpp"
#include "tests/wide_rig/hidden_effect.hpp"
#include "tests/wide_rig/sensor_noise.hpp"
#include "tests/wide_rig/shape_laws.hpp"

namespace gear3k::wide_rig {
namespace {

Line line_named(const std::string& name) {
  for (const Line& line : lines()) {
    if (line.name == name) return line;
  }
  throw std::invalid_argument("no line named " + name);
}

// A CSV of the contract: notes, a header, rows of as many fields.
struct Table {
  std::map<std::string, std::string> notes;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  std::size_t column(const std::string& name) const {
    const auto found = std::find(header.begin(), header.end(), name);
    EXPECT_NE(found, header.end()) << name;
    return static_cast<std::size_t>(found - header.begin());
  }
};

std::vector<std::string> fields_of(const std::string& text) {
  std::vector<std::string> fields;
  std::istringstream stream(text);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

Table table_of_text(const std::string& text) {
  Table table;
  std::istringstream stream(text);
  for (std::string row; std::getline(stream, row);) {
    if (row.front() == '#') {
      const std::size_t colon = row.find(':');
      table.notes[row.substr(2, colon - 2)] = row.substr(colon + 2);
    } else if (table.header.empty()) {
      table.header = fields_of(row);
    } else {
      table.rows.push_back(fields_of(row));
    }
  }
  return table;
}

BenchSubject bilateral() {
  BenchSubject subject;
  subject.train = rig::make_train(rig::bilateral_drive_gear());
  subject.ratio = subject.train.ratio;
  subject.friction = subject.train.gearbox.friction;
  return subject;
}

HiddenEffect constant_effect(Channel channel, Body body = Body::sun) {
  HiddenEffect effect;
  effect.channel = channel;
  effect.body = body;
  effect.value = [](double a, const BenchRow&, const MeshPoint&) { return a; };
  return effect;
}

double change(const HiddenEffect& effect, double amplitude, const BenchRow& row) {
  const BenchSubject subject = bilateral();
  return sun_torque(subject, row, {{&effect, amplitude}}).value -
         sun_torque(subject, row, {}).value;
}

BenchRow row_at(bool forward, double rotation) {
  BenchRow row;
  row.forward = forward;
  row.rotation = rotation;
  row.sun_speed_rpm = 400.0;
  row.output_torque_Nm = 20.0;
  return row;
}

TEST(WideRig, BalanceWithoutEffectsIsThatOfTheOtherBench) {
  for (const rig::Gearbox& gearbox :
       {rig::bilateral_drive_gear(), rig::low_backlash_gear(), rig::reversing_gear()}) {
    BenchSubject subject;
    subject.train = rig::make_train(gearbox);
    subject.ratio = subject.train.ratio;
    subject.friction = gearbox.friction;
    for (const bool forward : {true, false}) {
      for (const double rotation : {1.0, -1.0}) {
        const BenchRow row = row_at(forward, rotation);
        const double signed_Nm = rig::balanced_sun_torque(
            subject.train, {.output_torque_Nm = forward ? -20.0 : 20.0,
                            .sun_sense = rotation,
                            .sun_speed_rad_s = 400.0 * 3.14159265358979 / 30.0});
        EXPECT_NEAR(sun_torque(subject, row, {}).value,
                    signed_Nm * rotation * (forward ? 1.0 : -1.0), 1e-12)
            << gearbox.name;
      }
    }
  }
}

TEST(WideRig, LossesRaiseTheSunTorqueForwardAndLowerItBackward) {
  for (const auto& [effect, amplitude] : std::vector<std::pair<HiddenEffect, double>>{
           {constant_effect(Channel::friction), 0.2},
           {constant_effect(Channel::drag, Body::sun), 0.01},
           {constant_effect(Channel::drag, Body::planet), 0.01},
           {constant_effect(Channel::drag, Body::carrier), 0.05},
           {constant_effect(Channel::drag, Body::output), 0.3},
           {constant_effect(Channel::pin), 0.02},
           {constant_effect(Channel::output_bearing), 0.02}}) {
    for (const double rotation : {1.0, -1.0}) {
      EXPECT_GT(change(effect, amplitude, row_at(true, rotation)), 0.0);
      EXPECT_LT(change(effect, amplitude, row_at(false, rotation)), 0.0);
    }
  }
}

TEST(WideRig, DragOnTheSunIsItselfAtTheSensor) {
  const HiddenEffect drag = constant_effect(Channel::drag, Body::sun);
  EXPECT_NEAR(change(drag, 0.01, row_at(true, -1.0)), 0.01, 1e-13);
  EXPECT_NEAR(change(drag, 0.01, row_at(false, 1.0)), -0.01, 1e-13);
}

// Where nothing is lost in the meshes, the power of a drag has to come from the sun.
TEST(WideRig, DragOfInnerBodiesKeepsThePowerBalance) {
  BenchSubject subject = bilateral();
  subject.friction = 0.0;
  const double i = std::fabs(subject.ratio);
  const std::vector<std::pair<Body, double>> bodies{
      {Body::planet, 3.0 * std::fabs(subject.train.planet_speed)},
      {Body::carrier, std::fabs(subject.train.carrier_speed)},
      {Body::output, 1.0}};
  for (const auto& [body, speed] : bodies) {
    const HiddenEffect drag = constant_effect(Channel::drag, body);
    const double before_Nm = sun_torque(subject, row_at(true, 1.0), {}).value;
    const double after_Nm = sun_torque(subject, row_at(true, 1.0), {{&drag, 0.05}}).value;
    EXPECT_NEAR(before_Nm, 20.0 / i, 1e-13);
    EXPECT_NEAR(after_Nm - before_Nm, 0.05 * speed / i, 1e-12) << static_cast<int>(body);
  }
}

TEST(WideRig, SensorOffsetFollowsRotationAndSide) {
  const HiddenEffect offset = constant_effect(Channel::offset);
  for (const double rotation : {1.0, -1.0}) {
    EXPECT_NEAR(change(offset, 0.02, row_at(true, rotation)), 0.02 * rotation, 1e-15);
    EXPECT_NEAR(change(offset, 0.02, row_at(false, rotation)), -0.02 * rotation, 1e-15);
  }
}

TEST(WideRig, LinesHaveUniqueNamesAndEveryCauseHasThreeLaws) {
  std::set<std::string> names;
  for (const Line& line : lines()) EXPECT_TRUE(names.insert(line.name).second) << line.name;
  std::map<std::string, std::set<std::string>> laws;
  for (const char* kind : {"transmission", "lost_motion", "pair_loss", "torque_angle"}) {
    for (const std::string& cause : causes_of(kind)) {
      for (const std::string& law : laws_of(cause, kind)) laws[cause].insert(law);
    }
  }
  EXPECT_EQ(laws.size(), 18U);
  for (const auto& [cause, of_cause] : laws) EXPECT_GE(of_cause.size(), 3U) << cause;
}

TEST(WideRig, TimeLawsAreMonotoneAndBeginAtZero) {
  rig::DeterministicRandom random(3);
  for (const char* name : {"exponential", "power", "logarithmic", "linear", "weibull"}) {
    for (int draw = 0; draw < 50; ++draw) {
      const DrawnLaw law = time_law(name, random);
      EXPECT_EQ(law.value(1.0, 0.0), 0.0);
      for (double u = 0.0; u < 1.0; u += 0.05) {
        EXPECT_GE(law.value(1.0, u + 0.05), law.value(1.0, u)) << name;
      }
    }
  }
}

TEST(WideRig, SessionValuesDifferAndAreNotMonotone) {
  rig::DeterministicRandom random(5);
  for (int sessions = 3; sessions <= 8; ++sessions) {
    for (int draw = 0; draw < 20; ++draw) {
      const auto values = session_values(sessions, false, random);
      EXPECT_EQ(std::set<double>(values.begin(), values.end()).size(), values.size());
      EXPECT_FALSE(std::is_sorted(values.begin(), values.end()));
      EXPECT_FALSE(std::is_sorted(values.rbegin(), values.rend()));
    }
  }
}

TEST(WideRig, NoiseHasItsStandardDeviation) {
  rig::DeterministicRandom random(7);
  for (const char* model : {"normal", "t3", "quantised", "reading", "correlated", "blocks"}) {
    const SensorNoise noise = random_noise(model, 1.0, 0.03, random);
    NoisyReadings sensor(noise);
    double square = 0.0;
    constexpr int kDraws = 40000;
    for (int i = 0; i < kDraws; ++i) {
      const double deviation = sensor.read(1.3, 0, random) - 1.3;
      square += deviation * deviation;
    }
    // Student's t with 3 degrees of freedom has no fourth moment.
    EXPECT_NEAR(std::sqrt(square / kDraws) / sigma_of(noise, 1.3), 1.0,
                noise.model == "normal" || noise.model == "reading" ? 0.02 : 0.25)
        << model;
  }
}

// Readings that remember the one before: the correlation of neighbours within a session is the
// memory, that across sessions is none.
TEST(WideRig, CorrelatedNoiseRemembersWithinItsSession) {
  rig::DeterministicRandom random(9);
  const SensorNoise noise = random_noise("correlated", 1.0, 0.03, random);
  NoisyReadings sensor(noise);
  constexpr int kDraws = 40000;
  double within = 0.0, across = 0.0, before = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double deviate = (sensor.read(1.0, i / 2, random) - 1.0) / sigma_of(noise, 1.0);
    (i % 2 == 1 ? within : across) += deviate * before;
    before = deviate;
  }
  EXPECT_NEAR(within / (kDraws / 2), noise.memory, 0.03);
  EXPECT_NEAR(across / (kDraws / 2), 0.0, 0.03);
}

// The zero creeps from zeroing to zeroing: rows of a block lie on one side of rows without it.
TEST(WideRig, BlocksShareTheirNoise) {
  rig::DeterministicRandom random(11);
  const SensorNoise noise = random_noise("blocks", 1.0, 0.03, random);
  NoisyReadings sensor(noise);
  constexpr int kBlocks = 4000;
  double square = 0.0, last = 0.0;
  for (int b = 0; b < kBlocks; ++b) {
    double sum = 0.0;
    for (int i = 0; i < noise.block_rows; ++i) {
      const double deviate = (sensor.read(1.0, 0, random) - 1.0) / sigma_of(noise, 1.0);
      sum += deviate;
      if (i + 1 == noise.block_rows) last += deviate * deviate;
    }
    square += sum * sum / noise.block_rows;
  }
  // Mean of the block squared: (1 - s) / n + 3 s / 4; at its end nearly 1 - s + 3 s.
  const double s = noise.shared, n = noise.block_rows;
  EXPECT_NEAR(square / kBlocks, 1.0 - s + 0.75 * s * n, 0.1 * (1.0 + n * s));
  const double end = (n - 0.5) / n;
  EXPECT_NEAR(last / kBlocks, 1.0 - s + 3.0 * s * end * end, 0.15);
}

// On its coarse grid a wave is described as well at another order, and not at all others.
TEST(WideRig, CoarseGridsHaveAnAlias) {
  int with_alias = 0, all = 0;
  for (const Line& line : lines()) {
    if (line.group != "aliased") continue;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Campaign campaign = make_campaign(line, 4.0, seed);
      const auto& orders = campaign.orders;
      const auto& parameters = campaign.truths.at(0).parameters;
      EXPECT_EQ(std::count_if(orders.begin(), orders.end(),
                              [&](const PossibleOrder& o) {
                                return o.cause == campaign.truths[0].cause &&
                                       o.order == parameters.at(0).value;
                              }),
                1)
          << line.name;
      with_alias += orders.size() > 1 ? 1 : 0;
      EXPECT_LT(orders.size(), 8U) << line.name << ' ' << seed;
      ++all;
    }
  }
  EXPECT_EQ(all, 30);
  EXPECT_GE(with_alias, all * 8 / 10);
}

TEST(WideRig, CampaignsAreDeterministicAndSeedsDiffer) {
  for (const char* name : {"single friction_speed mixed_film", "gain steps",
                           "single torque_angle compliance hertz_power"}) {
    const Line line = line_named(name);
    const Campaign a = make_campaign(line, 4.0, 11), b = make_campaign(line, 4.0, 11);
    EXPECT_EQ(a.files.at(0).text, b.files.at(0).text);
    EXPECT_EQ(a.unseen.at(0).text, b.unseen.at(0).text);
    EXPECT_NE(a.files.at(0).text, make_campaign(line, 4.0, 12).files.at(0).text);
  }
}

TEST(WideRig, StrengthIsAsStatedOrTheGreatestPossible) {
  int reached = 0, all = 0;
  for (const Line& line : lines()) {
    if (line.hidden.size() != 1) continue;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Campaign campaign = make_campaign(line, 2.0, seed);
      ASSERT_EQ(campaign.truths.size(), 1U);
      const bool loads_follow = campaign.plan == "sun_torque_set";
      EXPECT_LE(campaign.truths[0].strength, loads_follow ? 2.4 : 2.0 * (1.0 + 1e-6)) << line.name;
      EXPECT_GT(campaign.truths[0].strength, 0.0) << line.name << " seed " << seed;
      EXPECT_NEAR(campaign.strength, campaign.truths[0].strength, 1e-9) << line.name;
      reached += campaign.truths[0].strength > 1.9 ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GT(reached, all * 8 / 10) << all;
}

TEST(WideRig, StrengthChangesNeitherGearboxNorLaw) {
  for (const Line& line : lines()) {
    const Campaign weak = make_campaign(line, 1.0, 3), strong = make_campaign(line, 4.0, 3);
    EXPECT_EQ(weak.subject_toml, strong.subject_toml) << line.name;
    EXPECT_EQ(weak.plan, strong.plan) << line.name;
    for (std::size_t t = 0; t < weak.truths.size(); ++t) {
      EXPECT_EQ(weak.truths[t].law, strong.truths[t].law) << line.name;
      EXPECT_LT(weak.truths[t].strength, strong.truths[t].strength * 1.01) << line.name;
    }
  }
}

// What no cause does must not look like one where it is strong.
TEST(WideRig, UnknownLawsAreNoCause) {
  int like_a_cause = 0, all = 0;
  for (const Line& line : lines()) {
    if (line.group != "unknown") continue;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Campaign campaign = make_campaign(line, 8.0, seed);
      like_a_cause += campaign.truths.at(0).acceptable.empty() ? 0 : 1;
      ++all;
    }
  }
  EXPECT_LE(like_a_cause, all / 10);
}

TEST(WideRig, NullCampaignsHideNothing) {
  for (const Line& line : lines()) {
    if (line.group != "null" && line.group != "correlated") continue;
    const Campaign campaign = make_campaign(line, 8.0, 2);
    EXPECT_TRUE(campaign.truths.empty());
    EXPECT_EQ(campaign.strength, 0.0);
    EXPECT_TRUE(campaign.excluded.empty());
  }
}

TEST(WideRig, TruthIsNeverExcludedAndAlwaysAcceptable) {
  for (const Line& line : lines()) {
    const Campaign campaign = make_campaign(line, 8.0, 4);
    for (const Truth& truth : campaign.truths) {
      if (truth.cause == "unknown") continue;
      EXPECT_EQ(truth.acceptable.at(0), truth.cause);
      for (const std::string& cause : truth.acceptable) {
        EXPECT_EQ(std::count(campaign.excluded.begin(), campaign.excluded.end(), cause), 0)
            << line.name << ' ' << cause;
      }
    }
  }
}

TEST(WideRig, FilesAreAsTheContractLaysThemOut) {
  const std::map<std::string, std::vector<std::string>> required{
      {"transmission", {"direction", "sun_speed_rpm", "output_torque_nm", "sun_torque_nm"}},
      {"lost_motion", {"output_angle_deg", "test_torque_nm", "lost_motion_arcmin"}},
      {"torque_angle", {"time_s", "angle_deg", "torque_nm"}},
      {"pair_loss", {"driving_teeth", "driven_teeth", "loss_factor"}}};
  const std::set<std::string> words{"direction", "run"};
  for (const Line& line : lines()) {
    const Campaign campaign = make_campaign(line, 4.0, 6);
    for (const File& file : campaign.files) {
      const Table table = table_of_text(file.text);
      EXPECT_EQ(table.notes.at("kind"), line.kind);
      for (const std::string& name : required.at(line.kind)) table.column(name);
      EXPECT_GE(table.rows.size(), 60U) << line.name;
      for (const auto& row : table.rows) {
        ASSERT_EQ(row.size(), table.header.size()) << line.name;
        for (std::size_t i = 0; i < row.size(); ++i) {
          if (words.count(table.header[i]) != 0) continue;
          std::size_t used = 0;
          EXPECT_TRUE(std::isfinite(std::stod(row[i], &used))) << line.name;
          EXPECT_EQ(used, row[i].size()) << line.name << ' ' << row[i];
        }
      }
    }
    const Table unseen = table_of_text(campaign.unseen.at(0).text);
    EXPECT_EQ(unseen.rows.size(), campaign.unseen_clean.size());
  }
}

TEST(WideRig, SetSunTorquesAreFewAndExact) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Campaign campaign = make_campaign(line_named("drag_constant sun torque set"), 4.0, seed);
    const Table table = table_of_text(campaign.files.at(0).text);
    std::set<std::string> torques;
    for (const auto& row : table.rows) torques.insert(row[table.column("sun_torque_nm")]);
    EXPECT_LE(torques.size(), 6U);
  }
}

// Temperature that follows speed: by no analysis can friction over temperature be told from
// friction over speed where both laws are weak.
TEST(WideRig, ConfoundedConditionsShowInWhatIsAcceptable) {
  int shared = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Campaign campaign = make_campaign(
        line_named("confounded transmission friction_temperature warming_with_speed"), 2.0, seed);
    const auto& acceptable = campaign.truths.at(0).acceptable;
    shared += std::count(acceptable.begin(), acceptable.end(), "friction_speed") > 0 ? 1 : 0;
  }
  EXPECT_GE(shared, 7);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Campaign campaign =
        make_campaign(line_named("confounded transmission sensor_offset one_rotation"), 4.0, seed);
    const auto& acceptable = campaign.truths.at(0).acceptable;
    EXPECT_EQ(std::count(acceptable.begin(), acceptable.end(), "drag_constant"), 1);
  }
}

// The built program reads what the lines write, one campaign of every kind and plan (of every third
// where samples are short).
TEST(WideRig, ProgramReadsEveryFile) {
  const std::string program = GEAR3K_PROGRAM;
  ASSERT_TRUE(std::filesystem::exists(program)) << program;
  const test::TemporaryFolder temporary;
  const std::filesystem::path& folder = temporary.path();
  std::set<std::string> seen;
  for (const Line& line : lines()) {
    const Campaign campaign = make_campaign(line, 4.0, 9);
    if (!seen.insert(campaign.kind + campaign.plan).second) continue;
    if (seen.size() % sample<std::size_t>(3, 1) != 0) continue;
    std::string command = '"' + program + "\" diagnose --quiet --threads 1";
    const auto write = [&](const std::string& name, const std::string& text) {
      test::write_text(folder / name, text);
      command += " \"" + (folder / name).string() + '"';
    };
    write("subject.toml", campaign.subject_toml);
    for (const File& file : campaign.files) write(file.name, file.text);
    EXPECT_EQ(std::system((command + " > /dev/null").c_str()), 0) << line.name;
  }
}

}  // namespace
}  // namespace gear3k::wide_rig
