#include "controller/runlog/checksum.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <cinttypes>
#include <cstdio>

namespace flexarm {

// xxHash aligns its state to 64 bytes, and so does `new` of this type.
struct Digest128::State {
  XXH3_state_t hash;
};

std::uint64_t Checksum64(std::string_view bytes, std::uint64_t seed) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

Digest128::Digest128() : state_(std::make_unique<State>()) { XXH3_128bits_reset(&state_->hash); }

Digest128::~Digest128() = default;

void Digest128::Add(std::string_view bytes) {
  XXH3_128bits_update(&state_->hash, bytes.data(), bytes.size());
}

std::string Digest128::Hex() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(&state_->hash);
  std::array<char, 33> text;
  std::snprintf(text.data(), text.size(), "%016" PRIx64 "%016" PRIx64, hash.high64, hash.low64);
  return text.data();
}

}  // namespace flexarm
