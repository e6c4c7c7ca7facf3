#include "tools/bench_host/machine_notes.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/utsname.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "controller/runlog/build_info.h"
#include "tools/bench_host/timing.h"

namespace flexarm {
namespace {

constexpr double kBusyLoad = 0.3;     // more than what this program itself leaves in the mean
constexpr double kWholeShare = 0.98;  // less: something else ran on this core
constexpr double kWatched_s = 0.1;

// Of the first line "name : value".
std::string CpuLine(const std::string& cpuinfo, const std::string& name) {
  std::istringstream lines(cpuinfo);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':');
    if (!line.starts_with(name) || colon == std::string::npos) continue;
    const std::size_t begin = line.find_first_not_of(" \t", colon + 1);
    return begin == std::string::npos ? "" : line.substr(begin);
  }
  return "";
}

int UsableCores() {
  cpu_set_t cores;
  return sched_getaffinity(0, sizeof cores, &cores) == 0 ? CPU_COUNT(&cores) : 1;
}

double ProcessorShare() {
  const double wall_s = WallTime_s(), thread_s = ThreadTime_s();
  double now_s = wall_s;
  while (now_s - wall_s < kWatched_s) now_s = WallTime_s();
  return std::min(1.0, (ThreadTime_s() - thread_s) / (now_s - wall_s));
}

std::string KernelText() {
  utsname names{};
  return uname(&names) == 0 ? std::string(names.sysname) + " " + names.release : "unknown";
}

}  // namespace

MachineNotes ReadMachine(const HostFiles& files) {
  const std::string cpuinfo = files.Read("/proc/cpuinfo").text;
  const std::string model = CpuLine(cpuinfo, "model name");
  double load = 0.0;
  if (getloadavg(&load, 1) != 1) load = 0.0;
  return {.processor = model.empty() ? "unknown" : model,
          .cores = UsableCores(),
          .is_virtual = (CpuLine(cpuinfo, "flags") + " ").find(" hypervisor ") != std::string::npos,
          .kernel = KernelText(),
          .governor = files.Read("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor").text,
          .load = load,
          .processor_share = ProcessorShare(),
          .compiler = ThisBuild().compiler,
          .build_type = FLEXARM_BUILD_TYPE,
          .build = BuildId()};
}

std::vector<std::string> WarningsOf(const MachineNotes& machine) {
  std::vector<std::string> warnings;
  if (machine.load > kBusyLoad || machine.processor_share < kWholeShare) {
    warnings.push_back(
        fmt::format("the machine is busy: load {:.1f}, a busy thread got {:.0f} % of a core; trust "
                    "the ratios, and stop what else runs before you compare times",
                    machine.load, 100.0 * machine.processor_share));
  }
  if (!machine.governor.empty() && machine.governor != "performance") {
    warnings.push_back("the frequency governor is " + machine.governor +
                       ": `cpupower frequency-set -g performance` makes times repeatable");
  }
  if (machine.build_type != "Release") {
    warnings.push_back("this is a build of type " + machine.build_type +
                       ": `cmake --preset release` makes the one that runs on a rig");
  }
  return warnings;
}

}  // namespace flexarm
