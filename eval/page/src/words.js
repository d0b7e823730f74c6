// SPDX-License-Identifier: BSD-3-Clause
// Elements and numbers.
const svgSpace = 'http://www.w3.org/2000/svg';

function filled(element, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
    else if (value === true) element.setAttribute(key, '');
    else if (value !== false && value != null) element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}
export function html(tag, attributes = {}, ...children) {
  return filled(document.createElement(tag), attributes, children);
}
export function svg(tag, attributes = {}, ...children) {
  return filled(document.createElementNS(svgSpace, tag), attributes, children);
}

// Three digits, with a true minus.
export function short(value, digits = 3) {
  if (value == null || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  const places = Math.max(0, Math.min(6, digits - 1 - Math.floor(Math.log10(size))));
  const text = size.toFixed(places);
  return (value < 0 && Number(text) !== 0 ? '−' : '') + (text.includes('.') ? text.replace(/\.?0+$/, '') : text);
}
// A length in metres.
export function length(metres) {
  if (metres == null) return '–';
  return Math.abs(metres) < 1 ? `${short(100 * metres, 2)} cm` : `${short(metres)} m`;
}
export function count(n) {
  return n.toLocaleString('en').replaceAll(',', ' ');
}
