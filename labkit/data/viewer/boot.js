(()=>{var i=`.lk-embed, .lk-player, .lk-demo {
  --lk-text: #1f2328; --lk-quiet: #57606a; --lk-edge: #b6bec8; --lk-face: #ffffff; --lk-sky: #e9edf2;
  --lk-grid: #7e8a97; --lk-accent: #0a5aa6; --lk-trace: #b3001b; --lk-path: #1f2328;
  --lk-line-0: #b3001b; --lk-line-1: #0a5aa6; --lk-line-2: #a35200; --lk-line-3: #1a7f4b;
  --lk-line-4: #7b3fa0; --lk-line-5: #57606a; --lk-line-6: #00737d;
  color: var(--lk-text); font-size: 0.95rem; line-height: 1.45;
}
html[data-theme="dark"] :is(.lk-embed, .lk-player, .lk-demo),
body[data-jp-theme-light="false"] :is(.lk-embed, .lk-player, .lk-demo) {
  --lk-text: #e6e9ee; --lk-quiet: #a9b4c0; --lk-edge: #566270; --lk-face: #15191e; --lk-sky: #3b444f;
  --lk-grid: #8a95a2; --lk-accent: #7ab8f5; --lk-trace: #ff7b86; --lk-path: #f0f3f6;
  --lk-line-0: #ff7b86; --lk-line-1: #7ab8f5; --lk-line-2: #f0ab5c; --lk-line-3: #6fd39d;
  --lk-line-4: #cf9df0; --lk-line-5: #a9b4c0; --lk-line-6: #66d0d8;
}
.lk-embed { margin: 1rem 0; max-width: 100%; }
.lk-embed > figcaption { margin-top: 0.4rem; color: var(--lk-text); text-align: left; font-weight: 400; font-family: inherit; }
.lk-embed details { margin-top: 0.3rem; }
.lk-embed .lk-poster { max-width: 100%; height: auto; display: block; border-radius: 6px; }
.lk-embed[data-mounted]:not(.lk-flat) > :is(.lk-poster, .lk-alt) { display: none; }
.lk-load { display: block; width: 100%; height: auto !important; padding: 1rem; }
.lk-player, .lk-demo { background: var(--lk-face); border: 1px solid var(--lk-edge); border-radius: 8px; overflow: hidden; }
.lk-demo { padding: 0.75rem; }
.lk-demo > .lk-player { margin: 0.6rem -0.75rem -0.75rem; border-width: 1px 0 0; border-radius: 0; }
.lk-stage { position: relative; background: var(--lk-sky); }
.lk-canvas { display: block; width: 100%; height: auto; aspect-ratio: 16 / 10; max-height: 480px; touch-action: pan-y; cursor: grab; }
.lk-canvas.lk-grab { touch-action: none; cursor: default; }
.lk-canvas.lk-over { cursor: grab; }
.lk-overlay { position: absolute; inset: 0; overflow: hidden; pointer-events: none; }
.lk-tag { position: absolute; top: 0; left: 0; padding: 0 0.35rem; border-radius: 4px; font-size: 0.78rem; white-space: nowrap;
  background: var(--lk-face); color: var(--lk-text); border: 1px solid var(--lk-edge); }
.lk-ring::before { content: ""; position: absolute; left: calc(50% - 1.1rem); top: calc(100% + 8px - 1.1rem); box-sizing: border-box; width: 2.2rem; height: 2.2rem;
  border: 3px solid #c77700; border-radius: 50%; animation: lk-pulse 1.4s ease-out infinite; }
@keyframes lk-pulse { from { transform: scale(0.5); } 80%, to { transform: scale(1.4); opacity: 0; } }
@media (prefers-reduced-motion: reduce) { .lk-ring::before { animation: none; } }
.lk-tag[hidden] { display: none; }
.lk-note { margin: 0; padding: 1rem; }
.lk-bar { display: flex; flex-wrap: wrap; align-items: center; gap: 0.4rem; padding: 0.45rem 0.75rem; }
.lk-bar + .lk-bar { padding-top: 0; }
.lk-range { flex: 1 1 10rem; min-width: 8rem; }
:is(.lk-player, .lk-demo, .lk-embed) :is(button, select, input[type="number"]) {
  font: inherit; box-sizing: border-box; height: 2rem; padding: 0.1rem 0.6rem; color: var(--lk-text); background: var(--lk-face);
  border: 1px solid var(--lk-quiet); border-radius: 5px; margin: 0; }
:is(.lk-player, .lk-demo, .lk-embed) button { cursor: pointer; }
:is(.lk-player, .lk-demo, .lk-embed) button:hover { border-color: var(--lk-accent); color: var(--lk-accent); }
:is(.lk-player, .lk-demo, .lk-embed) input[type="number"] { width: 5.2rem; }
:is(.lk-player, .lk-demo, .lk-embed) input[type="range"] { accent-color: var(--lk-accent); min-height: 1.6rem; margin: 0; }
:is(.lk-player, .lk-demo, .lk-embed) :is(button, select, input, canvas, summary):focus-visible { outline: 3px solid var(--lk-accent); outline-offset: 1px; }
.lk-canvas:focus-visible { outline-offset: -3px; }
.lk-play { min-width: 4.6rem; font-weight: 600; }
.lk-icon { min-width: 2rem; padding: 0.1rem 0.3rem; }
.lk-more { border-top: 1px solid var(--lk-edge); color: var(--lk-text); }
.lk-more > summary { padding: 0.3rem 0.75rem; cursor: pointer; }
.lk-say { margin: 0; padding: 0.45rem 0.75rem; border-bottom: 1px solid var(--lk-edge); color: var(--lk-text); }
.lk-player [hidden] { display: none !important; }
.lk-say.lk-alarm { border-left: 5px solid var(--lk-trace); font-weight: 600; }
.lk-player:has(> .lk-beside) { container-type: inline-size; }
@container (min-width: 38rem) { /* the curve beside the picture */
  .lk-beside { display: grid; grid-template-columns: 3fr 2fr; grid-template-rows: auto 1fr; }
  .lk-beside > :nth-child(2) { grid-row: span 2; }
}
.lk-beside > div { min-width: 0; }
.lk-livedials { padding: 0.1rem 0.75rem 0.4rem; }
.lk-live button[aria-pressed="true"] { background: var(--lk-accent); color: var(--lk-face); }
.lk-live button:disabled { opacity: 0.55; cursor: default; }
.lk-check { display: flex; align-items: center; gap: 0.3rem; min-height: 1.5rem; white-space: nowrap; font-size: 0.9rem; }
.lk-unit, .lk-speed, .lk-dial output { color: var(--lk-quiet); }
.lk-speed { display: flex; align-items: center; gap: 0.4rem; white-space: nowrap; }
.lk-legend { display: flex; flex-wrap: wrap; gap: 0.1rem 1.2rem; list-style: none; margin: 0; padding: 0.1rem 0.75rem; font-size: 0.85rem; color: var(--lk-text); }
.lk-legend li { margin: 0; display: flex; align-items: center; gap: 0.4rem; }
.lk-swatch { display: inline-block; width: 1.8rem; border-top: 3px solid; }
.lk-swatch.lk-dashed { border-top-style: dashed; }
.lk-swatch.lk-dotted { border-top-style: dotted; }
.lk-readout { margin: 0; padding: 0.2rem 0.75rem; font-variant-numeric: tabular-nums; color: var(--lk-text); min-height: 1.9em; }
.lk-hidden { position: absolute; width: 1px; height: 1px; margin: -1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap; }
.lk-plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 21rem), 1fr)); gap: 0.3rem 1rem; padding: 0.3rem 0.75rem 0.6rem; }
.lk-plotbox { min-width: 0; }
.lk-title { margin: 0; padding: 0.3rem 0.75rem; font-weight: 600; color: var(--lk-text); }
:is(.lk-embed, .lk-demo) .lk-title { display: none; } /* it has a caption or a heading */
.lk-plottitle { margin: 0; font-size: 0.85rem; font-weight: 600; color: var(--lk-text); }
.lk-plot { display: block; width: 100%; }
.lk-plot.lk-scrub { cursor: col-resize; touch-action: pan-y; }
.lk-gridline { stroke: var(--lk-edge); stroke-width: 0.6; }
.lk-line { fill: none; stroke-linejoin: round; }
.lk-leader { stroke: var(--lk-quiet); stroke-width: 0.7; fill: none; }
.lk-cursor { stroke: var(--lk-text); stroke-width: 1.5; }
.lk-tick { fill: var(--lk-quiet); font-size: 11px; }
.lk-name { fill: var(--lk-text); font-size: 11.5px; }
.lk-demo fieldset { border: 1px solid var(--lk-edge); border-radius: 6px; margin: 0 0 0.5rem; padding: 0.4rem 0.7rem; min-width: 0; }
.lk-demo legend { font-size: 0.9rem; font-weight: 600; padding: 0 0.3rem; margin: 0; width: auto; float: none; color: var(--lk-text); }
.lk-demo > :is(.lk-readout, .lk-plots) { padding-inline: 0; }
.lk-dials { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 19rem), 1fr)); gap: 0.35rem 1.2rem; }
.lk-dial, .lk-choice { display: flex; align-items: center; gap: 0.45rem; min-width: 0; }
.lk-dial label, .lk-choice label { flex: 0 0 5rem; margin: 0; }
:is(.lk-player, .lk-demo, .lk-embed) .lk-dial input[type="number"] { width: 5rem; padding-inline: 0.4rem; }
.lk-demo fieldset.lk-dials { grid-template-columns: repeat(auto-fit, minmax(min(100%, 14rem), 1fr)); }
fieldset .lk-dial label { flex-basis: 2.6rem; }
.lk-dial input[type="range"] { flex: 1 1 5rem; min-width: 4rem; }
.lk-dial output { min-width: 2.6rem; text-align: right; font-variant-numeric: tabular-nums; }
.lk-bar .lk-choice label { flex-basis: auto; }
.lk-dial .lk-unit { flex: 0 0 1.9rem; font-size: 0.85rem; line-height: 1.1; }
.lk-livedials .lk-dial label { flex: 0 0 5.5rem; }
.lk-choice select { flex: 1 1 auto; min-width: 0; }
.lk-scroll { overflow-x: auto; container-type: inline-size; }
.lk-table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 0.85rem; margin: 0.4rem 0; width: auto; }
.lk-table caption { position: sticky; left: 0; max-width: 100cqi; text-align: left; color: var(--lk-text); caption-side: top; padding: 0; }
.lk-table :is(th, td) { padding: 0.1rem 0.55rem; text-align: right; border-bottom: 1px solid var(--lk-edge); color: var(--lk-text); background: none; }
.lk-table thead th[aria-current="true"], .lk-table td.lk-chosen { border-left: 3px solid var(--lk-accent); font-weight: 700; }
@media (max-width: 500px) {
  .lk-canvas { aspect-ratio: 1; }
  .lk-beside .lk-canvas { aspect-ratio: 16 / 11; }
  .lk-range { flex-basis: 100%; order: -1; }
    .lk-speed label { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); } /* a screen reader still reads the name */
  .lk-table :is(th, td) { padding-inline: 0.3rem; }
}
@media print { /* the last frame and the plots are printed; what was never loaded is printed as its picture or text */
  .lk-bar, .lk-load, .lk-dial { display: none !important; }
  .lk-player, .lk-demo { break-inside: avoid; }
}
`;function a(){if(globalThis.labkitStyled)return;let e=new CSSStyleSheet;e.replaceSync(i),document.adoptedStyleSheets=[...document.adoptedStyleSheets,e],globalThis.labkitStyled=!0}var o=document.currentScript.src.split("?")[0].replace(/[^/]*$/,""),m=matchMedia("(max-width: 500px)"),p={},n=globalThis.labkitScript=e=>p[e]??=new Promise((l,r)=>{let t=Object.assign(document.createElement("script"),{src:e,onload:l});t.onerror=()=>r(new Error(`${e} is missing beside this page`)),document.head.append(t)}),c=globalThis.labkitLoad=async()=>(await Promise.all([n(`${o}viewer.js`),n(`${o}robot.js`)]),globalThis.labkitViewer);async function s(e){if(e.dataset.mounted)return;e.dataset.mounted="1",e.querySelector(".lk-load")?.remove();let l=JSON.parse(e.querySelector('script[type="application/json"]').textContent);try{let{mount:r}=await c(),t=document.createElement("div");e.insertBefore(t,e.querySelector("figcaption")),r(t,l),t.querySelector(".lk-note")&&e.classList.add("lk-flat")}catch(r){delete e.dataset.mounted,console.error(r)}}function b(e){let l=document.createElement("button");l.type="button",l.className="lk-load",l.textContent="Tap to load the interactive view",l.addEventListener("click",()=>s(e).then(()=>e.querySelector("button, input, select")?.focus())),e.insertBefore(l,e.querySelector("figcaption"))}function d(){if(globalThis.labkitStarted)return;globalThis.labkitStarted=!0,a();let e=new IntersectionObserver(l=>{for(let{isIntersecting:r,target:t}of l)r&&(e.unobserve(t),s(t))},{rootMargin:"400px"});for(let l of document.querySelectorAll(".lk-embed"))m.matches?b(l):e.observe(l)}document.readyState==="loading"?document.addEventListener("DOMContentLoaded",d):d();})();
