#include "calibrate/causes/form_catalogue.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>

namespace gear3k::calibrate {

namespace {

constexpr int kManyLevels = 17;  // near every place of a curve

/// What the rows of a campaign differ in.
struct WidePlan {
  int runs = 0;
  int levels = kManyLevels;  ///< of load, speed, temperature and test torque
};

/// Rows far apart in everything that forms are made from; of three runs one is between others.
MeasurementSet wide_data(Kind kind, const WidePlan& plan) {
  MeasurementSet data;
  data.kind = kind;
  for (int run = 0; run < plan.runs; ++run) data.runs.push_back(std::to_string(run + 1));
  for (int step = 0; step < kManyLevels; ++step) {
    const double share = 0.5 * step;
    const double level = 0.5 * (step % plan.levels);
    constexpr double kFar = 1e4;
    Observation row;
    row.condition.output_angle_rad = share * kFar;
    row.condition.temperature_K = 293.15 + level;
    row.condition.time_s = share * kFar;
    row.condition.cycles = share * kFar;
    row.condition.sun_speed_rad_s = 1.0 + level;
    row.condition.output_torque_Nm = 1.0 + level;
    row.condition.test_torque_Nm = 1.0 + level;
    row.condition.run = plan.runs > 0 ? std::min(step / 6, plan.runs - 1) : -1;
    constexpr std::array<int, 3> kTeeth{20, 30, 20};
    row.condition.driving_teeth = kTeeth[static_cast<std::size_t>(step % 3)];
    row.condition.driven_teeth = 50 - row.condition.driving_teeth;
    row.condition.direction =
        step == 1 ? design::Direction::kBackward : design::Direction::kForward;
    row.response = 1.0;
    data.rows.push_back(row);
  }
  return data;
}

bool same(const FormConstant& a, const FormConstant& b) {
  return a.name == b.name && a.unit == b.unit;
}

template <class Item, class Equal>
void add_once(std::vector<Item>& items, const Item& item, Equal equal) {
  if (!std::ranges::any_of(items, [&](const Item& known) { return equal(known, item); })) {
    items.push_back(item);
  }
}

void add_form(std::vector<CatalogueForm>& catalogue, const Form& form) {
  auto known = std::ranges::find(catalogue, form.name, &CatalogueForm::name);
  if (known == catalogue.end()) {
    catalogue.push_back(
        {.name = form.name, .constants = {}, .sets = {}, .bodies = {}, .has_order = false});
    known = catalogue.end() - 1;
  }
  for (const FormConstant& c : form.constants) {
    add_once(known->constants, {.name = c.name, .unit = c.unit, .value = 0.0}, same);
  }
  add_once(known->sets, form.constants,
           [](const auto& a, const auto& b) { return std::ranges::equal(a, b, same); });
  if (!form.body.empty()) add_once(known->bodies, form.body, std::equal_to<>());
  known->has_order = known->has_order || form.order != 0.0;
}

}  // namespace

std::vector<CatalogueForm> form_catalogue(const Cause& cause, Kind kind) {
  const train::ToothSet teeth{.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};
  std::vector<CatalogueForm> catalogue;
  constexpr std::array<WidePlan, 7> kPlans{{{.runs = 3},
                                            {.runs = 2},
                                            {.levels = kManyLevels},
                                            {.levels = 4},
                                            {.levels = 5},
                                            {.levels = 6},
                                            {.levels = 7}}};
  for (const WidePlan& plan : kPlans) {
    const MeasurementSet data = wide_data(kind, plan);
    for (const bool black_box : {false, true}) {
      Occasion occasion;
      occasion.kind = kind;
      occasion.data = &data;
      occasion.teeth = black_box ? nullptr : &teeth;
      occasion.ratio = kind == Kind::kPairLoss ? 0.0 : train::ratio(teeth);
      occasion.load = {1.0, 2.0};
      occasion.speed = {1.0, 2.0};
      if (black_box) {
        occasion.load_unit = "Nm";
        occasion.speed_unit = "rad/s";
      }
      occasion.temperature_K = {293.15, 303.15};
      occasion.has_drag = true;
      occasion.every_wave = true;
      for (const Form& form : cause.forms(occasion)) add_form(catalogue, form);
    }
  }
  return catalogue;
}

std::string file_key(std::string_view name, std::string_view unit) {
  std::string text(name);
  if (!unit.empty()) {
    std::string words(unit);
    if (words.starts_with("1/")) words.erase(0, 1);
    text += "_" + words;
  }
  std::string key;
  const auto separate = [&] {
    if (!key.empty() && key.back() != '_') key += '_';
  };
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto c = static_cast<unsigned char>(text[k]);
    if (std::isalnum(c) != 0 && c < 0x80U) {
      key += static_cast<char>(std::tolower(c));
    } else if (c == '/') {
      separate();
      key += "per_";
    } else {
      separate();
    }
  }
  while (!key.empty() && key.back() == '_') key.pop_back();
  return key;
}

}  // namespace gear3k::calibrate
