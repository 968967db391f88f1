#include "actuator/gear_model.hpp"

#include "actuator/design_gear.hpp"

namespace gear3k::actuator {

namespace {

class CatalogueGear : public GearModel {
 public:
  explicit CatalogueGear(const Actuator& actuator)
      : chain_(chain_of(actuator)),
        input_kgm2_(chain_.ratio * chain_.ratio * actuator.gearbox.input_inertia_kgm2) {}

  [[nodiscard]] const std::vector<std::string>& causes() const override { return causes_; }
  [[nodiscard]] GearInstant at(const OutputMotion& o) const override {
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
    std::vector<double> all;
    append_sign_changes(mesh, all);
    for (const double x : all) {
      if (x > range[0] && x < range[1]) roots.push_back(x);
    }
  }
  [[nodiscard]] RestBand band(double load_Nm) const override { return rest_band(chain_, load_Nm); }
  [[nodiscard]] bool constant_efficiencies() const override { return true; }
  [[nodiscard]] double static_nm() const override { return chain_.c2_static_Nm; }
  [[nodiscard]] double inertia_kgm2() const override { return chain_.j2_kgm2 + input_kgm2_; }

 private:
  Chain chain_;
  double input_kgm2_;
  std::vector<std::string> causes_{"gear_coulomb", "gear_viscous", "mesh"};
};

}  // namespace

std::unique_ptr<GearModel> gear_model(const Actuator& actuator) {
  if (actuator.train != nullptr) return design_gear(actuator);
  return std::make_unique<CatalogueGear>(actuator);
}

OutputMotion motion_at(const CyclePiece& piece, double x, double sense) {
  return {.speed_rad_s = value_at(piece.speed_rad_s, x),
          .acceleration_rad_s2 = piece.acceleration(x),
          .load_Nm = value_at(piece.load_Nm, x),
          .sense = sense};
}

}  // namespace gear3k::actuator
