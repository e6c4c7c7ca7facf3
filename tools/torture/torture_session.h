#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/config.h"
#include "controller/latch/trip_latch.h"
#include "controller/law/design.h"
#include "controller/operator/operator_task.h"
#include "controller/runlog/recorder_task.h"
#include "controller/types/loop_grid.h"
#include "tools/support/scratch_folder.h"
#include "tools/torture/disturbed_executor.h"
#include "tools/torture/line_client.h"
#include "tools/torture/scenario.h"
#include "tools/torture/session_watch.h"
#include "tools/torture/tortured_stack.h"

namespace flexarm {

/// A rig with one law, and its design: computed once for all scenarios.
struct TorturedRig {
  RigConfig config;
  Design design;
  double delay_margin_s;
  MotionLimits limits;

  explicit TorturedRig(RigConfig with_law);
};

/// The whole daemon from its start to its end on a simulated clock: operator task with its socket,
/// safety, control, bus and drives, recorder. The steps of a scenario are made through the socket.
class TortureSession {
 public:
  /// @param rig  outlives the session
  /// @throws ConfigError  the scenario's plant
  TortureSession(const TorturedRig& rig, const TortureScenario& scenario, const WatchRules& rules);

  void Watch(ActivationGuard* guard) noexcept { executor_.Watch(guard); }

  /// Runs until `until_ns`, millisecond by millisecond.
  void RunUntil(std::int64_t until_ns);
  void RunFor(std::int64_t ns) { RunUntil(now_ns_ + ns); }
  /// @returns whether it has come about within `within_ns`
  bool RunUntilState(SafetyState state, std::int64_t within_ns);

  /// Runs until each command has its answer, at most for `within_ns`. @returns whether they have
  bool RunUntilAnswered(std::int64_t within_ns);

  void Send(const std::string& line);
  /// One command without keys.
  void Command(const char* name);
  void Press(const char* line, int level);
  void RunMove();

  /// In mid-move: breaks a limit by a torque that is not that of the command, until that has
  /// latched. The arm is damped then, unless a reading became implausible as well: then it is
  /// Tripped, as by the emergency stop where the torque is too weak to break a limit. @returns
  /// whether a cause has latched
  bool BreakALimit();
  /// Faults begin now; their instants so far are relative.
  void BeginFaults();
  /// Faults end now.
  void EndFaults();

  /// The operator ends the daemon. @returns false: it was not done within `within_ns`
  bool ShutDown(std::int64_t within_ns);
  /// After the last task: closes the logs.
  void Finish();

  std::int64_t now_ns() const { return now_ns_; }
  SafetyState state() { return stack_.status().state; }
  TorturedStack& stack() { return stack_; }
  SessionWatch& watch() { return watch_; }
  long sent() const { return sent_; }
  long answered() const { return answered_; }
  /// The newest answer, one line of JSON.
  const std::string& answer() const { return answer_; }
  const std::deque<RunContents>& runs() const { return runs_; }
  /// Forgets the recorded runs but the newest.
  void DropRuns() {
    while (runs_.size() > 1) runs_.pop_front();
  }
  std::int64_t log_errors() const { return recording_.errors(); }
  const std::vector<Fault>& faults() const { return faults_; }
  /// Texts of the journal that are errors.
  const std::vector<std::string>& errors() const { return errors_; }

 private:
  OperatorContext Context();
  std::optional<FaultPlace> PlaceOf(const Task* task);
  void TakeAnswers();
  void TakeRecords();

  const TorturedRig& rig_;
  TortureScenario scenario_;
  std::vector<Fault> faults_;  // in the clock of the loop
  LoopGrid grid_;
  ScratchFolder folder_;
  RigConfig operator_config_;  // its calibration is a file of this session
  std::vector<std::string> errors_;
  RigConfig plant_;
  TorturedStack stack_;
  EventQueue events_;
  SpscQueue<TimingRecord> timing_;
  TripLatch latch_;
  std::deque<RunContents> runs_;
  RunRecording recording_;
  RecorderTask recorder_;
  std::optional<OperatorTask> operator_;
  std::optional<LineClient> client_;
  DisturbedExecutor executor_;
  SessionWatch watch_;
  std::string answer_;
  std::int64_t now_ns_;
  long sent_ = 0, answered_ = 0;
};

}  // namespace flexarm
