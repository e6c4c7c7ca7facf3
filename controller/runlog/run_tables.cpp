#include "controller/runlog/run_tables.h"

#include <span>
#include <string>
#include <variant>

#include "controller/runlog/blob.h"
#include "controller/runlog/run_digest.h"
#include "controller/runlog/run_info_keys.h"
#include "controller/runlog/safety_rows.h"
#include "controller/runlog/schema.h"
#include "controller/runlog/tick_columns.h"

namespace flexarm {
namespace {

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

}  // namespace

RunTables::RunTables(SqliteDb* db) : db_(db) {
  db_->Execute("BEGIN IMMEDIATE");
  CreateRunTables(db_);
  set_key_ = db_->Prepare("INSERT OR REPLACE INTO run VALUES (?,?)");
  insert_tick_ = db_->Prepare(InsertTick());
  insert_timing_ = db_->Prepare("INSERT INTO timing VALUES (?,?,?,?,?,?)");
  insert_safety_ = db_->Prepare(kInsertSafety);
  insert_event_ = db_->Prepare("INSERT INTO event VALUES (NULL,?,?,?,?,?,?)");
}

void RunTables::Add(const RunRecord& record) {
  std::visit([this](const auto& content) { AddOne(content); }, record);
}

void RunTables::Seal() {
  AddOne(InfoRecord{.key = run_key::kDigest, .value = DigestOfTables(db_)});
}

void RunTables::Commit() { db_->Execute("COMMIT"); }

double RunTables::SinceStart(std::int64_t time_ns) const {
  return static_cast<double>(time_ns - start_ns_) * 1e-9;
}

void RunTables::AddOne(const InfoRecord& record) {
  RunInfo info;
  info.start_ns = start_ns_;
  SetInfo(&info, record.key, record.value);
  start_ns_ = info.start_ns;
  Row(&set_key_) << std::string_view(record.key) << std::string_view(record.value);
  set_key_.Execute();
}

void RunTables::AddOne(const TickRecord& record) {
  const auto input = EncodeBlob(kStepInputVersion, record.input);
  const auto output = EncodeBlob(kStepOutputVersion, record.output);
  Row row(&insert_tick_);
  row << record.input.tick << SinceStart(record.input.sampling_instant_ns);
  for (const TickColumn& column : TickColumns()) {
    std::visit([&row](auto value) { row << value; }, column.value(record));
  }
  row << std::span<const std::byte>(input) << std::span<const std::byte>(output);
  insert_tick_.Execute();
}

void RunTables::AddOne(const TimingRecord& record) {
  Row(&insert_timing_) << record.tick << record.due_ns << record.woke_ns << record.finished_ns
                       << static_cast<double>(record.woke_ns - record.due_ns) * 1e-3
                       << static_cast<double>(record.finished_ns - record.woke_ns) * 1e-3;
  insert_timing_.Execute();
}

void RunTables::AddOne(const SafetyRecord& record) {
  InsertSafety(&insert_safety_, record, start_ns_);
}

void RunTables::AddOne(const RunEvent& event) {
  Row(&insert_event_) << event.time_ns << SinceStart(event.time_ns) << std::string_view(event.kind)
                      << std::string_view(event.name) << std::string_view(event.text)
                      << std::string_view(event.value_json);
  insert_event_.Execute();
}

void RunTables::AddOne(const EndRecord& record) {
  if (record.result_json.empty()) return;
  AddOne(InfoRecord{.key = run_key::kResult, .value = record.result_json});
}

}  // namespace flexarm
