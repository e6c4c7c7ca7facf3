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
/// their own.
inline constexpr std::string_view kStudyProgram = "flexarm-study";

/// It has the verb that serves a page over HTTP, and the libraries of that.
inline constexpr std::string_view kWebProgram = "flexarm-web";

/// A verb that `flexarm VERB ..` executes another program for.
struct OtherVerb {
  std::string_view verb;
  std::string_view description;  ///< shown by --help of both programs
  std::string_view program = kStudyProgram;
};

inline constexpr std::array kOtherVerbs = {
    OtherVerb{"modes", "Undamped natural frequencies of the links and of the whole arm"},
    OtherVerb{"gauges",
              "Strain gauges: how well they know the modes, and where they would know them best"},
    OtherVerb{
        "analyze",
        "Analyse the model: linearization, order reduction, parameters, claims of the thesis"},
    OtherVerb{
        "bound",
        "How fast a move can be: a rigid arm's shortest time, and the best found with bending"},
    OtherVerb{"sweep",
              "Simulate an experiment over a grid of parameter values, on all cores; resumable"},
    OtherVerb{
        "benchmark",
        "Compare the control laws in the same scenarios: settling, errors, torque, one score"},
    OtherVerb{
        "report",
        "Describe the arm and compare its laws in one HTML page; recompute the thesis for its arm"},
    OtherVerb{
        "bench-host",
        "Measure how fast this machine runs step, plan, plant, replay and sweeps, in one table"},
    OtherVerb{"torture", "Run the whole daemon under injected faults, and check every safety rule"},
    OtherVerb{"identify", "Identify parameters of the rig from a measured run"},
    OtherVerb{
        "export",
        "Export the samples of a run log as a CSV file, raw for `flexarm replay` or decoded, or as "
        "a MAT file"},
    OtherVerb{"dashboard",
              "Serve a live page of the daemon to browsers of this computer: arm, plots, trips, "
              "controls",
              kWebProgram},
};

bool IsOtherVerb(std::string_view verb) noexcept;

/// The program that has the verb: "flexarm" for a verb that is not one of kOtherVerbs.
std::string_view ProgramOf(std::string_view verb) noexcept;

/// The row of a verb. @throws std::out_of_range for one that is not of kOtherVerbs
const OtherVerb& RowOf(std::string_view verb);

/// Adds the verb, one of kOtherVerbs, with its description.
/// @throws std::out_of_range for any other name
CLI::App* AddOtherVerb(CLI::App& app, std::string_view verb);

/// Replaces this process by the program that has the verb, from the folder of this program, with
/// the same arguments. Returns only on failure: the exit code; the reason is printed to stderr.
/// @param verb  one of kOtherVerbs
int BecomeOtherProgram(std::string_view verb, char** argv);

}  // namespace flexarm
