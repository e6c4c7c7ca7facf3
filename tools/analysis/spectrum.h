#pragma once

#include <vector>

namespace flexarm {

/// Amplitude spectrum of evenly sampled values: a sinusoid of amplitude a gives a line of height a.
struct Spectrum {
  double step_hz;                 ///< between neighbours, from 0 Hz
  std::vector<double> amplitude;  ///< in the unit of the values; up to half the sampling rate

  double FrequencyHz(std::size_t i) const { return step_hz * static_cast<double>(i); }
  /// Index of the largest amplitude at or above a frequency.
  std::size_t Largest(double from_hz) const;
};

/// Subtracts the mean, applies a Hann window and the discrete Fourier transform. A line is two bins
/// wide; between two bins it loses up to 15 % of its height.
/// @param values  at least 8; a number with small prime factors is fast
/// @param step_s  > 0
Spectrum AmplitudeSpectrum(std::vector<double> values, double step_s);

/// Frequency of the strongest line at or above `from_hz`, interpolated between the bins: the peak
/// of the window's main lobe from its two largest lines. Exact for a single sinusoid.
double DominantFrequencyHz(const Spectrum& spectrum, double from_hz);

}  // namespace flexarm
