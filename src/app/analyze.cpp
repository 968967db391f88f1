#include "app/analyze.hpp"

#include <utility>

#include "app/evaluate.hpp"

namespace gear3k::app {

Analysis analyze(const AnalyzeRequest& request) {
  Notes notes;
  design::Design design =
      request.model ? with_model(request.design, *request.model, notes) : request.design;
  design::Evaluation evaluation = evaluate(design, request.source);
  evaluation.notes.insert(evaluation.notes.end(), notes.begin(), notes.end());
  design::Sensitivities sensitivities = design::sensitivities(design);
  std::optional<design::BuiltSeries> series = design::table_series(design);
  std::optional<design::TorqueAngleCurve> curve = torque_angle(design, evaluation);
  return {.design = std::move(design),
          .evaluation = std::move(evaluation),
          .sensitivities = std::move(sensitivities),
          .series = std::move(series),
          .torque_angle = std::move(curve),
          .model_notes = std::move(notes)};
}

design::PairEvaluation mesh(const MeshRequest& request) {
  return evaluate(request.pair, request.source);
}

}  // namespace gear3k::app
