#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace flexarm {

/// Indices of the nominal model's state vector.
///
///   x = [q; q'],  q = [th1 th2 f11 .. f1m f21 .. f2m] with rigid joints,
///                 q = [th1 th2 th3 th4 f11 .. f1m f21 .. f2m] with torsional ones
///
/// With rigid joints th3 = th1, th4 = th2. Joints, links and modes count from 0.
struct StateLayout {
  bool torsion;        ///< the joints are springs between rotor and hub; false: rigid
  int modes_per_link;  ///< m, 1 or 2

  constexpr int angles() const { return torsion ? 4 : 2; }
  constexpr int dof() const { return angles() + 2 * modes_per_link; }
  constexpr int states() const { return 2 * dof(); }

  // Coordinates: entries of q.
  constexpr int hub(int joint) const { return joint; }
  /// The coordinate on which the torque of a joint acts.
  constexpr int rotor(int joint) const { return torsion ? 2 + joint : joint; }
  constexpr int mode(int link, int number) const {
    return angles() + link * modes_per_link + number;
  }

  /// The entry of x that is the rate of a coordinate.
  constexpr int rate(int coordinate) const { return dof() + coordinate; }

  // Outputs: entries of y = [th1 th2 th3 th4 f11 .. f2m], measured by the sensors.
  constexpr int outputs() const { return 4 + 2 * modes_per_link; }
  /// The output that measures a coordinate; with rigid joints that of the hub.
  constexpr int output(int coordinate) const {
    return coordinate < angles() ? coordinate : coordinate + 4 - angles();
  }

  bool operator==(const StateLayout&) const = default;
};

inline constexpr StateLayout kR8{.torsion = false, .modes_per_link = 1};
inline constexpr StateLayout kR12{.torsion = false, .modes_per_link = 2};
inline constexpr StateLayout kT12{.torsion = true, .modes_per_link = 1};
inline constexpr StateLayout kT16{.torsion = true, .modes_per_link = 2};

/// R for rigid joints or T for torsional ones, and the number of states.
struct NamedLayout {
  std::string_view name;
  StateLayout layout;
};
inline constexpr std::array<NamedLayout, 4> kNominalModels{
    {{"R8", kR8}, {"R12", kR12}, {"T12", kT12}, {"T16", kT16}}};

constexpr std::string_view NameOf(const StateLayout& layout) {
  for (const NamedLayout& model : kNominalModels) {
    if (model.layout == layout) return model.name;
  }
  return "unnamed";
}

constexpr std::optional<StateLayout> LayoutNamed(std::string_view name) {
  for (const NamedLayout& model : kNominalModels) {
    if (model.name == name) return model.layout;
  }
  return std::nullopt;
}

}  // namespace flexarm
