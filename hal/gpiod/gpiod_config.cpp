#include "hal/gpiod/gpiod_config.h"

#include <map>

#include "hal/line_names.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr int kMaxOffset = 1023;  // no chip has more lines

std::string KeyOf(Line line) {
  std::string key = ToString(line);
  for (char& c : key) {
    if (c == '-') c = '_';
  }
  return key;
}

}  // namespace

std::vector<Problem> GpiodConfig::Problems() const {
  ProblemList list("hal.gpiod.");
  list.Require(!chip.empty(), "chip", chip, "must name a GPIO chip, e.g. \"/dev/gpiochip0\"");
  std::map<int, std::string> taken;
  const auto check = [&](const std::string& key, int offset) {
    list.Require(offset >= 0 && offset <= kMaxOffset, key, std::to_string(offset),
                 "must be a line's offset on the chip, 0 to " + std::to_string(kMaxOffset));
    const auto [other, is_new] = taken.emplace(offset, key);
    list.Require(is_new, key, std::to_string(offset),
                 "must be used once: " + other->second + " uses it too");
  };
  for (int i = 0; i < kLines; ++i) {
    check(KeyOf(static_cast<Line>(i)), input[static_cast<std::size_t>(i)]);
  }
  check("relay", relay);
  check("pump", pump);
  if (relay_contact) check("relay_contact", *relay_contact);
  if (drive_voltage) {
    list.Within("drive_voltage.rise_ms", drive_voltage->rise_ms, 20.0, 1000.0,
                "from relay and pump on until every drive reports voltage; measure it");
    list.Within("drive_voltage.fall_ms", drive_voltage->fall_ms, 20.0, 30'000.0,
                "from relay and pump off until no drive reports voltage; measure it");
  }
  return list.Take();
}

}  // namespace flexarm
