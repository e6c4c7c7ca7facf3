#include "tools/bench_host/flop_decoder.h"

#include <gtest/gtest.h>

#include <vector>

namespace flexarm {
namespace {

struct Coded {
  const char* text;
  std::vector<std::uint8_t> bytes;
  int flops;
};

void Expect(const std::vector<Coded>& instructions) {
  for (const Coded& coded : instructions)
    EXPECT_EQ(FlopsOf(coded.bytes), coded.flops) << coded.text;
}

// Bytes by GNU as 2.40 (objdump -d).
TEST(FlopDecoder, CountsTheLanesOfSse) {
  Expect({{"addsd xmm0, xmm1", {0xF2, 0x0F, 0x58, 0xC1}, 1},
          {"mulsd xmm8, xmm9", {0xF2, 0x45, 0x0F, 0x59, 0xC1}, 1},
          {"subss xmm0, xmm1", {0xF3, 0x0F, 0x5C, 0xC1}, 1},
          {"divpd xmm0, xmm1", {0x66, 0x0F, 0x5E, 0xC1}, 2},
          {"mulps xmm0, xmm1", {0x0F, 0x59, 0xC1}, 4},
          {"sqrtsd xmm0, xmm0", {0xF2, 0x0F, 0x51, 0xC0}, 1},
          {"haddpd xmm0, xmm1", {0x66, 0x0F, 0x7C, 0xC1}, 2},
          {"addsubps xmm0, xmm1", {0xF2, 0x0F, 0xD0, 0xC1}, 4}});
}

TEST(FlopDecoder, CountsTheLanesOfAvx) {
  Expect({{"vaddsd xmm0, xmm1, xmm2", {0xC5, 0xF3, 0x58, 0xC2}, 1},
          {"vmulpd ymm0, ymm1, ymm2", {0xC5, 0xF5, 0x59, 0xC2}, 4},
          {"vsubpd ymm8, ymm9, [rax+r9*8]", {0xC4, 0x21, 0x35, 0x5C, 0x04, 0xC8}, 4},
          {"vfmadd213pd ymm0, ymm1, ymm2", {0xC4, 0xE2, 0xF5, 0xA8, 0xC2}, 8},
          {"vfnmadd231sd xmm0, xmm1, xmm2", {0xC4, 0xE2, 0xF1, 0xBD, 0xC2}, 2},
          {"vaddpd zmm0, zmm1, zmm2", {0x62, 0xF1, 0xF5, 0x48, 0x58, 0xC2}, 8},
          {"vfmadd132pd zmm0, zmm1, zmm2", {0x62, 0xF2, 0xF5, 0x48, 0x98, 0xC2}, 16},
          {"vaddpd zmm0, zmm1, zmm2, {rn-sae}", {0x62, 0xF1, 0xF5, 0x18, 0x58, 0xC2}, 8}});
}

TEST(FlopDecoder, CountsTheOldUnit) {
  Expect({{"fadd qword [rax]", {0xDC, 0x00}, 1},
          {"fmulp st1, st0", {0xDE, 0xC9}, 1},
          {"fsqrt", {0xD9, 0xFA}, 1},
          {"fcomp st1", {0xD8, 0xD9}, 0},
          {"fcmovb st0, st1", {0xDA, 0xC1}, 0},
          {"fld tbyte [rax]", {0xDB, 0x28}, 0}});
}

TEST(FlopDecoder, CountsNothingElse) {
  Expect({{"movsd xmm0, [rax]", {0xF2, 0x0F, 0x10, 0x00}, 0},
          {"ucomisd xmm0, xmm1", {0x66, 0x0F, 0x2E, 0xC1}, 0},
          {"maxsd xmm0, xmm1", {0xF2, 0x0F, 0x5F, 0xC1}, 0},
          {"cvtsi2sd xmm0, eax", {0xF2, 0x0F, 0x2A, 0xC0}, 0},
          {"xorpd xmm0, xmm0", {0x66, 0x0F, 0x57, 0xC0}, 0},
          {"vxorps xmm0, xmm0, xmm0", {0xC5, 0xF8, 0x57, 0xC0}, 0},
          {"add eax, 0x58590f", {0x05, 0x0F, 0x59, 0x58, 0x00}, 0},
          {"cut short", {0xF2, 0x0F}, 0},
          {"nothing", {}, 0}});
}

}  // namespace
}  // namespace flexarm
