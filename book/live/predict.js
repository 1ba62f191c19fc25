// A box for the reader's prediction: what they say stands beside what the arm does, or what equations give.

/** Words for an element that a screen reader hears: the same words again are no news. */
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/**
 * `found()` gives the answer; `commit()` is called when the reader has said a number.  What
 * would tell it before is put `behind` some words, which then make room for it.
 */
export function predictBox(h, { question, unit, commit, found }) {
  const number = h("input", { type: "number", step: "any", "aria-label": `Your prediction in ${unit}` });
  const answer = h("p", { role: "status" });
  const veils = [];
  let said = null, told = false; // once the arm has answered, what a hand does to it later does not count
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
