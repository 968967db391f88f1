#include "calibrate/loops/zero_phase_filter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace gear3k::calibrate {
namespace {

using std::numbers::pi;

/// y_i = b0 x_i + b1 x_(i-1) + b2 x_(i-2) - a1 y_(i-1) - a2 y_(i-2)
struct Biquad {
  double b0, b1, b2, a1, a2;
};

Biquad butterworth(double cutoff_per_sample) {
  const double k = std::tan(pi * cutoff_per_sample);
  const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
  return {.b0 = k * k * scale,
          .b1 = 2.0 * k * k * scale,
          .b2 = k * k * scale,
          .a1 = 2.0 * (k * k - 1.0) * scale,
          .a2 = (1.0 - std::numbers::sqrt2 * k + k * k) * scale};
}

/// One pass in place, from the steady state of the first value.
template <class Iterator>
void pass(const Biquad& f, Iterator first, Iterator last) {
  double z1 = (1.0 - f.b0) * *first;
  double z2 = (f.b2 - f.a2) * *first;
  for (; first != last; ++first) {
    const double x = *first;
    const double y = f.b0 * x + z1;
    z1 = f.b1 * x - f.a1 * y + z2;
    z2 = f.b2 * x - f.a2 * y;
    *first = y;
  }
}

}  // namespace

std::size_t filter_padding(double cutoff_per_sample) {
  if (!(cutoff_per_sample > 0.0 && cutoff_per_sample < 0.5)) {
    throw std::invalid_argument(
        fmt::format("cutoff_per_sample = {} is not between 0 and 0.5", cutoff_per_sample));
  }
  return static_cast<std::size_t>(std::ceil(3.0 / cutoff_per_sample));
}

std::vector<double> zero_phase_filter(const std::vector<double>& signal, double cutoff_per_sample) {
  const std::size_t pad = filter_padding(cutoff_per_sample);
  const std::size_t n = signal.size();
  if (n <= pad) {
    throw std::invalid_argument(
        fmt::format("{} samples are too few to continue each end by {}", n, pad));
  }
  std::vector<double> x;
  x.reserve(n + 2 * pad);
  for (std::size_t k = pad; k > 0; --k) x.push_back(2.0 * signal.front() - signal[k]);
  x.insert(x.end(), signal.begin(), signal.end());
  for (std::size_t k = 1; k <= pad; ++k) x.push_back(2.0 * signal.back() - signal[n - 1 - k]);
  const Biquad filter = butterworth(cutoff_per_sample);
  pass(filter, x.begin(), x.end());
  pass(filter, x.rbegin(), x.rend());
  const auto first = x.begin() + static_cast<std::ptrdiff_t>(pad);
  return {first, first + static_cast<std::ptrdiff_t>(n)};
}

std::vector<double> impulse_response(double cutoff_per_sample) {
  const std::size_t reach = filter_padding(cutoff_per_sample);
  std::vector<double> impulse(4 * reach + 1, 0.0);
  impulse[2 * reach] = 1.0;
  const std::vector<double> response = zero_phase_filter(impulse, cutoff_per_sample);
  const auto centre = response.begin() + static_cast<std::ptrdiff_t>(2 * reach);
  return {centre, centre + static_cast<std::ptrdiff_t>(reach + 1)};
}

void add_filter_weights(const std::vector<double>& response, std::size_t i, double factor,
                        std::vector<double>& weight) {
  const auto reach = static_cast<std::ptrdiff_t>(response.size()) - 1;
  const auto last = static_cast<std::ptrdiff_t>(weight.size()) - 1;
  const auto at = [&](std::ptrdiff_t j) -> double& { return weight[static_cast<std::size_t>(j)]; };
  for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
    const double h = factor * response[static_cast<std::size_t>(std::abs(k))];
    const std::ptrdiff_t j = static_cast<std::ptrdiff_t>(i) + k;
    if (j < 0) {
      at(0) += 2.0 * h;
      at(-j) -= h;
    } else if (j > last) {
      at(last) += 2.0 * h;
      at(2 * last - j) -= h;
    } else {
      at(j) += h;
    }
  }
}

}  // namespace gear3k::calibrate
