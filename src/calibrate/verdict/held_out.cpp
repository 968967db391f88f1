#include "calibrate/verdict/held_out.hpp"

#include <fmt/format.h>

namespace gear3k::calibrate {

HeldOut held_out_rows(const Problem& problem, const Hypothesis& h,
                      const std::vector<Levels>& levels) {
  HeldOut held{.blocks = holdout_blocks(problem.data, levels, h), .predicted = {}};
  held.predicted = predict_held_out(problem, h, held.blocks, shown_by_bends(h, held.blocks));
  forget_beyond(h, held.blocks, levels, held.predicted);
  return held;
}

std::string note_on_levels_in_sample() {
  return "a law of friction goes through every level of what was varied: no level could be left "
         "out, and what the model predicts between the levels was not measured";
}

std::string note_on_known_rows(std::size_t known, std::size_t rows) {
  return fmt::format(
      "the errors held out are of {} of {} rows: of the others, at the ends of what a law of free "
      "shape is a law of, the rest says nothing; do not use the model beyond these ends",
      known, rows);
}

}  // namespace gear3k::calibrate
