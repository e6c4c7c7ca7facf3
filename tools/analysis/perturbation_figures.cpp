#include "tools/analysis/perturbation_figures.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "model/units.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"

namespace flexarm {
namespace {

// th1, th2 in deg and the tip deflections in mm: with psi(L) = 1 the sum of the modal coordinates.
void AddRow(const ArmModel& model, const Eigen::VectorXd& q, std::ostream* out) {
  *out << ' ' << kDegPerRad * q[kTheta1] << ' ' << kDegPerRad * q[kTheta2] << ' '
       << 1e3 * q.segment(kPhi1, model.mode_count().link1).sum() << ' '
       << 1e3 * q.tail(model.mode_count().link2).sum();
}

}  // namespace

void DrawPerturbation(const ArmModel& model, const PerturbationRun& run,
                      const std::filesystem::path& output, const OutputRules& rules) {
  std::ostringstream script;
  script << PictureHead(output, 1200, 800) << std::setprecision(8) << "$data << EOD\n";
  const std::size_t stride = std::max<std::size_t>(1, run.time_s.size() / 2000);
  for (std::size_t i = 0; i < run.time_s.size(); i += stride) {
    script << run.time_s[i];
    AddRow(model, run.nonlinear[i], &script);
    AddRow(model, run.linear[i], &script);
    script << '\n';
  }
  script << "EOD\nset multiplot layout 2,2 title 'Deviation from the nominal motion, linear and "
            "nonlinear model'\nset tmargin 3.5\nset xlabel 'time, s'\n";
  int column = 2;
  for (const char* label :
       {"joint 1, deg", "joint 2, deg", "tip of link 1, mm", "tip of link 2, mm"}) {
    script << "set ylabel " << Quoted(label) << "\nplot $data using 1:" << column << " with lines "
           << CurveStyle(0, 4.0) << " title 'nonlinear', '' using 1:" << column + 4
           << " with lines " << CurveStyle(1) << " title 'linear'\n";
    ++column;
  }
  script << "unset multiplot\n";
  DrawPicture(script.str(), output, rules);
}

}  // namespace flexarm
