// SPDX-License-Identifier: BSD-3-Clause
// Tables that a click on a column's head sorts; cells tell their number as data-v.
import { html } from './words.js';

function value(row, column) {
  const given = row.cells[column].dataset.v;
  return given === undefined || given === '' ? NaN : Number(given);
}

function sort(table, column, rising) {
  const body = table.tBodies[0];
  const rows = [...body.rows].sort((a, b) => {
    const u = value(a, column), v = value(b, column);
    if (Number.isNaN(u) || Number.isNaN(v)) return Number.isNaN(u) - Number.isNaN(v);  // what is missing comes last
    return rising ? u - v : v - u;
  });
  body.append(...rows);
  [...table.tHead.rows[0].cells].forEach((head, k) =>
    head.setAttribute('aria-sort', k !== column ? 'none' : rising ? 'ascending' : 'descending'));
}

export function sortable(table) {
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const words = [...head.childNodes];
    head.append(html('button', { type: 'button', onclick: () => sort(table, column, head.getAttribute('aria-sort') === 'descending') }, ...words));
  });
}
