/* bench-knit: what knits of hand-knitted wool do, beside what is known of them, and the cost of garments.
 *
 *   bench-knit [--quick] [curl | rib | munden | lace | stretch | sphere | plastic | cost ...]     only these parts
 *
 * Swatches are cast on in the rest shape of their chart's repeat and left to themselves as tests/scenes/knits.h says;
 * shares are of what lies flat.
 *   curl     stockinette turns by more than 30 degrees towards the purl side at its sides and towards the knit side at
 *            its ends, while the middle half turns by less than 30; garter by less than 15 everywhere.
 *            Four loops of the middle are held, and both have come to rest, by r/20 in 10 periods of a stitch: held
 *            nowhere, pieces this small roll up into two scrolls, on a table too. Angles without a source: a clear curl
 *   rib      1x1 and 2x2 are between 0.4 and 0.6 times as wide as stockinette of the same stitches, laid flat. A share
 *            of the nearer end where they are not. Half is what YARN shows (Fig. 5); the margin has no source
 *   munden   kc/kw within 20 % of 1.3; kc, kw and ks within 20 % of the range from dry to wet relaxed
 *   lace     Feather and Fan: the upper edge's strongest wave has a period of 18 stitches. Openwork diamonds: as many
 *            holes as yarn-overs, a hole being a gap between yarns larger than 3/4 of a stitch; those of plain knitting
 *            are of a fifth, those above double decreases of half, those of yarn-overs of 1 to 1.8, but for two
 *            of the first row, at the corners, which casting on draws shut. Flame chevron: columns lean to the other
 *            side every ten rows
 *   stretch  swatches with elastic edges drawn by their outermost columns or rows. At 49 N/m of what is laid plain
 *            knits give 10 to 40 % across and ribs 40 to 100 % (cotton jersey and wool rib, KES). What they give at 1 N
 *            per row, where they lock, is no goal: no source is known; garter goes furthest lengthwise; a rib is
 *            opposed by wrapping, then bending, then stretching, by what grows most from one point to the next (YARN,
 *            Fig. 11). The curves are drawn in out/knit-stretch.png
 *   sphere   six fabrics of 16 rows fallen on a sphere of 3.2 cm: the drape coefficients of any two, or their depths
 *            below the top, differ by 3 % (YARN, Fig. 12, is without numbers). Each comes to rest: 20 mm/s at most (no
 *            source)
 *   plastic  garter that has settled without friction for a while is drawn out by half its width and let go: with
 *            friction stitches stay wider by 2 % at least, without by a quarter of that at most (YARN, Fig. 9, is
 *            without numbers)
 *   cost     a sweater of 56,000 and a T-shirt of 325,000 loops that hang by their upper edge: memory, and seconds per
 *            frame of 1/30 s by the mean of the first three steps of 1 ms (the T-shirt: of the first alone), against
 *            the 96 s and 7.4 min that YARN reports on a GPU, and 4 GB for the larger. Time per Newton iteration grows
 *            with nodes to a power of 1.1 at most, from a sixteenth of the sweater, by the same solver (no source). All
 *            steps together are given 10 and 20 minutes; with --quick there is time for the sixteenth only. Both are
 *            of wool; a first step of 1 ms of 20 x 20 loops of cotton jersey takes 124 Newton iterations, the next 44
 * What stands outside: charts on garments' pieces; YARN's own curves, which are printed without numbers. */
#define _POSIX_C_SOURCE 200809L /* NOLINT(bugprone-reserved-identifier): what POSIX prescribes */
#include "bench.h"
#include "report.h"
#include "../../examples/common/ex_image.h"
#include "../scenes/knits.h"
#include "yarncloth.h"
#include <math.h>

static const double degree = 3.14159265358979323846 / 180.0;
static int quick;

/* A goal that a value lies in a range; the share of it that is reached. */
static void range_goal(const char *name, const char *what, double value, double low, double high, const char *unit) {
    double share = value >= low && value <= high ? 1.0 : value < low ? value / low : high / value;
    say("%-14s%-34s%9.3f  %7.3g to %-7.3g %-8s %s\n", name, what, value, low, high, unit,
        share >= 1.0 ? "met" : "missed");
    count_goal(name, what, share >= 0.0 ? share : 0.0);
}

static scene_knit *swatch(const char *name, const char *rows, int stitches, int row_count) {
    char why[YC_MESSAGE_SIZE] = "";
    scene_knit *k = scene_knit_new(rows, stitches, row_count, NULL, why);
    if (!k) say("%-14sfailed: %s\n", name, why);
    return k;
}

static void run_curl(void) {
    int n = quick ? 14 : 20, i;
    scene_knit *k = swatch("stockinette", scene_stockinette, n, n);
    scene_knit_shape s;
    double least = NAN, flat = NAN, rest = NAN;
    if (k && scene_knit_hold(k) == YC_OK && scene_knit_settle(k, 60) == YC_OK) {
        s = scene_knit_look(k), flat = s.flat / degree;
        least = fmin(fmin(s.side[0], s.side[1]), fmin(s.end[0], s.end[1])) / degree;
        rest = k->moved / k->desc.yarn.radius;
        say("%-14s%d x %d: sides turn by %.0f and %.0f, ends by %.0f and %.0f degrees; %.0f s\n", "stockinette", n, n,
            s.side[0] / degree, s.side[1] / degree, s.end[0] / degree, s.end[1] / degree, k->seconds);
    }
    range_goal("stockinette", "least turn of an edge", least, 30.0, 360.0, "degrees");
    range_goal("stockinette", "the middle half turns", flat, 0.0, 30.0, "degrees");
    range_goal("stockinette", "moves by, in the last step", rest, 0.0, 0.05, "radii");
    scene_knit_free(k);
    k = swatch("garter", scene_garter, 14, 14);
    for (i = 0, least = NAN; k && i < 2; i++) {
        if (i == 0 && scene_knit_settle(k, 60) != YC_OK) break;
        s = scene_knit_look(k);
        least = fmax(fmax(s.flat, i ? least * degree : 0.0), fmax(fabs(s.side[i]), fabs(s.end[i]))) / degree;
    }
    range_goal("garter", "largest turn", least, 0.0, 15.0, "degrees");
    scene_knit_free(k);
    say("\n");
}

static void run_rib(void) {
    static const char *const name[2] = {"rib 1x1", "rib 2x2"};
    const char *rows[2] = {scene_rib, scene_rib2};
    int n = quick ? 12 : 16, i;
    scene_knit *plain = swatch("stockinette", scene_stockinette, n, n);
    double flat = plain ? scene_knit_look(plain).width : NAN, share[2];
    scene_knit_free(plain);
    for (i = 0; i < 2; i++) {
        scene_knit *k = swatch(name[i], rows[i], n, n);
        share[i] = NAN;
        if (k && scene_knit_settle(k, 30) == YC_OK) share[i] = scene_knit_look(k).width / flat;
        if (k)
            say("%-14s%d x %d: height %.2f of flat; %.0f s\n", name[i], n, n,
                scene_knit_look(k).height * k->desc.courses / (n - 2), k->seconds);
        range_goal(name[i], "width of stockinette's", share[i], 0.4, 0.6, "");
        scene_knit_free(k);
    }
    say("%-14s%s draws in more\n\n", "ribs", share[0] < share[1] ? "1x1" : "2x2");
}

static void run_munden(void) {
    int n = quick ? 12 : 18;
    scene_knit *k = swatch("munden", scene_stockinette, n, n);
    scene_knit_munden m;
    memset(&m, 0, sizeof m);
    if (k) m = scene_knit_gauge(k);
    say("%-14s%d x %d, %.2f mm of yarn in a loop, laid as %.2f x %.2f mm, relaxed by %.3f x %.3f\n", "munden", n, n,
        1e3 * m.loop, k ? 1e3 / k->desc.wales : 0.0, k ? 1e3 / k->desc.courses : 0.0, k ? k->rest.scale[0] : 0.0,
        k ? k->rest.scale[1] : 0.0);
    range_goal("munden", "kc/kw", m.kc / m.kw, 1.3 / 1.2, 1.3 * 1.2, "");
    range_goal("munden", "kc, 5.0 to 5.5", m.kc, 5.0 / 1.2, 5.5 * 1.2, "");
    range_goal("munden", "kw, 3.8 to 4.2", m.kw, 3.8 / 1.2, 4.2 * 1.2, "");
    range_goal("munden", "ks, 19 to 23.1", m.ks, 19.0 / 1.2, 23.1 * 1.2, "");
    say("%-14syarns touch without thickness here: climbing over each other 8 times a loop, by a diameter, they would\n"
        "%-14sneed 4 %% more\n\n",
        "", "");
    scene_knit_free(k);
}

/* ---- lace ------------------------------------------------------------------------------------------------------- */

static void run_lace(void) {
    scene_knit *k = swatch("feather", scene_feather, 36, quick ? 4 : 8);
    double amplitude, other = 0.0, angle[4] = {0.0};
    int i, holes, made, bands = quick ? 2 : 4, turns = 0;
    if (k) {
        amplitude = scene_knit_wave(k, 2.0);
        for (i = 1; i < 9; i++)
            if (i != 2) other = fmax(other, scene_knit_wave(k, i));
        say("%-14samplitude %.1f mm, the next wave %.1f mm\n", "feather", 1e3 * amplitude, 1e3 * other);
        range_goal("feather", "wave of 18 stitches over others", amplitude / other, 1.0, 1e9, "");
    } else count_goal("feather", "wave", 0.0);
    scene_knit_free(k);
    k = swatch("diamonds", scene_diamond, 17, 14);
    if (k) {
        holes = scene_knit_holes(k, 0.75), made = 0;
        for (i = 0; i < 14; i++) made += i % 2 ? 0 : 4;
        range_goal("diamonds", "holes of those made", (double)holes / made, 1.0, 1.0, "");
    } else count_goal("diamonds", "holes", 0.0);
    scene_knit_free(k);
    k = swatch("chevron", scene_chevron, 23, 10 * bands);
    if (k) {
        for (i = 0; i < bands; i++) angle[i] = scene_knit_lean(k, 10.0 * i + 2.0, 10.0 * i + 10.0);
        for (i = 1; i < bands; i++) turns += angle[i] * angle[i - 1] < 0.0;
        say("%-14scolumns lean by %.1f, %.1f, %.1f, %.1f degrees\n", "chevron", angle[0] / degree, angle[1] / degree,
            angle[2] / degree, angle[3] / degree);
        range_goal("chevron", "changes of sign, of all", (double)turns / (double)(bands - 1), 1.0, 1.0, "");
    } else count_goal("chevron", "changes of sign", 0.0);
    scene_knit_free(k);
    say("\n");
}

/* ---- stretch ---------------------------------------------------------------------------------------------------- */

enum { FABRICS = 4 };
static const char *const fabric_name[FABRICS] = {"stockinette", "garter", "rib 1x1", "rib 2x2"};

/* Whether wrapping, then bending, then the yarn's stretch grow most, each somewhere and in that order: the share. */
static double regimes(const scene_knit_pull *p) {
    int n, stage = 0;
    for (n = 1; n < p->count; n++) {
        double wrap = p->energy[n][YC_TERM_WRAP] - p->energy[n - 1][YC_TERM_WRAP];
        double bend = p->energy[n][YC_TERM_BENDING] - p->energy[n - 1][YC_TERM_BENDING];
        double stretch = p->energy[n][YC_TERM_STRETCH] - p->energy[n - 1][YC_TERM_STRETCH];
        int most = wrap >= bend && wrap >= stretch ? 1 : bend >= stretch ? 2 : 3;
        if (most == stage + 1) stage++;
    }
    return stage / 3.0;
}

static void plot_stretch(scene_knit_pull (*pull)[2]) {
    ex_image *image = ex_image_new(900, 600, 255, 255, 255);
    ex_plot plot;
    int f, axis;
    if (!image) return;
    ex_plot_begin(
        &plot, image, 90, 50, 760, 470, 0.0, 2.0, 0.0, 0.3, "knits drawn out", "extension", "N per row or stitch");
    for (f = 0; f < FABRICS; f++)
        for (axis = 0; axis < 2; axis++) {
            static const int color[FABRICS][2] = {
                {0x1f77b4, 0x9ecae1}, {0x2ca02c, 0xa1d99b}, {0xd62728, 0xff9896}, {0x9467bd, 0xc5b0d5}};
            char name[64];
            snprintf(name, sizeof name, "%s %s", fabric_name[f], axis ? "lengthwise" : "widthwise");
            ex_plot_curve(&plot, pull[f][axis].stretch, pull[f][axis].force, pull[f][axis].count, color[f][axis], name);
        }
    if (!ex_image_write_png(image, "out/knit-stretch.png")) say("no picture out/knit-stretch.png\n");
    ex_image_free(image);
}

static void run_stretch(void) {
    static scene_knit_pull pull[FABRICS][2];
    const char *rows[FABRICS] = {scene_stockinette, scene_garter, scene_rib, scene_rib2};
    double at[FABRICS][2], lock[FABRICS][2], longest = 0.0;
    int f, axis, n = quick ? 8 : 12, i;
    for (f = 0; f < FABRICS; f++)
        for (axis = 0; axis < 2; axis++) {
            char why[YC_MESSAGE_SIZE] = "";
            scene_knit *k = scene_knit_new_elastic(rows[f], n, n, NULL, why);
            yc_result result = k ? YC_OK : YC_ERROR_DIVERGED;
            /* stockinette, which would roll up, is laid hold of while it lies flat */
            if (result == YC_OK && f) result = scene_knit_settle(k, 12);
            if (result == YC_OK) result = scene_knit_draw(k, axis, 0.05, 5.0, &pull[f][axis]);
            if (result != YC_OK) say("%-14s%s\n", fabric_name[f], k ? yc_scene_message(k->scene) : why);
            at[f][axis] = scene_knit_pull_at(&pull[f][axis], k ? 49.0 / (axis ? k->desc.wales : k->desc.courses) : 0.0);
            lock[f][axis] = scene_knit_pull_at(&pull[f][axis], 1.0);
            say("%-14s%-12s%d x %d: %.0f %% at 49 N/m, %.0f %% at 1 N per %s; %.0f s\n", fabric_name[f],
                axis ? "lengthwise" : "widthwise", n, n, 100.0 * at[f][axis], 100.0 * lock[f][axis],
                axis ? "stitch" : "row", k ? k->seconds : 0.0);
            if (f == 2 && !axis) /* what opposes a rib, in the paper's figure */
                for (i = 0; i < pull[f][0].count; i++)
                    say("%14s%6.1f %%%10.4f N, wrapping %.3g, bending %.3g, stretching %.3g mJ\n", "",
                        100.0 * pull[f][0].stretch[i], pull[f][0].force[i], 1e3 * pull[f][0].energy[i][YC_TERM_WRAP],
                        1e3 * pull[f][0].energy[i][YC_TERM_BENDING], 1e3 * pull[f][0].energy[i][YC_TERM_STRETCH]);
            scene_knit_free(k);
        }
    range_goal("stockinette", "widthwise at 49 N/m", at[0][0], 0.1, 0.4, "");
    for (f = 2; f < FABRICS; f++) {
        range_goal(fabric_name[f], "widthwise at 49 N/m", at[f][0], 0.4, 1.0, "");
        range_goal(fabric_name[f], "regimes, of three", 3.0 * regimes(&pull[f][0]), 3.0, 3.0, "");
    }
    for (f = 0; f < FABRICS; f++)
        if (f != 1) longest = fmax(longest, at[f][1]);
    range_goal("garter", "lengthwise, of the others' most", at[1][1] / longest, 1.0, 1e9, "");
    plot_stretch(pull);
    say("\n");
}

/* ---- drape and plasticity --------------------------------------------------------------------------------------- */

static void run_sphere(void) {
    const yc_yarn_material wool = scene_soft_wool();
    const int rows = quick ? 8 : 16;
    scene_knit_drape d[SCENE_FABRICS];
    double least = HUGE_VAL, fastest = 0.0;
    int i, j;
    for (i = 0; i < SCENE_FABRICS; i++) {
        const scene_fabric *f = &scene_fabrics[i];
        char why[YC_MESSAGE_SIZE] = "";
        scene_knit *k = scene_knit_new_above(*f->rows, f->stitches, rows, &wool, 1e-3 * rows, why);
        memset(&d[i], 0, sizeof d[i]);
        if (k && scene_knit_fall(k, 0.02, 20) == YC_OK) {
            d[i] = scene_knit_hang(k), fastest = fmax(fastest, k->moved / 0.02);
            say("%-18s%d x %d: drape coefficient %.3f, %.1f mm deep, its sides %.1f and its ends %.1f; %d sub-steps, "
                "%d Newton iterations, %.0f s\n",
                f->name, f->stitches, rows, d[i].shadow, 1e3 * d[i].depth, 1e3 * d[i].low[0], 1e3 * d[i].low[1],
                k->substeps, k->newton, k->seconds);
        } else {
            say("%-18sfailed: %s\n", f->name, k ? yc_scene_message(k->scene) : why), fastest = HUGE_VAL;
        }
        scene_knit_free(k);
        for (j = 0; j < i; j++)
            least = fmin(least, fmax(fabs(d[i].shadow / d[j].shadow - 1.0), fabs(d[i].depth / d[j].depth - 1.0)));
    }
    range_goal("sphere", "least difference of two", least, 0.03, 10.0, "");
    range_goal("sphere", "moves at, in the end", 1e3 * fastest, 0.0, 20.0, "mm/s");
    say("\n");
}

static void run_plastic(void) {
    double set[2] = {NAN, NAN};
    const int n = 8;
    int i;
    for (i = 0; i < 2; i++) {
        yc_yarn_material wool = scene_soft_wool();
        char why[YC_MESSAGE_SIZE] = "";
        double width[SCENE_PHASES];
        scene_knit *k;
        const double friction = i ? wool.friction : 0.0;
        yc_result result = YC_OK;
        int phase;
        wool.friction = 0.0;
        k = scene_knit_new(scene_garter, n, n, &wool, why);
        for (phase = 0; k && phase < SCENE_PHASES && result == YC_OK; phase++)
            result = scene_knit_overstretch(k, phase, friction, 0.5, &width[phase]);
        if (k && result == YC_OK) {
            set[i] = width[SCENE_AFTER] / width[SCENE_BEFORE] - 1.0;
            say("%-14s%d x %d, friction %.1f: stitches of %.2f mm, drawn to %.2f, then %.2f mm; %.0f s\n", "plastic", n,
                n, friction, 1e3 * width[SCENE_BEFORE], 1e3 * width[SCENE_DRAWN], 1e3 * width[SCENE_AFTER], k->seconds);
        } else say("%-14sfailed: %s\n", "plastic", k ? yc_scene_message(k->scene) : why);
        scene_knit_free(k);
    }
    range_goal("plastic", "wider, with friction", 100.0 * set[1], 2.0, 1e9, "%");
    range_goal("plastic", "without, of that", fmax(set[0], 0.0) / set[1], 0.0, 0.25, "");
    say("\n");
}

/* ---- cost ------------------------------------------------------------------------------------------------------- */

/* Whether a step has had its time. */
static int too_long(void *user, double done) {
    (void)done;
    return bench_clock() > *(const double *)user;
}

/* What a knit that hangs by its upper edge costs. */
typedef struct garment {
    int nodes, steps;
    double seconds, bytes; /* for a step */
    yc_stats stats;        /* newton, linear: of all steps */
} garment;

static garment hang_garment(const char *name, const yc_knit_desc *knit, int steps, double patience) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_host host;
    char why[YC_MESSAGE_SIZE] = "";
    yc_stats stats;
    scene_curtain *c;
    garment g;
    double begin = bench_clock(), end = begin + patience, last;
    yc_result result = YC_OK;
    memset(&g, 0, sizeof g), memset(&host, 0, sizeof host), memset(&stats, 0, sizeof stats);
    host.progress = too_long, host.user = &end;
    settings.linear_tolerance = 1e-2; /* Newton's method with semidefinite elements gains no more by an iteration */
    settings.newton_limit = 100;      /* of a sub-step; one that needs more is halved, and time is looked at */
    settings.solver = YC_SOLVER_TWO_LEVEL;
    c = scene_curtain_new(&host, &settings, scene_garter, knit, why);
    if (c) {
        g.nodes = c->yarns.node_count;
        say("%-14s%d loops, %d nodes, laid in %.1f s\n", name, knit->stitches * knit->rows, g.nodes,
            bench_clock() - begin);
    }
    for (begin = bench_clock(); c && result == YC_OK && g.steps < steps; g.steps += result == YC_OK) {
        last = bench_clock();
        result = yc_scene_step(c->scene, 1e-3, &stats);
        g.stats.newton += stats.newton, g.stats.linear += stats.linear, g.bytes = (double)stats.bytes_peak;
        say("%14s%s of 1 ms: %.1f s, %d Newton and %d linear iterations\n", "", result == YC_OK ? "a step" : "no step",
            bench_clock() - last, stats.newton, stats.linear);
    }
    if (!c || result != YC_OK) say("%14sfailed: %s\n", "", c ? yc_scene_message(c->scene) : why);
    g.seconds = g.steps ? (bench_clock() - begin) / g.steps : NAN;
    if (g.steps)
        say("%14s%.3g s a step, %.2g us a node and Newton iteration, %.2f GB\n", "", g.seconds,
            1e6 * g.seconds * g.steps / g.stats.newton / g.nodes, 1e-9 * g.bytes);
    scene_curtain_free(c);
    return g;
}

static void run_cost(void) {
    yc_knit_desc sweater = yc_knit_desc_default(), shirt = sweater, part = sweater;
    garment small, large;
    sweater.stitches = 200, sweater.rows = 280, shirt.stitches = 500, shirt.rows = 650;
    part.stitches = 50, part.rows = 70, memset(&large, 0, sizeof large), large.seconds = NAN;
    small = hang_garment("a sixteenth", &part, 3, 300.0);
    if (!quick) large = hang_garment("sweater", &sweater, 3, 600.0);
    range_goal("sweater", "s per frame", 1e3 / 30.0 * large.seconds, 0.0, 96.0, "s");
    if (large.steps)
        range_goal("sweater", "growth of time an iteration",
            log(large.seconds * large.steps / large.stats.newton * small.stats.newton / (small.seconds * small.steps)) /
                log((double)large.nodes / small.nodes),
            0.0, 1.1, "exponent");
    memset(&large, 0, sizeof large), large.seconds = NAN, large.bytes = NAN;
    if (!quick) large = hang_garment("T-shirt", &shirt, 1, 1200.0);
    range_goal("T-shirt", "s per frame", 1e3 / 30.0 * large.seconds, 0.0, 7.4 * 60.0, "s");
    if (!quick) range_goal("T-shirt", "memory", 1e-9 * large.bytes, 0.0, 4.0, "GB");
    say("\n");
}

int main(int argc, char **argv) {
    static const char *const part[] = {"curl", "rib", "munden", "lace", "stretch", "sphere", "plastic", "cost"};
    static void (*const run[])(void) = {
        run_curl, run_rib, run_munden, run_lace, run_stretch, run_sphere, run_plastic, run_cost};
    int i, k, parts = 0;
    for (i = 1; i < argc; i++) {
        quick |= !strcmp(argv[i], "--quick");
        for (k = 0; k < 8; k++) parts |= !strcmp(argv[i], part[k]) << k;
    }
    if (!parts) parts = 255;
    report_open("bench-knit");
    say("yarncloth %s, one thread\n\n", yc_version());
    for (k = 0; k < 8; k++)
        if (parts >> k & 1) run[k]();
    report_close();
    return 0;
}
