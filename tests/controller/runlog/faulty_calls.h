#pragma once

#include <cstddef>
#include <string_view>

namespace flexarm {

/// What a call that changes a file or a folder does in place of its own work.
struct CallFault {
  int error = 0;              ///< 0: none, the call is made
  bool halves_write = false;  ///< a write writes the first half, and the rest fails with `error`
};

/// Asked before every call of this program, and of the libraries in it, that changes a file or a
/// folder: open (to create), write, pwrite, ftruncate, fallocate, fsync, fdatasync, rename, link,
/// unlink. Null: all are made. A fork inherits it.
extern CallFault (*before_file_call)(std::string_view call, std::size_t bytes);

}  // namespace flexarm
