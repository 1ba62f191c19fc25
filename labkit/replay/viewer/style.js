// Adds the style sheet to the page once, as an adopted sheet, without inline styles or another file.
import text from "./style.css";

export function dress() {
  if (globalThis.labkitStyled) return;
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(text);
  document.adoptedStyleSheets = [...document.adoptedStyleSheets, sheet];
  globalThis.labkitStyled = true;
}
