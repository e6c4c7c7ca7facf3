#pragma once

#include <Eigen/Core>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace flexarm {

/// A JSON file of tests/golden/.
inline nlohmann::json GoldenFile(const std::string& name) {
  std::ifstream in(std::string(FLEXARM_SOURCE_DIR) + "/tests/golden/" + name);
  if (!in) throw std::runtime_error("cannot open tests/golden/" + name);
  return nlohmann::json::parse(in);
}

inline Eigen::VectorXd AsVector(const nlohmann::json& array) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(array.size()));
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = array[static_cast<std::size_t>(i)];
  return v;
}

inline Eigen::MatrixXd AsMatrix(const nlohmann::json& rows) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd m(n, static_cast<Eigen::Index>(rows[0].size()));
  for (Eigen::Index i = 0; i < n; ++i) m.row(i) = AsVector(rows[static_cast<std::size_t>(i)]);
  return m;
}

/// max |X - G| / max |G|: the relative error in which golden.json is compared.
inline double RelativeError(const Eigen::MatrixXd& X, const Eigen::MatrixXd& G) {
  return (X - G).cwiseAbs().maxCoeff() / G.cwiseAbs().maxCoeff();
}

}  // namespace flexarm
