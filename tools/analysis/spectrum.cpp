#include "tools/analysis/spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

#include "model/units.h"

namespace flexarm {
namespace {}  // namespace

std::size_t Spectrum::Largest(double from_hz) const {
  const auto first = static_cast<std::ptrdiff_t>(std::ceil(from_hz / step_hz));
  if (first >= static_cast<std::ptrdiff_t>(amplitude.size())) {
    throw std::invalid_argument("Spectrum: no line at or above that frequency");
  }
  return static_cast<std::size_t>(std::max_element(amplitude.begin() + first, amplitude.end()) -
                                  amplitude.begin());
}

Spectrum AmplitudeSpectrum(std::vector<double> values, double step_s) {
  const std::size_t n = values.size();
  if (n < 8 || !(step_s > 0.0)) {
    throw std::invalid_argument("Spectrum: expected at least 8 values and a positive step");
  }
  const auto count = static_cast<double>(n);
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  for (std::size_t k = 0; k < n; ++k) {
    values[k] =
        (values[k] - mean) * (0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(k) / count));
  }
  std::vector<std::complex<double>> transform;
  Eigen::FFT<double>().fwd(transform, values);
  Spectrum spectrum{1.0 / (count * step_s), {}};
  // Factor 2 for the two sides of the spectrum, and 2 for the window's mean of 1/2.
  for (std::size_t k = 0; k <= n / 2; ++k) {
    spectrum.amplitude.push_back(4.0 / count * std::abs(transform[k]));
  }
  return spectrum;
}

double DominantFrequencyHz(const Spectrum& spectrum, double from_hz) {
  const std::size_t k = spectrum.Largest(from_hz);
  const std::vector<double>& a = spectrum.amplitude;
  if (k == 0 || k + 1 >= a.size() || a[k] == 0.0) return spectrum.FrequencyHz(k);
  // Hann window: the lines 1 - d and d bins away have the amplitude ratio (1 + d) to (2 - d).
  const bool above = a[k + 1] >= a[k - 1];
  const double ratio = (above ? a[k + 1] : a[k - 1]) / a[k];
  const double d = (2.0 * ratio - 1.0) / (ratio + 1.0);
  return spectrum.FrequencyHz(k) + (above ? d : -d) * spectrum.step_hz;
}

}  // namespace flexarm
