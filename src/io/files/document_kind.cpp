#include "io/files/document_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "calibrate/measurement/measurement.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io {

namespace {

/// By DocumentKind.
constexpr std::array<std::string_view, 9> kNames{"",
                                                 "a DESIGN",
                                                 "a PAIR",
                                                 "a SPEC",
                                                 "a black box",
                                                 "a model.toml of diagnose",
                                                 "an ACTUATOR",
                                                 "a SCENARIO",
                                                 "a SPEC of a selection"};

const TomlValue* member(const TomlValue& document, std::string_view key) {
  const auto found = std::ranges::find(document.table, key, &TomlValue::key);
  return found == document.table.end() ? nullptr : &*found;
}

bool has_table(const TomlValue& document, std::string_view key) {
  const TomlValue* value = member(document, key);
  return value != nullptr && value->kind == TomlValue::Kind::kTable;
}

/// Whether [gears] holds gears: a SPEC states materials there and nothing else.
bool describes_gears(const TomlValue& document) {
  if (!has_table(document, "gears")) return false;
  const std::vector<TomlValue>& gears = member(document, "gears")->table;
  const auto of_material_only = [](const TomlValue& gear) {
    return gear.table.size() == 1 && gear.table[0].key == "material";
  };
  return gears.empty() || !std::ranges::all_of(gears, of_material_only);
}

/// All kinds that a document has a sign of, the most telling first.
std::vector<DocumentLook> looks_of(const TomlValue& document) {
  using enum DocumentKind;
  std::vector<DocumentLook> looks;
  const auto add_table = [&](DocumentKind kind, std::string_view key) {
    if (!has_table(document, key)) return false;
    looks.push_back({.kind = kind, .sign = fmt::format("[{}]", key)});
    return true;
  };
  for (const std::string_view kind : calibrate::kKindNames) {
    if (add_table(kModel, kind)) break;
  }
  add_table(kScenario, "control");
  if (!add_table(kActuator, "motor")) {
    if (member(document, "gearboxes") != nullptr) {
      looks.push_back({.kind = kSelection, .sign = "gearboxes"});
    } else {
      add_table(kBlackBox, "gearbox");
    }
  }
  if (describes_gears(document)) looks.push_back({.kind = kDesign, .sign = "[gears]"});
  if (!add_table(kPair, "gear1")) add_table(kPair, "gear2");
  if (!add_table(kSpecification, "ratio")) add_table(kSpecification, "teeth");
  return looks;
}

}  // namespace

DocumentLook look_of(const TomlValue& document) {
  const std::vector<DocumentLook> looks = looks_of(document);
  return looks.empty() ? DocumentLook{} : looks.front();
}

std::string look_text(const DocumentLook& look, std::string_view takes) {
  if (look.kind == DocumentKind::kUnknown) return "";
  return fmt::format("looks like {}: it has {}; {}", kNames[static_cast<std::size_t>(look.kind)],
                     look.sign, takes);
}

void refuse_other_documents(const TomlValue& document, const std::string& path,
                            std::initializer_list<DocumentKind> allowed, std::string_view takes) {
  const std::vector<DocumentLook> looks = looks_of(document);
  const bool has_sign = std::ranges::any_of(looks, [&](const DocumentLook& look) {
    return std::ranges::find(allowed, look.kind) != allowed.end();
  });
  if (looks.empty() || has_sign) return;
  throw InvalidInput(fmt::format("{}: {}", path, look_text(looks.front(), takes)));
}

}  // namespace gear3k::io
