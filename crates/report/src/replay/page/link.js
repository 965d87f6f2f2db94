// Storage of tick, selected block, view and controls in the address of the page.

/** Returns the requests in the address of the page. A request is `null` if it is absent. */
function readLink() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const whole = name => (/^-?\d+$/.test(asked.get(name) ?? '') ? Number(asked.get(name)) : null);
  const view = (asked.get('view') ?? '').split(',').map(Number);
  return {
    tick: whole('tick'),
    body: whole('block'),
    view: view.length === 6 && view.every(Number.isFinite) ? view : null,
    embedded: asked.has('embed') || new URLSearchParams(location.search).has('embed'),
  };
}

/**
 * Writes the state of the page into its address, so that it can be shared. Includes the view if it differs from the
 * initial one.
 */
function writeLink({ tick, body, view, embedded }) {
  const parts = [`tick=${Math.floor(tick)}`];
  if (body !== null) parts.push(`block=${body}`);
  if (view) parts.push(`view=${view.map(number => Number(number.toFixed(3))).join()}`);
  if (embedded) parts.push('embed');
  const hash = `#${parts.join('&')}`;
  if (location.hash === hash) return;
  try {
    window.history.replaceState(null, '', hash);
  } catch {
    // Some browsers do not allow a local file to change its address.
  }
}
