#include "hal/canopen/canopen_device.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "hal/time_units.h"

namespace flexarm {
namespace {

// A single lost frame can occur on any bus; three in a row at 50 Hz are 60 ms without a drive.
constexpr int kMissedIsSilent = 3;
constexpr int kStuckIsFault = 3;
// A drive charges its intermediate circuit or releases a brake: a second at 50 Hz.
constexpr int kFramesToEnable = 50;
constexpr int kFramesToDisable = 5;
constexpr int kResetsBeforeSetup = 6;
// More than a full socket holds: bounds the time of a call under a flood of frames.
constexpr int kMostFrames = 1024;

}  // namespace

CanopenDevice::CanopenDevice(CanopenConfig config, std::unique_ptr<CanBus> bus)
    : config_(std::move(config)), bus_(std::move(bus)), setup_(config_, bus_.get()) {
  for (const CanopenNodeConfig& node : config_.node) {
    if (node_count_ < nodes_.size()) nodes_[node_count_++].config = &node;
    if (IsDrive(node.role)) drives_ |= 1U << static_cast<unsigned>(node.role);
  }
}

void CanopenDevice::Open() {
  std::vector<std::uint32_t> ids = {kCobSync};
  for (const CanopenNodeConfig& node : config_.node) {
    for (const std::uint32_t function : {kCobEmergency, kCobTpdo, kCobSdoReply, kCobHeartbeat}) {
      ids.push_back(CobId(function, node.node_id));
    }
  }
  bus_->Open(ids, config_.bitrate_bps);
  setup_.Begin();
  NodeSetup::Progress progress = NodeSetup::Progress::kBusy;
  while (progress == NodeSetup::Progress::kBusy) {
    progress = setup_.Advance(bus_->now_ns() + 100 * kMillisecondNs);
  }
  if (progress == NodeSetup::Progress::kFailed) {
    bus_->Close();
    throw HalError(setup_.FailureText());
  }
  counts_ = {};
  open_ = true;
  configuring_ = false;
  BeginOperation();
}

void CanopenDevice::BeginOperation() noexcept {
  fault_ = {};
  resets_ = stuck_ = 0;
  first_ = true;
  for (Node& node : nodes()) {
    const CanopenNodeConfig* const config = node.config;
    node = Node{.config = config};
  }
}

BusStatus CanopenDevice::Exchange(const BusCommand& command, SensorFrame* part) noexcept {
  *part = SensorFrame{};
  const bool on = command.enabled && !configuring_;
  const BusStatus status = Cycle(on ? DriveWish::kOn : DriveWish::kOff, command);
  if (fault_.kind != CanopenFaultKind::kNone) return FaultStatus();
  if (status != BusStatus::kOk) return status;
  part->sampled_at_ns = sampled_ns_;
  for (const Node& node : nodes()) {
    const int counter = node.config->counter();
    if (counter < 0) continue;
    part->counter[static_cast<std::size_t>(counter)] = node.counts;
    part->counter_valid |= 1U << static_cast<unsigned>(counter);
  }
  return BusStatus::kOk;
}

BusStatus CanopenDevice::Cycle(DriveWish wish, const BusCommand& command) noexcept {
  const std::int64_t until_ns = bus_->now_ns() + answer_ns();
  malformed_ = nullptr;
  Drain(until_ns);
  if (BusIsGone()) return FaultStatus();
  CheckHeartbeats();
  first_ = false;
  // Includes faults that latched just now, while draining.
  if (fault_.kind != CanopenFaultKind::kNone && wish == DriveWish::kOn) wish = DriveWish::kOff;
  if (bus_->unsent() || !Send(wish, command)) return Stuck();
  Collect(until_ns);
  if (BusIsGone()) return FaultStatus();
  if (sampled_ns_ == 0) return Stuck();
  stuck_ = 0;
  for (Node& node : nodes()) {
    if (node.answered && IsDrive(node.config->role)) FollowDrive(wish, &node);
  }
  const BusStatus missing = CountMissing();
  return malformed_ != nullptr ? BusStatus::kMalformed : missing;
}

void CanopenDevice::Drain(std::int64_t until_ns) noexcept {
  collecting_ = false;
  ReceivedFrame received{};
  for (int i = 0; i < kMostFrames && bus_->Receive(&received); ++i) {
    Handle(received);
    if (bus_->now_ns() >= until_ns) return;
  }
}

CanFrame CanopenDevice::CommandFor(const Node& node, DriveWish wish,
                                   const BusCommand& command) const noexcept {
  DriveCommand drive{.controlword = ControlwordFor(node.state, wish), .torque_per_mille = 0};
  const std::size_t joint = node.config->role == CanopenRole::kDrive1 ? 0 : 1;
  const double torque_nm = command.torque_nm[joint];
  const bool expired = bus_->now_ns() > command.expires_ns;
  if (wish == DriveWish::kOn && node.state == DriveState::kOperationEnabled && !expired &&
      std::isfinite(torque_nm)) {
    const double most = node.config->torque_range_per_mille();
    const double asked = node.config->sign * torque_nm / node.config->torque_per_mille_nm;
    drive.torque_per_mille = static_cast<std::int16_t>(std::lround(std::clamp(asked, -most, most)));
  }
  return EncodeDriveCommand(node.config->node_id, drive);
}

bool CanopenDevice::Send(DriveWish wish, const BusCommand& command) noexcept {
  for (Node& node : nodes()) {
    node.answered = false;
    if (!IsDrive(node.config->role)) continue;
    if (bus_->Send(CommandFor(node, wish, command)) != SendResult::kSent) return false;
  }
  sync_sent_ns_ = bus_->now_ns();
  sampled_ns_ = 0;
  collecting_ = true;
  return bus_->Send(EncodeSync()) == SendResult::kSent &&
         bus_->Send(EncodeHeartbeat(config_.master_node_id, NmtState::kOperational)) ==
             SendResult::kSent;
}

void CanopenDevice::Collect(std::int64_t until_ns) noexcept {
  // A node that has missed a SYNC may answer twice: wait the whole time for the second answer.
  const auto complete = [this] {
    return sampled_ns_ != 0 && std::all_of(nodes().begin(), nodes().end(), [](const Node& node) {
             return node.answered && node.missed == 0;
           });
  };
  ReceivedFrame received{};
  for (int i = 0; i < kMostFrames && !complete(); ++i) {
    if (bus_->now_ns() >= until_ns) break;
    if (bus_->Receive(&received)) {
      Handle(received);
    } else {
      bus_->WaitUntil(until_ns);
    }
  }
  collecting_ = false;
}

BusStatus CanopenDevice::Stuck() noexcept {
  if (++stuck_ >= kStuckIsFault) Latch(CanopenFaultKind::kTransmitStuck, nullptr, 0);
  return BusStatus::kTimeout;
}

bool CanopenDevice::BusIsGone() noexcept {
  const CanState state = bus_->state();
  if (state == CanState::kBusOff) Latch(CanopenFaultKind::kBusOff, nullptr, 0);
  if (state == CanState::kDown) Latch(CanopenFaultKind::kInterfaceDown, nullptr, 0);
  return state == CanState::kBusOff || state == CanState::kDown;
}

BusStatus CanopenDevice::CountMissing() noexcept {
  BusStatus status = BusStatus::kOk;
  for (Node& node : nodes()) {
    if (node.answered) {
      node.missed = 0;
      continue;
    }
    status = BusStatus::kTimeout;
    ++counts_.missed;
    if (++node.missed >= kMissedIsSilent) Latch(CanopenFaultKind::kSilent, &node, 0);
  }
  return status;
}

void CanopenDevice::CheckHeartbeats() noexcept {
  // Between Open and the first exchange seconds may pass, more heartbeats than a socket holds.
  if (first_) {
    for (Node& node : nodes()) node.heartbeat_ns = bus_->now_ns();
  }
  const std::int64_t oldest_ns = bus_->now_ns() - config_.node_timeout_ms * kMillisecondNs;
  for (const Node& node : nodes()) {
    if (node.heartbeat_ns < oldest_ns) Latch(CanopenFaultKind::kHeartbeatLost, &node, 0);
  }
}

void CanopenDevice::FollowDrive(DriveWish wish, Node* node) noexcept {
  using enum DriveState;
  node->state = DecodeDriveState(node->statusword);
  const bool operating = node->state == kOperationEnabled;
  if ((node->state == kFault || node->state == kFaultReactionActive) &&
      wish != DriveWish::kResetFault) {
    return Latch(CanopenFaultKind::kDriveFault, node, node->statusword);
  }
  const bool follows = (wish == DriveWish::kOn) == operating;
  node->waiting = follows ? 0 : node->waiting + 1;
  if (wish == DriveWish::kOn) {
    if (node->was_enabled && !operating) {
      Latch(CanopenFaultKind::kLeftOperation, node, node->statusword);
    } else if (node->waiting > kFramesToEnable) {
      Latch(CanopenFaultKind::kNotEnabled, node, node->statusword);
    }
    node->was_enabled = node->was_enabled || operating;
  } else {
    node->was_enabled = false;
    if (node->waiting > kFramesToDisable) {
      Latch(CanopenFaultKind::kNotDisabled, node, node->statusword);
    }
  }
}

BusStatus CanopenDevice::SwitchOff() noexcept {
  if (!open_ || configuring_) return BusStatus::kOk;  // the drives are off
  // Also while frames of the last exchange wait: these come after them, and carry no torque.
  return SendOff() ? BusStatus::kOk : Stuck();
}

bool CanopenDevice::SendOff() noexcept {
  const BusCommand off{.torque_nm = {}, .enabled = false};
  bool sent = true;
  for (const Node& node : nodes()) {
    if (!IsDrive(node.config->role)) continue;
    sent = bus_->Send(CommandFor(node, DriveWish::kOff, off)) == SendResult::kSent && sent;
  }
  return bus_->Send(EncodeSync()) == SendResult::kSent && sent;
}

BusStatus CanopenDevice::Reconnect() noexcept {
  const bool anew = NeedsConfiguration(fault_.kind) || resets_ >= kResetsBeforeSetup;
  return configuring_ || anew ? ConfigureAnew() : ResetFaults();
}

BusStatus CanopenDevice::ConfigureAnew() noexcept {
  if (!configuring_) {
    const CanState state = bus_->state();
    const bool well = state == CanState::kActive || state == CanState::kPassive;
    // The restart may take the time of a whole call: the next call configures the nodes.
    if ((!well || bus_->unsent()) && !bus_->Restart()) return FaultStatus();
    setup_.Begin();
    configuring_ = true;
    return BusStatus::kTimeout;
  }
  switch (setup_.Advance(bus_->now_ns() + answer_ns())) {
    case NodeSetup::Progress::kBusy:
      return BusStatus::kTimeout;
    case NodeSetup::Progress::kFailed:
      configuring_ = false;
      fault_ = {setup_.without_answer() ? CanopenFaultKind::kSetupSilent
                                        : CanopenFaultKind::kSetupRefused,
                setup_.failed_node_id(), setup_.failed_index()};
      return FaultStatus();
    case NodeSetup::Progress::kDone:
      break;
  }
  configuring_ = false;
  BeginOperation();
  return BusStatus::kOk;
}

BusStatus CanopenDevice::ResetFaults() noexcept {
  fault_ = {};
  const bool even = resets_++ % 2 == 0;  // the reset acts on its rising edge: off in between
  const BusStatus status =
      Cycle(even ? DriveWish::kResetFault : DriveWish::kOff, {.torque_nm = {}, .enabled = false});
  if (fault_.kind != CanopenFaultKind::kNone) return FaultStatus();
  if (status != BusStatus::kOk) return status;
  for (const Node& node : nodes()) {
    if (!IsDrive(node.config->role)) continue;
    if (node.state == DriveState::kFault || node.state == DriveState::kFaultReactionActive) {
      Latch(CanopenFaultKind::kDriveFault, &node, node.statusword);
      return FaultStatus();
    }
  }
  resets_ = 0;
  return BusStatus::kOk;
}

// Faults that have not latched yet are of one exchange: a node did not answer, or sent a bad reply.
BusFault CanopenDevice::FaultOf(BusStatus /*status*/) const noexcept {
  using enum CanopenFaultKind;
  if (fault_.kind != kNone) return Packed(fault_);
  if (malformed_ != nullptr) {
    return Packed({.kind = kMalformed, .node_id = malformed_->config->node_id, .code = 0});
  }
  if (stuck_ > 0) return Packed({.kind = kTransmitStuck, .node_id = 0, .code = 0});
  for (const Node& node : nodes_) {
    if (node.config == nullptr || node.missed == 0) continue;
    return Packed({.kind = kSilent, .node_id = node.config->node_id, .code = 0});
  }
  return {};
}

std::string CanopenDevice::FaultText(const BusFault& fault) const {
  return CanopenFaultText(config_, Unpacked(fault));
}

void CanopenDevice::Close() noexcept {
  if (!open_) return;
  open_ = false;
  static_cast<void>(SendOff());
  // Without the cyclic traffic a drive must not be in the operational state. Only the drives: a
  // socket holds about six frames.
  for (const Node& node : nodes()) {
    if (!IsDrive(node.config->role)) continue;
    static_cast<void>(bus_->Send(EncodeNmt(NmtCommand::kPreOperational, node.config->node_id)));
  }
  bus_->Close();
}

CanopenDevice::Node* CanopenDevice::Find(int node_id) noexcept {
  for (Node& node : nodes()) {
    if (node.config->node_id == node_id) return &node;
  }
  return nullptr;
}

const CanopenDevice::Node* CanopenDevice::Drive(int joint) const noexcept {
  const CanopenRole role = joint == 0 ? CanopenRole::kDrive1 : CanopenRole::kDrive2;
  for (const Node& node : nodes_) {
    if (node.config != nullptr && node.config->role == role) return &node;
  }
  return nullptr;
}

std::uint32_t CanopenDevice::drives_on() const noexcept {
  std::uint32_t on = 0;
  for (int joint = 0; joint < 2; ++joint) {
    if (drive_state(joint) == DriveState::kOperationEnabled) on |= 1U << joint;
  }
  return on;
}

DriveState CanopenDevice::drive_state(int joint) const noexcept {
  const Node* drive = Drive(joint);
  return drive == nullptr ? DriveState::kUnknown : drive->state;
}

double CanopenDevice::drive_torque_nm(int joint) const noexcept {
  const Node* drive = Drive(joint);
  if (drive == nullptr) return 0.0;
  return drive->config->sign * drive->config->torque_per_mille_nm * drive->torque_per_mille;
}

std::int64_t CanopenDevice::answer_ns() const noexcept {
  return std::llround(config_.answer_timeout_ms * 1e6);
}

void CanopenDevice::Latch(CanopenFaultKind kind, const Node* node, unsigned code) noexcept {
  if (fault_.kind != CanopenFaultKind::kNone) return;  // the first is the cause
  fault_ = {kind, node == nullptr ? 0 : node->config->node_id, static_cast<std::uint16_t>(code)};
}

}  // namespace flexarm
