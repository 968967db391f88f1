// TOML documents of every kind: read, or refused with InvalidInput, and nothing else.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "entry.hpp"
#include "io/files/actuator_file.hpp"
#include "io/files/design_file.hpp"
#include "io/files/document_kind.hpp"
#include "io/files/model_file.hpp"
#include "io/files/scenario_file.hpp"
#include "io/files/selection_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/files/subject_file.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/toml_value.hpp"

namespace {

using namespace gear3k;

void read_or_refuse(const std::function<void()>& read) {
  try {
    read();
  } catch (const io::InvalidInput&) {
    // What a reader may do.
  }
}

void read_as(io::DocumentKind kind, const std::string& text) {
  using enum io::DocumentKind;
  const std::string name = "fuzz.toml";
  switch (kind) {
    case kDesign:
      io::parse_design(text, name);
      break;
    case kPair:
      io::parse_pair(text, name);
      break;
    case kSpecification:
      io::parse_specification(text, name);
      break;
    case kBlackBox:
      io::parse_black_box(text, name);
      break;
    case kModel:
      io::parse_model(text, name);
      break;
    case kActuator:
      io::parse_actuator(text, name);
      break;
    case kScenario:
      io::parse_scenario(text, name);
      break;
    case kSelection:
      io::parse_selection(
          text, name, [](const std::string& file) -> std::string { throw io::InvalidInput(file); });
      break;
    case kUnknown:
      for (const auto any :
           {kDesign, kPair, kSpecification, kBlackBox, kModel, kActuator, kScenario, kSelection}) {
        read_or_refuse([&] { read_as(any, text); });
      }
      break;
  }
}

}  // namespace

FUZZER(toml)(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  read_or_refuse([&] {
    const io::TomlValue document = io::parse_toml(text, "fuzz.toml");
    io::as_text(document);
    read_as(io::look_of(document).kind, text);
  });
  return 0;
}
