#pragma once

namespace flexarm {

/// The payload for which the gains of a GainTable are taken, kg: the estimate, or less.
///
/// Gains for a light arm are stable on a heavy one, gains for a heavy arm are not on a light one:
/// those of 0.15 kg hold every payload, those of 1 kg no arm below 0.15 kg, and a payload can be
/// dropped. So no more than 0.15 kg while
///   - the estimate is uncertain: weight sigma^2 / (0.1 kg)^2, at most 1;
///   - the filter's model is wrong: weight (mean NIS - 20) / 40, within 0 .. 1, for 8 outputs;
///   - the arm has rested for more than 0.5 s, when a payload may be handed over unseen.
/// Source: beyond.md 2.4. Real-time: safe.
/// @param payload_sigma_kg  standard deviation of the estimate, >= 0
/// @param mean_nis          as PayloadFilter's
/// @param rested_s          since the last move's end; 0 or less while one is under way
double GainPayload(double payload_kg, double payload_sigma_kg, double mean_nis,
                   double rested_s) noexcept;

}  // namespace flexarm
