#include "tools/torture/torture_session.h"

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>

#include "config/config.h"
#include "controller/design/design_controller.h"
#include "controller/design/design_verdict.h"
#include "controller/host/arm_verdicts.h"
#include "controller/host/run_info.h"
#include "controller/types/rejected_error.h"
#include "tools/sweep/plant_variant.h"

namespace flexarm {
namespace {

constexpr std::int64_t kNever = INT64_MAX;
constexpr std::size_t kEventDepth = 1'000, kTimingDepth = 64;
// Time stands still while an experiment is planned.
constexpr std::chrono::seconds kPlanWait{60};

// What BreakALimit uses is behind those of the scenario.
std::vector<Fault> NotYet(const TortureScenario& scenario) {
  std::vector<Fault> faults = scenario.faults;
  if (scenario.situation == Situation::kFaultStopping) {
    faults.push_back({.place = FaultPlace::kTorque,
                      .index = 1,
                      .kind = FaultKind::kGarbage,
                      .from_ns = kNever,
                      .to_ns = kNever,
                      .seed = scenario.seed});
  }
  for (Fault& fault : faults) fault.from_ns = fault.to_ns = kNever;
  return faults;
}

RigConfig PlantOf(const RigConfig& config, const TortureScenario& scenario) {
  std::vector<std::string> plant = scenario.plant;
  plant.push_back("sim.seed=" + std::to_string(scenario.seed % 1'000'000'000));
  return PlantWith(config, plant);
}

RigConfig LoggingTo(const std::filesystem::path& folder, RigConfig config) {
  config.daemon.log_directory = folder.string();
  return config;
}

// A config of a rig on wires has a simulated arm here, which begins at zero: no person proves its
// switches and its wiring, or measures its angles.
RigConfig Simulated(RigConfig config) {
  config.backend = "sim";
  config.commissioning.prove_before_run = false;
  if (config.commissioning.angles_at_start == AnglesAtStart::kLost) {
    config.commissioning.angles_at_start = AnglesAtStart::kAtZero;
  }
  return config;
}

// In memory where the machine has a folder for that, because each write is synced.
std::filesystem::path ParentOfFolders() {
  const std::filesystem::path in_memory = "/dev/shm";
  return std::filesystem::is_directory(in_memory) ? in_memory
                                                  : std::filesystem::temp_directory_path();
}

}  // namespace

TorturedRig::TorturedRig(RigConfig with_law)
    : config(Simulated(std::move(with_law))),
      design(DesignController(config)),
      delay_margin_s(JudgeDesign(config, design).delay_margin_s()),
      limits(MotionLimitsOf(config)) {}

TortureSession::TortureSession(const TorturedRig& rig, const TortureScenario& scenario,
                               const WatchRules& rules)
    : rig_(rig),
      scenario_(scenario),
      faults_(NotYet(scenario)),
      grid_(rig.config.loop),
      folder_(ParentOfFolders()),
      operator_config_(LoggingTo(folder_.path(), rig.config)),
      plant_(PlantOf(rig.config, scenario)),
      stack_(rig.config, plant_, rig.design, scenario.payload_kg, faults_),
      events_(kEventDepth),
      timing_(kTimingDepth),
      latch_(folder_.path() / "state", folder_.path().string(),
             [this](bool is_error, const std::string& text) {
               if (is_error) errors_.push_back(text);
             }),
      recording_(
          MakeRunInfo(rig.config, rig.design, "simulated", "sim"),
          [this](const RunInfo& info) -> std::unique_ptr<RunSink> {
            runs_.emplace_back();
            runs_.back().info = info;
            return std::make_unique<RunMemory>(&runs_.back());
          },
          [this](bool is_error, const std::string& text) {
            if (is_error) errors_.push_back(text);
          }),
      recorder_({.ticks = &stack_.tick_records(),
                 .safety = &stack_.safety_records(),
                 .timing = &timing_,
                 .events = &events_,
                 .truth = stack_.truth_records()},
                &recording_),
      executor_(scenario.wake_ups, faults_, 4'000 * kMs),
      watch_(rig.config, rules),
      now_ns_(scenario.wake_ups.start_ns) {
  stack_.BeginAt(now_ns_);
  latch_.Open();
  operator_.emplace(Context());
  client_.emplace((folder_.path() / "socket").string());
  for (Task* task : stack_.tasks()) {
    executor_.Add(*task, PlaceOf(task));
  }
  executor_.Add(*operator_, FaultPlace::kOperator);
  executor_.Add(recorder_);
}

std::optional<FaultPlace> TortureSession::PlaceOf(const Task* task) {
  if (task == &stack_.safety()) return FaultPlace::kSafety;
  if (task == &stack_.control()) return FaultPlace::kControl;
  if (task == stack_.planner()) return FaultPlace::kPlanner;
  if (task == stack_.drive_tasks().front()) return FaultPlace::kPlant;
  return std::nullopt;
}

OperatorContext TortureSession::Context() {
  return {.stack = &stack_,
          .latch = &latch_,
          .events = &events_,
          .design = &rig_.design,
          .config = &operator_config_,
          .grid = grid_,
          .delay_margin_s = rig_.delay_margin_s,
          .limits = rig_.limits,
          .arm_checks = {.design = {.result = ArmVerdict::Result::kPassed}, .simulated = true},
          .socket = (folder_.path() / "socket").string(),
          .unattended = {},
          .parse_experiment = ParseExperiment,
          .report =
              [this](bool is_error, const std::string& text) {
                if (is_error) errors_.push_back(text);
              },
          .thread_status = [] { return nlohmann::json::array(); },
          .alive = [](std::int64_t, const std::string&) {},
          .plan_wait = kPlanWait};
}

void TortureSession::RunUntil(std::int64_t until_ns) {
  while (now_ns_ < until_ns) {
    now_ns_ += kMs;
    executor_.RunUntil(now_ns_);
    watch_.Look(now_ns_, stack_.Sample());
    if (answered_ < sent_) TakeAnswers();  // a look each millisecond would take a fifth of the time
  }
}

bool TortureSession::RunUntilState(SafetyState state, std::int64_t within_ns) {
  const std::int64_t until_ns = now_ns_ + within_ns;
  while (now_ns_ < until_ns && stack_.status().state != state) RunFor(kMs);
  return stack_.status().state == state;
}

bool TortureSession::RunUntilAnswered(std::int64_t within_ns) {
  const std::int64_t until_ns = now_ns_ + within_ns;
  while (now_ns_ < until_ns && answered_ < sent_) RunFor(kMs);
  TakeAnswers();  // an answer to nothing is one too many
  return answered_ == sent_;
}

void TortureSession::TakeAnswers() {
  while (auto line = client_->Line()) {
    answer_ = *std::move(line);
    ++answered_;
  }
}

void TortureSession::Send(const std::string& line) {
  if (client_->Send(line)) ++sent_;
  watch_.Allow(nlohmann::json::parse(line).at("command").get<std::string>());
}

void TortureSession::Command(const char* name) { Send(nlohmann::json{{"command", name}}.dump()); }

void TortureSession::Press(const char* line, int level) {
  Send(nlohmann::json{{"command", "sim"}, {"line", line}, {"level", level}}.dump());
}

void TortureSession::RunMove() {
  const std::string experiment =
      "name = \"move\"\nduration_s = " + std::to_string(scenario_.move_s + 0.4) +
      "\n[[move]]\nstart_s = 0.0\nduration_s = " + std::to_string(scenario_.move_s) +
      "\nto_deg = [" + std::to_string(scenario_.move_to_deg[0]) + ", " +
      std::to_string(scenario_.move_to_deg[1]) + "]\n";
  Send(nlohmann::json{{"command", "run"}, {"experiment", experiment}}.dump());
}

bool TortureSession::BreakALimit() {
  constexpr std::int64_t kWithinNs = 3'000 * kMs;
  faults_.back().from_ns = now_ns_;
  const std::int64_t until_ns = now_ns_ + kWithinNs;
  while (now_ns_ < until_ns && !CauseLatched(state())) RunFor(kMs);
  faults_.back().to_ns = now_ns_;
  if (!CauseLatched(state())) {
    Press("emergency-stop", 0);
    RunUntilState(SafetyState::kTripped, 100 * kMs);
  }
  return CauseLatched(state());
}

void TortureSession::BeginFaults() {
  for (std::size_t i = 0; i < scenario_.faults.size(); ++i) {
    faults_[i].from_ns = now_ns_ + scenario_.faults[i].from_ns;
    const std::int64_t to_ns = scenario_.faults[i].to_ns;
    faults_[i].to_ns = to_ns == kNever ? kNever : now_ns_ + to_ns;
  }
}

void TortureSession::EndFaults() {
  for (Fault& fault : faults_) fault.to_ns = std::min(fault.to_ns, now_ns_);
  executor_.Release(now_ns_);
}

bool TortureSession::ShutDown(std::int64_t within_ns) {
  operator_->RequestShutdown();
  const std::int64_t until_ns = now_ns_ + within_ns;
  while (now_ns_ < until_ns && !operator_->done()) RunFor(kMs);
  return operator_->done();
}

void TortureSession::Finish() {
  for (Task* task : stack_.tasks()) task->Ended();
  operator_.reset();
  recorder_.Finish();
}

}  // namespace flexarm
