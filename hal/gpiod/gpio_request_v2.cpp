#include <gpiod.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "hal/bus_device.h"
#include "hal/gpiod/gpio_request.h"

namespace flexarm {
namespace {

constexpr const char* kConsumer = "flexarmd";
constexpr int kMostChips = 256;  // /dev/gpiochip0 ..

[[noreturn]] void Fail(const GpiodConfig& config, const std::string& what) {
  throw HalError("gpiod " + config.chip + ": " + what + " (" + std::strerror(errno) + ")");
}

template <auto release>
struct Releaser {
  template <typename T>
  void operator()(T* pointer) const noexcept {
    release(pointer);
  }
};
template <typename T, auto release>
using Owned = std::unique_ptr<T, Releaser<release>>;

using Chip = Owned<gpiod_chip, gpiod_chip_close>;
using ChipInfo = Owned<gpiod_chip_info, gpiod_chip_info_free>;
using LineInfo = Owned<gpiod_line_info, gpiod_line_info_free>;
using Settings = Owned<gpiod_line_settings, gpiod_line_settings_free>;
using LineConfig = Owned<gpiod_line_config, gpiod_line_config_free>;
using RequestConfig = Owned<gpiod_request_config, gpiod_request_config_free>;

// The first generation finds a chip by its path, name or label; the second by its path alone.
Chip OpenChip(const GpiodConfig& config) {
  if (config.chip.starts_with('/')) return Chip(gpiod_chip_open(config.chip.c_str()));
  for (int n = 0; n < kMostChips; ++n) {
    const std::string path = "/dev/gpiochip" + std::to_string(n);
    if (!gpiod_is_gpiochip_device(path.c_str())) continue;
    Chip chip(gpiod_chip_open(path.c_str()));
    if (chip == nullptr) continue;
    const ChipInfo info(gpiod_chip_get_info(chip.get()));
    if (info != nullptr && (config.chip == gpiod_chip_info_get_name(info.get()) ||
                            config.chip == gpiod_chip_info_get_label(info.get()))) {
      return chip;
    }
  }
  errno = ENOENT;
  return nullptr;
}

void CheckFree(const GpiodConfig& config, gpiod_chip* chip, unsigned offset,
               const std::string& name) {
  const std::string line = name + " = line " + std::to_string(offset);
  const LineInfo info(gpiod_chip_get_line_info(chip, offset));
  if (info == nullptr) Fail(config, line + " does not exist");
  if (!gpiod_line_info_is_used(info.get())) return;
  const char* consumer = gpiod_line_info_get_consumer(info.get());
  errno = EBUSY;
  Fail(config, line + " is held by " + (consumer != nullptr ? consumer : "an unknown process"));
}

// Null if the kernel refuses, with errno.
gpiod_line_request* RequestLines(gpiod_chip* chip, const std::vector<unsigned>& offsets,
                                 gpiod_line_direction direction, gpiod_line_bias bias) {
  const Settings settings(gpiod_line_settings_new());
  const LineConfig lines(gpiod_line_config_new());
  const RequestConfig request(gpiod_request_config_new());
  if (settings == nullptr || lines == nullptr || request == nullptr) return nullptr;
  gpiod_request_config_set_consumer(request.get(), kConsumer);
  if (gpiod_line_settings_set_direction(settings.get(), direction) != 0 ||
      gpiod_line_settings_set_bias(settings.get(), bias) != 0 ||
      gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE) != 0 ||
      gpiod_line_config_add_line_settings(lines.get(), offsets.data(), offsets.size(),
                                          settings.get()) != 0) {
    return nullptr;
  }
  return gpiod_chip_request_lines(chip, request.get(), lines.get());
}

gpiod_line_value ValueOf(int level) noexcept {
  return level != 0 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

}  // namespace

struct GpioRequest::Handles {
  Handles() = default;
  ~Handles() {
    gpiod_line_request_release(outputs);  // null is allowed
    gpiod_line_request_release(inputs);
  }
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;

  gpiod_line_request* inputs = nullptr;
  gpiod_line_request* outputs = nullptr;  // relay, pump
};

GpioRequest::GpioRequest(const GpiodConfig& config) : handles_(std::make_unique<Handles>()) {
  const Chip chip = OpenChip(config);
  if (chip == nullptr) Fail(config, "cannot be opened");
  const ChipInfo chip_info(gpiod_chip_get_info(chip.get()));
  if (chip_info == nullptr) Fail(config, "does not say its name");
  chip_name_ = gpiod_chip_info_get_name(chip_info.get());
  const std::vector<GpioInput> wanted = InputsOf(config);
  std::vector<unsigned> inputs;
  for (const GpioInput& input : wanted) {
    inputs.push_back(input.offset);
    CheckFree(config, chip.get(), input.offset, input.name);
  }
  const std::vector<unsigned> outputs = {static_cast<unsigned>(config.relay),
                                         static_cast<unsigned>(config.pump)};
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    CheckFree(config, chip.get(), outputs[i], kGpioOutputs[i]);
  }
  handles_->inputs =
      RequestLines(chip.get(), inputs, GPIOD_LINE_DIRECTION_INPUT, GPIOD_LINE_BIAS_PULL_DOWN);
  if (handles_->inputs == nullptr) {
    Fail(config, "the input lines cannot be requested with pull-down");
  }
  for (const GpioInput& input : wanted) {
    const LineInfo info(gpiod_chip_get_line_info(chip.get(), input.offset));
    if (info == nullptr || gpiod_line_info_get_bias(info.get()) != GPIOD_LINE_BIAS_PULL_DOWN) {
      throw HalError(NoPullDown(config, input));
    }
  }
  handles_->outputs =
      RequestLines(chip.get(), outputs, GPIOD_LINE_DIRECTION_OUTPUT, GPIOD_LINE_BIAS_AS_IS);
  if (handles_->outputs == nullptr) Fail(config, "the output lines cannot be requested");
}

GpioRequest::~GpioRequest() { static_cast<void>(Write(0, 0)); }

bool GpioRequest::Read(std::array<int, kMostGpioInputs>* levels) noexcept {
  std::array<gpiod_line_value, kMostGpioInputs> values{};
  if (gpiod_line_request_get_values(handles_->inputs, values.data()) != 0) return false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    (*levels)[i] = values[i] == GPIOD_LINE_VALUE_ACTIVE;
  }
  return true;
}

bool GpioRequest::Write(int relay, int pump) noexcept {
  const bool off = held_off_.load();
  const std::array<gpiod_line_value, 2> values = {ValueOf(off ? 0 : relay),
                                                  ValueOf(off ? 0 : pump)};
  return gpiod_line_request_set_values(handles_->outputs, values.data()) == 0;
}

}  // namespace flexarm
