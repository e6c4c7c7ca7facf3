#pragma once

#include <memory>

#include "controller/law/design.h"
#include "controller/law/law.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// Makes the law of `controller.name` with the gains of `design`.
std::unique_ptr<Law> MakeLaw(const ControlConfig& config, const Design& design);

}  // namespace flexarm
