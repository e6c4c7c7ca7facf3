#pragma once

#include "estimator/payload_monitor.h"

namespace flexarm {

/// The payload at which the gains of a GainTable are interpolated, kg: the estimate, or less.
///
/// Gains for a light payload are stable with a heavy one, but not the reverse: on the thesis's rig
/// the gains of 0.15 kg stabilise every payload to 1 kg, those of 1 kg no payload below 0.15 kg,
/// and a payload can be lost. So the result is weighted towards 0.15 of the greatest payload, or
/// the estimate if that is less, while
///   - the estimate is uncertain: weight (sigma / (0.1 of the greatest payload))^2, at most 1;
///   - the innovations contradict the filter's model: weight from 0 at a mean NIS of 20 to 1 at
///   kModelWrongNis;
///   - the arm has rested for more than 2 s: weight 1, as a payload may change unobserved.
/// Source: docs/theory/payload.md 4.3. Real-time: safe.
/// @param payload_sigma_kg  standard deviation of the estimate, >= 0
/// @param mean_nis          smoothed NIS, as PayloadFilter::mean_nis
/// @param most_kg           the greatest payload, > 0
/// @param rested_s          time since the end of the last move; 0 or less during a move
double SchedulingPayload(double payload_kg, double payload_sigma_kg, double mean_nis,
                         double rested_s, double most_kg) noexcept;

}  // namespace flexarm
