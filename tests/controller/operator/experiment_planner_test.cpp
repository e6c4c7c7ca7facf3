#include "controller/operator/experiment_planner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

namespace flexarm {
namespace {

using Order = ExperimentLoader::Order;
using std::chrono::milliseconds;

constexpr milliseconds kLong{60'000};

ExperimentPlanner::Job Named(const std::string& name) {
  return [name](const std::stop_token&) { return Order{.planned = {}, .name = name, .text = {}}; };
}

// Ends only when it is cancelled.
ExperimentPlanner::Job Endless(std::atomic<int>* ended) {
  return [ended](const std::stop_token& stop) -> Order {
    while (!stop.stop_requested()) std::this_thread::yield();
    ++*ended;
    throw std::runtime_error("cancelled");
  };
}

TEST(ExperimentPlanner, GivesThePlanOnce) {
  ExperimentPlanner planner;
  EXPECT_FALSE(planner.Take(milliseconds(0))) << "nothing was begun";
  planner.Begin(Named("square"));
  const std::optional<ExperimentPlanner::Outcome> outcome = planner.Take(kLong);
  ASSERT_TRUE(outcome && outcome->order);
  EXPECT_EQ(outcome->order->name, "square");
  EXPECT_FALSE(planner.Take(milliseconds(0)));
}

TEST(ExperimentPlanner, GivesTheReasonWhyThereIsNone) {
  ExperimentPlanner planner;
  planner.Begin([](const std::stop_token&) -> Order { throw std::runtime_error("out of reach"); });
  const std::optional<ExperimentPlanner::Outcome> outcome = planner.Take(kLong);
  ASSERT_TRUE(outcome);
  EXPECT_FALSE(outcome->order);
  EXPECT_EQ(outcome->problem, "out of reach");
}

TEST(ExperimentPlanner, ACallerDoesNotWaitForAPlan) {
  ExperimentPlanner planner;
  std::atomic<int> ended = 0;
  planner.Begin(Endless(&ended));
  EXPECT_FALSE(planner.Take(milliseconds(0)));
  EXPECT_EQ(ended, 0);
}

TEST(ExperimentPlanner, ACancelledPlanEndsAndIsNotGiven) {
  std::atomic<int> ended = 0;
  {
    ExperimentPlanner planner;
    planner.Begin(Endless(&ended));
    planner.Cancel();
    EXPECT_FALSE(planner.Take(milliseconds(0)));
    planner.Begin(Named("next"));
    EXPECT_EQ(planner.Take(kLong)->order->name, "next");
    EXPECT_LE(ended, 1);  // 0: it was cancelled before it began
    planner.Begin(Endless(&ended));
  }  // the end of the daemon waits for no plan
  EXPECT_LE(ended, 2);
}

}  // namespace
}  // namespace flexarm
