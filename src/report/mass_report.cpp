#include "report/mass_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "io/text/json.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using design::MassOrigin, design::PartMass;

std::string origin_name(MassOrigin origin) {
  return origin == MassOrigin::kStated ? "stated" : "geometry";
}

bool known(const PartMass& part) { return part.mass_kg || part.inertia_kgm2; }

}  // namespace

std::string mass_table(const design::Evaluation& e) {
  if (!std::ranges::any_of(e.parts, known)) return "";
  TextTable table({"part", "count", "mass", "from", "inertia", "from"});
  for (const std::size_t column : {3U, 5U}) table.align_left(column);
  for (const PartMass& part : e.parts) {
    if (!known(part)) continue;
    table.add({part.name, fmt::format("{}", part.count),
               part.mass_kg ? fmt::format("{:.5g} kg", *part.mass_kg) : "",
               part.mass_kg ? origin_name(part.mass_origin) : "",
               part.inertia_kgm2 ? fmt::format("{:.4e} kg m2", *part.inertia_kgm2) : "",
               part.inertia_kgm2 ? origin_name(part.inertia_origin) : ""});
  }
  return "\nMasses (of one part; inertia about its own axis)\n" + table.text(2) +
         (e.total_mass_kg
              ? fmt::format("  all parts: {:.5g} kg\n", *e.total_mass_kg)
              : fmt::format("  all parts: not known: lacks {}\n", e.total_mass_missing));
}

void add_masses(io::Json& json, const design::Evaluation& e) {
  const auto from = [](const std::optional<double>& value, MassOrigin origin) {
    return value ? io::Json(origin_name(origin)) : nullptr;
  };
  auto& list = json["masses"] = io::Json::array();
  for (const PartMass& part : e.parts) {
    list.push_back({{"name", part.name},
                    {"count", part.count},
                    {"mass_kg", part.mass_kg},
                    {"mass_from", from(part.mass_kg, part.mass_origin)},
                    {"inertia_kgm2", part.inertia_kgm2},
                    {"inertia_from", from(part.inertia_kgm2, part.inertia_origin)}});
  }
  json["total_mass_kg"] = e.total_mass_kg;
}

std::string mass_csv(const design::Evaluation& e) {
  std::string text;
  const auto add = [&](const std::string& item, const std::string& quantity, double value,
                       const std::string& unit) {
    text += csv_line({item, quantity, exact(value), unit, "", ""});
  };
  for (const PartMass& part : e.parts) {
    if (!known(part)) continue;
    add(part.name, "count", part.count, "");
    if (part.mass_kg) add(part.name, "mass", *part.mass_kg, "kg");
    if (part.inertia_kgm2) add(part.name, "inertia", *part.inertia_kgm2, "kg m2");
  }
  if (e.total_mass_kg) add("train", "mass", *e.total_mass_kg, "kg");
  return text;
}

}  // namespace gear3k::report
