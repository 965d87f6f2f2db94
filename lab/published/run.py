#!/usr/bin/env python3
"""Compares simulated blocks with published laws. No scene was fitted to these laws.

python3 lab/published/run.py [STOCHC [PART ...]]    needs only Python, takes some minutes

Writes the tables of docs/validation/published.md. ± is the 95 % confidence interval.
"""
import itertools
import json
import math
import random
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

STOCHC = sys.argv[1] if len(sys.argv) > 1 else "target/release/stochc"
BOLTZMANN = 1.380649e-23
"""Boltzmann's constant [J/K]."""

# The magnet is too weak to hold a block, so only the other terms of the scene move the blocks.
FREE = """scene s {{ {scene}
    bond attract {{ pull {pull} within {reach}  anchor centres {anchor} tilt 1e-3 deg }}
}}
assembly s in s {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A }} }}
"""


def stochc(*arguments):
    return subprocess.run([STOCHC, *map(str, arguments)], capture_output=True, text=True)


def simulate(text, folder, *options):
    Path(folder, "s.sa").write_text(text)
    options = ["--threads", 1, "--quiet", *options]
    made = stochc("simulate", Path(folder, "s.sa"), *options)
    if made.returncode not in (0, 3):
        sys.exit(made.stderr)
    return made.stdout


def trajectories(text, ticks, seed=1):
    """Returns positions [block lengths] and quaternions of every block at every tick of a run."""
    with tempfile.TemporaryDirectory() as folder:
        options = ["--runs", 1, "--seed", seed, "--max-ticks", ticks, "--record", "all"]
        simulate(text, folder, *options, "--record-every", 1, "--out", f"{folder}/out")
        file = f"{folder}/run.glb"
        stochc("export", f"{folder}/out", "--run", 0, "--format", "gltf", "--every", 1, "--out", file)
        data = Path(file).read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document, numbers = json.loads(data[20 : 20 + length]), data[28 + length :]
    moves = document["animations"][0]
    blocks = {}
    for channel in moves["channels"]:
        path, node = channel["target"]["path"], channel["target"]["node"]
        if path not in ("translation", "rotation"):
            continue
        accessor = document["accessors"][moves["samplers"][channel["sampler"]]["output"]]
        view = document["bufferViews"][accessor["bufferView"]]
        start, count = view.get("byteOffset", 0) + accessor.get("byteOffset", 0), accessor["count"]
        width = {"translation": 3, "rotation": 4}[path]
        if accessor["componentType"] == 5126:
            values = struct.unpack_from(f"<{width * count}f", numbers, start)
        else:
            values = [v / 32767 for v in struct.unpack_from(f"<{width * count}h", numbers, start)]
        series = [values[width * i : width * (i + 1)] for i in range(count)]
        blocks.setdefault(node, {})[path] = series
    whole = max(len(block["translation"]) for block in blocks.values())
    return [block for block in blocks.values() if len(block["translation"]) == whole]


def mean(values):
    return sum(values) / len(values)


def interval(values):
    """Returns the mean of independent values and half of its 95 % confidence interval."""
    middle = mean(values)
    spread = math.sqrt(sum((v - middle) ** 2 for v in values) / (len(values) - 1))
    return middle, 1.96 * spread / math.sqrt(len(values))


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


# --- eddies ---------------------------------------------------------------------------------------

SIDE, TICK = 0.02, 0.02
"""Side of a block [m], and tick [s]."""
EDDIES = [(5, None), (10, None), (8.8, 0.2)]
"""Size [cm] and correlation time [s] of the eddies. `None` is the default time."""


def eddy_scene(length, time, blocks=60, box=4):
    memory = f"  time {time} s" if time else ""
    return FREE.format(
        pull="1e-9 N",
        reach="1mm",
        anchor="1um",
        scene=f"""tick 20 ms  block cube {{ side 2 cm  mass 8 g  faces 1 }}  free {blocks} uniform
    enclosure box {{ length {box} m  width {box} m  height {box} m  wall 20 N/m }}
    fluid {{ density 1000 kg/m^3  viscosity 1 mPa s }}
    agitation turbulence {{ speed 10 cm/s  length {length} cm{memory} }}""",
    )


def velocities(blocks, skip=200):
    """Returns the velocities [m/s] of every block, without the start from rest."""
    for block in blocks:
        places = block["translation"][skip:]
        yield [[(q - p) * SIDE / TICK for p, q in zip(a, b)] for a, b in zip(places, places[1:])]


def kurtosis(values):
    second = mean([v * v for v in values])
    return mean([v**4 for v in values]) / second**2


def distance_to_maxwell(speeds, variance):
    """Returns the Kolmogorov distance of a sample of speeds to Maxwell's distribution."""
    speeds, largest = sorted(speeds), 0.0
    for i, speed in enumerate(speeds):
        x = speed / math.sqrt(2 * variance)
        expected = math.erf(x) - 2 / math.sqrt(math.pi) * x * math.exp(-x * x)
        largest = max(largest, abs((i + 0.5) / len(speeds) - expected))
    return largest


def pair_energy(length, time, distance=0.02, width=0.0025):
    """Returns the energy of the relative motion of two close blocks, divided by the energy of one block."""
    energies = []
    for seed in range(1, 5):
        blocks = trajectories(eddy_scene(length, time, blocks=200, box=1), 1500, seed)
        series, places = list(velocities(blocks)), [block["translation"][200:] for block in blocks]
        single, relative, pairs = 0, 0, 0
        for t in range(0, len(series[0]), 5):
            single += mean([dot(one[t], one[t]) for one in series])
            cells = {}
            for i, place in enumerate(places):
                cells.setdefault(tuple(int(x // 2) for x in place[t]), []).append(i)
            for i, place in enumerate(places):
                cell = [int(x // 2) for x in place[t]]
                for step in itertools.product((-1, 0, 1), repeat=3):
                    for j in cells.get(tuple(c + d for c, d in zip(cell, step)), ()):
                        if j > i and abs(math.dist(place[t], places[j][t]) * SIDE - distance) < width:
                            relative += math.dist(series[i][t], series[j][t]) ** 2
                            pairs += 1
        energies.append(relative / pairs / 2 / (single / len(range(0, len(series[0]), 5))))
    return interval(energies)


def eddies():
    ticks = 6000
    print("| eddies | v_x, v_y, v_z rms, cm/s | kurtosis | distance to Maxwell | T_L, s | D / (v² T_L) | D / Einstein | pair energy | of the fluid |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|--:|")
    for length, time in EDDIES:
        blocks = trajectories(eddy_scene(length, time), ticks)
        series = list(velocities(blocks))
        axes = [[v[k] for one in series for v in one[::5]] for k in range(3)]
        variances = [mean([v * v for v in axis]) for axis in axes]
        speeds = [math.sqrt(dot(v, v)) for one in series for v in one[::50]]
        lags = range(0, 400, 4)
        correlation = [
            mean([dot(one[t], one[t + lag]) for one in series for t in range(0, len(one) - lag, 20)])
            for lag in lags
        ]
        zero = next((i for i, c in enumerate(correlation) if c <= 0), len(correlation))
        memory = 4 * TICK * (sum(correlation[:zero]) / correlation[0] - 0.5)
        # Diffusivity from displacements over twenty memory times, one value per block.
        step = min(int(20 * memory / TICK), ticks // 4)
        spread = []
        for block in blocks:
            places = block["translation"][200:]
            moves = [
                [(q - p) * SIDE for p, q in zip(places[t], places[t + step])]
                for t in range(0, len(places) - step, step)
            ]
            spread.append(mean([dot(m, m) for m in moves]) / (6 * step * TICK))
        diffusivity, error = interval(spread)
        variance = mean(variances)
        # Drag is quadratic. Its coefficient at the speed v is the force ρ a² v² / 2, divided by v.
        rate = 1000 * SIDE**2 * math.sqrt(3 * variance) / 2 / 0.008
        einstein = variance / rate
        pair, spread_of_pairs = pair_energy(length, time)
        x = math.pi * SIDE / (length / 100)
        rms = ", ".join(f"{100 * math.sqrt(v):.2f}" for v in variances)
        shape = ", ".join(f"{kurtosis(axis):.2f}" for axis in axes)
        print(
            f"| {length} cm, {time or 'default'} s | {rms} | {shape} | {distance_to_maxwell(speeds, variance):.3f} | {memory:.2f} "
            f"| {diffusivity / (variance * memory):.2f} ± {error / (variance * memory):.2f} "
            f"| {diffusivity / einstein:.2f} ± {error / einstein:.2f} "
            f"| {pair:.3f} ± {spread_of_pairs:.3f} | {1 - math.sin(x) / x:.3f} |",
            flush=True,
        )


# --- heat -----------------------------------------------------------------------------------------

HEAT = FREE.format(
    pull="1e-6 fN",
    reach="1um",
    anchor="1nm",
    scene="""tick 10 s  block cube { side 10um  mass 1.05ng  faces 1 }  free 300 uniform
    enclosure box { length 600um  width 600um  height 600um  wall 10 nN/m }
    fluid { viscosity 1 mPa s }  agitation brownian { temperature 293 K }""",
)


def turned(q):
    """Returns the image of the x axis."""
    x, y, z, w = q
    size = x * x + y * y + z * z + w * w
    return [(w * w + x * x - y * y - z * z) / size, 2 * (x * y + w * z) / size, 2 * (x * z - w * y) / size]


def heat():
    ticks, step = 1200, 40
    blocks = trajectories(HEAT, ticks)
    energy, length, viscosity = BOLTZMANN * 293, 1e-5, 1e-3
    inside = [b for b in blocks if all(abs(p) < 22 for p in b["translation"][0][:2])]
    moved, turns = [], []
    for block in inside:
        places, frames = block["translation"], [turned(q) for q in block["rotation"]]
        moves = [[(q - p) * length for p, q in zip(places[t], places[t + step])] for t in range(0, ticks - step, step)]
        moved.append(mean([dot(m, m) for m in moves]) / (6 * step * 10))
        turns.append(mean([dot(frames[t], frames[t + step]) for t in range(0, ticks - step, step)]))
    found, error = interval(moved)
    print("\n| | simulated | cube, computed | ratio |\n|---|--:|--:|--:|")
    cube = energy / (6 * math.pi * viscosity * CUBE_RADIUS * length)
    print(f"| translation, um²/s | {found * 1e12:.4f} ± {error * 1e12:.4f} | {cube * 1e12:.4f} | {found / cube:.3f} ± {error / cube:.3f} |")
    middle, error = interval(turns)
    rate = -math.log(middle) / (2 * step * 10)
    error = error / middle / (2 * step * 10)
    cube = energy / (CUBE_TORQUE * viscosity * length**3)
    print(f"| rotation, 1e-4 rad²/s | {rate * 1e4:.3f} ± {error * 1e4:.3f} | {cube * 1e4:.3f} | {rate / cube:.3f} ± {error / cube:.3f} |", flush=True)


CUBE_RADIUS, CUBE_TORQUE = 0.675, 8.07
"""Stokes drag of a cube, from `cube_drag.py`: hydrodynamic radius and torque."""


def journal(text, *options):
    """Returns the records of an ensemble."""
    with tempfile.TemporaryDirectory() as folder:
        simulate(text, folder, *options, "--out", f"{folder}/out")
        lines = Path(folder, "out", "journal.jsonl").read_text().splitlines()
    return [it for it in map(json.loads, lines) if "record" in it]


# --- gas ------------------------------------------------------------------------------------------

def reach_area(reach, rng, samples=100_000):
    """Returns the mean area of the centres whose nearest face is at `reach` above a floor [a²]."""
    open_ = 0
    for _ in range(samples):
        q = [rng.gauss(0, 1) for _ in range(4)]
        size = math.sqrt(dot(q, q))
        x, y, z, w = (p / size for p in q)
        axes = [
            [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
            [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
        ]
        out = [rng.gauss(0, 1) for _ in range(3)]
        size = math.sqrt(dot(out, out))
        centre = [reach * p / size - 0.5 * a for p, a in zip(out, axes[2])]
        if centre[2] < 0.5 * sum(abs(a[2]) for a in axes):
            continue
        faces = (math.dist([c + s * 0.5 * a for c, a in zip(centre, axis)], [0, 0, 0]) for axis in axes for s in (1, -1))
        open_ += min(faces) > reach * (1 - 1e-9)
    return 6 * 4 * math.pi * reach**2 * open_ / samples


def gas():
    """Prints how often blocks enter the reach of a face, and the rate n v A / 4 of a dilute gas."""
    print("\n| reach / a | entries per face and 1000 ticks | n v A / 4 | with rotation | ratio |\n|--:|--:|--:|--:|--:|")
    rng, tick, side, radius, blocks, ticks, runs = random.Random(1), 0.02, 0.2, 5.0, 300, 4000, 10
    for reach in (0.1, 0.2):
        text = f"""scene s {{ tick 20ms  block cube {{ side 20cm  mass 1kg  faces 1 }}  free {blocks} uniform
    enclosure hemisphere {{ radius {radius} m  wall 250 N/m }}  agitation kicks {{ speed 0 .. 0.3 m/s }}
    drag {{ rate 1.3 Hz }}  contact {{ restitution 1  friction 0 }}
    bond attract {{ pull 1e-9 N within {reach} m  anchor centres 1nm tilt 1e-3 deg }} }}
assembly s in s {{
    seed plate 13 x 13 {{ for x in 0..2 {{ for y in 0..2 {{ M[x, y] at (6 * x, 6 * y) }} }} }}
    phase p {{ for x in 0..2 {{ for y in 0..2 {{ M[x, y].up -> A[x, y] }} }} }}
}}"""
        options = ["--runs", runs, "--max-ticks", ticks, "--seed", 3]
        records = [it["record"] for it in journal(text, *options)]
        counts = [mean([face["entries"] for face in record["waiting"]]) for record in records]
        middle, error = interval([1000 * count / ticks for count in counts])
        # Random impulses and drag balance: v² = j² e^(-2γτ) / (1 - e^(-2γτ)).
        kept = math.exp(-2 * 1.3 * tick)
        speed = math.sqrt(0.3**2 / 3 * kept / (1 - kept)) * math.sqrt(8 / (3 * math.pi))
        density = blocks / (2 / 3 * math.pi * radius**3)
        area = reach_area(reach / side, rng) * side**2
        expected = 1000 * density * speed * tick * area / 4
        # If rotation has as much energy as translation, the centre of a face is faster by sqrt(2).
        turning = math.sqrt(2) * expected
        ratio = f"{middle / turning:.2f} ± {error / turning:.2f}"
        print(f"| {reach / side} | {middle:.2f} ± {error:.2f} | {expected:.2f} | {turning:.2f} | {ratio} |", flush=True)


# --- diffusion to a face --------------------------------------------------------------------------

ENCOUNTER = """scene s {{ tick 10 s  block cube {{ side 10um  mass 1.05ng  faces 1 }}  free {free} uniform
    enclosure hemisphere {{ radius {radius}um  wall 10 nN/m }}
    fluid {{ viscosity 1 mPa s }}  agitation brownian {{ temperature 293 K }}  contact {{ restitution 0  friction 0 }}
    bond attract {{ pull 0.13 pN within {reach}um  align 0.03 pN within 20um  anchor centres 1um tilt 45 deg }} }}
assembly s in s {{ seed plate 1 x 1 {{ M at (0, 0) }}  phase p {{ M.up -> A }} }}
"""


def survival(inner, outer, diffusivity, places):
    """Returns the probability that no walker has been absorbed, as a function of time.

    Walkers start at the given distances between an absorbing and a reflecting sphere [um, um, um²/s, um].
    """
    width, modes = outer - inner, []
    for n in range(60):
        # tan(k w) = k b has one solution per branch of the tangent.
        low, high = (n * math.pi + 1e-9) / width, (n + 0.5) * math.pi / width
        for _ in range(100):
            k = (low + high) / 2
            low, high = (k, high) if math.tan(k * width) < k * outer else (low, k)
        norm = width / 2 - math.sin(2 * k * width) / (4 * k)
        overlap = inner / k + math.sin(k * width) / k**2 - outer * math.cos(k * width) / k
        modes.append((diffusivity * k * k, [overlap / norm * math.sin(k * (r - inner)) / r for r in places]))

    def value(time):
        left = [0.0] * len(places)
        for rate, shares in modes:
            factor = math.exp(-rate * time)
            left = [a + factor * b for a, b in zip(left, shares)]
        return math.prod(left)

    return value


def encounters():
    """Prints times of the first capture by diffusion, and those of diffusion to a sphere."""
    print("\n| radius of the tank, um | blocks | simulated, 1,000 s | expected, 1,000 s | ratio |\n|--:|--:|--:|--:|--:|")
    diffusivity = BOLTZMANN * 293 / (6 * math.pi * 1e-3 * CUBE_RADIUS * 1e-5) * 1e12
    rng, side, reach = random.Random(2), 10, 50
    # Mean distance of blocks with random orientations whose nearest face is within reach. They touch
    # the floor at a mean height of 0.6 a, so the centre of the face is outside of the space of their centres.
    directions = [[rng.gauss(0, 1) for _ in range(3)] for _ in range(100_000)]
    nearest = [max(map(abs, d)) / math.sqrt(dot(d, d)) for d in directions]
    inner = mean([side / 2 * c + math.sqrt(reach**2 - side**2 / 4 * (1 - c * c)) for c in nearest]) - 0.3 * side
    for radius, free, runs in ((300, 40, 400), (300, 10, 200), (400, 20, 100)):
        text = ENCOUNTER.format(free=free, radius=radius, reach=reach)
        records = [it["record"] for it in journal(text, "--runs", runs, "--seed", 7, "--substeps", 1)]
        bonds = [record["bonds"][0] for record in records]
        middle, error = interval([10 * (bond["docked"] - bond["magnetized"] - bond["docking"]) for bond in bonds])
        places = [side * math.dist(block["translation"][0], [0, 0, 0]) for block in trajectories(text, 1)]
        left = survival(inner, radius, diffusivity, places)
        expected, step = 0, middle / 500
        for i in range(10_000):
            expected += left((i + 0.5) * step) * step
        print(f"| {radius} | {free} | {middle / 1000:.1f} ± {error / 1000:.1f} | {expected / 1000:.1f} | {middle / expected:.3f} ± {error / expected:.3f} |", flush=True)


# --- planar self-assembly -------------------------------------------------------------------------

TABLE = """scene table {{
    tick 10 ms  block cube {{ side 3 cm  mass 20 g  faces 1 }}  free {free} uniform  world planar
    enclosure rectangle {{ length 150 cm  width 150 cm  wall 50 N/m }}
    agitation kicks {{ speed 0 .. 6 cm/s }}  drag {{ rate 2 Hz }}  contact {{ restitution 50%  friction 0.1 }}
    bond attract {{
        pull 0.05 N within 1.5 cm  align 2 mN within 1.5 cm  anchor centres 1 mm tilt 20 deg
    }}
}}
assembly a in table {{
    seed plate 50 x 50 {{ for i in {first}..{last} {{ M[i] at (6 * i - 3, 0) }} }}
    phase grow {{ for i in {first}..{last} {{ M[i].north -> A[i] }} }}
}}"""


def docked(free, first, last, runs):
    """Returns the times of the captures of each run [ticks], sorted."""
    records = journal(TABLE.format(free=free, first=first, last=last), "--runs", runs, "--seed", 5)
    return [sorted(bond["docked"] for bond in it["record"]["bonds"]) for it in records]


def reaction():
    """Prints captures in the plane, and the times of a second-order reaction with one constant."""
    print("\n| free blocks | mean wait of one face, ticks | CV | wait x blocks, thousands |\n|--:|--:|--:|--:|")
    constant = 0
    for free, runs in ((8, 200), (16, 100), (32, 100)):
        waits = [times[0] for times in docked(free, 4, 4, runs)]
        middle, error = interval(waits)
        spread = math.sqrt(mean([(w - middle) ** 2 for w in waits])) / middle
        print(f"| {free} | {middle:.0f} ± {error:.0f} | {spread:.2f} | {middle * free / 1000:.0f} ± {error * free / 1000:.0f} |", flush=True)
        if free == 16:
            constant = 1 / (middle * free)
    print("\n| capture | simulated, ticks | expected, ticks | ratio |\n|--:|--:|--:|--:|")
    runs, expected = docked(16, 1, 8, 40), 0
    for i in range(8):
        expected += 1 / (constant * (16 - i) * (8 - i))
        middle, error = interval([times[i] for times in runs])
        print(f"| {i + 1} | {middle:.0f} ± {error:.0f} | {expected:.0f} | {middle / expected:.2f} ± {error / expected:.2f} |", flush=True)


PARTS = {"eddies": eddies, "heat": heat, "gas": gas, "encounters": encounters, "reaction": reaction}
for name in sys.argv[2:] or PARTS:
    PARTS[name]()
