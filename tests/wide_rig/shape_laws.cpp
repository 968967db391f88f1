#include "tests/wide_rig/shape_laws.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace gear3k::wide_rig {
namespace {

double log_between(rig::DeterministicRandom& random, double low, double high) {
  return low * std::exp(random.uniform() * std::log(high / low));
}

double inside(rig::DeterministicRandom& random, Span span) {
  return log_between(random, span.low, std::max(span.high, span.low * 1.0001));
}

// a (h(x) - h(reference)).
template <typename Shape>
ShapeLaw about(double reference, Shape shape) {
  return [at = shape(reference), shape](double a, double x) { return a * (shape(x) - at); };
}

[[noreturn]] void unknown_law(const std::string& what, const std::string& law) {
  throw std::invalid_argument("no law of " + what + " named '" + law + "'");
}

}  // namespace

DrawnLaw load_law(const std::string& law, Span force, rig::DeterministicRandom& random) {
  const double reference = inside(random, force);
  const double knee = inside(random, force);
  if (law == "power") {
    return {.value = [reference](double a, double x) { return std::pow(x / reference, a) - 1.0; },
            .smallest = -0.9,
            .largest = 2.5};
  }
  if (law == "power_share") {
    const bool falls = random.uniform() < 0.5;
    const double exponent = falls ? -random.between(0.3, 0.7) : random.between(0.3, 2.5);
    const auto shape = [exponent, reference](double x) {
      return std::pow(x / reference, exponent);
    };
    return {.value = about(reference, shape)};
  }
  if (law == "logarithmic") {
    return {.value = about(reference, [](double x) { return std::log(x); })};
  }
  if (law == "saturating") {  // the film breaks where the teeth press hard
    return {.value = about(reference, [knee](double x) { return -std::exp(-x / knee); })};
  }
  if (law == "sigmoid") {
    const double width = random.between(0.3, 0.9);
    return {.value = about(reference, [knee, width](double x) {
              return std::tanh(std::log(x / knee) / width);
            })};
  }
  unknown_law("load", law);
}

DrawnLaw speed_law(const std::string& law, Span speed, rig::DeterministicRandom& random) {
  const double reference = inside(random, speed);
  const double knee = inside(random, {speed.low, 0.6 * speed.high});
  if (law == "stribeck_exponential") {
    const double exponent = random.between(0.5, 2.0);
    return {.value = about(reference, [knee, exponent](double x) {
              return std::exp(-std::pow(x / knee, exponent));
            })};
  }
  if (law == "mixed_film") {  // share of the load that asperities carry over the film's thickness
    const double exponent = random.between(0.7, 2.5);
    return {.value = about(reference, [knee, exponent](double x) {
              return 1.0 / (1.0 + std::pow(x / knee, exponent));
            })};
  }
  if (law == "power") {
    return {.value = [reference](double a, double x) { return std::pow(x / reference, a) - 1.0; },
            .smallest = -2.5,
            .largest = 2.5};
  }
  if (law == "eyring") {  // shear stress of a film, rate theory
    return {.value = about(reference, [knee](double x) { return std::asinh(x / knee); })};
  }
  if (law == "stribeck_viscous") {
    const double rise = random.between(0.05, 0.25) / speed.high;
    return {.value = about(reference,
                           [knee, rise](double x) { return std::exp(-x / knee) + rise * x; })};
  }
  unknown_law("speed", law);
}

DrawnLaw temperature_law(const std::string& law, Span t, rig::DeterministicRandom& random) {
  const double reference = random.between(std::min(t.low, 20.0), t.high);
  if (law == "exponential") {
    return {
        .value = [reference](double a, double x) { return std::exp(a * (x - reference)) - 1.0; },
        .smallest = -0.08,
        .largest = 0.08,
        .start = 0.002};
  }
  if (law == "vogel") {  // viscosity of an oil
    const double b = random.between(500.0, 1100.0);
    const double exponent = random.between(0.3, 1.0);
    return {.value = about(reference, [b, exponent, reference](double x) {
              return std::exp(exponent * (b / (x + 95.0) - b / (reference + 95.0)));
            })};
  }
  if (law == "linear") {
    return {.value = about(reference, [](double x) { return 0.1 * x; })};
  }
  if (law == "grease_transition") {
    const double knee =
        random.between(t.low + 0.2 * (t.high - t.low), t.high - 0.2 * (t.high - t.low));
    const double width = random.between(0.06, 0.25) * (t.high - t.low);
    return {.value = about(reference, [knee, width](double x) {
              return 1.0 / (1.0 + std::exp((x - knee) / width));
            })};
  }
  unknown_law("temperature", law);
}

DrawnLaw time_law(const std::string& law, rig::DeterministicRandom& random) {
  const double constant = log_between(random, 0.03, 3.0);
  const double exponent = random.between(0.3, 2.5);
  ShapeLaw value;
  if (law == "exponential") {
    value = about(0.0, [constant](double u) {
      return -std::expm1(-u / constant) / -std::expm1(-1.0 / constant);
    });
  } else if (law == "power") {
    value = about(0.0, [exponent](double u) { return std::pow(u, exponent); });
  } else if (law == "logarithmic") {
    value = about(0.0, [constant](double u) {
      return std::log1p(u / constant) / std::log1p(1.0 / constant);
    });
  } else if (law == "linear") {
    value = about(0.0, [](double u) { return u; });
  } else if (law == "weibull") {
    const double at = random.between(0.1, 0.9), shape = random.between(0.6, 3.0);
    value = about(0.0, [at, shape](double u) { return -std::expm1(-std::pow(u / at, shape)); });
  } else {
    unknown_law("time", law);
  }
  return {.value = value};
}

std::vector<double> session_values(int sessions, bool one_step, rig::DeterministicRandom& random) {
  const auto n = static_cast<std::size_t>(sessions);
  std::vector<double> values(n);
  if (one_step || n == 2) {
    const std::size_t at = 1 + random.index(n - 1);
    for (std::size_t i = 0; i < n; ++i) values[i] = i < at ? 0.0 : 1.0;
  } else {
    for (std::size_t i = 0; i < n; ++i) {
      values[i] = static_cast<double>(i) + random.between(-0.35, 0.35);
    }
    const auto monotone = [&] {
      return std::is_sorted(values.begin(), values.end()) ||
             std::is_sorted(values.rbegin(), values.rend());
    };
    do random.shuffle(values);
    while (monotone());
  }
  double mean = 0.0, square = 0.0;
  for (const double v : values) mean += v / static_cast<double>(n);
  for (const double v : values) square += (v - mean) * (v - mean) / static_cast<double>(n);
  const double origin = one_step || n == 2 ? 0.0 : mean;
  for (double& v : values) v = (v - origin) / std::sqrt(square);
  return values;
}

}  // namespace gear3k::wide_rig
