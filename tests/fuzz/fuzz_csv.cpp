#include <vector>

#include "config/attachment.h"
#include "controller/files/input_error.h"
#include "controller/runlog/csv_import.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_targets.h"

namespace flexarm {
namespace {

CsvColumn Column(const char* name, std::size_t unit, const char* target) {
  return {.column = name, .unit = kCsvUnits[unit], .scale = 1.0, .offset = 0.0, .target = target};
}

// Another recorder with two gauges: time in ms, angles in degrees.
CsvImport Foreign(bool resample) {
  CsvImport import{.decimation = 2, .resample = resample};
  import.column = {Column("t", 1, "time"),       Column("a", 5, "hub1"),
                   Column("b", 5, "hub2"),       Column("m", 10, "torque_1"),
                   Column("n", 10, "torque_2"),  Column("g", 8, "strain_1_01"),
                   Column("h", 8, "strain_2_01")};
  return import;
}

SensorConfig TwoGauges() {
  SensorConfig sensors = ShippedRig().sensors;
  SensorConfig few = sensors;
  few.encoder.resize(2);
  few.strain.clear();
  for (const int link : {1, 2}) {
    for (const StrainChannelConfig& row : sensors.strain) {
      if (row.link != link) continue;
      few.strain.push_back(row);
      break;
    }
  }
  return few;
}

template <typename Read>
void Refusable(const Read& read) {
  try {
    read();
  } catch (const InputError&) {
  }
}

}  // namespace

// As a run of our own, as one of another recorder, and as the trajectory of an experiment.
void FuzzCsv(FuzzBytes input) {
  static const FuzzFile file("input.csv");
  static const SensorConfig own = ShippedRig().sensors;
  static const SensorConfig two = TwoGauges();
  static const CsvImport each = Foreign(false), resampled = Foreign(true);
  constexpr double kPeriod_s = 0.02;
  file.Write(TextOf(input));
  Refusable([] { ReadAnyCsv(file.path(), nullptr, own, kPeriod_s); });
  Refusable([] { ReadForeignCsv(file.path(), each, two, kPeriod_s); });
  Refusable([] { ReadForeignCsv(file.path(), resampled, two, kPeriod_s); });
  Refusable([&] { ReadTrajectory("input.csv", TextOf(input)); });
}

}  // namespace flexarm
