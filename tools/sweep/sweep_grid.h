#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace flexarm {

/// What the values of an axis change.
enum class AxisTarget : std::uint8_t {
  kConfig,    ///< a config key, for the simulated rig and the controller alike
  kPlant,     ///< a config key, for the simulated rig alone
  kVariant,   ///< a named plant, for the simulated rig alone
  kPayload,   ///< payload that the simulated rig carries, kg
  kScenario,  ///< a situation of the benchmark, by its name
  kSeed       ///< of the measurement noise
};

const char* ToString(AxisTarget target) noexcept;

/// One axis of the grid. The values keep the text in which they were given.
struct SweepAxis {
  AxisTarget target;
  std::string key;  ///< of kConfig and kPlant: section.key; otherwise empty
  std::vector<std::string> values;

  /// The column of results: "controller.alpha", "plant:joint1.stiffness_nm_per_rad", "variant",
  /// "payload_kg", "scenario", "seed".
  std::string Column() const;
  bool operator==(const SweepAxis&) const = default;
};

/// "v1,v2,.." (commas inside brackets and quotes are part of a value), FROM:STEP:TO with both ends
/// (TO only if a step falls on it), or whole numbers FIRST..LAST.
/// @throws InputError  an empty list or value, a value twice, an empty or endless range
std::vector<std::string> ParseValues(const std::string& text);

/// "KEY=VALUES". @throws InputError
SweepAxis ParseAxis(AxisTarget target, const std::string& text);

/// Every combination of the axes' values, numbered from 0; the last axis varies fastest.
class SweepGrid {
 public:
  SweepGrid() = default;
  /// @throws InputError  two axes for one column; more than a million points
  explicit SweepGrid(std::vector<SweepAxis> axes);

  const std::vector<SweepAxis>& axes() const { return axes_; }
  std::size_t size() const { return size_; }
  /// Index of the point's value on each axis; point < size().
  std::vector<std::size_t> Indices(std::size_t point) const;
  /// The point's value on each axis; point < size().
  std::vector<std::string> Values(std::size_t point) const;

 private:
  std::vector<SweepAxis> axes_;
  std::size_t size_ = 1;
};

/// One of `count` parts of a grid, numbered from 1: the points with point % count == number - 1.
struct Shard {
  std::size_t number = 1;
  std::size_t count = 1;

  bool Has(std::size_t point) const { return point % count == number - 1; }
};

/// "I/N", 1 <= I <= N. @throws InputError
Shard ParseShard(const std::string& text);

}  // namespace flexarm
