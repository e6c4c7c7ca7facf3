#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "controller/types/messages.h"

// What the operator reads of the safety task's answers. Pure functions. Not real-time safe.

namespace flexarm {

/// A refusal as an answer to a client: "ok" false, "refusal" its machine name, "error" its text.
/// @param state  when the request was judged
nlohmann::json RefusalJson(RequestKind request, Refusal refusal, SafetyState state);

/// The answer to the client that made the request; "state" is `state_now`. Of a granted run it has
/// "run", its number; of a refusal by causes that are present their names, "present".
nlohmann::json AnswerJson(const RequestAnswer& answer, SafetyState state_now);

/// The journal line of an answer: "arm: accepted", "arm: refused: ...".
std::string AnswerLine(const RequestAnswer& answer);

}  // namespace flexarm
