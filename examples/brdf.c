/* SPDX-License-Identifier: MIT */
/* A BRDF without a scene: what it is made of, how bright it is, and how much light it returns.
 *   cc brdf.c $(pkg-config --cflags --libs --static steradian) -lm -o brdf && ./brdf */
#include <steradian/bsdf.h>

#include <math.h>
#include <stdio.h>

int main(void)
{
    char error[256];
    struct sr_brdf *paint;
    if (sr_brdf_create("ward_gmd reflectance=.3 specular=.1 alpha_x=.1 alpha_y=.2", &paint, error, sizeof error) !=
        SR_OK)
        return fprintf(stderr, "%s\n", error), 1;

    struct sr_brdf_parameter p;
    for (int i = 0; sr_brdf_model_parameter("ward_gmd", i, &p); ++i)
        printf("%-12s %g ... %g, initially %g [%s]: %s\n", p.name, p.least, p.most, p.initial, p.unit, p.text);

    float wo[91][3], wi[91][3], f[91], pdf[91]; // light from 45 degrees, seen in the plane of incidence
    for (int k = 0; k <= 90; ++k) {
        double theta = (2 * k - 90) * 3.14159265358979 / 180;
        wo[k][0] = (float)sin(theta), wo[k][1] = 0, wo[k][2] = (float)cos(theta);
        wi[k][0] = -sqrtf(0.5f), wi[k][1] = 0, wi[k][2] = sqrtf(0.5f);
    }
    // C before C23 adds no const to arrays of arrays by itself
    sr_brdf_evaluate(paint, 550, 91, (const float(*)[3])wo, (const float(*)[3])wi, f, pdf);
    for (int k = 15; k <= 90; k += 15)
        printf("theta_o %4d deg: f = %.5f 1/sr, pdf = %.5f 1/sr\n", 2 * k - 90, f[k], pdf[k]);

    struct sr_brdf_reflectance r;
    if (sr_brdf_reflectance(paint, 550, "direction:8", "hemisphere", 1e-6, &r, error, sizeof error) == SR_OK)
        printf("%s at 8 deg: %.6f +- %.0e\n", r.name, r.value, r.error);
    sr_brdf_destroy(paint);
    return 0;
}
