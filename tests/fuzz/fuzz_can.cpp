#include <cstdlib>
#include <string>

#include "hal/canopen/canopen_codec.h"
#include "hal/canopen/sdo.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/hal/canopen/canopen_bench.h"

namespace flexarm {
namespace {

// Functions of CiA 301 that nodes use, and an unused one.
constexpr std::array kFunctions = {
    kCobNmt,       kCobEmergency,       kCobTpdo, kCobSdoReply, kCobSdoRequest,
    kCobHeartbeat, std::uint32_t{0x280}};
constexpr std::array kNodes = {0, 1, 2, 3, 11, 12, 126, 127};

CanFrame FrameFrom(FuzzReader* from) {
  const std::uint8_t id = from->Byte(), length = from->Byte();
  CanFrame frame{};
  frame.id = CobId(kFunctions[id / kNodes.size() % kFunctions.size()], kNodes[id % kNodes.size()]);
  frame.length = length % 9;
  for (std::size_t i = 0; i < frame.length; ++i) frame.data[i] = from->Byte();
  return frame;
}

// What the input does to a frame of a good node.
MemoryWire::Fate Tamper(FuzzReader* from, CanFrame* frame) {
  MemoryWire::Fate fate;
  const std::uint8_t how = from->Byte();
  if (how < 0xA0) return fate;
  if (how < 0xB0) frame->data[how % 8U] = from->Byte();
  if (how >= 0xB0 && how < 0xC0) frame->length = how % 9U;
  if (how >= 0xC0 && how < 0xD0) fate.copies = how % 3;
  if (how >= 0xD0 && how < 0xE0) fate.delay_ns = (how % 16) * kMs;
  if (how >= 0xE0 && how < 0xF0) fate.waited_ns = (how % 16) * kMs;
  if (how >= 0xF0) frame->id = CobId(kCobTpdo, how % 16);
  return fate;
}

// Both drives and an encoder: of more nodes each input would take longer.
CanopenConfig ThreeNodes() {
  CanopenConfig config = BenchConfig();
  config.node.resize(3);
  return config;
}

void Say(const CanopenDevice& device, BusStatus status) {
  if (status != BusStatus::kOk) device.FaultText(device.FaultOf(status));
  if (device.notice().kind != 0) device.FaultText(device.notice());
  device.counter_values();
  device.voltage();
}

// One period: frames of a stranger, then an exchange or what follows a failure.
void Period(FuzzReader* from, MemoryBus* stranger, CanopenBench* bench) {
  const std::uint8_t plan = from->Byte();
  for (int i = plan % 8; i > 0; --i) {
    const CanFrame frame = FrameFrom(from);
    DecodeNmt(frame);
    DecodeDriveCommand(frame);
    if (stranger->Send(frame) != SendResult::kSent) break;
  }
  if ((plan & 0x08U) != 0 && bench->device->SwitchOff() != BusStatus::kOk) return;
  const bool acknowledge = (plan & 0x10U) != 0;
  const BusStatus status = (plan & 0x20U) != 0
                               ? bench->Recover()
                               : bench->Exchange({.torque_nm = {1.0, -1.0},
                                                  .enabled = !acknowledge && (plan & 0x40U) == 0,
                                                  .acknowledge = acknowledge});
  Say(*bench->device, status);
}

}  // namespace

// The first byte: the nodes' frames are changed from the beginning, or once the drives are on.
void FuzzCan(FuzzBytes input) {
  FuzzReader from(input);
  static const CanopenConfig config = ThreeNodes();
  CanopenBench bench(config, CanopenBench::Wired(config));
  MemoryBus stranger(&bench.wire);
  stranger.OpenForAll();
  const auto tamper = [&from](CanFrame* frame) { return Tamper(&from, frame); };
  if (from.Byte() % 4 == 0) {
    bench.wire.SetTamper(tamper);
    try {
      bench.device->Open();
    } catch (const HalError&) {
      return;
    }
  } else {
    if (!bench.Enable()) std::abort();
    bench.wire.SetTamper(tamper);
  }
  constexpr int kMostPeriods = 50;
  for (int i = 0; i < kMostPeriods && !from.empty(); ++i) Period(&from, &stranger, &bench);
  bench.device->Close();
}

}  // namespace flexarm
