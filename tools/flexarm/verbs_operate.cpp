#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "controller/operator/arm_verdict.h"
#include "controller/operator/prove_switches.h"
#include "controller/runlog/errors.h"
#include "tools/command_line/verbs.h"
#include "tools/flexarm/daemon_client.h"
#include "tools/flexarm/override_options.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

// The check of the host takes 3 s at most, the tests of the power path as long again.
constexpr double kLongestArm_s = 10.0;

struct OperateOptions {
  DaemonClient daemon;
  std::filesystem::path experiment;
  std::string line;
  int level = 0;
  bool watch = false;
  OverrideOptions overrides;
};

// When the trip was, and whether by this daemon or before its start.
void PrintTripTime(const Json& trip) {
  const auto text = [&trip](const char* key) {
    const auto found = trip.find(key);
    return found != trip.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  const std::string time = text("time_utc"), problem = text("record_problem");
  const bool before = trip.value("before_start", false);
  if (!time.empty()) {
    std::printf("               %s%s\n", time.c_str(), before ? ", before the daemon's start" : "");
  }
  if (!problem.empty()) std::printf("               %s\n", problem.c_str());
}

// Verdict of one check before arming, and what it found.
void PrintVerdict(const Json& s, const char* key) {
  if (!s.contains(key) || !s[key].is_object()) return;
  std::printf("%-14s %s\n", key, s[key].value("verdict", "-").c_str());
  for (const Json& finding : s[key].value("findings", Json::array())) {
    std::printf("               %s%s: %s\n", finding.value("advice", false) ? "advice: " : "",
                finding.value("name", "").c_str(), finding.value("text", "").c_str());
  }
}

// What the driver of a bus rejected or missed; nothing while all is 0.
void PrintCounters(const Json& bus) {
  std::string text;
  const Json counters = bus.value("counters", Json::object());  // outlives the loop
  for (const auto& [name, count] : counters.items()) {
    if (count == 0) continue;
    text += (text.empty() ? "" : ", ") + name + " " + count.dump();
  }
  if (!text.empty()) std::printf("               %s\n", text.c_str());
}

// Of the computer: threads, buses, log.
void PrintHealth(const Json& s) {
  if (s.contains("timing") && s["timing"].is_object()) {
    const Json& timing = s["timing"];
    std::printf(
        "late threads   safety %u times, worst %.1f ms; deadlines missed in a row %u times, "
        "often %u times; %s\n",
        timing.value("safety_overruns", 0U), timing.value("safety_worst_ms", 0.0),
        timing.value("deadlines_missed_in_a_row", 0U), timing.value("deadlines_often_missed", 0U),
        timing.value("trips", true) ? "each trips" : "simulated arm: no trip");
  }
  for (const Json& bus : s.value("buses", Json::array())) {
    std::printf(
        "%-14s %s, %u failed exchanges, recovered %u times, longest exchange %.1f of %.1f "
        "ms, %u longer%s%s\n",
        bus.value("name", "").c_str(), bus.value("ok", false) ? "ok" : "lost",
        bus.value("failed", 0U), bus.value("recovered", 0U), bus.value("longest_ms", 0.0),
        bus.value("declared_ms", 0.0), bus.value("slow", 0U), bus["fault"].is_string() ? "; " : "",
        bus["fault"].is_string() ? bus["fault"].get<std::string>().c_str() : "");
    PrintCounters(bus);
  }
  if (const auto dropped = s.value("log_records_dropped", std::uint64_t{0}); dropped != 0) {
    std::printf("log            %llu records dropped: the recorder was too slow\n",
                static_cast<unsigned long long>(dropped));
  }
  for (const Json& thread : s.value("threads", Json::array())) {
    std::printf(
        "%-14s %llu activations, %llu missed deadlines, %llu skipped periods, worst lateness %.0f "
        "us\n",
        thread.value("name", "").c_str(),
        static_cast<unsigned long long>(thread.value("activations", std::uint64_t{0})),
        static_cast<unsigned long long>(thread.value("missed_deadlines", std::uint64_t{0})),
        static_cast<unsigned long long>(thread.value("skipped_periods", std::uint64_t{0})),
        thread.value("worst_lateness_us", 0.0));
  }
}

// Of the arm.
void PrintStatus(const Json& s) {
  std::printf("state          %s\n", s.value("state", "-").c_str());
  for (const Json& given : s.value("overrides", Json::array())) {
    std::printf("override       %s: %s\n", given.value("condition", "").c_str(),
                given.value("reason", "").c_str());
  }
  PrintVerdict(s, "host");
  PrintVerdict(s, "design");
  if (s.contains("trip") && s["trip"].is_object()) {
    std::printf("trip           %s: %s\n", s["trip"].value("name", "").c_str(),
                s["trip"].value("text", "").c_str());
    if (s["trip"].contains("bus") && s["trip"]["bus"].is_string()) {
      std::printf("               %s\n", s["trip"]["bus"].get<std::string>().c_str());
    }
    PrintTripTime(s["trip"]);
  }
  if (s.contains("latch_problem") && s["latch_problem"].is_string()) {
    std::printf("latch file     %s\n", s["latch_problem"].get<std::string>().c_str());
  }
  std::printf("time           %.2f s (tick %lld)\n", s.value("time_s", 0.0),
              static_cast<long long>(s.value("tick", std::int64_t{0})));
  const auto pair = [&s](const char* key) { return s.value(key, std::vector<double>{0.0, 0.0}); };
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const Json& angle = s["joint_angle_deg"][joint];
    std::printf("%s", joint == 0 ? "joint angle    " : ", ");
    angle.is_number() ? std::printf("%.2f", angle.get<double>()) : std::printf("unknown");
  }
  std::printf(" deg\n");
  for (const Json& why : s.value("joint_angle_unknown", Json::array())) {
    if (why.is_string()) std::printf("               %s\n", why.get<std::string>().c_str());
  }
  std::printf("torque asked   %.3f, %.3f N m\n", pair("torque_nm")[0], pair("torque_nm")[1]);
  std::printf("at rest        %s\n", s.value("at_rest", false) ? "yes" : "no");
  if (const auto gauges = s.value("gauges_missing", std::vector<std::string>{}); !gauges.empty()) {
    std::printf("gauges missing");
    for (const std::string& gauge : gauges) std::printf(" %s", gauge.c_str());
    std::printf("\n");
  }
  std::printf("delay          %.2f ms, longest %.2f ms; %.1f ms of margin left\n",
              s.value("delay_ms", 0.0), s.value("delay_max_ms", 0.0),
              s.value("delay_margin_ms", 0.0));
  if (s.contains("payload") && s["payload"].is_object()) {
    const Json& payload = s["payload"];
    std::printf("payload        %.3f kg, standard deviation %.3f kg", payload.value("kg", 0.0),
                payload.value("sigma_kg", 0.0));
    if (const int samples = payload.value("delay_found", 0); samples != 0) {
      std::printf("; delay found: %+d samples more than declared", samples);
    }
    for (const Json& warning : payload.value("warnings", Json::array())) {
      std::printf("; %s", warning.get<std::string>().c_str());
    }
    std::printf("\n");
  }
}

int Status(const OperateOptions& options) {
  for (;;) {
    const Json answer = options.daemon.Ask({{"command", "status"}});
    if (options.daemon.json) {
      std::cout << answer.dump(2) << '\n';
    } else {
      if (options.watch) std::printf("\033[H\033[2J");
      PrintStatus(answer);
      PrintHealth(answer);
    }
    std::cout.flush();
    std::fflush(stdout);
    if (!options.watch) return Exit::kDone;
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
}

int RunExperiment(const OperateOptions& options) {
  const Experiment experiment = LoadExperiment(options.experiment);  // throws with file and line
  Json command{{"command", "run"},
               {"name", options.experiment.filename().string()},
               {"experiment", experiment.text}};
  options.overrides.PutInto(&command);
  return options.daemon.Conclude(options.daemon.Ask(command));
}

void AddCommand(CLI::App& app, Exit& exit, const char* name, const char* what, const char* footer) {
  const auto options = std::make_shared<OperateOptions>();
  CLI::App* verb = options->daemon.AddVerb(app, name, what);
  verb->footer(footer);
  verb->callback([options, &exit, name] {
    exit.code = options->daemon.Conclude(options->daemon.Ask({{"command", name}}));
  });
}

void RegisterArm(CLI::App& app, Exit& exit) {
  const auto arm = std::make_shared<OperateOptions>();
  CLI::App* verb = arm->daemon.AddVerb(app, "arm", "Close the relay: zero torque, ready to run");
  arm->overrides.AddTo(verb, "--override-host", kHostCondition,
                       "Arm a wired rig although this machine is not good enough for one");
  arm->overrides.AddTo(verb, "--override-design", kDesignCondition,
                       "Arm a wired rig although its gains were written with design --force");
  verb->footer(
      "Only from Idle, at rest, with no fault present, with a design that `flexarm design`\n"
      "accepts, and on a wired rig with a machine that `flexarm check-host` finds ready. The\n"
      "REASON of an override, one line of up to 200 bytes, is in the journal, in the run's log\n"
      "and, until the arm is disarmed, in the status (docs/safety.md).\n"
      "Examples: flexarm arm\n"
      "          flexarm arm --override-host \"bench test, drives without power\"");
  verb->callback([arm, &exit] {
    Json command = {{"command", "arm"}};
    arm->overrides.PutInto(&command);
    exit.code = arm->daemon.Conclude(arm->daemon.Ask(command, kLongestArm_s));
  });
}

}  // namespace

void RegisterOperate(CLI::App& app, Exit& exit) {
  const auto status = std::make_shared<OperateOptions>();
  CLI::App* verb = status->daemon.AddVerb(
      app, "status",
      "Show the state of the running daemon: safety, angles, torques, delay, buses, threads");
  verb->add_flag("--watch", status->watch, "Repeat every half second until interrupted");
  verb->footer("Example: flexarm status --watch");
  verb->callback([status, &exit] { exit.code = Status(*status); });

  RegisterArm(app, exit);

  const auto run = std::make_shared<OperateOptions>();
  verb = run->daemon.AddVerb(app, "run", "Run an experiment on the armed arm");
  verb->add_option("experiment", run->experiment, "Experiment, a TOML file")
      ->required()
      ->type_name("EXPERIMENT");
  run->overrides.AddTo(verb, "--override-switches", kSwitchesCondition,
                       "Run a wired rig although its switches have not been proved");
  verb->footer(
      "Only from Armed. The daemon first compares the reference with the limits of the rig: a\n"
      "refusal names the row, the joint, the value and the limit (docs/experiments.md). A wired "
      "rig\n"
      "needs the proof of its switches (flexarm prove-switches).\n"
      "Example: flexarm run config/experiments/square-30deg.toml");
  verb->callback([run, &exit] { exit.code = RunExperiment(*run); });

  AddCommand(app, exit, "stop", "End the experiment: the controller brings the arm to rest",
             "The controller damps the arm for at most 3 s, then the state is Armed. Example: "
             "flexarm stop");
  AddCommand(app, exit, "disarm", "Open the relay",
             "Only from Armed; stop first. Example: flexarm disarm");
  AddCommand(app, exit, "reset", "Leave Tripped for Idle",
             "Only after the reset button was pressed, at rest, with the cause gone.\n"
             "Example: flexarm reset");

  const auto sim = std::make_shared<OperateOptions>();
  verb = sim->daemon.AddVerb(
      app, "sim", "Set a digital line of the simulated rig: a switch or the reset button");
  verb->add_option(
          "line", sim->line,
          "limit-1-low, limit-1-high, limit-2-low, limit-2-high, emergency-stop, reset-button")
      ->required()
      ->type_name("LINE");
  verb->add_option("level", sim->level, "0 or 1; switches are closed (1) when healthy")
      ->required()
      ->check(CLI::Range(0, 1))
      ->type_name("LEVEL");
  verb->footer(
      "Examples: flexarm sim emergency-stop 0    the emergency stop is pressed\n"
      "          flexarm sim reset-button 1      pressed; 50 ms later 0: released");
  verb->callback([sim, &exit] {
    exit.code = sim->daemon.Conclude(
        sim->daemon.Ask({{"command", "sim"}, {"line", sim->line}, {"level", sim->level}}));
  });
}

}  // namespace flexarm
