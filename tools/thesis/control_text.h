#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/thesis/control_study.h"

// Words for the figures of ControlStudy, in the statements of chapter 7.

namespace flexarm {

/// The two loops that the statements speak of.
enum class LoopKind { kSensors, kIdeal };

/// The study's figures of a case in one of the loops.
const ControlFigures& FiguresOf(const ControlStudy& study, LoopKind loop, const ControlCase& of);

/// "1.08 / 0.75": of(payload_kg) for each payload.
template <typename F>
std::string PerPayload(std::span<const double> payloads_kg, const F& of) {
  std::string text;
  for (const double payload_kg : payloads_kg) text += (text.empty() ? "" : " / ") + of(payload_kg);
  return text;
}

/// " at 0.01 / 0.1 kg"
std::string AtPayloads(std::span<const double> payloads_kg);

/// " [sensors and delay, seeds 1 to 3; alpha 3, vartheta 0.35]", from config and study.
/// @param changed  settings that the row itself varies or changes, in place of alpha and vartheta
std::string SensorSettings(const ControlStudy& study, const std::string& changed = "");
/// " [known state, no delay; alpha 3, vartheta 0.35]"
std::string IdealSettings(const ControlStudy& study, const std::string& changed = "");
std::string BothSettings(const ControlStudy& study, const std::string& changed = "");

/// "no run completes" for NaN, "never" for an infinite time.
std::string FigureOrNever(const OverSeeds& value, int digits = 3);
/// "1.08 0.71" of both joints or links.
std::string PairText(const std::array<OverSeeds, 2>& values, int digits = 3);
/// "9 of 12 runs complete"
std::string CompletedText(const ControlStudy& study, LoopKind loop, const ControlCase& of,
                          std::span<const double> payloads_kg);

/// The same case with each payload, in both loops: the outcomes of one figure.
using FigureOf = const OverSeeds ControlFigures::*;
std::vector<Contrast> Contrasts(const ControlStudy& study, LoopKind loop, const ControlCase& first,
                                const ControlCase& second, std::span<const double> payloads_kg,
                                FigureOf figure);

/// One after the other.
template <typename T>
std::vector<T> Joined(std::vector<T> first, const std::vector<T>& then) {
  first.insert(first.end(), then.begin(), then.end());
  return first;
}

}  // namespace flexarm
