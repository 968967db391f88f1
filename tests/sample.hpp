#pragma once
// How much a test samples.

#include <cstdlib>
#include <string_view>

namespace gear3k {

/// True where the environment says GEAR3K_LONG=1, as under `./check long`.
inline bool long_samples() {
  const char* const value = std::getenv("GEAR3K_LONG");
  return value != nullptr && std::string_view(value) == "1";
}

/// The usual size of a sample, or the long one.
template <class Size>
Size sample(Size usual, Size long_one) {
  return long_samples() ? long_one : usual;
}

}  // namespace gear3k
