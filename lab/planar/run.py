#!/usr/bin/env python3
"""Compares the CPU time of a planar world with those of the same gas in a flat box and in a cube.

python3 lab/planar/run.py STOCHC

The three scenes differ only in the world. Magnets are so weak that no block docks. Prints a table of docs/validation/performance.md.
"""
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

ROUNDS, BLOCK_STEPS = 5, 800_000

PROGRAM = """
scene gas {{
    tick 10 ms
    block cube {{ side 3 cm  mass 20 g  faces 2 }}
    free {blocks} uniform
    {world} wall 50 N/m }}
    agitation kicks {{ speed 0 .. 3 cm/s }}
    drag {{ rate 0.5 Hz }}
    contact {{ restitution 50%  friction 0.1 }}
    bond attract {{
        pull 0.000001 mN within 3 cm
        align 0.0000001 mN within 1.5 cm
        anchor centres 0.001 mm tilt 1 deg
    }}
}}
assembly pair in gas {{
    seed plate 3 x 1 {{ M at (1, 0) }}
    phase grow {{ M.{face} ->> A[1..2] }}
}}
"""
# Lengths of the side of the plane and of the cube [cm].
SIDES = {40: (60, 24), 400: (190, 52)}


def worlds(blocks):
    """Returns the name, the clauses and the open face of each world."""
    flat, cubic = SIDES[blocks]
    yield "`world planar`", f"world planar\n    enclosure rectangle {{ length {flat} cm  width {flat} cm ", "north"
    yield "box of 7 cm height", f"enclosure box {{ length {flat} cm  width {flat} cm  height 7 cm ", "up"
    yield "cube", f"enclosure box {{ length {cubic} cm  width {cubic} cm  height {cubic} cm ", "up"


def cpu_time(program, ticks):
    """Returns the CPU time of a run [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    command = [sys.argv[1], "simulate", program, "--runs", "1", "--threads", "1", "--max-ticks", str(ticks), "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 3:
        sys.exit(f"the run was not stopped: {done.stderr}")
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def main():
    with tempfile.TemporaryDirectory() as folder:
        times = {}
        for blocks in SIDES:
            for number, (name, world, face) in enumerate(worlds(blocks)):
                program = pathlib.Path(folder) / f"{blocks}_{number}.sa"
                program.write_text(PROGRAM.format(blocks=blocks, world=world, face=face))
                times[blocks, name] = (program, [])
        for _ in range(ROUNDS):
            for (blocks, _), (program, measured) in times.items():
                ticks = BLOCK_STEPS // blocks
                measured.append((cpu_time(program, ticks) - cpu_time(program, 1)) / (ticks * blocks) * 1e9)
    print("| free blocks | world | time per block and tick [ns] |\n|--:|---|--:|")
    for (blocks, name), (_, measured) in times.items():
        print(f"| {blocks} | {name} | {statistics.median(measured):.0f} |")


main()
