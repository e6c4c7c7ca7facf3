#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "controller/latch/latch_record.h"
#include "controller/latch/state_folder.h"
#include "controller/types/messages.h"

namespace flexarm {

/// A trip that is latched.
struct HeldTrip {
  TripCause cause;
  Evidence evidence;
  std::string time_utc;  ///< of the trip; kEndedWhileArmed: of the arming; empty: not known
  bool before_start = false;
  std::string record_problem;  ///< kTripRecordUnreadable: the file, and what is wrong with it
};

/// Keeps a trip over the end of the process, however it ends: in one file of the state folder,
/// which says tripped, or armed. There is no file while the arm is neither.
///
/// - Before a request to arm is made, the file says armed (PrepareArm). So a process that ends
///   while the relay may be closed leaves a file, and the next one starts Tripped.
/// - Of a trip, the file says the cause as soon as the operator task sees it. A trip of an armed
///   arm is kept from the arming on.
/// - The file is removed when the arm is Idle: disarmed, or reset after a trip.
/// - A file that cannot be read counts as a trip.
///
/// A write that fails is reported once and tried again every second; what holds then is what the
/// file said before. Not real-time safe: waits for the disk, only while the relay is open.
/// Thread: operator, once it runs.
class TripLatch {
 public:
  static constexpr const char* kFile = "safety-latch.json";
  static constexpr std::int64_t kRetryNs = 1'000'000'000;

  /// For the journal.
  using Report = std::function<void(bool is_error, const std::string& text)>;

  /// @param log_directory  of the record
  TripLatch(std::filesystem::path folder, std::string log_directory, Report report);

  /// Locks the state folder and reads what the daemon before left. Before any task runs.
  /// @returns the trip in which the arm starts; empty: none
  /// @throws RejectedError if the folder cannot be used, or belongs to a daemon that runs
  std::optional<HeldTrip> Open();

  /// Before a request to arm is made: from then on the file says armed, or names the present trip,
  /// because of which the request will be refused.
  /// @param newest  permit of the safety task
  /// @returns why it could not be written: the arm must not be armed; empty: it is written
  std::string PrepareArm(const Permit& newest);

  /// Once a period: brings the file in line with the state.
  /// @param newest  permit of the safety task, read after its answers were taken
  /// @param awaiting  an arm, run or reset is not answered yet: the arm may be Idle no longer
  void Follow(std::int64_t now_ns, const Permit& newest, bool awaiting);

  /// The state folder, for its other files; nullptr before Open.
  const StateFolder* folder() const { return folder_ ? &*folder_ : nullptr; }

  /// The trip that is latched; empty: none.
  const std::optional<HeldTrip>& trip() const { return trip_; }

  /// Why the file does not say what it should; empty: it does.
  const std::string& problem() const { return problem_; }

 private:
  enum class Kept : std::uint8_t { kNothing, kArmed, kTrip, kUnknown };

  void NoteTrip(const Permit& newest);
  void Keep(std::int64_t now_ns, Kept wanted);
  FileChange Write(const LatchRecord& record);
  std::string Consequence(Kept wanted) const;

  std::filesystem::path path_;
  std::string log_directory_;
  Report report_;
  std::optional<StateFolder> folder_;  // empty: not open, so nothing can be kept
  Kept kept_ = Kept::kUnknown;         // what the file says
  std::optional<HeldTrip> trip_;
  std::string problem_;
  Kept failed_ = Kept::kUnknown;  // what the last write should have made of it; kUnknown: it did
  std::int64_t retry_ns_ = INT64_MIN;
};

}  // namespace flexarm
