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

}  // namespace flexarm
