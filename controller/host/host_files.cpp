#include "controller/host/host_files.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <memory>
#include <sstream>
#include <utility>

namespace flexarm {
namespace {

constexpr int kMostNumbers = 8192;  // more processors than any kernel supports

std::optional<std::int64_t> NumberOf(const std::string& text) {
  std::int64_t number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || rest != end) return std::nullopt;
  return number;
}

}  // namespace

std::optional<std::int64_t> HostText::number() const {
  return read() ? NumberOf(text) : std::nullopt;
}

HostText HostFiles::Read(const std::string& path) const {
  std::error_code error;
  if (!std::filesystem::exists(At(path), error)) {
    return {.state = error ? HostText::State::kUnreadable : HostText::State::kAbsent, .text = {}};
  }
  // Not a stream: its buffer throws for a folder, and for a process that ends during the read.
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
      std::fopen(At(path).c_str(), "rb"), [](std::FILE* open) { return std::fclose(open); });
  std::string text;
  std::array<char, 4096> part{};
  while (file != nullptr) {
    const std::size_t count = std::fread(part.data(), 1, part.size(), file.get());
    text.append(part.data(), count);
    if (count < part.size()) break;
  }
  if (file == nullptr || std::ferror(file.get()) != 0) {
    return {.state = HostText::State::kUnreadable, .text = {}};
  }
  text.erase(text.find_last_not_of(" \n\t") + 1);
  return {.state = HostText::State::kRead, .text = std::move(text)};
}

std::vector<std::string> HostFiles::List(const std::string& folder) const {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(At(folder), error), end; !error && entry != end;
       entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string HostFiles::Resolve(const std::string& path) const {
  std::error_code error;
  const std::filesystem::path root = std::filesystem::canonical(root_, error);
  const std::filesystem::path found = std::filesystem::canonical(At(path), error);
  if (error) return {};
  return (std::filesystem::path("/") / found.lexically_relative(root)).string();
}

std::optional<std::vector<int>> NumbersOfList(const std::string& text) {
  std::vector<int> numbers;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-');
    const auto first = NumberOf(part.substr(0, dash));
    const auto last = dash == std::string::npos ? first : NumberOf(part.substr(dash + 1));
    if (!first || !last || *first < 0 || *last < *first || *last >= kMostNumbers) {
      return std::nullopt;
    }
    for (auto n = *first; n <= *last; ++n) numbers.push_back(static_cast<int>(n));
  }
  return numbers;
}

}  // namespace flexarm
