/* The tensile test of a textile laboratory: a strip of cloth, clamped at both ends, is drawn, and the force is set
 * beside the strain.
 *
 *     tensile [shirting|linen|denim|satin|typed]      the first one without a name
 *
 * `typed` is a weave as a weaver would type it, of yarns as they are bought. Prints the curve, the extension at
 * 490 N/m, where the Kawabata system reads it, and what is measured there on fabrics of this kind. */
#include "yarncloth.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A 2/2 twill of worsted, 22 threads a centimetre each way; a row is a weft, X: the warp lies on top. */
static yc_result typed(yc_weave_desc *weave, char *why) {
    static const char rows[] = "XX.."
                               ".XX."
                               "..XX"
                               "X..X";
    static unsigned char over[16];
    yc_yarn_desc bought = yc_yarn_desc_default();
    yc_yarn_material yarn;
    yc_result result;
    int i;
    bought.fibre = YC_FIBRE_WOOL, bought.tex = 40.0;
    result = yc_yarn_material_make(&bought, &yarn, why);
    for (i = 0; i < 16; i++) over[i] = rows[i] == 'X';
    *weave = yc_weave_desc_default();
    weave->draft = over, weave->repeat[0] = weave->repeat[1] = 4;
    weave->warp = weave->weft = yarn;
    weave->spacing[0] = weave->spacing[1] = 0.01 / 22.0;
    weave->crimp[YC_WARP] = weave->crimp[YC_WEFT] = 0.06; /* without it cloth is as stiff as its yarns are straight */
    return result;
}

/* Pins the ends of the warps, which the layout has at v = 0 and v = height; those at the top are moved by `by`. Returns
 * the force on them, N, along v. */
static double clamp(yc_scene *scene, const yc_yarns *yarns, double height, double by, int measure) {
    double total = 0.0;
    int i;
    for (i = 0; i < yarns->node_count; i++) {
        const double *at = yarns->layout[i]; /* u, v of the pattern, here the cloth's x and y */
        double to[3], force[3];
        int top = at[1] > height - 1e-9;
        if (!top && at[1] > 1e-9) continue;
        to[0] = at[0], to[1] = at[1] + (top ? by : 0.0), to[2] = 0.0;
        if (!measure) yc_scene_pin(scene, 0, YC_NODE, i, to);
        else if (top && yc_scene_pin_force(scene, 0, YC_NODE, i, force) == YC_OK) total += force[1];
    }
    return total;
}

int main(int argc, char **argv) {
    static const char *const names[] = {"shirting", "linen", "denim", "satin", "typed"};
    enum { ACROSS = 40, ALONG = 40, STEPS = 60 }; /* threads; whole repeats of all drafts above */
    const double step = 2e-3, tension = 490.0;
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_fabric fabric;
    yc_weave_desc weave;
    yc_yarns yarns;
    yc_scene *scene = NULL;
    double force = 0.0, before, extension = 0.0;
    char why[YC_MESSAGE_SIZE] = "";
    int name = 0, i;

    while (argc > 1 && name < 5 && strcmp(argv[1], names[name]) != 0) name++;
    if (name == 5) return fputs("tensile [shirting|linen|denim|satin|typed]\n", stderr), 2;
    memset(&fabric, 0, sizeof fabric);
    if (name < 4) yc_fabric_get((yc_fabric_name)(YC_FABRIC_SHIRTING + name), &fabric), weave = fabric.weave;
    else if (typed(&weave, why) != YC_OK) return fprintf(stderr, "%s\n", why), 1;
    weave.size[0] = ACROSS * weave.spacing[0], weave.size[1] = ALONG * weave.spacing[1];

    /* Quasi-static: a time step of 1000 s, beside which inertia is nothing, so that each step ends in equilibrium, to
     * 10 nm. Damping by mass, even a little of it, holds motions that nothing else resists. No yarn slides in this
     * test: the clamps hold the warps, and the wefts move apart evenly. */
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.dt_max = 1e3, settings.dt_min = 1.0, settings.mass_damping = 1.0;
    settings.tolerance = 1e-8, settings.newton_limit = 200;
    if (yc_weave(NULL, &weave, NULL, &yarns, why) != YC_OK) return fprintf(stderr, "%s\n", why), 1;
    if (yc_scene_create(NULL, &settings, &scene, why) != YC_OK) return fprintf(stderr, "%s\n", why), 1;
    cloth.yarns = &yarns, cloth.hold_sliding = 1, cloth.hold_network = 1;
    if (yc_scene_add_cloth(scene, &cloth, NULL) != YC_OK) return fprintf(stderr, "%s\n", yc_scene_message(scene)), 1;

    printf("%s, %d warps and %d wefts, %.1f x %.1f mm, drawn along the warps\n", name < 4 ? fabric.name : "typed twill",
        ACROSS, ALONG, 1e3 * weave.size[0], 1e3 * weave.size[1]);
    printf("  strain, %%   force, N/m\n  %9.1f   %10.1f\n", 0.0, 0.0);
    for (i = 1; i <= STEPS && force < tension; i++) {
        clamp(scene, &yarns, weave.size[1], step * i * weave.size[1], 0);
        if (yc_scene_step(scene, 1e3, NULL) != YC_OK) return fprintf(stderr, "%s\n", yc_scene_message(scene)), 1;
        before = force;
        force = clamp(scene, &yarns, weave.size[1], 0.0, 1) / weave.size[0];
        printf("  %9.1f   %10.1f\n", 100.0 * step * i, force);
        if (force >= tension) extension = step * (i - (force - tension) / (force - before));
    }
    if (extension > 0.0) printf("extension at %.0f N/m: %.2f %%", tension, 100.0 * extension);
    else printf("%.0f N/m not reached", tension);
    if (name < 4)
        printf("; measured on such cloth: %.0f to %.0f %%", 100.0 * fabric.extension[0], 100.0 * fabric.extension[1]);
    printf("\n");
    yc_scene_destroy(scene);
    yc_yarns_destroy(&yarns);
    return 0;
}
