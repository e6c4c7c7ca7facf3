#include "config/document.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "config/config.h"
#include "config/toml_text.h"
#include "controller/files/external_file.h"

namespace flexarm {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Fail(const std::string& file, int line, std::string rule) {
  throw ConfigError({{file, line, "", "", std::move(rule)}});
}

// The chain of files that led to this one, to refuse a cycle.
using Chain = std::vector<fs::path>;

toml::table LoadOnTopOfBase(const fs::path& file, Chain chain);

toml::table LoadBase(const fs::path& file, const toml::node& extends, Chain chain) {
  const int line = static_cast<int>(extends.source().begin.line);
  const auto* name = extends.as_string();
  const auto refuse = [&](std::string rule) {
    throw ConfigError({{file.string(), line, kExtendsKey, ValueText(extends), std::move(rule)}});
  };
  if (name == nullptr || name->get().empty()) refuse("must be the name of a file, as a string");
  const fs::path base = (file.parent_path() / name->get()).lexically_normal();
  std::error_code ignored;
  if (!fs::exists(base, ignored)) refuse("there is no file " + base.string());
  const fs::path canonical = fs::weakly_canonical(base, ignored);
  if (std::find(chain.begin(), chain.end(), canonical) != chain.end()) {
    refuse("must not lead back to a file that extends this one");
  }
  return LoadOnTopOfBase(base, std::move(chain));
}

toml::table LoadOnTopOfBase(const fs::path& file, Chain chain) {
  std::error_code ignored;
  chain.push_back(fs::weakly_canonical(file, ignored));
  toml::table own = ParseToml(ReadConfigFile(file), file.string());
  const toml::node* extends = own.get(kExtendsKey);
  if (extends == nullptr) return own;
  toml::table document = LoadBase(file, *extends, std::move(chain));
  own.erase(kExtendsKey);
  Merge(&document, std::move(own));
  return document;
}

}  // namespace

std::string ReadConfigFile(const fs::path& file, const FileKind& kind) {
  FileContent content = ReadExternalFile(file, kind);
  if (content.problem) Fail(file.string(), content.problem->line, content.problem->what);
  return std::move(content.text);
}

toml::table ParseToml(std::string_view text, const std::string& name) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    Fail(name, 0, "is empty: must be a TOML file");
  }
  if (const auto problem = ProblemOfText(text, kConfigFile)) {
    Fail(name, problem->line, problem->what);
  }
  try {
    return toml::parse(text, std::string_view(name));
  } catch (const toml::parse_error& error) {
    Fail(name, static_cast<int>(error.source().begin.line),
         "is not valid TOML: " + std::string(error.description()));
  }
}

toml::table LoadDocument(const fs::path& file) { return LoadOnTopOfBase(file, {}); }

void Merge(toml::table* base, toml::table&& top) {
  for (auto& [key, node] : top) {
    toml::node* below = base->get(key.str());
    if (below != nullptr && below->is_table() && node.is_table()) {
      Merge(below->as_table(), std::move(*node.as_table()));
    } else {
      base->insert_or_assign(key.str(), std::move(node));
    }
  }
}

}  // namespace flexarm
