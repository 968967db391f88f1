#include "strength/load_sharing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "backlash/output_range.hpp"

namespace gear3k::strength {

namespace {

template <class T>
void check_sharing(std::span<const double> gap_rad, const T& stiffness, const T& torque) {
  if (!(value_of(stiffness) > 0.0)) {
    throw std::invalid_argument(fmt::format(
        "load sharing: output stiffness = {} N m/rad, allowed: above 0", value_of(stiffness)));
  }
  if (!(value_of(torque) > 0.0 && std::isfinite(value_of(torque)))) {
    throw std::invalid_argument(
        fmt::format("load sharing: torque = {} N m, allowed: above 0", value_of(torque)));
  }
  bool any_finite = false;
  for (const double gap : gap_rad) {
    if (std::isnan(gap) || gap == -std::numeric_limits<double>::infinity()) {
      throw std::invalid_argument(
          fmt::format("load sharing: gap = {} rad, allowed: a number or +inf", gap));
    }
    any_finite = any_finite || std::isfinite(gap);
  }
  if (!any_finite) throw std::invalid_argument("load sharing: no planet with a finite gap");
}

/// Turn of the output and number of planets that carry; gaps in order, from the least one.
template <class T>
struct SharedTurn {
  T angle_rad{};
  std::size_t carrying = 0;
};
template <class T>
SharedTurn<T> shared_turn(std::span<const double> ordered, const T& stiffness, const T& torque) {
  const T alone = static_cast<double>(ordered.size()) * torque / stiffness;  // T/κ
  double sum = 0.0;
  SharedTurn<T> turn;
  for (std::size_t n = 1; n <= ordered.size(); ++n) {
    sum += ordered[n - 1] - ordered[0];
    turn = {.angle_rad = (alone + sum) / static_cast<double>(n), .carrying = n};
    if (n == ordered.size() || value_of(turn.angle_rad) <= ordered[n] - ordered[0]) break;
  }
  return turn;
}

}  // namespace

template <class T>
LoadSharing<T> load_sharing(std::span<const double> gap_rad, const T& output_stiffness_Nm_rad,
                            const T& torque_Nm) {
  check_sharing(gap_rad, output_stiffness_Nm_rad, torque_Nm);
  std::vector<double> ordered(gap_rad.begin(), gap_rad.end());
  std::ranges::sort(ordered);
  const auto turn =
      shared_turn(std::span<const double>(ordered), output_stiffness_Nm_rad, torque_Nm);
  const double n = static_cast<double>(gap_rad.size());
  const T kappa = output_stiffness_Nm_rad / n;
  LoadSharing<T> sharing{.planet_torque_Nm = {},
                         .angle_rad = turn.angle_rad,
                         .load_factor = output_stiffness_Nm_rad * turn.angle_rad / torque_Nm,
                         .carrying = turn.carrying};
  sharing.planet_torque_Nm.reserve(gap_rad.size());
  for (const double gap : gap_rad) {
    const bool carries = gap - ordered[0] < value_of(turn.angle_rad);
    sharing.planet_torque_Nm.push_back(carries ? T(kappa * (turn.angle_rad - (gap - ordered[0])))
                                               : constant<T>(0.0));
  }
  return sharing;
}

std::vector<double> planet_gaps(const backlash::OutputLevers& levers,
                                std::span<const backlash::PlanetPlay> planets, bool greatest) {
  if (planets.empty()) throw std::invalid_argument("planet gaps: no planets");
  std::vector<double> gaps;
  gaps.reserve(planets.size());
  for (std::size_t p = 0; p < planets.size(); ++p) {
    const backlash::OutputRange range = backlash::output_range(levers, planets.subspan(p, 1));
    gaps.push_back(greatest ? range.upper_rad : -range.lower_rad);
  }
  const double least = *std::ranges::min_element(gaps);
  for (double& gap : gaps) gap -= least;
  return gaps;
}

PlanetGapSample draw_planet_gaps(const backlash::ClearanceModel& model,
                                 const PlanetGapOptions& options) {
  if (options.samples == 0) {
    throw std::invalid_argument("planet gaps: samples = 0, allowed: 1 and more");
  }
  const backlash::RandomGearbox random(model, options.scatter, options.seed);
  PlanetGapSample sample{.planets = static_cast<std::size_t>(model.planets)};
  sample.gap_rad.reserve(options.samples * sample.planets);
  for (std::uint64_t index = 0; index < options.samples; ++index) {
    const std::vector<backlash::PlanetPlay> plays =
        backlash::plays(model, random.deviations(index));
    ++sample.drawn;
    if (!backlash::output_range(model.levers, plays).assembles()) continue;
    ++sample.assembled;
    const std::vector<double> gaps = planet_gaps(model.levers, plays, options.greatest);
    sample.gap_rad.insert(sample.gap_rad.end(), gaps.begin(), gaps.end());
  }
  return sample;
}

template <class T>
LoadFactorDistribution<T> load_factor_distribution(const PlanetGapSample& sample,
                                                   const T& output_stiffness_Nm_rad,
                                                   const T& torque_Nm, double probability) {
  if (sample.assembled == 0) {
    throw std::invalid_argument(fmt::format(
        "load factor: none of {} gearboxes assembles, allowed: one and more", sample.drawn));
  }
  if (!(probability > 0.0 && probability <= 1.0)) {
    throw std::invalid_argument(
        fmt::format("load factor: probability = {}, allowed: 0 < probability <= 1", probability));
  }
  const std::span<const double> all(sample.gap_rad);
  const auto gaps_of = [&](std::size_t k) {
    return all.subspan(k * sample.planets, sample.planets);
  };
  std::vector<double> ordered(sample.planets);
  const auto factor_of = [&](std::size_t k) {
    std::ranges::copy(gaps_of(k), ordered.begin());
    std::ranges::sort(ordered);
    const auto turn =
        shared_turn(std::span<const double>(ordered), output_stiffness_Nm_rad, torque_Nm);
    return T(output_stiffness_Nm_rad * turn.angle_rad / torque_Nm);
  };
  check_sharing(gaps_of(0), output_stiffness_Nm_rad, torque_Nm);
  std::vector<double> values;
  values.reserve(sample.assembled);
  LoadFactorDistribution<T> result;
  result.mean = constant<T>(0.0);
  for (std::size_t k = 0; k < sample.assembled; ++k) {
    const T factor = factor_of(k);
    values.push_back(value_of(factor));
    result.mean = result.mean + factor;
  }
  result.mean = result.mean * (1.0 / static_cast<double>(sample.assembled));
  // The gearbox whose value has that rank; the one drawn first at a tie.
  const auto rank =
      static_cast<std::size_t>(std::ceil(probability * static_cast<double>(sample.assembled)));
  std::vector<std::size_t> order(sample.assembled);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto at = order.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(order.begin(), at, order.end(), [&](std::size_t a, std::size_t b) {
    return values[a] < values[b] || (values[a] == values[b] && a < b);
  });
  result.quantile = factor_of(*at);
  return result;
}

#define INSTANTIATE(T)                                                                             \
  template LoadSharing<T> load_sharing<T>(std::span<const double>, const T&, const T&);            \
  template LoadFactorDistribution<T> load_factor_distribution<T>(const PlanetGapSample&, const T&, \
                                                                 const T&, double);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
