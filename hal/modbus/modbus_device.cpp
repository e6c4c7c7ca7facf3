#include "hal/modbus/modbus_device.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <utility>

#include "hal/modbus/modbus_value.h"

namespace flexarm {
namespace {

constexpr std::int64_t kFirstPauseNs = 50'000'000;
constexpr std::int64_t kLongestPauseNs = 1'600'000'000;
constexpr int kOpenAttempts = 5;  // a device may still be starting, or this machine be busy

std::string Hexadecimal(int word) {
  std::string text = "0x0000";
  for (std::size_t i = 5; i >= 2; --i, word >>= 4) text[i] = "0123456789abcdef"[word & 0xF];
  return text;
}

std::uint32_t Bit(int index) noexcept { return std::uint32_t{1} << static_cast<unsigned>(index); }

}  // namespace

ModbusDevice::ModbusDevice(ModbusDeviceConfig config, ModbusClock clock)
    : config_(std::move(config)),
      plan_(PlanModbus(config_)),
      clock_(clock),
      link_(config_, clock),
      pause_ns_(kFirstPauseNs) {
  for (const ModbusRegister& row : config_.map) {
    (row.role == ModbusRole::kStrain ? strain_channels_ : lines_) |= Bit(row.index);
  }
}

std::int64_t ModbusDevice::worst_case_ns() const noexcept {
  return std::max(plan_.exchange_worst_ns, plan_.reconnect_worst_ns);
}

std::string ModbusDevice::Place() const {
  const std::string where = config_.transport == ModbusTransport::kTcp
                                ? config_.host + ":" + std::to_string(config_.port)
                                : config_.device;
  return "modbus '" + config_.name + "' (" + where + ", unit " + std::to_string(config_.unit) +
         "): ";
}

std::string ModbusDevice::Refusal(const ModbusRequest& request, BusStatus status) const {
  const std::string range = std::string(ToString(request.table)) + "s " +
                            std::to_string(request.address) + " .. " +
                            std::to_string(request.address + request.count - 1);
  const ModbusCounters& met = counters();
  const bool refused = status == BusStatus::kMalformed && met.last_exception != 0;
  return Place() + range + " cannot be read: found " +
         (refused ? "exception " + std::to_string(met.last_exception) : ToString(status)) +
         ", expected " + std::to_string(request.count) + " values";
}

std::span<const char* const> ModbusDevice::counter_names() const noexcept {
  static constexpr std::array kNames = {"timeouts",      "mismatches",    "exceptions",
                                        "late_bytes",    "held_requests", "lost_links",
                                        "refused_values"};
  static_assert(kNames.size() <= kMostBusCounters);
  return kNames;
}

BusCounters ModbusDevice::counter_values() const noexcept {
  const ModbusCounters& link = counters();
  const auto low = [](std::uint64_t count) { return static_cast<std::uint32_t>(count); };
  return {low(link.timeouts),      low(link.mismatches), low(link.exceptions), low(link.late_bytes),
          low(link.stale_dropped), low(link.lost_links), low(values_refused_)};
}

BusFault ModbusDevice::FaultOf(BusStatus status) const noexcept {
  const bool refused = status == BusStatus::kMalformed;
  return {.kind = static_cast<std::uint8_t>(status),
          .node = static_cast<std::uint8_t>(config_.unit),
          .code = static_cast<std::uint16_t>(refused ? counters().last_exception : 0)};
}

std::string ModbusDevice::FaultText(const BusFault& fault) const {
  if (fault.code != 0) return Place() + "answers with exception " + std::to_string(fault.code);
  return Place() + ToString(static_cast<BusStatus>(fault.kind));
}

void ModbusDevice::Open() {
  Wrong wrong{};
  BusStatus status = BusStatus::kDisconnected;
  SensorFrame fresh{};
  for (int attempt = 0; attempt < kOpenAttempts && status != BusStatus::kOk; ++attempt) {
    status = ConnectAndProve(&wrong);
    if (wrong.identity != nullptr) {
      const ModbusIdentity& id = *wrong.identity;
      throw HalError(Place() + ToString(id.table) + " " + std::to_string(id.address) + " is " +
                     Hexadecimal(wrong.found) + ", expected " + Hexadecimal(id.expected) +
                     ": another device, or different settings");
    }
    if (status == BusStatus::kOk) status = ReadAll(&fresh);
  }
  if (status == BusStatus::kOk) return;
  link_.Close();
  if (failed_ == nullptr) {
    const ModbusLink::Failure& failure = link_.failure();
    throw HalError(Place() + failure.what +
                   (failure.error != 0 ? std::string(": ") + std::strerror(failure.error) : ""));
  }
  throw HalError(Refusal(*failed_, status));
}

BusStatus ModbusDevice::ConnectAndProve(Wrong* wrong) noexcept {
  prove_first_ = false;
  failed_ = nullptr;
  if (const BusStatus status = link_.Connect(); status != BusStatus::kOk) return status;
  for (const ModbusRequest& proof : plan_.proofs) {
    if (const BusStatus status = Prove(proof, wrong); status != BusStatus::kOk) return status;
  }
  return BusStatus::kOk;
}

BusStatus ModbusDevice::Prove(const ModbusRequest& request, Wrong* wrong) noexcept {
  ModbusReply reply;
  failed_ = &request;
  const BusStatus status = link_.Ask(request, &reply);
  if (status != BusStatus::kOk) return status;
  for (const int row : request.rows) {
    const ModbusIdentity& id = config_.identification[static_cast<std::size_t>(row)];
    const int found = reply.Word(id.address - request.address);
    if (found == id.expected) continue;
    *wrong = {.identity = &id, .found = found};
    link_.Close();  // not the expected device
    return BusStatus::kMalformed;
  }
  return BusStatus::kOk;
}

BusStatus ModbusDevice::ReadAll(SensorFrame* fresh) noexcept {
  if (prove_first_) {
    Wrong wrong{};
    if (const BusStatus s = Prove(plan_.proofs.front(), &wrong); s != BusStatus::kOk) return s;
    prove_first_ = false;
  }
  bool first = true;
  for (const ModbusRequest& request : plan_.reads) {
    ModbusReply reply;
    failed_ = &request;
    if (const BusStatus s = link_.Ask(request, &reply); s != BusStatus::kOk) return s;
    if (first) fresh->sampled_at_ns = reply.middle_ns;
    first = false;
    Take(request, reply, fresh);
  }
  return BusStatus::kOk;
}

void ModbusDevice::Take(const ModbusRequest& request, const ModbusReply& reply,
                        SensorFrame* fresh) noexcept {
  const auto offset_ns = static_cast<std::int32_t>(reply.middle_ns - fresh->sampled_at_ns);
  for (const int i : request.rows) {
    const ModbusRegister& row = config_.map[static_cast<std::size_t>(i)];
    const int at = row.address - request.address;
    if (row.role == ModbusRole::kInput) {
      if (reply.Bit(at)) fresh->levels |= Bit(row.index);
      continue;
    }
    std::array<std::uint16_t, 2> words = {reply.Word(at), 0};
    if (WidthOf(row.type) == 2) words[1] = reply.Word(at + 1);
    const std::optional<std::int32_t> counts = CountsFromWords(row, words.data());
    if (!counts) {
      ++values_refused_;
      continue;
    }
    const auto channel = static_cast<std::size_t>(row.index);
    fresh->strain[channel] = *counts;
    fresh->strain_offset_ns[channel] = offset_ns;
    fresh->strain_valid |= Bit(row.index);
  }
}

BusStatus ModbusDevice::Exchange(const BusCommand&, SensorFrame* part) noexcept {
  SensorFrame fresh = last_;
  fresh.strain_valid = 0;
  fresh.levels = 0;
  const BusStatus status = ReadAll(&fresh);
  if (status == BusStatus::kOk) {
    link_.ClearMismatches();
    KeepAges(&fresh);
    last_ = fresh;
    *part = fresh;
    return status;
  }
  prove_first_ = config_.transport == ModbusTransport::kRtu;
  *part = last_;
  part->strain_valid = 0;
  part->levels = 0;
  return status;
}

// A repeated value keeps its age.
void ModbusDevice::KeepAges(SensorFrame* fresh) const noexcept {
  for (std::size_t i = 0; i < fresh->strain.size(); ++i) {
    if ((fresh->strain_valid & Bit(static_cast<int>(i))) != 0) continue;
    const std::int64_t taken_ns = last_.sampled_at_ns + last_.strain_offset_ns[i];
    fresh->strain_offset_ns[i] = static_cast<std::int32_t>(
        std::max(taken_ns - fresh->sampled_at_ns, std::int64_t{INT32_MIN}));
  }
}

BusStatus ModbusDevice::Reconnect() noexcept {
  link_.Close();
  if (clock_() < next_attempt_ns_) return BusStatus::kDisconnected;
  Wrong wrong{};
  const BusStatus status = ConnectAndProve(&wrong);
  if (status == BusStatus::kOk) {
    pause_ns_ = kFirstPauseNs;
    next_attempt_ns_ = INT64_MIN;
    return status;
  }
  link_.Close();
  next_attempt_ns_ = clock_() + pause_ns_;
  pause_ns_ = std::min(2 * pause_ns_, kLongestPauseNs);
  return status;
}

}  // namespace flexarm
