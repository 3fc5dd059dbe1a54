/* bench-mixed: the mixed solver against the preconditioners it could have instead.
 *
 *   bench-mixed [--quick] [convergence ...]     only these parts
 *
 * Convergence (MIX Fig. 2). Linear systems out of a running scene, tests/scenes/systems.h: a crimped swatch that swings
 * about one edge and has just met a ball; the first Newton iteration of a step. Conjugate gradients solve for the
 * change of velocity with every smoother, alone ("one") and with the coarse space ("two"). Counted are iterations until
 * the velocity of the yarns and that of the vertices are off by no more than 1e-1, 1e-2 and 1e-4 of that change, as
 * against the solution to rounding; more than the limit of a row are ">".
 *   sweep    7,200 yarn nodes with 25, 100 and 400 of them on a triangle, yarns 1, 10 and 100 times as stiff as those
 *            of MIX (1e7 Pa), steps of 0.1, 1 and 5 ms
 *   growth   100 nodes a triangle, 10 times as stiff: 5,000, 20,000 and 80,000 yarn nodes
 *   shirt    as many yarn nodes as the region of MIX's shirt, at its stiffness
 * The short form has 2,450 to 7,200 nodes in the sweep, of one stiffness, no more than 20,000 else, and no shirt.
 * Goals, for the two levels of the incomplete factor, which are the default: at most 20 iterations to 1e-2 at 0.1 ms
 * and 60 at 1 and 5 ms, never more than with P of MIX alone, in the median ten times fewer, and at most 1.5 times more
 * with 80,000 nodes than with 5,000. Where P meets its limit of iterations, that stands for its number.
 * The dense form of P, whose iterations are those of the sparse one, is left out where its matrix has more than 1,000
 * rows.
 *
 * Rows are kept in out/bench-mixed-convergence.txt, and those found there are not measured again: remove it after a
 * change of the library. */
#define _POSIX_C_SOURCE 200809L /* NOLINT(bugprone-reserved-identifier): what POSIX prescribes */
#include "../internals.h"
#include "bench.h"
#include "report.h"
#include "../scenes/systems.h"
#include <math.h>

static int quick;

/* ---- rows -------------------------------------------------------------------------------------------------------- */

enum { SMOOTHERS = YC_SMOOTHER_NONE + 1, WAYS = 2 * SMOOTHERS, DEFAULT = 0, PAPER = SMOOTHERS + YC_SMOOTHER_MASS };

/* What was measured of one system; `at` by way: two levels of every smoother, then one. */
typedef struct row {
    system_desc desc;
    double h;
    int limit; /* of iterations */
    int full, hybrid, vertices, touching, skipped;
    int at[WAYS][SYSTEM_MARKS]; /* -1: not within the limit */
} row;

static const char *const kept = "out/bench-mixed-convergence.txt";

static void row_key(const row *r, char key[96]) {
    snprintf(key, 96, "%d %d %g %g %d", r->desc.cells, r->desc.per_triangle, r->desc.stretch, r->h, r->limit);
}

/* Whether the row is in the file. */
static int row_find(row *r) {
    FILE *file = fopen(kept, "r");
    char line[2048], key[96], *at;
    int found = 0, k, used;
    row_key(r, key);
    while (file && !found && fgets(line, sizeof line, file)) {
        if (strncmp(line, key, strlen(key)) != 0 || line[strlen(key)] != ':') continue;
        at = line + strlen(key) + 1;
        found =
            sscanf(at, "%d %d %d %d %d%n", &r->full, &r->hybrid, &r->vertices, &r->touching, &r->skipped, &used) == 5;
        for (k = 0; k < WAYS * SYSTEM_MARKS && found; k++)
            at += used, found = sscanf(at, "%d%n", &r->at[k / SYSTEM_MARKS][k % SYSTEM_MARKS], &used) == 1;
    }
    if (file) fclose(file);
    return found;
}

static void row_keep(const row *r) {
    FILE *file = fopen(kept, "a");
    char key[96];
    int k;
    if (!file) return;
    row_key(r, key);
    fprintf(file, "%s: %d %d %d %d %d", key, r->full, r->hybrid, r->vertices, r->touching, r->skipped);
    for (k = 0; k < WAYS * SYSTEM_MARKS; k++) fprintf(file, " %d", r->at[k / SYSTEM_MARKS][k % SYSTEM_MARKS]);
    fprintf(file, "\n");
    fclose(file);
}

static yc_result row_measure(row *r, system_scene *s) {
    const yci_model *m;
    int k;
    yc_result result = system_take(s, r->h);
    if (result != YC_OK) return result;
    m = s->scene->model;
    r->full = m->full, r->hybrid = m->hybrid, r->touching = m->touch_count;
    r->vertices = m->system.a.n - m->full - m->hybrid;
    r->skipped = m->system.mixed.t_count + 2 * m->system.mixed.free_count > 1000;
    for (k = 0; k < WAYS; k++) {
        yc_smoother smoother = (yc_smoother)(k % SMOOTHERS);
        if (smoother == YC_SMOOTHER_MASS_DENSE && r->skipped) continue;
        result = system_prepare(s, k < SMOOTHERS ? YC_SOLVER_TWO_LEVEL : YC_SOLVER_ONE_LEVEL, smoother);
        if (result != YC_OK) return result;
        system_converge(s, r->limit, r->at[k]);
    }
    return YC_OK;
}

static void row_print(const row *r) {
    static const char *const names[SMOOTHERS] = {"incomplete", "line", "block", "P", "P dense", "diagonal", "none"};
    int k, i;
    say("\n%d + %d yarn nodes, %d vertices, %d touch; %d per triangle, %g Pa, %g ms, limit %d\n", r->full, r->hybrid,
        r->vertices, r->touching, r->desc.per_triangle, 1e7 * r->desc.stretch, 1e3 * r->h, r->limit);
    for (k = 0; k < WAYS; k++) {
        if (k % SMOOTHERS == 0) say("  %s", k ? "one" : "two");
        say("  %s", names[k % SMOOTHERS]);
        if (k % SMOOTHERS == YC_SMOOTHER_MASS_DENSE && r->skipped) say(" -");
        for (i = 0; i < SYSTEM_MARKS && !(k % SMOOTHERS == YC_SMOOTHER_MASS_DENSE && r->skipped); i++)
            if (r->at[k][i] < 0) say("%s>", i ? "/" : " ");
            else say("%s%d", i ? "/" : " ", r->at[k][i]);
        if (k % SMOOTHERS == SMOOTHERS - 1) say("\n");
    }
}

/* ---- goals ------------------------------------------------------------------------------------------------------- */

/* Iterations to 1e-2, the limit where there were more; an iteration is the least. */
static double to_percent(const row *r, int way) { return r->at[way][1] < 0 ? r->limit : fmax(1.0, r->at[way][1]); }

static double against_paper[256]; /* how many times fewer iterations than P */
static int against_count;

static void row_goals(const row *r) {
    char name[96];
    double own = r->at[DEFAULT][1] < 0 ? HUGE_VAL : to_percent(r, DEFAULT), fewer = to_percent(r, PAPER) / own;
    snprintf(name, sizeof name, "%d nodes, %d per triangle, %g Pa, %g ms", r->full + r->hybrid, r->desc.per_triangle,
        1e7 * r->desc.stretch, 1e3 * r->h);
    count_goal(name, "iterations", (r->h < 5e-4 ? 20.0 : 60.0) / own);
    count_goal(name, "no more than P", fewer);
    if (against_count < 256) against_paper[against_count++] = fewer;
}

/* ---- convergence ------------------------------------------------------------------------------------------------- */

static const double steps[] = {1e-4, 1e-3, 5e-3};

/* The rows of one scene, which is run when one of them is missing; their iterations to 1e-2 by default into `own`. */
static void measure(system_desc d, int limit, double own[3]) {
    system_scene *s = NULL;
    int k;
    for (k = 0; k < 3; k++) {
        row r;
        yc_result result = YC_OK;
        memset(&r, 0, sizeof r), memset(r.at, -1, sizeof r.at);
        r.desc = d, r.h = steps[k], r.limit = limit;
        if (!row_find(&r)) {
            if (!s) s = system_scene_new(&d);
            result = s && s->scene ? row_measure(&r, s) : YC_ERROR_MEMORY;
            if (result == YC_OK) row_keep(&r);
        }
        if (result == YC_OK) row_print(&r);
        else
            say("\n%d per triangle, %g Pa, %g ms: failed, %s\n", d.per_triangle, 1e7 * d.stretch, 1e3 * r.h,
                !s             ? "out of memory"
                    : s->scene ? yc_scene_message(s->scene)
                               : s->message);
        row_goals(&r);
        own[k] = r.at[DEFAULT][1] < 0 ? HUGE_VAL : to_percent(&r, DEFAULT);
    }
    system_scene_free(s);
}

static void convergence(void) {
    static const int per[] = {25, 100, 400}, all[] = {14, 8, 5}, few[] = {9, 6, 5}, sizes[] = {7, 12, 22};
    double own[3], first[3] = {0.0, 0.0, 0.0}, stretch;
    system_desc d = system_desc_default();
    int i, k, limit = quick ? 1000 : 2000;
    say("iterations to a velocity error of 1e-1/1e-2/1e-4\n\nsweep\n");
    for (i = 0; i < 3; i++)
        for (stretch = quick ? 10.0 : 1.0; stretch <= (quick ? 10.0 : 100.0); stretch *= 10.0) {
            d.per_triangle = per[i], d.cells = (quick ? few : all)[i], d.stretch = stretch;
            measure(d, limit, own);
        }
    say("\ngrowth\n");
    d = system_desc_default(), d.stretch = 10.0;
    for (i = 0; i < (quick ? 2 : 3); i++) {
        d.cells = sizes[i];
        measure(d, limit, own);
        for (k = 0; k < 3 && !i; k++) first[k] = own[k];
        for (k = 0; k < 3 && i == (quick ? 1 : 2); k++) {
            char name[32];
            say("%g times the iterations at %g ms\n", own[k] / first[k], 1e3 * steps[k]);
            snprintf(name, sizeof name, "%g ms", 1e3 * steps[k]);
            count_goal(name, "growth", 1.5 * first[k] / own[k]);
        }
    }
    if (!quick) {
        say("\nshirt\n");
        d = system_desc_default(), d.cells = 29;
        measure(d, limit, own);
    }
    i = against_count;
    stretch = i ? bench_quantile(against_paper, i, 0.5) : 0.0;
    say("\n%.3g times fewer than P in the median of %d\n", stretch, i);
    count_goal("P", "ten times fewer in the median", 0.1 * stretch);
}

int main(int argc, char **argv) {
    int i, all = 1;
    for (i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0) quick = 1;
        else all = 0;
    }
    report_open("bench-mixed");
    for (i = 1; i < argc && !all; i++)
        if (strcmp(argv[i], "convergence") == 0) convergence();
    if (all) convergence();
    report_close();
    return 0;
}
