#pragma once
// The directional-impedance thesis: its single-tooth loss model as maps over tooth counts, its
// corrected model against its own measurements (Table 3.1), refits of it, and the ledger of its
// errata, computed.

#include <string>
#include <vector>

#include "papers/ledger.hpp"

namespace gear3k::papers {

/// A row of Table 3.1.
struct MeasuredPairLoss {
  int driving_teeth = 0, driven_teeth = 0;
  double loss = 0.0;  ///< λ = 1 − slope of τ_out/N against τ_in
};

/// Figures that the thesis prints.
struct ThesisStatements {
  double module_m = 0.0;
  double pressure_angle_rad = 0.0;
  double map_friction = 0.0;
  double corrected_friction = 0.0, corrected_symmetric_scale = 0.0, corrected_offset = 0.0,
         corrected_skew_factor = 0.0;
  double largest_model_skew_percent = 0.0;
  double single_pair_contact_ratio = 0.0;
  int small_skew_teeth = 0;
  double small_skew_percent = 0.0;
  double sensor_sensitivity_error_percent = 0.0;
  double mesh_rate_1_s = 0.0;  ///< teeth a second
  double largest_asymmetry_percent = 0.0, smaller_asymmetry_percent = 0.0;
};

struct ThesisSources {
  std::vector<MeasuredPairLoss> measured;
  ThesisStatements statements;
};

/// Mean torque losses of the single-tooth model over tooth counts; full teeth without shift, so
/// that the module does not matter.
struct LossMap {
  struct Point {
    int driving_teeth = 0, driven_teeth = 0;
    double loss = 0.0, symmetric = 0.0, skew = 0.0;
    bool on_involutes = true;  ///< false: a tip reaches past the mate's tangent point
  };
  double friction = 0.0;
  std::vector<int> teeth;     ///< of either axis
  std::vector<Point> points;  ///< driving teeth slow, driven teeth fast
};

/// λ = symmetric_scale · symmetric(μ) + offset + skew_factor · skew(μ).
struct PairLossModel {
  std::string name, description;
  double friction = 0.0;  ///< μ
  double symmetric_scale = 1.0, offset = 0.0, skew_factor = 1.0;
  double rms_error = 0.0;  ///< √(mean of squared residuals over all rows)
};

struct PairLossRow {
  MeasuredPairLoss measured;
  std::vector<double> predicted;  ///< by each model, in the order of ThesisComparison::models
};

struct ThesisComparison {
  LossMap map;
  /// The model as it is, as the thesis corrects it, and two least-squares refits: of scale, offset
  /// and skew factor at the thesis's friction, and of friction, offset and skew factor.
  std::vector<PairLossModel> models;
  std::vector<PairLossRow> rows;
  std::vector<LedgerEntry> ledger;
};

/// Evaluates everything.
/// @throws std::invalid_argument when fewer than four rows are measured, when no pair is measured
///         in both directions, or when a pair has no defined geometry
ThesisComparison compare_thesis(const ThesisSources& sources);

}  // namespace gear3k::papers
