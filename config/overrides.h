#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

#include "config/problem_log.h"

namespace flexarm {

/// Lays "section.key=VALUE" over the document, in order, so that the last one wins.
///
/// VALUE is TOML; what is not, and is one word, is a string. A row or an element is named as in the
/// messages: "sensors.strain[3].face=-1", "limits.soft_angle_deg[1]=80". A key that the config does
/// not have is set too: the reader reports it as unknown. What has no sense goes into `log`.
void ApplyOverrides(const std::vector<std::string>& overrides, toml::table* document,
                    ProblemLog* log);

}  // namespace flexarm
