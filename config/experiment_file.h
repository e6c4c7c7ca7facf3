#pragma once

#include "config/table_reader.h"
#include "controller/types/experiment.h"

namespace flexarm {

/// Reads an experiment, except its text. Values that cannot be read are reported in the reader's
/// log.
void ReadExperiment(TableReader root, Experiment* out);

}  // namespace flexarm
