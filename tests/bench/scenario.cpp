#include "tests/bench/scenario.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>

namespace flexarm {

std::int64_t InstructionCounter::Last() {
  const std::filesystem::path file = prefix_.string() + "." + std::to_string(++calls_);
  std::ifstream profile(file);
  const std::string key = "summary: ";
  std::int64_t instructions = 0;
  for (std::string line; std::getline(profile, line);) {
    if (line.starts_with(key)) instructions = std::stoll(line.substr(key.size()));
  }
  if (instructions == 0) throw std::runtime_error("no profile of a call in " + file.string());
  std::filesystem::remove(file);
  return instructions;
}

Words WordsOf(const Candidate& candidate, std::size_t disturbance) {
  Words words{};
  std::copy_n(candidate.begin() + static_cast<std::ptrdiff_t>(2 + disturbance * kWordsEach),
              words.size(), words.begin());
  return words;
}

}  // namespace flexarm
