#include "tools/status/watch_rows.h"

#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "tools/status/gauge_bar.h"
#include "tools/status/status_text.h"

namespace flexarm {
namespace {

constexpr int kBarsFrom = 80, kLimitsFrom = 104;      // columns
constexpr int kJointText = 53, kJointLimitText = 24;  // columns of a joint's figures and limits

// "+1.50", or "-" if it is no number.
std::string Signed(const Reply& value, int decimals) {
  const std::string figure = FigureOf(value, decimals);
  return value.is_number() && figure.front() != '-' ? "+" + figure : figure;
}

std::string RightIn(const std::string& text, std::size_t columns) {
  return text.size() < columns ? std::string(columns - text.size(), ' ') + text : text;
}

Look LookOfState(std::string_view state) {
  if (state == "Tripped" || state == "FaultStopping") return Look::kBad;
  if (state == "Idle" || state == "Starting" || state == "-") return Look::kTitle;
  return Look::kCaution;  // the relay is closed, or about to be
}

// How old a sample, a permit or a reading is; empty unless that is too old.
void AddStale(const std::string& what, const Reply& age_ms, StyledRow* row) {
  if (!age_ms.is_number() || age_ms.get<double>() < kStale_ms) return;
  row->Add(" ").Add(what + AgeText(age_ms.get<double>() / 1e3) + " old", Look::kBad);
}

StyledRow Lamp(const std::string& name, const char* says, Look look) {
  StyledRow lamp(name + " ");
  return lamp.Add(says, look);
}

// A switch that is closed when healthy.
StyledRow SwitchLamp(const Reply& inputs, const char* key, const std::string& name) {
  const Reply& level = In(inputs, key);
  if (!level.is_number()) return Lamp(name, "?", Look::kCaution);
  return level.get<double>() == 0.0 ? Lamp(name, "OPEN", Look::kBad)
                                    : Lamp(name, "ok", Look::kGood);
}

StyledRow RelayLamp(const Reply& status) {
  const Reply& relay = In(status, "relay_closed");
  if (!relay.is_boolean()) return Lamp("relay", "?", Look::kCaution);
  return relay.get<bool>() ? Lamp("relay", "CLOSED", Look::kCaution)
                           : Lamp("relay", "open", Look::kGood);
}

StyledRow ButtonLamp(const Reply& inputs) {
  const Reply& level = In(inputs, "reset-button");
  if (!level.is_number()) return Lamp("reset", "?", Look::kCaution);
  return level.get<double>() == 0.0 ? Lamp("reset", "up", Look::kGood)
                                    : Lamp("reset", "PRESSED", Look::kCaution);
}

// What makes the torque, by the key "torque_source".
std::string SourceText(const Reply& status) {
  const std::string law = TextIn(status, "law", "-");
  const std::string source = TextIn(status, "torque_source");
  if (source.empty()) return "law " + law + ", no torque";
  if (source == "law") return "law " + law + " in force";
  return source + " in force";
}

}  // namespace

std::string AgeText(double age_s) {
  const auto figure = [](double value, int decimals) { return FigureOf(Reply(value), decimals); };
  if (age_s < 1e-3) return figure(age_s * 1e6, 0) + " us";
  if (age_s < 1.0) return figure(age_s * 1e3, age_s < 0.01 ? 1 : 0) + " ms";
  return age_s < 100.0 ? figure(age_s, 1) + " s" : figure(age_s / 60.0, 0) + " min";
}

Rows HeaderRows(const WatchedStatus& watched, int columns) {
  const Reply& s = watched.status;
  Rows rows;
  if (!watched.no_answer.empty()) {
    const bool had_one = s.is_object();
    rows.emplace_back(
        "NO ANSWER" +
            (had_one ? ": what follows is " + AgeText(watched.age_s) + " old" : std::string()),
        Look::kBad);
    for (const StyledRow& row : WrapWords(watched.no_answer, columns)) rows.push_back(row);
    if (!had_one) return rows;
  }
  StyledRow row(TextIn(s, "rig", "flexarm"), Look::kTitle);
  row.Add("  " + TextIn(s, "version", "-") + "  " + FigureIn(s, "time_s", 2) + " s, tick " +
          FigureIn(s, "tick", 0));
  AddStale(" sample ", In(s, "tick_age_ms"), &row);
  AddStale(" permit ", In(s, "permit_age_ms"), &row);
  constexpr std::string_view kHint = "q quits";
  const int hint_at = columns - static_cast<int>(kHint.size());
  if (row.width() + 2 <= hint_at) row.PadTo(hint_at).Add(kHint);
  rows.push_back(row);
  return rows;
}

Rows StateRows(const Reply& status, int columns) {
  const std::string state = TextIn(status, "state", "-");
  Rows items;
  items.emplace_back(" " + state + " ", LookOfState(state));
  const Reply& run = In(status, "run");
  if (run.is_object()) {
    const double duration_s = NumberIn(run, "duration_s");
    const std::string outcome = TextIn(run, "outcome", "-");
    const bool runs = outcome == "running";
    StyledRow item;
    if (runs && duration_s > 0.0) {
      item.Add(ShareBar(NumberIn(run, "elapsed_s") / duration_s, 12)).Add(" ");
    }
    item.Add(ProgressText(run) + (runs ? "" : ", " + outcome));
    items.push_back(item);
  }
  items.emplace_back(SourceText(status));
  return Flow(items, columns);
}

Rows TripRows(const Reply& status, int columns) {
  Rows rows;
  const Reply& trip = In(status, "trip");
  if (trip.is_object()) {
    const std::string evidence = EvidenceText(trip);
    rows.emplace_back(
        "TRIP " + TextIn(trip, "name", "-") + (evidence.empty() ? "" : ": " + evidence),
        Look::kBad);
    for (const StyledRow& row : WrapWords(TextIn(trip, "text"), columns)) rows.push_back(row);
  }
  for (const Reply& cause : ListIn(status, "present")) {
    const std::string evidence = EvidenceText(cause);
    rows.emplace_back(
        "present " + TextIn(cause, "name", "-") + (evidence.empty() ? "" : ": " + evidence),
        Look::kCaution);
  }
  return rows;
}

Rows LampRows(const Reply& status, int columns) {
  const Reply& inputs = In(status, "inputs");
  Rows lamps{RelayLamp(status), SwitchLamp(inputs, "emergency-stop", "e-stop"), ButtonLamp(inputs)};
  constexpr std::array kLimits = {
      std::pair{"limit-1-low", "1 low"}, std::pair{"limit-1-high", "1 high"},
      std::pair{"limit-2-low", "2 low"}, std::pair{"limit-2-high", "2 high"}};
  for (const auto& [key, name] : kLimits) lamps.push_back(SwitchLamp(inputs, key, name));
  return Flow(lamps, columns);
}

Rows JointRows(const Reply& status, int columns) {
  const bool bars = columns >= kBarsFrom;
  const bool shows_limits = columns >= kLimitsFrom;
  const int bar = (columns - kJointText - (shows_limits ? kJointLimitText : 0)) / 3;
  const Reply& limits = In(status, "limits");
  Rows rows;
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const auto of = [joint](const Reply& object, const char* key) -> const Reply& {
      return Element(In(object, key), joint);
    };
    const auto add = [&](const char* key, const char* limit_key, StyledRow* row) {
      const Reply& limit = of(limits, limit_key);
      if (bars) row->Add(GaugeBar(NumberOrNan(of(status, key)), NumberOrNan(limit), bar));
      if (shows_limits) row->Add(" of " + FigureOf(limit, 0));
    };
    StyledRow row("J" + std::to_string(joint + 1) + " ", Look::kTitle);
    const Reply& angle = of(status, "joint_angle_deg");
    row.Add(angle.is_number() ? RightIn(Signed(angle, 2), 7) : "unknown").Add(" deg ");
    add("joint_angle_deg", "angle_deg", &row);
    row.Add(" ref " + RightIn(Signed(of(status, "reference_deg"), 2), 7));
    if (bars) row.Add(" " + RightIn(Signed(of(status, "hub_rate_rad_s"), 2), 6) + " rad/s ");
    add("hub_rate_rad_s", "hub_rate_rad_s", &row);
    row.Add(" " + RightIn(Signed(of(status, "torque_nm"), 2), 6) + " N m ");
    add("torque_nm", "torque_nm", &row);
    rows.push_back(row);
  }
  return rows;
}

Rows EncoderRows(const Reply& status, int columns) {
  Rows items;
  for (const Reply& encoder : ListIn(status, "encoders")) {
    StyledRow item(TextIn(encoder, "name", "-"), Look::kTitle);
    item.Add(" " + Signed(In(encoder, "counts"), 0) + " counts " +
             Signed(In(encoder, "angle_deg"), 2) + " deg");
    if (!FlagIn(encoder, "used", true)) item.Add(" ").Add("not used", Look::kBad);
    AddStale("", In(encoder, "age_ms"), &item);
    items.push_back(item);
  }
  return Flow(items, columns);
}

Rows PayloadRows(const Reply& status) {
  const Reply& payload = In(status, "payload");
  if (!payload.is_object()) return {};
  StyledRow row("payload " + FigureIn(payload, "kg", 3) + " kg, sigma " +
                FigureIn(payload, "sigma_kg", 3) + " kg");
  for (const Reply& warning : ListIn(payload, "warnings")) {
    row.Add("  ").Add(TextOf(warning, "-"), Look::kCaution);
  }
  return {row};
}

Rows TelemetryRows(const Reply& status) {
  const Reply& telemetry = In(status, "telemetry");
  if (!telemetry.is_object()) return {};
  const bool lost = NumberIn(telemetry, "lost") > 0.0 || In(telemetry, "error").is_string();
  StyledRow row("telemetry ");
  return {row.Add(TelemetryText(telemetry), lost ? Look::kCaution : Look::kPlain)};
}

Rows HealthRows(const Reply& status) {
  Rows rows;
  for (const Reply& alarm : ListIn(In(status, "health"), "alarms")) {
    rows.push_back(StyledRow("health ").Add(TextIn(alarm, "text", "-"), Look::kCaution));
  }
  return rows;
}

Rows BusRows(const Reply& status, int columns) {
  Rows rows;
  for (const Reply& bus : ListIn(status, "buses")) {
    const bool ok = FlagIn(bus, "ok");
    StyledRow name(TextIn(bus, "name", "-") + " ", Look::kTitle);
    name.Add(ok ? "ok" : "LOST", ok ? Look::kGood : Look::kBad);
    const double failed = NumberIn(bus, "failed"), slow = NumberIn(bus, "slow");
    Rows items{name};
    items.emplace_back("failed " + FigureIn(bus, "failed", 0),
                       failed > 0.0 ? Look::kCaution : Look::kPlain);
    items.emplace_back("longest " + FigureIn(bus, "longest_ms", 1) + " of " +
                       FigureIn(bus, "declared_ms", 1) + " ms");
    items.emplace_back("longer " + FigureIn(bus, "slow", 0),
                       slow > 0.0 ? Look::kCaution : Look::kPlain);
    if (const std::string fault = TextIn(bus, "fault"); !fault.empty()) {
      items.emplace_back(fault, Look::kBad);
    }
    for (const StyledRow& row : Flow(items, columns)) rows.push_back(row);
  }
  return rows;
}

Rows ThreadRows(const Reply& status, int columns) {
  Rows items;
  for (const Reply& thread : ListIn(status, "threads")) {
    const double late = NumberIn(thread, "missed_deadlines") + NumberIn(thread, "skipped_periods");
    StyledRow item(TextIn(thread, "name", "-"), Look::kTitle);
    item.Add(" " + AgeText(NumberIn(thread, "worst_lateness_us") / 1e6));
    if (late > 0.0) item.Add(", " + FigureOf(Reply(late), 0) + " late", Look::kCaution);
    items.push_back(item);
  }
  if (items.empty()) return {};
  items.insert(items.begin(), StyledRow("lateness:"));
  return Flow(items, columns);
}

}  // namespace flexarm
