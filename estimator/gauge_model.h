#pragma once

#include <Eigen/Core>

#include "hal/sensor_config.h"
#include "model/arm/linearization.h"

namespace flexarm {

/// A linear model of the arm with the gauges' analogue filter behind its modal coordinates.
///
/// States: the model's n, then the `count` filtered coordinates phi_f, phi_f' = w_f (phi - phi_f),
/// and with a filter of second order their rates. A rig without filter gets one of 1600 Hz, which
/// acts as a delay of 0.1 ms.
/// @param first  state that is the first of `count` modal coordinates
LinearModel WithGaugeFilter(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::Index first,
                            Eigen::Index count, const StrainInputConfig& input);

/// Corner of the first-order filter that delays slow motion by as much as the rig's gauge filter
/// does: f / (2 zeta) for a second-order one.
///
/// The error of the replacement at frequency w is (w / w_f)^2 relative to the motion, to lowest
/// order in w, w_f that of the second-order filter.
double LagCorner_hz(const StrainInputConfig& input);

}  // namespace flexarm
