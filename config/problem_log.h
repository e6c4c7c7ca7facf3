#pragma once

#include <toml++/toml.h>

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.h"
#include "config/config_place.h"
#include "model/problem.h"

namespace flexarm {

/// Joins a path and a key below it: "loop" and "period_ms" give "loop.period_ms".
std::string JoinKey(const std::string& path, std::string_view key);

/// Collects the problems found while one document is read, each with the file and line of its
/// value.
///
/// A value that could not be read is reported once: rules about it are not checked.
class ProblemLog {
 public:
  /// `document` outlives this object; `file` is the place of problems without a node.
  ProblemLog(std::string file, const toml::table* document);

  /// Declares that the table at `path` may have `key`, so that it is not reported as unknown.
  void Know(const std::string& path, std::string_view key);

  /// Reports a missing required key. `wanted` describes its value, such as "a number".
  void AddMissing(const std::string& path, std::string_view key, std::string_view wanted);

  /// Does not report these keys as missing: what they depend on is reported.
  void Excuse(std::vector<std::string> keys);

  /// Reports a value that violates `rule`; its text and place are those of `node`.
  void Add(const std::string& key, const toml::node& node, std::string rule);

  /// Reports an override that could not be applied to the document.
  void AddOverride(const std::string& override_text, std::string rule);

  /// Reports violated rules of a struct, at the places of the keys that they name.
  void AddRules(const std::vector<Problem>& problems);

  /// True if no problem is reported at, above or below any of `keys`.
  bool Clear(std::initializer_list<std::string_view> keys) const;

  /// Where the value at a dotted key stands, or the deepest table on its path.
  ConfigPlace PlaceOf(std::string_view key) const;

  /// Reports every key of the document that no reader knows. Call it last.
  void AddUnknown();

  /// Throws a ConfigError with all problems, missing keys included, in order of file and line,
  /// unless there are none.
  void ThrowIfAny();

 private:
  struct Missing {
    std::string path;
    std::string key;
    std::string wanted;
  };

  ConfigProblem Placed(const toml::node* node, std::string key, std::string value,
                       std::string rule) const;
  ConfigPlace PlaceOfNode(const toml::node* node) const;
  const toml::node* Locate(std::string_view path) const;
  void AddUnknownIn(const toml::table& table, const std::string& path);
  void AddUnknownKey(const std::string& path, std::string_view key, const toml::node& node);
  std::string Suggestion(const std::string& path, std::string_view key);

  std::string file_;
  const toml::table* document_;
  std::map<std::string, std::vector<std::string>> known_;  // table path -> known keys, in order
  std::vector<std::string> excused_;
  std::vector<std::string> reported_;  // keys whose rules are not checked
  std::vector<Missing> missing_;
  std::vector<ConfigProblem> problems_;
};

}  // namespace flexarm
