#include "controller/files/external_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "controller/files/input_error.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

std::string ParseRefusal(const std::string& text) {
  return MessageOf<InputError>([&] { ParseJson(text, "f.json", "a calibration"); });
}

TEST(ExternalJson, ADamagedTextIsRefusedWithItsLine) {
  EXPECT_EQ(ParseJson("{\"a\": [1]}", "f", "x")["a"][0].get<int>(), 1);
  EXPECT_EQ(ParseRefusal("{\n\"a\": 1,,\n}"), "f.json:2: is not JSON; expected a calibration");
  EXPECT_EQ(ParseRefusal(""), "f.json:1: is not JSON; expected a calibration");
  EXPECT_EQ(ParseRefusal("{\n\"a\": 1e999}"), "f.json:2: is not JSON; expected a calibration");
  EXPECT_EQ(ParseRefusal("\"\xFF\""), "f.json:1: is not JSON; expected a calibration");
}

TEST(ExternalJson, AMemberOfAnotherTypeIsNamedWithWhatItIs) {
  const Json json = Json::parse(R"({"n": 1.5, "s": "t", "b": true, "a": [1], "z": null})");
  EXPECT_EQ(JsonNumber(json, "n", "f"), 1.5);
  EXPECT_EQ(JsonText(json, "s", "f"), "t");
  EXPECT_TRUE(JsonBool(json, "b", "f"));
  EXPECT_EQ(JsonArray(json, "a", "f").size(), 1U);
  const auto refused = [](const auto& take) { return MessageOf<InputError>(take); };
  EXPECT_EQ(refused([&] { JsonNumber(json, "s", "f"); }), "f: 's': found \"t\", expected a number");
  EXPECT_EQ(refused([&] { JsonNumber(json, "z", "f"); }), "f: 'z': found null, expected a number");
  EXPECT_EQ(refused([&] { JsonNumber(json, "q", "f"); }),
            "f: 'q': found nothing, expected a number");
  EXPECT_EQ(refused([&] { JsonNumber(Json(3), "q", "f"); }),
            "f: 'q': found nothing, expected a number");
  EXPECT_EQ(refused([&] { JsonWhole(json, "n", "f"); }),
            "f: 'n': found 1.5, expected a whole number");
  EXPECT_EQ(refused([&] { JsonText(json, "a", "f"); }), "f: 'a': found [1], expected a text");
  EXPECT_EQ(refused([&] { JsonBool(json, "n", "f"); }),
            "f: 'n': found 1.5, expected true or false");
  EXPECT_EQ(refused([&] { JsonArray(json, "n", "f"); }), "f: 'n': found 1.5, expected an array");
}

TEST(ExternalJson, AWholeNumberBeyond63BitsIsRefusedAndNotWrapped) {
  const Json json = Json::parse(R"({"n": 18446744073709551615, "m": -9223372036854775808})");
  EXPECT_EQ(JsonWhole(json, "m", "f"), INT64_MIN);
  EXPECT_THROW(JsonWhole(json, "n", "f"), InputError);
}

TEST(ExternalJson, WhatIsPrintedIsAsciiAndTheSameJson) {
  const Json json{{"k", "\x1B[31m\x7F\xC2\x9B \xC3\xA4"}, {"n", 1.5}};
  const std::string text = PrintedJson(json);
  EXPECT_EQ(Json::parse(text), json);
  for (const char c : text) EXPECT_TRUE(c == '\n' || (c >= ' ' && c < '\x7F')) << text;
  EXPECT_EQ(PrintedJson("\xFF"), "\"\\ufffd\"");
}

TEST(ExternalJson, TheMessageNeverHasBytesOfTheFile) {
  const Json json{{"k", "\x1B[31m\xFF" + std::string(1000, 'x')}};
  const std::string message = MessageOf<InputError>([&] { JsonNumber(json, "k", "f"); });
  EXPECT_LT(message.size(), 120U);
  EXPECT_EQ(message.find('\x1B'), std::string::npos);
}

}  // namespace
}  // namespace flexarm
