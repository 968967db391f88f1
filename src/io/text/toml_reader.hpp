#pragma once
// Values of a TOML document of the right type, and messages about those that are not.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "io/text/complaints.hpp"
#include "io/text/toml_value.hpp"

namespace gear3k::io {

/// Reads values of one file; the first errors are kept (Complaints) and all counted.  `path` is the
/// full key of a value in messages.
class TomlReader {
 public:
  explicit TomlReader(std::string file) : file_(std::move(file)) {}

  void error(Position position, const std::string& message);
  /// "unknown WHAT WORD; did you mean ...; allowed: ..."
  void unknown(const TomlValue& at, std::string_view what, const std::string& word,
               const std::vector<std::string>& known);
  /// "PATH = VALUE: allowed: ALLOWED"
  void refuse(const TomlValue& value, const std::string& path, const std::string& allowed);

  bool is_table(const TomlValue& value, const std::string& path);
  /// Its text; that of a value that is none with an error.
  std::string text(const TomlValue& value, const std::string& path);
  /// A finite number; 0 and an error where it is none.
  double number(const TomlValue& value, const std::string& path);
  /// true or false; false and an error where it is neither.
  bool truth(const TomlValue& value, const std::string& path);
  std::vector<std::string> texts(const TomlValue& value, const std::string& path);

  [[nodiscard]] std::size_t errors() const { return complaints_.count(); }
  /// @throws InvalidInput where there are errors
  void throw_if_invalid() const;

 private:
  std::string file_;
  Complaints complaints_;
};

}  // namespace gear3k::io
