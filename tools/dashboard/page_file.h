#pragma once

#include <string_view>

namespace flexarm {

/// A file of the page, as it is embedded in the program.
struct PageFile {
  std::string_view path;  ///< of the URL: "/", "/main.js"
  std::string_view type;  ///< header Content-Type
  std::string_view text;
};

/// The file at a path of the URL; null: there is none.
const PageFile* FindPageFile(std::string_view path) noexcept;

}  // namespace flexarm
