#include "controller/host/host_checks.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace flexarm {
namespace {

// The remedy is kept only where it is needed.
HostCheck MachineCheck(std::string name, bool ok, std::string value, std::string required,
                       std::string remedy) {
  return {.name = std::move(name),
          .ok = ok,
          .advice = false,
          .value = std::move(value),
          .required = std::move(required),
          .remedy = ok ? "" : std::move(remedy)};
}

HostCheck Kernel(const HostFacts& facts) {
  const std::string& version = facts.realtime.kernel_version;
  return MachineCheck("preempt-rt", IsPreemptRt(facts.realtime),
                      version.empty() ? kUnknownValue : version,
                      "a kernel whose version (uname -v) says PREEMPT_RT",
                      "apt install linux-image-rt-amd64 (or -arm64), then start that kernel");
}

HostCheck FifoPermission(const HostFacts& facts) {
  const RealtimeHost& host = facts.realtime;
  const std::string priority = std::to_string(host.fifo_priority);
  const std::string refusal =
      std::string("refused (") + std::strerror(host.fifo_error) + "); RLIMIT_RTPRIO is " +
      (host.rtprio_limit == RealtimeHost::kUnlimited ? "unlimited"
                                                     : std::to_string(host.rtprio_limit));
  return MachineCheck("fifo-priority", host.fifo_error == 0,
                      host.fifo_error == 0 ? "permitted" : refusal,
                      "SCHED_FIFO up to " + priority + " for this user",
                      "LimitRTPRIO=95 in the unit, as flexarmd.service has it; or check as root");
}

HostCheck MemoryLock(const HostFacts& facts) {
  const std::uint64_t limit = facts.realtime.memlock_limit_bytes;
  const bool unlimited = limit == RealtimeHost::kUnlimited;
  std::string value = unlimited ? "unlimited" : std::to_string(limit) + " bytes";
  if (!unlimited && facts.may_lock_all == true) value += ", but CAP_IPC_LOCK is held";
  if (!unlimited && !facts.may_lock_all) value += ", capabilities " + std::string(kUnknownValue);
  return MachineCheck(
      "memory-lock", unlimited || facts.may_lock_all == true, value,
      "RLIMIT_MEMLOCK unlimited, or CAP_IPC_LOCK",
      "LimitMEMLOCK=infinity in the unit, as flexarmd.service has it; or check as root");
}

HostCheck CpuTimeLimit(const HostFacts& facts) {
  const std::uint64_t limit_us = facts.realtime.rttime_limit_us;
  const bool unlimited = limit_us == RealtimeHost::kUnlimited;
  return MachineCheck("cpu-time-limit", unlimited,
                      unlimited ? "unlimited" : std::to_string(limit_us) + " us",
                      "RLIMIT_RTTIME unlimited: the kernel ends a real-time process beyond it",
                      "LimitRTTIME=infinity in the unit, as flexarmd.service has it");
}

HostCheck Throttling(const HostFacts& facts) {
  const std::int64_t runtime_us = facts.realtime.throttle_runtime_us;
  const std::optional<std::int64_t> period_us = facts.throttle_period_us.number();
  bool ok = runtime_us == -1;
  std::string value = ok ? "off" : kUnknownValue;
  if (!ok && runtime_us >= 0 && period_us && *period_us > 0) {
    ok = static_cast<double>(runtime_us) >= kLeastRealtimeShare * static_cast<double>(*period_us);
    value = std::to_string(runtime_us) + " of each " + std::to_string(*period_us) + " us";
  }
  return MachineCheck("rt-throttling", ok, value,
                      "real-time threads may use 95 % of a processor, or all of it (-1)",
                      "sysctl kernel.sched_rt_runtime_us=950000 kernel.sched_rt_period_us=1000000, "
                      "in /etc/sysctl.d/ to keep it");
}

// The state that a processor of this process leaves last; nothing if it has none.
struct SlowestIdle {
  bool known = true;
  std::optional<std::int64_t> exit_us;
  std::string name;
};

SlowestIdle SlowestOf(const HostFacts& facts) {
  SlowestIdle slowest;
  for (const CpuFacts& cpu : *facts.cpu) {
    for (const IdleState& state : cpu.may_idle) {
      if (!state.exit_latency_us) {
        slowest.known = false;
      } else if (facts.wake_up_limit_us && *state.exit_latency_us > *facts.wake_up_limit_us) {
        continue;  // not chosen while that process holds the limit
      } else if (!slowest.exit_us || *state.exit_latency_us > *slowest.exit_us) {
        slowest.exit_us = state.exit_latency_us;
        slowest.name = state.name + " of cpu" + std::to_string(cpu.number);
      }
    }
  }
  return slowest;
}

HostCheck IdleExit(const HostFacts& facts) {
  std::string value = kUnknownValue;
  bool ok = false;
  if (facts.cpu) {
    const SlowestIdle slowest = SlowestOf(facts);
    ok = slowest.known && slowest.exit_us.value_or(0) <= kIdleExitLimit_us;
    if (slowest.known && slowest.exit_us) {
      value = std::to_string(*slowest.exit_us) + " us, " + slowest.name;
    } else if (slowest.known) {
      value = "none: the kernel manages no idle states here";
    }
  }
  return MachineCheck("idle-states", ok, value,
                      "at most " + std::to_string(kIdleExitLimit_us) + " us to leave an idle state",
                      "cpupower idle-set --disable-by-latency " +
                          std::to_string(kIdleExitLimit_us) +
                          " at every start, or hold a limit on /dev/cpu_dma_latency");
}

HostCheck Governor(const HostFacts& facts) {
  std::string value = kUnknownValue;
  bool ok = facts.cpu.has_value();
  if (ok) {
    value = "performance";
    bool scales = false;
    for (const CpuFacts& cpu : *facts.cpu) {
      if (cpu.governor.absent()) continue;
      scales = true;
      if (cpu.governor.read() && cpu.governor.text == "performance") continue;
      ok = false;
      value = (cpu.governor.read() ? cpu.governor.text : kUnknownValue) + std::string(" on cpu") +
              std::to_string(cpu.number);
    }
    if (!scales) value = "none: the kernel does not change the frequency here";
  }
  return MachineCheck("frequency-governor", ok, value,
                      "performance on every processor that this process may use",
                      "cpupower frequency-set -g performance, at every start");
}

HostCheck Isolation(const HostFacts& facts) {
  const auto isolated = NumbersOfList(facts.isolated_cpus.text);
  std::string value = kUnknownValue;
  bool ok = facts.cpu.has_value() && !facts.cpu->empty() && facts.isolated_cpus.read() && isolated;
  if (ok) {
    for (const CpuFacts& cpu : *facts.cpu) {
      ok = ok && std::find(isolated->begin(), isolated->end(), cpu.number) != isolated->end();
    }
    value = "isolated: " + (facts.isolated_cpus.text.empty() ? "none" : facts.isolated_cpus.text);
  }
  HostCheck check = MachineCheck(
      "cpu-isolation", ok, value, "advice: every processor that this process may use is isolated",
      "isolcpus=N nohz_full=N on the kernel's command line and CPUAffinity=N "
      "in a drop-in of the unit; needs two processors or more");
  check.advice = true;
  return check;
}

HostCheck ClockSource(const HostFacts& facts) {
  const HostText& source = facts.clock_source;
  return MachineCheck(
      "clock-source", source.read() && (source.text == "tsc" || source.text == "arch_sys_counter"),
      source.read() ? source.text : kUnknownValue,
      "tsc or arch_sys_counter: the processor's own counter",
      "see dmesg for why the kernel gave tsc up; not a virtual machine; firmware update, "
      "or tsc=reliable on the kernel's command line if you have checked the clock");
}

}  // namespace

std::vector<HostCheck> MachineChecks(const HostFacts& facts) {
  return {Kernel(facts),       FifoPermission(facts), MemoryLock(facts),
          CpuTimeLimit(facts), Throttling(facts),     IdleExit(facts),
          Governor(facts),     ClockSource(facts),    Isolation(facts)};
}

std::vector<HostCheck> HostChecks(const HostFacts& facts) {
  std::vector<HostCheck> all = MachineChecks(facts);
  for (HostCheck& check : BusChecks(facts)) all.push_back(std::move(check));
  return all;
}

bool HostReady(const std::vector<HostCheck>& checks) {
  return std::all_of(checks.begin(), checks.end(),
                     [](const HostCheck& check) { return check.ok || check.advice; });
}

}  // namespace flexarm
