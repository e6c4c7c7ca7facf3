#pragma once

#include <cstdint>
#include <optional>

namespace flexarm {

/// Times of a simulated drive whose intermediate circuit (DC link) is fed through the rig's relay.
struct DriveSupplyModel {
  std::int64_t charge_ns = 300'000'000;   ///< from the closed relay until the DC link is up
  std::int64_t discharge_ns = 2'000'000;  ///< from the open relay until it is too low
  std::int64_t enable_ns = 200'000'000;   ///< from "switched on" until the brake is released
  bool safe_torque_off = false;  ///< the relay feeds the STO input too, which reports itself first
  bool clears_itself = false;    ///< the drive leaves the fault when the DC link is up again
};

/// The DC link of a simulated drive, and what the drive reports of it: an emergency as soon as it
/// is too low, whatever the state of the drive, and again after each boot-up without it. Real-time:
/// safe.
class DriveSupply {
 public:
  static constexpr std::uint16_t kUndervoltage = 0x3220;
  static constexpr std::uint16_t kSafeTorqueOff = 0xFF01;

  explicit DriveSupply(const DriveSupplyModel& model) : model_(model) {}

  const DriveSupplyModel& model() const noexcept { return model_; }
  /// The relay feeds the DC link, from now on.
  void Feed(bool fed, std::int64_t now_ns) noexcept;
  /// The drive has booted: it reports its DC link again.
  void Boot() noexcept { reported_ = false; }
  bool up(std::int64_t now_ns) const noexcept;
  /// Code of the emergency that is due now, once.
  std::optional<std::uint16_t> Emergency(std::int64_t now_ns) noexcept;

 private:
  DriveSupplyModel model_;
  bool fed_ = false;
  std::int64_t since_ns_ = INT64_MIN / 2;  // of `fed_`
  bool reported_ = false;                  // that it is too low
};

}  // namespace flexarm
