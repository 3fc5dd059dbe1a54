#include "pieces.h"
#include <math.h>
#include <stdlib.h>

scene_piece *scene_piece_new(int vertices, int uvs, int triangles) {
    scene_piece *p = (scene_piece *)calloc(1, sizeof *p);
    if (!p) return NULL;
    p->positions = (double(*)[3])calloc((size_t)vertices, sizeof *p->positions);
    p->uv = (double(*)[2])calloc((size_t)uvs, sizeof *p->uv);
    p->triangles = (int(*)[3])calloc((size_t)triangles, sizeof *p->triangles);
    p->uv_triangles = (int(*)[3])calloc((size_t)triangles, sizeof *p->uv_triangles);
    if (!p->positions || !p->uv || !p->triangles || !p->uv_triangles) {
        scene_piece_free(p);
        return NULL;
    }
    p->mesh.vertex_count = vertices, p->mesh.uv_count = uvs, p->mesh.triangle_count = triangles;
    p->mesh.positions = (const double(*)[3])p->positions, p->mesh.uv = (const double(*)[2])p->uv;
    p->mesh.triangles = (const int(*)[3])p->triangles, p->mesh.uv_triangles = (const int(*)[3])p->uv_triangles;
    return p;
}

void scene_piece_free(scene_piece *p) {
    if (!p) return;
    free(p->positions), free(p->uv), free(p->triangles), free(p->uv_triangles), free(p);
}

double scene_piece_area(const scene_piece *p) {
    double area = 0.0;
    int i;
    for (i = 0; i < p->mesh.triangle_count; i++) {
        const int *t = p->uv_triangles[i];
        const double *a = p->uv[t[0]], *b = p->uv[t[1]], *c = p->uv[t[2]];
        area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
    }
    return area;
}

/* Rings of 6 k vertices about the middle. */
scene_piece *scene_piece_disc(double radius, int rings) {
    int count = 1 + 3 * rings * (rings + 1), ring, side, k, c, t = 0;
    scene_piece *p = scene_piece_new(count, count, 6 * rings * rings);
    if (!p) return NULL;
    for (ring = 1; ring <= rings; ring++)
        for (k = 0; k < 6 * ring; k++) {
            int v = 1 + 3 * ring * (ring - 1) + k;
            double angle = 2.0 * 3.14159265358979323846 * k / (6 * ring);
            p->uv[v][0] = p->positions[v][0] = radius * ring / rings * cos(angle);
            p->uv[v][1] = p->positions[v][1] = radius * ring / rings * sin(angle);
        }
    for (ring = 1; ring <= rings; ring++) {
        int inner = ring > 1 ? 1 + 3 * (ring - 1) * (ring - 2) : 0, outer = 1 + 3 * ring * (ring - 1);
        for (side = 0; side < 6; side++)
            for (k = 0; k < ring; k++) {
                int a = ring > 1 ? inner + (side * (ring - 1) + k) % (6 * (ring - 1)) : 0;
                int b = outer + (side * ring + k) % (6 * ring), d = outer + (side * ring + k + 1) % (6 * ring);
                p->triangles[t][0] = a, p->triangles[t][1] = b, p->triangles[t++][2] = d;
                if (k + 1 == ring) continue;
                p->triangles[t][0] = a, p->triangles[t][1] = d;
                p->triangles[t++][2] = inner + (side * (ring - 1) + k + 1) % (6 * (ring - 1));
            }
    }
    for (k = 0; k < t; k++)
        for (c = 0; c < 3; c++) p->uv_triangles[k][c] = p->triangles[k][c];
    return p;
}

/* Columns of vertices from left to right. Behind column `seam` the pattern begins anew, far off; -1: nowhere. */
static scene_piece *grid(double width, double height, int n, int seam) {
    int rows = n + 1, i, j, c, t = 0, apart = seam >= 0;
    scene_piece *p = scene_piece_new(rows * rows, rows * (rows + apart), 2 * n * n);
    if (!p) return NULL;
    for (i = 0; i <= n + apart; i++)
        for (j = 0; j <= n; j++) {
            int column = apart && i > seam ? i - 1 : i;
            p->uv[i * rows + j][0] = width * column / n + (i > column ? 2.0 * width : 0.0);
            p->uv[i * rows + j][1] = height * j / n;
            p->positions[column * rows + j][0] = width * column / n;
            p->positions[column * rows + j][1] = height * j / n;
        }
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++, t += 2) {
            int corner[4], flip = (i + j) % 2, jump = apart && i >= seam ? rows : 0;
            corner[0] = i * rows + j, corner[1] = corner[0] + rows, corner[2] = corner[1] + 1,
            corner[3] = corner[0] + 1;
            for (c = 0; c < 3; c++) {
                p->triangles[t][c] = corner[(flip + c) % 4], p->triangles[t + 1][c] = corner[(flip + 2 + c) % 4];
                p->uv_triangles[t][c] = p->triangles[t][c] + jump;
                p->uv_triangles[t + 1][c] = p->triangles[t + 1][c] + jump;
            }
        }
    return p;
}

scene_piece *scene_piece_rectangle(double width, double height, int n) { return grid(width, height, n, -1); }

scene_piece *scene_piece_halves(double width, double height, int n) { return grid(width, height, n, n / 2); }
