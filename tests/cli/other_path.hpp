#pragma once
// What a user's environment may lack.

#include <cstdlib>
#include <string>

namespace gear3k::test {

/// The environment's PATH while it is another one, e.g. without gnuplot.
class OtherPath {
 public:
  explicit OtherPath(const char* path) {
    if (const char* before = std::getenv("PATH")) before_ = before;
    ::setenv("PATH", path, 1);
  }
  ~OtherPath() { ::setenv("PATH", before_.c_str(), 1); }
  OtherPath(const OtherPath&) = delete;
  OtherPath& operator=(const OtherPath&) = delete;

 private:
  std::string before_;
};

}  // namespace gear3k::test
