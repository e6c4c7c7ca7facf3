#include "tools/analysis/statement.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace flexarm {
namespace {

// A cell of a Markdown table.
std::string Cell(const std::string& text) {
  std::string cell;
  for (const char c : text) cell += c == '|' ? std::string("\\|") : std::string(1, c);
  return cell;
}

}  // namespace

Statement NotForThisRig(const std::string& section, const std::string& thesis,
                        const std::string& lacks) {
  return {section, thesis, "not for this rig: " + lacks, Verdict::kNotTested};
}

const char* ToString(Verdict verdict) {
  switch (verdict) {
    case Verdict::kHolds:
      return "holds";
    case Verdict::kInPart:
      return "holds in part";
    case Verdict::kDepends:
      return "depends on the excitation";
    case Verdict::kDoesNot:
      return "does not hold";
    case Verdict::kNotTested:
      return "not testable";
  }
  return "";
}

std::string Figure(double value, int digits) {
  if (!std::isfinite(value)) return "no finite number";
  std::ostringstream text;
  const double magnitude = value == 0.0 ? 0.0 : std::floor(std::log10(std::abs(value)));
  if (magnitude < -4.0 || magnitude >= 6.0) {
    text << std::scientific << std::setprecision(digits - 1) << value;
  } else {
    const int decimals = digits - 1 - static_cast<int>(magnitude);
    text << std::fixed << std::setprecision(decimals > 0 ? decimals : 0) << value;
  }
  return text.str();
}

std::string Count(std::ptrdiff_t number) { return std::to_string(number); }

std::string Counted(const std::vector<Statement>& statements) {
  std::string text;
  for (const Verdict verdict : {Verdict::kHolds, Verdict::kInPart, Verdict::kDepends,
                                Verdict::kDoesNot, Verdict::kNotTested}) {
    const auto count =
        std::count_if(statements.begin(), statements.end(),
                      [verdict](const Statement& s) { return s.verdict == verdict; });
    text +=
        (text.empty() ? "" : ", ") + std::string(ToString(verdict)) + ": " + std::to_string(count);
  }
  return text;
}

nlohmann::ordered_json StatementsJson(const std::vector<Statement>& statements) {
  nlohmann::ordered_json json{{"statements", nlohmann::ordered_json::array()}};
  for (const Statement& s : statements) {
    json["statements"].push_back({{"section", s.section},
                                  {"thesis", s.thesis},
                                  {"model", s.model},
                                  {"verdict", ToString(s.verdict)}});
  }
  return json;
}

std::string StatementTable(const std::vector<Statement>& statements) {
  std::string table =
      "| section | the thesis says | the model says | verdict |\n|---|---|---|---|\n";
  for (const Statement& s : statements) {
    table += "| " + s.section + " | " + Cell(s.thesis) + " | " + Cell(s.model) + " | " +
             ToString(s.verdict) + " |\n";
  }
  return table;
}

}  // namespace flexarm
