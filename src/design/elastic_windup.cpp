#include "design/elastic_windup.hpp"

#include <algorithm>
#include <cmath>

#include "design/evaluation.hpp"
#include "design/evaluation_parts.hpp"
#include "design/loaded_train.hpp"

namespace gear3k::design {

namespace {

constexpr int kLeastDoubling = -10;
constexpr int kMostDoubling = 3;

}  // namespace

std::optional<ElasticTrain> elastic_train(const Design& design) {
  if (!design.rating) return std::nullopt;
  const strength::RatingTask& task = *design.rating;
  const auto geometry = train::make_train_geometry(resolved_parameters(design));
  if (!geometry) return std::nullopt;
  const auto forms = tooth_forms(geometry->gears);
  auto loaded =
      loaded_train<double>(*geometry, forms, task.face_width_m, even_friction<double>({}, {}),
                           efficiency::LossModel::kSliding);
  loaded.mesh_load = strength::even_mesh_loads();
  ElasticTrain result;
  std::optional<strength::TrainSprings<double>> springs;
  for (int doubling = kLeastDoubling; doubling <= kMostDoubling; ++doubling) {
    const double torque_Nm = std::ldexp(task.torque_Nm, doubling);
    const auto rating = strength::rate_train(loaded, task, strength::Drive::kForward, torque_Nm,
                                             strength::StiffnessPart::kPath);
    if (!rating.springs) return std::nullopt;
    springs = rating.springs;
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      result.mesh[k].push_back({.normal_N = rating.mesh[k].normal_N,
                                .compliance_m_N = 1.0 / rating.springs->mesh_N_m[k]});
    }
  }
  result.train = strength::locked_train(*geometry, *springs);
  return result;
}

double mesh_compliance(const std::vector<ElasticTrain::MeshSpring>& spring, double normal_N) {
  const auto above =
      std::ranges::lower_bound(spring, normal_N, {}, &ElasticTrain::MeshSpring::normal_N);
  if (above == spring.begin()) return above->compliance_m_N;
  if (above == spring.end()) return spring.back().compliance_m_N;
  const auto below = std::prev(above);
  const double share =
      std::log(normal_N / below->normal_N) / std::log(above->normal_N / below->normal_N);
  return below->compliance_m_N + share * (above->compliance_m_N - below->compliance_m_N);
}

double elastic_windup(const ElasticTrain& train, double torque_Nm) {
  std::array<double, train::kMeshCount> compliance{};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const double force =
        std::abs(train.train.mesh_torque[k][0] * torque_Nm) * train.train.normal_N_per_Nm[k];
    compliance[k] = mesh_compliance(train.mesh[k], force);
  }
  return strength::locked_compliance(train.train, compliance)[0][0] * torque_Nm;
}

}  // namespace gear3k::design
