#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace flexarm {

struct StackConfig;

/// One check made on a design, with its figure.
struct DesignCheck {
  std::string name;    ///< e.g. "cgt-residual"
  double value;
  double limit;
  bool below;          ///< true: value must be below limit; false: above
  bool passed() const { return below ? value < limit : value > limit; }
};

/// Everything that the loop needs and that is computed before it runs. SI, psi(L) = 1.
///
/// Names as in control.md section 4: A B the nominal model R12 (n = 12, discrete), Am Bm the
/// reference model, K the LQR gain = Cp, J G of the positive-real lemma, S11..S22 of the command
/// generator, Ufx Ufu of (7.25), and the steady Kalman filter Aa Ba C L (16 states, 8 outputs).
struct Design {
  Eigen::MatrixXd A, B, Am, Bm, K, P, J, G, S11, S12, S21, S22, Ufx, Ufu;
  Eigen::MatrixXd filter_A, filter_B, filter_C, filter_L;
  Eigen::Matrix2d rigid_inertia_kgm2;  ///< M_r at theta2 = 0: move = M_r^-1 a T^2 / 4
  std::vector<DesignCheck> checks;

  bool sound() const;  ///< every check passed
};

/// Designs nominal and reference model, gains and filter for a rig. About a tenth of a second.
/// @throws std::runtime_error naming the equation that has no solution
Design DesignController(const StackConfig& config);

/// Gains as JSON text in full precision (17 digits), with the hash of the parts of the config that
/// they were designed from; and back.
/// @throws std::runtime_error if the text is not a gains file
std::string DesignToJson(const Design& design, const std::string& config_hash);
Design DesignFromJson(const std::string& text, std::string* config_hash);

}  // namespace flexarm
