#pragma once

#include <toml++/toml.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/key_survey.h"
#include "config/meaning.h"
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
/// Each call declares a key that the table may have, and says what it means: the config reference
/// lists what the calls declare (KeySurvey). A value that is missing, mistyped or not finite is
/// reported in the log, and a number that could not be read becomes NaN or keeps its value: rules
/// about it are not checked. A reader for a missing table is a no-op.
class TableReader {
 public:
  TableReader(const toml::table* table, std::string path, ProblemLog* log);
  /// Reads no document: reports to the survey what would be read. `log` gets nothing.
  TableReader(KeySurvey* survey, std::string path, ProblemLog* log);

  // Read a required key.
  void Read(std::string_view key, double* out, const Meaning& meaning);
  void Read(std::string_view key, int* out, const Meaning& meaning);
  void Read(std::string_view key, std::uint64_t* out, const Meaning& meaning);  // 0 and above
  void Read(std::string_view key, bool* out, const Meaning& meaning);
  void Read(std::string_view key, std::string* out, const Meaning& meaning);
  template <std::size_t n>
  void Read(std::string_view key, std::array<double, n>* out, const Meaning& meaning) {
    ReadNumbers(key, out->data(), n, meaning);
  }
  void Read(std::string_view key, std::vector<double>* out,
            const Meaning& meaning);  // any number of elements
  void Read(std::string_view key, std::vector<std::string>* out,
            const Meaning& meaning);  // the same
  template <typename E>
  void Read(std::string_view key, E* out, const std::vector<NamedValue<E>>& values,
            const Meaning& meaning);
  template <typename E>
  void Read(std::string_view key, E* out, std::initializer_list<NamedValue<E>> values,
            const Meaning& meaning) {
    Read(key, out, std::vector<NamedValue<E>>(values), meaning);
  }

  /// Read a key that may be left out: the field then keeps its value, which is the default.
  template <typename T>
  void ReadIfGiven(std::string_view key, T* out, const Meaning& meaning) {
    if (!Has(key)) return;
    const std::string without = survey_ != nullptr ? DefaultText(*out) : std::string();
    Read(key, out, meaning);
    SurveyDefault(key, without);
  }
  template <typename T>
  void ReadIfGiven(std::string_view key, std::optional<T>* out, const Meaning& meaning) {
    if (Has(key)) Read(key, &out->emplace(), meaning);
  }
  template <typename E>
  void ReadIfGiven(std::string_view key, E* out, std::initializer_list<NamedValue<E>> values,
                   const Meaning& meaning);

  /// True if the table has the key; if not, the key is not reported as missing.
  bool Has(std::string_view key);
  /// Reports that the key is missing, with what it should have; nothing if the table is missing.
  void Missing(std::string_view key, std::string_view wanted);
  /// Reports that the value of a key violates `rule`; nothing if the key is missing.
  void Refuse(std::string_view key, std::string rule);

  /// The table below `key`; a missing table is reported once, as a whole.
  TableReader Table(std::string_view key, const Meaning& meaning);
  /// The rows [[key]]; empty if the table has none.
  std::vector<TableReader> OptionalRows(std::string_view key, const Meaning& meaning);
  std::vector<TableReader> Rows(std::string_view key, const Meaning& meaning);

 private:
  const toml::node* Find(std::string_view key, std::string_view wanted);
  // True without a document: the key is reported to the survey.
  bool Surveyed(std::string_view key, std::string_view wanted, const Meaning& meaning);
  void SurveyDefault(std::string_view key, const std::string& without);
  static std::string DefaultText(double value);
  static std::string DefaultText(int value) { return std::to_string(value); }
  static std::string DefaultText(bool value);
  static std::string DefaultText(const std::string& value);
  static std::string DefaultText(const std::vector<double>& value);
  template <std::size_t n>
  static std::string DefaultText(const std::array<double, n>& value) {
    return DefaultText(std::vector<double>(value.begin(), value.end()));
  }
  void ReadNumbers(std::string_view key, double* out, std::size_t count, const Meaning& meaning);
  void Mistyped(std::string_view key, const toml::node& node, std::string_view wanted);
  std::string Key(std::string_view key) const { return JoinKey(path_, key); }

  const toml::table* table_;  // null: the table is missing
  std::string path_;
  ProblemLog* log_;
  KeySurvey* survey_ = nullptr;
};

template <typename E>
void TableReader::Read(std::string_view key, E* out, const std::vector<NamedValue<E>>& values,
                       const Meaning& meaning) {
  std::string wanted = "one of";
  for (const NamedValue<E>& v : values) wanted += " \"" + std::string(v.name) + "\"";
  if (Surveyed(key, wanted, meaning)) {
    *out = values[survey_->Choice(values.size())].value;
    return;
  }
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

template <typename E>
void TableReader::ReadIfGiven(std::string_view key, E* out,
                              std::initializer_list<NamedValue<E>> values, const Meaning& meaning) {
  if (!Has(key)) return;
  std::string without;
  for (const NamedValue<E>& v : values) {
    if (v.value == *out) without = DefaultText(std::string(v.name));
  }
  Read(key, out, values, meaning);
  SurveyDefault(key, without);
}

}  // namespace flexarm
