#include "hal/emulation/simulated_amplifier.h"

namespace flexarm {

SimulatedAmplifier::SimulatedAmplifier(const ModbusDeviceConfig& config,
                                       const SensorConfig& sensors)
    : name_(config.name),
      channels_(sensors),
      image_(config),
      server_(config, image_),
      thread_([this] { server_.Run(); }) {}

SimulatedAmplifier::~SimulatedAmplifier() {
  server_.Stop();
  thread_.join();
}

void SimulatedAmplifier::Show(SensorFrame frame) noexcept {
  channels_.Apply(&frame);
  image_.Publish(frame);
}

void SimulatedAmplifier::Mend() {
  channels_.Clear();
  image_.SwapWords(false);
  server_.Behave(WireFault::kNone);
}

bool SimulatedAmplifier::SwapWords() noexcept {
  image_.SwapWords(true);
  return image_.has_words_to_swap();
}

}  // namespace flexarm
