#include "calibrate/fit/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "calibrate/fit/screen.hpp"
#include "calibrate/measurement/commanded_torque.hpp"
#include "calibrate/measurement/noise.hpp"
#include "numerics/distributions.hpp"

namespace gear3k::calibrate {
namespace {

/// A reading in steps, what the simulation foretells, and how great that is beside the greatest.
struct SteppedRow {
  double reading = 0.0, expected = 0.0, size = 0.0;
};

/// Deviation before rounding, in steps: of all rows alike, and of the greatest row by its size.
struct AnalogNoise {
  double constant = 0.0, in_proportion = 0.0;

  [[nodiscard]] double of(const SteppedRow& row) const {
    return std::hypot(constant, in_proportion * row.size);
  }
};

/// −ln of the likelihood of rounded readings; what is far off counts as one in a hundred thousand.
double unlikelihood(const std::vector<SteppedRow>& rows, const AnalogNoise& noise) {
  constexpr double kFloor = 1e-5;
  double sum = 0.0;
  for (const SteppedRow& row : rows) {
    const double sigma = noise.of(row), off = row.reading - row.expected;
    sum -= std::log(kFloor + numerics::normal_cdf((off + 0.5) / sigma) -
                    numerics::normal_cdf((off - 0.5) / sigma));
  }
  return sum;
}

AnalogNoise likeliest_noise(const std::vector<SteppedRow>& all) {
  // As many rows tell it well enough.
  constexpr std::size_t kEnough = 2000;
  std::vector<SteppedRow> rows;
  const std::size_t stride = (all.size() + kEnough - 1) / kEnough;
  rows.reserve(all.size() / stride + 1);
  for (std::size_t i = 0; i < all.size(); i += stride) rows.push_back(all[i]);
  // 0.03 to 4 steps; in proportion up to 20, as rows far from the greatest have less.
  constexpr double kLeast = 0.03, kFactor = 1.35;
  constexpr int kConstants = 17, kShares = 23;
  AnalogNoise best;
  double least = HUGE_VAL;
  for (int k = 0; k < kConstants; ++k) {
    for (int l = 0; l < kShares; ++l) {
      const AnalogNoise noise{.constant = kLeast * std::pow(kFactor, k),
                              .in_proportion = l == 0 ? 0.0 : kLeast * std::pow(kFactor, l)};
      const double value = unlikelihood(rows, noise);
      if (!(value < least)) continue;
      least = value;
      best = noise;
    }
  }
  return best;
}

/// Whether loads take more values than responses: then those were read, and these were set.
bool load_was_read(const MeasurementSet& data) {
  if (data.kind != Kind::kTransmission) return false;
  std::set<double> responses, loads;
  for (const Observation& row : data.rows) {
    responses.insert(row.response);
    loads.insert(row.condition.output_torque_Nm);
  }
  return loads.size() > responses.size();
}

}  // namespace

std::optional<MeasurementSet> before_rounding(const MeasurementSet& data,
                                              const Eigen::VectorXd& simulated,
                                              std::uint64_t seed) {
  if (data.kind == Kind::kTorqueAngle || is_commanded(data) || load_was_read(data)) {
    return std::nullopt;
  }
  const auto steps = reading_steps(data);
  if (!steps) return std::nullopt;
  const double most = simulated.cwiseAbs().maxCoeff();
  if (!(most > 0.0)) return std::nullopt;
  std::vector<SteppedRow> rows;
  rows.reserve(data.rows.size());
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const double y = simulated[static_cast<Eigen::Index>(i)];
    rows.push_back({.reading = (data.rows[i].response - steps->origin) / steps->step,
                    .expected = (y - steps->origin) / steps->step,
                    .size = std::abs(y) / most});
  }
  const AnalogNoise noise = likeliest_noise(rows);
  constexpr double kFine = 1.0;
  if (std::ranges::none_of(rows, [&](const SteppedRow& row) { return noise.of(row) < kFine; })) {
    return std::nullopt;
  }
  MeasurementSet result = data;
  RandomBits random(seed);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double sigma = noise.of(rows[i]), off = rows[i].reading - rows[i].expected;
    // Below the middle, where the distribution's tail has all its digits.
    const double side = off > 0.0 ? -1.0 : 1.0;
    const double low = numerics::normal_cdf((side * off - 0.5) / sigma);
    const double high = numerics::normal_cdf((side * off + 0.5) / sigma);
    const double drawn = low + random.uniform() * (high - low);
    constexpr double kFarthest = 1e-300;
    const double before =
        drawn > kFarthest && drawn < 1.0
            ? std::clamp(side * sigma * numerics::normal_quantile(drawn), off - 0.5, off + 0.5)
            : off;
    result.rows[i].response += (before - off) * steps->step;
  }
  result.readings = {.resolution = resolution_of(data), .commanded = false};
  return result;
}

}  // namespace gear3k::calibrate
