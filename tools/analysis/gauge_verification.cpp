#include "tools/analysis/gauge_verification.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <random>
#include <sstream>
#include <utility>

#include "model/arm/arm_model.h"
#include "model/math/dense_decompositions.h"
#include "model/simulation/arm_simulator.h"
#include "model/units.h"
#include "tools/analysis/gauge_placing.h"
#include "tools/analysis/parametric_study.h"
#include "tools/plot/picture_style.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr int kTrueModes = 4;      // of the simulated arm
constexpr double kLength_s = 3.0;  // of the run
constexpr int kUniforms = 12;      // summed to one normal number
constexpr unsigned kNoiseSeed = 1;

// Normal numbers that are the same with every standard library.
class Noise {
 public:
  double operator()() {
    double sum = -0.5 * kUniforms;
    for (int i = 0; i < kUniforms; ++i) sum += static_cast<double>(engine_()) * 0x1p-32;
    return sum;
  }

 private:
  std::mt19937 engine_{kNoiseSeed};
};

// Gauges of one link, what they read, and the row that turns readings into the tip's deflection.
class FittedGauges {
 public:
  FittedGauges(int link, std::vector<double> position_m, double count_strain, double noise_counts,
               double filter_hz)
      : link_(link),
        position_m_(std::move(position_m)),
        count_strain_(count_strain),
        noise_counts_(noise_counts),
        filter_hz_(filter_hz),
        filtered_(VectorXd::Zero(static_cast<Index>(position_m_.size()))) {}

  const std::vector<double>& position_m() const { return position_m_; }
  void TakeFit(RowVectorXd tip_per_strain) { tip_per_strain_ = std::move(tip_per_strain); }

  void Advance(const ArmModel& model, const VectorXd& q, double step_s) {
    for (std::size_t i = 0; i < position_m_.size(); ++i) {
      double& state = filtered_[static_cast<Index>(i)];
      const double share = filter_hz_ > 0.0 ? -std::expm1(-kTwoPi * filter_hz_ * step_s) : 1.0;
      state += share * (model.Strain(link_, position_m_[i], q) - state);
    }
  }

  double Tip_m(Noise* noise) const {
    VectorXd read = filtered_ / count_strain_;
    for (double& counts : read) counts = std::round(counts + noise_counts_ * (*noise)());
    return count_strain_ * tip_per_strain_.dot(read);
  }

 private:
  int link_;
  std::vector<double> position_m_;
  double count_strain_, noise_counts_, filter_hz_;
  VectorXd filtered_;
  RowVectorXd tip_per_strain_;
};

// (B.1), (B.2): five strains give a_1 .. a_5, and they give w(L).
RowVectorXd PolynomialTip(const LinkParameters& link, const std::vector<double>& position_m) {
  const double L = link.length_m(), half = link.section.front().half_thickness_m;
  MatrixXd strain(5, 5);
  RowVectorXd tip(5);
  for (Index k = 0; k < 5; ++k) {
    const double power = static_cast<double>(k + 2);
    tip[k] = 1.0;  // of (u / L)^power
    for (Index i = 0; i < 5; ++i) {
      const double u = position_m[static_cast<std::size_t>(i)] / L;
      strain(i, k) = half * power * (power - 1.0) * std::pow(u, power - 2.0) / (L * L);
    }
  }
  const MatrixXd transposed = strain.transpose();
  const VectorXd right = tip.transpose();
  return Eigen::PartialPivLU<MatrixXd>(transposed).solve(right).transpose();
}

// The direct fit of modes; psi(L) = 1, so the tip's deflection is their sum.
RowVectorXd ModalTip(const GaugeShapes& shapes, int modes, const std::vector<double>& position_m) {
  MatrixXd S(static_cast<Index>(position_m.size()), modes);
  for (Index i = 0; i < S.rows(); ++i) {
    S.row(i) = shapes.At(position_m[static_cast<std::size_t>(i)]).head(modes);
  }
  const VectorXd size = S.colwise().norm();
  const MatrixXd scaled = S * size.cwiseInverse().asDiagonal();
  const MatrixXd information = scaled.transpose() * scaled, columns = scaled.transpose();
  const MatrixXd inverse = Eigen::PartialPivLU<MatrixXd>(information).solve(columns);
  return size.cwiseInverse().transpose() * inverse;
}

struct LinkGauges {
  FittedGauges polynomial, modal;
};

LinkGauges MakeGauges(const RigConfig& config, const GaugeComparison& gauges, bool filtered) {
  const LinkParameters& link = config.arm.link[static_cast<std::size_t>(gauges.link) - 1];
  const LinkModes modes = gauges.link == 1 ? Link1Modes(config.arm, gauges.task.modes + 1)
                                           : Link2Modes(config.arm, gauges.task.modes + 1);
  const GaugeShapes shapes(link, modes, gauges.task.modes + 1);
  const StrainInputConfig& input = config.sensors.strain_input;
  const double counts = std::sqrt(input.noise_counts * input.noise_counts + 1.0 / 12.0);
  const double count_strain = gauges.task.noise_strain / counts;
  const double filter_hz = filtered ? input.filter_hz : 0.0;
  LinkGauges made{FittedGauges(gauges.link, gauges.thesis.position_m, count_strain,
                               input.noise_counts, filter_hz),
                  FittedGauges(gauges.link, gauges.shipped.position_m, count_strain,
                               input.noise_counts, filter_hz)};
  made.polynomial.TakeFit(PolynomialTip(link, made.polynomial.position_m()));
  made.modal.TakeFit(ModalTip(shapes, gauges.task.modes, made.modal.position_m()));
  return made;
}

void Take(double error_mm, GaugeVerification::Error* error) {
  error->rms_mm += error_mm * error_mm;  // sum of squares until the end of the run
  error->largest_mm = std::max(error->largest_mm, std::abs(error_mm));
}

GaugeVerification::Sample Read(const ArmModel& model, const VectorXd& q,
                               const std::vector<LinkGauges>& gauges, double time_s, Noise* noise) {
  const ModeCount count = model.mode_count();
  GaugeVerification::Sample sample{
      time_s, {1e3 * q.segment(kPhi1, count.link1).sum(), 1e3 * q.tail(count.link2).sum()}, {}, {}};
  for (std::size_t i = 0; i < 2; ++i) {
    sample.polynomial_mm[i] = 1e3 * gauges[i].polynomial.Tip_m(noise);
    sample.modal_mm[i] = 1e3 * gauges[i].modal.Tip_m(noise);
  }
  return sample;
}

void Summarise(GaugeVerification* run) {
  for (std::size_t i = 0; i < 2; ++i) {
    for (const GaugeVerification::Sample& s : run->sample) {
      run->largest_mm[i] = std::max(run->largest_mm[i], std::abs(s.true_mm[i]));
      Take(s.polynomial_mm[i] - s.true_mm[i], &run->polynomial[i]);
      Take(s.modal_mm[i] - s.true_mm[i], &run->modal[i]);
    }
    const auto samples = static_cast<double>(run->sample.size());
    for (GaugeVerification::Error* error : {&run->polynomial[i], &run->modal[i]}) {
      error->rms_mm = std::sqrt(error->rms_mm / samples);
    }
  }
}

}  // namespace

GaugeVerification VerifyGauges(const RigConfig& config, bool filtered) {
  const ArmModel model(config.arm, {kTrueModes, kTrueModes});
  std::vector<LinkGauges> gauges;
  for (const GaugeComparison& link : CompareGauges(config)) {
    gauges.push_back(MakeGauges(config, link, filtered));
  }
  const Excitation excitation = ExcitationFor(config);
  const Eigen::Vector2d torque(excitation.torque_nm[0], excitation.torque_nm[1]);
  const double h = ArmSimulator::kDefaultStep_s;
  const long every = std::max(1L, std::lround(config.loop.period_s() / h));
  ArmSimulator simulator(model);
  ArmState x(model.dof());
  Noise noise;
  GaugeVerification run;
  for (long k = 0; k < std::lround(kLength_s / h); ++k) {
    const double t = (static_cast<double>(k) + 0.5) * h / Excitation::kPeriod_s;
    const double sign = t < 0.5 ? 1.0 : t < 1.0 ? -1.0 : 0.0;
    simulator.Step(x, sign * torque, h);
    for (LinkGauges& link : gauges) {
      link.polynomial.Advance(model, x.q, h);
      link.modal.Advance(model, x.q, h);
    }
    if ((k + 1) % every == 0) {
      run.sample.push_back(Read(model, x.q, gauges, static_cast<double>(k + 1) * h, &noise));
    }
  }
  Summarise(&run);
  return run;
}

void DrawVerification(const GaugeVerification& run, const std::filesystem::path& output,
                      const OutputRules& rules) {
  std::ostringstream script;
  script << PictureHead(output, 1200, 850) << std::setprecision(8) << "$data << EOD\n";
  for (const GaugeVerification::Sample& s : run.sample) {
    script << s.time_s;
    for (std::size_t i = 0; i < 2; ++i) {
      script << ' ' << s.true_mm[i] << ' ' << s.polynomial_mm[i] << ' ' << s.modal_mm[i];
    }
    script << '\n';
  }
  script << "EOD\nset multiplot layout 2,2 title 'Deflection of the tips by the gauges (figure "
            "B.2)'\nset key below\nset xlabel 'time, s'\n";
  for (const int first : {2, 5}) {
    const std::string link = first == 2 ? "link 1" : "link 2";
    script << "set ylabel " << Quoted(link + ": deflection, mm") << "\nplot $data using 1:" << first
           << " with lines lw 3 lc rgb '" << Colour(0)
           << "' title 'true', $data using 1:" << first + 1 << " with points pt 6 lc rgb '"
           << Colour(1) << "' title 'polynomial, five half bridges', $data using 1:" << first + 2
           << " with points pt 2 lc rgb '" << Colour(2) << "' title 'modal fit'\n";
  }
  for (const int first : {2, 5}) {
    const std::string link = first == 2 ? "link 1" : "link 2";
    script << "set ylabel " << Quoted(link + ": error, mm") << "\nplot $data using 1:($"
           << first + 1 << "-$" << first << ") with lines lw 2 lc rgb '" << Colour(1)
           << "' title 'polynomial', $data using 1:($" << first + 2 << "-$" << first
           << ") with lines lw 2 lc rgb '" << Colour(2) << "' title 'modal fit'\n";
  }
  script << "unset multiplot\n";
  DrawPicture(script.str(), output, rules);
}

}  // namespace flexarm
