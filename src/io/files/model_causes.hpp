#pragma once
// The causes of a MODEL file.

#include <string>
#include <vector>

#include "calibrate/model/extended_model.hpp"
#include "io/text/toml_reader.hpp"

namespace gear3k::io {

/// A standard deviation that stands beside its parameter.
struct StatedDeviation {
  Position position;
  double value = 0.0;
  bool stated = false;
};

struct ModelCauses {
  std::vector<calibrate::AppliedCause> causes;
  // Parameter by parameter of all causes.
  std::vector<std::string> names;  ///< "drag_constant.torque_nm"
  std::vector<StatedDeviation> deviations;
};

/// Reads the tables of causes of one kind.  Where there are errors, what is read may be incomplete.
/// @param path  of the table, for messages: "transmission.causes"
ModelCauses read_causes(const TomlValue& table, const std::string& path, calibrate::Kind kind,
                        TomlReader& reader);

}  // namespace gear3k::io
