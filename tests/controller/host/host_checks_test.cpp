#include "controller/host/host_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <string>
#include <vector>

#include "controller/tasks/bus_task.h"
#include "controller/tasks/safety_task.h"

namespace flexarm {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

HostText Text(const std::string& text) { return {.state = HostText::State::kRead, .text = text}; }
const HostText kAbsent{.state = HostText::State::kAbsent, .text = {}};
const HostText kUnreadable{.state = HostText::State::kUnreadable, .text = {}};

BusFacts Bus(BusFacts::Kind kind, const std::string& name) {
  return {.kind = kind,
          .bus = name,
          .device = name,
          .presence = BusFacts::Presence::kDevice,
          .interrupt = {33},
          .names = {name},
          .link = std::nullopt,
          .latency_timer_ms = kAbsent};
}

BusFacts GoodCan() {
  BusFacts bus = Bus(BusFacts::Kind::kCan, "can0");
  bus.link = CanLink{.up = true,
                     .echo = true,
                     .controller = true,
                     .index = 3,
                     .transmit_queue = 10,
                     .state = CanState::kActive,
                     .bitrate_bps = 1'000'000,
                     .restart_ms = 0};
  return bus;
}

HostFacts GoodHost() {
  return {.realtime = {.fifo_error = 0,
                       .fifo_priority = 90,
                       .rtprio_limit = 95,
                       .memlock_limit_bytes = RealtimeHost::kUnlimited,
                       .rttime_limit_us = RealtimeHost::kUnlimited,
                       .throttle_runtime_us = 950'000,
                       .kernel_version = "#1 SMP PREEMPT_RT Debian 6.1"},
          .may_lock_all = false,
          .throttle_period_us = Text("1000000"),
          .cpu = std::vector<CpuFacts>{{.number = 2,
                                        .governor = Text("performance"),
                                        .may_idle = {{.name = "POLL", .exit_latency_us = 0},
                                                     {.name = "C1E", .exit_latency_us = 50}}}},
          .wake_up_limit_us = std::nullopt,
          .isolated_cpus = Text("2-3"),
          .clock_source = Text("tsc"),
          .interrupt_thread = {{.number = 33, .name = "can0", .priority = 80}},
          .bus = {GoodCan()},
          .time_service = "",
          .chrony_config = kAbsent};
}

HostCheck CheckOf(const HostFacts& facts, const std::string& name) {
  for (const HostCheck& check : HostChecks(facts)) {
    if (check.name == name) return check;
  }
  ADD_FAILURE() << "no check " << name;
  return {};
}

// The check fails, says what it found and how to mend it, and decides the verdict.
void ExpectFailed(const HostFacts& facts, const std::string& name, const std::string& value) {
  const HostCheck check = CheckOf(facts, name);
  EXPECT_FALSE(check.ok) << name;
  EXPECT_THAT(check.value, HasSubstr(value));
  EXPECT_NE(check.required, "");
  EXPECT_NE(check.remedy, "");
  EXPECT_EQ(HostReady(HostChecks(facts)), check.advice) << name;
}

void ExpectOk(const HostFacts& facts, const std::string& name, const std::string& value) {
  const HostCheck check = CheckOf(facts, name);
  EXPECT_TRUE(check.ok) << name << ": " << check.value;
  EXPECT_THAT(check.value, HasSubstr(value));
  EXPECT_EQ(check.remedy, "");
}

TEST(HostChecks, AGoodHostPassesEveryCheck) {
  for (const HostCheck& check : HostChecks(GoodHost())) {
    EXPECT_TRUE(check.ok) << check.name << ": " << check.value;
    EXPECT_EQ(check.remedy, "") << check.name;
  }
  EXPECT_TRUE(HostReady(HostChecks(GoodHost())));
}

TEST(HostChecks, ABusNeedsNothingWithoutARig) {
  HostFacts facts = GoodHost();
  facts.bus.clear();
  for (const HostCheck& check : HostChecks(facts)) {
    EXPECT_EQ(check.name.find(':'), std::string::npos) << check.name;
  }
}

TEST(HostChecks, TheKernelMustBePreemptRt) {
  HostFacts facts = GoodHost();
  facts.realtime.kernel_version = "#1 SMP PREEMPT_DYNAMIC Debian";
  ExpectFailed(facts, "preempt-rt", "PREEMPT_DYNAMIC");
  facts.realtime.kernel_version = "";
  ExpectFailed(facts, "preempt-rt", "unknown");
}

TEST(HostChecks, FifoMustBePermitted) {
  HostFacts facts = GoodHost();
  facts.realtime.fifo_error = EPERM;
  facts.realtime.rtprio_limit = 89;
  ExpectFailed(facts, "fifo-priority", "RLIMIT_RTPRIO is 89");
}

TEST(HostChecks, MemoryMustBeLockableByLimitOrCapability) {
  HostFacts facts = GoodHost();
  facts.realtime.memlock_limit_bytes = 8'388'608;
  ExpectFailed(facts, "memory-lock", "8388608 bytes");
  facts.may_lock_all = std::nullopt;
  ExpectFailed(facts, "memory-lock", "unknown");
  facts.may_lock_all = true;
  ExpectOk(facts, "memory-lock", "CAP_IPC_LOCK");
}

TEST(HostChecks, TheCpuTimeOfARealTimeThreadMustBeUnlimited) {
  HostFacts facts = GoodHost();
  facts.realtime.rttime_limit_us = 200'000;
  ExpectFailed(facts, "cpu-time-limit", "200000 us");
}

TEST(HostChecks, ThrottlingMustLeaveTheKernelsDefaultShare) {
  HostFacts facts = GoodHost();
  facts.realtime.throttle_runtime_us = 949'000;
  ExpectFailed(facts, "rt-throttling", "949000 of each 1000000 us");
  facts.realtime.throttle_runtime_us = INT64_MIN;
  ExpectFailed(facts, "rt-throttling", "unknown");
  facts.realtime.throttle_runtime_us = 950'000;
  facts.throttle_period_us = kUnreadable;
  ExpectFailed(facts, "rt-throttling", "unknown");
  facts.realtime.throttle_runtime_us = -1;
  ExpectOk(facts, "rt-throttling", "off");
}

TEST(HostChecks, NoProcessorMaySleepDeeply) {
  HostFacts facts = GoodHost();
  (*facts.cpu)[0].may_idle.push_back({.name = "C6", .exit_latency_us = 133});
  ExpectFailed(facts, "idle-states", "133 us, C6 of cpu2");
  facts.wake_up_limit_us = 100;  // C6 is not chosen then
  ExpectOk(facts, "idle-states", "50 us, C1E of cpu2");
  (*facts.cpu)[0].may_idle.push_back({.name = "C7", .exit_latency_us = std::nullopt});
  ExpectFailed(facts, "idle-states", "unknown");
  (*facts.cpu)[0].may_idle.clear();
  ExpectOk(facts, "idle-states", "none");
  facts.cpu.reset();
  ExpectFailed(facts, "idle-states", "unknown");
}

TEST(HostChecks, TheFrequencyMustNotChange) {
  HostFacts facts = GoodHost();
  facts.cpu->push_back({.number = 3, .governor = Text("schedutil"), .may_idle = {}});
  ExpectFailed(facts, "frequency-governor", "schedutil on cpu3");
  (*facts.cpu)[1].governor = kUnreadable;
  ExpectFailed(facts, "frequency-governor", "unknown");
  (*facts.cpu)[0].governor = (*facts.cpu)[1].governor = kAbsent;
  ExpectOk(facts, "frequency-governor", "none");
  facts.cpu.reset();
  ExpectFailed(facts, "frequency-governor", "unknown");
}

TEST(HostChecks, AnIsolatedProcessorIsAdvice) {
  HostFacts facts = GoodHost();
  EXPECT_TRUE(CheckOf(facts, "cpu-isolation").advice);
  facts.isolated_cpus = Text("3");
  ExpectFailed(facts, "cpu-isolation", "isolated: 3");
  facts.isolated_cpus = Text("");
  ExpectFailed(facts, "cpu-isolation", "none");
  facts.isolated_cpus = kAbsent;
  ExpectFailed(facts, "cpu-isolation", "unknown");
}

TEST(HostChecks, TheClockMustBeTheProcessorsCounter) {
  HostFacts facts = GoodHost();
  facts.clock_source = Text("arch_sys_counter");
  ExpectOk(facts, "clock-source", "arch_sys_counter");
  for (const char* slow : {"hpet", "acpi_pm"}) {
    facts.clock_source = Text(slow);
    ExpectFailed(facts, "clock-source", slow);
  }
  facts.clock_source = kUnreadable;
  ExpectFailed(facts, "clock-source", "unknown");
}

TEST(BusChecks, ACanInterfaceNeedsAShortQueueAndNoRestartByItself) {
  HostFacts facts = GoodHost();
  facts.bus[0].link->transmit_queue = 17;
  ExpectFailed(facts, "can-queue:can0", "17 frames");
  facts.bus[0].link->transmit_queue = 16;
  ExpectOk(facts, "can-queue:can0", "16 frames");
  facts.bus[0].link->restart_ms = 100;
  ExpectFailed(facts, "can-restart:can0", "100 ms");
  facts.bus[0].link.reset();
  ExpectFailed(facts, "can-queue:can0", "unknown");
  ExpectFailed(facts, "can-restart:can0", "unknown");
}

TEST(BusChecks, ADriverShouldEchoAFrameWhenItWasSent) {
  HostFacts facts = GoodHost();
  ExpectOk(facts, "can-echo:can0", "when the frame was sent");
  facts.bus[0].link->echo = false;
  ExpectFailed(facts, "can-echo:can0", "when the frame is handed over");
  EXPECT_TRUE(CheckOf(facts, "can-echo:can0").advice);
  facts.bus[0].link->controller = false;
  ExpectOk(facts, "can-echo:can0", "virtual");
  facts.bus[0].link.reset();
  EXPECT_FALSE(CheckOf(facts, "can-echo:can0").ok);
  EXPECT_THAT(CheckOf(facts, "can-echo:can0").value, HasSubstr("unknown"));
}

TEST(BusChecks, ASerialAdapterMustNotCollectBytes) {
  HostFacts facts = GoodHost();
  facts.bus = {Bus(BusFacts::Kind::kSerial, "amplifier")};
  ExpectOk(facts, "serial-latency:amplifier", "not an adapter");
  facts.bus[0].latency_timer_ms = Text("16");
  ExpectFailed(facts, "serial-latency:amplifier", "16 ms");
  facts.bus[0].latency_timer_ms = Text("1");
  ExpectOk(facts, "serial-latency:amplifier", "1 ms");
  facts.bus[0].latency_timer_ms = kUnreadable;
  ExpectFailed(facts, "serial-latency:amplifier", "unknown");
  facts.bus[0].presence = BusFacts::Presence::kMissing;
  ExpectFailed(facts, "serial-latency:amplifier", "no such port");
  facts.bus[0].presence = BusFacts::Presence::kVirtual;
  ExpectOk(facts, "serial-latency:amplifier", "pseudo-terminal");
}

TEST(BusChecks, InterruptThreadsStandBetweenBusAndSafety) {
  HostFacts facts = GoodHost();
  for (const int priority : {kLowestInterruptPriority, kHighestInterruptPriority}) {
    facts.interrupt_thread[0].priority = priority;
    ExpectOk(facts, "interrupts:can0", "irq/33-can0 FIFO " + std::to_string(priority));
    EXPECT_GT(priority, BusTask::kPriority);
    EXPECT_LT(priority, SafetyTask::kPriority);
  }
  for (const int priority : {kLowestInterruptPriority - 1, kHighestInterruptPriority + 1}) {
    facts.interrupt_thread[0].priority = priority;
    ExpectFailed(facts, "interrupts:can0", "FIFO " + std::to_string(priority));
  }
  facts.interrupt_thread[0].priority = 0;
  ExpectFailed(facts, "interrupts:can0", "irq/33-can0 ordinary");
}

TEST(BusChecks, AnInterruptWithoutAThreadIsUnknownOnlyWhereThreadsExist) {
  HostFacts facts = GoodHost();
  facts.interrupt_thread.clear();
  ExpectFailed(facts, "interrupts:can0", "unknown");
  facts.realtime.kernel_version = "#1 SMP PREEMPT_DYNAMIC";
  ExpectOk(facts, "interrupts:can0", "before any thread");
  facts.bus[0].presence = BusFacts::Presence::kMissing;
  ExpectFailed(facts, "interrupts:can0", "can0 is missing");
  facts.bus[0].presence = BusFacts::Presence::kVirtual;
  ExpectOk(facts, "interrupts:can0", "virtual");
}

TEST(BusChecks, AServiceThatStepsTheClockIsAdvisedAgainst) {
  HostFacts facts = GoodHost();
  facts.time_service = "systemd-timesyn";
  ExpectFailed(facts, "clock-steps", "systemd-timesyn may step");
  EXPECT_TRUE(CheckOf(facts, "clock-steps").advice);
  facts.time_service = "chronyd";
  ExpectFailed(facts, "clock-steps", "unknown");
  facts.chrony_config = Text("pool 2.debian.pool.ntp.org iburst\nmakestep 1 -1");
  ExpectFailed(facts, "clock-steps", "may step");
  facts.chrony_config = Text("pool 2.debian.pool.ntp.org iburst\nmakestep 1 3");
  ExpectOk(facts, "clock-steps", "slews");
}

}  // namespace
}  // namespace flexarm
