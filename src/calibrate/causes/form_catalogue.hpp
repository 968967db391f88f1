#pragma once
// Every form that a cause may take on any data: what a file may name.

#include <string>
#include <string_view>
#include <vector>

#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate {

/// A form by its name.
struct CatalogueForm {
  std::string name;
  /// The constants that a form of this name may have, each once (values without meaning), and
  /// which of them go together; forms of one name differ in them with what the data state.
  std::vector<FormConstant> constants;
  std::vector<std::vector<FormConstant>> sets;
  std::vector<std::string> bodies;  ///< that it may concern; empty: none
  bool has_order = false;
};

/// Forms that a cause states for data with every column, of a gearbox or of a black box.
/// @returns in the order of the cause's own list; empty where the kind cannot show the cause
std::vector<CatalogueForm> form_catalogue(const Cause& cause, Kind kind);

/// Key of a quantity in files: its name and, where it has one, its unit, in lower-case letters,
/// digits and underscores.
///
///   torque [Nm] → torque_nm,  coefficient [1/K] → coefficient_per_k,
///   compliance [arcmin/Nm] → compliance_arcmin_per_nm,  share [] → share
std::string file_key(std::string_view name, std::string_view unit);

}  // namespace gear3k::calibrate
