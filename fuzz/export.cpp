// `export` of any DESIGN with coarse contours.

#include "app/analyze.hpp"
#include "drawing/drawing.hpp"
#include "drawing/dxf_drawing.hpp"
#include "drawing/svg_drawing.hpp"
#include "entry.hpp"
#include "io/files/design_file.hpp"
#include "work.hpp"

using namespace gear3k;

FUZZER(export)(const std::uint8_t* data, std::size_t size) {
  return fuzz::done_or_refused(data, size, [](const std::string& text) {
    design::Design design = io::parse_design(text, fuzz::kName);
    design.tolerances.reset();
    const auto evaluated = design::evaluate(design);
    const auto* evaluation = std::get_if<design::Evaluation>(&evaluated);
    if (evaluation == nullptr) return;
    const drawing::DrawingSet set = drawing::make_drawings(design, *evaluation, 1e-4);
    for (const drawing::Drawing& d : set.drawings) {
      drawing::dxf_text(d);
      drawing::svg_text(d);
    }
  });
}
