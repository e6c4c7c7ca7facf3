#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/sweep/scenario.h"

namespace flexarm {

/// The tables of the benchmark (docs/benchmark.md).
enum class BenchmarkKind : std::uint8_t {
  kCommands,  ///< the commands of config/experiments
  kMoves,     ///< random smooth moves, also for the laws that follow no other command
  kLimits,    ///< the same moves, with the limits of the rig removed one by one
  kFast,      ///< moves as short as each law makes them, over the shortest possible time
};

const char* ToString(BenchmarkKind kind);  ///< "commands", "moves", "limits", "fast"
/// @throws InputError  there is no table of that name
BenchmarkKind BenchmarkKindNamed(const std::string& name);

/// A law or a scenario that a rig's table does not have.
struct LeftOut {
  std::string name;
  std::string why;  ///< what the rig's config says against it
};

/// What a table compares, and with which seeds unless others are asked for.
struct BenchmarkSet {
  BenchmarkKind kind;
  std::vector<Scenario> scenarios;  ///< in the order of the tables; the first is the nominal one
  std::vector<std::string> laws;    ///< by their names in the config
  std::string seeds;                ///< values of a seed axis, such as "1..3"
  std::vector<LeftOut> left_out{};  ///< laws and scenarios that are not possible on this rig
};

/// Commands, payloads and moves are those that the rig can follow.
/// @param experiments  folder with benchmark-square.toml and the others
/// @throws ConfigError  one of them is missing or wrong
BenchmarkSet BenchmarkSetOf(BenchmarkKind kind, const RigConfig& config,
                            const std::filesystem::path& experiments);

/// A file by which the folder of the commands is found.
inline constexpr const char* kBenchmarkFile = "benchmark-square.toml";

/// The laws that accept any command.
std::vector<std::string> CommandLaws();
/// The laws that estimate the payload; they follow smooth moves only.
std::vector<std::string> PayloadLaws();

/// Payloads and commands of config/experiments that the rig can follow, and the plants.
std::vector<Scenario> CommandScenarios(const RigConfig& config,
                                       const std::filesystem::path& experiments);
/// The payload ranges and the plants of docs/theory/payload.md 6.2 and 6.3, and finer encoders.
std::vector<Scenario> MoveScenarios(const RigConfig& config);
std::vector<Scenario> LimitScenarios(const RigConfig& config);
/// Payloads, each known to be the same in a run, and plants (docs/theory/fast-moves.md 5).
std::vector<Scenario> FastScenarios(const RigConfig& config);

/// The set with these scenarios only, in the order of the set.
BenchmarkSet Only(BenchmarkSet set, const std::vector<std::string>& scenarios);

}  // namespace flexarm
