#!/usr/bin/env python3
"""Compares the height of free blocks under gravity with the height that `stochc check --physics` expects.

python3 lab/sedimentation/run.py [STOCHC]    needs only Python, takes some minutes
"""
import json
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

STOCHC = sys.argv[1] if len(sys.argv) > 1 else "target/release/stochc"

# The magnets are too weak to hold blocks, so only the other terms of the scene move them.
SCENE = """scene s {{ {scene}
    contact {{ restitution 0  friction 0.3 }}
    bond attract {{ pull {pull}  anchor centres {within} tilt 5 deg }}
}}
assembly s in s {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A }} }}
"""


def heat(mass, count=40):
    return dict(
        ticks=240_000 // count,
        pull="1e-6 fN within 1um",
        within="1nm",
        scene=f"""tick 10 s  block cube {{ side 10um  mass {mass}ng  faces 1 }}  free {count} uniform
    enclosure hemisphere {{ radius 80um  wall 10 nN/m }}  gravity 9.81 m/s^2
    fluid {{ density 1000 kg/m^3  viscosity 1 mPa s }}  agitation brownian {{ temperature 293 K }}""",
    )


def tank(mass):
    return dict(
        ticks=4000,
        pull="1e-9 N within 1mm",
        within="1um",
        scene=f"""tick 20ms  block cube {{ side 2cm  mass {mass}g  faces 1 }}  free 60 uniform
    enclosure hemisphere {{ radius 60cm  wall 20 N/m }}  gravity 9.81 m/s^2
    fluid {{ density 1000 kg/m^3  viscosity 1 mPa s }}  agitation turbulence {{ speed 10 cm/s  length 16cm }}""",
    )


def kicks(gravity):
    return dict(
        ticks=3000,
        pull="1e-9 N within 1mm",
        within="1um",
        scene=f"""tick 20ms  block cube {{ side 20cm  mass 1kg  faces 1 }}  free 60 uniform
    enclosure hemisphere {{ radius 5m  wall 25 N/m }}  gravity {gravity} m/s^2
    drag {{ rate 1 Hz }}  agitation kicks {{ speed 0 .. 0.28 m/s }}""",
    )


SCENES = {
    "heat, m' = 41.2 fg": heat(1.0000412),
    "heat, m' = 41.2 fg, 4 blocks": heat(1.0000412, 4),
    "heat, m' = 82.4 fg": heat(1.0000824),
    "heat, m' = 82.4 fg, 4 blocks": heat(1.0000824, 4),
    "eddies, 0.25 % heavier": tank(8.02),
    "eddies, 1.8 % heavier": tank(8.144),
    "eddies, 6.2 % heavier": tank(8.5),
    "kicks, g = 0.3 m/s^2": kicks(0.3),
    "kicks, g = 1.5 m/s^2": kicks(1.5),
}


def stochc(*arguments):
    return subprocess.run([STOCHC, *map(str, arguments)], capture_output=True, text=True)


def heights(animation):
    """Returns the heights of all blocks in the last two thirds of a run [block lengths]."""
    data = Path(animation).read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document, numbers = json.loads(data[20 : 20 + length]), data[28 + length :]
    moves = document["animations"][0]
    for channel in moves["channels"]:
        if channel["target"]["path"] != "translation":
            continue
        accessor = document["accessors"][moves["samplers"][channel["sampler"]]["output"]]
        view = document["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        places = struct.unpack_from(f"<{3 * accessor['count']}f", numbers, start)
        # The z axis of a block points up. The root node of the document rotates it.
        yield from places[2::3][accessor["count"] // 3 :]


print("| scene | ⟨z⟩ / a, expected | measured | n(a)/n, expected | measured |\n|---|--:|--:|--:|--:|")
with tempfile.TemporaryDirectory() as folder:
    for name, given in SCENES.items():
        file, out = Path(folder, "s.sa"), Path(folder, "".join(filter(str.isalnum, name)))
        file.write_text(SCENE.format(**given))
        listed = json.loads(stochc("check", "--physics", "--json", file).stdout)
        groups = {it["symbol"]: it["value"] for it in listed["scenes"][0]["groups"]}
        stochc("simulate", file, "--runs", 1, "--max-ticks", given["ticks"], "--quiet", "--out", out)
        made = stochc("export", out, "--run", 0, "--format", "gltf", "--every", 50)
        found = list(heights(made.stdout.strip()))
        # The centre of a block that lies flat is half a block length above the floor.
        mean = sum(found) / len(found) - 0.5
        above = sum(z > 1.5 for z in found) / len(found)
        print(
            f"| {name} | {groups['⟨z⟩ / a']:.2f} | {mean:.2f} | {groups['n(a) / n']:.2f} | {above:.2f} |",
            flush=True,
        )
