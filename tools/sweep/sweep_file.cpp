#include "tools/sweep/sweep_file.h"

#include <new>
#include <sstream>
#include <utility>

#include "controller/files/external_file.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"

namespace flexarm {
namespace {

constexpr int kFormat = 5;
constexpr std::size_t kShownCause = 200, kShownDifference = 400;  // bytes

// Runs `body`; an error of SQLite becomes an InputError that names the file.
template <typename Body>
auto Told(const std::filesystem::path& file, const Body& body) {
  try {
    return body();
  } catch (const SqliteError& error) {
    throw InputError(Shown(file.string(), kMessageBytes) + ": " + Shown(error.what(), kShownCause));
  } catch (const std::bad_alloc&) {
    throw InputError(Shown(file.string(), kMessageBytes) +
                     ": is damaged: it asks for more memory than there is");
  }
}

constexpr const char* kExpected = "a result file of flexarm sweep";

[[noreturn]] void RefuseSweepFile(const std::filesystem::path& file) {
  throw InputError(Shown(file.string(), kMessageBytes) + ": is not " + kExpected);
}

// SQLite would create the missing tables of an empty file, and tidy up a run's log when it closes
// it: so what is no result file is found before it is opened.
void CheckSweepFile(const std::filesystem::path& file, bool may_be_new) {
  if (const auto problem = ProblemOfPlace(file, kExpected)) {
    if (may_be_new && problem->missing) return;
    throw InputError(problem->Text(file));
  }
  constexpr std::size_t kHeader = 100, kApplicationId = 68;  // SQLite's file format, section 1.3
  const std::string header = Beginning(file, kHeader);
  if (may_be_new && header.empty()) return;
  const bool is_sqlite = header.size() == kHeader && header.starts_with("SQLite format 3");
  if (!is_sqlite || header.substr(kApplicationId, 4) != std::string(4, '\0')) RefuseSweepFile(file);
}

std::string QuotedColumn(const std::string& name) {
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

// NUMERIC affinity: texts that are numbers are stored as numbers, so that queries can compare them.
std::string RunTable(const std::vector<SweepAxis>& axes) {
  std::string sql = "CREATE TABLE run (point INTEGER PRIMARY KEY";
  for (const SweepAxis& axis : axes) sql += ", " + QuotedColumn(axis.Column()) + " NUMERIC";
  sql += ", completed INTEGER NOT NULL, trip TEXT, refused TEXT, ticks INTEGER NOT NULL";
  for (const SweepMeasure& measure : kSweepMeasures) {
    sql += ", " + std::string(measure.column) + " REAL";
  }
  return sql + ", wall_s REAL NOT NULL)";
}

std::string FirstDifference(const std::string& held, const std::string& asked) {
  std::istringstream a(held), b(asked);
  std::string line_a, line_b;
  while (true) {
    const bool more_a = static_cast<bool>(std::getline(a, line_a));
    const bool more_b = static_cast<bool>(std::getline(b, line_b));
    if (!more_a) line_a = "(end)";
    if (!more_b) line_b = "(end)";
    if (line_a != line_b || !more_a || !more_b) break;
  }
  return "\"" + line_a + "\" there, \"" + line_b + "\" here";
}

std::string AxesText(const std::vector<SweepAxis>& axes) {
  std::string text;
  for (const SweepAxis& axis : axes) {
    text += (text.empty() ? "" : "; ") + axis.Column() + " = " + axis.values.front();
    for (std::size_t i = 1; i < axis.values.size(); ++i) text += "," + axis.values[i];
  }
  return text;
}

void BindText(SqliteStatement* statement, int parameter, const std::string& text) {
  if (text.empty()) {
    statement->BindNull(parameter);
  } else {
    statement->Bind(parameter, std::string_view(text));
  }
}

}  // namespace

std::string DifferenceOf(const SweepIdentity& held, const SweepIdentity& asked) {
  if (held.build != asked.build) {
    return "was made by another build of flexarm (" + held.build + "; this is " + asked.build + ")";
  }
  if (held.axes != asked.axes) {
    return "sweeps " + AxesText(held.axes) + "; not " + AxesText(asked.axes);
  }
  if (held.config_text != asked.config_text) {
    return "has another config: " + FirstDifference(held.config_text, asked.config_text);
  }
  if (held.experiment_text != asked.experiment_text) {
    return "has another experiment: " +
           FirstDifference(held.experiment_text, asked.experiment_text);
  }
  return {};
}

SweepFile::SweepFile(std::filesystem::path path, SqliteDb db)
    : path_(std::move(path)), db_(std::move(db)) {}

SweepFile SweepFile::Resume(const std::filesystem::path& file, const SweepIdentity& identity) {
  CheckSweepFile(file, true);
  return Told(file, [&] {
    SweepFile sweep(file, SqliteDb::OpenOrCreate(file));
    // A file without tables is new, or its process was killed before it created them.
    if (sweep.db_.QueryInteger("SELECT count(*) FROM sqlite_master") == 0) sweep.Create(identity);
    sweep.Load();
    const std::string difference = DifferenceOf(sweep.identity_, identity);
    if (difference.empty()) return sweep;
    throw InputError(file.string() + ": holds another sweep, which " +
                     Shown(difference, kShownDifference) + "; name another file with -o");
  });
}

SweepFile SweepFile::Open(const std::filesystem::path& file) {
  CheckSweepFile(file, false);
  return Told(file, [&] {
    SweepFile sweep(file, SqliteDb::OpenOrCreate(file));
    sweep.Load();
    return sweep;
  });
}

void SweepFile::Create(const SweepIdentity& identity) {
  db_.Execute("BEGIN IMMEDIATE");
  db_.Execute(
      "CREATE TABLE sweep (format INTEGER NOT NULL, build TEXT NOT NULL, config TEXT NOT NULL,"
      " experiment_name TEXT NOT NULL, experiment TEXT NOT NULL)");
  db_.Execute(
      "CREATE TABLE axis (axis INTEGER NOT NULL, target TEXT NOT NULL, key TEXT NOT NULL,"
      " number INTEGER NOT NULL, value TEXT NOT NULL, PRIMARY KEY (axis, number))");
  db_.Execute(RunTable(identity.axes).c_str());
  SqliteStatement sweep = db_.Prepare("INSERT INTO sweep VALUES (?, ?, ?, ?, ?)");
  sweep.Bind(1, std::int64_t{kFormat});
  sweep.Bind(2, std::string_view(identity.build));
  sweep.Bind(3, std::string_view(identity.config_text));
  sweep.Bind(4, std::string_view(identity.experiment_name));
  sweep.Bind(5, std::string_view(identity.experiment_text));
  sweep.Execute();
  SqliteStatement value = db_.Prepare("INSERT INTO axis VALUES (?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < identity.axes.size(); ++i) {
    const SweepAxis& axis = identity.axes[i];
    for (std::size_t j = 0; j < axis.values.size(); ++j) {
      value.Bind(1, static_cast<std::int64_t>(i));
      value.Bind(2, std::string_view(ToString(axis.target)));
      value.Bind(3, std::string_view(axis.key));
      value.Bind(4, static_cast<std::int64_t>(j));
      value.Bind(5, std::string_view(axis.values[j]));
      value.Execute();
    }
  }
  db_.Execute("COMMIT");
}

void SweepFile::Load() {
  if (db_.QueryInteger("SELECT count(*) FROM sqlite_master WHERE name IN ('sweep', 'axis', 'run')"
                       " AND type = 'table'") != 3 ||
      db_.QueryInteger("SELECT format FROM sweep") != kFormat) {
    RefuseSweepFile(path_);
  }
  SqliteStatement sweep =
      db_.Prepare("SELECT build, config, experiment_name, experiment FROM sweep");
  sweep.Step();
  identity_ = {.build = sweep.Text(0),
               .config_text = sweep.Text(1),
               .experiment_name = sweep.Text(2),
               .experiment_text = sweep.Text(3),
               .axes = {}};
  SqliteStatement value =
      db_.Prepare("SELECT axis, target, key, value FROM axis ORDER BY axis, number");
  while (value.Step()) {
    const auto axis = static_cast<std::size_t>(value.Integer(0));
    const bool next = axis == identity_.axes.size();
    if (!next && axis + 1 != identity_.axes.size()) {
      throw InputError(path_.string() + ": has axes that are not numbered from 0 on");
    }
    if (next) {
      AxisTarget target = AxisTarget::kConfig;
      while (value.Text(1) != ToString(target) && target != AxisTarget::kSeed) {
        target = static_cast<AxisTarget>(static_cast<int>(target) + 1);
      }
      identity_.axes.push_back({.target = target, .key = value.Text(2), .values = {}});
    }
    identity_.axes.back().values.push_back(value.Text(3));
  }
  try {
    grid_ = SweepGrid(identity_.axes);
  } catch (const InputError& error) {
    throw InputError(path_.string() + ": " + error.what());
  }
}

std::vector<SweepRow> SweepFile::Rows() {
  return Told(path_, [this] {
    std::string sql = "SELECT point, completed, trip, refused, ticks, wall_s";
    for (const SweepMeasure& measure : kSweepMeasures) sql += ", " + std::string(measure.column);
    SqliteStatement run = db_.Prepare(sql + " FROM run ORDER BY point");
    std::vector<SweepRow> rows;
    while (run.Step()) {
      SweepRow row{.point = static_cast<std::size_t>(run.Integer(0)),
                   .completed = run.Integer(1) != 0,
                   .trip = run.Text(2),
                   .refused = run.Text(3),
                   .ticks = run.Integer(4),
                   .measure = {},
                   .wall_s = run.Real(5)};
      if (row.point >= grid_.size()) {
        throw InputError(path_.string() + ": has a run that is not a point of its sweep");
      }
      for (std::size_t i = 0; i < row.measure.size(); ++i) {
        row.measure[i] = run.Real(6 + static_cast<int>(i));
      }
      rows.push_back(row);
    }
    return rows;
  });
}

void SweepFile::Insert(const SweepRow& row) {
  std::string sql = "INSERT OR IGNORE INTO run VALUES (?";
  const std::size_t columns = identity_.axes.size() + kSweepMeasures.size() + 5;
  for (std::size_t i = 0; i < columns; ++i) sql += ", ?";
  SqliteStatement run = db_.Prepare(sql + ")");
  int at = 0;
  run.Bind(++at, static_cast<std::int64_t>(row.point));
  for (const std::string& value : grid_.Values(row.point)) run.Bind(++at, std::string_view(value));
  run.Bind(++at, std::int64_t{row.completed ? 1 : 0});
  BindText(&run, ++at, row.trip);
  BindText(&run, ++at, row.refused);
  run.Bind(++at, row.ticks);
  for (const double measure : row.measure) run.Bind(++at, measure);
  run.Bind(++at, row.wall_s);
  run.Execute();
}

void SweepFile::Add(const SweepRow& row) {
  Told(path_, [&] { Insert(row); });
}

void SweepFile::AddAll(const std::vector<SweepRow>& rows) {
  Told(path_, [&] {
    db_.Execute("BEGIN IMMEDIATE");
    for (const SweepRow& row : rows) Insert(row);
    db_.Execute("COMMIT");
  });
}

}  // namespace flexarm
