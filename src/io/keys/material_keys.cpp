#include "io/keys/material_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

#include "io/text/diagnostics.hpp"

namespace gear3k::io {

namespace {

using strength::GearMaterial, strength::HardnessScale, strength::LifeCurve, strength::LimitLaw,
    strength::Material, strength::MaterialGroup, strength::StressLimit, units::Unit;

constexpr MaterialGroup kDefaultGroup = MaterialGroup::kThroughHardened;
constexpr std::size_t kMostSimilar = 3;

/// What a material of numbers stands on.
constexpr Material kOfNumbers{.group = kDefaultGroup, .life_curve = LifeCurve::kSteel};

/// As the rows of the table have it.
LifeCurve life_curve_of(MaterialGroup group) {
  if (strength::is_plastic(group)) return LifeCurve::kPlastic;
  switch (group) {
    case MaterialGroup::kNitriding:
    case MaterialGroup::kNitrided:
      return LifeCurve::kNitrided;
    case MaterialGroup::kNitrocarburised:
      return LifeCurve::kNitrocarburised;
    case MaterialGroup::kBrass:
      return LifeCurve::kNone;
    default:
      return LifeCurve::kSteel;
  }
}

/// The row that a material stands on.
const Material& row_of(std::string_view name) {
  const Material* row = strength::find_material(name);
  return row != nullptr ? *row : kOfNumbers;
}

StressLimit stated_limit(double limit_Pa) {
  return {.law = LimitLaw::kLinear, .slope_Pa = 0.0, .constant_Pa = limit_Pa};
}

bool same_limit(const StressLimit& a, const StressLimit& b) {
  return a.law == b.law && a.slope_Pa == b.slope_Pa && a.constant_Pa == b.constant_Pa;
}

bool depends_on_hardness(const Material& material) {
  return material.flank_limit.slope_Pa != 0.0 || material.root_limit.slope_Pa != 0.0;
}

/// "200 to 360 HV"
std::string hardness_text(const Material& row) {
  const std::string_view scale =
      strength::kHardnessScaleNames[static_cast<std::size_t>(row.hardness_scale)];
  return *row.hardness_min == *row.hardness_max
             ? fmt::format("{:g} {}", *row.hardness_min, scale)
             : fmt::format("{:g} to {:g} {}", *row.hardness_min, *row.hardness_max, scale);
}

void check_hardness(const std::string& path, double hardness, const Material& row,
                    FileReading& reading) {
  const std::string key = path + ".hardness";
  if (strength::is_plastic(row.group)) {
    reading.error_at(key, fmt::format("{} = {:g}: allowed: of metals only", key, hardness));
  } else if (row.hardness_min &&
             !(hardness >= *row.hardness_min && hardness <= *row.hardness_max)) {
    reading.error_at(key, fmt::format("{} = {:g}: allowed: {}, for which \"{}\" holds", key,
                                      hardness, hardness_text(row), row.name));
  }
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : text + " ") {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!word.empty()) {
      words.push_back(std::exchange(word, ""));
    }
  }
  return words;
}

void refuse_unknown(const std::string& path, const std::string& name, FileReading& reading) {
  const std::string key = path + ".name";
  const std::vector<std::string> similar = similar_materials(name);
  reading.error_at(
      key, fmt::format("{} = {}: allowed: one of the {} names of docs/materials.md, or none and "
                       "numbers in its place{}",
                       key, as_text(text_value(name)), strength::material_table().size(),
                       similar.empty() ? ""
                                       : fmt::format("; did you mean \"{}\"?",
                                                     fmt::join(similar, "\" or \""))));
}

/// Puts a table in the place of a value; a path that is not there is left.
void tabulate(TomlValue& document, std::string_view path) {
  const auto dot = path.find('.');
  const std::string_view key = path.substr(0, dot);
  const auto found = std::ranges::find(document.table, key, &TomlValue::key);
  if (found == document.table.end()) return;
  if (dot != std::string_view::npos) {
    tabulate(*found, path.substr(dot + 1));
    return;
  }
  if (found->kind == TomlValue::Kind::kTable) return;
  TomlValue name = *found;
  name.key = "name";
  TomlValue table = table_value({std::move(name)});
  table.key = found->key;
  table.position = found->position;
  *found = std::move(table);
}

}  // namespace

std::vector<Key<MaterialInput>> material_keys() {
  constexpr const char* kOfRow = "that of the named row, else none";
  const auto stress = [&](const char* name, std::optional<double> MaterialInput::*member,
                          const char* default_text, const char* help) {
    return make_key<MaterialInput>(
        number(name, Unit::kMegapascal, above(0.0, 1e6), default_text, help), member);
  };
  return {
      make_key<MaterialInput>(
          {.path = "name",
           .type = KeyType::kText,
           .default_text = "none",
           .help = "a row of the table of materials (docs/materials.md); without it "
                   "the numbers are a material of their own; material = \"NAME\" says "
                   "the same"},
          &MaterialInput::name),
      make_key<MaterialInput>(
          {.path = "group",
           .type = KeyType::kChoice,
           .choices = {strength::kMaterialGroupNames.begin(), strength::kMaterialGroupNames.end()},
           .default_text = "that of the named row, else V",
           .help = "whose life, size, notch and roughness factors hold"},
          &MaterialInput::group),
      make_key<MaterialInput>(
          number("hardness", Unit::kNone, above(0.0, 2000.0), "the row's, where it has one value",
                 "in the scale of the named row, and within its range; HBW where no row "
                 "states a scale"),
          &MaterialInput::hardness),
      stress("youngs_modulus_mpa", &MaterialInput::youngs_modulus_Pa, kOfRow,
             "modulus of elasticity E"),
      make_key<MaterialInput>(
          number("poisson_ratio", Unit::kNone, within(0.0, 0.499), kOfRow, "Poisson's ratio"),
          &MaterialInput::poisson_ratio),
      stress("sigma_h_lim_mpa", &MaterialInput::flank_limit_Pa, kOfRow,
             "sigma_Hlim of the flank; in place of a row's curve too"),
      stress("sigma_f_lim_mpa", &MaterialInput::root_limit_Pa, kOfRow,
             "nominal sigma_Flim of the root, to be multiplied by Y_ST = 2"),
      make_key<MaterialInput>(
          number("density_kg_m3", Unit::kKilogramPerCubicMetre, above(0.0, 30000.0), kOfRow,
                 "density; that of the gear's mass where inertia.density_kg_m3 is not stated"),
          &MaterialInput::density_kgm3),
      stress("yield_strength_mpa", &MaterialInput::yield_strength_Pa, kOfRow,
             "yield strength, for the peak load of plastics and the notch of through hardened "
             "steel")};
}

TomlValue with_material_tables(TomlValue document, const std::vector<std::string>& gears) {
  tabulate(document, "material");
  for (const std::string& gear : gears) tabulate(document, gear + ".material");
  return document;
}

std::vector<std::string> similar_materials(const std::string& name) {
  std::vector<std::string> names;
  for (const Material& row : strength::material_table()) names.emplace_back(row.name);
  std::vector<std::string> similar;
  if (const std::string closest = closest_word(name, names); !closest.empty()) {
    similar.push_back(closest);
  }
  // Names that share a word, or one written alike, those that share most first.
  const std::vector<std::string> words = words_of(name);
  const auto shared = [&](const std::string& other) {
    const std::vector<std::string> others = words_of(other);
    int points = 0;
    for (const std::string& word : words) {
      if (std::ranges::find(others, word) != others.end()) {
        points += 2;
      } else if (!closest_word(word, others).empty()) {
        ++points;
      }
    }
    return points;
  };
  std::ranges::stable_sort(names, std::ranges::greater(), shared);
  for (const std::string& other : names) {
    if (similar.size() == kMostSimilar || shared(other) == 0) break;
    if (std::ranges::find(similar, other) == similar.end()) similar.push_back(other);
  }
  return similar;
}

std::optional<GearMaterial> finish_material(const std::string& path, const MaterialInput& input,
                                            FileReading& reading) {
  if (reading.stated(path + ".name") && !reading.has(path + ".name")) return std::nullopt;
  if (input.name && strength::find_material(*input.name) == nullptr) {
    refuse_unknown(path, *input.name, reading);
    return std::nullopt;
  }
  const Material& row = row_of(input.name.value_or(""));
  GearMaterial material{.record = row, .hardness = input.hardness};
  Material& record = material.record;
  if (input.group && *input.group != row.group) {
    record.group = *input.group;
    record.life_curve = life_curve_of(*input.group);
  }
  if (input.youngs_modulus_Pa) record.youngs_modulus_Pa = input.youngs_modulus_Pa;
  if (input.poisson_ratio) record.poisson_ratio = input.poisson_ratio;
  if (input.flank_limit_Pa) record.flank_limit = stated_limit(*input.flank_limit_Pa);
  if (input.root_limit_Pa) record.root_limit = stated_limit(*input.root_limit_Pa);
  if (input.density_kgm3) record.density_kgm3 = input.density_kgm3;
  if (input.yield_strength_Pa) record.yield_strength_Pa = input.yield_strength_Pa;
  if (input.hardness) {
    check_hardness(path, *input.hardness, record, reading);
    if (record.hardness_scale == HardnessScale::kNone) {
      record.hardness_scale = HardnessScale::kBrinell;
    }
  }
  return material;
}

void check_rated_material(const std::string& path, const GearMaterial& material,
                          FileReading& reading) {
  const Material& record = material.record;
  const std::string whose =
      record.name.empty() ? "" : fmt::format(", which \"{}\" does not state", record.name);
  const auto require = [&](const char* name, const std::optional<double>& value) {
    const std::string key = fmt::format("{}.{}", path, name);
    if (value || reading.stated(key)) return;
    reading.error_at(key, fmt::format("{} is missing, required by [strength]{}: allowed: a number, "
                                      "or a material of the table that has it",
                                      key, whose));
  };
  require("youngs_modulus_mpa", record.youngs_modulus_Pa);
  require("poisson_ratio", record.poisson_ratio);
  const std::string key = path + ".hardness";
  const bool one_value = record.hardness_min == record.hardness_max;
  if (depends_on_hardness(record) && !one_value && !reading.stated(key)) {
    reading.error_at(key, fmt::format("{} is missing, which the limits of \"{}\" depend on: "
                                      "allowed: {}",
                                      key, record.name, hardness_text(record)));
  }
}

MaterialInput stated_material(const GearMaterial& material) {
  const Material& record = material.record;
  const bool named = strength::find_material(record.name) != nullptr;
  const Material& row = row_of(record.name);
  const auto unless_of_row = [](const std::optional<double>& value,
                                const std::optional<double>& of_row) {
    return value == of_row ? std::nullopt : value;
  };
  const auto limit = [](const StressLimit& value,
                        const StressLimit& of_row) -> std::optional<double> {
    if (same_limit(value, of_row)) return std::nullopt;
    return value.constant_Pa;
  };
  MaterialInput input;
  if (named) input.name = std::string(record.name);
  if (!named || record.group != row.group) input.group = record.group;
  input.hardness = material.hardness;
  input.youngs_modulus_Pa = unless_of_row(record.youngs_modulus_Pa, row.youngs_modulus_Pa);
  input.poisson_ratio = unless_of_row(record.poisson_ratio, row.poisson_ratio);
  input.flank_limit_Pa = limit(record.flank_limit, row.flank_limit);
  input.root_limit_Pa = limit(record.root_limit, row.root_limit);
  input.density_kgm3 = unless_of_row(record.density_kgm3, row.density_kgm3);
  input.yield_strength_Pa = unless_of_row(record.yield_strength_Pa, row.yield_strength_Pa);
  return input;
}

}  // namespace gear3k::io
