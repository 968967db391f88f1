#include "backlash/turn_yield.hpp"

#include <algorithm>
#include <atomic>
#include <vector>

#include "backlash/random_teeth.hpp"
#include "numerics/parallel.hpp"

namespace gear3k::backlash {

TurnYield turn_yield(const ClearanceModel& model, const train::ToothSet& z,
                     const TurnYieldOptions& options) {
  const RandomGearbox random(model, options.scatter, options.seed);
  const OctaveTable numbers = number_table(options.scatter);
  const TurnWindow window = turn_window(z);
  const std::vector<TurningPlays::Angles> angles = turning_angles(
      TurningPlays(model, z, std::vector<DeviationValue>(model.deviations.size())), window);
  std::atomic<std::uint64_t> assembled = 0;
  std::atomic<std::uint64_t> within = 0;
  numerics::parallel_for(options.gearboxes, [&](std::size_t i) {
    const ToothErrors teeth = random_teeth(
        model, z, {.seed = options.seed, .gearbox = i, .scatter = options.scatter}, numbers);
    const Turn one =
        turn(model.levers, TurningPlays(model, z, random.deviations(i), teeth), window, angles);
    if (one.jams()) return;
    ++assembled;
    if (!options.limit_rad || std::ranges::all_of(one.points, [&](const TurnPoint& point) {
          return point.lost_motion_rad() <= *options.limit_rad;
        })) {
      ++within;
    }
  });
  return {.gearboxes = options.gearboxes,
          .assembled = proportion(assembled, options.gearboxes),
          .yield = proportion(within, options.gearboxes)};
}

}  // namespace gear3k::backlash
