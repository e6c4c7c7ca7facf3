#include "controller/runlog/record_format.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>

#include "controller/runlog/blob.h"
#include "controller/runlog/checksum.h"
#include "controller/runlog/record_blocks.h"
#include "controller/runlog/safety_rows.h"

namespace flexarm {
namespace {

constexpr std::uint32_t KindOf(std::string_view name) {
  std::uint32_t kind = 0;
  for (std::size_t i = 4; i-- > 0;) kind = kind << 8 | static_cast<std::uint8_t>(name[i]);
  return kind;
}

// In the order of RunRecord.
constexpr std::array<std::uint32_t, std::variant_size_v<RunRecord>> kKinds = {
    KindOf("INFO"), KindOf("TICK"), KindOf("TIME"), KindOf("SAFE"), KindOf("EVNT"), KindOf("END.")};

// Numbers and texts, one after the other.
class PayloadWriter {
 public:
  explicit PayloadWriter(std::string* bytes) : bytes_(bytes) {}

  template <typename T>
  void Raw(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t at = bytes_->size();
    bytes_->resize(at + sizeof value);
    std::memcpy(bytes_->data() + at, &value, sizeof value);
  }
  void Text(const std::string& text) {
    Raw(static_cast<std::uint32_t>(text.size()));
    Bytes(text);
  }
  void Bytes(std::string_view bytes) { bytes_->append(bytes); }

 private:
  std::string* bytes_;
};

class PayloadReader {
 public:
  explicit PayloadReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename T>
  void Raw(T* value) {
    const std::string_view part = Take(sizeof *value);
    if (part.size() == sizeof *value) std::memcpy(value, part.data(), sizeof *value);
  }
  void Text(std::string* text) {
    std::uint32_t length = 0;
    Raw(&length);
    *text = Take(length);
  }
  std::string_view Rest() { return Take(bytes_.size()); }
  /// What was read is of no known layout.
  void Refuse() { refused_ = true; }
  /// All that was asked for was there, and nothing is left.
  bool done() const { return !refused_ && bytes_.empty(); }

 private:
  std::string_view Take(std::size_t length) {
    if (length > bytes_.size()) {
      Refuse();
      bytes_ = {};
    }
    const std::string_view part = bytes_.substr(0, length);
    bytes_.remove_prefix(part.size());
    return part;
  }

  std::string_view bytes_;
  bool refused_ = false;
};

void Encode(PayloadWriter* to, const InfoRecord& record) {
  to->Text(record.key);
  to->Text(record.value);
}
void Decode(PayloadReader* from, InfoRecord* record) {
  from->Text(&record->key);
  from->Text(&record->value);
}

void Encode(PayloadWriter* to, const TicksRecord& record) {
  to->Bytes(PackTicks(record.ticks, Packing::kFast));
}
void Decode(PayloadReader* from, TicksRecord* record) {
  if (!UnpackTicks(from->Rest(), &record->ticks).empty()) from->Refuse();
}

void Encode(PayloadWriter* to, const TimingsRecord& record) {
  to->Bytes(PackTimings(record.timings, Packing::kFast));
}
void Decode(PayloadReader* from, TimingsRecord* record) {
  if (!UnpackTimings(from->Rest(), &record->timings).empty()) from->Refuse();
}

void Encode(PayloadWriter* to, const SafetyRecord& record) { to->Raw(record); }
void Decode(PayloadReader* from, SafetyRecord* record) { from->Raw(record); }

void Encode(PayloadWriter* to, const RunEvent& event) {
  to->Raw(event.time_ns);
  for (const std::string* text : {&event.kind, &event.name, &event.text, &event.value_json}) {
    to->Text(*text);
  }
}
void Decode(PayloadReader* from, RunEvent* event) {
  from->Raw(&event->time_ns);
  for (std::string* text : {&event->kind, &event->name, &event->text, &event->value_json}) {
    from->Text(text);
  }
}

void Encode(PayloadWriter* to, const EndRecord& record) { to->Text(record.result_json); }
void Decode(PayloadReader* from, EndRecord* record) { from->Text(&record->result_json); }

template <std::size_t kIndex = 0>
std::optional<RunRecord> DecodeAs(std::uint32_t kind, std::string_view payload) {
  if constexpr (kIndex == std::variant_size_v<RunRecord>) {
    return std::nullopt;
  } else {
    if (kind != kKinds[kIndex]) return DecodeAs<kIndex + 1>(kind, payload);
    std::variant_alternative_t<kIndex, RunRecord> record{};
    PayloadReader from(payload);
    Decode(&from, &record);
    if (!from.done()) return std::nullopt;
    return RunRecord(std::in_place_index<kIndex>, std::move(record));
  }
}

template <typename T>
T NumberAt(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

std::string HeaderBody() {
  std::string header(kRecordMagic);
  PayloadWriter to(&header);
  for (const std::uint32_t version :
       {kRecordFormatVersion, kStepInputVersion, kStepOutputVersion, kSafetyRecordVersion}) {
    to.Raw(version);
  }
  return header;
}

}  // namespace

std::string RecordHeader() {
  std::string header = HeaderBody();
  const std::uint64_t checksum = Checksum64(header, 0);
  PayloadWriter(&header).Raw(checksum);
  return header;
}

std::string RecordHeaderProblem(std::string_view bytes) {
  const std::string expected = RecordHeader();
  if (bytes.substr(0, expected.size()) == expected) return {};
  if (!bytes.starts_with(kRecordMagic)) return "does not begin as a record file does";
  if (bytes.size() < kRecordHeaderBytes) return "is cut short within its header";
  constexpr std::size_t kBody = kRecordHeaderBytes - sizeof(std::uint64_t);
  if (NumberAt<std::uint64_t>(bytes, kBody) != Checksum64(bytes.substr(0, kBody), 0)) {
    return "is damaged in its header";
  }
  const auto versions = [](std::string_view header) {
    std::string text;
    for (std::size_t at = kRecordMagic.size(); at < kBody; at += sizeof(std::uint32_t)) {
      if (!text.empty()) text.append(".");
      text.append(std::to_string(NumberAt<std::uint32_t>(header, at)));
    }
    return text;
  };
  return "was begun by another version of flexarm: its records are " + versions(bytes) +
         ", this version has " + versions(expected) + "; recover it with the version that wrote it";
}

std::string EncodeRecord(const RunRecord& record, std::uint64_t offset) {
  std::string bytes;
  PayloadWriter to(&bytes);
  to.Raw(kKinds[record.index()]);
  to.Raw(std::uint32_t{0});
  std::visit([&to](const auto& content) { Encode(&to, content); }, record);
  const auto length =
      static_cast<std::uint32_t>(bytes.size() - (kRecordFrameBytes - sizeof(std::uint64_t)));
  std::memcpy(bytes.data() + sizeof(std::uint32_t), &length, sizeof length);
  to.Raw(Checksum64(bytes, offset));
  return bytes;
}

std::optional<RecordFrame> DecodeFrame(std::string_view bytes) {
  if (bytes.size() < 2 * sizeof(std::uint32_t)) return std::nullopt;
  const RecordFrame frame{.kind = NumberAt<std::uint32_t>(bytes, 0),
                          .payload_bytes = NumberAt<std::uint32_t>(bytes, 4)};
  const bool known = std::find(kKinds.begin(), kKinds.end(), frame.kind) != kKinds.end();
  if (!known || frame.payload_bytes > kLargestPayload) return std::nullopt;
  return frame;
}

bool RecordIsWhole(std::string_view record, std::uint64_t offset) {
  const std::size_t body = record.size() - sizeof(std::uint64_t);
  return NumberAt<std::uint64_t>(record, body) == Checksum64(record.substr(0, body), offset);
}

std::optional<RunRecord> DecodeRecord(std::string_view record) {
  const std::optional<RecordFrame> frame = DecodeFrame(record);
  if (!frame || record.size() != frame->size()) return std::nullopt;
  return DecodeAs(frame->kind, record.substr(8, frame->payload_bytes));
}

}  // namespace flexarm
