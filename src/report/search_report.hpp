#pragma once
// What `search` and `optimize` print and write.

#include <string>

#include "optimize/optimizer.hpp"
#include "optimize/zero_shift.hpp"
#include "report/model_report.hpp"

namespace gear3k::report {

/// Counts of a tooth search in one paragraph.
std::string search_counts_text(const optimize::Specification& spec,
                               const optimize::ToothSearchResult& search);

/// Ranked tooth sets at zero profile shift; the first `rows` of them.
std::string search_table(const optimize::Specification& spec,
                         const optimize::ToothSearchResult& search,
                         const std::vector<optimize::ZeroShiftSet>& sets, std::size_t rows);
std::string search_csv(const std::vector<optimize::ZeroShiftSet>& sets);
std::string search_json(const optimize::Specification& spec,
                        const optimize::ToothSearchResult& search,
                        const std::vector<optimize::ZeroShiftSet>& sets);

/// refined.csv: a row for every tooth set that was refined, in the order of the search.
/// @param by_model  with the columns eta_b_model and eta_f_model
std::string refined_csv(const optimize::OptimizeResult& result, bool by_model = false);
/// pareto.csv: the same columns for the sets of result.pareto.
std::string pareto_csv(const optimize::OptimizeResult& result, bool by_model = false);

/// What may differ from run to run, kept apart in summary.json.
struct RunFacts {
  double wall_time_s = 0.0;
  int threads = 1;
};
/// @param model  with which the sets were judged; null: none
std::string summary_json(const optimize::Specification& spec,
                         const optimize::OptimizeResult& result, const RunFacts& facts,
                         const ModelUse* model = nullptr);

/// Counts by status and reason, for the terminal.
std::string optimize_counts_text(const optimize::OptimizeResult& result);

/// Which constraint blocks a run without a feasible design, and by how much.
std::string blocking_text(const optimize::Specification& spec,
                          const optimize::OptimizeResult& result);

}  // namespace gear3k::report
