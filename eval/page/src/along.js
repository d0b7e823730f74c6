// SPDX-License-Identifier: BSD-3-Clause
// The section along the path: a slider that moves the place, and charts that follow it.
import { lines } from './chart.js';
import { nearest } from './place.js';
import { player } from './player.js';
import { html, length, short } from './words.js';

function slider(place) {
  const { path } = place;
  const words = (k) => {
    const parts = [`${short(path.along[k], 4)} m`, `${short(path.t[k], 4)} s`];
    if (path.plan) parts.push(`${length(path.plan[k])} in plan`, `${length(path.height[k])} in height`, `${short(path.yaw[k], 2)}° in heading`);
    return parts.join(' · ');
  };
  const output = html('output', { for: 'place', 'aria-live': 'off' });
  const input = html('input', { id: 'place', type: 'range', min: 0, max: place.size - 1, step: 1, value: 0,
                                oninput: (event) => place.go(Number(event.target.value)) });
  place.onChange((k) => {
    input.value = k;
    input.setAttribute('aria-valuetext', words(k));
    output.textContent = words(k);
  });
  return html('div', { class: 'slider' }, html('label', { for: 'place' }, 'Place on the path'), input, output);
}

function bandsOf(data) {
  const { along, t } = data.path;
  return data.degenerate.map((d) => [along[nearest(t, d.from_s)], along[nearest(t, d.to_s)]]);
}

// What the scans could tell at best, in millimetres.
function information(data, shared) {
  const { information: told } = data;
  if (!told) return html('p', { class: 'missing' }, 'Not shown: information along the path. It is worked out from the true mine and the truth of the recording.');
  const mm = (list) => list.map((v) => (v == null ? null : 1000 * v));
  return lines({ ...shared, x: told.along, title: 'Information: what one scan can tell at best', yWords: 'mm, 1 σ', logY: true, height: 190,
                 series: [{ name: 'direction told least', y: mm(told.least), ink: 'two' }, { name: 'direction told most', y: mm(told.most), ink: 'one' }],
                 alt: 'Chart of the deviation with which one scan could at best tell the position, along the directions told least and most, along the way driven',
                 caption: 'Least deviation with which one scan of the mapping laser could place it in a mine that is known (Cramér–Rao bound); low is much information, a gap is none. Where the upper line is high, the mapper has to carry its position over from elsewhere.' });
}

export function along(data, place) {
  const { path } = place, bands = bandsOf(data);
  const shared = { x: path.along, xWords: 'way driven, m', place, bands, bandName: 'scans leave the way along the passage open' };
  const parts = [slider(place)];
  if (path.plan)
    parts.push(
      lines({ ...shared, title: 'Error of position', yWords: 'm', alt: 'Chart of the error of position in plan and in height along the way driven',
              series: [{ name: 'in plan (distance)', y: path.plan, ink: 'one' }, { name: 'in height (map − truth)', y: path.height, ink: 'two' }],
              caption: 'How far the mapped path lies from the true one, laid on it by the best rigid fit. Move over it, or move the slider: the plan and the view in space follow.' }),
      lines({ ...shared, title: 'Error of heading', yWords: 'degrees', alt: 'Chart of the error of heading along the way driven', height: 170,
              series: [{ name: 'heading (map − truth)', y: path.yaw, ink: 'one' }], caption: 'Turn about the vertical.' }));
  if (path.sigma) {
    const series = [{ name: 'stated by the map (1 σ)', y: path.sigma, ink: 'two' }];
    if (path.plan) series.push({ name: 'true error in plan', y: path.plan, ink: 'one' });
    parts.push(lines({ ...shared, title: 'What the map knew of its own error', yWords: 'm', series, height: 190,
                       alt: 'Chart of the deviation that the map states for its position, beside its true error, along the way driven',
                       caption: 'The deviation that the map states for its position relative to its first pose, along the direction that its measurements tell least of; where it grows, information is short.' +
                         (bands.length ? '' : ' The scans leave no stretch of the path open.') }));
  } else {
    parts.push(html('p', { class: 'missing' }, 'Not shown: what the map knew of its own error. It states no covariance of its path' +
      (bands.length ? '; shaded stretches above are those that its scans leave open.' : ', and no stretch that its scans leave open.')));
  }
  parts.push(information(data, shared));
  return [...parts, ...player(data.frames, place)];
}
