// The assembly drawing, read back from its files, against the design's own numbers.

#include "drawing/section_drawing.hpp"

#include <dl_creationadapter.h>
#include <dl_dxf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <regex>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "design/evaluation.hpp"
#include "drawing/dxf_file.hpp"
#include "drawing/planet_marks.hpp"
#include "io/files/design_file.hpp"
#include "io/text/utf8.hpp"

namespace gear3k::drawing::section_drawing_test {
namespace {

// 12/64/141/52/132 with everything that the drawing can tell.
constexpr const char* kDesign = R"(
name = "section"
planets = 3
center_distance_mm = 20.3
[rack]
addendum = 1.0
[stage1]
module_mm = 0.52
face_width_mm = 8.0
[stage2]
module_mm = 0.5
face_width_mm = 6.0
[gears.S]
teeth = 12
profile_shift = 0.3
[gears.P1]
teeth = 64
profile_shift = 0.4
[gears.R1]
teeth = 141
profile_shift = 0.9
outer_diameter_mm = 84.0
[gears.P2]
teeth = 52
profile_shift = 0.3
[gears.R2]
teeth = 132
profile_shift = 0.9
outer_diameter_mm = 78.0
)";
constexpr const char* kAxial = R"(
[axial]
S_mm = [1.0, 9.0]
P1_mm = [0.0, 8.5]
R1_mm = [0.5, 8.5]
P2_mm = [9.0, 15.5]
R2_mm = [9.5, 15.5]
)";

struct Drawn {
  design::Design design;
  design::Evaluation evaluation;
  SectionDrawing section;
};
Drawn drawn(const std::string& text) {
  design::Design design = io::parse_design(text, "gear.toml");
  const auto evaluation = std::get<design::Evaluation>(design::evaluate(design));
  SectionDrawing section = make_section(design, evaluation, {"a note of the drawings"});
  return {.design = std::move(design), .evaluation = evaluation, .section = std::move(section)};
}

/// Dimensions [mm] by name, as the text of an SVG has them.
std::map<std::string, double> dimensions_in(const std::string& svg) {
  std::map<std::string, double> found;
  const std::regex group("data-name=\"([^\"]*)\" data-value=\"([^\"]*)\"");
  for (std::sregex_iterator at(svg.begin(), svg.end(), group), end; at != end; ++at) {
    found[(*at)[1]] = std::stod((*at)[2]);
  }
  return found;
}

std::map<std::string, double> expected_diameters(const design::Evaluation& e) {
  std::map<std::string, double> expected;
  for (const design::GearResult& gear : e.gears) {
    expected[gear.name + " tip diameter"] = 1e3 * gear.tip_diameter_m;
    if (gear.name[0] == 'R') expected[gear.name + " root diameter"] = 1e3 * gear.root_diameter_m;
  }
  expected["centre distance"] = 20.3;
  return expected;
}

bool any_note(const SectionDrawing& section, const std::string& part) {
  return std::ranges::any_of(
      section.notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

TEST(SectionDrawing, SvgTellsEveryDimensionOfTheDesign) {
  const Drawn d = drawn(std::string(kDesign) + kAxial);
  std::map<std::string, double> expected = expected_diameters(d.evaluation);
  expected.insert({{"R1 outer diameter", 84.0},
                   {"R2 outer diameter", 78.0},
                   {"S face width", 8.0},
                   {"P1 face width", 8.5},
                   {"R1 face width", 8.0},
                   {"P2 face width", 6.5},
                   {"R2 face width", 6.0},
                   {"length", 15.5}});
  const auto found = dimensions_in(svg_text(d.section));
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [name, value] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_NEAR(found.at(name), value, 1e-6) << name;
  }
  EXPECT_TRUE(any_note(d.section, "P2 9.000 to 15.500"));
  EXPECT_TRUE(any_note(d.section, "a note of the drawings"));
}

/// Lines of the group of a dimension in an SVG: its own, to what is measured, and ticks.
long lines_of(const std::string& svg, const std::string& name) {
  const std::regex group("<g class=\"dimension\" data-name=\"" + name + "\"([\\s\\S]*?)</g>");
  const std::regex line("d=\"M[^\"]*L[^\"]*\"");
  std::smatch found;
  if (!std::regex_search(svg, found, group)) return 0;
  const std::string part = found[1];
  return std::distance(std::sregex_iterator(part.begin(), part.end(), line), {});
}

TEST(SectionDrawing, DiametersOfTheHalfSectionEndBeyondTheAxisWithoutATick) {
  const Drawn d = drawn(std::string(kDesign) + kAxial);
  const std::string svg = svg_text(d.section);
  int halves = 0;
  for (const Dimension& dimension : d.section.dimensions) {
    EXPECT_EQ(dimension.half, dimension.from.y_m < 0.0) << dimension.name;
    EXPECT_EQ(lines_of(svg, dimension.name), dimension.half ? 3 : 5) << dimension.name;
    if (!dimension.half) continue;
    ++halves;
    EXPECT_NEAR(dimension.to.y_m, 0.5 * dimension.value_m, 1e-12) << dimension.name;
    EXPECT_GT(dimension.from.y_m, -d.section.text_height_m) << dimension.name;
  }
  EXPECT_EQ(halves, 7) << "the sun's tip; tip, root and outer diameter of each ring";
}

TEST(SectionDrawing, NoTextBesideAColumnCrossesItsEnds) {
  const Drawn d = drawn(std::string(kDesign) + kAxial);
  const std::string svg = svg_text(d.section);
  const std::regex group(R"-(<g class="dimension"[^>]*>([\s\S]*?)</g>)-");
  const std::regex line(R"-(d="M[-0-9.]+ ([-0-9.]+)L[-0-9.]+ ([-0-9.]+)")-");
  const std::regex turned(R"-(rotate\(-90 [-0-9.]+ ([-0-9.]+)\)[^>]*>([^<]*)<)-");
  const double height = 1e3 * d.section.text_height_m;
  int texts = 0;
  for (std::sregex_iterator at(svg.begin(), svg.end(), group), end; at != end; ++at) {
    const std::string part = (*at)[1];
    std::smatch text;
    if (!std::regex_search(part, text, turned)) continue;
    ++texts;
    // The first line is the dimension's; a letter is some half of its height wide.
    const auto strokes = std::sregex_iterator(part.begin(), part.end(), line);
    const double one = std::stod((*strokes)[1]), other = std::stod((*strokes)[2]);
    const double y = std::stod(text[1]);
    const double half = 0.25 * height * static_cast<double>(io::characters_in(text[2].str()));
    for (const double end_y : {one, other}) {
      EXPECT_GT(std::abs(end_y - y), half)
          << text[2] << " at " << y << " of " << one << ", " << other;
    }
  }
  EXPECT_GT(texts, 5);
}

// Short widths of a large gearbox: "R1 8.000R2 6.000" would run together.
TEST(SectionDrawing, NoTwoTextsOfARowRunTogether) {
  for (const double narrow : {1.0, 0.3, 0.1}) {
    std::string axial = "[axial]\n";
    for (const auto& [name, from, to] :
         {std::tuple("S", 1.0, 9.0), std::tuple("P1", 0.0, 8.5), std::tuple("R1", 0.5, 8.5),
          std::tuple("P2", 9.0, 15.5), std::tuple("R2", 9.5, 15.5)}) {
      axial += std::string(name) + "_mm = [" + std::to_string(narrow * from) + ", " +
               std::to_string(narrow * to) + "]\n";
    }
    const SectionDrawing section = drawn(std::string(kDesign) + axial).section;
    int pairs = 0;
    for (const Dimension& a : section.dimensions) {
      for (const Dimension& b : section.dimensions) {
        if (&a == &b || !a.along_axis || !b.along_axis || a.line_m != b.line_m) continue;
        const double apart = std::abs(a.from.x_m + a.to.x_m - b.from.x_m - b.to.x_m) / 2.0;
        const auto letters = static_cast<double>(a.text.size() + b.text.size());
        EXPECT_GT(apart, 0.25 * letters * section.text_height_m) << a.text << b.text << narrow;
        ++pairs;
      }
    }
    if (narrow < 0.5) {
      EXPECT_EQ(pairs, 0);
    }
    // Each stands within the page.
    for (const Dimension& d : section.dimensions) {
      if (!d.along_axis) continue;
      EXPECT_GT(d.line_m, section.low.y_m);
      EXPECT_LT(d.line_m, section.high.y_m);
    }
  }
  const std::string wide =
      "[axial]\nS_mm = [1.0, 59.0]\nP1_mm = [0.0, 58.0]\nR1_mm = [0.5, "
      "58.0]\nP2_mm = [60.0, 120.0]\nR2_mm = [60.5, 120.0]\n";
  const SectionDrawing section = drawn(std::string(kDesign) + wide).section;
  const auto line_of = [&](const char* name) {
    return std::ranges::find(section.dimensions, name, &Dimension::name)->line_m;
  };
  EXPECT_EQ(line_of("R1 face width"), line_of("R2 face width"));
  EXPECT_EQ(line_of("P1 face width"), line_of("P2 face width"));
}

TEST(SectionDrawing, SvgIsBalancedAndItsBodiesLieWhereTheAxialTableSays) {
  const Drawn d = drawn(std::string(kDesign) + kAxial);
  const std::string svg = svg_text(d.section);
  // Every element is closed.
  const std::regex tag("<(/?)([a-z]+)([^>]*?)(/?)>");
  std::vector<std::string> open;
  for (std::sregex_iterator at(svg.begin(), svg.end(), tag), end; at != end; ++at) {
    if ((*at)[1] == "/") {
      ASSERT_FALSE(open.empty());
      EXPECT_EQ(open.back(), (*at)[2]);
      open.pop_back();
    } else if ((*at)[4] != "/") {
      open.push_back((*at)[2]);
    }
  }
  EXPECT_TRUE(open.empty());
  std::map<std::string, double> left, width, height;
  const std::regex rect(
      "<rect id=\"([^\"]*)\" x=\"([^\"]*)\" y=\"[^\"]*\" width=\"([^\"]*)\" height=\"([^\"]*)\"");
  for (std::sregex_iterator at(svg.begin(), svg.end(), rect), end; at != end; ++at) {
    left[(*at)[1]] = std::stod((*at)[2]);
    width[(*at)[1]] = std::stod((*at)[3]);
    height[(*at)[1]] = std::stod((*at)[4]);
  }
  EXPECT_NEAR(left["R2"] - left["P1"], 9.5, 2e-6);
  EXPECT_NEAR(left["S"] - left["P1"], 1.0, 2e-6);
  EXPECT_NEAR(width["P2"], 6.5, 1e-6);
  const auto& gears = d.evaluation.gears;
  EXPECT_NEAR(height["P1"], 1e3 * gears[train::kP1].tip_diameter_m, 1e-6);
  EXPECT_NEAR(height["R1"], 0.5 * (84.0 - 1e3 * gears[train::kR1].tip_diameter_m), 1e-6);
}

struct SectionReader : public DL_CreationAdapter {
  void addLayer(const DL_LayerData& layer) override { layers.push_back(layer.name); }
  void addPolyline(const DL_PolylineData& line) override {
    EXPECT_EQ(line.flags & 1, 1);
    bodies[getAttributes().getLayer()] = {};
    last = getAttributes().getLayer();
  }
  void addVertex(const DL_VertexData& v) override { bodies[last].push_back({v.x, v.y}); }
  void addText(const DL_TextData& text) override {
    texts.emplace_back(getAttributes().getLayer(), text.text);
  }
  void addLine(const DL_LineData& line) override {
    if (getAttributes().getLayer() == kDimensionLayer) {
      lengths.push_back(std::hypot(line.x2 - line.x1, line.y2 - line.y1));
    }
  }
  std::string last;
  std::vector<std::string> layers;
  std::map<std::string, std::vector<std::array<double, 2>>> bodies;
  std::vector<std::pair<std::string, std::string>> texts;
  std::vector<double> lengths;
};

TEST(SectionDrawing, DxfIsAsciiWithEscapesOfItsRelease) {
  std::string design = std::string(kDesign) + kAxial;
  const std::string name = "\"section\"";
  design.replace(design.find(name), name.size(), "\"Prüf ⚙ 𝛼 50%%d 5% a^b \\\\U+0041\"");
  const std::string text = dxf_text(drawn(design).section);
  EXPECT_TRUE(
      std::ranges::all_of(text, [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); }));
  // UTF-16 of each: U+00FC, U+2699, and U+1D6FC as a pair of surrogates.
  EXPECT_NE(text.find("Pr\\U+00FCf \\U+2699 \\U+D835\\U+DEFC 50%%%%%%d 5% a\\U+005Eb "
                      "\\U+005CU+0041"),
            std::string::npos);
}

TEST(SectionDrawing, DxfReadsBackWithBodiesDimensionsAndNotes) {
  const Drawn d = drawn(std::string(kDesign) + kAxial);
  std::istringstream stream(dxf_text(d.section));
  SectionReader reader;
  DL_Dxf dxf;
  ASSERT_TRUE(dxf.in(stream, &reader));
  ASSERT_EQ(reader.bodies.size(), 5U);
  const auto& ring = reader.bodies.at("R1");
  ASSERT_EQ(ring.size(), 4U);
  EXPECT_NEAR(ring[0][0], 0.5, 1e-9);
  EXPECT_NEAR(ring[2][0], 8.5, 1e-9);
  EXPECT_NEAR(ring[0][1], 500.0 * d.evaluation.gears[train::kR1].tip_diameter_m, 1e-9);
  EXPECT_NEAR(ring[2][1], 42.0, 1e-9);
  for (const char* layer :
       {"S", "P1", "R1", "P2", "R2", kDimensionLayer, kNotesLayer, kConstructionLayer}) {
    EXPECT_NE(std::ranges::find(reader.layers, layer), reader.layers.end()) << layer;
  }
  const auto has_text = [&](const char* layer, const std::string& part) {
    return std::ranges::any_of(reader.texts, [&](const auto& text) {
      return text.first == layer && text.second.find(part) != std::string::npos;
    });
  };
  EXPECT_TRUE(has_text(kDimensionLayer, "a 20.3000"));
  EXPECT_TRUE(has_text(kDimensionLayer, "R1 outer %%c84.000"));
  EXPECT_TRUE(has_text(kDimensionLayer, "P2 6.500"));
  EXPECT_TRUE(has_text(kNotesLayer, "planet 3: direction 240.0000 deg"));
  // A line as long as each thing that is measured; of diameters about the sun's axis, half of it
  // and what is drawn beyond the axis.
  const auto half = std::ranges::find_if(d.section.dimensions, &Dimension::half);
  ASSERT_NE(half, d.section.dimensions.end());
  const double beyond = -1e3 * half->from.y_m;
  for (const double length : {20.3, 42.0 + beyond, 39.0 + beyond, 8.5, 6.5, 15.5,
                              1e3 * d.evaluation.gears[train::kP1].tip_diameter_m}) {
    EXPECT_TRUE(std::ranges::any_of(reader.lengths, [&](double own) {
      return std::abs(own - length) < 1e-8;
    })) << length;
  }
}

TEST(PlanetMarks, FromTheAxisAreTheDirectionsWithoutThatOfTheAxis) {
  for (const auto& [z, planets] :
       {std::pair{train::ToothSet{.S = 18, .P1 = 43, .R1 = 105, .P2 = 39, .R2 = 87}, 3},
        std::pair{train::ToothSet{.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81}, 3},
        std::pair{train::ToothSet{.S = 14, .P1 = 40, .R1 = 94, .P2 = 36, .R2 = 92}, 3},
        std::pair{train::ToothSet{.S = 13, .P1 = 44, .R1 = 102, .P2 = 28, .R2 = 72}, 5}}) {
    const auto marks = planet_marks(z, planets);
    ASSERT_EQ(marks.size(), static_cast<std::size_t>(planets)) << z.S;
    const double turn = 2.0 * std::numbers::pi;
    for (std::size_t i = 0; i < marks.size(); ++i) {
      const double from_axis = marks[i].p1_from_axis_rad;
      const double axis = turn * static_cast<double>(i) / planets;
      EXPECT_NEAR(std::remainder(marks[i].p1_rad - axis - from_axis, turn), 0.0, 1e-12) << z.S;
      EXPECT_LE(std::abs(from_axis), 0.5 * turn) << z.S;
      EXPECT_FALSE(from_axis == 0.0 && std::signbit(from_axis)) << z.S << " prints as -0";
    }
  }
}

TEST(SectionDrawing, SaysWhatIsNotStatedAndTellsNoDimensionOfIt) {
  const Drawn side = drawn(kDesign);
  EXPECT_TRUE(any_note(side.section, "side by side"));
  EXPECT_NEAR(dimensions_in(svg_text(side.section)).at("length"), 14.0, 1e-6);
  std::string bare = kDesign;
  for (const char* line : {"face_width_mm = 8.0\n", "face_width_mm = 6.0\n",
                           "outer_diameter_mm = 84.0\n", "outer_diameter_mm = 78.0\n"}) {
    bare.erase(bare.find(line), std::string(line).size());
  }
  const Drawn d = drawn(bare);
  EXPECT_TRUE(any_note(d.section, "face widths are not stated"));
  EXPECT_TRUE(any_note(d.section, "the outer diameter of R1 is not stated"));
  const auto found = dimensions_in(svg_text(d.section));
  const auto expected = expected_diameters(d.evaluation);
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [name, value] : expected) EXPECT_NEAR(found.at(name), value, 1e-6) << name;
}

TEST(SectionDrawing, GearsWithoutAPlaceLieInTheirStage) {
  // Gaps between the steps of the planet count: 9.5 + 6.5 = 16 mm, not 8 + 6.
  const Drawn planet = drawn(std::string(kDesign) +
                             "[axial]\nP1_mm = [0.0, 9.0]\n"
                             "P2_mm = [9.5, 16.0]\n");
  EXPECT_TRUE(any_note(planet.section, "for S, R1, R2: drawn in the middle of their stage"));
  EXPECT_TRUE(any_note(planet.section, "R1 0.500 to 8.500, R2 9.750 to 15.750, S 0.500 to 8.500"));
  EXPECT_NEAR(dimensions_in(svg_text(planet.section)).at("length"), 16.0, 1e-6);
  // A stage without any lies beside the other.
  const Drawn second = drawn(std::string(kDesign) + "[axial]\nR2_mm = [20.0, 26.0]\n");
  EXPECT_TRUE(any_note(second.section, "P1 12.000 to 20.000, P2 20.000 to 26.000"));
  const Drawn first = drawn(std::string(kDesign) + "[axial]\nS_mm = [20.0, 28.0]\n");
  EXPECT_TRUE(any_note(first.section, "P1 20.000 to 28.000, P2 28.000 to 34.000"));
}

TEST(SectionDrawing, TellsPastWhichGearsSunAndRingsGo) {
  const Drawn d = drawn(kDesign);
  const auto tip = [&](std::size_t gear) {
    return 500.0 * d.evaluation.gears[gear].tip_diameter_m;
  };
  const double sun = 20.3 - tip(train::kP2) - tip(train::kS);
  const double ring2 = 20.3 + tip(train::kP1) - tip(train::kR2);
  ASSERT_GT(sun, 0.0);
  ASSERT_GT(ring2, 0.0);
  const auto text = [](double value) {
    std::ostringstream out;
    out.precision(3);
    out << std::fixed << value;
    return out.str();
  };
  EXPECT_TRUE(any_note(d.section,
                       "S goes in along the axis from P1's side; from P2's, it passes P2 "
                       "by " +
                           text(sun)));
  EXPECT_TRUE(any_note(d.section, "P1 is in its way by " + text(ring2)));
}

}  // namespace
}  // namespace gear3k::drawing::section_drawing_test
