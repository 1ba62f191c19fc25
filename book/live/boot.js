// Gives each live panel of a page a button; the first click loads the viewer, MuJoCo and the panel.

const base = document.currentScript.src.split("?")[0].replace(/[^/]*$/, "");

async function open(host, button, status) {
  button.disabled = true;
  status.textContent = "Loading the arm and its physics…";
  try {
    const [viewer] = await Promise.all([globalThis.labkitLoad(),
      ...["mujoco.js", "mujoco-wasm.js", "live.js"].map((name) => globalThis.labkitScript(base + name))]);
    const config = JSON.parse(host.querySelector('script[type="application/json"]').textContent);
    const place = document.createElement("div");
    host.querySelector(".lk-offer").replaceWith(place);
    host.querySelector(".lk-still").remove();
    host.live = await globalThis.labkitLive.mount(place, config, viewer, globalThis.labkitRobot);
    place.querySelector("button, input, select")?.focus({ preventScroll: true });
  } catch (problem) {
    button.disabled = false;
    status.textContent = `The live arm could not be loaded: ${problem.message}`;
    console.error(problem);
  }
}

function start() {
  for (const host of document.querySelectorAll(".lk-live")) {
    if (host.dataset.offered) continue;
    host.dataset.offered = "1";
    const button = document.createElement("button");
    const status = document.createElement("span");
    Object.assign(button, { type: "button", className: "lk-load", textContent: "Load the live arm" });
    status.setAttribute("role", "status");
    status.textContent = "5 MB, from this book’s folder";
    button.addEventListener("click", () => open(host, button, status));
    host.querySelector(".lk-offer").replaceChildren(button, status);
    const loop = host.querySelector(".lk-still source");
    if (loop && matchMedia(loop.media).matches) {
      const stop = Object.assign(document.createElement("button"), { type: "button", className: "lk-stop", textContent: "Stop the motion" });
      stop.addEventListener("click", () => { loop.remove(); stop.remove(); });
      status.after(stop);
    }
  }
}

if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", start);
else start();
