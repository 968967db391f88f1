#include "io/files/document_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "calibrate/measurement/measurement.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io {

namespace {

/// By DocumentKind.
constexpr std::array<std::string_view, 8> kNames{"",
                                                 "a DESIGN",
                                                 "a PAIR",
                                                 "a SPEC",
                                                 "a black box",
                                                 "a model.toml of diagnose",
                                                 "an ACTUATOR",
                                                 "a SCENARIO"};

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

}  // namespace

DocumentLook look_of(const TomlValue& document) {
  using enum DocumentKind;
  for (const std::string_view kind : calibrate::kKindNames) {
    if (has_table(document, kind)) return {.kind = kModel, .sign = fmt::format("[{}]", kind)};
  }
  if (has_table(document, "control")) return {.kind = kScenario, .sign = "[control]"};
  if (has_table(document, "motor")) return {.kind = kActuator, .sign = "[motor]"};
  if (has_table(document, "gearbox")) return {.kind = kBlackBox, .sign = "[gearbox]"};
  if (describes_gears(document)) return {.kind = kDesign, .sign = "[gears]"};
  for (const std::string_view key : {"gear1", "gear2"}) {
    if (has_table(document, key)) return {.kind = kPair, .sign = fmt::format("[{}]", key)};
  }
  for (const std::string_view key : {"ratio", "teeth"}) {
    if (has_table(document, key)) return {.kind = kSpecification, .sign = fmt::format("[{}]", key)};
  }
  return {};
}

std::string look_text(const DocumentLook& look, std::string_view takes) {
  if (look.kind == DocumentKind::kUnknown) return "";
  return fmt::format("looks like {}: it has {}; {}", kNames[static_cast<std::size_t>(look.kind)],
                     look.sign, takes);
}

void refuse_other_documents(const TomlValue& document, const std::string& path,
                            std::initializer_list<DocumentKind> allowed, std::string_view takes) {
  const DocumentLook look = look_of(document);
  if (look.kind == DocumentKind::kUnknown || std::ranges::find(allowed, look.kind) != allowed.end())
    return;
  throw InvalidInput(fmt::format("{}: {}", path, look_text(look, takes)));
}

}  // namespace gear3k::io
