#include "controller/files/external_text.h"

#include <gtest/gtest.h>

#include "controller/files/utf8.h"

namespace flexarm {
namespace {

TEST(ExternalText, PrintableTextStays) {
  EXPECT_EQ(Shown(""), "");
  EXPECT_EQ(Shown("rig 1: \"a\" \\ ~"), "rig 1: \"a\" \\ ~");
  EXPECT_EQ(Shown("\xC3\xA4\xE2\x82\xAC\xF0\x9F\xA4\x96"), "\xC3\xA4\xE2\x82\xAC\xF0\x9F\xA4\x96");
}

TEST(ExternalText, ControlCharactersAreShownAsNumbers) {
  EXPECT_EQ(Shown("\x1B[31mred\x7F"), "\\x1b[31mred\\x7f");
  EXPECT_EQ(Shown("a\nb\tc\r"), "a\\nb\\tc\\x0d");
  EXPECT_EQ(Shown(std::string("\0", 1)), "\\x00");
  EXPECT_EQ(Shown("\xC2\x9B"), "\\xc2\\x9b") << "the one-character form of ESC [";
  EXPECT_EQ(Shown("\xE2\x80\xAE"), "\\xe2\\x80\\xae") << "right-to-left override";
  EXPECT_EQ(Shown("\xE2\x81\xA9"), "\\xe2\\x81\\xa9") << "pop directional isolate";
}

TEST(ExternalText, BytesThatAreNoUtf8AreShownAsNumbers) {
  EXPECT_EQ(Shown("\xFFz"), "\\xffz");
  EXPECT_EQ(Shown("\xC3"), "\\xc3");
  EXPECT_EQ(Shown("\xC0\xAF"), "\\xc0\\xaf") << "overlong";
  EXPECT_EQ(Shown("\xED\xA0\x80"), "\\xed\\xa0\\x80") << "surrogate";
  EXPECT_EQ(Shown("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond U+10FFFF";
}

TEST(ExternalText, ALongTextIsCutBetweenCharacters) {
  EXPECT_EQ(Shown(std::string(60, 'x')), std::string(60, 'x'));
  EXPECT_EQ(Shown(std::string(61, 'x')), std::string(60, 'x') + "...");
  EXPECT_EQ(Shown("ab\xC3\xA4", 3), "ab...");
  EXPECT_EQ(Shown("ab\x01", 5), "ab...");
}

TEST(ExternalText, AMessageKeepsItsLinesAndNothingElse) {
  EXPECT_EQ(ShownMessage("a: b\n\x1B: c\n"), "a: b\n\\x1b: c\n");
  const std::string message = ShownMessage(std::string(10'000, 'x') + "\ny");
  EXPECT_EQ(message, std::string(kMessageBytes, 'x') + "...\ny");
}

// Every byte alone and every pair of bytes: the result is printable UTF-8.
TEST(ExternalText, NoInputOfTwoBytesGivesAnythingElseThanText) {
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const std::string shown =
          Shown(std::string{static_cast<char>(first), static_cast<char>(second)});
      for (std::string_view rest = shown; !rest.empty();) {
        const std::size_t length = Utf8Length(rest);
        ASSERT_GT(length, 0U) << first << ' ' << second;
        ASSERT_GE(static_cast<unsigned char>(rest[0]), 0x20) << first << ' ' << second;
        ASSERT_NE(rest[0], '\x7F') << first << ' ' << second;
        rest.remove_prefix(length);
      }
    }
  }
}

}  // namespace
}  // namespace flexarm
