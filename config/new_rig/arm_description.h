#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flexarm {

/// One key that describes an arm, in the words of its owner.
struct ArmKey {
  const char* key;        ///< "link1.length_m", in a file and as the option --link1.length_m
  const char* meaning;    ///< with its unit, as a question
  bool required;          ///< without a value there is no config
  const char* otherwise;  ///< what holds without the key; "" if it is required
  double least, most;     ///< of a number
};

/// Every numeric key, in the order in which they are asked.
std::span<const ArmKey> ArmKeys();

/// Material of the links, by its usual name.
struct Material {
  const char* name;
  const char* what;  ///< grade
  double density_kg_m3, youngs_modulus_pa;
  double strain_limit;  ///< half of the strain at which it yields
};
std::span<const Material> Materials();

/// An arm as its owner describes it: the input of `flexarm config new`.
struct ArmDescription {
  std::string name;
  std::array<Material, 2> material;  ///< of link 1 and link 2
  std::map<std::string, double, std::less<>> number;

  double At(std::string_view key) const { return number.find(key)->second; }
  bool Has(std::string_view key) const { return number.contains(key); }
  /// The value of the key, or `otherwise`.
  double Or(std::string_view key, double otherwise) const { return Has(key) ? At(key) : otherwise; }
};

/// Reads a description from a file, which may be empty, and values "key=VALUE" that replace those
/// of the file.
class ArmDescriptionReader {
 public:
  /// @throws ConfigError if the file cannot be read
  explicit ArmDescriptionReader(std::filesystem::path file, std::vector<std::string> values = {});

  /// The required keys that have no value yet, "material" included.
  std::vector<std::string> Missing() const;
  void Set(const std::string& key, const std::string& value);
  /// @throws ConfigError with every problem found: missing, unknown, mistyped, out of range
  ArmDescription Read() const;

 private:
  std::filesystem::path file_;
  std::vector<std::string> values_;
};

}  // namespace flexarm
