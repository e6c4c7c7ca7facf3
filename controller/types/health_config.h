#pragma once

namespace flexarm {

/// Section [health]: the parallel plant beside each run (docs/health.md). All of it is optional.
struct HealthConfig {
  bool enabled = true;
  bool judge_payload = true;  ///< false: the payload of a run may be another than is stated
};

}  // namespace flexarm
