// Drawings against geometry that shares no formula with their placing: polygons that may not
// overlap, files read back by other code.

#include "drawing/drawing.hpp"

#include <dl_creationadapter.h>
#include <dl_dxf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "drawing/dxf_drawing.hpp"
#include "drawing/svg_drawing.hpp"
#include "geometry/tooth_form.hpp"
#include "io/files/design_file.hpp"
#include "tests/random_train.hpp"

namespace gear3k::drawing::drawing_test {
namespace {

using geometry::Point;
using train::GearId, train::kP1, train::kP2, train::kR1, train::kR2, train::kS;

constexpr double kChordError = 0.25e-6;
/// Coordinates of some 0.1 m after a handful of operations.
constexpr double kRounding = 1e-15;

// --- polygons

bool inside(const std::vector<Point>& polygon, const Point& p) {
  bool odd = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point& a = polygon[k];
    const Point& b = polygon[(k + 1) % polygon.size()];
    if ((a.y_m > p.y_m) == (b.y_m > p.y_m)) continue;
    odd ^= p.x_m < a.x_m + (p.y_m - a.y_m) / (b.y_m - a.y_m) * (b.x_m - a.x_m);
  }
  return odd;
}

double distance_to(const std::vector<Point>& polygon, const Point& p) {
  double least = 1e9;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point& a = polygon[k];
    const Point& b = polygon[(k + 1) % polygon.size()];
    const double dx = b.x_m - a.x_m;
    const double dy = b.y_m - a.y_m;
    const double length2 = dx * dx + dy * dy;
    const double along =
        length2 > 0.0 ? ((p.x_m - a.x_m) * dx + (p.y_m - a.y_m) * dy) / length2 : 0.0;
    const double t = std::clamp(along, 0.0, 1.0);
    least = std::min(least, std::hypot(p.x_m - a.x_m - t * dx, p.y_m - a.y_m - t * dy));
  }
  return least;
}

double area(const std::vector<Point>& polygon) {
  double twice = 0.0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point& a = polygon[k];
    const Point& b = polygon[(k + 1) % polygon.size()];
    twice += a.x_m * b.y_m - b.x_m * a.y_m;
  }
  return 0.5 * twice;
}

double radius(const Point& p) { return std::hypot(p.x_m, p.y_m); }

/// Form radius of every gear, where involute flank and root fillet meet.
using FormRadii = std::array<double, train::kGearCount>;

/// How deep the vertices of the planet and of the central gear lie in the other's material [m].
struct Overlap {
  double flank_m = 0.0;   ///< at radii where the other has its involute flank
  double fillet_m = 0.0;  ///< at radii where it has its root fillet
};

/// A planet's contour in the place of `planet_gear`, against a central gear.
Overlap overlap(const std::vector<Point>& planet, const DrawnGear& planet_gear,
                const DrawnGear& central_gear, const FormRadii& form_m) {
  const bool ring = central_gear.id == kR1 || central_gear.id == kR2;
  const std::vector<Point>& central = central_gear.contour;
  const Point& axis = planet_gear.center;
  Overlap depth;
  const auto count = [&depth](double distance, bool fillet) {
    double& deepest = fillet ? depth.fillet_m : depth.flank_m;
    deepest = std::max(deepest, distance);
  };
  for (const Point& p : planet) {
    const bool near = ring ? radius(p) > central_gear.tip_radius_m - 1e-6
                           : radius(p) < central_gear.tip_radius_m + 1e-6;
    if (!near || inside(central, p) == ring) continue;
    const double form = form_m[central_gear.id];
    count(distance_to(central, p), ring ? radius(p) > form : radius(p) < form);
  }
  for (const Point& p : central) {
    const double from_axis = std::hypot(p.x_m - axis.x_m, p.y_m - axis.y_m);
    if (from_axis > planet_gear.tip_radius_m + 1e-6 || !inside(planet, p)) continue;
    count(distance_to(planet, p), from_axis < form_m[planet_gear.id]);
  }
  return depth;
}

// --- designs

struct Case {
  std::string name;
  design::Design design;
};

void PrintTo(const Case& c, std::ostream* stream) { *stream << c.name; }

Case example_case(const std::string& name) {
  return {name,
          io::read_design(std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/" + name + ".toml")};
}

/// Standard gears without shift at their common reference distance; only q opens backlash.  The
/// rings' teeth are shortened so far that their tips leave the planets' fillets alone.
Case standard_case(const std::string& name, const train::ToothSet& z, int planets) {
  Case c{name, {}};
  c.design.name = name;
  train::TrainParameters<double>& p = c.design.train;
  p.teeth = z;
  p.planets = planets;
  p.pressure_angle_rad = 20.0 * std::numbers::pi / 180.0;
  p.module_m[0] = 1e-3;
  p.center_distance_m = 0.5 * p.module_m[0] * (z.R1 - z.P1);
  p.module_m[1] = 2.0 * p.center_distance_m / (z.R2 - z.P2);
  p.machining_allowance.fill(0.05);
  p.tip_shortening[kR1] = p.tip_shortening[kR2] = 0.15;
  c.design.center_distance_given = true;
  return c;
}

std::vector<Case> cases() {
  return {example_case("bilateral_drive_gear"),
          example_case("low_backlash_prototype"),
          standard_case("G2Above1FourIdenticalPlanets",
                        {.S = 20, .P1 = 30, .R1 = 80, .P2 = 34, .R2 = 84}, 4),
          standard_case("FourPhasedPlanets", {.S = 20, .P1 = 30, .R1 = 80, .P2 = 28, .R2 = 78}, 4),
          standard_case("G2Above1ThreePhasedPlanets",
                        {.S = 21, .P1 = 33, .R1 = 87, .P2 = 35, .R2 = 90}, 3),
          standard_case("OnePlanet", {.S = 18, .P1 = 31, .R1 = 80, .P2 = 29, .R2 = 77}, 1)};
}

design::Evaluation evaluated(const design::Design& design) {
  return std::get<design::Evaluation>(design::evaluate(design));
}

DrawingSet drawn(const design::Design& design, double chord_error_m = kChordError) {
  return make_drawings(design, evaluated(design), chord_error_m);
}

const Drawing& drawing(const DrawingSet& set, const std::string& name) {
  for (const Drawing& d : set.drawings) {
    if (d.name == name) return d;
  }
  throw std::invalid_argument("no drawing " + name);
}

const DrawnGear& gear(const Drawing& drawing, GearId id) {
  for (const DrawnGear& g : drawing.gears) {
    if (g.id == id) return g;
  }
  throw std::invalid_argument("no such gear");
}

// --- placing

TEST(Placement, PlanetsAreTurnedByTheirPhases) {
  RandomTrain random(20);
  int seen = 0;
  while (seen < 2000) {
    const train::ToothSet z = random.teeth(random.count(0, 1) == 0);
    const int planets = random.count(1, 6);
    const train::Assembly assembly = train::assembly(z, planets);
    if (!assembly.equal_spacing) continue;
    ++seen;
    const TrainPlacement placement = place_train(z, planets);
    ASSERT_EQ(placement.planets.size(), static_cast<std::size_t>(planets));
    const double period =
        2.0 * std::numbers::pi / static_cast<double>(train::hunting_period_teeth(z.P1, z.P2));
    for (std::size_t i = 0; i < placement.planets.size(); ++i) {
      const auto& planet = placement.planets[i];
      const double off = planet.p2_rad - planet.p1_rad - assembly.planet_phase_rad[i];
      // Angles are below one tooth: a few units in the last place of it.
      EXPECT_NEAR(std::remainder(off, period), 0.0, 1e-15) << planets;
      EXPECT_NEAR(planet.carrier_rad, 2.0 * std::numbers::pi * static_cast<double>(i) / planets,
                  1e-15);
    }
  }
}

class DrawnTrain : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    evaluation_ = evaluated(GetParam().design);
    set_ = make_drawings(GetParam().design, evaluation_, kChordError);
  }
  [[nodiscard]] const Drawing& train() const { return drawing(set_, "train"); }

  struct Mesh {
    const DrawnGear* planet;
    const DrawnGear* central;
    double normal_backlash_m;
  };
  /// Every planet with the sun, with R1 and with R2.
  [[nodiscard]] std::vector<Mesh> meshes() const {
    std::vector<Mesh> list;
    for (const DrawnGear& g : train().gears) {
      if (g.id == kP1) {
        list.push_back({&g, &gear(train(), kS), evaluation_.meshes[0].normal_backlash_m});
        list.push_back({&g, &gear(train(), kR1), evaluation_.meshes[1].normal_backlash_m});
      } else if (g.id == kP2) {
        list.push_back({&g, &gear(train(), kR2), evaluation_.meshes[2].normal_backlash_m});
      }
    }
    return list;
  }

  [[nodiscard]] FormRadii form_radii() const {
    const auto gears = train::make_train_gears(GetParam().design.train);
    FormRadii form_m{};
    for (const GearId id : {kS, kP1, kR1, kP2, kR2}) {
      form_m[id] = geometry::make_tooth_form(gears[id]).form_radius_m;
    }
    return form_m;
  }

  design::Evaluation evaluation_;
  DrawingSet set_;
};

TEST_P(DrawnTrain, HasEveryPlanetOnTheCarriersCircle) {
  const int planets = GetParam().design.train.planets;
  EXPECT_EQ(train().gears.size(), static_cast<std::size_t>(3 + 2 * planets));
  EXPECT_EQ(meshes().size(), static_cast<std::size_t>(3 * planets));
  for (const DrawnGear& g : train().gears) {
    const bool central = g.id == kS || g.id == kR1 || g.id == kR2;
    EXPECT_NEAR(radius(g.center), central ? 0.0 : evaluation_.center_distance_m, kRounding);
    if (central) continue;
    const double angle = 2.0 * std::numbers::pi * (g.planet - 1) / planets;
    EXPECT_NEAR(
        std::remainder(std::atan2(g.center.y_m, g.center.x_m) - angle, 2.0 * std::numbers::pi), 0.0,
        1e-14)
        << g.name;
  }
}

// Where the design itself leaves negative backlash, centred flanks share it.
TEST_P(DrawnTrain, ContoursDoNotOverlap) {
  for (const Mesh& mesh : meshes()) {
    const double shared = std::max(0.0, -0.5 * mesh.normal_backlash_m);
    const Overlap depth = overlap(mesh.planet->contour, *mesh.planet, *mesh.central, form_radii());
    EXPECT_LE(depth.flank_m, shared + 2.0 * kChordError)
        << mesh.planet->name << " with " << mesh.central->name;
    // The published teeth of R2, at full height, reach into P2's fillets.
    const bool known = GetParam().name == "low_backlash_prototype" && mesh.central->id == kR2;
    EXPECT_LE(depth.fillet_m, known ? 5e-6 : 2.0 * kChordError)
        << mesh.planet->name << " with " << mesh.central->name;
  }
}

// A planet turned about its own axis moves its flanks along the lines of action by rb times the
// angle: half of the backlash is free either way, and no more.
TEST_P(DrawnTrain, BacklashIsCentredInEveryMesh) {
  for (const Mesh& mesh : meshes()) {
    const double half = 0.5 * mesh.normal_backlash_m;
    if (half < 20.0 * kChordError) continue;  // nothing to centre
    for (const double sense : {1.0, -1.0}) {
      const auto depth_after = [&](double travel_m) {
        const double angle = sense * travel_m / mesh.planet->base_radius_m;
        const Point& c = mesh.planet->center;
        std::vector<Point> turned =
            geometry::placed(mesh.planet->contour, 0.0, {.x_m = -c.x_m, .y_m = -c.y_m});
        turned = geometry::placed(turned, angle, c);
        return overlap(turned, *mesh.planet, *mesh.central, form_radii()).flank_m;
      };
      EXPECT_LE(depth_after(half - 3.0 * kChordError), 2.0 * kChordError)
          << mesh.planet->name << " with " << mesh.central->name;
      EXPECT_GE(depth_after(half + 10.0 * kChordError), 5.0 * kChordError)
          << mesh.planet->name << " with " << mesh.central->name;
    }
  }
}

TEST_P(DrawnTrain, TeethReachIntoTheSpacesOfTheirMates) {
  for (const Mesh& mesh : meshes()) {
    const bool ring = mesh.central->id != kS;
    const double depth = 0.8 * mesh.central->module_m;
    const auto reaches = [&](const Point& p) {
      return ring ? radius(p) > mesh.central->tip_radius_m + depth
                  : radius(p) < mesh.central->tip_radius_m - depth;
    };
    EXPECT_TRUE(std::ranges::any_of(mesh.planet->contour, reaches))
        << mesh.planet->name << " with " << mesh.central->name;
  }
}

TEST_P(DrawnTrain, GearsAloneHaveToothZeroOnTheXAxisAndLieBetweenTipAndRoot) {
  for (const GearId id : {kS, kP1, kR1, kP2, kR2}) {
    const Drawing& alone = drawing(set_, std::string(train::kGearNames[id]));
    ASSERT_EQ(alone.gears.size(), 1U);
    const DrawnGear& g = alone.gears.front();
    EXPECT_EQ(g.name, train::kGearNames[id]);
    const double low = std::min(g.tip_radius_m, g.root_radius_m);
    const double high = std::max(g.tip_radius_m, g.root_radius_m);
    const double pitch = 2.0 * std::numbers::pi / g.teeth;
    for (const Point& p : g.contour) {
      EXPECT_GE(radius(p), low - kRounding);
      EXPECT_LE(radius(p), high + kRounding);
      // On the tip circle within the half tooth of a tooth that is centred on k pitches.
      if (std::abs(radius(p) - g.tip_radius_m) < 1e-12) {
        EXPECT_LT(std::abs(std::remainder(std::atan2(p.y_m, p.x_m), pitch)), 0.3 * pitch);
      }
    }
    // Counter-clockwise, and coarsely the disc half-way up the teeth: teeth and spaces are about as
    // wide, within half of the toothed area.
    const double teeth = std::numbers::pi * (high * high - low * low);
    const double expected = std::numbers::pi * low * low + 0.5 * teeth;
    EXPECT_NEAR(area(g.contour), expected, 0.25 * teeth) << g.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Designs, DrawnTrain, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

TEST(Drawing, PlanetsThatCannotBeEquallySpacedLeaveOneAloneAndANote) {
  const Case c = standard_case("unequal", {.S = 20, .P1 = 30, .R1 = 80, .P2 = 28, .R2 = 78}, 3);
  const DrawingSet set = drawn(c.design, 1e-6);
  const Drawing& train = drawing(set, "train");
  EXPECT_EQ(train.gears.size(), 5U);
  EXPECT_NE(train.remark.find("planet 1 alone"), std::string::npos) << train.remark;
  const auto says = [](const std::string& note) {
    return note.find("100 is not divisible by 3") != std::string::npos;
  };
  EXPECT_TRUE(std::ranges::any_of(set.notes, says));
  EXPECT_NE(svg_text(train).find("planet 1 alone"), std::string::npos);
}

TEST(Drawing, RefusesAChordErrorThatIsNotPositive) {
  const design::Design design = cases()[0].design;
  for (const double bad : {0.0, -1e-6, std::nan("")}) {
    EXPECT_THROW(drawn(design, bad), std::invalid_argument) << bad;
  }
}

// --- DXF

struct ReadCircle {
  std::string layer;
  double x, y, radius;
};

struct ReadPolyline {
  std::string layer;
  bool closed = false;
  std::vector<Point> mm;
};

class Reader : public DL_CreationAdapter {
 public:
  void addLayer(const DL_LayerData& layer) override { layers[layer.name] = attributes; }
  void addLinetype(const DL_LinetypeData& line) override { line_types.push_back(line.name); }
  void addPolyline(const DL_PolylineData& line) override {
    polylines.push_back({getAttributes().getLayer(), (line.flags & 1) != 0, {}});
  }
  void addVertex(const DL_VertexData& v) override {
    EXPECT_EQ(v.bulge, 0.0);
    polylines.back().mm.push_back({v.x, v.y});
  }
  void addCircle(const DL_CircleData& c) override {
    circles.push_back({getAttributes().getLayer(), c.cx, c.cy, c.radius});
  }
  void addLine(const DL_LineData&) override { lines.push_back(getAttributes().getLayer()); }
  void setVariableInt(const std::string& name, int value, int /*code*/) override {
    integers[name] = value;
  }

  std::map<std::string, DL_Attributes> layers;
  std::vector<std::string> line_types, lines;
  std::vector<ReadPolyline> polylines;
  std::vector<ReadCircle> circles;
  std::map<std::string, int> integers;
};

void read_dxf(const Drawing& drawing, Reader& reader) {
  std::istringstream stream(dxf_text(drawing));
  DL_Dxf dxf;
  EXPECT_TRUE(dxf.in(stream, &reader));
}

TEST_P(DrawnTrain, DxfReadsBackAsClosedPolylinesOnTheGearsLayers) {
  for (const Drawing& drawing : set_.drawings) {
    Reader reader;
    read_dxf(drawing, reader);
    EXPECT_EQ(reader.integers["$INSUNITS"], 4);
    EXPECT_EQ(reader.integers["$MEASUREMENT"], 1);
    // 0, CONSTRUCTION, and TIMING where there is a planet
    const bool planets = std::ranges::any_of(
        drawing.gears, [](const DrawnGear& g) { return g.id == kP1 || g.id == kP2; });
    EXPECT_EQ(reader.layers.size(), drawing.gears.size() + (planets ? 3 : 2));
    EXPECT_EQ(reader.layers.contains(kTimingLayer), planets);
    ASSERT_EQ(reader.polylines.size(), drawing.gears.size());
    for (std::size_t k = 0; k < drawing.gears.size(); ++k) {
      const DrawnGear& g = drawing.gears[k];
      const ReadPolyline& line = reader.polylines[k];
      EXPECT_TRUE(reader.layers.contains(g.name)) << g.name;
      EXPECT_EQ(line.layer, g.name);
      EXPECT_TRUE(line.closed);
      ASSERT_EQ(line.mm.size(), g.contour.size());
      for (std::size_t i = 0; i < line.mm.size(); ++i) {
        // Half of the last of nine decimals.
        EXPECT_NEAR(line.mm[i].x_m, 1e3 * g.contour[i].x_m, 0.51e-9);
        EXPECT_NEAR(line.mm[i].y_m, 1e3 * g.contour[i].y_m, 0.51e-9);
      }
    }
  }
}

TEST_P(DrawnTrain, DxfHasItsCirclesAndCentreMarksOnTheConstructionLayer) {
  for (const Drawing& drawing : set_.drawings) {
    Reader reader;
    read_dxf(drawing, reader);
    EXPECT_NE(std::ranges::find(reader.line_types, "CENTER"), reader.line_types.end());
    ASSERT_TRUE(reader.layers.contains(kConstructionLayer));
    EXPECT_EQ(reader.layers.at(kConstructionLayer).getLinetype(), "CENTER");
    std::vector<ReadCircle> marks;
    std::erase_if(reader.circles, [&](const ReadCircle& c) {
      if (c.layer == kTimingLayer) marks.push_back(c);
      return c.layer == kTimingLayer;
    });
    ASSERT_EQ(reader.circles.size(), 4 * drawing.gears.size());
    for (std::size_t k = 0; k < reader.circles.size(); ++k) {
      const DrawnGear& g = drawing.gears[k / 4];
      const ReadCircle& c = reader.circles[k];
      EXPECT_EQ(c.layer, kConstructionLayer);
      EXPECT_NEAR(c.x, 1e3 * g.center.x_m, 0.51e-9);
      EXPECT_NEAR(c.y, 1e3 * g.center.y_m, 0.51e-9);
      // The evaluation's diameters: pitch, base, tip, root.
      const design::GearResult& e = evaluation_.gears[g.id];
      const double diameter[] = {e.pitch_diameter_m, e.base_diameter_m, e.tip_diameter_m,
                                 e.root_diameter_m};
      EXPECT_NEAR(c.radius, 0.5e3 * diameter[k % 4], 0.51e-9);
    }
    // A mark lies within a tooth of its planet: inside the contour, between root and tip.
    std::vector<DrawnGear> planets;
    std::ranges::copy_if(drawing.gears, std::back_inserter(planets),
                         [](const DrawnGear& g) { return g.id == kP1 || g.id == kP2; });
    ASSERT_EQ(marks.size(), planets.size());
    for (std::size_t k = 0; k < marks.size(); ++k) {
      const DrawnGear& g = planets[k];
      const Point at{.x_m = 1e-3 * marks[k].x, .y_m = 1e-3 * marks[k].y};
      const double from_axis = std::hypot(at.x_m - g.center.x_m, at.y_m - g.center.y_m);
      EXPECT_GT(from_axis, g.root_radius_m);
      EXPECT_LT(from_axis, g.tip_radius_m);
      for (int turn = 0; turn < 16; ++turn) {
        const double direction = 2.0 * std::numbers::pi * turn / 16.0;
        EXPECT_TRUE(
            inside(g.contour, {.x_m = at.x_m + 1e-3 * marks[k].radius * std::cos(direction),
                               .y_m = at.y_m + 1e-3 * marks[k].radius * std::sin(direction)}))
            << g.name;
      }
    }
    // Two lines for each axis.
    const std::size_t axes =
        drawing.gears.size() == 1 ? 1 : static_cast<std::size_t>(1 + evaluation_.planets);
    EXPECT_EQ(reader.lines.size(), 2 * axes);
    for (const std::string& layer : reader.lines) EXPECT_EQ(layer, kConstructionLayer);
  }
}

TEST(Dxf, BoresAndOuterDiameterOfTheDesignAreCirclesOfTheirGears) {
  Case c = standard_case("bodies", {.S = 20, .P1 = 30, .R1 = 80, .P2 = 28, .R2 = 78}, 4);
  c.design.masses.bore_radius_m = {3e-3, 5e-3, 0.0, 0.0, 0.0};
  c.design.masses.ring2_outer_radius_m = 60e-3;
  const DrawingSet set = drawn(c.design, 1e-6);
  Reader reader;
  read_dxf(drawing(set, "train"), reader);
  std::map<std::string, double> bodies;
  for (const ReadCircle& circle : reader.circles) {
    if (circle.layer == kTimingLayer) continue;
    if (circle.layer != kConstructionLayer) bodies[circle.layer] = circle.radius;
  }
  const std::map<std::string, double> expected{{"S", 3.0},    {"P1_1", 5.0}, {"P1_2", 5.0},
                                               {"P1_3", 5.0}, {"P1_4", 5.0}, {"R2", 60.0}};
  EXPECT_EQ(bodies, expected);
}

// --- SVG

/// Names of the elements in the order of their begin; fails where tags do not nest.
std::vector<std::string> elements_of(const std::string& xml) {
  std::vector<std::string> open, all;
  std::size_t at = 0;
  while ((at = xml.find('<', at)) != std::string::npos) {
    const std::size_t end = xml.find('>', at);
    EXPECT_NE(end, std::string::npos);
    const std::string tag = xml.substr(at + 1, end - at - 1);
    EXPECT_EQ(tag.find('<'), std::string::npos) << tag;
    EXPECT_EQ(std::ranges::count(tag, '"') % 2, 0) << tag;
    at = end;
    if (tag.front() == '?') continue;
    if (tag.front() == '/') {
      EXPECT_FALSE(open.empty());
      if (open.empty()) return all;
      EXPECT_EQ(tag.substr(1), open.back());
      open.pop_back();
      continue;
    }
    const std::string name = tag.substr(0, tag.find_first_of(" /"));
    all.push_back(name);
    if (tag.back() != '/') open.push_back(name);
  }
  EXPECT_TRUE(open.empty());
  return all;
}

std::string attribute(const std::string& xml, std::size_t from, const std::string& name) {
  const std::size_t begin = xml.find(' ' + name + "=\"", from) + name.size() + 3;
  return xml.substr(begin, xml.find('"', begin) - begin);
}

/// The first subpath of the path with an id: "M x y x y ... Z".
std::vector<Point> path_of(const std::string& svg, const std::string& id) {
  const std::size_t at = svg.find("<path id=\"" + id + "\"");
  EXPECT_NE(at, std::string::npos) << id;
  const std::string data = attribute(svg, at, "d");
  EXPECT_EQ(data.front(), 'M');
  std::istringstream numbers(data.substr(1, data.find('Z') - 1));
  std::vector<Point> points;
  for (Point p; numbers >> p.x_m >> p.y_m;) points.push_back(p);
  return points;
}

TEST_P(DrawnTrain, SvgIsWellFormedAndItsNumbersAreMillimetres) {
  for (const Drawing& drawing : set_.drawings) {
    const std::string svg = svg_text(drawing);
    const std::vector<std::string> elements = elements_of(svg);
    EXPECT_EQ(std::ranges::count(elements, "g"), drawing.gears.size() == 1 ? 1 : 2);
    // One unit is 1 mm, and the page holds the drawing.
    const std::string width = attribute(svg, 0, "width");
    const std::string height = attribute(svg, 0, "height");
    ASSERT_TRUE(width.ends_with("mm") && height.ends_with("mm"));
    EXPECT_EQ(attribute(svg, 0, "viewBox"), "0 0 " + width.substr(0, width.size() - 2) + " " +
                                                height.substr(0, height.size() - 2));
    for (const DrawnGear& g : drawing.gears) {
      EXPECT_GT(std::stod(width), 2e3 * g.root_radius_m);
      const std::vector<Point> path = path_of(svg, g.name);
      ASSERT_EQ(path.size(), g.contour.size());
      for (std::size_t i = 0; i < path.size(); ++i) {
        // Half of the last of six decimals.
        EXPECT_NEAR(path[i].x_m, 1e3 * g.contour[i].x_m, 0.51e-6);
        EXPECT_NEAR(path[i].y_m, 1e3 * g.contour[i].y_m, 0.51e-6);
      }
    }
  }
}

TEST_P(DrawnTrain, SvgShowsEachStageInAPanelOfItsOwnWithYUp) {
  const std::string svg = svg_text(train());
  const std::size_t first = svg.find("<g ");
  const std::size_t first_end = svg.find("</g>");
  const std::size_t second = svg.find("<g ", first + 1);
  ASSERT_LT(first_end, second);
  for (const std::size_t panel : {first, second}) {
    EXPECT_TRUE(attribute(svg, panel, "transform").ends_with("scale(1 -1)"));
  }
  for (const DrawnGear& g : train().gears) {
    const std::size_t at = svg.find("<path id=\"" + g.name + "\"");
    EXPECT_EQ(at < first_end, g.id == kS || g.id == kP1 || g.id == kR1) << g.name;
  }
}

TEST(Svg, EscapesTheDesignsName) {
  Case c = standard_case("x", {.S = 20, .P1 = 30, .R1 = 80, .P2 = 28, .R2 = 78}, 4);
  c.design.name = "a<b> & \"c\"\n\x01 \xC3\xA4";
  const std::string svg = svg_text(drawing(drawn(c.design, 1e-6), "S"));
  elements_of(svg);
  EXPECT_NE(svg.find("a&lt;b&gt; &amp; \"c\" \xEF\xBF\xBD \xC3\xA4: S"), std::string::npos);
}

// Renderers draw letters of a twentieth of a unit as crumbs.
TEST(Svg, LettersOfASmallGearAreLargeAndScaledToTheirPlace) {
  Case c = standard_case("small", {.S = 20, .P1 = 30, .R1 = 80, .P2 = 28, .R2 = 78}, 4);
  const std::string usual = svg_text(drawing(drawn(c.design, 1e-6), "train"));
  for (double& m : c.design.train.module_m) m *= 0.1;
  c.design.train.center_distance_m *= 0.1;
  const std::string small = svg_text(drawing(drawn(c.design, 1e-6), "train"));
  const auto sizes_of = [](const std::string& svg) {
    std::vector<double> sizes;
    for (std::size_t at = 0; (at = svg.find("<text ", at)) != std::string::npos; ++at) {
      const std::string element = svg.substr(at, svg.find('>', at) - at);
      const auto number = [&](const char* before) {
        const std::size_t found = element.find(before);
        if (found == std::string::npos) return 1.0;
        return std::stod(element.substr(found + std::string(before).size()));
      };
      EXPECT_GE(number("font-size=\""), 1.0) << element;
      sizes.push_back(number("font-size=\"") * number("scale("));
    }
    return sizes;
  };
  const std::vector<double> usual_mm = sizes_of(usual);
  const std::vector<double> small_mm = sizes_of(small);
  ASSERT_EQ(small_mm.size(), usual_mm.size());
  ASSERT_GT(usual_mm.size(), 5U);
  for (std::size_t k = 1; k < usual_mm.size(); ++k) {
    EXPECT_NEAR(small_mm[k], 0.1 * usual_mm[k], 2e-6) << k;
  }
}

TEST(Svg, RingIsAnAnnulusToTheOuterDiameterOrTwoAndAHalfModulesAboveTheRoot) {
  Case c = standard_case("ring", {.S = 20, .P1 = 30, .R1 = 80, .P2 = 28, .R2 = 78}, 4);
  c.design.masses.ring2_outer_radius_m = 60e-3;
  const DrawingSet set = drawn(c.design, 1e-6);
  // m = 1 mm, zR1 = 80: root circle 41.25 mm.
  EXPECT_NE(svg_text(drawing(set, "R1")).find("A43.75 43.75 "), std::string::npos);
  EXPECT_NE(svg_text(drawing(set, "R2")).find("A60 60 "), std::string::npos);
}

}  // namespace
}  // namespace gear3k::drawing::drawing_test
