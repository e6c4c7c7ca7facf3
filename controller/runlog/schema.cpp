#include "controller/runlog/schema.h"

#include <string>
#include <vector>

#include "controller/runlog/safety_rows.h"
#include "controller/runlog/sample_table.h"
#include "controller/runlog/sqlite_db.h"

namespace flexarm {
namespace {

// One row of sqlite_master, as text.
std::string SchemaRow(const SqliteStatement& row) {
  return row.Text(0) + " " + row.Text(1) + ": " + row.Text(2);
}

constexpr const char* kSelectSchema =
    "SELECT type, name, ifnull(sql, '') FROM sqlite_master ORDER BY rowid";

std::vector<std::string> ExpectedSchema() {
  SqliteDb db = SqliteDb::InMemory();
  CreateRunTables(&db);
  std::vector<std::string> rows;
  SqliteStatement row = db.Prepare(kSelectSchema);
  while (row.Step()) rows.push_back(SchemaRow(row));
  return rows;
}

std::string NameOf(const std::string& schema_row) {
  return schema_row.substr(0, schema_row.find(':'));
}

}  // namespace

void CreateRunTables(SqliteDb* db) {
  const std::string id = std::to_string(kRunLogApplicationId);
  const std::string version = std::to_string(kRunLogSchemaVersion);
  db->Execute(("PRAGMA application_id=" + id).c_str());
  db->Execute(("PRAGMA user_version=" + version).c_str());
  db->Execute(kRunLogSchema);
  db->Execute(CreateSampleTables().c_str());
  db->Execute(kSafetyTable);
}

std::string SchemaProblem(SqliteDb* db) {
  const std::int64_t id = db->QueryInteger("PRAGMA application_id");
  if (id != kRunLogApplicationId) {
    return "not a run log: a SQLite file with application id " + std::to_string(id) +
           ", expected " + std::to_string(kRunLogApplicationId);
  }
  const std::int64_t version = db->QueryInteger("PRAGMA user_version");
  if (version != kRunLogSchemaVersion) {
    return "has schema version " + std::to_string(version) + ", expected " +
           std::to_string(kRunLogSchemaVersion) + "; it was written by " +
           (version > kRunLogSchemaVersion ? "a newer" : "an earlier") +
           " flexarm: read it with the one that wrote it";
  }
  SqliteStatement row = db->Prepare(kSelectSchema);
  static const std::vector<std::string> kExpected = ExpectedSchema();
  for (const std::string& expected : kExpected) {
    if (!row.Step()) return "has no " + NameOf(expected) + "; expected the tables of a run log";
    if (SchemaRow(row) == expected) continue;
    return "has tables that are not those of a run log: found another " + NameOf(expected);
  }
  if (row.Step()) return "has more than the tables of a run log: found " + NameOf(SchemaRow(row));
  return {};
}

}  // namespace flexarm
