#include "tools/status/status_text.h"

#include <algorithm>
#include <utility>

namespace flexarm {
namespace {

constexpr std::size_t kLabelWidth = 15;

/// Lines with a label of fixed width, and lines below it.
class Lines {
 public:
  void Add(std::string label, const std::string& text) {
    label.resize(std::max(kLabelWidth, label.size() + 1), ' ');
    text_ += label + text + "\n";
  }
  void Below(const std::string& text) {
    if (!text.empty()) Add("", text);
  }
  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string Pair(const Reply& list, int decimals) {
  return FigureOf(Element(list, 0), decimals) + ", " + FigureOf(Element(list, 1), decimals);
}

void AddIdentity(const Reply& s, Lines* lines) {
  if (!In(s, "rig").is_string()) return;
  const Reply& config = In(s, "config");
  lines->Add("rig", TextIn(s, "rig") + ", flexarmd " + TextIn(s, "version", "-"));
  lines->Add("config", TextIn(config, "file", "-") + ", hash " + TextIn(config, "hash", "-"));
}

void AddLease(const Reply& s, Lines* lines) {
  const Reply& lease = In(s, "lease");
  if (!lease.is_object()) return;
  const bool ends = In(lease, "seconds_left").is_number();
  lines->Add("lease", TextIn(lease, "name", "-") + " (uid " + FigureIn(lease, "uid", 0) + ")" +
                          (ends ? ", " + FigureIn(lease, "seconds_left", 0) + " s left" : ""));
}

// Verdict of one check before arming, and what it found.
void AddVerdict(const Reply& s, const char* key, Lines* lines) {
  const Reply& verdict = In(s, key);
  if (!verdict.is_object()) return;
  lines->Add(key, TextIn(verdict, "verdict", "-"));
  for (const Reply& finding : ListIn(verdict, "findings")) {
    lines->Below((FlagIn(finding, "advice") ? "advice: " : "") + TextIn(finding, "name") + ": " +
                 TextIn(finding, "text"));
  }
}

void AddTrip(const Reply& s, Lines* lines) {
  const Reply& trip = In(s, "trip");
  if (trip.is_object()) {
    lines->Add("trip", TextIn(trip, "name") + ": " + TextIn(trip, "text"));
    lines->Below(EvidenceText(trip));
    const std::string time = TextIn(trip, "time_utc");
    if (!time.empty()) {
      lines->Below(time + (FlagIn(trip, "before_start") ? ", before the daemon's start" : ""));
    }
    lines->Below(TextIn(trip, "record_problem"));
    const std::string report = TextIn(trip, "report");
    lines->Below(report.empty() ? "" : "report: " + report);
  }
  for (const Reply& cause : ListIn(s, "present")) {
    const std::string evidence = EvidenceText(cause);
    lines->Add("present cause",
               TextIn(cause, "name", "-") + (evidence.empty() ? "" : ": " + evidence));
  }
  if (const std::string problem = TextIn(s, "latch_problem"); !problem.empty()) {
    lines->Add("latch file", problem);
  }
}

void AddRun(const Reply& s, Lines* lines) {
  const Reply& run = In(s, "run");
  if (!run.is_object()) return;
  const std::string trip = TextIn(run, "trip");
  lines->Add("run", FigureIn(run, "number", 0) + ", " + ProgressText(run) + ", " +
                        TextIn(run, "outcome", "-") + (trip.empty() ? "" : " by " + trip));
}

void AddInputs(const Reply& s, Lines* lines) {
  const Reply& inputs = In(s, "inputs");
  if (!inputs.is_object()) return;
  std::string text;
  for (const auto& [name, level] : inputs.items()) {
    text += (text.empty() ? "" : ", ") + TextOf(Reply(name)) + " " + FigureOf(level, 0);
  }
  lines->Add("inputs", text);
}

// Whether rig and wiring are proven.
void AddProofs(const Reply& s, Lines* lines) {
  for (const auto& [key, label] : {std::pair{"wiring", "wiring"}, {"switches", "switches"}}) {
    const Reply& proof = In(s, key);
    if (!proof.is_object()) continue;
    const std::string why = TextIn(proof, "why_not");
    lines->Add(label, FlagIn(proof, "proved") ? "proved" : "not proved: " + why);
  }
}

void AddAngles(const Reply& s, Lines* lines) {
  const Reply& angles = In(s, "joint_angle_deg");
  std::string text;
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const Reply& angle = Element(angles, joint);
    text += (joint == 0 ? "" : ", ") + (angle.is_number() ? FigureOf(angle, 2) : "unknown");
  }
  lines->Add("joint angle", text + " deg");
  for (const Reply& why : ListIn(s, "joint_angle_unknown")) lines->Below(TextOf(why));
}

void AddMotion(const Reply& s, Lines* lines) {
  lines->Add("torque asked", Pair(In(s, "torque_nm"), 3) + " N m");
  lines->Add("at rest", FlagIn(s, "at_rest") ? "yes" : "no");
  std::string gauges;
  for (const Reply& gauge : ListIn(s, "gauges_missing")) gauges += " " + TextOf(gauge, "-");
  if (!gauges.empty()) lines->Add("gauges missing", gauges.substr(1));
  lines->Add("delay", FigureIn(s, "delay_ms", 2) + " ms, longest " +
                          FigureIn(s, "delay_max_ms", 2) + " ms; " +
                          FigureIn(s, "delay_margin_ms", 1) + " ms of margin left");
}

void AddPayload(const Reply& s, Lines* lines) {
  const Reply& payload = In(s, "payload");
  if (!payload.is_object()) return;
  std::string text = FigureIn(payload, "kg", 3) + " kg, standard deviation " +
                     FigureIn(payload, "sigma_kg", 3) + " kg";
  if (const double samples = NumberIn(payload, "delay_found"); samples != 0.0) {
    text += "; delay found: " + std::string(samples > 0.0 ? "+" : "") +
            FigureIn(payload, "delay_found", 0) + " samples more than declared";
  }
  for (const Reply& warning : ListIn(payload, "warnings")) text += "; " + TextOf(warning, "-");
  lines->Add("payload", text);
}

void AddTiming(const Reply& s, Lines* lines) {
  const Reply& timing = In(s, "timing");
  if (!timing.is_object()) return;
  lines->Add("late threads",
             "safety " + FigureIn(timing, "safety_overruns", 0) + " times, worst " +
                 FigureIn(timing, "safety_worst_ms", 1) + " ms; deadlines missed in a row " +
                 FigureIn(timing, "deadlines_missed_in_a_row", 0) + " times, often " +
                 FigureIn(timing, "deadlines_often_missed", 0) + " times; " +
                 (FlagIn(timing, "trips", true) ? "each trips" : "simulated arm: no trip"));
}

// What the driver of a bus rejected or missed; nothing while all is 0.
std::string CountersText(const Reply& bus) {
  std::string text;
  const Reply& counters = In(bus, "counters");
  if (!counters.is_object()) return text;
  for (const auto& [name, count] : counters.items()) {
    if (!count.is_number() || count.get<double>() == 0.0) continue;
    text += (text.empty() ? "" : ", ") + TextOf(Reply(name)) + " " + FigureOf(count, 0);
  }
  return text;
}

void AddBuses(const Reply& s, Lines* lines) {
  for (const Reply& bus : ListIn(s, "buses")) {
    const std::string fault = TextIn(bus, "fault");
    lines->Add(TextIn(bus, "name", "-"),
               std::string(FlagIn(bus, "ok") ? "ok" : "lost") + ", " + FigureIn(bus, "failed", 0) +
                   " failed exchanges, recovered " + FigureIn(bus, "recovered", 0) +
                   " times, longest exchange " + FigureIn(bus, "longest_ms", 1) + " of " +
                   FigureIn(bus, "declared_ms", 1) + " ms, " + FigureIn(bus, "slow", 0) +
                   " longer" + (fault.empty() ? "" : "; " + fault));
    lines->Below(CountersText(bus));
  }
}

void AddTelemetry(const Reply& s, Lines* lines) {
  const Reply& telemetry = In(s, "telemetry");
  if (telemetry.is_object()) lines->Add("telemetry", TelemetryText(telemetry));
}

void AddHealth(const Reply& s, Lines* lines) {
  for (const Reply& alarm : ListIn(In(s, "health"), "alarms")) {
    lines->Add("health", TextIn(alarm, "text", "-"));
  }
}

void AddThreads(const Reply& s, Lines* lines) {
  if (const double dropped = NumberIn(s, "log_records_dropped"); dropped != 0.0) {
    lines->Add("log", FigureIn(s, "log_records_dropped", 0) +
                          " records dropped: the recorder was too slow");
  }
  for (const Reply& thread : ListIn(s, "threads")) {
    lines->Add(TextIn(thread, "name", "-"),
               FigureIn(thread, "activations", 0) + " activations, " +
                   FigureIn(thread, "missed_deadlines", 0) + " missed deadlines, " +
                   FigureIn(thread, "skipped_periods", 0) + " skipped periods, worst lateness " +
                   FigureIn(thread, "worst_lateness_us", 0) + " us");
  }
}

}  // namespace

// The bus says more than its numbers.
std::string EvidenceText(const Reply& cause) {
  if (const std::string bus = TextIn(cause, "bus"); !bus.empty()) return bus;
  std::string text;
  if (In(cause, "value").is_number()) {
    const std::string unit = TextIn(cause, "unit");
    text = "value " + FigureIn(cause, "value", 4) + ", limit " + FigureIn(cause, "limit", 4) +
           (unit.empty() ? "" : " " + unit);
  }
  const std::string channel = TextIn(cause, "channel_name");
  return channel.empty() ? text : text + (text.empty() ? "" : ", ") + channel;
}

std::string TelemetryText(const Reply& telemetry) {
  const std::string error = TextIn(telemetry, "error");
  return "to " + TextIn(telemetry, "address", "-") + " port " + FigureIn(telemetry, "port", 0) +
         ", " + FigureIn(telemetry, "sent", 0) + " sent, " + FigureIn(telemetry, "lost", 0) +
         " lost" + (error.empty() ? "" : "; " + error);
}

namespace {

// "" at the planned speed, and of a motion without a path.
std::string SpeedText(const Reply& run) {
  const double percent = NumberOrNan(In(run, "speed_percent"));
  if (percent == 0.0) return ", paused";
  return percent < 100.0 ? ", at " + FigureIn(run, "speed_percent", 0) + " % of the speed" : "";
}

}  // namespace

std::string ProgressText(const Reply& run) {
  const bool timed = In(run, "duration_s").is_number();
  return TextIn(run, "name", "-") + ": " + FigureIn(run, "elapsed_s", 1) +
         (timed ? " of " + FigureIn(run, "duration_s", 1) : "") + " s" + SpeedText(run);
}

std::string StatusText(const Reply& status) {
  Lines lines;
  lines.Add("state", TextIn(status, "state", "-"));
  AddIdentity(status, &lines);
  AddLease(status, &lines);
  for (const Reply& given : ListIn(status, "overrides")) {
    lines.Add("override", TextIn(given, "condition") + ": " + TextIn(given, "reason"));
  }
  AddVerdict(status, "host", &lines);
  AddVerdict(status, "design", &lines);
  AddTrip(status, &lines);
  if (FlagIn(In(status, "limits"), "reduced")) lines.Add("limits", "reduced");
  AddRun(status, &lines);
  lines.Add("time",
            FigureIn(status, "time_s", 2) + " s (tick " + FigureIn(status, "tick", 0) + ")");
  AddInputs(status, &lines);
  AddProofs(status, &lines);
  AddAngles(status, &lines);
  AddMotion(status, &lines);
  AddPayload(status, &lines);
  AddTiming(status, &lines);
  AddBuses(status, &lines);
  AddTelemetry(status, &lines);
  AddHealth(status, &lines);
  AddThreads(status, &lines);
  return lines.Take();
}

}  // namespace flexarm
