/* bench-woven: woven fabrics against what laboratories measure, weaves of the same yarns among themselves, and the cost
 * of a time step.
 *
 *   bench-woven [--quick] [--pictures] [fabrics | weaves | speed ...]     only these parts
 *
 * Pictures of the tests are written into out/, woven-CLOTH-TEST.png.
 *
 * Fabrics. Each of the named fabrics is tested as tests/scenes/mechanics.h says, its yarns laid one by one, and set
 * beside the range measured on fabrics of its kind.
 *   mass       of what is laid
 *   extension  at the range's tension. The swatch is four times as wide as it is long, as that of the Kawabata system,
 *              clamped along its long sides. Beside it, without a goal, a narrow strip and a swatch that keeps its
 *              width
 *   modulus    initial, the first 0.1 % (no range is known), and final, the slope at that tension. Its range follows
 *              from that of the extension: a power law whose linearity is LT (the work under the curve over that of a
 *              straight line) ends with the slope (2/LT - 1) tension / extension, and LT lies between 0.6 and 0.8
 *   bias       slopes of a strip cut at 45 degrees at the start, where friction holds, and at 2 % and 5 % of its
 *              middle, where it has yielded; no range is known
 *   shear      between 0.5 and 2.5 degrees, and the loop's width at 0.5 degrees (2HG), of a loop to 8 degrees under a
 *              tension of 9.8 N/m, mean of both directions
 *   bending    by the cantilever, at an overhang of two bending lengths
 *   drape      of a disc of 30 cm on a support of 18 cm, of yarns in bundles and without crimp, the mean of three
 *              starts. In range with two sizes of bundles, and alike within 3 points
 * What stays outside: the extension of denim's wefts and of satin, since a cloth cannot give much more than the crimp
 * of its yarns, 3.5, 3 and 2 %, of which a part remains at the range's tension; and drape, by 2 points of shirting, 11
 * of denim, 8 of satin. It follows bending, whose ranges are three times as wide: shirting bends as the stiffest of its
 * kind, denim as the softest. Denim of yarns 1.8 times as stiff, then in the middle of that range, drapes to 81 %;
 * satin of 0.57 times as stiff ones to 36 %. Without friction shirting would lose 5 points, denim 4, satin 2.
 *
 * Weaves. Plain, twill 2/2 and five-end satin of a shirting's yarns, as high over their crossings as in the plain
 * weave, so that crimp is less the fewer there are. A goal for shear stiffness, for the loop, for bending and for
 * drape, the mean of ten starts, beside its standard error: satin gives most, plain least, in order. Bending is out of
 * order by 3 % and 0.7 %: in all three the cantilever finds EI / spacing of the yarns over 1 + crimp within 0.5 %, with
 * friction and resistance against turning or without, and EI / spacing itself where there is no crimp. Crossings take
 * no part in the model's bending, and a plain weave's yarns are the longest in the same cloth. What stiffens real plain
 * weaves, fibres that crossings press and that rub as they slide past each other, is not in it.
 *
 * Speed. A square of plain weave of 1 mm, held by one edge, swings down from the horizontal, 1 ms a step, default
 * settings, after 60 ms in steps of 5 ms. Microseconds of processor time, on one thread, per crossing and step, the
 * median of 20 steps; the exponent is that of the time by crossings from the smallest to the largest. The drop of the
 * free edge is set beside a run to a tolerance of 1e-8 m and a linear one of 1e-6, and, without a goal, beside one of
 * steps eight times as short. Goals: 10 us, 1.1, and 0.1 % of the drop. Then, without a goal, the cost of a shirting,
 * with its crimp. */
#define _POSIX_C_SOURCE 200809L /* NOLINT(bugprone-reserved-identifier): what POSIX prescribes */
#include "bench.h"
#include "report.h"
#include "../../examples/common/ex_yarns.h"
#include "../scenes/mechanics.h"
#include "yarncloth.h"
#include <math.h>

static const double degree = 3.14159265358979323846 / 180.0;

static int quick, pictures;

/* ---- goals ------------------------------------------------------------------------------------------------------ */

/* A measured range, and the share of it that is reached: inside 1, outside the quotient with the nearer end. */
static double report_range(
    const char *name, const char *what, double value, const double range[2], double unit, const char *unit_name) {
    double share = value >= range[0] && value <= range[1] ? 1.0
        : value < range[0]                                ? value / range[0]
                                                          : range[1] / value;
    if (!isfinite(value)) share = 0.0; /* a curve that ended before */
    say("%-17s%-22s%11.4g  %9.4g to %-9.4g %-8s %s\n", name, what, value / unit, range[0] / unit, range[1] / unit,
        unit_name, share >= 1.0 ? "in" : "out");
    return share;
}

/* The same as a goal. */
static void report(
    const char *name, const char *what, double value, const double range[2], double unit, const char *unit_name) {
    count_goal(name, what, report_range(name, what, value, range, unit, unit_name));
}

static void report_alone(const char *name, const char *what, double value, double unit, const char *unit_name) {
    say("%-17s%-22s%11.4g  %22s %s\n", name, what, value / unit, "", unit_name);
}

static void failed(const char *name, const char *what, const char *message) {
    say("%-17s%-22s%11s  %s\n", name, what, "failed", message);
}

/* ---- pictures --------------------------------------------------------------------------------------------------- */

static char picture_of[96]; /* the fabric and the test that is drawn next; empty: none */

static void picture(const scene_sample *s) {
    static const double from[2][3] = {{0.0, 0.9, 0.35}, {0.5, 0.35, 0.9}};
    const yc_weave_desc *w = &s->weave;
    int flat = !strstr(picture_of, "drape") && !strstr(picture_of, "bending");
    ex_yarns_view view = {900, 600, 1, {0.0, 0.0, 0.0}, 1.0, {0.0, 0.0}, 1.0, 1, NULL};
    char path[128], message[YC_MESSAGE_SIZE], *c;
    ex_camera camera;
    ex_image *image;
    if (!*picture_of) return;
    memcpy(view.from, from[!flat], sizeof view.from);
    view.fuller = fmax(1.0, 0.42 * fmin(w->spacing[0], w->spacing[1]) / fmax(w->warp.radius, w->weft.radius));
    for (c = picture_of; *c; c++)
        if (strchr(" ,/", *c)) *c = '-';
    snprintf(path, sizeof path, "out/woven-%s.png", picture_of);
    image = ex_yarns_draw(s->scene, 0, &view, NULL, &camera, 0, message);
    if (!image || !ex_image_write_png(image, path)) say("no picture %s: %s\n", path, image ? "writing" : message);
    ex_image_free(image);
    *picture_of = 0;
}

/* The next test of this cloth is drawn. */
static void take_picture(const char *cloth, const char *test) {
    if (pictures) snprintf(picture_of, sizeof picture_of, "%s %s", cloth, test);
}

/* ---- tests of a fabric ----------------------------------------------------------------------------------------- */

static int repeat_of(const yc_weave_desc *w) { return w->repeat[0] > w->repeat[1] ? w->repeat[0] : w->repeat[1]; }

static yc_result tensile(const yc_weave_desc *w, int axis, int across, int along, int hold_width, double force,
    scene_tensile *out, char *message) {
    scene_tensile_desc d;
    memset(&d, 0, sizeof d);
    d.weave = *w, d.axis = axis, d.across = across, d.along = along, d.hold_width = hold_width;
    d.step = 1e-3, d.force = 1.1 * force, d.strain = 0.2, d.show = picture;
    return scene_tensile_run(&d, out, message);
}

static yc_result shear(const yc_weave_desc *w, int axis, int crossings, scene_shear_loop *out, char *message) {
    scene_shear_desc d;
    memset(&d, 0, sizeof d);
    d.weave = *w, d.axis = axis, d.across = d.along = crossings;
    d.tension = 9.80665, d.angle = 8.0 * degree, d.steps = 16, d.show = picture;
    return scene_shear_run(&d, out, message);
}

static yc_result cantilever(const yc_weave_desc *w, int axis, int times, scene_cantilever *out, char *message) {
    double rigidity = (axis ? w->warp : w->weft).bending / w->spacing[!axis];
    scene_cantilever_desc d;
    memset(&d, 0, sizeof d);
    d.weave = *w, d.axis = axis, d.across = times * (w->draft ? repeat_of(w) : 4);
    d.overhang = 2.0 * cbrt(rigidity / (9.81 * yc_weave_material(w).density)), d.show = picture;
    return scene_cantilever_run(&d, out, message);
}

/* The slope of the curve, N/m, at a strain of the middle. */
static double slope_near(const scene_tensile *c, double strain) {
    int k = 1;
    while (k < c->count && c->strain[k] < strain) k++;
    return k < c->count ? (c->force[k] - c->force[k - 1]) / (c->strain[k] - c->strain[k - 1]) : NAN;
}

static void report_tension(const yc_fabric *f) {
    static const char *const family[] = {"weft", "warp"};
    char message[YC_MESSAGE_SIZE], what[64];
    scene_tensile curve;
    scene_tensile_desc bias;
    double final[2];
    int axis, form, n = repeat_of(&f->weave) > 2 ? 6 * repeat_of(&f->weave) : 20;
    final[0] = (2.0 / 0.8 - 1.0) * f->tension / f->extension[1];
    final[1] = (2.0 / 0.6 - 1.0) * f->tension / f->extension[0];
    for (axis = 1; axis >= 0; axis--) {
        snprintf(what, sizeof what, "tension, %s", family[axis]);
        take_picture(f->name, what);
        if (tensile(&f->weave, axis, 64, 16, 0, f->tension, &curve, message) != YC_OK) {
            failed(f->name, what, message), count_goal(f->name, what, 0.0), count_goal(f->name, what, 0.0);
            continue;
        }
        snprintf(what, sizeof what, "extension, %s", family[axis]);
        report(f->name, what, scene_tensile_at(&curve, f->tension), f->extension, 0.01, "%");
        snprintf(what, sizeof what, "initial modulus, %s", family[axis]);
        report_alone(f->name, what, curve.force[1] / curve.strain[1], 1e3, "kN/m");
        snprintf(what, sizeof what, "final modulus, %s", family[axis]);
        report(f->name, what, scene_tensile_slope(&curve, f->tension), final, 1e3, "kN/m");
        for (form = 0; form < 2; form++) {
            if (tensile(&f->weave, axis, n / 2, n, form, f->tension, &curve, message) != YC_OK) continue;
            snprintf(what, sizeof what, form ? "  width held, %s" : "  narrow strip, %s", family[axis]);
            report_alone(f->name, what, scene_tensile_at(&curve, f->tension), 0.01, "%");
        }
    }
    memset(&bias, 0, sizeof bias);
    bias.weave = f->weave, bias.weave.grain = 45.0 * degree, bias.axis = 1, bias.across = 12, bias.along = 36;
    if (repeat_of(&f->weave) > 4) bias.across = 16;
    bias.step = 5e-3, bias.force = f->tension, bias.strain = 0.08, bias.show = picture;
    take_picture(f->name, "bias");
    if (scene_tensile_run(&bias, &curve, message) == YC_OK) {
        report_alone(f->name, "modulus, bias, start", curve.force[1] / curve.strain[1], 1e3, "kN/m");
        report_alone(f->name, "modulus, bias, 2 %", slope_near(&curve, 0.02), 1e3, "kN/m");
        report_alone(f->name, "modulus, bias, 5 %", slope_near(&curve, 0.05), 1e3, "kN/m");
    } else failed(f->name, "modulus, bias", message);
}

static void report_shear(const yc_fabric *f) {
    char message[YC_MESSAGE_SIZE];
    scene_shear_loop loop[2];
    yc_weave_desc w = f->weave;
    /* Whole repeats. Smaller, the border makes it soft; larger, a swatch of denim comes near buckling. */
    int n = repeat_of(&w) == 5 ? 10 : 12;
    take_picture(f->name, "shear");
    if (shear(&w, 0, n, loop, message) == YC_OK && shear(&w, 1, n, loop + 1, message) == YC_OK) {
        report(f->name, "shear stiffness", 0.5 * (loop[0].stiffness + loop[1].stiffness), f->shear, 1.0, "N/m");
        report(f->name, "shear loop, 2HG", 0.5 * (loop[0].hysteresis + loop[1].hysteresis), f->hysteresis, 1.0, "N/m");
    } else {
        failed(f->name, "shear", message);
        count_goal(f->name, "shear stiffness", 0.0), count_goal(f->name, "shear loop, 2HG", 0.0);
    }
}

static void report_bending(const yc_fabric *f) {
    char message[YC_MESSAGE_SIZE];
    scene_cantilever c;
    int axis;
    for (axis = 1; axis >= 0; axis--) {
        const char *what = axis ? "bending, warp" : "bending, weft";
        take_picture(f->name, what);
        if (cantilever(&f->weave, axis, 1, &c, message) == YC_OK) {
            report(f->name, what, c.rigidity, f->bending[!axis], 1e-6, "uN m");
            report_alone(f->name, "  bending length", c.length, 0.01, "cm");
        } else failed(f->name, what, message), count_goal(f->name, what, 0.0);
    }
}

/* In bundles of that width, m, the mean of some starts, and its standard error. */
static yc_result drape_of(
    const yc_weave_desc *weave, double width, int starts, scene_drape *mean, double *error, char *message) {
    scene_drape_desc d = scene_drape_desc_default(weave);
    double square = 0.0;
    int family, k = (int)(width / sqrt(weave->spacing[0] * weave->spacing[1]) + 0.5);
    scene_drape drape;
    for (family = 0; family < 2; family++) {
        yc_yarn_material *m = family == YC_WARP ? &d.weave.warp : &d.weave.weft;
        m->density *= 1.0 + d.weave.crimp[family], d.weave.crimp[family] = 0.0;
    }
    d.weave.bundle = k, d.show = picture;
    memset(mean, 0, sizeof *mean);
    for (d.start = 0; d.start < starts; d.start++) {
        yc_result result = scene_drape_run(&d, &drape, message);
        if (result != YC_OK) return result;
        square += drape.coefficient * drape.coefficient / starts;
        mean->coefficient += drape.coefficient / starts, mean->drift = fmax(mean->drift, fabs(drape.drift));
        mean->folds += drape.folds, mean->crossings = drape.crossings;
    }
    mean->folds = (mean->folds + starts / 2) / starts;
    *error = starts > 1 ? sqrt(fmax(0.0, square - mean->coefficient * mean->coefficient) / (starts - 1)) : NAN;
    return YC_OK;
}

/* The mean must be in range with both sizes of bundles, and both alike within 3 points. */
static void report_drape(const yc_fabric *f) {
    static const double width[2] = {4.6e-3, 3.3e-3};
    char message[YC_MESSAGE_SIZE] = "", what[64];
    double share = 1.0, last = NAN, error;
    scene_drape drape;
    int pass;
    for (pass = 0; pass < (quick ? 1 : 2); pass++) {
        yc_result result;
        take_picture(f->name, "drape");
        result = drape_of(&f->weave, width[pass], quick ? 1 : 3, &drape, &error, message);
        snprintf(what, sizeof what, "drape, bundles %g mm", 1e3 * width[pass]);
        if (result != YC_OK) failed(f->name, what, message), share = 0.0, drape.coefficient = NAN;
        else {
            share = fmin(share, report_range(f->name, what, drape.coefficient, f->drape, 0.01, "%"));
            say("%-17s  %d crossings, %d folds, standard error %.1f %%, still moving by %.1g %%\n", f->name,
                drape.crossings, drape.folds, 100.0 * error, 100.0 * drape.drift);
        }
        if (pass) count_goal(f->name, "drape, both alike", 0.03 / fabs(drape.coefficient - last));
        last = drape.coefficient;
    }
    count_goal(f->name, "drape", share);
}

/* What larger swatches change. */
static void report_sizes(const yc_fabric *f) {
    char message[YC_MESSAGE_SIZE];
    scene_tensile curve[2];
    scene_shear_loop loop[2];
    scene_cantilever c[2];
    if (tensile(&f->weave, 1, 64, 16, 0, f->tension, curve, message) == YC_OK &&
        tensile(&f->weave, 1, 96, 24, 0, f->tension, curve + 1, message) == YC_OK)
        say("%-17s  extension, warp, 1.5 times the swatch: x %.3f\n", f->name,
            scene_tensile_at(curve + 1, f->tension) / scene_tensile_at(curve, f->tension));
    if (shear(&f->weave, 1, 12, loop, message) == YC_OK && shear(&f->weave, 1, 24, loop + 1, message) == YC_OK)
        say("%-17s  shear stiffness, twice the swatch: x %.3f\n", f->name, loop[1].stiffness / loop[0].stiffness);
    if (cantilever(&f->weave, 1, 1, c, message) == YC_OK && cantilever(&f->weave, 1, 4, c + 1, message) == YC_OK)
        say("%-17s  bending, warp, 4 times as wide: x %.3f\n", f->name, c[1].rigidity / c[0].rigidity);
}

static void run_fabrics(void) {
    int name;
    say("%-17s%-22s%11s  %22s\n", "fabric", "", "simulated", "measured");
    for (name = YC_FABRIC_SHIRTING; name <= YC_FABRIC_SATIN; name++) {
        yc_fabric f;
        if (yc_fabric_get((yc_fabric_name)name, &f) != YC_OK) continue;
        if (quick && name != YC_FABRIC_SHIRTING && name != YC_FABRIC_SATIN) continue;
        report(f.name, "mass", yc_weave_material(&f.weave).density, f.mass, 1e-3, "g/m^2");
        report_tension(&f), report_shear(&f), report_bending(&f), report_drape(&f);
        if (name == YC_FABRIC_SHIRTING && !quick) report_sizes(&f);
        say("\n");
    }
}

/* ---- weaves ----------------------------------------------------------------------------------------------------- */

static void order_goal(const char *what, const double value[3]) {
    double first = value[0] / value[1], second = value[1] / value[2];
    say("%-17splain / twill %.4f, twill / satin %.4f  %s\n", what, first, second,
        first > 1.0 && second > 1.0 ? "in order" : "not in order");
    if (!isfinite(first + second)) first = 0.0; /* one was not measured */
    count_goal("weaves", what, first > 1.0 && second > 1.0 ? 1.0 : fmin(first, fmin(second, 0.999)));
}

static void run_weaves(void) {
    static const char *const name[] = {"plain", "twill 2/2", "satin 5"};
    static const double changes[] = {1.0, 0.5, 0.4}; /* of side, per crossing */
    double stiffness[3], hysteresis[3], rigidity[3], coefficient[3];
    char message[YC_MESSAGE_SIZE];
    yc_draft draft[3];
    yc_fabric f;
    int k;
    memset(draft, 0, sizeof draft);
    if (yc_fabric_get(YC_FABRIC_SHIRTING, &f) != YC_OK || yc_draft_plain(NULL, draft, NULL) != YC_OK ||
        yc_draft_twill(NULL, 2, 2, 'Z', draft + 1, NULL) != YC_OK ||
        yc_draft_satin(NULL, 5, 2, YC_WARP, draft + 2, NULL) != YC_OK)
        return;
    say("%-17s%12s%12s%12s%16s%12s%12s%12s\n", "weave", "G, N/m", "2HG, N/m", "B, uN m", "B (1 + crimp)", "drape, %",
        "+-", "crimp, %");
    for (k = 0; k < 3; k++) {
        yc_weave_desc w = f.weave;
        scene_shear_loop loop[2];
        scene_cantilever bend[2];
        scene_drape drape;
        double error = NAN, yarns = NAN;
        int axis;
        w.draft = draft[k].over, w.repeat[0] = draft[k].repeat[0], w.repeat[1] = draft[k].repeat[1];
        w.crimp[0] *= changes[k], w.crimp[1] *= changes[k];
        stiffness[k] = hysteresis[k] = rigidity[k] = coefficient[k] = NAN;
        take_picture(name[k], "shear");
        for (axis = 0; axis < 2; axis++)
            if (shear(&w, axis, 20, loop + axis, message) != YC_OK ||
                cantilever(&w, axis, 1, bend + axis, message) != YC_OK)
                break;
        if (axis == 2) {
            stiffness[k] = 0.5 * (loop[0].stiffness + loop[1].stiffness);
            hysteresis[k] = 0.5 * (loop[0].hysteresis + loop[1].hysteresis);
            rigidity[k] = 0.5 * (bend[0].rigidity + bend[1].rigidity);
            yarns = 0.5 * (bend[0].rigidity * (1.0 + w.crimp[YC_WEFT]) + bend[1].rigidity * (1.0 + w.crimp[YC_WARP]));
            take_picture(name[k], "drape");
            if (drape_of(&w, 4.6e-3, quick ? 1 : 10, &drape, &error, message) == YC_OK)
                coefficient[k] = drape.coefficient;
            else failed(name[k], "drape", message);
        } else failed(name[k], "", message);
        say("%-17s%12.4g%12.4g%12.4g%16.4g%12.4g%12.2g%12.3g\n", name[k], stiffness[k], hysteresis[k],
            1e6 * rigidity[k], 1e6 * yarns, 100.0 * coefficient[k], 100.0 * error, 100.0 * w.crimp[0]);
    }
    order_goal("shear stiffness", stiffness), order_goal("shear loop, 2HG", hysteresis),
        order_goal("bending", rigidity), order_goal("drape", coefficient);
    for (k = 0; k < 3; k++) yc_draft_destroy(draft + k);
    say("\n");
}

/* ---- speed ------------------------------------------------------------------------------------------------------ */

enum { BEFORE = 12, STEPS = 20 }; /* 5 ms each, and 1 ms each, which count */

typedef struct {
    double microseconds, drop, newton, linear, bytes;
    int crossings;
} swing;

/* With those last steps of 1 ms each cut into `cuts`. */
static int run_swing(const yc_weave_desc *weave, int side, int reference, int cuts, swing *out) {
    char message[YC_MESSAGE_SIZE];
    yc_weave_desc w = *weave;
    yc_scene_desc settings = yc_scene_desc_default();
    scene_sample *s;
    yc_stats stats;
    double times[STEPS];
    yc_result result = YC_OK;
    int i, k, edge = 0;
    memset(out, 0, sizeof *out), memset(&stats, 0, sizeof stats);
    w.size[0] = side * w.spacing[0], w.size[1] = side * w.spacing[1];
    settings.gravity[1] = 0.0, settings.gravity[2] = -9.81, settings.dt_max = 5e-3;
    if (reference) settings.tolerance = 1e-8, settings.linear_tolerance = 1e-6;
    s = scene_sample_new(&w, NULL, &settings, 0, message);
    if (!s) return 0;
    for (i = 0; i < s->yarns.node_count; i++)
        if (s->yarns.layout[i][1] < 1e-9) yc_scene_pin(s->scene, 0, YC_NODE, i, NULL);
    for (k = 0; k < BEFORE && result == YC_OK; k++) result = yc_scene_step(s->scene, 5e-3, &stats);
    settings.dt_max = 1e-3 / cuts;
    if (result == YC_OK) result = yc_scene_tune(s->scene, &settings);
    for (k = 0; k < STEPS && result == YC_OK; k++) {
        double begin = bench_clock();
        result = yc_scene_step(s->scene, 1e-3, &stats);
        times[k] = bench_clock() - begin;
        out->newton += (double)stats.newton / STEPS, out->linear += (double)stats.linear / STEPS;
    }
    out->crossings = s->yarns.visit_count - s->yarns.node_count, out->bytes = (double)stats.bytes_peak / out->crossings;
    if (result == YC_OK) result = yc_scene_positions(s->scene, 0, YC_NODE, s->x);
    if (result == YC_OK) {
        out->microseconds = 1e6 * bench_quantile(times, STEPS, 0.5) / out->crossings;
        for (i = 0; i < s->yarns.node_count; i++)
            if (s->yarns.layout[i][1] > w.size[1] - 1e-9) out->drop -= s->x[i][2], edge++;
        out->drop /= edge;
        if (!reference && side < 100 && w.crimp[0] == 0.0) take_picture("1 mm", "speed"), picture(s);
    } else say("%d crossings: %s\n", out->crossings, yc_scene_message(s->scene));
    scene_sample_free(s);
    return result == YC_OK;
}

static void run_speed(void) {
    static const int side[] = {71, 141, 283};
    int k, count = quick ? 2 : 3, done = 0;
    double exponent;
    swing own[3], reference;
    yc_weave_desc plain = yc_weave_desc_default();
    yc_fabric f;
    plain.spacing[0] = plain.spacing[1] = 1e-3;
    say("%-12s%14s%10s%10s%12s%14s%14s%12s\n", "crossings", "us per step", "Newton", "linear", "bytes each", "drop, mm",
        "reference", "off");
    for (k = 0; k < count; k++) {
        char what[64];
        if (!run_swing(&plain, side[k], 0, 1, own + k)) own[k].microseconds = HUGE_VAL;
        else done = k;
        say("%-12d%14.2f%10.1f%10.1f%12.0f%14.5f", own[k].crossings, own[k].microseconds, own[k].newton, own[k].linear,
            own[k].bytes, 1e3 * own[k].drop);
        if (k < (quick ? 1 : 3)) {
            double off =
                run_swing(&plain, side[k], 1, 1, &reference) ? fabs(own[k].drop / reference.drop - 1.0) : HUGE_VAL;
            say("%14.5f%11.3f%%", 1e3 * reference.drop, 100.0 * off);
            snprintf(what, sizeof what, "drop at %d", own[k].crossings);
            count_goal("speed", what, 1e-3 / off);
        }
        say("\n");
        snprintf(what, sizeof what, "us per crossing at %d", own[k].crossings);
        count_goal("speed", what, 10.0 / own[k].microseconds);
    }
    exponent =
        1.0 + log(own[done].microseconds / own[0].microseconds) / log((double)own[done].crossings / own[0].crossings);
    say("exponent %.3f\n", exponent);
    if (!quick && run_swing(&plain, side[0], 1, 8, &reference))
        say("drop at %d of steps of 0.125 ms: %.5f mm, off %.3f%%\n", own[0].crossings, 1e3 * reference.drop,
            100.0 * fabs(own[0].drop / reference.drop - 1.0));
    if (yc_fabric_get(YC_FABRIC_SHIRTING, &f) == YC_OK && run_swing(&f.weave, side[0], 0, 1, &reference))
        say("%s with its crimp: %d crossings, %.2f us per step, Newton %.1f, linear %.1f, %.0f bytes each\n", f.name,
            reference.crossings, reference.microseconds, reference.newton, reference.linear, reference.bytes);
    say("\n");
    count_goal("speed", "exponent", done ? 1.1 / exponent : 0.0);
}

int main(int argc, char **argv) {
    int i, parts = 0;
    for (i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--quick")) quick = 1;
        else if (!strcmp(argv[i], "--pictures")) pictures = 1;
        else
            parts |= !strcmp(argv[i], "fabrics") ? 1
                : !strcmp(argv[i], "weaves")     ? 2
                : !strcmp(argv[i], "speed")      ? 4
                                                 : 0;
    }
    if (!parts) parts = 7;
    report_open("bench-woven");
    say("yarncloth %s, one thread\n\n", yc_version());
    if (parts & 1) run_fabrics();
    if (parts & 2) run_weaves();
    if (parts & 4) run_speed();
    report_close();
    return 0;
}
