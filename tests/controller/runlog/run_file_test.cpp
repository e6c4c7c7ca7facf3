// A run written to a file is read back bit by bit, also after a crash or from a read-only folder.

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "controller/runlog/blob.h"
#include "controller/runlog/build_info.h"
#include "controller/runlog/tick_columns.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

using RunFileTest = RunLogTest;

TEST(BuildInfo, TheProcessorOfABuildIsInItsId) {
  EXPECT_EQ(ProcessorOf("0123456789ab-dirty GNU 12.2.0 aarch64 77f2"), "aarch64");
  EXPECT_TRUE(ThisBuild().compiler.ends_with(std::string(" ").append(ProcessorOf(BuildId()))));
}

TEST_F(RunFileTest, TicksReadBackBitExactIncludingNegativeZeroAndNan) {
  TickRecord odd = MakeTick(3);
  odd.output.torque_nm = {-0.0, std::numeric_limits<double>::quiet_NaN()};
  odd.output.x_hat[5] = -std::numeric_limits<double>::infinity();
  std::uint64_t nan_with_payload = 0x7ff800000000beefU;
  std::memcpy(&odd.input.applied_torque_nm[1], &nan_with_payload, sizeof(double));
  odd.truth.known = false;
  {
    RunWriter writer(File(), MakeInfo());
    writer.Tick(MakeTick(2));
    writer.Tick(odd);
    writer.Close("{}");
  }
  const RunContents run = RunReader(File()).ReadAll();
  ASSERT_EQ(run.tick.size(), 2U);
  EXPECT_TRUE(SameBytes(run.tick[0].input, MakeTick(2).input));
  EXPECT_TRUE(SameBytes(run.tick[0].output, MakeTick(2).output));
  EXPECT_EQ(run.tick[0].truth.tip_m, MakeTick(2).truth.tip_m);
  EXPECT_EQ(run.tick[0].truth.hub_angle_rad, MakeTick(2).truth.hub_angle_rad);
  EXPECT_EQ(run.tick[0].truth.tip_deflection_m, MakeTick(2).truth.tip_deflection_m);
  EXPECT_TRUE(run.tick[0].truth.known);
  EXPECT_TRUE(SameBytes(run.tick[1].input, odd.input));
  EXPECT_TRUE(SameBytes(run.tick[1].output, odd.output));
  EXPECT_FALSE(run.tick[1].truth.known);
}

TEST_F(RunFileTest, AllOtherRecordsReadBack) {
  const SafetyRecord safety =
      MakeSafety(5, {SafetyState::kIdle, TripCause::kNone}, RequestKind::kArm);
  const RunEvent event{.time_ns = 7,
                       .kind = "gap",
                       .name = "ticks",
                       .text = "it's \"so\"",
                       .value_json = "{\"a\":1}"};
  RunInfo info = MakeInfo();
  info.start_ns = 4;
  info.experiment_name = "square";
  info.experiment_text = "text one";
  {
    RunWriter writer(File(), info);
    writer.Safety(safety);
    writer.Timing({.tick = 1, .due_ns = 2, .woke_ns = 3, .finished_ns = 4});
    writer.Event(event);
    writer.Close("{\"trip\":null}");
  }
  RunReader reader(File());
  EXPECT_TRUE(reader.closed());
  const RunContents run = reader.ReadAll();
  EXPECT_EQ(run.info.start_utc, info.start_utc);
  EXPECT_EQ(run.info.start_ns, 4);
  EXPECT_EQ(run.info.build_id, BuildId());
  EXPECT_EQ(run.info.version, ThisBuild().version);
  EXPECT_EQ(run.info.rig_name, info.rig_name);
  EXPECT_EQ(run.info.seed, info.seed);
  EXPECT_EQ(run.info.config_text, info.config_text);
  EXPECT_EQ(run.info.gains_json, info.gains_json);
  EXPECT_EQ(run.info.experiment_name, "square");
  EXPECT_EQ(run.info.experiment_text, "text one");
  EXPECT_EQ(run.info.result_json, "{\"trip\":null}");
  ASSERT_EQ(run.safety.size(), 1U);
  EXPECT_TRUE(SameBytes(run.safety[0], safety));
  ASSERT_EQ(run.timing.size(), 1U);
  EXPECT_EQ(run.timing[0].finished_ns, 4);
  ASSERT_EQ(run.event.size(), 1U);
  EXPECT_EQ(run.event[0].text, event.text);
  EXPECT_EQ(run.event[0].value_json, event.value_json);
}

TEST_F(RunFileTest, ColumnsAgreeWithTheRecordsInTheirUnits) {
  TickRecord record = MakeTick(100);
  record.output.angle_rad[1] = 1.5707963267948966;
  record.gate_reasons = 0b10010;
  RunInfo info = MakeInfo();
  info.start_ns = 500'000'000;
  {
    RunWriter writer(File(), info);
    writer.Tick(record);
    writer.Close("");
  }
  SqliteDb db = SqliteDb::OpenReadOnly(File(), false);
  SqliteStatement row = db.Prepare(
      "SELECT time_s, state, hub_2_deg, torque_asked_1_nm, torque_applied_2_nm, gate,"
      " reference_1_deg FROM tick");
  ASSERT_TRUE(row.Step());
  EXPECT_DOUBLE_EQ(row.Real(0), 1.5);
  EXPECT_EQ(row.Text(1), "Running");
  EXPECT_DOUBLE_EQ(row.Real(2), 90.0);
  EXPECT_NEAR(row.Real(3), record.output.torque_nm[0], 0.5e-4);
  EXPECT_NEAR(row.Real(4), record.input.applied_torque_nm[1], 0.5e-4);
  EXPECT_EQ(row.Integer(5), 0b10010);
  EXPECT_NEAR(row.Real(6), record.input.reference_now.x_m[0] * 180 / 3.14159265358979, 0.5e-4);
}

TEST_F(RunFileTest, WhyTheGateChangedATorqueIsReadBack) {
  TickRecord record = MakeTick(100);
  record.gate_reasons = 0b10010;
  {
    RunWriter writer(File(), MakeInfo());
    writer.Tick(record);
    writer.Close("");
  }
  EXPECT_EQ(RunReader(File()).ReadAll().tick.at(0).gate_reasons, 0b10010U);
}

// Times off the grid of the first two, and values that have no step, are kept.
TEST_F(RunFileTest, TheViewsGiveEachSampleItsTimeAndUnknownValuesAreNull) {
  const std::int64_t times_ns[] = {20'000'000, 40'000'000, 60'000'001, 100'000'000};
  {
    RunWriter writer(File(), MakeInfo());
    for (int n = 0; n < 4; ++n) {
      TickRecord record = MakeTick(n < 3 ? n + 1 : 5);  // one is missing
      record.input.sampling_instant_ns = times_ns[n];
      record.output.payload_kg = std::numeric_limits<double>::quiet_NaN();
      record.output.payload_sigma_kg = std::numeric_limits<double>::infinity();
      writer.Tick(record);
      writer.Timing({.tick = n == 2 ? 2 : n + 1,
                     .due_ns = times_ns[n] + 10,
                     .woke_ns = times_ns[n] + 3'010,
                     .finished_ns = times_ns[n] + 8'510});
    }
    writer.Close("");
  }
  SqliteDb db = SqliteDb::OpenReadOnly(File(), false);
  SqliteStatement tick = db.Prepare("SELECT time_s, payload_kg, payload_sigma_kg FROM tick");
  SqliteStatement timing = db.Prepare("SELECT tick, due_ns, finished_ns, late_us FROM timing");
  for (int n = 0; n < 4; ++n) {
    ASSERT_TRUE(tick.Step() && timing.Step());
    EXPECT_DOUBLE_EQ(tick.Real(0), static_cast<double>(times_ns[n]) * 1e-9);
    EXPECT_TRUE(tick.IsNull(1) && tick.IsNull(2));
    EXPECT_EQ(timing.Integer(0), n == 2 ? 2 : n + 1);
    EXPECT_EQ(timing.Integer(1), times_ns[n] + 10);
    EXPECT_EQ(timing.Integer(2), times_ns[n] + 8'510);
    EXPECT_EQ(timing.Real(3), 3.0);
  }
  const std::vector<TimingRecord> read = RunReader(File()).ReadAll().timing;
  ASSERT_EQ(read.size(), 4U);
  EXPECT_EQ(read[2].tick, 2);
  EXPECT_EQ(read[3].woke_ns, times_ns[3] + 3'010);
}

TEST_F(RunFileTest, EachReadableColumnStandsOnceInTheView) {
  {
    RunWriter writer(File(), MakeInfo());
    writer.Close("");
  }
  SqliteDb db = SqliteDb::OpenReadOnly(File(), false);
  for (const TickColumn& column : TickColumns()) {
    SqliteStatement row =
        db.Prepare("SELECT count(*) FROM pragma_table_info('tick') WHERE name = ?");
    row.Bind(1, std::string_view(column.name));
    ASSERT_TRUE(row.Step());
    const bool is_state = std::string_view(column.name) == "state";
    EXPECT_EQ(row.Integer(0), is_state || column.steps_per_unit != 0 ? 1 : 0) << column.name;
  }
}

TEST_F(RunFileTest, AClosedRunIsOneFile) {
  {
    RunWriter writer(File(), MakeInfo());
    writer.Tick(MakeTick(1));
    writer.Commit();
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
    writer.Close("");
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

// For any reader of SQLite, not only ours.
TEST_F(RunFileTest, AClosedRunIsPlainSqlite) {
  {
    RunWriter writer(File(), MakeInfo());
    writer.Tick(MakeTick(1));
    writer.Close("{}");
  }
  SqliteDb db = SqliteDb::OpenReadOnly(File(), false);
  SqliteStatement mode = db.Prepare("PRAGMA journal_mode");
  ASSERT_TRUE(mode.Step());
  EXPECT_EQ(mode.Text(0), "delete");
  SqliteStatement check = db.Prepare("PRAGMA integrity_check");
  ASSERT_TRUE(check.Step());
  EXPECT_EQ(check.Text(0), "ok");
  EXPECT_EQ(db.QueryInteger("SELECT count(*) FROM tick"), 1);
}

TEST_F(RunFileTest, ARunIsNeverOverwritten) {
  WriteText(File(), "precious");
  try {
    RunWriter writer(File(), MakeInfo());
    FAIL() << "it overwrote a file";
  } catch (const RunLogError& error) {
    EXPECT_NE(std::string(error.what()).find("already exists"), std::string::npos) << error.what();
  }
  EXPECT_EQ(Bytes(File()), "precious");
}

TEST_F(RunFileTest, AFolderThatCannotBeMadeIsNamedWithItsCause) {
  WriteText(File("folder"), "a file, not a folder");
  try {
    RunWriter writer(File("folder") / "run.flexarm", MakeInfo());
    FAIL();
  } catch (const RunLogError& error) {
    EXPECT_NE(std::string(error.what()).find("folder/run.flexarm"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("Not a directory"), std::string::npos) << error.what();
  }
}

// A file size limit in place of a full disk: a write is cut short, then fails. @returns an exit
// code
int WriteBeyondALimit(const std::filesystem::path& file) {
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{.rlim_cur = 300'000, .rlim_max = RLIM_INFINITY};
  if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) return 2;
  RunWriter writer(file, MakeInfo());
  for (int tick = 1; tick <= 500; ++tick) {
    writer.Tick(MakeTick(tick));
    writer.Commit();
  }
  const std::string trouble = writer.Trouble();
  if (trouble.find(file.string() + ": cannot write the run log: File too large") != 0) {
    std::fprintf(stderr, "%s\n", trouble.c_str());
    return 1;
  }
  limit.rlim_cur = RLIM_INFINITY;
  if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) return 2;
  writer.Commit();
  if (!writer.Trouble().empty()) return 3;
  writer.Close("{}");
  return 0;
}

TEST_F(RunFileTest, AFullDiskIsNamedAsTheCauseAndLosesNothing) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::_exit(WriteBeyondALimit(File()));
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(RunReader(File()).ReadAll().tick.size(), 500U);
}

TEST_F(RunFileTest, ReadsARunWhileItIsWritten) {
  RunWriter writer(File(), MakeInfo());
  writer.Tick(MakeTick(1));
  writer.Commit();
  writer.Tick(MakeTick(2));
  RunReader reader(File());
  EXPECT_FALSE(reader.closed());
  EXPECT_EQ(reader.ReadAll().tick.size(), 1U);
  writer.Close("");  // a reader does not stop the writer
}

// Writes ticks and commits after every 25th, then kills itself without clean-up.
void WriteAndDie(const std::filesystem::path& file, int ticks) {
  RunWriter writer(file, MakeInfo());
  for (int tick = 1; tick <= ticks; ++tick) {
    writer.Tick(MakeTick(tick));
    if (tick % 25 == 0) writer.Commit();
  }
  ::kill(::getpid(), SIGKILL);
}

TEST_F(RunFileTest, AKilledProcessLosesOnlyWhatItDidNotCommit) {
  const pid_t child = ::fork();
  if (child == 0) WriteAndDie(File(), 1090);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  RunReader reader(File());
  EXPECT_FALSE(reader.closed());
  const RunContents run = reader.ReadAll();
  ASSERT_EQ(run.tick.size(), 1075U);
  EXPECT_TRUE(SameBytes(run.tick.back().output, MakeTick(1075).output));
}

TEST_F(RunFileTest, ReadsAKilledRunInAFolderWhereNothingMayBeWritten) {
  const pid_t child = ::fork();
  if (child == 0) WriteAndDie(File(), 60);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ::chmod(folder_.c_str(), 0555);
  const pid_t reader = ::fork();
  if (reader == 0) {
    // Root may write anywhere; user 65534 may not.
    if (::geteuid() == 0 && ::seteuid(65534) != 0) ::_exit(2);
    try {
      ::_exit(RunReader(File()).ReadAll().tick.size() == 50 ? 0 : 1);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      ::_exit(3);
    }
  }
  ASSERT_EQ(::waitpid(reader, &status, 0), reader);
  ::chmod(folder_.c_str(), 0755);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(RunFileTest, FileNamesAreUniqueAndValid) {
  const std::filesystem::path first = NewRunFile(folder_, "a/b c");
  EXPECT_EQ(first.parent_path(), folder_);
  EXPECT_NE(first.string().find("Z-a_b_c.flexarm"), std::string::npos) << first;
  WriteText(first, "");
  EXPECT_NE(NewRunFile(folder_, "a/b c"), first);
  EXPECT_NE(NewRunFile(folder_, "").string().find("-manual.flexarm"), std::string::npos);
}

}  // namespace
}  // namespace flexarm
