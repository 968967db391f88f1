#pragma once
// Lost motion and transmission error of one built gearbox over the output's angle.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "backlash/clearance_model.hpp"

namespace gear3k::backlash {

/// By how much single flanks stand off their places: arcs on the reference circle [m], positive
/// towards increasing angle, drawn within ± f_pt/2 of the gear (kSinglePitch).
struct ToothErrors {
  /// Of each gear by flank_place(); empty: none.  Of P1 and P2 those of all planets.
  std::array<std::vector<double>, train::kGearCount> flank_m{};
};
/// @param upper  the flank of a tooth on the side of greater angles
constexpr std::size_t flank_place(int teeth, int planet, int tooth, bool upper) {
  return 2U * (static_cast<std::size_t>(planet) * static_cast<std::size_t>(teeth) +
               static_cast<std::size_t>(tooth)) +
         (upper ? 1U : 0U);
}
/// Flanks of a gear, of a planet's step those of all planets.
std::size_t flank_count(const train::ToothSet& z, int gear, int planets);

/// Plays over the output's angle, sun and output turning at their ratio.
///
///   bound(φ) = constant + Σ_bodies (c cos ρ + s sin ρ) + single pitches of the touching flanks,
///   ρ = φ (w_body − w_C)/w_R2
///
/// Run-out and cumulative pitch turn with sun, planets, R1 and R2 in the frame of the carrier; pins
/// and all that is not planar stay.  In each mesh the two flanks nearest to the pitch point touch,
/// from half a pitch before it to half a pitch after; there the next ones take over, in a step.
/// Source: own derivation, docs/theory §34.
/// Truncation: as of ClearanceModel.  Does not cover: two pairs of teeth sharing a mesh, of which
/// the tighter one would hold the bound; tip contact ahead of the path of contact.
class TurningPlays {
 public:
  static constexpr std::size_t kBodies = 4;  ///< sun, planet, R1, R2
  /// The teeth whose flanks touch at one bound.
  struct Touching {
    std::size_t central = 0, planet = 0;
  };
  /// cos ρ and sin ρ of the bodies at one angle of the output, and the teeth at every bound; these
  /// only where the model has single pitches.
  struct Angles {
    std::array<double, kBodies> cosine{}, sine{};
    std::vector<Touching> touching{};
  };

  /// @param values  one for each of model.deviations; those of single pitches count nothing, the
  ///                errors of the teeth stand for them
  /// @param z       tooth numbers of the model's train
  /// @throws std::invalid_argument for another number of values or of flanks
  TurningPlays(const ClearanceModel& model, const train::ToothSet& z,
               std::span<const DeviationValue> values, const ToothErrors& errors = {});

  /// Where the output stands at as many revolutions; the same for every gearbox of a train.
  [[nodiscard]] Angles angles(double revolutions) const;
  /// Plays there.
  [[nodiscard]] std::vector<PlanetPlay> at(const Angles& angles) const;
  [[nodiscard]] std::vector<PlanetPlay> at(double revolutions) const {
    return at(angles(revolutions));
  }
  [[nodiscard]] int planets() const { return planets_; }

 private:
  /// How the teeth pass one bound's place.
  struct Passing {
    double start = 0.0;     ///< central gear's tooth at φ = 0, as a real number
    double per_turn = 0.0;  ///< by how many teeth that falls per revolution of the output
    long long offset = 0;   ///< planet's tooth = offset ± central gear's
    bool internal = false;
    int central_teeth = 0, planet_teeth = 0;
  };
  /// What the flanks that touch there add, for each tooth; empty: nothing.
  struct Flanks {
    std::size_t bound = 0;
    std::vector<double> central_m, planet_m;
  };

  void add_teeth(const ClearanceModel& model, const train::ToothSet& z, const ToothErrors& errors);

  int planets_ = 0;
  std::array<double, kBodies> rate_{};  ///< signed revolutions against the carrier per output's
  std::vector<PlanetPlay> constant_;
  std::array<std::vector<PlanetPlay>, kBodies> cosine_, sine_;  ///< empty: the body adds nothing
  std::vector<Passing> passing_;                                ///< of every bound
  std::vector<Flanks> flanks_;
};

/// Whole revolutions of the output after which all bodies stand against the carrier as before.
long long turn_period(const train::ToothSet& z);

struct TurnWindow {
  double revolutions = 0.0;  ///< of the output, > 0
  std::size_t samples = 0;   ///< evenly spaced, the end of the window not among them
};
/// The whole period where that is at most 4 revolutions, else 2: orders that differ by half a
/// period per revolution can then be told apart (those of R1 and R2 differ by 1).
/// @param samples_per_tooth  of the faster mesh, at least 8
TurnWindow turn_window(const train::ToothSet& z, int samples_per_tooth = 8);

/// The output at one angle.  Where it does not assemble, lower and upper mean nothing.
struct TurnPoint {
  double angle_rad = 0.0;  ///< of the output, had nothing a deviation
  OutputRange range;

  [[nodiscard]] double lost_motion_rad() const { return range.width_rad(); }
};

/// Over a window.  The sun is held at ratio times the angle; the output then stands in
/// [angle + lower, angle + upper].  Loaded one way it rests at one end, loaded the other way at the
/// other: without friction it goes where the load drives it, whatever the sign of 1 − G2.  Turning
/// towards increasing output angle,
///
///   forward   (the sun drives, the load holds R2 back)    output − sun/ratio = lower
///   backward  (R2 drives, the sun is held back)           output − sun/ratio = upper
///
/// and the other way round when turning towards decreasing angle.
struct Turn {
  TurnWindow window;
  std::vector<TurnPoint> points{};
  double least_margin_m = 0.0;
  double least_margin_angle_rad = 0.0;
  std::size_t jammed = 0;  ///< points where it does not assemble
  /// Means of lower and upper over the points where it assembles: what is constant is no
  /// transmission error.
  double mean_lower_rad = 0.0, mean_upper_rad = 0.0;

  [[nodiscard]] bool jams() const { return jammed > 0; }
  [[nodiscard]] double error_forward_rad(const TurnPoint& p) const {
    return p.range.lower_rad - mean_lower_rad;
  }
  [[nodiscard]] double error_backward_rad(const TurnPoint& p) const {
    return p.range.upper_rad - mean_upper_rad;
  }
};
/// @throws std::invalid_argument for a window without length or samples
Turn turn(const OutputLevers& levers, const TurningPlays& plays, const TurnWindow& window);

/// The angles at every sample of a window.
std::vector<TurningPlays::Angles> turning_angles(const TurningPlays& plays,
                                                 const TurnWindow& window);
/// The same for one of many gearboxes of a train: the angles are computed once for all of them.
/// @param angles  turning_angles() of any of them
Turn turn(const OutputLevers& levers, const TurningPlays& plays, const TurnWindow& window,
          const std::vector<TurningPlays::Angles>& angles);

}  // namespace gear3k::backlash
