#pragma once
// Which of the files that commands read a TOML document looks like.

#include <initializer_list>
#include <string>
#include <string_view>

#include "io/text/toml_value.hpp"

namespace gear3k::io {

enum class DocumentKind {
  kUnknown,
  kDesign,
  kPair,
  kSpecification,
  kBlackBox,
  kModel,
  kActuator,
  kScenario,
  kSelection
};

/// What a document looks like, told from a table that only one kind of file has.
struct DocumentLook {
  DocumentKind kind = DocumentKind::kUnknown;
  std::string sign = {};  ///< "[gears]", "kind"
};
DocumentLook look_of(const TomlValue& document);

/// "looks like a DESIGN: it has [gears]; TAKES"; "" of an unknown kind.
std::string look_text(const DocumentLook& look, std::string_view takes);

/// Refuses a document that is plainly another file, before all that would be wrong with its keys;
/// not one that has a sign of what is allowed, too.
/// @param takes  what is read here: "--model takes a model.toml of diagnose"
/// @throws InvalidInput "PATH: looks like a DESIGN: it has [gears]; TAKES"
void refuse_other_documents(const TomlValue& document, const std::string& path,
                            std::initializer_list<DocumentKind> allowed, std::string_view takes);

}  // namespace gear3k::io
