// Final structure of the program.

/** Returns the cells that are occupied after all events of the program. */
function target(about) {
  const magnetized = new Map();
  for (const { name, duties } of about.tables.blocks) {
    for (const { phase, rules } of duties) {
      for (const { then } of rules) if (then.cell) magnetized.set([phase, name, then.face, then.child].join('\0'), then.cell);
    }
  }
  const cells = new Map();
  for (const { name, events } of about.graph.phases) {
    const goes = events.filter(({ kind }) => kind === 'release').map(({ block }) => block);
    // Blocks that were already in the structure are released first, because their names may be
    // reused. Blocks that this phase captures and releases are removed at the end.
    const brief = goes.filter(block => !cells.has(block));
    for (const block of goes) cells.delete(block);
    for (const { parent, face, block } of events) {
      const cell = magnetized.get([name, parent, face, block].join('\0'));
      if (cell) cells.set(block, cell);
    }
    for (const block of brief) cells.delete(block);
  }
  return [...cells.values()];
}
