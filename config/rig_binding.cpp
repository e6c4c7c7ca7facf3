#include "config/rig_binding.h"

#include <limits>

#include "config/hal_binding.h"
#include "config/rig_sections.h"
#include "controller/types/csv_import_config.h"
#include "model/units.h"

namespace flexarm {
namespace {

void ReadDrift(TableReader drift, SimDrift* out) {
  drift.ReadIfGiven("gauge_gain_error", &out->gauge_gain_error,
                    {"of each strain channel, relative; 0 for those left out", "1"});
  drift.ReadIfGiven("gauge_zero_share", &out->gauge_zero_share,
                    {"zero of each strain channel, relative to the full scale of the converter; 0 "
                     "for those left out",
                     "1"});
  drift.ReadIfGiven("friction_error", &out->friction_error,
                    {"of the Coulomb friction of joint 1, 2, relative", "1"});
  drift.ReadIfGiven("joint_stiffness_error", &out->joint_stiffness_error,
                    {"of joint 1, 2, relative", "1"});
  drift.ReadIfGiven("link_stiffness_error", &out->link_stiffness_error,
                    {"of the bending stiffness of link 1, 2, relative", "1"});
  drift.ReadIfGiven("payload_error_kg", &out->payload_error_kg,
                    "by which the arm carries more than is stated");
}

void ReadSim(TableReader sim, SimConfig* out) {
  sim.Read("plant_modes", &out->plant_modes, {"bending modes of each simulated link", "modes"});
  sim.Read("step_ms", &out->step_ms, "integration step of the simulated arm; divides 1 ms");
  sim.Read("seed", &out->seed, "of the measurement noise; the same seed gives the same noise");
  sim.Read("motor_lag_ms", &out->motor_lag_ms,
           "electrical time constant of motor 1, 2 (3.24); 0: none");
  sim.Read("transport_delay_ms", &out->transport_delay_ms,
           "delay from command to drive beyond that of the loop; it is not compensated");
  sim.Read("lost_frame_fraction", &out->lost_frame_fraction,
           {"share of the samples whose readings are lost, never two in a row", "1"});
  sim.Read("channel_skew_us", &out->channel_skew_us,
           "time from one strain channel to the next; 0: all at the same instant");
  sim.Read("switch_angle_deg", &out->switch_angle_deg,
           "hub angle of joint 1, 2, in both directions, at which its limit switch opens");
  if (sim.Has("drift")) {
    ReadDrift(sim.Table("drift",
                        "how the simulated arm and its sensors differ from this config, which the "
                        "loop does not know: docs/health.md"),
              &out->drift);
  }
}

CsvImport ReadCsvImport(TableReader csv) {
  std::vector<NamedValue<CsvUnit>> units;
  for (const CsvUnit& unit : kCsvUnits) units.push_back({unit.name, unit});
  CsvImport import{};
  if (csv.Has("separator")) {
    csv.Read<char>("separator", &import.separator,
                   {{",", ','}, {";", ';'}, {"tab", '\t'}, {"\t", '\t'}},
                   "what separates the cells; without it, found in the file");
  }
  csv.ReadIfGiven("resample", &import.resample,
                  "true: values between the rows are interpolated where their times are not those "
                  "of the loop");
  csv.ReadIfGiven("longest_gap_s", &import.longest_gap_s,
                  "with resample: the longest time between two rows that is interpolated over");
  if (!import.resample || csv.Has("decimation")) {
    csv.Read("decimation", &import.decimation,
             {"rows of the file in one period of the loop", "rows"});
  }
  for (TableReader row : csv.Rows("column",
                                  "a column of the file and the quantity of the rig that is in it: "
                                  "value = scale * unit * cell + offset")) {
    CsvColumn& column = import.column.emplace_back();
    row.Read("column", &column.column, "its name in the header of the file");
    row.Read("unit", &column.unit, units, "unit of the cells");
    row.Read(
        "scale", &column.scale,
        {"SI unit of the target for one of the column, such as 8.9 N m for 1 A", "of the target"});
    row.ReadIfGiven("offset", &column.offset, {"added to the scaled value", "of the target"});
    row.Read("target", &column.target,
             "time, hub1, hub2, rotor1, rotor2, torque_1, torque_2, or a strain channel such as "
             "strain_1_01");
  }
  return import;
}

void ReadLog(TableReader log, DaemonConfig* out) {
  log.Read("directory", &out->log_directory, "folder of the run logs");
  log.ReadIfGiven("required", &out->log.required,
                  "true: no arm and no run without a file for the log of the run");
  log.ReadIfGiven("reserve_mb", &out->log.reserve_mb,
                  "space that is reserved for the next run; 2 MB are a minute at 50 Hz");
  log.ReadIfGiven("keep_free_mb", &out->log.keep_free_mb,
                  "with less space than this beside it, there is no file");
  log.ReadIfGiven("keep_days", &out->log.keep_days, "older runs are removed; 0: none is");
  log.ReadIfGiven("keep_total_mb", &out->log.keep_total_mb,
                  "the oldest runs are removed until all take less; 0: none is");
  log.ReadIfGiven("keep_trips", &out->log.keep_trips,
                  "true: the log of a trip is not removed by the two keys above");
}

void ReadTelemetry(TableReader telemetry, TelemetryConfig* out) {
  telemetry.ReadIfGiven("address", &out->address,
                        "of the receiver, IPv4 or IPv6 in figures; \"\": no telemetry is sent");
  telemetry.ReadIfGiven("port", &out->port, {"UDP port of the receiver", "1"});
  telemetry.ReadIfGiven("every", &out->every,
                        {"one sample of so many is sent; the others are not", "samples"});
}

void ReadHealth(TableReader health, HealthConfig* out) {
  health.ReadIfGiven("enabled", &out->enabled,
                     "true: flexarmd follows each run with the parallel plant");
  health.ReadIfGiven("judge_payload", &out->judge_payload,
                     "false: runs may carry another payload than they state, which is no alarm");
}

void ReadTiming(TableReader root, RigConfig* config) {
  TableReader loop = root.Table("loop", "timing of the control loop; docs/timing.md");
  loop.Read("period_ms", &config->loop.period_ms, "the loop samples and acts every so often");
  loop.Read("acquire_before_ms", &config->loop.acquire_before_ms,
            "from the sampling instant to the step: time for the buses to bring the readings");
  loop.Read("step_deadline_ms", &config->loop.step_deadline_ms,
            "a step that takes longer has missed its deadline");
  loop.Read("output", &config->loop.output,
            {{"next_tick", OutputTiming::kNextTick}, {"at_once", OutputTiming::kAtOnce}},
            "a torque acts at the next sampling instant, or output_after_ms after the one that it "
            "was computed from");
  loop.Read("output_after_ms", &config->loop.output_after_ms,
            "with output = \"at_once\": from the sampling instant to the torque");
  loop.Read("actuation_delay_ms", &config->loop.actuation_delay_ms,
            "known delay of bus and drive, which the prediction compensates");
  TableReader daemon = root.Table("daemon", "the program flexarmd");
  daemon.Read("socket", &config->daemon.socket, "path of the socket on which it takes commands");
  daemon.Read(
      "state_directory", &config->daemon.state_directory,
      "folder that keeps a trip and the proof of the switches over a restart; one for each daemon");
  ReadLog(root.Table("log", "run logs"), &config->daemon);
  if (root.Has("telemetry")) {
    ReadTelemetry(root.Table("telemetry", "samples as UDP datagrams; docs/telemetry.md"),
                  &config->telemetry);
  }
  if (root.Has("health")) {
    ReadHealth(root.Table("health", "drifts of the rig from run to run; docs/health.md"),
               &config->health);
  }
}

}  // namespace

void ReadTuningBasis(TableReader root, TuningBasis* basis) {
  ReadArm(root, &basis->arm);
  ReadSensors(root.Table("sensors", kListedElsewhere), &basis->sensors);
  double period_ms = 0.0;
  root.Table("loop", kListedElsewhere).Read("period_ms", &period_ms, kListedElsewhere);
  basis->period_s = 1e-3 * period_ms;
  TableReader limits = root.Table("limits", kListedElsewhere);
  limits.Read("torque_limit_nm", &basis->torque_limit_nm, kListedElsewhere);
  basis->strain_limit.fill(std::numeric_limits<double>::quiet_NaN());
  limits.ReadIfGiven("strain_limit", &basis->strain_limit, kListedElsewhere);
  root.Table("controller", kListedElsewhere)
      .Read("payload_range_kg", &basis->payload_range_kg, kListedElsewhere);
}

void ReadRig(TableReader root, RigConfig* config) {
  root.Table("rig", "").Read("name", &config->rig_name, "name of the rig, for its logs");
  ReadArm(root, &config->arm);
  ReadSensors(root.Table("sensors", ""), &config->sensors);
  ReadSim(root.Table("sim", "the simulated arm, beyond what a real one has"), &config->sim);
  ReadEstimator(root.Table("estimator", "the state estimator, and when its readings are faulty"),
                &config->estimator);
  ReadController(
      root.Table("controller", "the control law; docs/theory/control-law.md has the symbols"),
      &config->controller);
  ReadSafety(root, &config->safety);
  ReadCommissioning(
      root.Table("commissioning",
                 "test of the wiring and calibration of the sensors; docs/commissioning.md"),
      &config->commissioning);
  ReadTiming(root, config);
  if (root.Has("csv"))
    config->csv = ReadCsvImport(
        root.Table("csv", "how to read CSV files of another recorder; docs/run-logs.md"));
  if (root.Has("hal")) {
    ReadHal(root.Table("hal",
                       "the hardware; without it a config can be simulated and replayed, and no "
                       "daemon runs; docs/hardware.md"),
            config->loop.period_ms, &config->backend, &config->hal);
  }
}

}  // namespace flexarm
