// Runs in every page that embeds something: loads the viewer and the robot just before they are seen.
import { dress } from "./style.js";

const base = document.currentScript.src.split("?")[0].replace(/[^/]*$/, "");
const phone = matchMedia("(max-width: 500px)");
const asked = {}; // scripts by address

/** Loads a classic script once; this works in pages opened from disk, where fetch does not. */
const script = (globalThis.labkitScript = (src) => (asked[src] ??= new Promise((done, failed) => {
  const element = Object.assign(document.createElement("script"), { src, onload: done });
  element.onerror = () => failed(new Error(`${src} is missing beside this page`));
  document.head.append(element);
})));

/** Loads the viewer once; the notebook's widget also uses this in pages without a kernel. */
const load = (globalThis.labkitLoad = async () => {
  await Promise.all([script(`${base}viewer.js`), script(`${base}robot.js`)]);
  return globalThis.labkitViewer;
});

async function build(host) {
  if (host.dataset.mounted) return;
  host.dataset.mounted = "1";
  host.querySelector(".lk-load")?.remove();
  const data = JSON.parse(host.querySelector('script[type="application/json"]').textContent);
  try {
    const { mount } = await load();
    const place = document.createElement("div");
    host.insertBefore(place, host.querySelector("figcaption"));
    mount(place, data);
    if (place.querySelector(".lk-note")) host.classList.add("lk-flat"); // no WebGL: the picture stays
  } catch (problem) {
    delete host.dataset.mounted; // the picture and the words stay
    console.error(problem);
  }
}

function offer(host) {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "lk-load";
  button.textContent = "Tap to load the interactive view";
  button.addEventListener("click", () => build(host).then(() => host.querySelector("button, input, select")?.focus()));
  host.insertBefore(button, host.querySelector("figcaption"));
}

function start() {
  if (globalThis.labkitStarted) return;
  globalThis.labkitStarted = true;
  dress();
  const near = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      near.unobserve(target);
      build(target);
    }
  }, { rootMargin: "400px" });
  for (const host of document.querySelectorAll(".lk-embed")) {
    if (phone.matches) offer(host);
    else near.observe(host);
  }
}

if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", start);
else start();
