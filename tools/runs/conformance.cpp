#include "tools/runs/conformance.h"

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "tools/runs/safety_conformance.h"

namespace flexarm {
namespace {

// Torques are sums over a period: round-off may exceed a limit by this much.
constexpr double kRoundOff_nm = 1e-9;

std::string Number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string At(const TickRecord& record) { return "tick " + std::to_string(record.input.tick); }

// Describes what is wrong with a tick, given the one before it; empty if nothing is wrong.
using TickRule = std::function<std::string(const TickRecord* before, const TickRecord& now)>;

ConformanceCheck ForEveryTick(const std::string& name, const LoadedRun& run, const TickRule& rule) {
  const auto& ticks = run.contents.tick;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const std::string wrong = rule(i > 0 ? &ticks[i - 1] : nullptr, ticks[i]);
    if (wrong.empty()) continue;
    return {name, false, At(ticks[i]) + ": " + wrong, run.TimeOf(ticks[i].input.now_ns), {}};
  }
  return {name, true, ""};
}

std::string Follows(const TickRecord* before, const TickRecord& now) {
  if (before == nullptr || now.input.tick == before->input.tick + 1) return "";
  return "follows tick " + std::to_string(before->input.tick);
}

std::string TimeRunsForward(const TickRecord* before, const TickRecord& now) {
  if (before == nullptr || now.input.now_ns > before->input.now_ns) return "";
  return "is at " + std::to_string(now.input.now_ns) + " ns, the one before at " +
         std::to_string(before->input.now_ns) + " ns";
}

std::string BeginsWithReset(const TickRecord* before, const TickRecord& now) {
  if (before != nullptr || now.input.reset != 0) return "";
  return " is the first and does not reset the loop, so the log cannot be replayed";
}

std::string OutputBelongsToInput(const TickRecord*, const TickRecord& now) {
  if (now.output.tick == now.input.tick) return "";
  return "has the output of tick " + std::to_string(now.output.tick);
}

std::string TorqueIsFinite(const TickRecord*, const TickRecord& now) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    if (!std::isfinite(now.output.torque_nm[joint]) ||
        !std::isfinite(now.input.applied_torque_nm[joint])) {
      return "a torque is not finite";
    }
  }
  return "";
}

TickRule TorqueLimit(const SafetyConfig& limits) {
  return [limits](const TickRecord*, const TickRecord& now) -> std::string {
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const double torque = now.input.applied_torque_nm[joint];
      if (std::abs(torque) > limits.torque_limit_nm[joint] + kRoundOff_nm) {
        return Number(torque) + " N m on joint " + std::to_string(joint + 1) + ", limit " +
               Number(limits.torque_limit_nm[joint]);
      }
    }
    return "";
  };
}

// The means over neighbouring periods differ by at most the slew limit times one period.
TickRule SlewLimit(const SafetyConfig& limits, double period_s) {
  return [limits, period_s](const TickRecord* before, const TickRecord& now) -> std::string {
    const bool neighbours = before != nullptr && now.input.tick == before->input.tick + 1;
    // A trip may set the torque to zero at once.
    if (!neighbours || !TorqueAllowed(now.input.safety_state)) return "";
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const double step =
          now.input.applied_torque_nm[joint] - before->input.applied_torque_nm[joint];
      const double limit = limits.slew_limit_nm_per_s[joint] * period_s;
      if (std::abs(step) > limit + kRoundOff_nm) {
        return "torque " + std::to_string(joint + 1) + " changes by " + Number(step) +
               " N m, limit " + Number(limit);
      }
    }
    return "";
  };
}

ConformanceCheck DigestHolds(const LoadedRun& run) {
  return {"digest", run.digest_holds, run.digest_holds ? "" : "damaged since it was written"};
}

ConformanceCheck IsClosed(const LoadedRun& run) {
  const std::string& result = run.contents.info.result_json;
  if (!run.closed() || result.empty()) {
    return {"closed", false, "the run was not closed: still open, or its process died"};
  }
  const nlohmann::json parsed = nlohmann::json::parse(result, nullptr, false);
  const bool recovered = parsed.is_object() && parsed.contains("recovered");
  return {"closed", !recovered, recovered ? "its process died; the log was recovered later" : ""};
}

}  // namespace

std::vector<ConformanceCheck> CheckConformance(const LoadedRun& run) {
  const bool empty = run.contents.tick.empty();
  const SafetyConfig& limits = run.config.safety;
  std::vector<ConformanceCheck> checks{
      {"has-ticks", !empty, empty ? "there are none" : ""},
      ForEveryTick("no-gap", run, Follows),
      ForEveryTick("time-runs-forward", run, TimeRunsForward),
      ForEveryTick("begins-with-reset", run, BeginsWithReset),
      ForEveryTick("output-belongs-to-input", run, OutputBelongsToInput),
      ForEveryTick("torque-finite", run, TorqueIsFinite),
      ForEveryTick("torque-limit", run, TorqueLimit(limits)),
      ForEveryTick("slew-limit", run, SlewLimit(limits, run.period_s()))};
  for (ConformanceCheck& check : CheckSafety(run.contents, run.config))
    checks.push_back(std::move(check));
  checks.push_back(DigestHolds(run));
  checks.push_back(IsClosed(run));
  return checks;
}

}  // namespace flexarm
