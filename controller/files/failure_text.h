#pragma once

#include <exception>
#include <string>

namespace flexarm {

/// What a program prints of an exception: ShownMessage of its text. The JSON library's and the
/// C++ library's own texts, which say nothing to a user, are replaced.
std::string FailureText(const std::exception& error);

}  // namespace flexarm
