#include "model/perturbation/perturbation_run.h"
#include "model/simulation/arm_simulator.h"
#include "tools/analysis/excitation_run.h"
#include "tools/analysis/parametric_report.h"
#include "tools/analysis/perturbation_figures.h"
#include "tools/analysis/reduction_figures.h"
#include "tools/report/chapters.h"
#include "tools/support/parallel_for.h"
#include "tools/thesis/parametric_statements.h"
#include "tools/thesis/thesis_check.h"

namespace flexarm {
namespace {

// Table 2 of the thesis beside the parameters of the rig.
void ParameterTable(const ArmParameters& arm, HtmlPage* page) {
  const BeamSection &first = arm.link[0].section.front(), &second = arm.link[1].section.front();
  const auto row = [](const char* name, const char* printed, double used) {
    return std::vector<std::string>{name, printed, Figure(used, 4)};
  };
  page->Table({"Table 2", "printed", "used"},
              {row("L1, m", "0.8", arm.link[0].length_m()),
               row("A1, m2", "1.575e-4", first.area_m2),
               row("D1, kg/m3", "2.707e4", first.density_kg_m3),
               row("E1, N/m2", "6.890e11", first.youngs_modulus_pa),
               row("I1, m4", "2.657e-10", first.second_moment_m4),
               row("L2, m", "0.9", arm.link[1].length_m()),
               row("A2, m2", "9.525e-5", second.area_m2),
               row("D2, kg/m3", "2.707e4", second.density_kg_m3),
               row("E2, N/m2", "6.890e11", second.youngs_modulus_pa),
               row("I2, m4", "8.001e-11", second.second_moment_m4),
               row("K1, N m/rad", "761.59", arm.joint[0].stiffness_nm_per_rad),
               row("K2, N m/rad", "497.96", arm.joint[1].stiffness_nm_per_rad),
               row("J1, kg m2", "1.07e-2", arm.joint[0].rotor_inertia_kgm2),
               row("J2, kg m2", "9.25e-3", arm.joint[1].rotor_inertia_kgm2),
               row("KF1, N m", "0.16", arm.joint[0].coulomb_friction_nm),
               row("KF2, N m", "0.01", arm.joint[1].coulomb_friction_nm),
               row("Mh2, kg", "0.24", arm.hub2_mass_kg),
               row("Mr2, kg", "3.03", arm.motor2_mass_kg),
               row("Ir2, kg m2", "1.15e-2", arm.motor2_inertia_kgm2),
               row("Ih1, kg m2", "1.43e-7", arm.joint[0].hub_inertia_kgm2),
               row("Ih2, kg m2", "1.05e-7", arm.joint[1].hub_inertia_kgm2),
               row("Ratio 1", "0.03", arm.link[0].damping_ratio),
               row("Ratio 2", "0.03", arm.link[1].damping_ratio),
               row("Ip, kg m2", "1.078e-7", arm.payload_inertia_kgm2),
               row("Mp, kg", "0.1", arm.payload_mass_kg)});
}

// Table 1 of the thesis, and what stands for each component here.
void ComponentTable(HtmlPage* page) {
  page->Table({"Table 1", "component", "here"},
              {{"1", "support", "the base, rigid"},
               {"2", "DC motor 1", "torque 1; rotor in J1"},
               {"3", "optical encoder 1", "sensors.encoder rotor1"},
               {"4", "driving gear pair, 5:1", "in J1 and the torque, at the gearbox output"},
               {"5", "flexible joint 1", "K1"},
               {"6", "link 1", "link1"},
               {"7", "optical encoder 3", "sensors.encoder rotor2"},
               {"8", "DC motor 2, with a harmonic drive of 48.96:1", "torque 2; Mr2, Ir2, J2"},
               {"9", "flexible joint 2", "K2"},
               {"10", "hub 2", "Mh2, Ih2"},
               {"11", "link 2", "link2"},
               {"12", "optical encoder 4", "sensors.encoder hub2"},
               {"13", "hub 1", "Ih1"},
               {"14", "optical encoder 2", "sensors.encoder hub1"},
               {"15", "payload", "Mp, Ip"}});
}

// Figures 6.1 and 6.2: a small square wave on the arm at rest.
void LinearisationFigure(ReportContext* context, HtmlPage* page) {
  constexpr double kDuration_s = 2.0;
  const Eigen::Vector2d delta_nm(0.05, 0.0125);
  const ArmModel model(context->config.arm, {4, 4});
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(model.dof());
  const PerturbationRun run = Perturb(
      model, rest, rest, [](double) { return Eigen::Vector2d(0.0, 0.0); },
      [delta_nm](double t) {
        return Eigen::Vector2d((t < 0.5 ? 1.0 : t < 1.0 ? -1.0 : 0.0) * delta_nm);
      },
      kDuration_s, ArmSimulator::kDefaultStep_s);
  const auto figure = context->Figure("figure-6.1-6.2");
  DrawPerturbation(model, run, figure);
  page->Picture(figure,
                "Figures 6.1 and 6.2: deviations after a small square wave of torque, linear model "
                "over nonlinear one.");
}

// "Figure 5.1 payload" and the rest, for figure-5.1-payload.png.
std::string CaptionOf(const std::filesystem::path& file, const char* rest) {
  std::string caption("Figure");
  for (const char c : file.stem().string().substr(caption.size())) caption += c == '-' ? ' ' : c;
  return caption + rest;
}

}  // namespace

void Chapter3(ReportContext* context, HtmlPage* page) {
  page->Section("Chapter 3: the model");
  Say(Chapter3Statements(context->config), context, page);
}

void Chapter4(ReportContext* context, HtmlPage* page) {
  page->Section("Chapter 4: the rig");
  page->Paragraph(
      "Table 2 prints Young's modulus and density ten times too large; the rig is aluminium. "
      "Section 4.2.1 gives link 1 the length of 0.9 m and link 2 that of 0.8 m, Table 2 the other "
      "way round: this rig follows Table 2. Which encoder of Table 1 sits on which shaft is read "
      "from the text, not from figure 4.1, and is an assumption.");
  ComponentTable(page);
  ParameterTable(context->config.arm, page);
  const ArmModel model(context->config.arm, {4, 4});
  const auto figure = context->Figure("figure-4.4-4.5");
  Excitation excitation;
  excitation.motor_lag_ms = context->config.sim.motor_lag_ms;
  DrawExcitation(RunExcitation(model, 0.0, excitation, 3.0), figure);
  page->Picture(figure,
                "Figures 4.4 and 4.5: bending of the links and angles of the joints after a square "
                "wave of torque of 1 s. The thesis does not state its amplitude: 0.4 and 0.1 N m.");
  Say(Chapter4Statements(context->config), context, page);
}

void Chapter5(ReportContext* context, HtmlPage* page) {
  page->Section("Chapter 5: effect of the parameters");
  Excitation weak;
  weak.motor_lag_ms = context->config.sim.motor_lag_ms;
  const ParametricStudy study = RunParametricStudy(context->config, weak);
  std::vector<Statement> statements =
      ParametricStatements(study, RunParametricStudy(context->config, Strong(weak)));
  statements.push_back(MotorLag(context->config, study));
  const std::filesystem::path folder = context->folder / "tables" / "chapter-5";
  for (const auto& file : WriteParametricFolder(study, statements, folder)) {
    if (file.extension() != ".png") continue;
    page->Picture(file, CaptionOf(file, ": spectra, largest bending and largest twist over it."));
  }
  Say(statements, context, page);
}

void Chapter6(ReportContext* context, HtmlPage* page) {
  page->Section("Chapter 6: linearisation and order reduction");
  LinearisationFigure(context, page);
  const ArmModel model(context->config.arm, {10, 10});
  for (const auto& file : DrawReductionFigures(model, {}, context->folder / "figures")) {
    page->Picture(file, CaptionOf(file, ": power contributions by mass-normalised modes."));
  }
  Say(Chapter6Statements(context->config), context, page);
}

}  // namespace flexarm
