/* SPDX-License-Identifier: MIT */
/* Units of light as powers, and their names.
 *
 *     unit = PRODUCT flux_i^a_i s^b m^c sr^d nm^e,     flux in W, lm, umol/s
 *
 * Two quantities may be added when all powers agree, so a scotopic lux is no lux, and photons of 400 … 700 nm are not
 * photons of all wavelengths. Names: SI brochure, 9th edition, 2.3; CIE S 017:2020. Limits: powers from -99 to 99. */
#include "quantity/quantity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const system_names[SR_SYSTEM_COUNT] = {"radiometric", "photopic", "scotopic", "cones2",
                                                          "cones10",     "photon",   "par"};

const char *sr_system_name(enum sr_system system)
{
    return system_names[system];
}

bool sr_system_find(const char *name, enum sr_system *system)
{
    for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
        if (strcmp(name, system_names[i]) == 0) {
            *system = (enum sr_system)i;
            return true;
        }
    return false;
}

const char *sr_kind_symbol(enum sr_kind kind, enum sr_system system)
{
    static const char *const symbols[SR_KIND_COUNT][SR_SYSTEM_COUNT] = {
        [SR_KIND_ENERGY] = {"Q_e", "Q_v", "Q'_v", "Q_v,F2", "Q_v,F10", "Q_p", "Q_p,PAR"},
        [SR_KIND_FLUX] = {"Φ_e", "Φ_v", "Φ'_v", "Φ_v,F2", "Φ_v,F10", "Φ_p", "Φ_p,PAR"},
        [SR_KIND_FLUX_DENSITY] = {"E_e", "E_v", "E'_v", "E_v,F2", "E_v,F10", "E_p", "E_p,PAR"},
        [SR_KIND_INTENSITY] = {"I_e", "I_v", "I'_v", "I_v,F2", "I_v,F10", "I_p", "I_p,PAR"},
        [SR_KIND_RADIANCE] = {"L_e", "L_v", "L'_v", "L_v,F2", "L_v,F10", "L_p", "L_p,PAR"},
        [SR_KIND_EXPOSURE] = {"H_e", "H_v", "H'_v", "H_v,F2", "H_v,F10", "H_p", "H_p,PAR"},
    };
    return symbols[kind][system];
}

struct sr_unit sr_unit_of(enum sr_kind kind, enum sr_system system, bool is_spectral)
{
    struct sr_unit unit = {.nanometre = is_spectral ? -1 : 0};
    unit.flux[system] = 1;
    unit.second = kind == SR_KIND_ENERGY || kind == SR_KIND_EXPOSURE ? 1 : 0;
    unit.metre = kind == SR_KIND_FLUX_DENSITY || kind == SR_KIND_RADIANCE || kind == SR_KIND_EXPOSURE ? -2 : 0;
    unit.steradian = kind == SR_KIND_INTENSITY || kind == SR_KIND_RADIANCE ? -1 : 0;
    return unit;
}

struct sr_unit sr_unit_power(int metre, int steradian, int second)
{
    return (struct sr_unit){.metre = (int8_t)metre, .steradian = (int8_t)steradian, .second = (int8_t)second};
}

bool sr_unit_equal(struct sr_unit a, struct sr_unit b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

/* ---- names ---- */

struct factor {
    const char *name;
    int power;
};

/* The names of one sign's powers, blanks between them; how many there were. */
static int append_factors(const struct factor *factors, size_t count, int sign, char *text, size_t size)
{
    int shown = 0;
    for (size_t i = 0; i < count; ++i) {
        int power = sign * factors[i].power;
        if (power < 1)
            continue;
        size_t used = strlen(text);
        snprintf(text + used, size - used, power > 1 ? "%s%s^%d" : "%s%s", shown++ ? " " : "", factors[i].name, power);
    }
    return shown;
}

char *sr_unit_text(struct sr_unit unit, char *text, size_t size)
{
    static const char *const prefixes[SR_SYSTEM_COUNT] = {"", "", "scotopic ", "CIE2015-2 ", "CIE2015-10 ", "", "PAR "};
    int watt = unit.flux[SR_RADIOMETRIC], second = unit.second, metre = unit.metre, steradian = unit.steradian;
    struct factor factors[4 + SR_SYSTEM_COUNT + 3];
    size_t n = 0;
    const char *prefix = "";
    int photons = unit.flux[SR_PHOTON] + unit.flux[SR_PAR];
    second -= photons;
    // joule, lux and candela take up powers that have no names of their own then
    int joule = (watt > 0 && second > 0) || (watt < 0 && second < 0) ? watt : 0;
    if (joule && abs(second) >= abs(watt))
        watt -= joule, second -= joule, factors[n++] = (struct factor){"J", joule};
    factors[n++] = (struct factor){"W", watt};
    for (int s = SR_PHOTOPIC; s < SR_SYSTEM_COUNT; ++s) {
        const char *name = s >= SR_PHOTON ? "umol" : "lm";
        if (s < SR_PHOTON && unit.flux[s] == 1 && steradian == -1)
            name = "cd", steradian = 0;
        else if (s < SR_PHOTON && unit.flux[s] == 1 && metre == -2 && steradian == 0)
            name = "lx", metre = 0;
        prefix = unit.flux[s] ? prefixes[s] : prefix;
        factors[n++] = (struct factor){name, unit.flux[s]};
    }
    factors[n++] = (struct factor){"m", metre};
    factors[n++] = (struct factor){"sr", steradian};
    factors[n++] = (struct factor){"s", second};
    factors[n++] = (struct factor){"nm", unit.nanometre};

    char above[64] = "", below[64] = "";
    int over = append_factors(factors, n, 1, above, sizeof above),
        under = append_factors(factors, n, -1, below, sizeof below);
    snprintf(text, size, "%s%s%s%s%s%s", prefix, over || under ? above : "1", over || !under ? "" : "1",
             under ? "/" : "", under > 1 ? "(" : "", below);
    size_t used = strlen(text);
    if (under > 1 && used + 1 < size)
        snprintf(text + used, size - used, ")");
    return text;
}
