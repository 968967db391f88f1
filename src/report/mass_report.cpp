#include "report/mass_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

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

Fields mass_fields(const design::Evaluation& e) {
  const auto from = [](const std::optional<double>& value, MassOrigin origin) {
    return value ? io::Json(origin_name(origin)) : nullptr;
  };
  Fields f("train");
  f.add_list("masses", e.parts, [&](const PartMass& part) {
    Fields p(part.name);
    p.add("name", part.name);
    p.add("count", part.count);
    if (known(part)) p.add_row(part.count, {"count"});
    p.add("mass_kg", part.mass_kg, {"mass", "kg"});
    p.add("mass_from", from(part.mass_kg, part.mass_origin));
    p.add("inertia_kgm2", part.inertia_kgm2, {"inertia", "kg m2"});
    p.add("inertia_from", from(part.inertia_kgm2, part.inertia_origin));
    return p;
  });
  f.add("total_mass_kg", e.total_mass_kg, {"mass", "kg"});
  return f;
}

}  // namespace gear3k::report
