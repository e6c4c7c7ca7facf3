#pragma once

#include <string>
#include <string_view>

namespace flexarm {

/// The unit that the name of a key carries: "N m" of "torque_limit_nm"; "" if it carries none.
std::string UnitOfName(std::string_view name);

}  // namespace flexarm
