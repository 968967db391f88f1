#include "design/built_series.hpp"

#include <algorithm>

#include "backlash/first_contact.hpp"
#include "design/evaluation.hpp"

namespace gear3k::design {

namespace {

double quantile(std::vector<double>& values, double probability) {
  if (values.empty()) return 0.0;
  const auto place =
      static_cast<std::ptrdiff_t>(probability * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + place);
  return values[static_cast<std::size_t>(place)];
}

FirstContactRooms first_contact_rooms(const backlash::ClearanceModel& model,
                                      const backlash::RandomGearbox& gearboxes,
                                      std::uint64_t samples) {
  FirstContactRooms result;
  const auto planets = static_cast<std::size_t>(model.planets);
  std::vector<std::vector<double>> by_rank(planets);
  double share = 0.0;
  for (std::uint64_t i = 0; i < samples; ++i) {
    const auto plays = backlash::plays(model, gearboxes.deviations(i));
    if (!backlash::output_range(model.levers, plays).assembles()) continue;
    ++result.samples;
    for (const bool greatest : {false, true}) {
      backlash::FirstContact contact = backlash::first_contact(model.levers, plays, greatest);
      share += 0.5 * *std::ranges::max_element(contact.share);
      std::ranges::sort(contact.room_m);
      for (std::size_t k = 0; k < planets; ++k) by_rank[k].push_back(contact.room_m[k]);
    }
  }
  if (result.samples > 0) result.greatest_share = share / static_cast<double>(result.samples);
  for (std::vector<double>& rooms : by_rank) {
    result.median_m.push_back(quantile(rooms, 0.5));
    result.percent95_m.push_back(quantile(rooms, 0.95));
  }
  return result;
}

}  // namespace

std::optional<backlash::ClearanceModel> clearance_model_of(const Design& design) {
  if (!design.tolerances || why_undefined(design)) return std::nullopt;
  return backlash::clearance_model(resolved_parameters(design), *design.tolerances);
}

BuiltSeries build_series(const Design& design, const backlash::ClearanceModel& model,
                         std::uint64_t share_samples, const backlash::SeriesProgress& progress) {
  const auto samples = static_cast<std::uint64_t>(design.sampling.samples);
  const bool paper = design.limits.model == backlash::LostMotionModel::kPaper;
  backlash::MonteCarloOptions options{
      .samples = samples,
      .seed = design.sampling.seed,
      .scatter = {.scatter = design.tolerances->scatter,
                  .sigma_level = design.tolerances->sigma_level},
      .limit_rad = paper ? std::nullopt : design.limits[CheckId::kOutputBacklashMax],
      .progress = progress};
  BuiltSeries series{
      .model = model,
      .scatter = options.scatter,
      .seed = options.seed,
      .limit_rad = options.limit_rad,
      .result = backlash::monte_carlo(model, options),
      .shares = {},
      .rooms = {},
      .thermal = {},
      .turn = {},
      .paper_limit = paper && design.limits[CheckId::kOutputBacklashMax].has_value()};
  series.rooms =
      first_contact_rooms(model, backlash::RandomGearbox(model, options.scatter, options.seed),
                          std::min(samples, kRoomSamples));
  options.samples = std::min(samples, share_samples);
  // The shares' own count is not that of the series; they can be stopped all the same.
  options.progress = [&](std::uint64_t) { return !progress || progress(series.result.samples); };
  series.shares = backlash::tolerance_shares(model, options);
  series.thermal = thermal_series(design, model, options);
  return series;
}

std::optional<BuiltSeries> table_series(Design design) {
  constexpr std::int64_t kMostSamples = 200'000;
  constexpr std::uint64_t kMostShareSamples = 20'000;
  const auto model = clearance_model_of(design);
  if (!model) return std::nullopt;
  design.sampling.samples = std::min(design.sampling.samples, kMostSamples);
  return build_series(design, *model, kMostShareSamples, {});
}

}  // namespace gear3k::design
