// SPDX-License-Identifier: BSD-3-Clause
// The page's script: what stands in the page as data becomes charts, a view in space and a table that sorts.
import { along } from './along.js';
import { errors } from './errors.js';
import { Place } from './place.js';
import { markPlan } from './plan.js';
import { space } from './space.js';
import { sortable } from './table.js';

// Fills a section that is hidden where there is no script, or nothing to show.
function reveal(id, parts) {
  const section = document.getElementById(id);
  if (!section || !parts.length) return;
  section.append(...parts);
  section.hidden = false;
  for (const link of document.querySelectorAll(`nav a[href="#${section.getAttribute('aria-labelledby')}"]`)) link.hidden = false;
}

function lightPassages(table, data, light) {
  const of = (event) => event.target.closest('tr')?.dataset.passage;
  table.tBodies[0].addEventListener('pointerover', (event) => light(data.passages[of(event)]));
  table.tBodies[0].addEventListener('focusin', (event) => light(data.passages[of(event)]));
  table.addEventListener('pointerleave', () => light(null));
  table.addEventListener('focusout', () => light(null));
}

function fill(data) {
  const place = data.path ? new Place(data.path) : null;
  const light = markPlan(data, place);
  if (place) reveal('along-section', along(data, place));
  if (data.space) reveal('view-section', space(data, place));
  reveal('errors-section', errors(data));
  const passages = document.getElementById('passages-table');
  if (passages) lightPassages(passages, data, light);
}

document.documentElement.classList.add('scripted');
for (const table of document.querySelectorAll('table.sortable')) sortable(table);
const given = document.getElementById('data');
if (given) fill(JSON.parse(given.textContent));
