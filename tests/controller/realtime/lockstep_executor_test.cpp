#include "controller/realtime/lockstep_executor.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/realtime/wakeup.h"

namespace flexarm {
namespace {

struct Entry {
  std::string name;
  std::int64_t due_ns;
  friend bool operator==(const Entry&, const Entry&) = default;
  friend void PrintTo(const Entry& entry, std::ostream* out) {
    *out << entry.name << "@" << entry.due_ns;
  }
};

class LoggingTask final : public Task {
 public:
  LoggingTask(const char* name, std::int64_t period_ns, std::int64_t phase_ns, int priority,
              std::vector<Entry>* log)
      : traits_{.name = name,
                .period_ns = period_ns,
                .phase_ns = phase_ns,
                .deadline_ns = period_ns,
                .priority = priority},
        log_(log) {}

  Traits traits() const noexcept override { return traits_; }
  void Run(const Activation& activation) noexcept override {
    missed += activation.missed_in_a_row;
    log_->push_back({traits_.name, activation.due_ns});
  }

  int missed = 0;

 private:
  Traits traits_;
  std::vector<Entry>* log_;
};

TEST(LockstepExecutor, RunsInOrderOfInstantThenPriorityThenRegistration) {
  std::vector<Entry> log;
  LoggingTask plant("plant", 1, 0, 60, &log);
  LoggingTask other("other", 2, 0, 0, &log);
  LoggingTask control("control", 4, 1, 80, &log);
  LoggingTask twin("twin", 4, 1, 80, &log);
  LoggingTask safety("safety", 1, 0, 90, &log);
  LockstepExecutor executor;
  for (LoggingTask* task : {&plant, &other, &control, &twin, &safety}) executor.Add(*task);
  executor.RunUntil(3);
  EXPECT_EQ(log, (std::vector<Entry>{{"safety", 0},
                                     {"plant", 0},
                                     {"other", 0},
                                     {"safety", 1},
                                     {"control", 1},
                                     {"twin", 1},
                                     {"plant", 1},
                                     {"safety", 2},
                                     {"plant", 2},
                                     {"other", 2}}));
  EXPECT_EQ(executor.next_ns(), 3);
}

// Wakes another task in its activation at `at_ns`.
class WakingTask final : public Task {
 public:
  WakingTask(Wakeup* wakeup, std::int64_t at_ns) : wakeup_(wakeup), at_ns_(at_ns) {}
  Traits traits() const noexcept override {
    return {.name = "waking", .period_ns = 1, .phase_ns = 0, .deadline_ns = 1, .priority = 90};
  }
  void Run(const Activation& activation) noexcept override {
    if (activation.due_ns == at_ns_) wakeup_->Wake();
  }

 private:
  Wakeup* wakeup_;
  std::int64_t at_ns_;
};

class WokenTask final : public Task {
 public:
  WokenTask(Wakeup* wakeup, std::vector<Entry>* log) : wakeup_(wakeup), log_(log) {}
  Traits traits() const noexcept override {
    return {.name = "bus", .period_ns = 20, .phase_ns = 0, .deadline_ns = 1, .priority = 70};
  }
  void Run(const Activation& activation) noexcept override {
    log_->push_back({"bus", activation.due_ns});
  }
  Wakeup* wakeup() noexcept override { return wakeup_; }
  void Woken(std::int64_t now_ns) noexcept override { log_->push_back({"woken", now_ns}); }

 private:
  Wakeup* wakeup_;
  std::vector<Entry>* log_;
};

TEST(LockstepExecutor, ATaskIsWokenAtTheInstantOfTheOneThatWakesIt) {
  for (const std::int64_t at_ns : {std::int64_t{7}, std::int64_t{20}}) {
    std::vector<Entry> log;
    Wakeup wakeup;
    WakingTask waking(&wakeup, at_ns);
    WokenTask woken(&wakeup, &log);
    LockstepExecutor executor;
    executor.Add(woken);
    executor.Add(waking);
    executor.RunUntil(30);
    EXPECT_EQ(log, (std::vector<Entry>{{"bus", 0}, {"woken", at_ns}, {"bus", 20}}));
  }
}

TEST(LockstepExecutor, RunUntilExcludesTheEndAndContinuesFromThere) {
  std::vector<Entry> log;
  LoggingTask task("a", 10, 5, 1, &log);
  LockstepExecutor executor;
  executor.Add(task);
  executor.RunUntil(5);
  EXPECT_TRUE(log.empty());
  executor.RunUntil(25);
  EXPECT_EQ(log, (std::vector<Entry>{{"a", 5}, {"a", 15}}));
  executor.RunUntil(25);
  EXPECT_EQ(log.size(), 2u) << "nothing runs twice";
  executor.RunUntil(26);
  EXPECT_EQ(log.back(), (Entry{"a", 25}));
  EXPECT_EQ(task.missed, 0);
}

TEST(LockstepExecutor, RunWhileEvaluatesItsPredicateBeforeEachInstant) {
  std::vector<Entry> log;
  LoggingTask a("a", 10, 0, 2, &log);
  LoggingTask b("b", 10, 0, 1, &log);
  LockstepExecutor executor;
  executor.Add(a);
  executor.Add(b);
  std::vector<std::int64_t> asked;
  executor.RunWhile([&](std::int64_t instant_ns) {
    asked.push_back(instant_ns);
    return log.size() < 3;
  });
  EXPECT_EQ(log.size(), 4u) << "an instant is always completed";
  EXPECT_EQ(asked, (std::vector<std::int64_t>{0, 10, 20}));
}

TEST(LockstepExecutor, WithoutTasksThereIsNothingToRun) {
  LockstepExecutor executor;
  executor.RunUntil(1'000'000);
  executor.RunWhile([](std::int64_t) { return true; });
  EXPECT_EQ(executor.next_ns(), INT64_MAX);
}

TEST(LockstepExecutor, RefusesATaskThatCannotBeScheduled) {
  std::vector<Entry> log;
  LoggingTask standing("standing", 0, 0, 1, &log);
  LoggingTask early("early", 10, -1, 1, &log);
  LockstepExecutor executor;
  EXPECT_THROW(executor.Add(standing), std::invalid_argument);
  EXPECT_THROW(executor.Add(early), std::invalid_argument);
}

class DenormalTask final : public Task {
 public:
  Traits traits() const noexcept override {
    return {.name = "denormal", .period_ns = 1, .phase_ns = 0, .deadline_ns = 1, .priority = 1};
  }
  void Run(const Activation&) noexcept override {
    volatile double smallest_normal = std::numeric_limits<double>::min();
    volatile double denormal = std::numeric_limits<double>::denorm_min();
    result_flushed = smallest_normal / 2.0 == 0.0;
    operand_flushed = denormal * 1e300 == 0.0;
  }
  bool result_flushed = false;
  bool operand_flushed = false;
};

TEST(LockstepExecutor, FlushesDenormalsInTasksAndNowhereElse) {
  DenormalTask task;
  LockstepExecutor executor;
  executor.Add(task);
  executor.RunUntil(1);
  EXPECT_TRUE(task.result_flushed);
  EXPECT_TRUE(task.operand_flushed);
  volatile double smallest_normal = std::numeric_limits<double>::min();
  EXPECT_GT(smallest_normal / 2.0, 0.0);
}

}  // namespace
}  // namespace flexarm
