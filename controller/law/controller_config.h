#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/problem.h"

namespace flexarm {

enum class ControllerKind : std::uint8_t {
  kSobel,   ///< "sobel": modified Sobel model-reference adaptive control
  kLqrCgt,  ///< "lqr-cgt": the same with T = Tbar = 0: LQR around the command generator's
            ///< trajectory
};

enum class FeedforwardSign : std::uint8_t {
  kPrinted,    ///< (7.25) as printed: u_f = (B'B)^-1 B' (-(A_m - A) x_m + B_m u_m)
  kCorrected,  ///< the sign that follows from the derivation
};

/// Section [controller]. Symbols as in the thesis, chapter 7.
struct ControllerConfig {
  ControllerKind kind;  ///< key `name`
  double alpha;         ///< prescribed degree of stability, 1/s, 0..10
  double vartheta;      ///< weight of (7.24) against the CGT feedforward, 0..1
  double sigma;         ///< leak of the adaptive gains a sample, 0..1
  FeedforwardSign feedforward_sign;
  std::array<double, 2> hub_angle_weight;  ///< Q on th1 th2
  std::array<double, 2> hub_rate_weight;   ///< Q on their rates
  double torque_weight;                    ///< R = rho I
  double passivity_margin;                 ///< G = J + margin I, > 0
  double adaptation_gain;                  ///< T = Tbar = gain I_16, >= 0
  bool prediction;                         ///< one-sample open-loop prediction
  bool adaptation;  ///< false: u = u* + y_e, the same feedforward and feedback
  std::string
      gains_file;  ///< key `gains`, optional: written by `flexarm design`; empty: design at start

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
