#include "tools/dashboard/experiment_list.h"

#include <algorithm>
#include <system_error>

#include "config/config.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"

namespace flexarm {

std::vector<std::string> ExperimentList::Names() const {
  std::vector<std::string> names;
  if (folder_.empty()) return names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder_, error), end; !error && entry != end;
       entry.increment(error)) {
    const bool offered = entry->path().extension() == ".toml" && entry->is_regular_file(error);
    if (offered && names.size() < kMost) names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string ExperimentList::TextOf(const std::string& name) const {
  const std::vector<std::string> names = Names();
  if (!std::binary_search(names.begin(), names.end(), name)) {
    throw InputError("there is no experiment " + Shown(name) + " in the folder of the dashboard");
  }
  return LoadExperiment(folder_ / name).text;
}

}  // namespace flexarm
