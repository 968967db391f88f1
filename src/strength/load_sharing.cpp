#include "strength/load_sharing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "numerics/distributions.hpp"

namespace gear3k::strength {

namespace {

using backlash::OutputLevers, backlash::PlanetPlay;

constexpr int kSharingSteps = 200;
constexpr int kLineSteps = 100;
/// Of the force on R2.
constexpr double kForceRounding = 1e-13;
constexpr double kPlaceRounding = 1e-15;
/// Of the force on R2, and of the springs' forces at the places of the flanks: balance or none.
constexpr double kForceBalance = 1e-9;
constexpr double kPlaceBalance = 1e-12;
/// Beyond each end of the quantile's interval.
constexpr double kRankTail = 0.025;

/// Place along w and y.
struct Place {
  double w = 0.0, y = 0.0;
};
double dot(const Place& a, const Place& b) { return a.w * b.w + a.y * b.y; }

/// One planet at a place of carrier and R2: its meshes as springs on v, with weights k_1, k_2, κ²
/// k_3 behind intervals without force.
struct PlanetState {
  std::array<double, train::kMeshCount> beyond{};  ///< v less the nearer end of its interval
};

/// Least energy of the planets over w and y.
class SharedCarrier {
 public:
  SharedCarrier(const OutputLevers& levers, const MeshSprings& springs,
                std::span<const PlanetPlay> planets, double force_N)
      : levers_(levers),
        planets_(planets),
        weight_{springs[0], springs[1], levers.planet * levers.planet * springs[2]},
        slope_{Place{}, Place{.w = 1.0, .y = 0.0},
               Place{.w = levers.sun_side / levers.planet, .y = 1.0 / levers.planet}},
        force_N_(force_N) {}

  [[nodiscard]] PlanetState planet_at(const PlanetPlay& play, const Place& at) const {
    // Interval of v without force, mesh by mesh; u_2 and u_3 fall with v.
    std::array<double, train::kMeshCount> low{}, high{};
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const double shift = dot(slope_[k], at);
      const double scale = k == 2 ? 1.0 / levers_.planet : 1.0;
      low[k] = k == 0 ? play[k].lower_m : shift - scale * play[k].upper_m;
      high[k] = k == 0 ? play[k].upper_m : shift - scale * play[k].lower_m;
    }
    const auto a = static_cast<std::size_t>(std::ranges::min_element(high) - high.begin());
    const auto b = static_cast<std::size_t>(std::ranges::max_element(low) - low.begin());
    PlanetState state;
    if (low[b] <= high[a]) return state;
    // Two springs pull v apart; the third one joins in where they leave it outside its interval.
    const std::size_t c = 3 - a - b;
    double sum = weight_[a] + weight_[b];
    double v = (weight_[a] * high[a] + weight_[b] * low[b]) / sum;
    const double held = std::clamp(v, low[c], high[c]);
    if (held != v) {
      v = (sum * v + weight_[c] * held) / (sum + weight_[c]);
      state.beyond[c] = v - held;
    }
    state.beyond[a] = v - high[a];
    state.beyond[b] = v - low[b];
    return state;
  }

  /// Slope and curvature of the energy.
  struct Slope {
    Place gradient;
    double ww = 0.0, wy = 0.0, yy = 0.0;
  };
  [[nodiscard]] Slope slope_at(const Place& at) const {
    Slope s{.gradient = {.w = 0.0, .y = -force_N_}};
    for (const PlanetPlay& play : planets_) {
      const PlanetState state = planet_at(play, at);
      double sum = 0.0;
      for (std::size_t k = 0; k < train::kMeshCount; ++k) {
        const double pull = -weight_[k] * state.beyond[k];
        s.gradient.w += pull * slope_[k].w;
        s.gradient.y += pull * slope_[k].y;
        if (state.beyond[k] != 0.0) sum += weight_[k];
      }
      for (std::size_t i = 0; i < train::kMeshCount; ++i) {
        for (std::size_t j = i + 1; j < train::kMeshCount; ++j) {
          if (state.beyond[i] == 0.0 || state.beyond[j] == 0.0) continue;
          const double k = weight_[i] * weight_[j] / sum;
          const Place d{.w = slope_[j].w - slope_[i].w, .y = slope_[j].y - slope_[i].y};
          s.ww += k * d.w * d.w;
          s.wy += k * d.w * d.y;
          s.yy += k * d.y * d.y;
        }
      }
    }
    return s;
  }

  /// Where all planets carry on the flanks that the torque loads: the solution if they do.
  [[nodiscard]] Place all_carrying() const {
    const std::array<double, train::kMeshCount> share{levers_.planet - levers_.sun_side,
                                                      -levers_.sun_side, 1.0};
    const double n = static_cast<double>(planets_.size());
    std::array<double, train::kMeshCount> u{};
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const double f = share[k] * force_N_ / n;
      double count = 0.0;
      for (const PlanetPlay& play : planets_) {
        const double bound = f > 0.0 ? play[k].upper_m : play[k].lower_m;
        if (!std::isfinite(bound)) continue;
        u[k] += bound;
        count += 1.0;
      }
      const double stiffness = k == 2 ? weight_[2] / (levers_.planet * levers_.planet) : weight_[k];
      u[k] = (count > 0.0 ? u[k] / count : 0.0) + f / stiffness;
    }
    const double w = u[0] + u[1];
    return {.w = w, .y = u[2] + levers_.planet * u[0] - levers_.sun_side * w};
  }

  [[nodiscard]] Place least() const {
    Place at = all_carrying();
    Slope s = slope_at(at);
    // Where too few flanks touch to hold both, a little of all springs does.
    const double scale =
        static_cast<double>(planets_.size()) * (weight_[0] + weight_[1] + weight_[2]);
    const double give = 1e-9 * scale * (1.0 + dot(slope_[2], slope_[2]));
    for (int step = 0; step < kSharingSteps; ++step) {
      // Sums of forces to their rounding, which the places of the flanks have too.
      if (missing(s) <= sum_of(kForceRounding, kPlaceRounding * scale, at)) break;
      const double determinant = s.ww * s.yy - s.wy * s.wy;
      const double more = determinant > 1e-9 * (s.ww + s.yy) * (s.ww + s.yy) ? 0.0 : give;
      const double a = s.ww + more, c = s.yy + more;
      const double det = a * c - s.wy * s.wy;
      const Place way{.w = -(c * s.gradient.w - s.wy * s.gradient.y) / det,
                      .y = -(a * s.gradient.y - s.wy * s.gradient.w) / det};
      const Line best = along(at, way, s, dot(s.gradient, way));
      if (best.length == 0.0) break;
      at = {.w = at.w + best.length * way.w, .y = at.y + best.length * way.y};
      s = best.slope;
    }
    if (!(missing(s) <= sum_of(kForceBalance, kPlaceBalance * scale, at))) {
      throw std::runtime_error(fmt::format(
          "load sharing: forces miss their balance by {:.3g} N of {:.6g} N, allowed: {:.3g} N",
          missing(s), std::abs(force_N_), sum_of(kForceBalance, kPlaceBalance * scale, at)));
    }
    return at;
  }

 private:
  [[nodiscard]] static double missing(const Slope& s) {
    return std::hypot(s.gradient.w, s.gradient.y);
  }
  [[nodiscard]] double sum_of(double of_force, double spring_N_m, const Place& at) const {
    return of_force * std::abs(force_N_) + spring_N_m * (std::abs(at.w) + std::abs(at.y));
  }
  struct Line {
    double length = 0.0;
    Slope slope;
  };
  /// Least energy along a way on which it falls at first: the whole way, or false position
  /// (Illinois) on the slope, which rises.
  [[nodiscard]] Line along(const Place& at, const Place& way, const Slope& start,
                           double first_slope) const {
    const auto slope_after = [&](double t) {
      return slope_at({.w = at.w + t * way.w, .y = at.y + t * way.y});
    };
    const double enough = 0.1 * std::abs(first_slope);
    Line low{.length = 0.0, .slope = start}, high{.length = 1.0, .slope = slope_after(1.0)};
    double below = first_slope, above = dot(high.slope.gradient, way);
    while (above < -enough && high.length < 0x1p100) {
      low = high;
      below = above;
      high.length *= 2.0;
      high.slope = slope_after(high.length);
      above = dot(high.slope.gradient, way);
    }
    if (std::abs(above) <= enough) return high;
    int last = 0;
    double weight_low = below, weight_high = above;
    for (int step = 0; step < kLineSteps; ++step) {
      double t =
          high.length - weight_high * (high.length - low.length) / (weight_high - weight_low);
      if (!(t > low.length && t < high.length) || step % 4 == 3) {
        t = 0.5 * (low.length + high.length);
      }
      if (!(t > low.length && t < high.length)) break;
      Line middle{.length = t, .slope = slope_after(t)};
      const double value = dot(middle.slope.gradient, way);
      if (std::abs(value) <= enough) return middle;
      const int side = value < 0.0 ? -1 : 1;
      if (side < 0) {
        low = middle;
        weight_low = value;
        if (last == side) weight_high *= 0.5;
      } else {
        high = middle;
        weight_high = value;
        if (last == side) weight_low *= 0.5;
      }
      last = side;
    }
    return low.length > 0.0 ? low : high;
  }

  const OutputLevers& levers_;
  std::span<const PlanetPlay> planets_;
  std::array<double, train::kMeshCount> weight_;
  std::array<Place, train::kMeshCount> slope_;  ///< of the intervals' places by w and y
  double force_N_;
};

void check_sharing(const MeshSprings& springs, std::span<const PlanetPlay> planets, double torque) {
  if (planets.empty()) {
    throw std::invalid_argument("load sharing: 0 planets, allowed: 1 and more");
  }
  for (const double k : springs) {
    if (!(k > 0.0 && std::isfinite(k))) {
      throw std::invalid_argument(
          fmt::format("load sharing: mesh stiffness = {} N/m, allowed: above 0", k));
    }
  }
  if (!(std::abs(torque) > 0.0 && std::isfinite(torque))) {
    throw std::invalid_argument(
        fmt::format("load sharing: torque = {} N m, allowed: not 0", torque));
  }
  for (const PlanetPlay& planet : planets) {
    for (const backlash::MeshPlay& play : planet) {
      if (!(play.lower_m <= play.upper_m)) {
        throw std::invalid_argument(
            fmt::format("load sharing: play from {} to {} m, allowed: lower <= upper", play.lower_m,
                        play.upper_m));
      }
    }
  }
}

/// Whether the planets can hold the force on R2 at all: forces in balance (55.3) of the signs that
/// the finite bounds allow.  Those of one planet are a convex cone in (f_2, f_3), between rays on
/// which one of the three forces is 0; those of all planets are what the rays of each span
/// together.
bool holds(const OutputLevers& levers, std::span<const PlanetPlay> planets, double force_N) {
  const auto finite = [](const backlash::MeshPlay& play) {
    return std::isfinite(play.lower_m) && std::isfinite(play.upper_m);
  };
  if (std::ranges::all_of(planets.front(), finite)) return true;
  std::vector<PlanetForces> rays;
  for (const double sign : {1.0, -1.0}) {
    for (const PlanetForces& ray :
         {PlanetForces{0.0, -sign * levers.planet, sign},
          PlanetForces{sign * levers.planet, 0.0, sign}, PlanetForces{sign, sign, 0.0}}) {
      const auto allowed = [&](const PlanetPlay& play) {
        for (std::size_t k = 0; k < ray.size(); ++k) {
          if (ray[k] > 0.0 && std::isinf(play[k].upper_m)) return false;
          if (ray[k] < 0.0 && std::isinf(play[k].lower_m)) return false;
        }
        return true;
      };
      if (std::ranges::any_of(planets, allowed)) rays.push_back(ray);
    }
  }
  const auto cross = [](const PlanetForces& a, const PlanetForces& b) {
    return a[1] * b[2] - a[2] * b[1];
  };
  const PlanetForces all{-levers.ring_side * force_N, -levers.sun_side * force_N, force_N};
  for (const PlanetForces& a : rays) {
    for (const PlanetForces& b : rays) {
      if (cross(a, b) > 0.0 && cross(a, all) >= 0.0 && cross(all, b) >= 0.0) return true;
    }
  }
  return false;
}

void check_probability(double probability) {
  if (probability > 0.0 && probability <= 1.0) return;
  throw std::invalid_argument(
      fmt::format("load factor: probability = {}, allowed: 0 < probability <= 1", probability));
}

}  // namespace

std::vector<PlanetForces> shared_forces(const OutputLevers& levers, const MeshSprings& springs_N_m,
                                        std::span<const PlanetPlay> planets, double torque_Nm) {
  check_sharing(springs_N_m, planets, torque_Nm);
  if (!holds(levers, planets, torque_Nm / levers.output_m)) {
    throw std::invalid_argument(fmt::format(
        "load sharing: nothing holds R2 against {} N m, allowed: finite bounds of the plays on the "
        "flanks that the torque loads",
        torque_Nm));
  }
  const SharedCarrier carrier(levers, springs_N_m, planets, torque_Nm / levers.output_m);
  const Place at = carrier.least();
  std::vector<PlanetForces> forces;
  forces.reserve(planets.size());
  for (const PlanetPlay& play : planets) {
    const PlanetState state = carrier.planet_at(play, at);
    forces.push_back({springs_N_m[0] * state.beyond[0], -springs_N_m[1] * state.beyond[1],
                      -springs_N_m[2] * levers.planet * state.beyond[2]});
  }
  return forces;
}

std::array<double, train::kMeshCount> mesh_load_factors(const OutputLevers& levers,
                                                        std::span<const PlanetForces> planets,
                                                        double torque_Nm) {
  const double force_N = std::abs(torque_Nm) / levers.output_m;
  const std::array<double, train::kMeshCount> all{std::abs(levers.ring_side) * force_N,
                                                  levers.sun_side * force_N, force_N};
  std::array<double, train::kMeshCount> factors{};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    double greatest = 0.0;
    for (const PlanetForces& planet : planets) greatest = std::max(greatest, std::abs(planet[k]));
    factors[k] = static_cast<double>(planets.size()) * greatest / all[k];
  }
  return factors;
}

PlaySample draw_plays(const backlash::ClearanceModel& model, const PlaySampleOptions& options) {
  if (options.samples == 0) {
    throw std::invalid_argument("planet plays: samples = 0, allowed: 1 and more");
  }
  const backlash::RandomGearbox random(model, options.scatter, options.seed);
  PlaySample sample{.levers = model.levers, .planets = static_cast<std::size_t>(model.planets)};
  sample.plays.reserve(options.samples * sample.planets);
  for (std::uint64_t index = 0; index < options.samples; ++index) {
    const std::vector<PlanetPlay> plays = backlash::plays(model, random.deviations(index));
    ++sample.drawn;
    if (!backlash::output_range(model.levers, plays).assembles()) continue;
    ++sample.assembled;
    sample.plays.insert(sample.plays.end(), plays.begin(), plays.end());
  }
  return sample;
}

QuantileRanks quantile_ranks(std::uint64_t values, double probability) {
  check_probability(probability);
  const auto n = static_cast<double>(values);
  const auto bounds = [&](std::uint64_t count) {
    return numerics::binomial_bounds(n, static_cast<double>(count), kRankTail);
  };
  // P(B <= c) <= tail where the upper bound of the proportion from c hits is below `probability`,
  // P(B >= c) <= tail where the lower one is above it.
  const auto first_that_is_not = [&](const auto& is) {
    std::uint64_t low = 0, high = values + 1;
    while (low < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      if (is(middle)) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  };
  QuantileRanks ranks;
  ranks.lower = std::min(
      values, first_that_is_not([&](std::uint64_t c) { return bounds(c).upper <= probability; }));
  const std::uint64_t upper =
      first_that_is_not([&](std::uint64_t c) { return bounds(c).lower < probability; });
  if (upper <= values) ranks.upper = upper;
  return ranks;
}

LoadFactorSeries load_factor_series(const PlaySample& sample, const MeshSprings& springs_N_m,
                                    double torque_Nm, double probability) {
  if (sample.assembled == 0) {
    throw std::invalid_argument(fmt::format(
        "load factor: none of {} gearboxes assembles, allowed: one and more", sample.drawn));
  }
  check_probability(probability);
  const std::span<const PlanetPlay> all(sample.plays);
  const auto count = static_cast<std::size_t>(sample.assembled);
  std::array<std::vector<double>, train::kMeshCount> factors;
  for (std::vector<double>& of_mesh : factors) of_mesh.reserve(count);
  for (std::size_t g = 0; g < count; ++g) {
    const auto plays = all.subspan(g * sample.planets, sample.planets);
    std::array<double, train::kMeshCount> greatest{};
    for (const double torque : {torque_Nm, -torque_Nm}) {
      const auto forces = shared_forces(sample.levers, springs_N_m, plays, torque);
      const auto of_sense = mesh_load_factors(sample.levers, forces, torque);
      for (std::size_t k = 0; k < train::kMeshCount; ++k) {
        greatest[k] = std::max(greatest[k], of_sense[k]);
      }
    }
    for (std::size_t k = 0; k < train::kMeshCount; ++k) factors[k].push_back(greatest[k]);
  }
  const auto rank = static_cast<std::size_t>(std::ceil(probability * static_cast<double>(count)));
  const QuantileRanks ranks = quantile_ranks(count, probability);
  LoadFactorSeries series;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    std::vector<double>& values = factors[k];
    series.mean[k] =
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(count);
    std::ranges::sort(values);
    series.quantile[k] = values[std::max<std::size_t>(rank, 1) - 1];
    series.lower[k] = ranks.lower > 0 ? values[ranks.lower - 1] : 1.0;
    if (ranks.upper) series.upper[k] = values[*ranks.upper - 1];
  }
  return series;
}

}  // namespace gear3k::strength
