// The entry point of the bundle, which defines `labkitLive`.
import { mujoco } from "./load.js";
import { Panel } from "./panel.js";
import { tagPiece } from "./tag_piece.js";
import { singularPiece } from "./singular_piece.js";
import { stiffnessPiece } from "./stiffness_piece.js";
import { run } from "./run.js";
import { Session } from "./session.js";
import text from "./live.css";

const PIECES = { open: (...given) => new Panel(...given), stiffness: stiffnessPiece, age: tagPiece, singular: singularPiece };

async function mount(host, config, viewer, robot) {
  viewer.dress();
  if (!globalThis.labkitLiveStyled) {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(text);
    document.adoptedStyleSheets = [...document.adoptedStyleSheets, sheet];
    globalThis.labkitLiveStyled = true;
  }
  return PIECES[config.piece ?? "open"](host, config, await mujoco(), viewer, robot);
}

globalThis.labkitLive = { mount, Session, run };
