#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "controller/law/design.h"
#include "controller/types/step_types.h"

namespace flexarm {

/// Adds amplitude(i) shape[k], held for one period each, to u_m from sample `first` on.
/// The range must lie within the samples.
void AddTorques(const Eigen::Vector2d& amplitude_nm, const std::vector<double>& shape, int first,
                std::vector<ReferenceSample>* samples);

/// Fills x_m of every sample: x_m(k+1) = Am x_m(k) + Bm u_m(k), from rest at `start_rad`.
void RunReferenceModel(const Design& design, const std::array<double, 2>& start_rad,
                       std::vector<ReferenceSample>* samples);

}  // namespace flexarm
