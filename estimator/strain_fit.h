#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "estimator/calibration.h"
#include "estimator/estimator_config.h"
#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"
#include "model/beam/link_modes.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Modal coordinates fitted to the strain channels of one sample.
struct FittedModes {
  std::array<double, 4> modal_m;  ///< f11 f12 f21 f22; the last good fit if not valid
  std::array<bool, 2> valid;      ///< per link: enough good channels
  /// Surface strain of the fit at the root of each link, or of the section where it bends most;
  /// NaN, unknown, if not valid.
  std::array<double, 2> root_strain;
  std::array<double, 2> residual;  ///< rms of channel minus fit, unit strain
  std::uint32_t used;              ///< bit i: channel i was used
  std::uint32_t saturated;         ///< bit i: at an end of the converter's range
  std::uint32_t stuck;             ///< bit i: constant while its link bends
  std::uint32_t outlier;           ///< bit i: too far from the fit of the other channels
  double worst_outlier;            ///< its distance from the fit, unit strain
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
/// excluded in the same sample; outliers are removed worst first, at most two per link.
/// Real-time: Reset and Fit are safe.
class StrainFit {
 public:
  StrainFit(const ArmParameters& arm, const SensorConfig& sensors, const EstimatorConfig& config);

  void Reset(const Calibration& calibration) noexcept;
  /// Skew correction: a reading taken d after the instant is extrapolated by -d times the strain
  /// rate that `modal_rate_m_s` gives its channel. The residual error is (w d)^2 / 2 of a signal of
  /// w rad/s, instead of w d, plus d times the error of the rates.
  /// @param instant_ns      instant of the fitted modes; the frame's own if there is no skew
  /// @param modal_rate_m_s  at that instant, of the coordinates as the gauges read them
  FittedModes Fit(const SensorFrame& frame, std::int64_t instant_ns,
                  const std::array<double, 4>& modal_rate_m_s) noexcept;
  /// Bit i: channel i is a gauge of that link; 0 if the link has too few to separate its modes.
  std::array<std::uint32_t, 2> gauges() const noexcept {
    return {solvable_[0] ? LinkMask(0) : 0, solvable_[1] ? LinkMask(1) : 0};
  }
  /// Treats every reading as taken at the frame's instant.
  FittedModes Fit(const SensorFrame& frame) noexcept { return Fit(frame, frame.sampled_at_ns, {}); }

 private:
  struct Channel {
    int link = 0;
    double config_unit_per_count = 0.0;  // signed by face and gain
    double config_offset_counts = 0.0;
    double unit_per_count = 0.0;  // the same, calibrated
    double offset_counts = 0.0;
    double weight = 0.0;              // 1 / variance
    std::array<double, 2> shape{};    // (h/2) psi_j''(x)
    std::array<double, 2> inverse{};  // column of the pseudo-inverse when all channels are good
    // Stuck detection: the last raw value, and the fitted strain when it last changed.
    std::int32_t last_raw = 0;
    double strain_at_change = 0.0;
    bool seen = false;
  };

  double Predicted(const Channel& channel, const std::array<double, 4>& modal) const noexcept;
  std::uint32_t LinkMask(int link) const noexcept;
  void FitPolynomials(const ArmParameters& arm, const SensorConfig& sensors,
                      const std::array<LinkModes, 2>& modes);
  bool Solve(int link, std::uint32_t used, const std::array<double, kMaxStrainChannels>& strain,
             std::array<double, 4>* modal) const noexcept;
  void FitLink(int link, const std::array<double, kMaxStrainChannels>& strain,
               FittedModes* out) noexcept;
  void JudgeStuck(const SensorFrame& frame, FittedModes* out) noexcept;

  int modes_;
  int channels_;
  std::int32_t lowest_count_;
  std::int32_t highest_count_;
  double family_limit_;
  double stuck_limit_;
  std::array<Channel, kMaxStrainChannels> channel_;
  std::array<bool, 2> solvable_{};                     // a link's channels separate its modes
  std::array<std::array<double, 2>, 2> root_shape_{};  // (h/2) psi_j'' there
  std::array<double, 4> last_modal_{};
};

}  // namespace flexarm
