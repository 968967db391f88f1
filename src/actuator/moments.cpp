#include <algorithm>
#include <cmath>

#include "actuator/gear_model.hpp"
#include "actuator/selection.hpp"

namespace gear3k::actuator {

namespace {

using Basis = std::array<double, 4>;

Basis basis_of(const GearInstant& gear, const OutputMotion& motion) {
  return {gear.input_Nm, motion.acceleration_rad_s2, motion.speed_rad_s, motion.sense};
}

class MomentSum {
 public:
  explicit MomentSum(const GearModel& gear) : gear_(gear) {}

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
    turns_.assign(1, 0.0);
    append_sign_changes(piece.speed_rad_s, turns_);
    turns_.push_back(1.0);
    for (std::size_t k = 1; k < turns_.size(); ++k) {
      const double speed = value_at(piece.speed_rad_s, 0.5 * (turns_[k - 1] + turns_[k]));
      const double sense = speed > 0.0 ? 1.0 : -1.0;
      flows_.assign(1, turns_[k - 1]);
      gear_.append_flow_changes(piece, {turns_[k - 1], turns_[k]}, sense, flows_);
      flows_.push_back(turns_[k]);
      for (std::size_t j = 1; j < flows_.size(); ++j) {
        add_part(piece, flows_[j - 1], flows_[j], sense);
      }
    }
  }
  CycleMoments take() { return std::move(moments_); }

 private:
  void add_part(const CyclePiece& piece, double x0, double x1, double sense) {
    for (const double x : {x0, x1}) {
      const OutputMotion motion = motion_at(piece, x, sense);
      const GearInstant gear = gear_.at(motion);
      moments_.points.push_back(basis_of(gear, motion));
      moments_.peak_mesh_Nm = std::max(moments_.peak_mesh_Nm, std::abs(gear.mesh_Nm));
    }
    for (std::size_t g = 0; g < kGaussNodes.size(); ++g) {
      const OutputMotion motion = motion_at(piece, x0 + (x1 - x0) * kGaussNodes[g], sense);
      const GearInstant gear = gear_.at(motion);
      const Basis b = basis_of(gear, motion);
      const double seconds = (x1 - x0) * piece.duration_s * kGaussWeights[g];
      for (std::size_t r = 0; r < b.size(); ++r) {
        for (std::size_t c = 0; c < b.size(); ++c) {
          moments_.square[r][c] += b[r] * b[c] * seconds;
        }
      }
      moments_.input_work_J += gear.input_Nm * motion.speed_rad_s * seconds;
      moments_.square_mesh += gear.mesh_Nm * gear.mesh_Nm * seconds;
    }
  }

  const GearModel& gear_;
  CycleMoments moments_;
  std::vector<double> turns_, flows_;
};

}  // namespace

CycleMoments cycle_moments(const Actuator& actuator, const Cycle& cycle) {
  const auto gear = gear_model(actuator);
  MomentSum sum(*gear);
  for (const CyclePiece& piece : pieces_of(cycle)) sum.add(piece);
  CycleMoments moments = sum.take();
  moments.period_s = cycle.time_s.back() - cycle.time_s.front();
  return moments;
}

double square_torque(const CycleMoments& moments, const Chain& chain, double rotor_kgm2) {
  const Basis p{1.0, rotor_kgm2, chain.d1_Nms, chain.c1_Nm};
  double sum = 0.0;
  for (std::size_t r = 0; r < p.size(); ++r) {
    for (std::size_t c = 0; c < p.size(); ++c) sum += p[r] * moments.square[r][c] * p[c];
  }
  return sum;
}

}  // namespace gear3k::actuator
