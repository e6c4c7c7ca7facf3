#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

#include "config/problem_log.h"

namespace flexarm {

/// Applies overrides "section.key=VALUE" to the document, in order, so that the last one wins.
///
/// VALUE is TOML; a single word that is not TOML is a string. A row or an element is named as in
/// the messages: "sensors.strain[3].face=-1", "limits.soft_angle_deg[1]=80". An unknown key is set
/// too: the reader reports it as unknown. Overrides that cannot be applied are reported in `log`.
void ApplyOverrides(const std::vector<std::string>& overrides, toml::table* document,
                    ProblemLog* log);

}  // namespace flexarm
