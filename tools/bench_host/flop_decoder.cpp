#include "tools/bench_host/flop_decoder.h"

namespace flexarm {
namespace {

// What stands before the opcode, in the numbers that VEX and EVEX use for it.
enum class Prefix : std::uint8_t { kNone, k66, kF3, kF2 };

// Bytes of an instruction, 0 behind its end: no opcode that counts begins with that.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  std::uint8_t Next() noexcept { return at_ < bytes_.size() ? bytes_[at_++] : std::uint8_t{0}; }
  std::uint8_t Peek() const noexcept { return at_ < bytes_.size() ? bytes_[at_] : std::uint8_t{0}; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

// Opcodes 0F xx, in a register of `bytes` bytes.
int ArithmeticFlops(std::uint8_t opcode, Prefix prefix, int bytes) noexcept {
  const bool doubles = prefix == Prefix::k66;
  switch (opcode) {
    case 0x51:  // square root
    case 0x58:  // sum
    case 0x59:  // product
    case 0x5C:  // difference
    case 0x5E:  // quotient
      if (prefix == Prefix::kF2 || prefix == Prefix::kF3) return 1;
      return bytes / (doubles ? 8 : 4);
    case 0x7C:  // sums and differences of neighbours
    case 0x7D:
    case 0xD0:  // difference and sum in turn
      if (doubles) return bytes / 8;
      return prefix == Prefix::kF2 ? bytes / 4 : 0;
    default:
      return 0;
  }
}

// Opcodes 0F 38 xx: fused products and sums, in a register of `bytes` bytes.
int FusedFlops(std::uint8_t opcode, Prefix prefix, bool wide, int bytes) noexcept {
  const int row = opcode >> 4, column = opcode & 0xF;
  if (prefix != Prefix::k66 || row < 9 || row > 0xB || column < 6) return 0;
  const bool scalar = column >= 8 && column % 2 == 1;
  return 2 * (scalar ? 1 : bytes / (wide ? 8 : 4));
}

int Flops(int map, std::uint8_t opcode, Prefix prefix, bool wide, int bytes) noexcept {
  if (map == 1) return ArithmeticFlops(opcode, prefix, bytes);
  return map == 2 ? FusedFlops(opcode, prefix, wide, bytes) : 0;
}

Prefix PrefixOf(std::uint8_t byte) noexcept { return static_cast<Prefix>(byte & 3); }

int VexFlops(Bytes& in, bool long_form) noexcept {
  const int map = long_form ? in.Next() & 0x1F : 1;
  const std::uint8_t last = in.Next();
  const bool wide = long_form && (last & 0x80) != 0;
  return Flops(map, in.Next(), PrefixOf(last), wide, (last & 4) != 0 ? 32 : 16);
}

int EvexFlops(Bytes& in) noexcept {
  const int map = in.Next() & 7;
  const std::uint8_t second = in.Next(), third = in.Next(), opcode = in.Next();
  const bool rounds = (third & 0x10) != 0 && in.Peek() >= 0xC0;  // registers only: 64 bytes
  const int bytes = rounds ? 64 : 16 << (third >> 5 & 3);
  return Flops(map, opcode, PrefixOf(second), (second & 0x80) != 0, bytes);
}

// The x87 unit, which computes long double.
int OldFlops(std::uint8_t opcode, std::uint8_t operand) noexcept {
  if (opcode == 0xD9) return operand == 0xFA ? 1 : 0;  // fsqrt
  if (opcode % 2 != 0) return 0;                       // moves
  const int operation = operand >> 3 & 7;
  const bool compares = operation == 2 || operation == 3;
  const bool conditional = opcode == 0xDA && operand >= 0xC0;  // moves
  return compares || conditional ? 0 : 1;
}

}  // namespace

int FlopsOf(std::span<const std::uint8_t> instruction) noexcept {
  Bytes in(instruction);
  Prefix prefix = Prefix::kNone;
  for (std::size_t i = 0; i < kLongestInstruction; ++i) {
    const std::uint8_t byte = in.Next();
    if (byte == 0xF2 || byte == 0xF3) {
      prefix = byte == 0xF2 ? Prefix::kF2 : Prefix::kF3;
    } else if (byte == 0x66) {
      if (prefix == Prefix::kNone) prefix = Prefix::k66;
    } else if (byte == 0xC5 || byte == 0xC4) {
      return VexFlops(in, byte == 0xC4);
    } else if (byte == 0x62) {
      return EvexFlops(in);
    } else if (byte >= 0xD8 && byte <= 0xDF) {
      return OldFlops(byte, in.Next());
    } else if (byte == 0x0F) {
      const std::uint8_t opcode = in.Next();
      return ArithmeticFlops(opcode, prefix, 16);
    } else {
      const bool rex = (byte & 0xF0) == 0x40;
      const bool segment = byte == 0x2E || byte == 0x36 || byte == 0x3E || byte == 0x26 ||
                           byte == 0x64 || byte == 0x65;
      const bool lock_or_address = byte == 0x67 || byte == 0xF0;
      if (!rex && !segment && !lock_or_address) return 0;
    }
  }
  return 0;
}

}  // namespace flexarm
