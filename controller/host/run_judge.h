#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "controller/operator/override.h"
#include "controller/types/experiment.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// The part of an experiment's `payload_kg` that the rig is for (controller.payload_range_kg): an
/// experiment is for any rig. First above second: there is none. Nothing: it states no payloads.
std::optional<std::array<double, 2>> PayloadsOf(const Experiment& experiment,
                                                const RigConfig& config);

/// Why an experiment is not for an arm with this payload; nothing: it is.
std::optional<UnmetCondition> PayloadObjection(const Experiment& experiment,
                                               const RigConfig& config, double payload_kg);

/// Judges whether a law can run an experiment, before it does (docs/experiments.md).
///
/// The law must be one of `laws`. With `payload_kg`, the run is simulated in lock step with the
/// law, on the nominal arm of the config, from where the arm stands, with the least, the middle and
/// the greatest payload of PayloadsOf; none may trip. An objection names a law that works, found in
/// the same way. An experiment that states neither costs nothing, and a verdict is kept for a
/// repeated run. Events of the simulated rig do not take part, but those that change its payload.
///
/// Takes a tenth of a second a payload and law. Not real-time safe. Thread: one at a time.
class RunJudge {
 public:
  /// The config with another law. @throws std::exception if it cannot have it
  using WithLaw = std::function<RigConfig(const RigConfig& config, const std::string& law)>;

  /// An arm that stands nearer than this to where it stood gets the same verdict: rad.
  static constexpr double kSamePlace_rad = 0.01;

  /// @param with_law  empty: an objection names no other law
  RunJudge(RigConfig config, WithLaw with_law)
      : config_(std::move(config)), with_law_(std::move(with_law)) {}

  /// @returns why the experiment should not run; nothing: nothing speaks against it
  /// @throws RejectedError if the law cannot plan it, or a stop is requested
  std::optional<UnmetCondition> Judge(const Experiment& experiment,
                                      const std::array<double, 2>& start_rad,
                                      const std::stop_token& stop = {});

 private:
  struct Case {
    const Experiment* experiment;
    std::array<double, 2> start_rad;
    std::vector<double> payload_kg;
    const std::stop_token* stop;
  };
  struct Verdict {
    std::string text;  ///< of the experiment
    std::array<double, 2> start_rad;
    std::optional<UnmetCondition> objection;
  };

  std::optional<UnmetCondition> Find(const Case& judged) const;
  /// How a run trips; "": it completes. @throws RejectedError
  std::string Trips(const RigConfig& config, const Case& judged) const;
  /// "controller.name = \"gain-scheduled\" works", or why none does.
  std::string OtherLaw(const Case& judged) const;
  /// Why a law does not run the experiment; "": it does.
  std::string WhyNot(ControllerKind law, const Case& judged) const;

  RigConfig config_;
  WithLaw with_law_;
  std::deque<Verdict> kept_;  // the newest last
};

}  // namespace flexarm
