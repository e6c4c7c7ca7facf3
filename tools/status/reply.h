#pragma once

#include <nlohmann/json.hpp>
#include <string>

// Reads what a daemon has answered, which may be anything: a null, an empty list, another type, or
// a key that is missing. Never throws. Pure functions.

namespace flexarm {

using Reply = nlohmann::ordered_json;

/// The member of an object; null: it is missing, or `reply` is no object.
const Reply& In(const Reply& reply, const char* key);

/// The members of a list; empty: it is no list.
const Reply& ListIn(const Reply& reply, const char* key);

/// On one line, without control characters, at most 400 bytes; `otherwise` if it is no text.
std::string TextIn(const Reply& reply, const char* key, const std::string& otherwise = "");

/// The same of a value itself.
std::string TextOf(const Reply& value, const std::string& otherwise = "");

/// `otherwise` if it is neither true nor false.
bool FlagIn(const Reply& reply, const char* key, bool otherwise = false);

/// `otherwise` if it is no number that is finite.
double NumberIn(const Reply& reply, const char* key, double otherwise = 0.0);

/// The same of a value itself, whatever number it is; NaN: it is none.
double NumberOrNan(const Reply& value);

/// A number with so many decimals; "-" if it is no number.
std::string FigureIn(const Reply& reply, const char* key, int decimals);
std::string FigureOf(const Reply& value, int decimals);

/// Element i of a list; null: there is none.
const Reply& Element(const Reply& list, std::size_t i);

}  // namespace flexarm
