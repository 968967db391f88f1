#pragma once
// What a file of extended models holds after another diagnosis.

#include <vector>

#include "calibrate/model/extended_model.hpp"

namespace gear3k::calibrate {

/// The models that a diagnosis started from together with what it found on top of them.
///
/// Of one kind the causes follow each other, earlier ones first, as they act; their covariances
/// stay apart, and range, files and fingerprint become those of the new data.  Earlier causes of
/// the procedure (sessions, drift) stay too: the new data were simulated with what they left
/// behind. A kind without anything new keeps its model as it is.
std::vector<ExtendedModel> updated_models(const std::vector<ExtendedModel>& earlier,
                                          const std::vector<ExtendedModel>& found);

}  // namespace gear3k::calibrate
