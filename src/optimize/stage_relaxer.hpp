#pragma once
// The stages that tooth sets share, each relaxed by itself.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "optimize/shift_range.hpp"
#include "optimize/stage_flanks.hpp"
#include "optimize/stage_relaxation.hpp"
#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

/// Whether a specification has bounds: not with a free pressure angle, nor with a thinning in um
/// of modules that are to be chosen.
inline bool has_bounds(const Specification& spec) {
  return !spec.free.pressure_angle_rad && !thinning_varies(spec);
}

/// The distinct stages of tooth sets, and that of each set.
struct StageKeys {
  std::array<std::vector<Candidate>, 2> keys;  ///< by stage; the other stage's teeth are 0
  std::array<std::vector<std::uint32_t>, 2> of;
};
StageKeys stage_keys(std::span<const Candidate> candidates);

/// Shares of the lost motion that stages are relaxed with; the last is all of it.
inline constexpr std::size_t kMostLevels = 4;

struct RelaxationEffort {
  StageEffort weighted, alone;  ///< for both losses together, for one of them
};

/// Centre distances of a stage [m]: where its flanks and roots are to carry the load at least, and
/// what it can have at most.
struct StageReach {
  double least_m = 0.0, most_m = kInfinity;
  bool by_root = false;  ///< a root asks for more at the least than the flanks do
};

struct Stage1Level {
  bool empty = true;
  double sun = 0.0, ring = 0.0;  ///< least loss of S-P1, of P1-R1
  double weighted = 0.0;         ///< least of sun_weight · loss S-P1 + loss P1-R1
  StagePoint point;
};
struct Stage2Level {
  bool empty = true;
  double ring = 0.0;
  StagePoint point;
};

inline constexpr Interval kNowhere{kInfinity, -kInfinity};
struct RelaxedStage1 {
  double sun_weight = 1.0;
  double most_distance = 0.0;  ///< greatest centre distance [modules]
  std::array<Stage1Level, kMostLevels> level;
  Interval distance = kNowhere;  ///< holds all centre distances [modules]
  StageReach reach;
  std::optional<Infeasibility> infeasible;
};
struct RelaxedStage2 {
  std::array<Stage2Level, kMostLevels> level;
  Interval distance = kNowhere;
  StageReach reach;
  std::optional<Infeasibility> infeasible;
};

/// Relaxes stages under the limits of a specification.
class StageRelaxer {
 public:
  /// @param spec  must outlive it, as must `keys`
  /// @param stages  which of them are relaxed
  StageRelaxer(const Specification& spec, const StageKeys& keys,
               std::span<const Candidate> candidates, std::array<bool, 2> stages = {true, true});

  /// How a stage is relaxed.
  struct Ask {
    RelaxationEffort effort;
    /// Of stage 1; empty: that of a typical loss factor.
    std::optional<double> sun_weight{};
    /// Where the centre distance is looked for [modules].
    Interval distance{0.0, kInfinity};
    bool named = true;  ///< whether what an empty stage is owed to is found out
  };
  /// @param key  index into keys[0]
  [[nodiscard]] RelaxedStage1 relax1(std::size_t key, const Ask& ask) const;
  /// @param key  index into keys[1]  @param most_distance  of any stage 1 [modules]
  [[nodiscard]] RelaxedStage2 relax2(std::size_t key, const Ask& ask, double most_distance) const;

  [[nodiscard]] std::size_t levels() const { return levels_; }
  [[nodiscard]] const ShiftTable& shifts() const { return shifts_; }
  /// What flanks and roots of a stage ask; null where nothing is.
  [[nodiscard]] const StageFlanks* flanks_of(std::size_t stage, std::size_t key) const {
    return flanks_[stage].empty() ? nullptr : &flanks_[stage][key];
  }

 private:
  [[nodiscard]] static StageReach reach_of(StageTask task, const RelaxationEffort& effort);
  void take_flanks(std::size_t stage, const StageKeys& keys, std::span<const Candidate> candidates);
  [[nodiscard]] double share_of(std::size_t level) const;

  const Specification* spec_;
  const StageKeys* keys_;
  ShiftTable shifts_;
  std::size_t levels_ = 1;
  std::array<std::vector<StageFlanks>, 2> flanks_;  ///< by stage; empty without a rating
};

}  // namespace gear3k::optimize
