#!/usr/bin/env python3
"""Measures the cost of a step per block in general rigid-body engines. See README.md."""
import argparse
import importlib.util
import math
import os
import pathlib
import re
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
TARGET = HERE.parent.parent / "target" / "peers"

# Name, driver, and the driver's name for the engine. The other engines are compared with the first.
ENGINES = [
    ("`--model rigid`", "own", "rigid-world"),
    ("`--model rigid`, double precision", "own", "rigid-world-double"),
    ("`--model rapier`", "own", "rapier-world"),
    ("Rapier, as `--model rapier` sets it up", "own", "as-the-project"),
    ("Rapier, its defaults", "plain", "defaults"),
    ("ODE, `worldstep`, sweep and prune", "ode", "worldstep"),
    ("ODE, `quickstep`, hash space", "ode", "quickstep"),
    ("Bullet, sequential impulses", "bullet", "impulses"),
    ("MuJoCo, Newton", "mujoco", "newton"),
]

# Largest random impulse of the first engine [block lengths / tick]. Blocks move 0.05 block lengths per step.
KICK = 0.0128
DRAG = 0.01  # [1 / tick]
WARM_UP = 300  # ticks; the memory of speeds is 100 ticks
BLOCK_STEPS = 600_000  # in one round of one engine
CALIBRATION = 6000  # ticks, at 300 blocks
AGREEMENT = 0.03  # relative deviation of rms speeds from the first engine
NEAR = 0.9  # block lengths; cubes with centres closer than 1 overlap in every orientation


def say(text):
    print(text, file=sys.stderr, flush=True)


def build():
    """Builds the installed engines. Returns the commands of their programs."""
    TARGET.mkdir(parents=True, exist_ok=True)
    environment = os.environ | {"CARGO_TARGET_DIR": str(TARGET)}
    cargo = ["cargo", "build", "--release", "--locked", "--manifest-path", HERE.parent / "Cargo.toml"]
    for more in (["--bin", "plain"], ["--bin", "own", "--features", "own"]):
        subprocess.run(cargo + more, check=True, env=environment)
    programs = {name: TARGET / "release" / name for name in ("plain", "own")}
    compilers = {".c": ["cc", "-std=c17"], ".cpp": ["c++", "-std=c++17"]}

    def c(file, *libraries):
        source = HERE / "c" / file
        program = TARGET / source.stem
        compiler = [*compilers[source.suffix], "-O3", "-Wall", "-Wextra"]
        subprocess.run([*compiler, source, "-o", program, *libraries, "-lm"], check=True)
        programs[source.stem] = program

    if pathlib.Path("/usr/include/ode/ode.h").exists():
        c("ode.c", "-lode")
    else:
        say("left out: ODE is not installed (apt-get install libode-dev)")
    if pathlib.Path("/usr/include/bullet").exists():
        c("bullet.cpp", "-isystem", "/usr/include/bullet", "-lBulletDynamics", "-lBulletCollision", "-lLinearMath")
    else:
        say("left out: Bullet is not installed (apt-get install libbullet-dev)")
    if found := importlib.util.find_spec("mujoco"):
        # The Python package contains the library and its headers. Python itself does not run.
        place = pathlib.Path(found.origin).parent
        library = next(place.glob("libmujoco.so*"))
        c("mujoco.c", f"-I{place / 'include'}", library, f"-Wl,-rpath,{place}")
    else:
        say(f"left out: MuJoCo is not installed ({sys.executable} -m pip install mujoco)")
    return programs


class Driver:
    """Process of one engine with one scene, which waits for commands."""

    def __init__(self, program, engine, blocks, kick):
        command = [program, engine, str(blocks), repr(kick)]
        pipe = subprocess.PIPE
        self.blocks, self.kick = blocks, kick
        self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True)
        _, start, kicks, self.version = self.line().split(maxsplit=3)
        self.start, self.kicks = float(start), float(kicks)

    def line(self):
        line = self.process.stdout.readline()
        if not line:
            sys.exit(f"{self.process.args[:3]} ended early")
        return line

    def order(self, text):
        self.process.stdin.write(text + "\n")
        self.process.stdin.flush()

    def run(self, ticks):
        """Returns ns per block and step, mean square speed, contact points per block, and number of complaints."""
        self.order(f"run {ticks}")
        time, square, contacts, complaints = map(float, self.line().split())
        return time / ticks / self.blocks, square, contacts, complaints

    def state(self):
        self.order("state")
        return [tuple(map(float, self.line().split())) for _ in range(self.blocks)]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def radius(blocks):
    return 25.0 * (blocks / 300) ** (1 / 3)


def rms_without_collisions(kick):
    """Returns the rms speed for v' = (v + kick) exp(-drag). The mean square of a random impulse is kick^2 / 3."""
    keep = math.exp(-2 * DRAG)
    return math.sqrt(kick**2 / 3 * keep / (1 - keep))


def overlaps(state):
    """Counts pairs of blocks that overlap deeply."""
    cells, pairs = {}, 0
    for x, y, z, *_ in state:
        i, j, k = math.floor(x), math.floor(y), math.floor(z)
        for near in ((a, b, c) for a in (i - 1, i, i + 1) for b in (j - 1, j, j + 1) for c in (k - 1, k, k + 1)):
            for p in cells.get(near, ()):
                pairs += (x - p[0]) ** 2 + (y - p[1]) ** 2 + (z - p[2]) ** 2 < NEAR**2
        cells.setdefault((i, j, k), []).append((x, y, z))
    return pairs


def lowest_corner(state):
    def corner(x, y, z, u, v, w, a, b, c, d):
        up = abs(2 * (a * c - b * d)) + abs(2 * (b * c + a * d)) + abs(1 - 2 * (a * a + b * b))
        return z - up / 2

    return min(corner(*block) for block in state)


def same_start(drivers):
    """Exits if drivers differ in their initial states or in their random impulses."""
    for what, tolerance in (("start", 1e-5), ("kicks", 1e-5)):
        values = [getattr(driver, what) for driver in drivers]
        values = [value for value in values if not math.isnan(value)]
        if any(abs(value - values[0]) > tolerance * max(1, abs(values[0])) for value in values):
            sys.exit(f"the drivers differ in their {what}: {values}")


def calibrate(engines, programs, most):
    """Returns the largest random impulse of each engine that gives equal rms speeds at 300 blocks. Scales only once."""
    speeds = []
    for name, program, engine in engines:
        driver = Driver(programs[program], engine, 300, most)
        driver.run(WARM_UP)
        speeds.append(math.sqrt(driver.run(CALIBRATION)[1]))
        driver.close()
        say(f"{name}: rms speed {speeds[-1]:.4f} with kicks up to {most}")
    return [most * speeds[0] / speed for speed in speeds]


def measure(engines, programs, kicks, blocks, rounds):
    """Returns the results of `run` in each round and the deep overlaps of each engine. Also returns all errors."""
    drivers = []
    for (name, program, engine), kick in zip(engines, kicks):
        say(f"{blocks} blocks, setting up: {name}")
        drivers.append(Driver(programs[program], engine, blocks, kick))
    same_start(drivers)
    for (name, *_), driver in zip(engines, drivers):
        say(f"{blocks} blocks, warming up: {name}")
        driver.run(WARM_UP)
    rows = [[] for _ in drivers]
    deep = [0] * len(drivers)
    lowest = [math.inf] * len(drivers)
    wrong = []
    for number in range(rounds):
        say(f"{blocks} blocks, round {number + 1} of {rounds}")
        for i, driver in enumerate(drivers):
            rows[i].append(driver.run(max(1, BLOCK_STEPS // blocks)))
            state = driver.state()
            deep[i] += overlaps(state)
            lowest[i] = min(lowest[i], lowest_corner(state))
            name = engines[i][0]
            if not max(math.hypot(*block[:3]) for block in state) < radius(blocks) + 12:
                wrong.append(f"{name}, {blocks} blocks: a block has escaped")
            if not min(block[2] for block in state) > 0:
                wrong.append(f"{name}, {blocks} blocks: a centre is below the floor")
    for driver in drivers:
        driver.close()
    return rows, [count / rounds for count in deep], lowest, wrong


def rms(rows):
    return math.sqrt(statistics.fmean(row[1] for row in rows))


def versions(programs, drivers):
    lock = (HERE.parent / "Cargo.lock").read_text()
    rapier = re.search(r'name = "rapier3d"\nversion = "(.*)"', lock)[1]
    rust = subprocess.run(["rustc", "--version"], capture_output=True, text=True).stdout.split()[1]
    c = subprocess.run(["cc", "-dumpfullversion"], capture_output=True, text=True).stdout.strip()
    return ", ".join([f"Rapier {rapier}", *drivers, f"rustc {rust}", f"cc {c}"])


def table(engines, sizes, kicks, results, caption):
    """Prints the table of all engines. Returns the errors."""
    wrong = [text for result in results for text in result[3]]
    heads = [f"{blocks:,}" for blocks in sizes]
    of_sizes = " / ".join(heads)
    print(
        f"\n| engine and setting | {' | '.join(heads)} | ratio to the first | kick | rms speed"
        " | contact points per block | deep overlaps | errors per million |"
    )
    print("|---" + "|---:" * len(sizes) + "|---" * 6 + "|")
    for i, ((name, *_), kick) in enumerate(zip(engines, kicks)):
        times, ratios, speeds, points, deep, complaints = [], [], [], [], [], []
        for blocks, (rows, pairs, _, _) in zip(sizes, results):
            mine, first = rows[i], rows[0]
            times.append(f"{statistics.median(row[0] for row in mine):.0f}")
            ratio = statistics.median(a[0] / b[0] for a, b in zip(mine, first))
            ratios.append(f"{ratio:.2f}")
            speed = rms(mine)
            speeds.append(f"{speed:.4f}")
            contacts = statistics.fmean(row[2] for row in mine)
            points.append("-" if math.isnan(contacts) else f"{contacts:.3f}")
            ideal = blocks**2 * NEAR**3 / radius(blocks) ** 3
            deep.append(f"{100 * pairs[i] / ideal:.0f} %")
            steps = len(mine) * max(1, BLOCK_STEPS // blocks) * blocks
            complaints.append(f"{1e6 * sum(row[3] for row in mine) / steps:.1f}")
            if not abs(speed / rms(first) - 1) < AGREEMENT:
                wrong.append(f"{name}, {blocks} blocks: rms speed is not the first engine's")
            if not speed < 0.97 * rms_without_collisions(kick):
                wrong.append(f"{name}, {blocks} blocks: as fast as without collisions")
            if not pairs[i] < 0.5 * ideal + 3:
                wrong.append(f"{name}, {blocks} blocks: overlaps as if there were no contacts")
        cells = [name, *times, *map(" / ".join, (ratios,)), f"{kick:.4f}"]
        cells += map(" / ".join, (speeds, points, deep, complaints))
        print(f"| {' | '.join(cells)} |")
    lowest = min(min(result[2]) for result in results)
    print(
        f"\nns of thread CPU time per block-step at {of_sizes} blocks, {caption}. Without collisions,"
        f" kicks of {kicks[0]:.4f} give an rms speed of {rms_without_collisions(kicks[0]):.4f} sides a tick."
        f" The lowest corner seen was at z = {lowest:.2f}."
    )
    return wrong


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--rounds", type=int, default=5)
    options.add_argument("--sizes", default="300,3000,30000", help="numbers of blocks")
    options.add_argument(
        "--kick", type=float, default=KICK, help="greatest change of speed [side / tick]"
    )
    options.add_argument("--core", type=int, help="default: the last one")
    options = options.parse_args()
    sizes = [int(word) for word in options.sizes.split(",")]
    programs = build()
    engines = [engine for engine in ENGINES if engine[1] in programs]
    # The drivers inherit the pinned core.
    core = max(os.sched_getaffinity(0)) if options.core is None else options.core
    os.sched_setaffinity(0, {core})
    told = []
    for program, engine in (("ode", "worldstep"), ("bullet", "impulses"), ("mujoco", "newton")):
        if program in programs:
            driver = Driver(programs[program], engine, 300, KICK)
            told.append(driver.version.strip())
            driver.close()
    kicks = calibrate(engines, programs, options.kick)
    results = [measure(engines, programs, kicks, blocks, options.rounds) for blocks in sizes]
    caption = f"medians of {options.rounds} interleaved rounds on one core; {versions(programs, told)}"
    wrong = table(engines, sizes, kicks, results, caption)
    for text in wrong:
        print(f"\n**Wrong**: {text}.")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
