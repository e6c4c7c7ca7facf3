#pragma once

#include <functional>
#include <string>

namespace flexarm {

/// Writes one line to the text log of the daemon (controller/host/journal.h). May wait for a lock.
using JournalReport = std::function<void(bool is_error, const std::string& text)>;

}  // namespace flexarm
