#include "controller/latch/trip_latch.h"

#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "controller/runlog/errors.h"
#include "controller/runlog/run_writer.h"

namespace flexarm {
namespace {

// By bytes: a NaN equals itself.
bool Same(const Evidence& a, const Evidence& b) {
  using Bytes = std::array<std::byte, sizeof(Evidence)>;
  static_assert(sizeof(Evidence) == 2 * sizeof(double) + 2 * sizeof(std::uint32_t), "no padding");
  return std::bit_cast<Bytes>(a) == std::bit_cast<Bytes>(b);
}

HeldTrip Unreadable(const std::string& problem) {
  return {.cause = TripCause::kTripRecordUnreadable,
          .evidence = {},
          .time_utc = {},
          .before_start = true,
          .record_problem = problem};
}

HeldTrip FromBefore(const LatchRecord& record) {
  const bool armed = record.cause == TripCause::kNone;
  return {.cause = armed ? TripCause::kEndedWhileArmed : record.cause,
          .evidence = record.evidence,
          .time_utc = record.time_utc,
          .before_start = true,
          .record_problem = {}};
}

std::string StartText(const HeldTrip& trip, const std::string& file) {
  const std::string since =
      trip.time_utc.empty() ? trip.record_problem : trip.time_utc + ", kept in " + file;
  return std::string("the arm is tripped from before this start: ") + ToString(trip.cause) + " (" +
         since + "). " + OperatorText(trip.cause);
}

}  // namespace

TripLatch::TripLatch(std::filesystem::path folder, std::string log_directory, Report report)
    : path_(std::move(folder)),
      log_directory_(std::move(log_directory)),
      report_(std::move(report)) {}

std::optional<HeldTrip> TripLatch::Open() {
  folder_.emplace(path_);
  const FileText found = folder_->Read(kFile);
  if (found.text) {
    try {
      trip_ = FromBefore(ParseLatch(*found.text));
    } catch (const InputError& error) {
      trip_ = Unreadable(folder_->PathOf(kFile) + ": " + error.what());
    }
  } else if (!found.problem.empty()) {
    trip_ = Unreadable(found.problem);
  }
  // Whatever the file says, the next daemon reads the same: it need not be written again.
  kept_ = trip_ ? Kept::kTrip : Kept::kNothing;
  if (trip_) report_(true, StartText(*trip_, folder_->PathOf(kFile)));
  return trip_;
}

FileChange TripLatch::Write(const LatchRecord& record) {
  if (folder_) return folder_->Replace(kFile, LatchText(record));
  return {.problem = path_.string() + ": the state folder is not open", .untouched = true};
}

std::string TripLatch::PrepareArm(const Permit& newest) {
  if (CauseLatched(newest.state) || kept_ == Kept::kArmed) return {};
  const FileChange change = Write({.time_utc = UtcNow(), .log_directory = log_directory_});
  if (change.problem.empty()) {
    kept_ = Kept::kArmed;
    problem_.clear();
    return {};
  }
  if (!change.untouched) kept_ = Kept::kUnknown;
  report_(true, change.problem + "; the arm is not armed, because a trip could not be kept");
  return change.problem;
}

void TripLatch::NoteTrip(const Permit& newest) {
  if (!CauseLatched(newest.state)) {
    if (newest.state != SafetyState::kStarting) trip_.reset();
    return;
  }
  if (trip_ && trip_->cause == newest.cause && Same(trip_->evidence, newest.evidence)) return;
  trip_ = HeldTrip{.cause = newest.cause,
                   .evidence = newest.evidence,
                   .time_utc = UtcNow(),
                   .record_problem = {}};
  if (kept_ == Kept::kTrip) kept_ = Kept::kUnknown;  // it names another trip
}

void TripLatch::Follow(std::int64_t now_ns, const Permit& newest, bool awaiting) {
  NoteTrip(newest);
  if (newest.state == SafetyState::kTripped) {
    Keep(now_ns, Kept::kTrip);
  } else if (newest.state == SafetyState::kIdle && !awaiting) {
    Keep(now_ns, Kept::kNothing);
  }
}

void TripLatch::Keep(std::int64_t now_ns, Kept wanted) {
  if (kept_ == wanted || (failed_ == wanted && now_ns < retry_ns_)) return;
  retry_ns_ = now_ns + kRetryNs;
  const FileChange change = wanted == Kept::kNothing
                                ? (folder_ ? folder_->Remove(kFile) : FileChange{})
                                : Write({.cause = trip_->cause,
                                         .evidence = trip_->evidence,
                                         .time_utc = trip_->time_utc,
                                         .log_directory = log_directory_});
  if (change.problem.empty()) {
    kept_ = wanted;
    failed_ = Kept::kUnknown;
    if (!problem_.empty()) report_(false, "the latch file is in order again");
    problem_.clear();
    return;
  }
  if (!change.untouched) kept_ = Kept::kUnknown;
  const bool news = problem_ != change.problem || failed_ != wanted;
  failed_ = wanted;
  problem_ = change.problem;
  if (news) report_(true, problem_ + "; " + Consequence(wanted) + ". Tried again every second.");
}

std::string TripLatch::Consequence(Kept wanted) const {
  if (wanted == Kept::kNothing) return "a restarted daemon would be tripped";
  if (kept_ == Kept::kArmed) {
    return std::string("a restarted daemon would be tripped by ") +
           ToString(TripCause::kEndedWhileArmed) + ", without the cause of this trip";
  }
  return "this trip would not survive a restart of the daemon";
}

}  // namespace flexarm
