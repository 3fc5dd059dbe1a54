/* What benchmarks share: a clock, random numbers, medians and memory that is there. For C and C++; a C file defines
 * _POSIX_C_SOURCE as 200809L before its first include. */
#ifndef BENCH_H
#define BENCH_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Seconds of processor time of the calling thread: what other programs do on the machine does not count. */
static inline double bench_clock(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static inline void *bench_alloc(size_t count, size_t size) {
    void *block = calloc(count ? count : 1, size);
    if (!block) fputs("out of memory\n", stderr), exit(1);
    return block;
}

#define BENCH_NEW(type, count) ((type *)bench_alloc((size_t)(count), sizeof(type)))

/* Uniform in [lo, hi). */
static inline double bench_random(uint64_t *state, double lo, double hi) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * (double)(*state >> 11) / 9007199254740992.0;
}

static inline int bench_order(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Sorts, then returns what lies at a share of the way: 0.5 is the median. */
static inline double bench_quantile(double *values, int count, double share) {
    double at = share * (double)(count - 1);
    int k = (int)at;
    qsort(values, (size_t)count, sizeof *values, bench_order);
    if (k + 1 >= count || at == (double)k) return values[k];
    return values[k] + (at - (double)k) * (values[k + 1] - values[k]);
}

#endif
