#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace flexarm {

/// Parses JSON text that came from a file (its nesting was checked when it was read).
/// @param name      of the file, for the message
/// @param expected  what the file should be: "a gains file"
/// @throws InputError "name:line: is not JSON; expected .."
nlohmann::ordered_json ParseJson(const std::string& text, const std::string& name,
                                 const std::string& expected);

/// JSON text to print: indented, ASCII, without control characters; bytes of a text that are no
/// UTF-8 become U+FFFD. Never throws for what a text contains.
std::string PrintedJson(const nlohmann::ordered_json& json);

/// The finite number at `key` of an object.
/// @param where  begins the message: file, place within it
/// @throws InputError "where: 'key': found .., expected .."
double JsonNumber(const nlohmann::ordered_json& object, const std::string& key,
                  const std::string& where);
/// The same for a whole number.
std::int64_t JsonWhole(const nlohmann::ordered_json& object, const std::string& key,
                       const std::string& where);
/// The same for a text.
std::string JsonText(const nlohmann::ordered_json& object, const std::string& key,
                     const std::string& where);
/// The same for true or false.
bool JsonBool(const nlohmann::ordered_json& object, const std::string& key,
              const std::string& where);
/// An array; its elements may be anything.
const nlohmann::ordered_json& JsonArray(const nlohmann::ordered_json& object,
                                        const std::string& key, const std::string& where);

}  // namespace flexarm
