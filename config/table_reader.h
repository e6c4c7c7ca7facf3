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

/// A value of an enumeration (or of an int used as one) and its text in a file.
template <typename E>
struct NamedValue {
  std::string_view name;
  E value;
};

/// Reads one table of a document, key by key, into plain fields.
///
/// Each call declares a key that the table may have. A value that is missing, mistyped or not
/// finite is reported in the log, and a number that could not be read becomes NaN or keeps its
/// value: rules about it are not checked. A reader for a missing table is a no-op.
class TableReader {
 public:
  TableReader(const toml::table* table, std::string path, ProblemLog* log);

  // Read a required key.
  void Read(std::string_view key, double* out);
  void Read(std::string_view key, int* out);
  void Read(std::string_view key, std::uint64_t* out);  // 0 and above
  void Read(std::string_view key, bool* out);
  void Read(std::string_view key, std::string* out);
  template <std::size_t n>
  void Read(std::string_view key, std::array<double, n>* out) {
    ReadNumbers(key, out->data(), n);
  }
  void Read(std::string_view key, std::vector<double>* out);       // any number of elements
  void Read(std::string_view key, std::vector<std::string>* out);  // the same
  template <typename E>
  void Read(std::string_view key, E* out, const std::vector<NamedValue<E>>& values);
  template <typename E>
  void Read(std::string_view key, E* out, std::initializer_list<NamedValue<E>> values) {
    Read(key, out, std::vector<NamedValue<E>>(values));
  }

  /// True if the table has the key; if not, the key is not reported as missing.
  bool Has(std::string_view key);
  /// Reports that the key is missing, with what it should have; nothing if the table is missing.
  void Missing(std::string_view key, std::string_view wanted);
  /// Reports that the value of an existing key violates `rule`.
  void Refuse(std::string_view key, std::string rule);

  /// The table below `key`; a missing table is reported once, as a whole.
  TableReader Table(std::string_view key);
  /// The rows [[key]]; empty if the table has none.
  std::vector<TableReader> OptionalRows(std::string_view key);
  std::vector<TableReader> Rows(std::string_view key);

 private:
  const toml::node* Find(std::string_view key, std::string_view wanted);
  void ReadNumbers(std::string_view key, double* out, std::size_t count);
  void Mistyped(std::string_view key, const toml::node& node, std::string_view wanted);
  std::string Key(std::string_view key) const { return JoinKey(path_, key); }

  const toml::table* table_;  // null: the table is missing
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
