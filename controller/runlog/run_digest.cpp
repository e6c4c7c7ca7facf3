#include "controller/runlog/run_digest.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "controller/runlog/checksum.h"
#include "controller/runlog/row_order.h"
#include "controller/runlog/schema.h"

namespace flexarm {
namespace {

struct TableRows {
  const char* table;
  const char* select;  // the key first
};

constexpr std::array kTables = {
    TableRows{"block", "SELECT * FROM block ORDER BY first_tick"},
    TableRows{"grid", "SELECT * FROM grid ORDER BY number"},
    TableRows{"sample", "SELECT * FROM sample ORDER BY tick"},
    TableRows{"activation", "SELECT * FROM activation ORDER BY number"},
    TableRows{"safety", "SELECT * FROM safety ORDER BY number"},
    TableRows{"event", "SELECT * FROM event ORDER BY number"},
};

void AppendNumber(std::uint64_t number, std::string* bytes) {
  std::array<char, sizeof number> raw;
  std::memcpy(raw.data(), &number, sizeof number);
  bytes->append(raw.data(), raw.size());
}

// Type, then eight bytes: the number, or the length of the bytes that follow.
void AppendValue(const SqliteStatement& row, int column, std::string* bytes) {
  const SqliteType type = row.Type(column);
  bytes->push_back(static_cast<char>(type));
  switch (type) {
    case SqliteType::kInteger:
      AppendNumber(std::bit_cast<std::uint64_t>(row.Integer(column)), bytes);
      break;
    case SqliteType::kReal:
      AppendNumber(std::bit_cast<std::uint64_t>(row.Real(column)), bytes);
      break;
    case SqliteType::kText:
    case SqliteType::kBlob: {
      const std::span<const std::byte> value = row.Blob(column);
      AppendNumber(value.size(), bytes);
      bytes->append(reinterpret_cast<const char*>(value.data()), value.size());
      break;
    }
    case SqliteType::kNull:
      break;
  }
}

void AddRow(const SqliteStatement& row, std::string* buffer, Digest128* digest) {
  buffer->clear();
  AppendNumber(static_cast<std::uint64_t>(row.Columns()), buffer);
  for (int column = 0; column < row.Columns(); ++column) AppendValue(row, column, buffer);
  digest->Add(*buffer);
}

}  // namespace

std::string DigestOfTables(SqliteDb* db) {
  Digest128 digest;
  std::string buffer;
  digest.Add("run");
  RowOrder<std::string> keys("run");
  SqliteStatement key = db->Prepare("SELECT key, value FROM run ORDER BY key");
  while (key.Step()) {
    keys.Next(key.Text(0));
    if (key.Text(0) != run_key::kDigest) AddRow(key, &buffer, &digest);
  }
  for (const TableRows& rows : kTables) {
    digest.Add(rows.table);
    RowOrder<std::int64_t> order(rows.table);
    SqliteStatement row = db->Prepare(rows.select);
    while (row.Step()) {
      order.Next(row.Integer(0));
      AddRow(row, &buffer, &digest);
    }
  }
  return digest.Hex();
}

}  // namespace flexarm
