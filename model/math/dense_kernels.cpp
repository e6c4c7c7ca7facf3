#include "model/math/dense_kernels.h"

namespace Eigen::internal {

template struct gebp_kernel<double, double, Index, blas_data_mapper<double, Index, ColMajor>,
                            GebpTraits::mr, GebpTraits::nr, false, false>;
template struct gemm_pack_lhs<double, Index, ColumnMapper, GebpTraits::mr, GebpTraits::LhsProgress,
                              GebpTraits::LhsPacket4Packing, ColMajor>;
template struct gemm_pack_lhs<double, Index, RowMapper, GebpTraits::mr, GebpTraits::LhsProgress,
                              GebpTraits::LhsPacket4Packing, RowMajor>;
template struct gemm_pack_rhs<double, Index, ColumnMapper, GebpTraits::nr, ColMajor>;
template struct gemm_pack_rhs<double, Index, RowMapper, GebpTraits::nr, RowMajor>;

template struct general_matrix_vector_product<Index, double, ColumnMapper, ColMajor, false, double,
                                              ColumnMapper, false>;
template struct general_matrix_vector_product<Index, double, ColumnMapper, ColMajor, false, double,
                                              RowMapper, false>;
template struct general_matrix_vector_product<Index, double, RowMapper, RowMajor, false, double,
                                              ColumnMapper, false>;
template struct general_matrix_vector_product<Index, double, RowMapper, RowMajor, false, double,
                                              RowMapper, false>;

template struct triangular_solve_matrix<double, Index, OnTheLeft, Lower, false, ColMajor, ColMajor,
                                        1>;
template struct triangular_solve_matrix<double, Index, OnTheLeft, Lower | UnitDiag, false, ColMajor,
                                        ColMajor, 1>;
template struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, ColMajor, ColMajor,
                                        1>;
template struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, RowMajor, ColMajor,
                                        1>;

}  // namespace Eigen::internal
