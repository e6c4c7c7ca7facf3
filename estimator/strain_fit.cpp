#include "estimator/strain_fit.h"

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

double HalfThicknessAt(const LinkParameters& link, double x_m) {
  double end = 0.0;
  for (const BeamSection& section : link.section) {
    end += section.length_m;
    if (x_m <= end) return section.half_thickness_m;
  }
  return link.section.back().half_thickness_m;
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
    return HalfThicknessAt(arm.link[link], x_m) * modes[link].mode[j].Curvature(x_m);
  };
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    const StrainChannelConfig& row = sensors.strain[i];
    Channel& c = channel_[i];
    c.link = row.link - 1;
    const double unit = row.face * sensors.strain_input.volts_per_count() / row.gain_v_per_unit;
    c.config_unit_per_count = unit;
    c.config_offset_counts = row.offset_counts;
    c.weight = 1.0 / (counts_variance * unit * unit);
    for (std::size_t j = 0; j < static_cast<std::size_t>(modes_); ++j) {
      c.shape[j] = shape(static_cast<std::size_t>(c.link), j, row.position_m);
    }
  }
  for (std::size_t link = 0; link < 2; ++link) {
    root_shape_[link] = RootStrainShape(arm.link[link], modes[link]);
  }
  // Columns of the pseudo-inverse: the fit to a unit strain on one channel, with all channels used.
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    std::array<double, kMaxStrainChannels> unit{};
    unit[i] = 1.0;
    std::array<double, 4> modal{};
    if (!Solve(channel_[i].link, LinkMask(channel_[i].link), unit, &modal)) continue;
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
                          .half_thickness_m = HalfThicknessAt(arm.link[link], x_m),
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
  }
}

void StrainFit::Reset(const Calibration& calibration) noexcept {
  last_modal_ = {};
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels_); ++i) {
    Channel& c = channel_[i];
    c.seen = false;
    c.unit_per_count =
        c.config_unit_per_count / (1.0 + static_cast<double>(calibration.strain_gain_error[i]));
    c.offset_counts =
        c.config_offset_counts + static_cast<double>(calibration.strain_zero_counts[i]);
  }
}

std::uint32_t StrainFit::LinkMask(int link) const noexcept {
  std::uint32_t mask = 0;
  for (int i = 0; i < channels_; ++i) {
    if (channel_[static_cast<std::size_t>(i)].link == link) mask |= std::uint32_t{1} << i;
  }
  return mask;
}

double StrainFit::Predicted(const Channel& channel,
                            const std::array<double, 4>& modal) const noexcept {
  const std::size_t first = channel.link == 0 ? 0 : 2;
  return channel.shape[0] * modal[first] + channel.shape[1] * modal[first + 1];
}

// Weighted normal equations [a b; b c] f = [d; e] over the used channels of a link.
bool StrainFit::Solve(int link, std::uint32_t used,
                      const std::array<double, kMaxStrainChannels>& strain,
                      std::array<double, 4>* modal) const noexcept {
  double a = 0.0, b = 0.0, c = 0.0, d = 0.0, e = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels_); ++i) {
    const Channel& channel = channel_[i];
    if (channel.link != link || (used >> i & 1u) == 0) continue;
    a += channel.weight * channel.shape[0] * channel.shape[0];
    b += channel.weight * channel.shape[0] * channel.shape[1];
    c += channel.weight * channel.shape[1] * channel.shape[1];
    d += channel.weight * channel.shape[0] * strain[i];
    e += channel.weight * channel.shape[1] * strain[i];
  }
  const std::size_t first = link == 0 ? 0 : 2;
  if (!(a > 0.0)) return false;
  if (modes_ == 1) {
    (*modal)[first] = d / a;
    return true;
  }
  const double determinant = a * c - b * b;
  if (!(determinant > kMinSeparation * a * c)) return false;
  (*modal)[first] = (c * d - b * e) / determinant;
  (*modal)[first + 1] = (a * e - b * d) / determinant;
  return true;
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
    if (raw <= lowest_count_ || raw >= highest_count_) {
      out.saturated |= bit;
      continue;
    }
    strain[i] = (static_cast<double>(raw) - channel_[i].offset_counts) * channel_[i].unit_per_count;
    const std::int64_t late_ns = frame.strain_offset_ns[i] - age_ns;
    if (late_ns != 0) {
      strain[i] -= 1e-9 * static_cast<double>(late_ns) * Predicted(channel_[i], modal_rate_m_s);
    }
    out.used |= bit;
  }
  out.modal_m = last_modal_;
  for (int link = 0; link < 2; ++link) FitLink(link, strain, &out);
  JudgeStuck(frame, &out);
  for (int link = 0; link < 2; ++link) {  // fit again without the stuck channels
    const std::uint32_t stuck = out.stuck & out.used & LinkMask(link);
    if (stuck == 0) continue;
    const std::size_t i = static_cast<std::size_t>(link);
    out.used &= ~stuck;
    out.valid[i] = false;
    out.root_strain[i] = kUnknown;
    out.modal_m[2 * i] = last_modal_[2 * i];
    out.modal_m[2 * i + 1] = last_modal_[2 * i + 1];
    FitLink(link, strain, &out);
  }
  last_modal_ = out.modal_m;
  return out;
}

void StrainFit::FitLink(int link, const std::array<double, kMaxStrainChannels>& strain,
                        FittedModes* out) noexcept {
  const std::uint32_t all = LinkMask(link);
  const std::size_t first = link == 0 ? 0 : 2;
  std::array<double, 4> modal{};
  for (int removed = 0;; ++removed) {
    if ((out->used & all) == all && solvable_[static_cast<std::size_t>(link)]) {
      modal[first] = modal[first + 1] = 0.0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(channels_); ++i) {
        if (channel_[i].link != link) continue;
        modal[first] += channel_[i].inverse[0] * strain[i];
        modal[first + 1] += channel_[i].inverse[1] * strain[i];
      }
    } else if (!Solve(link, out->used, strain, &modal)) {
      return;
    }
    double worst = 0.0, sum = 0.0;
    std::uint32_t worst_bit = 0;
    int count = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(channels_); ++i) {
      if (channel_[i].link != link || (out->used >> i & 1u) == 0) continue;
      const double distance = std::fabs(strain[i] - Predicted(channel_[i], modal));
      sum += distance * distance;
      ++count;
      if (distance > worst) {
        worst = distance;
        worst_bit = std::uint32_t{1} << i;
      }
    }
    out->residual[static_cast<std::size_t>(link)] = std::sqrt(sum / count);
    if (worst <= family_limit_ || removed == kMaxOutliersPerLink) break;
    out->outlier |= worst_bit;
    out->used &= ~worst_bit;
    out->worst_outlier = std::fmax(out->worst_outlier, worst);
  }
  out->valid[static_cast<std::size_t>(link)] = true;
  out->modal_m[first] = modal[first];
  out->modal_m[first + 1] = modal[first + 1];
  const std::array<double, 2>& root = root_shape_[static_cast<std::size_t>(link)];
  out->root_strain[static_cast<std::size_t>(link)] =
      root[0] * modal[first] + root[1] * modal[first + 1];
}

// A channel is stuck when its raw value has not changed while the fit at its station has moved by
// more than the limit.
void StrainFit::JudgeStuck(const SensorFrame& frame, FittedModes* out) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels_); ++i) {
    Channel& c = channel_[i];
    const double fitted = Predicted(c, out->modal_m);
    if (!c.seen || frame.strain[i] != c.last_raw) {
      c.seen = true;
      c.last_raw = frame.strain[i];
      c.strain_at_change = fitted;
    } else if ((frame.strain_valid >> i & 1u) != 0 &&
               std::fabs(fitted - c.strain_at_change) > stuck_limit_) {
      out->stuck |= std::uint32_t{1} << i;
    }
  }
}

}  // namespace flexarm
