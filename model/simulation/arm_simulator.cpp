#include "model/simulation/arm_simulator.h"

#include <limits>
#include <stdexcept>

#include "model/simulation/step_kernel.h"

namespace flexarm {
namespace {

// ArmVector has a fixed capacity, and release builds do not check it.
ArmVector RestingVector(int dof) {
  if (dof > kMaxSteppedDof)
    throw std::invalid_argument("ArmState: more modes than ArmSimulator supports");
  return ArmVector::Zero(dof);
}

// What 3 passes from the last acceleration left of the tip's error was 6 to 68 times as much; the
// step's own error is 20 to 800 times as much (docs/theory/plant.md 7.1).
constexpr Passes kUntilTheyAgree{.least = 2,
                                 .most = 4,
                                 .agreement_rad_s = 1e-5,
                                 .tolerated_rad_s = 1e-3,
                                 .longest = 12,
                                 .halvings = 6};

Passes PassesOf(const SimulatorOptions& options) {
  if (!options.passes) return kUntilTheyAgree;
  constexpr double kAny = std::numeric_limits<double>::infinity();
  return {.least = *options.passes,
          .most = *options.passes,
          .agreement_rad_s = 0.0,
          .tolerated_rad_s = kAny};
}

}  // namespace

ArmState::ArmState(int dof) : q(RestingVector(dof)), v(q), a(q), a_before(q) {}

ArmSimulator::ArmSimulator(const ArmModel& model, const SimulatorOptions& options)
    : dof_(model.dof()), options_(options) {
  if (options.passes.value_or(1) < 1 || options.substeps < 1) {
    throw std::invalid_argument("SimulatorOptions: passes and substeps must be at least 1");
  }
  kernel_ = MakeStepKernel(model.constants(), options.coulomb_friction);
}

ArmSimulator::~ArmSimulator() = default;
ArmSimulator::ArmSimulator(ArmSimulator&&) noexcept = default;
ArmSimulator& ArmSimulator::operator=(ArmSimulator&&) noexcept = default;

void ArmSimulator::Step(ArmState& state, const Eigen::Vector2d& torque_nm, double h_s) noexcept {
  const double h = h_s / options_.substeps;
  const Passes passes = PassesOf(options_);
  for (int i = 0; i < options_.substeps; ++i) {
    kernel_->Step(&state, torque_nm, h, passes);
  }
}

void ArmSimulator::CarryPayloadOf(const ArmModel& model) noexcept {
  kernel_->CarryPayload(model.constants());
}

}  // namespace flexarm
