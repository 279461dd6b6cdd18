/* SPDX-License-Identifier: MIT */
/* steradian measure --balance, and the files of a goniophotometer. */
#include "run.h"

#define LAMP                                                                                                           \
    "Film \"rgb\" \"string filename\" \"a.exr\" Camera \"perspective\"\nWorldBegin\n"                                  \
    "#@ Meter \"intensity\" \"string name\" \"gonio\" \"float cstep\" 90 \"float gammastep\" 10\n"                     \
    "AttributeBegin Rotate 180 1 0 0 Material \"diffuse\" \"spectrum reflectance\" [360 0 830 0]\n"                    \
    "AreaLightSource \"diffuse\" \"float power\" 100 Shape \"disk\" \"float radius\" 0.2 AttributeEnd\n"               \
    "Material \"diffuse\" \"spectrum reflectance\" [360 0.5 830 0.5] AttributeBegin Translate 0 0 -1 Shape \"disk\" \"float radius\" 1 AttributeEnd\n"

static double value_of(const json_t *j, const char *key, const char *system, const char *what)
{
    const json_t *v = json_object_get(json_object_get(json_object_get(j, key), system), what);
    if (!json_is_number(v))
        test_fail(__FILE__, __LINE__, "there is no number %s %s %s", key, system, what);
    return json_number_value(v);
}

TEST(measure_balance_tells_where_the_light_goes)
{
    put_file("lamp.pbrt", LAMP);
    const struct said *s = run_expecting(0, "measure lamp.pbrt --balance --json --samples 65536 -q");
    json_t *all = json_of(s);
    const json_t *b = json_object_get(all, "balance");
    double emitted = value_of(b, "emitted", "photopic", "value"),
           absorbed = value_of(b, "absorbed", "photopic", "value"),
           escaped = value_of(b, "escaped", "photopic", "value"),
           u = value_of(b, "closure", "photopic", "standard_uncertainty");
    EXPECT_NEAR(emitted, 100, 0.01);
    EXPECT(fabs(emitted - absorbed - escaped) < 5 * u + 1e-6);
    EXPECT(absorbed > 1 && escaped > 1);
    EXPECT_EQUAL_INT(json_array_size(json_object_get(b, "absorbed_by_material")), 2);
    EXPECT_EQUAL_INT(json_array_size(json_object_get(b, "absorbed_by_object")), 2);
    json_decref(all);
    s = run_expecting(0, "measure lamp.pbrt --balance --samples 4096");
    EXPECT(strstr(s->out, "emitted") && strstr(s->out, "material 2") && strstr(s->out, "closure"));
}

TEST(measure_writes_intensity_distributions)
{
    put_file("lamp.pbrt", LAMP);
    run_expecting(0, "measure lamp.pbrt --meter gonio -o lamp.ies --samples 65536 -q");
    const struct said *s = run_expecting(0, "info lamp.ies");
    EXPECT(strstr(s->out, "IES LM-63-2002") && strstr(s->out, "4 C-planes") && strstr(s->out, "19 gamma"));
    run_expecting(0, "measure lamp.pbrt --meter gonio -o lamp.ldt --samples 65536 -q");
    run_expecting(0, "info lamp.ldt");
    run_expecting(0, "measure lamp.pbrt --meter gonio -o lamp.csv --samples 65536 -q");
    EXPECT_EQUAL_INT(count_files("lamp."), 4);
    s = run("measure lamp.pbrt --meter gonio -o lamp.exr --samples 4096 -q", NULL);
    EXPECT(s->code == 2 && strstr(s->err, ".ies, .ldt or .csv was expected"));
}
