#include "actuator/gear_model.hpp"

#include "actuator/catalogue_gear.hpp"
#include "actuator/design_gear.hpp"

namespace gear3k::actuator {

const std::vector<std::string>& CatalogueGear::causes() const {
  static const std::vector<std::string> names{"gear_coulomb", "gear_viscous", "mesh"};
  return names;
}

std::unique_ptr<GearModel> gear_model(const Actuator& actuator) {
  if (actuator.train != nullptr) return design_gear(actuator);
  return std::make_unique<CatalogueGear>(actuator);
}

}  // namespace gear3k::actuator
