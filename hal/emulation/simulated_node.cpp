#include "hal/emulation/simulated_node.h"

#include <algorithm>
#include <cmath>

#include "hal/time_units.h"

namespace flexarm {
namespace {

constexpr std::uint16_t kHeartbeatError = 0x8130;  // emergency code of CiA 301

constexpr bool IsMapping(std::uint16_t index) {
  return (index & 0xFF00U) == 0x1600U || (index & 0xFF00U) == 0x1A00U;
}

}  // namespace

SimulatedNodeConfig SimulatedNodeOf(const CanopenNodeConfig& config) {
  const bool drive = IsDrive(config.role);
  return {.drive = drive,
          .node_id = config.node_id,
          .vendor = config.vendor,
          .product = config.product,
          .serial = config.serial,
          .rated_torque_mnm =
              drive ? static_cast<std::uint32_t>(std::lround(config.rated_motor_torque_mnm())) : 0};
}

SimulatedNode::SimulatedNode(CanBus* bus, const SimulatedNodeConfig& config)
    : bus_(bus), config_(config) {
  if (config.supply) supply_.emplace(*config.supply);
  FillDictionary();
}

void SimulatedNode::Start() {
  std::array<std::uint32_t, 4 + kMaxNodeId> ids{};
  std::size_t count = 0;
  for (const std::uint32_t id : {kCobNmt, kCobSync, CobId(kCobRpdo, config_.node_id),
                                 CobId(kCobSdoRequest, config_.node_id)}) {
    ids[count++] = id;
  }
  for (int node = 1; node <= kMaxNodeId; ++node) {
    if (node != config_.node_id) ids[count++] = CobId(kCobHeartbeat, node);
  }
  bus_->Open(std::span(ids).first(count), 0);
  Boot();
}

void SimulatedNode::Add(CanopenObject object, int size, bool writable,
                        std::uint32_t value) noexcept {
  if (entries_ < dictionary_.size()) dictionary_[entries_++] = {object, size, writable, value};
}

void SimulatedNode::AddPdo(std::uint16_t communication, std::uint32_t cob_id, std::uint16_t mapping,
                           int entries) noexcept {
  Add({communication, 1}, 4, true, CobId(cob_id, config_.node_id));
  Add({communication, 2}, 1, true, 0xFF);
  for (int sub = 0; sub <= entries; ++sub) {
    Add({mapping, static_cast<std::uint8_t>(sub)}, sub == 0 ? 1 : 4, true, 0);
  }
}

void SimulatedNode::FillDictionary() noexcept {
  entries_ = 0;
  Add(kObjectDeviceType, 4, false, config_.drive ? 0x0002'0192U : 0x0001'0196U);
  Add(kObjectConsumerHeartbeat, 4, true, 0);
  Add(kObjectProducerHeartbeat, 2, true, 0);
  Add(kObjectVendor, 4, false, config_.vendor);
  Add(kObjectProduct, 4, false, config_.product);
  Add(kObjectSerial, 4, false, config_.serial);
  AddPdo(kObjectTpdoCommunication, kCobTpdo, kObjectTpdoMapping, 4);
  if (!config_.drive) {
    Add(kObjectEncoderPosition, 4, false, 0);
    return;
  }
  AddPdo(kObjectRpdoCommunication, kCobRpdo, kObjectRpdoMapping, 4);
  // By default many drives send a second PDO on every event.
  AddPdo(kObjectTpdoCommunication + 1, 0x280, kObjectTpdoMapping + 1, 2);
  Add(kObjectAbortConnection, 2, true, 0);
  Add(kObjectControlword, 2, true, 0);
  Add(kObjectStatusword, 2, false, 0);
  Add(kObjectMode, 1, true, 0);
  Add(kObjectModeDisplay, 1, false, 0);
  Add(kObjectPosition, 4, false, 0);
  Add(kObjectTargetTorque, 2, true, 0);
  Add(kObjectMaxTorque, 2, true, 1000);
  Add(kObjectRatedTorque, 4, false, config_.rated_torque_mnm);
  Add(kObjectActualTorque, 2, false, 0);
  Add(kObjectPeriodMantissa, 1, true, 1);
  Add(kObjectPeriodExponent, 1, true, 0xFD);
  Add(kObjectSupportedModes, 4, false, kCyclicTorqueSupported | 1U);
}

SimulatedNode::Entry* SimulatedNode::Find(CanopenObject object) noexcept {
  for (std::size_t i = 0; i < entries_; ++i) {
    if (dictionary_[i].object == object) return &dictionary_[i];
  }
  return nullptr;
}

std::uint32_t SimulatedNode::Value(CanopenObject object) const noexcept {
  for (std::size_t i = 0; i < entries_; ++i) {
    if (dictionary_[i].object == object) return dictionary_[i].value;
  }
  return 0;
}

void SimulatedNode::Set(CanopenObject object, std::uint32_t value) noexcept {
  if (Entry* entry = Find(object)) entry->value = value;
}

void SimulatedNode::SetPosition(std::uint32_t counts) noexcept {
  turned_to_ = counts;
  Set(config_.drive ? kObjectPosition : kObjectEncoderPosition, turned_to_ - counts_from_);
}

void SimulatedNode::LoseCount() noexcept {
  counts_from_ = turned_to_;
  SetPosition(turned_to_);
}

void SimulatedNode::PowerCycle() noexcept {
  LoseCount();
  Boot();
}

void SimulatedNode::Transmit(const CanFrame& frame) noexcept {
  if (!wrong_.silent) static_cast<void>(bus_->Send(frame));
}

void SimulatedNode::Boot() noexcept {
  FillDictionary();
  SetPosition(turned_to_);
  state_ = DriveState::kSwitchOnDisabled;
  RemoveTorque(state_);
  last_control_ = 0;
  master_heard_ns_.reset();
  nmt_ = NmtState::kPreOperational;
  Transmit(EncodeHeartbeat(config_.node_id, NmtState::kBooting));
  supply_fault_ = false;
  if (supply_) supply_->Boot();
}

void SimulatedNode::Run() noexcept {
  ReceivedFrame received{};
  while (bus_->Receive(&received)) {
    if (!wrong_.silent) Handle(received.frame);
  }
  if (!wrong_.silent) FollowSupply();
  const std::int64_t now = bus_->now_ns();
  const std::int64_t producer_ns = kMillisecondNs * std::int64_t{Value(kObjectProducerHeartbeat)};
  if (producer_ns > 0 && now >= next_heartbeat_ns_) {
    if (!wrong_.no_heartbeat) Transmit(EncodeHeartbeat(config_.node_id, nmt_));
    next_heartbeat_ns_ = now + producer_ns;
  }
  const std::int64_t consumer_ns =
      kMillisecondNs * std::int64_t{Value(kObjectConsumerHeartbeat) & 0xFFFFU};
  if (consumer_ns > 0 && master_heard_ns_ && now - *master_heard_ns_ >= consumer_ns &&
      !wrong_.keeps_torque) {
    LoseMaster();
  }
}

void SimulatedNode::Handle(const CanFrame& frame) noexcept {
  if (frame.id == kCobNmt) {
    if (const auto order = DecodeNmt(frame)) HandleNmt(*order);
  } else if (frame.id == kCobSync) {
    HandleSync();
  } else if (frame.id == CobId(kCobSdoRequest, config_.node_id)) {
    if (nmt_ != NmtState::kStopped) HandleSdo(frame);
  } else if (frame.id == CobId(kCobHeartbeat,
                               static_cast<int>(Value(kObjectConsumerHeartbeat) >> 16U & 0x7FU))) {
    master_heard_ns_ = bus_->now_ns();
  } else if (frame.id == Value({kObjectRpdoCommunication, 1})) {
    if (nmt_ == NmtState::kOperational) command_ = frame;
  }
}

void SimulatedNode::HandleNmt(const NmtOrder& order) noexcept {
  if (order.node_id != 0 && order.node_id != config_.node_id) return;
  switch (order.command) {
    case NmtCommand::kStart:
      nmt_ = NmtState::kOperational;
      return;
    case NmtCommand::kStop:
    case NmtCommand::kPreOperational:
      nmt_ = order.command == NmtCommand::kStop ? NmtState::kStopped : NmtState::kPreOperational;
      RemoveTorque(DriveState::kSwitchOnDisabled);
      return;
    case NmtCommand::kResetNode:
      PowerCycle();
      return;
    case NmtCommand::kResetCommunication:
      Boot();
      return;
  }
}

void SimulatedNode::HandleSdo(const CanFrame& frame) noexcept {
  const SdoRequest request = DecodeSdoRequest(frame);
  const Entry* entry = Find(request.object);
  std::uint32_t abort = 0;
  if (request.kind == SdoRequest::Kind::kMalformed) {
    abort = kSdoAbortBadCommand;
  } else if (entry == nullptr ||
             (wrong_.has_no_abort_option && request.object == kObjectAbortConnection)) {
    abort = kSdoAbortNoObject;
  } else if (request.kind == SdoRequest::Kind::kRead) {
    const bool lies = wrong_.another_product && request.object == kObjectProduct;
    Transmit(SdoValueReply(config_.node_id, request.object, entry->value + (lies ? 1U : 0U),
                           entry->size));
    return;
  } else {
    abort = Write(request.object, request.value, request.size);
  }
  Transmit(abort != 0 ? SdoAbortReply(config_.node_id, request.object, abort)
                      : SdoWrittenReply(config_.node_id, request.object));
}

std::uint32_t SimulatedNode::Write(CanopenObject object, std::uint32_t value, int size) noexcept {
  Entry* entry = Find(object);
  if (object.index == wrong_.refuses_index) return kSdoAbortValueRange;
  if (!entry->writable) return kSdoAbortReadOnly;
  if (size != entry->size) return kSdoAbortWrongLength;
  if (object.index == wrong_.forgets_index) return 0;
  if (IsMapping(object.index)) {
    const auto communication = static_cast<std::uint16_t>(object.index - 0x200U);
    const bool pdo_off = (Value({communication, 1}) & kPdoDisabled) != 0;
    if (!pdo_off) return kSdoAbortDeviceState;
    if (object.sub == 0) {
      if (const std::uint32_t abort = CheckMapping(object.index, value)) return abort;
    } else if (Value({object.index, 0}) != 0) {
      return kSdoAbortDeviceState;
    }
  }
  entry->value = value;
  if (object == kObjectMode) Set(kObjectModeDisplay, value);
  if (object == kObjectProducerHeartbeat) next_heartbeat_ns_ = bus_->now_ns();
  return 0;
}

std::uint32_t SimulatedNode::CheckMapping(std::uint16_t index, std::uint32_t count) const noexcept {
  std::uint32_t bits = 0;
  for (std::uint32_t sub = 1; sub <= count; ++sub) {
    const std::uint32_t entry = Value({index, static_cast<std::uint8_t>(sub)});
    const CanopenObject mapped{static_cast<std::uint16_t>(entry >> 16U),
                               static_cast<std::uint8_t>(entry >> 8U)};
    const bool known = std::any_of(
        dictionary_.begin(), dictionary_.begin() + static_cast<std::ptrdiff_t>(entries_),
        [&](const Entry& e) {
          return e.object == mapped && 8U * static_cast<unsigned>(e.size) == (entry & 0xFFU);
        });
    if (!known) return kSdoAbortNotMappable;
    bits += entry & 0xFFU;
  }
  return bits > 64 ? kSdoAbortPdoTooLong : 0;
}

void SimulatedNode::HandleSync() noexcept {
  if (nmt_ != NmtState::kOperational) return;
  if (config_.drive) TakeCommand();
  const bool enabled = (Value({kObjectTpdoCommunication, 1}) & kPdoDisabled) == 0;
  if (enabled && Value({kObjectTpdoCommunication, 2}) == kOnEverySync && !wrong_.answers_no_sync) {
    SendPdo();
  }
}

void SimulatedNode::SendPdo() noexcept {
  const std::uint16_t voltage_bit = Supplied() ? 0 : kStatusVoltageEnabled;
  Set(kObjectStatusword, wrong_.statusword.value_or(EncodeDriveState(state_) & ~voltage_bit));
  Set(kObjectActualTorque, static_cast<std::uint16_t>(torque_per_mille()));
  CanFrame frame{.id = Value({kObjectTpdoCommunication, 1}) & 0x7FFU};
  for (std::uint32_t sub = 1; sub <= Value({kObjectTpdoMapping, 0}); ++sub) {
    const std::uint32_t mapped = Value({kObjectTpdoMapping, static_cast<std::uint8_t>(sub)});
    const std::uint32_t value =
        Value({static_cast<std::uint16_t>(mapped >> 16U), static_cast<std::uint8_t>(mapped >> 8U)});
    for (std::uint32_t bit = 0; bit < (mapped & 0xFFU) && frame.length < 8; bit += 8) {
      frame.data[frame.length++] = static_cast<std::uint8_t>(value >> bit);
    }
  }
  if (wrong_.cuts_pdos && frame.length > 0) frame.data[--frame.length] = 0;
  Transmit(frame);
}

void SimulatedNode::LoseMaster() noexcept {
  master_heard_ns_.reset();
  if (nmt_ != NmtState::kOperational) return;
  Transmit(EncodeEmergency(config_.node_id,
                           {.code = kHeartbeatError, .error_register = 0x11, .vendor_bytes = {}}));
  const std::uint32_t option = Value(kObjectAbortConnection);
  if (config_.drive && option != 0) {
    RemoveTorque(option == 1 ? DriveState::kFault : DriveState::kSwitchOnDisabled);
  }
  nmt_ = NmtState::kPreOperational;  // default of 1029:1; a drive with option 0 keeps its torque
}

void SimulatedNode::RaiseFault(std::uint16_t code) noexcept {
  if (config_.drive) RemoveTorque(DriveState::kFault);
  supply_fault_ = false;
  Transmit(
      EncodeEmergency(config_.node_id, {.code = code, .error_register = 0x01, .vendor_bytes = {}}));
}

}  // namespace flexarm
