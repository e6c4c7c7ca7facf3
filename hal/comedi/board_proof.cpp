#include "hal/comedi/board_proof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "hal/comedi/daq_codec.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

// Periods that the buffer must hold when the reader is delayed, for example by a slow disk.
constexpr double kPeriodsToHold = 5.0;

const char* ToString(DaqKind kind) {
  constexpr std::array kNames = {"analogue input", "analogue output", "digital lines",
                                 "counter",        "something else",  "nothing"};
  return kNames[static_cast<std::size_t>(kind)];
}

class Proof {
 public:
  Proof(const ComediBoardConfig& config, DaqBoard* board) : config_(config), board_(board) {}

  ComediChannels Run(const DaqIdentity& identity) {
    Same("driver", identity.driver, config_.driver);
    Same("board", identity.board, config_.board);
    ComediChannels channels;
    if (config_.output) ProveOutput(*config_.output, &channels);  // first: the arm must be off
    if (config_.input) ProveInput(*config_.input, &channels);
    for (const ComediCounterConfig& row : config_.counter) ProveCounter(row, &channels);
    for (const ComediLineConfig& row : config_.line) ProveLine(row, &channels);
    return channels;
  }

 private:
  [[noreturn]] void Refuse(const std::string& what, const std::string& found,
                           const std::string& expected) const {
    throw HalError("comedi " + config_.device + ": " + what + " is " + found + ", expected " +
                   expected);
  }
  void Same(const std::string& what, const std::string& found, const std::string& expected) const {
    if (found != expected) Refuse(what, "'" + found + "'", "'" + expected + "'");
  }
  void Same(const std::string& what, int found, int expected) const {
    if (found != expected) Refuse(what, NumberText(found), NumberText(expected));
  }

  static std::string Place(int subdevice) { return "subdevice " + std::to_string(subdevice); }

  DaqSubdevice ProveSubdevice(int subdevice, DaqKind kind) const {
    const DaqSubdevice found = board_->Describe(subdevice);
    if (found.kind != kind) Refuse(Place(subdevice), ToString(found.kind), ToString(kind));
    return found;
  }

  void Take(int subdevice) {
    if (!taken_.insert(subdevice).second || board_->Lock(subdevice)) return;
    Refuse(Place(subdevice), "held by another program", "free");
  }

  int RangeOf(int subdevice, int channel, double range_v) const {
    const std::vector<DaqRange> ranges = board_->Ranges(subdevice, channel);
    std::string found;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      // 1e-6 V: comedi's kernel interface rounds ranges to that.
      if (std::abs(ranges[i].lowest_v + range_v) <= 1e-6 &&
          std::abs(ranges[i].highest_v - range_v) <= 1e-6) {
        return static_cast<int>(i);
      }
      found += (found.empty() ? "" : ", ") + NumberText(ranges[i].lowest_v) + " .. " +
               NumberText(ranges[i].highest_v) + " V";
    }
    Refuse("range of " + Place(subdevice) + " channel " + std::to_string(channel), found,
           NumberText(-range_v) + " .. " + NumberText(range_v) + " V");
  }

  void ProveOutput(const ComediOutputConfig& out, ComediChannels* channels) {
    const DaqSubdevice found = ProveSubdevice(out.subdevice, DaqKind::kAnalogOutput);
    Same("number of outputs", found.channels, out.channels);
    Same("bits of the outputs", found.bits, out.bits);
    Take(out.subdevice);
    for (const ComediDriveConfig& drive : out.drive) {
      const DaqChannel channel{.subdevice = out.subdevice,
                               .channel = drive.channel,
                               .range = RangeOf(out.subdevice, drive.channel, out.range_v),
                               .reference = DaqReference::kGround};
      std::uint32_t code = 0;
      const bool done = board_->Write(channel, ZeroCode(out.bits)) == DaqResult::kOk &&
                        board_->Read(channel, &code) == DaqResult::kOk;
      const std::string what = "output " + std::to_string(drive.channel) + " after writing 0 V";
      if (!done) Refuse(what, "cannot be read back", "code " + std::to_string(ZeroCode(out.bits)));
      Same(what, static_cast<int>(code), static_cast<int>(ZeroCode(out.bits)));
      channels->drive.push_back(channel);
    }
  }

  void ProveInput(const ComediInputConfig& in, ComediChannels* channels) {
    const DaqSubdevice found = ProveSubdevice(in.subdevice, DaqKind::kAnalogInput);
    Same("number of inputs", found.channels, in.channels);
    Same("bits of the inputs", found.bits, in.bits);
    Take(in.subdevice);
    for (const ComediStrainConfig& row : in.channel) {
      channels->strain.push_back({.subdevice = in.subdevice,
                                  .channel = row.channel,
                                  .range = RangeOf(in.subdevice, row.channel, in.range_v),
                                  .reference = static_cast<DaqReference>(in.reference)});
    }
    if (in.acquisition == ComediAcquisition::kStream) ProveStream(in, found, channels->strain);
  }

  void ProveStream(const ComediInputConfig& in, const DaqSubdevice& found,
                   const std::vector<DaqChannel>& channels) {
    if (!found.streams) {
      Refuse("acquisition", "possible by single reads only",
             "streaming: set acquisition = \"single\", and check the time that it takes");
    }
    const DaqScan made = board_->SetScan({.channel = channels,
                                          .scan_interval_ns = in.scan_interval_ns(),
                                          .convert_interval_ns = in.convert_interval_ns()});
    SameTime("scan_interval_us", made.scan_interval_ns, in.scan_interval_ns());
    SameTime("convert_interval_us", made.convert_interval_ns, in.convert_interval_ns());
    const double held = static_cast<double>(found.buffer_samples) /
                        static_cast<double>(channels.size()) *
                        static_cast<double>(in.scan_interval_ns()) / (config_.period_ms * 1e6);
    if (held >= kPeriodsToHold) return;
    Refuse("size of the input buffer", NumberText(held) + " periods",
           NumberText(kPeriodsToHold) + " or more: comedi_config --read-buffer makes it larger");
  }

  void SameTime(const std::string& what, std::int64_t made_ns, std::int64_t wanted_ns) const {
    if (made_ns == wanted_ns) return;
    Refuse(what, NumberText(static_cast<double>(made_ns) / 1e3) + " with the board's clock",
           NumberText(static_cast<double>(wanted_ns) / 1e3));
  }

  void ProveCounter(const ComediCounterConfig& row, ComediChannels* channels) {
    const DaqSubdevice found = ProveSubdevice(row.subdevice, DaqKind::kCounter);
    const std::string what = "counter " + ChannelName(row) + " of " + Place(row.subdevice);
    if (row.channel >= found.channels) {
      Refuse(what, "channel " + std::to_string(row.channel),
             "below " + std::to_string(found.channels));
    }
    Same("bits of " + what, found.bits, row.bits);
    Take(row.subdevice);
    channels->counter.push_back({.subdevice = row.subdevice,
                                 .channel = row.channel,
                                 .range = 0,
                                 .reference = DaqReference::kGround});
  }

  void ProveLine(const ComediLineConfig& row, ComediChannels* channels) {
    ProveSubdevice(row.subdevice, DaqKind::kDigital);
    Take(row.subdevice);
    if (!board_->SetInput(row.subdevice, row.channel)) {
      Refuse("line " + ChannelName(row), "no input",
             "an input: channel " + std::to_string(row.channel) + " of " + Place(row.subdevice));
    }
    std::vector<int>& all = channels->line_subdevice;
    if (std::find(all.begin(), all.end(), row.subdevice) == all.end()) {
      all.push_back(row.subdevice);
    }
  }

  const ComediBoardConfig& config_;
  DaqBoard* board_;
  std::set<int> taken_;
};

}  // namespace

ComediChannels ProveComediBoard(const ComediBoardConfig& config, const DaqIdentity& identity,
                                DaqBoard* board) {
  return Proof(config, board).Run(identity);
}

}  // namespace flexarm
