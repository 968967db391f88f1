#pragma once
// Series of gearboxes among what `diagnose` found: whose each difference is.

#include <string>

#include "calibrate/verdict/diagnosis.hpp"
#include "io/text/json.hpp"

namespace gear3k::report {

/// docs/interface.md, "UnitSeries"; null where no file states its gearbox.
io::Json unit_series_json(const calibrate::Diagnosis& d);

/// In words and as tables; "" where no file states its gearbox.
std::string unit_series_text(const calibrate::Diagnosis& d);

/// The gearbox that a row was measured on; "" where none is stated.
std::string gearbox_of(const calibrate::MeasurementSet& set, const calibrate::Observation& row);

}  // namespace gear3k::report
