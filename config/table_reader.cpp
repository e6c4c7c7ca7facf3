#include "config/table_reader.h"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr double kUnread = std::numeric_limits<double>::quiet_NaN();

// The value of a number, whole numbers included. Empty for inf and nan, which no key accepts.
std::optional<double> FiniteNumber(const toml::node& node) {
  const auto value = node.value<double>();
  const bool number = node.is_number() && value && std::isfinite(*value);
  return number ? value : std::nullopt;
}

std::string Numbers(std::size_t count) {
  return "an array of " + NumberText(count) + " finite numbers";
}

}  // namespace

TableReader::TableReader(const toml::table* table, std::string path, ProblemLog* log)
    : table_(table), path_(std::move(path)), log_(log) {}

TableReader::TableReader(KeySurvey* survey, std::string path, ProblemLog* log)
    : table_(nullptr), path_(std::move(path)), log_(log), survey_(survey) {}

bool TableReader::Surveyed(std::string_view key, std::string_view wanted, const Meaning& meaning) {
  if (survey_ == nullptr) return false;
  survey_->AddKey(Key(key), wanted, meaning);
  return true;
}

void TableReader::SurveyDefault(std::string_view key, const std::string& without) {
  if (survey_ != nullptr) survey_->SetDefault(Key(key), without);
}

std::string TableReader::DefaultText(double value) { return NumberText(value); }
std::string TableReader::DefaultText(bool value) { return value ? "true" : "false"; }
std::string TableReader::DefaultText(const std::string& value) {
  return value.empty() ? "" : "\"" + value + "\"";
}
std::string TableReader::DefaultText(const std::vector<double>& value) {
  std::string text;
  for (const double number : value) text += (text.empty() ? "[" : ", ") + NumberText(number);
  return text.empty() ? "" : text + "]";
}

void TableReader::Read(std::string_view key, double* out, const Meaning& meaning) {
  constexpr std::string_view kWanted = "a finite number";
  *out = kUnread;
  if (Surveyed(key, kWanted, meaning)) return;
  const toml::node* node = Find(key, kWanted);
  if (node == nullptr) return;
  const std::optional<double> number = FiniteNumber(*node);
  if (number) {
    *out = *number;
  } else {
    Mistyped(key, *node, kWanted);
  }
}

void TableReader::Read(std::string_view key, int* out, const Meaning& meaning) {
  constexpr std::string_view kWanted = "a whole number of at most 9 digits";
  constexpr std::int64_t kLargest = 999'999'999;
  if (Surveyed(key, kWanted, meaning)) {
    *out = survey_->whole_number();
    return;
  }
  const toml::node* node = Find(key, kWanted);
  if (node == nullptr) return;
  const auto* number = node->as_integer();
  if (number != nullptr && number->get() >= -kLargest && number->get() <= kLargest) {
    *out = static_cast<int>(number->get());
  } else {
    Mistyped(key, *node, kWanted);
  }
}

void TableReader::Read(std::string_view key, std::uint64_t* out, const Meaning& meaning) {
  constexpr std::string_view kWanted = "a whole number, 0 or above";
  if (Surveyed(key, kWanted, meaning)) return;
  const toml::node* node = Find(key, kWanted);
  if (node == nullptr) return;
  const auto* number = node->as_integer();
  if (number != nullptr && number->get() >= 0) {
    *out = static_cast<std::uint64_t>(number->get());
  } else {
    Mistyped(key, *node, kWanted);
  }
}

void TableReader::Read(std::string_view key, bool* out, const Meaning& meaning) {
  if (Surveyed(key, "true or false", meaning)) return;
  const toml::node* node = Find(key, "true or false");
  if (node == nullptr) return;
  if (const auto* flag = node->as_boolean()) {
    *out = flag->get();
  } else {
    Mistyped(key, *node, "true or false");
  }
}

void TableReader::Read(std::string_view key, std::string* out, const Meaning& meaning) {
  if (Surveyed(key, "a string", meaning)) return;
  const toml::node* node = Find(key, "a string");
  if (node == nullptr) return;
  if (const auto* text = node->as_string()) {
    *out = text->get();
  } else {
    Mistyped(key, *node, "a string");
  }
}

bool TableReader::Has(std::string_view key) {
  if (survey_ != nullptr) return survey_->Gives(Key(key));
  log_->Know(path_, key);
  return table_ != nullptr && table_->contains(key);
}

void TableReader::Missing(std::string_view key, std::string_view wanted) {
  if (table_ != nullptr) log_->AddMissing(path_, key, wanted);
}

void TableReader::Refuse(std::string_view key, std::string rule) {
  const toml::node* node = table_ != nullptr ? table_->get(key) : nullptr;
  if (node != nullptr) log_->Add(Key(key), *node, std::move(rule));
}

TableReader TableReader::Table(std::string_view key, const Meaning& meaning) {
  if (survey_ != nullptr) {
    survey_->AddTable(Key(key), meaning);
    return {survey_, Key(key), log_};
  }
  const std::string wanted = "a table, [" + Key(key) + "]";
  const toml::node* node = Find(key, wanted);
  const toml::table* table = node != nullptr ? node->as_table() : nullptr;
  if (node != nullptr && table == nullptr) Mistyped(key, *node, wanted);
  return {table, Key(key), log_};
}

std::vector<TableReader> TableReader::OptionalRows(std::string_view key, const Meaning& meaning) {
  return Has(key) ? Rows(key, meaning) : std::vector<TableReader>{};
}

std::vector<TableReader> TableReader::Rows(std::string_view key, const Meaning& meaning) {
  if (survey_ != nullptr) {
    std::vector<TableReader> rows;
    for (std::size_t i = 0; i < survey_->row_count(); ++i) {
      const std::string row = ProblemList::Element(Key(key), i);
      survey_->AddTable(row, meaning);
      rows.push_back(TableReader(survey_, row, log_));
    }
    return rows;
  }
  const std::string wanted = "rows, each [[" + Key(key) + "]]";
  const toml::node* node = Find(key, wanted);
  if (node == nullptr) return {};
  const toml::array* array = node->as_array();
  if (array == nullptr || !(array->empty() || array->is_homogeneous(toml::node_type::table))) {
    Mistyped(key, *node, wanted);
    return {};
  }
  std::vector<TableReader> rows;
  for (std::size_t i = 0; i < array->size(); ++i) {
    rows.emplace_back(array->get(i)->as_table(), ProblemList::Element(Key(key), i), log_);
  }
  return rows;
}

const toml::node* TableReader::Find(std::string_view key, std::string_view wanted) {
  if (table_ == nullptr) return nullptr;
  log_->Know(path_, key);
  const toml::node* node = table_->get(key);
  if (node == nullptr) log_->AddMissing(path_, key, wanted);
  return node;
}

void TableReader::ReadNumbers(std::string_view key, double* out, std::size_t count,
                              const Meaning& meaning) {
  for (std::size_t i = 0; i < count; ++i) out[i] = kUnread;
  if (Surveyed(key, Numbers(count), meaning)) return;
  const toml::node* node = Find(key, Numbers(count));
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != count) return Mistyped(key, *node, Numbers(count));
  for (std::size_t i = 0; i < count; ++i) {
    const toml::node& element = *array->get(i);
    const std::optional<double> number = FiniteNumber(element);
    if (number) {
      out[i] = *number;
    } else {
      Mistyped(ProblemList::Element(key, i), element, "a finite number");
    }
  }
}

void TableReader::Read(std::string_view key, std::vector<double>* out, const Meaning& meaning) {
  constexpr std::string_view kWanted = "an array of finite numbers";
  if (Surveyed(key, kWanted, meaning)) {
    out->assign(2, kUnread);  // the first element may have a rule of its own
    return;
  }
  const toml::node* node = Find(key, kWanted);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->empty()) return Mistyped(key, *node, kWanted);
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::node& element = *array->get(i);
    const std::optional<double> number = FiniteNumber(element);
    if (!number) Mistyped(ProblemList::Element(key, i), element, "a finite number");
    out->push_back(number.value_or(kUnread));
  }
}

void TableReader::Read(std::string_view key, std::vector<std::string>* out,
                       const Meaning& meaning) {
  constexpr std::string_view kWanted = "an array of strings";
  if (Surveyed(key, kWanted, meaning)) return;
  const toml::node* node = Find(key, kWanted);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->empty()) return Mistyped(key, *node, kWanted);
  for (std::size_t i = 0; i < array->size(); ++i) {
    const auto* text = array->get(i)->as_string();
    if (text == nullptr) return Mistyped(key, *node, kWanted);
    out->push_back(text->get());
  }
}

void TableReader::Mistyped(std::string_view key, const toml::node& node, std::string_view wanted) {
  log_->Add(Key(key), node, "must be " + std::string(wanted));
}

}  // namespace flexarm
