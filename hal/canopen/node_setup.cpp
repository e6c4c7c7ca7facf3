#include "hal/canopen/node_setup.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "hal/canopen/canopen_codec.h"
#include "hal/canopen/sdo.h"
#include "hal/time_units.h"

namespace flexarm {
namespace {

constexpr std::uint32_t kProfileMask = 0xFFFF;
constexpr std::uint32_t kProfileDrive = 402, kProfileEncoder = 406;
constexpr int kPdosByDefault = 4;  // PDOs of the predefined connection set

using Steps = std::vector<SetupStep>;

SetupStep Expect(const char* what, CanopenObject object, std::uint32_t value) {
  return {.action = SetupAction::kExpect, .what = what, .object = object, .value = value};
}

SetupStep Write(const char* what, CanopenObject object, int size, std::uint32_t value) {
  return {
      .action = SetupAction::kWrite, .what = what, .object = object, .size = size, .value = value};
}

SetupStep Only(SetupAction action, const char* what) { return {.action = action, .what = what}; }

void AddIdentity(const CanopenNodeConfig& node, Steps* steps) {
  steps->push_back(Expect("profile of the device", kObjectDeviceType,
                          IsDrive(node.role) ? kProfileDrive : kProfileEncoder));
  steps->back().mask = kProfileMask;
  steps->push_back(Expect("vendor", kObjectVendor, node.vendor));
  steps->push_back(Expect("product", kObjectProduct, node.product));
  if (node.serial != 0) steps->push_back(Expect("serial number", kObjectSerial, node.serial));
}

// CiA 301 7.5.2.36: a PDO is switched off before its mapping is changed, entry 0 first.
void AddPdo(std::uint16_t communication, std::uint16_t mapping, std::uint32_t cob_id,
            const std::vector<std::uint32_t>& entries, Steps* steps) {
  const auto cob = [&](std::uint32_t value) {
    SetupStep step = Write("identifier of the PDO", {communication, 1}, 4, value);
    step.mask = kPdoIdMask;
    return step;
  };
  steps->push_back(cob(cob_id | kPdoDisabled));
  steps->push_back(Write("PDO on every SYNC", {communication, 2}, 1, kOnEverySync));
  steps->push_back(Write("PDO mapping", {mapping, 0}, 1, 0));
  std::uint8_t sub = 0;
  for (const std::uint32_t entry : entries) {
    steps->push_back(Write("PDO mapping", {mapping, ++sub}, 4, entry));
  }
  steps->push_back(Write("PDO mapping", {mapping, 0}, 1, sub));
  steps->push_back(cob(cob_id));
}

// Unused PDOs must be neither sent nor received.
void AddPdosOff(std::uint16_t communication, std::uint32_t first_cob_id, Steps* steps) {
  for (int pdo = 1; pdo < kPdosByDefault; ++pdo) {
    const auto index = static_cast<std::uint16_t>(communication + pdo);
    steps->push_back(Write("unused PDO off", {index, 1}, 4,
                           kPdoDisabled | (first_cob_id + 0x100U * static_cast<unsigned>(pdo))));
    steps->back().mask = kPdoDisabled;
    steps->back().optional = true;
  }
}

void AddDrive(const CanopenConfig& config, const CanopenNodeConfig& node, Steps* steps) {
  steps->push_back(
      Expect("cyclic synchronous torque mode", kObjectSupportedModes, kCyclicTorqueSupported));
  steps->back().mask = kCyclicTorqueSupported;
  const double rated_mnm = node.rated_motor_torque_mnm();
  steps->push_back(Expect("rated motor torque in mN m", kObjectRatedTorque,
                          static_cast<std::uint32_t>(std::lround(rated_mnm))));
  // 5 %: torque_per_mille_nm includes the gearbox's losses, the drive's figure does not; a wrong
  // gear or a wrong motor differs by far more.
  steps->back().tolerance = static_cast<std::uint32_t>(std::lround(0.05 * rated_mnm)) + 1;
  AddPdo(kObjectRpdoCommunication, kObjectRpdoMapping, CobId(kCobRpdo, node.node_id),
         {MappingEntry(kObjectControlword, 16), MappingEntry(kObjectTargetTorque, 16)}, steps);
  AddPdosOff(kObjectRpdoCommunication, CobId(kCobRpdo, node.node_id), steps);
  AddPdo(kObjectTpdoCommunication, kObjectTpdoMapping, CobId(kCobTpdo, node.node_id),
         {MappingEntry(kObjectStatusword, 16), MappingEntry(kObjectPosition, 32),
          MappingEntry(kObjectActualTorque, 16)},
         steps);
  steps->push_back(Write("mode of operation", kObjectMode, 1, kCyclicTorqueMode));
  steps->push_back(Expect("mode of operation in force", kObjectModeDisplay, kCyclicTorqueMode));
  steps->push_back(Write("largest torque in 0.1 % of rated", kObjectMaxTorque, 2,
                         static_cast<std::uint32_t>(node.torque_range_per_mille())));
  steps->push_back(Write("period of the set-points", kObjectPeriodMantissa, 1,
                         static_cast<std::uint32_t>(std::lround(config.period_ms))));
  steps->back().optional = true;
  steps->push_back(Write("unit of that period, ms", kObjectPeriodExponent, 1, 0xFD));  // 10^-3 s
  steps->back().optional = true;
  steps->push_back(Write("torque off when the connection is lost", kObjectAbortConnection, 2,
                         kDisableVoltageOnAbort));
  steps->push_back(Write("time-out of the daemon's heartbeat", kObjectConsumerHeartbeat, 4,
                         static_cast<std::uint32_t>(config.master_node_id) << 16U |
                             static_cast<std::uint32_t>(config.master_timeout_ms)));
}

std::string Hex(std::uint32_t value, std::size_t digits) {
  std::array<char, 8> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value, 16);
  std::string hex(text.data(), end);
  std::transform(hex.begin(), hex.end(), hex.begin(),
                 [](char c) { return c >= 'a' ? static_cast<char>(c - 'a' + 'A') : c; });
  return hex.size() < digits ? std::string(digits - hex.size(), '0') + hex : hex;
}

std::string Number(std::uint32_t value) {
  return std::to_string(value) + " (0x" + Hex(value, 1) + ")";
}

}  // namespace

std::vector<SetupStep> SetupSteps(const CanopenConfig& config, const CanopenNodeConfig& node) {
  Steps steps;
  const bool drive = IsDrive(node.role);
  steps.push_back(
      Only(drive ? SetupAction::kResetNode : SetupAction::kResetCommunication, "reset"));
  steps.push_back(Only(SetupAction::kAwaitBoot, "boot-up message"));
  AddIdentity(node, &steps);
  if (drive) {
    AddDrive(config, node, &steps);
  } else {
    AddPdo(kObjectTpdoCommunication, kObjectTpdoMapping, CobId(kCobTpdo, node.node_id),
           {MappingEntry(kObjectEncoderPosition, 32)}, &steps);
  }
  AddPdosOff(kObjectTpdoCommunication, CobId(kCobTpdo, node.node_id), &steps);
  steps.push_back(Write("heartbeat of the node", kObjectProducerHeartbeat, 2,
                        static_cast<std::uint32_t>(config.node_heartbeat_ms)));
  steps.push_back(Only(SetupAction::kStart, "start"));
  steps.push_back(Only(SetupAction::kAwaitOperational, "heartbeat in the operational state"));
  return steps;
}

NodeSetup::NodeSetup(const CanopenConfig& config, CanBus* bus) : config_(config), bus_(bus) {
  for (const CanopenNodeConfig& node : config.node) steps_.push_back(SetupSteps(config, node));
}

void NodeSetup::Begin() noexcept {
  node_ = step_ = 0;
  phase_ = Phase::kBegin;
  failure_ = Failure::kNone;
  emergency_ = {};
}

NodeSetup::Progress NodeSetup::Advance(std::int64_t until_ns) noexcept {
  while (node_ < steps_.size()) {
    if (phase_ == Phase::kBegin) BeginStep();
    if (failure_ != Failure::kNone) return Progress::kFailed;
    if (phase_ == Phase::kBegin) continue;
    const std::int64_t now_ns = bus_->now_ns();
    ReceivedFrame received{};
    if (now_ns >= until_ns) return Progress::kBusy;
    if (bus_->Receive(&received)) {
      Handle(received);
    } else if (now_ns >= deadline_ns_) {
      Fail(Failure::kNoAnswer, 0);
    } else {
      bus_->WaitUntil(std::min(until_ns, deadline_ns_));
    }
    if (failure_ != Failure::kNone) return Progress::kFailed;
  }
  return Progress::kDone;
}

void NodeSetup::NextStep() noexcept {
  phase_ = Phase::kBegin;
  if (++step_ < steps_[node_].size()) return;
  step_ = 0;
  ++node_;
}

void NodeSetup::Fail(Failure failure, std::uint32_t found) noexcept {
  failure_ = failure;
  found_ = found;
}

void NodeSetup::BeginStep() noexcept {
  const int node_id = config_.node[node_].node_id;
  const auto order = [&](NmtCommand command) {
    asked_ns_ = bus_->now_ns();
    if (bus_->Send(EncodeNmt(command, node_id)) != SendResult::kSent) {
      return Fail(Failure::kNotSent, 0);
    }
    NextStep();
  };
  switch (step().action) {
    case SetupAction::kResetNode:
      return order(NmtCommand::kResetNode);
    case SetupAction::kResetCommunication:
      return order(NmtCommand::kResetCommunication);
    case SetupAction::kStart:
      return order(NmtCommand::kStart);
    case SetupAction::kExpect:
      return Ask(Phase::kReading);
    case SetupAction::kWrite:
      return Ask(Phase::kWriting);
    case SetupAction::kAwaitBoot:
    case SetupAction::kAwaitOperational:
      break;
  }
  const int patience_ms = step().action == SetupAction::kAwaitBoot
                              ? config_.boot_timeout_ms
                              : config_.node_timeout_ms + config_.sdo_timeout_ms;
  deadline_ns_ = bus_->now_ns() + patience_ms * kMillisecondNs;
  phase_ = Phase::kListening;
}

void NodeSetup::Ask(Phase phase) noexcept {
  const int node_id = config_.node[node_].node_id;
  const CanFrame request = phase == Phase::kWriting
                               ? SdoWriteRequest(node_id, step().object, step().value, step().size)
                               : SdoReadRequest(node_id, step().object);
  asked_ns_ = bus_->now_ns();
  deadline_ns_ = asked_ns_ + config_.sdo_timeout_ms * kMillisecondNs;
  phase_ = phase;
  if (bus_->Send(request) != SendResult::kSent) Fail(Failure::kNotSent, 0);
}

void NodeSetup::Handle(const ReceivedFrame& received) noexcept {
  const int node_id = config_.node[node_].node_id;
  if (received.own) return;
  HandleEmergency(received);
  if (received.at_ns <= asked_ns_) return;  // an answer to an older request
  if (phase_ == Phase::kListening && received.frame.id == CobId(kCobHeartbeat, node_id)) {
    const NmtState wanted =
        step().action == SetupAction::kAwaitBoot ? NmtState::kBooting : NmtState::kOperational;
    if (DecodeHeartbeat(received.frame) == wanted) NextStep();
  } else if (phase_ != Phase::kListening && received.frame.id == CobId(kCobSdoReply, node_id)) {
    HandleReply(received.frame);
  }
}

// The reset ends what a node reported before; a node without supply reports it again.
void NodeSetup::HandleEmergency(const ReceivedFrame& received) noexcept {
  for (std::size_t i = 0; i <= node_; ++i) {
    if (received.frame.id != CobId(kCobEmergency, config_.node[i].node_id)) continue;
    const bool was_reset =
        i < node_ || step().action != SetupAction::kAwaitBoot || received.at_ns > asked_ns_;
    const auto emergency = DecodeEmergency(received.frame);
    if (was_reset && emergency) emergency_[i] = emergency->code;
  }
}

void NodeSetup::HandleReply(const CanFrame& frame) noexcept {
  const SdoReply reply = DecodeSdoReply(frame);
  if (reply.kind != SdoReply::Kind::kMalformed && !(reply.object == step().object)) return;
  const auto awaited =
      phase_ == Phase::kWriting ? SdoReply::Kind::kWritten : SdoReply::Kind::kValue;
  if (reply.kind == SdoReply::Kind::kAborted) {
    const bool missing = reply.value == kSdoAbortNoObject || reply.value == kSdoAbortNoSubIndex;
    return step().optional && missing ? NextStep() : Fail(Failure::kAborted, reply.value);
  }
  if (reply.kind == SdoReply::Kind::kMalformed) return Fail(Failure::kMalformed, 0);
  if (reply.kind != awaited) return;  // a repeated answer to the write
  if (phase_ == Phase::kWriting) return Ask(Phase::kReading);
  const std::uint32_t found = reply.value & step().mask, expected = step().value & step().mask;
  const std::uint32_t difference = found > expected ? found - expected : expected - found;
  difference <= step().tolerance ? NextStep() : Fail(Failure::kDiffers, reply.value);
}

std::string NodeSetup::FailureText() const {
  if (failure_ == Failure::kNone) return "";
  const CanopenNodeConfig& node = config_.node[node_];
  std::string text = std::string(bus_->interface()) + ": node " + std::to_string(node.node_id) +
                     " (" + ToString(node.role) + "): " + step().what;
  const bool transfer =
      step().action == SetupAction::kExpect || step().action == SetupAction::kWrite;
  if (transfer) {
    text += ", object " + Hex(step().object.index, 4) + ":" + Hex(step().object.sub, 2);
  }
  switch (failure_) {
    case Failure::kNone:
      break;
    case Failure::kNotSent:
      text += ": the bus accepts no frames";
      break;
    case Failure::kNoAnswer:
      text += ": no answer";
      break;
    case Failure::kMalformed:
      text += ": malformed answer (CiA 301)";
      break;
    case Failure::kAborted:
      text += ": refused, " + std::string(SdoAbortText(found_)) + " (0x" + Hex(found_, 8) + ")";
      break;
    case Failure::kDiffers:
      text += ": found " + Number(found_ & step().mask);
      break;
  }
  if (transfer) text += ", expected " + Number(step().value & step().mask);
  return text;
}

}  // namespace flexarm
