#pragma once

#include <span>
#include <string_view>

namespace flexarm {

/// What a check of a design means, and which config keys change its value in which direction.
struct CheckExplanation {
  std::string_view name;     ///< DesignCheck::name
  std::string_view meaning;  ///< what its value is, and what a failure says
  std::string_view remedy;   ///< keys, and whether to raise or to lower them
};

/// One row for every check that a design can have; docs/design-checks.md shows this table.
std::span<const CheckExplanation> CheckExplanations();

/// The row of a check. @return null if there is none, as for a check of a foreign gains file
const CheckExplanation* ExplanationOf(std::string_view check_name);

}  // namespace flexarm
