// Runs MicroPython with a heap that cannot grow:
//   node run.mjs MICROPYTHON_FOLDER HEAP_BYTES FOLDER SCRIPT...
// All files of FOLDER lie in the interpreter's root; feed.char() gives the bytes of `transcript`,
// one by one. Before the first script, WebAssembly memory is
// kept from growing and what malloc could still give is used up: `heapsize` alone is no limit.
// =module.function:1 is called with 1, and what it returns printed; *module.function is called until
// it returns False; other scripts are Python, compiled in the same heap. This port collects garbage only after each of them, and after each call.
import fs from "node:fs";
import path from "node:path";
import { load } from "./load.mjs";

const SPARE = 8192; // for what JavaScript hands over; too little for the heap to grow by
const [home, heap, folder, ...scripts] = process.argv.slice(2);
const python = await load(home, folder, { heapsize: Number(heap) });
const script = path.join(folder, "transcript");
const transcript = fs.existsSync(script) ? fs.readFileSync(script) : [];
let at = 0;
python.registerJsModule("feed", { char: () => transcript[at++] });
WebAssembly.Memory.prototype.grow = () => { throw new RangeError("memory is capped"); };
process.stderr.write = () => true; // one line per refusal
const { _malloc: malloc, _free: free } = python._module;
const spare = malloc(SPARE);
for (let size = 1 << 24; size >= 16; size >>= 1) {
  while (malloc(size) !== 0);
}
free(spare);
const collect = python.pyimport("gc").collect;
for (const script of scripts) {
  const [module, name, ...given] = script.slice(1).split(/[.:]/);
  try {
    if (script.startsWith("*")) {
      const call = python.pyimport(module)[name];
      while (call());
    } else if (script.startsWith("=")) {
      const found = python.pyimport(module)[name](...given.map(Number));
      if (found !== null) fs.writeSync(1, `${name} ${found}\n`);
    } else {
      python.runPython(script);
    }
    collect();
  } catch (error) {
    fs.writeSync(1, `failed: ${script}: ${error.message}\n`);
    process.exit(1);
  }
}
