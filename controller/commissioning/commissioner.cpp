#include "controller/commissioning/commissioner.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "controller/commissioning/calibration_file.h"
#include "controller/runlog/csv.h"
#include "controller/types/named_rejection.h"
#include "hal/line_names.h"
#include "model/units.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;

// Tare and zero are possible after a trip, because wrong zeros can be its cause, and a reset wants
// the cause gone.
bool RemovesACause(const std::string& command) { return command == "tare" || command == "zero"; }

void RequireRelayOpen(const std::string& command, SafetyState state) {
  const bool also_tripped = RemovesACause(command);
  if (state == SafetyState::kIdle || (also_tripped && state == SafetyState::kTripped)) return;
  throw NamedRejection("wrong-state",
                       command + " needs the state Idle" + (also_tripped ? " or Tripped" : "") +
                           ", but the state is " + ToString(state) + ": run `flexarm disarm`" +
                           (also_tripped ? "" : ", or `flexarm reset` after a trip"));
}

void RequireArmed(const std::string& command, SafetyState state) {
  if (state == SafetyState::kArmed) return;
  throw NamedRejection("wrong-state",
                       command + " moves the arm and needs the state Armed, but the state is " +
                           ToString(state) + ": run `flexarm arm`");
}

double Number(const Json& command, const char* key) {
  const auto found = command.find(key);
  if (found == command.end() || !found->is_number()) {
    throw RejectedError(std::string("expected a number in '") + key + "'");
  }
  return found->get<double>();
}

int OneOrTwo(const Json& command, const char* key) {
  const double value = Number(command, key);
  if (value != 1.0 && value != 2.0) throw RejectedError(std::string(key) + " must be 1 or 2");
  return static_cast<int>(value);
}

Json StrainJson(const SensorConfig& sensors, const Calibration& calibration,
                const RestReadings& readings) {
  Json rows = Json::array();
  const std::vector<std::string> names = StrainColumns(sensors);
  for (std::size_t i = 0; i < names.size(); ++i) {
    rows.push_back({{"channel", names[i]},
                    {"zero_counts", calibration.strain_zero_counts[i]},
                    {"gain_error", calibration.strain_gain_error[i]},
                    {"mean_counts", readings.strain_mean[i]},
                    {"sigma_counts", readings.strain_sigma[i]}});
  }
  return rows;
}

Json EncoderJson(const SensorConfig& sensors, const Calibration& calibration) {
  Json rows = Json::array();
  for (const EncoderConfig& encoder : sensors.encoder) {
    rows.push_back(
        {{"joint", CounterName(encoder.counter)},
         {"zero_counts", calibration.counter_zero[static_cast<std::size_t>(encoder.counter)]}});
  }
  return rows;
}

}  // namespace

// Exactly one of the two continuations is set.
struct Commissioner::Job {
  std::string command;
  SafetyState state = SafetyState::kIdle;  // in which it measures
  RestMeter rest{1};
  FromRest from_rest;
  FromRun from_run;
  std::uint32_t run_number = 0;         // of its motion
  std::int64_t granted_ns = INT64_MAX;  // not before its motion was granted
  std::vector<TickRecord> run;
};

Commissioner::Commissioner(const RigConfig& config)
    : config_(config),
      file_(std::filesystem::path(config.daemon.log_directory) /
            config.commissioning.calibration_file),
      gains_(config.arm, config.sensors),
      angles_(config.commissioning.angles_at_start, config.sensors) {
  const std::optional<Calibration> found = ReadCalibration(file_, config.sensors);
  if (!found) return;
  calibration_ = *found;
  if (config.commissioning.angles_at_start == AnglesAtStart::kAbsolute) return;
  calibration_.counter_zero = {};
}

Commissioner::~Commissioner() = default;

void Commissioner::Abort() { job_.reset(); }

void Commissioner::Expect(std::uint32_t run_number) { job_->run_number = run_number; }

void Commissioner::Granted(std::uint32_t run_number, std::int64_t now_ns) {
  if (busy() && run_number == job_->run_number) job_->granted_ns = now_ns;
}

bool Commissioner::Knows(const std::string& command) {
  return command == "tare" || command == "zero" || command == "calibrate" || command == "pluck" ||
         command == "home";
}

std::string Commissioner::WhyNoRun() const {
  if (NeedsPluck()) {
    return "The wiring has not been tested since the daemon started. Run `flexarm pluck` first.";
  }
  for (std::size_t joint = 0; joint < 2; ++joint) {
    if (!angles_.knows(joint)) return angles_.Text(joint);
  }
  return {};
}

CommissioningMotion Commissioner::Start(const Json& command, SafetyState state,
                                        bool reduced_limits) {
  if (busy())
    throw NamedRejection(
        "busy", "busy with " + job_->command + ": wait until it ends, or run `flexarm stop`");
  const std::string name = command.value("command", "");
  if (name == "pluck") return StartPluck(state, reduced_limits);
  if (name == "home") return StartHome(command, state);
  if (name == "zero") {
    StartZero(command, state);
  } else if (name == "calibrate") {
    StartCalibrate(command, state);
  } else {
    StartRest(name, state, [this](const RestReadings& readings) {
      Adopt(Tare(config_.sensors, readings, calibration_));
      gains_ =
          GainCalibration(config_.arm, config_.sensors);  // loads are measured from the new zeros
      return Json{{"strain", StrainJson(config_.sensors, calibration_, readings)}};
    });
  }
  return {};
}

void Commissioner::StartRest(const std::string& command, SafetyState state, FromRest then) {
  RequireRelayOpen(command, state);
  const double ticks = config_.commissioning.measure_s / config_.loop.period_s();
  job_ = std::make_unique<Job>(Job{.command = command,
                                   .state = state,
                                   .rest = RestMeter(static_cast<int>(std::lround(ticks))),
                                   .from_rest = std::move(then),
                                   .from_run = {},
                                   .run_number = 0,
                                   .run = {}});
}

void Commissioner::StartZero(const Json& command, SafetyState state) {
  std::array<double, 2> hub_rad{};
  if (const auto found = command.find("angle_deg"); found != command.end()) {
    if (!found->is_array() || found->size() != 2 || !(*found)[0].is_number() ||
        !(*found)[1].is_number()) {
      throw RejectedError("angle_deg must be two numbers");
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const double angle_deg = (*found)[i].get<double>();
      const double most_deg = config_.safety.soft_angle_deg[i];
      if (!(std::fabs(angle_deg) <= most_deg)) {  // also refuses a NaN
        throw RejectedError(fmt::format(
            "angle_deg of joint {} is {:g}: at most {:g} (limits.soft_angle_deg), because an arm "
            "beyond its soft limit trips",
            i + 1, angle_deg, most_deg));
      }
      hub_rad[i] = angle_deg * kRadPerDeg;
    }
  }
  StartRest("zero", state, [this, hub_rad](const RestReadings& readings) {
    Adopt(Zero(config_.sensors, readings, hub_rad, calibration_));
    for (std::size_t joint = 0; joint < 2; ++joint) angles_.Know(joint);
    return Json{{"encoder", EncoderJson(config_.sensors, calibration_)}};
  });
}

void Commissioner::StartCalibrate(const Json& command, SafetyState state) {
  const StaticLoad load{.link = OneOrTwo(command, "link"),
                        .force_n = Number(command, "force_n"),
                        .at_m = Number(command, "at_m")};
  double length_m = 0.0;
  for (const BeamSection& section :
       config_.arm.link[static_cast<std::size_t>(load.link - 1)].section) {
    length_m += section.length_m;
  }
  if (!(load.at_m > 0.0) || load.at_m > length_m) {
    throw RejectedError("at_m must lie on link " + std::to_string(load.link) +
                        ", above 0 and at most " + std::to_string(length_m) + " m");
  }
  if (load.force_n == 0.0) throw RejectedError("force_n must not be zero");
  StartRest("calibrate", state, [this, load](const RestReadings& readings) {
    Adopt(gains_.Add(load, readings, calibration_));
    return Json{{"strain", StrainJson(config_.sensors, calibration_, readings)}};
  });
}

// With reduced limits the pulse has their share of its torque: the full one turns a hub faster than
// they allow.
CommissioningMotion Commissioner::StartPluck(SafetyState state, bool reduced_limits) {
  RequireArmed("pluck", state);
  job_ = std::make_unique<Job>();
  job_->command = "pluck";
  job_->from_run = [this](const std::vector<TickRecord>& run) { return Pluck(run); };
  CommissioningConfig pulse = config_.commissioning;
  if (reduced_limits) {
    for (double& torque_nm : pulse.pluck_torque_nm) torque_nm *= config_.safety.reduced_torque;
  }
  return {
      .planned = std::make_unique<PlannedExperiment>(PluckTorques(pulse, config_.loop.period_s())),
      .may_open = 0};
}

CommissioningMotion Commissioner::StartHome(const Json& command, SafetyState state) {
  RequireArmed("home", state);
  if (NeedsPluck()) {
    throw NamedRejection(
        "not-plucked",
        "homing is a controlled motion, but the wiring has not been tested: run `flexarm pluck`");
  }
  const auto joint = static_cast<std::size_t>(OneOrTwo(command, "joint") - 1);
  const auto given = command.find("side");
  const std::string side =
      given != command.end() && given->is_string() ? given->get<std::string>() : "";
  if (side != "low" && side != "high") throw RejectedError("side must be low or high");
  const std::size_t number = 2 * joint + (side == "high" ? 1 : 0);
  const auto line = static_cast<Line>(number);  // limit 1 low, 1 high, 2 low, 2 high
  const CommissioningConfig& c = config_.commissioning;
  const double step_rad = c.home_rate_deg_per_s * kRadPerDeg * config_.loop.period_s();
  const HomingPlan plan{.line = line,
                        .joint = joint,
                        .step_rad = side == "high" ? step_rad : -step_rad,
                        .travel_rad = c.home_travel_deg * kRadPerDeg,
                        .back_rad = c.home_back_deg * kRadPerDeg};
  job_ = std::make_unique<Job>();
  job_->command = "home";
  const double switch_deg = c.switch_angle_deg[number];
  job_->from_run = [this, joint, line, switch_deg](const std::vector<TickRecord>& run) {
    return Home(run, joint, line, switch_deg);
  };
  return {.planned = std::make_unique<PlannedExperiment>(plan), .may_open = LineBit(line)};
}

Json Commissioner::Pluck(const std::vector<TickRecord>& run) {
  const PluckVerdict verdict = JudgePluck(config_, run);
  proven_ = verdict.passed();
  Json answer{{"passed", verdict.passed()}, {"answer", Json::array()}, {"finding", Json::array()}};
  for (const PluckAnswer& a : verdict.answer) {
    answer["answer"].push_back(
        {{"channel", a.channel}, {"gain", a.gain}, {"match", a.match}, {"provable", a.provable}});
  }
  std::string text;
  for (const PluckFinding& f : verdict.finding) {
    answer["finding"].push_back({{"channel", f.channel}, {"problem", f.problem}});
    text += "\n  " + f.channel + ": " + f.problem;
  }
  if (!verdict.passed()) {
    answer["ok"] = false;
    answer["error"] = "the wiring differs from the config:" + text;
  }
  return answer;
}

Json Commissioner::Home(const std::vector<TickRecord>& run, std::size_t joint, Line line,
                        double switch_deg) {
  for (const TickRecord& tick : run) {
    if ((tick.input.frame.levels & LineBit(line)) != 0) continue;
    Calibration found = calibration_;
    for (const EncoderConfig& encoder : config_.sensors.encoder) {
      const auto i = static_cast<std::size_t>(encoder.counter);
      if (i % 2 != joint) continue;
      found.counter_zero[i] = tick.output.counts[i] - std::llround(encoder.sign * switch_deg /
                                                                   360.0 * encoder.counts_per_turn);
    }
    Adopt(found);
    angles_.Know(joint);
    return {{"encoder", EncoderJson(config_.sensors, calibration_)},
            {"contact_before_deg", tick.output.angle_rad[joint] / kRadPerDeg},
            {"contact_deg", switch_deg}};
  }
  throw RejectedError(std::string(ToString(line)) + " did not open: move the joint to within " +
                      std::to_string(config_.commissioning.home_travel_deg) +
                      " deg of it by hand, and check the switch");
}

void Commissioner::Follow(const CountEpochs& epochs) { EndIfLost(angles_.Follow(epochs)); }

void Commissioner::EndIfLost(std::uint8_t joints) {
  if (joints == 0 || job_ == nullptr) return;
  const std::size_t joint = (joints & 1U) != 0 ? 0 : 1;
  answer_ = std::make_unique<Json>(
      Json{{"ok", false}, {"command", job_->command}, {"error", angles_.Text(joint)}});
  job_.reset();
}

void Commissioner::Take(const TickRecord& tick) {
  EndIfLost(angles_.Follow(tick));
  if (job_ == nullptr) return angles_.BeginAtZero(tick, &calibration_);
  const SafetyState state = tick.input.safety_state;
  const Calibration before = calibration_;
  Json answer;
  try {
    if (job_->from_rest) {
      if (state != job_->state) {
        throw RejectedError(std::string("the arm left the state ") + ToString(job_->state) +
                            " during the measurement; repeat the command");
      }
      if (!job_->rest.Take(tick)) return;
      answer = job_->from_rest(job_->rest.Result());
    } else {
      const bool own = tick.run_number == job_->run_number;
      if (own && state == SafetyState::kRunning) job_->run.push_back(tick);
      if (own && TorqueAllowed(state)) return;
      if (job_->run.empty()) {
        if (TorqueAllowed(state) || tick.input.now_ns < job_->granted_ns) return;
        throw RejectedError("the arm was stopped before it moved: `flexarm status` names the trip");
      }
      answer = job_->from_run(job_->run);
    }
  } catch (const std::exception& error) {
    answer = {{"ok", false}, {"error", error.what()}};
  }
  if (!answer.contains("ok")) answer["ok"] = true;
  answer["command"] = job_->command;
  if (calibration_ != before) answer["calibration_file"] = file_.string();
  answer_ = std::make_unique<Json>(std::move(answer));
  job_.reset();
}

std::optional<Json> Commissioner::TakeAnswer() {
  if (answer_ == nullptr) return std::nullopt;
  const std::unique_ptr<Json> answer = std::move(answer_);
  return *answer;
}

void Commissioner::Adopt(const Calibration& calibration) {
  WriteCalibration(file_, config_.sensors, calibration);
  calibration_ = calibration;
}

}  // namespace flexarm
