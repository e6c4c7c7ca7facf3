#include "controller/latch/trip_latch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "tests/controller/latch/latch_folder.h"
#include "tests/controller/latch/sync_calls.h"

namespace flexarm {
namespace {

using enum SafetyState;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kFile = TripLatch::kFile;
constexpr Evidence kEvidence{.value = 1.6, .limit = 1.5, .channel = 2, .detail = 0};
constexpr std::int64_t kPeriodNs = 20'000'000;

class TripLatchTest : public testing::Test {
 protected:
  // The daemon starts, after the one before was killed. @returns the trip in which it starts
  std::optional<HeldTrip> Restart() {
    latch_.reset();
    journal_.clear();
    latch_ = std::make_unique<TripLatch>(
        there_.path(), "/runs", [this](bool is_error, const std::string& text) {
          journal_.push_back((is_error ? "error: " : "info: ") + text);
        });
    return latch_->Open();
  }

  static Permit In(SafetyState state, TripCause cause = TripCause::kSoftLimit2) {
    Permit permit = kNoPermit;
    permit.state = state;
    if (!CauseLatched(state)) return permit;
    permit.cause = cause;
    const bool of_start =
        cause == TripCause::kEndedWhileArmed || cause == TripCause::kTripRecordUnreadable;
    permit.evidence = of_start ? Evidence{} : kEvidence;
    return permit;
  }

  void Follow(const Permit& permit, bool awaiting = false) {
    latch_->Follow(now_ns_ += kPeriodNs, permit, awaiting);
  }

  void Arm() {
    ASSERT_EQ(latch_->PrepareArm(In(kIdle)), "");
    Follow(In(kIdle), true);
    Follow(In(kArmed));
  }

  LatchFolder there_;
  std::vector<std::string> journal_;
  std::unique_ptr<TripLatch> latch_;
  std::int64_t now_ns_ = 0;
};

TEST_F(TripLatchTest, TheFirstStartHasNoTripAndNoFile) {
  EXPECT_FALSE(Restart());
  EXPECT_NE(latch_->folder(), nullptr);
  Follow(In(kStarting));
  Follow(In(kIdle));
  EXPECT_FALSE(there_.Has(kFile));
  EXPECT_FALSE(latch_->trip());
  EXPECT_THAT(journal_, IsEmpty());
}

TEST_F(TripLatchTest, ATripComesBackWithItsCauseItsValuesAndItsTimeUntilItsReset) {
  Restart();
  Arm();
  Follow(In(kTripped));
  const std::string time_utc = latch_->trip()->time_utc;
  EXPECT_FALSE(latch_->trip()->before_start);
  for (int start = 0; start < 3; ++start) {
    const std::optional<HeldTrip> trip = Restart();
    ASSERT_TRUE(trip);
    EXPECT_EQ(trip->cause, TripCause::kSoftLimit2);
    EXPECT_EQ(trip->evidence.value, kEvidence.value);
    EXPECT_EQ(trip->evidence.channel, kEvidence.channel);
    EXPECT_EQ(trip->time_utc, time_utc);
    EXPECT_TRUE(trip->before_start);
    EXPECT_THAT(journal_, ElementsAre(AllOf(
                              HasSubstr("error: "), HasSubstr("from before this start"),
                              HasSubstr("soft-limit-2"), HasSubstr(time_utc), HasSubstr(kFile))));
    Follow(In(kStarting));
    Follow(In(kTripped));
    EXPECT_TRUE(latch_->trip()->before_start);
  }
  Follow(In(kIdle), true);
  EXPECT_TRUE(there_.Has(kFile)) << "the reset is not answered yet";
  Follow(In(kIdle));
  EXPECT_FALSE(there_.Has(kFile));
  EXPECT_FALSE(latch_->trip());
  EXPECT_FALSE(Restart());
}

TEST_F(TripLatchTest, ATripInIdleIsKept) {
  Restart();
  Follow(In(kIdle));
  Follow(In(kTripped, TripCause::kEmergencyStop));
  EXPECT_EQ(Restart().value().cause, TripCause::kEmergencyStop);
}

TEST_F(TripLatchTest, ADaemonThatEndsWhileArmedStartsTripped) {
  Restart();
  ASSERT_EQ(latch_->PrepareArm(In(kIdle)), "");
  const HeldTrip trip = Restart().value();
  EXPECT_EQ(trip.cause, TripCause::kEndedWhileArmed);
  EXPECT_NE(trip.time_utc, "");
  EXPECT_EQ(Restart().value().cause, TripCause::kEndedWhileArmed) << "until its reset";
  Follow(In(kTripped, TripCause::kEndedWhileArmed));
  Follow(In(kIdle));
  EXPECT_FALSE(Restart());
}

TEST_F(TripLatchTest, AnArmThatIsDisarmedOrRefusedLeavesNothing) {
  Restart();
  Arm();
  for (const SafetyState state : {kRunning, kStopping, kArmed, kDisarming}) {
    Follow(In(state));
    EXPECT_TRUE(there_.Has(kFile)) << ToString(state);
  }
  Follow(In(kIdle));
  EXPECT_FALSE(there_.Has(kFile));
  ASSERT_EQ(latch_->PrepareArm(In(kIdle)), "");
  Follow(In(kIdle), false);  // answered: refused
  EXPECT_FALSE(Restart());
}

TEST_F(TripLatchTest, FaultStoppingWritesNothingAndIsArmedUntilItIsTripped) {
  Restart();
  Arm();
  const std::string armed = there_.Text(kFile);
  Follow(In(kFaultStopping));
  EXPECT_EQ(there_.Text(kFile), armed) << "no wait for the disk while the arm moves";
  const std::string time_utc = latch_->trip()->time_utc;
  EXPECT_NE(time_utc, "");
  Follow(In(kTripped));
  EXPECT_EQ(Restart().value().cause, TripCause::kSoftLimit2);
}

TEST_F(TripLatchTest, ASecondTripIsKeptThoughItsResetWasNotSeen) {
  Restart();
  Follow(In(kTripped));
  Restart();
  Follow(In(kTripped));
  Follow(In(kTripped, TripCause::kEmergencyStop));
  EXPECT_FALSE(latch_->trip()->before_start);
  EXPECT_EQ(Restart().value().cause, TripCause::kEmergencyStop);
}

TEST_F(TripLatchTest, AFileThatCannotBeReadIsATripUntilItsReset) {
  for (const std::string& text : {std::string(), std::string("{\"flexarm\": \"safety-la"),
                                  std::string("garbage"), std::string(300, '\0')}) {
    there_.Put(kFile, text);
    const HeldTrip trip = Restart().value();
    EXPECT_EQ(trip.cause, TripCause::kTripRecordUnreadable);
    EXPECT_THAT(trip.record_problem, HasSubstr(there_.file(kFile).string()));
    EXPECT_EQ(trip.time_utc, "");
    EXPECT_TRUE(trip.before_start);
    EXPECT_THAT(journal_, ElementsAre(HasSubstr(trip.record_problem)));
    Follow(In(kTripped, TripCause::kTripRecordUnreadable));
    EXPECT_EQ(there_.Text(kFile), text) << "what was found stays for those who look";
    EXPECT_EQ(Restart().value().cause, TripCause::kTripRecordUnreadable);
    Follow(In(kIdle));
    EXPECT_FALSE(Restart());
  }
}

TEST_F(TripLatchTest, WithoutRoomTheArmIsNotArmedAndTheReasonIsTold) {
  Restart();
  {
    const FullDisk full;
    EXPECT_THAT(latch_->PrepareArm(In(kIdle)), HasSubstr(kFile));
  }
  EXPECT_THAT(journal_,
              ElementsAre(AllOf(HasSubstr("error: "), HasSubstr("the arm is not armed"))));
  EXPECT_EQ(latch_->PrepareArm(In(kIdle)), "");
  std::filesystem::remove_all(there_.path());
  Follow(In(kIdle));
  EXPECT_NE(latch_->PrepareArm(In(kIdle)), "") << "the folder is gone";
}

TEST_F(TripLatchTest, BeforeItIsOpenNothingMayBeArmed) {
  TripLatch closed(there_.path(), "/runs", [](bool, const std::string&) {});
  EXPECT_EQ(closed.folder(), nullptr);
  EXPECT_NE(closed.PrepareArm(In(kIdle)), "");
  EXPECT_FALSE(std::filesystem::exists(there_.path()));
}

TEST_F(TripLatchTest, ARequestToArmWhileTrippedKeepsTheTrip) {
  Restart();
  Follow(In(kTripped));
  EXPECT_EQ(latch_->PrepareArm(In(kTripped)), "") << "the safety task refuses it";
  EXPECT_EQ(Restart().value().cause, TripCause::kSoftLimit2);
}

TEST_F(TripLatchTest, WithoutRoomATripIsToldOnceAndTriedEverySecond) {
  Restart();
  Follow(In(kIdle));
  {
    const FullDisk full;
    for (int k = 0; k < 80; ++k) Follow(In(kTripped));
    EXPECT_THAT(journal_,
                ElementsAre(AllOf(HasSubstr("error: "), HasSubstr("would not survive a restart"))));
    EXPECT_THAT(latch_->problem(), HasSubstr(kFile));
  }
  int periods = 0;
  while (!there_.Has(kFile) && periods < 100) {
    Follow(In(kTripped));
    ++periods;
  }
  EXPECT_LE(periods, 50);
  EXPECT_GT(periods, 1) << "not in every period";
  EXPECT_EQ(latch_->problem(), "");
  EXPECT_THAT(journal_.back(), HasSubstr("info: the latch file is in order again"));
  EXPECT_EQ(Restart().value().cause, TripCause::kSoftLimit2);
}

TEST_F(TripLatchTest, WithoutRoomATripOfAnArmedArmStillSurvives) {
  Restart();
  Arm();
  {
    const FullDisk full;
    Follow(In(kTripped));
  }
  EXPECT_THAT(journal_, ElementsAre(HasSubstr("tripped by ended-while-armed")));
  EXPECT_EQ(Restart().value().cause, TripCause::kEndedWhileArmed);
}

TEST_F(TripLatchTest, AResetRemovesTheFileAtOnceAlsoWithoutRoom) {
  Restart();
  Arm();
  bool held = true;
  {
    const FullDisk full;
    Follow(In(kTripped));
    Follow(In(kIdle));  // does not wait for the next try of the write that failed
    held = Restart().has_value();
  }
  EXPECT_FALSE(held);
}

TEST_F(TripLatchTest, AFileThatCannotBeRemovedIsToldAndTheNextStartIsTripped) {
  std::filesystem::create_directories(there_.file(kFile) / "in the way");
  EXPECT_EQ(Restart().value().cause, TripCause::kTripRecordUnreadable);
  Follow(In(kIdle));
  EXPECT_THAT(journal_.back(), HasSubstr("a restarted daemon would be tripped"));
  EXPECT_NE(latch_->PrepareArm(In(kIdle)), "");
  EXPECT_TRUE(Restart());
}

TEST_F(TripLatchTest, ASecondTripByTheSameCauseIsAnotherIfItsValuesDiffer) {
  Restart();
  Follow(In(kTripped));
  Permit second = In(kTripped);
  second.evidence.value = 1.7;
  Follow(second);
  EXPECT_EQ(Restart().value().evidence.value, 1.7);
}

TEST_F(TripLatchTest, ATripIsWrittenOnce) {
  Restart();
  Follow(In(kTripped));
  there_.Put(kFile, "of another process");
  for (int k = 0; k < 200; ++k) Follow(In(kTripped));
  EXPECT_EQ(there_.Text(kFile), "of another process");
}

TEST_F(TripLatchTest, AWriteThatFailedIsTriedAfterASecondAndLaterOnesAtOnce) {
  Restart();
  {
    const FullDisk full;
    latch_->Follow(0, In(kTripped), false);
  }
  latch_->Follow(TripLatch::kRetryNs - 1, In(kTripped), false);
  EXPECT_FALSE(there_.Has(kFile));
  latch_->Follow(TripLatch::kRetryNs, In(kTripped), false);
  EXPECT_TRUE(there_.Has(kFile));
  latch_->Follow(TripLatch::kRetryNs + 1, In(kTripped, TripCause::kEmergencyStop), false);
  EXPECT_THAT(there_.Text(kFile), HasSubstr(ToString(TripCause::kEmergencyStop)));
  latch_->Follow(TripLatch::kRetryNs + 2, In(kIdle), false);
  EXPECT_FALSE(there_.Has(kFile));
}

TEST_F(TripLatchTest, AResetAfterASecondTripThatHadNoRoomRemovesTheFirst) {
  Restart();
  Follow(In(kTripped));
  {
    const FullDisk full;
    Follow(In(kTripped, TripCause::kEmergencyStop));
  }
  Follow(In(kIdle));
  EXPECT_FALSE(Restart());
}

// The file was removed, but a power failure could bring it back.
TEST_F(TripLatchTest, ARemovalThatWasNotSyncedIsTriedAgain) {
  Restart();
  Arm();
  {
    const FoldersFailToSync failing;
    Follow(In(kIdle));
  }
  EXPECT_THAT(journal_, ElementsAre(HasSubstr("a restarted daemon would be tripped")));
  EXPECT_NE(latch_->problem(), "");
  for (int k = 0; k < 50; ++k) Follow(In(kIdle));
  EXPECT_EQ(latch_->problem(), "");
}

TEST_F(TripLatchTest, AfterARemovalThatWasNotSyncedTheFileIsWrittenBeforeTheArmIsArmed) {
  Restart();
  Arm();
  {
    const FoldersFailToSync failing;
    Follow(In(kIdle));
  }
  EXPECT_EQ(latch_->PrepareArm(In(kIdle)), "");
  EXPECT_EQ(latch_->problem(), "") << "the file is as it should be";
  EXPECT_EQ(Restart().value().cause, TripCause::kEndedWhileArmed);
}

TEST_F(TripLatchTest, AFileThatWasWrittenButNotSyncedArmsNothingAndGoes) {
  Restart();
  Follow(In(kIdle));
  {
    const FoldersFailToSync failing;
    EXPECT_THAT(latch_->PrepareArm(In(kIdle)), HasSubstr("cannot be synced"));
  }
  EXPECT_TRUE(there_.Has(kFile));
  Follow(In(kIdle));
  EXPECT_FALSE(Restart());
}

TEST_F(TripLatchTest, TheSameTroubleIsToldAgainWhereItMeansSomethingElse) {
  Restart();
  const FoldersFailToSync failing;
  for (int k = 0; k < 10; ++k) Follow(In(kTripped));
  for (int k = 0; k < 10; ++k) Follow(In(kIdle));
  EXPECT_THAT(journal_, ElementsAre(HasSubstr("would not survive a restart"),
                                    HasSubstr("a restarted daemon would be tripped")));
}

TEST_F(TripLatchTest, AnotherTroubleIsToldToo) {
  Restart();
  {
    const FullDisk full;
    Follow(In(kTripped));
  }
  std::filesystem::remove_all(there_.path());
  for (int k = 0; k < 50; ++k) Follow(In(kTripped));
  EXPECT_THAT(journal_, ElementsAre(HasSubstr("File too large"), HasSubstr("No such file")));
}

// Whenever the process is killed: if the relay may be closed, or a trip was seen and its reset was
// not, the next one starts tripped; after Idle with nothing asked for it does not.
TEST_F(TripLatchTest, CampaignAKillAtAnyTimeLosesNoTrip) {
  std::mt19937 random(5);
  Restart();
  SafetyState state = kIdle;
  bool asked = false;
  for (int step = 0; step < 20'000; ++step) {
    const auto one_of = [&random](auto... states) {
      const std::array all{states...};
      return all[random() % all.size()];
    };
    const SafetyState before = state;
    const bool was_asked = asked;
    switch (before) {
      case kIdle:
        if (asked) {
          state = one_of(kIdle, kArmed, kTestingPump, kTripped);
          asked = false;
        } else if (random() % 2 == 0) {
          asked = latch_->PrepareArm(In(kIdle)).empty();
          ASSERT_TRUE(asked);
        } else {
          state = one_of(kIdle, kTripped);
        }
        break;
      case kTestingPump:
        state = one_of(kTestingPump, kTestingRelay, kIdle, kTripped);
        break;
      case kTestingRelay:
        state = one_of(kTestingRelay, kTestingPower, kIdle, kTripped);
        break;
      case kTestingPower:
        state = one_of(kTestingPower, kArmed, kIdle, kTripped);
        break;
      case kArmed:
        state = one_of(kArmed, kRunning, kDisarming, kTripped);
        break;
      case kRunning:
        state = one_of(kRunning, kStopping, kFaultStopping, kTripped);
        break;
      case kStopping:
        state = one_of(kArmed, kTripped);
        break;
      case kFaultStopping:
        state = kTripped;
        break;
      case kDisarming:
        state = one_of(kIdle, kTripped);
        break;
      case kStarting:
      case kTripped:
        state = one_of(kTripped, kIdle);
        break;
    }
    if (random() % 10 == 0) {  // killed before the operator task has seen the new state
      const bool held = Restart().has_value();
      const bool idle = before == kIdle && !asked && !was_asked;
      EXPECT_EQ(held, !idle) << ToString(before) << " -> " << ToString(state);
      state = held ? kTripped : kIdle;
      asked = false;
      continue;
    }
    Follow(In(state), asked);
    EXPECT_EQ(there_.Has(kFile), state != kIdle || asked) << ToString(state);
  }
}

}  // namespace
}  // namespace flexarm
