#include "backlash/turn.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace gear3k::backlash {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Place among the bodies that turn against the carrier; empty: the carrier.
std::optional<std::size_t> turning_body(Body body) {
  if (body == Body::kCarrier) return std::nullopt;
  return static_cast<std::size_t>(body) - 1;
}

std::size_t wrapped(long long tooth, int teeth) {
  const long long rest = tooth % teeth;
  return static_cast<std::size_t>(rest < 0 ? rest + teeth : rest);
}

/// What one side's flanks of one gear (on one planet) add to a bound.
std::vector<double> one_side(const std::vector<double>& flank_m, double coefficient, int teeth,
                             int planet, bool upper) {
  std::vector<double> added;
  if (flank_m.empty() || coefficient == 0.0) return added;
  added.reserve(static_cast<std::size_t>(teeth));
  for (int tooth = 0; tooth < teeth; ++tooth) {
    added.push_back(coefficient * flank_m[flank_place(teeth, planet, tooth, upper)]);
  }
  return added;
}

/// A bound of all plays by its bound_index().
double& bound_of(std::vector<PlanetPlay>& plays, std::size_t bound) {
  constexpr std::size_t kMeshes = train::kMeshCount;
  MeshPlay& play = plays[bound / 2U / kMeshes][bound / 2U % kMeshes];
  return bound % 2U == 0U ? play.lower_m : play.upper_m;
}

}  // namespace

std::size_t flank_count(const train::ToothSet& z, int gear, int planets) {
  const bool on_planet = gear == train::kP1 || gear == train::kP2;
  return flank_place(train::teeth_of(z)[static_cast<std::size_t>(gear)], on_planet ? planets : 1, 0,
                     false);
}

TurningPlays::TurningPlays(const ClearanceModel& model, const train::ToothSet& z,
                           std::span<const DeviationValue> values, const ToothErrors& errors)
    : planets_(model.planets), constant_(static_cast<std::size_t>(model.planets)) {
  if (values.size() != model.deviations.size()) {
    throw std::invalid_argument(fmt::format("TurningPlays: {} values, allowed: one for each of {}",
                                            values.size(), model.deviations.size()));
  }
  const train::SpeedRatios w = train::speed_ratios(z);
  rate_ = {w.sun - w.carrier, w.planet - w.carrier, -w.carrier, 1.0 - w.carrier};
  for (std::size_t i = 0; i < model.middle_m.size(); ++i) {
    bound_of(constant_, i) = model.middle_m[i];
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Deviation& d = model.deviations[i];
    if (model.sources[d.source].kind == ToleranceKind::kSinglePitch) continue;
    const auto body = d.planar ? turning_body(d.body) : std::nullopt;
    if (body) {
      cosine_[*body].resize(constant_.size());
      sine_[*body].resize(constant_.size());
    }
    // (x, y) turned by ρ is (x cos ρ − y sin ρ, x sin ρ + y cos ρ).
    const auto add = [&](const PlayEffect& e, double along, double across) {
      bound_of(body ? cosine_[*body] : constant_, e.bound) += e.coefficient * along;
      if (body) bound_of(sine_[*body], e.bound) += e.coefficient * across;
    };
    for (const PlayEffect& e : d.x) add(e, values[i].x_m, -values[i].y_m);
    for (const PlayEffect& e : d.y) add(e, values[i].y_m, values[i].x_m);
  }
  add_teeth(model, z, errors);
}

void TurningPlays::add_teeth(const ClearanceModel& model, const train::ToothSet& z,
                             const ToothErrors& errors) {
  const auto teeth = train::teeth_of(z);
  for (int gear = 0; gear < train::kGearCount; ++gear) {
    const auto& given = errors.flank_m[static_cast<std::size_t>(gear)];
    const std::size_t expected = flank_count(z, gear, model.planets);
    if (!given.empty() && given.size() != expected) {
      throw std::invalid_argument(
          fmt::format("TurningPlays: errors of {} flanks of {}, allowed: 0 or {}", given.size(),
                      train::kGearNames[static_cast<std::size_t>(gear)], expected));
    }
  }
  // What a displaced flank adds is what the model says of single pitches.
  const std::size_t bounds = model.middle_m.size();
  std::vector<std::array<double, 2>> coefficient(bounds);  // central gear, planet
  bool pitched = false;
  for (const Deviation& d : model.deviations) {
    const ToleranceSource& source = model.sources[d.source];
    if (source.kind != ToleranceKind::kSinglePitch) continue;
    pitched = true;
    for (const PlayEffect& e : d.x) {
      coefficient[e.bound][d.body == Body::kPlanet ? 1 : 0] = e.coefficient;
    }
  }
  if (!pitched) return;
  passing_.resize(bounds);
  constexpr std::array<std::size_t, train::kMeshCount> kCentralBody{0, 2, 3};
  for (int planet = 0; planet < model.planets; ++planet) {
    const double place = static_cast<double>(planet) / model.planets;  // in turns
    for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
      const auto k = static_cast<std::size_t>(mesh);
      const bool internal = mesh != train::kMeshSP1;
      const int central = train::kMeshGears[k][internal ? 1 : 0];
      const int own = train::kMeshGears[k][internal ? 0 : 1];
      const int zc = teeth[static_cast<std::size_t>(central)];
      const int zp = teeth[static_cast<std::size_t>(own)];
      const double facing = zp * (internal ? place : place + 0.5);
      for (const bool upper : {false, true}) {
        const std::size_t bound = bound_index(planet, mesh, upper);
        // u grows until the flanks on the far sides of the sun's and P1's teeth meet; in a ring a
        // planet's tooth runs against the far flank of the ring's tooth before it.
        const bool planet_upper = internal ? !upper : upper;
        // The flank stands a quarter of a pitch off its tooth's middle.
        const double flank = upper ? 0.25 : -0.25;
        passing_[bound] = {.start = zc * place - flank,
                           .per_turn = zc * rate_[kCentralBody[k]],
                           .offset = std::llround(facing + (internal ? -zc : zc) * place),
                           .internal = internal,
                           .central_teeth = zc,
                           .planet_teeth = zp};
        const auto& central_flanks = errors.flank_m[static_cast<std::size_t>(central)];
        const auto& own_flanks = errors.flank_m[static_cast<std::size_t>(own)];
        Flanks flanks{
            .bound = bound,
            .central_m = one_side(central_flanks, coefficient[bound][0], zc, 0, upper),
            .planet_m = one_side(own_flanks, coefficient[bound][1], zp, planet, planet_upper)};
        if (!flanks.central_m.empty() || !flanks.planet_m.empty()) {
          flanks_.push_back(std::move(flanks));
        }
      }
    }
  }
}

TurningPlays::Angles TurningPlays::angles(double revolutions) const {
  Angles angles;
  for (std::size_t b = 0; b < kBodies; ++b) {
    const double turns = rate_[b] * revolutions;
    const double angle = kTurn * (turns - std::floor(turns));
    angles.cosine[b] = std::cos(angle);
    angles.sine[b] = std::sin(angle);
  }
  angles.touching.reserve(passing_.size());
  for (const Passing& p : passing_) {
    const long long tooth = std::llround(p.start - p.per_turn * revolutions);
    angles.touching.push_back(
        {.central = wrapped(tooth, p.central_teeth),
         .planet = wrapped(p.internal ? p.offset + tooth : p.offset - tooth, p.planet_teeth)});
  }
  return angles;
}

std::vector<PlanetPlay> TurningPlays::at(const Angles& angles) const {
  std::vector<PlanetPlay> plays = constant_;
  for (std::size_t b = 0; b < kBodies; ++b) {
    if (cosine_[b].empty()) continue;
    const double cosine = angles.cosine[b], sine = angles.sine[b];
    for (std::size_t planet = 0; planet < plays.size(); ++planet) {
      for (std::size_t mesh = 0; mesh < plays[planet].size(); ++mesh) {
        const MeshPlay& along = cosine_[b][planet][mesh];
        const MeshPlay& across = sine_[b][planet][mesh];
        plays[planet][mesh].lower_m += along.lower_m * cosine + across.lower_m * sine;
        plays[planet][mesh].upper_m += along.upper_m * cosine + across.upper_m * sine;
      }
    }
  }
  for (const Flanks& f : flanks_) {
    const Touching& teeth = angles.touching[f.bound];
    double added = 0.0;
    if (!f.central_m.empty()) added += f.central_m[teeth.central];
    if (!f.planet_m.empty()) added += f.planet_m[teeth.planet];
    bound_of(plays, f.bound) += added;
  }
  return plays;
}

long long turn_period(const train::ToothSet& z) {
  // Revolutions against the carrier per revolution of the output, as fractions:
  // w_C = zP1 zR2/D, of P1 −zR1 zR2/D, of S zR1 zP1 zR2/(zS D), D = zP1 zR2 − zP2 zR1.
  const long long gap = 1LL * z.P1 * z.R2 - 1LL * z.P2 * z.R1;
  if (gap == 0 || z.S == 0) {
    throw std::invalid_argument(fmt::format(
        "turn_period: zP1 zR2 - zP2 zR1 = {} and zS = {}, allowed: both non-zero", gap, z.S));
  }
  const auto denominator = [](long long over, long long under) {
    const long long d = std::abs(under);
    return d / std::gcd(over, d);
  };
  return std::lcm(
      std::lcm(denominator(1LL * z.P1 * z.R2, gap), denominator(1LL * z.R1 * z.R2, gap)),
      denominator(1LL * z.R1 * z.P1 * z.R2, z.S * gap));
}

TurnWindow turn_window(const train::ToothSet& z, int samples_per_tooth) {
  constexpr int kLeast = 8;
  if (samples_per_tooth < kLeast) {
    throw std::invalid_argument(fmt::format(
        "turn_window: {} samples per tooth, allowed: {} or more", samples_per_tooth, kLeast));
  }
  constexpr long long kLongest = 4;
  constexpr double kPart = 2.0;
  const long long period = turn_period(z);
  const double revolutions = period <= kLongest ? static_cast<double>(period) : kPart;
  const double carrier = train::speed_ratios(z).carrier;
  const double meshing = std::max(z.R1 * std::abs(carrier), z.R2 * std::abs(1.0 - carrier));
  return {
      .revolutions = revolutions,
      .samples = static_cast<std::size_t>(std::ceil(samples_per_tooth * meshing * revolutions))};
}

namespace {

/// Revolutions of the output at a sample of a window.
double revolutions_at(const TurnWindow& window, std::size_t sample) {
  return window.revolutions * static_cast<double>(sample) / static_cast<double>(window.samples);
}

}  // namespace

std::vector<TurningPlays::Angles> turning_angles(const TurningPlays& plays,
                                                 const TurnWindow& window) {
  std::vector<TurningPlays::Angles> angles;
  angles.reserve(window.samples);
  for (std::size_t i = 0; i < window.samples; ++i) {
    angles.push_back(plays.angles(revolutions_at(window, i)));
  }
  return angles;
}

Turn turn(const OutputLevers& levers, const TurningPlays& plays, const TurnWindow& window) {
  if (!(window.revolutions > 0.0) || window.samples == 0) {
    throw std::invalid_argument(
        fmt::format("turn: {} samples over {} revolutions, allowed: at least 1 over more than 0",
                    window.samples, window.revolutions));
  }
  return turn(levers, plays, window, turning_angles(plays, window));
}

Turn turn(const OutputLevers& levers, const TurningPlays& plays, const TurnWindow& window,
          const std::vector<TurningPlays::Angles>& angles) {
  if (angles.size() != window.samples) {
    throw std::invalid_argument(
        fmt::format("turn: angles of {} samples, allowed: of {}", angles.size(), window.samples));
  }
  Turn result{
      .window = window, .points = {}, .least_margin_m = std::numeric_limits<double>::infinity()};
  result.points.reserve(window.samples);
  for (std::size_t i = 0; i < window.samples; ++i) {
    const double revolutions = revolutions_at(window, i);
    const double angle = kTurn * revolutions;
    const OutputRange range = output_range(levers, plays.at(angles[i]));
    if (range.margin_m < result.least_margin_m) {
      result.least_margin_m = range.margin_m;
      result.least_margin_angle_rad = angle;
    }
    if (range.assembles()) {
      result.mean_lower_rad += range.lower_rad;
      result.mean_upper_rad += range.upper_rad;
    } else {
      ++result.jammed;
    }
    result.points.push_back({.angle_rad = angle, .range = range});
  }
  const auto counted =
      static_cast<double>(std::max<std::size_t>(1, window.samples - result.jammed));
  result.mean_lower_rad /= counted;
  result.mean_upper_rad /= counted;
  return result;
}

}  // namespace gear3k::backlash
