#include "controller/realtime/lockstep_task.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

struct Seen {
  const Task* task;
  std::int64_t due_ns;
  std::int64_t late_ns;
  friend bool operator==(const Seen&, const Seen&) = default;
};

class WritingTask final : public Task {
 public:
  WritingTask(std::int64_t period_ns, std::int64_t phase_ns, int priority, std::vector<Seen>* seen)
      : traits_{.name = "test",
                .period_ns = period_ns,
                .phase_ns = phase_ns,
                .deadline_ns = period_ns,
                .priority = priority},
        seen_(seen) {}
  Traits traits() const noexcept override { return traits_; }
  void Run(const Activation& activation) noexcept override {
    seen_->push_back({this, activation.due_ns, activation.late_ns});
    missed += activation.missed_in_a_row;
  }
  void Ended() noexcept override { ended = true; }

  int missed = 0;
  bool ended = false;

 private:
  Traits traits_;
  std::vector<Seen>* seen_;
};

struct LockstepTaskTest : testing::Test {
  std::vector<Seen> seen;
  WritingTask slow{5 * kMs, 2 * kMs, 80, &seen};
  WritingTask fast{kMs, 0, 90, &seen};
  LockstepTask loop{{&slow, &fast}};
};

TEST_F(LockstepTaskTest, RunsWhatIsDueInOrderOfInstantAndPriority) {
  for (std::int64_t t = 0; t < 4 * kMs; t += kMs) loop.Run({.due_ns = t, .missed_in_a_row = 0});
  EXPECT_EQ(seen, (std::vector<Seen>{{&fast, 0, 0},
                                     {&fast, kMs, 0},
                                     {&fast, 2 * kMs, 0},
                                     {&slow, 2 * kMs, 0},
                                     {&fast, 3 * kMs, 0}}));
}

// The thread slept through 6 ms, and woke 0.25 ms after the last of its due instants.
TEST_F(LockstepTaskTest, CatchesUpWithoutASkipAndSaysHowLateEachActivationIs) {
  loop.Run({.due_ns = 0, .missed_in_a_row = 0});
  seen.clear();
  loop.Run({.due_ns = 7 * kMs, .missed_in_a_row = 6, .late_ns = 250'000});
  EXPECT_EQ(seen, (std::vector<Seen>{{&fast, 1 * kMs, 6'250'000},
                                     {&fast, 2 * kMs, 5'250'000},
                                     {&slow, 2 * kMs, 5'250'000},
                                     {&fast, 3 * kMs, 4'250'000},
                                     {&fast, 4 * kMs, 3'250'000},
                                     {&fast, 5 * kMs, 2'250'000},
                                     {&fast, 6 * kMs, 1'250'000},
                                     {&fast, 7 * kMs, 250'000},
                                     {&slow, 7 * kMs, 250'000}}));
  EXPECT_EQ(fast.missed + slow.missed, 0) << "none was skipped";
}

TEST_F(LockstepTaskTest, ItsEndIsTheEndOfAll) {
  loop.Ended();
  EXPECT_TRUE(fast.ended && slow.ended);
}

}  // namespace
}  // namespace flexarm
