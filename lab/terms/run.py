#!/usr/bin/env python3
"""Counts the instructions that each term of a scene costs.

Moves the same 300 blocks with the kernel of `--model rigid`, one step per tick, with all terms, and without each of them.
Needs valgrind.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
TERMS = ["agitation", "bond", "contact", "drag", "enclosure", "fluid", "gravity"]
IDLE = ["agitation", "bond", "drag", "fluid", "gravity"]  # terms that can be present with almost no effect
BLOCKS = 300
TICKS = (100, 500)  # the result is the difference


def build():
    command = ["cargo", "build", "--release", "--locked", "--manifest-path", "lab/Cargo.toml", "--bin", "terms"]
    subprocess.run(command, cwd=ROOT, check=True, stderr=subprocess.DEVNULL)
    return ROOT / "lab/target/release/terms"


def run(program, without, ticks):
    """Returns the number of instructions that a simulation executes."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", program, without, str(ticks)]
    found = subprocess.run(command, capture_output=True, text=True, check=True)
    counted = re.search(r"refs:\s*([\d,]+)", found.stderr)
    return int(counted[1].replace(",", ""))


def cost(program, without):
    first, last = (run(program, without, ticks) for ticks in TICKS)
    return (last - first) / (BLOCKS * (TICKS[1] - TICKS[0]))


def main():
    wrong = []
    program = build()
    print("| left out | instructions | idle |")
    print("|---|---:|---:|")
    print(f"| nothing | {cost(program, 'nothing'):.0f} | |")
    for term in TERMS:
        instructions = cost(program, term)
        idle = cost(program, f"idle-{term}") if term in IDLE else None
        shown = f"{idle:.0f}" if idle else ""
        print(f"| `{term}` | {instructions:.0f} | {shown} |", flush=True)
        if idle and idle <= instructions:
            wrong.append(f"an idle `{term}` costs no more than none: the scene without it pays for it")
    print(f"\nInstructions per block and tick, {BLOCKS} blocks, one step a tick.")
    for text in wrong:
        print(f"\n**Wrong**: {text}.")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
