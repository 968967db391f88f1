#include "strength/load_cycles.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "geometry/scalar.hpp"

namespace gear3k::strength {

template <class T>
LoadCycles<T> load_cycles(const TrainTurns<T>& turns, int planets, bool same_flank) {
  if (planets < 1) {
    throw std::invalid_argument(
        fmt::format("load cycles: planets = {}, allowed: 1 or more", planets));
  }
  const double n = planets;
  const T planet = magnitude(turns.planet_rolling);
  return {.sun = n * magnitude(T(turns.sun - turns.carrier)),
          .planet1 = same_flank ? T(2.0 * planet) : planet,
          .fixed_ring = n * magnitude(turns.carrier),
          .planet2 = planet,
          .output_ring = n * magnitude(T(turns.carrier - turns.output))};
}

#define INSTANTIATE(T) template LoadCycles<T> load_cycles<T>(const TrainTurns<T>&, int, bool);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
