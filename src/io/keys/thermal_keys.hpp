#pragma once
// Keys of the table [thermal]: temperature and moisture; the same in DESIGN and SPEC.

#include <array>
#include <optional>
#include <vector>

#include "design/checks.hpp"
#include "io/keys/key_registry.hpp"
#include "io/keys/limit_keys.hpp"
#include "train/thermal_growth.hpp"

namespace gear3k::io {

struct TemperatureLimits {
  double least_K = 0.0, greatest_K = 0.0;
};

/// What a file states of temperature and moisture.
struct ThermalInput {
  struct Part {
    std::optional<double> expansion_1_K;
    train::MoistureStrain swelling;
  };
  std::optional<TemperatureLimits> temperature;
  double reference_K = train::ThermalRange{}.reference_K;
  std::array<Part, train::kGearCount> gears{};
  Part carrier;
};

std::vector<Key<ThermalInput>> thermal_keys();

/// What the keys say together: the range with an expansion of every part, or nothing; and the
/// limits that it brings where the file does not state or switch them.
std::optional<train::ThermalRange> finish_thermal(const ThermalInput& input,
                                                  const LimitInput& stated, design::Limits& limits,
                                                  FileReading& reading);

/// What a file states of this range; with a range the limits that it would bring and that are off
/// are switched off.
ThermalInput stated_thermal(const std::optional<train::ThermalRange>& range,
                            const design::Limits& limits, LimitInput& stated);

}  // namespace gear3k::io
