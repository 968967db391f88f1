#pragma once
// Errors of several steps, told together.

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "io/text/diagnostics.hpp"

namespace gear3k::app {

class Errors {
 public:
  /// Runs a step; an error in it is kept, once where several steps have the same.
  template <class Step>
  void collect(Step step) {
    try {
      step();
    } catch (const io::InvalidInput& error) {
      const std::string text = error.what();
      if (std::ranges::find(texts_, text) == texts_.end()) texts_.push_back(text);
    }
  }
  /// @throws io::InvalidInput with all of them
  void throw_if_any() const {
    if (!texts_.empty()) throw io::InvalidInput(fmt::format("{}", fmt::join(texts_, "\n")));
  }

 private:
  std::vector<std::string> texts_;
};

}  // namespace gear3k::app
