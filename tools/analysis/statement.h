#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace flexarm {

/// Whether a statement of the thesis comes out of the model.
enum class Verdict : std::uint8_t {
  kHolds,
  kInPart,   ///< some of what it says does
  kDepends,  ///< on how strongly the arm is excited, which the thesis does not say
  kDoesNot,
  kNotTested,  ///< nothing to compare with
};

/// One statement, in our words, and what the model says to it. Every number in `model` is computed.
struct Statement {
  std::string section;  ///< of the thesis
  std::string thesis;
  std::string model;
  Verdict verdict;
};

/// "holds", "holds in part", "depends on the excitation", "does not hold", "not testable".
const char* Name(Verdict verdict);

/// A number with so many significant digits, without an exponent if that is short: "8.76", "0.023".
std::string Figure(double value, int digits = 3);

/// A whole number as text.
std::string Count(std::ptrdiff_t number);

/// How many statements have each verdict: "holds: 40, holds in part: 3, ..", all verdicts.
std::string Counted(const std::vector<Statement>& statements);

/// An object a statement: section, thesis, model, verdict.
nlohmann::ordered_json StatementsJson(const std::vector<Statement>& statements);

/// The statements as a table in Markdown.
std::string StatementTable(const std::vector<Statement>& statements);

}  // namespace flexarm
