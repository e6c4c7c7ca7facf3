#pragma once

#include <Eigen/Dense>

// Eigen's decompositions of matrices whose size is known at run time only, as off-line code uses
// them. Declared here, they are compiled once (dense_decompositions.cpp): each takes a compiler
// seconds. Code that includes <Eigen/Dense> itself computes the same numbers and compiles longer.
// Real-time: not for the loop, they allocate.
namespace Eigen {

extern template void PartialPivLU<MatrixXd>::compute();
extern template void PartialPivLU<MatrixXcd>::compute();
extern template LLT<MatrixXd>& LLT<MatrixXd>::compute<MatrixXd>(const EigenBase<MatrixXd>&);
extern template void ColPivHouseholderQR<MatrixXd>::computeInPlace();
extern template JacobiSVD<MatrixXd>& JacobiSVD<MatrixXd>::compute(const MatrixXd&, unsigned int);
extern template ComplexSchur<MatrixXd>& ComplexSchur<MatrixXd>::compute<MatrixXd>(
    const EigenBase<MatrixXd>&, bool);
extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute<MatrixXd>(
    const EigenBase<MatrixXd>&, bool);
extern template SelfAdjointEigenSolver<MatrixXd>&
SelfAdjointEigenSolver<MatrixXd>::compute<MatrixXd>(const EigenBase<MatrixXd>&, int);
extern template GeneralizedSelfAdjointEigenSolver<MatrixXd>&
GeneralizedSelfAdjointEigenSolver<MatrixXd>::compute(const MatrixXd&, const MatrixXd&, int);

}  // namespace Eigen
