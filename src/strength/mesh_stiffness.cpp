#include "strength/mesh_stiffness.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "numerics/gauss_rule.hpp"

namespace gear3k::strength {

namespace {

constexpr double kNewtonPerMillimetre = 1e3;    ///< N/mm in N/m
constexpr double kMillimetreMicrometre = 1e-9;  ///< mm µm/N in 1/Pa
constexpr double kSteelModulus_Pa = 206000e6;
constexpr double kFullLineLoad = 100.0 * kNewtonPerMillimetre;
constexpr std::size_t kPathNodes = 10;
/// Of the base pitch: least distance of a contact from a tangent point.
constexpr double kLeastCurvature = 1e-3;

}  // namespace

template <class T>
IsoPair<T> iso_pair(const geometry::GearGeometry<T>& gear1,
                    const geometry::GearGeometry<T>& gear2) {
  const geometry::Gear<T>* first = &gear1.gear;
  const geometry::Gear<T>* second = &gear2.gear;
  const bool first_ring = first->kind == geometry::GearKind::kRing;
  const bool second_ring = second->kind == geometry::GearKind::kRing;
  if (first_ring && second_ring) {
    throw std::invalid_argument("stiffness of a pair: both gears are rings, allowed: one");
  }
  if (first_ring || (!second_ring && second->teeth < first->teeth)) std::swap(first, second);
  IsoPair<T> pair{.teeth1 = first->teeth,
                  .profile_shift1 = first->profile_shift,
                  .profile_shift2 = second->profile_shift,
                  .dedendum1 = first->rack.dedendum,
                  .dedendum2 = second->rack.dedendum};
  if (second->kind == geometry::GearKind::kRing) {
    pair.profile_shift2 = -second->profile_shift;
  } else {
    pair.teeth2 = second->teeth;
  }
  return pair;
}

template <class T>
T iso_flexibility(const IsoPair<T>& pair) {
  // Symbols as in ISO 6336-1.
  const double z1 = 1.0 / pair.teeth1;
  const double z2 = pair.teeth2 ? 1.0 / *pair.teeth2 : 0.0;
  const T& x1 = pair.profile_shift1;
  const T& x2 = pair.profile_shift2;
  const T q = 0.04723 + 0.15551 * z1 + 0.25791 * z2 - 0.00635 * x1 - (0.11654 * z1) * x1 -
              0.00193 * x2 - (0.24188 * z2) * x2 + 0.00529 * x1 * x1 + 0.00182 * x2 * x2;
  return kMillimetreMicrometre * q;
}

template <class T>
bool iso_flexibility_in_range(const IsoPair<T>& pair) {
  const double sum = value_of(pair.profile_shift1) + value_of(pair.profile_shift2);
  return sum >= kLeastShiftSum && sum <= kGreatestShiftSum;
}

template <class T>
IsoStiffness<T> iso_stiffness(const IsoPair<T>& pair, const T& contact_ratio,
                              const IsoLoading& loading, const T& line_load_N_m) {
  using std::sqrt;
  check_elasticity(loading.material1);
  check_elasticity(loading.material2);
  // Symbols as in ISO 6336-1.
  const double E1 = loading.material1.youngs_modulus_Pa;
  const double E2 = loading.material2.youngs_modulus_Pa;
  const double E_r = 2.0 * E1 * E2 / (E1 + E2);
  const T C_B = 1.0 + 0.25 * ((1.2 - pair.dedendum1) + (1.2 - pair.dedendum2));
  IsoStiffness<T> c;
  c.single = (0.8 * loading.web_factor * E_r / kSteelModulus_Pa) * C_B / iso_flexibility(pair);
  c.low_load = value_of(line_load_N_m) < kFullLineLoad;
  if (c.low_load) {
    const bool loaded = value_of(line_load_N_m) > 0.0;
    c.single =
        loaded ? T(c.single * sqrt(sqrt(T(line_load_N_m / kFullLineLoad)))) : constant<T>(0.0);
  }
  c.mesh_alpha = c.single * (0.75 * larger(contact_ratio, constant<T>(1.0)) + 0.25);
  c.mesh_beta = 0.85 * c.mesh_alpha;
  return c;
}

template <class T>
ElasticMesh<T> make_elastic_mesh(const geometry::GearGeometry<T>& gear1,
                                 const geometry::ToothForm<T>& form1,
                                 const geometry::GearGeometry<T>& gear2,
                                 const geometry::ToothForm<T>& form2,
                                 const geometry::MeshGeometry<T>& mesh, const Elasticity& material1,
                                 const Elasticity& material2, const T& line_load_N_m) {
  check_elasticity(material1);
  check_elasticity(material2);
  if (!(value_of(line_load_N_m) > 0.0)) {
    throw std::invalid_argument(fmt::format("mesh stiffness: line load = {} N/m, allowed: above 0",
                                            value_of(line_load_N_m)));
  }
  ElasticMesh<T> elastic;
  elastic.tooth1 = make_elastic_tooth(gear1, form1);
  elastic.tooth2 = make_elastic_tooth(gear2, form2);
  elastic.sign = geometry::mesh_sign(gear2.gear.kind);
  elastic.tangent_length_m = mesh.tangent_length_m;
  elastic.base_pitch_m = mesh.base_pitch_m;
  elastic.material1 = material1;
  elastic.material2 = material2;
  elastic.line_load_N_m = line_load_N_m;
  // Gear 2's tip begins the path, gear 1's ends it.
  const T rho_a2 = geometry::tip_curvature_radius(gear2);
  const T least = kLeastCurvature * mesh.base_pitch_m;
  elastic.path_begin_m = larger(T(elastic.sign * (mesh.tangent_length_m - rho_a2)), least);
  elastic.path_end_m = geometry::tip_curvature_radius(gear1);
  if (elastic.sign > 0.0) {
    elastic.path_end_m = smaller(elastic.path_end_m, T(mesh.tangent_length_m - least));
  }
  return elastic;
}

template <class T>
T pair_stiffness(const ElasticMesh<T>& mesh, const T& curvature1_m) {
  const T curvature2 = mesh.tangent_length_m - mesh.sign * curvature1_m;
  const T reduced = curvature1_m * curvature2 / mesh.tangent_length_m;
  const T half_width =
      contact_half_width(mesh.line_load_N_m, reduced, mesh.material1, mesh.material2);
  const FlankLoad<T> load1 = flank_load(mesh.tooth1, curvature1_m);
  const FlankLoad<T> load2 = flank_load(mesh.tooth2, curvature2);
  return 1.0 / (tooth_compliance(mesh.tooth1, load1, mesh.material1) +
                tooth_compliance(mesh.tooth2, load2, mesh.material2) +
                contact_compliance(load1.depth_m, half_width, mesh.material1) +
                contact_compliance(load2.depth_m, half_width, mesh.material2));
}

template <class T>
T mean_mesh_stiffness(const ElasticMesh<T>& mesh) {
  static const auto kRule = numerics::gauss_rule<kPathNodes>();
  const T length = mesh.path_end_m - mesh.path_begin_m;
  T sum = constant<T>(0.0);
  for (const numerics::GaussNode& node : kRule) {
    sum = sum + node.weight * pair_stiffness(mesh, T(mesh.path_begin_m + node.position * length));
  }
  return sum * length / mesh.base_pitch_m;
}

#define INSTANTIATE(T)                                                                      \
  template IsoPair<T> iso_pair<T>(const geometry::GearGeometry<T>&,                         \
                                  const geometry::GearGeometry<T>&);                        \
  template T iso_flexibility<T>(const IsoPair<T>&);                                         \
  template bool iso_flexibility_in_range<T>(const IsoPair<T>&);                             \
  template IsoStiffness<T> iso_stiffness<T>(const IsoPair<T>&, const T&, const IsoLoading&, \
                                            const T&);                                      \
  template ElasticMesh<T> make_elastic_mesh<T>(                                             \
      const geometry::GearGeometry<T>&, const geometry::ToothForm<T>&,                      \
      const geometry::GearGeometry<T>&, const geometry::ToothForm<T>&,                      \
      const geometry::MeshGeometry<T>&, const Elasticity&, const Elasticity&, const T&);    \
  template T pair_stiffness<T>(const ElasticMesh<T>&, const T&);                            \
  template T mean_mesh_stiffness<T>(const ElasticMesh<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
