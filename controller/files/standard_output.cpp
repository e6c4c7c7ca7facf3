#include "controller/files/standard_output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

namespace flexarm {

std::string FlushStandardOutput() {
  errno = 0;
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  const int error = errno;
  if (flushed && std::cout && std::ferror(stdout) == 0) return {};
  // Unknown where an earlier write failed, before the last flush.
  const std::string cause = error == 0 ? std::string() : std::string(": ") + std::strerror(error);
  return "standard output cannot be written" + cause;
}

}  // namespace flexarm
