#pragma once

#include "papers/backdrivability.hpp"

namespace gear3k::papers {

/// The backdrivability-factors paper, the makers' tables and the walking knee, from the files
/// inside the program.
BackdrivabilitySources backdrivability_sources();

}  // namespace gear3k::papers
