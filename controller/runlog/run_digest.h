#pragma once

#include <string>

#include "controller/runlog/sqlite_db.h"

namespace flexarm {

/// XXH3-128 over all values of all tables, in the order of their keys and with their types, but for
/// the key `digest` of table `run`, where it is kept: 32 hexadecimal digits.
/// @throws SqliteError, also if the rows of a table are not in order
std::string DigestOfTables(SqliteDb* db);

}  // namespace flexarm
