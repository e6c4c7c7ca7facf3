#include "controller/operator/trip_circumstances.h"

#include <string>
#include <utility>

#include "controller/operator/status_json.h"
#include "controller/runlog/run_writer.h"

namespace flexarm {
namespace {

constexpr std::int64_t kCountsEveryNs = 1'000'000'000;

}  // namespace

void TripCircumstances::Follow(std::int64_t now_ns, const Permit& permit,
                               const PresentCauses& present, const std::vector<BusHealth>& buses) {
  const bool was_latched = std::exchange(latched_, CauseLatched(permit.state));
  if (!latched_) not_latched_ns_ = permit.renewed_ns;
  const bool from_start = not_latched_ns_ == INT64_MIN;  // of the daemon before: it has no log here
  if (latched_ && !was_latched && !from_start) NoteTrip(now_ns, buses);
  const bool begins = latched_ && !was_latched;
  if (begins) changes_ = 0;
  if (latched_ && !from_start && (begins || present.causes != noted_)) NoteCauses(now_ns, present);
  if (!counts_.empty() && now_ns - counts_.back().at_ns < kCountsEveryNs) return;
  counts_.push_back(
      {.at_ns = now_ns, .threads = sources_.thread_status(), .buses = BusesJson(buses)});
  if (counts_.size() > kBefore_s + 1) counts_.pop_front();
}

void TripCircumstances::NoteTrip(std::int64_t now_ns, const std::vector<BusHealth>& buses) {
  nlohmann::json json{
      {"time_utc", UtcNow()}, {"threads", sources_.thread_status()}, {"buses", BusesJson(buses)}};
  if (!counts_.empty()) {
    json["before_s"] = static_cast<double>(now_ns - counts_.front().at_ns) * 1e-9;
    json["threads_before"] = counts_.front().threads;
    json["buses_before"] = counts_.front().buses;
  }
  events_->Push({.time_ns = now_ns,
                 .kind = "circumstances",
                 .name = "trip",
                 .text = "threads and buses when the trip was seen, and before",
                 .value_json = json.dump()});
}

void TripCircumstances::NoteCauses(std::int64_t now_ns, const PresentCauses& present) {
  noted_ = present.causes;
  if (++changes_ > kMostChanges) return;
  events_->Push({.time_ns = now_ns,
                 .kind = "causes",
                 .name = "present",
                 .text = "causes that are present, with what breaks their limits",
                 .value_json = PresentJson(present, *sources_.sensors, sources_.bus_text).dump()});
}

}  // namespace flexarm
