/* SPDX-License-Identifier: MIT */
/* For the estimators of this room: from where light comes to a place, as learned from paths; to draw directions by.
 *
 * Places (position and normal) lie in the cells of a binary tree, and each cell has a density over the sphere: constant
 * on the leaves of a tree of squares, which the equal-area map lays on the sphere. It is learned in rounds. Within one,
 * nothing changes but sums of integers, so that what is learned depends neither on the order of the records nor on who
 * made them. */
#ifndef SR_INTEGRATOR_GUIDE_H
#define SR_INTEGRATOR_GUIDE_H

#include "math/math.h"

/* Shares of directions that a cell may draw by what has been learned; the rest is the BSDF's. */
enum { SR_GUIDE_SHARES = 5, SR_GUIDE_KINDS = 2 };
extern const float sr_guide_shares[SR_GUIDE_SHARES];

/* What paths have brought that went on from such places, for what they carried, and what that took. */
struct sr_guide_returns {
    uint64_t count, brought, brought2, cost;
};

struct sr_guide_cell {
    struct sr_guide_returns returns[SR_GUIDE_KINDS];
    float mean[SR_GUIDE_KINDS];  // of what a path brings
    float worth[SR_GUIDE_KINDS]; // sqrt(E[brought^2] / E[cost]); infinite: not known at all
    uint32_t root;               // of the tree of squares
    bool has_light;              // else there is no density
    float share[SR_GUIDE_KINDS]; // [1] that has been chosen for Lambert's surfaces, and for all others
    uint64_t records, measured[SR_GUIDE_KINDS];
    uint64_t place[6], place2[6];                      // sums of coordinates and of their squares
    uint64_t moments[SR_GUIDE_KINDS][SR_GUIDE_SHARES]; // of the estimate's square, were the share this one
};

/* The density of a direction that the guide draws in that share of cases. */
static inline float sr_guide_mix(float share, float pdf_bsdf, float pdf_guide)
{
    return (1 - share) * pdf_bsdf + share * pdf_guide;
}

struct sr_guide;

/* Six whole numbers of 20 bits: position and normal. */
struct sr_guide_place {
    uint32_t of[6];
};

/* bounds: of places. light, noise: the expected values of a record's light and noise, which the integers are sized by:
 * the sums hold 2^24 records, whatever they are. Where returns are added, the two are those of what one brings, and of
 * its square. NULL: no memory. */
struct sr_guide *sr_guide_create(const struct sr_box *bounds, double light, double noise);
void sr_guide_destroy(struct sr_guide *guide);

struct sr_guide_place sr_guide_place(const struct sr_guide *guide, sr_vec3 p, sr_vec3 n);
uint32_t sr_guide_find(const struct sr_guide *guide, const struct sr_guide_place *place); // the cell's number
const struct sr_guide_cell *sr_guide_cell(const struct sr_guide *guide, uint32_t number);
size_t sr_guide_cell_count(const struct sr_guide *guide);

/* Only where the cell has light. */
float sr_guide_pdf(const struct sr_guide *guide, const struct sr_guide_cell *cell, sr_vec3 w); // [1/sr]
float sr_guide_sample(const struct sr_guide *guide, const struct sr_guide_cell *cell, sr_vec2 u,
                      sr_vec3 *w); // returns its density

/* A direction that has been drawn. Threads may add records at the same time, while nobody refines. */
struct sr_guide_record {
    uint32_t cell;
    struct sr_guide_place place;
    sr_vec3 w;
    double light;      // (L cos theta)^2 / pdf
    bool is_direction; // false: a delta function chose it; light is not looked at
    int kind;
    double noise;                   // what came of it, as the picture has it, squared
    float pdf, pdf_bsdf, pdf_guide; // pdf: as it was drawn
};
void sr_guide_add(struct sr_guide *guide, const struct sr_guide_record *record);
/* A path that has gone on from a place. A guide takes records or returns, not both. */
void sr_guide_add_return(struct sr_guide *guide, uint32_t cell, const struct sr_guide_place *place, int kind,
                         double brought, uint64_t cost);

/* Makes densities and shares of the sums, and finer cells and squares where there is enough to fill them. false: no
 * memory, the guide is as it was. */
bool sr_guide_refine(struct sr_guide *guide);

#endif
