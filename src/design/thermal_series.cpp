#include "design/thermal_series.hpp"

#include <array>

#include "backlash/unequal_mesh.hpp"
#include "design/evaluation.hpp"

namespace gear3k::design {

namespace {

using MeshPlays = std::array<double, train::kMeshCount>;

/// Play of every mesh of a design that has grown; empty where one has no working angle.
std::optional<MeshPlays> grown_plays(const Design& design, const train::ThermalState& state,
                                     bool least) {
  const train::ThermalRange& range = *design.thermal;
  const auto parameters = resolved_parameters(design);
  const auto gears = train::make_train_gears(parameters);
  const auto grown = [&](int gear) {
    const auto i = static_cast<std::size_t>(gear);
    return train::grown_gear(gears[i],
                             train::growth_factor(range.gear[i], range.reference_K, state));
  };
  const double distance_m =
      parameters.center_distance_m * train::growth_factor(range.carrier, range.reference_K, state);
  MeshPlays plays{};
  for (std::size_t k = 0; k < plays.size(); ++k) {
    const auto mesh = backlash::make_unequal_mesh(grown(train::kMeshGears[k][0]),
                                                  grown(train::kMeshGears[k][1]), distance_m);
    if (!mesh.has_working_angle) return std::nullopt;
    plays[k] = least ? mesh.least_backlash_m : mesh.normal_backlash_m;
  }
  return plays;
}

}  // namespace

std::optional<backlash::ClearanceModel> thermal_clearance(const Design& design,
                                                          const backlash::ClearanceModel& model,
                                                          const train::ThermalState& state,
                                                          bool least) {
  const train::ThermalState as_drawn{.temperature_K = design.thermal->reference_K};
  const auto drawn = grown_plays(design, as_drawn, false);
  const auto grown = grown_plays(design, state, least);
  if (!drawn || !grown) return std::nullopt;
  backlash::ClearanceModel moved = model;
  for (int planet = 0; planet < model.planets; ++planet) {
    for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
      const auto k = static_cast<std::size_t>(mesh);
      const double half = 0.5 * ((*grown)[k] - (*drawn)[k]);
      moved.middle_m[backlash::bound_index(planet, mesh, true)] += half;
      moved.middle_m[backlash::bound_index(planet, mesh, false)] -= half;
    }
  }
  return moved;
}

std::vector<ThermalSeries> thermal_series(const Design& design,
                                          const backlash::ClearanceModel& model,
                                          backlash::MonteCarloOptions options) {
  std::vector<ThermalSeries> ends;
  if (!design.thermal) return ends;
  options.limit_rad = design.limits[CheckId::kThermalLostMotion];
  for (int end = 0; end < train::end_count(*design.thermal); ++end) {
    const train::ThermalState state = train::end_state(*design.thermal, end);
    const auto mean = thermal_clearance(design, model, state, false);
    const auto least = thermal_clearance(design, model, state, true);
    if (!mean || !least) continue;
    ends.push_back({.state = state,
                    .result = backlash::monte_carlo(*mean, options),
                    .jammed = backlash::monte_carlo(*least, options).jammed});
    // A series that was stopped has no part of the others.
    if (ends.back().result.samples < options.samples) {
      ends.pop_back();
      break;
    }
  }
  return ends;
}

}  // namespace gear3k::design
