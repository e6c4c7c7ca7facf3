#include "controller/runlog/run_conversion.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>
#include <variant>

#include "controller/runlog/append_file.h"
#include "controller/runlog/errors.h"
#include "controller/runlog/file_descriptor.h"
#include "controller/runlog/recovered_result.h"
#include "controller/runlog/run_tables.h"

namespace flexarm {
namespace {

RecordFileEnd FillFrom(RecordFileReader* from, RunTables* tables, RecoveredResult* recovered) {
  RecordFileEnd end;
  while (std::optional<RunRecord> record = from->Next()) {
    tables->Add(*record);
    recovered->Add(*record);
    if (std::holds_alternative<EndRecord>(*record)) end.ended = true;
  }
  end.left_out_bytes = from->left_out_bytes();
  end.damaged_at = from->damaged_at();
  return end;
}

// No program reads it before it is whole, so it needs no journal, and one sync at the end.
RecordFileEnd WritePart(int fd, const std::filesystem::path& part) {
  RecordFileReader reader(fd);
  if (!reader.problem().empty()) throw RunLogError(reader.problem());
  SqliteDb db = SqliteDb::CreateNew(part);
  db.Execute("PRAGMA journal_mode=OFF");
  db.Execute("PRAGMA synchronous=OFF");
  RecordFileEnd end;
  {
    RunTables tables(&db, Packing::kSmall);
    RecoveredResult recovered;
    end = FillFrom(&reader, &tables, &recovered);
    if (!end.ended) {
      tables.Add(EndRecord{.result_json = recovered.Json(end.left_out_bytes)});
    }
    tables.Finish();
    tables.Seal();
    tables.Commit();
  }
  db.Close();
  return end;
}

// @returns 0, or errno
int SyncFile(const std::filesystem::path& file) {
  const FileDescriptor fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  return fd.is_open() && ::fsync(fd.get()) == 0 ? 0 : errno;
}

}  // namespace

std::filesystem::path DamagedNameOf(const std::filesystem::path& file) {
  return file.string() + ".damaged";
}

RecordFileEnd FillTables(RecordFileReader* from, SqliteDb* db) {
  RunTables tables(db, Packing::kFast);
  RecoveredResult unused;
  const RecordFileEnd end = FillFrom(from, &tables, &unused);
  tables.Finish();
  tables.Commit();
  return end;
}

RecordFileEnd ConvertRecordFile(int fd, const std::filesystem::path& file) {
  const std::filesystem::path part = PartOf(file);
  const auto fail = [&](const std::string& cause) {
    ::unlink(part.c_str());
    throw RunLogError(file.string() + ": " + cause);
  };
  ::unlink(part.c_str());  // of an attempt that was killed: a live one would hold the lock
  RecordFileEnd end;
  try {
    end = WritePart(fd, part);
  } catch (const SqliteError& error) {
    fail(std::string("cannot be turned into SQLite: ") + error.what());
  } catch (const RunLogError& error) {
    fail(error.what());
  }
  int error = SyncFile(part);
  if (error == 0 && end.damaged_at && ::link(file.c_str(), DamagedNameOf(file).c_str()) != 0) {
    error = errno;
  }
  if (error == 0 && ::rename(part.c_str(), file.c_str()) != 0) error = errno;
  if (error == 0) error = SyncDirectory(file.parent_path());
  if (error != 0) fail(std::string("cannot be turned into SQLite: ") + std::strerror(error));
  return end;
}

}  // namespace flexarm
