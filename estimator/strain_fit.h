#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "estimator/calibration.h"
#include "estimator/estimator_config.h"
#include "estimator/strain_scale.h"
#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"
#include "model/beam/link_modes.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Modal coordinates fitted to the strain channels of one sample.
struct FittedModes {
  std::array<double, 4> modal_m;  ///< f11 f12 f21 f22; the last good fit if not valid
  std::array<bool, 2> valid;      ///< per link: its good gauges determine the modes
  /// Surface strain of the fit at the root of each link, or of the section where it bends most.
  /// NaN, unknown, if not valid.
  std::array<double, 2> root_strain;
  std::array<double, 2> residual;  ///< rms of channel minus fit, unit strain
  std::uint32_t used;              ///< bit i: channel i was used
  std::uint32_t saturated;         ///< bit i: at an end of the converter's range
  std::uint32_t stuck;             ///< bit i: constant while its link bends
  std::uint32_t outlier;           ///< bit i: too far from the fit of the other channels
  std::array<int, 2> gauges;       ///< per link: channels used
  /// Per link: its used channels if each repeats its last value to the bit, else 0. Noise makes
  /// that rare, and an arm that bends impossible.
  std::array<std::uint32_t, 2> repeated;
  double worst_outlier;  ///< of its studentised distance from the fit, unit strain
  /// Per link without a valid fit: the unit strain, above 0, at the end of the range of its gauges
  /// that read it and are bent so far as the others say too. 0: there is none.
  std::array<double, 2> beyond_range;
};

/// Weighted least-squares fit of one or two modal coordinates per link to the strain channels.
///
///   strain_i = face_i (h/2) sum_j psi_j''(x_i) f_j        (thesis B.2, and 7.4)
///
/// The estimator `polynomial` uses the thesis's fit of (B.1) instead, as long as all channels of
/// the link are good.
///
/// Channels are weighted by the inverse variance of their noise. With all channels good the fit is
/// one product with a precomputed pseudo-inverse; otherwise the 2 x 2 normal equations of the good
/// ones are solved. A channel that is saturated, stuck, or farther from the fit than the limit is
/// excluded in the same sample; outliers are removed worst first, at most two per link. The
/// distance is studentised: divided by sqrt(1 - h), with the channel's leverage h, because the fit
/// follows a channel of great leverage, such as the one next to the root, wherever it goes. So
/// noise is as large in the distance of each channel.
///
/// The fit of a link is valid while its good channels determine the modes nearly as well as all of
/// them: no coordinate, and not the strain at the root, has more than kMostSpread times the
/// standard deviation that it has with every channel good; and at least gauges_needed() are left.
/// Real-time: Reset and Fit are safe.
class StrainFit {
 public:
  /// Bound on the standard deviation of a fitted quantity relative to that with all channels. The
  /// modal noise that the observers are designed for (estimator.modal_sigma_m) is larger than this
  /// times the noise of the gauges, so their gains stay those of the remaining readings.
  static constexpr double kMostSpread = 2.0;

  StrainFit(const ArmParameters& arm, const SensorConfig& sensors, const EstimatorConfig& config);

  void Reset(const Calibration& calibration) noexcept;
  /// Skew correction: a reading taken d after the instant is extrapolated by -d times the strain
  /// rate that `modal_rate_m_s` gives its channel. The residual error is (w d)^2 / 2 of a signal of
  /// w rad/s, instead of w d, plus d times the error of the rates.
  /// @param instant_ns      instant of the fitted modes; the frame's own if there is no skew
  /// @param modal_rate_m_s  at that instant, of the coordinates as the gauges read them
  FittedModes Fit(const SensorFrame& frame, std::int64_t instant_ns,
                  const std::array<double, 4>& modal_rate_m_s) noexcept;
  /// Treats every reading as taken at the frame's instant.
  FittedModes Fit(const SensorFrame& frame) noexcept { return Fit(frame, frame.sampled_at_ns, {}); }

  /// Channels that a valid fit of each link needs at least: one more than it has modes, so that
  /// they check each other; all of a link that has no more than modes.
  const std::array<int, 2>& gauges_needed() const noexcept { return gauges_needed_; }
  /// How much of an error of one channel its studentised distance from the fit shows, 0 .. 1, with
  /// all channels good: sqrt(1 - h), with its leverage h. 0: the fit follows it wherever it goes.
  double ShownOfError(std::size_t channel) const noexcept;
  /// Surface strain at the root of a link, 0 or 1, bent as the modal coordinates f11 f12 f21 f22.
  double RootStrain(std::size_t link, const std::array<double, 4>& modal_m) const noexcept {
    return root_shape_[link][0] * modal_m[2 * link] + root_shape_[link][1] * modal_m[2 * link + 1];
  }

 private:
  struct Channel {
    int link = 0;
    StrainScale config;             // of the config
    StrainScale scale;              // the same, calibrated
    double weight = 0.0;            // 1 / variance
    std::array<double, 2> shape{};  // (h/2) psi_j''(x)
    // Terms of the normal equations: weight s0, weight s1; weight s0^2, weight s0 s1, weight s1^2.
    std::array<double, 2> weighted{};
    std::array<double, 3> normal{};
    std::array<double, 3> spread{};   // s0^2, s1^2, 2 s0 s1: of a variance of the modal coordinates
    std::array<double, 2> inverse{};  // column of the pseudo-inverse when all channels are good
    // Stuck detection: the last raw value, and when it last changed the fitted strain here, the
    // strains of all channels, and which of them were used.
    std::int32_t last_raw = 0;
    double strain_at_change = 0.0;
    std::array<double, kMaxStrainChannels> all_at_change{};
    std::uint32_t used_at_change = 0;
    bool seen = false;
  };

  /// Variances of a link's fit that are due to the noise of its channels.
  struct Variance {
    std::array<double, 2> modal_m2;
    double root;  ///< of RootStrain
    double modal_covariance_m2 = 0.0;
  };

  double Predicted(const Channel& channel, const std::array<double, 4>& modal) const noexcept;
  /// 1 - h of a channel, with its leverage h in a fit of that variance; 0: it alone determines a
  /// mode.
  double OfTheOthers(const Channel& channel, const Variance& variance) const noexcept;
  std::uint32_t LinkMask(int link) const noexcept {
    return link_mask_[static_cast<std::size_t>(link)];
  }
  void FitPolynomials(const ArmParameters& arm, const SensorConfig& sensors,
                      const std::array<LinkModes, 2>& modes);
  /// @param variance  of the result
  bool Solve(int link, std::uint32_t used, const std::array<double, kMaxStrainChannels>& strain,
             std::array<double, 4>* modal, Variance* variance) const noexcept;
  bool Determines(std::size_t link, std::uint32_t used, const Variance& variance) const noexcept;
  /// The largest strain of saturated channels that the fit of the others confirms; 0: none.
  double BeyondRange(std::uint32_t saturated, const std::array<double, kMaxStrainChannels>& strain,
                     const std::array<double, 4>& modal) const noexcept;
  /// The channel without which the others agree best.
  struct Suspect {
    std::uint32_t bit;  ///< 0: there is none
    double apart;       ///< its studentised distance from the fit, unit strain
  };
  /// @param modal     the fit of the used channels
  /// @param variance  of that fit
  /// @param residual  rms of channel minus fit
  Suspect SuspectOf(int link, std::uint32_t used,
                    const std::array<double, kMaxStrainChannels>& strain,
                    const std::array<double, 4>& modal, const Variance& variance,
                    double* residual) const noexcept;
  void FitLink(int link, const std::array<double, kMaxStrainChannels>& strain,
               FittedModes* out) noexcept;
  /// Whether the channels of `others` alone confirm that the strain at a channel that repeats its
  /// value has changed by more than the limit since it last changed; true if they cannot tell.
  bool OthersMoved(const Channel& channel, std::uint32_t others,
                   const std::array<double, kMaxStrainChannels>& strain) const noexcept;
  /// Whether a fit of these channels of the link determines the strain at its root to a tenth of
  /// the limit of the stuck detection.
  bool SeesStuck(std::size_t link, std::uint32_t used, const Variance& variance) const noexcept;
  /// @returns bit i: valid channel i repeats its last value
  std::uint32_t JudgeStuck(const SensorFrame& frame,
                           const std::array<double, kMaxStrainChannels>& strain,
                           FittedModes* out) noexcept;

  int modes_;
  int channels_;
  std::int32_t lowest_count_;
  std::int32_t highest_count_;
  double family_limit_;
  double stuck_limit_;
  std::array<Channel, kMaxStrainChannels> channel_;
  std::array<bool, 2> solvable_{};                     // a link's channels separate its modes
  std::array<std::array<double, 2>, 2> root_shape_{};  // (h/2) psi_j'' there
  std::array<std::uint32_t, 2> link_mask_{};           // bit i: channel i is on the link
  std::array<int, 2> gauges_needed_{};
  std::array<Variance, 2> of_all_{}, most_{};  // with all channels good; of a valid fit
  std::array<double, 4> last_modal_{};
};

}  // namespace flexarm
