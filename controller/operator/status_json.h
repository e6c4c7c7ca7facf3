#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "controller/commissioning/angle_knowledge.h"
#include "controller/latch/trip_latch.h"
#include "controller/operator/cause_json.h"
#include "controller/operator/delay_monitor.h"
#include "controller/operator/operator_snapshot.h"
#include "controller/tasks/bus_health.h"
#include "estimator/state_layout.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// What a status is made of. What is pointed to outlives the call.
struct StatusSources {
  const OperatorSnapshot* now;
  const DelayMonitor* delay;
  const SensorConfig* sensors;
  const AngleKnowledge* angles;
  StateLayout layout = kR8;                   ///< of the state that the loop estimates
  std::vector<std::string> missing_gauges{};  ///< RunWarnings
  std::string experiment;                     ///< name of the one that is loaded; empty: none
  std::vector<BusHealth> buses;               ///< empty: the backend has none
  BusTextOf bus_text;                         ///< LoopStack::BusText
  const PresentCauses* present;               ///< LoopStack::present_causes
  const TripLatch* latch;                     ///< when the trip was, and whether it is kept
  std::string trip_report{};                  ///< file of the latched trip's report; empty: none
  nlohmann::json threads;                     ///< OperatorContext::thread_status
  nlohmann::json host;                        ///< ArmCommand::HostStatus
  nlohmann::json design;                      ///< ArmCommand::DesignStatus
  nlohmann::json overrides;                   ///< OverrideRecord::Json
  nlohmann::json switches;                    ///< ProveSwitches::Json
  nlohmann::json log;                         ///< LogJson
  nlohmann::json telemetry;                   ///< OperatorContext::telemetry_status
  nlohmann::json health;                      ///< OperatorContext::health_status
  nlohmann::json identity;                    ///< OperatorContext::identity
  nlohmann::json lease;                       ///< Lease::Json
  nlohmann::json run;                         ///< RunWatch::Json
  std::string why_no_run;                     ///< CommissioningCommands::WhyNoRun
  TimingCounts timing{};                      ///< LoopStack::timing
  bool late_threads_trip = true;
  std::uint64_t log_records_dropped = 0;  ///< that no log has: the recorder was too slow
};

/// Of the operator socket: docs/protocol.md. A change that old clients do not understand raises it.
inline constexpr int kProtocolVersion = 1;

/// Part "buses" of the status.
nlohmann::json BusesJson(const std::vector<BusHealth>& buses);

/// Part "counters" of a bus: {name: count}.
nlohmann::json CountersJson(const std::vector<BusCounter>& counters);

/// Part "timing" of the status. @param trips  late threads trip
nlohmann::json TimingJson(const TimingCounts& counts, bool trips);

/// The answer to the command "status". Every key has its unit in its name, or is without unit;
/// "trip" is null but in Tripped; an angle is null while it is unknown, "joint_angle_unknown" says
/// why. Pure function. Not real-time safe.
nlohmann::json StatusJson(const StatusSources& sources);

}  // namespace flexarm
