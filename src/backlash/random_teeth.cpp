#include "backlash/random_teeth.hpp"

#include <Random123/philox.h>

namespace gear3k::backlash {

ToothErrors random_teeth(const ClearanceModel& model, const train::ToothSet& z,
                         const ToothSeries& series, const OctaveTable& numbers) {
  // RandomGearbox counts its calls in the second word from 0; gears stand in the third from 1.
  const r123::Philox4x64::key_type key{{series.seed, 0}};
  ToothErrors errors;
  for (const ToleranceSource& source : model.sources) {
    if (source.kind != ToleranceKind::kSinglePitch) continue;
    const auto gear = static_cast<std::size_t>(source.gear);
    auto& flanks = errors.flank_m[gear];
    flanks.resize(flank_count(z, source.gear, model.planets));
    for (std::size_t i = 0; i < flanks.size(); ++i) {
      const r123::Philox4x64::ctr_type counter{{series.gearbox, i, gear + 1, 0}};
      const auto words = r123::Philox4x64()(counter, key);
      flanks[i] = source.half_width_m * numbers(static_cast<std::uint32_t>(words[0]));
    }
  }
  return errors;
}

}  // namespace gear3k::backlash
