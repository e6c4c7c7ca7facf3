#include "tools/report/overview.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>

#include "controller/host/simulation.h"
#include "controller/types/rejected_error.h"
#include "controller/types/rounded_text.h"
#include "controller/types/tip_tolerance.h"
#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/plot_script.h"
#include "tools/report/arm_picture.h"

namespace flexarm {
namespace {

std::string Two(double first, double second) { return Figure(first) + " and " + Figure(second); }

std::string Lowest(const Eigen::VectorXd& hz) {
  std::string text;
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(3, hz.size()); ++i) {
    text += (i > 0 ? ", " : "") + Figure(hz[i]);
  }
  return text + " Hz";
}

std::size_t GaugesOf(const RigConfig& config, int link) {
  return static_cast<std::size_t>(
      std::count_if(config.sensors.strain.begin(), config.sensors.strain.end(),
                    [link](const auto& channel) { return channel.link == link; }));
}

void Arm(ReportContext* context, HtmlPage* page) {
  const RigConfig& config = context->config;
  const ArmParameters& arm = config.arm;
  const auto& link = arm.link;
  const auto& joint = arm.joint;
  const ArmModel model(arm, {2, 2});
  page->Heading("The arm");
  const auto figure = context->Figure("arm");
  DrawArm(config, figure);
  page->Picture(figure,
                "The arm from above, to scale, with the elbow at 40 degrees. Squares: gauges.");
  page->Table(
      {"parameter", "links or joints 1 and 2"},
      {{"length, m", Two(link[0].length_m(), link[1].length_m())},
       {"mass of the links, kg", Two(link[0].mass_kg(), link[1].mass_kg())},
       {"rotor inertia at the gearbox output, kg m2",
        Two(joint[0].rotor_inertia_kgm2, joint[1].rotor_inertia_kgm2)},
       {"joint stiffness, N m/rad",
        Two(joint[0].stiffness_nm_per_rad, joint[1].stiffness_nm_per_rad)},
       {"Coulomb friction, N m", Two(joint[0].coulomb_friction_nm, joint[1].coulomb_friction_nm)},
       {"torque limit, N m",
        Two(config.safety.torque_limit_nm[0], config.safety.torque_limit_nm[1])},
       {"gauges", Count(static_cast<std::ptrdiff_t>(GaugesOf(config, 1))) + " and " +
                      Count(static_cast<std::ptrdiff_t>(GaugesOf(config, 2)))},
       {"elbow with motor, kg; payload designed for, kg",
        Two(arm.hub2_mass_kg + arm.motor2_mass_kg, arm.payload_mass_kg)},
       {"lowest frequencies, motors free", Lowest(FreeMotorFrequenciesHz(model, 0))},
       {"lowest frequencies, motors held", Lowest(HeldMotorFrequenciesHz(model, 0))},
       {"payloads that the laws are for, kg",
        RoundedText(config.controller.payload_range_kg[0], 3) + " to " +
            RoundedText(config.controller.payload_range_kg[1], 3)},
       {"sampling period, ms", Figure(config.loop.period_ms)}});
}

std::string SettlingCell(const RunMetrics& metrics) {
  return metrics.tip_settling_time_s ? Figure(*metrics.tip_settling_time_s) : "not settled";
}

std::string FigureOrDash(double value) { return std::isfinite(value) ? Figure(value) : "-"; }

void RunTable(const RigConfig& config, const SimulationResult& result, HtmlPage* page) {
  const RunMetrics& m = result.metrics;
  page->Table(
      {"run of the law " + std::string(LawOf(config.controller.kind).name), ""},
      {{"completed",
        result.completed ? "yes" : "no, it trips: " + std::string(ToString(result.trip))},
       {"settled within " + Figure(1e3 * SettledWithin_m(config), 2) + " mm after the move, s",
        SettlingCell(m)},
       {"tip off its target, mm", FigureOrDash(m.tip_target_error_mm)},
       {"rms error of joints 1 and 2, deg",
        FigureOrDash(m.joint_rms_error_deg[0]) + " and " + FigureOrDash(m.joint_rms_error_deg[1])},
       {"peak torque, N m",
        FigureOrDash(m.peak_torque_nm[0]) + " and " + FigureOrDash(m.peak_torque_nm[1])}});
}

// A run of the law of the config, drawn as `flexarm plot` does.
void Run(ReportContext* context, HtmlPage* page) {
  const auto log = context->folder / "runs" / "overview.flexarm";
  const RigConfig& config = context->config;
  page->Heading("Summary");
  try {
    const SimulationResult result = Simulate({.config = config,
                                              .experiment = context->experiment,
                                              .payload_kg = config.arm.payload_mass_kg,
                                              .log = log});
    RunTable(config, result, page);
  } catch (const RejectedError& error) {
    page->Paragraph(std::string("The law of the config does not run: ") + error.what());
    return;
  }
  const auto figure = context->Figure("overview-run");
  DrawPicture(PlotScript({PlotDataOf(LoadRun(log))}, figure), figure);
  page->Picture(figure, "The experiment " + context->experiment.name +
                            ", with the law of the config on the simulated rig, " +
                            RoundedText(config.arm.payload_mass_kg, 3) + " kg.");
}

// "Chapter 7" of "7.3.3".
std::string ChapterOf(const std::string& section) {
  const std::string first = section.substr(0, section.find('.'));
  const bool number = !first.empty() && std::isdigit(static_cast<unsigned char>(first[0])) != 0;
  return number ? "Chapter " + first : "Appendix " + first.substr(0, 1);
}

void Verdicts(const std::vector<Statement>& statements, HtmlPage* page) {
  constexpr std::array kVerdicts = {Verdict::kHolds, Verdict::kInPart, Verdict::kDepends,
                                    Verdict::kDoesNot, Verdict::kNotTested};
  std::map<std::string, std::vector<Statement>> chapters;
  for (const Statement& statement : statements) {
    chapters[ChapterOf(statement.section)].push_back(statement);
  }
  std::vector<std::string> head = {"", "statements"};
  for (const Verdict verdict : kVerdicts) head.emplace_back(ToString(verdict));
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const std::vector<Statement>& of) {
    std::vector<std::string> row = {name, Count(std::ssize(of))};
    for (const Verdict verdict : kVerdicts) {
      row.push_back(
          Count(std::count_if(of.begin(), of.end(), [verdict](const Statement& statement) {
            return statement.verdict == verdict;
          })));
    }
    rows.push_back(row);
  };
  for (const auto& [name, of] : chapters) add(name, of);
  add("all", statements);
  page->Heading("The thesis's statements");
  page->Table(head, rows);
}

}  // namespace

void Overview(ReportContext* context, HtmlPage* page) {
  Arm(context, page);
  page->Heading("Main result");
  for (const std::string& result : context->results) page->Paragraph(result);
  Run(context, page);
  if (!context->statements.empty()) Verdicts(context->statements, page);
}

}  // namespace flexarm
