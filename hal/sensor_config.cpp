#include "hal/sensor_config.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>

#include "model/problem_list.h"

namespace flexarm {
namespace {

// Range of a two's complement converter.
int LowestCount(int bits) { return -(1 << (bits - 1)); }
int HighestCount(int bits) { return (1 << (bits - 1)) - 1; }

constexpr std::array<const char*, kCounters> kJointNames = {"hub1", "hub2", "rotor1", "rotor2"};

void CheckEncoders(const std::vector<EncoderConfig>& encoder, ProblemList* list) {
  std::uint32_t seen = 0;
  for (std::size_t i = 0; i < encoder.size(); ++i) {
    const EncoderConfig& e = encoder[i];
    const std::string row = ProblemList::Element("encoder", i);
    if (e.counter < 0 || e.counter >= kCounters) {
      list->Require(false, row + ".joint", NumberText(e.counter),
                    R"(must be "hub1", "hub2", "rotor1" or "rotor2" (counter 0 .. 3))");
      continue;
    }
    const std::uint32_t bit = std::uint32_t{1} << static_cast<unsigned>(e.counter);
    const char* joint = kJointNames[static_cast<std::size_t>(e.counter)];
    list->Require((seen & bit) == 0, row + ".joint", joint,
                  "must be used once: an angle has one encoder");
    seen |= bit;
    list->Within(row + ".counts_per_turn", e.counts_per_turn, 100.0, 1e8,
                 "counts per turn of the joint, gear and quadrature included");
    list->Within(row + ".counter_bits", e.counter_bits, 4, 32, "the counter wraps at 2^bits");
    list->Require(e.sign == 1 || e.sign == -1, row + ".sign", NumberText(e.sign),
                  "must be 1, or -1 if the encoder counts clockwise");
  }
  for (const std::size_t hub : {0U, 1U}) {
    list->Require((seen & (1U << hub)) != 0, "encoder", NumberText(encoder.size()) + " rows",
                  "must have a row with joint = \"" + std::string(kJointNames[hub]) +
                      "\": the loop closes on the hub angles");
  }
}

void CheckStrainInput(const StrainInputConfig& input, ProblemList* list) {
  list->Within("strain_input.converter_bits", input.converter_bits, 8, 24,
               "two's complement; below 8 bits the strains are too coarse to fit");
  list->Within("strain_input.range_v", input.range_v, 0.01, 100.0,
               "full scale is -range_v .. +range_v");
  list->Within("strain_input.filter_hz", input.filter_hz, 0.0, 1e5,
               "corner frequency of the analogue filter, 0 for none");
  list->Require(
      input.filter_damping == 0.0 || (input.filter_damping >= 0.1 && input.filter_damping <= 2.0),
      "strain_input.filter_damping", NumberText(input.filter_damping),
      "must lie in 0.1 .. 2: damping ratio of a second-order filter; omit the key "
      "for a first-order one");
  list->Within("strain_input.noise_counts", input.noise_counts, 0.0, 1e4,
               "standard deviation before quantising");
}

// Below a tenth of its corner the filter is a pure delay, as the estimator assumes: the vibrations
// in its model end at about 10 Hz.
constexpr double kLeastAccelerometerFilter_hz = 100.0;

void CheckTipAccelerometer(const TipAccelerometerConfig& config, ProblemList* list) {
  list->Within("tip_accelerometer.range_m_s2", config.range_m_s2, 1.0, 1e4,
               "full scale is -range_m_s2 .. +range_m_s2");
  list->Within("tip_accelerometer.converter_bits", config.converter_bits, 8, 24,
               "two's complement; below 8 bits it adds nothing to the gauges");
  list->Within("tip_accelerometer.noise_counts", config.noise_counts, 0.0, 1e4,
               "standard deviation before quantising");
  list->Within("tip_accelerometer.filter_hz", config.filter_hz, kLeastAccelerometerFilter_hz, 1e5,
               "corner of the analogue filter: \"ekf-payload\" treats it as a short delay");
}

void CheckStrainPosition(const StrainChannelConfig& channel, const std::string& key,
                         const std::array<double, 2>& link_length_m, ProblemList* list) {
  list->Require(channel.position_m >= 0.0 && channel.position_m <= 100.0, key,
                NumberText(channel.position_m), "must be 0 or more: counted from the link's root");
  if (channel.link != 1 && channel.link != 2) return;
  const double length = link_length_m[static_cast<std::size_t>(channel.link - 1)];
  // Written so that an unknown (NaN) length violates no rule.
  list->Require(!(channel.position_m > length), key, NumberText(channel.position_m),
                "must lie on the link: link " + NumberText(channel.link) + " is " +
                    NumberText(length) + " m long");
}

void CheckStrainChannels(const std::vector<StrainChannelConfig>& strain,
                         const StrainInputConfig& input, const std::array<double, 2>& link_length_m,
                         ProblemList* list) {
  list->Require(strain.size() <= std::size_t{kMaxStrainChannels}, "strain",
                NumberText(strain.size()) + " rows",
                "must be at most " + NumberText(kMaxStrainChannels) +
                    " rows, both links together: the size of a frame");
  const bool bits_known = input.converter_bits >= 8 && input.converter_bits <= 24;
  const double rail = bits_known ? input.highest_count() : 1e8;
  for (std::size_t i = 0; i < strain.size(); ++i) {
    const StrainChannelConfig& channel = strain[i];
    const std::string row = ProblemList::Element("strain", i);
    list->Within(row + ".link", channel.link, 1, 2, "the arm has two links");
    CheckStrainPosition(channel, row + ".position_m", link_length_m, list);
    list->Require(channel.face == 1 || channel.face == -1, row + ".face", NumberText(channel.face),
                  "must be 1 (reads +(h/2) w'') or -1 (its negative)");
    const double gain = std::abs(channel.gain_v_per_unit);
    list->Require(gain > 0.0 && gain <= 1e9, row + ".gain_v_per_unit",
                  NumberText(channel.gain_v_per_unit),
                  "must not be 0 (and at most 1e9): volts per unit strain");
    list->Require(std::abs(channel.offset_counts) < rail, row + ".offset_counts",
                  NumberText(channel.offset_counts),
                  "must lie within the converter's range, or the channel is always saturated");
  }
}

}  // namespace

const char* CounterName(int counter) { return kJointNames.at(static_cast<std::size_t>(counter)); }

double StrainInputConfig::volts_per_count() const {
  return 2.0 * range_v / std::ldexp(1.0, converter_bits);
}

int StrainInputConfig::lowest_count() const { return LowestCount(converter_bits); }

int StrainInputConfig::highest_count() const { return HighestCount(converter_bits); }

double TipAccelerometerConfig::m_s2_per_count() const {
  return 2.0 * range_m_s2 / std::ldexp(1.0, converter_bits);
}

double TipAccelerometerConfig::lag_s() const { return 1.0 / (2.0 * std::numbers::pi * filter_hz); }

int TipAccelerometerConfig::lowest_count() const { return LowestCount(converter_bits); }

int TipAccelerometerConfig::highest_count() const { return HighestCount(converter_bits); }

std::uint32_t SensorConfig::counters_present() const {
  std::uint32_t present = 0;
  for (const EncoderConfig& e : encoder) {
    if (e.counter >= 0 && e.counter < kCounters) {
      present |= std::uint32_t{1} << static_cast<unsigned>(e.counter);
    }
  }
  return present;
}

std::vector<Problem> SensorConfig::Problems(const std::array<double, 2>& link_length_m) const {
  ProblemList list("sensors.");
  CheckEncoders(encoder, &list);
  CheckStrainInput(strain_input, &list);
  CheckStrainChannels(strain, strain_input, link_length_m, &list);
  if (tip_accelerometer) CheckTipAccelerometer(*tip_accelerometer, &list);
  return list.Take();
}

}  // namespace flexarm
