#include "report/comparison_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "design/tightest.hpp"
#include "report/analysis_report.hpp"
#include "report/check_subject.hpp"
#include "report/display.hpp"
#include "report/fields.hpp"
#include "report/first_screen.hpp"
#include "report/text_table.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::report {

namespace {

using design::CheckResult;

/// A quantity of several designs.
struct ComparedQuantity {
  std::string item, quantity, unit;
  std::vector<std::optional<double>> values;  ///< by design

  /// Sums of positive parts have no rounding of their own.
  [[nodiscard]] double rounding() const {
    if (unit.starts_with("kg")) return 0.0;
    return unit == "um" ? kNegligible_um : kNegligible;
  }
  [[nodiscard]] bool alike() const {
    const std::optional<double>& first = values.front();
    return std::ranges::all_of(values, [&](const std::optional<double>& value) {
      if (!first || !value) return !first && !value;
      const double scale = std::max(std::abs(*first), std::abs(*value));
      return std::abs(*value - *first) <= std::max(kAlikeShare * scale, rounding());
    });
  }
};

std::optional<double> number_of(const io::Json& json) {
  return std::visit(
      [](const auto& value) -> std::optional<double> {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_arithmetic_v<T>) return static_cast<double>(value);
        return std::nullopt;
      },
      json.value());
}

Fields terms_fields(const design::OutputTerms& terms, std::span<const design::MeshResult> meshes) {
  Fields f("train");
  f.add("ring_root_diameter_mm", mm(terms.ring_root_diameter_m), {"ring_root_diameter", "mm"});
  f.add("outer_diameter_mm", mm(terms.outer_diameter_m), {"outer_diameter", "mm"});
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    f.append("tooth_force_n_per_nm", terms.tooth_force_per_torque_1_m[k],
             {"tooth_force_per_output_torque", "N/(N m)", 0, meshes[k].name});
  }
  const auto milli = [](const std::optional<double>& share) {
    constexpr double kPerMille = 1e3;
    return share ? std::optional(*share * kPerMille) : std::nullopt;
  };
  constexpr const char* kUnit = "mN m/(N m)";
  f.add("driving_torque", milli(terms.driving_torque_share),
        {"driving_torque_per_output_torque", kUnit});
  f.add("friction_torque", milli(terms.friction_torque_share),
        {"friction_torque_per_output_torque", kUnit});
  f.add("back_driven_torque", milli(terms.back_driven_torque_share),
        {"back_driven_torque_per_output_torque", kUnit});
  return f;
}

/// Every quantity that a design has, those of the first design first.
std::vector<ComparedQuantity> all_quantities(std::span<const ComparedDesign> designs) {
  std::vector<ComparedQuantity> all;
  std::map<std::tuple<std::string, std::string, std::string>, std::size_t> places;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    Fields fields = terms_fields(designs[i].terms, designs[i].evaluation.meshes);
    fields.join(analysis_quantities(designs[i].evaluation));
    for (FieldRow& row : fields.rows()) {
      const auto value = number_of(row.value);
      if (!value) continue;
      const auto [place, added] =
          places.try_emplace({row.item, row.quantity, row.unit}, all.size());
      if (added) {
        all.push_back({.item = std::move(row.item),
                       .quantity = std::move(row.quantity),
                       .unit = std::move(row.unit),
                       .values = std::vector<std::optional<double>>(designs.size())});
      }
      all[place->second].values[i] = value;
    }
  }
  return all;
}

/// A part of the table: quantities by their names in the CSV.
struct TablePart {
  std::string_view title;
  std::vector<std::string_view> quantities;
  bool of_train = false;  ///< those of the train and its stages alone
};
const std::vector<TablePart>& table_parts() {
  static const std::vector<TablePart> parts{
      {.title = "Size",
       .quantities = {"planets", "ratio", "module", "center_distance", "ring_root_diameter",
                      "outer_diameter", "mass"},
       .of_train = true},
      {.title = "Output",
       .quantities = {"efficiency_forward", "efficiency_backward",
                      "driving_torque_per_output_torque", "friction_torque_per_output_torque",
                      "back_driven_torque_per_output_torque", "lost_motion_kinematic",
                      "inertia_lossless", "rated_output_torque", "torque_capacity",
                      "torque_density", "gears_torque_density", "output_stiffness"},
       .of_train = true},
      {.title = "Meshes",
       .quantities = {"tooth_force_per_output_torque", "face_width", "working_pressure_angle",
                      "contact_ratio", "normal_backlash"}},
      {.title = "Gears",
       .quantities = {"teeth", "profile_shift", "tip_diameter", "root_diameter", "tip_thickness"}}};
  return parts;
}

bool is_of_train(const ComparedQuantity& q) {
  return q.item == "train" || q.item.starts_with("stage ");
}

std::string cell(const std::optional<double>& value, double rounding) {
  if (!value) return "none";
  return fmt::format("{:.6g}", std::abs(*value) < rounding ? 0.0 : *value);
}

/// The change from the first of two positive values.
std::string change_text(const ComparedQuantity& q) {
  const std::optional<double>& from = q.values[0];
  const std::optional<double>& to = q.values[1];
  if (!from || !to || !(std::min(*from, *to) > q.rounding())) return "";
  constexpr double kMost = 10.0;
  const double change = *to / *from - 1.0;
  return std::abs(change) < kMost ? fmt::format("{:+.2f} %", percent(change)) : "";
}

/// Heads of a table's columns: the labels, or letters where one is long.
std::vector<std::string> column_labels(std::span<const ComparedDesign> designs) {
  constexpr std::size_t kLong = 14;
  std::vector<std::string> labels;
  labels.reserve(designs.size());
  for (const ComparedDesign& one : designs) labels.push_back(one.label);
  const bool fit =
      std::ranges::all_of(labels, [](const std::string& label) { return label.size() <= kLong; });
  for (std::size_t k = 0; k < labels.size() && !fit; ++k) {
    labels[k] = k < 26 ? std::string(1, static_cast<char>('A' + k)) : fmt::format("{}", k + 1);
  }
  return labels;
}

/// Rows of a table, its head first: quantity, of, unit, the designs and of two the change.
class ComparisonRows {
 public:
  explicit ComparisonRows(std::span<const ComparedDesign> designs) : designs_(designs.size()) {
    std::vector<std::string> header{"quantity", "of", "unit"};
    for (const std::string& label : column_labels(designs)) header.push_back(label);
    if (designs_ == 2) header.emplace_back("change");
    rows_.push_back(std::move(header));
  }

  void add(const ComparedQuantity& q) {
    std::string name = q.quantity;
    std::ranges::replace(name, '_', ' ');
    if (q.quantity == "output_stiffness") name += " at rated output torque";
    std::vector<std::string> row{std::move(name), q.item == "train" ? "" : q.item, q.unit};
    for (const auto& value : q.values) row.push_back(cell(value, q.rounding()));
    if (q.values.size() == 2) row.push_back(change_text(q));
    rows_.push_back(std::move(row));
  }
  [[nodiscard]] bool any() const { return rows_.size() > 1; }

  /// The table in at most so many columns; where it needs more, several of fewer designs.
  [[nodiscard]] std::string text(std::size_t columns) const {
    if (designs_ <= 2) return block(kNames, rows_.front().size() - kNames, columns);
    std::string text;
    for (std::size_t from = 0; from < designs_;) {
      std::size_t count = designs_ - from;
      while (count > 1 && width_of(kNames + from, count) + kLeastName > columns) --count;
      if (from > 0) text += '\n';
      text += block(kNames + from, count, columns);
      from += count;
    }
    return text;
  }

 private:
  static constexpr std::size_t kNames = 3, kIndent = 2, kGap = 2;
  static constexpr std::size_t kLeastName = 20;  ///< no name is broken to less: "(backlash.model),"

  [[nodiscard]] std::size_t widest(std::size_t column) const {
    std::size_t most = 0;
    for (const auto& row : rows_) most = std::max(most, row[column].size());
    return most;
  }
  /// Width of a table of these columns, without the quantities' names.
  [[nodiscard]] std::size_t width_of(std::size_t first, std::size_t count) const {
    std::size_t width = kIndent + 2 * kGap + widest(1) + widest(2);
    for (std::size_t k = first; k < first + count; ++k) width += kGap + widest(k);
    return width;
  }
  /// A name in pieces of at most so many letters, the further ones indented.
  static std::vector<std::string> pieces(const std::string& name, std::size_t room) {
    std::vector<std::string> lines;
    std::istringstream words(broken(name, static_cast<int>(room), 2));
    for (std::string line; std::getline(words, line);) lines.push_back(line);
    return lines;
  }
  [[nodiscard]] std::string block(std::size_t first, std::size_t count, std::size_t columns) const {
    const std::size_t others = width_of(first, count);
    const std::size_t room = std::max(kLeastName, columns > others ? columns - others : 0);
    const auto of_row = [&](const std::vector<std::string>& row, std::string name) {
      std::vector<std::string> own{std::move(name), row[1], row[2]};
      own.insert(own.end(), row.begin() + static_cast<std::ptrdiff_t>(first),
                 row.begin() + static_cast<std::ptrdiff_t>(first + count));
      return own;
    };
    TextTable table(of_row(rows_.front(), rows_.front()[0]));
    table.align_left(1);
    table.align_left(2);
    for (std::size_t k = 1; k < rows_.size(); ++k) {
      // What is left of a broken name stands in lines of its own below.
      const std::vector<std::string> names = pieces(rows_[k][0], room);
      table.add(of_row(rows_[k], names.front()));
      for (std::size_t n = 1; n < names.size(); ++n) {
        std::vector<std::string> below(kNames + count);
        below[0] = names[n];
        table.add(std::move(below));
      }
    }
    return table.text(kIndent);
  }

  std::size_t designs_;
  std::vector<std::vector<std::string>> rows_;
};

std::string part_text(const TablePart& part, std::span<const ComparedDesign> designs,
                      std::span<const ComparedQuantity> quantities, std::size_t columns) {
  ComparisonRows rows(designs);
  for (const std::string_view name : part.quantities) {
    for (const ComparedQuantity& q : quantities) {
      if (q.quantity != name || is_of_train(q) != part.of_train || q.alike()) continue;
      rows.add(q);
    }
  }
  return rows.any() ? fmt::format("\n{}\n", part.title) + rows.text(columns) : "";
}

/// Whose outer diameter has no rims in it, where that of others has.
std::string rims_text(std::span<const ComparedDesign> designs, std::size_t columns) {
  const std::vector<std::string> labels = column_labels(designs);
  std::vector<std::string> without;
  for (std::size_t k = 0; k < designs.size(); ++k) {
    if (!designs[k].terms.outer_surface_stated) without.push_back(labels[k]);
  }
  if (without.empty() || without.size() == designs.size()) return "";
  return broken(
      without.size() == 1
          ? fmt::format("  no rims are stated of {}: its outer diameter is that of the larger root "
                        "circle",
                        without.front())
          : fmt::format("  no rims are stated of {}: the outer diameter of each is that of its "
                        "larger root circle",
                        fmt::join(without, ", ")),
      static_cast<int>(columns), 4);
}

/// Checks that fail in one of the designs, or are met there with less than a twentieth of their
/// limit to spare, or of what counts as small where that is 0.
std::string margins_text(std::span<const ComparedDesign> designs, std::size_t columns) {
  constexpr double kTight = 0.05;
  std::vector<ComparedQuantity> margins;
  std::map<std::pair<std::string, std::string>, std::size_t> places;
  std::vector<bool> tight;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    for (const CheckResult& c : designs[i].evaluation.checks) {
      const units::Unit unit = c.record->unit;
      const auto [place, added] =
          places.try_emplace({std::string(c.record->name), subject_of(c)}, margins.size());
      if (added) {
        margins.push_back({.item = subject_of(c),
                           .quantity = std::string(c.record->title),
                           .unit = std::string(units::unit_name(unit)),
                           .values = std::vector<std::optional<double>>(designs.size())});
        tight.push_back(false);
      }
      // What passes may miss its limit by rounding.
      const double margin = c.ok ? std::max(0.0, c.margin) : c.margin;
      margins[place->second].values[i] = units::difference_from_si(margin, unit);
      if (!c.ok || c.margin < kTight * design::margin_scale(c)) tight[place->second] = true;
    }
  }
  ComparisonRows rows(designs);
  for (std::size_t k = 0; k < margins.size(); ++k) {
    if (tight[k] && !margins[k].alike()) rows.add(margins[k]);
  }
  constexpr const char* kHead =
      "Margins of checks that fail or nearly do in one of them (negative: fails)";
  return rows.any() ? "\n" + broken(kHead, static_cast<int>(columns), 4) + rows.text(columns) : "";
}

}  // namespace

std::string comparison_table(std::span<const ComparedDesign> designs, int columns) {
  constexpr std::size_t kFurther = 4;  // indent of what follows a broken line
  const std::vector<std::string> labels = column_labels(designs);
  std::string text;
  for (std::size_t k = 0; k < designs.size(); ++k) {
    const ComparedDesign& one = designs[k];
    const auto failed = std::ranges::count(one.evaluation.checks, false, &CheckResult::ok);
    const std::string name = one.label == labels[k] ? labels[k] : labels[k] + "  " + one.label;
    const std::string file = one.label == one.file ? "" : fmt::format(" ({})", one.file);
    text += broken(fmt::format("{}{}: {}, checks that fail: {}", name, file,
                               teeth_text(one.evaluation.teeth), failed),
                   columns, kFurther);
  }
  const std::vector<ComparedQuantity> quantities = all_quantities(designs);
  const auto width = static_cast<std::size_t>(columns);
  for (const TablePart& part : table_parts()) {
    text += part_text(part, designs, quantities, width);
    if (&part == table_parts().data()) text += rims_text(designs, width);
  }
  text += margins_text(designs, width);
  const auto differ = std::ranges::count(quantities, false, &ComparedQuantity::alike);
  return text + fmt::format("\n{} of {} quantities differ{}.\n", differ, quantities.size(),
                            differ > 0 ? "; --format csv has them all" : "");
}

std::string comparison_json(std::span<const ComparedDesign> designs) {
  const std::vector<ComparedQuantity> quantities = all_quantities(designs);
  io::Json list = io::Json::array();
  std::size_t alike = 0;
  for (const ComparedQuantity& q : quantities) {
    if (q.alike()) {
      ++alike;
      continue;
    }
    list.push_back(
        {{"item", q.item}, {"quantity", q.quantity}, {"unit", q.unit}, {"values", q.values}});
  }
  io::Json result{{"tool", tool_json()}};
  result["designs"] = list_json(designs, [](const ComparedDesign& one) {
    const auto& e = one.evaluation;
    return io::Json{{"label", one.label},
                    {"file", one.file},
                    {"name", e.name},
                    {"outer_surface_stated", one.terms.outer_surface_stated},
                    {"ok", design::all_ok(e.checks)}};
  });
  result["quantities"] = std::move(list);
  result["alike"] = alike;
  return result.text();
}

std::string comparison_csv(std::span<const ComparedDesign> designs) {
  std::vector<std::string> header{"item", "quantity", "unit"};
  for (const ComparedDesign& one : designs) header.push_back(one.label);
  std::string text = csv_line(header);
  for (const ComparedQuantity& q : all_quantities(designs)) {
    if (q.alike()) continue;
    std::vector<std::string> line{q.item, q.quantity, q.unit};
    for (const auto& value : q.values) line.push_back(exact(or_nan(value)));
    text += csv_line(line);
  }
  return text;
}

}  // namespace gear3k::report
