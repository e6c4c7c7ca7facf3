#include "tools/analysis/linear_system_file.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "controller/files/external_file.h"
#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index kMostStates = 400;  // with more states the eigenvalues take minutes

std::string Size(const MatrixXd& m) {
  return std::to_string(m.rows()) + " x " + std::to_string(m.cols());
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file)
      : file_(Shown(file.string(), kMessageBytes)),
        json_(ParseJson(ReadExternalText(file, kLinearSystemFile), file_, kLinearSystemFile.name)) {
    if (!json_.is_object()) {
      throw InputError(file_ + ": expected one JSON object with M, K, B, C or A, B, C");
    }
  }

  [[noreturn]] void Refuse(const std::string& key, const std::string& what) const {
    throw InputError(file_ + ": " + key + ": " + what);
  }

  bool Has(const char* key) const { return json_.contains(key); }

  void AllowOnly(const std::set<std::string>& keys) const {
    for (const auto& [key, value] : json_.items()) {
      if (keys.contains(key)) continue;
      std::string list;
      for (const std::string& known : keys) list += (list.empty() ? "" : ", ") + known;
      Refuse(Shown(key), "is not a key here; expected " + list);
    }
  }

  std::string Name() const {
    if (!Has("name")) return std::filesystem::path(file_).filename().string();
    if (!json_["name"].is_string()) Refuse("name", "expected a text");
    return json_["name"].get<std::string>();
  }

  MatrixXd Matrix(const char* key) const {
    if (!Has(key)) Refuse(key, "is missing; expected a matrix as an array of rows");
    const nlohmann::ordered_json& rows = json_[key];
    if (!rows.is_array() || rows.empty() || !rows[0].is_array() || rows[0].empty()) {
      Refuse(key, "expected a matrix as an array of rows, at least one number");
    }
    MatrixXd out(static_cast<Index>(rows.size()), static_cast<Index>(rows[0].size()));
    if (out.rows() > kMostStates || out.cols() > kMostStates) {
      Refuse(key, "is " + Size(out) + "; expected at most " + std::to_string(kMostStates) +
                      " rows and columns");
    }
    for (Index i = 0; i < out.rows(); ++i) {
      FillRow(std::string(key) + ", row " + std::to_string(i + 1),
              rows[static_cast<std::size_t>(i)], i, &out);
    }
    return out;
  }

  /// A matrix whose size other matrices determine; 0 stands for any number.
  MatrixXd Matrix(const char* key, Index rows, Index cols) const {
    MatrixXd out = Matrix(key);
    const bool fits = (rows == 0 || out.rows() == rows) && (cols == 0 || out.cols() == cols);
    if (!fits) {
      const auto count = [](Index n) { return n == 0 ? "any" : std::to_string(n); };
      Refuse(key, "is " + Size(out) + "; expected " + count(rows) + " x " + count(cols));
    }
    return out;
  }

 private:
  void FillRow(const std::string& where, const nlohmann::ordered_json& row, Index i,
               MatrixXd* out) const {
    if (!row.is_array() || static_cast<Index>(row.size()) != out->cols()) {
      Refuse(where, "has " + (row.is_array() ? std::to_string(row.size()) : "no") +
                        " numbers; expected " + std::to_string(out->cols()));
    }
    for (Index j = 0; j < out->cols(); ++j) {
      const nlohmann::ordered_json& value = row[static_cast<std::size_t>(j)];
      if (!value.is_number() || !std::isfinite(value.get<double>())) {
        Refuse(where, "expected finite numbers, found " + Shown(value.dump()));
      }
      (*out)(i, j) = value.get<double>();
    }
  }

  std::string file_;
  nlohmann::ordered_json json_;
};

bool IsSymmetric(const MatrixXd& A) {
  return (A - A.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * A.cwiseAbs().maxCoeff();
}

// The whole system has the states q and q'; the oscillating part z = [q; M q'] if K is symmetric.
void ReadSecondOrder(const Reader& file, LinearSystemFile* out) {
  file.AllowOnly({"name", "M", "K", "D", "B", "C"});
  const MatrixXd M = file.Matrix("M");
  const Index n = M.rows();
  if (M.cols() != n) file.Refuse("M", "is " + Size(M) + "; expected a square matrix");
  const Eigen::LLT<MatrixXd> llt(M);
  if (!IsSymmetric(M) || llt.info() != Eigen::Success) {
    file.Refuse("M", "expected a symmetric positive definite matrix");
  }
  const MatrixXd K = file.Matrix("K", n, n), B = file.Matrix("B", n, 0), C = file.Matrix("C", 0, n);
  const MatrixXd D = file.Has("D") ? file.Matrix("D", n, n) : MatrixXd::Zero(n, n);
  StateSpace& s = out->system;
  s.A = MatrixXd::Zero(2 * n, 2 * n);
  s.A.topRightCorner(n, n).setIdentity();
  s.A.bottomLeftCorner(n, n) = -llt.solve(K);
  s.A.bottomRightCorner(n, n) = -llt.solve(D);
  s.B = MatrixXd::Zero(2 * n, B.cols());
  s.B.bottomRows(n) = llt.solve(B);
  s.C = MatrixXd::Zero(C.rows(), 2 * n);
  s.C.leftCols(n) = C;
  const MatrixXd one = MatrixXd::Identity(n, n), M_inverse = llt.solve(one);
  if (IsSymmetric(K)) {
    out->undamped = UndampedSystem{0.5 * (M_inverse + M_inverse.transpose()), K, B, C};
  } else {
    out->undamped = UndampedSystem{one, llt.solve(K), llt.solve(B), C};
  }
  out->damping_left_out = !D.isZero(0.0);
}

// Why x' = A x + B u, y = C x does not have the form (6.5); empty if it has.
std::string NotSecondOrder(const StateSpace& s) {
  const Index n = s.A.rows() / 2;
  if (s.A.rows() % 2 != 0) return "A has an odd number of states";
  if (!s.A.topLeftCorner(n, n).isZero(0.0)) return "the upper left quarter of A is not zero";
  if (!s.B.topRows(n).isZero(0.0)) return "the upper half of B is not zero";
  if (!s.C.rightCols(n).isZero(0.0)) return "the right half of C is not zero";
  return "";
}

void ReadFirstOrder(const Reader& file, LinearSystemFile* out) {
  file.AllowOnly({"name", "A", "B", "C"});
  StateSpace& s = out->system;
  s.A = file.Matrix("A");
  if (s.A.cols() != s.A.rows()) file.Refuse("A", "is " + Size(s.A) + "; expected a square matrix");
  s.B = file.Matrix("B", s.A.rows(), 0);
  s.C = file.Matrix("C", 0, s.A.rows());
  out->not_undamped = NotSecondOrder(s);
  if (!out->not_undamped.empty()) return;
  const Index n = s.A.rows() / 2;
  out->undamped = UndampedSystem{s.A.topRightCorner(n, n), -s.A.bottomLeftCorner(n, n),
                                 s.B.bottomRows(n), s.C.leftCols(n)};
  out->damping_left_out = !s.A.bottomRightCorner(n, n).isZero(0.0);
}

}  // namespace

LinearSystemFile LoadLinearSystem(const std::filesystem::path& file) {
  const Reader reader(file);
  LinearSystemFile out{};
  out.name = reader.Name();
  if (reader.Has("M") || reader.Has("K")) {
    ReadSecondOrder(reader, &out);
  } else {
    ReadFirstOrder(reader, &out);
  }
  return out;
}

}  // namespace flexarm
