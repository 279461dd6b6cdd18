/* SPDX-License-Identifier: MIT */
/* A hundred lumens, told in several ways: by power, by an IES file, by a EULUMDAT file, by a small glowing disk.
 *
 *     Lambertian, on its axis at 1 m: E = Phi / pi = 31.83 lx          isotropic: E = Phi / (4 pi) = 7.96 lx */
#include "analytic.h"
#include "unit/measured/luminaires.h"

static const char *file_of(struct sr_arena *arena, intensity_of *I, const char *name)
{
    struct sr_photometry p = luminaire_make(arena, SR_PHOTOMETRY_AXIAL, I, 0, 360);
    struct sr_error error = {0};
    char *path = sr_arena_printf(arena, "%s/%s", test_folder(), name);
    if (sr_photometry_write(path, &p, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return path;
}

/* Illuminance at p on the horizontal, of a luminaire in the origin that looks down. */
static void expect(const char *light, sr_vec3 p, double value)
{
    struct world w = world_of("Integrator \"path\"\nWorldBegin\n%s\n", light);
    struct sr_irradiance E = sr_render_irradiance(&w.job, p, (sr_vec3){0, 0, 1}, samples(256), REPLICATES);
    EXPECT(is_slow_build() || E.E_v_error <= 1.25e-4 * value);
    EXPECT_NEAR(E.E_v, value, 4.9 * E.E_v_error + 1e-4 * value);
    world_free(&w);
}

TEST(hundred_lumens_give_31_83_lux_from_a_lambertian_lamp_and_7_96_from_an_isotropic_one)
{
    struct sr_arena arena = {0};
    const double lambert = 100 / 3.14159265358979, even = lambert / 4;
    const char *disk = "AttributeBegin\nTranslate 0 0 -0.001\nAreaLightSource \"diffuse\" \"float power\" 100\n"
                       "ReverseOrientation Shape \"disk\" \"float radius\" 0.001\nAttributeEnd";
    const char *lights[] = {
        disk,
        sr_arena_printf(&arena, "LightSource \"ies\" \"string filename\" \"%s\"",
                        file_of(&arena, lambertian, "lambert.ies")),
        sr_arena_printf(&arena, "LightSource \"ies\" \"string filename\" \"%s\" \"float power\" 100",
                        file_of(&arena, lambertian, "lambert.ldt")),
        "LightSource \"point\" \"float power\" 100",
        sr_arena_printf(&arena, "LightSource \"ies\" \"string filename\" \"%s\"",
                        file_of(&arena, isotropic, "even.ies")),
        sr_arena_printf(&arena, "LightSource \"ies\" \"string filename\" \"%s\" \"blackbody I\" 3000",
                        file_of(&arena, isotropic, "even.ldt")),
    };
    for (int i = 0; i < 6; ++i) {
        bool is_lambert = i < 3;
        expect(lights[i], (sr_vec3){0, 0, i == 0 ? -1.001f : -1}, is_lambert ? lambert : even);
        // 45 deg aside at sqrt(2) m: cos / r^2, and another cos for Lambert
        double cosine = sqrt(0.5);
        expect(lights[i], (sr_vec3){1, 0, i == 0 ? -1.001f : -1}, (is_lambert ? lambert * cosine : even) * cosine / 2);
    }
    sr_arena_free(&arena);
}
