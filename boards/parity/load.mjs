// MicroPython with a folder's files, subfolders too, in its root.
import fs from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";

export async function load(home, folder, options) {
  const { loadMicroPython } = await import(pathToFileURL(path.join(home, "micropython.mjs")));
  const stdout = (line) => fs.writeSync(1, line + "\n");
  const python = await loadMicroPython({ stdout, ...options });
  copy(python, folder, "");
  return python;
}

function copy(python, from, to) {
  for (const entry of fs.readdirSync(from, { withFileTypes: true })) {
    const [here, there] = [path.join(from, entry.name), `${to}/${entry.name}`];
    if (entry.isDirectory()) {
      python.FS.mkdir(there);
      copy(python, here, there);
    } else {
      python.FS.writeFile(there, fs.readFileSync(here));
    }
  }
}
