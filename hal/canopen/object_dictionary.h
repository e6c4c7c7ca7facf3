#pragma once

#include <cstdint>

namespace flexarm {

/// An object of a CANopen node: index and sub-index.
struct CanopenObject {
  std::uint16_t index;
  std::uint8_t sub;

  friend bool operator==(const CanopenObject&, const CanopenObject&) = default;
};

/// Objects that the driver uses: CiA 301 (1000h..1AFFh), CiA 402 and CiA 406 (6000h..).
inline constexpr CanopenObject kObjectDeviceType{0x1000,
                                                 0};  ///< low 16 bits: number of the profile
inline constexpr CanopenObject kObjectConsumerHeartbeat{0x1016, 1};  ///< node id << 16 | time in ms
inline constexpr CanopenObject kObjectProducerHeartbeat{0x1017, 0};  ///< ms, 0: none (the default)
inline constexpr CanopenObject kObjectVendor{0x1018, 1};
inline constexpr CanopenObject kObjectProduct{0x1018, 2};
inline constexpr CanopenObject kObjectSerial{0x1018, 4};
inline constexpr std::uint16_t kObjectRpdoCommunication = 0x1400;
inline constexpr std::uint16_t kObjectRpdoMapping = 0x1600;
inline constexpr std::uint16_t kObjectTpdoCommunication = 0x1800;
inline constexpr std::uint16_t kObjectTpdoMapping = 0x1A00;
inline constexpr CanopenObject kObjectEncoderPosition{0x6004, 0};  ///< CiA 406, unsigned 32
inline constexpr CanopenObject kObjectAbortConnection{
    0x6007, 0};  ///< the drive's reaction to a lost connection
inline constexpr CanopenObject kObjectControlword{0x6040, 0};
inline constexpr CanopenObject kObjectStatusword{0x6041, 0};
inline constexpr CanopenObject kObjectMode{0x6060, 0};          ///< requested mode of operation
inline constexpr CanopenObject kObjectModeDisplay{0x6061, 0};   ///< active mode of operation
inline constexpr CanopenObject kObjectPosition{0x6064, 0};      ///< actual, integer 32, counts
inline constexpr CanopenObject kObjectTargetTorque{0x6071, 0};  ///< integer 16, per mille of rated
inline constexpr CanopenObject kObjectMaxTorque{0x6072, 0};     ///< unsigned 16, per mille of rated
inline constexpr CanopenObject kObjectRatedTorque{0x6076, 0};   ///< unsigned 32, mN m of the motor
inline constexpr CanopenObject kObjectActualTorque{0x6077, 0};  ///< integer 16, per mille of rated
inline constexpr CanopenObject kObjectPeriodMantissa{0x60C2, 1};
inline constexpr CanopenObject kObjectPeriodExponent{0x60C2, 2};  ///< integer 8: 10^n s
inline constexpr CanopenObject kObjectSupportedModes{0x6502, 0};

inline constexpr std::uint32_t kCyclicTorqueMode = 10;                   ///< for 6060 and 6061
inline constexpr std::uint32_t kCyclicTorqueSupported = 1U << 9;         ///< bit of 6502
inline constexpr std::uint32_t kDisableVoltageOnAbort = 2;               ///< for 6007
inline constexpr std::uint32_t kPdoDisabled = 1U << 31;                  ///< bit of a PDO's COB id
inline constexpr std::uint32_t kPdoIdMask = kPdoDisabled | 0x3FF'FFFFU;  ///< without the RTR bit
inline constexpr std::uint32_t kOnEverySync = 1;                         ///< transmission type

/// Entry of a PDO's mapping: index, sub-index and length in bits.
constexpr std::uint32_t MappingEntry(CanopenObject mapped, int bits) noexcept {
  return std::uint32_t{mapped.index} << 16U | std::uint32_t{mapped.sub} << 8U |
         static_cast<std::uint32_t>(bits);
}

}  // namespace flexarm
