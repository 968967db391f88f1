#include "calibrate/model/cause.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace gear3k::calibrate {

double Form::constant(std::string_view constant_name) const {
  const auto found = std::ranges::find(constants, constant_name, &FormConstant::name);
  if (found == constants.end()) {
    throw std::invalid_argument(
        fmt::format("Form::constant: form {} has no constant {}", name, constant_name));
  }
  return found->value;
}

const Cause* find_cause(std::string_view id) {
  const auto found = std::ranges::find(causes(), id, &Cause::id);
  return found == causes().end() ? nullptr : *found;
}

}  // namespace gear3k::calibrate
