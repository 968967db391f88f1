#pragma once
// Figures of a diagnosis, as scripts for gnuplot.

#include <vector>

#include "calibrate/diagnosis.hpp"
#include "report/plot.hpp"

namespace gear3k::report {

/// Above as many rows, figures show every n-th of them and say so.
inline constexpr std::size_t kMostPlottedRows = 4000;

/// measured_vs_simulated: both against each other, before and after the causes;
/// residuals: along what the first cause acts on (else what is left, else the load), before and
/// after, over the angle of the body for what repeats with it;
/// evidence: of each candidate by itself.
/// With several kinds the names end with the kind.
std::vector<Plot> diagnosis_plots(const std::vector<calibrate::Diagnosis>& diagnoses,
                                  const std::vector<calibrate::MeasurementSet>& sets);

}  // namespace gear3k::report
