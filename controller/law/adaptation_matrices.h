#pragma once

#include <Eigen/Core>

#include "controller/types/controller_config.h"

namespace flexarm {

struct Design;

/// The gain matrices of Sobel's law (7.11) to (7.14), of p = n + 4 entries of r = [y_e; x_m; u_m].
struct AdaptationMatrices {
  Eigen::MatrixXd T, Tbar;  ///< p x p
  Eigen::Matrix2d S, K_e;
  Eigen::MatrixXd K_I0;  ///< 2 x p, K_I(0)
  Eigen::MatrixXd Kbar;  ///< 2 x p, [K_e S21 S22]: the ideal gains of the nominal plant
};

/// The matrices of the config; what it leaves out is T = Tbar = adaptation_gain I, S = K_e = I,
/// K_I(0) = [K_e S21 S22].
AdaptationMatrices MatricesOf(const ControllerConfig& config, const Design& design);

/// K_e of the config, or I.
Eigen::Matrix2d OutputFeedback(const ControllerConfig& config);

}  // namespace flexarm
