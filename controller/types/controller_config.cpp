#include "controller/types/controller_config.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "model/problem_list.h"

namespace flexarm {

namespace {

constexpr const char* kDriftsAway =
    "without weight the joint's double integrator is not controlled";

constexpr std::size_t kMostKnots = 32;  // each takes a millisecond at start-up

void CheckGrid(const std::string& key, const std::vector<double>& grid, double last,
               ProblemList* list) {
  const bool ascending = std::adjacent_find(grid.begin(), grid.end(), std::greater_equal<>()) ==
                         grid.end();  // a NaN is caught by the range
  list->Require(grid.size() >= 2 && grid.size() <= kMostKnots && ascending, key,
                NumberText(grid.size()) + " numbers",
                "must be 2 to " + NumberText(kMostKnots) + " numbers, ascending");
  for (std::size_t i = 0; i < grid.size(); ++i) {
    list->Within(ProblemList::Element(key, i), grid[i], 0.0, i == 0 ? 0.0 : last,
                 "a knot of the gain table; the first is 0");
  }
}

void CheckPayload(const PayloadLawConfig& p, ProblemList* list) {
  list->Positive("payload.max_kg", p.max_kg, 100.0, "moves are planned for this payload");
  list->EachPositive("payload.fast_fraction", p.fast_fraction, 1.0,
                     "share of the limits for the shortest moves");
  list->Positive("payload.fast_least_s", p.fast_least_s, 60.0, "no move is shorter");
  list->Within("payload.reference_kg", p.reference_kg, 0.0, 100.0,
               "the reference is the motion of an arm with this payload");
  CheckGrid("payload.gain_payload_kg", p.gain_payload_kg, 100.0, list);
  CheckGrid("payload.gain_elbow_deg", p.gain_elbow_deg, 180.0, list);
}

void CheckPlan(const PlanAheadConfig& p, ProblemList* list) {
  list->EachWithin("plan.moving_weight", p.moving_weight, 0.0, 1e9, "a weight, never negative");
  list->EachWithin("plan.resting_weight", p.resting_weight, 0.0, 1e9, "a weight, never negative");
  list->EachPositive("plan.torque_weight", p.torque_weight, 1e6,
                     "without it the cost does not limit the torque");
  list->Positive("plan.light_kg", p.light_kg, 100.0,
                 "the weights during a move decrease for payloads of about this and above");
  list->Positive("plan.torque_share", p.torque_share, 1.0,
                 "share of the torque limits; the rest is reserved for the feedback");
  list->Within("plan.start_alpha", p.start_alpha, 0.0, 10.0, "1/s; as controller.alpha");
  list->Within("plan.every_periods", p.every_periods, 1, 100, "periods from one plan to the next");
  list->Within("plan.ready_periods", p.ready_periods, 2, kMostReadyPeriods,
               "periods from the request of a plan to its first sample");
  list->Within("plan.rest_periods", p.rest_periods, 1, 100,
               "periods planned after the end of the move");
  list->Positive("plan.roughness", p.roughness, 10.0,
                 "largest change of torque from sample to sample, share of the limits");
  list->Positive("plan.payload_change_kg", p.payload_change_kg, 100.0,
                 "with a larger change a plan is no warm start for the next");
  list->Within("plan.payload_change_share", p.payload_change_share, 0.0, 1.0,
               "or this share of the plan's payload");
}

void CheckSettling(const SettlingConfig& s, ProblemList* list) {
  list->Within("settling.alpha", s.alpha, 0.0, 10.0, "1/s; as controller.alpha");
  list->Positive("settling.payload_filter_below_mm", s.payload_filter_below_mm, 1e4,
                 "with a larger vibration the state is that of the Kalman filter");
  list->Positive("settling.acts_below_mm", s.acts_below_mm, 1e4,
                 "with a larger vibration the torque is that of a move");
  list->Positive("settling.hold_below_mm", s.hold_below_mm, 1e4,
                 "with a smaller vibration the friction holds the arm");
  list->Positive("settling.release_above_mm", s.release_above_mm, 1e4,
                 "with a larger vibration the arm is damped again");
  list->EachPositive("settling.process_force_share", s.process_force_share, 100.0,
                     "without process noise the filter ignores what it measures");
  list->Within("settling.dead_band_counts", s.dead_band_counts, 0.0, 0.5,
               "half a count is the error of rounding");
}

// Sizes by the entries p of r, and symmetry.
void CheckMatrices(const GainMatrixConfig& m, std::size_t p, ProblemList* list) {
  const auto check = [list](const std::string& key, const std::vector<double>& entries,
                            std::size_t few, std::size_t all, const std::string& what) {
    list->Require(entries.empty() || entries.size() == few || entries.size() == all, key,
                  NumberText(entries.size()) + " numbers",
                  "must have " + NumberText(few) + " or " + NumberText(all) + ": " + what);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      list->Within(ProblemList::Element(key, i), entries[i], -1e6, 1e6, "an entry of the matrix");
    }
  };
  check("matrices.T", m.T, p, p * p, "the diagonal, or all entries row by row");
  check("matrices.Tbar", m.Tbar, p, p * p, "the diagonal, or all entries row by row");
  check("matrices.S", m.S, 2, 4, "the diagonal, or all entries row by row");
  check("matrices.K_e", m.K_e, 2, 4, "the diagonal, or all entries row by row");
  check("matrices.K_I0", m.K_I0, 1, 2 * p, "the share of [K_e S21 S22], or all entries");
  for (const auto& [key, entries] :
       {std::pair{"matrices.T", &m.T}, std::pair{"matrices.Tbar", &m.Tbar}}) {
    bool symmetric = true;
    for (std::size_t i = 0; entries->size() == p * p && i < p * p; ++i) {
      symmetric = symmetric && (*entries)[i] == (*entries)[i % p * p + i / p];
    }
    list->Require(symmetric, key, "not symmetric", "must be symmetric, or (7.11) is no norm");
  }
}

}  // namespace

std::vector<Problem> ControllerConfig::Problems() const {
  ProblemList list("controller.");
  list.Within("alpha", alpha, 0.0, 10.0,
              "1/s; a larger degree of stability is too fast for the sampling rate");
  list.Within("vartheta", vartheta, 0.0, 1.0, "a weight between two feedforwards");
  list.Within("sigma", sigma, 0.0, 1.0,
              "leakage: the share of the adapted change that is removed per sample");
  list.EachPositive("hub_angle_weight", hub_angle_weight, 1e6, kDriftsAway);
  list.EachWithin("hub_rate_weight", hub_rate_weight, 0.0, 1e6, "a weight, never negative");
  for (std::size_t i = 0; i < state_weight.size(); ++i) {
    const std::string element = ProblemList::Element("state_weight", i);
    if (i < 2) {
      list.Positive(element, state_weight[i], 1e6, kDriftsAway);
    } else {
      list.Within(element, state_weight[i], 0.0, 1e6, "a weight, never negative");
    }
  }
  list.Positive("torque_weight", torque_weight, 1e6, "the Riccati equation divides by it");
  list.Positive("passivity_margin", passivity_margin, 1e4,
                "G = J + margin I must exceed J, or the adaptive loop is not passive");
  list.EachPositive("pd_stiffness_nm_per_rad", pd_stiffness_nm_per_rad, 1e4,
                    "without stiffness the hub angle is not controlled");
  list.EachWithin("pd_damping_nms_per_rad", pd_damping_nms_per_rad, 0.0, 1e3,
                  "negative damping excites vibration");
  list.Within("adaptation_gain", adaptation_gain, 0.0, 100.0, "0 disables the adaptation");
  list.Within("adaptation_dead_zone_nm", adaptation_dead_zone_nm, 0.0, 100.0,
              "no adaptation while y_e = C_p (x_m - x) is smaller; 0: no dead zone");
  list.Positive("adaptation_bound", adaptation_bound, 1e6,
                "the largest distance of the gains from their initial values");
  list.EachWithin("payload_range_kg", payload_range_kg, 0.0, 100.0,
                  "the payloads with which the loop must be stable");
  list.Require(!(payload_range_kg[0] > payload_range_kg[1]), "payload_range_kg",
               NumberText(payload_range_kg[0]) + " .. " + NumberText(payload_range_kg[1]),
               "must be the least payload, then the greatest");
  if (matrices) CheckMatrices(*matrices, static_cast<std::size_t>(nominal.states()) + 4, &list);
  if (payload) CheckPayload(*payload, &list);
  if (plan) CheckPlan(*plan, &list);
  if (settling) CheckSettling(*settling, &list);
  return list.Take();
}

}  // namespace flexarm
