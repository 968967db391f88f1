#pragma once
// Friction loss of one mesh.

#include <array>
#include <optional>
#include <string_view>

#include "geometry/scalar.hpp"

namespace gear3k::efficiency {

enum class LossModel {
  kSliding,   ///< mean |sliding| over a base pitch, exact to first order for any contact ratios
  kOhlendorf  ///< the papers' closed form, right for 0 ≤ e_a, e_r ≤ 1 and ε ≥ 1
};
/// Names of the models in files, in the order of the enum.
inline constexpr std::array<std::string_view, 2> kLossModelNames{"sliding", "ohlendorf"};

/// A mesh as its friction sees it.
template <class T>
struct MeshContact {
  int z1 = 0;                ///< teeth of gear 1
  int z2 = 0;                ///< teeth of gear 2, counted positive
  double sign = 1.0;         ///< +1 external, −1 when gear 2 is a ring
  T approach_contact_ratio;  ///< e_a
  T recess_contact_ratio;    ///< e_r
};

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
/// Source: own derivation, docs/theory.md §9; property-tested against numerical integration.
template <class T>
T sliding_factor(const T& approach, const T& recess);

/// Efficiency of one mesh under Coulomb friction, to first order in μ.
///
///   η = 1 − μ π (1/z1 ± 1/z2) B            (+ external, − ring)
///
/// The same for both drive directions, as approach and recess enter symmetrically.
/// Valid: μ small enough that η > 0; a value ≤ 0 is returned as it is.
/// Does not account for: load sharing by stiffness, churning, the second order in μ.
/// @param mu  coefficient of friction
template <class T>
T mesh_efficiency(const MeshContact<T>& contact, const T& mu, LossModel model);

/// Whether the model is inside its range of validity for this mesh (ohlendorf: 0 ≤ e_a, e_r ≤ 1 and
/// ε ≥ 1; sliding: ε > 0).
bool loss_model_in_range(LossModel model, double approach, double recess);

}  // namespace gear3k::efficiency
