#include "efficiency/train_efficiency.hpp"

namespace gear3k::efficiency {

template <class T>
MeshContact<T> contact_of(const geometry::GearGeometry<T>& gear1,
                          const geometry::GearGeometry<T>& gear2,
                          const geometry::MeshGeometry<T>& mesh, bool gear1_drives) {
  const T& e1 = mesh.addendum_contact_ratio1;
  const T& e2 = mesh.addendum_contact_ratio2;
  return {.z1 = gear1.gear.teeth,
          .z2 = gear2.gear.teeth,
          .sign = geometry::mesh_sign(gear2.gear.kind),
          .approach_contact_ratio = gear1_drives ? e2 : e1,
          .recess_contact_ratio = gear1_drives ? e1 : e2,
          .tan_alpha_w = mesh.tan_alpha_w,
          .gear1_drives = gear1_drives};
}

template <class T>
MeshContact<T> mesh_contact(const train::TrainGeometry<T>& train, train::MeshId mesh,
                            bool forward) {
  const auto index = static_cast<std::size_t>(mesh);
  const auto [first, second] = train::kMeshGears[index];
  return contact_of(train.gears[static_cast<std::size_t>(first)],
                    train.gears[static_cast<std::size_t>(second)], train.meshes[index],
                    train::gear1_drives(mesh, train::g2(train.teeth) < 1.0, forward));
}

template <class T>
MeshEfficiencies<T> mesh_efficiencies(const train::TrainGeometry<T>& train, const MeshFlanks<T>& mu,
                                      LossModel model, bool forward) {
  MeshEfficiencies<T> eta{};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    eta[k] =
        mesh_efficiency(mesh_contact(train, static_cast<train::MeshId>(k), forward), mu[k], model);
  }
  return eta;
}

template <class T>
T forward_efficiency(const train::ToothSet& z, const MeshEfficiencies<T>& eta) {
  const double g1 = train::g1(z);
  const double g2 = train::g2(z);
  const auto& [eta1, eta2, eta3] = eta;
  if (g2 < 1.0) {
    return (1.0 + g1 * eta1 * eta2) * (1.0 - g2) / ((1.0 + g1) * (1.0 - g2 * eta2 * eta3));
  }
  return eta3 * (eta2 + g1 * eta1) * (g2 - 1.0) / ((1.0 + g1) * (g2 - eta2 * eta3));
}

template <class T>
T backward_efficiency(const train::ToothSet& z, const MeshEfficiencies<T>& eta) {
  const double g1 = train::g1(z);
  const double g2 = train::g2(z);
  const auto& [eta1, eta2, eta3] = eta;
  if (g2 < 1.0) {
    return (1.0 + g1) * eta1 * (eta2 * eta3 - g2) / ((1.0 - g2) * eta3 * (g1 + eta1 * eta2));
  }
  return (1.0 + g1) * eta1 * (g2 * eta2 * eta3 - 1.0) / ((g2 - 1.0) * (eta1 + g1 * eta2));
}

template <class T>
T backdriving_margin(const train::ToothSet& z, const MeshEfficiencies<T>& eta) {
  const double g2 = train::g2(z);
  const T product = eta[1] * eta[2];
  return g2 < 1.0 ? T(product - g2) : T(g2 * product - 1.0);
}

#define INSTANTIATE(T)                                                                          \
  template MeshContact<T> contact_of<T>(const geometry::GearGeometry<T>&,                       \
                                        const geometry::GearGeometry<T>&,                       \
                                        const geometry::MeshGeometry<T>&, bool);                \
  template MeshContact<T> mesh_contact<T>(const train::TrainGeometry<T>&, train::MeshId, bool); \
  template MeshEfficiencies<T> mesh_efficiencies<T>(const train::TrainGeometry<T>&,             \
                                                    const MeshFlanks<T>&, LossModel, bool);     \
  template T forward_efficiency<T>(const train::ToothSet&, const MeshEfficiencies<T>&);         \
  template T backward_efficiency<T>(const train::ToothSet&, const MeshEfficiencies<T>&);        \
  template T backdriving_margin<T>(const train::ToothSet&, const MeshEfficiencies<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::efficiency
