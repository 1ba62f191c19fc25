// A box for the reader's prediction: what they say stands beside what the arm does.

/** `found()` gives what the arm does; `commit()` is called when the reader has said a number. */
export function predictBox(h, { question, unit, commit, found }) {
  const number = h("input", { type: "number", step: "any", "aria-label": `Your prediction in ${unit}` });
  const answer = h("p", { role: "status" });
  let said = null;
  const tell = () => {
    if (said === null) return;
    const now = found();
    answer.textContent = now === null ? `You said ${said} ${unit}. Watch.`
      : `You said ${said} ${unit}; the arm: ${+now.toPrecision(3)} ${unit}. ${Math.abs(now - said) <= 0.1 * Math.abs(now) ? "Within a tenth." : "What did you leave out?"}`;
  };
  const go = () => {
    if (!Number.isFinite(number.valueAsNumber)) { answer.textContent = "Say a number first; a guess will do."; return; }
    said = number.valueAsNumber;
    commit();
    tell();
  };
  number.addEventListener("keydown", (event) => { if (event.key === "Enter") go(); });
  const element = h("div", { class: "lk-predict" }, h("p", {}, h("strong", {}, "Predict first. "), question),
    number, h("span", { class: "lk-unit" }, `${unit} `), h("button", { type: "button", onclick: go }, "Try it"), answer);
  return { element, tell, get said() { return said; } };
}
