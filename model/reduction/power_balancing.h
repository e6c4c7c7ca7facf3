#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <vector>

namespace flexarm {

/// Undamped linear system z' = [[0, Q1], [-Q2, 0]] z + [0; B0] u, y = [C0, 0] z.
/// Source: thesis (6.5). Q1, Q2: n x n; B0: n x inputs; C0: outputs x n.
struct UndampedSystem {
  Eigen::MatrixXd Q1, Q2, B0, C0;
};

/// Conditions under which a system can be made internally power balanced.
enum class PowerCondition : std::uint8_t {
  kSymmetric,       ///< (6.6), Han et al.: Q1 = Q1' > 0 and Q2 = Q2'
  kDiagonalisable,  ///< relaxed condition, Appendix D: Q1 = 1, Q2 has distinct positive eigenvalues
};

/// A root of the system that is excluded from the balance: it does not oscillate.
struct DroppedRoot {
  enum class Reason : std::uint8_t {
    kRigid,     ///< |root| below the threshold: a rigid-body motion, its power grows without bound
    kNegative,  ///< the motion grows or decays without oscillating
    kComplex,   ///< a growing oscillation, paired with a decaying one
  };
  std::complex<double> squared_frequency_rad2_s2;
  Reason reason;
};

/// One oscillating mode of the undamped system.
struct PowerMode {
  double frequency_rad_s;  ///< omega_k
  double b_norm, c_norm;   ///< |b_k| and |c_k|: coupling to the inputs and to the outputs
  double rho;              ///< power element |b_k| |c_k| / omega_k of its pair of states (6.13)
  bool rigid_origin;       ///< among the lowest roots, which the caller declared as rigid-body
};

/// Result of power balancing: the modes and the power elements.
///
/// T1 and T2 map modal coordinates to the two halves of z: z = [T1 xi; T2 xi'], xi_k'' =
/// -omega_k^2 xi_k + b_k u. The scaling of their columns is arbitrary; rho and mu do not depend on
/// it.
struct PowerBalance {
  PowerCondition condition;
  std::vector<PowerMode> mode;       ///< ascending frequency
  std::vector<DroppedRoot> dropped;  ///< of the squared-frequency matrix
  Eigen::MatrixXd T1, T2;            ///< n x modes
  Eigen::MatrixXd b, c;              ///< modes x inputs, outputs x modes
  /// Power elements of the original states (6.17), (6.22): mean of twice the square of the unit
  /// impulse responses, summed over the inputs. First and second half of z; units of z squared.
  Eigen::VectorXd mu, mu_rate;
};

/// Definition of a rigid-body motion.
struct PowerOptions {
  double rigid_below_rad2_s2 = 1e-3;  ///< roots closer to zero are dropped
  int rigid_roots = 0;  ///< number of the lowest roots to mark; those of the system at rest
};

/// Power balancing of an undamped system, by the condition that its matrices satisfy.
///
/// Source: thesis 6.3, 6.4 and Appendix D. The sum (6.20) runs over 2n states with each rho twice
/// as printed; here over n pairs. Cross terms vanish because roots are distinct.
/// @throws std::invalid_argument if sizes do not fit or neither condition holds, with the part that
/// is violated; std::domain_error if two roots coincide, so that power elements are not unique.
PowerBalance BalancePower(const UndampedSystem& system, const PowerOptions& options = {});

/// The internally power balanced system eta' = A eta + B u, y = C eta (6.12), z = L eta.
///
/// States come in pairs, largest rho first. L = [T1; T2] R3 in the thesis's notation with (6.11)
/// corrected. Both power matrices are diag(rho_1, rho_1, rho_2, ..).
struct PowerBalancedSystem {
  Eigen::MatrixXd A, B, C, L;
};

/// @param modes  number of modes kept, in the order of rho: 1 to all
/// @throws std::invalid_argument if out of range; std::domain_error if a kept mode is not
/// controllable from the inputs or not observable at the outputs.
PowerBalancedSystem Realize(const PowerBalance& balance, int modes);

/// Mean of twice the square of z over the first `time_s` of the unit impulse responses, summed
/// over the inputs: (6.17) before the limit, by time steps instead of by modes. An independent
/// check of mu and mu_rate; slow.
/// @param step_s  > 0; any step that is no multiple of half a period of the system samples well
/// @returns 2n entries, as z. Rigid-body motions are included.
Eigen::VectorXd TimeAveragedPower(const UndampedSystem& system, double time_s, double step_s);

}  // namespace flexarm
