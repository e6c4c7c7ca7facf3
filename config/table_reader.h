#pragma once

#include <toml++/toml.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "config/problem_log.h"

namespace flexarm {

/// A value of an enumeration (or of an int that stands for one) and its text in a file.
template <typename E>
struct NamedValue {
  std::string_view name;
  E value;
};

/// Reads one table of a document, key by key, into plain fields.
///
/// Each call names a key that the table may have. What is missing, mistyped or not finite goes into
/// the log, and a number that could not be read becomes NaN or stays as it was: rules about it are
/// not asked. A reader of a table that is not there reads nothing and says nothing.
class TableReader {
 public:
  TableReader(const toml::table* table, std::string path, ProblemLog* log);

  // Required keys.
  void Read(std::string_view key, double* out);
  void Read(std::string_view key, int* out);
  void Read(std::string_view key, std::uint64_t* out);  // 0 and above
  void Read(std::string_view key, bool* out);
  void Read(std::string_view key, std::string* out);
  template <std::size_t n>
  void Read(std::string_view key, std::array<double, n>* out) {
    ReadNumbers(key, out->data(), n);
  }
  void Read(std::string_view key, std::vector<double>* out);  // however many
  template <typename E>
  void Read(std::string_view key, E* out, const std::vector<NamedValue<E>>& values);
  template <typename E>
  void Read(std::string_view key, E* out, std::initializer_list<NamedValue<E>> values) {
    Read(key, out, std::vector<NamedValue<E>>(values));
  }

  /// False if the table has no such key, which then is not missing either.
  bool Has(std::string_view key);
  /// Reports the value of a key that is there: it breaks `rule`.
  void Refuse(std::string_view key, std::string rule);

  /// The table below `key`; one that is not there is reported once, as a whole.
  TableReader Table(std::string_view key);
  /// The rows [[key]]; none if there are none.
  std::vector<TableReader> OptionalRows(std::string_view key);
  std::vector<TableReader> Rows(std::string_view key);

 private:
  const toml::node* Find(std::string_view key, std::string_view wanted);
  void ReadNumbers(std::string_view key, double* out, std::size_t count);
  void Mistyped(std::string_view key, const toml::node& node, std::string_view wanted);
  std::string Key(std::string_view key) const { return JoinKey(path_, key); }

  const toml::table* table_;  // null: not there
  std::string path_;
  ProblemLog* log_;
};

template <typename E>
void TableReader::Read(std::string_view key, E* out, const std::vector<NamedValue<E>>& values) {
  std::string wanted = "one of";
  for (const NamedValue<E>& v : values) wanted += " \"" + std::string(v.name) + "\"";
  const toml::node* node = Find(key, wanted);
  if (node == nullptr) return;
  const auto* text = node->as_string();
  for (const NamedValue<E>& v : values) {
    if (text == nullptr || text->get() != v.name) continue;
    *out = v.value;
    return;
  }
  Mistyped(key, *node, wanted);
}

}  // namespace flexarm
