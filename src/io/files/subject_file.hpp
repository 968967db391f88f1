#pragma once
// What was measured, from one file: a DESIGN, a PAIR, or a gearbox as a black box.

#include <string>
#include <string_view>

#include "calibrate/model/simulation.hpp"

namespace gear3k::io {

/// Reads a file whose content tells what it is: a table [gearbox] a black box, a key `kind` a PAIR,
/// anything else a DESIGN.
/// @param takes  what is said to be read where the file is another one
/// @throws InvalidInput with every error of the file
calibrate::Subject read_subject(const std::string& path, std::string_view takes =
                                                             "SUBJECT takes a DESIGN, a PAIR or a "
                                                             "black box ([gearbox])");

/// A black box from a text; `name` stands for the file in messages.
calibrate::BlackBox parse_black_box(const std::string& text, const std::string& name);

/// Table of the black box's keys, in Markdown.
std::string black_box_key_table();

}  // namespace gear3k::io
