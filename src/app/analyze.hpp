#pragma once
// Everything known about one gearbox, or one pair of gears.

#include <optional>
#include <string>

#include "app/model.hpp"
#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "design/sensitivity.hpp"
#include "design/torque_angle_curve.hpp"

namespace gear3k::app {

struct AnalyzeRequest {
  design::Design design;
  std::optional<Model> model = std::nullopt;  ///< what measurements add to the simulation
  std::string source = "design";              ///< stands for the design in messages
};

struct Analysis {
  design::Design design;  ///< with the model
  design::Evaluation evaluation;
  design::Sensitivities sensitivities;
  std::optional<design::BuiltSeries> series;  ///< where the design has tolerances
  /// Torque and angle of the output, where the design states [strength]; why not is a note.
  std::optional<design::TorqueAngleCurve> torque_angle;
  Notes model_notes;  ///< also among the notes of the evaluation
};

/// Evaluates a design, with a model where there is one.
/// @throws io::InvalidInput where the geometry is not defined
Analysis analyze(const AnalyzeRequest& request);

struct MeshRequest {
  design::PairDesign pair;
  std::string source = "pair";  ///< stands for the pair in messages
};

/// Evaluates a pair of gears.
/// @throws io::InvalidInput where the geometry is not defined
design::PairEvaluation mesh(const MeshRequest& request);

}  // namespace gear3k::app
