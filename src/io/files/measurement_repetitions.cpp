#include "io/files/measurement_repetitions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "calibrate/measurement/left_out_rows.hpp"
#include "calibrate/measurement/noise.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "io/text/fnv_hash.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

namespace {

using calibrate::MeasurementSet;
using calibrate::Observation;

/// What two rows of different files have in common when one is a copy; the run may be named anew.
auto values_of(const Observation& o) {
  const calibrate::Condition& c = o.condition;
  return std::array<double, 13>{static_cast<double>(c.direction),
                                c.sun_speed_rad_s,
                                c.output_torque_Nm,
                                static_cast<double>(c.rotation),
                                c.test_torque_Nm,
                                static_cast<double>(c.driving_teeth),
                                static_cast<double>(c.driven_teeth),
                                c.module_m,
                                c.output_angle_rad,
                                c.temperature_K,
                                c.cycles,
                                o.response,
                                o.sigma};
}

bool same_values(const Observation& a, const Observation& b) {
  const auto x = values_of(a), y = values_of(b);
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (x[k] != y[k] && !(std::isnan(x[k]) && std::isnan(y[k]))) return false;
  }
  return true;
}

/// Whether rows that differ have, nearly all of them, a value of their own.
bool tells_rows_apart(std::vector<double> value, const std::vector<char>& repetition) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < value.size(); ++k) {
    if (repetition[k] == 0 && !std::isnan(value[k])) value[kept++] = value[k];
  }
  value.resize(kept);
  std::ranges::sort(value);
  const auto own =
      static_cast<std::size_t>(std::unique(value.begin(), value.end()) - value.begin());
  constexpr std::size_t kOf = 10, kMost = 9;
  return own >= 2 && kOf * own >= kMost * kept;
}

/// Whether readings are so fine that none comes twice by chance.
bool is_fine(const MeasurementSet& set) {
  constexpr double kSteps = 1e4;
  calibrate::ValueRange range;
  for (const Observation& row : set.rows) range.extend(row.response);
  return range.varies() && range.high - range.low >= kSteps * calibrate::resolution_of(set);
}

/// Whether two files may hold the same measurement: other gearboxes of a series run one programme.
bool same_unit(const MeasurementSet& set, int a, int b) {
  return set.units.empty() ||
         set.units[static_cast<std::size_t>(a)] == set.units[static_cast<std::size_t>(b)];
}

}  // namespace

void RowTexts::add(std::string_view line, const CsvFields& fields) {
  std::uint64_t hash = kHashBasis;
  for (std::size_t k = 0; k < is_label_.size(); ++k) {
    const std::string_view field = trimmed(fields.values()[k]);
    const std::optional<double> value = is_label_[k] != 0 ? std::nullopt : csv_number(field);
    hash = value ? hashed(hash, *value) : hashed(hash, field);
    hash = (hash ^ 0xFFU) * kHashPrime;
  }
  lines_.push_back(line);
  hash_.push_back(hash);
}

bool RowTexts::same(std::size_t a, std::size_t b) const {
  CsvFields left, right;
  left.split(lines_[a]);
  right.split(lines_[b]);
  for (std::size_t k = 0; k < is_label_.size(); ++k) {
    const std::string_view x = trimmed(left.values()[k]), y = trimmed(right.values()[k]);
    if (x == y) continue;
    if (is_label_[k] != 0) return false;
    const std::optional<double> u = csv_number(x), v = csv_number(y);
    if (!u || !v || *u != *v) return false;
  }
  return true;
}

std::vector<char> RowTexts::repetitions() const {
  std::vector<std::uint32_t> order(hash_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(hash_[a], a) < std::pair(hash_[b], b);
  });
  std::vector<char> marked(order.size(), 0);
  for (std::size_t first = 0, k = 1; k < order.size(); ++k) {
    if (hash_[order[k]] != hash_[order[first]]) {
      first = k;
    } else if (same(order[first], order[k])) {
      marked[order[k]] = 1;
    }
  }
  return marked;
}

void leave_out_copies(MeasurementSet& set, const std::vector<char>& repetition) {
  if (std::ranges::count(repetition, 1) == 0) return;
  std::vector<char> copy(repetition.size(), 0);
  const auto mark = [&](const std::vector<double>& value) {
    for (std::size_t k = 0; k < copy.size(); ++k) {
      if (repetition[k] != 0 && !std::isnan(value[k])) copy[k] = 1;
    }
  };
  const auto column = [&](double calibrate::Condition::*member) {
    std::vector<double> value;
    value.reserve(set.rows.size());
    for (const Observation& row : set.rows) value.push_back(row.condition.*member);
    return value;
  };
  mark(column(&calibrate::Condition::time_s));
  std::vector<std::vector<double>> others{column(&calibrate::Condition::output_angle_rad),
                                          column(&calibrate::Condition::cycles)};
  for (const auto& covariate : set.covariates) others.push_back(covariate.value);
  for (const std::vector<double>& value : others) {
    if (tells_rows_apart(value, repetition)) mark(value);
  }
  if (is_fine(set)) copy = repetition;
  const auto kept = std::ranges::count(repetition, 1) - std::ranges::count(copy, 1);
  if (kept > 0) {
    set.notes.push_back(fmt::format(
        "{}: {} the same in every column as one before, kept as {}: no time_s or output_angle_deg "
        "tells copies from repeats",
        set.files[0], kept == 1 ? "1 row is" : fmt::format("{} rows are", kept),
        kept == 1 ? "a repeat" : "repeats"));
  }
  leave_out_noted(set, copy, "the same in every column as a row before");
}

std::vector<char> copies_of_earlier_files(const MeasurementSet& set) {
  std::vector<char> marked(set.rows.size(), 0);
  if (set.files.size() < 2) return marked;
  std::vector<std::uint32_t> order;
  order.reserve(set.rows.size());
  for (std::uint32_t k = 0; k < set.rows.size(); ++k) {
    if (!std::isnan(set.rows[k].condition.time_s)) order.push_back(k);
  }
  const auto key = [&](std::uint32_t k) {
    return std::tuple(set.rows[k].condition.time_s, set.rows[k].response, k);
  };
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Observation& row = set.rows[order[k]];
    for (std::size_t j = k; j-- > 0;) {
      const Observation& other = set.rows[order[j]];
      if (other.condition.time_s != row.condition.time_s || other.response != row.response) break;
      const bool elsewhere = other.file != row.file && same_unit(set, other.file, row.file);
      if (elsewhere && marked[order[j]] == 0 && same_values(other, row)) {
        marked[order[k]] = 1;
        break;
      }
    }
  }
  return marked;
}

void leave_out_noted(MeasurementSet& set, const std::vector<char>& marked,
                     std::string_view reason) {
  const auto count = std::ranges::count(marked, 1);
  if (count == 0) return;
  set.notes.push_back(fmt::format("{}: {} left out, {}", calibrate::places_of(set, marked),
                                  count == 1 ? "row" : "rows", reason));
  calibrate::leave_out(set, marked);
}

}  // namespace gear3k::io
