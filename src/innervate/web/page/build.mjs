// Builds ../static from the sources in this folder. `node build.mjs [FOLDER]` writes elsewhere.
//
// What is built carries a fingerprint of what it was built from, so that a test without Node can
// tell whether it is current (tests/browser/test_bundle.py).
import { createHash } from "node:crypto";
import { copyFileSync, mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "..", "static");

/** SHA-256 over names and contents of all files of this folder, in order of their names. */
function fingerprint() {
  const sum = createHash("sha256");
  const files = readdirSync(here, { withFileTypes: true }).filter((entry) => entry.isFile());
  for (const name of files.map((entry) => entry.name).sort()) {
    sum.update(`${name}\0`).update(readFileSync(join(here, name))).update("\0");
  }
  return sum.digest("hex");
}

/** The licences of the packages that went into the bundle. */
function licences(inputs) {
  const found = Object.keys(inputs).map((path) => /node_modules\/([^/]+)\//.exec(path)?.[1]);
  const names = [...new Set(found)].filter(Boolean).sort();
  return names.map((name) => {
    const text = readFileSync(join(here, "node_modules", name, "LICENSE"), "utf8").trim();
    return `${name}\n\n${text}\n`;
  });
}

const mark = `built by \`make page\` from src/innervate/web/page, sha256 ${fingerprint()}`;
mkdirSync(out, { recursive: true });
const result = await build({
  absWorkingDir: here,
  entryPoints: [{ in: "main.js", out: "page" }, { in: "page.css", out: "page" }],
  outdir: out,
  bundle: true,
  minify: true,
  format: "esm",
  target: ["chrome109", "firefox115", "safari16"],
  charset: "utf8",
  legalComments: "none",
  metafile: true,
  logLevel: "warning",
  banner: { js: `/* ${mark} */`, css: `/* ${mark} */` },
});
const page = readFileSync(join(here, "index.html"), "utf8");
writeFileSync(join(out, "index.html"), page.replace("<!doctype html>", `$&\n<!-- ${mark} -->`));
copyFileSync(join(here, "icon.svg"), join(out, "icon.svg"));
const texts = licences(result.metafile.inputs);
writeFileSync(join(out, "LICENCES.txt"), texts.join("\n----\n\n"));
