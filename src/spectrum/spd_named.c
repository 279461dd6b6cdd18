/* SPDX-License-Identifier: MIT */
/* Spectra with names: pbrt's, their aliases, and ours.
 *
 * pbrt's glass-F5, -F10 and -F11 hold the data of SF5, SF10 and SF11; they keep their names here and have true ones
 * beside them. Its stdillum-D50 (x = 0.3368, y = 0.3580) is not CIE's, which is illum-cieD50 (0.3457, 0.3585).
 * Illuminants are scaled as their sources print them (mostly 100 at 560 nm); indices are numbers [1]. */
#include "spectrum/data.h"

#include <string.h>

struct named {
    const char *name;
    const struct sr_table *table; // NULL: the constant 100
};

static const struct named names[] = {
    {"glass-BK7", &sr_data_bk7},
    {"glass-BAF10", &sr_data_baf10},
    {"glass-FK51A", &sr_data_fk51a},
    {"glass-LASF9", &sr_data_lasf9},
    {"glass-F5", &sr_data_sf5},
    {"glass-F10", &sr_data_sf10},
    {"glass-F11", &sr_data_sf11},
    {"glass-SF5", &sr_data_sf5},
    {"glass-SF10", &sr_data_sf10},
    {"glass-SF11", &sr_data_sf11},
    {"metal-Ag-eta", &sr_data_ag_eta},
    {"metal-Ag-k", &sr_data_ag_k},
    {"metal-Al-eta", &sr_data_al_eta},
    {"metal-Al-k", &sr_data_al_k},
    {"metal-Au-eta", &sr_data_au_eta},
    {"metal-Au-k", &sr_data_au_k},
    {"metal-Cu-eta", &sr_data_cu_eta},
    {"metal-Cu-k", &sr_data_cu_k},
    {"metal-CuZn-eta", &sr_data_cuzn_eta},
    {"metal-CuZn-k", &sr_data_cuzn_k},
    {"metal-MgO-eta", &sr_data_mgo_eta},
    {"metal-MgO-k", &sr_data_mgo_k},
    {"metal-TiO2-eta", &sr_data_tio2_eta},
    {"metal-TiO2-k", &sr_data_tio2_k},
    {"stdillum-A", &sr_data_a},
    {"stdillum-D50", &sr_data_pbrt_d50},
    {"stdillum-D65", &sr_data_d65},
    {"stdillum-E", NULL},
    {"stdillum-F1", &sr_data_f1},
    {"stdillum-F2", &sr_data_f2},
    {"stdillum-F3", &sr_data_f3},
    {"stdillum-F4", &sr_data_f4},
    {"stdillum-F5", &sr_data_f5},
    {"stdillum-F6", &sr_data_f6},
    {"stdillum-F7", &sr_data_f7},
    {"stdillum-F8", &sr_data_f8},
    {"stdillum-F9", &sr_data_f9},
    {"stdillum-F10", &sr_data_f10},
    {"stdillum-F11", &sr_data_f11},
    {"stdillum-F12", &sr_data_f12},
    {"illum-cieD50", &sr_data_d50},
    {"illum-acesD60", &sr_data_aces_d60},
};

#define NAME_COUNT ((int)(sizeof(names) / sizeof(names[0])))

struct sr_spd sr_spd_named(const char *name)
{
    for (int i = 0; i < NAME_COUNT; ++i) {
        if (strcmp(name, names[i].name) != 0)
            continue;
        if (!names[i].table)
            return sr_spd_constant(100);
        return (struct sr_spd){.kind = SR_SPD_TABLE, .scale = 1, .table = names[i].table};
    }
    return (struct sr_spd){.kind = SR_SPD_NONE};
}

const char *sr_spd_name(int i)
{
    return i >= 0 && i < NAME_COUNT ? names[i].name : NULL;
}
