/* Lays the flat pieces of a pattern round the mannequin as a start for sewing.
 *
 * Front and back are rolled along one smooth closed curve round the torso, keeping lengths (a sheet may bend one way at
 * a time); towards the shoulders the sideways bend is let out while the sheet starts to lean over the body.  Sleeves
 * are rolled round the upper arms and stay open underneath.  Nothing touches the body; right sides face outwards. */
#ifndef EX_PLACE_H
#define EX_PLACE_H

#include "ex_body.h"
#include "ex_obj.h"

typedef struct ex_placement {
    double clearance; /* smallest distance of a vertex from the body, m */
    double seam_gap;  /* largest distance between two vertices to be sewn together, m */
    double seam_mean;
    double stretch_low; /* smallest and largest edge length over its rest length */
    double stretch_high;
} ex_placement;

/* Fills positions[pattern->vertex_count]; returns 0 when memory ran out or the body lacks the cones that are needed
 * (upper_arm_1_l and so on).  `placement` may be NULL. */
int ex_place_pattern(const ex_pattern *pattern, const ex_body *body, double (*positions)[3], ex_placement *placement);

#endif
