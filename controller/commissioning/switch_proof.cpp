#include "controller/commissioning/switch_proof.h"

#include <utility>

#include "hal/line_names.h"

namespace flexarm {
namespace {

std::string Names(LineLevels lines) {
  std::string names;
  for (int i = 0; i < kLines; ++i) {
    const auto line = static_cast<Line>(i);
    if ((lines & LineBit(line)) == 0) continue;
    names.append(names.empty() ? "" : ", ").append(ToString(line));
  }
  return names;
}

std::string Instruction(const ProofStep& step) {
  const std::string name = ToString(step.line);
  switch (step.act) {
    case ProofAct::kOperate:
      return "operate " + name + " by hand, then release it";
    case ProofAct::kUnplug:
      return "unplug the connector of " + name + ", then plug it in again";
    case ProofAct::kPress:
      return "press and release " + name;
  }
  return {};
}

}  // namespace

void SwitchProof::Take(LineLevels levels) {
  if (done() || failed()) return;
  constexpr LineLevels kAll = (LineLevels{1} << kLines) - 1;
  const LineLevels before = std::exchange(unhealthy_, (levels ^ kHealthyLevels) & kAll);
  const LineLevels own = LineBit(kProofSteps[step_].line);
  ++waited_;
  if ((unhealthy_ & ~own) != 0) {
    away_ = false;  // what its line does now may be the other line's doing
  } else if (unhealthy_ == own && before == 0) {
    away_ = true;
    waited_ = 0;
  } else if (unhealthy_ == 0 && away_) {
    away_ = false;
    waited_ = 0;
    ++step_;
  }
}

std::string SwitchProof::Text() const {
  if (done()) return {};
  const ProofStep& step = kProofSteps[step_];
  const LineLevels wrong = unhealthy_ & ~LineBit(step.line);
  if (wrong != 0) {
    return Names(wrong) + (step.act == ProofAct::kPress ? " changed" : " opened") +
           " where nothing but " + ToString(step.line) + " should: close it; if you did operate " +
           ToString(step.line) + ", two inputs are exchanged or connected";
  }
  if (failed()) {
    return std::string(ToString(step.line)) + " did not " + (away_ ? "come back" : "change") +
           " within " + std::to_string(static_cast<int>(kPatience_s)) + " s (" + Instruction(step) +
           ")" +
           (step.act == ProofAct::kUnplug && !away_
                ? ": its input has no pull-down, so a cut wire does not trip (docs/hardware.md)"
                : "");
  }
  if (away_) return std::string(ToString(step.line)) + " is seen: now undo it";
  if (unhealthy_ != 0) return std::string(ToString(step.line)) + " is not closed: close it first";
  return Instruction(step);
}

const char* ToString(ProofAct act) noexcept {
  switch (act) {
    case ProofAct::kOperate:
      return "operate";
    case ProofAct::kUnplug:
      return "unplug";
    case ProofAct::kPress:
      return "press";
  }
  return "unknown";
}

}  // namespace flexarm
