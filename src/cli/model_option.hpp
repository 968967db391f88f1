#pragma once
// --model MODEL.toml: a design with what measurements added to its simulation.

#include <optional>
#include <string>
#include <vector>

#include "design/extension.hpp"
#include "optimize/specification.hpp"
#include "report/model_report.hpp"

namespace gear3k::cli {

struct LoadedModel {
  report::ModelUse use;
  design::Extension<double> extension;
};

/// Reads a MODEL file; empty for "".
/// @throws io::InvalidInput with every error of the file, and for a model of a black box
std::optional<LoadedModel> load_model(const std::string& path);
/// The same from a text that was read already; empty for the path "".
std::optional<LoadedModel> parse_model(const std::string& path, const std::string& text);

/// What a result made with a model has to say.
using Notes = std::vector<std::string>;

/// The design with the model.  Where the model needs an operating point and the design has none, it
/// gets the middle of the model's range; `notes` says that, and what leaves the model's range.
design::Design with_model(const design::Design& design, const LoadedModel& model, Notes& notes);

/// The same for a map: the grid is compared with the model's range.
design::Design with_model_on_grid(const design::Design& design, const LoadedModel& model,
                                  Notes& notes);

/// A specification whose sets the model judges, at its operating point or the middle of the model's
/// range.  The limits of lost motion are lowered by the model's clearance and wind-up, so that what
/// a test would measure keeps them.
optimize::Specification with_model(const optimize::Specification& spec, LoadedModel& model,
                                   Notes& notes);

/// Notes what there is to say about any use of a model: that it was measured on a gearbox of
/// another name, and why not to trust it as it stands.
void note_model(const std::string& name, const report::ModelUse& model, Notes& notes);

/// Why no teeth can keep a limit of lost motion with what the model adds to theirs; "" where they
/// can.
std::string unreachable_lost_motion(const optimize::Specification& stated,
                                    const LoadedModel& model);

/// Notes on stderr, unless quiet.
void warn(const Notes& notes, bool quiet);

}  // namespace gear3k::cli
