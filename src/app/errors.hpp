#pragma once
// Errors of several steps, told together.

#include <string>

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
      if (text_.find(error.what()) != std::string::npos) return;
      if (!text_.empty()) text_ += '\n';
      text_ += error.what();
    }
  }
  /// @throws io::InvalidInput with all of them
  void throw_if_any() const {
    if (!text_.empty()) throw io::InvalidInput(text_);
  }

 private:
  std::string text_;
};

}  // namespace gear3k::app
