#pragma once
// Friction loss of one mesh.

#include <array>
#include <optional>
#include <string_view>

#include "geometry/scalar.hpp"

namespace gear3k::efficiency {

enum class LossModel {
  kSliding,      ///< mean |sliding| over a base pitch, exact to first order for any contact ratios
  kOhlendorf,    ///< the papers' closed form, right for 0 ≤ e_a, e_r ≤ 1 and ε ≥ 1
  kCoulombPath,  ///< exact Coulomb friction along the path of contact, each direction by itself
  kDirectional   ///< kCoulombPath with different friction in approach and in recess
};
/// Names of the models in files, in the order of the enum.
inline constexpr std::array<std::string_view, 4> kLossModelNames{"sliding", "ohlendorf",
                                                                 "coulomb_path", "directional"};

/// Coefficient of friction of a mesh.  Factors other than 1 act in the first-order models by the
/// difference that they make to the path of contact, docs/theory §29.
template <class T>
struct FlankFriction {
  T coefficient{};                       ///< μ
  T approach_factor = constant<T>(1.0);  ///< friction in approach over μ
  T recess_factor = constant<T>(1.0);    ///< friction in recess over μ
};

/// A mesh as its friction sees it.
template <class T>
struct MeshContact {
  int z1 = 0;                  ///< teeth of gear 1
  int z2 = 0;                  ///< teeth of gear 2, counted positive
  double sign = 1.0;           ///< +1 external, −1 when gear 2 is a ring
  T approach_contact_ratio{};  ///< e_a
  T recess_contact_ratio{};    ///< e_r
  /// What the path models need besides.
  T tan_alpha_w = constant<T>(0.0);  ///< tangent of the working pressure angle
  bool gear1_drives = true;
};

/// The same mesh with its numbers in another scalar.
/// @param to  To(const From&)
template <class To, class From, class Convert>
MeshContact<To> contact_in(const MeshContact<From>& c, const Convert& to) {
  return {.z1 = c.z1,
          .z2 = c.z2,
          .sign = c.sign,
          .approach_contact_ratio = to(c.approach_contact_ratio),
          .recess_contact_ratio = to(c.recess_contact_ratio),
          .tan_alpha_w = to(c.tan_alpha_w),
          .gear1_drives = c.gear1_drives};
}
/// The numbers of a mesh without their derivatives.
template <class T>
MeshContact<double> values_of(const MeshContact<T>& c) {
  return contact_in<double>(c, [](const T& x) { return value_of(x); });
}
/// Whether they have none: the gears are as drawn.
bool is_drawn(const MeshContact<Jet1>& c);

/// Factor B of the mesh loss by Ohlendorf: 1 − ε + e_a² + e_r², ε = e_a + e_r.
///
/// Equals sliding_factor() where 0 ≤ e_a, e_r ≤ 1 and 1 ≤ ε ≤ 2; larger elsewhere.
/// Source: the formula of the low-backlash paper's reference [10] (see errata 10).
template <class T>
T ohlendorf_factor(const T& approach, const T& recess);

/// Factor B of the mesh loss: twice the mean over one base pitch of the mean |s| of the pairs in
/// contact, s = distance of a contact point from the pitch point in base pitches.
///
/// The pairs in contact share the load equally.  Any e_a, e_r, also negative, and any ε > 0: for
/// ε < 1 the mean is over the part of the pitch with a pair in contact; for ε ≤ 0 there is no
/// contact, and |s| at the middle of the (empty) path continues it.
/// Source: own derivation, docs/theory §9; property-tested against numerical integration.
template <class T>
T sliding_factor(const T& approach, const T& recess);

/// Efficiency of one mesh in its drive direction.
///
///   sliding, ohlendorf: η = 1 − μ π (1/z1 ± 1/z2) B            (+ external, − ring),
///   the same for both drive directions, as approach and recess enter symmetrically;
///   coulomb_path, directional: coulomb_path_efficiency()
///
/// Valid: μ small enough that η > 0; the first-order models return a value ≤ 0 as it is, the path
/// models 0, without slope, where the flanks jam.
/// Does not account for: load sharing by stiffness, churning, rolling friction; in the first-order
/// models, the second order in μ.
template <class T>
T mesh_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu, LossModel model);
template <class T>
T mesh_efficiency(const MeshContact<T>& contact, const T& mu, LossModel model) {
  return mesh_efficiency(contact, FlankFriction<T>{.coefficient = mu}, model);
}

/// Whether the model is inside its range of validity for this mesh (ohlendorf: 0 ≤ e_a, e_r ≤ 1 and
/// ε ≥ 1; the others: ε > 0).
bool loss_model_in_range(LossModel model, double approach, double recess);

}  // namespace gear3k::efficiency
