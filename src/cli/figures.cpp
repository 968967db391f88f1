#include "cli/figures.hpp"

#include <string_view>

#include "io/text/diagnostics.hpp"
#include "io/text/gnuplot.hpp"
#include "io/text/json.hpp"

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

std::string with_missing_figures(const std::string& json, const Figures& figures) {
  if (figures.missing.empty()) return json;
  io::Json missing = io::Json::array();
  for (const auto& [file, cause] : figures.missing) {
    missing.push_back({{"file", file}, {"cause", cause}});
  }
  // The members of one object after those of the other: "{ ... \n}\n" and "{\n ... \n}\n".
  const std::string members = io::Json{{"missing_figures", missing}}.text().substr(1);
  return json.substr(0, json.size() - std::string_view("\n}\n").size()) + ',' + members;
}

}  // namespace gear3k::cli
