#pragma once

#include <array>
#include <string_view>

namespace CLI {
class App;
}

namespace flexarm {

/// Verbs that study the model and the laws. They need neither daemon nor rig and take a compiler as
/// long as all other verbs together, so they are a program of their own, flexarm-study, which
/// `flexarm VERB ..` becomes.
struct Study {
  std::string_view verb;
  std::string_view description;  ///< as --help of either program shows it
};

inline constexpr std::array kStudies = {
    Study{"modes", "Natural frequencies of the links and of the whole arm, undamped"},
    Study{"analyze", "What the model says about the arm"},
    Study{"sweep", "Simulate an experiment over a grid of values, on all cores, resumable"},
    Study{"benchmark",
          "Every control law in the same situations: settling, errors, effort, one score"},
    Study{"report", "Every figure and table of chapters 4 to 7 recomputed, in one HTML page"},
    Study{"identify", "Find parameters of the rig that let the model predict a measured run"},
};

bool IsStudy(std::string_view verb) noexcept;

/// Adds the verb, one of kStudies, with its description.
/// @throws std::out_of_range of any other
CLI::App* AddStudy(CLI::App& app, std::string_view verb);

/// Becomes flexarm-study, which stands beside this program, with the same arguments. Returns only
/// if that cannot be: what the process ends with, the reason is on stderr.
int BecomeStudyProgram(char** argv);

}  // namespace flexarm
