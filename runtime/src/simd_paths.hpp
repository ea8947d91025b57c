// SPDX-License-Identifier: MIT
#pragma once

// Where the compilers and processors we know meet: x86-64 with function-wise target attributes. Everything
// else takes the scalar path.
#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define SPHERETREE_X86 1
#else
#define SPHERETREE_X86 0
#endif
