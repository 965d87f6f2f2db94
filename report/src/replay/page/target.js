// The structure that the program builds.

/** The cells that are filled when all has happened as the program says. */
function target(about) {
  const magnetized = new Map();
  for (const { name, duties } of about.tables.blocks) {
    for (const { phase, rules } of duties) {
      for (const { then } of rules) if (then.cell) magnetized.set([phase, name, then.face, then.child].join('\0'), then.cell);
    }
  }
  const cells = new Map();
  for (const { name, events } of about.graph.phases) {
    for (const { kind, parent, face, block } of events) {
      const cell = magnetized.get([name, parent, face, block].join('\0'));
      if (kind === 'release') cells.delete(block);
      else if (cell) cells.set(block, cell);
    }
  }
  return [...cells.values()];
}
