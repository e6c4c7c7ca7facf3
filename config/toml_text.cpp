#include "config/toml_text.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "model/problem_list.h"

namespace flexarm {
namespace {

bool IsBare(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

std::string Escaped(char c) {
  if (c == '"' || c == '\\') return std::string("\\") + c;
  if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) return {c};
  std::array<char, 8> code{};
  std::snprintf(code.data(), code.size(), "\\u%04X", static_cast<unsigned>(c));
  return code.data();
}

std::string Quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) out += Escaped(c);
  return out + "\"";
}

std::string FloatText(double value) {
  std::string text = NumberText(value);
  if (text.find_first_not_of("-0123456789") == std::string::npos)
    text += ".0";  // otherwise it would be read as an integer
  return text;
}

std::string ArrayText(const toml::array& array) {
  std::string out = "[";
  for (const toml::node& element : array) {
    if (out.size() > 1) out += ", ";
    out += ValueText(element);
  }
  return out + "]";
}

std::string JoinPath(const std::string& path, std::string_view key) {
  return path.empty() ? KeyText(key) : path + "." + KeyText(key);
}

bool IsRows(const toml::node& node) {
  const toml::array* rows = node.as_array();
  return rows != nullptr && !rows->empty() && rows->is_homogeneous(toml::node_type::table);
}

// Plain values come before sections: a value below a header would belong to that header.
void AppendTable(const toml::table& table, const std::string& path, std::string* out) {
  for (const auto& [key, node] : table) {
    if (node.is_table() || IsRows(node)) continue;
    *out += KeyText(key.str()) + " = " + ValueText(node) + "\n";
  }
  for (const auto& [key, node] : table) {
    const std::string name = JoinPath(path, key.str());
    if (const toml::table* section = node.as_table()) {
      *out += "\n[" + name + "]\n";
      AppendTable(*section, name, out);
    } else if (IsRows(node)) {
      for (const toml::node& row : *node.as_array()) {
        *out += "\n[[" + name + "]]\n";
        AppendTable(*row.as_table(), name, out);
      }
    }
  }
}

}  // namespace

std::string KeyText(std::string_view key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), IsBare);
  return bare ? std::string(key) : Quoted(key);
}

std::string ValueText(const toml::node& node) {
  if (const auto* text = node.as_string()) return Quoted(text->get());
  if (const auto* number = node.as_floating_point()) return FloatText(number->get());
  if (const auto* integer = node.as_integer()) return NumberText(integer->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* array = node.as_array()) return ArrayText(*array);
  if (node.is_table()) return "{...}";
  return "a date or time";
}

std::string DocumentText(const toml::table& document) {
  std::string out;
  AppendTable(document, "", &out);
  return out;
}

}  // namespace flexarm
