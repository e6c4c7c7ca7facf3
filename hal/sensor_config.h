#pragma once

#include <array>
#include <optional>
#include <vector>

#include "hal/sensor_frame.h"
#include "model/problem.h"

namespace flexarm {

/// "hub1" "hub2" "rotor1" "rotor2": values of the key `joint`. @param counter  0..3
const char* CounterName(int counter);

/// One incremental encoder and its counter: [[sensors.encoder]].
///
/// angle = sign * 2 pi * unwrapped counts / counts_per_turn, counter-clockwise positive.
struct EncoderConfig {
  int counter;             ///< 0..3: key `joint` = "hub1" "hub2" "rotor1" "rotor2" (th1..th4)
  double counts_per_turn;  ///< per turn of the joint, gear included, > 0
  int counter_bits;        ///< the counter wraps at 2^bits, 4..32
  int sign;                ///< +1, or -1 if the encoder counts clockwise
};

/// One strain channel: [[sensors.strain]]. A half bridge is a row too.
///
/// counts = round((face * (h/2) w''(x) * gain_v_per_unit) / volts_per_count) + offset_counts.
struct StrainChannelConfig {
  int link;                ///< 1 or 2
  double position_m;       ///< from the root of the link, 0 <= x <= L
  int face;                ///< +1 reads +(h/2) w'', -1 its negative
  double gain_v_per_unit;  ///< volts per unit strain, not 0
  double offset_counts;    ///< counts at zero strain
};

/// The converter and amplifier that all strain channels share: [sensors.strain_input].
struct StrainInputConfig {
  int converter_bits;     ///< 8..24, two's complement, saturates at the ends of its range
  double range_v;         ///< full scale is -range_v .. +range_v
  double filter_hz;       ///< natural frequency of the analogue filter; 0: no filter
  double noise_counts;    ///< standard deviation before quantising
  double filter_damping;  ///< damping ratio of a second-order filter; 0, no such key: first order

  double volts_per_count() const;  ///< 2 range / 2^bits
  int lowest_count() const;        ///< -2^(bits-1)
  int highest_count() const;       ///< 2^(bits-1) - 1
};

/// A single-axis accelerometer at the tip: [sensors.tip_accelerometer].
///
/// Mounted at the end of link 2, its axis normal to the link there and in the plane of the arm, so
/// that it turns with the tip; positive counter-clockwise, in the direction of w2. Gravity is
/// normal to the plane and not read. counts = round(acceleration / m_s2_per_count()).
struct TipAccelerometerConfig {
  double range_m_s2;    ///< full scale is -range_m_s2 .. +range_m_s2
  int converter_bits;   ///< 8..24, two's complement, saturates at the ends of its range
  double noise_counts;  ///< standard deviation before quantising
  double filter_hz;     ///< corner of the first-order analogue filter, 100 Hz at least

  double m_s2_per_count() const;  ///< 2 range / 2^bits
  double lag_s() const;           ///< lag of the filter well below its corner: 1 / (2 pi filter_hz)
  int lowest_count() const;       ///< -2^(bits-1)
  int highest_count() const;      ///< 2^(bits-1) - 1
};

/// Sensors of the rig, section [sensors]. Rotor encoders and accelerometer may be absent.
struct SensorConfig {
  std::vector<EncoderConfig> encoder;
  std::vector<StrainChannelConfig> strain;
  StrainInputConfig strain_input;
  std::optional<TipAccelerometerConfig> tip_accelerometer{};

  /// Bit i: counter i exists.
  std::uint32_t counters_present() const;
  /// Violated rules; `link_length_m` bounds the positions.
  std::vector<Problem> Problems(const std::array<double, 2>& link_length_m) const;
};

}  // namespace flexarm
