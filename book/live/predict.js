// A box for the reader's prediction, which is shown beside the arm's result or that of the equations.

/** Write words into an element that a screen reader reads; repeated words are not written again. */
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/**
 * `found()` returns the answer; `commit()` is called when the reader has entered a number.  Until
 * then, `behind` shows some words in place of the elements that would give the answer away.
 */
export function predictBox(h, { question, unit, commit, found }) {
  const number = h("input", { type: "number", step: "any", "aria-label": `Your prediction in ${unit}` });
  const answer = h("p", { role: "status" });
  const veils = [];
  let said = null, told = false; // once the arm has answered, a later hand does not change the answer
  const tell = () => {
    if (said === null || told) return;
    const now = found();
    told = now !== null;
    write(answer, now === null ? `You predicted ${said} ${unit}. Watch.`
      : `You predicted ${said} ${unit}; the answer is ${+now.toPrecision(3)} ${unit}. ${Math.abs(now - said) <= 0.1 * Math.abs(now) ? "Within a tenth." : "What did you leave out?"}`);
  };
  const go = () => {
    if (!Number.isFinite(number.valueAsNumber)) { answer.textContent = "Enter a number first; a guess will do."; return; }
    said = number.valueAsNumber;
    told = false;
    for (const [words, hidden] of veils) [words.hidden, hidden.hidden] = [true, false];
    commit();
    tell();
  };
  number.addEventListener("keydown", (event) => { if (event.key === "Enter") go(); });
  const element = h("div", { class: "lk-predict" }, h("p", {}, h("strong", {}, "Predict first. "), question),
    number, h("span", { class: "lk-unit" }, `${unit} `), h("button", { type: "button", onclick: go }, "Try it"), answer);
  const behind = (words, ...children) => {
    const veil = [h("p", { class: "lk-kept" }, words), h("div", { hidden: true }, ...children)];
    veils.push(veil);
    return veil;
  };
  return { element, tell, behind, get said() { return said; } };
}
