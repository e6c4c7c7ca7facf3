#include "controller/runlog/run_reader.h"

#include <array>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string_view>

#include "controller/runlog/blob.h"
#include "controller/runlog/schema.h"

namespace flexarm {
namespace {

constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);

constexpr const char* kSelectTick =
    "SELECT tick, truth_known, truth_hub_1_rad, truth_hub_2_rad, truth_tip_x_m, truth_tip_y_m,"
    " truth_deflection_1_m, truth_deflection_2_m, input, output, ";

std::filesystem::path WalOf(const std::filesystem::path& file) { return file.string() + "-wal"; }

bool HasWal(const std::filesystem::path& file) {
  std::error_code missing;
  return std::filesystem::file_size(WalOf(file), missing) > 0 && !missing;
}

PlantTruth ReadTruth(const SqliteStatement& row) {
  return {.hub_angle_rad = {row.Real(2), row.Real(3)},
          .tip_m = {row.Real(4), row.Real(5)},
          .tip_deflection_m = {row.Real(6), row.Real(7)},
          .known = row.Integer(1) != 0};
}

template <typename T>
T ParseInteger(const std::string& text) {
  T value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// The first bytes of a file, printable, for a message.
std::string Beginning(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text(16, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '.';
  }
  return text;
}

}  // namespace

bool LooksLikeSqlite(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::array<char, kSqliteMagic.size()> found{};
  stream.read(found.data(), found.size());
  return stream.good() && std::string_view(found.data(), found.size()) == kSqliteMagic;
}

/// The log and its -wal file in a temporary folder, where SQLite can create its -shm file.
class RunReader::TemporaryCopy {
 public:
  explicit TemporaryCopy(const std::filesystem::path& original) {
    std::string pattern = (std::filesystem::temp_directory_path() / "flexarm-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw std::filesystem::filesystem_error("cannot make a folder", pattern,
                                              std::error_code(errno, std::generic_category()));
    }
    folder_ = pattern;
    std::filesystem::copy_file(original, file());
    if (HasWal(original)) std::filesystem::copy_file(WalOf(original), WalOf(file()));
  }
  ~TemporaryCopy() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  TemporaryCopy(const TemporaryCopy&) = delete;
  TemporaryCopy& operator=(const TemporaryCopy&) = delete;

  std::filesystem::path file() const { return folder_ / "run.flexarm"; }

 private:
  std::filesystem::path folder_;
};

void RunReader::Fail(const std::string& what) const {
  throw InputError(file_.string() + ": " + what);
}

template <typename Action>
void RunReader::Guarded(Action action) {
  try {
    action();
  } catch (const SqliteError& error) {
    Fail(std::string("damaged or cut short: found \"") + error.what() +
         "\", expected a complete run log");
  }
}

RunReader::RunReader(const std::filesystem::path& file) : file_(file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) Fail(error.message() + "; expected a run log (.flexarm)");
  if (size == 0) Fail("is empty; expected a run log (.flexarm)");
  if (!LooksLikeSqlite(file)) {
    Fail("not a run log: begins with \"" + Beginning(file) +
         "\", expected a SQLite file (.flexarm)");
  }
  OpenFile();
  Guarded([&] { CheckIdentity(); });
  Guarded([&] { ReadInfo(); });
}

RunReader::~RunReader() = default;

void RunReader::TryOpen(const std::filesystem::path& file, bool immutable) {
  db_ = SqliteDb::OpenReadOnly(file, immutable);
  db_.QueryInteger("SELECT count(*) FROM sqlite_master");  // SQLite opens the file at first use
}

// A log in WAL mode needs a -shm file beside it. Where that cannot be created, a log without a -wal
// file is read in place, and one with a -wal file is read from a copy.
void RunReader::OpenFile() {
  try {
    TryOpen(file_, false);
    return;
  } catch (const SqliteError&) {  // the next attempt reports the error
  }
  Guarded([&] {
    if (!HasWal(file_)) {
      TryOpen(file_, true);
      return;
    }
    try {
      copy_ = std::make_unique<TemporaryCopy>(file_);
    } catch (const std::filesystem::filesystem_error& error) {
      Fail(std::string("its folder is read-only and it could not be copied: ") + error.what());
    }
    TryOpen(copy_->file(), false);
  });
}

void RunReader::CheckIdentity() {
  const std::int64_t id = db_.QueryInteger("PRAGMA application_id");
  if (id != kRunLogApplicationId) {
    Fail("not a run log: a SQLite file with application id " + std::to_string(id) + ", expected " +
         std::to_string(kRunLogApplicationId));
  }
  const std::int64_t version = db_.QueryInteger("PRAGMA user_version");
  if (version < 1 || version > kRunLogSchemaVersion) {
    Fail("has schema version " + std::to_string(version) + ", expected at most " +
         std::to_string(kRunLogSchemaVersion) + "; it was written by a newer flexarm");
  }
  SqliteStatement mode = db_.Prepare("PRAGMA journal_mode");
  closed_ = mode.Step() && mode.Text(0) != "wal";
}

void RunReader::SetInfo(const std::string& key, const std::string& value) {
  if (key == run_key::kStartUtc) info_.start_utc = value;
  if (key == run_key::kStartNs) info_.start_ns = ParseInteger<std::int64_t>(value);
  if (key == run_key::kVersion) info_.version = value;
  if (key == run_key::kBuildId) info_.build_id = value;
  if (key == run_key::kRigName) info_.rig_name = value;
  if (key == run_key::kClock) info_.clock = value;
  if (key == run_key::kBackend) info_.backend = value;
  if (key == run_key::kSeed) info_.seed = ParseInteger<std::uint64_t>(value);
  if (key == run_key::kConfig) info_.config_text = value;
  if (key == run_key::kExperimentName) info_.experiment_name = value;
  if (key == run_key::kExperiment) info_.experiment_text = value;
  if (key == run_key::kGains) info_.gains_json = value;
  if (key == run_key::kResult) info_.result_json = value;
}

void RunReader::ReadInfo() {
  SqliteStatement row = db_.Prepare("SELECT key, value FROM run");
  while (row.Step()) SetInfo(row.Text(0), row.Text(1));
}

bool RunReader::HasGateColumn() {
  SqliteStatement row =
      db_.Prepare("SELECT count(*) FROM pragma_table_info('tick') WHERE name = 'gate'");
  return row.Step() && row.Integer(0) != 0;
}

void RunReader::ForEachTick(const std::function<void(const TickRecord&)>& visit) {
  Guarded([&] {
    std::string select = kSelectTick;
    select.append(HasGateColumn() ? "gate" : "0");  // an older log has no such column
    select.append(" FROM tick ORDER BY tick");
    SqliteStatement row = db_.Prepare(select);
    while (row.Step()) {
      TickRecord record;
      const std::string where = "tick " + std::to_string(row.Integer(0)) + ": ";
      std::string wrong = DecodeBlob(row.Blob(8), kStepInputVersion, &record.input);
      if (!wrong.empty()) Fail(where + "input " + wrong);
      wrong = DecodeBlob(row.Blob(9), kStepOutputVersion, &record.output);
      if (!wrong.empty()) Fail(where + "output " + wrong);
      if (record.input.tick != row.Integer(0)) {
        Fail(where + "input belongs to tick " + std::to_string(record.input.tick));
      }
      record.truth = ReadTruth(row);
      record.gate_reasons = static_cast<std::uint32_t>(row.Integer(10));
      visit(record);
    }
  });
}

void RunReader::ForEachTiming(const std::function<void(const TimingRecord&)>& visit) {
  Guarded([&] {
    SqliteStatement row =
        db_.Prepare("SELECT tick, due_ns, woke_ns, finished_ns FROM timing ORDER BY rowid");
    while (row.Step()) {
      visit({.tick = row.Integer(0),
             .due_ns = row.Integer(1),
             .woke_ns = row.Integer(2),
             .finished_ns = row.Integer(3)});
    }
  });
}

void RunReader::ForEachSafety(const std::function<void(const SafetyRecord&)>& visit) {
  Guarded([&] {
    SqliteStatement row = db_.Prepare(kSelectSafety);
    while (row.Step()) {
      SafetyRecord record;
      const std::string wrong = ReadSafety(row, &record);
      if (!wrong.empty()) Fail("safety row " + std::to_string(row.Integer(0)) + " " + wrong);
      visit(record);
    }
  });
}

void RunReader::ForEachEvent(const std::function<void(const RunEvent&)>& visit) {
  Guarded([&] {
    SqliteStatement row = db_.Prepare(
        "SELECT time_ns, kind, name, text, value_json FROM event ORDER BY time_ns, number");
    while (row.Step()) {
      visit({.time_ns = row.Integer(0),
             .kind = row.Text(1),
             .name = row.Text(2),
             .text = row.Text(3),
             .value_json = row.Text(4)});
    }
  });
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
