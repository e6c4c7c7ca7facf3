#pragma once

namespace flexarm {

/// Copies what is below the diagonal above it, in the first `columns` columns of a square matrix
/// that is stored by columns. Real-time: safe.
template <int kRows>
void MirrorLowerHalf(int columns, double* P) noexcept {
  for (int j = 0; j < columns; ++j) {
    for (int i = j + 1; i < kRows; ++i) P[i * kRows + j] = P[j * kRows + i];
  }
}

}  // namespace flexarm
