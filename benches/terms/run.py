#!/usr/bin/env python3
"""What each term of a scene costs in instructions, and that an absent one costs nothing and changes nothing.

Moves the same 300 blocks by the kernel of `--model rigid`, one step a tick, with all terms; without one of them in the scene;
and once more in a build of the kernel without that term's code. The last two must end alike to the bit. Needs valgrind.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
TERMS = ["agitation", "bond", "contact", "drag", "enclosure", "fluid", "gravity"]
IDLE = ["agitation", "bond", "drag", "fluid", "gravity"]  # those that can be there and do next to nothing
BLOCKS = 300
TICKS = (100, 500)  # instructions are those of the ticks between


def build(without, where):
    features = ",".join(term for term in TERMS if term != without)
    command = ["cargo", "build", "--release", "--locked", "-p", "stochc-runtime", "--example", "terms"]
    if without:
        command += ["--no-default-features", "--features", features]
    subprocess.run(command, cwd=ROOT, check=True, stderr=subprocess.DEVNULL)
    program = where / f"terms-{without or 'all'}"
    program.write_bytes((ROOT / "target/release/examples/terms").read_bytes())
    program.chmod(0o755)
    return program


def run(program, without, ticks):
    """The number that a run ends with, and its instructions."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", program, without, str(ticks)]
    found = subprocess.run(command, capture_output=True, text=True, check=True)
    counted = re.search(r"refs:\s*([\d,]+)", found.stderr)
    return found.stdout.strip(), int(counted[1].replace(",", ""))


def cost(program, without):
    (_, first), (end, last) = (run(program, without, ticks) for ticks in TICKS)
    return end, (last - first) / (BLOCKS * (TICKS[1] - TICKS[0]))


def main():
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        where = pathlib.Path(folder)
        full = build(None, where)
        _, everything = cost(full, "nothing")
        print("| left out | instructions | in a build without its code | same to the bit | there, but next to nothing |")
        print("|---|---:|---:|---|---:|")
        print(f"| nothing | {everything:.0f} | | | |")
        for term in TERMS:
            end, instructions = cost(full, term)
            other, without_code = cost(build(term, where), term)
            idle = cost(full, f"idle-{term}")[1] if term in IDLE else None
            same = "yes" if end == other else "no"
            told = f"{idle:.0f}" if idle else ""
            print(f"| `{term}` | {instructions:.0f} | {without_code:.0f} | {same} | {told} |", flush=True)
            if end != other:
                wrong.append(f"without `{term}` the two builds end differently")
            if idle and idle <= instructions:
                wrong.append(f"where `{term}` does nothing it costs nothing: the scene without it must pay for it as well")
            if instructions > without_code * 1.05:
                wrong.append(f"the code for `{term}` costs something where the scene does not have it")
    print(f"\nInstructions per block and tick, {BLOCKS} blocks, one step a tick.")
    for text in wrong:
        print(f"\n**Wrong**: {text}.")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
