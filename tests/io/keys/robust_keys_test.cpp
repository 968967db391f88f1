#include "io/keys/robust_keys.hpp"

#include <gtest/gtest.h>

#include <string>

#include "io/files/specification_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io::robust_keys_test {
namespace {

const std::string kSpec =
    "[ratio]\ntarget = 96.2\n[teeth]\nS = [10, 20]\nP1 = [20, 60]\nR1_max = 120\nP2 = [20, 60]\n"
    "R2_max = 120\n[module]\nstage1_mm = 0.5\nstage2_mm = 0.5\n";
const std::string kTolerances = "[tolerances]\npin_position_um = 8\n";

std::string spec_errors(const std::string& text) {
  try {
    static_cast<void>(parse_specification(text, "spec.toml"));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(RobustKeys, AreRefusedWithoutWhatTheyNeed) {
  EXPECT_NE(spec_errors(kSpec + "[robust]\nhold = \"yield\"\n")
                .find("robust.hold = \"yield\" without [tolerances]: allowed: with them"),
            std::string::npos);
  EXPECT_NE(spec_errors(kSpec + "[tolerances.S]\naccuracy_grade = 6\n")
                .find("tolerances.S.accuracy_grade = 6: allowed in DESIGN files"),
            std::string::npos);
  EXPECT_NE(spec_errors(kSpec + "[robust]\ntolerances = \"cheapest\"\n")
                .find("robust.tolerances = \"cheapest\": allowed with robust.hold = \"yield\""),
            std::string::npos);
}

TEST(RobustKeys, RefuseAYieldForWhichNoCheapestTolerancesAreSought) {
  const std::string robust = "[robust]\nhold = \"yield\"\ntolerances = \"cheapest\"\nyield = ";
  EXPECT_EQ(spec_errors(kSpec + kTolerances + robust + "0.99995\n"), "");
  const std::string errors = spec_errors(kSpec + kTolerances + robust + "0.99996\n");
  EXPECT_NE(errors.find("robust.yield = 0.99996: allowed up to 0.99995 with robust.tolerances = "
                        "\"cheapest\""),
            std::string::npos)
      << errors;
}

TEST(RobustKeys, RefuseLimitsThatBuiltGearboxesCannotBeHeldTo) {
  const std::string errors =
      spec_errors(kSpec + kTolerances +
                  "[backlash]\nmodel = \"paper\"\nmin_output_arcmin = 2.5\nmax_output_arcmin = 8\n"
                  "[robust]\nhold = \"yield\"\n");
  EXPECT_NE(errors.find("backlash.min_output_arcmin = 2.5 with robust.hold: allowed: 0"),
            std::string::npos)
      << errors;
  EXPECT_NE(errors.find("backlash.model = \"paper\" with robust.hold: allowed: \"kinematic\""),
            std::string::npos)
      << errors;
  EXPECT_EQ(spec_errors(kSpec + kTolerances + "[robust]\nhold = \"worst_case\"\n"), "");
}

TEST(RobustKeys, ThatNothingReadsAreErrors) {
  const std::string errors = spec_errors(
      kSpec + kTolerances + "[robust]\nhold = \"worst_case\"\nyield = 0.9\ncost.runout = 2\n");
  EXPECT_NE(errors.find("robust.yield = 0.9: allowed with robust.hold = \"yield\""),
            std::string::npos)
      << errors;
  EXPECT_NE(errors.find("robust.cost.runout = 2: allowed with robust.tolerances = \"cheapest\""),
            std::string::npos)
      << errors;
}

}  // namespace
}  // namespace gear3k::io::robust_keys_test
