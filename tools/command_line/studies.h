#pragma once

#include <array>
#include <string_view>

namespace CLI {
class App;
}

namespace flexarm {

/// Verbs that analyse the model, compare the laws, and write files for other programs. They need
/// neither daemon nor rig; compiling them takes as long as all other verbs together, and libmatio
/// brings 30 libraries that would delay every start of flexarm. Therefore they are in a program of
/// their own, flexarm-study, which `flexarm VERB ..` executes.
struct Study {
  std::string_view verb;
  std::string_view description;  ///< shown by --help of both programs
};

inline constexpr std::array kStudies = {
    Study{"modes", "Undamped natural frequencies of the links and of the whole arm"},
    Study{"gauges",
          "Strain gauges: how well they know the modes, and where they would know them best"},
    Study{"analyze",
          "Analyse the model: linearization, order reduction, parameters, claims of the thesis"},
    Study{"bound",
          "How fast a move can be: a rigid arm's shortest time, and the best found with bending"},
    Study{"sweep",
          "Simulate an experiment over a grid of parameter values, on all cores; resumable"},
    Study{"benchmark",
          "Compare the control laws in the same scenarios: settling, errors, torque, one score"},
    Study{
        "report",
        "Describe the arm and compare its laws in one HTML page; recompute the thesis for its arm"},
    Study{"bench-host",
          "Measure how fast this machine runs step, plan, plant, replay and sweeps, in one table"},
    Study{"torture", "Run the whole daemon under injected faults, and check every safety rule"},
    Study{"identify", "Identify parameters of the rig from a measured run"},
    Study{
        "export",
        "Export the samples of a run log as a CSV file, raw for `flexarm replay` or decoded, or as "
        "a MAT file"},
};

bool IsStudy(std::string_view verb) noexcept;

/// Adds the verb, one of kStudies, with its description.
/// @throws std::out_of_range for any other name
CLI::App* AddStudy(CLI::App& app, std::string_view verb);

/// Replaces this process by flexarm-study, from the folder of this program, with the same
/// arguments. Returns only on failure: the exit code; the reason is printed to stderr.
int BecomeStudyProgram(char** argv);

}  // namespace flexarm
