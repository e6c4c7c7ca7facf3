#include "tools/dashboard/access_token.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "controller/files/input_error.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

class TokenFile : public testing::Test {
 protected:
  ~TokenFile() override { std::filesystem::remove(file_); }

  std::filesystem::path Write(const std::string& text, mode_t mode = 0600) {
    std::ofstream(file_) << text;
    chmod(file_.c_str(), mode);
    return file_;
  }
  std::string WhyRefused(const std::string& text, mode_t mode = 0600) {
    return MessageOf<InputError>([&] { AccessToken::OfFile(Write(text, mode)); });
  }

  const std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) /
      ("token-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST(AccessToken, MatchesItselfAndNothingElse) {
  const AccessToken token = AccessToken::Fresh();
  EXPECT_TRUE(token.Matches(token.text()));
  EXPECT_FALSE(token.Matches(""));
  EXPECT_FALSE(token.Matches(token.text() + "0"));
  EXPECT_FALSE(token.Matches(token.text() + token.text()));
  EXPECT_FALSE(token.Matches(token.text().substr(1)));
  for (std::size_t i = 0; i < token.text().size(); ++i) {  // also the last character counts
    std::string other = token.text();
    other[i] = other[i] == 'a' ? 'b' : 'a';
    EXPECT_FALSE(token.Matches(other)) << i;
  }
}

TEST(AccessToken, AFreshOneHas256BitsAndIsAnotherEachTime) {
  const AccessToken one = AccessToken::Fresh(), other = AccessToken::Fresh();
  EXPECT_EQ(one.text().size(), 64U);
  EXPECT_EQ(one.text().find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(one.text(), other.text());
}

TEST_F(TokenFile, ItsFirstLineIsTheToken) {
  const AccessToken token = AccessToken::OfFile(Write("abcdefghijklmnopqrst+/==\nsecond line\n"));
  EXPECT_EQ(token.text(), "abcdefghijklmnopqrst+/==");
}

TEST_F(TokenFile, OneThatOthersCanReadIsRefused) {
  const std::string good = "abcdefghijklmnopqrstuvwx\n";
  EXPECT_THAT(WhyRefused(good, 0640), HasSubstr("chmod 600"));
  EXPECT_THAT(WhyRefused(good, 0604), HasSubstr("chmod 600"));
  EXPECT_EQ(AccessToken::OfFile(Write(good, 0400)).text().size(), 24U);
}

TEST_F(TokenFile, ATokenThatIsTooShortTooLongOrOddIsRefused) {
  EXPECT_THAT(WhyRefused("0123456789012345678\n"), HasSubstr("20 to 200 characters"));
  EXPECT_THAT(WhyRefused(std::string(201, 'a')), HasSubstr("20 to 200 characters"));
  EXPECT_THAT(WhyRefused(""), HasSubstr("20 to 200 characters"));
  EXPECT_THAT(WhyRefused("01234567890123456 890\n"), HasSubstr("letters, digits"));
  EXPECT_EQ(AccessToken::OfFile(Write(std::string(200, 'a'))).text().size(), 200U);
}

TEST_F(TokenFile, WhatIsNoFileIsRefused) {
  EXPECT_THAT(MessageOf<InputError>([] { AccessToken::OfFile("/nowhere/token"); }),
              HasSubstr("No such file"));
  EXPECT_THAT(MessageOf<InputError>([] { AccessToken::OfFile("/dev/zero"); }),
              HasSubstr("is not a file"));
}

}  // namespace
}  // namespace flexarm
