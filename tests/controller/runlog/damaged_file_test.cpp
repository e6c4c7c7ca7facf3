// Damaged logs: one InputError that names the damage, or a valid prefix.

#include <sqlite3.h>

#include <algorithm>
#include <chrono>

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
    for (int i = 1; i <= 3; ++i) {
      writer.Timing({.tick = i, .due_ns = 2, .woke_ns = 3, .finished_ns = 4});
    }
    writer.Event({.time_ns = 1, .kind = "command", .name = "arm", .text = "", .value_json = ""});
    writer.Close("{}");
  }
  // What `replay` and `check` say: "" if they find nothing.
  static std::string VerificationError(const std::filesystem::path& file) {
    return MessageOf<InputError>([&] {
      RunReader reader(file);
      if (!reader.DigestHolds()) throw InputError("digest");
      reader.ReadAll();
    });
  }
  // All values of all tables, by SQLite itself and not by our reader; "" if it cannot read them.
  static std::string Dump(const std::filesystem::path& file) {
    sqlite3* db = nullptr;
    std::string dump;
    sqlite3_open(file.c_str(), &db);
    for (const char* sql :
         {"SELECT * FROM run", "SELECT * FROM block", "SELECT * FROM grid", "SELECT * FROM sample",
          "SELECT * FROM activation", "SELECT * FROM safety", "SELECT * FROM event"}) {
      sqlite3_stmt* row = nullptr;
      if (sqlite3_prepare_v2(db, sql, -1, &row, nullptr) != SQLITE_OK) dump += "error";
      while (sqlite3_step(row) == SQLITE_ROW) {
        for (int i = 0; i < sqlite3_column_count(row); ++i) {
          dump += std::to_string(sqlite3_column_type(row, i)) + ":";
          const auto* bytes = static_cast<const char*>(sqlite3_column_blob(row, i));
          dump.append(
              bytes == nullptr ? "" : bytes,
              bytes == nullptr ? 0 : static_cast<std::size_t>(sqlite3_column_bytes(row, i)));
        }
      }
      sqlite3_finalize(row);
    }
    sqlite3_close(db);
    return dump;
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

// SQLite itself takes the bytes that are missing of a last page for zeros.
TEST_F(DamagedFileTest, ALogWithoutItsLastBytesIsCutShort) {
  WriteRun(20);
  const std::string whole = Bytes(File());
  for (const std::size_t missing : {1U, 100U, 2'000U, 4'000U}) {
    WriteText(File(), whole.substr(0, whole.size() - missing));
    ExpectError("cut short");
  }
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
  ExpectError("begins with \"time_s,counter_1\", expected a run log");
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
  Alter("PRAGMA user_version=4");
  ExpectError("schema version 4, expected 3; it was written by a newer flexarm");
}

TEST_F(DamagedFileTest, AnEarlierSchemaIsRefused) {
  WriteRun(1);
  Alter("PRAGMA user_version=2");
  ExpectError("schema version 2, expected 3; it was written by an earlier flexarm");
}

TEST_F(DamagedFileTest, AShortBlockIsNamedWithItsTick) {
  WriteRun(3);
  Alter("UPDATE block SET records = substr(records, 1, 600)");
  ExpectError("block of tick 1: is damaged: expected 3 packed records");
  Alter("UPDATE block SET records = substr(records, 1, 8)");
  ExpectError("block of tick 1: is cut short");
}

// However many records it promises.
TEST_F(DamagedFileTest, ABlockWithAnotherNumberOfRecordsIsNamed) {
  for (const char* const count : {"00000000", "01040000", "ffffffff"}) {
    WriteRun(3);
    Alter((std::string("UPDATE block SET records = CAST(x'") + count +
           "' || substr(records, 5) AS BLOB)")
              .c_str());
    ExpectError("records, expected 1 to 1024");
    std::filesystem::remove(File());
  }
  WriteRun(3);
  Alter("UPDATE block SET records = CAST(x'02000000' || substr(records, 5) AS BLOB)");
  ExpectError("is damaged: expected 2 packed records");
}

TEST_F(DamagedFileTest, ABlockOfAnotherTickIsNamed) {
  WriteRun(3);
  Alter("UPDATE block SET first_tick = 2");
  ExpectError("block of tick 2: begins with tick 1");
}

TEST_F(DamagedFileTest, ABlockOfAnotherVersionIsNamed) {
  WriteRun(3);
  Alter(
      "UPDATE block SET records = CAST(substr(records, 1, 8) || x'09000000' || substr(records, 13)"
      " AS BLOB)");
  ExpectError("block of tick 1: has outputs of version 9, expected 3");
}

TEST_F(DamagedFileTest, AShortSafetyRecordIsNamed) {
  WriteRun(1);
  Alter("UPDATE safety SET record = x'03000000'");
  ExpectError("safety row 1 has 4 bytes, expected " + std::to_string(4 + sizeof(SafetyRecord)));
}

TEST_F(DamagedFileTest, AMissingTableIsNamed) {
  WriteRun(1);
  Alter("DROP TABLE block");
  ExpectError("tables that are not those of a run log: found another table ");
}

// Schemas made to hurt: none is run, and none takes long to refuse.
TEST_F(DamagedFileTest, AnySchemaButOurOwnIsRefusedBeforeItIsRead) {
  const char* const kChanges[] = {
      "DROP TABLE event; CREATE VIEW event AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i+1"
      " FROM n) SELECT i AS number, i AS time_ns, '' AS kind, '' AS name, '' AS text, '' AS"
      " value_json FROM n",
      "CREATE VIEW more AS SELECT * FROM tick",
      "CREATE TABLE more (a)",
      "CREATE INDEX more ON activation(late_ns)",
      "CREATE TRIGGER more AFTER INSERT ON block BEGIN DELETE FROM block; END",
      "DROP VIEW tick",
      "ALTER TABLE activation ADD COLUMN big TEXT AS (hex(zeroblob(500000000)))",
      "ALTER TABLE run RENAME TO runs",
      "ANALYZE",
  };
  for (const char* change : kChanges) {
    WriteRun(1);
    Alter(change);
    const auto begin = std::chrono::steady_clock::now();
    const std::string error = ReadingError(File());
    EXPECT_NE(error.find("of a run log"), std::string::npos) << change << "\n" << error;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5)) << change;
    std::filesystem::remove(File());
  }
}

// A page of a table that stands in the table twice: a tree without an end, or with rows twice.
TEST_F(DamagedFileTest, ATableWhosePagesLeadBackIsRefused) {
  WriteRun(400);
  const std::string whole = Bytes(File());
  std::mt19937 random(3);
  constexpr std::size_t kPage = 4096;
  for (int i = 0; i < 200; ++i) {
    std::string damaged = whole;
    const std::size_t pages = whole.size() / kPage;
    const std::size_t from = random() % pages, to = 1 + random() % (pages - 1);
    if (from == to) continue;
    std::copy_n(whole.begin() + static_cast<std::ptrdiff_t>(from * kPage), kPage,
                damaged.begin() + static_cast<std::ptrdiff_t>(to * kPage));
    WriteText(File("double"), damaged);
    EXPECT_NE(VerificationError(File("double")), "") << from << " over " << to;
  }
}

// Finding 33: no single bit of what a closed run holds changes unnoticed. Bytes that no value uses
// may differ; then everything reads as it was.
TEST_F(DamagedFileTest, NoFlippedBitThatChangesALogPassesItsDigest) {
  WriteRun(60);
  const std::string whole = Bytes(File());
  const std::string contents = Dump(File());
  std::mt19937 random(33);
  int told = 0;
  for (int i = 0; i < 600; ++i) {
    std::string damaged = whole;
    const std::size_t at = random() % whole.size();
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
    WriteText(File("flipped"), damaged);
    if (!VerificationError(File("flipped")).empty()) {
      ++told;
    } else {
      ASSERT_EQ(Dump(File("flipped")), contents) << "bit of byte " << at;
    }
  }
  EXPECT_GT(told, 200);  // the last page of each table is partly unused
}

TEST_F(DamagedFileTest, AnEditedValueOrADigestThatIsGoneIsNamed) {
  for (const char* change :
       {"UPDATE sample SET hub_1_deg_x10000 = hub_1_deg_x10000 + 1 WHERE tick = 2",
        "DELETE FROM event", "UPDATE run SET value = '8' WHERE key = 'seed'",
        "DELETE FROM activation WHERE number = 2", "DELETE FROM run WHERE key = 'digest'",
        "UPDATE sample SET state = CAST(state AS TEXT) || 'a'",
        "UPDATE grid SET first_ns = first_ns + 1"}) {
    WriteRun(3);
    EXPECT_EQ(VerificationError(File()), "");
    Alter(change);
    EXPECT_EQ(VerificationError(File()), "digest") << change;
    std::filesystem::remove(File());
  }
}

}  // namespace
}  // namespace flexarm
