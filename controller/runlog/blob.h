#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

#include "controller/types/step_types.h"

namespace flexarm {

// Records are logged as raw bytes: a version, then the struct, little-endian.
static_assert(std::endian::native == std::endian::little, "run logs are little-endian");

/// Versions of the BLOBs. Increase when the layout of the struct or the meaning of a field changes.
inline constexpr std::uint32_t kStepInputVersion = 5;
inline constexpr std::uint32_t kStepOutputVersion = 3;
static_assert(sizeof(StepInput) == 1296, "the layout changed: raise kStepInputVersion");
static_assert(sizeof(StepOutput) == 592, "the layout changed: raise kStepOutputVersion");

/// A logged struct, preceded by its version.
template <typename T>
using BlobBytes = std::array<std::byte, sizeof(std::uint32_t) + sizeof(T)>;

/// Version, then the bytes of the struct.
template <typename T>
BlobBytes<T> EncodeBlob(std::uint32_t version, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  BlobBytes<T> bytes;
  std::memcpy(bytes.data(), &version, sizeof version);
  std::memcpy(bytes.data() + sizeof version, &value, sizeof value);
  return bytes;
}

/// @returns the error in the bytes; empty if none, and only then `value` is set
template <typename T>
std::string DecodeBlob(std::span<const std::byte> bytes, std::uint32_t version, T* value) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::uint32_t found = 0;
  if (bytes.size() >= sizeof found) std::memcpy(&found, bytes.data(), sizeof found);
  if (bytes.size() >= sizeof found && found != version) {
    return "has version " + std::to_string(found) + ", expected " + std::to_string(version);
  }
  if (bytes.size() != sizeof(BlobBytes<T>)) {
    return "has " + std::to_string(bytes.size()) + " bytes, expected " +
           std::to_string(sizeof(BlobBytes<T>));
  }
  std::memcpy(value, bytes.data() + sizeof found, sizeof *value);
  return {};
}

/// True if both have the same bytes: -0.0 differs from 0.0, and NaN equals itself.
template <typename T>
bool SameBytes(const T& a, const T& b) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace flexarm
