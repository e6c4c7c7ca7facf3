#include "tools/torture/fault.h"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "hal/sensor_frame.h"

namespace flexarm {
namespace {

struct Row {
  const char* name;
  int count;  ///< 0: one for each gauge
};

constexpr std::array<Row, kFaultPlaces> kPlaces = {{{"gauge", 0},
                                                    {"gauges-of-link", 2},
                                                    {"counter", kCounters},
                                                    {"frame", 1},
                                                    {"torque", 2},
                                                    {"line", kLines},
                                                    {"line-reads", 1},
                                                    {"line-writes", 1},
                                                    {"relay", 1},
                                                    {"pump", 1},
                                                    {"bus-report", 1},
                                                    {"drive-report", 1},
                                                    {"safety-thread", 1},
                                                    {"control-thread", 1},
                                                    {"plant-thread", 1},
                                                    {"operator-thread", 1},
                                                    {"planner-thread", 1}}};

constexpr std::array<const char*, kFaultKinds> kKinds = {
    "off",  "stuck",   "garbage",      "not-a-number", "wrong-scale",
    "slow", "delayed", "intermittent", "drifting",     "late"};

bool IsOneOf(FaultKind kind, std::initializer_list<FaultKind> kinds) noexcept {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

const Row& RowOf(FaultPlace place) noexcept { return kPlaces.at(static_cast<std::size_t>(place)); }

}  // namespace

const char* ToString(FaultPlace place) noexcept { return RowOf(place).name; }

const char* ToString(FaultKind kind) noexcept { return kKinds.at(static_cast<std::size_t>(kind)); }

int CountOf(FaultPlace place, int gauges) noexcept {
  const int count = RowOf(place).count;
  return count == 0 ? gauges : count;
}

bool Exists(FaultPlace place, FaultKind kind) noexcept {
  using enum FaultKind;
  switch (place) {
    case FaultPlace::kGauge:
    case FaultPlace::kGauges:
    case FaultPlace::kCounter:
    case FaultPlace::kFrame:
    case FaultPlace::kTorque:
      return true;
    case FaultPlace::kLine:
      return !IsOneOf(kind, {kNotANumber, kSlow, kDrifting});
    case FaultPlace::kLineReads:
    case FaultPlace::kLineWrites:
      return IsOneOf(kind, {kOff, kSlow, kIntermittent, kDrifting});
    case FaultPlace::kRelay:
    case FaultPlace::kPump:
      return IsOneOf(kind, {kOff, kStuck, kIntermittent, kLate});
    case FaultPlace::kBusReport:
      return IsOneOf(kind, {kOff, kStuck, kIntermittent, kLate, kDelayed});
    case FaultPlace::kDriveReport:
      return IsOneOf(kind, {kOff, kIntermittent});
    case FaultPlace::kSafety:
    case FaultPlace::kControl:
    case FaultPlace::kPlant:
    case FaultPlace::kOperator:
    case FaultPlace::kPlanner:
      return IsOneOf(kind, {kOff, kStuck, kSlow, kDelayed, kIntermittent, kDrifting, kLate});
  }
  return false;
}

std::string Text(const Fault& fault) {
  std::string text = ToString(fault.place);
  if (RowOf(fault.place).count != 1) text += " " + std::to_string(fault.index + 1);
  return text + " " + ToString(fault.kind);
}

}  // namespace flexarm
