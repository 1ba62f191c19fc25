// In every page that embeds something: loads the viewer and the robot when they are about to be seen.
import { dress } from "./style.js";

const base = document.currentScript.src.split("?")[0].replace(/[^/]*$/, "");
const phone = matchMedia("(max-width: 500px)");
const asked = {}; // scripts by address

/** A classic script, once: works from a file, where fetch does not. */
function script(url) {
  return (asked[url] ??= new Promise((done, failed) => {
    const element = document.createElement("script");
    element.src = url;
    element.addEventListener("load", done);
    element.addEventListener("error", () => failed(new Error(`${url} is missing`)));
    document.head.append(element);
  }));
}

/** A recorded run of the explorer; its script leaves the motion in labkitRuns. */
async function run(key, url) {
  const address = new URL(url, document.baseURI).href;
  await script(address);
  return globalThis.labkitRuns[url.replace(/^.*\//, "").replace(/\.js$/, "")];
}

/** The viewer, loaded once; the notebook's widget asks for it too where a page has no kernel. */
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
    mount(place, data, run);
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
