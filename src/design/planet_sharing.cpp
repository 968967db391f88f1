#include "design/planet_sharing.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "design/built_series.hpp"

namespace gear3k::design {

namespace {

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

using strength::LoadFactorSeries, strength::MeshLoadFactors, strength::MeshSprings;

/// Springs of the meshes at a torque; empty where one has no path of contact.
std::optional<MeshSprings> springs_at(const strength::RatedTrain<double>& loaded,
                                      const strength::RatingTask& task, double torque_Nm) {
  strength::RatedTrain<double> even = loaded;
  even.mesh_load = strength::even_mesh_loads();
  const auto rating = strength::rate_train(even, task, strength::Drive::kForward, torque_Nm,
                                           strength::StiffnessPart::kPath);
  if (!rating.springs) return std::nullopt;
  return rating.springs->mesh_N_m;
}

/// The series at every torque that was asked for.
struct SeriesByTorque {
  const strength::RatedTrain<double>* loaded = nullptr;
  const strength::RatingTask* task = nullptr;
  strength::PlaySample sample{};
  std::map<double, std::optional<LoadFactorSeries>> known{};

  const std::optional<LoadFactorSeries>& at(double torque_Nm) {
    const auto found = known.find(torque_Nm);
    if (found != known.end()) return found->second;
    std::optional<LoadFactorSeries> series;
    const auto springs = springs_at(*loaded, *task, torque_Nm);
    if (springs && sample.assembled > 0) {
      series = strength::load_factor_series(sample, *springs, torque_Nm,
                                            task->factors.mesh_load_quantile);
    }
    return known.emplace(torque_Nm, series).first->second;
  }
};

}  // namespace

std::optional<SharedMeshLoad> shared_mesh_load(const Design& design,
                                               const strength::RatedTrain<double>& loaded) {
  const strength::RatingTask& task = *design.rating;
  if (task.factors.mesh_load_source != strength::MeshLoadSource::kTolerances) return std::nullopt;
  if (!design.tolerances) {
    throw std::invalid_argument("k_gamma from tolerances without tolerances, allowed: with them");
  }
  auto all = std::make_shared<SeriesByTorque>();
  all->loaded = &loaded;
  all->task = &task;
  if (const auto model = clearance_model_of(design)) {
    all->sample = strength::draw_plays(
        *model, {.samples = std::min<std::uint64_t>(
                     kSharingSamples, static_cast<std::uint64_t>(design.sampling.samples)),
                 .seed = design.sampling.seed,
                 .scatter = {.scatter = design.tolerances->scatter,
                             .sigma_level = design.tolerances->sigma_level}});
  }
  const auto mesh_load = [all](double torque_Nm) {
    MeshLoadFactors factors;
    const std::optional<LoadFactorSeries>& series = all->at(torque_Nm);
    for (std::size_t k = 0; k < factors.size(); ++k) {
      factors[k] = series ? strength::Factor<double>{.value = std::max(1.0, series->quantile[k]),
                                                     .branch = "quantile of built gearboxes",
                                                     .source = strength::sources::kTolerances}
                          : strength::Factor<double>{.value = kNotKnown,
                                                     .branch = "not known",
                                                     .source = strength::sources::kTolerances,
                                                     .in_range = false};
    }
    return factors;
  };
  return SharedMeshLoad{.sharing = {.quantile = task.factors.mesh_load_quantile,
                                    .drawn = all->sample.drawn,
                                    .assembled = all->sample.assembled,
                                    .series = all->at(task.torque_Nm)},
                        .mesh_load = mesh_load};
}

}  // namespace gear3k::design
