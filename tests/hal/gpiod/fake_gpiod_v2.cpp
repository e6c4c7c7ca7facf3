// The functions of the second generation of libgpiod that gpio_request_v2.cpp calls.
#include <gpiod.h>

#include <cerrno>
#include <string>
#include <vector>

#include "tests/hal/gpiod/fake_chip.h"

namespace flexarm {

FakeChip& TheChip() {
  static FakeChip chip;
  return chip;
}

}  // namespace flexarm

using flexarm::FakeChip;
using flexarm::TheChip;

struct gpiod_chip {};
struct gpiod_chip_info {};
struct gpiod_request_config {};
struct gpiod_line_info {
  std::size_t offset;
};
struct gpiod_line_settings {
  gpiod_line_direction direction = GPIOD_LINE_DIRECTION_AS_IS;
  gpiod_line_bias bias = GPIOD_LINE_BIAS_AS_IS;
  gpiod_line_value value = GPIOD_LINE_VALUE_INACTIVE;
};
struct gpiod_line_config {
  std::vector<unsigned> offsets;
  gpiod_line_settings settings;
};
struct gpiod_line_request {
  std::vector<unsigned> offsets;
};

bool gpiod_is_gpiochip_device(const char* path) { return "/dev/" + TheChip().name == path; }
gpiod_chip* gpiod_chip_open(const char* path) {
  if (gpiod_is_gpiochip_device(path)) return new gpiod_chip;
  errno = ENOENT;
  return nullptr;
}
void gpiod_chip_close(gpiod_chip* chip) { delete chip; }
gpiod_chip_info* gpiod_chip_get_info(gpiod_chip*) { return new gpiod_chip_info; }
void gpiod_chip_info_free(gpiod_chip_info* info) { delete info; }
const char* gpiod_chip_info_get_name(gpiod_chip_info*) { return TheChip().name.c_str(); }
const char* gpiod_chip_info_get_label(gpiod_chip_info*) { return "label"; }

gpiod_line_info* gpiod_chip_get_line_info(gpiod_chip*, unsigned offset) {
  return offset < FakeChip::kLines ? new gpiod_line_info{offset} : nullptr;
}
void gpiod_line_info_free(gpiod_line_info* info) { delete info; }
bool gpiod_line_info_is_used(gpiod_line_info* info) { return TheChip().held[info->offset]; }
const char* gpiod_line_info_get_consumer(gpiod_line_info*) { return "another-program"; }
gpiod_line_bias gpiod_line_info_get_bias(gpiod_line_info* info) {
  return TheChip().reports_bias && TheChip().pulled_down[info->offset] ? GPIOD_LINE_BIAS_PULL_DOWN
                                                                       : GPIOD_LINE_BIAS_UNKNOWN;
}

gpiod_line_settings* gpiod_line_settings_new() { return new gpiod_line_settings; }
void gpiod_line_settings_free(gpiod_line_settings* settings) { delete settings; }
int gpiod_line_settings_set_direction(gpiod_line_settings* settings, gpiod_line_direction to) {
  settings->direction = to;
  return 0;
}
int gpiod_line_settings_set_bias(gpiod_line_settings* settings, gpiod_line_bias to) {
  settings->bias = to;
  return 0;
}
int gpiod_line_settings_set_output_value(gpiod_line_settings* settings, gpiod_line_value to) {
  settings->value = to;
  return 0;
}
gpiod_line_config* gpiod_line_config_new() { return new gpiod_line_config; }
void gpiod_line_config_free(gpiod_line_config* config) { delete config; }
int gpiod_line_config_add_line_settings(gpiod_line_config* config, const unsigned* offsets,
                                        std::size_t count, gpiod_line_settings* settings) {
  config->offsets.assign(offsets, offsets + count);
  config->settings = *settings;
  return 0;
}
gpiod_request_config* gpiod_request_config_new() { return new gpiod_request_config; }
void gpiod_request_config_free(gpiod_request_config* config) { delete config; }
void gpiod_request_config_set_consumer(gpiod_request_config*, const char*) {}

gpiod_line_request* gpiod_chip_request_lines(gpiod_chip*, gpiod_request_config*,
                                             gpiod_line_config* config) {
  const bool pull_down = config->settings.bias == GPIOD_LINE_BIAS_PULL_DOWN;
  if (pull_down && !TheChip().takes_bias) {
    errno = EINVAL;
    return nullptr;
  }
  for (const unsigned offset : config->offsets) {
    TheChip().held[offset] = true;
    if (config->settings.direction == GPIOD_LINE_DIRECTION_INPUT) {
      TheChip().pulled_down[offset] = pull_down;
    } else {
      TheChip().output[offset] = config->settings.value == GPIOD_LINE_VALUE_ACTIVE ? 1 : 0;
    }
  }
  return new gpiod_line_request{config->offsets};
}
void gpiod_line_request_release(gpiod_line_request* request) {
  if (request == nullptr) return;
  for (const unsigned offset : request->offsets) TheChip().held[offset] = false;
  delete request;
}
int gpiod_line_request_get_values(gpiod_line_request* request, gpiod_line_value* values) {
  if (!TheChip().reads) return -1;
  for (const unsigned offset : request->offsets) {
    *values++ =
        TheChip().LevelOf(offset) != 0 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  }
  return 0;
}
int gpiod_line_request_set_values(gpiod_line_request* request, const gpiod_line_value* values) {
  if (!TheChip().writes) return -1;
  for (const unsigned offset : request->offsets) {
    TheChip().output[offset] = *values++ == GPIOD_LINE_VALUE_ACTIVE ? 1 : 0;
  }
  return 0;
}
