#include "controller/host/host_facts.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <sstream>
#include <utility>

namespace flexarm {
namespace {

constexpr unsigned kCapIpcLock = 14;  // linux/capability.h

// The value of a line "Name:  value" of /proc/self/status; "" if there is none.
std::string StatusLine(const std::string& status, const std::string& name) {
  std::istringstream lines(status);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(name + ":")) continue;
    const std::size_t begin = line.find_first_not_of(" \t", name.size() + 1);
    return begin == std::string::npos ? "" : line.substr(begin);
  }
  return {};
}

std::optional<bool> HasLockCapability(const std::string& status) {
  std::istringstream text(StatusLine(status, "CapEff"));
  std::uint64_t capabilities = 0;
  if (!(text >> std::hex >> capabilities)) return std::nullopt;
  return (capabilities >> kCapIpcLock & 1) != 0;
}

std::vector<IdleState> IdleStates(const HostFiles& files, const std::string& cpu) {
  std::vector<IdleState> states;
  for (const std::string& name : files.List(cpu + "/cpuidle")) {
    const std::string state = cpu + "/cpuidle/" + name;
    if (!name.starts_with("state") || files.Read(state + "/disable").number() == 1) continue;
    states.push_back({.name = files.Read(state + "/name").text,
                      .exit_latency_us = files.Read(state + "/latency").number()});
  }
  return states;
}

std::optional<std::vector<CpuFacts>> Cpus(const HostFiles& files, const std::string& status) {
  const std::string allowed = StatusLine(status, "Cpus_allowed_list");
  const HostText online = files.Read("/sys/devices/system/cpu/online");
  const auto numbers = NumbersOfList(allowed);
  const auto present = NumbersOfList(online.text);
  if (allowed.empty() || !numbers || !present) return std::nullopt;
  std::vector<CpuFacts> all;
  for (const int number : *numbers) {
    // The list may name processors that the machine does not have.
    if (online.read() && std::find(present->begin(), present->end(), number) == present->end()) {
      continue;
    }
    const std::string cpu = "/sys/devices/system/cpu/cpu" + std::to_string(number);
    all.push_back({.number = number,
                   .governor = files.Read(cpu + "/cpufreq/scaling_governor"),
                   .may_idle = IdleStates(files, cpu)});
  }
  return all;
}

// A read gives the strictest limit that any process holds, as 32 bits of the machine's order.
std::optional<std::int64_t> WakeUpLimit(const HostFiles& files) {
  constexpr std::int32_t kNoLimit_us = 2'000'000'000;  // linux/pm_qos.h
  const HostText held = files.Read("/dev/cpu_dma_latency");
  std::int32_t limit_us = 0;
  // Read drops white space and line ends, so a number that ends in such a byte counts as none.
  if (!held.read() || held.text.size() != sizeof(limit_us)) return std::nullopt;
  std::memcpy(&limit_us, held.text.data(), sizeof(limit_us));
  if (limit_us >= kNoLimit_us) return std::nullopt;
  return limit_us;
}

// The names are cut to 15 letters by the kernel.
std::string TimeService(const HostFiles& files) {
  constexpr std::array<const char*, 4> kServices = {"chronyd", "systemd-timesyn", "ntpd",
                                                    "openntpd"};
  for (const std::string& process : files.List("/proc")) {
    if (process.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string name = files.Read("/proc/" + process + "/comm").text;
    if (std::find(kServices.begin(), kServices.end(), name) != kServices.end()) return name;
  }
  return {};
}

}  // namespace

HostFacts ReadHostFacts(const HostFiles& files, const HalConfig& hal, int fifo_priority) {
  const std::string status = files.Read("/proc/self/status").text;
  return {.realtime = ReadRealtimeHost(fifo_priority),
          .may_lock_all = HasLockCapability(status),
          .throttle_period_us = files.Read("/proc/sys/kernel/sched_rt_period_us"),
          .cpu = Cpus(files, status),
          .wake_up_limit_us = WakeUpLimit(files),
          .isolated_cpus = files.Read("/sys/devices/system/cpu/isolated"),
          .clock_source =
              files.Read("/sys/devices/system/clocksource/clocksource0/current_clocksource"),
          .interrupt_thread = ReadInterruptThreads(files),
          .bus = ReadBusFacts(files, hal),
          .time_service = TimeService(files),
          .chrony_config = files.Read("/etc/chrony/chrony.conf")};
}

}  // namespace flexarm
