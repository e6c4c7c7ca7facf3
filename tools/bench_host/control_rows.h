#pragma once

#include <string>

#include "tools/bench_host/bench_row.h"
#include "tools/bench_host/bench_setting.h"

namespace flexarm {

/// One sample of the controller, ControlStep::Step, with a law: a mean over the inputs of a run.
BenchRow StepRow(const BenchSetting& setting, const RecordedRun& run, const std::string& law);

/// One plan of the law `receding-horizon`, which continues a plan from the sample before.
BenchRow PlanRow(const BenchSetting& setting);

}  // namespace flexarm
