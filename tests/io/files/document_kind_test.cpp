#include "io/files/document_kind.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "io/files/design_file.hpp"
#include "io/files/measurement_file.hpp"
#include "io/files/model_file.hpp"
#include "io/files/selection_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/files/subject_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io::document_kind_test {
namespace {

DocumentKind kind_of(const std::string& text) { return look_of(parse_toml(text, "t.toml")).kind; }

std::string example_path(const std::string& name) {
  return std::string(GEAR3K_SOURCE_DIR) + "/examples/" + name;
}

template <class Read>
std::string error_of(Read read) {
  try {
    read();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(DocumentKind, TheExamplesLookLikeWhatTheyAre) {
  using enum DocumentKind;
  const auto kind = [](const char* name) { return look_of(read_toml(example_path(name))).kind; };
  EXPECT_EQ(kind("designs/bilateral_drive_gear.toml"), kDesign);
  EXPECT_EQ(kind("designs/low_backlash_prototype.toml"), kDesign);
  EXPECT_EQ(kind("designs/ratio_96_with_losses.toml"), kDesign);
  EXPECT_EQ(kind("pair_internal.toml"), kPair);
  EXPECT_EQ(kind("pairs/dry_steel_pair.toml"), kPair);
  EXPECT_EQ(kind("ratio-96.toml"), kSpecification);
  EXPECT_EQ(kind("rp96.toml"), kSpecification);
  EXPECT_EQ(kind("actuators/knee.toml"), kActuator);
  EXPECT_EQ(kind("actuators/knee_selection.toml"), kSelection);
  EXPECT_EQ(kind("actuators/knee_co_design.toml"), kSpecification);
  EXPECT_EQ(kind_of("[control]\nmode = \"open\"\n"), kScenario);
  EXPECT_EQ(kind_of("[gearbox]\nratio = 96\n"), kBlackBox);
  EXPECT_EQ(kind_of("[lost_motion.causes]\n"), kModel);
  EXPECT_EQ(kind_of("name = \"x\"\n"), kUnknown);
  // A SPEC may state materials of gears.
  EXPECT_EQ(kind_of("[gears.S]\nmaterial = \"POM\"\n[ratio]\ntarget = 96\n"), kSpecification);
  EXPECT_EQ(kind_of("[gears.S]\nmaterial = \"POM\"\nteeth = 12\n"), kDesign);
  EXPECT_EQ(kind_of("[gears]\n"), kDesign);
}

TEST(DocumentKind, ADesignInPlaceOfAModelIsToldAloneAndAtOnce) {
  EXPECT_EQ(error_of([] { read_model(example_path("designs/bilateral_drive_gear.toml")); }),
            example_path("designs/bilateral_drive_gear.toml") +
                ": looks like a DESIGN: it has [gears]; --model takes a model.toml of diagnose");
}

TEST(DocumentKind, ASpecInPlaceOfASubjectIsToldAloneAndAtOnce) {
  EXPECT_EQ(error_of([] { read_subject(example_path("rp96.toml")); }),
            example_path("rp96.toml") +
                ": looks like a SPEC: it has [ratio]; SUBJECT takes a DESIGN, a PAIR or a black "
                "box ([gearbox])");
}

TEST(DocumentKind, EveryReaderTellsAnotherKindOfFileAloneAndAtOnce) {
  const std::string design = example_path("designs/loaded.toml");
  const std::string pair = example_path("pair_internal.toml"), spec = example_path("rp96.toml");
  const std::string selection = example_path("actuators/knee_selection.toml");
  EXPECT_EQ(error_of([&] { read_design(pair); }),
            pair + ": looks like a PAIR: it has [gear1]; DESIGN takes a file with [gears]");
  EXPECT_EQ(error_of([&] { read_pair(design); }),
            design +
                ": looks like a DESIGN: it has [gears]; PAIR takes a file with [gear1] and "
                "[gear2]");
  EXPECT_EQ(error_of([&] { read_specification(design, 1e7); }),
            design +
                ": looks like a DESIGN: it has [gears]; SPEC takes a file with [ratio] and "
                "[teeth]");
  EXPECT_EQ(error_of([&] { read_selection(spec); }),
            spec +
                ": looks like a SPEC: it has [ratio]; --select takes a file with motors, "
                "gearboxes and cycles");
  EXPECT_EQ(error_of([&] { read_subject(selection); }),
            selection +
                ": looks like a SPEC of a selection: it has gearboxes; SUBJECT takes a "
                "DESIGN, a PAIR or a black box ([gearbox])");
}

TEST(DocumentKind, AFileWithASignOfWhatIsAllowedIsReadAsThat) {
  const TomlValue both = parse_toml("[motor]\n[gears.S]\nteeth = 12\n", "t.toml");
  EXPECT_EQ(look_of(both).kind, DocumentKind::kActuator);
  EXPECT_EQ(error_of([&] { refuse_other_documents(both, "t.toml", {DocumentKind::kDesign}, ""); }),
            "");
}

TEST(DocumentKind, ADesignInPlaceOfMeasurementsIsToldAloneAndAtOnce) {
  const std::string path = example_path("designs/bilateral_drive_gear.toml");
  EXPECT_EQ(error_of([&] { read_measurements({path}); }),
            path +
                ": looks like a DESIGN: it has [gears]; DATA takes measurements, CSV files with a "
                "note \"# kind: ...\"");
}

}  // namespace
}  // namespace gear3k::io::document_kind_test
