// Light or dark: as the system has it, until somebody chooses.

import type {Theme} from '../view/colours.js';

const kKey = 'tetropolis-theme';
const system = window.matchMedia('(prefers-color-scheme: dark)');
const ofSystem = (): Theme => system.matches ? 'dark' : 'light';

function chosen(): Theme | null {
  try {
    const stored = localStorage.getItem(kKey);
    return stored === 'light' || stored === 'dark' ? stored : null;
  } catch {
    return null;  // pages from files have no storage everywhere
  }
}

export const currentTheme = (): Theme => chosen() ?? ofSystem();

export function storeTheme(theme: Theme): void {
  try {
    localStorage.setItem(kKey, theme);
  } catch { /* as above */ }
}

/** Calls `change` whenever the system's theme changes, as long as none is chosen. */
export function onSystemTheme(change: (theme: Theme) => void): void {
  system.addEventListener('change', () => {
    if (chosen() === null) change(ofSystem());
  });
}
