#include "controller/reference/reference_model.h"

#include <cstddef>

namespace flexarm {

void AddTorques(const Eigen::Vector2d& amplitude_nm, const std::vector<double>& shape, int first,
                std::vector<ReferenceSample>* samples) {
  for (std::size_t k = 0; k < shape.size(); ++k) {
    ReferenceSample& sample = (*samples)[static_cast<std::size_t>(first) + k];
    for (std::size_t i = 0; i < 2; ++i) {
      sample.u_m_nm[i] += amplitude_nm(static_cast<Eigen::Index>(i)) * shape[k];
    }
  }
}

void RunReferenceModel(const Design& design, const std::array<double, 2>& start_rad,
                       std::vector<ReferenceSample>* samples) {
  Eigen::VectorXd x_m = Eigen::VectorXd::Zero(design.Am.rows());
  for (int joint = 0; joint < 2; ++joint) {
    const double start = start_rad[static_cast<std::size_t>(joint)];
    x_m(design.layout.hub(joint)) = x_m(design.layout.rotor(joint)) = start;
  }
  for (ReferenceSample& sample : *samples) {
    for (Eigen::Index i = 0; i < x_m.size(); ++i) sample.x_m[static_cast<std::size_t>(i)] = x_m(i);
    x_m = design.Am * x_m + design.Bm * Eigen::Vector2d(sample.u_m_nm[0], sample.u_m_nm[1]);
  }
}

}  // namespace flexarm
