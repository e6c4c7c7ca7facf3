#include "tests/fuzz/fuzz_file.h"

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace flexarm {

FuzzFile::FuzzFile(const std::string& name) {
  const bool in_memory = std::filesystem::is_directory("/dev/shm");
  std::string folder = in_memory ? "/dev/shm/flexarm-fuzz-XXXXXX" : "/tmp/flexarm-fuzz-XXXXXX";
  if (mkdtemp(folder.data()) == nullptr)
    throw std::runtime_error("no folder for inputs: " + folder);
  path_ = std::filesystem::path(folder) / name;
}

FuzzFile::~FuzzFile() {
  std::error_code ignored;
  std::filesystem::remove_all(path_.parent_path(), ignored);
}

void FuzzFile::Write(std::string_view bytes) const {
  for (const auto& entry : std::filesystem::directory_iterator(path_.parent_path())) {
    if (entry.path() != path_) std::filesystem::remove_all(entry.path());
  }
  std::ofstream file(path_, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path_.string());
}

}  // namespace flexarm
