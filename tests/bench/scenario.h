#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace flexarm {

/// Counts the instructions of a program that runs under callgrind with --toggle-collect and
/// --dump-after of a function: every call of it leaves a profile, which the program reads itself.
class InstructionCounter {
 public:
  /// @param prefix  value of --callgrind-out-file
  explicit InstructionCounter(std::filesystem::path prefix) : prefix_(std::move(prefix)) {}

  /// Instructions of the call that has just returned. To be called after every counted call.
  /// @throws std::runtime_error if it left no profile
  std::int64_t Last();

 private:
  std::filesystem::path prefix_;
  int calls_ = 0;
};

/// A candidate of the search: words that a scenario turns into inputs. Any words are a candidate.
inline constexpr std::size_t kDisturbances = 6;  ///< inputs in a row that a candidate disturbs
inline constexpr std::size_t kWordsEach = 8;     ///< words for each of them
using Candidate = std::array<std::uint32_t, 2 + kDisturbances * kWordsEach>;

/// The words of a disturbed input.
using Words = std::array<std::uint32_t, kWordsEach>;
Words WordsOf(const Candidate& candidate, std::size_t disturbance);

/// True for a quarter of all words: whether a disturbance of this number takes place.
inline bool Happens(const Words& words, unsigned number) {
  return ((words[0] & words[1]) >> number & 1u) != 0;
}

/// Something whose slowest call is searched.
class Scenario {
 public:
  virtual ~Scenario() = default;
  virtual std::string name() const = 0;
  /// Instructions of the median call with undisturbed inputs.
  virtual std::int64_t Median() = 0;
  /// Instructions of the slowest call with the inputs of a candidate: always the same.
  virtual std::int64_t Cost(const Candidate& candidate) = 0;
};

}  // namespace flexarm
