#include "controller/files/failure_text.h"

#include <gtest/gtest.h>

#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace flexarm {
namespace {

template <typename Body>
std::string TextOf(const Body& body) {
  try {
    body();
  } catch (const std::exception& error) {
    return FailureText(error);
  }
  return "nothing was thrown";
}

TEST(FailureText, NoTextOfALibraryReachesTheUser) {
  EXPECT_EQ(TextOf([] { static_cast<void>(nlohmann::json("a").get<double>()); }),
            "found a JSON value of another type than expected");
  EXPECT_EQ(TextOf([] { EXPECT_TRUE(nlohmann::json::parse("{").is_null()); }),
            "found a JSON value of another type than expected");
  EXPECT_EQ(TextOf([] { throw std::bad_alloc(); }), "there is not enough memory for this");
}

TEST(FailureText, OurOwnTextStaysButForControlCharacters) {
  EXPECT_EQ(TextOf([] { throw std::runtime_error("a: \x1B[1m\nb"); }), "a: \\x1b[1m\nb");
}

}  // namespace
}  // namespace flexarm
