#pragma once

#include <vector>

#include "tools/analysis/parametric_study.h"

namespace flexarm {

// Figures of a sweep: one value a point, in the order of the points, and what their course is.

/// A measure of one signal at every point.
std::vector<double> Values(const ParametricSweep& sweep, Signal signal,
                           double SignalMeasures::*measure = &SignalMeasures::peak);

/// One of the two lowest frequencies with the motors free, Hz.
std::vector<double> FreeFrequenciesHz(const ParametricSweep& sweep, std::size_t mode);

/// The lowest frequency with the motors held, Hz.
std::vector<double> HeldFrequenciesHz(const ParametricSweep& sweep);

/// Bending that is left after the excitation, in percent of that at the first point.
std::vector<double> LeftInPercent(const ParametricSweep& sweep, Signal signal);

/// The values at those points whose parameter is at least `least`.
std::vector<double> From(double least, const ParametricSweep& sweep,
                         const std::vector<double>& values);

constexpr double kScatter = 0.005;  ///< of a measure, relative: no change below it means anything

/// Whether they rise from end to end, and on the way never fall back, but for their scatter.
bool Rises(const std::vector<double>& values);
bool Falls(std::vector<double> values);

/// The parameter at which they are largest, or smallest.
double ParameterOfLargest(const ParametricSweep& sweep, const std::vector<double>& values);
double ParameterOfLeast(const ParametricSweep& sweep, const std::vector<double>& values);

/// Largest less smallest, in percent of their mean.
double SpreadInPercent(const std::vector<double>& values);

/// How much they fall from the first to the last, in percent of the first.
double DropInPercent(const std::vector<double>& values);

/// Farthest from the straight line between the ends, in percent of the ends' difference.
double BowInPercent(const ParametricSweep& sweep, const std::vector<double>& values);

/// Pearson's, -1 to 1.
double Correlation(const std::vector<double>& a, const std::vector<double>& b);

/// p of values ~ parameter^p, by the ends of the sweep.
double Exponent(const ParametricSweep& sweep, const std::vector<double>& values);

}  // namespace flexarm
