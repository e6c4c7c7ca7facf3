#pragma once

namespace flexarm {

/// A reading that was rounded to whole counts, as a row of a least-squares problem.
struct QuantisedResidual {
  double residual;  ///< weighted
  double weight;    ///< 1 / sigma of the row: factor of its sensitivities
};

/// What a rounded reading tells of a prediction with a normal error.
///
/// The true value lies within half a count of the reading, `away` from the prediction. Score and
/// information of the likelihood of that interval: near an edge of the count a reading tells as
/// much as one without rounding, in its middle nearly nothing. With rounding taken as noise of
/// count / sqrt(12), the edges would be lost: three quarters of the information where the model is
/// ten times finer than a count. Not real-time safe (erfc).
/// @param away   reading minus prediction
/// @param count  > 0
/// @param sigma  of the prediction, > 0
QuantisedResidual Quantised(double away, double count, double sigma);

}  // namespace flexarm
