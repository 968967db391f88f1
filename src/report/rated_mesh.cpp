#include "report/rated_mesh.hpp"

namespace gear3k::report {

namespace {

/// Whether a root of plastic, which losses heat, is weaker though the force is not greater.
bool is_weaker(const strength::MeshRating<double>& a, const strength::MeshRating<double>& b) {
  constexpr double kRounding = 1e-9;
  for (std::size_t i = 0; i < a.teeth.size(); ++i) {
    if (!a.teeth[i].plastic || !a.teeth[i].root_limit_stated) continue;
    if (a.teeth[i].root_safety < (1.0 - kRounding) * b.teeth[i].root_safety) return true;
  }
  return false;
}

}  // namespace

std::array<RatedMesh, train::kMeshCount> rated_meshes(const design::StrengthResult& strength) {
  constexpr double kRounding = 1e-9;
  std::array<RatedMesh, train::kMeshCount> meshes;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const strength::MeshRating<double>& forward = strength.forward.mesh[k];
    const strength::MeshRating<double>& backward = strength.backward.mesh[k];
    const bool more_backward =
        backward.normal_N > (1.0 + kRounding) * forward.normal_N || is_weaker(backward, forward);
    const auto [gear1, gear2] = train::kMeshGears[k];
    meshes[k] = {.name = std::string(train::kMeshNames[k]),
                 .gears = {std::string(train::kGearNames[static_cast<std::size_t>(gear1)]),
                           std::string(train::kGearNames[static_cast<std::size_t>(gear2)])},
                 .rating = more_backward ? &backward : &forward,
                 .drive = more_backward ? strength::Drive::kBackward : strength::Drive::kForward,
                 .forward_N = forward.normal_N,
                 .backward_N = backward.normal_N};
  }
  return meshes;
}

RatedMesh rated_mesh(const design::PairEvaluation& e) {
  const strength::MeshRating<double>& rating = e.strength.value();
  return {.name = e.mesh.name,
          .gears = {e.gears.at(0).name, e.gears.at(1).name},
          .rating = &rating,
          .drive = {},
          .forward_N = rating.normal_N,
          .backward_N = rating.normal_N};
}

double rated_torque(const design::PairEvaluation& e) {
  return e.strength.value().normal_N * 0.5 * e.gears.at(0).base_diameter_m;
}

std::array<NamedFactor, 7> load_factors_of(const strength::MeshRating<double>& mesh) {
  const strength::RatedLoadFactors<double>& k = mesh.factors;
  return {{{"k_a", "K_A", &k.application},
           {"k_gamma", "K_gamma", &k.mesh_load},
           {"k_v", "K_v", &k.dynamic},
           {"k_h_beta", "K_Hbeta", &k.flank_face},
           {"k_f_beta", "K_Fbeta", &k.root_face},
           {"k_h_alpha", "K_Halpha", &k.flank_transverse},
           {"k_f_alpha", "K_Falpha", &k.root_transverse}}};
}

std::array<NamedFactor, 6> root_factors_of(const strength::ToothRating<double>& tooth) {
  const strength::RootStrength<double>& y = tooth.root_strength;
  return {{{"y_st", "Y_ST", &y.stress_correction},
           {"y_nt", "Y_NT", &y.life},
           {"y_delta", "Y_delta", &y.notch_sensitivity},
           {"y_r", "Y_R", &y.surface},
           {"y_x", "Y_X", &y.size},
           {"y_m", "Y_M", &y.reversal}}};
}

std::array<NamedFactor, 6> flank_factors_of(const strength::ToothRating<double>& tooth) {
  const strength::FlankStrength<double>& z = tooth.flank_strength;
  return {{{"z_nt", "Z_NT", &z.life},
           {"z_l", "Z_L", &z.lubricant},
           {"z_v", "Z_v", &z.speed},
           {"z_r", "Z_R", &z.roughness},
           {"z_w", "Z_W", &z.work_hardening},
           {"z_x", "Z_X", &z.size}}};
}

std::vector<PlacedFactor> factors_of(const RatedMesh& mesh) {
  std::vector<PlacedFactor> factors;
  const auto add = [&](const NamedFactor& named, const std::string& gear) {
    if (is_applied(*named.factor)) {
      factors.push_back({.named = named, .mesh = mesh.name, .gear = gear});
    }
  };
  const strength::MeshRating<double>& rating = *mesh.rating;
  for (const NamedFactor& named : load_factors_of(rating)) add(named, "");
  add({"z_eps", "Z_eps", &rating.flank.contact_ratio}, "");
  // Plastics are rated at the pitch point.
  if (!rating.teeth[0].plastic) add({"z_b", "Z_B", &rating.flank.single_contact1}, mesh.gears[0]);
  if (!rating.teeth[1].plastic) add({"z_d", "Z_D", &rating.flank.single_contact2}, mesh.gears[1]);
  for (const std::size_t i : {0U, 1U}) {
    const strength::ToothRating<double>& tooth = rating.teeth[i];
    add({"y_b", "Y_B", &tooth.rim}, mesh.gears[i]);
    for (const NamedFactor& named : root_factors_of(tooth)) add(named, mesh.gears[i]);
    for (const NamedFactor& named : flank_factors_of(tooth)) add(named, mesh.gears[i]);
  }
  return factors;
}

}  // namespace gear3k::report
