#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "config/config.h"
#include "tools/plot/gnuplot.h"

namespace flexarm {

/// Deflection of the links' tips by their gauges against the true one, like figure B.2: chapter 4's
/// square wave moves the arm with four modes a link, sampled at the loop's period.
///
/// The polynomial (B.1) is solved from five half bridges at the local maxima of strain, as in the
/// thesis. The modal fit takes the config's gauges and as many modes as its estimator. Readings
/// have the config's noise and quantisation; the analogue filter is left out, whose lag would hide
/// the error of the fits, or kept.
struct GaugeVerification {
  struct Sample {
    double time_s;
    std::array<double, 2> true_mm, polynomial_mm, modal_mm;  ///< links 1 and 2
  };
  struct Error {
    double rms_mm = 0.0, largest_mm = 0.0;
  };
  std::vector<Sample> sample;
  std::array<double, 2> largest_mm{};  ///< true deflection
  std::array<Error, 2> polynomial, modal;
};

/// @param filtered  with the config's filter of the gauges, as first order
/// @throws std::invalid_argument if gauges or filter do not determine the modes
GaugeVerification VerifyGauges(const RigConfig& config, bool filtered);

/// Draws deflections and errors of both links over time.
/// @throws std::runtime_error if gnuplot fails
void DrawVerification(const GaugeVerification& run, const std::filesystem::path& output,
                      const OutputRules& rules = ReplacedPicture());

}  // namespace flexarm
