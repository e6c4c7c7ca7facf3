#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/bench_host/solver_problem.h"

namespace flexarm {

/// What ode45_race.m printed.
struct OctaveRace {
  std::vector<std::vector<double>> rates;  ///< of each state that it was given
  struct Entry {
    double tolerance;  ///< relative
    double time_s;     ///< of the processor
    long calls;        ///< of the right-hand side
    SolverProblem::Motion motion;
  };
  std::vector<Entry> entries;  ///< one a tolerance
};

/// The text of arm_data.m: the arm, states whose rates are compared, pushes and tolerances.
std::string ArmDataText(const SolverProblem& problem,
                        const std::vector<SolverProblem::State>& states,
                        const std::vector<double>& tolerances);

/// @throws std::runtime_error if the text has another form
OctaveRace ParseOctaveRace(const std::string& output);

/// The files arm_rate.m and ode45_race.m, which are part of this program.
const char* ArmRateFile();
const char* Ode45RaceFile();

}  // namespace flexarm
