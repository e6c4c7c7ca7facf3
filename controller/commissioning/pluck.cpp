#include "controller/commissioning/pluck.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/commissioning/pluck_model.h"
#include "controller/runlog/csv.h"

namespace flexarm {
namespace {

constexpr double kLead_s = 0.2;            // at rest, for the zero of every channel
constexpr double kProvable_counts = 8.0;   // a smaller motion is not conclusive
constexpr double kSilent = 0.15;           // of the expected motion
constexpr double kGoodMatch = 0.8;         // share explained: the motion belongs to this channel
constexpr double kHubAgainstRotor = 0.06;  // relative: they differ by the torsion of the joint only
constexpr double kLinkShare = 0.01;        // of a link's largest strain: allowance for noise

struct Answer {
  double gain = 0.0;
  double match = 0.0;
};

// gain = <m, e> / <e, e>; match = 1 - |m - gain e|^2 / |m|^2.
Answer Compare(const Eigen::VectorXd& measured, const Eigen::VectorXd& expected) {
  const double energy = expected.squaredNorm(), moved = measured.squaredNorm();
  if (!(energy > 0.0) || !(moved > 0.0)) return {};
  const double gain = measured.dot(expected) / energy;
  return {.gain = gain, .match = 1.0 - (measured - gain * expected).squaredNorm() / moved};
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

int Samples(double time_s, double period_s) {
  return static_cast<int>(std::lround(time_s / period_s));
}

class Judge {
 public:
  Judge(const RigConfig& config, const std::vector<TickRecord>& run)
      : config_(config), limits_(config.commissioning), names_(StrainColumns(config.sensors)) {
    const double period_s = config.loop.period_s();
    const Eigen::Index lead = Samples(kLead_s, period_s);
    pulse_ = Samples(limits_.pluck_pulse_s, period_s);
    const Eigen::Index rest = Samples(limits_.pluck_rest_s, period_s);
    const auto size = static_cast<Eigen::Index>(run.size());
    for (Eigen::Index joint = 0; joint < 2; ++joint) {
      const Eigen::Index first = std::min(lead + joint * (pulse_ + rest), size);
      // The oscillation after a pulse carries as much information as the pulse, but friction and
      // damping, which are not known well, accumulate in it: half a pulse is enough.
      window_[static_cast<std::size_t>(joint)] = {
          first, std::min(first + pulse_ + std::min(pulse_ / 2, rest), size) - first};
      complete_[static_cast<std::size_t>(joint)] = size >= first + pulse_;
    }
    measured_ = MeasuredMotion(config, run);
    expected_ = ExpectedMotion(config, run, false);
    if (DrivesExchanged(run)) {
      Find("drive1, drive2", "are exchanged: each drives the other joint");
      expected_ = ExpectedMotion(config, run, true);
    }
  }

  PluckVerdict Run() {
    // A faulty drive moves the arm differently from the model, so the motion after its pulse
    // contains no information about the sensors.
    while (sound_drives_ < 2 && JudgeDrive(sound_drives_)) ++sound_drives_;
    JudgeEncoders();
    for (int link = 1; link <= 2; ++link) JudgeLink(link);
    return std::move(verdict_);
  }

 private:
  struct Window {
    Eigen::Index first = 0, count = 0;
  };

  void Find(const std::string& channel, const std::string& problem) {
    verdict_.finding.push_back({channel, problem});
  }

  Eigen::VectorXd Part(const PluckMotion& motion, Eigen::Index column, std::size_t joint) const {
    return motion.col(column).segment(window_[joint].first, window_[joint].count);
  }

  static Eigen::Index StrainColumn(std::size_t channel) {
    return kCounters + static_cast<Eigen::Index>(channel);
  }

  double CountsPerUnit(Eigen::Index column) const {
    if (column < kCounters) {
      for (const EncoderConfig& encoder : config_.sensors.encoder) {
        if (encoder.counter == column) return encoder.counts_per_turn / (2.0 * std::numbers::pi);
      }
      return 0.0;
    }
    const StrainChannelConfig& row =
        config_.sensors.strain[static_cast<std::size_t>(column - kCounters)];
    return std::fabs(row.gain_v_per_unit) / config_.sensors.strain_input.volts_per_count();
  }

  bool Provable(Eigen::Index column, std::size_t joint) const {
    if (window_[joint].count < 2) return false;
    return Part(expected_, column, joint).cwiseAbs().maxCoeff() * CountsPerUnit(column) >=
           kProvable_counts;
  }

  // The channels that respond to a joint's own pulse: its hub, its rotor, the gauges of its link.
  std::vector<Eigen::Index> Witnesses(std::size_t joint) const {
    std::vector<Eigen::Index> columns;
    for (const EncoderConfig& encoder : config_.sensors.encoder) {
      if (encoder.counter % 2 == static_cast<int>(joint)) columns.push_back(encoder.counter);
    }
    for (std::size_t i = 0; i < config_.sensors.strain.size(); ++i) {
      if (config_.sensors.strain[i].link == static_cast<int>(joint) + 1) {
        columns.push_back(StrainColumn(i));
      }
    }
    return columns;
  }

  // Mean match of all channels over the whole run.
  double OverallMatch(const PluckMotion& expected) const {
    double sum = 0.0;
    int count = 0;
    for (Eigen::Index column = 0; column < expected.cols(); ++column) {
      if (measured_.col(column).isZero()) continue;
      sum += Compare(measured_.col(column), expected.col(column)).match;
      ++count;
    }
    return count > 0 ? sum / count : 0.0;
  }

  bool DrivesExchanged(const std::vector<TickRecord>& run) const {
    const double as_wired = OverallMatch(expected_);
    if (as_wired > kGoodMatch) return false;
    const double exchanged = OverallMatch(ExpectedMotion(config_, run, true));
    return exchanged > kGoodMatch && exchanged > as_wired;
  }

  // Median of three gains: hub, rotor, and all gauges of the link together. One faulty channel does
  // not change the result much.
  bool JudgeDrive(std::size_t joint) {
    const std::string drive = "drive" + std::to_string(joint + 1);
    if (!complete_[joint]) Find(drive, "was not tested: the test ended before its pulse");
    if (2 * window_[joint].count < pulse_) return false;
    std::vector<double> votes, gauges;
    double match = 0.0;
    for (const Eigen::Index column : Witnesses(joint)) {
      if (!Provable(column, joint)) continue;
      const Answer answer = Compare(Part(measured_, column, joint), Part(expected_, column, joint));
      match = std::max(match, answer.match);
      (column < kCounters ? votes : gauges).push_back(answer.gain);
    }
    if (!gauges.empty()) votes.push_back(Median(gauges));
    const double gain = Median(votes);
    drive_gain_[joint] = gain;
    verdict_.answer.push_back({drive, gain, match, !votes.empty()});
    if (votes.empty()) {
      Find(drive,
           "the pulse moves no channel by 8 counts: commissioning.pluck_torque_nm is too small");
    } else if (votes.size() == 2 && votes[0] * votes[1] < 0.0) {
      Find(CounterName(static_cast<int>(joint)) + std::string(", strain_") +
               std::to_string(joint + 1) + "_*",
           "contradict each other: one of them has the wrong sign");
    } else if (std::fabs(gain) < kSilent) {
      Find(drive, "does not move the joint: no power, no torque, or a blocked joint");
    } else if (gain < 0.0) {
      Find(drive, "moves the joint in the wrong direction: its sign is inverted");
    } else if (std::fabs(gain - 1.0) > limits_.motion_tolerance) {
      Find(
          drive,
          fmt::format(
              "moves the arm {:.2f} times as far as the model (tolerance {:.2f}): check torque per "
              "volt or per mille, gear, or payload",
              gain, limits_.motion_tolerance));
    } else {
      return true;
    }
    return false;
  }

  // Gain of a channel relative to that of its drive, which has passed.
  double Relative(const Answer& answer, std::size_t joint) const {
    return answer.gain / drive_gain_[joint];
  }

  bool Judged(std::size_t joint) const { return joint < sound_drives_; }

  void JudgeEncoders() {
    std::array<double, kCounters> relative{};
    std::array<bool, kCounters> sound{};
    for (const EncoderConfig& encoder : config_.sensors.encoder) {
      const auto i = static_cast<std::size_t>(encoder.counter);
      const std::size_t joint = i % 2;
      const Answer answer =
          Compare(Part(measured_, encoder.counter, joint), Part(expected_, encoder.counter, joint));
      const bool provable = Provable(encoder.counter, joint);
      verdict_.answer.push_back(
          {CounterName(encoder.counter), answer.gain, answer.match, provable});
      if (!Judged(joint) || !provable) continue;
      relative[i] = Relative(answer, joint);
      sound[i] = JudgeEncoder(encoder, answer, relative[i]);
    }
    for (std::size_t joint = 0; joint < 2; ++joint) {
      if (!sound[joint] || !sound[joint + 2]) continue;
      const double ratio = relative[joint + 2] / relative[joint];
      if (std::fabs(ratio - 1.0) <= kHubAgainstRotor) continue;
      const bool rotor = std::fabs(relative[joint + 2] - 1.0) > std::fabs(relative[joint] - 1.0);
      Find(CounterName(static_cast<int>(rotor ? joint + 2 : joint)),
           fmt::format(
               "turns {:.3f} times as far as the joint's other encoder: check counts_per_turn",
               rotor ? ratio : 1.0 / ratio));
    }
  }

  bool JudgeEncoder(const EncoderConfig& encoder, const Answer& answer, double relative) {
    const char* name = CounterName(encoder.counter);
    const int other = OtherEncoder(encoder.counter);
    if (other >= 0 && answer.match < kGoodMatch) {
      Find(name,
           std::string("reads what ") + CounterName(other) + " should: the two are exchanged");
    } else if (std::fabs(relative) < kSilent) {
      Find(name, "does not move: not connected, or the wrong counter");
    } else if (relative < 0.0) {
      Find(name, "counts in the wrong direction: its sign is inverted");
    } else if (answer.match < kGoodMatch) {
      Find(name,
           fmt::format("does not follow the motion ({:.0f} % explained)", 100.0 * answer.match));
    } else if (std::fabs(relative - 1.0) > limits_.motion_tolerance) {
      Find(name,
           fmt::format(
               "turns {:.2f} times as far as the model (tolerance {:.2f}): check counts_per_turn",
               relative, limits_.motion_tolerance));
    } else {
      return true;
    }
    return false;
  }

  // The encoder of the other joint whose expected motion over both pulses matches, or -1.
  int OtherEncoder(int counter) const {
    for (const EncoderConfig& candidate : config_.sensors.encoder) {
      if (candidate.counter % 2 == counter % 2) continue;
      const Answer answer = Compare(measured_.col(counter), expected_.col(candidate.counter));
      if (answer.match > kGoodMatch) return candidate.counter;
    }
    return -1;
  }

  struct Gauge {
    std::size_t channel = 0;
    double amplitude = 0.0;  // rms of the expected motion
    double relative = 0.0;   // gain relative to the drive's
    bool suspect = false;
  };

  void JudgeLink(int link) {
    const auto joint = static_cast<std::size_t>(link - 1);
    std::vector<Gauge> gauges;
    std::vector<double> gains;
    for (std::size_t i = 0; i < config_.sensors.strain.size(); ++i) {
      if (config_.sensors.strain[i].link != link) continue;
      const Eigen::Index column = StrainColumn(i);
      const Answer answer = Compare(Part(measured_, column, joint), Part(expected_, column, joint));
      const bool provable = Provable(column, joint);
      verdict_.answer.push_back({names_[i], answer.gain, answer.match, provable});
      if (!Judged(joint) || !provable) continue;
      const double relative = Relative(answer, joint);
      if (JudgeGauge(i, answer, relative)) continue;
      const double amplitude = Part(expected_, column, joint).norm();
      gauges.push_back({.channel = i, .amplitude = amplitude, .relative = relative});
      gains.push_back(relative);
    }
    JudgeFamily(link, Median(gains), &gauges);
  }

  // Checks one gauge without the others. True if a fault was found.
  bool JudgeGauge(std::size_t i, const Answer& answer, double relative) {
    const int link = config_.sensors.strain[i].link;
    if (answer.match < kGoodMatch && ReadsOtherLink(i)) {
      Find(names_[i], "bends with link " + std::to_string(3 - link) +
                          ": exchanged with a channel of that link");
    } else if (std::fabs(relative) < kSilent) {
      Find(names_[i], "does not move with its link: not connected, or the wrong channel");
    } else if (answer.match < kGoodMatch) {
      Find(names_[i],
           fmt::format("does not follow its link ({:.0f} % explained)", 100.0 * answer.match));
    } else if (relative < 0.0) {
      Find(names_[i], "is inverted: check its face and the polarity of its bridge");
    } else {
      return false;
    }
    return true;
  }

  bool ReadsOtherLink(std::size_t i) const {
    const int link = config_.sensors.strain[i].link;
    const Eigen::VectorXd measured = measured_.col(StrainColumn(i));
    for (std::size_t j = 0; j < config_.sensors.strain.size(); ++j) {
      if (config_.sensors.strain[j].link == link) continue;
      if (Compare(measured, expected_.col(StrainColumn(j))).match > kGoodMatch) return true;
    }
    return false;
  }

  // Compares the gauges of a link: the ratios of their strains follow from their positions alone.
  void JudgeFamily(int link, double family, std::vector<Gauge>* gauges) {
    if (gauges->empty()) return;
    if (std::fabs(family - 1.0) > limits_.motion_tolerance) {
      Find("strain_" + std::to_string(link) + "_*",
           fmt::format(
               "all read {:.2f} times the model (tolerance {:.2f}): check the amplifier's gain",
               family, limits_.motion_tolerance));
    }
    double largest = 0.0;
    for (const Gauge& g : *gauges) largest = std::max(largest, g.amplitude);
    const auto fits = [&](const Gauge& g, const Gauge& place) {
      return std::fabs(g.relative / family * g.amplitude - place.amplitude) <=
             limits_.gauge_tolerance * place.amplitude + kLinkShare * largest;
    };
    for (Gauge& g : *gauges) g.suspect = !fits(g, g);
    for (Gauge& g : *gauges) {
      if (!g.suspect) continue;
      const auto partner = std::find_if(gauges->begin(), gauges->end(), [&](const Gauge& other) {
        return &other != &g && other.suspect && fits(g, other) && fits(other, g);
      });
      if (partner != gauges->end()) {
        partner->suspect = false;
        Find(names_[g.channel] + ", " + names_[partner->channel], "are exchanged");
      } else {
        Find(names_[g.channel],
             fmt::format("reads {:.2f} times what the other gauges of its link imply (tolerance "
                         "{:.2f}): check its gain, its position and its channel",
                         g.relative / family, limits_.gauge_tolerance));
      }
      g.suspect = false;
    }
  }

  const RigConfig& config_;
  const CommissioningConfig& limits_;
  std::vector<std::string> names_;
  Eigen::Index pulse_ = 0;
  std::size_t sound_drives_ = 0;  // drives that passed, from joint 1 on
  std::array<Window, 2> window_;
  std::array<bool, 2> complete_{};
  std::array<double, 2> drive_gain_{};
  PluckMotion measured_, expected_;
  PluckVerdict verdict_;
};

}  // namespace

std::vector<std::array<double, 2>> PluckTorques(const CommissioningConfig& config,
                                                double period_s) {
  std::vector<std::array<double, 2>> torque(static_cast<std::size_t>(Samples(kLead_s, period_s)));
  const int half = std::max(Samples(0.5 * config.pluck_pulse_s, period_s), 1);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    for (int k = 0; k < 2 * half; ++k) {
      torque.push_back({});
      torque.back()[joint] = (k < half ? 1.0 : -1.0) * config.pluck_torque_nm[joint];
    }
    torque.resize(torque.size() + static_cast<std::size_t>(Samples(config.pluck_rest_s, period_s)));
  }
  return torque;
}

PluckVerdict JudgePluck(const RigConfig& config, const std::vector<TickRecord>& run) {
  return Judge(config, run).Run();
}

}  // namespace flexarm
