#pragma once
// Threads over a series of random gearboxes, with the same sums whatever their number.

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "numerics/parallel.hpp"

namespace gear3k::backlash {

/// Called by the calling thread now and then, with the number of gearboxes done; false ends the
/// series there.
using SeriesProgress = std::function<bool(std::uint64_t done)>;

/// Gearboxes whose sums one thread takes in order, and chunks between two calls of the progress.
inline constexpr std::uint64_t kChunkGearboxes = 4096;
inline constexpr std::uint64_t kWaveChunks = 64;

/// Runs worker.run(first, count) for every chunk of [0, samples), each thread with a worker of its
/// own, and merge(sums) in the order of chunks.
/// @param workers  one for each of omp_get_max_threads()
/// @returns gearboxes done
template <class Worker, class Merge>
std::uint64_t run_in_chunks(std::uint64_t samples, std::vector<Worker>& workers,
                            const SeriesProgress& progress, Merge merge) {
  using Sums = decltype(workers.front().run(std::uint64_t{}, std::uint64_t{}));
  const std::uint64_t chunks = (samples + kChunkGearboxes - 1) / kChunkGearboxes;
  std::vector<Sums> sums(std::min(chunks, kWaveChunks), workers.front().run(0, 0));
  std::uint64_t done = 0;
  for (std::uint64_t wave = 0; wave < chunks; wave += kWaveChunks) {
    const std::uint64_t end = std::min(chunks, wave + kWaveChunks);
    numerics::parallel_for(end - wave, [&](std::size_t k) {
      const std::uint64_t first = (wave + k) * kChunkGearboxes;
      auto& worker = workers[static_cast<std::size_t>(omp_get_thread_num())];
      sums[k] = worker.run(first, std::min(kChunkGearboxes, samples - first));
    });
    for (std::uint64_t chunk = wave; chunk < end; ++chunk) merge(sums[chunk - wave]);
    done = std::min(samples, end * kChunkGearboxes);
    if (progress && !progress(done)) break;
  }
  return done;
}

}  // namespace gear3k::backlash
