// Measurement files: read, or refused with InvalidInput, and nothing else.

#include <cstddef>
#include <cstdint>
#include <string>

#include "calibrate/measurement/impossible_rows.hpp"
#include "entry.hpp"
#include "io/files/measurement_file.hpp"
#include "io/files/measurement_loops.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/diagnostics.hpp"

using namespace gear3k;

FUZZER(csv)(const std::uint8_t* data, std::size_t size) {
  constexpr double kRatio = 96.2;
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    io::parse_csv(text, "fuzz.csv");
  } catch (const io::InvalidInput&) {
    // What a reader may do.
  }
  try {
    io::Measurements measurements = io::parse_measurements({{.path = "fuzz.csv", .text = text}});
    io::read_loops(measurements, kRatio);
    for (calibrate::MeasurementSet& set : measurements.sets) {
      static_cast<void>(calibrate::leave_out_impossible(set, kRatio));
    }
  } catch (const io::InvalidInput&) {
    // The same.
  }
  return 0;
}
