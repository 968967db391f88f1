#include "report/turn_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>

#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using backlash::OrderFit, backlash::OrderPart, backlash::Turn, backlash::TurnPoint,
    backlash::TurnQuantity;

constexpr std::array<TurnQuantity, 3> kQuantities{
    TurnQuantity::kLostMotion, TurnQuantity::kErrorForward, TurnQuantity::kErrorBackward};

std::string quantity_name(std::size_t quantity) {
  return std::string(backlash::kTurnQuantityNames[quantity]);
}

struct Extremes {
  double least, greatest;
};
/// Over the angles where it assembles.
std::optional<Extremes> extremes_of(const Turn& turn, TurnQuantity quantity) {
  std::optional<Extremes> e;
  for (const TurnPoint& point : turn.points) {
    if (!point.range.assembles()) continue;
    const double value = value_of(turn, point, quantity);
    if (!e) e = Extremes{.least = value, .greatest = value};
    e->least = std::min(e->least, value);
    e->greatest = std::max(e->greatest, value);
  }
  return e;
}

std::string range_table(const Turn& turn) {
  TextTable table({"over the turn (arcmin)", "least", "greatest", "peak to peak"});
  for (std::size_t q = 0; q < kQuantities.size(); ++q) {
    const auto e = extremes_of(turn, kQuantities[q]);
    if (!e) continue;
    table.add({quantity_name(q), fixed(arcmin(e->least), 3), fixed(arcmin(e->greatest), 3),
               fixed(arcmin(e->greatest - e->least), 3)});
  }
  return table.text(2);
}

std::string margin_text(const Turn& turn) {
  const std::string at = fmt::format("{} um at {} deg", fixed(um(turn.least_margin_m), 2),
                                     fixed(degrees(turn.least_margin_angle_rad), 3));
  if (!turn.jams()) return fmt::format("  Assembles at every angle; least margin {}.\n", at);
  const double share = static_cast<double>(turn.jammed) / static_cast<double>(turn.points.size());
  return fmt::format("  Jams at {} of {} angles ({} %); least margin {}.\n", turn.jammed,
                     turn.points.size(), fixed(percent(share), 1), at);
}

/// The strongest orders of a quantity, and how much of its variance they and the others explain.
std::string orders_table(const OrderFit& fit, std::size_t quantity) {
  if (!(fit.variance_rad2 > 0.0))
    return fmt::format("\n  {}: does not vary\n", quantity_name(quantity));
  constexpr std::size_t kMost = 8;
  constexpr double kLeastShare = 1e-3;
  std::vector<const OrderPart*> parts;
  parts.reserve(fit.parts.size());
  for (const OrderPart& part : fit.parts) {
    if (part.share >= kLeastShare) parts.push_back(&part);
  }
  std::ranges::stable_sort(parts, std::ranges::greater{}, &OrderPart::share);
  if (parts.size() > kMost) parts.resize(kMost);
  TextTable table({quantity_name(quantity), "order (per turn of R2)", "amplitude (arcmin)",
                   "phase (deg)", "share of variance (%)"});
  double others = 1.0 - fit.rest;
  for (const OrderPart* part : parts) {
    others -= part->share;
    table.add({order_name(part->order), fmt::format("{:.4f}", part->order.order()),
               fixed(arcmin(part->amplitude_rad), 4), fixed(degrees(part->phase_rad), 1),
               fixed(percent(part->share), 2)});
  }
  if (parts.size() < fit.parts.size()) {
    table.add({"other orders", "", "", "", fixed(percent(others), 2)});
  }
  table.add({"rest", "", "", "", fixed(percent(fit.rest), 2)});
  return '\n' + table.text(2);
}

}  // namespace

std::string order_name(const backlash::TurnOrder& order) {
  std::string name = order.of.body;
  if (name.starts_with("stage")) name = "teeth of " + name;
  if (order.of.rolling) name += " against the carrier";
  return order.multiple == 1 ? name : fmt::format("{} x {}", order.multiple, name);
}

std::string turn_table(const TurnResult& result) {
  const Turn& turn = result.turn;
  std::string text = fmt::format("{}: one built gearbox over {:g} revolutions of R2, {} angles\n",
                                 result.name, turn.window.revolutions, turn.points.size());
  text += range_table(turn) + margin_text(turn);
  if (result.fits.empty()) {
    return text + "  No orders: it assembles at too few angles.\n";
  }
  for (std::size_t q = 0; q < result.fits.size(); ++q) text += orders_table(result.fits[q], q);
  return text;
}

std::string turn_csv(const TurnResult& result) {
  std::string text =
      csv_line({"output_angle_deg", "lost_motion_arcmin", "transmission_error_forward_arcmin",
                "transmission_error_backward_arcmin", "margin_um"});
  for (const TurnPoint& point : result.turn.points) {
    const bool fits = point.range.assembles();
    std::vector<std::string> row{exact(clean(degrees(point.angle_rad)))};
    row.reserve(kQuantities.size() + 2);
    for (const TurnQuantity quantity : kQuantities) {
      row.push_back(fits ? exact(clean(arcmin(value_of(result.turn, point, quantity)))) : "");
    }
    row.push_back(exact(clean(um(point.range.margin_m))));
    text += csv_line(row);
  }
  return text;
}

std::string turn_orders_csv(const TurnResult& result) {
  std::string text = csv_line(
      {"quantity", "order_of", "order", "amplitude_arcmin", "phase_deg", "share_of_variance"});
  for (std::size_t q = 0; q < result.fits.size(); ++q) {
    const OrderFit& fit = result.fits[q];
    for (const OrderPart& part : fit.parts) {
      text += csv_line({quantity_name(q), order_name(part.order), exact(clean(part.order.order())),
                        exact(clean(arcmin(part.amplitude_rad))),
                        exact(clean(degrees(part.phase_rad))), exact(clean(part.share))});
    }
    text += csv_line({quantity_name(q), "rest", "", "", "", exact(clean(fit.rest))});
    text += csv_line({quantity_name(q), "mean", "0", exact(clean(arcmin(fit.mean_rad))), "", ""});
  }
  return text;
}

}  // namespace gear3k::report
