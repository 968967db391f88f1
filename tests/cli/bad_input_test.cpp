// What the program does with wrong commands and files, and with tasks that no design fulfils.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "tests/cli/run_program.hpp"

namespace gear3k::bad_input_test {
namespace {

using test::ProgramResult, test::Workplace, test::replaced;

constexpr int kUsage = 1;
constexpr int kInvalidInput = 2;
constexpr int kNoFeasibleDesign = 3;

/// A design without fault; the rows below break one line of it each.
const std::string kDesign =
    "name = \"gear\"\n"                             //  1
    "planets = 3\n"                                 //  2
    "pressure_angle_deg = 20.0\n"                   //  3
    "[stage1]\n"                                    //  4
    "module_mm = 0.8\n"                             //  5
    "[stage2]\n"                                    //  6
    "module_mm = 0.8467\n"                          //  7
    "[gears]\n"                                     //  8
    "S = { teeth = 12, profile_shift = 0.476 }\n"   //  9
    "P1 = { teeth = 39, profile_shift = 0.762 }\n"  // 10
    "R1 = { teeth = 90, profile_shift = 2.0 }\n"    // 11
    "P2 = { teeth = 32, profile_shift = 0.536 }\n"  // 12
    "R2 = { teeth = 81, profile_shift = 1.21 }\n"   // 13
    "[friction]\n"                                  // 14
    "coefficient = 0.1\n";                          // 15

const std::string kPair =
    "kind = \"internal\"\n"   // 1
    "module_mm = 3.0\n"       // 2
    "[gear1]\n"               // 3
    "teeth = 16\n"            // 4
    "[gear2]\n"               // 5
    "teeth = 24\n"            // 6
    "profile_shift = 0.5\n";  // 7

const std::string kSpec =
    "planets = 3\n"                            //  1
    "objective = \"backward_efficiency\"\n"    //  2
    "[ratio]\n"                                //  3
    "target = 96.2\n"                          //  4
    "[teeth]\n"                                //  5
    "S = [12, 13]\n"                           //  6
    "P1 = [50, 60]\n"                          //  7
    "R1_max = 120\n"                           //  8
    "P2 = [40, 60]\n"                          //  9
    "R2_max = 120\n"                           // 10
    "[module]\n"                               // 11
    "stage1_mm = 1.0\n"                        // 12
    "stage2_mm = { min = 0.1, max = 10.0 }\n"  // 13
    "[backlash]\n"                             // 14
    "max_output_arcmin = 8.0\n"                // 15
    "[solver]\n"                               // 16
    "starts = 1\n";                            // 17

struct BadInput {
  std::string fact;                    ///< name of the test
  std::vector<std::string> arguments;  ///< of the program
  std::string file, content;           ///< written before; "" = none
  int exit_code;
  std::vector<std::string> fragments;  ///< that stderr holds
};

void PrintTo(const BadInput& input, std::ostream* stream) { *stream << input.fact; }

BadInput bad_design(const std::string& fact, const std::string& content,
                    const std::vector<std::string>& fragments) {
  return {fact, {"analyze", "gear.toml"}, "gear.toml", content, kInvalidInput, fragments};
}
BadInput bad_pair(const std::string& fact, const std::string& content,
                  const std::vector<std::string>& fragments) {
  return {fact, {"mesh", "pair.toml"}, "pair.toml", content, kInvalidInput, fragments};
}
BadInput bad_spec(const std::string& fact, const std::string& content,
                  const std::vector<std::string>& fragments) {
  return {fact, {"search", "spec.toml"}, "spec.toml", content, kInvalidInput, fragments};
}
BadInput bad_task(const std::string& fact, const std::string& content,
                  const std::vector<std::string>& fragments) {
  return {fact,     {"optimize", "spec.toml", "--out", "out"}, "spec.toml", content, kInvalidInput,
          fragments};
}
BadInput bad_usage(const std::string& fact, const std::vector<std::string>& arguments,
                   const std::vector<std::string>& fragments) {
  return {fact, arguments, "gear.toml", kDesign, kUsage, fragments};
}

std::vector<BadInput> usage_inputs() {
  return {
      bad_usage("NoCommand", {}, {"subcommand", "--help"}),
      bad_usage("UnknownCommandIsNamed", {"analyse", "gear.toml"}, {"analyse"}),
      bad_usage("UnknownOptionIsNamed", {"analyze", "gear.toml", "--fromat", "json"}, {"--fromat"}),
      bad_usage("NoFile", {"analyze"}, {"gear3k analyze: DESIGN is missing: DESIGN.toml\n"}),
      bad_usage("AllThatIsMissingIsTold", {"optimize"},
                {"gear3k optimize: SPEC is missing: SPEC.toml\n",
                 "gear3k optimize: --out is missing: folder for the result files\n",
                 "usage: gear3k optimize [OPTIONS] SPEC --out OUT\n"}),
      bad_usage("OneOfTwoFiles", {"compare", "gear.toml"},
                {"gear3k compare: DESIGN: 1 given, allowed: 2 to 32 files"}),
      bad_usage("OptionWithoutItsValue", {"export", "gear.toml", "--sheet"},
                {"gear3k export: --sheet without its value: folder for inspection sheets"}),
      bad_usage("KeysAreMarkdownOnly", {"keys", "--format", "json"}, {"--format", "table"}),
      bad_usage("NewFilesAreTomlOnly", {"new", "task", "--format", "csv"}, {"--format", "table"}),
      bad_usage("UnknownKindOfNewFile", {"new", "tsk"},
                {"unknown kind tsk", "task", "design, pair"}),
      bad_usage("NoKindOfNewFile", {"new"}, {"KIND"}),
      bad_usage("PagesAreRoffOnly", {"manual", "--format", "json"}, {"--format", "table"}),
      bad_usage("UnknownPage", {"manual", "optmize"},
                {"unknown page optmize", "optimize", "gear3k.5"}),
      bad_usage("APageOrAFolderOfAll", {"manual", "optimize", "--out", "pages"}, {"PAGE", "--out"}),
      bad_usage("CompletionIsAScriptOnly", {"completion", "--format", "csv"},
                {"--format", "table"}),
      bad_usage("NoPairFile", {"mesh"}, {"PAIR"}),
      bad_usage("NoSpecFile", {"search"}, {"SPEC"}),
      bad_usage("TwoFiles", {"analyze", "gear.toml", "second.toml"}, {"second.toml"}),
      bad_usage("UnknownFormat", {"analyze", "gear.toml", "--format", "xml"},
                {"--format", "xml", "table", "json", "csv"}),
      bad_usage("FormatByNumber", {"analyze", "gear.toml", "--format", "2"},
                {"--format", "2", "table", "json", "csv"}),
      bad_usage("ReproduceUnknownFormat", {"reproduce", "--format", "yaml"},
                {"--format", "yaml", "table", "json", "csv"}),
      bad_usage("ThreadsZero", {"analyze", "gear.toml", "--threads", "0"},
                {"--threads = 0: allowed: a whole number, 1 to 1024"}),
      bad_usage("ThreadsNegative", {"reproduce", "--threads", "-3"}, {"--threads", "-3"}),
      bad_usage("ThreadsNoNumber", {"reproduce", "--threads", "two"},
                {"--threads = two: allowed: a whole number"}),
      bad_usage("ThreadsBeyondAnyInteger", {"reproduce", "--threads", "99999999999999999999"},
                {"--threads", "99999999999999999999"}),
      bad_usage("OptimizeWithoutOut", {"optimize", "gear.toml"}, {"--out"}),
      bad_usage("OutWithoutValue", {"analyze", "gear.toml", "--out"}, {"--out"}),
      bad_usage("TopZero", {"search", "gear.toml", "--top", "0"},
                {"--top = 0: allowed: a whole number, 1 to 1000000"}),
      bad_usage("ColumnsTooFew", {"analyze", "gear.toml", "--columns", "1"},
                {"--columns = 1: allowed: a whole number, 60 to 500"}),
      bad_usage("SamplesBroken", {"tolerances", "gear.toml", "--samples", "1e5"},
                {"--samples = 1e5: allowed: a whole number, 1000 to 1000000000"}),
      bad_usage("BudgetNegative", {"optimize", "gear.toml", "--out", "out", "--front-budget", "-1"},
                {"--front-budget = -1: allowed: a number, 0.001 to 1e+07"}),
      bad_usage("BudgetNotANumber",
                {"optimize", "gear.toml", "--out", "out", "--front-budget", "nan"},
                {"--front-budget = nan: allowed: a number, 0.001"}),
      bad_usage("RateNoNumber",
                {"diagnose", "gear.toml", "data.csv", "--false-discovery-rate", "few"},
                {"--false-discovery-rate = few: allowed: a number"}),
      bad_usage("StrictBelongsToAnalyzeAndMesh", {"reproduce", "--strict"}, {"--strict"}),
      bad_usage("ReproduceTakesNoFile", {"reproduce", "gear.toml"}, {"gear.toml"}),
  };
}

std::vector<BadInput> path_inputs() {
  return {
      {"MissingDesign",
       {"analyze", "absent.toml"},
       "",
       "",
       kInvalidInput,
       {"absent.toml: ", "No such file"}},
      {"MissingPair",
       {"mesh", "absent.toml"},
       "",
       "",
       kInvalidInput,
       {"absent.toml: ", "No such file"}},
      {"MissingSpecMakesNoFolder",
       {"optimize", "absent.toml", "--out", "out"},
       "",
       "",
       kInvalidInput,
       {"absent.toml: ", "No such file"}},
      {"FolderForAFile", {"analyze", "."}, "", "", kInvalidInput, {".: is a directory", "TOML"}},
      {"FileBelowAFile",
       {"analyze", "gear.toml/inner.toml"},
       "gear.toml",
       kDesign,
       kInvalidInput,
       {"gear.toml/inner.toml: ", "Not a directory"}},
      {"OutInAMissingFolder",
       {"analyze", "gear.toml", "--out", "absent/result.json"},
       "gear.toml",
       kDesign,
       kInvalidInput,
       {"absent/result.json: ", "No such file"}},
      {"OutOnAFolder",
       {"mesh", "pair.toml", "--out", "."},
       "pair.toml",
       kPair,
       kInvalidInput,
       {".: "}},
      {"ReproduceOutInAMissingFolder",
       {"reproduce", "--out", "absent/result.txt"},
       "",
       "",
       kInvalidInput,
       {"absent/result.txt: ", "No such file"}},
      {"SearchOutInAMissingFolder",
       {"search", "spec.toml", "--out", "absent/sets.csv"},
       "spec.toml",
       kSpec,
       kInvalidInput,
       {"absent/sets.csv: ", "No such file"}},
      {"OptimizeOutOnAFile",
       {"optimize", "spec.toml", "--out", "spec.toml"},
       "spec.toml",
       kSpec,
       kInvalidInput,
       {"spec.toml: cannot be made a folder"}},
      {"OptimizeOutBelowAFile",
       {"optimize", "spec.toml", "--out", "spec.toml/out"},
       "spec.toml",
       kSpec,
       kInvalidInput,
       {"spec.toml/out: cannot be made a folder"}},
  };
}

std::vector<BadInput> design_inputs() {
  return {
      bad_design(
          "EmptyFileLacksEveryRequiredKey", "",
          {"gear.toml:1:1: stage1.module_mm is missing",
           "gear.toml:1:1: stage2.module_mm is missing", "gear.toml:1:1: gears.S.teeth is missing",
           "gear.toml:1:1: gears.P1.teeth is missing", "gear.toml:1:1: gears.R1.teeth is missing",
           "gear.toml:1:1: gears.P2.teeth is missing", "gear.toml:1:1: gears.R2.teeth is missing",
           "a number in mm, 0.001 to 100"}),
      bad_design("BinaryGarbage",
                 std::string("\x7f"
                             "ELF\x02\x01\0\0\xff\xfe\x80",
                             11),
                 {"gear.toml:1:", "not valid TOML"}),
      bad_design("NotToml", "teeth: 12\n", {"gear.toml:1:", "not valid TOML"}),
      bad_design("UnclosedText", replaced(kDesign, "\"gear\"", "\"gear"),
                 {"gear.toml:1:", "not valid TOML"}),
      bad_design("DeepNesting", "name = " + std::string(20000, '['),
                 {"gear.toml:1:24: lists and tables 17 deep, allowed: at most 16"}),
      bad_design("DuplicateKey", replaced(kDesign, "planets = 3\n", "planets = 3\nplanets = 4\n"),
                 {"gear.toml:3:", "not valid TOML", "planets"}),
      bad_design("DuplicateTable", replaced(kDesign, "[stage2]", "[stage1]"),
                 {"gear.toml:6:", "stage1"}),
      bad_design("UnknownKeyHasADidYouMean", replaced(kDesign, "planets", "plannets"),
                 {"gear.toml:2:1: unknown key plannets; did you mean planets?"}),
      bad_design("UnknownGearKeyHasADidYouMean",
                 replaced(kDesign, "profile_shift = 2.0", "profile_shfit = 2.0"),
                 {"gear.toml:11:20: unknown key gears.R1.profile_shfit; did you mean "
                  "gears.R1.profile_shift?"}),
      bad_design("KeyWithoutItsUnitHasADidYouMean", replaced(kDesign, "module_mm", "module"),
                 {"gear.toml:5:1: unknown key stage1.module; did you mean stage1.module_mm?",
                  "gear.toml:4:", "stage1.module_mm is missing"}),
      bad_design("KeyInTheWrongTableHasADidYouMean",
                 replaced(kDesign, "[stage2]\n", "center_distance_mm = 21.268\n[stage2]\n"),
                 {"gear.toml:6:1: unknown key stage1.center_distance_mm; did you mean "
                  "center_distance_mm?"}),
      bad_design("UnknownTableHasADidYouMean", replaced(kDesign, "[friction]", "[frction]"),
                 {"gear.toml:14:2: unknown table [frction]; did you mean [friction]?"}),
      bad_design("UnknownGearHasADidYouMean", replaced(kDesign, "R2 =", "R3 ="),
                 {"gear.toml:13:1: unknown table [gears.R3]; did you mean [gears.R",
                  "gears.R2.teeth is missing"}),
      bad_design("ValueForATable", replaced(kDesign, "[stage1]\nmodule_mm = 0.8", "stage1 = 0.8"),
                 {"gear.toml:4:1: stage1 = 0.8: allowed: a table [stage1]"}),
      bad_design("TableForAValue", replaced(kDesign, "planets = 3", "planets = { count = 3 }"),
                 {"gear.toml:2:1: planets = { count = 3 }: allowed: an integer, 1 to 24"}),
      bad_design("TextForANumber", replaced(kDesign, "teeth = 12", "teeth = \"12\""),
                 {"gear.toml:9:7: gears.S.teeth = \"12\": allowed: an integer"}),
      bad_design("FractionForAnInteger", replaced(kDesign, "teeth = 12", "teeth = 12.5"),
                 {"gear.toml:9:7: gears.S.teeth = 12.5: allowed: an integer"}),
      bad_design("NumberForAText", replaced(kDesign, "\"gear\"", "7"),
                 {"gear.toml:1:1: name = 7: allowed: a text in quotes"}),
      bad_design("DateForANumber",
                 replaced(kDesign, "coefficient = 0.1", "coefficient = 2020-01-01"),
                 {"gear.toml:15:1: friction.coefficient = ", "allowed: a number, 0 to 1"}),
      bad_design("ListForAnInteger", replaced(kDesign, "planets = 3", "planets = [3, 4]"),
                 {"gear.toml:2:1: planets = [3, 4]: allowed: an integer, 1 to 24"}),
      bad_design("NanForANumber", replaced(kDesign, "coefficient = 0.1", "coefficient = nan"),
                 {"gear.toml:15:1: friction.coefficient = nan: allowed: a number, 0 to 1"}),
      bad_design("InfinityForANumber", replaced(kDesign, "module_mm = 0.8\n", "module_mm = inf\n"),
                 {"gear.toml:5:1: stage1.module_mm = inf: allowed: a number in mm, 0.001 to 100"}),
      bad_design(
          "ModuleThatNoMetreHolds", replaced(kDesign, "module_mm = 0.8467", "module_mm = 5e-324"),
          {"gear.toml:7:1: stage2.module_mm = 5e-324: allowed: a number in mm, 0.001 to 100"}),
      bad_design("ZeroModule", replaced(kDesign, "module_mm = 0.8467", "module_mm = 0.0"),
                 {"gear.toml:7:1: stage2.module_mm = 0.0: allowed: a number in mm, 0.001 to 100"}),
      bad_design("NegativeFriction", replaced(kDesign, "coefficient = 0.1", "coefficient = -0.1"),
                 {"gear.toml:15:1: friction.coefficient = -0.1: allowed: a number, 0 to 1"}),
      bad_design("RightAngleForThePressureAngle", replaced(kDesign, "= 20.0", "= 90.0"),
                 {"gear.toml:3:1: pressure_angle_deg = 90", "a number in deg, 5 to 45"}),
      bad_design("NoPlanets", replaced(kDesign, "planets = 3", "planets = 0"),
                 {"gear.toml:2:1: planets = 0: allowed: an integer, 1 to 24"}),
      bad_design("GreatestInteger", replaced(kDesign, "teeth = 12", "teeth = 9223372036854775807"),
                 {"gear.toml:9:7: gears.S.teeth = 9223372036854775807: allowed: an integer, -2000 "
                  "to 2000"}),
      bad_design("IntegerBeyondSixtyFourBits",
                 replaced(kDesign, "teeth = 12", "teeth = 99999999999999999999"),
                 {"gear.toml:9:", "not valid TOML"}),
      bad_design("TwoTeeth", replaced(kDesign, "teeth = 12", "teeth = 2"),
                 {"gear.toml:9:7: gears.S.teeth = 2: allowed: at least 3"}),
      bad_design("MissingGear",
                 replaced(kDesign, "R2 = { teeth = 81, profile_shift = 1.21 }\n", ""),
                 {"gear.toml:8:", "gears.R2.teeth is missing"}),
      bad_design(
          "RingSmallerThanItsPlanet", replaced(kDesign, "teeth = 90", "teeth = 39"),
          {"gear.toml:11:8: gears.R1.teeth: 39 teeth, allowed: more than the 39 of gears.P1"}),
      bad_design(
          "LoadThatCannotBeRated",
          kDesign + "[material]\nname = \"34CrNiMo6 through hardend\"\n"
                    "[strength]\ncycles = 0.5\ns_h_min = 0\n"
                    "[bearings]\nplanet_positions_mm = [5, 5]\n",
          {"gear.toml:4:2: stage1.face_width_mm is missing, required by [strength]",
           "gear.toml:6:2: stage2.face_width_mm is missing, required by [strength]",
           "gear.toml:17:1: material.name = \"34CrNiMo6 through hardend\": allowed: one of the",
           "did you mean \"34CrNiMo6 through hardened\"",
           "gear.toml:18:2: strength.output_torque_nm is missing, required by [strength]",
           "gear.toml:19:1: strength.cycles = 0.5: allowed: a number, 1 to",
           "gear.toml:20:1: strength.s_h_min = 0: allowed: a number, above 0",
           "gear.toml:22:1: bearings.planet_positions_mm = [5, 5]: both bearings are in one "
           "plane"}),
      bad_design(
          "EqualProductsStopTheOutput",
          replaced(replaced(kDesign, "teeth = 39", "teeth = 40"), "teeth = 81", "teeth = 72"),
          {"gear.toml:13:8: ", "zP1 zR2 = zP2 zR1 = 2880"}),
      bad_design("KhkRingWithNegativeTeeth", replaced(kDesign, "teeth = 90", "teeth = -90"),
                 {"gear.toml:11:8: gears.R1.teeth = -90: allowed: at least 3", "khk"}),
      bad_design(
          "IsoRingsWithPositiveTeeth",
          replaced(kDesign, "planets = 3\n", "planets = 3\nsign_convention = \"iso21771\"\n"),
          {"gear.toml:12:8: gears.R1.teeth = 90: allowed: at most -3", "iso21771",
           "gear.toml:14:8: gears.R2.teeth = 81: allowed: at most -3"}),
      bad_design("IsoPlanetWithNegativeTeeth",
                 replaced(replaced(replaced(replaced(kDesign, "planets = 3\n",
                                                     "planets = 3\nsign_convention = "
                                                     "\"iso21771\"\n"),
                                            "teeth = 90, profile_shift = 2.0",
                                            "teeth = -90, profile_shift = -2.0"),
                                   "teeth = 81, profile_shift = 1.21",
                                   "teeth = -81, profile_shift = -1.21"),
                          "teeth = 39", "teeth = -39"),
                 {"gear.toml:11:8: gears.P1.teeth = -39: allowed: at least 3"}),
      bad_design("BothFormsOfTheAllowance",
                 replaced(kDesign, "teeth = 12,",
                          "teeth = 12, machining_allowance = 0.02, normal_thinning_um = 16.0,"),
                 {"gear.toml:9:", "normal_thinning_um", "machining_allowance"}),
      bad_design("ThicknessInTwoWaysIsSaidAtBothLines",
                 replaced(kDesign, "teeth = 12,", "teeth = 12, A_sn_um = [-60.0, -30.0],") +
                     "[tolerances.S]\ntooth_thickness_um = 15.0\n",
                 {"gear.toml:9:", "gear.toml:17:",
                  "gears.S.A_sn_um and tolerances.S.tooth_thickness_um state the same: allowed: "
                  "one of them"}),
      bad_design("RangeOfTemperatureWithoutAnExpansion",
                 kDesign + "[thermal]\ntemperature_c = [-20.0, 60.0]\nS.expansion_1_k = 0.11\n",
                 {"gear.toml:16:", "gear.toml:18:", "thermal.S.expansion_1_k = 0.11",
                  "thermal.P1.expansion_1_k is missing", "thermal.carrier.expansion_1_k"}),
      bad_design("TipBeyondItsPoint", kDesign + "[limits]\ntip_thickness_mm = -1.0\n",
                 {"gear.toml:17:1: limits.tip_thickness_mm = -1.0", "0 to 1000000"}),
      bad_design("UnknownConventionHasADidYouMean",
                 replaced(kDesign, "planets = 3\n", "planets = 3\nsign_convention = \"iso2171\"\n"),
                 {"gear.toml:3:1: sign_convention = \"iso2171\": allowed: \"khk\" or \"iso21771\"; "
                  "did you mean \"iso21771\"?"}),
      bad_design("UnknownLossModelHasADidYouMean", kDesign + "loss_model = \"ohlendorff\"\n",
                 {"gear.toml:16:1: friction.loss_model = \"ohlendorff\"", "\"sliding\"",
                  "did you mean \"ohlendorf\"?"}),
      bad_design("CentreDistanceWithoutARealWorkingAngle",
                 replaced(kDesign, "planets = 3\n", "planets = 3\ncenter_distance_mm = 15.0\n"),
                 {"gear.toml:3:1: ", "S-P1", "15 mm", "allowed: above 19.1697 mm"}),
      bad_design(
          "ShiftThatLeavesNoRootCircle",
          replaced(kDesign, "profile_shift = 0.476", "profile_shift = -5.0"),
          {"gear.toml:9:19: gears.S.profile_shift = -5: leaves no root circle", "allowed: above"}),
      bad_design("TipBelowTheRoot",
                 replaced(kDesign, "teeth = 12,", "teeth = 12, tip_shortening = 2.5,"),
                 {"gear.toml:9:19: gears.S.tip_shortening = 2.5: allowed: a number in modules, 0 "
                  "to 1.5"}),
      bad_design("BoreBeyondTheTeeth",
                 replaced(kDesign, "teeth = 12,", "teeth = 12, bore_mm = 30.0,"),
                 {"gear.toml:9:19: gears.S.bore_mm = 30: allowed: below"}),
      bad_design("OuterDiameterOfAPlanet",
                 replaced(kDesign, "teeth = 39,", "teeth = 39, outer_diameter_mm = 80.0,"),
                 {"gear.toml:10:20: gears.P1.outer_diameter_mm: allowed for R1 and R2 only"}),
      bad_design("OuterDiameterWithinTheTeeth",
                 replaced(kDesign, "teeth = 81,", "teeth = 81, outer_diameter_mm = 60.0,"),
                 {"gear.toml:13:20: gears.R2.outer_diameter_mm = 60: allowed: above"}),
      bad_design("ReversedContactRatioRange", kDesign + "[contact_ratio]\nrange = [2.0, 1.2]\n",
                 {"gear.toml:17:1: contact_ratio.range = [2.0, 1.2]: allowed: [low, high]",
                  "low <= high"}),
      bad_design("CheckSwitchedOnWithoutAThreshold",
                 kDesign + "[limits]\noutput_backlash_max = true\n",
                 {"gear.toml:17:1: limits.output_backlash_max = true", "no default",
                  "backlash.max_output_arcmin"}),
      bad_design("UnknownCheckHasADidYouMean", kDesign + "[limits]\ntip_thicknes = 0.3\n",
                 {"gear.toml:17:1: unknown key limits.tip_thicknes; did you mean "
                  "limits.tip_thickness?"}),
      bad_design(
          "SpecificationForADesign", kSpec,
          {"gear.toml: looks like a SPEC: it has [ratio]; DESIGN takes a file with [gears]"}),
      bad_design(
          "PairForADesign", kPair,
          {"gear.toml: looks like a PAIR: it has [gear1]; DESIGN takes a file with [gears]"}),
      bad_design("AllErrorsAtOnce",
                 replaced(replaced(replaced(replaced(kDesign, "planets = 3", "planets = -1"),
                                            "module_mm = 0.8\n", "module_mm = nan\n"),
                                   "teeth = 90", "teeth = 30"),
                          "coefficient", "coeficient"),
                 {"gear.toml:2:1: planets = -1", "gear.toml:5:1: stage1.module_mm = nan",
                  "gear.toml:11:8: gears.R1.teeth: 30 teeth",
                  "gear.toml:15:1: unknown key friction.coeficient; did you mean "
                  "friction.coefficient?"}),
  };
}

std::vector<BadInput> pair_inputs() {
  return {
      bad_pair("PairWithoutKind", replaced(kPair, "kind = \"internal\"\n", ""),
               {"pair.toml:1:1: kind is missing", "\"external\" or \"internal\""}),
      bad_pair(
          "UnknownKindHasADidYouMean", replaced(kPair, "\"internal\"", "\"intenral\""),
          {"pair.toml:1:1: kind = \"intenral\": allowed: \"external\" or \"internal\"; did you "
           "mean \"internal\"?"}),
      bad_pair("PairRingSmallerThanItsPinion", replaced(kPair, "teeth = 24", "teeth = 16"),
               {"pair.toml:6:1: gear2.teeth: 16 teeth, allowed: more than the 16 of gear1"}),
      bad_pair("PairCentreDistanceWithoutARealWorkingAngle", "center_distance_mm = 2.0\n" + kPair,
               {"pair.toml:1:1: ", "2 mm", "allowed: above 11.2763 mm"}),
      bad_pair("TrainKeyInAPair", "planets = 3\n" + kPair, {"pair.toml:1:1: unknown key planets"}),
      bad_pair("TrainCheckInAPair", kPair + "[limits]\nplanet_gap = 0.5\n",
               {"pair.toml:9:1: unknown key limits.planet_gap"}),
      bad_pair("PairIsoRingWithPositiveTeeth", "sign_convention = \"iso21771\"\n" + kPair,
               {"pair.toml:7:1: gear2.teeth = 24: allowed: at most -3", "iso21771"}),
      bad_pair("DesignForAPair", kDesign,
               {"pair.toml: looks like a DESIGN: it has [gears]; PAIR takes a file with [gear1] "
                "and [gear2]"}),
      bad_pair(
          "PairErrorsAtOnce",
          replaced(replaced(kPair, "module_mm = 3.0", "module_mm = -3.0"), "profile_shift",
                   "profil_shift"),
          {"pair.toml:2:1: module_mm = -3.0: allowed: a number in mm, 0.001 to 100",
           "pair.toml:7:1: unknown key gear2.profil_shift; did you mean gear2.profile_shift?"}),
  };
}

std::vector<BadInput> specification_inputs() {
  const std::string stage2 = "stage2_mm = { min = 0.1, max = 10.0 }";
  return {
      bad_spec("SpecWithoutRatio", replaced(kSpec, "[ratio]\ntarget = 96.2\n", ""),
               {"spec.toml:1:1: ratio.target is missing"}),
      bad_spec("RatioZero", replaced(kSpec, "96.2", "0.0"),
               {"spec.toml:4:1: ratio.target = 0: allowed: any number but 0"}),
      bad_spec("RatioAsText", replaced(kSpec, "96.2", "\"96.2:1\""),
               {"spec.toml:4:1: ratio.target = \"96.2:1\": allowed: a number"}),
      bad_spec("RatioInfinite", replaced(kSpec, "96.2", "inf"),
               {"spec.toml:4:1: ratio.target = inf: allowed: a number"}),
      bad_spec("ToleranceInPercent", replaced(kSpec, "96.2\n", "96.2\ntolerance = 5\n"),
               {"spec.toml:5:1: ratio.tolerance = 5: allowed: a number, 0 to 0.9"}),
      bad_spec("ReversedTeethRange", replaced(kSpec, "[12, 13]", "[20, 10]"),
               {"spec.toml:6:1: teeth.S = [20, 10]: allowed: [low, high]", "low <= high"}),
      bad_spec("OneTeethNumberForARange", replaced(kSpec, "[12, 13]", "12"),
               {"spec.toml:6:1: teeth.S = 12: allowed: [low, high], two integers"}),
      bad_spec("ThreeTeethNumbersForARange", replaced(kSpec, "[12, 13]", "[10, 12, 14]"),
               {"spec.toml:6:1: teeth.S = [10, 12, 14]: allowed: [low, high], two integers"}),
      bad_spec("FractionsInATeethRange", replaced(kSpec, "[12, 13]", "[12.0, 13.0]"),
               {"spec.toml:6:1: teeth.S = ", "two integers"}),
      bad_spec("RingTooSmallForThePlanets", replaced(kSpec, "R1_max = 120", "R1_max = 30"),
               {"spec.toml:8:1: teeth.R1_max = 30: allowed: at least", "58"}),
      bad_spec(
          "ReversedModuleRange", replaced(kSpec, stage2, "stage2_mm = { min = 2.0, max = 1.0 }"),
          {"spec.toml:13:1: module.stage2_mm = { min = 2.0, max = 1.0 }: allowed:", "min <= max"}),
      bad_spec("HalfAModuleRange", replaced(kSpec, stage2, "stage2_mm = { min = 0.5 }"),
               {"spec.toml:13:1: module.stage2_mm = { min = 0.5 }: allowed:", "{ min, max }"}),
      bad_spec("EmptyModuleSeries", replaced(kSpec, stage2, "stage2_mm = { series = [] }"),
               {"spec.toml:13:1: module.stage2_mm = { series = [] }: allowed:", "series"}),
      bad_spec("NegativeModuleInASeries",
               replaced(kSpec, stage2, "stage2_mm = { series = [0.5, -0.6] }"),
               {"spec.toml:13:1: module.stage2_mm = { series = [0.5, -0.6] }: allowed:",
                "0.001 to 100"}),
      bad_spec("ReversedBacklashLimits",
               replaced(kSpec, "[backlash]\n", "[backlash]\nmin_output_arcmin = 9.0\n"),
               {"spec.toml:15:1: backlash.min_output_arcmin = 9: allowed: at most", "8"}),
      bad_spec("NumberForAShiftRange", kSpec + "[profile_shift]\nrange = 0.5\n",
               {"spec.toml:19:1: profile_shift.range = 0.5: allowed: [low, high], two numbers"}),
      bad_spec("NoPlanetNumbers", replaced(kSpec, "planets = 3", "planets = []"),
               {"spec.toml:1:1: planets = []: allowed: an integer or a list of integers"}),
      bad_spec(
          "DesignForASpecification", kDesign,
          {"spec.toml: looks like a DESIGN: it has [gears]; SPEC takes a file with [ratio] and "
           "[teeth]"}),
      bad_spec(
          "SpecErrorsAtOnce",
          replaced(replaced(replaced(kSpec, "[12, 13]", "[13, 12]"), "R2_max", "R2_mx"),
                   "starts = 1", "starts = 0"),
          {"spec.toml:6:1: teeth.S = [13, 12]",
           "spec.toml:10:1: unknown key teeth.R2_mx; did you mean teeth.R2_max?",
           "teeth.R2_max is missing", "spec.toml:17:1: solver.starts = 0: allowed: an integer"}),
      bad_task(
          "DesignForATask", kDesign,
          {"spec.toml: looks like a DESIGN: it has [gears]; SPEC takes a file with [ratio] and "
           "[teeth]"}),
      bad_task("EmptySpec", "",
               {"spec.toml:1:1: ratio.target is missing", "teeth.S is missing",
                "module.stage1_mm is missing"}),
      bad_task("SameObjectiveTwice",
               replaced(kSpec, "\"backward_efficiency\"",
                        "[\"backward_efficiency\", \"backward_efficiency\"]"),
               {"spec.toml:2:1: objective: \"backward_efficiency\" twice"}),
      bad_task("MisspeltObjectiveInAList",
               replaced(kSpec, "\"backward_efficiency\"", "[\"backward_efficiency\", \"masss\"]"),
               {"spec.toml:2:1: objective = ", "did you mean \"mass\"?"}),
      bad_task("EmptyListOfObjectives", replaced(kSpec, "\"backward_efficiency\"", "[]"),
               {"spec.toml:2:1: objective = ", "or a list of these"}),
      bad_task("MassWithoutDensity",
               replaced(kSpec, "\"backward_efficiency\"", "[\"mass\", \"lost_motion\"]"),
               {"spec.toml:2:1: objective \"mass\" without inertia.density_kg_m3"}),
      bad_task("RimsAsLargeAsTheGearbox",
               kSpec + "[size]\nring_rim_mm = 4.0\nmax_outer_diameter_mm = 8.0\n",
               {"size.max_outer_diameter_mm = 8: allowed: above twice ring_rim_mm = 4"}),
      bad_task("LengthOfNothing", kSpec + "[size]\nmax_length_mm = 20.0\n",
               {"size.max_length_mm without [axial] and without stage1.face_width_mm and"}),
      bad_task("FreeTipsTwice",
               kSpec + "[free]\naddendum = [0.8, 1.2]\ntip_shortening = [0.0, 0.2]\n",
               {"free.tip_shortening and free.addendum: allowed: one of them"}),
      bad_task("UnknownObjectiveHasADidYouMean",
               replaced(kSpec, "\"backward_efficiency\"", "\"backwards_efficiency\""),
               {"spec.toml:2:1: objective = \"backwards_efficiency\"",
                "did you mean \"backward_efficiency\"?"}),
      bad_task("UnknownSolverNamesTheKnownOnes", kSpec + "refine = \"newton\"\n",
               {"spec.toml:18:1: solver.refine = \"newton\": allowed: \"slsqp\" or \"ipopt\" or "
                "\"both\""}),
      bad_task("SeedThatIsNoDouble", kSpec + "seed = 9007199254740993\n",
               {"spec.toml:18:1: solver.seed = 9007199254740993: allowed: an integer, 0 to"}),
      bad_task("NegativeSeed", kSpec + "seed = -1\n",
               {"spec.toml:18:1: solver.seed = -1: allowed: an integer, 0 to"}),
      bad_task("AllowanceOfAnUnknownGear",
               replaced(kSpec, "[backlash]\n",
                        "[backlash]\nmachining_allowance = { S = 0.01, P3 = 0.01 }\n"),
               {"spec.toml:15:1: backlash.machining_allowance = { S = 0.01, P3 = 0.01 }: allowed:",
                "S, P1, R1, P2, R2"}),
      bad_task("TipShorteningBeyondTheTooth",
               "tip_shortening = 1.4\n" + kSpec + "[rack]\naddendum = 0.5\ndedendum = 0.5\n",
               {"spec.toml:1:1: tip_shortening", "1.4", "allowed: below", "1"}),
      bad_task(
          "UnknownBacklashModel",
          replaced(kSpec, "[backlash]\n", "[backlash]\nmodel = \"papper\"\n"),
          {"spec.toml:15:1: backlash.model = \"papper\": allowed: \"kinematic\" or \"paper\"; did "
           "you mean \"paper\"?"}),
  };
}

std::vector<BadInput> all_bad_inputs() {
  std::vector<BadInput> all;
  for (const auto& inputs :
       {usage_inputs(), path_inputs(), design_inputs(), pair_inputs(), specification_inputs()}) {
    all.insert(all.end(), inputs.begin(), inputs.end());
  }
  return all;
}

/// Lines of messages about a file: those with a place come in the order of the file.
void expect_ascending_places(const std::string& err) {
  static const std::regex kPlace(R"(^[^:\s]+:(\d+):(\d+): )");
  std::pair<int, int> last{0, 0};
  for (const std::string& line : test::lines_of(err)) {
    std::smatch match;
    if (!std::regex_search(line, match, kPlace)) continue;
    const std::pair<int, int> place{std::stoi(match[1]), std::stoi(match[2])};
    EXPECT_LE(last, place) << line;
    last = place;
  }
}

class BadInputs : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputs, EndsWithItsCodeAndMessageAndLeavesNothing) {
  const BadInput& input = GetParam();
  const Workplace place;
  if (!input.file.empty()) place.write(input.file, input.content);
  const ProgramResult result = place.run(input.arguments);
  EXPECT_EQ(result.signal, 0);
  EXPECT_EQ(result.exit_code, input.exit_code) << result.err;
  EXPECT_EQ(result.out, "");
  for (const std::string& fragment : input.fragments) {
    EXPECT_NE(result.err.find(fragment), std::string::npos)
        << "not said: " << fragment << "\nbut:\n"
        << result.err;
  }
  EXPECT_EQ(result.err.find("terminate"), std::string::npos);
  EXPECT_TRUE(result.err.ends_with('\n'));
  expect_ascending_places(result.err);
  if (input.exit_code == kInvalidInput) {
    // Every line begins with the path that it is about.
    for (const std::string& line : test::lines_of(result.err)) {
      const bool named = std::ranges::any_of(input.arguments, [&](const std::string& argument) {
        return line.starts_with(argument + ":");
      });
      EXPECT_TRUE(named) << line;
    }
  }
  EXPECT_EQ(place.listing(),
            input.file.empty() ? std::vector<std::string>{} : std::vector<std::string>{input.file});
  if (!input.file.empty()) {
    EXPECT_EQ(place.read(input.file), input.content);
  }
}

INSTANTIATE_TEST_SUITE_P(Table, BadInputs, testing::ValuesIn(all_bad_inputs()),
                         [](const auto& param) { return param.param.fact; });

TEST(BadInput, TheFilesThatTheTableBreaksAreSound) {
  const Workplace place;
  place.write("gear.toml", kDesign);
  place.write("pair.toml", kPair);
  place.write("spec.toml", kSpec);
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"analyze", "gear.toml"},
        {"mesh", "pair.toml"},
        {"search", "spec.toml"},
        {"optimize", "spec.toml", "--out", "out"}}) {
    const ProgramResult result = place.run(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments[0] << "\n" << result.err;
    EXPECT_NE(result.out, "");
  }
}

TEST(BadInput, AnUnknownFormatIsRefusedInTheUsersWords) {
  const ProgramResult result = Workplace().run({"reproduce", "--format", "xml"});
  EXPECT_EQ(result.exit_code, kUsage);
  // Numbers that the program uses inside are no choice of the user's.
  for (const char* inside : {"->", "{2", "0}"}) {
    EXPECT_EQ(result.err.find(inside), std::string::npos) << result.err;
  }
}

TEST(BadInput, APartOfTheTableThatIsUnknownHasADidYouMean) {
  const ProgramResult result = Workplace().run({"analyze", "gear.toml", "--show", "meshs"});
  EXPECT_EQ(result.exit_code, kUsage);
  EXPECT_NE(result.err.find("unknown part meshs; did you mean meshes?"), std::string::npos)
      << result.err;
}

TEST(BadInput, GoingOnWithARunAndReplacingItExcludeEachOther) {
  const ProgramResult result =
      Workplace().run({"optimize", "spec.toml", "--out", "out", "--resume", "--force"});
  EXPECT_EQ(result.exit_code, kUsage);
  EXPECT_NE(result.err.find("--resume excludes --force"), std::string::npos) << result.err;
}

TEST(BadInput, ErrorsDoNotTouchTheResultsOfAnEarlierRun) {
  const Workplace place;
  place.write("gear.toml", replaced(kDesign, "teeth = 90", "teeth = 9"));
  place.write("result.json", "earlier");
  const ProgramResult result =
      place.run({"analyze", "gear.toml", "--format", "json", "--out", "result.json"});
  EXPECT_EQ(result.exit_code, kInvalidInput);
  EXPECT_EQ(place.read("result.json"), "earlier");
}

// --- tasks that no design fulfils

struct Infeasible {
  std::string fact;
  std::string content;
  std::vector<std::string> fragments;  ///< of stderr
};

void PrintTo(const Infeasible& task, std::ostream* stream) { *stream << task.fact; }

/// Tasks that the search alone refutes.
std::vector<Infeasible> without_tooth_sets() {
  return {
      {"RatioOutOfReach",
       replaced(kSpec, "96.2", "5.0"),
       {"blocked by ratio", "0.5 % of 5:1", "nearest", "% off"}},
      {"RatioOfTheOtherSenseOfTurning",
       replaced(kSpec, "96.2", "-0.01"),
       {"blocked by ratio", "-0.01:1", "no ring"}},
      {"NoRingForTheOffset",
       replaced(kSpec, "R1_max = 120", "R1_max = 100"),
       {"blocked by ratio", "R1_max"}},
      {"IdenticalPlanetsOnly",
       // The low-backlash prototype, 14/40/94/36/92: its planets fit, but not as one part.
       replaced(replaced(replaced(replaced(kSpec, "96.2\n", "95.907\ntolerance = 0.0001\n"),
                                  "S = [12, 13]", "S = [14, 14]\nmax_coaxial_offset = 0"),
                         "P1 = [50, 60]", "P1 = [40, 40]"),
                "P2 = [40, 60]", "P2 = [36, 36]"),
       {"blocked by identical_planets", "identical_planets = false"}},
      {"NoEqualSpacing",
       replaced(replaced(kSpec, "planets = 3", "planets = 23"), "[12, 13]", "[12, 12]"),
       {"blocked by equal_spacing"}},
      {"InternalDifferenceBeyondEverySet",
       replaced(kSpec, "R2_max = 120\n", "R2_max = 120\nmin_internal_difference = 70\n"),
       {"blocked by min_internal_difference"}},
  };
}

/// Tasks with tooth sets of which none can be refined into a design.
std::vector<Infeasible> without_designs() {
  return {
      {"RingRootDiameterFarTooSmall",
       kSpec + "[size]\nmax_ring_root_diameter_mm = 20.0\n",
       {"blocked by ring_root_diameter", " mm", "nearest"}},
      {"BacklashBelowWhatTheAllowanceAdds",
       replaced(kSpec, "max_output_arcmin = 8.0",
                "max_output_arcmin = 1.0\nmachining_allowance = 0.1\nmin_normal_um = 90.0"),
       {"blocked by ", "backlash", "nearest", "misses "}},
      {"ContactRatioBeyondTheTooth",
       kSpec + "[contact_ratio]\nrange = [4.0, 5.0]\n",
       {"blocked by ", "nearest", "contact_ratio_min by "}},
      {"TipsBroaderThanTheTooth",
       kSpec + "[limits]\ntip_thickness = 1.5\n",
       {"blocked by tip_thickness", "misses ", "module"}},
      // With three planets each of these tooth sets has room.
      {"FivePlanetsInEachOthersWay",
       replaced(replaced(kSpec, "planets = 3", "planets = 5"), "96.2\n",
                "96.2\ntolerance = 0.02\n"),
       {"blocked by planet_gap", "misses ", "module"}},
      {"TwelvePlanetsInEachOthersWay",
       replaced(replaced(kSpec, "planets = 3", "planets = 12"), "96.2\n",
                "96.2\ntolerance = 0.02\n"),
       {"blocked by planet_gap", "misses ", "module"}},
      {"Stage2ModuleBeyondAnyCommonCentreDistance",
       replaced(kSpec, "{ min = 0.1, max = 10.0 }", "5.0"),
       {"blocked by ", "misses "}},
  };
}

class NoToothSet : public testing::TestWithParam<Infeasible> {};

TEST_P(NoToothSet, SearchAndOptimizeNameWhatBlocks) {
  const Infeasible& task = GetParam();
  const Workplace place;
  place.write("spec.toml", task.content);
  const ProgramResult search = place.run({"search", "spec.toml", "--format", "csv", "--quiet"});
  EXPECT_EQ(search.signal, 0);
  EXPECT_EQ(search.exit_code, kNoFeasibleDesign) << search.err;
  EXPECT_EQ(test::lines_of(search.out).size(), 1U) << "a header and no set: " << search.out;
  const ProgramResult optimize = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
  EXPECT_EQ(optimize.signal, 0);
  EXPECT_EQ(optimize.exit_code, kNoFeasibleDesign) << optimize.err;
  EXPECT_EQ(optimize.out, "");
  EXPECT_FALSE(place.has("out/best.toml"));
  for (const ProgramResult* result : {&search, &optimize}) {
    EXPECT_NE(result->err.find("no feasible design"), std::string::npos);
    for (const std::string& fragment : task.fragments) {
      EXPECT_NE(result->err.find(fragment), std::string::npos)
          << "not said: " << fragment << "\nbut:\n"
          << result->err;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, NoToothSet, testing::ValuesIn(without_tooth_sets()),
                         [](const auto& param) { return param.param.fact; });

class NoDesign : public testing::TestWithParam<Infeasible> {};

TEST_P(NoDesign, OptimizeNamesWhatBlocksAndByHowMuch) {
  const Infeasible& task = GetParam();
  const Workplace place;
  place.write("spec.toml", task.content);
  std::filesystem::create_directory(place.file("out"));
  place.write("out/best.toml", "# of an earlier run\n");
  const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
  EXPECT_EQ(result.signal, 0);
  EXPECT_EQ(result.exit_code, kNoFeasibleDesign) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("no feasible design"), std::string::npos);
  for (const std::string& fragment : task.fragments) {
    EXPECT_NE(result.err.find(fragment), std::string::npos)
        << "not said: " << fragment << "\nbut:\n"
        << result.err;
  }
  EXPECT_FALSE(place.has("out/best.toml")) << "the design of an earlier run";
  // What is left says the same: no set is optimal, every one has its reason.
  const auto rows = test::lines_of(place.read("out/refined.csv"));
  ASSERT_GT(rows.size(), 1U);
  for (const std::string& row : rows) EXPECT_EQ(row.find(",optimal,"), std::string::npos) << row;
  const auto summary = nlohmann::json::parse(place.read("out/summary.json"));
  EXPECT_EQ(summary.at("status").at("optimal"), 0);
  EXPECT_TRUE(summary.at("best").is_null());
}

INSTANTIATE_TEST_SUITE_P(Table, NoDesign, testing::ValuesIn(without_designs()),
                         [](const auto& param) { return param.param.fact; });

}  // namespace
}  // namespace gear3k::bad_input_test
