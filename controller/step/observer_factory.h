#pragma once

#include <memory>

#include "controller/law/design.h"
#include "controller/types/control_config.h"
#include "estimator/observer.h"

namespace flexarm {

/// Makes the observer of `estimator.name` with the filter of `design`.
/// @throws RejectedError  `ideal`: IdealObserver needs who tells it the state
std::unique_ptr<Observer> MakeObserver(const ControlConfig& config, const Design& design);

}  // namespace flexarm
