#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hal/comedi/daq_board.h"

namespace flexarm {

/// A board of the kernel, through libcomedi. The only file that uses its interface.
///
/// Calls of libcomedi 0.11 in the loop (from its source; a test in the virtual machine checks
/// them): comedi_data_read, comedi_data_write and comedi_dio_bitfield2 are one ioctl each on stack
/// memory, comedi_command and comedi_cancel one ioctl; it allocates in comedi_open and in queries
/// of ranges and commands only. The kernel takes the board's mutex and a small buffer for each
/// ioctl. The stream is read with read(2) on a non-blocking descriptor. Real-time: as DaqBoard; the
/// duration of an instruction depends on the board.  Thread: one.
class LibcomediBoard final : public DaqBoard {
 public:
  /// CLOCK_MONOTONIC in ns; injected, as only executors read clocks.
  using Clock = std::int64_t (*)() noexcept;

  LibcomediBoard(std::string device, Clock clock);
  ~LibcomediBoard() override;
  LibcomediBoard(const LibcomediBoard&) = delete;
  LibcomediBoard& operator=(const LibcomediBoard&) = delete;

  const char* device() const noexcept override { return device_.c_str(); }
  std::int64_t now_ns() const noexcept override { return clock_(); }
  DaqIdentity Open() override;
  DaqSubdevice Describe(int subdevice) override;
  std::vector<DaqRange> Ranges(int subdevice, int channel) override;
  bool Lock(int subdevice) override;
  bool SetInput(int subdevice, int channel) override;
  DaqScan SetScan(const DaqScan& scan) override;
  [[nodiscard]] DaqResult StartScan() noexcept override;
  void StopScan() noexcept override;
  [[nodiscard]] DaqResult ReadScan(std::span<std::uint32_t> samples,
                                   std::size_t* count) noexcept override;
  void WaitUntil(std::int64_t instant_ns) noexcept override;
  [[nodiscard]] DaqResult Read(const DaqChannel& channel, std::uint32_t* value) noexcept override;
  [[nodiscard]] DaqResult Write(const DaqChannel& channel, std::uint32_t value) noexcept override;
  [[nodiscard]] DaqResult ReadBits(int subdevice, std::uint32_t* bits) noexcept override;
  void Close() noexcept override;

 private:
  struct Handle;  // libcomedi's handle, and the command

  std::string device_;
  Clock clock_;
  std::unique_ptr<Handle> handle_;
};

}  // namespace flexarm
