#include "controller/runlog/trips_of_run.h"

#include <algorithm>
#include <cstdint>

#include "controller/runlog/run_list.h"
#include "controller/runlog/run_reader.h"

namespace flexarm {

std::vector<SafetyRecord> TripsOfRun(const std::filesystem::path& log) {
  RunReader reader(log);
  std::vector<SafetyRecord> trips;
  SafetyRecord last{};
  reader.ForEachSafety([&](const SafetyRecord& record) {
    if (Trips(record)) trips.push_back(record);
    last = record;
  });
  const RunEnd end = ReadRunHead(log).end;
  const bool is_cut =
      end == RunEnd::kCutShort || (end == RunEnd::kOpen && reader.state() != RunState::kWritten);
  if (!is_cut || !RelayClosed(last.after.state) || CauseLatched(last.after.state)) return trips;
  std::int64_t end_ns = last.due_ns;
  reader.ForEachTick(
      [&](const TickRecord& record) { end_ns = std::max(end_ns, record.input.now_ns); });
  trips.push_back({.due_ns = end_ns,
                   .facts = last.facts,
                   .evidence = {},
                   .request_number = 0,
                   .before = last.after,
                   .after = {SafetyState::kTripped, TripCause::kEndedWhileArmed},
                   .refusal = Refusal::kNone,
                   .reserved = {}});
  return trips;
}

}  // namespace flexarm
