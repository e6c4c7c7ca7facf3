#include "controller/design/gains_check.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "controller/design/design_controller.h"
#include "controller/design/design_matrices.h"
#include "controller/design/robustness_analysis.h"
#include "controller/files/external_text.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

constexpr double kOfItself = 1e-6, kOfTheLargest = 1e-9;

[[noreturn]] void RefuseGains(const std::string& what) {
  throw RejectedError("gains file: " + what +
                      "; the file was damaged or edited: run `flexarm design` again");
}

void CheckNumber(const std::string& name, double found, double expected, double largest) {
  const double allowed = kOfItself * std::fabs(expected) + kOfTheLargest * largest;
  // Also refuses a NaN. Equal infinities pass.
  if (found == expected || std::fabs(found - expected) <= allowed) return;
  std::ostringstream text;
  text.precision(9);
  text << name << " is " << found << ", but the design of this config gives " << expected;
  RefuseGains(text.str());
}

template <typename M>
void CheckMatrix(const std::string& name, const M& found, const M& expected) {
  if (found.rows() != expected.rows() || found.cols() != expected.cols()) {
    RefuseGains("'" + name + "' has another size than the design of this config");
  }
  const double largest = expected.size() == 0 ? 0.0 : expected.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < expected.rows(); ++i) {
    for (Eigen::Index j = 0; j < expected.cols(); ++j) {
      CheckNumber("'" + name + "'[" + std::to_string(i) + "][" + std::to_string(j) + "]",
                  found(i, j), expected(i, j), largest);
    }
  }
}

void CheckList(const std::string& name, const std::vector<double>& found,
               const std::vector<double>& expected) {
  if (found.size() != expected.size()) {
    RefuseGains("'" + name + "' has another size than the design of this config");
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CheckNumber("'" + name + "'[" + std::to_string(i) + "]", found[i], expected[i],
                std::fabs(expected[i]));
  }
}

void CheckTable(const std::string& name, const GainTable& found, const GainTable& expected) {
  CheckList("payload.gain_payload_kg", found.grid().payload_kg, expected.grid().payload_kg);
  CheckList("payload.gain_theta2_rad", found.grid().theta2_rad, expected.grid().theta2_rad);
  for (std::size_t i = 0; i < expected.knots().size(); ++i) {
    CheckMatrix(name + "[" + std::to_string(i) + "]", found.knots()[i], expected.knots()[i]);
  }
}

// The reader has taken what the law of the config needs, so both have the same members.
void CheckPayload(const Design& found, const Design& expected) {
  CheckList("payload.model", found.payload_model, expected.payload_model);
  if (expected.settle_gains && found.settle_gains) {
    CheckTable("payload.gain", *found.settle_gains, *expected.settle_gains);
  }
  if (!expected.scheduled || !found.scheduled) return;
  const ScheduledDesign &a = *found.scheduled, &b = *expected.scheduled;
  CheckNumber("'payload.max_kg'", a.max_kg, b.max_kg, 0.0);
  CheckNumber("'payload.reference_kg'", a.reference_kg, b.reference_kg, 0.0);
  CheckTable("payload.gain", a.gains, b.gains);
  if (a.start_gains && b.start_gains) {
    CheckTable("payload.start_gain", *a.start_gains, *b.start_gains);
  }
}

std::vector<DesignCheck>::iterator Find(const std::string& name, std::vector<DesignCheck>* checks) {
  return std::find_if(checks->begin(), checks->end(),
                      [&name](const DesignCheck& check) { return check.name == name; });
}

// A residual is a rounding error: two processors agree on the verdict, not on its digits.
bool IsResidual(const std::string& name) { return name.ends_with("-residual"); }

void CheckChecks(const std::vector<DesignCheck>& expected, std::vector<DesignCheck>* found) {
  for (DesignCheck computed : expected) {
    const auto same = Find(computed.name, found);
    if (same == found->end()) RefuseGains("the check '" + computed.name + "' is missing");
    if (same->below != computed.below || same->passed() != computed.passed()) {
      RefuseGains("the check '" + computed.name + "' has another result than the design");
    }
    CheckNumber("the limit of the check '" + computed.name + "'", same->limit, computed.limit, 0.0);
    if (!IsResidual(computed.name)) {
      CheckNumber("the check '" + computed.name + "'", same->value, computed.value, 1.0);
    }
    computed.waived = same->waived;
    *same = computed;
  }
  std::vector<DesignCheck> own = expected;
  for (const DesignCheck& check : *found) {
    if (Find(check.name, &own) != own.end() || IsRobustnessCheck(check.name)) continue;
    RefuseGains("the check '" + Shown(check.name) + "' is none of this design");
  }
}

}  // namespace

void CheckGains(const ControlConfig& config, Design* read) {
  const Design expected = DesignController(config);
  ForEachMatrix(*read, [&expected](const std::string& name, const auto& found) {
    ForEachMatrix(expected, [&](const std::string& other, const auto& matrix) {
      if (name == other) CheckMatrix(name, Eigen::MatrixXd(found), Eigen::MatrixXd(matrix));
    });
  });
  CheckPayload(*read, expected);
  CheckChecks(expected.checks, &read->checks);
}

}  // namespace flexarm
