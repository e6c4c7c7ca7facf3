#pragma once

#include <string>

namespace CLI {
class App;
}

namespace flexarm {

/// What the user may have meant by the first argument that a verb did not expect:
/// "; did you mean --seed?", or "" if nothing is close to it.
/// @param verb  the innermost one that was given, after it failed to parse
std::string GuessFor(const CLI::App& verb);

/// "; did you mean simulate?" for a word that is no verb of `app`; "" if none is close.
std::string GuessVerb(const CLI::App& app, const std::string& word);

/// The innermost verb that was given.
const CLI::App& InnermostVerb(const CLI::App& app);

}  // namespace flexarm
