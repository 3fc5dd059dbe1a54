/* Runs the tests: all, or those whose names contain one of the words, and none that contains a word with - before it.
 * One line each, then the counts.
 *
 *   tests [--list] [--time] [word | -word ...] */
#include "test.h"
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifdef TEST_THREADS
#include <pthread.h>
#endif

#define ENTRY(name) void test_function_##name(void);
#include "tests.inc"
#undef ENTRY

typedef struct {
    const char *name;
    void (*function)(void);
} test_entry;

static const test_entry entries[] = {
#define ENTRY(name) {#name, test_function_##name},
#include "tests.inc"
#undef ENTRY
    {NULL, NULL}};

/* ---- checks ------------------------------------------------------------------------------------------------------ */

static const char *current;    /* name of the running test */
static int passed, failed;     /* tests */
static int failures;           /* checks of the running test */
static char first_reason[512]; /* of the running test */

static int report(int held, const char *file, int line, const char *format, ...) {
    va_list args;
    int used;
    if (held || failures++) return held;
    used = snprintf(first_reason, sizeof first_reason, "%s:%d: ", file, line);
    if (used < 0 || used >= (int)sizeof first_reason) return 0;
    va_start(args, format);
    vsnprintf(first_reason + used, sizeof first_reason - (size_t)used, format, args);
    va_end(args);
    return 0;
}

int test_check(int held, const char *file, int line, const char *text) { return report(held, file, line, "%s", text); }

int test_check_near(
    double a, double b, double tolerance, const char *file, int line, const char *text_a, const char *text_b) {
    double off = fabs(a - b);
    return report(off <= tolerance, file, line, "%s = %.17g, %s = %.17g, off by %.3g > %.3g", text_a, a, text_b, b, off,
        tolerance);
}

int test_check_near_all(const double *a, const double *b, int count, double tolerance, const char *file, int line,
    const char *text_a, const char *text_b) {
    int i, worst = 0;
    double off, most = -1.0;
    for (i = 0; i < count; i++) {
        off = fabs(a[i] - b[i]);
        if (off <= most) continue;
        most = off, worst = i;
        if (!(off <= tolerance) && !(off > tolerance)) break; /* not a number */
    }
    return report(count == 0 || most <= tolerance, file, line, "[%d] of %s = %.17g, of %s = %.17g, off by %.3g > %.3g",
        worst, text_a, count ? a[worst] : 0.0, text_b, count ? b[worst] : 0.0, most, tolerance);
}

int test_check_result(yc_result result, yc_result expected, const char *file, int line, const char *text) {
    return report(
        result == expected, file, line, "%s gave %s, not %s", text, yc_result_name(result), yc_result_name(expected));
}

int test_check_text(const char *text, const char *expected, const char *file, int line) {
    return report(!strcmp(text, expected), file, line, "got \"%s\", not \"%s\"", text, expected);
}

/* ---- hosts ------------------------------------------------------------------------------------------------------- */

#define COOKIE 16 /* in front of every block, for its size; keeps the alignment of malloc */

test_heap_count test_heap;
static int granted;     /* allocations still granted; negative: all */
static int in_parallel; /* nonzero while tasks run */

static void *heap_alloc(size_t size, void *user) {
    char *raw;
    (void)user;
    test_heap.calls++;
    report(!in_parallel, "host", 0, "memory asked for inside parallel_for");
    if (granted == 0) return NULL;
    if (granted > 0) granted--;
    raw = (char *)malloc(size + COOKIE);
    if (!raw) return NULL;
    memcpy(raw, &size, sizeof size);
    test_heap.live++;
    test_heap.bytes += size;
    return raw + COOKIE;
}

static void heap_free(void *block, size_t size, void *user) {
    char *raw = (char *)block - COOKIE;
    size_t asked;
    (void)user;
    memcpy(&asked, raw, sizeof asked);
    report(!in_parallel, "host", 0, "memory freed inside parallel_for");
    report(size == asked, "host", 0, "a block of %lu bytes freed as %lu", (unsigned long)asked, (unsigned long)size);
    test_heap.live--;
    test_heap.bytes -= asked;
    free(raw);
}

static void run_reversed(void (*task)(void *context, int index), void *context, int count) {
    while (count-- > 0) task(context, count);
}

#ifdef TEST_THREADS
typedef struct {
    void (*task)(void *context, int index);
    void *context;
    int count, next;
    pthread_mutex_t lock;
} work_queue;

static void *worker(void *argument) {
    work_queue *queue = (work_queue *)argument;
    for (;;) {
        int index;
        pthread_mutex_lock(&queue->lock);
        index = queue->next++;
        pthread_mutex_unlock(&queue->lock);
        if (index >= queue->count) return NULL;
        queue->task(queue->context, index);
    }
}

/* The calling thread works too, so a thread that cannot be had is only a worker less. */
static void run_threads(int workers, void (*task)(void *context, int index), void *context, int count) {
    pthread_t threads[TEST_WORKERS];
    work_queue queue;
    int i, started = 0;
    queue.task = task, queue.context = context, queue.count = count, queue.next = 0;
    pthread_mutex_init(&queue.lock, NULL);
    while (started < workers - 1 && started < count - 1) {
        if (pthread_create(&threads[started], NULL, worker, &queue)) break;
        started++;
    }
    worker(&queue);
    for (i = 0; i < started; i++) pthread_join(threads[i], NULL);
    pthread_mutex_destroy(&queue.lock);
}
#else
static void run_threads(int workers, void (*task)(void *context, int index), void *context, int count) {
    (void)workers;
    run_reversed(task, context, count);
}
#endif

static void host_parallel_for(void *user, void (*task)(void *context, int index), void *context, int count) {
    int workers = *(const int *)user;
    in_parallel++;
    if (workers) run_threads(workers, task, context, count);
    else run_reversed(task, context, count);
    in_parallel--;
}

yc_host test_host_failing(int n) {
    yc_host host;
    memset(&host, 0, sizeof host);
    memset(&test_heap, 0, sizeof test_heap);
    granted = n;
    host.alloc = heap_alloc, host.free = heap_free;
    return host;
}

void test_heap_grant(int n) { granted = n; }

int test_refused_memory(yc_result result, const char *message) {
    int held = CHECK_RESULT(result, YC_ERROR_MEMORY);
    held &= CHECK(!strncmp(message, "out of memory for ", 18));
    return held & CHECK(test_heap.live == 0);
}

yc_host test_host_counting(void) { return test_host_failing(-1); }

yc_host test_host_threads(int workers) {
    static int counts[TEST_WORKERS + 1]; /* one for each, so that hosts with different counts live side by side */
    yc_host host = test_host_counting();
    if (workers > TEST_WORKERS) workers = TEST_WORKERS;
    counts[workers] = workers;
    host.user = &counts[workers], host.parallel_for = host_parallel_for;
    return host;
}

/* ---- random numbers: splitmix64 ---------------------------------------------------------------------------------- */

static uint64_t random_bits(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

double test_random(uint64_t *state, double low, double high) {
    return low + (high - low) * ((double)(random_bits(state) >> 11) / 9007199254740992.0);
}

int test_random_int(uint64_t *state, int count) { return (int)(random_bits(state) % (uint64_t)count); }

void test_random_array(uint64_t *state, double low, double high, double *x, int count) {
    int i;
    for (i = 0; i < count; i++) x[i] = test_random(state, low, high);
}

/* ---- matrices ---------------------------------------------------------------------------------------------------- */

/* Cyclic Jacobi: turns the plane of i and j so that entry (i, j) vanishes, until nothing is left. */
double test_lowest_eigenvalue(const double *a, int n, double *largest) {
    double m[144], lowest, most = 0.0;
    int sweep, i, j, k;
    memcpy(m, a, sizeof(double) * (size_t)(n * n));
    for (sweep = 0; sweep < 30; sweep++)
        for (i = 0; i < n; i++)
            for (j = i + 1; j < n; j++) {
                double angle, c, s;
                if (m[n * i + j] == 0.0) continue;
                angle = 0.5 * atan2(2.0 * m[n * i + j], m[n * j + j] - m[n * i + i]);
                c = cos(angle), s = sin(angle);
                for (k = 0; k < n; k++) {
                    double x = m[n * i + k], y = m[n * j + k];
                    m[n * i + k] = c * x - s * y, m[n * j + k] = s * x + c * y;
                }
                for (k = 0; k < n; k++) {
                    double x = m[n * k + i], y = m[n * k + j];
                    m[n * k + i] = c * x - s * y, m[n * k + j] = s * x + c * y;
                }
            }
    lowest = m[0];
    for (i = 0; i < n; i++) lowest = fmin(lowest, m[n * i + i]), most = fmax(most, fabs(m[n * i + i]));
    if (largest) *largest = most;
    return lowest;
}

/* ---- main -------------------------------------------------------------------------------------------------------- */

static int print_summary(void) {
    printf("%d passed, %d failed\n", passed, failed);
    fflush(stdout);
    return failed ? 1 : 0;
}

/* A crash still names its test and leaves a count: not strictly allowed in a handler, but all is lost anyway. */
static void on_crash(int number) {
    failed++;
    printf("FAILED %s: signal %d\n", current, number);
    _Exit(print_summary());
}

/* Unless somebody else, a sanitizer for instance, has already taken the signal. */
static void catch_crash(int number) {
    void (*before)(int) = signal(number, on_crash);
    if (before != SIG_DFL) signal(number, before);
}

static void run(const test_entry *entry, int show_time) {
    clock_t start = clock();
    current = entry->name, failures = 0;
    entry->function();
    if (failures) failed++;
    else passed++;
    if (failures) printf("FAILED %s: %s", entry->name, first_reason);
    else printf("ok %s", entry->name);
    if (failures > 1) printf(" (and %d more)", failures - 1);
    if (show_time) printf(" (%.2f s)", (double)(clock() - start) / (double)CLOCKS_PER_SEC);
    printf("\n");
    fflush(stdout);
}

/* -word leaves out what contains it; without another word all the rest is chosen. */
static int chosen(const char *name, char **words, int count) {
    int i, found = 0, asked = 0;
    for (i = 0; i < count; i++) {
        if (words[i][0] == '-' && strstr(name, words[i] + 1)) return 0;
        if (words[i][0] == '-') continue;
        asked++, found = found || strstr(name, words[i]) != NULL;
    }
    return found || !asked;
}

int main(int count, char **words) {
    const test_entry *entry;
    int list = 0, show_time = 0, matched = 0;
    for (count--, words++; count > 0 && !strncmp(*words, "--", 2); count--, words++) {
        if (!strcmp(*words, "--list")) list = 1;
        else if (!strcmp(*words, "--time")) show_time = 1;
        else return fprintf(stderr, "usage: tests [--list] [--time] [word | -word ...]\n"), 2;
    }
    catch_crash(SIGSEGV), catch_crash(SIGFPE), catch_crash(SIGILL), catch_crash(SIGABRT);
    for (entry = entries; entry->name; entry++) {
        if (!chosen(entry->name, words, count)) continue;
        matched++;
        if (list) printf("%s\n", entry->name);
        else run(entry, show_time);
    }
    if (list) return 0;
    if (!matched) failed++, printf("FAILED: no test matches\n");
    return print_summary();
}
