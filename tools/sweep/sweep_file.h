#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "controller/runlog/sqlite_db.h"
#include "tools/sweep/sweep_grid.h"
#include "tools/sweep/sweep_row.h"

namespace flexarm {

/// The identity of a sweep: a point has the same result in two sweeps of the same identity.
struct SweepIdentity {
  std::string build;  ///< BuildId()
  std::string config_text;
  std::string experiment_name;
  std::string experiment_text;
  std::vector<SweepAxis> axes;
};

/// Describes the difference for the user; empty if they are the same sweep.
std::string DifferenceOf(const SweepIdentity& held, const SweepIdentity& asked);

/// Results of a sweep, one SQLite file (docs/sweep.md has the schema). Every row is on disk when
/// Add returns; a process that is killed at any instant leaves a file that opens.
///
/// All but DifferenceOf throw InputError, with the file and the cause, if the file is not such a
/// file or cannot be read or written. One thread at a time.
class SweepFile {
 public:
  /// Opens or creates the file. Refuses the file of another sweep and names the difference.
  static SweepFile Resume(const std::filesystem::path& file, const SweepIdentity& identity);
  static SweepFile Open(const std::filesystem::path& file);

  const std::filesystem::path& path() const { return path_; }
  const SweepIdentity& identity() const { return identity_; }
  const SweepGrid& grid() const { return grid_; }

  /// In order of the points.
  std::vector<SweepRow> Rows();
  /// Adds a result; a point that the file already has is not changed.
  void Add(const SweepRow& row);
  /// Adds all results in one transaction.
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
