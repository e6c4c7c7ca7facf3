#include "hal/wired/hardware_rig.h"

#include "hal/canopen/canopen_device.h"
#include "hal/canopen/socketcan_bus.h"
#include "hal/comedi/comedi_device.h"
#include "hal/comedi/libcomedi_board.h"
#include "hal/gpiod/gpiod_lines.h"
#include "hal/modbus/modbus_device.h"

namespace flexarm {
HardwareRig::HardwareRig(const HalConfig& config, const CanClocks& clocks) {
  if (!config.gpiod) throw HalError("no safety chain: section [hal.gpiod] is missing");
  lines_ = std::make_unique<GpiodLines>(*config.gpiod);
  for (const CanopenConfig& bus : config.canopen) {
    buses_.push_back(std::make_unique<CanopenDevice>(
        bus, std::make_unique<SocketCanBus>(bus.interface, clocks)));
  }
  for (const ModbusDeviceConfig& device : config.modbus.device) {
    buses_.push_back(std::make_unique<ModbusDevice>(device, clocks.monotonic_ns));
  }
  for (const ComediBoardConfig& board : config.comedi) {
    buses_.push_back(std::make_unique<ComediDevice>(
        board, std::make_unique<LibcomediBoard>(board.device, clocks.monotonic_ns)));
  }
  for (const auto& bus : buses_) bus->Open();
}

HardwareRig::~HardwareRig() {
  for (const auto& bus : buses_) bus->Close();
}

std::vector<BusDevice*> HardwareRig::buses() const {
  std::vector<BusDevice*> all;
  for (const auto& bus : buses_) all.push_back(bus.get());
  return all;
}

}  // namespace flexarm
