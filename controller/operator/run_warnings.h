#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "controller/operator/delay_monitor.h"
#include "controller/operator/gauge_monitor.h"
#include "controller/operator/journal_report.h"
#include "controller/operator/payload_warnings.h"
#include "controller/runlog/event_queue.h"
#include "controller/types/records.h"

namespace flexarm {

/// The warnings about a run that goes on: delay margin, delay found, payload, missing gauges. Each
/// is given at most once a run, as an event "warning" of the log and as a journal line with the
/// same text.
///
/// Not real-time safe. Thread: operator.
class RunWarnings {
 public:
  /// @param delay_margin_s  see DelayMonitor
  /// @param gauges  names of the strain channels, as in the log
  /// @param events  to the recorder; outlives this
  RunWarnings(std::int64_t period_ns, double delay_margin_s, std::vector<std::string> gauges,
              EventQueue* events, JournalReport report);

  /// Every step, in order.
  /// @param now_ns  time of the event
  void Take(std::int64_t now_ns, const TickRecord& tick);

  const DelayMonitor& delay() const { return delay_; }
  /// Names of the strain channels that the fit does without.
  std::vector<std::string> missing_gauges() const { return NamesOf(gauge_monitor_.missing()); }

 private:
  void WarnOfDelayMargin();
  void WarnOfDelayFound(const StepOutput& output);
  void WarnOfGauges(std::uint32_t missing);
  std::vector<std::string> NamesOf(std::uint32_t channels) const;
  void WarnOfPayload(const TickRecord& tick, std::uint32_t warnings);
  void Warn(const std::string& name, const std::string& text, const nlohmann::json& figures);

  std::int64_t period_ns_;
  EventQueue* events_;
  JournalReport report_;
  DelayMonitor delay_;
  FoundDelayMonitor found_delay_;
  PayloadWarnings payload_;
  std::vector<std::string> gauges_;
  GaugeMonitor gauge_monitor_;
  std::int64_t now_ns_ = 0;
};

}  // namespace flexarm
