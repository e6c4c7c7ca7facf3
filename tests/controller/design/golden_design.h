#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/golden_data.h"

namespace flexarm {

struct NamedMatrix {
  const char* name;
  const Eigen::MatrixXd& matrix;
};

/// Compares each matrix with golden.json's MODEL_NAME: max |X - G| / max |G| is below `bar`.
inline void ExpectGolden(const std::string& model, const std::vector<NamedMatrix>& matrices,
                         double bar) {
  static const nlohmann::json golden = GoldenFile("golden.json");
  for (const NamedMatrix& m : matrices) {
    const std::string key = model + "_" + m.name;
    EXPECT_LT(RelativeError(m.matrix, AsMatrix(golden.at(key))), bar) << key;
  }
}

}  // namespace flexarm
