#include "controller/design/check_explanation.h"

#include <algorithm>
#include <array>

namespace flexarm {
namespace {

// The same key helps against one cause, whichever check finds it.
constexpr std::string_view kSpread =
    "bring controller.hub_angle_weight, hub_rate_weight, state_weight and torque_weight "
    "within a few powers of ten of each other; lower controller.alpha; controller.nominal = "
    "\"R8\" has the smallest equation";
constexpr std::string_view kCalmer =
    "raise controller.torque_weight (tenfold is one step); lower controller.hub_rate_weight, "
    "estimator.process_force and, if it is above 3, controller.alpha";

constexpr std::array<CheckExplanation, 21> kExplanations = {{
    {"regulator-riccati-residual",
     "relative error of the Riccati equation of the regulator's gains: a failure means that "
     "its numbers lie too far apart to be solved exactly",
     kSpread},
    {"closed-loop-spectral-radius",
     "largest |eigenvalue| of the nominal model under the regulator: alpha promises e^(-alpha "
     "Ts); a failure means that the gains do not solve their equation",
     kSpread},
    {"lemma-residual",
     "relative error of A_c' P' B = K', the lemma on which the proof of Sobel's law rests: it "
     "holds up to rounding, unless P is wrong",
     kSpread},
    {"lemma-dissipation-min-eigenvalue",
     "smallest eigenvalue of P' - A_c' P' A_c, the energy that the loop loses in a period: "
     "below zero the proof of Sobel's law has no ground",
     kSpread},
    {"j-min-eigenvalue",
     "smallest eigenvalue of J = B' P' B / 2: zero means that one of the torques moves nothing"
     " that the regulator weighs",
     "raise controller.hub_angle_weight and hub_rate_weight of both joints, or state_weight"},
    {"g-minus-j-min-eigenvalue",
     "smallest eigenvalue of G - J: G must exceed J, or the adaptive loop is not passive",
     "raise controller.passivity_margin"},
    {"positive-real-min-eigenvalue",
     "smallest eigenvalue of S + S* over all frequencies, S(z) = J + K (zI - A_c)^-1 B: below "
     "zero the adaptation can feed the vibration",
     kSpread},
    {"cgt-condition",
     "condition number of the command generator's equation: a large one means that no steady "
     "torque holds a steady output of the law, so that the feedforward is a matter of rounding",
     "lower controller.alpha; raise controller.hub_rate_weight or lower "
     "controller.torque_weight, as far as gain-margin-up allows; `flexarm config check` warns "
     "about masses and lengths that cannot be"},
    {"cgt-residual",
     "error of the command generator's equations, of which the feedforward comes: a failure "
     "means that the model would not follow its own reference",
     "as for cgt-condition: lower controller.alpha; raise controller.hub_rate_weight or lower "
     "controller.torque_weight"},
    {"t-min-eigenvalue",
     "smallest eigenvalue of T, the gain of the integrating adaptation: it must be positive "
     "definite",
     "raise the diagonal of controller.matrices.T, or lower its other entries"},
    {"2tbar-minus-t-min-eigenvalue",
     "smallest eigenvalue of 2 Tbar - T: the proportional adaptation must be at least half of "
     "the integrating one",
     "raise the diagonal of controller.matrices.Tbar or lower that of controller.matrices.T"},
    {"ssg-minus-j-min-eigenvalue",
     "smallest eigenvalue of S'S G - J: as g-minus-j-min-eigenvalue, with the matrix S of the "
     "config",
     "raise controller.matrices.S or controller.passivity_margin"},
    {"ke-spectral-radius",
     "largest |eigenvalue| of A - B K_e K, the loop with the matrix K_e of the config: 1 and "
     "more is unstable",
     "bring controller.matrices.K_e nearer to [1.0, 1.0]; raise controller.torque_weight"},
    {"ke-positive-real-min-eigenvalue",
     "as positive-real-min-eigenvalue, around the loop with K_e: below zero the adaptation can"
     " feed the vibration",
     "bring controller.matrices.K_e nearer to [1.0, 1.0]"},
    {"pd-spectral-radius",
     "largest |eigenvalue| of the nominal model under the PD gains: 1 and more is unstable, "
     "and a shaper needs a loop that settles",
     "lower controller.pd_damping_nms_per_rad and controller.pd_stiffness_nm_per_rad: damping "
     "above what the sampling rate allows excites the bending modes"},
    {"filter-riccati-residual",
     "relative error of the Riccati equation of the Kalman filter: a failure means that its "
     "noises lie too far apart to be solved exactly",
     "bring the elements of estimator.process_force, and those of estimator.modal_sigma_m, "
     "within a few powers of ten of each other; raise estimator.rotor_extra_sigma_rad if it is"
     " far below a count"},
    {"filter-spectral-radius",
     "largest |eigenvalue| of the filter's error: 1 and more means that an error of the "
     "estimate never dies out",
     "raise estimator.process_force, of which no element may be near zero; lower "
     "estimator.modal_sigma_m"},
    {"robustness-spectral-radius",
     "largest |eigenvalue| of the whole loop around the arm with four modes a link, over "
     "payloads, elbow angles and gains: 1 and more means that some arm within "
     "controller.payload_range_kg swings up",
     "raise controller.torque_weight (tenfold is one step); lower controller.hub_rate_weight, "
     "estimator.process_force and, if it is above 3, controller.alpha; narrow "
     "controller.payload_range_kg to what the arm carries; controller.prediction = true"},
    {"gain-margin-up",
     "factor on the feedback at which the loop becomes unstable: an arm or motor that answers "
     "more strongly than described, by this factor, swings up",
     kCalmer},
    {"gain-margin-down",
     "factor below 1 on the feedback at which the loop becomes unstable: the loop is unstable,"
     " or needs its full gain",
     "an unstable loop has 1 here: see robustness-spectral-radius; otherwise lower "
     "controller.alpha and raise controller.torque_weight"},
    {"delay-margin-ms",
     "additional delay at which the loop becomes unstable: it must cover the motor's lag and "
     "the latency of the sensors",
     "raise controller.torque_weight; lower controller.hub_rate_weight; a delay that is known "
     "belongs into loop.actuation_delay_ms, and controller.prediction = true compensates it; "
     "estimator.process_force has a best value: try a third and three times"},
}};

}  // namespace

std::span<const CheckExplanation> CheckExplanations() { return kExplanations; }

const CheckExplanation* ExplanationOf(std::string_view check_name) {
  const auto* const found =
      std::find_if(kExplanations.begin(), kExplanations.end(),
                   [check_name](const CheckExplanation& e) { return e.name == check_name; });
  return found == kExplanations.end() ? nullptr : found;
}

}  // namespace flexarm
