#!/usr/bin/env python3
"""Compares Storm's probabilities for chains of `stochc compile --emit jani` with an integral.

Usage: storm.py STOCHC (needs stormpy and numpy). Prints a table, and exits with status 1 if a
difference exceeds 1e-6.

The integral does not use the chain. A face that has been open for s ticks captures at the rate
k G(s/d), where k and d are read from the chain. The density of a sum of such waiting times is
computed by convolution on two grids, and extrapolated to the limit of a fine grid.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy
import stormpy

BOUND = 1e-6
SEED = "seed plate 3 x 3 { M at (1, 1) }"
PHASES = {
    "one": "phase p { M.up -> A }",
    "two": "phase p { M.up ->> A[1..2] }",
    "three": "phase p { M.up ->> A[1..3] }",
    "four": "phase p { M.up ->> A[1..4] }",
    "six": "phase p { M.up ->> A[1..6] }",
    "ten": "phase p { M.up ->> A[1..10] }",
    "arm": "phase p { M.up ->> A[1..3] } phase q { A[3].east ->> B[1..2] }",
    "hook": "phase p { M.up ->> A[1..3] } phase q { A[3].east -> B  B.east -> C  C.down -> D }",
    "stairs": "phase p { M.up -> A  A.up -> B  B.east -> C  C.up -> D  D.east -> E }",
    "cross": "phase p { M.up ->> A[1..2] } phase q { A[2].east -> B } phase r { A[2].west -> C }",
}


def waits(chain):
    """Returns the rate of arrivals and the mean docking time of each capture."""
    edges = chain["automata"][0]["edges"]
    for arrival, stage in zip(edges[0::3], edges[1::3]):
        yield arrival["rate"]["exp"], 2 / stage["rate"]["exp"]["right"]


def integral(waits, time, steps):
    """Returns P(sum <= time) by the trapezoidal rule."""
    s = numpy.linspace(0, time, steps + 1)
    step = time / steps
    total = None
    for rate, docking in waits:
        x = 2 * s / docking
        hazard = rate * -numpy.expm1(-x + numpy.log1p(x))
        survival = numpy.exp(-rate * docking / 2 * (x - 2 + numpy.exp(-x) * (x + 2)))
        if total is None:
            total = 1 - survival
            continue
        density = hazard * survival
        length = 2 * len(s)
        product = numpy.fft.irfft(
            numpy.fft.rfft(total, length) * numpy.fft.rfft(density, length), length
        )[: len(s)]
        # The first and the last term of each sum count half. The first value of both is 0.
        total = step * product
    return total[-1]


def extrapolated(waits, time):
    coarse, fine = (integral(waits, time, steps) for steps in (1 << 15, 1 << 16))
    return fine + (fine - coarse) / 3


def main():
    stochc = sys.argv[1]
    print("| program | captures | states | time | Storm | integral | difference |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    largest = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, phases in PHASES.items():
            source = pathlib.Path(folder, f"{name}.sa")
            source.write_text(f"assembly {name} {{ {SEED} {phases} }}")
            target = source.with_suffix(".jani")
            command = [stochc, "compile", str(source), "--emit", "jani", "--out", str(target)]
            subprocess.run(command, check=True)
            chain = json.loads(target.read_text())
            pairs = list(waits(chain))
            model, _ = stormpy.parse_jani_model(str(target))
            for factor in (0.5, 1, 2):
                time = round(factor * 600 * len(pairs))
                text = f"P=? [F<={time} captures={len(pairs)}]"
                formula = stormpy.parse_property(text, model)
                built = stormpy.build_model(model, formula)
                checked = stormpy.model_checking(
                    built, formula, environment=stormpy.environments.sound()
                )
                storm = checked.get_value(built.initial_states[0])
                known = extrapolated(pairs, time)
                largest = max(largest, abs(storm - known))
                print(
                    f"| {name} | {len(pairs)} | {built.nr_states} | {time} | {storm:.8f} "
                    f"| {known:.8f} | {storm - known:+.1e} |"
                )
    print(f"\nlargest difference: {largest:.1e}")
    return int(largest > BOUND)


if __name__ == "__main__":
    sys.exit(main())
