// Damaged logs: one InputError that names the damage, or a valid prefix.

#include <sqlite3.h>

#include "controller/runlog/blob.h"
#include "controller/runlog/schema.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

class DamagedFileTest : public RunLogTest {
 protected:
  void WriteRun(int ticks) {
    RunWriter writer(File(), MakeInfo());
    for (int tick = 1; tick <= ticks; ++tick) writer.Tick(MakeTick(tick));
    writer.Safety(MakeSafety(1, {SafetyState::kIdle, TripCause::kNone}, RequestKind::kArm));
    writer.Close("{}");
  }
  void Alter(const char* sql) {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(File().c_str(), &db), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(db, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
    sqlite3_close(db);
  }
  void ExpectError(const std::string& text) {
    const std::string error = ReadingError(File());
    EXPECT_EQ(error.find(File().string() + ": "), 0U) << error;
    EXPECT_NE(error.find(text), std::string::npos) << error;
  }
};

TEST_F(DamagedFileTest, ALogCutAnywhereIsAnErrorOrAPrefix) {
  WriteRun(100);
  const std::string whole = Bytes(File());
  std::mt19937 random(1);
  int errors = 0;
  for (int i = 0; i < 100; ++i) {
    const std::size_t length = std::uniform_int_distribution<std::size_t>(0, whole.size())(random);
    WriteText(File("cut"), whole.substr(0, length));
    try {
      const RunContents run = RunReader(File("cut")).ReadAll();
      for (std::size_t n = 0; n < run.tick.size(); ++n) {
        ASSERT_TRUE(SameBytes(run.tick[n].input, MakeTick(static_cast<int>(n) + 1).input));
      }
    } catch (const InputError& error) {
      ++errors;
      EXPECT_NE(std::string(error.what()).find("expected"), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(errors, 90);
}

TEST_F(DamagedFileTest, FlippedBytesNeverCrash) {
  WriteRun(20);
  const std::string whole = Bytes(File());
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    std::string damaged = whole;
    for (int n = 0; n < 20; ++n) damaged[random() % damaged.size()] = static_cast<char>(random());
    WriteText(File("flipped"), damaged);
    ReadingError(File("flipped"));
  }
}

TEST_F(DamagedFileTest, ATextFileIsNotARunLog) {
  WriteText(File(), "time_s,counter_1\n0,0\n");
  ExpectError("begins with \"time_s,counter_1\", expected a SQLite file");
}

TEST_F(DamagedFileTest, AMissingFileIsNamed) { ExpectError("No such file or directory"); }

TEST_F(DamagedFileTest, AnEmptyFileIsNamed) {
  WriteText(File(), "");
  ExpectError("is empty");
}

TEST_F(DamagedFileTest, AFolderIsNotARunLog) {
  std::filesystem::create_directory(File());
  ExpectError("expected a run log");
}

TEST_F(DamagedFileTest, AnotherApplicationsFileIsRefused) {
  WriteRun(1);
  Alter("PRAGMA application_id=77");
  ExpectError("application id 77, expected " + std::to_string(kRunLogApplicationId));
}

TEST_F(DamagedFileTest, ANewerSchemaIsRefused) {
  WriteRun(1);
  Alter("PRAGMA user_version=2");
  ExpectError("schema version 2, expected at most 1");
}

TEST_F(DamagedFileTest, AShortBlobIsNamedWithItsTick) {
  WriteRun(3);
  Alter("UPDATE tick SET input = substr(input, 1, 600) WHERE tick = 2");
  ExpectError("tick 2: input has 600 bytes, expected " + std::to_string(4 + sizeof(StepInput)));
}

TEST_F(DamagedFileTest, ABlobOfAnotherVersionIsNamed) {
  WriteRun(3);
  Alter("UPDATE tick SET output = x'09000000' || substr(output, 5) WHERE tick = 3");
  ExpectError("tick 3: output has version 9, expected 3");
}

TEST_F(DamagedFileTest, AShortSafetyRecordIsNamed) {
  WriteRun(1);
  Alter("UPDATE safety SET record = x'03000000'");
  ExpectError("safety row 1 has 4 bytes, expected " + std::to_string(4 + sizeof(SafetyRecord)));
}

TEST_F(DamagedFileTest, AMissingTableIsNamed) {
  WriteRun(1);
  Alter("DROP TABLE tick");
  ExpectError("no such table: tick");
}

}  // namespace
}  // namespace flexarm
