#include "app/evaluate.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>
#include <variant>

#include "io/text/diagnostics.hpp"

namespace gear3k::app {

namespace {

/// What `evaluate` of design/ gives; both kinds of failure as one exception.
template <class Evaluate>
auto defined_or_throw(const Evaluate& evaluate, const std::string& source) {
  try {
    auto result = evaluate();
    const auto* undefined = std::get_if<design::NotDefined>(&result);
    if (undefined == nullptr) return std::get<0>(std::move(result));
    throw io::InvalidInput(fmt::format("{}: {}", source, undefined->message));
  } catch (const std::invalid_argument& error) {
    throw io::InvalidInput(fmt::format("{}: {}", source, error.what()));
  }
}

}  // namespace

design::Evaluation evaluate(const design::Design& design, const std::string& source) {
  return defined_or_throw([&] { return design::evaluate(design); }, source);
}

design::PairEvaluation evaluate(const design::PairDesign& pair, const std::string& source) {
  return defined_or_throw([&] { return design::evaluate(pair); }, source);
}

design::OperatingMap operating_map(const design::Design& design, const std::string& source) {
  return defined_or_throw([&] { return design::make_operating_map(design); }, source);
}

std::optional<design::TorqueAngleCurve> torque_angle(const design::Design& design,
                                                     design::Evaluation& evaluation) {
  if (!design.rating) return std::nullopt;
  auto curve = design::torque_angle_curve(design, evaluation);
  if (auto* missing = std::get_if<std::string>(&curve)) {
    evaluation.notes.push_back("no torque-angle curve: " + *missing);
    return std::nullopt;
  }
  return std::get<design::TorqueAngleCurve>(std::move(curve));
}

}  // namespace gear3k::app
