#include "controller/latch/latch_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "controller/runlog/errors.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

const LatchRecord kArmedRecord{.time_utc = "2026-11-20T13:45:06Z",
                               .log_directory = "/var/lib/flexarm"};

LatchRecord Tripped(TripCause cause) {
  LatchRecord record = kArmedRecord;
  record.cause = cause;
  record.evidence = {.value = 0.1 + 0.2, .limit = -1.0 / 3.0, .channel = 2, .detail = 0xFFFFFFFFu};
  return record;
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string ProblemOf(const std::string& text) {
  return MessageOf<InputError>([&] { ParseLatch(text); });
}

TEST(LatchRecord, EveryCauseIsReadAsItWasWritten) {
  for (int number = 1; number < kTripCauses; ++number) {
    const LatchRecord record = Tripped(static_cast<TripCause>(number));
    const LatchRecord read = ParseLatch(LatchText(record));
    EXPECT_EQ(read.cause, record.cause);
    EXPECT_EQ(read.evidence.value, record.evidence.value) << "to the bit";
    EXPECT_EQ(read.evidence.limit, record.evidence.limit);
    EXPECT_EQ(read.evidence.channel, 2u);
    EXPECT_EQ(read.evidence.detail, 0xFFFFFFFFu);
    EXPECT_EQ(read.time_utc, record.time_utc);
    EXPECT_EQ(read.log_directory, record.log_directory);
  }
  EXPECT_EQ(ParseLatch(LatchText(kArmedRecord)).cause, TripCause::kNone);
}

TEST(LatchRecord, PeopleCanReadIt) {
  const std::string text = LatchText(Tripped(TripCause::kSoftLimit2));
  EXPECT_THAT(text, HasSubstr("\"soft-limit-2\""));
  EXPECT_THAT(text, HasSubstr("limits.soft_angle_deg")) << "what happened";
  LatchRecord record = kArmedRecord;
  record.log_directory = "/Messungen/März";
  EXPECT_THAT(LatchText(record), HasSubstr("/Messungen/März"));
}

TEST(LatchRecord, AValueThatIsNoNumberStaysNone) {
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    LatchRecord record = Tripped(TripCause::kStateNotFinite);
    record.evidence.value = value;
    EXPECT_TRUE(std::isnan(ParseLatch(LatchText(record)).evidence.value));
  }
}

TEST(LatchRecord, ATruncatedTextIsRefusedAtEveryLength) {
  for (const LatchRecord& record : {kArmedRecord, Tripped(TripCause::kBusLost)}) {
    const std::string text = LatchText(record);
    ASSERT_EQ(text.back(), '\n');
    for (std::size_t length = 0; length + 1 < text.size(); ++length) {
      EXPECT_NE(ProblemOf(text.substr(0, length)), "") << length;
    }
  }
}

TEST(LatchRecord, WhatTheDaemonCannotHaveWrittenIsRefused) {
  const std::string text = LatchText(Tripped(TripCause::kSoftLimit2));
  EXPECT_THAT(ProblemOf(""), HasSubstr("JSON object"));
  EXPECT_THAT(ProblemOf("[]"), HasSubstr("JSON object"));
  EXPECT_THAT(ProblemOf(std::string(4096, '\0')), HasSubstr("JSON object"));
  EXPECT_THAT(ProblemOf(text + text), HasSubstr("JSON object"));
  EXPECT_THAT(ProblemOf("{}"), HasSubstr("'flexarm'"));
  EXPECT_THAT(ProblemOf(Replaced(text, "safety-latch", "calibration")), HasSubstr("calibration"));
  EXPECT_THAT(ProblemOf(Replaced(text, "\"version\": 1", "\"version\": 2")),
              HasSubstr("expected version 1, not 2"));
  EXPECT_THAT(ProblemOf(Replaced(text, "\"tripped\"", "\"well\"")), HasSubstr("'state'"));
  EXPECT_THAT(ProblemOf(Replaced(text, "soft-limit-2", "soft-limit-3")), HasSubstr("soft-limit-3"));
  EXPECT_THAT(ProblemOf(Replaced(text, "soft-limit-2", "none")), HasSubstr("none"));
  const char* corrupted = ToString(static_cast<TripCause>(kTripCauses));
  EXPECT_THAT(ProblemOf(Replaced(text, "soft-limit-2", corrupted)), HasSubstr(corrupted));
  EXPECT_THAT(ProblemOf(Replaced(text, "\"channel\": 2", "\"channel\": -2")),
              HasSubstr("'channel'"));
  EXPECT_THAT(ProblemOf(Replaced(text, "4294967295", "4294967296")), HasSubstr("'detail'"));
  EXPECT_THAT(ProblemOf(Replaced(text, "\"value\"", "\"worth\"")), HasSubstr("'value'"));
  EXPECT_THAT(ProblemOf(Replaced(text, "\"2026-11-20T13:45:06Z\"", "3")), HasSubstr("'time_utc'"));
}

}  // namespace
}  // namespace flexarm
