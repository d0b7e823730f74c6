// SPDX-License-Identifier: BSD-3-Clause
// The place looked at, on the plan of the first screen; a click there goes to the nearest place of the path.
import { svg } from './words.js';

export function markPlan(data, place) {
  const passages = [];  // what lights a passage up, one for each drawing
  for (const kind of ['wide', 'narrow']) {
    const drawing = document.querySelector(`#plan .${kind} svg`), at = data.plan[kind];
    if (!drawing || !at) continue;
    const toX = (x) => at.x + at.px_per_m * x, toY = (y) => at.y - at.px_per_m * y;
    const lit = svg('polyline', { class: 'passage' });
    drawing.append(lit);
    passages.push((line) => lit.setAttribute('points', line ? line.map(([x, y]) => `${toX(x)},${toY(y)}`).join(' ') : ''));
    if (!place) continue;
    const mark = svg('g', { class: 'place' }, svg('circle', { r: 11, class: 'halo' }), svg('circle', { r: 7, class: 'core' }));
    drawing.append(mark);
    place.onChange((k) => mark.setAttribute('transform', `translate(${toX(place.path.x[k])} ${toY(place.path.y[k])})`));
    drawing.addEventListener('click', (event) => {
      if (event.target.closest('a')) return;
      const box = drawing.getBoundingClientRect(), view = drawing.viewBox.baseVal;
      // The drawing keeps its shape within its box.
      const s = Math.min(box.width / view.width, box.height / view.height);
      const px = (event.clientX - box.left - (box.width - s * view.width) / 2) / s;
      const py = (event.clientY - box.top - (box.height - s * view.height) / 2) / s;
      place.goTo((px - at.x) / at.px_per_m, (at.y - py) / at.px_per_m);
    });
  }
  return (line) => passages.forEach((light) => light(line));
}
