#pragma once

#include <optional>
#include <string>

#include "controller/runlog/sqlite_db.h"

namespace flexarm {

/// Watches that the keys of a table rise from row to row. In a damaged file the tree of a table can
/// lead back to rows that were read, without end.
template <typename Key>
class RowOrder {
 public:
  explicit RowOrder(const char* table) : table_(table) {}

  /// @throws SqliteError if `key` does not follow the one before
  void Next(const Key& key) {
    if (last_ && !(*last_ < key)) {
      throw SqliteError(std::string("rows of table ") + table_ + " out of order");
    }
    last_ = key;
  }

 private:
  const char* table_;
  std::optional<Key> last_;
};

}  // namespace flexarm
