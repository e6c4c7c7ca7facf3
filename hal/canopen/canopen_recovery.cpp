#include <algorithm>

#include "hal/canopen/canopen_device.h"
#include "hal/time_units.h"

// CanopenDevice: configuration of the nodes after one, or the bus, was lost.

namespace flexarm {
namespace {

// Each attempt resets every node of the bus: a node that keeps failing must not keep the others
// from working.
constexpr std::int64_t kFirstPauseNs = 100 * kMillisecondNs;
constexpr std::int64_t kLongestPauseNs = 2000 * kMillisecondNs;

}  // namespace

BusStatus CanopenDevice::Reconnect() noexcept {
  if (!needs_reconnect()) {
    return fault_.kind == CanopenFaultKind::kNone ? BusStatus::kOk : FaultStatus();
  }
  if (!configuring_) return BeginSetup();
  switch (setup_.Advance(bus_.now_ns() + answer_ns())) {
    case NodeSetup::Progress::kBusy:
      return BusStatus::kTimeout;
    case NodeSetup::Progress::kFailed:
      configuring_ = false;
      next_setup_ns_ = bus_.now_ns() + pause_ns_;
      if (NeedsAcknowledgement(config_, fault_)) kept_ = fault_;
      fault_ = {setup_.without_answer() ? CanopenFaultKind::kSetupSilent
                                        : CanopenFaultKind::kSetupRefused,
                setup_.failed_node_id(), setup_.failed_index()};
      return FaultStatus();
    case NodeSetup::Progress::kDone:
      break;
  }
  EndSetup();
  return fault_.kind == CanopenFaultKind::kNone ? BusStatus::kOk : FaultStatus();
}

BusStatus CanopenDevice::BeginSetup() noexcept {
  const std::int64_t now_ns = bus_.now_ns();
  if (now_ns < next_setup_ns_) return FaultStatus();
  // A bus that went well for the longest pause since the last attempt has not failed again and
  // again.
  const bool at_first = next_setup_ns_ == INT64_MIN || now_ns - next_setup_ns_ > kLongestPauseNs;
  pause_ns_ = at_first ? kFirstPauseNs : std::min(2 * pause_ns_, kLongestPauseNs);
  next_setup_ns_ = now_ns + pause_ns_;
  Drain(now_ns + answer_ns());  // frames that were sent meanwhile have their echoes here
  const CanState state = bus_.state();
  const bool well = state == CanState::kActive || state == CanState::kPassive;
  // The restart may take the time of a whole call: the next call configures the nodes.
  if ((!well || bus_.unsent()) && !bus_.Restart()) return FaultStatus();
  for (const Node& node : nodes()) LoseCount(node);
  setup_.Begin();
  configuring_ = true;
  return BusStatus::kTimeout;
}

// A drive that was reset has no fault any more; that it had one, the operator acknowledges.
void CanopenDevice::EndSetup() noexcept {
  if (NeedsAcknowledgement(config_, fault_)) kept_ = fault_;
  fault_ = kept_;
  kept_ = {};
  configuring_ = lost_ = false;
  BeginOperation();
  for (std::size_t i = 0; i < node_count_; ++i) {
    if (const std::uint16_t code = setup_.emergency(i); code != 0) TakeEmergency(code, &nodes_[i]);
  }
}

void CanopenDevice::BeginOperation() noexcept {
  acknowledged_ = stuck_ = 0;
  first_ = true;
  for (Node& node : nodes()) {
    const CanopenNodeConfig* const config = node.config;
    node = Node{.config = config};
  }
}

void CanopenDevice::LoseCount(const Node& node) noexcept {
  const int counter = node.config->counter();
  if (counter >= 0) ++count_epochs_[static_cast<std::size_t>(counter)];
}

}  // namespace flexarm
