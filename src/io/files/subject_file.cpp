#include "io/files/subject_file.hpp"

#include <algorithm>

#include "io/files/design_file.hpp"
#include "io/files/document_kind.hpp"
#include "io/keys/key_registry.hpp"
#include "io/text/toml_value.hpp"

namespace gear3k::io {

namespace {

using calibrate::BlackBox;

const Schema<BlackBox>& black_box_schema() {
  static const Schema<BlackBox> schema(
      {}, {make_key<BlackBox>(
               {.path = "name",
                .type = KeyType::kText,
                .default_text = "\"\"",
                .help = "name in tables and results"},
               [](auto& t, std::size_t) -> auto& { return t.name; }),
           make_key<BlackBox>(
               {.path = "gearbox.ratio",
                .min = 1.0,
                .max = 1e6,
                .required = true,
                .help = "speed of the fast shaft, which takes the sun's place, over "
                        "that of the output; a magnitude"},
               [](auto& t, std::size_t) -> auto& { return t.ratio; }),
           make_key<BlackBox>(
               {.path = "gearbox.efficiency_forward",
                .min = 0.0,
                .max = 1.0,
                .min_excluded = true,
                .required = true,
                .help = "efficiency with the fast shaft driving"},
               [](auto& t, std::size_t) -> auto& { return t.efficiency_forward; }),
           make_key<BlackBox>(
               {.path = "gearbox.efficiency_backward",
                .min = 0.0,
                .max = 1.0,
                .min_excluded = true,
                .required = true,
                .help = "efficiency with the output driving"},
               [](auto& t, std::size_t) -> auto& { return t.efficiency_backward; }),
           make_key<BlackBox>(
               {.path = "gearbox.backlash_arcmin",
                .unit = units::Unit::kArcmin,
                .min = 0.0,
                .max = 21600.0,
                .default_text = "not stated",
                .help = "lost motion at the output with the fast shaft locked; needed to explain "
                        "lost_motion and torque_angle data"},
               [](auto& t, std::size_t) -> auto& { return t.backlash_rad; })});
  return schema;
}

BlackBox black_box_from(const TomlValue& document, const std::string& name) {
  FileReading reading(name);
  BlackBox box;
  read_by_schema(document, black_box_schema(), box, reading);
  reading.throw_if_invalid();
  return box;
}

bool has_key(const TomlValue& document, const std::string& key) {
  return std::ranges::any_of(document.table, [&](const TomlValue& v) { return v.key == key; });
}

}  // namespace

calibrate::Subject read_subject(const std::string& path, std::string_view takes) {
  const std::string text = read_toml_text(path);
  const TomlValue document = parse_toml(text, path);
  using enum DocumentKind;
  refuse_other_documents(document, path, {kDesign, kPair, kBlackBox}, takes);
  if (has_key(document, "gearbox")) return black_box_from(document, path);
  if (has_key(document, "kind")) return parse_pair(text, path);
  return parse_design(text, path);
}

BlackBox parse_black_box(const std::string& text, const std::string& name) {
  return black_box_from(parse_toml(text, name), name);
}

std::string black_box_key_table() { return key_table(black_box_schema()); }

}  // namespace gear3k::io
