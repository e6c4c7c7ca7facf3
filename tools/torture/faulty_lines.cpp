#include "tools/torture/faulty_lines.h"

namespace flexarm {
namespace {

// A bus that is asked for the levels, far beyond SafetyLines::kBudgetNs and the permit's age.
constexpr std::int64_t kSlowCallNs = 20'000'000;
// A drift ends at any limit: so much more per second.
constexpr double kDriftPerSecond = 10e-3;

}  // namespace

FaultyLines::FaultyLines(SafetyLines* lines, const std::vector<Fault>& faults)
    : lines_(lines), faults_(&faults), held_(faults.size(), kHealthyLevels) {}

bool FaultyLines::CallFails(FaultPlace place, std::int64_t now_ns, Call* call) noexcept {
  bool fails = false;
  for (const Fault& fault : *faults_) {
    if (fault.place != place || !IsActive(fault, now_ns)) continue;
    if (fault.kind == FaultKind::kSlow) call->took_ns += kSlowCallNs;
    if (fault.kind == FaultKind::kDrifting) {
      const double share = kDriftPerSecond * static_cast<double>(now_ns - fault.from_ns);
      call->took_ns += static_cast<std::int64_t>(share);
    }
    const bool missing = random_() % 2 == 0;
    if (fault.kind == FaultKind::kOff || (fault.kind == FaultKind::kIntermittent && missing)) {
      fails = true;
    }
  }
  if (fails) call->ok = false;
  return fails;
}

LineLevels FaultyLines::Spoilt(const Fault& fault, LineLevels levels) noexcept {
  const LineLevels bit = LineLevels{1} << static_cast<unsigned>(fault.index);
  const std::size_t number = static_cast<std::size_t>(&fault - faults_->data());
  const bool random_level = random_() % 2 == 0;
  const auto with = [&](bool level) { return level ? levels | bit : levels & ~bit; };
  switch (fault.kind) {
    case FaultKind::kStuck:
      return (levels & ~bit) | (held_[number] & bit);
    case FaultKind::kGarbage:
      return with(random_level);
    case FaultKind::kWrongScale:
      return levels ^ bit;
    case FaultKind::kIntermittent:
      return random_level ? levels : levels & ~bit;
    case FaultKind::kLate:
    case FaultKind::kDelayed:
      return (levels & ~bit) | (levels_before_ & bit);
    case FaultKind::kOff:
      return levels & ~bit;
    case FaultKind::kNotANumber:
    case FaultKind::kSlow:
    case FaultKind::kDrifting:
      break;  // not of a line
  }
  return levels;
}

SafetyLines::Reading FaultyLines::Read(std::int64_t now_ns) noexcept {
  Reading reading = lines_->Read(now_ns);
  const LineLevels levels = reading.levels;
  for (const Fault& fault : *faults_) {
    if (fault.place != FaultPlace::kLine) continue;
    if (IsActive(fault, now_ns)) {
      reading.levels = Spoilt(fault, reading.levels);
    } else {
      held_[static_cast<std::size_t>(&fault - faults_->data())] = levels;
    }
  }
  levels_before_ = levels;
  if (CallFails(FaultPlace::kLineReads, now_ns, &reading.call)) reading.levels = 0;
  return reading;
}

SafetyLines::Call FaultyLines::Write(std::int64_t now_ns, const Outputs& outputs) noexcept {
  Call call{};
  told_ = outputs;
  Outputs put_out = outputs;
  for (const Fault& fault : *faults_) {
    if (!IsActive(fault, now_ns)) continue;
    const bool is_relay = fault.place == FaultPlace::kRelay;
    if (!is_relay && fault.place != FaultPlace::kPump) continue;
    bool& output = is_relay ? put_out.relay_closed : put_out.pump_level;
    const bool held = is_relay ? put_out_.relay_closed : put_out_.pump_level;
    const bool before = is_relay ? before_.relay_closed : before_.pump_level;
    if (fault.kind == FaultKind::kOff) output = false;
    if (fault.kind == FaultKind::kStuck) output = held;
    if (fault.kind == FaultKind::kLate) output = before;
    if (fault.kind == FaultKind::kIntermittent && random_() % 2 == 0) output = held;
  }
  before_ = outputs;
  if (CallFails(FaultPlace::kLineWrites, now_ns, &call)) return call;  // nothing changes
  put_out_ = put_out;
  const Call written = lines_->Write(now_ns, put_out);
  call.took_ns += written.took_ns;
  call.ok = call.ok && written.ok;
  return call;
}

}  // namespace flexarm
