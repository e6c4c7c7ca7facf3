#include "tools/torture/disturbed_executor.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace flexarm {
namespace {

struct Seen {
  std::string name;
  Task::Activation activation;
};

class Noting final : public Task {
 public:
  Noting(const char* name, std::int64_t period_ms, int priority, std::vector<Seen>* seen)
      : name_(name), period_ms_(period_ms), priority_(priority), seen_(seen) {}

  Traits traits() const noexcept override {
    return {.name = name_,
            .period_ns = period_ms_ * kMs,
            .phase_ns = 0,
            .deadline_ns = kMs,
            .priority = priority_};
  }
  void Run(const Activation& activation) noexcept override {
    seen_->push_back({name_, activation});
  }

 private:
  const char* name_;
  std::int64_t period_ms_;
  int priority_;
  std::vector<Seen>* seen_;
};

std::vector<Seen> SeenIn(const WakeUps& wake_ups, const std::vector<Fault>& faults,
                         std::int64_t until_ms) {
  std::vector<Seen> seen;
  Noting safety("safety", 1, 90, &seen), control("control", 20, 80, &seen);
  DisturbedExecutor executor(wake_ups, faults, until_ms * kMs);
  executor.Add(safety, FaultPlace::kSafety);
  executor.Add(control, FaultPlace::kControl);
  executor.RunUntil(until_ms * kMs);
  return seen;
}

Fault Of(FaultPlace place, FaultKind kind, std::int64_t from_ms, std::int64_t to_ms) {
  return {.place = place,
          .index = 0,
          .kind = kind,
          .from_ns = from_ms * kMs,
          .to_ns = to_ms * kMs,
          .seed = 1};
}

std::vector<Task::Activation> Of(const std::vector<Seen>& seen, const std::string& name) {
  std::vector<Task::Activation> all;
  for (const Seen& one : seen) {
    if (one.name == name) all.push_back(one.activation);
  }
  return all;
}

TEST(DisturbedExecutor, WithoutDisturbanceEveryActivationIsOnTime) {
  const auto safety = Of(SeenIn({}, {}, 100), "safety");
  ASSERT_EQ(safety.size(), 100U);
  for (std::size_t k = 0; k < safety.size(); ++k) {
    EXPECT_EQ(safety[k].due_ns, static_cast<std::int64_t>(k) * kMs);
    EXPECT_EQ(safety[k].late_ns, 0);
    EXPECT_EQ(safety[k].missed_in_a_row, 0);
  }
}

// 0.9 ms is within the period and the deadline: late, and nothing missed.
TEST(DisturbedExecutor, AWakeUpWithinThePeriodIsLateAndMissesNothing) {
  const auto safety = Of(SeenIn({.seed = 3, .latest_ns = 900'000}, {}, 1'000), "safety");
  ASSERT_GE(safety.size(), 999U);  // the last one may wake after the end
  std::int64_t latest_ns = 0;
  for (std::size_t k = 0; k < safety.size(); ++k) {
    EXPECT_EQ(safety[k].due_ns, static_cast<std::int64_t>(k) * kMs);
    EXPECT_EQ(safety[k].missed_in_a_row, 0);
    latest_ns = std::max(latest_ns, safety[k].late_ns);
  }
  EXPECT_GT(latest_ns, 800'000);
  EXPECT_LT(latest_ns, 900'000);
}

// As RealtimeExecutor: the periods that have passed are skipped and counted, the present one is
// run.
TEST(DisturbedExecutor, AHungThreadSkipsThePeriodsThatHavePassed) {
  const std::vector<Fault> faults = {Of(FaultPlace::kControl, FaultKind::kOff, 30, 115)};
  const auto control = Of(SeenIn({}, faults, 200), "control");
  ASSERT_GE(control.size(), 4U);
  EXPECT_EQ(control[1].due_ns, 20 * kMs);
  EXPECT_EQ(control[2].due_ns, 100 * kMs);  // due at 40, woke at 115: 60, 80 and 100 had begun
  EXPECT_EQ(control[2].late_ns, 15 * kMs);
  EXPECT_EQ(control[2].missed_in_a_row, 3);
  EXPECT_EQ(control[3].due_ns, 120 * kMs);
  EXPECT_EQ(control[3].missed_in_a_row, 4) << "that one was missed as well";
}

TEST(DisturbedExecutor, AFaultOfReadingsDelaysNoThread) {
  const std::vector<Fault> faults = {Of(FaultPlace::kFrame, FaultKind::kOff, 0, 100)};
  std::vector<Seen> seen;
  Noting recorder("recorder", 10, 0, &seen);
  DisturbedExecutor executor({}, faults, 100 * kMs);
  executor.Add(recorder);
  executor.RunUntil(100 * kMs);
  ASSERT_EQ(seen.size(), 10U);
  for (const Seen& one : seen) EXPECT_EQ(one.activation.late_ns, 0);
}

TEST(DisturbedExecutor, TasksThatWakeTogetherRunInAnyOrderAndASeedRepeatsIt) {
  bool safety_first = false, control_first = false;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const WakeUps wake_ups{.seed = seed, .order_changes = 3};
    const std::vector<Seen> seen = SeenIn(wake_ups, {}, 200), again = SeenIn(wake_ups, {}, 200);
    ASSERT_EQ(seen.size(), again.size());
    for (std::size_t k = 0; k < seen.size(); ++k) EXPECT_EQ(seen[k].name, again[k].name);
    (seen[0].name == "safety" ? safety_first : control_first) = true;
  }
  EXPECT_TRUE(safety_first && control_first);
}

}  // namespace
}  // namespace flexarm
