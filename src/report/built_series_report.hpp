#pragma once
// How gearboxes built at random turn out, as printed and written.

#include <string>

#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "report/fields.hpp"
#include "report/plot.hpp"

namespace gear3k::report {

/// Yield, jamming, distribution of the lost motion, worst case, rooms at first contact, and which
/// tolerance to tighten first.
std::string built_series_table(const design::BuiltSeries& series);

/// "built" of docs/interface.md; rows of the figures that say most.
Fields built_series_fields(const design::BuiltSeries& series);

/// What `tolerances` says as JSON: the limits of a gearbox within its tolerances and the series.
io::Json tolerances_json(const design::Evaluation& e, const design::BuiltSeries& series);

/// "from_arcmin,to_arcmin,gearboxes" of the lost motion of those that assemble.
std::string lost_motion_histogram_csv(const design::BuiltSeries& series);

/// "tolerance,half_width_um,..." one row per source.
std::string tolerance_shares_csv(const design::BuiltSeries& series);

/// Histogram of the lost motion with limit, closed form and worst case.
Plot lost_motion_plot(const std::string& name, const design::BuiltSeries& series);

/// Shares of the variance by tolerance.
Plot tolerance_shares_plot(const std::string& name, const design::BuiltSeries& series);

}  // namespace gear3k::report
