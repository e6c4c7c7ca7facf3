#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "controller/operator/override.h"

namespace flexarm {

/// One thing that a check before arming found wanting.
struct Finding {
  std::string name;     ///< "preempt-rt"
  std::string text;     ///< what was found, and what is required
  std::string remedy;   ///< what to do
  bool advice = false;  ///< does not count for the verdict

  friend bool operator==(const Finding&, const Finding&) = default;
};

/// Result of a check before arming.
struct ArmVerdict {
  enum class Result : std::uint8_t {
    kChecking,  ///< not known yet: refuses
    kPassed,
    kForced,  ///< failed, and recorded as wanted: `flexarm design --force`
    kFailed,
  };
  Result result = Result::kChecking;
  std::vector<Finding> findings = {};
};

/// What is checked before an arm request reaches the safety task.
struct ArmChecks {
  ArmVerdict design = {};  ///< of the gains, computed at the start of the daemon
  bool simulated = false;  ///< the arm is: no machine is too bad for it
  /// Checks the machine. Called on a thread of its own, on a wired rig only.
  std::function<ArmVerdict()> check_host = {};
};

/// Names of the conditions of `arm` that may be overridden.
inline constexpr const char* kHostCondition = "host";
inline constexpr const char* kDesignCondition = "design";

/// The conditions of `arm` that do not hold.
///
/// | condition | simulated arm | wired rig |
/// |---|---|---|
/// | host: machine not ready, or not known | holds | refused; may be overridden |
/// | design: forced gains | holds | refused; may be overridden |
/// | design: rejected, or not known | refused | refused |
std::vector<UnmetCondition> UnmetToArm(const ArmVerdict& host, const ArmVerdict& design,
                                       bool simulated);

/// For the status: {"verdict", "findings": [{"name", "text", "remedy", "advice"}]}; "verdict" is
/// "checking", "ready" or "not-ready".
nlohmann::json HostJson(const ArmVerdict& host);
/// The same; "verdict" is "sound", "forced" or "rejected".
nlohmann::json DesignJson(const ArmVerdict& design);

}  // namespace flexarm
