#include "tools/bench_host/control_rows.h"

#include <array>
#include <memory>
#include <numbers>
#include <vector>

#include "controller/design/run_design.h"
#include "controller/law/design.h"
#include "controller/planner/horizon_planner.h"
#include "controller/step/control_step.h"
#include "controller/tasks/planner_task.h"
#include "controller/types/motion_profile.h"

namespace flexarm {
namespace {

constexpr const char* kNotCountedQuick = "not counted with --quick";

// Samples that are counted, one after the other.
int CountedSteps(const BenchSetting& setting) { return setting.quick ? 1 : 5; }

// From rest at 0 to 30 deg of both joints in 1.78 s, and the rest that a plan has behind a move.
struct BenchMove {
  static constexpr int kPeriods = 89, kRest = 20;

  explicit BenchMove(double period_s) {
    const double T_s = kPeriods * period_s, way_rad = std::numbers::pi / 6.0;
    for (int sample = -1; sample <= kPeriods + kRest + 1; ++sample) {
      const ProfilePoint at =
          ProfileAt(MoveProfile::kSeptic, static_cast<double>(sample) / kPeriods);
      RigidPoint point{};
      point.angle_rad.fill(way_rad * at.s);
      point.rate_rad_s.fill(way_rad * at.ds / T_s);
      point.acceleration_rad_s2.fill(way_rad * at.dds / (T_s * T_s));
      path.push_back(point);
    }
  }
  PlanProblem problem() const {
    return {.first_tick = 0,
            .x = PlanState::Zero(),
            .payload_kg = 0.37,
            .torque_before_nm = Eigen::Vector2d::Zero(),
            .path = path,
            .move_samples = kPeriods};
  }

  std::vector<RigidPoint> path;
};

}  // namespace

BenchRow StepRow(const BenchSetting& setting, const RecordedRun& run, const std::string& law) {
  BenchRow row{.name = "step-" + law, .what = "`Step`, one sample, law `" + law + "`"};
  const RigConfig config = WithLaw(setting.config, law);
  ControlStep step(config, DesignFor(config));
  std::size_t next = 0;
  const auto work = [&] {
    step.Step(run.inputs[next]);
    next = (next + 1) % run.inputs.size();
  };
  // Calls in a row run through all samples of the run, over and over.
  row.time =
      TimeWork(work, {.count = setting.short_work().count, .each_s = setting.quick ? 5e-3 : 50e-3});
  if (setting.quick && config.controller.kind != setting.config.controller.kind) {
    row.counted = kNotCountedQuick;
    return row;
  }
  // From the middle of the run, where the arm moves and its estimates have settled.
  next = 0;
  for (std::size_t i = 0; i < run.inputs.size() / 2; ++i) work();
  const int samples = CountedSteps(setting);
  CountResult counted = CountWork(
      [&] {
        for (int i = 0; i < samples; ++i) work();
      },
      samples * setting.most_counted());
  counted.count.flops /= samples;
  counted.count.instructions /= samples;
  AddCount(&row, counted);
  return row;
}

BenchRow PlanRow(const BenchSetting& setting) {
  BenchRow row{.name = "plan", .what = "Plan of 109 stages, law `receding-horizon`, warm"};
  const RigConfig config = WithLaw(setting.config, "receding-horizon");
  const Design design = DesignFor(config);
  const double period_s = 1e-9 * static_cast<double>(config.loop.period_ns());
  const auto planner = std::make_unique<HorizonPlanner>(
      MakeRigidJointArm(design), period_s, *design.scheduled->start_gains, PlannerConfigOf(config));
  const BenchMove move(period_s);
  const auto first = std::make_unique<HorizonPlan>(), plan = std::make_unique<HorizonPlan>();
  if (!planner->Plan(move.problem(), nullptr, first.get())) {
    return NotMeasured(row.name, row.what,
                       "this rig's planner refuses the move: name the shipped config with -c");
  }
  const auto work = [&] {
    static_cast<void>(planner->Plan(move.problem(), first.get(), plan.get()));
  };
  row.time = TimeWork(work, setting.short_work());
  if (setting.quick) {
    row.counted = kNotCountedQuick;
  } else {
    AddCount(&row, CountWork(work, setting.most_counted()));
  }
  return row;
}

}  // namespace flexarm
