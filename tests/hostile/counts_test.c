/* SPDX-License-Identifier: MIT */
/* Files whose counts do not fit into 32 bits, or into themselves: refused before memory is asked for; and depth without
 * end. */
#define _GNU_SOURCE
#include "test.h"

#include "import/import.h"

#include <sys/resource.h>

static struct sr_scene_counts counts;
static struct sr_box bounds;

/* is_held: within 64 MiB more than there is. The error, or "". */
static const char *read_scene(const char *name, const void *data, size_t size, bool is_held)
{
    static struct sr_error error;
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    error = (struct sr_error){0};
    EXPECT(sr_file_write(path, data, size, &error) == SR_OK);
    struct rlimit old, tight;
    getrlimit(RLIMIT_AS, &old);
    tight = old;
    tight.rlim_cur = test_address_space_B() + ((size_t)64 << 20);
    if (is_held && !is_slow_build()) // sanitizers need the space
        setrlimit(RLIMIT_AS, &tight);
    struct sr_import_result r;
    struct sr_import_options options = {.threads = 1, .width = 4, .height = 3, .spp = 1};
    sr_status status = sr_import_pbrt(path, &options, &r, NULL, &error);
    if (status == SR_OK) {
        counts = sr_scene_count(r.scene);
        bounds = sr_scene_bounds(r.scene);
    }
    sr_import_result_free(&r);
    setrlimit(RLIMIT_AS, &old);
    EXPECT(status == SR_OK || status == SR_ERROR_INPUT);
    return status == SR_OK ? "" : error.text;
}

static void expect_refusal(const char *name, const void *data, size_t size, const char *reason)
{
    const char *text = read_scene(name, data, size, true);
    if (!strstr(text, reason))
        test_fail(__FILE__, __LINE__, "%s: \"%s\", expected \"%s\"", name, text, reason);
}

#define GLTF(nodes, accessors)                                                                                         \
    "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64," \
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"         \
    "\"accessors\":[" accessors "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"   \
    "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[" nodes "]}"
#define CORNERS                                                                                                        \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":%s,\"type\":\"VEC3\"},{\"componentType\":5125,\"count\":%s,\"type\":\"SCALAR\"}"

TEST(counts_of_gltf_accessors_are_refused_where_nothing_backs_them)
{
    static const struct {
        const char *vertices, *indices, *reason;
    } cases[] = {{"4294967299", "3", "/accessors/0/count: expected a whole number from 0 to 2147483647"},
                 {"3", "4294967298", "/accessors/1/count: expected a whole number from 0 to 2147483647"},
                 {"3", "18446744073709551619", "too big integer"},
                 {"3", "2147483648", "/accessors/1/count: expected a whole number from 0 to 2147483647"},
                 {"3", "2147483646", "of memory, which is too much for a file of"},
                 {"1000000000", "3", "/accessors/0"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char text[2048];
        int n = snprintf(text, sizeof text, GLTF("{\"mesh\":0}", CORNERS), cases[i].vertices, cases[i].indices);
        expect_refusal("counts.gltf", text, (size_t)n, cases[i].reason);
    }
}

TEST(counts_of_ply_elements_are_refused_where_the_file_ends_before)
{
    static const char *const wrong[] = {"2147483648", "4294967299", "2000000000", "18446744073709551619", "-1"};
    for (int i = 0; i < 10; ++i) {
        char text[1024];
        int n = snprintf(
            text, sizeof text,
            "ply\nformat ascii 1.0\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\nelement face %s\n"
            "property list uint int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            i & 1 ? "3" : wrong[i / 2], i & 1 ? wrong[i / 2] : "1");
        expect_refusal("counts.ply", text, (size_t)n,
                       i / 2 < 3 ? "is cut short: its head promises" : "expected \"element NAME COUNT\"");
    }
}

TEST(counts_and_indices_of_other_formats_are_refused)
{
    static const char corners[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4294967299\n"; // 3 of 32 bits
    expect_refusal("counts.obj", corners, sizeof corners - 1, "4294967299 is no vertex");
    static const char below[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4294967293\n";
    expect_refusal("counts.obj", below, sizeof below - 1, "-4294967293 is no vertex");
    static const char index[] =
        "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 4294967298]\n";
    expect_refusal("counts.pbrt", index, sizeof index - 1, "expected a whole number of 32 bits");
    static const char levels[] =
        "WorldBegin\nShape \"loopsubdiv\" \"integer levels\" 30 \"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 1] \"integer indices\" [0 1 2 0 1 3 1 2 3 0 2 3]\n";
    expect_refusal("counts.pbrt", levels, sizeof levels - 1, "30 \"levels\" make");
    char stl[84 + 500] = {0};
    memset(stl + 80, 0xff, 4);
    expect_refusal("counts.stl", stl, sizeof stl, "says that it has 4294967295 triangles");
}

TEST(a_chain_of_nodes_may_be_as_long_as_the_file)
{
    uint32_t n = is_slow_build() ? 10000 : 100000;
    size_t size = 2048 + (size_t)n * 60;
    char *text = malloc(size), *p = text;
    EXPECT(text != NULL);
    static const char whole[] = GLTF("%%", CORNERS);
    char rest[2048];
    snprintf(rest, sizeof rest, whole, "3", "3");
    p += sprintf(p, "%.*s", (int)(strchr(rest, '%') - rest), rest);
    for (uint32_t i = 1; i < n; ++i)
        p += sprintf(p, "{\"children\":[%u],\"translation\":[1e-5,0,0]},", i);
    p += sprintf(p, "{\"mesh\":0}%s", strchr(rest, '%') + 1);
    char *indices = strstr(text, "{\"componentType\":5125"); // zeros are no triangle: the corners as they stand
    indices[-1] = ' ';
    memset(indices, ' ', (size_t)(strchr(indices, '}') - indices) + 1);
    memset(strstr(text, ",\"indices\":1"), ' ', strlen(",\"indices\":1"));
    EXPECT_EQUAL_TEXT(read_scene("chain.gltf", text, (size_t)(p - text), false), "");
    EXPECT_EQUAL_INT(counts.triangles, 1);
    EXPECT_RELATIVE(bounds.lo.x, 1e-5 * (n - 1), 1e-6);
    free(text);
}

TEST(blocks_may_be_nested_and_objects_may_not)
{
    enum { DEPTH = 10000 };
    size_t size = 100 + 50 * DEPTH;
    char *text = malloc(size), *p = text;
    EXPECT(text != NULL);
    p += sprintf(p, "WorldBegin\n");
    for (int i = 0; i < DEPTH; ++i)
        p += sprintf(p, "AttributeBegin Scale 1 1 1\n");
    p += sprintf(p, "Shape \"sphere\"\n");
    for (int i = 0; i < DEPTH; ++i)
        p += sprintf(p, "AttributeEnd\n");
    EXPECT_EQUAL_TEXT(read_scene("blocks.pbrt", text, (size_t)(p - text), false), "");
    free(text);
    static const char nested[] =
        "WorldBegin\nObjectBegin \"a\" Shape \"sphere\" ObjectEnd\nObjectBegin \"b\" ObjectInstance \"a\" ObjectEnd\n";
    expect_refusal("nested.pbrt", nested, sizeof nested - 1,
                   "nested.pbrt:3:17: ObjectInstance \"a\" inside of an object: expected outside");
    char *deep = malloc(400000);
    EXPECT(deep != NULL);
    int n = sprintf(deep, "{\"asset\":{\"version\":\"2.0\"},\"extras\":");
    memset(deep + n, '[', 100000);
    memset(deep + n + 100000, ']', 100000);
    deep[n + 200000] = '}';
    expect_refusal("deep.gltf", deep, (size_t)n + 200001, "maximum parsing depth reached");
    free(deep);
}
