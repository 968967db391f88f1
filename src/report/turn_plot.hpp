#pragma once
// Figure of lost motion and transmission error over the output's angle, as a script for gnuplot.

#include "report/plot.hpp"
#include "report/turn_report.hpp"

namespace gear3k::report {

/// Above as many angles a panel shows bands from the least to the greatest value of neighbouring
/// ones.
inline constexpr std::size_t kMostTurnPoints = 1500;

/// Lost motion and transmission errors over the window, and both over its beginning, one revolution
/// of the carrier.
/// @param carrier_order  revolutions of the carrier per revolution of the output
Plot turn_plot(const TurnResult& result, double carrier_order);

}  // namespace gear3k::report
