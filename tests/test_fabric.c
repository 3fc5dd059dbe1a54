/* Tests of chapter `fabric`: weaves laid over pieces, their ends, rods along seams, checks of meshes and networks;
 * yarns, bundles of them, fabrics. Drafts: see test_draft.c. */
#include "internals.h"
#include "test.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROOM 4000 /* vertices, UVs and triangles of a test mesh */

typedef struct {
    int vertices, uvs, triangles;
    double position[ROOM][3], uv[ROOM][2];
    int triangle[ROOM][3], uv_triangle[ROOM][3];
} mesh_room;

static mesh_room sheet; /* one mesh at a time */

static yc_mesh room_mesh(void) {
    yc_mesh m;
    memset(&m, 0, sizeof m);
    m.vertex_count = sheet.vertices, m.uv_count = sheet.uvs, m.triangle_count = sheet.triangles;
    m.positions = (const double(*)[3])sheet.position, m.uv = (const double(*)[2])sheet.uv;
    m.triangles = (const int(*)[3])sheet.triangle, m.uv_triangles = (const int(*)[3])sheet.uv_triangle;
    return m;
}

/* Adds a piece: the cells of nx x ny whose letter in `mask` (rows from below; NULL: all) is '#', each h wide. Its
 * pattern begins at (u, v), its mesh at (x, y, 0). If asked it is welded to the vertices that are already there. */
static void add_piece(int nx, int ny, const char *mask, double h, double u, double v, double x, double y, int weld) {
    int vertex[1000], uv[1000], i, j, k, c;
    for (k = 0; k < 1000; k++) vertex[k] = -1;
    for (j = 0; j < ny; j++)
        for (i = 0; i < nx; i++) {
            int corner[4];
            if (mask && mask[j * nx + i] != '#') continue;
            for (c = 0; c < 4; c++) {
                int ci = i + (c == 1 || c == 2), cj = j + (c >= 2), at = cj * (nx + 1) + ci;
                corner[c] = at;
                if (vertex[at] >= 0) continue;
                uv[at] = sheet.uvs;
                sheet.uv[sheet.uvs][0] = u + ci * h, sheet.uv[sheet.uvs++][1] = v + cj * h;
                for (k = 0; k < sheet.vertices && vertex[at] < 0; k++)
                    if (weld &&
                        fabs(sheet.position[k][0] - x - ci * h) + fabs(sheet.position[k][1] - y - cj * h) < 1e-9)
                        vertex[at] = k;
                if (vertex[at] >= 0) continue;
                vertex[at] = sheet.vertices;
                sheet.position[sheet.vertices][0] = x + ci * h, sheet.position[sheet.vertices][1] = y + cj * h;
                sheet.position[sheet.vertices++][2] = 0.0;
            }
            for (k = 0; k < 2; k++) {
                int flip = (i + j) % 2, t[3];
                t[0] = corner[flip ? 3 : 0], t[1] = corner[k ? (flip ? 1 : 2) : (flip ? 0 : 1)];
                t[2] = corner[k ? (flip ? 2 : 3) : (flip ? 1 : 2)];
                for (c = 0; c < 3; c++) {
                    sheet.triangle[sheet.triangles][c] = vertex[t[c]];
                    sheet.uv_triangle[sheet.triangles][c] = uv[t[c]];
                }
                sheet.triangles++;
            }
        }
}

static void clear_room(void) { memset(&sheet, 0, sizeof sheet); }

static double distance(const double *a, const double *b) {
    double d[3];
    yci_sub(d, a, b);
    return yci_norm(d);
}

/* Whether a node with these weights lies on an edge of its triangle, and which half-edge that is. */
static int half_of(const yc_yarns *y, int node) {
    int k;
    for (k = 0; k < 3; k++)
        if (y->weights[node][(k + 2) % 3] == 0.0) return 3 * y->triangle[node] + k;
    return -1;
}

static int selvedges; /* nonzero: crossings at ends may be held */

/* All that holds for every weave. Returns the summed length of warps and wefts. */
static double check_weave(const yc_yarns *y, const yc_mesh *mesh, double grain) {
    char message[YC_MESSAGE_SIZE];
    int i, k, *visits = (int *)calloc((size_t)y->node_count, sizeof(int));
    int *other = (int *)calloc((size_t)y->node_count, sizeof(int)); /* 1 + the first visit of a node */
    double length = 0.0, along[2][3];
    CHECK_RESULT(yc_yarns_check(y, mesh, message), YC_OK);
    CHECK_TEXT(message, "");
    along[0][0] = -sin(grain), along[0][1] = cos(grain), along[0][2] = 0.0;
    along[1][0] = cos(grain), along[1][1] = sin(grain), along[1][2] = 0.0;
    for (k = 0; k < y->visit_count; k++) visits[y->visit_node[k]]++;
    for (i = 0; i < y->yarn_count; i++) {
        int first = y->yarn_first[i], last = y->yarn_first[i + 1] - 1, family = y->yarn_family[i], crossings = 0;
        CHECK(y->yarn_material[i] == family);
        CHECK(y->visit_u[first] == 0.0);
        CHECK(y->visit_held[first] && y->visit_held[last]);
        for (k = first; k <= last; k++) {
            int node = y->visit_node[k], before = k > first ? y->visit_node[k - 1] : node;
            if (family == YC_ROD) CHECK(visits[node] == 2 && y->visit_held[k]);
            if (visits[node] == 1) CHECK(y->visit_layer[k] == 0);
            if (k > first && k < last && !selvedges)
                CHECK(!y->visit_held[k] == (family != YC_ROD && visits[node] == 2));
            crossings += y->visit_layer[k] != 0;
            if (visits[node] == 2 && !other[node]) other[node] = k + 1;
            else if (visits[node] == 2) {
                CHECK(y->visit_layer[k] + y->visit_layer[other[node] - 1] == 0);
                CHECK((y->visit_layer[k] == 0) == (family == YC_ROD)); /* rods come last */
            }
            if (k == first || family == YC_ROD) continue;
            CHECK_NEAR(y->visit_u[k] - y->visit_u[k - 1], distance(y->layout[node], y->layout[before]), 1e-15);
        }
        if (family == YC_ROD) continue;
        CHECK(crossings >= 1);
        length += y->visit_u[last];
        { /* straight along the grain, but for ends that were moved along a seam */
            double d[3];
            yci_sub(d, y->layout[y->visit_node[last]], y->layout[y->visit_node[first]]);
            CHECK(yci_dot(d, along[family]) > 0.98 * yci_norm(d));
        }
    }
    for (i = 0; i < y->node_count && mesh; i++) {
        const int *t = (mesh->uv_triangles ? mesh->uv_triangles : mesh->triangles)[y->triangle[i]];
        double place[2] = {0.0, 0.0};
        for (k = 0; k < 3; k++) {
            CHECK(y->weights[i][k] >= -1e-12);
            place[0] += y->weights[i][k] * mesh->uv[t[k]][0], place[1] += y->weights[i][k] * mesh->uv[t[k]][1];
        }
        CHECK_NEAR_ALL(place, y->layout[i], 2, 1e-12);
        CHECK(y->layout[i][2] == 0.0);
    }
    free(visits);
    free(other);
    return length;
}

static int count_family(const yc_yarns *y, int family) {
    int i, count = 0;
    for (i = 0; i < y->yarn_count; i++) count += y->yarn_family[i] == family;
    return count;
}

static int count_crossings(const yc_yarns *y) {
    int k, count = 0;
    for (k = 0; k < y->visit_count; k++) count += y->visit_layer[k] != 0;
    return count / 2;
}

static void node_position(const yc_yarns *y, int node, double *x) {
    const int *t = sheet.triangle[y->triangle[node]];
    int k;
    yci_zero(x, 3);
    for (k = 0; k < 3; k++) yci_axpy(x, y->weights[node][k], sheet.position[t[k]]);
}

TEST(fabric_rectangle) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_yarns y;
    int i, k;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    CHECK(y.node_count == 80 * 80 + 4 * 80 && y.yarn_count == 160 && y.visit_count == 160 * 82);
    CHECK(y.triangle == NULL && y.weights == NULL && y.material_count == 3);
    CHECK_NEAR(check_weave(&y, NULL, 0.0), 2.0 * 0.2 * 0.2 / 2.5e-3, 1e-10);
    CHECK(y.materials[2].density == 30e-6);
    for (i = 0; i < y.yarn_count; i++)
        for (k = y.yarn_first[i]; k < y.yarn_first[i + 1]; k++) {
            int n = k - y.yarn_first[i], line = i % 80, family = i / 80;
            const double *x = y.layout[y.visit_node[k]];
            double along = n == 0 ? 0.0 : n == 81 ? 0.2 : (n - 0.5) * 2.5e-3;
            CHECK_NEAR(x[family], (line + 0.5) * 2.5e-3, 1e-15);
            CHECK_NEAR(x[1 - family], along, 1e-15);
            CHECK_NEAR(y.visit_u[k], along, 1e-14);
            /* Plain weave: warp 0 passes over weft 0. */
            if (n > 0 && n < 81) CHECK(y.visit_layer[k] == ((line + n - 1) % 2 == family ? 1 : -1));
        }
    yc_yarns_destroy(&y);
    CHECK(y.layout == NULL && y.owner == NULL);
    yc_yarns_destroy(&y);
    yc_yarns_destroy(NULL);
}

/* Tails of 0.7, 0.1, 0.02 and 0 spacings at the far sides; different spacings. */
TEST(fabric_rectangle_tails) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_yarns y;
    int i, k;
    d.spacing[0] = 0.002, d.spacing[1] = 0.004;
    d.size[0] = 10.2 * 0.002, d.size[1] = 6.6 * 0.004; /* 10 warps, tail 0.7; 7 wefts, tail 0.1 */
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    CHECK(count_family(&y, YC_WARP) == 10 && count_family(&y, YC_WEFT) == 7 && count_crossings(&y) == 70);
    CHECK(y.node_count == 70 + 20 + 14);
    CHECK_NEAR(check_weave(&y, NULL, 0.0), 10 * 6.6 * 0.004 + 7 * 10.2 * 0.002, 1e-12);
    yc_yarns_destroy(&y);
    d.edge[YC_WARP] = d.edge[YC_WEFT] = YC_EDGE_SELVEDGE;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    CHECK(count_family(&y, YC_WARP) == 10 && count_family(&y, YC_WEFT) == 7 && count_crossings(&y) == 70);
    CHECK(y.node_count == 70 + 10 + 14); /* warps have one tip, wefts two */
    selvedges = 1;
    CHECK_NEAR(check_weave(&y, NULL, 0.0), 10 * 6.5 * 0.004 + 7 * 10.2 * 0.002, 1e-12);
    selvedges = 0;
    for (i = 0; i < y.yarn_count; i++)
        for (k = y.yarn_first[i]; k < y.yarn_first[i + 1]; k++) { /* first and last crossings, and what is beyond */
            int n = k - y.yarn_first[i], count = y.yarn_first[i + 1] - y.yarn_first[i];
            CHECK(y.visit_held[k] == (n < 2 || n >= count - (y.yarn_family[i] == YC_WARP ? 1 : 2)));
        }
    yc_yarns_destroy(&y);
    d.edge[YC_WARP] = YC_EDGE_CUT; /* as cloth comes off a loom */
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    for (i = 0; i < y.yarn_count; i++) CHECK(y.visit_held[y.yarn_first[i] + 1] == (y.yarn_family[i] == YC_WEFT));
    yc_yarns_destroy(&y);
    d.edge[YC_WEFT] = YC_EDGE_CUT;
    d.size[1] = 6.52 * 0.004; /* warps let go of the last weft, which falls off */
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    CHECK(count_family(&y, YC_WARP) == 10 && count_family(&y, YC_WEFT) == 6 && count_crossings(&y) == 60);
    CHECK_NEAR(check_weave(&y, NULL, 0.0), 10 * 6.52 * 0.004 + 6 * 10.2 * 0.002, 1e-12);
    yc_yarns_destroy(&y);
    d.size[0] = 10.5 * 0.002; /* a line on the edge is not laid */
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    CHECK(count_family(&y, YC_WARP) == 10);
    yc_yarns_destroy(&y);
}

TEST(fabric_draft) {
    static const unsigned char draft[6] = {1, 0, 0, 0, 9, 1}; /* warps 0..2 over weft 0, then over weft 1 */
    yc_weave_desc d = yc_weave_desc_default();
    yc_yarns y;
    int i, n;
    d.draft = draft, d.repeat[0] = 3, d.repeat[1] = 2, d.size[0] = d.size[1] = 0.025;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    check_weave(&y, NULL, 0.0);
    for (i = 0; i < 10; i++)
        for (n = 0; n < 10; n++) CHECK(y.visit_layer[y.yarn_first[i] + 1 + n] == (draft[n % 2 * 3 + i % 3] ? 1 : -1));
    yc_yarns_destroy(&y);
}

TEST(fabric_l_shape) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    int i;
    clear_room();
    add_piece(4, 4,
        "####"
        "####"
        "##.."
        "##..",
        0.01, 0.3, -0.7, 0.0, 0.0, 0);
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    CHECK(y.yarn_count == 32 && count_crossings(&y) == 192 && y.node_count == 192 + 64);
    CHECK_NEAR(check_weave(&y, &mesh, 0.0), 2.0 * 12e-4 / 2.5e-3, 1e-12);
    for (i = 0; i < y.yarn_count; i++) { /* the upper ends of the warps, the right ends of the wefts */
        const double *x = y.layout[y.visit_node[y.yarn_first[i + 1] - 1]];
        int f = y.yarn_family[i];
        double at = x[f] - (f ? -0.7 : 0.3);
        CHECK_NEAR(x[1 - f] - (f ? 0.3 : -0.7), at < 0.02 ? 0.04 : 0.02, 1e-15);
    }
    yc_yarns_destroy(&y);
}

/* A comb: its wefts are cut into three yarns each above the back. */
TEST(fabric_concave) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    clear_room();
    add_piece(5, 3,
        "#####"
        "#.#.#"
        "#.#.#",
        0.01, 0.0, 0.0, 0.0, 0.0, 0);
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    CHECK(count_family(&y, YC_WARP) == 20 && count_family(&y, YC_WEFT) == 4 + 3 * 8);
    CHECK(count_crossings(&y) == 4 * 20 + 8 * 12);
    CHECK_NEAR(check_weave(&y, &mesh, 0.0), 2.0 * 11e-4 / 2.5e-3, 1e-12);
    yc_yarns_destroy(&y);
    clear_room(); /* a frame: a hole */
    add_piece(3, 3,
        "###"
        "#.#"
        "###",
        0.01, 0.0, 0.0, 0.0, 0.0, 0);
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    CHECK(y.yarn_count == 2 * (8 + 8) && count_crossings(&y) == 144 - 16);
    check_weave(&y, &mesh, 0.0);
    yc_yarns_destroy(&y);
}

/* Half a ring, bent from a strip: exact clips on slanted edges; yarn ends of every length. A cut yarn ends in a node of
 * its own, a selvedge's does so or at its last crossing. */
static void check_ring(yc_edge edge, double least) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    double area = 0.0, length, shortest = 1.0;
    int i, k, tips = 0;
    clear_room();
    add_piece(40, 4, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 0);
    for (i = 0; i < sheet.uvs; i++) {
        double angle = YCI_PI * sheet.uv[i][0] / 0.4, r = 0.14 - sheet.uv[i][1];
        sheet.uv[i][0] = -r * cos(angle), sheet.uv[i][1] = -r * sin(angle);
    }
    mesh = room_mesh();
    d.edge[YC_WARP] = d.edge[YC_WEFT] = edge;
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    for (i = 0; i < sheet.triangles; i++) {
        const double *a = sheet.uv[sheet.uv_triangle[i][0]], *b = sheet.uv[sheet.uv_triangle[i][1]];
        const double *c = sheet.uv[sheet.uv_triangle[i][2]];
        area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    }
    selvedges = edge == YC_EDGE_SELVEDGE;
    length = check_weave(&y, &mesh, 0.0);
    selvedges = 0;
    CHECK_NEAR(length, 2.0 * area / 2.5e-3, 0.02 * length);
    CHECK_NEAR(count_crossings(&y), area / 2.5e-3 / 2.5e-3, 0.02 * area / 2.5e-3 / 2.5e-3);
    for (i = 0; i < y.yarn_count; i++)
        for (k = 0; k < 2; k++) {
            int visit = k ? y.yarn_first[i + 1] - 1 : y.yarn_first[i];
            if (y.visit_layer[visit]) continue;
            CHECK(half_of(&y, y.visit_node[visit]) >= 0); /* on the outline */
            shortest = yci_min(shortest, k ? y.visit_u[visit] - y.visit_u[visit - 1] : y.visit_u[visit + 1]);
            tips++;
        }
    CHECK(shortest >= least && shortest < 1.5 * least);
    CHECK(edge == YC_EDGE_CUT ? tips == 2 * y.yarn_count : tips < 2 * y.yarn_count);
    yc_yarns_destroy(&y);
}

TEST(fabric_ring) {
    check_ring(YC_EDGE_CUT, 0.05 * 2.5e-3);
    check_ring(YC_EDGE_SELVEDGE, 0.3 * 2.5e-3);
}

/* Two pieces at the same UVs: every node lies in a triangle of its own piece. */
TEST(fabric_pieces_overlap) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    int i, k;
    clear_room();
    add_piece(4, 4, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 0);
    add_piece(4, 3, NULL, 0.01, 0.0, 0.0, 1.0, 0.0, 0);
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    CHECK(y.yarn_count == 32 + 28 && count_crossings(&y) == 256 + 192);
    check_weave(&y, &mesh, 0.0);
    for (i = 0; i < y.yarn_count; i++)
        for (k = y.yarn_first[i]; k < y.yarn_first[i + 1]; k++) CHECK((y.triangle[y.visit_node[k]] < 32) == (i < 32));
    yc_yarns_destroy(&y);
    for (i = 0; i < 24; i++) /* the same with UV indices shared by both pieces, which the mesh keeps apart */
        for (k = 0; k < 3; k++) sheet.uv_triangle[32 + i][k] = sheet.uv_triangle[i][k];
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    CHECK(y.yarn_count == 32 + 28 && count_crossings(&y) == 256 + 192);
    check_weave(&y, &mesh, 0.0);
    yc_yarns_destroy(&y);
}

/* Doubles the vertices and UVs of the line u = `at` up to `height` for the triangles to its right. */
static void slit(double at, double height) {
    int i, k, n, old_uvs = sheet.uvs;
    for (n = 0; n < old_uvs; n++) {
        int vertex = sheet.vertices, used = 0;
        if (fabs(sheet.uv[n][0] - at) > 1e-9 || sheet.uv[n][1] > height) continue;
        for (i = 0; i < sheet.triangles; i++)
            for (k = 0; k < 3; k++) {
                const int *t = sheet.uv_triangle[i];
                if (t[k] != n || sheet.uv[t[0]][0] + sheet.uv[t[1]][0] + sheet.uv[t[2]][0] < 3.0 * at) continue;
                yci_copy(sheet.position[vertex], sheet.position[sheet.triangle[i][k]]);
                sheet.triangle[i][k] = vertex, sheet.uv_triangle[i][k] = sheet.uvs, used = 1;
            }
        if (!used) continue;
        sheet.uv[sheet.uvs][0] = sheet.uv[n][0], sheet.uv[sheet.uvs][1] = sheet.uv[n][1];
        sheet.uvs++, sheet.vertices++;
    }
}

/* Two edges of one piece at the same UVs: the wefts that meet the slit are cut, and end each on its own side. */
static void check_slit(double shift) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    int i, k, c, old, ends = 0;
    clear_room();
    add_piece(4, 4, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 0);
    old = sheet.uvs;
    slit(0.02, 0.015);
    for (i = 0; i < sheet.uvs; i++) sheet.uv[i][0] += 0.137 * sheet.uv[i][1] + (i < old ? 0.0 : shift);
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    CHECK(count_family(&y, YC_WEFT) == 16 + 8);
    check_weave(&y, &mesh, 0.0);
    for (i = 0; i < y.yarn_count; i++) {
        double least = 1.0, most = -1.0;
        if (y.yarn_family[i] != YC_WEFT || y.layout[y.visit_node[y.yarn_first[i]]][1] > 0.02) continue;
        for (k = y.yarn_first[i]; k < y.yarn_first[i + 1]; k++) { /* a yarn stays in triangles of one side */
            int t = y.triangle[y.visit_node[k]];
            double u = -0.02;
            for (c = 0; c < 3; c++) {
                const double *uv = sheet.uv[sheet.uv_triangle[t][c]];
                u += (uv[0] - 0.137 * uv[1]) / 3.0;
            }
            least = yci_min(least, u), most = yci_max(most, u);
        }
        CHECK(least > 0.0 || most < 0.0);
        ends++;
    }
    CHECK(ends == 16);
    yc_yarns_destroy(&y);
}

TEST(fabric_slit) {
    check_slit(0.0);
    check_slit(1e-13);
    check_slit(-1e-13); /* as rounding may have it: the sides overlap */
}

/* Lattice lines that run exactly along edges of the mesh and of the outline. */
TEST(fabric_on_edges) {
    char mask[16 * 16 + 1];
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    int i;
    for (i = 0; i < 256; i++) mask[i] = i % 16 >= 7 && i / 16 >= 7 ? '.' : '#';
    for (i = 0; i < 4; i++) {
        clear_room();
        add_piece(16, 16, mask, 0.00125, i % 2 * 0.1, 0.0, 0.0, 0.0, 0);
        d.grain = i / 2 * 0.5 * YCI_PI;
        mesh = room_mesh();
        if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
        check_weave(&y, &mesh, d.grain);
        CHECK(y.yarn_count == 16 && count_crossings(&y) >= 64 - 25 && count_crossings(&y) <= 64 - 16);
        yc_yarns_destroy(&y);
    }
}

TEST(fabric_grain) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    double length;
    d.grain = YCI_PI / 6.0;
    clear_room();
    add_piece(10, 10, NULL, 0.01, -0.02, 0.05, 0.0, 0.0, 0);
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    length = check_weave(&y, &mesh, d.grain);
    CHECK_NEAR(length, 2.0 * 0.01 / 2.5e-3, 0.02 * length);
    yc_yarns_destroy(&y);
    d.size[0] = d.size[1] = 0.1;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    length = check_weave(&y, NULL, d.grain);
    CHECK_NEAR(length, 2.0 * 0.01 / 2.5e-3, 0.02 * length);
    yc_yarns_destroy(&y);
    d.grain = 0.5 * YCI_PI; /* warps and wefts trade places */
    d.size[0] = 0.05;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    CHECK(count_family(&y, YC_WARP) == 40 && count_family(&y, YC_WEFT) == 20);
    CHECK_NEAR(check_weave(&y, NULL, d.grain), 2.0 * 0.005 / 2.5e-3, 1e-12);
    yc_yarns_destroy(&y);
}

/* What holds for the rods of a mesh that is flat and as large as its pattern. Every end on a seam is tied once. */
static void check_rods(const yc_yarns *y, double gap, int expected_rods, int expected_ends, double slack) {
    int i, k, ends = 0;
    CHECK(count_family(y, YC_ROD) == expected_rods);
    for (i = 0; i < y->yarn_count; i++) {
        if (y->yarn_family[i] != YC_ROD) continue;
        ends += y->yarn_first[i + 1] - y->yarn_first[i];
        for (k = y->yarn_first[i] + 1; k < y->yarn_first[i + 1]; k++) {
            double a[3], b[3], step = y->visit_u[k] - y->visit_u[k - 1];
            node_position(y, y->visit_node[k - 1], a), node_position(y, y->visit_node[k], b);
            CHECK(step >= gap * (1.0 - 1e-9));
            CHECK_NEAR(step, distance(a, b), slack);
        }
    }
    CHECK(ends == expected_ends);
}

/* Two pieces welded along a straight edge, their lattices shifted against each other. */
TEST(fabric_rod) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    clear_room();
    add_piece(4, 6, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 1);
    add_piece(3, 4, NULL, 0.01, 0.5, 0.2, 0.04, 0.01 * 1.0, 1); /* its lattice: wefts at 0.01125 + k 0.0025 */
    mesh = room_mesh();
    CHECK(mesh.vertex_count == 35 + 20 - 5);
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    check_weave(&y, &mesh, 0.0);
    check_rods(&y, 0.05 * 2.5e-3, 1, 32, 1e-12); /* 16 wefts from each side, moved apart: the lattices agree */
    CHECK(y.yarn_count == 16 + 24 + 12 + 16 + 1);
    CHECK(y.node_count == 16 * 24 + 12 * 16 + 2 * 16 + 2 * 24 + 2 * 12 + 2 * 16);
    yc_yarns_destroy(&y);
    d.spacing[1] = 2.3e-3; /* lattices that do not agree */
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    check_weave(&y, &mesh, 0.0);
    check_rods(&y, 0.05 * 2.4e-3, 1, 18 + 17, 1e-12);
    yc_yarns_destroy(&y);
    d.rod.density = 0.0; /* no rods: the ends are lone nodes */
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    check_weave(&y, &mesh, 0.0);
    check_rods(&y, 0.0, 0, 0, 0.0);
    CHECK(y.material_count == 2);
    yc_yarns_destroy(&y);
}

/* Ends of both sides that fall on the same vertices of the seam are moved apart over several edges and stay on their
 * sides. */
TEST(fabric_rod_spread) {
    yc_weave_desc d = yc_weave_desc_default();
    yci_weave_cut ties[3];
    yc_mesh mesh;
    yc_yarns y;
    int k;
    clear_room();
    add_piece(20, 10, NULL, 0.00125, 0.0, 0.0, 0.0, 0.0, 1);
    add_piece(20, 10, NULL, 0.00125, 1.0, 0.0, 0.025, 0.0, 1);
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    check_weave(&y, &mesh, 0.0);
    check_rods(&y, 0.05 * 2.5e-3, 1, 10, 1e-12);
    yc_yarns_destroy(&y);
    memset(ties, 0, sizeof ties);
    for (k = 0; k < 3; k++) ties[k].along = 1.0;
    yci_weave_spread(ties, 3, 0.125, 1.0);
    CHECK(ties[0].along == 0.75 && ties[1].along == 0.875 && ties[2].along == 1.0);
    ties[0].along = 0.0, ties[1].along = 0.0, ties[2].along = 0.5;
    yci_weave_spread(ties, 3, 0.125, 1.0);
    CHECK(ties[0].along == 0.0 && ties[1].along == 0.125 && ties[2].along == 0.5);
}

/* A slanted seam: short tails let go of their last crossings, so that every yarn reaches the seam. */
TEST(fabric_rod_slanted) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    int i, k, lone = 0, *visits;
    clear_room();
    add_piece(6, 6, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 1);
    add_piece(6, 6, NULL, 0.01, 1.0, 0.0, 0.06, 0.0, 1);
    for (i = 0; i < sheet.uvs; i++) /* sheared about the seam, and turned a little */
        sheet.uv[i][0] += 0.431 * sheet.uv[i][1], sheet.uv[i][1] -= 0.09 * sheet.uv[i][0];
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    check_weave(&y, &mesh, 0.0);
    CHECK(count_family(&y, YC_ROD) == 1);
    visits = (int *)calloc((size_t)y.node_count, sizeof(int));
    for (k = 0; k < y.visit_count; k++) visits[y.visit_node[k]]++;
    for (k = 0; k < y.yarn_count; k++)
        for (i = y.yarn_first[k] + 1; i + 1 < y.yarn_first[k + 1]; i++) lone += visits[y.visit_node[i]] == 1;
    CHECK(lone > 0);
    for (i = 0; i < y.node_count; i++) { /* no lone node lies on the seam */
        double x[3];
        node_position(&y, i, x);
        if (fabs(x[0] - 0.06) < 1e-12) CHECK(visits[i] == 2);
    }
    free(visits);
    yc_yarns_destroy(&y);
}

/* A pillow, welded all around: one rod along the closed seam, open between its last and first end. */
TEST(fabric_rod_cycle) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    int i, k, back, map[ROOM];
    clear_room();
    add_piece(4, 4, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 0);
    add_piece(4, 4, NULL, 0.01, 1.0, 0.0, 0.0, 0.0, 0);
    back = sheet.vertices / 2;
    for (i = 0; i < sheet.vertices; i++) { /* the second piece is the first one's mirror image, turned over */
        const double *x = sheet.position[i];
        map[i] = i;
        if (i < back) continue;
        sheet.position[i][0] = 0.04 - x[0];
        for (k = 0; k < back; k++)
            if (distance(sheet.position[k], x) < 1e-9 &&
                (x[0] < 1e-9 || x[0] > 0.04 - 1e-9 || x[1] < 1e-9 || x[1] > 0.04 - 1e-9))
                map[i] = k;
    }
    for (i = 0; i < sheet.triangles; i++)
        for (k = 0; k < 3; k++) sheet.triangle[i][k] = map[sheet.triangle[i][k]];
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    check_weave(&y, &mesh, 0.0);
    check_rods(&y, 0.05 * 2.5e-3, 1, 4 * 32, 2e-3); /* around the corners the distance is the shorter */
    yc_yarns_destroy(&y);
}

/* A tube: the seam joins a piece to itself. Three pieces at a corner: rods end at the branching point. */
TEST(fabric_rod_branch) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    int i, k, c;
    clear_room();
    add_piece(6, 4, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 0);
    for (i = 0; i < sheet.triangles; i++)
        for (k = 0; k < 3; k++) {
            const double *x = sheet.position[sheet.triangle[i][k]];
            if (x[0] < 0.06 - 1e-9) continue;
            for (c = 0; c < sheet.vertices; c++)
                if (sheet.position[c][0] == 0.0 && fabs(sheet.position[c][1] - x[1]) < 1e-9) break;
            sheet.triangle[i][k] = c;
        }
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    check_weave(&y, &mesh, 0.0);
    CHECK(count_family(&y, YC_ROD) == 1 && y.yarn_count == 24 + 16 + 1);
    CHECK(y.yarn_first[41] - y.yarn_first[40] == 32);
    yc_yarns_destroy(&y);
    clear_room();
    add_piece(4, 4, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 1);
    add_piece(3, 4, NULL, 0.01, 1.0, 0.0, 0.04, 0.0, 1);
    add_piece(7, 2, NULL, 0.01, 2.0, 0.0, 0.0, 0.04, 1);
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    check_weave(&y, &mesh, 0.0);
    check_rods(&y, 0.05 * 2.5e-3, 3, 2 * (16 + 12 + 16), 1e-12);
    yc_yarns_destroy(&y);
}

/* Jittered pieces, any grain, any spacing. */
TEST(fabric_random) {
    uint64_t state = 7;
    int round, i;
    for (round = 0; round < 60; round++) {
        yc_weave_desc d = yc_weave_desc_default();
        yc_mesh mesh;
        yc_yarns y;
        char message[YC_MESSAGE_SIZE];
        double area = 0.0, length;
        d.spacing[0] = test_random(&state, 1e-3, 4e-3), d.spacing[1] = test_random(&state, 1e-3, 4e-3);
        d.grain = round % 3 ? test_random(&state, -4.0, 4.0) : 0.0;
        clear_room();
        add_piece(5, 5,
            round % 2 ? "#####"
                        "##.##"
                        "#...#"
                        "##.##"
                        "#####"
                      : NULL,
            0.01, 0.0, 0.0, 0.0, 0.0, 1);
        add_piece(4, 5, NULL, 0.01, 1.0, 0.0, 0.05, 0.0, 1);
        for (i = 0; i < sheet.uvs; i++) {
            sheet.uv[i][0] += test_random(&state, -2e-3, 2e-3), sheet.uv[i][1] += test_random(&state, -2e-3, 2e-3);
        }
        mesh = room_mesh();
        CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, message), YC_OK);
        if (!CHECK_TEXT(message, "")) return;
        for (i = 0; i < sheet.triangles; i++) {
            const double *a = sheet.uv[sheet.uv_triangle[i][0]], *b = sheet.uv[sheet.uv_triangle[i][1]];
            const double *c = sheet.uv[sheet.uv_triangle[i][2]];
            area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        }
        length = check_weave(&y, &mesh, d.grain);
        CHECK_NEAR(length, area / d.spacing[0] + area / d.spacing[1], 0.1 * length);
        CHECK(count_family(&y, YC_ROD) == 1);
        yc_yarns_destroy(&y);
    }
}

/* ---- refusals ---------------------------------------------------------------------------------------------------- */

static void refused_weave(const yc_weave_desc *d, const yc_mesh *mesh, yc_result code, const char *expected) {
    char message[YC_MESSAGE_SIZE] = "";
    yc_yarns y, before;
    memset(&y, 7, sizeof y);
    before = y;
    CHECK_RESULT(yc_weave(NULL, d, mesh, &y, message), code);
    CHECK(memcmp(&y, &before, sizeof y) == 0);
    CHECK_TEXT(message, expected);
}

TEST(fabric_weave_refuses) {
    static const int order[3] = {0, 1, 2};
    static const unsigned char floats[8] = {1, 0, 0, 0, 0, 0, 0, 0};
    yc_yarn_material colours[2] = {yc_yarn_material_default(), yc_yarn_material_default()};
    yc_weave_desc d = yc_weave_desc_default(), good = d;
    yc_yarns y;
    char message[YC_MESSAGE_SIZE];
    d.cookie = 0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.cookie: not made by yc_weave_desc_default()");
    refused_weave(NULL, NULL, YC_ERROR_ARGUMENT, "desc must not be NULL");
    CHECK_RESULT(yc_weave(NULL, &good, NULL, NULL, message), YC_ERROR_ARGUMENT);
    CHECK_TEXT(message, "out must not be NULL");
    d = good, d.spacing[1] = -1.0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.spacing[1] = -1 must be greater than 0");
    d = good, d.spacing[0] = HUGE_VAL;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.spacing[0] = inf must be finite");
    d = good, d.repeat[0] = 0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.repeat[0] = 0 must be at least 1");
    d = good, d.size[1] = 0.0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.size[1] = 0 must be greater than 0");
    d = good, d.size[1] = HUGE_VAL;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.size[1] = inf must be finite");
    d = good, d.grain = HUGE_VAL;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.grain = inf must be finite");
    d = good, d.warp.stretch = 0.0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.warp.stretch = 0 must be greater than 0");
    d = good, d.warp.stretch = HUGE_VAL - HUGE_VAL;
    CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, message), YC_ERROR_ARGUMENT);
    CHECK(!strncmp(message, "weave.warp.stretch = ", 21) && strstr(message, "nan must be finite"));
    d = good, d.weft.bending = -1.0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.weft.bending = -1 must not be negative");
    d = good, d.weft.flattening = -2.0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.weft.flattening = -2 must not be negative");
    d = good, d.warp.bundle = 0.5;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.warp.bundle = 0.5 must be at least 1");
    d = good, d.weft.shear_limit = 2.0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.weft.shear_limit = 2 must lie in (0, pi/2]");
    d = good, d.weft.friction = 11.0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.weft.friction = 11 must be at most 10");
    d = good, d.rod.density = -1.0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.rod.density = -1 must be greater than 0");
    d = good, d.crimp[1] = 0.6;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.crimp[1] = 0.6 must lie in [0, 0.5]");
    d = good, d.draft = floats, d.repeat[0] = 1, d.repeat[1] = 8, d.crimp[0] = 0.2;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT,
        "weave.crimp[0] = 0.2: the draft changes sides so rarely that a yarn would be 1.8 spacings long there, more "
        "than 1.5");
    d.crimp[0] = 0.1, d.crimp[1] = 0.1; /* the wefts never change sides: they have none */
    if (CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) yc_yarns_destroy(&y);
    CHECK_NEAR(yc_weave_material(&d).density, (d.warp.density * 1.1 + d.weft.density) / d.spacing[0], 1e-15);
    d = good, d.edge[1] = (yc_edge)2;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.edge[1] = 2 is none of yc_edge");
    d = good, d.bundle = 0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.bundle = 0 must lie in 1 .. 1000");
    d = good, d.material_count = -1;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.material_count = -1 must lie in 0 .. 100000000");
    d = good, d.material_count = 2;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.materials must not be NULL: material_count = 2");
    d.materials = colours, d.order[1] = order;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.order_count[1] = 0 must be at least 1");
    d.order_count[1] = 3;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.order[1][2] = 2 must lie in 0 .. 1");
    colours[1].radius = -1.0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.materials[1].radius = -1 must be greater than 0");
    d = good, d.rod.density = 0.0, d.rod.stretch = -1.0; /* no rods: their material is not looked at */
    CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK);
    yc_yarns_destroy(&y);
    d = good, d.spacing[0] = d.spacing[1] = 1e-5;
    refused_weave(
        &d, NULL, YC_ERROR_ARGUMENT, "weave.spacing = 1e-05, 1e-05 gives about 4e+08 crossings, more than 100000000");
    d = good, d.spacing[0] = 1e-10, d.spacing[1] = 1000.0;
    refused_weave(
        &d, NULL, YC_ERROR_ARGUMENT, "weave.spacing = 1e-10, 1000 gives about 2e+09 lines, more than 100000000");
    d = good, d.spacing[0] = d.spacing[1] = 1.0;
    refused_weave(&d, NULL, YC_ERROR_ARGUMENT, "weave.spacing = 1, 1 is too wide: nowhere do two yarns cross");
}

TEST(fabric_mesh_refuses) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh, good;
    yc_yarns y;
    char message[YC_MESSAGE_SIZE];
    int kept;
    clear_room();
    add_piece(2, 2, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 0);
    good = mesh = room_mesh();
    mesh.vertex_count = 2;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.vertex_count = 2 must be at least 3");
    mesh = good, mesh.triangle_count = 0;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.triangle_count = 0 must lie in 1 .. 7e8");
    mesh = good, mesh.uv_count = -4;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.uv_count = -4 must be at least 3");
    mesh = good, mesh.uv = NULL;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.uv must not be NULL");
    mesh = good, mesh.positions = NULL;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.positions must not be NULL");
    mesh = good, mesh.triangles = NULL;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.triangles must not be NULL");
    mesh = good, mesh.uv_triangles = NULL; /* `triangles` serves */
    CHECK_RESULT(yc_weave(NULL, &d, &mesh, NULL, NULL), YC_ERROR_ARGUMENT);
    mesh = good, mesh.uv_count = 8;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.uv_triangles[6][2] = 8 must lie in 0 .. 7 of the UVs");
    mesh = good, sheet.triangle[3][1] = -2;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.triangles[3][1] = -2 must lie in 0 .. 8");
    clear_room();
    add_piece(2, 2, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 0);
    sheet.position[5][2] = HUGE_VAL;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.positions[5][2] = inf must be finite");
    sheet.position[5][2] = 0.0, sheet.uv[4][0] = -HUGE_VAL;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.uv[4][0] = -inf must be finite");
    sheet.uv[4][0] = 0.02;
    kept = sheet.uv_triangle[2][0], sheet.uv_triangle[2][0] = sheet.uv_triangle[2][1], sheet.uv_triangle[2][1] = kept;
    refused_weave(&d, &mesh, YC_ERROR_ARGUMENT, "mesh.uv_triangles[2]: area -5e-05 m^2 must be > 0");
    kept = sheet.uv_triangle[2][0], sheet.uv_triangle[2][0] = sheet.uv_triangle[2][1], sheet.uv_triangle[2][1] = kept;
    kept = sheet.triangle[2][0], sheet.triangle[2][0] = sheet.triangle[2][1], sheet.triangle[2][1] = kept;
    refused_weave(&d, &mesh, YC_ERROR_TOPOLOGY,
        "mesh.triangles[0] and [2] are wound against each other at the edge of vertices 1 and 2");
    sheet.triangle[2][1] = sheet.triangle[2][0];
    refused_weave(&d, &mesh, YC_ERROR_TOPOLOGY, "mesh.triangles[2] = 1 1 4: a vertex occurs twice");
    clear_room();
    add_piece(2, 1, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 0); /* a third triangle at the first one's first edge */
    mesh = room_mesh();
    sheet.triangle[2][0] = sheet.triangle[0][1], sheet.triangle[2][1] = sheet.triangle[0][0];
    sheet.triangle[3][0] = sheet.triangle[0][0], sheet.triangle[3][1] = sheet.triangle[0][1];
    refused_weave(&d, &mesh, YC_ERROR_TOPOLOGY, "mesh.triangles[0], [2] and [3] share the edge of vertices 0 and 1");
    clear_room(); /* a fan that turns around its middle by more than a full circle */
    mesh = room_mesh();
    for (kept = 0; kept < 12; kept++) {
        sheet.uv[kept][0] = kept ? 0.05 * cos(kept * 0.7) : 0.0,
        sheet.uv[kept][1] = kept ? 0.05 * sin(kept * 0.7) : 0.0;
        yci_zero(sheet.position[kept], 3);
        sheet.triangle[kept][0] = sheet.uv_triangle[kept][0] = 0;
        sheet.triangle[kept][1] = sheet.uv_triangle[kept][1] = kept + 1;
        sheet.triangle[kept][2] = sheet.uv_triangle[kept][2] = kept + 2;
    }
    mesh.vertex_count = mesh.uv_count = 12, mesh.triangle_count = 10;
    CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, message), YC_ERROR_TOPOLOGY);
    CHECK(strstr(message, "overlaps itself") != NULL);
}

static void check_refused(const yc_yarns *y, const yc_mesh *mesh, yc_result code, const char *expected) {
    char message[YC_MESSAGE_SIZE] = "";
    CHECK_RESULT(yc_yarns_check(y, mesh, message), code);
    CHECK_TEXT(message, expected);
}

/* Changes one value, checks the message, and changes it back. */
#define SPOILED(target, value, type, code, text) \
    do { \
        type kept_value = (target); \
        (target) = (value); \
        check_refused(&y, &mesh, (code), (text)); \
        (target) = kept_value; \
    } while (0)

TEST(fabric_check_refuses) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y;
    clear_room();
    add_piece(1, 1, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 0); /* 4 x 4 crossings, 16 ends */
    mesh = room_mesh();
    if (!CHECK_RESULT(yc_weave(NULL, &d, &mesh, &y, NULL), YC_OK)) return;
    CHECK(y.node_count == 32 && y.yarn_count == 8 && y.visit_count == 48);
    check_refused(&y, &mesh, YC_OK, "");
    check_refused(NULL, &mesh, YC_ERROR_ARGUMENT, "yarns must not be NULL");
    SPOILED(y.node_count, 1, int, YC_ERROR_ARGUMENT, "yarns.node_count = 1 must be at least 2");
    SPOILED(y.yarn_count, 0, int, YC_ERROR_ARGUMENT, "yarns.yarn_count = 0 must be at least 1");
    SPOILED(y.material_count, 0, int, YC_ERROR_ARGUMENT, "yarns.material_count = 0 must be at least 1");
    SPOILED(y.visit_u, NULL, double *, YC_ERROR_ARGUMENT,
        "yarns: only triangle, weights, visit_height, visit_turn and owner may be NULL");
    SPOILED(y.triangle, NULL, int *, YC_ERROR_ARGUMENT, "yarns.triangle and weights must not be NULL with a mesh");
    SPOILED(y.materials[0].stretch, -1.0, double, YC_ERROR_ARGUMENT,
        "yarns.materials[0].stretch = -1 must be greater than 0");
    SPOILED(y.layout[5][1], HUGE_VAL, double, YC_ERROR_ARGUMENT, "yarns.layout[5][1] = inf must lie in -1e6 .. 1e6");
    SPOILED(y.layout[5][1], -1e7, double, YC_ERROR_ARGUMENT, "yarns.layout[5][1] = -1e+07 must lie in -1e6 .. 1e6");
    SPOILED(y.triangle[5], 2, int, YC_ERROR_ARGUMENT, "yarns.triangle[5] = 2 must lie in 0 .. 1");
    SPOILED(y.weights[5][0], HUGE_VAL, double, YC_ERROR_ARGUMENT, "yarns.weights[5][0] = inf must be finite");
    y.weights[5][0] += 0.5;
    CHECK_RESULT(yc_yarns_check(&y, &mesh, NULL), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_yarns_check(&y, NULL, NULL), YC_OK);
    y.weights[5][0] -= 0.5;
    SPOILED(y.yarn_first[0], 1, int, YC_ERROR_ARGUMENT, "yarns.yarn_first[0] = 1 must be 0");
    SPOILED(
        y.yarn_first[2], 7, int, YC_ERROR_ARGUMENT, "yarns.yarn_first[2] = 7 must lie in 8 .. 48 (two visits or more)");
    SPOILED(y.yarn_first[8], 47, int, YC_ERROR_ARGUMENT, "yarns.yarn_first[8] = 47 must be visit_count, 48");
    SPOILED(y.yarn_family[1], 3, unsigned char, YC_ERROR_ARGUMENT, "yarns.yarn_family[1] = 3 must lie in 0 .. 2");
    SPOILED(y.yarn_material[1], 3, int, YC_ERROR_ARGUMENT, "yarns.yarn_material[1] = 3 must lie in 0 .. 2");
    SPOILED(y.visit_node[9], 32, int, YC_ERROR_ARGUMENT, "yarns.visit_node[9] = 32 must lie in 0 .. 31");
    SPOILED(y.visit_u[9], HUGE_VAL, double, YC_ERROR_ARGUMENT, "yarns.visit_u[9] = inf must lie in -1e6 .. 1e6");
    SPOILED(y.visit_u[9], 0.0, double, YC_ERROR_TOPOLOGY,
        "yarns.visit_u[9] = 0 must be at least 1e-9 greater than the 0.00375 before it");
    SPOILED(y.visit_u[9], y.visit_u[8] + 1e-10, double, YC_ERROR_TOPOLOGY,
        "yarns.visit_u[9] = 0.0037500001 must be at least 1e-9 greater than the 0.00375 before it");
    SPOILED(y.visit_held[9], 3, unsigned char, YC_ERROR_ARGUMENT, "yarns.visit_held[9] = 3 must lie in 0 .. 2");
    SPOILED(y.visit_layer[9], 2, signed char, YC_ERROR_ARGUMENT, "yarns.visit_layer[9] = 2 must lie in -1 .. 1");
    SPOILED(y.visit_node[2], y.visit_node[1], int, YC_ERROR_TOPOLOGY,
        "yarns.visit_node[2] = 0: the same node twice in a row");
    SPOILED(y.visit_node[5], y.visit_node[1], int, YC_ERROR_TOPOLOGY,
        "yarns.visit_node[25] = 0: a third visit of this node");
    SPOILED(y.visit_held[6], 0, unsigned char, YC_ERROR_ARGUMENT,
        "yarns.visit_held[6] = 0 must be 1: node 18 has no other visit");
    yc_yarns_destroy(&y);
}

/* Every allocation refused_weave in turn: an ordinary result, nothing leaked, the network untouched. */
TEST(fabric_out_of_memory) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_mesh mesh;
    yc_yarns y, before;
    int n;
    clear_room();
    add_piece(4, 6, NULL, 0.01, 0.0, 0.0, 0.0, 0.0, 1);
    add_piece(3, 6, NULL, 0.01, 1.0, 0.0, 0.04, 0.0, 1);
    mesh = room_mesh();
    memset(&y, 7, sizeof y);
    before = y;
    for (n = 0; n < 1000; n++) {
        yc_host host = test_host_failing(n);
        char message[YC_MESSAGE_SIZE];
        yc_result result = yc_weave(&host, &d, &mesh, &y, message);
        if (result == YC_OK) break;
        CHECK(test_refused_memory(result, message) && memcmp(&y, &before, sizeof y) == 0);
    }
    CHECK(n > 20 && n < 1000 && test_heap.live == 1);
    check_weave(&y, &mesh, 0.0);
    yc_yarns_destroy(&y);
    CHECK(test_heap.live == 0 && test_heap.bytes == 0);
}

TEST(fabric_material) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_triangle_material m;
    d.spacing[0] = 1e-3, d.spacing[1] = 3e-3;
    d.warp.stretch = 40.0, d.weft.stretch = 60.0, d.warp.shear = 1e-3, d.weft.shear = 3e-3;
    d.warp.bending = 2e-9, d.weft.bending = 6e-9, d.warp.density = 1e-5, d.weft.density = 3e-5;
    m = yc_weave_material(&d);
    CHECK_NEAR(m.stretch[0], 60.0 / 3e-3, 1e-9);
    CHECK_NEAR(m.stretch[1], 40.0 / 1e-3, 1e-9);
    CHECK_NEAR(m.shear, 4.0 * 2e-3 * 2e-3 / 3e-6, 1e-12);
    CHECK_NEAR(m.bending, 2e-6, 1e-18);
    CHECK_NEAR(m.density, 0.02, 1e-15);
    CHECK(m.coupling == 0.0);
    m = yc_triangle_material_default();
    CHECK(m.stretch[0] == 2000.0 && m.stretch[1] == 2000.0 && m.density == 0.12);
    CHECK(m.shear == 60.0 && m.bending == 8e-6);
}

/* Warps of two colours, 2 and 1; wefts of one. */
TEST(fabric_orders) {
    static const int order[3] = {1, 1, 0}, lines[3] = {2, 0, 1};
    yc_yarn_material colours[2] = {yc_yarn_material_default(), yc_yarn_material_default()};
    yc_weave_desc d = yc_weave_desc_default();
    yc_triangle_material m;
    yc_yarns y;
    int i;
    colours[0].density = 20e-6, colours[1].density = 50e-6, colours[1].stretch = 80.0;
    d.size[0] = d.size[1] = 0.025;
    d.material_count = 2, d.materials = colours, d.order[YC_WARP] = order, d.order_count[YC_WARP] = 3;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    CHECK(y.material_count == 5 && y.materials[2].density == 30e-6 && y.materials[4].density == 50e-6);
    for (i = 0; i < 20; i++) CHECK(y.yarn_material[i] == (i < 10 ? 3 + order[i % 3] : YC_WEFT));
    yc_yarns_destroy(&y);
    m = yc_weave_material(&d);
    CHECK_NEAR(m.density, (40e-6 + 15e-6) / 2.5e-3, 1e-15);
    CHECK_NEAR(m.stretch[1], 70.0 / 2.5e-3, 1e-9);
    CHECK_NEAR(m.stretch[0], 50.0 / 2.5e-3, 1e-9);
    d.grain = 0.5 * YCI_PI; /* lines with negative numbers: -1 is the last of the order */
    d.rod.density = 0.0;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    CHECK(y.material_count == 4 && count_family(&y, YC_WARP) == 10);
    for (i = 0; i < y.yarn_count; i++) {
        int line = (int)floor(y.layout[y.visit_node[y.yarn_first[i]]][1] / 2.5e-3);
        if (y.yarn_family[i] == YC_WARP) CHECK(y.yarn_material[i] == 2 + order[line % 3]);
    }
    yc_yarns_destroy(&y);
    d.grain = -0.5 * YCI_PI;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    for (i = 0; i < y.yarn_count; i++) {
        int line = (int)floor(y.layout[y.visit_node[y.yarn_first[i]]][1] / 2.5e-3);
        if (y.yarn_family[i] == YC_WARP) CHECK(y.yarn_material[i] == 2 + order[lines[line % 3]]);
    }
    yc_yarns_destroy(&y);
    d.material_count = 0; /* orders are not looked at */
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    CHECK(y.material_count == 2 && y.yarn_material[0] == YC_WARP);
    yc_yarns_destroy(&y);
}

/* The energies of a swatch of 40 mm, stretched (kind 0), sheared (1) or rolled up (2). */
static void deformed_energy(int bundle, int kind, double terms[YC_TERM_COUNT]) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene *scene;
    yc_yarns y;
    double(*place)[3];
    int i, handle;
    d.spacing[0] = d.spacing[1] = 1e-3, d.size[0] = d.size[1] = 0.04, d.bundle = bundle;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    place = (double(*)[3])calloc((size_t)y.node_count, sizeof *place);
    for (i = 0; i < y.node_count; i++) {
        const double *x = y.layout[i];
        double turn = 20.0 * x[0];
        place[i][0] = kind == 0 ? 1.01 * x[0] : kind == 1 ? x[0] + 0.3 * x[1] : sin(turn) / 20.0;
        place[i][1] = x[1], place[i][2] = kind == 2 ? cos(turn) / 20.0 : 0.0;
    }
    cloth.yarns = &y, cloth.yarn_positions = (const double(*)[3])place;
    if (CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK)) {
        CHECK_RESULT(yc_scene_add_cloth(scene, &cloth, &handle), YC_OK);
        CHECK_RESULT(yc_scene_energy(scene, terms), YC_OK);
        yc_scene_destroy(scene);
    }
    free(place);
    yc_yarns_destroy(&y);
}

/* Bundles of four store what single yarns do, stretched, sheared, bent, pressed together; and weigh as much. */
TEST(fabric_bundle) {
    static const yc_term terms[3] = {YC_TERM_STRETCH, YC_TERM_SHEAR, YC_TERM_BENDING};
    double close[2] = {0.0, 0.7e-3}, closer[2] = {0.0, 2.8e-3};
    yc_yarn_material m = yc_yarn_material_default();
    yc_weave_desc d = yc_weave_desc_default();
    yc_yarns y;
    int kind;
    for (kind = 0; kind < 3; kind++) {
        double single[YC_TERM_COUNT], bundled[YC_TERM_COUNT];
        deformed_energy(1, kind, single), deformed_energy(4, kind, bundled);
        CHECK(single[terms[kind]] > 0.0);
        CHECK_NEAR(bundled[terms[kind]] / single[terms[kind]], 1.0, kind == 0 ? 1e-9 : 0.1); /* ends do not bend */
        CHECK_NEAR(bundled[YC_TERM_GRAVITY], single[YC_TERM_GRAVITY],
            (kind == 2 ? 1e-2 : 1e-9) * fabs(single[YC_TERM_GRAVITY]));
    }
    CHECK_NEAR(
        yci_yarn_contact(closer, 4.0, 4e-3, NULL, NULL), 16.0 * yci_yarn_contact(close, 1.0, 1e-3, NULL, NULL), 1e-15);
    d.bundle = 3, d.size[0] = d.size[1] = 0.075, d.warp.preload = 0.01, d.warp.strength = 2.0;
    d.warp.flattening = 700.0;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
    CHECK(y.yarn_count == 20 && y.materials[2].density == d.rod.density);
    CHECK_NEAR(y.materials[0].slide, 9.0 * m.slide, 1e-9);
    CHECK_NEAR(y.materials[0].preload, 0.09, 1e-15);
    CHECK_NEAR(y.materials[0].crimp_bending, 27.0 * m.crimp_bending, 1e-20);
    CHECK_NEAR(y.materials[0].strength, 6.0, 1e-15);
    CHECK(y.materials[0].flattening == d.warp.flattening && d.warp.flattening > 0.0);
    CHECK(y.materials[0].bundle == 3.0 && y.materials[2].bundle == 1.0 && m.bundle == 1.0);
    CHECK(y.materials[0].friction == m.friction && y.materials[0].shear_limit == m.shear_limit);
    yc_yarns_destroy(&y);
}

static void yarn_refused(const yc_yarn_desc *d, const char *expected) {
    yc_yarn_material m, before;
    char message[YC_MESSAGE_SIZE];
    memset(&m, 7, sizeof m);
    before = m;
    CHECK_RESULT(yc_yarn_material_make(d, &m, message), YC_ERROR_ARGUMENT);
    CHECK_TEXT(message, expected);
    CHECK(!memcmp(&m, &before, sizeof m));
}

/* Peirce's diameters, and the bending of free fibres, from the books. */
TEST(fabric_yarn_material) {
    static const double diameter[3] = {0.0374e-3, 0.036e-3, 0.043e-3}; /* cotton, linen, wool: m per root of tex */
    yc_yarn_desc d = yc_yarn_desc_default();
    yc_yarn_material m;
    char message[YC_MESSAGE_SIZE];
    int f;
    for (f = 0; f < YC_FIBRE_COUNT; f++) {
        yc_yarns y;
        yc_weave_desc weave = yc_weave_desc_default();
        d.fibre = (yc_fibre)f, d.tex = 49.0;
        if (!CHECK_RESULT(yc_yarn_material_make(&d, &m, message), YC_OK)) return;
        CHECK_TEXT(message, "");
        CHECK_NEAR(m.density, 49e-6, 1e-18);
        if (f < 3) CHECK_NEAR(2.0 * m.radius, 7.0 * diameter[f], 0.01 * 7.0 * diameter[f]);
        CHECK(m.strength > 0.01 * m.stretch && m.strength < 0.2 * m.stretch); /* yarns break at some percent */
        CHECK(m.crimp_bending == m.bending);
        weave.warp = weave.weft = m;
        if (CHECK_RESULT(yc_weave(NULL, &weave, NULL, &y, message), YC_OK)) yc_yarns_destroy(&y);
    }
    d = yc_yarn_desc_default(), d.bending_factor = 1.0, d.fibre_tex = 0.17;
    CHECK_RESULT(yc_yarn_material_make(&d, &m, NULL), YC_OK);
    CHECK_NEAR(m.bending, 15.0 * 0.17 * 0.53e-9, 1e-18);
    CHECK_NEAR(m.stretch, 50.0, 1.0);
    d.fibre_tex = 15.0, d.bending_factor = 0.0; /* a single filament */
    CHECK_RESULT(yc_yarn_material_make(&d, &m, NULL), YC_OK);
    CHECK_NEAR(m.bending, 225.0 * 0.53e-9, 1e-16);
    d.packing = 1.0;
    CHECK_RESULT(yc_yarn_material_make(&d, &m, NULL), YC_OK);
    CHECK_NEAR(YCI_PI * m.radius * m.radius * 1520.0, 15e-6, 1e-15);
    CHECK_RESULT(yc_yarn_material_make(&d, NULL, message), YC_ERROR_ARGUMENT);
    CHECK_TEXT(message, "desc and out must not be NULL");
    d = yc_yarn_desc_default(), d.cookie = 0;
    yarn_refused(&d, "yarn.cookie: not made by yc_yarn_desc_default()");
    d = yc_yarn_desc_default(), d.fibre = YC_FIBRE_COUNT;
    yarn_refused(&d, "yarn.fibre = 6 must lie in 0 .. 5");
    d = yc_yarn_desc_default(), d.tex = 0.0;
    yarn_refused(&d, "yarn.tex = 0 must lie in (0, 1e5]");
    d.tex = HUGE_VAL;
    yarn_refused(&d, "yarn.tex = inf must lie in (0, 1e5]");
    d = yc_yarn_desc_default(), d.fibre_tex = 16.0;
    yarn_refused(&d, "yarn.fibre_tex = 16 must lie in [0, 15]");
    d = yc_yarn_desc_default(), d.packing = 1.5;
    yarn_refused(&d, "yarn.packing = 1.5 must lie in [0, 1]");
    d = yc_yarn_desc_default(), d.fibre_tex = 1.0, d.bending_factor = 20.0;
    yarn_refused(&d, "yarn.bending_factor = 20 must be 0 or lie in [1, 15]");
}

/* The fabrics weigh, bend and shear as such fabrics do. */
TEST(fabric_presets) {
    yc_fabric fabric, before;
    yc_draft satin, twill;
    int i, f;
    memset(&satin, 0, sizeof satin), memset(&twill, 0, sizeof twill);
    for (i = 0; i < YC_FABRIC_COUNT; i++) {
        double mass;
        if (!CHECK_RESULT(yc_fabric_get((yc_fabric_name)i, &fabric), YC_OK)) return;
        CHECK(fabric.name && fabric.source && fabric.woven == (i <= YC_FABRIC_SATIN));
        mass = fabric.wales * fabric.courses * fabric.loop * fabric.yarn.density;
        if (fabric.woven) {
            yc_weave_desc *d = &fabric.weave;
            yc_triangle_material m = yc_weave_material(d);
            yc_yarns y;
            mass = m.density;
            CHECK(m.shear >= fabric.shear[0] && m.shear <= fabric.shear[1]);
            for (f = 0; f < 2; f++) {
                double bending = (f ? d->weft : d->warp).bending / d->spacing[f];
                CHECK(bending >= fabric.bending[f][0] && bending <= fabric.bending[f][1]);
                CHECK(fabric.extension[f] > 0.0 && fabric.hysteresis[f] > 0.0 && fabric.tension == 490.0);
            }
            d->size[0] = d->size[1] = 0.01;
            if (CHECK_RESULT(yc_weave(NULL, d, NULL, &y, NULL), YC_OK)) yc_yarns_destroy(&y);
        } else {
            yc_yarns y;
            CHECK_RESULT(yc_weave(NULL, &fabric.weave, NULL, &y, NULL), YC_ERROR_ARGUMENT);
        }
        CHECK(mass >= fabric.mass[0] && mass <= fabric.mass[1]);
    }
    if (!CHECK_RESULT(yc_draft_satin(NULL, 5, 2, YC_WARP, &satin, NULL), YC_OK)) return;
    if (!CHECK_RESULT(yc_draft_twill(NULL, 3, 1, 'Z', &twill, NULL), YC_OK)) return;
    yc_fabric_get(YC_FABRIC_SATIN, &fabric);
    CHECK(fabric.weave.repeat[0] == 5 && !memcmp(fabric.weave.draft, satin.over, 25));
    yc_fabric_get(YC_FABRIC_DENIM, &fabric);
    CHECK(fabric.weave.repeat[1] == 4 && !memcmp(fabric.weave.draft, twill.over, 16));
    CHECK(fabric.weave.warp.density == 84e-6 && fabric.weave.weft.density == 75e-6);
    yc_draft_destroy(&satin), yc_draft_destroy(&twill);
    before = fabric;
    CHECK_RESULT(yc_fabric_get(YC_FABRIC_COUNT, &fabric), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_fabric_get((yc_fabric_name)-1, &fabric), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_fabric_get(YC_FABRIC_RIB, NULL), YC_ERROR_ARGUMENT);
    CHECK(!memcmp(&fabric, &before, sizeof fabric));
}
