// SPDX-License-Identifier: BSD-3-Clause
// The place on the path that is looked at: one for the whole page. Whoever shows it asks to be told.
export class Place {
  constructor(path) {
    this.path = path;
    this.index = 0;
    this.told = [];
  }
  get size() {
    return this.path.along.length;
  }
  onChange(tell) {
    this.told.push(tell);
    tell(this.index);
  }
  go(index) {
    const wanted = Math.max(0, Math.min(this.size - 1, Math.round(index)));
    if (wanted === this.index) return;
    this.index = wanted;
    for (const tell of this.told) tell(wanted);
  }
  // The pose nearest to so many metres of way.
  goAlong(metres) {
    this.go(nearest(this.path.along, metres));
  }
  goTo(x, y) {
    let best = 0, least = Infinity;
    for (let k = 0; k < this.size; ++k) {
      const far = (this.path.x[k] - x) ** 2 + (this.path.y[k] - y) ** 2;
      if (far < least) (least = far), (best = k);
    }
    this.go(best);
  }
}

// Index of the value of a rising list that is nearest.
export function nearest(list, value) {
  let low = 0, high = list.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (list[middle] < value) low = middle;
    else high = middle;
  }
  return value - list[low] <= list[high] - value ? low : high;
}
