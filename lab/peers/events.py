#!/usr/bin/env python3
"""Measures the cost of an event in other stochastic simulators, next to a capture in the rate model. See README.md."""
import argparse
import importlib.metadata
import importlib.util
import os
import pathlib
import re
import statistics
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
TARGET = HERE.parent.parent / "target" / "peers"
EVENTS = 40_000  # in one round of one simulator
CUBES = 100  # in the row of VisibleSim

# Name, driver, and the arguments of the driver.
SIMULATORS = [
    ("`--model rate`, 16 distant towers", "captures", ["16", "6"]),
    ("`--model rate`, 256 distant towers", "captures", ["256", "6"]),
    ("`--model rate`, 10,000 distant towers", "captures", ["10000", "6"]),
    ("`--model rate`, 256 adjacent towers", "captures", ["256", "1"]),
    ("`--model rate`, 10,000 adjacent towers", "captures", ["10000", "1"]),
    ("rebop, 16 reactions, dense", "reactions", ["dense", "16"]),
    ("rebop, 16 reactions, sparse", "reactions", ["sparse", "16"]),
    ("rebop, 256 reactions, sparse", "reactions", ["sparse", "256"]),
    ("rgrow, 16 rows of tiles", "rgrow", ["16"]),
    ("rgrow, 256 rows of tiles", "rgrow", ["256"]),
    ("KaSim, 256 chains", "kappy", ["256"]),
    ("`--model shuffle`, captures, releases and hops of messages", "control", ["10000"]),
    ("VisibleSim, a message between neighbours", "visiblesim", []),
]


def say(text):
    print(text, file=sys.stderr, flush=True)


def build():
    """Builds the Rust drivers."""
    environment = os.environ | {"CARGO_TARGET_DIR": str(TARGET)}
    cargo = ["cargo", "build", "--release", "--locked", "--manifest-path", HERE.parent / "Cargo.toml"]
    for name, features in (("captures", ["--features", "own"]), ("reactions", ["--features", "reactions"]), ("control", [])):
        subprocess.run([*cargo, "--bin", name, *features], check=True, env=environment)


def visiblesim(source, rounds):
    """Builds the driver of VisibleSim. Returns its command. `source` is a built copy of its repository."""
    program, world = TARGET / "visiblesim", TARGET / "visiblesim.xml"
    row = f'<blocksLine plane="1" line="1" values="{"1" * CUBES}"/>'
    blocks = f'<blockList color="128,255,128" blockSize="10.0,10.0,10.0">{row}</blockList>'
    world.write_text(f'<?xml version="1.0"?><world gridSize="{CUBES},3,3" windowSize="800,600">{blocks}</world>')
    core = pathlib.Path(source) / "simulatorCore"
    options = ["-O2", "-DNDEBUG", "-std=c++17", "-w", "-DTINYXML_USE_STL", "-DTIXML_USE_STL", f"-I{core}/src", f"-L{core}/lib"]
    libraries = ["-lsimSlidingCubes", "-lmuparser", "-lglut", "-lGL", "-lGLEW", "-lGLU", "-lpthread", "-ldl"]
    subprocess.run(["g++", *options, HERE / "c" / "visiblesim.cpp", "-o", program, *libraries], check=True)
    return [program, str(EVENTS), str(rounds), "-f", "-t", "-c", world]


def times(driver, text):
    """Returns the times of an event [ns] in the output of a driver."""
    lines = text.splitlines()
    if driver == "control":
        # The last row of its table: towers are built and released.
        return [1e3 / float(lines[-1].split("|")[6])]
    # VisibleSim prints other lines as well.
    return [float(line) for line in lines if re.fullmatch(r"[\d.]+(e[+-]?\d+)?", line)]


def command(driver, words, rounds):
    """Returns the command of a simulator. Returns `None` if it is not installed."""
    numbers = [str(EVENTS), str(rounds)]
    if driver in ("captures", "reactions"):
        return [TARGET / "release" / driver, *words, *numbers]
    if driver == "control":
        return [TARGET / "release" / driver, *words]
    if driver == "visiblesim":
        source = os.environ.get("VISIBLESIM")
        if source is None:
            say("left out: the variable VISIBLESIM is not the path of a built copy of VisibleSim")
        return source and visiblesim(source, rounds)
    if importlib.util.find_spec(driver) is None:
        say(f"left out: {sys.executable} -m pip install {driver}")
        return None
    return [sys.executable, __file__, "--drive", driver, *words, *numbers]


def rgrow(rows, events, rounds):
    """Measures rows of tiles: each row grows by tiles that almost never detach."""
    from rgrow import Tile, TileSet

    rows = int(rows)
    height = max(64, 2 * rows + 8)
    length = 64 + (rounds + 1) * events // rows * 2
    tiles = TileSet(
        [Tile(["null", "g", "null", "g"], name="t")],
        model="kTAM",
        gse=20.0,
        gmc=10.0,
        threshold=1,
        seed=[(4 + 2 * row, 4, "t") for row in range(rows)],
        size=(height, length),
        canvas_type="square",
    )
    system = tiles.create_system()
    state = tiles.create_state(system)
    for number in range(rounds + 1):
        before, begin = state.total_events, time.process_time()
        system.evolve(state, for_events=events, require_strong_bound=False)
        if number > 0:
            print((time.process_time() - begin) * 1e9 / (state.total_events - before))


def kappy(chains, events, rounds):
    """Measures chains of agents: other agents bind to their free ends."""
    import kappy as kappa

    free = 4 * (rounds + 1) * events
    kasim = kappa.KappaStd()
    kasim.add_model_string(f"""
%agent: B(d,u,c{{f s}})
'capture' B(u[.],c{{s}}), B(d[.],c{{f}}) -> B(u[1],c{{s}}), B(d[1],c{{s}}) @ 0.000001
%init: {chains} B(c{{s}})
%init: {free} B(c{{f}})
""")
    kasim.project_parse()
    kasim.simulation_start(kappa.SimulationParameter(pause_condition=f"[E] > {events}", plot_period=1e9))
    kasim.wait_for_simulation_stop()
    used = children()
    for number in range(rounds):
        kasim.simulation_continue(f"[E] > {(number + 2) * events}")
        kasim.wait_for_simulation_stop()
        before, used = used, children()
        print((used - before) * 1e9 / events)


def descendants(process):
    """Returns the child processes of a process and all their descendants."""
    for thread in pathlib.Path(f"/proc/{process}/task").iterdir():
        for child in (thread / "children").read_text().split():
            yield child
            yield from descendants(child)


def children():
    """Returns the CPU time of the child processes [s]."""
    total = 0
    for process in descendants(os.getpid()):
        fields = pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
        total += int(fields[11]) + int(fields[12])
    return total / os.sysconf("SC_CLK_TCK")


def versions():
    lock = (HERE.parent / "Cargo.lock").read_text()
    found = ["rebop " + re.search(r'name = "rebop"\nversion = "(.*)"', lock)[1]]
    for name in ("rgrow", "kappy"):
        if importlib.util.find_spec(name):
            found.append(f"{name} {importlib.metadata.version(name)}")
    return ", ".join(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--drive", nargs="+", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.drive:
        driver, *words, events, rounds = chosen.drive
        {"rgrow": rgrow, "kappy": kappy}[driver](*words, int(events), int(rounds))
        return
    build()
    rows = []
    for name, driver, words in SIMULATORS:
        if start := command(driver, words, chosen.rounds):
            say(name)
            said = subprocess.run(start, check=True, capture_output=True, text=True).stdout
            rows.append((name, statistics.median(times(driver, said))))
    reference = next(time for name, time in rows if name == "rebop, 16 reactions, dense")
    print("| simulator | ns an event | over rebop's 16 dense reactions |\n|---|--:|--:|")
    for name, nanoseconds in rows:
        print(f"| {name} | {nanoseconds:.0f} | {nanoseconds / reference:.2f} |")
    print(f"\n{versions()}")


if __name__ == "__main__":
    main()
