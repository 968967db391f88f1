#pragma once
// The covariance of the parameters of a MODEL file.

#include <string>
#include <vector>

#include "io/files/model_causes.hpp"
#include "io/text/toml_reader.hpp"

namespace gear3k::io {

/// Reads the covariance of parameters, in their order, row after row: symmetric, positive
/// semidefinite, and with the standard deviations that the causes state.
///
/// Without a table: diagonal, from the stated standard deviations; empty where none is stated.
/// @param table  null: there is none
/// @param path   of the table, for messages: "transmission.covariance"
std::vector<double> read_covariance(const TomlValue* table, const std::string& path,
                                    const ModelCauses& parameters, TomlReader& reader);

}  // namespace gear3k::io
