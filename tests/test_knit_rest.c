/* Rest shapes of knits: the smallest repeat is in equilibrium, its gauge comes out, and pieces are laid in it. */
#include "internals.h"
#include "scenes/knits.h"
#include "scenes/pieces.h"
#include "test_scene.h"
#include <math.h>

static const char zigzag[] = /* in the round; its repeat is worked from 6 to 4 stitches and back */
    "Row 1 (RS): *k1, k2tog, k2tog, k1, repeat from *.\nRow 2 (RS): *k1, yo, k2, yo, k1, repeat from *.\n"
    "Row 3 (RS): Knit.\n";
/* never as many stitches again */
static const char wedge[] = "Row 1 (RS): k1, m1, *k1, repeat from *.\nRow 2 (WS): Purl.\n";

static int relax(const char *text, yc_chart *chart, yc_knit_desc *d, yc_knit_rest *rest) {
    char why[YC_MESSAGE_SIZE] = "";
    if (!CHECK_RESULT(yc_chart_read(NULL, text, strlen(text), NULL, chart, why), YC_OK)) return 0;
    d->chart = chart;
    if (CHECK_RESULT(yc_knit_relax(NULL, d, rest, why), YC_OK)) {
        CHECK_TEXT(why, "");
        CHECK_NEAR(rest->wales * rest->scale[0], d->wales, 1e-9 * d->wales);
        CHECK_NEAR(rest->courses * rest->scale[1], d->courses, 1e-9 * d->courses);
        d->rest = rest;
        return 1;
    }
    CHECK_TEXT(why, "");
    yc_chart_destroy(chart);
    return 0;
}

static void end(yc_chart *chart, yc_knit_rest *rest, yc_yarns *y) {
    yc_knit_rest_destroy(rest), yc_chart_destroy(chart);
    if (y) yc_yarns_destroy(y);
    CHECK(!rest->owner && rest->wales == 0.0);
}

/* Slopes and curvatures are those of the energy, in a repeat that is its own neighbour and in one with stacks; what the
 * solver leaves is without forces and lower than where it began, however it is pushed. */
static void balance(const char *text, int stitches, int rows) {
    yci_context c;
    yci_rest w;
    yc_knit_desc d = yc_knit_desc_default();
    yc_chart chart;
    uint64_t seed = 3;
    double *x, *g, *h, begin, least, force, worst = 0.0, worst_h = 0.0, largest = 0.0, largest_h = 0.0;
    int i, k, a, periodic = 0;
    if (!CHECK_RESULT(yc_chart_read(NULL, text, strlen(text), NULL, &chart, NULL), YC_OK)) return;
    d.chart = &chart, d.stitches = d.rows = d.live = 1;
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);
    if (!CHECK_RESULT(yci_rest_open(&w, &c, &d, &periodic), YC_OK) || !CHECK(periodic)) return;
    CHECK(w.cell.period[w.cell.rows - 1] == stitches && w.cell.rows == rows);
    x = (double *)malloc(4 * (size_t)w.n * sizeof *x), g = x + w.n, h = g + w.n;
    force = w.force;
    for (i = 0; i < w.n; i++) x[i] = w.x[i] + test_random(&seed, -0.02, 0.02) * w.segment;
    begin = yci_rest_energy(&w, w.x, NULL);
    CHECK(isfinite(begin) && isfinite(yci_rest_energy(&w, x, w.values)));
    for (k = 0; k < 12; k++) {
        const double step = 1e-5 * w.segment;
        double e[2], slope = 0.0, along = test_random(&seed, 0.0, 1.0);
        int pick = k < 2 ? w.n - 1 - k : (int)(along * w.n); /* width and height always */
        memset(h, 0, (size_t)w.n * sizeof *h);
        yci_rest_energy(&w, x, w.values);
        for (i = 0; i < w.n; i++) /* the column of `pick`, from the lower triangle */
            for (a = w.ptr[i]; a < w.ptr[i + 1]; a++) {
                if (w.col[a] == pick) h[i] += w.values[a];
                else if (i == pick) h[w.col[a]] += w.values[a];
            }
        slope = w.g[pick];
        memset(g, 0, (size_t)w.n * sizeof *g);
        for (a = 0; a < 2; a++) {
            double kept = x[pick];
            x[pick] = kept + (a ? step : -step);
            e[a] = yci_rest_energy(&w, x, w.values);
            for (i = 0; i < w.n; i++) g[i] += (a ? 1.0 : -1.0) * w.g[i];
            x[pick] = kept;
        }
        worst = fmax(worst, fabs((e[1] - e[0]) / (2.0 * step) - slope)), largest = fmax(largest, fabs(slope));
        for (i = 0; i < w.n; i++) {
            worst_h = fmax(worst_h, fabs(g[i] / (2.0 * step) - h[i]));
            largest_h = fmax(largest_h, fabs(h[i]));
        }
    }
    CHECK(largest > force && worst < 1e-5 * largest && worst_h < 1e-4 * largest_h);
    CHECK_RESULT(yci_rest_solve(&w), YC_OK);
    least = yci_rest_energy(&w, w.x, w.values);
    for (i = 0; i < w.n; i++) CHECK(fabs(w.g[i]) < 1e-5 * force);
    CHECK(least < begin);
    for (k = 0; k < 20; k++) {
        for (i = 0; i < w.n; i++) x[i] = w.x[i] + test_random(&seed, -1e-3, 1e-3) * w.segment;
        CHECK(yci_rest_energy(&w, x, NULL) > least);
    }
    free(x);
    yci_rest_close(&w), yc_chart_destroy(&chart);
}

TEST(knit_rest_is_in_balance) {
    balance(scene_stockinette, 1, 2);
    balance(scene_rib2, 4, 2);
    balance(scene_feather, 18, 4);
}

/* Flat, knit and purl stitches have the same loop, near Munden's: kc/kw 1.3, kw 3.8 to 4.2, kc 5.0 to 5.5, which centre
 * lines that touch fall short of. */
TEST(knit_rest_has_the_gauge_of_its_loop) {
    const char *const text[4] = {scene_stockinette, scene_garter, scene_rib, scene_rib2};
    const int stitches[4] = {1, 1, 2, 4};
    double scale[2] = {0.0, 0.0};
    int i, f;
    for (i = 0; i < 4; i++) {
        yc_knit_desc d = yc_knit_desc_default();
        yc_chart chart;
        yc_knit_rest rest;
        double kw, kc;
        if (!relax(text[i], &chart, &d, &rest)) return;
        kw = rest.wales * rest.loop, kc = rest.courses * rest.loop;
        CHECK(rest.stitches == stitches[i] && rest.rows == 2 && rest.newton < 40);
        CHECK(kc / kw > 1.3 / 1.1 && kc / kw < 1.3 * 1.1 && kw > 3.8 / 1.15 && kw < 4.2 && kc > 5.0 / 1.15 && kc < 5.5);
        for (f = 0; f < 2; f++) {
            if (i) CHECK_NEAR(rest.scale[f], scale[f], 1e-5);
            scale[f] = rest.scale[f];
        }
        end(&chart, &rest, NULL);
    }
}

/* More yarn in a stitch makes larger stitches, by as much; one twice as thick resists twenty times as much and lies the
 * same but for where it touches itself. */
TEST(knit_rest_follows_its_yarn) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_knit_rest rest[3];
    int i, f;
    for (i = 0; i < 3; i++) {
        if (i == 1) d.loop = 1.25 * rest[0].loop, d.yarn.radius *= 1.25;
        if (i == 2) d.yarn.bending *= 20.0;
        if (!CHECK_RESULT(yc_knit_relax(NULL, &d, &rest[i], NULL), YC_OK)) return;
    }
    CHECK_NEAR(rest[1].loop, 1.25 * rest[0].loop, 1e-9);
    for (f = 0; f < 2; f++) {
        CHECK_NEAR(rest[1].scale[f], 1.25 * rest[0].scale[f], 2e-3);
        CHECK_NEAR(rest[2].scale[f], rest[1].scale[f], 0.03);
    }
    for (i = 0; i < 3; i++) yc_knit_rest_destroy(&rest[i]);
}

/* Yarns that hardly stretch, hardly bend or do not resist bending at all, and gauges from 0.3 to 30 times the usual, of
 * yarn as thick as ever: lace finds its shape, and it is that of any yarn which bends easily and hardly stretches. */
TEST(knit_rest_of_any_yarn) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_knit_rest rest[7];
    yc_chart chart;
    int i, f;
    if (!CHECK_RESULT(yc_chart_read(NULL, scene_diamond, strlen(scene_diamond), NULL, &chart, NULL), YC_OK)) return;
    for (i = 0; i < 7; i++) {
        char why[YC_MESSAGE_SIZE];
        d = yc_knit_desc_default(), d.chart = &chart;
        if (i == 1) d.yarn.stretch *= 1e3;
        if (i == 2) d.yarn.bending *= 1e-3;
        if (i == 3) d.yarn.bending = 0.0;
        if (i == 4) d.yarn.bending *= 1e3;
        if (i > 4) d.wales *= i == 5 ? 0.3 : 30.0, d.courses *= i == 5 ? 0.3 : 30.0;
        CHECK_RESULT(yc_knit_relax(NULL, &d, &rest[i], why), YC_OK);
        CHECK_TEXT(why, "");
    }
    for (f = 0; f < 2; f++)
        for (i = 1; i < 4; i++) CHECK_NEAR(rest[i].scale[f], rest[0].scale[f], 5e-3);
    for (i = 0; i < 7; i++) {
        CHECK(rest[i].scale[0] > 0.5 && rest[i].scale[0] < 2.0 && rest[i].scale[1] > 0.5 && rest[i].scale[1] < 2.0);
        yc_knit_rest_destroy(&rest[i]);
    }
    yc_chart_destroy(&chart);
}

/* A laid piece's loops, from the left, `apart` stitches and rows from each other, are the same; the piece has the
 * reported gauge, turns at rest as it is laid, and neither stretches nor bends. */
static void laid(const char *text, int stitches, int rows, int round, double close) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_chart chart;
    yc_knit_rest rest;
    yci_context c;
    yci_knitter k;
    yc_yarns y;
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene_desc settings = yc_scene_desc_default();
    yc_scene *s;
    double terms[YC_TERM_COUNT], straight, worst = 0.0, far = 0.0;
    int i, j, n, f, pairs = 0, set = 0;
    d.stitches = stitches, d.rows = rows, d.round = round;
    if (!relax(text, &chart, &d, &rest)) return;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    CHECK_RESULT(yc_yarns_check(&y, NULL, NULL), YC_OK);
    for (i = 1; i + 1 < y.visit_count; i++) {
        double q[9], p[3];
        for (n = 0; n < 3; n++) yci_copy(q + 3 * n, y.layout[y.visit_node[i + n - 1]]);
        yci_sub(p, q + 3, q);
        worst = fmax(worst, fabs(y.visit_turn[i] - yci_yarn_bend_strain(q)));
        far = fmax(far, fabs(y.visit_u[i] - y.visit_u[i - 1] - yci_norm(p)));
    }
    CHECK(worst < 1e-12 && far < 1e-12);
    /* the loops behind it */
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);
    d.wales = rest.wales, d.courses = rest.courses, d.loop = 0.0;
    yci_knit_start(&k, &c, &d);
    CHECK(yci_knit_work(&k) == YC_OK && yci_knit_place(&k) == YC_OK && yci_knit_follow(&k) == YC_OK);
    yci_knit_shape(&k);
    for (i = 0, worst = 0.0; i < k.loop_count; i++) set += k.loops[i].set;
    for (i = 0; i < k.loop_count && !round; i++)
        for (j = 0; j < k.loop_count; j++) {
            const yci_knit_loop *a = &k.loops[i], *b = &k.loops[j];
            int across = b->left - a->left, up = b->row - a->row;
            if (!a->set || !b->set || i == j || across % (2 * rest.stitches) || up % rest.rows) continue;
            if (!a->old_count || a->old_count != b->old_count || abs(across) > 4 * rest.stitches || abs(up) > rest.rows)
                continue;
            for (n = 0; n < 4; n++) {
                double apart[2];
                for (f = 0; f < 2; f++) apart[f] = k.place[b->node + n][f] - k.place[a->node + n][f];
                worst = fmax(worst, fabs(apart[0] - 0.5 * across / rest.wales));
                worst = fmax(worst, fabs(apart[1] - up / rest.courses));
            }
            pairs++;
        }
    CHECK((round || pairs > stitches * rows / 8) && worst < close && set * 2 > stitches * rows);
    yci_knit_free(&k);
    /* nothing but wrapping */
    memset(settings.gravity, 0, sizeof settings.gravity);
    y.materials[0].wrap = 0.0, cloth.yarns = &y;
    s = test_scene_of(&settings, &cloth);
    if (s && CHECK_RESULT(yc_scene_energy(s, terms), YC_OK)) {
        straight = d.yarn.bending * y.visit_count / (y.visit_u[y.visit_count - 1] / y.visit_count);
        CHECK(terms[YC_TERM_STRETCH] + terms[YC_TERM_STITCH] + terms[YC_TERM_SLIDE] < 1e-9 * straight);
        CHECK(terms[YC_TERM_BENDING] < 1e-9 * straight);
    }
    yc_scene_destroy(s);
    end(&chart, &rest, &y);
}

TEST(knit_rest_is_laid) {
    laid(scene_stockinette, 9, 10, 0, 1e-9);
    laid(scene_rib2, 12, 8, 0, 1e-9);
    laid(scene_feather, 54, 12, 0, 1e-9);
    laid(scene_diamond, 33, 24, 0, 1e-9);
    laid(scene_chevron, 30, 40, 0, 1e-9);
    laid(zigzag, 24, 9, 1, 1e-9);
}

/* The same shape serves pieces of any size, and is found in the time of its repeat. */
TEST(knit_rest_of_a_large_piece) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_chart chart;
    yc_knit_rest rest;
    yc_yarns y;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    int i, f;
    d.stitches = 100, d.rows = 100;
    if (!relax(scene_stockinette, &chart, &d, &rest)) return;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    for (i = 0; i < 2 * y.node_count; i++)
        low[i % 2] = fmin(low[i % 2], y.layout[i / 2][i % 2]), high[i % 2] = fmax(high[i % 2], y.layout[i / 2][i % 2]);
    CHECK_NEAR(high[0] - low[0], 100.0 / rest.wales, 1.5 / rest.wales);
    CHECK_NEAR(high[1] - low[1], 101.0 / rest.courses, 1.5 / rest.courses);
    for (f = 0; f < 2; f++) CHECK(rest.scale[f] < 0.99);
    end(&chart, &rest, &y);
}

/* Charts without a repeat that comes to as many stitches take plain knitting's; slipped stitches, bars and rows in the
 * round have repeats. */
TEST(knit_rest_repeats) {
    static const struct {
        const char *text;
        int round, stitches, rows;
    } charts[] = {{"Row 1 (RS): k1, k3tog, yo, k1, yo, k2tog, k1.\nRow 2 (WS): Purl.\n", 0, 1, 2}, {wedge, 0, 1, 2},
        {zigzag, 1, 6, 3}, {"Row 1 (RS): Knit.\n", 1, 1, 1},
        {"Row 1 (RS): *K1, sl1, repeat from *.\nRow 2 (WS): Purl.\n", 0, 2, 2},
        {"Row 1 (RS): *K1, ktbl, repeat from *.\nRow 2 (WS): *P1, ptbl, p1, repeat from *.\n", 0, 6, 2},
        {"Row 1 (RS): *K1, m1, k2tog, k1, repeat from *.\nRow 2 (WS): Purl.\n", 0, 4, 2}};
    double kw = 0.0;
    int i, n;
    for (i = 0; i < 7; i++) {
        yc_knit_desc d = yc_knit_desc_default();
        yc_chart chart;
        yc_knit_rest rest;
        yc_yarns y;
        d.round = charts[i].round;
        if (!relax(charts[i].text, &chart, &d, &rest)) return;
        CHECK(rest.stitches == charts[i].stitches && rest.rows == charts[i].rows);
        if (!i) kw = rest.wales * rest.loop;
        if (i == 1) CHECK_NEAR(rest.wales * rest.loop, kw, 1e-6);
        for (n = 8; n < 100; n++) {
            d.stitches = n, d.rows = 6;
            if (yc_knit(NULL, &d, &y, NULL) != YC_OK) continue;
            CHECK_RESULT(yc_yarns_check(&y, NULL, NULL), YC_OK);
            yc_yarns_destroy(&y);
            break;
        }
        end(&chart, &rest, NULL);
    }
}

/* Cut from relaxed knitting, a pattern's pieces have its gauge and turn at rest as they are laid. */
TEST(knit_rest_of_a_piece) {
    scene_piece *p = scene_piece_rectangle(0.1, 0.08, 4);
    yc_knit_desc d = yc_knit_desc_default();
    yc_knit_rest rest;
    yc_chart chart;
    yc_yarns y;
    double loops;
    int i, turned = 0;
    d.mesh = &p->mesh;
    if (!relax(scene_diamond, &chart, &d, &rest)) return;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    CHECK_RESULT(yc_yarns_check(&y, d.mesh, NULL), YC_OK);
    CHECK(y.materials[0].density == d.yarn.density);
    for (i = 0; i < y.visit_count; i++) turned += y.visit_turn[i] > 0.3;
    CHECK(2 * turned > y.visit_count);
    yc_yarns_destroy(&y);
    d.chart = NULL;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return; /* plain stitches of lace's gauge */
    loops = 0.1 * 0.08 * rest.wales * rest.courses;
    CHECK_NEAR(y.contact_count / 2.0, loops, 0.1 * loops);
    end(&chart, &rest, &y);
    scene_piece_free(p);
}

TEST(knit_rest_refuses) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_knit_rest rest, kept;
    yc_yarns y;
    yc_chart chart;
    char why[YC_MESSAGE_SIZE];
    int n;
    memset(&rest, 7, sizeof rest), memset(&kept, 7, sizeof kept);
    CHECK_RESULT(yc_knit_relax(NULL, NULL, &rest, why), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_knit_relax(NULL, &d, NULL, why), YC_ERROR_ARGUMENT);
    CHECK_TEXT(why, "desc and out must not be NULL");
    d.wales = -1.0;
    CHECK_RESULT(yc_knit_relax(NULL, &d, &rest, why), YC_ERROR_ARGUMENT);
    CHECK_TEXT(why, "knit.wales = -1 must be greater than 0");
    d = yc_knit_desc_default(), d.chart = &chart;
    CHECK_RESULT(yc_chart_read(NULL, "Row 1 (RS): Knit.\n", 18, NULL, &chart, why), YC_OK);
    CHECK_RESULT(yc_knit_relax(NULL, &d, &rest, why), YC_ERROR_ARGUMENT);
    CHECK_TEXT(why, "chart: rows 1 and 1 have the same side in front, so this is worked in the round");
    CHECK(!memcmp(&rest, &kept, sizeof rest));
    yc_chart_destroy(&chart);
    CHECK_RESULT(yc_chart_read(NULL, scene_rib2, strlen(scene_rib2), NULL, &chart, why), YC_OK);
    for (n = 0; n < 400; n++) {
        yc_host host = test_host_failing(n);
        yc_result result = yc_knit_relax(&host, &d, &rest, why);
        if (result == YC_OK) break;
        CHECK(test_refused_memory(result, why) && !memcmp(&rest, &kept, sizeof rest));
    }
    CHECK(n >= 12 && n < 400 && test_heap.live == 1);
    yc_knit_rest_destroy(&rest), yc_knit_rest_destroy(NULL);
    CHECK(test_heap.live == 0 && test_heap.bytes == 0);
    d.rest = &rest, d.stitches = 8;
    CHECK_RESULT(yc_knit(NULL, &d, &y, why), YC_ERROR_ARGUMENT);
    CHECK_TEXT(why, "knit.rest: not made by yc_knit_relax()");
    yc_chart_destroy(&chart);
}
