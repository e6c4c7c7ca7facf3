#include "controller/health/drift_channel.h"

#include <array>
#include <cstdint>

namespace flexarm {
namespace {

const char* QuantityOf(DriftKind kind) {
  switch (kind) {
    case DriftKind::kGaugeGain:
      return "gain";
    case DriftKind::kGaugeZero:
      return "zero";
    case DriftKind::kFriction:
      return "friction";
    case DriftKind::kJointStiffness:
    case DriftKind::kLinkStiffness:
      return "stiffness";
    case DriftKind::kPayload:
      return "payload";
  }
  return "";
}

bool OfJoint(DriftKind kind) {
  return kind == DriftKind::kFriction || kind == DriftKind::kJointStiffness;
}

}  // namespace

std::string DriftChannel::Name() const {
  if (part == 0) return QuantityOf(kind);
  const std::string where = (OfJoint(kind) ? "joint " : "link ") + std::to_string(part);
  const std::string owner = of_gauge() ? "gauge " + std::to_string(gauge) + " of " + where : where;
  return owner + ": " + QuantityOf(kind);
}

std::string DriftChannel::Key() const {
  if (part == 0) return QuantityOf(kind);
  const std::string where = (OfJoint(kind) ? "joint" : "link") + std::to_string(part);
  const std::string owner = of_gauge() ? where + ".gauge" + std::to_string(gauge) : where;
  return owner + "." + QuantityOf(kind);
}

std::vector<DriftChannel> DriftChannels(const ArmParameters& arm, const SensorConfig& sensors) {
  std::vector<DriftChannel> channels;
  const auto add = [&channels](DriftKind kind, int part) {
    channels.push_back({.kind = kind, .part = part, .gauge = 0, .strain = 0});
  };
  for (int joint = 1; joint <= 2; ++joint) {
    const JointParameters& parameters = arm.joint[static_cast<std::size_t>(joint) - 1];
    if (parameters.coulomb_friction_nm > 0.0) add(DriftKind::kFriction, joint);
    const std::uint32_t both = 5U << (joint - 1);
    if ((sensors.counters_present() & both) == both) add(DriftKind::kJointStiffness, joint);
  }
  for (int link = 1; link <= 2; ++link) add(DriftKind::kLinkStiffness, link);
  add(DriftKind::kPayload, 0);
  for (const DriftKind kind : {DriftKind::kGaugeGain, DriftKind::kGaugeZero}) {
    std::array<int, 2> number{};
    for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
      const int link = sensors.strain[i].link;
      const int gauge = ++number[static_cast<std::size_t>(link) - 1];
      channels.push_back({.kind = kind, .part = link, .gauge = gauge, .strain = i});
    }
  }
  return channels;
}

ShownUnit UnitOf(DriftKind kind) {
  switch (kind) {
    case DriftKind::kGaugeGain:
    case DriftKind::kJointStiffness:
    case DriftKind::kLinkStiffness:
      return {.scale = 100.0, .unit = "%"};
    case DriftKind::kGaugeZero:
      return {.scale = 1e6, .unit = "um/m"};
    case DriftKind::kFriction:
      return {.scale = 1.0, .unit = "N m"};
    case DriftKind::kPayload:
      return {.scale = 1e3, .unit = "g"};
  }
  return {};
}

const char* SiUnitOf(DriftKind kind) {
  if (kind == DriftKind::kFriction) return "N m";
  return kind == DriftKind::kPayload ? "kg" : "1";
}

}  // namespace flexarm
