#pragma once
// What `analyze` and `mesh` print.

#include <optional>
#include <string>
#include <vector>

#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "design/sensitivity.hpp"
#include "design/tightest.hpp"
#include "design/torque_angle_curve.hpp"
#include "report/fields.hpp"
#include "report/model_report.hpp"
#include "report/table_choice.hpp"

namespace gear3k::report {

/// Tables for the terminal; failed checks come first.
/// @param s  of the same design; {} = not wanted
/// @param model  with which the design was evaluated; null: none
/// @param built  gearboxes built within the design's tolerances; null: none
/// @param curve  of the output's torque and angle; null: none
std::string analysis_table(const design::Evaluation& e, const design::Sensitivities& s,
                           const ModelUse* model = nullptr,
                           const design::BuiltSeries* built = nullptr,
                           const design::TorqueAngleCurve* curve = nullptr);
std::string analysis_table(const design::PairEvaluation& e);

/// The first screen and the sections that are asked for, or the whole table.
/// @param tightest  of design::tightest_checks()
/// @param outer_diameter_m  of design::stated_outer_diameter_m()
std::string analysis_text(const design::Evaluation& e,
                          const std::vector<design::TightestCheck>& tightest,
                          const TableChoice& choice, const design::Sensitivities& s,
                          const ModelUse* model = nullptr,
                          const design::BuiltSeries* built = nullptr,
                          const design::TorqueAngleCurve* curve = nullptr,
                          std::optional<double> outer_diameter_m = {});
std::string analysis_text(const design::PairEvaluation& e,
                          const std::vector<design::TightestCheck>& tightest,
                          const TableChoice& choice);

/// "Not checked: ..." in a line; "" where all is.
std::string not_checked_text(const design::Evaluation& e);
std::string not_checked_text(const design::PairEvaluation& e);

/// JSON by the contract of docs/interface.md.
io::Json analysis_json(const design::Evaluation& e, const design::Sensitivities& s,
                       const ModelUse* model = nullptr, const design::BuiltSeries* built = nullptr,
                       const design::TorqueAngleCurve* curve = nullptr);
io::Json analysis_json(const design::PairEvaluation& e);

/// The quantities of an evaluation, each listed once.
Fields analysis_quantities(const design::Evaluation& e);

/// CSV with the columns item, quantity, value, unit, limit, ok.
std::string analysis_csv(const design::Evaluation& e, const design::Sensitivities& s,
                         const design::BuiltSeries* built = nullptr,
                         const design::TorqueAngleCurve* curve = nullptr);
std::string analysis_csv(const design::PairEvaluation& e);

}  // namespace gear3k::report
