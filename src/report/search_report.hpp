#pragma once
// What `search` and `optimize` print and write.

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "actuator/co_design.hpp"
#include "actuator/felt.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/pareto_search.hpp"
#include "optimize/relaxed_limits.hpp"
#include "optimize/zero_shift.hpp"
#include "report/co_design_report.hpp"
#include "report/fields.hpp"
#include "report/limit_price_report.hpp"
#include "report/model_change_report.hpp"
#include "report/model_report.hpp"
#include "report/result_tally.hpp"
#include "report/robust_report.hpp"
#include "report/rounding_report.hpp"

namespace gear3k::report {

/// "Best torque density: 467.1 Nm/kg" of what was asked for first; "" for an efficiency, which the
/// table of a design has.
std::string objective_line(const optimize::Specification& spec, const optimize::RefinedSet& best);

/// Counts of a tooth search in one paragraph.
std::string search_counts_text(const optimize::Specification& spec,
                               const optimize::ToothSearchResult& search);

/// Ranked tooth sets at zero profile shift, those that the ranking keeps.
/// @param search  the counts of the search that they are from
std::string search_table(const optimize::Specification& spec,
                         const optimize::ToothSearchResult& search,
                         optimize::ZeroShiftRanking& ranking);
/// The same as CSV and JSON, piece by piece.
/// @param out  called with one piece of the text after the other
void write_search_csv(optimize::ZeroShiftRanking& ranking,
                      const std::function<void(std::string_view)>& out);
void write_search_json(const optimize::Specification& spec,
                       const optimize::ToothSearchResult& search,
                       optimize::ZeroShiftRanking& ranking,
                       const std::function<void(std::string_view)>& out);

/// Columns of gearbox and motor together.
inline constexpr std::array<const char*, 2> kCoDesignColumns{"cycle_energy_j", "motor"};

/// Columns of refined.csv beyond those that are always there.
struct RefinedColumns {
  bool model = false;           ///< eta_b_model, eta_f_model
  bool tips = false;            ///< kS .. kR2: tip shortenings
  bool pressure_angle = false;  ///< pressure_angle_deg
  bool masses = false;          ///< mass_kg, inertia_kgm2
  /// b1_mm, b2_mm, torque_capacity_nm, torsional_stiffness_nm_per_rad; with masses
  /// torque_density_nm_per_kg.
  bool strength = false;
  bool grid = false;     ///< grid_cut
  bool cutters = false;  ///< cutter_R1_teeth, cutter_R2_teeth; 0: not chosen
  /// kCoDesignColumns; null: none of them.
  const actuator::CoDesign* co_design = nullptr;
};
RefinedColumns refined_columns(const optimize::Specification& spec);
/// Names of the columns, in their order.
std::vector<std::string> refined_column_names(const RefinedColumns& columns);
/// The columns of one refined set that have a value.
std::vector<FieldRow> refined_values(const optimize::OptimizeResult& result,
                                     const optimize::RefinedSet& set,
                                     const RefinedColumns& columns);

/// refined.csv: a row for every tooth set, in the order of the search; those that an interrupted
/// run did not reach have none.
/// @param out  called with one piece of the text after the other
void write_refined_csv(const optimize::OptimizeResult& result, const RefinedColumns& columns,
                       const std::function<void(std::string_view)>& out);
/// pareto.csv: the same columns for the sets of result.pareto.
std::string pareto_csv(const optimize::OptimizeResult& result, const RefinedColumns& columns);

/// Name of the DESIGN file of a row of the front, counted from 0: front_01.toml.
std::string front_file_name(std::size_t row);
/// pareto.csv of a list of objectives: the same columns, then each objective in its unit, and
/// design_file.
std::string pareto_csv(const optimize::Specification& spec, const optimize::ParetoFront& front);
std::string pareto_table(const optimize::Specification& spec, const optimize::ParetoFront& front);

/// What may differ from run to run, kept apart in summary.json.
struct RunFacts {
  double wall_time_s = 0.0;
  int threads = 1;
  /// Why it was not asked which limits would have to give way; "": it was, or need not be.
  std::string not_relaxed{};
  bool interrupted = false;  ///< a part of the run was ended
  /// Of the files of the task, and the program's version.
  std::string task_fingerprint{};
};
/// @param model  with which the sets were judged; null: none
/// @param front  of several objectives; null: none was asked for
/// @param stated_limits  before they were tightened; null: those of the specification
/// @param rounding  of the best design; null: it was not asked for
/// @param held  what holds the best designs back; null: there is none
/// @param co_design  the motor of the best design; null: no motor was asked for
/// @param comparison  of the best designs without and with the model; null: no model
/// @param relaxed  what would give a design; null: there is one, or none was sought
/// @param felt  limits of what is felt at the best design's output; null: none are known
io::Json summary_json(const optimize::Specification& spec, const optimize::OptimizeResult& result,
                      const ResultTally& tally, const RunFacts& facts,
                      const ModelUse* model = nullptr, const optimize::ParetoFront* front = nullptr,
                      const RobustRun* robust = nullptr,
                      const ModelComparison* comparison = nullptr,
                      const design::Limits* stated_limits = nullptr,
                      const HeldBackReport* held = nullptr,
                      const optimize::Rounding* rounding = nullptr,
                      const CoDesignReport* co_design = nullptr,
                      const std::vector<actuator::LimitCheck>* felt = nullptr,
                      const optimize::RelaxedLimits* relaxed = nullptr);

}  // namespace gear3k::report
