#include "io/keys/cutter_keys.hpp"

#include <fmt/format.h>

namespace gear3k::io {

std::vector<Key<geometry::PinionCutter>> cutter_keys() {
  using Cutter = geometry::PinionCutter;
  const auto cuts = [](const Cutter& cutter, std::size_t) { return cutter.teeth > 0; };
  return {
      make_key<Cutter>(integer("teeth", within(3, 2000), "none",
                               "teeth of the pinion cutter that shapes a ring, fewer than the "
                               "ring's; without it the ring's root is filleted by an arc of "
                               "rack.root_radius"),
                       &Cutter::teeth, cuts),
      make_key<Cutter>(number("profile_shift", units::Unit::kModules, within(-5.0, 5.0),
                              "with a cutter: 0", "profile shift of the cutter as it is ground"),
                       &Cutter::profile_shift, cuts),
      make_key<Cutter>(number("tip_radius", units::Unit::kModules, within(0.0, 1.0),
                              "with a cutter: 0", "rounding of the cutter's tip corners"),
                       &Cutter::tip_radius, cuts)};
}

void check_cutter(const std::string& path, const geometry::PinionCutter& cutter, int ring_teeth,
                  FileReading& reading) {
  for (const char* key : {".profile_shift", ".tip_radius"}) {
    if (reading.has(path + key) && !reading.stated(path + ".teeth")) {
      reading.error_at(path + key, fmt::format("{0}{1} without {0}.teeth: allowed: with the "
                                               "cutter's number of teeth",
                                               path, key));
    }
  }
  if (cutter.teeth > 0 && ring_teeth > 0 && cutter.teeth >= ring_teeth) {
    reading.error_at(path + ".teeth",
                     fmt::format("{}.teeth = {}: allowed: below the {} of the ring", path,
                                 cutter.teeth, ring_teeth));
  }
}

}  // namespace gear3k::io
