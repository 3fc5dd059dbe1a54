/* The rivals of bench-direct, a program of its own because OpenBLAS reads its settings when it starts. It takes
 * commands on its input and answers on its output. Each rival is at its best: Eigen is compiled for this machine with
 * all its instructions, CHOLMOD gets the triangle that it permutes fastest, workspaces are kept between solves.
 *
 * CHOLMOD opens a parallel region of four threads for every update of a supernode, whatever it is told, which makes it
 * up to four times slower. GOMP_parallel and its kin below replace those of the OpenMP library by direct calls. */
#include "direct.h"
#include <dirent.h>
#include <eigen3/Eigen/LU>
#include <eigen3/Eigen/SparseCholesky>
#include <suitesparse/cholmod.h>
#include <unistd.h>
#include <vector>

extern "C" {
void GOMP_parallel(void (*body)(void *), void *argument, unsigned, unsigned) { body(argument); }
int omp_get_num_threads(void) { return 1; }
int omp_get_thread_num(void) { return 0; }
int omp_get_max_threads(void) { return 1; }
char *openblas_get_corename(void);
void dgetrf_(const int *m, const int *n, double *a, const int *lda, int *pivots, int *info);
void dgetrs_(const char *trans, const int *n, const int *count, const double *a, const int *lda, const int *pivots,
    double *b, const int *ldb, int *info, size_t);
}

namespace {

struct loaded {
    int n = 0, dense = 0, sides = 0;
    std::vector<int> ptr, col, lower_ptr, lower_row; /* upper triangle by columns, lower triangle by columns */
    std::vector<double> ll[2], ldl[2], lower_ldl[2]; /* the matrix, its half */
    std::vector<double> lower_ll[2], columns, b;
};

loaded A;
cholmod_common common;

double *right_sides(const solver *s) { return A.b.data() + static_cast<size_t>(A.n) * static_cast<size_t>(s->from); }

/* What makes a solver deletable. */
struct base : solver {
    base() : solver() {}
    virtual ~base() {}
};

/* ---- CHOLMOD ----------------------------------------------------------------------------------------------------- */

struct cholmod_rival : base {
    int kind, ordering;
    cholmod_sparse matrix[2];
    cholmod_factor *symbolic, *factored;
    cholmod_dense *x[2], *y, *e; /* for 1 and 3 right-hand sides; Y and E are shared by both */
    cholmod_dense right;
    int last;
};

cholmod_rival *cholmod_self(solver *s) { return static_cast<cholmod_rival *>(s); }

void cholmod_release(solver *s, int whole) {
    cholmod_rival *r = cholmod_self(s);
    cholmod_free_factor(&r->factored, &common);
    if (whole) {
        cholmod_free_factor(&r->symbolic, &common);
        for (int k = 0; k < 2; k++) cholmod_free_dense(&r->x[k], &common);
        cholmod_free_dense(&r->y, &common), cholmod_free_dense(&r->e, &common);
    }
    r->state = whole || !r->symbolic ? 0 : 1;
}

int cholmod_analyse_run(solver *s) {
    cholmod_rival *r = cholmod_self(s);
    common.nmethods = 1, common.method[0].ordering = r->ordering, common.postorder = 1;
    common.supernodal = r->kind;
    r->symbolic = cholmod_analyze(&r->matrix[0], &common);
    return !r->symbolic;
}

int cholmod_renew(solver *s) {
    cholmod_rival *r = cholmod_self(s);
    cholmod_free_factor(&r->factored, &common);
    r->factored = cholmod_copy_factor(r->symbolic, &common);
    return !r->factored;
}

int cholmod_factor_run(solver *s, int halved) {
    cholmod_rival *r = cholmod_self(s);
    common.supernodal = r->kind;
    return !cholmod_factorize(&r->matrix[halved], r->factored, &common) || common.status != CHOLMOD_OK ||
        r->factored->minor < r->factored->n;
}

int cholmod_solve_run(solver *s, int count) {
    cholmod_rival *r = cholmod_self(s);
    r->right.x = right_sides(s);
    r->right.ncol = static_cast<size_t>(count), r->right.nzmax = r->right.nrow * r->right.ncol, r->last = count > 1;
    return !cholmod_solve2(CHOLMOD_A, r->factored, &r->right, nullptr, &r->x[r->last], nullptr, &r->y, &r->e, &common);
}

const double *cholmod_solution(solver *s) {
    return static_cast<const double *>(cholmod_self(s)->x[cholmod_self(s)->last]->x);
}

/* The supernodal method permutes an upper triangle faster, the simplicial one a lower triangle. */
solver *cholmod_make(int kind, int ordering) {
    cholmod_rival *r = new cholmod_rival();
    r->analyse = cholmod_analyse_run, r->renew = cholmod_renew, r->factor = cholmod_factor_run;
    r->solve = cholmod_solve_run, r->solution = cholmod_solution, r->release = cholmod_release;
    r->kind = kind, r->ordering = ordering;
    for (int half = 0; half < 2; half++) {
        cholmod_sparse *m = &r->matrix[half];
        bool upper = kind == CHOLMOD_SUPERNODAL;
        m->nrow = m->ncol = static_cast<size_t>(A.n), m->nzmax = A.col.size();
        m->p = upper ? A.ptr.data() : A.lower_ptr.data(), m->i = upper ? A.col.data() : A.lower_row.data();
        m->x = upper ? A.ll[half].data() : A.lower_ldl[half].data();
        m->stype = upper ? 1 : -1, m->itype = CHOLMOD_INT, m->xtype = CHOLMOD_REAL, m->dtype = CHOLMOD_DOUBLE;
        m->sorted = m->packed = 1;
    }
    r->right.nrow = r->right.d = static_cast<size_t>(A.n);
    r->right.xtype = CHOLMOD_REAL, r->right.dtype = CHOLMOD_DOUBLE;
    return r;
}

/* ---- Eigen, sparse ----------------------------------------------------------------------------------------------- */

typedef Eigen::SparseMatrix<double> sparse;

template <class Factor> struct eigen_rival : base {
    sparse matrix[2];
    Factor *factored;
    Eigen::MatrixXd right, x, y;
    int last, taken; /* what `right` holds: so many right-hand sides, from this one on */
};

/* In place, and with the same steps as Eigen's own solve, which allocates. */
void eigen_triangles(const Eigen::SimplicialLLT<sparse> &f, Eigen::MatrixXd &x) {
    f.matrixL().solveInPlace(x), f.matrixU().solveInPlace(x);
}

void eigen_triangles(const Eigen::SimplicialLDLT<sparse> &f, Eigen::MatrixXd &x) {
    f.matrixL().solveInPlace(x);
    x = f.vectorD().asDiagonal().inverse() * x;
    f.matrixU().solveInPlace(x);
}

template <class Factor> struct eigen_run {
    typedef eigen_rival<Factor> rival;
    static rival *self(solver *s) { return static_cast<rival *>(s); }
    static int analyse(solver *s) {
        self(s)->factored = new Factor;
        self(s)->factored->analyzePattern(self(s)->matrix[0]);
        return 0;
    }
    static void release(solver *s, int whole) {
        if (!whole && s->state < 2) return;
        delete self(s)->factored;
        self(s)->factored = nullptr, s->state = 0;
    }
    static int renew(solver *s) { return s->state == 1 ? 0 : (release(s, 1), analyse(s)); }
    static int factor(solver *s, int halved) {
        self(s)->factored->factorize(self(s)->matrix[halved]);
        return self(s)->factored->info() != Eigen::Success;
    }
    static int solve(solver *s, int count) {
        rival *r = self(s);
        if (r->last != count || r->taken != s->from) {
            r->right = Eigen::Map<Eigen::MatrixXd>(right_sides(s), A.n, count);
            r->x.resize(A.n, count), r->y.resize(A.n, count), r->last = count, r->taken = s->from;
        }
        r->x.noalias() = r->factored->permutationP() * r->right;
        eigen_triangles(*r->factored, r->x);
        r->y.noalias() = r->factored->permutationPinv() * r->x;
        return 0;
    }
    static const double *solution(solver *s) { return self(s)->y.data(); }
    static solver *make(std::vector<double> *values) {
        rival *r = new rival();
        r->analyse = analyse, r->renew = renew, r->factor = factor, r->solve = solve, r->solution = solution;
        r->release = release;
        for (int half = 0; half < 2; half++)
            r->matrix[half] = Eigen::Map<sparse>(A.n, A.n, static_cast<int>(A.lower_row.size()), A.lower_ptr.data(),
                A.lower_row.data(), values[half].data());
        return r;
    }
};

/* ---- dense: both factor in place, and the copy before it is not counted ------------------------------------------ */

struct openblas_rival : base {
    std::vector<double> factored, x;
    std::vector<int> pivots;
};

struct openblas_run {
    static openblas_rival *self(solver *s) { return static_cast<openblas_rival *>(s); }
    static int analyse(solver *s) {
        self(s)->factored.resize(A.columns.size()), self(s)->x.resize(static_cast<size_t>(A.n) * RIGHT_SIDES);
        self(s)->pivots.resize(static_cast<size_t>(A.n));
        return 0;
    }
    static int renew(solver *) { return 0; }
    static void prepare(solver *s) { self(s)->factored = A.columns; }
    static int factor(solver *s, int) {
        int info = 0;
        dgetrf_(&A.n, &A.n, self(s)->factored.data(), &A.n, self(s)->pivots.data(), &info);
        return info;
    }
    static int solve(solver *s, int count) {
        int info = 0;
        memcpy(
            self(s)->x.data(), right_sides(s), static_cast<size_t>(A.n) * static_cast<size_t>(count) * sizeof(double));
        dgetrs_("N", &A.n, &count, self(s)->factored.data(), &A.n, self(s)->pivots.data(), self(s)->x.data(), &A.n,
            &info, 1);
        return info;
    }
    static const double *solution(solver *s) { return self(s)->x.data(); }
    static void release(solver *, int) {}
    static solver *make() {
        openblas_rival *r = new openblas_rival();
        r->analyse = analyse, r->renew = renew, r->prepare = prepare, r->factor = factor, r->solve = solve;
        r->solution = solution, r->release = release;
        return r;
    }
};

typedef Eigen::PartialPivLU<Eigen::Ref<Eigen::MatrixXd>> eigen_lu;

struct eigen_dense_rival : base {
    Eigen::MatrixXd store, right, x;
    eigen_lu *factored;
    int last, taken;
};

struct eigen_dense_run {
    static eigen_dense_rival *self(solver *s) { return static_cast<eigen_dense_rival *>(s); }
    static int analyse(solver *s) {
        eigen_dense_rival *r = self(s);
        r->store.resize(A.n, A.n), r->last = 0;
        return 0;
    }
    static int renew(solver *) { return 0; }
    static void prepare(solver *s) {
        delete self(s)->factored;
        self(s)->factored = nullptr, self(s)->store = Eigen::Map<Eigen::MatrixXd>(A.columns.data(), A.n, A.n);
    }
    static int factor(solver *s, int) {
        Eigen::Ref<Eigen::MatrixXd> reference(self(s)->store);
        self(s)->factored = new eigen_lu(reference); /* its only way without another copy */
        return 0;
    }
    static int solve(solver *s, int count) {
        eigen_dense_rival *r = self(s);
        if (r->last != count || r->taken != s->from) {
            r->right = Eigen::Map<Eigen::MatrixXd>(right_sides(s), A.n, count);
            r->x.resize(A.n, count), r->last = count, r->taken = s->from;
        }
        r->x.noalias() = r->factored->permutationP() * r->right;
        r->factored->matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(r->x);
        r->factored->matrixLU().triangularView<Eigen::Upper>().solveInPlace(r->x);
        return 0;
    }
    static const double *solution(solver *s) { return self(s)->x.data(); }
    static void release(solver *s, int whole) {
        if (!whole) return;
        delete self(s)->factored;
        self(s)->factored = nullptr, s->state = 0;
    }
    static solver *make() {
        eigen_dense_rival *r = new eigen_dense_rival();
        r->analyse = analyse, r->renew = renew, r->prepare = prepare, r->factor = factor, r->solve = solve;
        r->solution = solution, r->release = release;
        return r;
    }
};

/* ---- commands ---------------------------------------------------------------------------------------------------- */

solver *rival[RIVALS];

void take(void *to, size_t bytes) {
    for (char *p = static_cast<char *>(to); bytes;) {
        ssize_t got = read(STDIN_FILENO, p, bytes);
        if (got <= 0) exit(0); /* the other program has ended */
        p += got, bytes -= static_cast<size_t>(got);
    }
}

void give(const void *from, size_t bytes) {
    for (const char *p = static_cast<const char *>(from); bytes;) {
        ssize_t put = write(STDOUT_FILENO, p, bytes);
        if (put <= 0) exit(1);
        p += put, bytes -= static_cast<size_t>(put);
    }
}

template <class T> void take(std::vector<T> &to, size_t count) { to.resize(count), take(to.data(), count * sizeof(T)); }

void halve(std::vector<double> *values) {
    values[1] = values[0];
    for (double &v : values[1]) v *= 0.5;
}

void forget(solver *&s) {
    if (s) s->release(s, 1);
    delete static_cast<base *>(s);
    s = nullptr;
}

void load(const command &c) {
    size_t n = static_cast<size_t>(c.n);
    for (solver *&s : rival) forget(s);
    A = loaded();
    A.n = c.n, A.dense = c.dense, A.sides = c.sides;
    if (c.dense) {
        std::vector<double> rows;
        take(rows, n * n), A.columns.resize(n * n);
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++) A.columns[j * n + i] = rows[i * n + j];
    } else {
        take(A.ptr, n + 1);
        size_t entries = static_cast<size_t>(A.ptr[n]);
        take(A.col, entries), take(A.ll[0], entries), take(A.ldl[0], entries);
        halve(A.ll), halve(A.ldl);
        A.lower_ptr.assign(n + 1, 0), A.lower_row.resize(entries);
        for (int j : A.col) A.lower_ptr[static_cast<size_t>(j) + 1]++;
        for (size_t j = 0; j < n; j++) A.lower_ptr[j + 1] += A.lower_ptr[j];
        std::vector<int> next(A.lower_ptr);
        for (int half = 0; half < 2; half++) A.lower_ll[half].resize(entries), A.lower_ldl[half].resize(entries);
        for (size_t i = 0; i < n; i++)
            for (int k = A.ptr[i]; k < A.ptr[i + 1]; k++) {
                size_t from = static_cast<size_t>(k),
                       to = static_cast<size_t>(next[static_cast<size_t>(A.col[from])]++);
                A.lower_row[to] = static_cast<int>(i);
                for (int half = 0; half < 2; half++)
                    A.lower_ll[half][to] = A.ll[half][from], A.lower_ldl[half][to] = A.ldl[half][from];
            }
    }
    take(A.b, n * static_cast<size_t>(c.sides));
}

solver *make(int which) {
    switch (which) {
    case SUPER_AMD: return cholmod_make(CHOLMOD_SUPERNODAL, CHOLMOD_AMD);
    case SUPER_METIS: return cholmod_make(CHOLMOD_SUPERNODAL, CHOLMOD_METIS);
    case SUPER_NESDIS: return cholmod_make(CHOLMOD_SUPERNODAL, CHOLMOD_NESDIS);
    case SIMPLICIAL_AMD: return cholmod_make(CHOLMOD_SIMPLICIAL, CHOLMOD_AMD);
    case SIMPLICIAL_METIS: return cholmod_make(CHOLMOD_SIMPLICIAL, CHOLMOD_METIS);
    case SIMPLICIAL_NESDIS: return cholmod_make(CHOLMOD_SIMPLICIAL, CHOLMOD_NESDIS);
    case EIGEN_LLT: return eigen_run<Eigen::SimplicialLLT<sparse>>::make(A.lower_ll);
    case EIGEN_LDLT: return eigen_run<Eigen::SimplicialLDLT<sparse>>::make(A.lower_ldl);
    case LU_OPENBLAS: return openblas_run::make();
    default: return eigen_dense_run::make();
    }
}

int threads() {
    int count = 0;
    DIR *folder = opendir("/proc/self/task");
    while (folder && readdir(folder)) count++;
    if (folder) closedir(folder);
    return folder ? count - 2 : 1;
}

/* The numbers of a rival that was measured in FACTOR are let go after its turn, so that only one such factor is in
 * memory at a time; a rival that is in the race for its solves alone keeps them. Analyses after the first turn leave
 * untouched what is kept. */
void measure(const command &c) {
    answer a = answer();
    solver *&s = rival[c.rival];
    unsigned phases = c.phases;
    double analyse = NOT_MEASURED;
    if (!s) s = make(c.rival);
    if (s->state && (phases >> ANALYSE & 1u)) {
        solver *other = make(c.rival);
        solver_measure(other, 1u << ANALYSE, a.seconds);
        analyse = a.seconds[ANALYSE], phases &= ~(1u << ANALYSE);
        forget(other);
    }
    solver_measure(s, phases, a.seconds);
    if (analyse != NOT_MEASURED) a.seconds[ANALYSE] = analyse;
    a.solution = c.solution && s->state == 3 && a.seconds[SOLVE3] >= 0.0 && a.seconds[SOLVE3] < HUGE_VAL;
    std::vector<double> x(a.solution ? A.b.size() : 0);
    if (a.solution) a.solution = !solver_all(s, A.n, A.sides, x.data());
    a.threads = threads();
    give(&a, sizeof a);
    if (a.solution) give(x.data(), x.size() * sizeof(double));
    if (!c.phases) forget(s);
    else if (c.phases >> FACTOR & 1u) s->release(s, 0);
}

} // namespace

int main() {
    command c;
    answer hello = answer();
    cholmod_start(&common);
    common.print = 0;
    snprintf(hello.kernels, sizeof hello.kernels, "%s", openblas_get_corename());
    hello.threads = threads();
    give(&hello, sizeof hello);
    for (;;) {
        take(&c, sizeof c);
        if (c.verb == 'L') load(c);
        else measure(c);
    }
}
