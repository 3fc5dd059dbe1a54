/* Include this first, before test.h, in a test file that reaches behind the public functions: the file then holds a
 * private copy of the implementation. Compilers drop what it does not call, so this costs little more than parsing. */
#ifndef INTERNALS_H
#define INTERNALS_H

#define YC_API static
#define YARNCLOTH_IMPLEMENTATION
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-const-variable"
#endif
#include "yarncloth.h"
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
