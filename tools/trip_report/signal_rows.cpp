#include "tools/trip_report/signal_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flexarm {

SignalRows::SignalRows(std::size_t signals, double from_s, double until_s, double period_s,
                       std::size_t most)
    : from_s_(from_s), until_s_(until_s), period_s_(period_s), value_(signals) {
  if ((until_s - from_s) / period_s > static_cast<double>(most)) parts_ = most / 2;
}

void SignalRows::Append(double time_s, const std::vector<double>& value) {
  time_s_.push_back(time_s);
  for (std::size_t i = 0; i < value_.size(); ++i) value_[i].push_back(value[i]);
}

void SignalRows::FlushPart() {
  if (least_.empty()) return;
  const double width_s = (until_s_ - from_s_) / static_cast<double>(parts_);
  const double begin_s = from_s_ + width_s * static_cast<double>(part_);
  Append(begin_s + 0.25 * width_s, least_);
  Append(begin_s + 0.75 * width_s, most_of_);
  least_.clear();
  most_of_.clear();
}

void SignalRows::Add(double time_s, const std::vector<double>& value) {
  if (!(time_s >= from_s_) || !(time_s <= until_s_)) return;
  if (any_ && time_s - last_s_ > 1.5 * period_s_) {
    FlushPart();
    Append(0.5 * (time_s + last_s_),
           std::vector<double>(value_.size(), std::numeric_limits<double>::quiet_NaN()));
  }
  any_ = true;
  last_s_ = time_s;
  if (parts_ == 0) return Append(time_s, value);
  const auto share = (time_s - from_s_) / (until_s_ - from_s_);
  const std::size_t part =
      std::min(parts_ - 1, static_cast<std::size_t>(share * static_cast<double>(parts_)));
  if (part != part_) FlushPart();
  part_ = part;
  if (least_.empty()) {
    least_ = most_of_ = value;
    return;
  }
  for (std::size_t i = 0; i < value.size(); ++i) {  // a NaN does not hide a number
    least_[i] = std::fmin(least_[i], value[i]);
    most_of_[i] = std::fmax(most_of_[i], value[i]);
  }
}

void SignalRows::Finish() { FlushPart(); }

}  // namespace flexarm
