/* SPDX-License-Identifier: MIT */
/* The tables of numbers behind this room, written by scripts/make-spectrum-data. Only this room includes them. */
#ifndef SR_SPECTRUM_DATA_H
#define SR_SPECTRUM_DATA_H

#include "spectrum/spectrum.h"

#define SR_OBSERVER_COUNT 471 // 360 … 830 nm by 1 nm

extern const double sr_data_observer[SR_OBSERVER_COUNT][3];
extern const float sr_data_observer_f[SR_OBSERVER_COUNT + 1][4];
extern const struct sr_colour_space sr_data_colour_spaces[SR_COLOUR_SPACE_COUNT];

extern const struct sr_table sr_data_a, sr_data_pbrt_d50, sr_data_d50, sr_data_d65, sr_data_aces_d60;
extern const struct sr_table sr_data_f1, sr_data_f2, sr_data_f3, sr_data_f4, sr_data_f5, sr_data_f6;
extern const struct sr_table sr_data_f7, sr_data_f8, sr_data_f9, sr_data_f10, sr_data_f11, sr_data_f12;

extern const struct sr_table sr_data_ag_eta, sr_data_ag_k, sr_data_al_eta, sr_data_al_k, sr_data_au_eta, sr_data_au_k;
extern const struct sr_table sr_data_cu_eta, sr_data_cu_k, sr_data_cuzn_eta, sr_data_cuzn_k;
extern const struct sr_table sr_data_mgo_eta, sr_data_mgo_k, sr_data_tio2_eta, sr_data_tio2_k;

extern const struct sr_table sr_data_bk7, sr_data_baf10, sr_data_fk51a, sr_data_lasf9;
extern const struct sr_table sr_data_sf5, sr_data_sf10, sr_data_sf11;

/* What src/spectrum/fit/fit_rgb.c writes at build time, one for each colour space: the knots of z, then the sigmoids'
 * coefficients by largest component, z, y, x, and one float of padding. */
#define SR_RGB_RESOLUTION 64
struct sr_rgb_table {
    float knots[SR_RGB_RESOLUTION];
    float coefficients[3][SR_RGB_RESOLUTION][SR_RGB_RESOLUTION][SR_RGB_RESOLUTION][3];
    float padding[16];
};
extern const struct sr_rgb_table sr_rgb_table_srgb, sr_rgb_table_dci_p3, sr_rgb_table_rec2020, sr_rgb_table_aces2065_1;

#endif
