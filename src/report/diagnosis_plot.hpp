#pragma once
// Figures of a diagnosis, as scripts for gnuplot.

#include <string>
#include <vector>

#include "calibrate/verdict/diagnosis.hpp"
#include "report/plot.hpp"
#include "train/shaft_orders.hpp"

namespace gear3k::report {

/// Above as many rows, figures show every n-th of them and say so.
inline constexpr std::size_t kMostPlottedRows = 4000;

/// measured_vs_simulated: both against each other, before and after the causes;
/// residuals: along what the first cause acts on (else what is left, else the load), before and
/// after, over the angle of the body for what repeats with it;
/// evidence: of each candidate by itself;
/// periodogram: of what the causes leave, over the order per turn of the output, where the data
/// state angles over more than a turn; at most kMostPlottedOrders classes of orders, each with its
/// greatest power.
/// With several kinds the names end with the kind.
/// @param orders  of the shafts, to be marked in the periodogram
std::vector<Plot> diagnosis_plots(const std::vector<calibrate::Diagnosis>& diagnoses,
                                  const std::vector<calibrate::MeasurementSet>& sets,
                                  const std::vector<train::ShaftOrder>& orders = {});

inline constexpr std::size_t kMostPlottedOrders = 1000;

/// Every name that diagnosis_plots() may give, whatever the kinds.
std::vector<std::string> diagnosis_plot_names();

}  // namespace gear3k::report
