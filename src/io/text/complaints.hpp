#pragma once
// Messages about one file, as many as are read.

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "io/text/diagnostics.hpp"

namespace gear3k::io {

/// Keeps the first messages and counts the rest; those about the file as a whole are all kept.
class Complaints {
 public:
  static constexpr std::size_t kMost = 50;

  void add(Position position, std::string message);
  /// The same with a message that is made only where it is kept.
  void add(Position position, const std::function<std::string()>& message);
  [[nodiscard]] bool none() const { return messages_.empty(); }
  [[nodiscard]] std::size_t count() const { return messages_.size() + more_; }
  /// As format_diagnostics(), with a last line "path: and 3 more" where there are more.
  [[nodiscard]] std::string text(const std::string& path) const;

 private:
  std::vector<Diagnostic> messages_;
  std::size_t more_ = 0;
};

}  // namespace gear3k::io
