#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "controller/runlog/sqlite_db.h"
#include "tools/sweep/sweep_grid.h"
#include "tools/sweep/sweep_row.h"

namespace flexarm {

/// What makes two sweeps the same: then a point has the same result in both.
struct SweepIdentity {
  std::string build;  ///< BuildId()
  std::string config_text;
  std::string experiment_name;
  std::string experiment_text;
  std::vector<SweepAxis> axes;
};

/// What differs, in a user's words; empty if they are the same sweep.
std::string DifferenceOf(const SweepIdentity& held, const SweepIdentity& asked);

/// Results of a sweep, one SQLite file (docs/sweep.md has the schema). Every row is on the disk
/// when Add returns; a process killed at any instant leaves a file that opens.
///
/// All but DifferenceOf throw InputError, with the file and the cause, when the file is no such
/// file or cannot be read or written. One thread at a time.
class SweepFile {
 public:
  /// Opens the file, or makes it. Refuses that of another sweep, and says what differs.
  static SweepFile Resume(const std::filesystem::path& file, const SweepIdentity& identity);
  static SweepFile Open(const std::filesystem::path& file);

  const std::filesystem::path& path() const { return path_; }
  const SweepIdentity& identity() const { return identity_; }
  const SweepGrid& grid() const { return grid_; }

  /// In order of the points.
  std::vector<SweepRow> Rows();
  /// A point that is there already stays as it is.
  void Add(const SweepRow& row);
  /// All at once or not at all.
  void AddAll(const std::vector<SweepRow>& rows);

 private:
  SweepFile(std::filesystem::path path, SqliteDb db);
  void Create(const SweepIdentity& identity);
  void Load();
  void Insert(const SweepRow& row);

  std::filesystem::path path_;
  SqliteDb db_;
  SweepIdentity identity_;
  SweepGrid grid_;
};

}  // namespace flexarm
