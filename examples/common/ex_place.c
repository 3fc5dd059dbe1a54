#include "ex_place.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define EX_PI 3.14159265358979323846

/* The body's axis leans: `up` runs from the hips' middle to the chest's, `ahead` is perpendicular to it. */
typedef struct frame {
    double origin[3], up[3], ahead[3];
} frame;

/* Half of the closed curve round the torso: heading angle at equal steps of arc length, from front centre to back. */
typedef struct ring {
    frame frame;
    double *heading;
    int count;
    double step, length;
    double front, back; /* how far ahead and behind of the axis the curve starts and ends */
} ring;

enum { TERMS = 6, DIRECTIONS = 256 };

/* How far the pieces stay away from the body, m. */
static const double CLEAR = 0.008;

static double smooth_step(double low, double high, double x) {
    double t = (x - low) / (high - low);
    t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    return t * t * (3.0 - 2.0 * t);
}

static double distance3(const double a[3], const double b[3]) {
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

static int of_torso(const char *name) {
    return !strncmp(name, "bust", 4) || !strncmp(name, "buttock", 7) || !strncmp(name, "thigh", 5);
}

/* How far the torso between two heights reaches in a direction (the support function). */
static double torso_support(const ex_body *body, const double n[3], double low, double high) {
    double best = -1e9, q = body->exponent / (body->exponent - 1.0), reach;
    int i, end;
    for (i = 0; i < body->section_count; i++) {
        const ex_section *s = &body->sections[i];
        if (s->y < low || s->y > high) continue;
        reach = n[1] * s->y + n[2] * s->centre_z;
        reach += pow(pow(s->half_width * fabs(n[0]), q) + pow(s->half_depth * fabs(n[2]), q), 1.0 / q);
        best = fmax(best, reach);
    }
    for (i = 0; i < body->cone_count; i++) {
        const ex_cone *c = &body->cones[i];
        for (end = 0; of_torso(c->name) && end < 2; end++) {
            const double *p = end ? c->b : c->a;
            reach = n[0] * p[0] + n[1] * p[1] + n[2] * p[2] + (end ? c->rb : c->ra);
            if (p[1] >= low && p[1] <= high) best = fmax(best, reach);
        }
    }
    return best;
}

static double middle_depth(const ex_body *body, double low, double high) {
    static const double ahead[3] = {0.0, 0.0, 1.0}, behind[3] = {0.0, 0.0, -1.0};
    return 0.5 * (torso_support(body, ahead, low, high) - torso_support(body, behind, low, high));
}

static void make_frame(const ex_body *body, frame *f) {
    double chest = middle_depth(body, 1.14, 1.30), hips = middle_depth(body, 0.80, 0.94),
           lean = (chest - hips) / (1.22 - 0.87);
    double size = sqrt(1.0 + lean * lean);
    memset(f, 0, sizeof *f);
    f->origin[1] = 1.22;
    f->origin[2] = chest;
    f->up[1] = f->ahead[2] = 1.0 / size;
    f->up[2] = lean / size;
    f->ahead[1] = -lean / size;
}

/* The torso's support function, smoothed by a short cosine series and pushed out so that it still holds everything,
 * is a smooth convex curve whose radius of curvature is h + h'': it can be walked by arc length. */
static int make_ring(const ex_body *body, ring *r, double low, double high, double clearance, double wanted) {
    double h[DIRECTIONS + 1], series[TERMS], deficit = 0.0, length, ahead;
    int i, k;
    make_frame(body, &r->frame);
    for (i = 0; i <= DIRECTIONS; i++) {
        double angle = EX_PI * i / DIRECTIONS, n[3];
        for (k = 0; k < 3; k++) n[k] = cos(angle) * r->frame.ahead[k] + (k == 0 ? sin(angle) : 0.0);
        h[i] = torso_support(body, n, low, high);
        for (k = 0; k < 3; k++) h[i] -= n[k] * r->frame.origin[k];
    }
    for (k = 0; k < TERMS; k++) {
        series[k] = 0.0;
        for (i = 0; i <= DIRECTIONS; i++)
            series[k] += (i == 0 || i == DIRECTIONS ? 0.5 : 1.0) * h[i] * cos(k * EX_PI * i / DIRECTIONS) / DIRECTIONS;
        series[k] *= (k ? 2.0 : 1.0) * exp(-0.02 * k * k);
    }
    for (i = 0; i <= DIRECTIONS; i++) {
        double sum = 0.0;
        for (k = 0; k < TERMS; k++) sum += series[k] * cos(k * EX_PI * i / DIRECTIONS);
        deficit = fmax(deficit, h[i] - sum);
    }
    /* Half the length is pi times the mean support, whatever the other terms are. */
    series[0] += fmax(deficit + clearance, wanted / EX_PI - series[0]);
    length = EX_PI * series[0];
    r->count = 1000;
    r->step = length / r->count;
    r->length = length;
    r->heading = (double *)malloc((size_t)(r->count + 1) * sizeof *r->heading);
    if (!r->heading) return 0;
    r->front = r->back = 0.0;
    for (k = 0; k < TERMS; k++) {
        r->front += series[k];
        r->back += k % 2 ? -series[k] : series[k];
    }
    ahead = 0.0;
    for (i = 0; i <= r->count; i++) {
        double radius = 0.0;
        r->heading[i] = ahead;
        for (k = 0; k < TERMS; k++) radius += series[k] * (1 - k * k) * cos(k * ahead);
        ahead = fmin(EX_PI, ahead + r->step / fmax(radius, 0.02));
    }
    return 1;
}

/* One body piece: where its vertices go for a given height of the pattern's origin and lean of the shoulder. */
typedef struct sheet {
    int back;
    double height;              /* of the pattern's y = 0, along the frame, if the sheet hung straight */
    double lean;                /* heading of the shoulder edge from upright, radians */
    double bend_low, bend_high; /* pattern y where it starts to lean and where it leans fully */
    double underarm;
} sheet;

static void sheet_point(const ring *r, const sheet *s, const double uv[2], double out[3]) {
    enum { STEPS = 48 };
    double u = fabs(uv[0]), x = 0.0, depth = 0.0, rise, inwards = 0.0, over = 0.0, open, start, side, ahead;
    int i, k, steps = (int)(u / r->step);
    open = 1.0 - 0.9 * smooth_step(s->underarm - 0.03, s->underarm + 0.14, uv[1]);
    for (i = 0; i <= steps; i++) {
        int at = s->back ? r->count - i : i;
        double turn = open * (s->back ? EX_PI - r->heading[at] : r->heading[at]);
        double part = i < steps ? r->step : u - steps * r->step;
        x += part * cos(turn);
        depth += part * sin(turn);
    }
    rise = fmin(uv[1], s->bend_low);
    start = rise;
    for (i = 0; i < STEPS && uv[1] > start; i++) {
        double part = (uv[1] - start) / STEPS, v = start + (i + 0.5) * part;
        over = s->lean * smooth_step(s->bend_low, s->bend_high, v);
        rise += part * cos(over);
        inwards += part * sin(over);
    }
    over = uv[1] > start ? s->lean * smooth_step(s->bend_low, s->bend_high, uv[1]) : 0.0;
    rise += s->height - depth * sin(over);
    inwards += depth * cos(over);
    side = s->back ? -1.0 : 1.0;
    ahead = side * ((s->back ? r->back : r->front) - inwards);
    for (k = 0; k < 3; k++) out[k] = r->frame.origin[k] + rise * r->frame.up[k] + ahead * r->frame.ahead[k];
    out[0] += (uv[0] < 0.0 ? -side : side) * x;
}

/* Smallest distance from the body of a piece between two heights of the pattern; ends early below `enough`. */
static double sheet_clearance(const ring *r, const sheet *s, const ex_body *body, const ex_piece *piece,
    const double (*uv)[2], double low, double high, double enough) {
    double least = 1e9;
    int i;
    for (i = piece->first_vertex; i < piece->first_vertex + piece->vertex_count && least >= enough; i++) {
        double p[3];
        if (uv[i][1] < low || uv[i][1] > high) continue;
        sheet_point(r, s, uv[i], p);
        least = fmin(least, ex_body_distance(body, p));
    }
    return least;
}

/* The armhole's lower end: the highest vertex of the side edge; a third of the piece when it has no such edge. */
static double underarm_height(const ex_pattern *pattern, int piece, const double (*uv)[2]) {
    double best = -1e9;
    int e, k;
    for (e = 0; e < pattern->edge_count; e++)
        if (pattern->edges[e].piece == piece && !strncmp(pattern->edges[e].name, "side", 4))
            for (k = 0; k < pattern->edges[e].count; k++) best = fmax(best, uv[pattern->edges[e].vertices[k]][1]);
    return best > -1e8 ? best : -0.25;
}

/* The best bend of one sheet at its height: the shoulder edge comes as near to the ridge of the shoulder as the body
 * lets it.  Returns the distance left, or a large number when nothing fits. */
static double fit_bend(const ex_body *body, const ring *r, const ex_piece *piece, const double (*uv)[2], sheet *s) {
    static const double shoulder[2] = {0.16, -0.02};
    double best = 1e9;
    sheet found = *s;
    int first, range, lean;
    for (first = 0; first < 4; first++)
        for (range = 0; range < 4; range++)
            for (lean = 0; lean <= 16; lean++) {
                double p[3], left;
                s->bend_low = s->underarm + 0.03 * first;
                s->bend_high = s->bend_low + 0.14 + 0.04 * range;
                s->lean = 0.1 * lean;
                sheet_point(r, s, shoulder, p);
                left = sqrt((p[2] - 0.012) * (p[2] - 0.012) + (p[1] - 1.40) * (p[1] - 1.40));
                if (left < best && sheet_clearance(r, s, body, piece, uv, s->underarm - 0.05, 1.0, CLEAR) >= CLEAR) {
                    best = left;
                    found = *s;
                }
            }
    *s = found;
    return best;
}

static void fit_sheets(const ex_pattern *pattern, const ex_body *body, const ring *r, const double (*uv)[2],
    sheet sheets[2], const int pieces[2]) {
    double best = 1e9;
    sheet found[2];
    int step, side;
    memcpy(found, sheets, sizeof found);
    for (step = 0; step < 26; step++) {
        double sum = 0.0;
        for (side = 0; side < 2 && sum < best; side++) {
            sheets[side].height = 1.46 - r->frame.origin[1] - 0.005 * step;
            if (pieces[side] >= 0) sum += fit_bend(body, r, &pattern->pieces[pieces[side]], uv, &sheets[side]);
        }
        if (sum < best) {
            best = sum;
            memcpy(found, sheets, sizeof found);
        }
    }
    memcpy(sheets, found, sizeof found);
}

/* A cone round the arm, wider towards the shoulder: pattern y runs up the arm, x round it, open on the side that hangs
 * down.  A flat sheet rolls into a cone without stretch: what is a circle sector in the plane closes to a turn. */
typedef struct sleeve {
    double start[3], axis[3], top[3], front[3]; /* axis away from the shoulder; `top` away from the ground */
    double radius, offset, slope;               /* at the pattern's y = 0, and its distance from the shoulder */
    double turn;                                /* -1 or 1: the way x runs round the arm */
} sleeve;

static int make_sleeve(const ex_body *body, int left, sleeve *s) {
    const ex_cone *upper = ex_body_cone(body, left ? "upper_arm_1_l" : "upper_arm_1_r");
    const ex_cone *lower = ex_body_cone(body, left ? "upper_arm_2_l" : "upper_arm_2_r");
    double size, down;
    int k;
    if (!upper || !lower) return 0;
    for (k = 0; k < 3; k++) {
        s->start[k] = upper->a[k];
        s->axis[k] = 0.6 * upper->b[k] + 0.4 * lower->b[k] - upper->a[k];
    }
    size = sqrt(s->axis[0] * s->axis[0] + s->axis[1] * s->axis[1] + s->axis[2] * s->axis[2]);
    for (k = 0; k < 3; k++) s->axis[k] /= size;
    down = s->axis[1];
    for (k = 0; k < 3; k++) s->top[k] = (k == 1) - down * s->axis[k];
    size = sqrt(s->top[0] * s->top[0] + s->top[1] * s->top[1] + s->top[2] * s->top[2]);
    for (k = 0; k < 3; k++) s->top[k] /= size;
    s->front[0] = s->axis[1] * s->top[2] - s->axis[2] * s->top[1];
    s->front[1] = s->axis[2] * s->top[0] - s->axis[0] * s->top[2];
    s->front[2] = s->axis[0] * s->top[1] - s->axis[1] * s->top[0];
    if (s->front[2] < 0.0)
        for (k = 0; k < 3; k++) s->front[k] = -s->front[k];
    /* The left sleeve is turned over: its front lies at x < 0 of the pattern. */
    s->turn = left ? -1.0 : 1.0;
    return 1;
}

static void sleeve_point(const sleeve *s, const double uv[2], double out[3]) {
    double apex = s->radius / s->slope, ray = sqrt(uv[0] * uv[0] + (apex + uv[1]) * (apex + uv[1]));
    double angle = s->turn * atan2(uv[0], apex + uv[1]) / s->slope;
    double along = s->offset - (ray - apex) * sqrt(1.0 - s->slope * s->slope);
    int k;
    for (k = 0; k < 3; k++)
        out[k] =
            s->start[k] + along * s->axis[k] + ray * s->slope * (cos(angle) * s->top[k] + sin(angle) * s->front[k]);
}

/* As close to the shoulder and the arm as the body and the pieces that lie already allow. */
static int sleeve_fits(const ex_body *body, const double (*uv)[2], const ex_piece *piece, const sleeve *s,
    const double (*placed)[3], int placed_count) {
    int i, k, fits = 1;
    for (i = piece->first_vertex; fits && i < piece->first_vertex + piece->vertex_count; i++) {
        double p[3];
        sleeve_point(s, uv[i], p);
        fits = ex_body_distance(body, p) > CLEAR;
        for (k = 0; fits && k < placed_count; k++) fits = distance3(p, placed[k]) > 0.014;
    }
    return fits;
}

static void fit_sleeve(const ex_body *body, const double (*uv)[2], const ex_piece *piece, sleeve *s,
    const double (*placed)[3], int placed_count) {
    sleeve found;
    double best = 1e9;
    int step, grow, widen;
    s->radius = 0.09;
    s->offset = 0.25;
    s->slope = 0.05;
    found = *s;
    for (widen = 0; widen < 5; widen++)
        for (grow = 0; grow < 18; grow++)
            for (step = 0; step < 26; step++) {
                s->radius = 0.054 + 0.002 * grow;
                s->offset = 0.12 + 0.005 * step;
                s->slope = 0.02 + 0.04 * widen;
                if (s->offset + 7.0 * s->radius < best && sleeve_fits(body, uv, piece, s, placed, placed_count)) {
                    best = s->offset + 7.0 * s->radius;
                    found = *s;
                }
            }
    *s = found;
}

/* What the analytic shapes stretch is let go here, and the seams draw a little closer: a few rounds that move edges to
 * their rest length, sewn pairs towards each other while they are far apart, and vertices out of the body. */
static void settle(const ex_pattern *pattern, const ex_body *body, const double (*uv)[2], double (*positions)[3]) {
    enum { ROUNDS = 150 };
    int round, i, k, axis;
    for (round = 0; round < ROUNDS; round++) {
        for (i = 0; i < pattern->pair_count && round < ROUNDS - 40; i++) {
            double *a = positions[pattern->pairs[i][0]], *b = positions[pattern->pairs[i][1]], gap = distance3(a, b);
            double move = gap > 0.06 ? 0.04 * (gap - 0.06) / gap : 0.0;
            for (axis = 0; axis < 3; axis++) {
                double d = move * (b[axis] - a[axis]);
                a[axis] += d;
                b[axis] -= d;
            }
        }
        for (i = 0; i < pattern->triangle_count; i++)
            for (k = 0; k < 3; k++) {
                int v = pattern->triangles[i][k], w = pattern->triangles[i][(k + 1) % 3];
                double *a = positions[v], *b = positions[w], now = distance3(a, b), move;
                move = 0.3 *
                    (now -
                        sqrt((uv[v][0] - uv[w][0]) * (uv[v][0] - uv[w][0]) +
                            (uv[v][1] - uv[w][1]) * (uv[v][1] - uv[w][1]))) /
                    now;
                for (axis = 0; axis < 3; axis++) {
                    double d = move * (b[axis] - a[axis]);
                    a[axis] += d;
                    b[axis] -= d;
                }
            }
        for (i = 0; i < pattern->vertex_count; i++) {
            double normal[3], d = ex_body_distance(body, positions[i]);
            if (d >= CLEAR) continue;
            ex_body_normal(body, positions[i], normal);
            for (axis = 0; axis < 3; axis++) positions[i][axis] += (CLEAR - d) * normal[axis];
        }
    }
}

static void measure(const ex_pattern *pattern, const ex_body *body, const double (*uv)[2], const double (*positions)[3],
    ex_placement *out) {
    int i, k;
    memset(out, 0, sizeof *out);
    out->clearance = out->stretch_low = 1e9;
    for (i = 0; i < pattern->vertex_count; i++)
        out->clearance = fmin(out->clearance, ex_body_distance(body, positions[i]));
    for (i = 0; i < pattern->pair_count; i++) {
        double gap = distance3(positions[pattern->pairs[i][0]], positions[pattern->pairs[i][1]]);
        out->seam_gap = fmax(out->seam_gap, gap);
        out->seam_mean += gap / pattern->pair_count;
    }
    for (i = 0; i < pattern->triangle_count; i++)
        for (k = 0; k < 3; k++) {
            int a = pattern->triangles[i][k], b = pattern->triangles[i][(k + 1) % 3];
            double rest =
                sqrt((uv[a][0] - uv[b][0]) * (uv[a][0] - uv[b][0]) + (uv[a][1] - uv[b][1]) * (uv[a][1] - uv[b][1]));
            double ratio = distance3(positions[a], positions[b]) / rest;
            out->stretch_low = fmin(out->stretch_low, ratio);
            out->stretch_high = fmax(out->stretch_high, ratio);
        }
}

/* Lays front and back first, then the sleeves outside of them. */
static int place_pieces(const ex_pattern *pattern, const ex_body *body, const double (*uv)[2], double (*positions)[3]) {
    sheet sheets[2];
    ring r;
    int pieces[2] = {-1, -1}, i, k, side, fine = 1, laid = 0;
    double half = 0.0, low = 0.0, least;
    double(*placed)[3] = (double(*)[3])malloc((size_t)(pattern->vertex_count + 1) * sizeof *placed);
    if (!placed) return 0;
    memset(sheets, 0, sizeof sheets);
    for (i = 0; i < pattern->piece_count; i++) {
        const ex_piece *piece = &pattern->pieces[i];
        double wide = 0.0;
        if (piece->place != EX_PLACE_FRONT && piece->place != EX_PLACE_BACK) continue;
        side = piece->place == EX_PLACE_BACK;
        pieces[side] = i;
        sheets[side].back = side;
        sheets[side].underarm = underarm_height(pattern, i, uv);
        sheets[side].bend_low = sheets[side].bend_high = 10.0;
        sheets[side].height = 1.41 - 1.22;
        for (k = piece->first_vertex; k < piece->first_vertex + piece->vertex_count; k++) {
            wide = fmax(wide, fabs(uv[k][0]));
            low = fmin(low, uv[k][1]);
        }
        half += wide;
    }
    /* The curve is wound once to learn how far the blends of the body reach, then with that added. */
    memset(&r, 0, sizeof r);
    for (i = 0, least = CLEAR; fine && i < 2; i++) {
        free(r.heading);
        fine = make_ring(body, &r, 1.40 + low, 1.26, 2.0 * CLEAR - least, i ? half + 0.02 : 0.0);
        for (side = 0; fine && i == 0 && side < 2; side++)
            if (pieces[side] >= 0)
                least = fmin(least,
                    sheet_clearance(&r, &sheets[side], body, &pattern->pieces[pieces[side]], uv, -10.0,
                        sheets[side].underarm - 0.05, -1.0));
    }
    if (fine) {
        fit_sheets(pattern, body, &r, uv, sheets, pieces);
        for (side = 0; side < 2; side++)
            for (k = 0; pieces[side] >= 0 && k < pattern->pieces[pieces[side]].vertex_count; k++) {
                int v = pattern->pieces[pieces[side]].first_vertex + k;
                sheet_point(&r, &sheets[side], uv[v], positions[v]);
                memcpy(placed[laid++], positions[v], sizeof placed[0]);
            }
        free(r.heading);
    }
    for (i = 0; fine && i < pattern->piece_count; i++) {
        const ex_piece *piece = &pattern->pieces[i];
        sleeve s;
        if (piece->place != EX_PLACE_SLEEVE_L && piece->place != EX_PLACE_SLEEVE_R) continue;
        fine = make_sleeve(body, piece->place == EX_PLACE_SLEEVE_L, &s);
        if (!fine) break;
        fit_sleeve(body, uv, piece, &s, (const double(*)[3])placed, laid);
        for (k = piece->first_vertex; k < piece->first_vertex + piece->vertex_count; k++)
            sleeve_point(&s, uv[k], positions[k]);
    }
    free(placed);
    return fine;
}

int ex_place_pattern(const ex_pattern *pattern, const ex_body *body, double (*positions)[3], ex_placement *placement) {
    double(*uv)[2] = (double(*)[2])calloc((size_t)pattern->vertex_count + 1, sizeof *uv);
    int fine;
    if (!uv) return 0;
    ex_pattern_vertex_uv(pattern, uv);
    memcpy(positions, pattern->positions, (size_t)pattern->vertex_count * sizeof *positions);
    fine = place_pieces(pattern, body, (const double(*)[2])uv, positions);
    if (fine) settle(pattern, body, (const double(*)[2])uv, positions);
    if (fine && placement) measure(pattern, body, (const double(*)[2])uv, (const double(*)[3])positions, placement);
    free(uv);
    return fine;
}
