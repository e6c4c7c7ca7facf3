#pragma once

#include <string>

namespace CLI {
class App;
}

namespace flexarm {

// Verbs on which a config has no effect accept neither -c/--config nor --set: a value that is
// given and not used would look as if it had been. The message says why, and what to do instead.

/// Why a verb that reads logs takes no config.
inline constexpr const char* kLogHasItsConfig =
    "a run log holds the config of its run; `flexarm replay RUN -c FILE --set KEY=VALUE` computes "
    "a run again with another";

/// Why a verb that talks to the daemon takes no --set.
inline constexpr const char* kDaemonHasItsConfig =
    "the daemon's config is what it was started with; start it with `flexarmd --config FILE --set "
    "KEY=VALUE`";

/// The verb refuses --set: "run: --set has no effect here: <why>". Not shown by --help.
/// @param why  must outlive the verb; says what to do instead
void RefuseSet(CLI::App* verb, const char* why);

/// The verb refuses -c/--config and --set.
void RefuseConfig(CLI::App* verb, const char* why);

/// RefuseConfig for `app` and every verb below it that has no --set: they read no config, or their
/// own verbs do.
void RefuseConfigElsewhere(CLI::App* app);

}  // namespace flexarm
