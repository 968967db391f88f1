// How often the gain that `optimize --model` states holds: campaigns of the wide rig with a hidden
// cause, diagnosed, the gearbox designed again, and both designs measured on the same bench.
//
//   redesign_gain [SEEDS [LAW-PREFIX [FIRST-SEED [rows]]]]      redesign_gain 20 friction_load 101
//
// A line of the table per law: campaigns, those whose best design changes, the share of these whose
// true gain is in the stated 90 % interval and the share of all, each with its 95 % interval; means
// of the stated and of the true gain, and mean half width, in percentage points.  A design that
// stays gains nothing, as its interval about 0 says: it is in the share of all alone.  A campaign
// that fails counts as one that changes, and as not covered; so does a change without an interval.
// With `rows` a line per campaign.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "benchmarks/program.hpp"
#include "benchmarks/share.hpp"
#include "io/files/specification_file.hpp"
#include "numerics/parallel.hpp"
#include "tests/calibrate/redesign_spec.hpp"
#include "tests/calibrate/redesigned.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program's own namespace
using wide_rig::HiddenLaw, wide_rig::Redesigned;

/// Laws of causes that the library can name; the last two have none of its shapes in them.
const std::vector<HiddenLaw>& laws() {
  static const std::vector<HiddenLaw> all{
      {.cause = "friction_level", .law = "all_meshes"},
      {.cause = "friction_load", .law = "power"},
      {.cause = "friction_load", .law = "logarithmic"},
      {.cause = "friction_load", .law = "saturating"},
      {.cause = "friction_speed", .law = "power"},
      {.cause = "friction_speed", .law = "stribeck_exponential"},
      {.cause = "friction_speed", .law = "mixed_film"},
      {.cause = "friction_temperature", .law = "vogel"},
      {.cause = "friction_direction", .law = "backward_only"},
      {.cause = "friction_direction", .law = "approach_recess"},
      {.cause = "drag_constant", .law = "sun_seal"},
      {.cause = "drag_constant", .law = "output_seal"},
      {.cause = "drag_viscous", .law = "sun"},
      {.cause = "drag_viscous", .law = "planet"},
      {.cause = "drag_quadratic", .law = "churning_power"},
      {.cause = "bearing_load", .law = "planet_pins"},
      {.cause = "bearing_load", .law = "output_bearing"},
      {.cause = "friction_level", .law = "ring_meshes"},
      {.cause = "friction_level", .law = "mesh_by_mesh"}};
  return all;
}

struct GainSum {
  int count = 0, changed = 0, covered_changed = 0, covered = 0, unstated = 0, failed = 0;
  double stated = 0.0, truth = 0.0, half_width = 0.0;

  void add(const Redesigned& r) {
    ++count;
    covered += r.covered() ? 1 : 0;
    if (r.change.same_design) return;
    ++changed;
    if (!r.change.gain || !r.change.gain->ci90) {
      ++unstated;
      return;
    }
    covered_changed += r.covered() ? 1 : 0;
    stated += r.change.gain->value;
    truth += r.true_gain;
    half_width += 0.5 * ((*r.change.gain->ci90)[1] - (*r.change.gain->ci90)[0]);
  }
  void fail() {
    ++count;
    ++changed;
    ++failed;
  }
  void print(const std::string& name) const {
    const double n = 0.01 * std::max(changed - unstated - failed, 1);
    fmt::print("{:<44} {:5} {:7} {} {} {:9.4f} {:9.4f} {:9.4f}{}{}\n", name, count, changed,
               benchmarks::share(covered_changed, changed), benchmarks::share(covered, count),
               stated / n, truth / n, half_width / n,
               unstated > 0 ? fmt::format("  {} without interval", unstated) : "",
               failed > 0 ? fmt::format("  {} failed", failed) : "");
    std::fflush(stdout);
  }
};

void print_row(std::size_t seed, const Redesigned& r) {
  const auto interval =
      r.change.gain && r.change.gain->ci90 ? *r.change.gain->ci90 : std::array<double, 2>{};
  const auto narrow = r.change.gain_by_parameters.value_or(std::array<double, 2>{});
  fmt::print(
      "    {:>3} {} {:10.7f} in [{:10.7f}, {:10.7f}] ([{:10.7f}, {:10.7f}]), stated {:10.7f}  "
      "{}{}\n",
      seed, r.covered() ? "      " : "missed", 100.0 * r.true_gain, 100.0 * interval[0],
      100.0 * interval[1], 100.0 * narrow[0], 100.0 * narrow[1],
      r.change.gain ? 100.0 * r.change.gain->value : 0.0, r.answer,
      r.change.same_design ? " (same design)" : "");
}

/// Tasks that differ in ratio, friction and the play that is allowed.
std::vector<wide_rig::FirstDesign> first_designs() {
  std::vector<wide_rig::FirstDesign> result;
  for (const auto& [ratio, mu, most_arcmin] : std::vector<std::array<double, 3>>{
           {96.2, 0.1, 12.0}, {80.0, 0.06, 15.0}, {120.0, 0.12, 15.0}}) {
    optimize::Specification spec = io::parse_specification(rig::kRedesignSpec, "spec.toml");
    spec.ratio.target = ratio;
    spec.friction.coefficient = mu;
    spec.limits[design::CheckId::kOutputBacklashMax] = most_arcmin * units::kArcmin;
    result.push_back(wide_rig::first_design(spec));
  }
  return result;
}

}  // namespace

PROGRAM(redesign_gain)(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 20;
  const std::string prefix = argc > 2 ? argv[2] : "";
  const std::size_t first = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 1;
  const bool rows = argc > 4;
  const auto specs = first_designs();
  fmt::print("{:<44} {:>5} {:>7} {:>19} {:>19} {:>9} {:>9} {:>9}\n", "law", "runs", "changed",
             "covered of changed", "covered of all", "stated", "true", "half");
  GainSum all;
  for (const HiddenLaw& law : laws()) {
    const std::string name = law.cause + " " + law.law;
    if (!name.starts_with(prefix)) continue;
    std::vector<Redesigned> results(static_cast<std::size_t>(seeds));
    std::vector<std::string> errors(results.size());
    numerics::parallel_for(results.size(), [&](std::size_t k) {
      try {
        results[k] = wide_rig::redesigned(specs[k % specs.size()], law, first + k);
      } catch (const std::exception& error) {
        errors[k] = error.what();
      }
    });
    GainSum sum;
    for (std::size_t k = 0; k < results.size(); ++k) {
      if (!errors[k].empty()) {
        sum.fail();
        all.fail();
        fmt::print("    seed {}: {}\n", first + k, errors[k]);
        continue;
      }
      sum.add(results[k]);
      all.add(results[k]);
      if (rows) print_row(first + k, results[k]);
    }
    sum.print(name);
  }
  all.print("all");
  return 0;
}
