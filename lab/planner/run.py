#!/usr/bin/env python3
"""Compares simulated planned programs with four naive ones, for docs/validation/planner.md.

run.py STOCHC FOLDER [--targets FOLDER] [--shapes a,b] [--race N] [--runs N] [--naive-runs N] [--max-ticks T] [--time T] [--threads N] [--minutes M]

Each shape of shapes/, or of `--targets`, is planned. Four naive programs are written in addition: one block after the other
along a walk through the shape (`chain`), everything at once (`at_once`), layer by layer (`layers`), and one block after the
other, the nearest to the plate first (`nearest`). Programs that `check` rejects are not run. Each round doubles the number of
runs, first of all planned programs and then of all others. It ends at the requested number or after the minutes. A naive
program gets no more runs once its mean is significantly longer than the planned one. The same command resumes an interrupted
study: FOLDER contains programs and runs. Each shape is planned again, and runs of a changed program are deleted.
"""
import argparse
import heapq
import json
import math
import pathlib
import shutil
import subprocess
import time

HERE = pathlib.Path(__file__).resolve().parent
FACES = {"east": (1, 0, 0), "west": (-1, 0, 0), "north": (0, 1, 0), "south": (0, -1, 0), "up": (0, 0, 1)}
FACES["down"] = (0, 0, -1)
FREE = 300  # of the default scene


def read(path):
    """Returns the cells of a file of layers, as `stochc plan` reads them."""
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
    """Returns each cell with its parent and face, as a tree from the plate. Cells with a small key come first."""
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
    """Returns such a tree along a walk. The walk continues to a neighbour as long as one is left."""
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
    """Returns the text of a naive program."""
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
    """Returns the default scene with at least twice as many blocks as needed."""
    return f"scene here from hemisphere {{ free {max(FREE, 2 * count)} uniform }}"


def simulate(arguments, program, folder, runs):
    """Makes runs up to the given number. Returns completed times and other times, or None if `check` rejects the program."""
    checked = program.with_suffix(".checked")
    if not checked.exists():
        check = subprocess.run([arguments.stochc, "check", program, "--format", "short"], capture_output=True, text=True)
        checked.write_text(str(check.returncode))
    if checked.read_text() != "0":
        return None
    found = runs_of(folder)
    if sum(map(len, found)) < runs and not arguments.is_over():
        line = ["simulate", program, "--seed", arguments.seed, "--max-ticks", arguments.max_ticks, "--model", "rigid", "--out", folder]
        line = ["resume", folder] if (folder / "manifest.json").exists() else line
        line += ["--runs", runs, "--quiet"] + (["--threads", arguments.threads] if arguments.threads else [])
        subprocess.run([arguments.stochc, *map(str, line)], capture_output=True, text=True)
        found = runs_of(folder)
    return found


def runs_of(folder):
    """Returns the times of completed runs, and the times of the other runs."""
    times, stuck = [], []
    journal = folder / "journal.jsonl"
    for line in journal.read_text().splitlines() if journal.exists() else []:
        record = json.loads(line)
        record = record.get("record", record)
        if "ticks" in record:
            (times if record["outcome"]["kind"] == "completed" else stuck).append(record["ticks"])
    return times, stuck


def moments(found):
    """Returns the mean of min(time, end), and the half-width of its 95 % interval."""
    times = found[0] + found[1]
    mean = sum(times) / len(times)
    deviation = math.sqrt(sum((t - mean) ** 2 for t in times) / max(len(times) - 1, 1))
    return mean, 1.96 * deviation / math.sqrt(len(times))


def quantile(found):
    """Returns the 90 % quantile of the times, and the half-width of its interval by order statistics."""
    times = sorted(found[0] + found[1])
    at = lambda place: times[min(max(math.ceil(place) - 1, 0), len(times) - 1)]
    spread = 1.96 * math.sqrt(0.09 * len(times))
    return at(0.9 * len(times)), (at(0.9 * len(times) + spread) - at(0.9 * len(times) - spread)) / 2


def told(found):
    """Returns a cell of the table as text."""
    if found is None:
        return "rejected"
    if not found[0]:
        return f"{len(found[1])} of {len(found[1])} stuck" if found[1] else ""
    mean, half = moments(found)
    count = len(found[0]) + len(found[1])
    stuck = f", {len(found[1])} stuck" if found[1] else ""
    return f"{mean:.0f} ± {half:.0f} ({quantile(found)[0]}; {count}{stuck})"


def is_beyond_doubt(found, other):
    """Returns whether a mean is significantly longer than another."""
    if found is None or other is None or min(len(found[0] + found[1]), len(other[0] + other[1])) < 4:
        return False
    (mean, half), (least, margin) = moments(found), moments(other)
    return mean - least > 2 * math.hypot(half, margin)


def keep(program, text):
    """Writes a program to a file. If it differs from the earlier one, deletes the runs of the earlier one."""
    if program.exists() and program.read_text() == text:
        return
    program.with_suffix(".checked").unlink(missing_ok=True)
    if program.with_suffix("").exists():
        shutil.rmtree(program.with_suffix(""))
    program.write_text(text)


def planned(arguments, path, folder):
    """Plans a program for a shape and returns it."""
    shape, cells, program = path.stem, read(path), folder / "planned.sa"
    command = [arguments.stochc, "plan", path]
    if 2 * len(cells) > FREE:
        # The scene needs enough blocks: the target contains the shape and a scene with enough blocks.
        target = folder / "target.sa"
        target.write_text(scene(len(cells)) + "\n" + shape_of(shape, cells))
        rates = folder / "here.rates"
        if not rates.exists():
            (folder / "scene.sa").write_text(scene(len(cells)) + "\nassembly probe in here { seed plate 1 x 1 { P at (0, 0) } phase grow { P.up -> A } }\n")
            subprocess.run([arguments.stochc, "calibrate", folder / "scene.sa", "--quiet", "--out", rates], check=True, stdout=subprocess.DEVNULL)
        command = [arguments.stochc, "plan", target, "--scene", "here", "--rates", rates]
    options = ["--time", arguments.time] if arguments.time else []
    options += ["--race", str(arguments.race)] if arguments.race else []
    start = time.monotonic()
    text = subprocess.run([*command, *options, "--quiet"], check=True, capture_output=True, text=True).stdout
    (folder / "planned.seconds").write_text(f"{time.monotonic() - start:.1f}")
    keep(program, text)
    return program


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stochc")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--shapes", default="", help="names, separated by commas; all if left out")
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--naive-runs", type=int, default=100, help="0: no naive plans")
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--max-ticks", type=int, default=60_000)
    parser.add_argument("--time", default="", help="as `stochc plan --time`")
    parser.add_argument("--race", type=int, default=0, help="as `stochc plan --race`")
    parser.add_argument("--targets", type=pathlib.Path, default=HERE / "shapes", help="folder of the shapes")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=math.inf, help="no runs are begun after so many")
    arguments = parser.parse_args()
    begin = time.monotonic()
    arguments.is_over = lambda: time.monotonic() - begin > 60 * arguments.minutes
    wanted = [shape for shape in arguments.shapes.split(",") if shape]
    kinds = ["chain", "at_once", "layers", "nearest"] if arguments.naive_runs else []
    paths = [path for path in sorted(arguments.targets.glob("*.txt")) if not wanted or path.stem in wanted]
    programs = {}
    for path in paths:
        shape, cells = path.stem, read(path)
        folder = arguments.folder / shape
        folder.mkdir(parents=True, exist_ok=True)
        programs[shape] = {"planned": planned(arguments, path, folder)}
        for kind in kinds:
            naive = folder / f"{kind}.sa"
            keep(naive, program(kind, shape, cells))
            programs[shape][kind] = naive
    results, runs = {}, 4
    while True:
        for kind in ("planned", *kinds):
            for shape, of in programs.items():
                most = arguments.runs if kind == "planned" else arguments.naive_runs
                known = results.get((shape, kind))
                if kind != "planned" and is_beyond_doubt(known, results.get((shape, "planned"))):
                    continue
                results[shape, kind] = simulate(arguments, of[kind], arguments.folder / shape / kind, min(runs, most))
        if runs >= max(arguments.runs, arguments.naive_runs) or arguments.is_over():
            break
        runs *= 2
    table(arguments, paths, programs, results, kinds)


def table(arguments, paths, programs, results, kinds):
    """Prints the results."""
    print("| shape | cells | planned in | predicted | planned | " + "".join(f"{kind} | " for kind in kinds))
    print("|---|--:|--:|--:|--:|" + "--:|" * len(kinds))
    errors, slower, stuck, runs = [], [], 0, 0
    for path in paths:
        shape = path.stem
        text = next(line for line in programs[shape]["planned"].read_text().splitlines() if "captures, up to" in line)
        predicted = float(text.split("about ")[1].split(" ticks")[0])
        took = arguments.folder / shape / "planned.seconds"
        found = {kind: results.get((shape, kind)) for kind in ("planned", *kinds)}
        row = [shape, len(read(path)), f"{took.read_text()} s" if took.exists() else "", f"{predicted:.0f}"]
        print("| " + " | ".join(map(str, row + [told(found[kind]) for kind in found])) + " |")
        own = found["planned"]
        if not own or not own[0]:
            continue
        stuck, runs = stuck + len(own[1]), runs + len(own[0]) + len(own[1])
        errors.append((predicted / moments(own)[0] - 1, shape))
        for kind in kinds:
            for what, of in (("mean", moments), ("90 % quantile", quantile)):
                if found[kind] and found[kind][0]:
                    (mine, my_half), (other, half) = of(own), of(found[kind])
                    if mine - other > math.hypot(my_half, half):
                        slower.append(f"{shape} than {kind} in the {what}")
    print(f"\n- planned runs that did not complete: {stuck} of {runs}")
    if errors:
        worst = max(errors, key=lambda error: abs(error[0]))
        mean = sum(abs(error) for error, _ in errors) / len(errors)
        print(f"- predicted means: off by {100 * mean:.1f} % on average, {100 * worst[0]:+.1f} % at worst ({worst[1]})")
    print("- significantly slower: " + (", ".join(slower) or "none"))


def shape_of(shape, cells):
    """Returns the declaration of a shape."""
    (west, east), (south, north), (_, top) = ((min(c[i] for c in cells), max(c[i] for c in cells)) for i in range(3))
    out = [f"shape {shape} at ({west}, {south}) {{"]
    for z in range(1, top + 1):
        out.append(f"layer {z} {{")
        for y in range(north, south - 1, -1):
            out.append(" ".join("#" if (x, y, z) in cells else "." for x in range(west, east + 1)))
        out.append("}")
    return "\n".join(out + ["}"]) + "\n"


main()
