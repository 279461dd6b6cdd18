/* SPDX-License-Identifier: MIT */
/* Beams of light: a direction, a cone or the whole hemisphere; their solid angles and the names of what lies between
 * two.
 *
 *     Omega = INTEGRAL cos theta d omega = pi sin^2 h cos theta of a cone of half angle h above the horizon    [sr]
 *
 * and pi of the hemisphere: the projected solid angle. F. E. Nicodemus et al., Geometrical considerations and
 * nomenclature for reflectance, NBS Monograph 160, 1977. */
#include "lab/reflect.h"

#include <stdlib.h>
#include <string.h>

static const char *const names[3][3] = {
    {"bidirectional reflectance", "directional-conical reflectance", "directional-hemispherical reflectance"},
    {"conical-directional reflectance", "biconical reflectance", "conical-hemispherical reflectance"},
    {"hemispherical-directional reflectance", "hemispherical-conical reflectance", "bihemispherical reflectance"},
};

static sr_status numbers(const char *text, const char *list, int least, int most, double *out, struct sr_error *error)
{
    int count = 0;
    for (const char *at = list;; ++at) {
        char *end;
        if (count == most)
            return sr_fail(error, SR_ERROR_USAGE, "beam \"%s\": at most %d angles", text, most);
        out[count] = strtod(at, &end);
        if (end == at || !isfinite(out[count]) || (*end && *end != ','))
            return sr_fail(error, SR_ERROR_USAGE, "beam \"%s\": \"%s\" is not a number of degrees", text, at);
        ++count;
        at = end;
        if (!*at)
            break;
    }
    if (count < least)
        return sr_fail(error, SR_ERROR_USAGE, "beam \"%s\": needs %d angles in degrees", text, least);
    return SR_OK;
}

sr_status sr_beam_check(const struct sr_beam *b, struct sr_error *error)
{
    if (b->kind == SR_BEAM_HEMISPHERE)
        return SR_OK;
    if (!(b->theta >= 0 && b->theta < 90) || !isfinite(b->phi))
        return sr_fail(error, SR_ERROR_USAGE, "a beam's theta is %g deg: must be at least 0 and below 90", b->theta);
    if (b->kind == SR_BEAM_CONE && !(b->half_angle > 0 && b->theta + b->half_angle <= 90 + 1e-9))
        return sr_fail(error, SR_ERROR_USAGE,
                       "a cone of half angle %g deg about theta %g deg: the half angle must be above 0, and no part of "
                       "the cone below the horizon",
                       b->half_angle, b->theta);
    return SR_OK;
}

sr_status sr_beam_read(const char *text, struct sr_beam *beam, struct sr_error *error)
{
    *beam = (struct sr_beam){.kind = SR_BEAM_HEMISPHERE};
    double angle[3] = {0, 0, 0};
    if (strcmp(text, "hemisphere") == 0)
        return SR_OK;
    if (strncmp(text, "direction:", 10) == 0) {
        beam->kind = SR_BEAM_DIRECTION;
        if (numbers(text, text + 10, 1, 2, angle, error) != SR_OK)
            return error->status;
    } else if (strncmp(text, "cone:", 5) == 0) {
        beam->kind = SR_BEAM_CONE;
        if (numbers(text, text + 5, 3, 3, angle, error) != SR_OK)
            return error->status;
    } else {
        return sr_fail(error, SR_ERROR_USAGE,
                       "beam \"%s\": must be direction:THETA[,PHI], cone:THETA,PHI,HALF or hemisphere (degrees)", text);
    }
    beam->theta = angle[0];
    beam->phi = angle[1];
    beam->half_angle = angle[2];
    return sr_beam_check(beam, error);
}

struct lab_region sr_region_of(const struct sr_beam *b)
{
    const double deg = M_PI / 180;
    struct lab_region r = {.is_direction = b->kind == SR_BEAM_DIRECTION,
                           .is_hemisphere = b->kind == SR_BEAM_HEMISPHERE,
                           .half = b->kind == SR_BEAM_HEMISPHERE ? M_PI / 2 : b->half_angle * deg};
    double theta = r.is_hemisphere ? 0 : b->theta * deg, phi = r.is_hemisphere ? 0 : b->phi * deg;
    double st = sin(theta), ct = cos(theta), sp = sin(phi), cp = cos(phi);
    memcpy(r.x, (double[3]){ct * cp, ct * sp, -st}, sizeof r.x);
    memcpy(r.y, (double[3]){-sp, cp, 0}, sizeof r.y);
    memcpy(r.z, (double[3]){st * cp, st * sp, ct}, sizeof r.z);
    double s = sin(r.half);
    r.projected = r.is_direction ? 0 : r.is_hemisphere ? M_PI : M_PI * s * s * ct;
    return r;
}

void sr_region_direction(const struct lab_region *r, double alpha, double beta, double w[3])
{
    double s = sin(alpha), x = s * cos(beta), y = s * sin(beta), z = cos(alpha);
    for (int k = 0; k < 3; ++k)
        w[k] = x * r->x[k] + y * r->y[k] + z * r->z[k];
}

void sr_region_angles(const struct lab_region *r, const double w[3], double *alpha, double *beta)
{
    double x = 0, y = 0, z = 0;
    for (int k = 0; k < 3; ++k) {
        x += w[k] * r->x[k];
        y += w[k] * r->y[k];
        z += w[k] * r->z[k];
    }
    *alpha = atan2(hypot(x, y), z);
    *beta = atan2(y, x);
}

bool sr_region_contains(const struct lab_region *r, const double w[3])
{
    double alpha, beta;
    sr_region_angles(r, w, &alpha, &beta);
    return !r->is_direction && alpha <= r->half + 1e-12 && w[2] > 0;
}

void sr_reflectance_describe(const struct sr_beam *from, const struct sr_beam *to, struct sr_reflectance *out)
{
    struct lab_region i = sr_region_of(from), r = sr_region_of(to);
    *out = (struct sr_reflectance){.name = names[from->kind][to->kind],
                                   .unit = r.is_direction ? "sr^-1" : "1",
                                   .projected_from = i.projected,
                                   .projected_to = r.projected};
}

void sr_reflectance_factor(struct sr_reflectance *out)
{
    double perfect = out->projected_to > 0 ? out->projected_to / M_PI : 1 / M_PI;
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        out->factor[l] = out->value[l] / perfect;
}
