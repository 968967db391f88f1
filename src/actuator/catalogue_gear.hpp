#pragma once
// A gearbox by values of a catalogue, in line: internal to actuator/.

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "actuator/gear_model.hpp"
#include "actuator/polynomial.hpp"

namespace gear3k::actuator {

class CatalogueGear final : public GearModel {
 public:
  static constexpr std::size_t kCauses = 3;

  explicit CatalogueGear(const Actuator& actuator)
      : chain_(chain_of(actuator)),
        input_kgm2_(chain_.ratio * chain_.ratio * actuator.gearbox.input_inertia_kgm2) {}

  [[nodiscard]] const std::vector<std::string>& causes() const override;
  [[nodiscard]] GearInstant at(const OutputMotion& o) const override {
    const auto own = instant(o);
    GearInstant all{.mesh_Nm = own.mesh_Nm, .input_Nm = own.input_Nm};
    std::ranges::copy(own.loss_W, all.loss_W.begin());
    return all;
  }
  [[nodiscard]] GearInstantOf<kCauses> instant(const OutputMotion& o) const {
    const double friction = chain_.c2_Nm * o.sense;
    const double viscous = chain_.d2_Nms * o.speed_rad_s;
    const double mesh = chain_.j2_kgm2 * o.acceleration_rad_s2 + viscous + friction - o.load_Nm;
    const double input = mesh_input(chain_, mesh, o.sense);
    return {.mesh_Nm = mesh,
            .input_Nm = input + input_kgm2_ * o.acceleration_rad_s2,
            .loss_W = {friction * o.speed_rad_s, viscous * o.speed_rad_s,
                       (input - mesh) * o.speed_rad_s}};
  }
  void append_flow_changes(const CyclePiece& piece, std::array<double, 2> range, double sense,
                           std::vector<double>& roots) const override {
    const Quadratic& w = piece.speed_rad_s;
    const double accelerating = chain_.j2_kgm2 / piece.duration_s;
    const Quadratic mesh{
        accelerating * w[1] + chain_.d2_Nms * w[0] + chain_.c2_Nm * sense - piece.load_Nm[0],
        2.0 * accelerating * w[2] + chain_.d2_Nms * w[1] - piece.load_Nm[1], chain_.d2_Nms * w[2]};
    const std::size_t before = roots.size();
    append_sign_changes(mesh, roots);
    std::size_t kept = before;
    for (std::size_t k = before; k < roots.size(); ++k) {
      if (roots[k] > range[0] && roots[k] < range[1]) roots[kept++] = roots[k];
    }
    roots.resize(kept);
  }
  [[nodiscard]] RestBand band(double load_Nm) const override { return rest_band(chain_, load_Nm); }
  [[nodiscard]] bool constant_efficiencies() const override { return true; }
  /// Where the load is what the friction of the output side holds.
  void append_band_kinks(const CyclePiece& piece, std::vector<double>& places) const override {
    for (const double kink : {-chain_.c2_static_Nm, chain_.c2_static_Nm}) {
      append_sign_changes(Quadratic{piece.load_Nm[0] - kink, piece.load_Nm[1], 0.0}, places);
    }
  }
  [[nodiscard]] double inertia_kgm2() const override { return chain_.j2_kgm2 + input_kgm2_; }

 private:
  Chain chain_;
  double input_kgm2_;
};

}  // namespace gear3k::actuator
