#pragma once

#include <cstddef>
#include <functional>

namespace flexarm {

/// Runs body(0) .. body(count - 1) on all cores, in no particular order.
///
/// `progress` is called on the calling thread with the number done so far, periodically and at the
/// end; it may be empty. The first exception of a body stops the rest and is thrown again here.
/// @param jobs  number of threads; 0: one per core
void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& body,
                 const std::function<void(std::size_t)>& progress = {}, std::size_t jobs = 0);

/// A progress bar with the time left on standard error if that is a terminal; otherwise no output.
std::function<void(std::size_t)> ProgressBar(const char* what, std::size_t count);

}  // namespace flexarm
