#include "calibrate/model/law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"

namespace gear3k::calibrate {

namespace {

/// A condition of a gearbox that a column states.
LawCondition stated(const ConditionQuantity& q, std::vector<Kind> kinds,
                    double (*value)(const Condition&)) {
  return {.name = q.name,
          .unit = q.unit,
          .shown_unit = q.shown_unit,
          .kinds = std::move(kinds),
          .value = value};
}

template <const ConditionQuantity& kQuantity>
double written(const Condition& c) {
  return kQuantity.written(c.*(kQuantity.member));
}

LawCondition of_teeth(std::string_view name, double (*value)(const Condition&)) {
  return {.name = name, .unit = "", .shown_unit = "", .kinds = {Kind::kPairLoss}, .value = value};
}

/// Of a pair; NaN where the data are of a gearbox.
double teeth(const Condition& c, double value) {
  return c.driving_teeth > 0 && c.driven_teeth > 0 ? value : kUnknown;
}

std::vector<LawCondition> make_conditions() {
  constexpr Kind kT = Kind::kTransmission;
  constexpr Kind kL = Kind::kLostMotion;
  constexpr Kind kA = Kind::kTorqueAngle;
  std::vector<LawCondition> list{
      stated(kOutputTorque, {kT}, written<kOutputTorque>),
      stated(kSunSpeed, {kT}, written<kSunSpeed>),
      stated(kTestTorque, {kL, kA}, written<kTestTorque>),
      stated(kTemperature, {kT, kL, kA}, written<kTemperature>),
      stated(kTime, {kT, kL, kA, Kind::kPairLoss}, written<kTime>),
      stated(kCycles, {kT, kL, kA}, written<kCycles>),
      stated(kOutputAngle, {kT, kL, kA}, written<kOutputAngle>),
      of_teeth(
          "pinion_teeth",
          [](const Condition& c) { return teeth(c, std::min(c.driving_teeth, c.driven_teeth)); }),
      of_teeth(
          "gear_teeth",
          [](const Condition& c) { return teeth(c, std::max(c.driving_teeth, c.driven_teeth)); }),
      of_teeth("tooth_sum",
               [](const Condition& c) { return teeth(c, c.driving_teeth + c.driven_teeth); }),
      of_teeth("tooth_ratio",
               [](const Condition& c) {
                 return teeth(c, static_cast<double>(c.driven_teeth) / c.driving_teeth);
               }),
      of_teeth("common_divisor", [](const Condition& c) {
        return teeth(c, std::gcd(c.driving_teeth, c.driven_teeth));
      })};
  for (LawCondition& c : list) {
    if (c.name == kTemperature.name) c.natural_zero = false;
    if (c.name == kOutputAngle.name) c.turn = 360.0;
    c.of_campaign = c.name == kTime.name || c.name == kCycles.name;
  }
  return list;
}

/// The same words for both factors of a product.
constexpr std::array<std::array<std::string_view, 2>, 9> kParameterNames{
    {{"exponent", "exponent_2"},
     {"rate", "rate_2"},
     {"half_value", "half_value_2"},
     {"centre", "centre_2"},
     {"width", "width_2"},
     {"threshold", "threshold_2"},
     {"zero", "zero_2"},
     {"order", "order_2"},
     {"phase", "phase_2"}}};

std::string_view name_at(std::string_view name, std::size_t factor) {
  for (const auto& names : kParameterNames) {
    if (names[0] == name) return names[factor];
  }
  throw std::invalid_argument(fmt::format("law: there is no parameter {}", name));
}

/// Bounds of a factor's parameter, in the unit that it is told in.
ParameterRecord factor_parameter(const LawFactor& f, std::size_t which, std::size_t place) {
  constexpr double kMostExponent = 8.0;
  constexpr double kMostRate = 30.0;
  constexpr double kBeyond = 3.0;
  constexpr double kNarrowest = 1e-3;
  constexpr double kWidest = 30.0;
  constexpr double kMostOrder = 1e4;
  const std::string_view name = record_of(f.shape).parameters[which];
  const std::string_view unit = law_conditions()[f.condition].shown_unit;
  ParameterRecord r{.name = name_at(name, place),
                    .unit = "",
                    .lower = -kMostExponent,
                    .upper = kMostExponent,
                    .plausible_low = 0.0,
                    .plausible_high = 0.0};
  if (name == "rate") {
    r.lower = -kMostRate;
    r.upper = kMostRate;
  } else if (name == "half_value" || name == "width") {
    r.unit = unit;
    r.lower = kNarrowest * f.reference;
    r.upper = kWidest * f.reference;
  } else if (name == "centre" || name == "threshold" || name == "zero") {
    r.unit = unit;
    r.lower =
        f.shape == LawShape::kWindow ? kNarrowest * f.reference : f.origin - kBeyond * f.reference;
    r.upper = f.origin + kBeyond * f.reference;
  } else if (name == "order") {
    r.lower = 0.0;
    r.upper = kMostOrder;
  } else if (name == "phase") {
    r.lower = -2.0;
    r.upper = 2.0;
  }
  // A law is no cause: nothing says what would be plausible.
  r.plausible_low = r.lower;
  r.plausible_high = r.upper;
  return r;
}

ParameterRecord amplitude_record(const Law& law, Kind kind, std::string_view name) {
  constexpr double kMost = 1e6;
  constexpr double kMostShare = 1e3;
  const double most = is_share(law.action) ? kMostShare : kMost;
  return {.name = name,
          .unit = is_share(law.action) ? std::string_view() : response_unit(kind).name,
          .lower = -most,
          .upper = most,
          .plausible_low = -most,
          .plausible_high = most};
}

double losing(const Condition& c) {
  return c.direction == design::Direction::kForward ? 1.0 : -1.0;
}

template <class T>
T squared(const T& x) {
  return x * x;
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t first = 0; first < text.size();) {
    const std::size_t end = std::min(text.find(' ', first), text.size());
    words.push_back(text.substr(first, end - first));
    first = end + 1;
  }
  return words;
}

template <class Names>
std::size_t place_of(const Names& names, std::string_view name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) throw std::invalid_argument(fmt::format("law: unknown {}", name));
  return static_cast<std::size_t>(found - names.begin());
}

std::vector<ParameterRecord> parameters(const Form& form, Kind kind) {
  return parameters_of(law_of(form), kind);
}

std::vector<Form> no_forms(const Occasion& /*occasion*/) { return {}; }

void apply_value(const Law& law, const Scalar& v, const Condition& c, Kind kind, Modification& m) {
  const double sign =
      law.action == LawAction::kLoss || law.action == LawAction::kShareLost ? losing(c) : 1.0;
  if (is_share(law.action)) {
    m.response_factor = m.response_factor * (1.0 + sign * v);
  } else {
    m.added = m.added + sign * response_unit(kind).si * v;
  }
}

void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
           Modification& m) {
  const Law law = law_of(form);
  if (acts_in(law, condition)) {
    apply_value(law, law_value(law, condition, p.data()), condition, kind, m);
  }
}

std::string quantity(double value, std::string_view unit) {
  return unit.empty() ? fmt::format("{:.4g}", value) : fmt::format("{:.4g} {}", value, unit);
}

/// " - 3 rpm", " + 3 rpm"
std::string less(double value, std::string_view unit) {
  return fmt::format(" {} {}", value < 0.0 ? '+' : '-', quantity(std::abs(value), unit));
}

std::string factor_formula(const LawFactor& f, const double* p) {
  const LawCondition& condition = law_conditions()[f.condition];
  const std::string_view unit = condition.shown_unit;
  const std::string x(condition.name);
  const auto q = [&](double value) { return quantity(value, unit); };
  const std::string u = f.origin == 0.0
                            ? fmt::format("{}/{}", x, q(f.reference))
                            : fmt::format("({}{})/{}", x, less(f.origin, unit), q(f.reference));
  switch (f.shape) {
    case LawShape::kPower:
      return fmt::format("({})^{:.4g}", u, p[0]);
    case LawShape::kExponential:
      return fmt::format("exp({:.4g} * {})", p[0], u);
    case LawShape::kGrowth:
      return fmt::format("(exp({0:.4g} * {1}) - 1)/(exp({0:.4g}) - 1)", p[0], u);
    case LawShape::kSaturation:
      return fmt::format("{0}/({0} + {1}) * {2:.4g}", x, q(p[0]), 1.0 + p[0] / f.reference);
    case LawShape::kBell:
      return fmt::format("exp(-(({}{})/{})^2)", x, less(p[0], unit), q(p[1]));
    case LawShape::kResonance:
      return fmt::format("1/(1 + (({}{})/{})^2)", x, less(p[0], unit), q(p[1]));
    case LawShape::kWindow:
      return fmt::format("exp(-(ln({}/{})/{:.4g})^2)", x, q(p[0]), f.constant);
    case LawShape::kRamp:
      return fmt::format("max(0, {}{})/{}", x, less(p[0], unit), q(f.reference));
    case LawShape::kStep:
      return fmt::format("[{} > {}]", x, q(f.constant));
    case LawShape::kCentred:
      return fmt::format("({}{})/{}", x, less(p[0], unit), q(f.reference));
    case LawShape::kWave:
      return fmt::format("cos(2 pi ({:.6g} * {}{}))", p[0], u, less(p[1], ""));
    case LawShape::kPulse:
      return fmt::format("pulse({:.6g} * {}{}, width {:.4g})", p[0], u, less(p[1], ""), f.constant);
  }
  return "";
}

}  // namespace

const std::vector<LawCondition>& law_conditions() {
  static const std::vector<LawCondition> list = make_conditions();
  return list;
}

const LawShapeRecord& record_of(LawShape shape) {
  static const std::array<LawShapeRecord, kLawShapes> records{
      {{.name = "power", .title = "power of", .parameters = {"exponent", ""}, .natural_zero = true},
       {.name = "exponential", .title = "exponential of", .parameters = {"rate", ""}},
       {.name = "growth",
        .title = "growth or levelling with",
        .parameters = {"rate", ""},
        .natural_zero = true},
       {.name = "saturation",
        .title = "saturation with",
        .parameters = {"half_value", ""},
        .natural_zero = true},
       {.name = "bell", .title = "bell over", .parameters = {"centre", "width"}},
       {.name = "resonance", .title = "resonance over", .parameters = {"centre", "width"}},
       {.name = "window",
        .title = "window of",
        .parameters = {"centre", ""},
        .constant = "width",
        .natural_zero = true},
       {.name = "ramp", .title = "ramp above a", .parameters = {"threshold", ""}},
       {.name = "step", .title = "step at a", .parameters = {"", ""}, .constant = "threshold"},
       {.name = "centred", .title = "line through a", .parameters = {"zero", ""}},
       {.name = "wave", .title = "wave over", .parameters = {"order", "phase"}, .turns = true},
       {.name = "pulse",
        .title = "pulses over",
        .parameters = {"order", "phase"},
        .constant = "width",
        .turns = true}}};
  return records[static_cast<std::size_t>(shape)];
}

int parameter_count(LawShape shape) {
  const auto& names = record_of(shape).parameters;
  return names[0].empty() ? 0 : names[1].empty() ? 1 : 2;
}

std::vector<ParameterRecord> parameters_of(const Law& law, Kind kind) {
  std::vector<ParameterRecord> result{amplitude_record(law, kind, "amplitude")};
  if (law.offset) result.push_back(amplitude_record(law, kind, "offset"));
  for (std::size_t f = 0; f < law.factors.size(); ++f) {
    for (int k = 0; k < parameter_count(law.factors[f].shape); ++k) {
      result.push_back(factor_parameter(law.factors[f], static_cast<std::size_t>(k), f));
    }
  }
  return result;
}

template <class T>
T factor_value(const LawFactor& f, double x, const T* p) {
  using std::abs;
  using std::cos;
  using std::exp;
  constexpr double kLeast = 1e-3;
  constexpr double kStraight = 1e-6;
  const double u = (x - f.origin) / f.reference;
  switch (f.shape) {
    case LawShape::kPower:
      return exp(p[0] * std::log(std::max(u, kLeast)));
    case LawShape::kExponential:
      return exp(p[0] * u);
    case LawShape::kGrowth:
      // Its first terms in k where the quotient is 0/0.
      if (abs(p[0]) < kStraight) return u * (1.0 + 0.5 * (u - 1.0) * p[0]);
      return (exp(p[0] * u) - 1.0) / (exp(p[0]) - 1.0);
    case LawShape::kSaturation:
      return x * (1.0 + p[0] / f.reference) / (x + p[0]);
    case LawShape::kBell:
      return exp(-squared(T((x - p[0]) / p[1])));
    case LawShape::kResonance:
      return 1.0 / (1.0 + squared(T((x - p[0]) / p[1])));
    case LawShape::kWindow: {
      using std::log;
      if (!(x > 0.0)) return T(0.0);
      return exp(-squared(T((std::log(x) - log(p[0])) / f.constant)));
    }
    case LawShape::kRamp:
      return x > p[0] ? T((x - p[0]) / f.reference) : T(0.0);
    case LawShape::kStep:
      return T(x > f.constant ? 1.0 : 0.0);
    case LawShape::kCentred:
      return (x - p[0]) / f.reference;
    case LawShape::kWave:
      return cos(2.0 * std::numbers::pi * (u * p[0] - p[1]));
    case LawShape::kPulse: {
      const T turn = u * p[0] - p[1];
      double whole = 0.0;
      if constexpr (std::is_floating_point_v<T>) {
        whole = std::round(turn);
      } else {
        whole = std::round(turn.a);
      }
      return exp(-squared(T((turn - whole) / f.constant)));
    }
  }
  return T(0.0);
}
template double factor_value(const LawFactor&, double, const double*);
template Scalar factor_value(const LawFactor&, double, const Scalar*);

bool acts_in(const Law& law, const Condition& c) {
  const bool forward = c.direction == design::Direction::kForward;
  if ((law.rows == LawRows::kForward && !forward) || (law.rows == LawRows::kBackward && forward) ||
      (law.rows == LawRows::kPositive && c.rotation < 0) ||
      (law.rows == LawRows::kNegative && c.rotation > 0)) {
    return false;
  }
  return std::ranges::all_of(law.factors, [&](const LawFactor& f) {
    return std::isfinite(law_conditions()[f.condition].value(c));
  });
}

bool has_limits(const LawFactor& factor) {
  return !(law_conditions()[factor.condition].turn > 0.0) && !record_of(factor.shape).turns;
}

template <class T>
T law_value(const Law& law, const Condition& c, const T* p) {
  T product = p[0];
  const T* next = p + (law.offset ? 2 : 1);
  for (const LawFactor& f : law.factors) {
    const double x = std::clamp(law_conditions()[f.condition].value(c), f.least, f.greatest);
    product = product * factor_value(f, x, next);
    next += parameter_count(f.shape);
  }
  return law.offset ? T(product + p[1]) : product;
}
template double law_value(const Law&, const Condition&, const double*);
template Scalar law_value(const Law&, const Condition&, const Scalar*);

double law_weight(LawAction action, const Condition& c, double response) {
  switch (action) {
    case LawAction::kAdded:
      return 1.0;
    case LawAction::kLoss:
      return losing(c);
    case LawAction::kShare:
      return response;
    case LawAction::kShareLost:
      return losing(c) * response;
  }
  return 0.0;
}

const Cause& law_cause() {
  static const Cause cause{.id = "law",
                           .title = "law without a cause",
                           .remedy = Remedy::kProcedure,
                           .place = Place::kMeasurement,
                           .weight = 1.0,
                           .parameters = parameters,
                           .forms = no_forms,
                           .apply = apply};
  return cause;
}

Form form_of(const Law& law) {
  Form form{.name = fmt::format("{} {}", kLawActionNames[static_cast<std::size_t>(law.action)],
                                kLawRowsNames[static_cast<std::size_t>(law.rows)])};
  for (const LawFactor& f : law.factors) {
    const std::string_view unit = law_conditions()[f.condition].shown_unit;
    form.name += fmt::format(" {} {}", record_of(f.shape).name, law_conditions()[f.condition].name);
    form.constants.push_back({.name = "origin", .unit = std::string(unit), .value = f.origin});
    form.constants.push_back(
        {.name = "reference", .unit = std::string(unit), .value = f.reference});
    form.constants.push_back({.name = "constant", .value = f.constant});
    form.constants.push_back({.name = "least", .unit = std::string(unit), .value = f.least});
    form.constants.push_back({.name = "greatest", .unit = std::string(unit), .value = f.greatest});
  }
  if (law.offset) form.name += " offset";
  return form;
}

Law law_of(const Form& form) {
  constexpr std::size_t kConstants = 5;
  const std::vector<std::string> words = words_of(form.name);
  const std::size_t factors = words.size() < 4 ? 0 : (words.size() - 2) / 2;
  if (factors < 1 || factors > 2 || form.constants.size() != kConstants * factors) {
    throw std::invalid_argument(fmt::format("law: there is no form \"{}\"", form.name));
  }
  Law law{.action = static_cast<LawAction>(place_of(kLawActionNames, words[0])),
          .rows = static_cast<LawRows>(place_of(kLawRowsNames, words[1])),
          .factors = {},
          .offset = words.size() % 2 != 0};
  for (std::size_t f = 0; f < factors; ++f) {
    const auto constant = [&](std::size_t k) { return form.constants[kConstants * f + k].value; };
    LawFactor factor{.origin = constant(0),
                     .reference = constant(1),
                     .constant = constant(2),
                     .least = constant(3),
                     .greatest = constant(4)};
    int shape = 0;
    while (shape < kLawShapes && record_of(static_cast<LawShape>(shape)).name != words[2 + 2 * f]) {
      ++shape;
    }
    const auto& conditions = law_conditions();
    const auto condition = std::ranges::find(conditions, words[3 + 2 * f], &LawCondition::name);
    if (shape == kLawShapes || condition == conditions.end()) {
      throw std::invalid_argument(fmt::format("law: there is no form \"{}\"", form.name));
    }
    factor.shape = static_cast<LawShape>(shape);
    factor.condition = static_cast<std::size_t>(condition - conditions.begin());
    law.factors.push_back(factor);
  }
  return law;
}

std::string law_title(const Law& law) {
  std::string text;
  for (const LawFactor& f : law.factors) {
    text += fmt::format("{}{} {}", text.empty() ? "" : " times ", record_of(f.shape).title,
                        law_conditions()[f.condition].name);
  }
  return text;
}

std::string law_formula(const Law& law, const std::vector<double>& value, Kind kind) {
  const std::string_view unit =
      is_share(law.action) ? std::string_view() : response_unit(kind).name;
  std::string text = fmt::format("{} = ", kLawActionNames[static_cast<std::size_t>(law.action)]);
  const double* next = value.data() + 1;
  if (law.offset) text += fmt::format("{} + ", quantity(*next++, unit));
  text += quantity(value[0], unit);
  for (const LawFactor& f : law.factors) {
    text += " * " + factor_formula(f, next);
    next += parameter_count(f.shape);
  }
  switch (law.rows) {
    case LawRows::kAll:
      return text;
    case LawRows::kForward:
      return text + ", forward only";
    case LawRows::kBackward:
      return text + ", backward only";
    case LawRows::kPositive:
      return text + ", rotation +1 only";
    case LawRows::kNegative:
      break;
  }
  return text + ", rotation -1 only";
}

bool is_of_campaign(const Law& law) {
  return std::ranges::any_of(
      law.factors, [](const LawFactor& f) { return law_conditions()[f.condition].of_campaign; });
}

AppliedLaw applied_law(const Law& law, std::span<const double> value,
                       std::span<const Observation> rows) {
  AppliedLaw applied{.law = law, .value = {value.begin(), value.end()}};
  const double* next = applied.value.data() + (law.offset ? 2 : 1);
  for (std::size_t f = 0; f < law.factors.size(); ++f) {
    const LawFactor& factor = law.factors[f];
    const LawCondition& condition = law_conditions()[factor.condition];
    if (condition.of_campaign) {
      ValueRange range;
      double sum = 0.0;
      int count = 0;
      for (const Observation& row : rows) {
        const double at = condition.value(row.condition);
        range.extend(at);
        if (!acts_in(law, row.condition)) continue;
        sum += factor_value(factor, at, next);
        ++count;
      }
      if (has_limits(factor)) {
        if (range.known()) applied.left_behind[f] = factor_value(factor, range.high, next);
      } else if (count > 0) {
        applied.left_behind[f] = sum / count;
      }
    }
    next += parameter_count(factor.shape);
  }
  return applied;
}

std::optional<AppliedLaw> as_left_behind(const AppliedLaw& applied) {
  const Law& law = applied.law;
  const std::size_t before = law.offset ? 2 : 1;
  AppliedLaw left{.law = law, .value = {}};
  left.law.factors.clear();
  left.value.assign(applied.value.begin(),
                    applied.value.begin() + static_cast<std::ptrdiff_t>(before));
  const double* next = applied.value.data() + before;
  for (std::size_t f = 0; f < law.factors.size(); ++f) {
    const LawFactor& factor = law.factors[f];
    const int count = parameter_count(factor.shape);
    if (law_conditions()[factor.condition].of_campaign) {
      if (!std::isfinite(applied.left_behind[f])) return std::nullopt;
      left.value.front() *= applied.left_behind[f];
    } else {
      left.law.factors.push_back(factor);
      left.value.insert(left.value.end(), next, next + count);
    }
    next += count;
  }
  return left;
}

void apply_law(const AppliedLaw& applied, const Condition& condition, Kind kind, Modification& m) {
  const std::size_t count = parameters_of(applied.law, kind).size();
  if (applied.value.size() != count) {
    throw std::invalid_argument(fmt::format("extended model: a law has {} parameters, allowed: {}",
                                            applied.value.size(), count));
  }
  if (!acts_in(applied.law, condition)) return;
  const double v = law_value(applied.law, condition, applied.value.data());
  apply_value(applied.law, constant<Scalar>(v), condition, kind, m);
}

}  // namespace gear3k::calibrate
