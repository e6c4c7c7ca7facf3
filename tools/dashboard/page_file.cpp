#include "tools/dashboard/page_file.h"

#include <algorithm>
#include <array>

#include "page_files_generated.h"

namespace flexarm {

const PageFile* FindPageFile(std::string_view path) noexcept {
  const auto* found = std::find_if(kPageFiles.begin(), kPageFiles.end(),
                                   [path](const PageFile& file) { return file.path == path; });
  return found == kPageFiles.end() ? nullptr : &*found;
}

}  // namespace flexarm
