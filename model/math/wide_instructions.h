#pragma once

/// A function that is compiled twice: for any processor, and with instructions for four numbers
/// (AVX2), which about halves its time. The first call finds out which one the processor runs.
///
/// Both give the same bits: neither has fused multiply-add, and no sum changes its order. What it
/// calls is inlined, so that it is compiled twice as well. Sanitizers run before processors are
/// told apart, and other compilers and processors have one version.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FLEXARM_WIDE_INSTRUCTIONS [[gnu::flatten, gnu::target_clones("avx2", "default")]]
#else
#define FLEXARM_WIDE_INSTRUCTIONS
#endif
