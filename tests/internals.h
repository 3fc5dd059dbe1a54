/* Include this first, before test.h, in a test file that reaches behind the public functions: the unit then holds the
 * implementation. Makefile makes one unit of all such tests, so their names must differ, and with YC_API extern it is
 * the library of the others too; without, the copy is private. */
#ifndef INTERNALS_H
#define INTERNALS_H

#ifndef YC_API
#define YC_API static
#endif
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
