// Efficiency and lost motion of a gearbox over its centre distance, with gear3k as a library.
//
//   analyze DESIGN.toml

#include "app/analyze.hpp"

#include <cstdio>
#include <exception>

#include "io/files/design_file.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: analyze DESIGN.toml\n");
    return 1;
  }
  try {
    using namespace gear3k;  // NOLINT(google-build-using-namespace): an example
    const design::Design drawn = io::read_design(argv[1]);
    const app::Analysis analysis = app::analyze({.design = drawn, .source = argv[1]});
    std::printf("%s, %.6g:1\n", analysis.evaluation.name.c_str(), analysis.evaluation.ratio);
    std::printf("%12s %12s %12s\n", "distance", "eta_b", "lost motion");
    for (const double change_um : {-10.0, 0.0, 10.0}) {
      design::Design moved = drawn;
      moved.train.center_distance_m = analysis.evaluation.center_distance_m + 1e-6 * change_um;
      moved.center_distance_given = true;
      const design::Evaluation e = app::analyze({.design = moved, .source = argv[1]}).evaluation;
      constexpr double kArcminPerRad = 60.0 * 180.0 / 3.14159265358979323846;
      std::printf("%9.3f mm %10.2f %% %7.2f arcmin\n", 1e3 * e.center_distance_m,
                  100.0 * e.efficiency.backward.value_or(0.0),
                  kArcminPerRad * e.lost_motion.kinematic_rad);
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
