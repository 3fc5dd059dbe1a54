/* bench-direct: our direct solvers against the established ones, on one thread.
 *
 *   bench-direct [--quick] [--rounds N] [word ...]     only the cases whose names contain one of the words; a word
 *                                                      that ends in a digit must be the end of the name
 *
 * Rivals: CHOLMOD, supernodal L L' and simplicial L D L', each ordered by AMD, METIS and NESDIS; Eigen's SimplicialLLT
 * and SimplicialLDLT (AMD); for dense LU OpenBLAS (dgetrf, dgetrs) and Eigen's PartialPivLU. They run in processes of
 * their own, one for each set of kernels OpenBLAS has for this machine, and only one process works at a time. There is
 * one thread: OPENBLAS_NUM_THREADS is 1 and CHOLMOD's parallel regions are replaced by direct calls. CHOLMOD keeps the
 * readings of the clock that it makes by itself. We are compiled as users compile us, Eigen with -march=native.
 *
 * Phases. analyse: the ordering and everything symbolic, from the pattern to an object that can factor. first: the
 * first numeric factorisation after it, with its allocations. factor: every further one, with other values in the same
 * object; this is what the goals for a factorisation mean, on both sides. solve 1 and solve 3: with 1 and 3 right-hand
 * sides, the copy of b into place included where a solver works in place. Dense factorisations do not count the copy
 * of A that the rivals, which work in place, need, though ours includes one.
 *
 * A round measures us and every rival in turn, all by solver_measure(): a run to warm up, then as many as make 2 ms; a
 * run longer than 0.2 s counts as it is. Seconds are processor time of the thread. The best rival of a phase is the
 * one with the lowest median over the rounds, chosen for each phase alone; the ratio is the median over the rounds of
 * ours to that rival's in the same round, and +- half its interquartile range. There are 7 rounds, 11 where nothing
 * takes longer than 10 ms. Every case has one more goal, its error.
 *
 * A rival leaves the race in a phase where the better of its first two rounds is more than twice the best of all, or
 * its first more than 1.5 times and longer than 0.5 s. Where a supernodal factorisation takes longer than 0.3 s, of
 * the simplicial rivals only the analyses after AMD are compared: with 50,000 vertices of cloth and with a million of
 * a mesh their factorisations took 15 to 40 times as long as supernodal ones, and their solves at least 0.9 (three
 * right-hand sides: 0.8) times as long.
 *
 * Accuracy: the largest |Ax - b| / (|A| |x| + |b|) of 21 right-hand sides (above 200,000 unknowns of three), in the
 * maximum norm, the residual in long double, so that it is no matter of luck. The goal is to stay below 4e-15 and below
 * twice that of CHOLMOD (dense: OpenBLAS) with the same right-hand sides, in its most accurate setting. */
#define _POSIX_C_SOURCE 200809L /* NOLINT(bugprone-reserved-identifier): what POSIX prescribes */
#include "direct/direct.h"
#include "report.h"
#include "yarncloth.h"
#include <errno.h>
#include <signal.h>
#include <unistd.h>

#define MOST_ROUNDS 31
#define MOST_WORKERS 3
#define MOST_SETTINGS 32
#define BOUND 4e-15

static const char *const phase_name[PHASES] = {"analyse", "first", "factor", "solve 1", "solve 3"};

/* ---- cases and goals --------------------------------------------------------------------------------------------- */

typedef struct {
    const char *name;
    matrix_kind kind;
    int jittered, width, height;
    int quick;           /* part of the short form */
    double goal[PHASES]; /* ours / best rival; 0: none */
} bench_case;

static const bench_case cases[] = {
    {"btb-regular-100", MATRIX_MASS, 0, 10, 10, 1, {0.70, 0, 0.40, 0.60, 0.50}},
    {"btb-jittered-100", MATRIX_MASS, 1, 10, 10, 1, {0.70, 0, 0.40, 0.60, 0.50}},
    {"btb-regular-1000", MATRIX_MASS, 0, 25, 40, 1, {0.70, 0, 0.25, 0.50, 0.45}},
    {"btb-jittered-1000", MATRIX_MASS, 1, 25, 40, 1, {0.70, 0, 0.25, 0.50, 0.45}},
    {"btb-regular-10000", MATRIX_MASS, 0, 100, 100, 0, {0.65, 0, 0.22, 0.45, 0.40}},
    {"btb-jittered-10000", MATRIX_MASS, 1, 100, 100, 1, {0.65, 0, 0.22, 0.45, 0.40}},
    {"btb-regular-100000", MATRIX_MASS, 0, 250, 400, 0, {0.60, 0, 0.33, 0.40, 0.40}},
    {"btb-jittered-100000", MATRIX_MASS, 1, 250, 400, 0, {0.60, 0, 0.33, 0.40, 0.40}},
    {"btb-jittered-1000000", MATRIX_MASS, 1, 1000, 1000, 0, {0, 0, 0, 0, 0}},
    {"cloth-1000", MATRIX_CLOTH, 1, 25, 40, 1, {0.40, 0, 0.28, 0.45, 0.38}},
    {"cloth-10000", MATRIX_CLOTH, 1, 100, 100, 0, {0.33, 0, 0.38, 0.45, 0.40}},
    {"cloth-50000", MATRIX_CLOTH, 1, 200, 250, 0, {0.27, 0, 0.48, 0.55, 0.45}},
    {"yarn-5000", MATRIX_YARN, 0, 50, 100, 1, {0.30, 0, 0.35, 0.45, 0.40}},
    {"yarn-20000", MATRIX_YARN, 0, 100, 200, 0, {0.20, 0, 0.45, 0.50, 0.45}},
    {"pair-60", MATRIX_PAIR, 1, 6, 10, 1, {0.70, 0, 0.40, 0.50, 0.45}},
    {"pair-250", MATRIX_PAIR, 1, 10, 25, 1, {0.70, 0, 0.40, 0.50, 0.45}},
    {"pair-1000", MATRIX_PAIR, 1, 25, 40, 1, {0.70, 0, 0.40, 0.50, 0.45}},
    {"pair-4000", MATRIX_PAIR, 1, 50, 80, 0, {0.70, 0, 0.40, 0.50, 0.45}},
    {"lu-60", MATRIX_DENSE, 0, 60, 1, 1, {0, 0, 0.45, 0.65, 0.60}},
    {"lu-200", MATRIX_DENSE, 0, 200, 1, 1, {0, 0, 0.45, 0.50, 0.45}},
    {"lu-700", MATRIX_DENSE, 0, 700, 1, 1, {0, 0, 0.55, 0.60, 0.40}},
    {"lu-1500", MATRIX_DENSE, 0, 1500, 1, 0, {0, 0, 0.65, 0.75, 0.40}},
    {"lu-3000", MATRIX_DENSE, 0, 3000, 1, 0, {0, 0, 0.72, 0.75, 0.45}},
};

static void stop(const char *why) {
    fprintf(stderr, "bench-direct: %s\n", why);
    exit(1);
}

/* ---- ours -------------------------------------------------------------------------------------------------------- */

typedef struct {
    solver base; /* first: the one is cast to the other */
    const matrix *m;
    yc_chol *chol;
    yc_lu *lu;
    double *half, *x;
} ours;

static void ours_release(solver *s, int whole) {
    ours *o = (ours *)s;
    if (!whole && s->state < 2) return;
    yc_chol_destroy(o->chol), yc_lu_destroy(o->lu);
    o->chol = NULL, o->lu = NULL, s->state = 0;
}

static int ours_analyse(solver *s) {
    ours *o = (ours *)s;
    yc_chol_options options;
    if (o->m->kind == MATRIX_DENSE) return yc_lu_create(NULL, o->m->n, &o->lu);
    yc_chol_options_default(&options);
    options.block = o->m->block;
    if (o->m->kind == MATRIX_PAIR) options.kind = YC_CHOL_QUASIDEFINITE;
    return yc_chol_analyze(NULL, o->m->n, o->m->ptr, o->m->col, &options, &o->chol);
}

static int ours_renew(solver *s) {
    if (s->state == 1) return 0;
    ours_release(s, 1);
    return ours_analyse(s);
}

static int ours_factor(solver *s, int halved) {
    ours *o = (ours *)s;
    if (o->lu) return yc_lu_factor(o->lu, o->m->own, o->m->n);
    return yc_chol_factor(o->chol, halved ? o->half : o->m->own);
}

static int ours_solve(solver *s, int count) {
    ours *o = (ours *)s;
    size_t n = (size_t)o->m->n;
    memcpy(o->x, o->m->b + n * (size_t)s->from, n * (size_t)count * sizeof(double));
    return o->lu ? yc_lu_solve(o->lu, o->x, count, o->m->n) : yc_chol_solve(o->chol, o->x, count, o->m->n);
}

/* Nothing: where the rivals need a copy before each run, our runs are measured one by one as well. */
static void ours_prepare(solver *s) { (void)s; }

static const double *ours_solution(solver *s) { return ((ours *)s)->x; }

static void ours_make(ours *o, const matrix *m) {
    size_t entries = matrix_entries(m), k;
    memset(o, 0, sizeof *o);
    o->base.analyse = ours_analyse, o->base.renew = ours_renew, o->base.factor = ours_factor;
    o->base.solve = ours_solve, o->base.solution = ours_solution, o->base.release = ours_release;
    if (m->kind == MATRIX_DENSE) o->base.prepare = ours_prepare;
    o->m = m, o->x = BENCH_NEW(double, (size_t)m->n *RIGHT_SIDES), o->half = BENCH_NEW(double, entries);
    for (k = 0; k < entries; k++) o->half[k] = 0.5 * m->own[k];
}

/* ---- rivals' processes ------------------------------------------------------------------------------------------- */

typedef struct {
    int to, from; /* pipes */
    char kernels[32];
} worker;

typedef struct {
    int worker, rival;
    char name[64];
    unsigned phases; /* in which it is still in the race */
    int gone;        /* from all, and its memory is free */
    double seconds[PHASES][MOST_ROUNDS], error;
} setting;

static worker workers[MOST_WORKERS];
static int worker_count;
static setting settings[MOST_SETTINGS];
static int setting_count;

static void give(const worker *w, const void *from, size_t bytes) {
    const char *p = (const char *)from;
    while (bytes) {
        ssize_t put = write(w->to, p, bytes);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) stop("the rivals' program has ended");
        p += put, bytes -= (size_t)put;
    }
}

static void take(const worker *w, void *to, size_t bytes) {
    char *p = (char *)to;
    while (bytes) {
        ssize_t got = read(w->from, p, bytes);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) stop("the rivals' program has ended");
        p += got, bytes -= (size_t)got;
    }
}

static void take_answer(const worker *w, answer *a) {
    take(w, a, sizeof *a);
    if (a->threads != 1) stop("a rival runs more than one thread: the comparison would not be sound");
}

/* Starts the rivals with a set of OpenBLAS's kernels, NULL for its own choice; those that run already are not started
 * twice. Cooperlake's differ from SkylakeX's in single precision alone. */
static void worker_start(const char *program, const char *kernels) {
    worker *w = &workers[worker_count];
    int to[2], from[2], i;
    pid_t child;
    answer hello;
    if (pipe(to) || pipe(from)) stop("no pipe");
    child = fork();
    if (child < 0) stop("no process");
    if (child == 0) {
        if (dup2(to[0], STDIN_FILENO) < 0 || dup2(from[1], STDOUT_FILENO) < 0) _exit(1);
        close(to[0]), close(to[1]), close(from[0]), close(from[1]);
        for (i = 0; i < worker_count; i++) close(workers[i].to), close(workers[i].from);
        setenv("OPENBLAS_NUM_THREADS", "1", 1), setenv("OMP_NUM_THREADS", "1", 1);
        if (kernels) setenv("OPENBLAS_CORETYPE", kernels, 1);
        else unsetenv("OPENBLAS_CORETYPE");
        execl(program, program, (char *)NULL);
        _exit(1);
    }
    close(to[0]), close(from[1]);
    w->to = to[1], w->from = from[0];
    take_answer(w, &hello);
    memcpy(w->kernels, hello.kernels, sizeof w->kernels);
    for (i = 0; i < worker_count; i++)
        if (!strcmp(workers[i].kernels, w->kernels) ||
            (!strcmp(workers[i].kernels, "SkylakeX") && !strcmp(w->kernels, "Cooperlake"))) {
            close(w->to), close(w->from);
            return;
        }
    worker_count++;
}

static void workers_start(const char *program) {
#if defined(__GNUC__) && defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) worker_start(program, "Haswell");
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
        worker_start(program, "SkylakeX");
#endif
    worker_start(program, NULL);
}

static void workers_load(const matrix *m) {
    size_t entries = matrix_entries(m);
    command c;
    int i;
    memset(&c, 0, sizeof c);
    c.verb = 'L', c.n = m->n, c.dense = m->kind == MATRIX_DENSE, c.sides = m->sides;
    for (i = 0; i < worker_count; i++) {
        const worker *w = &workers[i];
        give(w, &c, sizeof c);
        if (c.dense) {
            give(w, m->own, entries * sizeof(double));
        } else {
            give(w, m->ptr, (size_t)(m->n + 1) * sizeof(int)), give(w, m->col, entries * sizeof(int));
            give(w, m->ll, entries * sizeof(double)), give(w, m->ldl, entries * sizeof(double));
        }
        give(w, m->b, (size_t)m->n * (size_t)m->sides * sizeof(double));
    }
}

/* All that a matrix is compared with. What does not call OpenBLAS's kernels runs in one process only; so do the
 * analyses. */
static void settings_make(int dense) {
    static const char *const names[RIVALS] = {"CHOLMOD super AMD", "CHOLMOD super METIS", "CHOLMOD super NESDIS",
        "CHOLMOD simpl AMD", "CHOLMOD simpl METIS", "CHOLMOD simpl NESDIS", "Eigen LLT", "Eigen LDLT", "OpenBLAS",
        "Eigen PartialPivLU"};
    int rival, w, begin = dense ? SPARSE_RIVALS : 0, end = dense ? RIVALS : SPARSE_RIVALS;
    setting_count = 0;
    for (rival = begin; rival < end; rival++)
        for (w = 0; w < worker_count; w++) {
            int kernels = rival <= SUPER_NESDIS || rival == LU_OPENBLAS;
            setting *s = &settings[setting_count];
            if (w && !kernels) continue;
            memset(s, 0, sizeof *s);
            s->worker = w, s->rival = rival, s->error = HUGE_VAL;
            s->phases = dense ? 1u << FACTOR | 1u << SOLVE1 | 1u << SOLVE3 : (1u << PHASES) - 1u - (w ? 1u : 0u);
            snprintf(s->name, sizeof s->name, kernels ? "%s %s" : "%s", names[rival], workers[w].kernels);
            setting_count++;
        }
}

/* ---- judging ----------------------------------------------------------------------------------------------------- */

/* |Ax - b| / (|A| |x| + |b|), the worst right-hand side. */
static double backward_error(const matrix *m, const double *values, const double *x) {
    long double *residual = (long double *)bench_alloc((size_t)m->n, sizeof *residual);
    double *sum = BENCH_NEW(double, m->n), norm = 0.0, worst = 0.0;
    int i, j, k;
    for (i = 0; i < m->n; i++)
        for (k = m->ptr ? m->ptr[i] : 0; k < (m->ptr ? m->ptr[i + 1] : m->n); k++) {
            double size = fabs(values[m->ptr ? (size_t)k : (size_t)i * (size_t)m->n + (size_t)k]);
            sum[i] += size;
            if (m->ptr && m->col[k] != i) sum[m->col[k]] += size;
        }
    for (i = 0; i < m->n; i++) norm = sum[i] > norm ? sum[i] : norm;
    for (j = 0; j < m->sides; j++) {
        const double *b = m->b + (size_t)j * (size_t)m->n, *y = x + (size_t)j * (size_t)m->n;
        double most = 0.0, size = 0.0, right = 0.0, error;
        for (i = 0; i < m->n; i++) residual[i] = -(long double)b[i];
        for (i = 0; i < m->n; i++)
            for (k = m->ptr ? m->ptr[i] : 0; k < (m->ptr ? m->ptr[i + 1] : m->n); k++) {
                int c = m->ptr ? m->col[k] : k;
                long double a = values[m->ptr ? (size_t)k : (size_t)i * (size_t)m->n + (size_t)k];
                residual[i] += a * y[c];
                if (m->ptr && c != i) residual[c] += a * y[i];
            }
        for (i = 0; i < m->n; i++) {
            if (!(fabs(y[i]) < HUGE_VAL)) size = HUGE_VAL, most = HUGE_VAL;
            if (fabsl(residual[i]) > most) most = (double)fabsl(residual[i]);
            if (fabs(y[i]) > size) size = fabs(y[i]);
            if (fabs(b[i]) > right) right = fabs(b[i]);
        }
        error = most < HUGE_VAL ? most / (norm * size + right) : HUGE_VAL;
        worst = error > worst ? error : worst;
    }
    free(residual), free(sum);
    return worst;
}

static double median(const double *values, int count) {
    double sorted[MOST_ROUNDS];
    memcpy(sorted, values, (size_t)count * sizeof *sorted);
    return bench_quantile(sorted, count, 0.5);
}

static double least(const double *values, int count) {
    double best = HUGE_VAL;
    int i;
    for (i = 0; i < count; i++) best = values[i] < best ? values[i] : best;
    return best;
}

/* ---- a case ------------------------------------------------------------------------------------------------------ */

/* One turn of a rival. */
static void rival_turn(setting *s, const matrix *m, int round, double *x) {
    const worker *w = &workers[s->worker];
    command c;
    answer a;
    int p;
    memset(&c, 0, sizeof c);
    c.verb = 'M', c.rival = s->rival, c.phases = s->phases, c.solution = round == 0, c.n = m->n;
    s->gone = !s->phases;
    give(w, &c, sizeof c), take_answer(w, &a);
    if (a.solution) {
        take(w, x, (size_t)m->n * (size_t)m->sides * sizeof(double));
        s->error = backward_error(m, s->rival == EIGEN_LLT || s->rival <= SUPER_NESDIS ? m->ll : m->ldl, x);
    }
    for (p = 0; p < PHASES; p++) {
        s->seconds[p][round] = a.seconds[p];
        if (a.seconds[p] < 0.0 || a.seconds[p] == HUGE_VAL) s->phases &= ~(1u << p);
    }
}

/* After a round, who is too slow to become the best leaves the race. */
static void race(int rounds) {
    int p, i;
    for (p = 0; p < PHASES; p++) {
        double best = HUGE_VAL, mine;
        for (i = 0; i < setting_count; i++)
            if (settings[i].phases >> p & 1u && (mine = least(settings[i].seconds[p], rounds)) < best) best = mine;
        for (i = 0; i < setting_count; i++) {
            if (!(settings[i].phases >> p & 1u)) continue;
            mine = least(settings[i].seconds[p], rounds);
            if ((rounds >= 2 && mine > 2.0 * best) || (mine > 1.5 * best && mine > 0.5))
                settings[i].phases &= ~(1u << p);
        }
    }
}

/* The rival with the lowest median in a phase; -1: none. */
static int best_rival(int phase, int rounds) {
    int best = -1, i;
    for (i = 0; i < setting_count; i++)
        if (settings[i].phases >> phase & 1u &&
            (best < 0 || median(settings[i].seconds[phase], rounds) < median(settings[best].seconds[phase], rounds)))
            best = i;
    return best;
}

/* The rival with the smallest error of those whose names begin with a word; -1: none. */
static int most_accurate(const char *word) {
    int best = -1, i;
    for (i = 0; i < setting_count; i++)
        if (settings[i].error < HUGE_VAL && !strncmp(settings[i].name, word, strlen(word)) &&
            (best < 0 || settings[i].error < settings[best].error))
            best = i;
    return best;
}

static void report_phase(const bench_case *bc, int p, double *seconds, int rounds) {
    int best = best_rival(p, rounds), r;
    double ratio[MOST_ROUNDS], reached, spread, share;
    if (best < 0 || seconds[0] < 0.0) return;
    if (seconds[0] == HUGE_VAL) {
        say("%-21s%-9s%12s\n", bc->name, phase_name[p], "failed");
        if (bc->goal[p] > 0.0) count_goal(bc->name, phase_name[p], 0.0);
        return;
    }
    for (r = 0; r < rounds; r++) ratio[r] = seconds[r] / settings[best].seconds[p][r];
    spread = 0.5 * (bench_quantile(ratio, rounds, 0.75) - bench_quantile(ratio, rounds, 0.25));
    reached = bench_quantile(ratio, rounds, 0.5), share = bc->goal[p] / reached;
    say("%-21s%-9s%12.5f%12.5f  %-30s%6.2f +-%4.2f", bc->name, phase_name[p], 1e3 * median(seconds, rounds),
        1e3 * median(settings[best].seconds[p], rounds), settings[best].name, reached, spread);
    if (bc->goal[p] > 0.0) {
        say("%6.2f  %s", bc->goal[p], share >= 1.0 ? "met" : "missed");
        count_goal(bc->name, phase_name[p], share);
    }
    say("\n");
}

static void report_error(const bench_case *bc, double error) {
    int reference = most_accurate(bc->kind == MATRIX_DENSE ? "OpenBLAS" : "CHOLMOD");
    double theirs = reference < 0 ? HUGE_VAL : settings[reference].error;
    double goal = 2.0 * theirs < BOUND ? 2.0 * theirs : BOUND, share = error < HUGE_VAL ? goal / error : 0.0;
    say("%-21s%-9s%12.1e%12.1e  %-30s%6.2f       %6.2f  %s\n", bc->name, "error", error, theirs,
        reference < 0 ? "" : settings[reference].name, error / theirs, goal / theirs, share >= 1.0 ? "met" : "missed");
    count_goal(bc->name, "error", share);
}

static void run_case(const bench_case *bc, int rounds) {
    matrix m;
    ours own;
    double seconds[PHASES][MOST_ROUNDS], turn[PHASES], error = HUGE_VAL, longest = 0.0, *x;
    unsigned phases = bc->kind == MATRIX_DENSE ? 1u << FACTOR | 1u << SOLVE1 | 1u << SOLVE3 : (1u << PHASES) - 1u;
    int round, p, k;
    matrix_make(&m, bc->kind, bc->jittered, bc->width, bc->height);
    ours_make(&own, &m), workers_load(&m), settings_make(bc->kind == MATRIX_DENSE);
    x = BENCH_NEW(double, (size_t)m.n *(size_t)m.sides);
    for (round = 0; round < rounds; round++) {
        /* The order turns from round to round. The first begins with us and CHOLMOD's supernodal method, whose time
         * says whether the simplicial ones are tried. */
        for (k = 0; k <= setting_count; k++) {
            int turn_of = (k + 3 * round) % (setting_count + 1) - 1, i;
            if (turn_of >= 0) {
                setting *s = &settings[turn_of];
                if (s->gone) continue;
                for (i = 0; round == 0 && s->rival > SUPER_NESDIS && s->rival < SPARSE_RIVALS && i < turn_of; i++)
                    if (settings[i].rival <= SUPER_NESDIS && settings[i].seconds[FIRST][0] > 0.3)
                        s->phases &= s->rival == SIMPLICIAL_AMD || s->rival >= EIGEN_LLT ? 1u << ANALYSE : 0u;
                rival_turn(s, &m, round, x);
                continue;
            }
            solver_measure(&own.base, phases, turn);
            for (p = 0; p < PHASES; p++) {
                seconds[p][round] = turn[p];
                if (turn[p] == HUGE_VAL) phases = 0;
                else if (turn[p] > longest) longest = turn[p];
            }
            if (round == 0) {
                if (own.base.state == 3 && phases && !solver_all(&own.base, m.n, m.sides, x))
                    error = backward_error(&m, m.own, x);
                else say("%-21sours: %s\n", bc->name, own.chol ? yc_chol_message(own.chol) : "no object");
            }
            own.base.release(&own.base, 0);
        }
        race(round + 1);
        for (k = 0; k < setting_count; k++)
            for (p = 0; p < PHASES; p++)
                if (settings[k].seconds[p][round] > longest && settings[k].seconds[p][round] < HUGE_VAL)
                    longest = settings[k].seconds[p][round];
        if (longest < 0.01 && round == 0 && rounds == 7) rounds = 11;
    }
    for (p = 0; p < PHASES; p++) report_phase(bc, p, seconds[p], rounds);
    report_error(bc, error);
    own.base.release(&own.base, 1);
    free(own.half), free(own.x), free(x);
    matrix_free(&m);
}

/* ---- the program ------------------------------------------------------------------------------------------------- */

static void heading(void) {
    char line[256], date[64] = "";
    FILE *f = fopen("/proc/cpuinfo", "r");
    time_t now = time(NULL);
    struct tm *t = localtime(&now);
    int i;
    if (t) strftime(date, sizeof date, "%Y-%m-%d %H:%M", t);
    say("%s, yarncloth %s", date, yc_version());
    while (f && fgets(line, sizeof line, f))
        if (!strncmp(line, "model name", 10) && strchr(line, ':')) {
            line[strcspn(line, "\n")] = 0;
            say(",%s", strchr(line, ':') + 1);
            break;
        }
    if (f) fclose(f);
    say("\none thread, OpenBLAS kernels:");
    for (i = 0; i < worker_count; i++) say(" %s", workers[i].kernels);
    say("\n\n%-21s%-9s%12s%12s  %-30s%6s%13s\n", "case", "phase", "ours, ms", "theirs, ms", "best rival", "ratio",
        "goal");
}

/* A word that ends in a digit means the end of the name as well: btb-jittered-1000 is not 10000. */
static int asked_for(const char *name, const char *word) {
    size_t length = strlen(word);
    const char *at = strstr(name, word);
    if (!at || !length || word[length - 1] < '0' || word[length - 1] > '9') return at != NULL;
    return strlen(name) >= length && !strcmp(name + strlen(name) - length, word);
}

int main(int argc, char **argv) {
    char program[1024];
    int quick = 0, rounds = 7, words = 0, i, k;
    for (i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--quick")) quick = 1;
        else if (!strcmp(argv[i], "--rounds") && i + 1 < argc) rounds = (int)strtol(argv[++i], NULL, 10);
        else argv[1 + words++] = argv[i];
    }
    if (rounds < 1 || rounds > MOST_ROUNDS) stop("--rounds takes 1 to 31");
    signal(SIGPIPE, SIG_IGN);
    snprintf(program, sizeof program, "%s-rivals", argv[0]);
    workers_start(program);
    report_open("bench-direct");
    heading();
    for (k = 0; k < (int)(sizeof cases / sizeof cases[0]); k++) {
        int wanted = !words;
        for (i = 0; i < words; i++) wanted = wanted || asked_for(cases[k].name, argv[1 + i]);
        if (wanted && (cases[k].quick || !quick)) run_case(&cases[k], rounds);
    }
    report_close();
    return 0;
}
