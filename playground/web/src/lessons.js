// Lessons. Each has a text, an initial program, and a task that the page checks.

/** Returns the captures of the first program in a possible order. Returns none if the program has errors. */
const captures = ({ programs }) => (programs[0]?.structure?.events ?? []).filter(({ cell }) => cell);
const releases = ({ programs }) => (programs[0]?.structure?.events ?? []).filter(({ cell }) => !cell);
const isProved = ({ programs, diagnostics }) => Boolean(programs[0]?.structure) && !diagnostics.some(({ severity }) => severity === 'error');
const phases = ({ programs }) => programs[0]?.structure?.about.tables.phases ?? [];

export const LESSONS = [
  {
    title: 'One capture',
    text: `Blocks are cubes without motors. They drift in an agitated tank. One block, the <em>seed</em> <code>M</code>, is fixed to a plate. <code>M.up -> A</code> is a <em>capture</em>: the upper face of <code>M</code> attracts until a free block bonds to it. That block is called <code>A</code> from then on. The picture shows the finished structure.`,
    task: 'Capture a second block: write <code>A.up -> B</code> on a line of its own below <code>M.up -> A</code>.',
    program: `assembly first {
    seed plate 3 x 3 {
        M at (1, 1)
    }
    phase grow {
        M.up -> A
    }
}
`,
    solution: text => text.replace('M.up -> A', 'M.up -> A\n        A.up -> B'),
    done: ({ check }) => isProved(check) && captures(check).length >= 2,
  },
  {
    title: 'Run it',
    text: `No event has a fixed time: an open face waits until a free block comes close by chance. <b>Run</b> simulates one run with physics: collisions, drag, random impulses and the attraction of open faces. Open faces glow. Drag the picture to turn it. The slider below the picture rewinds the run.`,
    task: 'Press <b>Run</b> and wait until the run is complete.',
    program: `assembly tower {
    seed plate 3 x 3 {
        M at (1, 1)
    }
    phase grow {
        M.up -> A.up -> B
    }
}
`,
    solution: text => text,
    done: ({ run }) => run?.outcome.kind === 'completed',
  },
  {
    title: 'Rows of blocks',
    text: `<code>->></code> captures a row, one block after the other: <code>M.up ->> T[1..3]</code> captures <code>T[1]</code> on <code>M</code>, <code>T[2]</code> on <code>T[1]</code>, and so on. A chain can change its direction: <code>.east</code> names the face that captures next.`,
    task: 'Make the tower six blocks high, and add a row of two blocks at its top to the east: end the line with <code>.east ->> E[1..2]</code>.',
    program: `assembly tower {
    seed plate 3 x 3 {
        M at (1, 1)
    }
    phase grow {
        M.up ->> T[1..3]
    }
}
`,
    solution: text => text.replace('T[1..3]', 'T[1..6].east ->> E[1..2]'),
    done: ({ check }) => isProved(check) && captures(check).length >= 8 && captures(check).some(({ face }) => face === 'east'),
  },
  {
    title: 'Parallel, and in phases',
    text: `The statements of a phase run in parallel, and chance decides their order. A phase ends when all its captures have happened. Then the next phase begins. In the program below, two posts grow at the same time.`,
    task: 'Add a second phase <code>lintel</code> that joins the posts: <code>A[3].east -> K</code>.',
    program: `assembly gate {
    seed plate 3 x 1 {
        L at (0, 0)
        R at (2, 0)
    }
    phase posts {
        L.up ->> A[1..3]
        R.up ->> B[1..3]
    }
}
`,
    solution: text => text.replace(/\}\n$/, '    phase lintel {\n        A[3].east -> K\n    }\n}\n'),
    done: ({ check }) => isProved(check) && phases(check).length >= 2 && captures(check).length >= 7,
  },
  {
    title: 'When chance shuts a door',
    text: `A program must work for every order of arrivals. stochc proves this before anything runs. In this program, it finds a bad order: four blocks and a lid close the cell of <code>X</code> before the block <code>X</code> has come. The message shows that order and proposes a change.`,
    task: 'Repair the program so that no error is left. The button <b>Fix</b> of the message does this.',
    program: `assembly well {
    seed plate 3 x 3 {
        M at (1, 1)
        S at (1, 0)   W at (0, 1)   E at (2, 1)   N at (1, 2)
    }
    phase grow {
        M.up -> X
        W.up -> A   E.up -> B   N.up -> C
        S.up -> D.up -> D2.north -> LID
    }
}
`,
    fix: true,
    done: ({ check }) => isProved(check) && captures(check).length >= 7,
  },
  {
    title: 'Claim a shape',
    text: `A <em>shape</em> draws layers as text, from above. <code>yields</code> claims that the structure has this shape when the phase ends. stochc proves the claim. The claim in the program below is wrong, and the message shows the layer that differs.`,
    task: 'Change the program, not the shape, so that the claim holds: the lintel belongs on layer 3.',
    program: `shape gate {
    layer 1..2 {
        # . #
    }
    layer 3 {
        # # #
    }
}

assembly gate {
    seed plate 3 x 1 {
        L at (0, 0)
        R at (2, 0)
    }
    phase posts {
        L.up ->> A[1..3]
        R.up ->> B[1..3]
    }
    phase lintel {
        A[2].east -> K
        yields gate
    }
}
`,
    solution: text => text.replace('A[2].east', 'A[3].east'),
    done: ({ check, text }) => isProved(check) && /layer 3 \{\s*# # #/.test(text) && (check.programs[0].proved?.shapes ?? []).includes('gate'),
  },
  {
    title: 'A scaffold that is taken down',
    text: `<code>release ARM</code> sets the block <code>ARM</code> free again. A <em>scaffold</em> is a temporary block that helps to build a structure. Drag the slider below the picture to see the structure before and after each event.`,
    task: 'Add a third phase <code>clear</code> that releases <code>ARM</code>.',
    program: `assembly scaffold {
    seed plate 3 x 3 {
        M at (1, 1)
    }
    phase tower {
        M.up ->> T[1..3]
    }
    phase bridge {
        T[3].east -> ARM
    }
}
`,
    solution: text => text.replace(/\}\n$/, '    phase clear {\n        release ARM\n    }\n}\n'),
    done: ({ check }) => isProved(check) && releases(check).length >= 1,
  },
  {
    title: 'Time limits and retries',
    text: `A capture can take long by chance, and a block can jam. <code>timeout</code> limits the duration of a phase. <code>on timeout { release grow  retry 3 }</code> after the phase releases the blocks that it has captured, and begins it again, at most three times. stochc proves that every attempt starts from the same structure. <code>release ARM after 20 s</code> releases a block 20 s later than it could.`,
    task: 'Give the phase <code>grow</code> the handler: write <code>on timeout { release grow  wait 20 s  retry 3 }</code> after its brace. Then release <code>ARM</code> with <code>after 20 s</code>.',
    program: `assembly tower {
    seed plate 3 x 3 {
        M at (1, 1)
    }
    phase grow timeout 2 min {
        M.up ->> T[1..3].east -> ARM
    }
    phase clear {
        release ARM
    }
}
`,
    solution: text => text.replace(/\}\n    phase clear/, '} on timeout {\n        release grow\n        wait 20 s\n        retry 3\n    }\n    phase clear').replace('release ARM\n', 'release ARM after 20 s\n'),
    done: ({ check, text }) => isProved(check) && phases(check).some(({ recovery }) => recovery) && releases(check).length >= 1 && /release ARM after \d/.test(text),
  },
  {
    title: 'A scene of your own',
    text: `A <em>scene</em> is the physical world: blocks, fluid, agitation, enclosure. <code>scene crowded from hemisphere</code> copies the built-in scene <code>hemisphere</code> and changes single parameters. <b>Many runs</b> repeats the program with other random numbers. It draws the share of complete runs over time.`,
    task: 'Double the number of free blocks to <code>free 240 uniform</code>. Then make at least 10 runs under <b>Many runs</b>.',
    program: `scene crowded from hemisphere {
    free 120 uniform
}

assembly tower in crowded {
    seed plate 3 x 3 {
        M at (1, 1)
    }
    phase grow {
        M.up ->> T[1..4]
    }
}
`,
    solution: text => text.replace('free 120', 'free 240'),
    done: ({ check, ensemble }) => isProved(check) && (check.programs[0].structure.about.scene.free?.count ?? 0) >= 240 && (ensemble?.records.length ?? 0) >= 10,
  },
];
