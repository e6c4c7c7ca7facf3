#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace flexarm {

inline constexpr std::size_t kShownBytes = 60;       ///< of a name or a cell in a message
inline constexpr std::size_t kMessageBytes = 4'096;  ///< of a line of a message

/// Text that flexarm did not write, as it may stand in a message, a table or a journal: printable
/// UTF-8 on one line.
///
/// Control characters (also those of U+0080 to U+009F, the direction marks of U+202A to U+202E and
/// U+2066 to U+2069, and the line ends U+2028 and U+2029) and bytes that are no UTF-8 become \xNN;
/// a tab becomes \t and a line end \n. A longer text is cut, and "..." follows.
/// @param most_bytes  of the result, without the "..."
/// Not real-time safe: allocates.  Thread: any.
std::string Shown(std::string_view text, std::size_t most_bytes = kShownBytes);

/// A whole message that may quote such text: the same for each of its lines, whose ends stay.
std::string ShownMessage(std::string_view message);

}  // namespace flexarm
