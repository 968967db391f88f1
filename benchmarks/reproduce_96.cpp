// The published 96.2:1 gearboxes and both example tasks, each figure against its stated band.
// Prints one line a figure and exits with 1 when any leaves its band.

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "benchmarks/program.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/optimizer.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program

/// A figure and the band that it must lie in, with where the band comes from.
class Bands {
 public:
  void expect(const std::string& what, double value, double low, double high,
              const std::string& source) {
    const bool inside = value >= low && value <= high;
    failed_ += inside ? 0 : 1;
    fmt::print("{}  {:<58} {:>12.6g}  in [{:.6g}, {:.6g}]  ({})\n", inside ? "ok  " : "FAIL", what,
               value, low, high, source);
  }
  /// A printed figure: half a unit of its last digit either way.
  void expect_printed(const std::string& what, double value, double printed, int decimals,
                      const std::string& source) {
    const double half = 0.5 * std::pow(10.0, -decimals);
    expect(what, value, printed - half, printed + half, source);
  }
  [[nodiscard]] int failed() const { return failed_; }

 private:
  int failed_ = 0;
};

std::string path_of(const std::string& example) {
  return std::string(GEAR3K_SOURCE_DIR) + "/examples/" + example;
}

design::Evaluation analyzed(const design::Design& design) {
  return std::get<design::Evaluation>(design::evaluate(design));
}

void published(Bands& bands) {
  const std::string golden = "tests/golden/published_3k.toml";
  design::Design proposed = io::read_design(path_of("designs/low_backlash_prototype.toml"));
  const design::Evaluation sliding = analyzed(proposed);
  bands.expect_printed("low-backlash prototype: ratio", sliding.ratio, 95.907, 3, golden);
  const std::array<double, 3> distances{16.2077, 16.1813, 16.1752};
  for (std::size_t k = 0; k < 3; ++k) {
    bands.expect_printed(
        fmt::format("  zero-backlash centre distance {} [mm]", sliding.meshes[k].name),
        *sliding.meshes[k].zero_backlash_center_distance_m * 1e3, distances[k], 4, golden);
  }
  bands.expect_printed("  eta_f sliding, mu 0.1", sliding.efficiency.forward.value(), 0.881, 3,
                       golden);
  bands.expect_printed("  eta_b sliding, mu 0.1", sliding.efficiency.backward.value(), 0.869, 3,
                       golden);
  proposed.friction.model = efficiency::LossModel::kOhlendorf;
  const design::Evaluation ohlendorf = analyzed(proposed);
  bands.expect_printed("  eta_f ohlendorf, mu 0.1", ohlendorf.efficiency.forward.value(), 0.8761, 4,
                       golden);
  bands.expect_printed("  eta_b ohlendorf, mu 0.1", ohlendorf.efficiency.backward.value(), 0.8630,
                       4, golden);

  const design::Evaluation bilateral =
      analyzed(io::read_design(path_of("designs/bilateral_drive_gear.toml")));
  bands.expect_printed("bilateral drive gear: ratio", bilateral.ratio, 96.242, 3, golden);
  const std::array<double, 3> others{21.2679, 21.2679, 21.2687};
  for (std::size_t k = 0; k < 3; ++k) {
    bands.expect_printed(
        fmt::format("  zero-backlash centre distance {} [mm]", bilateral.meshes[k].name),
        *bilateral.meshes[k].zero_backlash_center_distance_m * 1e3, others[k], 4, golden);
  }
}

optimize::OptimizeResult optimized(const optimize::Specification& spec) {
  optimize::Progress progress;
  return optimize::optimize(spec, progress);
}

void reference_problem(Bands& bands) {
  const std::string source = "docs/rp96.md";
  optimize::Specification spec = io::read_specification(path_of("rp96.toml"));
  const optimize::OptimizeResult slsqp = optimized(spec);
  std::size_t feasible = 0;
  double worst_kkt = 0.0;
  for (const optimize::RefinedSet& s : slsqp.refined) {
    if (s.status != optimize::Status::kOptimal) continue;
    ++feasible;
    worst_kkt = std::max(worst_kkt, s.kkt_residual);
  }
  const auto count = static_cast<double>(slsqp.search.candidates.size());
  bands.expect("rp96: tooth sets", count, 654, 654, source);
  bands.expect("  feasible", static_cast<double>(feasible), 428, 654, source);
  const double best = slsqp.best ? slsqp.best->eta_b : 0.0;
  bands.expect("  best eta_b", best, 0.94340, 1.0, source);
  if (slsqp.best) {
    const design::Design winner = optimize::design_of(spec, *slsqp.best);
    const double arcmin = units::to_si(1.0, units::Unit::kArcmin);
    bands.expect_printed("  the winner's lost motion, kinematic [arcmin]",
                         analyzed(winner).lost_motion.kinematic_rad / arcmin, 15.92, 2, source);
  }
  bands.expect("  largest KKT residual", worst_kkt, 0.0, 1e-5, "stationary in scaled variables");
  spec.solver.refine = optimize::Refine::kIpopt;
  spec.solver.starts = 1;
  const optimize::OptimizeResult ipopt = optimized(spec);
  double largest = 0.0;
  for (std::size_t k = 0; k < slsqp.search.candidates.size(); ++k) {
    largest = std::max(
        largest, std::abs(optimize::set_at(slsqp, k)->eta_b - optimize::set_at(ipopt, k)->eta_b));
  }
  bands.expect("  largest |eta_b SLSQP - Ipopt|", largest, 0.0, 2e-6, "two solvers");
}

void buildable(Bands& bands) {
  const std::string source = "examples/ratio-96.toml";
  const optimize::Specification spec = io::read_specification(path_of("ratio-96.toml"));
  const optimize::OptimizeResult result = optimized(spec);
  if (!result.best) {
    bands.expect("ratio-96: designs found", 0, 1, 1, source);
    return;
  }
  const design::Evaluation e = analyzed(optimize::design_of(spec, *result.best));
  const auto failed = static_cast<double>(
      std::ranges::count_if(e.checks, [](const design::CheckResult& c) { return !c.ok; }));
  const double arcmin = units::to_si(1.0, units::Unit::kArcmin);
  bands.expect("ratio-96: failed checks of the best design", failed, 0, 0, source);
  bands.expect("  ratio", e.ratio, 96.2 * 0.995, 96.2 * 1.005, source);
  bands.expect("  lost motion, kinematic [arcmin]", e.lost_motion.kinematic_rad / arcmin, 0.0,
               8.0 * (1.0 + 1e-6), source);
  double root_diameter_mm = 0.0;
  for (const int ring : {train::kR1, train::kR2}) {
    root_diameter_mm =
        std::max(root_diameter_mm, e.gears[static_cast<std::size_t>(ring)].root_diameter_m * 1e3);
  }
  bands.expect("  ring root diameter [mm]", root_diameter_mm, 0.0, 76.0 * (1.0 + 1e-6), source);
  bands.expect("  smaller module [mm]", std::min(e.module_m[0], e.module_m[1]) * 1e3,
               0.5 * (1.0 - 1e-6), 1.0, source);
  bands.expect("  eta_b, mu 0.1, sliding", e.efficiency.backward.value(), 0.9512, 1.0,
               "best of 4 and of 32 starts; bilateral drive gear 0.9123");
}

}  // namespace

PROGRAM(reproduce_96)(int, char**) {
  Bands bands;
  published(bands);
  reference_problem(bands);
  buildable(bands);
  fmt::print("{}\n", bands.failed() == 0 ? "every figure is in its band"
                                         : fmt::format("{} figures outside", bands.failed()));
  return bands.failed() == 0 ? 0 : 1;
}
