#include <vector>

#include "config/rig_sections.h"
#include "controller/types/law_table.h"

namespace flexarm {
namespace {

void ReadPayloadLaw(TableReader payload, PayloadLawConfig* out) {
  payload.Read("max_kg", &out->max_kg,
               "moves are planned so that the arm can follow with this payload");
  payload.Read("fast_fraction", &out->fast_fraction,
               {"share of the limits that moves with duration = \"shortest\" use: without payload, "
                "with max_kg; linear between",
                "1"});
  payload.Read("fast_least_s", &out->fast_least_s, "no such move is shorter");
  payload.Read("reference_kg", &out->reference_kg,
               "the reference is the motion of an arm with this payload");
  payload.Read("gain_payload_kg", &out->gain_payload_kg,
               "payloads for which gains are computed, ascending from 0");
  payload.Read("gain_elbow_deg", &out->gain_elbow_deg,
               "elbow angles for which gains are computed, ascending from 0");
}

void ReadPlan(TableReader plan, PlanAheadConfig* out) {
  plan.Read("moving_weight", &out->moving_weight,
            {"weights of th1 th2 f11 f12 f21 f22 and their rates during a move, without payload",
             "1/(SI unit)^2"});
  plan.Read("resting_weight", &out->resting_weight,
            {"the same from the end of the move on", "1/(SI unit)^2"});
  plan.Read("torque_weight", &out->torque_weight,
            {"weight of the torque of joint 1, 2", "1/(N m)^2"});
  plan.Read("light_kg", &out->light_kg,
            "moving_weight decreases as 1 / (1 + (payload / this)^2): the hubs of a heavy arm must "
            "lead");
  plan.Read("torque_share", &out->torque_share,
            "share of the torque limits that a plan may use; the rest is for the feedback");
  plan.Read("start_alpha", &out->start_alpha,
            {"degree of stability of the gains with which the first plan of a move begins", "1/s"});
  plan.Read("every_periods", &out->every_periods, "from one plan to the next");
  plan.Read("ready_periods", &out->ready_periods,
            "from the request of a plan to its first sample: time for the planner's thread");
  plan.Read("rest_periods", &out->rest_periods, "part of a plan after the end of the move");
  plan.Read(
      "roughness", &out->roughness,
      {"largest change of the torque from sample to sample, as a share of the plan's limits", "1"});
  plan.Read("payload_change_kg", &out->payload_change_kg,
            "after a larger change of the estimate a plan is no start for the next");
  plan.Read("payload_change_share", &out->payload_change_share,
            "or after a change by this share of the payload, if that is more");
}

void ReadSettling(TableReader settling, SettlingConfig* out) {
  settling.Read("alpha", &out->alpha, {"degree of stability of the gains at rest", "1/s"});
  settling.Read("payload_filter_below_mm", &out->payload_filter_below_mm,
                "amplitude of the tip below which the payload filter estimates the state");
  settling.Read("acts_below_mm", &out->acts_below_mm,
                "amplitude below which gains of the estimated payload act and the friction is "
                "compensated");
  settling.Read("hold_below_mm", &out->hold_below_mm,
                "amplitude below which the friction holds the arm again");
  settling.Read("release_above_mm", &out->release_above_mm,
                "amplitude above which it is compensated again");
  settling.Read("process_force_share", &out->process_force_share,
                {"of estimator.payload.process_force at rest, for th1 th2 f11 f12 f21 f22", "1"});
  settling.Read("dead_band_counts", &out->dead_band_counts,
                "counts of an encoder about its prediction that are no motion");
}

void ReadMatrices(TableReader matrices, GainMatrixConfig* out) {
  matrices.ReadIfGiven("T", &out->T,
                       {"p numbers, the diagonal, or p p, row by row; p is 16 with R12; without "
                        "it: adaptation_gain I",
                        "1/(N m)^2"});
  matrices.ReadIfGiven(
      "Tbar", &out->Tbar,
      {"likewise; 2 Tbar - T must not be negative; without it: adaptation_gain I", "1/(N m)^2"});
  matrices.ReadIfGiven("S", &out->S,
                       {"2 numbers, the diagonal, or 4; S'S G > J; without it: I", "1"});
  matrices.ReadIfGiven("K_e", &out->K_e,
                       {"likewise; A - B K_e K must be stable; without it: I", "1"});
  matrices.ReadIfGiven("K_I0", &out->K_I0,
                       {"one number, the share of [K_e S21 S22], or all 2 p; without it: 1", "1"});
}

void ReadAdaptation(TableReader controller, ControllerConfig* out) {
  controller.Read("passivity_margin", &out->passivity_margin,
                  {"G = J + this I: the margin of the passivity that the adaptation needs", "1"});
  controller.Read("adaptation_gain", &out->adaptation_gain,
                  {"of the adaptive gains: T = Tbar = this I", "1/(N m)^2"});
  controller.Read("adaptation_dead_zone_nm", &out->adaptation_dead_zone_nm,
                  "no adaptation while the error signal y_e is smaller");
  controller.Read("adaptation_bound", &out->adaptation_bound,
                  {"largest norm by which the adaptive gains may leave their start", "N m"});
}

void ReadWeights(TableReader controller, ControllerConfig* out) {
  controller.Read("hub_angle_weight", &out->hub_angle_weight,
                  {"weight Q of th1, th2; larger: stiffer", "torque_weight (N m/rad)^2"});
  controller.Read("hub_rate_weight", &out->hub_rate_weight,
                  {"weight Q of their rates; larger: more damping", "torque_weight (N m s/rad)^2"});
  controller.ReadIfGiven("state_weight", &out->state_weight,
                         {"the whole diagonal of Q, one number a state of the nominal model, in "
                          "place of the two above",
                          "torque_weight (N m)^2/(SI unit)^2"});
  controller.Read("torque_weight", &out->torque_weight,
                  {"weight of the torque, R = this I; larger: gentler", "1"});
}

void ReadTables(TableReader controller, ControllerConfig* out) {
  if (controller.Has("matrices")) {
    ReadMatrices(controller.Table("matrices",
                                  "gain matrices of the adaptive laws, (7.11) to (7.14) of the "
                                  "thesis; docs/theory/control-law.md"),
                 &out->matrices.emplace());
  }
  if (controller.Has("payload")) {
    ReadPayloadLaw(
        controller.Table("payload", "settings of the laws that follow the estimated payload"),
        &out->payload.emplace());
  }
  if (controller.Has("plan")) {
    ReadPlan(controller.Table("plan", "the planner of \"receding-horizon\""), &out->plan.emplace());
  }
  if (controller.Has("settling")) {
    ReadSettling(controller.Table("settling",
                                  "how \"sobel\" brings the arm to rest; without it the law is "
                                  "\"sobel-thesis\"; docs/theory/control-law.md"),
                 &out->settling.emplace());
  }
}

}  // namespace

void ReadController(TableReader controller, ControllerConfig* out) {
  std::vector<NamedValue<ControllerKind>> laws;
  laws.reserve(kLaws.size());
  for (const LawRow& law : kLaws) laws.push_back({law.name, law.kind});
  controller.Read("name", &out->kind, laws, "the control law; docs/laws.md says which one to use");
  controller.Read("nominal", &out->nominal,
                  {{"R12", kR12}, {"R8", kR8}, {"T12", kT12}, {"T16", kT16}},
                  "model of law and filter: R with rigid joints, T with torsion, and its number of "
                  "states; docs/nominal-models.md");
  controller.Read(
      "alpha", &out->alpha,
      {"degree of stability: every mode of the design decays at least as exp(-alpha t)", "1/s"});
  controller.Read(
      "vartheta", &out->vartheta,
      {"weight of u_f (7.25) in the feedforward (7.24): vartheta u_f + (1 - vartheta) u_c", "1"});
  controller.Read("sigma", &out->sigma,
                  {"leakage of the adaptive gains in a sample; without it they drift", "1"});
  controller.Read(
      "feedforward_sign", &out->feedforward_sign,
      {{"printed", FeedforwardSign::kPrinted}, {"corrected", FeedforwardSign::kCorrected}},
      "feedforward (7.25) as printed, or with the sign that follows from its derivation");
  ReadWeights(controller, out);
  ReadAdaptation(controller, out);
  controller.Read("pd_stiffness_nm_per_rad", &out->pd_stiffness_nm_per_rad,
                  "gain of the laws pd, pd-zv and pd-zvd on the angles of hub 1, 2");
  controller.Read("pd_damping_nms_per_rad", &out->pd_damping_nms_per_rad,
                  "their gain on the hubs' rates");
  controller.Read("payload_range_kg", &out->payload_range_kg,
                  "least and greatest payload: the loop must be stable with every payload between, "
                  "or the arm is not armed");
  controller.Read("prediction", &out->prediction,
                  "true: the law gets the state predicted for the time at which its torque acts");
  controller.Read("adaptation", &out->adaptation,
                  "false: Sobel's laws keep their first gains, with the same feedforward and "
                  "feedback");
  ReadTables(controller, out);
  controller.ReadIfGiven("gains", &out->gains_file,
                         "file of gains that `flexarm design` wrote for this config; without it "
                         "they are designed at the start");
}

}  // namespace flexarm
