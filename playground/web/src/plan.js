// Dialog for drawing a shape, layer by layer.

/** Sizes of the grid [cells]. */
const MIN = 3, MAX = 16;

/**
 * Returns the content of the dialog. `node` creates elements. `call(request)` asks the engine. `open(plan)` opens the planned
 * program.
 */
export function planner({ node, call, open }) {
  const state = { size: 7, layer: 0, layers: [new Set()] };
  const key = (x, y) => `${x},${y}`;

  const grid = node('div', { className: 'drawing', role: 'grid', ariaLabel: 'cells of this layer, seen from above, north on top' });
  const status = node('p', { className: 'hint', role: 'status' });
  const count = node('output', {});
  const layerName = node('b', {});
  const plan = node('button', { className: 'primary', id: 'plan-now', onclick: () => run() }, 'Plan the program');
  const file = node('input', { type: 'file', accept: '.vox', hidden: true, ariaLabel: 'MagicaVoxel file', onchange: () => file.files[0] && drop(file.files[0]) });

  function text() {
    const row = (cells, y) => Array.from({ length: state.size }, (_, x) => (cells.has(key(x, y)) ? '#' : '.')).join('');
    const filled = state.layers.slice(0, state.layers.findLastIndex(cells => cells.size > 0) + 1);
    return filled.map(cells => Array.from({ length: state.size }, (_, y) => row(cells, y)).join('\n')).join('\n\n');
  }

  function draw() {
    const cells = state.layers[state.layer];
    const below = state.layers[state.layer - 1] ?? new Set();
    const focused = grid.querySelector('[tabindex="0"]')?.dataset.at ?? key(0, 0);
    const rows = Array.from({ length: state.size }, (_, y) => node('div', { role: 'row' }, ...Array.from({ length: state.size }, (_, x) => {
      const at = key(x, y);
      const cell = node('button', { type: 'button', role: 'gridcell', tabIndex: at === focused ? 0 : -1, ariaLabel: `column ${x + 1}, row ${y + 1}`, ariaSelected: String(cells.has(at)), className: below.has(at) ? 'below' : '' });
      cell.dataset.at = at;
      return cell;
    })));
    grid.style.setProperty('--size', state.size);
    grid.replaceChildren(...rows);
    if (!grid.querySelector('[tabindex="0"]')) grid.querySelector('button').tabIndex = 0;
    layerName.textContent = `Layer ${state.layer + 1} of ${state.layers.length}`;
    const blocks = state.layers.reduce((sum, cells) => sum + cells.size, 0);
    count.textContent = `${blocks} block${blocks === 1 ? '' : 's'}`;
    plan.disabled = blocks === 0;
  }

  function set(cell, isFull) {
    const cells = state.layers[state.layer];
    if (isFull) cells.add(cell.dataset.at);
    else cells.delete(cell.dataset.at);
    const had = document.activeElement === cell;
    draw();
    if (had) grid.querySelector(`[data-at="${cell.dataset.at}"]`).focus();
  }

  // Drag with the pointer: the first cell decides whether the others are filled or emptied.
  let fill = null;
  const cellAt = event => document.elementFromPoint(event.clientX, event.clientY)?.closest('[data-at]');
  grid.addEventListener('pointerdown', event => {
    const cell = cellAt(event);
    if (!cell) return;
    event.preventDefault();
    fill = cell.ariaSelected !== 'true';
    set(cell, fill);
  });
  grid.addEventListener('pointermove', event => {
    if (!event.buttons) fill = null;
    const cell = fill === null ? null : cellAt(event);
    if (cell && (cell.ariaSelected === 'true') !== fill) set(cell, fill);
  });
  grid.addEventListener('keydown', event => {
    const cell = event.target.closest('[data-at]');
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (step) {
      const [x, y] = cell.dataset.at.split(',').map(Number);
      const next = grid.querySelector(`[data-at="${key(x + step[0], y + step[1])}"]`);
      if (next) {
        cell.tabIndex = -1;
        next.tabIndex = 0;
        next.focus();
      }
    } else if (event.key === ' ' || event.key === 'Enter') set(cell, cell.ariaSelected !== 'true');
    else return;
    event.preventDefault();
  });

  function go(layer) {
    state.layer = Math.max(0, layer);
    while (state.layers.length <= state.layer) state.layers.push(new Set());
    draw();
  }

  function resize(size) {
    state.size = size;
    for (const cells of state.layers) for (const at of cells) if (at.split(',').some(part => Number(part) >= size)) cells.delete(at);
    draw();
  }

  async function drop(voxels) {
    try {
      const bytes = [...new Uint8Array(await voxels.arrayBuffer())];
      const { cells } = await call({ call: 'read_drawing', drawing: { vox: bytes } });
      const depth = Math.max(0, ...cells.map(([, y]) => y + 1));
      const size = Math.max(MIN, depth, ...cells.map(([x]) => x + 1));
      if (size > MAX) throw new Error(`the shape is ${size} cells wide; the page shows at most ${MAX}`);
      const layers = Array.from({ length: Math.max(1, ...cells.map(([, , z]) => z)) }, () => new Set());
      // North is on top.
      for (const [x, y, z] of cells) layers[z - 1].add(key(x, depth - 1 - y));
      Object.assign(state, { size, layer: 0, layers });
      sizes.value = String(size);
      status.textContent = `Read ${voxels.name}.`;
      draw();
    } catch (error) {
      status.textContent = `${voxels.name} cannot be read: ${error.message}`;
    }
  }

  async function run() {
    plan.disabled = true;
    status.textContent = 'Planning …';
    try {
      open(await call({ call: 'plan', drawing: { layers: text() } }));
    } catch (error) {
      status.textContent = `There is no plan: ${error.message}`;
      plan.disabled = false;
    }
  }

  const sizes = node('select', { onchange: () => resize(Number(sizes.value)) }, ...Array.from({ length: MAX - MIN + 1 }, (_, i) => node('option', { value: String(MIN + i), selected: MIN + i === state.size }, `${MIN + i} × ${MIN + i}`)));
  const body = node('div', { className: 'plan' },
    node('p', {}, 'Draw the structure layer by layer, from the plate upwards. The planner finds an order of captures that builds it without jams.'),
    node('div', { className: 'row' },
      node('button', { type: 'button', ariaLabel: 'layer below', onclick: () => go(state.layer - 1) }, '▼'),
      layerName,
      node('button', { type: 'button', id: 'layer-above', ariaLabel: 'layer above', onclick: () => go(state.layer + 1) }, '▲'),
      node('label', {}, 'size ', sizes),
      node('button', { type: 'button', onclick: () => file.click() }, 'Open .vox'), file),
    grid,
    node('div', { className: 'row' }, plan, count),
    status);
  body.addEventListener('dragover', event => event.preventDefault());
  body.addEventListener('drop', event => {
    event.preventDefault();
    // The page would open the file as well.
    event.stopPropagation();
    if (event.dataTransfer.files[0]) drop(event.dataTransfer.files[0]);
  });
  draw();
  return body;
}
