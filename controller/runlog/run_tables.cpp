#include "controller/runlog/run_tables.h"

#include <span>
#include <string>
#include <variant>

#include "controller/runlog/run_digest.h"
#include "controller/runlog/run_info_keys.h"
#include "controller/runlog/safety_rows.h"
#include "controller/runlog/schema.h"

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

RunTables::RunTables(SqliteDb* db, Packing packing) : db_(db), packing_(packing) {
  db_->Execute("BEGIN IMMEDIATE");
  CreateRunTables(db_);
  set_key_ = db_->Prepare("INSERT OR REPLACE INTO run VALUES (?,?)");
  samples_.emplace(db_);
  insert_block_ = db_->Prepare("INSERT INTO block VALUES (?,?)");
  insert_safety_ = db_->Prepare(kInsertSafety);
  insert_event_ = db_->Prepare("INSERT INTO event VALUES (NULL,?,?,?,?,?,?)");
}

void RunTables::Add(const RunRecord& record) {
  std::visit([this](const auto& content) { AddOne(content); }, record);
}

void RunTables::Finish() {
  AddBlock();
  AddTimings();
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

void RunTables::AddOne(const TicksRecord& record) {
  for (const TickRecord& tick : record.ticks) {
    ticks_.push_back(tick);
    if (ticks_.size() == kLargestBlock) AddBlock();
  }
}

void RunTables::AddOne(const TimingsRecord& record) {
  timings_.insert(timings_.end(), record.timings.begin(), record.timings.end());
  if (timings_.size() >= kLargestBlock) AddTimings();
}

void RunTables::AddBlock() {
  if (ticks_.empty()) return;
  const std::string block = PackTicks(ticks_, packing_);
  Row(&insert_block_) << ticks_.front().input.tick << std::as_bytes(std::span(block));
  insert_block_.Execute();
  samples_->Add(ticks_, start_ns_);
  ticks_.clear();
}

void RunTables::AddTimings() {
  samples_->Add(timings_);
  timings_.clear();
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
