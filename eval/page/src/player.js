// SPDX-License-Identifier: BSD-3-Clause
// The views along the path: the one nearest to the place, and a button that drives through them all.
import { nearest } from './place.js';
import { html, short } from './words.js';

const stepMs = 450;

export function player(frames, place) {
  if (!frames?.length) return [];
  const along = frames.map((f) => f.along), picture = html('img', { width: 680, height: 210 });
  const show = (k) => {
    picture.src = `data:image/png;base64,${frames[k].png}`;
    picture.alt = `View along the passage ${short(along[k], 4)} m after the start: the true mine beside the map coloured by error`;
  };
  place.onChange((k) => show(nearest(along, place.path.along[k])));
  let timer = null;
  const button = html('button', { type: 'button', 'aria-pressed': 'false', onclick: () => (timer ? stop() : start()) }, '▶ Drive through');
  const stop = () => {
    clearInterval(timer);
    timer = null;
    button.setAttribute('aria-pressed', 'false');
    button.textContent = '▶ Drive through';
  };
  const start = () => {
    let k = nearest(along, place.path.along[place.index]);
    if (k === along.length - 1) k = -1;
    button.setAttribute('aria-pressed', 'true');
    button.textContent = '❚❚ Stop';
    timer = setInterval(() => {
      if (++k >= along.length) return stop();
      place.goAlong(along[k]);
    }, stepMs);
  };
  return [html('figure', { class: 'chart' }, html('h3', {}, 'From the path'), html('div', { class: 'player' }, picture, html('div', { class: 'buttons' }, button)),
               html('figcaption', {}, 'What a lamp shows near the place: the true mine on the left, the map from the same place on the right. The file along.png beside this page is the same as one animated picture.'))];
}
