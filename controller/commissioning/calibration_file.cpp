#include "controller/commissioning/calibration_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "controller/runlog/csv.h"
#include "controller/runlog/errors.h"

namespace flexarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

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
template <typename Number>
void Take(const std::filesystem::path& file, const OrderedJson& row, const char* name,
          Number* value) {
  const auto found = row.find(name);
  if (found == row.end() || !found->is_number() || !std::isfinite(found->get<double>())) {
    Fail(file, "row " + row.dump() + ": expected a number in '" + name + "'");
  }
  *value = found->get<Number>();
}

void CheckSensors(const std::filesystem::path& file, OrderedJson found, OrderedJson expected) {
  for (OrderedJson* json : {&found, &expected}) {
    for (OrderedJson& row : (*json)["encoder"]) row.erase("zero_counts");
    for (OrderedJson& row : (*json)["strain"]) {
      row.erase("zero_counts");
      row.erase("gain_error");
    }
  }
  if (found == expected) return;
  Fail(file,
       "was made for other sensors than the config's [sensors]: remove it, then run `flexarm tare` "
       "and "
       "`flexarm zero`");
}

void WriteWhole(const std::filesystem::path& file, const std::string& text) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  bool ok = fd >= 0;
  ok = ok && ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  ok = ok && ::fsync(fd) == 0;
  const int error = errno;
  if (fd >= 0) ::close(fd);
  if (!ok) Fail(file, std::string("cannot be written: ") + std::strerror(error));
}

}  // namespace

void WriteCalibration(const std::filesystem::path& file, const SensorConfig& sensors,
                      const Calibration& calibration) {
  std::error_code ignored;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
  std::filesystem::path part = file;
  part += ".part";
  WriteWhole(part, ToJson(sensors, calibration).dump(1) + "\n");
  std::error_code error;
  std::filesystem::rename(part, file, error);
  if (error) Fail(file, "cannot be replaced: " + error.message());
}

std::optional<Calibration> ReadCalibration(const std::filesystem::path& file,
                                           const SensorConfig& sensors) {
  std::ifstream stream(file);
  if (!stream) {
    if (!std::filesystem::exists(file)) return std::nullopt;
    Fail(file, "cannot be read");
  }
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const OrderedJson json = OrderedJson::parse(text, nullptr, false);
  const auto is_rows = [&json](const char* name) {
    return json.contains(name) && json[name].is_array();
  };
  if (!json.is_object() || !is_rows("encoder") || !is_rows("strain")) {
    Fail(file, "expected a calibration: a JSON object with the lists 'encoder' and 'strain'");
  }
  CheckSensors(file, json, ToJson(sensors, {}));
  Calibration calibration{};
  for (std::size_t i = 0; i < sensors.encoder.size(); ++i) {
    const auto counter = static_cast<std::size_t>(sensors.encoder[i].counter);
    Take(file, json["encoder"][i], "zero_counts", &calibration.counter_zero[counter]);
  }
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    Take(file, json["strain"][i], "zero_counts", &calibration.strain_zero_counts[i]);
    Take(file, json["strain"][i], "gain_error", &calibration.strain_gain_error[i]);
  }
  return calibration;
}

}  // namespace flexarm
