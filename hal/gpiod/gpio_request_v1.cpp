#include <gpiod.h>

#include <cerrno>
#include <cstring>

#include "hal/bus_device.h"
#include "hal/gpiod/gpio_request.h"

namespace flexarm {
namespace {

constexpr const char* kConsumer = "flexarmd";

[[noreturn]] void Fail(const GpiodConfig& config, const std::string& what) {
  throw HalError("gpiod " + config.chip + ": " + what + " (" + std::strerror(errno) + ")");
}

gpiod_line* LineAt(const GpiodConfig& config, gpiod_chip* chip, unsigned offset,
                   const std::string& name) {
  gpiod_line* line = gpiod_chip_get_line(chip, offset);
  if (line == nullptr) Fail(config, name + " = line " + std::to_string(offset) + " does not exist");
  if (gpiod_line_is_used(line)) {
    const char* consumer = gpiod_line_consumer(line);
    errno = EBUSY;
    Fail(config, name + " = line " + std::to_string(offset) + " is held by " +
                     (consumer != nullptr ? consumer : "an unknown process"));
  }
  return line;
}

}  // namespace

struct GpioRequest::Handles {
  explicit Handles(const GpiodConfig& config) : chip(gpiod_chip_open_lookup(config.chip.c_str())) {
    if (chip == nullptr) Fail(config, "cannot be opened");
    try {
      Request(config);
    } catch (...) {
      gpiod_chip_close(chip);  // releases what was requested
      throw;
    }
  }
  ~Handles() { gpiod_chip_close(chip); }
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;

  void Request(const GpiodConfig& config) {
    const std::vector<GpioInput> wanted = InputsOf(config);
    gpiod_line_bulk_init(&inputs);
    for (const GpioInput& input : wanted) {
      gpiod_line_bulk_add(&inputs, LineAt(config, chip, input.offset, input.name));
    }
    gpiod_line_bulk_init(&outputs);
    gpiod_line_bulk_add(&outputs,
                        LineAt(config, chip, static_cast<unsigned>(config.relay), kGpioOutputs[0]));
    gpiod_line_bulk_add(&outputs,
                        LineAt(config, chip, static_cast<unsigned>(config.pump), kGpioOutputs[1]));
    if (gpiod_line_request_bulk_input_flags(&inputs, kConsumer,
                                            GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN) != 0) {
      Fail(config, "the input lines cannot be requested with pull-down");
    }
    for (unsigned i = 0; i < wanted.size(); ++i) {
      gpiod_line* line = gpiod_line_bulk_get_line(&inputs, i);
      if (gpiod_line_update(line) != 0 || gpiod_line_bias(line) != GPIOD_LINE_BIAS_PULL_DOWN) {
        throw HalError(NoPullDown(config, wanted[i]));
      }
    }
    const std::array<int, 2> low = {0, 0};
    if (gpiod_line_request_bulk_output(&outputs, kConsumer, low.data()) != 0) {
      Fail(config, "the output lines cannot be requested");
    }
  }

  gpiod_chip* chip;
  gpiod_line_bulk inputs;
  gpiod_line_bulk outputs;  // relay, pump
};

GpioRequest::GpioRequest(const GpiodConfig& config)
    : handles_(std::make_unique<Handles>(config)), chip_name_(gpiod_chip_name(handles_->chip)) {}

GpioRequest::~GpioRequest() { static_cast<void>(Write(0, 0)); }

bool GpioRequest::Read(std::array<int, kMostGpioInputs>* levels) noexcept {
  return gpiod_line_get_value_bulk(&handles_->inputs, levels->data()) == 0;
}

bool GpioRequest::Write(int relay, int pump) noexcept {
  const bool off = held_off_.load();
  const std::array<int, 2> values = {off ? 0 : relay, off ? 0 : pump};
  return gpiod_line_set_value_bulk(&handles_->outputs, values.data()) == 0;
}

}  // namespace flexarm
