#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace flexarm {

/// What may stand in place of a word that was begun on a command line.
struct Completion {
  enum class Paths : std::uint8_t { kNone, kFiles, kFolders };
  std::vector<std::string> words;  ///< that begin as the word does
  Paths paths = Paths::kNone;      ///< or files or folders of the disk
};

/// Completes the last word from the verbs and options of the program, so that every option of
/// --help is completed.
/// @param words  after the name of the program; the last one is begun and may be empty
Completion Complete(const CLI::App& program, const std::vector<std::string>& words);

/// As the completion scripts read it: a word a line; ":files" and ":folders" for paths.
std::string CompletionText(const Completion& completion);

/// Says which words an option or argument may have, where --help does not list them. Called while
/// verbs are registered; `words` runs only when it is asked for.
void OfferWords(const CLI::Option* option, std::function<std::vector<std::string>()> words);

}  // namespace flexarm
