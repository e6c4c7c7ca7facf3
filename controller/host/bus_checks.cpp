#include <algorithm>
#include <sstream>
#include <utility>

#include "controller/host/host_checks.h"
#include "hal/canopen/socketcan_bus.h"

namespace flexarm {
namespace {

HostCheck BusCheck(const std::string& what, const BusFacts& bus, bool ok, std::string value,
                   std::string required, std::string remedy) {
  return {.name = what + ":" + bus.bus,
          .ok = ok,
          .advice = false,
          .value = std::move(value),
          .required = std::move(required),
          .remedy = ok ? "" : std::move(remedy)};
}

HostCheck CanQueue(const BusFacts& bus) {
  const std::string most = std::to_string(SocketCanBus::kMostQueued);
  return BusCheck("can-queue", bus,
                  bus.link && bus.link->transmit_queue <= SocketCanBus::kMostQueued,
                  bus.link ? std::to_string(bus.link->transmit_queue) + " frames" : kUnknownValue,
                  "a transmit queue of at most " + most + " frames",
                  "ip link set " + bus.device +
                      " txqueuelen 10; to keep it, the udev rule of docs/hardware.md");
}

// Without it the frames that the controller holds are not seen: ConfirmedBus.
HostCheck CanEcho(const BusFacts& bus) {
  const bool is_virtual = bus.link && !bus.link->controller;
  std::string value = kUnknownValue;
  if (bus.link)
    value = bus.link->echo ? "when the frame was sent" : "when the frame is handed over";
  if (is_virtual) value = "none needed: " + bus.device + " is virtual";
  HostCheck check = BusCheck(
      "can-echo", bus, is_virtual || (bus.link && bus.link->echo), value,
      "advice: the driver echoes a frame when it was sent: without, frames of two or three "
      "exchanges can wait in the controller of a bus on which no node acknowledges",
      "another adapter, whose interface has the flag ECHO in `ip link show " + bus.device + "`");
  check.advice = true;
  return check;
}

HostCheck CanRestart(const BusFacts& bus) {
  return BusCheck("can-restart", bus, bus.link && bus.link->restart_ms == 0,
                  bus.link ? std::to_string(bus.link->restart_ms) + " ms" : kUnknownValue,
                  "restart-ms 0: only the operator's reset ends bus-off",
                  "ip link set " + bus.device +
                      " type can restart-ms 0 while it is down; RestartSec=0 in its .network file");
}

HostCheck SerialDelay(const BusFacts& bus) {
  const auto timer_ms = bus.latency_timer_ms.number();
  std::string value = kUnknownValue;
  bool ok = false;
  if (bus.presence == BusFacts::Presence::kMissing) {
    value = "unknown: there is no such port";
  } else if (bus.presence == BusFacts::Presence::kVirtual) {
    ok = true;
    value = "none: a pseudo-terminal";
  } else if (bus.latency_timer_ms.absent()) {
    ok = true;  // the daemon sets low latency on any port, and refuses one that does not keep it
    value = "none: not an adapter with a latency timer";
  } else if (timer_ms) {
    ok = *timer_ms <= 1;
    value = std::to_string(*timer_ms) + " ms";
  }
  return BusCheck(
      "serial-latency", bus, ok, value, "a latency timer of at most 1 ms",
      "udev rule ACTION==\"add\", SUBSYSTEM==\"usb-serial\", ATTR{latency_timer}=\"1\"; "
      "check that the adapter is plugged in");
}

std::string Listed(const std::vector<InterruptThread>& threads) {
  std::ostringstream text;
  for (const InterruptThread& thread : threads) {
    text << (text.tellp() > 0 ? ", " : "") << "irq/" << thread.number << '-' << thread.name << ' ';
    if (thread.priority > 0) {
      text << "FIFO " << thread.priority;
    } else {
      text << "ordinary";
    }
  }
  return text.str();
}

HostCheck Interrupts(const BusFacts& bus, const HostFacts& facts) {
  const std::vector<InterruptThread> threads = ThreadsOf(bus, facts.interrupt_thread);
  bool ok = std::all_of(threads.begin(), threads.end(), [](const InterruptThread& thread) {
    return thread.priority >= kLowestInterruptPriority &&
           thread.priority <= kHighestInterruptPriority;
  });
  std::string value = Listed(threads);
  if (bus.presence == BusFacts::Presence::kVirtual) {
    ok = true;
    value = "none: " + bus.device + " is virtual";
  } else if (bus.presence == BusFacts::Presence::kMissing) {
    ok = false;
    value = "unknown: " + (bus.device.empty() ? "no route or port" : bus.device) + " is missing";
  } else if (threads.empty() && !IsPreemptRt(facts.realtime)) {
    value = "none: this kernel serves them before any thread";
  } else if (threads.empty()) {
    ok = false;
    value = "unknown: no thread of " + bus.device + " found; is it in use?";
  }
  return BusCheck("interrupts", bus, ok, value,
                  "interrupt threads FIFO " + std::to_string(kLowestInterruptPriority) + " to " +
                      std::to_string(kHighestInterruptPriority),
                  "chrt -f -p 80 PID of each, at every start: the unit in docs/hardware.md");
}

// A word of chrony.conf's line "makestep THRESHOLD LIMIT": a LIMIT of -1 steps at any time.
bool ChronyStepsAtAnyTime(const std::string& config) {
  std::istringstream lines(config);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key, threshold;
    int limit = 0;
    if (words >> key >> threshold >> limit && key == "makestep" && limit < 0) return true;
  }
  return false;
}

HostCheck ClockSteps(const HostFacts& facts) {
  const bool chrony = facts.time_service == "chronyd";
  bool ok = facts.time_service.empty();
  std::string value = ok ? "no service sets the clock" : facts.time_service + " may step the clock";
  if (chrony && !facts.chrony_config.read()) {
    value = "chronyd, configuration " + std::string(kUnknownValue);
  } else if (chrony && !ChronyStepsAtAnyTime(facts.chrony_config.text)) {
    ok = true;
    value = "chronyd slews after its start";
  }
  return {
      .name = "clock-steps",
      .ok = ok,
      .advice = true,
      .value = value,
      .required =
          "advice: the clock is slewed, not stepped: a step of a few ms can cost each CAN bus an "
          "exchange",
      .remedy = ok ? "" : "apt install chrony, with makestep 1 3 in its configuration, or none"};
}

}  // namespace

std::vector<HostCheck> BusChecks(const HostFacts& facts) {
  std::vector<HostCheck> all;
  bool has_can = false;
  for (const BusFacts& bus : facts.bus) {
    if (bus.kind == BusFacts::Kind::kCan) {
      has_can = true;
      all.push_back(CanQueue(bus));
      all.push_back(CanEcho(bus));
      all.push_back(CanRestart(bus));
    }
    if (bus.kind == BusFacts::Kind::kSerial) all.push_back(SerialDelay(bus));
    all.push_back(Interrupts(bus, facts));
  }
  if (has_can) all.push_back(ClockSteps(facts));
  return all;
}

}  // namespace flexarm
