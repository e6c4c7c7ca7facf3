#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>

#include "controller/files/external_text.h"
#include "controller/files/nesting.h"
#include "controller/operator/trip_channel.h"
#include "controller/types/rounded_text.h"
#include "controller/types/trip_advice.h"
#include "model/units.h"
#include "tools/trip_report/trip_sections.h"

namespace flexarm {
namespace {

constexpr std::size_t kMostText = 400;  // bytes of a text of the log

// "0.531 rad (30.4 deg)".
std::string Quantity(double value, std::string_view unit) {
  if (unit.empty()) return "-";
  const std::string text = RoundedText(value, 4);
  if (unit == "level") return text + (value != 0.0 ? " (closed)" : " (open)");
  if (unit == "strain") return text + " (" + RoundedText(1e6 * value, 4) + " microstrain)";
  std::string with_unit = text + " " + std::string(unit);
  if (unit == "rad") return with_unit + " (" + RoundedText(kDegPerRad * value, 4) + " deg)";
  if (unit == "rad/s") return with_unit + " (" + RoundedText(kDegPerRad * value, 4) + " deg/s)";
  return with_unit;
}

void SetEvidence(double value, double limit, CauseSpan* span) {
  if (value == 0.0 && limit == 0.0) return;
  span->value = Quantity(value, EvidenceUnit(span->cause));
  span->limit = Quantity(limit, EvidenceUnit(span->cause));
}

nlohmann::json JsonOf(const std::string& text) {
  if (LineNestedTooDeepJson(text) != 0) return nullptr;
  nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  return json.is_discarded() ? nlohmann::json(nullptr) : json;
}

std::string TextIn(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? Shown(found->get<std::string>(), kMostText)
                                                   : std::string();
}

// What the operator task saw of a cause that did not latch, in an event "causes".
void FillFromEvents(const TripReading& reading, CauseSpan* span) {
  for (const RunEvent& event : reading.event) {
    if (event.kind != "causes") continue;
    const nlohmann::json causes = JsonOf(event.value_json);
    if (!causes.is_array()) continue;
    for (const nlohmann::json& cause : causes) {
      if (!cause.is_object() || TextIn(cause, "name") != ToString(span->cause)) continue;
      const std::string bus = TextIn(cause, "bus");
      span->where = bus.empty() ? TextIn(cause, "channel_name") : bus;
      const auto value = cause.find("value"), limit = cause.find("limit");
      if (value != cause.end() && value->is_number() && limit != cause.end() &&
          limit->is_number()) {
        SetEvidence(value->get<double>(), limit->get<double>(), span);
      }
      return;
    }
  }
}

// The latched cause has its evidence in its own record.
void FillLatched(const TripReading& reading, CauseSpan* span) {
  const Evidence& evidence = reading.trip.evidence;
  SetEvidence(evidence.value, evidence.limit, span);
  const std::string channel =
      TripChannelName(span->cause, evidence.channel, reading.config.sensors);
  if (!channel.empty()) span->where = channel;
}

std::vector<CauseSpan> SpansOf(const TripReading& reading) {
  std::vector<CauseSpan> spans;
  TripCauses before = 0;
  for (const SafetyRecord& record : reading.safety) {
    const TripCauses now = record.facts.present;
    const double at_s = reading.After_s(record.due_ns);
    for (int number = 1; number < kTripCauses; ++number) {
      const auto cause = static_cast<TripCause>(number);
      const bool was = (before & CauseBit(cause)) != 0, is = (now & CauseBit(cause)) != 0;
      if (is && !was) {
        spans.push_back({.cause = cause,
                         .from_s = at_s,
                         .until_s = std::nullopt,
                         .value = "-",
                         .limit = "-",
                         .where = ""});
      } else if (was && !is) {
        const auto open = std::find_if(spans.rbegin(), spans.rend(),
                                       [cause](const auto& span) { return span.cause == cause; });
        open->until_s = at_s;
      }
    }
    before = now;
  }
  return spans;
}

std::string RoleOf(const TripReading& reading, const CauseSpan& span, bool is_first) {
  if (is_first) return "first cause, latched";
  if ((reading.trip.facts.present & CauseBit(span.cause)) != 0) return "present at the trip";
  return span.from_s < 0.0 ? "before the trip" : "later";
}

std::string RelayText(const SafetyRecord& record) {
  const bool before = RelayClosed(record.before.state), after = RelayClosed(record.after.state);
  if (before == after) return after ? "closed" : "open";
  return after ? "is closed" : "is opened";
}

// When the relay was told to open.
std::string RelayStory(const TripReading& reading) {
  if (!RelayClosed(reading.trip.before.state)) return "The relay was open already.";
  for (const SafetyRecord& record : reading.safety) {
    if (record.due_ns < reading.trip.due_ns) continue;
    if (RelayClosed(record.before.state) && !RelayClosed(record.after.state)) {
      return "The relay was told to open " + RoundedText(reading.After_s(record.due_ns), 3, true) +
             " s after the cause had latched.";
    }
  }
  return "The log ends before the relay was opened: the charge pump stopped with the program, and "
         "so did the torque.";
}

std::string CategoryText(TripCause cause) {
  return (kCategory1Causes & CauseBit(cause)) != 0
             ? "stop category 1: the controller may damp the arm before the power goes"
             : "stop category 0: the torque ends in the tick of the cause";
}

}  // namespace

std::string SignedSeconds(double s) {
  return (s < 0.0 ? "" : "+") + RoundedText(s, 3, true) + " s";
}

nlohmann::json EventAtTrip(const TripReading& reading, const char* kind) {
  for (const RunEvent& event : reading.event) {
    if (event.kind == kind && event.time_ns >= reading.trip.due_ns) return JsonOf(event.value_json);
  }
  return nullptr;
}

std::string TimeOfTrip(const TripReading& reading) {
  const nlohmann::json event = EventAtTrip(reading, "circumstances");
  if (event.is_object()) {
    if (std::string time = TextIn(event, "time_utc"); !time.empty()) return time;
  }
  const RunInfo& info = reading.head.info;
  std::tm utc{};
  const char* end = strptime(info.start_utc.c_str(), "%Y-%m-%dT%H:%M:%S", &utc);
  if (end == nullptr) return Shown(info.start_utc);
  const std::time_t at = timegm(&utc) + (reading.trip.due_ns - info.start_ns) / 1'000'000'000;
  gmtime_r(&at, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

std::vector<CauseSpan> CausesOf(const TripReading& reading) {
  std::vector<CauseSpan> spans = SpansOf(reading);
  for (CauseSpan& span : spans) FillFromEvents(reading, &span);
  const TripCause latched = reading.trip.after.cause;
  const double at_s = 0.5e-3;  // half a tick: the one that is present at the trip
  auto first = std::find_if(spans.begin(), spans.end(), [&](const CauseSpan& span) {
    return span.cause == latched && span.from_s < at_s && span.until_s.value_or(1.0) > 0.0;
  });
  if (first == spans.end()) {  // a limit of time of the machine itself, or of the next start
    first = spans.insert(
        spans.begin(),
        {.cause = latched, .from_s = 0.0, .until_s = 0.0, .value = "-", .limit = "-", .where = ""});
  }
  FillLatched(reading, &*first);
  std::rotate(spans.begin(), first, first + 1);
  return spans;
}

void WhatHappened(const TripReading& reading, HtmlPage* page) {
  const CauseSpan cause = CausesOf(reading).front();
  const std::string name = ToString(cause.cause);
  const std::string happened = AdviceOf(cause.cause).happened;
  page->Lead(happened + " " + RelayStory(reading));
  page->Section("What happened");
  page->Table({"what", "value"},
              {{"cause", name + ", number " + std::to_string(static_cast<int>(cause.cause))},
               {"value", cause.value},
               {"limit", cause.limit},
               {"where", cause.where.empty() ? "-" : cause.where},
               {"kind of stop", CategoryText(cause.cause)},
               {"state before", ToString(reading.trip.before.state)},
               {"time of the trip", TimeOfTrip(reading)},
               {"rig", Shown(reading.head.info.rig_name)}});
}

void WhatToDo(const TripReading& reading, HtmlPage* page) {
  page->Section("What to check, and how to continue");
  std::vector<std::vector<std::string>> rows;
  TripCauses told = 0;
  for (const CauseSpan& span : CausesOf(reading)) {
    if ((told & CauseBit(span.cause)) != 0) continue;
    told |= CauseBit(span.cause);
    const TripAdvice advice = AdviceOf(span.cause);
    rows.push_back({ToString(span.cause), advice.check, advice.remedy});
  }
  page->Table({"cause", "check", "remedy"}, rows);
  page->Paragraph(std::string("Then: ") + kAfterEveryTrip +
                  ". `flexarm status` shows what is still present; docs/safety.md has the order.");
}

void ChainOfCauses(const TripReading& reading, HtmlPage* page) {
  page->Section("Chain of causes");
  page->Paragraph(
      "Times count from the tick of the safety task in which the first cause latched. "
      "A value is the one that broke the limit when the cause was first seen.");
  std::vector<std::vector<std::string>> rows;
  const std::vector<CauseSpan> spans = CausesOf(reading);
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const CauseSpan& span = spans[i];
    rows.push_back({ToString(span.cause), SignedSeconds(span.from_s),
                    span.until_s ? SignedSeconds(*span.until_s) : "end of the log", span.value,
                    span.limit, span.where.empty() ? "-" : span.where,
                    RoleOf(reading, span, i == 0)});
  }
  page->Table({"cause", "from", "until", "value", "limit", "where", "role"}, rows);
  page->Heading("What the safety machine did");
  rows.clear();
  for (const SafetyRecord& record : reading.safety) {
    if (record.before == record.after) continue;
    const bool asked = record.facts.request != RequestKind::kNone;
    rows.push_back({SignedSeconds(reading.After_s(record.due_ns)), ToString(record.before.state),
                    ToString(record.after.state),
                    record.after.cause == TripCause::kNone ? "-" : ToString(record.after.cause),
                    asked ? ToString(record.facts.request) : "-", RelayText(record)});
  }
  page->Table({"time", "from", "to", "cause", "request", "relay"}, rows);
  page->Paragraph(RelayStory(reading));
}

}  // namespace flexarm
