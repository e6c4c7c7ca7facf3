#include "tools/trip_report/trip_reading.h"

#include <algorithm>

#include "controller/runlog/errors.h"
#include "controller/runlog/trips_of_run.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

constexpr std::size_t kMostEarlierRows = 600;

std::vector<double> ValuesOf(const std::vector<SignalPanel>& panels, const TickRecord& record) {
  std::vector<double> values;
  for (const SignalPanel& panel : panels) {
    for (const PanelSignal& signal : panel.signal) values.push_back(signal.value(record));
  }
  return values;
}

std::size_t SignalsOf(const std::vector<SignalPanel>& panels) {
  std::size_t signals = 0;
  for (const SignalPanel& panel : panels) signals += panel.signal.size();
  return signals;
}

// One pass over the samples. Their instants, not those of the steps, are those of the signals.
void ReadSamples(RunReader* reader, TripReading* reading) {
  reader->ForEachTick([&](const TickRecord& record) {
    ++reading->ticks;
    const double time_s = reading->After_s(record.input.sampling_instant_ns);
    if (time_s > kWindowAfter_s) return;
    const std::vector<double> values = ValuesOf(reading->panel, record);
    reading->earlier.Add(time_s, values);
    reading->window.Add(time_s, values);
  });
  reading->earlier.Finish();
  reading->window.Finish();
}

void ReadEvents(RunReader* reader, std::int64_t until_ns, TripReading* reading) {
  reader->ForEachEvent([&](const RunEvent& event) {
    if (event.time_ns >= until_ns) return;
    reading->event.push_back(event);
    if (reading->event.size() <= TripReading::kMostEvents) return;
    reading->event.erase(reading->event.begin());
    ++reading->left_out_events;
  });
}

// Until the next trip: what follows belongs to that.
std::int64_t UntilNs(const std::vector<SafetyRecord>& trips, std::size_t number) {
  return number + 1 < trips.size() ? trips[number + 1].due_ns : INT64_MAX;
}

}  // namespace

TripReading ReadTrip(const std::filesystem::path& log, std::size_t number) {
  const std::vector<SafetyRecord> trips = TripsOfRun(log);
  if (number >= trips.size()) {
    throw InputError(log.string() + ": has " +
                     (trips.empty() ? std::string("no trip")
                                    : std::to_string(trips.size()) + " trips and no later one") +
                     "; expected the log of a run that tripped");
  }
  RunReader reader(log);
  const RigConfig config = ConfigOf(reader);
  const double period_s = config.loop.period_s();
  const SafetyRecord& trip = trips[number];
  const double start_s = static_cast<double>(reader.info().start_ns - trip.due_ns) * 1e-9;
  std::vector<SignalPanel> panels = SignalPanels(reader.info(), config);
  const std::size_t signals = SignalsOf(panels);
  TripReading reading{
      .log = log,
      .head = ReadRunHead(log),
      .config = config,
      .digest_holds = reader.DigestHolds(),
      .number = number,
      .trip = trip,
      .safety = {},
      .event = {},
      .left_out_events = 0,
      .timing = {},
      .panel = std::move(panels),
      .window =
          SignalRows(signals, -kWindowBefore_s, kWindowAfter_s, period_s, TripReading::kMostRows),
      .earlier = SignalRows(signals, start_s, -kWindowBefore_s, period_s, kMostEarlierRows),
      .ticks = 0};
  const std::int64_t until_ns = UntilNs(trips, number);
  reader.ForEachSafety([&](const SafetyRecord& record) {
    const bool is_near = reading.After_s(record.due_ns) >= -kWindowBefore_s;
    if (is_near && record.due_ns < until_ns) reading.safety.push_back(record);
  });
  ReadEvents(&reader, until_ns, &reading);
  reader.ForEachTiming([&](const TimingRecord& record) {
    const double time_s = reading.After_s(record.due_ns);
    if (time_s >= -kWindowBefore_s && time_s <= kWindowAfter_s) reading.timing.push_back(record);
  });
  ReadSamples(&reader, &reading);
  return reading;
}

}  // namespace flexarm
