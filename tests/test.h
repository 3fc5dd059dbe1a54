/* What every test file includes.
 *
 * A test is one function, written TEST(name) { ... } with TEST at the beginning of a line; the Makefile finds it there.
 * It passes when none of its checks failed, and prints nothing itself. A check is also an expression, 1 when it held,
 * so that a test which cannot go on says: if (!CHECK(...)) return;
 * Checks and random numbers are for the main thread, not for the inside of parallel_for. */
#ifndef TEST_H
#define TEST_H

#include "yarncloth.h"
#include <stdint.h>

#define TEST(name) \
    void test_function_##name(void); \
    void test_function_##name(void)

#define CHECK(condition) test_check((condition) ? 1 : 0, __FILE__, __LINE__, #condition)
#define CHECK_NEAR(a, b, tolerance) test_check_near((a), (b), (tolerance), __FILE__, __LINE__, #a, #b)
/* The same for arrays of doubles; names the entry that is furthest off. */
#define CHECK_NEAR_ALL(a, b, count, tolerance) \
    test_check_near_all((a), (b), (int)(count), (tolerance), __FILE__, __LINE__, #a, #b)
#define CHECK_RESULT(call, expected) test_check_result((call), (expected), __FILE__, __LINE__, #call)
#define CHECK_TEXT(text, expected) test_check_text((text), (expected), __FILE__, __LINE__)

int test_check(int held, const char *file, int line, const char *text);
int test_check_near(
    double a, double b, double tolerance, const char *file, int line, const char *text_a, const char *text_b);
int test_check_near_all(const double *a, const double *b, int count, double tolerance, const char *file, int line,
    const char *text_a, const char *text_b);
int test_check_result(yc_result result, yc_result expected, const char *file, int line, const char *text);
int test_check_text(const char *text, const char *expected, const char *file, int line);

/* ---- hosts ----------------------------------------------------------------------------------------------------------
 * All share one count of the heap, which each of these functions sets to zero. Blocks of one host may be freed through
 * another. A size other than the one asked for, or a call from inside parallel_for, fails the test. */

typedef struct {
    int calls;    /* allocations asked for */
    int live;     /* blocks not yet freed */
    size_t bytes; /* in them */
} test_heap_count;
extern test_heap_count test_heap;

/* Counts, and runs everything inline. */
yc_host test_host_counting(void);

/* Grants n allocations and refuses every later one. */
yc_host test_host_failing(int n);

/* From now on grants n allocations, all when n is negative, and goes on counting. */
void test_heap_grant(int n);

/* Checks what a call has made of a refused allocation: it says so, and holds nothing. */
int test_refused_memory(yc_result result, const char *message);

/* Runs parallel_for on that many threads, at most TEST_WORKERS; 0 runs it inline from the last index to the first, as
 * all of them do where there are no threads. */
#define TEST_WORKERS 32
yc_host test_host_threads(int workers);

/* ---- random numbers -------------------------------------------------------------------------------------------------
 * The same on every machine. Start with any state. */

double test_random(uint64_t *state, double low, double high);
int test_random_int(uint64_t *state, int count); /* 0 .. count-1 */
void test_random_array(uint64_t *state, double low, double high, double *x, int count);

/* ---- matrices ---------------------------------------------------------------------------------------------------- */

/* The lowest eigenvalue of the symmetric n x n matrix a, n at most 12. *largest, unless NULL, receives the greatest
 * magnitude of all. */
double test_lowest_eigenvalue(const double *a, int n, double *largest);

#endif
