#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace flexarm {

/// XXH3-64 of the bytes.
std::uint64_t Checksum64(std::string_view bytes, std::uint64_t seed);

/// XXH3-128 of bytes that come in parts.
class Digest128 {
 public:
  Digest128();
  ~Digest128();
  Digest128(const Digest128&) = delete;
  Digest128& operator=(const Digest128&) = delete;

  void Add(std::string_view bytes);
  /// 32 hexadecimal digits.
  std::string Hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace flexarm
