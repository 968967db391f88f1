#pragma once

#include "papers/reproduce.hpp"

namespace gear3k::papers {

/// The published gearboxes, the tasks RP-96 and of the figures, and the thesis, from the files
/// inside the program.
PublishedSources published_sources();

}  // namespace gear3k::papers
