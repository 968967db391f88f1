#pragma once
// Numbers with their uncertainty, in as many digits as it leaves them.

#include <string>

#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::report {

/// "12.30 ± 0.15 Nm": a value and half its 95 % interval, to two digits of that; the interval
/// itself where it is lopsided by more than a tenth of its width; no interval where it is not
/// known.
std::string with_interval(const calibrate::ParameterResult& p);

/// "12.30 ± 0.15": a value and its standard deviation, both in the unit shown, to two digits of the
/// latter; without one where it is not known.
std::string deviation_text(double value, double deviation);

}  // namespace gear3k::report
