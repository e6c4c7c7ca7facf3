#pragma once

#include <string>
#include <string_view>

// UTF-8 text in the columns of a terminal: a Chinese sign takes two, an accent that is put on the
// sign before it takes none. The tables are those of the C library's locale C.UTF-8, whatever
// locale the program runs in. Bytes that are no UTF-8 count as one column each. Pure functions.

namespace flexarm {

/// Columns that a text without control characters takes.
int DisplayWidth(std::string_view text);

/// The longest beginning of the text that takes at most so many columns: no sign is cut.
std::string Clipped(std::string_view text, int columns);

/// The same text for a terminal that knows ASCII only: a '?' a column for every other sign.
std::string InAscii(std::string_view text);

}  // namespace flexarm
