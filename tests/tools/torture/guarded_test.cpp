// The fault matrix with the heap forbidden on the real-time tasks: safety, control, bus and plant,
// planner. The sample has every fault in mid-move with one law; the whole campaign every cell.
// An exception allocates, so it is forbidden as well.

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/controller/law/shipped_rig.h"
#include "tests/support/campaign.h"
#include "tests/support/no_alloc.h"
#include "tools/torture/fault_matrix.h"

namespace flexarm {
namespace {

class HeapGuard final : public ActivationGuard {
 public:
  void Enter() noexcept override {
    guard_.emplace();
    ++activations_;
  }
  void Leave() noexcept override { guard_.reset(); }
  long activations() const { return activations_; }

 private:
  std::optional<NoAlloc> guard_;
  long activations_ = 0;
};

TEST(GuardedMatrix, CampaignNoRealTimeTaskUsesTheHeap) {
  const bool whole = CampaignCases(0, 1) != 0;
  std::vector<std::string> laws = {"sobel"};
  if (whole) laws = {"sobel", "sobel-thesis", "gain-scheduled", "receding-horizon", "lqg", "pd"};
  const TorturedRigs rigs(
      [](const std::string& law) { return ShippedRig({"controller.name=" + law}); }, laws);
  const TortureSpace space = SpaceOf(ShippedRig(), laws);
  HeapGuard guard;
  long sessions = 0;
  for (const MatrixRow& row : EmptyMatrix(space)) {
    for (const Situation situation : kMatrixSituations) {
      if (!whole && situation != Situation::kRunning) continue;
      for (const TortureScenario& scenario : MatrixScenarios(space, ShippedRig(), row, situation)) {
        SCOPED_TRACE(Text(scenario));
        RunScenario(rigs, scenario, kEnvelope, &guard);
        ++sessions;
        if (!whole) break;  // the first index of each place
      }
    }
  }
  EXPECT_GT(sessions, whole ? 4'000 : 80);
  EXPECT_GT(guard.activations(), 4'000 * sessions)
      << "safety and plant alone run 2000 times a second";
}

// A task that allocates, once, in its hundredth activation.
class Allocating final : public Task {
 public:
  Traits traits() const noexcept override {
    return {
        .name = "allocating", .period_ns = kMs, .phase_ns = 0, .deadline_ns = kMs, .priority = 50};
  }
  void Run(const Activation& activation) noexcept override {
    if (activation.due_ns == 100 * kMs) kept_ = std::make_unique<int>(1);
  }

 private:
  std::unique_ptr<int> kept_;
};

TEST(GuardedMatrixDeathTest, AnAllocationEndsTheProcessWithAMessage) {
  if (!kNoAllocWorks) GTEST_SKIP() << "the sanitizer has its own allocator";
  EXPECT_DEATH(
      {
        Allocating task;
        HeapGuard guard;
        const std::vector<Fault> faults;
        DisturbedExecutor executor({}, faults, kMs);
        executor.Watch(&guard);
        executor.Add(task);
        executor.RunUntil(200 * kMs);
      },
      "malloc of 4 bytes on a thread that must not touch the heap");
}

}  // namespace
}  // namespace flexarm
