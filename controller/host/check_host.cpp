#include "controller/host/check_host.h"

#include "controller/tasks/safety_task.h"

namespace flexarm {
namespace {

std::vector<HostCheck> ChecksFor(const HalConfig& hal) {
  return HostChecks(ReadHostFacts(HostFiles(), hal, SafetyTask::kPriority));
}

}  // namespace

std::vector<HostCheck> CheckHost() { return ChecksFor({}); }

std::vector<HostCheck> CheckHost(const RigConfig& config) { return ChecksFor(config.hal); }

}  // namespace flexarm
