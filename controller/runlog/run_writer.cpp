#include "controller/runlog/run_writer.h"

#include <array>
#include <cctype>
#include <ctime>
#include <utility>
#include <variant>

#include "controller/runlog/blob.h"
#include "controller/runlog/build_info.h"
#include "controller/runlog/schema.h"
#include "controller/runlog/tick_columns.h"

namespace flexarm {
namespace {

std::string Utc(const char* format) {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  std::array<char, 32> text;
  const std::size_t length = std::strftime(text.data(), text.size(), format, &parts);
  return {text.data(), length};
}

// Binds values one after the other.
class Row {
 public:
  explicit Row(SqliteStatement* statement) : statement_(statement) {}
  Row& operator<<(std::int64_t value) { return Bind(value); }
  Row& operator<<(double value) { return Bind(value); }
  Row& operator<<(std::string_view text) { return Bind(text); }
  Row& operator<<(std::span<const std::byte> blob) { return Bind(blob); }

 private:
  template <typename T>
  Row& Bind(T value) {
    statement_->Bind(next_++, value);
    return *this;
  }
  SqliteStatement* statement_;
  int next_ = 1;
};

// While another process reads the run, SQLite keeps the -wal file. All rows are committed, so this
// is no error.
void LeaveOneFile(SqliteDb* db) {
  try {
    db->Execute("PRAGMA wal_checkpoint(TRUNCATE)");
    db->Execute("PRAGMA journal_mode=DELETE");
  } catch (const SqliteError& error) {
    if (!error.is_busy()) throw;
  }
}

}  // namespace

std::string UtcNow() { return Utc("%Y-%m-%dT%H:%M:%SZ"); }

std::filesystem::path NewRunFile(const std::filesystem::path& directory, const std::string& name) {
  std::string safe = name.empty() ? "manual" : name;
  for (char& c : safe) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '.') c = '_';
  }
  const std::string stem = Utc("%Y%m%dT%H%M%SZ-") + safe;
  std::filesystem::path file = directory / (stem + ".flexarm");
  for (int n = 2; std::filesystem::exists(file); ++n) {
    file = directory / (stem + "-" + std::to_string(n) + ".flexarm");
  }
  return file;
}

template <typename Action>
void RunWriter::Guarded(Action action) {
  try {
    action();
  } catch (const SqliteError& error) {
    throw RunLogError(file_.string() + ": cannot write the run log: " + error.what());
  }
}

RunWriter::RunWriter(std::filesystem::path file, const RunInfo& info)
    : file_(std::move(file)),
      start_ns_(info.start_ns),
      has_experiment_(!info.experiment_text.empty()) {
  if (std::filesystem::exists(file_)) {
    throw RunLogError(file_.string() + ": already exists; a run is never overwritten");
  }
  std::error_code ignored;  // opening the file reports what is wrong with the folder
  if (file_.has_parent_path()) std::filesystem::create_directories(file_.parent_path(), ignored);
  Guarded([&] {
    db_ = SqliteDb::CreateNew(file_);
    CreateTables();
    PrepareStatements();
    WriteInfo(info);
  });
}

RunWriter::~RunWriter() {
  try {
    Close("");
  } catch (const RunLogError&) {  // a destructor cannot report it; Close() can
  }
}

void RunWriter::CreateTables() {
  db_.Execute("PRAGMA journal_mode=WAL");
  // A commit survives the process; a power failure may lose the last commits but not the file.
  db_.Execute("PRAGMA synchronous=NORMAL");
  db_.Execute("BEGIN IMMEDIATE");
  const std::string id = std::to_string(kRunLogApplicationId);
  const std::string version = std::to_string(kRunLogSchemaVersion);
  db_.Execute(("PRAGMA application_id=" + id).c_str());
  db_.Execute(("PRAGMA user_version=" + version).c_str());
  db_.Execute(kRunLogSchema);
  db_.Execute(CreateTickTable().c_str());
  db_.Execute(kSafetyTable);
  in_transaction_ = true;
}

void RunWriter::PrepareStatements() {
  set_key_ = db_.Prepare("INSERT OR REPLACE INTO run VALUES (?,?)");
  insert_tick_ = db_.Prepare(InsertTick());
  insert_timing_ = db_.Prepare("INSERT INTO timing VALUES (?,?,?,?,?,?)");
  insert_safety_ = db_.Prepare(kInsertSafety);
  insert_event_ = db_.Prepare("INSERT INTO event VALUES (NULL,?,?,?,?,?,?)");
}

void RunWriter::WriteInfo(const RunInfo& info) {
  SetKey(run_key::kStartUtc, info.start_utc.empty() ? UtcNow() : info.start_utc);
  SetKey(run_key::kStartNs, std::to_string(info.start_ns));
  SetKey(run_key::kVersion, info.version.empty() ? ThisBuild().version : info.version);
  SetKey(run_key::kBuildId, info.build_id.empty() ? BuildId() : info.build_id);
  SetKey(run_key::kRigName, info.rig_name);
  SetKey(run_key::kClock, info.clock);
  SetKey(run_key::kBackend, info.backend);
  SetKey(run_key::kSeed, std::to_string(info.seed));
  SetKey(run_key::kConfig, info.config_text);
  SetKey(run_key::kExperimentName, info.experiment_name);
  SetKey(run_key::kExperiment, info.experiment_text);
  SetKey(run_key::kGains, info.gains_json);
  Commit();
}

void RunWriter::SetKey(const char* key, const std::string& value) {
  BeginIfNeeded();
  set_key_.Bind(1, std::string_view(key));
  set_key_.Bind(2, std::string_view(value));
  set_key_.Execute();
}

void RunWriter::BeginIfNeeded() {
  if (in_transaction_) return;
  db_.Execute("BEGIN IMMEDIATE");
  in_transaction_ = true;
}

double RunWriter::SinceStart(std::int64_t time_ns) const {
  return static_cast<double>(time_ns - start_ns_) * 1e-9;
}

void RunWriter::Tick(const TickRecord& record) {
  Guarded([&] {
    BeginIfNeeded();
    const auto input = EncodeBlob(kStepInputVersion, record.input);
    const auto output = EncodeBlob(kStepOutputVersion, record.output);
    Row row(&insert_tick_);
    row << record.input.tick << SinceStart(record.input.sampling_instant_ns);
    for (const TickColumn& column : TickColumns()) {
      std::visit([&row](auto value) { row << value; }, column.value(record));
    }
    row << std::span<const std::byte>(input) << std::span<const std::byte>(output);
    insert_tick_.Execute();
  });
}

void RunWriter::Timing(const TimingRecord& record) {
  Guarded([&] {
    BeginIfNeeded();
    Row(&insert_timing_) << record.tick << record.due_ns << record.woke_ns << record.finished_ns
                         << static_cast<double>(record.woke_ns - record.due_ns) * 1e-3
                         << static_cast<double>(record.finished_ns - record.woke_ns) * 1e-3;
    insert_timing_.Execute();
  });
}

void RunWriter::Safety(const SafetyRecord& record) {
  Guarded([&] {
    BeginIfNeeded();
    InsertSafety(&insert_safety_, record, start_ns_);
  });
}

void RunWriter::Event(const RunEvent& event) {
  Guarded([&] {
    BeginIfNeeded();
    Row(&insert_event_) << event.time_ns << SinceStart(event.time_ns)
                        << std::string_view(event.kind) << std::string_view(event.name)
                        << std::string_view(event.text) << std::string_view(event.value_json);
    insert_event_.Execute();
  });
}

void RunWriter::SetExperiment(const std::string& name, const std::string& text) {
  if (has_experiment_) return;
  has_experiment_ = true;
  Guarded([&] {
    SetKey(run_key::kExperimentName, name);
    SetKey(run_key::kExperiment, text);
  });
}

void RunWriter::Commit() {
  if (!in_transaction_) return;
  Guarded([&] { db_.Execute("COMMIT"); });
  in_transaction_ = false;
}

void RunWriter::Close(const std::string& result_json) {
  if (!db_.is_open()) return;
  if (!result_json.empty()) Guarded([&] { SetKey(run_key::kResult, result_json); });
  Commit();
  for (SqliteStatement* statement :
       {&set_key_, &insert_tick_, &insert_timing_, &insert_safety_, &insert_event_}) {
    *statement = SqliteStatement();
  }
  Guarded([&] { LeaveOneFile(&db_); });
  db_.Close();
}

}  // namespace flexarm
