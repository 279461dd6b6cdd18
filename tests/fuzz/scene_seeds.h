/* SPDX-License-Identifier: MIT */
/* A scene with something of each kind, and small files of the kinds that scenes name. */
#ifndef TEST_FUZZ_SCENE_SEEDS_H
#define TEST_FUZZ_SCENE_SEEDS_H

static const char seed_scene_head[] =
    "LookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [40] \"float lensradius\" .01 \"float focaldistance\" 5\n"
    "Film \"rgb\" \"integer xresolution\" 3 \"integer yresolution\" [2] \"string filename\" \"a.exr\"\nSampler \"zsobol\" \"integer pixelsamples\" 1\n"
    "PixelFilter \"gaussian\" \"float xradius\" 2\nIntegrator \"volpath\" \"integer maxdepth\" 3\nOption \"integer seed\" 7\n"
    "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.1 .2 .3] \"float g\" .3\n"
    "TransformTimes 0 1 ColorSpace \"srgb\" CoordSysTransform \"camera\" Identity\n#@ Uncertainty \"x\" \"string material\" \"b\" \"string parameter\" \"vroughness\" \"float u\" .01\nWorldBegin\n";
static const char seed_scene_body[] =
    "AttributeBegin\n#@ Name \"lamp\"\nTranslate 0 2 0 Rotate 90 1 0 0 Scale 1 1 -1 ReverseOrientation\n"
    "AreaLightSource \"diffuse\" \"blackbody L\" 4000 \"float scale\" 2\nShape \"disk\" \"float radius\" .5\nAttributeEnd\n"
    "LightSource \"infinite\" \"rgb L\" [.1 .2 .3]\nLightSource \"spot\" \"point3 from\" [0 3 0] \"spectrum I\" [400 1 700 2]\n"
    "Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [.1 .2 .3] \"float uscale\" 3\nTexture \"f\" \"float\" \"fbm\" \"integer octaves\" 3\n"
    "Texture \"m\" \"spectrum\" \"mix\" \"texture tex1\" \"t\" \"texture amount\" \"f\"\n"
    "MakeNamedMaterial \"a\" \"string type\" \"coateddiffuse\" \"texture reflectance\" \"m\" \"float roughness\" .1\n"
    "MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"float vroughness\" .2\n"
    "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .5\n"
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 1 1 0 -1 1 .1] \"integer indices\" [0 1 2 0 2 3] \"point2 uv\" [0 0 1 0 1 1 0 1]\n"
    "NamedMaterial \"b\" Shape \"sphere\" \"float radius\" .4 \"float zmax\" .3\nMaterial \"dielectric\" Attribute \"shape\" \"float alpha\" .5\n"
    "MediumInterface \"fog\" \"\" Shape \"sphere\" \"float radius\" 3\nShape \"curve\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 1] \"float width\" .1\n"
    "Shape \"loopsubdiv\" \"integer levels\" 1 \"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 1] \"integer indices\" [0 2 1 0 1 3 1 2 3 0 3 2]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]\n"
    "ObjectBegin \"o\" Shape \"cylinder\" \"float radius\" .1 ObjectEnd\nConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1] ObjectInstance \"o\"\n"
    "#@ Meter \"irradiance\" \"string name\" \"m\" \"point3 p\" [0 0 1] \"normal n\" [0 0 1]\n";

static const char seed_spectrum[] = "# nm value\n360 0.1\n500, 0.4\n\t780 1e-1\n830 2.5E0\n";
static const char seed_lens[] =
    "# radius thickness eta diameter\n35.98 1.21 1.54 23.7\n11.69 9.99 1 20.1\n13.08 5.12 1.77 17.9\n-22.58 1.81 1.64 16.6\n0 1.6 0 15\n"
    "20.38 1.76 1.6 13\n-24.2 46 0 12.3\n";
static const char seed_materials[] =
    "newmtl m\nKd 0.5 .2 1\nKs 1 1 1\nNs 30\nillum 2\nd .5\nNi 1.5\nTf 1 0 1\nmap_Kd -s 1 1 1 none.png\nPm 0.1\nPr .2\nKe 1 1 1\nbump -bm 2 x.png\n";
static const char seed_ply_head[] =
    "ply\nformat ascii 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\nproperty float u\n"
    "property float v\nelement face 2\nproperty list uchar int vertex_indices\nproperty int face_indices\nend_header\n";
static const char seed_ply_body[] = "0 0 0 0 0\n1 0 0 1 0\n1 1 .5 1 1\n0 1 0 0 1\n3 0 1 2 7\n4 0 1 2 3 8\n";

#endif
