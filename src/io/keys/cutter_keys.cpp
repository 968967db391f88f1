#include "io/keys/cutter_keys.hpp"

#include <fmt/format.h>

namespace gear3k::io {

std::vector<Key<geometry::PinionCutter>> cutter_keys() {
  using Cutter = geometry::PinionCutter;
  const auto cuts = [](const Cutter& cutter, std::size_t) { return cutter.teeth > 0; };
  return {make_key<Cutter>(
              {.path = "teeth",
               .type = KeyType::kInteger,
               .min = 3,
               .max = 2000,
               .default_text = "none",
               .help = "teeth of the pinion cutter that shapes a ring, fewer than the "
                       "ring's; without it the ring's root is filleted by an arc of "
                       "rack.root_radius"},
              [](auto& t, std::size_t) -> auto& { return t.teeth; }, cuts),
          make_key<Cutter>(
              {.path = "profile_shift",
               .unit = units::Unit::kModules,
               .min = -5.0,
               .max = 5.0,
               .default_text = "with a cutter: 0",
               .help = "profile shift of the cutter as it is ground"},
              [](auto& t, std::size_t) -> auto& { return t.profile_shift; }, cuts),
          make_key<Cutter>(
              {.path = "tip_radius",
               .unit = units::Unit::kModules,
               .min = 0.0,
               .max = 1.0,
               .default_text = "with a cutter: 0",
               .help = "rounding of the cutter's tip corners"},
              [](auto& t, std::size_t) -> auto& { return t.tip_radius; }, cuts)};
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
