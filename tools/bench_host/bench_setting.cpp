#include "tools/bench_host/bench_setting.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include "controller/host/simulation.h"
#include "controller/runlog/run_reader.h"

namespace flexarm {

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "flexarm-bench-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error(name + ": cannot make a folder: " + std::strerror(errno));
  }
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

RecordedRun RecordRun(const BenchSetting& setting, const std::filesystem::path& folder) {
  RecordedRun run{.log = folder / "recorded.flexarm", .inputs = {}};
  Simulate({.config = setting.config,
            .experiment = setting.experiment,
            .payload_kg = {},
            .log = run.log});
  RunReader reader(run.log);
  reader.ForEachTick([&run](const TickRecord& tick) { run.inputs.push_back(tick.input); });
  return run;
}

}  // namespace flexarm
