/* Cloth that lets its yarns go: a weft that is hooked, a yarn pulled out, a frayed edge, a strip and a corner that are
 * drawn. On swatches without a mesh, in the xy plane, as long as they have the yarns they were woven with. */
#ifndef SCENES_WOVEN_H
#define SCENES_WOVEN_H

#include "yarncloth.h"

typedef enum scene_pull {
    SCENE_SNAG,    /* a loop: see scene_woven_hook. All warps are held at both ends */
    SCENE_PULLOUT, /* the weft in the middle, by its last end. All warps are held at both ends */
    SCENE_FRAY,    /* the last warp, by its first end. All others but the one beside it are held at both ends */
    SCENE_STRIP,   /* two neighbouring warps in the middle, one by its last end, one by its first, the other way. After
                      MIX, Fig. 7 */
    SCENE_CORNER   /* crossings at the last corner, as many held at the first. After MIX, Fig. 6 */
} scene_pull;

/* The k-th yarn of a family; what it visits, counted from its start or, where `visit` is negative, from its end. */
int scene_woven_yarn(const yc_yarns *yarns, int family, int k);
int scene_woven_visit(const yc_yarns *yarns, int family, int k, int visit);
int scene_woven_node(const yc_yarns *yarns, int family, int k, int visit);

/* A copy in which the weft in the middle has a node of its own, the last, where it crosses the warp in the middle, and
 * passes that by. It shares the other arrays with `yarns`, which goes with it. 0: memory is out. */
int scene_woven_hook(yc_yarns *yarns, yc_yarns *out);
void scene_woven_unhook(yc_yarns *hooked);

/* Draws a node of cloth 0 to where it was woven, moved by `by`, over the next step; NULL: lets it go. */
yc_result scene_woven_draw(yc_scene *scene, const yc_yarns *yarns, int node, const double by[3]);

/* Holds what is held and draws what is drawn, the strip's second warp against `by`; NULL: lets that go. */
yc_result scene_woven_pull(yc_scene *scene, const yc_yarns *yarns, scene_pull pull, const double by[3]);

/* The node that is drawn; of a corner the one in the middle. */
int scene_woven_drawn(const yc_yarns *yarns, scene_pull pull);

#endif
