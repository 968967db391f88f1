#include "cli/figures.hpp"

#include "io/text/diagnostics.hpp"
#include "io/text/gnuplot.hpp"

namespace gear3k::cli {

Figures draw(const std::vector<report::Plot>& plots) {
  Figures figures;
  for (const report::Plot& plot : plots) {
    const std::string file = plot.name + ".svg";
    try {
      figures.files.push_back({.path = file, .text = io::run_gnuplot(plot.script)});
    } catch (const io::InvalidInput& error) {
      figures.missing.push_back({.file = file, .cause = error.what()});
    }
  }
  return figures;
}

std::string with_missing_figures(io::Json json, const Figures& figures) {
  for (const auto& [file, cause] : figures.missing) {
    json["missing_figures"].push_back({{"file", file}, {"cause", cause}});
  }
  return json.text();
}

}  // namespace gear3k::cli
