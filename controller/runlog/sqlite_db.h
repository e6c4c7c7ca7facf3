#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace flexarm {

/// An error of SQLite. what() has the cause only; callers add the file.
class SqliteError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The type of one value, in SQLite's numbers.
enum class SqliteType { kInteger = 1, kReal = 2, kText = 3, kBlob = 4, kNull = 5 };

/// One prepared statement. Columns and parameters count as in SQLite: parameters from 1, columns
/// from 0. A NaN is stored as NULL and read back as NaN.
class SqliteStatement {
 public:
  SqliteStatement() = default;
  SqliteStatement(sqlite3* connection, std::string_view sql);
  ~SqliteStatement();
  SqliteStatement(SqliteStatement&& other) noexcept;
  SqliteStatement& operator=(SqliteStatement&& other) noexcept;
  SqliteStatement(const SqliteStatement&) = delete;
  SqliteStatement& operator=(const SqliteStatement&) = delete;

  void Bind(int parameter, std::int64_t value);
  void Bind(int parameter, double value);
  void Bind(int parameter, std::string_view text);
  /// The bytes must live until the next Reset.
  void Bind(int parameter, std::span<const std::byte> blob);
  void BindNull(int parameter);

  /// @returns true if there is a row, false at the end
  bool Step();
  /// Steps a statement that returns nothing, and makes it ready for the next parameters.
  void Execute();
  void Reset();

  std::int64_t Integer(int column) const;
  double Real(int column) const;  ///< NaN for NULL
  std::string Text(int column) const;
  SqliteType Type(int column) const;
  bool IsNull(int column) const { return Type(column) == SqliteType::kNull; }
  int Columns() const;
  /// Also the bytes of a text. Valid until the next Step or Reset.
  std::span<const std::byte> Blob(int column) const;

 private:
  void Check(int result) const;

  sqlite3* connection_ = nullptr;
  sqlite3_stmt* statement_ = nullptr;
};

/// One connection to a SQLite file.
class SqliteDb {
 public:
  SqliteDb() = default;
  /// Creates a new file. @throws SqliteError, also if the file exists
  static SqliteDb CreateNew(const std::filesystem::path& file);
  /// Opens a file for reading and writing; creates an empty one if there is none.
  static SqliteDb OpenOrCreate(const std::filesystem::path& file);
  static SqliteDb InMemory();
  /// @param immutable  the file does not change: no lock and no -shm file needed
  static SqliteDb OpenReadOnly(const std::filesystem::path& file, bool immutable);
  ~SqliteDb();
  SqliteDb(SqliteDb&& other) noexcept;
  SqliteDb& operator=(SqliteDb&& other) noexcept;
  SqliteDb(const SqliteDb&) = delete;
  SqliteDb& operator=(const SqliteDb&) = delete;

  /// Prepares a file of unknown origin: limits on sizes and statements, no code of its schema runs,
  /// and pages are checked when they are read.
  /// @param largest_value  bytes of a text, a blob and a row
  void Distrust(int largest_value);

  bool is_open() const { return connection_ != nullptr; }
  void Execute(const char* sql);
  SqliteStatement Prepare(std::string_view sql);
  std::int64_t QueryInteger(std::string_view sql);
  void Close();

 private:
  explicit SqliteDb(sqlite3* connection) : connection_(connection) {}
  static SqliteDb Open(const std::string& name, int flags);

  sqlite3* connection_ = nullptr;
};

}  // namespace flexarm
