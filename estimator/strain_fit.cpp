#include "estimator/strain_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "estimator/polynomial_fit.h"
#include "estimator/root_strain.h"
#include "model/beam/link_modes.h"

namespace flexarm {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr int kMaxOutliersPerLink = 2;

// Smallest determinant of the normalised normal equations at which two modes are separable: the
// squared sine of the angle between the two columns.
constexpr double kMinSeparation = 1e-4;

// Of a set of channels that is not empty.
std::size_t LowestBit(std::uint32_t channels) noexcept {
  return static_cast<std::size_t>(std::countr_zero(channels));
}

}  // namespace

StrainFit::StrainFit(const ArmParameters& arm, const SensorConfig& sensors,
                     const EstimatorConfig& config)
    : modes_(config.modes_per_link),
      channels_(static_cast<int>(sensors.strain.size())),
      lowest_count_(sensors.strain_input.lowest_count()),
      highest_count_(sensors.strain_input.highest_count()),
      family_limit_(config.strain_family_limit),
      stuck_limit_(config.strain_stuck_limit) {
  const std::array<LinkModes, 2> modes = {Link1Modes(arm, modes_), Link2Modes(arm, modes_)};
  const double counts_variance =
      sensors.strain_input.noise_counts * sensors.strain_input.noise_counts + 1.0 / 12.0;
  const auto shape = [&](std::size_t link, std::size_t j, double x_m) {
    return arm.link[link].HalfThicknessAt_m(x_m) * modes[link].mode[j].Curvature(x_m);
  };
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    const StrainChannelConfig& row = sensors.strain[i];
    Channel& c = channel_[i];
    c.link = row.link - 1;
    link_mask_[static_cast<std::size_t>(c.link)] |= std::uint32_t{1} << i;
    c.config = StrainScaleOf(sensors, i);
    const double unit = c.config.unit_per_count;
    c.weight = 1.0 / (counts_variance * unit * unit);
    for (std::size_t j = 0; j < static_cast<std::size_t>(modes_); ++j) {
      c.shape[j] = shape(static_cast<std::size_t>(c.link), j, row.position_m);
    }
    c.spread = {c.shape[0] * c.shape[0], c.shape[1] * c.shape[1], 2.0 * c.shape[0] * c.shape[1]};
    c.weighted = {c.weight * c.shape[0], c.weight * c.shape[1]};
    c.normal = {c.weighted[0] * c.shape[0], c.weighted[0] * c.shape[1], c.weighted[1] * c.shape[1]};
  }
  for (std::size_t link = 0; link < 2; ++link) {
    root_shape_[link] = RootStrainShape(arm.link[link], modes[link]);
    const int count = std::popcount(LinkMask(static_cast<int>(link)));
    gauges_needed_[link] = std::min(modes_ + 1, count);
  }
  // Columns of the pseudo-inverse: the fit to a unit strain on one channel, with all channels used.
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    std::array<double, kMaxStrainChannels> unit{};
    unit[i] = 1.0;
    std::array<double, 4> modal{};
    Variance variance{};
    if (!Solve(channel_[i].link, LinkMask(channel_[i].link), unit, &modal, &variance)) continue;
    constexpr double kMost = kMostSpread * kMostSpread;
    most_[static_cast<std::size_t>(channel_[i].link)] = {
        .modal_m2 = {kMost * variance.modal_m2[0], kMost * variance.modal_m2[1]},
        .root = kMost * variance.root};
    of_all_[static_cast<std::size_t>(channel_[i].link)] = variance;
    solvable_[static_cast<std::size_t>(channel_[i].link)] = true;
    const std::size_t first = channel_[i].link == 0 ? 0 : 2;
    channel_[i].inverse = {modal[first], modal[first + 1]};
  }
  if (config.kind == EstimatorKind::kPolynomial) FitPolynomials(arm, sensors, modes);
  Reset({});
}

void StrainFit::FitPolynomials(const ArmParameters& arm, const SensorConfig& sensors,
                               const std::array<LinkModes, 2>& modes) {
  for (std::size_t link = 0; link < 2; ++link) {
    std::vector<StrainStation> stations;
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
      if (channel_[i].link != static_cast<int>(link)) continue;
      const double x_m = sensors.strain[i].position_m;
      stations.push_back({.position_m = x_m,  // start-up
                          .half_thickness_m = arm.link[link].HalfThicknessAt_m(x_m),
                          .weight = channel_[i].weight});
      rows.push_back(i);  // start-up
    }
    const Eigen::MatrixXd map = PolynomialModalMap(modes[link], stations, modes_);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      for (int j = 0; j < modes_; ++j) {
        channel_[rows[k]].inverse[static_cast<std::size_t>(j)] =
            map(j, static_cast<Eigen::Index>(k));
      }
    }
    of_all_[link] =
        {};  // no least squares: a channel is judged by its distance from the polynomial
  }
}

void StrainFit::Reset(const Calibration& calibration) noexcept {
  last_modal_ = {};
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels_); ++i) {
    Channel& c = channel_[i];
    c.seen = false;
    c.scale = Calibrated(c.config, calibration, i);
  }
}

double StrainFit::Predicted(const Channel& channel,
                            const std::array<double, 4>& modal) const noexcept {
  const std::size_t first = channel.link == 0 ? 0 : 2;
  return channel.shape[0] * modal[first] + channel.shape[1] * modal[first + 1];
}

// Weighted normal equations [a b; b c] f = [d; e] over the used channels of a link.
bool StrainFit::Solve(int link, std::uint32_t used,
                      const std::array<double, kMaxStrainChannels>& strain,
                      std::array<double, 4>* modal, Variance* variance) const noexcept {
  double a = 0.0, b = 0.0, c = 0.0, d = 0.0, e = 0.0;
  for (std::uint32_t left = used & LinkMask(link); left != 0; left &= left - 1) {
    const std::size_t i = LowestBit(left);
    const Channel& channel = channel_[i];
    a += channel.normal[0];
    b += channel.normal[1];
    c += channel.normal[2];
    d += channel.weighted[0] * strain[i];
    e += channel.weighted[1] * strain[i];
  }
  const std::size_t first = link == 0 ? 0 : 2;
  const std::array<double, 2>& root = root_shape_[static_cast<std::size_t>(link)];
  if (!(a > 0.0)) return false;
  if (modes_ == 1) {
    (*modal)[first] = d / a;
    *variance = {.modal_m2 = {1.0 / a, 0.0}, .root = root[0] * root[0] / a};
    return true;
  }
  const double determinant = a * c - b * b;
  if (!(determinant > kMinSeparation * a * c)) return false;
  (*modal)[first] = (c * d - b * e) / determinant;
  (*modal)[first + 1] = (a * e - b * d) / determinant;
  *variance = {
      .modal_m2 = {c / determinant, a / determinant},
      .root = (root[0] * root[0] * c - 2.0 * root[0] * root[1] * b + root[1] * root[1] * a) /
              determinant,
      .modal_covariance_m2 = -b / determinant};
  return true;
}

// False for NaN.
bool StrainFit::Determines(std::size_t link, std::uint32_t used,
                           const Variance& variance) const noexcept {
  const Variance& most = most_[link];
  return std::popcount(used & LinkMask(static_cast<int>(link))) >= gauges_needed_[link] &&
         variance.modal_m2[0] <= most.modal_m2[0] && variance.modal_m2[1] <= most.modal_m2[1] &&
         variance.root <= most.root;
}

// A bridge that is open reads the end of its range too, but the others do not bend with it.
double StrainFit::BeyondRange(std::uint32_t saturated,
                              const std::array<double, kMaxStrainChannels>& strain,
                              const std::array<double, 4>& modal) const noexcept {
  constexpr double kConfirmed = 0.9;  // of the end: the fit of few gauges is not exact beyond them
  double most = 0.0;
  for (std::uint32_t left = saturated; left != 0; left &= left - 1) {
    const std::size_t i = LowestBit(left);
    const double end = std::fabs(strain[i]);
    const double bent = std::copysign(1.0, strain[i]) * Predicted(channel_[i], modal);
    if (bent >= kConfirmed * end && end > most) most = end;
  }
  return most;
}

FittedModes StrainFit::Fit(const SensorFrame& frame, std::int64_t instant_ns,
                           const std::array<double, 4>& modal_rate_m_s) noexcept {
  const std::int64_t age_ns = instant_ns - frame.sampled_at_ns;
  FittedModes out{};
  out.root_strain.fill(kUnknown);
  std::array<double, kMaxStrainChannels> strain{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels_); ++i) {
    const std::uint32_t bit = std::uint32_t{1} << i;
    if ((frame.strain_valid & bit) == 0) continue;
    const std::int32_t raw = frame.strain[i];
    strain[i] = StrainOf(channel_[i].scale, raw);
    if (raw <= lowest_count_ || raw >= highest_count_) {
      out.saturated |= bit;
      continue;
    }
    const std::int64_t late_ns = frame.strain_offset_ns[i] - age_ns;
    if (late_ns != 0) {
      strain[i] -= 1e-9 * static_cast<double>(late_ns) * Predicted(channel_[i], modal_rate_m_s);
    }
    out.used |= bit;
  }
  out.modal_m = last_modal_;
  for (int link = 0; link < 2; ++link) FitLink(link, strain, &out);
  const std::uint32_t repeats = JudgeStuck(frame, strain, &out);
  for (int link = 0; link < 2; ++link) {  // fit again without the stuck channels
    const std::uint32_t stuck = out.stuck & out.used & LinkMask(link);
    if (stuck == 0) continue;
    const std::size_t i = static_cast<std::size_t>(link);
    out.used &= ~stuck;
    out.valid[i] = false;
    out.beyond_range[i] = 0.0;
    out.root_strain[i] = kUnknown;
    out.modal_m[2 * i] = last_modal_[2 * i];
    out.modal_m[2 * i + 1] = last_modal_[2 * i + 1];
    FitLink(link, strain, &out);
  }
  for (int link = 0; link < 2; ++link) {
    const std::uint32_t used = out.used & LinkMask(link);
    out.gauges[static_cast<std::size_t>(link)] = std::popcount(used);
    out.repeated[static_cast<std::size_t>(link)] = (used & ~repeats) == 0 ? used : 0;
  }
  last_modal_ = out.modal_m;
  return out;
}

double StrainFit::OfTheOthers(const Channel& channel, const Variance& variance) const noexcept {
  constexpr double kAlone = 1e-6;
  const double spread = channel.spread[0] * variance.modal_m2[0] +
                        channel.spread[1] * variance.modal_m2[1] +
                        channel.spread[2] * variance.modal_covariance_m2;
  const double rest = 1.0 - channel.weight * spread;
  return rest > kAlone ? rest : 0.0;
}

double StrainFit::ShownOfError(std::size_t channel) const noexcept {
  const Channel& c = channel_[channel];
  const double rest = OfTheOthers(c, of_all_[static_cast<std::size_t>(c.link)]);
  const double followed = c.shape[0] * c.inverse[0] + c.shape[1] * c.inverse[1];
  return rest > 0.0 ? (1.0 - followed) / std::sqrt(rest) : 0.0;
}

// Without channel i the weighted sum of squares falls by w d^2 / (1 - h), with its distance d from
// the fit and its leverage h: the square of its studentised distance.
StrainFit::Suspect StrainFit::SuspectOf(int link, std::uint32_t used,
                                        const std::array<double, kMaxStrainChannels>& strain,
                                        const std::array<double, 4>& modal,
                                        const Variance& variance, double* residual) const noexcept {
  Suspect suspect{};
  double most = 0.0, sum = 0.0;
  int count = 0;
  for (std::uint32_t left = used & LinkMask(link); left != 0; left &= left - 1) {
    const std::size_t i = LowestBit(left);
    const Channel& channel = channel_[i];
    const double distance = std::fabs(strain[i] - Predicted(channel, modal));
    sum += distance * distance;
    ++count;
    const double rest = OfTheOthers(channel, variance);
    if (rest == 0.0) continue;
    const double falls = channel.weight * distance * distance / rest;
    if (!(falls > most)) continue;
    most = falls;
    suspect = {.bit = std::uint32_t{1} << i, .apart = distance / std::sqrt(rest)};
  }
  *residual = std::sqrt(sum / count);
  return suspect;
}

void StrainFit::FitLink(int link, const std::array<double, kMaxStrainChannels>& strain,
                        FittedModes* out) noexcept {
  const std::uint32_t all = LinkMask(link);
  const std::size_t at = static_cast<std::size_t>(link), first = link == 0 ? 0 : 2;
  std::array<double, 4> modal{};
  for (int removed = 0;; ++removed) {
    Variance variance = of_all_[at];
    if ((out->used & all) == all && solvable_[at]) {
      modal[first] = modal[first + 1] = 0.0;
      for (std::uint32_t left = all; left != 0; left &= left - 1) {
        const std::size_t i = LowestBit(left);
        modal[first] += channel_[i].inverse[0] * strain[i];
        modal[first + 1] += channel_[i].inverse[1] * strain[i];
      }
    } else {
      if (!Solve(link, out->used, strain, &modal, &variance)) return;
      if (!Determines(at, out->used, variance)) {
        out->beyond_range[at] = BeyondRange(out->saturated & all, strain, modal);
        return;
      }
    }
    const Suspect suspect = SuspectOf(link, out->used, strain, modal, variance, &out->residual[at]);
    if (suspect.apart <= family_limit_ || removed == kMaxOutliersPerLink) break;
    out->outlier |= suspect.bit;
    out->used &= ~suspect.bit;
    out->worst_outlier = std::fmax(out->worst_outlier, suspect.apart);
  }
  const double root_strain = RootStrain(static_cast<std::size_t>(link), modal);
  if (!std::isfinite(root_strain)) return;  // a gain or zero that is not a number
  out->valid[static_cast<std::size_t>(link)] = true;
  out->modal_m[first] = modal[first];
  out->modal_m[first + 1] = modal[first + 1];
  out->root_strain[static_cast<std::size_t>(link)] = root_strain;
}

bool StrainFit::SeesStuck(std::size_t link, std::uint32_t used,
                          const Variance& variance) const noexcept {
  return std::popcount(used) >= gauges_needed_[link] &&
         variance.root <= stuck_limit_ * stuck_limit_ / 100.0;
}

bool StrainFit::OthersMoved(const Channel& channel, std::uint32_t others,
                            const std::array<double, kMaxStrainChannels>& strain) const noexcept {
  const std::uint32_t both = others & channel.used_at_change & LinkMask(channel.link);
  std::array<double, kMaxStrainChannels> change{};
  for (std::uint32_t left = both; left != 0; left &= left - 1) {
    const std::size_t i = LowestBit(left);
    change[i] = strain[i] - channel.all_at_change[i];
  }
  std::array<double, 4> modal{};
  Variance variance{};
  if (!Solve(channel.link, both, change, &modal, &variance)) return true;
  if (!SeesStuck(static_cast<std::size_t>(channel.link), both, variance)) return true;
  return std::fabs(Predicted(channel, modal)) > stuck_limit_;
}

// A channel is stuck when its raw value has not changed while the bending at its station has moved
// by more than the limit. Stuck channels pull the fit with them, a pair near the root by more than
// half: the bending is that of the link's other channels, without all that repeat their value in
// this sample, if their noise moves it by a tenth of the limit at most.
// The strain that the others predict now and that of the fit when the channel changed come from
// different channels: where the link bends in more than its fitted modes, they differ though
// nothing moves.
std::uint32_t StrainFit::JudgeStuck(const SensorFrame& frame,
                                    const std::array<double, kMaxStrainChannels>& strain,
                                    FittedModes* out) noexcept {
  std::uint32_t repeats = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels_); ++i) {
    const Channel& c = channel_[i];
    if (c.seen && frame.strain[i] == c.last_raw) repeats |= std::uint32_t{1} << i;
  }
  repeats &= frame.strain_valid;
  std::array<double, 4> modal = out->modal_m;
  for (int link = 0; link < 2; ++link) {
    const std::uint32_t others = out->used & LinkMask(link) & ~repeats;
    std::array<double, 4> apart = modal;
    Variance variance{};
    const bool solved = Solve(link, others, strain, &apart, &variance);
    if (solved && SeesStuck(static_cast<std::size_t>(link), others, variance)) modal = apart;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels_); ++i) {
    if ((frame.strain_valid >> i & 1U) == 0) continue;  // what is there is no reading
    Channel& c = channel_[i];
    const double bent = Predicted(c, modal);
    if (!c.seen || frame.strain[i] != c.last_raw) {
      c.seen = true;
      c.last_raw = frame.strain[i];
      c.strain_at_change = bent;
      c.all_at_change = strain;
      c.used_at_change = out->used;
    } else if (std::fabs(bent - c.strain_at_change) > stuck_limit_ &&
               OthersMoved(c, out->used & ~repeats, strain)) {
      out->stuck |= std::uint32_t{1} << i;
    }
  }
  return repeats;
}

}  // namespace flexarm
