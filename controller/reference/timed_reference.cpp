#include "controller/reference/timed_reference.h"

#include <algorithm>

namespace flexarm {
namespace {

constexpr double kSigmas = 2.0;  // to either side of the estimate

}  // namespace

void TimedReference::Start(const ReferenceTable* table,
                           const std::vector<int>* load_change) noexcept {
  table_ = table;
  load_change_ = load_change;
  next_ = 0;
  has_begun_ = has_chosen_ = has_learned_ = false;
}

void TimedReference::Choose(int sample, const PayloadKnowledge& known) noexcept {
  const std::vector<PlannedMove>& moves = table_->moves();
  if (has_begun_ && !has_learned_ && sample >= chosen_.first + chosen_.periods) {
    learned_ = known;
    has_learned_ = true;
  }
  for (; next_ < moves.size() && moves[next_].first <= sample + 1; ++next_) {
    const PayloadKnowledge& load = has_learned_ ? learned_ : known;
    chosen_ = moves[next_];
    has_begun_ = true;
    has_learned_ = false;
    has_chosen_ = chosen_.choice.has_value();
    if (!has_chosen_) continue;
    const bool doubtful =
        ((load.warnings | known.warnings) & (kPayloadAtBound | kPayloadModelMismatch)) != 0;
    const double margin_kg = kSigmas * load.payload_sigma_kg;
    chosen_.periods = doubtful ? chosen_.choice->Longest()
                               : chosen_.choice->Between(load.payload_kg - margin_kg,
                                                         load.payload_kg + margin_kg);
  }
}

// Up to the next move, at which the table goes on from the same place.
bool TimedReference::IsChosen(int k) const noexcept {
  if (!has_chosen_ || k < chosen_.first) return false;
  const std::vector<PlannedMove>& moves = table_->moves();
  return next_ == moves.size() || k < moves[next_].first;
}

RigidPoint TimedReference::Point(int k) const noexcept {
  return IsChosen(k) ? chosen_.At(k, table_->period_s()) : table_->PathAround(k)[1];
}

std::array<RigidPoint, 3> TimedReference::PathAround(int k) const noexcept {
  return {Point(k - 1), Point(k), Point(k + 1)};
}

ReferenceSample TimedReference::At(int k) const noexcept {
  const bool chosen = IsChosen(k) && k < table_->periods();
  return chosen ? table_->Along(PathAround(k)) : table_->At(k);
}

bool TimedReference::KeepsLoad(int sample) const noexcept {
  const std::vector<PlannedMove>& moves = table_->moves();
  const auto after =
      std::upper_bound(moves.begin(), moves.end(), sample,
                       [](int k, const PlannedMove& move) { return k < move.first; });
  return after != moves.begin() && std::prev(after)->same_load;
}

bool TimedReference::LoadChanges(int sample) const noexcept {
  return load_change_ != nullptr &&
         std::binary_search(load_change_->begin(), load_change_->end(), sample);
}

}  // namespace flexarm
