#pragma once

#include <string>
#include <vector>

#include "controller/host/host_files.h"

namespace flexarm {

/// The machine and the build that a table is of.
struct MachineNotes {
  std::string processor;  ///< "unknown" if the kernel does not say
  int cores;              ///< that this process may use
  bool is_virtual;        ///< a guest of a hypervisor that says so
  std::string kernel;
  std::string governor;    ///< of the clock frequency of the first core; "" if it has none
  double load;             ///< processes that wanted to run, mean of a minute, before the start
  double processor_share;  ///< of the time that a busy thread got a core, before the start, 0..1
  std::string compiler, build_type, build;
};

/// Takes a tenth of a second.
MachineNotes ReadMachine(const HostFiles& files);

/// What makes figures of this machine worse than they might be.
std::vector<std::string> WarningsOf(const MachineNotes& machine);

}  // namespace flexarm
