#include "tests/bench/safety_scenario.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <stdexcept>

#include "config/config.h"
#include "controller/tasks/safety_task.h"
#include "tests/bench/counted.h"

namespace flexarm {

namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr int kRuns = 40;  // ticks until the run is under way

// Numbers of the disturbances.
enum : unsigned {
  kLevels,
  kLoopFaults,
  kBusLost,
  kDriveFault,
  kUnreliable,
  kRequests,
  kStop,
  kDisarm,
  kLoopSilent,
  kDrivesSilent,
  kLateTick,
  kLines,
  kRelayContact,
  kShutdown,
};

struct Lines final : SafetyLines {
  Reading Read(std::int64_t) noexcept override { return reading; }
  Call Write(std::int64_t, const Outputs&) noexcept override { return write; }
  void HoldOff() noexcept override {}

  Reading reading{.levels = kHealthyLevels};
  Call write;
};

// A safety task with its channels, whose other sides are written here.
class Rig {
 public:
  explicit Rig(const MonitorLimits& limits) : task_(limits, Channels()) {}

  void Ask(RequestKind kind, std::int64_t not_before_ns = INT64_MIN) {
    requests_.Push({.kind = kind, .number = ++number_, .not_before_ns = not_before_ns});
  }

  // Publishes what a healthy rig does in every tick. At 10 and 20 the operator arms and runs.
  void Prepare() {
    due_ns_ += kMs;
    ++tick_;
    if (tick_ == 10) Ask(RequestKind::kArm);
    if (tick_ == 20) Ask(RequestKind::kRun);
    const bool on = DrivesEnabled(task_.status().state);
    loop_ = {.tick = tick_,
             .due_ns = due_ns_,
             .faults = 0,
             .evidence = {},
             .at_rest = !TorqueAllowed(task_.status().state),
             .experiment_done = false,
             .missed_in_a_row = 0,
             .may_damp = true};
    drive_ = {.due_ns = due_ns_, .bus_ok = true, .drive_ok = true};
    drive_.power = on ? DrivePower::kOn : DrivePower::kOff;
    lines_.reading = {.levels = kHealthyLevels};
    lines_.write = {};
    late_ns_ = 0;
    loop_speaks_ = drives_speak_ = true;
  }

  void Disturb(const Words& words) {
    const TripCauses any =
        (TripCauses{words[4]} << 32 | words[3]) & ((TripCauses{1} << kTripCauses) - 1);
    if (Happens(words, kLevels)) lines_.reading.levels ^= words[2] & ((1u << kLines) - 1);
    if (Happens(words, kLoopFaults)) loop_.faults = any;
    if (Happens(words, kBusLost)) drive_.bus_ok = false;
    if (Happens(words, kDriveFault)) drive_.drive_ok = false;
    if (Happens(words, kUnreliable)) {
      drive_.failed_in_window = drive_.slow_in_window = static_cast<int>(words[5] % 64);
      loop_.missed_in_window = loop_.missed_in_a_row = static_cast<int>(words[5] >> 8 & 63u);
    }
    if (Happens(words, kRequests)) {
      for (std::uint32_t i = 0; i < words[6] % 32; ++i) {
        const bool later = (words[7] >> i & 1u) != 0;
        Ask(static_cast<RequestKind>(1 + (words[6] + i) % 6), later ? INT64_MAX : INT64_MIN);
      }
    }
    if (Happens(words, kStop)) stop_.Set(++number_);
    if (Happens(words, kDisarm)) disarm_.Set(++number_);
    loop_speaks_ = !Happens(words, kLoopSilent);
    drives_speak_ = !Happens(words, kDrivesSilent);
    if (Happens(words, kLateTick)) late_ns_ = words[5] % (20 * kMs);
    if (Happens(words, kLines)) {
      lines_.reading.call = {.ok = (words[2] >> 8 & 1u) == 0, .took_ns = words[5] % (20 * kMs)};
      lines_.write = {.ok = (words[2] >> 9 & 1u) == 0, .took_ns = words[6] % (20 * kMs)};
    }
    if (Happens(words, kRelayContact)) {
      lines_.reading.relay = static_cast<RelayContact>((words[2] >> 16) % 3);
    }
    if (Happens(words, kShutdown)) shutting_down_ = true;
  }

  void Publish() {
    if (loop_speaks_) {
      loops_.Push(due_ns_, loop_);
      loop_reports_.Publish(loops_);
    }
    if (drives_speak_) {
      drives_.Push(due_ns_, drive_);
      for (DriveReportChannel& channel : drive_reports_) channel.Publish(drives_);
    }
  }
  Task::Activation Now() const {
    return {.due_ns = due_ns_, .missed_in_a_row = 0, .late_ns = late_ns_};
  }
  // Not counted.
  void Tick() {
    Publish();
    task_.Run(Now());
  }
  void TickCounted() {
    Publish();
    Counted([this] { task_.Run(Now()); });
  }

  SafetyState state() const { return task_.status().state; }

 private:
  SafetyChannels Channels() {
    return {.lines = &lines_,
            .control = &loop_reports_,
            .drives = {&drive_reports_[0], &drive_reports_[1]},
            .requests = &requests_,
            .stop = &stop_,
            .disarm = &disarm_,
            .shutting_down = &shutting_down_,
            .reduced = &reduced_,
            .wakeups = {&wakeup_},
            .permits = {&permits_[0], &permits_[1], &permits_[2], &permits_[3]},
            .answers = &answers_,
            .records = &records_,
            .timing = &timing_,
            .present = &present_};
  }

  Lines lines_;
  ControlReport loop_ = kNoControlReport;
  DriveReport drive_ = kNoDriveReport;
  ControlReportHistory loops_{kNoControlReport};
  DriveReportHistory drives_{kNoDriveReport};
  ControlReportChannel loop_reports_{loops_};
  std::array<DriveReportChannel, 2> drive_reports_{DriveReportChannel{drives_},
                                                   DriveReportChannel{drives_}};
  std::array<PermitChannel, 4> permits_{
      PermitChannel{PermitHistory(kNoPermit)}, PermitChannel{PermitHistory(kNoPermit)},
      PermitChannel{PermitHistory(kNoPermit)}, PermitChannel{PermitHistory(kNoPermit)}};
  SpscQueue<OperatorRequest> requests_{1000};
  LatchedRequest stop_, disarm_;
  std::atomic<bool> reduced_{false};
  std::atomic<bool> shutting_down_{false};
  Wakeup wakeup_;
  SpscQueue<RequestAnswer> answers_{1000};
  SpscQueue<SafetyRecord> records_{1000};
  TimingChannel timing_{TimingCounts{}};
  PresentCausesChannel present_{PresentCauses{}};
  SafetyTask task_;
  std::uint32_t number_ = 0;
  std::int64_t due_ns_ = 0, late_ns_ = 0;
  int tick_ = 0;
  bool loop_speaks_ = true, drives_speak_ = true;
};

}  // namespace

SafetyScenario::SafetyScenario(InstructionCounter& counter) : counter_(&counter) {
  const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml");
  limits_ = MakeMonitorLimits(config.safety, config.loop, true);
}

std::int64_t SafetyScenario::Median() {
  const auto rig = std::make_unique<Rig>(limits_);
  std::vector<std::int64_t> counts;
  for (int i = 0; i < 500; ++i) {
    rig->Prepare();
    rig->TickCounted();
    counts.push_back(counter_->Last());
    if (i == kRuns && rig->state() != SafetyState::kRunning) {
      throw std::runtime_error("the safety scenario does not run");
    }
  }
  std::sort(counts.begin(), counts.end());
  return counts[counts.size() / 2];
}

std::int64_t SafetyScenario::Cost(const Candidate& candidate) {
  const auto rig = std::make_unique<Rig>(limits_);
  for (int i = 0; i < kRuns; ++i) {
    rig->Prepare();
    rig->Tick();
  }
  std::int64_t most = 0;
  for (std::size_t i = 0; i < kDisturbances; ++i) {
    rig->Prepare();
    rig->Disturb(WordsOf(candidate, i));
    rig->TickCounted();
    most = std::max(most, counter_->Last());
  }
  return most;
}

}  // namespace flexarm
