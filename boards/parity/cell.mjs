// Runs a board's main.py on MicroPython: node cell.mjs MICROPYTHON_FOLDER FOLDER DEVICE...
// The devices are the board's UARTs, from 0. It runs until it is killed.
import fs from "node:fs";
import path from "node:path";
import { load } from "./load.mjs";

const [home, folder, ...devices] = process.argv.slice(2);
const python = await load(home, folder, {});

const { O_RDWR, O_NOCTTY, O_NONBLOCK } = fs.constants;
const lines = devices.map((name) => ({
  fd: fs.openSync(name, O_RDWR | O_NOCTTY | O_NONBLOCK), come: [], go: [],
}));
const chunk = Buffer.alloc(256);

function attempt(what) {
  try {
    return what();
  } catch (error) {
    if (error.code === "EAGAIN") return 0;
    throw error;
  }
}

const clock = new Int32Array(new SharedArrayBuffer(4));
python.registerJsModule("host", {
  waiting(number) {
    const line = lines[number];
    const count = attempt(() => fs.readSync(line.fd, chunk, 0, chunk.length, null));
    line.come.push(...chunk.subarray(0, count));
    return line.come.length;
  },
  take: (number) => lines[number].come.shift(),
  put(number, byte) {
    lines[number].go.push(byte);
  },
  flush(number) {
    const count = attempt(() => fs.writeSync(lines[number].fd, Buffer.from(lines[number].go)));
    lines[number].go = [];
    return count;
  },
  rest: () => void Atomics.wait(clock, 0, 0, 1),
});
try {
  python.runPython(fs.readFileSync(path.join(folder, "main.py"), "utf8"));
} catch (error) {
  fs.writeSync(1, `failed: ${error.message}\n`);
  process.exit(1);
}
