#include "hal/emulation/drive_supply.h"

namespace flexarm {

void DriveSupply::Feed(bool fed, std::int64_t now_ns) noexcept {
  if (fed == fed_) return;
  fed_ = fed;
  since_ns_ = now_ns;
}

bool DriveSupply::up(std::int64_t now_ns) const noexcept {
  return fed_ ? now_ns - since_ns_ >= model_.charge_ns : now_ns - since_ns_ < model_.discharge_ns;
}

std::optional<std::uint16_t> DriveSupply::Emergency(std::int64_t now_ns) noexcept {
  const bool off = model_.safe_torque_off && !fed_;  // at once; the DC link takes its time
  if (up(now_ns) && !off) reported_ = false;
  if ((up(now_ns) && !off) || reported_) return std::nullopt;
  reported_ = true;
  return off ? kSafeTorqueOff : kUndervoltage;
}

}  // namespace flexarm
