#include <utility>

#include "config/config.h"
#include "controller/files/external_text.h"

namespace flexarm {
namespace {

std::string AllText(const std::vector<ConfigProblem>& problems) {
  std::string out;
  for (const ConfigProblem& p : problems) {
    if (!out.empty()) out += "\n";
    out += p.Text();
  }
  return out;
}

}  // namespace

std::string ConfigProblem::Text() const {
  std::string out = Shown(file, kMessageBytes);
  if (line > 0) out.append(":").append(std::to_string(line));
  if (!key.empty()) out.append(": ").append(key);
  if (!value.empty()) out.append(" = ").append(value);
  return out.append(": ").append(rule);
}

ConfigError::ConfigError(std::vector<ConfigProblem> problems)
    : std::runtime_error(AllText(problems)), problems_(std::move(problems)) {}

}  // namespace flexarm
