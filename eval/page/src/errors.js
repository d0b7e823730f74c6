// SPDX-License-Identifier: BSD-3-Clause
// The section on errors of the map: by kind of surface, by distance from the laser, by way driven.
import { bars, lines } from './chart.js';
import { count, html, length, short } from './words.js';

const names = { floor: 'Floor', roof: 'Roof', rib: 'Ribs', cap: 'Caps at portals' };

export function errors(data) {
  const ramp = data.space?.ramp, high = data.range;
  const colour = (v) => (ramp ? ramp[Math.round((254 * (Math.max(-high, Math.min(high, v)) + high)) / (2 * high))] : 'var(--one)');
  const grid = html('div', { class: 'charts' });
  for (const h of data.histogram)
    grid.append(bars({ ...h, low: -high, high, colour, title: names[h.label] ?? h.label, xWords: 'error, m: − in the rock, + in the void', yWords: '% of points',
                       alt: `Histogram of the signed errors of ${count(h.n)} points on ${h.label}`,
                       caption: `${count(h.n)} points; ${short((100 * (h.under + h.over)) / h.n, 2)} % lie beyond ±${length(high)} (outer bars).` }));
  if (data.reach.length > 1)
    grid.append(lines({ title: 'Error against distance from the laser', x: data.reach.map((r) => r.m), xWords: 'distance from the vehicle, m', yWords: 'm',
                        series: [{ name: '95 % lie below', y: data.reach.map((r) => r.p95), ink: 'two' }, { name: 'mean', y: data.reach.map((r) => r.mean), ink: 'one' }],
                        alt: 'Chart of the distance of map points to the rock against the distance from which they were seen',
                        caption: 'Distance of the map’s points to the true rock, by how far from the vehicle they were seen.' }));
  if (data.drift.length > 1)
    grid.append(lines({ title: 'Drift against way driven', x: data.drift.map((d) => d.m), xWords: 'way between two poses, m', yWords: '% of the way', log: true, dots: true,
                        series: [{ name: 'relative error', y: data.drift.map((d) => d.percent), ink: 'one' }],
                        alt: 'Chart of the mean relative error of poses against the way between them',
                        caption: 'Mean error of one pose as seen from another, in percent of the way between them.' }));
  return grid.childElementCount ? [grid] : [];
}
