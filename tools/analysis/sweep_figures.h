#pragma once

#include <vector>

#include "tools/analysis/parametric_study.h"

namespace flexarm {

// Values of a sweep, one per point in the order of the points, and figures of their course.

/// One measure of a signal at every point.
std::vector<double> Values(const ParametricSweep& sweep, Signal signal,
                           double SignalMeasures::* measure = &SignalMeasures::peak);

/// One of the two lowest frequencies with the motors free, Hz.
std::vector<double> FreeFrequenciesHz(const ParametricSweep& sweep, std::size_t mode);

/// The lowest frequency with the motors held, Hz.
std::vector<double> HeldFrequenciesHz(const ParametricSweep& sweep);

/// Bending after the excitation, in percent of that at the first point.
std::vector<double> LeftInPercent(const ParametricSweep& sweep, Signal signal);

/// The values at the points whose parameter is at least `least`.
std::vector<double> From(double least, const ParametricSweep& sweep,
                         const std::vector<double>& values);

constexpr double kScatter = 0.005;  ///< relative; smaller changes are not significant

/// True if the values rise from end to end and never fall between by more than their scatter.
bool Rises(const std::vector<double>& values);
bool Falls(std::vector<double> values);

/// The parameter at which the values are largest, or smallest.
double ParameterOfLargest(const ParametricSweep& sweep, const std::vector<double>& values);
double ParameterOfLeast(const ParametricSweep& sweep, const std::vector<double>& values);

/// Largest minus smallest value, in percent of the mean.
double SpreadInPercent(const std::vector<double>& values);

/// Decrease from the first to the last value, in percent of the first.
double DropInPercent(const std::vector<double>& values);

/// Largest deviation from the straight line between the ends, in percent of the ends' difference.
double BowInPercent(const ParametricSweep& sweep, const std::vector<double>& values);

/// Pearson's correlation coefficient, -1 to 1.
double Correlation(const std::vector<double>& a, const std::vector<double>& b);

/// Exponent p of values ~ parameter^p, from the ends of the sweep.
double Exponent(const ParametricSweep& sweep, const std::vector<double>& values);

}  // namespace flexarm
