#include "io/text/complaints.hpp"

#include <fmt/format.h>

#include <utility>

namespace gear3k::io {

void Complaints::add(Position position, std::string message) {
  add(position, [&] { return std::move(message); });
}

void Complaints::add(Position position, const std::function<std::string()>& message) {
  if (position.line == 0 || messages_.size() < kMost) {
    messages_.push_back({.position = position, .message = message()});
  } else {
    ++more_;
  }
}

std::string Complaints::text(const std::string& path) const {
  std::string text = format_diagnostics(path, messages_);
  if (more_ > 0) text += fmt::format("\n{}: and {} more", path, more_);
  return text;
}

}  // namespace gear3k::io
