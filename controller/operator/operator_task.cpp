#include "controller/operator/operator_task.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "controller/operator/trip_channel.h"
#include "controller/runlog/run_recording.h"
#include "controller/types/rejected_error.h"
#include "hal/line_names.h"
#include "model/units.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;

constexpr int kNoClient = -1;
constexpr std::int64_t kShutdownLimitNs = 6'000'000'000;  // a stop takes 3 s at most, or trips
constexpr std::int64_t kSettleNs = 300'000'000;           // until the recorder has seen everything
constexpr std::int64_t kAliveNs = 100'000'000;            // an older heartbeat starves the watchdog

Json Failure(const std::string& error, const std::string& remedy) {
  return {{"ok", false}, {"error", error}, {"remedy", remedy}};
}

Json BusStatusOf(const std::vector<BusHealth>& buses) {
  Json all = Json::array();
  for (const BusHealth& bus : buses) {
    all.push_back({{"name", bus.name},
                   {"ok", bus.ok},
                   {"fault", bus.fault.empty() ? Json(nullptr) : Json(bus.fault)},
                   {"failed", bus.failed},
                   {"recovered", bus.recovered}});
  }
  return all;
}

// Null where no estimator finds it.
Json PayloadJson(const StepInput& in, const StepOutput& out) {
  if (std::isnan(out.payload_kg)) return nullptr;
  Json warnings = Json::array();
  for (const PayloadWarningText& warning : kPayloadWarnings) {
    if ((out.payload_warnings & warning.bit) != 0) warnings.push_back(warning.name);
  }
  return {{"kg", out.payload_kg},
          {"sigma_kg", out.payload_sigma_kg},
          {"friction_nm", out.friction_nm},
          {"mean_nis", out.mean_nis},
          {"delay_found", out.delay_found},
          {"planned", in.planned != 0},
          {"warnings", warnings}};
}

std::optional<RequestKind> RequestByName(const std::string& name) {
  for (const RequestKind kind :
       {RequestKind::kArm, RequestKind::kStop, RequestKind::kDisarm, RequestKind::kReset}) {
    if (name == Name(kind)) return kind;
  }
  return std::nullopt;
}

}  // namespace

OperatorTask::OperatorTask(OperatorContext context)
    : context_(std::move(context)),
      delay_(context_.grid.period_ns, context_.delay_margin_s),
      commissioner_(*context_.config) {
  context_.stack->Calibrate(commissioner_.calibration());
  if (!context_.socket.empty()) socket_ = std::make_unique<OperatorSocket>(context_.socket);
  if (context_.unattended) PlanExperiment(*context_.unattended, {0.0, 0.0});
}

OperatorTask::~OperatorTask() = default;

Task::Traits OperatorTask::traits() const noexcept {
  return {.name = "operator",
          .period_ns = kPeriodNs,
          .phase_ns = 0,
          .deadline_ns = kPeriodNs,
          .priority = 0};
}

void OperatorTask::Run(const Activation& activation) noexcept {
  try {
    now_ns_ = activation.due_ns;
    FollowState();
    bus_journal_.Follow(now_ns_, context_.stack->buses(), context_.report);
    TakeTicks();
    TakeAnswers();
    if (socket_) Serve();
    FollowUnattended();
    FollowShutdown();
    while (!plans_.empty() && plans_.front().number < context_.stack->released_experiments()) {
      plans_.pop_front();
    }
    const bool alive =
        now_ns_ - permit_.renewed_ns < kAliveNs && now_ns_ - telemetry_.input.now_ns < kAliveNs;
    if (alive) context_.alive(now_ns_, Name(permit_.state));
  } catch (const std::exception& error) {
    context_.report(true, std::string("operator: ") + error.what());
  }
}

void OperatorTask::FollowState() {
  const Permit& permit = context_.stack->operator_permits().Read().At(now_ns_ - 1).value;
  if (permit.state != permit_.state) {
    const bool tripped = permit.state == SafetyState::kTripped;
    std::string text = std::string(Name(permit_.state)) + " -> " + Name(permit.state);
    if (tripped) {
      const std::string of_bus = context_.stack->BusText(permit.cause, permit.evidence);
      const std::string channel =
          TripChannelName(permit.cause, permit.evidence.channel, context_.config->sensors);
      text += std::string(": ") + Name(permit.cause) + (channel.empty() ? "" : ": " + channel) +
              (of_bus.empty() ? " (value " + std::to_string(permit.evidence.value) + ", limit " +
                                    std::to_string(permit.evidence.limit) + "). "
                              : ": " + of_bus + ". ") +
              OperatorText(permit.cause);
      if (!of_bus.empty()) {
        context_.events->Push({.time_ns = now_ns_,
                               .kind = "bus",
                               .name = Name(permit.cause),
                               .text = of_bus,
                               .value_json = {}});
      }
      trip_.store(permit.cause, std::memory_order_relaxed);
    }
    context_.report(tripped, text);
  }
  permit_ = permit;
}

void OperatorTask::TakeTicks() {
  while (context_.stack->operator_ticks().Pop(&telemetry_)) {
    commissioner_.Take(telemetry_);
    if (delay_.Take(telemetry_.input)) WarnOfDelay();
    WarnOfPayload(payload_.Take(telemetry_.input, telemetry_.output));
    if (delay_found_.Take(telemetry_.input, telemetry_.output)) WarnOfDelayFound();
  }
  if (std::optional<Json> answer = commissioner_.TakeAnswer()) {
    FinishCommissioning(std::move(*answer));
  }
}

void OperatorTask::WarnOfPayload(std::uint32_t warnings) {
  const StepOutput& out = telemetry_.output;
  for (const PayloadWarningText& warning : kPayloadWarnings) {
    if ((warnings & warning.bit) == 0) continue;
    const Json figures = PayloadJson(telemetry_.input, out);
    Warn(warning.name, warning.text + (": " + figures.dump()), figures);
  }
}

void OperatorTask::WarnOfDelay() {
  const Json figures{{"delay_ms", delay_.delay_ms()}, {"delay_margin_ms", delay_.margin_ms()}};
  const std::string text =
      "a torque acted later than predicted, and less than half of the loop's delay margin is "
      "left: " +
      figures.dump() + "; declare what the drives need (loop.actuation_delay_ms)";
  Warn("delay-margin", text, figures);
}

void OperatorTask::WarnOfDelayFound() {
  const auto samples = int{telemetry_.output.delay_found};
  const double period_ms = 1e-6 * static_cast<double>(context_.grid.period_ns);
  const Json figures{{"delay_found", samples},
                     {"delay_ms", delay_.delay_ms() + samples * period_ms}};
  const std::string text =
      std::string("torques act whole samples later or earlier than is declared and measured, as ") +
      "the sensors show: " + figures.dump() +
      "; the loop reckons with it until the arm is armed again, better declare it "
      "(loop.actuation_delay_ms)";
  Warn("delay-found", text, figures);
}

void OperatorTask::Warn(const std::string& name, const std::string& text, const Json& figures) {
  context_.events->Push({.time_ns = now_ns_,
                         .kind = "warning",
                         .name = name,
                         .text = text,
                         .value_json = figures.dump()});
  context_.report(true, text);
}

void OperatorTask::Serve() {
  for (const OperatorSocket::Message& message : socket_->Poll()) {
    Json answer;
    try {
      answer = Answer(message);
    } catch (const std::exception& error) {
      answer = {{"ok", false}, {"error", error.what()}};
    }
    if (!answer.is_null()) socket_->Reply(message.client, answer.dump());
  }
}

// Null: the answer comes when the safety task has judged.
Json OperatorTask::Answer(const OperatorSocket::Message& message) {
  const Json command = Json::parse(message.line, nullptr, false);
  if (!command.is_object() || !command.contains("command") || !command["command"].is_string()) {
    return Failure("not a command: expected a line like {\"command\": \"status\"}",
                   "use the flexarm program");
  }
  const std::string name = command["command"];
  if (name == "status") return Status();
  if (name == "sim") return PressLine(command);
  if (name == "run") return StartRun(command, message.client);
  if (Commissioner::Knows(name)) return StartCommissioning(command, message.client);
  if (const std::optional<RequestKind> kind = RequestByName(name)) {
    Ask(*kind, message.client);
    return nullptr;
  }
  return Failure("no such command: '" + name + "'",
                 "one of status, arm, run, stop, disarm, reset, tare, zero, calibrate, pluck, "
                 "home, sim");
}

Json OperatorTask::PressLine(const Json& command) {
  const std::optional<Line> line = LineByName(command.value("line", ""));
  const int level = command.value("level", -1);
  if (!line || (level != 0 && level != 1)) {
    return Failure("no such line or level",
                   "limit-1-low, limit-1-high, limit-2-low, limit-2-high, emergency-stop or "
                   "reset-button, and level 0 or 1");
  }
  if (!context_.stack->Press({.line = *line, .level = level})) {
    return Failure("this backend has no simulated switches", "press the real one");
  }
  context_.report(
      false, std::string("simulated line ") + Name(*line) + " set to " + std::to_string(level));
  return {{"ok", true},
          {"command", "sim"},
          {"state", Name(permit_.state)},
          {"line", Name(*line)},
          {"level", level}};
}

Json OperatorTask::StartRun(const Json& command, int client) {
  if (permit_.state != SafetyState::kArmed) {
    return {{"ok", false},
            {"refusal", Name(Refusal::kWrongState)},
            {"state", Name(permit_.state)},
            {"error", RefusalText(RequestKind::kRun, Refusal::kWrongState, permit_.state)}};
  }
  if (const std::string why = commissioner_.WhyNoRun(); !why.empty())
    return Failure(why, "then run");
  const std::string name = command.value("name", "experiment");
  PlanExperiment(context_.parse_experiment(command.value("experiment", ""), name),
                 {telemetry_.output.angle_rad[0], telemetry_.output.angle_rad[1]});
  Ask(RequestKind::kRun, client);
  return nullptr;
}

// Null: the answer comes when the command has ended.
Json OperatorTask::StartCommissioning(const Json& command, int client) {
  CommissioningMotion motion = commissioner_.Start(command, permit_.state);
  commissioning_client_ = client;
  commissioning_request_ = 0;
  if (motion.planned != nullptr) {
    Plan(std::move(motion.planned), command["command"], command.dump());
    Ask(RequestKind::kRun, kNoClient, motion.may_open);
    commissioning_request_ = request_number_;
  }
  return nullptr;
}

void OperatorTask::FinishCommissioning(Json answer) {
  const bool ok = answer.value("ok", false);
  answer["state"] = Name(permit_.state);
  if (permit_.state == SafetyState::kTripped) answer["trip"] = Name(permit_.cause);
  context_.stack->Calibrate(commissioner_.calibration());
  const std::string kept = answer.value("calibration_file", "");
  context_.report(
      !ok, answer.value("command", "") + (ok ? ": done" + (kept.empty() ? "" : ", kept in " + kept)
                                             : ": " + answer.value("error", "failed")));
  if (commissioning_client_ != kNoClient) socket_->Reply(commissioning_client_, answer.dump());
  commissioning_client_ = kNoClient;
}

void OperatorTask::PlanExperiment(const Experiment& experiment,
                                  const std::array<double, 2>& start_rad) {
  if (!context_.stack->simulated()) RefuseSimEvents(experiment);
  auto planned = std::make_unique<PlannedExperiment>(
      experiment, *context_.design, context_.grid.period_s(), start_rad, context_.limits);
  const Experiment chosen = planned->accepted;
  Plan(std::move(planned), chosen.name, chosen.text);
}

void OperatorTask::Plan(std::unique_ptr<PlannedExperiment> planned, const std::string& name,
                        const std::string& text) {
  context_.stack->Plan({.experiment = planned.get(), .number = ++plan_number_});
  plans_.push_back({.number = plan_number_, .experiment = std::move(planned)});
  experiment_name_ = name;
  context_.events->Push(
      {.time_ns = now_ns_, .kind = "experiment", .name = name, .text = text, .value_json = {}});
}

void OperatorTask::Ask(RequestKind kind, int client, LineLevels may_open) {
  const OperatorRequest request{
      .kind = kind, .number = ++request_number_, .not_before_ns = now_ns_, .may_open = may_open};
  if (client != kNoClient) waiting_.push_back({.number = request.number, .client = client});
  context_.stack->requests().Push(request);
}

void OperatorTask::TakeAnswers() {
  RequestAnswer answer{};
  while (context_.stack->answers().Pop(&answer)) {
    unattended_.Answered(answer);
    const bool ok = answer.refusal == Refusal::kNone;
    const std::string why = RefusalText(answer.kind, answer.refusal, answer.state);
    context_.report(!ok,
                    std::string(Name(answer.kind)) + (ok ? ": accepted" : ": refused: " + why));
    if (!ok && commissioner_.busy() && answer.number == commissioning_request_) {
      commissioner_.Abort();
      FinishCommissioning({{"ok", false}, {"refusal", Name(answer.refusal)}, {"error", why}});
    }
    if (waiting_.empty() || waiting_.front().number != answer.number) continue;
    Json reply{{"ok", ok}, {"command", Name(answer.kind)}, {"state", Name(permit_.state)}};
    if (!ok) {
      reply["refusal"] = Name(answer.refusal);
      reply["error"] = why;
    }
    socket_->Reply(waiting_.front().client, reply.dump());
    waiting_.pop_front();
  }
}

Json OperatorTask::Status() {
  const StepOutput& out = telemetry_.output;
  Json status{{"ok", true},
              {"state", Name(permit_.state)},
              {"time_s", static_cast<double>(now_ns_) * 1e-9},
              {"tick", telemetry_.input.tick},
              {"experiment", experiment_name_.empty() ? Json(nullptr) : Json(experiment_name_)},
              {"joint_angle_deg", {out.angle_rad[0] * kDegPerRad, out.angle_rad[1] * kDegPerRad}},
              {"torque_nm", out.torque_nm},
              {"modal_m", out.modal_m},
              {"root_strain", out.root_strain},
              {"at_rest", out.at_rest != 0},
              {"payload", PayloadJson(telemetry_.input, out)},
              {"delay_ms", delay_.delay_ms()},
              {"delay_max_ms", delay_.longest_ms()},
              {"delay_margin_ms", delay_.margin_ms()},
              {"levels", telemetry_.input.frame.levels},
              {"trip", nullptr},
              {"buses", BusStatusOf(context_.stack->buses())},
              {"threads", context_.thread_status()}};
  if (permit_.state == SafetyState::kTripped) {
    status["trip"] = {{"name", Name(permit_.cause)},
                      {"number", static_cast<int>(permit_.cause)},
                      {"value", permit_.evidence.value},
                      {"limit", permit_.evidence.limit},
                      {"channel", permit_.evidence.channel},
                      {"channel_name", TripChannelName(permit_.cause, permit_.evidence.channel,
                                                       context_.config->sensors)},
                      {"text", OperatorText(permit_.cause)}};
    const std::string of_bus = context_.stack->BusText(permit_.cause, permit_.evidence);
    status["trip"]["bus"] = of_bus.empty() ? Json(nullptr) : Json(of_bus);
  }
  return status;
}

void OperatorTask::FollowUnattended() {
  if (!context_.unattended || shutdown_.load(std::memory_order_relaxed)) return;
  const OperatorRequest request = unattended_.Update(now_ns_, permit_);
  if (request.kind != RequestKind::kNone) context_.stack->requests().Push(request);
  if (!unattended_.over()) return;
  if (unattended_.progress() == UnattendedRun::Progress::kRefused) {
    refused_.store(true, std::memory_order_relaxed);
  }
  if (over_ns_ == INT64_MAX) {
    over_ns_ = now_ns_ + (permit_.state == SafetyState::kTripped ? kAfterTripNs : kSettleNs);
  }
  if (now_ns_ >= over_ns_) done_.store(true, std::memory_order_release);
}

// One request a state: stop a run, then disarm, then it is Idle and done.
void OperatorTask::FollowShutdown() {
  if (!shutdown_.load(std::memory_order_relaxed) || done()) return;
  if (shutdown_since_ns_ == INT64_MAX) {
    shutdown_since_ns_ = now_ns_;
    context_.report(false, "shutting down: bringing the arm to rest");
  }
  const bool late = now_ns_ - shutdown_since_ns_ > kShutdownLimitNs;
  const bool moving =
      permit_.state == SafetyState::kRunning || permit_.state == SafetyState::kStopping;
  if (late || (!moving && permit_.state != SafetyState::kArmed)) {
    if (over_ns_ == INT64_MAX) over_ns_ = now_ns_ + kSettleNs;
    if (now_ns_ >= over_ns_) done_.store(true, std::memory_order_release);
    return;
  }
  if (permit_.state == shutdown_asked_in_) return;
  shutdown_asked_in_ = permit_.state;
  if (permit_.state == SafetyState::kRunning) Ask(RequestKind::kStop, kNoClient);
  if (permit_.state == SafetyState::kArmed) Ask(RequestKind::kDisarm, kNoClient);
}

}  // namespace flexarm
