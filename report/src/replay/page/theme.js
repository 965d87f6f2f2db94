// Colours of what is drawn; those of the page are in style.css.

/** Of the phases, in turn: they differ for the colour-blind as well. */
const PHASES = ['#e8871e', '#3b8fd9', '#2fa86f', '#c659a5', '#d9b512', '#e0533d', '#36b5b0', '#8f74d6'];

const THEMES = {
  dark: {
    background: '#12161c', ground: '#1d242d', rings: '#3a4654', shell: '#55657a', seed: '#aab4c0', plate: '#4a5563',
    free: '#8794a6', ghost: 0.3, lit: '#ff5a36', mark: '#ffffff', edge: 0.42, ink: '#ffffff', halo: '#0b0e12',
  },
  light: {
    background: '#f4f5f7', ground: '#e3e6ea', rings: '#c2c8d0', shell: '#a4adb9', seed: '#6c7683', plate: '#b4bcc6',
    free: '#8792a6', ghost: 0.28, lit: '#e0301e', mark: '#000000', edge: 0.6, ink: '#14181d', halo: '#ffffff',
  },
};

const phaseColour = phase => PHASES[phase % PHASES.length];

/** `#rrggbb` to red, green and blue from 0 to 1. */
function rgb(hex) {
  let known = RGB.get(hex);
  if (!known) RGB.set(hex, (known = [1, 3, 5].map(at => parseInt(hex.slice(at, at + 2), 16) / 255)));
  return known;
}

const RGB = new Map();

/** The theme that the reader chose, or the system's. */
function themeName() {
  const chosen = document.documentElement.dataset.theme;
  return chosen || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
}
