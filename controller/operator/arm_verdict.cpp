#include "controller/operator/arm_verdict.h"

#include <nlohmann/json.hpp>

namespace flexarm {
namespace {

using Result = ArmVerdict::Result;

// The findings that count, in one line.
template <typename Text>
std::string Joined(const ArmVerdict& verdict, const Text& text) {
  std::string joined;
  for (const Finding& finding : verdict.findings) {
    if (finding.advice || text(finding).empty()) continue;
    joined += (joined.empty() ? "" : "; ") + text(finding);
  }
  return joined;
}

std::string Texts(const ArmVerdict& verdict) {
  return Joined(verdict, [](const Finding& f) { return f.name + ": " + f.text; });
}

std::string Remedies(const ArmVerdict& verdict) {
  return Joined(verdict, [](const Finding& f) { return f.remedy; });
}

nlohmann::json FindingsJson(const ArmVerdict& verdict) {
  nlohmann::json all = nlohmann::json::array();
  for (const Finding& f : verdict.findings) {
    all.push_back({{"name", f.name}, {"text", f.text}, {"remedy", f.remedy}, {"advice", f.advice}});
  }
  return all;
}

const char* HostName(Result result) {
  switch (result) {
    case Result::kChecking:
      return "checking";
    case Result::kPassed:
      return "ready";
    case Result::kForced:
    case Result::kFailed:
      break;
  }
  return "not-ready";
}

const char* DesignName(Result result) {
  switch (result) {
    case Result::kPassed:
      return "sound";
    case Result::kForced:
      return "forced";
    case Result::kChecking:
    case Result::kFailed:
      break;
  }
  return "rejected";
}

void AddHost(const ArmVerdict& host, std::vector<UnmetCondition>* unmet) {
  if (host.result == Result::kPassed) return;
  if (host.result == Result::kChecking) {
    unmet->push_back(
        {.name = kHostCondition,
         .refusal = "host-checking",
         .found = "whether this machine is good enough for a real rig is not known yet",
         .remedy = "repeat the request; `flexarm check-host` shows what takes long",
         .may_override = true});
    return;
  }
  unmet->push_back({.name = kHostCondition,
                    .refusal = "host-not-ready",
                    .found = "this machine is not good enough for a real rig: " + Texts(host),
                    .remedy = Remedies(host) +
                              " (`flexarm check-host`); or, on your own responsibility, `flexarm "
                              "arm --override-host REASON`",
                    .may_override = true});
}

void AddDesign(const ArmVerdict& design, bool simulated, std::vector<UnmetCondition>* unmet) {
  if (design.result == Result::kPassed) return;
  if (design.result == Result::kForced) {
    if (simulated) return;
    unmet->push_back(
        {.name = kDesignCondition,
         .refusal = "design-forced",
         .found = "these gains failed checks and were written with --force: " + Texts(design),
         .remedy = Remedies(design) + "; or, on your own responsibility, `flexarm arm "
                                      "--override-design REASON`",
         .may_override = true});
    return;
  }
  unmet->push_back({.name = kDesignCondition,
                    .refusal = "design-rejected",
                    .found = "the design of the controller was rejected: " + Texts(design),
                    .remedy = Remedies(design),
                    .may_override = false});
}

}  // namespace

std::vector<UnmetCondition> UnmetToArm(const ArmVerdict& host, const ArmVerdict& design,
                                       bool simulated) {
  std::vector<UnmetCondition> unmet;
  if (!simulated) AddHost(host, &unmet);
  AddDesign(design, simulated, &unmet);
  return unmet;
}

nlohmann::json HostJson(const ArmVerdict& host) {
  return {{"verdict", HostName(host.result)}, {"findings", FindingsJson(host)}};
}

nlohmann::json DesignJson(const ArmVerdict& design) {
  return {{"verdict", DesignName(design.result)}, {"findings", FindingsJson(design)}};
}

}  // namespace flexarm
