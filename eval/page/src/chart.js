// SPDX-License-Identifier: BSD-3-Clause
// Charts as SVG: lines with a mark that follows the place, bars. Drawn anew when their width changes.
import { nearest } from './place.js';
import { html, short, svg } from './words.js';

const room = { left: 58, right: 14, top: 12, bottom: 44 };

function step(span, most) {
  const rough = span / most, decade = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((f) => f * decade).find((s) => s >= rough * 0.999);
}
function ticks(low, high, most) {
  const by = step(high - low, most), list = [];
  for (let k = Math.ceil(low / by - 1e-9); k * by <= high + 1e-9 * by; ++k) list.push(k * by);
  return list;
}

// 1, 2 and 5 times powers of ten; of many of those the powers alone.
function logTicks(low, high) {
  const list = [];
  for (let decade = 10 ** Math.floor(Math.log10(low)); decade <= high; decade *= 10)
    for (const f of [1, 2, 5]) if (f * decade >= low && f * decade <= high) list.push(f * decade);
  return list.length > 7 ? list.filter((v) => Number.isInteger(Math.round(1e6 * Math.log10(v)) / 1e6)) : list;
}

// Values laid on pixels; `log` for an axis of powers of ten.
function scale(low, high, from, to, log = false) {
  const f = log ? Math.log10 : (v) => v, a = f(low), b = f(high);
  const at = (v) => from + ((f(v) - a) / (b - a)) * (to - from);
  at.value = (px) => {
    const v = a + ((px - from) / (to - from)) * (b - a);
    return log ? 10 ** v : v;
  };
  return at;
}

function axes(picture, x, y, box, options) {
  const { xTicks, yTicks, xWords, yWords } = options;
  for (const v of yTicks) {
    picture.append(svg('line', { class: v === 0 ? 'zero' : 'grid', x1: box.left, x2: box.right, y1: y(v), y2: y(v) }),
                   svg('text', { class: 'tick', x: box.left - 7, y: y(v) + 4, 'text-anchor': 'end' }, short(v)));
  }
  for (const v of xTicks)
    picture.append(svg('line', { class: 'axis', x1: x(v), x2: x(v), y1: box.bottom, y2: box.bottom + 5 }),
                   svg('text', { class: 'tick', x: x(v), y: box.bottom + 18, 'text-anchor': 'middle' }, short(v, 4)));
  const middle = (box.top + box.bottom) / 2;
  picture.append(svg('line', { class: 'axis', x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom }),
                 svg('text', { class: 'words', x: box.right, y: box.bottom + 36, 'text-anchor': 'end' }, xWords),
                 svg('text', { class: 'words', x: 12, y: middle, 'text-anchor': 'middle',
                               transform: `rotate(-90 12 ${middle})` }, yWords));
}

// Of a long line in a narrow picture only the least and the greatest value of each pixel matter.
function outline(xs, ys, x, y) {
  let d = '', open = false, column = NaN, low, high, last;
  const flush = () => {
    if (Number.isNaN(column)) return;
    for (const v of low === high ? [low] : [low, high, last]) {
      d += `${open ? 'L' : 'M'}${column} ${v.toFixed(1)}`;
      open = true;
    }
  };
  for (let k = 0; k < xs.length; ++k) {
    if (ys[k] == null) {
      flush();
      (column = NaN), (open = false);
      continue;
    }
    const px = Math.round(2 * x(xs[k])) / 2, py = y(ys[k]);
    if (px !== column) {
      flush();
      (column = px), (low = high = py);
    }
    (low = Math.min(low, py)), (high = Math.max(high, py)), (last = py);
  }
  flush();
  return d;
}

function extent(series, withZero, log = false) {
  let low = withZero ? 0 : Infinity, high = withZero ? 0 : -Infinity;
  for (const s of series)
    for (const v of s.y) if (v != null) (low = Math.min(low, v)), (high = Math.max(high, v));
  if (log) return high > low ? [low / 1.15, high * 1.15] : [0.1, 10];
  if (!(high > low)) high = low + 1;
  const margin = 0.06 * (high - low);
  return [low < 0 || !withZero ? low - margin : low, high + margin];
}

function legend(series) {
  const list = html('ul', { class: 'legend' });
  for (const s of series)
    list.append(html('li', {}, html('span', { class: `key ${s.band ? 'band' : s.ink}`, 'aria-hidden': 'true' }), s.name));
  return list;
}

// A figure whose picture is drawn for its width by draw(width) -> svg element.
function frame({ title, caption, keys }, draw) {
  const holder = html('div', { class: 'plot' });
  const figure = html('figure', { class: 'chart' }, html('h3', {}, title), keys ? legend(keys) : '', holder,
                      html('figcaption', {}, caption));
  let width = 0;
  const redraw = () => {
    const now = Math.max(280, Math.round(holder.clientWidth));
    if (now === width || holder.clientWidth === 0) return;
    width = now;
    holder.replaceChildren(draw(width));
  };
  new ResizeObserver(() => requestAnimationFrame(redraw)).observe(holder);
  return figure;
}

// options: title, caption, alt, x, series [{name, y, ink}], bands [[from, to]], xWords, yWords, log (of x), logY, height;
// place for charts along the path, which follow it; dots for few points.
export function lines(options) {
  const { x: xs, series, bands = [], place, log = false, logY = false, dots = false, height = 210 } = options;
  const [low, high] = extent(series, !logY, logY);
  const keys = [...series];
  if (bands.length) keys.push({ name: options.bandName, band: true });
  let show = () => {};  // of the picture as it is drawn now
  place?.onChange((index) => show(index));
  return frame({ ...options, keys: keys.length > 1 ? keys : null }, (width) => {
    const box = { left: room.left, right: width - room.right, top: room.top, bottom: height - room.bottom };
    const x = scale(xs[0], xs[xs.length - 1], box.left, box.right, log), y = scale(low, high, box.bottom, box.top, logY);
    const picture = svg('svg', { viewBox: `0 0 ${width} ${height}`, width, height, role: 'img', 'aria-label': options.alt });
    for (const [from, to] of bands)
      picture.append(svg('rect', { class: 'band', x: x(from), width: Math.max(1, x(to) - x(from)), y: box.top,
                                   height: box.bottom - box.top }));
    axes(picture, x, y, box, { ...options, xTicks: log ? xs : ticks(xs[0], xs[xs.length - 1], width / 110),
                               yTicks: logY ? logTicks(low, high) : ticks(low, high, 5) });
    for (const s of series) {
      picture.append(svg('path', { class: `line ${s.ink}`, d: outline(xs, s.y, x, y) }));
      if (dots)
        s.y.forEach((v, k) => v != null && picture.append(svg('circle', { class: `dot ${s.ink}`, cx: x(xs[k]), cy: y(v), r: 3.5 },
          svg('title', {}, `${s.name}: ${short(v)} at ${short(xs[k])}`))));
    }
    if (place) {
      show = follow(picture, place, xs, series, x, y, box);
      show(place.index);
    }
    return picture;
  });
}

// A rule and dots at the place looked at, which the pointer moves; returns what shows another place.
function follow(picture, place, xs, series, x, y, box) {
  const rule = svg('line', { class: 'rule', y1: box.top, y2: box.bottom });
  const points = series.map((s) => svg('circle', { class: `point ${s.ink}`, r: 4.5 }));
  picture.append(rule, ...points);
  picture.classList.add('follows');
  const own = xs === place.path.along;
  const show = (at) => {
    const index = own ? at : nearest(xs, place.path.along[at]), px = x(xs[index]);
    rule.setAttribute('x1', px), rule.setAttribute('x2', px);
    series.forEach((s, k) => {
      const v = s.y[index];
      points[k].setAttribute('cx', px);
      points[k].setAttribute('cy', v == null ? -99 : y(v));
    });
  };
  const move = (event) => {
    const at = picture.getBoundingClientRect();
    place.goAlong(x.value(((event.clientX - at.left) / at.width) * picture.viewBox.baseVal.width));
  };
  picture.addEventListener('pointermove', (event) => (event.pointerType === 'mouse' || event.buttons) && move(event));
  picture.addEventListener('pointerdown', move);
  return show;
}

// options: title, caption, alt, low, high, count, under, over, unit words, colour(value).
export function bars(options) {
  const { low, high, count, under, over, n, height = 190 } = options;
  const all = [under, ...count, over], share = all.map((c) => (100 * c) / n);
  const top = Math.max(...share) * 1.06;
  return frame(options, (width) => {
    const box = { left: room.left, right: width - room.right, top: room.top, bottom: height - room.bottom };
    const by = (high - low) / count.length, x = scale(low - 2 * by, high + 2 * by, box.left, box.right);
    const y = scale(0, top, box.bottom, box.top);
    const picture = svg('svg', { viewBox: `0 0 ${width} ${height}`, width, height, role: 'img', 'aria-label': options.alt });
    axes(picture, x, y, box, { ...options, xTicks: [low, low / 2, 0, high / 2, high], yTicks: ticks(0, top, 4) });
    share.forEach((v, k) => {
      const outer = k === 0 || k === all.length - 1;
      const from = k === 0 ? low - 2 * by : k === all.length - 1 ? high : low + (k - 1) * by, wide = outer ? 2 * by : by;
      const words = outer ? (k ? `above ${short(high)} m` : `below ${short(low)} m`) : `${short(from)} to ${short(from + by)} m`;
      picture.append(svg('rect', { class: 'bar', x: x(from), width: Math.max(0.5, x(from + wide) - x(from) - 0.6), y: y(v),
                                   height: box.bottom - y(v), fill: options.colour(from + wide / 2) },
                         svg('title', {}, `${words}: ${short(v)} %`)));
    });
    return picture;
  });
}
