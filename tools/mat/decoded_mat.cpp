#include "tools/mat/decoded_mat.h"

#include <matio.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <variant>

#include "controller/runlog/file_descriptor.h"

namespace flexarm {
namespace {

using MatFile = std::unique_ptr<mat_t, int (*)(mat_t*)>;
using MatVariable = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

[[noreturn]] void Fail(const std::string& what) {
  throw std::runtime_error("libmatio cannot write " + what);
}

MatVariable Checked(matvar_t* variable, const std::string& name) {
  if (variable == nullptr) Fail("the variable " + name);
  return {variable, Mat_VarFree};
}

MatVariable Numbers(const std::string& name, std::vector<double> values) {
  std::array<std::size_t, 2> size = {values.size(), 1};
  return Checked(
      Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0),
      name);
}

// The lines below each other, each filled up with blanks; MAT files store columns.
MatVariable Text(const std::string& name, const std::vector<std::string>& lines) {
  std::size_t width = 0;
  for (const std::string& line : lines) width = std::max(width, line.size());
  std::string characters(lines.size() * width, ' ');
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = 0; j < lines[i].size(); ++j) {
      characters[j * lines.size() + i] = lines[i][j];
    }
  }
  std::array<std::size_t, 2> size = {lines.size(), width};
  return Checked(
      Mat_VarCreate(name.c_str(), MAT_C_CHAR, MAT_T_UTF8, 2, size.data(), characters.data(), 0),
      name);
}

MatVariable Units(const std::vector<DecodedColumn>& columns) {
  std::vector<const char*> names;
  for (const DecodedColumn& column : columns) names.push_back(column.name.c_str());
  std::array<std::size_t, 2> size = {1, 1};
  MatVariable units = Checked(Mat_VarCreateStruct("units", 2, size.data(), names.data(),
                                                  static_cast<unsigned>(names.size())),
                              "units");
  for (const DecodedColumn& column : columns) {  // the struct owns its fields
    Mat_VarSetStructFieldByName(units.get(), column.name.c_str(), 0,
                                Text(column.name, {column.unit}).release());
  }
  return units;
}

void Write(mat_t* file, const MatVariable& variable) {
  if (Mat_VarWrite(file, variable.get(), MAT_COMPRESSION_ZLIB) != 0) {
    Fail(std::string("the variable ") + variable->name);
  }
}

std::string ReadAll(int fd) {
  std::string bytes;
  std::array<char, 65536> part;
  for (off_t at = 0;;) {
    const ssize_t count = ::pread(fd, part.data(), part.size(), at);
    if (count < 0) throw std::system_error(errno, std::generic_category(), "a file in memory");
    if (count == 0) return bytes;
    bytes.append(part.data(), static_cast<std::size_t>(count));
    at += count;
  }
}

}  // namespace

DecodedMat::DecodedMat(const DecodedRun& run)
    : columns_(DecodedColumns(run)), values_(columns_.size()) {}

void DecodedMat::Row(const DecodedSample& sample) {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const ColumnValue value = columns_[i].value(sample);
    if (const auto* text = std::get_if<std::string_view>(&value)) {
      values_[i].text.emplace_back(*text);
    } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
      values_[i].number.push_back(static_cast<double>(*whole));
    } else {
      values_[i].number.push_back(std::get<double>(value));
    }
  }
}

std::string DecodedMat::Bytes() const {
  // libmatio writes files by name only: here one that exists in memory alone.
  const FileDescriptor memory(::memfd_create("flexarm-mat", MFD_CLOEXEC));
  if (!memory.is_open()) {
    throw std::system_error(errno, std::generic_category(), "a file in memory");
  }
  const std::string name = "/proc/self/fd/" + std::to_string(memory.get());
  MatFile file(Mat_CreateVer(name.c_str(), kDecodedMatMark, MAT_FT_MAT5), Mat_Close);
  if (!file) Fail("a MAT file");
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    Write(file.get(), values_[i].text.empty() ? Numbers(columns_[i].name, values_[i].number)
                                              : Text(columns_[i].name, values_[i].text));
  }
  Write(file.get(), Units(columns_));
  file.reset();
  return ReadAll(memory.get());
}

}  // namespace flexarm
