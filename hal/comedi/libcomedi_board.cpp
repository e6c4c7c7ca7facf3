#include "hal/comedi/libcomedi_board.h"

#include <comedilib.h>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <utility>

namespace flexarm {
namespace {

unsigned Unsigned(int number) noexcept { return static_cast<unsigned>(number); }

DaqKind KindOf(int type) noexcept {
  switch (type) {
    case -1:
    case COMEDI_SUBD_UNUSED:
      return DaqKind::kNone;
    case COMEDI_SUBD_AI:
      return DaqKind::kAnalogInput;
    case COMEDI_SUBD_AO:
      return DaqKind::kAnalogOutput;
    case COMEDI_SUBD_DI:
    case COMEDI_SUBD_DO:
    case COMEDI_SUBD_DIO:
      return DaqKind::kDigital;
    case COMEDI_SUBD_COUNTER:
      return DaqKind::kCounter;
    default:
      return DaqKind::kOther;
  }
}

DaqResult RefusedWith(int error) noexcept {
  return error == ENODEV || error == ENXIO ? DaqResult::kGone : DaqResult::kFailed;
}

// Result of a libcomedi function; below 0 an error of libcomedi or of the system.
DaqResult ResultOf(int returned) noexcept {
  return returned >= 0 ? DaqResult::kOk : RefusedWith(comedi_errno());
}

}  // namespace

struct LibcomediBoard::Handle {
  static constexpr std::size_t kChunkBytes = 16384;

  explicit Handle(const std::string& device) : board(comedi_open(device.c_str())) {
    if (board == nullptr) {
      throw HalError("comedi " + device + ": cannot be opened: " + comedi_strerror(comedi_errno()));
    }
    const int descriptor = comedi_fileno(board);
    if (fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) | O_NONBLOCK) != 0) {
      const int error = errno;
      comedi_close(board);
      throw HalError("comedi " + device +
                     ": its file descriptor cannot be made non-blocking: " + std::strerror(error));
    }
  }
  ~Handle() { comedi_close(board); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  comedi_t* board;
  comedi_cmd command{};
  std::vector<unsigned> channels;  // storage of the command's channel list
  bool wide = false;               // samples of 32 bits
  std::array<std::byte, kChunkBytes> bytes{};
};

LibcomediBoard::LibcomediBoard(std::string device, Clock clock)
    : device_(std::move(device)), clock_(clock) {}

LibcomediBoard::~LibcomediBoard() = default;

DaqIdentity LibcomediBoard::Open() {
  handle_ = std::make_unique<Handle>(device_);
  const char* driver = comedi_get_driver_name(handle_->board);
  const char* board = comedi_get_board_name(handle_->board);
  return {.driver = driver != nullptr ? driver : "", .board = board != nullptr ? board : ""};
}

DaqSubdevice LibcomediBoard::Describe(int subdevice) {
  comedi_t* board = handle_->board;
  const unsigned number = Unsigned(subdevice);
  DaqSubdevice found{.kind = KindOf(comedi_get_subdevice_type(board, number)),
                     .channels = 0,
                     .bits = 0,
                     .streams = false,
                     .buffer_samples = 0};
  if (found.kind == DaqKind::kNone) return found;
  found.channels = comedi_get_n_channels(board, number);
  const std::uint64_t values = std::uint64_t{comedi_get_maxdata(board, number, 0)} + 1;
  if (std::has_single_bit(values)) found.bits = std::countr_zero(values);
  const int flags = comedi_get_subdevice_flags(board, number);
  found.streams = flags >= 0 && (flags & SDF_CMD_READ) != 0;
  const int buffer_bytes = found.streams ? comedi_get_buffer_size(board, number) : 0;
  const bool wide = (Unsigned(flags) & SDF_LSAMPL) != 0;
  if (buffer_bytes > 0) {
    found.buffer_samples = Unsigned(buffer_bytes) / (wide ? sizeof(lsampl_t) : sizeof(sampl_t));
  }
  return found;
}

std::vector<DaqRange> LibcomediBoard::Ranges(int subdevice, int channel) {
  std::vector<DaqRange> ranges;
  const unsigned number = Unsigned(subdevice), at = Unsigned(channel);
  const int count = comedi_get_n_ranges(handle_->board, number, at);
  for (int i = 0; i < count; ++i) {
    const comedi_range* range = comedi_get_range(handle_->board, number, at, Unsigned(i));
    const bool volts = range != nullptr && range->unit == UNIT_volt;
    ranges.push_back(volts ? DaqRange{.lowest_v = range->min, .highest_v = range->max}
                           : DaqRange{.lowest_v = 0.0, .highest_v = 0.0});
  }
  return ranges;
}

bool LibcomediBoard::Lock(int subdevice) {
  return comedi_lock(handle_->board, Unsigned(subdevice)) == 0;
}

bool LibcomediBoard::SetInput(int subdevice, int channel) {
  const unsigned number = Unsigned(subdevice), at = Unsigned(channel);
  const int type = comedi_get_subdevice_type(handle_->board, number);
  if (channel >= comedi_get_n_channels(handle_->board, number)) return false;
  if (type == COMEDI_SUBD_DI) return true;
  if (type != COMEDI_SUBD_DIO) return false;
  unsigned direction = COMEDI_OUTPUT;
  return comedi_dio_config(handle_->board, number, at, COMEDI_INPUT) == 0 &&
         comedi_dio_get_config(handle_->board, number, at, &direction) == 0 &&
         direction == COMEDI_INPUT;
}

DaqScan LibcomediBoard::SetScan(const DaqScan& scan) {
  Handle& h = *handle_;
  const unsigned subdevice = Unsigned(scan.channel.front().subdevice);
  const auto count = static_cast<unsigned>(scan.channel.size());
  h.channels.clear();
  for (const DaqChannel& c : scan.channel) {
    h.channels.push_back(
        CR_PACK(Unsigned(c.channel), Unsigned(c.range), Unsigned(static_cast<int>(c.reference))));
  }
  const auto refuse = [this](const std::string& what) {
    throw HalError("comedi " + device_ + ": " + what + ": " + comedi_strerror(comedi_errno()));
  };
  comedi_cmd can{};
  if (comedi_get_cmd_src_mask(h.board, subdevice, &can) < 0) refuse("cannot stream");
  if (comedi_set_read_subdevice(h.board, subdevice) < 0) refuse("its inputs cannot be streamed");
  const bool at_once = scan.convert_interval_ns == 0;
  const bool follow = (can.scan_begin_src & TRIG_TIMER) == 0;  // scans back to back
  h.command = comedi_cmd{};
  h.command.subdev = subdevice;
  h.command.flags = CMDF_WAKE_EOS;  // deliver every scan, not every full buffer
  h.command.start_src = TRIG_NOW;
  h.command.scan_begin_src = follow ? TRIG_FOLLOW : TRIG_TIMER;
  h.command.scan_begin_arg = follow ? 0 : static_cast<unsigned>(scan.scan_interval_ns);
  h.command.convert_src = at_once ? TRIG_NOW : TRIG_TIMER;
  h.command.convert_arg = static_cast<unsigned>(scan.convert_interval_ns);
  h.command.scan_end_src = TRIG_COUNT;
  h.command.scan_end_arg = count;
  h.command.stop_src = TRIG_NONE;
  h.command.chanlist = h.channels.data();
  h.command.chanlist_len = count;
  // Each test corrects the values that the previous one rejected: comedi needs two or three.
  int wrong = comedi_command_test(h.board, &h.command);
  for (int i = 0; i < 3 && wrong > 0; ++i) wrong = comedi_command_test(h.board, &h.command);
  if (wrong != 0) refuse("the board cannot make this scan, test " + std::to_string(wrong));
  h.wide = (Unsigned(comedi_get_subdevice_flags(h.board, subdevice)) & SDF_LSAMPL) != 0;
  DaqScan made = scan;
  made.convert_interval_ns = at_once ? 0 : h.command.convert_arg;
  made.scan_interval_ns = follow ? made.convert_interval_ns * count : h.command.scan_begin_arg;
  return made;
}

DaqResult LibcomediBoard::StartScan() noexcept {
  comedi_cmd command = handle_->command;  // the call may write to it
  return ResultOf(comedi_command(handle_->board, &command));
}

void LibcomediBoard::StopScan() noexcept {
  if (handle_->channels.empty()) return;
  comedi_cancel(handle_->board, handle_->command.subdev);
}

DaqResult LibcomediBoard::ReadScan(std::span<std::uint32_t> samples, std::size_t* count) noexcept {
  Handle& h = *handle_;
  *count = 0;
  const std::size_t width = h.wide ? sizeof(lsampl_t) : sizeof(sampl_t);
  const std::size_t wanted = std::min(samples.size() * width, h.bytes.size());
  const ssize_t got = read(comedi_fileno(h.board), h.bytes.data(), wanted);
  if (got < 0) {
    if (errno == EAGAIN || errno == EINTR) return DaqResult::kNothing;
    return errno == EPIPE ? DaqResult::kOverrun : RefusedWith(errno);
  }
  if (got == 0) return DaqResult::kStopped;
  *count = static_cast<std::size_t>(got) / width;
  for (std::size_t i = 0; i < *count; ++i) {
    sampl_t narrow = 0;
    if (h.wide) {
      std::memcpy(&samples[i], &h.bytes[i * width], width);
    } else {
      std::memcpy(&narrow, &h.bytes[i * width], width);
      samples[i] = narrow;
    }
  }
  return DaqResult::kOk;
}

void LibcomediBoard::WaitUntil(std::int64_t instant_ns) noexcept {
  const std::int64_t left_ns = std::max<std::int64_t>(instant_ns - clock_(), 0);
  const timespec left{.tv_sec = left_ns / 1'000'000'000, .tv_nsec = left_ns % 1'000'000'000};
  pollfd wait{.fd = comedi_fileno(handle_->board), .events = POLLIN, .revents = 0};
  ppoll(&wait, 1, &left, nullptr);
}

DaqResult LibcomediBoard::Read(const DaqChannel& channel, std::uint32_t* value) noexcept {
  lsampl_t data = 0;
  const int returned = comedi_data_read(handle_->board, Unsigned(channel.subdevice),
                                        Unsigned(channel.channel), Unsigned(channel.range),
                                        Unsigned(static_cast<int>(channel.reference)), &data);
  *value = data;
  return ResultOf(returned);
}

DaqResult LibcomediBoard::Write(const DaqChannel& channel, std::uint32_t value) noexcept {
  return ResultOf(comedi_data_write(handle_->board, Unsigned(channel.subdevice),
                                    Unsigned(channel.channel), Unsigned(channel.range),
                                    Unsigned(static_cast<int>(channel.reference)), value));
}

DaqResult LibcomediBoard::ReadBits(int subdevice, std::uint32_t* bits) noexcept {
  unsigned levels = 0;
  const int returned = comedi_dio_bitfield2(handle_->board, Unsigned(subdevice), 0, &levels, 0);
  *bits = levels;
  return ResultOf(returned);
}

void LibcomediBoard::Close() noexcept { handle_.reset(); }

}  // namespace flexarm
