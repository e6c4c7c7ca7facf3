#include "tools/bench_host/octave_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "octave_generated.h"

namespace flexarm {
namespace {

std::string Exact(double value) { return fmt::format("{:.17g}", value); }

// A matrix as Octave reads it.
std::string MatrixText(const Eigen::MatrixXd& matrix) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) text += Exact(matrix(i, j)) + " ";
    text += ";";
  }
  return text + "]";
}

void AddMatrix(std::string* text, const char* name, const Eigen::MatrixXd& matrix) {
  *text += std::string(name) + " = " + MatrixText(matrix) + ";\n";
}

void AddNumber(std::string* text, const char* name, double value) {
  *text += std::string(name) + " = " + Exact(value) + ";\n";
}

void AddArm(std::string* text, const ArmConstants& c) {
  AddNumber(text, "arm.m1", c.m1), AddNumber(text, "arm.m2", c.m2);
  AddNumber(text, "arm.L1", c.L1), AddNumber(text, "arm.I1", c.I1);
  AddNumber(text, "arm.m", c.m_outboard), AddNumber(text, "arm.Sx", c.Sx);
  AddNumber(text, "arm.I2", c.I2), AddNumber(text, "arm.Ir2", c.Ir2);
  AddNumber(text, "arm.J1", c.J1), AddNumber(text, "arm.J2", c.J2);
  AddNumber(text, "arm.Ip", c.Ip);
  AddNumber(text, "arm.K1", c.K1), AddNumber(text, "arm.K2", c.K2);
  AddNumber(text, "arm.b1", c.viscous[0]), AddNumber(text, "arm.b2", c.viscous[1]);
  AddMatrix(text, "arm.psi1", c.link1.psi_tip), AddMatrix(text, "arm.slope1", c.link1.slope_tip);
  AddMatrix(text, "arm.a1", c.link1.a), AddMatrix(text, "arm.N1", c.link1.N);
  AddMatrix(text, "arm.G1", c.link1.G), AddMatrix(text, "arm.D1", c.link1.D);
  AddMatrix(text, "arm.slope2", c.link2.slope_tip), AddMatrix(text, "arm.N2", c.N2);
  AddMatrix(text, "arm.k2", c.k2), AddMatrix(text, "arm.a2", c.a2);
  AddMatrix(text, "arm.G2", c.link2.G), AddMatrix(text, "arm.D2", c.link2.D);
}

std::vector<double> NumbersOf(std::istringstream& line) {
  std::vector<double> numbers;
  for (double number = 0.0; line >> number;) numbers.push_back(number);
  return numbers;
}

void Require(bool right, const std::string& line) {
  if (!right) throw std::runtime_error("Octave printed an unexpected line: " + line);
}

}  // namespace

std::string ArmDataText(const SolverProblem& problem,
                        const std::vector<SolverProblem::State>& states,
                        const std::vector<double>& tolerances) {
  std::string text = "1;\n";
  AddArm(&text, problem.model().constants());
  Eigen::MatrixXd columns(SolverProblem::kStates, static_cast<Eigen::Index>(states.size()));
  for (std::size_t i = 0; i < states.size(); ++i) {
    columns.col(static_cast<Eigen::Index>(i)) =
        Eigen::VectorXd::Map(states[i].data(), static_cast<Eigen::Index>(states[i].size()));
  }
  AddMatrix(&text, "states", columns);
  Eigen::Matrix2d pushes;
  pushes << problem.PushBefore(0), problem.PushBefore(SolverProblem::kInstants - 1);
  AddMatrix(&text, "pushes", pushes);
  AddMatrix(
      &text, "tolerances",
      Eigen::RowVectorXd::Map(tolerances.data(), static_cast<Eigen::Index>(tolerances.size())));
  AddNumber(&text, "interval", SolverProblem::kInterval_s);
  return text;
}

OctaveRace ParseOctaveRace(const std::string& output) {
  OctaveRace race;
  std::istringstream lines(output);
  for (std::string text; std::getline(lines, text);) {
    std::istringstream line(text);
    std::string kind;
    line >> kind;
    const std::vector<double> numbers = NumbersOf(line);
    if (kind == "rate") {
      Require(numbers.size() == SolverProblem::kStates, text);
      race.rates.push_back(numbers);
    } else if (kind == "race") {
      Require(numbers.size() == 3, text);
      race.entries.push_back({.tolerance = numbers[0],
                              .time_s = numbers[1],
                              .calls = static_cast<long>(numbers[2]),
                              .motion = {}});
    } else if (kind == "y") {
      Require(numbers.size() == SolverProblem::kStates && !race.entries.empty(), text);
      SolverProblem::State& y = race.entries.back().motion.emplace_back();
      std::copy(numbers.begin(), numbers.end(), y.begin());
    } else {
      Require(kind.empty(), text);
    }
  }
  for (const OctaveRace::Entry& entry : race.entries) {
    Require(entry.motion.size() == SolverProblem::kInstants, "too few states");
  }
  return race;
}

const char* ArmRateFile() { return kArmRateFile; }
const char* Ode45RaceFile() { return kOde45RaceFile; }

}  // namespace flexarm
