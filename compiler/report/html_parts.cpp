#include "compiler/report/html_parts.h"

namespace kiln::report {

const char* const page_style = R"css(
:root { --ground: #fcfcfa; --panel: #ffffff; --ink: #1c2024; --faint: #5c6670; --line: #dde1e4; --accent: #0b62c4;
  --off: #8a949e; --good: #1a7f37; --bad: #b42318; --mark: #fff3c4; }
@media (prefers-color-scheme: dark) { :root { --ground: #14171a; --panel: #1b1f23; --ink: #e6e9ec; --faint: #9aa5af;
  --line: #343b42; --accent: #6cb2ff; --off: #77828c; --good: #56d364; --bad: #ff8a80; --mark: #3d3510; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1180px; padding: 16px; background: var(--ground); color: var(--ink);
  font: 15px/1.5 system-ui, sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.6em; margin: 8px 0; } h2 { font-size: 1.25em; margin: 0 0 4px; } p { margin: 6px 0; }
header p, .note { color: var(--faint); }
nav { display: flex; flex-wrap: wrap; gap: 4px 14px; margin: 10px 0; }
a { color: var(--accent); }
section { background: var(--panel); border: 1px solid var(--line); border-radius: 8px; padding: 16px; margin: 16px 0; }
.number { color: var(--faint); }
.choose { display: flex; flex-wrap: wrap; gap: 6px; margin: 12px 0 8px; }
button { font: inherit; color: inherit; background: none; border: 1px solid var(--line); border-radius: 14px; padding: 3px 12px;
  min-height: 32px; cursor: pointer; }
button[aria-selected=true] { border-color: var(--accent); color: var(--accent); font-weight: 600; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 420px), 1fr)); gap: 12px; }
svg.plot { width: 100%; height: auto; display: block; }
svg text { font-family: system-ui, sans-serif; font-size: 12px; fill: var(--ink); }
svg .label { paint-order: stroke; stroke: var(--panel); stroke-width: 3px; stroke-linejoin: round; }
svg .title { font-size: 13px; font-weight: 600; } svg .tick, svg .axis { fill: var(--faint); }
svg .grid { stroke: var(--line); } svg .zero { stroke-dasharray: 3 3; }
svg .front { fill: none; stroke: var(--accent); stroke-width: 1.5; opacity: .6; }
svg .leader { stroke: var(--off); stroke-width: .8; }
svg .reach { fill: transparent; } svg .dot { fill: var(--panel); stroke: var(--off); stroke-width: 2; }
svg .on-front .dot { fill: var(--accent); stroke: var(--accent); } svg .on-front .label { font-weight: 600; }
svg .point { cursor: pointer; outline: none; } svg .point:hover .label, svg .point:focus .label { text-decoration: underline; }
svg .selected .dot { stroke: var(--ink); stroke-width: 3; } svg .selected .label { text-decoration: underline; }
.wide { overflow-x: auto; margin: 10px 0; } table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13px; }
th, td { padding: 4px 7px; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
th:first-child { text-align: left; position: sticky; left: 0; background: var(--panel); }
thead th { color: var(--faint); font-weight: 600; white-space: normal; vertical-align: bottom; line-height: 1.25; }
thead th:first-child { white-space: nowrap; } tbody tr { cursor: pointer; }
tr.selected > *, tr.selected th:first-child { background: var(--mark); }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 268px), 1fr)); gap: 12px; }
figure { margin: 0; border: 2px solid transparent; border-radius: 6px; padding: 4px; cursor: pointer; }
figure.truth { cursor: default; } figure.selected { border-color: var(--accent); background: var(--mark); }
figure div { display: grid; grid-template-columns: 1fr 1fr; gap: 4px; } figure.truth img { width: calc(50% - 2px); }
img { width: 100%; image-rendering: pixelated; display: block; } figcaption { font-size: 13px; }
.contradicted { background: var(--panel); border: 1px solid var(--line); border-radius: 8px; padding: 0 16px 10px; }
.verdicts { padding-left: 1.2em; } .verdicts li { margin: 3px 0; }
.confirmed::marker { content: "\2713  "; color: var(--good); } .falsified::marker { content: "\2717  "; color: var(--bad); }
.undecided::marker { content: "~  "; color: var(--faint); } .falsified { color: var(--bad); }
pre { white-space: pre-wrap; background: var(--panel); border: 1px solid var(--line); border-radius: 8px; padding: 12px; }
summary { cursor: pointer; font-weight: 600; margin-top: 10px; }
)css";

const char* const page_foot = R"html(<section id="how"><h2>How to read this</h2>
<p>Time: least of at least 30 dispatches of at least 2 ms, of a loop that shades points computed on the spot, less the least time of
the same loop around an empty body. The first dispatch, in which the driver compiles the shader, is not among them; its extra time is
the column JIT ms. R and M mark what nothing else beats in time and relMSE, in time and maxRel; members with values that are not finite
are never marked.</p>
<p>relMSE = mean (x - r)<sup>2</sup> / (r<sup>2</sup> + 0.01 mean(r)<sup>2</sup>); maxRel = max |x - r| / max(|r|, 10<sup>-3</sup> max r);
bias = mean(x - r) / mean(r), over all scenes the mean of its size. Left picture: the member at the exposure of the reference. Right
picture: the size of the relative error from 10<sup>-7</sup> (dark) to 1 (bright), on a logarithmic scale.</p></section>)html";

const char* const page_script = R"js(
(function () {
  function select(id, from) {
    document.querySelectorAll('.selected').forEach(function (e) { e.classList.remove('selected'); });
    var all = document.querySelectorAll('[data-row="' + id + '"]');
    all.forEach(function (e) { e.classList.add('selected'); });
    // A point leads to its picture, or to its row where there is none; a row or a picture leads nowhere else.
    if (from.closest('svg')) {
      var to = document.querySelector('tr[data-row="' + id + '"]');
      if (to) to.scrollIntoView({block: 'nearest', inline: 'nearest'});
    }
  }
  function show(button) {
    var part = document.getElementById(button.dataset.part), section = part.closest('section');
    section.querySelectorAll('.part').forEach(function (p) { p.hidden = p !== part; });
    section.querySelectorAll('[data-part]').forEach(function (b) { b.setAttribute('aria-selected', String(b === button)); });
  }
  function act(target) {
    var button = target.closest('[data-part]');
    if (button) return show(button);
    var row = target.closest('[data-row]');
    if (row) select(row.dataset.row, row);
  }
  document.addEventListener('click', function (e) { act(e.target); });
  document.addEventListener('keydown', function (e) {
    if ((e.key === 'Enter' || e.key === ' ') && e.target.closest('[data-row]')) { e.preventDefault(); act(e.target); }
  });
})();
)js";

}  // namespace kiln::report
