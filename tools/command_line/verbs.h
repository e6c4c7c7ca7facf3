#pragma once

namespace CLI {
class App;
}

namespace flexarm {

/// Exit code of the program (a contract of every verb).
struct Exit {
  static constexpr int kDone = 0;
  static constexpr int kFailed =
      1;  ///< the run failed or tripped, a replay differs, a check failed
  static constexpr int kBadInput = 2;  ///< bad usage, config or input

  int code = kDone;
};

// One function a verb, in verb_<name>.cpp: adds the verb, which sets `exit.code` when it runs. Bad
// input is thrown (InputError, ConfigError, Refused); RunProgram turns it into a message and
// kBadInput, and any other exception into kFailed.
void RegisterAnalyze(CLI::App& app, Exit& exit);
void RegisterAnalyzeCheck(CLI::App& analyze, Exit& exit);
void RegisterAnalyzeExcite(CLI::App& analyze, Exit& exit);
void RegisterAnalyzeLinearize(CLI::App& analyze, Exit& exit);
void RegisterAnalyzeParametric(CLI::App& analyze, Exit& exit);
void RegisterAnalyzeReduce(CLI::App& analyze, Exit& exit);
void RegisterAnalyzeTorsion(CLI::App& analyze, Exit& exit);
void RegisterBenchHost(CLI::App& app, Exit& exit);
void RegisterBenchmark(CLI::App& app, Exit& exit);
void RegisterBound(CLI::App& app, Exit& exit);
void RegisterCheck(CLI::App& app, Exit& exit);
void RegisterCheckHost(CLI::App& app, Exit& exit);
void RegisterCommission(CLI::App& app, Exit& exit);  ///< tare, zero, calibrate, pluck, home
void RegisterConfig(CLI::App& app, Exit& exit);
void RegisterConfigNew(CLI::App& config, Exit& exit);
void RegisterConfigReference(CLI::App& config, Exit& exit);
void RegisterConfigShow(CLI::App& config, Exit& exit);
void RegisterDashboard(CLI::App& app, Exit& exit);
void RegisterDesign(CLI::App& app, Exit& exit);
void RegisterDiff(CLI::App& app, Exit& exit);
void RegisterExplain(CLI::App& app, Exit& exit);
void RegisterExport(CLI::App& app, Exit& exit);
void RegisterGauges(CLI::App& app, Exit& exit);
void RegisterHealth(CLI::App& app, Exit& exit);
void RegisterIdentify(CLI::App& app, Exit& exit);
void RegisterInfo(CLI::App& app, Exit& exit);
void RegisterLinesOff(CLI::App& app, Exit& exit);
void RegisterLog(CLI::App& app, Exit& exit);  ///< recover
void RegisterModes(CLI::App& app, Exit& exit);
void RegisterOperate(CLI::App& app,
                     Exit& exit);  ///< status, arm, run, move, stop, disarm, reset, sim
void RegisterPlot(CLI::App& app, Exit& exit);
void RegisterProveSwitches(CLI::App& app, Exit& exit);
void RegisterReplay(CLI::App& app, Exit& exit);
void RegisterReport(CLI::App& app, Exit& exit);
void RegisterRig(CLI::App& app, Exit& exit);
void RegisterRun(CLI::App& app, Exit& exit);   ///< with move
void RegisterPath(CLI::App& app, Exit& exit);  ///< pause, resume, speed
void RegisterRuns(CLI::App& app, Exit& exit);  ///< with tag, untag and note
void RegisterSimulate(CLI::App& app, Exit& exit);
void RegisterSweep(CLI::App& app, Exit& exit);  ///< with merge and show
void RegisterTorture(CLI::App& app, Exit& exit);
void RegisterTripReport(CLI::App& app, Exit& exit);

}  // namespace flexarm
