#include "io/files/selection_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "design/evaluation.hpp"
#include "io/files/cycle_file.hpp"
#include "io/files/design_file.hpp"
#include "io/files/document_kind.hpp"
#include "io/files/specification_file.hpp"
#include "io/keys/selection_keys.hpp"
#include "io/text/complaints.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/file_reader.hpp"
#include "io/text/toml_value.hpp"

namespace gear3k::io {

namespace {

/// Values of a catalogue's rows; errors of all rows are collected.
class CatalogueRows {
 public:
  /// @param slips  of the table's form, told with those of its values
  CatalogueRows(const CsvTable& table, const std::vector<Diagnostic>& slips) : table_(table) {
    for (const Diagnostic& slip : slips) complaints_.add(slip.position, slip.message);
  }

  void require(const std::vector<std::string>& columns) {
    if (!table_.header.empty()) {
      const auto slip = wrong_separator(table_.header.size(), table_.header[0]);
      if (!slip.empty()) {
        throw InvalidInput(fmt::format("{}:{}:1: {}", table_.name, table_.header_line, slip));
      }
    }
    bool missing = false;
    for (const std::string& column : columns) {
      if (has(column)) continue;
      missing = true;
      complaints_.add({.line = table_.header_line, .column = 1},
                      fmt::format("column {} is missing: allowed: columns {}", column,
                                  fmt::join(columns, ", ")));
    }
    if (missing) raise();
    if (table_.rows.empty() && complaints_.none()) {
      complaints_.add({.line = table_.header_line, .column = 1},
                      "no row below the header: allowed: one or more");
    }
  }
  /// Complains of a row whose manufacturer and order_code stand in one before.
  void refuse_second(const CsvTable::Row& row) {
    if (!table_.text(row, "order_code")) return;
    const auto [first, is_new] = lines_.try_emplace(label(row), row.line);
    if (is_new) return;
    complaints_.add({.line = row.line, .column = 1},
                    fmt::format("{} stands twice, first in line {}: allowed: one row of a "
                                "manufacturer's order_code",
                                first->first, first->second));
  }
  /// A number above `least` (or equal to it), or blank.
  std::optional<double> number(const CsvTable::Row& row, const std::string& column, double least,
                               bool excluded, double most = kNoBound) {
    if (!has(column)) return std::nullopt;
    const auto text = table_.text(row, column);
    if (!text) return std::nullopt;
    const auto value = csv_number(*text);
    if (value && std::isfinite(*value) && *value <= most &&
        (excluded ? *value > least : *value >= least)) {
      return value;
    }
    complaints_.add({.line = row.line, .column = 1},
                    fmt::format("{} = \"{}\": allowed: a number {} {:g}{}", column, *text,
                                excluded ? "above" : "from", least,
                                most < kNoBound ? fmt::format(" to {:g}", most) : ""));
    return std::nullopt;
  }
  double required(const CsvTable::Row& row, const std::string& column, double least, bool excluded,
                  double most = kNoBound) {
    const std::size_t before = complaints_.count();
    const auto value = number(row, column, least, excluded, most);
    if (!value && complaints_.count() == before) {
      complaints_.add({.line = row.line, .column = 1},
                      fmt::format("{} is blank: allowed: a number", column));
    }
    return value.value_or(1.0);
  }
  [[nodiscard]] std::string label(const CsvTable::Row& row) const {
    return fmt::format("{} {}", table_.text(row, "manufacturer").value_or(""),
                       table_.text(row, "order_code").value_or(""));
  }
  void raise() const {
    if (!complaints_.none()) throw InvalidInput(complaints_.text(table_.name));
  }

 private:
  static constexpr double kNoBound = std::numeric_limits<double>::infinity();
  [[nodiscard]] bool has(const std::string& column) const {
    return std::ranges::find(table_.header, column) != table_.header.end();
  }

  const CsvTable& table_;
  Complaints complaints_;
  std::map<std::string, int> lines_;  ///< of the rows, by their labels
};

/// Viscous and Coulomb friction: as published, else all of the no-load torque viscous.
void set_friction(CatalogueRows& rows, const CsvTable::Row& row,
                  actuator::CatalogueMotor& catalogued) {
  actuator::Motor& motor = catalogued.motor;
  const auto coulomb = rows.number(row, "coulomb_torque_nm", 0.0, false);
  const auto viscous = rows.number(row, "viscous_nms_per_rad", 0.0, false);
  const auto current = rows.number(row, "no_load_current_a", 0.0, false);
  const auto speed = rows.number(row, "no_load_speed_rad_s", 0.0, true);
  catalogued.coulomb_known = coulomb.has_value();
  catalogued.friction_known = coulomb || viscous || (current && speed);
  motor.coulomb_Nm = coulomb.value_or(0.0);
  motor.static_Nm = motor.coulomb_Nm;
  if (viscous) {
    motor.viscous_Nms = *viscous;
  } else if (current && speed) {
    motor.viscous_Nms =
        std::max(0.0, motor.torque_constant_Nm_A * *current - motor.coulomb_Nm) / *speed;
  }
}

/// Tooth sets that `optimize` refined.
std::vector<actuator::CatalogueGearbox> refined_gearboxes(const CsvTable& table,
                                                          const std::vector<Diagnostic>& slips) {
  CatalogueRows rows(table, slips);
  rows.require({"zS", "zP1", "zR1", "zP2", "zR2", "status", "ratio", "eta_b", "eta_f"});
  constexpr double kAny = -std::numeric_limits<double>::infinity();
  constexpr double kMostPlanets = 1000.0;
  std::vector<actuator::CatalogueGearbox> gearboxes;
  for (const CsvTable::Row& row : table.rows) {
    if (table.text(row, "status") != "optimal") continue;
    const auto teeth = [&](const char* gear) { return table.text(row, gear).value_or("?"); };
    actuator::CatalogueGearbox g;
    g.planets =
        static_cast<int>(rows.number(row, "planets", 0.0, true, kMostPlanets).value_or(0.0));
    g.name = fmt::format("{}/{}/{}/{}/{}", teeth("zS"), teeth("zP1"), teeth("zR1"), teeth("zP2"),
                         teeth("zR2"));
    g.gearbox.ratio = rows.required(row, "ratio", kAny, true);
    g.gearbox.efficiency_forward = rows.required(row, "eta_f", 0.0, true, 1.0);
    g.gearbox.efficiency_backward = rows.required(row, "eta_b", kAny, true, 1.0);
    const auto inertia_kgm2 = rows.number(row, "inertia_kgm2", 0.0, false);
    g.inertia_known = inertia_kgm2.has_value();
    g.gearbox.output_inertia_kgm2 = inertia_kgm2.value_or(0.0);
    g.gearbox.mass_kg = rows.number(row, "mass_kg", 0.0, false);
    g.continuous_Nm = rows.number(row, "torque_capacity_nm", 0.0, true);
    g.intermittent_Nm = g.continuous_Nm;
    gearboxes.push_back(std::move(g));
  }
  rows.raise();
  return gearboxes;
}

/// A design by its efficiencies, which decide as long as friction is constant and nothing drags.
actuator::CatalogueGearbox designed_gearbox(const std::string& path) {
  const design::Design design = read_design(path);
  const auto evaluated = design::evaluate(design);
  const auto* evaluation = std::get_if<design::Evaluation>(&evaluated);
  if (evaluation == nullptr) {
    throw InvalidInput(
        fmt::format("{}: {}", path, std::get<design::NotDefined>(evaluated).message));
  }
  const design::ShaftLosses<double>& shafts = design.shafts;
  const bool drags = std::ranges::any_of(shafts.drag, [](const auto& drag) {
    return drag.constant_Nm > 0.0 || drag.viscous_Nms > 0.0 || drag.quadratic_Nms2 > 0.0;
  });
  if (efficiency::depends_on_state(design.friction) || drags ||
      shafts.planet_bearing_coefficient > 0.0 || shafts.output_bearing_share > 0.0 ||
      shafts.output_bearing_growth.share > 0.0) {
    throw InvalidInput(fmt::format(
        "{}: its losses depend on speed or load, and a selection takes efficiencies: allowed: a "
        "constant friction.coefficient without drags and bearings; `gear3k actuator` with "
        "gearbox.design runs this one",
        path));
  }
  if (!evaluation->efficiency.forward || !evaluation->efficiency.backward) {
    throw InvalidInput(fmt::format("{}: has no efficiencies, as a mesh has no contact", path));
  }
  actuator::CatalogueGearbox g;
  g.name = design.name.empty() ? std::filesystem::path(path).stem().string() : design.name;
  g.file = path;
  g.planets = design.train.planets;
  g.gearbox.ratio = train::ratio(design.train.teeth);
  g.gearbox.efficiency_forward = *evaluation->efficiency.forward;
  g.gearbox.efficiency_backward = *evaluation->efficiency.backward;
  g.inertia_known = evaluation->inertia.has_value();
  if (evaluation->inertia) g.gearbox.output_inertia_kgm2 = evaluation->inertia->lossless_kgm2;
  g.gearbox.mass_kg = evaluation->total_mass_kg;
  if (evaluation->strength) {
    const auto least = evaluation->strength->least_capacity();
    if (least) g.continuous_Nm = g.intermittent_Nm = least->capacity.torque_Nm;
  }
  return g;
}

using TextOfFile = std::function<std::string(const std::string&)>;

void read_parts(const SelectionInput& input, const std::string& of, const FileReading& reading,
                const TextOfFile& file_text, CollectedErrors& errors, SelectionFiles& files) {
  const std::filesystem::path folder = std::filesystem::path(of).parent_path();
  const auto path_of = [&](const std::string& name) { return (folder / name).string(); };
  const auto text_of = [&](const std::string& name, const std::string& key) {
    files.inputs.push_back(path_of(name));
    return text_of_named_file(file_text, path_of(name), key, reading.place_of(key));
  };
  errors.attempt([&] {
    if (!input.motors.empty()) {
      files.task.motors = parse_motors(text_of(input.motors, "motors"), path_of(input.motors));
    }
  });
  for (const std::string& name : input.gearboxes) {
    errors.attempt([&] {
      auto& all = files.task.gearboxes;
      if (name.ends_with(".toml")) {
        files.inputs.push_back(path_of(name));
        check_named_file(path_of(name), "gearboxes", reading.place_of("gearboxes"));
        if (look_of(read_toml(path_of(name))).kind == DocumentKind::kSpecification) {
          files.tasks.push_back(
              {.file = path_of(name),
               .spec = read_specification(path_of(name), optimize::kMostRefinedSets)});
          const auto named = named_files(files.tasks.back().spec);
          files.inputs.insert(files.inputs.end(), named.begin(), named.end());
          return;
        }
        all.push_back(designed_gearbox(path_of(name)));
        return;
      }
      auto more =
          parse_gearboxes(text_of(name, "gearboxes"), path_of(name), input.backward_over_forward);
      for (actuator::CatalogueGearbox& g : more) g.file = path_of(name);
      all.insert(all.end(), more.begin(), more.end());
    });
  }
  for (const std::string& cycle : input.cycles) {
    errors.attempt([&] {
      files.task.cycles.push_back(parse_cycle(text_of(cycle, "cycles"), path_of(cycle)));
    });
  }
}

SelectionFiles selection_from(const TomlValue& document, const std::string& name,
                              const TextOfFile& file_text) {
  refuse_other_documents(document, name, {DocumentKind::kSelection, DocumentKind::kBlackBox},
                         "--select takes a file with motors, gearboxes and cycles");
  FileReading reading(name);
  SelectionInput input;
  read_by_schema(document, selection_schema(), input, reading);
  check_selection(input, reading);
  SelectionFiles files{.task = input.task, .inputs = {name}};
  CollectedErrors errors;
  errors.attempt([&] { reading.throw_if_invalid(); });
  read_parts(input, name, reading, file_text, errors, files);
  errors.raise();
  if (files.task.weights.empty()) files.task.weights.assign(files.task.cycles.size(), 1.0);
  return files;
}

}  // namespace

std::vector<actuator::CatalogueMotor> parse_motors(const std::string& text,
                                                   const std::string& name) {
  std::vector<Diagnostic> slips;
  const CsvTable table = parse_csv(text, name, slips);
  CatalogueRows rows(table, slips);
  rows.require({"manufacturer", "order_code", "resistance_ohm", "torque_constant_nm_per_a"});
  std::vector<actuator::CatalogueMotor> motors;
  motors.reserve(table.rows.size());
  for (const CsvTable::Row& row : table.rows) {
    rows.refuse_second(row);
    actuator::CatalogueMotor m;
    m.name = rows.label(row);
    m.motor.resistance_ohm = rows.required(row, "resistance_ohm", 0.0, true);
    m.motor.torque_constant_Nm_A = rows.required(row, "torque_constant_nm_per_a", 0.0, true);
    const auto rotor_kgm2 = rows.number(row, "rotor_inertia_kgm2", 0.0, false);
    m.inertia_known = rotor_kgm2.has_value();
    m.motor.rotor_inertia_kgm2 = rotor_kgm2.value_or(0.0);
    m.motor.mass_kg = rows.number(row, "mass_kg", 0.0, false);
    const auto winding = rows.number(row, "thermal_resistance_winding_housing_k_per_w", 0.0, true);
    const auto housing = rows.number(row, "thermal_resistance_housing_ambient_k_per_w", 0.0, true);
    // One of them tells no temperature.
    if (winding && housing) {
      m.motor.heat.winding_housing_K_W = winding;
      m.motor.heat.housing_ambient_K_W = housing;
    }
    m.nominal_current_A = rows.number(row, "nominal_current_a", 0.0, true);
    m.nominal_voltage_V = rows.number(row, "nominal_voltage_v", 0.0, true);
    set_friction(rows, row, m);
    motors.push_back(std::move(m));
  }
  rows.raise();
  return motors;
}

std::vector<actuator::CatalogueGearbox> parse_gearboxes(const std::string& text,
                                                        const std::string& name,
                                                        double backward_over_forward) {
  std::vector<Diagnostic> slips;
  const CsvTable table = parse_csv(text, name, slips);
  if (std::ranges::find(table.header, "zS") != table.header.end()) {
    return refined_gearboxes(table, slips);
  }
  CatalogueRows rows(table, slips);
  rows.require({"manufacturer", "order_code", "ratio", "efficiency"});
  std::vector<actuator::CatalogueGearbox> gearboxes;
  gearboxes.reserve(table.rows.size());
  for (const CsvTable::Row& row : table.rows) {
    rows.refuse_second(row);
    actuator::CatalogueGearbox g;
    g.name = rows.label(row);
    g.gearbox.ratio = rows.required(row, "ratio", 0.0, true);
    g.gearbox.efficiency_forward = rows.required(row, "efficiency", 0.0, true, 1.0);
    g.gearbox.efficiency_backward =
        std::min(1.0, backward_over_forward * g.gearbox.efficiency_forward);
    const auto inertia_kgm2 = rows.number(row, "input_inertia_kgm2", 0.0, false);
    g.inertia_known = inertia_kgm2.has_value();
    g.gearbox.input_inertia_kgm2 = inertia_kgm2.value_or(0.0);
    g.gearbox.mass_kg = rows.number(row, "mass_kg", 0.0, false);
    g.continuous_Nm = rows.number(row, "continuous_torque_nm", 0.0, true);
    g.intermittent_Nm = rows.number(row, "intermittent_torque_nm", 0.0, true);
    gearboxes.push_back(std::move(g));
  }
  rows.raise();
  return gearboxes;
}

SelectionFiles read_selection(const std::string& path) {
  return selection_from(read_toml(path), path, [](const std::string& file) {
    return read_text(file, "a CSV file", kMostCycleBytes);
  });
}

SelectionFiles parse_selection(const std::string& text, const std::string& name,
                               const TextOfFile& file_text) {
  return selection_from(parse_toml(text, name), name, file_text);
}

std::string selection_key_table() { return key_table(selection_schema()); }

}  // namespace gear3k::io
