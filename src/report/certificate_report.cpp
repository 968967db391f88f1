#include "report/certificate_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "report/display.hpp"

namespace gear3k::report {

namespace {

using optimize::OptimizeResult, optimize::Specification;

/// A value of an objective in its unit, SI given.
std::string with_objective_unit(const optimize::ObjectiveRecord& record, double value) {
  return fmt::format("{:.6g}{}{}", value / record.per_unit, record.unit.empty() ? "" : " ",
                     record.unit);
}

/// Which limits of the load the bounds account for; "" without a load.
std::string bounded_strength_text(const optimize::Certificate& c) {
  const auto listed = [](const std::vector<std::string_view>& names) {
    return names.empty() ? std::string("none") : fmt::format("{}", fmt::join(names, ", "));
  };
  if (c.strength_bounded.empty() && c.strength_not_bounded.empty()) return "";
  return fmt::format("; of the limits of the load the bounds account for {}, and not for {}",
                     listed(c.strength_bounded), listed(c.strength_not_bounded));
}

}  // namespace

std::string bound_text(const Specification& spec, double merit) {
  const optimize::ObjectiveRecord& record =
      optimize::objective_record(optimize::first_objective(spec));
  const double value = optimize::sense_of(record.id) * merit / record.per_unit;
  if (value == 0.0) return with_objective_unit(record, 0.0);
  constexpr double kDigits = 6.0;
  const double power = std::pow(10.0, kDigits - 1.0 - std::floor(std::log10(std::abs(value))));
  const double rounded =
      (record.maximise ? std::ceil(value * power) : std::floor(value * power)) / power;
  return with_objective_unit(record, rounded * record.per_unit);
}

io::Json proof_json(const Specification& spec, const optimize::Certificate& c) {
  const optimize::ObjectiveRecord& record =
      optimize::objective_record(optimize::first_objective(spec));
  const auto shown = [&](double merit) -> io::Json {
    if (!std::isfinite(merit)) return nullptr;
    return optimize::sense_of(record.id) * merit / record.per_unit;
  };
  const bool bounded = c.objective_bounded && std::isfinite(c.global_bound);
  return {{"objective", record.name},
          {"unit", record.unit},
          {"best", shown(c.best)},
          {"refined", c.refined},
          {"bounded", c.bounded},
          {"infeasible", c.infeasible},
          {"largest_unrefined_bound",
           c.largest_unrefined_bound ? shown(*c.largest_unrefined_bound) : nullptr},
          {"global_bound", bounded ? shown(c.global_bound) : nullptr},
          {"gap", bounded && std::isfinite(c.best)
                      ? io::Json(std::abs(c.global_bound - c.best) / record.per_unit)
                      : nullptr},
          {"locally_optimal_only", c.open},
          {"grid_cut", c.grid_cut},
          {"strength_bounded", c.strength_bounded},
          {"strength_not_bounded", c.strength_not_bounded}};
}

io::Json certificate_json(const Specification& spec, const OptimizeResult& result) {
  return result.certificate ? proof_json(spec, *result.certificate) : io::Json(nullptr);
}

std::string certificate_text(const Specification& spec, const OptimizeResult& result) {
  if (!result.certificate) return "";
  const optimize::Certificate& c = *result.certificate;
  const optimize::ObjectiveRecord& record =
      optimize::objective_record(optimize::first_objective(spec));
  const auto shown = [&](double merit) {
    return with_objective_unit(record, optimize::sense_of(record.id) * merit);
  };
  const char* than = record.maximise ? "more" : "less";
  const std::string strength = bounded_strength_text(c);
  std::string text =
      fmt::format("certificate under the stated model: best {} {}", record.name, shown(c.best));
  if (!c.objective_bounded) {
    return text + fmt::format(
                      "; nothing bounds {}: {} sets are refined, to local optima, and {} are "
                      "proven to have no feasible design{}\n",
                      record.name, c.refined, c.infeasible, strength);
  }
  if (c.largest_unrefined_bound) {
    text += fmt::format("; no design of the {} bounded sets has {} than {}", c.bounded, than,
                        bound_text(spec, *c.largest_unrefined_bound));
  }
  text += fmt::format(
      "; {} sets are proven to have no feasible design; no design of any set has {} than {}",
      c.infeasible, than, bound_text(spec, c.global_bound));
  if (c.open > 0) {
    text +=
        fmt::format(" ({} refined sets are locally optimal only and may hold up to that)", c.open);
  }
  if (c.grid_cut > 0) {
    text += fmt::format("; the grids of {} refined set{} were not searched to the end", c.grid_cut,
                        c.grid_cut == 1 ? "" : "s");
  }
  return text + strength + "\n";
}

}  // namespace gear3k::report
