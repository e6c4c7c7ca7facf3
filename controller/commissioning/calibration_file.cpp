#include "controller/commissioning/calibration_file.h"

#include <nlohmann/json.hpp>

#include "controller/commissioning/calibrate.h"
#include "controller/files/external_file.h"
#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/files/write_file.h"
#include "controller/runlog/csv.h"

namespace flexarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int kKept = 9;  // older calibrations

[[noreturn]] void Fail(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": " + what);
}

OrderedJson ToJson(const SensorConfig& sensors, const Calibration& calibration) {
  OrderedJson json{{"flexarm", "calibration"},
                   {"encoder", OrderedJson::array()},
                   {"strain", OrderedJson::array()}};
  for (const EncoderConfig& encoder : sensors.encoder) {
    const auto i = static_cast<std::size_t>(encoder.counter);
    json["encoder"].push_back({{"joint", CounterName(encoder.counter)},
                               {"counts_per_turn", encoder.counts_per_turn},
                               {"sign", encoder.sign},
                               {"zero_counts", calibration.counter_zero[i]}});
  }
  const std::vector<std::string> names = StrainColumns(sensors);
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    const StrainChannelConfig& row = sensors.strain[i];
    json["strain"].push_back({{"channel", names[i]},
                              {"position_m", row.position_m},
                              {"face", row.face},
                              {"gain_v_per_unit", row.gain_v_per_unit},
                              {"zero_counts", calibration.strain_zero_counts[i]},
                              {"gain_error", calibration.strain_gain_error[i]}});
  }
  return json;
}

// The file of another rig must be rejected: everything except the measured values is compared.
void CheckSensors(const std::filesystem::path& file, OrderedJson found, OrderedJson expected) {
  for (OrderedJson* json : {&found, &expected}) {
    for (const char* list : {"encoder", "strain"}) {
      for (OrderedJson& row : (*json)[list]) {
        if (!row.is_object()) {
          Fail(file, std::string("'") + list + "': found a row that is no JSON object");
        }
        row.erase("zero_counts");
        row.erase("gain_error");
      }
    }
  }
  if (found == expected) return;
  Fail(file,
       "was made for other sensors than the config's [sensors]: remove it, then run `flexarm tare` "
       "and `flexarm zero`");
}

std::filesystem::path Older(const std::filesystem::path& file, int number) {
  return file.string() + "." + std::to_string(number);
}

// Keeps the file's contents as FILE.1, those of FILE.1 as FILE.2 and so on. A copy and no rename:
// the file itself is there at every instant. What cannot be kept does not stop a calibration.
void KeepOlder(const std::filesystem::path& file, const std::string& next) {
  const FileContent present = ReadExternalFile(file, kCalibrationFile);
  if (present.problem || present.text == next) return;
  std::error_code ignored;
  for (int number = kKept; number > 1; --number) {
    std::filesystem::rename(Older(file, number - 1), Older(file, number), ignored);
  }
  std::filesystem::copy_file(file, Older(file, 1), ignored);
}

}  // namespace

std::string CalibrationText(const SensorConfig& sensors, const Calibration& calibration) {
  return ToJson(sensors, calibration).dump(1) + "\n";
}

void WriteCalibration(const std::filesystem::path& file, const SensorConfig& sensors,
                      const Calibration& calibration) {
  const std::string beyond = OutOfRange(sensors, calibration);
  if (!beyond.empty()) Fail(file, "is not written: " + beyond);
  if (file.has_parent_path()) MakeFolder(file.parent_path());
  const std::string text = CalibrationText(sensors, calibration);
  KeepOlder(file, text);
  WriteFile(file, text,
            {.kind = "a calibration", .mark = kCalibrationMark, .inputs = {}, .overwrite = false});
}

std::optional<Calibration> ReadCalibration(const std::filesystem::path& file,
                                           const SensorConfig& sensors) {
  const FileContent content = ReadExternalFile(file, kCalibrationFile);
  if (content.problem && content.problem->missing) return std::nullopt;
  if (content.problem) throw InputError(content.problem->Text(file));
  const OrderedJson json = ParseJson(content.text, file.string(), kCalibrationFile.name);
  const auto is_rows = [&json](const char* name) {
    return json.contains(name) && json[name].is_array();
  };
  if (!json.is_object() || !is_rows("encoder") || !is_rows("strain")) {
    Fail(file, "expected a calibration: a JSON object with the lists 'encoder' and 'strain'");
  }
  CheckSensors(file, json, ToJson(sensors, {}));
  Calibration calibration{};
  const auto where = [&file](const char* list, std::size_t row) {
    return Shown(file.string(), kMessageBytes) + ": " + list + "[" + std::to_string(row) + "]";
  };
  for (std::size_t i = 0; i < sensors.encoder.size(); ++i) {
    const auto counter = static_cast<std::size_t>(sensors.encoder[i].counter);
    calibration.counter_zero[counter] =
        JsonWhole(json["encoder"][i], "zero_counts", where("encoder", i));
  }
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    const OrderedJson& row = json["strain"][i];
    calibration.strain_zero_counts[i] =
        static_cast<float>(JsonNumber(row, "zero_counts", where("strain", i)));
    calibration.strain_gain_error[i] =
        static_cast<float>(JsonNumber(row, "gain_error", where("strain", i)));
  }
  const std::string beyond = OutOfRange(sensors, calibration);
  if (!beyond.empty()) Fail(file, beyond);
  return calibration;
}

}  // namespace flexarm
