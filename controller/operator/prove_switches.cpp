#include "controller/operator/prove_switches.h"

#include <ctime>
#include <nlohmann/json.hpp>
#include <utility>

#include "controller/operator/switch_proof_record.h"
#include "controller/types/named_rejection.h"

namespace flexarm {
namespace {

bool RelayIsOpen(SafetyState state) {
  return state == SafetyState::kIdle || state == SafetyState::kTripped;
}

}  // namespace

ProveSwitches::ProveSwitches(const RigConfig& config, TripLatch* latch, JournalReport report,
                             std::function<std::int64_t()> unix_s)
    : lines_(config.hal.gpiod),
      valid_days_(config.safety.prove_days),
      period_s_(config.loop.period_s()),
      needed_(config.backend == "wired"),
      latch_(latch),
      report_(std::move(report)),
      unix_s_(unix_s ? std::move(unix_s) : [] { return std::int64_t{std::time(nullptr)}; }) {}

void ProveSwitches::Start(int client, SafetyState state) {
  if (!RelayIsOpen(state)) {
    throw NamedRejection(
        "wrong-state", std::string("prove-switches needs the state Idle or Tripped, but the state "
                                   "is ") +
                           ToString(state) + ": run `flexarm disarm`");
  }
  if (proof_)
    throw NamedRejection("busy", "prove-switches is under way: `flexarm status` says what to do");
  proof_.emplace(period_s_);
  client_ = client;
  report_(false, "prove-switches: begun");
}

void ProveSwitches::Take(const TickRecord& tick) {
  if (!proof_) return;
  if (!RelayIsOpen(tick.input.safety_state)) return End("the arm was armed during the proof");
  proof_->Take(tick.input.frame.levels);
  if (proof_->failed()) return End(proof_->Text());
  if (!proof_->done()) return;
  const StateFolder* folder = latch_->folder();
  const std::string problem =
      folder == nullptr ? "the state folder is not open"
                        : folder->Replace(kFile, SwitchProofText(lines_, unix_s_())).problem;
  End(problem.empty() ? "" : "every switch was seen, but the proof cannot be kept: " + problem);
}

void ProveSwitches::End(const std::string& error) {
  nlohmann::json answer{{"ok", error.empty()}, {"command", "prove-switches"}};
  if (!error.empty()) answer["error"] = error;
  report_(!error.empty(), "prove-switches: " + (error.empty() ? "every switch is proved" : error));
  answer_ = std::make_unique<nlohmann::json>(std::move(answer));
  proof_.reset();
}

std::optional<ClientAnswer> ProveSwitches::TakeAnswer(const Permit& permit) {
  if (answer_ == nullptr) return std::nullopt;
  const std::unique_ptr<nlohmann::json> answer = std::move(answer_);
  (*answer)["state"] = ToString(permit.state);
  return ClientAnswer{.client = client_, .json = std::move(*answer)};
}

std::string ProveSwitches::WhyNot() const {
  const StateFolder* folder = latch_->folder();
  if (folder == nullptr) return "the state folder is not open";
  const FileText found = folder->Read(kFile);
  if (!found.problem.empty()) return found.problem;
  if (!found.text) return "the switches of this rig have not been proved";
  return WhyNoProof(*found.text, lines_, valid_days_, unix_s_());
}

std::vector<UnmetCondition> ProveSwitches::UnmetToRun() const {
  if (!needed_) return {};
  const std::string why = WhyNot();
  if (why.empty()) return {};
  return {{.name = kSwitchesCondition,
           .refusal = "switches-not-proved",
           .found = why,
           .remedy = "run `flexarm prove-switches`; or, on your own responsibility, `flexarm run "
                     "--override-switches REASON`",
           .may_override = true}};
}

nlohmann::json ProveSwitches::Json() const {
  const std::string why = WhyNot();
  nlohmann::json json{{"proved", why.empty()},
                      {"why_not", why.empty() ? nlohmann::json(nullptr) : nlohmann::json(why)},
                      {"steps", kProofSteps.size()},
                      {"step", nullptr},
                      {"text", nullptr}};
  if (!proof_) return json;
  json["step"] = proof_->step() + 1;
  json["text"] = proof_->Text();
  return json;
}

}  // namespace flexarm
