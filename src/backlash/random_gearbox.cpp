#include "backlash/random_gearbox.hpp"

#include <Random123/philox.h>
#include <fmt/format.h>

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <stdexcept>

#include "numerics/distributions.hpp"

namespace gear3k::backlash {

namespace {

/// 32-bit numbers of one call of the generator.
constexpr std::size_t kPerCall = 8;

std::array<std::uint32_t, kPerCall> random_bits(const std::array<std::uint64_t, 2>& key,
                                                std::uint64_t gearbox, std::uint64_t call) {
  const r123::Philox4x64::ctr_type counter{{gearbox, call, 0, 0}};
  const r123::Philox4x64::key_type philox_key{{key[0], key[1]}};
  const auto words = r123::Philox4x64()(counter, philox_key);
  std::array<std::uint32_t, kPerCall> bits{};
  for (std::size_t k = 0; k < kPerCall; ++k) {
    bits[k] = static_cast<std::uint32_t>(words[k / 2] >> (k % 2 == 0 ? 0U : 32U));
  }
  return bits;
}

double checked_level(const ScatterOptions& scatter) {
  if (!(scatter.sigma_level > 0.0)) {
    throw std::invalid_argument(
        fmt::format("ScatterOptions: sigma_level = {}, allowed: > 0", scatter.sigma_level));
  }
  return scatter.sigma_level;
}

double normal_density(double q) {
  return std::exp(-0.5 * q * q) / boost::math::constants::root_two_pi<double>();
}

/// result[b] for the 32-bit numbers of kBatch gearboxes.
void fill_numbers(const OctaveTable& table, double half_width_m, const std::uint32_t* bits,
                  double* result) {
  for (std::size_t b = 0; b < kBatch; ++b) result[b] = half_width_m * table(bits[b]);
}
void fill_vectors(const OctaveTable& radius, const UnitCircleTable& direction, double half_width_m,
                  const std::uint32_t* radius_bits, const std::uint32_t* direction_bits, double* x,
                  double* y) {
  for (std::size_t b = 0; b < kBatch; ++b) {
    const double r = half_width_m * radius(radius_bits[b]);
    const auto towards = direction(direction_bits[b]);
    x[b] = r * towards.x;
    y[b] = r * towards.y;
  }
}

}  // namespace

std::array<double, 4> OctaveTable::cubic(std::size_t k, const Node& a, const Node& b,
                                         double direction) {
  const double start = place(k);
  const double width = place(k + 1) - start;
  const double slope_a = direction * 0x1p-32 * a.slope;
  const double slope_b = direction * 0x1p-32 * b.slope;
  const double chord = (b.value - a.value) / width;
  // In t = x − start, then by powers of x.
  const double c3 = (slope_a + slope_b - 2.0 * chord) / (width * width);
  const double c2 = (3.0 * chord - 2.0 * slope_a - slope_b) / width;
  return {a.value - start * (slope_a - start * (c2 - start * c3)),
          slope_a - start * (2.0 * c2 - 3.0 * start * c3), c2 - 3.0 * start * c3, c3};
}

UnitCircleTable::UnitCircleTable() {
  for (std::size_t k = 0; k < middles_.size(); ++k) {
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(k) + 0.5) / 256.0;
    middles_[k] = {.x = std::cos(angle), .y = std::sin(angle)};
  }
}

OctaveTable number_table(const ScatterOptions& scatter) {
  using Node = OctaveTable::Node;
  if (scatter.scatter == Scatter::kUniform) {
    return OctaveTable([](double x) { return Node{.value = 2.0 * x - 1.0, .slope = 2.0}; },
                       [](double x) { return Node{.value = 1.0 - 2.0 * x, .slope = 2.0}; });
  }
  const double level = checked_level(scatter);
  const double beyond = numerics::normal_cdf(-level);
  const double within = std::erf(level / boost::math::constants::root_two<double>());
  const auto from_start = [=](double x) {
    const double q = numerics::normal_quantile(std::min(0.5, beyond + x * within));
    return Node{.value = std::max(-1.0, q / level), .slope = within / (normal_density(q) * level)};
  };
  return OctaveTable(from_start, [=](double x) {
    const Node mirrored = from_start(x);
    return Node{.value = -mirrored.value, .slope = mirrored.slope};
  });
}

OctaveTable radius_table(const ScatterOptions& scatter) {
  using Node = OctaveTable::Node;
  if (scatter.scatter == Scatter::kUniform) {
    const auto node = [](double u) {
      return Node{.value = std::sqrt(u), .slope = 0.5 / std::sqrt(u)};
    };
    return OctaveTable(node, [=](double x) { return node(1.0 - x); });
  }
  const double level = checked_level(scatter);
  const double within = -std::expm1(-0.5 * level * level);
  // ρ = √(−2 ln s) with the share s beyond the radius ρ σ: s from 1 to 1 − within.
  const auto node = [=](double s, double log_s) {
    const double rho = std::sqrt(-2.0 * log_s);
    return Node{.value = std::min(1.0, rho / level), .slope = within / (s * rho * level)};
  };
  return OctaveTable([=](double x) { return node(1.0 - x * within, std::log1p(-x * within)); },
                     [=](double x) {
                       const double s = std::exp(-0.5 * level * level) + x * within;
                       return node(s, std::log(s));
                     });
}

RandomGearbox::RandomGearbox(const ClearanceModel& model, const ScatterOptions& scatter,
                             std::uint64_t seed, std::uint64_t stream)
    : key_{seed, stream}, number_(number_table(scatter)), radius_(radius_table(scatter)) {
  deviations_.reserve(model.deviations.size());
  for (const Deviation& d : model.deviations) {
    deviations_.push_back(
        {.half_width_m = model.sources[d.source].half_width_m, .planar = d.planar});
    components_ += d.planar ? 2U : 1U;
  }
}

void RandomGearbox::draw(std::uint64_t first, std::vector<Lanes>& components) const {
  components.resize(components_);
  // Of one call after another; a vector may take its two numbers from two calls.
  std::array<std::array<std::uint32_t, kBatch>, kPerCall> bits{};
  std::array<std::uint32_t, kBatch> radius_bits{};
  std::size_t at = 0;  // components so far
  const auto next = [&]() -> const std::uint32_t* {
    if (at % kPerCall == 0) {
      for (std::size_t b = 0; b < kBatch; ++b) {
        const auto drawn = random_bits(key_, first + b, at / kPerCall);
        for (std::size_t k = 0; k < kPerCall; ++k) bits[k][b] = drawn[k];
      }
    }
    return bits[at++ % kPerCall].data();
  };
  for (const Source& d : deviations_) {
    double* x = components[at].lane.data();
    if (!d.planar) {
      fill_numbers(number_, d.half_width_m, next(), x);
      continue;
    }
    double* y = components[at + 1].lane.data();
    std::copy_n(next(), kBatch, radius_bits.begin());
    fill_vectors(radius_, direction_, d.half_width_m, radius_bits.data(), next(), x, y);
  }
}

std::vector<DeviationValue> RandomGearbox::deviations(std::uint64_t index) const {
  std::vector<DeviationValue> values;
  values.reserve(deviations_.size());
  std::size_t at = 0;
  const auto next = [&] {
    const std::uint32_t bits = random_bits(key_, index, at / kPerCall)[at % kPerCall];
    ++at;
    return bits;
  };
  for (const Source& d : deviations_) {
    if (!d.planar) {
      values.push_back({.x_m = d.half_width_m * number_(next()), .y_m = 0.0});
      continue;
    }
    const double r = d.half_width_m * radius_(next());
    const auto towards = direction_(next());
    values.push_back({.x_m = r * towards.x, .y_m = r * towards.y});
  }
  return values;
}

}  // namespace gear3k::backlash
