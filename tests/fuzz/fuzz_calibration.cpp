#include "controller/commissioning/calibration_file.h"
#include "controller/files/input_error.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_targets.h"

namespace flexarm {

void FuzzCalibration(FuzzBytes input) {
  static const FuzzFile file("calibration.json");
  static const SensorConfig sensors = ShippedRig().sensors;
  file.Write(TextOf(input));
  try {
    ReadCalibration(file.path(), sensors);
  } catch (const InputError&) {
  }
}

}  // namespace flexarm
