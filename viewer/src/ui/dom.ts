// Elements in a line.

type Child = Node | string | number | null | undefined | false;
type Attributes = Record<string, string | number | boolean | EventListener | undefined>;

function fill(element: Element, attributes: Attributes, children: readonly Child[]): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, '');
    else if (value !== undefined && value !== false) element.setAttribute(name, String(value));
  }
  for (const child of children)
    if (child !== null && child !== undefined && child !== false)
      element.append(typeof child === 'number' ? String(child) : child);
}

/** Attributes that begin with "on" are listeners. */
export function el<Tag extends keyof HTMLElementTagNameMap>(
    tag: Tag, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[Tag] {
  const element = document.createElement(tag);
  fill(element, attributes, children);
  return element;
}

export function svg<Tag extends keyof SVGElementTagNameMap>(
    tag: Tag, attributes: Attributes = {}, ...children: Child[]): SVGElementTagNameMap[Tag] {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  fill(element, attributes, children);
  return element;
}

export const byId = <T extends HTMLElement = HTMLElement>(id: string): T => document.getElementById(id) as T;

/** Buttons of which one is chosen; arrow keys go from one to the next. */
export function choice<Value extends string>(
    group: HTMLElement, name: string, options: readonly (readonly [Value, string])[], chosen: Value,
    choose: (value: Value) => void): {set: (value: Value) => void} {
  const buttons = options.map(([value, text]) => el('button', {role: 'radio', 'data-value': value, onclick: () => pick(value)}, text));
  const show = (value: Value): void => {
    for (const button of buttons) {
      const on = button.dataset['value'] === value;
      button.setAttribute('aria-checked', String(on));
      button.tabIndex = on ? 0 : -1;
    }
  };
  const pick = (value: Value): void => {
    show(value);
    choose(value);
  };
  group.append(...(name === '' ? [] : [el('span', {class: 'name'}, name)]), ...buttons);
  group.addEventListener('keydown', (event) => {
    const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key];
    if (step === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const next = (buttons.findIndex((b) => b.tabIndex === 0) + step + buttons.length) % buttons.length;
    buttons[next].focus();
    pick(options[next][0]);
  });
  show(chosen);
  return {set: show};
}

const numbers = new Intl.NumberFormat('en');
/** 1,666,811 */
export const whole = (value: number): string => numbers.format(Math.round(value));
export const fixed = (value: number, digits: number): string => value.toFixed(digits);
export const plural = (n: number, one: string, many = `${one}s`): string => `${whole(n)} ${n === 1 ? one : many}`;

/** 0.04 s, 3.2 s, 214 s. */
export const seconds = (s: number): string => `${s < 0.995 ? s.toFixed(2) : s < 99.5 ? s.toFixed(1) : whole(s)} s`;

export const megabytes = (bytes: number): string => bytes < 1e9 ? `${whole(bytes / 1e6)} MB` : `${(bytes / 1e9).toFixed(1)} GB`;
