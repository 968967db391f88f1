#pragma once
// Upper bounds of the efficiency of every tooth set, from the least losses of its stages.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "optimize/progress.hpp"
#include "optimize/shift_range.hpp"
#include "optimize/stage_flanks.hpp"
#include "optimize/stage_relaxation.hpp"
#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

struct SetBound {
  bool known = false;  ///< else nothing is known of the set but a proof of infeasible shifts
  std::optional<Infeasibility> infeasible;
  double eta_b = 1.0, eta_f = 1.0;  ///< no feasible design of the set has more; 0 = cannot run so
  /// Where both stages come nearest to it: shifts, and both distances in modules.
  StagePoint stage1, stage2;
  std::array<double, train::kMeshCount> losses{};  ///< of the meshes about there
};

/// Whether a specification has bounds: not with a free pressure angle, nor with a thinning in um
/// of modules that are to be chosen.
inline bool has_bounds(const Specification& spec) {
  return !spec.free.pressure_angle_rad && !thinning_varies(spec);
}

/// Bounds of all tooth sets of a specification; unknown unless has_bounds().
///
/// Efficiency rises with that of each mesh, so that least losses give most efficiency.  Stage 1
/// (S, P1, R1) and stage 2 (P2, R2) are relaxed apart: what ties them (the centre distance in
/// metres) is dropped, lost motion that they share is split between them in every way.  Tooth
/// sets share stages, and each stage is searched once.  With a rating the flanks of each mesh ask
/// for a module, and those of each stage for a centre distance that the other one has to have.
/// Source: own derivation, docs/theory §32, §36.
class SetBounds {
 public:
  /// Relaxes the stages of these tooth sets; OpenMP over the stages, results independent of it.
  /// @param candidates  must outlive the bounds, as must the specification
  /// @param progress  its stop ends the work early: bounds must not be asked for then
  SetBounds(const Specification& spec, std::span<const Candidate> candidates, Progress& progress);

  /// @param k  index into the candidates
  [[nodiscard]] SetBound of(std::size_t k) const;
  /// The bound of one set with 100 times the effort.
  [[nodiscard]] SetBound sharpened(std::size_t k) const;
  /// Stages relaxed, of both kinds.
  [[nodiscard]] std::size_t stages() const { return stage1_.size() + stage2_.size(); }
  [[nodiscard]] const ShiftTable& shifts() const { return shifts_; }

 private:
  /// Shares of the lost motion that stages are relaxed with; the last is all of it.
  static constexpr std::size_t kMostLevels = 4;
  struct Effort {
    StageEffort weighted, alone;  ///< for both losses together, for one of them
  };
  static constexpr Effort kUsual{.weighted = {.boxes = 200, .tolerance = 0.02},
                                 .alone = {.boxes = 24, .tolerance = 0.1}};
  static constexpr Effort kSharp{.weighted = {.boxes = 20000, .tolerance = 1e-4},
                                 .alone = {.boxes = 2000, .tolerance = 1e-3}};

  /// Centre distances of a stage [m]: where its flanks are to carry the load at least, and what it
  /// can have at most.
  struct Reach {
    double least_m = 0.0, most_m = kInfinity;
  };
  static constexpr Interval kNowhere{kInfinity, -kInfinity};
  struct Stage1Level {
    bool empty = true;
    double sun = 0.0, ring = 0.0;  ///< least loss of S-P1, of P1-R1
    double weighted = 0.0;         ///< least of sun_weight · loss S-P1 + loss P1-R1
    StagePoint point;
  };
  struct Stage1 {
    double sun_weight = 1.0;
    double most_distance = 0.0;  ///< greatest centre distance [modules]
    std::array<Stage1Level, kMostLevels> level;
    Interval distance = kNowhere;  ///< holds all centre distances [modules]
    Reach reach;
    std::optional<Infeasibility> infeasible;
  };
  struct Stage2Level {
    bool empty = true;
    double ring = 0.0;
    StagePoint point;
  };
  struct Stage2 {
    std::array<Stage2Level, kMostLevels> level;
    Interval distance = kNowhere;
    Reach reach;
    std::optional<Infeasibility> infeasible;
  };

  /// @param flanks  null where nothing is asked of them
  [[nodiscard]] Stage1 relax1(const Candidate& key, const Effort& effort,
                              std::optional<double> sun_weight, const StageFlanks* flanks) const;
  [[nodiscard]] Stage2 relax2(const Candidate& key, const Effort& effort,
                              const StageFlanks* flanks) const;
  [[nodiscard]] static Reach reach_of(StageTask task, const Effort& effort);
  /// Proof that the flanks of one stage ask for a centre distance that the other cannot have.
  [[nodiscard]] std::optional<Infeasibility> flanks_apart(const Reach& stage1,
                                                          const Reach& stage2) const;
  /// What the flanks of a stage ask; null where nothing is.
  [[nodiscard]] const StageFlanks* flanks_of(std::size_t stage, std::size_t key) const;
  void take_flanks(std::size_t stage, std::span<const Candidate> keys);
  [[nodiscard]] SetBound combine(std::size_t k, const Stage1& stage1, const Stage2& stage2) const;
  [[nodiscard]] double share_of(std::size_t level) const;

  const Specification* spec_;
  std::span<const Candidate> candidates_;
  ShiftTable shifts_;
  std::size_t levels_ = 1;
  double most_distance_ = 0.0;  ///< of any stage 1 [modules]
  std::optional<Infeasibility> of_any_set_;
  std::vector<Stage1> stage1_;
  std::vector<Stage2> stage2_;
  std::vector<std::uint32_t> stage1_of_, stage2_of_;
  std::array<std::vector<StageFlanks>, 2> flanks_;  ///< by stage; empty without a rating
};

}  // namespace gear3k::optimize
