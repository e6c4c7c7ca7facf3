#pragma once

#include <array>
#include <functional>
#include <vector>

#include "config/config.h"
#include "controller/commissioning/pluck.h"
#include "controller/step/control_step.h"
#include "hal/sim/simulated_rig.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {

/// A rig whose wiring or arm differs from its config.
struct Miswiring {
  std::function<void(RigConfig&)> real = [](RigConfig&) {};  ///< the actual sensors and arm
  std::function<void(SensorFrame&)> frame = [](SensorFrame&) {
  };  ///< changes each frame before the loop gets it
  std::function<std::array<double, 2>(const std::array<double, 2>&)> torque =
      [](const std::array<double, 2>& t) { return t; };  ///< torques at the joints
};

/// The pluck test on the simulated arm with a wiring fault: the real control step, sample by
/// sample, until its end or the first fault.
inline std::vector<TickRecord> PluckedRun(const Miswiring& wrong, const RigConfig& config) {
  RigConfig real = config;
  wrong.real(real);
  SimulatedRig rig(real.arm, real.sensors, real.sim);
  ControlStep step(config, ShippedDesign());
  const std::int64_t period_ns = 20'000'000;
  const std::vector<std::array<double, 2>> torque = PluckTorques(config.commissioning, 0.02);
  std::array<double, 2> applied{};
  std::vector<TickRecord> run;
  for (std::size_t k = 0; k <= torque.size(); ++k) {
    TickRecord tick{};
    tick.input.tick = static_cast<std::int64_t>(k);
    tick.input.sampling_instant_ns = tick.input.tick * period_ns;
    tick.input.frame = rig.Sample(tick.input.sampling_instant_ns);
    wrong.frame(tick.input.frame);
    tick.input.applied_torque_nm = applied;
    tick.input.safety_state = SafetyState::kRunning;
    tick.input.mode = LoopMode::kOpenLoop;
    tick.input.reset = k == 0 ? 1 : 0;
    if (k < torque.size()) tick.input.reference_next.u_m_nm = torque[k];
    tick.output = step.Step(tick.input);
    run.push_back(tick);
    if (tick.output.faults != 0) break;
    applied = tick.output.torque_nm;  // from the next sample on, for a whole period
    rig.SetTorque(wrong.torque(applied));
    for (std::int64_t t = 0; t < period_ns; t += rig.step_ns()) rig.Step();
  }
  return run;
}

}  // namespace flexarm
