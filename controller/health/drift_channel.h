#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// What may drift on a rig.
enum class DriftKind : std::uint8_t {
  kGaugeGain,       ///< relative to the calibrated gain
  kGaugeZero,       ///< surface strain that the gauge reads of a straight link
  kFriction,        ///< Coulomb friction of a joint, N m
  kJointStiffness,  ///< relative to the config
  kLinkStiffness,   ///< bending stiffness, relative to the config
  kPayload,         ///< kg beyond the payload that the run states
};

/// A quantity whose drift a run tells.
struct DriftChannel {
  DriftKind kind;
  int part;            ///< link or joint, 1 or 2; 0: of the whole arm
  int gauge;           ///< its number on the link, from 1 at the root; 0: no gauge
  std::size_t strain;  ///< row of [[sensors.strain]] from 0; 0 for no gauge

  bool of_gauge() const { return gauge > 0; }
  std::string Name() const;  ///< "gauge 7 of link 1: gain"
  std::string Key() const;   ///< "link1.gauge7.gain"
};

/// The channels of a rig: gain and zero of every gauge, friction of each joint that has friction in
/// the config, stiffness of each joint that has encoders on hub and rotor, stiffness of each link,
/// payload.
std::vector<DriftChannel> DriftChannels(const ArmParameters& arm, const SensorConfig& sensors);

/// How a figure of a kind is shown: its number times `scale`, then `unit`.
struct ShownUnit {
  double scale;  ///< of the unit of DriftKind
  const char* unit;
};
ShownUnit UnitOf(DriftKind kind);
/// The unit of the figures themselves: "1" of relative ones, "N m", "kg".
const char* SiUnitOf(DriftKind kind);

}  // namespace flexarm
