#include "tools/runs/run_search.h"

#include <algorithm>
#include <cctype>

namespace flexarm {
namespace {

std::string Lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool HasTag(const RunLabel& label, const std::string& tag) {
  return std::ranges::find(label.tags, tag) != label.tags.end();
}

}  // namespace

bool Matches(const ListedRun& run, const RunSearch& search) {
  std::string words = run.file.filename().string() + '\n' + run.label.name + '\n' + run.label.note +
                      '\n' + run.head.info.experiment_name;
  for (const std::string& tag : run.label.tags) words += '\n' + tag;
  words = Lower(words);
  const auto has_text = [&](const std::string& text) {
    return words.find(Lower(text)) != std::string::npos;
  };
  const auto has_tag = [&](const std::string& tag) { return HasTag(run.label, tag); };
  if (!std::ranges::all_of(search.text, has_text)) return false;
  if (!std::ranges::all_of(search.tag, has_tag)) return false;
  if (!search.law.empty() && run.head.info.law != search.law) return false;
  if (!search.trip) return true;
  return !run.head.trip.empty() && (*search.trip == "any" || run.head.trip == *search.trip);
}

}  // namespace flexarm
