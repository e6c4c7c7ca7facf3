#pragma once

#include <Eigen/Dense>

// The inner loops of Eigen's products of real matrices too large to unroll. Declared here, they are
// compiled once (dense_kernels.cpp): that saves a second of compile time per file with a product.
// Code that includes <Eigen/Dense> itself computes the same numbers and compiles more slowly.
// Real-time: these loops are safe. A product that uses them allocates unless its sizes are bounded.
namespace Eigen::internal {

using GebpTraits = gebp_traits<double, double>;
using ColumnMapper = const_blas_data_mapper<double, Index, ColMajor>;
using RowMapper = const_blas_data_mapper<double, Index, RowMajor>;

extern template struct gebp_kernel<double, double, Index, blas_data_mapper<double, Index, ColMajor>,
                                   GebpTraits::mr, GebpTraits::nr, false, false>;
extern template struct gemm_pack_lhs<double, Index, ColumnMapper, GebpTraits::mr,
                                     GebpTraits::LhsProgress, GebpTraits::LhsPacket4Packing,
                                     ColMajor>;
extern template struct gemm_pack_lhs<double, Index, RowMapper, GebpTraits::mr,
                                     GebpTraits::LhsProgress, GebpTraits::LhsPacket4Packing,
                                     RowMajor>;
extern template struct gemm_pack_rhs<double, Index, ColumnMapper, GebpTraits::nr, ColMajor>;
extern template struct gemm_pack_rhs<double, Index, RowMapper, GebpTraits::nr, RowMajor>;

// Products with a vector: the matrix by columns or by rows, the vector contiguous or strided.
extern template struct general_matrix_vector_product<Index, double, ColumnMapper, ColMajor, false,
                                                     double, ColumnMapper, false>;
extern template struct general_matrix_vector_product<Index, double, ColumnMapper, ColMajor, false,
                                                     double, RowMapper, false>;
extern template struct general_matrix_vector_product<Index, double, RowMapper, RowMajor, false,
                                                     double, ColumnMapper, false>;
extern template struct general_matrix_vector_product<Index, double, RowMapper, RowMajor, false,
                                                     double, RowMapper, false>;

// Solutions with a triangular matrix from the left, as the decompositions call them.
extern template struct triangular_solve_matrix<double, Index, OnTheLeft, Lower, false, ColMajor,
                                               ColMajor, 1>;
extern template struct triangular_solve_matrix<double, Index, OnTheLeft, Lower | UnitDiag, false,
                                               ColMajor, ColMajor, 1>;
extern template struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, ColMajor,
                                               ColMajor, 1>;
extern template struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, RowMajor,
                                               ColMajor, 1>;

}  // namespace Eigen::internal
