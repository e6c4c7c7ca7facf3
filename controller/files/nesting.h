#pragma once

#include <string_view>

namespace flexarm {

/// Deepest nesting of any file that flexarm reads; its own have at most 6 levels.
inline constexpr int kDeepestNesting = 32;

/// First line of JSON text on which brackets are open more than kDeepestNesting deep; 0 if there is
/// none. Brackets in strings do not count. Parsers and destructors are recursive: this is asked
/// before any of them sees the text.
/// Thread: any.
int LineNestedTooDeepJson(std::string_view text);

/// The same for TOML. A dotted key nests as well: its parts are counted like brackets. Brackets and
/// dots in strings, comments and numbers do not count.
int LineNestedTooDeepToml(std::string_view text);

}  // namespace flexarm
