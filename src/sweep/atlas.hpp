#pragma once
// The atlas: results of one sweep of ours (examples/sweep/atlas.toml), part of the program.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/plot.hpp"
#include "sweep/rows.hpp"
#include "train/tooth_set.hpp"

namespace gear3k::sweep {

std::string_view atlas_csv();    ///< of data/atlas.zip
std::string_view atlas_sweep();  ///< examples/sweep/atlas.toml

/// A task of the atlas, and its best design.
struct AtlasPoint {
  double ratio_target = 0.0;
  int planets = 0;
  double backlash_arcmin = 0.0, friction = 0.0;  ///< limit of lost motion, coefficient
  struct Best {
    train::ToothSet teeth;
    double eta_b = 0.0, eta_f = 0.0;
    double bound = 0.0;  ///< of eta_b: no design of the task is above
    std::array<double, 2> module_mm{};
    double ring_root_diameter_mm = 0.0, torque_capacity_nm = 0.0;
  };
  std::optional<Best> best;  ///< none where no design keeps every limit
};
/// In the order of the sweep: ratio, planets, backlash, friction.
const std::vector<AtlasPoint>& atlas();

struct AtlasQuestion {
  double ratio = 0.0;
  std::optional<int> planets{};
  std::optional<double> backlash_arcmin{};  ///< the loosest limit of the atlas that keeps it
  std::optional<double> friction{};         ///< the nearest of the atlas
};
/// What of a question is beyond the atlas's ratios, numbers of planets or least limit; "" =
/// nothing.
std::string atlas_error(const AtlasQuestion& question);
/// The points of the atlas at its ratio nearest to the one asked for, by proportion.
/// @throws io::InvalidInput beyond its ratios, numbers of planets or least limit
std::vector<AtlasPoint> atlas_near(const AtlasQuestion& question);
/// Where the points of an answer lie that is not what was asked for, "" where it is:
/// "the atlas's nearest: ratio 39.36 (43 was asked for), lost motion within 5 arcmin (7 was asked
/// for)".
/// @param points  of atlas_near(), at least one
std::string atlas_snap_text(const AtlasQuestion& question, const std::vector<AtlasPoint>& points);
Rows atlas_rows(const std::vector<AtlasPoint>& points);

/// A SPEC to begin with: the task of the atlas at the ratio asked for itself, and where it is not
/// said otherwise at the planets, limit and friction of the point with most backward efficiency.
std::string atlas_task(const AtlasQuestion& question);

/// Backward efficiency over the ratio, a figure for each limit of lost motion, a point for each
/// task, looks for planets and frictions; the published 3K gearboxes that keep the figure's limit
/// and size, measured.
std::vector<report::Plot> atlas_plots();

}  // namespace gear3k::sweep
