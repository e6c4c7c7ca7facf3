// Identification on a simulated rig: it must find the true parameters from the counts.

#include "tools/identification/identification.h"

#include <cmath>

#include "controller/runlog/csv.h"
#include "hal/sim/simulated_rig.h"
#include "model/problem_list.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

const std::string kRig = FLEXARM_SOURCE_DIR "/config/quanser-2dsfl.toml";

class IdentificationTest : public RunLogTest {
 protected:
  // Simulates the rig from rest under doublets of torque on both joints, and writes a CSV file.
  std::filesystem::path Record(const std::string& name, const RigConfig& truth, double seconds) {
    SimulatedRig rig(truth.arm, truth.sensors, truth.sim);
    std::ofstream file(File(name), std::ios::binary);
    CsvWriter writer(&file, truth.sensors, 0);
    const auto steps = truth.loop.period_ns() / rig.step_ns();
    std::array<double, 2> torque{};
    for (std::int64_t tick = 0; static_cast<double>(tick) * Period(truth) < seconds; ++tick) {
      StepInput input{};
      input.tick = tick;
      input.sampling_instant_ns = tick * truth.loop.period_ns();
      input.frame = rig.Sample(input.sampling_instant_ns);
      input.applied_torque_nm = torque;
      writer.Row(input);
      const double t = static_cast<double>(tick) * Period(truth);
      torque = {Doublet(t, 0.2, 1.1, 5.0) + Doublet(t, 2.2, 0.7, -4.0),
                Doublet(t, 0.5, 0.6, 0.6) + Doublet(t, 1.9, 0.9, -0.5)};
      rig.SetTorque(torque);
      for (std::int64_t i = 0; i < steps; ++i) rig.Step();
    }
    return File(name);
  }

  static double Period(const RigConfig& config) { return config.loop.period_s(); }

  // Torque for half the time, its negative for the other half.
  static double Doublet(double t, double start, double duration, double height) {
    const double share = (t - start) / duration;
    if (share < 0.0 || share >= 1.0) return 0.0;
    return share < 0.5 ? height : -height;
  }

  static std::vector<FreeParameter> Free(const RigConfig& config,
                                         const std::vector<std::string>& keys) {
    std::vector<FreeParameter> free;
    for (const std::string& key : keys) free.push_back(ParseFreeParameter(config, key));
    return free;
  }
};

const std::vector<std::string> kFree = {"joint1.coulomb_friction_nm",
                                        "joint1.viscous_friction_nm_s_per_rad",
                                        "joint2.coulomb_friction_nm=0.005:0.5",
                                        "joint2.viscous_friction_nm_s_per_rad",
                                        "link1.damping_ratio=0.001:0.2",
                                        "link2.damping_ratio=0.001:0.2",
                                        "sensors.strain[0].gain_v_per_unit=4000:12000",
                                        "sensors.strain[1].gain_v_per_unit=4000:11500",
                                        "sensors.strain[0].offset_counts=-500:500",
                                        "sensors.strain_input.filter_hz=1:10"};

const std::vector<double> kTruth = {0.35, 3.0, 0.06, 0.9, 0.03, 0.04, 6500.0, 9500.0, 80.0, 2.7};

// The start values are wrong by 20 to 200 %. The remaining error is the counts' rounding and noise
// (2 counts of some thousand, over 1000 samples; standard errors of 1 % at most) and the tolerance
// of the search (2e-4 of its ranges). Allowed: 2 %, and 4 standard errors plus the tolerance of the
// search.
TEST_F(IdentificationTest, FindsTheParametersOfASimulatedRig) {
  const RigConfig start = LoadConfig(
      kRig, {"joint1.coulomb_friction_nm=0.5", "joint1.viscous_friction_nm_s_per_rad=4",
             "joint2.coulomb_friction_nm=0.1", "joint2.viscous_friction_nm_s_per_rad=1.5",
             "link1.damping_ratio=0.01", "link2.damping_ratio=0.01",
             "sensors.strain[0].gain_v_per_unit=7776", "sensors.strain[1].gain_v_per_unit=8097",
             "sensors.strain[0].offset_counts=0", "sensors.strain_input.filter_hz=2"});
  const std::vector<FreeParameter> free = Free(start, kFree);
  std::vector<std::string> truth;
  for (std::size_t i = 0; i < free.size(); ++i) {
    truth.push_back(free[i].key + "=" + NumberText(kTruth[i]));
  }
  const RigConfig rig = WithOverrides(start, truth);
  const RunComparison run(Record("run.csv", rig, 10.0), start);
  const Identification found = Identify(start, run, free);
  EXPECT_TRUE(found.converged);
  for (std::size_t i = 0; i < free.size(); ++i) {
    const FoundParameter& p = found.parameter[i];
    EXPECT_NEAR(p.found, kTruth[i], 0.02 * kTruth[i]) << p.free.key;
    const double range = p.free.logarithmic ? p.found * std::log(100.0) : p.free.high - p.free.low;
    EXPECT_NEAR(p.found, kTruth[i], 4.0 * p.standard_error + 1e-3 * range) << p.free.key;
    EXPECT_LT(p.standard_error, 0.01 * kTruth[i]) << p.free.key;
    EXPECT_FALSE(p.at_bound) << p.free.key;
  }
  EXPECT_GT(FitPercent(run, run.Predict(found.config)).minCoeff(), 99.0);
  EXPECT_LT(FitPercent(run, run.Predict(start)).minCoeff(), 90.0);
  // Validation with a run that the search did not use, with another seed of the noise.
  const RigConfig other = WithOverrides(rig, {"sim.seed=7"});
  const RunComparison validation(Record("other.csv", other, 3.0), start);
  EXPECT_GT(FitPercent(validation, validation.Predict(found.config)).minCoeff(), 99.0);
}

TEST_F(IdentificationTest, NamesTheParametersThatTheRunDoesNotDetermine) {
  const RigConfig start = LoadConfig(kRig);
  const RunComparison run(Record("run.csv", start, 2.0), start);
  const Identification found = Identify(
      start, run,
      Free(start, {"joint1.viscous_friction_nm_s_per_rad", "limits.torque_limit_nm[0]=7:9"}));
  EXPECT_TRUE(std::isinf(found.parameter[1].standard_error));
}

TEST_F(IdentificationTest, FitIsHundredForTheDataAndZeroForTheirMean) {
  const RigConfig rig = LoadConfig(kRig);
  const RunComparison run(Record("run.csv", rig, 2.0), rig, {.from_s = 0.5, .until_s = 1.7});
  ASSERT_EQ(run.signal().size(), 4U);
  ASSERT_EQ(run.time_s().size(), 121);
  EXPECT_DOUBLE_EQ(run.time_s()(0), 0.5);
  EXPECT_DOUBLE_EQ(run.time_s()(120), 1.7);
  EXPECT_EQ(run.compared().sum(), 4.0 * 121.0);
  const Eigen::MatrixXd y = run.measured();
  EXPECT_NEAR((FitPercent(run, y).array() - 100.0).abs().maxCoeff(), 0.0, 1e-12);
  const Eigen::RowVectorXd mean = y.colwise().mean();
  EXPECT_NEAR(FitPercent(run, mean.replicate(y.rows(), 1)).cwiseAbs().maxCoeff(), 0.0, 1e-9);
  // An error of one spread, and of two.
  EXPECT_NEAR(Misfit(run, y + 2.0 * run.spread().transpose().replicate(y.rows(), 1)), 4.0, 1e-9);
}

// A part of a run is compared like a whole run: times do not change, and the arm starts at its
// angles of that time.
TEST_F(IdentificationTest, ASpanStartsFromTheAnglesAtItsBeginning) {
  const RigConfig rig = LoadConfig(kRig);
  const std::filesystem::path file = Record("run.csv", rig, 6.0);
  const RunComparison rest(file, rig, {.from_s = 1.9, .until_s = 6.0});
  // The first moves end before 1.9 s; the prediction lacks only the oscillation that remains then.
  EXPECT_GT(FitPercent(rest, rest.Predict(rig)).minCoeff(), 80.0);
  EXPECT_GT(std::abs(rest.measured()(0, 0)), 0.01);
}

// Measured runs of the real arm, which are not part of the project; they are expected beside its
// folder.
TEST(MeasuredArm, IsPredictedWithTheFitOfTheDocs) {
  const std::filesystem::path data = FLEXARM_SOURCE_DIR "/../shared/data/quanser-2dsfl";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no measured runs at " << data;
  const RigConfig rig = LoadConfig(kRig);
  const RunComparison own(data / "lqr_10deg.csv", rig);
  const Eigen::VectorXd fit = FitPercent(own, own.Predict(rig));
  const Eigen::Vector4d documented(97.5, 78.5, 75.9, 78.3);
  EXPECT_LT((fit - documented).cwiseAbs().maxCoeff(), 0.5) << fit.transpose();
}

TEST_F(IdentificationTest, ARunWithoutMotionIsRefused) {
  const RigConfig rig = LoadConfig(kRig);
  std::string still =
      "time_s,counter_1,counter_2,strain_1_01,strain_2_01,valid,torque_1_nm,"
      "torque_2_nm\n";
  for (int k = 0; k < 5; ++k) still += NumberText(0.01 * k) + ",0,0,0,0,1,0,0\n";
  WriteText(File("still.csv"), still);
  EXPECT_THROW(RunComparison(File("still.csv"), rig), InputError);
  EXPECT_THROW(RunComparison(File("still.csv"), rig, {.from_s = 9.0, .until_s = 10.0}), InputError);
}

TEST_F(IdentificationTest, FreeParametersAreNumbersOfTheConfigWithinItsRules) {
  const RigConfig rig = LoadConfig(kRig);
  const FreeParameter wide = ParseFreeParameter(rig, "joint1.viscous_friction_nm_s_per_rad");
  EXPECT_TRUE(wide.logarithmic);
  EXPECT_DOUBLE_EQ(wide.high / wide.low, 100.0);
  const FreeParameter between = ParseFreeParameter(rig, "sensors.strain[0].offset_counts=-9e3:1e4");
  EXPECT_EQ(between.low, -9e3);
  EXPECT_EQ(between.high, 1e4);
  EXPECT_THROW(ParseFreeParameter(rig, "joint1.viscous"), InputError);
  EXPECT_THROW(ParseFreeParameter(rig, "rig.name"), InputError);
  EXPECT_THROW(ParseFreeParameter(rig, "arm.hub2_mass_kg"), InputError);  // starts from 0
  EXPECT_THROW(ParseFreeParameter(rig, "link1.damping_ratio=0.5:0.9"), InputError);
  EXPECT_THROW(ParseFreeParameter(rig, "link1.damping_ratio=0:x"), InputError);
  EXPECT_THROW(ParseFreeParameter(rig, "link1.damping_ratio=0"), InputError);
  EXPECT_THROW(ParseFreeParameter(rig, "link1.damping_ratio=-0.5:0.9"), InputError);
}

}  // namespace
}  // namespace flexarm
