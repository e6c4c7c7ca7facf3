#pragma once

namespace flexarm {

struct ControlConfig;

/// No arm is at rest farther than this from its target, and none whose reach is below 1.5 m farther
/// than this share of the reach.
inline constexpr double kLargestTipError_m = 0.015;
inline constexpr double kLargestTipErrorOfReach = 0.01;

/// Both links' lengths, m.
double Reach_m(const ControlConfig& config);

/// How far one count of the coarser hub encoder moves the stretched arm's tip, m.
double CountAtTip_m(const ControlConfig& config);

/// A rest is settled while the tip is within this distance, m: 1 % of the reach and one count at
/// the tip, at most 15 mm. Source: docs/benchmark.md, "Settled".
double SettledWithin_m(const ControlConfig& config);

}  // namespace flexarm
