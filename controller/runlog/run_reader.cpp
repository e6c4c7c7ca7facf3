#include "controller/runlog/run_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <string_view>

#include "controller/files/external_file.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/runlog/file_descriptor.h"
#include "controller/runlog/record_blocks.h"
#include "controller/runlog/row_order.h"
#include "controller/runlog/run_conversion.h"
#include "controller/runlog/run_digest.h"
#include "controller/runlog/run_file_lock.h"
#include "controller/runlog/run_info_keys.h"
#include "controller/runlog/sample_table.h"
#include "controller/runlog/schema.h"

namespace flexarm {
namespace {

constexpr std::size_t kShownCause = 200;  // bytes of a message of SQLite, which may quote the file
constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);

// The first bytes of a file.
std::string BeginningOf(int fd) {
  std::string text(16, '\0');
  const ssize_t count = ::pread(fd, text.data(), text.size(), 0);
  text.resize(count < 0 ? 0 : static_cast<std::size_t>(count));
  return text;
}

}  // namespace

void RunReader::Fail(const std::string& what) const {
  throw InputError(Shown(file_.string(), kMessageBytes) + ": " + what);
}

template <typename Action>
void RunReader::Guarded(Action action) {
  try {
    action();
  } catch (const SqliteError& error) {
    Fail("damaged or cut short: found \"" + Shown(error.what(), kShownCause) +
         "\", expected a complete run log");
  } catch (const std::bad_alloc&) {
    Fail("damaged: it asks for more memory than there is, expected a complete run log");
  }
}

RunReader::RunReader(const std::filesystem::path& file) : file_(file) {
  if (const auto problem = ProblemOfPlace(file, "a run log (.flexarm)")) {
    throw InputError(problem->Text(file));
  }
  const FileDescriptor fd(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  struct stat there{};
  if (!fd.is_open() || ::fstat(fd.get(), &there) != 0) {
    Fail(std::string(std::strerror(errno)) + "; expected a run log (.flexarm)");
  }
  if (there.st_size == 0) Fail("is empty; expected a run log (.flexarm)");
  const std::string beginning = BeginningOf(fd.get());
  if (beginning.starts_with(kRecordMagic)) {
    OpenRecords(fd.get());
  } else if (beginning == kSqliteMagic) {
    OpenSqlite(there.st_size);
  } else {
    Fail("not a run log: begins with \"" + Shown(beginning) + "\", expected a run log (.flexarm)");
  }
  Guarded([&] { ReadInfo(); });
}

void RunReader::OpenRecords(int fd) {
  state_ = RunFileIsLocked(fd) ? RunState::kWritten : RunState::kLeft;
  RecordFileReader records(fd);
  if (!records.problem().empty()) Fail(records.problem());
  RecordFileEnd end;
  Guarded([&] {
    db_ = SqliteDb::InMemory();
    end = FillTables(&records, &db_);
  });
  if (end.damaged_at) {
    Fail("damaged at byte " + std::to_string(*end.damaged_at) +
         "; `flexarm log recover` makes a run of what stands before it");
  }
  left_out_bytes_ = end.left_out_bytes;
}

// A SQLite log is never written again: it needs neither a lock nor a file beside it.
void RunReader::OpenSqlite(std::int64_t file_bytes) {
  Guarded([&] {
    db_ = SqliteDb::OpenReadOnly(file_, true);
    db_.Distrust(static_cast<int>(kLargestPayload));
    const std::string problem = SchemaProblem(&db_);
    if (!problem.empty()) Fail(Shown(problem, kMessageBytes));
    // SQLite takes what is missing of the last page for zeros.
    const std::int64_t bytes =
        db_.QueryInteger("PRAGMA page_count") * db_.QueryInteger("PRAGMA page_size");
    if (file_bytes != bytes) {
      Fail("cut short or damaged: found " + std::to_string(file_bytes) + " bytes, expected " +
           std::to_string(bytes));
    }
  });
}

void RunReader::ReadInfo() {
  RowOrder<std::string> order("run");
  SqliteStatement row = db_.Prepare("SELECT key, value FROM run ORDER BY key");
  while (row.Step()) {
    const std::string key = row.Text(0);
    order.Next(key);
    if (key == run_key::kDigest) digest_ = row.Text(1);
    SetInfo(&info_, key, row.Text(1));
  }
}

void RunReader::ForEachTick(const std::function<void(const TickRecord&)>& visit) {
  Guarded([&] {
    RowOrder<std::int64_t> order("block");
    std::vector<TickRecord> ticks;
    SqliteStatement row = db_.Prepare("SELECT first_tick, records FROM block ORDER BY first_tick");
    while (row.Step()) {
      const std::int64_t first = row.Integer(0);
      const std::string where = "block of tick " + std::to_string(first) + ": ";
      const std::string wrong = UnpackTicks(row.Text(1), &ticks);
      if (!wrong.empty()) Fail(where + wrong);
      if (ticks.front().input.tick != first) {
        Fail(where + "begins with tick " + std::to_string(ticks.front().input.tick));
      }
      for (const TickRecord& record : ticks) {
        order.Next(record.input.tick);
        visit(record);
      }
    }
  });
}

void RunReader::ForEachTiming(const std::function<void(const TimingRecord&)>& visit) {
  Guarded([&] {
    RowOrder<std::int64_t> order("activation");
    SqliteStatement row = db_.Prepare(kSelectTiming);
    while (row.Step()) {
      order.Next(row.Integer(0));
      visit({.tick = row.Integer(1),
             .due_ns = row.Integer(2),
             .woke_ns = row.Integer(3),
             .finished_ns = row.Integer(4)});
    }
  });
}

void RunReader::ForEachSafety(const std::function<void(const SafetyRecord&)>& visit) {
  Guarded([&] {
    RowOrder<std::int64_t> order("safety");
    SqliteStatement row = db_.Prepare(kSelectSafety);
    while (row.Step()) {
      order.Next(row.Integer(0));
      SafetyRecord record;
      const std::string wrong = ReadSafety(row, &record);
      if (!wrong.empty()) Fail("safety row " + std::to_string(row.Integer(0)) + " " + wrong);
      visit(record);
    }
  });
}

// Sorted here: SQLite would collect all rows, however many, before it gives the first.
void RunReader::ForEachEvent(const std::function<void(const RunEvent&)>& visit) {
  std::vector<RunEvent> events;
  Guarded([&] {
    RowOrder<std::int64_t> order("event");
    SqliteStatement row = db_.Prepare(
        "SELECT time_ns, kind, name, text, value_json, number FROM event ORDER BY number");
    while (row.Step()) {
      order.Next(row.Integer(5));
      events.push_back({.time_ns = row.Integer(0),
                        .kind = row.Text(1),
                        .name = row.Text(2),
                        .text = row.Text(3),
                        .value_json = row.Text(4)});
    }
  });
  std::stable_sort(events.begin(), events.end(),
                   [](const RunEvent& a, const RunEvent& b) { return a.time_ns < b.time_ns; });
  for (const RunEvent& event : events) visit(event);
}

bool RunReader::DigestHolds() {
  if (!closed()) return true;
  bool holds = false;
  Guarded([&] { holds = DigestOfTables(&db_) == digest_; });
  return holds;
}

RunContents RunReader::ReadAll() {
  RunContents run;
  run.info = info_;
  ForEachTick([&](const TickRecord& record) { run.tick.push_back(record); });
  ForEachTiming([&](const TimingRecord& record) { run.timing.push_back(record); });
  ForEachSafety([&](const SafetyRecord& record) { run.safety.push_back(record); });
  ForEachEvent([&](const RunEvent& event) { run.event.push_back(event); });
  return run;
}

}  // namespace flexarm
