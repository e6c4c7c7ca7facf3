#include "controller/files/external_json.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "controller/files/external_text.h"
#include "controller/files/input_error.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void RefuseMember(const Json& object, const std::string& key, const std::string& where,
                               const std::string& expected) {
  std::string found = "nothing";
  if (object.is_object() && object.contains(key)) {
    // Bytes that are no UTF-8 would throw; the reader has refused them, other callers may not have.
    found = Shown(object.at(key).dump(-1, ' ', false, Json::error_handler_t::replace));
  }
  throw InputError(where + ": '" + key + "': found " + found + ", expected " + expected);
}

// Null if there is no such member.
const Json* Member(const Json& object, const std::string& key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

}  // namespace

Json ParseJson(const std::string& text, const std::string& name, const std::string& expected) {
  std::size_t at = 0;
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    at = std::min(error.byte, text.size());
  } catch (const Json::exception&) {  // a number beyond the range of a double
    at = text.size();
  }
  const auto lines = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  throw InputError(Shown(name, kMessageBytes) + ":" + std::to_string(lines + 1) +
                   ": is not JSON; expected " + expected);
}

std::string PrintedJson(const Json& json) {
  const std::string text = json.dump(2, ' ', true, Json::error_handler_t::replace);
  std::string printed;
  for (const char c : text) {  // DEL is ASCII, and the only control character that dump leaves
    if (c == '\x7F') {
      printed += "\\u007f";
    } else {
      printed += c;
    }
  }
  return printed;
}

double JsonNumber(const Json& object, const std::string& key, const std::string& where) {
  const Json* member = Member(object, key);
  if (member == nullptr || !member->is_number() || !std::isfinite(member->get<double>())) {
    RefuseMember(object, key, where, "a number");
  }
  return member->get<double>();
}

std::int64_t JsonWhole(const Json& object, const std::string& key, const std::string& where) {
  const Json* member = Member(object, key);
  // An unsigned number beyond the signed range would wrap.
  if (member == nullptr || !member->is_number_integer() ||
      (member->is_number_unsigned() &&
       member->get<std::uint64_t>() > static_cast<std::uint64_t>(INT64_MAX))) {
    RefuseMember(object, key, where, "a whole number");
  }
  return member->get<std::int64_t>();
}

std::string JsonText(const Json& object, const std::string& key, const std::string& where) {
  const Json* member = Member(object, key);
  if (member == nullptr || !member->is_string()) RefuseMember(object, key, where, "a text");
  return member->get<std::string>();
}

bool JsonBool(const Json& object, const std::string& key, const std::string& where) {
  const Json* member = Member(object, key);
  if (member == nullptr || !member->is_boolean()) RefuseMember(object, key, where, "true or false");
  return member->get<bool>();
}

const Json& JsonArray(const Json& object, const std::string& key, const std::string& where) {
  const Json* member = Member(object, key);
  if (member == nullptr || !member->is_array()) RefuseMember(object, key, where, "an array");
  return *member;
}

}  // namespace flexarm
