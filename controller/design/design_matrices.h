#pragma once

namespace flexarm {

/// Calls visit(name, matrix) for every matrix of a design: one list for the writer, the reader and
/// the check of a gains file. @param design  a Design, const or not
template <typename D, typename F>
void ForEachMatrix(D& design, F&& visit) {
  visit("A", design.A);
  visit("B", design.B);
  visit("A_rate", design.A_rate);
  visit("B_rate", design.B_rate);
  visit("Am", design.Am);
  visit("Bm", design.Bm);
  visit("K", design.K);
  visit("K_stop", design.K_stop);
  visit("P", design.P);
  visit("J", design.J);
  visit("G", design.G);
  visit("S11", design.S11);
  visit("S12", design.S12);
  visit("S21", design.S21);
  visit("S22", design.S22);
  visit("Ufx", design.Ufx);
  visit("Ufu", design.Ufu);
  visit("filter_A", design.filter_A);
  visit("filter_B", design.filter_B);
  visit("filter_C", design.filter_C);
  visit("filter_L", design.filter_L);
  visit("filter_A_rate", design.filter_A_rate);
  visit("filter_B_rate", design.filter_B_rate);
  visit("filter_W", design.filter_W);
  visit("filter_P", design.filter_P);
  visit("filter_R", design.filter_R);
  visit("shaper", design.shaper);
  visit("rigid_inertia_kgm2", design.rigid_inertia_kgm2);
}

}  // namespace flexarm
