#pragma once
// MODEL.toml: the extended models that `gear3k diagnose` writes and --model reads.

#include <string>
#include <vector>

#include "calibrate/model/extended_model.hpp"

namespace gear3k::io {

/// A MODEL file that read_model() turns into the same models: all numbers exactly, of a form all
/// but its weight in the search, which has no meaning after it.
/// @throws std::invalid_argument for what the file cannot hold: two models of one kind, an unknown
/// cause or range, a value that is not finite
std::string model_text(const std::vector<calibrate::ExtendedModel>& models);

/// Reads a MODEL file.
/// @throws InvalidInput with every error of the file
std::vector<calibrate::ExtendedModel> read_model(const std::string& path);
/// The same from a text; `name` stands for the file in messages.
std::vector<calibrate::ExtendedModel> parse_model(const std::string& text, const std::string& name);

}  // namespace gear3k::io
