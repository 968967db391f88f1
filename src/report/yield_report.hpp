#pragma once
// How gearboxes built at random turn out, as printed and written.

#include <string>

#include "design/built_series.hpp"
#include "io/text/json.hpp"
#include "report/plot.hpp"

namespace gear3k::report {

/// Yield, jamming, distribution of the lost motion, worst case, rooms at first contact, and which
/// tolerance to tighten first.
std::string yield_table(const design::BuiltSeries& series);

/// Members of the object "built" of docs/interface.md.
io::Json yield_json(const design::BuiltSeries& series);

/// Rows for analysis_csv(): quantity, subject, value, unit.
std::string yield_csv(const design::BuiltSeries& series);

/// "from_arcmin,to_arcmin,gearboxes" of the lost motion of those that assemble.
std::string lost_motion_histogram_csv(const design::BuiltSeries& series);

/// "tolerance,half_width_um,..." one row per source.
std::string tolerance_shares_csv(const design::BuiltSeries& series);

/// Histogram of the lost motion with limit, closed form and worst case.
Plot lost_motion_plot(const std::string& name, const design::BuiltSeries& series);

/// Shares of the variance by tolerance.
Plot tolerance_shares_plot(const std::string& name, const design::BuiltSeries& series);

}  // namespace gear3k::report
