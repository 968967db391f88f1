#pragma once
// The entry of a fuzzer: libFuzzer's, or one of many in the program that replays inputs.

#include <cstddef>
#include <cstdint>

namespace gear3k::fuzz {

/// What a fuzzer does with an input; a replayed one returns 1 when a command refused it.
using Entry = int (*)(const std::uint8_t* data, std::size_t size);

/// Makes a fuzzer known to replay.cpp.
struct Registered {
  Registered(const char* name, Entry entry);
};

}  // namespace gear3k::fuzz

// FUZZER(NAME)(const std::uint8_t* data, std::size_t size) { ... }
#ifdef GEAR3K_REPLAY
#define FUZZER(name)                                                        \
  static int name##_input(const std::uint8_t* data, std::size_t size);      \
  static const gear3k::fuzz::Registered name##_fuzzer(#name, name##_input); \
  static int name##_input
#else
#define FUZZER(name) extern "C" int LLVMFuzzerTestOneInput
#endif
