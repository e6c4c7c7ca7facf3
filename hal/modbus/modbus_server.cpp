#include "hal/modbus/modbus_server.h"

#include <fcntl.h>
#include <modbus.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "hal/bus_device.h"

namespace flexarm {
namespace {

constexpr std::size_t kMostClients = 8;
constexpr std::uint32_t kHalfRequestUs = 20'000;
// How long libmodbus sleeps before it throws the rest of a refused request away.
constexpr std::uint32_t kFlushDelayUs = 1'000;

}  // namespace

// libmodbus's side: the context, and the tables as it serves them.
struct ModbusServer::Context {
  Context(const ModbusDeviceConfig& config, const RegisterImage& image)
      : modbus(
            config.transport == ModbusTransport::kTcp
                ? modbus_new_tcp(config.host.c_str(), config.port)
                // Only frames: the pseudo-terminal is opened here, so name and rate are not used.
                : modbus_new_rtu("/dev/ptmx", 115200, 'N', 8, 1)) {
    const auto extent = [&image](ModbusTable table) { return image.extent(table); };
    const auto start = [&](ModbusTable table) {
      return static_cast<unsigned>(extent(table).start);
    };
    const auto count = [&](ModbusTable table) {
      return static_cast<unsigned>(extent(table).count);
    };
    using enum ModbusTable;
    mapping = modbus_mapping_new_start_address(start(kCoil), count(kCoil), start(kDiscreteInput),
                                               count(kDiscreteInput), start(kHoldingRegister),
                                               count(kHoldingRegister), start(kInputRegister),
                                               count(kInputRegister));
    if (modbus == nullptr || mapping == nullptr) throw HalError("modbus server: out of memory");
    modbus_set_slave(modbus, config.unit);
    modbus_set_indication_timeout(modbus, 0, kHalfRequestUs);
    modbus_set_byte_timeout(modbus, 0, 0);
    modbus_set_response_timeout(modbus, 0, kFlushDelayUs);
  }
  ~Context() {
    if (mapping != nullptr) modbus_mapping_free(mapping);
    if (modbus != nullptr) modbus_free(modbus);
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  modbus_t* modbus;
  modbus_mapping_t* mapping = nullptr;
};

ModbusServer::ModbusServer(ModbusDeviceConfig config, const RegisterImage& image)
    : config_(std::move(config)),
      image_(image),
      context_(std::make_unique<Context>(config_, image)) {
  stop_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (config_.transport == ModbusTransport::kTcp) {
    Listen();
  } else {
    OpenPseudoTerminal();
  }
}

ModbusServer::~ModbusServer() {
  for (const int fd : clients_) close(fd);
  for (const int fd : {held_, terminal_, listener_, stop_}) {
    if (fd >= 0) close(fd);
  }
  if (terminal_ >= 0 && !config_.device.empty()) unlink(config_.device.c_str());
}

void ModbusServer::Listen() {
  listener_ = modbus_tcp_listen(context_->modbus, static_cast<int>(kMostClients));
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  if (listener_ < 0 || getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw HalError("modbus server '" + config_.name + "': cannot listen on " + config_.host + ":" +
                   std::to_string(config_.port) + ": " + std::strerror(errno));
  }
  port_ = ntohs(address.sin_port);
  fcntl(listener_, F_SETFL, O_NONBLOCK);
  fcntl(listener_, F_SETFD, FD_CLOEXEC);
}

void ModbusServer::OpenPseudoTerminal() {
  const auto fail = [this](const std::string& what) {
    throw HalError("modbus server '" + config_.name + "': " + what + ": " + std::strerror(errno));
  };
  terminal_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  std::array<char, 64> name{};
  if (terminal_ < 0 || grantpt(terminal_) != 0 || unlockpt(terminal_) != 0 ||
      ptsname_r(terminal_, name.data(), name.size()) != 0) {
    fail("no pseudo-terminal");
  }
  path_ = name.data();
  held_ = open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (held_ < 0 || tcgetattr(held_, &settings) != 0) fail(path_);
  cfmakeraw(&settings);  // or our replies would come back as an echo
  tcsetattr(held_, TCSANOW, &settings);
  if (config_.device.empty()) return;
  struct stat there {};
  if (lstat(config_.device.c_str(), &there) == 0 && S_ISLNK(there.st_mode)) {
    unlink(config_.device.c_str());  // of a server that died
  }
  if (symlink(path_.c_str(), config_.device.c_str()) != 0) fail(config_.device);
}

void ModbusServer::Stop() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(stop_, &one, sizeof(one));  // wakes poll for good
}

void ModbusServer::Run() {
  std::vector<pollfd> ready;
  for (;;) {
    ready.assign({{.fd = stop_, .events = POLLIN, .revents = 0},
                  {.fd = listener_, .events = POLLIN, .revents = 0},
                  {.fd = terminal_, .events = POLLIN, .revents = 0}});  // negative: left out
    for (const int fd : clients_) ready.push_back({.fd = fd, .events = POLLIN, .revents = 0});
    if (poll(ready.data(), ready.size(), -1) < 0) continue;  // a signal
    if (ready[0].revents != 0) return;
    for (std::size_t i = 3; i < ready.size(); ++i) {
      if (ready[i].revents == 0 || Serve(ready[i].fd)) continue;
      close(ready[i].fd);
      std::erase(clients_, ready[i].fd);
    }
    if (ready[1].revents != 0) Accept();
    if (ready[2].revents != 0 && !Serve(terminal_)) modbus_flush(context_->modbus);
  }
}

void ModbusServer::Accept() {
  const int fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (fd < 0) return;
  if (clients_.size() < kMostClients) {
    clients_.push_back(fd);
  } else {
    close(fd);
  }
}

bool ModbusServer::Serve(int fd) {
  modbus_t* modbus = context_->modbus;
  modbus_set_socket(modbus, fd);
  std::array<std::uint8_t, MODBUS_MAX_ADU_LENGTH> request;
  const int length = modbus_receive(modbus, request.data());
  if (length < 0) return false;
  if (length == 0) return true;  // serial: another unit's
  requests_.fetch_add(1, std::memory_order_relaxed);
  if (silent_.load(std::memory_order_relaxed)) return true;
  return Reply(request.data(), length) >= 0;
}

int ModbusServer::Reply(const std::uint8_t* request, int length) {
  modbus_t* modbus = context_->modbus;
  modbus_mapping_t* mapping = context_->mapping;
  const int header = modbus_get_header_length(modbus);
  if (request[header - 1] != config_.unit) {
    return modbus_reply_exception(modbus, request, MODBUS_EXCEPTION_GATEWAY_TARGET);
  }
  const std::uint8_t function = request[header];
  if (function < MODBUS_FC_READ_COILS || function > MODBUS_FC_READ_INPUT_REGISTERS) {
    return modbus_reply_exception(modbus, request, MODBUS_EXCEPTION_ILLEGAL_FUNCTION);
  }
  const auto table = static_cast<ModbusTable>(function);
  cells_.resize(static_cast<std::size_t>(image_.extent(table).count));
  image_.Copy(table, cells_.data());
  if (HoldsBits(table)) {
    std::transform(cells_.begin(), cells_.end(),
                   table == ModbusTable::kCoil ? mapping->tab_bits : mapping->tab_input_bits,
                   [](std::uint16_t cell) { return static_cast<std::uint8_t>(cell != 0); });
  } else {
    std::copy(cells_.begin(), cells_.end(),
              table == ModbusTable::kHoldingRegister ? mapping->tab_registers
                                                     : mapping->tab_input_registers);
  }
  return modbus_reply(modbus, request, length, mapping);
}

}  // namespace flexarm
