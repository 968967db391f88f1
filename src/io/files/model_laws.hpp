#pragma once
// The laws of a MODEL file: formulas without a cause.

#include <string>
#include <vector>

#include "calibrate/model/law.hpp"
#include "io/files/model_causes.hpp"
#include "io/text/toml_reader.hpp"

namespace gear3k::io {

/// Reads the tables of laws of one kind, [KIND.laws.law], [KIND.laws.law_2], ...  Names and
/// deviations of their parameters go behind those of the causes.  Where there are errors, what is
/// read may be incomplete.
/// @param path  of the table, for messages: "transmission.laws"
std::vector<calibrate::AppliedLaw> read_laws(const TomlValue& table, const std::string& path,
                                             calibrate::Kind kind, TomlReader& reader,
                                             ModelCauses& parameters);

/// Key of a factor's constant: "width", of a second factor "width_2"; a threshold has the unit of
/// its condition.
std::string law_constant_key(const calibrate::LawFactor& factor, std::size_t place);
/// Key of what is not fitted of a factor: "shape", "condition", "origin", "reference".
std::string law_key(std::string_view name, std::size_t place);
/// Of "origin" and "reference", in the unit of the factor's condition.
std::string law_unit_key(std::string_view name, const calibrate::LawFactor& factor,
                         std::size_t place);

}  // namespace gear3k::io
