#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <utility>
#include <vector>

#include "controller/operator/arm_command.h"
#include "controller/operator/change_command.h"
#include "controller/operator/commissioning_commands.h"
#include "controller/operator/lease.h"
#include "controller/operator/prove_switches.h"
#include "controller/operator/run_command.h"
#include "tests/controller/latch/latch_folder.h"
#include "tests/controller/operator/operator_records.h"
#include "tests/controller/operator/still_stack.h"
#include "tests/support/loop_time.h"

namespace flexarm {

/// In a test a plan is waited for, however slow the machine is.
inline constexpr std::chrono::milliseconds kPlanWait{60'000};

/// The operator task's parts up to the commissioning commands, on a stack that does not run.
class OperatorParts : public testing::Test {
 protected:
  explicit OperatorParts(RigConfig config) : config_(std::move(config)) {
    now_.now_ns = 60 * kMs;
    now_.permit.state = SafetyState::kArmed;
    latch_.Open();
  }

  // The answer of the safety task to the request `number`, taken by every part.
  RequestAnswer Answered(RequestKind kind, std::uint32_t number, Refusal refusal) {
    const RequestAnswer answer{.number = number,
                               .kind = kind,
                               .refusal = refusal,
                               .state = SafetyState::kArmed,
                               .present = 0};
    experiments_.Answered(answer);
    clients_ = requests_.TakeClientsOf(answer);
    return answer;
  }

  RigConfig config_;
  StillStack stack_{config_};
  EventQueue events_{64};
  RecordedJournal journal_;
  LatchFolder folder_;
  TripLatch latch_{folder_.path(), "/runs", [](bool, const std::string&) {}};
  RequestTracker requests_{&stack_, &latch_};
  ExperimentLoader experiments_{&stack_,
                                &requests_,
                                &events_,
                                &ShippedDesign(),
                                LoopGrid(config_.loop),
                                ShippedLimits(),
                                MotionLimitsOf(config_, true)};
  CommissioningCommands commissioning_{config_,
                                       {.stack = &stack_,
                                        .experiments = &experiments_,
                                        .requests = &requests_,
                                        .report = journal_.Report()}};
  std::int64_t unix_s_ = 1'700'000'000;
  ProveSwitches switches_{config_, &latch_, journal_.Report(), [this] { return unix_s_; }};
  OverrideRecord overrides_{&events_, journal_.Report()};
  ArmCommand arm_{ArmChecks{.design = {.result = ArmVerdict::Result::kPassed}, .simulated = true},
                  {.requests = &requests_, .overrides = &overrides_, .report = journal_.Report()}};
  RunCommand run_{{.experiments = &experiments_,
                   .commissioning = &commissioning_,
                   .switches = &switches_,
                   .overrides = &overrides_,
                   .parse_experiment = ParseExperiment,
                   .plan_wait = kPlanWait}};
  ChangeCommand change_{{.experiments = &experiments_,
                         .events = &events_,
                         .period_s = config_.loop.period_s(),
                         .plan_wait = kPlanWait}};
  Lease lease_{&events_, journal_.Report()};
  OperatorSnapshot now_;
  std::vector<int> clients_;  // of the newest answer
};

}  // namespace flexarm
