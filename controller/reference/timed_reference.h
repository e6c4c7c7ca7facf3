#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "controller/reference/reference.h"
#include "controller/types/step_types.h"
#include "estimator/payload_knowledge.h"

namespace flexarm {

/// The reference of a run: the table that was accepted, with the durations that are chosen while it
/// runs (docs/theory/fast-moves.md 1).
///
/// A move with a choice gets its duration from the payload that was known when the move before it
/// ended, at two standard deviations to either side; later the filter allows for a change, which
/// the move excludes. It is never longer than in the table, and at rest at the
/// same place from its end until the next move, whose start does not change. Real-time: all is
/// safe.
class TimedReference {
 public:
  /// @param table        nullptr: none; must outlive its use
  /// @param load_change  samples at which the payload changes, ascending; likewise
  void Start(const ReferenceTable* table, const std::vector<int>* load_change) noexcept;

  /// Goes on with another table, which is the same up to the next sample; no move in it has a
  /// choice, and no change of the payload is announced.
  void Continue(const ReferenceTable* table) noexcept {
    table_ = table;
    load_change_ = nullptr;
    has_chosen_ = false;
  }

  /// Chooses the duration of a move that begins at or before `sample` + 1, once.
  void Choose(int sample, const PayloadKnowledge& known) noexcept;

  /// As ReferenceTable's.
  ReferenceSample At(int k) const noexcept;
  std::array<RigidPoint, 3> PathAround(int k) const noexcept;
  int periods() const noexcept { return table_->periods(); }

  /// Whether the move that `sample` belongs to has the payload of the move before it.
  bool KeepsLoad(int sample) const noexcept;
  /// Whether a change of the payload is announced for this sample.
  bool LoadChanges(int sample) const noexcept;

 private:
  RigidPoint Point(int k) const noexcept;
  bool IsChosen(int k) const noexcept;

  const ReferenceTable* table_ = nullptr;
  const std::vector<int>* load_change_ = nullptr;
  std::size_t next_ = 0;                           // first move that has not begun
  PlannedMove chosen_{};                           // the last move that began, with its duration
  PayloadKnowledge learned_ = kNoPayloadEstimate;  // when that ended
  bool has_begun_ = false;                         // chosen_ is set
  bool has_chosen_ = false;                        // its duration is not the table's
  bool has_learned_ = false;
};

}  // namespace flexarm
