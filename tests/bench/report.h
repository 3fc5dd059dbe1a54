/* What a benchmark prints, to the terminal and to out/bench-NAME.txt, and the goals it counts. For the one file of a
 * benchmark that has main(). */
#ifndef BENCH_REPORT_H
#define BENCH_REPORT_H

#include <stdarg.h>
#include <stdio.h>

static struct {
    const char *name; /* "bench-woven" */
    FILE *record;
    int goals, met;
    double worst; /* reached share */
    char which[96];
} tally;

static void report_open(const char *name) {
    char path[64];
    snprintf(path, sizeof path, "out/%s.txt", name);
    tally.name = name, tally.record = fopen(path, "w");
}

static void say(const char *format, ...) {
    va_list args;
    va_start(args, format), vprintf(format, args), va_end(args);
    fflush(stdout);
    if (!tally.record) return;
    va_start(args, format), vfprintf(tally.record, format, args), va_end(args);
    fflush(tally.record);
}

/* A goal is met at a share of 1; one that could not be measured has the share 0 or NaN. */
static void count_goal(const char *name, const char *what, double share) {
    if (!(share >= 0.0)) share = 0.0;
    tally.goals++, tally.met += share >= 1.0;
    if (share >= tally.worst && tally.goals > 1) return;
    tally.worst = share;
    snprintf(tally.which, sizeof tally.which, "%s, %s", name, what);
}

static void report_close(void) {
    say("%s: %d of %d goals met, worst %.2f (%s)\n", tally.name, tally.met, tally.goals, tally.worst, tally.which);
    if (tally.record) fclose(tally.record);
}

#endif
