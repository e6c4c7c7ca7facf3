#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/analysis/spectrum.h"

namespace flexarm {

/// The signals of chapter 5: bending of the links at their tips, twist of the joints' springs.
enum Signal : std::size_t { kBending1, kBending2, kTwist1, kTwist2 };
constexpr std::size_t kSignals = 4;

/// Excitation of chapter 4: one period of a square wave of 1 s, from rest with a straight elbow,
/// then zero torque. The thesis does not state its amplitude, nor its motors' time constants.
struct Excitation {
  std::array<double, 2> torque_nm = {0.4, 0.1};
  std::array<double, 2> motor_lag_ms = {0.0, 0.0};  ///< of (3.24), DcMotor; 0: none
  static constexpr double kPeriod_s = 1.0;
};

/// The excitation for a rig, with the lag of its motors: 0.4 and 0.1 N m for the thesis's arm, for
/// others the same shares of the torque limits as there.
Excitation ExcitationFor(const RigConfig& config);

/// One signal of one run. mm for bending, mrad for twist. All infinite if the run diverged.
struct SignalMeasures {
  double peak;               ///< largest magnitude of the whole run
  double spectral_peak;      ///< largest amplitude of the whole run's spectrum
  double free_rms;           ///< rms about the mean, after the excitation
  double free_frequency_hz;  ///< strongest line after the excitation
  Spectrum spectrum;         ///< of the whole run, up to kShown_hz
};

/// Results at one value of the varied parameter.
struct ParametricPoint {
  double value;
  std::array<SignalMeasures, kSignals> signal;
  std::array<double, 2> free_hz;  ///< the two lowest frequencies of the arm, motors free, undamped
  double held_hz;                 ///< the lowest with the motors held
};

/// One parameter varied, all others as in the config.
struct ParametricSweep {
  std::string name;  ///< "payload_kg": key of the JSON and of the files, with its unit
  std::string label;
  double nominal;                      ///< value in the config
  std::vector<ParametricPoint> point;  ///< ascending values
};

/// Payload, joint stiffnesses, friction, backlash (as a dead zone with impacts, and for the
/// thesis's arm in its dissipation form) and link lengths, in this order.
enum SweepPlace : std::size_t {
  kPayload,
  kStiffness1,
  kStiffness2,
  kFriction,
  kBacklash,
  kThesisBacklash,
  kLength1,
  kLength2,
  kSweeps
};

struct ParametricStudy {
  Excitation excitation;
  std::vector<ParametricSweep> sweep;  ///< by SweepPlace; without kThesisBacklash for another arm

  /// Of the thesis's arm.
  const ParametricSweep& At(SweepPlace place) const { return sweep[place]; }
};

constexpr double kStrongExcitation = 5.0;  ///< factor on the torque of the second study
constexpr double kShown_hz = 25.0;         ///< spectra are stored up to this frequency

/// The same excitation with kStrongExcitation times the torque.
Excitation Strong(const Excitation& weak);

/// Simulates every point of every sweep on all cores.
/// @param progress  as ParallelFor, with the number of runs done of `ParametricRuns`
ParametricStudy RunParametricStudy(const RigConfig& config, const Excitation& excitation,
                                   const std::function<void(std::size_t)>& progress = {});

/// Number of runs of a study.
std::size_t ParametricRuns(const RigConfig& config);

}  // namespace flexarm
