#include "controller/commissioning/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "controller/runlog/csv.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

constexpr double kSteadySigmas = 6.0;
constexpr double kQuantisation = 0.29;  // 1/sqrt(12) counts, quantisation noise of a converter
constexpr double kStill_deg =
    0.1;  // largest motion of a joint while it is zeroed; at least one count
constexpr double kSmallestStrain_counts = 20.0;
// A bus that loses more than this share of its frames is to be mended first. Fewer do no harm: the
// readings that came are enough for a mean, and show that the arm is still.
constexpr double kMostMissing = 0.2;

// Collects problems, one per line.
class Findings {
 public:
  explicit Findings(std::string what) : what_(std::move(what)) {}
  void Add(const std::string& channel, const std::string& problem) {
    text_ += "\n  " + channel + ": " + problem;
  }
  void RefuseIfAny() const {
    if (!text_.empty()) throw RejectedError(what_ + text_);
  }

 private:
  std::string what_;
  std::string text_;
};

// Adds a finding if too few readings came.
bool CheckRead(int missing, int ticks, const std::string& name, Findings* findings) {
  const int allowed = static_cast<int>(kMostMissing * ticks);
  if (missing < ticks && missing <= allowed) return true;
  findings->Add(name, missing == ticks
                          ? std::string("was not read")
                          : fmt::format("{} of {} readings are missing, at most {} may be: look at "
                                        "`buses` of `flexarm status`",
                                        missing, ticks, allowed));
  return false;
}

// Checks for missing and unsteady readings. True if the channel can be used.
bool CheckSteady(const SensorConfig& sensors, const RestReadings& readings, std::size_t i,
                 const std::string& name, Findings* findings) {
  if (!CheckRead(readings.strain_missing[i], readings.ticks, name, findings)) return false;
  const double expected = std::hypot(sensors.strain_input.noise_counts, kQuantisation);
  if (readings.strain_sigma[i] > kSteadySigmas * expected) {
    findings->Add(
        name,
        fmt::format("varies by {:.1f} counts (standard deviation); at rest {:.1f} are expected",
                    readings.strain_sigma[i], expected));
    return false;
  }
  return true;
}

double CountsPerUnit(const SensorConfig& sensors, const StrainChannelConfig& row) {
  return row.face * row.gain_v_per_unit / sensors.strain_input.volts_per_count();
}

const BeamSection& SectionAt(const LinkParameters& link, double x_m) {
  double end_m = 0.0;
  for (const BeamSection& section : link.section) {
    end_m += section.length_m;
    if (x_m <= end_m) return section;
  }
  return link.section.back();
}

}  // namespace

Calibration Tare(const SensorConfig& sensors, const RestReadings& readings, Calibration before) {
  Findings findings("the strain channels cannot be tared:");
  const std::vector<std::string> names = StrainColumns(sensors);
  const double largest = kLargestZero * sensors.strain_input.highest_count();
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    if (!CheckSteady(sensors, readings, i, names[i], &findings)) continue;
    const double zero = readings.strain_mean[i] - sensors.strain[i].offset_counts;
    if (std::fabs(zero) > largest) {
      findings.Add(names[i],
                   fmt::format("is {:.0f} counts from its zero, more than {:.0f}: a gauge under "
                               "load, a broken bridge, or a wrong word order",
                               zero, largest));
    }
    before.strain_zero_counts[i] = static_cast<float>(zero);
  }
  findings.RefuseIfAny();
  return before;
}

Calibration Zero(const SensorConfig& sensors, const RestReadings& readings,
                 const std::array<double, 2>& hub_rad, Calibration before) {
  Findings findings("the encoders cannot be zeroed:");
  for (const EncoderConfig& encoder : sensors.encoder) {
    const auto i = static_cast<std::size_t>(encoder.counter);
    const double allowed = std::max(1.0, kStill_deg / 360.0 * encoder.counts_per_turn);
    const std::string name = CounterName(encoder.counter);
    if (!CheckRead(readings.counter_missing[i], readings.ticks, name, &findings)) continue;
    if (static_cast<double>(readings.travel_counts[i]) > allowed) {
      findings.Add(
          name, fmt::format("moved by {:.0f} counts; at rest at most {:.0f} are allowed",
                            static_cast<double>(readings.travel_counts[i]), std::floor(allowed)));
    }
    const double counts_at_angle =
        encoder.sign * hub_rad[i % 2] * encoder.counts_per_turn / (2.0 * std::numbers::pi);
    before.counter_zero[i] = readings.counts[i] - std::llround(counts_at_angle);
  }
  findings.RefuseIfAny();
  return before;
}

std::string OutOfRange(const SensorConfig& sensors, const Calibration& calibration) {
  const auto told = [](const std::string& channel, const char* name, double value, double most) {
    return fmt::format("{}: {} = {:g}, expected {:g} to {:g}", channel, name, value, -most, most);
  };
  // Single precision may round the largest values that `tare` and `calibrate` accept upwards.
  constexpr double kRounding = 1.0 + 1e-6;
  constexpr double kMostTurns = 2.0;  // to the angle that was stated, and since the start
  const std::vector<std::string> names = StrainColumns(sensors);
  const double most_counts = kLargestZero * sensors.strain_input.highest_count();
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    const double zero = static_cast<double>(calibration.strain_zero_counts[i]);
    const double gain = static_cast<double>(calibration.strain_gain_error[i]);
    if (!(std::fabs(zero) <= most_counts * kRounding)) {
      return told(names[i], "zero_counts", zero, most_counts);
    }
    if (!(std::fabs(gain) <= kLargestGainError * kRounding)) {
      return told(names[i], "gain_error", gain, kLargestGainError);
    }
  }
  for (const EncoderConfig& encoder : sensors.encoder) {
    const auto zero =
        static_cast<double>(calibration.counter_zero[static_cast<std::size_t>(encoder.counter)]);
    const double most =
        std::ldexp(1.0, encoder.counter_bits) + kMostTurns * encoder.counts_per_turn;
    if (std::fabs(zero) > most)
      return told(CounterName(encoder.counter), "zero_counts", zero, most);
  }
  return {};
}

double StaticStrain(const LinkParameters& link, const StaticLoad& load, double x_m) {
  if (x_m >= load.at_m) return 0.0;
  const BeamSection& section = SectionAt(link, x_m);
  const double EI = section.bending_stiffness_nm2();
  return section.half_thickness_m * load.force_n * (load.at_m - x_m) / EI;
}

Calibration GainCalibration::Add(const StaticLoad& load, const RestReadings& readings,
                                 Calibration before) {
  Findings findings("the strain gains cannot be calibrated with this load:");
  const std::vector<std::string> names = StrainColumns(sensors_);
  std::array<Sums, kMaxStrainChannels> sums = sums_;
  bool learned = false;
  for (std::size_t i = 0; i < sensors_.strain.size(); ++i) {
    const StrainChannelConfig& row = sensors_.strain[i];
    if (row.link != load.link || !CheckSteady(sensors_, readings, i, names[i], &findings)) continue;
    const LinkParameters& link = arm_.link[static_cast<std::size_t>(row.link - 1)];
    const double expected = CountsPerUnit(sensors_, row) * StaticStrain(link, load, row.position_m);
    if (std::fabs(expected) < kSmallestStrain_counts) continue;
    const double measured = readings.strain_mean[i] - row.offset_counts -
                            static_cast<double>(before.strain_zero_counts[i]);
    sums[i].expected_squared += expected * expected;
    sums[i].expected_times_measured += expected * measured;
    const double error = sums[i].expected_times_measured / sums[i].expected_squared - 1.0;
    if (std::fabs(error) > kLargestGainError) {
      findings.Add(names[i], fmt::format("reads {:.0f} counts, but the load gives {:.0f}", measured,
                                         expected));
    }
    before.strain_gain_error[i] = static_cast<float>(error);
    learned = true;
  }
  findings.RefuseIfAny();
  if (!learned) {
    throw RejectedError("this load strains no channel of link " + std::to_string(load.link) +
                        " by 20 counts: use a larger load, or apply it further from the joint");
  }
  sums_ = sums;
  return before;
}

}  // namespace flexarm
