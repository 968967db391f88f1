#pragma once
// The extended model that a result was made with.

#include <string>
#include <vector>

#include "calibrate/model/extended_model.hpp"
#include "io/text/json.hpp"

namespace gear3k::report {

/// A model as a command used it.
struct ModelUse {
  std::string file;
  std::vector<calibrate::ExtendedModel> models;
  /// What optimize moved its limits of lost motion by; 0 elsewhere.
  double lost_motion_shift_rad = 0.0;
};

/// Each cause with its parameters in words: "load-independent drag (drag_constant, sun): torque
/// 0.021 Nm, sd 0.0003"; those that do not change the gearbox say so.
std::vector<std::string> cause_lines(const ModelUse& model);

/// A paragraph for tables that have no rows for it.
std::string model_paragraph(const ModelUse& model);

/// The same for a diagnosis, with what each model was measured on.  There sensors act too; sessions
/// and drift are those of other data.
std::string diagnosed_model_paragraph(const ModelUse& model);

/// Why not to trust a model as it stands, a line each: a diagnosis that was ambiguous or left
/// something unexplained, parameters that no gearbox shows.
std::vector<std::string> cautions(const ModelUse& model);

/// `model` of docs/interface.md: { "file", "causes": [...], "data": [...] }.
io::Json model_json(const ModelUse& model);

}  // namespace gear3k::report
