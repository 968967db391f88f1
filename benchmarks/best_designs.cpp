// The best designs for the low-backlash paper's task beside the two published gearboxes: ratio
// 96.2:1, friction 0.1, at most 8 arcmin by the kinematic model, ring roots within 76 mm, module
// 0.5 or coarser, every manufacturing check on (examples/ratio-96.toml).
//
//   best_designs [DIR]    with DIR, the three designs as DIR/*.toml
//
// Masses and inertias are those of the gears alone at assumed widths, the same for all rows.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "benchmarks/program.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/file_writer.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/optimizer.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program

constexpr double kFaceWidth1_m = 8e-3, kFaceWidth2_m = 10e-3, kDensity_kgm3 = 7850.0,
                 kRim_m = 2.5e-3;

std::string example(const char* name) {
  return std::string(GEAR3K_SOURCE_DIR) + "/examples/" + name;
}

optimize::Specification paper_task() {
  optimize::Specification spec = io::read_specification(example("ratio-96.toml"));
  spec.bodies = {.density_kgm3 = kDensity_kgm3,
                 .face_width_m = {kFaceWidth1_m, kFaceWidth2_m},
                 .ring_rim_m = kRim_m};
  return spec;
}

void print_row(const char* what, const optimize::Specification& spec,
               const design::Design& design) {
  const auto result = design::evaluate(design);
  const auto* e = std::get_if<design::Evaluation>(&result);
  if (e == nullptr) {
    fmt::print("{:<34} not defined\n", what);
    return;
  }
  train::TrainParameters<double> parameters = design.train;
  parameters.center_distance_m = e->center_distance_m;
  const auto train = train::make_train_geometry(parameters);
  const auto j_bn = backlash::normal_backlashes(*train);
  const auto value = [&](optimize::Objective objective) {
    return optimize::objective_value(objective, spec, *train, j_bn);
  };
  const auto failed = std::ranges::count(e->checks, false, &design::CheckResult::ok);
  const train::ToothSet& z = design.train.teeth;
  const double least_j_um = 1e6 * *std::ranges::min_element(j_bn);
  fmt::print(
      "{:<34} {:<19} {:>2} {:8.3f} {:6.2f} {:6.2f} {:7.2f} {:8.1f} {:8.2f} {:9.3f} {:7.3f} {:>6}\n",
      what, fmt::format("{}/{}/{}/{}/{}", z.S, z.P1, z.R1, z.P2, z.R2), design.train.planets,
      train::ratio(z), 100.0 * e->efficiency.forward.value_or(0.0),
      100.0 * e->efficiency.backward.value_or(0.0),
      units::from_si(e->lost_motion.kinematic_rad, units::Unit::kArcmin), least_j_um,
      1e3 * 2.0 *
          std::max(train->gears[train::kR1].root_radius_m, train->gears[train::kR2].root_radius_m),
      1e3 * value(optimize::Objective::kInertia), value(optimize::Objective::kMass), failed);
}

struct Task {
  const char* what;
  const char* file;
  optimize::Specification spec;
};

std::vector<Task> tasks() {
  optimize::Specification own = paper_task();
  own.teeth.S = {14, 14};
  own.teeth.P1 = {40, 40};
  own.teeth.P2 = {36, 36};
  own.teeth.R1_max = 94;
  own.teeth.R2_max = 92;
  own.teeth.max_coaxial_offset = 0;
  own.teeth.min_internal_difference = 8;
  // Three identical planets cannot be assembled with these teeth: each has its own phase.
  own.limits[design::CheckId::kIdenticalPlanets] = std::nullopt;
  const optimize::Specification reference = io::read_specification(example("rp96.toml"));
  optimize::Specification sets = paper_task();
  sets.teeth = reference.teeth;
  sets.ratio = reference.ratio;
  optimize::Specification wide = io::read_specification(example("ratio-96-wide.toml"));
  wide.bodies = own.bodies;
  return {{"best with the paper's teeth", "paper_teeth.toml", own},
          {"best of rp96's tooth sets", "rp96_sets.toml", sets},
          {"best of the wide space", "wide_space.toml", wide}};
}

}  // namespace

PROGRAM(best_designs)(int argc, char** argv) {
  fmt::print("{:<34} {:<19} {:>2} {:>8} {:>6} {:>6} {:>7} {:>8} {:>8} {:>9} {:>7} {:>6}\n", "",
             "S/P1/R1/P2/R2", "N", "ratio", "eta_f", "eta_b", "lost", "least j", "ring", "inertia",
             "mass", "checks");
  fmt::print("{:<34} {:<19} {:>2} {:>8} {:>6} {:>6} {:>7} {:>8} {:>8} {:>9} {:>7} {:>6}\n", "", "",
             "", "", "%", "%", "arcmin", "um", "mm", "g m2", "kg", "failed");
  const optimize::Specification any = paper_task();
  for (const auto& [what, file] :
       {std::pair{"published: low-backlash prototype", "designs/low_backlash_prototype.toml"},
        std::pair{"published: bilateral drive gear", "designs/bilateral_drive_gear.toml"}}) {
    design::Design design = io::read_design(example(file));
    design.limits = any.limits;
    print_row(what, any, design);
  }
  for (const Task& task : tasks()) {
    optimize::Progress progress;
    const auto result = optimize::optimize(task.spec, progress, {.best_only = true});
    if (!result.best) {
      fmt::print("{:<34} none found\n", task.what);
      continue;
    }
    const design::Design design = optimize::design_of(task.spec, *result.best);
    print_row(task.what, task.spec, design);
    if (argc > 1) {
      io::prepare_folder(argv[1]);
      io::write_file(fmt::format("{}/{}", argv[1], task.file), io::design_text(design));
    }
    const optimize::Certificate& c = *result.certificate;
    const std::string rest = c.largest_unrefined_bound
                                 ? fmt::format("unrefined ones hold at most {:.2f} %",
                                               100.0 * *c.largest_unrefined_bound)
                                 : std::string("none was left out");
    fmt::print("{:<34} of {} sets {} were refined; {}, any set holds at most {:.2f} %\n", "",
               result.search.candidates.size(), c.refined, rest, 100.0 * c.global_bound);
  }
  return 0;
}
