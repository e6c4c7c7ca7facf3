#include "controller/reference/identification_torques.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace flexarm {
namespace {

constexpr double kTaper = 0.1;  // of the duration, at each end

// Taps of a primitive polynomial for each number of bits: bit i - 1 is the coefficient of x^i.
constexpr std::array<std::uint32_t, 13> kTaps = {0,    0,    0x3,   0x6,   0xC,   0x14, 0x30,
                                                 0x60, 0xB8, 0x110, 0x240, 0x500, 0x829};

}  // namespace

std::vector<double> ChirpAngles(const Chirp& chirp, int n, double period_s) {
  const double T = n * period_s;
  std::vector<double> angles(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    const double t = k * period_s, x = static_cast<double>(k) / (n - 1);
    const double cycles = chirp.from_hz * t + (chirp.to_hz - chirp.from_hz) * t * t / (2.0 * T);
    const double window = ProfileAt(MoveProfile::kQuintic, x / kTaper).s *
                          ProfileAt(MoveProfile::kQuintic, (1.0 - x) / kTaper).s;
    angles[static_cast<std::size_t>(k)] = window * std::sin(2.0 * std::numbers::pi * cycles);
  }
  return angles;
}

std::vector<int> MaximalLengthSequence(int bits, int seed) {
  const std::uint32_t mask = (std::uint32_t{1} << bits) - 1;
  auto state = static_cast<std::uint32_t>(seed);
  std::vector<int> sequence(mask);
  for (int& value : sequence) {
    value = (state >> (bits - 1) & 1u) != 0 ? 1 : -1;
    const auto taps = static_cast<std::uint32_t>(
        std::popcount(state & kTaps[static_cast<std::size_t>(bits)]) & 1);
    state = (state << 1 | taps) & mask;
  }
  return sequence;
}

std::vector<double> PrbsSigns(const Prbs& prbs, int hold_periods, int joint) {
  constexpr std::array<int, 4> kPulse = {1, -1, -1, 1};
  const std::vector<int> sequence = MaximalLengthSequence(prbs.bits, prbs.seed);
  const std::size_t shift = joint == 0 ? 0 : sequence.size() / 2;
  std::vector<double> signs;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const int value = sequence[(i + shift) % sequence.size()];
    for (const int part : kPulse) {
      signs.insert(signs.end(), static_cast<std::size_t>(hold_periods), part * value);
    }
  }
  return signs;
}

}  // namespace flexarm
