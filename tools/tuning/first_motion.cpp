#include "tools/tuning/first_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "config/experiment_file.h"
#include "controller/host/simulation.h"
#include "controller/types/rejected_error.h"
#include "controller/types/rounded_text.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr double kAngle_deg = 5.0, kShareOfReduced = 0.25;
constexpr double kShortest_s = 4.0, kLongest_s = 30.0, kLonger = 1.5;
constexpr double kBetweenMoves_s = 1.0;  // between two moves
constexpr int kPayloads = 5;

// The smaller of 5 deg and a share of what the reduced limits allow; in tenths of a degree.
double AngleOf(const RigConfig& config, std::size_t joint) {
  const double most_deg = kShareOfReduced * WithReducedLimits(config.safety).soft_angle_deg[joint];
  return std::floor(10.0 * std::min(kAngle_deg, most_deg)) / 10.0;
}

// Seconds on samples of the loop.
double OnSamples(double time_s, double period_s) {
  return std::ceil(time_s / period_s - 1e-6) * period_s;
}

std::string TextWith(const RigConfig& config, double move_s) {
  const double period_s = config.loop.period_s();
  const double takes_s = OnSamples(move_s, period_s),
               every_s = OnSamples(move_s + kBetweenMoves_s, period_s);
  std::string text = std::string(kFirstMotionMark) +
                     ": each joint alone by a small angle, slowly.\n"
                     "# No payload that the rig is for trips in simulation, also with reduced "
                     "limits.\nname = \"first-motion\"\n";
  int row = 0;
  for (const std::size_t joint : {std::size_t{1}, std::size_t{0}}) {
    const double angle_deg = AngleOf(config, joint);
    for (const double to_deg : {angle_deg, -angle_deg, 0.0}) {
      std::array<double, 2> to{};
      to[joint] = to_deg;
      text += "\n[[move]]\nstart_s = " + RoundedText(row * every_s, 4) +
              "\nduration_s = " + RoundedText(takes_s, 4) + "\nto_deg = [" + RoundedText(to[0], 1) +
              ", " + RoundedText(to[1], 1) + "]\n";
      ++row;
    }
  }
  return text;
}

// "" if no payload trips.
std::string ProblemOf(const RigConfig& config, const std::string& text) {
  SimulationRequest request;
  request.config = config;
  request.experiment = ParseExperiment(text, "first-motion.toml");
  const auto [least_kg, most_kg] = config.controller.payload_range_kg;
  for (const bool reduced : {true, false}) {
    request.config.safety.reduced = reduced;
    for (int i = 0; i < kPayloads; ++i) {
      request.payload_kg = least_kg + (most_kg - least_kg) * i / (kPayloads - 1);
      const std::string with = " with " + RoundedText(*request.payload_kg, 3) + " kg";
      try {
        const SimulationResult result = Simulate(request);
        if (!result.completed) return std::string(ToString(result.trip)) + with;
      } catch (const RejectedError& error) {
        return error.what() + with;
      }
    }
  }
  return {};
}

}  // namespace

std::string FirstMotion(const RigConfig& config) {
  std::string problem;
  for (double move_s = kShortest_s; move_s <= kLongest_s; move_s *= kLonger) {
    std::string text = TextWith(config, move_s);
    problem = ProblemOf(config, text);
    if (problem.empty()) return text;
  }
  throw RejectedError("no first motion is slow enough: " + problem);
}

}  // namespace flexarm
