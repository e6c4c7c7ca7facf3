#include "tools/report/overview.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include "controller/host/simulation.h"
#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/plot_script.h"
#include "tools/report/arm_picture.h"
#include "tools/thesis/control_study.h"

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
       {"sampling period, ms", Figure(config.loop.period_ms)}});
}

// A run of the law of the config, drawn as `flexarm plot` does.
void Run(ReportContext* context, HtmlPage* page) {
  const auto log = context->folder / "runs" / "overview.flexarm";
  Simulate({.config = context->config,
            .experiment = ControlCommand(DoubletShape::kSquare),
            .payload_kg = context->config.arm.payload_mass_kg,
            .log = log});
  const auto figure = context->Figure("overview-run");
  DrawPicture(PlotScript({PlotDataOf(LoadRun(log))}, figure), figure);
  page->Picture(
      figure,
      "The base command, with the law of the config on the simulated rig: both joints turn by 30 "
      "degrees, rest and turn back.");
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
  page->Heading("Main result");
  for (const std::string& result : context->results) page->Paragraph(result);
  Run(context, page);
  Verdicts(context->statements, page);
  Arm(context, page);
}

}  // namespace flexarm
