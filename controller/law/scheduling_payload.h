#pragma once

#include "estimator/payload_monitor.h"

namespace flexarm {

/// The payload for which the gains of a GainTable are taken, kg: the estimate, or less.
///
/// Gains for a light arm are stable on a heavy one, gains for a heavy arm are not on a light one:
/// those of 0.15 kg hold every payload, those of 1 kg no arm below 0.15 kg, and a payload can be
/// dropped. So no more than 0.15 kg while
///   - the estimate is uncertain: weight (sigma / kPayloadUncertain_kg)^2, at most 1;
///   - the filter's model is wrong: weight from 0 at a mean NIS of 20 to 1 at kModelWrongNis;
///   - the arm has rested for more than 0.5 s, when a payload may be handed over unseen.
/// Source: docs/theory/payload.md 4.3. Real-time: safe.
/// @param payload_sigma_kg  standard deviation of the estimate, >= 0
/// @param mean_nis          as PayloadFilter's
/// @param rested_s          since the last move's end; 0 or less while one is under way
double SchedulingPayload(double payload_kg, double payload_sigma_kg, double mean_nis,
                         double rested_s) noexcept;

}  // namespace flexarm
