#include "io/files/measurement_loops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "calibrate/measurement/loop_observations.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/fnv_hash.hpp"

namespace gear3k::io {

namespace {

using calibrate::Kind, calibrate::MeasurementSet;

std::vector<calibrate::LockedShaftRecord> records_of(std::vector<TorqueAngleFile> files,
                                                     const MeasurementSet& set) {
  std::vector<calibrate::LockedShaftRecord> records;
  records.reserve(files.size());
  for (TorqueAngleFile& file : files) {
    const auto place = std::ranges::find(set.files, file.path) - set.files.begin();
    records.push_back({.samples = {.time_s = std::move(file.time_s),
                                   .angle_rad = std::move(file.angle_rad),
                                   .torque_Nm = std::move(file.torque_Nm)},
                       .run = std::move(file.run),
                       .sun_locked = file.sun_locked,
                       .file = static_cast<int>(place),
                       .name = file.path});
  }
  return records;
}

}  // namespace

void read_loops(Measurements& data, double ratio) {
  const auto own = std::ranges::find(data.sets, Kind::kTorqueAngle, &MeasurementSet::kind);
  if (own == data.sets.end()) return;
  const calibrate::LoopObservations loops =
      calibrate::loop_observations(records_of(std::exchange(data.loops, {}), *own), ratio);
  if (loops.rows.empty()) {
    throw InvalidInput(
        fmt::format("{}: no loop could be measured, allowed: a torque that goes to and fro through "
                    "zero, with the loop closed\n{}\nto measure: {}",
                    fmt::join(own->files, ", "), fmt::join(loops.notes, "\n"),
                    fmt::join(loops.remedies, "; ")));
  }
  const auto pool = std::ranges::find(data.sets, Kind::kLostMotion, &MeasurementSet::kind);
  if (pool == data.sets.end()) {
    calibrate::add_loops(*own, loops, 0);
    return;
  }
  const auto offset = static_cast<int>(pool->files.size());
  pool->files.insert(pool->files.end(), own->files.begin(), own->files.end());
  pool->units.insert(pool->units.end(), own->units.begin(), own->units.end());
  pool->notes.insert(pool->notes.end(), own->notes.begin(), own->notes.end());
  calibrate::add_loops(*pool, loops, offset);
  pool->fingerprint = hashed_bytes(pool->fingerprint, own->fingerprint);
  data.sets.erase(own);
}

}  // namespace gear3k::io
