// Bundles the viewer and copies what the book needs from npm; writes the manifest of hashes.
// book/_tools/vendor.sh installs the packages and runs this:
// node build.mjs <node_modules> <the licence of mujoco> <the fonts of the theme>
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { createRequire } from "node:module";
import { cpSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { basename, dirname, join, relative } from "node:path";
import { gzipSync } from "node:zlib";
import { fileURLToPath } from "node:url";

const [modules, mujocoLicence, theme] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, "../../..");
const source = join(root, "labkit/replay/viewer");
const viewer = join(root, "labkit/data/viewer");
// Not book/_static: Jupyter Book 1 would put every script in a folder of that name on every page.
const vendor = join(root, "book/static/vendor");
const tests = join(root, "tests/vendor");
const esbuild = createRequire(join(modules, "x.js"))("esbuild");
const wanted = JSON.parse(readFileSync(join(here, "package.json"))).dependencies;

const common = {
  bundle: true, minify: true, format: "iife", target: "es2022", legalComments: "none",
  loader: { ".css": "text" }, nodePaths: [modules], logLevel: "warning" };
const three = `/* three.js ${wanted.three}, MIT, see LICENSE-three */`;
for (const [name, more] of [
  ["viewer", { globalName: "labkitViewer", banner: { js: three }, footer: { js: "globalThis.labkitViewer=labkitViewer;" } }],
  ["boot", {}]]) {
  await esbuild.build({ ...common, ...more, entryPoints: [join(source, `${name}.js`)], outfile: join(viewer, `${name}.js`) });
}
cpSync(join(source, "widget.js"), join(viewer, "widget.js"));
cpSync(join(modules, "three/LICENSE"), join(viewer, "LICENSE-three"));

// The live arm of the book.  Its scripts are classic ones, which work on file://.  MuJoCo's WebAssembly
// is compressed here, and build_book.py writes it into a script.
const live = join(root, "book/live"), bundle = join(live, "bundle");
rmSync(bundle, { recursive: true, force: true });
mkdirSync(bundle, { recursive: true });
const script = { ...common, external: ["module", "fs", "path", "url"],
  define: { process: "undefined", "import.meta.url": '"file:///mujoco.js"' } };
const mujoco = join(modules, "@mujoco/mujoco/mujoco.js");
await esbuild.build({ ...script, outfile: join(bundle, "mujoco.js"), banner: { js: `/* MuJoCo ${wanted["@mujoco/mujoco"]}, Apache-2.0, see LICENSE-mujoco */` },
  stdin: { contents: `import load from ${JSON.stringify(mujoco)}; globalThis.labkitLoadMuJoCo = load;`, resolveDir: modules } });
await esbuild.build({ ...common, entryPoints: [join(live, "page.js")], outfile: join(bundle, "live.js") });
await esbuild.build({ ...common, entryPoints: [join(live, "boot.js")], outfile: join(bundle, "boot.js") });
writeFileSync(join(bundle, "mujoco.wasm.gz"), gzipSync(readFileSync(join(modules, "@mujoco/mujoco/mujoco.wasm")), { level: 9 }));
cpSync(mujocoLicence, join(bundle, "LICENSE-mujoco")); // the npm package has no licence; the wheel from the same source has it
cpSync(join(dirname(mujocoLicence), "LICENSES_THIRD_PARTY.md"), join(bundle, "NOTICE-mujoco.md"));

rmSync(vendor, { recursive: true, force: true });
mkdirSync(vendor, { recursive: true });
const take = (from, to) => cpSync(from, join(vendor, to));
// The font of formulas, with the characters that formulas use; its letters alone would be five times as large.
const stix = join(modules, "@fontsource/stix-two-math");
const cut = (font, to, ...options) => execFileSync(process.env.PYTHON, ["-m", "fontTools.subset", font, "--flavor=woff", `--output-file=${join(vendor, to)}`, ...options]);
cut(join(stix, "files/stix-two-math-latin-400-normal.woff"), "stix-two-math.woff", "--no-hinting", "--layout-features=ssty,ccmp,math,mark,mkmk,dtls,flac",
  "--unicodes=U+20-7E,U+A0-FF,U+2C6-2DD,U+300-338,U+391-3F5,U+2016,U+2026,U+2032,U+203E,U+20D7,U+2102,U+2110-2131,U+2190-2199," +
  "U+210E,U+21D0-21D4,U+2200-2265,U+226A,U+226B,U+22A4,U+22A5,U+22C5,U+22C6,U+22EE-22F1,U+2308-230B,U+239B-23B4,U+23DC-23E1,U+27E8,U+27E9," +
  "U+1D434-1D467,U+1D6A4-1D6E1,U+1D6FC-1D71B");
execFileSync(process.env.PYTHON, [join(here, "roots.py"), join(vendor, "stix-two-math.woff")]);
// The theme's icons, without the thousand that no page shows.
cut(join(theme, "fa-solid-900.ttf"), "icons.woff", "--no-layout-closure", "--unicodes=U+F002,U+F00C,U+F010,U+F019,U+F03A,U+F042,U+F053,U+F054,U+F057,U+F058,U+F05A," +
  "U+F062,U+F064,U+F06A,U+F071,U+F077,U+F078,U+F0C9,U+F0EB,U+F0F3,U+F104,U+F105,U+F107,U+F185,U+F186,U+F303,U+F35D");
take(join(stix, "LICENSE"), "LICENSE-stix");
// The font of the text, upright and italic, in all weights.
const sans = join(modules, "@fontsource-variable/source-sans-3");
for (const style of ["normal", "italic"]) take(join(sans, `files/source-sans-3-latin-wght-${style}.woff2`), `source-sans-${style}.woff2`);
take(join(sans, "LICENSE"), "LICENSE-source-sans");
cpSync(join(modules, "axe-core/axe.min.js"), join(tests, "axe.min.js"));
cpSync(join(modules, "axe-core/LICENSE"), join(tests, "LICENSE-axe"));

const walk = (folder) => readdirSync(folder, { withFileTypes: true, recursive: true })
  .filter((e) => e.isFile()).map((e) => join(e.parentPath, e.name)).sort();
const sha = (file) => createHash("sha256").update(readFileSync(file)).digest("hex");
const hashes = (files) => Object.fromEntries(files.map((f) => [relative(root, f).replaceAll("\\", "/"), sha(f)]));
const built = walk(viewer).filter((f) => basename(f) !== "robot.js"); // make_robot.py makes that one
writeFileSync(join(vendor, "MANIFEST.json"), `${JSON.stringify({
  made_by: "sh book/_tools/vendor.sh", packages: wanted,
  files: hashes([...walk(vendor), ...built, ...walk(bundle), ...walk(tests)]),
  sources: hashes([...walk(source), ...walk(live).filter((f) => !f.startsWith(bundle)), ...walk(here)]),
}, null, 1)}\n`);
