#include "tools/analysis/excitation_run.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "model/arm/dc_motor.h"
#include "model/simulation/arm_simulator.h"
#include "model/units.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"

namespace flexarm {
namespace {

ExcitationRun::Sample SampleOf(const ArmModel& model, const ArmState& x, double time_s) {
  return {time_s,
          {1e3 * x.q.segment(kPhi1, model.mode_count().link1).sum(),
           1e3 * x.q.tail(model.mode_count().link2).sum()},
          {kDegPerRad * x.q[kTheta1], kDegPerRad * x.q[kTheta2]}};
}

}  // namespace

ExcitationRun RunExcitation(const ArmModel& model, double theta2_deg, const Excitation& excitation,
                            double duration_s) {
  ArmSimulator simulator(model);
  ArmState x(model.dof());
  x.q[kTheta2] = x.q[kTheta4] = theta2_deg / kDegPerRad;
  const double h = ArmSimulator::kDefaultStep_s;
  DcMotor motor1(h, 1e-3 * excitation.motor_lag_ms[0]);
  DcMotor motor2(h, 1e-3 * excitation.motor_lag_ms[1]);
  const auto steps = std::lround(duration_s / h);
  ExcitationRun run;
  run.sample.push_back(SampleOf(model, x, 0.0));
  for (long k = 0; k < steps; ++k) {
    const double t = (static_cast<double>(k) + 0.5) * h / Excitation::kPeriod_s;
    const double sign = t < 0.5 ? 1.0 : t < 1.0 ? -1.0 : 0.0;
    const double torque1 = motor1.Step(sign * excitation.torque_nm[0]);
    const double torque2 = motor2.Step(sign * excitation.torque_nm[1]);
    simulator.Step(x, {torque1, torque2}, h);
    run.sample.push_back(SampleOf(model, x, static_cast<double>(k + 1) * h));
    for (std::size_t i = 0; i < 2; ++i) {
      run.peak_bending_mm[i] =
          std::max(run.peak_bending_mm[i], std::fabs(run.sample.back().bending_mm[i]));
    }
  }
  run.tip_m = model.TipPosition(x.q);
  return run;
}

void DrawExcitation(const ExcitationRun& run, const std::filesystem::path& output,
                    const OutputRules& rules) {
  std::ostringstream script;
  script << PictureHead(output, 1200, 800) << std::setprecision(8) << "$data << EOD\n";
  const std::size_t stride = std::max<std::size_t>(1, run.sample.size() / 2000);
  for (std::size_t i = 0; i < run.sample.size(); i += stride) {
    const ExcitationRun::Sample& s = run.sample[i];
    script << s.time_s << ' ' << s.bending_mm[0] << ' ' << s.bending_mm[1] << ' ' << s.joint_deg[0]
           << ' ' << s.joint_deg[1] << '\n';
  }
  script << "EOD\nset multiplot layout 2,2 title 'One period of a square wave of torque of 1 s, "
            "from rest'\nunset key\nset xlabel 'time, s'\n";
  int column = 2;
  for (const char* label :
       {"bending of link 1, mm", "bending of link 2, mm", "joint 1, deg", "joint 2, deg"}) {
    script << "set ylabel " << Quoted(label) << "\nplot $data using 1:" << column << " with lines "
           << CurveStyle(0) << '\n';
    ++column;
  }
  script << "unset multiplot\n";
  DrawPicture(script.str(), output, rules);
}

}  // namespace flexarm
