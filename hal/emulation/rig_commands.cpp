#include "hal/emulation/rig_commands.h"

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "hal/emulation/can_bus_off.h"
#include "hal/emulation/wire_fault.h"
#include "hal/line_names.h"

namespace flexarm {

const char* const kRigCommands =
    R"(Commands on stdin, one per line; each replaces the last one of its device, `well` removes it:
  press LINE 0|1             limit-1-low limit-1-high limit-2-low limit-2-high
                             emergency-stop reset-button
  amplifier NAME well        NAME as in [[hal.modbus]]
  amplifier NAME late MS     each reply delayed by MS
  amplifier NAME FAULT       silent byte-by-byte wrong-unit wrong-transaction wrong-length
                             garbage flood reset half-frame away (unplugged), and
                             one-behind wrong-protocol wrong-function long-payload
                             short-payload huge-payload bad-checksum three-bytes
                             half-frame-then-close twice exception close never-reads
  amplifier NAME frozen      repeats its present readings
  amplifier NAME stuck C     channel C alone: a row of [[sensors.strain]], from 0
  amplifier NAME inverted C  the bridge wired with inverted polarity
  amplifier NAME swapped C D the plugs of two channels exchanged
  amplifier NAME scaled C F  F times the gain
  amplifier NAME wrong-word-order
  node ROLE well             ROLE as in [[hal.canopen.node]]: drive1 .. rotor2
  node ROLE silent           does not answer, as without power; `well` ends it
  node ROLE power-cycle      loses its power for a moment: its encoder counts from 0
  node ROLE no-answer        to SYNC; its heartbeat continues
  node ROLE no-heartbeat     its answers continue
  node ROLE short-pdo        PDOs one byte too short
  node ROLE another-product  the device was replaced by another product
  node ROLE emcy CODE        one emergency message; a drive enters its fault state. CODE as 0x2310
  bus-off INTERFACE          reports to every socket that the CAN controllers have left the bus
  report                     present state of the hardware
)";

namespace {

std::optional<std::size_t> Channel(std::istringstream& words, const ChannelFaults& channels) {
  int channel = -1;
  if (!(words >> channel) || channel < 0) return std::nullopt;
  const auto index = static_cast<std::size_t>(channel);
  if (index >= channels.channels()) return std::nullopt;
  return index;
}

std::string NoChannel(const ChannelFaults& channels) {
  return "expected a channel from 0 to " + std::to_string(channels.channels() - 1);
}

// Executes a fault of single channels. Empty: `what` is not one of them.
std::optional<std::string> CommandChannels(const std::string& what, std::istringstream& words,
                                           ChannelFaults* channels) {
  if (what != "stuck" && what != "inverted" && what != "swapped" && what != "scaled") {
    return std::nullopt;
  }
  const std::optional<std::size_t> channel = Channel(words, *channels);
  if (!channel) return NoChannel(*channels);
  if (what == "swapped") {
    const std::optional<std::size_t> other = Channel(words, *channels);
    if (!other) return NoChannel(*channels);
    channels->Swap(*channel, *other);
  } else if (what == "scaled") {
    double factor = 0.0;
    if (!(words >> factor)) return "expected a factor";
    channels->Scale(*channel, factor);
  } else if (what == "stuck") {
    channels->Stick(*channel);
  } else {
    channels->Invert(*channel);
  }
  return "";
}

}  // namespace

std::string CommandAmplifier(std::istringstream& words, SimulatedAmplifier* amplifier) {
  std::string what;
  words >> what;
  if (const auto done = CommandChannels(what, words, &amplifier->channels())) return *done;
  if (what == "late") {
    int late_ms = 0;
    if (!(words >> late_ms) || late_ms < 0) return "expected a delay in ms";
    amplifier->server().Behave(WireFault::kLate, std::chrono::milliseconds(late_ms));
  } else if (what == "well") {
    amplifier->Mend();
  } else if (what == "frozen") {
    amplifier->channels().Freeze();
  } else if (what == "wrong-word-order") {
    if (!amplifier->SwapWords()) return "this amplifier has no 32-bit value";
  } else if (const std::optional<WireFault> fault = WireFaultByName(what)) {
    amplifier->server().Behave(*fault);
  } else {
    return "unknown amplifier fault: '" + what + "'";
  }
  return "";
}

std::string CommandNode(std::istringstream& words, SimulatedNode* node) {
  std::string what, code;
  words >> what >> code;
  if (what == "well") {
    node->Misbehave({});
  } else if (what == "silent") {
    node->Misbehave({.silent = true});
  } else if (what == "no-answer") {
    node->Misbehave({.answers_no_sync = true});
  } else if (what == "no-heartbeat") {
    node->Misbehave({.no_heartbeat = true});
  } else if (what == "short-pdo") {
    node->Misbehave({.cuts_pdos = true});
  } else if (what == "another-product") {
    node->Misbehave({.another_product = true});
  } else if (what == "power-cycle") {
    node->PowerCycle();
  } else if (what == "emcy") {
    char* end = nullptr;
    const unsigned long number = std::strtoul(code.c_str(), &end, 0);
    if (code.empty() || *end != '\0' || number < 1 || number > 0xFFFF) {
      return "expected a code from 0x0001 to 0xFFFF";
    }
    node->RaiseFault(static_cast<std::uint16_t>(number));
  } else {
    return "unknown node fault: '" + what + "'";
  }
  return "";
}

std::string ExecuteRigCommand(const std::string& line, EmulatedRig* rig) {
  std::istringstream words(line);
  std::string command, name;
  if (!(words >> command)) return "";
  words >> name;
  if (command == "press") {
    int level = -1;
    const std::optional<Line> pressed = LineByName(name);
    if (!pressed) return "no such line: '" + name + "'";
    if (!(words >> level) || level < 0 || level > 1) return "expected a level, 0 or 1";
    rig->Press(*pressed, level);
    return "";
  }
  if (command == "amplifier") {
    SimulatedAmplifier* amplifier = rig->FindAmplifier(name);
    return amplifier == nullptr ? "no such amplifier: '" + name + "'"
                                : CommandAmplifier(words, amplifier);
  }
  if (command == "node") {
    SimulatedNode* node = rig->FindNode(name);
    return node == nullptr ? "no such node: '" + name + "'" : CommandNode(words, node);
  }
  if (command == "bus-off") {
    return AnnounceBusOff(name) ? "" : name + ": " + std::strerror(errno);
  }
  return "no such command: '" + command + "'; press, amplifier, node, bus-off or report";
}

}  // namespace flexarm
