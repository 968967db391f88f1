#include "app/compare.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "io/files/design_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::app::compare_test {
namespace {

CompareRequest::Item item(const std::string& name, const std::string& source) {
  return {.design = io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/" + name),
          .source = source};
}

TEST(Compare, LabelsByNameThenByFileThenByNumber) {
  const auto first = item("bilateral_drive_gear.toml", "a.toml");
  const auto second = item("loaded.toml", "b.toml");
  auto compared = compare({.designs = {first, second}});
  EXPECT_EQ(compared[0].label, "bilateral drive gear");
  EXPECT_EQ(compared[1].label, "ratio-96 loaded");
  compared = compare({.designs = {first, item("bilateral_drive_gear.toml", "c.toml"), second}});
  EXPECT_EQ(compared[1].label, "c.toml");
  EXPECT_EQ(compared[2].label, "b.toml");
  compared = compare({.designs = {first, first}});
  EXPECT_NE(compared[0].label, compared[1].label);
  EXPECT_EQ(compared[0].file, "a.toml");
}

TEST(Compare, RefusesOneDesignAndSaysWhatIsNotDefinedOfAll) {
  EXPECT_THROW(compare({.designs = {item("loaded.toml", "a.toml")}}), std::invalid_argument);
  auto far = item("bilateral_drive_gear.toml", "far.toml");
  far.design.train.center_distance_m *= 0.5;
  far.design.center_distance_given = true;
  auto near = far;
  near.source = "near.toml";
  try {
    compare({.designs = {far, near}});
    FAIL() << "no exception";
  } catch (const io::InvalidInput& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("far.toml: "), std::string::npos) << text;
    EXPECT_NE(text.find("\nnear.toml: "), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace gear3k::app::compare_test
