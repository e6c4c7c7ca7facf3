#include "controller/operator/run_warnings.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "controller/operator/payload_json.h"

namespace flexarm {

RunWarnings::RunWarnings(std::int64_t period_ns, double delay_margin_s,
                         std::vector<std::string> gauges, EventQueue* events, JournalReport report)
    : period_ns_(period_ns),
      events_(events),
      report_(std::move(report)),
      delay_(period_ns, delay_margin_s),
      gauges_(std::move(gauges)),
      gauge_monitor_(gauges_.size()) {}

void RunWarnings::Take(std::int64_t now_ns, const TickRecord& tick) {
  now_ns_ = now_ns;
  if (delay_.Take(tick.input)) WarnOfDelayMargin();
  WarnOfPayload(tick, payload_.Take(tick.input, tick.output));
  if (found_delay_.Take(tick.input, tick.output)) WarnOfDelayFound(tick.output);
  if (const std::uint32_t missing = gauge_monitor_.Take(tick.input, tick.output); missing != 0) {
    WarnOfGauges(missing);
  }
}

void RunWarnings::WarnOfDelayMargin() {
  const nlohmann::json figures{{"delay_ms", delay_.delay_ms()},
                               {"delay_margin_ms", delay_.margin_ms()}};
  const std::string text =
      "a torque acted later than predicted, and less than half of the loop's delay margin is "
      "left: " +
      figures.dump() + "; declare what the drives need (loop.actuation_delay_ms)";
  Warn("delay-margin", text, figures);
}

void RunWarnings::WarnOfDelayFound(const StepOutput& output) {
  const auto samples = int{output.delay_found};
  const double period_ms = 1e-6 * static_cast<double>(period_ns_);
  const nlohmann::json figures{{"delay_found", samples},
                               {"delay_ms", delay_.delay_ms() + samples * period_ms}};
  const std::string text =
      "torques act whole samples later or earlier than is declared and measured, as the sensors "
      "show: " +
      figures.dump() +
      "; the loop compensates for this delay until the arm is armed again; set "
      "loop.actuation_delay_ms";
  Warn("delay-found", text, figures);
}

std::vector<std::string> RunWarnings::NamesOf(std::uint32_t channels) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < gauges_.size(); ++i) {
    if ((channels >> i & 1U) != 0) names.push_back(gauges_[i]);
  }
  return names;
}

void RunWarnings::WarnOfGauges(std::uint32_t missing) {
  const nlohmann::json figures{{"gauges", NamesOf(missing)}};
  const std::string text =
      "gauges give no good reading, and the bending is fitted without them: " + figures.dump() +
      "; check their cables and their amplifier";
  Warn("gauges-missing", text, figures);
}

void RunWarnings::WarnOfPayload(const TickRecord& tick, std::uint32_t warnings) {
  for (const PayloadWarningText& warning : kPayloadWarnings) {
    if ((warnings & warning.bit) == 0) continue;
    const nlohmann::json figures = PayloadJson(tick.input, tick.output);
    Warn(warning.name, warning.text + (": " + figures.dump()), figures);
  }
}

void RunWarnings::Warn(const std::string& name, const std::string& text,
                       const nlohmann::json& figures) {
  events_->Push({.time_ns = now_ns_,
                 .kind = "warning",
                 .name = name,
                 .text = text,
                 .value_json = figures.dump()});
  report_(true, text);
}

}  // namespace flexarm
