#pragma once

/// Compiles a function twice, for any x86-64 and for those with AVX2, and picks one when the program starts. Without
/// fused multiply-add, so that both give the same numbers. Elsewhere the compiler's own vectors do.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
#define FLIES_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define FLIES_VECTOR_CLONES
#endif
