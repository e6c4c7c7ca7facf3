#include "controller/host/arm_verdicts.h"

namespace flexarm {
namespace {

using Result = ArmVerdict::Result;

Finding FindingOf(const HostCheck& check) {
  return {.name = check.name,
          .text = check.value + ", required: " + check.required,
          .remedy = check.remedy,
          .advice = check.advice};
}

Result ResultOf(DesignVerdict::Result result) {
  switch (result) {
    case DesignVerdict::Result::kSound:
      return Result::kPassed;
    case DesignVerdict::Result::kForced:
      return Result::kForced;
    case DesignVerdict::Result::kRejected:
      break;
  }
  return Result::kFailed;
}

}  // namespace

ArmVerdict HostVerdictOf(const std::vector<HostCheck>& checks, bool realtime) {
  ArmVerdict verdict{.result = realtime && HostReady(checks) ? Result::kPassed : Result::kFailed};
  if (!realtime) {
    verdict.findings.push_back(
        {.name = "real-time",
         .text = "off, by --without-realtime: ordinary scheduling, unlocked memory",
         .remedy = "start the daemon without --without-realtime"});
  }
  for (const HostCheck& check : checks) {
    if (!check.ok) verdict.findings.push_back(FindingOf(check));
  }
  return verdict;
}

ArmVerdict DesignVerdictOf(const DesignVerdict& verdict) {
  ArmVerdict out{.result = ResultOf(verdict.result)};
  if (out.result == Result::kPassed) return out;
  out.findings.push_back(
      {.name = ToString(verdict.result),
       .text = verdict.found,
       .remedy =
           out.result == Result::kForced
               ? "correct the config until `flexarm design` writes gains without --force"
               : "correct the config until `flexarm design` accepts it: less controller.alpha, "
                 "more controller.torque_weight, or a narrower controller.payload_range_kg; on "
                 "the simulated arm gains of `flexarm design --force` may be armed"});
  return out;
}

}  // namespace flexarm
