// The functions of the first generation of libgpiod that gpio_request_v1.cpp calls.
#include <gpiod.h>

#include <cerrno>
#include <string>

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
struct gpiod_line {
  std::size_t offset;
  bool up_to_date;
};

namespace {

gpiod_chip opened;
std::array<gpiod_line, FakeChip::kLines> lines;

}  // namespace

gpiod_chip* gpiod_chip_open_lookup(const char* wanted) {
  if (TheChip().name == wanted || "/dev/" + TheChip().name == wanted) return &opened;
  errno = ENOENT;
  return nullptr;
}
void gpiod_chip_close(gpiod_chip*) { TheChip().held = {}; }
const char* gpiod_chip_name(gpiod_chip*) { return TheChip().name.c_str(); }

gpiod_line* gpiod_chip_get_line(gpiod_chip*, unsigned offset) {
  if (offset >= lines.size()) return nullptr;
  lines[offset] = {.offset = offset, .up_to_date = false};
  return &lines[offset];
}
bool gpiod_line_is_used(gpiod_line* line) { return TheChip().held[line->offset]; }
const char* gpiod_line_consumer(gpiod_line*) { return "another-program"; }
int gpiod_line_update(gpiod_line* line) {
  line->up_to_date = true;
  return 0;
}
int gpiod_line_bias(gpiod_line* line) {
  const bool shown = line->up_to_date && TheChip().reports_bias;
  return shown && TheChip().pulled_down[line->offset] ? GPIOD_LINE_BIAS_PULL_DOWN
                                                      : GPIOD_LINE_BIAS_AS_IS;
}

int gpiod_line_request_bulk_input_flags(gpiod_line_bulk* bulk, const char*, int flags) {
  const bool pull_down = (flags & GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN) != 0;
  if (pull_down && !TheChip().takes_bias) {
    errno = EINVAL;
    return -1;
  }
  for (unsigned i = 0; i < bulk->num_lines; ++i) {
    TheChip().pulled_down[bulk->lines[i]->offset] = pull_down;
    TheChip().held[bulk->lines[i]->offset] = true;
  }
  return 0;
}
int gpiod_line_request_bulk_input(gpiod_line_bulk* bulk, const char* consumer) {
  return gpiod_line_request_bulk_input_flags(bulk, consumer, 0);
}
int gpiod_line_request_bulk_output(gpiod_line_bulk* bulk, const char*, const int* values) {
  for (unsigned i = 0; i < bulk->num_lines; ++i) {
    TheChip().output[bulk->lines[i]->offset] = values[i];
    TheChip().held[bulk->lines[i]->offset] = true;
  }
  return 0;
}

int gpiod_line_get_value_bulk(gpiod_line_bulk* bulk, int* values) {
  if (!TheChip().reads) return -1;
  for (unsigned i = 0; i < bulk->num_lines; ++i) {
    values[i] = TheChip().LevelOf(bulk->lines[i]->offset);
  }
  return 0;
}
int gpiod_line_set_value_bulk(gpiod_line_bulk* bulk, const int* values) {
  if (!TheChip().writes) return -1;
  for (unsigned i = 0; i < bulk->num_lines; ++i) {
    TheChip().output[bulk->lines[i]->offset] = values[i];
  }
  return 0;
}
