#include "tools/analysis/reduction_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <stdexcept>

#include "model/reduction/balanced_truncation.h"
#include "model/units.h"

namespace flexarm {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Eigen::Index;

std::vector<double> List(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }

const char* ToString(PowerCondition condition) {
  return condition == PowerCondition::kSymmetric ? "symmetric" : "diagonalisable";
}

const char* ToString(DroppedRoot::Reason reason) {
  switch (reason) {
    case DroppedRoot::Reason::kRigid:
      return "rigid";
    case DroppedRoot::Reason::kNegative:
      return "negative";
    case DroppedRoot::Reason::kComplex:
      return "complex";
  }
  return "";
}

// Notes that a reader needs to compare the figures with others.
OrderedJson Notes(const OrderedJson& power) {
  OrderedJson notes = OrderedJson::array();
  notes.push_back("mu, and so each contribution, depends on how the coordinates are scaled");
  notes.push_back("damping is left out in power balancing; roots are squared frequencies");
  if (!power["dropped_roots"].empty()) {
    notes.push_back(
        "roots that do not oscillate (rigid, negative or complex) are left out: their power grows "
        "without bound");
  }
  for (const OrderedJson& mode : power["modes"]) {
    if (!mode["rigid_origin"].get<bool>()) continue;
    notes.push_back(
        "a rigid-body root has become a slow oscillation: it is included in mu; the shares of rho "
        "are those among the flexible modes, without it");
    break;
  }
  return notes;
}

OrderedJson PowerJson(const PowerBalance& balance) {
  OrderedJson json;
  json["condition"] = ToString(balance.condition);
  double flexible = 0.0;
  for (const PowerMode& mode : balance.mode) flexible += mode.rigid_origin ? 0.0 : mode.rho;
  json["modes"] = OrderedJson::array();
  for (const PowerMode& mode : balance.mode) {
    const double share = flexible > 0.0 ? 100.0 * mode.rho / flexible : 0.0;
    json["modes"].push_back(
        {{"frequency_hz", mode.frequency_rad_s / kTwoPi},
         {"rho", mode.rho},
         {"rho_percent", mode.rigid_origin ? OrderedJson(nullptr) : OrderedJson(share)},
         {"rigid_origin", mode.rigid_origin}});
  }
  json["dropped_roots"] = OrderedJson::array();
  for (const DroppedRoot& root : balance.dropped) {
    json["dropped_roots"].push_back({{"real_rad2_s2", root.squared_frequency_rad2_s2.real()},
                                     {"imaginary_rad2_s2", root.squared_frequency_rad2_s2.imag()},
                                     {"reason", ToString(root.reason)}});
  }
  return json;
}

OrderedJson GramianJson(const BalancedSystem& balanced) {
  OrderedJson json;
  json["hankel"] = List(balanced.hankel);
  json["states_kept_whole"] = balanced.rest_states();
  const int states = static_cast<int>(balanced.stable.A.rows());
  int order = 0;
  while (order < states && ErrorBound(balanced, order) > 0.01 * ErrorBound(balanced, 0)) ++order;
  json["states_within_one_percent"] = order;
  json["error_bound_there"] = ErrorBound(balanced, order);
  return json;
}

// Share of each mode of a link in the reachability Gramian's diagonal: (6.22) with Gramians in
// place of power matrices, as the end of thesis 6.4 suggests.
Eigen::VectorXd GramianShares(const BalancedSystem& balanced, Index first, const LinkModes& link,
                              ModalScaling scaling) {
  const Index modes = link.count(), states = balanced.L.cols();
  const Eigen::VectorXd weight = ModalScale(link, scaling).cwiseAbs2();
  const Eigen::MatrixXd squares = balanced.L.middleRows(first, modes).cwiseAbs2();
  Eigen::VectorXd energy = (squares * balanced.hankel.head(states)).cwiseProduct(weight);
  const double sum = energy.sum();
  std::partial_sum(energy.begin(), energy.end(), energy.begin());
  return 100.0 * energy / sum;
}

OrderedJson Extreme(const std::vector<ReductionCell>& cells,
                    const std::function<double(const ReductionCell&)>& value) {
  const auto less = [&](const ReductionCell& a, const ReductionCell& b) {
    return value(a) < value(b);
  };
  const auto [low, high] = std::minmax_element(cells.begin(), cells.end(), less);
  OrderedJson json;
  for (const auto& [key, cell] : {std::pair{"least", low}, std::pair{"largest", high}}) {
    json[key] = {{"percent", value(*cell)},
                 {"theta2_deg", cell->motion.theta2_rad * kDegPerRad},
                 {"theta1_rate_rad_s", cell->motion.theta1_rate_rad_s},
                 {"theta2_rate_rad_s", cell->motion.theta2_rate_rad_s}};
  }
  return json;
}

void PrintModes(const OrderedJson& power) {
  std::printf("\nmodes of the system     Hz         rho   %% of the flexible modes' rho\n");
  for (const OrderedJson& mode : power["modes"]) {
    std::printf("                  %8.3f %11.4e", mode["frequency_hz"].get<double>(),
                mode["rho"].get<double>());
    if (mode["rho_percent"].is_null()) {
      std::printf("   a rigid-body root\n");
    } else {
      std::printf("   %8.4f\n", mode["rho_percent"].get<double>());
    }
  }
  for (const OrderedJson& root : power["dropped_roots"]) {
    std::printf("left out: root %.3g%+.3gi rad2/s2, %s\n", root["real_rad2_s2"].get<double>(),
                root["imaginary_rad2_s2"].get<double>(), root["reason"].get<std::string>().c_str());
  }
}

void PrintGramians(const OrderedJson& gramians) {
  std::printf("\nHankel singular values, damped:");
  const std::size_t shown = std::min<std::size_t>(8, gramians["hankel"].size());
  for (std::size_t i = 0; i < shown; ++i) {
    std::printf(" %.4g", gramians["hankel"][i].get<double>());
  }
  std::printf(
      "%s\nstates kept as slow or unstable: %d; others needed for an error bound of 1 %%: %d\n",
      shown < gramians["hankel"].size() ? " .." : "", gramians["states_kept_whole"].get<int>(),
      gramians["states_within_one_percent"].get<int>());
}

// Without damping no state decays, so Gramians have no shares.
void PrintShare(double percent) {
  if (std::isfinite(percent)) {
    std::printf("  %8.4f", percent);
  } else {
    std::printf("  %8s", "-");
  }
}

void PrintLinks(const OrderedJson& json) {
  std::printf("elbow %g deg, rates %g and %g rad/s; scaling of phi: %s\n",
              json["theta2_deg"].get<double>(), json["theta1_rate_rad_s"].get<double>(),
              json["theta2_rate_rad_s"].get<double>(), json["scaling"].get<std::string>().c_str());
  std::printf(
      "contribution of the first k modes, %%\n   k   link 1    link 2    by Gramians, damped\n");
  const OrderedJson& links = json["links"];
  const std::size_t modes = std::max(links[0]["mu"].size(), links[1]["mu"].size());
  for (std::size_t k = 0; k < modes; ++k) {
    std::printf("  %2zu", k + 1);
    for (const char* kind : {"epsilon_percent", "gramian_epsilon_percent"}) {
      for (const OrderedJson& link : links) PrintShare(link[kind][k].get<double>());
    }
    std::printf("\n");
  }
}

void PrintGrid(const OrderedJson& grid) {
  std::printf("\n%d cells\n", grid["cells"].get<int>());
  for (const OrderedJson& link : grid["links"]) {
    for (const char* which : {"epsilon_1", "epsilon_2"}) {
      const OrderedJson &low = link[which]["least"], &high = link[which]["largest"];
      std::printf("link %d, %s: %.3f .. %.3f %%, least at %.4g deg, %.3g and %.3g rad/s\n",
                  link["link"].get<int>(), which, low["percent"].get<double>(),
                  high["percent"].get<double>(), low["theta2_deg"].get<double>(),
                  low["theta1_rate_rad_s"].get<double>(), low["theta2_rate_rad_s"].get<double>());
    }
  }
  std::printf(
      "cells with a slow rigid-body oscillation: %d, with a root left out as negative: %d\n",
      grid["cells_with_rigid_oscillation"].get<int>(), grid["cells_with_negative_root"].get<int>());
}

}  // namespace

const char* ToString(ModalScaling scaling) {
  switch (scaling) {
    case ModalScaling::kTip:
      return "tip";
    case ModalScaling::kMass:
      return "mass";
    case ModalScaling::kLength:
      return "length";
  }
  return "";
}

OrderedJson ArmReductionJson(const ArmModel& model, const NominalMotion& motion,
                             const ReductionOptions& options) {
  const ArmReduction reduction =
      ReduceArm(model, motion, options.scaling, options.rigid_below_rad2_s2);
  const BalancedSystem balanced = BalanceGramians(DampedArm(model, motion), options.margin_per_s);
  OrderedJson json{{"theta2_deg", motion.theta2_rad * kDegPerRad},
                   {"theta1_rate_rad_s", motion.theta1_rate_rad_s},
                   {"theta2_rate_rad_s", motion.theta2_rate_rad_s},
                   {"payload_kg", model.parameters().payload_mass_kg},
                   {"modes_per_link", model.mode_count().link1},
                   {"scaling", ToString(options.scaling)}};
  const ArmConstants& c = model.constants();
  for (const int link : {1, 2}) {
    const LinkContribution& contribution = reduction.link[static_cast<std::size_t>(link - 1)];
    const Eigen::VectorXd shares = GramianShares(balanced, link == 1 ? int{kPhi1} : c.phi2(),
                                                 model.link_modes(link), options.scaling);
    json["links"].push_back({{"link", link},
                             {"mu", List(contribution.mu)},
                             {"epsilon_percent", List(contribution.epsilon_percent)},
                             {"gramian_epsilon_percent", List(shares)}});
  }
  json["power"] = PowerJson(reduction.balance);
  json["gramians"] = GramianJson(balanced);
  json["notes"] = Notes(json["power"]);
  return json;
}

OrderedJson SystemReductionJson(const LinearSystemFile& file, const ReductionOptions& options) {
  OrderedJson json{{"system", file.name}, {"power", nullptr}, {"power_refused", file.not_undamped}};
  if (file.undamped) {
    try {
      const PowerBalance balance =
          BalancePower(*file.undamped, {.rigid_below_rad2_s2 = options.rigid_below_rad2_s2});
      json["power"] = PowerJson(balance);
      json["power"]["mu"] = List(balance.mu);
      json["power"]["mu_rate"] = List(balance.mu_rate);
      json["power"]["damping_left_out"] = file.damping_left_out;
      json["power_refused"] = nullptr;
      json["notes"] = Notes(json["power"]);
    } catch (const std::logic_error& refused) {  // neither condition holds, or two roots are equal
      json["power_refused"] = refused.what();
    }
  }
  json["gramians"] = GramianJson(BalanceGramians(file.system, options.margin_per_s));
  return json;
}

OrderedJson GridJson(const ReductionGrid& grid, const std::vector<ReductionCell>& cells) {
  OrderedJson json{{"cells", cells.size()},
                   {"cells_per_axis", grid.cells},
                   {"theta2_deg", grid.theta2_deg},
                   {"theta1_rate_limit_rad_s", grid.theta1_rate_rad_s},
                   {"theta2_rate_limit_rad_s", grid.theta2_rate_rad_s}};
  for (std::size_t link = 0; link < 2; ++link) {
    json["links"].push_back(
        {{"link", link + 1},
         {"epsilon_1",
          Extreme(cells, [link](const ReductionCell& c) { return c.epsilon_1_percent[link]; })},
         {"epsilon_2",
          Extreme(cells, [link](const ReductionCell& c) { return c.epsilon_2_percent[link]; })}});
  }
  const auto count = [&](const auto& is) { return std::count_if(cells.begin(), cells.end(), is); };
  json["cells_with_rigid_oscillation"] =
      count([](const ReductionCell& c) { return c.rigid_share_percent > 0.0; });
  json["cells_with_negative_root"] =
      count([](const ReductionCell& c) { return c.negative_roots > 0; });
  return json;
}

void PrintReduction(const OrderedJson& json) {
  if (json.contains("links")) PrintLinks(json);
  if (json.contains("system")) {
    std::printf("%s\n", json["system"].get<std::string>().c_str());
    if (json["power"].is_null()) {
      std::printf("no power balancing: %s\n", json["power_refused"].get<std::string>().c_str());
    }
  }
  if (!json["power"].is_null()) PrintModes(json["power"]);
  PrintGramians(json["gramians"]);
  if (json.contains("grid")) PrintGrid(json["grid"]);
  if (!json.contains("notes")) return;
  std::printf("\n");
  for (const OrderedJson& note : json["notes"])
    std::printf("- %s\n", note.get<std::string>().c_str());
}

}  // namespace flexarm
