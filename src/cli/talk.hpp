#pragma once
// What the program says on stderr, beside results.

#include <string_view>

namespace gear3k::cli {

/// Writes lines to stderr, control characters in them as io::printable_lines() shows them.  A
/// stderr that cannot be written (closed, full) is no reason to end a run: then nothing is said.
void say(std::string_view text);
/// The same as it is, for what moves about on a terminal.
void say_as_it_is(std::string_view text);

/// Gives standard streams that are closed a descriptor on which reading (stdin) or writing (stdout,
/// stderr) fails, so that no file of a result gets 0, 1 or 2 and with it what is meant for a
/// stream.
void reserve_standard_streams();

}  // namespace gear3k::cli
