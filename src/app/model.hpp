#pragma once
// A design with what measurements added to its simulation.

#include <optional>
#include <string>
#include <vector>

#include "design/extension.hpp"
#include "optimize/specification.hpp"
#include "report/model_report.hpp"

namespace gear3k::app {

/// An extended model as results use it.
struct Model {
  report::ModelUse use;
  design::Extension<double> extension;
};

/// What the models of a MODEL file change in a simulation.
/// @param source  stands for the file in messages
/// @throws io::InvalidInput for a model of a black box
Model model_of(std::vector<calibrate::ExtendedModel> models, const std::string& source);
/// The model of a file; empty for "".
/// @throws io::InvalidInput with every error of the file
std::optional<Model> read_model(const std::string& path);

/// What a result made with a model has to say.
using Notes = std::vector<std::string>;

/// The design with the model.  Where the model needs an operating point and the design has none, it
/// gets the middle of the model's range; `notes` says that, and what leaves the model's range.
design::Design with_model(const design::Design& design, const Model& model, Notes& notes);

/// The same for a map: the grid is compared with the model's range.
design::Design with_model_on_grid(const design::Design& design, const Model& model, Notes& notes);

/// A specification whose sets the model judges, at its operating point or the middle of the model's
/// range.  The limits of lost motion are lowered by the model's clearance and wind-up, so that what
/// a test would measure keeps them.
optimize::Specification with_model(const optimize::Specification& spec, Model& model, Notes& notes);

/// Notes what there is to say about any use of a model: that it was measured on a gearbox of
/// another name, and why not to trust it as it stands.
void note_model(const std::string& name, const report::ModelUse& model, Notes& notes);

/// Notes that a model's compliance counts beyond springs that a design does not state.
void note_springs(const report::ModelUse& model, bool states_springs, Notes& notes);

/// Why no teeth can keep a limit of lost motion with what the model adds to theirs; "" where they
/// can.
std::string unreachable_lost_motion(const optimize::Specification& stated, const Model& model);

}  // namespace gear3k::app
