#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "hal/sensor_frame.h"

namespace flexarm {

/// What the person at the rig does in a step of the proof.
enum class ProofAct : std::uint8_t {
  kOperate,  ///< operate the switch by hand, and release it
  kUnplug,   ///< unplug the connector of the switch, and plug it in again
  kPress,    ///< press the reset button, and release it
};

/// One act on one line.
struct ProofStep {
  Line line;
  ProofAct act;
};

/// Each limit switch and the emergency stop is operated and its connector unplugged; then the reset
/// button is pressed.
inline constexpr std::array<ProofStep, 11> kProofSteps = {{
    {Line::kLimit1Low, ProofAct::kOperate},
    {Line::kLimit1Low, ProofAct::kUnplug},
    {Line::kLimit1High, ProofAct::kOperate},
    {Line::kLimit1High, ProofAct::kUnplug},
    {Line::kLimit2Low, ProofAct::kOperate},
    {Line::kLimit2Low, ProofAct::kUnplug},
    {Line::kLimit2High, ProofAct::kOperate},
    {Line::kLimit2High, ProofAct::kUnplug},
    {Line::kEmergencyStop, ProofAct::kOperate},
    {Line::kEmergencyStop, ProofAct::kUnplug},
    {Line::kResetButton, ProofAct::kPress},
}};

/// Proves that every switch of a rig is read, at its own input, and that a cut wire reads as open:
/// only that an unplugged connector reads as open shows the pull-down of the input.
///
/// A step ends when its line, and no other, has left its healthy level and come back. A line that
/// changes in the place of another is named, and the step waits. A step that sees nothing for
/// kPatience_s ends the proof, and names the step.
///
/// Takes one sample of the levels a control period. Not real-time; no I/O.
class SwitchProof {
 public:
  static constexpr double kPatience_s = 120.0;

  explicit SwitchProof(double period_s) : patience_(static_cast<int>(kPatience_s / period_s)) {}

  void Take(LineLevels levels);

  bool done() const { return step_ == kProofSteps.size(); }
  bool failed() const { return !done() && waited_ >= patience_; }

  /// 0-based index of the present step in kProofSteps; its size when done.
  std::size_t step() const { return step_; }

  /// What to do now, or what is wrong, for the person at the rig. "" when done.
  std::string Text() const;

 private:
  int patience_;
  std::size_t step_ = 0;
  bool away_ = false;  // the step's line has left its healthy level
  int waited_ = 0;     // samples without progress
  LineLevels unhealthy_ = LineBit(kProofSteps[0].line);
};

const char* ToString(ProofAct act) noexcept;

}  // namespace flexarm
