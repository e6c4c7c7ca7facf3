// The program as its users see it: exit codes, standard output, standard error.

#include <sys/wait.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "controller/design/design_json.h"
#include "controller/design/run_design.h"
#include "controller/law/design.h"
#include "controller/step/control_step.h"
#include "tests/controller/runlog/runlog_fixture.h"
#include "tools/command_line/other_programs.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;

const std::string kRig = FLEXARM_SOURCE_DIR "/config/thesis-rig.toml";

class ProgramTest : public RunLogTest {
 protected:
  struct Answer {
    int code;
    std::string out, err;
  };

  // Runs `flexarm ARGUMENTS` in the test's folder, through the shell.
  Answer Run(const std::string& arguments) {
    const std::string command = "cd '" + folder_.string() + "' && " + ProgramFor(arguments) + " " +
                                arguments + " >out 2>err </dev/null";
    const int status = std::system(command.c_str());
    EXPECT_TRUE(WIFEXITED(status)) << arguments;
    return {WEXITSTATUS(status), Bytes(File("out")), Bytes(File("err"))};
  }
  Json RunJson(const std::string& arguments, int code = 0) {
    const Answer answer = Run(arguments + " --json");
    EXPECT_EQ(answer.code, code) << answer.err;
    const Json json = Json::parse(answer.out, nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << answer.out;
    return json;
  }
  void ExpectBadInput(const std::string& arguments, const std::string& message) {
    const Answer answer = Run(arguments);
    EXPECT_EQ(answer.code, 2) << arguments;
    EXPECT_EQ(answer.out, "") << arguments;
    EXPECT_EQ(answer.err.find("flexarm: "), 0U) << answer.err;
    EXPECT_NE(answer.err.find(message), std::string::npos) << answer.err;
  }

  // An emulated program cannot start a second one, so the program of a verb is started directly
  // then.
  static std::string ProgramFor(const std::string& arguments) {
    constexpr const char* kEmulator = FLEXARM_EMULATOR;  // empty: this processor runs it
    const std::string emulator = kEmulator;
    if (emulator.empty()) return "'" FLEXARM_PROGRAM "'";
    const std::string_view program = ProgramOf(arguments.substr(0, arguments.find(' ')));
    const std::filesystem::path folder = std::filesystem::path(FLEXARM_PROGRAM).parent_path();
    return emulator + " '" + (folder / program).string() + "'";
  }

  // A log of an arm at rest that the loop holds for `ticks` ticks, as the recorder writes it.
  void WriteRun(const std::string& name, int ticks, std::int32_t strain_of_last_tick = 0) {
    const RigConfig config = LoadConfig(kRig);
    const Design design = DesignFor(config);
    RunInfo info = MakeInfo();
    info.config_text = config.text;
    info.gains_json = DesignToJson(design, DesignHash(config));
    RunWriter writer(File(name), info);
    ControlStep step(config, design);
    writer.Safety(MakeSafety(0, {SafetyState::kIdle, TripCause::kNone}, RequestKind::kArm));
    for (int tick = 1; tick <= ticks; ++tick) {
      TickRecord record{};
      record.input.tick = tick;
      record.input.now_ns = record.input.sampling_instant_ns = tick * kTestPeriodNs;
      record.input.frame.sampled_at_ns = record.input.sampling_instant_ns;
      record.input.frame.counter_valid = config.sensors.counters_present();
      record.input.frame.strain_valid = (1U << config.sensors.strain.size()) - 1;
      record.input.frame.levels = kHealthyLevels;
      if (tick == ticks) record.input.frame.strain[0] = strain_of_last_tick;
      record.input.safety_state = SafetyState::kArmed;
      record.input.reset = tick == 1 ? 1 : 0;
      record.output = step.Step(record.input);
      writer.Tick(record);
    }
    writer.Close("{\"completed\":false}");
  }
};

TEST_F(ProgramTest, HelpAndVersionExitWithZero) {
  EXPECT_EQ(Run("--help").code, 0);
  EXPECT_NE(Run("--version").out.find("flexarm 0."), std::string::npos);
  for (const char* verb :
       {"config check", "modes", "replay", "info", "plot", "export", "check", "diff", "identify"}) {
    const Answer answer = Run(std::string(verb) + " --help");
    EXPECT_EQ(answer.code, 0) << verb;
    EXPECT_NE(answer.out.find("Example"), std::string::npos) << verb << " has no example";
  }
}

TEST_F(ProgramTest, BadUsageIsExitCodeTwo) {
  ExpectBadInput("", "subcommand is required");
  ExpectBadInput("frobnicate", "frobnicate");
  ExpectBadInput("replay", "expected a run log, or --last");
  ExpectBadInput("info run.flexarm --frobnicate", "--frobnicate");
  ExpectBadInput("modes", "--config is required");
  ExpectBadInput("modes -c '" + kRig + "' --modes 7", "--modes");
}

TEST_F(ProgramTest, AStudyRunsUnderItsVerbAsDoesTheDashboard) {
  for (const OtherVerb& other : kOtherVerbs) {
    const std::string verb(other.verb);
    const Answer help = Run(verb + " --help");
    EXPECT_EQ(help.code, 0) << verb;
    EXPECT_EQ(help.out.find(other.description), 0U) << help.out;
    EXPECT_NE(Run("--help").out.find(other.description.substr(0, 40)), std::string::npos) << verb;
    EXPECT_EQ(Run(verb + " --no-such-option").code, 2) << verb;
  }
}

TEST_F(ProgramTest, AMissingStudyProgramGivesTheCommandThatBuildsIt) {
  std::filesystem::copy_file(FLEXARM_PROGRAM, File("flexarm"));
  const std::string command =
      "cd '" + folder_.string() + "' && ./flexarm modes -c '" + kRig + "' >out 2>err </dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  EXPECT_EQ(Bytes(File("out")), "");
  const std::string said = Bytes(File("err"));
  EXPECT_NE(said.find("flexarm-study, which has the verb \"modes\": No such file"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("cmake --build --preset release --target flexarm-study"), std::string::npos);
}

TEST_F(ProgramTest, BadInputIsExitCodeTwoInEveryVerbThatReadsARun) {
  WriteText(File("text"), "this is no log");
  for (const char* verb : {"replay text", "info text", "export text -o x.csv", "check text",
                           "diff text text", "plot text -o x.png"}) {
    ExpectBadInput(verb, "text: not a run log: begins with \"this is no log\"");
  }
  ExpectBadInput("info missing", "missing: cannot be read: No such file or directory");
}

TEST_F(ProgramTest, ABadConfigNamesFileAndLine) {
  WriteText(File("bad.toml"), "extends = \"" + kRig + "\"\n[loop]\nperiod_ms = -1\n");
  ExpectBadInput("config check bad.toml", "bad.toml:3: loop.period_ms = -1");
  ExpectBadInput("modes -c bad.toml", "bad.toml:3: loop.period_ms = -1");
  ExpectBadInput("config check '" + kRig + "' --set loop.perid_ms=20", "perid_ms");
}

TEST_F(ProgramTest, ConfigCheckPrintsDerivedQuantities) {
  EXPECT_EQ(Run("config check '" + kRig + "'").code, 0);
  const Json json = RunJson("config check '" + kRig + "'");
  EXPECT_EQ(json["valid"], true);
  EXPECT_NEAR(json["arm"]["link_length_m"][0].get<double>(), 0.8, 1e-12);
  EXPECT_NEAR(json["encoders"][0]["resolution_deg"].get<double>(), 0.1417, 1e-4);
  // docs/theory/control-law.md 7.1: an 8-bit counter of 2540 counts a turn unwraps below 7.85 rad/s
  // over two periods.
  EXPECT_NEAR(json["encoders"][0]["unwraps_below_rad_s"].get<double>(), 7.9, 0.1);
  EXPECT_EQ(json["strain"]["channels"], Json({10, 10}));
}

TEST_F(ProgramTest, ConfigCheckGivesTheTimeOfEveryChannelOfAHardwareRig) {
  const std::string daq = FLEXARM_SOURCE_DIR "/config/daq-rig.toml";
  const Json json = RunJson("config check '" + daq + "'");
  const Json& acquisition = json["acquisition"];
  EXPECT_EQ(acquisition["available_ms"], 10.0);
  ASSERT_EQ(acquisition["buses"].size(), 2U);
  const Json& board = acquisition["buses"][0];
  EXPECT_EQ(board["name"], "/dev/comedi0");
  EXPECT_EQ(board["channels"].size(), 14U);  // two drives, ten gauges, two encoders
  EXPECT_EQ(board["channels"][2]["channel"], "strain[0]");
  EXPECT_EQ(board["channels"][2]["shared_by"], 10);
  EXPECT_EQ(board["channels"][2]["convert_ms"], 0.2);
  // Drives and encoders at 0.05 ms, the buffer 0.3 ms, the exchange itself 0.2 ms.
  EXPECT_NEAR(board["worst_case_ms"].get<double>(), 0.7, 1e-9);
  EXPECT_NEAR(board["spare_ms"].get<double>(), 9.3, 1e-9);
  EXPECT_EQ(acquisition["slowest_bus"], "/dev/comedi0");
  const std::string text = Run("config check '" + daq + "'").out;
  EXPECT_NE(text.find("subdevice 5 hub1        0.05 ms"), std::string::npos) << text;
}

TEST_F(ProgramTest, ConfigCheckGivesTheScalingOfTorquesToVoltsOrPerMille) {
  const Json volts = RunJson("config check '" FLEXARM_SOURCE_DIR "/config/daq-rig.toml'")["drives"];
  ASSERT_EQ(volts.size(), 2U);
  EXPECT_NEAR(volts[0]["torque_per_volt_nm"].get<double>(), 3.0, 1e-12);
  EXPECT_EQ(volts[1]["gear"], 48.96);
  EXPECT_EQ(volts[1]["range_v"], 10.0);
  const Json wire = RunJson("config check '" FLEXARM_SOURCE_DIR "/config/hil-wire.toml'");
  EXPECT_EQ(wire["acquisition"]["slowest_bus"], "vcan0");
  EXPECT_EQ(wire["drives"][0]["torque_per_mille_nm"], 0.03);
  EXPECT_EQ(wire["drives"][0]["sign"], 1);
  EXPECT_EQ(wire["drives"][0]["torque_range_nm"], 30.0);
  EXPECT_EQ(wire["drives"][0]["range_per_mille"], 1000.0);
}

TEST_F(ProgramTest, ConfigCheckGivesItsProblemsAsJsonToo) {
  const Answer answer = Run("config check '" FLEXARM_SOURCE_DIR
                            "/config/daq-rig.toml' --json --set "
                            "'hal.comedi[0].instruction_us=3000.0'");
  EXPECT_EQ(answer.code, 2);
  const Json json = Json::parse(answer.out);
  EXPECT_EQ(json["valid"], false);
  ASSERT_EQ(json["problems"].size(), 1U);
  EXPECT_EQ(json["problems"][0]["key"], "hal.comedi[0].instruction_us");
  // Drives end at 6.2 ms, the scan at 6.5 ms.
  EXPECT_NE(
      json["problems"][0]["rule"].get<std::string>().find("hub2 costs 3 ms and ends at 12.5 ms"),
      std::string::npos)
      << json.dump(2);
  EXPECT_NE(answer.err.find("hub2 costs 3 ms"), std::string::npos);
}

TEST_F(ProgramTest, ConfigCheckWarnsAboutAnImplausibleValueWithItsPlaceAndStaysValid) {
  EXPECT_EQ(RunJson("config check '" + kRig + "'")["warnings"], Json::array());
  WriteText(File("soft.toml"),
            "extends = \"" + kRig + "\"\n[joint1]\nstiffness_nm_per_rad = 13.3\n");
  const Answer answer = Run("config check soft.toml");
  EXPECT_EQ(answer.code, 0);
  EXPECT_NE(answer.out.find("soft.toml:3: warning: joint1.stiffness_nm_per_rad = 13.3: the torque "
                            "limit of 30 N m twists the joint by 129 deg; usual: above 150"),
            std::string::npos)
      << answer.out;
  const Json warnings = RunJson("config check soft.toml")["warnings"];
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0]["line"], 3);
  EXPECT_EQ(warnings[0]["key"], "joint1.stiffness_nm_per_rad");
  EXPECT_EQ(warnings[0]["value"], "13.3");
  EXPECT_TRUE(warnings[0].contains("unusual") && warnings[0].contains("usual"));
}

TEST_F(ProgramTest, ModesHaveTheKeysOfTheContract) {
  // docs/theory/plant.md 2.5 and docs/theory/control-law.md 1.2: clamped and torque-mode
  // frequencies of the nominal rig.
  const Json json = RunJson("modes -c '" + kRig + "' --modes 2");
  EXPECT_EQ(json["links"][0]["link"], 1);
  EXPECT_EQ(json["links"][0]["base"], "clamped");
  EXPECT_EQ(json["links"][0]["beta_l"].size(), 2U);
  EXPECT_NEAR(json["links"][0]["frequency_hz"][0].get<double>(), 0.851, 5e-4);
  EXPECT_NEAR(json["links"][1]["frequency_hz"][1].get<double>(), 15.52, 5e-3);
  EXPECT_EQ(json["arm"]["motors"], "free");
  EXPECT_NEAR(json["arm"]["frequency_hz"][0].get<double>(), 6.63, 0.01);
  EXPECT_EQ(json["arm_motors_held"]["motors"], "held");
  const Json heavy = RunJson("modes -c '" + kRig + "' --modes 2 --payload-kg 1 --theta2-deg 45");
  EXPECT_EQ(heavy["arm"]["payload_kg"], 1.0);
  EXPECT_EQ(heavy["arm"]["theta2_deg"], 45.0);
  EXPECT_LT(heavy["arm"]["frequency_hz"][0], json["arm"]["frequency_hz"][0]);
}

TEST_F(ProgramTest, ReplayOfARunIsBitExact) {
  WriteRun("run.flexarm", 20);
  const Json json = RunJson("replay run.flexarm");
  EXPECT_EQ(json["ticks"], 20);
  EXPECT_EQ(json["bit_exact"], true);
  EXPECT_EQ(json["safety_exact"], true);
  EXPECT_EQ(json["max_torque_difference_nm"], Json({0.0, 0.0}));
  EXPECT_TRUE(json["first_gap_tick"].is_null());
}

TEST_F(ProgramTest, ReplayWithAnotherConfigComparesNoBytes) {
  WriteRun("run.flexarm", 20);
  EXPECT_EQ(RunJson("replay run.flexarm -c '" + kRig + "'")["bit_exact"], true);
  const Json other = RunJson("replay run.flexarm -c '" + kRig + "' --set controller.alpha=2.5");
  EXPECT_TRUE(other["bit_exact"].is_null());
  const Json changed = RunJson("replay run.flexarm --set controller.alpha=2");
  EXPECT_TRUE(changed["bit_exact"].is_null()) << "--set changes the config of the log";
}

TEST_F(ProgramTest, ReplayOfASimulationWithKnownStateIsBitExact) {
  RunJson("simulate -c '" + kRig + "' --ideal -o ideal.flexarm");
  EXPECT_EQ(RunJson("replay ideal.flexarm")["bit_exact"], true);
  RunJson("simulate -c '" + kRig + "' -o run.flexarm");
  ExpectBadInput("replay run.flexarm -c '" + kRig + "' --set estimator.name=ideal",
                 "the true state is not in this log");
}

TEST_F(ProgramTest, AReplayThatDiffersIsExitCodeOne) {
  WriteRun("run.flexarm", 5);
  const RunContents run = RunReader(File()).ReadAll();
  // One bit of what a sensor read, and of what the step computed.
  for (const bool of_input : {true, false}) {
    RunWriter writer(File(of_input ? "input.flexarm" : "output.flexarm"), run.info);
    for (TickRecord tick : run.tick) {
      if (tick.input.tick == 4 && of_input) tick.input.frame.counter[0] ^= 1;
      if (tick.input.tick == 4 && !of_input) tick.output.x_hat[15] = -0.0;
      writer.Tick(tick);
    }
    writer.Close("{}");
    const Json json =
        RunJson(std::string("replay ") + (of_input ? "input.flexarm" : "output.flexarm"), 1);
    EXPECT_EQ(json["bit_exact"], false);
    EXPECT_EQ(json["first_different_tick"], 4);
    EXPECT_EQ(json["digest_holds"], true);
  }
}

TEST_F(ProgramTest, ReplayReadsTheCsvFileOfExport) {
  WriteRun("run.flexarm", 20);
  EXPECT_EQ(Run("export run.flexarm -o data.csv").code, 0);
  const Json json = RunJson("replay data.csv -c '" + kRig + "'");
  EXPECT_EQ(json["ticks"], 20);
  EXPECT_TRUE(json["bit_exact"].is_null());
  EXPECT_TRUE(json["safety_exact"].is_null());
  ExpectBadInput("replay data.csv", "add -c FILE");
  WriteText(File("bad.csv"), "time_s\n0\n");
  ExpectBadInput("replay bad.csv -c '" + kRig + "'", "bad.csv:1: found no column");
}

TEST_F(ProgramTest, IdentifyEstimatesThePayloadFromAShortRun) {
  const std::string rig = "'" FLEXARM_SOURCE_DIR "/config/hil.toml'";
  ASSERT_EQ(Run("simulate -c " + rig + " --seed 3 -o run.flexarm").code, 0);
  const Json json = RunJson(
      "identify --run run.flexarm --validate run.flexarm --span 0 3 --validate-span 3 6 "
      "--set arm.payload_mass_kg=0.2 --free arm.payload_mass_kg=0:1 -o found");
  EXPECT_EQ(json["converged"], true);
  // The rig has 0.1 kg; 20 channels with noise of one count and encoders of 0.14 degrees determine
  // it to 10 g.
  EXPECT_NEAR(json["parameters"][0]["found"].get<double>(), 0.1, 0.01);
  EXPECT_EQ(json["identification"]["fit"].size(), 6U);
  EXPECT_EQ(json["validation"]["fit"][0]["signal"], "joint1");
  EXPECT_EQ(Bytes(File("found/identification.png")).substr(1, 3), "PNG");
  EXPECT_EQ(Run("config check found/identified.toml").code, 0);
}

TEST_F(ProgramTest, IdentifyRefusesBadInput) {
  WriteRun("run.flexarm", 20);
  WriteText(File("bad.csv"), "time_s\n0\n");
  const std::string free = " --free link1.damping_ratio";
  ExpectBadInput("identify --run bad.csv" + free, "add -c FILE");
  ExpectBadInput("identify --run bad.csv -c '" + kRig + "'" + free, "bad.csv:1: found no column");
  ExpectBadInput("identify --run run.flexarm", "--free is required");
  ExpectBadInput("identify --run run.flexarm --free link1.xi", "no number at link1.xi");
  ExpectBadInput("identify --run run.flexarm" + free, "joint1 never changes");
  ExpectBadInput("identify --run run.flexarm --span 3 2" + free, "FROM < TO");
  ExpectBadInput("identify --run run.flexarm --span 3 4" + free, "fewer than 2 samples");
  ExpectBadInput("identify --run missing.flexarm" + free, "No such file");
}

TEST_F(ProgramTest, InfoSummarisesTheRun) {
  WriteRun("run.flexarm", 20);
  const Json json = RunJson("info run.flexarm");
  EXPECT_EQ(json["ticks"], 20);
  EXPECT_EQ(json["final_state"], "Armed");
  EXPECT_TRUE(json["trip"].is_null());
  EXPECT_EQ(json["result"]["completed"], false);
  EXPECT_NE(Run("info run.flexarm").out.find("Idle -> Armed"), std::string::npos);
}

TEST_F(ProgramTest, CheckIsExitCodeOneIfARuleIsViolated) {
  WriteRun("run.flexarm", 20);
  EXPECT_EQ(RunJson("check run.flexarm")["passed"], true);
  ASSERT_EQ(std::system(
                ("sqlite3 '" + File().string() + "' 'DELETE FROM sample WHERE tick = 7'").c_str()),
            0);
  EXPECT_EQ(RunJson("check run.flexarm", 1)["passed"], false);
}

TEST_F(ProgramTest, DiffNamesTheFirstTickThatDiffers) {
  WriteRun("a", 20);
  WriteRun("b", 20);
  WriteRun("c", 20, 500);
  EXPECT_EQ(RunJson("diff a b")["identical"], true);
  const Json json = RunJson("diff a c", 1);
  EXPECT_EQ(json["first_different_tick"], 20);
}

TEST_F(ProgramTest, PlotDrawsOneRunOrSeveral) {
  WriteRun("run_1", 60);
  WriteRun("it's `b`", 60);
  EXPECT_EQ(Run("plot run_1 -o one.png").code, 0);
  EXPECT_EQ(Bytes(File("one.png")).substr(1, 3), "PNG");
  const Answer both = Run("plot run_1 \"it's \\`b\\`\" -o both.svg");
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_NE(Bytes(File("both.svg")).find("`b`"), std::string::npos);
  ExpectBadInput("plot run_1 -o one.bmp", "expected .png or .svg");
}

}  // namespace
}  // namespace flexarm
