// Speed of the core: one evaluation, its gradient and Hessian, one refinement, the tooth search.
// Ratios within one run are what counts; the machine's own speed cancels.
//
//   build/bench/benchmarks/core_benchmark --benchmark_repetitions=5 --benchmark_out=core.json

#include <benchmark/benchmark.h>
#include <omp.h>

#include <stdexcept>

#include "benchmarks/program.hpp"
#include "design/evaluation.hpp"
#include "efficiency/train_efficiency.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/version.hpp"
#include "optimize/ipopt.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/refinement_problem.hpp"
#include "optimize/slsqp.hpp"
#include "optimize/starting_points.hpp"
#include "tests/strength/steel.hpp"

namespace {

using namespace gear3k;            // NOLINT(google-build-using-namespace): a program
using namespace gear3k::optimize;  // NOLINT(google-build-using-namespace)

const Specification& rp96() {
  static const Specification kSpec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/rp96.toml");
  return kSpec;
}

const RefinementProblem& winner() {
  static const RefinementProblem kProblem = make_refinement_problem(
      rp96(), {.teeth = {.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118}, .planets = 3},
      {1e-3, std::nullopt});
  return kProblem;
}

/// ratio-96's winner with every check that a train can have: the default ones, radial assembly,
/// coaxiality, all bodies overlapping along the axis, both rings shaped by cutters.
const RefinementProblem& winner_with_all_checks() {
  static const Specification kSpec = [] {
    Specification spec =
        io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml");
    spec.limits[design::CheckId::kTrimming] = 0.0;
    spec.limits[design::CheckId::kCoaxiality] = 0.1e-3;
    spec.limits[design::CheckId::kOutputBacklashMin] = 1e-4;
    for (const auto ring : {train::kR1, train::kR2}) {
      spec.cutter[ring] = {.teeth = 40, .profile_shift = 0.0, .tip_radius = 0.2};
    }
    spec.axial.extent.fill(train::AxialInterval{.from_m = 0.0, .to_m = 0.01});
    spec.axial.carrier_radius_m = 0.03;
    return spec;
  }();
  static const RefinementProblem kProblem = make_refinement_problem(
      kSpec, {.teeth = {.S = 12, .P1 = 64, .R1 = 141, .P2 = 52, .R2 = 132}, .planets = 3},
      {std::nullopt, std::nullopt});
  return kProblem;
}

/// rp96 under a load that binds in some tooth sets and forbids others: steel 700/290, 8 mm wide.
const Specification& loaded_rp96() {
  static const Specification kSpec = [] {
    Specification spec = rp96();
    strength::RatingTask& task = spec.rating.emplace();
    task.material.fill(strength::steel_700_290());
    task.torque_Nm = 10.0;
    task.face_width_m = {8e-3, 8e-3};
    task.teeth.root_safety_min = 1.5;
    task.teeth.flank_safety_min = 1.2;
    return spec;
  }();
  return kSpec;
}

const RefinementProblem& loaded_winner() {
  static const RefinementProblem kProblem =
      make_refinement_problem(loaded_rp96(), winner().candidate, {1e-3, std::nullopt});
  return kProblem;
}

/// Independent variables of any scalar type at a point.
template <class T>
std::vector<T> seeded(const RefinementProblem& p, const Point& v) {
  std::vector<T> jets(static_cast<std::size_t>(p.variables));
  for (std::size_t k = 0; k < jets.size(); ++k) {
    if constexpr (std::is_same_v<T, double>) {
      jets[k] = v[k];
    } else if constexpr (std::is_same_v<T, Jet1>) {
      jets[k] = Jet1(v[k], static_cast<int>(k));
    } else {
      jets[k] = Jet2::variable(v[k], k);
    }
  }
  return jets;
}

/// Objective and all constraints of a winner: double = values, Jet1 = gradients, Jet2 =
/// gradients and Hessians.
template <class T, const RefinementProblem& (*problem)()>
void evaluate_problem(benchmark::State& state) {
  const RefinementProblem& p = problem();
  const std::vector<T> v = seeded<T>(p, starting_points(p, 1, 1).front());
  std::vector<T> g(p.rows.size());
  for (auto _ : state) {
    if (!evaluate<T>(p, std::span<const T>(v), std::span<T>(g))) {
      throw std::runtime_error("the starting point is not defined");
    }
    benchmark::DoNotOptimize(g.data());
  }
}
BENCHMARK_TEMPLATE(evaluate_problem, double, winner);
BENCHMARK_TEMPLATE(evaluate_problem, Jet1, winner);
BENCHMARK_TEMPLATE(evaluate_problem, Jet2, winner);
BENCHMARK_TEMPLATE(evaluate_problem, double, loaded_winner);
BENCHMARK_TEMPLATE(evaluate_problem, Jet1, loaded_winner);
BENCHMARK_TEMPLATE(evaluate_problem, double, winner_with_all_checks);
BENCHMARK_TEMPLATE(evaluate_problem, Jet1, winner_with_all_checks);
BENCHMARK_TEMPLATE(evaluate_problem, Jet2, winner_with_all_checks);

/// All derivatives by central differences of the values: what exact gradients replace.
void gradient_by_differences(benchmark::State& state) {
  const RefinementProblem& p = winner();
  const Point start = starting_points(p, 1, 1).front();
  std::vector<double> g(p.rows.size());
  for (auto _ : state) {
    for (int k = 0; k < p.variables; ++k) {
      for (const double step : {1e-6, -1e-6}) {
        Point v = start;
        v[static_cast<std::size_t>(k)] += step;
        benchmark::DoNotOptimize(evaluate<double>(p, used(p, v), std::span<double>(g)));
      }
    }
  }
}
BENCHMARK(gradient_by_differences);

void refine_slsqp_one_start(benchmark::State& state) {
  const Point start = starting_points(winner(), 1, 1).front();
  for (auto _ : state) benchmark::DoNotOptimize(solve_slsqp(winner(), start, {}));
}
BENCHMARK(refine_slsqp_one_start)->Unit(benchmark::kMicrosecond);

void refine_ipopt_one_start(benchmark::State& state) {
  const Point start = starting_points(winner(), 1, 1).front();
  for (auto _ : state) benchmark::DoNotOptimize(solve_ipopt(winner(), start));
}
BENCHMARK(refine_ipopt_one_start)->Unit(benchmark::kMicrosecond);

/// A gearbox of the task ratio-96 with losses of every kind.
const design::Design& lossy_gearbox() {
  static const design::Design kDesign = io::read_design(
      std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/ratio_96_with_losses.toml");
  return kDesign;
}

/// Efficiencies of the three meshes of a train.
template <efficiency::LossModel model>
void mesh_losses(benchmark::State& state) {
  const auto train = train::make_train_geometry(lossy_gearbox().train);
  for (auto _ : state) {
    benchmark::DoNotOptimize(efficiency::mesh_efficiencies(*train, 0.1, model, true));
  }
}
BENCHMARK_TEMPLATE(mesh_losses, efficiency::LossModel::kSliding);
BENCHMARK_TEMPLATE(mesh_losses, efficiency::LossModel::kCoulombPath);

/// One operating point: friction by load and speed, drags, bearings, torques in balance.
void operate_backward(benchmark::State& state) {
  const auto train = train::make_train_geometry(lossy_gearbox().train);
  const auto lossy = design::lossy_train(lossy_gearbox(), *train);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        design::operate(lossy, *lossy_gearbox().operating_point, design::Direction::kBackward));
  }
}
BENCHMARK(operate_backward);

void search_rp96(benchmark::State& state) {
  omp_set_num_threads(static_cast<int>(state.range(0)));
  std::size_t sets = 0;
  for (auto _ : state) {
    Progress progress;
    sets += search_teeth(rp96(), progress).within_ratio;
  }
  state.counters["sets/s"] =
      benchmark::Counter(static_cast<double>(sets), benchmark::Counter::kIsRate);
}
BENCHMARK(search_rp96)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// The whole of rp96 with its 4 starts a set, as it is and under a load: their ratio is what
/// strength costs.
template <const Specification& (*task)()>
void optimize_rp96(benchmark::State& state) {
  omp_set_num_threads(static_cast<int>(state.range(0)));
  std::size_t sets = 0;
  for (auto _ : state) {
    Progress progress;
    sets += optimize::optimize(task(), progress).search.candidates.size();
  }
  state.counters["sets/s"] =
      benchmark::Counter(static_cast<double>(sets), benchmark::Counter::kIsRate);
}
BENCHMARK_TEMPLATE(optimize_rp96, rp96)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_TEMPLATE(optimize_rp96, loaded_rp96)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace

PROGRAM(core_benchmark)(int argc, char** argv) {
  benchmark::AddCustomContext("gear3k", std::string(io::version()));
  benchmark::AddCustomContext("commit", std::string(io::git_commit()));
  benchmark::AddCustomContext("compiler", __VERSION__);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
