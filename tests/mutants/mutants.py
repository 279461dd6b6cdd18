#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Deliberately wrong versions of the program, and the test that catches each.

Usage: mutants.py --check ROOT            every edit still applies to exactly one place (fast: a test of the suite)
       mutants.py ROOT BUILD [NAME ...]   builds ROOT's sources in BUILD with one edit at a time, and sees the tests fail

A mutant is caught when its test, which passes without the edit, fails with it. Exits 1 if one survives."""
import dataclasses
import os
import pathlib
import shutil
import subprocess
import sys
import time


@dataclasses.dataclass
class Mutant:
    name: str  # what is wrong with it
    file: str  # below src/
    old: str   # stands in exactly one place
    new: str
    test: str  # the folder of tests, which of them, and [rows of the closed forms]; or validate, and cases of the suite


MUTANTS = [
    # transport
    Mutant("the cosine at the surface is dropped", "integrator/path.h", "sr_spectrum fL = f * l->L * sr_abs_cos_theta(wi);",
           "sr_spectrum fL = f * l->L;", "analytic sources* [A2]"),
    Mutant("0.2 % of the light is lost at each bounce", "integrator/path.c", "beta *= s.f * (sr_abs_cos_theta(s.wi) / s.pdf);",
           "beta *= s.f * (0.998f * sr_abs_cos_theta(s.wi) / s.pdf);", "analytic enclosures* [D1]"),
    Mutant("one bounce is missing", "integrator/path.c", "if (bounce == path->max_depth)", "if (bounce + 1 >= path->max_depth)", "analytic enclosures* [D1]"),
    Mutant("lights that the surface meets are counted in full, and sampled as well", "integrator/path.c",
           "return density > 0 ? sr_mis_weight(pdf, sr_lights_pmf(lights, from, light) * density) : 1;",
           "(void)lights, (void)from, (void)pdf, (void)light, (void)density; return 1;", "analytic sources* [B8]"),
    Mutant("the weights of two strategies do not add up to 1", "integrator/integrator.h", "weight = 1 / (1 + q * q);", "weight = 1 / (1 + 1.01f * q * q);",
           "analytic sources* [B8]"),
    Mutant("who survives the lot does not carry the others' share", "integrator/path.c", "beta *= 1 / survive;", ";", "analytic enclosures* [D1]"),
    Mutant("who survives the lot finds more of the sky", "integrator/path.c", "outside = has_outside ? survive : 1;", "(void)has_outside;",
           "analytic enclosures* [D6]"),
    Mutant("who ends by lot loses the sky", "integrator/path.c", "if (has_outside && sr_sees_outside(", "if (0 && sr_sees_outside(", "analytic enclosures* [D6]"),
    Mutant("who survives the lot on another way finds more of the sky", "integrator/way.h", "p->outside = has_outside ? survive : 1;", ";",
           "analytic enclosures* [D6]"),
    Mutant("rays leave triangles by the error of the point alone", "shape/trianglemesh.c", "return sr_min(32 * SR_MACHINE_EPSILON * of_normal,",
           "return sr_min(0 * of_normal,", "truth nothing_meets_the_floor_that_it_leaves"),
    Mutant("rays to lamps are asked again to their very end", "scene/private.h", "#define SLIP_SHARE (1 - 0x1p-6f)", "#define SLIP_SHARE 1.0f",
           "truth no_segment_meets_the_lamp_that_it_aims_at"),
    Mutant("rays are asked again 0.5 mrad beside, and any is believed", "scene/closed.c", "0x1p-18f, 0x1p-16f}", "0x1p-18f, 0x1p-11f}",
           "truth no_segment_meets_the_lamp_that_it_aims_at"),
    Mutant("the ring around a slipped ray has three sides", "scene/closed.c", "{0.58f, 0.58f, 0.58f},", "{0.58f, -0.58f, -0.58f},",
           "truth no_silhouette_grows"),
    Mutant("shadows end at half of the way to the lamp", "scene/scene.h", ".t_max = is_far ? INFINITY : share};",
           ".t_max = is_far ? INFINITY : share / 2};", "validate screened_0.75"),
    Mutant("light from below the horizon is not cut off", "bsdf/bsdf.h", "bool is_reflected = sr_same_hemisphere(wo, wi);", "bool is_reflected = true;",
           "analytic sources* [B6]"),
    # what is learned
    Mutant("the density of guided directions leaves out the guide's share", "integrator/mixture.c",
           "sr_guide_mix(m->share, r->pdf_bsdf, r->pdf_guide);", "(1 - m->share) * r->pdf_bsdf;", "analytic guided_paths_find_what*"),
    Mutant("guided directions are weighed by a share of the guide 10 % too high", "integrator/mixture.c",
           "sr_guide_mix(m->share, r->pdf_bsdf, r->pdf_guide);", "sr_guide_mix(1.1f * m->share, r->pdf_bsdf, r->pdf_guide);",
           "unit_integrator guided_and_own*"),
    Mutant("the mixture's density takes the guide's share 10 % too high", "integrator/mixture.h", "sr_guide_mix(m->share, pdf_bsdf,",
           "sr_guide_mix(1.1f * m->share, pdf_bsdf,", "unit_integrator guided_and_own*"),
    Mutant("a mixture's density does not add up to 1", "integrator/guide.h", "(1 - share) * pdf_bsdf + share * pdf_guide;",
           "(1 - share) * pdf_bsdf + 1.1f * share * pdf_guide;", "unit_integrator guided_and_own*"),
    Mutant("what the BSDF draws is weighed by 10 % too little of the guide", "integrator/mixture.c", "r->pdf_bsdf / (r->pdf * s->pdf)",
           "r->pdf_bsdf / ((r->pdf - 0.1f * m->share * r->pdf_guide) * s->pdf)", "unit_integrator guided_and_own*"),
    Mutant("shares of the guide are judged as if each were 10 % larger", "integrator/guide.c", "sr_guide_mix(sr_guide_shares[k],",
           "sr_guide_mix(1.1f * sr_guide_shares[k],", "unit_integrator records_tell*"),
    Mutant("light samples count in full where the guide draws as well", "integrator/guided_path.c", "l->is_delta ? 0 : sr_mixture_pdf(m, l->wi, pdf_bsdf);",
           "0 * (pdf_bsdf + m->share);", "analytic guided_paths_find_what*"),
    Mutant("light samples compete with 10 % more than the mixture", "integrator/guided_path.c", "l->is_delta ? 0 : sr_mixture_pdf(m, l->wi, pdf_bsdf);",
           "l->is_delta ? 0 : 1.1f * sr_mixture_pdf(m, l->wi, pdf_bsdf);", "analytic light_samples_and*"),
    Mutant("the guide claims a density 2 % too high", "integrator/guide.c", "            return pdf;\n        }\n        i = s->child[k];",
           "            return 1.02f * pdf;\n        }\n        i = s->child[k];", "unit_integrator guided_directions*"),
    Mutant("learning always pays", "integrator/pilot.c", "variance * cost < least_gain;", "variance * cost >= 0;",
           "analytic guiding_switches_itself_off*"),
    Mutant("who survives a learned lot does not carry the others' share", "integrator/roulette_path.c", "p->beta *= 1 / survive;", ";",
           "analytic learned_roulette_finds*"),
    # media
    Mutant("light samples compete with directions as if fog hid nothing from them", "integrator/flight.c", "c->r *= sr_spectrum_exp(SR_BLACK + tau);", ";",
           "analytic glowing_walls*"),
    Mutant("collisions absorb nothing", "integrator/flight.c", "c->f *= at->sigma_s * T;", "c->f *= sigma_t * T;", "analytic media_are* [H6.0.9]"),
    Mutant("null collisions take light away", "integrator/flight.c", "c->f *= sr_spectrum_select(null > 0.0f, null, SR_BLACK) * P;",
           "c->f *= 0.9f * sr_spectrum_select(null > 0.0f, null, SR_BLACK) * P;", "analytic smoke_is*"),
    Mutant("shadow rays do not change their medium at interfaces", "integrator/flight.c", "medium = sr_hit_medium(&hit, l->wi, medium);", ";",
           "analytic media_are* [H3r]"),
    # lights
    Mutant("light falls off with the distance, not with its square", "light/point.c", "sr_spd_eval(&m->I, w->lambda) / r2", "sr_spd_eval(&m->I, w->lambda) / r",
           "unit_light *1000_lm*"),
    Mutant("a point light fills only half of space", "light/point.c", "m->power / (4 * SR_PI), error", "m->power / (2 * SR_PI), error", "unit_light *1000_lm*"),
    Mutant("a spot falls off evenly with the angle, not with its cosine", "light/spot.c",
           "float t = (cos_theta - m->cos_total) / (m->cos_start - m->cos_total);",
           "float t = (m->total - acosf(cos_theta)) / (m->total - m->start);", "analytic sources* [A6]"),
    Mutant("the solid angle of a lamp forgets the lamp's own cosine", "light/area.c", "s->pdf = r2 * r * m->inverse_area / fabsf(height);",
           "s->pdf = r2 * m->inverse_area;", "unit_light *lamberts_illuminance"),
    Mutant("the density in a cone is 0.2 % too high", "light/area.c", "s->pdf = SR_INV_PI * 0.5f / rest;", "s->pdf = 1.002f * SR_INV_PI * 0.5f / rest;",
           "unit_light *sine_squared"),
    Mutant("the density of an image's sky is not that of its draws", "light/infinite.c", ".pdf = pdf * jacobian / (4 * SR_PI)};",
           ".pdf = pdf / (4 * SR_PI)};", "unit_light samples_of_an_image*"),
    Mutant("a tilted distant light gives as much as an upright one", "light/distant.c", "m->common.is_absolute, m->scale, m->illuminance, error",
           "m->common.is_absolute, m->scale, m->illuminance / fabsf(m->wi.z), error", "unit_light *500_lx*"),
    # matter
    Mutant("a microfacet's density lacks its Jacobian 1/4", "bsdf/microfacet.h", "*pdf = D / (2 * (zo + so));", "*pdf = 2 * D / (zo + so);", "family bsdf_sampler_follows*"),
    Mutant("rough glass does not compress radiance", "bsdf/facets_interface.h", "if (mode == SR_RADIANCE && i->transmits)",
           "if (mode == SR_IMPORTANCE && i->transmits)", "family bsdf_functions_agree*"),
    Mutant("drawn glass does not compress radiance", "bsdf/dielectric.c", "value /= i.eta * i.eta;", ";", "family bsdf_functions_agree*"),
    Mutant("refraction bends the wrong way", "bsdf/fresnel.c", "float cos_t = sqrtf(g2) / eta;", "float cos_t = sqrtf(g2) * eta;", "unit_bsdf refraction_obeys_snell"),
    Mutant("Fresnel's reflectance is that of one polarisation", "bsdf/microfacet.h", "return (r_p * r_p + r_s * r_s) * 0.5f;", "return r_s * r_s;",
           "unit_bsdf fresnel_dielectric*"),
    Mutant("facets do not hide each other where light leaves", "bsdf/microfacet.h", "return D / (2 * (so * zi + si * zo));", "return D / (4 * so * zi);",
           "unit_bsdf ggx_reflects*"),
    # spectra and colour
    Mutant("linear values are written as if they were sRGB's", "image/image.c",
           "return v <= 0.0031308f ? v * 12.92f : 1.055f * powf(v, 1 / 2.4f) - 0.055f;", "return v;", "unit_image srgb*"),
    Mutant("wavelengths claim a density 0.2 % too high", "spectrum/wavelengths.c", "w.pdf = SLOPE / d * grown", "w.pdf = 1.002f * SLOPE / d * grown",
           "unit_spectrum wavelengths_have*"),
    Mutant("the observer is one nanometre off", "spectrum/observer.c", "sr_spectrum at = w->lambda - SR_LAMBDA_MIN;",
           "sr_spectrum at = w->lambda + 1.0f - SR_LAMBDA_MIN;", "unit_spectrum film_estimates*"),
    # chance and its error
    Mutant("the standard error is that of one sample", "math/statistics.c", "sqrt(sr_tally_variance(t) / (double)t->n)", "sqrt(sr_tally_variance(t))",
           "unit_math tally*"),
    Mutant("the variance divides by n", "math/statistics.c", "t->m2 / (double)(t->n - 1) : 0;", "t->m2 / (double)t->n : 0;", "unit_math tally*"),
    Mutant("the last sample drawn ahead has another's index", "sample/sampler.c", "k < SR_AHEAD; ++k)\n        begun", "k < SR_AHEAD - 1; ++k)\n        begun",
           "unit_sample numbers_in_pairs*"),
    Mutant("an alias table takes the wrong side of its threshold", "sample/distribution.c", "bool here = fraction < threshold;",
           "bool here = fraction < 0.99f * threshold;", "unit_sample alias*"),
    Mutant("a pixel's error bar forgets that it has few blocks", "film/film.c", "((double)(p->blocks - 1) * p->n)", "((double)(4 * p->blocks) * p->n)",
           "analytic *ordinary_images*"),
    # cameras
    Mutant("a lens is out of focus", "sensor/perspective.c", "*d = sr_mad(*d, -s->inv_focal, lens);",
           "*d = sr_mad(*d, -s->inv_focal, sr_scale(0.99f, lens));", "analytic cameras* [J5]"),
    Mutant("the picture is scaled by the wrong sensitivity", "film/film.c", "(double)s->iso / 100;", "(double)s->iso / 125;", "analytic cameras*"),
    Mutant("pixels are darker by the cosine to the fourth", "sensor/perspective.c", ".t_max = INFINITY}, .weight = 1};",
           ".t_max = INFINITY}, .weight = sr_sqr(sr_sqr(sr_dot(sr_normalize(d), ((const struct perspective *)self)->n)))};", "analytic cameras*"),
    # checkpoints
    Mutant("a checksum does not know where its block belongs", "store/write.c", "crc32(crc32(0, (const Bytef *)place, sizeof place), data, (uInt)size)",
           "crc32((uLong)(place[0] & 0), data, (uInt)size)", "unit_store blocks_in*"),
    Mutant("gaps are not looked at", "store/read.c", "if (bytes[i])", "if (bytes[i] && n == 0)", "unit_store every_flipped*"),
    Mutant("a resumed render takes a block twice", "render/unit.c", "> run->pass->blocks_before + block - run->first_block;",
           "> run->pass->blocks_before + block - run->first_block + 1;", "agree resumed_sums*"),
]


def edit(root, mutant):
    """The file's text with the mutant's edit, or None."""
    text = (root / "src" / mutant.file).read_text(encoding="utf-8")
    return text.replace(mutant.old, mutant.new) if text.count(mutant.old) == 1 else None


def check(root):
    stale = [m for m in MUTANTS if edit(root, m) is None]
    for m in stale:
        print(f"src/{m.file}: does not hold exactly once what the mutant \"{m.name}\" changes: {m.old}")
    print(f"{len(MUTANTS)} mutants, {len(stale)} of them stale")
    return not stale


def passes(build, test):
    """Builds the test's program and runs it; None: it does not compile."""
    folder, *rest = test.split()
    target = "steradian_command" if folder == "validate" else f"test_{folder}"
    if subprocess.run(["cmake", "--build", build, "--target", target], capture_output=True).returncode:
        return None
    if folder == "validate":
        return subprocess.run([build / "steradian", "validate", build / "source/validation/cases.tsv", "--case", rest[0]], capture_output=True).returncode == 0
    rows = [word.strip("[]") for word in rest if word.startswith("[")]
    names = [word for word in rest if not word.startswith("[")]
    environment = dict(os.environ, **({"STERADIAN_TEST_ROWS": rows[0]} if rows else {}))
    out = subprocess.run([build / "tests" / f"test_{folder}", *names], capture_output=True, text=True, env=environment)
    return out.returncode == 0


def hunt(root, build, names):
    copy = build / "source"
    shutil.rmtree(copy, ignore_errors=True)
    # dated now: what an earlier hunt has left of its last mutant is older
    shutil.copytree(root, copy, copy_function=shutil.copy,
                    ignore=lambda folder, entries: [e for e in entries if pathlib.Path(folder) == root and (e in (".git", "out") or e.startswith("build"))])
    subprocess.run(["cmake", "-S", copy, "-B", build, "-G", "Ninja" if shutil.which("ninja") else "Unix Makefiles", "-DCMAKE_BUILD_TYPE=Release", "-DSTERADIAN_LTO=OFF"], check=True, stdout=subprocess.DEVNULL)
    caught, hunted = 0, [m for m in MUTANTS if not names or any(n in m.name for n in names)]
    for test in sorted({m.test for m in hunted}):
        if passes(build, test) is not True:
            sys.exit(f"{test}: does not pass without any mutant (or does not compile)")
    for m in hunted:
        file, begin = copy / "src" / m.file, time.time()
        text = file.read_text(encoding="utf-8")
        file.write_text(edit(copy, m), encoding="utf-8")
        verdict = {None: "does not compile", True: "SURVIVES", False: "caught"}[passes(build, m.test)]
        file.write_text(text, encoding="utf-8")
        caught += verdict == "caught"
        print(f"{verdict:10} {m.name} (src/{m.file}; {m.test}; {time.time() - begin:.0f} s)", flush=True)
    print(f"{caught} of {len(hunted)} mutants caught")
    return caught == len(hunted)


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--check":
        sys.exit(not check(pathlib.Path(sys.argv[2])))
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(not hunt(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), sys.argv[3:]))
