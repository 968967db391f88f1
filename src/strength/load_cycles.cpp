#include "strength/load_cycles.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "geometry/scalar.hpp"

namespace gear3k::strength {

namespace {
template <class T>
T turns_of(const T& x) {
  return value_of(x) < 0.0 ? T(-x) : x;
}
}  // namespace

template <class T>
LoadCycles<T> load_cycles(const TrainTurns<T>& turns, int planets, bool same_flank) {
  if (planets < 1) {
    throw std::invalid_argument(
        fmt::format("load cycles: planets = {}, allowed: 1 or more", planets));
  }
  const double n = planets;
  const T planet = turns_of(turns.planet_rolling);
  return {.sun = n * turns_of(T(turns.sun - turns.carrier)),
          .planet1 = same_flank ? T(2.0 * planet) : planet,
          .fixed_ring = n * turns_of(turns.carrier),
          .planet2 = planet,
          .output_ring = n * turns_of(T(turns.carrier - turns.output))};
}

#define INSTANTIATE(T) template LoadCycles<T> load_cycles<T>(const TrainTurns<T>&, int, bool);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
