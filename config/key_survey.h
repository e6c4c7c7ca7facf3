#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "config/meaning.h"

namespace flexarm {

/// A table or an array of tables that a reader knows, with its keys.
struct SurveyedTable {
  std::string path;     ///< "hal.canopen[].node[]"; "" for the keys outside of all tables
  std::string meaning;  ///< "" for the root and for tables that are only a part of others' names
  bool is_optional = false;  ///< the table may be left out
};

/// A key that a reader knows.
struct SurveyedKey {
  std::string path;    ///< "sensors.strain[].position_m"
  std::string wanted;  ///< its type, as in messages: "a finite number"
  std::string meaning;
  std::string unit;          ///< as stated with the meaning
  bool is_optional = false;  ///< the reader asks whether the key is there
  std::string without;       ///< the value that holds without an optional key; "" if there is none
};

/// Lists the tables and keys that a reader would accept, by running it without a document: a
/// TableReader with a survey finds what the survey says and reports to it what it was asked for.
///
/// A pass answers "is this key there?" and "which word?" in one way. `Run` makes passes until every
/// branch that depends on one such answer was taken. Each pass is made twice, with other numbers
/// and another count of rows: what a rule says in both depends on no other value.
class KeySurvey {
 public:
  /// Runs `read` once for each pass.
  void Run(const std::function<void(KeySurvey*)>& read);

  const std::vector<SurveyedTable>& tables() const { return tables_; }
  const std::vector<SurveyedKey>& keys() const { return keys_; }

  // What a TableReader reports. Paths have numbered rows: "sensors.strain[0].face".
  void AddTable(const std::string& path, const Meaning& meaning);
  void AddKey(const std::string& path, std::string_view wanted, const Meaning& meaning);
  void SetDefault(const std::string& path, std::string value);

  // What a TableReader finds.
  bool Gives(const std::string& path);  ///< an optional key or table
  std::size_t row_count() const { return second_ ? 2 : 1; }
  std::size_t Choice(std::size_t count);  ///< of the words of a key, less than `count`
  /// Beyond the range of every whole number, and another one each time.
  int whole_number() { return sign_ * (whole_ -= 1); }

  /// The pass repeats the one before it.
  bool second() const { return second_; }

  /// "sensors.strain[3].face" is "sensors.strain[].face".
  static std::string Pattern(std::string_view path);

 private:
  enum class Answer { kAll, kNone, kOnly };

  template <typename Row>
  Row* Placed(std::vector<Row>* rows, std::size_t* last, const std::string& path);
  void Pass(const std::function<void(KeySurvey*)>& read, Answer answer, std::size_t choice);
  bool Asked(const std::string& pattern) const;

  std::vector<SurveyedTable> tables_;
  std::vector<SurveyedKey> keys_;
  std::vector<std::string> asked_;  // patterns of optional keys
  std::size_t most_choices_ = 1;
  // Of the present pass.
  Answer answer_ = Answer::kAll;
  std::string only_;  // of kOnly: this key and the tables above it are there
  std::size_t choice_ = 0;
  int whole_ = 0, sign_ = 1;
  bool second_ = false;
  std::size_t last_table_ = 0, last_key_ = 0;  // after which a new row is placed
};

}  // namespace flexarm
