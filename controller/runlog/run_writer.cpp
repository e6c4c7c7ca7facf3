#include "controller/runlog/run_writer.h"

#include <array>
#include <cctype>
#include <ctime>
#include <exception>

#include "controller/runlog/record_blocks.h"
#include "controller/runlog/run_conversion.h"
#include "controller/runlog/run_file_lock.h"
#include "controller/runlog/run_info_keys.h"
#include "controller/runlog/schema.h"

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

AppendFile Taken(ReservedRunFile file) {
  const std::filesystem::path path = file.path();
  return {path, file.Take()};
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

std::string EndedRun::Finish() noexcept {
  try {
    if (!file_.Sync()) return file_.trouble();
    ConvertRecordFile(file_.fd(), file_.path());
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

RunWriter::RunWriter(const std::filesystem::path& file, const RunInfo& info)
    : RunWriter(ReservedRunFile::At(file), info) {}

RunWriter::RunWriter(ReservedRunFile file, const RunInfo& info)
    : file_(std::make_unique<AppendFile>(Taken(std::move(file)))), name_(file_->path().string()) {
  RunInfo filled = info;
  if (filled.start_utc.empty()) filled.start_utc = UtcNow();
  file_->Append(RecordHeader());
  for (const InfoRecord& key : InfoKeys(filled)) Add(key);
  if (file_->Flush()) return;
  if (NamesFile(file_->path(), file_->fd())) ::unlink(file_->path().c_str());
  throw RunLogError(file_->trouble());
}

RunWriter::~RunWriter() {
  try {
    Close("");
  } catch (const std::exception&) {  // a destructor cannot report it; Close() can
  }
}

void RunWriter::Add(const RunRecord& record, std::size_t parts) {
  const std::string bytes = EncodeRecord(record, file_->size());
  if (bytes.size() > kLargestPayload) {
    throw RunLogError(name_ + ": cannot write a record of " + std::to_string(bytes.size()) +
                      " bytes");
  }
  if (file_->pending_bytes() + bytes.size() > kLargestBacklog) {
    lost_records_ += parts;
  } else {
    file_->Append(bytes);
  }
}

void RunWriter::Tick(const TickRecord& record) {
  last_tick_ns_ = record.input.now_ns;
  ticks_.ticks.push_back(record);
  if (ticks_.ticks.size() == kLargestBlock) AddBlocks();
}

void RunWriter::Timing(const TimingRecord& record) {
  timings_.timings.push_back(record);
  if (timings_.timings.size() == kLargestBlock) AddBlocks();
}

void RunWriter::AddBlocks() {
  if (!ticks_.ticks.empty()) Add(ticks_, ticks_.ticks.size());
  if (!timings_.timings.empty()) Add(timings_, timings_.timings.size());
  ticks_.ticks.clear();
  timings_.timings.clear();
}

// Beside the limit of the backlog: a loss is told in any case.
void RunWriter::AddGap() {
  if (lost_records_ == 0) return;
  const std::string count = std::to_string(lost_records_);
  lost_records_ = 0;
  const RunEvent gap{.time_ns = last_tick_ns_,
                     .kind = "gap",
                     .name = "disk",
                     .text = count + " records were lost: the disk took nothing for so long.",
                     .value_json = "{\"records\":" + count + "}"};
  file_->Append(EncodeRecord(gap, file_->size()));
}

void RunWriter::Commit() {
  AddBlocks();
  if (!file_->Flush()) return;
  name_ = file_->path().string();
  AddGap();
}

std::string RunWriter::Trouble() const {
  if (file_ == nullptr || file_->trouble().empty()) return {};
  std::string trouble =
      file_->trouble() + "; " + std::to_string(file_->pending_bytes()) + " bytes wait in memory";
  if (lost_records_ > 0) trouble += ", " + std::to_string(lost_records_) + " records are lost";
  return trouble;
}

EndedRun RunWriter::End(const std::string& result_json) {
  Commit();
  AddGap();
  AppendFile file = std::move(*file_);
  file_.reset();
  file.Append(EncodeRecord(EndRecord{.result_json = result_json}, file.size()));
  return EndedRun(std::move(file));
}

void RunWriter::Close(const std::string& result_json) {
  if (file_ == nullptr) return;
  const std::string trouble = End(result_json).Finish();
  if (!trouble.empty()) throw RunLogError(trouble);
}

}  // namespace flexarm
