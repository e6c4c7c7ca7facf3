#include "tools/thesis/thesis_check.h"

#include <algorithm>

#include "tools/thesis/appendix_statements.h"
#include "tools/thesis/chapter7_statements.h"
#include "tools/thesis/control_features.h"
#include "tools/thesis/parametric_statements.h"

namespace flexarm {
namespace {

std::vector<Statement> Chapter5Statements(const RigConfig& config) {
  Excitation weak;
  weak.motor_lag_ms = config.sim.motor_lag_ms;
  const ParametricStudy study = RunParametricStudy(config, weak);
  std::vector<Statement> all =
      ParametricStatements(study, RunParametricStudy(config, Strong(weak)));
  all.push_back(MotorLag(config, study));
  return all;
}

std::vector<Statement> ControlStatements(const RigConfig& config, int first_seed) {
  std::vector<Statement> all = ControlFeatureStatements(config);
  for (Statement& statement : Chapter7Statements(ControlStudy(config, first_seed))) {
    all.push_back(std::move(statement));
  }
  return all;
}

std::string ControlIntroduction() {
  return "The statements of chapter 7 are checked with two loops. That with sensors has the noise, "
         "the quantisation, the estimator and the delay of one sample of `config/hil.toml`; its "
         "figures are medians over " +
         std::to_string(ControlStudy::kSeeds) +
         " seeds. The other knows the state and has no delay, as the thesis's simulations "
         "(`flexarm simulate --ideal`). A square doublet of 1 s turns the joints by " +
         Figure(kMove_deg, 2) +
         " degrees, a second one 2 s later turns them back, and 2 s of rest follow. Each row ends "
         "with the loops, seeds and settings that its verdict uses. One figure counts as larger "
         "than another if it is so by more than " +
         Figure(100.0 * kSameShare, 1) +
         " % and by more than the scatter between seeds; a statement on several payloads, joints "
         "or "
         "figures holds if all agree, and in part if some do. `--first-seed` repeats the check "
         "with "
         "other seeds.";
}

}  // namespace

std::vector<Statement> ThesisStatements(const RigConfig& config, int first_seed,
                                        const std::function<void(std::size_t)>& progress) {
  std::vector<Statement> all;
  std::size_t done = 0;
  const auto add = [&](std::vector<Statement> statements) {
    for (Statement& statement : statements) all.push_back(std::move(statement));
    if (progress) progress(++done);
  };
  for (auto* chapter :
       {Chapter3Statements, Chapter4Statements, Chapter5Statements, Chapter6Statements}) {
    add(chapter(config));
  }
  add(ControlStatements(config, first_seed));
  add(AppendixStatements(config));
  std::stable_sort(all.begin(), all.end(),
                   [](const Statement& a, const Statement& b) { return a.section < b.section; });
  return all;
}

std::string ThesisCheckPage(const RigConfig& config, const std::vector<Statement>& statements) {
  const Excitation weak;
  return std::string(kThesisCheckTitle) +
         "\n\nAfter reading this page you know which statements of the thesis agree with the model "
         "of "
         "this project, and by which numbers.\n\n"
         "The table checks statements of chapters 3 to 7 and Appendix B, in our words, against the "
         "model with the "
         "config `" +
         config.rig_name +
         "`. `flexarm analyze check -c FILE -o docs/thesis-check.md` writes this page: every "
         "number "
         "in the third column is computed, every verdict follows from numbers by a rule, and a "
         "test writes the page again and compares. The tests in `tests/model/` check the model by "
         "other means.\n\n"
         "Chapter 5 does not say how strongly the arm was excited. Here the excitation is one "
         "period of a square wave of " +
         Figure(Excitation::kPeriod_s, 1) + " s, " + Figure(weak.torque_nm[0], 1) + " and " +
         Figure(weak.torque_nm[1], 1) + " N m, with the elbow straight, and again with " +
         Figure(kStrongExcitation, 1) + " times as much, and the motors lag by " +
         Figure(config.sim.motor_lag_ms[0], 2) + " and " + Figure(config.sim.motor_lag_ms[1], 2) +
         " ms, `sim.motor_lag_ms`. Bending is the deflection of a link's tip, twist the deflection "
         "of a "
         "joint's spring; \"largest\" is over the whole run, \"after the excitation\" refers to "
         "the "
         "free vibration. An interaction counts above " +
         Figure(100.0 * kInteractionShare, 1) + " % of the effect of the link's own length.\n\n" +
         ControlIntroduction() + "\n\n" + StatementTable(statements) + "\n" + Counted(statements) +
         ".\n";
}

}  // namespace flexarm
