#include <algorithm>
#include <cmath>

#include "actuator/catalogue_gear.hpp"
#include "actuator/selection.hpp"

namespace gear3k::actuator {

namespace {

using Basis = std::array<double, 4>;

/// @tparam Gear  GearModel, or a final one of it, which is then called in line
template <class Gear>
class MomentSum {
 public:
  MomentSum(const Gear& gear, std::size_t pieces)
      : gear_(gear), constant_(gear.constant_efficiencies()) {
    moments_.points.reserve(2 * pieces + pieces / 2);
  }

  void add(const CyclePiece& piece) {
    if (piece.rests()) {
      const double held =
          std::max(std::abs(piece.load_Nm[0]), std::abs(value_at(piece.load_Nm, 1)));
      moments_.peak_mesh_Nm = std::max(moments_.peak_mesh_Nm, held);
      const double first = piece.load_Nm[0];
      const double last = value_at(piece.load_Nm, 1.0);
      moments_.square_mesh += piece.duration_s * (first * first + first * last + last * last) / 3.0;
      return;
    }
    turns_.clear();
    turns_.push_back(0.0);
    append_sign_changes(piece.speed_rad_s, turns_);
    turns_.push_back(1.0);
    for (std::size_t k = 1; k < turns_.size(); ++k) {
      const double speed = value_at(piece.speed_rad_s, 0.5 * (turns_[k - 1] + turns_[k]));
      const double sense = speed > 0.0 ? 1.0 : -1.0;
      flows_.clear();
      flows_.push_back(turns_[k - 1]);
      gear_.append_flow_changes(piece, {turns_[k - 1], turns_[k]}, sense, flows_);
      flows_.push_back(turns_[k]);
      for (std::size_t j = 1; j < flows_.size(); ++j) {
        add_part(piece, flows_[j - 1], flows_[j], sense);
      }
    }
  }
  CycleMoments take() {
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < r; ++c) moments_.square[r][c] = moments_.square[c][r];
    }
    return std::move(moments_);
  }

 private:
  /// The state at a place, and of the mesh.
  struct Place {
    Basis b{};
    double mesh_Nm = 0.0;
  };

  [[nodiscard]] Place place(const CyclePiece& piece, double x, double sense) const {
    const OutputMotion motion = motion_at(piece, x, sense);
    const GearInstant gear = gear_.at(motion);
    return {.b = {gear.input_Nm, motion.acceleration_rad_s2, motion.speed_rad_s, sense},
            .mesh_Nm = gear.mesh_Nm};
  }

  void add_part(const CyclePiece& piece, double x0, double x1, double sense) {
    const Place first = place(piece, x0, sense);
    const Place last = place(piece, x1, sense);
    for (const Place* end : {&first, &last}) {
      moments_.points.push_back(end->b);
      moments_.peak_mesh_Nm = std::max(moments_.peak_mesh_Nm, std::abs(end->mesh_Nm));
    }
    const double seconds = (x1 - x0) * piece.duration_s;
    if (piece.speed_rad_s[2] == 0.0 && constant_) {
      add_straight(first, last, seconds);
      return;
    }
    for (std::size_t g = 0; g < kGaussNodes.size(); ++g) {
      const Place inside = place(piece, x0 + (x1 - x0) * kGaussNodes[g], sense);
      add_node(inside, seconds * kGaussWeights[g]);
    }
  }
  void add_node(const Place& at, double seconds) {
    for (std::size_t r = 0; r < at.b.size(); ++r) {
      for (std::size_t c = r; c < at.b.size(); ++c) {
        moments_.square[r][c] += at.b[r] * at.b[c] * seconds;
      }
    }
    moments_.input_work_J += at.b[0] * at.b[2] * seconds;
    moments_.square_mesh += at.mesh_Nm * at.mesh_Nm * seconds;
  }
  /// ∫ of a product of two straight lines: (2 a0 b0 + a0 b1 + a1 b0 + 2 a1 b1)/6.
  void add_straight(const Place& first, const Place& last, double seconds) {
    const double sixth = seconds / 6.0;
    const auto both = [&](double a0, double a1, double b0, double b1) {
      return ((2.0 * a0 + a1) * b0 + (a0 + 2.0 * a1) * b1) * sixth;
    };
    const Basis& p = first.b;
    const Basis& q = last.b;
    for (std::size_t r = 0; r < p.size(); ++r) {
      for (std::size_t c = r; c < p.size(); ++c) {
        moments_.square[r][c] += both(p[r], q[r], p[c], q[c]);
      }
    }
    moments_.input_work_J += both(p[0], q[0], p[2], q[2]);
    moments_.square_mesh += both(first.mesh_Nm, last.mesh_Nm, first.mesh_Nm, last.mesh_Nm);
  }

  const Gear& gear_;
  bool constant_;
  CycleMoments moments_;
  std::vector<double> turns_, flows_;
};

template <class Gear>
CycleMoments moments_with(const Gear& gear, const std::vector<CyclePiece>& pieces) {
  MomentSum<Gear> sum(gear, pieces.size());
  for (const CyclePiece& piece : pieces) sum.add(piece);
  CycleMoments moments = sum.take();
  for (const CyclePiece& piece : pieces) moments.period_s += piece.duration_s;
  return moments;
}

}  // namespace

CycleMoments cycle_moments(const Actuator& actuator, const std::vector<CyclePiece>& pieces) {
  if (actuator.train == nullptr) return moments_with(CatalogueGear(actuator), pieces);
  return moments_with(*gear_model(actuator), pieces);
}

}  // namespace gear3k::actuator
