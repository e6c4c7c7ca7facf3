#include "tools/tuning/tuning_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/types/rounded_text.h"

namespace flexarm {
namespace {

/// Keys that one factor scales together, 10^step at a time.
struct Direction {
  std::vector<const char*> keys;
  double least, most;  // of the exponent, from the start
};

const std::vector<Direction>& Directions() {
  static const std::vector<Direction> directions = {
      {{"controller.torque_weight"}, -1.0, 3.0},
      {{"estimator.process_force", "estimator.payload.process_force"}, -3.0, 1.5},
      {{"estimator.modal_sigma_m"}, -1.0, 1.5},
      {{"controller.alpha"}, -1.0, 0.5},
      {{"controller.hub_rate_weight"}, -1.5, 1.0},
      {{"estimator.hub_extra_sigma_rad"}, -1.0, 1.5},
  };
  return directions;
}

std::string NumberOf(double value) { return RoundedText(value, 3); }

std::string ListOf(const std::vector<double>& values, bool is_list) {
  if (!is_list) return NumberOf(values.front());
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + NumberOf(value);
  return "[" + text + "]";
}

/// A key of the config with its numbers.
struct Numbers {
  std::string key;
  std::vector<double> values;
  bool is_list;
};

Numbers NumbersAt(const RigConfig& config, const char* key) {
  const std::optional<double> one = NumberAt(config, key);
  if (one) return {key, {*one}, false};
  Numbers numbers{key, {}, true};
  for (int i = 0;; ++i) {
    const auto element = NumberAt(config, std::string(key) + "[" + std::to_string(i) + "]");
    if (!element) return numbers;
    numbers.values.push_back(*element);
  }
}

using Exponents = std::vector<double>;

class Search {
 public:
  Search(const RigConfig& config, int most, const std::function<void(int, double)>& progress)
      : start_(config), most_(most), progress_(progress), best_(Directions().size(), 0.0) {
    for (const Direction& direction : Directions()) {
      std::vector<Numbers>& scaled = numbers_.emplace_back();
      for (const char* key : direction.keys) {
        Numbers numbers = NumbersAt(config, key);
        const bool zero = std::all_of(numbers.values.begin(), numbers.values.end(),
                                      [](double x) { return x == 0.0; });
        if (!zero) scaled.push_back(std::move(numbers));
      }
    }
  }

  Tuning Run() {
    const DesignScore before = ScoreOf(start_);
    DesignScore best = before;
    Report(best);
    for (double step = 1.0; step >= 0.12 && done_ < most_ && best.value < 1.0;) {
      if (!Improve(step, &best)) step *= 0.5;
    }
    Tuning tuning{.changed = {}, .before = before, .after = best, .config = start_};
    if (best_ == Exponents(best_.size(), 0.0)) return tuning;
    tuning.changed = Changes(best_);
    tuning.config = At(best_);
    return tuning;
  }

 private:
  // Tries every direction, up and down, and moves to each point that is better.
  bool Improve(double step, DesignScore* best) {
    bool better = false;
    for (std::size_t i = 0; i < best_.size(); ++i) {
      if (numbers_[i].empty()) continue;
      for (const double move : {step, -step}) {
        if (done_ >= most_ || best->value >= 1.0) return better;
        Exponents next = best_;
        next[i] += move;
        if (next[i] < Directions()[i].least || next[i] > Directions()[i].most) continue;
        const DesignScore score = Judge(next);
        if (!(score.value > best->value + 1e-3)) continue;
        *best = score;
        best_ = next;
        better = true;
        break;
      }
    }
    return better;
  }

  DesignScore Judge(const Exponents& exponents) {
    ++done_;
    DesignScore score{.value = -10.0, .result = DesignVerdict::Result::kRejected, .found = {}};
    try {
      score = ScoreOf(At(exponents));
    } catch (const ConfigError&) {  // out of a key's range
    }
    Report(score);
    return score;
  }

  void Report(const DesignScore& score) {
    shown_ = std::max(shown_, score.value);
    if (progress_) progress_(done_, shown_);
  }

  std::vector<TunedKey> Changes(const Exponents& exponents) const {
    std::vector<TunedKey> changes;
    for (std::size_t i = 0; i < exponents.size(); ++i) {
      if (exponents[i] == 0.0) continue;
      for (const Numbers& numbers : numbers_[i]) {
        std::vector<double> scaled = numbers.values;
        for (double& value : scaled) value *= std::pow(10.0, exponents[i]);
        changes.push_back({numbers.key, ListOf(numbers.values, numbers.is_list),
                           ListOf(scaled, numbers.is_list)});
      }
    }
    return changes;
  }

  RigConfig At(const Exponents& exponents) const {
    std::vector<std::string> overrides;
    for (const TunedKey& change : Changes(exponents)) {
      overrides.push_back(change.key + "=" + change.after);
    }
    return WithOverrides(start_, overrides);
  }

  const RigConfig& start_;
  int most_, done_ = 0;
  const std::function<void(int, double)>& progress_;
  std::vector<std::vector<Numbers>> numbers_;
  Exponents best_;
  double shown_ = -10.0;
};

}  // namespace

Tuning TuneDesign(const RigConfig& config, int most,
                  const std::function<void(int, double)>& progress) {
  return Search(config, most, progress).Run();
}

}  // namespace flexarm
