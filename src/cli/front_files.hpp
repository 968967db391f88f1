#pragma once
// The DESIGN files of the rows of a front.

#include <cstddef>
#include <string>
#include <vector>

#include "design/design.hpp"
#include "io/text/file_set.hpp"
#include "optimize/specification.hpp"

namespace gear3k::cli {

/// Names of those that a run of a specification may write; none with one objective.
std::vector<std::string> possible_front_files(const optimize::Specification& spec);

/// Names of those that an earlier run wrote into a folder, which its pareto.csv tells.
std::vector<std::string> earlier_front_files(const std::string& folder);

/// The files of a front's designs, in its order.
std::vector<io::FileText> front_files(const std::vector<design::Design>& designs);

/// "front_01.toml to front_08.toml, ", for what is said of a run's files; "" without designs.
std::string front_files_text(std::size_t designs);

}  // namespace gear3k::cli
