#!/usr/bin/env python3
"""Planned programs against four naive ones, simulated: the table of docs/planner.md.

run.py STOCHC FOLDER [--shapes a,b] [--runs N] [--max-ticks T] [--budget B] [--no-naive] [--threads N]

Each shape of shapes/ is planned and written in four ways that need no thought: one block after the other along a walk through the
shape (`chain`), everything at once (`at_once`), layer by layer (`layers`) and one block after the other, the nearest to the plate
first (`nearest`). What `check` rejects is not run. Runs that FOLDER has already are not made again.
"""
import argparse
import heapq
import json
import math
import pathlib
import subprocess
import time

HERE = pathlib.Path(__file__).resolve().parent
FACES = {"east": (1, 0, 0), "west": (-1, 0, 0), "north": (0, 1, 0), "south": (0, -1, 0), "up": (0, 0, 1)}
FACES["down"] = (0, 0, -1)
FREE = 300


def read(path):
    """The cells of a file of layers, as `stochc plan` reads them."""
    layers, rows = [], []
    for line in [*path.read_text().splitlines(), ""]:
        line = line.replace(" ", "")
        if line.startswith("//"):
            continue
        if line:
            rows.append(line)
        elif rows:
            layers.append(rows)
            rows = []
    return {
        (x, y, z + 1)
        for z, rows in enumerate(layers)
        for y, row in enumerate(reversed(rows))
        for x, sign in enumerate(row)
        if sign == "#"
    }


def neighbours(cell, cells):
    for face, step in FACES.items():
        near = tuple(a + b for a, b in zip(cell, step))
        if near in cells:
            yield face, near


def name(cell):
    x, y, z = cell
    return f"P[{x}, {y}]" if z == 0 else f"B[{x}, {y}, {z}]"


def grown(cells, key):
    """Each cell with its parent and the face: a tree from the plate, in which cells with a small key come first."""
    feet = [cell for cell in cells if cell[2] == 1]
    heap = [(key(foot, None), foot, (foot[0], foot[1], 0), "up") for foot in feet]
    heapq.heapify(heap)
    done = {}
    while heap:
        at, cell, parent, face = heapq.heappop(heap)
        if cell in done:
            continue
        done[cell] = (parent, face, at)
        for face, near in neighbours(cell, cells):
            if near not in done:
                heapq.heappush(heap, (key(near, at), near, cell, face))
    return done


def walk(cells):
    """The same, along a walk that goes on with a neighbour as long as there is one."""
    done = {}
    for foot in sorted(cell for cell in cells if cell[2] == 1):
        stack = [(foot, (foot[0], foot[1], 0), "up")]
        while stack:
            cell, parent, face = stack.pop()
            if cell in done:
                continue
            done[cell] = (parent, face, (len(done),))
            stack += [(near, cell, face) for face, near in neighbours(cell, cells) if near not in done]
    return done


def program(kind, shape, cells):
    """A naive program, as text."""
    steps = lambda cell, before: ((before[0] if before else 0) + 1,)
    highest = lambda cell, before: (max(cell[2], before[0] if before else 0),)
    tree = {"chain": lambda: walk(cells), "layers": lambda: grown(cells, highest)}.get(kind, lambda: grown(cells, steps))()
    order = list(tree)
    seeds = sorted({parent for parent, _, _ in tree.values() if parent[2] == 0})
    width, depth = (max(cell[axis] for cell in cells if cell[2] == 1) + 1 for axis in (0, 1))
    out = [scene(len(cells)), f"assembly {kind}_{shape} in here {{ seed plate {width} x {depth} {{"]
    out += [f"{name(seed)} at ({seed[0]}, {seed[1]})" for seed in seeds] + ["}"]
    phases = {}
    for i, cell in enumerate(order):
        parent, face, key = tree[cell]
        after = f" after {name(order[i - 1])}" if kind in ("chain", "nearest") and i else ""
        phases.setdefault(key[0] if kind == "layers" else 0, []).append(f"{name(parent)}.{face} -> {name(cell)}{after}")
    for number, statements in sorted(phases.items()):
        out += [f"phase stage_{number} {{", *statements, "}"]
    return "\n".join(out + ["}"]) + "\n"


def scene(count):
    """The default scene, with more blocks where it has too few."""
    return f"scene here from hemisphere {{ free {max(FREE, count)} uniform }}"


def simulate(arguments, program, folder):
    """Mean, half of its interval, the 90 % quantile and the runs that did not complete; or why there are none."""
    stochc = arguments.stochc
    checked = subprocess.run([stochc, "check", program, "--format", "short"], capture_output=True, text=True)
    if checked.returncode != 0:
        return "rejected"
    if not (folder / "manifest.json").exists():
        options = ["--runs", arguments.runs, "--seed", arguments.seed, "--max-ticks", arguments.max_ticks, "--out", folder]
        options += ["--model", "rigid", "--quiet"] + (["--threads", arguments.threads] if arguments.threads else [])
        subprocess.run([stochc, "simulate", program, *map(str, options)], capture_output=True, text=True)
    times, stuck = [], 0
    records = [json.loads(line) for line in (folder / "journal.jsonl").read_text().splitlines()]
    for record in (record.get("record", record) for record in records):
        if "ticks" not in record:
            continue
        if record["outcome"]["kind"] == "completed":
            times.append(record["ticks"])
        else:
            stuck += 1
    if not times:
        return f"{stuck} of {stuck} stuck"
    mean = sum(times) / len(times)
    deviation = math.sqrt(sum((t - mean) ** 2 for t in times) / max(len(times) - 1, 1))
    quantile = sorted(times)[max(math.ceil(0.9 * len(times)) - 1, 0)]
    told = f"{mean:.0f} ± {1.96 * deviation / math.sqrt(len(times)):.0f} ({quantile})"
    return told + (f", {stuck} of {stuck + len(times)} stuck" if stuck else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stochc")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--shapes", default="", help="names, separated by commas; all if left out")
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--max-ticks", type=int, default=60_000)
    parser.add_argument("--budget", default="", help="as `stochc plan --budget`")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--no-naive", action="store_true")
    arguments = parser.parse_args()
    wanted = [shape for shape in arguments.shapes.split(",") if shape]
    kinds = [] if arguments.no_naive else ["chain", "at_once", "layers", "nearest"]
    print("| shape | cells | planned in | estimate | planned | " + " | ".join(kinds) + (" |" if kinds else ""))
    print("|---|--:|--:|--:|--:|" + "--:|" * len(kinds), flush=True)
    for path in sorted((HERE / "shapes").glob("*.txt")):
        shape, cells = path.stem, read(path)
        if wanted and shape not in wanted:
            continue
        folder = arguments.folder / shape
        folder.mkdir(parents=True, exist_ok=True)
        target, planned = folder / "target.sa", folder / "planned.sa"
        # The scene has to have enough blocks: a target with its shape, in a scene of that.
        drawn = subprocess.run([arguments.stochc, "plan", path, "--quiet", "--budget", "1"], capture_output=True, text=True)
        took = ""
        if not planned.exists():
            if drawn.returncode == 0:
                command = [arguments.stochc, "plan", path]
            else:
                target.write_text(scene(len(cells)) + "\n" + shape_of(shape, cells))
                command = [arguments.stochc, "plan", target, "--scene", "here"]
            start = time.monotonic()
            options = ["--budget", arguments.budget] if arguments.budget else []
            subprocess.run([*command, *options, "--quiet", "--out", planned], check=True)
            took = f"{time.monotonic() - start:.1f} s"
        estimate = next(line for line in planned.read_text().splitlines() if "captures, up to" in line)
        estimate = estimate.split("about ")[1].split(" ticks")[0]
        row = [shape, len(cells), took, estimate, simulate(arguments, planned, folder / "planned")]
        for kind in kinds:
            naive = folder / f"{kind}.sa"
            naive.write_text(program(kind, shape, cells))
            row.append(simulate(arguments, naive, folder / kind))
        print("| " + " | ".join(map(str, row)) + " |", flush=True)


def shape_of(shape, cells):
    """The declaration of a shape."""
    (west, east), (south, north), (_, top) = ((min(c[i] for c in cells), max(c[i] for c in cells)) for i in range(3))
    out = [f"shape {shape} at ({west}, {south}) {{"]
    for z in range(1, top + 1):
        out.append(f"layer {z} {{")
        for y in range(north, south - 1, -1):
            out.append(" ".join("#" if (x, y, z) in cells else "." for x in range(west, east + 1)))
        out.append("}")
    return "\n".join(out + ["}"]) + "\n"


main()
