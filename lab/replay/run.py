#!/usr/bin/env python3
"""Compares the frame rates of two pages of `stochc replay` while they play.

    python3 lab/replay/run.py BEFORE.html AFTER.html

Chromium draws without a graphics processor. The pages alternate, each in a new browser. The printed values are medians over the
rounds, and the ratio of the second page to the first.
"""
import argparse
import statistics

from browser import Browser

# Resolves with the number of frames in some seconds, and the fraction of the canvas's pixels that the last frame has.
PLAY = """(async () => {
    const canvas = document.getElementById('arena');
    const next = () => new Promise(requestAnimationFrame);
    await replay.seek(0);
    if (%(view)s) replay.look(%(view)s);
    replay.speed(%(speed)s);
    replay.play();
    const warm = performance.now() + %(warm)s;
    while (performance.now() < warm) await next();
    let pictures = 0;
    const begun = await next();
    let now = begun;
    while (now < begun + %(milliseconds)s) {
        now = await next();
        pictures++;
    }
    const { tick, playing } = replay.state();
    replay.pause();
    if (!playing) throw new Error(`the run ends at tick ${tick}, before the measurement does`);
    return [pictures, (now - begun) / 1000, (canvas.width / canvas.clientWidth) ** 2];
})()"""


def measure(page, options):
    """Returns frames per second, CPU time per frame [ms], and the fraction of drawn pixels while the replay plays."""
    browser = Browser(options.width, options.height)
    try:
        browser.open(page)
        words = {
            "speed": options.speed,
            "view": f"[{options.view}]" if options.view else "null",
            "warm": 1000 * options.warm,
            "milliseconds": 1000 * options.seconds,
        }
        browser.value(PLAY % {**words, "warm": 1000, "milliseconds": 0})
        before = browser.processor_time()
        pictures, seconds, pixels = browser.value(PLAY % words)
        spent = browser.processor_time() - before
        # Frames are also drawn during the warm-up.
        return pictures / seconds, 1000 * spent * seconds / (seconds + options.warm) / pictures, pixels
    finally:
        browser.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=6)
    parser.add_argument("--warm", type=float, default=3)
    parser.add_argument("--width", type=int, default=1440)
    parser.add_argument("--height", type=int, default=900)
    parser.add_argument("--speed", type=float, default=1)
    parser.add_argument("--view", help="where one looks from, as in an address: azimuth,height,distance,x,y,z; the first view, if left out")
    options = parser.parse_args()
    pages = [options.before, options.after]
    measured = [[], []]
    for _ in range(options.rounds):
        for page, rounds in zip(pages, measured):
            rounds.append(measure(page, options))
    print(f"{options.width} x {options.height}, medians of {options.rounds} rounds of {options.seconds:g} s\n")
    print("| page | pictures a second | processor time of a picture | pixels |")
    print("|---|---:|---:|---:|")
    medians = [[statistics.median(column) for column in zip(*rounds)] for rounds in measured]
    for page, (rate, cost, pixels) in zip(pages, medians):
        print(f"| {page} | {rate:.1f} | {cost:.1f} ms | {100 * pixels:.0f} % |")
    rates = [[rate for rate, *_ in rounds] for rounds in measured]
    ratios = sorted(after / before for before, after in zip(*rates))
    print(f"\npictures a second: {medians[1][0] / medians[0][0]:.2f} times as many ({ratios[0]:.2f} to {ratios[-1]:.2f})")


if __name__ == "__main__":
    main()
