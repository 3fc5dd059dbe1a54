/* What the two programs of bench-direct share: the matrices, the messages between them, and the one procedure that
 * measures every solver, ours and theirs, so that all are measured alike. */
#ifndef DIRECT_H
#define DIRECT_H

#include "../bench.h"
#include <math.h>

/* ---- matrices: matrices.c ---------------------------------------------------------------------------------------- */

typedef enum matrix_kind {
    MATRIX_MASS,  /* B'B of random points in the triangles of a mesh, one unknown per vertex */
    MATRIX_CLOTH, /* 3x3 blocks: mass, a spring along each edge, a hinge across each edge */
    MATRIX_YARN,  /* 3x3 blocks: nine-point grid and second neighbours along both yarns */
    MATRIX_PAIR,  /* [[Mv, G], [G, -K]], quasi-definite, the two unknowns of a vertex side by side */
    MATRIX_DENSE  /* random numbers */
} matrix_kind;

#define RIGHT_SIDES 3     /* at most: solved together */
#define ACCURACY_SIDES 21 /* by which the error is judged; only the first RIGHT_SIDES where n is above the next */
#define ACCURACY_MOST 200000

/* A sparse matrix is its lower triangle by rows, which is as well its upper triangle by columns. `own` are the values
 * for us. Only MATRIX_PAIR has others: some of its Mv are zero, which breaks scalar pivots, so a rival's L D L' gets
 * `ldl` with all Mv positive, and a rival's L L' gets `ll`, a positive definite matrix of the same pattern. A dense
 * matrix is its rows in `own`. */
typedef struct matrix {
    matrix_kind kind;
    int n, block;
    int *ptr, *col; /* NULL: dense */
    double *own, *ll, *ldl;
    int sides; /* a multiple of RIGHT_SIDES */
    double *b; /* sides times n */
} matrix;

/* Meshes and grids of width x height vertices, dense matrices of width x width. A jittered mesh has vertices off the
 * grid, the Delaunay diagonal in each cell and random numbers; a regular one has one direction of diagonals and rows
 * in order. */
void matrix_make(matrix *m, matrix_kind kind, int jittered, int width, int height);
void matrix_free(matrix *m);

static inline size_t matrix_entries(const matrix *m) {
    return m->ptr ? (size_t)m->ptr[m->n] : (size_t)m->n * (size_t)m->n;
}

/* ---- measuring --------------------------------------------------------------------------------------------------- */

/* FIRST is the first numeric factorisation after an analysis, FACTOR every further one. */
enum { ANALYSE, FIRST, FACTOR, SOLVE1, SOLVE3, PHASES };

#define NOT_MEASURED (-1.0)

/* The functions return 0 for success. `state`: 0 nothing or failed, 1 analysed, 2 with a factor of half the matrix, 3
 * with a factor of the matrix. */
typedef struct solver {
    int (*analyse)(struct solver *s);             /* timed, after release(s, 1) */
    int (*renew)(struct solver *s);               /* not timed: to an analysis without numbers */
    void (*prepare)(struct solver *s);            /* not timed, before every factorisation; or NULL */
    int (*factor)(struct solver *s, int halved);  /* timed */
    int (*solve)(struct solver *s, int count);    /* timed: from the b of the matrix to a place of its own */
    const double *(*solution)(struct solver *s);  /* that place */
    void (*release)(struct solver *s, int whole); /* the numbers, or the analysis with them */
    int from; /* right-hand side of the matrix that is the first to be solved with */
    int state;
} solver;

static inline int solver_run(solver *s, int phase) {
    int failed;
    if (phase > FACTOR) return s->solve(s, phase == SOLVE1 ? 1 : RIGHT_SIDES);
    failed = phase == ANALYSE ? s->analyse(s) : s->factor(s, phase == FIRST);
    s->state = failed ? 0 : phase == ANALYSE ? 1 : phase == FIRST ? 2 : 3;
    return failed;
}

/* What is done before each run of a phase, outside its time. */
static inline int solver_before(solver *s, int phase) {
    if (phase == ANALYSE) s->release(s, 1);
    if (phase == FIRST && s->renew(s)) return 1;
    if (phase <= FACTOR && phase != ANALYSE && s->prepare) s->prepare(s);
    return 0;
}

/* Seconds of `runs` runs, less what reading the clock costs. */
static inline double solver_batch(solver *s, int phase, int runs) {
    static double cost = -1.0;
    double total = 0.0, begin;
    int apart = phase == ANALYSE || phase == FIRST || (phase == FACTOR && s->prepare), i;
    if (cost < 0.0) {
        double least = 1.0;
        for (i = 0; i < 2000; i++) {
            begin = bench_clock(), begin = bench_clock() - begin;
            if (begin < least) least = begin;
        }
        cost = least;
    }
    if (!apart) {
        if (solver_before(s, phase)) return HUGE_VAL;
        begin = bench_clock();
        for (i = 0; i < runs; i++)
            if (solver_run(s, phase)) return HUGE_VAL;
        return bench_clock() - begin - cost;
    }
    for (i = 0; i < runs; i++) {
        if (solver_before(s, phase)) return HUGE_VAL;
        begin = bench_clock();
        if (solver_run(s, phase)) return HUGE_VAL;
        total += bench_clock() - begin - cost;
    }
    return total;
}

/* Seconds of one run. What takes below 0.2 s is run once before, and then as often as makes 2 ms. */
static inline double solver_time(solver *s, int phase) {
    double once = solver_batch(s, phase, 1), total;
    int runs;
    if (once >= 0.2) return once;
    for (runs = 1; runs < 1 << 24; runs *= 2) {
        total = solver_batch(s, phase, runs);
        if (total >= 2e-3) return total / (double)runs;
    }
    return HUGE_VAL;
}

/* One turn: measures the phases whose bits are set, doing what they need without measuring it. HUGE_VAL:
 * the solver failed there. */
static inline void solver_measure(solver *s, unsigned phases, double seconds[PHASES]) {
    int p, failed = 0;
    for (p = 0; p < PHASES; p++) {
        int wanted = (phases >> p & 1u) != 0;
        seconds[p] = NOT_MEASURED;
        if (phases >> p == 0) continue; /* nothing more is asked for */
        if (failed && wanted) {
            seconds[p] = HUGE_VAL;
        } else if (wanted) {
            seconds[p] = solver_time(s, p);
            failed = seconds[p] == HUGE_VAL;
        } else if (!failed && ((p == ANALYSE && s->state < 1) || (p == FACTOR && s->state < 2))) {
            failed = (p == FACTOR && s->renew(s)) || solver_before(s, p) || solver_run(s, p);
        }
    }
}

/* All right-hand sides of a matrix, after a measurement; x has sides * n numbers. */
static inline int solver_all(solver *s, int n, int sides, double *x) {
    size_t part = (size_t)n * RIGHT_SIDES;
    int failed = 0;
    for (s->from = 0; s->from < sides && !failed; s->from += RIGHT_SIDES, x += part) {
        failed = s->solve(s, RIGHT_SIDES);
        if (!failed) memcpy(x, s->solution(s), part * sizeof *x);
    }
    s->from = 0;
    return failed;
}

/* ---- messages between the programs ------------------------------------------------------------------------------- */

/* The rivals that the second program knows. */
enum {
    SUPER_AMD, /* CHOLMOD, supernodal L L' */
    SUPER_METIS,
    SUPER_NESDIS,
    SIMPLICIAL_AMD, /* CHOLMOD, simplicial L D L' */
    SIMPLICIAL_METIS,
    SIMPLICIAL_NESDIS,
    EIGEN_LLT, /* Eigen, simplicial, AMD */
    EIGEN_LDLT,
    SPARSE_RIVALS,
    LU_OPENBLAS = SPARSE_RIVALS,
    LU_EIGEN,
    RIVALS
};

/* After a command to load come n + 1 of ptr and the entries of col, ll and ldl, or the n x n numbers of a dense matrix;
 * then b. */
typedef struct command {
    int verb; /* 'L' load a matrix, 'M' measure */
    int rival;
    unsigned phases; /* none: let go of everything that this rival keeps */
    int solution;    /* send it after the answer, if there is one */
    int n, dense, sides;
} command;

typedef struct answer {
    int threads;  /* of the rival's process: must be 1 */
    int solution; /* n * sides numbers follow */
    double seconds[PHASES];
    char kernels[32]; /* of OpenBLAS */
} answer;

#endif
