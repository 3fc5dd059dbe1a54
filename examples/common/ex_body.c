#include "ex_body.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- A reader for the JSON that the mannequin needs -------------------------------------------------------------- */

enum { JSON_NUMBER, JSON_STRING, JSON_ARRAY, JSON_OBJECT };

typedef struct json {
    int kind, line;
    double number;
    char *string; /* a string's text */
    char *key;    /* inside an object */
    struct json *child, *next;
} json;

typedef struct parser {
    const char *path, *at;
    int line, depth;
    char *error;
} parser;

static void *json_fail(parser *p, int line, const char *what, const char *detail) {
    if (!p->error[0]) snprintf(p->error, EX_ERROR_SIZE, "%.120s:%d: %s%.40s", p->path, line, what, detail);
    return NULL;
}

static void json_free(json *j) {
    while (j) {
        json *next = j->next;
        json_free(j->child);
        free(j->string);
        free(j->key);
        free(j);
        j = next;
    }
}

static void json_skip(parser *p) {
    for (; *p->at == ' ' || *p->at == '\t' || *p->at == '\r' || *p->at == '\n'; p->at++) p->line += *p->at == '\n';
}

static char *json_text(parser *p) {
    const char *begin = ++p->at;
    char *text, *out;
    while (*p->at && *p->at != '"' && *p->at != '\n') p->at += p->at[0] == '\\' && p->at[1] ? 2 : 1;
    if (*p->at != '"') return (char *)json_fail(p, p->line, "a string does not end", "");
    text = out = (char *)malloc((size_t)(p->at - begin) + 1);
    if (!text) return (char *)json_fail(p, p->line, "out of memory", "");
    for (; begin < p->at; begin++) {
        if (*begin == '\\') begin++;
        *out++ = *begin;
    }
    *out = 0;
    p->at++;
    return text;
}

static json *json_value(parser *p);

static json *json_members(parser *p, json *j, char close) {
    json **tail = &j->child;
    p->at++;
    json_skip(p);
    while (*p->at != close) {
        char *key = NULL;
        if (close == '}') {
            key = *p->at == '"' ? json_text(p) : (char *)json_fail(p, p->line, "a key is missing", "");
            json_skip(p);
            if (key && *p->at++ != ':') json_fail(p, p->line, "':' is missing after ", key);
        }
        *tail = p->error[0] ? NULL : json_value(p);
        if (!*tail) {
            free(key);
            json_free(j);
            return NULL;
        }
        (*tail)->key = key;
        tail = &(*tail)->next;
        json_skip(p);
        if (*p->at == ',') {
            p->at++;
            json_skip(p);
        } else if (*p->at != close) {
            json_free(j);
            return (json *)json_fail(p, p->line, "',' or a closing bracket is missing", "");
        }
    }
    p->at++;
    return j;
}

static json *json_value(parser *p) {
    json *j = (json *)calloc(1, sizeof *j), *done = NULL;
    if (!j) return (json *)json_fail(p, p->line, "out of memory", "");
    json_skip(p);
    j->line = p->line;
    if (++p->depth > 64) {
        json_fail(p, p->line, "nested too deeply", "");
        free(j);
    } else if (*p->at == '{' || *p->at == '[') {
        j->kind = *p->at == '{' ? JSON_OBJECT : JSON_ARRAY;
        done = json_members(p, j, *p->at == '{' ? '}' : ']');
    } else if (*p->at == '"') {
        j->kind = JSON_STRING;
        j->string = json_text(p);
        done = j->string ? j : NULL;
        if (!done) free(j);
    } else {
        char *end;
        j->kind = JSON_NUMBER;
        j->number = strtod(p->at, &end);
        done = end > p->at ? j : (json *)json_fail(p, p->line, "a value is missing", "");
        if (!done) free(j);
        p->at = end;
    }
    p->depth--;
    return done;
}

static const json *json_get(parser *p, const json *object, const char *key, int kind) {
    const json *j;
    for (j = object->child; j; j = j->next)
        if (j->key && !strcmp(j->key, key)) {
            if (j->kind == kind) return j;
            return (const json *)json_fail(p, j->line, "a value of another type is needed for ", key);
        }
    return (const json *)json_fail(p, object->line, "missing: ", key);
}

static double json_number(parser *p, const json *object, const char *key) {
    const json *j = json_get(p, object, key, JSON_NUMBER);
    return j ? j->number : 0.0;
}

static void json_numbers(parser *p, const json *array, double *out, int count) {
    const json *j = array ? array->child : NULL;
    int k;
    for (k = 0; array && k < count; k++, j = j->next) {
        if (!j || j->kind != JSON_NUMBER) {
            json_fail(p, array->line, "too few numbers", "");
            return;
        }
        out[k] = j->number;
    }
}

static int json_count(const json *array) {
    const json *j;
    int count = 0;
    for (j = array ? array->child : NULL; j; j = j->next) count++;
    return count;
}

/* ---- Reading the body -------------------------------------------------------------------------------------------- */

static char *read_text(const char *path) {
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    size_t used = 0, room = 0;
    if (!file) return NULL;
    for (;;) {
        size_t got;
        if (used + 1 >= room) {
            char *larger = (char *)realloc(text, room = room ? 2 * room : 65536);
            if (!larger) break;
            text = larger;
        }
        got = fread(text + used, 1, room - used - 1, file);
        used += got;
        if (!got) {
            text[used] = 0;
            fclose(file);
            return text;
        }
    }
    free(text);
    fclose(file);
    return NULL;
}

static void read_sections(parser *p, ex_body *body, const json *array) {
    const json *j;
    int count = json_count(array);
    if (count < 2) {
        json_fail(p, array ? array->line : 1, "two sections are needed", "");
        return;
    }
    body->sections = (ex_section *)calloc((size_t)count, sizeof *body->sections);
    if (!body->sections) {
        json_fail(p, array->line, "out of memory", "");
        return;
    }
    for (j = array->child; j; j = j->next) {
        double row[4] = {0.0, 0.0, 0.0, 0.0};
        ex_section *s = &body->sections[body->section_count++];
        json_numbers(p, j, row, 4);
        s->y = row[0];
        s->half_width = row[1];
        s->half_depth = row[2];
        s->centre_z = row[3];
        if (s->half_width <= 0.0 || s->half_depth <= 0.0 || (body->section_count > 1 && s->y <= s[-1].y))
            json_fail(p, j->line, "sections must rise and have a size", "");
    }
}

static void read_cones(parser *p, ex_body *body, const json *array) {
    const json *j;
    int count = json_count(array);
    body->cones = (ex_cone *)calloc((size_t)(count ? count : 1), sizeof *body->cones);
    if (!body->cones) {
        json_fail(p, 1, "out of memory", "");
        return;
    }
    for (j = array ? array->child : NULL; j && !p->error[0]; j = j->next) {
        ex_cone *cone = &body->cones[body->cone_count++];
        const json *name = json_get(p, j, "name", JSON_STRING);
        snprintf(cone->name, sizeof cone->name, "%s", name ? name->string : "");
        json_numbers(p, json_get(p, j, "a", JSON_ARRAY), cone->a, 3);
        json_numbers(p, json_get(p, j, "b", JSON_ARRAY), cone->b, 3);
        cone->ra = json_number(p, j, "ra");
        cone->rb = json_number(p, j, "rb");
        if (!p->error[0] && (cone->ra <= 0.0 || cone->rb <= 0.0))
            json_fail(p, j->line, "a radius must be positive: ", cone->name);
    }
}

/* Weights of sections i - 1 .. i + 2 for a height between i and i + 1: a cubic through i and i + 1 whose slopes there
 * are those of the lines through their neighbours, so that the body shows no edges at the sections. */
static void loft_weights(const ex_section *s, int last, int i, double y, double weight[4]) {
    int before = i > 0 ? i - 1 : 0, after = i + 2 > last ? last : i + 2;
    double h = s[i + 1].y - s[i].y, t = (y - s[i].y) / h;
    double m0 = t * (1.0 - t) * (1.0 - t) * h / (s[i + 1].y - s[before].y),
           m1 = t * t * (t - 1.0) * h / (s[after].y - s[i].y);
    double rise = t * t * (3.0 - 2.0 * t);
    weight[0] = -m0;
    weight[1] = 1.0 - rise - m1;
    weight[2] = rise + m0;
    weight[3] = m1;
}

/* The section at a height between sections i and i + 1. */
static ex_section loft_section(const ex_section *s, int last, int i, double y) {
    ex_section at;
    double weight[4];
    int k;
    loft_weights(s, last, i, y, weight);
    memset(&at, 0, sizeof at);
    at.y = y;
    for (k = 0; k < 4; k++) {
        const ex_section *near = s + (i + k - 1 < 0 ? 0 : i + k - 1 > last ? last : i + k - 1);
        at.half_width += weight[k] * near->half_width;
        at.half_depth += weight[k] * near->half_depth;
        at.centre_z += weight[k] * near->centre_z;
    }
    return at;
}

/* Puts `count` sections in the place of each interval: who joins them by straight lines then sees the same body. */
static int refine_sections(ex_body *body, int count) {
    int last = body->section_count - 1, i, k;
    ex_section *fine = calloc((size_t)last * (size_t)count + 1, sizeof *fine);
    if (!fine) return 0;
    for (i = 0; i < last; i++)
        for (k = 0; k < count; k++) {
            const ex_section *s = body->sections + i;
            fine[i * count + k] = loft_section(body->sections, last, i, s->y + (s[1].y - s->y) * k / count);
        }
    fine[last * count] = body->sections[last];
    free(body->sections);
    body->sections = fine, body->section_count = last * count + 1;
    return 1;
}

int ex_body_read(ex_body *body, const char *path, char error[EX_ERROR_SIZE]) {
    parser p;
    json *root = NULL;
    const json *loft;
    char *text = read_text(path);
    memset(body, 0, sizeof *body);
    p.path = path;
    p.at = text;
    p.line = 1;
    p.depth = 0;
    p.error = error;
    error[0] = 0;
    if (!text) json_fail(&p, 0, "cannot be read", "");
    else root = json_value(&p);
    if (root && root->kind != JSON_OBJECT) json_fail(&p, root->line, "an object is needed", "");
    loft = root ? json_get(&p, root, "torso_loft", JSON_OBJECT) : NULL;
    if (loft) {
        body->exponent = json_number(&p, loft, "exponent");
        body->blend = json_number(&p, root, "smooth_union_k");
        read_sections(&p, body, json_get(&p, loft, "sections", JSON_ARRAY));
        read_cones(&p, body, json_get(&p, root, "rounded_cones", JSON_ARRAY));
        if (!error[0] && (body->exponent <= 1.0 || body->blend <= 0.0))
            json_fail(&p, loft->line, "exponent must be above 1 and smooth_union_k above 0", "");
        if (!error[0] && !refine_sections(body, 6)) json_fail(&p, loft->line, "out of memory", "");
    }
    json_free(root);
    free(text);
    if (error[0]) ex_body_free(body);
    return !error[0];
}

void ex_body_free(ex_body *body) {
    free(body->sections);
    free(body->cones);
    memset(body, 0, sizeof *body);
}

const ex_cone *ex_body_cone(const ex_body *body, const char *name) {
    int i;
    for (i = 0; i < body->cone_count; i++)
        if (!strcmp(body->cones[i].name, name)) return &body->cones[i];
    return NULL;
}

/* ---- Distance ---------------------------------------------------------------------------------------------------- */

/* f = ((x/a)^n + (z/b)^n)^(1/n) is 1 on a section's outline, so (f - 1) / |grad f| is the distance to first order. */
static double loft_distance(const ex_body *body, const double p[3]) {
    const ex_section *s = body->sections;
    int last = body->section_count - 1, i = 0;
    ex_section at;
    double y = p[1], u, v, n = body->exponent, sum, f, gx, gz, grad, side, beyond;
    y = y < s[0].y ? s[0].y : y > s[last].y ? s[last].y : y;
    while (i + 1 < last && y > s[i + 1].y) i++;
    at = loft_section(s, last, i, y);
    u = fabs(p[0]) / at.half_width;
    v = fabs(p[2] - at.centre_z) / at.half_depth;
    u = u + v < 1e-9 ? 1e-9 : u;
    gx = pow(u, n - 1.0);
    gz = pow(v, n - 1.0);
    sum = u * gx + v * gz;
    f = pow(sum, 1.0 / n);
    grad = f / sum * sqrt(gx * gx / (at.half_width * at.half_width) + gz * gz / (at.half_depth * at.half_depth));
    side = (f - 1.0) / grad;
    beyond = p[1] < s[0].y ? s[0].y - p[1] : p[1] > s[last].y ? p[1] - s[last].y : 0.0;
    if (beyond <= 0.0) /* inside, the flat ends count as well: without them the distance would jump there */
        return fmax(side, fmax(s[0].y - p[1], p[1] - s[last].y));
    return side > 0.0 ? sqrt(side * side + beyond * beyond) : beyond;
}

/* In the plane through the axis the nearest point of the slanted side belongs to the sphere whose centre lies
 * rho * slope / sqrt(1 - slope^2) behind the foot point, where slope = (ra - rb) / length. */
static double cone_distance(const ex_cone *cone, const double p[3]) {
    double axis[3], q[3], length2 = 0.0, along = 0.0, q2 = 0.0, length, slope, rho, s;
    int k;
    for (k = 0; k < 3; k++) {
        axis[k] = cone->b[k] - cone->a[k];
        q[k] = p[k] - cone->a[k];
        length2 += axis[k] * axis[k];
        along += axis[k] * q[k];
        q2 += q[k] * q[k];
    }
    length = sqrt(length2);
    if (length <= fabs(cone->ra - cone->rb)) {
        double b2 = q2 - 2.0 * along + length2;
        return cone->ra > cone->rb ? sqrt(q2) - cone->ra : sqrt(b2 > 0.0 ? b2 : 0.0) - cone->rb;
    }
    along /= length;
    slope = (cone->ra - cone->rb) / length;
    rho = sqrt(q2 > along * along ? q2 - along * along : 0.0);
    s = along - rho * slope / sqrt(1.0 - slope * slope);
    s = s < 0.0 ? 0.0 : s > length ? length : s;
    return sqrt(rho * rho + (along - s) * (along - s)) - (cone->ra - slope * s);
}

double ex_body_distance(const ex_body *body, const double p[3]) {
    double d = loft_distance(body, p);
    int i;
    for (i = 0; i < body->cone_count; i++) {
        double e = cone_distance(&body->cones[i], p), h = body->blend - fabs(d - e);
        d = d < e ? d : e;
        if (h > 0.0) d -= h * h / (4.0 * body->blend);
    }
    return d;
}

double ex_body_normal(const ex_body *body, const double p[3], double normal[3]) {
    /* Differences over a tetrahedron's corners need four evaluations and no value in the middle. */
    static const double corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    double sum = 0.0, size;
    int i, k;
    normal[0] = normal[1] = normal[2] = 0.0;
    for (i = 0; i < 4; i++) {
        double q[3], d;
        for (k = 0; k < 3; k++) q[k] = p[k] + 5e-4 * corner[i][k];
        d = ex_body_distance(body, q);
        sum += d;
        for (k = 0; k < 3; k++) normal[k] += d * corner[i][k];
    }
    size = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (k = 0; k < 3; k++) normal[k] = size > 0.0 ? normal[k] / size : k == 1;
    return 0.25 * sum;
}

/* ---- A mesh of the skin: surface nets ---------------------------------------------------------------------------- */

static void body_bounds(const ex_body *body, double low[3], double high[3]) {
    int i, k, end;
    low[0] = low[1] = low[2] = 1e9;
    high[0] = high[1] = high[2] = -1e9;
    for (i = 0; i < body->section_count; i++) {
        const ex_section *s = &body->sections[i];
        double centre[3], half[3];
        centre[0] = 0.0;
        centre[1] = s->y;
        centre[2] = s->centre_z;
        half[0] = s->half_width;
        half[1] = 0.0;
        half[2] = s->half_depth;
        for (k = 0; k < 3; k++) {
            low[k] = fmin(low[k], centre[k] - half[k]);
            high[k] = fmax(high[k], centre[k] + half[k]);
        }
    }
    for (i = 0; i < body->cone_count; i++)
        for (end = 0; end < 2; end++)
            for (k = 0; k < 3; k++) {
                const double *c = end ? body->cones[i].b : body->cones[i].a;
                double r = end ? body->cones[i].rb : body->cones[i].ra;
                low[k] = fmin(low[k], c[k] - r);
                high[k] = fmax(high[k], c[k] + r);
            }
}

typedef struct grid {
    double origin[3], h;
    int n[3]; /* points along each axis */
    float *value;
    int *vertex; /* the net's vertex in the cell above a grid point, or -1 */
} grid;

static size_t grid_at(const grid *g, int i, int j, int k) {
    return ((size_t)k * (size_t)g->n[1] + (size_t)j) * (size_t)g->n[0] + (size_t)i;
}

/* Blocks of 4 points whose middle is far from the skin keep that one value; only its sign matters. */
static void grid_sample(grid *g, const ex_body *body) {
    enum { BLOCK = 4 };
    int block[3], i, j, k;
    for (block[2] = 0; block[2] < g->n[2]; block[2] += BLOCK)
        for (block[1] = 0; block[1] < g->n[1]; block[1] += BLOCK)
            for (block[0] = 0; block[0] < g->n[0]; block[0] += BLOCK) {
                double p[3], d;
                int axis, end[3], far;
                for (axis = 0; axis < 3; axis++) {
                    end[axis] = block[axis] + BLOCK < g->n[axis] ? block[axis] + BLOCK : g->n[axis];
                    p[axis] = g->origin[axis] + g->h * (block[axis] + 0.5 * (BLOCK - 1));
                }
                d = ex_body_distance(body, p);
                far = fabs(d) > 6.0 * g->h;
                for (k = block[2]; k < end[2]; k++)
                    for (j = block[1]; j < end[1]; j++)
                        for (i = block[0]; i < end[0]; i++) {
                            p[0] = g->origin[0] + g->h * i;
                            p[1] = g->origin[1] + g->h * j;
                            p[2] = g->origin[2] + g->h * k;
                            g->value[grid_at(g, i, j, k)] = (float)(far ? d : ex_body_distance(body, p));
                        }
            }
}

/* A cell that the skin crosses gets one vertex: the mean of the crossings on its edges, then pulled onto the skin. */
static int cell_vertex(const grid *g, const ex_body *body, const int cell[3], double p[3], double normal[3]) {
    double value[8], sum[3] = {0.0, 0.0, 0.0}, d;
    int corner, axis, k, crossings = 0, step;
    for (corner = 0; corner < 8; corner++)
        value[corner] =
            (double)g->value[grid_at(g, cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2))];
    for (corner = 0; corner < 8; corner++)
        for (axis = 0; axis < 3; axis++) {
            int other = corner | 1 << axis;
            if (other == corner || (value[corner] < 0.0) == (value[other] < 0.0)) continue;
            for (k = 0; k < 3; k++) sum[k] += corner >> k & 1;
            sum[axis] += value[corner] / (value[corner] - value[other]);
            crossings++;
        }
    if (!crossings) return 0;
    for (k = 0; k < 3; k++) p[k] = g->origin[k] + g->h * (cell[k] + sum[k] / crossings);
    for (step = 0; step < 2; step++) {
        d = ex_body_normal(body, p, normal);
        for (k = 0; k < 3; k++) p[k] -= d * normal[k];
    }
    return 1;
}

static int net_vertices(grid *g, const ex_body *body, ex_mesh *mesh) {
    int cell[3], room = 0;
    for (cell[2] = 0; cell[2] + 1 < g->n[2]; cell[2]++)
        for (cell[1] = 0; cell[1] + 1 < g->n[1]; cell[1]++)
            for (cell[0] = 0; cell[0] + 1 < g->n[0]; cell[0]++) {
                double p[3], normal[3];
                size_t at = grid_at(g, cell[0], cell[1], cell[2]);
                g->vertex[at] = -1;
                if (!cell_vertex(g, body, cell, p, normal)) continue;
                if (mesh->vertex_count == room) {
                    void *a, *b;
                    room = room ? 2 * room : 4096;
                    a = realloc(mesh->positions, (size_t)room * sizeof *mesh->positions);
                    if (a) mesh->positions = (double(*)[3])a;
                    b = realloc(mesh->normals, (size_t)room * sizeof *mesh->normals);
                    if (b) mesh->normals = (double(*)[3])b;
                    if (!a || !b) return 0;
                }
                memcpy(mesh->positions[mesh->vertex_count], p, sizeof p);
                memcpy(mesh->normals[mesh->vertex_count], normal, sizeof normal);
                g->vertex[at] = mesh->vertex_count++;
            }
    return 1;
}

/* Every grid edge that the skin crosses is surrounded by four cells, whose vertices make two triangles. */
static int net_triangles(const grid *g, ex_mesh *mesh) {
    int at[3], axis, room = 2 * mesh->vertex_count + 64;
    mesh->triangles = (int(*)[3])malloc((size_t)room * sizeof *mesh->triangles);
    if (!mesh->triangles) return 0;
    for (at[2] = 1; at[2] + 1 < g->n[2]; at[2]++)
        for (at[1] = 1; at[1] + 1 < g->n[1]; at[1]++)
            for (at[0] = 1; at[0] + 1 < g->n[0]; at[0]++)
                for (axis = 0; axis < 3; axis++) {
                    int u = (axis + 1) % 3, v = (axis + 2) % 3, step[3] = {0, 0, 0}, q[4], c, inside;
                    step[axis] = 1;
                    inside = g->value[grid_at(g, at[0], at[1], at[2])] < 0.0f;
                    if (inside == (g->value[grid_at(g, at[0] + step[0], at[1] + step[1], at[2] + step[2])] < 0.0f))
                        continue;
                    for (c = 0; c < 4; c++) {
                        int cell[3];
                        memcpy(cell, at, sizeof cell);
                        cell[u] -= c == 0 || c == 3;
                        cell[v] -= c < 2;
                        q[inside ? c : 3 - c] = g->vertex[grid_at(g, cell[0], cell[1], cell[2])];
                    }
                    if (mesh->triangle_count + 2 > room) {
                        void *larger = realloc(mesh->triangles, (size_t)(room *= 2) * sizeof *mesh->triangles);
                        if (!larger) return 0;
                        mesh->triangles = (int(*)[3])larger;
                    }
                    for (c = 0; c < 2; c++) {
                        int *t = mesh->triangles[mesh->triangle_count++];
                        t[0] = q[0];
                        t[1] = q[1 + c];
                        t[2] = q[2 + c];
                    }
                }
    return 1;
}

int ex_body_mesh(const ex_body *body, double h, ex_mesh *mesh) {
    grid g;
    double low[3], high[3];
    size_t count = 1;
    int k, made;
    memset(mesh, 0, sizeof *mesh);
    body_bounds(body, low, high);
    g.h = h;
    for (k = 0; k < 3; k++) {
        g.origin[k] = low[k] - 2.5 * h - body->blend;
        g.n[k] = (int)ceil((high[k] - low[k] + 2.0 * body->blend) / h) + 6;
        count *= (size_t)g.n[k];
    }
    g.value = (float *)malloc(count * sizeof *g.value);
    g.vertex = (int *)malloc(count * sizeof *g.vertex);
    made = g.value && g.vertex;
    if (made) grid_sample(&g, body);
    made = made && net_vertices(&g, body, mesh) && net_triangles(&g, mesh);
    free(g.value);
    free(g.vertex);
    if (!made) ex_mesh_free(mesh);
    return made;
}

void ex_mesh_free(ex_mesh *mesh) {
    free(mesh->positions);
    free(mesh->normals);
    free(mesh->triangles);
    memset(mesh, 0, sizeof *mesh);
}
