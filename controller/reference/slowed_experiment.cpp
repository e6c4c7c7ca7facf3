#include "controller/reference/slowed_experiment.h"

#include <cmath>
#include <string>

#include "controller/reference/sampling_grid.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

constexpr double kRounding = 1e-6;  // of decimal times, in periods

class Stretch {
 public:
  Stretch(double speed, double period_s) : speed_(speed), period_s_(period_s) {}

  // The next instant of the grid; in multiples of `unit` periods.
  double operator()(double time_s, int unit = 1) const {
    const double units = time_s / speed_ / period_s_ / unit;
    return InSeconds(unit * static_cast<int>(std::ceil(units - kRounding)), period_s_);
  }

 private:
  double speed_, period_s_;
};

void RefuseSignals(const Experiment& experiment) {
  std::string row;
  if (!experiment.chirp.empty()) row = "chirp[0]";
  if (!experiment.prbs.empty()) row = "prbs[0]";
  if (experiment.csv) row = "csv";
  if (row.empty()) return;
  throw RejectedError("speed_percent: " + row +
                      " is a signal in time, only moves and doublets can be slowed");
}

}  // namespace

Experiment Slowed(Experiment experiment, double speed, double period_s) {
  RefuseSignals(experiment);
  const Stretch stretched(speed, period_s);
  for (Doublet& doublet : experiment.doublet) {
    doublet.start_s = stretched(doublet.start_s);
    doublet.duration_s = stretched(doublet.duration_s, 2);
  }
  for (Move& move : experiment.move) {
    move.start_s = stretched(move.start_s);
    if (move.duration_s) move.duration_s = stretched(*move.duration_s);
  }
  for (LoadChange& change : experiment.load_change) change.at_s = stretched(change.at_s);
  for (SimEvent& event : experiment.sim_event) event.at_s /= speed;
  experiment.duration_s = stretched(experiment.duration_s);
  experiment.speed = 1.0;
  if (experiment.duration_s <= kLongestRun_s) return experiment;
  throw RejectedError("speed_percent: the run would take longer than an hour");
}

}  // namespace flexarm
