/* SPDX-License-Identifier: MIT */
/* Ear clipping: a corner is cut off where the triangle with its neighbours turns as the polygon does and holds no other
 * corner.
 *
 * In the plane of the two axes along which the polygon is largest, by Newell's normal. G. H. Meisters 1975: there are
 * always two ears, if the polygon does not cross itself. */
#include "import/polygon.h"

struct flat {
    double x, y;
};

static double turn(struct flat a, struct flat b, struct flat c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* counterclockwise, onto the plane where its area is largest */
static void flatten(const sr_vec3 *P, const int32_t *corners, uint32_t stride, uint32_t count, struct flat *q)
{
    double n[3] = {0, 0, 0};
    for (uint32_t i = 0; i < count; ++i) {
        sr_vec3 a = P[corners[i * stride]], b = P[corners[(i + 1 < count ? i + 1 : 0) * stride]];
        n[0] += ((double)a.y - (double)b.y) * ((double)a.z + (double)b.z);
        n[1] += ((double)a.z - (double)b.z) * ((double)a.x + (double)b.x);
        n[2] += ((double)a.x - (double)b.x) * ((double)a.y + (double)b.y);
    }
    int axis = fabs(n[0]) > fabs(n[1]) && fabs(n[0]) > fabs(n[2]) ? 0 : fabs(n[1]) > fabs(n[2]) ? 1 : 2;
    for (uint32_t i = 0; i < count; ++i) {
        sr_vec3 a = P[corners[i * stride]];
        double p[3] = {(double)a.x, (double)a.y, (double)a.z}, sign = n[axis] < 0 ? -1 : 1;
        q[i] = (struct flat){sign * p[(axis + 1) % 3], p[(axis + 2) % 3]};
    }
}

static bool is_ear(const struct flat *q, const uint32_t *left, uint32_t n, uint32_t i, int64_t *budget)
{
    uint32_t ia = left[(i + n - 1) % n], ib = left[i], ic = left[(i + 1) % n];
    struct flat a = q[ia], b = q[ib], c = q[ic];
    if (!(turn(a, b, c) > 0))
        return false;
    *budget -= n;
    for (uint32_t k = 0; k < n; ++k) {
        struct flat p = q[left[k]];
        bool is_corner = (p.x == a.x && p.y == a.y) || (p.x == b.x && p.y == b.y) || (p.x == c.x && p.y == c.y);
        if (!is_corner && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0)
            return false;
    }
    return true;
}

static bool is_convex(const struct flat *q, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        if (turn(q[i], q[(i + 1) % count], q[(i + 2) % count]) < 0)
            return false;
    return true;
}

static void fan(const uint32_t *left, uint32_t n, uint32_t *triangles)
{
    for (uint32_t i = 2; i < n; ++i, triangles += 3) {
        triangles[0] = left ? left[0] : 0;
        triangles[1] = left ? left[i - 1] : i - 1;
        triangles[2] = left ? left[i] : i;
    }
}

bool sr_polygon_triangulate(const sr_vec3 *P, const int32_t *corners, uint32_t stride, uint32_t count, int64_t *budget,
                            uint32_t *triangles)
{
    struct flat q[SR_POLYGON_MOST];
    uint32_t left[SR_POLYGON_MOST], n = count;
    if (count <= 3 || count > SR_POLYGON_MOST || *budget <= 0) {
        fan(NULL, count, triangles);
        return count <= 3;
    }
    flatten(P, corners, stride, count, q);
    if (is_convex(q, count)) {
        fan(NULL, count, triangles);
        return true;
    }
    for (uint32_t i = 0; i < n; ++i)
        left[i] = i;
    for (uint32_t i = 0, passed = 0; *budget > 0 && n > 3 && passed < n;) {
        i %= n;
        if (!is_ear(q, left, n, i, budget)) {
            ++i;
            ++passed;
            continue;
        }
        triangles[0] = left[(i + n - 1) % n];
        triangles[1] = left[i];
        triangles[2] = left[(i + 1) % n];
        triangles += 3;
        for (uint32_t k = i; k + 1 < n; ++k)
            left[k] = left[k + 1];
        --n;
        passed = 0;
    }
    fan(left, n, triangles);
    return n == 3;
}
