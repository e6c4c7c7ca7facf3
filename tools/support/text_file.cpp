#include "tools/support/text_file.h"

#include <fstream>

#include "controller/runlog/errors.h"

namespace flexarm {

void WriteText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw InputError(file.string() + ": cannot be written");
}

}  // namespace flexarm
