#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace flexarm {

/// The secret without which no command is taken from a browser. Not real-time safe.
class AccessToken {
 public:
  static constexpr std::size_t kLeastBytes = 20;  ///< of a token that a file has
  static constexpr std::size_t kMostBytes = 200;

  /// 256 random bits of the kernel, as 64 hexadecimal digits.
  /// @throws std::system_error if the kernel gives none
  static AccessToken Fresh();

  /// The first line of a file that its owner alone can read.
  /// @throws InputError: it cannot be read, others can read it, or the token is too short, too long
  /// or has characters other than letters, digits and -._~+/=
  static AccessToken OfFile(const std::filesystem::path& file);

  const std::string& text() const { return text_; }

  /// Whether `given` is this token. The time that it takes depends on the length of `given` alone,
  /// so it tells nothing about the token.
  bool Matches(std::string_view given) const noexcept;

 private:
  explicit AccessToken(std::string text) : text_(std::move(text)) {}

  std::string text_;
};

}  // namespace flexarm
