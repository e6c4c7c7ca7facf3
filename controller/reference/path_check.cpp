#include "controller/reference/path_check.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "model/problem_list.h"

namespace flexarm {
namespace {

std::vector<ReferenceSample> RigidReference(const RigidPath& path, int states, int first,
                                            int last) {
  std::vector<ReferenceSample> samples(static_cast<std::size_t>(last - first) + 1);
  for (int k = first; k <= last; ++k) {
    ReferenceSample& sample = samples[static_cast<std::size_t>(k - first)];
    const RigidPoint& point = path.At(k);
    for (std::size_t i = 0; i < 2; ++i) {
      sample.x_m[i] = point.angle_rad[i];
      sample.x_m[static_cast<std::size_t>(states) / 2 + i] = point.rate_rad_s[i];
    }
  }
  return samples;
}

}  // namespace

PathCheck::PathCheck(const Design& design, const MotionLimits& limits, const LimitShares& shares,
                     double period_s)
    : arm_(MakeRigidJointArm(design)),
      max_kg_(design.scheduled->max_kg),
      states_(static_cast<int>(design.Am.rows())),
      limits_(limits),
      shares_(shares),
      period_s_(period_s) {}

std::optional<BrokenLimit> PathCheck::FirstWith(double payload_kg, const RigidPath& path, int first,
                                                int last) const {
  const int from = std::max(first - 1, 0);  // the sample before, for the change of the torque
  return FirstBrokenLimit(QuasiStaticReference(path, arm_, payload_kg, period_s_, from, last),
                          states_, limits_, shares_, period_s_, from);
}

std::optional<BrokenLimit> PathCheck::First(const RigidPath& path, int first, int last) const {
  auto heavy = FirstWith(max_kg_, path, first, last);
  auto empty = FirstWith(0.0, path, first, last);
  const int from = std::max(first - 1, 0);
  const auto rigid = FirstBrokenLimit(RigidReference(path, states_, from, last), states_, limits_,
                                      shares_, period_s_, from);
  if (heavy) heavy->text += " (with " + NumberText(max_kg_) + " kg, controller.payload.max_kg)";
  if (empty) empty->text += " (without payload)";
  std::optional<BrokenLimit> earliest = heavy;
  for (const auto& broken : {empty, rigid}) {
    if (broken && (!earliest || broken->sample < earliest->sample)) earliest = broken;
  }
  return earliest;
}

}  // namespace flexarm
