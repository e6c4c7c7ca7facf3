#pragma once

#include "tools/bench_host/bench_row.h"
#include "tools/bench_host/bench_setting.h"

namespace flexarm {

/// One evaluation of PlantRate in motion, 4 modes on each link.
BenchRow RateRow(const BenchSetting& setting);

/// One step of ArmSimulator in motion as the simulated rig makes it, its friction included.
BenchRow IntegratorRow(const BenchSetting& setting);

/// The setting's experiment in lock step: loop, safety and plant, without design and log.
/// @param integrator, step  rows of this run whose counts are added up; step of the config's law
BenchRow ExperimentRow(const BenchSetting& setting, const BenchRow& integrator,
                       const BenchRow& step);

}  // namespace flexarm
