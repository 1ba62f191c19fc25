// The notebook's front end (anywidget).  Viewer and robot are asked from the kernel once per page,
// so a saved notebook holds the motion alone.  In the built book there is no kernel: boot.js has them.

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
  const data = () => JSON.parse(model.get("data"));
  const host = document.createElement("div");
  const alt = document.createElement("p");
  alt.textContent = data().alt ?? "";
  el.append(alt, host);
  const { mount } = await viewer(model);
  alt.remove();
  let shown = mount(host, data());
  const change = () => { shown.dispose(); shown = mount(host, data()); };
  model.on("change:data", change);
  return () => { model.off("change:data", change); shown.dispose(); };
}

export default { render };
