#pragma once

#include <cstddef>
#include <string_view>

namespace flexarm {

/// Length in bytes of the UTF-8 character at the start of `text`: 1 to 4; 0 if the bytes there are
/// none (RFC 3629: overlong forms, surrogates and values beyond U+10FFFF are none), or if `text` is
/// empty.
/// Real-time: safe.  Thread: any.
std::size_t Utf8Length(std::string_view text);

}  // namespace flexarm
