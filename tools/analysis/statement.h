#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace flexarm {

/// Result of checking a statement of the thesis against the model.
enum class Verdict : std::uint8_t {
  kHolds,
  kInPart,   ///< only a part of the statement holds
  kDepends,  ///< on the amplitude of the excitation, which the thesis does not state
  kDoesNot,
  kNotTested,  ///< there is nothing to compare it with
};

/// One statement of the thesis in our words, and the result of the model. Every number in `model`
/// is computed.
struct Statement {
  std::string section;  ///< of the thesis
  std::string thesis;
  std::string model;
  Verdict verdict;
};

/// A statement that cannot be asked about a rig: not testable, with what the rig lacks.
Statement NotForThisRig(const std::string& section, const std::string& thesis,
                        const std::string& lacks);

/// "holds", "holds in part", "depends on the excitation", "does not hold", "not testable".
const char* ToString(Verdict verdict);

/// A number with the given significant digits, without an exponent if that is short: "8.76",
/// "0.023".
std::string Figure(double value, int digits = 3);

/// A whole number as text.
std::string Count(std::ptrdiff_t number);

/// The number of statements with each verdict: "holds: 40, holds in part: 3, ..", for all verdicts.
std::string Counted(const std::vector<Statement>& statements);

/// One object per statement: section, thesis, model, verdict.
nlohmann::ordered_json StatementsJson(const std::vector<Statement>& statements);

/// The statements as a table in Markdown.
std::string StatementTable(const std::vector<Statement>& statements);

}  // namespace flexarm
