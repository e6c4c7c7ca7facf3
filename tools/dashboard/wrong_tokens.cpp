#include "tools/dashboard/wrong_tokens.h"

#include <iostream>

namespace flexarm {
namespace {

constexpr std::chrono::seconds kLineEvery{10};

}  // namespace

void WrongTokens::Report(std::string_view path) {
  ++count_;
  const Clock::time_point now = Clock::now();
  if (now < next_line_) return;
  next_line_ = now + kLineEvery;
  std::cerr << "flexarm: dashboard: a request of " << path << " had no token or a wrong one; "
            << count_ << " since the start\n";
}

}  // namespace flexarm
