#include "estimator/nominal_model.h"

#include <algorithm>
#include <cmath>

#include "model/arm/arm_model.h"
#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

// [th1 th2 th3 th4 f..] = T_r q: with rigid joints th3 = th1, th4 = th2.
Eigen::MatrixXd CoordinateMap(const StateLayout& layout) {
  const int modes = layout.modes_per_link;
  Eigen::MatrixXd T_r = Eigen::MatrixXd::Zero(4 + 2 * modes, layout.dof());
  for (int joint = 0; joint < 2; ++joint) {
    T_r(joint, layout.hub(joint)) = 1.0;
    T_r(2 + joint, layout.rotor(joint)) = 1.0;
  }
  for (int i = 0; i < 2 * modes; ++i) T_r(4 + i, layout.angles() + i) = 1.0;
  return T_r;
}

// x' = A x + B u with x = [q; q'].
void FormStateSpace(NominalModel* model) {
  const Eigen::Index n = model->M.rows();
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(n, 2);
  for (int joint = 0; joint < 2; ++joint) E(model->layout.rotor(joint), joint) = 1.0;
  const Eigen::LLT<Eigen::MatrixXd> mass(model->M);
  model->A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  model->A.topRightCorner(n, n).setIdentity();
  model->A.bottomLeftCorner(n, n) = -mass.solve(model->K);
  model->A.bottomRightCorner(n, n) = -mass.solve(model->D);
  model->B = Eigen::MatrixXd::Zero(2 * n, 2);
  model->B.bottomRows(n) = mass.solve(E);
}

// Non-zero roots of K v = w^2 M v. Two are zero by construction: a rigid rotation has no stiffness.
Eigen::VectorXd TorqueModes(const NominalModel& model) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(model.K, model.M,
                                                                        Eigen::EigenvaluesOnly);
  return modes.eigenvalues().tail(model.M.rows() - 2).cwiseSqrt();
}

}  // namespace

Eigen::Matrix2d NominalModel::RigidInertia_kgm2() const {
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(M.rows(), 2);  // q of a unit angle of each joint
  for (int joint = 0; joint < 2; ++joint) {
    turn(layout.hub(joint), joint) = turn(layout.rotor(joint), joint) = 1.0;
  }
  const Eigen::MatrixXd inertia = turn.transpose() * M * turn;
  return inertia;
}

NominalModel MakeNominalModel(const ArmParameters& arm, const StateLayout& layout) {
  const int modes = layout.modes_per_link;
  const ArmModel full(arm, ModeCount{.link1 = modes, .link2 = modes});
  const Eigen::MatrixXd T_r = CoordinateMap(layout);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(full.dof());
  NominalModel model;
  model.layout = layout;
  model.M = T_r.transpose() * full.MassMatrix(rest) * T_r;
  model.D = T_r.transpose() * full.damping() * T_r;
  model.K = T_r.transpose() * full.stiffness() * T_r;
  FormStateSpace(&model);
  model.torque_mode_rad_s = TorqueModes(model);
  return model;
}

NominalModel MakeReferenceModel(const NominalModel& nominal) {
  NominalModel reference = nominal;
  reference.D.setZero();
  const int m = nominal.layout.modes_per_link;
  for (int link = 0; link < 2; ++link) {
    const int first = nominal.layout.mode(link, 0);
    const double c = 2.0 / nominal.torque_mode_rad_s(link);
    reference.D.block(first, first, m, m) = c * nominal.K.block(first, first, m, m);
  }
  FormStateSpace(&reference);
  return reference;
}

}  // namespace flexarm
