#pragma once
// The low-backlash paper's Figs. 6 to 8 as files and in words.

#include <string>
#include <vector>

#include "papers/paper_figures.hpp"

namespace gear3k::papers {

/// What the paper says of a figure, and what ours shows.
struct FigureStatement {
  std::string figure, paper;
  std::vector<std::string> ours;
};

/// Statements under a headline; the paper's words and ours.
std::string figures_text(const std::string& paper, const std::vector<FigureStatement>& statements,
                         const std::string& assumptions = "");

/// The statements for the end of the table that `reproduce` prints.
std::string figures_table(const PaperFigures& figures);

/// A figure's data; notes on what it shows are comment lines before the header.
struct FigureData {
  std::string name;  ///< of the file, without .csv
  std::string csv;
};
/// docs/interface.md, "Figures of `reproduce`".
std::vector<FigureData> figure_data(const PaperFigures& figures);

/// The refined set with the greatest η_b under one limit; null where none is feasible.
const optimize::RefinedSet* best_refined(const PaperFigures& figures, std::size_t limit);

}  // namespace gear3k::papers
