#pragma once

#include "report/reproduce.hpp"

namespace gear3k::io {

/// The published gearboxes, the task RP-96 and the thesis, from the files inside the program.
report::PublishedSources published_sources();

}  // namespace gear3k::io
