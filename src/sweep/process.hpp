#pragma once
// Which process holds a task, and whether it lives.

#include <cstdint>
#include <string>

namespace gear3k::sweep {

/// A process by what no later one has.
struct Process {
  std::string host;         ///< machine, its start and the name space of its processes
  std::int64_t number = 0;  ///< of the process
  std::int64_t began = 0;  ///< clock ticks from the machine's start to its own (proc(5), starttime)
};

Process this_process();
/// Another process of this machine; `began` = 0 where there is none.
Process process_of(std::int64_t number);
/// Whether a process of this machine has ended, or lives; false where it is another's.
bool is_dead(const Process& process);
bool is_alive(const Process& process);
/// The machine's name.
std::string host_name();

}  // namespace gear3k::sweep
