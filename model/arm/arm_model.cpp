#include "model/arm/arm_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/arm/arm_equations.h"
#include "model/beam/quadrature.h"
#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

// R(angle) [x, y] and its derivative for a turning frame.
Vector2d Turned(double angle, const Vector2d& p) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

Vector2d Crossed(double rate, const Vector2d& p) { return {-rate * p.y(), rate * p.x()}; }

// Quantities of MassMatrix that foreshortening changes before the sum over the bodies.
struct Turn {
  double sine, cosine;  // of frame 1 to frame 2
};

void AddShortening(const ArmConstants& c, const VectorXd& f1, const VectorXd& f2, const Turn& turn,
                   const VectorXd& gamma, VectorXd* x, VectorXd* y, MatrixXd* M, double* Sx,
                   double* I2) {
  const VectorXd none1 = VectorXd::Zero(c.m1), none2 = VectorXd::Zero(c.m2);
  const ShortenedLink<double, Eigen::Dynamic> link1(c.shortening1, f1, none1, none1);
  const ShortenedLink<double, Eigen::Dynamic> link2(c.shortening2, f2, none2, none2);
  (*x)[kTheta1] -= turn.sine * link1.tip;
  (*y)[kTheta1] -= turn.cosine * link1.tip;
  x->segment(kPhi1, c.m1) -= turn.cosine * link1.tip_slope;
  y->segment(kPhi1, c.m1) += turn.sine * link1.tip_slope;
  (*M)(kTheta1, kTheta1) += link1.second_moment;
  M->block(kPhi1, kTheta1, c.m1, 1) += link1.coupling;
  M->block(kPhi1, kPhi1, c.m1, c.m1) += ShorteningMass<Eigen::Dynamic>(c.shortening1, f1);
  M->bottomRightCorner(c.m2, c.m2) += ShorteningMass<Eigen::Dynamic>(c.shortening2, f2);
  M->bottomLeftCorner(c.m2, c.phi2()) = c.k2 * y->head(c.phi2()).transpose() -
                                        link2.k_slope * x->head(c.phi2()).transpose() +
                                        (c.a2 + link2.coupling) * gamma.head(c.phi2()).transpose();
  *Sx -= link2.k;
  *I2 += link2.second_moment;
}

}  // namespace

ArmModel::ArmModel(const ArmParameters& parameters, ModeCount count)
    : parameters_(parameters), constants_(parameters, count) {
  const ArmConstants& c = constants_;
  stiffness_ = damping_ = MatrixXd::Zero(dof(), dof());
  for (const auto& [hub, rotor, K] :
       {std::tuple{kTheta1, kTheta3, c.K1}, std::tuple{kTheta2, kTheta4, c.K2}}) {
    stiffness_(hub, hub) = stiffness_(rotor, rotor) = K;
    stiffness_(hub, rotor) = stiffness_(rotor, hub) = -K;
  }
  stiffness_.block(kPhi1, kPhi1, c.m1, c.m1) = c.link1.G;
  stiffness_.bottomRightCorner(c.m2, c.m2) = c.link2.G;
  damping_(kTheta1, kTheta1) = c.viscous[0];
  damping_(kTheta2, kTheta2) = c.viscous[1];
  damping_.block(kPhi1, kPhi1, c.m1, c.m1) = c.link1.D;
  damping_.bottomRightCorner(c.m2, c.m2) = c.link2.D;
}

const LinkModes& ArmModel::link_modes(int link) const {
  if (link == 1) return constants_.link1;
  if (link == 2) return constants_.link2;
  throw std::out_of_range("ArmModel: the link must be 1 or 2");
}

void ArmModel::CarryPayload(double payload_kg) noexcept {
  parameters_.payload_mass_kg = payload_kg;
  constants_.CarryPayload(parameters_);
}

// M = sum of T' m T over the bodies, T their velocities as rows over q'. Implemented independently
// of InertialForces, so that tests compare the two.
MatrixXd ArmModel::MassMatrix(const VectorXd& q) const {
  const ArmConstants& c = constants_;
  const VectorXd f1 = ModalPart(1, q), f2 = ModalPart(2, q);
  const double w = c.link1.psi_tip.dot(f1), s = c.link1.slope_tip.dot(f1);
  const double s2 = c.link2.slope_tip.dot(f2), beta = q[kTheta2] + std::atan(s);
  const double sb = std::sin(beta), cb = std::cos(beta);

  VectorXd x = VectorXd::Zero(dof()), y = x, turn = x;  // elbow along and across link 2; stator 2
  x[kTheta1] = -cb * w + sb * c.L1;
  y[kTheta1] = sb * w + cb * c.L1;
  x.segment(kPhi1, c.m1) = sb * c.link1.psi_tip;
  y.segment(kPhi1, c.m1) = cb * c.link1.psi_tip;
  turn[kTheta1] = 1.0;
  turn.segment(kPhi1, c.m1) = c.link1.slope_tip / (1.0 + s * s);
  const VectorXd gamma = turn + VectorXd::Unit(dof(), kTheta2);
  const VectorXd rotor2 = turn + VectorXd::Unit(dof(), kTheta4);
  VectorXd payload = gamma;
  payload.tail(c.m2) = c.link2.slope_tip / (1.0 + s2 * s2);

  MatrixXd M = MatrixXd::Zero(dof(), dof());
  M(kTheta1, kTheta1) = c.I1 + f1.dot(c.link1.N * f1);
  M(kTheta3, kTheta3) = c.J1;
  M.block(kPhi1, kTheta1, c.m1, 1) = c.link1.a;
  M.block(kPhi1, kPhi1, c.m1, c.m1) = c.link1.N;
  M.bottomRightCorner(c.m2, c.m2) = c.N2;
  M.bottomLeftCorner(c.m2, c.phi2()) =
      c.k2 * y.head(c.phi2()).transpose() + c.a2 * gamma.head(c.phi2()).transpose();
  double Sx = c.Sx, I2 = c.I2 + f2.dot(c.N2 * f2);
  if (c.foreshortening) AddShortening(c, f1, f2, {sb, cb}, gamma, &x, &y, &M, &Sx, &I2);
  auto lower = M.selfadjointView<Eigen::Lower>();
  lower.rankUpdate(x, c.m_outboard).rankUpdate(y, c.m_outboard);
  lower.rankUpdate(x, gamma, -c.k2.dot(f2)).rankUpdate(y, gamma, Sx);
  lower.rankUpdate(gamma, I2).rankUpdate(turn, c.Ir2);
  lower.rankUpdate(rotor2, c.J2).rankUpdate(payload, c.Ip);
  return lower;
}

VectorXd ArmModel::Bias(const VectorXd& q, const VectorXd& v) const {
  return InertialForces<double>(constants_, q, v, VectorXd::Zero(dof()));
}

VectorXd ArmModel::Acceleration(const VectorXd& q, const VectorXd& v,
                                const VectorXd& generalized_force) const {
  VectorXd force = generalized_force - Bias(q, v) - damping_ * v - stiffness_ * q;
  if (constants_.backlash.active()) force += BacklashForce(q, v);
  return MassMatrix(q).llt().solve(force);
}

VectorXd ArmModel::BacklashForce(const VectorXd& q, const VectorXd& v) const {
  const double twist = q[kTheta4] - q[kTheta2], twist_rate = v[kTheta4] - v[kTheta2];
  const Joint2Torque joint = constants_.backlash.At(twist, twist_rate, v[kTheta4]);
  const double added = joint.spring_nm - constants_.K2 * twist;
  VectorXd force = VectorXd::Zero(dof());
  force[kTheta2] = added;
  force[kTheta4] = -added - joint.drag_nm;
  return force;
}

MatrixXd ArmModel::InputMatrix() const {
  MatrixXd B = MatrixXd::Zero(dof(), 2);
  B(kTheta3, 0) = B(kTheta4, 1) = 1.0;
  return B;
}

double ArmModel::KineticEnergy(const VectorXd& q, const VectorXd& v) const {
  return 0.5 * v.dot(InertialForces<double>(constants_, q, VectorXd::Zero(dof()), v));
}

double ArmModel::PotentialEnergy(const VectorXd& q) const {
  const double twist = q[kTheta4] - q[kTheta2], wound = constants_.backlash.Wound(twist);
  return 0.5 * q.dot(stiffness_ * q) - 0.5 * constants_.K2 * (twist * twist - wound * wound);
}

VectorXd ArmModel::ModalPart(int link, const VectorXd& q) const {
  return link == 1 ? q.segment(kPhi1, constants_.m1) : q.tail(constants_.m2);
}

double ArmModel::Deflection(int link, double u_m, const VectorXd& coordinates) const {
  const LinkModes& modes = link_modes(link);
  const VectorXd phi = ModalPart(link, coordinates);
  double w = 0.0;
  for (int i = 0; i < modes.count(); ++i) {
    w += modes.mode[static_cast<std::size_t>(i)].Value(u_m) * phi[i];
  }
  return w;
}

// int_0^u a' b' for deflections a, b: half of it, for a = b, is the bent link's loss of length; for
// w, w_dot it is the rate of that. By quadrature of the slopes, independent of the products used in
// the equations.
double ArmModel::Shortening(int link, double u_m, const VectorXd& a, const VectorXd& b) const {
  if (!constants_.foreshortening) return 0.0;
  const LinkModes& modes = link_modes(link);
  const VectorXd phi_a = ModalPart(link, a), phi_b = ModalPart(link, b);
  if (phi_a.isZero(0.0) || phi_b.isZero(0.0)) return 0.0;  // unbent: no need for the slopes
  double sum = 0.0, start = 0.0;
  for (const BeamSection& s : parameters_.link[static_cast<std::size_t>(link - 1)].section) {
    const double length = std::min(s.length_m, u_m - start);
    if (length <= 0.0) break;
    const int panels = std::max(1, static_cast<int>(std::ceil(length / modes.panel_m)));
    for (int i = 0; i < panels; ++i) {
      const double from = start + i * length / panels;
      AtGaussNodes(from, from + length / panels, [&](double x, double weight) {
        double slope_a = 0.0, slope_b = 0.0;
        for (int j = 0; j < modes.count(); ++j) {
          const double slope = modes.mode[static_cast<std::size_t>(j)].Slope(x);
          slope_a += slope * phi_a[j];
          slope_b += slope * phi_b[j];
        }
        sum += weight * slope_a * slope_b;
      });
    }
    start += s.length_m;
  }
  return sum;
}

Vector2d ArmModel::Point(int link, double u_m, const VectorXd& q) const {
  const Vector2d p(u_m - 0.5 * Shortening(link, u_m, q, q), Deflection(link, u_m, q));
  if (link == 1) return Turned(q[kTheta1], p);
  const double alpha = std::atan(constants_.link1.slope_tip.dot(ModalPart(1, q)));
  return Point(1, constants_.L1, q) + Turned(q[kTheta1] + alpha + q[kTheta2], p);
}

Vector2d ArmModel::PointVelocity(int link, double u_m, const VectorXd& q, const VectorXd& v) const {
  const Vector2d p(u_m - 0.5 * Shortening(link, u_m, q, q), Deflection(link, u_m, q));
  const Vector2d p_dot(-Shortening(link, u_m, q, v), Deflection(link, u_m, v));
  if (link == 1) return Turned(q[kTheta1], p_dot + Crossed(v[kTheta1], p));
  const double s = constants_.link1.slope_tip.dot(ModalPart(1, q));
  const double alpha_dot = constants_.link1.slope_tip.dot(ModalPart(1, v)) / (1.0 + s * s);
  const double gamma = q[kTheta1] + std::atan(s) + q[kTheta2];
  const double gamma_dot = v[kTheta1] + alpha_dot + v[kTheta2];
  return PointVelocity(1, constants_.L1, q, v) + Turned(gamma, p_dot + Crossed(gamma_dot, p));
}

Vector2d ArmModel::TipPosition(const VectorXd& q) const { return Point(2, constants_.L2, q); }

Vector2d ArmModel::TipVelocity(const VectorXd& q, const VectorXd& v) const {
  return PointVelocity(2, constants_.L2, q, v);
}

double ArmModel::Strain(int link, double x_m, const VectorXd& q) const {
  const LinkModes& modes = link_modes(link);
  const VectorXd phi = ModalPart(link, q);
  double curvature = 0.0;
  for (int i = 0; i < modes.count(); ++i) {
    curvature += modes.mode[static_cast<std::size_t>(i)].Curvature(x_m) * phi[i];
  }
  const auto& section = parameters_.link[static_cast<std::size_t>(link - 1)].section;
  double end = 0.0;
  for (const BeamSection& s : section) {
    end += s.length_m;
    if (x_m < end) return s.half_thickness_m * curvature;
  }
  return section.back().half_thickness_m * curvature;
}

}  // namespace flexarm
