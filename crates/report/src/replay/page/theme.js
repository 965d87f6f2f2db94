// Colours of drawings, from the palette of stochc. The colours of the page itself are in style.css.

/** Colours of both themes. `ghost` is the opacity of free blocks, and `edge` the darkness of the edges of blocks. */
const THEMES = {
  dark: { ...PALETTE.dark, ghost: 0.3, edge: 0.42 },
  light: { ...PALETTE.light, ghost: 0.28, edge: 0.6 },
};

const ofPhase = phase => PALETTE.phases[phase % PALETTE.phases.length];
const phaseColour = phase => ofPhase(phase).colour;

/** Returns the red, green and blue of `#rrggbb`, from 0 to 1. */
function rgb(hex) {
  let known = RGB.get(hex);
  if (!known) RGB.set(hex, (known = [1, 3, 5].map(at => parseInt(hex.slice(at, at + 2), 16) / 255)));
  return known;
}

const RGB = new Map();

/** Returns the theme that the reader chose, or the theme of the system. */
function themeName() {
  const chosen = document.documentElement.dataset.theme;
  return chosen || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
}
