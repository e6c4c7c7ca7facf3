#pragma once

#include "controller/types/records.h"

namespace CLI {
class App;
}

namespace flexarm {

/// The options --name, --note and --tag of every verb that makes a log of a run.
class LabelOptions {
 public:
  void AddTo(CLI::App* verb);
  /// @throws InputError for a text that ProblemOfLabel refuses
  RunLabel Label() const;

 private:
  RunLabel label_;
};

}  // namespace flexarm
