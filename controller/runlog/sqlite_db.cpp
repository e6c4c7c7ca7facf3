#include "controller/runlog/sqlite_db.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace flexarm {
namespace {

std::string Cause(sqlite3* connection, int result) {
  std::string cause = sqlite3_errstr(result);
  if (connection == nullptr) return cause;
  const std::string detail = sqlite3_errmsg(connection);
  if (detail != cause) cause += " (" + detail + ")";
  const int primary = result & 0xff;
  if (primary != SQLITE_IOERR && primary != SQLITE_CANTOPEN) return cause;
  const int system_error = sqlite3_system_errno(connection);
  if (system_error != 0) return cause + ": " + std::strerror(system_error);
  return cause + " (SQLite code " + std::to_string(result) + ")";
}

// SQLite's URI syntax: only ?, # and % are special in a path.
std::string Uri(const std::filesystem::path& file) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    if (c == '?') {
      uri += "%3f";
    } else if (c == '#') {
      uri += "%23";
    } else if (c == '%') {
      uri += "%25";
    } else {
      uri += c;
    }
  }
  return uri;
}

}  // namespace

SqliteStatement::SqliteStatement(sqlite3* connection, std::string_view sql)
    : connection_(connection) {
  Check(sqlite3_prepare_v3(connection, sql.data(), static_cast<int>(sql.size()),
                           SQLITE_PREPARE_PERSISTENT, &statement_, nullptr));
}

SqliteStatement::~SqliteStatement() { sqlite3_finalize(statement_); }

SqliteStatement::SqliteStatement(SqliteStatement&& other) noexcept
    : connection_(other.connection_), statement_(std::exchange(other.statement_, nullptr)) {}

SqliteStatement& SqliteStatement::operator=(SqliteStatement&& other) noexcept {
  std::swap(connection_, other.connection_);
  std::swap(statement_, other.statement_);
  return *this;
}

void SqliteStatement::Check(int result) const {
  if (result != SQLITE_OK) throw SqliteError(Cause(connection_, result));
}

void SqliteStatement::Bind(int parameter, std::int64_t value) {
  Check(sqlite3_bind_int64(statement_, parameter, value));
}

void SqliteStatement::Bind(int parameter, double value) {
  Check(std::isnan(value) ? sqlite3_bind_null(statement_, parameter)
                          : sqlite3_bind_double(statement_, parameter, value));
}

void SqliteStatement::Bind(int parameter, std::string_view text) {
  Check(sqlite3_bind_text64(statement_, parameter, text.data(), text.size(), SQLITE_TRANSIENT,
                            SQLITE_UTF8));
}

void SqliteStatement::Bind(int parameter, std::span<const std::byte> blob) {
  Check(sqlite3_bind_blob64(statement_, parameter, blob.data(), blob.size(), SQLITE_STATIC));
}

void SqliteStatement::BindNull(int parameter) { Check(sqlite3_bind_null(statement_, parameter)); }

bool SqliteStatement::Step() {
  const int result = sqlite3_step(statement_);
  if (result == SQLITE_ROW) return true;
  if (result == SQLITE_DONE) return false;
  throw SqliteError(Cause(connection_, result));
}

void SqliteStatement::Execute() {
  try {
    Step();
  } catch (const SqliteError&) {
    Reset();
    throw;
  }
  Reset();
}

void SqliteStatement::Reset() {
  sqlite3_reset(statement_);  // returns the error of the last Step again, which was already thrown
  sqlite3_clear_bindings(statement_);
}

std::int64_t SqliteStatement::Integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

double SqliteStatement::Real(int column) const {
  if (IsNull(column)) return std::numeric_limits<double>::quiet_NaN();
  return sqlite3_column_double(statement_, column);
}

std::string SqliteStatement::Text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_, column);
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

SqliteType SqliteStatement::Type(int column) const {
  return static_cast<SqliteType>(sqlite3_column_type(statement_, column));
}

int SqliteStatement::Columns() const { return sqlite3_column_count(statement_); }

std::span<const std::byte> SqliteStatement::Blob(int column) const {
  const void* bytes = sqlite3_column_blob(statement_, column);
  return {
      static_cast<const std::byte*>(bytes),
      bytes == nullptr ? 0 : static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

SqliteDb SqliteDb::Open(const std::string& name, int flags) {
  sqlite3* connection = nullptr;
  const int result = sqlite3_open_v2(name.c_str(), &connection, flags, nullptr);
  SqliteDb db(connection);  // closes also after an error
  if (result != SQLITE_OK) throw SqliteError(Cause(connection, result));
  sqlite3_extended_result_codes(connection, 1);
  sqlite3_busy_timeout(connection, 2000);
  return db;
}

SqliteDb SqliteDb::CreateNew(const std::filesystem::path& file) {
  // SQLite cannot create exclusively, so the file is created first: a run is never overwritten.
  const int descriptor = ::open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0644);
  if (descriptor < 0) throw SqliteError(std::strerror(errno));
  ::close(descriptor);
  return Open(file.string(), SQLITE_OPEN_READWRITE);
}

SqliteDb SqliteDb::OpenOrCreate(const std::filesystem::path& file) {
  return Open(file.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
}

SqliteDb SqliteDb::InMemory() {
  return Open(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
}

SqliteDb SqliteDb::OpenReadOnly(const std::filesystem::path& file, bool immutable) {
  return Open(Uri(file) + (immutable ? "?immutable=1" : ""),
              SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
}

void SqliteDb::Distrust(int largest_value) {
  constexpr std::array kLimits = {
      std::pair{SQLITE_LIMIT_SQL_LENGTH, 20'000}, std::pair{SQLITE_LIMIT_COLUMN, 200},
      std::pair{SQLITE_LIMIT_VDBE_OP, 5'000},     std::pair{SQLITE_LIMIT_EXPR_DEPTH, 20},
      std::pair{SQLITE_LIMIT_COMPOUND_SELECT, 2}, std::pair{SQLITE_LIMIT_FUNCTION_ARG, 8},
      std::pair{SQLITE_LIMIT_ATTACHED, 0},        std::pair{SQLITE_LIMIT_TRIGGER_DEPTH, 1},
      std::pair{SQLITE_LIMIT_WORKER_THREADS, 0},
  };
  sqlite3_limit(connection_, SQLITE_LIMIT_LENGTH, largest_value);
  for (const auto& [limit, value] : kLimits) sqlite3_limit(connection_, limit, value);
  for (const int off :
       {SQLITE_DBCONFIG_TRUSTED_SCHEMA, SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_ENABLE_VIEW,
        SQLITE_DBCONFIG_DQS_DDL, SQLITE_DBCONFIG_DQS_DML}) {
    sqlite3_db_config(connection_, off, 0, nullptr);
  }
  sqlite3_db_config(connection_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  Execute("PRAGMA cell_size_check=ON");
}

SqliteDb::~SqliteDb() { Close(); }

SqliteDb::SqliteDb(SqliteDb&& other) noexcept
    : connection_(std::exchange(other.connection_, nullptr)) {}

SqliteDb& SqliteDb::operator=(SqliteDb&& other) noexcept {
  std::swap(connection_, other.connection_);
  return *this;
}

void SqliteDb::Execute(const char* sql) {
  const int result = sqlite3_exec(connection_, sql, nullptr, nullptr, nullptr);
  if (result != SQLITE_OK) throw SqliteError(Cause(connection_, result));
}

SqliteStatement SqliteDb::Prepare(std::string_view sql) {
  return SqliteStatement(connection_, sql);
}

std::int64_t SqliteDb::QueryInteger(std::string_view sql) {
  SqliteStatement statement = Prepare(sql);
  return statement.Step() ? statement.Integer(0) : 0;
}

void SqliteDb::Close() {
  sqlite3_close_v2(
      std::exchange(connection_, nullptr));  // deferred by SQLite until all statements are closed
}

}  // namespace flexarm
