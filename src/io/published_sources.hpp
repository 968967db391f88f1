#pragma once

#include "report/reproduce.hpp"

namespace gear3k::io {

/// The published gearboxes and the task RP-96, from the files inside the program.
report::PublishedSources published_sources();

}  // namespace gear3k::io
