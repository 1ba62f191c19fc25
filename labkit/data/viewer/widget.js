// The notebook's front end (anywidget).  A page requests the viewer and the robot from the kernel once,
// so a saved notebook contains only the motion.  The built book has no kernel, so boot.js loads them.

function viewer(model) {
  if (globalThis.labkitLoad) return globalThis.labkitLoad();
  return (globalThis.labkitFiles ??= new Promise((done) => {
    model.on("msg:custom", async (message, buffers) => {
      if (message.kind !== "files") return;
      for (const buffer of buffers) {
        const url = URL.createObjectURL(new Blob([buffer], { type: "text/javascript" }));
        await import(url);
        URL.revokeObjectURL(url);
      }
      done(globalThis.labkitViewer);
    });
    model.send({ kind: "files" });
  }));
}

async function render({ model, el }) {
  const data = JSON.parse(model.get("data"));
  const host = document.createElement("div");
  const alt = document.createElement("p");
  alt.textContent = data.alt ?? "";
  el.append(alt, host);
  host.tabIndex = -1; // after a click beside a button, keys still come here
  host.style.outline = "none";
  el.addEventListener("keydown", (event) => { // the keys d d would delete the cell; Ctrl+S still saves
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "s") event.stopPropagation();
  });
  const { mount } = await viewer(model);
  alt.remove();
  const hear = [];
  const heard = (message) => hear.forEach((f) => f(message));
  // JupyterLab keeps the widget if its kernel is restarted or is shut down, after which it has no kernel.
  let gone = false;
  const cut = () => {
    const { kernel } = model.widget_manager ?? {};
    return gone || kernel === null || ["dead", "restarting", "autorestarting"].includes(kernel?.status);
  };
  const restarted = () => { gone ||= cut(); };
  model.on("comm_live_update", restarted);
  const link = model.send && { send: (message) => model.send(message), hear: (f) => hear.push(f), cut };
  const shown = mount(host, data, link);
  model.on("msg:custom", heard);
  return () => { model.off("comm_live_update", restarted); model.off("msg:custom", heard); shown.dispose(); };
}

export default { render };
