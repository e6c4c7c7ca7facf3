#include "config/config_place.h"

#include "config/document.h"
#include "config/overrides.h"
#include "config/problem_log.h"

namespace flexarm {

std::vector<ConfigPlace> PlacesOf(const std::filesystem::path& file,
                                  const std::vector<std::string>& overrides,
                                  const std::vector<std::string>& keys) {
  toml::table document = LoadDocument(file);
  ProblemLog log(file.string(), &document);
  ApplyOverrides(overrides, &document, &log);
  std::vector<ConfigPlace> places;
  for (const std::string& key : keys) places.push_back(log.PlaceOf(key));
  return places;
}

}  // namespace flexarm
