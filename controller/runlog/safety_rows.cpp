#include "controller/runlog/safety_rows.h"

#include "controller/runlog/blob.h"

namespace flexarm {

std::string CauseNames(TripCauses causes) {
  std::string names;
  for (int number = 1; number < kTripCauses; ++number) {
    const TripCause cause = static_cast<TripCause>(number);
    if ((causes & CauseBit(cause)) == 0) continue;
    if (!names.empty()) names += ' ';
    names += ToString(cause);
  }
  return names;
}

void InsertSafety(SqliteStatement* insert, const SafetyRecord& record, std::int64_t start_ns) {
  const SafetyFacts& facts = record.facts;
  int next = 1;
  const auto text = [&](std::string_view value) { insert->Bind(next++, value); };
  const auto integer = [&](std::int64_t value) { insert->Bind(next++, value); };
  const auto real = [&](double value) { insert->Bind(next++, value); };
  integer(record.due_ns);
  real(static_cast<double>(record.due_ns - start_ns) * 1e-9);
  text(ToString(record.before.state));
  text(ToString(record.after.state));
  text(ToString(record.after.cause));
  text(CauseNames(facts.present));
  for (const std::uint8_t flag :
       {facts.all_reported, facts.at_rest, facts.experiment_done, facts.stop_expired,
        facts.reset_pressed, facts.may_damp, facts.drives_on, facts.drives_off, facts.tests_power,
        facts.power_follows}) {
    integer(flag);
  }
  text(ToString(facts.request));
  integer(record.request_number);
  text(ToString(record.refusal));
  real(record.evidence.value);
  real(record.evidence.limit);
  integer(record.evidence.channel);
  const auto bytes = EncodeBlob(kSafetyRecordVersion, record);
  insert->Bind(next++, std::span<const std::byte>(bytes));
  insert->Execute();
}

std::string ReadSafety(const SqliteStatement& row, SafetyRecord* record) {
  return DecodeBlob(row.Blob(1), kSafetyRecordVersion, record);
}

}  // namespace flexarm
