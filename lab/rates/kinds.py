#!/usr/bin/env python3
"""Compares the rate model with physics in eight scenes outside of the rate law: planar worlds, fluids, suction, magnets, gravity.

`kinds.py STOCHC FOLDER [RUNS [SCENE...]]` calibrates each scene, makes RUNS runs (200) of three programs with the model `rigid`,
and 2,000 runs with the model `rate`. It writes a table of docs/validation/rates.md. The scenes and programs were chosen before
the first measurement. Existing files of the folder are used again.
"""
import itertools
import json
import math
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SEED, RATE_SEED, RATE_RUNS, MAX_TICKS = 4400, 77, 2000, 1_000_000

# Name, file of the scene, replaced clauses, and text of a scene without a file.
SCENES = {
    "white_2004": ("examples/published/white_2004.sa", {}),
    "lily_2016": ("examples/published/lily_2016.sa", {}),
    "zykov_2007": ("examples/published/zykov_2007.sa", {}),
    "suction_growth": ("examples/suction_growth.sa", {}),
    "microns": ("examples/microns.sa", {}),
    "hageman_2018": ("examples/published/hageman_2018.sa", {"free 2 ring 5 cm": "free 8 uniform"}),
    "bowl": ("examples/lab/bowl.sa", {}),
    "gravity": (None, "scene heavy from hemisphere { gravity 0.2 m/s^2 }\n"),
}
SPACE = {
    "column": "seed plate 3 x 3 { M at (1, 1) }\n phase a { M.up ->> T[1..3] }",
    "bend": "seed plate 3 x 3 { M at (1, 1) }\n phase a { M.up ->> T[1..2] }\n phase b { T[2].east ->> E[1..2] }",
    "pair": "seed plate 4 x 1 { M at (0, 0) N at (3, 0) }\n phase a { M.up ->> T[1..2]\n N.up ->> U[1..2] }",
}
PLANE = {
    "line": "seed plate 9 x 9 { M at (4, 4) }\n phase a { M.north ->> A[1..4] }",
    "hook": "seed plate 9 x 9 { M at (4, 4) }\n phase a { M.north ->> A[1..2] }\n phase b { A[2].east ->> B[1..2] }",
    "both": "seed plate 9 x 9 { M at (4, 4) }\n phase a { M.east ->> A[1..2]\n M.west ->> B[1..2] }",
}


def scene(name):
    file, changes = SCENES[name]
    if file is None:
        return changes
    text = (ROOT / file).read_text()
    found = re.search(r"^scene .*?^}\n", text, re.M | re.S).group()
    for old, new in changes.items():
        assert old in found, old
        found = found.replace(old, new)
    return found


def program(name):
    text = scene(name)
    called = re.search(r"scene (\w+)", text).group(1)
    structures = PLANE if "world planar" in text else SPACE
    return text + "".join(f"assembly {it} in {called} {{ {body} }}\n" for it, body in structures.items())


def stochc(binary, *words):
    return subprocess.run([binary, *map(str, words)], capture_output=True, text=True)


def kept(path, make):
    if not path.exists():
        path.write_text(make())
    return json.loads(path.read_text())


def times(binary, file, runs, *options):
    done = stochc(binary, "simulate", file, "--runs", runs, "--max-ticks", MAX_TICKS, "--allow", "warnings", "--quiet", "--json", *options)
    if done.returncode not in (0, 3):
        raise SystemExit(done.stderr)
    return done.stdout


def row(binary, folder, runs, name):
    file, rates = folder / f"{name}.sa", folder / f"{name}.rates"
    file.write_text(program(name))
    if not rates.exists():
        stochc(binary, "calibrate", file, "--out", rates, "--quiet")
    if not rates.exists():
        return f"| `{name}` | no rates | | |"
    error = json.loads(rates.read_text())["held_out"]
    stated = f"{100 * error['error']:.1f} % ({100 * error['sampling']:.1f} %)"
    rated = stochc(binary, "estimate", file, "--rates", rates, "--runs", 2, "--quiet")
    if "held-out error" in rated.stderr:
        return f"| `{name}` | {stated} | refused | |"
    physics = kept(folder / f"{name}.rigid.json", lambda: times(binary, file, runs, "--seed", SEED))
    model = kept(
        folder / f"{name}.rate.json",
        lambda: times(binary, file, RATE_RUNS, "--seed", RATE_SEED, "--model", "rate", "--rates", rates),
    )
    cells, means = [], []
    for real, rated in zip(physics["programs"], model["programs"]):
        (a, b), half = (it["time"]["mean"] for it in (real, rated)), real["time"]["half_width"]
        if a is None or b is None:
            cells.append("not all runs complete")
            continue
        cells.append(f"{a:,.0f} ± {half:,.0f}, {b:,.0f} ({100 * (b / a - 1):+.1f} %)")
        means.append((a, half, b))
    pairs = [(x, y) for x, y in itertools.combinations(means, 2) if abs(x[0] - y[0]) > math.hypot(x[1], y[1])]
    right = sum((x[0] < y[0]) == (x[2] < y[2]) for x, y in pairs)
    return f"| `{name}` | {stated} | {'; '.join(cells)} | {right} of {len(pairs)} |"


def main():
    binary, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    runs = int(sys.argv[3]) if len(sys.argv) > 3 else 200
    folder.mkdir(parents=True, exist_ok=True)
    print("| scene | held-out error (sampling) | `rigid`, rate model (error) | pairs in correct order |\n|---|---|---|---|")
    for name in sys.argv[4:] or SCENES:
        print(row(binary, folder, runs, name), flush=True)


main()
