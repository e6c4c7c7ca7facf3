#include "estimator/nominal_model.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "model/arm_model.h"

namespace flexarm {
namespace {

// q = T_r [th1 th2 f..]: th3 = th1, th4 = th2.
Eigen::MatrixXd RigidJointMap(int modes) {
  Eigen::MatrixXd T_r = Eigen::MatrixXd::Zero(4 + 2 * modes, 2 + 2 * modes);
  T_r(0, 0) = T_r(1, 1) = T_r(2, 0) = T_r(3, 1) = 1.0;
  for (int i = 0; i < 2 * modes; ++i) T_r(4 + i, 2 + i) = 1.0;
  return T_r;
}

// x' = A x + B u with x = [q; q'].
void FormStateSpace(NominalModel* model) {
  const Eigen::Index n = model->M.rows();
  const Eigen::LLT<Eigen::MatrixXd> mass(model->M);
  model->A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  model->A.topRightCorner(n, n).setIdentity();
  model->A.bottomLeftCorner(n, n) = -mass.solve(model->K);
  model->A.bottomRightCorner(n, n) = -mass.solve(model->D);
  model->B = Eigen::MatrixXd::Zero(2 * n, 2);
  model->B.bottomRows(n) = mass.solve(Eigen::MatrixXd::Identity(n, 2));
}

// Non-zero roots of K v = w^2 M v. Two are zero by construction: the hub rows of K are.
Eigen::VectorXd TorqueModes(const NominalModel& model) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(model.K, model.M,
                                                                        Eigen::EigenvaluesOnly);
  return modes.eigenvalues().tail(model.M.rows() - 2).cwiseSqrt();
}

}  // namespace

NominalModel MakeNominalModel(const ArmParameters& arm, int modes_per_link) {
  const ArmModel full(arm, ModeCount{.link1 = modes_per_link, .link2 = modes_per_link});
  const Eigen::MatrixXd T_r = RigidJointMap(modes_per_link);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(full.dof());
  NominalModel model;
  model.modes_per_link = modes_per_link;
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
  const int m = nominal.modes_per_link;
  for (int link = 0; link < 2; ++link) {
    const int first = 2 + link * m;
    const double c = 2.0 / nominal.torque_mode_rad_s(link);
    reference.D.block(first, first, m, m) = c * nominal.K.block(first, first, m, m);
  }
  FormStateSpace(&reference);
  return reference;
}

}  // namespace flexarm
