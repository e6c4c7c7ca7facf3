#pragma once

#include <vector>

namespace flexarm {

/// Amplitudes over frequency of evenly sampled values: a sinusoid of amplitude a shows as a.
struct Spectrum {
  double step_hz;                 ///< between neighbours, from 0 Hz
  std::vector<double> amplitude;  ///< in the unit of the values; up to half the sampling rate

  double FrequencyHz(std::size_t i) const { return step_hz * static_cast<double>(i); }
  /// Place of the largest amplitude at or above a frequency.
  std::size_t Largest(double from_hz) const;
};

/// Mean taken out, Hann window, discrete Fourier transform. A line is two bins wide; between two
/// bins up to 15 % of its height is lost.
/// @param values  at least 8, of which the number has small prime factors for speed's sake
/// @param step_s  > 0
Spectrum AmplitudeSpectrum(std::vector<double> values, double step_s);

/// Frequency of the strongest line at or above `from_hz`, between the bins: the peak of the
/// window's main lobe from its two largest neighbours. Exact for one sinusoid alone.
double DominantFrequencyHz(const Spectrum& spectrum, double from_hz);

}  // namespace flexarm
