/* Tests of chapter `fabric`: knitting instructions, what is drawn through what, and the networks of knits. */
#include "internals.h"
#include "test.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Row instructions of common stitches, as stitch dictionaries give them: facts, in wording of our own. Their counts
 * were checked for one, two and five repeats. */
static const char all_charts[] =
    "pattern: Stockinette\n"
    "multiple: 1 + 0\n"
    "sure: yes\n"
    "Row 1 (RS): Knit.\n"
    "Row 2 (WS): Purl.\n"
    "\n"
    "pattern: Reverse stockinette\n"
    "multiple: 1 + 0\n"
    "sure: yes\n"
    "Row 1 (RS): Purl.\n"
    "Row 2 (WS): Knit.\n"
    "\n"
    "pattern: Garter\n"
    "multiple: 1 + 0\n"
    "sure: yes\n"
    "Row 1 (RS): Knit.\n"
    "Row 2 (WS): Knit.\n"
    "\n"
    "pattern: Rib 1x1\n"
    "multiple: 2 + 0\n"
    "sure: yes\n"
    "Row 1 (RS): *K1, p1, repeat from *.\n"
    "Row 2 (WS): *K1, p1, repeat from *.\n"
    "\n"
    "pattern: Rib 2x2\n"
    "multiple: 4 + 0\n"
    "sure: yes\n"
    "Row 1 (RS): *K2, p2, repeat from *.\n"
    "Row 2 (WS): *K2, p2, repeat from *.\n"
    "\n"
    "pattern: Seed\n"
    "multiple: 2 + 0\n"
    "sure: yes\n"
    "Row 1 (RS): *K1, p1, repeat from *.\n"
    "Row 2 (WS): *P1, k1, repeat from *.\n"
    "\n"
    "pattern: Basketweave 8+5\n"
    "multiple: 8 + 5\n"
    "sure: yes\n"
    "Rows 1 and 5 (RS): Knit.\n"
    "Rows 2 and 4 (WS): K5, *p3, k5, repeat from *.\n"
    "Row 3 (RS): P5, *k3, p5, repeat from *.\n"
    "Rows 6 and 8 (WS): K1, *p3, k5, repeat from *, p3, k1.\n"
    "Row 7 (RS): P1, *k3, p5, repeat from *, k3, p1.\n"
    "\n"
    "pattern: Basketweave blocks 4x4\n"
    "multiple: 8 + 0\n"
    "sure: yes\n"
    "Rows 1 and 3 (RS): *K4, p4, repeat from *.\n"
    "Rows 2 and 4 (WS): *K4, p4, repeat from *.\n"
    "Rows 5 and 7 (RS): *P4, k4, repeat from *.\n"
    "Rows 6 and 8 (WS): *P4, k4, repeat from *.\n"
    "\n"
    "pattern: Cable 2/2 right cross\n"
    "multiple: 8 + 0\n"
    "sure: yes\n"
    "Rows 1 and 5 (RS): *P2, k4, p2, repeat from *.\n"
    "Rows 2, 4 and 6 (WS): *K2, p4, k2, repeat from *.\n"
    "Row 3 (RS): *P2, 2/2 RC, p2, repeat from *.\n"
    "\n"
    "pattern: Rope cable 3/3 left cross\n"
    "multiple: 10 + 0\n"
    "sure: yes\n"
    "Rows 1, 3 and 7 (RS): *P2, k6, p2, repeat from *.\n"
    "Rows 2, 4, 6 and 8 (WS): *K2, p6, k2, repeat from *.\n"
    "Row 5 (RS): *P2, 3/3 LC, p2, repeat from *.\n"
    "\n"
    "pattern: Old Shale (often called Feather and Fan)\n"
    "multiple: 18 + 0\n"
    "sure: yes\n"
    "note: 4 rows; the garter ridge of row 4 is on the right side. Variants swap rows 2 and 4 or use "
    "[k1, yo].\n"
    "Row 1 (RS): Knit.\n"
    "Row 2 (WS): Purl.\n"
    "Row 3 (RS): *[K2tog] 3 times, [yo, k1] 6 times, [k2tog] 3 times, repeat from *.\n"
    "Row 4 (WS): Knit.\n"
    "\n"
    "pattern: Openwork diamond\n"
    "multiple: 8 + 1\n"
    "sure: no\n"
    "note: one of many diamond laces; count-checked here, common in stitch dictionaries in this form. "
    "Row 11 straddles the repeat: for a periodic tile shift the start by 4 stitches.\n"
    "Row 1 (RS): K1, *yo, ssk, k3, k2tog, yo, k1, repeat from *.\n"
    "Rows 2, 4, 6, 8, 10 and 12 (WS): Purl.\n"
    "Row 3 (RS): K1, *k1, yo, ssk, k1, k2tog, yo, k2, repeat from *.\n"
    "Row 5 (RS): K1, *k2, yo, sl1-k2tog-psso, yo, k3, repeat from *.\n"
    "Row 7 (RS): K1, *k1, k2tog, yo, k1, yo, ssk, k2, repeat from *.\n"
    "Row 9 (RS): K1, *k2tog, yo, k3, yo, ssk, k1, repeat from *.\n"
    "Row 11 (RS): K2tog, *yo, k5, yo, sl1-k2tog-psso, repeat from *, yo, k5, yo, ssk.\n"
    "\n"
    "pattern: Horseshoe lace\n"
    "multiple: 10 + 1\n"
    "sure: yes\n"
    "Row 1 (RS): K1, *yo, k3, sl1-k2tog-psso, k3, yo, k1, repeat from *.\n"
    "Rows 2, 4, 6 and 8 (WS): Purl.\n"
    "Row 3 (RS): K1, *k1, yo, k2, sl1-k2tog-psso, k2, yo, k2, repeat from *.\n"
    "Row 5 (RS): K1, *k2, yo, k1, sl1-k2tog-psso, k1, yo, k3, repeat from *.\n"
    "Row 7 (RS): K1, *k3, yo, sl1-k2tog-psso, yo, k4, repeat from *.\n"
    "\n"
    "pattern: Flame Chevron\n"
    "multiple: 7 + 2\n"
    "sure: no\n"
    "note: family right (a 7-stitch bias panel leaning left for half of the rows, then right); the exact "
    "book wording could not be confirmed here. Row 1 is a WS row, as in most books.\n"
    "Rows 1, 3, 5, 7, 9, 11, 13, 15, 17 and 19 (WS): Purl.\n"
    "Rows 2, 4, 6, 8 and 10 (RS): K1, *ssk, k5, yo, repeat from *, k1.\n"
    "Rows 12, 14, 16, 18 and 20 (RS): K1, *yo, k5, k2tog, repeat from *, k1.\n";

static const struct {
    const char *name;
    int rows, multiple, rest;
} patterns[] = {{"Stockinette", 2, 1, 0}, {"Reverse stockinette", 2, 1, 0}, {"Garter", 2, 1, 0}, {"Rib 1x1", 2, 2, 0},
    {"Rib 2x2", 2, 4, 0}, {"Seed", 2, 2, 0}, {"Basketweave 8+5", 8, 8, 5}, {"Basketweave blocks 4x4", 8, 8, 0},
    {"Old Shale (often called Feather and Fan)", 4, 18, 0}, {"Openwork diamond", 12, 8, 1},
    {"Horseshoe lace", 8, 10, 1}, {"Flame Chevron", 20, 7, 2}};
enum { PATTERNS = sizeof patterns / sizeof patterns[0] };

/* Reads a text from a block of just its size, so that sanitizers see a step beyond its end. */
static yc_result read_bytes(
    const yc_host *host, const char *text, size_t length, const char *name, yc_chart *out, char *message) {
    char *tight = (char *)malloc(length + !length);
    yc_result result;
    memcpy(tight, text, length);
    result = yc_chart_read(host, tight, length, name, out, message);
    free(tight);
    return result;
}

static yc_result read_chart(const char *text, const char *name, yc_chart *out, char *message) {
    return read_bytes(NULL, text, strlen(text), name, out, message);
}

/* ---- networks ---- */

/* Works a chart like yc_knit, up to where loops are known. */
static void work(yci_knitter *k, yci_context *c, const yc_knit_desc *d) {
    memset(k, 0, sizeof *k);
    yci_context_init(c, NULL);
    k->c = c, k->desc = d, k->width = 1.0 / d->wales, k->height = 1.0 / d->courses;
    k->around = d->round ? d->stitches * k->width : 0.0;
    CHECK_RESULT(yci_knit_work(k), YC_OK);
}

static void put_away(yci_knitter *k) {
    yci_free(k->c, k->loops), yci_free(k->c, k->olds), yci_free(k->c, k->needle), yci_free(k->c, k->fresh);
}

/* Every loop but the yarn's end is held by one or two loops of its own row or later; the yarn passes all of them. */
static void check_loops(const yc_knit_desc *d) {
    yci_context c;
    yci_knitter k;
    int i, j, passed = 0, draws = 0;
    work(&k, &c, d);
    for (i = 0; i >= 0 && passed <= k.loop_count; i = k.loops[i].next) passed++;
    CHECK(passed == k.loop_count);
    for (i = 0; i < k.loop_count; i++) {
        const yci_knit_loop *loop = &k.loops[i];
        CHECK((loop->up[0] < 0) == loop->tail);
        for (j = 0; j < 2 && loop->up[j] >= 0; j++, draws++) CHECK(k.loops[loop->up[j]].row + loop->tail >= loop->row);
        for (j = 0; j < loop->old_count; j++) {
            const yci_knit_loop *old = &k.loops[k.olds[loop->old + j]];
            CHECK(old->up[0] == i || old->up[1] == i);
        }
        CHECK(loop->old_count > 0 || loop->row <= d->rows);
        CHECK(loop->row > 0 || (loop->twist && !loop->old_count));
    }
    CHECK(draws == k.old_count);
    CHECK(k.loops[0].row == 0 && k.loops[k.loop_count - 1].tail);
    put_away(&k);
}

static double turn_at(const yc_yarns *y, int v) {
    double a[3], b[3], n[3];
    yci_sub(a, y->layout[y->visit_node[v]], y->layout[y->visit_node[v - 1]]);
    yci_sub(b, y->layout[y->visit_node[v + 1]], y->layout[y->visit_node[v]]);
    yci_cross(n, a, b);
    return atan2(yci_norm(n), yci_dot(a, b));
}

/* What must hold for the network of any knit. Crowded stitches may turn sharper than others. */
static void check_network(const yc_yarns *y, int crowded) {
    int *visits = (int *)calloc((size_t)y->node_count, sizeof *visits);
    int *contacts = (int *)calloc((size_t)y->node_count, sizeof *contacts);
    int *other = (int *)calloc((size_t)y->node_count, sizeof *other); /* B of A, A of B, plus one */
    long *layers = (long *)calloc((size_t)y->node_count, sizeof *layers);
    char message[YC_MESSAGE_SIZE];
    int i, v, bad = 0;
    double sharpest = 0.0;
    CHECK_RESULT(yc_yarns_check(y, NULL, message), YC_OK);
    CHECK_TEXT(message, "");
    for (v = 0; v < y->visit_count; v++) visits[y->visit_node[v]]++;
    for (v = 0; v < y->visit_count; v++) {
        int n = visits[y->visit_node[v]], place = (n - 1 - y->visit_layer[v]) / 2;
        bad +=
            (n - 1 - y->visit_layer[v]) % 2 != 0 || place < 0 || place >= n || (layers[y->visit_node[v]] >> place & 1);
        layers[y->visit_node[v]] |= 1L << (place < 0 ? 0 : place); /* each layer of a stack once */
        bad += (n == 1) != (y->visit_held[v] != 0);
        if (v && v + 1 < y->visit_count) sharpest = fmax(sharpest, turn_at(y, v));
    }
    for (i = 0; i < y->contact_count; i++) {
        const yc_stitch_contact *s = &y->contacts[i];
        int a = y->visit_node[s->visit[0][0]], b = y->visit_node[s->visit[0][1]];
        int over_a = y->visit_layer[s->visit[1][0]] - y->visit_layer[s->visit[0][0]];
        int over_b = y->visit_layer[s->visit[1][1]] - y->visit_layer[s->visit[0][1]];
        bad += over_a * over_b >= 0; /* the yarns change places between A and B */
        bad += (other[a] && other[a] != b + 1) || (other[b] && other[b] != a + 1);
        other[a] = b + 1, other[b] = a + 1, contacts[a]++, contacts[b]++;
    }
    for (i = 0; i < y->node_count; i++) bad += visits[i] < 1 || (contacts[i] && contacts[i] != visits[i] - 1);
    for (i = 0; i < y->node_count; i++) bad += !contacts[i] && visits[i] > 2;
    CHECK(!bad);
    CHECK(y->visit_held[0] == 2 && y->visit_held[y->visit_count - 1] == 2);
    CHECK(crowded || sharpest < 0.5 * YCI_PI);
    free(visits), free(contacts), free(other), free(layers);
}

/* Curves pass their nodes on the side that their layers say, which is +z, or in the round outward of the axis. There
 * all rows run to the left, so that the first leg of a crossing goes up to the left: it passes outside, whatever its
 * layer. Returns the share of the visits that do not. */
static double wrong_sides(const yc_yarns *y, int round) {
    yc_curve_desc d = yc_curve_desc_default();
    yc_curves c;
    unsigned char *named = (unsigned char *)calloc((size_t)y->visit_count, 1);
    unsigned char *crossed = (unsigned char *)calloc((size_t)y->node_count, 1);
    int v, wrong = 0, all = 0;
    memset(&c, 0, sizeof c);
    d.steps = 1;
    CHECK_RESULT(yc_curves_make(NULL, y, (const double(*)[3])y->layout, &d, &c, NULL), YC_OK);
    if (!CHECK(c.curve_count == 1 && c.point_count == y->visit_count)) return 1.0;
    c.first = (int *)calloc(2, sizeof *c.first), c.radius = (float *)calloc(1, sizeof *c.radius);
    c.yarn = (int *)calloc(1, sizeof *c.yarn), c.points = (float(*)[3])calloc((size_t)c.point_count, sizeof *c.points);
    CHECK_RESULT(yc_curves_make(NULL, y, (const double(*)[3])y->layout, &d, &c, NULL), YC_OK);
    for (v = 0; v < 4 * y->contact_count; v++) named[y->contacts[v / 4].visit[v / 2 % 2][v % 2]] = 1;
    for (v = 0; v < c.point_count; v++) {
        const double *x = y->layout[y->visit_node[v]];
        double out = round ? ((double)c.points[v][0] - x[0]) * x[0] + ((double)c.points[v][2] - x[2]) * x[2]
                           : (double)c.points[v][2];
        int side = y->visit_layer[v];
        if (!side) continue;
        if (round && !named[v]) side = crossed[y->visit_node[v]]++ ? -1 : 1;
        all++, wrong += !(out * side > 0.0);
    }
    free(c.first), free(c.radius), free(c.yarn), free(c.points), free(named), free(crossed);
    return (double)wrong / all;
}

static void knit_and_check(const yc_knit_desc *d, int crowded) {
    char message[YC_MESSAGE_SIZE];
    yc_yarns y;
    if (!CHECK_RESULT(yc_knit(NULL, d, &y, message), YC_OK) || !CHECK_TEXT(message, "")) return;
    check_loops(d);
    check_network(&y, crowded || (d->round && d->stitches < 8));
    yc_yarns_destroy(&y);
    CHECK(y.layout == NULL && y.contacts == NULL);
}

TEST(chart_patterns) {
    char message[YC_MESSAGE_SIZE];
    int i, n, round;
    for (i = 0; i < PATTERNS; i++) {
        yc_chart chart;
        yc_knit_desc d = yc_knit_desc_default();
        if (!CHECK_RESULT(read_chart(all_charts, patterns[i].name, &chart, message), YC_OK) || !CHECK_TEXT(message, ""))
            continue;
        CHECK(chart.row_count == patterns[i].rows);
        CHECK(chart.multiple[0] == patterns[i].multiple && chart.multiple[1] == patterns[i].rest);
        d.chart = &chart, d.rows = 2 * chart.row_count;
        for (round = 0; round < 2; round++)
            for (n = 1; n <= 5; n += n) {
                yc_yarns y;
                d.round = round, d.stitches = n * patterns[i].multiple + patterns[i].rest;
                knit_and_check(&d, 0);
                if (n < 4 || d.stitches < (round ? 8 : 2) || !CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK))
                    continue;
                CHECK(wrong_sides(&y, round) <= (i < 8 ? 0.0 : 0.02)); /* lace leans where it is bound off */
                yc_yarns_destroy(&y);
            }
        yc_chart_destroy(&chart);
        CHECK(chart.rows == NULL && chart.owner == NULL);
    }
    yc_chart_destroy(NULL);
}

/* The loops of a row, along the yarn: k or p as seen from the right side, then the old loops from the front, numbered
 * from the left of their row; t where their legs cross. */
static const char *worked(const char *text, int stitches, int round, int row) {
    static char out[512];
    char message[YC_MESSAGE_SIZE];
    yc_knit_desc d = yc_knit_desc_default();
    yci_context c;
    yci_knitter k;
    yc_chart chart;
    int i, j, at = 0, width[64];
    out[0] = 0;
    if (!CHECK_RESULT(read_chart(text, NULL, &chart, message), YC_OK)) return message[0] ? "refused" : "";
    d.chart = &chart, d.stitches = stitches, d.rows = chart.row_count, d.round = round;
    work(&k, &c, &d);
    memset(width, 0, sizeof width);
    for (i = 0; i < k.loop_count; i++) /* but tail, bars and slipped loops */
        width[k.loops[i].row] += !k.loops[i].tail && k.loops[i].slot == floor(k.loops[i].slot);
    for (i = 0; i >= 0; i = k.loops[i].next) {
        if (k.loops[i].row != row || k.loops[i].tail) continue;
        at += snprintf(out + at, sizeof out - (size_t)at, "%s%s", at ? " " : "",
            !k.loops[i].old_count ? "o"
                : k.loops[i].purl ? "p"
                                  : "k");
        for (j = 0; j < k.loops[i].old_count; j++) {
            const yci_knit_loop *old = &k.loops[k.olds[k.loops[i].old + j]];
            double column = old->dir > 0 ? old->slot : width[old->row] - 1 - old->slot;
            char name[16] = "bar";
            if (old->slot == floor(old->slot)) snprintf(name, sizeof name, "%.0f", column);
            at += snprintf(out + at, sizeof out - (size_t)at, "%s%s", name,
                old->twist && old->row == row - 1 && row > 1 ? "t" : "");
        }
    }
    put_away(&k);
    yc_chart_destroy(&chart);
    return out;
}

/* Right-side rows run to the left, so their loops are named from the right. */
TEST(chart_worked) {
    CHECK_TEXT(worked("Row 1 (RS): k2, p1.", 3, 0, 0), "o o o");
    CHECK_TEXT(worked("Row 1 (RS): k2, p1.", 3, 0, 1), "k2 k1 p0");
    CHECK_TEXT(worked("Row 1 (WS): k2, p1.", 3, 0, 1), "p0 p1 k2");
    CHECK_TEXT(worked("Row 1 (RS): k1, yo, k2.", 3, 0, 1), "k2 o k1 k0");
    CHECK_TEXT(worked("Row 1 (RS): k2tog, k1.", 3, 0, 1), "k12 k0"); /* the left one on top, as all k2tog */
    CHECK_TEXT(worked("Row 1 (RS): p2tog, k1.", 3, 0, 1), "p12 k0");
    CHECK_TEXT(worked("Row 1 (RS): ssk, skpo.", 4, 0, 1), "k32 k10");
    CHECK_TEXT(worked("Row 1 (RS): k3tog.", 3, 0, 1), "k012");
    CHECK_TEXT(worked("Row 1 (RS): p3tog.", 3, 0, 1), "p012");
    CHECK_TEXT(worked("Row 1 (RS): sl1-k2tog-psso.", 3, 0, 1), "k201");
    CHECK_TEXT(worked("Row 1 (RS): SL2-K1-p2sso.", 3, 0, 1), "k120");
    /* From behind, p2tog is the k2tog of the right side. */
    CHECK_TEXT(worked("Row 1 (WS): p2tog, p1.", 3, 0, 1), "k01 k2");
    CHECK_TEXT(worked("Row 1 (WS): k2tog, k1.", 3, 0, 1), "p01 p2");
    CHECK_TEXT(worked("Row 1 (WS): ssk, p1.", 3, 0, 1), "p10 k2");
    CHECK_TEXT(worked("Row 1 (WS): sl1-k2tog-psso.", 3, 0, 1), "p120");
    /* In the round a row of the wrong side is worked from the right one, and looks as it would flat. */
    CHECK_TEXT(worked("Row 1 (WS): p2tog, p1.", 3, 1, 1), "k2 k01");
    CHECK_TEXT(worked("Row 1 (WS): ssk, p1.", 3, 1, 1), "k2 p10");
    CHECK_TEXT(worked("Row 1 (WS): k1, p3, yo.", 4, 1, 1), "o k3 k2 k1 p0");
    CHECK_TEXT(worked("Row 1 (RS): k1. \n Row 2 (RS): ktbl.", 1, 1, 2), "k0t");
    CHECK_TEXT(worked("Row 1 (RS): k2. \n Row 2 (WS): ptbl, p1.", 2, 0, 2), "k0t k1");
    CHECK_TEXT(worked("Row 1 (RS): k1, m1, k1.", 2, 0, 1), "k1 kbar k0");
    CHECK_TEXT(worked("Row 1 (RS): k1, m1, k1.", 2, 0, 0), "o o o"); /* the bar is a loop of its row */
    CHECK_TEXT(worked("Row 1 (WS): p1, m1, p1.", 2, 0, 1), "k0 pbar k1");
    CHECK_TEXT(worked("Row 1 (RS): kfb, k1.", 2, 0, 1), "k1 k1 k0");
    /* A slipped loop is carried up to the next row; the yarn goes on to the next stitch. */
    CHECK_TEXT(worked("Row 1 (RS): k1, sl1, k1.\nRow 2 (WS): Purl.", 3, 0, 1), "k2 k0");
    CHECK_TEXT(worked("Row 1 (RS): k1, sl1, k1.\nRow 2 (WS): Purl.", 3, 0, 2), "k-1 k1 k1");
    CHECK_TEXT(worked("Row 1 (RS): *sl1, repeat from *.\nRow 2 (WS): Purl.", 3, 0, 1), "");
    /* Binding off: through the loop before, in front, and the next one. */
    CHECK_TEXT(worked("Row 1 (RS): Knit.", 3, 0, 2), "k0 k01 k12");
    CHECK_TEXT(worked("Row 1 (WS): Knit.", 3, 0, 2), "k2 k21 k10");
}

TEST(chart_text) {
    static const char *const same[] = {
        "Row 1 (RS): k1, p1, k1, p1, k1.",
        "Row 1 (RS): k1, *p1, k1, repeat from *.",
        "Row 1 (RS): *K1, p1, rep from *, K1",
        "row 1 (rs) : [k1, p1] twice, k1.",
        "ROW 1 (RS): [K1,P1] 2 times,K1 .",
        "\xef\xbb\xbfnote: x: y\r\nsure: no\rRow 1 (RS): *[k1, p1] 1 time, repeat from *, k1 # and so on\r\n\r\n",
        "pattern: a\npattern: b\nRow 1 (RS): k1.\n",
        "pattern: a\nRow 1 (RS): k1, [p1, k1] twice.\nmultiple: 0 + 5\npattern: b\nRow 7 (XX): nonsense\n",
    };
    char message[YC_MESSAGE_SIZE];
    yc_chart chart;
    int i;
    for (i = 0; i < (int)(sizeof same / sizeof same[0]); i++)
        if (i != 6) CHECK_TEXT(worked(same[i], 5, 0, 1), "k4 p3 k2 p1 k0");
    CHECK_RESULT(read_chart(same[6], NULL, &chart, message), YC_ERROR_PARSE);
    CHECK_TEXT(message, "chart: there are no rows");
    CHECK_RESULT(read_chart(same[6], "B", &chart, message), YC_OK);
    yc_chart_destroy(&chart);
    if (CHECK_RESULT(read_chart("Rows 1, 3-5 and 8 (RS): k2, yo3.\nRows 2 & 6 (WS): [k1, p1, k1] twice, k1000000.\n"
                                "Row 7 (WS): Purl.",
                         NULL, &chart, message),
            YC_OK)) {
        CHECK(chart.row_count == 8 && chart.item_count == 10);
        CHECK(chart.rows[3].line == 1 && !chart.rows[3].wrong_side && chart.rows[5].line == 2);
        CHECK(chart.rows[5].wrong_side && chart.rows[5].last - chart.rows[5].first == 7);
        CHECK(chart.items[1].stitch == YC_STITCH_YO && chart.items[1].times == 3);
        CHECK(chart.rows[6].repeat == 9 && chart.rows[6].after == 10 && chart.multiple[0] == 0);
        yc_chart_destroy(&chart);
    }
}

TEST(chart_text_refuses) {
    static const char *const texts[][2] = {
        {"", "chart: there are no rows"},
        {"pattern: a", "chart: there are no rows"},
        {"Row 1 (RS): k4, k2tog, k4tog.", "chart line 1, row 1, stitch 6: 'k4tog' is no stitch known here"},
        {"\nRow 5 (WS): k1, yo, [p1, k2] 2 times, x1.", "chart line 2, row 5, stitch 9: 'x1' is no stitch known here"},
        {"Row 1 (RS): *P2, 2/2 RC, p2, repeat from *.",
            "chart line 1, row 1, stitch 3: '2/2 RC' is a cable, which stitch contacts cannot hold"},
        {"Row 1 (RS): 3/3 lc.",
            "chart line 1, row 1, stitch 1: '3/3 lc' is a cable, which stitch contacts cannot hold"},
        {"Row 1 (RS): 3/3 xc.", "chart line 1, row 1, stitch 1: '3/3 xc' is no stitch known here"},
        {"Row 1 (RS): k0.", "chart line 1, row 1, stitch 1: 'k0' has a count beyond 1 .. 1000000"},
        {"Row 1 (RS): k1000001.", "chart line 1, row 1, stitch 1: 'k1000001' has a count beyond 1 .. 1000000"},
        {"Row 1 (RS): k1\nRow 3 (RS): k1", "chart: row 2 is missing"},
        {"Row 1 (RS): k1\nRows 2 and 1 (RS): k1",
            "chart line 2, row 1: expected a row that is not there yet, found \"1\""},
        {"Row 0 (RS): k1", "chart line 1: expected a row in 1 .. 65536, found \"0 (RS)\""},
        {"Row 1: k1", "chart line 1, row 1: expected a row in 1 .. 65536, or (RS) or (WS), found \"\""},
        {"Row 1 (XS): k1", "chart line 1, row 1: expected (RS) or (WS), found \"(XS)\""},
        {"Rows 3-1 (RS): k1", "chart line 1: expected a range of rows in 1 .. 65536, found \"3-1 (RS)\""},
        {"Row 1 (RS): k1,, p1", "chart line 1, row 1: expected a stitch, found \"\""},
        {"Row 1 (RS): k1, p1,", "chart line 1, row 1: expected a stitch after the last comma, found \"\""},
        {"Row 1 (RS): .", "chart line 1, row 1: expected stitches, found \"\""},
        {"Row 1 (RS): k1. p1.", "chart line 1, row 1: expected nothing behind the full stop, found \" p1.\""},
        {"Row 1 (RS): [k1, [p1] twice] twice",
            "chart line 1, row 1: expected no brackets within brackets, found \"[p1\""},
        {"Row 1 (RS): [k1, p1", "chart line 1, row 1: expected a closing bracket after, found \"[k1, p1\""},
        {"Row 1 (RS): [k1, p1], k1",
            "chart line 1, row 1: expected a number of times or 'twice' after brackets, found \", k1\""},
        {"Row 1 (RS): [k1] 3, k1",
            "chart line 1, row 1: expected a number of times or 'twice' after brackets, found \"3, k1\""},
        {"Row 1 (RS): *k1, p1", "chart line 1, row 1: expected 'repeat from *', found \"\""},
        {"Row 1 (RS): k1, repeat from *",
            "chart line 1, row 1: expected one repeat, '*stitches, repeat from *', found \"repeat from \""},
        {"Row 1 (RS): *k1, *p1, repeat from *",
            "chart line 1, row 1: expected one repeat, '*stitches, repeat from *', found \"\""},
        {"Row 1 (RS): *k1, repeat from *, *p1, repeat from *",
            "chart line 1, row 1: expected one repeat, '*stitches, repeat from *', found \"\""},
        {"Row 1 (RS): *yo, repeat from *",
            "chart line 1, row 1: expected a repeat that uses stitches, found \"*yo, repeat from *\""},
        {"Row 1 (RS): k1 [p1] twice", "chart line 1, row 1: expected a comma, found \"[p1] twice\""},
        {"colour: red", "chart line 1: expected pattern, multiple, sure, note or rows, found \"colour\""},
        {"hello", "chart line 1: expected pattern, multiple, sure, note or rows before a colon, found \"hello\""},
        {"multiple: 8", "chart line 1: expected a multiple like '8 + 1', found \"8\""},
        {"multiple: 0 + 0", "chart line 1: expected a multiple like '8 + 1', found \"0 + 0\""},
        {"multiple: 4 + 1\nRow 1 (RS): *k4, repeat from *.",
            "chart line 2, row 1: uses 4 of 5 stitches, and its repeat of 4 does not fit the rest"},
        {"multiple: 4 + 1\nRow 1 (RS): k1, *ssk, k2, repeat from *.\nRow 2 (WS): k1, *p4, repeat from *.",
            "chart line 3, row 2: uses 1 of 4 stitches, and its repeat of 4 does not fit the rest"},
        {"multiple: 0 + 18\nRow 1 (RS): k17.", "chart line 2, row 1: uses 17 of 18 stitches"},
        {"multiple: 0 + 16\nRow 1 (RS): k17.", "chart line 2, row 1: uses 17 of 16 stitches"},
        {"Row 1 (RS): [k1, p1] 600000 times",
            "chart line 1, row 1: a row has at most 100000000 stitches, a chart 1048576 changes of stitches"},
        {"Row 1 (RS): [k1000000] 101 times",
            "chart line 1, row 1: a row has at most 100000000 stitches, a chart 1048576 changes of stitches"},
    };
    char message[YC_MESSAGE_SIZE], plain[32];
    yc_chart chart, kept;
    int i;
    memset(&chart, 7, sizeof chart);
    kept = chart;
    for (i = 0; i < (int)(sizeof texts / sizeof texts[0]); i++) {
        CHECK_RESULT(read_chart(texts[i][0], NULL, &chart, message), YC_ERROR_PARSE);
        CHECK_TEXT(message, texts[i][1]);
        CHECK(!memcmp(&chart, &kept, sizeof chart));
    }
    CHECK_RESULT(read_chart(all_charts, "Cable 2/2 right cross", &chart, message), YC_ERROR_PARSE);
    CHECK_TEXT(message, "chart line 59, row 3, stitch 3: '2/2 RC' is a cable, which stitch contacts cannot hold");
    CHECK_RESULT(read_chart(all_charts, "Rope cable 3/3 left cross", &chart, message), YC_ERROR_PARSE);
    CHECK_TEXT(message, "chart line 66, row 5, stitch 3: '3/3 LC' is a cable, which stitch contacts cannot hold");
    CHECK_RESULT(read_chart(all_charts, "Garte", &chart, message), YC_ERROR_PARSE);
    CHECK_TEXT(message, "chart: there is no pattern 'Garte'");
    CHECK_RESULT(yc_chart_read(NULL, NULL, 0, NULL, &chart, message), YC_ERROR_ARGUMENT);
    CHECK_TEXT(message, "text and out must not be NULL");
    CHECK_RESULT(yc_chart_read(NULL, "", 0, NULL, NULL, message), YC_ERROR_ARGUMENT);
    memcpy(plain, "Row 1 (RS): k1\0, k2", 19); /* a zero is a byte like others */
    CHECK_RESULT(read_bytes(NULL, plain, 19, NULL, &chart, message), YC_ERROR_PARSE);
    CHECK(!memcmp(&chart, &kept, sizeof chart));
}

TEST(knit_refuses) {
    char message[YC_MESSAGE_SIZE];
    yc_knit_desc d = yc_knit_desc_default();
    yc_chart chart, hand;
    yc_chart_item items[1];
    yc_chart_row rows[1];
    yc_yarns y, kept;
    memset(&y, 7, sizeof y);
    kept = y;
#define REFUSED(change, text) \
    do { \
        d = yc_knit_desc_default(); \
        change; \
        CHECK_RESULT(yc_knit(NULL, &d, &y, message), YC_ERROR_ARGUMENT); \
        CHECK_TEXT(message, text); \
        CHECK(!memcmp(&y, &kept, sizeof y)); \
    } while (0)
    REFUSED(d.cookie = 0, "knit.cookie: not made by yc_knit_desc_default()");
    REFUSED(d.stitches = 0, "knit.stitches = 0 must lie in 1 .. 1000000");
    REFUSED(d.rows = 1000001, "knit.rows = 1000001 must lie in 1 .. 1000000");
    REFUSED(d.wales = 0.0, "knit.wales = 0 must be greater than 0");
    REFUSED(d.courses = -1.0, "knit.courses = -1 must be greater than 0");
    REFUSED(d.loop = -1.0, "knit.loop = -1 must not be negative");
    REFUSED(d.yarn.radius = 0.0, "knit.yarn.radius = 0 must be greater than 0");
    REFUSED((d.stitches = 1000000, d.rows = 1000), "knit: more than 25000000 loops");
    CHECK_RESULT(yc_knit(NULL, NULL, &y, message), YC_ERROR_ARGUMENT);
    CHECK_TEXT(message, "desc and out must not be NULL");
    if (CHECK_RESULT(read_chart(all_charts, "Rib 2x2", &chart, message), YC_OK)) {
        REFUSED((d.chart = &chart, d.stitches = 18),
            "chart line 28, row 1: uses 16 of 18 stitches, and its repeat of 4 does not fit the rest");
        yc_chart_destroy(&chart);
    }
    if (CHECK_RESULT(
            read_chart("Row 1 (RS): k2.\nRow 2 (WS): k1, m1, k1.\nRow 3 (RS): k1, m1, m1, k2.", NULL, &chart, message),
            YC_OK)) {
        REFUSED((d.chart = &chart, d.stitches = 2, d.rows = 3),
            "chart line 3, row 3: m1 after 1 stitches finds no bar between two of the row below");
        REFUSED((d.chart = &chart, d.stitches = 3, d.rows = 3), "chart line 1, row 1: uses 2 of 3 stitches");
        REFUSED((d.chart = &chart, d.stitches = 2, d.rows = 3, d.round = 1),
            "chart line 3, row 3: m1 after 1 stitches finds no bar between two of the row below");
        yc_chart_destroy(&chart);
    }
    if (CHECK_RESULT(read_chart("Row 1 (RS): m1, k2.", NULL, &chart, message), YC_OK)) {
        REFUSED((d.chart = &chart, d.stitches = 2, d.rows = 1),
            "chart line 1, row 1: m1 after 0 stitches finds no bar between two of the row below");
        yc_chart_destroy(&chart);
    }
    if (CHECK_RESULT(read_chart("Rows 1-3 (RS): Knit.", NULL, &chart, message), YC_OK)) {
        REFUSED(d.chart = &chart, "chart: rows 1 and 2 have the same side in front, so this is worked in the round");
        d.rows = 1;
        knit_and_check(&d, 0);
        d.rows = 9, d.round = 1;
        knit_and_check(&d, 0);
        yc_chart_destroy(&chart);
    }
    if (CHECK_RESULT(read_chart("Rows 1 and 3 (RS): Knit.\nRow 2 (WS): Knit.", NULL, &chart, message), YC_OK)) {
        REFUSED(d.chart = &chart, "chart: rows 3 and 1 have the same side in front, so this is worked in the round");
        d.rows = 3;
        knit_and_check(&d, 0);
        yc_chart_destroy(&chart);
    }
    /* Charts of the caller's own. */
    memset(&hand, 0, sizeof hand);
    memset(rows, 0, sizeof rows);
    hand.row_count = hand.item_count = 1, hand.rows = rows, hand.items = items;
    items[0].stitch = YC_STITCH_K, items[0].times = 20, rows[0].repeat = rows[0].after = rows[0].last = 1;
    d = yc_knit_desc_default();
    d.chart = &hand, d.rows = 1;
    knit_and_check(&d, 0);
    REFUSED((d.chart = &hand, items[0].times = 19, d.rows = 1), "chart row 1: uses 19 of 20 stitches");
    REFUSED((d.chart = &hand, items[0].times = 0), "chart.items[0]: stitch 0, 0 times, is none");
    REFUSED((d.chart = &hand, items[0].stitch = 99), "chart.items[0]: stitch 99, 0 times, is none");
    REFUSED((d.chart = &hand, rows[0].last = 2), "chart.rows[0] = 0, 1, 1, 2 must rise within 0 .. 1");
    REFUSED((d.chart = &hand, hand.items = NULL), "chart.rows and items must not be NULL");
    REFUSED((d.chart = &hand, hand.row_count = 0), "chart.row_count = 0 must lie in 1 .. 65536");
#undef REFUSED
}

/* About four nodes and twenty unknowns a loop; the yarn in a stitch is as long as was asked for. */
TEST(knit_counts) {
    static const yc_fabric_name names[] = {YC_FABRIC_JERSEY, YC_FABRIC_RIB, YC_FABRIC_STOCKINETTE};
    yc_knit_desc d = yc_knit_desc_default(), kept = d;
    yc_yarns y;
    int i, v, *visits, unknowns = 0;
    for (i = 0; i < 3; i++) {
        yc_fabric fabric;
        double loops;
        CHECK_RESULT(yc_knit_fabric(names[i], &d), YC_OK);
        CHECK_RESULT(yc_fabric_get(names[i], &fabric), YC_OK);
        CHECK(d.wales == fabric.wales && d.courses == fabric.courses && d.loop == fabric.loop);
        d.stitches = 60, d.rows = 80;
        if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
        loops = d.stitches * (d.rows + 1.8); /* cast-on and bind-off loops take nearly as much */
        CHECK_NEAR(y.visit_u[y.visit_count - 1] / loops / d.loop, 1.0, 0.02);
        CHECK_NEAR(y.visit_u[y.visit_count - 1] * y.materials[0].density * d.wales * d.courses / loops,
            0.5 * (fabric.mass[0] + fabric.mass[1]), 0.35 * fabric.mass[1]); /* kg/m^2 */
        if (i < 2) yc_yarns_destroy(&y);
    }
    CHECK_NEAR((double)y.node_count / (60 * 81), 4.0, 0.15);
    visits = (int *)calloc((size_t)y.node_count, sizeof *visits);
    for (v = 0; v < y.visit_count; v++) visits[y.visit_node[v]]++;
    for (i = 0; i < y.node_count; i++) unknowns += 3 + (visits[i] > 1 ? visits[i] : 0);
    CHECK_NEAR((double)unknowns / (60 * 81), 20.0, 0.5);
    CHECK_NEAR((double)y.contact_count / (60 * 81), 2.0, 0.05);
    free(visits);
    yc_yarns_destroy(&y);
    CHECK_RESULT(yc_knit_fabric(YC_FABRIC_DENIM, &kept), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_knit_fabric(YC_FABRIC_COUNT, &kept), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_knit_fabric(YC_FABRIC_RIB, NULL), YC_ERROR_ARGUMENT);
    CHECK(kept.stitches == 20);
}

/* Width and height of a piece, m, and the yarn in it. */
static void piece_size(const yc_knit_desc *desc, int stitches, int rows, double out[3]) {
    yc_knit_desc d = *desc;
    yc_yarns y;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    int i, k;
    memset(out, 0, 3 * sizeof *out);
    d.stitches = stitches, d.rows = rows;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    for (i = 0; i < y.node_count; i++)
        for (k = 0; k < 2; k++) low[k] = fmin(low[k], y.layout[i][k]), high[k] = fmax(high[k], y.layout[i][k]);
    for (k = 0; k < 2; k++) out[k] = high[k] - low[k];
    out[2] = y.visit_u[y.visit_count - 1];
    yc_yarns_destroy(&y);
}

/* Knits that have names, away from their edges: Munden's shape of a loop, from dry to fully relaxed, a tightness from
 * hand to machine knitting, and the gauge and mass that are known; relaxed they keep the gauge within a quarter. */
TEST(knit_fabrics_gauge_and_mass) {
    static const struct {
        yc_fabric_name name;
        double wales, courses, tightness; /* per m; 0: only Munden's range is known */
    } known[] = {{YC_FABRIC_JERSEY, 0.0, 0.0, 16.0}, {YC_FABRIC_RIB, 0.0, 0.0, 15.3},
        {YC_FABRIC_STOCKINETTE, 220.0, 300.0, 11.0},             /* to 10 cm, as the label of DK yarn says */
        {YC_FABRIC_SWEATER, 6.5 / 25.4e-3, 1.0 / 3.0e-3, 13.0}}; /* YARN, 5.1.1 and Table 1 */
    const int n = 12;
    int i, k;
    for (i = 0; i < 4; i++) {
        yc_knit_desc d;
        yc_fabric fabric;
        yc_knit_rest rest;
        double size[4][3], wide, high, loop, mass;
        CHECK_RESULT(yc_knit_fabric(known[i].name, &d), YC_OK);
        CHECK_RESULT(yc_fabric_get(known[i].name, &fabric), YC_OK);
        for (k = 0; k < 4; k++) piece_size(&d, k % 2 ? 2 * n : n, k / 2 ? 2 * n : n, size[k]);
        wide = (size[3][0] - size[2][0]) / n, high = (size[3][1] - size[1][1]) / n;
        loop = (size[3][2] - size[2][2] - size[1][2] + size[0][2]) / (n * n);
        mass = d.yarn.density * loop / (wide * high);
        CHECK(mass > fabric.mass[0] && mass < fabric.mass[1]);
        CHECK(loop / wide > 0.96 * 3.8 && loop / wide < 1.04 * 4.2);
        CHECK(loop / high > 0.96 * 5.0 && loop / high < 1.04 * 5.5);
        CHECK_NEAR(sqrt(1e6 * d.yarn.density) / (1e2 * loop), known[i].tightness, 0.1);
        if (known[i].wales > 0.0) CHECK_NEAR(1.0 / wide / known[i].wales, 1.0, 0.02);
        if (known[i].courses > 0.0) CHECK_NEAR(1.0 / high / known[i].courses, 1.0, 0.02);
        if (!CHECK_RESULT(yc_knit_relax(NULL, &d, &rest, NULL), YC_OK)) return;
        CHECK(fabs(rest.wales / d.wales - 1.0) < 0.25 && fabs(rest.courses / d.courses - 1.0) < 0.25);
        CHECK_NEAR(rest.loop, d.loop, 0.01 * d.loop);
        yc_knit_rest_destroy(&rest);
    }
}

/* The loop of plain knitting, by hand: its nodes, layers and signs. */
TEST(knit_layout) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_yarns y;
    int i, k, at = -1;
    double x = 4.5, top;
    d.stitches = 9, d.rows = 4, d.wales = d.courses = 1.0, d.yarn.radius = 0.1;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    /* The left contacts of the fifth loop from the left in the second row from the bottom, and what is around them. */
    for (i = 0, top = 0.0; i < y.node_count; i++) top = fmax(top, y.layout[i][1]);
    for (i = 0; i < y.contact_count; i++) {
        const yc_stitch_contact *s = &y.contacts[i];
        const double *a = y.layout[y.visit_node[s->visit[0][0]]], *b = y.layout[y.visit_node[s->visit[0][1]]];
        if (a[1] > top - 2.0) continue; /* binding off leans */
        CHECK_NEAR(b[1] - a[1], 0.64, 1e-12);
        CHECK_NEAR(b[0] - a[0], s->sign > 0 ? 0.2 : -0.2, 1e-12); /* towards the loop's middle */
        for (k = 0; k < 2; k++) {
            CHECK(y.visit_layer[s->visit[k][0]] == (k ? -1 : 1)); /* old leg before new foot */
            CHECK(y.visit_layer[s->visit[k][1]] == (k ? 1 : -1)); /* new leg before old head */
        }
        if (s->sign > 0 && fabs(a[1] - 1.8) < 0.3 && fabs(a[0] - x) < 0.6) at = i;
    }
    if (CHECK(at >= 0)) {
        const int *new_loop = y.contacts[at].visit[1], *old_loop = y.contacts[at].visit[0];
        int step = new_loop[1] - new_loop[0];
        for (k = 0; k < 2; k++) { /* the old loop: leg, A, B, head; the new one: foot, A, B, leg */
            const int *v = k ? new_loop : old_loop;
            const double *a = y.layout[y.visit_node[v[0]]], *b = y.layout[y.visit_node[v[1]]];
            const double *before, *after;
            step = v[1] - v[0];
            before = y.layout[y.visit_node[v[0] - step]], after = y.layout[y.visit_node[v[1] + step]];
            CHECK_NEAR(before[0] - a[0], k ? -0.3 : 0.2, 1e-12);
            CHECK_NEAR(before[1] - a[1], k ? 0.0 : -0.36, 1e-12);
            CHECK_NEAR(after[0] - b[0], k ? -0.2 : 0.3, 1e-12);
            CHECK_NEAR(after[1] - b[1], k ? 0.36 : 0.0, 1e-12);
        }
    }
    yc_yarns_destroy(&y);
}

/* A text of random rows that fit a width. Returns the stitches that the last one leaves. */
static int random_chart(uint64_t *state, int stitches, int rows, int round, char *text) {
    int row, at = 0, i;
    for (row = 1; row <= rows; row++) {
        int left = stitches, makes = 0, bar = 0;
        at += sprintf(text + at, "Row %d (%s):", row, round || row % 2 ? "RS" : "WS");
        while (left > 0) {
            static const char *const more[] = {"YO", "M1"};
            i = test_random_int(state, YC_STITCH_COUNT);
            if (i == YC_STITCH_M1 && (!bar || left < 1)) continue;
            if (yci_stitches[i].uses > left || (stitches > 40 && yci_stitches[i].makes > yci_stitches[i].uses))
                continue;
            at += sprintf(text + at, "%s %s", makes || left < stitches ? "," : "",
                yci_stitches[i].uses ? yci_stitches[i].name : more[i == YC_STITCH_M1]);
            left -= yci_stitches[i].uses, makes += yci_stitches[i].makes;
            bar = i == YC_STITCH_K || i == YC_STITCH_P; /* another needs a bar of its own */
        }
        at += sprintf(text + at, ".\n");
        stitches = makes;
    }
    return stitches;
}

TEST(knit_random) {
    uint64_t state = 5;
    char text[65536], message[YC_MESSAGE_SIZE];
    int n, worked_out = 0;
    for (n = 0; n < 300; n++) {
        yc_knit_desc d = yc_knit_desc_default();
        yc_chart chart;
        yc_yarns y;
        d.stitches = 1 + test_random_int(&state, 20), d.rows = 1 + test_random_int(&state, 8), d.round = n % 2;
        random_chart(&state, d.stitches, d.rows, d.round, text);
        if (!CHECK_RESULT(read_chart(text, NULL, &chart, message), YC_OK) || !CHECK_TEXT(message, "")) break;
        d.chart = &chart;
        if (yc_knit(NULL, &d, &y, message) == YC_OK) { /* m1 next to a slipped stitch has no bar */
            yc_yarns_destroy(&y);
            knit_and_check(&d, 1), worked_out++;
        } else CHECK(strstr(message, "finds no bar") != NULL);
        yc_chart_destroy(&chart);
    }
    CHECK(worked_out > 150);
}

/* One stitch wide, decreased to one, and as wide as it gets. */
TEST(knit_extremes) {
    char message[YC_MESSAGE_SIZE];
    yc_knit_desc d = yc_knit_desc_default();
    yc_chart chart;
    yc_yarns y;
    d.stitches = 1, d.rows = 1;
    knit_and_check(&d, 0);
    d.rows = 50;
    knit_and_check(&d, 0);
    d.round = 1;
    knit_and_check(&d, 0);
    if (CHECK_RESULT(read_chart("Row 1 (RS): ssk, k3, k2tog.\nRow 2 (WS): p2tog, p1, ssk.\nRow 3 (RS): k3tog.", NULL,
                         &chart, message),
            YC_OK)) {
        d = yc_knit_desc_default();
        d.chart = &chart, d.stitches = 7, d.rows = 3;
        knit_and_check(&d, 0);
        d.round = 1;
        knit_and_check(&d, 0);
        yc_chart_destroy(&chart);
    }
    if (CHECK_RESULT(read_chart("Row 1 (RS): [k2tog] 50000 times.\nRow 2 (WS): [p1, p2tog, p2] 10000 times.", NULL,
                         &chart, message),
            YC_OK)) {
        d = yc_knit_desc_default();
        d.stitches = 100000, d.rows = 2;
        if (CHECK_RESULT(yc_knit(NULL, &d, &y, message), YC_OK)) {
            CHECK_NEAR((double)y.node_count / 100000.0, 1.0 + 4.0 * 3.0 + 5.0, 0.01);
            CHECK_RESULT(yc_yarns_check(&y, NULL, message), YC_OK);
            yc_yarns_destroy(&y);
        }
        d.chart = &chart, d.rows = 2;
        if (CHECK_RESULT(yc_knit(NULL, &d, &y, message), YC_OK)) {
            CHECK_RESULT(yc_yarns_check(&y, NULL, message), YC_OK);
            yc_yarns_destroy(&y);
        }
        yc_chart_destroy(&chart);
    }
}

TEST(knit_out_of_memory) {
    static const char text[] = "Row 1 (RS): [k2tog] 2 times, [yo, k1] 4 times.\nRow 2 (WS): k1, m1, p9.";
    yc_knit_desc d = yc_knit_desc_default();
    yc_chart chart, before;
    yc_yarns y, kept;
    char message[YC_MESSAGE_SIZE];
    int n;
    memset(&chart, 7, sizeof chart), memset(&y, 7, sizeof y);
    before = chart, kept = y;
    for (n = 0; n < 20; n++) {
        yc_host host = test_host_failing(n);
        yc_result result = read_bytes(&host, text, sizeof text - 1, NULL, &chart, message);
        if (result == YC_OK) break;
        CHECK(test_refused_memory(result, message) && !memcmp(&chart, &before, sizeof chart));
    }
    CHECK(n >= 2 && n < 20 && test_heap.live == 1);
    yc_chart_destroy(&chart);
    CHECK(test_heap.live == 0 && test_heap.bytes == 0);
    if (!CHECK_RESULT(read_chart(text, NULL, &chart, message), YC_OK)) return;
    d.chart = &chart, d.stitches = 8, d.rows = 2;
    for (n = 0; n < 100; n++) {
        yc_host host = test_host_failing(n);
        yc_result result = yc_knit(&host, &d, &y, message);
        if (result == YC_OK) break;
        CHECK(test_refused_memory(result, message) && !memcmp(&y, &kept, sizeof y));
    }
    CHECK(n >= 8 && n < 100 && test_heap.live == 1);
    yc_yarns_destroy(&y);
    CHECK(test_heap.live == 0 && test_heap.bytes == 0);
    yc_chart_destroy(&chart);
}

/* Texts with bytes changed, left out and doubled are read or refused, and what was read is knitted or refused. */
TEST(chart_fuzz) {
    static const char bytes[] = "kpyo1239,.*[]()/-+:# \nRWS\tsl\xff";
    uint64_t state = 11;
    char message[YC_MESSAGE_SIZE];
    int n, i, read = 0, knitted = 0;
    for (n = 0; n < 4000; n++) {
        char text[512];
        const char *begin = strstr(all_charts, patterns[n % PATTERNS].name) - 9;
        size_t length = strlen(begin) < 500 ? strlen(begin) : 500;
        yc_knit_desc d = yc_knit_desc_default();
        yc_chart chart;
        yc_yarns y;
        memcpy(text, begin, length);
        for (i = 1 + test_random_int(&state, 3); i > 0; i--) {
            size_t at = (size_t)test_random_int(&state, (int)length - 1);
            int kind = test_random_int(&state, 3);
            if (kind == 0) text[at] = bytes[test_random_int(&state, (int)sizeof bytes - 1)];
            else if (kind == 1) memmove(text + at, text + at + 1, length - at - 1), length--;
            else memmove(text + at + 1, text + at, length - at - 1);
        }
        if (read_bytes(NULL, text, length, NULL, &chart, message) != YC_OK) {
            CHECK(message[0] != 0);
            continue;
        }
        read++;
        d.chart = &chart, d.stitches = chart.multiple[0] + chart.multiple[1], d.rows = 3;
        if (d.stitches < 1 || d.stitches > 1000) d.stitches = 8;
        if (yc_knit(NULL, &d, &y, message) == YC_OK) {
            knitted++;
            CHECK_RESULT(yc_yarns_check(&y, NULL, NULL), YC_OK);
            yc_yarns_destroy(&y);
        } else CHECK(message[0] != 0);
        yc_chart_destroy(&chart);
    }
    CHECK(read > 100 && knitted > 100 && read < 4000);
}

/* What the check of a network says of wrong contacts, and a scene of a stack that is none. */
TEST(knit_check_refuses) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene_desc settings = yc_scene_desc_default();
    yc_stitch_contact *s, other;
    yc_scene *scene;
    yc_chart chart;
    yc_yarns y;
    char message[YC_MESSAGE_SIZE], want[YC_MESSAGE_SIZE];
    int v;
    if (!CHECK_RESULT(read_chart("Row 1 (RS): k1, k2tog, yo, k1.", NULL, &chart, message), YC_OK)) return;
    d.chart = &chart, d.stitches = 4, d.rows = 1;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, message), YC_OK)) return;
    s = &y.contacts[1];
#define WRONG(type, place, value, code, text) \
    do { \
        type kept = place; \
        place = value; \
        CHECK_RESULT(yc_yarns_check(&y, NULL, message), code); \
        CHECK_TEXT(message, text); \
        place = kept; \
    } while (0)
    v = s->visit[0][0];
    WRONG(int, y.contact_count, -1, YC_ERROR_ARGUMENT, "yarns.contact_count = -1 must not be negative");
    snprintf(want, sizeof want, "yarns.contacts[1].visit[1][0] = -1 must lie in 0 .. %d", y.visit_count - 1);
    WRONG(int, s->visit[1][0], -1, YC_ERROR_ARGUMENT, want);
    snprintf(want, sizeof want, "yarns.contacts[1].visit[0] = %d and %d do not follow each other", v, s->visit[1][1]);
    WRONG(int, s->visit[0][1], s->visit[1][1], YC_ERROR_TOPOLOGY, want);
    other = *s, memcpy(other.visit[1], y.contacts[0].visit[1], sizeof other.visit[1]);
    snprintf(want, sizeof want, "yarns.contacts[1]: visits %d and %d are at different nodes", v, other.visit[1][0]);
    WRONG(yc_stitch_contact, *s, other, YC_ERROR_TOPOLOGY, want);
    memcpy(other.visit[1], other.visit[0], sizeof other.visit[1]);
    snprintf(want, sizeof want, "yarns.contacts[1]: visit %d touches itself", v);
    WRONG(yc_stitch_contact, *s, other, YC_ERROR_TOPOLOGY, want);
    WRONG(signed char, s->sign, 0, YC_ERROR_ARGUMENT, "yarns.contacts[1].sign = 0 must be +1 or -1");
    snprintf(want, sizeof want, "yarns.visit_layer[%d] = 5 must lie in -1 .. 1", v);
    WRONG(signed char, y.visit_layer[v], 5, YC_ERROR_ARGUMENT, want);
    WRONG(int, y.contact_count, 3, YC_ERROR_TOPOLOGY,
        "yarns.visit_node[12] = 10: 3 visits of this node, and no contact names this one");
    WRONG(int, y.contact_count, 0, YC_ERROR_ARGUMENT, "yarns.visit_layer[12] = 2 must lie in -1 .. 1");
#undef WRONG
    if (CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, message), YC_OK)) {
        cloth.yarns = &y;
        for (s = y.contacts; y.visit_layer[s->visit[1][0]] != -2;) s++;
        y.visit_layer[s->visit[1][0]] = 0; /* the new loop in the midst of its stack */
        CHECK_RESULT(yc_scene_add_cloth(scene, &cloth, NULL), YC_ERROR_ARGUMENT);
        snprintf(want, sizeof want,
            "cloth.yarns.visit_layer[%d] = 0: the new loop must lie on top of its stack of 3, or below all",
            s->visit[1][0]);
        CHECK_TEXT(yc_scene_message(scene), want);
        yc_scene_destroy(scene);
    }
    yc_yarns_destroy(&y);
    yc_chart_destroy(&chart);
}
