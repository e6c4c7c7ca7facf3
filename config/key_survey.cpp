#include "config/key_survey.h"

#include <algorithm>

namespace flexarm {
namespace {

constexpr int kFarWhole = 999'999'999;  // about the largest that a TableReader accepts

bool IsAbove(const std::string& table, const std::string& key) {
  return key.size() > table.size() && key.starts_with(table) &&
         (key[table.size()] == '.' || key[table.size()] == '[');
}

}  // namespace

std::string KeySurvey::Pattern(std::string_view path) {
  std::string pattern;
  bool in_index = false;
  for (const char c : path) {
    if (c == ']') in_index = false;
    if (!in_index) pattern += c;
    if (c == '[') in_index = true;
  }
  return pattern;
}

void KeySurvey::Run(const std::function<void(KeySurvey*)>& read) {
  for (std::size_t choice = 0; choice < most_choices_; ++choice) {
    for (const int sign : {1, -1}) {
      sign_ = sign;
      Pass(read, Answer::kAll, choice);
    }
  }
  Pass(read, Answer::kNone, 0);
  // Grows while it is read, when a key is asked for in these passes only.
  std::size_t next = 0;
  while (next < asked_.size()) {
    only_ = asked_[next++];
    Pass(read, Answer::kOnly, 0);
  }
  for (SurveyedKey& key : keys_) key.is_optional = Asked(key.path);
  for (SurveyedTable& table : tables_) {
    const bool has_rows = table.path.ends_with("[]");
    table.is_optional = Asked(table.path.substr(0, table.path.size() - (has_rows ? 2 : 0)));
  }
}

void KeySurvey::Pass(const std::function<void(KeySurvey*)>& read, Answer answer,
                     std::size_t choice) {
  answer_ = answer;
  choice_ = choice;
  for (const bool second : {false, true}) {
    second_ = second;
    whole_ = second ? kFarWhole - 10'000 : kFarWhole;
    last_table_ = last_key_ = 0;
    read(this);
  }
}

bool KeySurvey::Asked(const std::string& pattern) const {
  return std::find(asked_.begin(), asked_.end(), pattern) != asked_.end();
}

// The row of a path. A new one follows the row that was reported before it, so that the order is
// that of the reading.
template <typename Row>
Row* KeySurvey::Placed(std::vector<Row>* rows, std::size_t* last, const std::string& path) {
  const std::string pattern = Pattern(path);
  const auto found =
      std::find_if(rows->begin(), rows->end(), [&](const Row& row) { return row.path == pattern; });
  const bool is_new = found == rows->end();
  const auto at =
      is_new ? std::min(*last, rows->size()) : static_cast<std::size_t>(found - rows->begin());
  *last = at + 1;
  if (!is_new) return &(*rows)[at];
  Row row{};
  row.path = pattern;
  return &*rows->insert(rows->begin() + static_cast<std::ptrdiff_t>(at), row);
}

void KeySurvey::AddTable(const std::string& path, const Meaning& meaning) {
  Placed(&tables_, &last_table_, path)->meaning = meaning.text;
}

void KeySurvey::AddKey(const std::string& path, std::string_view wanted, const Meaning& meaning) {
  SurveyedKey* row = Placed(&keys_, &last_key_, path);
  row->wanted = wanted;
  row->meaning = meaning.text;
  row->unit = meaning.unit;
}

void KeySurvey::SetDefault(const std::string& path, std::string value) {
  const std::string pattern = Pattern(path);
  const auto row = std::find_if(keys_.begin(), keys_.end(),
                                [&](const SurveyedKey& key) { return key.path == pattern; });
  if (row != keys_.end()) row->without = std::move(value);
}

bool KeySurvey::Gives(const std::string& path) {
  const std::string pattern = Pattern(path);
  if (!Asked(pattern)) asked_.push_back(pattern);
  return answer_ == Answer::kAll ||
         (answer_ == Answer::kOnly && (pattern == only_ || IsAbove(pattern, only_)));
}

std::size_t KeySurvey::Choice(std::size_t count) {
  most_choices_ = std::max(most_choices_, count);
  return choice_ % count;
}

}  // namespace flexarm
