#pragma once

#include <memory>
#include <string>

#include "controller/types/step_types.h"

namespace flexarm {

struct ControlConfig;
struct Design;

/// The loop: counts in, torque out (docs/architecture.md).
///
///   counts -decode-> angles, strains -fit-> modal coordinates -filter-> x(k) -predict-> x when the
///   torque acts
///          -reference, CGT, Sobel-> asked torque
///
/// A function of its inputs since the last reset: no I/O, lock, allocation, clock or exception, and
/// + - * / and sqrt only, so the same bytes in give the same bytes out.
/// Real-time: `Step` is safe; the constructor is not.
class ControlStep {
 public:
  ControlStep(const ControlConfig& config, const Design& design);
  ~ControlStep();
  ControlStep(const ControlStep&) = delete;
  ControlStep& operator=(const ControlStep&) = delete;

  StepOutput Step(const StepInput& input) noexcept;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace flexarm
