#pragma once

#include <string>

#include "tools/analysis/statement.h"
#include "tools/thesis/control_text.h"

namespace flexarm {

/// How the arm comes to rest with 0 to 0.2 kg: 15 and 5 mm bands, and motion in the last second.
/// @param law  override; empty: the thesis's law
Statement Damped(const ControlStudy& study, LoopKind loop, const std::string& section,
                 const std::string& thesis, const Overrides& law = {});
/// "The steady state error is zero", against the encoder's count.
Statement NoFinalError(const ControlStudy& study, LoopKind loop, const std::string& section);

}  // namespace flexarm
