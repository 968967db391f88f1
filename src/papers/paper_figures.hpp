#pragma once
// The low-backlash paper's Figs. 6 to 8 from our own models: tooth sets at zero profile shift, the
// same sets refined, and maps about the published gear.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "optimize/optimizer.hpp"
#include "optimize/tooth_search.hpp"
#include "papers/reproduce.hpp"

namespace gear3k::papers {

/// Names of the figures' files, without .csv and .svg.
inline constexpr std::array<const char*, 5> kFigureNames{"fig6", "fig7", "fig8a", "fig8b", "fig8c"};

/// Fig. 6 shows ratios within this share of the task's target.
inline constexpr double kScatterTolerance = 0.05;

/// Upper limits φ_U of the lost motion that Fig. 7's sets are refined under [arcmin].
inline constexpr std::array<double, 4> kRefinementLimits_arcmin{2.0, 4.0, 8.0, 18.0};
inline constexpr std::size_t kLimits = kRefinementLimits_arcmin.size();

/// A tooth set at zero profile shift, meshes P1-R1 and P2-R2 closed but for the allowance, at the
/// module with which the gearbox has the paper's outer diameter.
struct ZeroShiftPoint {
  optimize::Candidate candidate;
  double ratio = 0.0;
  double eta_b = 0.0, eta_f = 0.0;
  double lost_motion_rad = 0.0;  ///< by the task's model
  std::array<double, train::kMeshCount> contact_ratio{};
  std::array<double, 2> module_m{};
  double center_distance_m = 0.0;
};

/// Fig. 6: every tooth set near the ratio that meshes at zero shift, by ratio, then teeth.
struct RatioScatter {
  std::uint64_t within_ratio = 0;  ///< sets within the task's ranges, before assembly rules
  std::size_t assembled = 0;       ///< of those, sets that can be assembled
  std::vector<ZeroShiftPoint> points;
};

/// One tooth set of Fig. 7.
struct RefinedPoint {
  std::size_t scatter_index = 0;  ///< in RatioScatter::points
  /// Checks of the task that zero shift fails, lost motion apart, in the order of the registry.
  std::vector<std::string> zero_shift_fails;
  double zero_shift_kinematic_rad = 0.0;
  /// For each of kRefinementLimits_arcmin.
  std::array<optimize::RefinedSet, kRefinementLimits_arcmin.size()> refined;
  std::array<double, kRefinementLimits_arcmin.size()> refined_kinematic_rad{};  ///< where optimal
};

/// An input of the published gear that a map varies.
struct VariedInput {
  std::string name;            ///< column and axis, e.g. "x_R1"
  units::Unit unit;            ///< of the axis
  double published = 0.0;      ///< SI
  std::vector<double> values;  ///< SI, rising, `published` among them
};

struct FigureMapPoint {
  /// "ok"; "undefined" where a mesh has no working angle; else the first check that fails, with the
  /// mesh or gear that it is of.
  std::string status;
  // The rest only when ok.
  double eta_b = 0.0, eta_f = 0.0;
  double paper_rad = 0.0, kinematic_rad = 0.0;  ///< lost motion at the output
};

/// A map over one or two inputs; all others as published.
struct FigureMap {
  VariedInput x;
  std::optional<VariedInput> y;
  std::vector<FigureMapPoint> points;  ///< y fastest

  [[nodiscard]] std::size_t rows() const { return y ? y->values.size() : 1; }
};

struct PaperFigures {
  optimize::Specification task;
  PaperStatements statements;
  double published_center_distance_m = 0.0;      ///< what Fig. 8 holds fixed
  design::Design published;                      ///< with the task's allowance, friction and limits
  double rim_m = 0.0;                            ///< between a ring's root circle and the outside
  RatioScatter scatter;                          ///< Fig. 6
  std::vector<RefinedPoint> refined;             ///< Fig. 7: sets within the task's own tolerance
  FigureMap ring_shifts, modules, planet_shift;  ///< Fig. 8 a, b, c
};

/// Computes everything, OpenMP over sets and points; the result does not depend on the number of
/// threads.
///
/// Fig. 7 refines the sets of Fig. 6 within the task's tolerance, "every feasible solution
/// identified in the exhaustive search", once for each limit of the lost motion.  Fig. 8 keeps the
/// centre distance at that of the published gear (mesh P1-R1 without backlash at q = 0), and all
/// inputs but the varied ones.
/// Source: low-backlash paper, Sec. IV and Figs. 6 to 8; what it leaves open is in
/// docs/interface.md, "Figures of `reproduce`".
/// @throws std::invalid_argument when the published gear has no defined geometry
PaperFigures paper_figures(const PublishedSources& sources);

}  // namespace gear3k::papers
