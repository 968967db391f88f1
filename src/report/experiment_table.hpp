#pragma once
// What to measure next.

#include <string>

#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::report {

/// What the next experiment separates, its conditions in the columns of DATA.csv with how often
/// each is measured, and its advice; "" where none is proposed.
std::string experiment_table(const calibrate::Diagnosis& d);

}  // namespace gear3k::report
