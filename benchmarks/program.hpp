#pragma once
// Benchmarks are one program, called by the names of its parts: each is a source that defines
//   PROGRAM(NAME)(int argc, char** argv) { ... }
// in place of main(), and a link build/release/benchmarks/NAME.

namespace gear3k::benchmarks {

using Main = int (*)(int argc, char** argv);

/// Makes a part known to programs.cpp.
struct Program {
  Program(const char* name, Main main);
};

}  // namespace gear3k::benchmarks

#define PROGRAM(name)                                                          \
  static int name##_main(int argc, char** argv);                               \
  static const gear3k::benchmarks::Program name##_program(#name, name##_main); \
  static int name##_main
