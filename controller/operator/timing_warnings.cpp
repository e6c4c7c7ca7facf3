#include "controller/operator/timing_warnings.h"

#include <string>
#include <utility>

#include "controller/operator/status_json.h"

namespace flexarm {

TimingWarnings::TimingWarnings(EventQueue* events, JournalReport report)
    : events_(events), report_(std::move(report)) {}

void TimingWarnings::Follow(std::int64_t now_ns, const TimingCounts& counts) {
  const bool more = counts.safety_overruns != told_.safety_overruns ||
                    counts.deadlines_missed != told_.deadlines_missed ||
                    counts.deadlines_often_missed != told_.deadlines_often_missed;
  const bool lately = told_at_ns_ != INT64_MIN && now_ns - told_at_ns_ < kEveryNs;
  if (!more || lately) return;
  told_ = counts;
  told_at_ns_ = now_ns;
  const std::string figures = TimingJson(counts, false).dump();
  const std::string text =
      "threads were too late; on a rig with hardware this would have tripped: " + figures +
      "; see `flexarm status` and docs/timing.md";
  events_->Push({.time_ns = now_ns,
                 .kind = "warning",
                 .name = "late-threads",
                 .text = text,
                 .value_json = figures});
  report_(true, text);
}

}  // namespace flexarm
