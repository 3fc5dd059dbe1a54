/* Reference scenes: cloths and whole scenes that tests, benchmarks and examples share, so that one definition serves
 * all. Everything made here is freed by the function beside it; a maker returns NULL when memory is out or the library
 * refuses, and then *message says why where there is one. */
#ifndef SCENES_H
#define SCENES_H

#include "yarncloth.h"

/* The same swatch, told apart by its descriptor alone. */
typedef enum scene_kind {
    SCENE_TRIANGLES,   /* a mesh whose material is the weave's */
    SCENE_YARNS,       /* yarns over the mesh, alpha 1 */
    SCENE_YARNS_ALONE, /* yarns without a mesh */
    SCENE_MIXED,       /* alpha 1 in the middle, a hybrid ring around it, triangles outside */
    SCENE_HALF,        /* alpha 1/2 everywhere: hybrid throughout */
    SCENE_ENRICHED,    /* enrich_all: every triangle hybrid with alpha 1, no sliding */
    SCENE_KINDS
} scene_kind;

const char *scene_kind_name(scene_kind kind);

typedef struct scene_swatch_desc {
    scene_kind kind;
    int cells[2];          /* of the mesh, along u and v; two triangles each, diagonals alternating */
    int one_way;           /* nonzero: all diagonals run the same way */
    double size[2];        /* m */
    double spacing;        /* m, of warps and of wefts */
    yc_yarn_material yarn; /* of both */
    double region;         /* SCENE_MIXED: vertices closer than this share of the size to the middle have alpha 1 */
    double origin[3], along_u[3], along_v[3]; /* where the pattern's (0, 0) lies and where its axes point */
} scene_swatch_desc;

/* 5 x 5 cells on 5 x 5 cm, yarns 2.5 mm apart, upright in the xy plane: 8 crossings a triangle. SCENE_MIXED has alpha 1
 * at the corners of the cell in the middle, all around it is hybrid, the outermost cells are triangles. */
scene_swatch_desc scene_swatch_desc_default(scene_kind kind);

typedef struct scene_swatch {
    scene_swatch_desc desc;
    yc_cloth_desc cloth; /* ready for yc_scene_add_cloth; a caller may change it before that */
    yc_weave_desc weave;
    yc_yarns yarns;   /* none for SCENE_TRIANGLES */
    int vertex_count; /* (cells[0] + 1) (cells[1] + 1), u first; 0 for SCENE_YARNS_ALONE */
    double (*positions)[3], (*uv)[2];
    int (*triangles)[3];
    double *alpha;
    double (*nodes)[3]; /* [yarns.node_count], where yarn nodes start */
    char message[YC_MESSAGE_SIZE];
} scene_swatch;

scene_swatch *scene_swatch_new(const scene_swatch_desc *desc);
void scene_swatch_free(scene_swatch *swatch);

/* Moves every vertex and yarn node to where `place` puts its pattern coordinates. */
void scene_swatch_place(scene_swatch *swatch, void (*place)(void *user, const double uv[2], double out[3]), void *user);

/* What the swatch's mechanics moves best: yarn nodes where there are yarns, vertices elsewhere. */
yc_point scene_swatch_kind(const scene_swatch *swatch);
int scene_swatch_count(const scene_swatch *swatch);

/* The vertex, or without a mesh the yarn node, nearest to a place of the pattern. */
int scene_swatch_nearest(const scene_swatch *swatch, double u, double v);

/* Pins it: to where it is, or to `position`. */
yc_result scene_swatch_pin(
    yc_scene *scene, int cloth, const scene_swatch *swatch, double u, double v, const double *position);

/* A single yarn of `pieces` equal segments along a straight line, held by nothing. Positions may be changed before it
 * is added. */
typedef struct scene_chain {
    yc_cloth_desc cloth;
    yc_yarns yarns;
    yc_yarn_material material;
    double (*positions)[3];
} scene_chain;

scene_chain *scene_chain_new(
    int pieces, double length, const double from[3], const double to[3], const yc_yarn_material *material);
void scene_chain_free(scene_chain *chain);

/* ---- the papers' scenes --------------------------------------------------------------------------------------- */

/* MIX Fig. 2: a swatch held along one edge swings down; soft yarns (k_s = 1e7 Pa times pi R^2), 0.1 ms. `cells` sets
 * the size: cells x cells pairs of triangles with 10 x 10 crossings each. The kind is as the caller wants it. */
scene_swatch *scene_swing(scene_kind kind, int cells);

/* The same yarns in a square of that size, crimped by 5 %, on as many pairs of triangles along each side: alpha 1 up to
 * `region` of the size from the middle. They are `stretch` times as stiff. */
scene_swatch *scene_swing_sized(int cells, double size, double region, double stretch);

/* MIX Fig. 3: the two opposite sides u = 0 and u = size are held by pins on yarn nodes and moved along v. Call once to
 * pin, then before each step with the displacement reached at its end. */
yc_result scene_shear(yc_scene *scene, int cloth, const scene_swatch *swatch, double displacement);

#endif
