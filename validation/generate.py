#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the validation suite: scenes whose answers are known, as pbrt-v4 files, and cases.tsv with what is expected.

Usage: generate.py            writes cases.tsv, scenes/*.pbrt and skies/*.pfm beside itself
       generate.py --check    exits 1 if what is there is not what would be written

A class of cases is a function here, its parameters are free, and its closed form stands in it. Each scene carries meters
as comments (#@ Meter …), and a camera: where a point receiver is measured, the camera sees a grey patch of reflectance 1/2
there, so that a program without meters finds a pixel of luminance E/(2 pi)."""
import math
import pathlib
import struct
import sys

HERE = pathlib.Path(__file__).resolve().parent
PI = math.pi
BLACK = 'Material "diffuse" "spectrum reflectance" [360 0 830 0]\n'


def grey(rho):
    return f'Material "diffuse" "spectrum reflectance" [360 {rho:.9g} 830 {rho:.9g}]\n'


GLOW = 'AreaLightSource "diffuse" "float scale" 1\n'  # 1 cd/m^2
GLOW_BOTH = 'AreaLightSource "diffuse" "float scale" 1 "bool twosided" true\n'

files = {}  # path below HERE -> bytes
cases = []  # rows of cases.tsv


def v(*numbers):
    return "[" + " ".join(f"{x:.9g}" for x in numbers) + "]"


def deg(a):
    return a * PI / 180


def case(name, ident, what, source, content, readings, depth=1, head="", integrator="path"):
    """One scene. readings: (meter's name, expected value, unit, relative uncertainty of that value)."""
    lines = [f"# {what}", f"# {source}"]
    for meter, value, unit, _ in readings:
        lines.append(f"#   {meter}: {value:.12g}{' ' + unit if unit != '1' else ''}")
    lines.append(f'Integrator "{integrator}" "integer maxdepth" {depth}' + (' "bool samplelights" false' if integrator == "simplepath" else ""))
    files[f"scenes/{name}.pbrt"] = ("\n".join(lines) + "\n" + head + content).encode()
    for meter, value, unit, within in readings:
        cases.append((ident if len(readings) == 1 else f"{ident} {meter}", f"scenes/{name}.pbrt", meter, f"{value:.15g}", unit, f"{within:.2g}", what, source))


def view(eye, at, fov=0.01, up=(0, 0, 1)):
    return f'LookAt {v(*eye, *at, *up)[1:-1]}\nCamera "perspective" "float fov" {fov:g}\n' \
           'Film "rgb" "integer xresolution" 1 "integer yresolution" 1\nPixelFilter "box"\nWorldBegin\n'


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def irradiance(name, ident, what, source, content, E, p=(0, 0, 0), n=(0, 0, 1), within=0.0, head="", integrator="path"):
    """A point receiver: a meter, and a grey patch of 2 mm that a camera sees."""
    n = unit(n)
    t = unit(cross(n, (0, 1, 0) if abs(n[1]) < 0.9 else (1, 0, 0)))
    b = cross(n, t)
    corners = [p[i] + 1e-3 * (s * t[i] + r * b[i]) for r in (-1, 1) for s in (-1, 1) for i in range(3)]
    eye = [p[i] + 0.01 * (n[i] + 0.5 * t[i]) for i in range(3)]
    patch = f'AttributeBegin\n{grey(0.5)}Shape "bilinearmesh" "point3 P" {v(*corners)}\nAttributeEnd\n'
    meter = f'#@ Meter "irradiance" "string name" "E" "point3 p" {v(*p)} "normal n" {v(*n)}\n'
    case(name, ident, what, source, view(eye, p, up=t) + patch + f'AttributeBegin\n{content}AttributeEnd\n' + meter, [("E", E, "lx", within)], head=head, integrator=integrator)


def radiance(name, ident, what, source, content, L, o, d, within=0.0, depth=1, head="", integrator="path"):
    meter = f'#@ Meter "radiance" "string name" "L" "point3 p" {v(*o)} "vector3 d" {v(*d)}\n'
    at = [o[i] + d[i] for i in range(3)]
    up = (0, 1, 0) if abs(d[1]) < 0.9 else (1, 0, 0)
    case(name, ident, what, source, view(o, at, up=up) + content + meter, [("L", L, "cd/m^2", within)], depth=depth, head=head, integrator=integrator)


# ---- A: points and distant light ----

def point(h, d, power):
    E = power / (4 * PI) * h / (h * h + d * d) ** 1.5
    irradiance(f"point_h{h:g}_d{d:g}", {(2, 0): "A1", (3, 4): "A2"}.get((h, d), "CIE 171 5.2"), f"isotropic point of {power:g} lm, {h:g} m above and {d:g} m beside",
               "E = Phi/(4 pi) h/r^3", f'LightSource "point" "point3 from" {v(0, 0, h)} "float power" {power:g}\n', E, p=(d, 0, 0))


def distant(theta, E0):
    irradiance(f"distant_{theta:g}", "A3" if theta == 60 else "A3 class", f"distant light of {E0:g} lx, {theta:g} deg from the normal", "E = E0 cos(theta)",
               f'LightSource "distant" "float illuminance" {E0:g} "point3 from" {v(math.sin(deg(theta)), 0, math.cos(deg(theta)))} "point3 to" [0 0 0]\n',
               E0 * math.cos(deg(theta)))


def spot(inner, outer):
    flux = 2 * PI * 100 * ((1 - math.cos(deg(inner))) + (math.cos(deg(inner)) - math.cos(deg(outer))) / 2)
    case(f"spot_{inner:g}_{outer:g}", "A6", f"spot of 100 cd, smooth from {inner:g} to {outer:g} deg: its flux through a plane",
         "Phi = 2 pi I [(1 - cos a) + (cos a - cos b)/2]", view((0, 0, -1), (0, 0, 0), up=(0, 1, 0)) +
         f'LightSource "spot" "float scale" 100 "float coneangle" {outer:g} "float conedeltaangle" {outer - inner:g} "point3 to" [0 0 1]\n'
         '#@ Meter "flux" "string name" "Phi" "string shape" "disk" "point3 p" [0 0 1] "normal n" [0 0 -1] '
         f'"float radius" {1.1 * math.tan(deg(outer)):.9g}\n', [("Phi", flux, "lm", 0)])


# ---- B: areas that glow ----

def disk(R, h, d, tilt):
    """Foote 1915; tilted receivers that see the whole disk: cos(tilt) E_z + sin(tilt) E_x."""
    W = math.sqrt((h * h + d * d + R * R) ** 2 - 4 * R * R * d * d)
    E_z = PI / 2 * (1 - (h * h + d * d - R * R) / W)
    E_x = PI / 2 * h / d * ((h * h + d * d + R * R) / W - 1) if d else 0
    E = math.cos(deg(tilt)) * E_z + math.sin(deg(tilt)) * E_x
    ident = {(1, 2, 0, 0): "B1", (1, 2, 1.5, 0): "B2", (1, 2, 1.5, 35): "B4"}.get((R, h, d, tilt), "B2 class")
    irradiance(f"disk_h{h:g}_d{d:g}_tilt{tilt:g}", ident, f"disk of radius {R:g} m and 1 cd/m^2, {h:g} m above, {d:g} m aside, receiver tilted by {tilt:g} deg",
               "Foote 1915", BLACK + GLOW + f'ReverseOrientation Shape "disk" "float height" {h:g} "float radius" {R:g}\n', E, p=(d, 0, 0),
               n=(-math.sin(deg(tilt)), 0, math.cos(deg(tilt))))


def sphere(R, D, tilt):
    H, t = D / R, deg(tilt)
    if tilt + math.degrees(math.asin(1 / H)) <= 90:
        E = PI / (H * H) * math.cos(t)
    else:
        q = math.sqrt(H * H - 1)
        E = math.cos(t) / (H * H) * math.acos(-q / math.tan(t)) - q * math.sqrt(1 - (H * math.cos(t)) ** 2) / (H * H) + PI / 2 - \
            math.asin(q / (H * math.sin(t)))
    ident = {(3, 40): "B5", (2, 80): "B6.80", (2, 90): "B6.90"}.get((D, tilt), "B5 class")
    irradiance(f"sphere_D{D:g}_tilt{tilt:g}", ident, f"sphere of radius {R:g} m and 1 cd/m^2 at {D:g} m, {tilt:g} deg from the normal", "Naraghi 1988",
               BLACK + GLOW + f'Translate {D * math.sin(t):.9g} 0 {D * math.cos(t):.9g} Shape "sphere" "float radius" {R:g}\n', E)


def cap(half_angle):
    irradiance(f"cap_{half_angle:g}", {15: "B14.15", 0.2665: "B14.0.2665"}[half_angle], f"sphere of 1 cd/m^2 that fills a cone of {half_angle:g} deg", "E = pi L sin^2(alpha)",
               BLACK + GLOW + f'Translate 0 0 1 Shape "sphere" "float radius" {math.sin(deg(half_angle)):.9g}\n', PI * math.sin(deg(half_angle)) ** 2)


def corner(X, Y):
    """Irradiance of a rectangle X by Y times the distance, parallel, over its corner; radiance 1."""
    a, b = math.sqrt(1 + X * X), math.sqrt(1 + Y * Y)
    return 0.5 * (X / a * math.atan(Y / a) + Y / b * math.atan(X / b))


def corners(x0, x1, y0, y1, h):
    def c(x, y):
        return math.copysign(1, x) * math.copysign(1, y) * corner(abs(x) / h, abs(y) / h)
    return c(x1, y1) - c(x0, y1) - c(x1, y0) + c(x0, y0)


def rectangle(name, ident, x0, x1, y0, y1, h, luminance=1.0):
    irradiance(name, ident, f"rectangle {x1 - x0:g} m x {y1 - y0:g} m of {luminance:g} cd/m^2, {h:g} m above", "Howell; Hamilton & Morgan 1952",
               BLACK + f'AreaLightSource "diffuse" "float scale" {luminance:g}\nReverseOrientation Shape "bilinearmesh" "point3 P" '
               f'{v(x0, y0, h, x1, y0, h, x0, y1, h, x1, y1, h)}\n', luminance * corners(x0, x1, y0, y1, h))


def screened(h, screen):
    """A square over the receiver, of which a screen at the height `screen` hides the half x > 0."""
    irradiance(f"screened_{screen:g}", "CIE 171 5.7", f"square of 1 m and 1 cd/m^2, {h:g} m above, half of it behind a screen {screen:g} m above", "Hamilton & Morgan 1952",
               BLACK + f'Shape "bilinearmesh" "point3 P" {v(0, -9, screen, 9, -9, screen, 0, 9, screen, 9, 9, screen)}\n' + GLOW +
               f'ReverseOrientation Shape "bilinearmesh" "point3 P" {v(-0.5, -0.5, h, 0.5, -0.5, h, -0.5, 0.5, h, 0.5, 0.5, h)}\n', corners(-0.5, 0, -0.5, 0.5, h))


def triangle():
    corners3 = [(1, 0, 1), (-1, 2, 1.5), (-1, -1, 2)]
    E = 0
    for a, b in zip(corners3, corners3[1:] + corners3[:1]):
        E += 0.5 * math.acos(dot(unit(a), unit(b))) * unit(cross(a, b))[2]
    irradiance("triangle", "B10", "triangle of 1 cd/m^2 above the horizon", "Lambert 1760; Arvo 1994", BLACK + GLOW_BOTH +
               'Shape "trianglemesh" "point3 P" [1 0 1 -1 2 1.5 -1 -1 2] "integer indices" [0 1 2]\n', abs(E))


def dome(tilt):
    t = deg(tilt)
    ground = "" if tilt == 0 else f'AttributeBegin\n{BLACK}Shape "disk" "float radius" 1e6 "float height" -0.01\nAttributeEnd\n'
    irradiance(f"dome_{tilt:g}", f"B12.{tilt:g}" if tilt else "B12.0, E1", f"uniform sky of 1 cd/m^2 over black ground, receiver tilted by {tilt:g} deg",
               "E = pi L (1 + cos(tilt))/2", f'LightSource "infinite" "float scale" 1\n{ground}', PI * (1 + math.cos(t)) / 2, n=(math.sin(t), 0, math.cos(t)),
               within=0 if tilt == 0 else 1e-6)


# ---- C: exchange ----

def exchange(name, ident, what, source, content, surface, F, area_of_source):
    case(name, ident, what, source, view((9, 9, 9), (0, 0, 0)) + f'AttributeBegin\n{content}AttributeEnd\n#@ Meter "flux" "string name" "Phi" {surface}\n',
         [("Phi", F * PI * area_of_source, "lm", 0)], depth=0)


def opposed(a, b, c):
    X, Y = a / c, b / c
    F = 2 / (PI * X * Y) * (0.5 * math.log((1 + X * X) * (1 + Y * Y) / (1 + X * X + Y * Y)) + X * math.sqrt(1 + Y * Y) * math.atan(X / math.sqrt(1 + Y * Y)) +
                            Y * math.sqrt(1 + X * X) * math.atan(Y / math.sqrt(1 + X * X)) - X * math.atan(X) - Y * math.atan(Y))
    exchange(f"opposed_{a:g}x{b:g}_{c:g}", "C1, CIE 171 5.4" if a == 1 else "C2", f"two parallel rectangles {a:g} m x {b:g} m, {c:g} m apart: flux from one onto the other", "Howell C-11",
             BLACK + GLOW + f'ReverseOrientation Shape "bilinearmesh" "point3 P" {v(0, 0, c, a, 0, c, 0, b, c, a, b, c)}\n',
             f'"string shape" "rectangle" "point3 p" [0 0 0] "vector3 u" {v(a, 0, 0)} "vector3 v" {v(0, b, 0)}', F, a * b)


def perpendicular():
    W = H = 1.0
    A = (1 + W * W) * (1 + H * H) / (1 + W * W + H * H)
    B = (W * W * (1 + W * W + H * H) / ((1 + W * W) * (W * W + H * H))) ** (W * W)
    C = (H * H * (1 + H * H + W * W) / ((1 + H * H) * (H * H + W * W))) ** (H * H)
    s = math.sqrt(H * H + W * W)
    F = 1 / (PI * W) * (W * math.atan(1 / W) + H * math.atan(1 / H) - s * math.atan(1 / s) + 0.25 * math.log(A * B * C))
    exchange("perpendicular", "C3", "two unit squares with a common edge: flux from one onto the other", "Howell C-14",
             BLACK + GLOW + 'Shape "bilinearmesh" "point3 P" [0 0 0 0 1 0 0 0 1 0 1 1]\n',
             '"string shape" "rectangle" "point3 p" [0 0 0] "vector3 u" [1 0 0] "vector3 v" [0 1 0]', F, 1)


def coaxial(r1, r2, h):
    R1, R2 = r1 / h, r2 / h
    S = 1 + (1 + R2 * R2) / (R1 * R1)
    F = 0.5 * (S - math.sqrt(S * S - 4 * (r2 / r1) ** 2))
    exchange(f"coaxial_{r1:g}_{r2:g}_{h:g}", "C5" if r2 == 1 else "C5 class", f"disks of radius {r1:g} and {r2:g} m on one axis, {h:g} m apart", "Howell C-41",
             BLACK + GLOW + f'ReverseOrientation Shape "disk" "float height" {h:g} "float radius" {r1:g}\n',
             f'"string shape" "disk" "point3 p" [0 0 0] "normal n" [0 0 1] "float radius" {r2:g}', F, PI * r1 * r1)


def sphere_to_disk(R, r, h):
    F = 0.5 * (1 - 1 / math.sqrt(1 + (r / h) ** 2))
    exchange("sphere_disk", "C7", f"sphere of radius {R:g} m, {h:g} m above the centre of a disk of radius {r:g} m", "Feingold & Gupta 1970",
             BLACK + GLOW + f'Translate 0 0 {h:g} Shape "sphere" "float radius" {R:g}\n',
             f'"string shape" "disk" "point3 p" [0 0 0] "normal n" [0 0 1] "float radius" {r:g}', F, 4 * PI * R * R)


# ---- D: to and fro ----

def furnace(rho, shape, text, depth):
    n = math.ceil(math.log(1e-8) / math.log(rho)) if depth is None else depth
    radiance(f"furnace_{shape}_{rho:g}" + ("" if depth is None else f"_depth{depth}"), "D1b" if depth else "D1" if rho == 0.8 else "D1 class",
             f"closed {shape} whose walls glow with 1 cd/m^2 and reflect {rho:g}" + (f", {depth} bounces" if depth else ""), "L = Le (1 - rho^(n+1))/(1 - rho)",
             grey(rho) + GLOW_BOTH + text, (1 - rho ** (n + 1)) / (1 - rho), (0.11, -0.07, 0.05), (0.36, 0.48, 0.8), depth=n, integrator="simplepath")


CUBE = 'Shape "bilinearmesh" "point3 P" [-1 -1 -1 1 -1 -1 -1 1 -1 1 1 -1 -1 -1 1 1 -1 1 -1 1 1 1 1 1] ' \
       '"integer indices" [0 1 2 3 4 5 6 7 0 1 4 5 2 3 6 7 0 2 4 6 1 3 5 7]\n'


def integrating_sphere(rho, f, power=1.0, R=0.15):
    """Wall irradiance beside the direct light, from the multiplier of Jacquez & Kuppenheim 1955; the lamp stands at the centre."""
    A = 4 * PI * R * R
    wall = A * (1 - f)
    E = power / A * (1 + rho * (1 - f) / (1 - rho * (1 - f)))
    content = f'LightSource "point" "float power" {power:g}\n{grey(rho)}#@ Name "wall"\nShape "sphere" "float radius" {R:g} "float zmax" {R * (1 - 2 * f):.9g}\n' \
              'ReverseOrientation\n'
    case(f"integrating_sphere_{rho:g}", "D2, D3" if rho == 0.99 else "D5 class", f"sphere with a port of {100 * f:g} %, wall reflectance {rho:g}: flux onto its wall, direct light included",
         "Jacquez & Kuppenheim 1955", view((0, 0, 0), (0, 0, -1), up=(0, 1, 0)) + content + '#@ Meter "flux" "string name" "Phi" "string surface" "wall" "string side" "back"\n',
         [("Phi", E * wall, "lm", 0)], depth=2000)


def lambertian_cube():
    """Floor and walls reflect 1/2, the ceiling gives off 1 and reflects nothing: continuous radiosity, not six patches."""
    content = f'AttributeBegin\n{BLACK}AreaLightSource "diffuse" "float scale" {1 / PI:.12g}\nReverseOrientation Shape "bilinearmesh" "point3 P" [0 0 1 1 0 1 0 1 1 1 1 1]\nAttributeEnd\n'
    content += grey(0.5) + 'Shape "bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 0]\n' + \
        'Shape "bilinearmesh" "point3 P" [0 0 0 1 0 0 0 0 1 1 0 1  0 1 0 1 1 0 0 1 1 1 1 1  0 0 0 0 1 0 0 0 1 0 1 1  1 0 0 1 1 0 1 0 1 1 1 1] ' \
        '"integer indices" [0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15]\n'
    square = '#@ Meter "flux" "string name" "{}" "string shape" "rectangle" "point3 p" {} "vector3 u" {} "vector3 v" {}\n'
    content += square.format("floor", "[0 0 0]", "[1 0 0]", "[0 1 0]") + square.format("wall", "[0 0 0]", "[0 0 1]", "[1 0 0]") + \
        square.format("ceiling", "[0 0 1]", "[0 1 0]", "[1 0 0]")
    case("lambertian_cube", "D13", "unit cube, ceiling gives off 1 lm/m^2, floor and walls reflect 1/2: flux onto floor, wall, ceiling",
         "continuous radiosity, Galerkin and Richardson, uncertain by 5e-9", view((0.5, 0.5, 0.5), (0.5, 0.5, 0)).replace("0 0 1\nCamera", "0 1 0\nCamera") + content,
         [("floor", 0.31034917, "lm", 2e-8), ("wall", 0.32798491, "lm", 2e-8), ("ceiling", 0.18885559, "lm", 2e-8)], depth=40)


def room_with_point(rho):
    """CIE 171 5.8: the mean over all walls of a closed room is exact, Phi/(S (1 - rho)); here as the flux onto all of them."""
    cube = CUBE.replace("-1", "-2").replace(" 1", " 2").replace("[0 2 2 3 4 5 6 7 0 2 4 5 2 3 6 7 0 2 4 6 2 3 5 7]", "[0 1 2 3 4 5 6 7 0 1 4 5 2 3 6 7 0 2 4 6 1 3 5 7]")
    content = f'LightSource "point" "float power" 10000\n{grey(rho)}#@ Name "walls"\n{cube}'
    n = math.ceil(math.log(1e-7) / math.log(rho))
    case(f"room_{rho:g}", "CIE 171 5.8", f"closed room of 4 m, 10000 lm at its centre, walls reflect {rho:g}: flux onto them", "Phi/(1 - rho)",
         view((0, 0, 0), (0, 0, -1), up=(0, 1, 0)) + content + '#@ Meter "flux" "string name" "Phi" "string surface" "walls" "string side" "both"\n',
         [("Phi", 10000 / (1 - rho), "lm", 0)], depth=n)


# ---- E: skies, as images (equal-area octahedral maps); the ground hides their lower half ----

def square_to_sphere(x, y):
    """Clarberg 2008: the unit square to the unit sphere, areas kept."""
    u, w = 2 * x - 1, 2 * y - 1
    up, wp = abs(u), abs(w)
    signed = 1 - (up + wp)
    d = abs(signed)
    r = 1 - d
    phi = (1 if r == 0 else (wp - up) / r + 1) * PI / 4
    z = math.copysign(1 - r * r, signed)
    s = r * math.sqrt(2 - r * r)
    return math.copysign(math.cos(phi), u) * s, math.copysign(math.sin(phi), w) * s, z


images = {}  # name -> texels of a sky


def sky_image(name, L, n=96, sub=3):
    """L of the unit direction; below the horizon its mirror image, which the ground hides."""
    def mean(i, j):
        points = [square_to_sphere((i + (a + 0.5) / sub) / n, (j + (b + 0.5) / sub) / n) for a in range(sub) for b in range(sub)]
        return sum(L(x, y, abs(z)) for x, y, z in points) / sub ** 2
    images[name] = [[mean(i, j) for i in range(n)] for j in range(n)]
    data = b"PF\n%d %d\n-1\n" % (n, n)
    for row in reversed(images[name]):  # PFM's first row is the lowest
        data += b"".join(struct.pack("<fff", x, x, x) for x in row)
    files[f"skies/{name}.pfm"] = data


def flat_texels_cost(name, E, normal, sub=8):
    """Relative difference of the irradiance under the image, whose texels are flat, from E."""
    n, total = len(images[name]), 0.0
    for j in range(n):
        for i in range(n):
            for k in range(sub * sub):
                d = square_to_sphere((i + (k % sub + 0.5) / sub) / n, (j + (k // sub + 0.5) / sub) / n)
                if d[2] > 0:
                    total += images[name][j][i] * max(0, dot(normal, d))
    return abs(total * 4 * PI / (n * sub) ** 2 / E - 1)


def overcast(x, y, z):
    return (1 + 2 * z) / 3


def general_sky(a, b, c, d, e, sun_zenith):
    """ISO 15469 / CIE S 011: gradation times indicatrix over those of the zenith; azimuth of the sun along +x."""
    sun = (math.sin(sun_zenith), 0, math.cos(sun_zenith))

    def phi(cos_Z):
        return 1 + a * math.exp(b / cos_Z) if cos_Z > 1e-9 else 1.0

    def f(cos_chi):
        chi = math.acos(max(-1, min(1, cos_chi)))
        return 1 + c * (math.exp(d * chi) - math.exp(d * PI / 2)) + e * math.cos(chi) ** 2
    norm = phi(1) * f(sun[2])
    return lambda x, y, z: phi(z) * f(x * sun[0] + z * sun[2]) / norm


def through(L, x0, x1, y0, y1, m=400):
    """INTEGRAL L cos(theta) dw over a window in the plane at height 1: midpoint rule."""
    total = 0.0
    for i in range(m):
        for k in range(m):
            x, y = x0 + (x1 - x0) * (i + 0.5) / m, y0 + (y1 - y0) * (k + 0.5) / m
            r2 = 1 + x * x + y * y
            r = math.sqrt(r2)
            total += L(x / r, y / r, 1 / r) / (r2 * r2)
    return total * (x1 - x0) * (y1 - y0) / m ** 2


GROUND = f'AttributeBegin\n{BLACK}Shape "disk" "float radius" 1e6 "float height" -0.01\nAttributeEnd\n'


def sky_light(name):
    return f'LightSource "infinite" "string filename" "../skies/{name}.pfm"\n'


def under_sky(scene, name, ident, what, source, E, n=(0, 0, 1)):
    irradiance(scene, ident, what, source, sky_light(name) + GROUND, E, n=n, within=flat_texels_cost(name, E, n) + 2e-6)


def skies():
    sky_image("overcast", overcast)
    under_sky("sky_overcast", "overcast", "E2", "CIE overcast sky of 1 cd/m^2 at the zenith: horizontal", "7 pi/9; Moon & Spencer 1942", 7 * PI / 9)
    under_sky("sky_overcast_vertical", "overcast", "E3", "CIE overcast sky: vertical, over black ground", "pi/6 + 4/9", PI / 6 + 4 / 9, n=(1, 0, 0))
    for kind, a, b, c, d, e, known in ((1, 4, -0.7, 0, -1, 0, 2.44954087402), (8, 0, -1, 10, -3, 0.45, 3.338746183), (11, -1, -0.55, 10, -3, 0.45, 4.48536012577)):
        sky_image(f"cie{kind}", general_sky(a, b, c, d, e, PI / 4))
        under_sky(f"sky_cie{kind}", f"cie{kind}", f"E7.{kind}", f"CIE general sky of type {kind}, sun at 45 deg: horizontal, over the luminance of the zenith", "ISO 15469", known)
    # a hole of 1 m x 1 m in a roof, 3 m above the receiver
    roof = BLACK + "".join(f'Shape "bilinearmesh" "point3 P" {v(x0, y0, 3, x1, y0, 3, x0, y1, 3, x1, y1, 3)}\n'
                           for x0, x1, y0, y1 in ((-1e4, -0.5, -1e4, 1e4), (0.5, 1e4, -1e4, 1e4), (-0.5, 0.5, -1e4, -0.5), (-0.5, 0.5, 0.5, 1e4)))
    irradiance("roof_uniform", "E5u, CIE 171 5.9", "uniform sky of 1 cd/m^2 through a roof opening of 1 m x 1 m, 3 m above", "4 corners of Hamilton & Morgan",
               'LightSource "infinite" "float scale" 1\n' + roof + GROUND, corners(-0.5, 0.5, -0.5, 0.5, 3))
    irradiance("roof_overcast", "E5o, CIE 171 5.9", "CIE overcast sky through a roof opening of 1 m x 1 m, 3 m above", "quadrature", sky_light("overcast") + roof + GROUND,
               through(overcast, -1 / 6, 1 / 6, -1 / 6, 1 / 6), within=1e-4)
    # a window in a facade: 2 m wide, from 1 m to 2 m above the receiver, which looks up, 3 m behind it
    wall = BLACK + "".join(f'Shape "bilinearmesh" "point3 P" {v(3, y0, z0, 3, y1, z0, 3, y0, z1, 3, y1, z1)}\n'
                           for y0, y1, z0, z1 in ((-9, -1, -0.01, 4), (1, 9, -0.01, 4), (-1, 1, -0.01, 1), (-1, 1, 2, 4))) + \
        f'Shape "bilinearmesh" "point3 P" {v(-3, -9, 4, 3, -9, 4, -3, 9, 4, 3, 9, 4)}\n' \
        f'Shape "bilinearmesh" "point3 P" {v(-3, -9, -0.01, -3, 9, -0.01, -3, -9, 4, -3, 9, 4)}\n' + \
        "".join(f'Shape "bilinearmesh" "point3 P" {v(-3, y, -0.01, 3, y, -0.01, -3, y, 4, 3, y, 4)}\n' for y in (-9, 9))

    def under_edge(z):  # a receiver that looks up, below the middle of a half-infinite strip: the part of the window below height z
        return 2 * 0.5 * (math.atan(1 / 3) - 3 / math.hypot(3, z) * math.atan(1 / math.hypot(3, z)))
    irradiance("facade_uniform", "CIE 171 5.11", "uniform sky of 1 cd/m^2 through a window 2 m wide, 1 to 2 m up, 3 m away", "Howell C-13",
               'LightSource "infinite" "float scale" 1\n' + wall + GROUND, under_edge(2) - under_edge(1))
    mask = f'AttributeBegin\n{BLACK}AreaLightSource "diffuse" "float scale" 0.2 "bool twosided" true\nShape "bilinearmesh" "point3 P" ' \
           f'{v(6, -1e3, -0.005, 6, -1e3, 3, 6, 1e3, -0.005, 6, 1e3, 3)}\nAttributeEnd\n'
    # the wall opposite, 3 m high and 6 m away, hides what is seen below a height of 1.5 m in the window, and shines with 0.2
    irradiance("facade_mask", "CIE 171 5.13", "the same window with a wall of 0.2 cd/m^2 opposite, which hides its lower half", "Howell C-13",
               'LightSource "infinite" "float scale" 1\n' + wall + mask + GROUND, under_edge(2) - under_edge(1.5) + 0.2 * (under_edge(1.5) - under_edge(1)))


# ---- G: glass, metal, panes ----

def fresnel(cos_i, eta, k=0.0):
    n = complex(eta, k)
    ct = (1 - (1 - cos_i ** 2) / n ** 2) ** 0.5
    rs, rp = (cos_i - n * ct) / (cos_i + n * ct), (n * cos_i - ct) / (n * cos_i + ct)
    return abs(rs) ** 2, abs(rp) ** 2


def sheet(z):
    return f'AttributeBegin\n{BLACK}{GLOW_BOTH}Shape "disk" "float height" {z:g} "float radius" 1e4\nAttributeEnd\n'


def slanted(name, ident, what, source, material, glow, theta, L, depth=1, shape='Shape "disk" "float radius" 1e3\n'):
    s, c = math.sin(deg(theta)), math.cos(deg(theta))
    radiance(name, ident, what, source, sheet(glow) + material + shape, L, (-0.5 * s, 0, 0.5 * c), (s, 0, -c), depth=depth)


def glass_and_metal():
    for theta in (0, 45, 80):
        slanted(f"glass_{theta}", f"G1.{theta}", f"glass of index 1.5 reflects a sheet of 1 cd/m^2, {theta} deg", "Fresnel 1823", 'Material "dielectric" "float eta" 1.5\n', 1, theta,
                sum(fresnel(math.cos(deg(theta)), 1.5)) / 2)
    for theta in (0, 60):
        slanted(f"metal_{theta}", f"G3.Au.{theta}", f"metal of index 0.43 + 2.455 i reflects a sheet of 1 cd/m^2, {theta} deg", "Fresnel 1823",
                'Material "conductor" "spectrum eta" [360 0.43 830 0.43] "spectrum k" [360 2.455 830 2.455]\n', 1, theta, sum(fresnel(math.cos(deg(theta)), 0.43, 2.455)) / 2)
    for theta in (0, 30, 45, 60):
        T = sum((1 - r) / (1 + r) for r in fresnel(math.cos(deg(theta)), 1.52)) / 2
        slanted(f"pane_{theta}", f"G9.{theta}, CIE 171 5.5", f"pane of index 1.52 before a sheet of 1 cd/m^2, {theta} deg", "Stokes 1862",
                'Material "thindielectric" "float eta" 1.52 "bool unbiased" true\n', -1, theta, T)
    slanted("from_glass", "G12", "radiance of a sheet of 1 cd/m^2, seen from inside of glass of index 1.5, straight on", "n^2 (1 - R)",
            'Material "dielectric" "float eta" 1.5\n', -1, 0, 1.5 ** 2 * (1 - sum(fresnel(1, 1.5)) / 2), shape='ReverseOrientation Shape "disk" "float radius" 1e3\n')


# ---- photometry ----

def lamps():
    for r in (0.01, 0.1):
        irradiance(f"lamp_area_{r:g}", "31.83 lx", f"Lambertian disk of 100 lm and radius {r:g} m, 1 m above", "E = Phi/(pi (r^2 + h^2))",
                   BLACK + f'AreaLightSource "diffuse" "float power" 100\nReverseOrientation Shape "disk" "float height" 1 "float radius" {r:g}\n', 100 / (PI * (r * r + 1)))
    irradiance("lamp_point", "7.96 lx", "isotropic point of 100 lm, 1 m above", "E = Phi/(4 pi r^2)", 'LightSource "point" "point3 from" [0 0 1] "float power" 100\n', 100 / (4 * PI))
    for kelvin, luminance in ((2856, 19749726.1611),):
        radiance(f"blackbody_{kelvin}", "I11b.2856", f"blackbody of {kelvin} K in SI units: luminance", "683 lm/W INTEGRAL L V", BLACK +
                 f'AreaLightSource "diffuse" "blackbody L" {kelvin}\nShape "disk" "float radius" 1\n', luminance, (0, 0, 1), (0, 0, -1), within=1e-5, head='#@ Option "string units" "si"\n')


# ---- H: media ----

def medium(albedo, sigma_t, extra=""):
    return (f'MakeNamedMedium "m" "string type" "homogeneous" "spectrum sigma_a" {v(300, (1 - albedo) * sigma_t, 900, (1 - albedo) * sigma_t)} '
            f'"spectrum sigma_s" {v(300, albedo * sigma_t, 900, albedo * sigma_t)}{extra}\n')


def layer(*planes):
    """Interfaces at z, with the medium below (-1) or above (+1)."""
    text = ""
    for z, side in planes:
        media = '"m" ""' if side < 0 else '"" "m"'
        text += f'AttributeBegin\nMaterial "interface"\nMediumInterface {media}\nShape "disk" "float height" {z:g} "float radius" 1e3\nAttributeEnd\n'
    return text


SKY = 'LightSource "infinite" "float scale" 1\n'
FLOOR = f'AttributeBegin\n{BLACK}Shape "disk" "float height" -3 "float radius" 1e3\nAttributeEnd\n'  # the sky shines from above only


def fog(sigma, d):
    radiance(f"fog_{sigma:g}_{d:g}", "H1" if (sigma, d) == (0.7, 2.5) else "H1 class", f"a surface of 1 cd/m^2 behind {d:g} m of absorber of {sigma:g}/m", "L = exp(-sigma d)",
             f'AttributeBegin\n{BLACK}{GLOW_BOTH}Shape "disk" "float height" {d:g} "float radius" 1\nAttributeEnd\n', math.exp(-sigma * d), (0, 0, 0), (0, 0, 1),
             head=medium(0, sigma) + 'MediumInterface "" "m"\n', integrator="volpath")


def point_in_fog(sigma, r, I):
    irradiance(f"fog_point_{sigma:g}_{r:g}", "H2", f"point of {I:g} cd in absorber of {sigma:g}/m, {r:g} m above", "E = I exp(-sigma r)/r^2",
               f'LightSource "point" "point3 from" {v(0, 0, r)} "float power" {4 * PI * I:.12g}\n', I * math.exp(-sigma * r) / r**2,
               head=medium(0, sigma) + 'MediumInterface "" "m"\n', integrator="volpath")


def slab_once(albedo, tau, mu0, mu, is_reflected):
    s0, s = math.sqrt(1 - mu0 * mu0), math.sqrt(1 - mu * mu)
    if is_reflected:
        L = albedo / (4 * PI) * mu0 / (mu0 + mu) * (1 - math.exp(-tau * (1 / mu + 1 / mu0)))
    else:
        L = albedo / (4 * PI) * mu0 / (mu0 - mu) * (math.exp(-tau / mu0) - math.exp(-tau / mu))
    radiance(f"slab_once_{'reflected' if is_reflected else 'transmitted'}", "H3r" if is_reflected else "H3t", f"slab of depth {tau:g} and albedo {albedo:g}, lit and seen aslant: scattered once",
             "Chandrasekhar 1950", f'LightSource "distant" "float illuminance" 1 "point3 from" {v(s0, 0, mu0)} "point3 to" [0 0 0]\n' + layer((0, -1), (-tau, 1)), L,
             (0, 0, 1 if is_reflected else -tau - 1), (0, s, -mu if is_reflected else mu), head=medium(albedo, 1), integrator="volpath")


def chandrasekhar_H(mu, albedo, n=20000):
    """ln H(mu) = -(mu/pi) INTEGRAL_0^inf ln(1 - albedo atan(t)/t) / (1 + mu^2 t^2) dt; t = tan(a)."""
    total = 0.0
    for i in range(n):
        a = (i + 0.5) * PI / 2 / n
        t = math.tan(a)
        total += math.log(1 - albedo * a / t) * (1 + t * t) / (1 + mu * mu * t * t)
    return math.exp(-mu / PI * total * PI / 2 / n)


def half_space(albedo, mu):
    radiance(f"half_space_{albedo:g}_{mu:g}", f"H6.{albedo:g}.{mu:.1f}", f"half-space of albedo {albedo:g} under an even sky, seen under mu = {mu:g}", "1 - sqrt(1 - albedo) H(mu), Chandrasekhar 1950",
             SKY + layer((0, -1)), 1 - math.sqrt(1 - albedo) * chandrasekhar_H(mu, albedo), (0, 0, 1), (0, math.sqrt(1 - mu * mu), -mu), within=1e-6, depth=10000, head=medium(albedo, 1),
             integrator="volpath")


def slab(albedo, mu, R, T):
    s = math.sqrt(1 - mu * mu)
    for name, ident, L, z in (("reflected", "H11", R, 1), ("transmitted", "H11t", T, -2)):
        radiance(f"slab_{name}_{albedo:g}_{mu:g}", f"{ident}.1.{albedo:g}.{mu:g}", f"slab of depth 1 and albedo {albedo:g} under half an even sky, seen under mu = {mu:g}",
                 "van de Hulst 1980; Milne's integral equation by Nystrom's method", SKY + FLOOR + layer((0, -1), (-1, 1)), L, (0, 0, z), (0, s, -mu if z > 0 else mu), within=1e-7, depth=10000,
                 head=medium(albedo, 1), integrator="volpath")


def absorbing_slab(tau):
    """2 E3(tau) = 2 INTEGRAL_0^1 mu exp(-tau/mu) dmu."""
    n = 20000
    T = 2 * sum((i + 0.5) / n * math.exp(-tau * n / (i + 0.5)) for i in range(n)) / n
    irradiance(f"slab_absorber_{tau:g}", "H10", f"an even sky above an absorber of depth {tau:g}", "E = 2 pi E3(tau)", SKY + layer((2, -1), (1, 1)), PI * T, head=medium(0, tau),
               within=1e-8, integrator="volpath")


def glowing_ball(tau, b):
    radiance(f"glowing_ball_{tau:g}_{b:g}", "H9 class", f"ball of glowing absorber of optical radius {tau:g}, seen {b:g} radii beside its centre", "L = 1 - exp(-2 tau sqrt(1 - b^2))",
             'AttributeBegin\nMaterial "interface"\nMediumInterface "m" ""\nShape "sphere"\nAttributeEnd\n', 1 - math.exp(-2 * tau * math.sqrt(1 - b * b)), (b, 0, -3), (0, 0, 1),
             head=medium(0, tau, ' "spectrum Le" [300 1 900 1]'), integrator="volpath")


def white_ball(sigma):
    radiance(f"white_ball_{sigma:g}", "furnace", f"ball of a medium of {sigma:g}/m that absorbs nothing, in an even sky: it is not seen", "L = 1",
             SKY + 'AttributeBegin\nMaterial "interface"\nMediumInterface "m" ""\nShape "sphere"\nAttributeEnd\n', 1, (0.3, 0, -3), (0, 0, 1), depth=100000, head=medium(1, sigma, ' "float g" 0.7'),
             integrator="volpath")


def media():
    for sigma, d in ((0.7, 2.5), (0.1, 1), (3, 2)):
        fog(sigma, d)
    point_in_fog(0.3, 2, 10)
    slab_once(0.8, 1, 0.6, 0.5, True)
    slab_once(0.8, 1, 0.6, 0.5, False)
    for albedo in (0.5, 0.9):
        for mu in (0.5, 1):
            half_space(albedo, mu)
    slab(1, 1, 0.341328760066, 0.658671239934)
    slab(0.9, 0.5, 0.393661658837, 0.414839902926)
    absorbing_slab(1)
    for tau, b in ((1, 0), (1, 0.8), (0.1, 0), (5, 0.8)):
        glowing_ball(tau, b)
    white_ball(3)


def build():
    for h, d in ((2, 0), (3, 4), (3, 0), (3, 1), (3, 2)):
        point(h, d, 1000)
    for theta in (0, 60, 80):
        distant(theta, 1000)
    spot(20, 30)
    for d, tilt in ((0, 0), (1.5, 0), (1.5, 35), (0.5, 0), (4, 0)):
        disk(1, 2, d, tilt)
    for D, tilt in ((3, 40), (3, 0), (2, 80), (2, 90)):
        sphere(1, D, tilt)
    for a in (15, 0.2665):
        cap(a)
    rectangle("rectangle_corner", "B7", 0, 2, 0, 1, 1)
    rectangle("rectangle_centre", "B8", -0.5, 0.5, -0.5, 0.5, 1)
    for d in (0, 1, 2):
        rectangle(f"rectangle_grid_{d}", "CIE 171 5.3", d - 0.5, d + 0.5, -1, 1, 3, luminance=1000)
    for screen in (0.25, 0.75):
        screened(1, screen)
    triangle()
    for tilt in (0, 30, 60, 90, 120):
        dome(tilt)
    opposed(1, 1, 1)
    opposed(2, 1, 0.5)
    perpendicular()
    coaxial(1, 1, 1)
    coaxial(1, 0.5, 2)
    sphere_to_disk(0.5, 1.5, 2)
    for rho in (0.1, 0.5, 0.8):
        furnace(rho, "cube", CUBE, None)
    furnace(0.8, "sphere", 'Shape "sphere" "float radius" 1.3\n', None)
    furnace(0.8, "cube", CUBE, 10)
    for rho in (0.99, 0.989, 0.9):
        integrating_sphere(rho, 0.02)
    lambertian_cube()
    for rho in (0.1, 0.5, 0.9):
        room_with_point(rho)
    skies()
    glass_and_metal()
    lamps()
    media()
    header = ("case", "scene", "meter", "expected", "unit", "relative uncertainty of it", "what", "source")
    files["cases.tsv"] = "".join("\t".join(row) + "\n" for row in [header] + cases).encode()


def main():
    build()
    stale = [name for name, data in files.items() if not (HERE / name).is_file() or (HERE / name).read_bytes() != data]
    if sys.argv[1:] == ["--check"]:
        for name in stale:
            print(f"validation/{name} is not what generate.py writes")
        sys.exit(bool(stale))
    for name in stale:
        (HERE / name).parent.mkdir(exist_ok=True)
        (HERE / name).write_bytes(files[name])
    print(f"{len(files)} files, {len(stale)} written; {len(cases)} readings")


if __name__ == "__main__":
    main()
