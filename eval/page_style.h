// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace adit {

/// The page's style sheet: light and dark, one column when narrow, printable.
inline constexpr const char* page_style = R"css(
:root { color-scheme: light dark; --ground: #ffffff; --panel: #f4f5f7; --ink: #1b1d22; --faint: #5b606b; --rule: #d9dce2; --link: #0b57a4; --one: #0072b2; --two: #c04e00; --band: #e6c35c66; --place: #d4007a; }
@media (prefers-color-scheme: dark) {
  :root { --ground: #15171b; --panel: #1f2228; --ink: #e8eaee; --faint: #a4aab6; --rule: #363b45; --link: #7db8f5; --one: #56b4e9; --two: #f0a35e; --band: #b58f2a55; --place: #ff5fb0; }
}
* { box-sizing: border-box; }
html { scroll-behavior: smooth; }
@media (prefers-reduced-motion: reduce) { html { scroll-behavior: auto; } }
body { margin: 0; background: var(--ground); color: var(--ink); font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; }
a { color: var(--link); }
:focus-visible { outline: 3px solid var(--link); outline-offset: 2px; }
.skip { position: absolute; left: -99em; }
.skip:focus { left: 1em; top: 1em; background: var(--ground); padding: .5em; z-index: 2; }
header, main, footer { max-width: 1500px; margin: 0 auto; padding: 0 24px; }
header { padding-top: 20px; }
h1 { font-size: 1.15rem; margin: 0 0 .3em; color: var(--faint); font-weight: 600; overflow-wrap: anywhere; }
h2 { font-size: 1.4rem; margin: 2.2em 0 .6em; padding-top: .6em; border-top: 1px solid var(--rule); }
h3 { font-size: 1.05rem; margin: 0 0 .4em; }
.verdict { font-size: 1.25rem; line-height: 1.4; margin: 0 0 .9em; font-weight: 500; text-wrap: pretty; }
.first { display: grid; grid-template-columns: minmax(300px, 27%) 1fr; gap: 24px; align-items: start; }
.numbers { display: grid; grid-template-columns: 1fr 1fr; gap: 10px; margin: 0; }
.numbers div { background: var(--panel); border-radius: 8px; padding: 10px 12px; }
.numbers dt { font-size: .82rem; color: var(--faint); line-height: 1.25; }
.numbers dd { margin: 0; }
.numbers .value { font-size: 1.6rem; font-weight: 650; line-height: 1.3; font-variant-numeric: tabular-nums; }
.numbers .unit { font-size: 1rem; font-weight: 500; color: var(--faint); }
.numbers .note { font-size: .76rem; color: var(--faint); line-height: 1.3; display: block; }
nav { margin: 1em 0 0; font-size: .95rem; display: flex; flex-wrap: wrap; gap: .3em 1.1em; }
figure { margin: 0 0 1.6em; }
figure svg { display: block; width: 100%; height: auto; border-radius: 8px; font-family: "DejaVu Sans", Verdana, system-ui, sans-serif; }
figure svg a:focus-visible circle { stroke: #0b57a4; stroke-width: 5; }
figcaption { font-size: .9rem; color: var(--faint); margin-top: .5em; max-width: 95ch; }
.narrow { display: none; }
.scroll + .trio { margin-top: 1.4em; }
.trio { display: grid; grid-template-columns: repeat(3, 1fr); gap: 16px; }
header figure svg { max-height: calc(100vh - 130px); min-height: 300px; }
.pair { display: grid; grid-template-columns: repeat(2, 1fr); gap: 16px 20px; }
main > section > figure { max-width: 1240px; }
.missing { background: var(--panel); border-radius: 8px; padding: 1em 1.2em; color: var(--faint); }
table { border-collapse: collapse; font-size: .9rem; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .28em .8em .28em 0; border-bottom: 1px solid var(--rule); vertical-align: top; }
th { color: var(--faint); font-weight: 600; }
td.n, th.n { text-align: right; white-space: nowrap; }
td code { overflow-wrap: break-word; }
summary { cursor: pointer; font-weight: 600; padding: .4em 0; }
pre { background: var(--panel); border-radius: 8px; padding: 1em; overflow-x: auto; font-size: .82rem; line-height: 1.45; }
.scroll { overflow-x: auto; }
.tall { max-height: 70vh; overflow-y: auto; }
.tall thead th { position: sticky; top: 0; background: var(--ground); }
.sortable th button { font: inherit; color: inherit; background: none; border: 0; padding: 0; cursor: pointer; text-align: inherit; }
.sortable th button::after { content: " ↕"; opacity: .45; }
.sortable th[aria-sort="ascending"] button::after { content: " ↑"; opacity: 1; }
.sortable th[aria-sort="descending"] button::after { content: " ↓"; opacity: 1; }
.sortable tbody tr:hover, .sortable tbody tr:focus { background: var(--panel); }
.note { color: var(--faint); font-weight: 400; font-size: .85em; }
.verdict-better { color: light-dark(#00684b, #4fd1a5); font-weight: 650; } .verdict-worse { color: light-dark(#a33f00, #ff9d5c); font-weight: 650; }
.about { color: var(--faint); font-size: .9rem; margin: 0 0 .6em; }
[hidden] { display: none !important; }
.scripted #errors { display: none; }
.slider { position: sticky; top: 0; z-index: 1; background: var(--ground); display: grid; grid-template-columns: auto 1fr; gap: 2px 14px; align-items: center; padding: 8px 0; border-bottom: 1px solid var(--rule); margin-bottom: 14px; }
.slider label { font-weight: 600; }
.slider input { width: 100%; accent-color: var(--place); }
.slider output { grid-column: 1 / -1; color: var(--faint); font-size: .9rem; font-variant-numeric: tabular-nums; min-height: 1.5em; }
.chart { margin-bottom: 1.3em; min-width: 0; }
.plot { background: var(--panel); border-radius: 8px; }
.plot svg { overflow: visible; font-family: inherit; }
.plot text { font-size: 12.5px; fill: var(--faint); }
.grid { stroke: var(--rule); stroke-width: 1; }
.zero, .axis { stroke: var(--faint); stroke-width: 1; }
.line { fill: none; stroke-width: 1.6; stroke-linejoin: round; }
.line.one, .point.one, .dot.one { stroke: var(--one); } .line.two, .point.two, .dot.two { stroke: var(--two); }
.dot.one { fill: var(--one); } .dot.two { fill: var(--two); }
rect.band { fill: var(--band); }
.bar { stroke: var(--faint); stroke-width: .4; }
.rule { stroke: var(--place); stroke-width: 1.5; pointer-events: none; }
.point { fill: var(--panel); stroke-width: 2; pointer-events: none; }
.follows { cursor: crosshair; touch-action: pan-y; }
.legend { list-style: none; display: flex; flex-wrap: wrap; gap: .1em 1.4em; margin: 0 0 .3em; padding: 0; font-size: .88rem; color: var(--faint); }
.key { display: inline-block; width: 1.6em; height: 3px; margin-right: .5em; vertical-align: middle; border-radius: 2px; }
.key.one { background: var(--one); } .key.two { background: var(--two); } .key.band { background: var(--band); height: .9em; }
.charts { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 8px 24px; }
.place .halo { fill: #fff; fill-opacity: .75; } .place .core { fill: #d4007a; stroke: #fff; stroke-width: 2; }
.passage { fill: none; stroke: #d4007a; stroke-width: 5; stroke-linecap: round; stroke-opacity: .8; pointer-events: none; }
.scripted #plan svg { cursor: pointer; }
figure.view { max-width: none !important; }
.space { background: var(--panel); border-radius: 8px; overflow: hidden; position: relative; min-height: 200px; }
.space canvas { display: block; width: 100%; touch-action: none; border-radius: 8px; }
.status { position: absolute; left: 16px; top: 8px; color: var(--faint); }
.toggles { border: 1px solid var(--rule); border-radius: 8px; display: flex; flex-wrap: wrap; gap: .2em 1.2em; margin: 0 0 10px; padding: 4px 12px 8px; }
.toggles legend { color: var(--faint); font-size: .85rem; }
.ramp { display: flex; align-items: center; gap: 8px; font-size: .85rem; color: var(--faint); margin-top: 8px; }
.ramp i { width: 220px; height: 12px; border-radius: 3px; }
.player { display: grid; grid-template-columns: minmax(0, 1fr); gap: 6px; }
.player img { width: 100%; height: auto; max-width: 900px; border-radius: 8px; display: block; }
.buttons { display: flex; flex-wrap: wrap; gap: 8px; margin-top: 10px; }
.buttons button { font: inherit; font-size: .9rem; color: var(--ink); background: var(--panel); border: 1px solid var(--rule); border-radius: 6px; padding: .3em .8em; cursor: pointer; }
footer { margin: 3em auto 2em; color: var(--faint); font-size: .85rem; }
@media (max-width: 1000px) { .first { grid-template-columns: 1fr; } .numbers { grid-template-columns: repeat(3, 1fr); } .trio, .pair, .charts { grid-template-columns: minmax(0, 1fr); } header figure svg { max-height: none; min-height: 0; } }
@media (max-width: 620px) {
  header, main, footer { padding-left: 14px; padding-right: 14px; }
  .verdict { font-size: 1.08rem; }
  .numbers { grid-template-columns: 1fr 1fr; }
  .numbers .value { font-size: 1.35rem; }
  .has-narrow .wide { display: none; }
  .has-narrow .narrow { display: block; }
  .plate { overflow-x: auto; }
  .plate.big svg { min-width: 680px; }
  .plate.big + figcaption::before { content: "Swipe the picture sideways to see the whole of it. "; font-weight: 600; }
}
@media print { h2, h3 { break-after: avoid; } nav, .skip, .slider, .toggles, .buttons { display: none; } .tall { max-height: none; } .scroll { overflow: visible; } table { font-size: 8pt; } td, th { padding: .1em .6em .1em 0; } th.n { white-space: normal; } .sortable th button::after { content: ""; } details::details-content { content-visibility: visible; } pre { white-space: pre-wrap; columns: 3; font-size: 7pt; } figure, tr, .numbers div { break-inside: avoid; } body { font-size: 11pt; } details > * { display: block; } }
)css";

}  // namespace adit
