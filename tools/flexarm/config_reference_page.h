#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "config/config_reference.h"

namespace flexarm {

/// The page docs/config-reference.md: every key of a config, an experiment, a description of an
/// arm.
std::string ReferencePage(const KeyListing& rig, const KeyListing& experiment,
                          const KeyListing& arm);

/// {"tables": [..], "keys": [..]} of one kind of file.
nlohmann::ordered_json ReferenceJson(const KeyListing& reference);

/// The keys that a person may mean by `word`: one key or all of a table, by its path with or
/// without numbers of rows, or all keys of that name.
std::vector<ListedKey> KeysMeant(const KeyListing& reference, const std::string& word);

/// One key for a person, several lines.
std::string ReferenceText(const ListedKey& key);

}  // namespace flexarm
