#include <algorithm>
#include <cmath>

#include "controller/files/external_text.h"
#include "controller/types/rounded_text.h"
#include "tools/plot/svg_chart.h"
#include "tools/trip_report/trip_sections.h"

namespace flexarm {
namespace {

constexpr std::size_t kMostCell = 200;  // bytes
constexpr std::size_t kMostRows = 64;   // of a table made from a text of the log

std::string CellOf(const nlohmann::json& row, const char* key) {
  const auto found = row.find(key);
  if (found == row.end() || found->is_null()) return "-";
  if (found->is_string()) return Shown(found->get<std::string>(), kMostCell);
  if (found->is_boolean()) return found->get<bool>() ? "yes" : "no";
  return found->is_number() ? RoundedText(found->get<double>(), 6) : "-";
}

const nlohmann::json& ListIn(const nlohmann::json& event, const char* key) {
  static const nlohmann::json kEmpty = nlohmann::json::array();
  if (!event.is_object()) return kEmpty;
  const auto found = event.find(key);
  return found != event.end() && found->is_array() ? *found : kEmpty;
}

// What a count has grown by since `before`, the row of the same name.
std::string Growth(const nlohmann::json& row, const nlohmann::json& before, const char* key) {
  const auto now = row.find(key);
  if (now == row.end() || !now->is_number()) return "-";
  for (const nlohmann::json& old : before) {
    if (!old.is_object() ||
        old.value("name", nlohmann::json()) != row.value("name", nlohmann::json())) {
      continue;
    }
    const auto then = old.find(key);
    if (then == old.end() || !then->is_number()) return "-";
    return RoundedText(now->get<double>() - then->get<double>(), 6);
  }
  return "-";
}

std::string SecondsBefore(const nlohmann::json& event) {
  return event.is_object() ? CellOf(event, "before_s") : "-";
}

constexpr double kUsPerNs = 1e-3;

// Lateness and run time of the control task around the trip.
void ControlTask(const TripReading& reading, HtmlPage* page) {
  if (reading.timing.empty()) {
    return page->Paragraph(
        "Control: the log has no times of its activations, as that of a "
        "simulation in lock step.");
  }
  const double deadline_us = 1e3 * reading.config.loop.step_deadline_ms;
  SignalRows rows(2, -kWindowBefore_s, kWindowAfter_s, reading.config.loop.period_s(),
                  TripReading::kMostRows);
  double late_us = 0.0, took_us = 0.0;
  int missed = 0;
  for (const TimingRecord& record : reading.timing) {
    const double late = kUsPerNs * static_cast<double>(record.woke_ns - record.due_ns);
    const double took = kUsPerNs * static_cast<double>(record.finished_ns - record.woke_ns);
    late_us = std::max(late_us, late);
    took_us = std::max(took_us, took);
    if (late + took > deadline_us) ++missed;
    rows.Add(reading.After_s(record.due_ns), {late, late + took});
  }
  rows.Finish();
  const std::string text =
      "Control, from 10 s before the trip to 3 s after it: " +
      std::to_string(reading.timing.size()) + " activations, " + std::to_string(missed) +
      " missed deadlines of " + RoundedText(deadline_us, 5) + " us, worst lateness " +
      RoundedText(late_us, 5) + " us, longest run " + RoundedText(took_us, 5) + " us.";
  page->Paragraph(text);
  if (rows.empty()) return;
  const SvgChart chart{.id = "timing",
                       .title = "Control thread: lateness, and end of the step",
                       .description = text,
                       .unit = "us",
                       .time_label = "time after the trip, s",
                       .from_s = std::min(rows.time_s().front(), -0.1),
                       .until_s = std::max(rows.time_s().back(), 0.1),
                       .time_s = rows.time_s(),
                       .curve = {{.label = "woke after its due time", .y = rows.value(0)},
                                 {.label = "had finished after it", .y = rows.value(1)}},
                       .limit = {deadline_us},
                       .mark = {{.at_s = 0.0, .text = "trip"}},
                       .row = {}};
  page->Svg(chart.Text(), chart.title + " (us). The limit is the deadline.");
}

// Kinds that have a section of their own, or are no news for an operator.
bool IsToldElsewhere(const RunEvent& event) {
  constexpr std::array kKinds = {"causes", "circumstances", "counters", "experiment"};
  return std::ranges::any_of(kKinds, [&](const char* kind) { return event.kind == kind; });
}

}  // namespace

void ThreadTiming(const TripReading& reading, HtmlPage* page) {
  page->Section("Timing of the threads");
  ControlTask(reading, page);
  const nlohmann::json event = EventAtTrip(reading, "circumstances");
  const nlohmann::json &now = ListIn(event, "threads"), &before = ListIn(event, "threads_before");
  std::vector<std::vector<std::string>> rows;
  for (const nlohmann::json& thread : now) {
    if (!thread.is_object() || rows.size() == kMostRows) continue;
    rows.push_back({CellOf(thread, "name"), CellOf(thread, "activations"),
                    CellOf(thread, "missed_deadlines"), Growth(thread, before, "missed_deadlines"),
                    CellOf(thread, "skipped_periods"), Growth(thread, before, "skipped_periods"),
                    CellOf(thread, "worst_lateness_us"),
                    Growth(thread, before, "worst_lateness_us"), CellOf(thread, "worst_run_us")});
  }
  if (rows.empty()) {
    return page->Paragraph(
        "The log has no counts of the other threads: the daemon notes them at a "
        "trip.");
  }
  page->Paragraph(
      "All threads, since the start of the daemon, and how much of it came in the last " +
      SecondsBefore(event) + " s before the trip was seen.");
  page->Table({"thread", "activations", "missed deadlines", "in that time", "skipped periods",
               "in that time", "worst lateness, us", "grown by, us", "longest run, us"},
              rows);
}

void Buses(const TripReading& reading, HtmlPage* page) {
  page->Section("Buses");
  const nlohmann::json event = EventAtTrip(reading, "circumstances");
  const nlohmann::json &now = ListIn(event, "buses"), &before = ListIn(event, "buses_before");
  std::vector<std::vector<std::string>> rows;
  for (const nlohmann::json& bus : now) {
    if (!bus.is_object() || rows.size() == kMostRows) continue;
    std::string counters;
    const auto found = bus.find("counters");
    if (found != bus.end() && found->is_object()) {
      for (const auto& [name, count] : found->items()) {
        if (!count.is_number() || count.get<double>() == 0.0) continue;
        counters += (counters.empty() ? "" : ", ") + Shown(name) + " " +
                    RoundedText(count.get<double>(), 8);
      }
    }
    rows.push_back({CellOf(bus, "name"), CellOf(bus, "ok"), CellOf(bus, "fault"),
                    CellOf(bus, "failed"), Growth(bus, before, "failed"), CellOf(bus, "recovered"),
                    CellOf(bus, "slow"), CellOf(bus, "longest_ms"), CellOf(bus, "declared_ms"),
                    counters.empty() ? "none" : counters});
  }
  if (rows.empty()) {
    return page->Paragraph("The log names no bus: the simulated arm in process has none.");
  }
  page->Paragraph(
      "Counts since the start of the daemon, and of failed exchanges those of the last " +
      SecondsBefore(event) + " s before the trip was seen.");
  page->Table({"bus", "answers", "fault", "failed exchanges", "in that time", "recovered",
               "too slow", "longest, ms", "declared, ms", "what the driver rejected or missed"},
              rows);
}

void CommandsAndEvents(const TripReading& reading, HtmlPage* page) {
  page->Section("Commands and events");
  if (reading.left_out_events > 0) {
    page->Paragraph(std::to_string(reading.left_out_events) +
                    " earlier ones are left out; `flexarm info` and the log have all.");
  }
  std::vector<std::vector<std::string>> rows;
  for (const RunEvent& event : reading.event) {
    if (IsToldElsewhere(event)) continue;
    rows.push_back({SignedSeconds(reading.After_s(event.time_ns)), Shown(event.kind),
                    Shown(event.name), Shown(event.text, 400)});
  }
  if (rows.empty()) return page->Paragraph("The log has none.");
  page->Paragraph(
      "What was asked before the trip and by whom (kind operator), what the safety task "
      "answered (command, refusal), and warnings.");
  page->Table({"time", "kind", "name", "text"}, rows);
}

}  // namespace flexarm
