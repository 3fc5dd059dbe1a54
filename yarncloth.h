/* yarncloth.h - cloth at the level a scene needs: triangles, yarns, or both mixed in one garment.   v0.1.0
 *
 * One C99 file, no dependency but libm. Public domain or MIT, as you like: see the end of this file.
 *
 *   In one source file:      #define YARNCLOTH_IMPLEMENTATION
 *                            #include "yarncloth.h"
 *   Everywhere else:         #include "yarncloth.h"
 *
 * DOES NOT (yet): mix knits with triangles; homogenised volumes, GPU, single precision, changing the yarn region while
 * a scene runs, contact of yarns in one layer beyond what the weave gives.
 *
 * HELLO. A 20 cm swatch, held at two corners, swings for a second; see examples/hello.c, which is this text:
 *
 *     #define YARNCLOTH_IMPLEMENTATION
 *     #include "yarncloth.h"
 *     #include <stdio.h>
 *
 *     enum { N = 11 }; // vertices along a side
 *
 *     int main(void) {
 *         static double position[N * N][3], uv[N * N][2];
 *         static int triangle[2 * (N - 1) * (N - 1)][3];
 *         char why[YC_MESSAGE_SIZE];
 *         yc_scene_desc settings = yc_scene_desc_default();
 *         yc_cloth_desc swatch = yc_cloth_desc_default();
 *         yc_scene *scene;
 *         int i, x, y, t = 0, cloth;
 *
 *         for (i = 0; i < N * N; i++) { // a square of 20 cm, flat, 1 m above the ground
 *             position[i][0] = uv[i][0] = 0.02 * (i % N), uv[i][1] = 0.02 * (i / N);
 *             position[i][1] = 1.0, position[i][2] = -uv[i][1];
 *         }
 *         for (y = 0; y + 1 < N; y++)
 *             for (x = 0; x + 1 < N; x++, t += 2) {
 *                 int a = y * N + x, b = a + 1, c = a + N, d = c + 1;
 *                 triangle[t][0] = a, triangle[t][1] = b, triangle[t][2] = d;
 *                 triangle[t + 1][0] = a, triangle[t + 1][1] = d, triangle[t + 1][2] = c;
 *             }
 *         swatch.mesh.vertex_count = swatch.mesh.uv_count = N * N, swatch.mesh.triangle_count = t;
 *         swatch.mesh.positions = (const double(*)[3])position, swatch.mesh.uv = (const double(*)[2])uv;
 *         swatch.mesh.triangles = (const int(*)[3])triangle;
 *
 *         if (yc_scene_create(NULL, &settings, &scene, why) != YC_OK) return puts(why), 1;
 *         yc_scene_add_cloth(scene, &swatch, &cloth);
 *         yc_scene_pin(scene, cloth, YC_VERTEX, 0, NULL);
 *         yc_scene_pin(scene, cloth, YC_VERTEX, N - 1, NULL);
 *         for (i = 0; i < 100; i++)
 *             if (yc_scene_step(scene, 0.01, NULL) != YC_OK) return puts(yc_scene_message(scene)), 1;
 *         yc_scene_positions(scene, cloth, YC_VERTEX, position);
 *         printf("the free corner hangs %.3f m below the pins\n", 1.0 - position[N * N - 1][1]);
 *         yc_scene_destroy(scene);
 *         return 0;
 *     }
 *
 * THE IDEA. A cloth is a triangle mesh whose UVs are its sewing pattern, in metres. yc_weave() lays yarns over that
 * pattern. A blending field alpha, one number per vertex, says where the yarns act: 0 triangles alone, 1 yarns alone,
 * in between both at once (Casafranca et al. 2020, "Mixing Yarns and Triangles in Cloth Simulation", called MIX below;
 * the yarn model is Cirio et al. 2014 and 2017, the latter called YARN). So the same swatch runs as triangles, as yarns
 * or mixed by changing the descriptor alone.
 *
 * UNITS. SI throughout: m, kg, s, N, rad. Positions are double[3], y is up in the examples but nowhere assumed.
 *
 * ERRORS. A function that can fail returns a yc_result: YC_OK or a negative code, and then nothing has changed. The
 * reason, naming the field, the index and the value, is in yc_scene_message() or in the message buffer passed. The
 * library never aborts, prints or touches files.
 *
 * THREADS. No globals: two scenes in two threads just work. One scene may be used by one thread at a time; inside, it
 * runs host.parallel_for. Results are the same bits for any number of workers, in one build on one machine.
 *
 * MACROS. YARNCLOTH_IMPLEMENTATION as above; YC_API in front of public functions (extern by default; define it as
 * static for a private copy). YC_USE_LAPACK: yc_lu_factor and yc_lu_solve call dgetrf_ and dgetrs_, large fronts of a
 * sparse factor dgemm_ (32-bit integers) of a LAPACK that you link, whose sums then decide whether results are the same
 * bits. YC_NO_SIMD: no vector instructions beyond the compiler's own. YC_SELF: this file's name in quotes where you
 * have renamed it, since it includes itself to compile its kernels for several instruction sets. Do not compile with
 * -ffast-math: the file refuses it.
 *
 * CONTENTS. Search for the tag. Declarations first, complete with their documentation; stop reading where they end
 * if you only want to use the library. A chapter of the implementation calls only chapters above it.
 *
 *   >>api        what users see
 *   >>host       chapter 1: results, messages, memory, parallel loops
 *   >>vec        chapter 2: vectors of three, the one-sided law
 *   >>dense      chapter 3: small blocks, kernels, panels, LU with partial pivoting
 *   >>sparse     chapter 4: block matrices, ordering, L L^T and block L D L^T, incomplete factor
 *   >>fabric     chapter 5: weaves laid over a sewing pattern, seam rods, drafts, fabrics with names, charts, knits
 *   >>yarn       chapter 6: elements of the persistent-contact yarn model
 *   >>triangle   chapter 7: membrane and hinge elements
 *   >>contact    chapter 8: bodies, pairs, penalty and friction
 *   >>mixed      chapter 9: the embedding B, the kinematic filter F, the blended mass
 *   >>solve      chapter 10: MPCG and its preconditioners, direct solves
 *   >>scene      chapter 11: what the user holds: build, Newton, step, state
 *   >>output     chapter 12: curves, tubes, subdivided mesh
 *   >>region     chapter 14: where yarns go
 */

#ifndef YARNCLOTH_H
#define YARNCLOTH_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* =====================================================================================================================
 * >>api
 * ===================================================================================================================== */

#define YC_VERSION_MAJOR 0
#define YC_VERSION_MINOR 1
#define YC_VERSION_PATCH 0
#define YC_VERSION "0.1.0"

#ifndef YC_API
#define YC_API extern
#endif

/* The version of the compiled implementation, to compare with YC_VERSION of the header. */
YC_API const char *yc_version(void);

/* ---- results and host ------------------------------------------------------------------------------------------ */

#define YC_MESSAGE_SIZE 256 /* bytes of a message, with its final zero */

typedef enum yc_result {
    YC_OK = 0,
    YC_ERROR_ARGUMENT = -1, /* a field, index or value out of its range; the message names it */
    YC_ERROR_MEMORY = -2,   /* the host's allocator returned NULL */
    YC_ERROR_TOPOLOGY = -3, /* a mesh or network that is not sound: winding, non-manifold edges, order of u */
    YC_ERROR_NOT_SPD = -4,  /* a matrix that must be positive definite is not */
    YC_ERROR_SINGULAR = -5, /* a matrix without an inverse, to rounding */
    YC_ERROR_DIVERGED = -6, /* a step did not converge even at dt_min */
    YC_ERROR_PARSE = -7,    /* text that does not follow its format, or a saved state of another scene */
    YC_ERROR_CANCELLED = -8 /* host.progress returned nonzero */
} yc_result;

/* "YC_OK" and so on; never NULL. */
YC_API const char *yc_result_name(yc_result result);

/* What the library asks of its host. A zeroed yc_host is legal and means malloc, one thread (OpenMP's where compiled
 * with it) and silence. The struct is copied; what `user` points to must outlive the objects made with it. */
typedef struct yc_host {
    void *user; /* handed to every callback */
    /* Memory, 16-byte aligned, NULL when there is none. Both or neither. `size` is the one asked for. Never called from
     * inside parallel_for. */
    void *(*alloc)(size_t size, void *user);
    void (*free)(void *block, size_t size, void *user);
    /* Calls task(context, 0 .. count-1), in any order, on any threads, and returns when all are done. */
    void (*parallel_for)(void *user, void (*task)(void *context, int index), void *context, int count);
    /* One line of text for a person, without a newline. */
    void (*log)(void *user, const char *text);
    /* Called between the parts of a long call with the share done so far, 0 to 1. Nonzero cancels the call: it returns
     * YC_ERROR_CANCELLED with nothing changed. */
    int (*progress)(void *user, double fraction);
} yc_host;

/* ---------------------------------------------------------------------------------------------------------------------
 * Linear solvers
 *
 * Both kinds of factor are made once per size or pattern, factored any number of times and solved with any number of
 * times; only making one allocates. Numbers have whatever units the caller's matrix has. Different objects may be used
 * by different threads at the same time; one object by one thread at a time, unless a function says otherwise. Results
 * are the same bits for any worker count of host.parallel_for. A host of NULL means malloc, one thread, silence. A
 * function that makes an object and fails leaves *out NULL and says why through host.log. An object of NULL is refused
 * by every function: YC_ERROR_ARGUMENT, 0 or a message that says so; to destroy it does nothing.
 * ------------------------------------------------------------------------------------------------------------------ */

/* Dense LU with partial pivoting, P A = L U. */
typedef struct yc_lu yc_lu;

/* Makes room for matrices of n x n, n >= 0: n * n + O(n) numbers. Errors: YC_ERROR_ARGUMENT (n < 0, host with only one
 * of alloc and free), YC_ERROR_MEMORY. */
YC_API yc_result yc_lu_create(const yc_host *host, int n, yc_lu **out);

/* Factors a, n x n by rows, row i starting at a + i * lda, lda >= n; a is left untouched. Errors: YC_ERROR_ARGUMENT (a
 * NULL, lda too small, an entry not finite; the previous factor stays), YC_ERROR_SINGULAR (a column in which no
 * pivot is left; the message names it; there is no factor then). A matrix that is singular but for rounding passes:
 * ask yc_lu_rcond. */
YC_API yc_result yc_lu_factor(yc_lu *lu, const double *a, int lda);

/* Solves A x = b, or A' x = b, for `count` right-hand sides: x[k * ldx + i] holds entry i of b number k and receives
 * that of the solution; ldx >= n. YC_ERROR_ARGUMENT, with x untouched, when there is no factor or an argument is out
 * of range. Several threads may solve with one factor at the same time. */
YC_API yc_result yc_lu_solve(const yc_lu *lu, double *x, int count, int ldx);
YC_API yc_result yc_lu_solve_transposed(const yc_lu *lu, double *x, int count, int ldx);

/* An estimate of 1 / (|A| |inverse(A)|) in the 1-norm, practically always within a factor of 3 of the truth: 1 is
 * perfect, below 1e-15 solutions mean nothing. Costs a few solves. 0 when there is no factor. Uses the object's
 * workspace, so one thread at a time. */
YC_API double yc_lu_rcond(const yc_lu *lu);

/* The growth of the elimination, largest |U| / largest |A|: usually below 10 or so. Rounding errors of solutions are
 * those of an A changed by about growth * 1e-16 of its largest entry. Reads U once; 0 when there is no factor. */
YC_API double yc_lu_growth(const yc_lu *lu);

/* Why the last yc_lu_factor failed, in words; never NULL. Valid until the next call with this object. */
YC_API const char *yc_lu_message(const yc_lu *lu);

/* NULL is fine. */
YC_API void yc_lu_destroy(yc_lu *lu);

/* Sparse direct factorisation of a symmetric matrix, P A P' = L D L'. */
typedef struct yc_chol yc_chol;

typedef enum yc_chol_kind {
    YC_CHOL_SPD = 1, /* symmetric positive definite; anything else is reported */
    /* Indefinite, but stable in any order once each node's block is inverted with pivoting: [[H G'],[G -C]] with
     * positive definite H and C, or with nodes that pair the two, so that H or C may be singular. A general indefinite
     * matrix may lose accuracy, and a node's block of condition c costs about c * 1e-16: check residuals, see
     * yc_chol_refine. Where diagonal entries are zero nothing tells rounding from a pivot: a constraint that is there
     * twice may pass for regular. */
    YC_CHOL_QUASIDEFINITE = 2
} yc_chol_kind;

typedef struct yc_chol_options {
    yc_chol_kind kind; /* default YC_CHOL_SPD */
    /* Unknowns per node, 1 to 8; n must be a multiple. Unknowns b*i to b*i+b-1 form node i and are eliminated together,
     * which is faster when they share their pattern. Default 1. */
    int block;
    /* n / block nodes: the node eliminated k-th; read during the analysis only. Default NULL: the library's choice, by
     * size and pattern, between minimum degree and nested dissection. */
    const int *order;
    /* n / block numbers of 0 to n / block - 1, ignored with `order`: nodes of a lower stage are eliminated before those
     * of a higher one. Read during the analysis only. Default NULL: no such constraint. */
    const int *stage;
    /* YC_CHOL_QUASIDEFINITE: what a pivot block without an inverse has added to its diagonal, away from zero, in the
     * matrix's unit; >= 0. The factor is then that of a nearby matrix: see yc_chol_refine, and `shifted` in the
     * statistics. Default 0: such a block is an error. Small matrices may do without either where the library
     * eliminates the block together with its neighbours. */
    double shift;
} yc_chol_options;

/* Fills in the defaults; of NULL nothing. Options that were not filled in, with a block of 0, are refused. */
YC_API void yc_chol_options_default(yc_chol_options *options);

typedef struct yc_chol_statistics {
    double nonzeros; /* numbers in L with its diagonal, with the padding of supernodes; small factors take more */
    double flops;    /* additions and multiplications of one factorisation by supernodes */
    int supernodes;
    int pivots;   /* unknowns that the last factorisation eliminated: n, or how far it came before it failed */
    int shifted;  /* nodes that it had to shift */
    size_t bytes; /* memory of the object */
} yc_chol_statistics;

/* Analyses the pattern of an n x n matrix in compressed rows: the columns of row i are col[ptr[i]] to col[ptr[i+1]-1],
 * ascending, without duplicates; either the lower triangle alone or the full symmetric pattern. A diagonal entry that
 * is missing counts as zero. Nothing of the arguments is kept but the host. options NULL: defaults. Errors:
 * YC_ERROR_ARGUMENT (sizes, options, a pattern that is out of range, unsorted, duplicate or unsymmetric),
 * YC_ERROR_MEMORY. */
YC_API yc_result yc_chol_analyze(
    const yc_host *host, int n, const int *ptr, const int *col, const yc_chol_options *options, yc_chol **out);

/* Factors the matrix with values[k] at (row, col[k]). Values above the diagonal do not matter. The first call makes
 * room for the factor, later ones allocate nothing. Errors: YC_ERROR_ARGUMENT (a value not finite; the previous factor
 * stays), YC_ERROR_MEMORY, YC_ERROR_NOT_SPD (kind YC_CHOL_SPD: a pivot is not positive, or lost to rounding),
 * YC_ERROR_SINGULAR (the other kind: a pivot block is singular to working precision). The message of these two names
 * the unknown and its place in the order of elimination: what precedes it there is a matrix that has a factor. There is
 * none for the whole until the next success. */
YC_API yc_result yc_chol_factor(yc_chol *chol, const double *values);

/* Solves A x = b for `count` right-hand sides x[k * ldx + i], in place, ldx >= n. Up to four are solved in one pass
 * over the factor. YC_ERROR_ARGUMENT, with x untouched, when there is no factor or an argument is out of range. Uses
 * the object's workspace, so one thread at a time; several threads solve with one factor at the same time by
 * yc_chol_solve_with, each with yc_chol_work(chol) numbers of its own. */
YC_API yc_result yc_chol_solve(const yc_chol *chol, double *x, int count, int ldx);
YC_API yc_result yc_chol_solve_with(const yc_chol *chol, double *x, int count, int ldx, double *work);
YC_API size_t yc_chol_work(const yc_chol *chol);

/* Iterative refinement of x, which yc_chol_solve made of b: at most `steps` times x += inverse(A) (b - A x), as long as
 * that at least halves the error |b - A x| / (|A| |x| + |b|), in the maximum norm, which *error (NULL: not wanted)
 * receives; steps = 0 only measures it. The matrix is given as to yc_chol_analyze and yc_chol_factor. `work` as of
 * yc_chol_solve_with; NULL: the object's. Errors as of yc_chol_solve. */
YC_API yc_result yc_chol_refine(const yc_chol *chol, const int *ptr, const int *col, const double *values,
    const double *b, double *x, int steps, double *error, double *work);

/* Writes the n / block nodes in the order of elimination, for yc_chol_options.order of a later run. It may differ from
 * a given order or from stages where that changes no entry of the factor: parts that do not touch may change places. */
YC_API yc_result yc_chol_order(const yc_chol *chol, int *order);

/* Sizes, and how the last factorisation went. */
YC_API yc_result yc_chol_stats(const yc_chol *chol, yc_chol_statistics *out);

/* Why the last yc_chol_factor failed, in words; never NULL. Valid until the next call with this object. */
YC_API const char *yc_chol_message(const yc_chol *chol);

/* NULL is fine. */
YC_API void yc_chol_destroy(yc_chol *chol);

/* ---- materials -------------------------------------------------------------------------------------------------- */

/* A yarn. Stretch and bending are separate inputs: a solid rod of the same thickness is 30 to 100 times stiffer in
 * bending than a real yarn. Defaults: a 15 tex cotton yarn of a shirting. All values finite. */
typedef struct yc_yarn_material {
    double stretch; /* EA, N; > 0; default 50 */
    double bending; /* EI, N m^2; >= 0; default 3e-9 */
    double density; /* kg/m (1 tex = 1e-6 kg/m), > 0; default 15e-6. It carries the factor 1 + crimp: see below */
    double radius;  /* m, > 0; default 72e-6 */
    /* k_x, N: resistance of a crossing against turning, where its yarns lie on other sides of each other than at all
     * neighbouring crossings; in proportion less on floats; >= 0; default 4e-3 */
    double shear;
    double shear_limit; /* rad from the rest angle at which neighbouring yarns jam; (0, pi/2]; default 0.9 */
    double contact;     /* k_c, N: resistance of neighbouring parallel yarns pressed together; >= 0; default 1 */
    double friction;    /* Coulomb coefficient between crossing yarns; [0, 10]; default 0.3 */
    double slide;       /* k_f, N/m: stiffness of the anchored friction spring; > 0; default 100 */
    /* N: what presses the yarns of a crossing together at rest, as weaving and finishing leave it; the mean of both
     * yarns counts, less on floats like `shear`, and friction of sliding and of turning adds it to what the state
     * gives; >= 0; default 0 */
    double preload;
    /* N m^2: EI of the undulation of a crimped yarn. Another value than `bending` only where a yarn stands for several;
     * > 0; default 3e-9. Not used without crimp */
    double crimp_bending;
    double strength; /* N: tension at which the yarn breaks; >= 0; default 0, never */
    /* N/m: how the yarn resists being pressed flat by the yarn it crosses, in series with that one's; four times as
     * much once both together are thinner by a fifth of their thickness; >= 0; default 0: it keeps its shape. Not used
     * without crimp */
    double flattening;
    /* k_w, N: resistance of the yarns of a stitch contact against any other angle about each other than a quarter turn;
     * the mean of both counts; >= 0; default 3e-3. Flat is a quarter turn away: k_w above bending / (60 radius^2) rolls
     * a knit up or crumples it */
    double wrap;
    double stitch; /* k_l, N: resistance of a stitch contact's length of yarn against sliding; >= 0; default 50 */
} yc_yarn_material;
YC_API yc_yarn_material yc_yarn_material_default(void);

/* What a yarn is spun of. Polyester and silk are filaments, the others staple fibres. */
typedef enum yc_fibre {
    YC_FIBRE_COTTON,
    YC_FIBRE_LINEN,
    YC_FIBRE_WOOL,
    YC_FIBRE_SILK,
    YC_FIBRE_VISCOSE,
    YC_FIBRE_POLYESTER,
    YC_FIBRE_COUNT
} yc_fibre;

/* A yarn as a spinner names it. */
typedef struct yc_yarn_desc {
    unsigned cookie;       /* set by yc_yarn_desc_default() */
    yc_fibre fibre;        /* default YC_FIBRE_COTTON */
    double tex;            /* g/km of the yarn; (0, 1e5]; default 15 */
    double fibre_tex;      /* g/km of one fibre or filament; (0, tex]; default 0: the usual one, at most tex */
    double packing;        /* share of the yarn's volume that is fibre; (0, 1]; default 0: the usual one */
    double bending_factor; /* times the bending of free fibres; [1, tex / fibre_tex]; default 0: 2.5, at most that */
} yc_yarn_desc;
YC_API yc_yarn_desc yc_yarn_desc_default(void);

/* The material of such a yarn:
 *   density  tex * 1e-6 kg/m, of the straight yarn
 *   radius   half of Peirce's diameter (1937), that of a cylinder of the fibre's density times `packing`
 *   stretch  modulus of yarns of this fibre times tex; strength likewise
 *   bending  tex * fibre_tex * R * bending_factor, R the fibre's specific flexural rigidity. With a factor of 1 fibres
 *            slide freely past each other, with tex / fibre_tex the yarn is a solid rod; real yarns lie between 1.5 and
 *            4 (Hearle, Grosberg, Backer 1969; fibre values from Morton and Hearle). crimp_bending is the same
 *   wrap     bending / (200 radius^2): a fifth of what bending resists a turn with, in a knit whose stitch contacts are
 *            5 radii long, as hand-knitted ones are; stitch is the same as stretch
 *   friction, preload, slide, contact, shear, flattening  typical of the fibre and of cloth of such yarn; see
 *            yci_fibre_values
 * Single yarns differ from these by a factor of two.
 * desc  not NULL; out  untouched on failure; message  NULL or YC_MESSAGE_SIZE bytes. Errors: ARGUMENT. */
YC_API yc_result yc_yarn_material_make(const yc_yarn_desc *desc, yc_yarn_material *out, char *message);

/* A sheet of triangles, orthotropic along the grain: 1 is the weft (u of the pattern), 2 the warp (v). Density of the
 * membrane energy, per area,
 * 1/2 (stretch[0] E11^2 + stretch[1] E22^2 + 2 coupling E11 E22 + shear (2 E12)^2), E Green's strain. */
typedef struct yc_triangle_material {
    double density;    /* kg/m^2; > 0; default 0.12. Not used where yarns are laid: they give the mass */
    double stretch[2]; /* N/m, along u and v; > 0; default 2000, 2000 */
    double coupling;   /* N/m; |coupling| < sqrt(stretch[0] stretch[1]); default 0 */
    double shear;      /* N/m; > 0; default 60 */
    /* Flexural rigidity per width, N m; >= 0; default 8e-6. A cylinder stores 1/2 D kappa^2 per area; a free strip of a
     * mesh of right triangles, whose diagonals all run one way, bends as with 0.8 D. */
    double bending;
} yc_triangle_material;
YC_API yc_triangle_material yc_triangle_material_default(void);

/* ---- meshes and yarn networks ---------------------------------------------------------------------------------- */

/* A triangle mesh as the caller holds it. A UV island is a pattern piece, so a garment is an OBJ whose UVs are its
 * sewing pattern in metres. Triangles are wound consistently, on the mesh and in UV (positive UV area). */
typedef struct yc_mesh {
    int vertex_count;
    const double (*positions)[3]; /* [vertex_count], m */
    int triangle_count;
    const int (*triangles)[3]; /* [triangle_count], vertex indices */
    int uv_count;
    const double (*uv)[2];        /* [uv_count], m */
    const int (*uv_triangles)[3]; /* [triangle_count], indices into uv; NULL: `triangles` serves */
} yc_mesh;

/* Families of yarns. */
#define YC_WARP 0 /* runs along v of the pattern (turned by the grain) */
#define YC_WEFT 1 /* runs along u */
#define YC_ROD 2  /* runs along a seam and holds the yarns that end there */

/* A stitch contact of a knit: where a loop is drawn through an older one, two yarns, or two places of one yarn, run
 * side by side from node A, the outer and lower one, to node B, the inner and upper one, and wrap about each other
 * there. Below A come the old loop's leg and the new one's foot, above B leave the old loop's head and the new one's
 * leg. */
typedef struct yc_stitch_contact {
    int visit[2][2]; /* [old loop 0, new loop 1][A 0, B 1]; the two visits of a loop follow each other, either way */
    /* +1, -1: the sign of the wrapping angle: + at the left contact of a knit, - at its right one, reversed for a purl,
     * all as seen from the right side */
    signed char sign;
} yc_stitch_contact;

/* A yarn network as plain arrays. A yarn is a sequence of visits (node, arc length u), u strictly increasing. A node
 * visited by two yarns is a crossing, one that no yarn visits is idle. Made by yc_weave() or filled in by the caller
 * (then the arrays are the caller's, `owner` is NULL and yc_yarns_destroy does nothing). */
typedef struct yc_yarns {
    int node_count;
    double (*layout)[3];  /* [node_count], m: rest positions, flat: the pattern's (u, v, 0) */
    int *triangle;        /* [node_count], the mesh triangle that carries the node; NULL without a mesh */
    double (*weights)[3]; /* [node_count], barycentric weights there, sum 1; NULL without a mesh */
    int yarn_count;
    int *yarn_first;            /* [yarn_count + 1], first visit of each yarn; the last entry is visit_count */
    unsigned char *yarn_family; /* [yarn_count], YC_WARP, YC_WEFT or YC_ROD */
    int *yarn_material;         /* [yarn_count], index into materials */
    int visit_count;
    int *visit_node; /* [visit_count] */
    double *visit_u; /* [visit_count], m, strictly increasing along a yarn */
    /* [visit_count], +1 the upper yarn at a crossing, -1 the lower, 0 alone. In a stack of n yarns, which only stitch
     * contacts may make, n - 1, n - 3 .. 1 - n from the uppermost yarn to the lowest */
    signed char *visit_layer;
    /* [visit_count], m, >= 0: how far the yarn's centre line passes from its node at rest, on the side of its layer, 0
     * where that is 0; u is then true length along the undulating yarn. NULL: no crimp, u is measured along the layout
     */
    double *visit_height;
    /* [visit_count], rad, 0 .. pi: how far the yarn turns there when at rest, in any direction; NULL: 0, it is straight
     */
    double *visit_turn;
    /* [visit_count], nonzero: u is a label and never slides (ends, rods, lone visits). An end alone at its node with 1
     * is free, and may slide out of the crossing next to it; with 2 it is secured, as by a knot or a selvedge */
    unsigned char *visit_held;
    int material_count;
    yc_yarn_material *materials; /* [material_count] */
    int contact_count;           /* 0: woven */
    yc_stitch_contact *contacts; /* [contact_count]: one for each old loop of a stack, with the new one; NULL: none */
    void *owner;                 /* the library's own; NULL: the caller's arrays */
} yc_yarns;

/* What the yarns of a family do at a free outline of the cloth. */
typedef enum yc_edge {
    YC_EDGE_CUT = 0,     /* end on the outline, in a node of their own beyond the last crossing: they may slide out */
    YC_EDGE_SELVEDGE = 1 /* are held at their last crossing, as if they turned back there */
} yc_edge;

/* A weave. The draft is read like a weaver's draw-down: draft[r * repeat[0] + c] nonzero: warp c passes over weft r. */
typedef struct yc_weave_desc {
    unsigned cookie; /* set by yc_weave_desc_default() */
    /* m: between neighbouring warp yarns (along u), between weft yarns (along v); > 0; default 2.5e-3 */
    double spacing[2];
    int repeat[2];              /* columns (warps) and rows (wefts) of the draft; >= 1; default 2, 2 */
    const unsigned char *draft; /* [repeat[1] * repeat[0]]; NULL: plain weave; default NULL */
    yc_yarn_material warp, weft;
    int material_count;                /* >= 0; default 0: all yarns are `warp` or `weft`, orders are not looked at */
    const yc_yarn_material *materials; /* [material_count], for instance one per colour */
    /* [YC_WARP], [YC_WEFT]: yarn k of the family is materials[order[k modulo order_count]]; k counts as the draft's
     * columns and rows do. NULL: the family is all `warp` or `weft`; default NULL */
    const int *order[2];
    int order_count[2]; /* >= 1 where there is an order; default 0, 0 */
    /* along welded seams of a mesh; rod.density = 0: no rods. Default: the yarn's, twice as heavy */
    yc_yarn_material rod;
    /* [YC_WARP], [YC_WEFT]: length of a yarn over the length of its cloth, less 1, the mean over the family's yarns and
     * the draft's repeat; from 0 to half the share of crossings behind which a yarn changes sides; default 0, 0. Where
     * one is above 0 yarns undulate (visit_height, one for each family), density is that of the straightened yarn, and
     * cloth stretches by straightening them first */
    double crimp[2];
    yc_edge edge[2]; /* [YC_WARP], [YC_WEFT]: ends of that family at a free outline; default YC_EDGE_CUT, twice */
    /* [1, 1000]; default 1. Yarns that are laid as one: spacing is that many times as wide and materials are changed so
     * that the cloth weighs, stretches, bends and shears as before, and friction of sliding stays but for what crimp
     * adds; see yci_yarn_bundle. Draft and orders count bundles, so the pattern grows. The rod is one yarn always */
    int bundle;
    double grain;   /* rad, turns the yarns against the pattern's axes, counter-clockwise; default 0 */
    double size[2]; /* m, width and height of the cloth when no mesh is given; default 0.2, 0.2 */
} yc_weave_desc;
YC_API yc_weave_desc yc_weave_desc_default(void);

/* Lays a weave over every UV island of `mesh` (clipped exactly at the island's outline, tied to a rod along every edge
 * where two islands are welded), or over a rectangle [0,w] x [0,h] of its own when mesh is NULL.
 * desc     not NULL; mesh  NULL, or a mesh with a UV area > 0 in every triangle
 * out      receives the network; untouched on failure; free with yc_yarns_destroy. Its materials are warp, weft,
 *          rod unless rod.density is 0, then the list
 * message  NULL or YC_MESSAGE_SIZE bytes for the reason of a failure
 * Errors: ARGUMENT, TOPOLOGY, MEMORY. Cost: linear in triangles and crossings. */
YC_API yc_result yc_weave(
    const yc_host *host, const yc_weave_desc *desc, const yc_mesh *mesh, yc_yarns *out, char *message);

/* Checks a network: indices, order of u, weights, materials, contacts, at most two visits a node unless contacts name
 * them all. yc_cloth creation calls it.
 * mesh NULL: triangle and weights are not looked at. */
YC_API yc_result yc_yarns_check(const yc_yarns *yarns, const yc_mesh *mesh, char *message);

/* Frees what yc_weave made and zeroes the struct. NULL is fine; a caller's own network is left alone. */
YC_API void yc_yarns_destroy(yc_yarns *yarns);

/* The triangle material that stretches, shears, bends and weighs like the weave does when straight: stretch EA/spacing,
 * shear 4 k_x/spacing summed over both families' halves, times the share of places where yarns change sides, bending
 * EI/spacing, density as laid, which with crimp is that of (1 + crimp) times the length. Stretch knows of no crimp.
 * Where there is an order, the mean of its materials counts. desc is not checked. */
YC_API yc_triangle_material yc_weave_material(const yc_weave_desc *desc);

/* ---- drafts ----------------------------------------------------------------------------------------------------- */

/* One repeat of a weave, and of its colours. Column 0 is the warp at the left, row 0 the weft woven first, at the
 * bottom; the cloth is seen from the front. Made by the functions below, or filled in by the caller (then the arrays
 * are the caller's, `owner` is NULL and yc_draft_destroy does nothing). */
typedef struct yc_draft {
    int repeat[2];       /* columns (warps) and rows (wefts); >= 1 */
    unsigned char *over; /* [repeat[1] * repeat[0]], over[r * repeat[0] + c] nonzero: warp c passes over weft r */
    int order_count[2];  /* [YC_WARP], [YC_WEFT]: length of that family's order of colours; 0: none */
    int *order[2];       /* [order_count], 0 .. colour_count - 1; NULL: none */
    int colour_count;    /* 0 without orders */
    float (*colours)[3]; /* [colour_count], red, green, blue, 0 to 1, as the file gives them; NULL: not known */
    double spacing[2];   /* m, mean distance of neighbouring warps, of wefts; 0: not known */
    double thickness[2]; /* m, mean diameter of warps, of wefts; 0: not known */
    void *owner;         /* the library's own; NULL: the caller's arrays */
} yc_draft;

/* The weaves that have names. All share: host NULL is a zeroed one; *out receives the draft, untouched on failure, free
 * with yc_draft_destroy; message is NULL or YC_MESSAGE_SIZE bytes. Errors: ARGUMENT (a number out of its range),
 * MEMORY. Floats, shafts and counts are at most 256. */
YC_API yc_result yc_draft_plain(const yc_host *host, yc_draft *out, char *message);
/* Warps pass over `over` wefts, then under `under`, >= 1 each, the next one a weft later. hand 'Z': the diagonal climbs
 * to the right; 'S': to the left. */
YC_API yc_result yc_draft_twill(const yc_host *host, int over, int under, char hand, yc_draft *out, char *message);
/* Single crossings, scattered: in column c at row c * move modulo `shafts`. shafts >= 5; move 2 .. shafts - 2, without
 * a common divisor with shafts (6 has none). face YC_WARP: warps float on the front; YC_WEFT: wefts do (sateen). */
YC_API yc_result yc_draft_satin(const yc_host *host, int shafts, int move, int face, yc_draft *out, char *message);
/* Plain weave of `ends` warps and `picks` wefts at a time, >= 1 each. */
YC_API yc_result yc_draft_basket(const yc_host *host, int ends, int picks, yc_draft *out, char *message);
/* Plain weave in which one family floats over `length` >= 2 yarns of the other at a time: family YC_WARP, warp rep,
 * whose ribs run along the wefts; YC_WEFT, weft rep. */
YC_API yc_result yc_draft_rep(const yc_host *host, int length, int family, yc_draft *out, char *message);
/* Honeycomb (waffle) of n x n, n even and >= 6: a lattice of diamonds, filled with warp floats of up to n - 3 and weft
 * floats of up to n - 1 in turn, which relaxes into cells. */
YC_API yc_result yc_draft_honeycomb(const yc_host *host, int n, yc_draft *out, char *message);

/* What a weaver sets up on a loom. Plain arrays of the caller's; read during the call. */
typedef struct yc_loom {
    int shafts, treadles; /* 1 .. 4096 */
    int count[2];         /* warps, wefts of the draft; 1 .. 65536; warps times wefts or shafts at most 2^24 */
    const int *threading; /* [count[0]], the shaft of every warp, 0 .. shafts - 1; -1: none */
    /* [treadles * shafts], tieup[t * shafts + s] nonzero: treadle t moves shaft s. NULL: treadle t moves shaft t alone,
     * and treadling is a liftplan; then treadles must be shafts */
    const unsigned char *tieup;
    const unsigned char *treadling; /* [count[1] * treadles], treadling[r * treadles + t] nonzero: down for weft r */
    int sinking;                    /* 0: treadles raise their shafts (rising shed). Nonzero: they lower them */
} yc_loom;

/* The draft that such a loom weaves: a warp passes over the wefts for which its shaft is up. Shared arguments as above.
 * Errors: ARGUMENT (the message names field, index and value), MEMORY. Cost: at most warps * wefts * shafts. */
YC_API yc_result yc_draft_loom(const yc_host *host, const yc_loom *loom, yc_draft *out, char *message);

/* The draft in a text of the Weaving Information File format, version 1.1, as weaving programs write it.
 * text  `length` bytes, not zero-terminated; any line ends; nothing beyond is read
 * Read are WEAVING (Shafts, Treadles, Rising Shed, which is true unless said otherwise), WARP and WEFT (Threads, Color,
 * Units, Spacing, Thickness), COLOR PALETTE (Entries, Form, Range), COLOR TABLE, THREADING, TIEUP, TREADLING, LIFTPLAN,
 * and COLORS, SPACING, THICKNESS of WARP and WEFT. A thread may be on several shafts, a pick on several treadles; 0 or
 * nothing is none, and so is a thread left out, but for the last one: without that a file counts as cut off. A LIFTPLAN
 * with lines is used instead of TIEUP and TREADLING. Names are compared without case; a semicolon begins a comment;
 * other sections and keys are passed over; of lines with the same key the last one counts. Thread 1 of the file is
 * column or row 0, colour 1 is colour 0. An order of one entry is the family's only colour. Spacing and thickness are 0
 * without Units. Other shared arguments as above.
 * Errors: PARSE (the message names the line, what was expected and what stands there; or what is missing), ARGUMENT
 * (text NULL), MEMORY. Limits as of yc_loom; colours 65536. */
YC_API yc_result yc_draft_wif(const yc_host *host, const char *text, size_t length, yc_draft *out, char *message);

/* Frees what the functions above made and zeroes the struct. NULL is fine; a caller's own draft is left alone. */
YC_API void yc_draft_destroy(yc_draft *draft);

/* Points desc->draft, repeat, order and order_count to the draft, which must live as long as desc is used, and sets
 * spacing where it is known. Orders take effect once the caller gives desc->materials, one for each colour. */
YC_API void yc_draft_use(const yc_draft *draft, yc_weave_desc *desc);

/* Whether a draft makes good cloth. */
typedef struct yc_draft_facts {
    int longest[2]; /* [YC_WARP], [YC_WEFT]: crossings that a yarn passes on one side in a row, at most; 0: endless */
    int holds;      /* 0: some of the yarns lie above all others and come off (Clapham 1980). 1: it holds together */
} yc_draft_facts;
/* draft: its repeat and over are looked at. *out is untouched on failure. Errors: ARGUMENT, MEMORY. Cost: linear
 * in the crossings. */
YC_API yc_result yc_draft_examine(const yc_host *host, const yc_draft *draft, yc_draft_facts *out, char *message);

/* ---- fabrics ---------------------------------------------------------------------------------------------------- */

typedef enum yc_fabric_name {
    YC_FABRIC_SHIRTING,    /* cotton, plain weave */
    YC_FABRIC_LINEN,       /* linen, plain weave */
    YC_FABRIC_DENIM,       /* cotton, 3/1 twill */
    YC_FABRIC_SATIN,       /* polyester filament, five-end satin */
    YC_FABRIC_JERSEY,      /* cotton, single jersey */
    YC_FABRIC_RIB,         /* wool, 1x1 rib, machine-knitted */
    YC_FABRIC_STOCKINETTE, /* wool, hand-knitted */
    YC_FABRIC_SWEATER,     /* wool, garter stitch */
    YC_FABRIC_COUNT
} yc_fabric_name;

/* A fabric that everybody knows: what to make it of, and what is measured on fabrics of this kind, as [low, high], 0
 * and 0 where nothing is known. Ranges are those of the Kawabata system's tests (KES-F), in SI units. */
typedef struct yc_fabric {
    const char *name;    /* "cotton shirting" */
    const char *source;  /* a sentence: where the numbers come from and how sure they are */
    int woven;           /* nonzero: `weave` holds; 0, a knit: yarn, wales, courses, loop, and `weave` is zero */
    yc_weave_desc weave; /* with its draft; size and grain are the defaults */
    yc_yarn_material yarn;
    double wales, courses; /* per m, of the relaxed fabric; wales of both faces */
    double loop;           /* m of yarn in a stitch */
    double mass[2];        /* kg/m^2 */
    double bending[2][2];  /* [YC_WARP], [YC_WEFT], N m, flexural rigidity per width: yarns of that family bend */
    double shear[2];       /* N/m per rad */
    double hysteresis[2];  /* N/m, width of the shear loop (2HG) at 0.5 degrees */
    double tension;        /* N/m, at which `extension` is measured */
    double extension[2];   /* share of the length; a knit's across the wales */
    double drape[2];       /* Cusick's drape coefficient, 0 to 1 */
} yc_fabric;

/* Never fails but for ARGUMENT: out NULL, or a name that is none; then *out is untouched. */
YC_API yc_result yc_fabric_get(yc_fabric_name name, yc_fabric *out);

/* ---- charts and knits ------------------------------------------------------------------------------------------- */

/* Stitches by their names in knitting instructions. Stacks are given as the worker sees them. */
typedef enum yc_stitch {
    YC_STITCH_K,    /* knit: the new loop comes through the old one from the back */
    YC_STITCH_P,    /* purl: from the front */
    YC_STITCH_SL1,  /* slip: the old loop is carried up, the yarn passes behind it */
    YC_STITCH_KTBL, /* knit through the back loop: the old loop's legs cross */
    YC_STITCH_PTBL, /* the same, purled */
    YC_STITCH_YO,   /* yarn over: a loop through no other, which leaves a hole */
    /* make one: knit, twisted, through the bar between two stitches that the row below has made, once for each bar */
    YC_STITCH_M1,
    YC_STITCH_KFB,            /* knit front and back: two loops through one */
    YC_STITCH_K2TOG,          /* one loop through two, the left one on top */
    YC_STITCH_P2TOG,          /* the same, purled */
    YC_STITCH_SSK,            /* the right one on top; also written skpo */
    YC_STITCH_K3TOG,          /* one loop through three, the left one on top, the right one at the bottom */
    YC_STITCH_P3TOG,          /* the same, purled */
    YC_STITCH_SL1_K2TOG_PSSO, /* the right one on top, then the left one */
    YC_STITCH_SL2_K1_P2SSO,   /* the middle one on top, then the right one */
    YC_STITCH_COUNT
} yc_stitch;

typedef struct yc_chart_item {
    int stitch; /* yc_stitch */
    int times;  /* 1 .. 10^6 */
} yc_chart_item;

/* A row's items, in the order in which they are worked: first .. repeat - 1 once, repeat .. after - 1 as often as there
 * are stitches for, after .. last - 1 once. */
typedef struct yc_chart_row {
    int line;       /* of the text; 0: none. Failures name it */
    int wrong_side; /* nonzero: worked with the wrong side in front; its stitches are named as they are worked */
    int first, repeat, after,
        last; /* 0 <= first <= repeat <= after <= last <= item_count; repeat == after: no repeat */
} yc_chart_row;

/* Knitting instructions, bottom row first. Made by yc_chart_read, or filled in by the caller (then the arrays are the
 * caller's, `owner` is NULL and yc_chart_destroy does nothing). */
typedef struct yc_chart {
    int multiple[2]; /* it fits multiple[0] n + multiple[1] stitches, n >= 1, as its text says; 0, 0: not known */
    int row_count;   /* 1 .. 65536 */
    const yc_chart_row *rows; /* [row_count] */
    int item_count;           /* 1 .. 2^20 */
    const yc_chart_item *items;
    void *owner; /* the library's own; NULL: the caller's arrays */
} yc_chart;

/* Reads knitting instructions: a small part of the language of stitch charts, as they are printed.
 *     pattern: Openwork            several patterns may follow each other in a text
 *     multiple: 6 + 1              stitches: 6 n + 1
 *     Rows 1 and 5 (RS): Knit.     RS: the right side is in front, WS: the wrong one; also Rows 1-3, Rows 2, 4 and 6
 *     Row 2 (WS): P1, *k2tog, yo, p4, repeat from *.
 *     Row 3 (RS): *[K1, p1] twice, [yo, ssk] 3 times, repeat from *, k1.       # a comment
 * text  `length` bytes, not zero-terminated; any line ends; nothing beyond is read
 * name  of the pattern wanted, without case; NULL: the first, which needs no line `pattern:`. Others are not looked at
 * Known are all of yc_stitch, skpo (as ssk), counts behind k, p and yo, one repeat of the rest of a row by asterisks,
 * brackets within it or without it (not within each other), Knit. and Purl. for whole rows, and the lines pattern,
 * multiple, note and sure; the last two are passed over. Rows may come in any order, each once, without a gap. Where
 * there is a multiple, all rows must fit onto each other for n = 1 and n = 2.
 * *out receives the chart, untouched on failure, free with yc_chart_destroy. host NULL is a zeroed one; message is NULL
 * or YC_MESSAGE_SIZE bytes.
 * Errors: PARSE (the message names line, row, and the stitch by its number in the row as written: one that is not
 * known, a cable, which stitch contacts cannot hold, a repeat that does not fit), ARGUMENT (text or out NULL), MEMORY.
 * Cost: linear in the text and in the items that its brackets stand for. */
YC_API yc_result yc_chart_read(
    const yc_host *host, const char *text, size_t length, const char *name, yc_chart *out, char *message);

/* Frees what yc_chart_read made and zeroes the struct. NULL is fine; a caller's own chart is left alone. */
YC_API void yc_chart_destroy(yc_chart *chart);

/* A piece of knitting: cast on by backward loops, worked by the chart's rows, which begin anew after the last one,
 * bound off by a chain. One yarn does it all. Or, with a mesh, what is cut from such pieces and sewn. */
typedef struct yc_knit_desc {
    unsigned cookie;       /* set by yc_knit_desc_default() */
    const yc_chart *chart; /* NULL: stockinette; default NULL */
    int stitches;          /* cast on; 1 .. 10^6; default 20 */
    int rows;              /* worked, without cast-on and bind-off; 1 .. 10^6; default 24 */
    /* 0: flat, back and forth; the sides of the chart's rows must then alternate. Nonzero: in the round, a spiral with
     * the right side outward; rows of the wrong side are worked as they look from the right one. Default 0 */
    int round;
    /* nonzero: not bound off. The loops of the last row stand open, and the yarn's end is free: pulled, it unravels row
     * after row. Default 0 */
    int live;
    double wales, courses; /* per m, stitches across and rows along; > 0; default 220, 300: hand-knitted wool */
    double loop;           /* m of yarn in a stitch; >= 0; default 0: as long as it is laid */
    yc_yarn_material yarn; /* default: a wool yarn of 440 tex */
    /* NULL: none. Else every UV island is cut from a flat piece that is knitted as large as it takes: stitches and rows
     * are not looked at, but the chart must fit some number of stitches again and again. Default NULL */
    const yc_mesh *mesh;
    double grain; /* rad, turns rows against u of the pattern, counter-clockwise; only with a mesh; default 0 */
    yc_edge edge; /* ends of yarn at a free outline of the mesh; default YC_EDGE_CUT */
    /* along welded seams of the mesh; rod.density = 0: no rods. Default: the default yarn, twice as heavy */
    yc_yarn_material rod;
} yc_knit_desc;
YC_API yc_knit_desc yc_knit_desc_default(void);

/* A knit fabric that has a name, as yc_fabric_get tells of it: its chart, wales, courses, loop, yarn, and a rod of that
 * yarn, twice as heavy; the rest is the default. Errors: ARGUMENT (out NULL, a woven fabric, or a name that is none);
 * then *out is untouched. */
YC_API yc_result yc_knit_fabric(yc_fabric_name name, yc_knit_desc *out);

/* Knits. The network's layout is seen from the right side, the cast-on at the bottom (z = 0; in the round a tube about
 * the y axis, outward from it): loops are moved, by springs between neighbours, to where their stitches want to be, so
 * that decreases slant and yarn-overs open holes. Every place where a loop is drawn through k >= 1 older ones has four
 * nodes with k + 1 visits each, A and B of its left and of its right contact, and k contacts on each side; a plain
 * stitch thus has four nodes of 5 unknowns. Where a loop's legs cross (cast-on, twisted stitches) is a node with two
 * visits and without a contact; nodes with a single visit stand beside sharp turns: the yarn turns by less than 90
 * degrees everywhere unless stitches are crowded. The ends of the yarn are secured, but for the last one of a live
 * knit. u is measured along the layout, stretched by one factor so that the length in a stitch is `loop`, the mean over
 * the rows that were worked.
 * With a mesh the layout is the pattern's; yarns end on the outline of their island, in a node of their own, and are
 * tied to a rod along every edge where two islands are welded, as yc_weave does it. A stitch contact of which the
 * outline cuts a part goes as a whole: its yarns pass there alone. Yarn without any contact is left out. Since
 * yc_knit_relax cannot settle such pieces, their yarns turn at rest as they are laid, u is measured along the layout,
 * and the yarn's density carries the factor by which `loop` is longer: but for wrapping they lie still, at the gauge
 * that was asked for, and weigh what they should.
 * desc  not NULL; out  receives the network, untouched on failure; free with yc_yarns_destroy. Its materials are the
 *       yarn and, with a mesh, the rod unless rod.density is 0
 * Errors: ARGUMENT (the message names the field, or line, row and stitch of the chart and what does not fit), TOPOLOGY
 * (of the mesh), MEMORY. Limits: 2.5 10^7 loops in all, of an island in the rectangle around it. Cost: linear in these
 * loops and in triangles. */
YC_API yc_result yc_knit(const yc_host *host, const yc_knit_desc *desc, yc_yarns *out, char *message);

/* ---- scene ------------------------------------------------------------------------------------------------------ */

typedef struct yc_scene yc_scene;

typedef enum yc_solver {
    YC_SOLVER_AUTO = 0,  /* direct without hybrid nodes and with few full ones, else YC_SOLVER_TWO_LEVEL */
    YC_SOLVER_DIRECT,    /* sparse LDL^T; not for scenes with hybrid nodes */
    YC_SOLVER_TWO_LEVEL, /* MPCG: incomplete factor of the yarns; coarse space: the mesh, a net where there is none */
    YC_SOLVER_NONE,      /* MPCG of MIX without preconditioner */
    YC_SOLVER_MASS_DIAGONAL, /* MPCG with the mass diagonal, filtered on both sides */
    YC_SOLVER_MASS,          /* MPCG with the preconditioner P of MIX (12), in its sparse form */
    YC_SOLVER_MASS_DENSE     /* the same P by Sherman-Morrison-Woodbury and a dense LU, as in MIX; for comparison */
} yc_solver;

/* Presets of tolerances and step limits together. */
typedef enum yc_preset { YC_PREVIEW, YC_DEFAULT, YC_REFERENCE } yc_preset;

typedef struct yc_scene_desc {
    unsigned cookie;   /* set by yc_scene_desc_preset() */
    double gravity[3]; /* m/s^2; default 0, -9.81, 0 */
    double dt_max;     /* s, longest sub-step; > 0; preview 1/60, default 5e-3, reference 1e-3 */
    double dt_min;     /* s, shortest before a step is given up; (0, dt_max]; default 1e-6 */
    /* m: Newton stops when its largest correction is below; with contact, below half of slip_speed * h, but not below a
     * twentieth of this. A step of h thus accepts a speed error of tolerance / h. > 0; preview 1e-4, default 1e-5,
     * reference 1e-8. */
    double tolerance;
    /* Newton iterations of a sub-step; >= 1; preview 8, else 400. A step that has taken this many for each sub-step it
     * was to have, and for 32 more, fails with the next sub-step that does */
    int newton_limit;
    /* what happens when they do not suffice. 0: the sub-step is halved. Nonzero: the last iterate, the lowest in
     * energy, is taken and counted in stats.unfinished; preview 1, else 0 */
    int best_effort;
    yc_solver solver; /* default YC_SOLVER_AUTO */
    /* MPCG stops at this share of the starting residual, in the preconditioner's norm; (0, 1); default 1e-4,
     * reference 1e-6. YC_SOLVER_TWO_LEVEL stops earlier where what is left moves nothing by 0.01 tolerance */
    double linear_tolerance;
    /* MPCG iterations; >= 1; default 2000. Reaching it is no error: the line search judges the step */
    int linear_limit;
    double stiffness_damping; /* s, Rayleigh's beta, on strain rates: rigid motion is undamped; >= 0; default 0 */
    double mass_damping;      /* 1/s, Rayleigh's alpha; >= 0; default 0 */
    double contact_stiffness; /* N/m of penetration, per point; > 0; default 200 */
    /* m, at which triangles feel bodies, and half of what they keep between each other; > 0; default 1.5e-3 */
    double thickness;
    double slip_speed; /* m/s below which Coulomb friction acts like a viscous brake; > 0; default 1e-3 */
    /* nonzero: cloth against cloth, where it does not touch at rest; default 0. Triangles keep twice `thickness`; nodes
     * of yarns without triangles are spheres, as large as what all yarns there amount to: layers lie about as far apart
     * as cloth is thick, if that is no less than 0.7 of the distance of its nodes; more open cloth lets others through
     */
    int self_contact;
    double self_friction; /* Coulomb coefficient of cloth on cloth; [0, 10]; default 0.2 */
} yc_scene_desc;
YC_API yc_scene_desc yc_scene_desc_preset(yc_preset preset);
YC_API yc_scene_desc yc_scene_desc_default(void); /* YC_DEFAULT */

typedef struct yc_cloth_desc {
    unsigned cookie; /* set by yc_cloth_desc_default() */
    yc_mesh mesh;    /* zero: none, then yarns alone make the cloth */
    /* NULL: triangles alone. Copied, like every array here. A knit is refused with crimp, where more than five yarns
     * are stacked, and on a mesh unless alpha is 1 at all vertices and enrich_all is 0 */
    const yc_yarns *yarns;
    /* [node_count], m: where yarn nodes start; NULL: on the mesh, or at their layout without one */
    const double (*yarn_positions)[3];
    /* [vertex_count], 0 triangles .. 1 yarns, in between both; NULL: alpha_uniform everywhere */
    const double *alpha;
    double alpha_uniform; /* [0, 1]; default 0. Without a mesh 1 is meant and this is not looked at */
    yc_triangle_material material;
    const double *grain;      /* [triangle_count], rad, material's direction against u; NULL: 0 */
    const double *prestretch; /* [triangle_count], rest = UV times this; > 0; NULL: 1 */
    int hold_sliding;         /* nonzero: no yarn slides; default 0 */
    /* nonzero: the network stays as given (see yc_event): no yarn breaks, and none slides further than a fifth of the
     * length laid between two nodes; default 0 */
    int hold_network;
    /* validation (MIX Fig. 3): every triangle hybrid with alpha 1 and no sliding; default 0 */
    int enrich_all;
} yc_cloth_desc;
YC_API yc_cloth_desc yc_cloth_desc_default(void);

typedef enum yc_point { YC_VERTEX, YC_NODE } yc_point; /* a vertex of the mesh, a node of the yarn network */

/* Two chains of points to be sewn, pair by pair: springs draw them together over close_time. Then pairs of vertices are
 * welded into one vertex each, while yarn nodes stay tied by their springs. The caller's indices stay valid: both
 * vertices of a pair then report the same position. */
typedef struct yc_seam_desc {
    unsigned cookie;   /* set by yc_seam_desc_default() */
    int cloth[2];      /* handles; may be the same */
    yc_point kind;     /* of all its points; default YC_VERTEX */
    int count;         /* pairs; >= 1 */
    const int *a, *b;  /* [count], points of cloth[0] and cloth[1]; a[k] meets b[k] */
    double stiffness;  /* N/m per pair; > 0; default 100 */
    double close_time; /* s, over which the springs' rest length shrinks to zero; >= 0; default 0.5 */
    /* m: once every pair of vertices of the seam is closer, after close_time, it is welded; >= 0; default 2e-3 */
    double weld_distance;
    double rest_angle; /* rad, of hinges across the welded seam; (-pi, pi); default 0 */
} yc_seam_desc;
YC_API yc_seam_desc yc_seam_desc_default(void);

/* ---------------------------------------------------------------------------------------------------------------------
 * Bodies: what cloth falls on and is worn by
 * ------------------------------------------------------------------------------------------------------------------ */

/* The shapes a body is made of. Each is a signed distance in metres, negative inside, in the body's own frame. */
typedef enum yc_primitive_type {
    YC_SPHERE,       /* centre a, radius ra */
    YC_ROUNDED_CONE, /* hull of two spheres: centre a with radius ra, centre b with radius rb; a capsule when ra = rb */
    YC_BOX,          /* centre a, half extents b along x, y, z; edges and corners rounded with radius ra, inside b */
    YC_PLANE,        /* half space: a point a of the surface, the normal b pointing out of the solid */
    YC_LOFT          /* stack of superelliptic sections along y, displaced by a; flat caps at both ends */
} yc_primitive_type;

/* One shape. A field that the type does not name above is ignored, so clear the struct first and set what is needed.
 * All lengths in metres and finite. The arrays are copied. */
typedef struct yc_primitive {
    yc_primitive_type type;
    double a[3];       /* see the type; any value */
    double b[3];       /* see the type. Box: each > 0. Plane: any length but zero. Rounded cone: may equal a */
    double ra;         /* sphere: > 0. Rounded cone: >= 0. Box: >= 0 and at most the smallest of b */
    double rb;         /* rounded cone: >= 0, and ra + rb > 0 */
    int section_count; /* loft: 2 to 65536 */
    /* loft, section_count rows: height y (strictly ascending), half width along x (> 0), half depth along z (> 0),
     * centre z. A section is the curve |x / width|^e + |(z - centre) / depth|^e = 1; in between all three go
     * linearly */
    const double (*sections)[4];
    double exponent; /* loft: e above, 2 (ellipse) to 8 (nearly a rectangle); a human torso is near 2.3 */
} yc_primitive;

/* A rigid body: the union of its primitives. Make it with yc_body_desc_default(); any other is refused. */
typedef struct yc_body_desc {
    unsigned cookie;     /* set by yc_body_desc_default() */
    int primitive_count; /* 1 to 65536; default 0, so it must be set */
    /* primitive_count of them, copied; default NULL. Their order matters a little where three or more blend at one
     * place */
    const yc_primitive *primitives;
    /* m, >= 0, default 0: surfaces closer than this blend into each other, by a polynomial smooth union that adds at
     * most a quarter of it per joint; 0 is the sharp union */
    double smooth_radius;
    double friction; /* Coulomb coefficient of cloth on the body, 0 to 10, default 0.3 */
} yc_body_desc;

/* Returns the defaults named above. Never fails. */
YC_API yc_body_desc yc_body_desc_default(void);

/* Terms of the energy, in the order of yc_scene_energy. */
typedef enum yc_term {
    YC_TERM_KINETIC,
    YC_TERM_GRAVITY,
    YC_TERM_STRETCH,
    YC_TERM_BENDING,
    YC_TERM_SHEAR,
    YC_TERM_ADJACENT,
    YC_TERM_FLATTENING,
    YC_TERM_SLIDE,
    YC_TERM_MEMBRANE,
    YC_TERM_HINGE,
    YC_TERM_SEAM,
    YC_TERM_BODY,
    YC_TERM_PAIR,
    YC_TERM_WRAP,   /* of stitch contacts */
    YC_TERM_STITCH, /* their lengths */
    YC_TERM_COUNT
} yc_term;
YC_API const char *yc_term_name(yc_term term);

/* What a step cost and what the scene holds; counts of the last yc_scene_step, sums over its sub-steps. */
typedef struct yc_stats {
    int substeps, rejected; /* accepted sub-steps; tried again at half the step */
    int unfinished;         /* accepted at newton_limit: see best_effort */
    int newton, linear;     /* Newton and MPCG iterations */
    double correction;      /* m, largest correction of the last Newton iteration */
    double residual;        /* N, largest force left over at the last iterate */
    /* s, processor time of this process; 0 where clock() is missing */
    double seconds_assembly, seconds_solve, seconds_contact, seconds;
    int vertices, full_nodes, hybrid_nodes, dummy_nodes; /* in the mechanics; dummy yarn nodes are for drawing only */
    int hybrid_vertices;                                 /* vertices carrying the filter */
    int dofs;                                            /* unknowns of the linear system */
    int body_contacts, pair_contacts;
    int welded;               /* seams welded so far */
    int events;               /* changes of yarn networks: see yc_event */
    size_t bytes, bytes_peak; /* of this scene, as asked of the host */
    yc_solver solver;         /* what YC_SOLVER_AUTO picked */
} yc_stats;

/* Makes an empty scene. desc not NULL and made by a default function; host NULL is a zeroed one. On failure *out is
 * NULL and the reason is in message (NULL, or YC_MESSAGE_SIZE bytes). All functions below need a scene: only
 * yc_scene_destroy and yc_scene_message may be given NULL. */
YC_API yc_result yc_scene_create(const yc_host *host, const yc_scene_desc *desc, yc_scene **out, char *message);
YC_API void yc_scene_destroy(yc_scene *scene); /* NULL is fine */

/* The last failure of a call on this scene, in words; "" before the first. Valid until the next call. */
YC_API const char *yc_scene_message(const yc_scene *scene);
/* The resolved descriptor; gravity, damping, tolerances and step limits may be changed between steps by yc_scene_tune.
 */
YC_API yc_scene_desc yc_scene_desc_get(const yc_scene *scene);
YC_API yc_result yc_scene_tune(yc_scene *scene, const yc_scene_desc *desc);

/* Adds a cloth, a seam, a body. *handle counts from 0 for each kind. Everything given is copied and checked: indices,
 * NaN, areas, winding, materials. Errors: ARGUMENT, TOPOLOGY, MEMORY; the scene is then as before. */
YC_API yc_result yc_scene_add_cloth(yc_scene *scene, const yc_cloth_desc *desc, int *handle);
YC_API yc_result yc_scene_add_seam(yc_scene *scene, const yc_seam_desc *desc, int *handle);
YC_API yc_result yc_scene_add_body(yc_scene *scene, const yc_body_desc *desc, int *handle);

/* Moves a body over the next step to the pose x -> rotation x + translation, rotation by rows, from its given geometry.
 */
YC_API yc_result yc_scene_move_body(yc_scene *scene, int body, const double rotation[9], const double translation[3]);

/* Holds a point where it is (position NULL) or draws it to `position` over the next step, at constant speed; call again
 * to move it on. A vertex in the midst of full yarns has no mechanics: its pin passes to the nearest yarn node.
 * yc_scene_pin_force gives the force, N, that the pin exerts, of the last step. */
YC_API yc_result yc_scene_pin(yc_scene *scene, int cloth, yc_point kind, int index, const double position[3]);
YC_API yc_result yc_scene_unpin(yc_scene *scene, int cloth, yc_point kind, int index);
YC_API yc_result yc_scene_pin_force(const yc_scene *scene, int cloth, yc_point kind, int index, double force[3]);

/* Advances the scene by exactly dt > 0 seconds, in sub-steps of at most dt_max; or fails, with positions, velocities
 * and time as before. stats may be NULL. Errors: ARGUMENT, MEMORY, DIVERGED, CANCELLED. */
YC_API yc_result yc_scene_step(yc_scene *scene, double dt, yc_stats *stats);

/* How the yarn networks of a scene change while it runs, where their yarns are free of triangles. */
typedef enum yc_event_type {
    YC_EVENT_RELEASE, /* `yarn` has slid out of its crossing with `other` at `node`, which stays a node of that alone */
    /* `node`, which `yarn` visited alone, came too close to a crossing, or lies in loose yarn, and is left out */
    YC_EVENT_MERGE,
    YC_EVENT_SPLIT, /* a segment of `yarn` has become long: `node` is new in its middle */
    YC_EVENT_BREAK, /* `yarn` broke: it ends in the new `node`, what is beyond it is the new yarn `other` */
    YC_EVENT_LOOSE, /* `yarn` crosses no other any more; node is -1 */
    /* of knits: */
    YC_EVENT_SLIP, /* a loop of `yarn` has slipped out of those it was drawn through, there at `node`, or fallen open */
    YC_EVENT_PART, /* yarns at `node` have come apart: `yarn` goes on through the new node `other`, in the same place */
    YC_EVENT_COUNT
} yc_event_type;

/* "release", "merge" and so on; never NULL. */
YC_API const char *yc_event_name(yc_event_type type);

typedef struct yc_event {
    yc_event_type type;
    int cloth, yarn, other, node; /* other: see the type; else -1 */
    double time;                  /* s */
} yc_event;

/* What happened in the last yc_scene_step, in order; *count of them. Valid until the next call that changes the scene.
 * A step brings about what the state calls for when a sub-step begins, where `pitch` is the mean distance of
 * neighbouring crossings on the yarns of a family, as the cloth was given:
 * - a free end that is closer than 0.15 pitch, in u, to its crossing slides out of it, and a lone node so close to a
 *   crossing is left out;
 * - a segment longer than twice its pitch, and than twice what was laid there, gets a node;
 * - of a knit, a loop whose head crosses nothing slips out of all that it was drawn through once less than a pitch of
 *   yarn is left between both its upper nodes; a loop whose legs cross falls open likewise; an end leaves both nodes of
 *   a stitch contact at once. Yarns part there, old loops of a stack from each other too: each goes on through a node
 *   of its own in the same place, so that only the energy of wrapping, sliding and stitch length is lost. Lone nodes
 *   are left out when they are within a third of a pitch of a crossing, or new and in loose yarn, and that costs hardly
 *   any energy; within a hundredth they are at any cost. Segments of stitch contacts get no node and do not break;
 * - of the segments of a yarn whose tension exceeds its strength, and which are longer than 0.3 pitch, the one most
 *   overloaded breaks in its middle.
 * Crossings never merge: contact of parallel yarns, and a floor under what is left of a segment, keep two apart.
 * Mass, linear momentum and the positions of all nodes are what they were. Nodes and yarns keep their numbers for ever;
 * new ones come last, except that a node which an event has made may serve again once it is idle. Visits are numbered
 * anew. Pinned nodes, and ends that are tied to a crossing, to a rod or secured (visit_held), are not let go. */
YC_API const yc_event *yc_scene_events(const yc_scene *scene, int *count);

/* The network of a cloth as it is now: visit_u are the present sliding coordinates, and the layout of an end that has
 * slid out of a crossing is that of the crossing. The arrays are the scene's: to be read only, until the next call that
 * changes the scene. Counts of yc_scene_positions and yc_scene_sliding follow it. ARGUMENT: a cloth without yarns. */
YC_API yc_result yc_scene_network(const yc_scene *scene, int cloth, yc_yarns *out);

YC_API double yc_scene_time(const yc_scene *scene);
/* Energies in J, by term; gravity against the world's origin. terms[YC_TERM_COUNT]. Returns MEMORY when the scene could
 * not be built. */
YC_API yc_result yc_scene_energy(yc_scene *scene, double terms[YC_TERM_COUNT]);
/* Total mass, kg; linear and angular momentum about the origin. Any pointer may be NULL. */
YC_API yc_result yc_scene_momentum(yc_scene *scene, double *mass, double linear[3], double angular[3]);

/* Positions, velocities of a cloth's vertices or yarn nodes: out[count][3], count as in its mesh or present network. A
 * vertex in the midst of full yarns is seen where the best affine fit of the yarn nodes around it puts it; dummy yarn
 * nodes follow the mesh, and idle ones stay where they were left. */
YC_API yc_result yc_scene_positions(yc_scene *scene, int cloth, yc_point kind, double (*out)[3]);
YC_API yc_result yc_scene_velocities(yc_scene *scene, int cloth, yc_point kind, double (*out)[3]);
/* Starts a point with a velocity, m/s. */
YC_API yc_result yc_scene_set_velocity(yc_scene *scene, int cloth, yc_point kind, int index, const double velocity[3]);
/* Sliding coordinates u of a cloth's visits, out[visit_count] of its present network. */
YC_API yc_result yc_scene_sliding(yc_scene *scene, int cloth, double *out);

/* The cloth's triangles after welding, [triangle_count][3]: indices into the vertices of `cloth`, every welded vertex
 * by its lowest index. Seams between different cloths leave the triangles alone. */
YC_API yc_result yc_scene_triangles(yc_scene *scene, int cloth, int (*out)[3]);

/* What the triangles carry: [vertex_count], largest principal membrane stress in N/m, area-weighted at the vertices; 0
 * where yarns alone act. */
YC_API yc_result yc_scene_stress(yc_scene *scene, int cloth, double *out);

/* The state as bytes: call with buffer NULL to ask the size. A scene built the same way and loaded continues bit for
 * bit as the saved one does, in one build on one machine. Load refuses the state of another scene with PARSE. */
YC_API yc_result yc_scene_save(yc_scene *scene, void *buffer, size_t *size);
YC_API yc_result yc_scene_load(yc_scene *scene, const void *buffer, size_t size);

/* What a knit has settled to: `scale` is how much wider and higher its middle became. */
typedef struct yc_knit_rest {
    double scale[2];
    int steps, newton;
} yc_knit_rest;

/* Gives a knit that yc_knit laid flat its rest shape (YARN 4.1). Yarn that is straight at rest settles on a table, free
 * and without wrapping, held by friction; what comes of it is the new layout, u its length, and visit_turn how the yarn
 * turns in it, as fibres set where they are left or washed. A piece starts at rest then, but for wrapping, which curls
 * it. The gauge becomes wales / scale[0], courses / scale[1].
 * yarns  not NULL, with visit_turn; untouched on failure; rest  may be NULL
 * Errors: ARGUMENT (no knit, not flat), MEMORY, DIVERGED. Cost: some hundred direct solves of the whole piece. */
YC_API yc_result yc_knit_relax(const yc_host *host, yc_yarns *yarns, yc_knit_rest *rest, char *message);

/* ---------------------------------------------------------------------------------------------------------------------
 * Output: what a renderer wants
 *
 * Everything here works on plain arrays and keeps nothing, so any thread may call it at any time; inside, curves and
 * tubes run host.parallel_for, with the same bits for any number of workers. A host of NULL means malloc, one thread.
 *
 * Each of the three makers is called twice with the same input. First with the arrays of `out` NULL (a cleared struct):
 * it sets the counts. Then the caller allocates the arrays for these counts, in any way, and the second call fills
 * them. A failure leaves counts and arrays as they were; message, NULL or YC_MESSAGE_SIZE bytes, says why. The counts
 * depend on the topology alone: for the frames of an animation only the second call is repeated.
 * ------------------------------------------------------------------------------------------------------------------ */

/* Yarns as smooth curves: polylines of dense points. */
typedef struct yc_curve_desc {
    unsigned cookie; /* set by yc_curve_desc_default() */
    int steps;       /* pieces of the polyline between two nodes; 1 to 64; default 4 */
    /* How far crossing yarns are moved apart: 1, they touch; 0, both pass through the node; [0, 10]; default 1. */
    double offset;
    /* [node_count], nonzero: the node and both its segments of every yarn are left out, which cuts yarns into pieces
     * and leaves the rest where it is. NULL: none; default NULL. */
    const unsigned char *skip;
} yc_curve_desc;
YC_API yc_curve_desc yc_curve_desc_default(void);

typedef struct yc_curves {
    int curve_count; /* in order of the yarns, and along them */
    int point_count;
    int *first;         /* [curve_count + 1], first point of each curve; the last entry is point_count */
    float (*points)[3]; /* [point_count], m; at least two per curve */
    float *radius;      /* [curve_count], m: the material's */
    int *yarn;          /* [curve_count], the yarn it is a piece of */
} yc_curves;

/* Draws a network as curves through its nodes. At a crossing each yarn passes beside the node, along the normal of the
 * plane of both yarns there: layer +1 on the side that u x v of the pattern points to, layer -1 on the other, each by
 * half the sum of both radii times desc->offset. In a stack of a knit each passes by its layer times that, to the side
 * that its stitch contact calls the right one. Lone visits and crossings with a rod are not moved. Between nodes runs
 * a centripetal Catmull-Rom spline: it passes through every one of these points with a continuous direction, without
 * loops or cusps, and is straight where they are.
 * yarns  the network, as for yc_yarns_check, which is called
 * nodes  [node_count], m: where its nodes are, for instance from yc_scene_positions; at most 1e30 in size. Not looked
 *        at, and may be NULL, when counts are asked for
 * desc   not NULL, made by yc_curve_desc_default()
 * out    see above; counts first, then the arrays
 * Errors: ARGUMENT (also when the counts of the second call do not fit, or points are more than an int counts),
 * TOPOLOGY (of the network), MEMORY. */
YC_API yc_result yc_curves_make(const yc_host *host, const yc_yarns *yarns, const double (*nodes)[3],
    const yc_curve_desc *desc, yc_curves *out, char *message);

/* Curves as tubes, one closed surface each, triangles counter-clockwise seen from outside. */
typedef struct yc_tubes {
    int vertex_count; /* per curve: `sides` for each of its points, then the middles of both end caps */
    int triangle_count;
    float (*positions)[3]; /* [vertex_count], m */
    float (*normals)[3];   /* [vertex_count], unit, outward; along the curve in the middle of a cap */
    int (*triangles)[3];   /* [triangle_count], vertex indices */
} yc_tubes;

/* Sweeps a regular polygon along every curve, with frames that do not turn about it and no vertex doubled at a seam.
 * Vertex j around point i of curve k, i from 0, is sides * (first[k] + i) + 2 k + j.
 * curves  filled by yc_curves_make, or the caller's own: two points or more per curve, finite, radius > 0
 * sides   3 to 64
 * out     see above; counts first, then the arrays
 * Errors: ARGUMENT. Allocates nothing. */
YC_API yc_result yc_tubes_make(const yc_host *host, const yc_curves *curves, int sides, yc_tubes *out, char *message);

/* A mesh one level finer. */
typedef struct yc_fine {
    int vertex_count;       /* the mesh's vertices, then one for each of its edges */
    int triangle_count;     /* four for each of the mesh's */
    double (*positions)[3]; /* [vertex_count], m */
    /* [triangle_count], vertex indices, wound like the mesh's: 4 t + k at corner k = 0, 1, 2 of triangle t, and 4 t + 3
     * between those three. */
    int (*triangles)[3];
} yc_fine;

/* One level of Loop's subdivision: smooth inside, and a border that depends on the border alone (a cubic B-spline,
 * which rounds corners off). A vertex where several borders meet, or without a triangle (the other half of a welded
 * pair, with the triangles of yc_scene_triangles), stays where it is.
 * positions  [vertex_count], m; not looked at, and may be NULL, when counts are asked for
 * triangles  [triangle_count], vertex indices; at most two triangles at an edge
 * out        see above; counts first, then the arrays, which are none of the input's
 * Errors: ARGUMENT (indices, counts), TOPOLOGY (an edge of three triangles), MEMORY. Cost: linear. */
YC_API yc_result yc_subdivide(const yc_host *host, const double (*positions)[3], int vertex_count,
    const int (*triangles)[3], int triangle_count, yc_fine *out, char *message);

/* Where a point that triangle *triangle carries with barycentric `weights` lies on the finer mesh: both are replaced by
 * those of the small triangle that it falls into. Weights may leave [0, 1]. With triangle and weights of a yc_yarns
 * this draws the yarns of the triangle region on the subdivided surface. Never fails. */
YC_API void yc_fine_locate(int *triangle, double weights[3]);

/* Vertex normals, weighted by the triangles' areas: normals[vertex_count], unit length, or 0 at a vertex whose
 * triangles have no area. Indices are not checked. Never fails; one thread. */
YC_API void yc_vertex_normals(
    const double (*positions)[3], int vertex_count, const int (*triangles)[3], int triangle_count, float (*normals)[3]);

/* ---- region ------------------------------------------------------------------------------------------------------ */

/* Chooses where yarns go: alpha = 1 at all vertices within `radius` (m, along the mesh's edges, as long as they are in
 * the UVs; a welded edge counts with the shorter of its two lengths) of `center`, 0 elsewhere, so that the ring of
 * triangles around them is hybrid.
 * center  a vertex, or -1: the one with the highest score (score[vertex_count], for instance yc_scene_stress)
 * alpha   [vertex_count], written; chosen  NULL or the center used. Errors: ARGUMENT, TOPOLOGY, MEMORY. */
YC_API yc_result yc_region_select(const yc_host *host, const yc_mesh *mesh, const double *score, int center,
    double radius, double *alpha, int *chosen, char *message);

#ifdef __cplusplus
}
#endif

/* Stop here if you only want to use the library. */

#endif /* YARNCLOTH_H */

#if defined(YARNCLOTH_IMPLEMENTATION) && !defined(YARNCLOTH_IMPLEMENTED)
#define YARNCLOTH_IMPLEMENTED

#if defined(__FAST_MATH__)
#error "yarncloth.h must not be compiled with -ffast-math: it counts on NaN and on the order of sums"
#endif

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Element functions are pure and shared with the GPU: see chapter vec. */
#ifndef YC_FN
#ifdef __CUDACC__
#define YC_FN static __host__ __device__ inline
#else
#define YC_FN static inline
#endif
#endif

YC_API const char *yc_version(void) { return YC_VERSION; }

typedef struct yci_context yci_context;

/* =====================================================================================================================
 * >>host   (chapter 1)
 *
 * What the library asks of its host: memory, a parallel loop, a place for messages. A yci_context is carried by every
 * object; it counts the bytes in use, remembers the last message and is the only way to the host's callbacks.
 *
 * Determinism. yci_parallel cuts [0, count) into blocks of a fixed grain, whatever the number of workers; a body writes
 * only what its block owns, and sums are kept per block and added in block order. So results are the same bits for any
 * worker count, and a host that runs every block inline is legal.
 * ===================================================================================================================== */

struct yci_context {
    yc_host host;
    size_t bytes, peak; /* in use now, and at most so far, without the allocator's own overhead */
    char message[YC_MESSAGE_SIZE];
};

static const char *const yci_result_names[] = {"YC_OK", "YC_ERROR_ARGUMENT", "YC_ERROR_MEMORY", "YC_ERROR_TOPOLOGY",
    "YC_ERROR_NOT_SPD", "YC_ERROR_SINGULAR", "YC_ERROR_DIVERGED", "YC_ERROR_PARSE", "YC_ERROR_CANCELLED"};

YC_API const char *yc_result_name(yc_result result) {
    int index = -(int)result;
    int count = (int)(sizeof yci_result_names / sizeof yci_result_names[0]);
    return index >= 0 && index < count ? yci_result_names[index] : "unknown yc_result";
}

static void yci_say(yci_context *c, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(c->message, sizeof c->message, format, args);
    va_end(args);
}

/* YCI_FAIL(c, code, format, ...) writes the message and hands the code back: `return YCI_FAIL(...)`. A macro, so that
 * tools which read the code see which code that is. */
#define YCI_FAIL(c, code, ...) (yci_say((c), __VA_ARGS__), (code))

static yc_result yci_out_of_memory(yci_context *c, const char *what) {
    return YCI_FAIL(c, YC_ERROR_MEMORY, "out of memory for %s", what);
}

static void yci_log(yci_context *c, const char *format, ...) {
    char text[YC_MESSAGE_SIZE];
    va_list args;
    if (!c->host.log) return;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    c->host.log(c->host.user, text);
}

/* A cookie of 64 bytes stands in front of every block and keeps its size; it also keeps the caller's 64-byte alignment,
 * since the host need only align to 16. The padding in front is stored as well. */
#define YCI_COOKIE 64

static void *yci_alloc_raw(yci_context *c, size_t count, size_t size) {
    size_t total, shift, header[2];
    char *raw, *block;
    if (size && count > ((size_t)-1 / 2 - 2 * YCI_COOKIE) / size) return NULL;
    total = count * size + 2 * YCI_COOKIE;
    raw = (char *)(c->host.alloc ? c->host.alloc(total, c->host.user) : malloc(total));
    if (!raw) return NULL;
    shift = YCI_COOKIE + (YCI_COOKIE - ((size_t)raw & (YCI_COOKIE - 1))) % YCI_COOKIE;
    block = raw + shift;
    header[0] = total, header[1] = shift;
    memcpy(block - sizeof header, header, sizeof header);
    c->bytes += count * size;
    if (c->bytes > c->peak) c->peak = c->bytes;
    return block;
}

static void *yci_alloc(yci_context *c, size_t count, size_t size) {
    void *block = yci_alloc_raw(c, count, size);
    if (block) memset(block, 0, count * size);
    return block;
}

static void yci_free(yci_context *c, void *block) {
    size_t header[2];
    char *raw;
    if (!block) return;
    memcpy(header, (char *)block - sizeof header, sizeof header);
    raw = (char *)block - header[1];
    c->bytes -= header[0] - 2 * YCI_COOKIE;
    if (c->host.free) c->host.free(raw, header[0], c->host.user);
    else free(raw);
}

#define YCI_NEW(c, type, count) ((type *)yci_alloc((c), (size_t)(count), sizeof(type)))     /* zeros */
#define YCI_RAW(c, type, count) ((type *)yci_alloc_raw((c), (size_t)(count), sizeof(type))) /* anything */

/* Makes an array hold at least `need` items of `size` bytes, keeping the first `used`. Growth is by half, so pushing is
 * linear overall. On failure the array is untouched. */
static int yci_reserve(yci_context *c, void **array, int *capacity, int used, int need, size_t size) {
    int grown = *capacity + *capacity / 2;
    void *bigger;
    if (need <= *capacity) return 1;
    if (grown < need) grown = need;
    if (grown < 16) grown = 16;
    bigger = yci_alloc(c, (size_t)grown, size);
    if (!bigger) return 0;
    if (used) memcpy(bigger, *array, (size_t)used * size);
    yci_free(c, *array);
    *array = bigger, *capacity = grown;
    return 1;
}
#define YCI_RESERVE(c, array, capacity, used, need) \
    yci_reserve((c), (void **)&(array), &(capacity), (used), (need), sizeof *(array))

static yc_result yci_context_init(yci_context *c, const yc_host *host) {
    memset(c, 0, sizeof *c);
    if (host) c->host = *host;
    if (!c->host.alloc != !c->host.free)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "host.alloc and host.free must be given both or neither");
    return YC_OK;
}

/* Ends a public function without an object: the message goes to the caller's buffer, "" on success. */
static yc_result yci_report(const yci_context *c, yc_result result, char *message) {
    if (message) memcpy(message, c->message, YC_MESSAGE_SIZE);
    return result;
}

typedef void (*yci_body)(void *arg, int begin, int end);

typedef struct {
    yci_body body;
    void *arg;
    int count, grain;
} yci_loop;

static void yci_run_block(void *context, int block) {
    const yci_loop *loop = (const yci_loop *)context;
    int begin = block * loop->grain, end = begin + loop->grain;
    loop->body(loop->arg, begin, end < loop->count ? end : loop->count);
}

static void yci_parallel(yci_context *c, int count, int grain, yci_body body, void *arg) {
    yci_loop loop;
    int block, blocks = (count + grain - 1) / grain;
    loop.body = body, loop.arg = arg, loop.count = count, loop.grain = grain;
    if (c->host.parallel_for && blocks > 1) {
        c->host.parallel_for(c->host.user, yci_run_block, &loop, blocks);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic, 1) if (blocks > 1)
#endif
    for (block = 0; block < blocks; block++) yci_run_block(&loop, block);
}

/* =====================================================================================================================
 * >>vec   (chapter 2)
 *
 * Vectors of three doubles as plain arrays, 3x3 matrices as double[9] by rows, and the one-sided law of the jamming and
 * contact terms. Everything here is YC_FN: pure, allocation-free, compiled for the CPU and for the GPU alike.
 * ===================================================================================================================== */

YC_FN double yci_min(double a, double b) { return a < b ? a : b; }
YC_FN double yci_max(double a, double b) { return a > b ? a : b; }
YC_FN int yci_min_int(int a, int b) { return a < b ? a : b; }
YC_FN double yci_clamp(double x, double lo, double hi) { return x < lo ? lo : x > hi ? hi : x; }

YC_FN void yci_copy(double *out, const double *a) { out[0] = a[0], out[1] = a[1], out[2] = a[2]; }
YC_FN void yci_add(double *out, const double *a, const double *b) {
    out[0] = a[0] + b[0], out[1] = a[1] + b[1], out[2] = a[2] + b[2];
}
YC_FN void yci_sub(double *out, const double *a, const double *b) {
    out[0] = a[0] - b[0], out[1] = a[1] - b[1], out[2] = a[2] - b[2];
}
YC_FN void yci_scale(double *out, const double *a, double s) {
    out[0] = a[0] * s, out[1] = a[1] * s, out[2] = a[2] * s;
}
YC_FN void yci_axpy(double *y, double s, const double *x) { y[0] += s * x[0], y[1] += s * x[1], y[2] += s * x[2]; }
YC_FN double yci_dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
YC_FN double yci_norm(const double *a) { return sqrt(yci_dot(a, a)); }
YC_FN void yci_cross(double *out, const double *a, const double *b) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x, out[1] = y, out[2] = z;
}
/* Returns the length; a vector too short to have a direction becomes the given fallback. */
YC_FN double yci_normalize(double *a, const double *fallback) {
    double length = yci_norm(a);
    if (length > 1e-150) yci_scale(a, a, 1.0 / length);
    else yci_copy(a, fallback);
    return length;
}
/* A unit vector perpendicular to the unit vector t, by a fixed rule: cross with the axis that t has least of. */
YC_FN void yci_perpendicular(double *out, const double *t) {
    double x = fabs(t[0]), y = fabs(t[1]), z = fabs(t[2]);
    double axis[3] = {0.0, 0.0, 0.0};
    axis[x <= y && x <= z ? 0 : y <= z ? 1 : 2] = 1.0;
    yci_cross(out, t, axis);
    yci_scale(out, out, 1.0 / yci_norm(out));
}
/* One-sided law g: zero for t <= 0, t^3/(6 delta) up to delta, t^2/2 - delta t/2 + delta^2/6 beyond. C2, g'' <= 1. */
YC_FN void yci_one_sided(double t, double delta, double *g, double *dg, double *ddg) {
    if (t <= 0.0) *g = *dg = *ddg = 0.0;
    else if (t < delta) *g = t * t * t / (6.0 * delta), *dg = t * t / (2.0 * delta), *ddg = t / delta;
    else *g = 0.5 * t * t - 0.5 * delta * t + delta * delta / 6.0, *dg = t - 0.5 * delta, *ddg = 1.0;
}
YC_FN void yci_zero(double *a, int count) {
    for (int i = 0; i < count; i++) a[i] = 0.0;
}
#define YCI_PI 3.14159265358979323846
/* The difference of two angles of [-pi, pi], modulo 2 pi, in [-pi, pi]. */
YC_FN double yci_angle_difference(double a, double b) {
    double d = a - b;
    return d > YCI_PI ? d - 2.0 * YCI_PI : d < -YCI_PI ? d + 2.0 * YCI_PI : d;
}

/* =====================================================================================================================
 * >>dense   (chapter 3)
 *
 * Small dense kernels, panels of factors, and LU with partial pivoting:
 *
 *   blocks    YC_FN functions on row-major blocks of at most YCI_BLOCK_MAX rows: the diagonal blocks of the mechanics
 *             (3x3 positions, 5x5 nodes with sliding coordinates, 6x6 pairs of the mixing constraint).
 *   kernels   products, triangular solves and what else the time goes into, on column-major operands where they lie:
 *             tiles of 24x8 for AVX-512 and 12x4 for AVX2, or what the compiler was told of (6x4 for SSE2 and NEON).
 *   panels    Cholesky and block L D L' of the leading columns of a symmetric front.
 *   LU        P A = L U, right-looking by blocks of columns on the kernels (Golub and Van Loan, Matrix Computations,
 *             3.4).
 *
 * LU keeps A by rows, as it comes, and works on it where it lies. A block of columns is halved down to panels of
 * YCI_PANEL columns (recursive as in F. G. Gustavson, IBM J. Res. Dev. 41, 1997). A panel is turned round into an array
 * by columns, in which rows stay where they are until it is done. Then the columns outside are done in strips:
 * exchanges, rows of U, update. A strip's rows of U are copied side by side; L is read where it lies. Solves are dot
 * products along rows, eight at a time, which read the factor once and never write behind it.
 *
 * Measured on AVX-512, gcc -O2: copying a strip's rows of U and fetching its next tile ahead, whose rows lie in
 * different pages, is worth 1.6 at n = 1500. Blocks of 64 columns are best or near it for all n; copying a block's L
 * side by side costs 4 to 7 % up to n = 700 and gains 2 at 3000, strips of 48 or 72 columns gain nothing. A pivot takes
 * 90 cycles at n = 60, nearly all of them waiting for the search, and 140 with exchanges within the panel. Solves that
 * fetch rows ahead are slower by 15 % at n = 1500 with one right-hand side, since processors foresee eight rows.
 *
 * Promises: each entry of a result is summed in one order, whatever the number of workers.
 * ===================================================================================================================== */

#define YCI_BLOCK_MAX 8                          /* rows of the largest node block: a stack of five yarns */
#define YCI_LU_BLOCK 64                          /* columns of LU's largest block */
#define YCI_LU_STRIP 24                          /* columns right of a block that are updated together */
#define YCI_LU_BEHIND 64                         /* numbers behind a block that its search may read */
#define YCI_LU_LEFT 480                          /* columns left of a block whose rows are exchanged together */
#define YCI_PIVOT_TOLERANCE (64.0 * DBL_EPSILON) /* a pivot this small against what it came from is rounding error */

/* A = G G' in place: the lower triangle of the row-major n x n block becomes G, the upper is neither read nor written.
 * reference[i * stride] is the size that pivot i came from, before anything was subtracted: a pivot lost in its
 * rounding counts as zero. Returns 1 when A is positive definite; NaN and infinity are not. */
YC_FN int yci_block_cholesky(int n, double *a, const double *reference, int stride) {
    int i, j, k;
    for (j = 0; j < n; j++) {
        double pivot = a[j * n + j];
        for (k = 0; k < j; k++) pivot -= a[j * n + k] * a[j * n + k];
        if (!(pivot > 0.0 && pivot > YCI_PIVOT_TOLERANCE * reference[j * stride] && pivot <= DBL_MAX)) return 0;
        a[j * n + j] = pivot = sqrt(pivot);
        for (i = j + 1; i < n; i++) {
            double sum = a[i * n + j];
            for (k = 0; k < j; k++) sum -= a[i * n + k] * a[j * n + k];
            a[i * n + j] = sum / pivot;
        }
    }
    return 1;
}

/* The inverse of a lower triangle, with zeros above its diagonal. */
YC_FN void yci_block_invert_lower(int n, const double *g, double *inverse) {
    int i, j, k;
    for (j = 0; j < n; j++) {
        for (i = 0; i < j; i++) inverse[i * n + j] = 0.0;
        for (i = j; i < n; i++) {
            double sum = i == j ? 1.0 : 0.0;
            for (k = j; k < i; k++) sum -= g[i * n + k] * inverse[k * n + j];
            inverse[i * n + j] = sum / g[i * n + i];
        }
    }
}

/* The inverse of a symmetric positive definite block (its lower triangle is read); arguments as for the Cholesky. */
YC_FN int yci_block_invert_spd(int n, const double *a, const double *reference, int stride, double *inverse) {
    double g[YCI_BLOCK_MAX * YCI_BLOCK_MAX], h[YCI_BLOCK_MAX * YCI_BLOCK_MAX];
    int i, j, k;
    memcpy(g, a, (size_t)(n * n) * sizeof *g);
    if (!yci_block_cholesky(n, g, reference, stride)) return 0;
    yci_block_invert_lower(n, g, h);
    for (i = 0; i < n; i++)
        for (j = 0; j <= i; j++) {
            double sum = 0.0;
            for (k = i; k < n; k++) sum += h[k * n + i] * h[k * n + j];
            inverse[i * n + j] = inverse[j * n + i] = sum;
        }
    return 1;
}

/* Scales s with s_i |a_ij| s_j <= 1, and close to 1 somewhere in every row: row after row by what stands at or before
 * its diagonal (J. R. Bunch, Equilibration of symmetric matrices in the max-norm, J. ACM 18, 1971), then the rows that
 * had nothing there by all of it. For a pair [[m g],[g -k]] with small m k that gives the first row or the last all
 * the weight, and drowns k or m; so it is done from both ends, and the geometric mean, which obeys the same bounds,
 * makes both diagonals equal. Elimination then pivots on g and keeps m and k, even a k beside an m that is only
 * noise. */
YC_FN void yci_block_equilibrate(int n, const double *a, double *s) {
    double t[2][YCI_BLOCK_MAX];
    int i, j, step, side, pass;
    for (side = 0; side < 2; side++) {
        for (i = 0; i < n; i++) t[side][i] = 0.0;
        for (pass = 0; pass < 2; pass++)
            for (step = 0; step < n; step++) {
                double most, first = 0.0;
                i = side ? n - 1 - step : step;
                if (t[side][i] > 0.0) continue;
                most = sqrt(fabs(a[i * n + i]));
                for (j = 0; j < n; j++) most = yci_max(most, t[side][j] * fabs(a[i * n + j]));
                for (j = 0; pass && most == 0.0 && j < n; j++)
                    if (t[side][j] == 0.0) first = yci_max(first, sqrt(fabs(a[i * n + j])));
                if (most == 0.0) most = first;
                if (most > 0.0) t[side][i] = 1.0 / most;
            }
    }
    for (i = 0; i < n; i++) s[i] = sqrt(t[0][i]) * sqrt(t[1][i]);
}

/* The inverse of a symmetric block of two rows that is far from singular, measured as yci_block_invert does: its
 * determinant beside the larger of the two products that it is the difference of. Returns half the quotient, which the
 * smallest pivot is not below, or 0 where that is in doubt. */
YC_FN double yci_block_invert_pair(const double *a, const double *reference, double *inverse) {
    double x = yci_max(fabs(a[0]), fabs(reference[0])), y = yci_max(fabs(a[1]), fabs(reference[1]));
    double z = yci_max(fabs(a[3]), fabs(reference[3])), most = yci_max(x * z, y * y);
    double determinant = a[0] * a[3] - a[1] * a[1], factor = 1.0 / determinant;
    inverse[0] = a[3] * factor, inverse[1] = inverse[2] = -a[1] * factor, inverse[3] = a[0] * factor;
    return most > DBL_MIN / DBL_EPSILON && most <= DBL_MAX && fabs(determinant) > 1e-6 * most &&
            fabs(inverse[0]) <= DBL_MAX && fabs(inverse[1]) <= DBL_MAX && fabs(inverse[3]) <= DBL_MAX
        ? 0.5 * fabs(determinant) / most
        : 0.0;
}

/* The inverse of a symmetric block that may be indefinite, by Gauss-Jordan elimination with complete pivoting on the
 * equilibrated block. `reference` (n x n) holds the block before anything was subtracted from it, so that one that
 * cancelled to rounding error is seen as singular. Returns the smallest pivot of the equilibrated block (or a bound
 * from below), 0 when it is singular to working precision or not finite; `inverse` is then meaningless. */
YC_FN double yci_block_invert(int n, const double *a, const double *reference, double *inverse) {
    double m[YCI_BLOCK_MAX * YCI_BLOCK_MAX], s[YCI_BLOCK_MAX], smallest;
    int row_of[YCI_BLOCK_MAX], column_of[YCI_BLOCK_MAX], i, j, step; /* pivots, by column and by row */
    if (n == 2 && (smallest = yci_block_invert_pair(a, reference, inverse)) > 0.0) return smallest;
    smallest = 1.0;
    for (i = 0; i < n * n; i++) m[i] = yci_max(fabs(reference[i]), fabs(a[i]));
    yci_block_equilibrate(n, m, s);
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++) m[i * n + j] = s[i] * a[i * n + j] * s[j];
    for (i = 0; i < n; i++) column_of[i] = row_of[i] = -1;
    for (step = 0; step < n; step++) {
        int row = -1, column = -1;
        double most = 0.0, pivot;
        for (i = 0; i < n; i++)
            for (j = 0; j < n; j++)
                if (column_of[i] < 0 && row_of[j] < 0 && fabs(m[i * n + j]) > most)
                    most = fabs(m[i * n + j]), row = i, column = j;
        if (!(most > YCI_PIVOT_TOLERANCE && most <= DBL_MAX)) return 0.0;
        smallest = yci_min(smallest, most);
        column_of[row] = column, row_of[column] = row;
        pivot = m[row * n + column];
        m[row * n + column] = 1.0;
        for (j = 0; j < n; j++) m[row * n + j] /= pivot;
        for (i = 0; i < n; i++) {
            double factor = m[i * n + column];
            if (i == row) continue;
            m[i * n + column] = 0.0;
            for (j = 0; j < n; j++) m[i * n + j] -= factor * m[row * n + j];
        }
    }
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++) {
            inverse[i * n + j] = s[i] * m[row_of[i] * n + column_of[j]] * s[j];
            if (!(fabs(inverse[i * n + j]) <= DBL_MAX)) return 0.0;
        }
    for (i = 0; i < n; i++)
        for (j = 0; j < i; j++)
            inverse[i * n + j] = inverse[j * n + i] = 0.5 * (inverse[i * n + j] + inverse[j * n + i]);
    return smallest;
}

/* The inverse of a singular block with `shift` added to its diagonal, away from zero as `reference` tells. */
YC_FN int yci_block_repair(int n, double *a, const double *reference, double shift, double *inverse) {
    double size[YCI_BLOCK_MAX * YCI_BLOCK_MAX];
    int i;
    for (i = 0; i < n * n; i++) size[i] = reference[i];
    for (i = 0; i < n; i++) {
        double sign = reference[i * (n + 1)] < 0.0 ? -1.0 : 1.0;
        a[i * (n + 1)] += sign * shift, size[i * (n + 1)] = sign * shift;
    }
    return shift > 0.0 && yci_block_invert(n, a, size, inverse) > 0.0;
}

/* ------------------------------------------------------------------------------------------------------ kernels --- */

/* What the sparse factorisation, its solves and LU spend their time in. Matrices are by columns, entry (i, j) at
 * x[j * ld + i]. Kernels take rows by whole vectors: they may read up to YCI_OVERREAD numbers behind an operand, whose
 * values do not matter, and write nothing but what they were asked for. */
#define YCI_PANEL 8    /* columns that are factored together */
#define YCI_OVERREAD 8 /* numbers behind every array that a kernel reads */
#define YCI_RIGHT 4    /* right-hand sides that are solved together */
#define YCI_AHEAD 2048 /* numbers by which a solve asks for L ahead of its use */
#define YCI_CORNER 40  /* numbers of a corner */

/* Adds columns of `source` to columns of `target` in which their rows stand further apart: row k of the source goes to
 * row place[k], column k to column place[k]. Rows are told in chunks: chunk[c], at << 8 | bits, brings the source's
 * rows at, at + 1, ... to the target's rows 8 (base + c) + bit, for the bits that are set. What lies above the diagonal
 * is moved like the rest and means nothing. */
typedef struct yci_expansion {
    int count, chunks, base, column, row; /* columns to add; the target's first column and row are these */
    const int *place, *chunk;
    const double *source; /* its columns from the one that goes to place[0] */
    double *target;
    size_t source_ld, target_ld;
} yci_expansion;

/* The columns of L that one front gives, height x width. Row i of them is unknown first + i of y where i < width, and
 * then row[i - width], of which there are YCI_OVERREAD - 1 more that name a spare entry of y. They are stored in the
 * order of a forward solve, panel by panel of YCI_PANEL columns (the last may have fewer): the corner, which takes in
 * the panel's first YCI_PANEL rows, and then the rows behind it in tiles of YCI_PANEL of them (the last may have
 * fewer), each by columns. A corner holds reciprocals of the diagonal (one where there is no column), what is below
 * it by columns, divided by the column's diagonal, and spare numbers. */
typedef struct yci_trapezoid {
    const double *l;
    int first, width, height;
    const int *row;
} yci_trapezoid;

/* A small factor L D L' in tiles of YCI_PANEL x YCI_PANEL numbers, by columns, aligned both ways: D has one block per
 * tile on the diagonal, L unit blocks there. Nothing is searched for and no index is read inside a tile. The price is
 * the inverse P of a whole diagonal tile C, taken without pivoting, with which errors grow by its condition. That is
 * measured by the sum of |C_ij P_ij| (for positive definite C, at least an eighth of the condition that scaling leaves)
 * and YCI_TILE_LOSS times that with what C came from. Above YCI_TILE_CONDITION, what is multiplied by P is refined once
 * (a mass matrix stays at 11, where 8 is the least). That cannot mend L D L', in which terms larger than their sum
 * cancel, unlike in a Cholesky factor: above YCI_TILE_LIMIT, or YCI_TILE_INDEFINITE, the tile is refused. With 12 and
 * 200 residuals of chains, grids, hubs and springs stay within about twice CHOLMOD's; 16 and 1e4 gave up to three and
 * eleven times. A pair of pivots is refused that is not positive definite (spd) or else as ill-conditioned by itself,
 * which the ones behind it may undo in P but not in its errors, or whose determinant is near what underflows. */
typedef struct yci_tiles {
    int blocks, spd;
    int *begin;     /* blocks + 1: first tile of every column, the one on the diagonal */
    int *row;       /* a tile's row of tiles, ascending in a column */
    int *target;    /* the tiles that are changed by all pairs (a, b >= a) of a column's tiles below the diagonal */
    int *refine;    /* blocks: whether what is multiplied by inverse(D) is refined */
    double *l;      /* L below the diagonal, inverse(D) on it */
    double *kept;   /* D; while it is made, the tiles on the diagonal before anything was subtracted */
    double *scaled; /* work: L D of one column */
} yci_tiles;
#define YCI_TILE (YCI_PANEL * YCI_PANEL)
#define YCI_TILE_CONDITION 12.0
#define YCI_TILE_LIMIT 200.0
#define YCI_TILE_INDEFINITE 64.0
#define YCI_TILE_LOSS 1e-6
#define YCI_TILE_LEAST 1e-280

/* Numbers that these columns take. */
static size_t yci_packed(int width, int height) {
    size_t count = 0;
    int c;
    for (c = 0; c < width; c += YCI_PANEL) {
        count += YCI_CORNER;
        if (height - c > YCI_PANEL)
            count += (size_t)yci_min_int(YCI_PANEL, width - c) * (size_t)(height - c - YCI_PANEL);
    }
    return count;
}

/* A panel of LU, m rows by n <= YCI_PANEL columns at a, rows lda apart. It is turned round into w, where columns are
 * ldw apart and have YCI_LU_BEHIND numbers behind them, and factored there. Step j exchanges rows j and pivot[j] of
 * what lies from `first` to `last` beside a, the panel itself included. Its corner goes to `corner` by columns, and one
 * over the diagonal to `inverse`. The panel has YCI_PANEL columns and YCI_PANEL rows or more, in whole vectors, zero
 * where there is nothing. The kernel returns n, or the column that has no pivot. */
typedef struct yci_panel {
    double *w;
    size_t ldw;
    int first, last;
} yci_panel;

/* Products of blocks of at most YCI_BLOCK_MAX rows and columns, all by columns: A_p is m x k_p, B_p is n x k_p. */
#define YCI_BLOCK_TERMS 16
typedef struct {
    int count, k[YCI_BLOCK_TERMS];
    const double *a[YCI_BLOCK_TERMS], *b[YCI_BLOCK_TERMS];
} yci_block_terms;

/* A triangular factor by rows of blocks, `at` those left of the diagonal and `corner` the inverses of those on it, all
 * by columns; of every column, `down` are its blocks below the diagonal and `row` their rows. `y`, the vector, has
 * YCI_BLOCK_MAX numbers for every row of blocks, zero behind dim[i]. */
typedef struct {
    int count;
    const int *dim, *ptr, *col, *down_ptr, *down, *row;
    const size_t *at, *corner;
    const double *val;
    double *y;
} yci_substitution;

typedef struct yci_kernels {
    const char *name;

    /* C -= A B' (add), or C = -A B': C is m x n, A is m x k, B is n x k. */
    void (*product)(
        int m, int n, int k, const double *a, size_t lda, const double *b, size_t ldb, double *c, size_t ldc, int add);

    /* C := (C - A B') inverse(G'), C being m x n with n <= YCI_PANEL. G is lower triangular, its entry (i, j) below the
     * diagonal at g[YCI_PANEL * j + i]; inverse[j] is one over its diagonal entry j. */
    void (*strips)(int m, int n, int k, const double *a, size_t lda, const double *b, size_t ldb, const double *g,
        const double *inverse, double *c, size_t ldc);

    void (*expand)(const yci_expansion *e);

    /* Turns height x width columns of a front, one behind the other, into those of a yci_trapezoid, in place; diagonal
     * blocks of YCI_PANEL columns are as corners want them. `work`: YCI_PANEL * (height + 2 * YCI_OVERREAD). */
    void (*pack)(int width, int height, double *l, double *work);

    /* Solves with one front of a sparse factor, in place on y: `count` arrays, at most YCI_RIGHT, of ldy numbers. `z`
     * is work, ldz >= height + 2 * YCI_OVERREAD. */
    void (*forward)(const yci_trapezoid *s, double *y, size_t ldy, int count, double *z, size_t ldz);
    void (*backward)(const yci_trapezoid *s, double *y, size_t ldy, int count, double *z, size_t ldz);

    /* Factors in place the matrix in `l`; returns 0 where the tiles cannot. Solves with count
     * <= YCI_RIGHT arrays y, in tiles like the unknowns. */
    int (*tiles_factor)(const yci_tiles *t);
    void (*tiles_solve)(const yci_tiles *t, double *y, size_t ldy, int count);

    /* For LU. Whether A's entries, m x n at a[i * lda + j], are finite. A is the only operand that ends where it
     * ends. */
    int (*finite)(size_t m, size_t n, const double *a, size_t lda);

    /* Copies A, n x n, to F, with zeros around it up to whole panels. Leaves in `sums` those of |A|'s columns, the
     * largest of them in *norm, and returns the largest |a[i * lda + j]|. */
    double (*take)(int n, const double *a, size_t lda, double *f, size_t ldf, double *sums, double *norm);

    /* B = A', m and n being multiples of YCI_PANEL. */
    void (*transpose)(int m, int n, const double *a, size_t lda, double *b, size_t ldb);

    /* Factors n <= YCI_PANEL columns with partial pivoting; see yci_panel. */
    int (*panel)(const yci_panel *p, int m, int n, double *a, size_t lda, int *pivot, double *corner, double *inverse);

    /* Exchanges the rows k and pivot[k], each n numbers at a + row * lda, for k = 0 to count - 1. */
    void (*exchange)(int count, const int *pivot, int n, double *a, size_t lda);

    /* The columns at c, m <= YCI_LU_STRIP of them in whole vectors, right of a block of k <= YCI_LU_BLOCK columns at l,
     * which has been factored: its first k rows become rows of U, its other n - k are updated. k and n are multiples of
     * YCI_PANEL. */
    void (*update)(int m, int n, int k, const double *l, size_t ldl, double *c, size_t ldc);

    /* X := inverse(L U) X, or of its transpose, for count <= YCI_RIGHT. The factor lies by rows at f, its corners of
     * YCI_PANEL rows also by columns at `corner`; inverse: one over U's diagonal. */
    void (*solve)(int n, const double *f, size_t ld, const double *corner, const double *inverse, double *x, size_t ldx,
        int count);
    void (*solve_transposed)(
        int n, const double *f, size_t ld, const double *inverse, double *x, size_t ldx, int count);

    /* D = C - sum A_p B_p', or that times H' where H, n x n, is given. C and D are m x n; behind each of the operands
     * YCI_BLOCK_MAX numbers may be read, and behind D written. */
    void (*block)(int m, int n, const yci_block_terms *t, const double *c, const double *h, double *d);

    /* y = A x, m numbers, for `count` blocks by rows, one behind the other at `a`, each m x dim[col[k]] and to be
     * multiplied by x + off[col[k]]. Behind them YCI_BLOCK_MAX numbers may be read. */
    void (*row)(
        int m, int count, const int *col, const int *dim, const int *off, const double *a, const double *x, double *y);

    /* y := inverse(L L') y. Behind the factor YCI_BLOCK_MAX numbers may be read, all of them finite. */
    void (*substitute)(const yci_substitution *t);
} yci_kernels;

#ifdef YC_USE_LAPACK
#ifdef __cplusplus
extern "C" {
#endif
void dgemm_(const char *transpose_a, const char *transpose_b, const int *m, const int *n, const int *k,
    const double *alpha, const double *a, const int *lda, const double *b, const int *ldb, const double *beta,
    double *c, const int *ldc);
void dgetrf_(const int *m, const int *n, double *a, const int *lda, int *pivot, int *info);
void dgetrs_(const char *transposed, const int *n, const int *count, const double *a, const int *lda, const int *pivot,
    double *x, const int *ldx, int *info);
#ifdef __cplusplus
}
#endif

/* A product large enough for a BLAS. */
static void yci_product_lapack(
    int m, int n, int k, const double *a, size_t lda, const double *b, size_t ldb, double *c, size_t ldc, int add) {
    const double minus = -1.0, beta = add ? 1.0 : 0.0;
    int ld[3];
    ld[0] = (int)lda, ld[1] = (int)ldb, ld[2] = (int)ldc;
    dgemm_("N", "T", &m, &n, &k, &minus, a, ld, b, ld + 1, &beta, c, ld + 2);
}
#endif

/* The kernels are written once, on vectors, and compiled once per instruction set: for two of x86-64, which are used
 * where the processor has them whatever the compiler was told, and for what the compiler was told. To that end the file
 * includes itself: define YC_SELF as its name where that is not yarncloth.h. YC_NO_SIMD leaves plain C alone. */
#if defined(__GNUC__) && !defined(YC_NO_SIMD) && !defined(__CUDACC__)
#define YCI_GNU
#ifdef __clang__
#define YCI_UNROLL _Pragma("clang loop unroll(full)")
#else
#define YCI_UNROLL _Pragma("GCC unroll 8")
#endif
#define YCI_INLINE static inline __attribute__((always_inline))
#define YCI_PREFETCH(p) __builtin_prefetch(p)
#else
#define YCI_PREFETCH(p) ((void)(p))
#define YCI_UNROLL
#define YCI_INLINE static inline
#endif

/* The number of the lowest bit that is set, of one at least. */
static inline int yci_first_bit(unsigned long long bits) {
#ifdef YCI_GNU
    return __builtin_ctzll(bits);
#else
    int i = 0;
    while (!(bits >> i & 1)) i++;
    return i;
#endif
}

#if defined(YCI_GNU) && defined(__x86_64__)
#define YCI_X86
#include <immintrin.h>
#ifndef YC_SELF
#define YC_SELF "yarncloth.h"
#endif
#define YCI_ISA 512
#include YC_SELF
#undef YCI_ISA
#define YCI_ISA 256
#include YC_SELF
#undef YCI_ISA
#endif
#define YCI_ISA 0
#endif /* of what is read once */

#ifdef YCI_ISA /* ---- read once per instruction set, until the line that says so ---- */

#ifdef __clang__ /* says so of loops that it does unroll, in another place */
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wpass-failed"
#elif defined(__GNUC__) /* says so of its own intrinsics, whose unused operands are left undefined */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#endif

/* V: V_W doubles. A tile of V_TILE_V vectors by V_TILE_N columns stays in registers beside its operands; so does a
 * strip of V_STRIP_V vectors by YCI_PANEL columns, and so do V_COLUMNS sums for three right-hand sides. V_STORE_PART
 * stores the first n numbers, 1 <= n <= V_W. */
#if YCI_ISA == 512
#define YCI_(name) name##_avx512
#define YCI_TARGET __attribute__((target("avx512f,avx512dq,avx512vl,avx2,fma")))
#define V __m512d
#define V_W 8
#define V_TILE_V 3
#define V_TILE_N 8
#define V_STRIP_V 3
#define V_COLUMNS 8
#define V_SET(x) _mm512_set1_pd(x)
#define V_LOAD(p) _mm512_loadu_pd(p)
#define V_STORE(p, x) _mm512_storeu_pd(p, x)
#define V_STORE_PART(p, x, n) _mm512_mask_storeu_pd(p, (__mmask8)((1u << (n)) - 1u), x)
#define V_ADD(a, b) _mm512_add_pd(a, b)
#define V_SUB(a, b) _mm512_sub_pd(a, b)
#define V_MUL(a, b) _mm512_mul_pd(a, b)
#define V_FMA(a, b, c) _mm512_fmadd_pd(a, b, c)
#define V_FNMA(a, b, c) _mm512_fnmadd_pd(a, b, c)
#define V_ALL_ROWS 4
#define V_COUNT _mm512_setr_pd(0, 1, 2, 3, 4, 5, 6, 7)
#define V_LOAD_PART(p, n) _mm512_maskz_loadu_pd((__mmask8)((1u << (n)) - 1u), p)
#define V_ABS(a) _mm512_abs_pd(a)
#define V_MAX(a, b) _mm512_max_pd(a, b)
#define V_PICK(a, b, x, y) _mm512_mask_blend_pd(_mm512_cmp_pd_mask(a, b, _CMP_GT_OQ), y, x)
#define V_SAME(a, b, x, y) _mm512_mask_blend_pd(_mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ), y, x)
#define V_WHERE(a, b) _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ)
#define V_MOST(a) yci_most_lane_avx512(a)
#define V_FIRST(a) _mm512_cvtsd_f64(a)
#define V_SIGNED(a, b) _mm512_or_pd(a, _mm512_and_pd(b, _mm512_set1_pd(-0.0)))
#define V_LANE(a, i) _mm512_permutexvar_pd(_mm512_set1_epi64(i), a)
YCI_TARGET static inline V yci_most_lane_avx512(V x) {
    x = _mm512_max_pd(x, _mm512_shuffle_f64x2(x, x, 0x4e));
    x = _mm512_max_pd(x, _mm512_shuffle_f64x2(x, x, 0xb1));
    return _mm512_max_pd(x, _mm512_permute_pd(x, 0x55));
}
#define V_EXPAND(p, bits) _mm512_maskz_expand_pd((__mmask8)(bits), _mm512_loadu_pd(p))
#define V_FNMA1(a, b, c) __builtin_fma(-(a), b, c)
#elif YCI_ISA == 256
#define YCI_(name) name##_avx2
#define YCI_TARGET __attribute__((target("avx2,fma")))
#define V __m256d
#define V_W 4
#define V_TILE_V 3
#define V_TILE_N 4
#define V_STRIP_V 1
#define V_COLUMNS 4
#define V_SET(x) _mm256_set1_pd(x)
#define V_LOAD(p) _mm256_loadu_pd(p)
#define V_STORE(p, x) _mm256_storeu_pd(p, x)
#define V_STORE_PART(p, x, n) _mm256_maskstore_pd(p, yci_first_lanes_avx2(n), x)
#define V_ADD(a, b) _mm256_add_pd(a, b)
#define V_SUB(a, b) _mm256_sub_pd(a, b)
#define V_MUL(a, b) _mm256_mul_pd(a, b)
#define V_FMA(a, b, c) _mm256_fmadd_pd(a, b, c)
#define V_FNMA(a, b, c) _mm256_fnmadd_pd(a, b, c)
#define V_FNMA1(a, b, c) __builtin_fma(-(a), b, c)
#define V_ALL_ROWS 2
#define V_COUNT _mm256_setr_pd(0, 1, 2, 3)
#define V_LOAD_PART(p, n) _mm256_maskload_pd(p, yci_first_lanes_avx2(n))
#define V_ABS(a) _mm256_andnot_pd(_mm256_set1_pd(-0.0), a)
#define V_MAX(a, b) _mm256_max_pd(a, b)
#define V_PICK(a, b, x, y) _mm256_blendv_pd(y, x, _mm256_cmp_pd(a, b, _CMP_GT_OQ))
#define V_LANE(a, i) _mm256_set1_pd((a)[i])
#define V_SAME(a, b, x, y) _mm256_blendv_pd(y, x, _mm256_cmp_pd(a, b, _CMP_EQ_OQ))
#define V_WHERE(a, b) (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_EQ_OQ))
#define V_MOST(a) yci_most_lane_avx2(a)
#define V_FIRST(a) _mm256_cvtsd_f64(a)
#define V_SIGNED(a, b) _mm256_or_pd(a, _mm256_and_pd(b, _mm256_set1_pd(-0.0)))
YCI_TARGET static inline V yci_most_lane_avx2(V x) {
    x = _mm256_max_pd(x, _mm256_permute2f128_pd(x, x, 1));
    return _mm256_max_pd(x, _mm256_permute_pd(x, 5));
}
YCI_TARGET static inline __m256i yci_first_lanes_avx2(int n) {
    return _mm256_cmpgt_epi64(_mm256_set1_epi64x(n), _mm256_setr_epi64x(0, 1, 2, 3));
}
#else
#define YCI_(name) name##_plain
#define YCI_TARGET
#define V_TILE_V 3
#define V_TILE_N 4
#define V_STRIP_V 1
#define V_COLUMNS 4
#define V_ADD(a, b) ((a) + (b))
#define V_SUB(a, b) ((a) - (b))
#define V_MUL(a, b) ((a) * (b))
#define V_FMA(a, b, c) ((c) + (a) * (b))
#define V_FNMA(a, b, c) ((c) - (a) * (b))
#define V_FNMA1(a, b, c) ((c) - (a) * (b))
#define V_ALL_ROWS 1
#define V_MAX(a, b) V_PICK(a, b, a, b)
#ifdef YCI_GNU
#define V yci_two
#define V_W 2
typedef double yci_two __attribute__((vector_size(16)));
typedef double yci_unaligned_two __attribute__((vector_size(16), aligned(8), may_alias));
static inline yci_two yci_two_set(double x) {
    yci_two v = {x, x};
    return v;
}
static inline void yci_two_store_part(double *p, yci_two x, int n) {
    p[0] = x[0];
    if (n > 1) p[1] = x[1];
}
#define V_SET(x) yci_two_set(x)
#define V_LOAD(p) ((yci_two)(*(const yci_unaligned_two *)(p)))
#define V_STORE(p, x) (*(yci_unaligned_two *)(p) = (x))
#define V_STORE_PART(p, x, n) yci_two_store_part(p, x, n)
typedef long long yci_two_masks __attribute__((vector_size(16)));
static inline yci_two yci_two_count(void) {
    yci_two v = {0.0, 1.0};
    return v;
}
static inline yci_two yci_two_load_part(const double *p, int n) {
    yci_two v = {p[0], 0.0};
    if (n > 1) v[1] = p[1];
    return v;
}
static inline yci_two yci_two_pick(yci_two a, yci_two b, yci_two x, yci_two y) {
    yci_two_masks where = (yci_two_masks)(a > b);
    return (yci_two)(((yci_two_masks)x & where) | ((yci_two_masks)y & ~where));
}
static inline yci_two yci_two_same(yci_two a, yci_two b, yci_two x, yci_two y) {
    yci_two_masks where = (yci_two_masks)(a == b);
    return (yci_two)(((yci_two_masks)x & where) | ((yci_two_masks)y & ~where));
}
#define V_COUNT yci_two_count()
#define V_LOAD_PART(p, n) yci_two_load_part(p, n)
#define V_PICK(a, b, x, y) yci_two_pick(a, b, x, y)
#define V_ABS(a) V_PICK(a, -(a), a, -(a))
#define V_LANE(a, i) yci_two_set((a)[i])
#define V_SAME(a, b, x, y) yci_two_same(a, b, x, y)
#define V_WHERE(a, b) ((unsigned)((a)[0] == (b)[0]) | (unsigned)((a)[1] == (b)[1]) << 1)
#define V_MOST(a) yci_two_set(yci_max((a)[0], (a)[1]))
#define V_FIRST(a) ((a)[0])
#define V_SIGNED(a, b) V_PICK(yci_two_set(0.0), b, -(a), a)
#else
#define V double
#define V_W 1
#define V_SET(x) (x)
#define V_LOAD(p) (*(p))
#define V_STORE(p, x) (*(p) = (x))
#define V_STORE_PART(p, x, n) ((void)(n), *(p) = (x))
#define V_COUNT 0.0
#define V_LOAD_PART(p, n) ((void)(n), *(p))
#define V_PICK(a, b, x, y) ((a) > (b) ? (x) : (y))
#define V_ABS(a) fabs(a)
#define V_LANE(a, i) ((void)(i), (a))
#define V_SAME(a, b, x, y) ((a) == (b) ? (x) : (y))
#define V_WHERE(a, b) ((unsigned)((a) == (b)))
#define V_MOST(a) (a)
#define V_FIRST(a) (a)
#define V_SIGNED(a, b) copysign(a, b)
#endif
#endif

#ifdef YCI_GNU
#define V_PREFETCH(p) __builtin_prefetch(p)
#else
#define V_PREFETCH(p) ((void)(p))
#endif

/* s -= A B' for the vectors and columns of a tile; column j of s begins at s[j * stride]. */
YCI_TARGET YCI_INLINE void YCI_(yci_accumulate)(
    int vectors, int columns, int k, const double *a, size_t lda, const double *b, size_t ldb, V *s, int stride) {
    int i, j;
    for (; k > 0; k--, a += lda, b += ldb) {
        V x[V_TILE_V];
        YCI_UNROLL
        for (i = 0; i < vectors; i++) x[i] = V_LOAD(a + V_W * i);
        YCI_UNROLL
        for (j = 0; j < columns; j++) {
            V y = V_SET(b[j]);
            YCI_UNROLL
            for (i = 0; i < vectors; i++) s[j * stride + i] = V_FNMA(x[i], y, s[j * stride + i]);
        }
    }
}

/* One tile of C: n <= columns of them exist; the last of its vectors has `last` rows. */
YCI_TARGET YCI_INLINE void YCI_(yci_tile)(int vectors, int last, int columns, int n, int k, const double *a, size_t lda,
    const double *b, size_t ldb, double *c, size_t ldc, int add) {
    V s[V_TILE_N][V_TILE_V];
    int i, j;
    YCI_UNROLL
    for (j = 0; j < columns; j++) YCI_UNROLL
    for (i = 0; i < vectors; i++) s[j][i] = V_SET(0.0);
    YCI_(yci_accumulate)(vectors, columns, k, a, lda, b, ldb, s[0], V_TILE_V);
    YCI_UNROLL
    for (j = 0; j < columns; j++) {
        if (j >= n) return;
        YCI_UNROLL
        for (i = 0; i < vectors; i++) {
            double *to = c + (size_t)j * ldc + V_W * i;
            if (add) s[j][i] = V_ADD(V_LOAD(to), s[j][i]);
            if (i + 1 < vectors) V_STORE(to, s[j][i]);
            else V_STORE_PART(to, s[j][i], last);
        }
    }
}

YCI_TARGET static void YCI_(yci_product)(
    int m, int n, int k, const double *a, size_t lda, const double *b, size_t ldb, double *c, size_t ldc, int add) {
    int i, j;
#ifdef YC_USE_LAPACK
    if (m >= 96 && n >= 24 && k >= 24) {
        yci_product_lapack(m, n, k, a, lda, b, ldb, c, ldc, add);
        return;
    }
#endif
    for (i = 0; i < m; i += V_TILE_V * V_W)
        for (j = 0; j < n; j += V_TILE_N) {
            int vectors = (m - i + V_W - 1) / V_W, columns = n - j, last = m - i - V_W * (vectors - 1);
            const double *x = a + i, *y = b + j;
            double *to = c + (size_t)j * ldc + i;
            if (vectors > V_TILE_V) vectors = V_TILE_V, last = V_W;
            if (columns <= V_TILE_N / 2) {
                if (vectors == 1) YCI_(yci_tile)(1, last, V_TILE_N / 2, columns, k, x, lda, y, ldb, to, ldc, add);
                else if (vectors == 2) YCI_(yci_tile)(2, last, V_TILE_N / 2, columns, k, x, lda, y, ldb, to, ldc, add);
                else YCI_(yci_tile)(V_TILE_V, last, V_TILE_N / 2, columns, k, x, lda, y, ldb, to, ldc, add);
            } else if (vectors == 1) YCI_(yci_tile)(1, last, V_TILE_N, columns, k, x, lda, y, ldb, to, ldc, add);
            else if (vectors == 2) YCI_(yci_tile)(2, last, V_TILE_N, columns, k, x, lda, y, ldb, to, ldc, add);
            else YCI_(yci_tile)(V_TILE_V, last, V_TILE_N, columns, k, x, lda, y, ldb, to, ldc, add);
        }
}

/* A strip is a tile of a panel's columns with the triangular solve done before anything is stored. */
YCI_TARGET YCI_INLINE void YCI_(yci_strip)(int vectors, int last, int columns, int n, int k, const double *a,
    size_t lda, const double *b, size_t ldb, const double *g, const double *inverse, double *c, size_t ldc) {
    V s[YCI_PANEL][V_STRIP_V];
    int i, j, q;
    YCI_UNROLL
    for (j = 0; j < columns; j++) YCI_UNROLL
    for (i = 0; i < vectors; i++) s[j][i] = V_LOAD(c + (size_t)(j < n ? j : 0) * ldc + V_W * i);
    YCI_(yci_accumulate)(vectors, columns, k, a, lda, b, ldb, s[0], V_STRIP_V);
    YCI_UNROLL
    for (j = 0; j < columns; j++) {
        if (j >= n) return;
        YCI_UNROLL
        for (i = 0; i < vectors; i++) {
            double *to = c + (size_t)j * ldc + V_W * i;
            s[j][i] = V_MUL(s[j][i], V_SET(inverse[j]));
            if (i + 1 < vectors) V_STORE(to, s[j][i]);
            else V_STORE_PART(to, s[j][i], last);
        }
        YCI_UNROLL
        for (q = j + 1; q < columns; q++) YCI_UNROLL
        for (i = 0; i < vectors; i++) s[q][i] = V_FNMA(s[j][i], V_SET(g[YCI_PANEL * j + q]), s[q][i]);
    }
}

YCI_TARGET static void YCI_(yci_strips)(int m, int n, int k, const double *a, size_t lda, const double *b, size_t ldb,
    const double *g, const double *inverse, double *c, size_t ldc) {
    for (; m > 0; m -= V_STRIP_V * V_W, a += V_STRIP_V * V_W, c += V_STRIP_V * V_W) {
        int vectors = (m + V_W - 1) / V_W, last = m - V_W * (vectors - 1);
        if (vectors > V_STRIP_V) vectors = V_STRIP_V, last = V_W;
        if (n <= YCI_PANEL / 2) {
            if (vectors == 1) YCI_(yci_strip)(1, last, YCI_PANEL / 2, n, k, a, lda, b, ldb, g, inverse, c, ldc);
#if V_STRIP_V == 3
            else if (vectors == 2) YCI_(yci_strip)(2, last, YCI_PANEL / 2, n, k, a, lda, b, ldb, g, inverse, c, ldc);
            else YCI_(yci_strip)(3, last, YCI_PANEL / 2, n, k, a, lda, b, ldb, g, inverse, c, ldc);
#endif
        } else if (vectors == 1) YCI_(yci_strip)(1, last, YCI_PANEL, n, k, a, lda, b, ldb, g, inverse, c, ldc);
#if V_STRIP_V == 3
        else if (vectors == 2) YCI_(yci_strip)(2, last, YCI_PANEL, n, k, a, lda, b, ldb, g, inverse, c, ldc);
        else YCI_(yci_strip)(3, last, YCI_PANEL, n, k, a, lda, b, ldb, g, inverse, c, ldc);
#endif
    }
}

/* `columns` of them, from the one that goes to place[0] on; the first decides where the rows begin. */
YCI_TARGET YCI_INLINE void YCI_(yci_expand_some)(int columns, const yci_expansion *e, int from) {
    int first = e->place[from] / 8, j;
    const int *chunk = e->chunk + (first - e->base), *end = e->chunk + e->chunks;
    const double *source = e->source + (size_t)from * e->source_ld;
    double *to[4];
    YCI_UNROLL
    for (j = 0; j < columns; j++)
        to[j] = e->target + (size_t)(e->place[from + j] - e->column) * e->target_ld + (8 * first - e->row);
    for (; chunk < end; chunk++) {
        const double *x = source + (*chunk >> 8);
        YCI_UNROLL
        for (j = 0; j < columns; j++, x += e->source_ld) {
#ifdef V_EXPAND
            V_STORE(to[j], V_ADD(V_LOAD(to[j]), V_EXPAND(x, *chunk)));
#else
            int bits = *chunk & 255, i, k = 0;
            if (bits == 255)
                for (i = 0; i < 8; i += V_W) V_STORE(to[j] + i, V_ADD(V_LOAD(to[j] + i), V_LOAD(x + i)));
            else
                for (i = 0; bits; i++, bits >>= 1)
                    if (bits & 1) to[j][i] += x[k++];
#endif
            to[j] += 8;
        }
    }
}

YCI_TARGET static void YCI_(yci_expand)(const yci_expansion *e) {
    int j;
    for (j = 0; j + 4 <= e->count; j += 4) YCI_(yci_expand_some)(4, e, j);
    for (; j < e->count; j++) YCI_(yci_expand_some)(1, e, j);
}

/* The sums of V_W vectors in the lanes of one. */
YCI_TARGET YCI_INLINE V YCI_(yci_sums)(const V *s) {
#if YCI_ISA == 512
    __m512d a = _mm512_add_pd(_mm512_unpacklo_pd(s[0], s[1]), _mm512_unpackhi_pd(s[0], s[1]));
    __m512d b = _mm512_add_pd(_mm512_unpacklo_pd(s[2], s[3]), _mm512_unpackhi_pd(s[2], s[3]));
    __m512d c = _mm512_add_pd(_mm512_unpacklo_pd(s[4], s[5]), _mm512_unpackhi_pd(s[4], s[5]));
    __m512d d = _mm512_add_pd(_mm512_unpacklo_pd(s[6], s[7]), _mm512_unpackhi_pd(s[6], s[7]));
    a = _mm512_add_pd(_mm512_shuffle_f64x2(a, b, 0x88), _mm512_shuffle_f64x2(a, b, 0xdd));
    c = _mm512_add_pd(_mm512_shuffle_f64x2(c, d, 0x88), _mm512_shuffle_f64x2(c, d, 0xdd));
    return _mm512_add_pd(_mm512_shuffle_f64x2(a, c, 0x88), _mm512_shuffle_f64x2(a, c, 0xdd));
#elif YCI_ISA == 256
    __m256d a = _mm256_add_pd(_mm256_unpacklo_pd(s[0], s[1]), _mm256_unpackhi_pd(s[0], s[1]));
    __m256d b = _mm256_add_pd(_mm256_unpacklo_pd(s[2], s[3]), _mm256_unpackhi_pd(s[2], s[3]));
    return _mm256_add_pd(_mm256_permute2f128_pd(a, b, 0x20), _mm256_permute2f128_pd(a, b, 0x31));
#else
    double lane[V_W], sum[V_W];
    int i, j;
    for (j = 0; j < V_W; j++) {
        V_STORE(lane, s[j]);
        for (sum[j] = lane[0], i = 1; i < V_W; i++) sum[j] += lane[i];
    }
    return V_LOAD(sum);
#endif
}

#define V_TILE_PART (YCI_PANEL / V_W) /* vectors of a column of a tile */

/* x[r][q] := number q of array r in all lanes. */
YCI_TARGET YCI_INLINE void YCI_(yci_spread_right)(const double *from, size_t ld, V (*x)[YCI_PANEL], int count) {
    int q, r;
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (q = 0; q < YCI_PANEL; q++) x[r][q] = V_SET(from[(size_t)r * ld + (size_t)q]);
}

/* z := A x for a tile of n columns, lda apart; x is zero behind them. Even and odd columns are summed at the same time,
 * to hide an addition's time, and whatever the count, so that it does not change the bits. */
YCI_TARGET YCI_INLINE void YCI_(yci_tile_times)(
    int n, const double *a, size_t lda, const V (*x)[YCI_PANEL], V (*z)[V_TILE_PART], int count) {
    int i, q, r;
    YCI_UNROLL
    for (i = 0; i < V_TILE_PART; i++) {
        V s[2][YCI_RIGHT];
        YCI_UNROLL
        for (q = 0; q < YCI_PANEL; q++) {
            V column = V_LOAD(a + lda * (size_t)(q < n ? q : 0) + V_W * i);
            YCI_UNROLL
            for (r = 0; r < count; r++)
                s[q % 2][r] = q < 2 ? V_MUL(column, x[r][q]) : V_FMA(column, x[r][q], s[q % 2][r]);
        }
        YCI_UNROLL
        for (r = 0; r < count; r++) z[r][i] = V_ADD(s[0][r], s[1][r]);
    }
}

/* y -= A x for a tile. */
YCI_TARGET YCI_INLINE void YCI_(yci_tile_subtract)(
    int n, const double *a, size_t lda, const V (*x)[YCI_PANEL], double *y, size_t ldy, int count) {
    V z[YCI_RIGHT][V_TILE_PART];
    int i, r;
    YCI_(yci_tile_times)(n, a, lda, x, z, count);
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (i = 0; i < V_TILE_PART; i++) {
        double *at = y + (size_t)r * ldy + V_W * i;
        V_STORE(at, V_SUB(V_LOAD(at), z[r][i]));
    }
}

/* s[r][q] += column first + q of a tile of n columns times x, lane by lane. */
YCI_TARGET YCI_INLINE void YCI_(yci_tile_gather)(
    int first, int n, const double *a, size_t lda, const double *x, size_t ldx, V (*s)[V_COLUMNS], int count) {
    int i, q, r;
    YCI_UNROLL
    for (i = 0; i < V_TILE_PART; i++) {
        V at[YCI_RIGHT];
        YCI_UNROLL
        for (r = 0; r < count; r++) at[r] = V_LOAD(x + (size_t)r * ldx + V_W * i);
        YCI_UNROLL
        for (q = 0; q < V_COLUMNS; q++) {
            V column = V_LOAD(a + lda * (size_t)(first + q < n ? first + q : 0) + V_W * i);
            YCI_UNROLL
            for (r = 0; r < count; r++) s[r][q] = V_FMA(column, at[r], s[r][q]);
        }
    }
}

YCI_TARGET YCI_INLINE void YCI_(yci_tile_clear)(V (*s)[V_COLUMNS], int count) {
    int q, r;
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (q = 0; q < V_COLUMNS; q++) s[r][q] = V_SET(0.0);
}

/* The sums over the lanes, in vectors. */
YCI_TARGET YCI_INLINE void YCI_(yci_tile_sums)(V (*s)[V_COLUMNS], V (*sum)[V_TILE_PART], int first, int count) {
    int q, r;
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (q = 0; q < V_COLUMNS; q += V_W) sum[r][(first + q) / V_W] = YCI_(yci_sums)(s[r] + q);
}

/* ---- solves with a front ---- */

/* The corner of n columns: `from` and its rows behind them are columns ld apart. */
YCI_TARGET YCI_INLINE void YCI_(yci_pack_corner)(int n, int rows, const double *from, size_t ld, double *to) {
    double *below = to + YCI_PANEL;
    int i, q;
    YCI_UNROLL
    for (q = 0; q < YCI_PANEL; q++) {
        double own = q < n ? from[(ld + 1) * (size_t)q] : 1.0;
        to[q] = own;
        YCI_UNROLL
        for (i = q + 1; i < YCI_PANEL; i++) {
            double x = q < n && i < rows ? from[ld * (size_t)q + (size_t)i] : 0.0;
            *below++ = i < n ? x : x * own;
        }
    }
    for (i = YCI_PANEL * (YCI_PANEL + 1) / 2; i < YCI_CORNER; i++) to[i] = 0.0;
}

YCI_TARGET static void YCI_(yci_pack)(int width, int height, double *l, double *work) {
    double *to = l;
    int c, i, q, k;
    for (c = 0; c < width; c += YCI_PANEL) {
        int n = yci_min_int(YCI_PANEL, width - c), rows = height - c;
        size_t ld = ((size_t)rows + 7) & ~(size_t)7;
        for (q = 0; q < n; q++) {
            const double *from = l + (size_t)(c + q) * (size_t)height + c;
            for (i = 0; i < rows; i += V_W) V_STORE(work + ld * (size_t)q + i, V_LOAD(from + i));
        }
        if (n == YCI_PANEL) YCI_(yci_pack_corner)(YCI_PANEL, YCI_PANEL, work, ld, to);
        else YCI_(yci_pack_corner)(n, rows, work, ld, to);
        for (to += YCI_CORNER, i = YCI_PANEL; i < rows; i += YCI_PANEL) {
            int count = yci_min_int(YCI_PANEL, rows - i);
            for (q = 0; q < n; q++, to += count)
                for (k = 0; k < YCI_PANEL; k += V_W) V_STORE(to + k, V_LOAD(work + ld * (size_t)q + i + k));
        }
    }
    for (k = 0; k < YCI_OVERREAD; k += V_W) V_STORE(to + k, V_SET(0.0)); /* what is read behind the last tile */
}

/* x := inverse(G) x in the corner of a panel of n columns, of whose result all lanes of y[r][q] receive number q: from
 * registers, since a vector loaded behind stores of its parts would wait. */
YCI_TARGET YCI_INLINE void YCI_(yci_corner_forward)(
    int n, const double *g, double *x, size_t ldx, V (*y)[YCI_PANEL], int count) {
    double v[YCI_RIGHT][YCI_PANEL];
    const double *below = g + YCI_PANEL;
    int i, j, r;
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (i = 0; i < YCI_PANEL; i++) v[r][i] = x[(size_t)r * ldx + (size_t)i];
    YCI_UNROLL
    for (j = 0; j < YCI_PANEL; j++) {
        YCI_UNROLL
        for (i = j + 1; i < YCI_PANEL; i++) YCI_UNROLL
        for (r = 0; r < count; r++) v[r][i] = V_FNMA1(below[i - j - 1], v[r][j], v[r][i]);
        below += YCI_PANEL - 1 - j;
    }
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (i = 0; i < YCI_PANEL; i++) {
        v[r][i] *= g[i];
        x[(size_t)r * ldx + (size_t)i] = v[r][i], y[r][i] = V_SET(i < n ? v[r][i] : 0.0);
    }
}

/* x := inverse(G') (x - sum). */
YCI_TARGET YCI_INLINE void YCI_(yci_corner_backward)(
    const double *g, const double (*sum)[YCI_PANEL], double *x, size_t ldx, int count) {
    double v[YCI_RIGHT][YCI_PANEL];
    int i, j, r;
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (i = 0; i < YCI_PANEL; i++) v[r][i] = (x[(size_t)r * ldx + (size_t)i] - sum[r][i]) * g[i];
    YCI_UNROLL
    for (i = YCI_PANEL - 1; i > 0; i--) YCI_UNROLL
    for (j = 0; j < i; j++) YCI_UNROLL
    for (r = 0; r < count; r++)
        v[r][j] = V_FNMA1(g[YCI_PANEL + j * (2 * YCI_PANEL - 1 - j) / 2 + i - j - 1], v[r][i], v[r][j]);
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (i = 0; i < YCI_PANEL; i++) x[(size_t)r * ldx + (size_t)i] = v[r][i];
}

YCI_TARGET YCI_INLINE void YCI_(yci_ahead)(const double *l) {
    int i;
    YCI_UNROLL
    for (i = 0; i < YCI_PANEL; i++) V_PREFETCH(l + YCI_PANEL * i);
}

/* Forward through a panel of n columns, whose rows begin at z. Returns the next one. */
YCI_TARGET YCI_INLINE const double *YCI_(yci_panel_forward)(
    int n, int rows, const double *l, double *z, size_t ldz, int count) {
    V x[YCI_RIGHT][YCI_PANEL];
    int i;
    YCI_(yci_ahead)(l + YCI_AHEAD);
    YCI_(yci_corner_forward)(n, l, z, ldz, x, count);
    l += YCI_CORNER;
    if (rows <= YCI_PANEL) return l;
    for (i = YCI_PANEL; i + YCI_PANEL <= rows; i += YCI_PANEL, l += YCI_PANEL * n) {
        YCI_(yci_ahead)(l + YCI_AHEAD);
        YCI_(yci_tile_subtract)(n, l, YCI_PANEL, (const V(*)[YCI_PANEL])x, z + i, ldz, count);
    }
    if (i == rows) return l;
    YCI_(yci_ahead)(l + YCI_AHEAD);
    YCI_(yci_tile_subtract)(n, l, (size_t)(rows - i), (const V(*)[YCI_PANEL])x, z + i, ldz, count);
    return l + (rows - i) * n;
}

YCI_TARGET YCI_INLINE void YCI_(yci_forward_some)(
    const yci_trapezoid *s, double *y, size_t ldy, int count, double *z, size_t ldz) {
    const double *l = s->l;
    int c, i, r, m = s->height - s->width;
    for (r = 0; r < count; r++) {
        const double *from = y + (size_t)r * ldy + s->first;
        double *to = z + (size_t)r * ldz;
        for (i = 0; i < s->width; i += V_W) V_STORE(to + i, V_LOAD(from + i));
        for (i = s->width; i < s->height + YCI_PANEL; i += V_W) V_STORE(to + i, V_SET(0.0));
    }
    for (c = 0; c + YCI_PANEL <= s->width; c += YCI_PANEL)
        l = YCI_(yci_panel_forward)(YCI_PANEL, s->height - c, l, z + c, ldz, count);
    if (c < s->width) YCI_(yci_panel_forward)(s->width - c, s->height - c, l, z + c, ldz, count);
    for (r = 0; r < count; r++) {
        const double *from = z + (size_t)r * ldz;
        double *to = y + (size_t)r * ldy, *own = to + s->first;
        for (i = 0; i + V_W <= s->width; i += V_W) V_STORE(own + i, V_LOAD(from + i));
        if (i < s->width) V_STORE_PART(own + i, V_LOAD(from + i), s->width - i);
        for (i = 0, from += s->width; i < m; i += YCI_OVERREAD) {
            int k;
            YCI_UNROLL
            for (k = 0; k < YCI_OVERREAD; k++) to[s->row[i + k]] += from[i + k];
        }
    }
}

YCI_TARGET static void YCI_(yci_forward)(
    const yci_trapezoid *s, double *y, size_t ldy, int count, double *z, size_t ldz) {
    if (count == 1) YCI_(yci_forward_some)(s, y, ldy, 1, z, ldz);
    else if (count == 2) YCI_(yci_forward_some)(s, y, ldy, 2, z, ldz);
    else if (count == 3) YCI_(yci_forward_some)(s, y, ldy, 3, z, ldz);
    else YCI_(yci_forward_some)(s, y, ldy, 4, z, ldz);
}

/* Backward through the panel that ends at l. Returns where it begins. */
YCI_TARGET YCI_INLINE const double *YCI_(yci_panel_backward)(
    int n, int rows, const double *l, double *z, size_t ldz, int count) {
    static const double first[2 * YCI_PANEL] = {1, 1, 1, 1, 1, 1, 1, 1}; /* lets n through from YCI_PANEL - n on */
    V sum[YCI_RIGHT][V_TILE_PART];
    double taken[YCI_RIGHT][YCI_PANEL];
    const double *end = l;
    int i, q, r, last = rows > YCI_PANEL ? (rows - 1) % YCI_PANEL + 1 : 0;
    YCI_UNROLL
    for (q = 0; q < YCI_PANEL; q += V_COLUMNS) {
        V s[YCI_RIGHT][V_COLUMNS];
        YCI_(yci_tile_clear)(s, count);
        l = end;
        if (last) {
            l -= last * n;
            if (q == 0) YCI_(yci_ahead)(l - YCI_AHEAD);
            YCI_(yci_tile_gather)(q, n, l, (size_t)last, z + (rows - last), ldz, s, count);
        }
        for (i = rows - last - YCI_PANEL; i > 0; i -= YCI_PANEL) {
            l -= YCI_PANEL * n;
            if (q == 0) YCI_(yci_ahead)(l - YCI_AHEAD);
            YCI_(yci_tile_gather)(q, n, l, YCI_PANEL, z + i, ldz, s, count);
        }
        YCI_(yci_tile_sums)(s, sum, q, count);
    }
    l -= YCI_CORNER;
    YCI_(yci_ahead)(l - YCI_AHEAD);
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (i = 0; i < V_TILE_PART; i++)
        V_STORE(taken[r] + V_W * i, V_PICK(V_LOAD(first + YCI_PANEL - n + V_W * i), V_SET(0.5), sum[r][i], V_SET(0.0)));
    YCI_(yci_corner_backward)(l, (const double(*)[YCI_PANEL])taken, z, ldz, count);
    return l;
}

YCI_TARGET YCI_INLINE void YCI_(yci_backward_some)(
    const yci_trapezoid *s, double *y, size_t ldy, int count, double *z, size_t ldz) {
    const double *l = s->l + yci_packed(s->width, s->height);
    int c = (s->width - 1) / YCI_PANEL * YCI_PANEL, i, r, m = s->height - s->width;
    for (r = 0; r < count; r++) {
        const double *from = y + (size_t)r * ldy;
        double *to = z + (size_t)r * ldz;
        for (i = 0; i < s->width; i += V_W) V_STORE(to + i, V_LOAD(from + s->first + i));
        for (i = 0, to += s->width; i < m; i += YCI_OVERREAD) {
            int k;
            YCI_UNROLL
            for (k = 0; k < YCI_OVERREAD; k++) to[i + k] = from[s->row[i + k]];
        }
        for (i = 0; i < YCI_PANEL; i += V_W) V_STORE(to + m + i, V_SET(0.0));
    }
    if (s->width - c < YCI_PANEL)
        l = YCI_(yci_panel_backward)(s->width - c, s->height - c, l, z + c, ldz, count), c -= YCI_PANEL;
    for (; c >= 0; c -= YCI_PANEL) l = YCI_(yci_panel_backward)(YCI_PANEL, s->height - c, l, z + c, ldz, count);
    for (r = 0; r < count; r++) {
        double *own = y + (size_t)r * ldy + s->first;
        for (i = 0; i + V_W <= s->width; i += V_W) V_STORE(own + i, V_LOAD(z + (size_t)r * ldz + i));
        if (i < s->width) V_STORE_PART(own + i, V_LOAD(z + (size_t)r * ldz + i), s->width - i);
    }
}

YCI_TARGET static void YCI_(yci_backward)(
    const yci_trapezoid *s, double *y, size_t ldy, int count, double *z, size_t ldz) {
    if (count == 1) YCI_(yci_backward_some)(s, y, ldy, 1, z, ldz);
    else if (count == 3) YCI_(yci_backward_some)(s, y, ldy, 3, z, ldz);
    else /* what the registers hold */
        for (; count > 0; count -= 2, y += 2 * ldy) YCI_(yci_backward_some)(s, y, ldy, 2, z, ldz);
}

/* ---- small factors, in tiles ---- */

YCI_TARGET YCI_INLINE void YCI_(yci_tile_copy)(const double *from, double *to) {
    int i;
    YCI_UNROLL
    for (i = 0; i < YCI_TILE; i += V_W) V_STORE(to + i, V_LOAD(from + i));
}

/* to := from - A B' or, without `from`, -A B'; tiles all of them, and `count` of all but B. The product is summed by
 * itself and rounded into `from` once: a tile on which hundreds of columns meet loses a third as much as with one
 * rounding for each term. */
YCI_TARGET YCI_INLINE void YCI_(yci_tile_update)(
    int count, const double *const *from, const double *const *a, const double *b, double *const *to) {
    int i, j, q, p, k;
    for (i = 0; i < YCI_PANEL; i += V_W)
        for (j = 0; j < YCI_PANEL; j += V_TILE_N) {
            V s[V_TILE_N][V_TILE_V], x[V_TILE_V];
            YCI_UNROLL
            for (q = 0; q < V_TILE_N; q++) YCI_UNROLL
            for (p = 0; p < count; p++) s[q][p] = V_SET(0.0);
            for (k = 0; k < YCI_PANEL; k++) {
                YCI_UNROLL
                for (p = 0; p < count; p++) x[p] = V_LOAD(a[p] + YCI_PANEL * k + i);
                YCI_UNROLL
                for (q = 0; q < V_TILE_N; q++) {
                    V y = V_SET(b[YCI_PANEL * k + j + q]);
                    YCI_UNROLL
                    for (p = 0; p < count; p++) s[q][p] = V_FNMA(x[p], y, s[q][p]);
                }
            }
            YCI_UNROLL
            for (q = 0; q < V_TILE_N; q++) YCI_UNROLL
            for (p = 0; p < count; p++) {
                size_t at = (size_t)(YCI_PANEL * (j + q) + i);
                V_STORE(to[p] + at, from ? V_ADD(V_LOAD(from[p] + at), s[q][p]) : s[q][p]);
            }
        }
}

/* C := inverse(C) for a symmetric tile, whose negative goes to `minus`, by the sweep operator on pairs of rows: with B
 * the inverse of the pair's block K, rows and columns K become (-B, B C_K), the rest C - C_K' B C_K. Returns 0 when
 * that cannot be trusted, 2 when it is to be refined, or else 1 (see yci_tiles); `kept` becomes C. */
YCI_TARGET YCI_INLINE int YCI_(yci_tile_invert)(double *c, double *kept, int spd, double *minus) {
    static const double hole[2 * YCI_PANEL] = {1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 1, 1};
    static const double unit[2 * YCI_PANEL] = {0, 0, 0, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0, 0};
    V a[YCI_PANEL][V_TILE_PART], least = V_SET(DBL_MAX), most = V_SET(0.0), sum = V_SET(0.0);
    double lane[V_W], extremes[V_W], total = 0.0;
    int i, j, k;
    YCI_UNROLL
    for (j = 0; j < YCI_PANEL; j++) YCI_UNROLL
    for (i = 0; i < V_TILE_PART; i++) a[j][i] = V_LOAD(c + YCI_PANEL * j + V_W * i);
    YCI_UNROLL
    for (k = 0; k < YCI_PANEL; k += 2) {
        V p = V_LANE(a[k][k / V_W], k % V_W), q = V_LANE(a[k][(k + 1) / V_W], (k + 1) % V_W);
        V r = V_LANE(a[k + 1][(k + 1) / V_W], (k + 1) % V_W), det = V_FNMA(q, q, V_MUL(p, r));
        V inverse = V_SET(1.0) / det, u[V_TILE_PART], v[V_TILE_PART], low = spd ? det : V_ABS(det);
        if (spd) least = V_PICK(p, least, least, p);
        else { /* a pair that cancels cannot be seen in what comes of all of them */
            V size = V_FMA(q, q, V_ABS(V_MUL(p, r)));
            low = V_PICK(size, V_MUL(low, V_SET(YCI_TILE_INDEFINITE)), V_SET(0.0), low);
        }
        least = V_PICK(low, least, least, low), most = V_PICK(low, most, low, most);
        p = V_MUL(p, inverse), q = V_MUL(q, inverse), r = V_MUL(r, inverse); /* first, so that no product underflows */
        YCI_UNROLL
        for (i = 0; i < V_TILE_PART; i++) { /* C_K and, in rows K, minus one */
            const double *zero = hole + YCI_PANEL - k + V_W * i, *one = unit + YCI_PANEL - k + V_W * i;
            V s = V_FMA(a[k][i], V_LOAD(zero), V_LOAD(one)), t = V_FMA(a[k + 1][i], V_LOAD(zero), V_LOAD(one - 1));
            u[i] = V_FNMA(t, q, V_MUL(s, r)), v[i] = V_FNMA(s, q, V_MUL(t, p));
        }
        YCI_UNROLL
        for (j = 0; j < YCI_PANEL; j++)
            if (j != k && j != k + 1) {
                V x = V_LANE(a[k][j / V_W], j % V_W), y = V_LANE(a[k + 1][j / V_W], j % V_W);
                YCI_UNROLL
                for (i = 0; i < V_TILE_PART; i++)
                    a[j][i] = V_FNMA(v[i], y, V_FNMA(u[i], x, V_MUL(a[j][i], V_LOAD(hole + YCI_PANEL - k + V_W * i))));
            }
        YCI_UNROLL
        for (i = 0; i < V_TILE_PART; i++) a[k][i] = u[i], a[k + 1][i] = v[i];
    }
    YCI_UNROLL
    for (j = 0; j < YCI_PANEL; j++) YCI_UNROLL
    for (i = 0; i < V_TILE_PART; i++) {
        double *to = c + YCI_PANEL * j + V_W * i, *before = kept + YCI_PANEL * j + V_W * i;
        V x = V_LOAD(to);
        sum = V_FMA(V_ABS(a[j][i]), V_FMA(V_ABS(V_LOAD(before)), V_SET(YCI_TILE_LOSS), V_ABS(x)), sum);
        V_STORE(before, x), V_STORE(minus + (to - c), a[j][i]), V_STORE(to, V_SUB(V_SET(0.0), a[j][i]));
    }
    V_STORE(lane, sum);
    for (i = 0; i < V_W; i++) total += lane[i];
    if (!(total <= (spd ? YCI_TILE_LIMIT : YCI_TILE_INDEFINITE))) return 0;
    V_STORE(lane, least), V_STORE(extremes, most);
    if (!(lane[0] >= YCI_TILE_LEAST && extremes[0] <= 1.0 / YCI_TILE_LEAST)) return 0;
    return total > YCI_TILE_CONDITION ? 2 : 1;
}

/* Subtracts from `count` targets the products of as many tiles of L with one of L D. */
YCI_TARGET YCI_INLINE void YCI_(yci_tile_some)(
    int count, const yci_tiles *t, const int *target, const double *l, const double *scaled) {
    const double *a[V_TILE_V];
    double *to[V_TILE_V];
    int p;
    YCI_UNROLL
    for (p = 0; p < count; p++) a[p] = l + YCI_TILE * p, to[p] = t->l + YCI_TILE * (size_t)target[p];
    YCI_(yci_tile_update)(count, (const double *const *)to, a, scaled, to);
}

YCI_TARGET static int YCI_(yci_tiles_factor)(const yci_tiles *t) {
    const int *target = t->target;
    int j, a, b;
    for (j = 0; j < t->blocks; j++)
        YCI_(yci_tile_copy)(t->l + YCI_TILE * (size_t)t->begin[j], t->kept + YCI_TILE * (size_t)j);
    for (j = 0; j < t->blocks; j++) {
        double minus[YCI_TILE], *c = t->l + YCI_TILE * (size_t)t->begin[j], *w = t->scaled;
        int n = t->begin[j + 1] - t->begin[j] - 1;
        double *kept = t->kept + YCI_TILE * (size_t)j;
        int quality = YCI_(yci_tile_invert)(c, kept, t->spd, minus);
        if (!quality) return 0;
        t->refine[j] = quality == 2;
        for (a = 0, c += YCI_TILE; a < n; a++) {
            double rest[YCI_TILE], *to = c + YCI_TILE * a, *back = rest;
            const double *x = w + YCI_TILE * a, *left = rest;
            YCI_(yci_tile_copy)(to, w + YCI_TILE * a);
            YCI_(yci_tile_update)(1, NULL, &x, minus, &to);
            if (!t->refine[j]) continue;
            YCI_(yci_tile_update)(1, &x, (const double *const *)&to, kept, &back); /* what L D leaves of it */
            YCI_(yci_tile_update)(1, (const double *const *)&to, &left, minus, &to);
        }
        for (a = 0; a < n; a++) {
            for (b = a; n - b >= 3; b += 3, target += 3)
                YCI_(yci_tile_some)(3, t, target, c + YCI_TILE * b, w + YCI_TILE * a);
            if (n - b == 2) YCI_(yci_tile_some)(2, t, target, c + YCI_TILE * b, w + YCI_TILE * a);
            else if (n - b == 1) YCI_(yci_tile_some)(1, t, target, c + YCI_TILE * b, w + YCI_TILE * a);
            target += n - b;
        }
    }
    return 1;
}

/* y -= L y from the rows of one column of tiles. */
YCI_TARGET YCI_INLINE void YCI_(yci_tiles_forward)(
    int tiles, const double *l, const int *row, const double *own, double *y, size_t ldy, int count) {
    V x[YCI_RIGHT][YCI_PANEL];
    int k;
    YCI_(yci_spread_right)(own, ldy, x, count);
    for (k = 0; k < tiles; k++, l += YCI_TILE) YCI_(yci_tile_subtract)
    (YCI_PANEL, l, YCI_PANEL, (const V(*)[YCI_PANEL])x, y + YCI_PANEL * (size_t)row[k], ldy, count);
}

/* z += P (y - C z): a step of refinement of z = P y. */
YCI_TARGET YCI_INLINE void YCI_(yci_tile_refine)(
    const double *p, const double *c, const double *y, size_t ldy, V (*z)[V_TILE_PART], int count) {
    V x[YCI_RIGHT][YCI_PANEL], change[YCI_RIGHT][V_TILE_PART];
    double rest[YCI_RIGHT][YCI_PANEL];
    int i, r;
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (i = 0; i < V_TILE_PART; i++) V_STORE(rest[r] + V_W * i, z[r][i]);
    YCI_(yci_spread_right)(rest[0], YCI_PANEL, x, count);
    YCI_(yci_tile_times)(YCI_PANEL, c, YCI_PANEL, (const V(*)[YCI_PANEL])x, change, count);
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (i = 0; i < V_TILE_PART; i++)
        V_STORE(rest[r] + V_W * i, V_SUB(V_LOAD(y + (size_t)r * ldy + V_W * i), change[r][i]));
    YCI_(yci_spread_right)(rest[0], YCI_PANEL, x, count);
    YCI_(yci_tile_times)(YCI_PANEL, p, YCI_PANEL, (const V(*)[YCI_PANEL])x, change, count);
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (i = 0; i < V_TILE_PART; i++) z[r][i] = V_ADD(z[r][i], change[r][i]);
}

/* y := inverse(D) y - L' y in the rows of one column of tiles, from the last tile on: memory is read backwards. `d` is
 * its block of D if that is to be refined. */
YCI_TARGET YCI_INLINE void YCI_(yci_tiles_backward)(
    int tiles, const double *l, const double *d, const int *row, double *own, const double *y, size_t ldy, int count) {
    V x[YCI_RIGHT][YCI_PANEL], z[YCI_RIGHT][V_TILE_PART], sum[YCI_RIGHT][V_TILE_PART];
    int i, k, q, r;
    YCI_UNROLL
    for (q = 0; q < YCI_PANEL; q += V_COLUMNS) {
        V s[YCI_RIGHT][V_COLUMNS];
        YCI_(yci_tile_clear)(s, count);
        YCI_UNROLL
        for (k = tiles - 1; k >= 0; k--) YCI_(yci_tile_gather)
        (q, YCI_PANEL, l + YCI_TILE * (size_t)k, YCI_PANEL, y + YCI_PANEL * (size_t)row[k], ldy, s, count);
        YCI_(yci_tile_sums)(s, sum, q, count);
    }
    YCI_(yci_spread_right)(own, ldy, x, count);
    YCI_(yci_tile_times)(YCI_PANEL, l - YCI_TILE, YCI_PANEL, (const V(*)[YCI_PANEL])x, z, count);
    if (d) YCI_(yci_tile_refine)(l - YCI_TILE, d, own, ldy, z, count);
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (i = 0; i < V_TILE_PART; i++) V_STORE(own + (size_t)r * ldy + V_W * i, V_SUB(z[r][i], sum[r][i]));
}

YCI_TARGET YCI_INLINE void YCI_(yci_tiles_solve_some)(const yci_tiles *t, double *y, size_t ldy, int count) {
    const int *begin = t->begin, *row = t->row + 1;
    const double *l = t->l + YCI_TILE;
    int j, blocks = t->blocks;
    for (j = 0; j < blocks; j++) YCI_(yci_tiles_forward)
    (begin[j + 1] - begin[j] - 1, l + YCI_TILE * (size_t)begin[j], row + begin[j], y + YCI_PANEL * j, y, ldy, count);
    for (j = blocks - 1; j >= 0; j--) YCI_(yci_tiles_backward)
    (begin[j + 1] - begin[j] - 1, l + YCI_TILE * (size_t)begin[j], t->refine[j] ? t->kept + YCI_TILE * (size_t)j : NULL,
        row + begin[j], y + YCI_PANEL * j, y, ldy, count);
}

YCI_TARGET static void YCI_(yci_tiles_solve)(const yci_tiles *t, double *y, size_t ldy, int count) {
    if (count == 1) YCI_(yci_tiles_solve_some)(t, y, ldy, 1);
    else if (count == 3) YCI_(yci_tiles_solve_some)(t, y, ldy, 3);
    else
        for (; count > 0; count -= 2, y += 2 * ldy) YCI_(yci_tiles_solve_some)(t, y, ldy, 2);
}

/* ---- LU ---- */

/* The largest of `count` vectors in all lanes; NaN does not count. */
YCI_TARGET YCI_INLINE V YCI_(yci_most)(int count, V *x) {
    int i;
    YCI_UNROLL
    for (i = count / 2; i > 0; i /= 2) {
        int k;
        YCI_UNROLL
        for (k = 0; k < i; k++) x[k] = V_MAX(x[k], x[k + i]);
    }
    return V_MOST(x[0]);
}

/* Zero times A is zero, but for infinity and NaN. */
YCI_TARGET static int YCI_(yci_finite)(size_t m, size_t n, const double *a, size_t lda) {
    V sum[8], zero = V_SET(0.0);
    double lane[V_W];
    size_t i, j;
    int k, finite = 1;
    if (lda == n) n *= m, m = 1; /* one long row has one end */
    YCI_UNROLL
    for (k = 0; k < 8; k++) sum[k] = zero;
    for (i = 0; i < m; i++, a += lda) {
        for (j = 0; n - j >= 8 * V_W; j += 8 * V_W) YCI_UNROLL
        for (k = 0; k < 8; k++) sum[k] = V_FMA(V_LOAD(a + j + V_W * k), zero, sum[k]);
        for (; n - j >= V_W; j += V_W) sum[0] = V_FMA(V_LOAD(a + j), zero, sum[0]);
        if (j < n) sum[1] = V_FMA(V_LOAD_PART(a + j, (int)(n - j)), zero, sum[1]);
    }
    YCI_UNROLL
    for (k = 1; k < 8; k++) sum[0] = V_ADD(sum[0], sum[k]);
    V_STORE(lane, sum[0]);
    for (k = 0; k < V_W; k++) finite = finite && lane[k] == 0.0;
    return finite;
}

/* The first n <= V_W numbers of some rows. */
YCI_TARGET YCI_INLINE void YCI_(yci_take_some)(
    int rows, int n, const double *a, size_t lda, double *f, size_t ldf, double *sums, V *most) {
    V sum = V_LOAD(sums);
    int k;
    YCI_UNROLL
    for (k = 0; k < rows; k++) {
        V x = n == V_W ? V_LOAD(a + (size_t)k * lda) : V_LOAD_PART(a + (size_t)k * lda, n);
        V_STORE(f + (size_t)k * ldf, x);
        x = V_ABS(x), most[k] = V_MAX(x, most[k]), sum = V_ADD(sum, x);
    }
    V_STORE(sums, sum);
}

YCI_TARGET YCI_INLINE void YCI_(yci_take_rows)(
    int rows, int n, const double *a, size_t lda, double *f, size_t ldf, double *sums, V *most) {
    int j, k;
    for (j = 0; j + V_W <= n; j += V_W) YCI_(yci_take_some)(rows, V_W, a + j, lda, f + j, ldf, sums + j, most);
    if (j < n) YCI_(yci_take_some)(rows, n - j, a + j, lda, f + j, ldf, sums + j, most), j += V_W;
    for (; j % YCI_PANEL; j += V_W)
        for (k = 0; k < rows; k++) V_STORE(f + (size_t)k * ldf + j, V_SET(0.0));
}

YCI_TARGET static double YCI_(yci_take)(
    int n, const double *a, size_t lda, double *f, size_t ldf, double *sums, double *norm) {
    V most[4], widest[4], zero = V_SET(0.0);
    int i, k;
    YCI_UNROLL
    for (k = 0; k < 4; k++) most[k] = widest[k] = zero;
    for (i = 0; i < n; i += V_W) V_STORE(sums + i, zero);
    for (i = 0; i + 4 <= n; i += 4, a += 4 * lda, f += 4 * ldf) YCI_(yci_take_rows)(4, n, a, lda, f, ldf, sums, most);
    for (; i < n; i++, a += lda, f += ldf) YCI_(yci_take_rows)(1, n, a, lda, f, ldf, sums, most);
    for (; i % YCI_PANEL; i++, f += ldf)
        for (k = 0; k < n; k += V_W) V_STORE(f + k, zero);
    for (i = 0; i < n; i += V_W) widest[0] = V_MAX(V_LOAD(sums + i), widest[0]);
    *norm = V_FIRST(YCI_(yci_most)(4, widest));
    return V_FIRST(YCI_(yci_most)(4, most));
}

YCI_TARGET static void YCI_(yci_transpose)(int m, int n, const double *a, size_t lda, double *b, size_t ldb) {
    int i, j, p, q;
    for (i = 0; i < m; i += 8)
        for (j = 0; j < n; j += 8) {
            const double *from = a + (size_t)i * lda + j;
            double *to = b + (size_t)j * ldb + i;
#if YCI_ISA == 512
            V x[8], y[8];
            YCI_UNROLL
            for (p = 0; p < 8; p++) x[p] = V_LOAD(from + (size_t)p * lda);
            YCI_UNROLL
            for (p = 0; p < 8; p += 2) {
                y[p] = _mm512_unpacklo_pd(x[p], x[p + 1]);
                y[p + 1] = _mm512_unpackhi_pd(x[p], x[p + 1]);
            }
            YCI_UNROLL
            for (q = 0; q < 2; q++) {
                x[q] = _mm512_shuffle_f64x2(y[q], y[q + 2], 0x88);
                x[q + 2] = _mm512_shuffle_f64x2(y[q], y[q + 2], 0xdd);
                x[q + 4] = _mm512_shuffle_f64x2(y[q + 4], y[q + 6], 0x88);
                x[q + 6] = _mm512_shuffle_f64x2(y[q + 4], y[q + 6], 0xdd);
            }
            YCI_UNROLL
            for (q = 0; q < 4; q++) {
                V_STORE(to + (size_t)q * ldb, _mm512_shuffle_f64x2(x[q], x[q + 4], 0x88));
                V_STORE(to + (size_t)(q + 4) * ldb, _mm512_shuffle_f64x2(x[q], x[q + 4], 0xdd));
            }
#else
            for (p = 0; p < 8; p++)
                for (q = 0; q < 8; q++) (to + p)[(size_t)q * ldb] = (from + q)[(size_t)p * lda];
#endif
        }
}

/* The first of a column's m rows whose size is `most`. Looks at whole groups of rows. */
YCI_TARGET YCI_INLINE int YCI_(yci_find)(int m, const double *column, V most) {
    int i, k, best = 0;
    for (i = 0; i < m; i += 8 * V_W) {
        unsigned long long found = 0;
        YCI_UNROLL
        for (k = 0; k < 8; k++)
            found |= (unsigned long long)V_WHERE(V_ABS(V_LOAD(column + i + V_W * k)), most) << (V_W * k);
        if (found) return i + yci_first_bit(found);
    }
    for (i = 1; i < m; i++) /* a processor whose registers hold more digits than memory */
        if (fabs(column[i]) > fabs(column[best])) best = i;
    return best;
}

/* The steps of a panel go in pairs: the columns behind both are updated by both at once. `odd` tells which of the two
 * a step is; u holds its row of U, t that of the step before. */

/* `vectors` vectors of rows in step j: column j becomes L, the next one is updated and searched. */
YCI_TARGET YCI_INLINE void YCI_(yci_eliminate)(
    int odd, int vectors, double *l, size_t lda, V scale, V t, V u, V *at, V here, V *most) {
    double *next = l + lda;
    int i;
    YCI_UNROLL
    for (i = 0; i < vectors; i++, l += V_W, next += V_W, *at = V_ADD(*at, V_SET((double)V_W))) {
        V x = V_SAME(*at, here, V_SET(1.0), V_MUL(V_LOAD(l), scale)), y = V_LOAD(next);
        V_STORE(l, x);
        if (odd) y = V_FNMA(V_LOAD(l - lda), t, y);
        y = V_FNMA(x, u, y);
        V_STORE(next, y);
        most[i] = V_MAX(V_ABS(y), most[i]);
    }
}

/* Step j of a panel; 0 when there is no pivot. Rows stay where they are: that of the pivot, of which `upper` keeps a
 * copy, becomes zero in the columns to come by an L of one, exactly. `most` is the largest of column j, and then that
 * of the next. */
YCI_TARGET YCI_INLINE int YCI_(yci_pivot)(
    int j, int m, double *a, size_t lda, int *pivot, double *reciprocal, double *upper, V *t, V *u, V *most) {
    double size = V_FIRST(*most), inverse = 1.0 / size, *column = a + (size_t)j * lda;
    V at = V_COUNT, best[4], scale, here;
    int i, q, row, odd = j % 2;
    if (!(size > 0.0 && size <= DBL_MAX)) return 0;
    row = YCI_(yci_find)(m, column, *most);
    YCI_UNROLL
    for (q = j; q < YCI_PANEL; q++) {
        u[q] = V_SET(a[(size_t)q * lda + (size_t)row]);
        if (odd && q > j) u[q] = V_FNMA(V_SET(column[row - (ptrdiff_t)lda]), t[q], u[q]);
        upper[q] = V_FIRST(u[q]);
    }
    scale = V_SIGNED(V_SET(inverse), u[j]);
    reciprocal[j] = V_FIRST(scale);
    if (!(inverse <= DBL_MAX)) { /* the pivot is subnormal */
        for (i = 0; i < m; i++) column[i] /= upper[j];
        scale = V_SET(1.0);
    }
    here = V_SET((double)row);
    YCI_UNROLL
    for (i = 0; i < 4; i++) best[i] = V_SET(0.0);
    if (j + 1 == YCI_PANEL) {
        for (i = 0; i < m; i += V_W) V_STORE(column + i, V_MUL(V_LOAD(column + i), scale));
    } else {
        for (i = 0; i + 4 * V_W <= m; i += 4 * V_W)
            YCI_(yci_eliminate)(odd, 4, column + i, lda, scale, t[j + 1], u[j + 1], &at, here, best);
        for (; i < m; i += V_W)
            YCI_(yci_eliminate)(odd, 1, column + i, lda, scale, t[j + 1], u[j + 1], &at, here, best);
        *most = YCI_(yci_most)(4, best);
    }
    if (odd && j + 2 < YCI_PANEL)
        for (i = 0; i < m; i += V_W) {
            V k = V_LOAD(column - lda + i), l = V_LOAD(column + i);
            YCI_UNROLL
            for (q = j + 2; q < YCI_PANEL; q++) {
                double *to = a + (size_t)q * lda + i;
                V_STORE(to, V_FNMA(l, u[q], V_FNMA(k, t[q], V_LOAD(to))));
            }
        }
    for (q = 0; q < j; q++)
        if (row == q) row = pivot[q];
    pivot[j] = row;
    return 1;
}

YCI_TARGET static void YCI_(yci_exchange)(int count, const int *pivot, int n, double *a, size_t lda) {
    int i, k;
    for (k = 0; k < count; k++) {
        double *x = a + (size_t)k * lda, *y = a + (size_t)pivot[k] * lda;
        if (k + YCI_PANEL < count)
            for (i = 0; i < n; i += 8) V_PREFETCH(a + (size_t)pivot[k + YCI_PANEL] * lda + i);
        if (x == y) continue;
        for (i = 0; i < n; i += V_W) {
            V upper = V_LOAD(x + i), lower = V_LOAD(y + i);
            V_STORE(x + i, lower);
            V_STORE(y + i, upper);
        }
    }
}

YCI_TARGET static int YCI_(yci_panel)(
    const yci_panel *p, int m, int n, double *a, size_t lda, int *pivot, double *corner, double *inverse) {
    double upper[YCI_PANEL][YCI_PANEL], *w = p->w;
    V best[4], most, even[YCI_PANEL], odd[YCI_PANEL];
    int i, k;
    YCI_(yci_transpose)(m, YCI_PANEL, a, lda, w, p->ldw);
    YCI_UNROLL
    for (i = 0; i < 4; i++) best[i] = V_SET(0.0);
    for (i = 0; i < m; i += V_W) best[0] = V_MAX(V_ABS(V_LOAD(w + i)), best[0]);
    most = YCI_(yci_most)(4, best);
#define YCI_STEP(j, t, u) \
    if (n > (j) && !YCI_(yci_pivot)(j, m, w, p->ldw, pivot, inverse, upper[j], t, u, &most)) return (j)
    YCI_STEP(0, odd, even);
    YCI_STEP(1, even, odd);
    YCI_STEP(2, odd, even);
    YCI_STEP(3, even, odd);
    YCI_STEP(4, odd, even);
    YCI_STEP(5, even, odd);
    YCI_STEP(6, odd, even);
    YCI_STEP(7, even, odd);
#undef YCI_STEP
    YCI_(yci_transpose)(YCI_PANEL, m, w, p->ldw, a, lda);
    YCI_(yci_exchange)(n, pivot, p->last - p->first, a + p->first, lda);
    for (k = 0; k < n; k++)
        for (i = 0; i < YCI_PANEL; i += V_W) {
            double *to = a + (size_t)k * lda + i;
            V at = V_ADD(V_COUNT, V_SET((double)i));
            V_STORE(to, V_PICK(V_SET((double)k), at, V_LOAD(to), V_LOAD(upper[k] + i)));
        }
    YCI_(yci_transpose)(YCI_PANEL, YCI_PANEL, a, lda, corner, YCI_PANEL);
    return n;
}

/* s -= L U for some rows of L, ldl apart. Row j of s begins at s[j * stride]. */
YCI_TARGET YCI_INLINE void YCI_(yci_lower)(
    int vectors, int rows, int k, const double *u, const double *l, size_t ldl, V *s, int stride) {
    int i, j;
    for (; k > 0; k--, u += YCI_LU_STRIP, l++) {
        V x[V_TILE_V];
        YCI_UNROLL
        for (i = 0; i < vectors; i++) x[i] = V_LOAD(u + V_W * i);
        YCI_UNROLL
        for (j = 0; j < rows; j++) {
            V y = V_SET(l[(size_t)j * ldl]);
            YCI_UNROLL
            for (i = 0; i < vectors; i++) s[j * stride + i] = V_FNMA(x[i], y, s[j * stride + i]);
        }
    }
}

/* YCI_PANEL rows of U, at c and at u + YCI_LU_STRIP * k, from the k before them. */
YCI_TARGET YCI_INLINE void YCI_(yci_upper)(
    int vectors, int k, const double *l, size_t ldl, double *u, double *c, size_t ldc) {
    V s[YCI_PANEL][V_STRIP_V];
    int i, j, q;
    YCI_UNROLL
    for (j = 0; j < YCI_PANEL; j++) YCI_UNROLL
    for (i = 0; i < vectors; i++) s[j][i] = V_LOAD(c + (size_t)j * ldc + V_W * i);
    YCI_(yci_lower)(vectors, YCI_PANEL, k, u, l, ldl, s[0], V_STRIP_V);
    l += k, u += YCI_LU_STRIP * k;
    YCI_UNROLL
    for (j = 0; j < YCI_PANEL; j++) {
        YCI_UNROLL
        for (i = 0; i < vectors; i++) {
            V_STORE(c + (size_t)j * ldc + V_W * i, s[j][i]);
            V_STORE(u + YCI_LU_STRIP * j + V_W * i, s[j][i]);
        }
        YCI_UNROLL
        for (q = j + 1; q < YCI_PANEL; q++) YCI_UNROLL
        for (i = 0; i < vectors; i++) s[q][i] = V_FNMA(s[j][i], V_SET(l[(size_t)q * ldl + (size_t)j]), s[q][i]);
    }
}

/* V_TILE_N rows of C, less L U. */
YCI_TARGET YCI_INLINE void YCI_(yci_rest)(
    int vectors, int k, const double *l, size_t ldl, const double *u, double *c, size_t ldc) {
    V s[V_TILE_N][V_TILE_V];
    int i, j;
    YCI_UNROLL
    for (j = 0; j < V_TILE_N; j++) YCI_UNROLL
    for (i = 0; i < vectors; i++) s[j][i] = V_SET(0.0);
    YCI_(yci_lower)(vectors, V_TILE_N, k, u, l, ldl, s[0], V_TILE_V);
    YCI_UNROLL
    for (j = 0; j < V_TILE_N; j++) YCI_UNROLL
    for (i = 0; i < vectors; i++) {
        double *to = c + (size_t)j * ldc + V_W * i;
        V_STORE(to, V_ADD(V_LOAD(to), s[j][i]));
    }
}

/* The tile of the next rows is fetched meanwhile: they lie far apart, where no processor foresees them. */
YCI_TARGET static void YCI_(yci_update)(int m, int n, int k, const double *l, size_t ldl, double *c, size_t ldc) {
    V rows[YCI_LU_STRIP * YCI_LU_BLOCK / V_W]; /* in whole lines */
    double *u = (double *)rows;
    int i, j, p, far = ldc > 256; /* a smaller C is near already */
    for (j = 0; j < k; j += YCI_PANEL, l += YCI_PANEL * ldl, c += YCI_PANEL * ldc)
        for (i = 0; i < m; i += V_STRIP_V * V_W) {
#if V_STRIP_V == 3
            if (m - i == V_W) YCI_(yci_upper)(1, j, l, ldl, u + i, c + i, ldc);
            else if (m - i == 2 * V_W) YCI_(yci_upper)(2, j, l, ldl, u + i, c + i, ldc);
            else
#endif
                YCI_(yci_upper)(V_STRIP_V, j, l, ldl, u + i, c + i, ldc);
        }
    for (; j < n; j += V_TILE_N, l += V_TILE_N * ldl, c += V_TILE_N * ldc) {
        for (p = V_TILE_N; far && p < 2 * V_TILE_N; p++)
            for (i = 0; i < m; i += 8) V_PREFETCH(c + (size_t)p * ldc + i);
        for (i = 0; i < m; i += V_TILE_V * V_W) {
            if (m - i == V_W) YCI_(yci_rest)(1, k, l, ldl, u + i, c + i, ldc);
            else if (m - i == 2 * V_W) YCI_(yci_rest)(2, k, l, ldl, u + i, c + i, ldc);
            else YCI_(yci_rest)(V_TILE_V, k, l, ldl, u + i, c + i, ldc);
        }
    }
}

#define V_PANEL (YCI_PANEL / V_W) /* vectors of a panel's rows */

/* T -= A X for rows `first` to first + some - 1 of A, which lie at multiples of lda and have m numbers. */
YCI_TARGET YCI_INLINE void YCI_(yci_dots_some)(
    int first, int some, int m, const double *a, size_t lda, V (*t)[V_PANEL], const double *x, size_t ldx, int count) {
    V s[YCI_RIGHT][YCI_PANEL];
    int i, j, r;
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (j = 0; j < YCI_PANEL; j++) s[r][j] = V_SET(0.0);
    for (i = 0; i + V_W <= m; i += V_W) {
        V y[YCI_RIGHT];
        YCI_UNROLL
        for (r = 0; r < count; r++) y[r] = V_LOAD(x + (size_t)r * ldx + i);
        YCI_UNROLL
        for (j = first; j < first + some; j++) {
            V z = V_LOAD(a + (size_t)j * lda + i);
            YCI_UNROLL
            for (r = 0; r < count; r++) s[r][j] = V_FMA(z, y[r], s[r][j]);
        }
    }
    if (i < m) {
        YCI_UNROLL
        for (r = 0; r < count; r++) {
            V y = V_LOAD_PART(x + (size_t)r * ldx + i, m - i);
            YCI_UNROLL
            for (j = first; j < first + some; j++) s[r][j] = V_FMA(V_LOAD(a + (size_t)j * lda + i), y, s[r][j]);
        }
    }
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (j = 0; j < V_PANEL; j++)
        if (some == YCI_PANEL || V_W > some || (j * V_W >= first && j * V_W < first + some))
            t[r][j] = V_SUB(t[r][j], YCI_(yci_sums)(s[r] + V_W * j));
}

YCI_TARGET YCI_INLINE void YCI_(yci_dots)(
    int m, const double *a, size_t lda, V (*t)[V_PANEL], const double *x, size_t ldx, int count) {
    if (m <= 0) return;
    if (count < V_ALL_ROWS) YCI_(yci_dots_some)(0, YCI_PANEL, m, a, lda, t, x, ldx, count);
    else {
        YCI_(yci_dots_some)(0, YCI_PANEL / 2, m, a, lda, t, x, ldx, count);
        YCI_(yci_dots_some)(YCI_PANEL / 2, YCI_PANEL / 2, m, a, lda, t, x, ldx, count);
    }
}

/* T := inverse(C) T for the triangle of a corner whose column j is at c + j * ldc: below the diagonal, going down, or
 * above it, going up. inverse: one over the diagonal, or NULL where that is one. */
YCI_TARGET YCI_INLINE void YCI_(yci_corner)(
    int up, const double *c, size_t ldc, const double *inverse, V (*t)[V_PANEL], int count) {
    int step, r, v;
    YCI_UNROLL
    for (step = 0; step < YCI_PANEL; step++) {
        int j = up ? YCI_PANEL - 1 - step : step;
        V here = V_SET((double)j), column[V_PANEL];
        YCI_UNROLL
        for (v = 0; v < V_PANEL; v++) {
            V at = V_ADD(V_COUNT, V_SET((double)(V_W * v))), x = V_LOAD(c + (size_t)j * ldc + V_W * v);
            column[v] = up ? V_PICK(here, at, x, V_SET(0.0)) : V_PICK(at, here, x, V_SET(0.0));
        }
        YCI_UNROLL
        for (r = 0; r < count; r++) {
            V x = V_LANE(t[r][j / V_W], j % V_W);
            if (inverse) x = V_MUL(x, V_SET(inverse[j]));
            YCI_UNROLL
            for (v = 0; v < V_PANEL; v++) t[r][v] = V_FNMA(column[v], x, t[r][v]);
        }
    }
    if (inverse) {
        YCI_UNROLL
        for (r = 0; r < count; r++) YCI_UNROLL
        for (v = 0; v < V_PANEL; v++) t[r][v] = V_MUL(t[r][v], V_LOAD(inverse + V_W * v));
    }
}

/* T from and to rows of X of which n exist. */
YCI_TARGET YCI_INLINE void YCI_(yci_fetch)(int n, const double *x, size_t ldx, V (*t)[V_PANEL], int count) {
    int r, v;
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (v = 0; v < V_PANEL; v++) {
        const double *from = x + (size_t)r * ldx + V_W * v;
        int left = n - V_W * v;
        t[r][v] = left >= V_W ? V_LOAD(from) : left > 0 ? V_LOAD_PART(from, left) : V_SET(0.0);
    }
}

YCI_TARGET YCI_INLINE void YCI_(yci_deliver)(int n, V (*t)[V_PANEL], double *x, size_t ldx, int count) {
    int r, v;
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (v = 0; v < V_PANEL; v++) {
        double *to = x + (size_t)r * ldx + V_W * v;
        int left = n - V_W * v;
        if (left >= V_W) V_STORE(to, t[r][v]);
        else if (left > 0) V_STORE_PART(to, t[r][v], left);
    }
}

YCI_TARGET YCI_INLINE void YCI_(yci_solve_some)(
    int n, const double *f, size_t ld, const double *corner, const double *inverse, double *x, size_t ldx, int count) {
    V t[YCI_RIGHT][V_PANEL];
    int i;
    for (i = 0; i < n; i += YCI_PANEL) {
        YCI_(yci_fetch)(n - i, x + i, ldx, t, count);
        YCI_(yci_dots)(i, f + (size_t)i * ld, ld, t, x, ldx, count);
        YCI_(yci_corner)(0, corner + YCI_PANEL * (size_t)i, YCI_PANEL, NULL, t, count);
        YCI_(yci_deliver)(n - i, t, x + i, ldx, count);
    }
    for (i -= YCI_PANEL; i >= 0; i -= YCI_PANEL) {
        int next = i + YCI_PANEL;
        YCI_(yci_fetch)(n - i, x + i, ldx, t, count);
        YCI_(yci_dots)(n - next, f + (size_t)i * ld + next, ld, t, x + next, ldx, count);
        YCI_(yci_corner)(1, corner + YCI_PANEL * (size_t)i, YCI_PANEL, inverse + i, t, count);
        YCI_(yci_deliver)(n - i, t, x + i, ldx, count);
    }
}

/* X -= A' T for YCI_PANEL rows of A with m numbers each. */
YCI_TARGET YCI_INLINE void YCI_(yci_spread)(
    int m, const double *a, size_t lda, V (*t)[V_PANEL], double *x, size_t ldx, int count) {
    double lane[YCI_RIGHT][YCI_PANEL];
    int i, j, r;
    YCI_UNROLL
    for (r = 0; r < count; r++) YCI_UNROLL
    for (j = 0; j < V_PANEL; j++) V_STORE(lane[r] + V_W * j, t[r][j]);
    for (i = 0; i < m; i += V_W) {
        V s[YCI_RIGHT];
        YCI_UNROLL
        for (r = 0; r < count; r++) {
            const double *from = x + (size_t)r * ldx + i;
            s[r] = m - i >= V_W ? V_LOAD(from) : V_LOAD_PART(from, m - i);
        }
        YCI_UNROLL
        for (j = 0; j < YCI_PANEL; j++) {
            V y = V_LOAD(a + (size_t)j * lda + i);
            YCI_UNROLL
            for (r = 0; r < count; r++) s[r] = V_FNMA(y, V_SET(lane[r][j]), s[r]);
        }
        YCI_UNROLL
        for (r = 0; r < count; r++) {
            double *to = x + (size_t)r * ldx + i;
            if (m - i >= V_W) V_STORE(to, s[r]);
            else V_STORE_PART(to, s[r], m - i);
        }
    }
}

YCI_TARGET YCI_INLINE void YCI_(yci_solve_transposed_some)(
    int n, const double *f, size_t ld, const double *inverse, double *x, size_t ldx, int count) {
    V t[YCI_RIGHT][V_PANEL];
    int i;
    for (i = 0; i < n; i += YCI_PANEL) {
        const double *corner = f + (size_t)i * ld + i;
        YCI_(yci_fetch)(n - i, x + i, ldx, t, count);
        YCI_(yci_corner)(0, corner, ld, inverse + i, t, count);
        YCI_(yci_deliver)(n - i, t, x + i, ldx, count);
        YCI_(yci_spread)(n - i - YCI_PANEL, corner + YCI_PANEL, ld, t, x + i + YCI_PANEL, ldx, count);
    }
    for (i -= YCI_PANEL; i >= 0; i -= YCI_PANEL) {
        const double *row = f + (size_t)i * ld;
        YCI_(yci_fetch)(n - i, x + i, ldx, t, count);
        YCI_(yci_corner)(1, row + i, ld, NULL, t, count);
        YCI_(yci_deliver)(n - i, t, x + i, ldx, count);
        YCI_(yci_spread)(i, row, ld, t, x, ldx, count);
    }
}

YCI_TARGET static void YCI_(yci_solve)(
    int n, const double *f, size_t ld, const double *corner, const double *inverse, double *x, size_t ldx, int count) {
    if (count == 1) YCI_(yci_solve_some)(n, f, ld, corner, inverse, x, ldx, 1);
    else if (count == 2) YCI_(yci_solve_some)(n, f, ld, corner, inverse, x, ldx, 2);
    else if (count == 3) YCI_(yci_solve_some)(n, f, ld, corner, inverse, x, ldx, 3);
    else YCI_(yci_solve_some)(n, f, ld, corner, inverse, x, ldx, 4);
}

YCI_TARGET static void YCI_(yci_solve_transposed)(
    int n, const double *f, size_t ld, const double *inverse, double *x, size_t ldx, int count) {
    if (count == 1) YCI_(yci_solve_transposed_some)(n, f, ld, inverse, x, ldx, 1);
    else if (count == 2) YCI_(yci_solve_transposed_some)(n, f, ld, inverse, x, ldx, 2);
    else if (count == 3) YCI_(yci_solve_transposed_some)(n, f, ld, inverse, x, ldx, 3);
    else YCI_(yci_solve_transposed_some)(n, f, ld, inverse, x, ldx, 4);
}

/* s -= A B', s[j] being column j. */
YCI_TARGET YCI_INLINE void YCI_(yci_block_accumulate)(
    int n, int vectors, int k, const double *a, int lda, const double *b, V (*s)[YCI_BLOCK_MAX / V_W]) {
    int i, j;
    for (; k > 0; k--, a += lda, b += n) {
        YCI_UNROLL
        for (j = 0; j < n; j++) {
            V y = V_SET(b[j]);
            YCI_UNROLL
            for (i = 0; i < vectors; i++) s[j][i] = V_FNMA(V_LOAD(a + V_W * i), y, s[j][i]);
        }
    }
}

YCI_TARGET YCI_INLINE void YCI_(yci_block_some)(
    int m, int n, const yci_block_terms *t, const double *c, const double *h, double *d) {
    const int vectors = (m + V_W - 1) / V_W;
    double work[YCI_BLOCK_MAX * YCI_BLOCK_MAX];
    V s[YCI_BLOCK_MAX][YCI_BLOCK_MAX / V_W];
    int i, j, p;
    YCI_UNROLL
    for (j = 0; j < n; j++) YCI_UNROLL
    for (i = 0; i < vectors; i++) s[j][i] = V_LOAD(c + m * j + V_W * i);
    for (p = 0; p < t->count; p++) YCI_(yci_block_accumulate)(n, vectors, t->k[p], t->a[p], m, t->b[p], s);
    YCI_UNROLL
    for (j = 0; j < n && h; j++) YCI_UNROLL
    for (i = 0; i < vectors; i++)
        V_STORE(work + YCI_BLOCK_MAX * j + V_W * i, V_SUB(V_SET(0.0), s[j][i])), s[j][i] = V_SET(0.0);
    if (h) YCI_(yci_block_accumulate)(n, vectors, n, work, YCI_BLOCK_MAX, h, s);
    YCI_UNROLL
    for (j = 0; j < n; j++) /* what is written behind a column comes before the next one */
        YCI_UNROLL
    for (i = 0; i < vectors; i++) V_STORE(d + m * j + V_W * i, s[j][i]);
}

YCI_TARGET static void YCI_(yci_block)(
    int m, int n, const yci_block_terms *t, const double *c, const double *h, double *d) {
    if (m == 5 && n == 5) YCI_(yci_block_some)(5, 5, t, c, h, d); /* a crossing's */
    else YCI_(yci_block_some)(m, n, t, c, h, d);
}

YCI_TARGET YCI_INLINE void YCI_(yci_row_some)(
    int m, int count, const int *col, const int *dim, const int *off, const double *a, const double *x, double *y) {
    V s[YCI_BLOCK_MAX];
    double lane[V_W];
    int i, j, k;
    YCI_UNROLL
    for (i = 0; i < m; i++) s[i] = V_SET(0.0);
    for (k = 0; k < count; k++) {
        const double *from = x + off[col[k]];
        int n = dim[col[k]];
        for (j = 0; j < n; j += V_W) { /* of the last vector what is behind a row meets zeros */
            V part = n - j >= V_W ? V_LOAD(from + j) : V_LOAD_PART(from + j, n - j);
            YCI_UNROLL
            for (i = 0; i < m; i++) s[i] = V_FMA(V_LOAD(a + n * i + j), part, s[i]);
        }
        a += m * n;
    }
    for (i = 0; i < m; i++) {
        V_STORE(lane, s[i]);
        for (j = 0, y[i] = 0.0; j < V_W; j++) y[i] += lane[j];
    }
}

YCI_TARGET static void YCI_(yci_row)(
    int m, int count, const int *col, const int *dim, const int *off, const double *a, const double *x, double *y) {
    if (m == 5) YCI_(yci_row_some)(5, count, col, dim, off, a, x, y);
    else if (m == 3) YCI_(yci_row_some)(3, count, col, dim, off, a, x, y);
    else YCI_(yci_row_some)(m, count, col, dim, off, a, x, y);
}

/* Row i of y, its m numbers, with zeros behind. */
YCI_TARGET YCI_INLINE void YCI_(yci_substitute_put)(int m, const V *s, double *y) {
    int v;
    YCI_UNROLL
    for (v = 0; v < (m + V_W - 1) / V_W; v++)
        V_STORE(y + V_W * v, V_PICK(V_SET((double)m), V_ADD(V_COUNT, V_SET((double)(V_W * v))), s[v], V_SET(0.0)));
}

/* y_i := G_i (y_i - sum L_ij y_j), G the inverse corner. */
YCI_TARGET YCI_INLINE void YCI_(yci_substitute_down)(const yci_substitution *t, int i, int m) {
    const int vectors = (m + V_W - 1) / V_W;
    double *y = t->y + YCI_BLOCK_MAX * (size_t)i;
    V s[1][YCI_BLOCK_MAX / V_W];
    int k, v;
    YCI_UNROLL
    for (v = 0; v < vectors; v++) s[0][v] = V_LOAD(y + V_W * v);
    for (k = t->ptr[i]; k < t->ptr[i + 1]; k++) {
        int j = t->col[k];
        YCI_(yci_block_accumulate)(1, vectors, t->dim[j], t->val + t->at[k], m, t->y + YCI_BLOCK_MAX * (size_t)j, s);
    }
    YCI_UNROLL
    for (v = 0; v < vectors; v++) V_STORE(y + V_W * v, V_SUB(V_SET(0.0), s[0][v])), s[0][v] = V_SET(0.0);
    YCI_(yci_block_accumulate)(1, vectors, m, t->val + t->corner[i], m, y, s);
    YCI_(yci_substitute_put)(m, s[0], y);
}

/* p[c] += column c of A, by n numbers of y. */
YCI_TARGET YCI_INLINE void YCI_(yci_substitute_dots)(int m, int n, const double *a, const double *y, V *p) {
    int c, v;
    for (v = 0; v < n; v += V_W) {
        V x = V_LOAD(y + v);
        YCI_UNROLL
        for (c = 0; c < m; c++) p[c] = V_FMA(V_LOAD(a + n * c + v), x, p[c]);
    }
}

/* y_i := G_i' (y_i - sum L_ki' y_k). */
YCI_TARGET YCI_INLINE void YCI_(yci_substitute_up)(const yci_substitution *t, int i, int m) {
    double *y = t->y + YCI_BLOCK_MAX * (size_t)i;
    V p[YCI_BLOCK_MAX], s[YCI_BLOCK_MAX / V_W];
    int c, k, v;
    YCI_UNROLL
    for (c = 0; c < YCI_BLOCK_MAX; c++) p[c] = V_SET(0.0);
    for (k = t->down_ptr[i]; k < t->down_ptr[i + 1]; k++) {
        int j = t->row[k];
        YCI_(yci_substitute_dots)(m, t->dim[j], t->val + t->at[t->down[k]], t->y + YCI_BLOCK_MAX * (size_t)j, p);
    }
    YCI_UNROLL
    for (v = 0; v < YCI_BLOCK_MAX / V_W; v++)
        if (V_W * v < m) s[v] = V_SUB(V_LOAD(y + V_W * v), YCI_(yci_sums)(p + V_W * v));
    YCI_(yci_substitute_put)(m, s, y);
    YCI_UNROLL
    for (c = 0; c < YCI_BLOCK_MAX; c++) p[c] = V_SET(0.0);
    YCI_(yci_substitute_dots)(m, m, t->val + t->corner[i], y, p);
    YCI_UNROLL
    for (v = 0; v < YCI_BLOCK_MAX / V_W; v++)
        if (V_W * v < m) s[v] = YCI_(yci_sums)(p + V_W * v);
    YCI_(yci_substitute_put)(m, s, y);
}

YCI_TARGET static void YCI_(yci_substitute)(const yci_substitution *t) {
    int i;
    for (i = 0; i < t->count; i++)
        if (t->dim[i] == 5) YCI_(yci_substitute_down)(t, i, 5);
        else if (t->dim[i] == 3) YCI_(yci_substitute_down)(t, i, 3);
        else YCI_(yci_substitute_down)(t, i, t->dim[i]);
    for (i = t->count - 1; i >= 0; i--)
        if (t->dim[i] == 5) YCI_(yci_substitute_up)(t, i, 5);
        else if (t->dim[i] == 3) YCI_(yci_substitute_up)(t, i, 3);
        else YCI_(yci_substitute_up)(t, i, t->dim[i]);
}

#define YCI_TEXT_(name) #name
#define YCI_TEXT(name) YCI_TEXT_(name)
static const yci_kernels YCI_(yci_kernels) = {YCI_TEXT(YCI_()), YCI_(yci_product), YCI_(yci_strips), YCI_(yci_expand),
    YCI_(yci_pack), YCI_(yci_forward), YCI_(yci_backward), YCI_(yci_tiles_factor), YCI_(yci_tiles_solve),
    YCI_(yci_finite), YCI_(yci_take), YCI_(yci_transpose), YCI_(yci_panel), YCI_(yci_exchange), YCI_(yci_update),
    YCI_(yci_solve), YCI_(yci_solve_transposed), YCI_(yci_block), YCI_(yci_row), YCI_(yci_substitute)};

#ifdef __clang__
#pragma clang diagnostic pop
#elif defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#undef YCI_
#undef YCI_TARGET
#undef YCI_TEXT
#undef YCI_TEXT_
#undef V
#undef V_W
#undef V_TILE_V
#undef V_TILE_N
#undef V_STRIP_V
#undef V_COLUMNS
#undef V_SET
#undef V_LOAD
#undef V_STORE
#undef V_STORE_PART
#undef V_ADD
#undef V_SUB
#undef V_MUL
#undef V_FMA
#undef V_FNMA
#undef V_EXPAND
#undef V_FNMA1
#undef V_TILE_PART
#undef V_PREFETCH
#undef V_ALL_ROWS
#undef V_COUNT
#undef V_LOAD_PART
#undef V_ABS
#undef V_MAX
#undef V_PICK
#undef V_LANE
#undef V_SAME
#undef V_WHERE
#undef V_MOST
#undef V_FIRST
#undef V_SIGNED
#undef V_PANEL
#endif /* ---- what is read once per instruction set ---- */

#if defined(YCI_ISA) && YCI_ISA == 0 /* the rest is read once again */
#undef YCI_ISA

/* The kernels for instruction set `level`, 0 to YCI_LEVELS - 1, plain to best; NULL where this processor lacks it. */
#define YCI_LEVELS 3
static const yci_kernels *yci_kernels_of(int level) {
    if (level == 0) return &yci_kernels_plain;
#ifdef YCI_X86
    if (level == 1 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return &yci_kernels_avx2;
    if (level == 2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma"))
        return &yci_kernels_avx512;
#endif
    return NULL;
}

static const yci_kernels *yci_kernels_best(void) {
    const yci_kernels *best = NULL;
    int level = YCI_LEVELS;
    while (!best) best = yci_kernels_of(--level);
    return best;
}

/* ------------------------------------------------------------------------------------------ panels of a factor --- */

/* The leading n columns of a symmetric front of m rows (its lower triangle) become those of its Cholesky factor, panel
 * by panel looking left; diagonal blocks as yci_trapezoid wants them. What stands above the diagonal is overwritten.
 * reference[j] is what pivot j came from: one lost in its rounding counts as zero. Returns the column without a pivot,
 * or -1. */
static int yci_panel_cholesky(const yci_kernels *kernel, int m, int n, double *f, size_t ld, const double *reference) {
    int begin, width, j, i, k;
    for (begin = 0; begin < n; begin += width) {
        double g[YCI_PANEL * YCI_PANEL], inverse[YCI_PANEL], *corner = f + (size_t)begin * (ld + 1);
        width = yci_min_int(n - begin, YCI_PANEL);
        if (begin) kernel->product(width, width, begin, f + begin, ld, f + begin, ld, corner, ld, 1);
        for (j = 0; j < width; j++)
            for (i = j; i < width; i++) g[YCI_PANEL * j + i] = corner[(size_t)j * ld + (size_t)i];
        for (j = 0; j < width; j++) { /* L D L' first, since a division takes less time than a root besides */
            double *a = g + YCI_PANEL * j, pivot = a[j];
            if (!(pivot > 0.0 && pivot > YCI_PIVOT_TOLERANCE * reference[begin + j] && pivot <= DBL_MAX))
                return begin + j;
            inverse[j] = 1.0 / pivot;
            for (k = j + 1; k < width; k++) {
                double factor = inverse[j] <= DBL_MAX ? a[k] * inverse[j] : a[k] / pivot;
                for (i = k; i < width; i++) g[YCI_PANEL * k + i] -= a[i] * factor;
            }
        }
        for (j = 0; j < width; j++) {
            double *a = g + YCI_PANEL * j;
            inverse[j] = 1.0 / sqrt(a[j]);
            corner[(size_t)j * ld + (size_t)j] = inverse[j];
            for (i = j + 1; i < width; i++) a[i] *= inverse[j], corner[(size_t)j * ld + (size_t)i] = a[i] * inverse[j];
        }
        kernel->strips(
            m - begin - width, width, begin, f + begin + width, ld, f + begin, ld, g, inverse, corner + width, ld);
    }
    return -1;
}

/* Columns of the whole nodes, the first with dim[0] unknowns, that make up the next panel of at most n columns. */
static int yci_panel_nodes(const unsigned char *dim, int n) {
    int columns = dim[0];
    while (columns < n && columns + dim[columns] <= YCI_PANEL) columns += dim[columns];
    return columns;
}

/* The same for an indefinite front whose pivots are the blocks of whole nodes, L D L' with unit blocks on the diagonal
 * of L. `pivot` holds these blocks one after the other, before anything was subtracted; they become their inverses.
 * `scaled` (of the same layout) receives L D below the panels. A block without an inverse has `shift` added to its
 * diagonal, away from zero, and is counted in *repaired; with shift 0 it ends the factorisation. */
static int yci_panel_indefinite(const yci_kernels *kernel, int m, int n, double *f, size_t ld, const unsigned char *dim,
    double *pivot, double shift, double *scaled, int *repaired) {
    static const double ones[YCI_PANEL] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
    int begin, width, j, i, k, a, b, d;
    for (begin = 0; begin < n; begin += width) {
        double g[YCI_PANEL * YCI_PANEL] = {0.0}, minus[YCI_PANEL * YCI_PANEL] = {0.0};
        double *corner = f + (size_t)begin * (ld + 1), *w = scaled + (size_t)begin * ld + begin;
        width = yci_panel_nodes(dim + begin, n - begin);
        if (begin) kernel->product(width, width, begin, f + begin, ld, scaled + begin, ld, corner, ld, 1);
        for (j = 0; j < width; j += d, pivot += d * d) {
            double block[YCI_BLOCK_MAX * YCI_BLOCK_MAX], inverse[YCI_BLOCK_MAX * YCI_BLOCK_MAX];
            d = dim[begin + j];
            for (a = 0; a < d; a++)
                for (b = 0; b <= a; b++)
                    block[a * d + b] = block[b * d + a] = corner[(size_t)(j + b) * ld + (size_t)(j + a)];
            if (!(yci_block_invert(d, block, pivot, inverse) > 0.0)) {
                if (!yci_block_repair(d, block, pivot, shift, inverse)) return begin + j;
                ++*repaired;
            }
            for (a = 0; a < d; a++)
                for (b = 0; b < d; b++) {
                    pivot[a * d + b] = inverse[a * d + b];
                    minus[YCI_PANEL * (j + b) + j + a] = -inverse[a * d + b];
                }
            for (i = j + d; i < width; i++) { /* L of the panel's later rows, and what it takes from them */
                for (a = 0; a < d; a++)
                    for (b = 0; b < d; b++)
                        g[YCI_PANEL * (j + a) + i] += corner[(size_t)(j + b) * ld + (size_t)i] * inverse[b * d + a];
                for (k = j + d; k <= i; k++)
                    for (a = 0; a < d; a++)
                        corner[(size_t)k * ld + (size_t)i] -=
                            g[YCI_PANEL * (j + a) + i] * corner[(size_t)(j + a) * ld + (size_t)k];
            }
        }
        k = m - begin - width;
        kernel->strips(k, width, begin, f + begin + width, ld, scaled + begin, ld, g, ones, corner + width, ld);
        for (j = 0; j < width; j++) {
            corner[(size_t)j * ld + (size_t)j] = 1.0;
            for (i = j + 1; i < width; i++) corner[(size_t)j * ld + (size_t)i] = g[YCI_PANEL * j + i];
            memcpy(w + (size_t)j * ld + width, corner + (size_t)j * ld + width, (size_t)k * sizeof *w);
        }
        kernel->product(k, width, width, w + width, ld, minus, YCI_PANEL, corner + width, ld, 0);
    }
    return -1;
}

struct yc_lu {
    yci_context context;
    const yci_kernels *kernels;
    int n, rows, factored, plain; /* n, and n in whole panels; a reciprocal overflows: solve with divisions */
    size_t ld;
    double *f;       /* the factor by rows: U on and above the diagonal, L (unit diagonal) below; zeros up to `rows` */
    yci_panel panel; /* room for a panel */
    double *corner;  /* the diagonal's 8 x 8 corners by columns */
    double *inverse; /* one over U's diagonal */
    double *work;    /* 2 * rows, for the scan and the condition estimate */
    int *pivot;      /* row exchanged with row j at step j */
    double norm;     /* the 1-norm of A */
    double largest;  /* and its largest entry */
};

YC_API void yc_lu_destroy(yc_lu *lu) {
    yci_context c;
    if (!lu) return;
    c = lu->context;
    yci_free(&c, lu->f);
    yci_free(&c, lu->panel.w);
    yci_free(&c, lu->corner);
    yci_free(&c, lu->inverse);
    yci_free(&c, lu->work);
    yci_free(&c, lu->pivot);
    yci_free(&c, lu);
}

/* A leading dimension of whole lines whose multiples do not meet in the same part of a cache, where that matters. */
static size_t yci_lu_stride(int rows) { return (size_t)rows + (rows > 64 && rows % 64 == 0 ? YCI_PANEL : 0); }

static int yci_lu_allocate(yc_lu *lu) {
    yci_context *c = &lu->context;
    size_t rows = (size_t)lu->rows;
    lu->ld = lu->panel.ldw = yci_lu_stride(lu->rows);
    lu->f = (double *)yci_alloc(c, rows + 1, lu->ld * sizeof(double));
    lu->panel.w = YCI_NEW(c, double, YCI_PANEL * lu->ld + YCI_LU_BEHIND);
    lu->corner = YCI_NEW(c, double, YCI_PANEL *rows);
    lu->inverse = YCI_NEW(c, double, rows);
    lu->work = YCI_NEW(c, double, 2 * rows + 1);
    lu->pivot = YCI_NEW(c, int, lu->n);
    return lu->f && lu->panel.w && lu->corner && lu->inverse && lu->work && lu->pivot;
}

YC_API yc_result yc_lu_create(const yc_host *host, int n, yc_lu **out) {
    yci_context c;
    yc_lu *lu;
    yc_result result = yci_context_init(&c, host);
    if (!out) return YC_ERROR_ARGUMENT;
    *out = NULL;
    if (result == YC_OK && (n < 0 || n > INT_MAX - YCI_PANEL))
        result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "yc_lu_create: n is %d", n);
    lu = result == YC_OK ? YCI_NEW(&c, yc_lu, 1) : NULL;
    if (lu) {
        lu->context = c, lu->kernels = yci_kernels_best(), lu->n = n;
        lu->rows = (n + YCI_PANEL - 1) / YCI_PANEL * YCI_PANEL;
        if (yci_lu_allocate(lu)) {
            *out = lu;
            return YC_OK;
        }
        yc_lu_destroy(lu);
    }
    if (result == YC_OK) result = YCI_FAIL(&c, YC_ERROR_MEMORY, "out of memory for an LU factorisation of order %d", n);
    yci_log(&c, "%s", c.message);
    return result;
}

YC_API const char *yc_lu_message(const yc_lu *lu) { return lu ? lu->context.message : "lu is NULL"; }

typedef struct {
    yc_lu *lu;
    int begin, end; /* the block's columns; a block that does not end in whole panels is the last */
} yci_lu_block_of;

static double *yci_lu_at(const yc_lu *lu, int row, int column) { return lu->f + (size_t)row * lu->ld + (size_t)column; }

/* Columns [from, to), at most YCI_LU_STRIP of them, are updated by [begin, end), which lie left of them. */
static void yci_lu_strip(const yc_lu *lu, int begin, int end, int from, int to) {
    lu->kernels->update(to - from, lu->rows - begin, end - begin, yci_lu_at(lu, begin, begin), lu->ld,
        yci_lu_at(lu, begin, from), lu->ld);
}

/* Factors columns [begin, end) of a block: halves, the right one updated by the left one. Returns the column without a
 * pivot, or -1. */
static int yci_lu_columns(const yci_lu_block_of *b, int begin, int end) {
    yc_lu *lu = b->lu;
    int middle = begin + (end - begin + 2 * YCI_PANEL - 1) / (2 * YCI_PANEL) * YCI_PANEL, bad, j;
    int stop = (end + YCI_PANEL - 1) / YCI_PANEL * YCI_PANEL, wide = stop - middle <= 32 ? 16 : YCI_LU_STRIP;
    if (end - begin <= YCI_PANEL) {
        yci_panel panel = lu->panel;
        panel.first = b->begin - begin, panel.last = (b->end + YCI_PANEL - 1) / YCI_PANEL * YCI_PANEL - begin;
        bad = lu->kernels->panel(&panel, lu->rows - begin, end - begin, yci_lu_at(lu, begin, begin), lu->ld,
            lu->pivot + begin, lu->corner + YCI_PANEL * (size_t)begin, lu->inverse + begin);
        if (bad < end - begin) return begin + bad;
        for (j = begin; j < end; j++) {
            lu->pivot[j] += begin - b->begin;
            if (!(fabs(lu->inverse[j]) <= DBL_MAX)) lu->plain = 1;
        }
        return -1;
    }
    if ((bad = yci_lu_columns(b, begin, middle)) >= 0) return bad;
    for (j = middle; j < stop; j += wide) yci_lu_strip(lu, begin, middle, j, yci_min_int(j + wide, stop));
    return yci_lu_columns(b, middle, end);
}

/* Strips of the columns outside a block: exchanges in all, and the update in those to its right. */
static void yci_lu_outside(void *arg, int first, int last) {
    const yci_lu_block_of *b = (const yci_lu_block_of *)arg;
    const yc_lu *lu = b->lu;
    int before = (b->begin + YCI_LU_LEFT - 1) / YCI_LU_LEFT, q;
    for (q = first; q < last; q++) {
        int right = q >= before, wide = right ? YCI_LU_STRIP : YCI_LU_LEFT;
        int from = right ? b->end + (q - before) * wide : q * wide;
        int to = yci_min_int(from + wide, right ? lu->rows : b->begin);
        lu->kernels->exchange(
            b->end - b->begin, lu->pivot + b->begin, to - from, yci_lu_at(lu, b->begin, from), lu->ld);
        if (right) yci_lu_strip(lu, b->begin, b->end, from, to);
    }
}

/* Factors the block of columns [begin, end) and updates the others. Returns the column without a pivot, or -1. */
static int yci_lu_step(yc_lu *lu, int begin, int end) {
    yci_lu_block_of b;
    int bad, j, items;
    b.lu = lu, b.begin = begin, b.end = end;
    bad = yci_lu_columns(&b, begin, end);
    if (bad >= 0) return bad;
    items = (begin + YCI_LU_LEFT - 1) / YCI_LU_LEFT;
    if (end < lu->n) items += (lu->rows - end + YCI_LU_STRIP - 1) / YCI_LU_STRIP;
    yci_parallel(&lu->context, items, 1, yci_lu_outside, &b);
    for (j = begin; j < end; j++) lu->pivot[j] += begin;
    return -1;
}

#ifdef YC_USE_LAPACK
/* A is turned round, tile by tile, since LAPACK factors by columns. Returns the column without a pivot, or -1. */
static int yci_lu_lapack(yc_lu *lu) {
    double tile[YCI_PANEL * YCI_PANEL];
    int i, j, k, ld = (int)lu->ld, info = 0;
    for (i = 0; i < lu->rows; i += YCI_PANEL)
        for (j = 0; j <= i; j += YCI_PANEL) {
            double *lower = lu->f + (size_t)i * lu->ld + j, *upper = lu->f + (size_t)j * lu->ld + i;
            lu->kernels->transpose(YCI_PANEL, YCI_PANEL, lower, lu->ld, tile, YCI_PANEL);
            if (i != j) lu->kernels->transpose(YCI_PANEL, YCI_PANEL, upper, lu->ld, lower, lu->ld);
            for (k = 0; k < YCI_PANEL; k++)
                memcpy(upper + (size_t)k * lu->ld, tile + YCI_PANEL * k, YCI_PANEL * sizeof(double));
        }
    if (lu->n) dgetrf_(&lu->n, &lu->n, lu->f, &ld, lu->pivot, &info);
    return info > 0 ? info - 1 : -1;
}

/* Leaves no right-hand sides to solve for. */
static void yci_lu_lapack_solve(const yc_lu *lu, const char *transposed, double *x, int *count, int ldx) {
    int ld = (int)lu->ld, info;
    if (lu->n && *count) dgetrs_(transposed, &lu->n, count, lu->f, &ld, lu->pivot, x, &ldx, &info);
    *count = 0;
}
#endif

/* Factors A in f. Returns the column without a pivot, or -1. */
static int yci_lu_all(yc_lu *lu) {
    int begin, end, bad = -1;
#ifdef YC_USE_LAPACK
    return yci_lu_lapack(lu);
#endif
    for (begin = 0; begin < lu->n && bad < 0; begin = end) {
        end = yci_min_int(begin + YCI_LU_BLOCK, lu->n);
        bad = yci_lu_step(lu, begin, end);
    }
    return bad;
}

static yc_result yci_lu_not_finite(yc_lu *lu, const double *a, int lda) {
    int i = 0, j = 0;
    while (fabs(a[(size_t)i * (size_t)lda + (size_t)j]) <= DBL_MAX)
        if (++j == lu->n) i++, j = 0;
    return YCI_FAIL(
        &lu->context, YC_ERROR_ARGUMENT, "yc_lu_factor: a[%d][%d] is %g", i, j, a[(size_t)i * (size_t)lda + (size_t)j]);
}

YC_API yc_result yc_lu_factor(yc_lu *lu, const double *a, int lda) {
    int bad;
    if (!lu) return YC_ERROR_ARGUMENT;
    if (lu->n && !a) return YCI_FAIL(&lu->context, YC_ERROR_ARGUMENT, "yc_lu_factor: a is NULL");
    if (lda < lu->n) return YCI_FAIL(&lu->context, YC_ERROR_ARGUMENT, "yc_lu_factor: lda is %d, n is %d", lda, lu->n);
    if (!lu->kernels->finite((size_t)lu->n, (size_t)lu->n, a, (size_t)lda)) return yci_lu_not_finite(lu, a, lda);
    lu->factored = lu->plain = 0;
    lu->largest = lu->kernels->take(lu->n, a, (size_t)lda, lu->f, lu->ld, lu->work, &lu->norm);
    bad = yci_lu_all(lu);
    if (bad >= 0) return YCI_FAIL(&lu->context, YC_ERROR_SINGULAR, "yc_lu_factor: column %d has no pivot", bad);
    lu->factored = 1;
    return YC_OK;
}

/* x := inverse(L U) x, or of its transpose, by the textbook: for a pivot whose reciprocal overflows. */
static void yci_lu_plain(const yc_lu *lu, double *x) {
    int i, j;
    for (i = 0; i < lu->n; i++)
        for (j = 0; j < i; j++) x[i] -= lu->f[(size_t)i * lu->ld + (size_t)j] * x[j];
    for (i = lu->n - 1; i >= 0; i--) {
        for (j = i + 1; j < lu->n; j++) x[i] -= lu->f[(size_t)i * lu->ld + (size_t)j] * x[j];
        x[i] /= lu->f[(size_t)i * lu->ld + (size_t)i];
    }
}

static void yci_lu_plain_transposed(const yc_lu *lu, double *x) {
    int i, j;
    for (i = 0; i < lu->n; i++) {
        x[i] /= lu->f[(size_t)i * lu->ld + (size_t)i];
        for (j = i + 1; j < lu->n; j++) x[j] -= lu->f[(size_t)i * lu->ld + (size_t)j] * x[i];
    }
    for (i = lu->n - 1; i >= 0; i--)
        for (j = 0; j < i; j++) x[j] -= lu->f[(size_t)i * lu->ld + (size_t)j] * x[i];
}

static void yci_lu_exchange(const yc_lu *lu, int i, double *x) {
    double value = x[i];
    x[i] = x[lu->pivot[i]], x[lu->pivot[i]] = value;
}

/* x := inverse(A) x = inverse(U) inverse(L) P x, or of the transpose, P' inverse(L') inverse(U') x; YCI_RIGHT at a
 * time, so that the factor is read once for them. */
static void yci_lu_solve_all(const yc_lu *lu, int transposed, double *x, int count, int ldx) {
    int i, k, some;
#ifdef YC_USE_LAPACK
    yci_lu_lapack_solve(lu, transposed ? "T" : "N", x, &count, ldx);
#endif
    for (; count > 0; count -= some, x += (size_t)some * (size_t)ldx) {
        some = yci_min_int(count, YCI_RIGHT);
        for (k = 0; !transposed && k < some; k++)
            for (i = 0; i < lu->n; i++) yci_lu_exchange(lu, i, x + (size_t)k * (size_t)ldx);
        for (k = 0; lu->plain && k < some; k++)
            (transposed ? yci_lu_plain_transposed : yci_lu_plain)(lu, x + (size_t)k * (size_t)ldx);
        if (!lu->plain && transposed)
            lu->kernels->solve_transposed(lu->n, lu->f, lu->ld, lu->inverse, x, (size_t)ldx, some);
        else if (!lu->plain) lu->kernels->solve(lu->n, lu->f, lu->ld, lu->corner, lu->inverse, x, (size_t)ldx, some);
        for (k = 0; transposed && k < some; k++)
            for (i = lu->n - 1; i >= 0; i--) yci_lu_exchange(lu, i, x + (size_t)k * (size_t)ldx);
    }
}

YC_API yc_result yc_lu_solve(const yc_lu *lu, double *x, int count, int ldx) {
    if (!lu || !lu->factored || count < 0 || ldx < lu->n || (count && lu->n && !x)) return YC_ERROR_ARGUMENT;
    yci_lu_solve_all(lu, 0, x, count, ldx);
    return YC_OK;
}

YC_API yc_result yc_lu_solve_transposed(const yc_lu *lu, double *x, int count, int ldx) {
    if (!lu || !lu->factored || count < 0 || ldx < lu->n || (count && lu->n && !x)) return YC_ERROR_ARGUMENT;
    yci_lu_solve_all(lu, 1, x, count, ldx);
    return YC_OK;
}

YC_API double yc_lu_growth(const yc_lu *lu) {
    double most = 0.0;
    int i, j;
    if (!lu || !lu->factored) return 0.0;
#ifdef YC_USE_LAPACK /* its factor lies by columns */
    for (i = 0; i < lu->n; i++)
        for (j = 0; j <= i; j++) most = yci_max(most, fabs(lu->f[(size_t)i * lu->ld + (size_t)j]));
#else
    for (i = 0; i < lu->n; i++)
        for (j = i; j < lu->n; j++) most = yci_max(most, fabs(lu->f[(size_t)i * lu->ld + (size_t)j]));
#endif
    return lu->n ? most / lu->largest : 1.0;
}

static double yci_dense_norm1(int n, const double *x) {
    double sum = 0.0;
    int i;
    for (i = 0; i < n; i++) sum += fabs(x[i]);
    return sum;
}

/* Hager's estimate of the 1-norm of the inverse with Higham's safeguard vector (N. J. Higham, FORTRAN codes for
 * estimating the one-norm of a real or complex matrix, ACM TOMS 14, 1988, algorithm 4.1). */
YC_API double yc_lu_rcond(const yc_lu *lu) {
    double *x, *z, estimate, alternative;
    int i, j, best, last = -1, round, n;
    if (!lu || !lu->factored) return 0.0;
    n = lu->n, x = lu->work, z = lu->work + n;
    if (n == 0) return 1.0;
    for (i = 0; i < n; i++) x[i] = 1.0 / n;
    yci_lu_solve_all(lu, 0, x, 1, n);
    estimate = yci_dense_norm1(n, x);
    for (round = 0; round < 5; round++) {
        double sum;
        for (i = 0; i < n; i++) z[i] = x[i] < 0.0 ? -1.0 : 1.0;
        yci_lu_solve_all(lu, 1, z, 1, n);
        for (best = 0, j = 1; j < n; j++)
            if (fabs(z[j]) > fabs(z[best])) best = j;
        if (best == last) break;
        for (i = 0; i < n; i++) x[i] = i == best ? 1.0 : 0.0;
        yci_lu_solve_all(lu, 0, x, 1, n);
        sum = yci_dense_norm1(n, x);
        if (!(sum > estimate)) break;
        estimate = sum, last = best;
    }
    for (i = 0; i < n; i++) x[i] = (i % 2 ? -1.0 : 1.0) * (1.0 + (n > 1 ? (double)i / (n - 1) : 0.0));
    yci_lu_solve_all(lu, 0, x, 1, n);
    alternative = 2.0 * yci_dense_norm1(n, x) / (3.0 * n);
    estimate = yci_max(estimate, alternative);
    return estimate <= DBL_MAX && estimate * lu->norm > 0.0 ? 1.0 / (estimate * lu->norm) : 0.0;
}

/* =====================================================================================================================
 * >>sparse   (chapter 4)
 *
 * Sparse symmetric matrices of small dense blocks, one block row per node:
 *
 *   yci_bsr     the matrix: pattern from node pairs, product
 *   yci_order   fill-reducing ordering of the node graph: minimum degree, nested dissection
 *   yci_ldl     direct factorisation P A P' = L D L', D of one symmetric block per node
 *   yci_ic      incomplete factorisation on the matrix's own pattern, for preconditioning
 *   yc_chol     the public face of yci_ldl
 *
 * Ordering: approximate minimum external degree on the quotient graph (Amestoy, Davis, Duff, An approximate minimum
 * degree ordering algorithm, SIAM J. Matrix Anal. 17, 1996), on nodes rather than unknowns; for large matrices with
 * much work per node, inside the pieces and separators of a nested dissection. The fronts that it meets are the
 * supernodes.
 *
 * Factorisation: multifrontal (Duff and Reid, 1983; Liu, The multifrontal method for sparse matrix solution, SIAM
 * Review 34, 1992). The unknowns of one supernode s stand in one front of `height` rows, in elimination order, of which
 * the first `width` are eliminated:
 *
 *     [ F11  .  ]      F11 = L11 D L11',   L21 = F21 inverse(D L11')
 *     [ F21 F22 ]      F22 := F22 - L21 D L21'
 *
 * (F11, F21) is the supernode's panel and stays as L; the update matrix F22 is added into the parent's front. With a
 * positive definite matrix D = I, and L is its Cholesky factor. Otherwise D has one block per node, inverted with
 * pivoting inside the block, so pairs [[0 g],[g -k]] of a quasi-definite matrix are stable in any order; L then has
 * unit blocks, and inverse(D) lies beside it. A front that is done is packed in the order in which solves read it.
 *
 * Small factors (at most YCI_LDL_TILES tiles of 8 x 8) are made in tiles instead, L D L' with D of whole tiles: see
 * yci_tiles. Whatever these cannot do, and every failure, is left to the fronts, so that there is one account of
 * errors.
 *
 * Measured on one core with AVX-512 (meshes of 100 to 100,000 vertices, 1 and 3 unknowns per vertex; make
 * bench-direct).
 * - Children's update matrices are expanded by masks of eight rows; adding them while a group of columns is still in
 *   the first cache gained nothing. An update matrix is written by the product and never zeroed. Runs of values go
 *   straight into the panels; fetching them ahead, and expanding four columns at a time, together saved 4 to 9 % of
 *   10,000 to 100,000 vertices. Amalgamation is flat around the costs below.
 * - Packing costs 7 % of a factorisation of 10,000 unknowns, and solves gain 1.1 (1 unknown per vertex) to 1.4 (3, or
 *   out of memory) by constant shapes and by memory read in one direction. They fetch L 16 KB ahead, worth 1.3 at
 *   100,000.
 * - Tiles halve the time of solves with 100 to 1,000 unknowns, and take a quarter to a half off factorisations of up
 *   to 500; with 1,000 unknowns these cost the same either way. A backward solve that reads them backwards gains a
 *   third.
 * - Dissection saves a quarter of the operations of 10,000 blocks of three. Minimum degree through windows of near
 *   nodes halves the analysis of 100,000 vertices in random order, which cache misses and page faults bound; ordering
 *   and build share one room, and entries are sorted once at the end instead of following each renumbering.
 * - A build without flags is as fast as -O3 -march=native (geometric mean of 7 matrices .96 to .98 for factorisations
 *   and solves). AVX2 takes 1.6 times as long to factor and 1.2 to solve, SSE2 3.8 and 1.6. Two workers factor 10,000
 *   to 50,000 blocks of three 1.4 to 1.6 times as fast as one.
 *
 * Promises. Analysis is done once per pattern. The first factorisation makes room for L and for all update matrices
 * that can be alive at once, whose places the analysis has fixed, and for tiles; later ones and solves allocate
 * nothing. Subtrees are factored at the same time where the host has threads; the bits are the same for any worker
 * count. Solves on one factor may run at the same time with different work arrays.
 * ===================================================================================================================== */

typedef struct yci_bsr {
    int n;
    int *dim, *off; /* n: rows of each node, 0 to YCI_BLOCK_MAX; n + 1: first unknown of each node */
    int *ptr, *col; /* n + 1 and ptr[n]: full symmetric pattern, ascending, the diagonal always present */
    int *diag;      /* n: the diagonal's block */
    size_t *at;     /* ptr[n] + 1: first value of each block, row-major; at[ptr[n]] is the number of values */
    double *val;
} yci_bsr;

static void yci_bsr_destroy(yci_context *c, yci_bsr *m) {
    yci_free(c, m->dim), yci_free(c, m->off), yci_free(c, m->ptr), yci_free(c, m->col);
    yci_free(c, m->diag), yci_free(c, m->at), yci_free(c, m->val);
    memset(m, 0, sizeof *m);
}

/* Sorts the pairs (both ways round, diagonal added) into rows: into buckets by row in any order, then once more with
 * rows and columns exchanged, which leaves every row ascending and its duplicates side by side. Returns 0 without
 * memory. */
static int yci_bsr_sort(yci_context *c, yci_bsr *m, const int (*pair)[2], size_t pair_count) {
    size_t total = 2 * pair_count + (size_t)m->n, k;
    int *begin = YCI_NEW(c, int, m->n + 1), *bucket = YCI_NEW(c, int, total);
    int *last = YCI_NEW(c, int, m->n), *sorted = YCI_NEW(c, int, total), i, p, ok = 0;
    if (begin && bucket && last && sorted) {
        for (i = 0; i < m->n; i++) begin[i] = 1;
        for (k = 0; k < pair_count; k++) begin[pair[k][0]]++, begin[pair[k][1]]++;
        for (i = 0, p = 0; i < m->n; i++) p += begin[i], begin[i] = last[i] = p; /* ends; filled from behind */
        for (k = 0; k < pair_count; k++) {
            bucket[--begin[pair[k][0]]] = pair[k][1];
            bucket[--begin[pair[k][1]]] = pair[k][0];
        }
        for (i = 0; i < m->n; i++) bucket[--begin[i]] = i;
        begin[m->n] = p;
        for (i = 0; i < m->n; i++) last[i] = begin[i];
        for (i = 0; i < m->n; i++)
            for (p = begin[i]; p < begin[i + 1]; p++) {
                int row = bucket[p];
                if (last[row] == begin[row] || sorted[last[row] - 1] != i) sorted[last[row]++] = i;
            }
        for (i = 0; i < m->n; i++) m->ptr[i + 1] = m->ptr[i] + last[i] - begin[i];
        m->col = YCI_NEW(c, int, m->ptr[m->n]);
        ok = m->col != NULL;
        for (i = 0; ok && i < m->n; i++)
            memcpy(m->col + m->ptr[i], sorted + begin[i], (size_t)(last[i] - begin[i]) * sizeof(int));
    }
    yci_free(c, begin), yci_free(c, bucket), yci_free(c, last), yci_free(c, sorted);
    return ok;
}

/* Makes a zero matrix whose pattern joins the two nodes of every pair; a pair may come more than once, either way
 * round, and may join a node with itself. On failure *out is empty. */
static yc_result yci_bsr_create(
    yci_context *c, int n, const int *dim, const int (*pair)[2], size_t pair_count, yci_bsr *out) {
    yci_bsr m;
    size_t k;
    int i, p;
    memset(out, 0, sizeof *out);
    memset(&m, 0, sizeof m);
    if (n < 0 || pair_count > ((size_t)INT_MAX - (size_t)n) / 2)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "block matrix: %d nodes and %.0f pairs", n, (double)pair_count);
    for (i = 0; i < n; i++)
        if (dim[i] < 0 || dim[i] > YCI_BLOCK_MAX || n > INT_MAX / YCI_BLOCK_MAX)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "block matrix: node %d of %d has %d unknowns", i, n, dim[i]);
    for (k = 0; k < pair_count; k++)
        if (pair[k][0] < 0 || pair[k][0] >= n || pair[k][1] < 0 || pair[k][1] >= n)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "block matrix: pair (%d, %d) of %d nodes", pair[k][0], pair[k][1], n);
    m.n = n;
    m.dim = YCI_NEW(c, int, n), m.off = YCI_NEW(c, int, n + 1), m.ptr = YCI_NEW(c, int, n + 1);
    m.diag = YCI_NEW(c, int, n);
    if (!m.dim || !m.off || !m.ptr || !m.diag || !yci_bsr_sort(c, &m, pair, pair_count)) goto out_of_memory;
    m.at = YCI_NEW(c, size_t, (size_t)m.ptr[n] + 1);
    if (!m.at) goto out_of_memory;
    for (i = 0; i < n; i++) m.dim[i] = dim[i], m.off[i + 1] = m.off[i] + dim[i];
    for (i = 0; i < n; i++)
        for (p = m.ptr[i]; p < m.ptr[i + 1]; p++) {
            if (m.col[p] == i) m.diag[i] = p;
            m.at[p + 1] = m.at[p] + (size_t)(dim[i] * dim[m.col[p]]);
        }
    m.val = YCI_NEW(c, double, m.at[m.ptr[n]] + YCI_BLOCK_MAX); /* kernels read beyond the end */
    if (!m.val) goto out_of_memory;
    *out = m;
    return YC_OK;
out_of_memory:
    yci_bsr_destroy(c, &m);
    return yci_out_of_memory(c, "a block matrix");
}

/* The block of row i and column j, or -1 where there is none. */
static int yci_bsr_find(const yci_bsr *m, int i, int j) {
    int low = m->ptr[i], high = m->ptr[i + 1] - 1;
    while (low <= high) {
        int middle = low + (high - low) / 2;
        if (m->col[middle] == j) return middle;
        if (m->col[middle] < j) low = middle + 1;
        else high = middle - 1;
    }
    return -1;
}

static void yci_bsr_zero(yci_bsr *m) { memset(m->val, 0, m->at[m->ptr[m->n]] * sizeof(double)); }

typedef struct {
    const yci_kernels *kernels;
    const yci_bsr *m;
    const double *x;
    double *y;
} yci_bsr_product;

static void yci_bsr_multiply_rows(void *arg, int begin, int end) {
    const yci_bsr_product *job = (const yci_bsr_product *)arg;
    const yci_bsr *m = job->m;
    int i;
    for (i = begin; i < end; i++)
        job->kernels->row(m->dim[i], m->ptr[i + 1] - m->ptr[i], m->col + m->ptr[i], m->dim, m->off,
            m->val + m->at[m->ptr[i]], job->x, job->y + m->off[i]);
}

/* y = A x; x and y are different arrays of off[n] numbers. */
static void yci_bsr_multiply(yci_context *c, const yci_bsr *m, const double *x, double *y) {
    yci_bsr_product job;
    job.kernels = yci_kernels_best(), job.m = m, job.x = x, job.y = y;
    yci_parallel(c, m->n, 512, yci_bsr_multiply_rows, &job);
}

/* ----------------------------------------------------------------------------------------------- minimum degree --- */

/* The quotient graph. A node is a variable until it is eliminated and an element from then on. A variable's list holds
 * its elements first and then its variables, in the room that its neighbours had at the start, which always suffices:
 * it gains one element (the pivot) only when it loses the pivot itself or an element that the pivot absorbed. An
 * element's list holds the variables of its front: where the pivot's own list was if that had no elements, otherwise
 * in a pool that is squeezed when full. Variables that became alike stand as one, with the sum of their weights. */
typedef struct yci_order_node {
    int begin, length; /* its list in `list` */
    int elements;      /* variable: how many its list starts with; element: the pivot that absorbed it */
    int weight;        /* variable: what it stands for, negative in the newest front; 0: merged or element */
    int degree;        /* variable: bound on its external degree; element: weight of its front */
    int outside;       /* element: its weight outside the newest front, over `base`; variable: a hash */
    int mark;          /* stamp of the comparison that met it last */
    int key;           /* variable: its bucket, at most its degree; -1: none yet; -2: left out; -3: no unknowns */
} yci_order_node;

/* What is touched less often: neighbours in a bucket (the first one's previous is the last); the ring of nodes numbered
 * together; the next with this hash, and in the end the number of the front. */
typedef struct yci_order_link {
    int next, previous, ring, chain;
} yci_order_link;

typedef struct yci_order_graph {
    int n;
    yci_order_node *node;
    yci_order_link *link;
    int *list, pool_begin, pool_used, pool_size; /* the variables' lists, then the pool */
    int *head, lowest, alive;                    /* n + 1 buckets by degree, the last for n and more; a low bound */
    int *table, table_mask;                      /* hash table over the newest front */
    int *name, *index, *stage;                   /* of a node: its number outside; the inverse; its stage, or NULL */
    double unit, flops;                          /* unknowns of a weight of 1; squared column counts */
    int window;                                  /* nodes that come into play at once */
    int stamp, base, widest; /* what `outside` was for earlier fronts is below `base`; widest: the heaviest front */
} yci_order_graph;

/* What elimination learns of the fronts that it forms, in the order of elimination: nodes eliminated, the weight left,
 * the front that takes it in (-1: none). Known are they if all weights are 1 and no node was left out. */
typedef struct yci_order_fronts {
    int known, count;
    int *size, *below, *parent;
    double flops; /* of the factorisation: squared column counts */
} yci_order_fronts;

static void yci_order_file(yci_order_graph *g, int v) {
    yci_order_link *link = g->link + v;
    int key = g->node[v].degree < g->n ? g->node[v].degree : g->n, first = g->head[key];
    link->next = -1, link->previous = v;
    if (first >= 0)
        link->previous = g->link[first].previous, g->link[link->previous].next = v, g->link[first].previous = v;
    else g->head[key] = v;
    g->node[v].key = key;
    if (key < g->lowest) g->lowest = key;
}

static void yci_order_unfile(yci_order_graph *g, int v) {
    const yci_order_link *link = g->link + v;
    int *head = &g->head[g->node[v].key];
    g->link[link->next >= 0 ? link->next : *head].previous = link->previous;
    if (*head != v) g->link[link->previous].next = link->next;
    else *head = link->next;
}

/* Takes out a variable of least degree; -1: there is none of degree `most` or less. Buckets are lazy: a variable moves
 * at once when its degree falls, but when it grew, or the variable is gone, that is seen only here. */
static int yci_order_next(yci_order_graph *g, int most) {
    for (;;) {
        int v;
        while (g->lowest <= most && g->head[g->lowest] < 0) g->lowest++;
        if (g->lowest > most) return -1;
        v = g->head[g->lowest];
        yci_order_unfile(g, v);
        if (!g->node[v].weight) continue;
        if (g->node[v].degree <= g->lowest || g->lowest == g->n) return v;
        yci_order_file(g, v);
    }
}

/* Variable v joins `into` and is numbered together with it: their rings become one. */
static void yci_order_merge(yci_order_graph *g, int v, int into) {
    int ring = g->link[v].ring;
    g->link[v].ring = g->link[into].ring, g->link[into].ring = ring;
    g->node[into].weight += g->node[v].weight, g->node[v].weight = 0;
}

/* Moves the fronts of live elements together. In the pool, each is led by its element and its length when new. */
static void yci_order_squeeze(yci_order_graph *g) {
    int from = g->pool_begin, to = from, i;
    while (from < g->pool_used) {
        int e = g->list[from], size = g->list[from + 1], begin = from + 2, kept = 0;
        from = begin + size;
        if (g->node[e].begin != begin || !g->node[e].degree) continue;
        for (i = begin; i < from; i++)
            if (g->node[g->list[i]].weight) g->list[to + 2 + kept++] = g->list[i];
        g->list[to] = e, g->list[to + 1] = kept, g->node[e].begin = to + 2, g->node[e].length = kept;
        to += 2 + kept;
    }
    g->pool_used = to;
}

/* Appends to a front the live variables of a list that it does not hold yet; returns their number. The two may be the
 * same array. */
static int yci_order_gather(yci_order_node *node, const int *from, int count, int *front, int *total) {
    int i, kept = 0, sum = 0;
    for (i = 0; i < count; i++) {
        int v = from[i], weight = node[v].weight, fresh = weight > 0;
        node[v].weight = fresh ? -weight : weight, sum += fresh ? weight : 0;
        front[kept] = v, kept += fresh;
    }
    *total += sum;
    return kept;
}

/* Turns variable p into an element: its front is the union of its variables and of its elements' fronts, which die.
 * From their weights p itself is taken off, so that 0 remains outside the new front. */
static void yci_order_eliminate(yci_order_graph *g, int p) {
    yci_order_node *pivot = g->node + p;
    int *list = g->list + pivot->begin, count = 0, total = 0, k, weight = pivot->weight;
    pivot->weight = 0;
    if (!pivot->elements) count = yci_order_gather(g->node, list, pivot->length, list, &total);
    else {
        int need = pivot->length + 2;
        for (k = 0; k < pivot->elements; k++) need += g->node[list[k]].length;
        if (need > g->n + 2) need = g->n + 2;
        if (g->pool_used + need > g->pool_size) yci_order_squeeze(g);
        pivot->begin = g->pool_used + 2;
        for (k = 0; k < pivot->elements; k++) {
            yci_order_node *e = g->node + list[k];
            count += yci_order_gather(g->node, g->list + e->begin, e->length, g->list + pivot->begin + count, &total);
            e->degree -= weight, e->elements = p;
        }
        count += yci_order_gather(g->node, list + k, pivot->length - k, g->list + pivot->begin + count, &total);
        g->list[pivot->begin - 2] = p;
    }
    pivot->length = count, pivot->degree = total;
}

/* Rewrites v's list: elements inside the new front, which the pivot absorbs, and variables that the front covers go, p
 * comes. Returns the bound on v's degree outside the front, and leaves a hash of the list. */
static int yci_order_rewrite(const yci_order_graph *g, yci_order_node *v, int p) {
    yci_order_node *node = g->node;
    int *list = g->list + v->begin, base = g->base, all = v->elements, kept = 0, elements, degree = 0, i;
    unsigned sum = (unsigned)p;
    for (i = 0; i < all; i++) {
        int e = list[i], outside = node[e].outside - base, keep = outside > 0;
        list[kept] = e, kept += keep, degree += outside, sum += (unsigned)(e & -keep);
        node[e].degree &= -keep, node[e].elements = keep ? node[e].elements : p;
    }
    elements = kept;
    for (all = v->length; i < all; i++) {
        int u = list[i], weight = node[u].weight, keep = weight > 0;
        list[kept] = u, kept += keep, degree += weight & -keep, sum += (unsigned)(u & -keep);
    }
    list[kept] = list[elements], list[elements] = p; /* the first variable makes room */
    v->elements = elements + 1, v->length = kept + 1, v->outside = (int)(sum & INT_MAX);
    return degree;
}

/* Whether two variables have the same list, if every entry of i's bears the stamp. */
static int yci_order_alike(const yci_order_graph *g, int i, int j) {
    const yci_order_node *a = g->node + i, *b = g->node + j;
    const int *list = g->list + b->begin;
    int k = 0;
    if (a->length != b->length || a->elements != b->elements || (g->stage && g->stage[i] != g->stage[j])) return 0;
    while (k < b->length && g->node[list[k]].mark == g->stamp) k++;
    return k == b->length;
}

/* Merges the variables of the front whose lists are equal; the hash table has brought candidates together. */
static void yci_order_find_alike(yci_order_graph *g, const int *front, int count) {
    int k, i, j, s;
    for (k = 0; k < count; k++) {
        int *first = g->table + (g->node[front[k]].outside & g->table_mask);
        for (i = *first, *first = -1; i >= 0; i = g->link[i].chain) {
            const yci_order_node *v = g->node + i;
            int *before = &g->link[i].chain, stamped = 0;
            while ((j = *before) >= 0) {
                if (g->node[j].outside == v->outside && !stamped++)
                    for (s = 0, g->stamp++; s < v->length; s++) g->node[g->list[v->begin + s]].mark = g->stamp;
                if (g->node[j].outside == v->outside && yci_order_alike(g, i, j))
                    yci_order_merge(g, j, i), *before = g->link[j].chain;
                else before = &g->link[j].chain;
            }
        }
    }
}

/* What is left of the front after a step: positive weights, and new degrees. */
static void yci_order_finish(yci_order_graph *g, int p) {
    yci_order_node *pivot = g->node + p;
    int *front = g->list + pivot->begin, count = 0, k;
    g->base += g->widest + 1, pivot->outside = 0, pivot->elements = -1;
    for (k = 0; k < pivot->length; k++) {
        yci_order_node *v = g->node + front[k];
        int most;
        if (!v->weight) continue;
        v->weight = -v->weight, v->degree += pivot->degree - v->weight, most = g->alive - v->weight;
        if (v->degree > most) v->degree = most;
        if (v->degree < v->key) yci_order_unfile(g, front[k]), yci_order_file(g, front[k]);
        front[count++] = front[k];
    }
    pivot->length = count;
    if (pivot->begin >= g->pool_begin) front[-1] = count, g->pool_used = pivot->begin + count;
}

/* Eliminates p, together with what has no neighbour outside its front, and updates the front's variables. Returns the
 * weight left in the front. */
static int yci_order_step(yci_order_graph *g, int p) {
    yci_order_node *pivot = g->node + p;
    int weight = pivot->weight, direct = !pivot->elements, before = g->alive, base, k, i;
    double below, height;
    const int *front;
    if (g->base > INT_MAX / 2) /* weights are far below that: see yci_order_minimum_degree */
        for (k = 0, g->base = 1; k < g->n; k++) g->node[k].outside = 0;
    base = g->base;
    yci_order_eliminate(g, p);
    front = g->list + pivot->begin;
    g->alive -= weight;
    if (pivot->degree > g->widest) g->widest = pivot->degree;
    if (direct && pivot->length == 1) { /* a leaf goes without leaving an element: stars stay linear */
        yci_order_node *v = g->node + front[0];
        v->weight = -v->weight, v->degree -= weight, pivot->degree = 0, pivot->elements = front[0];
        if (v->degree < v->key) yci_order_unfile(g, front[0]), yci_order_file(g, front[0]);
        g->flops += (double)weight * v->weight * (v->weight + weight);
        return v->weight;
    }
    for (k = 0; k < pivot->length; k++) {
        const yci_order_node *v = g->node + front[k];
        const int *list = g->list + v->begin;
        for (i = 0; i < v->elements; i++) {
            yci_order_node *e = g->node + list[i];
            int whole = e->degree + base;
            e->outside = (e->outside < base ? whole : e->outside) + v->weight;
        }
    }
    for (k = 0; k < pivot->length; k++) {
        yci_order_node *v = g->node + front[k];
        int degree = yci_order_rewrite(g, v, p), *first = g->table + (v->outside & g->table_mask);
        if (degree == 0 && (!g->stage || g->stage[front[k]] == g->stage[p])) {
            g->alive += v->weight, pivot->degree += v->weight;
            yci_order_merge(g, front[k], p);
            continue;
        }
        if (degree < v->degree) v->degree = degree;
        g->link[front[k]].chain = *first, *first = front[k];
    }
    pivot->weight = 0;
    yci_order_find_alike(g, front, pivot->length);
    yci_order_finish(g, p);
    below = pivot->degree, height = below + before - g->alive;
    g->flops += (height * height * height - below * below * below) / 3.0;
    return pivot->degree;
}

/* Numbers the nodes by their stages: `name` becomes the node of a number. */
static void yci_order_sort(int n, const int *stage, int *index, int *name, int *begin) {
    int i, at = 0;
    for (i = 0; i < n; i++) begin[i] = 0;
    for (i = 0; i < n; i++) begin[stage[i]]++;
    for (i = 0; i < n; i++) at += begin[i], begin[i] = at - begin[i];
    for (i = 0; i < n; i++) name[index[i] = begin[stage[i]]++] = i;
}

/* A node with more neighbours is left out: every step would touch it. */
static int yci_order_limit(int n) { return (int)(10.0 * sqrt((double)n)) + 16; }

/* Nodes come into play by windows. What has a degree of at most YCI_ORDER_DEGREE is eliminated before the next window
 * comes; twice that after YCI_ORDER_WIDEN windows, four times after the square of that, and so on. */
#define YCI_ORDER_FAR 30000   /* nodes of a graph that may be renumbered */
#define YCI_ORDER_WINDOW 4000 /* nodes, whose part of the graph fits the second cache */
#define YCI_ORDER_DEGREE 16
#define YCI_ORDER_WIDEN 8

/* Numbers the nodes so that neighbours are near each other in memory: in patches of a window's size, grown breadth
 * first, each from beside the first node that still has a neighbour without a number. `name` becomes the node of a
 * number. */
static int yci_order_patches(int n, const int *ptr, const int *col, int *index, int *name) {
    int seed, from = 0, i, j, k, count = 0, full;
    for (seed = 0; seed < n; seed++) {
        if (index[seed] == -1) index[seed] = count, name[count++] = seed;
        for (; from < count; from++)
            for (k = ptr[name[from]]; k < ptr[name[from] + 1]; k++) {
                if (index[col[k]] != -1) continue;
                i = count, full = count + YCI_ORDER_WINDOW, index[col[k]] = count, name[count++] = col[k];
                for (; i < count && count < full; i++) {
                    if (i + 8 < count) YCI_PREFETCH(col + ptr[name[i + 8]]);
                    for (j = ptr[name[i]]; j < ptr[name[i] + 1]; j++)
                        if (index[col[j]] == -1) index[col[j]] = count, name[count++] = col[j];
                }
            }
    }
    return count;
}

/* Whether neighbours are so far from each other in memory that it pays to renumber a graph that fits no cache. */
static int yci_order_far(int n, const int *ptr, const int *col) {
    double sum = 0.0;
    int i, count = 0;
    for (i = 0; n >= YCI_ORDER_FAR && i < n; i += 16, count++) sum += abs(col[ptr[i + 1] - 1] - i);
    return sum > 0.125 * n * count;
}

/* The graph at the start. Nodes with very many neighbours would be touched by every step: they are left out (weight 0)
 * and come last in their stage, after them nodes without unknowns. Weights are unknowns over their common divisor.
 * Returns whether all are 1 and only nodes without unknowns left out. */
static int yci_order_fill(yci_order_graph *g, const int *dim, const int *ptr, const int *col) {
    int limit = yci_order_limit(g->n), divisor = 0, plain = 1, used = 0, i, k;
    for (i = 0; i < g->n; i++) {
        int a = dim[i], b = divisor;
        while (b && a != b) k = a % b, a = b, b = k;
        divisor = a;
    }
    g->unit = divisor;
    for (i = 0; i < g->n; i++) {
        int v = g->name ? g->name[i] : i;
        g->node[i].weight = ptr[v + 1] - ptr[v] > limit || !dim[v] ? 0 : dim[v] / divisor;
        g->node[i].key = g->node[i].weight ? -1 : dim[v] ? -2 : -3;
        g->alive += g->node[i].weight, plain &= g->node[i].weight == 1 || !dim[v];
    }
    for (i = 0; i < g->n; i++) {
        yci_order_node *v = g->node + i;
        int *list = g->list + used, kept = 0, degree = -v->weight, at = g->name ? g->name[i] : i;
        if (g->name && i + 8 < g->n) YCI_PREFETCH(col + ptr[g->name[i + 8]]);
        for (k = ptr[at]; k < ptr[at + 1]; k++) {
            int j = g->name ? g->index[col[k]] : col[k], weight = g->node[j].weight;
            if (weight && j != i) list[kept++] = j;
            degree += weight;
        }
        v->begin = used, used += ptr[at + 1] - ptr[at];
        v->elements = 0, v->length = kept, v->degree = degree, v->outside = v->mark = 0;
        g->link[i].ring = i;
    }
    for (i = 0; i <= g->n; i++) g->head[i] = -1;
    for (i = 0; i <= g->table_mask; i++) g->table[i] = -1;
    return plain;
}

/* Files the variables of window number `count`, from v on; returns the one behind, and in `limit` up to which degree
 * there is to be eliminated now: the more windows are complete, the more. */
static int yci_order_open(yci_order_graph *g, int v, int count, int *limit) {
    int i;
    for (i = 0; i < g->window && v >= 0; i++) {
        int next = g->link[v].next;
        if (g->node[v].weight) yci_order_file(g, v); /* others have become part of one */
        v = next;
    }
    for (*limit = YCI_ORDER_DEGREE; count % YCI_ORDER_WIDEN == 0; count /= YCI_ORDER_WIDEN) *limit *= 2;
    if (v < 0 || *limit > g->n) *limit = g->n;
    return v;
}

/* Orders one stage, the nodes order[begin, end), in place. Those of a window are near each other, so most steps find
 * what they touch in the cache: two to three times as fast on 100,000 nodes, at the same fill. Who waits is chained by
 * `next`. */
static void yci_order_stage(yci_order_graph *g, int *order, int begin, int end, yci_order_fronts *fronts) {
    int k, i, pass, p, waiting = -1, windows = 0, limit = -1;
    for (pass = 0; pass < 2; pass++) /* those left out to the end */
        for (k = end - 1, i = end; k >= begin; k--) {
            int v = order[k], last = g->node[v].key < (pass ? -1 : -2);
            if (last) order[k] = order[--i], order[i] = v;
        }
    end = i;
    for (k = end - 1; k >= begin; k--) g->link[order[k]].next = waiting, waiting = order[k];
    for (k = begin; k < end;) {
        int s = fronts->count;
        while ((p = yci_order_next(g, limit)) < 0) waiting = yci_order_open(g, waiting, ++windows, &limit);
        fronts->count++, fronts->below[s] = yci_order_step(g, p), fronts->parent[s] = p, fronts->size[s] = k, i = p;
        do order[k++] = i, g->link[i].chain = s, i = g->link[i].ring;
        while (i != p);
        fronts->size[s] = k - fronts->size[s];
    }
}

/* How many numbers any ordering works in; 0: the graph is too large. A dissection needs most; minimum degree then works
 * in the same place, as does what follows the ordering: fresh memory is slow. */
static size_t yci_order_room(int n, const int *ptr) {
    size_t size = (size_t)n, entries = (size_t)ptr[n];
    if (entries > (size_t)INT_MAX / 8 || size > (size_t)INT_MAX / (4 * YCI_BLOCK_MAX)) return 0;
    return 21 * size + 4 * entries + 66;
}

/* Fills `order` with all n nodes, and the arrays of `fronts` (n each). With `stage` (numbers from 0 to n - 1; it may be
 * `order` itself), every node of a stage comes before those of higher ones. Works on a copy that is sorted by stages
 * or, if neighbours are far from each other, numbered by patches: most steps then stay within the cache. */
static void yci_order_minimum_degree(int n, const int *dim, const int *ptr, const int *col, const int *stage,
    int *order, yci_order_fronts *fronts, int *room) {
    yci_order_graph g;
    int begin, end, s, far = !stage && yci_order_far(n, ptr, col);
    memset(&g, 0, sizeof g);
    while (g.table_mask < n / 4) g.table_mask = 2 * g.table_mask + 1;
    g.window = far ? YCI_ORDER_WINDOW : n;
    g.pool_begin = g.pool_used = ptr[n], g.pool_size = 5 * (ptr[n] / 2) + 3 * n + 8;
    g.base = 1, g.n = g.lowest = n;
    g.node = (yci_order_node *)room, g.link = (yci_order_link *)(g.node + n), g.list = (int *)(g.link + n);
    g.head = g.list + g.pool_size, g.table = g.head + n + 1;
    if (far || stage) g.name = g.table + g.table_mask + 1, g.index = g.name + n;
    if (far) {
        for (s = 0; s < n; s++) g.index[s] = -1;
        yci_order_patches(n, ptr, col, g.index, g.name);
    }
    if (stage) {
        yci_order_sort(n, stage, g.index, g.name, g.head), g.stage = g.index + n;
        for (s = 0; s < n; s++) g.stage[s] = stage[g.name[s]];
    }
    for (s = 0; s < n; s++) order[s] = s;
    fronts->known = yci_order_fill(&g, dim, ptr, col), fronts->count = 0;
    for (begin = 0; begin < n; begin = end) {
        for (end = g.stage ? begin + 1 : n; end < n && g.stage[end] == g.stage[begin];) end++;
        yci_order_stage(&g, order, begin, end, fronts);
    }
    for (s = 0; g.name && s < n; s++) order[s] = g.name[order[s]];
    fronts->flops = g.flops * g.unit * g.unit * g.unit;
    for (s = 0; s < fronts->count; s++) {
        int taken = g.node[fronts->parent[s]].elements;
        fronts->parent[s] = taken < 0 ? -1 : g.link[taken].chain;
    }
}

/* -------------------------------------------------------------------------------------------- nested dissection --- */

/* Multilevel vertex separators (Karypis and Kumar, A fast and high quality multilevel scheme for partitioning irregular
 * graphs, SIAM J. Sci. Comput. 20, 1998; the improvement is of the kind of Fiduccia and Mattheyses, 1982). Stars of a
 * few vertices become vertices of a coarser graph, the coarsest is cut by breadth-first growth, and on the way back the
 * separator is improved on every level: vertices leave it to one side, what they touch on the other comes in, and the
 * best moment is kept. Sides are cut again until they are small. Most of this is done on the graph of the first stars
 * alone; the whole graph then follows its cuts and improves them. Minimum degree at last orders the whole graph with
 * pieces and separators as its stages, so that every boundary counts (as in CHOLMOD's NESDIS). */
#define YCI_DISSECT_LEAF 1000    /* vertices of a graph that is not cut */
#define YCI_DISSECT_COARSEST 120 /* of one that is not coarsened */
#define YCI_DISSECT_STAR 3       /* of a star; twice as many in the finest graph */
#define YCI_DISSECT_TRIES 4      /* cuts of the coarsest graph */
#define YCI_DISSECT_SWEEPS 20    /* of a level, at most */
#define YCI_DISSECT_BALANCE 0.55 /* the most of the weight that one side may have */
#define YCI_DISSECT_PATIENCE 10  /* moves without gain in a sweep, beyond the size of the separator */

typedef struct yci_dissect_graph {
    int n, total;          /* vertices, their weight */
    int *ptr, *col, *tied; /* neighbours without the vertex itself; how many edges each stands for (NULL: one) */
    int *weight, *side;    /* side: 0, 1, 2 in the separator, or 3 outside the part that is cut */
    int *map, *id;         /* the vertex of the coarser graph; the node of the graph that is dissected */
} yci_dissect_graph;

typedef struct yci_dissect {
    int *arena, used, size;               /* graphs, as a stack */
    int *heap, *place, *gain, heap_count; /* vertices of the separator, greatest gain first; place -1: not there */
    int *rim, rim_count;                  /* all that have been in the separator during a sweep */
    int *moved, *rim_before;              /* what a sweep has moved, and how much rim there was before */
    int *table, *best;                    /* work */
    int weight[3];                        /* of both sides and of the separator */
    int *stage, stages;                   /* per node; how many so far: those of a piece, with its separator last */
    int *fork;                            /* of a stage: the first one of the second side, -1: it was not cut */
    int *guide;                           /* per vertex: its stage in the graph of stars */
} yci_dissect;

static int *yci_dissect_take(yci_dissect *d, int count) {
    int *block = d->arena + d->used;
    d->used += count;
    return block;
}

/* Room for a graph; 0 if there is none, or not for the graphs to come. */
static int yci_dissect_open(yci_dissect *d, yci_dissect_graph *g, int n, int entries, int tied) {
    if (entries > (d->size - d->used - 5 * n - 1) / (1 + tied)) return 0;
    g->n = n, g->total = 0;
    g->ptr = yci_dissect_take(d, n + 1), g->weight = yci_dissect_take(d, n), g->side = yci_dissect_take(d, n);
    g->map = yci_dissect_take(d, n), g->tied = tied ? yci_dissect_take(d, entries) : NULL;
    g->id = yci_dissect_take(d, n);
    g->col = yci_dissect_take(d, entries), g->ptr[0] = 0;
    return 1;
}

/* Gathers stars: every free vertex with its free neighbours across the heaviest edges, the lightest of them first.
 * Leaves their members in `table` and numbers the stars. */
static int yci_dissect_gather(yci_dissect *d, yci_dissect_graph *g) {
    int star = g->tied ? YCI_DISSECT_STAR : 2 * YCI_DISSECT_STAR, i, k, more, used = 0, count = 0, *begin = d->moved;
    int most = 3 * (g->total / YCI_DISSECT_COARSEST) + 1;
    for (i = 0; i < g->n; i++) g->map[i] = -1;
    for (i = 0; i < g->n; i++) {
        int weight = g->weight[i];
        if (g->map[i] >= 0) continue;
        g->map[i] = count, begin[count] = used, d->table[used++] = i;
        for (k = g->ptr[i]; !g->tied && k < g->ptr[i + 1] && used - begin[count] < star; k++) {
            int j = g->col[k]; /* all edges are alike */
            if (g->map[j] < 0 && weight + g->weight[j] <= most)
                g->map[j] = count, d->table[used++] = j, weight += g->weight[j];
        }
        for (more = 1; g->tied && more < star; more++) {
            int best = -1, heaviest = 0;
            for (k = g->ptr[i]; k < g->ptr[i + 1]; k++) {
                int j = g->col[k], rank = g->tied[k];
                if (g->map[j] >= 0 || rank < heaviest || weight + g->weight[j] > most) continue;
                if (rank == heaviest && g->weight[j] >= g->weight[best]) continue;
                best = j, heaviest = rank;
            }
            if (best < 0) break;
            g->map[best] = count, d->table[used++] = best, weight += g->weight[best];
        }
        count++;
    }
    begin[count] = used;
    return count;
}

/* The graph of the stars. An edge met again is found by its slot; the first slot of a vertex stands for the edges
 * inside and is filled by the last one in the end. Returns 0 if it is not worth it. */
static int yci_dissect_coarsen(yci_dissect *d, yci_dissect_graph *g, yci_dissect_graph *coarse) {
    int count = yci_dissect_gather(d, g), i, k, m, used = 0, *slot = d->best;
    if (count > g->n - g->n / 8 || !yci_dissect_open(d, coarse, count, g->ptr[g->n] + count, 1)) return 0;
    coarse->total = g->total;
    for (i = 0; i < count; i++) slot[i] = -1;
    for (i = 0; i < count; i++) {
        int begin = used;
        slot[i] = used++, coarse->col[begin] = i, coarse->tied[begin] = 0, coarse->weight[i] = 0;
        for (m = d->moved[i]; m < d->moved[i + 1]; m++) {
            int v = d->table[m];
            coarse->weight[i] += g->weight[v];
            for (k = g->ptr[v]; k < g->ptr[v + 1]; k++) {
                int j = g->map[g->col[k]], at = slot[j], fresh = at < begin;
                at = fresh ? used : at, used += fresh;
                slot[j] = at, coarse->col[at] = j;
                coarse->tied[at] = (coarse->tied[at] & (fresh - 1)) + (g->tied ? g->tied[k] : 1);
            }
        }
        used--, coarse->col[begin] = coarse->col[used], coarse->tied[begin] = coarse->tied[used];
        slot[coarse->col[begin]] = -1;
        coarse->ptr[i + 1] = used;
    }
    d->used -= g->ptr[g->n] + count - used; /* `col` was taken last */
    return 1;
}

/* The heap of the separator: v rises from a place, the best one comes out. */
static void yci_dissect_raise(yci_dissect *d, int v, int at) {
    for (; at > 0 && d->gain[d->heap[(at - 1) / 2]] < d->gain[v]; at = (at - 1) / 2)
        d->heap[at] = d->heap[(at - 1) / 2], d->place[d->heap[at]] = at;
    d->heap[at] = v, d->place[v] = at;
}

static int yci_dissect_pop(yci_dissect *d) {
    int first = d->heap[0], v = d->heap[--d->heap_count], at = 0, child;
    for (child = 1; child < d->heap_count; at = child, child = 2 * at + 1) {
        if (child + 1 < d->heap_count && d->gain[d->heap[child + 1]] > d->gain[d->heap[child]]) child++;
        if (d->gain[d->heap[child]] <= d->gain[v]) break;
        d->heap[at] = d->heap[child], d->place[d->heap[at]] = at;
    }
    d->heap[at] = v, d->place[v] = at, d->place[first] = -1;
    return first;
}

/* Vertex v of the separator waits to be moved away from side `other`: what it gains is its own weight, less that of its
 * neighbours there, which would follow it into the separator. */
static void yci_dissect_push(yci_dissect *d, const yci_dissect_graph *g, int v, int other) {
    int k, gain = g->weight[v];
    for (k = g->ptr[v]; k < g->ptr[v + 1]; k++) gain -= g->weight[g->col[k]] & -(g->side[g->col[k]] == other);
    d->gain[v] = gain;
    yci_dissect_raise(d, v, d->heap_count++);
}

/* Vertex u comes from side `other` into the separator and waits; its neighbours there gain by that. */
static void yci_dissect_pull(yci_dissect *d, yci_dissect_graph *g, int u, int other) {
    int k, w = g->weight[u], gain = w;
    g->side[u] = 2, d->rim[d->rim_count++] = u;
    d->weight[other] -= w, d->weight[2] += w;
    for (k = g->ptr[u]; k < g->ptr[u + 1]; k++) {
        int x = g->col[k];
        gain -= g->weight[x] & -(g->side[x] == other);
        if (d->place[x] >= 0) d->gain[x] += w, yci_dissect_raise(d, x, d->place[x]);
    }
    d->gain[u] = gain, yci_dissect_raise(d, u, d->heap_count++);
}

/* Moves vertices of the separator to side `to`, best first, and goes back to the best moment. Returns whether the
 * separator has become lighter. */
static int yci_dissect_sweep(yci_dissect *d, yci_dissect_graph *g, int to) {
    int other = 1 - to, total = d->weight[0] + d->weight[1] + d->weight[2], moves = 0, best = 0, k, kept = 0;
    int patience = YCI_DISSECT_PATIENCE + d->rim_count, least = d->weight[2], before = least,
        most = (int)(YCI_DISSECT_BALANCE * total) + 1, apart = abs(d->weight[0] - d->weight[1]);
    for (k = 0, d->heap_count = 0; k < d->rim_count; k++) yci_dissect_push(d, g, d->rim[k], other);
    while (d->heap_count && moves - best < patience) {
        int v = yci_dissect_pop(d), w = g->weight[v], now;
        if (d->weight[to] + w > most) continue;
        d->moved[moves] = v, d->rim_before[moves++] = d->rim_count;
        g->side[v] = to, d->weight[to] += w, d->weight[2] -= w;
        for (k = g->ptr[v]; k < g->ptr[v + 1]; k++)
            if (g->side[g->col[k]] == other) yci_dissect_pull(d, g, g->col[k], other);
        now = abs(d->weight[0] - d->weight[1]);
        if (d->weight[2] < least || (d->weight[2] == least && now < apart))
            least = d->weight[2], apart = now, best = moves;
    }
    while (d->heap_count) d->place[d->heap[--d->heap_count]] = -1;
    while (moves > best) {
        int v = d->moved[--moves];
        g->side[v] = 2, d->weight[to] -= g->weight[v], d->weight[2] += g->weight[v];
        while (d->rim_count > d->rim_before[moves]) {
            int u = d->rim[--d->rim_count];
            g->side[u] = other, d->weight[other] += g->weight[u], d->weight[2] -= g->weight[u];
        }
    }
    for (k = 0; k < d->rim_count; k++)
        if (g->side[d->rim[k]] == 2) d->rim[kept++] = d->rim[k];
    d->rim_count = kept;
    return least < before;
}

/* Collects the separator and weighs the parts. */
static void yci_dissect_collect(yci_dissect *d, const yci_dissect_graph *g) {
    int i;
    d->rim_count = 0, d->weight[0] = d->weight[1] = d->weight[2] = 0;
    for (i = 0; i < g->n; i++) {
        d->weight[g->side[i]] += g->weight[i];
        d->rim[d->rim_count] = i, d->rim_count += g->side[i] == 2;
    }
}

/* What touches one side only leaves the separator for that side at once: a separator that comes from a coarser graph is
 * several vertices thick. */
static void yci_dissect_thin(yci_dissect *d, yci_dissect_graph *g) {
    int i, k, seen = d->rim_count;
    d->rim_count = 0;
    for (i = 0; i < seen; i++) {
        int v = d->rim[i], to, touched = 0;
        for (k = g->ptr[v]; k < g->ptr[v + 1]; k++) touched |= 1 << g->side[g->col[k]];
        to = (touched & 3) ? (touched & 3) / 2 : d->weight[0] > d->weight[1];
        if ((touched & 3) == 3) d->rim[d->rim_count++] = v;
        else g->side[v] = to, d->weight[to] += g->weight[v], d->weight[2] -= g->weight[v];
    }
}

/* Sweeps to the lighter side first and then in turns, until neither way gains, which is after 3 or 4 as a rule. */
static void yci_dissect_refine(yci_dissect *d, yci_dissect_graph *g) {
    int to, idle = 0, sweep = 0;
    yci_dissect_thin(d, g);
    for (to = d->weight[0] > d->weight[1]; idle < 2 && sweep++ < YCI_DISSECT_SWEEPS; to = 1 - to)
        idle = yci_dissect_sweep(d, g, to) ? 0 : idle + 1;
}

/* Grows side 0 from a vertex, breadth first, to half of the weight; those waiting then are the separator. */
static void yci_dissect_grow(yci_dissect *d, yci_dissect_graph *g, int seed) {
    int *queue = d->rim, head = 0, tail = 0, grown = 0, i, k;
    for (i = 0; i < g->n; i++) g->side[i] = 1;
    for (i = seed; grown < g->total / 2; i = (i + 1) % g->n) { /* on from the next piece when one is used up */
        if (g->side[i] == 1) g->side[i] = 2, queue[tail++] = i;
        while (head < tail && grown < g->total / 2) {
            int v = queue[head++];
            g->side[v] = 0, grown += g->weight[v];
            for (k = g->ptr[v]; k < g->ptr[v + 1]; k++)
                if (g->side[g->col[k]] == 1) g->side[g->col[k]] = 2, queue[tail++] = g->col[k];
        }
    }
}

/* Leaves the separator in g->side and the weights of the parts in d->weight. */
static void yci_dissect_cut(yci_dissect *d, yci_dissect_graph *g) {
    yci_dissect_graph coarse;
    int used = d->used, i, trial, best = INT_MAX;
    if (g->n > YCI_DISSECT_COARSEST && yci_dissect_coarsen(d, g, &coarse)) {
        yci_dissect_cut(d, &coarse);
        for (i = 0; i < g->n; i++) g->side[i] = coarse.side[g->map[i]];
        d->used = used;
    } else {
        for (trial = 0; trial < YCI_DISSECT_TRIES; trial++) {
            yci_dissect_grow(d, g, (int)((double)g->n * trial / YCI_DISSECT_TRIES));
            yci_dissect_collect(d, g), yci_dissect_refine(d, g);
            if (d->weight[2] < best) {
                best = d->weight[2];
                for (i = 0; i < g->n; i++) d->best[i] = g->side[i];
            }
        }
        for (i = 0; i < g->n; i++) g->side[i] = d->best[i];
    }
    yci_dissect_collect(d, g), yci_dissect_refine(d, g);
}

/* The part of g on one side. */
static int yci_dissect_extract(yci_dissect *d, const yci_dissect_graph *g, int side, yci_dissect_graph *part) {
    int *index = d->best, count = 0, entries = 0, i, k, used = 0;
    for (i = 0; i < g->n; i++)
        if (g->side[i] == side) index[i] = count++, entries += g->ptr[i + 1] - g->ptr[i];
    if (!yci_dissect_open(d, part, count, entries, g->tied != NULL)) return 0;
    for (i = 0, count = 0; i < g->n; i++) {
        if (g->side[i] != side) continue;
        part->id[count] = g->id[i], part->total += part->weight[count] = g->weight[i];
        for (k = g->ptr[i]; k < g->ptr[i + 1]; k++) {
            int j = g->col[k];
            if (g->tied) part->tied[used] = g->tied[k];
            part->col[used] = index[j], used += g->side[j] == side;
        }
        part->ptr[++count] = used;
    }
    d->used -= entries - used;
    return 1;
}

/* Gives the vertices of g their stages: both sides and then the separator, or all the same one. */
static void yci_dissect_split(yci_dissect *d, yci_dissect_graph *g) {
    yci_dissect_graph part;
    int used = d->used, side, i, fork = 0,
        cut = g->n > (g->tied ? YCI_DISSECT_LEAF / (2 * YCI_DISSECT_STAR) : YCI_DISSECT_LEAF);
    if (cut) {
        yci_dissect_cut(d, g);
        cut = d->weight[0] && d->weight[1] && d->weight[2] < g->total / 3;
    }
    for (side = 0; side < 2 && cut; side++) {
        fork = d->stages;
        if (yci_dissect_extract(d, g, side, &part)) yci_dissect_split(d, &part);
        else cut = 0;
        d->used = used;
    }
    for (i = 0; i < g->n; i++)
        if (!cut || g->side[i] == 2) d->stage[g->id[i]] = d->stages;
    d->fork[d->stages++] = cut ? fork : -1;
}

/* Cuts the vertices in `list` as the graph of stars was cut below stage s, but along improved separators; all others of
 * g are outside. What an improvement further up has moved here from a separator begins in the separator. */
static void yci_dissect_follow(yci_dissect *d, yci_dissect_graph *g, int *list, int count, int s) {
    int i, fork = d->fork[s], first = 0, second = 0, *apart = d->best;
    d->rim_count = 0, d->weight[0] = d->weight[1] = d->weight[2] = 0;
    for (i = 0; i < count; i++) d->stage[g->id[list[i]]] = s;
    for (i = 0; fork >= 0 && i < count; i++) {
        int v = list[i], guide = d->guide[v], side = guide < fork ? 0 : guide < s ? 1 : 2;
        g->side[v] = side, d->weight[side] += g->weight[v];
        d->rim[d->rim_count] = v, d->rim_count += side == 2;
    }
    if (fork < 0) return;
    yci_dissect_refine(d, g);
    for (i = 0; i < count; i++) {
        int v = list[i], side = g->side[v];
        list[first] = v, first += side == 0, apart[second] = v, second += side == 1, g->side[v] = 3;
    }
    memcpy(list + first, apart, (size_t)second * sizeof *list);
    yci_dissect_follow(d, g, list, first, fork - 1);
    yci_dissect_follow(d, g, list + first, second, s - 1);
}

/* By way of the graph of stars, if there is one. */
static void yci_dissect_guided(yci_dissect *d, yci_dissect_graph *g) {
    yci_dissect_graph coarse;
    int *stage = d->stage, *list = g->map, i;
    if (g->n <= YCI_DISSECT_LEAF || !yci_dissect_coarsen(d, g, &coarse)) {
        yci_dissect_split(d, g);
        return;
    }
    for (i = 0; i < coarse.n; i++) coarse.id[i] = i;
    d->stage = yci_dissect_take(d, coarse.n);
    yci_dissect_split(d, &coarse);
    for (i = 0; i < g->n; i++) d->guide[i] = d->stage[g->map[i]], list[i] = i;
    d->stage = stage, yci_dissect_follow(d, g, list, g->n, d->stages - 1);
}

/* The whole graph, without nodes that have no unknowns or very many neighbours; those make the last stage. */
static void yci_dissect_nodes(yci_dissect *d, int n, const int *dim, const int *ptr, const int *col) {
    yci_dissect_graph g;
    int i, k, count, used = 0, *index = d->best, *queue = d->rim, limit = yci_order_limit(n);
    for (i = 0; i < n; i++) index[i] = dim[i] && ptr[i + 1] - ptr[i] <= limit ? -1 : -2;
    count = yci_order_patches(n, ptr, col, index, queue);
    yci_dissect_open(d, &g, count, ptr[n] - n, 0);
    for (i = 0; i < count; i++) {
        int v = g.id[i] = queue[i];
        g.total += g.weight[i] = dim[v];
        for (k = ptr[v]; k < ptr[v + 1]; k++)
            if (col[k] != v && index[col[k]] >= 0) g.col[used++] = index[col[k]];
        g.ptr[i + 1] = used;
    }
    for (i = 0; i < n; i++) d->stage[i] = -1;
    if (count) yci_dissect_guided(d, &g);
    for (i = 0; i < n; i++)
        if (d->stage[i] < 0) d->stage[i] = d->stages;
}

/* As yci_order_minimum_degree, by nested dissection, whose stages stand in `order` meanwhile. */
static void yci_order_dissect(
    int n, const int *dim, const int *ptr, const int *col, int *order, yci_order_fronts *fronts, int *room) {
    yci_dissect d;
    int *at = room;
    memset(&d, 0, sizeof d);
    d.size = 11 * n + 4 * ptr[n] + 64, d.stage = order;
    d.heap = at, d.place = at += n, d.gain = at += n, d.rim = at += n, d.rim_before = at += n;
    d.table = at += n, d.best = at += n, d.guide = at += n, d.fork = at += n, d.moved = at += n, d.arena = at + n + 1;
    memset(d.place, -1, (size_t)n * sizeof(int));
    yci_dissect_nodes(&d, n, dim, ptr, col);
    yci_order_minimum_degree(n, dim, ptr, col, order, order, fronts, room);
}

/* Dissection where the order is good for so many operations that what it saves, about a quarter of them from this size
 * on, outweighs the few microseconds that it takes per node; otherwise minimum degree. That one is as good on grids
 * that are numbered line by line, where most rows are the one before moved by one; and is tried as well where
 * dissection leaves more work than a mesh should. */
#define YCI_ORDER_SMALL 6000    /* nodes */
#define YCI_ORDER_WORTH 30000.0 /* operations per node */

/* What a factorisation takes in a mesh, roughly: fronts are as high as a line of nodes has neighbours. */
static double yci_order_guess(int n, const int *dim, const int *ptr) {
    double size = 0.0, neighbours = n ? (double)ptr[n] / n - 1.0 : 0.0;
    int i;
    for (i = 0; i < n; i++) size += (double)dim[i] / n;
    return size * size * size * pow(neighbours * n, 1.5);
}

static int yci_order_regular(int n, const int *ptr, const int *col) {
    int i, alike = 0;
    for (i = 1; i < n; i++)
        alike += ptr[i + 1] - ptr[i] == ptr[i] - ptr[i - 1] && col[ptr[i]] == col[ptr[i - 1]] + 1 &&
            col[ptr[i + 1] - 1] == col[ptr[i] - 1] + 1;
    return alike > n / 4 * 3;
}

/* `trial` is room for another order and its fronts (4 n). */
static void yci_order_auto(int n, const int *dim, const int *ptr, const int *col, int *order, yci_order_fronts *fronts,
    int *room, int *trial) {
    yci_order_fronts other;
    double guess = n < YCI_ORDER_SMALL ? 0.0 : yci_order_guess(n, dim, ptr);
    if (guess < YCI_ORDER_WORTH * n || !n || yci_order_regular(n, ptr, col)) {
        yci_order_minimum_degree(n, dim, ptr, col, NULL, order, fronts, room);
        return;
    }
    yci_order_dissect(n, dim, ptr, col, order, fronts, room);
    if (fronts->flops < 2.0 * guess) return;
    other.size = trial + n, other.below = other.size + n, other.parent = other.below + n;
    yci_order_minimum_degree(n, dim, ptr, col, NULL, trial, &other, room);
    if (other.flops < fronts->flops) {
        size_t bytes = (size_t)other.count * sizeof(int);
        memcpy(order, trial, (size_t)n * sizeof(int)), memcpy(fronts->size, other.size, bytes);
        memcpy(fronts->below, other.below, bytes), memcpy(fronts->parent, other.parent, bytes);
        fronts->count = other.count, fronts->known = other.known, fronts->flops = other.flops;
    }
}

/* ------------------------------------------------------------------------------------ direct: symbolic analysis --- */

#define YCI_LDL_TASKS 32 /* at most: subtrees factored at the same time */
#define YCI_LDL_SOON 16  /* runs of values by which memory is asked ahead */
#define YCI_LDL_STEP 64  /* columns of a front that are factored before the rest of it is updated */
#ifndef YCI_LDL_TILES
#define YCI_LDL_TILES 2500 /* at most: of a factor in tiles */
#endif

/* Values of a block, and where they go: rows of `count` values side by side, each of them `stride` behind the one
 * before, which grows by `grow` from row to row (in a lower triangle). The first goes to `to` in the panel; one further
 * is a column further, or a row if `flip`. The analysis is given `to` as 8 * row + column in the block, and in `flip`
 * whether the next run is of the same block. */
typedef struct yci_ldl_run {
    int from, to, stride;
    unsigned char rows, count, grow, flip;
} yci_ldl_run;

/* An entry of the pattern on or below the diagonal of the permuted matrix: its row's position; the first run of its
 * block, or the complement of that if the caller has it transposed. */
typedef struct yci_ldl_edge {
    int row, run;
} yci_ldl_edge;

/* The blocks of every node with earlier ones and then with itself, those of node i from begin[i] on (behind them may be
 * others): the other node, and the first run of the block. The runs give all values on and below the diagonal, block by
 * block; `run` is NULL if every block is a single value, and its run's number that of the value; first_run is NULL if
 * that is the block's own. */
typedef struct yci_ldl_entries {
    const int *begin, *node, *first_run;
    const yci_ldl_run *run;
    size_t run_count;
} yci_ldl_entries;

/* value[from] goes to l[to]. */
typedef struct yci_ldl_move {
    int from, to;
} yci_ldl_move;

typedef struct yci_ldl_super {
    int first, width, height; /* its first column; its columns; its rows, which begin with the columns themselves */
    int parent, child, next;  /* supernode it updates, its first child, its next sibling; -1: none */
    int row, chunk;           /* where its rows below begin in `row` and `rel`, and the chunks that expand them */
    int inside, chunks;       /* rows below that are columns of the parent's panel; number of chunks */
    int run;                  /* its values' first run; the next supernode's is the end */
    int region, side;         /* where its update matrix lives: task (or their number), and end of its region */
    int shift;                /* first row of the update matrix: width, rounded down to a chunk */
    int repaired;             /* pivot blocks that the last factorisation had to shift */
    int pivot;                /* where its diagonal blocks begin */
    size_t panel, update, ld; /* where panel (height x width) and update matrix begin, and the latter's stride */
} yci_ldl_super;

/* Columns and rows are numbered in elimination order, by unknowns. */
typedef struct yci_ldl {
    yci_context *c;
    const yci_kernels *kernels;
    int spd, size, supers;
    int factored, pivots, tallest; /* columns factored; rows of the highest front */
    int *unknown;                  /* size: the caller's number of each unknown */
    unsigned char *dim;            /* size: unknowns of the node that begins here; 0 inside a node */
    yci_ldl_super *super;          /* supers + 1 */
    int *row, *rel, *chunk;
    yci_ldl_run *run;
    double *panel, *update; /* L, and the update matrices alive */
    double *pivot;          /* the nodes' diagonal blocks (spd: the diagonal), and then the inverses of D */
    double *scaled;         /* work for each task: L D of a front's columns, or a panel that is packed */
    size_t pivot_size, scaled_size, update_size;
    int (*task)[2], tasks; /* ranges of supernodes that are whole subtrees, for parallel factorisation */
    double shift;          /* added to the diagonal of a pivot block without an inverse; 0: it fails */
    double nonzeros, flops;
    yci_tiles tiles; /* of a small factor; without blocks otherwise */
    int tile_rows;   /* of the tiles, if there may be some; 0: there are too many */
    int *place;      /* size: where the unknowns stand among these rows */
    yci_ldl_move *move;
    int moves, ones, tiled; /* values to move, and ones; whether the factor is there rather than in the panels */
} yci_ldl;

static void yci_ldl_untile(yci_ldl *f) {
    yci_context *c = f->c;
    yci_tiles *t = &f->tiles;
    yci_free(c, f->place), yci_free(c, f->move), yci_free(c, t->begin), yci_free(c, t->row), yci_free(c, t->target);
    yci_free(c, t->refine), yci_free(c, t->l), yci_free(c, t->kept), yci_free(c, t->scaled);
    f->place = NULL, f->move = NULL;
    memset(t, 0, sizeof *t);
}

static void yci_ldl_destroy(yci_ldl *f) {
    yci_context *c;
    if (!f) return;
    c = f->c;
    yci_free(c, f->unknown), yci_free(c, f->dim), yci_free(c, f->super), yci_free(c, f->row);
    yci_free(c, f->rel), yci_free(c, f->chunk), yci_free(c, f->run), yci_free(c, f->panel), yci_free(c, f->update);
    yci_free(c, f->pivot), yci_free(c, f->scaled), yci_free(c, f->task);
    yci_ldl_untile(f);
    yci_free(c, f);
}

/* What the analysis works with; everything of the size of the node count, in one block. */
typedef struct yci_ldl_plan {
    int n, active;
    const int *dim, *ptr, *col;
    int *node, *pos;             /* node of a position, position of a node (-1: none) */
    int *parent, *first;         /* elimination tree on positions; the first position of the subtree of each */
    int *head, *next, *work;     /* work arrays */
    int *count, *weight;         /* column counts below the diagonal: nodes, and unknowns */
    int *super_of;               /* supernode of a position */
    int *super_parent, *below;   /* of a supernode: the one above, nodes below its panel, */
    int *width, *height, *group; /* unknowns of its panel; first where it went in amalgamation, at last `below` */
    int *last;                   /* end of its positions */
    int supers, groups;
} yci_ldl_plan;

/* Liu's elimination tree: the first later column that each column's subtree meets; `work` holds compressed paths. */
static void yci_ldl_tree(yci_ldl_plan *t) {
    int i, k;
    for (i = 0; i < t->active; i++) {
        int v = t->node[i];
        t->parent[i] = t->work[i] = -1;
        for (k = t->ptr[v]; k < t->ptr[v + 1]; k++) {
            int j = t->pos[t->col[k]];
            while (j >= 0 && j < i) {
                int up = t->work[j];
                t->work[j] = i;
                if (up < 0) t->parent[j] = i;
                j = up;
            }
        }
    }
}

/* index[i] becomes the place of vertex i of a forest in postorder: children before parents, in ascending order,
 * subtrees together; `size` becomes that of its subtree. From the top, every subtree takes as many places as it has
 * vertices, from behind, out of those that its parent's has left. */
static void yci_ldl_postorder(int n, const int *parent, int *size, int *index) {
    int i, end = n;
    for (i = 0; i < n; i++) size[i] = 1;
    for (i = 0; i < n; i++)
        if (parent[i] >= 0) size[parent[i]] += size[i];
    for (i = n - 1; i >= 0; i--) {
        int *left = parent[i] < 0 ? &end : &index[parent[i]];
        int own = *left - 1;
        *left -= size[i], index[i] = own;
    }
    for (i = 0; i < n; i++) index[i] += size[i] - 1;
}

/* Renumbers positions in postorder. */
static void yci_ldl_sort(yci_ldl_plan *t) {
    int i, *size = t->count, *index = t->next, *node = t->work, *parent = t->weight;
    yci_ldl_postorder(t->active, t->parent, size, index);
    for (i = 0; i < t->active; i++) {
        int place = index[i];
        t->first[place] = place - size[i] + 1, node[place] = t->node[i];
        parent[place] = t->parent[i] < 0 ? -1 : index[t->parent[i]];
    }
    for (i = 0; i < t->active; i++) t->node[i] = node[i], t->pos[node[i]] = i, t->parent[i] = parent[i];
}

/* Counts of the columns of L (Gilbert, Ng, Peyton, An efficient algorithm to compute row and column counts for sparse
 * Cholesky factorization, SIAM J. Matrix Anal. 15, 1994). Row i of L is a subtree with root i; its leaves are those
 * neighbours j < i of i that have no earlier one in their own subtree. A row's weight is put on each leaf and taken off
 * where a leaf's path meets that of the leaf before, and at the root; then sums over subtrees are the counts. `up`
 * leads to the first vertex not yet passed, where the paths meet, and is compressed by halving. */
static void yci_ldl_count(yci_ldl_plan *t) {
    int *leaf = t->work, *up = t->next, i, j, k;
    for (i = 0; i < t->active; i++) t->count[i] = t->weight[i] = 0, leaf[i] = -1, up[i] = i;
    for (j = 0; j < t->active; j++) {
        int v = t->node[j], first = t->first[j];
        for (k = t->ptr[v]; k < t->ptr[v + 1]; k++) {
            int meet, weight;
            i = t->pos[t->col[k]];
            if (i <= j || leaf[i] >= first) continue;
            meet = leaf[i] < 0 ? i : leaf[i], weight = t->dim[t->col[k]];
            while (up[meet] != meet) meet = up[meet] = up[up[meet]];
            t->count[j]++, t->weight[j] += weight;
            t->count[meet]--, t->weight[meet] -= weight;
            leaf[i] = j;
        }
        if (t->parent[j] >= 0) up[j] = t->parent[j];
    }
    for (j = 0; j < t->active; j++) {
        i = t->parent[j];
        if (i >= 0) t->count[i] += t->count[j], t->weight[i] += t->weight[j];
    }
}

/* Supernodes in the strict sense: chains of columns that differ only by their own diagonals. */
static void yci_ldl_fundamental(yci_ldl_plan *t) {
    int i, s = -1;
    for (i = 0; i < t->active; i++) {
        if (i == 0 || t->parent[i - 1] != i || t->count[i - 1] != t->count[i] + 1) t->width[++s] = 0;
        t->super_of[i] = s, t->width[s] += t->dim[t->node[i]], t->height[s] = t->width[s] + t->weight[i];
        t->super_parent[s] = t->parent[i], t->below[s] = t->count[i];
    }
    t->supers = s + 1;
    for (s = 0; s < t->supers; s++)
        if (t->super_parent[s] >= 0) t->super_parent[s] = t->super_of[t->super_parent[s]];
}

/* The same from the fronts of the ordering, which has seen them all; what it left in the plan's own arrays are numbers
 * of nodes, all of the same number of unknowns. */
static void yci_ldl_take_fronts(yci_ldl_plan *t, int count) {
    int s, i = 0, dim = t->active ? t->dim[t->node[0]] : 0;
    t->supers = count;
    for (s = 0; s < count; s++) {
        int end = i + t->width[s];
        while (i < end) t->super_of[i++] = s;
        t->width[s] *= dim, t->height[s] = t->width[s] + dim * t->below[s];
    }
}

/* Costs in nanoseconds on a processor of 2024: of a front, whatever its size; of a multiplication and addition; of an
 * entry of its update matrix; of a stored zero, which the factorisation hardly feels but every solve reads twice. */
#define YCI_LDL_FRONT 300.0
#define YCI_LDL_FLOP (1.0 / 60.0)
#define YCI_LDL_ENTRY 0.5
#define YCI_LDL_ZERO 2.0

static double yci_ldl_cost(double width, double height) {
    double below = height - width;
    return YCI_LDL_FRONT + YCI_LDL_FLOP / 3.0 * (height * height * height - below * below * below) +
        YCI_LDL_ENTRY / 2.0 * below * below;
}

/* Lets a supernode take in those of its children with which it costs less in one front than in two. The child's columns
 * come to the front and grow by the rows that it had not; nothing is left of its update matrix. Leaves in `group` the
 * supernode that a supernode has become part of, which is the topmost. */
static void yci_ldl_amalgamate(yci_ldl_plan *t) {
    int s, child;
    for (s = 0; s < t->supers; s++) t->head[s] = -1;
    for (s = 0; s < t->supers; s++) {
        double cost = yci_ldl_cost(t->width[s], t->height[s]);
        t->group[s] = s;
        for (child = t->head[s]; child >= 0; child = t->next[child]) {
            double w = t->width[child], h = t->height[child];
            double merged = yci_ldl_cost(t->width[s] + w, t->height[s] + w), zeros = w * (t->height[s] - (h - w));
            if (merged + YCI_LDL_ZERO * zeros > cost + yci_ldl_cost(w, h)) continue;
            t->group[child] = s, cost = merged;
            t->width[s] += t->width[child], t->height[s] += t->width[child];
        }
        if (t->super_parent[s] >= 0) t->next[s] = t->head[t->super_parent[s]], t->head[t->super_parent[s]] = s;
    }
    for (s = t->supers - 1; s >= 0; s--) t->group[s] = t->group[t->group[s]];
}

/* Makes the groups supernodes and renumbers them in postorder, and the positions by them. */
static void yci_ldl_regroup(yci_ldl_plan *t) {
    int s, i, at = 0, *index = t->head, *begin = t->next, *parent = t->count, *size = t->work, *node = t->work;
    t->groups = 0;
    for (s = 0; s < t->supers; s++) index[s] = t->group[s] == s ? t->groups++ : -1;
    for (s = 0; s < t->supers; s++)
        if (index[s] >= 0) parent[index[s]] = t->super_parent[s] < 0 ? -1 : index[t->group[t->super_parent[s]]];
    yci_ldl_postorder(t->groups, parent, size, begin);
    for (s = 0; s < t->supers; s++)
        if (index[s] >= 0) {
            i = index[s] = begin[index[s]];
            t->parent[i] = t->super_parent[s];
            t->first[i] = t->width[s], t->weight[i] = t->height[s], t->count[i] = t->below[s];
        }
    for (s = 0; s < t->groups; s++) {
        t->super_parent[s] = t->parent[s] < 0 ? -1 : index[t->group[t->parent[s]]];
        t->width[s] = t->first[s], t->height[s] = t->weight[s], t->below[s] = t->count[s], begin[s] = 0;
    }
    for (i = 0; i < t->active; i++) begin[t->super_of[i] = index[t->group[t->super_of[i]]]]++;
    for (s = 0; s < t->groups; s++) at += begin[s], begin[s] = at - begin[s];
    for (i = 0; i < t->active; i++) node[begin[t->super_of[i]]++] = t->node[i];
    for (i = 0; i < t->active; i++) t->node[i] = node[i], t->pos[node[i]] = i;
    for (s = 0; s < t->groups; s++) t->group[s] = t->below[s], t->last[s] = begin[s];
}

/* Supernodes from the elimination order in `node`, which is renumbered; `fronts` are those that the order was made
 * with, if they are known. */
static void yci_ldl_lay_out(yci_ldl_plan *t, const yci_order_fronts *fronts) {
    if (fronts->known) yci_ldl_take_fronts(t, fronts->count);
    else {
        yci_ldl_tree(t);
        yci_ldl_sort(t);
        yci_ldl_count(t);
        yci_ldl_fundamental(t);
    }
    yci_ldl_amalgamate(t);
    yci_ldl_regroup(t);
}

/* Numbers of a supernode's update matrix. */
static size_t yci_ldl_update_size(const yci_ldl_super *s) { return s->ld * (size_t)(s->height - s->width); }

/* Turns the plan's groups into supernodes and measures them. */
static void yci_ldl_measure(yci_ldl *f, const yci_ldl_plan *t) {
    int s, first = 0, blocks = 0;
    size_t panels = 0, size;
    for (s = 0; s < f->supers; s++) {
        yci_ldl_super *u = f->super + s;
        double below = t->height[s] - t->width[s], w = t->width[s], h = t->height[s];
        u->first = first, first += t->width[s];
        u->width = t->width[s], u->height = t->height[s], u->parent = t->super_parent[s], u->child = -1;
        u->shift = u->width & ~7, u->ld = ((size_t)(u->height - u->shift) + 7) & ~(size_t)7;
        size = (size_t)u->width * (size_t)u->height;
        if (size < yci_packed(u->width, u->height)) size = yci_packed(u->width, u->height);
        u->panel = panels, panels += (size + YCI_OVERREAD + 7) & ~(size_t)7;
        if (u->height > f->tallest) f->tallest = u->height;
        blocks += (u->width + YCI_PANEL - 1) / YCI_PANEL;
        f->nonzeros += w * below + 0.5 * w * (w + 1.0);
        f->flops += (h * (h + 1.0) * (2.0 * h + 1.0) - below * (below + 1.0) * (2.0 * below + 1.0)) / 6.0;
    }
    f->super[s].first = first, f->super[s].panel = panels;
    f->tile_rows = blocks <= YCI_LDL_TILES ? YCI_PANEL * blocks : 0;
    for (s = f->supers - 1; s >= 0; s--) {
        yci_ldl_super *u = f->super + s;
        u->next = -1;
        if (u->parent >= 0) u->next = f->super[u->parent].child, f->super[u->parent].child = s;
    }
}

/* Cuts subtrees off the tree until none of them is more than an eighth of the work: the tasks. What remains above them
 * is factored after them. A host without threads gets no tasks. */
static void yci_ldl_cut(yci_ldl *f) {
    double *work;
    int s, child, parallel = f->c->host.parallel_for != NULL;
#ifdef _OPENMP
    parallel = 1;
#endif
    if (!parallel || f->flops < 1e7 || !(work = YCI_RAW(f->c, double, f->supers))) return;
    for (s = 0; s < f->supers; s++) {
        double h = f->super[s].height, w = f->super[s].width;
        work[s] = h * h * w;
        for (child = f->super[s].child; child >= 0; child = f->super[child].next) work[s] += work[child];
    }
    for (s = 0; s < f->supers; s++) {
        int up = f->super[s].parent, first = s;
        double most = 0.125 * f->flops;
        if (work[s] > most || (up >= 0 && work[up] <= most) || f->tasks == YCI_LDL_TASKS) continue;
        while (f->super[first].child >= 0) first = f->super[first].child;
        f->task[f->tasks][0] = first, f->task[f->tasks++][1] = s + 1;
    }
    yci_free(f->c, work);
}

/* Places of the update matrices: a supernode at an even depth of the tree keeps its own at the low end of a region, one
 * at an odd depth at the high end, so a front can be filled while its children's matrices, at the other end, are read.
 * In postorder each end is a stack. Every task has its region, and what is above the tasks has one. */
static size_t yci_ldl_place_updates(yci_ldl *f) {
    size_t end[2][YCI_LDL_TASKS + 1], most[YCI_LDL_TASKS + 1], begin[YCI_LDL_TASKS + 1], total = 0;
    int s, child, k;
    for (k = 0; k <= f->tasks; k++) end[0][k] = end[1][k] = most[k] = 0;
    for (s = f->supers - 1; s >= 0; s--) {
        yci_ldl_super *u = f->super + s;
        u->side = u->parent < 0 ? 0 : 1 - f->super[u->parent].side;
        u->region = f->tasks;
    }
    for (k = 0; k < f->tasks; k++)
        for (s = f->task[k][0]; s < f->task[k][1]; s++) f->super[s].region = k;
    for (s = 0; s < f->supers; s++) {
        yci_ldl_super *u = f->super + s;
        k = u->region;
        u->update = end[u->side][k], end[u->side][k] += yci_ldl_update_size(u);
        if (end[0][k] + end[1][k] > most[k]) most[k] = end[0][k] + end[1][k];
        for (child = u->child; child >= 0; child = f->super[child].next)
            if (f->super[child].region == k) end[1 - u->side][k] -= yci_ldl_update_size(f->super + child);
    }
    for (k = 0; k <= f->tasks; k++) begin[k] = total, total += most[k] + YCI_OVERREAD;
    for (s = 0; s < f->supers; s++) {
        yci_ldl_super *u = f->super + s;
        if (u->side) u->update = most[u->region] - u->update - yci_ldl_update_size(u);
        u->update += begin[u->region];
    }
    return total;
}

/* What the build needs besides the plan: in `rows` the nodes below every front's own, ascending, those of front s from
 * begin[s] on; in `edge` the entries of the columns, those of position i from edge_begin[i] on. */
typedef struct yci_ldl_rows {
    int *begin, *rows, *edge_begin;
    yci_ldl_edge *edge;
} yci_ldl_rows;

/* Sorts the given entries by the columns where they go, which are those of the node that is eliminated first. */
static void yci_ldl_sort_edges(const yci_ldl_plan *t, const yci_ldl_entries *given, yci_ldl_rows *m) {
    const int *pos = t->pos, *node = given->node;
    int *end = m->edge_begin + 1, i, k, j, sum = 0;
    for (i = -1; i < t->active; i++) end[i] = 0;
    for (i = 0; i < t->n; i++)
        for (k = given->begin[i]; k < given->begin[i + 1] && node[k] <= i; k++)
            j = pos[node[k]], end[j + ((pos[i] - j) & -(pos[i] < j))]++;
    for (i = 0, end[-1] = 0; i < t->active; i++) sum += end[i], end[i] = sum - end[i];
    for (i = 0; i < t->n; i++) {
        int to = pos[i];
        for (k = given->begin[i]; to >= 0 && k < given->begin[i + 1] && node[k] <= i; k++) {
            int run = given->first_run ? given->first_run[k] : k, from = pos[node[k]], flip = from > to;
            int column = from + ((to - from) & -flip); /* the lesser, without a jump */
            yci_ldl_edge *edge;
            if (from < 0) continue;
            edge = m->edge + end[column]++, edge->row = from + to - column, edge->run = run ^ -flip;
        }
    }
}

/* Finds the rows from the entries and the children. All fronts are sorted at once by exchanging rows and columns twice.
 * What is not wanted is written as well, and then overwritten by what comes next. */
static void yci_ldl_gather(const yci_ldl *f, yci_ldl_plan *t, yci_ldl_rows *m, int *sorted) {
    int s, i, k, child, edge = 0, *start = t->work, *mark = t->count, *rows = m->rows, *begin = m->begin;
    for (k = 0; k < t->active; k++) start[k] = 0, mark[k] = -1;
    for (s = 0, begin[0] = 0; s < f->supers; s++) {
        int used = begin[s], last = t->last[s];
        for (; edge < m->edge_begin[last]; edge++) {
            int r = m->edge[edge].row, fresh = (r >= last) & (mark[r] != s);
            rows[used] = r, used += fresh, mark[r] = s;
        }
        for (child = f->super[s].child; child >= 0; child = f->super[child].next)
            for (k = begin[child]; k < begin[child + 1]; k++) {
                int r = rows[k], fresh = (r >= last) & (mark[r] != s);
                rows[used] = r, used += fresh, mark[r] = s;
            }
        for (k = begin[s]; k < used; k++) start[rows[k]]++;
        begin[s + 1] = used;
    }
    for (i = 0, k = 0; i < t->active; i++) k += start[i], start[i] = k - start[i];
    for (s = 0; s < f->supers; s++)
        for (k = begin[s]; k < begin[s + 1]; k++) sorted[start[rows[k]]++] = s;
    for (s = 0; s < f->supers; s++) t->head[s] = begin[s];
    for (i = 0, k = 0; i < t->active; i++)
        for (; k < start[i]; k++) rows[t->head[sorted[k]]++] = i;
}

/* A child's rows in its parent's front, in which node i begins at where[i]. */
static void yci_ldl_relate(yci_ldl *f, const int *dim, const int *where, yci_ldl_super *v, const int *row, int count) {
    int *rel = f->rel + v->row, *chunk = f->chunk + v->chunk, width = f->super[v->parent].width;
    int k, used = 0, inside = 0, at = 0, word = 0, base = count ? where[row[0]] / 8 : 0;
    for (k = 0; k < count; k++) {
        int place = where[row[k]], end = place + dim[row[k]];
        inside += place < width ? end - place : 0;
        for (; place < end; place++) {
            if (place / 8 - base > at)
                for (chunk[at++] = word, word = used << 8; at < place / 8 - base;) chunk[at++] = word;
            rel[used++] = place, word |= 1 << (place & 7);
        }
    }
    if (count) chunk[at++] = word;
    v->inside = inside, v->chunks = at;
}

/* The runs of a node's entries, whose column begins at `column` of its panel. Returns their number. */
static int yci_ldl_place(const yci_ldl_edge *edge, int count, int left, const int *where, int column, int height,
    const yci_ldl_run *given, yci_ldl_run *run) {
    int k, used = 0;
    for (k = 0; !given && k < count; k++) {
        int flip = edge[k].run < 0;
        run[k].from = edge[k].run ^ -flip, run[k].to = column * height + where[edge[k].row], run[k].stride = 0;
        run[k].rows = run[k].count = 1, run[k].grow = 0, run[k].flip = (unsigned char)flip;
    }
    if (!given) return count;
    for (k = 0; k < count; k++) {
        int row = where[edge[k].row], flip = edge[k].run < 0;
        if (k + YCI_LDL_SOON < left) {
            int soon = edge[k + YCI_LDL_SOON].run;
            YCI_PREFETCH(given + (soon ^ -(soon < 0)));
        }
        const yci_ldl_run *from = given + (edge[k].run ^ -flip);
        do {
            int r = from->to >> 3, c = from->to & 7;
            run[used] = *from, run[used].flip = (unsigned char)flip;
            run[used++].to = (column + (flip ? r : c)) * height + row + (flip ? c : r);
        } while (from++->flip);
    }
    return used;
}

/* Where everything goes: the fronts' rows, children's rows in their parents' fronts, the caller's values in the panels.
 * Positions have their numbers of unknowns in `dim` and their first ones in `first`; `where` holds a node's place in
 * the front at hand. */
static void yci_ldl_maps(yci_ldl *f, const yci_ldl_plan *t, const int *dim, const int *first, int *where,
    const yci_ldl_rows *m, const yci_ldl_run *given) {
    int s, i = 0, k, a, child, at = 0, chunks = 0, runs = 0, *row = f->row;
    for (s = 0; s < f->supers; s++) {
        yci_ldl_super *u = f->super + s;
        int place = u->width;
        u->row = at, u->run = runs;
        for (k = i; k < t->last[s]; k++) where[k] = first[k] - u->first;
        for (k = m->begin[s]; k < m->begin[s + 1]; k++) {
            int r = m->rows[k];
            where[r] = place, place += dim[r];
            for (a = 0; a < dim[r]; a++) row[at++] = first[r] + a;
        }
        for (a = 1; a < YCI_OVERREAD; a++) row[at++] = f->size;
        for (child = u->child; child >= 0; child = f->super[child].next) {
            yci_ldl_super *v = f->super + child;
            v->chunk = chunks;
            yci_ldl_relate(f, dim, where, v, m->rows + m->begin[child], m->begin[child + 1] - m->begin[child]);
            chunks += v->chunks;
        }
        for (; i < t->last[s]; i++)
            runs += yci_ldl_place(m->edge + m->edge_begin[i], m->edge_begin[i + 1] - m->edge_begin[i],
                m->edge_begin[t->active] - m->edge_begin[i], where, where[i], u->height, given, f->run + runs);
    }
    f->super[s].row = at, f->super[s].run = runs;
}

/* The unknowns in elimination order; leaves in `dim` and `first` what yci_ldl_maps wants. */
static void yci_ldl_number(yci_ldl *f, const yci_ldl_plan *t, int *dim, int *first) {
    int i, k, a, at = 0, *unknown = t->work;
    memset(f->dim, 0, (size_t)f->size);
    for (i = 0, k = 0; i < t->n; i++) unknown[i] = k, k += t->dim[i];
    for (i = 0; i < t->active; i++) {
        int v = t->node[i];
        dim[i] = t->dim[v], first[i] = at, f->dim[at] = (unsigned char)dim[i];
        for (a = 0; a < dim[i]; a++) f->unknown[at++] = unknown[v] + a;
    }
}

/* Everything of the factor that depends on the plan's outcome, but for L itself; works in `room` if that is enough.
 * Returns 0 without memory. */
static int yci_ldl_build(yci_ldl *f, yci_ldl_plan *t, const yci_ldl_entries *given, int *room, size_t room_size) {
    yci_context *c = f->c;
    size_t n = (size_t)f->size, node_rows = 1, rows = 0, chunks = 0,
           edges = ((size_t)t->ptr[t->n] + (size_t)t->n) / 2 + 1, need;
    int *block = NULL, s, i, ok;
    yci_ldl_rows m;
    f->supers = t->groups;
    for (s = 0; s < f->supers; s++) {
        node_rows += (size_t)t->group[s];
        rows += (size_t)(t->height[s] - t->width[s] + YCI_OVERREAD - 1);
        if (t->super_parent[s] >= 0) chunks += (size_t)t->height[t->super_parent[s]] / 8 + 1;
        if (t->height[s] > INT_MAX >> 9 || t->width[s] > INT_MAX / t->height[s]) return 0; /* beyond what maps hold */
    }
    if (rows > INT_MAX) return 0;
    f->super = YCI_NEW(c, yci_ldl_super, f->supers + 1), f->task = (int(*)[2])YCI_RAW(c, int, 2 * YCI_LDL_TASKS);
    f->unknown = YCI_RAW(c, int, n), f->dim = YCI_RAW(c, unsigned char, n);
    f->row = YCI_RAW(c, int, rows), f->rel = YCI_RAW(c, int, rows), f->chunk = YCI_RAW(c, int, chunks);
    f->run = YCI_RAW(c, yci_ldl_run, given->run_count);
    need = (size_t)f->supers + 1 + 2 * node_rows + 2 * edges;
    if (need > room_size) room = block = YCI_RAW(c, int, need);
    ok = f->super && f->task && room && f->unknown && f->dim && f->row && f->rel && f->run && f->chunk;
    if (ok) {
        m.edge = (yci_ldl_edge *)room, m.begin = room + 2 * edges, m.rows = m.begin + f->supers + 1;
        m.edge_begin = t->first;
        yci_ldl_measure(f, t);
        yci_ldl_sort_edges(t, given, &m);
        yci_ldl_gather(f, t, &m, m.rows + node_rows);
        yci_ldl_number(f, t, t->count, t->next);
        yci_ldl_maps(f, t, t->count, t->next, t->head, &m, given->run);
        for (s = 0; s < f->supers; s++) {
            f->super[s].pivot = (int)f->pivot_size;
            for (i = f->super[s].first; i < f->super[s + 1].first; i++)
                f->pivot_size += f->spd ? 1 : (size_t)(f->dim[i] * f->dim[i]);
        }
        if (f->pivot_size > INT_MAX) ok = 0;
        yci_ldl_cut(f);
        f->update_size = yci_ldl_place_updates(f);
    }
    yci_free(c, block);
    f->scaled_size = (size_t)(f->tallest + 2 * YCI_OVERREAD) * (f->spd ? YCI_PANEL : YCI_LDL_STEP);
    return ok;
}

/* Analyses a full symmetric pattern of nodes with its diagonal (as of yci_bsr), whose values are `given`. `order` names
 * the node eliminated k-th, or is NULL for the library's choice, which `stage` (NULL or n numbers of 0 to n - 1)
 * constrains: lower stages come first. Nothing of the arguments is kept. On failure *out is NULL. */
static yc_result yci_ldl_analyze(yci_context *c, int n, const int *dim, const int *ptr, const int *col,
    const yci_ldl_entries *given, const int *order, const int *stage, int spd, yci_ldl **out) {
    yci_ldl_plan t;
    yci_order_fronts fronts;
    yci_ldl *f = YCI_NEW(c, yci_ldl, 1);
    size_t size = (size_t)n + 1, room = yci_order_room(n, ptr);
    int *block = room ? YCI_RAW(c, int, room + 17 * size) : NULL, *at, i, ok;
    yc_result result = YC_OK;
    *out = NULL;
    memset(&t, 0, sizeof t), memset(&fronts, 0, sizeof fronts);
    ok = f && block && given->run_count <= INT_MAX;
    if (f) f->c = c;
    if (ok) {
        f->kernels = yci_kernels_best(), f->spd = spd;
        t.n = n, t.dim = dim, t.ptr = ptr, t.col = col;
        t.node = at = block + room, t.pos = at += size, t.parent = at += size, t.first = at += size;
        t.head = at += size, t.next = at += size, t.work = at += size, t.count = at += size, t.weight = at += size;
        t.super_of = at += size, t.super_parent = at += size, t.below = at += size, t.width = at += size;
        t.height = at += size, t.group = at += size, t.last = at += size, at += size;
        fronts.size = t.width, fronts.below = t.below, fronts.parent = t.super_parent;
        if (!order && stage) yci_order_minimum_degree(n, dim, ptr, col, stage, at, &fronts, block);
        else if (!order) yci_order_auto(n, dim, ptr, col, at, &fronts, block, t.node);
        for (i = 0; i < n; i++) t.pos[i] = -1, t.work[i] = 0;
        for (i = 0; result == YC_OK && i < n; i++) {
            int v = order ? order[i] : at[i];
            if (v < 0 || v >= n || t.work[v]++)
                result = YCI_FAIL(c, YC_ERROR_ARGUMENT, "elimination order: entry %d is %d, of %d nodes", i, v, n);
            else if (t.dim[v]) t.pos[v] = t.active, t.node[t.active++] = v, f->size += t.dim[v];
        }
    }
    if (ok && result == YC_OK) {
        yci_ldl_lay_out(&t, &fronts);
        ok = yci_ldl_build(f, &t, given, block, room);
    }
    yci_free(c, block);
    if (ok && result == YC_OK) {
        *out = f;
        return YC_OK;
    }
    yci_ldl_destroy(f);
    return ok ? result : yci_out_of_memory(c, "a sparse factorisation");
}

/* The same for a block matrix, whose values yci_ldl_factor is then given. */
static yc_result yci_ldl_analyze_bsr(yci_context *c, const yci_bsr *m, const int *order, int spd, yci_ldl **out) {
    size_t count = 0;
    int i, k, a, used = 0, *first_run = YCI_RAW(c, int, m->ptr[m->n]);
    yci_ldl_entries given;
    yci_ldl_run *run;
    yc_result result;
    *out = NULL;
    for (i = 0; i < m->n; i++) count += (size_t)(m->diag[i] - m->ptr[i] + m->dim[i] + 1);
    run = YCI_RAW(c, yci_ldl_run, count);
    if (!run || !first_run || m->at[m->ptr[m->n]] > INT_MAX) {
        yci_free(c, run), yci_free(c, first_run);
        return yci_out_of_memory(c, "a sparse factorisation");
    }
    for (i = 0; i < m->n; i++) {
        for (k = m->ptr[i]; k <= m->diag[i]; k++) {
            int j = m->col[k], columns = m->dim[j], whole = j < i;
            first_run[k] = used;
            for (a = 0; a < (whole ? 1 : m->dim[i]); a++, used++) {
                run[used].from = (int)m->at[k] + a * columns, run[used].to = 8 * a, run[used].stride = columns;
                run[used].rows = (unsigned char)(whole ? m->dim[i] : 1), run[used].grow = 0;
                run[used].count = (unsigned char)(whole ? columns : a + 1), run[used].flip = a + 1 < m->dim[i];
                if (whole) run[used].flip = 0;
            }
        }
    }
    given.begin = m->ptr, given.node = m->col, given.first_run = first_run;
    given.run = run, given.run_count = (size_t)used;
    result = yci_ldl_analyze(c, m->n, m->dim, m->ptr, m->col, &given, order, NULL, spd, out);
    yci_free(c, run), yci_free(c, first_run);
    return result;
}

/* ------------------------------------------------------------------------------------ direct: numbers and solve --- */

/* Adds the columns of a child's update matrix that fall into its parent's panel (part 0), or the others (part 1). */
static void yci_ldl_extend(const yci_ldl *f, const yci_ldl_super *child, const yci_ldl_super *s, int part) {
    yci_expansion e;
    int begin = part ? child->inside : 0;
    e.count = (part ? child->height - child->width : child->inside) - begin;
    if (e.count == 0) return;
    e.place = f->rel + child->row + begin, e.chunk = f->chunk + child->chunk;
    e.chunks = child->chunks, e.base = f->rel[child->row] / 8;
    e.source = f->update + child->update + (size_t)begin * child->ld + (child->width - child->shift);
    e.source_ld = child->ld;
    e.target = part ? f->update + s->update : f->panel + s->panel, e.target_ld = part ? s->ld : (size_t)s->height;
    e.column = part ? s->width : 0, e.row = part ? s->shift : 0;
    f->kernels->expand(&e);
}

YCI_INLINE void yci_ldl_put(
    const yci_ldl_run *run, int rows, int count, const double *from, double *to, size_t height) {
    size_t along = run->flip ? 1 : height, down = run->flip ? height : 1;
    int a, i, stride = run->stride;
    for (a = 0; a < rows; a++, from += stride, stride += run->grow, to += down) {
        YCI_UNROLL
        for (i = 0; i < count; i++) to[(size_t)i * along] = from[i];
    }
}

/* Fills the panel of a supernode: its own values, and what its children leave in its columns. Keeps its diagonal
 * blocks before anything is subtracted from them. */
static void yci_ldl_assemble(const yci_ldl *f, const yci_ldl_super *s, const double *value, double *pivot) {
    double *panel = f->panel + s->panel;
    size_t h = (size_t)s->height;
    int k, i, a, b, d, child, runs = f->super[f->supers].run;
    memset(panel, 0, (size_t)(s[1].panel - s->panel) * sizeof *panel);
    for (k = s->run; k < s[1].run; k++) {
        const yci_ldl_run *run = f->run + k;
        const double *from = value + run->from;
        double *to = panel + run->to;
        if (k + YCI_LDL_SOON < runs) YCI_PREFETCH(value + run[YCI_LDL_SOON].from);
        if (run->rows == 1 && run->count == 1) *to = *from; /* the common sizes, as constants */
        else if (run->rows == 3 && run->count == 3) yci_ldl_put(run, 3, 3, from, to, h);
        else yci_ldl_put(run, run->rows, run->count, from, to, h);
    }
    for (i = 0; i < s->width; i += d) {
        const double *corner = panel + (size_t)i * (h + 1);
        d = f->spd ? 1 : f->dim[s->first + i];
        for (a = 0; a < d; a++)
            for (b = 0; b < d; b++) *pivot++ = corner[a > b ? b * (int)h + a : a * (int)h + b];
    }
    for (child = s->child; child >= 0; child = f->super[child].next) yci_ldl_extend(f, f->super + child, s, 0);
}

/* Columns [begin, end) of a front have been factored; what they take from the columns behind them. */
typedef struct yci_ldl_trail {
    const yci_ldl *f;
    const yci_ldl_super *s;
    const double *scaled;         /* L D of the columns, from row `begin` on */
    int begin, end, inner, group; /* inner: groups of columns that are in the panel */
} yci_ldl_trail;

static void yci_ldl_trail_columns(void *arg, int first, int last) {
    const yci_ldl_trail *t = (const yci_ldl_trail *)arg;
    const yci_ldl_super *s = t->s;
    size_t h = (size_t)s->height;
    const double *l = t->f->panel + s->panel + (size_t)t->begin * h, *ld = t->scaled - t->begin;
    int q, j, k = t->end - t->begin;
    for (q = first; q < last; q++) {
        int inside = q < t->inner, column = inside ? t->end + q * t->group : s->width + (q - t->inner) * t->group;
        int limit = inside ? s->width : s->height, shift = inside ? 0 : s->shift, origin = inside ? 0 : s->width;
        size_t ldc = inside ? h : s->ld;
        double *c = (inside ? t->f->panel + s->panel : t->f->update + s->update) - shift;
        if (limit > column + t->group) limit = column + t->group;
        for (j = column; j < limit; j += YCI_PANEL) { /* rows down to the group's last, then those below together */
            int n = yci_min_int(limit - j, YCI_PANEL), from = inside ? j : j & ~7;
            int to = t->group == YCI_PANEL ? s->height : yci_min_int((limit + 7) & ~7, s->height);
            t->f->kernels->product(to - from, n, k, l + from, h, ld + j, h, c + (size_t)(j - origin) * ldc + from, ldc,
                inside || t->begin);
        }
        j = t->group == YCI_PANEL ? s->height : (limit + 7) & ~7;
        if (j < s->height)
            t->f->kernels->product(s->height - j, limit - column, k, l + j, h, ld + column, h,
                c + (size_t)(column - origin) * ldc + j, ldc, inside || t->begin);
    }
}

/* Assembles and factors the front of supernode s. Returns the column that failed, or -1. */
static int yci_ldl_front(yci_ldl *f, int index, const double *value, int alone) {
    yci_ldl_super *s = f->super + index;
    yci_ldl_trail t;
    size_t h = (size_t)s->height, slot = (size_t)s->region;
    double *pivot = f->pivot + s->pivot;
    int i, items, child, bad;
    yci_ldl_assemble(f, s, value, pivot);
    t.f = f, t.s = s, s->repaired = 0;
    for (t.begin = t.end = 0; t.begin < s->width; t.begin = t.end) {
        double *corner = f->panel + s->panel + (size_t)t.begin * (h + 1);
        int rows = s->height - t.begin;
        if (f->spd) {
            t.end = s->width - t.begin > YCI_LDL_STEP ? t.begin + YCI_LDL_STEP : s->width;
            t.scaled = corner;
            bad = yci_panel_cholesky(f->kernels, rows, t.end - t.begin, corner, h, pivot);
            pivot += t.end - t.begin;
        } else {
            const unsigned char *dim = f->dim + s->first;
            double *scaled = f->scaled + slot * f->scaled_size, *next = pivot;
            for (i = t.begin; i < s->width && i + dim[i] - t.begin <= YCI_LDL_STEP; i += dim[i])
                next += dim[i] * dim[i];
            t.end = i, t.scaled = scaled;
            bad = yci_panel_indefinite(
                f->kernels, rows, t.end - t.begin, corner, h, dim + t.begin, pivot, f->shift, scaled, &s->repaired);
            pivot = next;
        }
        if (bad >= 0) return s->first + t.begin + bad;
        t.group = s->height - t.end > 256 ? 32 : 8;
        t.inner = (s->width - t.end + t.group - 1) / t.group;
        items = t.inner + (s->height - s->width + t.group - 1) / t.group;
        if (alone)
            yci_parallel(
                f->c, items, 1 + 65536 / (1 + (t.end - t.begin) * (s->height - t.end)), yci_ldl_trail_columns, &t);
        else yci_ldl_trail_columns(&t, 0, items);
    }
    f->kernels->pack(s->width, s->height, f->panel + s->panel, f->scaled + slot * f->scaled_size);
    for (child = s->child; child >= 0; child = f->super[child].next) yci_ldl_extend(f, f->super + child, s, 1);
    return -1;
}

typedef struct yci_ldl_job {
    yci_ldl *f;
    const double *value;
    int bad[YCI_LDL_TASKS];
} yci_ldl_job;

static void yci_ldl_tasks(void *arg, int first, int last) {
    yci_ldl_job *job = (yci_ldl_job *)arg;
    int k, s;
    for (k = first; k < last; k++) {
        job->bad[k] = -1;
        for (s = job->f->task[k][0]; s < job->f->task[k][1] && job->bad[k] < 0; s++)
            job->bad[k] = yci_ldl_front(job->f, s, job->value, 0);
    }
}

/* Factors as far as possible. Returns the first column that fails, or -1. */
static int yci_ldl_columns(yci_ldl *f, const double *value) {
    yci_ldl_job job;
    int k, s, bad = -1;
    job.f = f, job.value = value;
    yci_parallel(f->c, f->tasks, 1, yci_ldl_tasks, &job);
    for (k = f->tasks - 1; k >= 0; k--)
        if (job.bad[k] >= 0) bad = job.bad[k];
    for (s = 0; s < f->supers && (bad < 0 || f->super[s].first < bad); s++)
        if (f->super[s].region == f->tasks) {
            int own = yci_ldl_front(f, s, value, 1);
            if (own >= 0) bad = own;
        }
    return bad;
}

/* ---------------------------------------------------------------------------------- direct: small ones in tiles --- */

/* Gives every unknown its place, each supernode beginning with a tile. Returns 0 where a node's pivot block would be
 * taken apart by the pairs in which tiles are inverted. */
static int yci_ldl_places(yci_ldl *f) {
    int s, i, at = 0;
    for (s = 0; s < f->supers; s++, at = (at + YCI_PANEL - 1) / YCI_PANEL * YCI_PANEL)
        for (i = f->super[s].first; i < f->super[s + 1].first; i++, at++) {
            if (!f->spd && (f->dim[i] > 2 || (f->dim[i] == 2 && at % 2))) return 0;
            f->place[i] = at;
        }
    return 1;
}

/* The columns of tiles. Those of one supernode have the same rows of tiles, since what a row of a front meets is in the
 * front of every other of its rows. Returns the number of tiles, 0 when there are too many. `list` is work. */
static int yci_ldl_tile_columns(yci_ldl *f, int *list) {
    yci_tiles *t = &f->tiles;
    int s, i, q, used = 0;
    t->blocks = 0;
    for (s = 0; s < f->supers; s++) {
        const yci_ldl_super *u = f->super + s;
        int count = 0, own = (u->width + YCI_PANEL - 1) / YCI_PANEL;
        for (i = 0; i < own; i++) list[count++] = t->blocks + i;
        for (i = 0; i < u->height - u->width; i++) {
            int tile = f->place[f->row[u->row + i]] / YCI_PANEL;
            if (tile != list[count - 1]) list[count++] = tile;
        }
        for (q = 0; q < own; used += count - q, q++) {
            if (count - q > YCI_LDL_TILES - used) return 0;
            t->begin[t->blocks++] = used;
            memcpy(t->row + used, list + q, (size_t)(count - q) * sizeof *list);
        }
    }
    t->begin[t->blocks] = used;
    return used;
}

/* The tiles that pairs of tiles change; returns their number, which is all that happens without `target`. */
static size_t yci_ldl_tile_targets(const yci_tiles *t, int *target) {
    size_t used = 0;
    int j, a, b, k;
    for (j = 0; j < t->blocks; j++)
        for (a = t->begin[j] + 1; a < t->begin[j + 1]; a++) {
            if (!target) used += (size_t)(t->begin[j + 1] - a);
            else
                for (b = a, k = t->begin[t->row[a]]; b < t->begin[j + 1]; target[used++] = k, b++)
                    while (t->row[k] != t->row[b]) k++;
        }
    return used;
}

/* Where the values go; those on the diagonal's tiles, which are stored whole, to both places. `at` is work. */
static int yci_ldl_tile_moves(const yci_ldl *f, int *at, yci_ldl_move *move) {
    const yci_tiles *t = &f->tiles;
    const int *place = f->place;
    int s, k, i, a, used = 0;
    for (s = 0; s < f->supers; s++) {
        const yci_ldl_super *u = f->super + s;
        const int *below = f->row + u->row - u->width;
        int first = place[u->first] / YCI_PANEL;
        for (k = t->begin[first]; k < t->begin[first + 1]; k++) at[t->row[k]] = k - t->begin[first];
        for (k = u->run; k < u[1].run; k++) {
            const yci_ldl_run *run = f->run + k;
            int top = run->to % u->height, left = u->first + run->to / u->height, from = run->from, step = run->stride;
            for (a = 0; a < run->rows; a++, from += step, step += run->grow)
                for (i = 0; i < run->count; i++) {
                    int r = top + (run->flip ? i : a), column = place[left + (run->flip ? a : i)];
                    int row = place[r < u->width ? u->first + r : below[r]], block = column / YCI_PANEL;
                    int down = at[row / YCI_PANEL] - (block - first), corner = YCI_TILE * (t->begin[block] + down);
                    row %= YCI_PANEL, column %= YCI_PANEL;
                    move[used].from = from + i, move[used++].to = corner + YCI_PANEL * column + row;
                    if (down || row == column) continue;
                    move[used].from = from + i, move[used++].to = corner + YCI_PANEL * row + column;
                }
        }
    }
    return used;
}

/* The ones that stand on the diagonal where no unknown does. */
static int yci_ldl_tile_ones(const yci_ldl *f, yci_ldl_move *move) {
    int s, used = 0;
    for (s = 0; s < f->supers; s++) {
        int at = f->place[f->super[s + 1].first - 1] + 1;
        for (; at % YCI_PANEL; at++, used++)
            move[used].from = 0,
            move[used].to = YCI_TILE * f->tiles.begin[at / YCI_PANEL] + (YCI_PANEL + 1) * (at % YCI_PANEL);
    }
    return used;
}

/* Prepares a factor in tiles where the analysis gives few of them. Returns 0 without memory. */
static int yci_ldl_tile(yci_ldl *f) {
    yci_context *c = f->c;
    yci_tiles *t = &f->tiles;
    int k, most = 0, blocks = f->tile_rows / YCI_PANEL, count = 0, ok, *work;
    size_t pairs, values = 0;
    if (!blocks) return 1;
    work = YCI_RAW(c, int, blocks), f->place = YCI_RAW(c, int, f->size);
    t->begin = YCI_RAW(c, int, blocks + 1), t->row = YCI_RAW(c, int, YCI_LDL_TILES);
    ok = work && f->place && t->begin && t->row;
    if (ok && yci_ldl_places(f)) count = yci_ldl_tile_columns(f, work);
    if (count) {
        pairs = yci_ldl_tile_targets(t, NULL);
        for (k = 0; k < f->super[f->supers].run; k++) values += (size_t)(f->run[k].rows * f->run[k].count) * 2;
        for (k = 0; k < t->blocks; k++)
            if (most < t->begin[k + 1] - t->begin[k]) most = t->begin[k + 1] - t->begin[k];
        t->spd = f->spd, t->target = YCI_RAW(c, int, pairs);
        f->move = YCI_RAW(c, yci_ldl_move, values + (size_t)YCI_PANEL * (size_t)blocks);
        t->l = YCI_RAW(c, double, count *YCI_TILE), t->kept = YCI_RAW(c, double, blocks *YCI_TILE);
        t->scaled = YCI_RAW(c, double, most *YCI_TILE);
        t->refine = YCI_RAW(c, int, blocks);
        ok = t->target && f->move && t->refine && t->l && t->kept && t->scaled;
    }
    if (ok && count) {
        yci_ldl_tile_targets(t, t->target);
        f->moves = yci_ldl_tile_moves(f, work, f->move);
        f->ones = yci_ldl_tile_ones(f, f->move + f->moves);
    }
    yci_free(c, work);
    if (!ok || !count) yci_ldl_untile(f);
    return ok;
}

/* Factors in tiles. Returns 0 where that cannot be done, which says nothing of the matrix. */
static int yci_ldl_factor_tiles(yci_ldl *f, const double *value) {
    const yci_tiles *t = &f->tiles;
    int k;
    if (!t->blocks) return 0;
    memset(t->l, 0, YCI_TILE * (size_t)t->begin[t->blocks] * sizeof *t->l);
    for (k = 0; k < f->moves; k++) t->l[f->move[k].to] = value[f->move[k].from];
    for (; k < f->moves + f->ones; k++) t->l[f->move[k].to] = 1.0;
    return f->kernels->tiles_factor(t);
}

/* Takes the unknowns of count arrays x to their places in y, or back. */
YCI_INLINE void yci_ldl_carry_some(
    const yci_ldl *f, double *x, int count, size_t ldx, double *y, size_t ldy, int back) {
    const int *place = f->place, *unknown = f->unknown;
    int i, r, size = f->size;
    for (i = 0; i < size; i++) {
        double *there = y + place[i], *here = x + unknown[i];
        YCI_UNROLL
        for (r = 0; r < count; r++)
            if (back) here[(size_t)r * ldx] = there[(size_t)r * ldy];
            else there[(size_t)r * ldy] = here[(size_t)r * ldx];
    }
}

static void yci_ldl_carry(const yci_ldl *f, double *x, int count, size_t ldx, double *y, size_t ldy, int back) {
    if (count == 1) yci_ldl_carry_some(f, x, 1, ldx, y, ldy, back);
    else if (count == 3) yci_ldl_carry_some(f, x, 3, ldx, y, ldy, back);
    else yci_ldl_carry_some(f, x, count, ldx, y, ldy, back);
}

static void yci_ldl_solve_tiles(const yci_ldl *f, double *x, int count, size_t ldx, double *y) {
    size_t ldy = (size_t)YCI_PANEL * (size_t)f->tiles.blocks;
    memset(y, 0, ldy * (size_t)count * sizeof *y);
    yci_ldl_carry(f, x, count, ldx, y, ldy, 0);
    f->kernels->tiles_solve(&f->tiles, y, ldy, count);
    yci_ldl_carry(f, x, count, ldx, y, ldy, 1);
}

/* Room for L and the update matrices, which nobody needs before the first factorisation. */
static int yci_ldl_room(yci_ldl *f) {
    size_t sets = (size_t)f->tasks + 1;
    if (f->panel) return 1;
    f->update = YCI_RAW(f->c, double, f->update_size);
    f->pivot = YCI_RAW(f->c, double, f->pivot_size);
    f->scaled = YCI_RAW(f->c, double, sets * f->scaled_size);
    if (f->update && f->pivot && f->scaled && yci_ldl_tile(f))
        f->panel = YCI_RAW(f->c, double, f->super[f->supers].panel);
    if (f->panel) return 1;
    yci_free(f->c, f->update), yci_free(f->c, f->pivot), yci_free(f->c, f->scaled);
    f->update = f->pivot = f->scaled = NULL;
    yci_ldl_untile(f);
    return 0;
}

/* Factors the matrix with these values, which the analysis was told where to find. The first call allocates L. After a
 * failure there is no factor; the columns before f->pivots have one. */
static yc_result yci_ldl_factor(yci_ldl *f, const double *value) {
    int bad, s;
    f->factored = f->pivots = f->tiled = 0;
    for (s = 0; s < f->supers; s++) f->super[s].repaired = 0;
    if (!yci_ldl_room(f)) return yci_out_of_memory(f->c, "a sparse factor");
    if (yci_ldl_factor_tiles(f, value)) {
        f->factored = f->tiled = 1, f->pivots = f->size;
        return YC_OK;
    }
    bad = yci_ldl_columns(f, value);
    f->pivots = bad < 0 ? f->size : bad;
    if (bad >= 0 && f->spd)
        return YCI_FAIL(f->c, YC_ERROR_NOT_SPD, "the matrix is not positive definite at unknown %d, pivot %d of %d",
            f->unknown[bad], bad, f->size);
    if (bad >= 0)
        return YCI_FAIL(f->c, YC_ERROR_SINGULAR, "the matrix is singular at unknown %d, pivot %d of %d",
            f->unknown[bad], bad, f->size);
    f->factored = 1;
    return YC_OK;
}

/* Numbers of `work` for a solve: the unknowns, or all rows of tiles; and a front's. */
static size_t yci_ldl_right(const yci_ldl *f) {
    int rows = f->size + YCI_OVERREAD;
    return ((size_t)(rows > f->tile_rows ? rows : f->tile_rows) + 7) & ~(size_t)7;
}
static size_t yci_ldl_own(const yci_ldl *f) { return ((size_t)f->tallest + 2 * YCI_OVERREAD + 7) & ~(size_t)7; }
static size_t yci_ldl_work(const yci_ldl *f, int count) { return (yci_ldl_right(f) + yci_ldl_own(f)) * (size_t)count; }

static yci_trapezoid yci_ldl_trapezoid(const yci_ldl *f, int s) {
    const yci_ldl_super *u = f->super + s;
    yci_trapezoid t;
    t.l = f->panel + u->panel, t.first = u->first, t.width = u->width, t.height = u->height, t.row = f->row + u->row;
    return t;
}

/* y := inverse(D) y. */
static void yci_ldl_divide(const yci_ldl *f, double *y) {
    const double *inverse = f->pivot;
    int i, a, b, d;
    for (i = 0; i < f->size; i += d, inverse += d * d) {
        d = f->dim[i];
        if (d == 1) y[i] *= inverse[0];
        else if (d == 2) {
            double first = y[i], second = y[i + 1];
            y[i] = inverse[0] * first + inverse[1] * second;
            y[i + 1] = inverse[2] * first + inverse[3] * second;
        } else {
            double t[YCI_BLOCK_MAX];
            for (a = 0; a < d; a++) t[a] = y[i + a], y[i + a] = 0.0;
            for (a = 0; a < d; a++)
                for (b = 0; b < d; b++) y[i + a] += inverse[a * d + b] * t[b];
        }
    }
}

/* x := inverse(A) x for at most YCI_RIGHT right-hand sides x[r * ldx + i] in the caller's numbering. Needs a factor;
 * `work` has yci_ldl_work(f, count) numbers. */
static void yci_ldl_solve_some(const yci_ldl *f, double *x, int count, size_t ldx, double *work) {
    size_t ldy = yci_ldl_right(f), ldz = yci_ldl_own(f);
    double *z = work + ldy * (size_t)count;
    int s, r, i;
    if (f->tiled) {
        yci_ldl_solve_tiles(f, x, count, ldx, work);
        return;
    }
    for (r = 0; r < count; r++) {
        double *y = work + (size_t)r * ldy;
        for (i = 0; i < f->size; i++) y[i] = x[(size_t)r * ldx + (size_t)f->unknown[i]];
        y[f->size] = 0.0;
    }
    for (s = 0; s < f->supers; s++) {
        yci_trapezoid t = yci_ldl_trapezoid(f, s);
        f->kernels->forward(&t, work, ldy, count, z, ldz);
    }
    for (r = 0; r < count; r++) {
        double *y = work + (size_t)r * ldy;
        y[f->size] = 0.0;
        if (!f->spd) yci_ldl_divide(f, y);
    }
    for (s = f->supers - 1; s >= 0; s--) {
        yci_trapezoid t = yci_ldl_trapezoid(f, s);
        f->kernels->backward(&t, work, ldy, count, z, ldz);
    }
    for (r = 0; r < count; r++)
        for (i = 0; i < f->size; i++) x[(size_t)r * ldx + (size_t)f->unknown[i]] = work[(size_t)r * ldy + (size_t)i];
}

/* The same for any number of them; `work` is for the smaller of count and YCI_RIGHT. */
static void yci_ldl_solve(const yci_ldl *f, double *x, int count, int ldx, double *work) {
    int k;
    for (k = 0; k < count; k += YCI_RIGHT)
        yci_ldl_solve_some(f, x + (size_t)k * (size_t)ldx, yci_min_int(count - k, YCI_RIGHT), (size_t)ldx, work);
}

/* --------------------------------------------------------------------------------------------------- incomplete --- */

/* A ~ L L' on the pattern of A between the included nodes, and on so many levels of fill beyond it (0: none), block row
 * by block row (Saad, Iterative Methods for Sparse Linear Systems, 10.3, with blocks for entries). A pivot block that
 * is not positive definite restarts the factorisation with the diagonal blocks of A times 1 + shift (after Manteuffel,
 * Math. Comp. 34, 1980), by decades: a shift of 1e-3 where 1e-6 will do takes ten times the iterations in knits, whose
 * yarn is that much stiffer along itself than any other way. After YCI_IC_RAISES raises, 1e-6 to 1, only the diagonal
 * blocks are kept. */
#define YCI_IC_RAISES 7

typedef struct yci_ic {
    yci_context *c;
    const yci_kernels *kernels;
    int count;
    int *node, *off, *dim; /* per included node, in order: node of the matrix, its first unknown, its unknowns */
    int *ptr, *col;        /* count + 1: blocks left of the diagonal, ascending positions */
    int *source;           /* what they are in the matrix, turned round: its blocks are by rows; -1: fill */
    int *diag;             /* count: the diagonal's block in the matrix */
    size_t *at, *corner;   /* first value of each block of L, and of each inverse diagonal block, both by columns */
    double *val;
    int *down_ptr, *down, *row; /* of every column its blocks below the diagonal and their rows, the last one first */
    double *y;                  /* [YCI_BLOCK_MAX count] */
    int *mark;                  /* count: block of the current row in this column, or -1 */
    double shift;               /* what the last factorisation needed; 0: nothing */
    int diagonal_only;          /* 1 when even the last shift failed */
} yci_ic;

static void yci_ic_destroy(yci_ic *f) {
    yci_context *c;
    if (!f) return;
    c = f->c;
    yci_free(c, f->node), yci_free(c, f->off), yci_free(c, f->dim), yci_free(c, f->ptr), yci_free(c, f->col);
    yci_free(c, f->source), yci_free(c, f->diag), yci_free(c, f->at), yci_free(c, f->corner), yci_free(c, f->val);
    yci_free(c, f->mark), yci_free(c, f->down_ptr), yci_free(c, f->down), yci_free(c, f->row), yci_free(c, f->y);
    yci_free(c, f);
}

/* Which blocks L has, by columns: below the diagonal of column k the rows row[ptr[k]..ptr[k + 1]), as they came, and
 * how many levels of fill each is from the matrix. */
typedef struct yci_ic_pattern {
    int *ptr, *row, *level, *left, *mark; /* left, mark: count each; the row at hand: its columns, and levels + 1 */
    int count, capacity, levels, level_capacity;
} yci_ic_pattern;

static void yci_ic_pattern_free(yci_context *c, yci_ic_pattern *p) {
    yci_free(c, p->ptr), yci_free(c, p->row), yci_free(c, p->level), yci_free(c, p->left), yci_free(c, p->mark);
}

/* Adds node j of the order to row i; `lefts` is the number of its columns, ascending, which node j follows or joins. */
static int yci_ic_reach(yci_context *c, yci_ic_pattern *p, int i, int j, int level, int *lefts) {
    int slot = *lefts;
    if (p->mark[j]) {
        if (p->mark[j] > level + 1) p->mark[j] = level + 1;
        return 1;
    }
    p->mark[j] = level + 1;
    if (j > i) {
        if (!YCI_RESERVE(c, p->row, p->capacity, p->count, p->count + 1)) return 0;
        p->row[p->count++] = j;
        return 1;
    }
    for (; slot > 0 && p->left[slot - 1] > j; slot--) p->left[slot] = p->left[slot - 1];
    p->left[slot] = j, ++*lefts;
    return 1;
}

/* Row i, by symmetry column i: what the matrix has there, and what its columns bring along (Saad, 10.3.3). */
static int yci_ic_pattern_row(yci_context *c, yci_ic_pattern *p, const yci_bsr *m, const int *pos, int v, int fill) {
    int i = pos[v], k, e, lefts = 0;
    p->ptr[i] = p->count, p->mark[i] = 1;
    for (k = m->ptr[v]; k < m->ptr[v + 1]; k++)
        if (pos[m->col[k]] >= 0 && !yci_ic_reach(c, p, i, pos[m->col[k]], 0, &lefts)) return 0;
    for (k = 0; k < lefts && fill > 0; k++)
        for (e = p->ptr[p->left[k]]; e < p->ptr[p->left[k] + 1]; e++) {
            int level = p->mark[p->left[k]] + p->level[e];
            if (level <= fill && !yci_ic_reach(c, p, i, p->row[e], level, &lefts)) return 0;
        }
    if (!YCI_RESERVE(c, p->level, p->level_capacity, p->ptr[i], p->count)) return 0;
    for (e = p->ptr[i]; e < p->count; e++) p->level[e] = p->mark[p->row[e]] - 1, p->mark[p->row[e]] = 0;
    for (k = 0; k < lefts; k++) p->mark[p->left[k]] = 0;
    p->mark[i] = 0, p->ptr[i + 1] = p->count;
    return 1;
}

static int yci_ic_pattern_make(
    yci_context *c, yci_ic_pattern *p, const yci_bsr *m, const int *pos, const int *node, int count, int fill) {
    int i;
    memset(p, 0, sizeof *p);
    p->ptr = YCI_NEW(c, int, (size_t)count + 1), p->left = YCI_NEW(c, int, count), p->mark = YCI_NEW(c, int, count);
    if (!p->ptr || !p->left || !p->mark) return 0;
    for (i = 0; i < count; i++)
        if (!yci_ic_pattern_row(c, p, m, pos, node[i], fill)) return 0;
    return 1;
}

/* Lays out L: rows are what columns are not. */
static void yci_ic_layout(yci_ic *f, const yci_bsr *m, const yci_ic_pattern *p) {
    size_t values = 0;
    int i, k;
    for (i = 0; i < f->count; i++) f->off[i] = m->off[f->node[i]], f->dim[i] = m->dim[f->node[i]];
    for (i = 0; i < f->count; i++) f->diag[i] = m->diag[f->node[i]];
    for (k = 0; k < p->count; k++) f->ptr[p->row[k] + 1]++;
    for (i = 0; i < f->count; i++) f->ptr[i + 1] += f->ptr[i], f->mark[i] = f->ptr[i];
    for (i = 0; i < f->count; i++)
        for (k = p->ptr[i]; k < p->ptr[i + 1]; k++) {
            int slot = f->mark[p->row[k]]++;
            f->col[slot] = i, f->source[slot] = p->level[k] ? -1 : yci_bsr_find(m, f->node[i], f->node[p->row[k]]);
        }
    for (i = 0; i < f->count; i++) {
        for (k = f->ptr[i]; k < f->ptr[i + 1]; k++)
            f->at[k] = values, values += (size_t)(f->dim[i] * f->dim[f->col[k]]);
        f->corner[i] = values, values += (size_t)(f->dim[i] * f->dim[i]);
    }
    f->corner[f->count] = values;
    memcpy(f->down_ptr, p->ptr, ((size_t)f->count + 1) * sizeof *p->ptr);
    for (i = 0; i < f->count; i++) f->mark[i] = f->down_ptr[i + 1]; /* ends, from which columns are filled back */
    for (i = 0; i < f->count; i++)
        for (k = f->ptr[i]; k < f->ptr[i + 1]; k++) f->row[--f->mark[f->col[k]]] = i, f->down[f->mark[f->col[k]]] = k;
    for (i = 0; i < f->count; i++) f->mark[i] = -1;
}

/* Prepares an incomplete factorisation of the rows and columns of `order[0..count)`, in that order, with `fill` levels
 * of fill. On failure *out is NULL. */
static yc_result yci_ic_create(yci_context *c, const yci_bsr *m, const int *order, int count, int fill, yci_ic **out) {
    yci_ic *f = YCI_NEW(c, yci_ic, 1);
    int *pos = YCI_NEW(c, int, m->n), i, ok = f && pos;
    yci_ic_pattern pattern;
    yc_result result = YC_OK;
    *out = NULL;
    memset(&pattern, 0, sizeof pattern);
    if (f) f->c = c, f->kernels = yci_kernels_best();
    if (ok) {
        f->count = count;
        f->node = YCI_NEW(c, int, count), f->off = YCI_NEW(c, int, count), f->dim = YCI_NEW(c, int, count);
        f->ptr = YCI_NEW(c, int, (size_t)count + 1), f->diag = YCI_NEW(c, int, count);
        f->mark = YCI_NEW(c, int, count), f->corner = YCI_NEW(c, size_t, (size_t)count + 1);
        f->down_ptr = YCI_NEW(c, int, (size_t)count + 1), f->y = YCI_NEW(c, double, (size_t)count *YCI_BLOCK_MAX);
        ok = f->node && f->off && f->dim && f->ptr && f->diag && f->mark && f->corner && f->down_ptr && f->y;
    }
    for (i = 0; ok && i < m->n; i++) pos[i] = -1;
    for (i = 0; ok && result == YC_OK && i < count; i++) {
        int v = order[i];
        if (v < 0 || v >= m->n || pos[v] >= 0)
            result = YCI_FAIL(
                c, YC_ERROR_ARGUMENT, "incomplete factorisation: order entry %d is %d, of %d nodes", i, v, m->n);
        else pos[v] = i, f->node[i] = v;
    }
    if (ok && result == YC_OK) ok = yci_ic_pattern_make(c, &pattern, m, pos, f->node, count, fill);
    yci_free(c, pos);
    if (ok && result == YC_OK) {
        f->col = YCI_NEW(c, int, pattern.count), f->source = YCI_NEW(c, int, pattern.count);
        f->at = YCI_NEW(c, size_t, pattern.count), f->down = YCI_NEW(c, int, pattern.count);
        f->row = YCI_NEW(c, int, pattern.count), ok = f->col && f->source && f->at && f->down && f->row;
    }
    if (ok && result == YC_OK) {
        yci_ic_layout(f, m, &pattern);
        f->val = YCI_NEW(c, double, f->corner[count] + YCI_BLOCK_MAX);
        ok = f->val != NULL;
    }
    yci_ic_pattern_free(c, &pattern);
    if (ok && result == YC_OK) {
        *out = f;
        return YC_OK;
    }
    yci_ic_destroy(f);
    return ok ? result : yci_out_of_memory(c, "an incomplete factorisation");
}

/* Factors the diagonal block of row i, scaled by 1 + shift before the row's blocks are subtracted, and keeps the
 * inverse of its Cholesky factor. The whole block is scaled, not its diagonal: that leaves its soft directions soft,
 * such as a yarn sliding along itself. */
static int yci_ic_pivot(yci_ic *f, const yci_bsr *m, int i, double shift) {
    const double *a = m->val + m->at[f->diag[i]], *from = a;
    double block[YCI_BLOCK_MAX * (YCI_BLOCK_MAX + 1)], *corner = f->val + f->corner[i];
    yci_block_terms t;
    int d = f->dim[i], k, j;
    for (k = 0; k < d * d && shift > 0.0; k++) block[k] = (1.0 + shift) * a[k], from = block;
    for (k = f->ptr[i], t.count = 0; k < f->ptr[i + 1] && !f->diagonal_only; k++) {
        if (t.count == YCI_BLOCK_TERMS) f->kernels->block(d, d, &t, from, NULL, block), from = block, t.count = 0;
        t.a[t.count] = t.b[t.count] = f->val + f->at[k], t.k[t.count++] = f->dim[f->col[k]];
    }
    f->kernels->block(d, d, &t, from, NULL, block);
    if (!yci_block_cholesky(d, block, a, d + 1)) return 0;
    yci_block_invert_lower(d, block, corner);
    for (k = 0; k < d; k++)
        for (j = 0; j < k; j++) corner[d * j + k] = corner[d * k + j], corner[d * k + j] = 0.0;
    return 1;
}

/* Blocks of row i: L(i,j) = (A(i,j) - sum over k < j of L(i,k) L(j,k)') inverse(G(j)'). */
static void yci_ic_row(yci_ic *f, const yci_bsr *m, int i) {
    static const double nothing[YCI_BLOCK_MAX * YCI_BLOCK_MAX] = {0.0};
    int d = f->dim[i], k, p;
    for (k = f->ptr[i]; k < f->ptr[i + 1]; k++) {
        int j = f->col[k];
        double *l = f->val + f->at[k];
        const double *rest = f->source[k] < 0 ? nothing : m->val + m->at[f->source[k]];
        yci_block_terms t;
        for (p = f->ptr[j], t.count = 0; p < f->ptr[j + 1]; p++) {
            int other = f->mark[f->col[p]];
            if (other < 0) continue;
            if (t.count == YCI_BLOCK_TERMS) f->kernels->block(d, f->dim[j], &t, rest, NULL, l), rest = l, t.count = 0;
            t.a[t.count] = f->val + f->at[other], t.b[t.count] = f->val + f->at[p];
            t.k[t.count++] = f->dim[f->col[p]];
        }
        f->kernels->block(d, f->dim[j], &t, rest, f->val + f->corner[j], l);
        f->mark[j] = k;
    }
    for (k = f->ptr[i]; k < f->ptr[i + 1]; k++) f->mark[f->col[k]] = -1;
}

/* Returns the row whose pivot failed, or -1. */
static int yci_ic_attempt(yci_ic *f, const yci_bsr *m, double shift) {
    int i;
    for (i = 0; i < f->count; i++) {
        if (!f->diagonal_only) yci_ic_row(f, m, i);
        if (!yci_ic_pivot(f, m, i, shift)) return i;
    }
    return -1;
}

/* Factors m, which has the pattern given at creation. f->shift and f->diagonal_only tell what it took. Fails only when
 * a diagonal block itself is not positive definite; then there is no factor. */
static yc_result yci_ic_factor(yci_ic *f, const yci_bsr *m) {
    static const double shifts[YCI_IC_RAISES + 1] = {0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0};
    int raise, bad;
    f->diagonal_only = 0;
    for (raise = 0; raise <= YCI_IC_RAISES; raise++) {
        f->shift = shifts[raise];
        if (yci_ic_attempt(f, m, f->shift) < 0) return YC_OK;
    }
    f->diagonal_only = 1, f->shift = 0.0;
    memset(f->val, 0, f->corner[f->count] * sizeof *f->val);
    bad = yci_ic_attempt(f, m, 0.0);
    if (bad < 0) return YC_OK;
    return YCI_FAIL(f->c, YC_ERROR_NOT_SPD, "the diagonal block of node %d is not positive definite", f->node[bad]);
}

/* x := inverse(L L') x, on the matrix's numbering; unknowns of nodes not included keep their values. */
static void yci_ic_solve(const yci_ic *f, double *x) {
    yci_substitution t;
    int i, r;
    t.count = f->count, t.dim = f->dim, t.ptr = f->ptr, t.col = f->col, t.at = f->at, t.corner = f->corner;
    t.down_ptr = f->down_ptr, t.down = f->down, t.row = f->row, t.val = f->val, t.y = f->y;
    for (i = 0; i < f->count; i++)
        for (r = 0; r < f->dim[i]; r++) t.y[YCI_BLOCK_MAX * (size_t)i + (size_t)r] = x[f->off[i] + r];
    f->kernels->substitute(&t);
    for (i = 0; i < f->count; i++)
        for (r = 0; r < f->dim[i]; r++) x[f->off[i] + r] = t.y[YCI_BLOCK_MAX * (size_t)i + (size_t)r];
}

/* ------------------------------------------------------------------------------------------------------- public --- */

struct yc_chol {
    yci_context context;
    int n, block, lower; /* lower: the pattern holds nothing above the diagonal */
    size_t entries;
    yci_ldl *ldl;
    double *work;
};

YC_API void yc_chol_options_default(yc_chol_options *options) {
    if (!options) return;
    options->kind = YC_CHOL_SPD;
    options->block = 1;
    options->order = options->stage = NULL;
    options->shift = 0.0;
}

YC_API void yc_chol_destroy(yc_chol *chol) {
    yci_context c;
    if (!chol) return;
    yci_ldl_destroy(chol->ldl);
    yci_free(&chol->context, chol->work);
    c = chol->context;
    yci_free(&c, chol);
}

/* Whether the entries of a row from the given one on ascend, within 0 to n - 1; `k` becomes the first that does not. */
static int yci_chol_ascends(int n, const int *col, int begin, int end, int *k) {
    int i, wrong = 0;
    for (i = begin + 1; i < end; i++) wrong |= col[i] <= col[i - 1];
    *k = begin;
    if (begin == end || (!wrong && col[begin] >= 0 && col[end - 1] < n)) return 1;
    while (col[*k] >= 0 && col[*k] < n && (*k == begin || col[*k] > col[*k - 1])) ++*k;
    return 0;
}

/* A pattern is right when its rows ascend without duplicates and it is lower, or mirrored in full. `shared` (n) becomes
 * how many entries every row has in common with the one before, all of the shorter one or none. At last `cursor` (n)
 * walks every row once: entry (i, j) must find (j, i) next in row j. */
static yc_result yci_chol_check(
    yci_context *c, int n, const int *ptr, const int *col, int *shared, int *cursor, int *lower) {
    int i, k, upper = 0, length = 0;
    if (ptr[0] != 0) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yc_chol_analyze: ptr[0] is %d", ptr[0]);
    for (i = 0; i < n; i++)
        if (ptr[i + 1] < ptr[i])
            return YCI_FAIL(
                c, YC_ERROR_ARGUMENT, "yc_chol_analyze: ptr[%d] is %d, after %d", i + 1, ptr[i + 1], ptr[i]);
    for (i = 0; i < n; i++) {
        int begin = ptr[i], end = ptr[i + 1], same = end - begin < length ? end - begin : length;
        if (same &&
            (col[begin] != col[begin - length] ||
                memcmp(col + begin, col + begin - length, (size_t)same * sizeof *col) != 0))
            same = 0;
        if (!yci_chol_ascends(n, col, begin + (same ? same - 1 : 0), end, &k)) {
            if (col[k] < 0 || col[k] >= n)
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yc_chol_analyze: col[%d] is %d, n is %d", k, col[k], n);
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yc_chol_analyze: row %d is not ascending: %s %d at col[%d]", i,
                col[k] == col[k - 1] ? "duplicate" : "unsorted", col[k], k);
        }
        upper |= end > begin && col[end - 1] > i;
        shared[i] = same, cursor[i] = begin, length = end - begin;
    }
    *lower = !upper;
    for (i = 0; upper && i < n; i++)
        for (k = ptr[i]; k < ptr[i + 1]; k++) {
            int j = col[k];
            if (cursor[j] >= ptr[j + 1] || col[cursor[j]++] != i)
                return YCI_FAIL(c, YC_ERROR_ARGUMENT,
                    "yc_chol_analyze: (%d, %d) and (%d, %d) are not both there, "
                    "and the pattern is not lower",
                    i, j, j, i);
        }
    return YC_OK;
}

/* What becomes a yci_ldl_entries; every block has a run. */
typedef struct yci_chol_blocks {
    int b, count, run_count;
    const int *ptr, *col; /* of the caller */
    int *begin, *node, *first_run;
    yci_ldl_run *run;
} yci_chol_blocks;

static yci_ldl_run *yci_chol_run(yci_chol_blocks *m, int from, int to, int rows, int count) {
    yci_ldl_run *run = m->run + m->run_count++;
    run->from = from, run->to = to, run->stride = 0;
    run->rows = (unsigned char)rows, run->count = (unsigned char)count, run->grow = 0, run->flip = 1;
    return run;
}

/* The block of nodes i and j, row by row. `at` is where the rows of i have come to. */
static void yci_chol_block(yci_chol_blocks *m, int i, int j, int *at) {
    int a, count, b = m->b;
    m->node[m->count] = j, m->first_run[m->count++] = m->run_count;
    for (a = 0; a < b; a++) {
        int row = b * i + a, limit = j < i ? b * (j + 1) : row + 1, end = m->ptr[row + 1];
        for (; at[a] < end && m->col[at[a]] < limit; at[a] += count) {
            const int *col = m->col + at[a];
            for (count = 1; at[a] + count < end && col[count] == *col + count && col[count] < limit;) count++;
            yci_chol_run(m, at[a], 8 * a + *col - b * j, 1, count);
        }
    }
    if (m->run_count == m->first_run[m->count - 1]) yci_chol_run(m, 0, 0, 0, 0);
    m->run[m->run_count - 1].flip = 0;
}

/* The blocks of node i if all of its rows begin with the same `off` entries and these are whole blocks, as one run
 * each; otherwise returns 0. */
static int yci_chol_whole(yci_chol_blocks *m, int i, int off, const int *shared, int grow) {
    int b = m->b, a, k, begin = m->ptr[b * i], stride = m->ptr[b * i + 1] - begin;
    int count = m->count, runs = m->run_count;
    const int *row = m->ptr + b * i;
    for (a = 1; a < b; a++)
        if (shared[b * i + a] < off || row[a + 1] - row[a] != stride + a * grow ||
            (off < row[a + 1] - row[a] && m->col[row[a] + off] < b * i)) /* more left of the block than the first */
            return 0;
    for (k = begin; k < begin + off; k += b) {
        int j = b == 1 ? m->col[k] : m->col[k] / b;
        yci_ldl_run *run;
        if (begin + off - k < b || m->col[k] != j * b || m->col[k + b - 1] != j * b + b - 1) {
            m->count = count, m->run_count = runs;
            return 0;
        }
        m->node[m->count] = j, m->first_run[m->count++] = m->run_count;
        run = yci_chol_run(m, k, 0, b, b);
        run->stride = stride, run->grow = (unsigned char)grow, run->flip = 0;
    }
    return 1;
}

/* All blocks; `shared` is as of yci_chol_check. */
static void yci_chol_scan(yci_chol_blocks *m, int nodes, const int *shared, int lower) {
    int i, a, b = m->b, at[YCI_BLOCK_MAX];
    for (i = 0; i < nodes; i++) {
        const int *row = m->ptr + b * i;
        int off = row[1] - row[0];
        while (off && m->col[row[0] + off - 1] >= b * i) off--;
        m->begin[i] = m->count;
        if (yci_chol_whole(m, i, off, shared, lower))
            for (a = 0; a < b; a++) at[a] = row[a] + off;
        else {
            int j;
            for (a = 0; a < b; a++) at[a] = row[a];
            do {
                for (a = 0, j = i; a < b; a++)
                    if (at[a] < row[a + 1] && m->col[at[a]] / b < j) j = m->col[at[a]] / b;
                if (j < i) yci_chol_block(m, i, j, at);
            } while (j < i);
        }
        yci_chol_block(m, i, i, at);
    }
    m->begin[nodes] = m->count;
}

/* The number of blocks if they are single values and hold all of the diagonal, or else 0: entries are as good then. */
static size_t yci_chol_plain(const yc_chol *chol, const int *ptr, const int *col) {
    size_t count = 0;
    int i, k;
    for (i = 0; i < chol->n; i++) {
        for (k = ptr[i + 1]; k > ptr[i] && col[k - 1] > i;) k--;
        if (chol->block > 1 || k == ptr[i] || col[k - 1] != i) return 0;
        count += (size_t)(k - ptr[i]);
    }
    return count;
}

/* The full symmetric pattern. */
static void yci_chol_graph(const yci_ldl_entries *m, int nodes, int *ptr, int *col) {
    const int *begin = m->begin, *node = m->node;
    int i, k, total = 0;
    for (i = 0; i < nodes; i++) ptr[i] = 1;
    for (i = 0; i < nodes; i++)
        for (k = begin[i]; node[k] < i; k++) ptr[i]++, ptr[node[k]]++;
    for (i = 0; i < nodes; i++) k = ptr[i], ptr[i] = total, total += k;
    for (i = 0; i < nodes; i++) {
        for (k = begin[i]; node[k] < i; k++) col[ptr[i]++] = node[k], col[ptr[node[k]]++] = i;
        col[ptr[i]++] = i;
    }
    for (i = nodes; i > 0; i--) ptr[i] = ptr[i - 1]; /* ends become beginnings */
    ptr[0] = 0;
}

static yc_result yci_chol_build(
    yc_chol *chol, const int *ptr, const int *col, const int *shared, const yc_chol_options *options) {
    yci_context *c = &chol->context;
    int b = options->block, nodes = chol->n / b, ok = 1, i, *block = NULL, *graph = NULL, *dim;
    size_t size = (size_t)nodes, most = 0, count = yci_chol_plain(chol, ptr, col);
    yci_chol_blocks m;
    yci_ldl_entries given;
    yc_result result = YC_ERROR_MEMORY;
    memset(&m, 0, sizeof m);
    given.begin = ptr, given.node = col, given.first_run = NULL, given.run = NULL, given.run_count = count;
    if (!count) {
        for (i = 0; i < nodes; i++) most += (size_t)(ptr[b * (i + 1)] - ptr[b * i] + 2);
        m.b = b, m.ptr = ptr, m.col = col;
        block = YCI_RAW(c, int, size + 1 + 2 * most), m.run = YCI_RAW(c, yci_ldl_run, most);
        ok = block && m.run;
        if (ok) {
            m.begin = block, m.node = m.begin + nodes + 1, m.first_run = m.node + most;
            yci_chol_scan(&m, nodes, shared, chol->lower);
            given.begin = m.begin, given.node = m.node, given.first_run = m.first_run, given.run = m.run;
            given.run_count = (size_t)m.run_count, count = (size_t)m.count;
        }
    }
    if (ok && count < INT_MAX / 2) graph = YCI_RAW(c, int, size + 1 + 2 * count);
    if (graph) {
        dim = graph + 2 * count + 1;
        yci_chol_graph(&given, nodes, graph, graph + nodes + 1);
        for (i = 0; i < nodes; i++) dim[i] = b;
        result = yci_ldl_analyze(c, nodes, dim, graph, graph + nodes + 1, &given, options->order, options->stage,
            options->kind == YC_CHOL_SPD, &chol->ldl);
        if (result == YC_OK && !(chol->work = YCI_RAW(c, double, yc_chol_work(chol)))) result = YC_ERROR_MEMORY;
        if (result == YC_OK) chol->ldl->shift = options->shift;
    }
    yci_free(c, block), yci_free(c, m.run), yci_free(c, graph);
    return result == YC_ERROR_MEMORY ? yci_out_of_memory(c, "a sparse factorisation") : result;
}

YC_API yc_result yc_chol_analyze(
    const yc_host *host, int n, const int *ptr, const int *col, const yc_chol_options *options, yc_chol **out) {
    yci_context c;
    yc_chol_options defaults;
    yc_chol *chol;
    int *shared, nodes, i;
    yc_result result;
    if (!out) return YC_ERROR_ARGUMENT;
    *out = NULL;
    yc_chol_options_default(&defaults);
    if (!options) options = &defaults;
    result = yci_context_init(&c, host);
    if (result == YC_OK && (n < 0 || !ptr || (n && ptr[n] && !col)))
        result =
            YCI_FAIL(&c, YC_ERROR_ARGUMENT, "yc_chol_analyze: n is %d%s", n, n < 0 ? "" : ", a pattern array is NULL");
    if (result == YC_OK &&
        (options->block < 1 || options->block > YCI_BLOCK_MAX || n % options->block ||
            (options->kind != YC_CHOL_SPD && options->kind != YC_CHOL_QUASIDEFINITE)))
        result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "yc_chol_analyze: kind is %d, block is %d, n is %d",
            (int)options->kind, options->block, n);
    if (result == YC_OK && !(options->shift >= 0.0 && options->shift <= DBL_MAX))
        result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "yc_chol_analyze: shift is %g", options->shift);
    nodes = result == YC_OK && options->stage ? n / options->block : 0;
    for (i = 0; result == YC_OK && i < nodes; i++)
        if (options->stage[i] < 0 || options->stage[i] >= nodes)
            result = YCI_FAIL(
                &c, YC_ERROR_ARGUMENT, "yc_chol_analyze: stage[%d] is %d, of %d nodes", i, options->stage[i], nodes);
    if (result == YC_OK && !(chol = YCI_NEW(&c, yc_chol, 1))) result = yci_out_of_memory(&c, "a factorisation");
    if (result != YC_OK) {
        yci_log(&c, "%s", c.message);
        return result;
    }
    chol->context = c, chol->n = n, chol->block = options->block, chol->entries = (size_t)ptr[n];
    shared = YCI_RAW(&chol->context, int, 2 * (size_t)n);
    result = shared ? yci_chol_check(&chol->context, n, ptr, col, shared, shared + n, &chol->lower)
                    : yci_out_of_memory(&chol->context, "a pattern");
    if (result == YC_OK) result = yci_chol_build(chol, ptr, col, shared, options);
    yci_free(&chol->context, shared);
    if (result == YC_OK) {
        *out = chol;
        return YC_OK;
    }
    yci_log(&chol->context, "%s", chol->context.message);
    yc_chol_destroy(chol);
    return result;
}

/* The first value that is not finite, or `entries`; only those of the runs count. A sum of 0 * x is NaN when one of
 * them is not finite. */
static size_t yci_chol_not_finite(const yc_chol *chol, const double *values) {
    const yci_ldl *f = chol->ldl;
    size_t k, first = chol->entries;
    int i, a, r;
    double sum[4] = {0.0, 0.0, 0.0, 0.0}; /* at the same time, to hide an addition's time */
    for (k = 0; k + 4 <= first; k += 4)
        for (i = 0; i < 4; i++) sum[i] += 0.0 * values[k + (size_t)i];
    for (; k < first; k++) sum[0] += 0.0 * values[k];
    if (sum[0] + sum[1] + sum[2] + sum[3] == 0.0) return first;
    for (r = 0; r < f->super[f->supers].run; r++) {
        const yci_ldl_run *run = f->run + r;
        int from = run->from, stride = run->stride;
        for (a = 0; a < run->rows; a++, from += stride, stride += run->grow)
            for (i = from; i < from + run->count; i++)
                if (!(fabs(values[i]) <= DBL_MAX) && (size_t)i < first) first = (size_t)i;
    }
    return first;
}

YC_API yc_result yc_chol_factor(yc_chol *chol, const double *values) {
    size_t k;
    if (!chol) return YC_ERROR_ARGUMENT;
    if (chol->entries && !values) return YCI_FAIL(&chol->context, YC_ERROR_ARGUMENT, "yc_chol_factor: values is NULL");
    k = yci_chol_not_finite(chol, values);
    if (k < chol->entries)
        return YCI_FAIL(&chol->context, YC_ERROR_ARGUMENT, "yc_chol_factor: values[%.0f] is %g", (double)k, values[k]);
    return yci_ldl_factor(chol->ldl, values);
}

YC_API size_t yc_chol_work(const yc_chol *chol) {
    return chol ? yci_ldl_work(chol->ldl, YCI_RIGHT) + 2 * (size_t)chol->n : 0;
}

YC_API yc_result yc_chol_solve_with(const yc_chol *chol, double *x, int count, int ldx, double *work) {
    if (!chol || !chol->ldl->factored || count < 0 || ldx < chol->n || (count && chol->n && (!x || !work)))
        return YC_ERROR_ARGUMENT;
    yci_ldl_solve(chol->ldl, x, count, ldx, work);
    return YC_OK;
}

YC_API yc_result yc_chol_solve(const yc_chol *chol, double *x, int count, int ldx) {
    return chol ? yc_chol_solve_with(chol, x, count, ldx, chol->work) : YC_ERROR_ARGUMENT;
}

/* r = b - A x from the lower triangle. Returns |r| / (|A| |x| + |b|). */
static double yci_chol_residual(int n, const int *ptr, const int *col, const double *values, const double *b,
    const double *x, double *r, double *sum) {
    double most = 0.0, matrix = 0.0, largest = 0.0, right = 0.0;
    int i, k;
    for (i = 0; i < n; i++) {
        r[i] = b[i], sum[i] = 0.0;
        right = yci_max(right, fabs(b[i])), largest = yci_max(largest, fabs(x[i]));
    }
    for (i = 0; i < n; i++)
        for (k = ptr[i]; k < ptr[i + 1] && col[k] <= i; k++) {
            int j = col[k];
            r[i] -= values[k] * x[j], sum[i] += fabs(values[k]);
            if (j < i) r[j] -= values[k] * x[i], sum[j] += fabs(values[k]);
        }
    for (i = 0; i < n; i++) {
        if (!(fabs(r[i]) <= most)) most = fabs(r[i]);
        if (most != most) return most;
        matrix = yci_max(matrix, sum[i]);
    }
    return most == 0.0 ? 0.0 : most / (matrix * largest + right);
}

YC_API yc_result yc_chol_refine(const yc_chol *chol, const int *ptr, const int *col, const double *values,
    const double *b, double *x, int steps, double *error, double *work) {
    double *r, *other, before, after;
    int i, n, step;
    if (!chol || !chol->ldl->factored || !ptr || steps < 0 || (chol->entries && (!col || !values)) ||
        (chol->n && (!b || !x)))
        return YC_ERROR_ARGUMENT;
    if (!work) work = chol->work;
    n = chol->n, r = work + yci_ldl_work(chol->ldl, YCI_RIGHT), other = r + n;
    before = yci_chol_residual(n, ptr, col, values, b, x, r, other);
    for (step = 0; step < steps && before > 0.0; step++, before = after) {
        yci_ldl_solve(chol->ldl, r, 1, n, work);
        for (i = 0; i < n; i++) r[i] += x[i];
        after = yci_chol_residual(n, ptr, col, values, b, r, other, work);
        if (!(after <= 0.5 * before)) break;
        for (i = 0; i < n; i++) x[i] = r[i], r[i] = other[i];
    }
    if (error) *error = before;
    return YC_OK;
}

YC_API yc_result yc_chol_order(const yc_chol *chol, int *order) {
    int k;
    if (!chol || (chol->n && !order)) return YC_ERROR_ARGUMENT;
    for (k = 0; k < chol->ldl->size; k += chol->block) order[k / chol->block] = chol->ldl->unknown[k] / chol->block;
    return YC_OK;
}

YC_API yc_result yc_chol_stats(const yc_chol *chol, yc_chol_statistics *out) {
    int s;
    if (!chol || !out) return YC_ERROR_ARGUMENT;
    out->nonzeros = chol->ldl->nonzeros, out->flops = chol->ldl->flops, out->supernodes = chol->ldl->supers;
    out->pivots = chol->ldl->pivots, out->bytes = chol->context.bytes;
    for (s = 0, out->shifted = 0; s < out->supernodes; s++) out->shifted += chol->ldl->super[s].repaired;
    return YC_OK;
}

YC_API const char *yc_chol_message(const yc_chol *chol) { return chol ? chol->context.message : "chol is NULL"; }

/* =====================================================================================================================
 * >>fabric   (chapter 5)
 *
 * Lays a weave over a sewing pattern. A yarn is a list of visits (node, arc length u). A crossing is a node with two
 * visits, one of a warp and one of a weft; a lone node has one visit, whose u is a held label.
 *
 * Frame. The pattern is turned by minus the grain, so that warps are lines at constant frame[0] and wefts at constant
 * frame[1]; line k of family f lies at origin[f] + (k + 1/2) spacing[f]. A piece is a set of triangles connected across
 * edges that are one edge on the mesh and in UV; its outline is what is left of its edges, free (one triangle on the
 * mesh) or a welded seam (two). Each piece has its own lattice, centred in its bounding box; the rectangle that is laid
 * without a mesh is two triangles with the lattice's origin at its corner.
 *
 * Clipping. A line meets an outline edge whose ends lie at lo < line <= hi; by this half-open rule the cuts of a line
 * alternate between entering and leaving, whatever vertices it passes through. Each pair of cuts is a span, each span
 * becomes a yarn:
 *   - it ends in a lone node on the outline, where its tail (from the last crossing) is at least 0.3 spacings long at a
 *     seam or selvedge, 0.05 at a cut edge;
 *   - shorter, seam or cut edge: it lets go of its last crossing and ends on the outline, so that it reaches that
 *     without a tiny segment; the crossing becomes a lone node of the other yarn;
 *   - shorter, selvedge: it ends at its last crossing.
 * So at a cut edge every yarn has a tail, which can slide out of its last crossing; at a selvedge last crossings are
 * held. A yarn that crosses no other would fall off: it is not made, and neither is one with fewer than two visits.
 *
 * Crimp. A yarn of family f passes height[f] over or under its crossings. Where it changes sides, over a spacing p of
 * the other family, it falls from crest to trough by 2 height[f] on a length of sqrt(p^2 + kappa (2 height[f])^2), with
 * kappa = 9/8: for small crimp that is Peirce's (1937) 2 height = (4/3) p sqrt(crimp). The straight segments of floats
 * count in: height[f] is such that the mean of all lengths in a repeat is 1 + crimp[f] spacings. u sums them.
 *
 * Rods. Seam edges chain up between branching points; along each chain the yarn ends of both sides, in order, are
 * visited by a rod. Its u is the arc length along the seam, by the mean of both sides' pattern lengths. Ends closer
 * than 0.05 spacings (often: equal pieces have equal lattices) are first moved apart along the seam to that distance,
 * so that no segment of the rod is tiny and the rod still starts at rest. Where there is no room to move them, the
 * rod's rest length is the greater. A rod along a closed chain is open between its last and first end.
 *
 * Drafts come by rule, from a loom's parts, or from a Weaving Information File, which is read twice: for its sizes,
 * then into matrices of the loom.
 *
 * Charts are read line by line into rows of items: stitches, how often; brackets are written out, a row's one repeat
 * stays one. Knitting works them stitch by stitch on a needle of loops (yci_knit_loop): what is drawn through what, in
 * which order, from the front, all turned to how it looks from the right side. A bar that m1 lifts becomes a loop of
 * its row after the fact. Springs then place the loops' bases; nodes, visits and contacts follow from loops alone, see
 * yc_knit. Over a pattern, a piece of knitting that covers an island is laid flat in its frame; nodes are looked up in
 * triangles, segments of yarn cut by the outline, by a grid of cells as large as stitches, and what is inside goes into
 * the weaver, which makes the rods.
 *
 * Promises: the result depends on nothing but the inputs; time is linear in triangles, crossings and yarns, but for the
 * sorting of the cuts; working memory is freed before return, and the network is one block.
 * ===================================================================================================================== */

#define YCI_DESC_COOKIE 0x7961726eu
#define YCI_WEAVE_LIMIT 100000000 /* nodes of one network, lines of one piece */
#define YCI_WEAVE_TAIL 0.3        /* spacings; a shorter tail is not kept at a seam or selvedge */
#define YCI_WEAVE_STUB 0.05       /* spacings; nor such a one at a cut edge */
#define YCI_WEAVE_GAP 0.05        /* spacings, between neighbouring visits of a rod */
#define YCI_CRIMP_KAPPA 1.125     /* Peirce's, see Crimp above; chapter yarn measures lengths with it */

static int yci_finite(double x) { return x - x == 0.0; }

YC_API yc_yarn_material yc_yarn_material_default(void) {
    yc_yarn_material m;
    m.stretch = 50.0, m.bending = 3e-9, m.density = 15e-6, m.radius = 72e-6;
    m.shear = 4e-3, m.shear_limit = 0.9, m.contact = 1.0, m.friction = 0.3, m.slide = 100.0;
    m.preload = 0.0, m.crimp_bending = m.bending, m.strength = 0.0, m.flattening = 0.0;
    m.wrap = 3e-3, m.stitch = m.stretch;
    return m;
}

YC_API yc_triangle_material yc_triangle_material_default(void) {
    yc_triangle_material m;
    m.density = 0.12, m.stretch[0] = m.stretch[1] = 2000.0;
    m.coupling = 0.0, m.shear = 60.0, m.bending = 8e-6;
    return m;
}

YC_API yc_weave_desc yc_weave_desc_default(void) {
    yc_weave_desc d;
    memset(&d, 0, sizeof d);
    d.cookie = YCI_DESC_COOKIE;
    d.spacing[0] = d.spacing[1] = 2.5e-3;
    d.repeat[0] = d.repeat[1] = 2;
    d.warp = d.weft = d.rod = yc_yarn_material_default();
    d.rod.density *= 2.0;
    d.bundle = 1;
    d.size[0] = d.size[1] = 0.2;
    return d;
}

static const unsigned char yci_draft_tabby[4] = {1, 0, 0, 1};

/* The share of a family's spacings over which its yarns change sides, in a draft of n columns and rows. */
static double yci_weave_changes(const unsigned char *draft, const int n[2], int family) {
    int r, c, changes = 0;
    for (r = 0; r < n[1]; r++)
        for (c = 0; c < n[0]; c++) {
            int next = family == YC_WARP ? (r + 1) % n[1] * n[0] + c : r * n[0] + (c + 1) % n[0];
            changes += !draft[r * n[0] + c] != !draft[next];
        }
    return (double)changes / n[0] / n[1];
}

/* The length of a yarn where it changes sides, in spacings; 1 where none does. */
static double yci_weave_length(const unsigned char *draft, const int n[2], int family, double crimp) {
    double changes = yci_weave_changes(draft, n, family);
    return changes > 0.0 ? 1.0 + crimp / changes : 1.0;
}

/* A family's yarns, with what yc_weave_material needs of them averaged over their order. */
static yc_yarn_material yci_weave_mean(const yc_weave_desc *d, int family) {
    yc_yarn_material mean = family == YC_WARP ? d->warp : d->weft;
    int i, count = d->order_count[family];
    if (!d->material_count || !d->order[family]) return mean;
    mean.stretch = mean.shear = mean.bending = mean.density = 0.0;
    for (i = 0; i < count; i++) {
        const yc_yarn_material *m = &d->materials[d->order[family][i]];
        mean.stretch += m->stretch / count, mean.shear += m->shear / count;
        mean.bending += m->bending / count, mean.density += m->density / count;
    }
    return mean;
}

YC_API yc_triangle_material yc_weave_material(const yc_weave_desc *desc) {
    yc_yarn_material warp = yci_weave_mean(desc, YC_WARP), weft = yci_weave_mean(desc, YC_WEFT);
    yc_triangle_material m;
    const unsigned char *draft = desc->draft ? desc->draft : yci_draft_tabby;
    double s0 = desc->spacing[0], s1 = desc->spacing[1], bind = 0.0, length[2];
    int f, tabby[2] = {2, 2};
    for (f = 0; f < 2; f++) {
        double changes = yci_weave_changes(draft, desc->draft ? desc->repeat : tabby, f);
        bind += 0.5 * changes, length[f] = changes > 0.0 ? 1.0 + desc->crimp[f] : 1.0;
    }
    m.density = warp.density * length[YC_WARP] / s0 + weft.density * length[YC_WEFT] / s1;
    m.stretch[0] = weft.stretch / s1, m.stretch[1] = warp.stretch / s0;
    m.coupling = 0.0;
    /* A crossing pays 1/2 k L phi^2 for each of its four pairs of segments, L the mean spacing, on an area of s0 s1. */
    m.shear = bind * 4.0 * 0.5 * (warp.shear + weft.shear) * 0.5 * (s0 + s1) / (s0 * s1);
    m.bending = 0.5 * (warp.bending / s0 + weft.bending / s1);
    return m;
}

/* k yarns as one, in a weave k times as wide. A segment of it stands for k segments of k yarns, a crossing for k^2, so
 * energies per segment and per crossing must grow by k^2 at the same strain, curvature, angle, density of mass.
 *   stretch, bending, mass   1/2 EA L w^2 and the like, where L grows by k: the coefficients by k
 *   shear                    1/2 k_x L phi^2: by k
 *   contact                  (k_c/d) g(d - L), where g is quadratic and the touching distance d grows by k: by k
 *   slide                    1/2 k_f s^2, and s stays: what a yarn slides, it slides past all crossings on its way. k^2
 *   preload                  friction of sliding lets go at s = mu N / k_f: k^2 too
 *   crimp_bending            about EI h^2 / L^3, where the height h grows by k like the radius: k^3
 *   strength                 k yarns at the tension of each: k
 *   flattening               1/2 k_t d^2, where d grows by k: it stays
 * The moment of friction, mu N times a share of the radius, should grow by k^2 as well; that of the preload grows by
 * k^3. Tension adds T kappa L to N where cloth is curved, which grows by k^2, and T h / L at a crimped crossing, which
 * grows by k: right for the moment and for crimp itself, too little by k for sliding. */
static void yci_yarn_bundle(yc_yarn_material *m, double k) {
    m->stretch *= k, m->bending *= k, m->density *= k, m->radius *= k, m->shear *= k, m->contact *= k;
    m->slide *= k * k, m->preload *= k * k, m->crimp_bending *= k * k * k, m->strength *= k;
}

/* ---- checks ------------------------------------------------------------------------------------------------------ */

static yc_result yci_yarn_material_check(yci_context *c, const char *owner, const yc_yarn_material *m) {
    static const char *const names[] = {"stretch", "density", "radius", "slide", "crimp_bending", "bending", "shear",
        "contact", "friction", "shear_limit", "preload", "strength", "flattening", "wrap", "stitch"};
    double values[15];
    int i;
    values[0] = m->stretch, values[1] = m->density, values[2] = m->radius, values[3] = m->slide;
    values[4] = m->crimp_bending, values[5] = m->bending, values[6] = m->shear, values[7] = m->contact;
    values[8] = m->friction, values[9] = m->shear_limit, values[10] = m->preload, values[11] = m->strength;
    values[12] = m->flattening, values[13] = m->wrap, values[14] = m->stitch;
    for (i = 0; i < 15; i++) {
        if (!yci_finite(values[i]))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s.%s = %g must be finite", owner, names[i], values[i]);
        if (i < 5 && values[i] <= 0.0)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s.%s = %g must be greater than 0", owner, names[i], values[i]);
        if (values[i] < 0.0)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s.%s = %g must not be negative", owner, names[i], values[i]);
    }
    if (m->friction > 10.0)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s.friction = %g must be at most 10", owner, m->friction);
    if (m->shear_limit <= 0.0 || m->shear_limit > 0.5 * YCI_PI)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s.shear_limit = %g must lie in (0, pi/2]", owner, m->shear_limit);
    return YC_OK;
}

/* Half-edge h = 3 t + k runs from corner k of triangle t to the next corner. */
static int yci_half_next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
static int yci_half_from(const int (*triangles)[3], int h) { return triangles[h / 3][h % 3]; }
static int yci_half_to(const int (*triangles)[3], int h) { return yci_half_from(triangles, yci_half_next(h)); }

static int yci_half_key(const int (*triangles)[3], int h, int higher) {
    int a = yci_half_from(triangles, h), b = yci_half_to(triangles, h);
    return (a < b) == (higher != 0) ? b : a;
}

/* Half-edges ordered by (lower vertex, higher vertex, number), by two passes of counting; NULL when out of memory. */
static int *yci_half_order(yci_context *c, const yc_mesh *mesh) {
    const int(*triangles)[3] = mesh->triangles;
    int total = 3 * mesh->triangle_count, pass, k;
    int *order = YCI_NEW(c, int, total), *other = YCI_NEW(c, int, total);
    int *start = YCI_NEW(c, int, mesh->vertex_count + 1);
    for (pass = 0; pass < 2 && order && other && start; pass++) {
        memset(start, 0, ((size_t)mesh->vertex_count + 1) * sizeof *start);
        for (k = 0; k < total; k++) start[yci_half_key(triangles, k, !pass) + 1]++;
        for (k = 0; k < mesh->vertex_count; k++) start[k + 1] += start[k];
        for (k = 0; k < total; k++) {
            int h = pass ? other[k] : k;
            (pass ? order : other)[start[yci_half_key(triangles, h, !pass)]++] = h;
        }
    }
    if (pass < 2) yci_free(c, order), order = NULL;
    yci_free(c, other);
    yci_free(c, start);
    return order;
}

static int yci_half_same_edge(const int (*triangles)[3], int a, int b) {
    return yci_half_key(triangles, a, 0) == yci_half_key(triangles, b, 0) &&
        yci_half_key(triangles, a, 1) == yci_half_key(triangles, b, 1);
}

static yc_result yci_mesh_check_arrays(yci_context *c, const yc_mesh *mesh) {
    const int(*uvt)[3] = mesh->uv_triangles ? mesh->uv_triangles : mesh->triangles;
    const char *uvt_name = mesh->uv_triangles ? "uv_triangles" : "triangles";
    int i, k;
    if (mesh->vertex_count < 3)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "mesh.vertex_count = %d must be at least 3", mesh->vertex_count);
    if (mesh->triangle_count < 1 || mesh->triangle_count > 700000000)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "mesh.triangle_count = %d must lie in 1 .. 7e8", mesh->triangle_count);
    if (mesh->uv_count < 3)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "mesh.uv_count = %d must be at least 3", mesh->uv_count);
    if (!mesh->positions) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "mesh.positions must not be NULL");
    if (!mesh->triangles) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "mesh.triangles must not be NULL");
    if (!mesh->uv) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "mesh.uv must not be NULL");
    for (i = 0; i < mesh->vertex_count; i++)
        for (k = 0; k < 3; k++)
            if (!yci_finite(mesh->positions[i][k]))
                return YCI_FAIL(
                    c, YC_ERROR_ARGUMENT, "mesh.positions[%d][%d] = %g must be finite", i, k, mesh->positions[i][k]);
    for (i = 0; i < mesh->uv_count; i++)
        for (k = 0; k < 2; k++)
            if (!yci_finite(mesh->uv[i][k]))
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "mesh.uv[%d][%d] = %g must be finite", i, k, mesh->uv[i][k]);
    for (i = 0; i < mesh->triangle_count; i++) {
        const int *t = mesh->triangles[i], *q = uvt[i];
        double area;
        for (k = 0; k < 3; k++) {
            if (t[k] < 0 || t[k] >= mesh->vertex_count)
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "mesh.triangles[%d][%d] = %d must lie in 0 .. %d", i, k, t[k],
                    mesh->vertex_count - 1);
            if (q[k] < 0 || q[k] >= mesh->uv_count)
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "mesh.%s[%d][%d] = %d must lie in 0 .. %d of the UVs", uvt_name,
                    i, k, q[k], mesh->uv_count - 1);
        }
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
            return YCI_FAIL(
                c, YC_ERROR_TOPOLOGY, "mesh.triangles[%d] = %d %d %d: a vertex occurs twice", i, t[0], t[1], t[2]);
        area = 0.5 *
            ((mesh->uv[q[1]][0] - mesh->uv[q[0]][0]) * (mesh->uv[q[2]][1] - mesh->uv[q[0]][1]) -
                (mesh->uv[q[2]][0] - mesh->uv[q[0]][0]) * (mesh->uv[q[1]][1] - mesh->uv[q[0]][1]));
        if (!(area > 0.0) || !yci_finite(area))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "mesh.%s[%d]: area %g m^2 must be > 0", uvt_name, i, area);
    }
    return YC_OK;
}

/* Everything the library asks of a mesh: sizes, indices, finite numbers, positive UV areas, at most two triangles at an
 * edge and these wound alike. */
static yc_result yci_mesh_check(yci_context *c, const yc_mesh *mesh) {
    yc_result result = yci_mesh_check_arrays(c, mesh);
    int *order, k, total;
    if (result != YC_OK) return result;
    order = yci_half_order(c, mesh);
    if (!order) return yci_out_of_memory(c, "the edges of a mesh");
    total = 3 * mesh->triangle_count;
    for (k = 0; k + 1 < total && result == YC_OK; k++) {
        int a = order[k], b = order[k + 1], p = yci_half_key(mesh->triangles, a, 0);
        int q = yci_half_key(mesh->triangles, a, 1);
        if (!yci_half_same_edge(mesh->triangles, a, b)) continue;
        if (k + 2 < total && yci_half_same_edge(mesh->triangles, a, order[k + 2]))
            result =
                YCI_FAIL(c, YC_ERROR_TOPOLOGY, "mesh.triangles[%d], [%d] and [%d] share the edge of vertices %d and %d",
                    a / 3, b / 3, order[k + 2] / 3, p, q);
        else if (yci_half_from(mesh->triangles, a) == yci_half_from(mesh->triangles, b))
            result = YCI_FAIL(c, YC_ERROR_TOPOLOGY,
                "mesh.triangles[%d] and [%d] are wound against each other at the edge of vertices %d and %d", a / 3,
                b / 3, p, q);
    }
    yci_free(c, order);
    return result;
}

static yc_result yci_yarns_check_nodes(yci_context *c, const yc_yarns *y, const yc_mesh *mesh) {
    int i, k;
    for (i = 0; i < y->node_count; i++) {
        double sum = 0.0;
        for (k = 0; k < 3; k++)
            if (!(fabs(y->layout[i][k]) <= 1e6))
                return YCI_FAIL(
                    c, YC_ERROR_ARGUMENT, "yarns.layout[%d][%d] = %g must lie in -1e6 .. 1e6", i, k, y->layout[i][k]);
        if (!mesh) continue;
        if (y->triangle[i] < 0 || y->triangle[i] >= mesh->triangle_count)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.triangle[%d] = %d must lie in 0 .. %d", i, y->triangle[i],
                mesh->triangle_count - 1);
        for (k = 0; k < 3; k++) {
            if (!yci_finite(y->weights[i][k]))
                return YCI_FAIL(
                    c, YC_ERROR_ARGUMENT, "yarns.weights[%d][%d] = %g must be finite", i, k, y->weights[i][k]);
            sum += y->weights[i][k];
        }
        if (fabs(sum - 1.0) > 1e-9)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.weights[%d]: sum %.17g must be 1", i, sum);
    }
    return YC_OK;
}

/* `visits` [node_count], zeroed, receives the number of visits of every node. */
static yc_result yci_yarns_check_visits(yci_context *c, const yc_yarns *y, int *visits) {
    int i, k;
    if (y->yarn_first[0] != 0)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.yarn_first[0] = %d must be 0", y->yarn_first[0]);
    for (i = 0; i < y->yarn_count; i++) {
        int first = y->yarn_first[i], last = y->yarn_first[i + 1];
        if (last > y->visit_count || last - first < 2)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.yarn_first[%d] = %d must lie in %d .. %d (two visits or more)",
                i + 1, last, first + 2, y->visit_count);
        if (y->yarn_family[i] > YC_ROD)
            return YCI_FAIL(
                c, YC_ERROR_ARGUMENT, "yarns.yarn_family[%d] = %d must lie in 0 .. 2", i, y->yarn_family[i]);
        if (y->yarn_material[i] < 0 || y->yarn_material[i] >= y->material_count)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.yarn_material[%d] = %d must lie in 0 .. %d", i,
                y->yarn_material[i], y->material_count - 1);
        for (k = first; k < last; k++) {
            int node = y->visit_node[k];
            if (node < 0 || node >= y->node_count)
                return YCI_FAIL(
                    c, YC_ERROR_ARGUMENT, "yarns.visit_node[%d] = %d must lie in 0 .. %d", k, node, y->node_count - 1);
            if (!(fabs(y->visit_u[k]) <= 1e6))
                return YCI_FAIL(
                    c, YC_ERROR_ARGUMENT, "yarns.visit_u[%d] = %g must lie in -1e6 .. 1e6", k, y->visit_u[k]);
            if (k > first && !(y->visit_u[k] - y->visit_u[k - 1] >= 1e-9))
                return YCI_FAIL(c, YC_ERROR_TOPOLOGY,
                    "yarns.visit_u[%d] = %.12g must be at least 1e-9 greater than the %.12g before it", k,
                    y->visit_u[k], y->visit_u[k - 1]);
            if (y->visit_held[k] > 2)
                return YCI_FAIL(
                    c, YC_ERROR_ARGUMENT, "yarns.visit_held[%d] = %d must lie in 0 .. 2", k, y->visit_held[k]);
            if (k > first && node == y->visit_node[k - 1])
                return YCI_FAIL(
                    c, YC_ERROR_TOPOLOGY, "yarns.visit_node[%d] = %d: the same node twice in a row", k, node);
            if (!y->contact_count && (y->visit_layer[k] < -1 || y->visit_layer[k] > 1))
                return YCI_FAIL(
                    c, YC_ERROR_ARGUMENT, "yarns.visit_layer[%d] = %d must lie in -1 .. 1", k, y->visit_layer[k]);
            if (y->visit_height && !(yci_finite(y->visit_height[k]) && y->visit_height[k] >= 0.0))
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.visit_height[%d] = %g must be finite and not negative", k,
                    y->visit_height[k]);
            if (y->visit_height && !y->visit_layer[k] && y->visit_height[k] != 0.0)
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.visit_height[%d] = %g must be 0: its layer is 0", k,
                    y->visit_height[k]);
            if (y->visit_turn && !(y->visit_turn[k] >= 0.0 && y->visit_turn[k] <= YCI_PI))
                return YCI_FAIL(
                    c, YC_ERROR_ARGUMENT, "yarns.visit_turn[%d] = %g must lie in 0 .. pi", k, y->visit_turn[k]);
            if (++visits[node] > 2 && !y->contact_count)
                return YCI_FAIL(c, YC_ERROR_TOPOLOGY, "yarns.visit_node[%d] = %d: a third visit of this node", k, node);
        }
    }
    if (y->yarn_first[y->yarn_count] != y->visit_count)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.yarn_first[%d] = %d must be visit_count, %d", y->yarn_count,
            y->yarn_first[y->yarn_count], y->visit_count);
    for (k = 0; k < y->visit_count; k++)
        if (visits[y->visit_node[k]] == 1 && !y->visit_held[k])
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.visit_held[%d] = 0 must be 1: node %d has no other visit", k,
                y->visit_node[k]);
    return YC_OK;
}

/* One visit of a contact: is it there, and does its neighbour B follow A or come before it? */
static yc_result yci_yarns_check_contact(yci_context *c, const yc_yarns *y, int contact) {
    const yc_stitch_contact *s = &y->contacts[contact];
    int i, k;
    for (i = 0; i < 2; i++) {
        for (k = 0; k < 2; k++)
            if (s->visit[i][k] < 0 || s->visit[i][k] >= y->visit_count)
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.contacts[%d].visit[%d][%d] = %d must lie in 0 .. %d",
                    contact, i, k, s->visit[i][k], y->visit_count - 1);
        if (s->visit[i][1] != s->visit[i][0] + 1 && s->visit[i][1] != s->visit[i][0] - 1)
            return YCI_FAIL(c, YC_ERROR_TOPOLOGY, "yarns.contacts[%d].visit[%d] = %d and %d do not follow each other",
                contact, i, s->visit[i][0], s->visit[i][1]);
    }
    for (k = 0; k < 2; k++) {
        if (s->visit[0][k] == s->visit[1][k])
            return YCI_FAIL(
                c, YC_ERROR_TOPOLOGY, "yarns.contacts[%d]: visit %d touches itself", contact, s->visit[0][k]);
        if (y->visit_node[s->visit[0][k]] != y->visit_node[s->visit[1][k]])
            return YCI_FAIL(c, YC_ERROR_TOPOLOGY, "yarns.contacts[%d]: visits %d and %d are at different nodes",
                contact, s->visit[0][k], s->visit[1][k]);
    }
    if (s->sign != 1 && s->sign != -1)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.contacts[%d].sign = %d must be +1 or -1", contact, s->sign);
    return YC_OK;
}

/* The contacts of a knit, and what only they allow: `visits` are those of every node, `named` [visit_count] is zero. */
static yc_result yci_yarns_check_contacts(yci_context *c, const yc_yarns *y, const int *visits, unsigned char *named) {
    yc_result result;
    int i, k, yarn;
    for (i = 0; i < y->contact_count; i++) {
        result = yci_yarns_check_contact(c, y, i);
        if (result != YC_OK) return result;
        for (k = 0; k < 4; k++) named[y->contacts[i].visit[k / 2][k % 2]] |= (unsigned char)(1 << k / 2);
    }
    for (k = 0; k < y->visit_count; k++) {
        int count = visits[y->visit_node[k]], most = count < 2 ? 1 : count - 1;
        if (count > 2 && !named[k])
            return YCI_FAIL(c, YC_ERROR_TOPOLOGY,
                "yarns.visit_node[%d] = %d: %d visits of this node, and no contact "
                "names this one",
                k, y->visit_node[k], count);
        if (y->visit_layer[k] < -most || y->visit_layer[k] > most)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.visit_layer[%d] = %d must lie in %d .. %d", k,
                y->visit_layer[k], -most, most);
    }
    for (yarn = 1; yarn < y->yarn_count; yarn++) named[y->yarn_first[yarn]] |= 4; /* begins a yarn */
    for (i = 0; i < y->contact_count; i++)
        for (k = 0; k < 2; k++) {
            const int *pair = y->contacts[i].visit[k];
            if (named[pair[0] > pair[1] ? pair[0] : pair[1]] & 4)
                return YCI_FAIL(c, YC_ERROR_TOPOLOGY, "yarns.contacts[%d].visit[%d] = %d and %d: different yarns", i, k,
                    pair[0], pair[1]);
        }
    return YC_OK;
}

static yc_result yci_yarns_check(yci_context *c, const yc_yarns *y, const yc_mesh *mesh) {
    yc_result result;
    unsigned char *named;
    int *visits, i;
    if (y->node_count < 2)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.node_count = %d must be at least 2", y->node_count);
    if (y->yarn_count < 1)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.yarn_count = %d must be at least 1", y->yarn_count);
    if (y->material_count < 1)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.material_count = %d must be at least 1", y->material_count);
    if (!y->layout || !y->yarn_first || !y->yarn_family || !y->yarn_material || !y->visit_node || !y->visit_u ||
        !y->visit_layer || !y->visit_held || !y->materials)
        return YCI_FAIL(
            c, YC_ERROR_ARGUMENT, "yarns: only triangle, weights, visit_height, visit_turn and owner may be NULL");
    if (y->contact_count < 0)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.contact_count = %d must not be negative", y->contact_count);
    if (y->contact_count && !y->contacts)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.contacts must not be NULL: contact_count = %d", y->contact_count);
    if (mesh && (!y->triangle || !y->weights))
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns.triangle and weights must not be NULL with a mesh");
    for (i = 0; i < y->material_count; i++) {
        char owner[48];
        snprintf(owner, sizeof owner, "yarns.materials[%d]", i);
        result = yci_yarn_material_check(c, owner, &y->materials[i]);
        if (result != YC_OK) return result;
    }
    result = yci_yarns_check_nodes(c, y, mesh);
    if (result != YC_OK) return result;
    visits = YCI_NEW(c, int, y->node_count);
    if (!visits) return yci_out_of_memory(c, "the check of a yarn network");
    result = yci_yarns_check_visits(c, y, visits);
    if (result == YC_OK && y->contact_count) {
        named = YCI_NEW(c, unsigned char, y->visit_count);
        result =
            named ? yci_yarns_check_contacts(c, y, visits, named) : yci_out_of_memory(c, "the check of a yarn network");
        yci_free(c, named);
    }
    yci_free(c, visits);
    return result;
}

/* The list of materials and the orders, where there is a list. */
static yc_result yci_weave_check_order(yci_context *c, const yc_weave_desc *d) {
    int i, k;
    if (d->material_count < 0 || d->material_count > YCI_WEAVE_LIMIT)
        return YCI_FAIL(
            c, YC_ERROR_ARGUMENT, "weave.material_count = %d must lie in 0 .. %d", d->material_count, YCI_WEAVE_LIMIT);
    if (d->material_count && !d->materials)
        return YCI_FAIL(
            c, YC_ERROR_ARGUMENT, "weave.materials must not be NULL: material_count = %d", d->material_count);
    for (i = 0; i < d->material_count; i++) {
        char owner[48];
        yc_result result;
        snprintf(owner, sizeof owner, "weave.materials[%d]", i);
        result = yci_yarn_material_check(c, owner, &d->materials[i]);
        if (result != YC_OK) return result;
    }
    for (i = 0; i < 2 && d->material_count; i++) {
        if (!d->order[i]) continue;
        if (d->order_count[i] < 1)
            return YCI_FAIL(
                c, YC_ERROR_ARGUMENT, "weave.order_count[%d] = %d must be at least 1", i, d->order_count[i]);
        for (k = 0; k < d->order_count[i]; k++)
            if (d->order[i][k] < 0 || d->order[i][k] >= d->material_count)
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.order[%d][%d] = %d must lie in 0 .. %d", i, k,
                    d->order[i][k], d->material_count - 1);
    }
    return YC_OK;
}

static yc_result yci_weave_check(yci_context *c, const yc_weave_desc *d, int with_mesh) {
    yc_result result;
    int i;
    if (d->cookie != YCI_DESC_COOKIE)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.cookie: not made by yc_weave_desc_default()");
    for (i = 0; i < 2; i++) {
        if (!yci_finite(d->spacing[i]))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.spacing[%d] = %g must be finite", i, d->spacing[i]);
        if (d->spacing[i] <= 0.0)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.spacing[%d] = %g must be greater than 0", i, d->spacing[i]);
        if (d->repeat[i] < 1)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.repeat[%d] = %d must be at least 1", i, d->repeat[i]);
        if (d->edge[i] != YC_EDGE_CUT && d->edge[i] != YC_EDGE_SELVEDGE)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.edge[%d] = %d is none of yc_edge", i, (int)d->edge[i]);
        if (!(d->crimp[i] >= 0.0 && d->crimp[i] <= 0.5))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.crimp[%d] = %g must lie in [0, 0.5]", i, d->crimp[i]);
        if (!with_mesh && !yci_finite(d->size[i]))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.size[%d] = %g must be finite", i, d->size[i]);
        if (!with_mesh && d->size[i] <= 0.0)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.size[%d] = %g must be greater than 0", i, d->size[i]);
    }
    for (i = 0; i < 2 && d->draft; i++) {
        double length = yci_weave_length(d->draft, d->repeat, i, d->crimp[i]);
        if (length > 1.5 * (1.0 + 1e-12))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT,
                "weave.crimp[%d] = %g: the draft changes sides so rarely that a yarn would be %g spacings long there, "
                "more than 1.5",
                i, d->crimp[i], length);
    }
    if (!yci_finite(d->grain)) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.grain = %g must be finite", d->grain);
    if (d->bundle < 1 || d->bundle > 1000)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "weave.bundle = %d must lie in 1 .. 1000", d->bundle);
    result = yci_yarn_material_check(c, "weave.warp", &d->warp);
    if (result == YC_OK) result = yci_yarn_material_check(c, "weave.weft", &d->weft);
    if (result == YC_OK && d->rod.density != 0.0) result = yci_yarn_material_check(c, "weave.rod", &d->rod);
    if (result == YC_OK) result = yci_weave_check_order(c, d);
    return result;
}

/* ---- laying ------------------------------------------------------------------------------------------------------ */

typedef struct {
    double place[2];   /* layout, m */
    double weights[3]; /* of the triangle's corners */
    int triangle;      /* -1 until found */
    int visits;        /* by yarns that will be made */
    int over;          /* +1: the warp is the upper yarn of this crossing, -1: the lower; 0: an end on the outline */
} yci_weave_node;

/* Where a line meets the outline. Later also a yarn's end on a seam: line is then the chain, along the arc length on
 * it, share the same before ends were moved apart. */
typedef struct {
    double along, share; /* position on the line; on the half-edge, 0 to 1 */
    int line, half, enter, node;
} yci_weave_cut;

/* A stretch of a line inside a piece, and the yarn made of it; or a rod. */
typedef struct {
    double end[2], share[2]; /* of the two cuts */
    int half[2];
    int family, line;
    int row, row_end; /* lines of the other family strictly between the ends */
    int node;         /* warps: the node of `row`, the others follow */
    int first, count; /* in visits */
    int tip[2];       /* nodes on the outline, -1: none */
} yci_weave_span;

typedef struct {
    double along; /* position on the line; u of a rod */
    int node;
    signed char layer; /* of a knit */
} yci_weave_visit;

typedef struct {
    yci_context *c;
    const yc_weave_desc *desc;
    const yc_mesh *mesh;
    const int (*uvt)[3];
    const unsigned char *draft;
    int repeat[2];
    double turn[2]; /* cosine and sine of the grain */
    double height[2];
    int *twin; /* [3 triangle_count], half-edge across the edge of the mesh, -1 at its border */
    int piece_count;
    int *piece_first, *piece_triangle; /* [piece_count + 1], [triangle_count] */
    /* lattice of the piece at work */
    double origin[2];
    int line_first[2], line_end[2];
    int *span_first; /* [lines + 1] spans of every warp of this piece */
    int span_first_capacity;
    /* growing */
    yci_weave_node *nodes;
    yci_weave_cut *cuts;
    yci_weave_span *spans;
    yci_weave_visit *visits;
    int node_count, node_capacity, cut_count, cut_capacity, span_count, span_capacity, visit_count, visit_capacity;
} yci_weaver;

static const double *yci_weave_uv(const yci_weaver *w, int half) { return w->mesh->uv[yci_half_from(w->uvt, half)]; }

static void yci_weave_to_frame(const yci_weaver *w, const double *uv, double *frame) {
    frame[0] = w->turn[0] * uv[0] + w->turn[1] * uv[1];
    frame[1] = w->turn[0] * uv[1] - w->turn[1] * uv[0];
}

static void yci_weave_from_frame(const yci_weaver *w, const double *frame, double *uv) {
    uv[0] = w->turn[0] * frame[0] - w->turn[1] * frame[1];
    uv[1] = w->turn[0] * frame[1] + w->turn[1] * frame[0];
}

static double yci_weave_line(const yci_weaver *w, int family, int line) {
    return w->origin[family] + (line + 0.5) * w->desc->spacing[family];
}

/* The first line of the piece that lies at x or beyond; one past the last where there is none. */
static int yci_weave_first_line(const yci_weaver *w, int family, double x) {
    double guess = floor((x - w->origin[family]) / w->desc->spacing[family] - 0.5) - 1.0;
    int line;
    if (!(guess < w->line_end[family])) return w->line_end[family];
    line = guess < w->line_first[family] ? w->line_first[family] : (int)guess;
    while (line < w->line_end[family] && yci_weave_line(w, family, line) < x) line++;
    return line;
}

/* An edge is one edge in UV, too: both triangles use the same UVs at its ends. */
static int yci_weave_interior(const yci_weaver *w, int half) {
    int twin = w->twin[half];
    return twin >= 0 && yci_half_from(w->uvt, half) == yci_half_to(w->uvt, twin) &&
        yci_half_to(w->uvt, half) == yci_half_from(w->uvt, twin);
}

static int yci_weave_root(int *parent, int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Twins of the half-edges, then the pieces by union-find across interior edges; pieces in the order of their first
 * triangles. */
static yc_result yci_weave_pieces(yci_weaver *w) {
    int count = w->mesh->triangle_count, total = 3 * count, i, h;
    int *order = yci_half_order(w->c, w->mesh), *parent = YCI_NEW(w->c, int, count), *piece = YCI_NEW(w->c, int, count);
    int ok;
    w->twin = YCI_NEW(w->c, int, total);
    w->piece_first = YCI_NEW(w->c, int, count + 2);
    w->piece_triangle = YCI_NEW(w->c, int, count);
    ok = order && parent && piece && w->twin && w->piece_first && w->piece_triangle;
    if (ok) {
        for (h = 0; h < total; h++) w->twin[h] = -1;
        for (h = 0; h + 1 < total; h++)
            if (yci_half_same_edge(w->mesh->triangles, order[h], order[h + 1]))
                w->twin[order[h]] = order[h + 1], w->twin[order[h + 1]] = order[h];
        for (i = 0; i < count; i++) parent[i] = i;
        for (h = 0; h < total; h++) {
            int a, b;
            if (!yci_weave_interior(w, h)) continue;
            a = yci_weave_root(parent, h / 3), b = yci_weave_root(parent, w->twin[h] / 3);
            if (a < b) parent[b] = a;
            else parent[a] = b;
        }
        for (i = 0; i < count; i++) {
            int root = yci_weave_root(parent, i); /* never above i */
            piece[i] = root == i ? w->piece_count++ : piece[root];
            w->piece_first[piece[i] + 2]++;
        }
        for (i = 0; i < w->piece_count; i++) w->piece_first[i + 2] += w->piece_first[i + 1];
        for (i = 0; i < count; i++) w->piece_triangle[w->piece_first[piece[i] + 1]++] = i;
    }
    yci_free(w->c, order);
    yci_free(w->c, parent);
    yci_free(w->c, piece);
    return ok ? YC_OK : yci_out_of_memory(w->c, "the pieces of a pattern");
}

static yc_result yci_weave_too_many(yci_weaver *w, double count, const char *what) {
    return YCI_FAIL(w->c, YC_ERROR_ARGUMENT, "weave.spacing = %g, %g gives about %.3g %s, more than %d",
        w->desc->spacing[0], w->desc->spacing[1], count, what, YCI_WEAVE_LIMIT);
}

/* Refuses a weave whose arrays would not be counted by an int; crossings are one per area spacing[0] spacing[1]. */
static yc_result yci_weave_check_count(yci_weaver *w) {
    double count = 0.0;
    int i;
    for (i = 0; i < w->mesh->triangle_count; i++) {
        const double *a = yci_weave_uv(w, 3 * i), *b = yci_weave_uv(w, 3 * i + 1), *d = yci_weave_uv(w, 3 * i + 2);
        count += 0.5 * ((b[0] - a[0]) * (d[1] - a[1]) - (d[0] - a[0]) * (b[1] - a[1]));
    }
    count = count / w->desc->spacing[0] / w->desc->spacing[1];
    return count <= YCI_WEAVE_LIMIT ? YC_OK : yci_weave_too_many(w, count, "crossings");
}

/* The bounding box of a piece, in the frame. */
static void yci_weave_box(const yci_weaver *w, int piece, double low[2], double high[2]) {
    double frame[2];
    int i, k, f;
    low[0] = low[1] = HUGE_VAL, high[0] = high[1] = -HUGE_VAL;
    for (i = w->piece_first[piece]; i < w->piece_first[piece + 1]; i++)
        for (k = 0; k < 3; k++) {
            yci_weave_to_frame(w, yci_weave_uv(w, 3 * w->piece_triangle[i] + k), frame);
            for (f = 0; f < 2; f++) low[f] = yci_min(low[f], frame[f]), high[f] = yci_max(high[f], frame[f]);
        }
}

/* The lattice of a piece: centred in its bounding box, with margins of 1/4 to 3/4 spacing. The rectangle without a mesh
 * has its origin at its corner and every line strictly inside. */
static yc_result yci_weave_lattice(yci_weaver *w, int piece, int centred) {
    double low[2], high[2];
    int f;
    yci_weave_box(w, piece, low, high);
    for (f = 0; f < 2; f++) {
        double s = w->desc->spacing[f], lines = (high[f] - low[f]) / s;
        if (!(lines + fabs(low[f] / s) < YCI_WEAVE_LIMIT))
            return yci_weave_too_many(w, lines + fabs(low[f] / s), "lines");
        if (centred) {
            w->line_first[f] = 0;
            w->line_end[f] = (int)yci_max(1.0, floor(lines + 0.5));
            w->origin[f] = 0.5 * (low[f] + high[f]) - 0.5 * w->line_end[f] * s;
        } else {
            w->origin[f] = 0.0;
            w->line_first[f] = (int)ceil(low[f] / s - 0.5 + 1e-6);
            w->line_end[f] = (int)floor(high[f] / s - 0.5 - 1e-6) + 1;
        }
    }
    return YC_OK;
}

static int yci_weave_cut_less(const yci_weave_cut *a, const yci_weave_cut *b) {
    if (a->line != b->line) return a->line < b->line;
    if (a->along != b->along) return a->along < b->along;
    if (a->enter != b->enter) return a->enter < b->enter;
    return a->half != b->half ? a->half < b->half : a->node < b->node;
}

/* Shell's sort: in place, no recursion, the same everywhere. */
static void yci_weave_sort_cuts(yci_weave_cut *cuts, int count) {
    int gap, i, k;
    for (gap = count; gap > 1;) {
        gap = gap < 5 ? 1 : (int)(gap * 0.4545);
        for (i = gap; i < count; i++) {
            yci_weave_cut moved = cuts[i];
            for (k = i; k >= gap && yci_weave_cut_less(&moved, &cuts[k - gap]); k -= gap) cuts[k] = cuts[k - gap];
            cuts[k] = moved;
        }
    }
}

/* All cuts of the family's lines with the outline of the piece, sorted. */
static yc_result yci_weave_cut_piece(yci_weaver *w, int piece, int family) {
    int i, k, line;
    w->cut_count = 0;
    for (i = w->piece_first[piece]; i < w->piece_first[piece + 1]; i++)
        for (k = 0; k < 3; k++) {
            int half = 3 * w->piece_triangle[i] + k, up;
            double p[2], q[2];
            const double *low, *high;
            if (yci_weave_interior(w, half)) continue;
            yci_weave_to_frame(w, yci_weave_uv(w, half), p);
            yci_weave_to_frame(w, yci_weave_uv(w, yci_half_next(half)), q);
            up = p[family] < q[family];
            low = up ? p : q, high = up ? q : p;
            for (line = yci_weave_first_line(w, family, low[family]); line < w->line_end[family]; line++) {
                double x = yci_weave_line(w, family, line), share;
                yci_weave_cut *cut;
                if (x > high[family]) break;
                if (x <= low[family]) continue;
                if (w->cut_count + w->span_count >= YCI_WEAVE_LIMIT)
                    return yci_weave_too_many(w, (double)w->cut_count + w->span_count, "yarns");
                if (!YCI_RESERVE(w->c, w->cuts, w->cut_capacity, w->cut_count, w->cut_count + 1))
                    return yci_out_of_memory(w->c, "the outline of a pattern piece");
                cut = &w->cuts[w->cut_count++];
                share = (x - low[family]) / (high[family] - low[family]);
                cut->along = low[1 - family] + share * (high[1 - family] - low[1 - family]);
                cut->share = up ? share : 1.0 - share;
                cut->line = line, cut->half = half, cut->node = -1;
                cut->enter = up == (family == YC_WARP); /* the piece lies to the left of its outline */
            }
        }
    yci_weave_sort_cuts(w->cuts, w->cut_count);
    return YC_OK;
}

static yc_result yci_weave_overlap(yci_weaver *w, int half) {
    return YCI_FAIL(w->c, YC_ERROR_TOPOLOGY, "mesh.uv: the piece of triangle %d overlaps itself there", half / 3);
}

/* Pairs the sorted cuts up. The two sides of a slit may come in either order, by rounding: leaving goes first. */
static yc_result yci_weave_pair_cuts(yci_weaver *w, int family) {
    double close = 1e-9 * w->desc->spacing[1 - family];
    int i, e;
    if (w->cut_count % 2) return yci_weave_overlap(w, w->cuts[w->cut_count - 1].half);
    for (i = 0; i < w->cut_count; i++) {
        yci_weave_cut *cut = &w->cuts[i];
        if (cut->enter != (i % 2 == 0)) {
            yci_weave_cut swapped = *cut;
            if (i + 1 == w->cut_count || cut[1].line != cut->line || cut[1].along - cut->along > close ||
                cut[1].enter == cut->enter)
                return yci_weave_overlap(w, cut->half);
            cut[0] = cut[1], cut[1] = swapped;
        }
        if (i % 2 && cut->line != cut[-1].line) return yci_weave_overlap(w, cut->half);
    }
    if (!YCI_RESERVE(w->c, w->spans, w->span_capacity, w->span_count, w->span_count + w->cut_count / 2))
        return yci_out_of_memory(w->c, "the yarns of a weave");
    for (i = 0; i < w->cut_count; i += 2) {
        yci_weave_span *span = &w->spans[w->span_count++];
        memset(span, 0, sizeof *span);
        span->family = family, span->line = w->cuts[i].line;
        for (e = 0; e < 2; e++) {
            span->end[e] = w->cuts[i + e].along, span->share[e] = w->cuts[i + e].share;
            span->half[e] = w->cuts[i + e].half;
            span->tip[e] = -1;
        }
        span->row = yci_weave_first_line(w, 1 - family, span->end[0]);
        span->row_end = yci_weave_first_line(w, 1 - family, span->end[1]);
        if (span->row < span->row_end && yci_weave_line(w, 1 - family, span->row) <= span->end[0]) span->row++;
    }
    return YC_OK;
}

/* The node at the crossing of a warp and a weft line, -1 outside the piece. */
static int yci_weave_find(const yci_weaver *w, int warp, int weft) {
    int k = warp - w->line_first[0], low = w->span_first[k], high = w->span_first[k + 1];
    while (low < high) {
        int middle = low + (high - low) / 2;
        const yci_weave_span *span = &w->spans[middle];
        if (weft < span->row) high = middle;
        else if (weft >= span->row_end) low = middle + 1;
        else return span->node + weft - span->row;
    }
    return -1;
}

static yc_result yci_weave_push_visit(yci_weaver *w, int node, double along) {
    if (!YCI_RESERVE(w->c, w->visits, w->visit_capacity, w->visit_count, w->visit_count + 1))
        return yci_out_of_memory(w->c, "the visits of a weave");
    w->visits[w->visit_count].node = node, w->visits[w->visit_count].along = along;
    w->visits[w->visit_count++].layer = 0;
    return YC_OK;
}

static yci_weave_node *yci_weave_push_node(yci_weaver *w) {
    yci_weave_node *node;
    if (!YCI_RESERVE(w->c, w->nodes, w->node_capacity, w->node_count, w->node_count + 1)) return NULL;
    node = &w->nodes[w->node_count++];
    memset(node, 0, sizeof *node);
    node->triangle = -1;
    return node;
}

/* Where a line, whose number may be negative, falls in a repeat. */
static int yci_weave_repeat(int line, int count) {
    int rest = line % count;
    return rest < 0 ? rest + count : rest;
}

/* Nodes of a warp's crossings. */
static yc_result yci_weave_cross(yci_weaver *w, yci_weave_span *span) {
    int row, column = yci_weave_repeat(span->line, w->repeat[0]);
    span->node = w->node_count;
    for (row = span->row; row < span->row_end; row++) {
        yci_weave_node *node = yci_weave_push_node(w);
        double frame[2];
        int r = yci_weave_repeat(row, w->repeat[1]);
        if (!node) return yci_out_of_memory(w->c, "the nodes of a weave");
        frame[0] = yci_weave_line(w, 0, span->line), frame[1] = yci_weave_line(w, 1, row);
        yci_weave_from_frame(w, frame, node->place);
        node->over = w->draft[(size_t)r * (size_t)w->repeat[0] + (size_t)column] ? 1 : -1;
    }
    return YC_OK;
}

/* The visits at crossings of all spans of the piece: warps from span `begin` on, wefts from span `wefts` on. A
 * crossing on the outline may lie inside one family's span and outside the other's: a visit count of one tells. */
static yc_result yci_weave_cross_piece(yci_weaver *w, int begin, int wefts) {
    int i, k, row;
    yc_result result = YC_OK;
    if (!YCI_RESERVE(w->c, w->span_first, w->span_first_capacity, 0, w->line_end[0] - w->line_first[0] + 1))
        return yci_out_of_memory(w->c, "the lines of a weave");
    for (i = begin, k = 0; k <= w->line_end[0] - w->line_first[0]; k++) {
        w->span_first[k] = i;
        while (i < wefts && w->spans[i].line == k + w->line_first[0]) i++;
    }
    for (i = begin; i < wefts && result == YC_OK; i++) result = yci_weave_cross(w, &w->spans[i]);
    for (i = begin; i < w->span_count && result == YC_OK; i++) {
        yci_weave_span *span = &w->spans[i];
        span->first = w->visit_count;
        for (row = span->row; row < span->row_end && result == YC_OK; row++) {
            int node = i < wefts ? span->node + row - span->row : yci_weave_find(w, row, span->line);
            if (node < 0) continue;
            w->nodes[node].visits++;
            result = yci_weave_push_visit(w, node, yci_weave_line(w, 1 - span->family, row));
        }
        span->count = w->visit_count - span->first;
    }
    return result;
}

/* The triangle's claim on a node: it is kept where the least weight is greater than with the triangles before. */
static void yci_weave_claim(yci_weaver *w, int triangle, yci_weave_node *node) {
    const double *a = yci_weave_uv(w, 3 * triangle), *b = yci_weave_uv(w, 3 * triangle + 1);
    const double *d = yci_weave_uv(w, 3 * triangle + 2);
    double e0 = b[0] - a[0], e1 = b[1] - a[1], f0 = d[0] - a[0], f1 = d[1] - a[1];
    double p0 = node->place[0] - a[0], p1 = node->place[1] - a[1], area = e0 * f1 - e1 * f0, weights[3];
    weights[1] = (p0 * f1 - p1 * f0) / area;
    weights[2] = (e0 * p1 - e1 * p0) / area;
    weights[0] = 1.0 - weights[1] - weights[2];
    if (node->triangle >= 0 &&
        yci_min(yci_min(weights[0], weights[1]), weights[2]) <=
            yci_min(yci_min(node->weights[0], node->weights[1]), node->weights[2]))
        return;
    node->triangle = triangle;
    yci_copy(node->weights, weights);
}

/* Runs over the crossings in and, to rounding, around a triangle: warp by warp. */
static void yci_weave_locate(yci_weaver *w, int triangle) {
    double p[3][2], close0 = 1e-9 * w->desc->spacing[0], close1 = 1e-9 * w->desc->spacing[1], least, most;
    int k, warp, weft;
    for (k = 0; k < 3; k++) yci_weave_to_frame(w, yci_weave_uv(w, 3 * triangle + k), p[k]);
    least = yci_min(yci_min(p[0][0], p[1][0]), p[2][0]) - close0;
    most = yci_max(yci_max(p[0][0], p[1][0]), p[2][0]) + close0;
    for (warp = yci_weave_first_line(w, 0, least); warp < w->line_end[0]; warp++) {
        double x = yci_weave_line(w, 0, warp), low = HUGE_VAL, high = -HUGE_VAL;
        if (x > most) break;
        for (k = 0; k < 3; k++) {
            const double *a = p[k], *b = p[(k + 1) % 3];
            double wide = b[0] - a[0], y;
            if (fabs(wide) <= 2.0 * close0) {
                if (fabs(x - a[0]) > 3.0 * close0) continue;
                low = yci_min(low, yci_min(a[1], b[1])), high = yci_max(high, yci_max(a[1], b[1]));
            } else {
                if ((x - a[0]) / wide < -close0 / fabs(wide) || (x - b[0]) / wide > close0 / fabs(wide)) continue;
                y = a[1] + yci_clamp((x - a[0]) / wide, 0.0, 1.0) * (b[1] - a[1]);
                low = yci_min(low, y), high = yci_max(high, y);
            }
        }
        for (weft = yci_weave_first_line(w, 1, low - close1); weft < w->line_end[1]; weft++) {
            int node;
            if (yci_weave_line(w, 1, weft) > high + close1) break;
            node = yci_weave_find(w, warp, weft);
            if (node >= 0) yci_weave_claim(w, triangle, &w->nodes[node]);
        }
    }
}

/* Puts a node on a half-edge. */
static void yci_weave_place(const yci_weaver *w, yci_weave_node *node, int half, double share) {
    const double *a = yci_weave_uv(w, half), *b = yci_weave_uv(w, yci_half_next(half));
    node->triangle = half / 3;
    node->weights[half % 3] = 1.0 - share, node->weights[(half + 1) % 3] = share, node->weights[(half + 2) % 3] = 0.0;
    node->place[0] = a[0] + share * (b[0] - a[0]), node->place[1] = a[1] + share * (b[1] - a[1]);
}

/* Whether a span ends at a selvedge. */
static int yci_weave_selvedge(const yci_weaver *w, const yci_weave_span *span, int end) {
    return w->desc->edge[span->family] == YC_EDGE_SELVEDGE && w->twin[span->half[end]] < 0;
}

/* Decides how a span ends, by the rules in the head of this chapter. */
static yc_result yci_weave_ends(yci_weaver *w, yci_weave_span *span) {
    double spacing = w->desc->spacing[1 - span->family];
    yci_weave_visit *visits = w->visits + span->first;
    int i, e, kept = 0, wanted[2] = {0, 0};
    for (i = 0; i < span->count; i++) {
        const yci_weave_node *node = &w->nodes[visits[i].node];
        if (node->visits == 2 && node->triangle >= 0) visits[kept++] = visits[i];
    }
    span->count = kept;
    for (e = 0; e < 2 && span->count; e++) {
        const yci_weave_visit *last = &w->visits[span->first + (e ? span->count - 1 : 0)];
        int selvedge = yci_weave_selvedge(w, span, e), cut = !selvedge && w->twin[span->half[e]] < 0;
        int long_enough = fabs(span->end[e] - last->along) >= (cut ? YCI_WEAVE_STUB : YCI_WEAVE_TAIL) * spacing;
        wanted[e] = long_enough || !selvedge;
        if (long_enough || selvedge) continue;
        span->count--;
        if (!e) span->first++;
    }
    for (e = 0; e < 2 && span->count; e++) {
        yci_weave_node *node;
        if (!wanted[e]) continue;
        node = yci_weave_push_node(w);
        if (!node) return yci_out_of_memory(w->c, "the nodes of a weave");
        span->tip[e] = w->node_count - 1;
        yci_weave_place(w, node, span->half[e], span->share[e]);
    }
    return YC_OK;
}

static yc_result yci_weave_piece(yci_weaver *w, int piece, int centred) {
    int begin = w->span_count, wefts, i;
    yc_result result = yci_weave_lattice(w, piece, centred);
    if (result == YC_OK) result = yci_weave_cut_piece(w, piece, YC_WARP);
    if (result == YC_OK) result = yci_weave_pair_cuts(w, YC_WARP);
    wefts = w->span_count;
    if (result == YC_OK) result = yci_weave_cut_piece(w, piece, YC_WEFT);
    if (result == YC_OK) result = yci_weave_pair_cuts(w, YC_WEFT);
    if (result == YC_OK) result = yci_weave_cross_piece(w, begin, wefts);
    if (result != YC_OK) return result;
    for (i = w->piece_first[piece]; i < w->piece_first[piece + 1]; i++) yci_weave_locate(w, w->piece_triangle[i]);
    for (i = begin; i < w->span_count && result == YC_OK; i++) result = yci_weave_ends(w, &w->spans[i]);
    return result;
}

/* Counts the visits of every node and takes out, one after another, the spans that make no yarn: without a crossing or
 * with one visit. Taking one out may leave another without a crossing. */
static void yci_weave_prune(yci_weaver *w) {
    int i, k, pruned = 1;
    for (i = 0; i < w->node_count; i++) w->nodes[i].visits = 0;
    for (i = 0; i < w->span_count; i++) {
        const yci_weave_span *span = &w->spans[i];
        for (k = 0; k < span->count; k++) w->nodes[w->visits[span->first + k].node].visits++;
        for (k = 0; k < 2; k++)
            if (span->tip[k] >= 0) w->nodes[span->tip[k]].visits++;
    }
    while (pruned) {
        pruned = 0;
        for (i = 0; i < w->span_count; i++) {
            yci_weave_span *span = &w->spans[i];
            int crossings = 0;
            if (!span->count) continue;
            for (k = 0; k < span->count; k++) crossings += w->nodes[w->visits[span->first + k].node].visits == 2;
            if (crossings && span->count + (span->tip[0] >= 0) + (span->tip[1] >= 0) >= 2) continue;
            for (k = 0; k < span->count; k++) w->nodes[w->visits[span->first + k].node].visits--;
            for (k = 0; k < 2; k++) {
                if (span->tip[k] >= 0) w->nodes[span->tip[k]].visits = 0;
                span->tip[k] = -1;
            }
            span->count = 0, pruned = 1;
        }
    }
}

/* ---- rods -------------------------------------------------------------------------------------------------------- */

/* A seam edge, in the order and direction in which its chain is walked. */
typedef struct {
    int half; /* the half-edge that runs with the chain; its twin runs against */
    int chain;
    double arc, length; /* m, along the chain where it begins; mean of both sides in the pattern */
} yci_weave_seam;

static double yci_weave_half_length(const yci_weaver *w, int half) {
    const double *a = yci_weave_uv(w, half), *b = yci_weave_uv(w, yci_half_next(half));
    return sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
}

static int yci_weave_is_seam(const yci_weaver *w, int half) {
    return w->twin[half] >= 0 && !yci_weave_interior(w, half);
}

/* Walks the seam edges into chains: from vertices where not just two of them meet, then the cycles that are left.
 * around[first[v] .. first[v + 1]) are the half-edges of seams that leave vertex v, place[half] is its seam, -1
 * before. */
static int yci_weave_walk(const yci_weaver *w, const int *first, const int *around, int *place, yci_weave_seam *seams) {
    int total = 3 * w->mesh->triangle_count, count = 0, chains = 0, cycles, start;
    for (cycles = 0; cycles < 2; cycles++)
        for (start = 0; start < total; start++) {
            int half = -1, v, k;
            double arc = 0.0;
            if (!yci_weave_is_seam(w, start) || place[start] >= 0) continue;
            /* Either end of the edge may be where the chain begins. */
            for (k = 0; k < 2 && half < 0; k++) {
                int candidate = k ? w->twin[start] : start;
                v = yci_half_from(w->mesh->triangles, candidate);
                if (cycles || first[v + 1] - first[v] != 2) half = candidate;
            }
            if (half < 0) continue;
            while (half >= 0) {
                yci_weave_seam *seam = &seams[count];
                seam->half = half, seam->chain = chains, seam->arc = arc;
                seam->length = 0.5 * (yci_weave_half_length(w, half) + yci_weave_half_length(w, w->twin[half]));
                arc += seam->length;
                place[half] = place[w->twin[half]] = count++;
                v = yci_half_to(w->mesh->triangles, half), half = -1;
                if (first[v + 1] - first[v] != 2) break;
                for (k = first[v]; k < first[v + 1]; k++)
                    if (place[around[k]] < 0) half = around[k];
            }
            chains++;
        }
    return count;
}

/* Spreads the yarn ends of one chain to the least distance `gap`, forward, then back from the chain's end. */
static void yci_weave_spread(yci_weave_cut *ties, int count, double gap, double length) {
    int k;
    for (k = 1; k < count; k++) ties[k].along = yci_max(ties[k].along, ties[k - 1].along + gap);
    for (k = count - 1; k >= 0 && ties[k].along > length; k--, length -= gap) ties[k].along = length;
}

/* Moves a yarn end to its new place on its side of the seam; past the seam edge's end where need be, but not into
 * another piece. */
static void yci_weave_move(
    yci_weaver *w, const yci_weave_seam *seams, int seam_count, int seam, const yci_weave_cut *tie) {
    int against = seams[seam].half != tie->half, half = tie->half, step = tie->along > seams[seam].arc ? 1 : -1, next;
    double share;
    for (; tie->along < seams[seam].arc || tie->along > seams[seam].arc + seams[seam].length;
         seam += step, half = next) {
        int follows, other = seam + step;
        if (other < 0 || other >= seam_count || seams[other].chain != seams[seam].chain) break;
        next = against ? w->twin[seams[other].half] : seams[other].half;
        follows = (step > 0) != against;
        if ((follows ? yci_half_to(w->uvt, half) : yci_half_from(w->uvt, half)) !=
            (follows ? yci_half_from(w->uvt, next) : yci_half_to(w->uvt, next)))
            break;
    }
    share = yci_clamp((tie->along - seams[seam].arc) / seams[seam].length, 0.0, 1.0);
    yci_weave_place(w, &w->nodes[tie->node], half, against ? 1.0 - share : share);
}

/* Ties the yarn ends to the chains: a span of the family YC_ROD for every chain with two of them or more. */
static yc_result yci_weave_tie(yci_weaver *w, const yci_weave_seam *seams, int seam_count, const int *place) {
    double gap = YCI_WEAVE_GAP * 0.5 * (w->desc->spacing[0] + w->desc->spacing[1]);
    int i, e, k, begin, end;
    yc_result result = YC_OK;
    w->cut_count = 0;
    for (i = 0; i < w->span_count; i++)
        for (e = 0; e < 2; e++) {
            const yci_weave_span *span = &w->spans[i];
            const yci_weave_seam *seam;
            yci_weave_cut *tie;
            if (span->tip[e] < 0 || w->twin[span->half[e]] < 0) continue;
            if (!YCI_RESERVE(w->c, w->cuts, w->cut_capacity, w->cut_count, w->cut_count + 1))
                return yci_out_of_memory(w->c, "the rods of a pattern");
            tie = &w->cuts[w->cut_count++];
            seam = &seams[place[span->half[e]]];
            tie->along =
                seam->arc + seam->length * (seam->half == span->half[e] ? span->share[e] : 1.0 - span->share[e]);
            tie->share = tie->along;
            tie->line = seam->chain, tie->half = span->half[e], tie->enter = 0, tie->node = span->tip[e];
        }
    yci_weave_sort_cuts(w->cuts, w->cut_count);
    for (begin = 0; begin < w->cut_count && result == YC_OK; begin = end) {
        yci_weave_cut *ties = w->cuts + begin;
        yci_weave_span *rod;
        int last = place[ties->half];
        for (end = begin + 1; end < w->cut_count && w->cuts[end].line == ties->line;) end++;
        if (end - begin < 2) continue;
        while (last + 1 < seam_count && seams[last + 1].chain == ties->line) last++;
        yci_weave_spread(ties, end - begin, gap, seams[last].arc + seams[last].length);
        if (!YCI_RESERVE(w->c, w->spans, w->span_capacity, w->span_count, w->span_count + 1))
            return yci_out_of_memory(w->c, "the rods of a pattern");
        rod = &w->spans[w->span_count++];
        memset(rod, 0, sizeof *rod);
        rod->family = YC_ROD, rod->tip[0] = rod->tip[1] = -1, rod->first = w->visit_count, rod->count = end - begin;
        for (k = 0; k < end - begin && result == YC_OK; k++) {
            if (ties[k].along != ties[k].share) yci_weave_move(w, seams, seam_count, place[ties[k].half], &ties[k]);
            w->nodes[ties[k].node].visits++;
            result = yci_weave_push_visit(w, ties[k].node, ties[k].along);
        }
    }
    return result;
}

static yc_result yci_weave_rods(yci_weaver *w) {
    int total = 3 * w->mesh->triangle_count, h, v, count = 0;
    int *first = YCI_NEW(w->c, int, w->mesh->vertex_count + 2), *place = YCI_NEW(w->c, int, total), *around = NULL;
    yci_weave_seam *seams = NULL;
    yc_result result;
    if (first && place) {
        for (h = 0; h < total; h++) {
            place[h] = -1;
            if (yci_weave_is_seam(w, h)) first[yci_half_from(w->mesh->triangles, h) + 2]++, count++;
        }
        around = YCI_NEW(w->c, int, count);
        seams = YCI_NEW(w->c, yci_weave_seam, count / 2);
    }
    if (around && seams) {
        for (v = 0; v < w->mesh->vertex_count; v++) first[v + 2] += first[v + 1];
        for (h = 0; h < total; h++)
            if (yci_weave_is_seam(w, h)) around[first[yci_half_from(w->mesh->triangles, h) + 1]++] = h;
        count = yci_weave_walk(w, first, around, place, seams);
        result = yci_weave_tie(w, seams, count, place);
    } else result = yci_out_of_memory(w->c, "the seams of a pattern");
    yci_free(w->c, first);
    yci_free(w->c, place);
    yci_free(w->c, around);
    yci_free(w->c, seams);
    return result;
}

/* ---- the network ------------------------------------------------------------------------------------------------- */

static void *yci_weave_carve(char *block, size_t *used, int count, size_t size) {
    void *part = block ? block + *used : NULL;
    *used += ((size_t)count * size + 15) / 16 * 16;
    return part;
}

enum { YCI_HEIGHTS = 1, YCI_TURNS = 2 }; /* arrays that not every network has */

/* Points the arrays of a network, whose counts are set, into the block and returns its size. The context that frees it
 * stands in front. */
static size_t yci_weave_arrays(yc_yarns *y, char *block, int on_mesh, int has) {
    size_t used = 0;
    y->owner = yci_weave_carve(block, &used, 1, sizeof(yci_context));
    y->layout = (double(*)[3])yci_weave_carve(block, &used, y->node_count, sizeof *y->layout);
    if (on_mesh) {
        y->weights = (double(*)[3])yci_weave_carve(block, &used, y->node_count, sizeof *y->weights);
        y->triangle = (int *)yci_weave_carve(block, &used, y->node_count, sizeof *y->triangle);
    }
    y->visit_u = (double *)yci_weave_carve(block, &used, y->visit_count, sizeof *y->visit_u);
    if (has & YCI_HEIGHTS)
        y->visit_height = (double *)yci_weave_carve(block, &used, y->visit_count, sizeof *y->visit_height);
    if (has & YCI_TURNS) y->visit_turn = (double *)yci_weave_carve(block, &used, y->visit_count, sizeof(double));
    y->materials = (yc_yarn_material *)yci_weave_carve(block, &used, y->material_count, sizeof *y->materials);
    y->yarn_first = (int *)yci_weave_carve(block, &used, y->yarn_count + 1, sizeof *y->yarn_first);
    y->yarn_material = (int *)yci_weave_carve(block, &used, y->yarn_count, sizeof *y->yarn_material);
    y->visit_node = (int *)yci_weave_carve(block, &used, y->visit_count, sizeof *y->visit_node);
    y->yarn_family = (unsigned char *)yci_weave_carve(block, &used, y->yarn_count, sizeof *y->yarn_family);
    y->visit_layer = (signed char *)yci_weave_carve(block, &used, y->visit_count, sizeof *y->visit_layer);
    y->visit_held = (unsigned char *)yci_weave_carve(block, &used, y->visit_count, sizeof *y->visit_held);
    if (y->contact_count)
        y->contacts = (yc_stitch_contact *)yci_weave_carve(block, &used, y->contact_count, sizeof *y->contacts);
    return used;
}

/* Copies the nodes that are visited; number[] receives their new numbers. */
static void yci_weave_fill_nodes(const yci_weaver *w, yc_yarns *y, int *number) {
    int i, k, next = 0;
    for (i = 0; i < w->node_count; i++) {
        const yci_weave_node *node = &w->nodes[i];
        double sum = 0.0;
        if (!node->visits) continue;
        y->layout[next][0] = node->place[0], y->layout[next][1] = node->place[1], y->layout[next][2] = 0.0;
        if (y->triangle) {
            y->triangle[next] = node->triangle;
            for (k = 0; k < 3; k++) sum += yci_max(node->weights[k], 0.0);
            for (k = 0; k < 3; k++) y->weights[next][k] = yci_max(node->weights[k], 0.0) / sum;
        }
        number[i] = next++;
    }
}

/* The material of a span's yarn: its place in the network's list. */
static int yci_weave_choose(const yci_weaver *w, const yci_weave_span *span) {
    const yc_weave_desc *d = w->desc;
    int f = span->family;
    if (f == YC_ROD || !d->material_count || !d->order[f]) return f;
    return (d->rod.density > 0.0 ? 3 : 2) + d->order[f][yci_weave_repeat(span->line, d->order_count[f])];
}

/* Holds the last crossings at selvedges, beyond which a yarn may have a tail. */
static void yci_weave_hold(const yci_weaver *w, yc_yarns *y) {
    int i, e, yarn = 0;
    for (i = 0; i < w->span_count; i++) {
        const yci_weave_span *span = &w->spans[i];
        if (!span->count) continue;
        for (e = 0; e < 2 && span->family != YC_ROD; e++)
            if (span->tip[e] >= 0 && yci_weave_selvedge(w, span, e))
                y->visit_held[e ? y->yarn_first[yarn + 1] - 2 : y->yarn_first[yarn] + 1] = 1;
        yarn++;
    }
}

/* The side of its node on which a visit passes at rest, m. */
static double yci_visit_rise(const yc_yarns *y, int visit) {
    return y->visit_height ? y->visit_height[visit] * y->visit_layer[visit] : 0.0;
}

static void yci_weave_fill_yarns(const yci_weaver *w, yc_yarns *y, const int *number) {
    int i, k, yarn = 0, visit = 0;
    for (i = 0; i < w->span_count; i++) {
        const yci_weave_span *span = &w->spans[i];
        int first = visit, before = span->tip[0] >= 0, count = span->count + before + (span->tip[1] >= 0);
        if (!span->count) continue;
        y->yarn_first[yarn] = first;
        y->yarn_family[yarn] = (unsigned char)span->family, y->yarn_material[yarn] = yci_weave_choose(w, span);
        for (k = 0; k < count; k++, visit++) {
            const yci_weave_visit *at =
                k < before || k - before == span->count ? NULL : &w->visits[span->first + k - before];
            int old = at ? at->node : span->tip[k >= before], node = number[old];
            y->visit_node[visit] = node;
            if (w->nodes[old].visits == 2)
                y->visit_layer[visit] =
                    (signed char)(span->family == YC_WARP ? w->nodes[old].over : -w->nodes[old].over);
            if (y->visit_height && y->visit_layer[visit]) y->visit_height[visit] = w->height[span->family];
            if (k == 0) y->visit_u[visit] = 0.0;
            else if (at && span->family == YC_ROD) y->visit_u[visit] = at->along - w->visits[span->first].along;
            else {
                double step[3];
                yci_sub(step, y->layout[node], y->layout[y->visit_node[visit - 1]]);
                step[2] = sqrt(YCI_CRIMP_KAPPA) * (yci_visit_rise(y, visit) - yci_visit_rise(y, visit - 1));
                y->visit_u[visit] = y->visit_u[visit - 1] + yci_norm(step);
            }
            y->visit_held[visit] = span->family == YC_ROD || w->nodes[old].visits == 1 || k == 0 || k == count - 1;
        }
        yarn++;
    }
    y->yarn_first[yarn] = visit;
}

static yc_result yci_weave_finish(yci_weaver *w, int on_mesh, yc_yarns *out) {
    yc_yarns y;
    char *block;
    int *number, rods, i, crimped = w->desc->crimp[0] > 0.0 || w->desc->crimp[1] > 0.0;
    memset(&y, 0, sizeof y);
    for (i = 0; i < w->node_count; i++) y.node_count += w->nodes[i].visits > 0;
    for (i = 0; i < w->span_count; i++) {
        const yci_weave_span *span = &w->spans[i];
        if (!span->count) continue;
        y.yarn_count++;
        y.visit_count += span->count + (span->tip[0] >= 0) + (span->tip[1] >= 0);
    }
    if (!y.yarn_count)
        return YCI_FAIL(w->c, YC_ERROR_ARGUMENT, "weave.spacing = %g, %g is too wide: nowhere do two yarns cross",
            w->desc->spacing[0], w->desc->spacing[1]);
    rods = w->desc->rod.density > 0.0;
    y.material_count = 2 + rods + w->desc->material_count;
    number = YCI_NEW(w->c, int, w->node_count);
    block = (char *)yci_alloc(w->c, yci_weave_arrays(&y, NULL, on_mesh, crimped), 1);
    if (!number || !block) {
        yci_free(w->c, number);
        yci_free(w->c, block);
        return yci_out_of_memory(w->c, "a yarn network");
    }
    yci_weave_arrays(&y, block, on_mesh, crimped);
    y.materials[0] = w->desc->warp, y.materials[1] = w->desc->weft;
    for (i = 0; i < w->desc->material_count; i++) y.materials[2 + rods + i] = w->desc->materials[i];
    for (i = 0; i < y.material_count; i++) yci_yarn_bundle(&y.materials[i], w->desc->bundle);
    if (rods) y.materials[2] = w->desc->rod;
    yci_weave_fill_nodes(w, &y, number);
    yci_weave_fill_yarns(w, &y, number);
    yci_weave_hold(w, &y);
    yci_free(w->c, number);
    *out = y;
    return YC_OK;
}

/* How far a family's yarns pass from their crossings: see Crimp at the chapter's head. */
static double yci_weave_height(const yci_weaver *w, int family) {
    double length = yci_weave_length(w->draft, w->repeat, family, w->desc->crimp[family]);
    return 0.5 * w->desc->spacing[!family] * sqrt((length * length - 1.0) / YCI_CRIMP_KAPPA);
}

static void yci_weave_free(yci_weaver *w) {
    yci_free(w->c, w->twin);
    yci_free(w->c, w->piece_first);
    yci_free(w->c, w->piece_triangle);
    yci_free(w->c, w->span_first);
    yci_free(w->c, w->nodes);
    yci_free(w->c, w->cuts);
    yci_free(w->c, w->spans);
    yci_free(w->c, w->visits);
}

static yc_result yci_weave_lay(yci_weaver *w, int on_mesh, yc_yarns *out) {
    int piece;
    yc_result result = yci_weave_check_count(w);
    if (result == YC_OK) result = yci_weave_pieces(w);
    for (piece = 0; piece < w->piece_count && result == YC_OK; piece++) result = yci_weave_piece(w, piece, on_mesh);
    if (result == YC_OK) yci_weave_prune(w);
    if (result == YC_OK && w->desc->rod.density > 0.0) result = yci_weave_rods(w);
    if (result == YC_OK) result = yci_weave_finish(w, on_mesh, out);
    yci_weave_free(w);
    return result;
}

static yc_result yci_weave_run(yci_context *c, const yc_weave_desc *desc, const yc_mesh *mesh, yc_yarns *out) {
    static const int halves[2][3] = {{0, 1, 2}, {0, 2, 3}};
    double corners[4][2], positions[4][3];
    yc_weave_desc bundled;
    yc_mesh rectangle;
    yci_weaver w;
    yc_result result;
    int k;
    if (!desc) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "desc must not be NULL");
    if (!out) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "out must not be NULL");
    result = yci_weave_check(c, desc, mesh != NULL);
    if (result == YC_OK && mesh) result = yci_mesh_check(c, mesh);
    if (result != YC_OK) return result;
    memset(&w, 0, sizeof w);
    memset(&rectangle, 0, sizeof rectangle);
    for (k = 0; k < 4; k++) {
        corners[k][0] = k == 1 || k == 2 ? desc->size[0] : 0.0, corners[k][1] = k >= 2 ? desc->size[1] : 0.0;
        positions[k][0] = corners[k][0], positions[k][1] = corners[k][1], positions[k][2] = 0.0;
    }
    rectangle.vertex_count = rectangle.uv_count = 4, rectangle.triangle_count = 2;
    rectangle.positions = (const double(*)[3])positions, rectangle.uv = (const double(*)[2])corners;
    rectangle.triangles = halves;
    bundled = *desc;
    bundled.spacing[0] *= desc->bundle, bundled.spacing[1] *= desc->bundle;
    w.c = c, w.desc = &bundled, w.mesh = mesh ? mesh : &rectangle;
    w.uvt = w.mesh->uv_triangles ? w.mesh->uv_triangles : w.mesh->triangles;
    w.draft = desc->draft ? desc->draft : yci_draft_tabby;
    w.repeat[0] = desc->draft ? desc->repeat[0] : 2, w.repeat[1] = desc->draft ? desc->repeat[1] : 2;
    w.turn[0] = cos(desc->grain), w.turn[1] = sin(desc->grain);
    for (k = 0; k < 2; k++) w.height[k] = yci_weave_height(&w, k);
    return yci_weave_lay(&w, mesh != NULL, out);
}

YC_API yc_result yc_weave(
    const yc_host *host, const yc_weave_desc *desc, const yc_mesh *mesh, yc_yarns *out, char *message) {
    yci_context c;
    yc_result result = yci_context_init(&c, host);
    if (result == YC_OK) result = yci_weave_run(&c, desc, mesh, out);
    if (result == YC_OK) memcpy(out->owner, &c, sizeof c);
    return yci_report(&c, result, message);
}

/* The visits of the nodes are counted in memory of malloc: there is no host here. */
YC_API yc_result yc_yarns_check(const yc_yarns *yarns, const yc_mesh *mesh, char *message) {
    yci_context c;
    yc_result result = yci_context_init(&c, NULL);
    if (!yarns) result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "yarns must not be NULL");
    if (result == YC_OK) result = yci_yarns_check(&c, yarns, mesh);
    return yci_report(&c, result, message);
}

/* Frees a block that begins with a copy of the context it came from. */
static void yci_owned_free(void *owner) {
    yci_context c;
    memcpy(&c, owner, sizeof c);
    yci_free(&c, owner);
}

YC_API void yc_yarns_destroy(yc_yarns *yarns) {
    if (yarns && yarns->owner) yci_owned_free(yarns->owner), memset(yarns, 0, sizeof *yarns);
}

/* ---- drafts ------------------------------------------------------------------------------------------------------ */

#define YCI_DRAFT_COUNT 65536    /* warps, wefts, colours of a draft */
#define YCI_DRAFT_CELLS 16777216 /* of each matrix of a loom */
#define YCI_DRAFT_FLOAT 256      /* floats and counts of the weaves with names */
#define YCI_DRAFT_SHAFTS 4096

/* Points the arrays of a draft, whose counts are set, into the block and returns its size, like yci_weave_arrays. */
static size_t yci_draft_arrays(yc_draft *d, char *block, int with_colours) {
    size_t used = 0;
    int f;
    d->owner = yci_weave_carve(block, &used, 1, sizeof(yci_context));
    for (f = 0; f < 2; f++)
        if (d->order_count[f]) d->order[f] = (int *)yci_weave_carve(block, &used, d->order_count[f], sizeof(int));
    if (with_colours) d->colours = (float(*)[3])yci_weave_carve(block, &used, d->colour_count, sizeof *d->colours);
    d->over = (unsigned char *)yci_weave_carve(block, &used, d->repeat[0] * d->repeat[1], 1);
    return used;
}

/* Makes room for a draft whose counts are set, within the limits. */
static yc_result yci_draft_room(yci_context *c, yc_draft *d, int with_colours) {
    char *block = (char *)yci_alloc(c, yci_draft_arrays(d, NULL, with_colours), 1);
    if (!block) return yci_out_of_memory(c, "a draft");
    yci_draft_arrays(d, block, with_colours);
    return YC_OK;
}

static yc_result yci_draft_begin(yci_context *c, const yc_host *host, const yc_draft *out) {
    yc_result result = yci_context_init(c, host);
    if (result == YC_OK && !out) result = YCI_FAIL(c, YC_ERROR_ARGUMENT, "out must not be NULL");
    return result;
}

static yc_result yci_draft_end(
    const yci_context *c, yc_result result, const yc_draft *draft, yc_draft *out, char *message) {
    if (result == YC_OK) *out = *draft, memcpy(out->owner, c, sizeof *c);
    return yci_report(c, result, message);
}

static yc_result yci_draft_range(yci_context *c, const char *name, int value, int low, int high) {
    if (value >= low && value <= high) return YC_OK;
    return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s = %d must lie in %d .. %d", name, value, low, high);
}

static yc_result yci_draft_family(yci_context *c, const char *name, int value) {
    if (value == YC_WARP || value == YC_WEFT) return YC_OK;
    return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s = %d must be YC_WARP or YC_WEFT", name, value);
}

/* Whether the warp of a column passes over the weft of a row, by two numbers and a variant. */
typedef int (*yci_draft_rule)(int column, int row, const int *p);

static int yci_draft_is_basket(int column, int row, const int *p) { return (column / p[0] + row / p[1]) % 2 == 0; }

static int yci_draft_is_twill(int column, int row, const int *p) {
    int repeat = p[0] + p[1], step = p[2] ? row + column : row - column + repeat;
    return step % repeat < p[0];
}

static int yci_draft_is_satin(int column, int row, const int *p) {
    return (column * p[1] % p[0] == row) == (p[2] == YC_WEFT);
}

/* Distances from a corner, column x and row y, both folded at half the repeat: the diamonds' outlines are x = y. Those
 * around (n/2, 0) are filled with warp, short of one crossing beside the outline. */
static int yci_draft_is_honeycomb(int column, int row, const int *p) {
    int x = column > p[0] / 2 ? p[0] - column : column, y = row > p[0] / 2 ? p[0] - row : row;
    return x == y || x - y >= 2;
}

static yc_result yci_draft_weave(
    yci_context *c, int columns, int rows, yci_draft_rule rule, const int *p, yc_draft *draft) {
    yc_result result;
    int i;
    memset(draft, 0, sizeof *draft);
    draft->repeat[0] = columns, draft->repeat[1] = rows;
    result = yci_draft_room(c, draft, 0);
    for (i = 0; i < columns * rows && result == YC_OK; i++)
        draft->over[i] = (unsigned char)rule(i % columns, i / columns, p);
    return result;
}

YC_API yc_result yc_draft_basket(const yc_host *host, int ends, int picks, yc_draft *out, char *message) {
    int p[2] = {ends, picks};
    yci_context c;
    yc_draft draft;
    yc_result result = yci_draft_begin(&c, host, out);
    if (result == YC_OK) result = yci_draft_range(&c, "ends", ends, 1, YCI_DRAFT_FLOAT);
    if (result == YC_OK) result = yci_draft_range(&c, "picks", picks, 1, YCI_DRAFT_FLOAT);
    if (result == YC_OK) result = yci_draft_weave(&c, 2 * ends, 2 * picks, yci_draft_is_basket, p, &draft);
    return yci_draft_end(&c, result, &draft, out, message);
}

YC_API yc_result yc_draft_plain(const yc_host *host, yc_draft *out, char *message) {
    return yc_draft_basket(host, 1, 1, out, message);
}

YC_API yc_result yc_draft_rep(const yc_host *host, int length, int family, yc_draft *out, char *message) {
    int p[2] = {family == YC_WEFT ? length : 1, family == YC_WEFT ? 1 : length};
    yci_context c;
    yc_draft draft;
    yc_result result = yci_draft_begin(&c, host, out);
    if (result == YC_OK) result = yci_draft_range(&c, "length", length, 2, YCI_DRAFT_FLOAT);
    if (result == YC_OK) result = yci_draft_family(&c, "family", family);
    if (result == YC_OK) result = yci_draft_weave(&c, 2 * p[0], 2 * p[1], yci_draft_is_basket, p, &draft);
    return yci_draft_end(&c, result, &draft, out, message);
}

YC_API yc_result yc_draft_twill(const yc_host *host, int over, int under, char hand, yc_draft *out, char *message) {
    int p[3] = {over, under, hand == 'S'};
    yci_context c;
    yc_draft draft;
    yc_result result = yci_draft_begin(&c, host, out);
    if (result == YC_OK) result = yci_draft_range(&c, "over", over, 1, YCI_DRAFT_FLOAT);
    if (result == YC_OK) result = yci_draft_range(&c, "under", under, 1, YCI_DRAFT_FLOAT);
    if (result == YC_OK && hand != 'S' && hand != 'Z')
        result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "hand = %d must be 'S' or 'Z'", hand);
    if (result == YC_OK) result = yci_draft_weave(&c, over + under, over + under, yci_draft_is_twill, p, &draft);
    return yci_draft_end(&c, result, &draft, out, message);
}

YC_API yc_result yc_draft_satin(const yc_host *host, int shafts, int move, int face, yc_draft *out, char *message) {
    int p[3] = {shafts, move, face}, a = shafts, b = move;
    yci_context c;
    yc_draft draft;
    yc_result result = yci_draft_begin(&c, host, out);
    if (result == YC_OK) result = yci_draft_range(&c, "shafts", shafts, 5, YCI_DRAFT_FLOAT);
    if (result == YC_OK) result = yci_draft_range(&c, "move", move, 2, shafts - 2);
    if (result == YC_OK) result = yci_draft_family(&c, "face", face);
    while (result == YC_OK && b) { /* Euclid's algorithm */
        int rest = a % b;
        a = b, b = rest;
    }
    if (result == YC_OK && a > 1)
        result =
            YCI_FAIL(&c, YC_ERROR_ARGUMENT, "move = %d and shafts = %d have the common divisor %d", move, shafts, a);
    if (result == YC_OK) result = yci_draft_weave(&c, shafts, shafts, yci_draft_is_satin, p, &draft);
    return yci_draft_end(&c, result, &draft, out, message);
}

YC_API yc_result yc_draft_honeycomb(const yc_host *host, int n, yc_draft *out, char *message) {
    yci_context c;
    yc_draft draft;
    yc_result result = yci_draft_begin(&c, host, out);
    if (result == YC_OK) result = yci_draft_range(&c, "n", n, 6, YCI_DRAFT_FLOAT);
    if (result == YC_OK && n % 2) result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "n = %d must be even", n);
    if (result == YC_OK) result = yci_draft_weave(&c, n, n, yci_draft_is_honeycomb, &n, &draft);
    return yci_draft_end(&c, result, &draft, out, message);
}

/* A loom as matrices. */
typedef struct {
    int shafts, treadles, sinking;
    unsigned char *thread;          /* [shafts * warps], nonzero: the shaft moves the warp */
    const unsigned char *tieup;     /* [treadles * shafts]; NULL: none */
    const unsigned char *treadling; /* [wefts * treadles] */
} yci_loom;

/* The draw-down: a warp moves where one of its shafts does. */
static yc_result yci_draft_shed(yci_context *c, const yci_loom *loom, yc_draft *draft) {
    size_t warps = (size_t)draft->repeat[0], shafts = (size_t)loom->shafts, i;
    unsigned char *moved = YCI_NEW(c, unsigned char, loom->shafts);
    int r, t, s;
    if (!moved) return yci_out_of_memory(c, "the shafts of a loom");
    for (r = 0; r < draft->repeat[1]; r++) {
        unsigned char *row = draft->over + (size_t)r * warps;
        memset(moved, 0, shafts);
        for (t = 0; t < loom->treadles; t++) {
            if (!loom->treadling[(size_t)r * (size_t)loom->treadles + (size_t)t]) continue;
            if (!loom->tieup) moved[t] = 1;
            for (i = 0; i < shafts && loom->tieup; i++) moved[i] |= loom->tieup[(size_t)t * shafts + i] != 0;
        }
        memset(row, 0, warps);
        for (s = 0; s < loom->shafts; s++)
            for (i = 0; i < warps && moved[s]; i++) row[i] |= loom->thread[(size_t)s * warps + i];
        for (i = 0; i < warps && loom->sinking; i++) row[i] ^= 1;
    }
    yci_free(c, moved);
    return YC_OK;
}

static yc_result yci_draft_check_loom(yci_context *c, const yc_loom *loom) {
    yc_result result;
    int i;
    if (!loom) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "loom must not be NULL");
    result = yci_draft_range(c, "loom.shafts", loom->shafts, 1, YCI_DRAFT_SHAFTS);
    if (result == YC_OK) result = yci_draft_range(c, "loom.treadles", loom->treadles, 1, YCI_DRAFT_SHAFTS);
    if (result == YC_OK)
        result = yci_draft_range(
            c, "loom.count[0]", loom->count[0], 1, yci_min_int(YCI_DRAFT_COUNT, YCI_DRAFT_CELLS / loom->shafts));
    if (result == YC_OK)
        result = yci_draft_range(
            c, "loom.count[1]", loom->count[1], 1, yci_min_int(YCI_DRAFT_COUNT, YCI_DRAFT_CELLS / loom->count[0]));
    if (result != YC_OK) return result;
    if (!loom->threading) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "loom.threading must not be NULL");
    if (!loom->treadling) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "loom.treadling must not be NULL");
    if (!loom->tieup && loom->treadles != loom->shafts)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "loom.treadles = %d must be shafts, %d, without a tieup", loom->treadles,
            loom->shafts);
    for (i = 0; i < loom->count[0]; i++)
        if (loom->threading[i] < -1 || loom->threading[i] >= loom->shafts)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "loom.threading[%d] = %d must lie in -1 .. %d", i, loom->threading[i],
                loom->shafts - 1);
    return YC_OK;
}

YC_API yc_result yc_draft_loom(const yc_host *host, const yc_loom *loom, yc_draft *out, char *message) {
    yci_loom set;
    yci_context c;
    yc_draft draft;
    yc_result result = yci_draft_begin(&c, host, out);
    int i;
    memset(&set, 0, sizeof set);
    memset(&draft, 0, sizeof draft);
    if (result == YC_OK) result = yci_draft_check_loom(&c, loom);
    if (result == YC_OK) {
        draft.repeat[0] = loom->count[0], draft.repeat[1] = loom->count[1];
        set.shafts = loom->shafts, set.treadles = loom->treadles, set.sinking = loom->sinking;
        set.tieup = loom->tieup, set.treadling = loom->treadling;
        set.thread = YCI_NEW(&c, unsigned char, (size_t)loom->shafts *(size_t)loom->count[0]);
        result = set.thread ? yci_draft_room(&c, &draft, 0) : yci_out_of_memory(&c, "the threading of a loom");
    }
    if (result == YC_OK) {
        for (i = 0; i < loom->count[0]; i++)
            if (loom->threading[i] >= 0)
                set.thread[(size_t)loom->threading[i] * (size_t)loom->count[0] + (size_t)i] = 1;
        result = yci_draft_shed(&c, &set, &draft);
        if (result != YC_OK) yci_free(&c, draft.owner);
    }
    yci_free(&c, set.thread);
    return yci_draft_end(&c, result, &draft, out, message);
}

YC_API void yc_draft_destroy(yc_draft *draft) {
    if (draft && draft->owner) yci_owned_free(draft->owner), memset(draft, 0, sizeof *draft);
}

YC_API void yc_draft_use(const yc_draft *draft, yc_weave_desc *desc) {
    int f;
    desc->draft = draft->over;
    for (f = 0; f < 2; f++) {
        desc->repeat[f] = draft->repeat[f];
        desc->order[f] = draft->order[f], desc->order_count[f] = draft->order_count[f];
        if (draft->spacing[f] > 0.0) desc->spacing[f] = draft->spacing[f];
    }
}

/* Longest run of equal crossings along yarn `line` of a family, which closes upon itself; 0 where all are equal. */
static int yci_draft_float(const yc_draft *d, int family, int line) {
    size_t columns = (size_t)d->repeat[0], step = family == YC_WARP ? columns : 1;
    const unsigned char *at = d->over + (family == YC_WARP ? (size_t)line : (size_t)line * columns);
    int count = d->repeat[1 - family], first = 1, run = 0, longest = 0, k;
    while (first < count && !at[(size_t)first * step] == !at[0]) first++; /* where the first run ends */
    if (first == count) return 0;
    for (k = 0; k < count; k++) {
        int here = (first + k) % count;
        run = k && !at[(size_t)here * step] == !at[(size_t)((here + count - 1) % count) * step] ? run + 1 : 1;
        if (run > longest) longest = run;
    }
    return longest;
}

/* How many of the repeat's yarns, warps first, lie above warp 0 (up 1) or below it (0), be it by way of others. `seen`
 * is zero; `queue` has room for all. */
static int yci_draft_reach(const yc_draft *d, int up, unsigned char *seen, int *queue) {
    int columns = d->repeat[0], begin, end = 1, k;
    queue[0] = 0, seen[0] = 1;
    for (begin = 0; begin < end; begin++) {
        int at = queue[begin], warp = at < columns;
        for (k = warp ? columns : 0; k < (warp ? columns + d->repeat[1] : columns); k++) {
            int c = warp ? at : k, r = (warp ? k : at) - columns;
            int over = d->over[(size_t)r * (size_t)columns + (size_t)c] != 0;
            if (seen[k] || (over == warp) == up) continue;
            seen[k] = 1, queue[end++] = k;
        }
    }
    return end;
}

YC_API yc_result yc_draft_examine(const yc_host *host, const yc_draft *draft, yc_draft_facts *out, char *message) {
    yci_context c;
    yc_result result = yci_context_init(&c, host);
    int f, i, up, total, *queue;
    unsigned char *seen;
    if (result == YC_OK && (!draft || !draft->over || !out))
        result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "draft, draft.over and out must not be NULL");
    for (f = 0; f < 2 && result == YC_OK; f++) {
        const char *name = f ? "draft.repeat[1]" : "draft.repeat[0]";
        result = yci_draft_range(&c, name, draft->repeat[f], 1, YCI_WEAVE_LIMIT);
    }
    if (result != YC_OK) return yci_report(&c, result, message);
    total = draft->repeat[0] + draft->repeat[1];
    seen = YCI_NEW(&c, unsigned char, total), queue = YCI_NEW(&c, int, total);
    if (seen && queue) {
        /* Cloth falls apart where some yarns lie above all others: where "above" is not strongly connected. */
        out->holds = 1;
        for (up = 0; up < 2; up++) {
            memset(seen, 0, (size_t)total);
            if (yci_draft_reach(draft, up, seen, queue) < total) out->holds = 0;
        }
        for (f = 0; f < 2; f++) {
            out->longest[f] = yci_draft_float(draft, f, 0);
            for (i = 1; i < draft->repeat[f] && out->longest[f]; i++) {
                int here = yci_draft_float(draft, f, i);
                if (!here || here > out->longest[f]) out->longest[f] = here;
            }
        }
    } else result = yci_out_of_memory(&c, "the examination of a draft");
    yci_free(&c, seen);
    yci_free(&c, queue);
    return yci_report(&c, result, message);
}

/* ---- Weaving Information Files ----------------------------------------------------------------------------------- */

/* Sections that are read. Those of the warp come right before those of the weft. */
enum {
    YCI_WIF_WEAVING,
    YCI_WIF_PALETTE,
    YCI_WIF_TABLE,
    YCI_WIF_TIEUP,
    YCI_WIF_THREADING,
    YCI_WIF_TREADLING,
    YCI_WIF_LIFTPLAN,
    YCI_WIF_WARP,
    YCI_WIF_WEFT,
    YCI_WIF_WARP_COLOURS,
    YCI_WIF_WEFT_COLOURS,
    YCI_WIF_WARP_SPACING,
    YCI_WIF_WEFT_SPACING,
    YCI_WIF_WARP_THICKNESS,
    YCI_WIF_WEFT_THICKNESS,
    YCI_WIF_COUNT /* any other section */
};
static const char *const yci_wif_names[] = {"WEAVING", "COLOR PALETTE", "COLOR TABLE", "TIEUP", "THREADING",
    "TREADLING", "LIFTPLAN", "WARP", "WEFT", "WARP COLORS", "WEFT COLORS", "WARP SPACING", "WEFT SPACING",
    "WARP THICKNESS", "WEFT THICKNESS"};

typedef struct {
    const char *at, *end;
} yci_wif_text;

typedef struct {
    yci_context *c;
    yci_wif_text rest;       /* of the file */
    int line, section;       /* where the reader stands */
    yci_wif_text key, value; /* of this line */
    yc_result result;
    /* what the first reading finds */
    int shafts, treadles, falling;
    int count[2], colour[2], symbols; /* 0: not given; colours from 1 */
    double length[2][2], unit[2];     /* spacing and thickness of both families, in this unit of m; 0: not given */
    int entries, highest;             /* colours as announced; highest number in the table */
    double range[2];
    int lines[YCI_WIF_COUNT]; /* of each section */
    /* what the second one fills */
    yci_loom loom;
    unsigned char *tieup, *treadling;
    int last[2];      /* warp of the threading, weft of the treadling or liftplan that a line has; from 1 */
    double sum[2][2]; /* of the lengths of single threads, `given` of them */
    int given[2][2];
} yci_wif;

static int yci_wif_space(int byte) { return byte == ' ' || byte == '\t' || byte == '\v' || byte == '\f'; }

static void yci_wif_trim(yci_wif_text *t) {
    while (t->at < t->end && yci_wif_space(*t->at)) t->at++;
    while (t->at < t->end && yci_wif_space(t->end[-1])) t->end--;
}

static int yci_wif_upper(int byte) { return byte >= 'a' && byte <= 'z' ? byte - 'a' + 'A' : byte; }

/* Whether the text is this name, in capitals here, in any case there. */
static int yci_wif_is(yci_wif_text t, const char *name) {
    for (; t.at < t.end && *name; t.at++, name++)
        if (yci_wif_upper(*t.at) != *name) return 0;
    return t.at == t.end && !*name;
}

static int yci_wif_wrong(yci_wif *w, const char *expected, yci_wif_text found) {
    int length = (int)yci_min((double)(found.end - found.at), 40.0);
    w->result =
        YCI_FAIL(w->c, YC_ERROR_PARSE, "wif line %d: expected %s, found \"%.*s\"", w->line, expected, length, found.at);
    return 0;
}

/* Moves to the next line `key = value` of a section that is read. 0 at the end, and after an error. */
static int yci_wif_next(yci_wif *w) {
    while (w->rest.at < w->rest.end) {
        yci_wif_text line;
        line.at = w->rest.at;
        while (w->rest.at < w->rest.end && *w->rest.at != '\n' && *w->rest.at != '\r') w->rest.at++;
        line.end = w->rest.at;
        if (w->rest.end - w->rest.at >= 2 && w->rest.at[0] == '\r' && w->rest.at[1] == '\n') w->rest.at++;
        if (w->rest.at < w->rest.end) w->rest.at++;
        w->line++;
        for (w->key.at = line.at; w->key.at < line.end && *w->key.at != ';';) w->key.at++;
        line.end = w->key.at; /* a comment */
        yci_wif_trim(&line);
        if (line.at == line.end) continue;
        if (*line.at == '[') {
            if (line.end[-1] != ']') return yci_wif_wrong(w, "a section's name in brackets", line);
            line.at++, line.end--;
            yci_wif_trim(&line);
            for (w->section = 0; w->section < YCI_WIF_COUNT; w->section++)
                if (yci_wif_is(line, yci_wif_names[w->section])) break;
            continue;
        }
        if (w->section == YCI_WIF_COUNT) continue;
        w->key = w->value = line;
        while (w->value.at < w->value.end && *w->value.at != '=') w->value.at++;
        if (w->value.at == w->value.end) return yci_wif_wrong(w, "key=value", line);
        w->key.end = w->value.at++;
        yci_wif_trim(&w->key);
        yci_wif_trim(&w->value);
        return 1;
    }
    return 0;
}

/* Takes the next number off a list with commas. 0 at the list's end, and after an error. */
static int yci_wif_number(yci_wif *w, yci_wif_text *list, double *number) {
    const char *begin;
    double sign = 1.0, place = 1.0;
    int digits = 0;
    yci_wif_trim(list);
    if (list->at == list->end) return 0;
    begin = list->at;
    if (*list->at == '-' || *list->at == '+') sign = *list->at++ == '-' ? -1.0 : 1.0;
    for (*number = 0.0; list->at < list->end && *list->at >= '0' && *list->at <= '9'; list->at++, digits++)
        *number = *number * 10.0 + (*list->at - '0');
    if (list->at < list->end && *list->at == '.')
        for (list->at++; list->at < list->end && *list->at >= '0' && *list->at <= '9'; list->at++, digits++)
            place *= 0.1, *number += place * (*list->at - '0');
    *number *= sign;
    yci_wif_trim(list);
    if (!digits || !yci_finite(*number) || (list->at < list->end && *list->at != ',')) {
        list->at = begin;
        return yci_wif_wrong(w, "a number", *list);
    }
    if (list->at < list->end) list->at++;
    return 1;
}

/* The next number of a list as a whole one. 0 at the list's end, and after an error. */
static int yci_wif_whole(yci_wif *w, yci_wif_text *list, const char *what, int low, int high, int *whole) {
    yci_wif_text before = *list;
    double number;
    char expected[80];
    if (!yci_wif_number(w, list, &number)) return 0;
    if (number >= low && number <= high && floor(number) == number) {
        *whole = (int)number;
        return 1;
    }
    snprintf(expected, sizeof expected, "%s in %d .. %d", what, low, high);
    return yci_wif_wrong(w, expected, before);
}

/* The key of a line as a number from 1 on. 0 after an error. */
static int yci_wif_key(yci_wif *w, const char *what, int high, int *number) {
    yci_wif_text list = w->key;
    if (yci_wif_whole(w, &list, what, 1, high, number) && list.at == list.end) return 1;
    return w->result == YC_OK ? yci_wif_wrong(w, what, w->key) : 0;
}

/* The first number of a line's value; an error where there is none. */
static void yci_wif_count(yci_wif *w, const char *what, int low, int high, int *whole) {
    yci_wif_text list = w->value;
    if (!yci_wif_whole(w, &list, what, low, high, whole) && w->result == YC_OK) yci_wif_wrong(w, what, w->value);
}

static void yci_wif_length(yci_wif *w, double *length) {
    yci_wif_text list = w->value;
    if (yci_wif_number(w, &list, length) ? *length <= 0.0 : w->result == YC_OK)
        yci_wif_wrong(w, "a length above 0", w->value);
}

static void yci_wif_read_family(yci_wif *w, int f) {
    if (yci_wif_is(w->key, "THREADS")) yci_wif_count(w, "a number of threads", 1, YCI_DRAFT_COUNT, &w->count[f]);
    else if (yci_wif_is(w->key, "COLOR")) yci_wif_count(w, "a colour", 1, YCI_DRAFT_COUNT, &w->colour[f]);
    else if (yci_wif_is(w->key, "SPACING")) yci_wif_length(w, &w->length[f][0]);
    else if (yci_wif_is(w->key, "THICKNESS")) yci_wif_length(w, &w->length[f][1]);
    else if (yci_wif_is(w->key, "UNITS")) {
        if (yci_wif_is(w->value, "DECIPOINTS")) w->unit[f] = 0.0254 / 720.0;
        else if (yci_wif_is(w->value, "INCHES")) w->unit[f] = 0.0254;
        else if (yci_wif_is(w->value, "CENTIMETERS") || yci_wif_is(w->value, "CENTIMETRES")) w->unit[f] = 0.01;
        else yci_wif_wrong(w, "Decipoints, Inches or Centimeters", w->value);
    }
}

static void yci_wif_read_weaving(yci_wif *w) {
    static const char *const words[] = {"TRUE", "YES", "ON", "T", "1", "FALSE", "NO", "OFF", "F", "0"};
    int i;
    if (yci_wif_is(w->key, "SHAFTS")) yci_wif_count(w, "a number of shafts", 1, YCI_DRAFT_SHAFTS, &w->shafts);
    else if (yci_wif_is(w->key, "TREADLES"))
        yci_wif_count(w, "a number of treadles", 0, YCI_DRAFT_SHAFTS, &w->treadles);
    else if (yci_wif_is(w->key, "RISING SHED")) {
        for (i = 0; i < 10 && !yci_wif_is(w->value, words[i]);) i++;
        w->falling = i >= 5;
        if (i == 10) yci_wif_wrong(w, "true or false", w->value);
    }
}

static void yci_wif_read_palette(yci_wif *w) {
    yci_wif_text list = w->value;
    if (yci_wif_is(w->key, "ENTRIES")) yci_wif_count(w, "a number of colours", 1, YCI_DRAFT_COUNT, &w->entries);
    else if (yci_wif_is(w->key, "FORM")) w->symbols = !yci_wif_is(w->value, "RGB");
    else if (yci_wif_is(w->key, "RANGE")) {
        if (yci_wif_number(w, &list, &w->range[0]) && yci_wif_number(w, &list, &w->range[1]) &&
            w->range[0] < w->range[1])
            return;
        if (w->result == YC_OK) yci_wif_wrong(w, "two numbers, the second greater", w->value);
    }
}

/* First reading: sizes, and how many lines each section has. */
static void yci_wif_read_sizes(yci_wif *w) {
    w->section = YCI_WIF_COUNT;
    while (w->result == YC_OK && yci_wif_next(w)) {
        int number;
        w->lines[w->section]++;
        if (w->section == YCI_WIF_WEAVING) yci_wif_read_weaving(w);
        else if (w->section == YCI_WIF_PALETTE) yci_wif_read_palette(w);
        else if (w->section == YCI_WIF_WARP || w->section == YCI_WIF_WEFT)
            yci_wif_read_family(w, w->section - YCI_WIF_WARP);
        else if (w->section == YCI_WIF_TABLE && yci_wif_key(w, "a colour", YCI_DRAFT_COUNT, &number) &&
            number > w->highest)
            w->highest = number;
    }
}

static yc_result yci_wif_missing(yci_wif *w, const char *what) {
    return YCI_FAIL(w->c, YC_ERROR_PARSE, "wif: %s", what);
}

static int yci_wif_fits(yci_wif *w, const char *rows, int row_count, const char *columns, int column_count) {
    if (!column_count || row_count <= YCI_DRAFT_CELLS / column_count) return 1;
    w->result = YCI_FAIL(w->c, YC_ERROR_PARSE, "wif: %d %s by %d %s are more than %d", row_count, rows, column_count,
        columns, YCI_DRAFT_CELLS);
    return 0;
}

/* Whether the sizes make sense together. */
static yc_result yci_wif_check(yci_wif *w) {
    if (!w->shafts) return yci_wif_missing(w, "Shafts is missing in [WEAVING]");
    if (!w->count[0]) return yci_wif_missing(w, "Threads is missing in [WARP]");
    if (!w->count[1]) return yci_wif_missing(w, "Threads is missing in [WEFT]");
    if (!yci_wif_fits(w, "warps", w->count[0], "wefts", w->count[1]) ||
        !yci_wif_fits(w, "warps", w->count[0], "shafts", w->shafts) ||
        !yci_wif_fits(w, "wefts", w->count[1], "shafts", w->shafts) ||
        !yci_wif_fits(w, "wefts", w->count[1], "treadles", w->treadles))
        return w->result;
    if (!w->lines[YCI_WIF_THREADING]) return yci_wif_missing(w, "[THREADING] is missing");
    if (w->lines[YCI_WIF_LIFTPLAN]) return YC_OK;
    if (!w->lines[YCI_WIF_TREADLING]) return yci_wif_missing(w, "[TREADLING] and [LIFTPLAN] are missing");
    if (!w->lines[YCI_WIF_TIEUP]) return yci_wif_missing(w, "[TIEUP] and [LIFTPLAN] are missing");
    if (!w->treadles) return yci_wif_missing(w, "Treadles is missing in [WEAVING]");
    return YC_OK;
}

/* A line `row = columns` as a row of a matrix; rows and columns count from 1. `across`: the row is a column of it.
 * The highest row so far; 0: refused. */
static int yci_wif_read_row(yci_wif *w, int last, unsigned char *matrix, const char *row_name, int rows,
    const char *column_name, int columns, int across) {
    yci_wif_text list = w->value;
    size_t row_step = across ? 1 : (size_t)columns, column_step = across ? (size_t)rows : 1;
    int row, column;
    if (!yci_wif_key(w, row_name, rows, &row)) return 0;
    matrix += (size_t)(row - 1) * row_step;
    for (column = 0; column < columns; column++) matrix[(size_t)column * column_step] = 0;
    while (yci_wif_whole(w, &list, column_name, 0, columns, &column))
        if (column) matrix[(size_t)(column - 1) * column_step] = 1;
    return row > last ? row : last;
}

static void yci_wif_read_colour(yci_wif *w, yc_draft *draft) {
    yci_wif_text list = w->value;
    double value;
    int number, k;
    if (!yci_wif_key(w, "a colour", draft->colour_count, &number)) return;
    for (k = 0; k < 3; k++) {
        if (!yci_wif_number(w, &list, &value) || value < w->range[0] || value > w->range[1]) {
            if (w->result == YC_OK) yci_wif_wrong(w, "three numbers in the palette's range", w->value);
            return;
        }
        draft->colours[number - 1][k] = (float)((value - w->range[0]) / (w->range[1] - w->range[0]));
    }
}

/* What a section says of single threads of a family: colour (kind -1), spacing (0), thickness (1). */
static void yci_wif_read_thread(yci_wif *w, yc_draft *draft, int f, int kind) {
    double length = 0.0;
    int thread, highest = draft->colour_count ? draft->colour_count : YCI_DRAFT_COUNT;
    if (!yci_wif_key(w, "a thread", w->count[f], &thread)) return;
    if (kind < 0) {
        yci_wif_count(w, "a colour", 1, highest, &draft->order[f][thread - 1]);
        return;
    }
    yci_wif_length(w, &length);
    if (w->result == YC_OK) w->sum[f][kind] += length, w->given[f][kind]++;
}

/* Second reading: what the sections say. */
static void yci_wif_read_lists(yci_wif *w, yc_draft *draft) {
    int liftplan = w->lines[YCI_WIF_LIFTPLAN] > 0, section;
    w->section = YCI_WIF_COUNT, w->line = 0;
    while (w->result == YC_OK && yci_wif_next(w)) {
        section = w->section;
        if (section == YCI_WIF_THREADING)
            w->last[0] =
                yci_wif_read_row(w, w->last[0], w->loom.thread, "a warp", w->count[0], "a shaft", w->shafts, 1);
        else if (section == YCI_WIF_LIFTPLAN)
            w->last[1] = yci_wif_read_row(w, w->last[1], w->treadling, "a weft", w->count[1], "a shaft", w->shafts, 0);
        else if (section == YCI_WIF_TREADLING && !liftplan)
            w->last[1] =
                yci_wif_read_row(w, w->last[1], w->treadling, "a weft", w->count[1], "a treadle", w->treadles, 0);
        else if (section == YCI_WIF_TIEUP && !liftplan)
            yci_wif_read_row(w, 0, w->tieup, "a treadle", w->treadles, "a shaft", w->shafts, 0);
        else if (section == YCI_WIF_TABLE && draft->colours) yci_wif_read_colour(w, draft);
        else if (section >= YCI_WIF_WARP_COLOURS && section < YCI_WIF_COUNT)
            yci_wif_read_thread(
                w, draft, (section - YCI_WIF_WARP_COLOURS) % 2, (section - YCI_WIF_WARP_COLOURS) / 2 - 1);
    }
}

/* Threads that lift nothing may be left out, but not the last: then the file has most likely been cut off. */
static yc_result yci_wif_whole_lists(yci_wif *w) {
    int f;
    for (f = 0; f < 2; f++)
        if (w->last[f] < w->count[f])
            return YCI_FAIL(w->c, YC_ERROR_PARSE, "wif: [%s] ends with %s %d of %d; 0 would say that it lifts nothing",
                f == 0                               ? "THREADING"
                    : w->lines[YCI_WIF_LIFTPLAN] > 0 ? "LIFTPLAN"
                                                     : "TREADLING",
                f ? "weft" : "warp", w->last[f], w->count[f]);
    return YC_OK;
}

/* The counts of the draft's arrays, and room for them. */
static yc_result yci_wif_room(yci_wif *w, yc_draft *draft) {
    int f, liftplan = w->lines[YCI_WIF_LIFTPLAN] > 0, coloured;
    int ordered;
    size_t warps = (size_t)w->count[0], wefts = (size_t)w->count[1], shafts = (size_t)w->shafts;
    size_t treadles = liftplan ? shafts : (size_t)w->treadles;
    w->loom.shafts = w->shafts, w->loom.treadles = (int)treadles, w->loom.sinking = w->falling;
    w->loom.thread = YCI_NEW(w->c, unsigned char, warps *shafts);
    w->treadling = YCI_NEW(w->c, unsigned char, wefts *treadles);
    w->tieup = YCI_NEW(w->c, unsigned char, liftplan ? 0 : treadles *shafts);
    if (!w->loom.thread || !w->treadling || !w->tieup) return yci_out_of_memory(w->c, "a weaving information file");
    w->loom.treadling = w->treadling, w->loom.tieup = liftplan ? NULL : w->tieup;
    for (f = 0; f < 2; f++) {
        draft->repeat[f] = w->count[f];
        draft->order_count[f] = w->lines[YCI_WIF_WARP_COLOURS + f] ? w->count[f] : w->colour[f] > 0;
    }
    ordered = draft->order_count[0] || draft->order_count[1];
    coloured = ordered && w->highest && !w->symbols;
    draft->colour_count = !ordered ? 0 : w->entries ? w->entries : coloured ? w->highest : 0;
    return yci_draft_room(w->c, draft, coloured);
}

/* Turns the orders' colours, which count from 1 and are 0 where none is given, into indices. */
static yc_result yci_wif_colours(yci_wif *w, yc_draft *draft) {
    int f, k, colour, highest = 0;
    for (f = 0; f < 2; f++)
        for (k = 0; k < draft->order_count[f]; k++) {
            colour = draft->order[f][k] ? draft->order[f][k] : w->colour[f];
            if (!colour)
                return YCI_FAIL(w->c, YC_ERROR_PARSE, "wif: thread %d has no colour in [%s COLORS], [%s] no Color",
                    k + 1, yci_wif_names[YCI_WIF_WARP + f], yci_wif_names[YCI_WIF_WARP + f]);
            if ((draft->colour_count && colour > draft->colour_count) ||
                (draft->colours && draft->colours[colour - 1][0] < 0.0f))
                return YCI_FAIL(w->c, YC_ERROR_PARSE, "wif: colour %d of [%s] is not in [COLOR TABLE]", colour,
                    yci_wif_names[YCI_WIF_WARP + f]);
            draft->order[f][k] = colour - 1;
            if (colour > highest) highest = colour;
        }
    for (k = 0; k < draft->colour_count && draft->colours; k++)
        if (draft->colours[k][0] < 0.0f) draft->colours[k][0] = 0.0f; /* not in the table, and not used */
    if (!draft->colour_count) draft->colour_count = highest;          /* the file does not say how many there are */
    return YC_OK;
}

static yc_result yci_wif_run(yci_wif *w, const char *text, size_t length, yc_draft *draft) {
    yci_wif_text all;
    yc_result result;
    int f, k;
    all.at = text, all.end = text + length;
    if (length >= 3 && !memcmp(text, "\xef\xbb\xbf", 3)) all.at += 3; /* a mark of UTF-8 */
    w->rest = all, w->range[1] = 255.0;
    yci_wif_read_sizes(w);
    result = w->result == YC_OK ? yci_wif_check(w) : w->result;
    if (result == YC_OK) result = yci_wif_room(w, draft);
    if (result != YC_OK) return result;
    for (k = 0; k < draft->colour_count && draft->colours; k++) draft->colours[k][0] = -1.0f;
    w->rest = all;
    yci_wif_read_lists(w, draft);
    for (f = 0; f < 2; f++)
        for (k = 0; k < 2; k++) {
            int others = w->length[f][k] > 0.0 ? w->count[f] - w->given[f][k] : 0;
            double sum = w->sum[f][k] + (others > 0 ? others * w->length[f][k] : 0.0);
            int counted = w->given[f][k] + (others > 0 ? others : 0);
            (k ? draft->thickness : draft->spacing)[f] = counted ? sum / counted * w->unit[f] : 0.0;
        }
    result = w->result == YC_OK ? yci_wif_whole_lists(w) : w->result;
    if (result == YC_OK) result = yci_wif_colours(w, draft);
    return result == YC_OK ? yci_draft_shed(w->c, &w->loom, draft) : result;
}

YC_API yc_result yc_draft_wif(const yc_host *host, const char *text, size_t length, yc_draft *out, char *message) {
    yci_context c;
    yc_draft draft;
    yci_wif w;
    yc_result result = yci_draft_begin(&c, host, out);
    memset(&w, 0, sizeof w);
    memset(&draft, 0, sizeof draft);
    w.c = &c;
    if (result == YC_OK && !text) result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "text must not be NULL");
    if (result == YC_OK) result = yci_wif_run(&w, text, length, &draft);
    yci_free(&c, w.loom.thread);
    yci_free(&c, w.treadling);
    yci_free(&c, w.tieup);
    if (result != YC_OK) yci_free(&c, draft.owner);
    return yci_draft_end(&c, result, &draft, out, message);
}

/* ---- fabrics ----------------------------------------------------------------------------------------------------- */

/* Typical values of fibres and of yarns made of them; single yarns differ by a factor of two.
 *   density   g/cm^3 of the fibre (Morton and Hearle)
 *   packing   share of fibre in the yarn; with it Peirce's diameter is 0.0374 sqrt(tex) mm for cotton (Peirce 1937),
 *             0.036 for linen and filaments, 0.043 for worsted wool
 *   fibre     tex of one fibre
 *   rigidity  R, specific flexural rigidity in mN mm^2/tex^2 (Morton and Hearle); that of flax from its modulus,
 *             18 N/tex / (4 pi density)
 *   modulus, tenacity   N/tex of the yarn: staple yarns have about half of their fibres'
 *   friction  between yarns; it falls as the load rises, and wool's depends on the direction */
static const struct {
    double density, packing, fibre, rigidity, modulus, tenacity, friction;
} yci_fibre_values[] = {
    {1.52, 0.60, 0.17, 0.53, 3.3, 0.16, 0.30},  /* cotton */
    {1.50, 0.65, 0.30, 0.95, 9.0, 0.25, 0.25},  /* linen */
    {1.31, 0.525, 0.50, 0.24, 1.1, 0.07, 0.30}, /* wool */
    {1.34, 0.70, 0.13, 0.60, 7.0, 0.30, 0.25},  /* silk */
    {1.50, 0.60, 0.17, 0.35, 2.5, 0.12, 0.30},  /* viscose */
    {1.38, 0.71, 0.20, 0.30, 9.0, 0.40, 0.25},  /* polyester */
};

YC_API yc_yarn_desc yc_yarn_desc_default(void) {
    yc_yarn_desc d;
    memset(&d, 0, sizeof d);
    d.cookie = YCI_DESC_COOKIE, d.fibre = YC_FIBRE_COTTON, d.tex = 15.0;
    return d;
}

/* Replaces what is 0 by the usual. */
static yc_yarn_desc yci_yarn_resolve(const yc_yarn_desc *desc) {
    yc_yarn_desc d = *desc;
    if (d.fibre_tex == 0.0) d.fibre_tex = yci_min(yci_fibre_values[d.fibre].fibre, d.tex);
    if (d.packing == 0.0) d.packing = yci_fibre_values[d.fibre].packing;
    if (d.bending_factor == 0.0) d.bending_factor = yci_min(2.5, d.tex / d.fibre_tex);
    return d;
}

static yc_result yci_yarn_check(yci_context *c, const yc_yarn_desc *d) {
    double most;
    int f = (int)d->fibre;
    if (d->cookie != YCI_DESC_COOKIE)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarn.cookie: not made by yc_yarn_desc_default()");
    if (f < 0 || f >= YC_FIBRE_COUNT)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarn.fibre = %d must lie in 0 .. %d", f, YC_FIBRE_COUNT - 1);
    if (!(d->tex > 0.0 && d->tex <= 1e5))
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarn.tex = %g must lie in (0, 1e5]", d->tex);
    if (!(d->fibre_tex >= 0.0 && d->fibre_tex <= d->tex))
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarn.fibre_tex = %g must lie in [0, %g]", d->fibre_tex, d->tex);
    if (!(d->packing >= 0.0 && d->packing <= 1.0))
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarn.packing = %g must lie in [0, 1]", d->packing);
    most = d->tex / yci_yarn_resolve(d).fibre_tex;
    if (d->bending_factor != 0.0 && !(d->bending_factor >= 1.0 && d->bending_factor <= most))
        return YCI_FAIL(
            c, YC_ERROR_ARGUMENT, "yarn.bending_factor = %g must be 0 or lie in [1, %g]", d->bending_factor, most);
    return YC_OK;
}

#define YCI_TRANSVERSE_SHEAR \
    5e6 /* Pa, of a yarn across its fibres: twist is all that holds them; within a factor of 2 */
#define YCI_WEAVING_TENSION 1e-2 /* N/tex; on looms 0.005 to 0.015 */
#define YCI_FINISHED 0.05        /* what washing, heat and rest leave of the forces of weaving; an order of magnitude */
#define YCI_FRICTION_REACH 0.015 /* radii a yarn moves before friction gives way, see yci_yarn_make */

/* k_x, N, of yarns of a radius whose crossings are `spacing` apart: two elastic bodies that touch on a disc of their
 * radius, and turn on each other by an angle, resist by (8/3) G radius^3 (Reissner and Sagoci 1944), which are four
 * pairs of neighbouring segments of k_x spacing each. */
static double yci_yarn_shear_of(double radius, double spacing) {
    return 2.0 / 3.0 * YCI_TRANSVERSE_SHEAR * radius * radius * radius / spacing;
}

/* What presses yarns together where they bend round each other: 2 T times the slope (Peirce 1937), of the tension that
 * they are woven with, less what finishing relaxes. `length` is that of a yarn from crest to trough, in spacings, which
 * with the height of chapter fabric gives the slope sqrt(kappa (length^2 - 1)) / length. */
static double yci_yarn_preload_of(double tex, double length) {
    return YCI_FINISHED * 2.0 * YCI_WEAVING_TENSION * tex * sqrt(YCI_CRIMP_KAPPA * (length * length - 1.0)) / length;
}

/* What a yarn resists being pressed flat with, N/m: two like cylinders crossed, of Young's modulus 3 G and without
 * change of volume, press by (8/3) G sqrt(radius) d^(3/2) (Hertz 1882); this is its slope where they press by
 * `preload`, and each yarn takes half of d. Yarns in cloth are pressed to 0.6 to 0.8 of their thickness (Kemp 1958), to
 * 0.8 already by their crimp: so they grow stiffer within a fifth of it. Hertz' solid does not; fibres that come closer
 * do (van Wyk 1946). */
static double yci_yarn_flattening_of(double radius, double preload) {
    double modulus = 2.0 * YCI_TRANSVERSE_SHEAR; /* E / (2 (1 - nu^2)) */
    return 2.0 * cbrt(6.0 * modulus * modulus * radius * preload);
}

/* The material of a yarn that was checked. Friction gives way after 0.015 radii, when the yarns of a crossing have
 * turned by 2/3 of that, 0.6 degrees: cloth in shear is stiff at first and yields within the first degree (Grosberg and
 * Park 1966), and its loop is open where it is measured, half a degree from the middle. */
static yc_yarn_material yci_yarn_make(const yc_yarn_desc *desc) {
    yc_yarn_material m = yc_yarn_material_default();
    yc_yarn_desc d = yci_yarn_resolve(desc);
    m.density = d.tex * 1e-6;
    m.radius = sqrt(m.density / (YCI_PI * d.packing * yci_fibre_values[d.fibre].density * 1e3));
    m.stretch = yci_fibre_values[d.fibre].modulus * d.tex, m.strength = yci_fibre_values[d.fibre].tenacity * d.tex;
    m.bending = d.tex * d.fibre_tex * yci_fibre_values[d.fibre].rigidity * d.bending_factor * 1e-9;
    m.crimp_bending = m.bending, m.wrap = 0.005 * m.bending / (m.radius * m.radius), m.stitch = m.stretch;
    m.friction = yci_fibre_values[d.fibre].friction;
    m.contact = d.tex / 15.0;
    /* As in a shirting, whose crossings are 4.5 radii apart and whose yarns are 7 % longer than the cloth. */
    m.shear = yci_yarn_shear_of(m.radius, 4.5 * m.radius), m.preload = yci_yarn_preload_of(d.tex, 1.07);
    m.slide = m.friction * m.preload / (YCI_FRICTION_REACH * m.radius);
    m.flattening = yci_yarn_flattening_of(m.radius, m.preload);
    return m;
}

YC_API yc_result yc_yarn_material_make(const yc_yarn_desc *desc, yc_yarn_material *out, char *message) {
    yci_context c;
    yc_result result = yci_context_init(&c, NULL);
    if (!desc || !out) result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "desc and out must not be NULL");
    if (result == YC_OK) result = yci_yarn_check(&c, desc);
    if (result == YC_OK) *out = yci_yarn_make(desc);
    return yci_report(&c, result, message);
}

/* A fabric as textile engineers write it; wales, courses and loops per cm and in mm, like `range`. */
typedef struct {
    const char *name, *source;
    yc_fibre fibre;
    int repeat;            /* of the draft, 0: plain weave */
    double tex[2];         /* warp and weft; a knit's yarn */
    double per_cm[2];      /* ends and picks; wales and courses */
    double loop;           /* mm; 0: woven */
    double crimp[2];       /* percent */
    double bending_factor; /* of the yarns */
    const unsigned char *draft;
    double mass[2];        /* g/m^2 */
    double bending[2][2];  /* uN m */
    double shear_range[2]; /* N/m per rad */
    double hysteresis[2];  /* gf/cm */
    double tension;        /* N/m */
    double extension[2];   /* percent */
    double drape[2];       /* percent */
} yci_fabric_row;

static const unsigned char yci_draft_denim[16] = {1, 0, 1, 1, 1, 1, 0, 1, 1, 1, 1, 0, 0, 1, 1, 1};
static const unsigned char yci_draft_satin[25] = {
    0, 1, 1, 1, 1, 1, 1, 1, 0, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 0, 1, 1, 0, 1, 1};

static const yci_fabric_row yci_fabric_rows[] = {
    {"cotton shirting",
        "Counts, threads and mass as in the trade; crimp, KES and drape ranges are typical textbook values, single "
        "fabrics differ by a factor of two.",
        YC_FIBRE_COTTON, 0, {15, 15}, {34, 28}, 0, {7, 7}, 2.5, NULL, {95, 130}, {{4, 12}, {4, 12}}, {34, 84}, {1, 3},
        490, {2, 6}, {45, 70}},
    {"linen plain",
        "Counts, threads and mass typical of medium linens; bending, crimp and KES ranges are orders of magnitude.",
        YC_FIBRE_LINEN, 0, {50, 50}, {16, 14}, 0, {5, 5}, 2.5, NULL, {150, 190}, {{20, 60}, {20, 60}}, {40, 110},
        {1.5, 5}, 490, {2, 5}, {60, 85}},
    {"denim 3/1 twill",
        "Counts, threads and mass of a 12 oz denim as in the trade; crimp, KES and drape ranges are typical textbook "
        "values, single fabrics differ by a factor of two.",
        YC_FIBRE_COTTON, 4, {84, 75}, {25, 17}, 0, {11, 3.5}, 2.5, yci_draft_denim, {320, 480}, {{40, 120}, {20, 60}},
        {110, 280}, {4, 10}, 490, {2, 8}, {80, 95}},
    {"polyester satin",
        "A five-end satin of flat filament yarn, counts and threads typical; KES and drape ranges are typical textbook "
        "values, single fabrics differ by a factor of two.",
        YC_FIBRE_POLYESTER, 5, {8.3, 8.3}, {80, 38}, 0, {3, 2}, 1.25, yci_draft_satin, {80, 120}, {{2, 6}, {2, 6}},
        {14, 28}, {0.3, 1}, 490, {2, 8}, {15, 35}},
    {"cotton single jersey",
        "Loop length and count as in the trade, wales and courses near the dry-relaxed ones of Munden 1959; KES and "
        "drape ranges are typical textbook values.",
        YC_FIBRE_COTTON, 0, {20, 20}, {14.8, 19.3}, 2.8, {0, 0}, 2.5, NULL, {140, 180}, {{1, 5}, {1, 5}}, {22, 45},
        {1.5, 4}, 49, {10, 40}, {15, 35}},
    {"wool rib 1x1",
        "Yarn 2/28 Nm and loop length typical, wales and courses from the fully relaxed ones of Munden 1959 for "
        "plain knitting; KES and drape ranges are orders of magnitude.",
        YC_FIBRE_WOOL, 0, {71, 71}, {7.6, 10}, 5.5, {0, 0}, 2.5, NULL, {250, 320}, {{10, 40}, {10, 40}}, {28, 56},
        {2, 5}, 49, {40, 100}, {20, 45}},
    {"wool stockinette",
        "DK yarn at the gauge of its label; bending is an order of magnitude, KES and drape values are not known.",
        YC_FIBRE_WOOL, 0, {440, 440}, {2.2, 3}, 19, {0, 0}, 2.5, NULL, {450, 600}, {{0, 0}, {0, 0}}, {0, 0}, {0, 0}, 0,
        {0, 0}, {0, 0}},
    {"wool sweater",
        "Garter stitch with the 6.5 stitches per inch of the sweater in Cirio, Lopez-Moreno, Otaduy 2017; loop and "
        "courses from the dry-relaxed constants of Munden 1959 for plain knitting, yarn from a tightness of 13; KES "
        "and drape values are not known.",
        YC_FIBRE_WOOL, 0, {370, 370}, {2.56, 3.37}, 14.8, {0, 0}, 2.5, NULL, {400, 550}, {{0, 0}, {0, 0}}, {0, 0},
        {0, 0}, 0, {0, 0}, {0, 0}}};

static void yci_fabric_range(double out[2], const double in[2], double unit) {
    out[0] = in[0] * unit, out[1] = in[1] * unit;
}

YC_API yc_result yc_fabric_get(yc_fabric_name name, yc_fabric *out) {
    const yci_fabric_row *row;
    yc_yarn_desc yarn = yc_yarn_desc_default();
    yc_yarn_material yarns[2];
    yc_weave_desc *weave;
    int f;
    if (!out || (int)name < 0 || name >= YC_FABRIC_COUNT) return YC_ERROR_ARGUMENT;
    row = &yci_fabric_rows[name];
    memset(out, 0, sizeof *out);
    out->name = row->name, out->source = row->source, out->woven = row->loop == 0.0;
    yarn.fibre = row->fibre;
    for (f = 0; f < 2; f++) {
        yarn.tex = row->tex[f], yarn.bending_factor = row->bending_factor;
        yarns[f] = yci_yarn_make(&yarn);
        yci_fabric_range(out->bending[f], row->bending[f], 1e-6);
    }
    if (out->woven) {
        weave = &out->weave, *weave = yc_weave_desc_default();
        weave->warp = yarns[0], weave->weft = yarns[1], weave->rod = yarns[0], weave->rod.density *= 2.0;
        weave->draft = row->draft;
        for (f = 0; f < 2; f++) {
            weave->spacing[f] = 0.01 / row->per_cm[f], weave->crimp[f] = 0.01 * row->crimp[f];
            if (row->repeat) weave->repeat[f] = row->repeat;
        }
        for (f = 0; f < 2; f++) { /* what the crossings are like in this weave */
            const unsigned char *draft = row->draft ? row->draft : yci_draft_tabby;
            yc_yarn_material *m = f ? &weave->weft : &weave->warp;
            m->shear = yci_yarn_shear_of(m->radius, 0.5 * (weave->spacing[0] + weave->spacing[1]));
            m->preload = yci_yarn_preload_of(row->tex[f], yci_weave_length(draft, weave->repeat, f, weave->crimp[f]));
            m->slide = m->friction * m->preload / (YCI_FRICTION_REACH * m->radius);
            m->flattening = yci_yarn_flattening_of(m->radius, m->preload);
        }
    } else {
        out->yarn = yarns[0], out->loop = 1e-3 * row->loop;
        out->wales = 100.0 * row->per_cm[0], out->courses = 100.0 * row->per_cm[1];
    }
    yci_fabric_range(out->mass, row->mass, 1e-3);
    yci_fabric_range(out->shear, row->shear_range, 1.0);
    yci_fabric_range(out->hysteresis, row->hysteresis, 0.980665); /* gf/cm */
    yci_fabric_range(out->extension, row->extension, 0.01);
    yci_fabric_range(out->drape, row->drape, 0.01);
    out->tension = row->tension;
    return YC_OK;
}

/* ---- charts ------------------------------------------------------------------------------------------------------ */

#define YCI_CHART_ROWS 65536
#define YCI_CHART_ITEMS 1048576
#define YCI_CHART_COUNT 1000000      /* behind k, p, yo; repeats of brackets; stitches cast on; rows worked */
#define YCI_CHART_STITCHES 100000000 /* of a row as written */

static const struct {
    const char *name;     /* in capitals */
    int uses, makes;      /* loops taken from the needle, loops left on it */
    int purl, twist;      /* seen as it is worked; whether the old loop's legs cross */
    signed char order[3]; /* of the old loops, front to back as seen by the worker; 0 is the first on the needle */
} yci_stitches[] = {
    {"K", 1, 1, 0, 0, {0, 0, 0}}, /* YC_STITCH_K and so on */
    {"P", 1, 1, 1, 0, {0, 0, 0}}, {"SL1", 1, 1, 0, 0, {0, 0, 0}}, {"KTBL", 1, 1, 0, 1, {0, 0, 0}},
    {"PTBL", 1, 1, 1, 1, {0, 0, 0}}, {"YO", 0, 1, 0, 0, {0, 0, 0}}, {"M1", 0, 1, 0, 1, {0, 0, 0}},
    {"KFB", 1, 2, 0, 0, {0, 0, 0}}, {"K2TOG", 2, 1, 0, 0, {1, 0, 0}}, {"P2TOG", 2, 1, 1, 0, {1, 0, 0}},
    {"SSK", 2, 1, 0, 0, {0, 1, 0}}, {"K3TOG", 3, 1, 0, 0, {2, 1, 0}}, {"P3TOG", 3, 1, 1, 0, {2, 1, 0}},
    {"SL1-K2TOG-PSSO", 3, 1, 0, 0, {0, 2, 1}}, {"SL2-K1-P2SSO", 3, 1, 0, 0, {1, 0, 2}},
    {"SKPO", 2, 1, 0, 0, {0, 1, 0}}, /* another name of YC_STITCH_SSK */
};

typedef struct {
    yci_context *c;
    yc_result result;
    yci_wif_text rest; /* of the text */
    int line, row;     /* where the reader stands; row 0: in none */
    double stitch;     /* number of the next stitch in its row, less 1 */
    int fresh;         /* items before this one are not added to: a repeat or a row begins here */
    int multiple[2];
    yc_chart_row *rows; /* line 0: not given so far */
    yc_chart_item *items;
    int row_count, row_capacity, item_count, item_capacity;
} yci_chart_reader;

/* Where the reader stands, for a message. */
static const char *yci_chart_place(const yci_chart_reader *r, char place[64], int stitch) {
    int at = snprintf(place, 64, "chart line %d", r->line);
    if (r->row) at += snprintf(place + at, 64 - (size_t)at, ", row %d", r->row);
    if (stitch) snprintf(place + at, 64 - (size_t)at, ", stitch %.0f", r->stitch + 1.0);
    return place;
}

static int yci_chart_wrong(yci_chart_reader *r, const char *expected, yci_wif_text found) {
    char place[64];
    int length = (int)yci_min((double)(found.end - found.at), 40.0);
    r->result = YCI_FAIL(r->c, YC_ERROR_PARSE, "%s: expected %s, found \"%.*s\"", yci_chart_place(r, place, 0),
        expected, length, found.at);
    return 0;
}

/* Fails at a stitch: 'token' and what is wrong with it. */
static int yci_chart_refuse(yci_chart_reader *r, yci_wif_text token, const char *what) {
    char place[64];
    int length = (int)yci_min((double)(token.end - token.at), 40.0);
    r->result = YCI_FAIL(r->c, YC_ERROR_PARSE, "%s: '%.*s' %s", yci_chart_place(r, place, 1), length, token.at, what);
    return 0;
}

/* Whether the text begins with this name in capitals, in any case there; moves past it and the space after it. */
static int yci_chart_skip(yci_wif_text *t, const char *name) {
    const char *at = t->at;
    for (; *name; at++, name++)
        if (at == t->end || yci_wif_upper(*at) != *name) return 0;
    t->at = at;
    yci_wif_trim(t);
    return 1;
}

/* Takes a number in low .. high off the front of a text. */
static int yci_chart_number(yci_wif_text *t, int low, int high, int *number) {
    const char *at = t->at;
    double value = 0.0;
    for (; at < t->end && *at >= '0' && *at <= '9'; at++) value = yci_min(10.0 * value + (*at - '0'), 1e10);
    if (at == t->at || value < low || value > high) return 0;
    t->at = at, *number = (int)value;
    yci_wif_trim(t);
    return 1;
}

/* Moves to the next line that holds something but a comment. 0 at the end. */
static int yci_chart_next(yci_chart_reader *r, yci_wif_text *line) {
    while (r->rest.at < r->rest.end) {
        const char *at;
        line->at = r->rest.at;
        while (r->rest.at < r->rest.end && *r->rest.at != '\n' && *r->rest.at != '\r') r->rest.at++;
        line->end = r->rest.at;
        if (r->rest.end - r->rest.at >= 2 && r->rest.at[0] == '\r' && r->rest.at[1] == '\n') r->rest.at++;
        if (r->rest.at < r->rest.end) r->rest.at++;
        r->line++;
        for (at = line->at; at < line->end && *at != '#';) at++;
        line->end = at;
        yci_wif_trim(line);
        if (line->at < line->end) return 1;
    }
    return 0;
}

static int yci_chart_same_name(yci_wif_text t, const char *name) {
    for (; t.at < t.end && *name; t.at++, name++)
        if (yci_wif_upper((unsigned char)*t.at) != yci_wif_upper((unsigned char)*name)) return 0;
    return t.at == t.end && !*name;
}

/* Adds stitches to the row. 0 when memory or the limits do not allow it. */
static int yci_chart_push(yci_chart_reader *r, int stitch, int times) {
    char place[64];
    yc_chart_item *last = r->item_count > r->fresh ? &r->items[r->item_count - 1] : NULL;
    r->stitch += times;
    if (r->stitch > YCI_CHART_STITCHES || r->item_count == YCI_CHART_ITEMS) {
        r->result = YCI_FAIL(r->c, YC_ERROR_PARSE, "%s: a row has at most %d stitches, a chart %d changes of stitches",
            yci_chart_place(r, place, 0), YCI_CHART_STITCHES, YCI_CHART_ITEMS);
        return 0;
    }
    if (last && last->stitch == stitch && last->times <= YCI_CHART_COUNT - times) {
        last->times += times;
        return 1;
    }
    if (!YCI_RESERVE(r->c, r->items, r->item_capacity, r->item_count, r->item_count + 1)) {
        r->result = yci_out_of_memory(r->c, "a chart");
        return 0;
    }
    r->items[r->item_count].stitch = stitch, r->items[r->item_count++].times = times;
    return 1;
}

/* One stitch as written, with its count. */
static int yci_chart_stitch(yci_chart_reader *r, yci_wif_text token) {
    yci_wif_text t = token;
    int i, times = 1, other;
    if (yci_chart_number(&t, 0, INT_MAX, &other) && t.at < t.end && *t.at == '/') {
        t.at++;
        if (yci_chart_number(&t, 0, INT_MAX, &other) && (yci_wif_is(t, "RC") || yci_wif_is(t, "LC")))
            return yci_chart_refuse(r, token, "is a cable, which stitch contacts cannot hold");
    }
    for (i = 0; i <= YC_STITCH_COUNT; i++) /* skpo comes last */
        if (yci_wif_is(token, yci_stitches[i].name))
            return yci_chart_push(r, i == YC_STITCH_COUNT ? YC_STITCH_SSK : i, 1);
    t = token;
    i = yci_chart_skip(&t, "K") ? YC_STITCH_K : yci_chart_skip(&t, "P") ? YC_STITCH_P : YC_STITCH_YO;
    if ((i != YC_STITCH_YO || yci_chart_skip(&t, "YO")) && t.at < t.end && *t.at >= '0' && *t.at <= '9') {
        yci_wif_text digits = t;
        while (digits.at < digits.end && *digits.at >= '0' && *digits.at <= '9') digits.at++;
        if (digits.at == digits.end) {
            if (yci_chart_number(&t, 1, YCI_CHART_COUNT, &times)) return yci_chart_push(r, i, times);
            return yci_chart_refuse(r, token, "has a count beyond 1 .. 1000000");
        }
    }
    if (token.at == token.end) return yci_chart_wrong(r, "a stitch", token);
    return yci_chart_refuse(r, token, "is no stitch known here");
}

/* What follows a bracket: `3 times`, `twice` or `once`. */
static int yci_chart_times(yci_chart_reader *r, yci_wif_text *t, int *times) {
    yci_wif_text from = *t;
    *times = 2;
    if (yci_chart_skip(t, "TWICE")) return 1;
    if (yci_chart_number(t, 1, YCI_CHART_COUNT, times) && (yci_chart_skip(t, "TIMES") || yci_chart_skip(t, "TIME")))
        return 1;
    return yci_chart_wrong(r, "a number of times or 'twice' after brackets", from);
}

/* [..] N times: the items since `from`, which made the row `stitch` long, once more and more. */
static int yci_chart_unroll(yci_chart_reader *r, int from, double stitch, int times) {
    int count = r->item_count - from, i;
    yc_chart_item first;
    char place[64];
    if (!count) return 1;
    if (stitch + (r->stitch - stitch) * times > YCI_CHART_STITCHES ||
        (count > 1 && (double)from + (double)count * times > YCI_CHART_ITEMS)) {
        r->result = YCI_FAIL(r->c, YC_ERROR_PARSE, "%s: a row has at most %d stitches, a chart %d changes of stitches",
            yci_chart_place(r, place, 0), YCI_CHART_STITCHES, YCI_CHART_ITEMS);
        return 0;
    }
    first = r->items[from];
    for (times--; times > 0; times--) {
        r->fresh = count == 1 ? from : r->item_count; /* else items that are still to be read would change */
        for (i = 0; i < count; i++) {
            yc_chart_item item = count == 1 ? first : r->items[from + i];
            if (!yci_chart_push(r, item.stitch, item.times)) return 0;
        }
    }
    return 1;
}

/* Reads the stitches of a row, or of brackets within it, up to the end of `t`. `row` NULL: brackets. */
static int yci_chart_stitches(yci_chart_reader *r, yci_wif_text t, yc_chart_row *row) {
    int star = 0, comma = 0;
    yci_wif_trim(&t);
    while (t.at < t.end) {
        yci_wif_text token = t, word;
        if (*t.at == '[') {
            double stitch = r->stitch;
            int from, times;
            if (!row) return yci_chart_wrong(r, "no brackets within brackets", t);
            while (t.at < t.end && *t.at != ']') t.at++;
            if (t.at == t.end) return yci_chart_wrong(r, "a closing bracket after", token);
            token.at++, token.end = t.at++;
            from = r->fresh = r->item_count;
            if (!yci_chart_stitches(r, token, NULL)) return 0;
            yci_wif_trim(&t);
            if (!yci_chart_times(r, &t, &times) || !yci_chart_unroll(r, from, stitch, times)) return 0;
            r->fresh = r->item_count;
        } else {
            while (t.at < t.end && *t.at != ',' && *t.at != '[' && *t.at != '*') t.at++;
            token.end = t.at, word = token;
            yci_wif_trim(&token);
            if (t.at < t.end && *t.at == '*' && row &&
                (token.at == token.end || yci_wif_is(token, "REPEAT FROM") || yci_wif_is(token, "REP FROM"))) {
                if (star == 2 || (star == 0) != (token.at == token.end))
                    return yci_chart_wrong(r, "one repeat, '*stitches, repeat from *'", word);
                *(star ? &row->after : &row->repeat) = r->fresh = r->item_count;
                t.at++, star++;
                yci_wif_trim(&t);
                if (star == 1) continue;
            } else if (!yci_chart_stitch(r, token)) return 0;
        }
        if (t.at < t.end && *t.at != ',') return yci_chart_wrong(r, "a comma", t);
        comma = t.at < t.end;
        t.at += comma;
        yci_wif_trim(&t);
    }
    if (comma) return yci_chart_wrong(r, "a stitch after the last comma", t);
    if (star == 1) return yci_chart_wrong(r, "'repeat from *'", t);
    if (row && !star) row->repeat = row->after = r->item_count;
    return 1;
}

/* The instructions of a row: `body` into items, the row's places among them. */
static int yci_chart_body(yci_chart_reader *r, yci_wif_text body, yc_chart_row *row) {
    const char *at;
    int i, uses = 0;
    for (at = body.at; at < body.end && *at != '.';) at++;
    if (body.end - at > 1) {
        body.at = at + 1;
        return yci_chart_wrong(r, "nothing behind the full stop", body);
    }
    body.end = at;
    yci_wif_trim(&body);
    if (body.at == body.end) return yci_chart_wrong(r, "stitches", body);
    row->first = r->fresh = r->item_count, r->stitch = 0.0;
    if (yci_wif_is(body, "KNIT") || yci_wif_is(body, "PURL")) {
        if (!yci_chart_push(r, yci_wif_is(body, "KNIT") ? YC_STITCH_K : YC_STITCH_P, 1)) return 0;
        row->repeat = row->first, row->after = r->item_count;
    } else if (!yci_chart_stitches(r, body, row)) return 0;
    row->last = r->item_count;
    for (i = row->repeat; i < row->after; i++) uses |= yci_stitches[r->items[i].stitch].uses;
    if (row->repeat < row->after && !uses) return yci_chart_wrong(r, "a repeat that uses stitches", body);
    return 1;
}

/* `Rows 1, 3-5 and 8 (RS)`: their number is set in every row of that list, with `found` as its instructions. With
 * found NULL the list is only gone through, and the side and the first number are set. */
static int yci_chart_list(yci_chart_reader *r, yci_wif_text head, int *side, yc_chart_row *found) {
    yci_wif_text all = head;
    int from, to, k, begun = 0;
    if (!yci_chart_skip(&head, "ROWS") && !yci_chart_skip(&head, "ROW")) return yci_chart_wrong(r, "a row", all);
    for (;;) {
        yci_wif_text number;
        while (begun && (yci_chart_skip(&head, ",") || yci_chart_skip(&head, "AND") || yci_chart_skip(&head, "&")))
            ;
        number = head;
        if (begun && head.at < head.end && *head.at == '(') break;
        if (!yci_chart_number(&head, 1, YCI_CHART_ROWS, &from))
            return yci_chart_wrong(r, begun ? "a row in 1 .. 65536, or (RS) or (WS)" : "a row in 1 .. 65536", number);
        to = from;
        if (yci_chart_skip(&head, "-") && (!yci_chart_number(&head, 1, YCI_CHART_ROWS, &to) || to < from))
            return yci_chart_wrong(r, "a range of rows in 1 .. 65536", number);
        if (!begun++) r->row = from;
        for (k = from; k <= to && found; k++) {
            if (!YCI_RESERVE(r->c, r->rows, r->row_capacity, r->row_count, k)) {
                r->result = yci_out_of_memory(r->c, "a chart");
                return 0;
            }
            if (r->rows[k - 1].line) {
                r->row = k;
                number.end = head.at;
                yci_wif_trim(&number);
                return yci_chart_wrong(r, "a row that is not there yet", number);
            }
            r->rows[k - 1] = *found;
            if (k > r->row_count) r->row_count = k;
        }
    }
    *side = yci_wif_is(head, "(WS)");
    return *side || yci_wif_is(head, "(RS)") ? 1 : yci_chart_wrong(r, "(RS) or (WS)", head);
}

/* One line of the pattern wanted, `key: value`. */
static int yci_chart_line(yci_chart_reader *r, yci_wif_text line) {
    yci_wif_text key = line, value = line;
    yc_chart_row row;
    int side = 0;
    memset(&row, 0, sizeof row);
    while (value.at < value.end && *value.at != ':') value.at++;
    r->row = 0;
    if (value.at == value.end) return yci_chart_wrong(r, "pattern, multiple, sure, note or rows before a colon", line);
    key.end = value.at++;
    yci_wif_trim(&key), yci_wif_trim(&value);
    if (yci_wif_is(key, "SURE") || yci_wif_is(key, "NOTE")) return 1;
    if (yci_wif_is(key, "MULTIPLE")) {
        yci_wif_text all = value;
        if (!yci_chart_number(&value, 0, YCI_CHART_COUNT, &r->multiple[0]) || !yci_chart_skip(&value, "+") ||
            !yci_chart_number(&value, 0, YCI_CHART_COUNT, &r->multiple[1]) || value.at < value.end ||
            r->multiple[0] + r->multiple[1] < 1)
            return yci_chart_wrong(r, "a multiple like '8 + 1'", all);
        return 1;
    }
    if (!yci_chart_skip(&line, "ROW")) return yci_chart_wrong(r, "pattern, multiple, sure, note or rows", key);
    if (!yci_chart_list(r, key, &side, NULL)) return 0;
    row.line = r->line, row.wrong_side = side;
    return yci_chart_body(r, value, &row) && yci_chart_list(r, key, &side, &row);
}

/* Reads the pattern of that name. */
static yc_result yci_chart_pattern(yci_chart_reader *r, const char *name) {
    yci_wif_text line;
    int inside = !name, begun = 0;
    while (yci_chart_next(r, &line)) {
        yci_wif_text value = line;
        if (yci_chart_skip(&value, "PATTERN") && yci_chart_skip(&value, ":")) {
            if (inside && (begun || r->row_count || r->item_count)) break;
            inside = begun = !name || yci_chart_same_name(value, name);
        } else if (inside && !yci_chart_line(r, line)) return r->result;
    }
    if (!inside && !begun)
        return YCI_FAIL(r->c, YC_ERROR_PARSE, "chart: there is no pattern '%.100s'", name ? name : "");
    return YC_OK;
}

/* "chart line 12, row 3", or "chart row 3" without a text. */
static const char *yci_chart_row_name(const yc_chart *chart, int row, char place[64]) {
    int line = chart->rows[row].line;
    int at = line ? snprintf(place, 64, "chart line %d,", line) : snprintf(place, 64, "chart");
    snprintf(place + at, 64 - (size_t)at, " row %d", row + 1);
    return place;
}

/* How often a row's repeat is worked on that many stitches, and how many it leaves on the needle. */
static yc_result yci_chart_fit(
    yci_context *c, const yc_chart *chart, int row, int stitches, int *times, double *makes) {
    const yc_chart_row *r = &chart->rows[row];
    double uses[2] = {0.0, 0.0}, left;
    int i, k;
    char place[64];
    *makes = 0.0, *times = 0;
    for (i = r->first; i < r->last; i++)
        uses[i >= r->repeat && i < r->after] +=
            (double)yci_stitches[chart->items[i].stitch].uses * chart->items[i].times;
    left = stitches - uses[0];
    if (left >= 0.0 && uses[1] > 0.0) *times = (int)(left / uses[1]);
    left -= uses[1] * *times;
    for (i = r->first; i < r->last; i++) {
        k = i >= r->repeat && i < r->after ? *times : 1;
        *makes += (double)yci_stitches[chart->items[i].stitch].makes * chart->items[i].times * k;
    }
    if (left == 0.0) return YC_OK;
    yci_chart_row_name(chart, row, place);
    if (uses[1] > 0.0 && left > 0.0)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT,
            "%s: uses %.0f of %d stitches, and its repeat of %.0f does not fit the rest", place, stitches - left,
            stitches, uses[1]);
    return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s: uses %.0f of %d stitches", place, uses[0], stitches);
}

/* Whether all rows are there, and fit onto each other. */
static yc_result yci_chart_check_rows(yci_chart_reader *r, const yc_chart *chart) {
    int i, n, times;
    if (!r->row_count) return YCI_FAIL(r->c, YC_ERROR_PARSE, "chart: there are no rows");
    for (i = 0; i < r->row_count; i++)
        if (!r->rows[i].line) return YCI_FAIL(r->c, YC_ERROR_PARSE, "chart: row %d is missing", i + 1);
    for (n = 1; n <= 2 && r->multiple[0] + r->multiple[1] > 0; n++) {
        double stitches = (double)n * r->multiple[0] + r->multiple[1];
        for (i = 0; i < r->row_count; i++) {
            if (stitches > INT_MAX || yci_chart_fit(r->c, chart, i, (int)stitches, &times, &stitches) != YC_OK)
                return YC_ERROR_PARSE;
        }
    }
    return YC_OK;
}

static yc_result yci_chart_build(yci_chart_reader *r, yc_chart *chart) {
    size_t used = 0, rows, items;
    char *block;
    yc_result result;
    memset(chart, 0, sizeof *chart);
    chart->multiple[0] = r->multiple[0], chart->multiple[1] = r->multiple[1];
    chart->row_count = r->row_count, chart->rows = r->rows;
    chart->item_count = r->item_count, chart->items = r->items;
    result = yci_chart_check_rows(r, chart);
    if (result != YC_OK) return result;
    yci_weave_carve(NULL, &used, 1, sizeof(yci_context));
    rows = used;
    yci_weave_carve(NULL, &used, r->row_count, sizeof *r->rows);
    items = used;
    yci_weave_carve(NULL, &used, r->item_count, sizeof *r->items);
    block = (char *)yci_alloc(r->c, used, 1);
    if (!block) return yci_out_of_memory(r->c, "a chart");
    memcpy(block + rows, r->rows, (size_t)r->row_count * sizeof *r->rows);
    memcpy(block + items, r->items, (size_t)r->item_count * sizeof *r->items);
    chart->owner = block;
    chart->rows = (const yc_chart_row *)(block + rows), chart->items = (const yc_chart_item *)(block + items);
    return YC_OK;
}

YC_API yc_result yc_chart_read(
    const yc_host *host, const char *text, size_t length, const char *name, yc_chart *out, char *message) {
    yci_context c;
    yci_chart_reader r;
    yc_chart chart;
    yc_result result = yci_context_init(&c, host);
    memset(&r, 0, sizeof r);
    r.c = &c;
    if (result == YC_OK && (!text || !out)) result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "text and out must not be NULL");
    if (result == YC_OK) {
        r.rest.at = text, r.rest.end = text + length;
        if (length >= 3 && !memcmp(text, "\xef\xbb\xbf", 3)) r.rest.at += 3; /* a mark of UTF-8 */
        result = yci_chart_pattern(&r, name);
    }
    if (result == YC_OK) result = yci_chart_build(&r, &chart);
    yci_free(&c, r.rows);
    yci_free(&c, r.items);
    if (result == YC_OK) *out = chart, memcpy(out->owner, &c, sizeof c);
    return yci_report(&c, result, message);
}

YC_API void yc_chart_destroy(yc_chart *chart) {
    if (chart && chart->owner) yci_owned_free(chart->owner), memset(chart, 0, sizeof *chart);
}

/* ---- knits ------------------------------------------------------------------------------------------------------- */

#define YCI_KNIT_LOOPS 25000000
#define YCI_KNIT_TURN (75.0 / 180.0 * YCI_PI) /* a sharper turn of the yarn is shared with nodes beside it, */
#define YCI_KNIT_CUTS 4                       /* at most so many, */
#define YCI_KNIT_STEP 0.12                    /* a share of the segment's length from each other */
#define YCI_KNIT_SWEEPS 400                   /* of the springs that place loops */
#define YCI_KNIT_LEAST 1e-3                   /* shares of a stitch, of yarn between two visits */
#define YCI_KNIT_STUB 0.1 /* widths of a stitch; nothing is visited closer to where an outline cuts the yarn */

/* A loop. Its base is where it is drawn through older ones or, if it is drawn through none, in its row between its
 * neighbours. */
typedef struct {
    double x[2];                   /* base, m: to the right, up; in the round x runs around the tube */
    double slot;                   /* in its row, in the order of work; the half ones are bars that were picked up */
    int row;                       /* 0: cast on */
    int next;                      /* along the yarn; -1: none */
    int old;                       /* the first of its old loops, from front to back, in yci_knitter.olds */
    int up[2];                     /* loops drawn through this one, in the order of work; -1: none */
    int node;                      /* the first of its nodes: A, B at the left, A, B at the right; then the crossing */
    int contact;                   /* the first of its contacts, those at the left first */
    signed char dir, up_dir;       /* +1: the yarn runs to the right, in this row and in that of `up` */
    unsigned char old_count, purl; /* as seen from the right side */
    unsigned char twist, tail;     /* its legs cross; the yarn's end, half a loop through the last one */
} yci_knit_loop;

/* A visit before nodes are put beside sharp turns. */
typedef struct {
    double turn;  /* rad, of the yarn here, to the left */
    int node, at; /* at: what number it will have */
    signed char layer;
    unsigned char joined, after; /* the segment after it lies in a contact; it is the one for this turn's nodes */
    unsigned char alone;         /* no other yarn is there */
    unsigned char cuts[2];       /* nodes for this turn in the segment before, after it */
} yci_knit_visit;

typedef struct {
    yci_context *c;
    const yc_knit_desc *desc;
    yci_knit_loop *loops;
    int *olds, *needle, *fresh; /* loops on the needle, in the order of work of their row; those of this row */
    int loop_count, loop_capacity, old_count, old_capacity, needle_count, needle_capacity, fresh_count, fresh_capacity;
    int used, last;               /* how many were taken from the needle; the loop at the yarn's end */
    int row, dir, shaped;         /* shaped: loops are not all where rows and columns meet */
    double width, height, around; /* m, of a stitch; around the tube, 0 when flat */
    double scale;                 /* of u over lengths as laid */
    double (*force)[3];           /* [loop_count], on loops and the stiffness they feel */
    double (*speed)[2];
    double (*place)[2]; /* [node_count], m */
    yci_knit_visit *visits;
    yc_stitch_contact *contacts; /* with numbers of `visits` */
    int node_count, visit_count, contact_count;
} yci_knitter;

static const yc_chart_item yci_knit_items[] = {{YC_STITCH_K, 1}, {YC_STITCH_P, 1}};
static const yc_chart_row yci_knit_rows_plain[] = {{0, 0, 0, 0, 1, 1}, {0, 1, 1, 1, 2, 2}};
static const yc_chart_row yci_knit_rows_garter[] = {{0, 0, 0, 0, 1, 1}, {0, 1, 0, 0, 1, 1}};
static const yc_chart_row yci_knit_rows_rib[] = {{0, 0, 0, 0, 2, 2}, {0, 1, 0, 0, 2, 2}};
static const yc_chart yci_knit_plain = {{1, 0}, 2, yci_knit_rows_plain, 2, yci_knit_items, NULL};
static const yc_chart yci_knit_garter = {{1, 0}, 2, yci_knit_rows_garter, 2, yci_knit_items, NULL};
static const yc_chart yci_knit_rib = {{2, 0}, 2, yci_knit_rows_rib, 2, yci_knit_items, NULL};

YC_API yc_knit_desc yc_knit_desc_default(void) {
    yc_yarn_desc wool = yc_yarn_desc_default();
    yc_knit_desc d;
    memset(&d, 0, sizeof d);
    wool.fibre = YC_FIBRE_WOOL, wool.tex = 440.0;
    d.cookie = YCI_DESC_COOKIE;
    d.stitches = 20, d.rows = 24, d.wales = 220.0, d.courses = 300.0;
    d.yarn = d.rod = yci_yarn_make(&wool);
    d.rod.density *= 2.0;
    return d;
}

YC_API yc_result yc_knit_fabric(yc_fabric_name name, yc_knit_desc *out) {
    yc_fabric fabric;
    if (!out || yc_fabric_get(name, &fabric) != YC_OK || fabric.woven) return YC_ERROR_ARGUMENT;
    *out = yc_knit_desc_default();
    out->chart = name == YC_FABRIC_RIB ? &yci_knit_rib : name == YC_FABRIC_SWEATER ? &yci_knit_garter : &yci_knit_plain;
    out->wales = fabric.wales, out->courses = fabric.courses, out->loop = fabric.loop;
    out->yarn = out->rod = fabric.yarn, out->rod.density *= 2.0;
    return YC_OK;
}

static yc_result yci_knit_check_chart(yci_context *c, const yc_chart *chart) {
    yc_result result = yci_draft_range(c, "chart.row_count", chart->row_count, 1, YCI_CHART_ROWS);
    int i;
    if (result == YC_OK) result = yci_draft_range(c, "chart.item_count", chart->item_count, 1, YCI_CHART_ITEMS);
    if (result != YC_OK) return result;
    if (!chart->rows || !chart->items) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "chart.rows and items must not be NULL");
    for (i = 0; i < chart->row_count; i++) {
        const yc_chart_row *r = &chart->rows[i];
        if (r->first < 0 || r->repeat < r->first || r->after < r->repeat || r->last < r->after ||
            r->last > chart->item_count)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "chart.rows[%d] = %d, %d, %d, %d must rise within 0 .. %d", i,
                r->first, r->repeat, r->after, r->last, chart->item_count);
    }
    for (i = 0; i < chart->item_count; i++)
        if (chart->items[i].stitch < 0 || chart->items[i].stitch >= YC_STITCH_COUNT || chart->items[i].times < 1 ||
            chart->items[i].times > YCI_CHART_COUNT)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "chart.items[%d]: stitch %d, %d times, is none", i,
                chart->items[i].stitch, chart->items[i].times);
    return YC_OK;
}

/* What counts only where a knit is cut to pieces of a pattern. */
static yc_result yci_knit_check_cut(yci_context *c, const yc_knit_desc *d) {
    if (!yci_finite(d->grain)) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "knit.grain = %g must be finite", d->grain);
    if (d->edge != YC_EDGE_CUT && d->edge != YC_EDGE_SELVEDGE)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "knit.edge = %d is none of yc_edge", (int)d->edge);
    if (d->round)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "knit.round = %d: what pieces are cut from is knitted flat", d->round);
    if (d->live)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "knit.live = %d: pieces are cut, and have no row that is last", d->live);
    if (d->rod.density != 0.0) {
        yc_result result = yci_yarn_material_check(c, "knit.rod", &d->rod);
        if (result != YC_OK) return result;
    }
    return yci_mesh_check(c, d->mesh);
}

static yc_result yci_knit_check(yci_context *c, const yc_knit_desc *d) {
    const double values[3] = {d->wales, d->courses, d->loop};
    static const char *const names[3] = {"wales", "courses", "loop"};
    yc_result result;
    int i;
    if (d->cookie != YCI_DESC_COOKIE)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "knit.cookie: not made by yc_knit_desc_default()");
    result = d->mesh ? YC_OK : yci_draft_range(c, "knit.stitches", d->stitches, 1, YCI_CHART_COUNT);
    if (result == YC_OK && !d->mesh) result = yci_draft_range(c, "knit.rows", d->rows, 1, YCI_CHART_COUNT);
    if (result != YC_OK) return result;
    for (i = 0; i < 3; i++) {
        if (!yci_finite(values[i]))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "knit.%s = %g must be finite", names[i], values[i]);
        if (values[i] < 0.0 || (i < 2 && values[i] == 0.0))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "knit.%s = %g must %s", names[i], values[i],
                i < 2 ? "be greater than 0" : "not be negative");
    }
    result = yci_yarn_material_check(c, "knit.yarn", &d->yarn);
    if (result == YC_OK && d->chart) result = yci_knit_check_chart(c, d->chart);
    if (result == YC_OK && d->mesh) result = yci_knit_check_cut(c, d);
    return result;
}

/* ---- working a chart: which loop is drawn through which ---- */

static int yci_knit_next_old(const yci_knitter *k) {
    int i = k->desc->round ? k->used : k->needle_count - 1 - k->used;
    return k->needle[i];
}

/* A new loop at the yarn's end. -1: out of memory, or too many. */
static int yci_knit_new(yci_knitter *k, double slot) {
    yci_knit_loop *loop;
    int id = k->loop_count;
    if (id >= YCI_KNIT_LOOPS || !YCI_RESERVE(k->c, k->loops, k->loop_capacity, id, id + 1)) return -1;
    loop = &k->loops[id];
    loop->row = k->row, loop->dir = (signed char)k->dir, loop->slot = slot;
    loop->next = loop->up[0] = loop->up[1] = -1, loop->old = k->old_count, loop->old_count = 0;
    if (k->last >= 0) k->loops[k->last].next = id;
    return k->last = k->loop_count++;
}

/* Draws a loop through `old`, behind those that it is drawn through already. */
static int yci_knit_draw(yci_knitter *k, int loop, int old) {
    yci_knit_loop *below = &k->loops[old];
    if (!YCI_RESERVE(k->c, k->olds, k->old_capacity, k->old_count, k->old_count + 1)) return 0;
    k->olds[k->old_count++] = old, k->loops[loop].old_count++;
    below->up[below->up[0] >= 0] = loop, below->up_dir = k->loops[loop].dir;
    return 1;
}

/* Puts a loop on the needle. */
static int yci_knit_hang(yci_knitter *k, int loop) {
    if (k->fresh_count >= YCI_KNIT_LOOPS ||
        !YCI_RESERVE(k->c, k->fresh, k->fresh_capacity, k->fresh_count, k->fresh_count + 1))
        return 0;
    k->fresh[k->fresh_count++] = loop;
    return 1;
}

/* The bar between the loop taken last and the next one becomes a loop of the row below; -1: there is none, -2: no
 * memory. */
static int yci_knit_bar(yci_knitter *k) {
    int a, b, bar, end = k->last;
    if (k->used == 0 || k->used == k->needle_count) return -1;
    b = yci_knit_next_old(k), k->used--;
    a = yci_knit_next_old(k), k->used++;
    if (!k->desc->round) bar = a, a = b, b = bar; /* the row below was worked the other way */
    if (k->loops[a].next != b || k->loops[a].row != k->loops[b].row) return -1;
    k->last = -1;
    bar = yci_knit_new(k, 0.5 * (k->loops[a].slot + k->loops[b].slot));
    k->last = end;
    if (bar < 0) return -2;
    k->loops[bar].row = k->loops[a].row, k->loops[bar].dir = k->loops[a].dir, k->loops[bar].twist = 1;
    for (end = 0; end < 2; end++) k->loops[bar].x[end] = 0.5 * (k->loops[a].x[end] + k->loops[b].x[end]);
    k->loops[a].next = bar, k->loops[bar].next = b;
    return bar;
}

/* Works one stitch. 0: out of memory, or too many loops; -1: m1 finds no bar. */
static int yci_knit_stitch(yci_knitter *k, int stitch, int wrong_side) {
    int old[3] = {-1, -1, -1}, uses = yci_stitches[stitch].uses, i, n, loop;
    int backward = wrong_side && k->desc->round; /* the worker would come from the other end */
    if (yci_stitches[stitch].uses != yci_stitches[stitch].makes) k->shaped = 1;
    for (i = 0; i < uses; i++) old[backward ? uses - 1 - i : i] = yci_knit_next_old(k), k->used++;
    if (stitch == YC_STITCH_SL1) return yci_knit_hang(k, old[0]);
    if (stitch == YC_STITCH_M1) {
        old[0] = yci_knit_bar(k), uses = 1;
        if (old[0] < 0) return old[0] == -1 ? -1 : 0;
    } else if (yci_stitches[stitch].twist) k->loops[old[0]].twist = 1;
    for (n = 0; n < yci_stitches[stitch].makes; n++) {
        loop = yci_knit_new(k, k->fresh_count);
        if (loop < 0) return 0;
        k->loops[loop].purl = (unsigned char)(yci_stitches[stitch].purl ^ wrong_side);
        for (i = 0; i < uses; i++) /* what lies in front for the worker is behind from the right side */
            if (!yci_knit_draw(k, loop, old[yci_stitches[stitch].order[wrong_side ? uses - 1 - i : i]])) return 0;
        if (!yci_knit_hang(k, loop)) return 0;
    }
    return 1;
}

/* Ends a row: its loops, from number `first` on, get their places, and the needle is turned or begun anew. */
static void yci_knit_row_end(yci_knitter *k, int first) {
    int i, *swap = k->needle, room = k->needle_capacity, n = k->fresh_count;
    for (i = first; i < k->loop_count; i++) {
        yci_knit_loop *loop = &k->loops[i];
        if (loop->row != k->row) continue;
        if (k->around > 0.0) {
            loop->x[0] = k->around * (1.0 - (loop->slot + 0.5) / n);
            loop->x[1] = k->height * (k->row + loop->slot / n);
        } else {
            loop->x[0] = k->width * k->dir * (loop->slot - 0.5 * (n - 1));
            loop->x[1] = k->height * k->row;
        }
    }
    k->needle = k->fresh, k->needle_capacity = k->fresh_capacity, k->needle_count = n;
    k->fresh = swap, k->fresh_capacity = room, k->fresh_count = 0, k->used = 0;
    k->row++;
    if (!k->desc->round) k->dir = -k->dir;
}

static yc_result yci_knit_room(yci_knitter *k) {
    if (k->loop_count >= YCI_KNIT_LOOPS)
        return YCI_FAIL(k->c, YC_ERROR_ARGUMENT, "knit: more than %d loops", YCI_KNIT_LOOPS);
    return yci_out_of_memory(k->c, "the loops of a knit");
}

/* Works a row of the chart. */
static yc_result yci_knit_row(yci_knitter *k, const yc_chart *chart, int row) {
    const yc_chart_row *r = &chart->rows[row];
    int part, at, i, n, times[3] = {1, 1, 1}, begin[3], end[3], backward = r->wrong_side && k->desc->round;
    int first = k->loop_count, done;
    double makes;
    char place[64];
    yc_result result = yci_chart_fit(k->c, chart, row, k->needle_count, &times[1], &makes);
    if (result != YC_OK) return result;
    begin[0] = r->first, end[0] = begin[1] = r->repeat, end[1] = begin[2] = r->after, end[2] = r->last;
    for (part = 0; part < 3; part++) {
        int p = backward ? 2 - part : part;
        for (n = 0; n < times[p]; n++)
            for (at = begin[p]; at < end[p]; at++) {
                const yc_chart_item *item = &chart->items[backward ? begin[p] + end[p] - 1 - at : at];
                for (i = 0; i < item->times; i++) {
                    done = yci_knit_stitch(k, item->stitch, r->wrong_side != 0);
                    if (!done) return yci_knit_room(k);
                    if (done < 0)
                        return YCI_FAIL(k->c, YC_ERROR_ARGUMENT,
                            "%s: m1 after %d stitches finds no bar between two of the row below",
                            yci_chart_row_name(chart, row, place), k->used);
                }
            }
    }
    yci_knit_row_end(k, first);
    return YC_OK;
}

/* Casts on by loops whose legs cross. */
static yc_result yci_knit_begin(yci_knitter *k) {
    int i, loop;
    for (i = 0; i < k->desc->stitches; i++) {
        loop = yci_knit_new(k, i);
        if (loop < 0 || !yci_knit_hang(k, loop)) return yci_knit_room(k);
        k->loops[loop].twist = 1;
    }
    yci_knit_row_end(k, 0);
    return YC_OK;
}

/* Binds off: each loop is drawn through the next one of the needle and the one before it, at last the yarn's end. */
static yc_result yci_knit_end(yci_knitter *k) {
    int i, loop, before = -1, first = k->loop_count, count = k->needle_count;
    for (i = 0; i <= count; i++, before = loop) {
        loop = yci_knit_new(k, i);
        if (loop < 0) return yci_knit_room(k);
        k->loops[loop].tail = (unsigned char)(i == count);
        if (before >= 0 && !yci_knit_draw(k, loop, before)) return yci_knit_room(k);
        if (i == count) break;
        if (!yci_knit_draw(k, loop, yci_knit_next_old(k)) || !yci_knit_hang(k, loop)) return yci_knit_room(k);
        k->used++;
    }
    yci_knit_row_end(k, first);
    return YC_OK;
}

static yc_result yci_knit_work(yci_knitter *k) {
    const yc_chart *chart = k->desc->chart ? k->desc->chart : &yci_knit_plain;
    yc_result result = YC_OK;
    double needle = k->desc->stitches, worked = needle;
    int i, times;
    for (i = 0; i < k->desc->rows && !k->desc->round; i++) {
        int row = i % chart->row_count, below = (row + chart->row_count - 1) % chart->row_count;
        if (i && !chart->rows[row].wrong_side == !chart->rows[below].wrong_side)
            return YCI_FAIL(k->c, YC_ERROR_ARGUMENT,
                "chart: rows %d and %d have the same side in front, so this is worked in the round", below + 1,
                row + 1);
        if (i > chart->row_count) break;
    }
    for (i = 0; i < k->desc->rows && result == YC_OK; i++) { /* before there is anything in memory */
        result = yci_chart_fit(k->c, chart, i % chart->row_count, (int)needle, &times, &needle);
        worked += needle;
        if (worked > YCI_KNIT_LOOPS)
            return YCI_FAIL(k->c, YC_ERROR_ARGUMENT, "knit: more than %d loops", YCI_KNIT_LOOPS);
    }
    if (result != YC_OK) return result;
    k->dir = k->desc->round || chart->rows[0].wrong_side ? -1 : 1; /* row 1 from the right side runs to the left */
    k->last = -1;
    result = yci_knit_begin(k);
    for (i = 0; i < k->desc->rows && result == YC_OK; i++) result = yci_knit_row(k, chart, i % chart->row_count);
    if (result == YC_OK && !k->desc->live) result = yci_knit_end(k);
    return result;
}

/* ---- where loops lie ---- */

/* From one loop's base to another's; around a tube by the shorter way. */
static void yci_knit_way(const yci_knitter *k, const double *from, const double *to, double *d) {
    d[0] = to[0] - from[0], d[1] = to[1] - from[1];
    if (k->around > 0.0) d[0] -= k->around * floor(d[0] / k->around + 0.5);
}

static void yci_knit_spring(yci_knitter *k, int a, int b, double rest, double stiffness, double pressed) {
    double d[2], length, f;
    int i;
    yci_knit_way(k, k->loops[a].x, k->loops[b].x, d);
    length = sqrt(d[0] * d[0] + d[1] * d[1]);
    f = (length < rest ? pressed : stiffness) * (1.0 - rest / yci_max(length, 1e-3 * rest));
    for (i = 0; i < 2; i++) k->force[a][i] += f * d[i], k->force[b][i] -= f * d[i];
    k->force[a][2] += stiffness, k->force[b][2] += stiffness;
}

/* Springs along rows, which yield when pressed, as stitches draw together; along columns; and weak ones across where
 * neighbours are plain, which keep columns square to rows. */
static void yci_knit_forces(yci_knitter *k) {
    int i, j;
    memset(k->force, 0, (size_t)k->loop_count * sizeof *k->force);
    for (i = 0; i < k->loop_count; i++) {
        const yci_knit_loop *loop = &k->loops[i], *next = loop->next < 0 ? NULL : &k->loops[loop->next];
        for (j = 0; j < loop->old_count; j++) {
            int old = k->olds[loop->old + j], rows = loop->row - k->loops[old].row;
            if (rows) yci_knit_spring(k, i, old, k->height * rows, 1.0, 1.0);
        }
        if (!next || next->row != loop->row) continue;
        yci_knit_spring(k, i, loop->next, k->width * fabs(next->slot - loop->slot), 1.0, 0.3);
        if (loop->old_count == 1 && next->old_count == 1 && next->slot - loop->slot == 1.0 && !next->tail) {
            int a = k->olds[loop->old], b = k->olds[next->old], rows = loop->row - k->loops[a].row;
            double rest = sqrt(k->width * k->width + k->height * k->height * rows * rows);
            if (k->loops[a].row != k->loops[b].row || fabs(k->loops[a].slot - k->loops[b].slot) != 1.0 || !rows)
                continue;
            yci_knit_spring(k, i, b, rest, 0.3, 0.3), yci_knit_spring(k, loop->next, a, rest, 0.3, 0.3);
        }
    }
}

/* Lets the springs move the loops, by steps of Jacobi's method with momentum. */
static yc_result yci_knit_relax(yci_knitter *k) {
    int sweep, i, j;
    double far = k->width;
    k->force = (double(*)[3])yci_alloc(k->c, (size_t)k->loop_count, sizeof *k->force);
    k->speed = (double(*)[2])yci_alloc(k->c, (size_t)k->loop_count, sizeof *k->speed);
    if (!k->force || !k->speed) return yci_out_of_memory(k->c, "the layout of a knit");
    for (sweep = 0; sweep < YCI_KNIT_SWEEPS && far > 1e-4 * k->width; sweep++) {
        yci_knit_forces(k);
        for (i = 0, far = 0.0; i < k->loop_count; i++)
            for (j = 0; j < 2; j++) {
                k->speed[i][j] = 0.9 * k->speed[i][j] + 0.5 * k->force[i][j] / yci_max(k->force[i][2], 1e-30);
                k->loops[i].x[j] += k->speed[i][j];
                far = yci_max(far, fabs(k->speed[i][j]));
            }
    }
    return YC_OK;
}

static void yci_knit_add_way(const yci_knitter *k, int from, int to, double sign, double sum[2]) {
    double d[2], length;
    yci_knit_way(k, k->loops[from].x, k->loops[to].x, d);
    length = sqrt(d[0] * d[0] + d[1] * d[1]);
    if (length > 0.0) sum[0] += sign * d[0] / length, sum[1] += sign * d[1] / length;
}

/* The direction that is up at a loop's base: between that along its column and that across its row. */
static void yci_knit_up(const yci_knitter *k, int i, int before, double up[2]) {
    const yci_knit_loop *loop = &k->loops[i];
    double row[2] = {0.0, 0.0}, column[2] = {0.0, 0.0}, length;
    int j;
    if (before >= 0 && k->loops[before].row == loop->row && !loop->tail) yci_knit_add_way(k, before, i, loop->dir, row);
    if (loop->next >= 0 && k->loops[loop->next].row == loop->row) yci_knit_add_way(k, i, loop->next, loop->dir, row);
    for (j = 0; j < loop->old_count; j++) yci_knit_add_way(k, k->olds[loop->old + j], i, 1.0, column);
    for (j = 0; j < 2 && loop->up[j] >= 0; j++) yci_knit_add_way(k, i, loop->up[j], 1.0, column);
    for (j = 0; j < 2; j++) {
        double *d = j ? column : row;
        length = sqrt(d[0] * d[0] + d[1] * d[1]);
        if (length > 0.0) d[0] /= length, d[1] /= length;
    }
    up[0] = column[0] - row[1], up[1] = column[1] + row[0];
    length = sqrt(up[0] * up[0] + up[1] * up[1]);
    if (length < 0.1) up[0] = 0.0, up[1] = length = 1.0;
    up[0] /= length, up[1] /= length;
}

/* How many lone nodes shape the head of a loop that no other is drawn through: as many as if one were. */
static int yci_knit_open(const yci_knitter *k, const yci_knit_loop *loop) {
    return k->desc->live && loop->up[0] < 0 ? 4 : 0;
}

/* Numbers the nodes and contacts of a loop. */
static void yci_knit_number(yci_knitter *k, yci_knit_loop *loop) {
    loop->node = k->node_count, loop->contact = k->contact_count;
    if (loop->old_count) {
        k->node_count += loop->tail ? 2 : 4;
        k->contact_count += (loop->tail ? 1 : 2) * loop->old_count;
    }
    k->node_count += loop->twist + yci_knit_open(k, loop);
}

static int yci_knit_cross(const yci_knit_loop *loop) { return loop->node + (loop->old_count ? 4 : 0); }

/* Places a loop's nodes: A 0.35 widths beside its base and 0.32 heights below, B 0.15 beside and 0.32 above, where the
 * legs of Peirce's loop (1947; d the yarn's diameter, arcs of 1.5 d, loops 4 d wide in rows 2 sqrt(3) d apart) pass
 * beside the arcs of the row above and below; 0.2 in the chain that binds off, whose loops lie along the row. Legs
 * cross half way up, or at the base of a loop that is drawn through none. */
static void yci_knit_place_loop(yci_knitter *k, int i, int before) {
    const yci_knit_loop *loop = &k->loops[i];
    double up[2], d[2], deep = loop->row + 1 == k->row && !k->desc->live ? 0.2 : 0.32;
    int j, n, count = !loop->old_count ? 0 : loop->tail ? 2 : 4;
    yci_knit_up(k, i, before, up);
    for (n = 0; n < count; n++) {
        int side = loop->tail ? loop->dir > 0 : n / 2;
        double x = (side ? 1.0 : -1.0) * (n % 2 ? 0.15 : 0.35) * k->width, y = (n % 2 ? deep : -deep) * k->height;
        k->place[loop->node + n][0] = loop->x[0] + up[1] * x + up[0] * y;
        k->place[loop->node + n][1] = loop->x[1] - up[0] * x + up[1] * y;
    }
    for (n = 0; n < yci_knit_open(k, loop); n++) {
        double x = (n < 2 ? -loop->dir : loop->dir) * (n % 3 ? 0.15 : 0.35) * k->width;
        double y = (k->row - loop->row + (n % 3 ? 0.32 : -0.32)) * k->height;
        for (j = 0; j < 2; j++)
            k->place[yci_knit_cross(loop) + loop->twist + n][j] = loop->x[j] + (j ? -up[0] : up[1]) * x + up[j] * y;
    }
    if (!loop->twist) return;
    for (j = 0; j < 2; j++) k->place[yci_knit_cross(loop)][j] = loop->x[j];
    if (!loop->old_count) return;
    n = loop->up[1] >= 0 ? 2 : 1;
    for (j = 0; j < n; j++) {
        yci_knit_way(k, loop->x, k->loops[loop->up[j]].x, d);
        for (count = 0; count < 2; count++) k->place[yci_knit_cross(loop)][count] += 0.5 * d[count] / n;
    }
}

/* Numbers and places all nodes. The last two are the yarn's ends, half a stitch beyond its first and last loop. */
static yc_result yci_knit_place(yci_knitter *k) {
    int i, before = -1, last = k->loop_count - 1, n, end;
    yc_result result = k->shaped ? yci_knit_relax(k) : YC_OK;
    if (result != YC_OK) return result;
    for (i = 0; i >= 0; i = k->loops[i].next) yci_knit_number(k, &k->loops[i]);
    k->place = (double(*)[2])yci_alloc(k->c, (size_t)k->node_count + 2, sizeof *k->place);
    if (!k->place) return yci_out_of_memory(k->c, "the nodes of a knit");
    for (i = 0; i >= 0; before = i, i = k->loops[i].next) yci_knit_place_loop(k, i, before);
    n = k->node_count, k->node_count += 2;
    end = k->loops[last].node + (k->loops[last].tail ? 1 : k->loops[last].old_count && k->loops[last].dir > 0 ? 2 : 0);
    for (i = 0; i < 2; i++)
        k->place[n][i] = k->place[k->loops[0].node][i] - (i ? 0.0 : 0.5 * k->width * k->loops[0].dir),
        k->place[n + 1][i] = k->place[end][i] + (i ? 0.0 : 0.5 * k->width * k->loops[last].dir);
    return YC_OK;
}

/* ---- the yarn's way ---- */

static void yci_knit_go(yci_knitter *k, int node, int layer, int joined) {
    yci_knit_visit *v = &k->visits[k->visit_count++];
    v->node = node, v->layer = (signed char)layer, v->joined = (unsigned char)joined;
}

/* Goes through A and B of one side of the place where `at` is drawn through, or from B to A. `old`: which of its old
 * loops does so, from the front; -1: `at` itself. Of the k + 1 yarns there the new one lies behind the others at A and
 * before them at B; of a purl, the other way. */
static void yci_knit_touch(yci_knitter *k, int at, int old, int side, int down) {
    const yci_knit_loop *loop = &k->loops[at];
    int n = loop->old_count, i, end, sides = loop->tail ? 0 : side;
    for (i = 0; i < 2; i++) {
        int b = down ? !i : i, before = b != loop->purl, from_front; /* whether the new loop is before the others */
        from_front = old < 0 ? (before ? 0 : n) : old + before;
        for (end = 0; end < n; end++)
            if (old < 0 || end == old) {
                yc_stitch_contact *s = &k->contacts[loop->contact + sides * n + end];
                s->visit[old < 0][b] = k->visit_count;
                s->sign = (signed char)(side == loop->purl ? 1 : -1);
            }
        yci_knit_go(k, loop->node + 2 * sides + b, n - 2 * from_front, i == 0);
    }
}

/* The head of a loop within one that is drawn through it. `first`: the side that comes first. */
static void yci_knit_head(yci_knitter *k, int loop, int up, int first) {
    int old = 0;
    while (k->olds[k->loops[up].old + old] != loop) old++;
    if (!k->loops[up].tail) yci_knit_touch(k, up, old, first, 0);
    yci_knit_touch(k, up, old, !first, 1);
}

/* Follows the yarn through all loops. Crossing legs: the one from the lower right to the upper left lies in front. */
static yc_result yci_knit_follow(yci_knitter *k) {
    int i, j, count = 2, ends = k->node_count - 2;
    for (i = 0; i < k->loop_count; i++) /* two visits of A and B at each side, by each yarn */
        count += (k->loops[i].tail ? 2 : 4) * (k->loops[i].old_count + (k->loops[i].old_count > 0)) +
            2 * k->loops[i].twist + yci_knit_open(k, k->loops + i);
    k->visits = YCI_NEW(k->c, yci_knit_visit, count);
    k->contacts = YCI_NEW(k->c, yc_stitch_contact, k->contact_count);
    if (!k->visits || !k->contacts) return yci_out_of_memory(k->c, "the yarn of a knit");
    yci_knit_go(k, ends, 0, 0);
    for (i = 0; i >= 0; i = k->loops[i].next) {
        const yci_knit_loop *loop = &k->loops[i];
        int near = loop->dir < 0, turned = loop->up[1] >= 0 && loop->up_dir != loop->dir; /* near: 0 left, 1 right */
        if (loop->old_count) yci_knit_touch(k, i, -1, loop->tail ? !near : near, 0);
        if (loop->twist) yci_knit_go(k, yci_knit_cross(loop), -loop->dir, 0);
        for (j = 0; j < 2; j++) {
            int up = loop->up[turned ? !j : j];
            if (up >= 0) yci_knit_head(k, i, up, near ^ loop->twist);
        }
        for (j = 0; j < yci_knit_open(k, loop); j++) {
            k->visits[k->visit_count].alone = 1;
            yci_knit_go(k, yci_knit_cross(loop) + loop->twist + j, 0, 0);
        }
        if (loop->twist) yci_knit_go(k, yci_knit_cross(loop), loop->dir, 0);
        if (loop->old_count && !loop->tail) yci_knit_touch(k, i, -1, !near, 1);
    }
    yci_knit_go(k, ends + 1, 0, 0);
    return YC_OK;
}

/* Sets `count` points that begin (side 1) or end (side 0) the segment d from or to `at`: equal shares of a turn. */
static void yci_knit_cut(const double *at, const double *d, double turn, int side, int count, double (*out)[2]) {
    double x[2], angle, step = side ? YCI_KNIT_STEP : -YCI_KNIT_STEP;
    int i;
    x[0] = at[0], x[1] = at[1];
    for (i = 0; i < count; i++) {
        angle = (side ? -1.0 : 1.0) * turn * (count - i) / (count + 1);
        x[0] += step * (cos(angle) * d[0] - sin(angle) * d[1]), x[1] += step * (sin(angle) * d[0] + cos(angle) * d[1]);
        out[side ? i : count - 1 - i][0] = x[0], out[side ? i : count - 1 - i][1] = x[1];
    }
}

/* The points from a visit to the next one, as laid flat; returns their count. */
static int yci_knit_segment(const yci_knitter *k, int visit, double (*out)[2]) {
    const yci_knit_visit *v = &k->visits[visit];
    const double *at = k->place[v->node];
    int n = v->cuts[1], count = n + v[1].cuts[0] + 2;
    double d[2], length;
    if (v->node == v[1].node) { /* a yarn over at the end of a row, drawn through at once */
        yci_knit_way(k, k->place[v[-1].node], at, d);
        length = yci_max(sqrt(d[0] * d[0] + d[1] * d[1]), 1e-3 * k->width);
        out[0][0] = out[2][0] = at[0], out[0][1] = out[2][1] = at[1];
        out[1][0] = at[0] + 0.3 * k->width / length * d[0], out[1][1] = at[1] + 0.3 * k->width / length * d[1];
        return 3;
    }
    yci_knit_way(k, at, k->place[v[1].node], d);
    out[0][0] = at[0], out[0][1] = at[1], out[count - 1][0] = at[0] + d[0], out[count - 1][1] = at[1] + d[1];
    yci_knit_cut(at, d, v->turn, 1, n, out + 1);
    yci_knit_cut(out[count - 1], d, v[1].turn, 0, v[1].cuts[0], out + 1 + n);
    return count;
}

/* How far the way a b, c d turns, from -pi to pi. */
static double yci_knit_angle(const double *a, const double *b, const double *c, const double *d) {
    double p[2], q[2];
    p[0] = b[0] - a[0], p[1] = b[1] - a[1], q[0] = d[0] - c[0], q[1] = d[1] - c[1];
    return atan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]);
}

static void yci_knit_more(yci_knit_visit *v, int side) {
    if (v[side - 1].node != v[side].node && v->cuts[side] < YCI_KNIT_CUTS) v->cuts[side]++;
}

/* Puts nodes beside every turn that is too sharp: into the segment outside of contacts, the longer one. More where that
 * does not suffice, since nodes at one end of a segment tilt what is left of it. */
static void yci_knit_turns(yci_knitter *k) {
    double points[2][2 * YCI_KNIT_CUTS + 2][2], d[2][2];
    int sweep, i, j, count = 0, before;
    for (i = 1; i + 1 < k->visit_count; i++) { /* as it turns without nodes */
        yci_knit_visit *v = &k->visits[i];
        yci_knit_way(k, k->place[v[-1].node], k->place[v->node], d[0]);
        yci_knit_way(k, k->place[v->node], k->place[v[1].node], d[1]);
        v->turn = atan2(d[0][0] * d[1][1] - d[0][1] * d[1][0], d[0][0] * d[1][0] + d[0][1] * d[1][1]);
        v->after = !v->joined &&
            (v[-1].joined || d[1][0] * d[1][0] + d[1][1] * d[1][1] >= d[0][0] * d[0][0] + d[0][1] * d[0][1]);
        if (v[-1].node == v->node || v->node == v[1].node) v->turn = 0.0;
        if (fabs(v->turn) > YCI_KNIT_TURN)
            v->cuts[v->after] = (unsigned char)(1 + (fabs(v->turn) > 1.5 * YCI_KNIT_TURN));
        if (v->node == v[1].node) v->cuts[1] = 1;
    }
    for (sweep = 0; sweep < 2 * YCI_KNIT_CUTS; sweep++)
        for (i = 0; i + 1 < k->visit_count; i++) {
            yci_knit_visit *v = &k->visits[i];
            double(*p)[2] = points[i & 1], (*q)[2] = points[~i & 1];
            before = count, count = yci_knit_segment(k, i, p);
            if (i && fabs(yci_knit_angle(q[before - 2], q[before - 1], p[0], p[1])) > YCI_KNIT_TURN)
                yci_knit_more(v, v->after);
            for (j = 1; j + 1 < count; j++)
                if (fabs(yci_knit_angle(p[j - 1], p[j], p[j], p[j + 1])) > YCI_KNIT_TURN)
                    yci_knit_more(j <= v->cuts[1] ? v : v + 1, j <= v->cuts[1]);
        }
}

/* Gives the visits their numbers; returns the count of nodes beside turns. */
static int yci_knit_count(yci_knitter *k) {
    int i, added = 0;
    for (i = 0; i < k->visit_count; i++) {
        added += k->visits[i].cuts[0];
        k->visits[i].at = i + added;
        added += k->visits[i].cuts[1];
    }
    return added;
}

/* The place of a point of the flat layout. */
static void yci_knit_bend(const yci_knitter *k, const double *x, double *out) {
    double radius = k->around / (2.0 * YCI_PI);
    out[0] = x[0], out[1] = x[1], out[2] = 0.0;
    if (radius > 0.0) out[0] = radius * sin(x[0] / radius), out[2] = radius * cos(x[0] / radius);
}

/* Copies nodes and visits, with the nodes of sharp turns last. */
static void yci_knit_fill(yci_knitter *k, yc_yarns *y) {
    double points[2 * YCI_KNIT_CUTS + 2][2];
    int i, j, next = k->node_count, n;
    for (i = 0; i < k->node_count; i++) yci_knit_bend(k, k->place[i], y->layout[i]);
    for (i = 0; i < k->visit_count; i++) {
        const yci_knit_visit *v = &k->visits[i];
        y->visit_node[v->at] = v->node, y->visit_layer[v->at] = v->layer;
        y->visit_held[v->at] = (unsigned char)(i == 0 ? 2 : v->alone);
        if (i + 1 == k->visit_count) {
            y->visit_held[v->at] = k->desc->live ? 1 : 2;
            break;
        }
        n = yci_knit_segment(k, i, points);
        for (j = 1; j + 1 < n; j++, next++) {
            yci_knit_bend(k, points[j], y->layout[next]);
            y->visit_node[v->at + j] = next, y->visit_held[v->at + j] = 1;
        }
    }
    for (i = 0; i < k->contact_count; i++) {
        y->contacts[i] = k->contacts[i];
        for (j = 0; j < 4; j++) {
            int *visit = &y->contacts[i].visit[j / 2][j % 2];
            *visit = k->visits[*visit].at;
        }
    }
}

/* How many visits a loop makes, in `visits`. */
static int yci_knit_visits_of(const yci_knitter *k, const yci_knit_loop *loop) {
    int count = (loop->tail ? 2 : 4) * (loop->old_count > 0) + 2 * loop->twist + yci_knit_open(k, loop), j;
    for (j = 0; j < 2 && loop->up[j] >= 0; j++) count += k->loops[loop->up[j]].tail ? 2 : 4;
    return count;
}

/* Lengths along the yarn; the mean over worked rows is then what the descriptor asks for. */
static void yci_knit_measure(yci_knitter *k, yc_yarns *y) {
    double d[3], worked = 0.0, least = YCI_KNIT_LEAST * yci_min(k->width, k->height);
    int i, v, end, stitches = 0;
    for (v = 1; v < y->visit_count; v++) {
        yci_sub(d, y->layout[y->visit_node[v]], y->layout[y->visit_node[v - 1]]);
        y->visit_u[v] = y->visit_u[v - 1] + yci_max(yci_norm(d), least);
    }
    for (i = 0, v = 0; i >= 0; i = k->loops[i].next, v = end) { /* a loop's stretch of yarn ends at its last visit */
        end = v + yci_knit_visits_of(k, &k->loops[i]);
        if (k->loops[i].row < 1 || k->loops[i].row > k->desc->rows) continue;
        worked += y->visit_u[k->visits[end].at] - y->visit_u[k->visits[v].at], stitches++;
    }
    k->scale = k->desc->loop > 0.0 && worked > 0.0 ? k->desc->loop * stitches / worked : 1.0;
    for (v = 0; v < y->visit_count; v++) y->visit_u[v] *= k->scale;
}

/* Turns the layers of crossing legs where a tube turns away: +1 stands for the side of u x v, which is the inner one
 * there. That side is the one of the normal's positive z, as in yci_curve_normal. */
static void yci_knit_cross_layers(const yci_knitter *k, yc_yarns *y) {
    int i, j, e, v, end;
    for (i = 0, v = 0; i >= 0; i = k->loops[i].next, v = end) {
        const yci_knit_loop *loop = &k->loops[i];
        double t[2][3], d[3], n[3];
        const double *x;
        int at[2];
        end = v + yci_knit_visits_of(k, loop);
        if (!loop->twist) continue;
        at[0] = k->visits[v + 1 + (loop->old_count ? 2 : 0)].at, at[1] = k->visits[end - (loop->old_count ? 2 : 0)].at;
        x = y->layout[y->visit_node[at[0]]];
        memset(t, 0, sizeof t);
        for (j = 0; j < 2; j++)
            for (e = -1; e < 2; e += 2) {
                yci_sub(d, y->layout[y->visit_node[at[j] + e]], x);
                yci_axpy(t[j], e / yci_max(yci_norm(d), 1e-300), d);
            }
        yci_cross(n, t[0], t[1]);
        if ((n[2] < 0.0) == (n[0] * x[0] + n[2] * x[2] < 0.0)) continue;
        for (j = 0; j < 2; j++) y->visit_layer[at[j]] = (signed char)-y->visit_layer[at[j]];
    }
}

static yc_result yci_knit_lay(yci_knitter *k, yc_yarns *out) {
    int added, i, j;
    double low[2] = {0.0, 0.0};
    char *block;
    yc_yarns y;
    yc_result result = yci_knit_place(k);
    if (result == YC_OK) result = yci_knit_follow(k);
    if (result != YC_OK) return result;
    for (j = 0; j < 2 && k->around == 0.0; j++) {
        for (i = 0, low[j] = k->place[0][j]; i < k->node_count; i++) low[j] = yci_min(low[j], k->place[i][j]);
        for (i = 0; i < k->node_count; i++) k->place[i][j] -= low[j];
    }
    yci_knit_turns(k);
    added = yci_knit_count(k);
    memset(&y, 0, sizeof y);
    y.node_count = k->node_count + added, y.visit_count = k->visit_count + added;
    y.yarn_count = y.material_count = 1, y.contact_count = k->contact_count;
    block = (char *)yci_alloc(k->c, yci_weave_arrays(&y, NULL, 0, YCI_TURNS), 1);
    if (!block) return yci_out_of_memory(k->c, "a yarn network");
    yci_weave_arrays(&y, block, 0, YCI_TURNS);
    y.yarn_first[1] = y.visit_count, y.yarn_family[0] = YC_WEFT, y.materials[0] = k->desc->yarn;
    yci_knit_fill(k, &y);
    yci_knit_measure(k, &y);
    if (k->around > 0.0) yci_knit_cross_layers(k, &y);
    *out = y;
    return YC_OK;
}

/* Knits what desc asks for, or would without a mesh. *scale: that of u. */
static yc_result yci_knit_make(yci_context *c, const yc_knit_desc *desc, yc_yarns *out, double *scale) {
    yci_knitter k;
    yc_result result;
    memset(&k, 0, sizeof k);
    k.c = c, k.desc = desc;
    k.width = 1.0 / desc->wales, k.height = 1.0 / desc->courses;
    k.around = desc->round ? desc->stitches * k.width : 0.0;
    result = yci_knit_work(&k);
    if (result == YC_OK) result = yci_knit_lay(&k, out);
    *scale = k.scale;
    yci_free(c, k.loops), yci_free(c, k.olds), yci_free(c, k.needle), yci_free(c, k.fresh);
    yci_free(c, k.force), yci_free(c, k.speed), yci_free(c, k.place);
    yci_free(c, k.visits), yci_free(c, k.contacts);
    return result;
}

/* ---- knits cut to the pieces of a pattern ---- */

/* A weaver holds what has been cut so far: nodes, yarns (its spans), visits; and makes the rods. The piece at work lies
 * in a grid of cells as large as stitches, in the frame. */
typedef struct {
    yci_weaver w;
    const yc_knit_desc *desc;
    yc_stitch_contact *contacts; /* with numbers of w.visits */
    int contact_count, contact_capacity;
    double scale; /* of the yarn in a stitch over what is laid, of the largest piece */
    int largest;  /* visits that were cut for it */
    /* the piece at work: what is cut, as knitted flat, its layout in the frame */
    yc_yarns flat;
    yci_weave_node *at;   /* [flat.node_count], in the pattern; visits: how many in all; over: what of them is left */
    int *run;             /* [flat.visit_count], the span that a visit is left to; -1: none */
    int *to;              /* [flat.visit_count], its number in w.visits */
    double low[2];        /* of the grid */
    int cells[2];         /* of the grid */
    int *first, *members; /* [cells + 2], nodes or half-edges of the outline */
} yci_knit_cutter;

/* How many stitches, at least so many, the chart turns into as many again; 0: none that is near. */
static int yci_knit_fitting(yci_context *c, const yc_chart *chart, int least) {
    int n, row, times;
    for (n = least; n < least + 1000 + 2 * chart->multiple[0]; n++) {
        double needle = n;
        for (row = 0; row < chart->row_count; row++)
            if (needle > YCI_KNIT_LOOPS || yci_chart_fit(c, chart, row, (int)needle, &times, &needle) != YC_OK) break;
        if (row == chart->row_count && needle == n) return n;
    }
    return 0;
}

/* Knits a piece that covers the box: some stitches and rows more, and more of them where loops move. */
static yc_result yci_knit_cover(yci_knit_cutter *t, int triangle, const double *low, const double *high) {
    const double size[2] = {1.0 / t->desc->wales, 1.0 / t->desc->courses};
    const yc_chart *chart = t->desc->chart ? t->desc->chart : &yci_knit_plain;
    yc_knit_desc d = *t->desc;
    double scale, need[2], shift[2], least[2] = {HUGE_VAL, HUGE_VAL}, most[2] = {-HUGE_VAL, -HUGE_VAL};
    int i, f, shaped = 0;
    yc_result result;
    for (i = 0; i < chart->item_count; i++)
        shaped |= yci_stitches[chart->items[i].stitch].uses != yci_stitches[chart->items[i].stitch].makes;
    for (f = 0; f < 2; f++) need[f] = ceil((high[f] - low[f]) / size[f] * (shaped ? 1.15 : 1.0)) + 4.0;
    if (!(need[0] * need[1] <= YCI_KNIT_LOOPS))
        return YCI_FAIL(t->w.c, YC_ERROR_ARGUMENT,
            "knit.wales = %g, courses = %g: the rectangle around the piece of mesh.triangles[%d] takes about %.3g "
            "loops, more than %d",
            t->desc->wales, t->desc->courses, triangle, need[0] * need[1], YCI_KNIT_LOOPS);
    d.stitches = yci_knit_fitting(t->w.c, chart, (int)need[0]), d.rows = (int)need[1], d.live = 1;
    if (!d.stitches)
        return YCI_FAIL(t->w.c, YC_ERROR_ARGUMENT,
            "knit.chart: no number of stitches from %.0f on, which the piece of mesh.triangles[%d] takes, fits its "
            "rows and is left after them",
            need[0], triangle);
    result = yci_knit_make(t->w.c, &d, &t->flat, &scale);
    if (result != YC_OK) return result;
    if (t->flat.visit_count > t->largest) t->largest = t->flat.visit_count, t->scale = scale;
    for (i = 1; i + 1 < t->flat.visit_count; i++) { /* the yarn's ends stick out */
        const double *x = t->flat.layout[t->flat.visit_node[i]];
        for (f = 0; f < 2; f++) least[f] = yci_min(least[f], x[f]), most[f] = yci_max(most[f], x[f]);
    }
    for (f = 0; f < 2; f++) shift[f] = 0.5 * (low[f] + high[f] - least[f] - most[f]);
    /* Sides that run along columns shall fall between two. */
    if ((d.stitches - (int)((high[0] - low[0]) / size[0] + 0.5)) % 2) shift[0] += 0.5 * size[0];
    for (i = 0; i < t->flat.node_count; i++)
        for (f = 0; f < 2; f++) t->flat.layout[i][f] += shift[f];
    for (f = 0; f < 2; f++) {
        t->low[f] = low[f] - 0.5 * size[f];
        t->cells[f] = (int)((high[f] - low[f]) / size[f]) + 2;
    }
    return YC_OK;
}

/* The column or row of cells in which x lies; outside the grid, the nearest. */
static int yci_knit_cell(const yci_knit_cutter *t, int f, double x) {
    double cell = floor((x - t->low[f]) * (f ? t->desc->courses : t->desc->wales));
    return (int)yci_clamp(cell, 0.0, t->cells[f] - 1.0);
}

/* Enters something in a cell: at first it is counted, then listed. */
static void yci_knit_enter(yci_knit_cutter *t, int column, int row, int item, int list) {
    int *first = t->first + row * t->cells[0] + column;
    if (list) t->members[first[1]++] = item;
    else first[2]++;
}

static void yci_knit_enter_nodes(yci_knit_cutter *t, int list) {
    int i;
    for (i = 0; i < t->flat.node_count; i++)
        yci_knit_enter(
            t, yci_knit_cell(t, 0, t->flat.layout[i][0]), yci_knit_cell(t, 1, t->flat.layout[i][1]), i, list);
}

/* Half-edges of the outline, row by row of cells. */
static void yci_knit_enter_edges(yci_knit_cutter *t, int piece, int list) {
    const yci_weaver *w = &t->w;
    double close = 1e-6 / t->desc->wales, tall = 1.0 / t->desc->courses;
    int i, k, row, last, column, end;
    for (i = w->piece_first[piece]; i < w->piece_first[piece + 1]; i++)
        for (k = 0; k < 3; k++) {
            int half = 3 * w->piece_triangle[i] + k;
            double p[2], q[2];
            if (yci_weave_interior(w, half)) continue;
            yci_weave_to_frame(w, yci_weave_uv(w, half), p);
            yci_weave_to_frame(w, yci_weave_uv(w, yci_half_next(half)), q);
            row = yci_knit_cell(t, 1, yci_min(p[1], q[1]) - close);
            last = yci_knit_cell(t, 1, yci_max(p[1], q[1]) + close);
            for (; row <= last; row++) {
                double x[2], y = t->low[1] + row * tall;
                x[0] = p[0], x[1] = q[0];
                if (fabs(q[1] - p[1]) > close) { /* what of it lies in this row */
                    double a = yci_clamp((y - close - p[1]) / (q[1] - p[1]), 0.0, 1.0);
                    double b = yci_clamp((y + tall + close - p[1]) / (q[1] - p[1]), 0.0, 1.0);
                    x[0] = p[0] + a * (q[0] - p[0]), x[1] = p[0] + b * (q[0] - p[0]);
                }
                column = yci_knit_cell(t, 0, yci_min(x[0], x[1]) - close);
                end = yci_knit_cell(t, 0, yci_max(x[0], x[1]) + close);
                for (; column <= end; column++) yci_knit_enter(t, column, row, half, list);
            }
        }
}

/* Fills the grid with nodes, or with the outline of a piece. */
static int yci_knit_grid(yci_knit_cutter *t, int piece, int outline) {
    int cells = t->cells[0] * t->cells[1], list, i;
    yci_free(t->w.c, t->first), yci_free(t->w.c, t->members);
    t->members = NULL, t->first = YCI_NEW(t->w.c, int, (size_t)cells + 2);
    if (!t->first) return 0;
    for (list = 0; list < 2; list++) {
        if (list) {
            for (i = 0; i < cells; i++) t->first[i + 2] += t->first[i + 1];
            t->members = YCI_NEW(t->w.c, int, t->first[cells + 1]);
            if (!t->members) return 0;
        }
        if (outline) yci_knit_enter_edges(t, piece, list);
        else yci_knit_enter_nodes(t, list);
    }
    return 1;
}

static double yci_knit_depth(const yci_weave_node *node) {
    return yci_min(yci_min(node->weights[0], node->weights[1]), node->weights[2]);
}

/* Finds the triangles in which nodes lie: those that no triangle has are outside. */
static yc_result yci_knit_locate(yci_knit_cutter *t, int piece) {
    const yci_weaver *w = &t->w;
    double close = 1e-6 / t->desc->wales, flush = 1e-9; /* m; of weights */
    int i, k, f, row, column, from[2], end[2];
    for (i = 0; i < t->flat.node_count; i++) {
        yci_weave_from_frame(w, t->flat.layout[i], t->at[i].place);
        t->at[i].triangle = -1;
    }
    for (k = w->piece_first[piece]; k < w->piece_first[piece + 1]; k++) {
        int triangle = w->piece_triangle[k];
        double p[3][2];
        for (i = 0; i < 3; i++) yci_weave_to_frame(w, yci_weave_uv(w, 3 * triangle + i), p[i]);
        for (f = 0; f < 2; f++) {
            from[f] = yci_knit_cell(t, f, yci_min(yci_min(p[0][f], p[1][f]), p[2][f]) - close);
            end[f] = yci_knit_cell(t, f, yci_max(yci_max(p[0][f], p[1][f]), p[2][f]) + close);
        }
        for (row = from[1]; row <= end[1]; row++)
            for (column = from[0]; column <= end[0]; column++) {
                const int *cell = t->first + row * t->cells[0] + column;
                for (i = cell[0]; i < cell[1]; i++) {
                    yci_weave_node *node = t->at + t->members[i], here = *node;
                    double depth;
                    here.triangle = -1;
                    yci_weave_claim(&t->w, triangle, &here);
                    depth = yci_knit_depth(&here);
                    if (depth < -flush) continue;
                    if (node->triangle < 0) *node = here;
                    else if (yci_min(depth, yci_knit_depth(node)) > flush)
                        return yci_weave_overlap(&t->w, 3 * triangle);
                    else if (depth > yci_knit_depth(node)) *node = here;
                }
            }
    }
    return YC_OK;
}

static int yci_knit_inside(const yci_knit_cutter *t, int visit) {
    return t->at[t->flat.visit_node[visit]].triangle >= 0;
}

/* The next place, along the yarn from visit v to the next one, where that enters the piece, or leaves it. after: where
 * it left it last, and entered it. */
static int yci_knit_cut_next(const yci_knit_cutter *t, int v, int enter, const double after[2], yci_weave_cut *cut) {
    const double *p = t->flat.layout[t->flat.visit_node[v]], *q = t->flat.layout[t->flat.visit_node[v + 1]];
    double d[2], a[2], b[2], along, sides[2];
    int f, i, row, column, from[2], end[2];
    cut->half = -1;
    for (f = 0; f < 2; f++) {
        d[f] = q[f] - p[f];
        from[f] = yci_knit_cell(t, f, yci_min(p[f], q[f])), end[f] = yci_knit_cell(t, f, yci_max(p[f], q[f]));
    }
    for (row = from[1]; row <= end[1]; row++)
        for (column = from[0]; column <= end[0]; column++) {
            const int *cell = t->first + row * t->cells[0] + column;
            for (i = cell[0]; i < cell[1]; i++) {
                int half = t->members[i];
                yci_weave_to_frame(&t->w, yci_weave_uv(&t->w, half), a);
                yci_weave_to_frame(&t->w, yci_weave_uv(&t->w, yci_half_next(half)), b);
                sides[0] = d[0] * (a[1] - p[1]) - d[1] * (a[0] - p[0]);
                sides[1] = d[0] * (b[1] - p[1]) - d[1] * (b[0] - p[0]);
                /* The piece lies to the left of its outline: an edge that runs to the right is left behind. */
                if ((sides[0] <= 0.0) == (sides[1] <= 0.0) || (sides[0] > 0.0) != enter) continue;
                along = ((a[0] - p[0]) * (b[1] - a[1]) - (a[1] - p[1]) * (b[0] - a[0])) /
                    (d[0] * (b[1] - a[1]) - d[1] * (b[0] - a[0]));
                if (!(along >= -1e-9 && along <= 1.0 + 1e-9 && along > after[enter] && along >= after[!enter]))
                    continue;
                if (cut->half >= 0 && (along > cut->along || (along == cut->along && half >= cut->half))) continue;
                cut->along = along, cut->half = half, cut->share = sides[0] / (sides[0] - sides[1]);
            }
        }
    return cut->half >= 0;
}

/* A yarn begins, at a cut or, where rounding hides that, at a visit. */
static yci_weave_span *yci_knit_begin_run(yci_weaver *w, int visit, const yci_weave_cut *cut) {
    yci_weave_span *span;
    if (!YCI_RESERVE(w->c, w->spans, w->span_capacity, w->span_count, w->span_count + 1)) return NULL;
    span = &w->spans[w->span_count++];
    memset(span, 0, sizeof *span);
    span->family = YC_WEFT, span->tip[0] = span->tip[1] = -1, span->first = visit;
    span->half[0] = cut ? cut->half : -1, span->share[0] = cut ? cut->share : 0.0;
    span->half[1] = -1;
    return span;
}

/* Follows the yarn: where it is inside it makes spans, whose `first` and `count` are visits of the flat piece. */
static int yci_knit_runs(yci_knit_cutter *t) {
    yci_weaver *w = &t->w;
    yci_weave_span *span = NULL;
    yci_weave_cut cut;
    int v;
    for (v = 0; v < t->flat.visit_count; v++) {
        int inside = yci_knit_inside(t, v), enter;
        double after[2] = {-1.0, -1.0};
        if (!inside) span = NULL;
        else if (!span && !(span = yci_knit_begin_run(w, v, NULL))) return 0;
        t->run[v] = span ? w->span_count - 1 : -1;
        if (span) span->count++;
        if (v + 1 == t->flat.visit_count || (!span && !yci_knit_inside(t, v + 1))) continue;
        for (enter = !span; yci_knit_cut_next(t, v, enter, after, &cut); enter = !enter) {
            after[enter] = cut.along;
            if (!enter) span->half[1] = cut.half, span->share[1] = cut.share, span = NULL;
            else if (!(span = yci_knit_begin_run(w, v + 1, &cut))) return 0;
        }
    }
    return 1;
}

/* Takes visits that are too close to where their yarn is cut from it. */
static void yci_knit_trim(yci_knit_cutter *t, int begin) {
    yci_weaver *w = &t->w;
    int i, e;
    for (i = begin; i < w->span_count; i++)
        for (e = 0; e < 2; e++) {
            yci_weave_span *span = &w->spans[i];
            yci_weave_node tip;
            while (span->count && span->half[e] >= 0) {
                int v = e ? span->first + span->count - 1 : span->first;
                const double *x = t->at[t->flat.visit_node[v]].place;
                double d[2], stub = YCI_KNIT_STUB / t->desc->wales;
                yci_weave_place(w, &tip, span->half[e], span->share[e]);
                d[0] = tip.place[0] - x[0], d[1] = tip.place[1] - x[1];
                if (d[0] * d[0] + d[1] * d[1] >= stub * stub) break;
                t->run[v] = -1, span->count--, span->first += !e;
            }
        }
}

/* Marks nodes that keep all visits, 1, and, in stitch contacts, have their partner whole and all yarn between both, 2.
 */
static void yci_knit_mark_whole(yci_knit_cutter *t) {
    const yc_yarns *y = &t->flat;
    int i, k;
    for (i = 0; i < y->node_count; i++) t->at[i].over = t->at[i].visits > 1;
    for (i = 0; i < y->visit_count; i++)
        if (t->run[i] < 0) t->at[y->visit_node[i]].over = 0;
    for (i = 0; i < y->contact_count; i++) {
        const yc_stitch_contact *s = y->contacts + i;
        yci_weave_node *a = t->at + y->visit_node[s->visit[0][0]], *b = t->at + y->visit_node[s->visit[0][1]];
        int whole = a->over && b->over;
        for (k = 0; k < 2; k++) whole = whole && t->run[s->visit[k][0]] == t->run[s->visit[k][1]];
        a->over = b->over = 2 * whole;
    }
}

/* Leaves out yarns without a contact, which may cross their own legs or others'. Returns how many yarns stay. */
static int yci_knit_prune(yci_knit_cutter *t, int begin) {
    yci_weaver *w = &t->w;
    int i, k, pruned = 1, left = 0;
    while (pruned) {
        yci_knit_mark_whole(t);
        for (i = begin, pruned = left = 0; i < w->span_count; i++) {
            yci_weave_span *span = &w->spans[i];
            int contacts = 0, end = span->first + span->count;
            for (k = span->first; k < end; k++) contacts += t->at[t->flat.visit_node[k]].over == 2;
            if (contacts) {
                left++;
                continue;
            }
            pruned |= span->count > 0;
            for (k = span->first; k < end; k++) t->run[k] = -1;
            span->count = 0;
        }
    }
    return left;
}

/* Copies what is left of the piece. A visit whose node is not whole gets one of its own. */
static yc_result yci_knit_keep(yci_knit_cutter *t, int begin) {
    yci_weaver *w = &t->w;
    yci_weave_node *node;
    int i, k, e, last;
    for (i = 0; i < t->flat.node_count; i++) t->at[i].visits = -1; /* its number from now on */
    for (i = begin; i < w->span_count; i++) {
        yci_weave_span *span = &w->spans[i];
        int first = span->first;
        span->first = w->visit_count;
        for (k = first; k < first + span->count; k++) {
            yci_weave_node *from = t->at + t->flat.visit_node[k];
            if (from->visits < 0 || !from->over) {
                node = yci_weave_push_node(w);
                if (!node) return yci_out_of_memory(w->c, "the nodes of a knit");
                *node = *from, node->visits = 0, from->visits = w->node_count - 1;
            }
            w->nodes[from->visits].visits++, t->to[k] = w->visit_count;
            if (yci_weave_push_visit(w, from->visits, 0.0) != YC_OK)
                return yci_out_of_memory(w->c, "the visits of a knit");
            if (from->over) w->visits[t->to[k]].layer = t->flat.visit_layer[k];
        }
        for (e = 0; e < 2 && span->count; e++) {
            if (span->half[e] < 0) continue;
            node = yci_weave_push_node(w);
            if (!node) return yci_out_of_memory(w->c, "the nodes of a knit");
            span->tip[e] = w->node_count - 1, node->visits = 1;
            yci_weave_place(w, node, span->half[e], span->share[e]);
        }
    }
    for (i = 0; i < t->flat.contact_count; i++) {
        const yc_stitch_contact *s = t->flat.contacts + i;
        if (!t->at[t->flat.visit_node[s->visit[0][0]]].over) continue;
        last = t->contact_count;
        if (!YCI_RESERVE(w->c, t->contacts, t->contact_capacity, last, last + 1))
            return yci_out_of_memory(w->c, "the contacts of a knit");
        t->contacts[last] = *s, t->contact_count++;
        for (k = 0; k < 4; k++) t->contacts[last].visit[k / 2][k % 2] = t->to[s->visit[k / 2][k % 2]];
    }
    return YC_OK;
}

static yc_result yci_knit_piece(yci_knit_cutter *t, int piece) {
    yci_context *c = t->w.c;
    double low[2], high[2];
    int i, begin = t->w.span_count, triangle = t->w.piece_triangle[t->w.piece_first[piece]];
    yc_result result;
    yci_weave_box(&t->w, piece, low, high);
    result = yci_knit_cover(t, triangle, low, high);
    if (result != YC_OK) return result;
    t->at = YCI_NEW(c, yci_weave_node, t->flat.node_count);
    t->run = YCI_NEW(c, int, t->flat.visit_count), t->to = YCI_NEW(c, int, t->flat.visit_count);
    if (!t->at || !t->run || !t->to || !yci_knit_grid(t, piece, 0)) result = yci_out_of_memory(c, "a piece of a knit");
    if (result == YC_OK) result = yci_knit_locate(t, piece);
    if (result == YC_OK && !(yci_knit_grid(t, piece, 1) && yci_knit_runs(t)))
        result = yci_out_of_memory(c, "a piece of a knit");
    if (result == YC_OK) {
        for (i = 0; i < t->flat.visit_count; i++) t->at[t->flat.visit_node[i]].visits++;
        yci_knit_trim(t, begin);
        if (yci_knit_prune(t, begin)) result = yci_knit_keep(t, begin);
        else
            result = YCI_FAIL(c, YC_ERROR_ARGUMENT,
                "knit.wales = %g, courses = %g: the piece of mesh.triangles[%d] is too small for a loop",
                t->desc->wales, t->desc->courses, triangle);
    }
    yci_free(c, t->flat.owner), yci_free(c, t->at), yci_free(c, t->run), yci_free(c, t->to);
    t->at = NULL, t->run = t->to = NULL;
    return result;
}

/* A yarn of the network: `at` receives its visits' nodes, as numbered there. */
static void yci_knit_fill_yarn(const yci_knit_cutter *t, const yci_weave_span *span, const int *number, yc_yarns *y) {
    const yci_weaver *w = &t->w;
    double least = YCI_KNIT_LEAST * yci_min(1.0 / t->desc->wales, 1.0 / t->desc->courses), d[2][3], cross[3];
    int rod = span->family == YC_ROD, yarn = y->yarn_count++, first = y->yarn_first[yarn], v = first, k, e;
    for (k = -(span->tip[0] >= 0); k < span->count + (span->tip[1] >= 0); k++, v++) {
        int tip = k < 0 || k == span->count, visit = span->first + k;
        int old = tip ? span->tip[k >= 0] : w->visits[visit].node;
        y->visit_node[v] = number[old], y->visit_held[v] = rod || w->nodes[old].visits == 1;
        if (!tip && w->nodes[old].visits > 1) y->visit_layer[v] = w->visits[visit].layer;
        if (v == first) continue;
        yci_sub(d[0], y->layout[y->visit_node[v]], y->layout[y->visit_node[v - 1]]);
        y->visit_u[v] = rod && !tip ? w->visits[visit].along - w->visits[span->first].along
                                    : y->visit_u[v - 1] + yci_max(yci_norm(d[0]), least);
    }
    y->yarn_family[yarn] = (unsigned char)span->family, y->yarn_material[yarn] = rod;
    y->yarn_first[yarn + 1] = v;
    for (e = 0; e < 2; e++) {
        y->visit_held[e ? v - 1 : first] = 1;
        if (rod || span->tip[e] < 0 || w->twin[span->half[e]] >= 0 || t->desc->edge == YC_EDGE_CUT) continue;
        y->visit_held[e ? v - 1 : first] = 2; /* and the crossing next to it is held */
        for (k = 1; w->nodes[w->visits[span->first + (e ? span->count - k : k - 1)].node].visits < 2;) k++;
        y->visit_held[e ? v - 1 - k : first + k] = 1;
    }
    for (k = first + 1; k + 1 < v && !rod; k++) { /* it turns at rest as it is laid */
        for (e = 0; e < 2; e++) yci_sub(d[e], y->layout[y->visit_node[k + e]], y->layout[y->visit_node[k + e - 1]]);
        yci_cross(cross, d[0], d[1]);
        y->visit_turn[k] = atan2(yci_norm(cross), yci_dot(d[0], d[1]));
    }
}

static yc_result yci_knit_finish(yci_knit_cutter *t, yc_yarns *out) {
    const yci_weaver *w = &t->w;
    yc_yarns y;
    char *block;
    int *number, i, k, tips;
    memset(&y, 0, sizeof y);
    for (i = 0; i < w->node_count; i++) y.node_count += w->nodes[i].visits > 0;
    for (i = 0; i < w->span_count; i++) {
        const yci_weave_span *span = &w->spans[i];
        y.yarn_count += span->count > 0;
        if (span->count) y.visit_count += span->count + (span->tip[0] >= 0) + (span->tip[1] >= 0);
    }
    y.material_count = 1 + (t->desc->rod.density > 0.0), y.contact_count = t->contact_count;
    number = YCI_NEW(w->c, int, yci_max(w->node_count, w->visit_count));
    block = (char *)yci_alloc(w->c, yci_weave_arrays(&y, NULL, 1, YCI_TURNS), 1);
    if (!number || !block) {
        yci_free(w->c, number);
        yci_free(w->c, block);
        return yci_out_of_memory(w->c, "a yarn network");
    }
    yci_weave_arrays(&y, block, 1, YCI_TURNS);
    y.materials[0] = t->desc->yarn, y.materials[0].density *= t->scale;
    if (y.material_count > 1) y.materials[1] = t->desc->rod;
    yci_weave_fill_nodes(w, &y, number);
    for (i = 0, y.yarn_count = 0; i < w->span_count; i++)
        if (w->spans[i].count) yci_knit_fill_yarn(t, &w->spans[i], number, &y);
    for (i = 0, tips = 0; i < w->span_count; i++) { /* from now on numbers of visits */
        const yci_weave_span *span = &w->spans[i];
        if (!span->count) continue;
        tips += span->tip[0] >= 0;
        for (k = span->first; k < span->first + span->count; k++) number[k] = k + tips;
        tips += span->tip[1] >= 0;
    }
    for (i = 0; i < y.contact_count; i++) {
        y.contacts[i] = t->contacts[i];
        for (k = 0; k < 4; k++) y.contacts[i].visit[k / 2][k % 2] = number[t->contacts[i].visit[k / 2][k % 2]];
    }
    yci_free(w->c, number);
    *out = y;
    return YC_OK;
}

static yc_result yci_knit_cut_out(yci_context *c, const yc_knit_desc *desc, yc_yarns *out) {
    yc_weave_desc like; /* what rods look at */
    yci_knit_cutter t;
    yc_result result;
    int piece;
    memset(&t, 0, sizeof t);
    like = yc_weave_desc_default();
    like.spacing[0] = 1.0 / desc->wales, like.spacing[1] = 1.0 / desc->courses, like.rod = desc->rod;
    t.desc = desc, t.w.c = c, t.w.desc = &like, t.w.mesh = desc->mesh;
    t.w.uvt = desc->mesh->uv_triangles ? desc->mesh->uv_triangles : desc->mesh->triangles;
    t.w.turn[0] = cos(desc->grain), t.w.turn[1] = sin(desc->grain);
    result = yci_weave_pieces(&t.w);
    for (piece = 0; piece < t.w.piece_count && result == YC_OK; piece++) result = yci_knit_piece(&t, piece);
    if (result == YC_OK && desc->rod.density > 0.0) result = yci_weave_rods(&t.w);
    if (result == YC_OK) result = yci_knit_finish(&t, out);
    yci_free(c, t.first), yci_free(c, t.members), yci_free(c, t.contacts);
    yci_weave_free(&t.w);
    return result;
}

YC_API yc_result yc_knit(const yc_host *host, const yc_knit_desc *desc, yc_yarns *out, char *message) {
    yci_context c;
    double scale;
    yc_result result = yci_context_init(&c, host);
    if (result == YC_OK && (!desc || !out)) result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "desc and out must not be NULL");
    if (result == YC_OK) result = yci_knit_check(&c, desc);
    if (result == YC_OK) result = desc->mesh ? yci_knit_cut_out(&c, desc, out) : yci_knit_make(&c, desc, out, &scale);
    if (result == YC_OK) memcpy(out->owner, &c, sizeof c);
    return yci_report(&c, result, message);
}

/* =====================================================================================================================
 * >>yarn   (chapter 6)
 *
 * Elements of the persistent-contact yarn model (YARN): pure functions of a few numbers. Each returns its energy in
 * joules, overwrites the gradient g and the full Hessian h (by rows) unless they are NULL, and takes k >= 0 already
 * scaled by its blending weight. `projected` 0 gives the exact second derivative; 1 a positive semidefinite one in
 * closed form, which differs only where the text says so. Notation: du = u_b - u_a > 0 is rest length, l = |x_j - x_i|.
 *
 *   stretch      (1/2) k du (l/du - 1)^2. Projected drops the transverse stiffness of a compressed segment.
 *   gravity      -rho du g.(x_i + x_j)/2. Projected is zero.
 *   bending      k (theta - theta_0)^2 / du + 999 (2k/du) g(theta - pi/2), theta in [0, pi] the turning angle.
 *   shear        (1/2) k L (phi - phi_0)^2 + 999 k L g(|phi - phi_0| - limit), phi in [0, pi] between two edges.
 *   contact      (k/d) g(d - du), the neighbouring crossings of one yarn. Convex: projected is exact.
 *   floor        k d b(du/d), b(t) = -(t - 1)^2 log t below 1, 0 above (C2, convex, without bound at 0): no segment
 *                vanishes between two steps. It acts far below any touching distance. Projected is exact.
 *   friction     (1/2) k s^2 to |s| = limit/k, linear beyond, s = u - anchor (YARN 4.4). Projected is limit/|s| where
 *                it slips, the parabola that touches from above: with the exact zero Newton would overshoot forever.
 *   wrapping     k L (1 - s_p s_q cos(psi - psi_0)), s_p, s_q the sines of two tails' angles to a stitch contact's
 *                axis, psi their dihedral about it, 0 when flat (YARN 4.2, eq. 2, smooth: a polynomial of three unit
 *                vectors, as stiff as the literal (1/2) k L (psi - psi_0)^2 where both tails stand across the axis;
 *                that is the hinge of chapter triangle, undefined where a tail lies in the axis). With p, q the parts
 *                of the tails across it, q turned by psi_0 about it, it is k L/2 (|p - q|^2 + (tail.axis)^2 of both);
 *                projected is the Gauss-Newton form of that, exact at rest.
 *   length       (1/2) k L (du/L - 1)^2, of the yarn in a stitch contact (YARN 4.5). Convex: projected is exact.
 *   turning      the friction law of phi in place of u, k in N m, limit = mu lambda (2/3) rho: the moment of a pressure
 *                lambda spread evenly over a disc of radius rho. Part of shear; f'' is the projected one always.
 * With crimp u is the true length of a yarn that passes its nodes at heights y, and
 *   stretch      is the same with l^2 = |x_j - x_i|^2 + kappa (y_b - y_a)^2, a distance in four dimensions, kappa = 9/8
 *                (Peirce 1937, see chapter fabric).
 *   kink         k (t - t_0)^2 / (du_- + du_+), t = (y_b - y_a)/du_- - (y_c - y_b)/du_+ the difference of the slopes.
 *                Projected keeps the positive part of f' hess t on either side; it is exact where t = t_0.
 *   flattening   (1/2) k d^2 (1 + (d/D)^2 / 2), d = rest - (y_high - y_low) what both yarns of a crossing are thinner
 *                by than at rest, so that they press by k d (1 + (d/D)^2): the curve of compression of Kawabata's
 *                theory (1973). Convex: projected is exact.
 *
 * The energies of an angle f(phi) share one Hessian. With unit edges a, b of lengths l1, l2, in-plane normals n1 (of a,
 * towards b) and n2 (of b, towards a) and the binormal m, grad phi = (-n1/l1, -n2/l2) and
 *   hess phi = sym(a n1^T)/l1^2 + sym(b n2^T)/l2^2 + (m m^T) (x) [cot/l1^2, -csc/(l1 l2); -csc/(l1 l2), cot/l2^2],
 * sym(X) = X + X^T. The last bracket is (cot(phi/2) v v^T - tan(phi/2) w w^T)/2, v = (1/l1, -1/l2), w = (1/l1, 1/l2).
 * Projected keeps f'' grad grad^T and those of f' cot(phi/2), -f' tan(phi/2) that are positive; it is exact where
 * f' = 0. Bending divides by du, and F(theta)/du is jointly convex in theta and du for every term above, so the rows of
 * u are exact in its projected form.
 * Within 1e-8 of a straight or folded pair the plane is fixed by rule and f' cot(phi/2) takes its smooth limit 2 f'',
 * which is exact for f'(0) = 0. Edges shorter than a nanometre count as that long in derivatives: nothing is NaN.
 *
 * Stiffness damping: each elastic element has a strain s (the _strain functions) and adds (1/2) E'' r (s - s_prev)^2,
 * E'' the stiffness by s without jamming, r = beta/h (0: off), s_prev the strain at the step's start. Strains are
 * invariant, so rigid motion is undamped exactly. The turning angle has no sign: a node that snaps through straight to
 * the mirrored bend is not damped.
 *
 * Compression (YARN 4.3, eq. 3): the force of each yarn at a crossing comes from its own stretch and bending with the
 * nodes offset along the contact normals (crimp); the tensions are the true ones, the directions those of the offset
 * polyline. For two yarns the non-negative least squares of f_low - lambda = 0, f_high + lambda = 0 has a closed form.
 * ===================================================================================================================== */

#define YCI_YARN_SHORTEST 1e-9 /* metres */
#define YCI_YARN_JAM 999.0     /* a jammed angle is three orders of magnitude stiffer */

/* -- stretch: q = (x_i, x_j, u_a, u_b) ----------------------------------------------------------------------------- */

YC_FN double yci_yarn_stretch_strain(const double *q) {
    double d[3];
    yci_sub(d, q + 3, q);
    return yci_norm(d) / (q[7] - q[6]) - 1.0;
}

/* The tension after the step dq, by the linear model. */
YC_FN double yci_yarn_stretch_predict(const double *q, const double *dq, double k, double r, double s_prev) {
    double d[3], e[3], du = q[7] - q[6], l, s, rate;
    yci_sub(d, q + 3, q), yci_sub(e, dq + 3, dq);
    l = yci_norm(d);
    s = l / du - 1.0;
    rate = (yci_dot(d, e) / yci_max(l, YCI_YARN_SHORTEST) - (s + 1.0) * (dq[7] - dq[6])) / du;
    return k * (s + rate + r * (s + rate - s_prev));
}

/* The strain that a tension stands for, above that of a segment without length; tension NULL: the state's, s. */
YC_FN double yci_yarn_stretch_mixed(double s, double k, double r, double s_prev, const double *tension) {
    return tension ? yci_max((*tension / k + r * s_prev) / (1.0 + r), -0.9) : s;
}

/* With a tension and h, g and h are those of Newton's method with a tension of its own (see chapter scene): the tension
 * in the transverse stiffness, its strain where rest length enters. */
YC_FN double yci_yarn_stretch(
    const double *q, double k, double r, double s_prev, const double *tension, double *g, double *h, int projected) {
    double x_axis[3] = {1.0, 0.0, 0.0}, t[3], du = q[7] - q[6], l, s, rate, density, slope, mixed, lag;
    yci_sub(t, q + 3, q);
    l = yci_normalize(t, x_axis);
    s = l / du - 1.0, rate = s - s_prev;
    density = 0.5 * k * (s * s + r * rate * rate);
    slope = k * (s + r * rate);
    mixed = yci_yarn_stretch_mixed(s, k, r, s_prev, h ? tension : NULL), lag = mixed - s_prev;
    if (g) {
        yci_scale(g, t, -slope), yci_scale(g + 3, t, slope);
        g[7] = 0.5 * k * (mixed * mixed + r * lag * lag) - (mixed + 1.0) * slope, g[6] = -g[7];
    }
    if (h) {
        /* Along the yarn the strain is l/du: its Hessian is a rank-one form in (dl, d du) plus the transverse part. */
        double along = k * (1.0 + r) / du, across = (tension ? *tension : slope) / yci_max(l, YCI_YARN_SHORTEST), v[8];
        if (projected) across = yci_max(across, 0.0);
        yci_scale(v, t, -1.0), yci_copy(v + 3, t);
        v[6] = mixed + 1.0, v[7] = -v[6];
        for (int i = 0; i < 8; i++) {
            for (int j = 0; j < 8; j++) h[8 * i + j] = along * v[i] * v[j];
        }
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                double p = across * ((i == j ? 1.0 : 0.0) - t[i] * t[j]);
                h[8 * i + j] += p, h[8 * (i + 3) + j + 3] += p;
                h[8 * i + j + 3] -= p, h[8 * (i + 3) + j] -= p;
            }
        }
    }
    return du * density;
}

/* -- stretch with crimp: q = (x_i, x_j, u_a, u_b, y_a, y_b) -------------------------------------------------------- */

/* The unit vector in four dimensions from one visit to the next; returns their distance. */
YC_FN double yci_yarn_crimp_direction(double *t, const double *q) {
    double l;
    yci_sub(t, q + 3, q);
    t[3] = sqrt(YCI_CRIMP_KAPPA) * (q[9] - q[8]);
    l = sqrt(yci_dot(t, t) + t[3] * t[3]);
    for (int i = 0; i < 4; i++) t[i] = l > 1e-150 ? t[i] / l : i == 0;
    return l;
}

YC_FN double yci_yarn_crimp_strain(const double *q) {
    double t[4];
    return yci_yarn_crimp_direction(t, q) / (q[7] - q[6]) - 1.0;
}

/* The tension after the step dq, by the linear model. */
YC_FN double yci_yarn_crimp_predict(const double *q, const double *dq, double k, double r, double s_prev) {
    double t[4], e[3], du = q[7] - q[6], s = yci_yarn_crimp_direction(t, q) / du - 1.0, rate;
    yci_sub(e, dq + 3, dq);
    rate = (yci_dot(t, e) + sqrt(YCI_CRIMP_KAPPA) * t[3] * (dq[9] - dq[8]) - (s + 1.0) * (dq[7] - dq[6])) / du;
    return k * (s + rate + r * (s + rate - s_prev));
}

YC_FN double yci_yarn_crimp(
    const double *q, double k, double r, double s_prev, const double *tension, double *g, double *h, int projected) {
    double t[4], v[10], du = q[7] - q[6], l = yci_yarn_crimp_direction(t, q);
    double s = l / du - 1.0, rate = s - s_prev, density = 0.5 * k * (s * s + r * rate * rate), slope, mixed, lag;
    slope = k * (s + r * rate);
    mixed = yci_yarn_stretch_mixed(s, k, r, s_prev, h ? tension : NULL), lag = mixed - s_prev;
    yci_scale(v, t, -1.0), yci_copy(v + 3, t); /* the gradient of l; of u further down */
    v[6] = v[7] = 0.0;
    v[9] = sqrt(YCI_CRIMP_KAPPA) * t[3], v[8] = -v[9];
    if (g) {
        for (int i = 0; i < 10; i++) g[i] = slope * v[i];
        g[7] = 0.5 * k * (mixed * mixed + r * lag * lag) - (mixed + 1.0) * slope, g[6] = -g[7];
    }
    if (h) {
        double along = k * (1.0 + r) / du, across = (tension ? *tension : slope) / yci_max(l, YCI_YARN_SHORTEST);
        if (projected) across = yci_max(across, 0.0);
        for (int i = 0; i < 10; i++) {
            for (int j = 0; j < 10; j++) h[10 * i + j] = (along - across) * v[i] * v[j];
        }
        for (int i = 0; i < 3; i++) {
            h[11 * i] += across, h[11 * (i + 3)] += across;
            h[10 * i + i + 3] -= across, h[10 * (i + 3) + i] -= across;
        }
        h[88] += across * YCI_CRIMP_KAPPA, h[99] += across * YCI_CRIMP_KAPPA;
        h[89] -= across * YCI_CRIMP_KAPPA, h[98] -= across * YCI_CRIMP_KAPPA;
        for (int i = 0; i < 10; i++) {
            double c = along * (mixed + 1.0) * v[i];
            h[10 * i + 6] += c, h[60 + i] += c;
            h[10 * i + 7] -= c, h[70 + i] -= c;
        }
        slope = along * (mixed + 1.0) * (mixed + 1.0);
        h[66] += slope, h[77] += slope, h[67] -= slope, h[76] -= slope;
    }
    return du * density;
}

/* -- kink of a crimped yarn: q = (y_a, y_b, y_c, u_a, u_b, u_c) ---------------------------------------------------- */

/* The stiffness of a beam over its crossings, as a multiple of EI, from the kinks t at rest: the three-moment equation
 * M_a + 4 M_b + M_c = 6 EI t_b/du, with M in proportion to t, gives M_b = f EI t_b/du and an energy (1/2) M_b t_b. 3
 * where kinks alternate, 3/2 where one stands alone, 1 in a long wave and where there is none. */
YC_FN double yci_yarn_kink_factor(double before, double here, double after) {
    if (fabs(here) <= 1e-9 * (fabs(before) + fabs(after))) return 1.0;
    return 6.0 / yci_clamp(4.0 + (before + after) / here, 2.0, 6.0);
}

YC_FN double yci_yarn_kink_strain(const double *q) {
    return (q[1] - q[0]) / (q[4] - q[3]) - (q[2] - q[1]) / (q[5] - q[4]);
}

YC_FN double yci_yarn_kink(
    const double *q, double k, double t_0, double r, double t_prev, double *g, double *h, int projected) {
    double a = 1.0 / (q[4] - q[3]), b = 1.0 / (q[5] - q[4]), du = q[5] - q[3];
    double before = (q[1] - q[0]) * a, after = (q[2] - q[1]) * b, t = before - after; /* slopes */
    double s = t - t_0, rate = t - t_prev, f = k * (s * s + r * rate * rate), df = 2.0 * k * (s + r * rate);
    double v[6]; /* the gradient of t */
    v[0] = -a, v[1] = a + b, v[2] = -b;
    v[3] = before * a, v[5] = after * b, v[4] = -v[3] - v[5];
    if (g) {
        for (int i = 0; i < 6; i++) g[i] = df / du * v[i];
        g[3] += f / (du * du), g[5] -= f / (du * du);
    }
    if (h) {
        double cross = df / (du * du), end = 2.0 * f / (du * du * du);
        for (int i = 0; i < 6; i++) {
            for (int j = 0; j < 6; j++) h[6 * i + j] = 2.0 * k * (1.0 + r) / du * v[i] * v[j];
        }
        for (int i = 0; i < 6; i++) {
            h[6 * i + 3] += cross * v[i], h[18 + i] += cross * v[i];
            h[6 * i + 5] -= cross * v[i], h[30 + i] -= cross * v[i];
        }
        h[21] += end, h[35] += end, h[23] -= end, h[33] -= end;
        /* f' hess t: that of a slope dy/du is [0, -1; -1, 2 slope]/du^2, its positive part in closed form. */
        for (int side = 0; side < 2; side++) {
            double inverse = side ? b : a, slope = side ? after : before, sign = side == (df > 0.0) ? -1.0 : 1.0;
            double c = fabs(df) / du * inverse * inverse, m11 = 0.0, m12 = -sign * c, m22 = 2.0 * sign * slope * c;
            if (projected) {
                double root = sign * slope + sqrt(slope * slope + 1.0);
                m11 = c * root / (1.0 + root * root), m12 = -sign * root * m11, m22 = root * root * m11;
            }
            for (int i = 0; i < 4; i++) {
                int row = side + i / 2, column = side + i % 2;
                double same = i % 3 ? -1.0 : 1.0;
                h[6 * row + column] += same * m11, h[6 * (row + 3) + column + 3] += same * m22;
                h[6 * row + column + 3] += same * m12, h[6 * (row + 3) + column] += same * m12;
            }
        }
    }
    return f / du;
}

/* -- flattening at a crossing: q = (y_low, y_high) ----------------------------------------------------------------- */

YC_FN double yci_yarn_flatten_strain(const double *q, double rest) { return rest - (q[1] - q[0]); }

YC_FN double yci_yarn_flatten(
    const double *q, double k, double rest, double depth, double r, double s_prev, double *g, double *h) {
    double s = yci_yarn_flatten_strain(q, rest), rate = s - s_prev, t = s / depth * (s / depth);
    if (g) g[0] = k * (s * (1.0 + t) + r * rate), g[1] = -g[0];
    if (h) h[0] = h[3] = k * (1.0 + 3.0 * t + r), h[1] = h[2] = -h[0];
    return 0.5 * k * (s * s * (1.0 + 0.5 * t) + r * rate * rate);
}

/* -- gravity: q = (x_i, x_j, u_a, u_b), rho in kg/m ---------------------------------------------------------------- */

YC_FN double yci_yarn_gravity(const double *q, double rho, const double *gravity, double *g, double *h, int projected) {
    double du = q[7] - q[6];
    double potential = -0.5 * rho * (yci_dot(gravity, q) + yci_dot(gravity, q + 3)); /* per length */
    if (g) {
        yci_scale(g, gravity, -0.5 * rho * du), yci_copy(g + 3, g);
        g[6] = -potential, g[7] = potential;
    }
    if (h) {
        yci_zero(h, 64);
        for (int i = 0; i < 6 && !projected; i++) {
            double c = -0.5 * rho * gravity[i % 3];
            h[8 * i + 7] = h[56 + i] = c;
            h[8 * i + 6] = h[48 + i] = -c;
        }
    }
    return du * potential;
}

/* -- the angle between two edges ----------------------------------------------------------------------------------- */

typedef struct yci_yarn_angle {
    double phi, tan_half;      /* in [0, pi]; tan(phi/2), meaningless at pi */
    double l1, l2;             /* lengths, floored */
    double a[3], b[3];         /* unit edges */
    double n1[3], n2[3], m[3]; /* in-plane normals of a towards b and of b towards a; binormal */
} yci_yarn_angle;

YC_FN void yci_yarn_angle_make(yci_yarn_angle *angle, const double *e1, const double *e2) {
    double x_axis[3] = {1.0, 0.0, 0.0}, fallback[3], sine, cosine;
    yci_copy(angle->a, e1), yci_copy(angle->b, e2);
    angle->l1 = yci_max(yci_normalize(angle->a, x_axis), YCI_YARN_SHORTEST);
    angle->l2 = yci_max(yci_normalize(angle->b, angle->a), YCI_YARN_SHORTEST);
    /* Rounding takes the cross product of nearly parallel vectors out of the normal plane: project it back. */
    yci_cross(angle->m, angle->a, angle->b);
    yci_axpy(angle->m, -yci_dot(angle->m, angle->a), angle->a);
    cosine = yci_dot(angle->a, angle->b);
    sine = yci_norm(angle->m);
    angle->phi = atan2(sine, cosine);
    angle->tan_half = cosine > 0.0 ? sine / (1.0 + cosine) : (1.0 - cosine) / yci_max(sine, 1e-150);
    /* Below 1e-12 it is nothing but rounding and has no direction. */
    if (sine > 1e-12) yci_scale(angle->m, angle->m, 1.0 / sine);
    else yci_perpendicular(fallback, angle->a), yci_copy(angle->m, fallback);
    yci_cross(angle->n1, angle->m, angle->a);
    yci_cross(angle->n2, angle->b, angle->m);
}

/* Gradient and Hessian of f(phi) over three nodes, edge i being the sum of c_i[p] x_p. Either may be NULL; the Hessian
 * fills the first nine rows and columns of an n x n matrix. */
YC_FN void yci_yarn_angle_derivatives(const yci_yarn_angle *angle, const double *c1, const double *c2, double df,
    double ddf, double *g, double *h, int n, int projected) {
    const double *a = angle->a, *b = angle->b, *n1 = angle->n1, *n2 = angle->n2, *m = angle->m;
    double i1 = 1.0 / angle->l1, i2 = 1.0 / angle->l2;
    double opening, closing, turning = projected ? 0.0 : df, m11, m12, m22, h11[9], h12[9], h22[9];
    if (g) {
        for (int p = 0; p < 3; p++) {
            for (int i = 0; i < 3; i++) g[3 * p + i] = -df * (c1[p] * i1 * n1[i] + c2[p] * i2 * n2[i]);
        }
    }
    if (!h) return;
    opening = angle->phi > 1e-8 ? df / angle->tan_half : 2.0 * ddf;
    closing = YCI_PI - angle->phi > 1e-8 ? -df * angle->tan_half : 2.0 * ddf;
    if (projected) opening = yci_max(opening, 0.0), closing = yci_max(closing, 0.0);
    m11 = 0.5 * (opening + closing) * i1 * i1;
    m12 = 0.5 * (closing - opening) * i1 * i2;
    m22 = 0.5 * (opening + closing) * i2 * i2;
    for (int k = 0; k < 9; k++) {
        int i = k / 3, j = k % 3;
        double mm = m[i] * m[j];
        h11[k] = m11 * mm + i1 * i1 * (ddf * n1[i] * n1[j] + turning * (a[i] * n1[j] + n1[i] * a[j]));
        h12[k] = m12 * mm + i1 * i2 * ddf * n1[i] * n2[j];
        h22[k] = m22 * mm + i2 * i2 * (ddf * n2[i] * n2[j] + turning * (b[i] * n2[j] + n2[i] * b[j]));
    }
    for (int p = 0; p < 3; p++) {
        for (int q = 0; q < 3; q++) {
            double w11 = c1[p] * c1[q], w12 = c1[p] * c2[q], w21 = c2[p] * c1[q], w22 = c2[p] * c2[q];
            double *block = h + 3 * (n * p + q);
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++) {
                    block[n * i + j] =
                        w11 * h11[3 * i + j] + w12 * h12[3 * i + j] + w21 * h12[3 * j + i] + w22 * h22[3 * i + j];
                }
            }
        }
    }
}

/* -- bending: q = (x_a, x_b, x_c, u_a, u_c), jam the width in radians over which jamming sets in, 0 for none ------- */

YC_FN double yci_yarn_bend_strain(const double *q) {
    double e1[3], e2[3], m[3];
    yci_sub(e1, q + 3, q), yci_sub(e2, q + 6, q + 3);
    yci_cross(m, e1, e2);
    return atan2(yci_norm(m), yci_dot(e1, e2));
}

YC_FN double yci_yarn_bend(const double *q, double k, double theta_0, double jam, double r, double s_prev, double *g,
    double *h, int projected) {
    double c1[3] = {-1.0, 1.0, 0.0}, c2[3] = {0.0, -1.0, 1.0}, e1[3], e2[3], du = q[10] - q[9], f, df, ddf, s, rate;
    yci_yarn_angle angle;
    yci_sub(e1, q + 3, q), yci_sub(e2, q + 6, q + 3);
    yci_yarn_angle_make(&angle, e1, e2);
    s = angle.phi - theta_0, rate = angle.phi - s_prev;
    f = k * (s * s + r * rate * rate);
    df = 2.0 * k * (s + r * rate);
    ddf = 2.0 * k * (1.0 + r);
    if (jam > 0.0) {
        double j, dj, ddj;
        yci_one_sided(angle.phi - 0.5 * YCI_PI, jam, &j, &dj, &ddj);
        f += 2.0 * YCI_YARN_JAM * k * j;
        df += 2.0 * YCI_YARN_JAM * k * dj;
        ddf += 2.0 * YCI_YARN_JAM * k * ddj;
    }
    if (g || h) {
        double slope[9];
        yci_yarn_angle_derivatives(&angle, c1, c2, df / du, ddf / du, slope, h, 11, projected);
        if (g) {
            for (int i = 0; i < 9; i++) g[i] = slope[i];
            g[9] = f / (du * du), g[10] = -g[9];
        }
        if (h) {
            for (int i = 0; i < 9; i++) {
                h[11 * i + 9] = h[99 + i] = slope[i] / du;
                h[11 * i + 10] = h[110 + i] = -h[99 + i];
            }
            h[108] = h[120] = 2.0 * f / (du * du * du);
            h[109] = h[119] = -h[108];
        }
    }
    return f / du;
}

/* -- sliding friction of one visit: k in N/m, limit = mu lambda in N ----------------------------------------------- */

YC_FN double yci_yarn_friction(double u, double anchor, double k, double limit, double *g, double *h, int projected) {
    double s = u - anchor;
    int slips = k * fabs(s) > limit;
    if (g) *g = !slips ? k * s : s < 0.0 ? -limit : limit;
    if (h) *h = !slips ? k : projected ? limit / fabs(s) : 0.0;
    return slips ? limit * (fabs(s) - 0.5 * limit / k) : 0.5 * k * s * s;
}

/* The share of its limit, -1 to 1, that friction has after the step du, by the linear model in which share and s are
 * unknowns of their own, share |s| = s where it slips (Chan, Golub and Mulet 1999); `share` is that before. */
YC_FN double yci_yarn_friction_predict(double u, double anchor, double du, double k, double limit, double share) {
    double s = u - anchor, sign = s < 0.0 ? -1.0 : 1.0;
    if (limit <= 0.0) return 0.0;
    if (k * fabs(s) <= limit) return yci_clamp(k * (s + du) / limit, -1.0, 1.0);
    return yci_clamp(sign + (1.0 - share * sign) / fabs(s) * du, -1.0, 1.0);
}

/* The factor on the projected second derivative that belongs to a share: 1 at 0. */
YC_FN double yci_yarn_friction_factor(double u, double anchor, double k, double limit, double share) {
    double s = u - anchor;
    return k * fabs(s) <= limit ? 1.0 : 1.0 - (s < 0.0 ? -share : share);
}

/* The anchor after an accepted step: it follows a slipping yarn so that |u - anchor| <= limit/k. */
YC_FN double yci_yarn_friction_anchor(double u, double anchor, double k, double limit) {
    if (k * fabs(u - anchor) <= limit) return anchor;
    return u < anchor ? u + limit / k : u - limit / k;
}

/* -- shear: q = (x_i, x_j, x_k), the edges x_j - x_i and x_k - x_i; jam as above, from `limit` on ------------------ */

YC_FN double yci_yarn_shear_strain(const double *q) {
    double e1[3], e2[3], m[3];
    yci_sub(e1, q + 3, q), yci_sub(e2, q + 6, q);
    yci_cross(m, e1, e2);
    return atan2(yci_norm(m), yci_dot(e1, e2));
}

/* Friction of turning: that of phi in place of u, its anchor an angle from phi_0. */
typedef struct yci_yarn_turn {
    double anchor, k, limit; /* of the friction */
} yci_yarn_turn;

/* `turn` may be NULL. Its second derivative is the projected one always. */
YC_FN double yci_yarn_shear(const double *q, double k, double length, double phi_0, double limit, double jam, double r,
    double s_prev, const yci_yarn_turn *turn, double *g, double *h, int projected) {
    double c1[3] = {-1.0, 1.0, 0.0}, c2[3] = {-1.0, 0.0, 1.0}, e1[3], e2[3], f, df, ddf, s, rate;
    yci_yarn_angle angle;
    yci_sub(e1, q + 3, q), yci_sub(e2, q + 6, q);
    yci_yarn_angle_make(&angle, e1, e2);
    s = angle.phi - phi_0, rate = angle.phi - s_prev;
    f = 0.5 * k * length * (s * s + r * rate * rate);
    df = k * length * (s + r * rate);
    ddf = k * length * (1.0 + r);
    if (jam > 0.0) {
        double j, dj, ddj;
        yci_one_sided(fabs(s) - limit, jam, &j, &dj, &ddj);
        f += YCI_YARN_JAM * k * length * j;
        df += YCI_YARN_JAM * k * length * (s < 0.0 ? -dj : dj);
        ddf += YCI_YARN_JAM * k * length * ddj;
    }
    if (turn) {
        double dt, ddt;
        f += yci_yarn_friction(s, turn->anchor, turn->k, turn->limit, &dt, &ddt, 1);
        df += dt, ddf += ddt;
    }
    if (g || h) yci_yarn_angle_derivatives(&angle, c1, c2, df, ddf, g, h, 9, projected);
    return f;
}

/* -- adjacent contact: q = (u_a, u_b), d the touching distance ----------------------------------------------------- */

/* The law turns quadratic a tenth of d after touching: at the touching distance it has no force and no stiffness. */
YC_FN double yci_yarn_contact(const double *q, double k, double d, double *g, double *h) {
    double f, df, ddf;
    yci_one_sided(d - (q[1] - q[0]), 0.1 * d, &f, &df, &ddf);
    if (g) g[0] = k / d * df, g[1] = -g[0];
    if (h) h[0] = h[3] = k / d * ddf, h[1] = h[2] = -h[0];
    return k / d * f;
}

/* -- floor: q = (u_a, u_b); infinite when the segment has no length left ----------------------------------------- */

YC_FN double yci_yarn_floor(const double *q, double k, double d, double *g, double *h) {
    double t = (q[1] - q[0]) / d, e = t - 1.0, df, ddf, logarithm;
    if (g) g[0] = g[1] = 0.0;
    if (h) h[0] = h[1] = h[2] = h[3] = 0.0;
    if (t >= 1.0) return 0.0;
    if (t <= 0.0) return HUGE_VAL;
    logarithm = log(t);
    df = -2.0 * e * logarithm - e * e / t;
    ddf = -2.0 * logarithm - 4.0 * e / t + e * e / (t * t);
    if (g) g[1] = k * df, g[0] = -g[1];
    if (h) h[0] = h[3] = k / d * ddf, h[1] = h[2] = -h[0];
    return -k * d * e * e * logarithm;
}

/* -- length of a stitch contact: q = (u_a, u_b), at rest `length` ---------------------------------------------------- */

YC_FN double yci_yarn_length(const double *q, double k, double length, double *g, double *h) {
    double s = (q[1] - q[0]) / length - 1.0;
    if (g) g[1] = k * s, g[0] = -g[1];
    if (h) h[0] = h[3] = k / length, h[1] = h[2] = -h[0];
    return 0.5 * k * length * s * s;
}

/* -- wrapping of a stitch contact: q = (x_a, x_b, x_p, x_q), its nodes and the far ends of the tails there ---------- */

/* m += c I + s [v]x + d x y^T */
YC_FN void yci_yarn_wrap_term(
    double *m, double c, double s, const double *v, double d, const double *x, const double *y) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        m[4 * i] += c, m[3 * i + j] -= s * v[k], m[3 * j + i] += s * v[k];
        yci_axpy(m + 3 * i, d * x[i], y);
    }
}

/* The second derivatives by the three unit vectors, over k, of which those with i <= j are set; `fall` are the
 * derivatives along the vectors. */
YC_FN void yci_yarn_wrap_blocks(
    double (*m)[3][9], double (*unit)[3], double c, double s, const double *fall, int projected) {
    const double *e = unit[0], *a = unit[1], *b = unit[2];
    double alpha = yci_dot(a, e), beta = yci_dot(b, e), r[3][9];
    yci_zero(&m[0][0][0], 81), yci_zero(&r[0][0], 27);
    if (!projected) {
        for (int i = 0; i < 3; i++) yci_yarn_wrap_term(m[i][i], -fall[i], 0.0, e, 0.0, e, e);
        yci_yarn_wrap_term(m[0][0], 0.0, 0.0, e, -c, a, b), yci_yarn_wrap_term(m[0][0], 0.0, 0.0, e, -c, b, a);
        yci_yarn_wrap_term(m[0][1], -c * beta, s, b, -c, b, e);
        yci_yarn_wrap_term(m[0][2], -c * alpha, -s, a, -c, a, e);
        yci_yarn_wrap_term(m[1][2], c, s, e, -c, e, e);
        return;
    }
    yci_yarn_wrap_term(r[0], -alpha - c * beta, -s, b, -1.0, e, a), yci_yarn_wrap_term(r[0], 0.0, 0.0, e, -c, e, b);
    yci_yarn_wrap_term(r[1], 1.0, 0.0, e, -1.0, e, e);
    yci_yarn_wrap_term(r[2], c, s, e, -c, e, e);
    for (int i = 0; i < 3; i++) {
        for (int j = i; j < 3; j++) {
            if (i < 2 && j < 2) yci_yarn_wrap_term(m[i][j], 0.0, 0.0, e, 1.0, i ? e : a, j ? e : a);
            if (i != 1 && j != 1) yci_yarn_wrap_term(m[i][j], 0.0, 0.0, e, 1.0, i ? e : b, j ? e : b);
            for (int p = 0; p < 3; p++) yci_yarn_wrap_term(m[i][j], 0.0, 0.0, e, 1.0, r[i] + 3 * p, r[j] + 3 * p);
        }
    }
}

/* k = k_w L */
YC_FN double yci_yarn_wrap(const double *q, double k, double psi_0, double *g, double *h, int projected) {
    static const int from[3] = {0, 0, 1}, to[3] = {1, 2, 3};
    double x_axis[3] = {1.0, 0.0, 0.0}, unit[3][3], inverse[3], slope[3][3], fall[3], m[3][3][9], gap[3];
    double c = cos(psi_0), s = sin(psi_0), alpha, beta, *e = unit[0], *a = unit[1], *b = unit[2];
    for (int i = 0; i < 3; i++) {
        yci_sub(unit[i], q + 3 * to[i], q + 3 * from[i]);
        inverse[i] = 1.0 / yci_max(yci_normalize(unit[i], x_axis), YCI_YARN_SHORTEST);
    }
    alpha = yci_dot(a, e), beta = yci_dot(b, e);
    yci_cross(slope[0], a, b), yci_scale(slope[0], slope[0], -s), yci_axpy(slope[0], -c * beta, a);
    yci_axpy(slope[0], -c * alpha, b);
    yci_cross(slope[1], e, b), yci_scale(slope[1], slope[1], s), yci_axpy(slope[1], c, b);
    yci_axpy(slope[1], -c * beta, e);
    yci_cross(slope[2], a, e), yci_scale(slope[2], slope[2], s), yci_axpy(slope[2], c, a);
    yci_axpy(slope[2], -c * alpha, e);
    yci_copy(gap, a), yci_axpy(gap, -alpha, e), yci_add(gap, gap, slope[1]);
    for (int i = 0; i < 3; i++) fall[i] = yci_dot(slope[i], unit[i]), yci_axpy(slope[i], -fall[i], unit[i]);
    if (g) yci_zero(g, 12);
    for (int i = 0; i < 3 && g; i++) {
        yci_axpy(g + 3 * to[i], k * inverse[i], slope[i]), yci_axpy(g + 3 * from[i], -k * inverse[i], slope[i]);
    }
    if (h) {
        yci_zero(h, 144);
        yci_yarn_wrap_blocks(m, unit, c, s, fall, projected);
    }
    for (int p = 0; p < 9 && h; p++) {
        int i = yci_min_int(p / 3, p % 3), j = p / 3 + p % 3 - i;
        double scale = k * inverse[i] * inverse[j], *block = m[i][j];
        if (i == p / 3) { /* tangential to both, and the turn of a vector's own length */
            for (int x = 0; x < 3; x++) yci_axpy(block + 3 * x, -yci_dot(block + 3 * x, unit[j]), unit[j]);
            for (int y = 0; y < 3; y++) {
                double along = unit[i][0] * block[y] + unit[i][1] * block[3 + y] + unit[i][2] * block[6 + y];
                for (int x = 0; x < 3; x++) block[3 * x + y] -= along * unit[i][x];
            }
            if (i == j && !projected) {
                yci_yarn_wrap_term(block, 0.0, 0.0, e, -1.0, unit[i], slope[i]);
                yci_yarn_wrap_term(block, 0.0, 0.0, e, -1.0, slope[i], unit[i]);
            }
        }
        for (int z = 0; z < 36; z++) {
            int x = z / 3 % 3, y = z % 3, row = z / 18 ? to[p / 3] : from[p / 3],
                column = z / 9 % 2 ? to[p % 3] : from[p % 3];
            double v = scale * (i == p / 3 ? block[3 * x + y] : block[3 * y + x]);
            h[12 * (3 * row + x) + 3 * column + y] += z / 18 == z / 9 % 2 ? v : -v;
        }
    }
    return 0.5 * k * (yci_dot(gap, gap) + alpha * alpha + beta * beta);
}

/* -- compression --------------------------------------------------------------------------------------------------- */

/* Force in N of one yarn on its offset centre line at the middle one of five visits: tension of the two segments there
 * and the three turns that move with it, with their rest angles. A visit is x[3], offset[3] (contact normal times
 * radius times layer), u; NULL beyond a yarn's end. */
YC_FN void yci_yarn_crossing_force(
    double *force, const double *const visit[5], double k_stretch, double k_bend, const double *theta_0) {
    const double *here = visit[2];
    double q[11], g[11], nowhere[3] = {0.0, 0.0, 0.0};
    yci_zero(force, 3);
    for (int side = 1; side < 4; side += 2) {
        const double *other = visit[side];
        double d[3], tension;
        if (!other) continue;
        yci_sub(d, other, here);
        tension = k_stretch * (yci_norm(d) / fabs(other[6] - here[6]) - 1.0);
        yci_axpy(d, 1.0, other + 3), yci_axpy(d, -1.0, here + 3);
        yci_normalize(d, nowhere);
        yci_axpy(force, tension, d);
    }
    for (int turn = 1; turn < 4; turn++) {
        if (!visit[turn - 1] || !visit[turn] || !visit[turn + 1]) continue;
        for (int i = 0; i < 3; i++) yci_add(q + 3 * i, visit[turn - 1 + i], visit[turn - 1 + i] + 3);
        q[9] = visit[turn - 1][6], q[10] = visit[turn + 1][6];
        yci_yarn_bend(q, k_bend, theta_0[turn - 1], 0.0, 0.0, 0.0, g, NULL, 0);
        yci_axpy(force, -1.0, g + 3 * (3 - turn));
    }
}

/* Compression lambda >= 0 in N of two yarns under these forces, the unit normal n pointing from low to high. */
YC_FN double yci_yarn_compression(const double *low, const double *high, const double *n) {
    return yci_max(0.0, 0.5 * (yci_dot(low, n) - yci_dot(high, n)));
}

/* The same for a stack of n yarns, low to high, n - 1 contacts with normals n_i from yarn i to i + 1 (YARN 4.3, eq. 3):
 * with load_i = u_i.F_i, below_i = u_i.n_(i-1), above_i = u_i.n_i, u_i the mean of a yarn's normals, lambda >= 0
 * minimises the sum of (load_i + below_i lambda_(i-1) - above_i lambda_i)^2. Its normal matrix is tridiagonal, positive
 * definite and has no positive entry beside the diagonal, so that the set of pressed contacts only grows: those that
 * stick at lambda = 0 are added until none is left (Chandrasekaran 1970). Exact after n - 1 rounds at most; the closed
 * form of YARN (4) is that for two yarns alone. */
#define YCI_STACK 8 /* yarns at most */

YC_FN void yci_yarn_stack_compression(
    double *lambda, int n, const double *load, const double *below, const double *above) {
    double pivot[YCI_STACK] = {0.0}, side[YCI_STACK] = {0.0};
    int pressed[YCI_STACK] = {0}, grown = 1;
    yci_zero(lambda, n - 1);
    while (grown) {
        grown = 0;
        for (int i = 0; i + 1 < n; i++) { /* equilibrium of contact i, all others as they are */
            double slack =
                above[i] * (load[i] - above[i] * lambda[i]) - below[i + 1] * (load[i + 1] + below[i + 1] * lambda[i]);
            if (i > 0) slack += above[i] * below[i] * lambda[i - 1];
            if (i + 2 < n) slack += below[i + 1] * above[i + 1] * lambda[i + 1];
            if (!pressed[i] && slack > 0.0) pressed[i] = grown = 1;
        }
        for (int i = 0; i + 1 < n && grown; i++) { /* elimination, then back */
            double beside = i > 0 && pressed[i - 1] ? -below[i] * above[i] / pivot[i - 1] : 0.0;
            pivot[i] = above[i] * above[i] + below[i + 1] * below[i + 1],
            side[i] = above[i] * load[i] - below[i + 1] * load[i + 1];
            if (beside != 0.0) pivot[i] += beside * below[i] * above[i], side[i] -= beside * side[i - 1];
        }
        for (int i = n - 2; i >= 0 && grown; i--) {
            double after = i + 2 < n ? below[i + 1] * above[i + 1] * lambda[i + 1] : 0.0;
            lambda[i] = pressed[i] ? (side[i] + after) / pivot[i] : 0.0;
        }
    }
}

/* -- kinetic ------------------------------------------------------------------------------------------------------- */

/* Lumped, not consistent (a sixth of the segment's mass between its nodes): the frequencies of waves of n segments come
 * out low by (pi / n)^2 / 6 with it and high by as much with the other, 1.6 % at 10, which is less than what backward
 * Euler takes of them unless steps are a thirtieth of a period; only free ends of a few segments swing better with the
 * other, and chapter mixed needs blocks.
 *
 * Adds the lumped inertia of half a segment to the block (n x n, n = 3 + visits) of its node: (1/2) m |x' - w u'|^2
 * with m = rho du/2 and w = (x_j - x_i)/du, and 1e-3 m on the diagonal of u, the floor for a compressed segment's w
 * near 0. */
YC_FN void yci_yarn_inertia(double m, const double *w, int visit, int n, double *block) {
    int u = 3 + visit;
    for (int i = 0; i < 3; i++) {
        block[n * i + i] += m;
        block[n * i + u] -= m * w[i];
        block[n * u + i] -= m * w[i];
    }
    block[n * u + u] += m * (yci_dot(w, w) + 1e-3);
}

#undef YCI_YARN_SHORTEST
#undef YCI_YARN_JAM

/* =====================================================================================================================
 * >>triangle   (chapter 7)
 *
 * Elements of the triangle cloth (MIX 4.1): pure functions with the manner of chapter 6 (energy returned, g and h
 * overwritten unless NULL, `projected` 1 for a positive semidefinite Hessian in closed form).
 *
 *   membrane   St. Venant-Kirchhoff per rest area, F = [x1 - x0, x2 - x0] Dm^-1 (3x2) in the grain frame,
 *              strain e = (E11, E22, 2 E12) of E = (F^T F - I)/2, density (1/2) e^T C e with
 *              C = [C11 C12 0; C12 C22 0; 0 0 C33] in N/m. Hessian: area (B^T C B + stress term), B = de/dq.
 *              Projected clamps the 2x2 stress of the second to its positive part: exact wherever both principal
 *              stresses are tensile.
 *   hinge      discrete shells, (1/2) c (theta - theta_bar)^2 with c = D |e|^2/A (D the flexural rigidity in N m, e the
 *              rest edge, A the summed rest area of both triangles): a finely meshed cylinder of curvature kappa
 *              stores (1/2) D kappa^2 per area. Projected is the Gauss-Newton part: exact at theta = theta_bar.
 *
 * The dihedral is theta = psi(x2) - psi(x3) - pi, psi the angle of a wing about the edge, positive when the wings rise
 * to the side of the normal of (x0, x1, x2). So its derivatives are a sum over two independent wings. With t the edge's
 * direction, l its length, m the wing's direction across it, n = t x m, height h and foot s (in edge lengths from x0),
 *   grad psi = n w / h,                w = -(1 - s) on x0, -s on x1, 1 on the wing's tip,
 *   hess psi = -sym(n m^T) w w^T / h^2 - sym((n v)(t w)^T) / (h l) - sym(n m^T) v v^T / (2 l^2),   v = -1, 1, 0,
 * up to an antisymmetric term in which the two wings cancel, sym(X) = X + X^T (derived here). Degenerate triangles:
 * directions by fixed rule, l floored at 1e-4 of the wings' size and h at 1e-4 of its triangle's size, both at a
 * nanometre, so that the force stays bounded; it still sums to zero.
 *
 * Stiffness damping as in chapter 6: strains e_prev (read only when r > 0) and theta_prev at the step's start.
 * ===================================================================================================================== */

/* -- membrane: q = (x0, x1, x2) ------------------------------------------------------------------------------------ */

typedef struct yci_membrane {
    double dm[4]; /* inverse of the rest edges, 2x2 by rows, first coordinate along the grain, 1/m */
    double area;  /* rest area in m^2; 0 for a pattern triangle too thin to tell, which has no energy */
} yci_membrane;

/* uv: three pattern points in metres, wound either way; grain: angle of the warp in radians from the u axis;
 * pre_stretch: the rest shape is the pattern times this factor. */
YC_FN void yci_triangle_rest(yci_membrane *rest, const double *uv, double grain, double pre_stretch) {
    double c = pre_stretch * cos(grain), s = pre_stretch * sin(grain);
    double u1 = uv[2] - uv[0], v1 = uv[3] - uv[1], u2 = uv[4] - uv[0], v2 = uv[5] - uv[1];
    double a = c * u1 + s * v1, b = c * u2 + s * v2; /* rest edges as columns: (a, d) and (b, e) */
    double d = c * v1 - s * u1, e = c * v2 - s * u2;
    double det = a * e - b * d, size = a * a + b * b + d * d + e * e;
    double scale = fabs(det) > 1e-12 * size ? 1.0 / det : 0.0;
    rest->dm[0] = e * scale, rest->dm[1] = -b * scale;
    rest->dm[2] = -d * scale, rest->dm[3] = a * scale;
    rest->area = scale != 0.0 ? 0.5 * fabs(det) : 0.0;
}

/* The two columns of the deformation gradient. */
YC_FN void yci_triangle_gradient(const double *q, const yci_membrane *rest, double *f1, double *f2) {
    double e1[3], e2[3];
    yci_sub(e1, q + 3, q), yci_sub(e2, q + 6, q);
    yci_scale(f1, e1, rest->dm[0]), yci_axpy(f1, rest->dm[2], e2);
    yci_scale(f2, e1, rest->dm[1]), yci_axpy(f2, rest->dm[3], e2);
}

YC_FN void yci_triangle_membrane_strain(const double *q, const yci_membrane *rest, double *strain) {
    double f1[3], f2[3];
    yci_triangle_gradient(q, rest, f1, f2);
    strain[0] = 0.5 * (yci_dot(f1, f1) - 1.0);
    strain[1] = 0.5 * (yci_dot(f2, f2) - 1.0);
    strain[2] = yci_dot(f1, f2);
}

/* Adds factor times the stress of a strain and returns factor times its energy density. */
YC_FN double yci_triangle_stress(double *stress, const double *material, double factor, const double *e) {
    double s0 = factor * (material[0] * e[0] + material[1] * e[1]);
    double s1 = factor * (material[1] * e[0] + material[2] * e[1]);
    double s2 = factor * material[3] * e[2];
    stress[0] += s0, stress[1] += s1, stress[2] += s2;
    return 0.5 * (s0 * e[0] + s1 * e[1] + s2 * e[2]);
}

/* The positive semidefinite part of [s0 s2; s2 s1]. */
YC_FN void yci_triangle_clamp(double *s) {
    double mean = 0.5 * (s[0] + s[1]), half = 0.5 * (s[0] - s[1]), radius = sqrt(half * half + s[2] * s[2]);
    double top = mean + radius, bottom = mean - radius;
    if (bottom >= 0.0) return;
    if (top <= 0.0) {
        s[0] = s[1] = s[2] = 0.0;
        return;
    }
    /* One eigenvalue of each sign: top times the projector on its eigenvector. */
    top *= 0.5 / radius;
    s[0] = top * (radius + half), s[1] = top * (radius - half), s[2] *= top;
}

/* The stress after the step dq, by the linear model. */
YC_FN void yci_triangle_membrane_predict(const double *q, const double *dq, const yci_membrane *rest,
    const double *material, double r, const double *e_prev, double *stress) {
    double f1[3], f2[3], d1[3], d2[3], e[3], rate[3];
    yci_triangle_gradient(q, rest, f1, f2), yci_triangle_gradient(dq, rest, d1, d2);
    yci_triangle_membrane_strain(q, rest, e);
    e[0] += yci_dot(f1, d1), e[1] += yci_dot(f2, d2), e[2] += yci_dot(f1, d2) + yci_dot(f2, d1);
    yci_zero(stress, 3);
    yci_triangle_stress(stress, material, 1.0, e);
    if (r <= 0.0) return;
    yci_sub(rate, e, e_prev);
    yci_triangle_stress(stress, material, r, rate);
}

/* material: C11, C12, C22, C33 in N/m. held: the stress of the second derivative of the strains; NULL: the state's. */
YC_FN double yci_triangle_membrane(const double *q, const yci_membrane *rest, const double *material, double r,
    const double *e_prev, const double *held, double *g, double *h, int projected) {
    double f1[3], f2[3], e[3], rate[3], stress[3] = {0.0, 0.0, 0.0}, density, b[3][9], n1[3], n2[3];
    yci_triangle_gradient(q, rest, f1, f2);
    yci_triangle_membrane_strain(q, rest, e);
    density = yci_triangle_stress(stress, material, 1.0, e);
    if (r > 0.0) {
        yci_sub(rate, e, e_prev);
        density += yci_triangle_stress(stress, material, r, rate);
    }
    if (!g && !h) return rest->area * density;
    /* n1, n2: derivatives of the shape functions; rows of b: gradients of the three strains. */
    n1[1] = rest->dm[0], n1[2] = rest->dm[2], n1[0] = -n1[1] - n1[2];
    n2[1] = rest->dm[1], n2[2] = rest->dm[3], n2[0] = -n2[1] - n2[2];
    for (int p = 0; p < 3; p++) {
        for (int i = 0; i < 3; i++) {
            b[0][3 * p + i] = n1[p] * f1[i];
            b[1][3 * p + i] = n2[p] * f2[i];
            b[2][3 * p + i] = n1[p] * f2[i] + n2[p] * f1[i];
        }
    }
    if (g) {
        for (int i = 0; i < 9; i++) {
            g[i] = rest->area * (stress[0] * b[0][i] + stress[1] * b[1][i] + stress[2] * b[2][i]);
        }
    }
    if (h) {
        double c = rest->area * (1.0 + r);
        for (int j = 0; j < 9; j++) {
            double c0 = c * (material[0] * b[0][j] + material[1] * b[1][j]);
            double c1 = c * (material[1] * b[0][j] + material[2] * b[1][j]);
            double c2 = c * material[3] * b[2][j];
            for (int i = 0; i < 9; i++) h[9 * j + i] = c0 * b[0][i] + c1 * b[1][i] + c2 * b[2][i];
        }
        if (held) yci_copy(stress, held);
        if (projected) yci_triangle_clamp(stress);
        for (int p = 0; p < 9; p++) {
            int i = p / 3, j = p % 3;
            double s = rest->area *
                (stress[0] * n1[i] * n1[j] + stress[1] * n2[i] * n2[j] + stress[2] * (n1[i] * n2[j] + n2[i] * n1[j]));
            for (int axis = 0; axis < 3; axis++) h[9 * (3 * i + axis) + 3 * j + axis] += s;
        }
    }
    return rest->area * density;
}

#define YCI_TRIANGLE_SHORTEST 1e-9 /* metres */

/* -- hinge: q = (x0, x1, x2, x3), x0 x1 the shared edge ------------------------------------------------------------ */

typedef struct yci_triangle_wing {
    double m[3], n[3];   /* unit, across the edge in the wing's plane, and normal to it: n = t x m */
    double height, foot; /* of the tip: distance from the edge (floored), place along it (0 at x0, 1 at x1) */
} yci_triangle_wing;

YC_FN void yci_triangle_wing_make(yci_triangle_wing *wing, const double *t, double l, const double *y) {
    double along = yci_dot(y, t), size = yci_norm(y), height;
    yci_copy(wing->m, y), yci_axpy(wing->m, -along, t);
    height = yci_norm(wing->m);
    if (height > 1e-12 * size) yci_scale(wing->m, wing->m, 1.0 / height);
    else yci_perpendicular(wing->m, t);
    yci_cross(wing->n, t, wing->m);
    wing->height = yci_max(yci_max(height, 1e-4 * (size + l)), YCI_TRIANGLE_SHORTEST);
    wing->foot = along / l;
}

/* The edge's direction and length, and both wings; returns theta in [-pi, pi]. */
YC_FN double yci_triangle_fold(const double *q, double *t, double *l, yci_triangle_wing *wings) {
    double x_axis[3] = {1.0, 0.0, 0.0}, y2[3], y3[3], c[3];
    yci_sub(t, q + 3, q), yci_sub(y2, q + 6, q), yci_sub(y3, q + 9, q);
    *l = yci_normalize(t, x_axis);
    *l = yci_max(yci_max(*l, 1e-4 * (yci_norm(y2) + yci_norm(y3))), YCI_TRIANGLE_SHORTEST);
    yci_triangle_wing_make(&wings[0], t, *l, y2);
    yci_triangle_wing_make(&wings[1], t, *l, y3);
    yci_cross(c, wings[0].m, wings[1].m);
    return atan2(yci_dot(t, c), -yci_dot(wings[0].m, wings[1].m));
}

YC_FN double yci_triangle_hinge_strain(const double *q) {
    double t[3], l;
    yci_triangle_wing wings[2];
    return yci_triangle_fold(q, t, &l, wings);
}

/* Adds the derivatives of psi of one wing, times `slope` to g (twelve) and times `bend` to h (12 x 12, or NULL). */
YC_FN void yci_triangle_wing_derivatives(const yci_triangle_wing *wing, const double *t, double l, int side,
    double slope, double bend, double *g, double *h) {
    double w[3], v[3] = {-1.0, 1.0, 0.0}, nm[9], nt[9];
    w[0] = (wing->foot - 1.0) / wing->height, w[1] = -wing->foot / wing->height, w[2] = 1.0 / wing->height;
    yci_scale(v, v, 1.0 / l);
    for (int p = 0; p < 3; p++) yci_axpy(g + 3 * (p < 2 ? p : 2 + side), slope * w[p], wing->n);
    if (!h) return;
    for (int k = 0; k < 9; k++) {
        nm[k] = wing->n[k / 3] * wing->m[k % 3] + wing->m[k / 3] * wing->n[k % 3];
        nt[k] = wing->n[k / 3] * t[k % 3];
    }
    for (int p = 0; p < 3; p++) {
        for (int q = 0; q < 3; q++) {
            double across = -bend * (w[p] * w[q] + 0.5 * v[p] * v[q]);
            double shear = -bend * v[p] * w[q], transposed = -bend * w[p] * v[q];
            double *block = h + 36 * (p < 2 ? p : 2 + side) + 3 * (q < 2 ? q : 2 + side);
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++) {
                    block[12 * i + j] += across * nm[3 * i + j] + shear * nt[3 * i + j] + transposed * nt[3 * j + i];
                }
            }
        }
    }
}

/* c in N m; theta_bar and theta_prev in [-pi, pi], differences are taken modulo 2 pi. */
YC_FN double yci_triangle_hinge(
    const double *q, double c, double theta_bar, double r, double theta_prev, double *g, double *h, int projected) {
    double t[3], l, gradient[12], s, rate, df, ddf = c * (1.0 + r), theta;
    yci_triangle_wing wings[2];
    theta = yci_triangle_fold(q, t, &l, wings);
    s = yci_angle_difference(theta, theta_bar), rate = yci_angle_difference(theta, theta_prev);
    df = c * (s + r * rate);
    if (g || h) {
        double *exact = projected ? NULL : h;
        yci_zero(gradient, 12);
        if (h) yci_zero(h, 144);
        yci_triangle_wing_derivatives(&wings[0], t, l, 0, 1.0, df, gradient, exact);
        yci_triangle_wing_derivatives(&wings[1], t, l, 1, -1.0, -df, gradient, exact);
        for (int i = 0; i < 12 && g; i++) g[i] = df * gradient[i];
        for (int i = 0; i < 12 && h; i++) {
            double row = ddf * gradient[i];
            for (int j = 0; j < 12; j++) h[12 * i + j] += row * gradient[j];
        }
    }
    return 0.5 * c * (s * s + r * rate * rate);
}

#undef YCI_TRIANGLE_SHORTEST

/* =====================================================================================================================
 * >>contact   (chapter 8)
 *
 * Geometry and elements of contact: signed distances of rigid bodies, closest points of pairs, the penalty and friction
 * potentials of both, and the broad phase that finds the pairs.
 *
 * Body distance d(x). Sphere, rounded cone, box and plane are exact. A loft measures, in the horizontal plane of each
 * section j, D_j = (f - 1)/|grad f| with f = (|x/a|^e + |z/b|^e)^(1/e): the distance of the tangent at the radial
 * projection, hence never above the true one, and exact to first order at the surface. The points (D_j, y_j) form a
 * profile in a plane that holds the query at (0, y); d is the signed distance to that profile, closed by the two caps.
 * So slope and caps are accounted for, d is continuous and changes no faster than the D_j do. Shapes join by the
 * polynomial smooth minimum, whose gradient is a convex combination of theirs.
 *
 * Contact. x_rel = sum_i w_i x_i with sum_i w_i = 0 (or one node with w = 1 against a body), d = |x_rel|, n = x_rel/d:
 *     E = k g(thickness - d),  g of yci_one_sided, delta = YCI_CONTACT_SHARE thickness
 *     dE/dx_i = -k g' w_i n,   Hessian k g'' w_i w_j n n^T: positive semidefinite, the curvature of d is dropped.
 * Friction, lagged as in incremental potentials: with w, n and lambda = k g' of the step's start (or of the last pass)
 *     E = mu lambda f(|u_t|),  u_t = (I - n n^T) u,  u = sum_i w_i (x_i - x_i at the step's start) - motion of the body
 *     f(s) = s^2/(2 eps) up to eps, s - eps/2 beyond,  eps = slip speed * h.
 * A block that should stick therefore creeps with less than the slip speed. Both potentials give a 3-vector and a 3x3
 * block in x_rel; yci_contact_spread carries them to the nodes.
 *
 * Directions at d = 0: the triangle's normal, the normal of both edges, else a fixed perpendicular of an edge, else x.
 *
 * Broad phase: boxes in a uniform hash grid whose cells are about as large as the mean box. The result's order and bits
 * depend neither on the order of the input nor on the number of workers. Cost is linear while the boxes are of similar
 * size; where a few are much larger than the rest, cells grow rather than entries.
 *
 * Workspace: pairs take about 48 bytes per box in the grid's cells plus 16 bytes per cell entry, freed on return.
 * ===================================================================================================================== */

#define YCI_CONTACT_SHARE 0.25 /* of the thickness: the part over which the penalty's stiffness rises to its full k */
#define YCI_FAR 1e300          /* bounds of a half space */

/* ---- signed distances of the primitives: value returned, gradient in n ---- */

YC_FN double yci_sphere_distance(const double *p, const double *a, double ra, double *n) {
    const double up[3] = {0.0, 1.0, 0.0};
    yci_sub(n, p, a);
    return yci_normalize(n, up) - ra;
}

/* The solid is the union of the spheres at a + t (b - a); the nearest of them has a closed form. */
YC_FN double yci_rounded_cone_distance(
    const double *p, const double *a, const double *b, double ra, double rb, double *n) {
    double axis[3], q[3], centre[3], fallback[3], length, y, radial, slope, t;
    yci_sub(axis, b, a);
    length = yci_norm(axis);
    if (length <= fabs(rb - ra)) return yci_sphere_distance(p, ra > rb ? a : b, yci_max(ra, rb), n);
    yci_scale(axis, axis, 1.0 / length);
    yci_sub(q, p, a);
    y = yci_dot(q, axis);
    yci_axpy(q, -y, axis);
    radial = yci_norm(q);
    slope = (rb - ra) / length;
    t = yci_clamp(y + slope * radial / sqrt(1.0 - slope * slope), 0.0, length);
    yci_copy(centre, a);
    yci_axpy(centre, t, axis);
    yci_perpendicular(fallback, axis);
    yci_sub(n, p, centre);
    return yci_normalize(n, fallback) - (ra + t * slope);
}

YC_FN double yci_box_distance(const double *p, const double *a, const double *b, double ra, double *n) {
    double q[3], outside[3], sign[3], length, inner;
    int i, axis = 0;
    for (i = 0; i < 3; i++) {
        sign[i] = p[i] < a[i] ? -1.0 : 1.0;
        q[i] = fabs(p[i] - a[i]) - (b[i] - ra);
        outside[i] = yci_max(q[i], 0.0);
        if (q[i] > q[axis]) axis = i;
    }
    inner = q[axis];
    if (inner <= 0.0) {
        n[0] = n[1] = n[2] = 0.0;
        n[axis] = sign[axis];
        return inner - ra;
    }
    length = yci_norm(outside);
    for (i = 0; i < 3; i++) n[i] = sign[i] * outside[i] / length;
    return length - ra;
}

/* Distance in its plane to one section s = {y, half width, half depth, centre z}; g receives d/dx and d/dz. With
 * U = |x|/(a f), V = |z|/(b f) and q = (V/a, -U/b): grad f = (U^(e-1)/a, V^(e-1)/b), its Hessian is
 * (e-1)/f (UV)^(e-2) q q^T. Inside, 1/|grad f| fades with f^4 into the smaller half size, which is the depth at the
 * centre: without that the depth there would depend on the direction one comes from. */
YC_FN double yci_section_distance(const double *s, double e, double x, double z, double *g) {
    double a = s[1], b = s[2], sx = x < 0.0 ? -1.0 : 1.0, sz, u, v, big, small, ratio, power, root;
    double f, ue, ve, fx, fz, slope, least, weight, scale, along, turn;
    z -= s[3];
    sz = z < 0.0 ? -1.0 : 1.0;
    u = fabs(x) / a, v = fabs(z) / b;
    big = yci_max(u, v), small = yci_min(u, v);
    if (big < 1e-12) {
        g[0] = g[1] = 0.0;
        return -yci_min(a, b);
    }
    ratio = small / big;
    power = e == 2.0 ? 1.0 : pow(ratio, e - 2.0);
    small = 1.0 + power * ratio * ratio; /* (f/big)^e */
    root = e == 2.0 ? sqrt(small) : pow(small, 1.0 / e);
    f = big * root;
    ue = root * root / small, ve = power * ue; /* U^(e-2), V^(e-2) when u is the larger */
    if (u < v) scale = ue, ue = ve, ve = scale;
    u /= f, v /= f;
    fx = ue * u / a, fz = ve * v / b;
    slope = sqrt(fx * fx + fz * fz);
    turn = (e - 1.0) / f * ue * ve * (v / a * fx - u / b * fz) / slope; /* grad |grad f| = turn q */
    least = yci_min(a, b);
    weight = f < 1.0 ? f * f * f * f : 1.0;
    scale = least + weight * (1.0 / slope - least); /* the distance is (f - 1) scale */
    along = scale + (f < 1.0 ? 4.0 * (f - 1.0) * f * f * f * (1.0 / slope - least) : 0.0);
    turn *= (1.0 - f) * weight / (slope * slope);
    g[0] = sx * (along * fx + turn * v / a), g[1] = sz * (along * fz - turn * u / b);
    return (f - 1.0) * scale;
}

/* The nearest point so far of a loft's profile: its distance without sign, the gradient with it. */
typedef struct {
    double distance, sign, n[3];
} yci_loft_best;

/* One profile segment between sections s and s + 4; d and g are the section distances and their gradients. */
YC_FN void yci_loft_segment(yci_loft_best *best, const double *s, const double *d0, const double *d1, double y) {
    double run = s[4] - s[0], rise = d1[0] - d0[0], length = sqrt(run * run + rise * rise);
    double t = yci_clamp(((y - s[0]) * run - d0[0] * rise) / (length * length), 0.0, 1.0);
    double side = d0[0] + t * rise, up = y - (s[0] + t * run), distance = sqrt(side * side + up * up);
    double by_side = run / length, by_y = rise / length;
    if (distance >= best->distance) return;
    if ((t <= 0.0 || t >= 1.0) && distance > 1e-12 * length)
        by_side = best->sign * side / distance, by_y = best->sign * up / distance;
    best->distance = distance;
    best->n[0] = by_side * ((1.0 - t) * d0[1] + t * d1[1]);
    best->n[1] = by_y;
    best->n[2] = by_side * ((1.0 - t) * d0[2] + t * d1[2]);
}

YC_FN void yci_loft_cap(yci_loft_best *best, double distance, double direction) {
    if (distance >= best->distance) return;
    best->distance = distance;
    best->n[0] = best->n[2] = 0.0, best->n[1] = direction;
}

/* Walks from the query's own height up and down the profile, as far as something nearer may be. */
YC_FN double yci_loft_distance(const double *s, int count, double e, const double *p, double *n) {
    double lower[3], upper[3], top[3], bottom[3], t, y = p[1];
    int k = 0, end = count - 1, j;
    yci_loft_best best;
    while (end - k > 1) {
        j = (k + end) / 2;
        if (y < s[4 * j]) end = j;
        else k = j;
    }
    lower[0] = yci_section_distance(s + 4 * k, e, p[0], p[2], lower + 1);
    upper[0] = yci_section_distance(s + 4 * k + 4, e, p[0], p[2], upper + 1);
    t = (y - s[4 * k]) / (s[4 * k + 4] - s[4 * k]);
    best.distance = YCI_FAR, best.n[0] = best.n[1] = best.n[2] = 0.0;
    best.sign = t >= 0.0 && t <= 1.0 && (1.0 - t) * lower[0] + t * upper[0] < 0.0 ? -1.0 : 1.0;
    yci_loft_segment(&best, s + 4 * k, lower, upper, y);
    yci_copy(bottom, lower);
    for (j = k; j > 0 && y - s[4 * j] < best.distance; j--) {
        yci_copy(top, bottom);
        bottom[0] = yci_section_distance(s + 4 * j - 4, e, p[0], p[2], bottom + 1);
        yci_loft_segment(&best, s + 4 * j - 4, bottom, top, y);
    }
    if (j == 0 && bottom[0] <= 0.0) yci_loft_cap(&best, fabs(y - s[0]), -1.0);
    yci_copy(top, upper);
    for (j = k + 1; j < count - 1 && s[4 * j] - y < best.distance; j++) {
        yci_copy(bottom, top);
        top[0] = yci_section_distance(s + 4 * j + 4, e, p[0], p[2], top + 1);
        yci_loft_segment(&best, s + 4 * j, bottom, top, y);
    }
    if (j == count - 1 && top[0] <= 0.0) yci_loft_cap(&best, fabs(y - s[4 * j]), 1.0);
    yci_copy(n, best.n);
    return best.sign * best.distance;
}

/* ---- bodies ---- */

typedef struct {
    yc_primitive_type type;
    double a[3], b[3], ra, rb, exponent; /* as in yc_primitive; a plane's b is a unit vector */
    int first, count;                    /* loft: its rows in the body's sections */
    double lo[3], hi[3];                 /* bounding box in the body's frame */
} yci_primitive;

/* world = r local + t, r by rows */
typedef struct {
    double r[9], t[3];
} yci_pose;

typedef struct {
    yci_primitive *primitive;
    int primitive_count;
    double *section; /* rows of four of all lofts, refined so that neighbours are alike */
    double smooth_radius, friction;
    double lo[3], hi[3];
    yci_pose pose, last; /* now, and at the start of the step */
} yci_body_sdf;

YC_API yc_body_desc yc_body_desc_default(void) {
    yc_body_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.cookie = YCI_DESC_COOKIE;
    desc.friction = 0.3;
    return desc;
}

YC_FN double yci_bounds_squared(const double *lo, const double *hi, const double *p) {
    double sum = 0.0;
    int i;
    for (i = 0; i < 3; i++) {
        double gap = yci_max(yci_max(lo[i] - p[i], p[i] - hi[i]), 0.0);
        sum += gap * gap;
    }
    return sum;
}

YC_FN void yci_pose_local(const yci_pose *pose, const double *x, double *p) {
    double q[3];
    int i;
    yci_sub(q, x, pose->t);
    for (i = 0; i < 3; i++) p[i] = pose->r[i] * q[0] + pose->r[3 + i] * q[1] + pose->r[6 + i] * q[2];
}

YC_FN void yci_pose_rotate(const yci_pose *pose, const double *p, double *x) {
    double q[3];
    int i;
    for (i = 0; i < 3; i++) q[i] = yci_dot(pose->r + 3 * i, p);
    yci_copy(x, q);
}

/* `bound` is the squared distance to the bounding box. A loft's tangent distance may fall below it far away, so the
 * larger of the two holds; for the other shapes it never does. */
YC_FN double yci_primitive_distance(
    const yci_primitive *q, const double *section, const double *p, double bound, double *n) {
    double local[3], d;
    int i;
    switch (q->type) {
    case YC_SPHERE: return yci_sphere_distance(p, q->a, q->ra, n);
    case YC_ROUNDED_CONE: return yci_rounded_cone_distance(p, q->a, q->b, q->ra, q->rb, n);
    case YC_BOX: return yci_box_distance(p, q->a, q->b, q->ra, n);
    case YC_PLANE:
        yci_copy(n, q->b);
        yci_sub(local, p, q->a);
        return yci_dot(local, q->b);
    case YC_LOFT: break;
    }
    yci_sub(local, p, q->a);
    d = yci_loft_distance(section + 4 * (size_t)q->first, q->count, q->exponent, local, n);
    if (bound <= 0.0 || d * d >= bound) return d;
    d = sqrt(bound);
    for (i = 0; i < 3; i++) n[i] = (yci_min(p[i] - q->lo[i], 0.0) + yci_max(p[i] - q->hi[i], 0.0)) / d;
    return d;
}

/* Signed distance of the world point x in metres; n receives its gradient, of length near one (a smooth union's is
 * shorter in its creases). Shapes whose bounding box is farther than the blend reaches are skipped, which is exact. */
YC_FN double yci_body_distance(const yci_body_sdf *body, const double *x, double *n) {
    double p[3], sum[3] = {0.0, 0.0, 0.0}, d = YCI_FAR, k = body->smooth_radius;
    int i, j;
    yci_pose_local(&body->pose, x, p);
    for (i = 0; i < body->primitive_count; i++) {
        const yci_primitive *q = body->primitive + i;
        double bound = yci_bounds_squared(q->lo, q->hi, p), reach = yci_max(d + k, 0.0), other, blend, m[3];
        if (bound > 0.0 && bound >= reach * reach) continue;
        other = yci_primitive_distance(q, body->section, p, bound, m);
        blend = k > 0.0 ? 0.5 * yci_max(1.0 - fabs(d - other) / k, 0.0) : 0.0; /* weight of the farther one */
        if (other < d) {
            d = other;
            blend = 1.0 - blend;
        }
        for (j = 0; j < 3; j++) sum[j] += blend * (m[j] - sum[j]);
        blend = yci_min(blend, 1.0 - blend);
        d -= k * blend * blend;
    }
    yci_pose_rotate(&body->pose, sum, n);
    return d;
}

/* A lower bound of yci_body_distance at the price of a box; 0 or less says nothing. */
YC_FN double yci_body_bound(const yci_body_sdf *body, const double *x) {
    double p[3];
    yci_pose_local(&body->pose, x, p);
    return sqrt(yci_bounds_squared(body->lo, body->hi, p)) - body->smooth_radius;
}

/* How far the material point of the body that is at x now has moved since the step's start. */
YC_FN void yci_body_motion(const yci_body_sdf *body, const double *x, double *u) {
    double p[3];
    yci_pose_local(&body->pose, x, p);
    yci_pose_rotate(&body->last, p, p);
    yci_add(p, p, body->last.t);
    yci_sub(u, x, p);
}

/* Starts a step: the present pose becomes the last one, r (rotation, by rows) and t the present. */
static void yci_body_move(yci_body_sdf *body, const double *r, const double *t) {
    body->last = body->pose;
    memcpy(body->pose.r, r, sizeof body->pose.r);
    yci_copy(body->pose.t, t);
}

static void yci_body_free(yci_context *c, yci_body_sdf *body) {
    yci_free(c, body->primitive);
    yci_free(c, body->section);
    memset(body, 0, sizeof *body);
}

static yc_result yci_body_wrong(yci_context *c, int index, const char *field, double value, const char *rule) {
    return YCI_FAIL(c, YC_ERROR_ARGUMENT, "body.primitives[%d].%s is %g, %s", index, field, value, rule);
}

/* A finite number in [lo, hi]; NaN fails both comparisons. */
static int yci_within(double value, double lo, double hi) { return value >= lo && value <= hi; }

static yc_result yci_body_check_vector(yci_context *c, int index, const char *field, const double *v) {
    int j;
    for (j = 0; j < 3; j++)
        if (!yci_within(v[j], -1e100, 1e100))
            return YCI_FAIL(
                c, YC_ERROR_ARGUMENT, "body.primitives[%d].%s[%d] is %g, must be finite", index, field, j, v[j]);
    return YC_OK;
}

static yc_result yci_body_check_loft(yci_context *c, int index, const yc_primitive *p) {
    static const char *const column[4] = {"height", "half width", "half depth", "centre"};
    int i, j;
    if (!yci_within(p->exponent, 2.0, 8.0))
        return yci_body_wrong(c, index, "exponent", p->exponent, "must be in [2, 8]");
    if (p->section_count < 2 || p->section_count > 65536)
        return yci_body_wrong(c, index, "section_count", p->section_count, "must be in [2, 65536]");
    if (!p->sections) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "body.primitives[%d].sections is NULL", index);
    for (i = 0; i < p->section_count; i++) {
        for (j = 0; j < 4; j++) {
            double value = p->sections[i][j];
            int positive = j == 1 || j == 2;
            if (!yci_within(value, positive ? 1e-9 : -1e100, 1e100))
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "body.primitives[%d].sections[%d][%d] (%s) is %g, must be %s",
                    index, i, j, column[j], value, positive ? "positive" : "finite");
        }
        if (i && !(p->sections[i][0] > p->sections[i - 1][0]))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "body.primitives[%d].sections[%d][0] (height) is %g, must exceed %g",
                index, i, p->sections[i][0], p->sections[i - 1][0]);
    }
    return YC_OK;
}

static yc_result yci_body_check(yci_context *c, int index, const yc_primitive *p) {
    double smallest = yci_min(yci_min(p->b[0], p->b[1]), p->b[2]);
    int j;
    if ((int)p->type < (int)YC_SPHERE || (int)p->type > (int)YC_LOFT)
        return yci_body_wrong(c, index, "type", (double)p->type, "is not a yc_primitive_type");
    if (yci_body_check_vector(c, index, "a", p->a)) return YC_ERROR_ARGUMENT;
    if (p->type == YC_LOFT) return yci_body_check_loft(c, index, p);
    if (p->type != YC_SPHERE && yci_body_check_vector(c, index, "b", p->b)) return YC_ERROR_ARGUMENT;
    if (p->type == YC_PLANE) {
        if (!(yci_norm(p->b) > 1e-100))
            return yci_body_wrong(c, index, "b", yci_norm(p->b), "in length, has no direction");
        return YC_OK;
    }
    for (j = 0; p->type == YC_BOX && j < 3; j++)
        if (!(p->b[j] > 0.0))
            return YCI_FAIL(
                c, YC_ERROR_ARGUMENT, "body.primitives[%d].b[%d] is %g, must be positive", index, j, p->b[j]);
    if (!yci_within(p->ra, 0.0, 1e100)) return yci_body_wrong(c, index, "ra", p->ra, "must be finite and not negative");
    if (p->type == YC_SPHERE && !(p->ra > 0.0)) return yci_body_wrong(c, index, "ra", p->ra, "must be positive");
    if (p->type == YC_BOX && p->ra > smallest)
        return yci_body_wrong(c, index, "ra", p->ra, "must not exceed the smallest half extent");
    if (p->type != YC_ROUNDED_CONE) return YC_OK;
    if (!yci_within(p->rb, 0.0, 1e100)) return yci_body_wrong(c, index, "rb", p->rb, "must be finite and not negative");
    if (!(p->ra + p->rb > 0.0)) return yci_body_wrong(c, index, "ra + rb", 0.0, "must be positive");
    return YC_OK;
}

/* Neighbouring sections are refined until they are alike, since the profile goes linearly in the distance to them and
 * should follow sections whose sizes and centre go linearly. Returns the number of pieces between the two rows. */
static int yci_loft_pieces(const double *s, const double *next) {
    double smallest = yci_min(yci_min(s[1], s[2]), yci_min(next[1], next[2])), change = 0.0;
    int j;
    for (j = 1; j < 4; j++) change = yci_max(change, fabs(next[j] - s[j]));
    return (int)yci_clamp(ceil(6.0 * change / smallest), 1.0, 64.0);
}

/* Fills the copy of a primitive and its bounding box; `section` has room for the loft's refined rows. */
static void yci_body_copy(yci_primitive *out, const yc_primitive *p, double *section, int first) {
    int i, j, k, rows = 0;
    out->type = p->type, out->ra = p->ra, out->rb = p->rb, out->exponent = p->exponent, out->first = first;
    yci_copy(out->a, p->a), yci_copy(out->b, p->b);
    if (p->type == YC_PLANE) yci_scale(out->b, p->b, 1.0 / yci_norm(p->b));
    for (j = 0; j < 3; j++) {
        double size = p->type == YC_BOX ? p->b[j] : p->ra;
        out->lo[j] = p->type == YC_PLANE ? -YCI_FAR : p->a[j] - size;
        out->hi[j] = p->type == YC_PLANE ? YCI_FAR : p->a[j] + size;
        if (p->type != YC_ROUNDED_CONE) continue;
        out->lo[j] = yci_min(out->lo[j], p->b[j] - p->rb);
        out->hi[j] = yci_max(out->hi[j], p->b[j] + p->rb);
    }
    if (p->type != YC_LOFT) return;
    for (i = 0; i < p->section_count; i++) {
        const double *s = p->sections[i], *next = p->sections[i + 1 < p->section_count ? i + 1 : i];
        int pieces = i + 1 < p->section_count ? yci_loft_pieces(s, next) : 1;
        for (k = 0; k < pieces; k++, rows++)
            for (j = 0; j < 4; j++) section[4 * rows + j] = s[j] + (next[j] - s[j]) * ((double)k / (double)pieces);
        out->lo[0] = yci_min(i ? out->lo[0] : YCI_FAR, p->a[0] - s[1]);
        out->hi[0] = yci_max(i ? out->hi[0] : -YCI_FAR, p->a[0] + s[1]);
        out->lo[2] = yci_min(i ? out->lo[2] : YCI_FAR, p->a[2] + s[3] - s[2]);
        out->hi[2] = yci_max(i ? out->hi[2] : -YCI_FAR, p->a[2] + s[3] + s[2]);
    }
    out->count = rows;
    out->lo[1] = p->a[1] + p->sections[0][0];
    out->hi[1] = p->a[1] + p->sections[p->section_count - 1][0];
}

/* Checks and copies a body; its pose is the identity. On failure *out is untouched. Give it to yci_body_free. */
static yc_result yci_body_init(yci_context *c, const yc_body_desc *desc, yci_body_sdf *out) {
    yci_body_sdf body;
    size_t rows = 0;
    int i, j;
    memset(&body, 0, sizeof body);
    if (!desc) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "body descriptor is NULL");
    if (desc->cookie != YCI_DESC_COOKIE)
        return YCI_FAIL(
            c, YC_ERROR_ARGUMENT, "body.cookie is %u, make the struct with yc_body_desc_default()", desc->cookie);
    if (desc->primitive_count < 1 || desc->primitive_count > 65536)
        return YCI_FAIL(
            c, YC_ERROR_ARGUMENT, "body.primitive_count is %d, must be in [1, 65536]", desc->primitive_count);
    if (!desc->primitives) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "body.primitives is NULL");
    if (!yci_within(desc->smooth_radius, 0.0, 1e100))
        return YCI_FAIL(
            c, YC_ERROR_ARGUMENT, "body.smooth_radius is %g, must be finite and not negative", desc->smooth_radius);
    if (!yci_within(desc->friction, 0.0, 10.0))
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "body.friction is %g, must be in [0, 10]", desc->friction);
    for (i = 0; i < desc->primitive_count; i++) {
        const yc_primitive *p = desc->primitives + i;
        if (yci_body_check(c, i, p)) return YC_ERROR_ARGUMENT;
        if (p->type != YC_LOFT) continue;
        for (j = 0; j + 1 < p->section_count; j++) rows += (size_t)yci_loft_pieces(p->sections[j], p->sections[j + 1]);
        rows++;
        if (rows > 0x1fffffff)
            return yci_body_wrong(c, i, "section_count", p->section_count, "too many sections in all");
    }
    body.primitive = YCI_NEW(c, yci_primitive, desc->primitive_count);
    body.section = YCI_NEW(c, double, 4 * rows);
    if (!body.primitive || !body.section) {
        yci_body_free(c, &body);
        return yci_out_of_memory(c, "a body");
    }
    body.primitive_count = desc->primitive_count;
    body.smooth_radius = desc->smooth_radius, body.friction = desc->friction;
    for (i = 0, rows = 0; i < desc->primitive_count; i++) {
        yci_primitive *q = body.primitive + i;
        yci_body_copy(q, desc->primitives + i, body.section + 4 * rows, (int)rows);
        rows += (size_t)q->count;
        for (j = 0; j < 3; j++) {
            body.lo[j] = yci_min(i ? body.lo[j] : YCI_FAR, q->lo[j]);
            body.hi[j] = yci_max(i ? body.hi[j] : -YCI_FAR, q->hi[j]);
        }
    }
    body.pose.r[0] = body.pose.r[4] = body.pose.r[8] = 1.0;
    body.last = body.pose;
    *out = body;
    return YC_OK;
}

/* ---- closest points: distance returned, unit normal n, weights w with x_rel = sum w_i x_i = d n ---- */

/* Squared distance; rel = p - (a + t (b - a)). */
YC_FN double yci_closest_point_segment(const double *p, const double *a, const double *b, double *rel, double *t) {
    double ab[3], ap[3], length;
    yci_sub(ab, b, a), yci_sub(ap, p, a);
    length = yci_dot(ab, ab);
    *t = length > 0.0 ? yci_clamp(yci_dot(ap, ab) / length, 0.0, 1.0) : 0.0;
    if (*t < 1.0) {
        yci_copy(rel, ap);
        yci_axpy(rel, -*t, ab);
    } else yci_sub(rel, p, b);
    return yci_dot(rel, rel);
}

/* The documented direction when a pair touches: the given normal, or a perpendicular of the edge, or x. */
YC_FN void yci_closest_fallback(double *n, const double *normal, const double *edge) {
    const double x[3] = {1.0, 0.0, 0.0};
    double along[3];
    yci_copy(n, normal);
    if (yci_normalize(n, x) > 1e-150) return;
    yci_copy(along, edge);
    if (yci_normalize(along, x) > 1e-150) yci_perpendicular(n, along);
}

YC_FN double yci_closest_point_point(const double *p, const double *q, double *n, double *w) {
    const double x[3] = {1.0, 0.0, 0.0};
    w[0] = 1.0, w[1] = -1.0, w[2] = w[3] = 0.0;
    yci_sub(n, p, q);
    return yci_normalize(n, x);
}

YC_FN double yci_closest_point_triangle(
    const double *p, const double *a, const double *b, const double *c, double *n, double *w) {
    const double *corner[3] = {a, b, c};
    double ab[3], ac[3], ap[3], normal[3], m[3], rel[3], area2, wb, wc, best = YCI_FAR, t;
    int i, j;
    yci_sub(ab, b, a), yci_sub(ac, c, a), yci_sub(ap, p, a);
    yci_cross(normal, ab, ac);
    area2 = yci_dot(normal, normal);
    w[0] = 1.0;
    if (area2 > 1e-24 * yci_dot(ab, ab) * yci_dot(ac, ac)) {
        yci_cross(m, ap, ac), wb = yci_dot(m, normal) / area2;
        yci_cross(m, ab, ap), wc = yci_dot(m, normal) / area2;
        if (wb >= 0.0 && wc >= 0.0 && wb + wc <= 1.0) {
            double height = yci_dot(ap, normal) / sqrt(area2);
            w[1] = wb + wc - 1.0, w[2] = -wb, w[3] = -wc;
            yci_scale(n, normal, (height < 0.0 ? -1.0 : 1.0) / sqrt(area2));
            return fabs(height);
        }
    }
    for (i = 0; i < 3; i++) {
        double squared;
        j = i == 2 ? 0 : i + 1;
        squared = yci_closest_point_segment(p, corner[i], corner[j], rel, &t);
        if (i && squared >= best) continue;
        best = squared;
        w[1] = w[2] = w[3] = 0.0;
        w[1 + i] = t - 1.0, w[1 + j] = -t;
        yci_copy(n, rel);
    }
    yci_closest_fallback(m, normal, yci_dot(ab, ab) > yci_dot(ac, ac) ? ab : ac);
    return yci_normalize(n, m);
}

/* The minimum of a convex function over a square: inside it where the lines cross, else at an end of one edge. Parallel
 * and zero-length edges have no crossing and need no case of their own. */
YC_FN double yci_closest_edge_edge(
    const double *a0, const double *a1, const double *b0, const double *b1, double *n, double *w) {
    const double *end[4] = {a0, a1, b0, b1};
    double u[3], v[3], r[3], rel[3], normal[3], m[3], uu, vv, uv, ur, vr, sine2, s, t, best = YCI_FAR;
    int i;
    yci_sub(u, a1, a0), yci_sub(v, b1, b0), yci_sub(r, a0, b0);
    yci_cross(normal, u, v);
    uu = yci_dot(u, u), vv = yci_dot(v, v), uv = yci_dot(u, v), ur = yci_dot(u, r), vr = yci_dot(v, r);
    sine2 = yci_dot(normal, normal); /* uu vv - uv^2 without its cancellation */
    if (sine2 > 1e-10 * uu * vv) {
        s = (uv * vr - vv * ur) / sine2;
        t = (uv * s + vr) / vv; /* by projection, which stays accurate where the lines are nearly parallel */
        if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) {
            double height = yci_dot(r, normal) / sqrt(sine2);
            w[0] = 1.0 - s, w[1] = s, w[2] = t - 1.0, w[3] = -t;
            yci_scale(n, normal, (height < 0.0 ? -1.0 : 1.0) / sqrt(sine2));
            return fabs(height);
        }
    }
    for (i = 0; i < 4; i++) {
        int other = i < 2 ? 2 : 0, own = 2 - other;
        double squared = yci_closest_point_segment(end[i], end[other], end[other + 1], rel, &t);
        double sign = i < 2 ? 1.0 : -1.0;
        if (squared >= best) continue;
        best = squared;
        w[own] = w[own + 1] = 0.0, w[i] = sign;
        w[other] = -sign * (1.0 - t), w[other + 1] = -sign * t;
        yci_scale(n, rel, sign);
    }
    yci_closest_fallback(m, normal, uu > vv ? u : v);
    return yci_normalize(n, m);
}

/* ---- pairs ---- */

typedef enum { YCI_POINT_TRIANGLE, YCI_EDGE_EDGE, YCI_POINT_POINT } yci_pair_kind;

/* Nodes p, a, b, c or a0, a1, b0, b1 or p, q, -1, -1; touching when the distance is `thickness`. */
typedef struct {
    int node[4];
    int kind;
    double thickness;
} yci_pair;

YC_FN int yci_pair_nodes(int kind) { return kind == YCI_POINT_POINT ? 2 : 4; }

/* The number of nodes on the pair's first side. */
YC_FN int yci_pair_side(int kind) { return kind == YCI_EDGE_EDGE ? 2 : 1; }

/* x are the positions of all nodes, three each. */
YC_FN double yci_pair_distance(const yci_pair *pair, const double *x, double *n, double *w) {
    const int *k = pair->node;
    const double *p = x + 3 * (size_t)k[0], *q = x + 3 * (size_t)k[1];
    if (pair->kind == YCI_POINT_POINT) return yci_closest_point_point(p, q, n, w);
    if (pair->kind == YCI_EDGE_EDGE)
        return yci_closest_edge_edge(p, q, x + 3 * (size_t)k[2], x + 3 * (size_t)k[3], n, w);
    return yci_closest_point_triangle(p, q, x + 3 * (size_t)k[2], x + 3 * (size_t)k[3], n, w);
}

/* ---- elements: energy returned, gradient g[3] and Hessian h[9] in x_rel ---- */

/* The penalty of distance d with gradient n (unit, or what yci_body_distance gave); *lambda is the normal force, N. */
YC_FN double yci_contact_normal(
    double d, const double *n, double thickness, double k, double *lambda, double *g, double *h) {
    double energy, slope, curvature;
    int i, j;
    yci_one_sided(thickness - d, YCI_CONTACT_SHARE * thickness, &energy, &slope, &curvature);
    *lambda = k * slope;
    for (i = 0; i < 3; i++) {
        g[i] = -k * slope * n[i];
        for (j = 0; j < 3; j++) h[3 * i + j] = k * curvature * n[i] * n[j];
    }
    return k * energy;
}

/* Friction of the displacement u with the lagged unit normal n; limit = mu lambda in N, eps > 0 the slip length. */
YC_FN double yci_contact_friction(const double *u, const double *n, double limit, double eps, double *g, double *h) {
    double t[3], slip, stiffness, across; /* `across`: what the Hessian lacks along the slip */
    int i, j;
    yci_copy(t, u);
    yci_axpy(t, -yci_dot(u, n), n);
    slip = yci_norm(t);
    stiffness = limit / yci_max(slip, eps);
    across = slip > eps ? stiffness / (slip * slip) : 0.0;
    for (i = 0; i < 3; i++) {
        g[i] = stiffness * t[i];
        for (j = 0; j < 3; j++) h[3 * i + j] = stiffness * ((i == j ? 1.0 : 0.0) - n[i] * n[j]) - across * t[i] * t[j];
    }
    return slip > eps ? limit * (slip - 0.5 * eps) : limit * slip * slip / (2.0 * eps);
}

/* Adds g and h of x_rel to the gradient (3 count) and the Hessian (3 count by 3 count, by rows) of the nodes. */
YC_FN void yci_contact_spread(
    int count, const double *w, const double *g, const double *h, double *gradient, double *hessian) {
    int i, j, r, s;
    for (i = 0; i < count; i++) {
        yci_axpy(gradient + 3 * i, w[i], g);
        for (j = 0; j < count; j++)
            for (r = 0; r < 3; r++)
                for (s = 0; s < 3; s++) hessian[(3 * i + r) * 3 * count + 3 * j + s] += w[i] * w[j] * h[3 * r + s];
    }
}

/* ---- how far a step may go ---- */

/* The largest t in (0, 1] with which t dx moves the two sides of no pair against each other by more than 0.4 of their
 * distance. So that pressed layers can move at all, 0.02 thickness is always allowed: a pair that is farther apart than
 * that cannot pass through, a nearer one is left to the penalty, which then is at its strongest. */
static double yci_pair_step_limit(const yci_pair *pair, int count, const double *x, const double *dx) {
    double limit = 1.0, n[3], w[4], u[3];
    int i, j, k;
    for (i = 0; i < count; i++) {
        int side = yci_pair_side(pair[i].kind), nodes = yci_pair_nodes(pair[i].kind);
        double allowed, fastest = 0.0;
        for (j = 0; j < side; j++)
            for (k = side; k < nodes; k++) {
                yci_sub(u, dx + 3 * (size_t)pair[i].node[j], dx + 3 * (size_t)pair[i].node[k]);
                fastest = yci_max(fastest, yci_dot(u, u));
            }
        fastest = sqrt(fastest) * limit;
        if (fastest <= 0.02 * pair[i].thickness) continue;
        allowed = yci_max(0.4 * yci_pair_distance(pair + i, x, n, w), 0.02 * pair[i].thickness);
        if (fastest > allowed) limit *= allowed / fastest;
    }
    return limit;
}

/* How far any node is from where it was: pairs found at `before` with margin m are complete while this is below m/2. */
static double yci_pairs_drift(int node_count, const double *before, const double *x) {
    double farthest = 0.0, u[3];
    int i;
    for (i = 0; i < node_count; i++) {
        yci_sub(u, x + 3 * (size_t)i, before + 3 * (size_t)i);
        farthest = yci_max(farthest, yci_dot(u, u));
    }
    return sqrt(farthest);
}

/* ---- broad phase ---- */

typedef struct {
    int node_count, triangle_count, edge_count, point_count;
    const double *x;               /* node_count x 3 */
    const int *triangle;           /* triangle_count x 3 nodes */
    const double *triangle_radius; /* m, half the thickness on either side */
    const int *edge;               /* edge_count x 2 nodes */
    const double *edge_radius;     /* m */
    const int *point;              /* point_count nodes */
    const double *point_radius;    /* m */
    const unsigned char *sphere;   /* point_count: not 0 where a point also meets other such points; NULL: nowhere */
    double margin;                 /* m: pairs up to this much beyond touching are found */
    int (*exclude)(void *user, const yci_pair *pair); /* not 0 leaves the pair out; pure, runs on any worker; or NULL */
    void *exclude_user;
} yci_pairs_input;

typedef struct {
    yci_pair *pair;
    int count, capacity;
} yci_pairs;

static void yci_pairs_free(yci_context *c, yci_pairs *pairs) {
    yci_free(c, pairs->pair);
    memset(pairs, 0, sizeof *pairs);
}

/* An `exclude`: leaves out what touches at rest already. `user` are the rest positions, doubles, three a node. */
static int yci_pairs_exclude_rest(void *user, const yci_pair *pair) {
    double n[3], w[4];
    return yci_pair_distance(pair, (const double *)user, n, w) < pair->thickness;
}

typedef struct {
    unsigned long long cell;
    int item;
} yci_grid_entry;

/* Boxes (lo, hi: six numbers each) in the cells they touch; entries of equal hash lie together, in order of items. */
typedef struct {
    int count, bits;
    const double *box;
    double origin[3], scale; /* cells per metre */
    int *start;              /* 2^bits + 1 */
    yci_grid_entry *entry;
} yci_grid;

#define YCI_GRID_CELLS 1048576.0 /* along one axis at most, so that three indices fit 63 bits */

/* Monotone in x, which is all that the query needs: what lies outside the grid is counted to its border. */
static int yci_grid_index(const yci_grid *grid, int axis, double x) {
    return (int)yci_clamp((x - grid->origin[axis]) * grid->scale, 0.0, YCI_GRID_CELLS);
}

static void yci_grid_range(const yci_grid *grid, const double *box, int *lo, int *hi) {
    int i;
    for (i = 0; i < 3; i++) lo[i] = yci_grid_index(grid, i, box[i]), hi[i] = yci_grid_index(grid, i, box[3 + i]);
}

static unsigned long long yci_grid_key(int x, int y, int z) {
    return ((unsigned long long)z << 42) | ((unsigned long long)y << 21) | (unsigned long long)x;
}

static size_t yci_grid_hash(const yci_grid *grid, unsigned long long key) {
    return (size_t)((key * 0x9e3779b97f4a7c15ull) >> (64 - grid->bits));
}

/* An empty box, of a point that takes no part. */
static int yci_grid_empty(const double *box) { return box[0] > box[3]; }

static double yci_grid_entries(const yci_grid *grid) {
    double sum = 0.0;
    int i, lo[3], hi[3];
    for (i = 0; i < grid->count; i++) {
        if (yci_grid_empty(grid->box + 6 * (size_t)i)) continue;
        yci_grid_range(grid, grid->box + 6 * (size_t)i, lo, hi);
        sum += (hi[0] - lo[0] + 1.0) * (hi[1] - lo[1] + 1.0) * (hi[2] - lo[2] + 1.0);
    }
    return sum;
}

/* Cells a little larger than the mean box; larger still while some boxes fill so many that entries were not linear. */
static void yci_grid_size(yci_grid *grid) {
    double hi[3] = {-YCI_FAR, -YCI_FAR, -YCI_FAR}, span = 0.0, mean = 0.0, cell;
    int i, j, used = 0;
    for (j = 0; j < 3; j++) grid->origin[j] = YCI_FAR;
    for (i = 0; i < grid->count; i++) {
        const double *box = grid->box + 6 * (size_t)i;
        double size = 0.0;
        if (yci_grid_empty(box)) continue;
        for (j = 0; j < 3; j++) {
            grid->origin[j] = yci_min(grid->origin[j], box[j]);
            hi[j] = yci_max(hi[j], box[3 + j]);
            size = yci_max(size, box[3 + j] - box[j]);
        }
        mean += size, used++;
    }
    for (j = 0; j < 3 && used; j++) span = yci_max(span, hi[j] - grid->origin[j]);
    cell = used ? yci_max(1.2 * mean / used, span / (0.5 * YCI_GRID_CELLS)) : 1.0;
    grid->scale = cell > 1e-100 ? 1.0 / cell : 1.0;
    while (yci_grid_entries(grid) > 32.0 * used + 64.0) grid->scale /= 1.5;
}

static void yci_grid_free(yci_context *c, yci_grid *grid) {
    yci_free(c, grid->start);
    yci_free(c, grid->entry);
}

/* Counting sort of (cell, item) by the cell's hash. Returns 0 when out of memory, with nothing left behind. */
static int yci_grid_build(yci_context *c, yci_grid *grid, const double *box, int count) {
    double entries;
    size_t size, h;
    int i, x, y, z, pass, lo[3], hi[3];
    memset(grid, 0, sizeof *grid);
    grid->count = count, grid->box = box;
    yci_grid_size(grid);
    entries = yci_grid_entries(grid);
    if (entries > 1e9) return 0;
    for (grid->bits = 4; (double)((size_t)1 << grid->bits) < entries; grid->bits++) {}
    size = (size_t)1 << grid->bits;
    grid->start = YCI_NEW(c, int, size + 1);
    grid->entry = YCI_NEW(c, yci_grid_entry, entries);
    if (!grid->start || !grid->entry) {
        yci_grid_free(c, grid);
        return 0;
    }
    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < count; i++) {
            if (yci_grid_empty(box + 6 * (size_t)i)) continue;
            yci_grid_range(grid, box + 6 * (size_t)i, lo, hi);
            for (z = lo[2]; z <= hi[2]; z++)
                for (y = lo[1]; y <= hi[1]; y++)
                    for (x = lo[0]; x <= hi[0]; x++) {
                        unsigned long long key = yci_grid_key(x, y, z);
                        h = yci_grid_hash(grid, key);
                        if (pass) {
                            yci_grid_entry *entry = grid->entry + grid->start[h]++;
                            entry->cell = key, entry->item = i;
                        } else grid->start[h + 1]++;
                    }
        }
        if (!pass)
            for (h = 0; h < size; h++) grid->start[h + 1] += grid->start[h];
    }
    memmove(grid->start + 1, grid->start, size * sizeof *grid->start); /* filling moved every start to the next one's */
    grid->start[0] = 0;
    return 1;
}

static int yci_boxes_overlap(const double *a, const double *b) {
    return a[0] <= b[3] && b[0] <= a[3] && a[1] <= b[4] && b[1] <= a[4] && a[2] <= b[5] && b[2] <= a[5];
}

/* One join: every query box against the boxes in the grid; the query of a self-join looks at later items only. */
typedef struct {
    const yci_pairs_input *in;
    int kind, grain, slots;
    const double *query;
    const yci_grid *grid;
    yci_pair *slot; /* `slots` per block */
    int *found;     /* per block: how many there are, also when they are more than the slots */
} yci_join;

static void yci_sort_nodes(int *k, int count) {
    int i, j, swap;
    for (i = 1; i < count; i++)
        for (j = i; j > 0 && k[j] < k[j - 1]; j--) swap = k[j], k[j] = k[j - 1], k[j - 1] = swap;
}

/* The pair of items i and j in canonical order, so that its distance has the same bits however the input is ordered:
 * nodes of a triangle or an edge ascend, and so do the edges or points. Returns 0 if it is none. */
static int yci_join_pair(const yci_pairs_input *in, int kind, int i, int j, yci_pair *pair) {
    double n[3], w[4];
    int *k = pair->node, side = yci_pair_side(kind), nodes = yci_pair_nodes(kind), r, s, swap;
    pair->kind = kind;
    if (kind == YCI_EDGE_EDGE) {
        memcpy(k, in->edge + 2 * (size_t)i, 2 * sizeof *k);
        memcpy(k + 2, in->edge + 2 * (size_t)j, 2 * sizeof *k);
        pair->thickness = in->edge_radius[i] + in->edge_radius[j];
    } else if (kind == YCI_POINT_POINT) {
        k[0] = in->point[i], k[1] = in->point[j], k[2] = k[3] = -1;
        pair->thickness = in->point_radius[i] + in->point_radius[j];
    } else {
        k[0] = in->point[i];
        memcpy(k + 1, in->triangle + 3 * (size_t)j, 3 * sizeof *k);
        pair->thickness = in->point_radius[i] + in->triangle_radius[j];
    }
    for (r = 0; r < side; r++)
        for (s = side; s < nodes; s++)
            if (k[r] == k[s]) return 0;
    yci_sort_nodes(k, side);
    yci_sort_nodes(k + side, nodes - side);
    if (kind != YCI_POINT_TRIANGLE && k[side] < k[0])
        for (r = 0; r < side; r++) swap = k[r], k[r] = k[side + r], k[side + r] = swap;
    return yci_pair_distance(pair, in->x, n, w) < pair->thickness + in->margin &&
        !(in->exclude && in->exclude(in->exclude_user, pair));
}

/* Two boxes may share several cells; they meet in the lowest one they share, and only there. */
static void yci_join_block(void *arg, int begin, int end) {
    const yci_join *join = (const yci_join *)arg;
    const yci_grid *grid = join->grid;
    yci_pair *slot = join->slot + (size_t)(begin / join->grain) * (size_t)join->slots, pair;
    int i, e, x, y, z, found = 0, lo[3], hi[3];
    for (i = begin; i < end; i++) {
        const double *box = join->query + 6 * (size_t)i;
        if (yci_grid_empty(box)) continue;
        yci_grid_range(grid, box, lo, hi);
        for (z = lo[2]; z <= hi[2]; z++)
            for (y = lo[1]; y <= hi[1]; y++)
                for (x = lo[0]; x <= hi[0]; x++) {
                    unsigned long long key = yci_grid_key(x, y, z);
                    size_t h = yci_grid_hash(grid, key);
                    for (e = grid->start[h + 1]; e-- > grid->start[h];) { /* items descend */
                        const double *other;
                        int j = grid->entry[e].item;
                        if (join->kind != YCI_POINT_TRIANGLE && j <= i) break;
                        if (grid->entry[e].cell != key) continue;
                        other = grid->box + 6 * (size_t)j;
                        if (!yci_boxes_overlap(box, other) || x != yci_grid_index(grid, 0, yci_max(box[0], other[0])) ||
                            y != yci_grid_index(grid, 1, yci_max(box[1], other[1])) ||
                            z != yci_grid_index(grid, 2, yci_max(box[2], other[2])))
                            continue;
                        if (!yci_join_pair(join->in, join->kind, i, j, &pair)) continue;
                        if (found < join->slots) slot[found] = pair;
                        found++;
                    }
                }
    }
    join->found[begin / join->grain] = found;
}

/* Boxes of `size`-node items, grown by radius and half the margin; items that `use` leaves out get an empty box. */
static double *yci_join_boxes(yci_context *c, const yci_pairs_input *in, const int *node, int size,
    const double *radius, const unsigned char *use, int count) {
    double *boxes = YCI_NEW(c, double, 6 * (size_t)count);
    int i, j, k;
    for (i = 0; boxes && i < count; i++) {
        double *box = boxes + 6 * (size_t)i, grow = radius[i] + 0.5 * in->margin;
        for (k = 0; k < 3; k++) box[k] = YCI_FAR, box[3 + k] = -YCI_FAR;
        for (j = 0; j < size && (!use || use[i]); j++)
            for (k = 0; k < 3; k++) {
                double at = in->x[3 * (size_t)node[(size_t)size * (size_t)i + (size_t)j] + (size_t)k];
                box[k] = yci_min(box[k], at - grow), box[3 + k] = yci_max(box[3 + k], at + grow);
            }
    }
    return boxes;
}

/* Runs a join and appends its pairs. Blocks write to slots of their own; should one need more, all run again. */
static yc_result yci_join_run(yci_context *c, yci_join *join, int queries, yci_pairs *out) {
    int i, most, total, blocks;
    yc_result result = YC_ERROR_MEMORY;
    join->grain = 256, join->slots = 8 * join->grain;
    blocks = (queries + join->grain - 1) / join->grain;
    join->found = YCI_NEW(c, int, blocks);
    for (join->slot = NULL; join->found;) {
        yci_free(c, join->slot);
        join->slot = YCI_NEW(c, yci_pair, (size_t)blocks * (size_t)join->slots);
        if (!join->slot) break;
        yci_parallel(c, queries, join->grain, yci_join_block, join);
        for (i = 0, most = 0, total = out->count; i < blocks && total >= 0; i++) {
            most = join->found[i] > most ? join->found[i] : most;
            total = join->found[i] > 0x3fffffff - total ? -1 : total + join->found[i];
        }
        if (total < 0) break;
        if (most > join->slots) {
            join->slots = most;
            continue;
        }
        if (!YCI_RESERVE(c, out->pair, out->capacity, out->count, total)) break;
        for (i = 0; i < blocks; i++) {
            const yci_pair *from = join->slot + (size_t)i * (size_t)join->slots;
            if (join->found[i]) memcpy(out->pair + out->count, from, (size_t)join->found[i] * sizeof *from);
            out->count += join->found[i];
        }
        result = YC_OK;
        break;
    }
    yci_free(c, join->slot);
    yci_free(c, join->found);
    return result;
}

static yc_result yci_pairs_join(yci_context *c, const yci_pairs_input *in, int kind, yci_pairs *out) {
    const unsigned char *use = kind == YCI_POINT_POINT ? in->sphere : NULL;
    const int *node = kind == YCI_EDGE_EDGE ? in->edge : in->point;
    const double *radius = kind == YCI_EDGE_EDGE ? in->edge_radius : in->point_radius;
    int count = kind == YCI_EDGE_EDGE ? in->edge_count : in->point_count;
    double *query, *box;
    yci_grid grid;
    yci_join join;
    yc_result result = YC_ERROR_MEMORY;
    if (!count || (kind == YCI_POINT_POINT && !use)) return YC_OK;
    if (kind == YCI_POINT_TRIANGLE && !in->triangle_count) return YC_OK;
    memset(&join, 0, sizeof join);
    query = box = yci_join_boxes(c, in, node, kind == YCI_EDGE_EDGE ? 2 : 1, radius, use, count);
    if (kind == YCI_POINT_TRIANGLE)
        box = yci_join_boxes(c, in, in->triangle, 3, in->triangle_radius, NULL, in->triangle_count);
    if (query && box && yci_grid_build(c, &grid, box, kind == YCI_POINT_TRIANGLE ? in->triangle_count : count)) {
        join.in = in, join.kind = kind, join.query = query, join.grid = &grid;
        result = yci_join_run(c, &join, count, out);
        yci_grid_free(c, &grid);
    }
    if (box != query) yci_free(c, box);
    yci_free(c, query);
    return result;
}

/* Total order by kind, nodes, and thickness from large to small. */
static int yci_pair_before(const yci_pair *a, const yci_pair *b) {
    int i;
    if (a->kind != b->kind) return a->kind < b->kind;
    for (i = 0; i < 4; i++)
        if (a->node[i] != b->node[i]) return a->node[i] < b->node[i];
    return a->thickness > b->thickness;
}

/* Merge sort from below, with scratch of the same size; the sorted list ends in `pair`. */
static void yci_pairs_sort(yci_pair *pair, yci_pair *scratch, int count) {
    yci_pair *from = pair, *to = scratch, *swap;
    int width, begin;
    for (width = 1; width < count; width = width < count / 2 ? 2 * width : count) {
        for (begin = 0; begin < count; begin += 2 * width) {
            int middle = width < count - begin ? begin + width : count;
            int end = width < count - middle ? middle + width : count, i = begin, j = middle, k = begin;
            for (; k < end; k++)
                to[k] = j >= end || (i < middle && !yci_pair_before(from + j, from + i)) ? from[i++] : from[j++];
            if (end == count) break;
        }
        swap = from, from = to, to = swap;
    }
    if (from != pair && count) memcpy(pair, from, (size_t)count * sizeof *pair);
}

/* Replaces *out by all pairs nearer than thickness + margin that share no node and are not excluded, sorted by kind and
 * nodes, each once. On failure *out is untouched. */
static yc_result yci_pairs_find(yci_context *c, const yci_pairs_input *in, yci_pairs *out) {
    yci_pairs found;
    yci_pair *scratch;
    size_t v;
    int kind, i, kept = 0;
    memset(&found, 0, sizeof found);
    for (v = 0; v < 3 * (size_t)in->node_count; v++)
        if (!yci_within(in->x[v], -1e100, 1e100))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "contact: position of node %d is %g", (int)(v / 3), in->x[v]);
    for (kind = YCI_POINT_TRIANGLE; kind <= YCI_POINT_POINT; kind++)
        if (yci_pairs_join(c, in, kind, &found)) break;
    scratch = kind > YCI_POINT_POINT ? YCI_NEW(c, yci_pair, found.count) : NULL;
    if (!scratch) {
        yci_pairs_free(c, &found);
        return yci_out_of_memory(c, "contact pairs");
    }
    yci_pairs_sort(found.pair, scratch, found.count);
    yci_free(c, scratch);
    for (i = 0; i < found.count; i++) {
        if (kept && !memcmp(found.pair[i].node, found.pair[kept - 1].node, sizeof found.pair[i].node) &&
            found.pair[i].kind == found.pair[kept - 1].kind)
            continue;
        found.pair[kept++] = found.pair[i];
    }
    found.count = kept;
    yci_pairs_free(c, out);
    *out = found;
    return YC_OK;
}

#undef YCI_GRID_CELLS

/* =====================================================================================================================
 * >>mixed   (chapter 9)
 *
 * MIX's enriched kinematics of the hybrid region: vertices v, yarn nodes p, barycentric weights B, displacements x.
 *
 *     p = B v + F x,   F = I - B_t G^-1 B_t',   G = B_t' B_t                                              (MIX 2, 3)
 *
 * B has a column for every vertex that moves a hybrid node. The filter acts on the set t of columns: free vertices that
 * the yarns cover well. A pinned vertex, and one with hardly any yarn under it, still moves p but is not filtered. So
 * F = F' = F F and B_t' F = 0, and (v, F x) and (p, v outside t) describe the same motion, one for one:
 *
 *     T: (p, v_rest) -> v_t = G^-1 B_t' (p - B_rest v_rest),   x = F (p - B_rest v_rest).
 *
 * All of it is constant and acts on one coordinate at a time: G is scalar, factored once, solved for x, y, z together.
 *
 * Mass preconditioner P = S M + I - S, S = diag(I, F), M = [Mv + B'Mp B, B'Mp; Mp B, Mp] with the free columns of B
 * (MIX 7, 8, 12). For a filtered residual z = P^-1 r is the filtered solution of S M z = r. With y = B z_v + z_x, the
 * velocity of the yarn nodes, its rows are
 *
 *     Mv z_v + B' Mp y = r_v,   F Mp y = r_x,   B_t' z_x = 0.
 *
 * The second says Mp y = r_x + B_t k for some k; put into the first, and into the third as B_t' y = B_t' B z_v:
 *
 *     [ Mv   H ] [ z_v ]   [ r_v - B' r_x   ]     H = B' B_t,   K = B_t' Mp^-1 B_t,
 *     [ H'  -K ] [  k  ] = [ B_t' Mp^-1 r_x ]     y = Mp^-1 (r_x + B_t k),   z_x = y - B z_v.
 *
 * This is sparse, symmetric and quasi-definite, as large as the vertices, and exact: no low-rank update is needed. The
 * right-hand side takes an unfiltered r_x too and gives the answer for F r_x. Vertex j of t brings the pivot pair
 * (k_j, z_j), so that none is singular even where Mv = 0 (all the mass on the yarns); outside t, Mv must be positive. A
 * vertex that moves no hybrid node has z = r / Mv; a pinned one has z = 0.
 *
 * The paper's own form (12)-(15), a dense LU of the low-rank update, is kept as reference. There I - S is multiplied by
 * the mean mass of a node: it cancels on filtered vectors, and with I (no unit) beside masses of 1e-8 kg the small
 * matrix would have condition 1e15.
 *
 * Vectors have 3 numbers per vertex or per hybrid node. Nodes in a row in the same triangle form a run, whose corners
 * are read once: numbering hybrid nodes along yarns or by triangle makes products fast. Objects hold their workspace:
 * each serves one thread at a time; products run in parallel inside. Nothing but create and factor can fail.
 * ===================================================================================================================== */

/* A free vertex leaves the filter when its diagonal of B'B is below YCI_MIXED_COVER of the median, or when its column
 * of B, scaled to length 1, is a combination of the others' but for sqrt(YCI_MIXED_RANK): nodes on one line, or fewer
 * nodes than vertices. What remains keeps B_t' F x below about 1e-12 |x|. */
#define YCI_MIXED_COVER 1e-3
#define YCI_MIXED_RANK 1e-8
#define YCI_MIXED_GRAIN 256 /* runs, or columns, in a block of a parallel loop */

typedef struct yci_mixed {
    yci_context *c;
    int vertex_count, hybrid_count;
    unsigned char *is_free; /* [vertex_count] */
    /* Columns of B: first the set t, then the other free vertices (badly covered: the caller should log their number,
     * free_count - t_count), then known ones. Each part in the vertices' order. */
    int t_count, free_count, column_count;
    int *vertex; /* [column_count] */
    int run_count;
    int *run;          /* [run_count + 1] first hybrid node of each run */
    int (*corner)[3];  /* [run_count] columns */
    double (*beta)[3]; /* [hybrid_count] */
    int *share_ptr;    /* [column_count + 1] */
    int *share;        /* the places 3 run + corner where a column occurs, ascending */
    double *partial;   /* [run_count][3 corners][3], sums of a run on their way to the columns */
    double *w;         /* [3][column_count], values on the columns, one coordinate after the other */
    yci_ldl *g;        /* NULL if t is empty */
    double *g_work;
} yci_mixed;

/* ---- products with B and B': everything else is made of these two ---- */

typedef struct {
    const yci_mixed *m;
    const double *in, *scale;
    double *out;
    double sign;
} yci_mixed_pass;

static void yci_mixed_corners(const yci_mixed *m, int run, double w[9]) {
    int a, k;
    for (a = 0; a < 3; a++)
        for (k = 0; k < 3; k++) w[3 * a + k] = m->w[k * m->column_count + m->corner[run][a]];
}

static void yci_mixed_spread_body(void *arg, int begin, int end) {
    const yci_mixed_pass *s = (const yci_mixed_pass *)arg;
    const yci_mixed *m = s->m;
    int run, i, k;
    for (run = begin; run < end; run++) {
        double w[9];
        yci_mixed_corners(m, run, w);
        for (i = m->run[run]; i < m->run[run + 1]; i++) {
            const double *b = m->beta[i];
            double f = s->scale ? s->scale[i] : 1.0;
            for (k = 0; k < 3; k++) {
                double sum = s->sign * (b[0] * w[k] + b[1] * w[3 + k] + b[2] * w[6 + k]);
                s->out[3 * i + k] = f * (s->in ? s->in[3 * i + k] + sum : sum);
            }
        }
    }
}

/* out = scale (in + sign B w), node by node; in NULL: 0, scale NULL: 1; out may be in. */
static void yci_mixed_spread(yci_mixed *m, const double *in, double sign, const double *scale, double *out) {
    yci_mixed_pass s;
    s.m = m, s.in = in, s.scale = scale, s.out = out, s.sign = sign;
    yci_parallel(m->c, m->run_count, YCI_MIXED_GRAIN, yci_mixed_spread_body, &s);
}

static void yci_mixed_partial_body(void *arg, int begin, int end) {
    const yci_mixed_pass *s = (const yci_mixed_pass *)arg;
    const yci_mixed *m = s->m;
    int run, i, k;
    for (run = begin; run < end; run++) {
        double w[9] = {0.0}, sum[9] = {0.0};
        if (s->sign != 0.0) yci_mixed_corners(m, run, w);
        for (i = m->run[run]; i < m->run[run + 1]; i++) {
            const double *b = m->beta[i];
            double f = s->scale ? s->scale[i] : 1.0;
            for (k = 0; k < 3; k++) {
                double x = s->in[3 * i + k];
                if (s->sign != 0.0) x += s->sign * (b[0] * w[k] + b[1] * w[3 + k] + b[2] * w[6 + k]);
                x *= f;
                sum[k] += b[0] * x, sum[3 + k] += b[1] * x, sum[6 + k] += b[2] * x;
            }
        }
        memcpy(s->out + 9 * (size_t)run, sum, sizeof sum);
    }
}

static void yci_mixed_collect_body(void *arg, int begin, int end) {
    const yci_mixed *m = (const yci_mixed *)arg;
    int column, e, k;
    for (column = begin; column < end; column++) {
        double sum[3] = {0.0, 0.0, 0.0};
        for (e = m->share_ptr[column]; e < m->share_ptr[column + 1]; e++)
            yci_add(sum, sum, m->partial + 3 * (size_t)m->share[e]);
        for (k = 0; k < 3; k++) m->w[k * m->column_count + column] = sum[k];
    }
}

/* w = B' (scale (in + sign B w)); sign 0 leaves the old w out. */
static void yci_mixed_collect(yci_mixed *m, const double *in, double sign, const double *scale) {
    yci_mixed_pass s;
    s.m = m, s.in = in, s.scale = scale, s.out = m->partial, s.sign = sign;
    yci_parallel(m->c, m->run_count, YCI_MIXED_GRAIN, yci_mixed_partial_body, &s);
    yci_parallel(m->c, m->column_count, YCI_MIXED_GRAIN, yci_mixed_collect_body, m);
}

/* w = v on the columns [begin, end), 0 elsewhere. */
static void yci_mixed_load(yci_mixed *m, const double *v, int begin, int end) {
    int i, k;
    for (i = 0; i < m->column_count; i++)
        for (k = 0; k < 3; k++) m->w[k * m->column_count + i] = i >= begin && i < end ? v[3 * m->vertex[i] + k] : 0.0;
}

/* w = G^-1 w on t, 0 elsewhere. */
static void yci_mixed_fit(yci_mixed *m) {
    int i, k;
    for (k = 0; k < 3; k++)
        for (i = m->t_count; i < m->column_count; i++) m->w[k * m->column_count + i] = 0.0;
    if (m->g) yci_ldl_solve(m->g, m->w, 3, m->column_count, m->g_work);
}

/* p = B v. */
static void yci_mixed_embed(yci_mixed *m, const double *v, double *p) {
    yci_mixed_load(m, v, 0, m->column_count);
    yci_mixed_spread(m, NULL, 1.0, NULL, p);
}

/* v += B' p, known vertices included: on these it is what the yarns pull with. */
static void yci_mixed_gather(yci_mixed *m, const double *p, double *v) {
    int i, k;
    yci_mixed_collect(m, p, 0.0, NULL);
    for (i = 0; i < m->column_count; i++)
        for (k = 0; k < 3; k++) v[3 * m->vertex[i] + k] += m->w[k * m->column_count + i];
}

/* x = F x. */
static void yci_mixed_filter(yci_mixed *m, double *x) {
    if (!m->g) return;
    yci_mixed_collect(m, x, 0.0, NULL);
    yci_mixed_fit(m);
    yci_mixed_spread(m, x, -1.0, NULL, x);
}

/* v_t = G^-1 B_t' (p - B_rest v_rest): the vertices of t that fit the yarns best, the others given in v. */
static void yci_mixed_project(yci_mixed *m, const double *p, double *v) {
    int i, k;
    if (!m->g) return;
    yci_mixed_load(m, v, m->t_count, m->column_count);
    yci_mixed_collect(m, p, m->t_count < m->column_count ? -1.0 : 0.0, NULL);
    yci_mixed_fit(m);
    for (i = 0; i < m->t_count; i++)
        for (k = 0; k < 3; k++) v[3 * m->vertex[i] + k] = m->w[k * m->column_count + i];
}

/* T in place: p becomes the filtered x, v on t becomes the fit; what v held on t does not matter. */
static void yci_mixed_split(yci_mixed *m, double *p, double *v) {
    yci_mixed_project(m, p, v);
    yci_mixed_load(m, v, 0, m->column_count);
    yci_mixed_spread(m, p, -1.0, NULL, p);
}

/* T' in place: x becomes p = F x + B_t G^-1 v_t; v_rest -= B_rest' p; v_t = 0. */
static void yci_mixed_split_transposed(yci_mixed *m, double *x, double *v) {
    int i, k;
    yci_mixed_collect(m, x, 0.0, NULL);
    for (i = 0; i < m->t_count; i++)
        for (k = 0; k < 3; k++) m->w[k * m->column_count + i] -= v[3 * m->vertex[i] + k], v[3 * m->vertex[i] + k] = 0.0;
    yci_mixed_fit(m);
    yci_mixed_spread(m, x, -1.0, NULL, x);
    if (m->t_count == m->column_count) return;
    yci_mixed_collect(m, x, 0.0, NULL);
    for (i = m->t_count; i < m->column_count; i++)
        for (k = 0; k < 3; k++) v[3 * m->vertex[i] + k] -= m->w[k * m->column_count + i];
}

/* v += diagonal of B' Mp B, scalars: one mass per hybrid node, one number per vertex. */
static void yci_mixed_mass_diagonal(const yci_mixed *m, const double *mp, double *v) {
    int run, i, a;
    for (run = 0; run < m->run_count; run++)
        for (i = m->run[run]; i < m->run[run + 1]; i++)
            for (a = 0; a < 3; a++) v[m->vertex[m->corner[run][a]]] += mp[i] * m->beta[i][a] * m->beta[i][a];
}

/* (out_v, out_x) = S M S (v, x), filtered mass (MIX 6); mv per vertex, mp per node. out_v may be v, out_x may be x. */
YC_FN void yci_mixed_mass_multiply(
    yci_mixed *m, const double *mv, const double *mp, const double *v, const double *x, double *out_v, double *out_x) {
    int i, k;
    if (out_x != x) memcpy(out_x, x, (size_t)m->hybrid_count * 3 * sizeof *x);
    yci_mixed_filter(m, out_x);
    yci_mixed_load(m, v, 0, m->free_count);
    yci_mixed_spread(m, out_x, 1.0, mp, out_x);
    yci_mixed_collect(m, out_x, 0.0, NULL);
    for (i = 0; i < m->vertex_count; i++)
        for (k = 0; k < 3; k++) out_v[3 * i + k] = m->is_free[i] ? mv[i] * v[3 * i + k] : 0.0;
    for (i = 0; i < m->free_count; i++)
        for (k = 0; k < 3; k++) out_v[3 * m->vertex[i] + k] += m->w[k * m->column_count + i];
    yci_mixed_filter(m, out_x);
}

/* The 3x3 sums of beta beta' over the nodes of a run, weighted if `scale` is given. */
static void yci_mixed_run_gram(const yci_mixed *m, int run, const double *scale, double sum[9]) {
    int i, a, b;
    memset(sum, 0, 9 * sizeof *sum);
    for (i = m->run[run]; i < m->run[run + 1]; i++)
        for (a = 0; a < 3; a++) {
            double f = scale ? scale[i] * m->beta[i][a] : m->beta[i][a];
            for (b = 0; b < 3; b++) sum[3 * a + b] += f * m->beta[i][b];
        }
}

/* A matrix with a block per column [0, n), dim[i] wide, and a block for each two of them that share a node; two columns
 * from `lonely` on are not coupled. */
static yc_result yci_mixed_pattern(const yci_mixed *m, int n, int lonely, const int *dim, yci_bsr *out) {
    int(*pair)[2] = (int(*)[2])yci_alloc(m->c, (size_t)m->run_count * 3, sizeof *pair);
    size_t count = 0;
    int run, a;
    yc_result result;
    if (!pair) return yci_out_of_memory(m->c, "the pairs of hybrid vertices");
    for (run = 0; run < m->run_count; run++)
        for (a = 0; a < 3; a++) {
            int i = m->corner[run][a], j = m->corner[run][(a + 1) % 3];
            if (i >= n || j >= n || (i >= lonely && j >= lonely)) continue;
            pair[count][0] = i, pair[count][1] = j, count++;
        }
    result = yci_bsr_create(m->c, n, dim, (const int(*)[2])pair, count, out);
    yci_free(m->c, pair);
    return result;
}

/* ---- creation ---- */

static int yci_mixed_compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* in_t[v] = 1 for the free vertices whose diagonal of B'B (zero where no node is) is not far below the median. */
static void yci_mixed_cover(const yci_mixed *m, const double *diagonal, double *sorted, unsigned char *in_t) {
    int v, count = 0;
    for (v = 0; v < m->vertex_count; v++)
        if (m->is_free[v] && diagonal[v] > 0.0) sorted[count++] = diagonal[v];
    if (!count) return;
    qsort(sorted, (size_t)count, sizeof *sorted, yci_mixed_compare);
    for (v = 0; v < m->vertex_count; v++)
        in_t[v] = m->is_free[v] && diagonal[v] > 0.0 && diagonal[v] >= YCI_MIXED_COVER * sorted[count / 2];
}

/* Numbers the columns. column[v] is -1 where a vertex has none, and otherwise its number. */
static void yci_mixed_number(yci_mixed *m, const unsigned char *in_t, int *column) {
    int part, v, n = 0;
    for (part = 0; part < 3; part++) {
        for (v = 0; v < m->vertex_count; v++)
            if (column[v] >= 0 && part == (in_t[v] ? 0 : m->is_free[v] ? 1 : 2)) m->vertex[n] = v, column[v] = n++;
        if (part == 0) m->t_count = n;
        if (part == 1) m->free_count = n;
    }
}

/* Lists, for every column, the places where runs have it. */
static void yci_mixed_shares(yci_mixed *m) {
    int e, *next = m->share_ptr + 1; /* next[i] runs from the start of i's places to their end, the start of i + 1's */
    memset(m->share_ptr, 0, (size_t)(m->column_count + 2) * sizeof *m->share_ptr);
    for (e = 0; e < 3 * m->run_count; e++) m->share_ptr[m->corner[e / 3][e % 3] + 2]++;
    for (e = 0; e < m->column_count; e++) next[e + 1] += next[e];
    for (e = 0; e < 3 * m->run_count; e++) m->share[next[m->corner[e / 3][e % 3]]++] = e;
}

/* Takes columns that depend on the others out of t: in_t becomes 0. Tried is D^-1/2 G D^-1/2 - YCI_MIXED_RANK I, D the
 * diagonal of G; the column at which it is not positive definite goes, and the rest is tried again. *gone receives how
 * many went. `scaled` is work of G's pattern. */
static yc_result yci_mixed_independent(
    yci_mixed *m, const yci_bsr *gram, double *scaled, const double *diagonal, unsigned char *in_t, int *gone) {
    int i, e, bad;
    if (!yci_ldl_room(m->g)) return yci_out_of_memory(m->c, "the kinematic filter");
    for (*gone = 0;; ++*gone) {
        for (i = 0; i < m->t_count; i++)
            for (e = gram->ptr[i]; e < gram->ptr[i + 1]; e++) {
                int v = m->vertex[i], u = m->vertex[gram->col[e]];
                if (u == v) scaled[e] = 1.0 - YCI_MIXED_RANK;
                else scaled[e] = in_t[v] && in_t[u] ? gram->val[e] / sqrt(diagonal[v] * diagonal[u]) : 0.0;
            }
        bad = yci_ldl_columns(m->g, scaled);
        if (bad < 0) return YC_OK;
        in_t[m->vertex[m->g->unknown[bad]]] = 0;
    }
}

/* Factors G, or, when columns of t depend on the others, takes them out of in_t and sets *gone. */
static yc_result yci_mixed_factor(yci_mixed *m, const double *diagonal, unsigned char *in_t, int *gone) {
    int *dim = YCI_NEW(m->c, int, m->t_count), i, run, e;
    double *scaled = NULL;
    yci_bsr gram;
    yc_result result;
    memset(&gram, 0, sizeof gram);
    if (!dim) return yci_out_of_memory(m->c, "the kinematic filter");
    for (i = 0; i < m->t_count; i++) dim[i] = 1;
    result = yci_mixed_pattern(m, m->t_count, m->t_count, dim, &gram);
    if (result == YC_OK) result = yci_ldl_analyze_bsr(m->c, &gram, NULL, 1, &m->g);
    if (result == YC_OK && !(scaled = YCI_NEW(m->c, double, gram.ptr[m->t_count])))
        result = yci_out_of_memory(m->c, "the kinematic filter");
    for (run = 0; result == YC_OK && run < m->run_count; run++) {
        double sum[9];
        yci_mixed_run_gram(m, run, NULL, sum);
        for (e = 0; e < 9; e++) {
            int a = m->corner[run][e / 3], b = m->corner[run][e % 3];
            if (a < m->t_count && b < m->t_count) gram.val[yci_bsr_find(&gram, a, b)] += sum[e];
        }
    }
    if (result == YC_OK) result = yci_mixed_independent(m, &gram, scaled, diagonal, in_t, gone);
    if (result == YC_OK && !*gone) result = yci_ldl_factor(m->g, gram.val);
    yci_free(m->c, dim), yci_free(m->c, scaled);
    yci_bsr_destroy(m->c, &gram);
    return result;
}

static void yci_mixed_destroy(yci_context *c, yci_mixed *m) {
    yci_free(c, m->is_free), yci_free(c, m->vertex), yci_free(c, m->run), yci_free(c, m->corner), yci_free(c, m->beta);
    yci_free(c, m->share_ptr), yci_free(c, m->share), yci_free(c, m->partial), yci_free(c, m->w);
    yci_free(c, m->g_work);
    yci_ldl_destroy(m->g);
    memset(m, 0, sizeof *m);
}

/* The part of creation that needs temporary arrays per vertex: the columns, the set t, the factor of G. */
static yc_result yci_mixed_build(
    yci_mixed *m, const int (*triangle)[3], double *diagonal, double *sorted, int *column, unsigned char *in_t) {
    int i, a, gone = 1;
    for (i = 0; i < m->vertex_count; i++) column[i] = -1;
    for (i = 0; i < m->hybrid_count; i++)
        for (a = 0; a < 3; a++) {
            int v = triangle[i][a];
            diagonal[v] += m->beta[i][a] * m->beta[i][a];
            if (column[v] < 0) column[v] = m->column_count++;
        }
    m->vertex = YCI_NEW(m->c, int, m->column_count);
    m->share_ptr = YCI_NEW(m->c, int, m->column_count + 2);
    m->w = YCI_NEW(m->c, double, 3 * (size_t)m->column_count);
    if (!m->vertex || !m->share_ptr || !m->w) return yci_out_of_memory(m->c, "the hybrid vertices");
    yci_mixed_cover(m, diagonal, sorted, in_t);
    while (gone) {
        yc_result result;
        yci_mixed_number(m, in_t, column);
        for (i = 0; i < m->run_count; i++)
            for (a = 0; a < 3; a++) m->corner[i][a] = column[triangle[m->run[i]][a]];
        yci_ldl_destroy(m->g);
        m->g = NULL;
        if (!m->t_count) break;
        result = yci_mixed_factor(m, diagonal, in_t, &gone);
        if (result != YC_OK) return result;
    }
    yci_mixed_shares(m);
    m->g_work = YCI_NEW(m->c, double, m->g ? yci_ldl_work(m->g, 3) : 0);
    return m->g_work ? YC_OK : yci_out_of_memory(m->c, "the kinematic filter");
}

/* vertex_state: 1 free, else its motion is known. Pinned yarn nodes must not be among the hybrid_count nodes: then the
 * filter and their pins commute. Everything is copied. On failure *out is empty, as it is after destroy. */
static yc_result yci_mixed_create(yci_context *c, int vertex_count, const unsigned char *vertex_state, int hybrid_count,
    const int (*triangle)[3], const double (*beta)[3], yci_mixed *out) {
    yci_mixed *m = out;
    double *diagonal = YCI_NEW(c, double, vertex_count), *sorted = YCI_NEW(c, double, vertex_count);
    int *column = YCI_NEW(c, int, vertex_count), i;
    unsigned char *in_t = YCI_NEW(c, unsigned char, vertex_count);
    yc_result result = YC_OK;
    memset(m, 0, sizeof *m);
    m->c = c, m->vertex_count = vertex_count, m->hybrid_count = hybrid_count;
    for (i = 0; i < hybrid_count; i++)
        m->run_count += !i || memcmp(triangle[i], triangle[i - 1], sizeof *triangle) != 0;
    m->is_free = YCI_NEW(c, unsigned char, vertex_count);
    m->run = YCI_NEW(c, int, m->run_count + 1);
    m->corner = (int(*)[3])yci_alloc(c, (size_t)m->run_count, sizeof *m->corner);
    m->beta = (double(*)[3])yci_alloc(c, (size_t)hybrid_count, sizeof *m->beta);
    m->share = YCI_NEW(c, int, 3 * (size_t)m->run_count);
    m->partial = YCI_NEW(c, double, 9 * (size_t)m->run_count);
    if (diagonal && sorted && column && in_t && m->is_free && m->run && m->corner && m->beta && m->share &&
        m->partial) {
        int run = 0;
        for (i = 0; i < vertex_count; i++) m->is_free[i] = vertex_state[i] == 1;
        for (i = 0; i < hybrid_count; i++)
            if (!i || memcmp(triangle[i], triangle[i - 1], sizeof *triangle) != 0) m->run[run++] = i;
        m->run[run] = hybrid_count;
        if (hybrid_count) memcpy(m->beta, beta, (size_t)hybrid_count * sizeof *beta);
        result = yci_mixed_build(m, triangle, diagonal, sorted, column, in_t);
    } else {
        result = yci_out_of_memory(c, "the embedding of the yarns");
    }
    yci_free(c, diagonal), yci_free(c, sorted), yci_free(c, column), yci_free(c, in_t);
    if (result != YC_OK) yci_mixed_destroy(c, m);
    return result;
}

/* ---- the masses that both preconditioners start from ---- */

typedef struct {
    yci_mixed *m;
    double *mv;         /* [vertex_count] */
    double *inverse_mp; /* [hybrid_count] */
} yci_mass;

static yc_result yci_mass_init(yci_mass *s, yci_mixed *m) {
    s->m = m;
    s->mv = YCI_NEW(m->c, double, m->vertex_count);
    s->inverse_mp = YCI_NEW(m->c, double, m->hybrid_count);
    return s->mv && s->inverse_mp ? YC_OK : yci_out_of_memory(m->c, "masses");
}

/* Takes the masses divided by `unit`. A free vertex outside t must have mass, and so must every hybrid node. */
static yc_result yci_mass_take(yci_mass *s, const double *mv, const double *mp, double unit) {
    const yci_mixed *m = s->m;
    int i;
    memcpy(s->mv, mv, (size_t)m->vertex_count * sizeof *mv);
    for (i = 0; i < m->t_count; i++) s->mv[m->vertex[i]] = 1.0;
    for (i = 0; i < m->vertex_count; i++)
        if (m->is_free[i] && !(s->mv[i] > 0.0))
            return YCI_FAIL(
                m->c, YC_ERROR_SINGULAR, "vertex %d is free, not carried by yarns, and has mass %g", i, mv[i]);
    for (i = 0; i < m->hybrid_count; i++)
        if (!(mp[i] > 0.0)) return YCI_FAIL(m->c, YC_ERROR_SINGULAR, "hybrid yarn node %d has mass %g", i, mp[i]);
    for (i = 0; i < m->vertex_count; i++) s->mv[i] = mv[i] / unit;
    for (i = 0; i < m->hybrid_count; i++) s->inverse_mp[i] = unit / mp[i];
    return YC_OK;
}

/* z = r / Mv on free vertices, 0 on known ones; those of B are then overwritten. */
static void yci_mass_untouched(const yci_mass *s, const double *r, double *z) {
    const yci_mixed *m = s->m;
    int i, k;
    for (i = 0; i < m->vertex_count; i++)
        for (k = 0; k < 3; k++) z[3 * i + k] = m->is_free[i] && s->mv[i] > 0.0 ? r[3 * i + k] / s->mv[i] : 0.0;
}

static void yci_mass_free(yci_context *c, yci_mass *s) { yci_free(c, s->mv), yci_free(c, s->inverse_mp); }

/* ---- P^-1 by the sparse quasi-definite system ---- */

typedef struct yci_mass_p {
    yci_mass mass;
    yci_bsr a;    /* a block per free column: (k, z) on t, z alone outside */
    int *target;  /* [run_count][9]: the block of A that a pair of corners adds to, or -1 */
    yci_ldl *ldl; /* NULL without hybrid nodes */
    double *x;    /* [3][order of A] */
    double *work;
} yci_mass_p;

static void yci_mass_destroy(yci_context *c, yci_mass_p *p) {
    yci_mass_free(c, &p->mass);
    yci_free(c, p->target), yci_free(c, p->x), yci_free(c, p->work);
    yci_bsr_destroy(c, &p->a);
    yci_ldl_destroy(p->ldl);
    memset(p, 0, sizeof *p);
}

static yc_result yci_mass_build(yci_mass_p *p, int *dim) {
    yci_mixed *m = p->mass.m;
    int i, a, b;
    yc_result result;
    if (!dim || !p->target) return yci_out_of_memory(m->c, "the mass preconditioner");
    for (i = 0; i < m->free_count; i++) dim[i] = i < m->t_count ? 2 : 1;
    result = yci_mixed_pattern(m, m->free_count, m->t_count, dim, &p->a);
    if (result != YC_OK || !m->free_count) return result;
    for (i = 0; i < m->run_count; i++)
        for (a = 0; a < 3; a++)
            for (b = 0; b < 3; b++) {
                int u = m->corner[i][a], v = m->corner[i][b];
                int coupled = u < m->free_count && v < m->free_count && (u < m->t_count || v < m->t_count);
                p->target[9 * i + 3 * a + b] = coupled ? yci_bsr_find(&p->a, u, v) : -1;
            }
    p->x = YCI_NEW(m->c, double, 3 * (size_t)p->a.off[p->a.n]);
    if (!p->x) return yci_out_of_memory(m->c, "the mass preconditioner");
    result = yci_ldl_analyze_bsr(m->c, &p->a, NULL, 0, &p->ldl);
    if (result != YC_OK) return result;
    p->work = YCI_NEW(m->c, double, yci_ldl_work(p->ldl, 3));
    return p->work ? YC_OK : yci_out_of_memory(m->c, "the mass preconditioner");
}

/* m must stay where it is while *out lives. */
static yc_result yci_mass_create(yci_context *c, yci_mixed *m, yci_mass_p *out) {
    int *dim = YCI_NEW(c, int, m->free_count);
    yc_result result;
    memset(out, 0, sizeof *out);
    out->target = YCI_NEW(c, int, 9 * (size_t)m->run_count);
    result = yci_mass_init(&out->mass, m);
    if (result == YC_OK) result = yci_mass_build(out, dim);
    yci_free(c, dim);
    if (result != YC_OK) yci_mass_destroy(c, out);
    return result;
}

/* Masses mv >= 0 per vertex (a pinned one's does not matter) and mp > 0 per hybrid node. After a failure nothing may be
 * applied until another factor succeeds. */
static yc_result yci_mass_factor(yci_mass_p *p, const double *mv, const double *mp) {
    yci_mixed *m = p->mass.m;
    yci_bsr *a = &p->a;
    int run, i, e;
    yc_result result = yci_mass_take(&p->mass, mv, mp, 1.0);
    if (result != YC_OK || !p->ldl) return result;
    yci_bsr_zero(a);
    for (run = 0; run < m->run_count; run++) {
        double h[9], k[9];
        yci_mixed_run_gram(m, run, NULL, h);
        yci_mixed_run_gram(m, run, p->mass.inverse_mp, k);
        for (e = 0; e < 9; e++) {
            int block = p->target[9 * run + e];
            double *value;
            if (block < 0) continue;
            value = a->val + a->at[block];
            if (m->corner[run][e / 3] < m->t_count && m->corner[run][e % 3] < m->t_count)
                value[0] -= k[e], value[1] += h[e], value[2] += h[e];
            else value[0] += h[e]; /* (k, z) against z alone: H in the row or column of k, the other entry is 0 */
        }
    }
    for (i = 0; i < m->free_count; i++)
        a->val[a->at[a->diag[i]] + (i < m->t_count ? 3 : 0)] += p->mass.mv[m->vertex[i]];
    return yci_ldl_factor(p->ldl, a->val);
}

/* (z_v, z_x) = P^-1 (r_v, r_x); z_v may be r_v, z_x may be r_x. r_x need not be filtered, z_x is. */
static void yci_mass_apply(yci_mass_p *p, const double *r_v, const double *r_x, double *z_v, double *z_x) {
    yci_mixed *m = p->mass.m;
    const int *off = p->a.off;
    int size = off[p->a.n], n = m->column_count, i, k;
    yci_mixed_collect(m, r_x, 0.0, NULL);
    for (k = 0; k < 3; k++)
        for (i = 0; i < m->free_count; i++)
            p->x[k * size + off[i + 1] - 1] = r_v[3 * m->vertex[i] + k] - m->w[k * n + i];
    yci_mass_untouched(&p->mass, r_v, z_v);
    yci_mixed_collect(m, r_x, 0.0, p->mass.inverse_mp);
    for (k = 0; k < 3; k++)
        for (i = 0; i < m->t_count; i++) p->x[k * size + off[i]] = m->w[k * n + i];
    if (p->ldl) yci_ldl_solve(p->ldl, p->x, 3, size, p->work);
    for (k = 0; k < 3; k++)
        for (i = 0; i < n; i++) m->w[k * n + i] = i < m->t_count ? p->x[k * size + off[i]] : 0.0;
    yci_mixed_spread(m, r_x, 1.0, p->mass.inverse_mp, z_x);
    for (i = 0; i < m->free_count; i++)
        for (k = 0; k < 3; k++) z_v[3 * m->vertex[i] + k] = p->x[k * size + off[i + 1] - 1];
    yci_mixed_load(m, z_v, 0, m->free_count);
    yci_mixed_spread(m, z_x, -1.0, NULL, z_x);
}

/* ---- P^-1 in the paper's form, for comparison ---- */

/* In units of the mean node mass, f = free_count columns B_f = (B_t, B_b), U = B_f' Mp B_f and M0 = diag(W, Mp):
 *
 *     P = M0 + U_P A_P V_P,   U_P = [0 0 1; B_t Mp B_f 0],   A_P = diag(G^-1, [0 1; 1 0]),
 *     V_P = [-U_t, B_t'(1 - Mp); 0, B_f' Mp; 1, 0],   W = Mv + U,   U_t the first t_count rows of U       (MIX 13-15)
 *     P^-1 = M0^-1 - M0^-1 U_P C^-1 V_P M0^-1,   C = A_P^-1 + V_P M0^-1 U_P,
 *
 *         [ K   H' - U_t   -U_t W^-1 ]
 *     C = [ H      U            1    ]        of order t_count + 2 free_count.
 *         [ 0      1          W^-1   ]
 */
typedef struct yci_mass_dense {
    yci_mass mass;
    double unit;  /* mean node mass */
    yci_bsr a;    /* W */
    yci_ldl *ldl; /* NULL without hybrid nodes */
    yc_lu *lu;
    double *small; /* C by rows; U is read from it later */
    double *x;     /* [3][order of C] */
    double *work;
} yci_mass_dense;

static void yci_mass_dense_destroy(yci_context *c, yci_mass_dense *p) {
    yci_mass_free(c, &p->mass);
    yci_bsr_destroy(c, &p->a);
    yci_ldl_destroy(p->ldl);
    yc_lu_destroy(p->lu);
    yci_free(c, p->small), yci_free(c, p->x), yci_free(c, p->work);
    memset(p, 0, sizeof *p);
}

static yc_result yci_mass_dense_build(yci_mass_dense *p, int *dim) {
    yci_mixed *m = p->mass.m;
    int i, n = m->t_count + 2 * m->free_count;
    yc_result result;
    p->x = YCI_NEW(m->c, double, 3 * (size_t)n);
    if (!dim || !p->x) return yci_out_of_memory(m->c, "the dense mass preconditioner");
    for (i = 0; i < m->free_count; i++) dim[i] = 1;
    result = yci_mixed_pattern(m, m->free_count, m->free_count, dim, &p->a);
    if (result != YC_OK || !m->free_count) return result;
    result = yci_ldl_analyze_bsr(m->c, &p->a, NULL, 1, &p->ldl);
    if (result != YC_OK) return result;
    result = yc_lu_create(&m->c->host, n, &p->lu);
    if (result != YC_OK) return YCI_FAIL(m->c, result, "no memory for a dense matrix of order %d", n);
    p->small = (double *)yci_alloc(m->c, (size_t)n, (size_t)n * sizeof(double));
    p->work = YCI_NEW(m->c, double, yci_ldl_work(p->ldl, m->free_count));
    return p->small && p->work ? YC_OK : yci_out_of_memory(m->c, "the dense mass preconditioner");
}

/* m must stay where it is while *out lives. */
static yc_result yci_mass_dense_create(yci_context *c, yci_mixed *m, yci_mass_dense *out) {
    int *dim = YCI_NEW(c, int, m->free_count);
    yc_result result;
    memset(out, 0, sizeof *out);
    result = yci_mass_init(&out->mass, m);
    if (result == YC_OK) result = yci_mass_dense_build(out, dim);
    yci_free(c, dim);
    if (result != YC_OK) yci_mass_dense_destroy(c, out);
    return result;
}

static yc_result yci_mass_dense_factor(yci_mass_dense *p, const double *mv, const double *mp) {
    yci_mixed *m = p->mass.m;
    int t = m->t_count, f = m->free_count, run, i, j, e;
    size_t n = (size_t)t + 2 * (size_t)f;
    double *c = p->small, unit = 0.0;
    yc_result result;
    for (i = 0; i < m->hybrid_count; i++) unit += mp[i] / m->hybrid_count;
    p->unit = unit > 0.0 ? unit : 1.0;
    result = yci_mass_take(&p->mass, mv, mp, p->unit);
    if (result != YC_OK || !p->ldl) return result;
    memset(c, 0, n * n * sizeof *c);
    yci_bsr_zero(&p->a);
    for (run = 0; run < m->run_count; run++) {
        double h[9], k[9], u[9];
        yci_mixed_run_gram(m, run, NULL, h);
        yci_mixed_run_gram(m, run, p->mass.inverse_mp, k);
        yci_mixed_run_gram(m, run, mp, u);
        for (e = 0; e < 9; e++) {
            size_t row = (size_t)m->corner[run][e / 3], column = (size_t)m->corner[run][e % 3];
            if (row >= (size_t)f || column >= (size_t)f) continue;
            u[e] /= p->unit;
            p->a.val[p->a.at[yci_bsr_find(&p->a, (int)row, (int)column)]] += u[e];
            c[((size_t)t + row) * n + (size_t)t + column] += u[e];
            if (column < (size_t)t) c[((size_t)t + row) * n + column] += h[e];
            if (row >= (size_t)t) continue;
            if (column < (size_t)t) c[row * n + column] += k[e];
            c[row * n + (size_t)t + column] += h[e] - u[e];
            c[row * n + (size_t)(t + f) + column] -= u[e];
        }
    }
    for (i = 0; i < f; i++) {
        p->a.val[p->a.at[p->a.diag[i]]] += p->mass.mv[m->vertex[i]];
        for (j = 0; j < 2; j++) c[(size_t)(t + f * j + i) * n + (size_t)(t + f * (1 - j) + i)] = 1.0;
        c[(size_t)(t + f + i) * n + (size_t)(t + f + i)] = 1.0; /* becomes W^-1, as -U_t becomes -U_t W^-1 */
    }
    result = yci_ldl_factor(p->ldl, p->a.val);
    if (result != YC_OK) return result;
    if (t) yci_ldl_solve(p->ldl, c + t + f, t, (int)n, p->work);
    yci_ldl_solve(p->ldl, c + (size_t)(t + f) * n + (size_t)(t + f), f, (int)n, p->work);
    result = yc_lu_factor(p->lu, c, (int)n);
    return result == YC_OK ? YC_OK : YCI_FAIL(m->c, result, "the dense mass preconditioner: %s", yc_lu_message(p->lu));
}

/* As yci_mass_apply for a filtered r_x; with an unfiltered one, P^-1 of the whole vector, z_x not filtered then. */
static void yci_mass_dense_apply(yci_mass_dense *p, const double *r_v, const double *r_x, double *z_v, double *z_x) {
    yci_mixed *m = p->mass.m;
    int t = m->t_count, f = m->free_count, n = t + 2 * f, columns = m->column_count, i, j, k;
    double *y_v = p->x + t + f; /* W^-1 r_v, the last part of V_P M0^-1 r, all of which is put together in x */
    for (k = 0; k < 3; k++)
        for (i = 0; i < f; i++) y_v[k * n + i] = r_v[3 * m->vertex[i] + k];
    if (p->ldl) yci_ldl_solve(p->ldl, y_v, 3, n, p->work);
    yci_mixed_collect(m, r_x, 0.0, p->mass.inverse_mp);
    for (k = 0; k < 3; k++)
        for (i = 0; i < t; i++) p->x[k * n + i] = m->w[k * columns + i];
    yci_mixed_collect(m, r_x, 0.0, NULL);
    for (k = 0; k < 3; k++) {
        for (i = 0; i < f; i++) p->x[k * n + t + i] = m->w[k * columns + i];
        for (i = 0; i < t; i++) {
            const double *u = p->small + (size_t)(t + i) * (size_t)n + t;
            p->x[k * n + i] -= m->w[k * columns + i];
            for (j = 0; j < f; j++) p->x[k * n + i] -= u[j] * y_v[k * n + j];
        }
    }
    if (p->lu) yc_lu_solve(p->lu, p->x, 3, n);
    for (k = 0; k < 3; k++)
        for (i = 0; i < columns; i++) m->w[k * columns + i] = i < t ? p->x[k * n + i] : 0.0;
    yci_mixed_spread(m, r_x, -1.0, p->mass.inverse_mp, z_x);
    for (k = 0; k < 3; k++)
        for (i = 0; i < columns; i++) m->w[k * columns + i] = i < f ? p->x[k * n + t + i] : 0.0;
    yci_mixed_spread(m, z_x, -1.0, NULL, z_x);
    for (k = 0; k < 3; k++)
        for (i = 0; i < f; i++) y_v[k * n + i] = r_v[3 * m->vertex[i] + k] - y_v[k * n + i];
    if (p->ldl) yci_ldl_solve(p->ldl, y_v, 3, n, p->work);
    yci_mass_untouched(&p->mass, r_v, z_v);
    for (i = 0; i < f; i++)
        for (k = 0; k < 3; k++) z_v[3 * m->vertex[i] + k] = y_v[k * n + i];
    for (i = 0; i < 3 * m->vertex_count; i++) z_v[i] /= p->unit;
    for (i = 0; i < 3 * m->hybrid_count; i++) z_x[i] /= p->unit;
}

/* =====================================================================================================================
 * >>solve   (chapter 10)
 *
 * One linear system A d = b per Newton iteration. A is the matrix of the scene's nodes, vertices v and yarn nodes p
 * alike, assembled in blocks of 3 + n unknowns. With hybrid nodes the unknowns are MIX's q = (v, x), p = B v + F x (MIX
 * 2), so
 *
 *     C' A C q = C' b,   C = (v, x, rest) -> (v, p = B v + F x, rest),                                    (MIX 10, 11)
 *
 * solved by conjugate gradients on vectors whose x is filtered (MPCG). Vectors in q keep the layout of A's: x_i sits
 * where p_i does. Without hybrid nodes C is the identity and a direct LDL^T serves.
 *
 * Two-level preconditioner. Fine level: independent increments (p, v outside the filter's set) carry the same motion as
 * q by the map T of chapter mixed, so M1 = T IC(A_pp)^-1 T', IC the incomplete factor of the yarn block in yarn order.
 * Coarse level: Z has a column triple per mesh vertex: v = 1, x = 0, full yarn nodes by their barycentric weights;
 * Ac = Z'AZ is factored. Q = Z Ac^-1 Z'. Applied as z = M1 r, z += Q (r - A z), from the start vector Q b; the triangle
 * region is thereby solved exactly on every iteration. The iteration stops when sqrt(r'z) has fallen to a share of its
 * start, which measures the error in the energy norm; a raw residual would not.
 *
 * In knits the incomplete factor counts for more than the coarse level, see yci_build_sweep. Iterations to 1e-4 in
 * stockinette of 6,700 nodes at 1 ms, and at 5 ms, without fill in the yarn's order: 74 to 155, over 500; wale by wale:
 * 20 to 61, 118; with one level of fill: 14 to 24, 58; with two: 9 to 11, 32, and 30 with 26,000 nodes. A
 * system of 26,000 nodes at 1 ms takes 0.27 s, by a direct factor 0.42 s.
 * ===================================================================================================================== */

typedef struct yci_system {
    yci_context *c;
    yci_bsr a;
    double *mass;    /* block diagonal of kinetic blocks, dim x dim at mass_at[node] */
    size_t *mass_at; /* [n + 1] */
    /* mixing; hybrid_count 0: none */
    int vertex_count, hybrid_count;
    int *vertex_node; /* [vertex_count], system node of a vertex; -1: pinned, or not in the mechanics */
    int *hybrid_node; /* [hybrid_count], system node */
    yci_mixed mixed;
    double *v, *p, *v2, *p2; /* vectors of chapter mixed, 3 per vertex and 3 per hybrid node */
    /* preconditioners, made when first needed */
    yc_solver solver;
    yci_ldl *direct;
    double *direct_work;
    yci_ic *ic;
    /* Coarse columns that move a system node, and by how much; a hybrid node's too: it follows B v, though in q it has
     * no share of its own. */
    int *support_ptr, *support_column;
    double *support_weight;
    unsigned char *is_hybrid, *is_yarn; /* [n] */
    double *mass_diagonal;
    int coarse_count;
    yci_bsr coarse;
    int *coarse_target; /* for each block of A on and above the diagonal: blocks of `coarse`, in the loops' order */
    yci_ldl *coarse_factor;
    yci_mass_p mass_p;
    yci_mass_dense mass_dense;
    double *work, *coarse_x, *coarse_work;
    double *cg;     /* four vectors */
    int indefinite; /* whether conjugate gradients have found the matrix not positive definite */
} yci_system;

static int yci_system_size(const yci_system *s) { return s->a.off[s->a.n]; }

/* ---- between A's layout and chapter mixed's ---- */

static void yci_system_take_vertices(const yci_system *s, const double *q, double *v) {
    int i;
    for (i = 0; i < s->vertex_count; i++) {
        int node = s->vertex_node[i];
        if (node >= 0) yci_copy(v + 3 * i, q + s->a.off[node]);
        else v[3 * i] = v[3 * i + 1] = v[3 * i + 2] = 0.0;
    }
}

static void yci_system_put_vertices(const yci_system *s, const double *v, double *q) {
    int i;
    for (i = 0; i < s->vertex_count; i++)
        if (s->vertex_node[i] >= 0) yci_copy(q + s->a.off[s->vertex_node[i]], v + 3 * i);
}

static void yci_system_take_hybrid(const yci_system *s, const double *q, double *p) {
    int i;
    for (i = 0; i < s->hybrid_count; i++) yci_copy(p + 3 * i, q + s->a.off[s->hybrid_node[i]]);
}

static void yci_system_put_hybrid(const yci_system *s, const double *p, double *q) {
    int i;
    for (i = 0; i < s->hybrid_count; i++) yci_copy(q + s->a.off[s->hybrid_node[i]], p + 3 * i);
}

/* y = C q, for filtered x. */
static void yci_system_expand(yci_system *s, const double *q, double *y) {
    int i, size = yci_system_size(s);
    if (y != q) memcpy(y, q, (size_t)size * sizeof *y);
    if (!s->hybrid_count) return;
    yci_system_take_vertices(s, q, s->v);
    yci_system_take_hybrid(s, q, s->p2);
    yci_mixed_embed(&s->mixed, s->v, s->p);
    for (i = 0; i < 3 * s->hybrid_count; i++) s->p[i] += s->p2[i];
    yci_system_put_hybrid(s, s->p, y);
}

/* r = C' y in place: what the yarns feel goes to the vertices, and, filtered, to x. */
static void yci_system_reduce(yci_system *s, double *y) {
    if (!s->hybrid_count) return;
    yci_system_take_vertices(s, y, s->v);
    yci_system_take_hybrid(s, y, s->p);
    yci_mixed_gather(&s->mixed, s->p, s->v);
    yci_mixed_filter(&s->mixed, s->p);
    yci_system_put_vertices(s, s->v, y);
    yci_system_put_hybrid(s, s->p, y);
}

/* y = C' A C q. */
static void yci_system_multiply(yci_system *s, const double *q, double *y) {
    yci_system_expand(s, q, s->work);
    yci_bsr_multiply(s->c, &s->a, s->work, y);
    yci_system_reduce(s, y);
}

/* ---- coarse level ---- */

/* out (coarse) = Z' r: hybrid nodes have no part in it, since Z's columns have x = 0. */
static void yci_system_restrict(const yci_system *s, const double *r, double *out) {
    int i, k;
    memset(out, 0, (size_t)(3 * s->coarse_count) * sizeof *out);
    for (i = 0; i < s->a.n; i++)
        if (!s->is_hybrid[i])
            for (k = s->support_ptr[i]; k < s->support_ptr[i + 1]; k++)
                yci_axpy(out + 3 * s->support_column[k], s->support_weight[k], r + s->a.off[i]);
}

/* q += Q r. */
static void yci_system_coarse_add(yci_system *s, const double *r, double *q) {
    int i, k;
    yci_system_restrict(s, r, s->coarse_x);
    yci_ldl_solve(s->coarse_factor, s->coarse_x, 1, 3 * s->coarse_count, s->coarse_work);
    for (i = 0; i < s->a.n; i++)
        if (!s->is_hybrid[i])
            for (k = s->support_ptr[i]; k < s->support_ptr[i + 1]; k++)
                yci_axpy(q + s->a.off[i], s->support_weight[k], s->coarse_x + 3 * s->support_column[k]);
}

/* Visits the blocks of A on and above the diagonal with the pairs of coarse columns that they couple. With `pairs` it
 * lists the pairs; else it finds the targets in the coarse matrix. Returns their number. */
static size_t yci_system_coarse_pairs(yci_system *s, int (*pairs)[2]) {
    size_t count = 0;
    int i, k, u, w;
    for (i = 0; i < s->a.n; i++)
        for (k = s->a.diag[i]; k < s->a.ptr[i + 1]; k++) {
            int j = s->a.col[k];
            for (u = s->support_ptr[i]; u < s->support_ptr[i + 1]; u++)
                for (w = s->support_ptr[j]; w < s->support_ptr[j + 1]; w++, count++) {
                    int a = s->support_column[u], b = s->support_column[w];
                    if (pairs) pairs[count][0] = a, pairs[count][1] = b;
                    else if (s->coarse_target) s->coarse_target[count] = yci_bsr_find(&s->coarse, a, b);
                }
        }
    return count;
}

/* Ac = Z'AZ from the 3x3 position parts of A's blocks; sliding coordinates stay local. Half of it is summed, which
 * those above the diagonal and half of the diagonal make, and its transpose added. A column with next to no stiffness
 * of its own (yarns missing under it) is held by a trace of its neighbours' diagonal. */
static void yci_system_coarse_assemble(yci_system *s) {
    size_t count = 0;
    double trace = 0.0;
    int i, k, u, w, r, t;
    yci_bsr_zero(&s->coarse);
    for (i = 0; i < s->a.n; i++)
        for (k = s->a.diag[i]; k < s->a.ptr[i + 1]; k++) {
            int j = s->a.col[k], stride = s->a.dim[j];
            const double *block = s->a.val + s->a.at[k];
            for (u = s->support_ptr[i]; u < s->support_ptr[i + 1]; u++)
                for (w = s->support_ptr[j]; w < s->support_ptr[j + 1]; w++, count++) {
                    double f = (i == j ? 0.5 : 1.0) * s->support_weight[u] * s->support_weight[w];
                    double *x = s->coarse.val + s->coarse.at[s->coarse_target[count]];
                    for (r = 0; r < 3; r++) {
                        const double *row = block + r * stride;
                        x[3 * r] += f * row[0], x[3 * r + 1] += f * row[1], x[3 * r + 2] += f * row[2];
                    }
                }
        }
    for (i = 0; i < s->coarse_count; i++)
        for (k = s->coarse.diag[i]; k < s->coarse.ptr[i + 1]; k++) {
            double *x = s->coarse.val + s->coarse.at[k];
            double *y = s->coarse.val + s->coarse.at[yci_bsr_find(&s->coarse, s->coarse.col[k], i)];
            for (r = 0; r < 3; r++)
                for (t = x == y ? r : 0; t < 3; t++) x[3 * r + t] = y[3 * t + r] = x[3 * r + t] + y[3 * t + r];
        }
    for (i = 0; i < s->coarse_count; i++)
        for (r = 0; r < 3; r++) trace += s->coarse.val[s->coarse.at[s->coarse.diag[i]] + (size_t)(4 * r)];
    trace *= 1e-10 / (3 * s->coarse_count);
    for (i = 0; i < s->coarse_count; i++)
        for (r = 0; r < 3; r++) {
            double *diagonal = s->coarse.val + s->coarse.at[s->coarse.diag[i]] + (size_t)(4 * r);
            if (*diagonal < trace) *diagonal += trace;
        }
}

/* ---- preconditioners ---- */

/* Node blocks of the mass, inverted, on the nodes that are neither vertices nor hybrid; the rest of z is untouched. */
static void yci_system_full_mass(const yci_system *s, const double *r, double *z) {
    int i;
    for (i = 0; i < s->a.n; i++) {
        double inverse[YCI_BLOCK_MAX * YCI_BLOCK_MAX];
        const double *m = s->mass + s->mass_at[i];
        int d = s->a.dim[i], a, b, o = s->a.off[i];
        if (s->is_hybrid[i] || !s->is_yarn[i]) continue;
        if (!yci_block_invert_spd(d, m, m, d + 1, inverse)) continue;
        for (a = 0; a < d; a++) {
            double sum = 0.0;
            for (b = 0; b < d; b++) sum += inverse[a * d + b] * r[o + b];
            z[o + a] = sum;
        }
    }
}

static void yci_system_mass_diagonal(yci_system *s, const double *r, double *z) {
    int i, k;
    memcpy(z, r, (size_t)yci_system_size(s) * sizeof *z);
    for (i = 0; i < s->a.n; i++)
        for (k = 0; k < s->a.dim[i]; k++) z[s->a.off[i] + k] /= s->mass_diagonal[s->a.off[i] + k];
    if (!s->hybrid_count) return;
    yci_system_take_hybrid(s, z, s->p);
    yci_mixed_filter(&s->mixed, s->p);
    yci_system_put_hybrid(s, s->p, z);
}

/* z = P^-1 r (MIX 12), by the sparse or by the dense form. */
static void yci_system_mass(yci_system *s, const double *r, double *z) {
    yci_system_take_vertices(s, r, s->v);
    yci_system_take_hybrid(s, r, s->p);
    if (s->solver == YC_SOLVER_MASS_DENSE) yci_mass_dense_apply(&s->mass_dense, s->v, s->p, s->v2, s->p2);
    else yci_mass_apply(&s->mass_p, s->v, s->p, s->v2, s->p2);
    yci_system_put_vertices(s, s->v2, z);
    yci_system_put_hybrid(s, s->p2, z);
    yci_system_full_mass(s, r, z);
}

/* M1: through T' to independent increments, the incomplete factor there, and back. */
static void yci_system_fine(yci_system *s, const double *r, double *z) {
    memcpy(z, r, (size_t)yci_system_size(s) * sizeof *z);
    if (s->hybrid_count) {
        yci_system_take_vertices(s, r, s->v);
        yci_system_take_hybrid(s, r, s->p);
        yci_mixed_split_transposed(&s->mixed, s->p, s->v);
        yci_system_put_vertices(s, s->v, z);
        yci_system_put_hybrid(s, s->p, z);
    }
    yci_ic_solve(s->ic, z);
    if (s->hybrid_count) {
        yci_system_take_vertices(s, z, s->v);
        yci_system_take_hybrid(s, z, s->p);
        yci_mixed_split(&s->mixed, s->p, s->v);
        yci_system_put_vertices(s, s->v, z);
        yci_system_put_hybrid(s, s->p, z);
    }
}

static void yci_system_two_level(yci_system *s, const double *r, double *z, double *rest) {
    int i, size = yci_system_size(s);
    yci_system_fine(s, r, z);
    yci_system_multiply(s, z, rest);
    for (i = 0; i < size; i++) rest[i] = r[i] - rest[i];
    yci_system_coarse_add(s, rest, z);
}

static void yci_system_precondition(yci_system *s, const double *r, double *z, double *rest) {
    switch (s->solver) {
    case YC_SOLVER_TWO_LEVEL: yci_system_two_level(s, r, z, rest); break;
    case YC_SOLVER_MASS:
    case YC_SOLVER_MASS_DENSE: yci_system_mass(s, r, z); break;
    case YC_SOLVER_MASS_DIAGONAL: yci_system_mass_diagonal(s, r, z); break;
    default: memcpy(z, r, (size_t)yci_system_size(s) * sizeof *z); break;
    }
}

static double yci_vector_dot(const double *a, const double *b, int n) {
    double sum = 0.0;
    int i;
    for (i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

static double yci_vector_largest(const double *a, int n) {
    double largest = 0.0;
    int i;
    for (i = 0; i < n; i++) largest = yci_max(largest, fabs(a[i]));
    return largest;
}

/* MPCG, until r'z has fallen by the square of `tolerance` or the preconditioner would move nothing by more than
 * `enough`. b in A's layout is spent; d, which may be b, receives the increment in A's layout (v, p); where the matrix
 * shows a direction of no curvature, as far as it came until then. Returns the iterations. */
static int yci_system_mpcg(yci_system *s, double *b, double *d, double tolerance, double enough, int limit) {
    int i, iteration, size = yci_system_size(s);
    double *q = s->cg, *z = q + size, *dir = z + size, *y = dir + size, *r = b, rz, start = 0.0;
    s->indefinite = 0;
    yci_system_reduce(s, r);
    memset(q, 0, (size_t)size * sizeof *q);
    if (s->solver == YC_SOLVER_TWO_LEVEL) {
        yci_system_coarse_add(s, r, q);
        start = yci_vector_dot(q, r, size);
        yci_system_multiply(s, q, y);
        for (i = 0; i < size; i++) r[i] -= y[i];
    }
    yci_system_precondition(s, r, z, y);
    memcpy(dir, z, (size_t)size * sizeof *dir);
    rz = yci_vector_dot(r, z, size);
    start += rz;
    for (iteration = 0; iteration < limit && rz > tolerance * tolerance * start && yci_vector_largest(z, size) > enough;
         iteration++) {
        double step, next, curvature;
        yci_system_multiply(s, dir, y);
        curvature = yci_vector_dot(dir, y, size);
        s->indefinite = !(curvature > 0.0);
        if (s->indefinite) break;
        step = rz / curvature;
        for (i = 0; i < size; i++) q[i] += step * dir[i], r[i] -= step * y[i];
        yci_system_precondition(s, r, z, y);
        next = yci_vector_dot(r, z, size);
        for (i = 0; i < size; i++) dir[i] = z[i] + next / rz * dir[i];
        rz = next;
    }
    yci_system_expand(s, q, d);
    return iteration;
}

/* d = A^-1 d by the direct factor. */
static void yci_system_direct(yci_system *s, double *d) {
    yci_ldl_solve(s->direct, d, 1, yci_system_size(s), s->direct_work);
}

/* About A^-1 r in A's layout, for a reduced r; returns 0 where no more than the mass is known of A^-1. */
static int yci_system_estimate(yci_system *s, const double *r, double *d) {
    if (s->solver == YC_SOLVER_DIRECT) {
        memcpy(d, r, (size_t)yci_system_size(s) * sizeof *d);
        yci_system_direct(s, d);
    } else if (s->solver == YC_SOLVER_TWO_LEVEL) {
        yci_system_two_level(s, r, d, s->cg);
        yci_system_expand(s, d, d);
    }
    return s->solver == YC_SOLVER_DIRECT || s->solver == YC_SOLVER_TWO_LEVEL;
}

/* ---- life of a system ---- */

static void yci_system_destroy(yci_system *s) {
    yci_context *c = s->c;
    if (!c) return;
    yci_bsr_destroy(c, &s->a);
    yci_free(c, s->mass), yci_free(c, s->mass_at), yci_free(c, s->mass_diagonal);
    yci_free(c, s->vertex_node), yci_free(c, s->hybrid_node);
    yci_mixed_destroy(c, &s->mixed);
    yci_free(c, s->v), yci_free(c, s->is_hybrid), yci_free(c, s->is_yarn);
    yci_ldl_destroy(s->direct), yci_free(c, s->direct_work), yci_ic_destroy(s->ic), yci_ldl_destroy(s->coarse_factor);
    yci_free(c, s->support_ptr), yci_free(c, s->support_column), yci_free(c, s->support_weight);
    yci_bsr_destroy(c, &s->coarse);
    yci_free(c, s->coarse_target), yci_free(c, s->coarse_x), yci_free(c, s->coarse_work);
    yci_mass_destroy(c, &s->mass_p), yci_mass_dense_destroy(c, &s->mass_dense);
    yci_free(c, s->work), yci_free(c, s->cg);
    memset(s, 0, sizeof *s);
}

/* What a scene says of its nodes. System nodes are those with unknowns. */
typedef struct yci_system_input {
    int n;
    const int *dim;       /* [n], 3 + sliding coordinates */
    const int (*pair)[2]; /* couplings */
    size_t pair_count;
    int vertex_count;
    const int *vertex_node;                   /* [vertex_count], system node or -1 */
    const unsigned char *vertex_state;        /* [vertex_count], 0 not in the mechanics, 1 free, 2 pinned */
    const unsigned char *is_yarn, *is_hybrid; /* [n] */
    const int (*triangle)[3];                 /* [n], for yarn nodes the vertices that carry them, or -1 first */
    const double (*beta)[3];                  /* [n] */
    const int *order;                         /* yarn nodes, as the incomplete factor has them */
    int order_count, fill;                    /* fill: levels of it there */
    yc_solver solver;
} yci_system_input;

/* Coarse columns: free vertices, and vertices under full yarns that are covered well enough to mean something. */
static yc_result yci_system_coarse_create(yci_system *s, const yci_system_input *in) {
    yci_context *c = s->c;
    int *column = YCI_NEW(c, int, in->vertex_count), i, k, total = 0, *dims = NULL;
    double *cover = YCI_NEW(c, double, in->vertex_count), mean = 0.0;
    int(*pairs)[2] = NULL;
    size_t count = 0;
    yc_result result = YC_ERROR_MEMORY;
    s->support_ptr = YCI_NEW(c, int, in->n + 1);
    if (!column || !cover || !s->support_ptr) goto done;
    for (i = 0; i < in->n; i++)
        for (k = 0; k < 3; k++)
            if (in->is_yarn[i] && in->triangle[i][0] >= 0) cover[in->triangle[i][k]] += in->beta[i][k] * in->beta[i][k];
    for (i = 0; i < in->vertex_count; i++) mean += cover[i], total += cover[i] > 0.0;
    mean /= total ? total : 1;
    for (i = 0; i < in->vertex_count; i++) {
        int used = in->vertex_state[i] == 1 || (in->vertex_state[i] == 0 && cover[i] > 1e-2 * mean);
        column[i] = used ? s->coarse_count++ : -1;
    }
    for (i = total = 0; i < in->n; i++) total += in->is_yarn[i] ? 3 : 1;
    s->support_column = YCI_NEW(c, int, total), s->support_weight = YCI_NEW(c, double, total);
    dims = YCI_NEW(c, int, s->coarse_count);
    if (!s->support_column || !s->support_weight || !dims) goto done;
    total = 0;
    for (i = 0; i < in->vertex_count; i++) /* support_ptr holds the vertex + 1 of a vertex node for a moment */
        if (in->vertex_node[i] >= 0) s->support_ptr[in->vertex_node[i]] = i + 1;
    for (i = 0; i < in->n; i++) {
        int vertex = s->support_ptr[i] - 1;
        s->support_ptr[i] = total;
        if (!in->is_yarn[i] && column[vertex] >= 0)
            s->support_column[total] = column[vertex], s->support_weight[total++] = 1.0;
        for (k = 0; k < 3 && in->is_yarn[i] && in->triangle[i][0] >= 0; k++)
            if (column[in->triangle[i][k]] >= 0 && in->beta[i][k] != 0.0)
                s->support_column[total] = column[in->triangle[i][k]], s->support_weight[total++] = in->beta[i][k];
    }
    s->support_ptr[in->n] = total;
    for (i = 0; i < s->coarse_count; i++) dims[i] = 3;
    count = yci_system_coarse_pairs(s, NULL);
    pairs = (int(*)[2])yci_alloc(c, count, sizeof *pairs);
    if (!pairs) goto done;
    yci_system_coarse_pairs(s, pairs);
    result = yci_bsr_create(c, s->coarse_count, dims, (const int(*)[2])pairs, count, &s->coarse);
    if (result != YC_OK) goto done;
    result = YC_ERROR_MEMORY;
    s->coarse_target = YCI_NEW(c, int, count);
    if (!s->coarse_target) goto done;
    yci_system_coarse_pairs(s, NULL);
    result = yci_ldl_analyze_bsr(c, &s->coarse, NULL, 1, &s->coarse_factor);
    if (result != YC_OK) goto done;
    s->coarse_x = YCI_NEW(c, double, 3 * s->coarse_count);
    s->coarse_work = YCI_NEW(c, double, yci_ldl_work(s->coarse_factor, 1));
    if (!s->coarse_x || !s->coarse_work) result = YC_ERROR_MEMORY;
done:
    yci_free(c, column), yci_free(c, cover), yci_free(c, dims), yci_free(c, pairs);
    return result;
}

static yc_result yci_system_mixed_create(yci_system *s, const yci_system_input *in) {
    yci_context *c = s->c;
    int i, h = s->hybrid_count, *triangle = YCI_NEW(c, int, 3 * h);
    double *beta = YCI_NEW(c, double, 3 * h);
    yc_result result = YC_ERROR_MEMORY;
    if (triangle && beta) {
        for (i = 0; i < h; i++) {
            memcpy(triangle + 3 * i, in->triangle[s->hybrid_node[i]], sizeof in->triangle[0]);
            memcpy(beta + 3 * i, in->beta[s->hybrid_node[i]], sizeof in->beta[0]);
        }
        result = yci_mixed_create(
            c, in->vertex_count, in->vertex_state, h, (const int(*)[3])triangle, (const double(*)[3])beta, &s->mixed);
    }
    yci_free(c, triangle), yci_free(c, beta);
    return result;
}

static yc_result yci_system_parts(yci_system *s, const yci_system_input *in) {
    yci_context *c = s->c;
    int i, size;
    yc_result result = yci_bsr_create(c, in->n, in->dim, in->pair, in->pair_count, &s->a);
    if (result != YC_OK) return result;
    size = yci_system_size(s);
    s->mass_at = YCI_NEW(c, size_t, in->n + 1);
    s->vertex_node = YCI_NEW(c, int, in->vertex_count), s->hybrid_node = YCI_NEW(c, int, in->n);
    s->is_hybrid = YCI_NEW(c, unsigned char, in->n), s->is_yarn = YCI_NEW(c, unsigned char, in->n);
    if (!s->mass_at || !s->vertex_node || !s->hybrid_node || !s->is_hybrid || !s->is_yarn) return YC_ERROR_MEMORY;
    for (i = 0; i < in->n; i++) s->mass_at[i + 1] = s->mass_at[i] + (size_t)(in->dim[i] * in->dim[i]);
    s->mass = YCI_NEW(c, double, s->mass_at[in->n]);
    if (!s->mass) return YC_ERROR_MEMORY;
    memcpy(s->vertex_node, in->vertex_node, (size_t)in->vertex_count * sizeof(int));
    for (i = 0; i < in->n; i++) {
        s->is_hybrid[i] = in->is_hybrid[i], s->is_yarn[i] = in->is_yarn[i];
        if (in->is_hybrid[i]) s->hybrid_node[s->hybrid_count++] = i;
    }
    if (s->solver == YC_SOLVER_DIRECT) {
        result = yci_ldl_analyze_bsr(c, &s->a, NULL, 1, &s->direct);
        if (result != YC_OK) return result;
        s->direct_work = YCI_NEW(c, double, yci_ldl_work(s->direct, 1));
        return s->direct_work ? YC_OK : YC_ERROR_MEMORY;
    }
    s->work = YCI_NEW(c, double, size), s->cg = YCI_NEW(c, double, 4 * size);
    s->v = YCI_NEW(c, double, 6 * (in->vertex_count + s->hybrid_count)), s->mass_diagonal = YCI_NEW(c, double, size);
    if (!s->work || !s->cg || !s->v || !s->mass_diagonal) return YC_ERROR_MEMORY;
    s->v2 = s->v + 3 * in->vertex_count, s->p = s->v2 + 3 * in->vertex_count, s->p2 = s->p + 3 * s->hybrid_count;
    result = yci_system_mixed_create(s, in);
    if (result == YC_OK && s->solver == YC_SOLVER_MASS) result = yci_mass_create(c, &s->mixed, &s->mass_p);
    if (result == YC_OK && s->solver == YC_SOLVER_MASS_DENSE)
        result = yci_mass_dense_create(c, &s->mixed, &s->mass_dense);
    if (result != YC_OK || s->solver != YC_SOLVER_TWO_LEVEL) return result;
    result = yci_ic_create(c, &s->a, in->order, in->order_count, in->fill, &s->ic);
    return result == YC_OK ? yci_system_coarse_create(s, in) : result;
}

/* On failure *s is zeroed. */
static yc_result yci_system_create(yci_context *c, const yci_system_input *in, yci_system *s) {
    yc_result result;
    memset(s, 0, sizeof *s);
    s->c = c, s->solver = in->solver, s->vertex_count = in->vertex_count;
    result = yci_system_parts(s, in);
    if (result != YC_OK) {
        if (result == YC_ERROR_MEMORY) yci_out_of_memory(c, "the linear system");
        yci_system_destroy(s);
    }
    return result;
}
/* Takes this iteration's matrix and masses into the preconditioners. */
static yc_result yci_system_factor(yci_system *s) {
    int i, k;
    if (s->solver == YC_SOLVER_DIRECT) return yci_ldl_factor(s->direct, s->a.val);
    if (s->solver == YC_SOLVER_TWO_LEVEL) {
        yc_result result = yci_ic_factor(s->ic, &s->a);
        if (result != YC_OK) return result;
        yci_system_coarse_assemble(s);
        return yci_ldl_factor(s->coarse_factor, s->coarse.val);
    }
    if (s->solver == YC_SOLVER_NONE) return YC_OK;
    for (i = 0; i < s->vertex_count; i++) {
        int node = s->vertex_node[i];
        s->v[i] = node >= 0 ? s->mass[s->mass_at[node]] : 0.0;
    }
    for (i = 0; i < s->hybrid_count; i++) s->p[i] = s->mass[s->mass_at[s->hybrid_node[i]]];
    if (s->solver == YC_SOLVER_MASS_DIAGONAL) {
        for (i = 0; i < s->a.n; i++)
            for (k = 0; k < s->a.dim[i]; k++)
                s->mass_diagonal[s->a.off[i] + k] = s->mass[s->mass_at[i] + (size_t)(k * (s->a.dim[i] + 1))];
        yci_mixed_mass_diagonal(&s->mixed, s->p, s->v); /* Mv + diag of B' Mp B */
        for (i = 0; i < s->vertex_count; i++)
            if (s->vertex_node[i] >= 0)
                for (k = 0; k < 3; k++) s->mass_diagonal[s->a.off[s->vertex_node[i]] + k] = s->v[i];
        return YC_OK;
    }
    if (s->solver == YC_SOLVER_MASS_DENSE) return yci_mass_dense_factor(&s->mass_dense, s->v, s->p);
    return yci_mass_factor(&s->mass_p, s->v, s->p);
}

/* =====================================================================================================================
 * >>scene   (chapter 11)
 *
 * What the user holds. A scene numbers the vertices of all cloths first and their yarn nodes behind them: one array of
 * positions x and velocities, one of sliding coordinates u. Those arrays, with anchors, pins, poses and time, are the
 * state; all else is the model: roles of nodes, elements, masses and the linear system, built from the descriptors and
 * thrown away when the topology changes (something added, pinned, welded).
 *
 * Step (MIX 4.3, as a minimisation). Backward Euler from q_n, v_n over h finds the minimum of
 *
 *     E(q) = 1/(2h^2) |q - q_n - h v_n|^2_M + c/(2h) |q - q_n|^2_M + V(q),   v = (q - q_n)/h,
 *
 * c the mass damping, M the mass at q_n (its derivative is dropped, as in MIX 4.2), V all elastic, gravity, damping,
 * contact and friction terms; friction and compression are lagged: their normal forces are those of q_n. A sub-step
 * ends no higher in E than it began, so any step size stays finite; one that fails is restored and halved. A user's
 * step is bounded: with more iterations than newton_limit times its planned sub-steps and YCI_RETRIES, the next failure
 * is its own.
 *
 * Newton, with positive semidefinite element Hessians. Where a stiff segment of length l turns by a, the linear step
 * makes it longer by l a^2 / 2, and the tension of that, were it let into the Hessian, would all but forbid to turn any
 * further: each iteration would move by a small angle. So tension is an unknown of its own, T = k (l/du - 1), and
 * Newton's method is that of the pair (q, T): eliminating T leaves the same gradient and the same matrix, but for the
 * transverse stiffness T/l, whose T is the one that the last linear step predicted (the mixed form of Trusty, Kaufman
 * and Levin 2022; the stress of triangles likewise), and but for the rows of u, where the strain is T/k instead of
 * l/du - 1: what a pin has just stretched then does not push the crossing next to it along the yarn, a way that costs
 * nothing, by its whole energy. Friction that slips is treated alike, the share of its limit being the unknown; line
 * searches take the parabola. Whole steps are taken, whatever E does on the way; when the lowest E has stood for some
 * iterations, line searches do the rest from there. They do so as well once a direction takes more of a segment's rest
 * length than there is: a compressed segment between crossings that slide loses energy by getting shorter, in the
 * linear model without end, and a few whole steps leave it no length. Measured on a 4 cm flap of 1,600 crossings that
 * swings down at 5 ms a step: 2.8 iterations a step, 14.6 with line searches alone; on a yarn drawn over posts 6
 * instead of 73 with the parabola throughout.
 *
 * Line searches keep the predicted tension in the Hessian, not in the gradient, which is that of E. A turn by a makes
 * a stiff segment longer by l a^2 / 2, so that E falls over short ways only: where a share t of the direction fails,
 * the tension there that the linear model lacks, taken along the yarn as it lay, is put to the factor at hand, and
 * what that moves is added (the second-order correction of constrained optimisation, Nocedal and Wright, ch. 15). Of a
 * share t next tension is t times the predicted one and the rest the state's own. Stockinette of 14 x 14 let go, with
 * this and the next paragraph: 337 iterations and no rejected sub-step instead of 1,635 and 27. newton_limit is far
 * off, since halving a step that is on its way starts it again: over wide ranges of a satin, whose crossings snap one
 * after the other, 5,600 iterations, and 9,900 where corrections had to fall by half within 40.
 *
 * Cloth that buckles has a mode whose stiffness is negative or a small difference, of which a positive semidefinite
 * Hessian knows nothing: kinks of satin between crossings that slide have six times the stiffness that way, and
 * corrections creep. Where they have not fallen by half three times, a quarter of the part that makes elements
 * semidefinite is kept, then a quarter of that, at last none; where there is no factor the share rises fourfold, and
 * falls again after half as many more iterations, twelve at most. The added part is a shift by what the elements
 * themselves lack. The two levels tell likewise: their matrix has none where conjugate gradients find a direction of no
 * curvature, or the incomplete factor needs more than a small shift. Not with hybrid nodes.
 *
 * Yarn that slides without friction, and long steps leave it no inertia, has modes that cost less than E's rounding:
 * the matrix has no factor, or corrections are what rounding makes of them, without end. Then, and where the linear
 * model promises a fall of less than 1e-15 of E's terms, sliding is made stiffer by 1e-9 of the matrix's diagonal, at
 * most 1e-6: E and its gradient stay, the mode stays where it is.
 *
 * Small steps of yarns without crimp begin where the last one points to. After a sub-step that three whole steps at
 * most have ended, the next begins at free flight, q_n + h v_n, unless E is higher there than at q_n, and with the
 * tension it left: by one further linear step that is right, while k times the strain of a state that is right to
 * its tolerance only is not (k of 1 N per 1e-4: a turn by 1e-2 makes half a newton). What such a start does not decide
 * by whole steps is begun again at q_n with the state's own tension, and so is all else: what follows a failure, line
 * searches or a new model. A step of at most ten tolerances is the last one if the next, by the factor at hand, is
 * below a tenth of one. That factor, and the correction itself, would tell nothing where tension has just gone that
 * held its segment: if T falls by dT while the segment turns its ends by e against each other, dT e / l is left out,
 * against which the inertia rho l / h^2 is sure to stand. Where that is more than the tolerance another iteration
 * follows, unless the tension has no more than halved. Conjugate gradients may stop once the preconditioner moves
 * nothing by more than a hundredth of the tolerance. Measured on a flap of 5,000 crossings at 1 ms a step: 1.05 Newton
 * and 5.0 linear iterations a step instead of 2.15 and 20, the drop of its edge off by 0.0012 % instead of 0.008 %.
 * With crimp, where cloth buckles between its crossings, that cost more than it saved (over wide ranges of stiffness
 * 9.9 iterations a sub-step instead of 9.4; without crimp 3.6 instead of 4.0), and with triangles stress would have to
 * be watched like tension: there nothing is kept.
 *
 * Knits (YARN 3 and 4). A node has as many sliding coordinates as yarns. A stitch contact has two wrapped pairs, the
 * old leg below A with the new one above B and the new foot at A with the old head at B, each at rest a quarter turn
 * from flat, and keeps its length of yarn; nothing turns or shears there. Yarn jams when it turns by more than a right
 * angle, and turns by visit_turn at rest: a piece whose yarn would rather be straight has a moment in every loop and
 * buckles. Every segment has a floor under its length; outside of stitch contacts its ends resist, by k_c, when they
 * come closer than two yarns that lie side by side. A stack has one normal; its yarns press each other by stretch,
 * bending and wrapping. The new loop of a stack and the old one next to it are anchored each by itself, further old
 * ones by what they slide past their neighbour. Wrapping has no stiffness damping. What comes undone is listed with
 * the model, see yci_due: a persistent contact ends when the yarn that keeps it has gone (YARN 5.2.4), and a node of n
 * yarns becomes up to n nodes of one, in the same place. A knit that has lost all its contacts stays one.
 *
 * Blending (MIX 4.1). An element's weight is alpha (yarn) or 1 - alpha (triangle) at its centroid; values in (0, 0.01]
 * are raised to 0.01. A segment's mass goes to its nodes by alpha and to the vertices by 1 - alpha, so the total is the
 * layout's for any alpha.
 *
 * Crimp. Where visit_height is given, every crossing of full nodes has one more unknown, z: both its yarns touch, so
 * they move along the contact's normal together, to heights y = layer height + z. Pulling a yarn straightens it and
 * presses the crossing ones into waves: crimp interchange. z is a scalar, so that rigid motion leaves it alone, and has
 * the inertia (1/2) m z'^2 of its node, the part of both yarns' kinetic energy that is transverse (the product with
 * x', which alternates along a yarn, is left out). Lone visits and rods lie at height 0; z is held at hybrid and at
 * pinned nodes. Yarns that flatten have a z each, the mass of each its own, and the energy of flattening between them.
 *
 * Pressure lambda of a crossing's yarns on each other, >= 0, lagged: preload, and what the state adds. With crimp that
 * is half of what the elements of the upper yarn push it down with and those of the lower one up, -dV/dy of each alone
 * (both are equal where z is free and at rest); without, it is as in chapter yarn (YARN 4.3). It bounds the friction of
 * sliding (YARN 4.4), mu lambda, and that of turning: each of the four pairs of neighbouring segments has a quarter of
 * a spring k_f rho^2 and of its limit mu lambda (2/3) rho, rho the mean radius.
 * ===================================================================================================================== */

/* ---- what is held ---- */

typedef struct yci_cloth {
    yc_cloth_desc desc; /* its arrays are copies in the one block `memory` */
    void *memory;
    yc_yarns yarns;  /* as it is now, in the block `owner`. visit_u is not the state: where it was laid what is there */
    yc_yarns kept;   /* what it was when the user's step began; owner NULL: the same */
    double pitch[3]; /* m, mean distance of neighbouring crossings, by family, as given */
    int knit;        /* whether it was given with stitch contacts: it may lose them all */
    int laid_nodes, laid_visits;       /* as given; nodes from laid_nodes on are made by events */
    int vertex, node, visit, triangle; /* first of each in the scene */
} yci_cloth;

typedef struct yci_seam {
    yc_seam_desc desc;
    int *a, *b;        /* points of their cloths; one block, from a */
    double gap, start; /* m, largest distance of a pair when the seam was added, and s, when that was */
} yci_seam;

/* Roles of a scene node. */
enum { YCI_IDLE, YCI_TRIANGLE, YCI_FULL, YCI_HYBRID };

/* Elements. Weights are alpha or 1 - alpha, already multiplied into stiffness where there is one; `previous` is the
 * strain at the step's start; tension, stress and what share of its limit friction has (0: none is known) are those
 * that Newton's last direction predicted; `floor` is the distance below which a segment with crimp no longer stands up;
 * `excess` is the tension that a trial of the line search has and its linear model had not.
 */
typedef struct yci_segment {
    int a, b;
    double stretch, density, previous, tension, floor, excess;
} yci_segment; /* a, b, c: visits */
typedef struct yci_bend {
    int a, b, c;
    double stiffness, rest, jam, previous;
} yci_bend;
typedef struct yci_kink {
    int a, b, c;
    double stiffness, rest, previous;
} yci_kink;
/* Of the lower and the upper visit at a crossing: rest is their distance at rest. */
typedef struct yci_flatten {
    int a, b;
    double stiffness, rest, depth, previous;
} yci_flatten;
typedef struct yci_shear {
    int node[3];
    double stiffness, length, rest, limit, previous;
} yci_shear;
/* The friction of a shear's angle: a spring of N m about its anchor, which holds reach times the rub's limit. */
typedef struct yci_turn {
    int rub, anchor; /* -1: none */
    double stiffness, reach;
} yci_turn;
/* `drop` is the visit that goes once the segment is shorter than `limit`; -1: none. */
typedef struct yci_adjacent {
    int a, b, drop;
    double stiffness, distance, hardness, floor, limit;
} yci_adjacent;
/* The friction of a visit: its u is held, or, in a stack, its u less `sign` times what its neighbour `other` has slid
 * from `from`. */
typedef struct yci_slide {
    int visit, other, rub; /* -1: none */
    double sign, from, stiffness, share;
} yci_slide;
/* Which way a visit goes through its stitch contact, from A to B +1, and whether it is the new loop's there. */
typedef struct yci_role {
    signed char way;
    unsigned char fresh;
    int contact; /* one that names it; -1: none */
} yci_role;
/* What becomes of a knit once its yarn between visits a and b is shorter than `limit`: MERGE, visit `drop` goes; SLIP,
 * a loop comes out of those it was drawn through, by visits `leave`; RELEASE, the end of a yarn does so. -1: none. */
typedef struct yci_due {
    int cloth, yarn, a, b, drop, leave[2];
    yc_event_type type;
    double limit;
} yci_due;
/* A stitch contact's yarns wrap about each other: visits at its two nodes, of the yarns whose tails are p and q there.
 */
typedef struct yci_wrap {
    int a, b, p, q;
    double stiffness, rest;
} yci_wrap;
/* The yarn in a stitch contact. */
typedef struct yci_length {
    int a, b;
    double stiffness, length;
} yci_length;
/* A stack of yarns at a node of a knit: `count` rubs from `rub`, from the lowest upwards. */
typedef struct yci_stack {
    int contact, rub, count; /* contact: of its cloth; -1: none, legs that cross */
} yci_stack;
/* A crossing with friction, by numbers of its cloth's network; limit = mu lambda. */
typedef struct yci_rub {
    int cloth, visit[2], yarn[2];
    double friction, preload, limit;
} yci_rub;
typedef struct yci_face {
    int node[3];
    yci_membrane rest;
    double material[4], previous[3], stress[3];
} yci_face;
typedef struct yci_hinge {
    int node[4];
    double stiffness, rest, previous;
} yci_hinge;
typedef struct yci_stitch {
    int node[2], seam;
    double stiffness;
} yci_stitch;
/* A node, or a triangle's centre, that feels bodies. */
typedef struct yci_probe {
    int count, node[3];
    double weight, thickness;
} yci_probe;
typedef struct yci_touch {
    int probe, body;
    double lambda, normal[3];
} yci_touch; /* a probe near a body */
/* What friction of a pair lags. */
typedef struct yci_grip {
    double weight, lambda, normal[3], share[4];
} yci_grip;

/* Kinds of elements, in the order of assembly. */
enum {
    YCI_SEGMENT,
    YCI_BEND,
    YCI_KINK,
    YCI_SHEAR,
    YCI_ADJACENT,
    YCI_FLATTEN,
    YCI_SLIDE,
    YCI_WRAP,
    YCI_LENGTH,
    YCI_FACE,
    YCI_HINGE,
    YCI_STITCH,
    YCI_TOUCH,
    YCI_GRIP,
    YCI_KINDS,
    YCI_STRETCH = YCI_KINDS, /* the two parts of a segment's energy, for the table of energies */
    YCI_GRAVITY
};

/* One element as the assembly sees it. */
typedef struct yci_local {
    int nodes, points, dofs, node[4]; /* scene nodes; unknowns: `points` of positions, and others behind */
    short slot[12], comp[12];         /* of each unknown: which node, which component of its block, -1: held */
    double energy, g[12], h[144];
    double *block[4][4]; /* of its nodes in the matrix, NULL where one is held */
} yci_local;

#define YCI_CHUNK 256         /* elements evaluated at once before their serial, ordered addition */
#define YCI_DIRECT_LIMIT 2000 /* full yarn nodes that are solved for directly */
#define YCI_DIRECT_KNIT 20000 /* and with a knit among them, whose incomplete factor costs more: see yci_build_solver */
#define YCI_KNIT_FILL 2       /* levels of fill in its incomplete factor */
#define YCI_HARDNESS 1e-3     /* of the floor under lengths, times EA */
#define YCI_NET_NODES 9       /* yarn nodes per cell of a coarse net: 25 take twice the iterations at 5 ms */
#define YCI_NET_KNIT 36       /* in a knit, about three loops by three */
#define YCI_LOOP 8            /* visits of a plain loop of a knit */
#define YCI_NEAR 10.0         /* tolerances: a shorter Newton step may be the last but for one that need not be taken */
#define YCI_CONVEX (1.0 / 64.0) /* least share of semidefinite Hessians where the exact ones have no factor */
#define YCI_CONVEX_SHIFT 1e-4   /* largest shift of an incomplete factor with a smaller share than all of them */
#define YCI_BENT 0.1            /* to this share what bends a line search is solved for */
#define YCI_PATIENCE 3          /* Newton iterations without a lower E before line searches; see yci_newton */
#define YCI_PATIENCE_MOST 12    /* at most so many before the share of semidefinite Hessians falls again */
#define YCI_SHIFT 1e-6          /* of the diagonal: most by which sliding is stiffened that would cost nothing */
#define YCI_RETRIES 32          /* sub-steps of newton_limit iterations beyond the planned ones, in a step */
#define YCI_JAM_WIDTH 0.05      /* rad, over which shear jamming rises to its full stiffness */
#define YCI_TURN_WIDTH 0.3      /* rad, likewise for the bending of a knit's yarns */
#define YCI_TAIL 0.15           /* pitches: a yarn's end slides out of a crossing that is closer */
#define YCI_LONG 2.0            /* pitches: a longer segment gets a node */
#define YCI_SLIP 1.0            /* pitches: a loop of a knit slips out of others when its head is shorter */
#define YCI_NOTHING 0.01        /* pitches: so much of it goes wherever it must */
#define YCI_SHORT 0.7           /* pitches: so much of a knit's loose yarn needs no node in it */

#define YCI_APART 1e3 /* m between cloths at rest */
#define YCI_FOLD 1.6  /* thicknesses along the cloth around its tightest fold, half a circle */

#define YCI_ARRAY(type, name) \
    type *name; \
    int name##_count, name##_capacity

typedef struct yci_model {
    unsigned char *role; /* [nodes] */
    double *share;       /* [nodes], alpha of yarn nodes in the mechanics, 1 - alpha of vertices, clamped */
    unsigned char *held; /* [nodes], pinned, or a yarn node that holds the pin of a vertex without mechanics */
    int *holder;         /* [vertices], that yarn node; -1: none */
    int *system_node;    /* [nodes], node of the linear system; -1: none; -2 - k: pinned, number k */
    int *node_of;        /* [system nodes] */
    int *walk;           /* [nodes], vertices, then yarn nodes along their yarns, wefts first: what elements, the system
                            and its incomplete factor are ordered by, so that they lie close in memory */
    int *visit_slot;     /* [visits], the component of u in its node's block; -1: held */
    /* Crimp; NULL where the scene has none. */
    int *height_slot;         /* [visits], the component of z in its node's block; -1: held; NULL without crimp */
    unsigned char *undulates; /* [visits], whether z counts */
    double *lift;             /* [visits], m, y at rest */
    double *thrust;           /* [visits], N, dV/dy of the yarn alone; lagged */
    double *unwrap;           /* [3 visits], N: what wrapping does to each yarn of a knit; lagged; NULL without knits */
    double *mass;             /* [nodes], kg, of translation */
    double *mass_fixed;       /* [nodes], the part of it that no sliding changes */
    double *reaction;         /* [3 pinned], N; behind the vectors from dof */
    int pinned;
    YCI_ARRAY(yci_segment, segment);
    YCI_ARRAY(yci_bend, bend);
    YCI_ARRAY(yci_kink, kink);
    YCI_ARRAY(yci_shear, shear);
    YCI_ARRAY(yci_turn, turn); /* one for each shear; none in a scene without friction */
    YCI_ARRAY(yci_adjacent, adjacent);
    YCI_ARRAY(yci_flatten, flatten);
    YCI_ARRAY(yci_slide, slide);
    YCI_ARRAY(yci_rub, rub);
    YCI_ARRAY(yci_wrap, wrap);
    YCI_ARRAY(yci_length, length);
    YCI_ARRAY(yci_stack, stack);
    YCI_ARRAY(yci_due, due);
    yci_role *knitted; /* [visits], set in knits; NULL without any */
    YCI_ARRAY(yci_face, face);
    YCI_ARRAY(yci_hinge, hinge);
    YCI_ARRAY(yci_stitch, stitch);
    YCI_ARRAY(yci_probe, probe);
    YCI_ARRAY(yci_touch, touch);
    yci_pairs pairs;
    YCI_ARRAY(yci_grip, grip); /* one for each pair */
    /* search of cloth against cloth: what takes part, and where all nodes are at rest */
    YCI_ARRAY(int, edge);
    YCI_ARRAY(int, ball);
    int *face_node;               /* [3 faces] */
    double *radius, *half, *rest; /* of yarn nodes: their thickest yarn's radius, half of the cloth's thickness there */
    int *closed;                  /* [vertices], as if every seam were welded */
    double margin;                /* m: contacts are searched again once a node has moved half of it */
    double *searched;             /* [3 nodes], positions at the last search; behind them room for as many */
    yci_system system;
    int has_system;
    yc_solver solver;
    /* Vectors of the system's size, one block from dof. */
    double *dof, *dof_n, *dof_free, *dof_best, *start, *gradient, *direction, *right;
    yci_local *local; /* [YCI_CHUNK] */
    double slope;     /* of E along the direction, J */
    double h, rate;   /* s; stiffness damping / h. h = 0: energies alone, without damping and friction */
    double shift;     /* how much stiffer sliding is made, as a share, where it costs nothing */
    double convex;    /* share of the elements' semidefinite Hessians; the rest is that of the exact ones */
    double eased;     /* m: what the last prediction may have left out where tension fell */
    int searching;    /* whether line searches are on */
    int tense;        /* whether tension and stress are those that Newton's method ended the last sub-step with */
    int full, hybrid, dummy, vertices, hybrid_vertices;
} yci_model;

struct yc_scene {
    yci_context c;
    yc_scene_desc desc;
    YCI_ARRAY(yci_cloth, cloth);
    YCI_ARRAY(yci_seam, seam);
    YCI_ARRAY(yci_body_sdf, body);
    /* topology of all cloths together */
    int vertices, nodes, visits, triangles; /* nodes: vertices and, behind them, yarn nodes */
    int crimped, rubs;                      /* whether any cloth has crimp, friction */
    int *triangle;                          /* [3 triangles], scene vertices, welded */
    int *weld;                              /* [vertices], the lowest vertex welded with it */
    int *visit_node;                        /* [visits] */
    /* state */
    double *x, *velocity;       /* [3 nodes] */
    double *u, *slide, *anchor; /* [visits]: u, its velocity, its friction anchor */
    double *z, *rise;           /* [visits]: z, its velocity; NULL without crimp */
    double *turn;               /* [4 turns], rad: friction anchors of a crossing's pairs, from their rest angles */
    unsigned char *pin;         /* [nodes] */
    double *goal;               /* [3 nodes], where a pin draws its node over the next step */
    unsigned char *welded;      /* [seams] */
    yci_pose *pose;             /* [2 bodies]: where each is, where the next step takes it */
    double time, dt;            /* s; the sub-step that control has settled on */
    /* scratch of the state's size */
    double *x_n, *u_n, *z_n;   /* before the sub-step */
    int node_room, visit_room; /* what the arrays of the state hold */
    YCI_ARRAY(yc_event, event);
    yci_model *model; /* NULL: to be built */
};

/* What the state keeps for each node or for each visit. */
typedef struct yci_state_array {
    void *array; /* address of the pointer */
    int of_visits;
    size_t size; /* bytes for each */
} yci_state_array;

enum { YCI_STATE_SAVED = 10, YCI_STATE_ARRAYS = 13 };

/* The first YCI_STATE_SAVED are saved, doubles before bytes; the others are scratch. Size 0: not there. */
static void yci_state_arrays(yc_scene *s, yci_state_array *list) {
    const size_t one = sizeof(double), three = 3 * one, crimp = s->crimped ? one : 0, four = s->rubs ? 4 * one : 0;
    const yci_state_array all[YCI_STATE_ARRAYS] = {{&s->x, 0, three}, {&s->velocity, 0, three}, {&s->goal, 0, three},
        {&s->u, 1, one}, {&s->slide, 1, one}, {&s->anchor, 1, one}, {&s->z, 1, crimp}, {&s->rise, 1, crimp},
        {&s->turn, 0, four}, {&s->pin, 0, 1}, {&s->x_n, 0, three}, {&s->u_n, 1, one}, {&s->z_n, 1, crimp}};
    memcpy(list, all, sizeof all);
}

static char *yci_state_array_of(const yci_state_array *a) {
    char *pointer;
    memcpy(&pointer, a->array, sizeof pointer);
    return pointer;
}

/* ---- descriptors ---- */

YC_API const char *yc_term_name(yc_term term) {
    static const char *const names[] = {"kinetic", "gravity", "stretch", "bending", "shear", "adjacent", "flattening",
        "slide", "membrane", "hinge", "seam", "body", "pair", "wrap", "stitch"};
    return (int)term >= 0 && term < YC_TERM_COUNT ? names[term] : "unknown yc_term";
}

YC_API const char *yc_event_name(yc_event_type type) {
    static const char *const names[] = {"release", "merge", "split", "break", "loose", "slip", "part"};
    return (int)type >= 0 && type < YC_EVENT_COUNT ? names[type] : "unknown yc_event_type";
}

YC_API yc_scene_desc yc_scene_desc_preset(yc_preset preset) {
    yc_scene_desc d;
    memset(&d, 0, sizeof d);
    d.cookie = YCI_DESC_COOKIE;
    d.gravity[1] = -9.81;
    d.dt_max = preset == YC_PREVIEW ? 1.0 / 60.0 : preset == YC_REFERENCE ? 1e-3 : 5e-3;
    d.dt_min = 1e-6;
    d.tolerance = preset == YC_PREVIEW ? 1e-4 : preset == YC_REFERENCE ? 1e-8 : 1e-5;
    d.newton_limit = preset == YC_PREVIEW ? 8 : 400;
    d.best_effort = preset == YC_PREVIEW;
    d.linear_tolerance = preset == YC_REFERENCE ? 1e-6 : 1e-4;
    d.linear_limit = 2000;
    d.contact_stiffness = 200.0;
    d.thickness = 1.5e-3;
    d.slip_speed = 1e-3;
    d.self_friction = 0.2;
    return d;
}

YC_API yc_scene_desc yc_scene_desc_default(void) { return yc_scene_desc_preset(YC_DEFAULT); }

YC_API yc_cloth_desc yc_cloth_desc_default(void) {
    yc_cloth_desc d;
    memset(&d, 0, sizeof d);
    d.cookie = YCI_DESC_COOKIE;
    d.material = yc_triangle_material_default();
    return d;
}

YC_API yc_seam_desc yc_seam_desc_default(void) {
    yc_seam_desc d;
    memset(&d, 0, sizeof d);
    d.cookie = YCI_DESC_COOKIE;
    d.stiffness = 100.0;
    d.close_time = 0.5;
    d.weld_distance = 2e-3;
    return d;
}

/* One line of a descriptor's check: a value, and the range it must lie in; `open` excludes the lower bound. */
static yc_result yci_scene_range(yci_context *c, const char *field, double value, double lo, double hi, int open) {
    if (value <= hi && (open ? value > lo : value >= lo)) return YC_OK;
    return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s = %g must be %s %g and at most %g", field, value,
        open ? "greater than" : "at least", lo, hi);
}

static yc_result yci_scene_desc_check(yci_context *c, const yc_scene_desc *d) {
    const double big = 1e12;
    const char *axis[] = {"scene.gravity[0]", "scene.gravity[1]", "scene.gravity[2]"};
    yc_result r = YC_OK;
    int i;
    if (!d) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "scene descriptor is NULL");
    if (d->cookie != YCI_DESC_COOKIE)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "scene.cookie: not made by yc_scene_desc_default()");
    for (i = 0; i < 3 && r == YC_OK; i++) r = yci_scene_range(c, axis[i], d->gravity[i], -big, big, 0);
    if (r == YC_OK) r = yci_scene_range(c, "scene.dt_max", d->dt_max, 0.0, big, 1);
    if (r == YC_OK) r = yci_scene_range(c, "scene.dt_min", d->dt_min, 0.0, d->dt_max, 1);
    if (r == YC_OK) r = yci_scene_range(c, "scene.tolerance", d->tolerance, 0.0, big, 1);
    if (r == YC_OK) r = yci_scene_range(c, "scene.newton_limit", d->newton_limit, 1.0, 1e9, 0);
    if (r == YC_OK)
        r = yci_scene_range(c, "scene.solver", (double)(int)d->solver, 0.0, (double)YC_SOLVER_MASS_DENSE, 0);
    if (r == YC_OK) r = yci_scene_range(c, "scene.linear_tolerance", d->linear_tolerance, 0.0, 1.0, 1);
    if (r == YC_OK) r = yci_scene_range(c, "scene.linear_limit", d->linear_limit, 1.0, 1e9, 0);
    if (r == YC_OK) r = yci_scene_range(c, "scene.stiffness_damping", d->stiffness_damping, 0.0, big, 0);
    if (r == YC_OK) r = yci_scene_range(c, "scene.mass_damping", d->mass_damping, 0.0, big, 0);
    if (r == YC_OK) r = yci_scene_range(c, "scene.contact_stiffness", d->contact_stiffness, 0.0, big, 1);
    if (r == YC_OK) r = yci_scene_range(c, "scene.thickness", d->thickness, 0.0, big, 1);
    if (r == YC_OK) r = yci_scene_range(c, "scene.slip_speed", d->slip_speed, 0.0, big, 1);
    if (r == YC_OK) r = yci_scene_range(c, "scene.self_friction", d->self_friction, 0.0, 10.0, 0);
    return r;
}

YC_API yc_result yc_scene_create(const yc_host *host, const yc_scene_desc *desc, yc_scene **out, char *message) {
    yci_context c;
    yc_scene *s = NULL;
    yc_result result = yci_context_init(&c, host);
    if (!out) result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "out is NULL");
    else *out = NULL;
    if (result == YC_OK) result = yci_scene_desc_check(&c, desc);
    if (result == YC_OK && !(s = YCI_NEW(&c, yc_scene, 1))) result = yci_out_of_memory(&c, "the scene");
    if (yci_report(&c, result, message) != YC_OK) return result;
    s->c = c, s->desc = *desc, s->dt = desc->dt_max;
    *out = s;
    return YC_OK;
}

YC_API const char *yc_scene_message(const yc_scene *s) { return s ? s->c.message : "scene is NULL"; }
YC_API yc_scene_desc yc_scene_desc_get(const yc_scene *s) { return s->desc; }
YC_API double yc_scene_time(const yc_scene *s) { return s->time; }

YC_API const yc_event *yc_scene_events(const yc_scene *s, int *count) {
    *count = s->event_count;
    return s->event;
}

static void yci_model_destroy(yc_scene *s) {
    yci_context *c = &s->c;
    yci_model *m = s->model;
    if (!m) return;
    if (m->has_system) yci_system_destroy(&m->system);
    yci_free(c, m->role), yci_free(c, m->share), yci_free(c, m->held), yci_free(c, m->holder),
        yci_free(c, m->system_node), yci_free(c, m->node_of), yci_free(c, m->walk);
    yci_free(c, m->visit_slot), yci_free(c, m->mass), yci_free(c, m->mass_fixed);
    yci_free(c, m->undulates), yci_free(c, m->height_slot), yci_free(c, m->lift), yci_free(c, m->thrust);
    yci_free(c, m->segment), yci_free(c, m->bend), yci_free(c, m->kink), yci_free(c, m->shear), yci_free(c, m->turn),
        yci_free(c, m->adjacent), yci_free(c, m->flatten), yci_free(c, m->slide), yci_free(c, m->rub);
    yci_free(c, m->wrap), yci_free(c, m->length), yci_free(c, m->stack), yci_free(c, m->due), yci_free(c, m->knitted),
        yci_free(c, m->unwrap);
    yci_free(c, m->face), yci_free(c, m->hinge), yci_free(c, m->stitch), yci_free(c, m->probe), yci_free(c, m->touch);
    yci_free(c, m->grip), yci_free(c, m->edge), yci_free(c, m->ball), yci_free(c, m->face_node),
        yci_pairs_free(c, &m->pairs);
    yci_free(c, m->radius), yci_free(c, m->half), yci_free(c, m->rest), yci_free(c, m->closed),
        yci_free(c, m->searched);
    yci_free(c, m->dof), yci_free(c, m->local), yci_free(c, m);
    s->model = NULL;
}

YC_API yc_result yc_scene_tune(yc_scene *s, const yc_scene_desc *desc) {
    yc_result result = yci_scene_desc_check(&s->c, desc);
    if (result != YC_OK) return result;
    if (desc->solver != s->desc.solver || !desc->self_contact != !s->desc.self_contact ||
        desc->thickness != s->desc.thickness)
        yci_model_destroy(s);
    s->desc = *desc;
    s->dt = yci_min(s->dt, desc->dt_max);
    return YC_OK;
}

YC_API void yc_scene_destroy(yc_scene *s) {
    yci_context c;
    int i;
    if (!s) return;
    yci_model_destroy(s);
    for (i = 0; i < s->cloth_count; i++) yci_free(&s->c, s->cloth[i].memory), yci_free(&s->c, s->cloth[i].yarns.owner);
    for (i = 0; i < s->seam_count; i++) yci_free(&s->c, s->seam[i].a);
    for (i = 0; i < s->body_count; i++) yci_body_free(&s->c, s->body + i);
    yci_free(&s->c, s->cloth), yci_free(&s->c, s->seam), yci_free(&s->c, s->body);
    yci_free(&s->c, s->triangle), yci_free(&s->c, s->weld), yci_free(&s->c, s->visit_node);
    yci_free(&s->c, s->x), yci_free(&s->c, s->velocity), yci_free(&s->c, s->u), yci_free(&s->c, s->slide);
    yci_free(&s->c, s->anchor), yci_free(&s->c, s->pin), yci_free(&s->c, s->goal), yci_free(&s->c, s->welded);
    yci_free(&s->c, s->pose), yci_free(&s->c, s->x_n), yci_free(&s->c, s->u_n), yci_free(&s->c, s->z_n);
    yci_free(&s->c, s->z), yci_free(&s->c, s->rise), yci_free(&s->c, s->turn), yci_free(&s->c, s->event);
    c = s->c;
    yci_free(&c, s);
}

/* ---- adding things: everything that can fail comes first, then all is swapped in ---- */

typedef struct yci_grow {
    void *array; /* address of the pointer */
    size_t used, need, item;
    void *fresh;
} yci_grow;

static yci_grow yci_grow_item(void *array, int used, int more, int per, size_t item) {
    yci_grow g;
    g.array = array, g.used = (size_t)used * (size_t)per, g.need = ((size_t)used + (size_t)more) * (size_t)per;
    g.item = item, g.fresh = NULL;
    return g;
}

static int yci_grow_acquire(yci_context *c, yci_grow *list, int count) {
    int i;
    for (i = 0; i < count; i++) {
        list[i].fresh = yci_alloc(c, list[i].need, list[i].item);
        if (!list[i].fresh) {
            while (i--) yci_free(c, list[i].fresh);
            return 0;
        }
    }
    return 1;
}

static void yci_grow_commit(yci_context *c, yci_grow *list, int count) {
    int i;
    for (i = 0; i < count; i++) {
        void *old;
        memcpy(&old, list[i].array, sizeof old);
        if (old) memcpy(list[i].fresh, old, list[i].used * list[i].item);
        yci_free(c, old);
        memcpy(list[i].array, &list[i].fresh, sizeof old);
    }
}

static yc_result yci_triangle_material_check(yci_context *c, const yc_triangle_material *m) {
    const double big = 1e12, limit = sqrt(yci_max(m->stretch[0] * m->stretch[1], 0.0));
    yc_result r = yci_scene_range(c, "cloth.material.density", m->density, 0.0, big, 1);
    if (r == YC_OK) r = yci_scene_range(c, "cloth.material.stretch[0]", m->stretch[0], 0.0, big, 1);
    if (r == YC_OK) r = yci_scene_range(c, "cloth.material.stretch[1]", m->stretch[1], 0.0, big, 1);
    if (r == YC_OK)
        r = yci_scene_range(c, "cloth.material.coupling", m->coupling, -0.999999 * limit, 0.999999 * limit, 0);
    if (r == YC_OK) r = yci_scene_range(c, "cloth.material.shear", m->shear, 0.0, big, 1);
    if (r == YC_OK) r = yci_scene_range(c, "cloth.material.bending", m->bending, 0.0, big, 0);
    return r;
}

static yc_result yci_array_check(
    yci_context *c, const char *field, const double *values, int count, double lo, double hi, int open) {
    int i;
    for (i = 0; values && i < count; i++)
        if (!(values[i] <= hi && (open ? values[i] > lo : values[i] >= lo)))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "cloth.%s[%d] = %g must be %s %g and at most %g", field, i, values[i],
                open ? "greater than" : "at least", lo, hi);
    return YC_OK;
}

/* Where yarn nodes start, unless that is on a mesh: neighbours on a yarn need a direction. */
static yc_result yci_cloth_check_starts(yci_context *c, const yc_cloth_desc *d) {
    const char *field = d->yarn_positions ? "cloth.yarn_positions" : "yarns.layout";
    const yc_yarns *y = d->yarns;
    const double(*x)[3] = d->yarn_positions ? d->yarn_positions : (const double(*)[3])y->layout;
    int i, k, yarn;
    for (i = 0; i < y->node_count; i++)
        for (k = 0; k < 3; k++)
            if (!(fabs(x[i][k]) <= 1e6))
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s[%d][%d] = %g must lie in -1e6 .. 1e6", field, i, k, x[i][k]);
    for (yarn = 0; yarn < y->yarn_count; yarn++)
        for (k = y->yarn_first[yarn] + 1; k < y->yarn_first[yarn + 1]; k++) {
            int a = y->visit_node[k - 1], b = y->visit_node[k];
            double d3[3];
            yci_sub(d3, x[b], x[a]);
            if (!(yci_norm(d3) >= 1e-9))
                return YCI_FAIL(c, YC_ERROR_ARGUMENT,
                    "%s[%d] and [%d], neighbours on yarn %d, are %g m apart; at least 1e-9 is needed", field, a, b,
                    yarn, yci_norm(d3));
        }
    return YC_OK;
}

/* What a scene asks of a knit beyond yci_yarns_check: how many yarns a stack has, and that what is drawn through the
 * others lies on one side of them. */
static yc_result yci_knit_check_stacks(yci_context *c, const yc_yarns *y) {
    int i, k, *count;
    yc_result r = YC_OK;
    if (y->visit_height) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "cloth.yarns.visit_height: a knit cannot have crimp");
    count = YCI_NEW(c, int, y->node_count);
    if (!count) return yci_out_of_memory(c, "the check of a knit");
    for (i = 0; i < y->visit_count && r == YC_OK; i++)
        if (++count[y->visit_node[i]] > YCI_BLOCK_MAX - 3)
            r = YCI_FAIL(c, YC_ERROR_ARGUMENT, "cloth.yarns: a stack of more than %d yarns at node %d",
                YCI_BLOCK_MAX - 3, y->visit_node[i]);
    for (i = 0; i < 2 * y->contact_count && r == YC_OK; i++) {
        k = y->contacts[i / 2].visit[1][i % 2];
        if (abs(y->visit_layer[k]) != count[y->visit_node[k]] - 1)
            r = YCI_FAIL(c, YC_ERROR_ARGUMENT,
                "cloth.yarns.visit_layer[%d] = %d: the new loop must lie on top of its stack of %d, or below all", k,
                y->visit_layer[k], count[y->visit_node[k]]);
    }
    yci_free(c, count);
    return r;
}

/* Stitch contacts know of no triangles: those below a knit must have left the mechanics. */
static yc_result yci_knit_check_alone(yci_context *c, const yc_cloth_desc *d) {
    int i;
    if (d->enrich_all)
        return YCI_FAIL(
            c, YC_ERROR_ARGUMENT, "cloth.enrich_all = %d: a knit does not mix with triangles", d->enrich_all);
    if (!d->alpha && d->alpha_uniform != 1.0)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "cloth.alpha_uniform = %g must be 1: a knit does not mix with triangles",
            d->alpha_uniform);
    for (i = 0; d->alpha && i < d->mesh.vertex_count; i++)
        if (d->alpha[i] != 1.0)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "cloth.alpha[%d] = %g must be 1: a knit does not mix with triangles",
                i, d->alpha[i]);
    return YC_OK;
}

static yc_result yci_cloth_check(yci_context *c, const yc_cloth_desc *d) {
    yc_result r;
    if (!d) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "cloth descriptor is NULL");
    if (d->cookie != YCI_DESC_COOKIE)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "cloth.cookie: not made by yc_cloth_desc_default()");
    if (!d->mesh.vertex_count && !d->yarns) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "cloth has neither mesh nor yarns");
    r = yci_triangle_material_check(c, &d->material);
    if (r == YC_OK && d->mesh.vertex_count) r = yci_mesh_check(c, &d->mesh);
    if (r == YC_OK && d->yarns) r = yci_yarns_check(c, d->yarns, d->mesh.vertex_count ? &d->mesh : NULL);
    if (r == YC_OK && d->yarns && d->yarns->contact_count) {
        r = d->mesh.vertex_count ? yci_knit_check_alone(c, d) : YC_OK;
        if (r == YC_OK) r = yci_knit_check_stacks(c, d->yarns);
    }
    if (r == YC_OK) r = yci_scene_range(c, "cloth.alpha_uniform", d->alpha_uniform, 0.0, 1.0, 0);
    if (r == YC_OK) r = yci_array_check(c, "alpha", d->alpha, d->mesh.vertex_count, 0.0, 1.0, 0);
    if (r == YC_OK) r = yci_array_check(c, "grain", d->grain, d->mesh.triangle_count, -1e3, 1e3, 0);
    if (r == YC_OK) r = yci_array_check(c, "prestretch", d->prestretch, d->mesh.triangle_count, 0.0, 1e3, 1);
    if (r == YC_OK && d->yarns && (d->yarn_positions || !d->mesh.vertex_count)) r = yci_cloth_check_starts(c, d);
    return r;
}

/* Copies a descriptor's arrays into one block. `at` walks through it; with block NULL only the size is counted. */
static void *yci_pack(char *block, size_t *at, const void *data, size_t count, size_t item) {
    char *place = block ? block + *at : NULL;
    size_t bytes = (count * item + 15) & ~(size_t)15;
    if (!data) return NULL;
    if (place && count) memcpy(place, data, count * item);
    *at += bytes;
    return place;
}

static size_t yci_cloth_pack(yci_cloth *out, const yc_cloth_desc *d, char *block) {
    const yc_mesh *m = &d->mesh;
    size_t at = 0, vertices = (size_t)m->vertex_count, triangles = (size_t)m->triangle_count;
    out->desc = *d;
    out->desc.mesh.positions = NULL, out->desc.yarn_positions = NULL; /* they become the state */
    out->desc.mesh.triangles = (const int(*)[3])yci_pack(block, &at, m->triangles, triangles, sizeof m->triangles[0]);
    out->desc.mesh.uv = (const double(*)[2])yci_pack(block, &at, m->uv, (size_t)m->uv_count, sizeof m->uv[0]);
    out->desc.mesh.uv_triangles =
        (const int(*)[3])yci_pack(block, &at, m->uv_triangles, triangles, sizeof m->uv_triangles[0]);
    if (vertices && !m->uv_triangles) out->desc.mesh.uv_triangles = out->desc.mesh.triangles;
    out->desc.alpha = (const double *)yci_pack(block, &at, d->alpha, vertices, sizeof(double));
    out->desc.grain = (const double *)yci_pack(block, &at, d->grain, triangles, sizeof(double));
    out->desc.prestretch = (const double *)yci_pack(block, &at, d->prestretch, triangles, sizeof(double));
    out->desc.yarns = NULL; /* see yci_cloth_yarns */
    return at;
}

static const yc_yarns *yci_cloth_yarns(const yci_cloth *cloth) { return cloth->yarns.owner ? &cloth->yarns : NULL; }

static int yci_cloth_points(const yci_cloth *cloth, yc_point kind) {
    return kind == YC_VERTEX ? cloth->desc.mesh.vertex_count : cloth->yarns.node_count;
}

/* The arrays of a network but its materials, doubles first. */
typedef struct yci_network_part {
    void *data;
    size_t bytes;
} yci_network_part;

enum { YCI_NETWORK_PARTS = 13 };

static void yci_network_parts(const yc_yarns *y, yci_network_part *list) {
    size_t nodes = (size_t)y->node_count, yarns = (size_t)y->yarn_count, visits = (size_t)y->visit_count;
    const yci_network_part all[YCI_NETWORK_PARTS] = {{y->layout, nodes * sizeof *y->layout},
        {y->weights, y->weights ? nodes * sizeof *y->weights : 0}, {y->visit_u, visits * sizeof *y->visit_u},
        {y->visit_height, y->visit_height ? visits * sizeof *y->visit_height : 0},
        {y->triangle, y->triangle ? nodes * sizeof *y->triangle : 0}, {y->yarn_first, (yarns + 1) * sizeof(int)},
        {y->yarn_material, yarns * sizeof(int)}, {y->visit_node, visits * sizeof(int)}, {y->yarn_family, yarns},
        {y->visit_layer, visits}, {y->visit_held, visits},
        {y->visit_turn, y->visit_turn ? visits * sizeof *y->visit_turn : 0},
        {y->contacts, (size_t)y->contact_count * sizeof *y->contacts}};
    memcpy(list, all, sizeof all);
}

/* Makes a network with room for these counts and the materials of another. */
static int yci_network_new(
    yci_context *c, const yc_yarns *like, int nodes, int yarns, int visits, int contacts, int on_mesh, yc_yarns *out) {
    const int has = (like->visit_height ? YCI_HEIGHTS : 0) | (like->visit_turn ? YCI_TURNS : 0);
    char *block;
    memset(out, 0, sizeof *out);
    out->node_count = nodes, out->yarn_count = yarns, out->visit_count = visits;
    out->material_count = like->material_count, out->contact_count = contacts;
    block = (char *)yci_alloc(c, yci_weave_arrays(out, NULL, on_mesh, has), 1);
    if (!block) return 0;
    yci_weave_arrays(out, block, on_mesh, has);
    memcpy(out->materials, like->materials, (size_t)like->material_count * sizeof *like->materials);
    return 1;
}

static int yci_network_copy(yci_context *c, const yc_yarns *y, int on_mesh, yc_yarns *out) {
    yci_network_part from[YCI_NETWORK_PARTS], to[YCI_NETWORK_PARTS];
    int i;
    if (!yci_network_new(c, y, y->node_count, y->yarn_count, y->visit_count, y->contact_count, on_mesh, out)) return 0;
    yci_network_parts(y, from), yci_network_parts(out, to);
    for (i = 0; i < YCI_NETWORK_PARTS; i++)
        if (to[i].bytes) memcpy(to[i].data, from[i].data, to[i].bytes);
    return 1;
}

/* The mean distance of neighbouring crossings, for each family; of all its visits where it has no such pair. */
static void yci_network_pitch(const yc_yarns *y, double pitch[3]) {
    double sum[2][3] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    int count[2][3] = {{0, 0, 0}, {0, 0, 0}}, i, k;
    for (i = 0; i < y->yarn_count; i++)
        for (k = y->yarn_first[i]; k + 1 < y->yarn_first[i + 1]; k++) {
            int family = y->yarn_family[i], inner = y->visit_layer[k] != 0 && y->visit_layer[k + 1] != 0;
            sum[inner][family] += y->visit_u[k + 1] - y->visit_u[k], count[inner][family]++;
        }
    for (i = 0; i < 3; i++)
        pitch[i] = count[1][i] ? sum[1][i] / count[1][i] : count[0][i] ? sum[0][i] / count[0][i] : 0.0;
}

/* Numbers the yarn nodes and visits of all cloths by their networks. */
static void yci_scene_number(yc_scene *s) {
    int i, k;
    s->nodes = s->vertices, s->visits = 0;
    for (i = 0; i < s->cloth_count; i++) {
        yci_cloth *cloth = s->cloth + i;
        cloth->node = s->nodes, cloth->visit = s->visits;
        for (k = 0; k < cloth->yarns.visit_count; k++)
            s->visit_node[s->visits + k] = s->nodes + cloth->yarns.visit_node[k];
        s->nodes += cloth->yarns.node_count, s->visits += cloth->yarns.visit_count;
    }
}

/* Writes a new cloth's part of the state and topology, behind what is there. */
static void yci_cloth_start(yc_scene *s, yci_cloth *cloth, const yc_cloth_desc *d) {
    const yc_yarns *y = yci_cloth_yarns(cloth);
    int i, k, j;
    for (i = 0; i < d->mesh.vertex_count; i++) {
        s->weld[cloth->vertex + i] = cloth->vertex + i;
        yci_copy(s->x + 3 * (cloth->vertex + i), d->mesh.positions[i]);
    }
    for (i = 0; i < 3 * d->mesh.triangle_count; i++)
        s->triangle[3 * cloth->triangle + i] = cloth->vertex + (&d->mesh.triangles[0][0])[i];
    for (i = 0; y && i < y->node_count; i++) {
        double *x = s->x + 3 * (cloth->node + i);
        if (d->yarn_positions) yci_copy(x, d->yarn_positions[i]);
        else if (!d->mesh.vertex_count) yci_copy(x, y->layout[i]);
        else
            for (k = 0; k < 3; k++)
                yci_axpy(x, y->weights[i][k], d->mesh.positions[d->mesh.triangles[y->triangle[i]][k]]);
    }
    for (j = 0; y && j < y->visit_count; j++) s->u[cloth->visit + j] = s->anchor[cloth->visit + j] = y->visit_u[j];
}

/* Vertices of a new cloth stand before all yarn nodes: those of earlier cloths move up by `shift`. */
static void yci_scene_shift_nodes(yc_scene *s, int shift) {
    yci_state_array list[YCI_STATE_ARRAYS];
    int i;
    yci_state_arrays(s, list);
    for (i = 0; i < YCI_STATE_ARRAYS; i++) {
        char *from = yci_state_array_of(list + i) + (size_t)s->vertices * list[i].size;
        if (list[i].of_visits || !list[i].size) continue;
        memmove(from + (size_t)shift * list[i].size, from, (size_t)(s->nodes - s->vertices) * list[i].size);
        memset(from, 0, (size_t)shift * list[i].size);
    }
}

/* What makes the arrays of the state, and visit_node, hold that many nodes and visits; returns the number of items. */
static int yci_state_grow(yc_scene *s, int nodes, int visits, yci_grow *grow) {
    yci_state_array list[YCI_STATE_ARRAYS];
    int i, n = 0;
    yci_state_arrays(s, list);
    for (i = 0; i < YCI_STATE_ARRAYS; i++) {
        int used = list[i].of_visits ? s->visits : s->nodes, need = list[i].of_visits ? visits : nodes;
        if (list[i].size) grow[n++] = yci_grow_item(list[i].array, used, need - used, 1, list[i].size);
    }
    grow[n++] = yci_grow_item(&s->visit_node, s->visits, visits - s->visits, 1, sizeof(int));
    return n;
}

static int yci_yarns_rub(const yc_yarns *y) {
    int i;
    for (i = 0; i < y->material_count; i++)
        if (y->materials[i].friction > 0.0) return 1;
    return 0;
}

YC_API yc_result yc_scene_add_cloth(yc_scene *s, const yc_cloth_desc *desc, int *handle) {
    yci_context *c = &s->c;
    yci_cloth cloth;
    yci_grow grow[YCI_STATE_ARRAYS + 4];
    int vertices, nodes = s->nodes, visits = s->visits, crimped = s->crimped, rubs = s->rubs, n;
    yc_result result = yci_cloth_check(c, desc);
    if (result != YC_OK) return result;
    memset(&cloth, 0, sizeof cloth);
    cloth.memory = yci_alloc(c, yci_cloth_pack(&cloth, desc, NULL), 1);
    if (!cloth.memory) return yci_out_of_memory(c, "the cloth");
    yci_cloth_pack(&cloth, desc, (char *)cloth.memory);
    vertices = desc->mesh.vertex_count;
    if (desc->yarns && !yci_network_copy(c, desc->yarns, vertices > 0, &cloth.yarns)) {
        yci_free(c, cloth.memory);
        return yci_out_of_memory(c, "the cloth");
    }
    nodes += vertices + cloth.yarns.node_count, visits += cloth.yarns.visit_count;
    if (desc->yarns) s->crimped |= desc->yarns->visit_height != NULL, s->rubs |= yci_yarns_rub(desc->yarns);
    n = yci_state_grow(s, nodes, visits, grow);
    grow[n++] = yci_grow_item(&s->cloth, s->cloth_count, 1, 1, sizeof *s->cloth);
    grow[n++] = yci_grow_item(&s->triangle, s->triangles, desc->mesh.triangle_count, 3, sizeof(int));
    grow[n++] = yci_grow_item(&s->weld, s->vertices, vertices, 1, sizeof(int));
    if (!yci_grow_acquire(c, grow, n)) {
        yci_free(c, cloth.memory), yci_free(c, cloth.yarns.owner);
        s->crimped = crimped, s->rubs = rubs;
        return yci_out_of_memory(c, "the cloth");
    }
    yci_grow_commit(c, grow, n);
    yci_scene_shift_nodes(s, vertices);
    s->node_room = nodes, s->visit_room = visits;
    cloth.knit = cloth.yarns.contact_count > 0;
    cloth.laid_nodes = cloth.yarns.node_count, cloth.laid_visits = cloth.yarns.visit_count;
    if (desc->yarns) yci_network_pitch(desc->yarns, cloth.pitch);
    cloth.vertex = s->vertices, cloth.triangle = s->triangles;
    s->vertices += vertices, s->triangles += desc->mesh.triangle_count;
    s->cloth[s->cloth_count++] = cloth;
    yci_scene_number(s);
    yci_cloth_start(s, s->cloth + s->cloth_count - 1, desc);
    if (handle) *handle = s->cloth_count - 1;
    yci_model_destroy(s);
    return YC_OK;
}

static yc_result yci_handle_check(yci_context *c, const char *what, int handle, int count) {
    if (handle >= 0 && handle < count) return YC_OK;
    if (!count) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s handle %d: the scene has none", what, handle);
    return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%s handle %d is not in [0, %d)", what, handle, count);
}

/* Which way the directed edge (a, b) runs in the triangles: 1 forward, -1 backward, 0 in none. */
static int yci_scene_edge_direction(const yc_scene *s, int a, int b) {
    int t, k;
    for (t = 0; t < s->triangles; t++)
        for (k = 0; k < 3; k++) {
            int p = s->triangle[3 * t + k], q = s->triangle[3 * t + (k + 1) % 3];
            if (p == s->weld[a] && q == s->weld[b]) return 1;
            if (p == s->weld[b] && q == s->weld[a]) return -1;
        }
    return 0;
}

static yc_result yci_seam_check(yc_scene *s, const yc_seam_desc *d) {
    yci_context *c = &s->c;
    const int *chain[2];
    yc_result r;
    int side, i;
    if (!d) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "seam descriptor is NULL");
    if (d->cookie != YCI_DESC_COOKIE)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "seam.cookie: not made by yc_seam_desc_default()");
    chain[0] = d->a, chain[1] = d->b;
    if (d->count < 1) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "seam.count = %d must be at least 1", d->count);
    if (d->kind != YC_VERTEX && d->kind != YC_NODE)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "seam.kind = %d is neither YC_VERTEX nor YC_NODE", (int)d->kind);
    for (side = 0; side < 2; side++) {
        r = yci_handle_check(c, "seam.cloth", d->cloth[side], s->cloth_count);
        if (r != YC_OK) return r;
        if (!chain[side]) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "seam.%c is NULL", "ab"[side]);
        for (i = 0; i < d->count; i++)
            if (chain[side][i] < 0 || chain[side][i] >= yci_cloth_points(s->cloth + d->cloth[side], d->kind))
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "seam.%c[%d] = %d is no %s of its cloth", "ab"[side], i,
                    chain[side][i], d -> kind == YC_VERTEX ? "vertex" : "node");
    }
    for (i = 0; i < d->count; i++)
        if (d->cloth[0] == d->cloth[1] && d->a[i] == d->b[i])
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "seam.b[%d] = %d sews a point to itself", i, d->b[i]);
    r = yci_scene_range(c, "seam.stiffness", d->stiffness, 0.0, 1e12, 1);
    if (r == YC_OK) r = yci_scene_range(c, "seam.close_time", d->close_time, 0.0, 1e12, 0);
    if (r == YC_OK) r = yci_scene_range(c, "seam.weld_distance", d->weld_distance, 0.0, 1e12, 0);
    if (r == YC_OK) r = yci_scene_range(c, "seam.rest_angle", fabs(d->rest_angle), 0.0, 3.14, 0);
    for (i = 0; r == YC_OK && d->kind == YC_VERTEX && i + 1 < d->count; i++) {
        int a = s->cloth[d->cloth[0]].vertex, b = s->cloth[d->cloth[1]].vertex;
        int forward = yci_scene_edge_direction(s, a + d->a[i], a + d->a[i + 1]);
        int backward = yci_scene_edge_direction(s, b + d->b[i], b + d->b[i + 1]);
        if (forward && forward == backward)
            r = YCI_FAIL(c, YC_ERROR_TOPOLOGY,
                "seam edge %d joins two pieces wound against each other (vertices %d, %d and %d, %d)", i, d->a[i],
                d->a[i + 1], d->b[i], d->b[i + 1]);
    }
    return r;
}

/* The scene's node of a seam's point, welded. */
static int yci_seam_point(const yc_scene *s, const yci_seam *seam, int side, int k) {
    const yci_cloth *cloth = s->cloth + seam->desc.cloth[side];
    int index = (side ? seam->b : seam->a)[k];
    return seam->desc.kind == YC_VERTEX ? s->weld[cloth->vertex + index] : cloth->node + index;
}

YC_API yc_result yc_scene_add_seam(yc_scene *s, const yc_seam_desc *desc, int *handle) {
    yci_context *c = &s->c;
    yci_seam seam;
    yci_grow grow[2];
    int i;
    yc_result result = yci_seam_check(s, desc);
    if (result != YC_OK) return result;
    memset(&seam, 0, sizeof seam);
    seam.desc = *desc;
    seam.a = YCI_NEW(c, int, 2 * (size_t)desc->count);
    grow[0] = yci_grow_item(&s->seam, s->seam_count, 1, 1, sizeof *s->seam);
    grow[1] = yci_grow_item(&s->welded, s->seam_count, 1, 1, 1);
    if (!seam.a || !yci_grow_acquire(c, grow, 2)) {
        yci_free(c, seam.a);
        return yci_out_of_memory(c, "the seam");
    }
    yci_grow_commit(c, grow, 2);
    seam.b = seam.a + desc->count;
    for (i = 0; i < desc->count; i++) {
        double d[3];
        seam.a[i] = desc->a[i], seam.b[i] = desc->b[i];
        yci_sub(d, s->x + 3 * yci_seam_point(s, &seam, 0, i), s->x + 3 * yci_seam_point(s, &seam, 1, i));
        seam.gap = yci_max(seam.gap, yci_norm(d));
    }
    seam.start = s->time;
    seam.desc.a = seam.desc.b = NULL;
    s->seam[s->seam_count] = seam;
    if (handle) *handle = s->seam_count;
    s->seam_count++;
    yci_model_destroy(s);
    return YC_OK;
}

YC_API yc_result yc_scene_add_body(yc_scene *s, const yc_body_desc *desc, int *handle) {
    yci_context *c = &s->c;
    yci_body_sdf body;
    yci_grow grow[2];
    yc_result result = yci_body_init(c, desc, &body);
    if (result != YC_OK) return result;
    grow[0] = yci_grow_item(&s->body, s->body_count, 1, 1, sizeof *s->body);
    grow[1] = yci_grow_item(&s->pose, s->body_count, 1, 2, sizeof *s->pose);
    if (!yci_grow_acquire(c, grow, 2)) {
        yci_body_free(c, &body);
        return yci_out_of_memory(c, "the body");
    }
    yci_grow_commit(c, grow, 2);
    s->pose[2 * s->body_count] = s->pose[2 * s->body_count + 1] = body.pose;
    s->body[s->body_count] = body;
    if (handle) *handle = s->body_count;
    s->body_count++;
    return YC_OK;
}

YC_API yc_result yc_scene_move_body(yc_scene *s, int body, const double rotation[9], const double translation[3]) {
    yci_pose pose;
    int i, j;
    yc_result result = yci_handle_check(&s->c, "body", body, s->body_count);
    if (result != YC_OK) return result;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) {
            double product = yci_dot(rotation + 3 * i, rotation + 3 * j);
            if (!(fabs(product - (i == j)) < 1e-6))
                return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "rotation is not orthonormal: rows %d and %d have product %g",
                    i, j, product);
        }
    for (i = 0; i < 3; i++)
        if (!(fabs(translation[i]) < 1e9))
            return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "translation[%d] = %g is not a place", i, translation[i]);
    memcpy(pose.r, rotation, sizeof pose.r);
    yci_copy(pose.t, translation);
    s->pose[2 * body + 1] = pose;
    return YC_OK;
}

/* The scene node of a cloth's vertex (welded) or yarn node; fails with a message. */
static yc_result yci_scene_point(yc_scene *s, int cloth, yc_point kind, int index, int *node) {
    yc_result result = yci_handle_check(&s->c, "cloth", cloth, s->cloth_count);
    int count;
    if (result != YC_OK) return result;
    if (kind != YC_VERTEX && kind != YC_NODE)
        return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "kind = %d is neither YC_VERTEX nor YC_NODE", (int)kind);
    count = yci_cloth_points(s->cloth + cloth, kind);
    if (index < 0 || index >= count)
        return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "%s %d of cloth %d is not in [0, %d)",
            kind == YC_VERTEX ? "vertex" : "node", index, cloth, count);
    *node = kind == YC_VERTEX ? s->weld[s->cloth[cloth].vertex + index] : s->cloth[cloth].node + index;
    return YC_OK;
}

YC_API yc_result yc_scene_pin(yc_scene *s, int cloth, yc_point kind, int index, const double position[3]) {
    int node, k;
    yc_result result = yci_scene_point(s, cloth, kind, index, &node);
    if (result != YC_OK) return result;
    for (k = 0; position && k < 3; k++)
        if (!(fabs(position[k]) < 1e9))
            return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "pin position[%d] = %g is not a place", k, position[k]);
    if (!s->pin[node]) yci_model_destroy(s);
    s->pin[node] = 1;
    yci_copy(s->goal + 3 * node, position ? position : s->x + 3 * node);
    return YC_OK;
}

YC_API yc_result yc_scene_unpin(yc_scene *s, int cloth, yc_point kind, int index) {
    int node;
    yc_result result = yci_scene_point(s, cloth, kind, index, &node);
    if (result != YC_OK) return result;
    if (!s->pin[node])
        return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "%s %d of cloth %d is not pinned",
            kind == YC_VERTEX ? "vertex" : "node", index, cloth);
    s->pin[node] = 0;
    yci_model_destroy(s);
    return YC_OK;
}

YC_API yc_result yc_scene_set_velocity(yc_scene *s, int cloth, yc_point kind, int index, const double velocity[3]) {
    int node, k;
    yc_result result = yci_scene_point(s, cloth, kind, index, &node);
    if (result != YC_OK) return result;
    for (k = 0; k < 3; k++)
        if (!(fabs(velocity[k]) < 1e9))
            return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "velocity[%d] = %g is no speed", k, velocity[k]);
    yci_copy(s->velocity + 3 * node, velocity);
    return YC_OK;
}

/* ---- model: roles and weights ---- */

static double yci_raise(double alpha) { return alpha > 0.0 && alpha < 0.01 ? 0.01 : alpha; }

/* Alpha at a cloth's vertex; without yarns nothing blends. */
static double yci_cloth_alpha(const yci_cloth *cloth, int vertex) {
    if (!yci_cloth_yarns(cloth)) return 0.0;
    if (cloth->desc.enrich_all) return 1.0;
    return cloth->desc.alpha ? cloth->desc.alpha[vertex] : cloth->desc.alpha_uniform;
}

/* Mean alpha of a triangle, and its region: YCI_FULL, YCI_HYBRID or YCI_TRIANGLE. */
static int yci_cloth_region(const yci_cloth *cloth, int triangle, double *mean) {
    const int *v = cloth->desc.mesh.triangles[triangle];
    double a = yci_cloth_alpha(cloth, v[0]), b = yci_cloth_alpha(cloth, v[1]), d = yci_cloth_alpha(cloth, v[2]);
    *mean = (a + b + d) / 3.0;
    if (cloth->desc.enrich_all && yci_cloth_yarns(cloth)) return YCI_HYBRID;
    return a >= 1.0 && b >= 1.0 && d >= 1.0 ? YCI_FULL : a <= 0.0 && b <= 0.0 && d <= 0.0 ? YCI_TRIANGLE : YCI_HYBRID;
}

/* Roles of nodes. A vertex takes part when a triangle of it does; a yarn node by its triangle's region. */
static void yci_build_roles(yc_scene *s, yci_model *m) {
    int i, k, t;
    for (i = 0; i < s->cloth_count; i++) {
        const yci_cloth *cloth = s->cloth + i;
        const yc_yarns *y = yci_cloth_yarns(cloth);
        double mean;
        for (t = 0; t < cloth->desc.mesh.triangle_count; t++) {
            int region = yci_cloth_region(cloth, t, &mean);
            for (k = 0; k < 3 && region != YCI_FULL; k++) {
                int v = cloth->desc.mesh.triangles[t][k], node = s->weld[cloth->vertex + v];
                double share = cloth->desc.enrich_all ? 0.0 : yci_max(1.0 - yci_cloth_alpha(cloth, v), 0.01);
                m->role[node] = YCI_TRIANGLE;
                m->share[node] = yci_max(m->share[node], share);
            }
        }
        for (k = 0; y && k < y->node_count; k++) {
            int node = cloth->node + k, region = YCI_FULL;
            double alpha = 1.0;
            if (y->triangle) {
                const int *v = cloth->desc.mesh.triangles[y->triangle[k]];
                region = yci_cloth_region(cloth, y->triangle[k], &mean);
                alpha = y->weights[k][0] * yci_cloth_alpha(cloth, v[0]) +
                    y->weights[k][1] * yci_cloth_alpha(cloth, v[1]) + y->weights[k][2] * yci_cloth_alpha(cloth, v[2]);
            }
            if (region == YCI_TRIANGLE) {
                m->dummy++;
                continue;
            }
            m->role[node] = (unsigned char)region;
            m->share[node] = region == YCI_FULL ? 1.0 : yci_clamp(alpha, 0.01, 1.0);
            if (region == YCI_FULL) m->full++;
            else m->hybrid++;
        }
    }
    for (i = 0; i < s->vertices; i++) m->vertices += m->role[i] != YCI_IDLE;
}

/* A yarn node none of whose segments is left, at the tip of the hybrid region, has neither mass nor stiffness: it is
 * for drawing only. `held` marks the others, and is free until the pins come. */
static void yci_build_drop_loners(yc_scene *s, yci_model *m) {
    int i, k, yarn;
    for (i = 0; i < s->cloth_count; i++) {
        const yc_yarns *y = yci_cloth_yarns(s->cloth + i);
        const int base = s->cloth[i].node;
        for (yarn = 0; y && yarn < y->yarn_count; yarn++)
            for (k = y->yarn_first[yarn]; k + 1 < y->yarn_first[yarn + 1]; k++) {
                int a = base + y->visit_node[k], b = base + y->visit_node[k + 1];
                if (m->role[a] != YCI_IDLE && m->role[b] != YCI_IDLE) m->held[a] = m->held[b] = 1;
            }
        for (k = 0; y && k < y->node_count; k++) {
            int node = base + k;
            if (m->role[node] == YCI_IDLE || m->held[node]) continue;
            if (m->role[node] == YCI_FULL) m->full--;
            else m->hybrid--;
            m->role[node] = YCI_IDLE, m->share[node] = 0.0, m->dummy++;
        }
    }
}

/* The pin of a vertex that has left the mechanics passes to the nearest yarn node of its triangles, measured in the
 * pattern. */
static void yci_build_holders(yc_scene *s, yci_model *m) {
    int i, k, j;
    if (s->nodes) memcpy(m->held, s->pin, (size_t)s->nodes);
    for (i = 0; i < s->vertices; i++) m->holder[i] = -1;
    for (i = 0; i < s->cloth_count; i++) {
        const yci_cloth *cloth = s->cloth + i;
        const yc_yarns *y = yci_cloth_yarns(cloth);
        for (k = 0; k < cloth->desc.mesh.vertex_count; k++) {
            int vertex = s->weld[cloth->vertex + k], node, best = -1;
            double nearest = 2.0; /* weights of a node in its triangle: 1 at the vertex itself */
            if (!y || !s->pin[vertex] || m->holder[vertex] >= 0) continue;
            if (m->role[vertex] != YCI_IDLE && !cloth->desc.enrich_all) continue;
            for (node = 0; node < y->node_count; node++)
                for (j = 0; j < 3; j++)
                    if (s->triangle[3 * (cloth->triangle + y->triangle[node]) + j] == vertex &&
                        1.0 - y->weights[node][j] < nearest)
                        nearest = 1.0 - y->weights[node][j], best = cloth->node + node;
            if (best >= 0) m->holder[vertex] = best, m->held[best] = 1;
        }
    }
}

/* ---- model: elements of yarns ---- */

typedef struct yci_build {
    yc_scene *s;
    yci_model *m;
    const yci_cloth *cloth;
    const yc_yarns *yarns;
} yci_build;

#define YCI_PUSH(b, name) \
    (YCI_RESERVE(&(b)->s->c, (b)->m->name, (b)->m->name##_capacity, (b)->m->name##_count, (b)->m->name##_count + 1) \
            ? (b)->m->name + (b)->m->name##_count++ \
            : NULL)

static const yc_yarn_material *yci_yarn_of(const yci_build *b, int yarn) {
    return b->yarns->materials + b->yarns->yarn_material[yarn];
}

static int yci_build_active(const yci_build *b, int visit) {
    return b->m->role[b->cloth->node + b->yarns->visit_node[visit]] != YCI_IDLE;
}
static int yci_build_full(const yci_build *b, int visit) {
    return b->m->role[b->cloth->node + b->yarns->visit_node[visit]] == YCI_FULL;
}

static double yci_build_share(const yci_build *b, int visit) {
    return b->m->share[b->cloth->node + b->yarns->visit_node[visit]];
}

/* Gives half of a segment's mass, times `factor`, to the vertices that carry the visit's node. */
static void yci_build_vertex_mass(const yci_build *b, int visit, double mass) {
    int node = b->yarns->visit_node[visit], k;
    const int *v = b->cloth->desc.mesh.triangles[b->yarns->triangle[node]];
    for (k = 0; k < 3; k++) b->m->mass_fixed[b->s->weld[b->cloth->vertex + v[k]]] += b->yarns->weights[node][k] * mass;
}

/* The rest length behind a visit as laid. Nodes that events made stand in the middle of their segments, again and again
 * where a yarn is drawn out: what is between them counts as a pitch, however little of the layout it has left. */
static double yci_build_laid(const yci_build *b, int yarn, int visit) {
    const yc_yarns *y = b->yarns;
    double du = y->visit_u[visit + 1] - y->visit_u[visit];
    int made = y->visit_node[visit] >= b->cloth->laid_nodes || y->visit_node[visit + 1] >= b->cloth->laid_nodes;
    return made ? yci_max(du, b->cloth->pitch[y->yarn_family[yarn]]) : du;
}

/* A segment with both nodes in the mechanics is an element; else its mass is the triangles'. */
static int yci_build_segment(const yci_build *b, int yarn, int a) {
    const yc_yarn_material *material = yci_yarn_of(b, yarn);
    int active_a = yci_build_active(b, a), active_b = yci_build_active(b, a + 1);
    double mass = material->density * (b->yarns->visit_u[a + 1] - b->yarns->visit_u[a]), alpha = 0.0;
    yci_segment *e;
    if (active_a && active_b) {
        alpha = yci_raise(0.5 * (yci_build_share(b, a) + yci_build_share(b, a + 1)));
        e = YCI_PUSH(b, segment);
        if (!e) return 0;
        e->a = b->cloth->visit + a, e->b = e->a + 1;
        e->stretch = alpha * material->stretch, e->density = alpha * material->density, e->previous = 0.0;
        e->floor = 0.1 * yci_build_laid(b, yarn, a);
    }
    if (alpha < 1.0 && b->yarns->triangle) {
        int full_a = b->m->role[b->cloth->node + b->yarns->visit_node[a]] == YCI_FULL;
        int full_b = b->m->role[b->cloth->node + b->yarns->visit_node[a + 1]] == YCI_FULL;
        /* A full node's vertices may have left the mechanics: then the other end takes all. */
        double half = 0.5 * (1.0 - alpha) * mass;
        yci_build_vertex_mass(b, full_a && !full_b ? a + 1 : a, half);
        yci_build_vertex_mass(b, full_b && !full_a ? a : a + 1, half);
    }
    return 1;
}

/* The visits of a node, those of a stack from the lowest yarn to the highest, and their yarns' numbers. Filled once per
 * cloth. */
typedef struct yci_crossing {
    int *visit, *yarn, count, rub;
    double bind; /* see yci_build_bind */
} yci_crossing;

/* The kink of a yarn at rest. */
static double yci_build_rest_kink(const yci_build *b, int yarn, int visit) {
    const yc_yarns *y = b->yarns;
    double q[6] = {0.0};
    int k;
    if (visit <= y->yarn_first[yarn] || visit >= y->yarn_first[yarn + 1] - 1) return 0.0;
    for (k = 0; k < 3; k++) q[k] = yci_visit_rise(y, visit + k - 1);
    for (k = 0; k < 2; k++) q[4 + k] = q[3 + k] + yci_build_laid(b, yarn, visit + k - 1);
    return yci_yarn_kink_strain(q);
}

static int yci_build_kink(const yci_build *b, int yarn, int visit, double alpha) {
    double before = yci_build_rest_kink(b, yarn, visit - 1), here = yci_build_rest_kink(b, yarn, visit),
           after = yci_build_rest_kink(b, yarn, visit + 1);
    yci_kink *e = YCI_PUSH(b, kink);
    if (!e) return 0;
    e->a = b->cloth->visit + visit - 1, e->b = e->a + 1, e->c = e->a + 2;
    e->stiffness = alpha * yci_yarn_of(b, yarn)->crimp_bending * yci_yarn_kink_factor(before, here, after);
    e->rest = e->previous = here;
    return 1;
}

static int yci_is_sewn(const yc_scene *s, int node) {
    int i, k;
    for (i = 0; i < s->seam_count; i++)
        for (k = 0; s->seam[i].desc.kind == YC_NODE && k < s->seam[i].desc.count; k++)
            if (yci_seam_point(s, s->seam + i, 0, k) == node || yci_seam_point(s, s->seam + i, 1, k) == node) return 1;
    return 0;
}

/* The segment between a lone visit and a crossing that slides may be used up: then a yarn's end leaves the crossing,
 * and any other lone visit leaves the yarn. */
static void yci_build_tail(const yci_build *b, int yarn, int lone, int slider, yci_adjacent *e) {
    const yc_yarns *y = b->yarns;
    int end = lone == y->yarn_first[yarn] || lone + 1 == y->yarn_first[yarn + 1], goes = end ? slider : lone;
    int node = b->cloth->node + y->visit_node[goes];
    if (b->cloth->desc.hold_network || (end && y->visit_held[lone] > 1)) return;
    e->limit = YCI_TAIL * b->cloth->pitch[y->yarn_family[yarn]];
    e->floor = 0.2 * e->limit;
    if (b->cloth->knit && !end) e->floor = 0.5 * YCI_NOTHING * b->cloth->pitch[y->yarn_family[yarn]];
    if (b->cloth->knit || b->m->held[node] || yci_is_sewn(b->s, node)) return;
    if (end || (yci_build_full(b, lone - 1) && yci_build_full(b, lone + 1))) e->drop = b->cloth->visit + goes;
}

static void yci_build_knit_roles(const yc_yarns *y, yci_role *role) {
    int i, k;
    for (i = 0; i < y->visit_count; i++) role[i].contact = -1;
    for (i = 0; i < y->contact_count; i++)
        for (k = 0; k < 4; k++) {
            const int *pair = y->contacts[i].visit[k / 2];
            yci_role *at = role + pair[k % 2];
            at->way = (signed char)(pair[1] - pair[0]), at->contact = i;
            if (k / 2) at->fresh = 1;
        }
}

/* Whether a segment lies in a stitch contact. */
static int yci_build_joined(const yc_yarns *y, const yci_role *role, int visit) {
    int contact = role[visit].contact, i, in = 0;
    for (i = 0; i < 2 && contact >= 0; i++) {
        const int *pair = y->contacts[contact].visit[i];
        in |= (pair[0] == visit && pair[1] == visit + 1) || (pair[1] == visit && pair[0] == visit + 1);
    }
    return in;
}

/* The elements that begin at visit `a` of a yarn. `role` is NULL but in knits. */
static int yci_build_visit(const yci_build *b, int yarn, int a, const yci_crossing *crossing, const yci_role *role) {
    const yc_yarns *y = b->yarns;
    const yc_yarn_material *material = yci_yarn_of(b, yarn);
    const yci_crossing *here = crossing + y->visit_node[a], *next;
    int last = y->yarn_first[yarn + 1] - 1, base = b->cloth->visit + a, active;
    double alpha, touching;
    if (a == last) return 1;
    next = crossing + y->visit_node[a + 1], active = yci_build_active(b, a) && yci_build_active(b, a + 1);
    if (!yci_build_segment(b, yarn, a)) return 0;
    if (active && a + 2 <= last && yci_build_active(b, a + 2)) {
        alpha = yci_raise((yci_build_share(b, a) + yci_build_share(b, a + 1) + yci_build_share(b, a + 2)) / 3.0);
        if (material->bending > 0.0) {
            yci_bend *e = YCI_PUSH(b, bend);
            if (!e) return 0;
            e->a = base, e->b = base + 1, e->c = base + 2;
            e->stiffness = alpha * material->bending, e->previous = 0.0;
            e->rest = y->visit_turn ? y->visit_turn[a + 1] : 0.0;
            e->jam = b->cloth->knit ? YCI_TURN_WIDTH : 0.0;
        }
        if (y->visit_height && !yci_build_kink(b, yarn, a + 1, alpha)) return 0;
    }
    if (active && (b->m->visit_slot[base] >= 0 || b->m->visit_slot[base + 1] >= 0)) {
        yci_adjacent *e = YCI_PUSH(b, adjacent);
        double rest = yci_build_laid(b, yarn, a);
        if (b->cloth->knit && !b->cloth->desc.hold_network)
            rest = yci_min(rest, YCI_LONG * b->cloth->pitch[y->yarn_family[yarn]]);
        /* else the segment runs to an end, with nothing to touch, or lies in a stitch contact */
        int parallel = here->count > 1 && next->count > 1 && !(role && yci_build_joined(y, role, a));
        if (!e) return 0;
        touching = parallel ? yci_yarn_of(b, here->yarn[here->yarn[0] == yarn])->radius +
                yci_yarn_of(b, next->yarn[next->yarn[0] == yarn])->radius
                            : 0.0;
        alpha = yci_raise(0.5 * (yci_build_share(b, a) + yci_build_share(b, a + 1)));
        e->a = base, e->b = base + 1, e->stiffness = parallel ? alpha * material->contact : 0.0;
        e->distance = yci_min(touching, role ? rest : 0.9 * rest); /* loops may touch at rest */
        e->hardness = alpha * YCI_HARDNESS * material->stretch, e->floor = 0.2 * rest, e->drop = -1, e->limit = 0.0;
        if (here->count == 1) yci_build_tail(b, yarn, a, a + 1, e);
        if (next->count == 1) yci_build_tail(b, yarn, a + 1, a, e);
    }
    return 1;
}

/* The up to four pairs of neighbouring segments at a crossing of warp and weft, their rest angle from the layout. */
static int yci_build_shear(const yci_build *b, const yci_crossing *crossing, int node) {
    const yc_yarns *y = b->yarns;
    const yci_crossing *here = crossing + node;
    const yc_yarn_material *p, *q;
    double rho;
    int i, k;
    if (here->count != 2 || y->yarn_family[here->yarn[0]] + y->yarn_family[here->yarn[1]] != YC_WARP + YC_WEFT)
        return 1;
    p = yci_yarn_of(b, here->yarn[0]), q = yci_yarn_of(b, here->yarn[1]), rho = 0.5 * (p->radius + q->radius);
    for (i = 0; i < 4; i++) {
        int node_of[3], visit, ends = 0;
        double q9[9], e1[3], e2[3], alpha = 0.0;
        yci_shear *e;
        yci_turn *turn;
        node_of[0] = node;
        for (k = 0; k < 2; k++) {
            visit = here->visit[k] + ((i >> k) & 1 ? 1 : -1);
            if (visit < y->yarn_first[here->yarn[k]] || visit >= y->yarn_first[here->yarn[k] + 1]) break;
            node_of[k + 1] = y->visit_node[visit], ends++;
        }
        if (ends < 2) continue;
        for (k = 0; k < 3 && b->m->role[b->cloth->node + node_of[k]] != YCI_IDLE; k++) {
            yci_copy(q9 + 3 * k, y->layout[node_of[k]]);
            alpha += b->m->share[b->cloth->node + node_of[k]] / 3.0;
        }
        if (k < 3 || (p->shear + q->shear <= 0.0 && here->rub < 0)) continue;
        e = YCI_PUSH(b, shear);
        if (!e) return 0;
        for (k = 0; k < 3; k++) e->node[k] = b->cloth->node + node_of[k];
        yci_sub(e1, q9 + 3, q9), yci_sub(e2, q9 + 6, q9);
        e->length = 0.5 * (yci_norm(e1) + yci_norm(e2));
        e->stiffness = yci_raise(alpha) * here->bind * 0.5 * (p->shear + q->shear);
        e->limit = yci_min(p->shear_limit, q->shear_limit);
        e->rest = yci_yarn_shear_strain(q9), e->previous = e->rest;
        if (!b->s->rubs) continue;
        turn = YCI_PUSH(b, turn);
        if (!turn) return 0;
        turn->rub = here->rub, turn->anchor = here->rub < 0 ? -1 : 4 * (b->cloth->node + node) + i;
        turn->stiffness = yci_raise(alpha) * 0.125 * (p->slide + q->slide) * rho * rho;
        turn->reach = yci_raise(alpha) * rho / 6.0;
    }
    return 1;
}

/* Which visits slide: crossings of full nodes, free, between full neighbours. Where alpha changes along a yarn, sliding
 * would carry material from one weight to another: mass would change, and gravity would drive it. */
static void yci_build_slots(const yci_build *b, const yci_crossing *crossing) {
    const yc_yarns *y = b->yarns;
    int yarn, visit, k;
    for (visit = 0; visit < y->visit_count; visit++) b->m->visit_slot[b->cloth->visit + visit] = -1;
    for (yarn = 0; yarn < y->yarn_count && !b->cloth->desc.hold_sliding; yarn++)
        for (visit = y->yarn_first[yarn] + 1; visit < y->yarn_first[yarn + 1] - 1; visit++) {
            int node = y->visit_node[visit], global = b->cloth->node + node;
            if (y->visit_held[visit] || b->m->role[global] != YCI_FULL || b->m->held[global] ||
                crossing[node].count < 2)
                continue;
            if (!yci_build_full(b, visit - 1) || !yci_build_full(b, visit + 1)) continue;
            b->m->visit_slot[b->cloth->visit + visit] = 3;
        }
    for (k = 0; k < y->node_count; k++) { /* the sliding visits of a node stand behind each other */
        const yci_crossing *here = crossing + k;
        int i, slot = 3;
        for (i = 0; i < here->count; i++) {
            int *at = b->m->visit_slot + b->cloth->visit + here->visit[i];
            if (*at >= 0) *at = slot++;
        }
    }
}

/* How two yarns in series resist flattening, 0: not at all flat. */
static double yci_build_flattening(const yci_build *b, const yci_crossing *here) {
    double p = yci_yarn_of(b, here->yarn[0])->flattening, q = yci_yarn_of(b, here->yarn[1])->flattening;
    return p > 0.0 && q > 0.0 ? p * q / (p + q) : yci_max(p, q);
}

static int yci_build_flatten(const yci_build *b, const yci_crossing *here, double stiffness) {
    const yc_yarns *y = b->yarns;
    int low = y->visit_layer[here->visit[0]] < 0 ? 0 : 1;
    yci_flatten *e = YCI_PUSH(b, flatten);
    if (!e) return 0;
    e->a = b->cloth->visit + here->visit[low], e->b = b->cloth->visit + here->visit[!low];
    e->stiffness = stiffness, e->previous = 0.0;
    e->rest = b->m->lift[e->b] - b->m->lift[e->a];
    e->depth = 0.2 * (yci_yarn_of(b, here->yarn[0])->radius + yci_yarn_of(b, here->yarn[1])->radius);
    return 1;
}

/* Which visits have a z: those of full nodes where two yarns lie on each other, or where one has slid out and the other
 * goes on. It comes behind the sliding visits; two yarns that keep their shape have it together. */
static int yci_build_heights(const yci_build *b, const yci_crossing *crossing) {
    const yc_yarns *y = b->yarns;
    yci_model *m = b->m;
    int k;
    for (k = 0; k < y->visit_count; k++) {
        m->lift[b->cloth->visit + k] = yci_visit_rise(y, k);
        m->undulates[b->cloth->visit + k] = y->visit_height != NULL, m->height_slot[b->cloth->visit + k] = -1;
    }
    for (k = 0; k < y->node_count; k++) {
        const yci_crossing *here = crossing + k;
        int node = b->cloth->node + k, i, free = m->role[node] == YCI_FULL && !m->held[node], slot = 3;
        double stiffness = 0.0;
        if (!y->visit_height || !here->count || !free) continue;
        if (here->count == 1) {
            const int *first = y->yarn_first + here->yarn[0], visit = here->visit[0];
            free = visit > first[0] && visit + 1 < first[1];
        } else free = y->visit_layer[here->visit[0]] && y->visit_layer[here->visit[1]];
        if (!free) continue;
        if (here->count == 2) stiffness = yci_build_flattening(b, here);
        if (stiffness > 0.0 && !yci_build_flatten(b, here, stiffness)) return 0;
        for (i = 0; i < here->count; i++) slot += m->visit_slot[b->cloth->visit + here->visit[i]] >= 0;
        for (i = 0; i < here->count; i++)
            m->height_slot[b->cloth->visit + here->visit[i]] = stiffness > 0.0 ? slot + i : slot;
    }
    return 1;
}

/* What share of the neighbouring crossings, on both yarns, the yarns of one lie on other sides of each other. Where a
 * yarn changes sides it presses its partner with its tension times its slope, on a float it does not: so that share of
 * preload, and of the resistance against turning, is left there. 1 at all crossings of a plain weave. */
static double yci_build_bind(const yci_build *b, const yci_crossing *here) {
    const yc_yarns *y = b->yarns;
    int i, side, changes = 0, count = 0;
    for (i = 0; i < 2; i++)
        for (side = -1; side < 2; side += 2) {
            int visit = here->visit[i], next = visit + side, way;
            if (next < y->yarn_first[here->yarn[i]] || next >= y->yarn_first[here->yarn[i] + 1]) continue;
            way = y->visit_layer[visit] * y->visit_layer[next];
            count += way != 0, changes += way < 0;
        }
    return count ? (double)changes / count : 1.0;
}

/* The slides of a crossing, and its rub where it has friction: that of sliding and of turning. */
static int yci_build_slides(const yci_build *b, yci_crossing *here, int node) {
    const yc_yarn_material *p, *q;
    int i;
    here->rub = -1;
    if (here->count != 2 || b->m->role[b->cloth->node + node] == YCI_IDLE) return 1;
    here->bind = yci_build_bind(b, here);
    p = yci_yarn_of(b, here->yarn[0]), q = yci_yarn_of(b, here->yarn[1]);
    if (p->friction + q->friction > 0.0) {
        yci_rub *e = YCI_PUSH(b, rub);
        if (!e) return 0;
        here->rub = b->m->rub_count - 1;
        for (i = 0; i < 2; i++) e->visit[i] = here->visit[i], e->yarn[i] = here->yarn[i];
        e->cloth = (int)(b->cloth - b->s->cloth), e->friction = 0.5 * (p->friction + q->friction);
        e->preload = here->bind * 0.5 * (p->preload + q->preload), e->limit = 0.0;
    }
    for (i = 0; i < 2; i++) {
        int visit = b->cloth->visit + here->visit[i];
        yci_slide *e;
        if (b->m->visit_slot[visit] < 0) continue;
        e = YCI_PUSH(b, slide);
        if (!e) return 0;
        e->visit = visit, e->rub = here->rub, e->stiffness = 0.5 * (p->slide + q->slide), e->other = -1;
    }
    return 1;
}

/* ---- model: elements of knits ---- */

/* The two wrapped pairs of a contact: the old leg below A with the new one above B, the new foot at A with the old head
 * at B. */
static int yci_build_wraps(const yci_build *b, const yci_crossing *crossing, int contact) {
    const yc_yarns *y = b->yarns;
    const yc_stitch_contact *s = y->contacts + contact;
    double length = 0.0, k = 0.0;
    int i, yarn[2];
    for (i = 0; i < 2; i++) {
        const yci_crossing *at = crossing + y->visit_node[s->visit[i][0]];
        int j = 0;
        while (at->visit[j] != s->visit[i][0]) j++;
        yarn[i] = at->yarn[j];
        length += 0.5 * fabs(y->visit_u[s->visit[i][1]] - y->visit_u[s->visit[i][0]]);
        k += 0.5 * yci_yarn_of(b, yarn[i])->wrap;
    }
    for (i = 0; i < 2 && k > 0.0; i++) {
        const int *old = s->visit[i], *fresh = s->visit[!i]; /* of i = 0; for 1 they change their parts */
        int p = 2 * old[0] - old[1], q = 2 * fresh[1] - fresh[0];
        yci_wrap *e;
        if (p < y->yarn_first[yarn[i]] || p >= y->yarn_first[yarn[i] + 1]) continue;
        if (q < y->yarn_first[yarn[!i]] || q >= y->yarn_first[yarn[!i] + 1]) continue;
        e = YCI_PUSH(b, wrap);
        if (!e) return 0;
        e->a = b->cloth->visit + old[0], e->b = b->cloth->visit + fresh[1];
        e->p = b->cloth->visit + p, e->q = b->cloth->visit + q;
        e->stiffness = k * length, e->rest = -0.5 * YCI_PI * s->sign; /* both tails turn to the same side */
    }
    return 1;
}

/* The lengths of yarn in stitch contacts: every segment once, however many contacts name it. */
static int yci_build_lengths(const yci_build *b, int yarn, const yci_role *role) {
    const yc_yarns *y = b->yarns;
    int k;
    for (k = y->yarn_first[yarn]; k + 1 < y->yarn_first[yarn + 1]; k++) {
        int a = b->cloth->visit + k;
        yci_length *e;
        if (!yci_build_joined(y, role, k) || yci_yarn_of(b, yarn)->stitch <= 0.0 ||
            (b->m->visit_slot[a] < 0 && b->m->visit_slot[a + 1] < 0))
            continue;
        e = YCI_PUSH(b, length);
        if (!e) return 0;
        e->a = a, e->b = a + 1, e->length = y->visit_u[k + 1] - y->visit_u[k];
        e->stiffness = yci_yarn_of(b, yarn)->stitch;
    }
    return 1;
}

/* The rubs of a stack, from the lowest pair of neighbours to the highest, and the slides of its visits. The new loop,
 * which lies on one side of all old ones, and the old one next to it are held each by itself; the other old loops,
 * which run side by side, each by its neighbour on the way to the new one (YARN 4.4). */
static int yci_build_stack(const yci_build *b, const yci_crossing *here, const yci_role *role) {
    const yc_yarns *y = b->yarns;
    int i, n = here->count, rub = b->m->rub_count, low;
    double friction = 0.0;
    yci_stack *stack;
    if (n < 2) return 1;
    for (i = 0; i < n; i++) friction += yci_yarn_of(b, here->yarn[i])->friction;
    low = role[here->visit[0]].fresh || !role[here->visit[n - 1]].fresh; /* whether the new loop is the lowest */
    if (friction > 0.0) {
        stack = YCI_PUSH(b, stack);
        if (!stack) return 0;
        stack->contact = role[here->visit[0]].contact, stack->rub = rub, stack->count = n - 1;
        for (i = 0; i + 1 < n; i++) {
            yci_rub *e = YCI_PUSH(b, rub);
            if (!e) return 0;
            e->cloth = (int)(b->cloth - b->s->cloth), e->preload = e->limit = 0.0;
            e->visit[0] = here->visit[i], e->visit[1] = here->visit[i + 1];
            e->yarn[0] = here->yarn[i], e->yarn[1] = here->yarn[i + 1];
            e->friction = 0.5 * (yci_yarn_of(b, here->yarn[i])->friction + yci_yarn_of(b, here->yarn[i + 1])->friction);
        }
    }
    for (i = 0; i < n; i++) {
        int visit = here->visit[i], rank = low ? i : n - 1 - i,
            partner = rank == 0 ? 1 : rank - 1; /* from the new one */
        int other = here->visit[low ? partner : n - 1 - partner], pair = low ? 0 : n - 2;
        yci_slide *e;
        if (b->m->visit_slot[b->cloth->visit + visit] < 0) continue;
        e = YCI_PUSH(b, slide);
        if (!e) return 0;
        e->visit = b->cloth->visit + visit, e->other = -1;
        if (rank > 1) {
            pair = low ? i - 1 : i, e->other = b->cloth->visit + other, e->from = y->visit_u[other];
            e->sign = role[visit].way * role[other].way < 0 ? -1.0 : 1.0;
        }
        e->rub = friction > 0.0 ? rub + pair : -1;
        e->stiffness = 0.5 *
            (yci_yarn_of(b, here->yarn[i])->slide + yci_yarn_of(b, here->yarn[low ? partner : n - 1 - partner])->slide);
    }
    return 1;
}

/* Whether nothing outside of a knit holds a node. */
static int yci_build_free(const yci_build *b, int visit) {
    int node = b->cloth->node + b->yarns->visit_node[visit];
    return b->m->role[node] == YCI_FULL && !b->m->held[node] && !yci_is_sewn(b->s, node);
}

/* The other end of the stitch contacts that a visit lies in; itself where it lies in none. */
static int yci_build_partner(const yc_yarns *y, const yci_role *role, int visit) {
    const int *pair = role[visit].contact < 0 ? NULL : y->contacts[role[visit].contact].visit[role[visit].fresh];
    return pair ? pair[pair[0] == visit] : visit;
}

static int yci_build_may_leave(const yci_build *b, const yci_role *role, int visit) {
    return yci_build_free(b, visit) && yci_build_free(b, yci_build_partner(b->yarns, role, visit));
}

static yci_due *yci_build_push_due(const yci_build *b, int yarn, int v, int w, yc_event_type type, double pitches) {
    const yc_yarns *y = b->yarns;
    yci_due *e = YCI_PUSH(b, due);
    int a = v < w ? v : w, z = v < w ? w : v;
    if (!e) return NULL;
    e->cloth = (int)(b->cloth - b->s->cloth), e->yarn = yarn, e->type = type;
    e->a = b->cloth->visit + a, e->b = b->cloth->visit + z, e->drop = e->leave[0] = e->leave[1] = -1;
    e->limit = pitches * b->cloth->pitch[y->yarn_family[yarn]];
    return e;
}

/* What may become of a lone visit: an end slides out of the crossing next to it, any other is left out when it comes
 * close to one, or lies in loose yarn. What was laid short stays until half of it has gone. */
static int yci_build_due_alone(
    const yci_build *b, const yci_crossing *crossing, const yci_role *role, int yarn, int v) {
    const yc_yarns *y = b->yarns;
    int first = y->yarn_first[yarn], last = y->yarn_first[yarn + 1] - 1, side, end = v == first || v == last;
    yci_due *e;
    if (end ? y->visit_held[v] > 1 : !yci_build_free(b, v) || y->visit_node[v - 1] == y->visit_node[v + 1]) return 1;
    for (side = -1; side < 2; side += 2) {
        int next = v + side;
        if (next < first || next > last || crossing[y->visit_node[next]].count < 2) continue;
        if (end && !yci_build_may_leave(b, role, next)) continue;
        e = yci_build_push_due(
            b, yarn, v, next, end ? YC_EVENT_RELEASE : YC_EVENT_MERGE, end ? YCI_TAIL : 0.5 * YCI_SHORT);
        if (!e) return 0;
        if (end) e->leave[0] = b->cloth->visit + next;
        else e->drop = b->cloth->visit + v, e->limit = yci_min(e->limit, 0.5 * fabs(y->visit_u[next] - y->visit_u[v]));
    }
    if (end || y->visit_node[v] < b->cloth->laid_nodes) return 1;
    e = yci_build_push_due(b, yarn, v - 1, v + 1, YC_EVENT_MERGE, YCI_SHORT);
    if (e) e->drop = b->cloth->visit + v;
    return e != NULL;
}

/* Whether nothing lies between two neighbouring crossings of a yarn but the head of a loop, which both B bound. */
static int yci_build_is_head(const yc_yarns *y, const yci_role *role, int p, int q) {
    return role[p].contact >= 0 && role[p].fresh && role[p].way > 0 && role[q].contact >= 0 && role[q].fresh &&
        role[q].way < 0 && yci_build_partner(y, role, p) == p - 1 && yci_build_partner(y, role, q) == q + 1;
}

/* What may become of a knit. A loop whose head crosses nothing slips out when that has been drawn in; so falls open a
 * loop whose legs cross and whose yarn does not cross anything in between. */
static int yci_build_due(const yci_build *b, const yci_crossing *crossing, const yci_role *role) {
    const yc_yarns *y = b->yarns;
    int yarn, v;
    for (yarn = 0; yarn < y->yarn_count; yarn++) {
        int before = -1; /* the crossing before */
        for (v = y->yarn_first[yarn]; v < y->yarn_first[yarn + 1]; v++) {
            if (crossing[y->visit_node[v]].count < 2) {
                if (!yci_build_due_alone(b, crossing, role, yarn, v)) return 0;
                continue;
            }
            if (before >= 0 && yci_build_may_leave(b, role, before) && yci_build_may_leave(b, role, v)) {
                int open = y->visit_node[before] == y->visit_node[v];
                if (open || yci_build_is_head(y, role, before, v)) {
                    yci_due *e = yci_build_push_due(b, yarn, before, v, YC_EVENT_SLIP, YCI_SLIP);
                    if (!e) return 0;
                    e->leave[0] = e->a, e->leave[1] = open ? -1 : e->b;
                }
            }
            before = v;
        }
    }
    return 1;
}

static int yci_build_knit(const yci_build *b, const yci_crossing *crossing, const yci_role *role) {
    const yc_yarns *y = b->yarns;
    int i, ok = 1;
    for (i = 0; ok && i < y->contact_count; i++) ok = yci_build_wraps(b, crossing, i);
    for (i = 0; ok && i < y->yarn_count; i++) ok = yci_build_lengths(b, i, role);
    for (i = 0; ok && i < y->node_count; i++) ok = yci_build_stack(b, crossing + i, role);
    if (ok && !b->cloth->desc.hold_network) ok = yci_build_due(b, crossing, role);
    if (ok && !b->m->unwrap) ok = (b->m->unwrap = YCI_NEW(&b->s->c, double, 3 * (size_t)b->s->visits)) != NULL;
    return ok;
}

/* Enters a network's visits at their nodes, in `room` [2 visits]. Visits are numbered from `first`, nodes by
 * visit_node; `stacks`: those of a node are sorted. */
static void yci_crossing_fill(
    yci_crossing *crossing, const yc_yarns *y, const int *visit_node, int first, int stacks, int *room) {
    int yarn, visit, pass, k;
    for (pass = 0; pass < 2; pass++)
        for (yarn = 0; yarn < y->yarn_count; yarn++)
            for (visit = y->yarn_first[yarn]; visit < y->yarn_first[yarn + 1]; visit++) {
                yci_crossing *at = crossing + visit_node[visit];
                if (!pass) {
                    at->count++;
                    continue;
                }
                if (!at->visit) at->visit = room, at->yarn = room + at->count, room += 2 * at->count, at->count = 0;
                for (k = at->count++; k && stacks; k--) {
                    if (y->visit_layer[at->visit[k - 1] - first] <= y->visit_layer[visit]) break;
                    at->visit[k] = at->visit[k - 1], at->yarn[k] = at->yarn[k - 1];
                }
                at->visit[k] = first + visit, at->yarn[k] = yarn;
            }
}

/* The order of nodes. One without a visit stands behind the others of its cloth. */
static void yci_build_walk(const yc_scene *s, yci_model *m) {
    int i, k, n = 0, yarn, pass, *taken = m->system_node; /* not yet in use */
    memset(taken, 0, (size_t)s->nodes * sizeof *taken);
    for (i = 0; i < s->vertices; i++) m->walk[n++] = i;
    for (i = 0; i < s->cloth_count; i++) {
        const yc_yarns *y = yci_cloth_yarns(s->cloth + i);
        int first = s->cloth[i].node;
        for (pass = 0; pass < 2 && y; pass++)
            for (yarn = 0; yarn < y->yarn_count; yarn++)
                for (k = y->yarn_first[yarn]; k < y->yarn_first[yarn + 1]; k++) {
                    int node = first + y->visit_node[k];
                    if (taken[node] || (!pass && y->yarn_family[yarn] != YC_WEFT)) continue;
                    taken[node] = 1, m->walk[n++] = node;
                }
        for (k = 0; y && k < y->node_count; k++)
            if (!taken[first + k]) m->walk[n++] = first + k;
    }
}

static int yci_build_yarns(yci_build *b) {
    yci_context *c = &b->s->c;
    const yc_yarns *y = b->yarns;
    yci_crossing *crossing = YCI_NEW(c, yci_crossing, y->node_count);
    const int *walk = b->m->walk + b->cloth->node;
    int i, k, woven = !b->cloth->knit, *room = YCI_NEW(c, int, 2 * (size_t)y->visit_count);
    yci_role *role = NULL;
    int ok = crossing && room;
    if (ok && !woven && !b->m->knitted) ok = (b->m->knitted = YCI_NEW(c, yci_role, b->s->visits)) != NULL;
    if (ok && !woven) role = b->m->knitted + b->cloth->visit, yci_build_knit_roles(y, role);
    if (ok) yci_crossing_fill(crossing, y, y->visit_node, 0, !woven, room), yci_build_slots(b, crossing);
    if (ok && b->m->height_slot) ok = yci_build_heights(b, crossing);
    for (i = 0; i < y->node_count; i++) {
        const yci_crossing *here = crossing + walk[i] - b->cloth->node;
        for (k = 0; ok && k < here->count; k++) ok = yci_build_visit(b, here->yarn[k], here->visit[k], crossing, role);
    }
    if (ok && !woven) ok = yci_build_knit(b, crossing, role);
    for (i = 0; ok && woven && i < y->node_count; i++) {
        int node = walk[i] - b->cloth->node;
        ok = yci_build_slides(b, crossing + node, node) && yci_build_shear(b, crossing, node);
    }
    yci_free(c, crossing), yci_free(c, room);
    return ok;
}

/* ---- model: elements of triangles ---- */

static void yci_cloth_uv(const yci_cloth *cloth, int triangle, double uv[6]) {
    int k;
    for (k = 0; k < 3; k++) {
        const double *p = cloth->desc.mesh.uv[cloth->desc.mesh.uv_triangles[triangle][k]];
        double factor = cloth->desc.prestretch ? cloth->desc.prestretch[triangle] : 1.0;
        uv[2 * k] = p[0] * factor, uv[2 * k + 1] = p[1] * factor;
    }
}

/* A triangle's weight in the mechanics, and whether it takes part at all. */
static int yci_cloth_weight(const yci_cloth *cloth, int triangle, double *weight) {
    double mean;
    int region = yci_cloth_region(cloth, triangle, &mean);
    *weight = cloth->desc.enrich_all && yci_cloth_yarns(cloth) ? 0.0 : yci_raise(1.0 - mean);
    return region != YCI_FULL;
}

static int yci_build_faces(yci_build *b) {
    const yci_cloth *cloth = b->cloth;
    const yc_triangle_material *material = &cloth->desc.material;
    int t, k;
    for (t = 0; t < cloth->desc.mesh.triangle_count; t++) {
        double uv[6], weight;
        yci_face *e;
        if (!yci_cloth_weight(cloth, t, &weight) || weight <= 0.0) continue;
        e = YCI_PUSH(b, face);
        if (!e) return 0;
        yci_cloth_uv(cloth, t, uv);
        yci_triangle_rest(&e->rest, uv, cloth->desc.grain ? cloth->desc.grain[t] : 0.0, 1.0);
        e->material[0] = weight * material->stretch[0], e->material[1] = weight * material->coupling;
        e->material[2] = weight * material->stretch[1], e->material[3] = weight * material->shear;
        yci_zero(e->previous, 3);
        for (k = 0; k < 3; k++) {
            e->node[k] = b->s->triangle[3 * (cloth->triangle + t) + k];
            if (!b->yarns) b->m->mass_fixed[e->node[k]] += material->density * e->rest.area / 3.0;
        }
    }
    return 1;
}

/* Where yarns are coarser than triangles, some vertices would be left without mass. Then this cloth's triangle mass is
 * spread by area instead; the total stays. */
static void yci_build_spread_mass(yci_build *b, int first_face) {
    yci_model *m = b->m;
    double total = 0.0, area = 0.0;
    int i, k, poor = 0;
    for (i = first_face; i < m->face_count; i++) area += m->face[i].material[0] * m->face[i].rest.area;
    for (i = b->cloth->vertex; i < b->cloth->vertex + b->cloth->desc.mesh.vertex_count; i++) total += m->mass_fixed[i];
    if (area <= 0.0 || total <= 0.0) return;
    for (i = first_face; i < m->face_count; i++)
        for (k = 0; k < 3; k++)
            poor |=
                m->mass_fixed[m->face[i].node[k]] < 0.02 * total * m->face[i].material[0] * m->face[i].rest.area / area;
    if (!poor) return;
    for (i = b->cloth->vertex; i < b->cloth->vertex + b->cloth->desc.mesh.vertex_count; i++) m->mass_fixed[i] = 0.0;
    for (i = first_face; i < m->face_count; i++)
        for (k = 0; k < 3; k++)
            m->mass_fixed[m->face[i].node[k]] += total * m->face[i].material[0] * m->face[i].rest.area / (3.0 * area);
}

/* One side of an edge: its end vertices in ascending order, and the triangle it belongs to. */
typedef struct yci_side {
    int lo, hi, cloth, triangle, corner, forward;
} yci_side;

static int yci_side_before(const yci_side *a, const yci_side *b) {
    if (a->lo != b->lo) return a->lo < b->lo;
    if (a->hi != b->hi) return a->hi < b->hi;
    return a->cloth != b->cloth ? a->cloth < b->cloth : a->triangle < b->triangle;
}

/* Bottom-up merge sort: stable, no recursion, the same order on every machine. */
static void yci_side_sort(yci_side *list, yci_side *scratch, int count) {
    yci_side *from = list, *to = scratch, *swap;
    int width, i, a, b, k, mid, end;
    for (width = 1; width < count; width *= 2) {
        for (i = 0; i < count; i = end) {
            mid = i + width < count ? i + width : count, end = mid + width < count ? mid + width : count;
            for (a = i, b = mid, k = i; k < end; k++)
                to[k] = a < mid && (b >= end || !yci_side_before(from + b, from + a)) ? from[a++] : from[b++];
        }
        swap = from, from = to, to = swap;
    }
    if (from != list && count) memcpy(list, from, (size_t)count * sizeof *list);
}

/* The rest angle of the seam that joins two vertices, 0 where none does. */
static double yci_seam_angle(const yc_scene *s, int lo, int hi) {
    int i, k;
    for (i = 0; i < s->seam_count; i++)
        for (k = 0; s->welded[i] && s->seam[i].desc.rest_angle != 0.0 && k + 1 < s->seam[i].desc.count; k++) {
            int p = yci_seam_point(s, s->seam + i, 0, k), q = yci_seam_point(s, s->seam + i, 0, k + 1);
            if ((p == lo && q == hi) || (p == hi && q == lo)) return s->seam[i].desc.rest_angle;
        }
    return 0.0;
}

static int yci_build_hinge(const yci_build *b, const yci_side *p, const yci_side *q) {
    const yci_side *side[2];
    double length = 0.0, area = 0.0, weight = 0.0, rigidity = 0.0;
    yci_hinge *e;
    int k;
    side[0] = p->forward ? p : q, side[1] = p->forward ? q : p;
    if (p->forward == q->forward) return 1; /* wound against each other: refused when the mesh or seam was added */
    for (k = 0; k < 2; k++) {
        const yci_cloth *cloth = b->s->cloth + side[k]->cloth;
        yci_membrane rest;
        double uv[6], edge[3] = {0.0, 0.0, 0.0}, w;
        int from = side[k]->corner, to = (from + 1) % 3;
        yci_cloth_weight(cloth, side[k]->triangle, &w);
        yci_cloth_uv(cloth, side[k]->triangle, uv);
        yci_triangle_rest(&rest, uv, 0.0, 1.0);
        edge[0] = uv[2 * to] - uv[2 * from], edge[1] = uv[2 * to + 1] - uv[2 * from + 1];
        length += 0.5 * yci_norm(edge), area += rest.area, weight += 0.5 * w;
        rigidity += 0.5 * cloth->desc.material.bending;
    }
    if (rigidity <= 0.0 || weight <= 0.0) return 1;
    e = YCI_PUSH(b, hinge);
    if (!e) return 0;
    e->node[0] = p->lo, e->node[1] = p->hi;
    for (k = 0; k < 2; k++)
        e->node[2 + k] =
            b->s->triangle[3 * (b->s->cloth[side[k]->cloth].triangle + side[k]->triangle) + (side[k]->corner + 2) % 3];
    e->stiffness = weight * rigidity * length * length / area, e->rest = yci_seam_angle(b->s, p->lo, p->hi),
    e->previous = e->rest;
    return 1;
}

/* Hinges of all cloths together, so that a welded seam bends like the rest; and the edges, for contact. */
static int yci_build_hinges(yci_build *b) {
    yci_context *c = &b->s->c;
    yci_side *side = YCI_NEW(c, yci_side, 6 * (size_t)b->s->triangles), *scratch = side + 3 * (size_t)b->s->triangles;
    int i, t, k, count = 0, ok = side != NULL;
    for (i = 0; ok && i < b->s->cloth_count; i++)
        for (t = 0; t < b->s->cloth[i].desc.mesh.triangle_count; t++) {
            double weight;
            if (!yci_cloth_weight(b->s->cloth + i, t, &weight)) continue;
            for (k = 0; k < 3; k++) {
                const int *v = b->s->triangle + 3 * (b->s->cloth[i].triangle + t);
                yci_side *x = side + count++;
                x->forward = v[k] < v[(k + 1) % 3];
                x->lo = x->forward ? v[k] : v[(k + 1) % 3], x->hi = x->forward ? v[(k + 1) % 3] : v[k];
                x->cloth = i, x->triangle = t, x->corner = k;
            }
        }
    if (ok) yci_side_sort(side, scratch, count);
    for (i = 0; ok && i < count; i++) {
        int pair = i + 1 < count && side[i].lo == side[i + 1].lo && side[i].hi == side[i + 1].hi;
        if (b->s->desc.self_contact) {
            int *e;
            ok = (e = YCI_PUSH(b, edge)) != NULL;
            if (ok) *e = side[i].lo;
            ok = ok && (e = YCI_PUSH(b, edge)) != NULL;
            if (ok) *e = side[i].hi;
        }
        if (ok && pair) ok = yci_build_hinge(b, side + i, side + i + 1), i++;
    }
    yci_free(c, side);
    return ok;
}

static int yci_build_stitches(yci_build *b) {
    int i, k;
    for (i = 0; i < b->s->seam_count; i++)
        for (k = 0; !b->s->welded[i] && k < b->s->seam[i].desc.count; k++) {
            int p = yci_seam_point(b->s, b->s->seam + i, 0, k), q = yci_seam_point(b->s, b->s->seam + i, 1, k);
            yci_stitch *e;
            if (p == q) continue;
            e = YCI_PUSH(b, stitch);
            if (!e) return 0;
            e->node[0] = p, e->node[1] = q, e->seam = i, e->stiffness = b->s->seam[i].desc.stiffness;
        }
    return 1;
}

/* Points that feel bodies: vertices, full and hybrid yarn nodes, and triangle centres. */
static int yci_build_probes(yci_build *b) {
    yci_model *m = b->m;
    yc_scene *s = b->s;
    int i, k;
    for (i = 0; i < s->nodes; i++) {
        yci_probe *e;
        if (m->role[i] == YCI_IDLE || m->share[i] <= 0.0) continue;
        e = YCI_PUSH(b, probe);
        if (!e) return 0;
        e->count = 1, e->node[0] = i, e->weight = m->share[i],
        e->thickness = i < s->vertices ? s->desc.thickness : m->radius[i - s->vertices];
    }
    for (i = 0; i < m->face_count; i++) {
        yci_probe *e = YCI_PUSH(b, probe);
        if (!e) return 0;
        e->count = 3, e->weight = 0.0, e->thickness = s->desc.thickness;
        for (k = 0; k < 3; k++) e->node[k] = m->face[i].node[k], e->weight += m->share[e->node[k]] / 3.0;
    }
    return 1;
}

/* ---- model: unknowns and the linear system ---- */

/* Numbers the nodes that have unknowns. */
static void yci_build_unknowns(yc_scene *s, yci_model *m, int *dim, int *count) {
    int i, k, n = 0;
    for (k = 0; k < s->nodes; k++) {
        int active = m->role[i = m->walk[k]] != YCI_IDLE;
        m->system_node[i] = !active ? -1 : m->held[i] ? -2 - m->pinned++ : n;
        if (active && !m->held[i]) m->node_of[n] = i, dim[n++] = 3;
    }
    for (i = 0; i < s->visits; i++)
        if (m->visit_slot[i] >= 0) dim[m->system_node[s->visit_node[i]]]++;
    for (i = 0; i < s->visits && m->height_slot; i++) {
        int slot = m->height_slot[i], at = m->system_node[s->visit_node[i]];
        if (slot >= 0 && slot >= dim[at]) dim[at] = slot + 1;
    }
    *count = n;
}

/* Couplings of an element's nodes, added to the list; a NULL list counts. */
static size_t yci_build_couple(const yci_model *m, const int *node, int count, int (*pairs)[2], size_t at) {
    int i, j;
    for (i = 0; i < count; i++)
        for (j = 0; j < i; j++) {
            if (m->system_node[node[i]] < 0 || m->system_node[node[j]] < 0 || node[i] == node[j]) continue;
            if (pairs) pairs[at][0] = m->system_node[node[i]], pairs[at][1] = m->system_node[node[j]];
            at++;
        }
    return at;
}

static size_t yci_build_couplings(const yc_scene *s, const yci_model *m, int (*pairs)[2]) {
    size_t at = 0;
    int i, node[4];
    for (i = 0; i < m->segment_count; i++) {
        node[0] = s->visit_node[m->segment[i].a], node[1] = s->visit_node[m->segment[i].b];
        at = yci_build_couple(m, node, 2, pairs, at);
    }
    for (i = 0; i < m->bend_count; i++) {
        node[0] = s->visit_node[m->bend[i].a], node[1] = s->visit_node[m->bend[i].b],
        node[2] = s->visit_node[m->bend[i].c];
        at = yci_build_couple(m, node, 3, pairs, at);
    }
    for (i = 0; i < m->kink_count; i++) {
        node[0] = s->visit_node[m->kink[i].a], node[1] = s->visit_node[m->kink[i].b],
        node[2] = s->visit_node[m->kink[i].c];
        at = yci_build_couple(m, node, 3, pairs, at);
    }
    for (i = 0; i < m->wrap_count; i++) {
        const yci_wrap *e = m->wrap + i;
        node[0] = s->visit_node[e->a], node[1] = s->visit_node[e->b], node[2] = s->visit_node[e->p],
        node[3] = s->visit_node[e->q];
        at = yci_build_couple(m, node, 4, pairs, at);
    }
    for (i = 0; i < m->shear_count; i++) at = yci_build_couple(m, m->shear[i].node, 3, pairs, at);
    for (i = 0; i < m->face_count; i++) at = yci_build_couple(m, m->face[i].node, 3, pairs, at);
    for (i = 0; i < m->hinge_count; i++) at = yci_build_couple(m, m->hinge[i].node, 4, pairs, at);
    for (i = 0; i < m->stitch_count; i++) at = yci_build_couple(m, m->stitch[i].node, 2, pairs, at);
    for (i = 0; i < m->pairs.count; i++)
        at = yci_build_couple(m, m->pairs.pair[i].node, yci_pair_nodes(m->pairs.pair[i].kind), pairs, at);
    return at;
}

/* A direct solve of many yarn nodes costs more than the two levels, in time and in memory. Knits of 26,000 nodes take
 * as long by both, and 0.54 GB instead of 0.24. */
static yc_solver yci_build_solver(const yc_scene *s, const yci_model *m) {
    if (s->desc.solver != YC_SOLVER_AUTO) return s->desc.solver;
    return m->hybrid || m->full > (m->knitted ? YCI_DIRECT_KNIT : YCI_DIRECT_LIMIT) ? YC_SOLVER_TWO_LEVEL
                                                                                    : YC_SOLVER_DIRECT;
}

/* A node of a knit, and how far it lies along the rows. */
typedef struct yci_sweep {
    double at;
    int node;
} yci_sweep;

static int yci_sweep_compare(const void *a, const void *b) {
    const yci_sweep *x = (const yci_sweep *)a, *y = (const yci_sweep *)b;
    return x->at != y->at ? (x->at > y->at) - (x->at < y->at) : (x->node > y->node) - (x->node < y->node);
}

/* The direction of a knit's rows in its layout: the main one in which yarn gets on within a loop. */
static void yci_knit_rows(const yc_yarns *y, double *rows) {
    double xx = 0.0, xy = 0.0, yy = 0.0, d[3], angle;
    int k, v;
    for (k = 0; k < y->yarn_count; k++)
        for (v = y->yarn_first[k]; v + YCI_LOOP < y->yarn_first[k + 1]; v++) {
            yci_sub(d, y->layout[y->visit_node[v + YCI_LOOP]], y->layout[y->visit_node[v]]);
            xx += d[0] * d[0], xy += d[0] * d[1], yy += d[1] * d[1];
        }
    angle = 0.5 * atan2(2.0 * xy, xx - yy);
    rows[0] = cos(angle), rows[1] = sin(angle);
}

/* The incomplete factor has the nodes of a knit wale by wale, whatever the order of its yarn: course by course, between
 * which yarn goes up and down, it needs shifts and takes four to ten times the iterations. */
static void yci_build_sweep(const yc_scene *s, const yci_model *m, yci_sweep *sweep, int *order, int count) {
    int i, k = 0, begin;
    for (i = 0; i < s->cloth_count; i++) {
        const yci_cloth *cloth = s->cloth + i;
        const yc_yarns *y = yci_cloth_yarns(cloth);
        double rows[2];
        if (y && cloth->knit) yci_knit_rows(y, rows);
        for (begin = k; y && k < count && m->node_of[order[k]] < cloth->node + y->node_count; k++) {
            const double *at = y->layout[m->node_of[order[k]] - cloth->node];
            sweep[k].at = cloth->knit ? rows[0] * at[0] + rows[1] * at[1] : 0.0;
            sweep[k].node = order[k];
        }
        qsort(sweep + begin, (size_t)(k - begin), sizeof *sweep, yci_sweep_compare);
    }
    for (i = 0; i < k; i++) order[i] = sweep[i].node;
}

/* The coarse space of a cloth without a mesh: a grid over its layout, each cell of about YCI_NET_NODES nodes split into
 * two triangles. Its vertices are numbered behind those of all meshes. */
typedef struct yci_net {
    int cells[2];
    double low[2], step[2]; /* m */
} yci_net;

static int yci_net_make(const yc_yarns *y, yci_net *net) {
    double high[2], cell;
    int i, k;
    for (k = 0; k < 2; k++) net->low[k] = high[k] = y->layout[0][k];
    for (i = 1; i < y->node_count; i++)
        for (k = 0; k < 2; k++) {
            net->low[k] = yci_min(net->low[k], y->layout[i][k]);
            high[k] = yci_max(high[k], y->layout[i][k]);
        }
    cell = sqrt((y->contact_count ? YCI_NET_KNIT : YCI_NET_NODES) * (high[0] - net->low[0]) * (high[1] - net->low[1]) /
        y->node_count);
    for (k = 0; k < 2; k++) {
        double width = high[k] - net->low[k];
        net->cells[k] = cell > 0.0 ? (int)yci_clamp(floor(width / cell + 0.5), 1.0, (double)y->node_count) : 1;
        net->step[k] = width > 0.0 ? width / net->cells[k] : 1.0;
    }
    return (net->cells[0] + 1) * (net->cells[1] + 1);
}

static void yci_net_place(const yci_net *net, const double *point, int first, int *vertex, double *weight) {
    double at[2];
    int cell[2], k, row = net->cells[0] + 1, corner, low;
    for (k = 0; k < 2; k++) {
        at[k] = (point[k] - net->low[k]) / net->step[k];
        cell[k] = (int)yci_clamp(floor(at[k]), 0.0, (double)(net->cells[k] - 1));
        at[k] -= cell[k];
    }
    corner = first + cell[1] * row + cell[0], low = at[0] >= at[1];
    vertex[0] = corner, vertex[1] = corner + (low ? 1 : row), vertex[2] = corner + row + 1;
    weight[2] = yci_min(at[0], at[1]), weight[1] = yci_max(at[0], at[1]) - weight[2];
    weight[0] = 1.0 - weight[1] - weight[2];
}

typedef struct yci_system_scratch {
    int *dim, *vertex_node, *order, *triangle;
    double *beta;
    yci_sweep *sweep; /* NULL: no knit */
    unsigned char *state, *is_yarn, *is_hybrid;
    int (*pairs)[2];
} yci_system_scratch;

static void yci_build_input(yc_scene *s, yci_model *m, yci_system_scratch *w, yci_system_input *in) {
    int i, k, n = in->n, vertices = s->vertices;
    for (i = 0; i < s->vertices; i++) {
        w->vertex_node[i] = m->system_node[i] >= 0 ? m->system_node[i] : -1;
        w->state[i] = (unsigned char)(m->system_node[i] >= 0 ? 1 : m->system_node[i] <= -2 ? 2 : 0);
    }
    for (i = 0; i < n; i++) w->triangle[3 * i] = -1;
    for (i = 0; i < s->cloth_count; i++) {
        const yc_yarns *y = yci_cloth_yarns(s->cloth + i);
        yci_net net;
        int node, first = vertices;
        if (y && !y->triangle) vertices += yci_net_make(y, &net);
        for (node = 0; y && node < y->node_count; node++) {
            int at = m->system_node[s->cloth[i].node + node];
            if (at < 0) continue;
            if (!y->triangle) yci_net_place(&net, y->layout[node], first, w->triangle + 3 * at, w->beta + 3 * at);
            w->is_yarn[at] = 1, w->is_hybrid[at] = m->role[s->cloth[i].node + node] == YCI_HYBRID;
            for (k = 0; y->triangle && k < 3; k++) {
                w->triangle[3 * at + k] = s->triangle[3 * (s->cloth[i].triangle + y->triangle[node]) + k];
                w->beta[3 * at + k] = y->weights[node][k];
            }
        }
    }
    for (i = s->vertices; i < vertices; i++) w->vertex_node[i] = -1;
    for (i = 0; i < n; i++)
        if (w->is_yarn[i]) w->order[in->order_count++] = i;
    if (w->sweep) yci_build_sweep(s, m, w->sweep, w->order, in->order_count), in->fill = YCI_KNIT_FILL;
    in->dim = w->dim, in->pair = (const int(*)[2])w->pairs, in->vertex_count = vertices,
    in->vertex_node = w->vertex_node;
    in->vertex_state = w->state, in->is_yarn = w->is_yarn, in->is_hybrid = w->is_hybrid;
    in->triangle = (const int(*)[3])w->triangle, in->beta = (const double(*)[3])w->beta, in->order = w->order;
    in->solver = yci_build_solver(s, m);
}

/* (Re)builds the system for the present elements and contact pairs. On failure the model has none. */
static yc_result yci_build_system(yc_scene *s, yci_model *m) {
    yci_context *c = &s->c;
    yci_system_scratch w;
    yci_system_input in;
    yc_result result = YC_ERROR_MEMORY;
    size_t n = (size_t)s->nodes, vertices = (size_t)s->vertices;
    yci_net net;
    int i;
    if (m->has_system) yci_system_destroy(&m->system);
    m->has_system = 0, m->pinned = 0;
    memset(&w, 0, sizeof w), memset(&in, 0, sizeof in);
    for (i = 0; i < s->cloth_count; i++) {
        const yc_yarns *y = yci_cloth_yarns(s->cloth + i);
        if (y && !y->triangle) vertices += (size_t)yci_net_make(y, &net);
    }
    w.dim = YCI_NEW(c, int, n), w.vertex_node = YCI_NEW(c, int, vertices),
    w.state = YCI_NEW(c, unsigned char, vertices);
    if (w.dim && w.vertex_node && w.state) {
        yci_build_unknowns(s, m, w.dim, &in.n);
        in.pair_count = yci_build_couplings(s, m, NULL);
        w.pairs = (int(*)[2])yci_alloc(c, in.pair_count, sizeof *w.pairs);
        w.triangle = YCI_NEW(c, int, 3 * (size_t)in.n), w.beta = YCI_NEW(c, double, 3 * (size_t)in.n),
        w.order = YCI_NEW(c, int, in.n);
        w.is_yarn = YCI_NEW(c, unsigned char, in.n), w.is_hybrid = YCI_NEW(c, unsigned char, in.n);
        if (m->knitted) w.sweep = YCI_NEW(c, yci_sweep, in.n);
        if (w.pairs && w.triangle && w.beta && w.order && w.is_yarn && w.is_hybrid && (w.sweep || !m->knitted)) {
            yci_build_couplings(s, m, w.pairs);
            yci_build_input(s, m, &w, &in);
            if (in.solver == YC_SOLVER_DIRECT && m->hybrid)
                result = YCI_FAIL(
                    c, YC_ERROR_ARGUMENT, "scene.solver: YC_SOLVER_DIRECT cannot solve the %d hybrid nodes", m->hybrid);
            else result = yci_system_create(c, &in, &m->system);
            m->solver = in.solver;
        }
    }
    yci_free(c, w.dim), yci_free(c, w.vertex_node), yci_free(c, w.state), yci_free(c, w.pairs), yci_free(c, w.triangle);
    yci_free(c, w.beta), yci_free(c, w.order), yci_free(c, w.sweep), yci_free(c, w.is_yarn), yci_free(c, w.is_hybrid);
    if (result == YC_ERROR_MEMORY) return yci_out_of_memory(c, "the linear system");
    if (result != YC_OK) return result;
    m->has_system = 1, m->hybrid_vertices = m->hybrid ? m->system.mixed.t_count : 0;
    return YC_OK;
}

/* What contact needs: radii of yarn nodes, the faces' nodes, rest positions with cloths far apart. */
static int yci_build_contact(yci_build *b) {
    yc_scene *s = b->s;
    yci_model *m = b->m;
    yci_context *c = &s->c;
    int i, k, visit, t;
    m->radius = YCI_NEW(c, double, s->nodes - s->vertices);
    if (!m->radius) return 0;
    for (i = 0; i < s->cloth_count; i++) {
        const yc_yarns *y = yci_cloth_yarns(s->cloth + i);
        for (k = 0; y && k < y->yarn_count; k++)
            for (visit = y->yarn_first[k]; visit < y->yarn_first[k + 1]; visit++) {
                double *r = m->radius + s->cloth[i].node - s->vertices + y->visit_node[visit];
                *r = yci_max(*r, y->materials[y->yarn_material[k]].radius);
            }
    }
    if (!yci_build_probes(b)) return 0;
    if (!s->desc.self_contact) return 1;
    m->rest = YCI_NEW(c, double, 3 * (size_t)s->nodes), m->face_node = YCI_NEW(c, int, 3 * (size_t)m->face_count);
    m->closed = YCI_NEW(c, int, s->nodes), m->half = YCI_NEW(c, double, s->nodes - s->vertices);
    if (!m->rest || !m->face_node || !m->closed || !m->half) return 0;
    for (i = 0; i < 3 * m->face_count; i++) m->face_node[i] = m->face[i / 3].node[i % 3];
    for (i = 0; i < s->nodes; i++) {
        int *ball;
        m->closed[i] = i < s->vertices ? s->weld[i] : i;
        if (m->role[i] != YCI_FULL && !(i < s->vertices && m->role[i] == YCI_TRIANGLE && m->share[i] > 0.0)) continue;
        ball = YCI_PUSH(b, ball);
        if (!ball) return 0;
        *ball = i;
    }
    for (i = 0; i < s->cloth_count; i++) {
        const yci_cloth *cloth = s->cloth + i;
        const yc_yarns *y = yci_cloth_yarns(cloth);
        for (t = 0; t < cloth->desc.mesh.triangle_count; t++)
            for (k = 0; k < 3; k++)
                memcpy(m->rest + 3 * s->triangle[3 * (cloth->triangle + t) + k],
                    cloth->desc.mesh.uv[cloth->desc.mesh.uv_triangles[t][k]], 2 * sizeof(double));
        for (t = 0; y && t < y->node_count; t++) yci_copy(m->rest + 3 * (cloth->node + t), y->layout[t]);
        for (t = 0; t < cloth->desc.mesh.vertex_count; t++) m->rest[3 * (cloth->vertex + t) + 2] += YCI_APART * i;
        for (t = 0; y && t < y->node_count; t++) m->rest[3 * (cloth->node + t) + 2] += YCI_APART * i;
        for (k = 0; y && k < y->yarn_count; k++)
            for (visit = y->yarn_first[k]; visit < y->yarn_first[k + 1]; visit++)
                m->half[cloth->node - s->vertices + y->visit_node[visit]] += y->materials[y->yarn_material[k]].radius;
    }
    for (i = 0; i < s->seam_count; i++) /* Open seams count as closed: their sides do not repel each other. */
        for (k = 0; k < s->seam[i].desc.count; k++) {
            int p = m->closed[yci_seam_point(s, s->seam + i, 0, k)], v;
            int q = m->closed[yci_seam_point(s, s->seam + i, 1, k)], end = p < s->vertices ? s->vertices : s->nodes;
            for (v = 0; p != q && v < end; v++)
                if (m->closed[v] == (p > q ? p : q)) m->closed[v] = p < q ? p : q;
        }
    return 1;
}

static yc_result yci_scene_build(yc_scene *s) {
    yci_context *c = &s->c;
    yci_model *m;
    yci_build b;
    yc_result result;
    int i, ok, first, size;
    if (s->model && s->model->has_system) return YC_OK;
    yci_model_destroy(s); /* a search that ran out of memory may have left it without a system */
    s->model = m = YCI_NEW(c, yci_model, 1);
    if (!m) return yci_out_of_memory(c, "the model");
    b.s = s, b.m = m;
    m->held = YCI_NEW(c, unsigned char, s->nodes), m->holder = YCI_NEW(c, int, s->vertices);
    m->role = YCI_NEW(c, unsigned char, s->nodes), m->share = YCI_NEW(c, double, s->nodes),
    m->system_node = YCI_NEW(c, int, s->nodes);
    m->walk = YCI_NEW(c, int, s->nodes), m->node_of = YCI_NEW(c, int, s->nodes),
    m->visit_slot = YCI_NEW(c, int, s->visits), m->mass = YCI_NEW(c, double, s->nodes);
    m->mass_fixed = YCI_NEW(c, double, s->nodes), m->local = YCI_NEW(c, yci_local, YCI_CHUNK);
    ok = m->held && m->holder && m->role && m->share && m->system_node && m->walk && m->node_of && m->visit_slot &&
        m->mass && m->mass_fixed && m->local;
    if (ok && s->crimped) {
        m->undulates = YCI_NEW(c, unsigned char, s->visits), m->lift = YCI_NEW(c, double, s->visits);
        m->thrust = YCI_NEW(c, double, s->visits), m->height_slot = YCI_NEW(c, int, s->visits);
        ok = m->undulates && m->lift && m->thrust && m->height_slot;
    }
    if (ok) yci_build_walk(s, m), yci_build_roles(s, m), yci_build_drop_loners(s, m), yci_build_holders(s, m);
    for (i = 0; ok && i < s->cloth_count; i++) {
        b.cloth = s->cloth + i, b.yarns = yci_cloth_yarns(b.cloth);
        ok = !b.yarns || yci_build_yarns(&b);
        first = m->face_count;
        ok = ok && yci_build_faces(&b);
        if (ok && b.yarns) yci_build_spread_mass(&b, first);
    }
    ok = ok && yci_build_hinges(&b) && yci_build_stitches(&b) && yci_build_contact(&b);
    result = ok ? yci_build_system(s, m) : yci_out_of_memory(c, "the model");
    if (result == YC_OK) {
        size = yci_system_size(&m->system);
        m->dof = YCI_NEW(c, double, 8 * (size_t)size + 3 * (size_t)m->pinned);
        if (!m->dof) result = yci_out_of_memory(c, "the model");
        else {
            m->dof_n = m->dof + size, m->dof_free = m->dof_n + size, m->dof_best = m->dof_free + size;
            m->start = m->dof_best + size, m->gradient = m->start + size;
            m->direction = m->gradient + size, m->right = m->direction + size, m->reaction = m->right + size;
        }
    }
    if (result != YC_OK) yci_model_destroy(s);
    return result;
}

/* ---- evaluation of one element ---- */

/* What is evaluated: energy alone, gradient too, positive semidefinite Hessian too. */
enum { YCI_ENERGY, YCI_GRADIENT, YCI_HESSIAN };

static void yci_local_nodes(yci_local *out, int count, const int *node) {
    int i;
    out->nodes = count, out->points = out->dofs = 3 * count;
    for (i = 0; i < count; i++) out->node[i] = node[i];
    for (i = 0; i < 3 * count; i++) out->slot[i] = (short)(i / 3), out->comp[i] = (short)(i % 3);
}

static void yci_local_gather(const yc_scene *s, const yci_local *out, double *q) {
    int i;
    for (i = 0; i < out->nodes; i++) yci_copy(q + 3 * i, s->x + 3 * out->node[i]);
}

/* Appends u of a visit as the element's next unknown. */
static void yci_local_slide(const yc_scene *s, yci_local *out, double *q, int slot, int visit) {
    q[out->dofs] = s->u[visit];
    out->slot[out->dofs] = (short)slot, out->comp[out->dofs] = (short)s->model->visit_slot[visit];
    out->dofs++;
}

/* Whether a visit's yarn undulates. */
static int yci_crimped(const yci_model *m, int visit) { return m->undulates && m->undulates[visit]; }

/* How far a visit passes from its node, m. */
static double yci_rise(const yc_scene *s, int visit) {
    return yci_crimped(s->model, visit) ? s->model->lift[visit] + s->z[visit] : 0.0;
}

/* The element of two neighbouring visits' u alone. */
static void yci_local_slides(const yc_scene *s, yci_local *out, double *q, int a, int b) {
    out->nodes = 2, out->points = out->dofs = 0;
    out->node[0] = s->visit_node[a], out->node[1] = s->visit_node[b];
    yci_local_slide(s, out, q, 0, a), yci_local_slide(s, out, q, 1, b);
}

/* Appends y of a visit likewise: it varies as z does. */
static void yci_local_rise(const yc_scene *s, yci_local *out, double *q, int slot, int visit) {
    q[out->dofs] = yci_rise(s, visit);
    out->slot[out->dofs] = (short)slot, out->comp[out->dofs] = (short)s->model->height_slot[visit];
    out->dofs++;
}

/* The unknowns of a kink. */
static void yci_local_kink(const yc_scene *s, yci_local *out, double *q, const int *visit) {
    int i;
    out->nodes = 3, out->points = out->dofs = 0;
    for (i = 0; i < 3; i++) out->node[i] = s->visit_node[visit[i]];
    for (i = 0; i < 3; i++) yci_local_rise(s, out, q, i, visit[i]);
    for (i = 0; i < 3; i++) yci_local_slide(s, out, q, i, visit[i]);
}

/* The unknowns of a crossing that flattens. */
static void yci_local_flatten(const yc_scene *s, yci_local *out, double *q, const yci_flatten *e) {
    out->nodes = 1, out->points = out->dofs = 0;
    out->node[0] = s->visit_node[e->a];
    yci_local_rise(s, out, q, 0, e->a);
    yci_local_rise(s, out, q, 0, e->b);
}

/* The unknowns of two or three visits: positions, and u of the first and the last. */
static void yci_local_visits(const yc_scene *s, yci_local *out, double *q, int count, const int *visit) {
    int i, node[3];
    for (i = 0; i < count; i++) node[i] = s->visit_node[visit[i]];
    yci_local_nodes(out, count, node);
    yci_local_gather(s, out, q);
    yci_local_slide(s, out, q, 0, visit[0]);
    yci_local_slide(s, out, q, count - 1, visit[count - 1]);
}

/* A segment with crimp is as long upright as flat, and a short end of yarn in a deep wave would stand up until its
 * nodes meet, where no angle has a direction. The floor, here of their distance, keeps them apart. */
static void yci_eval_upright(const yci_segment *e, const double *q, int mode, yci_local *out) {
    double d[3], ends[2] = {0.0, 0.0}, g[2], h[4];
    yci_sub(d, q + 3, q);
    ends[1] = yci_normalize(d, d);
    out->energy += yci_yarn_floor(ends, YCI_HARDNESS * e->stretch, e->floor, g, h);
    for (int i = 0; i < 6 && mode; i++) {
        double sign = i < 3 ? -1.0 : 1.0;
        out->g[i] += sign * g[1] * d[i % 3];
        for (int j = 0; j < 6 && mode == YCI_HESSIAN; j++)
            out->h[out->dofs * i + j] += (i / 3 == j / 3 ? 1.0 : -1.0) * h[3] * d[i % 3] * d[j % 3];
    }
}

/* The part of a vector of the system's size that belongs to the element; NULL is zero. */
static void yci_local_direction(const yci_model *m, const yci_local *e, const double *direction, double *dq) {
    int i;
    for (i = 0; i < e->dofs; i++) {
        int node = m->system_node[e->node[e->slot[i]]];
        dq[i] = direction && node >= 0 && e->comp[i] >= 0 ? direction[m->system.a.off[node] + e->comp[i]] : 0.0;
    }
}

/* The unknowns of a segment; with crimp both heights too. */
static void yci_local_segment(const yc_scene *s, yci_local *out, double *q, const yci_segment *e) {
    yci_local_visits(s, out, q, 2, &e->a);
    if (!yci_crimped(s->model, e->a)) return;
    yci_local_rise(s, out, q, 0, e->a);
    yci_local_rise(s, out, q, 1, e->b);
}

/* Adds a second element with the same unknowns. */
static void yci_local_add(yci_local *out, const double *g, const double *h) {
    int i;
    for (i = 0; i < out->dofs && g; i++) out->g[i] += g[i];
    for (i = 0; i < out->dofs * out->dofs && h; i++) out->h[i] += h[i];
}

static double yci_stitch_rest(const yc_scene *s, const yci_stitch *e) {
    const yci_seam *seam = s->seam + e->seam;
    double t = s->time + s->model->h - seam->start;
    return t >= seam->desc.close_time ? 0.0 : seam->gap * (1.0 - t / seam->desc.close_time);
}

/* Spring of an open seam: 1/2 k (l - r)^2 for l > r, so that it only draws. Its Hessian keeps the stiffness across. */
static void yci_eval_stitch(const yc_scene *s, const yci_stitch *e, int mode, yci_local *out) {
    double d[3], up[3] = {0.0, 1.0, 0.0}, length, stretch, across;
    int i, j;
    yci_local_nodes(out, 2, e->node);
    yci_sub(d, s->x + 3 * e->node[1], s->x + 3 * e->node[0]);
    length = yci_normalize(d, up);
    stretch = yci_max(length - yci_stitch_rest(s, e), 0.0);
    out->energy = 0.5 * e->stiffness * stretch * stretch;
    if (!mode) return;
    yci_scale(out->g + 3, d, e->stiffness * stretch), yci_scale(out->g, d, -e->stiffness * stretch);
    across = stretch > 0.0 ? e->stiffness * stretch / length : 0.0;
    for (i = 0; i < 6; i++)
        for (j = 0; j < 6; j++) {
            double along = stretch > 0.0 ? (e->stiffness - across) * d[i % 3] * d[j % 3] : 0.0;
            out->h[6 * i + j] = (i / 3 == j / 3 ? 1.0 : -1.0) * (along + (i % 3 == j % 3 ? across : 0.0));
        }
}

/* Penalty and friction in x_rel, spread to the nodes. `u` is the relative displacement over the step. */
static void yci_eval_contact(const yc_scene *s, yci_local *out, double d, const double *n, const double *w,
    double thickness, double stiffness, double limit, const double *lagged, const double *share, const double *u,
    int mode) {
    double g[3], h[9], lambda;
    out->energy = yci_contact_normal(d, n, thickness, stiffness, &lambda, g, h);
    if (mode) {
        yci_zero(out->g, out->dofs), yci_zero(out->h, out->dofs * out->dofs);
        if (lambda > 0.0) yci_contact_spread(out->nodes, w, g, h, out->g, out->h);
    }
    if (limit <= 0.0 || s->model->h <= 0.0) return;
    out->energy += yci_contact_friction(u, lagged, limit, s->desc.slip_speed * s->model->h, g, h);
    if (mode) yci_contact_spread(out->nodes, share, g, h, out->g, out->h);
}

/* Displacement of sum w_i x_i since the step's start. */
static void yci_step_motion(const yc_scene *s, int count, const int *node, const double *w, double *u) {
    double d[3];
    int i;
    yci_zero(u, 3);
    for (i = 0; i < count; i++) {
        yci_sub(d, s->x + 3 * node[i], s->x_n + 3 * node[i]);
        yci_axpy(u, w[i], d);
    }
}

static void yci_probe_place(const yc_scene *s, const yci_probe *p, double *x, double *w) {
    int i;
    yci_zero(x, 3);
    for (i = 0; i < p->count; i++) w[i] = 1.0 / p->count, yci_axpy(x, w[i], s->x + 3 * p->node[i]);
}

static void yci_eval_touch(const yc_scene *s, const yci_touch *e, int mode, yci_local *out) {
    const yci_probe *p = s->model->probe + e->probe;
    const yci_body_sdf *body = s->body + e->body;
    double x[3], w[3], n[3], u[3], moved[3], d;
    yci_local_nodes(out, p->count, p->node);
    yci_probe_place(s, p, x, w);
    d = yci_body_distance(body, x, n);
    yci_step_motion(s, p->count, p->node, w, u);
    yci_body_motion(body, x, moved);
    yci_axpy(u, -1.0, moved);
    yci_eval_contact(s, out, d, n, w, p->thickness, p->weight * s->desc.contact_stiffness, body->friction * e->lambda,
        e->normal, w, u, mode);
}

static void yci_eval_grip(const yc_scene *s, const yci_pair *pair, const yci_grip *e, int mode, yci_local *out) {
    int count = yci_pair_nodes(pair->kind);
    double n[3], w[4], u[3], d;
    yci_local_nodes(out, count, pair->node);
    d = yci_pair_distance(pair, s->x, n, w);
    yci_step_motion(s, count, pair->node, e->share, u);
    yci_eval_contact(s, out, d, n, w, pair->thickness, e->weight * s->desc.contact_stiffness,
        s->desc.self_friction * e->lambda, e->normal, e->share, u, mode);
}

/* What the friction of a slide is about: how far its yarn is, or has slid past its neighbour. */
static double yci_slid(const yc_scene *s, const yci_slide *e) {
    return e->other < 0 ? s->u[e->visit] : s->u[e->visit] - e->sign * (s->u[e->other] - e->from);
}

/* The unknowns of a wrapped pair: its contact's nodes, then the far ends of the tails. */
static void yci_local_wrap(const yc_scene *s, yci_local *out, double *q, const yci_wrap *e) {
    int node[4];
    node[0] = s->visit_node[e->a], node[1] = s->visit_node[e->b];
    node[2] = s->visit_node[e->p], node[3] = s->visit_node[e->q];
    yci_local_nodes(out, 4, node);
    yci_local_gather(s, out, q);
}

/* What friction holds, mu lambda; nothing where there is none. */
static double yci_rub_limit(const yci_model *m, int rub) { return rub < 0 ? 0.0 : m->rub[rub].limit; }

/* Element `i` of a kind at the present state. Contact and seams write their Hessian with the gradient. */
static void yci_eval_form(const yc_scene *s, int kind, int i, int mode, int projected, yci_local *out) {
    const yci_model *m = s->model;
    double q[12], *g = mode ? out->g : NULL, *h = mode == YCI_HESSIAN ? out->h : NULL;
    switch (kind) {
    case YCI_SEGMENT:
    case YCI_STRETCH:
    case YCI_GRAVITY: {
        const yci_segment *e = m->segment + i;
        int k;
        double weight[8];
        yci_local_segment(s, out, q, e);
        out->energy = 0.0;
        if (kind != YCI_GRAVITY)
            out->energy += out->dofs > 8
                ? yci_yarn_crimp(q, e->stretch, m->rate, e->previous, &e->tension, g, h, projected)
                : yci_yarn_stretch(q, e->stretch, m->rate, e->previous, &e->tension, g, h, projected);
        if (m->searching && mode == YCI_HESSIAN) {
            if (out->dofs > 8) yci_yarn_crimp(q, e->stretch, m->rate, e->previous, NULL, g, NULL, projected);
            else yci_yarn_stretch(q, e->stretch, m->rate, e->previous, NULL, g, NULL, projected);
        }
        if (kind != YCI_GRAVITY && out->dofs > 8) yci_eval_upright(e, q, mode, out);
        if (kind == YCI_STRETCH) break;
        out->energy += yci_yarn_gravity(q, e->density, s->desc.gravity, g ? weight : NULL, NULL, 1);
        for (k = 0; g && k < 8; k++) g[k] += weight[k];
        break;
    }
    case YCI_BEND: {
        const yci_bend *e = m->bend + i;
        yci_local_visits(s, out, q, 3, &e->a);
        out->energy = yci_yarn_bend(q, e->stiffness, e->rest, e->jam, m->rate, e->previous, g, h, projected);
        break;
    }
    case YCI_KINK: {
        const yci_kink *e = m->kink + i;
        yci_local_kink(s, out, q, &e->a);
        out->energy = yci_yarn_kink(q, e->stiffness, e->rest, m->rate, e->previous, g, h, projected);
        break;
    }
    case YCI_SHEAR: {
        const yci_shear *e = m->shear + i;
        yci_yarn_turn turn;
        int rubs = 0;
        yci_local_nodes(out, 3, e->node);
        yci_local_gather(s, out, q);
        if (m->turn_count && yci_rub_limit(m, m->turn[i].rub) > 0.0) {
            const yci_turn *t = m->turn + i;
            turn.anchor = s->turn[t->anchor], turn.k = t->stiffness, turn.limit = t->reach * yci_rub_limit(m, t->rub);
            rubs = 1;
        }
        out->energy = yci_yarn_shear(q, e->stiffness, e->length, e->rest, e->limit, YCI_JAM_WIDTH, m->rate, e->previous,
            rubs ? &turn : NULL, g, h, projected);
        break;
    }
    case YCI_ADJACENT: {
        const yci_adjacent *e = m->adjacent + i;
        yci_local_slides(s, out, q, e->a, e->b);
        out->energy = yci_yarn_floor(q, e->hardness, e->floor, g, h);
        if (e->stiffness > 0.0) {
            double g2[2], h2[4];
            out->energy += yci_yarn_contact(q, e->stiffness, e->distance, g ? g2 : NULL, h ? h2 : NULL);
            yci_local_add(out, g ? g2 : NULL, h ? h2 : NULL);
        }
        break;
    }
    case YCI_FLATTEN: {
        const yci_flatten *e = m->flatten + i;
        yci_local_flatten(s, out, q, e);
        out->energy = yci_yarn_flatten(q, e->stiffness, e->rest, e->depth, m->rate, e->previous, g, h);
        break;
    }
    case YCI_SLIDE: {
        const yci_slide *e = m->slide + i;
        out->nodes = 1, out->points = out->dofs = 0;
        out->node[0] = s->visit_node[e->visit];
        yci_local_slide(s, out, q, 0, e->visit);
        if (e->other >= 0) yci_local_slide(s, out, q, 0, e->other);
        q[0] = yci_slid(s, e);
        out->energy = yci_yarn_friction(q[0], s->anchor[e->visit], e->stiffness, yci_rub_limit(m, e->rub), g, h, 1);
        if (h)
            h[0] *=
                yci_yarn_friction_factor(q[0], s->anchor[e->visit], e->stiffness, yci_rub_limit(m, e->rub), e->share);
        if (e->other >= 0 && g) g[1] = -e->sign * g[0];
        if (e->other >= 0 && h) h[3] = h[0], h[1] = h[2] = -e->sign * h[0];
        break;
    }
    case YCI_WRAP: {
        const yci_wrap *e = m->wrap + i;
        yci_local_wrap(s, out, q, e);
        out->energy = yci_yarn_wrap(q, e->stiffness, e->rest, g, h, projected);
        break;
    }
    case YCI_LENGTH: {
        const yci_length *e = m->length + i;
        yci_local_slides(s, out, q, e->a, e->b);
        out->energy = yci_yarn_length(q, e->stiffness, e->length, g, h);
        break;
    }
    case YCI_FACE: {
        const yci_face *e = m->face + i;
        yci_local_nodes(out, 3, e->node);
        yci_local_gather(s, out, q);
        out->energy = yci_triangle_membrane(q, &e->rest, e->material, m->rate, e->previous, e->stress, g, h, projected);
        break;
    }
    case YCI_HINGE: {
        const yci_hinge *e = m->hinge + i;
        yci_local_nodes(out, 4, e->node);
        yci_local_gather(s, out, q);
        out->energy = yci_triangle_hinge(q, e->stiffness, e->rest, m->rate, e->previous, g, h, projected);
        break;
    }
    case YCI_STITCH: yci_eval_stitch(s, m->stitch + i, mode, out); break;
    case YCI_TOUCH: yci_eval_touch(s, m->touch + i, mode, out); break;
    default: yci_eval_grip(s, m->pairs.pair + i, m->grip + i, mode, out); break;
    }
}

/* Whether the two Hessians of a kind differ. */
static int yci_is_projected(int kind) {
    return kind <= YCI_SHEAR || kind == YCI_WRAP || kind == YCI_FACE || kind == YCI_HINGE;
}

/* The same with the Hessian that Newton's method takes, between the exact and the semidefinite one. */
static void yci_eval(const yc_scene *s, int kind, int i, int mode, yci_local *out) {
    const double convex = s->model->convex;
    yci_local exact;
    int k;
    yci_eval_form(s, kind, i, mode, convex > 0.0, out);
    if (mode != YCI_HESSIAN || convex == 0.0 || convex == 1.0) return;
    if (!yci_is_projected(kind)) return;
    yci_eval_form(s, kind, i, mode, 0, &exact);
    for (k = 0; k < out->dofs * out->dofs; k++) out->h[k] = convex * out->h[k] + (1.0 - convex) * exact.h[k];
}

static int yci_count(const yci_model *m, int kind) {
    switch (kind) {
    case YCI_SEGMENT:
    case YCI_STRETCH:
    case YCI_GRAVITY: return m->segment_count;
    case YCI_BEND: return m->bend_count;
    case YCI_KINK: return m->kink_count;
    case YCI_SHEAR: return m->shear_count;
    case YCI_ADJACENT: return m->adjacent_count;
    case YCI_FLATTEN: return m->flatten_count;
    case YCI_SLIDE: return m->slide_count;
    case YCI_WRAP: return m->wrap_count;
    case YCI_LENGTH: return m->length_count;
    case YCI_FACE: return m->face_count;
    case YCI_HINGE: return m->hinge_count;
    case YCI_STITCH: return m->stitch_count;
    case YCI_TOUCH: return m->touch_count;
    default: return m->pairs.count;
    }
}

/* ---- assembly ---- */

/* Finds where an element's Hessian goes. The blocks are fetched while others are evaluated: they lie far apart. */
static void yci_local_find(const yci_model *m, yci_local *e) {
    const yci_bsr *a = &m->system.a;
    int i, j;
    for (i = 0; i < e->nodes; i++)
        for (j = 0; j < e->nodes; j++) {
            int row = m->system_node[e->node[i]], column = m->system_node[e->node[j]];
            double *block = NULL;
            if (row >= 0 && column >= 0) {
                block = a->val + a->at[yci_bsr_find(a, row, column)];
                YCI_PREFETCH(block), YCI_PREFETCH(block + 8), YCI_PREFETCH(block + 16);
            }
            e->block[i][j] = block;
        }
}

/* Adds the Hessian of an element to the matrix: the 3x3 blocks of its positions, then the rows and columns of further
 * unknowns, which stand behind those of the positions. `node` are the system's. */
static void yci_local_blocks(const yci_bsr *a, const yci_local *e, const int *node) {
    const int n = e->dofs, points = e->points;
    int i, j, r, c;
    for (i = 0; 3 * i < points; i++)
        for (j = 0; 3 * j < points; j++) {
            const double *h = e->h + 3 * (n * i + j);
            double *out = e->block[i][j];
            int stride = out ? a->dim[node[j]] : 0;
            for (r = 0; r < 3 && out; r++, out += stride, h += n) out[0] += h[0], out[1] += h[1], out[2] += h[2];
        }
    for (i = points; i < n; i++) {
        int own = e->slot[i], at = e->comp[i], stride = node[own] >= 0 ? a->dim[node[own]] : 0;
        const double *h = e->h + n * i;
        if (at < 0 || !stride) continue;
        for (j = 0; 3 * j < points; j++) {
            double *row = e->block[own][j], *column = e->block[j][own];
            if (!row) continue;
            row += at * a->dim[node[j]], column += at;
            for (c = 0; c < 3; c++) row[c] += h[3 * j + c], column[c * stride] += e->h[(3 * j + c) * n + i];
        }
        for (j = points; j < n; j++)
            if (e->comp[j] >= 0 && node[e->slot[j]] >= 0)
                e->block[own][e->slot[j]][at * a->dim[node[e->slot[j]]] + e->comp[j]] += h[j];
    }
}

/* Adds an element's gradient and Hessian to the system; at a pinned node the gradient goes to its reaction. */
static void yci_local_scatter(yci_model *m, const yci_local *e, int mode) {
    const yci_bsr *a = &m->system.a;
    int i, node[4] = {-1, -1, -1, -1};
    for (i = 0; i < e->nodes; i++) node[i] = m->system_node[e->node[i]];
    for (i = 0; i < e->dofs; i++) {
        int row = node[e->slot[i]];
        if (e->comp[i] < 0) continue;
        if (row >= 0) m->gradient[a->off[row] + e->comp[i]] += e->g[i];
        else if (row <= -2) m->reaction[3 * (-2 - row) + e->comp[i]] += e->g[i];
    }
    if (mode == YCI_HESSIAN) yci_local_blocks(a, e, node);
}

typedef struct yci_chunk {
    const yc_scene *s;
    int kind, first, mode;
} yci_chunk;

static void yci_eval_block(void *arg, int begin, int end) {
    const yci_chunk *chunk = (const yci_chunk *)arg;
    int i;
    for (i = begin; i < end; i++) {
        yci_local *local = chunk->s->model->local + i;
        yci_eval(chunk->s, chunk->kind, chunk->first + i, chunk->mode, local);
        if (chunk->mode == YCI_HESSIAN) yci_local_find(chunk->s->model, local);
    }
}

/* The energy of one kind of element; with their modes also into gradient and matrix. Elements are evaluated in
 * parallel and added in order, so the bits do not depend on the workers. */
static double yci_assemble_kind(yc_scene *s, int kind, int mode) {
    yci_model *m = s->model;
    yci_chunk chunk;
    double energy = 0.0;
    int i, n, count = yci_count(m, kind);
    chunk.s = s, chunk.kind = kind, chunk.mode = mode;
    for (chunk.first = 0; chunk.first < count; chunk.first += YCI_CHUNK) {
        n = count - chunk.first < YCI_CHUNK ? count - chunk.first : YCI_CHUNK;
        yci_parallel(&s->c, n, 32, yci_eval_block, &chunk);
        for (i = 0; i < n; i++) {
            energy += m->local[i].energy;
            if (mode) yci_local_scatter(m, m->local + i, mode);
        }
    }
    return energy;
}

/* ---- the incremental potential ---- */

/* Where u of a sliding visit, and z of one that is not held, stand among the unknowns. */
static int yci_dof_of_slide(const yc_scene *s, int visit) {
    const yci_model *m = s->model;
    return m->system.a.off[m->system_node[s->visit_node[visit]]] + m->visit_slot[visit];
}
static int yci_dof_of_height(const yc_scene *s, int visit) {
    const yci_model *m = s->model;
    return m->system.a.off[m->system_node[s->visit_node[visit]]] + m->height_slot[visit];
}

/* The unknowns, or their velocities, out of the state's arrays. */
static void yci_dofs_get(const yc_scene *s, const double *x, const double *u, const double *z, double *q) {
    const yci_model *m = s->model;
    int i;
    for (i = 0; i < m->system.a.n; i++) yci_copy(q + m->system.a.off[i], x + 3 * m->node_of[i]);
    for (i = 0; i < m->slide_count; i++) q[yci_dof_of_slide(s, m->slide[i].visit)] = u[m->slide[i].visit];
    for (i = 0; i < s->visits && m->height_slot; i++)
        if (m->height_slot[i] >= 0) q[yci_dof_of_height(s, i)] = z[i];
}

static void yci_dofs_set(yc_scene *s, const double *q) {
    const yci_model *m = s->model;
    int i;
    for (i = 0; i < m->system.a.n; i++) yci_copy(s->x + 3 * m->node_of[i], q + m->system.a.off[i]);
    for (i = 0; i < m->slide_count; i++) s->u[m->slide[i].visit] = q[yci_dof_of_slide(s, m->slide[i].visit)];
    for (i = 0; i < s->visits && m->height_slot; i++)
        if (m->height_slot[i] >= 0) s->z[i] = q[yci_dof_of_height(s, i)];
}

/* Masses at the step's start: blocks of the system, and translational masses of all nodes. */
static void yci_masses(yc_scene *s) {
    yci_model *m = s->model;
    int i, end;
    memset(m->system.mass, 0, m->system.mass_at[m->system.a.n] * sizeof(double));
    memcpy(m->mass, m->mass_fixed, (size_t)s->nodes * sizeof(double));
    for (i = 0; i < m->system.a.n; i++) {
        double *block = m->system.mass + m->system.mass_at[i];
        int d = m->system.a.dim[i];
        block[0] = block[d + 1] = block[2 * d + 2] = m->mass_fixed[m->node_of[i]];
    }
    for (i = 0; i < m->segment_count; i++) {
        const yci_segment *e = m->segment + i;
        double du = s->u_n[e->b] - s->u_n[e->a], half = 0.5 * e->density * du, w[3];
        yci_sub(w, s->x_n + 3 * s->visit_node[e->b], s->x_n + 3 * s->visit_node[e->a]);
        yci_scale(w, w, 1.0 / du);
        for (end = 0; end < 2; end++) {
            int visit = end ? e->b : e->a, node = s->visit_node[visit], at = m->system_node[node], k, d;
            double *block;
            m->mass[node] += half;
            if (at < 0) continue;
            d = m->system.a.dim[at], block = m->system.mass + m->system.mass_at[at];
            if (m->height_slot && m->height_slot[visit] >= 0) block[m->height_slot[visit] * (d + 1)] += half;
            if (m->visit_slot[visit] >= 0) yci_yarn_inertia(half, w, m->visit_slot[visit] - 3, d, block);
            else
                for (k = 0; k < 3; k++) block[k * (d + 1)] += half;
        }
    }
}

/* The part of E that is made of masses: inertia about the free flight, mass damping about the start, gravity of the
 * triangles' mass. */
static double yci_inertia(yc_scene *s, int mode) {
    yci_model *m = s->model;
    const yci_bsr *a = &m->system.a;
    double energy = 0.0, f = 1.0 / (m->h * m->h), c = s->desc.mass_damping / m->h, dof[YCI_BLOCK_MAX] = {0.0},
           lag[YCI_BLOCK_MAX] = {0.0};
    int i, r, t;
    for (i = 0; i < a->n; i++) {
        const double *block = m->system.mass + m->system.mass_at[i];
        double fixed = m->mass_fixed[m->node_of[i]];
        int d = a->dim[i], o = a->off[i];
        double *diagonal = a->val + a->at[a->diag[i]];
        for (r = 0; r < d; r++) dof[r] = m->dof[o + r] - m->dof_free[o + r], lag[r] = m->dof[o + r] - m->dof_n[o + r];
        for (r = 0; r < d; r++) {
            double force = 0.0;
            for (t = 0; t < d; t++) {
                double mass = block[r * d + t];
                force += mass * (f * dof[t] + c * lag[t]);
                energy += 0.5 * mass * (f * dof[r] * dof[t] + c * lag[r] * lag[t]);
                if (mode == YCI_HESSIAN) diagonal[r * d + t] += mass * (f + c);
            }
            if (mode) m->gradient[o + r] += force;
        }
        energy -= fixed * yci_dot(s->desc.gravity, lag); /* measured from the start, where rounding is least */
        if (mode) yci_axpy(m->gradient + o, -fixed, s->desc.gravity);
    }
    return energy;
}

/* E at the present state; with their modes its gradient and the matrix too. *scale receives the sum of |terms|. */
static double yci_potential(yc_scene *s, int mode, double *scale) {
    yci_model *m = s->model;
    double energy, sum;
    int kind;
    if (mode == YCI_HESSIAN) yci_bsr_zero(&m->system.a);
    if (mode) {
        memset(m->gradient, 0, (size_t)yci_system_size(&m->system) * sizeof(double));
        memset(m->reaction, 0, (size_t)(3 * m->pinned) * sizeof(double));
    }
    sum = energy = yci_inertia(s, mode);
    for (kind = 0; kind < YCI_KINDS; kind++) {
        double e = yci_assemble_kind(s, kind, mode);
        energy += e, sum += fabs(e);
    }
    *scale = fabs(sum);
    return energy;
}

/* ---- contact search ---- */

/* Normal forces, normals and weights at the step's start, for friction. A body is where it was then. */
static void yci_contact_lag(yc_scene *s) {
    yci_model *m = s->model;
    double g[3], h[9], w[3], x[3];
    int i, k;
    for (i = 0; i < m->touch_count; i++) {
        yci_touch *e = m->touch + i;
        const yci_probe *p = m->probe + e->probe;
        yci_body_sdf before = s->body[e->body];
        double d;
        before.pose = s->pose[2 * e->body];
        yci_zero(x, 3);
        for (k = 0; k < p->count; k++) w[k] = 1.0 / p->count, yci_axpy(x, w[k], s->x_n + 3 * p->node[k]);
        d = yci_body_distance(&before, x, e->normal);
        yci_contact_normal(d, e->normal, p->thickness, p->weight * s->desc.contact_stiffness, &e->lambda, g, h);
        yci_normalize(e->normal, e->normal);
    }
    for (i = 0; i < m->pairs.count; i++) {
        yci_grip *e = m->grip + i;
        double d = yci_pair_distance(m->pairs.pair + i, s->x_n, e->normal, e->share);
        yci_contact_normal(
            d, e->normal, m->pairs.pair[i].thickness, e->weight * s->desc.contact_stiffness, &e->lambda, g, h);
    }
}

static yc_result yci_search_bodies(yc_scene *s) {
    yci_model *m = s->model;
    int i, j;
    m->touch_count = 0;
    for (i = 0; i < m->probe_count; i++)
        for (j = 0; j < s->body_count; j++) {
            const yci_probe *p = m->probe + i;
            double x[3], w[3], n[3], reach = p->thickness + m->margin;
            yci_touch *e;
            yci_probe_place(s, p, x, w);
            if (yci_body_bound(s->body + j, x) > reach || yci_body_distance(s->body + j, x, n) > reach) continue;
            if (!YCI_RESERVE(&s->c, m->touch, m->touch_capacity, m->touch_count, m->touch_count + 1))
                return yci_out_of_memory(&s->c, "contacts");
            e = m->touch + m->touch_count++;
            memset(e, 0, sizeof *e);
            e->probe = i, e->body = j;
        }
    return YC_OK;
}

/* Leaves out pairs across a seam that is still open, and pairs that touch at rest. Yarn nodes of a cloth that are
 * nearer than around its tightest fold can only come close as it narrows or shears, which the weave knows of. */
static int yci_exclude_pair(void *user, const yci_pair *pair) {
    const yci_model *m = (const yci_model *)user;
    int side = yci_pair_side(pair->kind), count = yci_pair_nodes(pair->kind), i, j;
    yci_pair fold = *pair;
    if (pair->kind == YCI_POINT_POINT) fold.thickness *= YCI_FOLD;
    for (i = 0; i < side; i++)
        for (j = side; j < count; j++)
            if (m->closed[pair->node[i]] == m->closed[pair->node[j]]) return 1;
    return yci_pairs_exclude_rest((void *)m->rest, &fold);
}

/* Radii of what carries contact: half the thickness for triangles and their edges and vertices; for yarn nodes half of
 * what all yarns there amount to, the more so as there is nothing between the nodes. */
static void yci_pairs_radii(const yc_scene *s, yci_pairs_input *in, double *radius, unsigned char *sphere) {
    const yci_model *m = s->model;
    int i;
    for (i = 0; i < in->triangle_count; i++) radius[i] = s->desc.thickness;
    in->triangle_radius = radius, radius += in->triangle_count;
    for (i = 0; i < in->edge_count; i++) radius[i] = s->desc.thickness;
    in->edge_radius = radius, radius += in->edge_count;
    for (i = 0; i < in->point_count; i++) {
        int node = m->ball[i];
        sphere[i] = node >= s->vertices;
        radius[i] = sphere[i] ? m->half[node - s->vertices] : s->desc.thickness;
    }
    in->point_radius = radius, in->sphere = sphere;
}

static double yci_pair_weight(const yci_model *m, const yci_pair *pair) {
    double sum = 0.0;
    int i, count = yci_pair_nodes(pair->kind);
    for (i = 0; i < count; i++) sum += m->share[pair->node[i]];
    return sum / count;
}

static int yci_pairs_fit(const yci_model *m) { /* whether the matrix has a place for every pair's coupling */
    int i, j, k;
    for (i = 0; i < m->pairs.count; i++)
        for (j = 0; j < yci_pair_nodes(m->pairs.pair[i].kind); j++)
            for (k = 0; k < j; k++) {
                int a = m->system_node[m->pairs.pair[i].node[j]], b = m->system_node[m->pairs.pair[i].node[k]];
                if (a >= 0 && b >= 0 && yci_bsr_find(&m->system.a, a, b) < 0) return 0;
            }
    return 1;
}

static yc_result yci_search_pairs(yc_scene *s) {
    yci_model *m = s->model;
    yci_context *c = &s->c;
    yci_pairs_input in;
    double *radius;
    unsigned char *sphere;
    yc_result result = YC_ERROR_MEMORY;
    int i;
    memset(&in, 0, sizeof in);
    in.node_count = s->nodes, in.x = s->x, in.triangle_count = m->face_count, in.triangle = m->face_node;
    in.edge_count = m->edge_count / 2, in.edge = m->edge, in.point_count = m->ball_count, in.point = m->ball;
    in.margin = m->margin, in.exclude = yci_exclude_pair, in.exclude_user = m;
    radius = YCI_NEW(c, double, in.triangle_count + in.edge_count + in.point_count),
    sphere = YCI_NEW(c, unsigned char, in.point_count);
    if (radius && sphere) {
        yci_pairs_radii(s, &in, radius, sphere);
        result = yci_pairs_find(c, &in, &m->pairs);
    }
    if (result == YC_OK && !YCI_RESERVE(c, m->grip, m->grip_capacity, 0, m->pairs.count)) result = YC_ERROR_MEMORY;
    for (i = 0; result == YC_OK && i < m->pairs.count; i++) m->grip[i].weight = yci_pair_weight(m, m->pairs.pair + i);
    if (result == YC_OK && !yci_pairs_fit(m)) result = yci_build_system(s, m);
    yci_free(c, radius), yci_free(c, sphere);
    return result == YC_ERROR_MEMORY ? yci_out_of_memory(c, "contacts") : result;
}

/* Finds what may touch while no node moves more than half the margin. */
static yc_result yci_search(yc_scene *s) {
    yci_model *m = s->model;
    double fastest = 0.0, far;
    yc_result result = YC_OK;
    int i;
    if (!s->body_count && !s->desc.self_contact) return YC_OK;
    if (!m->searched && !(m->searched = YCI_NEW(&s->c, double, 6 * (size_t)s->nodes)))
        return yci_out_of_memory(&s->c, "contacts");
    for (i = 0; i < s->nodes; i++) fastest = yci_max(fastest, yci_dot(s->velocity + 3 * i, s->velocity + 3 * i));
    far = (m->face_count ? 20.0 : 4.0) * s->desc.thickness; /* direct solvers pay for every pair */
    m->margin = 2.0 * s->desc.thickness + yci_min(2.0 * m->h * sqrt(fastest), far);
    memcpy(m->searched, s->x, (size_t)(3 * s->nodes) * sizeof(double));
    result = yci_search_bodies(s);
    if (result == YC_OK && s->desc.self_contact) result = yci_search_pairs(s);
    if (result == YC_OK) yci_contact_lag(s);
    return result;
}

/* ---- Newton ---- */

static double yci_seconds(void) {
    clock_t ticks = clock();
    return ticks == (clock_t)-1 ? 0.0 : (double)ticks / CLOCKS_PER_SEC;
}

/* Makes sliding stiffer by a share of itself, in the matrix alone. */
static void yci_stiffen(yc_scene *s, double share) {
    yci_model *m = s->model;
    const yci_bsr *a = &m->system.a;
    int i;
    for (i = 0; i < m->slide_count && share > 0.0; i++) {
        int visit = m->slide[i].visit, node = m->system_node[s->visit_node[visit]];
        a->val[a->at[a->diag[node]] + (size_t)(m->visit_slot[visit] * (a->dim[node] + 1))] *= 1.0 + share;
    }
}

/* Ten times the shift, up to YCI_SHIFT; false where it is there. */
static int yci_shift_more(yci_model *m) {
    if (m->shift >= YCI_SHIFT) return 0;
    m->shift = yci_clamp(10.0 * m->shift, 1e-3 * YCI_SHIFT, YCI_SHIFT);
    return 1;
}

/* Whether what is solved for is plain A d = b, and about A's inverse known. */
static int yci_solves_plain(const yci_model *m) {
    return m->solver == YC_SOLVER_DIRECT || (m->solver == YC_SOLVER_TWO_LEVEL && !m->hybrid);
}

/* d = A^-1 d for the factors at hand, to a share of it. Only the two levels come close enough to the inverse to tell
 * how far it would move what is left. */
static void yci_solve(yc_scene *s, double *d, double share, double tolerance, yc_stats *stats) {
    yci_model *m = s->model;
    if (m->solver == YC_SOLVER_DIRECT) yci_system_direct(&m->system, d);
    else
        stats->linear += yci_system_mpcg(
            &m->system, d, d, share, m->solver == YC_SOLVER_TWO_LEVEL ? 1e-2 * tolerance : 0.0, s->desc.linear_limit);
}

/* Solves for the direction. While elements keep a share only of what makes them semidefinite, a matrix that conjugate
 * gradients find indefinite, or that only a shift makes one with an incomplete factor, counts as one without. */
static yc_result yci_direction_try(yc_scene *s, double tolerance, yc_stats *stats) {
    yci_model *m = s->model;
    int i, size = yci_system_size(&m->system);
    yc_result result;
    yci_stiffen(s, m->shift);
    result = yci_system_factor(&m->system);
    if (result != YC_OK) return result;
    if (m->convex < 1.0 && m->system.ic && m->system.ic->shift > YCI_CONVEX_SHIFT) return YC_ERROR_NOT_SPD;
    for (i = 0; i < size; i++) m->direction[i] = -m->gradient[i];
    yci_solve(s, m->direction, s->desc.linear_tolerance, tolerance, stats);
    return m->convex < 1.0 && m->system.indefinite ? YC_ERROR_NOT_SPD : YC_OK;
}

/* The direction of the present state, whose matrix and gradient are at hand. */
static yc_result yci_direction(yc_scene *s, double tolerance, yc_stats *stats) {
    yci_model *m = s->model;
    int i, size = yci_system_size(&m->system);
    double slope = 0.0, scale;
    yc_result result = yci_direction_try(s, tolerance, stats);
    while (result == YC_ERROR_NOT_SPD) {
        if (m->convex < 1.0) m->convex = yci_min(1.0, yci_max(4.0 * m->convex, YCI_CONVEX));
        else if (!yci_shift_more(m)) break;
        yci_potential(s, YCI_HESSIAN, &scale);
        result = yci_direction_try(s, tolerance, stats);
    }
    if (result != YC_OK) return result;
    for (i = 0; i < size; i++) slope += m->gradient[i] * m->direction[i];
    m->slope = slope;
    return slope <= 0.0 ? YC_OK : YCI_FAIL(&s->c, YC_ERROR_DIVERGED, "no descent direction: slope %g", slope);
}

/* How much of the direction keeps every segment's rest length above a tenth of what it is. */
static double yci_length_limit(const yc_scene *s) {
    const yci_model *m = s->model;
    double limit = 1.0;
    int i;
    for (i = 0; i < m->segment_count; i++) {
        int a = m->segment[i].a, b = m->segment[i].b;
        double change = 0.0, du = s->u[b] - s->u[a];
        if (m->visit_slot[a] >= 0) change -= m->direction[yci_dof_of_slide(s, a)];
        if (m->visit_slot[b] >= 0) change += m->direction[yci_dof_of_slide(s, b)];
        if (limit * change < -0.9 * du) limit = -0.9 * du / change;
    }
    return limit;
}

/* How much of it does that, and lets nothing pass through anything else. */
static double yci_step_limit(yc_scene *s, double longest) {
    yci_model *m = s->model;
    double limit = yci_length_limit(s), *move = m->searched ? m->searched + 3 * s->nodes : NULL;
    int i;
    if (!s->desc.self_contact || !move) return limit;
    limit = yci_min(limit, 0.5 * m->margin / yci_max(longest, 1e-300));
    memset(move, 0, (size_t)(3 * s->nodes) * sizeof(double));
    for (i = 0; i < m->system.a.n; i++) yci_scale(move + 3 * m->node_of[i], m->direction + m->system.a.off[i], limit);
    return limit * yci_pair_step_limit(m->pairs.pair, m->pairs.count, s->x, move);
}

/* How far, in metres, a segment's ends may be from where the step dq takes them because its tension was `before`: the
 * force that is left out, against the inertia; 0 where no more than half of what holds the segment has gone. */
static double yci_segment_eased(const yci_segment *e, double before, const double *q, const double *dq, double h) {
    double axis[3] = {1.0, 0.0, 0.0}, along[3], turn[3], du = q[7] - q[6], inertia = e->density * du * du / (h * h);
    double tension = yci_max(e->tension, 0.0), fall = before - tension;
    if (fall <= tension + inertia) return 0.0;
    yci_sub(along, q + 3, q), yci_normalize(along, axis);
    yci_sub(turn, dq + 3, dq), yci_axpy(turn, -yci_dot(turn, along), along);
    return fall * yci_norm(turn) / inertia;
}

/* The tension of segments, the stress of triangles and the friction of sliding after `share` of the direction, by the
 * linear model; with the direction NULL a share of the way to tension and stress of the state. */
static void yci_predict(yc_scene *s, const double *direction, double share) {
    yci_model *m = s->model;
    yci_local local;
    double q[12], dq[12] = {0.0}, stress[3], tension, before;
    int i, k;
    m->eased = 0.0;
    for (i = 0; i < m->segment_count; i++) {
        yci_segment *e = m->segment + i;
        yci_local_segment(s, &local, q, e);
        yci_local_direction(m, &local, direction, dq);
        tension = local.dofs > 8 ? yci_yarn_crimp_predict(q, dq, e->stretch, m->rate, e->previous)
                                 : yci_yarn_stretch_predict(q, dq, e->stretch, m->rate, e->previous);
        before = e->tension, e->tension += share * (tension - e->tension);
        if (direction) m->eased = yci_max(m->eased, yci_segment_eased(e, before, q, dq, m->h));
    }
    for (i = 0; i < m->slide_count; i++) {
        yci_slide *e = m->slide + i;
        double du = direction ? direction[yci_dof_of_slide(s, e->visit)] : 0.0, after;
        if (e->other >= 0 && direction && m->visit_slot[e->other] >= 0)
            du -= e->sign * direction[yci_dof_of_slide(s, e->other)];
        after = yci_yarn_friction_predict(
            yci_slid(s, e), s->anchor[e->visit], du, e->stiffness, yci_rub_limit(m, e->rub), e->share);
        e->share = direction ? e->share + share * (after - e->share) : (1.0 - share) * e->share;
    }
    for (i = 0; i < m->face_count; i++) {
        yci_face *e = m->face + i;
        yci_local_nodes(&local, 3, e->node), yci_local_gather(s, &local, q);
        yci_local_direction(m, &local, direction, dq);
        yci_triangle_membrane_predict(q, dq, &e->rest, e->material, m->rate, e->previous, stress);
        for (k = 0; k < 3; k++) e->stress[k] += share * (stress[k] - e->stress[k]);
    }
}

/* The tension of a segment after the step dq by the linear model; with dq NULL that of the state. */
static double yci_segment_tension(const yc_scene *s, const yci_segment *e, const double *direction, double share) {
    yci_local local;
    double q[12], dq[12];
    int i;
    yci_local_segment(s, &local, q, e);
    yci_local_direction(s->model, &local, direction, dq);
    for (i = 0; i < local.dofs; i++) dq[i] *= share;
    return local.dofs > 8 ? yci_yarn_crimp_predict(q, dq, e->stretch, s->model->rate, e->previous)
                          : yci_yarn_stretch_predict(q, dq, e->stretch, s->model->rate, e->previous);
}

/* Forces that stand for the segments' excess, along the yarn as it lies now, into `right`. */
static void yci_excess(yc_scene *s) {
    yci_model *m = s->model;
    int i, k;
    memset(m->right, 0, (size_t)yci_system_size(&m->system) * sizeof(double));
    for (i = 0; i < m->segment_count; i++) {
        const yci_segment *e = m->segment + i;
        yci_local local;
        double q[12], v[12] = {0.0}, t[4] = {1.0, 0.0, 0.0, 0.0}, l;
        yci_local_segment(s, &local, q, e);
        if (local.dofs > 8) l = yci_yarn_crimp_direction(t, q);
        else yci_sub(t, q + 3, q), l = yci_normalize(t, t);
        yci_scale(v, t, -1.0), yci_copy(v + 3, t);
        v[6] = l / (q[7] - q[6]), v[7] = -v[6];
        v[9] = sqrt(YCI_CRIMP_KAPPA) * t[3], v[8] = -v[9];
        for (k = 0; k < local.dofs; k++) {
            int node = m->system_node[local.node[local.slot[k]]];
            if (node >= 0 && local.comp[k] >= 0) m->right[m->system.a.off[node] + local.comp[k]] -= e->excess * v[k];
        }
    }
}

/* E after a share of the direction; where `bent`, and after what takes the excess of tension away that is then there,
 * by the factor at hand. */
static double yci_trial(yc_scene *s, double share, int bent, double tolerance, yc_stats *stats) {
    yci_model *m = s->model;
    int i, size = yci_system_size(&m->system);
    double unused;
    if (bent) { /* the state is that of the straight trial */
        for (i = 0; i < m->segment_count; i++) m->segment[i].excess = yci_segment_tension(s, m->segment + i, NULL, 0.0);
        yci_dofs_set(s, m->start);
        for (i = 0; i < m->segment_count; i++)
            m->segment[i].excess -= yci_segment_tension(s, m->segment + i, m->direction, share);
        yci_excess(s);
        yci_solve(s, m->right, YCI_BENT, tolerance, stats);
        for (i = 0; i < size; i++) m->dof[i] += m->right[i];
    } else
        for (i = 0; i < size; i++) m->dof[i] = m->start[i] + share * m->direction[i];
    yci_dofs_set(s, m->dof);
    return yci_potential(s, YCI_ENERGY, &unused);
}

/* Backtracks along the direction, and along the bent way beside it, until E falls enough. A fall too small for E to
 * resolve is taken on trust: there the quadratic model is exact to rounding. Tension and friction are then those of the
 * linear model by the share that was taken of it. */
static yc_result yci_line_search(
    yc_scene *s, double energy, double scale, double longest, double tolerance, yc_stats *stats) {
    yci_model *m = s->model;
    int tries, bent, fell = 0, ways = yci_solves_plain(m) ? 2 : 1;
    double t = 2.0 * yci_step_limit(s, longest);
    memcpy(m->start, m->dof, (size_t)yci_system_size(&m->system) * sizeof(double));
    for (tries = 0; tries < 40 && !fell; tries++) {
        t *= 0.5;
        for (bent = 0; bent < ways && !fell; bent++)
            fell = yci_trial(s, t, bent, tolerance, stats) <= energy + 1e-4 * t * m->slope ||
                -t * m->slope < 1e-12 * scale;
    }
    if (!fell)
        return YCI_FAIL(&s->c, YC_ERROR_DIVERGED,
            "line search: energy %g J does not fall along a direction of slope %g", energy, m->slope);
    yci_dofs_set(s, m->start);
    yci_predict(s, m->direction, 1.0);
    yci_dofs_set(s, m->dof);
    if (t < 1.0) yci_predict(s, NULL, 1.0 - t);
    return YC_OK;
}

/* Goes a share of the direction. */
static void yci_move(yc_scene *s, double share) {
    yci_model *m = s->model;
    int i, size = yci_system_size(&m->system);
    for (i = 0; i < size; i++) m->dof[i] += share * m->direction[i];
    yci_dofs_set(s, m->dof);
}

/* Takes the whole direction, as far as rest lengths and contact let it, whatever E does. */
static void yci_full_step(yc_scene *s, double longest) {
    double t = yci_step_limit(s, longest);
    yci_predict(s, s->model->direction, t);
    yci_move(s, t);
}

/* Back at the best iterate; returns 1, since line searches begin there. */
static int yci_newton_back(yc_scene *s) {
    yci_model *m = s->model;
    memcpy(m->dof, m->dof_best, (size_t)yci_system_size(&m->system) * sizeof(double));
    yci_dofs_set(s, m->dof);
    return 1;
}

/* What of the gradient is not balanced by the filter. */
static void yci_residual(yc_scene *s, yc_stats *stats) {
    yci_model *m = s->model;
    int size = yci_system_size(&m->system);
    memcpy(m->right, m->gradient, (size_t)size * sizeof(double));
    yci_system_reduce(&m->system, m->right);
    stats->residual = yci_vector_largest(m->right, size);
}

/* Back where the sub-step began, with tension and stress of that state; returns 0, since those are not kept ones. */
static int yci_newton_again(yc_scene *s) {
    yci_model *m = s->model;
    memcpy(m->dof, m->dof_n, (size_t)yci_system_size(&m->system) * sizeof(double));
    yci_dofs_set(s, m->dof);
    yci_predict(s, NULL, 1.0);
    m->convex = 1.0;
    return 0;
}

/* Whether E, which is `energy` at free flight, is lower at q_n. Only weight is below zero, which comes first: what is
 * added until the sum reaches that says that it is not. */
static int yci_newton_rises(yc_scene *s, double energy) {
    yci_model *m = s->model;
    size_t bytes = (size_t)yci_system_size(&m->system) * sizeof(double);
    double least;
    int kind;
    memcpy(m->start, m->dof, bytes), memcpy(m->dof, m->dof_n, bytes);
    yci_dofs_set(s, m->dof);
    least = yci_inertia(s, YCI_ENERGY);
    for (kind = 0; kind < YCI_KINDS && (kind == YCI_SEGMENT || least < energy); kind++)
        least += yci_assemble_kind(s, kind, YCI_ENERGY);
    memcpy(m->dof, m->start, bytes);
    yci_dofs_set(s, m->dof);
    return energy > least;
}

/* Ends Newton's iteration: E, forces and reactions of the last iterate. False, and back at the best one, when E there,
 * `best`, was lower. */
static int yci_newton_ends(yc_scene *s, double best, yc_stats *stats) {
    double scale, energy = yci_potential(s, YCI_GRADIENT, &scale);
    int lower = energy <= best + 1e-12 * scale;
    if (!lower) yci_newton_back(s), yci_potential(s, YCI_GRADIENT, &scale);
    yci_residual(s, stats);
    return lower;
}

/* Whether the step just taken was the last that is needed, though it was longer than the tolerance: by the factor at
 * hand the next one would be a tenth of that at most (the simplified Newton correction of Deuflhard, Newton Methods for
 * Nonlinear Problems, Springer 2004). Then forces and reactions are those of the end. */
static int yci_newton_is_near(yc_scene *s, double tolerance, double best, yc_stats *stats) {
    yci_model *m = s->model;
    double scale, next;
    if (stats->correction > YCI_NEAR * tolerance || yci_potential(s, YCI_GRADIENT, &scale) > best) return 0;
    yci_residual(s, stats);
    if (!yci_system_estimate(&m->system, m->right, m->direction)) return 0;
    next = yci_vector_largest(m->direction, yci_system_size(&m->system));
    if (!(next <= 0.1 * tolerance)) return 0;
    stats->correction = next;
    return 1;
}

/* Iterates to the minimum. Whole steps at first; when the best E so far has stood for YCI_PATIENCE iterations, or E is
 * higher in the end, or a direction takes more of a segment's rest length than there is, they are given up: what began
 * at free flight begins again at q_n, the rest is done from the best iterate by line searches. Where corrections do not
 * fall the Hessian lacks a negative part: elements give more and more of theirs while it has a factor. */
static yc_result yci_newton(yc_scene *s, yc_stats *stats) {
    yci_model *m = s->model;
    yc_result result;
    double tolerance = s->desc.tolerance, best = HUGE_VAL, last = HUGE_VAL, scale, convex;
    int iteration, size = yci_system_size(&m->system), waited = 0, slow = 0, lost = 0, tense = m->tense;
    int patience = YCI_PATIENCE;
    m->convex = 1.0, m->shift = 0.0, m->tense = 0, m->searching = 0;
    /* Friction has a scale of its own: the slip over one step at which the brake lets go. The floor keeps a halved
     * sub-step from being asked for more than the one that failed. */
    if (m->touch_count || m->pairs.count)
        tolerance = yci_clamp(0.5 * s->desc.slip_speed * m->h, 0.05 * tolerance, tolerance);
    if (tense) yci_move(s, yci_step_limit(s, yci_vector_largest(m->direction, size)));
    for (iteration = 0; iteration < s->desc.newton_limit; iteration++) {
        double energy, clock = yci_seconds();
        if (lost && tense) tense = yci_newton_again(s), best = last = HUGE_VAL, waited = slow = 0;
        else if (lost) m->searching = yci_newton_back(s), yci_predict(s, NULL, 1.0);
        if (iteration && m->searched && yci_pairs_drift(s->nodes, m->searched, s->x) > 0.25 * m->margin) {
            result = yci_search(s);
            if (result != YC_OK) return result;
            yci_masses(s);               /* the search may have made a new system */
            best = HUGE_VAL, waited = 0; /* and E has new terms */
        }
        energy = yci_potential(s, YCI_HESSIAN, &scale);
        lost = !iteration && tense && yci_newton_rises(s, energy);
        if (energy < best) {
            best = energy, waited = 0;
            memcpy(m->dof_best, m->dof, (size_t)size * sizeof(double));
        } else if (!m->searching && ++waited > YCI_PATIENCE) lost = 1;
        if (lost) continue;
        stats->seconds_assembly += yci_seconds() - clock, clock = yci_seconds();
        convex = m->convex, stats->newton++;
        result = yci_direction(s, tolerance, stats);
        stats->seconds_solve += yci_seconds() - clock, clock = yci_seconds();
        if (result != YC_OK) return result == YC_ERROR_MEMORY ? result : YC_ERROR_DIVERGED;
        stats->correction = yci_vector_largest(m->direction, size);
        if (!(stats->correction < 1e9))
            return YCI_FAIL(&s->c, YC_ERROR_DIVERGED, "a Newton step of %g m", stats->correction);
        slow = stats->correction > 0.5 * last ? slow + 1 : 0, last = stats->correction;
        if (m->convex > convex) patience = patience < YCI_PATIENCE_MOST ? patience + patience / 2 : patience, slow = 0;
        if (slow >= patience && -m->slope < 1e-15 * scale) yci_shift_more(m), slow = 0;
        else if (slow >= patience && yci_solves_plain(m))
            m->convex = m->convex > YCI_CONVEX / 16.0 ? 0.25 * m->convex : 0.0, slow = 0;
        lost = !m->searching && yci_length_limit(s) < 1.0;
        if (lost) continue;
        if (m->searching) result = yci_line_search(s, energy, scale, stats->correction, tolerance, stats);
        else yci_full_step(s, stats->correction);
        if (result != YC_OK) return result;
        if (tense && m->eased > tolerance && iteration < YCI_PATIENCE) continue;
        if (stats->correction <= tolerance) {
            if (yci_newton_ends(s, m->searching || !waited ? HUGE_VAL : best, stats)) {
                m->tense = !m->searching && iteration < YCI_PATIENCE && !m->face_count && !s->crimped;
                return YC_OK;
            }
            lost = 1;
        } else if (tense && yci_newton_is_near(s, tolerance, best, stats)) {
            m->tense = iteration < YCI_PATIENCE;
            return YC_OK;
        }
        stats->seconds_assembly += yci_seconds() - clock;
    }
    if (s->desc.best_effort) {
        yci_newton_ends(s, best, stats);
        stats->unfinished++;
        return YC_OK;
    }
    return YCI_FAIL(&s->c, YC_ERROR_DIVERGED, "Newton: correction %g m after %d iterations, tolerance %g m",
        stats->correction, s->desc.newton_limit, s->desc.tolerance);
}

/* ---- steps ---- */

/* Strains at the step's start, for stiffness damping. */
static void yci_strains(yc_scene *s) {
    yci_model *m = s->model;
    yci_local out;
    double q[12];
    int i;
    for (i = 0; i < m->segment_count; i++) {
        yci_local_segment(s, &out, q, m->segment + i);
        m->segment[i].previous = out.dofs > 8 ? yci_yarn_crimp_strain(q) : yci_yarn_stretch_strain(q);
    }
    for (i = 0; i < m->bend_count; i++) {
        yci_local_visits(s, &out, q, 3, &m->bend[i].a);
        m->bend[i].previous = yci_yarn_bend_strain(q);
    }
    for (i = 0; i < m->kink_count; i++) {
        yci_local_kink(s, &out, q, &m->kink[i].a);
        m->kink[i].previous = yci_yarn_kink_strain(q);
    }
    for (i = 0; i < m->flatten_count; i++) {
        yci_local_flatten(s, &out, q, m->flatten + i);
        m->flatten[i].previous = yci_yarn_flatten_strain(q, m->flatten[i].rest);
    }
    for (i = 0; i < m->shear_count; i++) {
        yci_local_nodes(&out, 3, m->shear[i].node), yci_local_gather(s, &out, q);
        m->shear[i].previous = yci_yarn_shear_strain(q);
    }
    for (i = 0; i < m->face_count; i++) {
        yci_local_nodes(&out, 3, m->face[i].node), yci_local_gather(s, &out, q);
        yci_triangle_membrane_strain(q, &m->face[i].rest, m->face[i].previous);
    }
    for (i = 0; i < m->hinge_count; i++) {
        yci_local_nodes(&out, 4, m->hinge[i].node), yci_local_gather(s, &out, q);
        m->hinge[i].previous = yci_triangle_hinge_strain(q);
    }
}

/* Whether a yarn has this visit, and in the mechanics. */
static int yci_yarn_goes_on(const yc_scene *s, const yci_cloth *cloth, int yarn, int visit) {
    return visit >= cloth->yarns.yarn_first[yarn] && visit < cloth->yarns.yarn_first[yarn + 1] &&
        s->model->role[s->visit_node[cloth->visit + visit]] != YCI_IDLE;
}

/* The yarn of a visit of a cloth's network. */
static int yci_scene_yarn_of(const yci_cloth *cloth, int visit) {
    int low = 0, high = cloth->yarns.yarn_count;
    while (low + 1 < high) {
        int middle = low + (high - low) / 2;
        if (cloth->yarns.yarn_first[middle] <= visit) low = middle;
        else high = middle;
    }
    return low;
}

/* The unit tangent of a yarn at a visit, one-sided at its ends. */
static void yci_yarn_tangent(const yc_scene *s, const yci_cloth *cloth, int visit, int yarn, double *t) {
    const double up[3] = {0.0, 1.0, 0.0};
    int before = visit - yci_yarn_goes_on(s, cloth, yarn, visit - 1),
        after = visit + yci_yarn_goes_on(s, cloth, yarn, visit + 1);
    yci_sub(t, s->x + 3 * s->visit_node[cloth->visit + after], s->x + 3 * s->visit_node[cloth->visit + before]);
    yci_normalize(t, up);
}

/* The force of one yarn at a crossing, every visit offset by the yarn's radius to its side of the contact. */
static void yci_yarn_press(
    const yc_scene *s, const yci_cloth *cloth, int visit, int yarn, const double *n, double *force) {
    const yc_yarns *y = &cloth->yarns;
    const yc_yarn_material *material = y->materials + y->yarn_material[yarn];
    const double *there[5];
    double point[5][7], turn[3] = {0.0, 0.0, 0.0};
    int k;
    for (k = 0; k < 3 && y->visit_turn; k++)
        if (yci_yarn_goes_on(s, cloth, yarn, visit + k - 1)) turn[k] = y->visit_turn[visit + k - 1];
    for (k = 0; k < 5; k++) {
        int at = visit + k - 2;
        there[k] = k == 2 || yci_yarn_goes_on(s, cloth, yarn, at) ? point[k] : NULL;
        if (!there[k]) continue;
        yci_copy(point[k], s->x + 3 * s->visit_node[cloth->visit + at]);
        yci_scale(point[k] + 3, n, material->radius * y->visit_layer[at]);
        point[k][6] = s->u[cloth->visit + at];
    }
    yci_yarn_crossing_force(force, there, material->stretch, material->bending, turn);
}

/* What two yarns press each other with where they do not undulate (YARN 4.3). */
static double yci_compression(const yc_scene *s, const yci_rub *e) {
    const yci_cloth *cloth = s->cloth + e->cloth;
    const double up[3] = {0.0, 1.0, 0.0};
    double t[2][3], n[3], force[2][3];
    int k, weft = cloth->yarns.yarn_family[e->yarn[0]] == YC_WEFT ? 0 : 1,
           low = cloth->yarns.visit_layer[e->visit[0]] < 0 ? 0 : 1;
    for (k = 0; k < 2; k++) yci_yarn_tangent(s, cloth, e->visit[k], e->yarn[k], t[k]);
    yci_cross(n, t[weft], t[!weft]); /* the pattern's u x v: from the lower layer to the upper */
    yci_normalize(n, up);
    for (k = 0; k < 2; k++) yci_yarn_press(s, cloth, e->visit[k], e->yarn[k], n, force[k]);
    return yci_yarn_compression(force[low], force[!low], n);
}

/* What the elements of every undulating yarn push it with at its visits, downwards. */
static void yci_thrusts(yc_scene *s) {
    yci_model *m = s->model;
    yci_local out;
    double q[12], g[12];
    int i;
    memset(m->thrust, 0, (size_t)s->visits * sizeof(double));
    for (i = 0; i < m->segment_count; i++) {
        const yci_segment *e = m->segment + i;
        if (!yci_crimped(m, e->a)) continue;
        yci_local_segment(s, &out, q, e);
        yci_yarn_crimp(q, e->stretch, 0.0, 0.0, NULL, g, NULL, 0);
        m->thrust[e->a] += g[8], m->thrust[e->b] += g[9];
    }
    for (i = 0; i < m->kink_count; i++) {
        const yci_kink *e = m->kink + i;
        yci_local_kink(s, &out, q, &e->a);
        yci_yarn_kink(q, e->stiffness, e->rest, 0.0, 0.0, g, NULL, 0);
        m->thrust[e->a] += g[0], m->thrust[e->b] += g[1], m->thrust[e->c] += g[2];
    }
}

/* What wrapping does to each yarn: all of a tail's pull is its yarn's. */
static void yci_unwraps(yc_scene *s) {
    yci_model *m = s->model;
    yci_local out;
    double q[12], g[12];
    int i, k;
    memset(m->unwrap, 0, 3 * (size_t)s->visits * sizeof(double));
    for (i = 0; i < m->wrap_count; i++) {
        const int visit[4] = {m->wrap[i].a, m->wrap[i].b, m->wrap[i].p, m->wrap[i].q};
        yci_local_wrap(s, &out, q, m->wrap + i);
        yci_yarn_wrap(q, m->wrap[i].stiffness, m->wrap[i].rest, g, NULL, 0);
        for (k = 0; k < 4; k++) yci_axpy(m->unwrap + 3 * visit[k], -1.0, g + 3 * k);
    }
}

/* The normal of a stack, towards its highest layer. Followed from A to B, the old yarn turns to the right of the new
 * one at B and to the left of it at A where the contact is the left one of a knit, whose new loop is on top at B. */
static void yci_stack_normal(const yc_scene *s, const yci_rub *rub, int contact, double *n) {
    const yci_cloth *cloth = s->cloth + rub->cloth;
    const yc_yarns *y = &cloth->yarns;
    const yc_stitch_contact *at = contact < 0 ? NULL : y->contacts + contact;
    const double up[3] = {0.0, 1.0, 0.0};
    double t[2][3], cross[2][3];
    int yarn, end, knit;
    if (contact < 0) { /* crossing legs: the layout's side, as where yarns are drawn */
        for (yarn = 0; yarn < 2; yarn++) yci_yarn_tangent(s, cloth, rub->visit[yarn], rub->yarn[yarn], t[yarn]);
        yci_cross(n, t[0], t[1]), yci_normalize(n, up);
        return;
    }
    knit = (at->sign > 0) == (y->visit_layer[at->visit[1][1]] > y->visit_layer[at->visit[0][1]]);
    for (end = 0; end < 2; end++) {
        for (yarn = 0; yarn < 2; yarn++) {
            int visit = at->visit[yarn][end];
            yci_yarn_tangent(s, cloth, visit, yci_scene_yarn_of(cloth, visit), t[yarn]);
            if (at->visit[yarn][1] < at->visit[yarn][0]) yci_scale(t[yarn], t[yarn], -1.0);
        }
        yci_cross(cross[end], t[0], t[1]);
    }
    yci_sub(n, cross[1], cross[0]), yci_normalize(n, up);
    if (!knit) yci_scale(n, n, -1.0);
}

/* What the neighbours of every stack press each other with (YARN 4.3), one normal for all of them. */
static void yci_press_stacks(yc_scene *s) {
    yci_model *m = s->model;
    int i, k, c;
    if (!m->stack_count) return;
    yci_unwraps(s);
    for (i = 0; i < m->stack_count; i++) {
        const yci_stack *e = m->stack + i;
        yci_rub *rub = m->rub + e->rub;
        const yci_cloth *cloth = s->cloth + rub->cloth;
        double n[3], force[3], load[YCI_STACK], one[YCI_STACK], lambda[YCI_STACK];
        yci_stack_normal(s, rub, e->contact, n);
        for (k = 0; k <= e->count; k++) {
            int at = k < e->count ? k : k - 1, side = k == e->count;
            const double *unwrap = m->unwrap + 3 * (cloth->visit + rub[at].visit[side]);
            yci_yarn_press(s, cloth, rub[at].visit[side], rub[at].yarn[side], n, force);
            for (load[k] = 0.0, one[k] = 1.0, c = 0; c < 3; c++) load[k] += n[c] * (force[c] + unwrap[c]);
        }
        yci_yarn_stack_compression(lambda, e->count + 1, load, one, one);
        for (k = 0; k < e->count; k++) rub[k].limit = rub[k].friction * lambda[k];
    }
}

/* What presses the yarns of every crossing with friction together, and what its friction holds by that. */
static void yci_compress(yc_scene *s) {
    yci_model *m = s->model;
    int i;
    if (m->rub_count && m->thrust) yci_thrusts(s);
    yci_press_stacks(s);
    for (i = 0; i < m->rub_count; i++) {
        yci_rub *e = m->rub + i;
        const yci_cloth *cloth = s->cloth + e->cloth;
        double lambda;
        if (cloth->knit) continue;
        if (m->thrust && cloth->yarns.visit_height) {
            int up = cloth->yarns.visit_layer[e->visit[0]] < 0 ? 1 : 0;
            const double *thrust = m->thrust + cloth->visit;
            lambda = yci_max(0.0, 0.5 * (thrust[e->visit[up]] - thrust[e->visit[!up]]));
        } else lambda = yci_compression(s, e);
        e->limit = e->friction * (e->preload + lambda);
    }
}

/* Where a moving body is after `share` of the way: rows between both poses, made orthonormal again. */
static void yci_pose_between(const yci_pose *from, const yci_pose *to, double share, yci_pose *out) {
    int i;
    for (i = 0; i < 9; i++) out->r[i] = from->r[i] + share * (to->r[i] - from->r[i]);
    for (i = 0; i < 3; i++) out->t[i] = from->t[i] + share * (to->t[i] - from->t[i]);
    yci_normalize(out->r, to->r);
    yci_axpy(out->r + 3, -yci_dot(out->r, out->r + 3), out->r);
    yci_normalize(out->r + 3, to->r + 3);
    yci_cross(out->r + 6, out->r, out->r + 3);
}

/* Moves what is prescribed: pins and bodies, `share` of what is left of their way. */
static void yci_prescribe(yc_scene *s, double share) {
    int i, k;
    for (i = 0; i < s->nodes; i++)
        for (k = 0; s->pin[i] && k < 3; k++)
            s->x[3 * i + k] = s->x_n[3 * i + k] + share * (s->goal[3 * i + k] - s->x_n[3 * i + k]);
    for (i = 0; i < s->vertices; i++) { /* a vertex without mechanics hands its motion to its yarn node */
        int holder = s->model->holder[i];
        if (!s->pin[i] || holder < 0) continue;
        for (k = 0; k < 3; k++) s->x[3 * holder + k] = s->x_n[3 * holder + k] + s->x[3 * i + k] - s->x_n[3 * i + k];
    }
    for (i = 0; i < s->body_count; i++) {
        yci_pose pose;
        yci_pose_between(s->pose + 2 * i, s->pose + 2 * i + 1, share, &pose);
        s->body[i].pose = s->pose[2 * i];
        yci_body_move(s->body + i, pose.r, pose.t);
    }
}

/* Makes the hybrid vertices the least-squares fit of their yarns, which they are up to rounding after a step. */
static void yci_fit_vertices(yc_scene *s, double *x) {
    yci_system *system = &s->model->system;
    int i;
    if (!s->model->hybrid) return;
    for (i = 0; i < system->hybrid_count; i++)
        yci_copy(system->p + 3 * i, x + 3 * s->model->node_of[system->hybrid_node[i]]);
    yci_mixed_project(&system->mixed, system->p, x);
}

/* The step starts here. */
static void yci_keep(yc_scene *s) {
    if (s->nodes) memcpy(s->x_n, s->x, 3 * (size_t)s->nodes * sizeof(double));
    if (s->visits) memcpy(s->u_n, s->u, (size_t)s->visits * sizeof(double));
    if (s->crimped) memcpy(s->z_n, s->z, (size_t)s->visits * sizeof(double));
}

static void yci_restore(yc_scene *s) {
    int i;
    if (s->nodes) memcpy(s->x, s->x_n, 3 * (size_t)s->nodes * sizeof(double));
    if (s->visits) memcpy(s->u, s->u_n, (size_t)s->visits * sizeof(double));
    if (s->crimped) memcpy(s->z, s->z_n, (size_t)s->visits * sizeof(double));
    for (i = 0; i < s->body_count; i++) s->body[i].pose = s->pose[2 * i];
}

/* After an accepted step anchors follow what slips. */
static void yci_anchors(yc_scene *s) {
    yci_model *m = s->model;
    int i, k;
    for (i = 0; i < m->slide_count; i++) {
        const yci_slide *e = m->slide + i;
        double *anchor = s->anchor + e->visit;
        *anchor = yci_yarn_friction_anchor(yci_slid(s, e), *anchor, e->stiffness, yci_rub_limit(m, e->rub));
    }
    for (i = 0; i < m->turn_count; i++) {
        const yci_turn *e = m->turn + i;
        double q[9], *anchor;
        if (e->rub < 0) continue;
        for (k = 0; k < 3; k++) yci_copy(q + 3 * k, s->x + 3 * m->shear[i].node[k]);
        anchor = s->turn + e->anchor;
        *anchor = yci_yarn_friction_anchor(
            yci_yarn_shear_strain(q) - m->shear[i].rest, *anchor, e->stiffness, e->reach * yci_rub_limit(m, e->rub));
    }
}

/* Whether a sub-step has taken most of a segment's length at once, down to its floor: then more of a yarn has gone than
 * there was before its end, or Newton has found a minimum far off. */
static int yci_overrun(const yc_scene *s) {
    const yci_model *m = s->model;
    int i, found = 0;
    for (i = 0; i < m->adjacent_count && !found; i++) {
        const yci_adjacent *e = m->adjacent + i;
        double du = s->u[e->b] - s->u[e->a], before = s->u_n[e->b] - s->u_n[e->a];
        found = du < e->floor && du < 0.25 * before;
    }
    return found;
}

/* One implicit step of h seconds, which is `share` of what is left of the user's step. On failure the state is as
 * before. */
static yc_result yci_substep(yc_scene *s, double h, double share, yc_stats *stats) {
    yci_model *m = s->model;
    double clock = yci_seconds();
    yc_result result;
    int i, size;
    m->h = h, m->rate = s->desc.stiffness_damping / h;
    yci_fit_vertices(s, s->x);
    yci_keep(s);
    if (m->rate > 0.0) yci_strains(s);
    yci_compress(s);
    yci_predict(s, NULL, m->tense ? 0.0 : 1.0);
    yci_prescribe(s, share);
    result = yci_search(s);
    stats->seconds_contact += yci_seconds() - clock;
    if (result == YC_OK) {
        size = yci_system_size(&m->system);
        yci_masses(s);
        yci_dofs_get(s, s->x, s->u, s->z, m->dof);
        memcpy(m->dof_n, m->dof, (size_t)size * sizeof(double));
        yci_dofs_get(s, s->velocity, s->slide, s->rise, m->dof_free);
        for (i = 0; i < size; i++) m->direction[i] = h * m->dof_free[i], m->dof_free[i] = m->dof_n[i] + m->direction[i];
        result = yci_newton(s, stats);
        if (result == YC_OK && 0.5 * h >= s->desc.dt_min && yci_overrun(s))
            result = YCI_FAIL(&s->c, YC_ERROR_DIVERGED, "a segment lost most of its length within %g s", h);
    }
    m->h = 0.0, m->rate = 0.0;
    if (result != YC_OK) {
        yci_restore(s);
        return result;
    }
    for (i = 0; i < 3 * s->nodes; i++) s->velocity[i] = (s->x[i] - s->x_n[i]) / h;
    for (i = 0; i < s->visits; i++) s->slide[i] = (s->u[i] - s->u_n[i]) / h;
    for (i = 0; i < s->visits && s->crimped; i++) s->rise[i] = (s->z[i] - s->z_n[i]) / h;
    yci_anchors(s);
    for (i = 0; i < s->body_count; i++) s->pose[2 * i] = s->body[i].pose;
    s->time += h;
    return YC_OK;
}

/* ---- welding ---- */

/* The welded numbering that follows from the seams' flags: every vertex by the lowest one joined with it. */
static void yci_reweld(yc_scene *s) {
    int i, k, t, changed = 1;
    for (i = 0; i < s->vertices; i++) s->weld[i] = i;
    while (changed)
        for (i = changed = 0; i < s->seam_count; i++)
            for (k = 0; s->welded[i] && k < s->seam[i].desc.count; k++) {
                int *a = s->weld + s->cloth[s->seam[i].desc.cloth[0]].vertex + s->seam[i].a[k];
                int *b = s->weld + s->cloth[s->seam[i].desc.cloth[1]].vertex + s->seam[i].b[k];
                if (*a < *b) *b = *a, changed = 1;
                if (*b < *a) *a = *b, changed = 1;
            }
    for (i = 0; i < s->cloth_count; i++)
        for (t = 0; t < s->cloth[i].desc.mesh.triangle_count; t++)
            for (k = 0; k < 3; k++)
                s->triangle[3 * (s->cloth[i].triangle + t) + k] =
                    s->weld[s->cloth[i].vertex + s->cloth[i].desc.mesh.triangles[t][k]];
}

static int yci_seam_is_closed(const yc_scene *s, int seam) {
    const yci_seam *x = s->seam + seam;
    double d[3];
    int k;
    if (x->desc.kind != YC_VERTEX || s->welded[seam] || s->time < x->start + x->desc.close_time) return 0;
    for (k = 0; k < x->desc.count; k++) {
        yci_sub(d, s->x + 3 * yci_seam_point(s, x, 0, k), s->x + 3 * yci_seam_point(s, x, 1, k));
        if (yci_norm(d) > x->desc.weld_distance) return 0;
    }
    return 1;
}

/* Gives all vertices of a weld the mean position and velocity, by mass, and the pins of any. sum is [7 vertices]. */
static void yci_weld_state(yc_scene *s, double *sum) {
    int i, k;
    for (i = 0; i < s->vertices; i++) {
        double *at = sum + 7 * s->weld[i], mass = s->model->mass_fixed[i] + 1e-30;
        at[0] += mass;
        yci_axpy(at + 1, mass, s->x + 3 * i), yci_axpy(at + 4, mass, s->velocity + 3 * i);
    }
    for (i = 0; i < s->vertices; i++) {
        int to = s->weld[i];
        if (s->pin[to] || to == i) continue;
        if (s->pin[i]) s->pin[to] = 1, yci_copy(s->goal + 3 * to, s->goal + 3 * i);
    }
    for (i = 0; i < s->vertices; i++) {
        const double *at = sum + 7 * s->weld[i];
        for (k = 0; k < 3; k++) s->x[3 * i + k] = at[1 + k] / at[0], s->velocity[3 * i + k] = at[4 + k] / at[0];
    }
}

/* Welds the seams that have closed. The positions of vertices that are welded already must not be spread again: their
 * representative speaks for them, so it is copied to all first. */
static yc_result yci_weld_closed(yc_scene *s) {
    double *sum;
    yc_result result;
    int i, count = 0;
    for (i = 0; i < s->seam_count; i++) count += yci_seam_is_closed(s, i);
    if (!count) return YC_OK;
    result = yci_scene_build(s); /* its masses weigh the mean */
    if (result != YC_OK) return result;
    sum = YCI_NEW(&s->c, double, 7 * (size_t)s->vertices);
    if (!sum) return yci_out_of_memory(&s->c, "welding");
    for (i = 0; i < s->vertices; i++) {
        yci_copy(s->x + 3 * i, s->x + 3 * s->weld[i]);
        yci_copy(s->velocity + 3 * i, s->velocity + 3 * s->weld[i]);
    }
    for (i = 0; i < s->seam_count; i++)
        if (yci_seam_is_closed(s, i)) {
            s->welded[i] = 1;
            yci_log(&s->c, "seam %d welded at %.3f s", i, s->time);
        }
    yci_reweld(s);
    yci_weld_state(s, sum);
    yci_free(&s->c, sum);
    yci_model_destroy(s);
    return YC_OK;
}

/* ---- changes of networks ----
 *
 * Between two sub-steps, and all at once: what is due is marked, everything that can fail is acquired, then networks
 * and state are written anew. A visit that goes leaves one longer segment in place of its two; a crossing that it
 * leaves becomes a lone visit of the other yarn, whose sliding turns into motion of its node; a visit that comes stands
 * in the middle of its segment and moves with the material there. What linear momentum the first two would change goes
 * to the ends of the segment: to the lone ones, or else to both; what belongs to a pinned end is the pin's. */

enum { YCI_ADD_NODE = 1, YCI_ADD_BREAK = 2 };

typedef struct yci_change {
    yc_scene *s;
    unsigned char *drop, *add; /* [visits]: whether it goes, and what comes behind it */
    unsigned char *part;       /* [visits]: whether it gets a node of its own */
    unsigned char *tell;       /* [visits]: 1 + type of an event there, 0: none */
    int *visit_to;             /* [visits], their numbers in their networks to come */
    unsigned char *touched;    /* [nodes], whether a visit leaves it */
    yci_crossing *crossing;    /* [nodes], visits by their numbers in the scene, */
    int *room;                 /* [2 visits], which lie here */
    /* The cloths' networks to come, owner NULL where it stays; and in their numbering: */
    yc_yarns *to;
    int *node_from;        /* [nodes], the number before; -1: new */
    int *visit_from;       /* [visits], the number before; -1 - a: new, behind visit a */
    unsigned char *visits; /* [nodes], how many */
    double *mass;          /* [nodes], kg */
    int node_count, visit_count;
    /* while a network is written: its cloth, and how far it is */
    int cloth, first_node, first_visit, visit, spare, fresh;
} yci_change;

/* What a segment calls for; *load receives its tension as a share of the yarn's strength. */
static int yci_segment_due(const yc_scene *s, const yci_cloth *cloth, int yarn, int k, double *load) {
    const yc_yarns *y = &cloth->yarns;
    const yc_yarn_material *material = y->materials + y->yarn_material[yarn];
    int a = cloth->visit + k, p = s->visit_node[a], q = s->visit_node[a + 1];
    double d[3], du = s->u[a + 1] - s->u[a], laid = y->visit_u[k + 1] - y->visit_u[k],
                 pitch = cloth->pitch[y->yarn_family[yarn]];
    *load = 0.0;
    if (s->model->role[p] != YCI_FULL || s->model->role[q] != YCI_FULL) return 0;
    yci_sub(d, s->x + 3 * q, s->x + 3 * p);
    if (material->strength > 0.0 && du > 2.0 * YCI_TAIL * pitch) {
        double rise = yci_rise(s, a + 1) - yci_rise(s, a);
        *load =
            material->stretch * (sqrt(yci_dot(d, d) + YCI_CRIMP_KAPPA * rise * rise) / du - 1.0) / material->strength;
    }
    if (*load > 1.0) return YCI_ADD_BREAK;
    return du > YCI_LONG * yci_max(pitch, laid) ? YCI_ADD_NODE : 0;
}

/* The energy of a yarn through `count` of its visits: of stretch between them and of bending at the inner ones. */
static double yci_change_energy(const yc_scene *s, const yci_cloth *cloth, int yarn, const int *visit, int count) {
    const yc_yarns *y = &cloth->yarns;
    const yc_yarn_material *material = y->materials + y->yarn_material[yarn];
    double q[11], energy = 0.0, strain, du, d[3];
    int i, k;
    for (i = 0; i + 1 < count; i++) {
        yci_sub(d, s->x + 3 * s->visit_node[visit[i + 1]], s->x + 3 * s->visit_node[visit[i]]);
        du = s->u[visit[i + 1]] - s->u[visit[i]], strain = yci_norm(d) / du - 1.0;
        energy += 0.5 * material->stretch * du * strain * strain;
    }
    for (i = 0; i + 2 < count; i++) {
        double rest = y->visit_turn ? y->visit_turn[visit[i + 1] - cloth->visit] : 0.0;
        for (k = 0; k < 3; k++) yci_copy(q + 3 * k, s->x + 3 * s->visit_node[visit[i + k]]);
        q[9] = s->u[visit[i]], q[10] = s->u[visit[i + 2]];
        energy += yci_yarn_bend(q, material->bending, rest, YCI_TURN_WIDTH, 0.0, 0.0, NULL, NULL, 0);
    }
    return energy;
}

/* Whether the yarn of a knit may go past a lone visit: where that costs no energy, or there is hardly any yarn left. */
static int yci_change_pays(const yc_scene *s, const yci_due *e) {
    const yci_cloth *cloth = s->cloth + e->cloth;
    const int *first = cloth->yarns.yarn_first + e->yarn;
    const yc_yarn_material *material = cloth->yarns.materials + cloth->yarns.yarn_material[e->yarn];
    int with[5], without[4], i, n = 0, m = 0;
    double pitch = cloth->pitch[cloth->yarns.yarn_family[e->yarn]], cost;
    for (i = e->drop - 2; i <= e->drop + 2; i++) {
        if (i < cloth->visit + first[0] || i >= cloth->visit + first[1]) continue;
        with[n++] = i;
        if (i != e->drop) without[m++] = i;
    }
    cost = yci_change_energy(s, cloth, e->yarn, without, m) - yci_change_energy(s, cloth, e->yarn, with, n);
    if (e->b > e->a + 1) return cost <= 0.0;
    return cost <= 0.1 * material->bending / pitch || s->u[e->b] - s->u[e->a] < YCI_NOTHING * pitch;
}

/* The other end of the stitch contacts that a visit lies in; itself where it lies in none. By the scene's numbers. */
static int yci_change_partner(const yc_scene *s, const yci_cloth *cloth, int visit) {
    return cloth->visit + yci_build_partner(&cloth->yarns, s->model->knitted + cloth->visit, visit - cloth->visit);
}

/* A yarn leaves one of its crossings, of a stitch contact both. The old loops of a stack lie side by side: once the new
 * one has gone they part too. */
static void yci_change_leave(yci_change *w, const yci_cloth *cloth, int visit) {
    const yci_role *role = w->s->model->knitted + visit;
    int end[2], i, k, fresh = role->contact >= 0 && role->fresh;
    end[0] = visit, end[1] = yci_change_partner(w->s, cloth, visit);
    for (i = 0; i < 1 + (end[1] != end[0]); i++) {
        const yci_crossing *at = w->crossing + w->s->visit_node[end[i]];
        int stays = 0;
        for (k = 0; k < at->count; k++)
            if (at->visit[k] == end[i] || (fresh && stays++)) w->part[at->visit[k]] = 1;
        w->touched[w->s->visit_node[end[i]]] = 1;
    }
}

static void yci_change_mark_due(yci_change *w, const yci_due *e) {
    const yci_cloth *cloth = w->s->cloth + e->cloth;
    int i;
    if (e->type == YC_EVENT_MERGE) {
        if (w->drop[e->drop - 1] || w->drop[e->drop] || w->drop[e->drop + 1]) return;
        w->drop[e->drop] = 1, w->touched[w->s->visit_node[e->drop]] = 1;
        return;
    }
    for (i = 0; i < 2; i++)
        if (e->leave[i] >= 0 &&
            (w->touched[w->s->visit_node[e->leave[i]]] ||
                w->touched[w->s->visit_node[yci_change_partner(w->s, cloth, e->leave[i])]]))
            return;
    i = yci_change_partner(w->s, cloth, e->leave[0]);
    w->tell[i < e->leave[0] ? i : e->leave[0]] = (unsigned char)(1 + e->type);
    for (i = 0; i < 2; i++)
        if (e->leave[i] >= 0) yci_change_leave(w, cloth, e->leave[i]);
}

/* Marks what is due, in w unless that is NULL; returns 0 when nothing is. Segments whose nodes a visit leaves wait. */
static int yci_change_mark(const yc_scene *s, yci_change *w) {
    const yci_model *m = s->model;
    int i, k, yarn, count = 0;
    for (i = 0; i < m->due_count; i++) {
        const yci_due *e = m->due + i;
        if (s->u[e->b] - s->u[e->a] >= e->limit || (e->type == YC_EVENT_MERGE && !yci_change_pays(s, e))) continue;
        count++;
        if (w) yci_change_mark_due(w, e);
    }
    for (i = 0; i < m->adjacent_count; i++) {
        const yci_adjacent *e = m->adjacent + i;
        if (e->drop < 0 || s->u[e->b] - s->u[e->a] >= e->limit) continue;
        count++;
        if (w) w->drop[e->drop] = 1, w->touched[s->visit_node[e->drop]] = 1;
    }
    for (i = 0; i < s->cloth_count; i++) {
        const yci_cloth *cloth = s->cloth + i;
        const yc_yarns *y = yci_cloth_yarns(cloth);
        for (yarn = 0; y && !cloth->desc.hold_network && yarn < y->yarn_count; yarn++) {
            double load, most = 1.0;
            int worst = -1;
            for (k = y->yarn_first[yarn]; k + 1 < y->yarn_first[yarn + 1]; k++) {
                int a = cloth->visit + k, due = yci_segment_due(s, cloth, yarn, k, &load);
                if (!due || (w && (w->touched[s->visit_node[a]] || w->touched[s->visit_node[a + 1]]))) continue;
                if (cloth->knit && yci_build_joined(y, m->knitted + cloth->visit, k)) continue;
                count++;
                if (w && due == YCI_ADD_NODE) w->add[a] = YCI_ADD_NODE;
                if (load > most) most = load, worst = a;
            }
            if (w && worst >= 0) w->add[worst] = YCI_ADD_BREAK;
        }
    }
    return count;
}

static int yci_change_spare(const yci_change *w, int node) { /* whether an event made it and nothing needs it now */
    return !w->crossing[node].count && !w->s->pin[node] && !yci_is_sewn(w->s, node);
}

/* Whether all four visits of a stitch contact stay together. */
static int yci_change_lasts(const yci_change *w, const yci_cloth *cloth, const yc_stitch_contact *at) {
    int i, lasts = 1;
    for (i = 0; i < 4; i++) lasts &= !w->part[cloth->visit + at->visit[i / 2][i % 2]];
    return lasts;
}

/* Counts what each cloth will have and makes room for it. */
static int yci_change_acquire(yci_change *w) {
    yc_scene *s = w->s;
    yci_context *c = &s->c;
    int i, k, events = 0;
    w->node_count = s->vertices;
    for (i = 0; i < s->cloth_count; i++) {
        const yci_cloth *cloth = s->cloth + i;
        const yc_yarns *y = &cloth->yarns;
        int nodes = 0, yarns = 0, gone = 0, parts = 0, told = 0, contacts = 0;
        for (k = cloth->visit; k < cloth->visit + y->visit_count; k++) {
            gone += w->drop[k], nodes += w->add[k], yarns += w->add[k] == YCI_ADD_BREAK;
            parts += w->part[k], told += w->tell[k] > 0;
        }
        if (nodes || gone || parts) {
            int fresh = nodes + parts;
            for (k = cloth->laid_nodes; k < y->node_count && fresh; k++) fresh -= yci_change_spare(w, cloth->node + k);
            for (k = 0; k < y->contact_count; k++) contacts += yci_change_lasts(w, cloth, y->contacts + k);
            if (!yci_network_new(c, y, y->node_count + fresh, y->yarn_count + yarns, y->visit_count - gone + nodes,
                    contacts, y->triangle != NULL, w->to + i))
                return 0;
            events += nodes + gone + parts + told + w->to[i].yarn_count;
        }
        w->node_count += w->to[i].owner ? w->to[i].node_count : y->node_count;
        w->visit_count += w->to[i].owner ? w->to[i].visit_count : y->visit_count;
    }
    w->node_from = YCI_NEW(c, int, w->node_count), w->visit_from = YCI_NEW(c, int, w->visit_count);
    w->visits = YCI_NEW(c, unsigned char, w->node_count), w->mass = YCI_NEW(c, double, w->node_count);
    return w->node_from && w->visit_from && w->visits && w->mass &&
        YCI_RESERVE(c, s->event, s->event_capacity, s->event_count, s->event_count + events);
}

static void yci_change_event(yci_change *w, yc_event_type type, int yarn, int other, int node) {
    yc_event *e = w->s->event + w->s->event_count++;
    e->type = type, e->cloth = w->cloth, e->yarn = yarn, e->other = other, e->node = node, e->time = w->s->time;
}

/* ---- the network to come ---- */

static void yci_change_push(yci_change *w, int node, double laid, int layer, int held, int from) {
    const yc_yarns *y = &w->s->cloth[w->cloth].yarns;
    yc_yarns *to = w->to + w->cloth;
    to->visit_node[w->visit] = node, to->visit_u[w->visit] = laid;
    to->visit_layer[w->visit] = (signed char)layer, to->visit_held[w->visit] = (unsigned char)held;
    if (to->visit_height)
        to->visit_height[w->visit] = from < 0 ? 0.0 : y->visit_height[from - w->s->cloth[w->cloth].visit];
    if (to->visit_turn) to->visit_turn[w->visit] = from < 0 ? 0.0 : y->visit_turn[from - w->s->cloth[w->cloth].visit];
    w->visit_from[w->first_visit + w->visit] = from;
    if (from >= 0) w->visit_to[from] = w->visit;
    w->visits[w->first_node + node]++, w->visit++;
}

/* Barycentric weights of a place of the pattern in a triangle of the mesh. */
static void yci_cloth_weights(const yci_cloth *cloth, int triangle, const double *place, double *weights) {
    const double(*uv)[2] = cloth->desc.mesh.uv;
    const int *v = cloth->desc.mesh.uv_triangles[triangle];
    double a[2], b[2], p[2], det;
    int k;
    for (k = 0; k < 2; k++)
        a[k] = uv[v[1]][k] - uv[v[0]][k], b[k] = uv[v[2]][k] - uv[v[0]][k], p[k] = place[k] - uv[v[0]][k];
    det = a[0] * b[1] - a[1] * b[0];
    weights[1] = (p[0] * b[1] - p[1] * b[0]) / det, weights[2] = (a[0] * p[1] - a[1] * p[0]) / det;
    weights[0] = 1.0 - weights[1] - weights[2];
}

/* The number of a new node. */
static int yci_change_node(yci_change *w) {
    const yci_cloth *cloth = w->s->cloth + w->cloth;
    int node;
    while (w->spare < cloth->yarns.node_count && !yci_change_spare(w, cloth->node + w->spare)) w->spare++;
    node = w->spare < cloth->yarns.node_count ? w->spare++ : w->fresh++;
    w->node_from[w->first_node + node] = -1;
    return node;
}

/* A new node and its visit, in the middle of the segment behind visit k. */
static int yci_change_middle(yci_change *w, int k) {
    const yci_cloth *cloth = w->s->cloth + w->cloth;
    const yc_yarns *y = &cloth->yarns;
    yc_yarns *to = w->to + w->cloth;
    int a = y->visit_node[k], b = y->visit_node[k + 1], node = yci_change_node(w), i;
    for (i = 0; i < 3; i++) to->layout[node][i] = 0.5 * (y->layout[a][i] + y->layout[b][i]);
    if (to->triangle) {
        to->triangle[node] = y->triangle[a];
        yci_cloth_weights(cloth, to->triangle[node], to->layout[node], to->weights[node]);
    }
    yci_change_push(w, node, 0.5 * (y->visit_u[k] + y->visit_u[k + 1]), 0, 1, -1 - (cloth->visit + k));
    return node;
}

/* The yarn, by its number now, of a visit. */
static int yci_change_yarn_of(const yci_change *w, int visit) {
    const yci_crossing *at = w->crossing + w->s->visit_node[visit];
    int k = 0;
    while (at->visit[k] != visit) k++;
    return at->yarn[k];
}

/* Writes visits k to `last` as part of yarn `yarn`, up to a break; `next` is the yarn that begins there. */
static void yci_change_run(yci_change *w, int yarn, int next, int k, int last) {
    const yci_cloth *cloth = w->s->cloth + w->cloth;
    const yc_yarns *y = &cloth->yarns;
    for (; k <= last; k++) {
        int from = cloth->visit + k, node = y->visit_node[k];
        const yci_crossing *at = w->crossing + cloth->node + node;
        if (w->tell[from])
            yci_change_event(w, (yc_event_type)(w->tell[from] - 1), yarn,
                w->tell[from] - 1 == YC_EVENT_RELEASE ? at->yarn[at->visit[0] == from] : -1, node);
        if (w->part[from]) {
            int own = yci_change_node(w);
            yci_copy(w->to[w->cloth].layout[own], y->layout[node]);
            if (y->triangle && w->to[w->cloth].triangle) {
                w->to[w->cloth].triangle[own] = y->triangle[node];
                yci_copy(w->to[w->cloth].weights[own], y->weights[node]);
            }
            yci_change_event(w, YC_EVENT_PART, yarn, own, node);
            yci_change_push(w, own, y->visit_u[k], y->visit_layer[k], y->visit_held[k], from);
        } else if (!w->drop[from]) yci_change_push(w, node, y->visit_u[k], y->visit_layer[k], y->visit_held[k], from);
        else if (at->count < 2) yci_change_event(w, YC_EVENT_MERGE, yarn, -1, node);
        else yci_change_event(w, YC_EVENT_RELEASE, yarn, at->yarn[at->visit[0] == from], node);
        if (!w->add[from]) continue;
        node = yci_change_middle(w, k);
        if (w->add[from] == YCI_ADD_NODE) yci_change_event(w, YC_EVENT_SPLIT, yarn, -1, node);
        else {
            yci_change_event(w, YC_EVENT_BREAK, yarn, next, node);
            return;
        }
    }
}

static void yci_change_yarns(yci_change *w) {
    const yci_cloth *cloth = w->s->cloth + w->cloth;
    const yc_yarns *y = &cloth->yarns;
    yc_yarns *to = w->to + w->cloth;
    int yarn, pass, next, k;
    for (pass = 0; pass < 2; pass++) /* what stands before the breaks, then the new yarns behind them */
        for (yarn = 0, next = y->yarn_count; yarn < y->yarn_count; yarn++) {
            int first = y->yarn_first[yarn], last = y->yarn_first[yarn + 1] - 1, number = pass ? next : yarn;
            for (k = first; k < last && w->add[cloth->visit + k] != YCI_ADD_BREAK;) k++;
            if (pass && k == last) continue;
            to->yarn_first[number] = w->visit;
            to->yarn_family[number] = y->yarn_family[yarn], to->yarn_material[number] = y->yarn_material[yarn];
            if (pass) yci_change_middle(w, k);
            yci_change_run(w, number, next, pass ? k + 1 : first, last);
            next += k < last;
        }
    to->yarn_first[to->yarn_count] = w->visit;
}

/* An end that has slid out of crossings is laid where the last of them was. `inside` is the visit next to it. */
static void yci_change_lay_end(yci_change *w, int end, int inside) {
    const yci_cloth *cloth = w->s->cloth + w->cloth;
    const yc_yarns *y = &cloth->yarns;
    yc_yarns *to = w->to + w->cloth;
    int from = w->visit_from[w->first_visit + inside] + (end < inside ? -1 : 1), node = to->visit_node[end], left;
    if (w->visit_from[w->first_visit + inside] < 0 || !w->drop[from] || w->crossing[w->s->visit_node[from]].count < 2)
        return;
    left = y->visit_node[from - cloth->visit];
    to->visit_u[end] = y->visit_u[from - cloth->visit];
    yci_copy(to->layout[node], y->layout[left]);
    if (to->triangle) to->triangle[node] = y->triangle[left], yci_copy(to->weights[node], y->weights[left]);
}

static int yci_change_crosses(
    const yci_change *w, int yarn, int before) { /* whether a yarn of the cloth has a crossing */
    const yci_cloth *cloth = w->s->cloth + w->cloth;
    const yc_yarns *y = before ? &cloth->yarns : w->to + w->cloth;
    int k, found = 0;
    for (k = y->yarn_first[yarn]; k < y->yarn_first[yarn + 1] && !found; k++)
        found = (before ? w->crossing[cloth->node + y->visit_node[k]].count
                        : w->visits[w->first_node + y->visit_node[k]]) > 1;
    return found;
}

/* The layer of a visit among those that stay at its node: of n, which are sorted, from 1 - n to n - 1. */
static int yci_change_layer(const yci_change *w, int visit) {
    const yci_crossing *at = w->crossing + w->s->visit_node[visit];
    int k, layer = 0, side = 1;
    for (k = 0; k < at->count && !w->part[visit]; k++)
        if (at->visit[k] == visit) side = -1;
        else if (!w->part[at->visit[k]] && !w->drop[at->visit[k]]) layer += side;
    return layer;
}

/* Writes the network to come of w->cloth. */
static void yci_change_write(yci_change *w) {
    const yci_cloth *cloth = w->s->cloth + w->cloth;
    const yc_yarns *y = &cloth->yarns;
    yc_yarns *to = w->to + w->cloth;
    size_t nodes = (size_t)y->node_count;
    int k, yarn, from, contacts = 0;
    memcpy(to->layout, y->layout, nodes * sizeof *y->layout);
    if (to->triangle) {
        memcpy(to->triangle, y->triangle, nodes * sizeof *y->triangle);
        memcpy(to->weights, y->weights, nodes * sizeof *y->weights);
    }
    w->visit = 0, w->spare = cloth->laid_nodes, w->fresh = y->node_count;
    yci_change_yarns(w);
    for (k = 0; k < to->visit_count; k++) {
        from = w->visit_from[w->first_visit + k];
        if (from < 0 || !w->touched[w->s->visit_node[from]]) continue;
        to->visit_layer[k] = (signed char)yci_change_layer(w, from);
        if (w->visits[w->first_node + to->visit_node[k]] > 1) continue;
        if (to->visit_height) to->visit_height[k] = 0.0;
        if (!to->visit_held[k]) to->visit_held[k] = 1;
    }
    for (k = 0; k < y->contact_count; k++) {
        yc_stitch_contact *at = to->contacts + contacts;
        if (!yci_change_lasts(w, cloth, y->contacts + k)) continue;
        *at = y->contacts[k], contacts++;
        for (from = 0; from < 4; from++)
            at->visit[from / 2][from % 2] = w->visit_to[cloth->visit + at->visit[from / 2][from % 2]];
    }
    for (yarn = 0; yarn < to->yarn_count; yarn++) {
        int first = to->yarn_first[yarn], last = to->yarn_first[yarn + 1] - 1;
        int was = yarn < y->yarn_count ? yarn : yci_change_yarn_of(w, w->visit_from[w->first_visit + last]);
        yci_change_lay_end(w, first, first + 1), yci_change_lay_end(w, last, last - 1);
        if (yci_change_crosses(w, was, 1) && !yci_change_crosses(w, yarn, 0))
            yci_change_event(w, YC_EVENT_LOOSE, yarn, -1, -1);
    }
}

/* Writes what is to come of all cloths, and the numberings. */
static void yci_change_write_all(yci_change *w) {
    yc_scene *s = w->s;
    int i, k;
    for (i = 0; i < s->vertices; i++) w->node_from[i] = i;
    w->first_node = s->vertices, w->first_visit = 0;
    for (i = 0; i < s->cloth_count; i++) {
        const yci_cloth *cloth = s->cloth + i;
        const yc_yarns *to = w->to[i].owner ? w->to + i : &cloth->yarns;
        for (k = 0; k < to->node_count; k++)
            w->node_from[w->first_node + k] = k < cloth->yarns.node_count ? cloth->node + k : -1;
        w->cloth = i;
        if (w->to[i].owner) yci_change_write(w);
        else
            for (k = 0; k < to->visit_count; k++) w->visit_from[w->first_visit + k] = cloth->visit + k;
        w->first_node += to->node_count, w->first_visit += to->visit_count;
    }
}

/* ---- the state to come ---- */

/* The state to come, by the arrays of yci_state_arrays. */
typedef struct yci_change_state {
    double *x, *velocity, *u, *slide, *anchor, *z; /* z NULL without crimp */
} yci_change_state;

static void yci_change_map(yci_change *w, yci_grow *grow, yci_change_state *out) {
    const yc_scene *s = w->s;
    yci_state_array list[YCI_STATE_ARRAYS];
    int i, k;
    yci_state_arrays(w->s, list);
    memset(out, 0, sizeof *out);
    for (i = 0; i < YCI_STATE_ARRAYS; i++) {
        const int *from = list[i].of_visits ? w->visit_from : w->node_from;
        const char *old = yci_state_array_of(list + i);
        int count = list[i].of_visits ? w->visit_count : w->node_count;
        if (!list[i].size) continue;
        for (k = 0; k < count; k++)
            if (from[k] >= 0)
                memcpy(
                    (char *)grow->fresh + (size_t)k * list[i].size, old + (size_t)from[k] * list[i].size, list[i].size);
        if (list[i].array == &s->x) out->x = (double *)grow->fresh;
        if (list[i].array == &s->velocity) out->velocity = (double *)grow->fresh;
        if (list[i].array == &s->u) out->u = (double *)grow->fresh;
        if (list[i].array == &s->slide) out->slide = (double *)grow->fresh;
        if (list[i].array == &s->anchor) out->anchor = (double *)grow->fresh;
        if (list[i].array == &s->z) out->z = (double *)grow->fresh;
        grow++->used = 0; /* written already */
    }
}

/* Adds the linear momentum of a segment between visits a and b, as they are now; `slide` is the sum of their speeds. */
static void yci_change_momentum(const yc_scene *s, int a, int b, double density, double slide, double *p) {
    const double *va = s->velocity + 3 * s->visit_node[a], *vb = s->velocity + 3 * s->visit_node[b];
    double d[3], half = 0.5 * density * (s->u[b] - s->u[a]);
    yci_sub(d, s->x + 3 * s->visit_node[b], s->x + 3 * s->visit_node[a]);
    yci_axpy(p, half, va), yci_axpy(p, half, vb), yci_axpy(p, -0.5 * density * slide, d);
}

/* Fills in the visit that comes at `visit`, of node `node`. */
static void yci_change_fill(const yci_change *w, const yci_change_state *to, int visit, int node) {
    const yc_scene *s = w->s;
    int a = -1 - w->visit_from[visit], b = a + 1, p = s->visit_node[a], q = s->visit_node[b], k;
    double along[3], rate = 0.5 * (s->slide[a] + s->slide[b]) / (s->u[b] - s->u[a]);
    yci_sub(along, s->x + 3 * q, s->x + 3 * p);
    for (k = 0; k < 3; k++) {
        to->x[3 * node + k] = 0.5 * (s->x[3 * p + k] + s->x[3 * q + k]);
        to->velocity[3 * node + k] = 0.5 * (s->velocity[3 * p + k] + s->velocity[3 * q + k]) - rate * along[k];
    }
    to->u[visit] = to->anchor[visit] = 0.5 * (s->u[a] + s->u[b]);
    if (to->z) to->z[visit] = 0.5 * (yci_rise(s, a) + yci_rise(s, b));
}

/* The segment between visits i and i + 1 to come, `node` is where they go; `shift` leads from nodes now to nodes to
 * come. First masses follow it, then what it lacks of its former momentum goes to its ends. */
static void yci_change_segment(yci_change *w, const yci_change_state *to, int i, const int *node, int first, int shift,
    double density, int masses) {
    const yc_scene *s = w->s;
    int a = w->visit_from[i], b = w->visit_from[i + 1], k, end[2];
    double lost[3] = {0.0, 0.0, 0.0}, after[3] = {0.0, 0.0, 0.0}, half, sum = 0.0;
    if (a < 0 || b < 0) { /* half of a segment that gets a node: a quarter of its mass leaves the end that it had */
        k = a < 0 ? -1 - a : a;
        if (masses) w->mass[s->visit_node[a < 0 ? b : a] + shift] -= 0.25 * density * (s->u[k + 1] - s->u[k]);
        return;
    }
    end[0] = first + node[0], end[1] = first + node[1];
    if (masses) {
        for (k = a; k < b; k++) {
            half = 0.5 * density * (s->u[k + 1] - s->u[k]);
            w->mass[s->visit_node[k] + shift] -= half, w->mass[s->visit_node[k + 1] + shift] -= half;
            w->mass[end[0]] += half, w->mass[end[1]] += half;
        }
        return;
    }
    if (b == a + 1 && to->slide[i] == s->slide[a] && to->slide[i + 1] == s->slide[b]) return;
    for (k = a; k < b; k++) yci_change_momentum(s, k, k + 1, density, s->slide[k] + s->slide[k + 1], lost);
    yci_change_momentum(s, a, b, density, to->slide[i] + to->slide[i + 1], after);
    yci_axpy(lost, -1.0, after);
    for (k = 0; k < 2; k++) {
        int alone = w->visits[end[k]] == 1 || w->visits[end[!k]] > 1;
        half = alone && (w->node_from[end[k]] < 0 || !s->model->held[w->node_from[end[k]]]) ? 1.0 : 0.0;
        if (half > 0.0) sum += w->mass[end[k]];
        else end[k] = -1;
    }
    for (k = 0; k < 2; k++)
        if (end[k] >= 0) yci_axpy(to->velocity + 3 * end[k], 1.0 / sum, lost);
}

/* What the arrays of the state hold for what is new, and what changes for the others. */
static void yci_change_motion(yci_change *w, const yci_change_state *to) {
    yc_scene *s = w->s;
    int i, k, yarn, pass, node, visit;
    for (i = 0; i < w->node_count; i++) w->mass[i] = w->node_from[i] < 0 ? 0.0 : s->model->mass[w->node_from[i]];
    for (pass = 0; pass < 3; pass++)
        for (i = 0, node = s->vertices, visit = 0; i < s->cloth_count; i++) {
            const yci_cloth *cloth = s->cloth + i;
            const yc_yarns *y = w->to[i].owner ? w->to + i : &cloth->yarns;
            for (yarn = 0; w->to[i].owner && yarn < y->yarn_count; yarn++) {
                double density = y->materials[y->yarn_material[yarn]].density;
                for (k = y->yarn_first[yarn]; k < y->yarn_first[yarn + 1]; k++) {
                    int from = w->visit_from[visit + k];
                    if (!pass && from < 0) yci_change_fill(w, to, visit + k, node + y->visit_node[k]);
                    else if (!pass && w->touched[s->visit_node[from]] && w->visits[node + y->visit_node[k]] == 1) {
                        to->slide[visit + k] = 0.0;
                        if (to->z) to->z[visit + k] = yci_rise(s, from);
                    }
                    if (!pass && from >= 0 && w->part[from]) {
                        yci_copy(to->x + 3 * (node + y->visit_node[k]), s->x + 3 * s->visit_node[from]);
                        yci_copy(to->velocity + 3 * (node + y->visit_node[k]), s->velocity + 3 * s->visit_node[from]);
                    }
                    if (pass && k + 1 < y->yarn_first[yarn + 1])
                        yci_change_segment(
                            w, to, visit + k, y->visit_node + k, node, node - cloth->node, density, pass == 1);
                }
            }
            node += y->node_count, visit += y->visit_count;
        }
}

static void yci_change_commit(yci_change *w, yci_grow *grow, int arrays) {
    yc_scene *s = w->s;
    yci_context *c = &s->c;
    int i;
    yci_grow_commit(c, grow, arrays);
    if (s->node_room < w->node_count) s->node_room = w->node_count;
    if (s->visit_room < w->visit_count) s->visit_room = w->visit_count;
    for (i = 0; i < s->cloth_count; i++) {
        yci_cloth *cloth = s->cloth + i;
        if (!w->to[i].owner) continue;
        if (cloth->kept.owner) yci_free(c, cloth->yarns.owner);
        else cloth->kept = cloth->yarns;
        cloth->yarns = w->to[i], w->to[i].owner = NULL;
    }
    yci_scene_number(s);
    yci_model_destroy(s);
}

/* Brings about what is due. On failure nothing has changed. */
static yc_result yci_change_networks(yc_scene *s) {
    yci_context *c = &s->c;
    yci_change w;
    yci_change_state to;
    yci_grow grow[YCI_STATE_ARRAYS + 1];
    int i, arrays = 0, ok;
    yc_result result = yci_scene_build(s);
    if (result != YC_OK || !yci_change_mark(s, NULL)) return result;
    memset(&w, 0, sizeof w);
    w.s = s;
    w.drop = YCI_NEW(c, unsigned char, s->visits), w.add = YCI_NEW(c, unsigned char, s->visits);
    w.part = YCI_NEW(c, unsigned char, s->visits), w.tell = YCI_NEW(c, unsigned char, s->visits);
    w.visit_to = YCI_NEW(c, int, s->visits);
    w.touched = YCI_NEW(c, unsigned char, s->nodes), w.crossing = YCI_NEW(c, yci_crossing, s->nodes);
    w.room = YCI_NEW(c, int, 2 * (size_t)s->visits);
    w.to = YCI_NEW(c, yc_yarns, s->cloth_count);
    ok = w.drop && w.add && w.part && w.tell && w.visit_to && w.touched && w.crossing && w.room && w.to;
    for (i = 0; ok && i < s->cloth_count; i++)
        yci_crossing_fill(w.crossing, &s->cloth[i].yarns, s->visit_node + s->cloth[i].visit, s->cloth[i].visit,
            s->cloth[i].knit, w.room + 2 * s->cloth[i].visit);
    if (ok) yci_change_mark(s, &w), ok = yci_change_acquire(&w);
    if (ok) {
        int nodes = s->node_room > w.node_count ? s->node_room : w.node_count;
        int visits = s->visit_room > w.visit_count ? s->visit_room : w.visit_count;
        arrays = yci_state_grow(s, nodes, visits, grow);
        ok = yci_grow_acquire(c, grow, arrays);
    }
    if (ok) {
        yci_keep(s), yci_masses(s);
        yci_change_write_all(&w);
        yci_change_map(&w, grow, &to);
        yci_change_motion(&w, &to);
        yci_change_commit(&w, grow, arrays);
    }
    for (i = 0; w.to && i < s->cloth_count; i++) yci_free(c, w.to[i].owner);
    yci_free(c, w.drop), yci_free(c, w.add), yci_free(c, w.part), yci_free(c, w.tell), yci_free(c, w.visit_to);
    yci_free(c, w.touched), yci_free(c, w.crossing), yci_free(c, w.room), yci_free(c, w.to);
    yci_free(c, w.node_from), yci_free(c, w.visit_from), yci_free(c, w.visits), yci_free(c, w.mass);
    return ok ? YC_OK : yci_out_of_memory(c, "a change of yarns");
}

/* The user's step is done, or undone: the networks of its beginning go, or come back. */
static void yci_change_settle(yc_scene *s, int undo) {
    int i, back = 0;
    for (i = 0; i < s->cloth_count; i++) {
        yci_cloth *cloth = s->cloth + i;
        if (!cloth->kept.owner) continue;
        back = undo;
        yci_free(&s->c, undo ? cloth->yarns.owner : cloth->kept.owner);
        if (undo) cloth->yarns = cloth->kept;
        cloth->kept.owner = NULL;
    }
    if (back) yci_model_destroy(s), yci_scene_number(s);
}

/* ---- state ---- */

typedef struct yci_state_head {
    char magic[8];
    int vertices, nodes, visits, crimped, rubs, seams, bodies, cloths;
    int laid_nodes, laid_visits; /* of all networks as they were given */
    double time, dt;
} yci_state_head;

enum { YCI_STATE_ASK, YCI_STATE_WRITE, YCI_STATE_READ };

static void yci_state_move(int way, char *buffer, size_t *at, void *data, size_t size) {
    if (way == YCI_STATE_WRITE && size) memcpy(buffer + *at, data, size);
    if (way == YCI_STATE_READ && size) memcpy(data, buffer + *at, size);
    *at += size;
}

/* All arrays of the state to or from a buffer, doubles first. */
static void yci_state_pass(yc_scene *s, int way, char *buffer) {
    yci_state_array list[YCI_STATE_ARRAYS];
    size_t at = sizeof(yci_state_head);
    int i;
    yci_state_arrays(s, list);
    yci_state_move(way, buffer, &at, s->pose, 2 * (size_t)s->body_count * sizeof(yci_pose));
    for (i = 0; i < YCI_STATE_SAVED; i++)
        yci_state_move(way, buffer, &at, yci_state_array_of(list + i),
            (size_t)(list[i].of_visits ? s->visits : s->nodes) * list[i].size);
    yci_state_move(way, buffer, &at, s->welded, (size_t)s->seam_count);
}

/* What that takes with so many nodes and visits. */
static size_t yci_state_size(yc_scene *s, int nodes, int visits) {
    yci_state_array list[YCI_STATE_ARRAYS];
    size_t size = sizeof(yci_state_head) + 2 * (size_t)s->body_count * sizeof(yci_pose) + (size_t)s->seam_count;
    int i;
    yci_state_arrays(s, list);
    for (i = 0; i < YCI_STATE_SAVED; i++) size += (size_t)(list[i].of_visits ? visits : nodes) * list[i].size;
    return size;
}

/* Behind them, one network: its counts, then its arrays. */
static size_t yci_state_network(const yc_yarns *y, int way, char *buffer, size_t at) {
    yci_network_part part[YCI_NETWORK_PARTS];
    int count[4], i;
    count[0] = y->node_count, count[1] = y->yarn_count, count[2] = y->visit_count, count[3] = y->contact_count;
    yci_state_move(way, buffer, &at, count, sizeof count);
    yci_network_parts(y, part);
    for (i = 0; i < YCI_NETWORK_PARTS; i++) yci_state_move(way, buffer, &at, part[i].data, part[i].bytes);
    return at;
}

static size_t yci_state_networks(const yc_scene *s, int way, char *buffer, size_t at) {
    int i;
    for (i = 0; i < s->cloth_count; i++)
        if (yci_cloth_yarns(s->cloth + i)) at = yci_state_network(&s->cloth[i].yarns, way, buffer, at);
    return at;
}

static void yci_state_head_make(const yc_scene *s, yci_state_head *head) {
    int i;
    memset(head, 0, sizeof *head);
    memcpy(head->magic, "yarnst03", 8);
    head->vertices = s->vertices, head->nodes = s->nodes, head->visits = s->visits, head->cloths = s->cloth_count;
    head->crimped = s->crimped, head->rubs = s->rubs;
    head->seams = s->seam_count, head->bodies = s->body_count, head->time = s->time, head->dt = s->dt;
    for (i = 0; i < s->cloth_count; i++)
        head->laid_nodes += s->cloth[i].laid_nodes, head->laid_visits += s->cloth[i].laid_visits;
}

static void yci_state_write(yc_scene *s, char *buffer) {
    yci_state_head head;
    yci_state_head_make(s, &head);
    memcpy(buffer, &head, sizeof head);
    yci_state_pass(s, YCI_STATE_WRITE, buffer);
}

/* The scene's networks are those of the buffer. The model goes when welds differ, which a step may change; `fresh`
 * makes it go anyway, so that nothing of the past is left in it. */
static void yci_state_read(yc_scene *s, const char *buffer, int fresh) {
    const char *welded = buffer + yci_state_size(s, s->nodes, s->visits) - (size_t)s->seam_count; /* they come last */
    yci_state_head head;
    int i;
    memcpy(&head, buffer, sizeof head);
    if (fresh || (s->seam_count && memcmp(s->welded, welded, (size_t)s->seam_count) != 0)) yci_model_destroy(s);
    yci_state_pass(s, YCI_STATE_READ, (char *)buffer);
    if (s->model) s->model->tense = 0;
    s->time = head.time, s->dt = head.dt;
    for (i = 0; i < s->body_count; i++) s->body[i].pose = s->pose[2 * i];
    yci_reweld(s);
}

YC_API yc_result yc_scene_save(yc_scene *s, void *buffer, size_t *size) {
    size_t at = yci_state_size(s, s->nodes, s->visits), need = yci_state_networks(s, YCI_STATE_ASK, NULL, at);
    if (!size) return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "size is NULL");
    if (!buffer) {
        *size = need;
        return YC_OK;
    }
    if (*size < need)
        return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "size = %lu bytes, the state needs %lu", (unsigned long)*size,
            (unsigned long)need);
    yci_model_destroy(s);
    yci_state_write(s, (char *)buffer);
    yci_state_networks(s, YCI_STATE_WRITE, (char *)buffer, at);
    *size = need;
    return YC_OK;
}

static int yci_state_head_same(const yci_state_head *a, const yci_state_head *b) {
    return !memcmp(a->magic, b->magic, sizeof a->magic) && a->vertices == b->vertices && a->cloths == b->cloths &&
        a->crimped == b->crimped && a->rubs == b->rubs && a->laid_nodes == b->laid_nodes &&
        a->laid_visits == b->laid_visits && a->seams == b->seams && a->bodies == b->bodies &&
        a->nodes >= a->vertices + a->laid_nodes && a->nodes < INT_MAX / 9 && a->visits >= 0 &&
        a->visits < INT_MAX / 9 && a->time >= 0.0 && a->dt > 0.0;
}

/* Reads one network from a state and checks it; *u, at most `visits` of them, are its sliding coordinates. */
static yc_result yci_state_take(yc_scene *s, const yci_cloth *cloth, const char *buffer, size_t size, size_t *at,
    const char *u, int visits, yc_yarns *out) {
    yci_context *c = &s->c;
    const yc_mesh *mesh = cloth->desc.mesh.vertex_count ? &cloth->desc.mesh : NULL;
    int count[4], i;
    size_t bytes;
    double *laid;
    char why[YC_MESSAGE_SIZE];
    yc_result result;
    if (size - *at < sizeof count) return YCI_FAIL(c, YC_ERROR_PARSE, "the state ends before its networks");
    memcpy(count, buffer + *at, sizeof count);
    for (i = 0; i < 3; i++)
        if (count[i] < 1 || (size_t)count[i] > size || count[0] < cloth->laid_nodes || count[2] > visits)
            return YCI_FAIL(c, YC_ERROR_PARSE, "a network of the state has %d nodes, %d yarns, %d visits", count[0],
                count[1], count[2]);
    if (count[3] < 0 || (size_t)count[3] > size || (count[3] && !cloth->knit))
        return YCI_FAIL(c, YC_ERROR_PARSE, "a network of the state has %d stitch contacts", count[3]);
    if (!yci_network_new(c, &cloth->yarns, count[0], count[1], count[2], count[3], mesh != NULL, out))
        return yci_out_of_memory(c, "a state");
    if (yci_state_network(out, YCI_STATE_ASK, NULL, *at) > size)
        return YCI_FAIL(c, YC_ERROR_PARSE, "the state ends within a network");
    *at = yci_state_network(out, YCI_STATE_READ, (char *)buffer, *at);
    for (i = 0; i < count[2]; i++)
        if (!yci_finite(out->visit_u[i]))
            return YCI_FAIL(c, YC_ERROR_PARSE, "a network of the state lays visit %d at %g", i, out->visit_u[i]);
    bytes = (size_t)count[2] * sizeof *laid;
    laid = YCI_NEW(c, double, count[2]);
    if (!laid) return yci_out_of_memory(c, "a state");
    memcpy(laid, out->visit_u, bytes), memcpy(out->visit_u, u, bytes);
    result = yci_yarns_check(c, out, mesh);
    if (result == YC_OK && count[3]) result = yci_knit_check_stacks(c, out);
    memcpy(out->visit_u, laid, bytes);
    yci_free(c, laid);
    if (result == YC_OK || result == YC_ERROR_MEMORY) return result;
    memcpy(why, c->message, sizeof why);
    return YCI_FAIL(c, YC_ERROR_PARSE, "the state's %.200s", why);
}

/* Reads all networks of a state; the arrays in front of them are there. */
static yc_result yci_state_open(
    yc_scene *s, const yci_state_head *head, const char *buffer, size_t size, yc_yarns *to) {
    const char *u = buffer + sizeof *head + 2 * (size_t)s->body_count * sizeof(yci_pose);
    size_t at = yci_state_size(s, head->nodes, head->visits);
    int i, k, side, nodes = head->vertices, visits = 0;
    yc_result result = YC_OK;
    u += 9 * (size_t)head->nodes * sizeof(double);
    for (i = 0; i < s->cloth_count; i++) {
        if (!yci_cloth_yarns(s->cloth + i)) continue;
        result = yci_state_take(
            s, s->cloth + i, buffer, size, &at, u + (size_t)visits * sizeof(double), head->visits - visits, to + i);
        if (result != YC_OK) return result;
        nodes += to[i].node_count, visits += to[i].visit_count;
    }
    if (nodes != head->nodes || visits != head->visits || at != size)
        return YCI_FAIL(&s->c, YC_ERROR_PARSE, "the state's networks do not add up");
    for (i = 0; i < s->seam_count; i++)
        for (k = 0; s->seam[i].desc.kind == YC_NODE && k < s->seam[i].desc.count; k++)
            for (side = 0; side < 2; side++)
                if ((side ? s->seam[i].b : s->seam[i].a)[k] >= to[s->seam[i].desc.cloth[side]].node_count)
                    return YCI_FAIL(&s->c, YC_ERROR_PARSE, "the state lacks a node of seam %d", i);
    return YC_OK;
}

YC_API yc_result yc_scene_load(yc_scene *s, const void *buffer, size_t size) {
    const char *bytes = (const char *)buffer;
    yci_context *c = &s->c;
    yci_state_head head, own;
    yci_grow grow[YCI_STATE_ARRAYS + 1];
    yc_yarns *to;
    size_t i, count;
    int k, arrays;
    yc_result result;
    yci_state_head_make(s, &own);
    if (!buffer || size < sizeof head)
        return YCI_FAIL(c, YC_ERROR_PARSE, "a state of %lu bytes is not this scene's", (unsigned long)size);
    memcpy(&head, buffer, sizeof head);
    if (!yci_state_head_same(&head, &own) || size < yci_state_size(s, head.nodes, head.visits))
        return YCI_FAIL(c, YC_ERROR_PARSE, "the state is not this scene's");
    count = (size_t)(9 + (s->rubs ? 4 : 0)) * (size_t)head.nodes + (size_t)(s->crimped ? 5 : 3) * (size_t)head.visits +
        24 * (size_t)s->body_count;
    for (i = 0; i < count; i++) {
        double value; /* the doubles of a state come first, in one row */
        memcpy(&value, bytes + sizeof head + i * sizeof value, sizeof value);
        if (!yci_finite(value))
            return YCI_FAIL(c, YC_ERROR_PARSE, "number %lu of the state is %g", (unsigned long)i, value);
    }
    to = YCI_NEW(c, yc_yarns, s->cloth_count);
    result = to ? yci_state_open(s, &head, bytes, size, to) : yci_out_of_memory(c, "a state");
    if (result == YC_OK) {
        int nodes = s->node_room > head.nodes ? s->node_room : head.nodes;
        int visits = s->visit_room > head.visits ? s->visit_room : head.visits;
        arrays = yci_state_grow(s, nodes, visits, grow);
        if (!yci_grow_acquire(c, grow, arrays)) result = yci_out_of_memory(c, "a state");
        else yci_grow_commit(c, grow, arrays), s->node_room = nodes, s->visit_room = visits;
    }
    for (k = 0; to && k < s->cloth_count; k++) {
        yci_free(c, result == YC_OK ? s->cloth[k].yarns.owner : to[k].owner);
        if (result == YC_OK) s->cloth[k].yarns = to[k];
    }
    yci_free(c, to);
    if (result != YC_OK) return result;
    yci_scene_number(s);
    yci_state_read(s, bytes, 1);
    s->event_count = 0;
    return YC_OK;
}

/* ---- the user's step ---- */

/* Sub-steps until dt is done. The caller restores the state when this fails. */
static yc_result yci_advance(yc_scene *s, double dt, yc_stats *stats) {
    double start = s->time, remaining = dt, h = yci_min(s->dt, s->desc.dt_max);
    double most = s->desc.newton_limit * (YCI_RETRIES + ceil(dt / h));
    yc_result result;
    int i;
    while (remaining > 0.0) {
        double pieces = ceil(remaining / h - 1e-9), step = remaining / yci_max(pieces, 1.0);
        result = yci_weld_closed(s);
        if (result == YC_OK) result = yci_change_networks(s);
        if (result == YC_OK) result = yci_scene_build(s);
        if (result == YC_OK) result = yci_substep(s, step, step / remaining, stats);
        if (result == YC_ERROR_DIVERGED && 0.5 * step >= s->desc.dt_min) {
            h = 0.5 * step, stats->rejected++;
            if (stats->newton <= most) continue;
        }
        if (result != YC_OK) return result;
        stats->substeps++;
        remaining = pieces <= 1.0 ? 0.0 : remaining - step;
        h = yci_min(2.0 * step, s->desc.dt_max);
        if (s->c.host.progress && s->c.host.progress(s->c.host.user, 1.0 - remaining / dt))
            return YCI_FAIL(&s->c, YC_ERROR_CANCELLED, "cancelled by host.progress");
    }
    s->time = start + dt, s->dt = h;
    for (i = 0; i < s->body_count; i++) s->pose[2 * i] = s->body[i].pose = s->pose[2 * i + 1];
    return YC_OK;
}

static void yci_stats_fill(const yc_scene *s, yc_stats *stats) {
    const yci_model *m = s->model;
    int i;
    stats->bytes = s->c.bytes, stats->bytes_peak = s->c.peak;
    for (i = 0; i < s->seam_count; i++) stats->welded += s->welded[i];
    if (!m || !m->has_system) return;
    stats->vertices = m->vertices, stats->full_nodes = m->full, stats->hybrid_nodes = m->hybrid,
    stats->dummy_nodes = m->dummy;
    stats->hybrid_vertices = m->hybrid_vertices, stats->dofs = yci_system_size(&m->system), stats->solver = m->solver;
    stats->body_contacts = m->touch_count, stats->pair_contacts = m->pairs.count;
}

YC_API yc_result yc_scene_step(yc_scene *s, double dt, yc_stats *out) {
    yc_stats stats;
    char *before;
    double clock = yci_seconds();
    yc_result result;
    int events = s->event_count;
    memset(&stats, 0, sizeof stats);
    if (!(dt > 0.0 && dt < 1e6))
        return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "dt = %g must be greater than 0 and below 1e6 s", dt);
    before = (char *)yci_alloc(&s->c, yci_state_size(s, s->nodes, s->visits), 1);
    if (!before) return yci_out_of_memory(&s->c, "the state before the step");
    yci_state_write(s, before);
    result = yci_advance(s, dt, &stats);
    yci_change_settle(s, result != YC_OK);
    if (result != YC_OK) yci_state_read(s, before, 0), s->event_count = events;
    else if (events) {
        s->event_count -= events;
        memmove(s->event, s->event + events, (size_t)s->event_count * sizeof *s->event);
    }
    yci_free(&s->c, before);
    stats.events = result == YC_OK ? s->event_count : 0;
    stats.seconds = yci_seconds() - clock;
    yci_stats_fill(s, &stats);
    if (out) *out = stats;
    return result;
}

/* ---- what can be read ---- */

YC_API yc_result yc_scene_energy(yc_scene *s, double terms[YC_TERM_COUNT]) {
    static const int term_of[] = {YC_TERM_COUNT, YC_TERM_BENDING, YC_TERM_BENDING, YC_TERM_SHEAR, YC_TERM_ADJACENT,
        YC_TERM_FLATTENING, YC_TERM_SLIDE, YC_TERM_WRAP, YC_TERM_STITCH, YC_TERM_MEMBRANE, YC_TERM_HINGE, YC_TERM_SEAM,
        YC_TERM_BODY, YC_TERM_PAIR, YC_TERM_STRETCH, YC_TERM_GRAVITY};
    yci_model *m;
    yc_result result = yci_scene_build(s);
    int i, r, t, kind;
    if (result != YC_OK) return result;
    m = s->model;
    yci_zero(terms, YC_TERM_COUNT);
    yci_keep(s);
    result = yci_search(s);
    if (result != YC_OK) return result;
    yci_masses(s);
    for (kind = YCI_SEGMENT + 1; kind <= YCI_GRAVITY; kind++)
        terms[term_of[kind]] += yci_assemble_kind(s, kind, YCI_ENERGY);
    for (i = 0; i < s->nodes; i++) terms[YC_TERM_GRAVITY] -= m->mass_fixed[i] * yci_dot(s->desc.gravity, s->x + 3 * i);
    yci_dofs_get(s, s->velocity, s->slide, s->rise, m->dof);
    for (i = 0; i < m->system.a.n; i++)
        for (r = 0; r < m->system.a.dim[i]; r++)
            for (t = 0; t < m->system.a.dim[i]; t++)
                terms[YC_TERM_KINETIC] += 0.5 *
                    m->system.mass[m->system.mass_at[i] + (size_t)(r * m->system.a.dim[i] + t)] *
                    m->dof[m->system.a.off[i] + r] * m->dof[m->system.a.off[i] + t];
    return YC_OK;
}

YC_API yc_result yc_scene_momentum(yc_scene *s, double *mass, double linear[3], double angular[3]) {
    yci_model *m;
    yc_result result = yci_scene_build(s);
    double p[3] = {0.0, 0.0, 0.0}, l[3] = {0.0, 0.0, 0.0}, total = 0.0, w[3], arm[3];
    int i;
    if (result != YC_OK) return result;
    m = s->model;
    yci_keep(s);
    yci_masses(s);
    for (i = 0; i < s->nodes; i++) {
        total += m->mass[i];
        yci_axpy(p, m->mass[i], s->velocity + 3 * i);
        yci_cross(arm, s->x + 3 * i, s->velocity + 3 * i);
        yci_axpy(l, m->mass[i], arm);
    }
    for (i = 0; i < m->segment_count; i++) { /* sliding carries mass along the yarn: c = x' - w u' */
        const yci_segment *e = m->segment + i;
        double half = 0.5 * e->density, slide = s->slide[e->a] + s->slide[e->b];
        if (slide == 0.0) continue;
        yci_sub(w, s->x + 3 * s->visit_node[e->b], s->x + 3 * s->visit_node[e->a]);
        yci_axpy(p, -half * slide, w);
        yci_cross(arm, s->x + 3 * s->visit_node[e->a], w);
        yci_axpy(l, -half * s->slide[e->a], arm);
        yci_cross(arm, s->x + 3 * s->visit_node[e->b], w);
        yci_axpy(l, -half * s->slide[e->b], arm);
    }
    if (mass) *mass = total;
    if (linear) yci_copy(linear, p);
    if (angular) yci_copy(angular, l);
    return YC_OK;
}

/* Hybrid yarns hang on the vertices that carry them, p = B v + F x: at equilibrium what is left of their gradient is in
 * the range of B, and a pinned vertex takes its share of it. */
static void yci_pin_force_of_hybrid(const yc_scene *s, int vertex, double *force) {
    const yci_model *m = s->model;
    int i, k, node;
    for (i = 0; i < s->cloth_count && vertex < s->vertices && m->hybrid; i++) {
        const yc_yarns *y = yci_cloth_yarns(s->cloth + i);
        for (node = 0; y && node < y->node_count; node++) {
            int at = m->system_node[s->cloth[i].node + node];
            if (m->role[s->cloth[i].node + node] != YCI_HYBRID || at < 0) continue;
            for (k = 0; k < 3; k++)
                if (s->triangle[3 * (s->cloth[i].triangle + y->triangle[node]) + k] == vertex)
                    yci_axpy(force, y->weights[node][k], m->gradient + m->system.a.off[at]);
        }
    }
}

YC_API yc_result yc_scene_pin_force(const yc_scene *s, int cloth, yc_point kind, int index, double force[3]) {
    yc_scene *scene = (yc_scene *)s; /* only its message may change */
    int node;
    yc_result result = yci_scene_point(scene, cloth, kind, index, &node);
    if (result != YC_OK) return result;
    if (!s->model || !s->pin[node])
        return YCI_FAIL(&scene->c, YC_ERROR_ARGUMENT, "%s %d of cloth %d has not been pinned in a step",
            kind == YC_VERTEX ? "vertex" : "node", index, cloth);
    if (node < s->vertices && s->model->holder[node] >= 0) node = s->model->holder[node];
    yci_zero(force, 3);
    if (s->model->system_node[node] > -2) return YC_OK;
    yci_copy(force, s->model->reaction + 3 * (-2 - s->model->system_node[node]));
    yci_axpy(force, -s->model->mass_fixed[node], s->desc.gravity);
    yci_pin_force_of_hybrid(s, node, force);
    return YC_OK;
}

/* The affine map of the pattern that fits the full yarn nodes around a vertex best, taken at the vertex: where the
 * vertex is seen to be when the triangles have left the mechanics there. sum holds the normal equations of (1, u, v),
 * from node to value. */
typedef struct yci_fit {
    double a[9], b[9];
} yci_fit;

static void yci_fit_add(yci_fit *fit, const double *uv, const double *value) {
    double row[3];
    int i, j;
    row[0] = 1.0, row[1] = uv[0], row[2] = uv[1];
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) fit->a[3 * i + j] += row[i] * row[j], fit->b[3 * i + j] += row[i] * value[j];
}

/* The fit's value at its origin; with too few nodes their mean. */
static int yci_fit_value(const yci_fit *fit, double *out) {
    double inverse[9];
    int k;
    if (fit->a[0] <= 0.0) return 0;
    if (fit->a[0] > 3.5 && yci_block_invert(3, fit->a, fit->a, inverse) > 1e-9)
        for (k = 0; k < 3; k++)
            out[k] = inverse[0] * fit->b[k] + inverse[1] * fit->b[3 + k] + inverse[2] * fit->b[6 + k];
    else yci_scale(out, fit->b, 1.0 / fit->a[0]);
    return 1;
}

/* Values (positions or velocities) of a cloth's vertices. */
static yc_result yci_vertex_values(yc_scene *s, const yci_cloth *cloth, const double *value, double (*out)[3]) {
    const yc_yarns *y = yci_cloth_yarns(cloth);
    yci_fit *fit;
    int i, k;
    for (i = 0; i < cloth->desc.mesh.vertex_count; i++) yci_copy(out[i], value + 3 * s->weld[cloth->vertex + i]);
    if (!y || !y->triangle || !s->model->full) return YC_OK;
    fit = YCI_NEW(&s->c, yci_fit, s->vertices);
    if (!fit) return yci_out_of_memory(&s->c, "vertices under full yarns");
    for (i = 0; i < y->node_count; i++)
        for (k = 0; k < 3; k++) {
            const int *corner = cloth->desc.mesh.uv_triangles[y->triangle[i]];
            int vertex = s->weld[cloth->vertex + cloth->desc.mesh.triangles[y->triangle[i]][k]];
            double uv[2];
            if (s->model->role[vertex] != YCI_IDLE || s->model->role[cloth->node + i] != YCI_FULL) continue;
            uv[0] = y->layout[i][0] - cloth->desc.mesh.uv[corner[k]][0],
            uv[1] = y->layout[i][1] - cloth->desc.mesh.uv[corner[k]][1];
            yci_fit_add(fit + vertex, uv, value + 3 * (cloth->node + i));
        }
    for (i = 0; i < cloth->desc.mesh.vertex_count; i++) {
        int vertex = s->weld[cloth->vertex + i];
        if (!s->pin[vertex]) yci_fit_value(fit + vertex, out[i]);
    }
    yci_free(&s->c, fit);
    return YC_OK;
}

static yc_result yci_point_values(yc_scene *s, int cloth, yc_point kind, const double *value, double (*out)[3]) {
    const yc_yarns *y;
    yc_result result = yci_handle_check(&s->c, "cloth", cloth, s->cloth_count);
    double mean;
    int i, k;
    if (result != YC_OK) return result;
    if (kind != YC_VERTEX && kind != YC_NODE)
        return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "kind = %d is neither YC_VERTEX nor YC_NODE", (int)kind);
    if (!out) return YCI_FAIL(&s->c, YC_ERROR_ARGUMENT, "out is NULL");
    result = yci_scene_build(s);
    if (result != YC_OK) return result;
    if (kind == YC_VERTEX) return yci_vertex_values(s, s->cloth + cloth, value, out);
    y = yci_cloth_yarns(s->cloth + cloth);
    for (i = 0; y && i < y->node_count; i++) {
        int node = s->cloth[cloth].node + i;
        yci_copy(out[i], value + 3 * node);
        if (s->model->role[node] != YCI_IDLE || !y->triangle ||
            yci_cloth_region(s->cloth + cloth, y->triangle[i], &mean) == YCI_FULL)
            continue;
        yci_zero(out[i], 3); /* a dummy node follows the mesh */
        for (k = 0; k < 3; k++)
            yci_axpy(
                out[i], y->weights[i][k], value + 3 * s->triangle[3 * (s->cloth[cloth].triangle + y->triangle[i]) + k]);
    }
    return YC_OK;
}

YC_API yc_result yc_scene_positions(yc_scene *s, int cloth, yc_point kind, double (*out)[3]) {
    return yci_point_values(s, cloth, kind, s->x, out);
}

YC_API yc_result yc_scene_velocities(yc_scene *s, int cloth, yc_point kind, double (*out)[3]) {
    return yci_point_values(s, cloth, kind, s->velocity, out);
}

YC_API yc_result yc_scene_sliding(yc_scene *s, int cloth, double *out) {
    yc_result result = yci_handle_check(&s->c, "cloth", cloth, s->cloth_count);
    if (result != YC_OK) return result;
    if (yci_cloth_yarns(s->cloth + cloth))
        memcpy(out, s->u + s->cloth[cloth].visit, (size_t)s->cloth[cloth].yarns.visit_count * sizeof *out);
    return YC_OK;
}

YC_API yc_result yc_scene_network(const yc_scene *s, int cloth, yc_yarns *out) {
    yci_context *c = &((yc_scene *)s)->c; /* only its message may change */
    yc_result result = yci_handle_check(c, "cloth", cloth, s->cloth_count);
    if (result != YC_OK) return result;
    if (!yci_cloth_yarns(s->cloth + cloth)) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "cloth %d has no yarns", cloth);
    *out = s->cloth[cloth].yarns;
    out->visit_u = s->u + s->cloth[cloth].visit, out->owner = NULL;
    return YC_OK;
}

YC_API yc_result yc_scene_triangles(yc_scene *s, int cloth, int (*out)[3]) {
    yc_result result = yci_handle_check(&s->c, "cloth", cloth, s->cloth_count);
    int i, k;
    if (result != YC_OK) return result;
    for (i = 0; i < s->cloth[cloth].desc.mesh.triangle_count; i++)
        for (k = 0; k < 3; k++) {
            int own = s->cloth[cloth].vertex + s->cloth[cloth].desc.mesh.triangles[i][k],
                welded = s->weld[own] - s->cloth[cloth].vertex;
            out[i][k] = welded >= 0 ? welded : own - s->cloth[cloth].vertex;
        }
    return YC_OK;
}

YC_API yc_result yc_scene_stress(yc_scene *s, int cloth, double *out) {
    yc_result result = yci_handle_check(&s->c, "cloth", cloth, s->cloth_count);
    const yci_model *m;
    double *area;
    int i, k, count;
    if (result == YC_OK) result = yci_scene_build(s);
    if (result != YC_OK) return result;
    m = s->model, count = s->cloth[cloth].desc.mesh.vertex_count;
    area = YCI_NEW(&s->c, double, 2 * (size_t)s->vertices);
    if (!area) return yci_out_of_memory(&s->c, "stress");
    for (i = 0; i < m->face_count; i++) {
        const yci_face *e = m->face + i;
        double q[9], strain[3], stress[3] = {0.0, 0.0, 0.0}, mean, half;
        for (k = 0; k < 3; k++) yci_copy(q + 3 * k, s->x + 3 * e->node[k]);
        yci_triangle_membrane_strain(q, &e->rest, strain);
        yci_triangle_stress(stress, e->material, 1.0, strain);
        mean = 0.5 * (stress[0] + stress[1]), half = 0.5 * (stress[0] - stress[1]);
        for (k = 0; k < 3; k++) {
            area[2 * e->node[k]] += e->rest.area;
            area[2 * e->node[k] + 1] += e->rest.area * (mean + sqrt(half * half + stress[2] * stress[2]));
        }
    }
    for (i = 0; i < count; i++) {
        const double *at = area + 2 * s->weld[s->cloth[cloth].vertex + i];
        out[i] = at[0] > 0.0 ? at[1] / at[0] : 0.0;
    }
    yci_free(&s->c, area);
    return YC_OK;
}

/* ---- rest shape of knits ---- */

/* How much longer what lies along an axis became, by least squares over the nodes in the middle third of a box. */
static double yci_rest_scale(const yc_yarns *y, const double (*x)[3], int axis) {
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, n = 0.0, p = 0.0, q = 0.0, pp = 0.0,
           pq = 0.0;
    int i, k;
    for (i = 0; i < 2 * y->node_count; i++) {
        low[i % 2] = yci_min(low[i % 2], y->layout[i / 2][i % 2]);
        high[i % 2] = yci_max(high[i % 2], y->layout[i / 2][i % 2]);
    }
    for (i = 0; i < y->node_count; i++) {
        int inside = 1;
        for (k = 0; k < 2; k++) inside &= fabs(y->layout[i][k] - 0.5 * (low[k] + high[k])) <= (high[k] - low[k]) / 6.0;
        if (!inside) continue;
        n += 1.0, p += y->layout[i][axis], q += x[i][axis];
        pp += y->layout[i][axis] * y->layout[i][axis], pq += y->layout[i][axis] * x[i][axis];
    }
    return n * pp - p * p > 0.0 ? (n * pq - p * q) / (n * pp - p * p) : 1.0;
}

/* A scene in which a knit settles: yarns are straight at rest and do not wrap, so that everything stays in the plane.
 * *period is about that of a stitch, from its yarn's bending. */
static yc_result yci_rest_scene(
    yci_context *c, const yc_host *host, const yc_yarns *y, double *period, yc_scene **out) {
    yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_yarns plain = *y;
    double length = 2.0 * (y->visit_u[y->visit_count - 1] - y->visit_u[0]) / y->visit_count;
    int i;
    yc_result result;
    plain.materials = YCI_NEW(c, yc_yarn_material, y->material_count);
    if (!plain.materials) return yci_out_of_memory(c, "the rest shape of a knit");
    for (*period = 0.0, i = 0; i < y->material_count; i++) {
        const yc_yarn_material *m = y->materials + i;
        plain.materials[i] = *m, plain.materials[i].wrap = 0.0;
        *period = yci_max(*period, length * length * sqrt(m->density / yci_max(m->bending, 1e-300)));
    }
    plain.visit_turn = NULL;
    yci_zero(settings.gravity, 3);
    settings.dt_max = 10.0 * *period, settings.dt_min = 1e-6 * *period, settings.mass_damping = 0.05 / *period;
    settings.tolerance = 1e-4 * plain.materials[0].radius, settings.newton_limit = 25;
    settings.solver = YC_SOLVER_DIRECT;
    cloth.yarns = &plain, cloth.hold_network = 1;
    result = yc_scene_create(host, &settings, out, c->message);
    if (result == YC_OK) result = yc_scene_add_cloth(*out, &cloth, NULL);
    if (result != YC_OK && *out) yci_say(c, "%s", yc_scene_message(*out));
    yci_free(c, plain.materials);
    return result;
}

/* Makes what was reached the rest. */
static void yci_rest_take(yc_yarns *y, const double (*x)[3]) {
    double q[11] = {0.0}, d[3];
    int yarn, v, k;
    for (k = 0; k < y->node_count; k++) yci_copy(y->layout[k], x[k]);
    for (yarn = 0; yarn < y->yarn_count; yarn++)
        for (v = y->yarn_first[yarn]; v < y->yarn_first[yarn + 1]; v++) {
            int inner = v > y->yarn_first[yarn] && v + 1 < y->yarn_first[yarn + 1];
            if (v > y->yarn_first[yarn]) {
                yci_sub(d, x[y->visit_node[v]], x[y->visit_node[v - 1]]);
                y->visit_u[v] = y->visit_u[v - 1] + yci_norm(d);
            }
            for (k = 0; k < 3 && inner; k++) yci_copy(q + 3 * k, x[y->visit_node[v + k - 1]]);
            y->visit_turn[v] = inner ? yci_yarn_bend_strain(q) : 0.0;
        }
}

YC_API yc_result yc_knit_relax(const yc_host *host, yc_yarns *y, yc_knit_rest *rest, char *message) {
    yci_context c;
    yc_scene *s = NULL;
    yc_stats stats;
    yc_knit_rest out;
    double(*x)[3] = NULL, (*last)[3], period = 0.0, moved = HUGE_VAL;
    yc_result result = yci_context_init(&c, host);
    int i;
    memset(&out, 0, sizeof out), memset(&stats, 0, sizeof stats);
    if (result == YC_OK && !y) result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "yarns must not be NULL");
    if (result == YC_OK) result = yci_yarns_check(&c, y, NULL);
    if (result == YC_OK && (!y->contact_count || !y->visit_turn))
        result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "yarns must be a knit, with visit_turn");
    for (i = 0; result == YC_OK && i < y->node_count; i++)
        if (y->layout[i][2] != 0.0)
            result = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "yarns.layout[%d][2] = %g: only a flat knit settles on a table", i,
                y->layout[i][2]);
    if (result == YC_OK && !(x = (double(*)[3])yci_alloc(&c, 2 * (size_t)y->node_count, sizeof *x)))
        result = yci_out_of_memory(&c, "the rest shape of a knit");
    if (result == YC_OK) result = yci_rest_scene(&c, host, y, &period, &s);
    for (out.steps = 0; result == YC_OK && moved > 1e-2 * y->materials[0].radius && out.steps < 100; out.steps++) {
        last = x + y->node_count, memcpy(last, x, (size_t)y->node_count * sizeof *x);
        result = yc_scene_step(s, 10.0 * period, &stats);
        if (result == YC_OK) result = yc_scene_positions(s, 0, YC_NODE, x);
        if (result != YC_OK) yci_say(&c, "the knit does not settle: %s", yc_scene_message(s));
        for (moved = 0.0, i = 0; i < 3 * y->node_count; i++)
            moved = yci_max(moved, fabs(x[i / 3][i % 3] - last[i / 3][i % 3]));
        out.newton += stats.newton;
    }
    if (result == YC_OK) {
        for (i = 0; i < 2; i++) out.scale[i] = yci_rest_scale(y, (const double(*)[3])x, i);
        yci_rest_take(y, (const double(*)[3])x);
        if (rest) *rest = out;
    }
    yc_scene_destroy(s);
    yci_free(&c, x);
    return yci_report(&c, result, message);
}

/* =====================================================================================================================
 * >>output   (chapter 12)
 *
 * Curves, tubes and a finer mesh, from plain arrays to plain arrays; no scene.
 *
 * Curves. At a crossing the contact plane is the one of both yarns' tangents, a tangent being the bisector of the two
 * unit segments that meet at the node. The plane that fits all four segments best (YARN 3, by SVD) is the same where
 * yarns run smoothly, but at a fold sharper than a right angle its normal jumps to an axis in the cloth; this one,
 * which compression in the mechanics uses too, stays on the bisector. The pattern's layout decides the side, so that
 * yarns may be listed in any direction. Splines are Catmull-Rom with knots at the square roots of the distances
 * (Yuksel et al. 2011), as Hermite cubics: with chords p = b - a and q = c - b over knot intervals r and s the
 * derivative at b is
 *   m = (s/r p + r/s q) / (r + s).
 *
 * Tubes. Frames (t, n, t x n) are carried from point to point by two reflections (Wang et al. 2008, Table I): in the
 * middle plane of both points, then in that of the reflected and the new tangent. Nothing turns about the tangent.
 *
 * Subdivision (Loop 1987). Edge vertices 3/8 (a + b) + 1/8 (c + d), on borders (a + b)/2. Old vertices of valence n
 * (1 - n w) x + w sum, w = (5/8 - (3/8 + cos(2 pi/n)/4)^2)/n, on borders 3/4 x + 1/8 (a + b).
 *
 * Promises: every loop of yci_parallel writes what it owns, no sum crosses a block. Workspace: curves 28 bytes per
 * visit, 8 per node (12 in knits) and 4 per curve; tubes none; subdivision at most 20 bytes per triangle corner and 4
 * per vertex.
 * ===================================================================================================================== */

#define YCI_OUTPUT_GRAIN 64 /* curves or visits in a block of a parallel loop */
#define YCI_OUTPUT_FAR 1e30 /* coordinates beyond this do not fit a float with room to spare */
#define YCI_SIDES_MAX 64

/* The bisector of the directions before -> here and here -> after, not of unit length. An end is given by `here` twice.
 * Where the line turns straight back it is the direction after. */
YC_FN void yci_bisector(const double *before, const double *here, const double *after, double *t) {
    const double zero[3] = {0.0, 0.0, 0.0};
    double previous[3], next[3];
    yci_sub(previous, here, before), yci_normalize(previous, zero);
    yci_sub(next, after, here), yci_normalize(next, zero);
    yci_add(t, previous, next);
    if (yci_norm(t) < 1e-9) yci_copy(t, next);
}

/* Derivative of the spline at b by its knots. A neighbour equal to b has no direction and leaves the other chord's. */
YC_FN void yci_spline_slope(const double *a, const double *b, const double *c, double *m) {
    double p[3], q[3], r, s;
    yci_sub(p, b, a), yci_sub(q, c, b);
    r = sqrt(yci_norm(p)), s = sqrt(yci_norm(q));
    yci_zero(m, 3);
    if (r > 0.0 && s > 0.0) yci_axpy(m, s / (r * (r + s)), p), yci_axpy(m, r / (s * (r + s)), q);
    else if (r > 0.0) yci_axpy(m, 1.0 / r, p);
    else if (s > 0.0) yci_axpy(m, 1.0 / s, q);
}

/* The spline between b and c, whose neighbours are a and d, at the share x of its knot interval. */
YC_FN void yci_spline(const double *a, const double *b, const double *c, const double *d, double x, double *out) {
    double chord[3], begin[3], end[3], interval;
    yci_sub(chord, c, b);
    interval = sqrt(yci_norm(chord));
    yci_spline_slope(a, b, c, begin), yci_spline_slope(b, c, d, end);
    yci_copy(out, b);
    yci_axpy(out, x * x * (3.0 - 2.0 * x), chord);
    yci_axpy(out, x * (1.0 - x) * (1.0 - x) * interval, begin);
    yci_axpy(out, x * x * (x - 1.0) * interval, end);
}

static int yci_output_far(const double *x) {
    return !(fabs(x[0]) <= YCI_OUTPUT_FAR && fabs(x[1]) <= YCI_OUTPUT_FAR && fabs(x[2]) <= YCI_OUTPUT_FAR);
}

static void yci_output_store(float *out, const double *x) {
    out[0] = (float)x[0], out[1] = (float)x[1], out[2] = (float)x[2];
}

/* ---- curves ------------------------------------------------------------------------------------------------------ */

typedef struct yci_curve_work {
    const yc_yarns *yarns;
    const double (*nodes)[3];
    const yc_curve_desc *desc;
    yc_curves *out;
    int (*crossing)[2]; /* [node_count], the visits of a node, each plus one; 0: none */
    int *contact;       /* [node_count], the last stitch contact there plus one; 0: none; NULL: woven */
    int *yarn;          /* [visit_count], whose visit it is */
    double (*point)[3]; /* [visit_count], where the spline passes */
    int *begin;         /* [curve_count], first visit of each curve */
} yci_curve_work;

YC_API yc_curve_desc yc_curve_desc_default(void) {
    yc_curve_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.cookie = YCI_DESC_COOKIE, desc.steps = 4, desc.offset = 1.0;
    return desc;
}

static yc_result yci_curves_check(yci_context *c, const yc_yarns *yarns, const yc_curve_desc *d, const yc_curves *out) {
    yc_result r;
    int i;
    if (!yarns) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "yarns is NULL");
    if (!d) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curve descriptor is NULL");
    if (!out) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "out is NULL");
    if (d->cookie != YCI_DESC_COOKIE)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curve.cookie: not made by yc_curve_desc_default()");
    if (d->steps < 1 || d->steps > 64)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curve.steps = %d must be 1 to 64", d->steps);
    if (!(d->offset >= 0.0 && d->offset <= 10.0))
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curve.offset = %g must be in [0, 10]", d->offset);
    r = yci_yarns_check(c, yarns, NULL);
    for (i = 0; r == YC_OK && i < yarns->material_count; i++)
        if (yarns->materials[i].radius > YCI_OUTPUT_FAR)
            r = YCI_FAIL(
                c, YC_ERROR_ARGUMENT, "yarns.materials[%d].radius = %g is beyond 1e30", i, yarns->materials[i].radius);
    return r;
}

/* Finds the pieces of all yarns. With begin NULL it only counts; otherwise the arrays of out but points are written,
 * and the first visit of each piece. Returns 0 when there are more points than an int counts. */
static int yci_curves_cut(const yc_yarns *y, const yc_curve_desc *d, yc_curves *out, int *begin) {
    int yarn, v, from;
    out->curve_count = out->point_count = 0;
    for (yarn = 0; yarn < y->yarn_count; yarn++)
        for (v = y->yarn_first[yarn]; v < y->yarn_first[yarn + 1]; v++) {
            from = v;
            while (v < y->yarn_first[yarn + 1] && !(d->skip && d->skip[y->visit_node[v]])) v++;
            if (v - from < 2) continue;
            if (v - from - 1 > (INT_MAX - 1 - out->point_count) / d->steps) return 0;
            if (begin) {
                out->first[out->curve_count] = out->point_count, begin[out->curve_count] = from;
                out->radius[out->curve_count] = (float)y->materials[y->yarn_material[yarn]].radius;
                out->yarn[out->curve_count] = yarn;
            }
            out->curve_count++, out->point_count += (v - from - 1) * d->steps + 1;
        }
    if (begin) out->first[out->curve_count] = out->point_count;
    return 1;
}

/* The yarn's bisector at a visit, in space or in the layout. */
static void yci_curve_tangent(const yci_curve_work *w, const double (*x)[3], int visit, double *t) {
    const yc_yarns *y = w->yarns;
    const int *first = y->yarn_first + w->yarn[visit];
    int before = visit > first[0] ? visit - 1 : visit, after = visit + 1 < first[1] ? visit + 1 : visit;
    yci_bisector(x[y->visit_node[before]], x[y->visit_node[visit]], x[y->visit_node[after]], t);
}

/* The normal of the contact plane, on the side of u x v; zero where both yarns run the same way. */
static void yci_curve_normal(const yci_curve_work *w, int a, int b, double *n) {
    const double zero[3] = {0.0, 0.0, 0.0};
    const double(*layout)[3] = (const double(*)[3])w->yarns->layout;
    double s[3], t[3];
    yci_curve_tangent(w, layout, a, s), yci_curve_tangent(w, layout, b, t);
    yci_cross(n, s, t);
    if (n[2] < 0.0) {
        int swap = a;
        a = b, b = swap;
    }
    yci_curve_tangent(w, w->nodes, a, s), yci_curve_tangent(w, w->nodes, b, t);
    yci_cross(n, s, t), yci_normalize(n, zero);
}

/* The normal of a stitch contact's plane, towards the side of layer +1: where the new loop lies before the old one at
 * B, that is the knit side. Followed from A to B, the old yarn turns to the right of the new one at B and to the left
 * of it at A where the contact is the left one of a knit. */
static void yci_curve_contact(const yci_curve_work *w, const yc_stitch_contact *s, double *n) {
    const double zero[3] = {0.0, 0.0, 0.0};
    const signed char *layer = w->yarns->visit_layer;
    double t[2][3], at[2][3];
    int yarn, end, left = (s->sign > 0) == (layer[s->visit[1][1]] > layer[s->visit[0][1]]);
    for (end = 0; end < 2; end++) {
        for (yarn = 0; yarn < 2; yarn++) {
            yci_curve_tangent(w, w->nodes, s->visit[yarn][end], t[yarn]), yci_normalize(t[yarn], zero);
            if (s->visit[yarn][1] < s->visit[yarn][0]) yci_scale(t[yarn], t[yarn], -1.0);
        }
        yci_cross(at[end], t[0], t[1]);
    }
    yci_sub(n, at[1], at[0]), yci_normalize(n, zero);
    if (!left) yci_scale(n, n, -1.0);
}

static void yci_curve_offset(void *arg, int begin, int end) {
    const yci_curve_work *w = (const yci_curve_work *)arg;
    const yc_yarns *y = w->yarns;
    int v;
    for (v = begin; v < end; v++) {
        int a = w->crossing[y->visit_node[v]][0] - 1, b = w->crossing[y->visit_node[v]][1] - 1;
        double n[3], sum;
        yci_copy(w->point[v], w->nodes[y->visit_node[v]]);
        if (b < 0 || y->yarn_family[w->yarn[a]] == YC_ROD || y->yarn_family[w->yarn[b]] == YC_ROD) continue;
        sum = y->materials[y->yarn_material[w->yarn[a]]].radius + y->materials[y->yarn_material[w->yarn[b]]].radius;
        if (w->contact && w->contact[y->visit_node[v]])
            yci_curve_contact(w, &y->contacts[w->contact[y->visit_node[v]] - 1], n);
        else yci_curve_normal(w, a, b, n);
        yci_axpy(w->point[v], 0.5 * sum * w->desc->offset * y->visit_layer[v], n);
    }
}

/* A piece takes its directions from the whole yarn, also beyond its ends. */
static void yci_curve_draw(void *arg, int begin, int end) {
    const yci_curve_work *w = (const yci_curve_work *)arg;
    int curve, i, steps = w->desc->steps;
    for (curve = begin; curve < end; curve++) {
        const int *first = w->yarns->yarn_first + w->out->yarn[curve];
        int last = w->out->first[curve + 1] - 1;
        for (i = w->out->first[curve]; i < last; i++) {
            int v = w->begin[curve] + (i - w->out->first[curve]) / steps;
            int before = v > first[0] ? v - 1 : v, after = v + 2 < first[1] ? v + 2 : v + 1;
            double x[3], share = (double)((i - w->out->first[curve]) % steps) / steps;
            yci_spline(w->point[before], w->point[v], w->point[v + 1], w->point[after], share, x);
            yci_output_store(w->out->points[i], x);
        }
        yci_output_store(w->out->points[last], w->point[w->begin[curve] + (last - w->out->first[curve]) / steps]);
    }
}

static yc_result yci_curves_fill(yci_context *c, yci_curve_work *w) {
    const yc_yarns *y = w->yarns;
    yc_result r = YC_OK;
    int yarn, v, i;
    for (i = 0; i < y->node_count; i++)
        if (yci_output_far(w->nodes[i]))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "nodes[%d] = (%g, %g, %g) is not finite or beyond 1e30", i,
                w->nodes[i][0], w->nodes[i][1], w->nodes[i][2]);
    w->crossing = (int(*)[2])yci_alloc(c, (size_t)y->node_count, sizeof *w->crossing);
    w->point = (double(*)[3])yci_alloc(c, (size_t)y->visit_count, sizeof *w->point);
    w->yarn = YCI_NEW(c, int, y->visit_count);
    w->begin = YCI_NEW(c, int, w->out->curve_count);
    if (y->contact_count) w->contact = YCI_NEW(c, int, y->node_count);
    if (!w->crossing || !w->point || !w->yarn || !w->begin || (y->contact_count && !w->contact))
        r = yci_out_of_memory(c, "the curves");
    for (i = 0; r == YC_OK && i < y->contact_count; i++)
        for (v = 0; v < 2; v++) w->contact[y->visit_node[y->contacts[i].visit[0][v]]] = i + 1;
    if (r == YC_OK) {
        for (yarn = 0; yarn < y->yarn_count; yarn++)
            for (v = y->yarn_first[yarn]; v < y->yarn_first[yarn + 1]; v++) {
                int *crossing = w->crossing[y->visit_node[v]];
                crossing[crossing[0] != 0] = v + 1, w->yarn[v] = yarn;
            }
        yci_curves_cut(y, w->desc, w->out, w->begin);
        yci_parallel(c, y->visit_count, YCI_OUTPUT_GRAIN, yci_curve_offset, w);
        yci_parallel(c, w->out->curve_count, YCI_OUTPUT_GRAIN, yci_curve_draw, w);
    }
    yci_free(c, w->crossing), yci_free(c, w->point), yci_free(c, w->yarn), yci_free(c, w->begin);
    yci_free(c, w->contact);
    return r;
}

YC_API yc_result yc_curves_make(const yc_host *host, const yc_yarns *yarns, const double (*nodes)[3],
    const yc_curve_desc *desc, yc_curves *out, char *message) {
    yci_context c;
    yci_curve_work work;
    yc_curves counts;
    yc_result r = yci_context_init(&c, host);
    memset(&work, 0, sizeof work), memset(&counts, 0, sizeof counts);
    if (r == YC_OK) r = yci_curves_check(&c, yarns, desc, out);
    if (r == YC_OK && !yci_curves_cut(yarns, desc, &counts, NULL))
        r = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "curve.steps = %d makes more than %d points", desc->steps, INT_MAX);
    if (r == YC_OK && !out->first && !out->points && !out->radius && !out->yarn) *out = counts;
    else if (r == YC_OK && (!out->first || (counts.curve_count && (!out->points || !out->radius || !out->yarn))))
        r = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "curves: either all arrays are NULL, or none");
    else if (r == YC_OK && (out->curve_count != counts.curve_count || out->point_count != counts.point_count))
        r = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "curves has room for %d curves and %d points, not %d and %d",
            out->curve_count, out->point_count, counts.curve_count, counts.point_count);
    else if (r == YC_OK && !nodes) r = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "nodes is NULL");
    else if (r == YC_OK) {
        work.yarns = yarns, work.nodes = nodes, work.desc = desc, work.out = out;
        r = yci_curves_fill(&c, &work);
    }
    return yci_report(&c, r, message);
}

/* ---- tubes ------------------------------------------------------------------------------------------------------- */

typedef struct yci_tube_work {
    const yc_curves *curves;
    yc_tubes *out;
    int sides;
    double turn[YCI_SIDES_MAX][2]; /* cosine and sine of each side's angle */
} yci_tube_work;

static void yci_tube_point(const yc_curves *u, int i, double *x) {
    x[0] = (double)u->points[i][0], x[1] = (double)u->points[i][1], x[2] = (double)u->points[i][2];
}

/* Checks the curves and counts, or says why not. */
static yc_result yci_tubes_check(yci_context *c, const yc_curves *u, int sides, const yc_tubes *out, yc_tubes *counts) {
    double triangles;
    int i;
    if (!u) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curves is NULL");
    if (!out) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "out is NULL");
    if (sides < 3 || sides > YCI_SIDES_MAX)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "sides = %d must be 3 to %d", sides, YCI_SIDES_MAX);
    if (u->curve_count < 0) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curves.curve_count = %d", u->curve_count);
    if (!u->curve_count) return YC_OK;
    if (!u->first || !u->points || !u->radius)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curves.first, points or radius is NULL");
    for (i = 0; i < u->curve_count; i++)
        if (u->first[i] < 0 || u->first[i + 1] <= u->first[i] || u->first[i + 1] - u->first[i] < 2)
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curves.first[%d] = %d, then %d: each curve needs two points", i,
                u->first[i], u->first[i + 1]);
    if (u->first[0] != 0 || u->first[u->curve_count] != u->point_count)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curves.first runs from %d to %d, not from 0 to %d points", u->first[0],
            u->first[u->curve_count], u->point_count);
    for (i = 0; i < u->curve_count; i++)
        if (!(u->radius[i] > 0.0f && (double)u->radius[i] <= YCI_OUTPUT_FAR))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curves.radius[%d] = %g must be > 0", i, (double)u->radius[i]);
    for (i = 0; i < u->point_count; i++) {
        double x[3];
        yci_tube_point(u, i, x);
        if (yci_output_far(x))
            return YCI_FAIL(c, YC_ERROR_ARGUMENT, "curves.points[%d] = (%g, %g, %g) is not finite or beyond 1e30", i,
                x[0], x[1], x[2]);
    }
    triangles = 2.0 * sides * u->point_count;
    if (triangles > (double)INT_MAX)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "%d points with %d sides make too many triangles", u->point_count, sides);
    counts->triangle_count = (int)triangles, counts->vertex_count = sides * u->point_count + 2 * u->curve_count;
    return YC_OK;
}

/* The unit tangent at a point of a curve; where the neighbours fall on it, what t was before. */
static void yci_tube_tangent(const yc_curves *u, int curve, int i, double *t) {
    double before[3], here[3], after[3], old[3];
    yci_tube_point(u, i > u->first[curve] ? i - 1 : i, before);
    yci_tube_point(u, i, here);
    yci_tube_point(u, i + 1 < u->first[curve + 1] ? i + 1 : i, after);
    yci_copy(old, t);
    yci_bisector(before, here, after, t);
    yci_normalize(t, old);
}

/* Reflects a in the plane normal to v; does nothing where v is too short to have one. */
YC_FN void yci_reflect(double *a, const double *v) {
    double square = yci_dot(v, v);
    if (square > 1e-290) yci_axpy(a, -2.0 * yci_dot(v, a) / square, v);
}

/* Carries n, perpendicular to the unit tangent t, over a step along the curve to the unit tangent t_next. */
YC_FN void yci_frame_carry(const double *t, const double *step, const double *t_next, double *n) {
    double turned[3], across[3];
    yci_copy(turned, t);
    yci_reflect(n, step), yci_reflect(turned, step);
    yci_sub(across, t_next, turned);
    yci_reflect(n, across);
    yci_axpy(n, -yci_dot(n, t_next), t_next); /* rounding */
    yci_perpendicular(across, t_next);
    yci_normalize(n, across);
}

static void yci_tube_triangle(yc_tubes *out, int index, int a, int b, int c) {
    out->triangles[index][0] = a, out->triangles[index][1] = b, out->triangles[index][2] = c;
}

static void yci_tube_ring(
    const yci_tube_work *w, int vertex, const double *x, double radius, const double *t, const double *n) {
    double b[3], d[3], p[3];
    int j;
    yci_cross(b, t, n);
    for (j = 0; j < w->sides; j++) {
        yci_scale(d, n, w->turn[j][0]), yci_axpy(d, w->turn[j][1], b);
        yci_copy(p, x), yci_axpy(p, radius, d);
        yci_output_store(w->out->positions[vertex + j], p), yci_output_store(w->out->normals[vertex + j], d);
    }
}

/* The middle of a cap and its fan over the ring; sign -1 at the curve's beginning, 1 at its end. */
static void yci_tube_cap(
    const yci_tube_work *w, int middle, int ring, int triangle, const double *x, const double *t, double sign) {
    double d[3];
    int j;
    yci_scale(d, t, sign);
    yci_output_store(w->out->positions[middle], x), yci_output_store(w->out->normals[middle], d);
    for (j = 0; j < w->sides; j++) {
        int a = ring + j, b = ring + (j + 1) % w->sides;
        yci_tube_triangle(w->out, triangle + j, middle, sign < 0.0 ? b : a, sign < 0.0 ? a : b);
    }
}

static void yci_tube_sweep(void *arg, int begin, int end) {
    const yci_tube_work *w = (const yci_tube_work *)arg;
    const yc_curves *u = w->curves;
    int curve, i, j, sides = w->sides;
    for (curve = begin; curve < end; curve++) {
        double x[3], t[3] = {1.0, 0.0, 0.0}, n[3], last[3], t_last[3], step[3];
        int ring = sides * u->first[curve] + 2 * curve, triangle = 2 * sides * u->first[curve];
        int middle = sides * u->first[curve + 1] + 2 * curve;
        yci_tube_point(u, u->first[curve], x), yci_tube_tangent(u, curve, u->first[curve], t);
        yci_perpendicular(n, t);
        yci_tube_ring(w, ring, x, (double)u->radius[curve], t, n);
        yci_tube_cap(w, middle, ring, triangle, x, t, -1.0), triangle += sides;
        for (i = u->first[curve] + 1; i < u->first[curve + 1]; i++, ring += sides) {
            yci_copy(last, x), yci_copy(t_last, t);
            yci_tube_point(u, i, x), yci_tube_tangent(u, curve, i, t);
            yci_sub(step, x, last), yci_frame_carry(t_last, step, t, n);
            yci_tube_ring(w, ring + sides, x, (double)u->radius[curve], t, n);
            for (j = 0; j < sides; j++, triangle += 2) {
                int next = (j + 1) % sides;
                yci_tube_triangle(w->out, triangle, ring + j, ring + next, ring + sides + next);
                yci_tube_triangle(w->out, triangle + 1, ring + j, ring + sides + next, ring + sides + j);
            }
        }
        yci_tube_cap(w, middle + 1, ring, triangle, x, t, 1.0);
    }
}

YC_API yc_result yc_tubes_make(const yc_host *host, const yc_curves *curves, int sides, yc_tubes *out, char *message) {
    yci_context c;
    yci_tube_work work;
    yc_tubes counts;
    int j;
    yc_result r = yci_context_init(&c, host);
    memset(&counts, 0, sizeof counts);
    if (r == YC_OK) r = yci_tubes_check(&c, curves, sides, out, &counts);
    if (r == YC_OK && !out->positions && !out->normals && !out->triangles) *out = counts;
    else if (r == YC_OK && (!out->positions || !out->normals || !out->triangles))
        r = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "tubes: either all arrays are NULL, or none");
    else if (r == YC_OK && (out->vertex_count != counts.vertex_count || out->triangle_count != counts.triangle_count))
        r = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "tubes has room for %d vertices and %d triangles, not %d and %d",
            out->vertex_count, out->triangle_count, counts.vertex_count, counts.triangle_count);
    else if (r == YC_OK) {
        work.curves = curves, work.out = out, work.sides = sides;
        for (j = 0; j < sides; j++)
            work.turn[j][0] = cos(2.0 * YCI_PI * j / sides), work.turn[j][1] = sin(2.0 * YCI_PI * j / sides);
        yci_parallel(&c, curves->curve_count, YCI_OUTPUT_GRAIN, yci_tube_sweep, &work);
    }
    return yci_report(&c, r, message);
}

/* ---- finer mesh -------------------------------------------------------------------------------------------------- */

/* The edges of a mesh by their half-edges: the second is -1 on a border. */
typedef struct yci_finer {
    const int (*triangles)[3];
    int vertex_count, triangle_count, edge_count;
    int (*half)[2]; /* [edge_count] */
    int *edge;      /* [3 triangle_count], of each half-edge */
} yci_finer;

static void yci_finer_free(yci_context *c, yci_finer *m) { yci_free(c, m->half), yci_free(c, m->edge); }

static yc_result yci_finer_number(yci_context *c, const int *order, yci_finer *m) {
    int k, total = 3 * m->triangle_count, uses = 0;
    for (k = 0; k < total; k++) {
        uses = k && yci_half_same_edge(m->triangles, order[k - 1], order[k]) ? uses + 1 : 0;
        if (uses > 1)
            return YCI_FAIL(c, YC_ERROR_TOPOLOGY, "triangles[%d], [%d] and [%d] share the edge of vertices %d and %d",
                order[k - 2] / 3, order[k - 1] / 3, order[k] / 3, yci_half_key(m->triangles, order[k], 0),
                yci_half_key(m->triangles, order[k], 1));
        if (!uses) m->half[m->edge_count++][1] = -1;
        m->half[m->edge_count - 1][uses] = order[k], m->edge[order[k]] = m->edge_count - 1;
    }
    return YC_OK;
}

static yc_result yci_finer_make(yci_context *c, yci_finer *m) {
    yc_mesh mesh;
    yc_result r = YC_OK;
    int *order;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertex_count = m->vertex_count, mesh.triangle_count = m->triangle_count, mesh.triangles = m->triangles;
    order = yci_half_order(c, &mesh);
    m->half = (int(*)[2])yci_alloc(c, 3 * (size_t)m->triangle_count, sizeof *m->half);
    m->edge = YCI_NEW(c, int, 3 * (size_t)m->triangle_count);
    if (!order || !m->half || !m->edge) r = yci_out_of_memory(c, "the edges of a mesh");
    else r = yci_finer_number(c, order, m);
    yci_free(c, order);
    return r;
}

static yc_result yci_finer_check(yci_context *c, const yci_finer *m, const yc_fine *out) {
    int t, k;
    if (!out) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "out is NULL");
    if (m->triangle_count < 0 || m->triangle_count > INT_MAX / 12)
        return YCI_FAIL(
            c, YC_ERROR_ARGUMENT, "triangle_count = %d must lie in 0 .. %d", m->triangle_count, INT_MAX / 12);
    if (m->vertex_count < 0 || m->vertex_count > INT_MAX / 2)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "vertex_count = %d must lie in 0 .. %d", m->vertex_count, INT_MAX / 2);
    if (m->triangle_count && !m->triangles) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "triangles is NULL");
    for (t = 0; t < m->triangle_count; t++) {
        const int *v = m->triangles[t];
        for (k = 0; k < 3; k++)
            if (v[k] < 0 || v[k] >= m->vertex_count)
                return YCI_FAIL(c, YC_ERROR_ARGUMENT, "triangles[%d][%d] = %d must lie in 0 .. %d", t, k, v[k],
                    m->vertex_count - 1);
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
            return YCI_FAIL(
                c, YC_ERROR_TOPOLOGY, "triangles[%d] = %d %d %d: a vertex occurs twice", t, v[0], v[1], v[2]);
    }
    return YC_OK;
}

/* What the old vertices need: the sum of their neighbours and the number of them. On a border only those along it
 * count, and the number is negative. */
static void yci_finer_sums(const yci_finer *m, const double (*x)[3], double (*sum)[3], int *valence) {
    int i, k;
    for (i = 0; i < m->vertex_count; i++) yci_zero(sum[i], 3);
    for (i = 0; i < m->edge_count; i++)
        if (m->half[i][1] < 0)
            valence[yci_half_from(m->triangles, m->half[i][0])]--, valence[yci_half_to(m->triangles, m->half[i][0])]--;
    for (i = 0; i < m->edge_count; i++)
        for (k = 0; k < 2; k++) {
            int v = yci_half_key(m->triangles, m->half[i][0], k);
            if (valence[v] < 0 && m->half[i][1] >= 0) continue;
            yci_axpy(sum[v], 1.0, x[yci_half_key(m->triangles, m->half[i][0], !k)]);
            if (valence[v] >= 0) valence[v]++;
        }
}

/* On entry the first vertex_count positions are the sums. */
static void yci_finer_positions(const yci_finer *m, const double (*x)[3], const int *valence, double (*out)[3]) {
    int i, k;
    for (i = 0; i < m->vertex_count; i++) {
        double share = 0.0, root; /* of the neighbours together */
        int n = valence[i];
        if (n > 0) root = 0.375 + 0.25 * cos(2.0 * YCI_PI / n), share = 0.625 - root * root;
        else if (n == -2) share = 0.25;
        yci_scale(out[i], out[i], n ? share / abs(n) : 0.0);
        yci_axpy(out[i], 1.0 - share, x[i]);
    }
    for (i = 0; i < m->edge_count; i++) {
        double *edge = out[m->vertex_count + i];
        int border = m->half[i][1] < 0;
        yci_add(edge, x[yci_half_from(m->triangles, m->half[i][0])], x[yci_half_to(m->triangles, m->half[i][0])]);
        yci_scale(edge, edge, border ? 0.5 : 0.375);
        for (k = 0; k < 2 && !border; k++)
            yci_axpy(edge, 0.125, x[yci_half_from(m->triangles, yci_half_next(yci_half_next(m->half[i][k])))]);
    }
}

static void yci_finer_triangles(const yci_finer *m, int (*out)[3]) {
    int t, k;
    for (t = 0; t < m->triangle_count; t++)
        for (k = 0; k < 3; k++) {
            int *corner = out[4 * t + k];
            out[4 * t + 3][k] = m->vertex_count + m->edge[3 * t + k];
            corner[k] = m->triangles[t][k];
            corner[(k + 1) % 3] = m->vertex_count + m->edge[3 * t + k];
            corner[(k + 2) % 3] = m->vertex_count + m->edge[3 * t + (k + 2) % 3];
        }
}

/* Counts, or fills, as `out` asks for. */
static yc_result yci_finer_run(yci_context *c, const yci_finer *m, const double (*positions)[3], yc_fine *out) {
    int vertices = m->vertex_count + m->edge_count, triangles = 4 * m->triangle_count, *valence;
    if (!out->positions && !out->triangles) {
        out->vertex_count = vertices, out->triangle_count = triangles;
        return YC_OK;
    }
    if ((vertices && !out->positions) || (triangles && !out->triangles))
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "fine: either both arrays are NULL, or none");
    if (out->vertex_count != vertices || out->triangle_count != triangles)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "fine has room for %d vertices and %d triangles, not %d and %d",
            out->vertex_count, out->triangle_count, vertices, triangles);
    if (vertices && !positions) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "positions is NULL");
    valence = YCI_NEW(c, int, m->vertex_count);
    if (!valence) return yci_out_of_memory(c, "the valences of a mesh");
    yci_finer_sums(m, positions, out->positions, valence);
    yci_finer_positions(m, positions, valence, out->positions);
    yci_finer_triangles(m, out->triangles);
    yci_free(c, valence);
    return YC_OK;
}

YC_API yc_result yc_subdivide(const yc_host *host, const double (*positions)[3], int vertex_count,
    const int (*triangles)[3], int triangle_count, yc_fine *out, char *message) {
    yci_context c;
    yci_finer mesh;
    yc_result r = yci_context_init(&c, host);
    memset(&mesh, 0, sizeof mesh);
    mesh.vertex_count = vertex_count, mesh.triangles = triangles, mesh.triangle_count = triangle_count;
    if (r == YC_OK) r = yci_finer_check(&c, &mesh, out);
    if (r == YC_OK) r = yci_finer_make(&c, &mesh);
    if (r == YC_OK) r = yci_finer_run(&c, &mesh, positions, out);
    yci_finer_free(&c, &mesh);
    return yci_report(&c, r, message);
}

/* The small triangle at corner k has the points whose weight there is a half or more: with b_k its weight at k, the
 * corner's is 2 b_k - 1 and those of the two edge vertices 2 b of the others. Between the edges, the small triangle's
 * vertex k is the middle of corners k and k + 1, which is opposite corner k + 2: its weight is 1 - 2 b_(k + 2). */
YC_API void yc_fine_locate(int *triangle, double weights[3]) {
    double b[3];
    int k, corner = 0;
    yci_copy(b, weights);
    for (k = 1; k < 3; k++)
        if (b[k] > b[corner]) corner = k;
    if (b[corner] < 0.5) corner = 3;
    for (k = 0; k < 3; k++)
        weights[k] = corner == 3 ? 1.0 - 2.0 * b[(k + 2) % 3] : 2.0 * b[k] - (k == corner ? 1.0 : 0.0);
    *triangle = 4 * *triangle + corner;
}

YC_API void yc_vertex_normals(const double (*positions)[3], int vertex_count, const int (*triangles)[3],
    int triangle_count, float (*normals)[3]) {
    const double zero[3] = {0.0, 0.0, 0.0};
    double a[3], b[3], n[3];
    int i, k;
    for (i = 0; i < vertex_count; i++) yci_output_store(normals[i], zero);
    for (i = 0; i < triangle_count; i++) {
        const int *v = triangles[i];
        yci_sub(a, positions[v[1]], positions[v[0]]), yci_sub(b, positions[v[2]], positions[v[0]]);
        yci_cross(n, a, b);
        for (k = 0; k < 9; k++) normals[v[k / 3]][k % 3] += (float)n[k % 3];
    }
    for (i = 0; i < vertex_count; i++) {
        for (k = 0; k < 3; k++) n[k] = (double)normals[i][k];
        yci_normalize(n, zero), yci_output_store(normals[i], n);
    }
}

/* =====================================================================================================================
 * >>region   (chapter 14)
 *
 * Where yarns go: the vertices within a distance of one, along the mesh's edges, by Dijkstra's algorithm with a binary
 * heap; it ends at the radius. An edge is as long as in the pattern, since positions may be stretched or draped
 * already; one that two pattern pieces share counts with the shorter of its two lengths. Distances up to 1e-9 of the
 * radius beyond it still count as within, so that rounding does not fray the rim of a region on a regular mesh.
 *
 * Workspace: 20 bytes per vertex, 12 per triangle.
 * ===================================================================================================================== */

typedef struct yci_region {
    int *first;       /* [vertex_count + 1] into corner */
    int *corner;      /* [3 triangle_count], corners 3 t + k by their vertex */
    double *distance; /* [vertex_count], m, by vertex */
    int *heap;        /* [vertex_count], vertices; none lies nearer than the one at half its index */
    int *place;       /* [vertex_count], 0: not seen yet; 1 + where in the heap; -1: done */
    int heap_count;
} yci_region;

static void yci_region_put(yci_region *g, int at, int vertex) { g->heap[at] = vertex, g->place[vertex] = at + 1; }

/* A shorter way to a vertex, or the first. */
static void yci_region_reach(yci_region *g, int vertex, double distance) {
    int at = g->place[vertex] - 1;
    if (at < -1 || (at >= 0 && distance >= g->distance[vertex])) return;
    g->distance[vertex] = distance;
    if (at < 0) at = g->heap_count++;
    for (; at > 0 && g->distance[g->heap[(at - 1) / 2]] > distance; at = (at - 1) / 2)
        yci_region_put(g, at, g->heap[(at - 1) / 2]);
    yci_region_put(g, at, vertex);
}

/* Takes the nearest vertex out of the heap, for good. */
static int yci_region_nearest(yci_region *g) {
    int nearest = g->heap[0], last = g->heap[--g->heap_count], at = 0, child;
    for (child = 1; child < g->heap_count; child = 2 * at + 1) {
        if (child + 1 < g->heap_count && g->distance[g->heap[child + 1]] < g->distance[g->heap[child]]) child++;
        if (g->distance[g->heap[child]] >= g->distance[last]) break;
        yci_region_put(g, at, g->heap[child]);
        at = child;
    }
    yci_region_put(g, at, last);
    g->place[nearest] = -1;
    return nearest;
}

/* The corners of each vertex; place serves as the cursor and is zero again at the end. */
static void yci_region_corners(const yc_mesh *mesh, yci_region *g) {
    int i, v;
    for (i = 0; i < 3 * mesh->triangle_count; i++) g->first[mesh->triangles[i / 3][i % 3] + 1]++;
    for (v = 0; v < mesh->vertex_count; v++) g->first[v + 1] += g->first[v];
    for (i = 0; i < 3 * mesh->triangle_count; i++) {
        v = mesh->triangles[i / 3][i % 3];
        g->corner[g->first[v] + g->place[v]++] = i;
    }
    memset(g->place, 0, (size_t)mesh->vertex_count * sizeof *g->place);
}

static void yci_region_walk(const yc_mesh *mesh, int center, double radius, yci_region *g, double *alpha) {
    const int(*uv_triangles)[3] = mesh->uv_triangles ? mesh->uv_triangles : mesh->triangles;
    int i, k;
    memset(alpha, 0, (size_t)mesh->vertex_count * sizeof *alpha);
    yci_region_reach(g, center, 0.0);
    while (g->heap_count && g->distance[g->heap[0]] <= radius) {
        int v = yci_region_nearest(g);
        alpha[v] = 1.0;
        for (i = g->first[v]; i < g->first[v + 1]; i++)
            for (k = 1; k < 3; k++) {
                int t = g->corner[i] / 3, here = g->corner[i] % 3, there = (here + k) % 3;
                const double *a = mesh->uv[uv_triangles[t][here]], *b = mesh->uv[uv_triangles[t][there]];
                double edge[3] = {0.0, 0.0, 0.0};
                edge[0] = b[0] - a[0], edge[1] = b[1] - a[1];
                yci_region_reach(g, mesh->triangles[t][there], g->distance[v] + yci_norm(edge));
            }
    }
}

/* Checks all but the mesh, and picks the center. */
static yc_result yci_region_center(yci_context *c, const yc_mesh *mesh, const double *score, int center, double radius,
    const double *alpha, int *chosen) {
    int v;
    if (!alpha) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "alpha is NULL");
    if (!(radius >= 0.0) || !yci_finite(radius))
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "radius = %g must be at least 0", radius);
    if (center < -1 || center >= mesh->vertex_count)
        return YCI_FAIL(c, YC_ERROR_ARGUMENT, "center = %d, of %d vertices", center, mesh->vertex_count);
    if (center < 0 && !score) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "center = -1 needs a score");
    *chosen = center < 0 ? 0 : center;
    for (v = 0; center < 0 && v < mesh->vertex_count; v++) {
        if (!yci_finite(score[v])) return YCI_FAIL(c, YC_ERROR_ARGUMENT, "score[%d] = %g is not finite", v, score[v]);
        if (score[v] > score[*chosen]) *chosen = v;
    }
    return YC_OK;
}

YC_API yc_result yc_region_select(const yc_host *host, const yc_mesh *mesh, const double *score, int center,
    double radius, double *alpha, int *chosen, char *message) {
    yci_context c;
    yci_region g;
    int start = 0;
    yc_result r = yci_context_init(&c, host);
    memset(&g, 0, sizeof g);
    if (r == YC_OK && !mesh) r = YCI_FAIL(&c, YC_ERROR_ARGUMENT, "mesh is NULL");
    if (r == YC_OK) r = yci_mesh_check(&c, mesh);
    if (r == YC_OK) r = yci_region_center(&c, mesh, score, center, radius, alpha, &start);
    if (r == YC_OK) {
        g.first = YCI_NEW(&c, int, (size_t)mesh->vertex_count + 1);
        g.corner = YCI_NEW(&c, int, 3 * (size_t)mesh->triangle_count);
        g.distance = YCI_NEW(&c, double, mesh->vertex_count);
        g.heap = YCI_NEW(&c, int, mesh->vertex_count);
        g.place = YCI_NEW(&c, int, mesh->vertex_count);
        if (!g.first || !g.corner || !g.distance || !g.heap || !g.place) r = yci_out_of_memory(&c, "the region");
    }
    if (r == YC_OK) {
        yci_region_corners(mesh, &g);
        yci_region_walk(mesh, start, radius * (1.0 + 1e-9), &g, alpha);
        if (chosen) *chosen = start;
    }
    yci_free(&c, g.first), yci_free(&c, g.corner), yci_free(&c, g.distance), yci_free(&c, g.heap),
        yci_free(&c, g.place);
    return yci_report(&c, r, message);
}

#endif /* YARNCLOTH_IMPLEMENTATION */

/*
 * LICENSE. This file is available under two licenses: choose the one you prefer.
 *
 * A. MIT License. Copyright (c) 2026 the yarncloth authors
 * Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated
 * documentation files (the "Software"), to deal in the Software without restriction, including without limitation the
 * rights to use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of the Software, and to
 * permit persons to whom the Software is furnished to do so, subject to the following conditions: The above copyright
 * notice and this permission notice shall be included in all copies or substantial portions of the Software. THE
 * SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE
 * WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR
 * COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR
 * OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE.
 *
 * B. Public domain (www.unlicense.org). This is free and unencumbered software released into the public domain. Anyone
 * is free to copy, modify, publish, use, compile, sell, or distribute this software, either in source code form or as a
 * compiled binary, for any purpose, commercial or non-commercial, and by any means. In jurisdictions that recognize
 * copyright laws, the author or authors of this software dedicate any and all copyright interest in the software to the
 * public domain. We make this dedication for the benefit of the public at large and to the detriment of our heirs and
 * successors. We intend this dedication to be an overt act of relinquishment in perpetuity of all present and future
 * rights to this software under copyright law. THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS
 * OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND
 * NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN
 * ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER
 * DEALINGS IN THE SOFTWARE.
 */
