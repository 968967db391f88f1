#include "io/files/model_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "calibrate/causes/form_catalogue.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io::model_file_test {
namespace {

using calibrate::AppliedCause, calibrate::ExtendedModel, calibrate::Kind;

/// What reading says is wrong with a text; "" when nothing is.
std::string errors_of(const std::string& text) {
  try {
    parse_model(text, "m.toml");
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

void expect_same(const ExtendedModel& a, const ExtendedModel& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.fingerprint, b.fingerprint);
  EXPECT_EQ(a.files, b.files);
  EXPECT_EQ(a.verdict, b.verdict);
  ASSERT_EQ(a.range.size(), b.range.size());
  for (std::size_t k = 0; k < a.range.size(); ++k) {
    EXPECT_EQ(a.range[k].name, b.range[k].name);
    EXPECT_EQ(a.range[k].unit, b.range[k].unit);
    if (std::isnan(a.range[k].low)) {
      EXPECT_TRUE(std::isnan(b.range[k].low) && std::isnan(b.range[k].high));
      continue;
    }
    EXPECT_EQ(a.range[k].low, b.range[k].low);
    EXPECT_EQ(a.range[k].high, b.range[k].high);
  }
  ASSERT_EQ(a.causes.size(), b.causes.size());
  for (std::size_t k = 0; k < a.causes.size(); ++k) {
    const AppliedCause& one = a.causes[k];
    const AppliedCause& other = b.causes[k];
    EXPECT_EQ(one.id, other.id);
    EXPECT_EQ(one.value, other.value);
    EXPECT_EQ(one.alternatives, other.alternatives);
    EXPECT_EQ(one.implausible, other.implausible);
    EXPECT_EQ(one.empirical, other.empirical);
    EXPECT_EQ(std::isnan(one.left_behind), std::isnan(other.left_behind));
    if (!std::isnan(one.left_behind)) {
      EXPECT_EQ(one.left_behind, other.left_behind);
    }
    EXPECT_EQ(one.left_behind_on, other.left_behind_on);
    EXPECT_EQ(one.form.name, other.form.name);
    EXPECT_EQ(one.form.body, other.form.body);
    EXPECT_EQ(one.form.order, other.form.order);
    ASSERT_EQ(one.form.constants.size(), other.form.constants.size());
    for (std::size_t c = 0; c < one.form.constants.size(); ++c) {
      EXPECT_EQ(one.form.constants[c].name, other.form.constants[c].name);
      EXPECT_EQ(one.form.constants[c].unit, other.form.constants[c].unit);
      EXPECT_EQ(one.form.constants[c].value, other.form.constants[c].value);
    }
  }
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.beyond_springs, b.beyond_springs);
}

/// Every form of every cause of a kind, twice over, with numbers of all digits.
ExtendedModel everything(Kind kind, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> share(0.1, 0.9);
  ExtendedModel m;
  m.kind = kind;
  m.name = "gear \"A\"\\";
  m.files = {"a b.csv", "ü.csv"};
  m.fingerprint = generator();
  m.verdict = static_cast<calibrate::Verdict>(static_cast<int>(kind));
  m.beyond_springs = kind == Kind::kLostMotion;
  m.range = {{.name = "sun_speed", .unit = "rpm", .low = 200.0, .high = 1000.0 / 3.0},
             {.name = "temperature",
              .unit = "c",
              .low = calibrate::kUnknown,
              .high = calibrate::kUnknown}};
  std::size_t count = 0;
  for (const calibrate::Cause* cause : calibrate::causes()) {
    for (const auto& known : calibrate::form_catalogue(*cause, kind)) {
      for (const auto& set : known.sets) {
        AppliedCause applied{.id = std::string(cause->id), .form = {}, .value = {}};
        applied.form.name = known.name;
        applied.form.constants = set;
        for (auto& constant : applied.form.constants) {
          constexpr double kMost = 16.0;
          constant.value = 100.0 * share(generator);
          if (constant.name == "first_run") constant.value = std::floor(constant.value);
          if (constant.name == "sessions") {
            constant.value = 1.0 + std::floor(kMost * share(generator));
          }
          if (constant.name.starts_with("place_")) {  // one after the other
            constant.value = -1.0 + 0.25 * (constant.name.back() - '1' + share(generator));
          }
        }
        if (!known.bodies.empty()) applied.form.body = known.bodies.back();
        if (known.has_order) applied.form.order = 100.0 * share(generator);
        for (const auto& p : cause->parameters(applied.form, kind)) {
          const double low = std::max(p.lower, -10.0);
          const double high = std::min(p.upper, 10.0);
          applied.value.push_back(low + (high - low) * share(generator));
        }
        if (m.causes.size() % 2 == 0) applied.alternatives = {"sensor_gain", "bearing_load"};
        if (m.causes.size() % 3 == 0) applied.implausible = {"amplitude"};
        applied.empirical = m.causes.size() % 4 == 1;
        if (cause->as_constant != nullptr && m.causes.size() % 2 == 1) {
          applied.left_behind = share(generator) - 0.5;
          if (m.causes.size() % 3 != 0) applied.left_behind_on = calibrate::kOnGain;
        }
        count += applied.value.size();
        m.causes.push_back(applied);
      }
    }
  }
  // I + L Lᵀ of a random L of a few columns.
  constexpr std::size_t kColumns = 8;
  std::vector<double> factor(count * kColumns, 0.0);
  for (double& x : factor) x = share(generator);
  m.covariance.assign(count * count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      double& entry = m.covariance[i * count + j];
      entry = i == j ? 1.0 : 0.0;
      for (std::size_t k = 0; k < kColumns; ++k) {
        entry += factor[i * kColumns + k] * factor[j * kColumns + k];
      }
    }
  }
  return m;
}

/// A model with a few of its causes each, as a file holds at most a megabyte.
std::vector<ExtendedModel> parts_of(const ExtendedModel& whole) {
  constexpr std::size_t kCauses = 12;
  std::size_t all = 0;
  for (const auto& cause : whole.causes) all += cause.value.size();
  std::vector<ExtendedModel> parts;
  std::size_t offset = 0;
  for (std::size_t first = 0; first < whole.causes.size(); first += kCauses) {
    const std::size_t end = std::min(whole.causes.size(), first + kCauses);
    ExtendedModel part = whole;
    part.causes.assign(whole.causes.begin() + static_cast<std::ptrdiff_t>(first),
                       whole.causes.begin() + static_cast<std::ptrdiff_t>(end));
    std::size_t count = 0;
    for (const auto& cause : part.causes) count += cause.value.size();
    part.covariance.clear();
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        part.covariance.push_back(whole.covariance[(offset + i) * all + offset + j]);
      }
    }
    offset += count;
    parts.push_back(std::move(part));
  }
  return parts;
}

TEST(ModelFile, EveryFormOfEveryCauseComesBackExactly) {
  std::mt19937_64 generator(5);
  std::vector<ExtendedModel> one_of_each;
  const auto expect_back = [](const std::vector<ExtendedModel>& models) {
    const std::string text = model_text(models);
    const auto back = parse_model(text, "m.toml");
    ASSERT_EQ(back.size(), models.size());
    for (std::size_t k = 0; k < models.size(); ++k) expect_same(models[k], back[k]);
    EXPECT_EQ(model_text(back), text);
  };
  for (const Kind kind :
       {Kind::kTransmission, Kind::kLostMotion, Kind::kTorqueAngle, Kind::kPairLoss}) {
    const std::vector<ExtendedModel> parts = parts_of(everything(kind, generator));
    for (const ExtendedModel& part : parts) expect_back({part});
    EXPECT_GT(parts.front().causes.size(), 1U);
    one_of_each.push_back(parts.front());
  }
  expect_back(one_of_each);
}

TEST(ModelFile, ConstantsHaveTheirRanges) {
  const auto refused = [](const std::string& cause, const std::string& form,
                          const std::string& line, const std::string& allowed) {
    const std::string text =
        "[lost_motion]\nname = \"gear\"\n[lost_motion.range]\n"
        "[lost_motion.causes." +
        cause + "]\nform = \"" + form + "\"\n" + line + "\n";
    try {
      parse_model(text, "m.toml");
    } catch (const InvalidInput& error) {
      return std::string(error.what()).find("m.toml:6:") != std::string::npos &&
             std::string(error.what()).find(allowed) != std::string::npos;
    }
    return false;
  };
  for (const char* bad : {"0", "-1.0"}) {
    EXPECT_TRUE(refused("compliance", "hardening", std::string("hardening_torque_nm = ") + bad,
                        "a number above 0"));
    EXPECT_TRUE(
        refused("drift", "linear_time", std::string("span_s = ") + bad, "a number above 0"));
  }
  for (const char* bad : {"0", "2.5", "17", "1e300"}) {
    EXPECT_TRUE(refused("run_step", "sessions", std::string("sessions = ") + bad,
                        "an integer from 1 to 16"));
  }
  EXPECT_TRUE(refused("thermal_expansion", "from_design", "reference_temperature_c = -300.0",
                      "a number above -273.15"));
}

TEST(ModelFile, OrderOfKeysChangesNothing) {
  const std::string head =
      "[transmission]\nname = \"gear\"\n[transmission.range]\n"
      "[transmission.causes.friction_temperature]\nform = \"any_curve\"\n"
      "coefficient_per_k = 0.01\nrelative_change = 0.1\ncurvature = 0.2\n";
  const std::string a = "reference_temperature_c = 30.0\n";
  const std::string b = "half_range_k = 10.0\n";
  EXPECT_EQ(model_text(parse_model(head + a + b, "m.toml")),
            model_text(parse_model(head + b + a, "m.toml")));
}

TEST(ModelFile, AModelWithoutCausesComesBack) {
  ExtendedModel m;
  m.kind = Kind::kPairLoss;
  const auto back = parse_model(model_text({m}), "m.toml");
  ASSERT_EQ(back.size(), 1U);
  expect_same(m, back[0]);
}

const std::string kModel = R"([transmission]
name = "gear"
data_fingerprint = "fnv1a64:00000000000000ff"
[transmission.range]
sun_speed_rpm = [200, 1000]
[transmission.causes.drag_constant]
form = "sun"
torque_nm = 0.02
torque_nm_sd = 0.001
[transmission.causes.friction_level]
form = "coefficient"
relative_change = 0.2
relative_change_sd = 0.1
)";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kModel;
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::invalid_argument(from);
  return text.replace(at, from.size(), to);
}

TEST(ModelFile, DeviationsAloneAreIndependentParameters) {
  const auto models = parse_model(kModel, "m.toml");
  ASSERT_EQ(models.size(), 1U);
  EXPECT_EQ(models[0].fingerprint, 255U);
  ASSERT_EQ(models[0].covariance.size(), 4U);
  EXPECT_EQ(models[0].covariance[0], 0.001 * 0.001);
  EXPECT_EQ(models[0].covariance[1], 0.0);
}

TEST(ModelFile, CovarianceMayNameTheParametersInAnyOrder) {
  const auto models = parse_model(kModel + R"([transmission.covariance]
parameters = ["friction_level.relative_change", "drag_constant.torque_nm"]
matrix = [0.01, 2e-5, 2e-5, 1e-6]
)",
                                  "m.toml");
  EXPECT_EQ(models[0].covariance, (std::vector<double>{1e-6, 2e-5, 2e-5, 0.01}));
}

TEST(ModelFile, EveryErrorHasItsPlaceAndWhatIsAllowed) {
  struct Case {
    std::string text;
    std::vector<std::string> parts;
  };
  const std::string covariance =
      "[transmission.covariance]\nparameters = [\"drag_constant.torque_nm\", "
      "\"friction_level.relative_change\"]\nmatrix = ";
  const std::vector<Case> cases{
      {"", {"m.toml:1:1: no model in the file"}},
      {"[transmision]\n", {"m.toml:1:2: unknown table transmision; did you mean transmission?"}},
      {with("causes.drag_constant", "causes.drag_constnt"),
       {"m.toml:6:",
        "unknown cause transmission.causes.drag_constnt; did you mean drag_constant?"}},
      {with("\"sun\"", "\"outpt\""), {"m.toml:7:1: ", "did you mean \"output\"?"}},
      {with("torque_nm = ", "torqe_nm = "),
       {"m.toml:6:", "torque_nm is missing", "m.toml:8:1: unknown key", "did you mean torque_nm?"}},
      {with("0.02\n", "-0.02\n"), {"m.toml:8:1: ", "= -0.02: allowed: a number in Nm, 0 to 100"}},
      {with("form = \"sun\"\n", ""), {"form is missing: allowed: \"sun\" or \"output\""}},
      {with("0.001", "-0.001"), {"m.toml:9:1: ", "allowed: a number, at least 0"}},
      {with("ff\"", "fg\""), {"m.toml:3:1: ", "16 hexadecimal digits"}},
      {with("sun_speed_rpm", "sun_sped_rpm"), {"m.toml:5:1: ", "did you mean sun_speed_rpm?"}},
      {with("[200, 1000]", "[1000, 200]"), {"m.toml:5:1: ", "low <= high"}},
      {with("[200, 1000]", "[-1000, -200]"),
       {"m.toml:5:1: transmission.range.sun_speed_rpm = [-1000, -200]: allowed: [low, high]",
        "each a finite number, at least 0 (speeds and torques are magnitudes"}},
      {with("name", "nam"), {"m.toml:2:1: unknown key transmission.nam; did you mean name?"}},
      {kModel + covariance + "[1e-6, 2e-5, 3e-5, 0.01]\n", {"m.toml:16:1: ", "not symmetric"}},
      {kModel + covariance + "[1e-6, 2e-4, 2e-4, 0.01]\n", {"not positive semidefinite"}},
      {kModel + covariance + "[1e-6, 2e-5, 2e-5]\n", {"3 elements: allowed: 4 numbers, 2 by 2"}},
      {kModel + covariance + "[-1e-6, 0, 0, 0.01]\n", {"variance of drag_constant.torque_nm"}},
      {kModel + covariance + "[4e-6, 0, 0, 0.01]\n",
       {"m.toml:9:1: ", "the square root of its variance"}},
      {kModel +
           "[transmission.covariance]\nparameters = [\"drag_constant.torq_nm\"]\nmatrix = []\n",
       {"unknown parameter \"drag_constant.torq_nm\"; did you mean drag_constant.torque_nm?",
        "friction_level.relative_change is missing"}},
      {"[lost_motion.causes.drag_constant]\nform = \"sun\"\n", {"lost_motion data cannot show"}},
      {"[transmission.causes.friction_load]\nform = \"any_smooth_4_levels\"\n"
       "reference_load_n = 100.0\nlog_half_range = 1.0\nplace_2 = 0.4\nplace_3 = 0.405\n",
       {"m.toml:6:1: transmission.causes.friction_load.place_3 = 0.405: allowed: a number at least "
        "0.01 above place_2 (0.4), up to 0.99"}},
      {"[transmission.causes.friction_load]\nform = \"any_smooth_5_levels\"\nplace_2 = -0.995\n"
       "reference_load_n = 100.0\nlog_half_range = 1.0\nplace_3 = -0.999\nplace_4 = 2.0\n",
       {"m.toml:3:1: transmission.causes.friction_load.place_2 = -0.995: allowed: a number at "
        "least 0.01 above the first place (-1), up to 0.99"}},
      {"[transmission.causes.friction_load]\nform = \"about_middle\"\nexponent = 0.1\n",
       {"needs reference_load_n, or reference_load_nm"}}};
  for (const Case& one : cases) {
    const std::string errors = errors_of(one.text);
    for (const std::string& part : one.parts) {
      EXPECT_TRUE(contains(errors, part)) << "wanted: " << part << "\ngot: " << errors;
    }
  }
}

TEST(ModelFile, AMissingPlaceOfALevelIsOneErrorAndNoneOfTheParameters) {
  const std::string errors = errors_of(
      "[transmission.causes.friction_load]\nform = \"any_smooth_4_levels\"\n"
      "reference_load_n = 100.0\nlog_half_range = 1.0\nplace_2 = -0.3\n"
      "relative_change = 0.1\nlog_change_1 = 0.2\nlog_change_2 = 0.1\n"
      "log_change_4 = -0.1\n");
  EXPECT_TRUE(contains(errors, "m.toml:1:")) << errors;
  EXPECT_TRUE(contains(errors, "place_2 and place_3")) << errors;
  EXPECT_EQ(std::ranges::count(errors, '\n'), 0) << errors;
}

TEST(ModelFile, AWrongFormDoesNotHideWhatElseIsWrongWithACause) {
  const std::string errors = errors_of(
      "[transmission.causes.drag_constant]\nform = \"sum\"\ntorqe_nm = 0.01\nbody = \"sun\"\n");
  for (const char* part :
       {"m.toml:2:", "did you mean \"sun\"?", "m.toml:3:", "did you mean torque_nm?"}) {
    EXPECT_TRUE(contains(errors, part)) << part << '\n' << errors;
  }
  EXPECT_FALSE(contains(errors, "drag_constant.body")) << "another form has it: " << errors;
}

TEST(ModelFile, AWrongFormAsksForNoParameterOfAnotherForm) {
  struct Case {
    std::string id, parameters;
  };
  // The parameters of the form that comes last among those of its cause.
  const std::vector<Case> cases{
      {"bearing_load", "share = 0.01\nshare_sd = 0.001\n"},
      {"friction_load", "exponent = 0.1\nrelative_change = 0.1\nreference_load_n = 100.0\n"},
      {"friction_speed", "exponent = -0.1\nreference_speed_m_per_s = 0.1\n"},
      {"friction_temperature", "coefficient_per_k = 0.01\n"}};
  for (const Case& one : cases) {
    const std::string errors =
        errors_of("[transmission.causes." + one.id + "]\nform = \"no_such\"\n" + one.parameters);
    EXPECT_TRUE(contains(errors, "m.toml:2:")) << errors;
    EXPECT_EQ(std::ranges::count(errors, '\n'), 0) << errors;
  }
}

TEST(ModelFile, AWrongFormDoesNotHideAValueThatNoFormAllows) {
  const std::string errors = errors_of(
      "[transmission.causes.bearing_load]\nform = \"no_such\"\nshare = 99.0\nshare_sd = -1.0\n");
  for (const char* part : {"m.toml:2:", "m.toml:3:", "m.toml:4:"}) {
    EXPECT_TRUE(contains(errors, part)) << part << '\n' << errors;
  }
}

TEST(ModelFile, VerdictAndAlternativesAreChecked) {
  const std::string errors = errors_of(
      "[transmission]\nverdict = \"unsure\"\n[transmission.causes.drag_constant]\nform = "
      "\"sun\"\ntorque_nm = 0.01\nalternatives = [\"sensor_ofset\"]\nimplausible = "
      "\"x\"\nempirical = 1\n");
  for (const char* part :
       {"m.toml:2:", "\"no_discrepancy\" or \"explained\" or \"ambiguous\" or \"unexplained\"",
        "m.toml:6:", "did you mean sensor_offset?", "m.toml:7:", "a list of texts",
        "m.toml:8:", "transmission.causes.drag_constant.empirical = 1: allowed: true or false"}) {
    EXPECT_TRUE(contains(errors, part)) << part << '\n' << errors;
  }
}

TEST(ModelFile, AllErrorsAreToldAtOnce) {
  const std::string errors =
      errors_of("[transmission]\nname = 3\ndata_files = \"a\"\n[transmission.causes.x]\n[other]\n");
  EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 3) << errors;
}

TEST(ModelText, RefusesWhatTheFileCannotHold) {
  ExtendedModel m;
  EXPECT_THROW(model_text({m, m}), std::invalid_argument);
  m.causes = {{.id = "no_such_cause", .form = {}, .value = {}}};
  EXPECT_THROW(model_text({m}), std::invalid_argument);
  m.causes.clear();
  m.range = {{.name = "colour", .unit = "", .low = 0.0, .high = 1.0}};
  EXPECT_THROW(model_text({m}), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::io::model_file_test
