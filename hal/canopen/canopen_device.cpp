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
// More than a full socket holds: bounds the time of a call under a flood of frames.
constexpr int kMostFrames = 1024;

}  // namespace

CanopenDevice::CanopenDevice(CanopenConfig config, std::unique_ptr<CanBus> bus)
    : config_(std::move(config)), bus_(std::move(bus)), setup_(config_, &bus_) {
  for (const CanopenNodeConfig& node : config_.node) {
    if (node_count_ < nodes_.size()) nodes_[node_count_++].config = &node;
    if (IsDrive(node.role)) drives_ |= 1U << static_cast<unsigned>(node.role);
  }
}

void CanopenDevice::Open() {
  bus_.Open(Identifiers(), config_.bitrate_bps);
  setup_.Begin();
  NodeSetup::Progress progress = NodeSetup::Progress::kBusy;
  while (progress == NodeSetup::Progress::kBusy) {
    progress = setup_.Advance(bus_.now_ns() + 100 * kMillisecondNs);
  }
  if (progress == NodeSetup::Progress::kFailed) {
    bus_.Close();
    throw HalError(setup_.FailureText());
  }
  counts_ = {};
  open_ = true;
  fault_ = kept_ = {};
  EndSetup();
}

// Of the frames that are received, and of those that are sent, for their echoes.
std::vector<std::uint32_t> CanopenDevice::Identifiers() const {
  std::vector<std::uint32_t> ids = {kCobNmt, kCobSync,
                                    CobId(kCobHeartbeat, config_.master_node_id)};
  for (const CanopenNodeConfig& node : config_.node) {
    for (const std::uint32_t function :
         {kCobEmergency, kCobTpdo, kCobSdoReply, kCobSdoRequest, kCobHeartbeat}) {
      ids.push_back(CobId(function, node.node_id));
    }
    if (IsDrive(node.role)) ids.push_back(CobId(kCobRpdo, node.node_id));
  }
  return ids;
}

BusStatus CanopenDevice::Exchange(const BusCommand& command, SensorFrame* part) noexcept {
  *part = SensorFrame{};
  const bool on = command.enabled && !configuring_;
  const bool acknowledges =
      command.acknowledge && !on && !needs_reconnect() && fault_.kind != CanopenFaultKind::kNone;
  const BusStatus status =
      acknowledges ? Acknowledge() : Cycle(on ? DriveWish::kOn : DriveWish::kOff, command);
  if (status == BusStatus::kOk && !needs_reconnect()) Read(part);
  return fault_.kind != CanopenFaultKind::kNone ? FaultStatus() : status;
}

void CanopenDevice::Read(SensorFrame* part) const noexcept {
  part->sampled_at_ns = sampled_ns_;
  for (const Node& node : std::span(nodes_).first(node_count_)) {
    const int counter = node.config->counter();
    if (counter < 0) continue;
    part->counter[static_cast<std::size_t>(counter)] = node.counts;
    part->counter_valid |= 1U << static_cast<unsigned>(counter);
  }
}

BusStatus CanopenDevice::Cycle(DriveWish wish, const BusCommand& command) noexcept {
  const std::int64_t until_ns = bus_.now_ns() + answer_ns();
  malformed_ = nullptr;
  if (wish != DriveWish::kOn) MarkOff();
  Drain(until_ns);
  if (BusIsGone()) return FaultStatus();
  CheckHeartbeats();
  first_ = false;
  // Includes faults that latched just now, while draining.
  if (fault_.kind != CanopenFaultKind::kNone && wish == DriveWish::kOn) wish = DriveWish::kOff;
  if (bus_.unsent() || !Send(wish, command)) return Stuck();
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
  for (int i = 0; i < kMostFrames && bus_.Receive(&received); ++i) {
    Handle(received);
    if (bus_.now_ns() >= until_ns) return;
  }
}

bool CanopenDevice::Send(DriveWish wish, const BusCommand& command) noexcept {
  for (Node& node : nodes()) {
    node.answered = false;
    if (!IsDrive(node.config->role)) continue;
    if (bus_.Send(CommandFor(node, wish, command)) != SendResult::kSent) return false;
  }
  sync_sent_ns_ = bus_.now_ns();
  sampled_ns_ = 0;
  collecting_ = true;
  return bus_.Send(EncodeSync()) == SendResult::kSent &&
         bus_.Send(EncodeHeartbeat(config_.master_node_id, NmtState::kOperational)) ==
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
    if (bus_.now_ns() >= until_ns) break;
    if (bus_.Receive(&received)) {
      Handle(received);
    } else {
      bus_.WaitUntil(until_ns);
    }
  }
  collecting_ = false;
}

BusStatus CanopenDevice::Stuck() noexcept {
  ++counts_.unsent;
  if (++stuck_ >= kStuckIsFault) Latch(CanopenFaultKind::kTransmitStuck, nullptr, 0);
  return BusStatus::kTimeout;
}

bool CanopenDevice::BusIsGone() noexcept {
  const CanState state = bus_.state();
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
    for (Node& node : nodes()) node.heartbeat_ns = bus_.now_ns();
  }
  const std::int64_t oldest_ns = bus_.now_ns() - config_.node_timeout_ms * kMillisecondNs;
  for (const Node& node : nodes()) {
    if (node.heartbeat_ns < oldest_ns) Latch(CanopenFaultKind::kHeartbeatLost, &node, 0);
  }
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

std::span<const char* const> CanopenDevice::counter_names() const noexcept {
  static constexpr std::array kNames = {"stale_answers",  "duplicated_answers", "malformed_frames",
                                        "missed_answers", "unsent_exchanges",   "refused_sends",
                                        "error_frames"};
  static_assert(kNames.size() <= kMostBusCounters);
  return kNames;
}

BusCounters CanopenDevice::counter_values() const noexcept {
  return {counts_.stale,
          counts_.duplicated,
          counts_.malformed,
          counts_.missed,
          counts_.unsent,
          static_cast<std::uint32_t>(bus_counts().queue_full),
          static_cast<std::uint32_t>(bus_counts().error_frames)};
}

void CanopenDevice::Close() noexcept {
  if (!open_) return;
  open_ = false;
  static_cast<void>(SendOff());
  // Without the cyclic traffic a drive must not be in the operational state. Only the drives: a
  // socket holds about six frames.
  for (const Node& node : nodes()) {
    if (!IsDrive(node.config->role)) continue;
    static_cast<void>(bus_.Send(EncodeNmt(NmtCommand::kPreOperational, node.config->node_id)));
  }
  bus_.Close();
}

CanopenDevice::Node* CanopenDevice::Find(int node_id) noexcept {
  for (Node& node : nodes()) {
    if (node.config->node_id == node_id) return &node;
  }
  return nullptr;
}

std::int64_t CanopenDevice::answer_ns() const noexcept {
  return std::llround(config_.answer_timeout_ms * 1e6);
}

void CanopenDevice::Latch(CanopenFaultKind kind, const Node* node, unsigned code) noexcept {
  const CanopenFault found{kind, node == nullptr ? 0 : node->config->node_id,
                           static_cast<std::uint16_t>(code)};
  if (!NeedsAcknowledgement(config_, found)) lost_ = true;
  if (fault_.kind == CanopenFaultKind::kNone) fault_ = found;  // the first is the cause
}

}  // namespace flexarm
